// @ts-check
// A test before it is made: its blocks as the server takes them, in SI units.

/** @typedef {"triangle" | "sine" | "static" | {stairs: {steps: number, hold_s: number}}} Path */
/** @typedef {{pressures_pa: number[], contraction: [number, number], held?: number[], path: Path, cycles: number, period_s: number, rows: number, repeats: number, specimens: number}} Block */
/** @typedef {{blocks: Block[], noise: Record<string, number>, steps: Record<string, number>, rig: string, pause_s: number, warming_k: number}} Protocol */

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

/** Seconds that it takes, without pauses. @param {Block} of */
export const duration = (of) => (isStatic(of) ? 0 : of.cycles * of.period_s * of.repeats * of.specimens * (isHeld(of) ? of.held?.length ?? 0 : of.pressures_pa.length));
