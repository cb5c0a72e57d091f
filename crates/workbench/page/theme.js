// @ts-check
// Light or dark: as the system has it, until somebody chooses.

import { byId } from "./dom.js";
import { ground } from "./palette.js";
import { tell } from "./store.js";

const KEY = "bulge-theme";

/** @param {string | null} theme */
function set(theme) {
  if (theme === "light" || theme === "dark") document.documentElement.dataset.theme = theme;
  else delete document.documentElement.dataset.theme;
}

function remembered() {
  try {
    return localStorage.getItem(KEY);
  } catch {
    // Storage may be forbidden; then the system decides.
    return null;
  }
}

export function startTheme() {
  set(remembered());
  byId("theme").addEventListener("click", () => {
    const next = ground() === "dark" ? "light" : "dark";
    set(next);
    try {
      localStorage.setItem(KEY, next);
    } catch {
      // It holds for this page only.
    }
    tell("theme");
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => tell("theme"));
}
