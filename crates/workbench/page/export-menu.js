// @ts-check
// Everything that leaves the page.

import { byId, download, fill, h } from "./dom.js";
import { named } from "./plots.js";
import { asPng, asSvg } from "./save-plot.js";
import { on, state } from "./store.js";

/** @type {[string, string, string | null][]} */
const DOCUMENTS = [
  ["Report (HTML)", "api/report", null],
  ["Report of the diagnosis", "api/diagnosis-report", null],
  ["Muscle with what was learnt (TOML)", "api/learnt.toml", "learnt.toml"],
  ["Rows with residuals (CSV)", "api/rows.csv", "rows.csv"],
  ["Comparison (JSON)", "api/comparison.json", "comparison.json"],
  ["Diagnosis (JSON)", "api/diagnosis.json", "diagnosis.json"],
];

/** @param {"png" | "svg"} kind */
function savePlots(kind) {
  for (const [name, plot] of Object.entries(named())) {
    if (!plot.content) continue;
    if (kind === "png") download(asPng(plot), `${name}.png`);
    else download(new Blob([asSvg(plot)], { type: "image/svg+xml" }), `${name}.svg`);
  }
}

/** @param {boolean} isOpen */
function setOpen(isOpen) {
  const menu = byId("export-menu");
  menu.hidden = !isOpen;
  byId("export").setAttribute("aria-expanded", String(isOpen));
  if (isOpen) /** @type {HTMLElement | null} */ (menu.firstElementChild)?.focus();
}

export function startExport() {
  const menu = byId("export-menu");
  const opener = byId("export");
  const leave = () => setOpen(false);
  const links = DOCUMENTS.map(([says, address, file]) => {
    const diagnosed = address.includes("diagnosis");
    return h("a", { role: "menuitem", tabindex: -1, href: address, download: file, target: file ? null : "_blank", rel: "noopener", "data-export": address, class: diagnosed ? "needs-diagnosis" : null, onclick: leave }, says);
  });
  const plots = /** @type {("png" | "svg")[]} */ (["png", "svg"]).map((kind) => h("button", { type: "button", role: "menuitem", tabindex: -1, "data-export": kind, onclick: () => {
    leave();
    savePlots(kind);
  } }, `All plots (${kind.toUpperCase()})`));
  // What the printed command names.
  const own = /** @type {[string, string, () => string | null | undefined][]} */ ([
    ["Muscle as it stands (TOML)", "muscle.toml", () => state.session?.muscle.toml], ["Effects of your own (TOML)", "effects.toml", () => state.session?.own_effects],
  ]).map(([says, file, text]) => h("button", { type: "button", role: "menuitem", tabindex: -1, "data-export": file, onclick: () => {
    leave();
    download(new Blob([text() ?? ""], { type: "text/plain" }), file);
  } }, says));
  on("session", () => {
    own[1].hidden = !state.session?.own_effects;
  });
  fill(menu, ...links, ...own, ...plots);
  opener.addEventListener("click", () => setOpen(Boolean(menu.hidden)));
  menu.addEventListener("keydown", (event) => {
    const items = /** @type {HTMLElement[]} */ ([...menu.children]).filter((one) => one.offsetParent);
    const at = items.indexOf(/** @type {HTMLElement} */ (document.activeElement));
    const to = /** @type {Record<string, number>} */ ({ ArrowDown: at + 1, ArrowUp: at - 1, Home: 0, End: items.length - 1 })[event.key];
    if (event.key === "Escape") {
      leave();
      opener.focus();
    }
    if (to === undefined) return;
    event.preventDefault();
    items[(to + items.length) % items.length].focus();
  });
  document.addEventListener("click", (event) => {
    if (event.target instanceof Node && !menu.parentElement?.contains(event.target)) leave();
  });
  menu.addEventListener("focusout", (event) => {
    if (event.relatedTarget instanceof Node && !menu.contains(event.relatedTarget) && event.relatedTarget !== opener) leave();
  });
}
