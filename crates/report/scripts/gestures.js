// @ts-check
// Hand and keyboard on a plot: wheel zooms, drag pans or brushes, a double click goes back; arrows and + - do the same, [ and ] go from row to row, Enter selects.

import { part } from "./axis.js";

/** @typedef {import("./plot.js").Plot} Plot */
/** @typedef {"pan" | "rectangle" | "lasso"} Tool */
/** @typedef {"replace" | "add" | "take"} How */

/** Pixels within which the pointer finds a row. */
const REACH = 16;

/**
 * @param {Plot} plot
 * @param {object} does
 * @param {boolean} does.scrolls whether the wheel is the page's until the plot is clicked
 * @param {() => Tool} does.tool
 * @param {(rows: number[], how: How) => void} does.brushed
 * @param {(row: number | null, px: number, py: number) => void} does.hovered
 */
export function listen(plot, does) {
  const area = plot.element;
  area.tabIndex = 0;
  /** @type {{tool: Tool, how: How, points: [number, number][], from: [number, number]} | null} */
  let drag = null;

  const at = (/** @type {MouseEvent} */ event) => /** @type {[number, number]} */ ([event.clientX - area.getBoundingClientRect().left, event.clientY - area.getBoundingClientRect().top]);

  area.addEventListener("wheel", (event) => {
    if (!plot.content || (does.scrolls && document.activeElement !== area && !event.ctrlKey)) return;
    event.preventDefault();
    const [px, py] = at(event);
    zoom(plot, 1.0015 ** Math.max(-400, Math.min(400, event.deltaY * (event.deltaMode === 1 ? 30 : 1))), px, py);
  }, { passive: false });

  area.addEventListener("pointerdown", (event) => {
    if (event.button !== 0 || !plot.content) return;
    const from = at(event);
    const tool = event.shiftKey && does.tool() === "pan" ? "rectangle" : does.tool();
    drag = { tool, how: event.altKey ? "take" : event.ctrlKey || event.metaKey ? "add" : "replace", points: [from], from };
    area.setPointerCapture(event.pointerId);
    area.classList.add("dragging");
  });

  area.addEventListener("pointermove", (event) => {
    const [px, py] = at(event);
    if (!drag) {
      does.hovered(nearest(plot, px, py), px, py);
      return;
    }
    if (drag.tool === "pan") {
      pan(plot, px - drag.from[0], py - drag.from[1]);
      drag.from = [px, py];
      return;
    }
    drag.points.push([px, py]);
    plot.brush.setAttribute("d", outline(drag));
  });

  const end = (/** @type {PointerEvent} */ event) => {
    if (!drag) return;
    const done = drag;
    drag = null;
    area.classList.remove("dragging");
    plot.brush.setAttribute("d", "");
    if (done.tool === "pan" || event.type === "pointercancel") return;
    const [px, py] = at(event);
    const isClick = Math.abs(px - done.from[0]) + Math.abs(py - done.from[1]) < 4 && done.points.length < 6;
    const row = isClick ? nearest(plot, px, py) : null;
    does.brushed(isClick ? (row === null ? [] : [row]) : inside(plot, done), done.how);
  };
  area.addEventListener("pointerup", end);
  area.addEventListener("pointercancel", end);
  area.addEventListener("pointerleave", () => does.hovered(null, 0, 0));
  area.addEventListener("dblclick", () => plot.reset());

  /** The keyboard's pointer: the next row of the file. @param {number} by */
  const stepTo = (by) => {
    const count = plot.content?.x.values.length ?? 0;
    if (!count) return;
    const row = ((plot.hovered ?? (by > 0 ? -1 : 0)) + by + count) % count;
    const to = plot.projection();
    does.hovered(row, to.x(row), to.y(row));
  };

  area.addEventListener("keydown", (event) => {
    if (!plot.content) return;
    const { left, top, width, height } = plot.box;
    const middle = /** @type {[number, number]} */ ([left + width / 2, top + height / 2]);
    const step = 0.1;
    const moves = /** @type {Record<string, () => void>} */ ({
      ArrowLeft: () => pan(plot, step * width, 0), ArrowRight: () => pan(plot, -step * width, 0), ArrowUp: () => pan(plot, 0, step * height), ArrowDown: () => pan(plot, 0, -step * height),
      "+": () => zoom(plot, 0.8, ...middle), "=": () => zoom(plot, 0.8, ...middle), "-": () => zoom(plot, 1.25, ...middle), 0: () => plot.reset(),
    });
    const by = /** @type {Record<string, number>} */ ({ "]": 1, "[": -1 })[event.key];
    if (by) {
      stepTo(by);
      return;
    }
    if (event.key === "Enter" && plot.hovered !== null) {
      does.brushed([plot.hovered], "add");
      return;
    }
    const move = moves[event.key];
    if (!move || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    move();
  });
}

/** Beside the axes only one of them is zoomed. @param {Plot} plot @param {number} factor @param {number} px @param {number} py */
export function zoom(plot, factor, px, py) {
  const { left, top, width, height } = plot.box;
  const sx = Math.min(1, Math.max(0, (px - left) / width));
  const sy = Math.min(1, Math.max(0, 1 - (py - top) / height));
  const { x, y } = plot.view;
  plot.move({
    x: px < left ? x : part(x, sx - sx * factor, sx + (1 - sx) * factor),
    y: py > top + height ? y : part(y, sy - sy * factor, sy + (1 - sy) * factor),
  });
}

/** @param {Plot} plot @param {number} dx @param {number} dy */
function pan(plot, dx, dy) {
  const { width, height } = plot.box;
  const { x, y } = plot.view;
  plot.move({ x: part(x, -dx / width, 1 - dx / width), y: part(y, dy / height, 1 + dy / height) });
}

/** The row whose point is nearest to the pointer. @param {Plot} plot @param {number} px @param {number} py @returns {number | null} */
export function nearest(plot, px, py) {
  if (!plot.content) return null;
  const to = plot.projection();
  let best = null;
  let least = REACH ** 2;
  for (const group of plot.content.groups) {
    for (let i = 0; i < group.rows.length; i += 1) {
      const distance = (to.x(group.rows[i]) - px) ** 2 + (to.y(group.rows[i]) - py) ** 2;
      if (distance < least) {
        least = distance;
        best = group.rows[i];
      }
    }
  }
  return best;
}

/** @param {{tool: Tool, points: [number, number][], from: [number, number]}} drag */
function outline(drag) {
  const [x1, y1] = drag.points[drag.points.length - 1];
  const [x0, y0] = drag.from;
  if (drag.tool === "rectangle") return `M${x0} ${y0}H${x1}V${y1}H${x0}Z`;
  return `M${drag.points.map(([x, y]) => `${x} ${y}`).join("L")}Z`;
}

/** @param {Plot} plot @param {{tool: Tool, points: [number, number][], from: [number, number]}} drag @returns {number[]} */
function inside(plot, drag) {
  const [x0, y0] = drag.from;
  const [x1, y1] = drag.points[drag.points.length - 1];
  const xs = drag.tool === "rectangle" ? [x0, x1] : drag.points.map((p) => p[0]);
  const ys = drag.tool === "rectangle" ? [y0, y1] : drag.points.map((p) => p[1]);
  const [left, right, top, bottom] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
  const to = plot.projection();
  const found = [];
  for (const group of plot.content?.groups ?? []) {
    for (let i = 0; i < group.rows.length; i += 1) {
      const [x, y] = [to.x(group.rows[i]), to.y(group.rows[i])];
      if (!(x >= left && x <= right && y >= top && y <= bottom)) continue;
      if (drag.tool === "rectangle" || isWithin(drag.points, x, y)) found.push(group.rows[i]);
    }
  }
  return found.sort((a, b) => a - b);
}

/** Whether a polygon holds a point: a ray crosses its sides an odd number of times. @param {[number, number][]} polygon @param {number} x @param {number} y */
function isWithin(polygon, x, y) {
  let isIn = false;
  for (let i = 0, j = polygon.length - 1; i < polygon.length; j = i, i += 1) {
    const [xi, yi] = polygon[i];
    const [xj, yj] = polygon[j];
    if (yi > y !== yj > y && x < ((xj - xi) * (y - yi)) / (yj - yi) + xi) isIn = !isIn;
  }
  return isIn;
}
