// @ts-check
// One plot: points in coloured groups, lines, a marked selection. ECharts draws; ranges, ticks and places are the page's own,
// so that zooming only moves the axes, and brushing and hovering need no question to the chart.

import { around, place, ticks, tickText, valueAt } from "./axis.js";
import { svg } from "./dom.js";
import { labelled } from "./format.js";
import { inks } from "./palette.js";
import { init } from "./vendor/echarts.js";

/** @typedef {import("./axis.js").Axis} Axis */
/** @typedef {{name: string, colour: string, rows: ArrayLike<number>, isAside?: boolean}} Group */
/** @typedef {{name: string, colour: string, width: number, isFaint?: boolean, rows: ArrayLike<number>, y: ArrayLike<number>}} Line */
/** @typedef {{name: string, unit: string, isLog: boolean, values: ArrayLike<number>}} Side */
/** @typedef {{x: Side, y: Side, groups: Group[], lines: Line[], zero?: boolean, extra?: ArrayLike<number>[], extraX?: ArrayLike<number>, cells?: any}} Content */

/** More points than this are thinned while the axes move. */
export const MOST_MOVING = 6000;
/** More points than this are drawn as small squares, which is faster. Fewer are circles, all in one path (the "large" mode of ECharts): a shape for each takes longer. */
const LARGE = 2500;
const REST_MS = 180;
/** Contents that follow each other faster than this are those of a slider. */
const RAPID_MS = 700;

export class Plot {
  /** @param {HTMLElement} element @param {{small?: boolean}} [how] */
  constructor(element, how = {}) {
    this.element = element;
    this.isSmall = how.small ?? false;
    this.canvas = document.createElement("div");
    this.canvas.className = "canvas";
    this.overlay = /** @type {SVGSVGElement} */ (svg("svg", { class: "overlay", "aria-hidden": "true" }));
    this.marker = svg("circle", { r: 6, class: "hovered", visibility: "hidden" });
    this.brush = svg("path", { class: "brush", d: "" });
    this.overlay.append(this.brush, this.marker);
    this.note = document.createElement("p");
    this.note.className = "note";
    element.append(this.canvas, this.overlay, this.note);
    this.chart = init(this.canvas, null, { renderer: "canvas" });
    /** @type {Content | null} */
    this.content = null;
    /** @type {{x: Axis, y: Axis}} */
    this.home = { x: { low: 0, high: 1, isLog: false }, y: { low: 0, high: 1, isLog: false } };
    this.view = this.home;
    this.isZoomed = false;
    this.isThin = false;
    /** @type {ArrayLike<number>} */
    this.selected = [];
    /** @type {number | null} */
    this.hovered = null;
    this.restTimer = 0;
    this.shownAt = -Infinity;
    this.frame = 0;
    new ResizeObserver(() => this.resize()).observe(element);
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.element;
    if (!width || !height) return;
    this.chart.resize({ width, height });
    if (this.content) this.chart.setOption(this.axes());
    this.mark(this.hovered);
  }

  /** Where the axes enclose the data. */
  get box() {
    const { clientWidth: width, clientHeight: height } = this.element;
    return this.isSmall
      ? { left: 40, top: 8, width: width - 50, height: height - 42 }
      : { left: 58, top: 10, width: width - 72, height: height - 56 };
  }

  /** @param {Content} content @param {boolean} [isNew] whether a zoom into what was there before is left */
  show(content, isNew = false) {
    this.content = content;
    // Rows that don't count, such as spikes, would make all others small.
    const counting = content.groups.filter((group) => !group.isAside).map((group) => group.rows);
    const of = (/** @type {ArrayLike<number>} */ values) => (counting.length ? counting.map((rows) => at(values, rows)) : [values]);
    this.home = {
      x: around([...of(content.x.values), content.extraX ?? []], content.x.isLog),
      y: around([...of(content.y.values), ...(content.extra ?? []).flatMap(of)], content.y.isLog),
    };
    if (content.zero && !content.y.isLog) {
      const { low, high } = this.home.y;
      this.home.y = { ...this.home.y, low: Math.min(low, -0.05 * high), high: Math.max(high, -0.05 * low) };
    }
    if (isNew || !this.isZoomed) this.reset(false);
    // While a slider is dragged one content follows the other: points are thinned until it is let go.
    const now = performance.now();
    this.isThin = now - this.shownAt < RAPID_MS && this.isMany();
    this.shownAt = now;
    this.draw();
    if (this.isThin) this.restAfter(RAPID_MS);
  }

  /** @param {number} ms */
  restAfter(ms) {
    clearTimeout(this.restTimer);
    this.restTimer = window.setTimeout(() => this.rest(), ms);
  }

  /** @param {boolean} [andDraw] */
  reset(andDraw = true) {
    this.view = this.home;
    this.isZoomed = false;
    if (andDraw) this.move(this.home, false);
  }

  /** Draws everything, at once. */
  draw() {
    if (!this.content || !this.element.clientWidth) return;
    this.chart.setOption({ animation: false, ...this.axes(), series: this.series() }, { replaceMerge: ["series"] });
    this.chart.getZr().flush();
    this.note.textContent = this.says();
    this.mark(this.hovered);
  }

  /** Moves the axes in the next frame; points beyond a number are thinned until they rest. @param {{x: Axis, y: Axis}} view @param {boolean} [isZoomed] */
  move(view, isZoomed = true) {
    this.view = view;
    this.isZoomed = isZoomed;
    if (!this.frame) this.frame = requestAnimationFrame(() => this.redraw());
    this.restAfter(REST_MS);
  }

  redraw() {
    this.frame = 0;
    if (!this.content) return;
    const start = performance.now();
    if (!this.isThin && this.isMany()) {
      this.isThin = true;
      this.chart.setOption({ ...this.axes(), series: this.series() }, { replaceMerge: ["series"] });
      this.note.textContent = this.says();
    } else this.chart.setOption(this.axes());
    this.chart.getZr().flush();
    this.mark(this.hovered);
    performance.measure("redraw", { start, end: performance.now() });
  }

  rest() {
    if (!this.isThin) return;
    this.isThin = false;
    this.draw();
  }

  /** @returns {number} */
  count() {
    return (this.content?.groups ?? []).reduce((sum, group) => sum + group.rows.length, 0);
  }

  isMany() {
    return this.count() > MOST_MOVING;
  }

  says() {
    if (this.isThin) return `1 of ${Math.ceil(this.count() / MOST_MOVING)} points while moving`;
    const { x, y } = this.content ?? {};
    const axis = [x, y].find((side) => side?.isLog && hasNoLog(side.values));
    return axis ? `values of ${axis.name} that are not above 0 have no place on a logarithmic axis` : "";
  }

  axes() {
    const ink = inks();
    const { x, y } = /** @type {Content} */ (this.content);
    const box = this.box;
    const font = { color: ink.soft, fontSize: 11, fontFamily: "system-ui, sans-serif" };
    const one = (/** @type {Axis} */ axis, /** @type {Side} */ side, /** @type {number} */ most, /** @type {boolean} */ isLeft) => {
      const at = ticks(axis, most);
      return {
        type: axis.isLog ? "log" : "value",
        min: axis.low,
        max: axis.high,
        name: labelled(side.name, side.unit),
        nameLocation: "middle",
        nameGap: isLeft ? (this.isSmall ? 28 : 42) : this.isSmall ? 18 : 24,
        nameTextStyle: { ...font, color: ink.ink },
        axisLine: { show: true, onZero: false, lineStyle: { color: ink.axis } },
        axisTick: { show: true, length: 4, customValues: at, lineStyle: { color: ink.axis } },
        axisLabel: { ...font, customValues: at, formatter: tickText(at), hideOverlap: true },
        splitLine: { show: !this.isSmall, customValues: at, lineStyle: { color: ink.grid } },
        minorTick: { show: false },
      };
    };
    return {
      grid: { left: box.left, top: box.top, width: box.width, height: box.height, containLabel: false },
      xAxis: one(this.view.x, x, Math.max(2, Math.round(box.width / 80)), false),
      yAxis: one(this.view.y, y, Math.max(this.isSmall ? 3 : 2, Math.round(box.height / 42)), true),
    };
  }

  series() {
    const content = /** @type {Content} */ (this.content);
    const ink = inks();
    const count = this.count();
    const every = this.isThin ? Math.ceil(count / MOST_MOVING) : 1;
    const isLarge = count / every > LARGE;
    const size = this.isSmall ? 2 : isLarge ? (count > 30_000 ? 1.6 : 2.4) : count > 900 ? 3.6 : 4.6;
    /** @type {any[]} */
    const all = [];
    if (content.zero) all.push(line("zero", ink.axis, 1, [-1e30, 0, 1e30, 0], 1));
    if (content.cells) all.push(content.cells);
    else {
      for (const [place, group] of content.groups.entries()) {
        all.push({
          type: "scatter", id: group.name, name: group.name, data: pairs(content.x.values, content.y.values, group.rows, every), dimensions: ["x", "y"], symbolSize: group.isAside ? size + 1 : size,
          symbol: group.isAside ? "emptyCircle" : isLarge ? "rect" : "circle", large: !group.isAside, largeThreshold: 0, progressive: 0, silent: true, clip: true, 
          // One over the other in their order, whichever of them were there before.
          z: group.isAside ? 2 : 3 + place / content.groups.length,
          itemStyle: { color: group.colour, opacity: group.isAside ? 0.8 : isLarge ? 0.75 : 0.72, borderColor: group.isAside ? group.colour : "transparent" },
        });
      }
    }
    for (const one of content.lines) {
      const thin = Math.max(1, Math.ceil(one.rows.length / (this.isThin ? 600 : 4000)));
      const data = pairs(content.x.values, one.y, one.rows, thin);
      all.push(line(one.name, one.colour, one.width, data, one.isFaint ? 2 : 5));
    }
    if (this.selected.length) all.push(this.marked(size, every));
    return all;
  }

  /** @param {number} size @param {number} every */
  marked(size, every) {
    const content = /** @type {Content} */ (this.content);
    const isLarge = this.selected.length / every > LARGE;
    return {
      type: "scatter", id: "selected", name: "selected", data: pairs(content.x.values, content.y.values, this.selected, every), dimensions: ["x", "y"], symbol: isLarge ? "rect" : "circle", symbolSize: isLarge ? size + 0.8 : size + 2,
      large: true, largeThreshold: 0, progressive: 0, silent: true, clip: true, z: 6, itemStyle: { color: inks().mark, borderColor: inks().halo, borderWidth: isLarge ? 0 : 1 },
    };
  }

  /** @param {ArrayLike<number>} rows */
  select(rows) {
    this.selected = rows;
    this.draw();
  }

  /** Pixels of a row, for one row or for all of them in a row. @returns {{x: (row: number) => number, y: (row: number) => number}} */
  projection() {
    const { x, y } = /** @type {Content} */ (this.content);
    const { left, top, width, height } = this.box;
    const view = this.view;
    return {
      x: (row) => left + width * place(view.x, x.values[row]),
      y: (row) => top + height * (1 - place(view.y, y.values[row])),
    };
  }

  /** @param {number} px @param {number} py @returns {[number, number]} */
  valuesAt(px, py) {
    const box = this.box;
    return [valueAt(this.view.x, (px - box.left) / box.width), valueAt(this.view.y, 1 - (py - box.top) / box.height)];
  }

  /** Marks the hovered row. @param {number | null} row */
  mark(row) {
    this.hovered = row;
    const box = this.box;
    const isThere = row !== null && this.content && row < this.content.x.values.length;
    const to = isThere ? this.projection() : null;
    const [px, py] = to && row !== null ? [to.x(row), to.y(row)] : [NaN, NaN];
    const isInside = px >= box.left - 1 && px <= box.left + box.width + 1 && py >= box.top - 1 && py <= box.top + box.height + 1;
    this.marker.setAttribute("visibility", isInside ? "visible" : "hidden");
    if (!isInside) return;
    this.marker.setAttribute("cx", px.toFixed(1));
    this.marker.setAttribute("cy", py.toFixed(1));
  }
}

/** @param {ArrayLike<number>} values @param {ArrayLike<number>} rows */
const at = (values, rows) => Float64Array.from(rows, (row) => values[row]);

/** @param {ArrayLike<number>} values */
function hasNoLog(values) {
  for (let i = 0; i < values.length; i += 1) if (values[i] <= 0) return true;
  return false;
}

/** x and y of every k-th row, one after the other. @param {ArrayLike<number>} x @param {ArrayLike<number>} y @param {ArrayLike<number>} rows @param {number} every */
function pairs(x, y, rows, every) {
  const data = new Float64Array(2 * Math.ceil(rows.length / every));
  for (let i = 0, k = 0; i < rows.length; i += every, k += 2) {
    // A row of -1 is a gap between lines.
    data[k] = rows[i] < 0 ? NaN : x[rows[i]];
    data[k + 1] = rows[i] < 0 ? NaN : y[rows[i]];
  }
  return data;
}

/** @param {string} name @param {string} colour @param {number} width @param {ArrayLike<number>} data @param {number} z */
function line(name, colour, width, data, z) {
  return {
    type: "line", id: name, name, data: data instanceof Float64Array ? data : new Float64Array(data), dimensions: ["x", "y"], showSymbol: false, silent: true, clip: true, z, connectNulls: false,
    lineStyle: { color: colour, width, join: "round" },
  };
}
