// @ts-check
// Where the server's refusals appear: at the part of the page that they are about. And what happens when something of the page itself fails.

import { byId, fill, h } from "./dom.js";
import { withoutExcerpt } from "./format.js";
import { on } from "./store.js";

const PLACES = /** @type {Record<string, string>} */ ({
  data: "data-error", columns: "columns-error", muscle: "muscle-error", effects: "effects-error", shape: "shape-error", excluded: "data-error",
});

/** @param {string} where @param {string} says an empty text takes it away */
export function showAt(where, says) {
  const place = byId(PLACES[where] ?? "data-error");
  place.textContent = withoutExcerpt(says);
  place.hidden = !says;
}

/** A sentence at the edge of the page that goes away. @param {string} says @param {number} [ms] */
export function notice(says, ms = 6000) {
  const item = h("p", { class: "notice" }, says);
  byId("notices").append(item);
  setTimeout(() => item.remove(), ms);
}

/** @param {string} says @param {string} kind */
function banner(says, kind) {
  const element = byId("banner");
  element.dataset.kind = kind;
  fill(element, says);
  element.hidden = false;
}

function broken() {
  document.body.dataset.state = "error";
  banner("Something in this page went wrong. Nothing is lost: the session lives in bulge open. Reload the page to go on.", "broken");
}

export function startNotices() {
  addEventListener("error", (event) => {
    // Chromium reports this for observers that move what they observe; nothing fails.
    if (event.message?.startsWith("ResizeObserver loop")) return;
    broken();
  });
  addEventListener("unhandledrejection", broken);
  on("refused", ({ says, where, blocks }) => {
    // Where nothing can be computed the reason stands above the plots, whatever part of the page is in front.
    if (blocks) {
      byId("problem").textContent = withoutExcerpt(says);
      byId("problem").hidden = false;
    }
    if (PLACES[where]) showAt(where, says);
    else if (where !== "own_effects") notice(says, 10_000);
  });
  on("documents", () => {
    byId("problem").hidden = true;
  });
  on("session", (why) => {
    if (why !== "refused") for (const where of Object.keys(PLACES)) showAt(where, "");
  });
  on("lost", (says) => banner(says, "lost"));
  on("found", () => {
    byId("banner").hidden = true;
    notice("Connected again.");
  });
}
