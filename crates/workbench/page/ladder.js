// @ts-check
// One rung for each effect: the error that is left, the held-out error beside it, and a way back.

import { byId, fill, h, keepingFocus } from "./dom.js";
import { newtons, number } from "./format.js";
import { change, on, state } from "./store.js";

/** How an error has changed. @param {number} change */
const percentOf = (change) => (Math.abs(change) < 5e-4 ? "0 %" : `${change > 0 ? "+" : ""}${number(100 * change, 2)} %`);

/** Decades of error that a bar may show below the largest one. */
const MOST_DECADES = 4;

function draw() {
  const comparison = state.comparison;
  if (!comparison) {
    fill(byId("ladder"));
    fill(byId("warnings"));
    return;
  }
  const { ladder } = comparison;
  const floor = comparison.noise_floor?.sd_n ?? null;
  const values = ladder.flatMap((rung) => [rung.rmse_n, rung.held_out_rmse_n]).concat(floor).filter((v) => v !== null && Number.isFinite(v) && v > 0);
  const high = Math.max(...values.map(Number), 1e-9);
  const low = Math.max(Math.min(...values.map(Number), high) / 2, high / 10 ** MOST_DECADES);
  // Errors fall by orders of magnitude: lengths of bars are logarithmic.
  const share = (/** @type {number | null} */ v) => (v && v > 0 ? Math.max(0.01, Math.min(1, Math.log(v / low) / Math.log(high / low || 2))) : 0);
  fill(byId("ladder"), ...ladder.map((rung, i) => {
    const isLast = i === ladder.length - 1;
    const bar = h("span", { class: "bar-room" });
    const length = h("span", { class: "length" });
    length.style.width = `${100 * share(rung.rmse_n)}%`;
    bar.append(length);
    if (rung.held_out_rmse_n !== null && rung.held_out_rmse_n !== undefined) {
      const tick = h("span", { class: "tick" });
      tick.style.left = `${100 * share(rung.held_out_rmse_n)}%`;
      bar.append(tick);
    }
    if (floor) {
      const line = h("span", { class: "floor-line" });
      line.style.left = `${100 * share(floor)}%`;
      bar.append(line);
    }
    const before = i ? ladder[i - 1].rmse_n : null;
    const held = state.heldOutIsPending ? "…" : newtons(rung.held_out_rmse_n);
    return h("li", null, h(
      "button",
      {
        type: "button", class: isLast ? "rung last" : "rung", "data-rung": i, "data-rmse": rung.rmse_n, "aria-current": isLast ? "step" : null,
        title: isLast ? rung.title : `Back to: ${rung.title}`, onclick: () => goTo(i),
      },
      h("span", { class: "rung-name" }, rung.added ? `+ ${rung.added}` : "muscle as stated"),
      bar,
      h("span", { class: "rung-error" }, newtons(rung.rmse_n)),
      h("span", { class: "rung-fall" }, before ? percentOf(rung.rmse_n / before - 1) : ""),
      h("span", { class: state.heldOutIsPending ? "rung-held pending" : "rung-held" }, held),
    ));
  }));
  if (ladder.length === 1) byId("ladder").append(h("li", { class: "empty" }, "Switch an effect on, or press Diagnose: each effect adds a rung."));
  byId("ladder").scrollTop = byId("ladder").scrollHeight;
  const texts = [...new Set([...comparison.warnings, ...ladder.map((rung) => rung.without_state ?? "")].filter((text) => typeof text === "string" && text))];
  fill(byId("warnings"), ...texts.map((text) => h("li", null, text)));
}

/** Keeps the effects up to a rung. @param {number} rung */
function goTo(rung) {
  const kept = state.comparison?.ladder.slice(1, rung + 1).map((one) => one.added) ?? [];
  void change((now) => {
    const effects = now.effects.filter((effect) => kept.includes(effect.name));
    return effects.length === now.effects.length ? null : { effects };
  }, "effects");
}

export function startLadder() {
  const again = () => keepingFocus(byId("ladder"), draw);
  on("outdated", draw);
  on("documents", again);
  on("held-out", again);
}
