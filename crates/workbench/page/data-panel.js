// @ts-check
// Files in, and what was found in them: remarks of the check, rows that don't count and why.

import { byId, fill, h, input, keepingFocus } from "./dom.js";
import { counted, sentence } from "./format.js";
import { showAt } from "./notices.js";
import { change, on, report, sendFile, state } from "./store.js";

/** Rows that are named one by one. */
const MOST_ROWS = 40;

function draw() {
  const session = state.session;
  if (!session) return;
  // What the check of the data says is in the comparison: it needs the muscle.
  const data = session.problem ? null : state.comparison?.data;
  const quality = session.problem ? [] : state.comparison?.quality ?? [];
  const { reading } = session;
  byId("data-facts").textContent = session.problem ? "" : [counted(session.data.rows, "row"), data ? counted(data.sweeps, "sweep") : ""].filter(Boolean).join(", ");
  const found = [...(data?.findings ?? []), ...(reading.notes ?? []), ...quality];
  keepingFocus(byId("remarks"), () => fill(byId("remarks"), ...remarks(found), aside(reading, data?.left_out ?? []), excluded(session.excluded.length), session.columns ? mapping(session.columns) : null));
}

/** @param {any[]} found */
function remarks(found) {
  const texts = found.map((item) => [sentence(item), typeof item === "object" && item?.instead ? String(item.instead) : ""]).filter(([text]) => text);
  return texts.map(([text, instead]) => h("p", { class: "remark" }, instead && !/[.?:]$/.test(text) ? `${text}: ` : `${text} `, instead ? h("span", { class: "instead" }, instead) : null));
}

/** Rows that the reading set apart or the check left out, by reason. @param {import("./types.js").Reading} reading @param {any[]} left */
function aside(reading, left) {
  const leftRows = left.reduce((sum, one) => sum + one.rows, 0);
  const apart = reading.set_apart ?? [];
  const apartCount = reading.set_apart_rows ?? apart.length;
  if (!left.length && !apartCount) return null;
  const lines = [...apart.map((row) => `line ${row.row}: ${row.reason}`), ...left.map((one) => `line ${one.lines}: ${one.why}`)];
  const head = [left.length ? `${counted(leftRows, "row")} left out` : "", apartCount ? `${counted(apartCount, "row")} set apart` : ""].filter(Boolean).join(", ");
  return h(
    "details", { class: "remark", id: "left-out" }, h("summary", null, head),
    h("ul", null, ...lines.slice(0, MOST_ROWS).map((line) => h("li", null, line)), lines.length > MOST_ROWS ? h("li", null, `and ${lines.length - MOST_ROWS} more`) : null),
  );
}

/** @param {number} count */
function excluded(count) {
  if (!count) return null;
  return h("p", { class: "remark", id: "excluded" }, `${counted(count, "row")} excluded by hand `, h("button", { type: "button", class: "small", onclick: () => void change(() => ({ excluded: [] })) }, "bring all back"));
}

/** @param {string} columns */
function mapping(columns) {
  return h("p", { class: "remark", id: "mapping" }, "columns as said: ", h("code", null, columns), " ", h("button", { type: "button", class: "small", id: "forget-columns", onclick: () => void change(() => ({ columns: null }), "columns") }, "forget"));
}

/** Takes files as one analysis; the first one in the place of those that are there, unless it is added to them. @param {File[]} files */
async function take(files) {
  showAt("data", "");
  showAt("columns", "");
  try {
    for (const [i, file] of files.entries()) await sendFile(file, file.name, { add: i > 0 || input("add-file").checked });
  } catch (error) {
    report(error, "data");
  }
}

export function startDataPanel() {
  on("session", (why) => {
    if (why !== "refused") draw();
  });
  on("documents", draw);
  on("outdated", draw);
  input("file").addEventListener("change", () => {
    const files = [...(input("file").files ?? [])];
    input("file").value = "";
    if (files.length) void take(files);
  });

  // A file may be dropped anywhere: whoever misses the box would otherwise leave the page.
  let depth = 0;
  const isFile = (/** @type {DragEvent} */ event) => event.dataTransfer?.types.includes("Files");
  addEventListener("dragenter", (event) => {
    if (isFile(event)) document.body.classList.toggle("dropping", (depth += 1) > 0);
  });
  addEventListener("dragleave", (event) => {
    if (isFile(event)) document.body.classList.toggle("dropping", (depth -= 1) > 0);
  });
  addEventListener("dragover", (event) => event.preventDefault());
  addEventListener("drop", (event) => {
    event.preventDefault();
    depth = 0;
    document.body.classList.remove("dropping");
    const dropped = [...(event.dataTransfer?.files ?? [])];
    const muscle = dropped.find((file) => file.name.endsWith(".toml"));
    const files = dropped.filter((file) => file !== muscle);
    if (muscle) dispatchEvent(new CustomEvent("muscle-file", { detail: muscle }));
    if (files.length) void take(files);
  });
}
