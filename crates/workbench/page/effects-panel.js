// @ts-check
// The catalogue: what is on, with its numbers; and what could be, by stage, with a switch each.

import { details } from "./effect-card.js";
import { byId, fill, h, input, keepingFocus } from "./dom.js";
import { numbersOfEffect } from "./numbers.js";
import { change, on, prepare, state } from "./store.js";
import { scrollColumn } from "./tabs.js";

/** @typedef {import("./types.js").Card} Card */

/** Order of the stages along the way from what is set to what is read; others follow. */
const STAGES = ["input", "shape", "load", "output"];

/** Cards that are open. @type {Set<string>} */
const open = new Set();

/** @param {string} name */
export const isOn = (name) => state.effects.some((effect) => effect.name === name);

/** @param {string} name @param {boolean} wanted */
export function setEffect(name, wanted) {
  performance.mark("switch:click");
  for (const control of document.querySelectorAll("[role=switch]")) if (/** @type {HTMLElement} */ (control).dataset.effect === name) control.setAttribute("aria-checked", String(wanted));
  return change((now) => {
    const isThere = now.effects.some((effect) => effect.name === name);
    if (isThere === wanted) return null;
    return { effects: switched(now, name, wanted) };
  }, "effects");
}

/** The effects once this one is switched. @param {import("./types.js").Session} now @param {string} name @param {boolean} wanted */
const switched = (now, name, wanted) => wanted ? [...now.effects, { name }] : now.effects.filter((effect) => effect.name !== name);

/** @param {string} name @param {string} title @param {boolean} isUsable */
function switchOf(name, title, isUsable) {
  const checked = isOn(name);
  // Whoever points at a switch will often press it.
  const onpoint = () => prepare((now) => switched(now, name, !isOn(name)));
  return h("button", {
    type: "button", role: "switch", class: "switch", "aria-checked": checked, "aria-label": title, "data-effect": name, disabled: !isUsable && !checked, onclick: () => void setEffect(name, !isOn(name)), onpointerenter: onpoint, onfocus: onpoint,
  }, h("span", { class: "knob" }));
}

/** As the session has it. @param {HTMLButtonElement} control */
function setSwitch(control) {
  const name = control.dataset.effect ?? "";
  const checked = isOn(name);
  control.setAttribute("aria-checked", String(checked));
  control.disabled = Boolean(state.card(name)?.unsuitable) && !checked;
}

/** @param {Card} card @param {boolean} isActive */
function item(card, isActive) {
  const isUsable = !card.unsuitable;
  const key = `${isActive ? "active" : "list"}:${card.name}`;
  const isOpen = open.has(key);
  const name = h(
    "button",
    {
      type: "button", class: "link title", "aria-expanded": isOpen, "data-card": card.name, title: card.about, onclick: () => {
        if (isOpen) open.delete(key);
        else open.add(key);
        draw();
      },
    },
    h("span", { class: "name" }, card.name), h("span", { class: "what" }, card.title),
  );
  return h(
    "li", { class: isUsable ? "effect" : "effect unsuitable", "data-item": card.name },
    switchOf(card.name, card.title, isUsable), name,
    card.unsuitable ? h("p", { class: "reason" }, card.unsuitable) : null,
    isActive ? numbersOfEffect(card.name) : null,
    isOpen ? details(card) : null,
  );
}

/** A stand-in for an effect of which there is no card yet. @param {string} name @returns {Card} */
const bareCard = (name) => ({ name, title: "", about: "", equation: "", source: "", stage: "", mechanism: "", separate: "", signature: null, twins: [], parameters: [] });

/** @param {Card} card @param {string} sought */
function matches(card, sought) {
  if (!sought) return true;
  const text = [card.name, card.title, card.about, card.equation, card.source, card.stage, card.mechanism].join(" ").toLowerCase();
  return sought.split(/\s+/).every((word) => text.includes(word));
}

function drawActive() {
  const cards = state.effects.map((effect) => state.card(effect.name) ?? bareCard(effect.name));
  fill(byId("active"), cards.length ? h("h3", null, `On (${cards.length})`) : null, cards.length ? h("ul", { class: "effects" }, ...cards.map((card) => item(card, true))) : h("p", { class: "empty" }, "No effect is on: the model is the muscle as stated."));
}

/** What the catalogue shows, but for the state of its switches. @type {{key: string, cards: Card[]}} */
let shown = { key: "", cards: [] };

function drawCatalogue() {
  const sought = input("search").value.trim().toLowerCase();
  const { cards } = state;
  const key = [sought, ...open].join(" ");
  if (key === shown.key && cards === shown.cards) {
    // Of all that is there nothing but the switches has changed.
    for (const control of byId("catalogue").querySelectorAll("[role=switch]")) setSwitch(/** @type {HTMLButtonElement} */ (control));
    return;
  }
  shown = { key, cards };
  const found = cards.filter((card) => matches(card, sought));
  const stages = [...new Set([...STAGES, ...cards.map((card) => card.stage)])];
  const groups = stages.flatMap((stage) => {
    const its = found.filter((card) => card.stage === stage);
    if (!its.length) return [];
    // What can't be added here stands last.
    const sorted = [...its.filter((card) => !card.unsuitable), ...its.filter((card) => card.unsuitable)];
    return [h("section", { class: "stage", "data-stage": stage }, h("h3", null, stage, h("span", { class: "facts" }, ` ${its.length}`)), h("ul", { class: "effects" }, ...sorted.map((card) => item(card, false))))];
  });
  fill(byId("catalogue"), ...groups, cards.length && !found.length ? h("p", { class: "empty" }, `No effect holds “${sought}”.`) : null);
}

let isPressed = false;
let isWaiting = false;

function draw() {
  // A switch doesn't go away below the finger that presses it.
  isWaiting = isPressed;
  if (isPressed) return;
  const { top } = byId("catalogue").getBoundingClientRect();
  // While a slider is held its element must stay.
  if (!document.querySelector("#active [data-held-by-hand]")) keepingFocus(byId("active"), drawActive);
  keepingFocus(byId("catalogue"), drawCatalogue);
  byId("tab-effects").textContent = state.effects.length ? `Effects (${state.effects.length} on)` : "Effects";
  // What is on grows above the list: the switch that was pressed stays below the pointer.
  if (byId("catalogue").matches(":hover")) scrollColumn(byId("catalogue").getBoundingClientRect().top - top);
}

export function startEffects() {
  byId("effects-panel").addEventListener("pointerdown", () => {
    isPressed = true;
  });
  for (const end of ["pointerup", "pointercancel"]) {
    addEventListener(end, () => {
      isPressed = false;
      // After the click that follows.
      if (isWaiting) setTimeout(draw);
    });
  }
  on("session", draw);
  on("documents", draw);
  on("held-out", draw);
  on("cards", draw);
  on("numbers", draw);
  input("search").addEventListener("input", drawCatalogue);
  input("search").addEventListener("keydown", (event) => {
    if (event.key === "Escape") {
      input("search").value = "";
      drawCatalogue();
    }
  });
}
