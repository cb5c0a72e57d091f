// @ts-check
// The table of columns: what each was taken for, and a click to say it better.

import { bare, parse, QUANTITIES, UNITS, withEntry } from "./column-map.js";
import { byId, fill, h } from "./dom.js";
import { change, on, state } from "./store.js";

/** @typedef {import("./types.js").ColumnReading} ColumnReading */

/** The column that is being edited. */
let open = "";

function draw() {
  const session = state.session;
  if (!session) return;
  const table = byId("columns");
  const isSeveral = session.data.names.length > 1;
  const said = parse(session.columns);
  const rows = session.reading.columns.flatMap((column, i) => rowsOf(column, `${column.file}/${column.column}`, i, isSeveral, said));
  const caption = table.querySelector("caption");
  fill(
    table, caption,
    h("thead", null, h("tr", null, h("th", { scope: "col" }, "column"), h("th", { scope: "col" }, "taken for"), h("th", { scope: "col" }, "first values"))),
    h("tbody", null, ...rows),
  );
}

/**
 * @param {ColumnReading} column @param {string} key @param {number} i @param {boolean} isSeveral
 * @param {import("./column-map.js").Entry[]} said
 */
function rowsOf(column, key, i, isSeveral, said) {
  const isOpen = open === key;
  const isSaid = said.some((entry) => entry.heading === column.column || entry.heading === bare(column.column).heading);
  const taken = column.quantity ? `${column.quantity}${column.unit && column.unit !== "1" ? ` [${column.unit}]` : ""}` : "not read";
  const marks = [column.guessed && column.quantity ? h("span", { class: "tag guess", title: column.says ?? "guessed from the readings" }, "guessed") : null, isSaid ? h("span", { class: "tag" }, "said") : null];
  const row = h(
    "tr", { "data-column": column.column, "data-quantity": column.quantity ?? "", title: isSeveral ? column.file : null },
    h("th", { scope: "row" }, h("button", { type: "button", class: "link", "aria-expanded": isOpen, "data-edit": i, title: `${column.column}: click to change`, onclick: () => toggle(key) }, column.column)),
    h("td", null, taken, " ", ...marks),
    h("td", { class: "values" }, column.first.slice(0, 3).join("  ")),
  );
  return isOpen ? [row, h("tr", { class: "editor" }, h("td", { colspan: 3 }, editor(column, said)))] : [row];
}

/** @param {string} key */
function toggle(key) {
  open = open === key ? "" : key;
  draw();
  if (open) /** @type {HTMLElement | null} */ (document.querySelector("#columns .editor select"))?.focus();
}

/** @param {ColumnReading} column @param {import("./column-map.js").Entry[]} said */
function editor(column, said) {
  const { heading } = bare(column.column);
  const before = said.find((entry) => entry.heading === column.column || entry.heading === heading);
  const quantity = h("select", { name: "quantity", "aria-label": "quantity" }, ...QUANTITIES.map((name) => h("option", { value: name, selected: name === column.quantity }, name)));
  const unit = h("input", { name: "unit", "aria-label": "unit", size: 7, list: "units", value: column.unit ?? "", autocomplete: "off", spellcheck: "false" });
  const list = h("datalist", { id: "units" });
  const offer = () => fill(list, ...(UNITS[quantity.value] ?? []).map((name) => h("option", { value: name })));
  quantity.addEventListener("change", () => {
    offer();
    const offered = UNITS[quantity.value] ?? [];
    if (!offered.includes(unit.value)) unit.value = offered[0] ?? "";
  });
  offer();
  const reversed = h("input", { type: "checkbox", name: "reversed", checked: before?.isReversed ?? false });
  const form = h(
    "form", { class: "row", "data-editor": column.column },
    quantity, unit, list, h("label", null, reversed, " turn sign"), h("button", { type: "submit", class: "small primary" }, "Apply"),
    h("button", { type: "button", class: "small", onclick: () => toggle(open) }, "Cancel"),
    column.says ? h("p", { class: "says" }, column.says) : null,
  );
  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    const entry = { quantity: quantity.value, heading, unit: unit.value.trim() || null, isReversed: reversed.checked };
    const isTaken = await change((now) => ({ columns: withEntry(now.columns, entry) }), "columns");
    if (!isTaken) return;
    open = "";
    draw();
  });
  return form;
}

export function startColumns() {
  on("session", (why) => {
    // A refusal leaves the form as it was filled in.
    if (why !== "refused") draw();
  });
}
