// @ts-check
// Effects, diagnosis or plan, in one column.

import { byId } from "./dom.js";
import { tell } from "./store.js";

const NAMES = ["effects", "diagnosis", "plan"];

/** @param {string} wanted */
export function showTab(wanted) {
  for (const name of NAMES) {
    const tab = byId(`tab-${name}`);
    tab.setAttribute("aria-selected", String(name === wanted));
    tab.tabIndex = name === wanted ? 0 : -1;
    byId(`${name}-panel`).hidden = name !== wanted;
  }
  tell("tab", wanted);
}

export function startTabs() {
  for (const name of NAMES) {
    const tab = byId(`tab-${name}`);
    tab.addEventListener("click", () => showTab(name));
    tab.addEventListener("keydown", (event) => {
      if (event.key !== "ArrowLeft" && event.key !== "ArrowRight") return;
      const other = NAMES[(NAMES.indexOf(name) + (event.key === "ArrowRight" ? 1 : NAMES.length - 1)) % NAMES.length];
      showTab(other);
      byId(`tab-${other}`).focus();
    });
  }
}
