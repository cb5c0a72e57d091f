// @ts-check
// The error is the headline: how it fell, what is held out, where the noise begins.

import { button, byId, fill, h } from "./dom.js";
import { newtons, number } from "./format.js";
import { on, state, step } from "./store.js";

/** More rungs than this are shortened in the middle. */
const MOST = 5;

function draw() {
  const { session, comparison } = state;
  if (session) {
    const names = session.data.names;
    byId("data-name").textContent = names.length > 2 ? `${names[0]} and ${names.length - 1} more` : names.join(", ");
    byId("muscle-name").textContent = session.muscle.name;
    document.title = `${names[0] ?? "bulge"} × ${session.muscle.name}`;
    button("undo").disabled = !session.can_undo;
    button("redo").disabled = !session.can_redo;
  }
  if (!comparison) {
    fill(byId("error-ladder"), "–");
    byId("floor").textContent = "–";
    byId("held-out").textContent = "–";
    return;
  }
  const rungs = comparison.ladder.filter((rung) => Number.isFinite(rung.rmse_n));
  const shown = rungs.length > MOST ? [rungs[0], null, ...rungs.slice(-3)] : rungs;
  const parts = shown.flatMap((rung, i) => {
    const isLast = i === shown.length - 1;
    const text = rung ? newtons(rung.rmse_n) : "…";
    const node = isLast ? h("b", { id: "error", "data-rmse": rung?.rmse_n }, text) : h("span", { title: rung?.title }, text);
    return i ? [h("span", { class: "arrow", "aria-label": "then" }, " → "), node] : [node];
  });
  fill(byId("error-ladder"), ...parts);
  const floor = comparison.noise_floor;
  byId("floor").textContent = newtons(floor?.sd_n);
  byId("floor").title = floor?.says ?? "";
  drawHeldOut();
}

function drawHeldOut() {
  const last = state.comparison?.ladder.at(-1);
  const element = byId("held-out");
  const isPending = state.heldOutIsPending;
  element.classList.toggle("pending", isPending);
  // While the new one is computed the old one would be a lie.
  element.textContent = isPending ? "…" : newtons(last?.held_out_rmse_n);
  element.title = isPending ? "is being computed" : last?.held_out_by ? `held out by ${last.held_out_by}` : "";
  element.dataset.value = isPending || !last?.held_out_rmse_n ? "" : number(last.held_out_rmse_n, 6);
}

export function startHeadline() {
  on("session", draw);
  on("documents", draw);
  on("outdated", draw);
  on("held-out", draw);
  byId("undo").addEventListener("click", () => void step("undo"));
  byId("redo").addEventListener("click", () => void step("redo"));
  document.addEventListener("keydown", (event) => {
    const key = event.key.toLowerCase();
    if (!(event.ctrlKey || event.metaKey) || !["z", "y"].includes(key)) return;
    // Within a text the key undoes what was typed.
    if (event.target instanceof HTMLElement && event.target.matches("input:not([type=range]):not([type=checkbox]), textarea")) return;
    event.preventDefault();
    void step(event.shiftKey || key === "y" ? "redo" : "undo");
  });
}
