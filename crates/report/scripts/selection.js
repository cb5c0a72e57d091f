// @ts-check
// The rows that are brushed, and the one below the pointer: one selection for all plots.

import { byId } from "./dom.js";
import { linesOf } from "./rows.js";
import { on, tell } from "./topics.js";

/** @type {number[]} */
let selected = [];
/** @type {number | null} */
let hovered = null;

export const selection = {
  get rows() { return selected; },
  get hovered() { return hovered; },
};

/** @param {number[]} rows sorted @param {"replace" | "add" | "take"} [how] */
export function selectRows(rows, how = "replace") {
  if (how === "replace") selected = rows;
  else {
    const those = new Set(rows);
    const kept = how === "add" ? [...new Set([...selected, ...rows])] : selected.filter((row) => !those.has(row));
    selected = kept.sort((a, b) => a - b);
  }
  tell("selection");
}

/** @param {number | null} row */
export function hover(row) {
  if (row === hovered) return;
  hovered = row;
  tell("hover", row);
}

/** @param {import("./plots.js").Shown} shown */
function showBox(shown) {
  const rows = shown.rows;
  const isEmpty = !selected.length || !rows;
  byId("selection").hidden = isEmpty;
  if (!isEmpty) byId("selection-says").textContent = linesOf(rows, selected);
}

/** @param {import("./plots.js").Shown} shown */
export function startSelection(shown) {
  byId("clear-selection").addEventListener("click", () => selectRows([]));
  document.addEventListener("keydown", (event) => {
    if (event.key === "Escape" && selected.length) selectRows([]);
  });
  on("selection", () => showBox(shown));
  let before = "";
  on("documents", () => {
    // Row numbers mean other rows once the data are others.
    if (shown.data !== before) {
      before = shown.data;
      hovered = null;
      if (selected.length) selectRows([]);
    }
    showBox(shown);
  });
}
