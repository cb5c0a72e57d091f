// @ts-check
// One axis of a plot: its range, its ticks, and where a value lies.

import { number } from "./format.js";

/** @typedef {{low: number, high: number, isLog: boolean}} Axis */

/** @param {Axis} axis @param {number} value a share of the axis, from 0 at its low end */
export function place(axis, value) {
  if (axis.isLog) return (Math.log(value) - Math.log(axis.low)) / (Math.log(axis.high) - Math.log(axis.low));
  return (value - axis.low) / (axis.high - axis.low);
}

/** @param {Axis} axis @param {number} share */
export function valueAt(axis, share) {
  if (axis.isLog) return Math.exp(Math.log(axis.low) + share * (Math.log(axis.high) - Math.log(axis.low)));
  return axis.low + share * (axis.high - axis.low);
}

/** The part between two shares. @param {Axis} axis @param {number} from @param {number} to @returns {Axis} */
export function part(axis, from, to) {
  const low = valueAt(axis, from);
  const high = valueAt(axis, to);
  const least = axis.isLog ? low * 1e-7 : Math.max(Math.abs(low), Math.abs(high)) * 1e-7;
  return high - low > least ? { low, high, isLog: axis.isLog } : axis;
}

/** All finite values, with a margin. @param {ArrayLike<number>[]} arrays @param {boolean} isLog @returns {Axis} */
export function around(arrays, isLog) {
  let low = Infinity;
  let high = -Infinity;
  for (const values of arrays) {
    for (let i = 0; i < values.length; i += 1) {
      const value = values[i];
      if (!Number.isFinite(value) || (isLog && value <= 0)) continue;
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  if (low > high) return isLog ? { low: 1, high: 10, isLog } : { low: 0, high: 1, isLog };
  if (isLog) {
    const margin = Math.max(1.02, (high / low) ** 0.04);
    return { low: low / margin, high: high * margin, isLog };
  }
  const margin = high > low ? 0.04 * (high - low) : Math.max(1e-3, 0.1 * Math.abs(high));
  return { low: low - margin, high: high + margin, isLog };
}

/** @param {Axis} axis @param {number} most @returns {number[]} */
export function ticks(axis, most) {
  return axis.isLog && axis.high / axis.low > 8 ? decades(axis, most) : even(axis.low, axis.high, most);
}

/** @param {number} low @param {number} high @param {number} most */
function even(low, high, most) {
  const rough = (high - low) / Math.max(1, most);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * ([1, 2, 5, 10].find((s) => s * power >= 0.75 * rough) ?? 10);
  const found = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i += 1) found.push(Number((i * step).toPrecision(12)));
  return found;
}

/** @param {Axis} axis @param {number} most */
function decades(axis, most) {
  const first = Math.floor(Math.log10(axis.low));
  const last = Math.ceil(Math.log10(axis.high));
  const within = (/** @type {number} */ v) => v >= axis.low && v <= axis.high;
  for (const steps of [[1, 2, 5], [1, 3], [1]]) {
    const found = [];
    for (let p = first; p <= last; p += 1) for (const step of steps) found.push(Number((step * 10 ** p).toPrecision(12)));
    const shown = found.filter(within);
    if (shown.length <= most + 1) return shown;
  }
  const stride = Math.max(1, Math.ceil((last - first) / most));
  return Array.from({ length: last - first + 1 }, (_, i) => 10 ** (first + i)).filter((v, i) => within(v) && i % stride === 0);
}

/** Text of a tick: as many decimals as its neighbours need. @param {number[]} all @returns {(value: number) => string} */
export function tickText(all) {
  const step = all.length > 1 ? Math.min(...all.slice(1).map((v, i) => v - all[i])) : 0;
  const largest = Math.max(...all.map(Math.abs), 0);
  return (value) => {
    if (value === 0) return "0";
    if (largest >= 1e6 || (step > 0 && step < 1e-4)) return number(value);
    if (step === 0) return String(Number(value.toPrecision(6))).replace("-", "−");
    const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
    const isEven = Math.abs(value / step - Math.round(value / step)) < 1e-6;
    return isEven ? value.toFixed(decimals).replace("-", "−") : number(value);
  };
}
