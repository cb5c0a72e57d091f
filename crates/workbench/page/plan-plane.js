// @ts-check
// Contraction over pressure, as the map of residuals: what was measured, the blocks of a test, and a new one that is drawn by dragging.

import { h, svg } from "./dom.js";
import { inks, sweepColour } from "./palette.js";
import { block, isHeld, isStatic, pressureRange } from "./protocol.js";

/** @typedef {import("./protocol.js").Block} Block */
/** @typedef {import("./types.js").Rows} Rows */

const [WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM] = [320, 220, 30, 8, 8, 30];
/** Rows that are drawn, at most. */
const MOST_ROWS = 500;
/** Length of a drag that means something. */
const LEAST = 7;
/** Part of the range that is free on either side, so that a test can go beyond the data. */
const ROOM = 0.18;

/** @param {number} low @param {number} high @param {number} count */
function ticks(low, high, count) {
  const raw = (high - low) / count;
  const size = 10 ** Math.floor(Math.log10(raw));
  const step = size * ([1, 2, 5, 10].find((one) => one * size >= raw) ?? 10);
  const found = [];
  for (let at = Math.ceil(low / step) * step; at <= high + 1e-9 * step; at += step) found.push(Number(at.toPrecision(12)));
  return found;
}

/** Pressure [bar] and contraction [%] that are shown. @param {Rows | null} rows @param {Block[]} blocks */
function ranges(rows, blocks) {
  const xs = blocks.flatMap((one) => one.pressures_pa.map((value) => value / 1e5));
  const ys = blocks.flatMap((one) => (isHeld(one) ? one.held ?? [] : one.contraction).map((value) => 100 * value));
  if (rows) for (let i = 0; i < rows.count; i += 1) {
    xs.push(rows.of.pressure[i]);
    ys.push(rows.of.contraction[i]);
  }
  const wide = (/** @type {number[]} */ all, /** @type {number} */ usual) => {
    let [low, high] = [Infinity, -Infinity];
    for (const value of all) if (Number.isFinite(value)) [low, high] = [Math.min(low, value), Math.max(high, value)];
    if (low > high) [low, high] = [0, usual];
    const room = Math.max(ROOM * (high - low), 0.05 * Math.abs(high), 0.1);
    return [low - room, high + room];
  };
  const [x, y] = [wide(xs, 5), wide(ys, 25)];
  return { x: [Math.max(0, x[0]), x[1]], y };
}

/** Colour of a block. @param {number} i @param {number} n */
export const blockColour = (i, n) => sweepColour(i, Math.max(n, 2));

/**
 * @param {{rows: Rows | null, blocks: Block[], usual: Block, add: (made: Block) => void}} of `usual`: what a new block has besides its range
 */
export function plane({ rows, blocks, usual, add }) {
  const { x, y } = ranges(rows, blocks);
  const ink = inks();
  const toX = (/** @type {number} */ value) => LEFT + ((value - x[0]) / (x[1] - x[0])) * (WIDTH - LEFT - RIGHT);
  const toY = (/** @type {number} */ value) => HEIGHT - BOTTOM - ((value - y[0]) / (y[1] - y[0])) * (HEIGHT - TOP - BOTTOM);
  const ofX = (/** @type {number} */ at) => x[0] + ((at - LEFT) / (WIDTH - LEFT - RIGHT)) * (x[1] - x[0]);
  const ofY = (/** @type {number} */ at) => y[0] + ((HEIGHT - BOTTOM - at) / (HEIGHT - TOP - BOTTOM)) * (y[1] - y[0]);
  const root = svg("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, id: "plan-plane", class: "plane", role: "img", "aria-label": "The test over pressure and contraction; drag to draw a block, or use the fields below" });
  const line = (/** @type {number[]} */ [x1, y1, x2, y2], /** @type {Record<string, string | number>} */ more) => root.append(svg("line", { x1, y1, x2, y2, ...more }));
  const text = (/** @type {number} */ at, /** @type {number} */ up, /** @type {string} */ says, /** @type {Record<string, string | number>} */ more) => {
    const element = svg("text", { x: at, y: up, fill: ink.soft, "font-size": 10, ...more });
    element.textContent = says;
    root.append(element);
  };
  for (const at of ticks(x[0], x[1], 5)) {
    line([toX(at), TOP, toX(at), HEIGHT - BOTTOM], { stroke: ink.grid });
    text(toX(at), HEIGHT - BOTTOM + 12, String(at), { "text-anchor": "middle" });
  }
  for (const at of ticks(y[0], y[1], 4)) {
    line([LEFT, toY(at), WIDTH - RIGHT, toY(at)], { stroke: ink.grid });
    text(LEFT - 4, toY(at) + 3, String(at), { "text-anchor": "end" });
  }
  text(WIDTH - RIGHT, HEIGHT - 4, "pressure [bar]", { "text-anchor": "end" });
  text(LEFT + 3, TOP + 9, "contraction [%]", {});
  if (rows) {
    const stride = Math.max(1, Math.ceil(rows.count / MOST_ROWS));
    for (let i = 0; i < rows.count; i += stride) root.append(svg("circle", { cx: toX(rows.of.pressure[i]).toFixed(1), cy: toY(rows.of.contraction[i]).toFixed(1), r: 1.4, fill: ink.aside, "fill-opacity": 0.6 }));
  }
  blocks.forEach((one, i) => {
    const look = { stroke: blockColour(i, blocks.length), "stroke-width": 2.2, "stroke-linecap": "round", "stroke-dasharray": typeof one.path === "object" ? "5 5" : isStatic(one) ? "0.1 6" : "none" };
    const [low, high] = pressureRange(one);
    if (isHeld(one)) for (const held of one.held ?? []) line([toX(low / 1e5), toY(100 * held), toX(high / 1e5), toY(100 * held)], look);
    else for (const pressure of one.pressures_pa) line([toX(pressure / 1e5), toY(100 * one.contraction[0]), toX(pressure / 1e5), toY(100 * one.contraction[1])], look);
  });
  const band = svg("rect", { fill: ink.alert, "fill-opacity": 0.12, stroke: ink.alert, visibility: "hidden" });
  root.append(band);

  /** @type {{x: number, y: number} | null} */
  let start = null;
  const at = (/** @type {PointerEvent} */ event) => {
    const box = root.getBoundingClientRect();
    const clamp = (/** @type {number} */ value, /** @type {number} */ low, /** @type {number} */ high) => Math.min(high, Math.max(low, value));
    return { x: clamp(((event.clientX - box.left) / box.width) * WIDTH, LEFT, WIDTH - RIGHT), y: clamp(((event.clientY - box.top) / box.height) * HEIGHT, TOP, HEIGHT - BOTTOM) };
  };
  root.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    start = at(event);
    root.setPointerCapture(event.pointerId);
  });
  root.addEventListener("pointermove", (event) => {
    if (!start) return;
    const now = at(event);
    for (const [name, value] of Object.entries({ x: Math.min(start.x, now.x), y: Math.min(start.y, now.y), width: Math.abs(now.x - start.x), height: Math.abs(now.y - start.y), visibility: "visible" })) band.setAttribute(name, String(value));
  });
  root.addEventListener("pointercancel", () => {
    start = null;
    band.setAttribute("visibility", "hidden");
  });
  root.addEventListener("pointerup", (event) => {
    if (!start) return;
    const [from, to] = [start, at(event)];
    start = null;
    band.setAttribute("visibility", "hidden");
    const made = drawn([ofX(Math.min(from.x, to.x)), ofX(Math.max(from.x, to.x))], [ofY(Math.max(from.y, to.y)), ofY(Math.min(from.y, to.y))], [Math.abs(to.x - from.x), Math.abs(to.y - from.y)], usual);
    if (made) add(made);
  });
  return h("div", { class: "plane-room" }, root);
}

/**
 * A block from a drag: along the contraction one pressure, along the pressure a held length, a rectangle three pressures.
 *
 * @param {number[]} x pressure [bar] @param {number[]} y contraction [%] @param {number[]} size of the drag on the screen @param {Block} usual
 * @returns {Block | null}
 */
function drawn(x, y, [wide, high], usual) {
  const percent = (/** @type {number} */ value) => Number((value / 100).toFixed(3));
  const pascal = (/** @type {number} */ value) => Math.max(1e4, Math.round(value * 10) * 1e4);
  const moving = isHeld(usual) || isStatic(usual) ? block({ period_s: usual.period_s || 60 }) : usual;
  if (wide < LEAST && high < LEAST) return null;
  if (high < LEAST) return block({ ...moving, path: "triangle", held: [percent((y[0] + y[1]) / 2)], pressures_pa: [pascal(x[0]), pascal(x[1])] });
  const contraction = /** @type {[number, number]} */ ([percent(y[0]), percent(y[1])]);
  const pressures = wide < LEAST ? [(x[0] + x[1]) / 2] : [x[0], (x[0] + x[1]) / 2, x[1]];
  return block({ ...moving, held: [], contraction, pressures_pa: pressures.map(pascal) });
}
