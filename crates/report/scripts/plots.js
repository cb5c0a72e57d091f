// @ts-check
// The plots of the middle, linked by selection and hovered row.

import * as contents from "./contents.js";
import { byId, fill, h, select } from "./dom.js";
import { listen } from "./gestures.js";
import { newtons, number } from "./format.js";
import { gradient, ground, signedColour } from "./palette.js";
import { Plot } from "./plot.js";
import { startSaving } from "./save-plot.js";
import { describe, hover, selection, selectRows } from "./selection.js";
import { keepView, on, state } from "./store.js";

/** @type {Record<string, Plot>} */
const plots = {};
/** @type {import("./gestures.js").Tool} */
let tool = "pan";
let scale = 1;

const view = () => state.session?.view ?? {};

/** Isometric tests are read along the pressure, all others along the contraction. */
function abscissa() {
  const rows = state.rows;
  const chosen = view().against;
  if (chosen && rows?.of[chosen]) return chosen;
  return rows?.kind.length && rows.kind.every((kind) => kind === "isometric") ? "pressure" : "contraction";
}

const residualAgainst = () => {
  const chosen = view().residual ?? "contraction";
  return state.rows?.of[chosen] ? chosen : "contraction";
};

const inCells = () => view().cells ?? (state.rows?.count ?? 0) > 5000;

/** Which content each plot had, so that a zoom is kept while only the model changes. @type {Record<string, string>} */
const shown = {};

/** @param {string} name @param {string} key @param {import("./plot.js").Content} content */
function show(name, key, content) {
  const full = `${JSON.stringify(state.session?.data)} ${key}`;
  plots[name].show(content, shown[name] !== full);
  shown[name] = full;
}

function drawForce() {
  const rows = state.rows;
  if (!rows) return;
  const against = abscissa();
  const isLog = view().log ?? false;
  const how = { isLog, isPath: state.comparison?.data.is_path ?? true, hasEffects: state.effects.length > 0 };
  show("force", `${against} ${isLog}`, contents.force(rows, against, how));
  for (const choice of document.querySelectorAll("[data-against]")) {
    const its = /** @type {HTMLButtonElement} */ (choice);
    its.setAttribute("aria-pressed", String(its.dataset.against === against));
    its.hidden = !rows.of[its.dataset.against ?? ""];
  }
  byId("log").setAttribute("aria-pressed", String(isLog));
}

function drawMap() {
  const rows = state.rows;
  if (!rows) return;
  scale = contents.residualScale(rows);
  show("map", String(inCells()), contents.map(rows, inCells(), scale));
  byId("cells").setAttribute("aria-pressed", String(inCells()));
  const floor = state.comparison?.noise_floor?.sd_n;
  byId("map-scale").style.backgroundImage = gradient((share) => signedColour(2 * share - 1));
  byId("map-low").textContent = `−${number(scale)}`;
  byId("map-high").textContent = `+${newtons(scale)}`;
  byId("map-high").title = floor ? `${number(scale / floor, 2)} times the noise floor` : "";
}

function drawAgainst() {
  const rows = state.rows;
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
  const { session, rows } = state;
  if (!session || !rows) return;
  const key = JSON.stringify([session.data, session.columns, session.excluded, session.muscle.toml, ground()]);
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
  fill(tip, ...describe(row).map((part) => h("span", null, part)));
  const box = plot.element.getBoundingClientRect();
  const left = Math.min(box.left + px + 14, document.documentElement.clientWidth - tip.offsetWidth - 8);
  const below = box.top + py + 14;
  tip.style.left = `${Math.max(4, left)}px`;
  tip.style.top = `${below + tip.offsetHeight > innerHeight ? box.top + py - tip.offsetHeight - 10 : below}px`;
}

export function startPlots() {
  for (const name of ["force", "map", "against", "sweeps"]) {
    const plot = new Plot(byId(`plot-${name}`), { small: name === "sweeps" });
    plots[name] = plot;
    listen(plot, { tool: () => tool, brushed: selectRows, hovered: (row, px, py) => showTip(plot, row, px, py) });
  }
  setTool("pan");
  startSaving(plots);

  on("documents", drawAll);
  on("theme", drawAll);
  on("selection", () => Object.values(plots).forEach((plot) => plot.content && plot.select(selection.rows)));
  on("hover", (row) => Object.values(plots).forEach((plot) => plot.mark(row)));

  for (const choice of document.querySelectorAll("[data-against]")) {
    choice.addEventListener("click", () => {
      keepView({ against: /** @type {HTMLElement} */ (choice).dataset.against });
      drawForce();
    });
  }
  byId("log").addEventListener("click", () => {
    keepView({ log: !view().log });
    drawForce();
  });
  byId("cells").addEventListener("click", () => {
    keepView({ cells: !inCells() });
    drawMap();
  });
  byId("reset").addEventListener("click", () => Object.values(plots).forEach((plot) => plot.content && plot.reset()));
  select("residual-against").addEventListener("change", () => {
    keepView({ residual: select("residual-against").value });
    drawAgainst();
  });
  for (const choice of document.querySelectorAll("[data-tool]")) {
    choice.addEventListener("click", () => setTool(/** @type {any} */ (choice).dataset.tool));
  }
}
