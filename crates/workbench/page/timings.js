// @ts-check
// Marks from which a test reads how long things took: `data` (start to drawn), `switch` (click to redrawn plots), `draw` (documents here to redrawn plots: the page's own part of it), `redraw` (one frame of a zoom).

import { on } from "./store.js";

export function startTimings() {
  let isFirst = true;
  on("documents", () => {
    // After all listeners have drawn and the browser has shown it.
    requestAnimationFrame(() => {
      performance.mark("plots:drawn");
      performance.measure("draw", "documents:here", "plots:drawn");
      if (isFirst) performance.measure("data", { start: 0, end: "plots:drawn" });
      isFirst = false;
      if (performance.getEntriesByName("switch:click").length) {
        performance.measure("switch", "switch:click", "plots:drawn");
        performance.clearMarks("switch:click");
      }
    });
  });
}
