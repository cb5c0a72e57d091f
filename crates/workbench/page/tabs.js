// @ts-check
// Effects or diagnosis, in one column.

import { byId } from "./dom.js";

const NAMES = ["effects", "diagnosis"];

/** @param {string} wanted */
export function showTab(wanted) {
  for (const name of NAMES) {
    const tab = byId(`tab-${name}`);
    tab.setAttribute("aria-selected", String(name === wanted));
    tab.tabIndex = name === wanted ? 0 : -1;
    byId(`${name}-panel`).hidden = name !== wanted;
  }
}

export function startTabs() {
  for (const name of NAMES) {
    const tab = byId(`tab-${name}`);
    tab.addEventListener("click", () => showTab(name));
    tab.addEventListener("keydown", (event) => {
      if (event.key !== "ArrowLeft" && event.key !== "ArrowRight") return;
      const other = NAMES[1 - NAMES.indexOf(name)];
      showTab(other);
      byId(`tab-${other}`).focus();
    });
  }
}
