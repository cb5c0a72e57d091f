// @ts-check
// The text that says which column is which: `force=Force_N [N], pressure=P1 [psi], length=-Weg`, as `--columns` takes it.

export const QUANTITIES = [
  "pressure", "length", "contraction", "displacement", "force", "time", "sweep", "specimen", "cycle", "direction", "temperature", "diameter", "volume", "force_sd", "ignore",
];

/** Units that are offered; others can be typed. @type {Record<string, string[]>} */
export const UNITS = {
  pressure: ["bar", "kPa", "MPa", "Pa", "psi", "mbar", "bar abs"], length: ["mm", "cm", "m", "in"], displacement: ["mm", "cm", "m", "in"], contraction: ["%", "1"],
  force: ["N", "kN", "lbf", "kgf"], force_sd: ["N", "kN"], time: ["s", "ms", "min", "h"], temperature: ["degC", "K"], diameter: ["mm", "cm", "m", "in"], volume: ["l", "ml", "m3"],
};

/** @typedef {{quantity: string, heading: string, unit: string | null, isReversed: boolean}} Entry */

/** @param {string | null} text @returns {Entry[]} */
export function parse(text) {
  return split(text ?? "").flatMap((part) => {
    const at = part.indexOf("=");
    if (at < 0) return [];
    const quantity = part.slice(0, at).trim();
    let heading = part.slice(at + 1).trim();
    const isReversed = heading.startsWith("-");
    if (isReversed) heading = heading.slice(1).trim();
    if (heading.length > 1 && heading.startsWith('"') && heading.endsWith('"')) heading = heading.slice(1, -1);
    return [{ quantity, isReversed, ...bare(heading) }];
  });
}

/** A heading without the unit in brackets behind it. @param {string} heading @returns {{heading: string, unit: string | null}} */
export function bare(heading) {
  const found = /^(.*)\[([^[\]]*)\]\s*$/s.exec(heading.trim());
  return found ? { heading: found[1].trim(), unit: found[2].trim() } : { heading: heading.trim(), unit: null };
}

/** Commas within quotes separate nothing. @param {string} text */
function split(text) {
  const parts = [""];
  let isQuoted = false;
  for (const letter of text) {
    if (letter === '"') isQuoted = !isQuoted;
    if (letter === "," && !isQuoted) parts.push("");
    else parts[parts.length - 1] += letter;
  }
  return parts;
}

/** @param {Entry[]} entries */
export function format(entries) {
  return entries.map(({ quantity, heading, unit, isReversed }) => {
    const whole = unit && quantity !== "ignore" ? `${heading} [${unit}]` : heading;
    const mustQuote = /[,]/.test(whole) || whole.startsWith("-") || whole.startsWith('"');
    return `${quantity}=${isReversed ? "-" : ""}${mustQuote ? `"${whole}"` : whole}`;
  }).join(", ");
}

/** The map with one column changed; a quantity that another column had is freed. @param {string | null} text @param {Entry} entry */
export function withEntry(text, entry) {
  const kept = parse(text).filter((one) => one.heading !== entry.heading && (one.quantity !== entry.quantity || entry.quantity === "ignore"));
  return format([...kept, entry]);
}
