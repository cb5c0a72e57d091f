// @ts-check
// Marks from which a test reads how long things took: `data` (start to drawn), `switch` (click to redrawn plots), `draw` (documents here to redrawn plots: the page's own part of it), `held-out` (click to the error on held-out data), `redraw` (one frame of a zoom).

import { on } from "./store.js";

export function startTimings() {
  let isFirst = true;
  /** @type {number | null} */
  let click = null;
  on("documents", () => {
    // After all listeners have drawn and the browser has shown it.
    requestAnimationFrame(() => {
      performance.mark("plots:drawn");
      performance.measure("draw", "documents:here", "plots:drawn");
      if (isFirst) performance.measure("data", { start: 0, end: "plots:drawn" });
      isFirst = false;
      click = performance.getEntriesByName("switch:click").at(-1)?.startTime ?? null;
      if (click !== null) performance.measure("switch", { start: click, end: "plots:drawn" });
      performance.clearMarks("switch:click");
    });
  });
  on("held-out", () => {
    if (click !== null) performance.measure("held-out", { start: click });
    click = null;
  });
}
