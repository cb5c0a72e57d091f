// @ts-check
// The same on the command line and in Python, ready to copy.

import { byId } from "./dom.js";
import { on, state } from "./store.js";

/** @param {string} id @param {() => string} text */
function copies(id, text) {
  const button = byId(id);
  button.addEventListener("click", async () => {
    try {
      await navigator.clipboard.writeText(text());
      button.textContent = "copied";
    } catch {
      // Without permission the text is selected, so that the keyboard copies it.
      const what = byId(id.replace("copy-", ""));
      getSelection()?.selectAllChildren(what);
      button.textContent = "press Ctrl+C";
    }
    setTimeout(() => {
      button.textContent = "copy";
    }, 2000);
  });
}

export function startFooter() {
  on("session", () => {
    byId("command").textContent = state.session?.command ?? "";
    const files = [state.session && !state.session.muscle.shipped && / --muscle muscle\.toml/.test(state.session.command) ? "muscle.toml" : "", state.session?.own_effects ? "effects.toml" : ""].filter(Boolean);
    byId("needs").textContent = files.length ? `needs ${files.join(" and ")} from Export` : "";
    byId("python").textContent = state.session?.python ?? "";
  });
  copies("copy-command", () => state.session?.command ?? "");
  copies("copy-python", () => state.session?.python ?? "");
}
