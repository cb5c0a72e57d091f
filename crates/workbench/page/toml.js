// @ts-check
// The numbers of a muscle file: found where they stand and replaced there, so that comments and everything unknown stay as they are.

/** @typedef {{key: string, table: string, value: string, from: number, to: number, isText: boolean}} Field */

/** A number, with or without a unit and a width: `250 mm +- 0.5 mm`; a name such as "20 mm braid" is none. */
const NUMBER = /^\s*[-+]?(\d[\d_]*\.?\d*|\.\d+)(e[-+]?\d+)?(\s*[^\s\d,;+][^\s,;+]*)?(\s*(\+-|±).*)?\s*$/i;

/**
 * The fields `key = value` whose value is a number, or a text that begins with one; of inline tables each pair.
 *
 * @param {string} text
 * @returns {Field[]}
 */
export function numbersOf(text) {
  /** @type {Field[]} */
  const found = [];
  let table = "";
  let at = 0;
  for (const line of text.split("\n")) {
    const head = /^\s*\[([^[\]]+)\]\s*(#.*)?$/.exec(line);
    const pair = /^(\s*([A-Za-z0-9_.-]+)\s*=\s*)(.*)$/.exec(line);
    if (head) table = head[1].trim();
    else if (pair) {
      const start = at + pair[1].length;
      if (pair[3].trimStart().startsWith("{")) inline(pair[3], start, [table, pair[2]].filter(Boolean).join("."), found);
      else value(pair[3], start, pair[2], table, found);
    }
    at += line.length + 1;
  }
  return found;
}

/** @param {string} rest what stands behind the equals sign @param {number} start @param {string} key @param {string} table @param {Field[]} found */
function value(rest, start, key, table, found) {
  const quoted = /^(["'])(.*?)\1/.exec(rest);
  if (quoted) {
    if (NUMBER.test(quoted[2])) found.push({ key, table, value: quoted[2], from: start + 1, to: start + 1 + quoted[2].length, isText: true });
    return;
  }
  const plain = /^[^\s,#}\]]+/.exec(rest);
  if (plain && NUMBER.test(plain[0])) found.push({ key, table, value: plain[0], from: start, to: start + plain[0].length, isText: false });
}

/** @param {string} rest @param {number} start @param {string} table @param {Field[]} found */
function inline(rest, start, table, found) {
  for (const pair of rest.matchAll(/([A-Za-z0-9_-]+)\s*=\s*(?=["'\d.+-])/g)) value(rest.slice(pair.index + pair[0].length), start + pair.index + pair[0].length, pair[1], table, found);
}

/** @param {string} text @param {Field} field @param {string} next */
export function replaced(text, field, next) {
  // A number that gets a unit becomes a text.
  const isPlain = field.isText || /^[-+]?[\d_.]+(e[-+]?\d+)?$/i.test(next);
  const safe = next.replaceAll('"', "").replaceAll("\\", "").replaceAll("\n", " ");
  return text.slice(0, field.from) + (isPlain ? safe : `"${safe}"`) + text.slice(field.to);
}

/** The field that a sentence of the server names, such as "`length` is -0.25 m: ...". @param {Field[]} fields @param {string} says */
export function fieldNamed(fields, says) {
  const names = [...says.matchAll(/`([^`]+)`/g)].map((match) => match[1].split(/[\s=]/)[0]);
  for (const name of names) {
    const field = fields.find((one) => one.key === name || `${one.table}.${one.key}` === name);
    if (field) return field;
  }
  return undefined;
}
