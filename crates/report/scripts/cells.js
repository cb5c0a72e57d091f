// @ts-check
// The residual map in cells: means over pressure and contraction. Where the pressure was held at levels, each level is a column of its own.

import { signedColour } from "./palette.js";

/** @typedef {import("./rows.js").Rows} Rows */

/** Cells along the pressure, where it has no levels, and along the contraction. */
const MOST = [28, 22];
/** More levels than this are a range. */
const MOST_LEVELS = 14;
/** Pressures further apart than this share of their range are of two levels. */
const GAP = 0.035;

/** @param {Float32Array} values @returns {[number, number]} */
function extent(values) {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) {
    if (value < low) low = value;
    if (value > high) high = value;
  }
  return high > low ? [low, high] : [low - 0.5, low + 0.5];
}

/** @param {[number, number]} range @param {number} count @returns {[number, number][]} */
const even = ([low, high], count) => Array.from({ length: count }, (_, i) => [low + ((high - low) * i) / count, low + ((high - low) * (i + 1)) / count]);

/** Columns of cells: around each level that was held, or even ones. @param {Float32Array} pressure @returns {[number, number][]} */
export function columnsOf(pressure) {
  const range = extent(pressure);
  // Some thousand readings show the levels as well as all of them.
  const every = Math.ceil(pressure.length / 4000);
  const sorted = pressure.filter((_, i) => i % every === 0).sort();
  const least = GAP * (range[1] - range[0]);
  /** @type {[number, number][]} */
  const levels = [];
  for (const value of sorted) {
    const last = levels.at(-1);
    if (last && value - last[1] <= least) last[1] = value;
    else levels.push([value, value]);
    if (levels.length > MOST_LEVELS) return even(range, MOST[0]);
  }
  if (levels.length < 2) return even(range, MOST[0]);
  const middles = levels.map(([low, high]) => (low + high) / 2);
  const apart = Math.min(...middles.slice(1).map((middle, i) => middle - middles[i]));
  const widest = Math.max(...levels.map(([low, high]) => high - low));
  if (widest > 0.8 * apart) return even(range, MOST[0]);
  return levels.map(([low, high], i) => [Math.min(low, middles[i] - 0.22 * apart), Math.max(high, middles[i] + 0.22 * apart)]);
}

/** Mean residual of each cell, as a series that draws rectangles. @param {Rows} rows @param {number} scale */
export function cells(rows, scale) {
  const { pressure, contraction, state } = rows.of;
  const columns = columnsOf(pressure);
  const dividers = columns.slice(1).map(([start], i) => (columns[i][1] + start) / 2);
  const [low, high] = extent(contraction);
  const layers = MOST[1];
  const sums = new Float64Array(columns.length * layers);
  const counts = new Uint32Array(sums.length);
  for (let i = 0; i < rows.count; i += 1) {
    if (state[i] !== 1 || !Number.isFinite(rows.residual[i])) continue;
    let column = 0;
    while (column < dividers.length && pressure[i] > dividers[column]) column += 1;
    const layer = Math.min(layers - 1, Math.max(0, Math.floor(((contraction[i] - low) / (high - low)) * layers)));
    const at = column * layers + layer;
    sums[at] += rows.residual[i];
    counts[at] += 1;
  }
  const data = [];
  for (let i = 0; i < sums.length; i += 1) {
    if (!counts[i]) continue;
    const layer = i % layers;
    const edge = (/** @type {number} */ k) => low + ((high - low) * k) / layers;
    data.push([...columns[Math.floor(i / layers)], edge(layer), edge(layer + 1), sums[i] / counts[i] / scale]);
  }
  return {
    type: "custom", id: "cells", name: "cells", data, silent: true, clip: true, z: 3, encode: { x: [0, 1], y: [2, 3] },
    renderItem: (/** @type {unknown} */ _, /** @type {any} */ api) => {
      const [left, bottom] = api.coord([api.value(0), api.value(2)]);
      const [right, top] = api.coord([api.value(1), api.value(3)]);
      // A quarter of a pixel more on each side leaves no seams.
      return { type: "rect", shape: { x: left - 0.25, y: top - 0.25, width: right - left + 0.5, height: bottom - top + 0.5 }, style: { fill: signedColour(api.value(4)) } };
    },
  };
}
