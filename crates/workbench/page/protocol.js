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

/** @typedef {{p: [number, number], c: [number, number], t: [number, number], count: number, turns: number, way: number, rates: number[]}} Sweep */

/** @param {Rows} rows @returns {Sweep[]} */
function sweepsOf(rows) {
  const { pressure, contraction, sweep, time, direction, rate } = rows.of;
  /** @type {Map<number, Sweep>} */
  const sweeps = new Map();
  for (let i = 0; i < rows.count; i += 1) {
    const its = sweeps.get(sweep[i]) ?? { p: [Infinity, -Infinity], c: [Infinity, -Infinity], t: [Infinity, -Infinity], count: 0, turns: 0, way: 0, rates: [] };
    for (const [range, value] of /** @type {[[number, number], number][]} */ ([[its.p, pressure[i]], [its.c, contraction[i]], [its.t, time ? time[i] : 0]])) {
      range[0] = Math.min(range[0], value);
      range[1] = Math.max(range[1], value);
    }
    its.count += 1;
    const way = direction ? direction[i] : 0;
    if (way && its.way && way !== its.way) its.turns += 1;
    if (way) its.way = way;
    if (rate && Number.isFinite(rate[i])) its.rates.push(Math.abs(rate[i]));
    sweeps.set(sweep[i], its);
  }
  return [...sweeps.values()];
}

const spread = (/** @type {[number, number]} */ [low, high]) => high - low;
const ends = (/** @type {[number, number][]} */ of) => /** @type {[number, number]} */ ([Math.min(...of.map((one) => one[0])), Math.max(...of.map((one) => one[1]))]);
const middle = (/** @type {number[]} */ values) => values.sort((a, b) => a - b)[Math.floor(values.length / 2)];

/** How all of some sweeps move. @param {Sweep[]} all @param {boolean} isTimed @returns {Partial<Block>} */
function motionOf(all, isTimed) {
  if (!isTimed) return { path: "static", rows: Math.max(2, Math.min(1000, middle(all.map((one) => one.count)))), period_s: 0 };
  // To and fro is one turn.
  const cycles = Math.max(1, middle(all.map((one) => Math.round((one.turns + 1) / 2))));
  const period = middle(all.map((one) => spread(one.t))) / cycles;
  // The mean speed of a sine is 2/pi of its largest one; at even speed both are alike.
  const evenness = middle(all.filter((one) => one.rates.length > 4).map(({ rates }) => rates.reduce((sum, one) => sum + one, 0) / rates.length / [...rates].sort((a, b) => a - b)[Math.floor(0.95 * rates.length)]));
  return { path: evenness < 0.8 ? "sine" : "triangle", cycles, period_s: period > 0 ? round(period) : 60, rows: Math.max(8, Math.min(1000, Math.round(middle(all.map((one) => one.count)) / cycles))) };
}

/** The test that was made, about: what each sweep holds, and what it goes over; one block for all pressures with the same range. @param {Rows} rows @returns {Block[]} */
export function asMeasured(rows) {
  const all = sweepsOf(rows);
  const isTimed = Boolean(rows.of.time);
  const [p, c] = [ends(all.map((one) => one.p)), ends(all.map((one) => one.c))];
  const share = (/** @type {number} */ percent) => round(percent) / 100;
  if (all.every((one) => spread(one.c) <= HELD * spread(c)) || spread(c) < 1e-3) {
    const held = levels(all.map((one) => (one.c[0] + one.c[1]) / 2), Math.max(spread(c), 1));
    return [block({ ...motionOf(all, true), held: held.map((value) => value / 100), pressures_pa: p.map((bar) => 1e5 * Math.max(0.01, round(bar))), contraction: [share(c[0]), share(c[1])] })];
  }
  const isHeldPressure = (/** @type {Sweep} */ one) => spread(one.p) <= HELD * Math.max(spread(p), one.p[1]);
  const isobaric = all.filter(isHeldPressure);
  /** @type {Map<string, Sweep[]>} */
  const alike = new Map();
  for (const one of isobaric) {
    const name = one.c.map((value) => Math.round((20 * value) / Math.max(spread(c), 1e-9))).join(" ");
    alike.set(name, [...(alike.get(name) ?? []), one]);
  }
  const groups = alike.size && alike.size <= MOST_LEVELS ? [...alike.values()] : [isobaric.length ? isobaric : all];
  return groups.map((group) => {
    const means = group.filter(isHeldPressure).map((one) => (one.p[0] + one.p[1]) / 2);
    const range = ends(group.map((one) => one.c));
    const pressures = levels(means.length ? means : [p[0], (p[0] + p[1]) / 2, p[1]], Math.max(spread(p), 1)).filter((bar) => bar > 0);
    return block({ ...motionOf(group, isTimed), pressures_pa: pressures.map((bar) => 1e5 * bar), contraction: [share(range[0]), share(range[1])] });
  });
}
