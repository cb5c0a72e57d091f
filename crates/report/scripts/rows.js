// @ts-check
// All rows of a comparison, as the program writes them (`bulge.rows/1`), and what is said of them.

import { counted, newtons, number, quantity, ranges, signed } from "./format.js";

/** @typedef {{name: string, unit: string}} ColumnName */

/**
 * @typedef {object} Rung a rung of the ladder, in the rows of a report
 * @property {string | null} added
 * @property {string} column of its force
 * @property {number} rmse_n
 */

/**
 * @typedef {object} Report what a report says beside the rows, because nobody can be asked
 * @property {number} all rows that there are
 * @property {number} every of so many rows one is here
 * @property {boolean} is_path
 * @property {number | null} noise_floor_n
 * @property {Rung[]} rungs
 */

/**
 * @typedef {object} Rows
 * @property {number} revision
 * @property {number} count
 * @property {ColumnName[]} columns
 * @property {Record<string, Float32Array>} of values of each column
 * @property {string[]} files
 * @property {string[]} specimens
 * @property {string[]} sweeps
 * @property {string[]} kind
 * @property {Float32Array} residual measured - model; NaN where the model has no state
 * @property {Report | null} report
 */

/** One array for each column. @param {ArrayBuffer} bytes @returns {Rows} */
export function decoded(bytes) {
  const length = new DataView(bytes).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 4, length)));
  const count = header.rows;
  /** @type {Record<string, Float32Array>} */
  const of = {};
  header.columns.forEach((/** @type {ColumnName} */ column, /** @type {number} */ i) => {
    of[column.name] = new Float32Array(bytes, 4 + length + 4 * count * i, count);
  });
  const { revision, columns, files, specimens, sweeps } = header;
  return {
    revision, count, columns, of, files, specimens, sweeps, kind: header.kind ?? [], report: header.report ?? null, residual: residualOf(of.measured, of.model),
  };
}

/** @param {Float32Array} measured @param {Float32Array} model */
function residualOf(measured, model) {
  const residual = new Float32Array(measured.length);
  for (let i = 0; i < residual.length; i += 1) residual[i] = measured[i] - model[i];
  return residual;
}

/** The same rows with another model. @param {Rows} rows @param {Float32Array} model its force @returns {Rows} */
export function withModel(rows, model) {
  return { ...rows, of: { ...rows.of, model }, residual: residualOf(rows.of.measured, model) };
}

/** What is known of a row, part by part. @param {Rows | null} rows @param {number} row @param {number | null | undefined} floor the noise floor [N] */
export function describe(rows, row, floor) {
  if (!rows || row >= rows.count) return [];
  const { of } = rows;
  const file = rows.files[of.file?.[row] ?? 0];
  const parts = [`line ${of.line[row]}${file ? ` of ${file}` : ""}`];
  if (rows.sweeps.length > 1) parts.push(`sweep ${rows.sweeps[of.sweep[row]] ?? of.sweep[row] + 1}`);
  parts.push(quantity(of.pressure[row], "bar"), quantity(of.contraction[row], "%"), newtons(of.measured[row]));
  const sigmas = floor ? ` (${number(rows.residual[row] / floor, 2)} σ)` : "";
  if (Number.isFinite(rows.residual[row])) parts.push(`residual ${signed(rows.residual[row])} N${sigmas}`);
  else parts.push("the model has no state here");
  if (of.state[row] === 0) parts.push("left out");
  if (of.state[row] === -1) parts.push("excluded by hand");
  return parts;
}

/** How many rows, and their lines in the file. @param {Rows} rows @param {number[]} those sorted */
export function linesOf(rows, those) {
  const { of } = rows;
  const files = new Set(those.map((row) => of.file?.[row] ?? 0));
  const lines = files.size === 1 ? `lines ${ranges(those.map((row) => of.line[row]))}` : `of ${files.size} files`;
  return `${counted(those.length, "row")}, ${lines}`;
}
