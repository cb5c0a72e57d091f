// @ts-check
// Numbers and words as the reports write them.

const NONE = "–";

/** Three significant digits, without an exponent where a person reads none. @param {number | null | undefined} value @param {number} [digits] */
export function number(value, digits = 3) {
  if (value === null || value === undefined || !Number.isFinite(value)) return NONE;
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e6 || size < 1e-4) return value.toExponential(digits - 1).replace("e+", "e").replace("-", "−");
  const rounded = Number(value.toPrecision(digits));
  const decimals = Math.max(0, digits - 1 - Math.floor(Math.log10(Math.abs(rounded))));
  return rounded.toFixed(decimals).replace("-", "−");
}

/** @param {number | null | undefined} value @param {string | null | undefined} unit @param {number} [digits] */
export function quantity(value, unit, digits = 3) {
  const text = number(value, digits);
  return unit && unit !== "1" && text !== NONE ? `${text} ${unit}` : text;
}

/** @param {number | null | undefined} value */
export const newtons = (value) => quantity(value, "N");

/** Both ends of an interval, with as many digits as tell them apart. @param {number} low @param {number} high */
export function interval(low, high) {
  const size = Math.max(Math.abs(low), Math.abs(high));
  const digits = high > low && size > 0 ? Math.min(7, Math.max(3, 2 + Math.ceil(Math.log10(size / (high - low))))) : 3;
  return `${number(low, digits)} to ${number(high, digits)}`;
}

/** @param {number} value with its sign */
export const signed = (value) => (value > 0 ? `+${number(value)}` : number(value));

/** @param {number} count @param {string} one @param {string} [many] */
export const counted = (count, one, many = `${one}s`) => `${count.toLocaleString("en").replaceAll(",", " ")} ${count === 1 ? one : many}`;

/** `pressure [bar]`. @param {string} name @param {string} unit */
export const labelled = (name, unit) => (unit && unit !== "1" ? `${name} [${unit}]` : name);

/** @param {number | null | undefined} share */
export const percent = (share) => (share === null || share === undefined ? NONE : `${number(share * 100, 2)} %`);

/** `12–48, 60 and 3 more`: sorted numbers as ranges. @param {ArrayLike<number>} sorted @param {number} [most] */
export function ranges(sorted, most = 3) {
  const found = [];
  for (let i = 0; i < sorted.length; ) {
    let end = i;
    while (end + 1 < sorted.length && sorted[end + 1] <= sorted[end] + 1) end += 1;
    found.push(sorted[i] === sorted[end] ? `${sorted[i]}` : `${sorted[i]}–${sorted[end]}`);
    i = end + 1;
  }
  const shown = found.slice(0, most).join(", ");
  return found.length > most ? `${shown} and ${found.length - most} more ranges` : shown;
}

/** A refusal without the excerpt of the file below it: the page marks the place itself. @param {string} says */
export const withoutExcerpt = (says) => says.split("\n").filter((line) => !/^\s*\d*\s*\|/.test(line)).map((line) => line.replace(/^\s*= /, "")).join("\n").trim();

/** What a document says, whether it is a sentence or an object around one. @param {any} item @returns {string} */
export function sentence(item) {
  if (typeof item === "string") return item;
  if (!item || typeof item !== "object") return "";
  for (const key of ["says", "sentence", "why", "reason", "about", "message"]) if (typeof item[key] === "string" && item[key]) return item[key];
  return "";
}
