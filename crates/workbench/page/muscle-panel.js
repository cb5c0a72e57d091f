// @ts-check
// The muscle: a shipped one, a file, a form with its numbers, or its text.

import { get } from "./api.js";
import { byId, fill, h, input, select } from "./dom.js";
import { withoutExcerpt } from "./format.js";
import { showAt } from "./notices.js";
import { change, on, report, state } from "./store.js";
import { fieldNamed, numbersOf, replaced } from "./toml.js";

/** The text as it is edited here; it becomes the muscle once the server takes it. */
let draft = "";
let drawnFor = "";
/** What stands in the fields and isn't taken yet, by table and key. @type {Map<string, string>} */
const edits = new Map();

/** @param {{table: string, key: string}} field */
const nameOf = (field) => `${field.table} ${field.key}`;

/** The muscle of the server with what stands in the fields. */
function edited() {
  let text = state.session?.muscle.toml ?? "";
  for (const [name, value] of edits) {
    const field = numbersOf(text).find((one) => nameOf(one) === name);
    if (field) text = replaced(text, field, value);
  }
  return text;
}

/** @param {string} toml @returns {Promise<boolean>} */
function send(toml) {
  draft = toml;
  if (toml === state.session?.muscle.toml) {
    // Back to what the server has: there is nothing to ask and no complaint left.
    startAnew();
    return Promise.resolve(true);
  }
  return change(() => ({ muscle: { toml } }), "muscle");
}

function draw() {
  const muscle = state.session?.muscle;
  if (!muscle) return;
  const choice = select("shipped");
  choice.value = muscle.shipped ?? "";
  const own = choice.querySelector('option[value=""]');
  if (own) own.textContent = muscle.shipped ? "own file" : muscle.name;
  if (drawnFor === muscle.toml) return;
  drawnFor = draft = muscle.toml;
  input("muscle-toml").value = draft;
  drawForm();
}

function drawForm() {
  const form = byId("muscle-form");
  let table = "";
  const rows = numbersOf(draft).flatMap((field) => {
    const id = `field-${[field.table, field.key].filter(Boolean).join("-").replace(/[^A-Za-z0-9_-]/g, "-")}`;
    const head = field.table !== table ? [h("h3", null, field.table)] : [];
    table = field.table;
    const box = h("input", { id, type: "text", value: field.value, "data-key": field.key, "data-table": field.table, autocomplete: "off", spellcheck: "false" });
    box.addEventListener("change", () => void edit(field, box.value.trim()));
    return [...head, h("label", { for: id }, field.key.replaceAll("_", " ")), box];
  });
  fill(form, ...rows);
}

/** @param {import("./toml.js").Field} field @param {string} value */
async function edit(field, value) {
  if (!value) return;
  const taken = numbersOf(state.session?.muscle.toml ?? "").find((one) => nameOf(one) === nameOf(field));
  if (taken?.value === value) edits.delete(nameOf(field));
  else edits.set(nameOf(field), value);
  await send(edited());
}

/** @param {string} says */
function showRefusal(says) {
  // Of a field that holds no number the server's muscle knows where it stands.
  const field = fieldNamed(numbersOf(state.session?.muscle.toml ?? ""), says) ?? fieldNamed(numbersOf(draft), says);
  for (const old of document.querySelectorAll("#muscle-form .field-error")) old.remove();
  const box = field && [...document.querySelectorAll("#muscle-form input")].find((one) => one instanceof HTMLInputElement && one.dataset.key === field.key && one.dataset.table === field.table);
  input("muscle-toml").value = draft;
  if (!box) return;
  showAt("muscle", "");
  box.setAttribute("aria-invalid", "true");
  const note = h("p", { class: "field-error", id: `${box.id}-error`, role: "alert" }, withoutExcerpt(says));
  box.setAttribute("aria-describedby", note.id);
  box.after(note);
}

function clearComplaints() {
  showAt("muscle", "");
  for (const box of document.querySelectorAll("#muscle-form [aria-invalid]")) box.removeAttribute("aria-invalid");
  for (const old of document.querySelectorAll("#muscle-form .field-error")) old.remove();
}

/** The form as the server's muscle has it. */
function startAnew() {
  edits.clear();
  clearComplaints();
  drawnFor = "";
  draw();
}

/** @param {Blob} file */
async function takeFile(file) {
  edits.clear();
  await send(await file.text());
}

export async function startMusclePanel() {
  on("session", (why) => {
    if (why === "refused") return;
    // What stands in the fields and isn't taken keeps its complaint, whatever else is changed.
    if (edits.size && drawnFor === state.session?.muscle.toml) return;
    edits.clear();
    clearComplaints();
    draw();
  });
  on("refused", ({ says, where }) => {
    if (where === "muscle") showRefusal(says);
  });
  input("muscle-file").addEventListener("change", () => {
    const file = input("muscle-file").files?.[0];
    if (file) void takeFile(file);
    input("muscle-file").value = "";
  });
  addEventListener("muscle-file", (event) => void takeFile(/** @type {CustomEvent<File>} */ (event).detail));
  byId("muscle-apply").addEventListener("click", () => {
    edits.clear();
    void send(input("muscle-toml").value);
  });
  byId("muscle-revert").addEventListener("click", startAnew);
  const choice = select("shipped");
  choice.addEventListener("change", () => {
    const shipped = choice.value;
    if (shipped) void change(() => ({ muscle: { shipped } }), "muscle");
  });
  try {
    /** @type {{muscles: {name: string, title: string}[]}} */
    const { muscles } = await get("muscles");
    fill(choice, h("option", { value: "" }, "own file"), h("optgroup", { label: "shipped" }, ...muscles.map(({ name, title }) => h("option", { value: name, title }, `${name}: ${title}`))));
  } catch (error) {
    report(error);
  }
  draw();
}
