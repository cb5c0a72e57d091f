// @ts-check
// A test before it is made: its blocks as the server takes them, in SI units.

/** @typedef {import("./types.js").Rows} Rows */
/** @typedef {"triangle" | "sine" | "static" | {stairs: {steps: number, hold_s: number}}} Path */
/** @typedef {{pressures_pa: number[], contraction: [number, number], held?: number[], path: Path, cycles: number, period_s: number, rows: number, repeats: number, specimens: number}} Block */
/** @typedef {{blocks: Block[], noise: Record<string, number>, steps: Record<string, number>, rig: string, pause_s: number, warming_k: number}} Protocol */

/** Levels that are taken over from the data, at most. */
const MOST_LEVELS = 8;
/** Part of its range by which what a sweep holds may vary. */
const HELD = 0.1;

/** @param {Partial<Block>} part @returns {Block} */
export const block = (part) => ({ pressures_pa: [2e5], contraction: [0, 0.1], path: "triangle", cycles: 1, period_s: 60, rows: 50, repeats: 1, specimens: 1, ...part });

/** @param {Block[]} blocks @param {Record<string, number>} noise @returns {Protocol} */
export const protocol = (blocks, noise) => ({ blocks, noise, steps: {}, rig: "none", pause_s: 10, warming_k: 0 });

/** @param {Block} of */
export const isHeld = (of) => Boolean(of.held?.length);
/** @param {Block} of */
export const isStatic = (of) => of.path === "static";
/** @param {Block} of */
export const stairs = (of) => (typeof of.path === "object" ? of.path.stairs : null);
/** @param {Block} of @returns {[number, number]} */
export const pressureRange = (of) => [Math.min(...of.pressures_pa), Math.max(...of.pressures_pa)];

/** Two digits, as a person would set it. @param {number} value */
const round = (value) => Number(value.toPrecision(2));

/** Seconds that it takes, without pauses. @param {Block} of */
export const duration = (of) => (isStatic(of) ? 0 : of.cycles * of.period_s * of.repeats * of.specimens * (isHeld(of) ? of.held?.length ?? 0 : of.pressures_pa.length));

/** Values that differ, in their order; of many those that are spread over the range. @param {number[]} values @param {number} range */
function levels(values, range) {
  const sorted = [...values].sort((a, b) => a - b);
  const apart = sorted.filter((value, i) => i === 0 || value - sorted[i - 1] > 0.02 * range).map(round);
  const some = apart.length > MOST_LEVELS ? Array.from({ length: MOST_LEVELS }, (_, i) => apart[Math.round((i * (apart.length - 1)) / (MOST_LEVELS - 1))]) : apart;
  return [...new Set(some)];
}

/** The test that was made, about: what each sweep holds, and what it goes over. @param {Rows} rows @returns {Block} */
export function asMeasured(rows) {
  const { pressure, contraction, sweep, time, direction } = rows.of;
  /** @type {Map<number, {p: [number, number], c: [number, number], t: [number, number], count: number, turns: number, way: number}>} */
  const sweeps = new Map();
  for (let i = 0; i < rows.count; i += 1) {
    const its = sweeps.get(sweep[i]) ?? { p: [Infinity, -Infinity], c: [Infinity, -Infinity], t: [Infinity, -Infinity], count: 0, turns: 0, way: 0 };
    for (const [range, value] of /** @type {[[number, number], number][]} */ ([[its.p, pressure[i]], [its.c, contraction[i]], [its.t, time ? time[i] : 0]])) {
      range[0] = Math.min(range[0], value);
      range[1] = Math.max(range[1], value);
    }
    its.count += 1;
    const way = direction ? direction[i] : 0;
    if (way && its.way && way !== its.way) its.turns += 1;
    if (way) its.way = way;
    sweeps.set(sweep[i], its);
  }
  const all = [...sweeps.values()];
  const ends = (/** @type {[number, number][]} */ of) => /** @type {[number, number]} */ ([Math.min(...of.map((one) => one[0])), Math.max(...of.map((one) => one[1]))]);
  const [p, c] = [ends(all.map((one) => one.p)), ends(all.map((one) => one.c))];
  const spread = (/** @type {[number, number]} */ [low, high]) => high - low;
  const middle = (/** @type {number[]} */ values) => values.sort((a, b) => a - b)[Math.floor(values.length / 2)];
  // To and fro is one turn.
  const cycles = Math.max(1, middle(all.map((one) => Math.round((one.turns + 1) / 2))));
  const period = middle(all.map((one) => spread(one.t))) / cycles;
  const rest = { cycles, period_s: period > 0 ? round(period) : 60, rows: Math.max(8, Math.min(1000, Math.round(middle(all.map((one) => one.count)) / cycles))) };
  const contractions = /** @type {[number, number]} */ (c.map((value) => round(value) / 100));
  if (all.every((one) => spread(one.c) <= HELD * spread(c)) || spread(c) < 1e-3) {
    const held = levels(all.map((one) => (one.c[0] + one.c[1]) / 2), Math.max(spread(c), 1));
    return block({ held: held.map((value) => value / 100), pressures_pa: p.map((bar) => 1e5 * Math.max(0.01, round(bar))), contraction: contractions, ...rest });
  }
  const means = all.filter((one) => spread(one.p) <= HELD * Math.max(spread(p), one.p[1])).map((one) => (one.p[0] + one.p[1]) / 2);
  const pressures = levels(means.length ? means : [p[0], (p[0] + p[1]) / 2, p[1]], Math.max(spread(p), 1)).filter((bar) => bar > 0);
  return block({ pressures_pa: pressures.map((bar) => 1e5 * bar), contraction: contractions, ...(time ? rest : { path: "static", rows: 20 }) });
}
