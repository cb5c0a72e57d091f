// @ts-check
// The rows that are brushed, and the one below the pointer: one selection for all plots.

import { button, byId } from "./dom.js";
import { counted, newtons, number, quantity, ranges, signed } from "./format.js";
import { change, on, state, tell } from "./store.js";

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
  showBox();
  tell("selection");
}

/** @param {number | null} row */
export function hover(row) {
  if (row === hovered) return;
  hovered = row;
  byId("readout").textContent = row === null ? byId("readout").dataset.empty ?? "" : describe(row).join(" · ");
  tell("hover", row);
}

/** What is known of a row, part by part. @param {number} row */
export function describe(row) {
  const rows = state.rows;
  if (!rows || row >= rows.count) return [];
  const { of } = rows;
  const file = rows.files[of.file?.[row] ?? 0];
  const parts = [`line ${of.line[row]}${file ? ` of ${file}` : ""}`];
  if (rows.sweeps.length > 1) parts.push(`sweep ${rows.sweeps[of.sweep[row]] ?? of.sweep[row] + 1}`);
  parts.push(quantity(of.pressure[row], "bar"), quantity(of.contraction[row], "%"), newtons(of.measured[row]));
  const floor = state.comparison?.noise_floor?.sd_n;
  const sigmas = floor ? ` (${number(rows.residual[row] / floor, 2)} σ)` : "";
  if (Number.isFinite(rows.residual[row])) parts.push(`residual ${signed(rows.residual[row])} N${sigmas}`);
  else parts.push("the model has no state here");
  if (of.state[row] === 0) parts.push("left out");
  if (of.state[row] === -1) parts.push("excluded by hand");
  return parts;
}

function showBox() {
  const box = byId("selection");
  const rows = state.rows;
  const isEmpty = !selected.length || !rows;
  box.hidden = isEmpty;
  if (isEmpty) return;
  const of = rows.of;
  const files = new Set(selected.map((row) => of.file?.[row] ?? 0));
  const lines = files.size === 1 ? `lines ${ranges(selected.map((row) => of.line[row]))}` : `of ${files.size} files`;
  byId("selection-says").textContent = `${counted(selected.length, "row")}, ${lines}`;
  const excluded = selected.filter((row) => of.state[row] === -1).length;
  button("exclude").disabled = excluded === selected.length;
  button("bring-back").disabled = excluded === 0;
}

export function startSelection() {
  byId("exclude").addEventListener("click", () => {
    const those = selected;
    void change((now) => ({ excluded: [...new Set([...now.excluded, ...those])].sort((a, b) => a - b) })).then((isTaken) => {
      // Marked rows would hide that they are out.
      if (isTaken) selectRows([]);
    });
  });
  byId("bring-back").addEventListener("click", () => {
    const those = new Set(selected);
    void change((now) => ({ excluded: now.excluded.filter((row) => !those.has(row)) }));
  });
  byId("clear-selection").addEventListener("click", () => selectRows([]));
  document.addEventListener("keydown", (event) => {
    if (event.key === "Escape" && selected.length) selectRows([]);
  });
  let shown = "";
  on("documents", () => {
    // Row numbers mean other rows once the data are others.
    const names = JSON.stringify([state.session?.data, state.session?.columns]);
    if (names !== shown) {
      shown = names;
      hovered = null;
      if (selected.length) selectRows([]);
    }
    showBox();
  });
}
