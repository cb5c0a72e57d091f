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

/** Scrolls what scrolls this column: itself, or the whole page where it is narrow. @param {number} by [px] */
export function scrollColumn(by) {
  const column = byId("effects-panel").closest(".right");
  if (column && getComputedStyle(column).overflowY === "auto") column.scrollTop += by;
  else window.scrollBy(0, by);
}

export function startTabs() {
  for (const name of NAMES) {
    const tab = byId(`tab-${name}`);
    tab.addEventListener("click", () => {
      // Once more: back to what stands first.
      if (tab.getAttribute("aria-selected") === "true") tab.closest(".right")?.scrollTo({ top: 0 });
      showTab(name);
    });
    tab.addEventListener("keydown", (event) => {
      if (event.key !== "ArrowLeft" && event.key !== "ArrowRight") return;
      const other = NAMES[(NAMES.indexOf(name) + (event.key === "ArrowRight" ? 1 : NAMES.length - 1)) % NAMES.length];
      showTab(other);
      byId(`tab-${other}`).focus();
    });
  }
}
