// @ts-check
// The numbers of an effect that is on: value, interval, a slider within bounds, and whether it is fitted or held.

import { h } from "./dom.js";
import { interval, quantity } from "./format.js";
import { change, changeSoon, state, tell, whenSlid } from "./store.js";

/** @typedef {import("./types.js").Fitted} Fitted */
/** @typedef {import("./types.js").Parameter} Parameter */

const STEPS = 1000;

/** The last fit that has a number. @param {string} effect @returns {Fitted[]} */
function fittedOf(effect) {
  const rung = state.comparison?.ladder.findLast((one) => one.fit);
  return rung?.fit?.parameters.filter((one) => one.effect === effect) ?? [];
}

/** @param {string} effect @param {string} name @returns {number | undefined} */
const heldAt = (effect, name) => state.effects.find((one) => one.name === effect)?.hold?.[name];

/** @param {string} effect @param {string} name @param {number | null} value null: fit it */
const holding = (effect, name, value) => (/** @type {import("./types.js").Session} */ now) => ({
  effects: now.effects.map((one) => {
    if (one.name !== effect) return one;
    const hold = { ...one.hold };
    if (value === null) delete hold[name];
    else hold[name] = value;
    return Object.keys(hold).length ? { name: effect, hold } : { name: effect };
  }),
});

/**
 * Bounds in the unit that is shown. Cards give some as multiples of a length of the muscle, which the plausible range of a fit tells.
 *
 * @param {Parameter | undefined} parameter @param {Fitted | undefined} fit
 * @returns {[number, number] | null}
 */
function boundsOf(parameter, fit) {
  if (!parameter) return fit?.plausible_range ?? null;
  if (!parameter.multiple_of) return [parameter.low, parameter.high];
  const [shown, plain] = [fit?.plausible_range?.[1], parameter.plausible?.[1]];
  if (!shown || !plain) return fit?.plausible_range ?? null;
  const length = shown / plain;
  return [parameter.low * length, parameter.high * length];
}

/** @param {string} effect */
export function numbersOfEffect(effect) {
  const fits = fittedOf(effect);
  const parameters = state.card(effect)?.parameters ?? [];
  const names = [...new Set([...parameters.map((one) => one.name), ...fits.map((one) => one.name)])];
  if (!names.length) return null;
  return h("div", { class: "numbers" }, ...names.map((name) => one(effect, name, parameters.find((p) => p.name === name), fits.filter((f) => f.name === name))));
}

/** @param {string} effect @param {string} name @param {Parameter | undefined} parameter @param {Fitted[]} fits one for each specimen */
function one(effect, name, parameter, fits) {
  const fit = fits[0];
  const held = heldAt(effect, name);
  const isHeld = held !== undefined;
  const unit = fit?.unit ?? parameter?.unit ?? "";
  const value = held ?? fit?.value ?? parameter?.typical ?? 0;
  const bounds = boundsOf(parameter, fit);
  const shown = h("output", { class: "value", "data-value": value }, quantity(value, unit));
  const range = h("span", { class: "interval" }, isHeld ? "held" : intervalOf(fit));
  const id = `${effect}-${name}`;
  const row = h(
    "div", { class: fit && !fit.plausible ? "number implausible" : "number", "data-number": id },
    h("span", { class: "number-name", title: parameter?.about }, name.replaceAll("_", " ")), shown, range,
    h("button", {
      type: "button", class: "small fit-hold", "aria-pressed": isHeld, "data-hold": id, title: isHeld ? "held: click to fit it again" : "fitted: click to hold it at this value",
      onclick: () => void change(holding(effect, name, isHeld ? null : Number(value.toPrecision(6))), "effects"),
    }, isHeld ? "hold" : "fit"),
    bounds ? slider({ effect, name, value, bounds, unit, isLog: Boolean(parameter?.logarithmic) && bounds[0] > 0, shown, interval: range }) : null,
  );
  if (fit?.at_bound) row.append(h("span", { class: "tag bad" }, `at its ${fit.at_bound} bound`));
  if (fit && !fit.plausible) row.append(h("span", { class: "tag bad" }, "implausible"));
  if (fits.length > 1) row.append(h("p", { class: "specimens" }, fits.map((f) => `${f.specimen ?? "all"}: ${quantity(f.value, f.unit)}`).join(", ")));
  return row;
}

/** @param {Fitted | undefined} fit */
function intervalOf(fit) {
  if (!fit) return "";
  if (!fit.determined) return "not determined by these data";
  return fit.low === null || fit.high === null ? "" : interval(fit.low, fit.high);
}

/** @param {{effect: string, name: string, value: number, bounds: [number, number], unit: string, isLog: boolean, shown: HTMLElement, interval: HTMLElement}} of */
function slider({ effect, name, value, bounds: [low, high], unit, isLog, shown, interval: range }) {
  const toStep = (/** @type {number} */ v) => Math.round(STEPS * (isLog ? Math.log(v / low) / Math.log(high / low) : (v - low) / (high - low)));
  const toValue = (/** @type {number} */ s) => Number((isLog ? low * (high / low) ** (s / STEPS) : low + ((high - low) * s) / STEPS).toPrecision(4));
  const box = h("input", { type: "range", min: 0, max: STEPS, step: 1, "aria-label": `${name} of ${effect}${unit && unit !== "1" ? ` in ${unit}` : ""}`, "aria-valuetext": quantity(value, unit), "data-slider": `${effect}-${name}`, title: `${quantity(low, unit)} to ${quantity(high, unit)}; moving it holds the number` });
  box.value = String(toStep(Math.min(high, Math.max(low, value))));
  box.addEventListener("input", () => {
    const next = toValue(Number(box.value));
    // The panel isn't drawn anew below the hand that moves the slider.
    box.dataset.heldByHand = "true";
    shown.textContent = quantity(next, unit);
    range.textContent = "held";
    box.setAttribute("aria-valuetext", quantity(next, unit));
    // One drag is one step back.
    const goesOn = box.dataset.moved === "true";
    box.dataset.moved = "true";
    changeSoon((now) => ({ ...holding(effect, name, next)(now), goes_on: goesOn }));
  });
  const release = async () => {
    if (!box.dataset.heldByHand) return;
    delete box.dataset.moved;
    // Until its last position is drawn the panel would show an older one.
    await whenSlid();
    delete box.dataset.heldByHand;
    tell("numbers");
  };
  box.addEventListener("change", () => void release());
  box.addEventListener("blur", () => void release());
  return box;
}
