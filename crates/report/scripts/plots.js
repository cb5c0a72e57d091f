// @ts-check
// The plots of rows, linked by selection and hovered row. Their elements and controls are found by their ids; a page may lack some of them.

import * as contents from "./contents.js";
import { byId, fill, h, select } from "./dom.js";
import { listen } from "./gestures.js";
import { newtons, number } from "./format.js";
import { gradient, ground, signedColour } from "./palette.js";
import { Plot } from "./plot.js";
import { describe } from "./rows.js";
import { startSaving } from "./save-plot.js";
import { hover, selection, selectRows, startSelection } from "./selection.js";
import { on } from "./topics.js";

/** @typedef {{against?: string, residual?: string, log?: boolean, cells?: boolean}} View how the plots are looked at */

/**
 * @typedef {object} Shown what the plots show at the moment
 * @property {import("./rows.js").Rows | null} rows
 * @property {string} data another text for other data, of which a row's number means another row
 * @property {string} measured another text if anything else than the model is another one
 * @property {boolean} isPath
 * @property {boolean} hasEffects
 * @property {number | null | undefined} floor the noise floor [N]
 * @property {boolean} scrolls whether the page is a long one: then the wheel moves the page, until a plot is clicked
 * @property {View} view
 * @property {(part: View) => void} keepView
 */

/** @type {Shown} */
let shown;
/** @type {Record<string, Plot>} */
const plots = {};
/** @type {import("./gestures.js").Tool} */
let tool = "pan";
let scale = 1;

const view = () => shown.view;

/** Isometric tests are read along the pressure, all others along the contraction. */
function abscissa() {
  const rows = shown.rows;
  const chosen = view().against;
  if (chosen && rows?.of[chosen]) return chosen;
  return rows?.kind.length && rows.kind.every((kind) => kind === "isometric") ? "pressure" : "contraction";
}

const residualAgainst = () => {
  const chosen = view().residual ?? "contraction";
  return shown.rows?.of[chosen] ? chosen : "contraction";
};

const inCells = () => view().cells ?? (shown.rows?.count ?? 0) > 5000;

/** Which content each plot had, so that a zoom is kept while only the model changes. @type {Record<string, string>} */
const before = {};

/** @param {string} name @param {string} key @param {import("./plot.js").Content} content */
function show(name, key, content) {
  const full = `${shown.data} ${key}`;
  plots[name].show(content, before[name] !== full);
  before[name] = full;
}

function drawForce() {
  const rows = shown.rows;
  if (!rows) return;
  const against = abscissa();
  const isLog = view().log ?? false;
  const how = { isLog, isPath: shown.isPath, hasEffects: shown.hasEffects };
  show("force", `${against} ${isLog}`, contents.force(rows, against, how));
  for (const choice of document.querySelectorAll("[data-against]")) {
    const its = /** @type {HTMLButtonElement} */ (choice);
    its.setAttribute("aria-pressed", String(its.dataset.against === against));
    its.hidden = !rows.of[its.dataset.against ?? ""];
  }
  byId("log").setAttribute("aria-pressed", String(isLog));
}

function drawMap() {
  const rows = shown.rows;
  if (!rows) return;
  scale = contents.residualScale(rows);
  show("map", String(inCells()), contents.map(rows, inCells(), scale));
  byId("cells").setAttribute("aria-pressed", String(inCells()));
  const { floor } = shown;
  byId("map-scale").style.backgroundImage = gradient((share) => signedColour(2 * share - 1));
  byId("map-low").textContent = `−${number(scale)}`;
  byId("map-high").textContent = `+${newtons(scale)}`;
  byId("map-high").title = floor ? `${number(scale / floor, 2)} times the noise floor` : "";
}

function drawAgainst() {
  const rows = shown.rows;
  if (!rows) return;
  const against = residualAgainst();
  show("against", against, contents.residual(rows, against));
  const choice = select("residual-against");
  const names = rows.columns.map((column) => column.name).filter((name) => !["file", "state"].includes(name) && !(name === "specimen" && rows.specimens.length < 2));
  if (choice.dataset.names !== names.join()) {
    choice.dataset.names = names.join();
    fill(choice, ...names.map((name) => h("option", { value: name }, name)));
  }
  choice.value = against;
}

/** Each plot by itself: one that fails leaves the others as they should be. */
function drawAll() {
  /** @type {unknown} */
  let failure = null;
  for (const one of [drawForce, drawMap, drawAgainst, drawSweeps]) {
    try {
      one();
    } catch (error) {
      failure ??= error;
    }
  }
  if (failure) throw failure;
}

/** What was measured changes with the data and the rows that count, not with the model. */
let sweepsFor = "";

function drawSweeps() {
  const { rows } = shown;
  if (!plots.sweeps || !rows) return;
  const key = `${shown.measured} ${ground()}`;
  if (key === sweepsFor) return;
  sweepsFor = key;
  show("sweeps", "", contents.sweeps(rows));
}

/** The plots with a name that a file may have. */
export const named = () => plots;

/** @param {import("./gestures.js").Tool} next */
function setTool(next) {
  tool = next;
  for (const choice of document.querySelectorAll("[data-tool]")) choice.setAttribute("aria-pressed", String(/** @type {HTMLElement} */ (choice).dataset.tool === tool));
  for (const plot of Object.values(plots)) plot.element.dataset.brushing = String(tool !== "pan");
}

/** @param {Plot} plot @param {number | null} row @param {number} px @param {number} py */
function showTip(plot, row, px, py) {
  const tip = byId("tip");
  hover(row);
  tip.hidden = row === null;
  if (row === null) return;
  fill(tip, ...describe(shown.rows, row, shown.floor).map((part) => h("span", null, part)));
  const box = plot.element.getBoundingClientRect();
  const left = Math.min(box.left + px + 14, document.documentElement.clientWidth - tip.offsetWidth - 8);
  const below = box.top + py + 14;
  tip.style.left = `${Math.max(4, left)}px`;
  tip.style.top = `${below + tip.offsetHeight > innerHeight ? box.top + py - tip.offsetHeight - 10 : below}px`;
}

/** @param {number | null} row */
function readOut(row) {
  const readout = byId("readout");
  readout.textContent = row === null ? readout.dataset.empty ?? "" : describe(shown.rows, row, shown.floor).join(" · ");
}

/** @param {Shown} what */
export function startPlots(what) {
  shown = what;
  for (const name of ["force", "map", "against", "sweeps"]) {
    const element = document.getElementById(`plot-${name}`);
    if (!element) continue;
    const plot = new Plot(element, { small: name === "sweeps" });
    plots[name] = plot;
    listen(plot, { scrolls: shown.scrolls, tool: () => tool, brushed: selectRows, hovered: (row, px, py) => showTip(plot, row, px, py) });
  }
  setTool("pan");
  startSaving(plots);
  startSelection(shown);

  on("documents", drawAll);
  on("theme", drawAll);
  on("selection", () => Object.values(plots).forEach((plot) => plot.content && plot.select(selection.rows)));
  on("hover", (row) => {
    readOut(row);
    Object.values(plots).forEach((plot) => plot.mark(row));
  });

  for (const choice of document.querySelectorAll("[data-against]")) {
    choice.addEventListener("click", () => {
      shown.keepView({ against: /** @type {HTMLElement} */ (choice).dataset.against });
      drawForce();
    });
  }
  byId("log").addEventListener("click", () => {
    shown.keepView({ log: !view().log });
    drawForce();
  });
  byId("cells").addEventListener("click", () => {
    shown.keepView({ cells: !inCells() });
    drawMap();
  });
  byId("reset").addEventListener("click", () => Object.values(plots).forEach((plot) => plot.content && plot.reset()));
  select("residual-against").addEventListener("change", () => {
    shown.keepView({ residual: select("residual-against").value });
    drawAgainst();
  });
  for (const choice of document.querySelectorAll("[data-tool]")) {
    choice.addEventListener("click", () => setTool(/** @type {any} */ (choice).dataset.tool));
  }
}
