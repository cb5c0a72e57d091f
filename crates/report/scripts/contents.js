// @ts-check
// What each plot shows of the rows: which columns, in which colours, with which lines.

import { cells } from "./cells.js";
import { inks, lineColour, signedColour, sweepColour } from "./palette.js";

/** @typedef {import("./rows.js").Rows} Rows */
/** @typedef {import("./plot.js").Content} Content */
/** @typedef {import("./plot.js").Group} Group */
/** @typedef {import("./plot.js").Line} Line */

/** More sweeps than this share colours with their neighbours. */
const MOST_COLOURS = 24;
/** Steps of the colours of residuals. */
const STEPS = 13;

/** Units of columns, where they have one. @param {Rows} rows @param {string} name */
export const unitOf = (rows, name) => rows.columns.find((column) => column.name === name)?.unit ?? (name === "residual" ? "N" : "");

/** @param {Rows} rows @param {string} name */
export const valuesOf = (rows, name) => (name === "residual" ? rows.residual : name === "row" ? Float32Array.from({ length: rows.count }, (_, i) => i) : rows.of[name]);

/** @param {Rows} rows @param {string} name @param {boolean} [isLog] */
function side(rows, name, isLog = false) {
  return { name: name === "measured" ? "force" : name, unit: unitOf(rows, name), isLog, values: valuesOf(rows, name) };
}

/** Which of the colours a sweep has. @param {Rows} rows @returns {(sweep: number) => number} */
function bucketOf(rows) {
  const count = Math.max(1, rows.sweeps.length);
  const colours = Math.min(count, MOST_COLOURS);
  return (sweep) => Math.min(colours - 1, Math.max(0, Math.floor((sweep * colours) / count)));
}

/** @param {Rows} rows */
export const colourCount = (rows) => Math.min(Math.max(1, rows.sweeps.length), MOST_COLOURS);

/** Rows that count, by sweep; those that don't, apart. @param {Rows} rows @returns {Group[]} */
export function bySweep(rows) {
  const { sweep, state } = rows.of;
  const bucket = bucketOf(rows);
  const colours = colourCount(rows);
  /** @type {number[][]} */
  const lists = Array.from({ length: colours }, () => []);
  for (let i = 0; i < rows.count; i += 1) if (state[i] === 1) lists[bucket(sweep[i])].push(i);
  // By number: sweeps of several files or specimens may have the same name.
  const groups = lists.map((list, i) => ({ name: `sweep ${i}`, colour: sweepColour(i, colours), rows: Uint32Array.from(list) }));
  return [...groups, ...aside(rows)].filter((group) => group.rows.length);
}

/** @param {Rows} rows @returns {Group[]} */
function aside(rows) {
  const { state } = rows.of;
  /** @type {number[]} */
  const left = [];
  for (let i = 0; i < rows.count; i += 1) if (state[i] !== 1) left.push(i);
  return left.length ? [{ name: "does not count", colour: inks().aside, rows: Uint32Array.from(left), isAside: true }] : [];
}

/** Rows of each colour with gaps (-1) between sweeps; static maps in the order of their abscissa. @param {Rows} rows @param {ArrayLike<number>} x @param {boolean} isPath */
function strokes(rows, x, isPath) {
  const { sweep, state } = rows.of;
  const bucket = bucketOf(rows);
  /** @type {Map<number, number[]>} */
  const runs = new Map();
  for (let i = 0; i < rows.count; i += 1) {
    if (state[i] !== 1) continue;
    const run = runs.get(sweep[i]);
    if (run) run.push(i);
    else runs.set(sweep[i], [i]);
  }
  /** @type {number[][]} */
  const found = Array.from({ length: colourCount(rows) }, () => []);
  for (const [name, run] of runs) {
    if (!isPath) run.sort((a, b) => x[a] - x[b]);
    found[bucket(name)].push(...run, -1);
  }
  return found.map((list) => Int32Array.from(list));
}

/**
 * Force against a column: points as measured, a line of the model for each sweep, the muscle as stated faintly.
 *
 * @param {Rows} rows
 * @param {string} against
 * @param {{isLog: boolean, isPath: boolean, hasEffects: boolean}} how
 * @returns {Content}
 */
export function force(rows, against, how) {
  const ink = inks();
  const x = side(rows, against);
  const isPath = how.isPath || against === "time";
  /** @type {Line[]} */
  const lines = [];
  strokes(rows, x.values, isPath).forEach((run, i) => {
    if (!run.length) return;
    lines.push({ name: `base ${i + 1}`, colour: ink.base, width: 1, isFaint: true, rows: run, y: rows.of.base });
    if (how.hasEffects) lines.push({ name: `model ${i + 1}`, colour: lineColour(i, colourCount(rows)), width: 1.5, rows: run, y: rows.of.model });
  });
  const extra = [rows.of.model, rows.of.base];
  return { x, y: side(rows, "measured", how.isLog), groups: bySweep(rows), lines, extra };
}

/** @param {Rows} rows @param {string} against @returns {Content} */
export function residual(rows, against) {
  return { x: side(rows, against), y: side(rows, "residual"), groups: bySweep(rows), lines: [], zero: true };
}

/** How the sweeps follow each other. @param {Rows} rows @returns {Content} */
export function sweeps(rows) {
  const isIsometric = rows.kind.length > 0 && rows.kind.every((kind) => kind === "isometric");
  return { x: side(rows, rows.of.time ? "time" : "row"), y: side(rows, isIsometric ? "pressure" : "contraction"), groups: bySweep(rows), lines: [] };
}

/** The residual that gets the full colour: all but one in fifty are smaller. @param {Rows} rows */
export function residualScale(rows) {
  const sizes = [];
  const every = Math.max(1, Math.floor(rows.count / 5000));
  for (let i = 0; i < rows.count; i += every) if (rows.of.state[i] === 1 && Number.isFinite(rows.residual[i])) sizes.push(Math.abs(rows.residual[i]));
  sizes.sort((a, b) => a - b);
  return sizes.length ? Math.max(sizes[Math.floor(0.98 * (sizes.length - 1))], 1e-9) : 1;
}

/** Residuals over pressure and contraction. @param {Rows} rows @param {boolean} inCells @param {number} scale @returns {Content} */
export function map(rows, inCells, scale) {
  /** @type {number[][]} */
  const lists = Array.from({ length: STEPS }, () => []);
  for (let i = 0; i < rows.count; i += 1) {
    if (rows.of.state[i] !== 1 || !Number.isFinite(rows.residual[i])) continue;
    const share = Math.min(1, Math.max(-1, rows.residual[i] / scale));
    lists[Math.round(((share + 1) / 2) * (STEPS - 1))].push(i);
  }
  const groups = lists.map((list, i) => ({ name: `residual ${i}`, size: Math.abs((2 * i) / (STEPS - 1) - 1), colour: signedColour((2 * i) / (STEPS - 1) - 1), rows: Uint32Array.from(list) }));
  // Large residuals of either sign lie over small ones.
  groups.sort((a, b) => a.size - b.size);
  /** @type {Content} */
  const content = { x: side(rows, "pressure"), y: side(rows, "contraction"), groups: [...groups, ...(inCells ? [] : aside(rows))].filter((group) => group.rows.length), lines: [] };
  if (inCells) {
    content.cells = cells(rows, scale);
    content.extraX = content.cells.data.flatMap((/** @type {number[]} */ cell) => cell.slice(0, 2));
  }
  return content;
}
