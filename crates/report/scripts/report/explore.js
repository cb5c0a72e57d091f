// @ts-check
// The plots of rows in a report: they stand for the drawings that the report has without scripts. The rows lie in the page; nothing is asked of anybody.

import { byId, fill, h } from "../dom.js";
import { counted, newtons } from "../format.js";
import { startPlots } from "../plots.js";
import { decoded, withModel } from "../rows.js";
import { on, tell } from "../topics.js";

/** @typedef {import("../rows.js").Rows} Rows */
/** @typedef {import("../rows.js").Report} Report */

const EMPTY = "Point at a row for its line in the file. Brush rows to mark them in all plots. Click a plot to zoom with the wheel.";

/** @param {string} text Base64 @returns {ArrayBuffer} */
const bytesOf = (text) => Uint8Array.from(atob(text.trim()), (letter) => letter.charCodeAt(0)).buffer;

/** @param {string} name */
const savers = (name) => h("span", { class: "save" }, ...["PNG", "SVG"].map((kind) => h("button", { type: "button", class: "small", "data-save": `${name}:${kind.toLowerCase()}` }, kind)));

/** @param {string} name @param {string} value @param {string} says @param {boolean} isOn @param {string} [title] */
const choice = (name, value, says, isOn, title) => h("button", { type: "button", [`data-${name}`]: value, "aria-pressed": isOn, title }, says);

/** @param {string} name @param {string} label @param {...import("../dom.js").Child} bar */
function panel(name, label, ...bar) {
  return h(
    "div", { class: "panel", id: `${name}-panel` },
    h("div", { class: "bar" }, ...bar, h("span", { class: "space" }), savers(name)),
    h("div", { id: `plot-${name}`, class: "plot", role: "application", "aria-label": `${label}; arrows pan, plus and minus zoom, 0 resets, brackets go from row to row, Enter selects` }),
  );
}

/** All elements that the plots look for. @param {Report} report */
function build(report) {
  const rungs = report.rungs.map((rung, i) => h(
    "button", { type: "button", "data-rung": i, "aria-pressed": i === report.rungs.length - 1 },
    rung.added === null ? "as stated" : `+ ${rung.added}`, h("span", { class: "rung-error" }, newtons(rung.rmse_n)),
  ));
  const force = panel(
    "force", "Force, measured and modelled", h("h3", null, "Force against"),
    h("span", { class: "choice", role: "group", "aria-label": "Abscissa" }, choice("against", "contraction", "contraction", true), choice("against", "pressure", "pressure", false), choice("against", "time", "time", false)),
    h("button", { id: "log", type: "button", class: "small", "aria-pressed": false }, "log"),
    h("span", { class: "choice", role: "group", "aria-label": "What dragging does" }, choice("tool", "pan", "pan", true, "Drag moves the plot; Shift and drag brushes"), choice("tool", "rectangle", "brush", false, "Drag brushes a rectangle; Ctrl adds, Alt takes away"), choice("tool", "lasso", "lasso", false, "Drag brushes what you draw around")),
    h("button", { id: "reset", type: "button", class: "small", title: "Show everything again (double click, or 0)" }, "reset"),
  );
  force.append(h("div", { class: "key", "aria-hidden": true }, h("span", { class: "k-dot" }, "measured"), rungs.length > 1 ? h("span", { class: "k-line" }, "model") : null, h("span", { class: "k-dash" }, "muscle as stated")));
  fill(
    byId("explored"),
    rungs.length > 1 ? h("div", { class: "rungs", role: "group", "aria-label": "The model, with its RMS error" }, ...rungs) : null,
    force,
    h(
      "div", { class: "strip" }, h("p", { id: "readout", "data-empty": EMPTY }, EMPTY),
      h("div", { id: "selection", hidden: true }, h("b", { id: "selection-says" }), h("button", { id: "clear-selection", type: "button", class: "small" }, "clear")),
    ),
    h(
      "div", { class: "pair" },
      panel(
        "map", "Residuals over pressure and contraction", h("h3", null, "Where it fails"),
        h("span", { class: "colourbar inline" }, h("span", { id: "map-low" }), h("span", { id: "map-scale", class: "scale" }), h("span", { id: "map-high" })),
        h("button", { id: "cells", type: "button", class: "small", "aria-pressed": false, title: "Means of cells instead of points" }, "cells"),
      ),
      panel("against", "Residuals, measured minus model, against a column", h("h3", null, h("label", { for: "residual-against" }, "Residual against")), h("select", { id: "residual-against" })),
    ),
    report.every > 1 ? h("p", { id: "thinned", class: "soft" }, `This page holds 1 of ${report.every} of the ${counted(report.all, "row")}; errors are those of all.`) : null,
    h("div", { id: "tip", role: "tooltip", hidden: true }),
  );
}

function start() {
  const all = decoded(bytesOf(byId("rows").textContent ?? ""));
  const report = /** @type {Report} */ (all.report);
  // The forces of the rungs are no variables of the rows.
  const columns = all.columns.filter((column) => !column.name.startsWith("rung "));
  let rung = report.rungs.length - 1;
  /** @type {Rows} */
  let rows = { ...all, columns };
  build(report);
  /** @type {import("../plots.js").View} */
  let view = {};
  startPlots({
    get rows() { return rows; },
    data: "rows",
    measured: "rows",
    isPath: report.is_path,
    get hasEffects() { return rung > 0; },
    floor: report.noise_floor_n,
    scrolls: true,
    get view() { return view; },
    keepView: (part) => { view = { ...view, ...part }; },
  });
  const buttons = /** @type {NodeListOf<HTMLElement>} */ (document.querySelectorAll("[data-rung]"));
  for (const button of buttons) {
    button.addEventListener("click", () => {
      rung = Number(button.dataset.rung);
      rows = withModel(rows, all.of[report.rungs[rung].column]);
      for (const other of buttons) other.setAttribute("aria-pressed", String(other === button));
      tell("documents");
    });
  }
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => tell("theme"));
  on("documents", () => performance.mark("plots:drawn"));
  tell("documents");
}

// What stands for a drawing is shown before it is drawn: plots need their size.
document.documentElement.classList.add("scripted");
try {
  start();
} catch (error) {
  document.documentElement.classList.remove("scripted");
  throw error;
}
