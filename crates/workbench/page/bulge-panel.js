// @ts-check
// The bulge of the row below the pointer, or of the sliders.

import { get, isAborted, Refusal } from "./api.js";
import { afterRest, byId, fill, h, input, select } from "./dom.js";
import { newtons, number, quantity } from "./format.js";
import { showAt } from "./notices.js";
import { gradient, rampColour } from "./palette.js";
import { selection } from "./selection.js";
import { on, report, state } from "./store.js";

/** @typedef {import("./types.js").Shape} Shape */

const WAIT_MS = 50;
/** A fit of its own goes before the bulge of another model: it waits until nothing is switched. */
const REST_MS = 400;

/** @type {import("./scene.js").BulgeScene | null} */
let scene = null;
/** @type {Shape | null} */
let shape = null;
let asking = new AbortController();
let shownFor = "";
let field = "";

const query = () => `pressure_pa=${Number(input("shape-pressure").value) * 1e5}&contraction=${Number((Number(input("shape-contraction").value) / 100).toPrecision(6))}`;

function showValues() {
  byId("shape-contraction-value").textContent = `${Number(input("shape-contraction").value).toFixed(1)} %`;
  byId("shape-pressure-value").textContent = `${Number(input("shape-pressure").value).toFixed(2)} bar`;
  byId("shape-vtk").setAttribute("href", `api/shape.vtp?${query()}`);
}

async function ask() {
  if (!state.session || !scene) return;
  const text = query();
  const key = JSON.stringify([text, state.session.muscle.toml, state.session.effects, state.session.own_effects]);
  if (key === shownFor) return;
  asking.abort();
  asking = new AbortController();
  try {
    shape = await get(`shape?${text}`, asking.signal);
    shownFor = key;
    showAt("shape", "");
    draw();
  } catch (error) {
    if (isAborted(error)) return;
    if (error instanceof Refusal) {
      showAt("shape", error.message);
      byId("shape-facts").textContent = "";
    } else report(error);
  }
}

const askSoon = afterRest(WAIT_MS, () => void ask());
const askAtRest = afterRest(REST_MS, () => void ask());

function draw() {
  if (!scene || !shape) return;
  const choice = select("shape-field");
  const names = shape.fields.map((one) => one.name);
  if (choice.dataset.names !== names.join()) {
    choice.dataset.names = names.join();
    fill(choice, ...names.map((name) => h("option", { value: name }, name.replaceAll("_", " "))));
  }
  if (!names.includes(field)) field = names[0] ?? "";
  choice.value = field;
  const at = Math.max(0, names.indexOf(field));
  const [low, high] = scene.show(shape, at);
  const unit = shape.fields[at]?.unit;
  byId("shape-low").textContent = number(low);
  byId("shape-high").textContent = quantity(high, unit);
  byId("shape-scale").style.backgroundImage = gradient(rampColour);
  byId("shape-facts").textContent = `${newtons(shape.force_n)}, ${number(shape.length_m * 1000)} mm long, ${number(shape.radius_m * 2000)} mm wide`;
  byId("shape-view").dataset.drawn = "true";
}

/** Sliders go as far as the data, and a little beyond. */
function setRanges() {
  const reading = /** @type {any} */ (state.session?.reading);
  const highest = (reading?.pressure_pa?.[1] ?? 6e5) / 1e5;
  const largest = (reading?.contraction?.[1] ?? 0.3) * 100;
  input("shape-pressure").max = String(Math.max(0.2, Math.ceil(highest * 11) / 10));
  input("shape-contraction").max = String(Math.max(1, Math.min(60, Math.ceil(largest * 1.2))));
  showValues();
}

/** @param {number | null} row */
function follow(row) {
  const rows = state.rows;
  if (row === null || !rows) return;
  input("shape-pressure").value = String(rows.of.pressure[row]);
  input("shape-contraction").value = String(rows.of.contraction[row]);
  showValues();
  askSoon();
}

/** three.js is read once the data are drawn: the plots come first. */
async function loadScene() {
  const element = byId("shape-view");
  try {
    const { BulgeScene } = await import("./scene.js");
    scene = new BulgeScene(element);
  } catch {
    element.classList.add("none");
    element.textContent = "This browser offers no WebGL, which drawing in space needs. The bulge can be saved as VTK.";
  }
  askSoon();
}

export function startBulge() {
  let isLoading = false;
  for (const id of ["shape-pressure", "shape-contraction"]) {
    input(id).addEventListener("input", () => {
      showValues();
      askSoon();
    });
  }
  select("shape-field").addEventListener("change", () => {
    field = select("shape-field").value;
    draw();
  });
  on("documents", () => {
    setRanges();
    if (selection.hovered !== null) follow(selection.hovered);
    askAtRest();
    if (isLoading) return;
    isLoading = true;
    setTimeout(() => void loadScene(), 0);
  });
  on("hover", follow);
  on("theme", draw);
}
