// @ts-check
// Brushed rows leave the comparison, and come back.

import { button, byId } from "./dom.js";
import { selection, selectRows } from "./selection.js";
import { change, on, state } from "./store.js";

function showButtons() {
  const rows = state.rows;
  if (!rows || !selection.rows.length) return;
  const excluded = selection.rows.filter((row) => rows.of.state[row] === -1).length;
  button("exclude").disabled = excluded === selection.rows.length;
  button("bring-back").disabled = excluded === 0;
}

export function startExclusion() {
  byId("exclude").addEventListener("click", () => {
    const those = selection.rows;
    void change((now) => ({ excluded: [...new Set([...now.excluded, ...those])].sort((a, b) => a - b) })).then((isTaken) => {
      // Marked rows would hide that they are out.
      if (isTaken) selectRows([]);
    });
  });
  byId("bring-back").addEventListener("click", () => {
    const those = new Set(selection.rows);
    void change((now) => ({ excluded: now.excluded.filter((row) => !those.has(row)) }));
  });
  on("selection", showButtons);
  on("documents", showButtons);
}
