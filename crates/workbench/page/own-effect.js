// @ts-check
// An effect of one's own, checked by the server while it is typed.

import { isAborted, post, Refusal } from "./api.js";
import { afterRest, button, byId, input } from "./dom.js";
import { counted, withoutExcerpt } from "./format.js";
import { notice } from "./notices.js";
import { change, on, report, state } from "./store.js";

const TEMPLATE = `[effects.hose-stiffness]
title = "Hose pulls on the muscle"
force = "-k * (eps - eps_free)"          # added to the force of the muscle, in N
parameters.k = { unit = "N", typical = "50 N", low = "0 N", high = "500 N" }
parameters.eps_free = { unit = "1", typical = 0.1, low = -0.1, high = 0.4 }
`;

let asking = new AbortController();

/** @param {string} says @param {"good" | "bad" | ""} kind */
function say(says, kind) {
  byId("own-says").textContent = withoutExcerpt(says);
  byId("own-says").dataset.kind = kind;
}

async function check() {
  asking.abort();
  asking = new AbortController();
  const text = input("own-toml").value;
  button("own-apply").disabled = true;
  if (!text.trim()) return say("", "");
  try {
    /** @type {{effects: {name: string}[]}} */
    const { effects } = await post("effects/check", text, asking.signal);
    say(`${counted(effects.length, "effect")} understood: ${effects.map((card) => card.name).join(", ")}`, "good");
    button("own-apply").disabled = !effects.length || text === state.session?.own_effects;
  } catch (error) {
    if (isAborted(error)) return undefined;
    if (error instanceof Refusal) say(error.message, "bad");
    else report(error);
  }
  return undefined;
}

export function startOwnEffect() {
  const box = input("own-toml");
  box.value = TEMPLATE;
  box.addEventListener("input", afterRest(350, () => void check()));
  byId("own").addEventListener("toggle", () => void check());
  byId("own-apply").addEventListener("click", async () => {
    const text = box.value;
    if (await change(() => ({ own_effects: text }), "own_effects")) {
      const [, name] = /^\s*\[effects\.([^\]]+)\]/m.exec(text) ?? [];
      say("It stands in the catalogue: switch it on there.", "good");
      notice(`${name ? `${name} stands` : "It stands"} in the list of effects now: switch it on there.`);
      if (name) document.querySelector(`[data-item="${CSS.escape(name.trim())}"]`)?.scrollIntoView({ block: "center" });
      button("own-apply").disabled = true;
    }
  });
  byId("own-remove").addEventListener("click", () => {
    void change((now) => {
      const own = [...(now.own_effects ?? "").matchAll(/^\s*\[effects\.([^\]]+)\]/gm)].map((found) => found[1].trim());
      return { own_effects: null, effects: now.effects.filter((effect) => !own.includes(effect.name)) };
    }, "own_effects");
  });
  on("refused", ({ says, where }) => {
    if (where === "own_effects") say(says, "bad");
  });
  let shown = /** @type {string | null} */ (null);
  on("session", () => {
    const own = state.session?.own_effects ?? null;
    button("own-remove").hidden = own === null;
    if (own !== shown && own !== null) box.value = own;
    shown = own;
  });
}
