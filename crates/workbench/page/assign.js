// @ts-check
// A file whose columns the server could not tell: each heading gets a quantity and a unit by hand, and the file is sent once more.

import { format, parse, QUANTITIES, UNITS } from "./column-map.js";
import { byId, fill, h, input } from "./dom.js";

/** Headings that the server's sentence says it found. @param {string} says */
export function headingsIn(says) {
  const found = [...says.matchAll(/found: ((?:`[^`]*`(?:, )?)+)/g)].flatMap((part) => [...part[1].matchAll(/`([^`]*)`/g)].map((heading) => heading[1]));
  return [...new Set(found)].filter(Boolean);
}

/** What the server's sentence says to write. @param {string} says */
function suggested(says) {
  const texts = [...says.matchAll(/--columns "([^"]+)"/g)].map((found) => found[1]).filter((text) => !text.includes("NAME"));
  return [...new Set(texts)].join(", ");
}

/** @param {string} says the refusal */
export function openAssign(says) {
  const box = input("assign-columns");
  box.value ||= suggested(says);
  const headings = headingsIn(says);
  fill(byId("assign-headings"), ...headings.map((heading) => {
    const before = parse(box.value).find((entry) => entry.heading === heading);
    const quantity = h("select", { "aria-label": `quantity of ${heading}`, "data-heading": heading }, h("option", { value: "" }, "–"), ...QUANTITIES.map((name) => h("option", { value: name, selected: name === before?.quantity }, name)));
    const unit = h("input", { "aria-label": `unit of ${heading}`, size: 6, value: before?.unit ?? "", spellcheck: "false", autocomplete: "off" });
    const update = () => {
      const others = parse(box.value).filter((entry) => entry.heading !== heading && (entry.quantity !== quantity.value || quantity.value === "ignore"));
      box.value = format(quantity.value ? [...others, { quantity: quantity.value, heading, unit: unit.value.trim() || null, isReversed: false }] : others);
    };
    quantity.addEventListener("change", () => {
      unit.value = UNITS[quantity.value]?.[0] ?? "";
      update();
    });
    unit.addEventListener("input", update);
    return h("li", null, h("span", { class: "heading", title: heading }, heading), quantity, unit);
  }));
  byId("assign").hidden = false;
}

export function closeAssign() {
  byId("assign").hidden = true;
  input("assign-columns").value = "";
}
