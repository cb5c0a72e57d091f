// @ts-check
// Plan: a test before it is made, drawn over pressure and contraction, and what it would show and tell apart.

import { get, isAborted, post, Refusal } from "./api.js";
import { afterRest, button, byId, download, fill, h, keepingFocus } from "./dom.js";
import { counted, newtons, number, withoutExcerpt } from "./format.js";
import { blockColour, plane } from "./plan-plane.js";
import { block, duration, isHeld, isStatic, protocol, stairs } from "./protocol.js";
import { keepView, on, report, state } from "./store.js";
import { showTab } from "./tabs.js";

/** @typedef {import("./protocol.js").Block} Block */
/** @typedef {{effect: string, family: string, detection_limit_n: number | null, usual_sigma: number, compensation: number, why: string | null}} PlannedEffect */
/** @typedef {{effects: [string, string], cosine: number, sigma: number, repeats: number | null, separate: string}} Pair */
/** @typedef {{toml: string, seconds: number, plan: {rows: number, sweeps: number, effects: PlannedEffect[], confused: Pair[], warnings: string[], noise: {says: string}}}} Planned */

/** Effects and pairs that are shown before the rest. */
const [MOST_EFFECTS, MOST_PAIRS] = [12, 8];

/** @type {Planned | null} */
let planned = null;
let failure = "";
let isPlanning = false;
let isAsking = false;
let asking = new AbortController();
let askedFor = "";
/** Effects of the last diagnosis: pairs of them come first. @type {Set<string>} */
let wanted = new Set();

/** The blocks that were cleared last. @type {Block[]} */
let cleared = [];

/** The test that the data come from, about, with what it belongs to. @type {{of: string, blocks: Block[]}} */
let measured = { of: "", blocks: [] };

const isShown = () => !byId("plan-panel").hidden;

/** Asks for the test that the data come from, unless it is there. */
async function lookAtData() {
  const { session } = state;
  const of = JSON.stringify([session?.data, session?.columns, session?.muscle.toml]);
  if (!isShown() || !session || !state.rows || measured.of === of) return;
  measured = { of, blocks: [] };
  try {
    const { blocks } = await get("protocol");
    if (measured.of !== of) return;
    measured = { of, blocks };
    draw();
    ask();
  } catch (error) {
    measured = { of: "", blocks: [] };
    report(error);
  }
}

/** The test that is planned; as long as nobody has drawn one, that of the data. @returns {{blocks: Block[], noise_n: number | null}} */
function test() {
  const kept = state.session?.view.plan;
  return { blocks: kept?.blocks ?? measured.blocks, noise_n: kept?.noise_n ?? null };
}

/** The noise that is stated, else what the data show. */
const noise = () => test().noise_n ?? Number((state.comparison?.noise_floor?.sd_n ?? 0).toPrecision(2));

/** @param {{blocks?: Block[], noise_n?: number | null}} part */
function keep(part) {
  keepView({ plan: { ...test(), ...part } });
  draw();
  ask();
}

/** The same from a field: the form stays, with whoever is on the way to its next field. @param {{blocks?: Block[], noise_n?: number | null}} part */
function keepField(part) {
  keepView({ plan: { ...test(), ...part } });
  drawPlane();
  ask();
}

/** @param {number} i @param {Partial<Block>} part */
const edited = (i, part) => ({ blocks: test().blocks.map((one, j) => (i === j ? block({ ...one, ...part }) : one)) });
/** @param {number} i @param {Partial<Block>} part */
const edit = (i, part) => keepField(edited(i, part));

/** What the answer depends on. */
const key = () => JSON.stringify([test().blocks, noise(), state.session?.muscle.toml, state.effects, state.session?.own_effects, state.session?.data, state.session?.excluded]);

async function askNow() {
  if (!isShown() || !state.session) return;
  if (key() === askedFor) {
    // Changed and changed back: what stands there, or is on its way, is right.
    isPlanning = isAsking;
    drawAnswer();
    return;
  }
  const { blocks } = test();
  asking.abort();
  asking = new AbortController();
  const mine = asking;
  askedFor = key();
  failure = "";
  if (!blocks.length) {
    planned = null;
    isPlanning = false;
    isAsking = false;
    drawAnswer();
    return;
  }
  isPlanning = true;
  isAsking = true;
  drawAnswer();
  try {
    const found = await post("plan", JSON.stringify(protocol(blocks, noise() > 0 ? { force_n: noise() } : {})), mine.signal);
    if (mine !== asking) return;
    planned = { ...found, seconds: blocks.reduce((sum, one) => sum + duration(one), 0) };
  } catch (error) {
    if (mine !== asking || isAborted(error)) return;
    planned = null;
    if (error instanceof Refusal) failure = withoutExcerpt(error.message).replace(/^the protocol:\d+:\d+: /, "");
    else report(error);
  }
  isAsking = false;
  isPlanning = false;
  drawAnswer();
}

const askSoon = afterRest(300, () => void askNow());

function ask() {
  // What stands there is about another test from now on.
  if (isShown() && key() !== askedFor) {
    isPlanning = true;
    drawAnswer();
  }
  askSoon();
}

/** Draws a test in the plan, and shows it. @param {import("./protocol.js").Protocol} of @param {number} repeats how often it is to be made */
export function drawInPlan(of, repeats) {
  showTab("plan");
  keep({ blocks: of.blocks.map((one) => block({ ...one, repeats: one.repeats * repeats })), noise_n: of.noise.force_n || null });
}

/** Numbers between commas or blanks. A comma within a number is a decimal one where semicolons stand between the numbers; one comma alone can be either. @param {string} text @returns {number[] | null} */
function numbers(text) {
  const plain = text.trim().replaceAll("−", "-");
  if (/^[^,;]*\d,\d[^,;]*$/.test(plain)) return null;
  const words = plain.includes(";") ? plain.replaceAll(/(\d),(\d)/g, "$1.$2").split(/[;\s]+/) : plain.split(/[,\s]+/);
  const found = words.filter(Boolean).map(Number);
  return found.length && found.every(Number.isFinite) ? found : null;
}

/**
 * @param {string} label @param {string} id @param {number[]} value @param {(values: number[]) => void} then
 * @param {{least?: number, most?: number, isWhole?: boolean, low?: number, example: string}} how how many numbers it takes, and which
 */
function field(label, id, value, then, { least = 1, most = 1, isWhole = false, low = -Infinity, example }) {
  const box = h("input", { type: "text", id, value: value.map((one) => String(Number(one.toPrecision(6)))).join(", "), autocomplete: "off", inputmode: "decimal", "data-field": id });
  const wrong = h("span", { class: "field-error", role: "alert" });
  box.addEventListener("change", () => {
    const found = numbers(box.value);
    const isRight = found && found.length >= least && found.length <= most && found.every((one) => one >= low && (!isWhole || Number.isInteger(one)));
    box.setAttribute("aria-invalid", String(!isRight));
    wrong.textContent = isRight ? "" : `write ${most === 1 ? (isWhole ? "a whole number" : "a number") : least === 2 ? "two numbers" : "numbers"} such as ${example}`;
    if (found && isRight) then(found);
  });
  return [h("label", { for: id }, label), h("span", null, box, wrong)];
}

const MOTIONS = /** @type {[string, string, Partial<Block>][]} */ ([
  ["loops", "loops, at even speed", { path: "triangle", held: [] }],
  ["sine", "loops, as a sine", { path: "sine", held: [] }],
  ["stairs", "steps with holds", { path: { stairs: { steps: 6, hold_s: 5 } }, held: [] }],
  ["static", "single readings", { path: "static", held: [] }],
  ["held", "held lengths", { path: "triangle" }],
]);

/** @param {Block} of */
const motion = (of) => (isHeld(of) ? "held" : isStatic(of) ? "static" : stairs(of) ? "stairs" : of.path === "sine" ? "sine" : "loops");

/** The same block with another motion; what it lacks is as usual. @param {Block} of @param {string} name @returns {Partial<Block>} */
function moved(of, name) {
  const part = MOTIONS.find((one) => one[0] === name)?.[2] ?? {};
  const [low, high] = [Math.min(...of.pressures_pa), Math.max(...of.pressures_pa)];
  if (name === "held") return { ...part, period_s: of.period_s || 60, held: of.held?.length ? of.held : [...of.contraction], pressures_pa: low < high ? [low, high] : [low / 3, high] };
  const period_s = of.period_s || 60;
  // Each step has two rows, and more time than its hold.
  if (name === "stairs") return { ...part, rows: Math.max(of.rows, 48), period_s: Math.max(period_s, 120) };
  return { ...part, period_s: name === "static" ? 0 : period_s };
}

/** @param {Block} of @param {number} i */
function blockForm(of, i) {
  const id = (/** @type {string} */ name) => `block-${i}-${name}`;
  const percents = (/** @type {number[]} */ values) => values.map((value) => 100 * value);
  const shares = (/** @type {number[]} */ values) => values.map((value) => value / 100);
  const bars = (/** @type {number[]} */ values) => values.map((value) => value / 1e5);
  const pascals = (/** @type {number[]} */ values) => values.map((value) => 1e5 * value);
  const mark = h("span", { class: "block-mark", "aria-hidden": "true" });
  const one = (/** @type {"cycles" | "period_s" | "rows" | "repeats"} */ name, /** @type {string} */ label, /** @type {string} */ example) => field(label, id(name), [of[name]], ([value]) => edit(i, { [name]: value }), { example, low: name === "period_s" ? 0 : 1, isWhole: name !== "period_s" });
  const its = stairs(of);
  const choose = h("select", { id: id("motion"), "data-motion": i }, ...MOTIONS.map(([name, label]) => h("option", { value: name }, label)));
  choose.value = motion(of);
  choose.addEventListener("change", () => keep(edited(i, moved(test().blocks[i], choose.value))));
  return h(
    "fieldset", { class: "block", "data-block": i },
    h("legend", null, mark, `block ${i + 1}`, " ", h("button", { type: "button", class: "link", "data-remove": i, onclick: () => keep({ blocks: test().blocks.filter((_, j) => j !== i) }) }, "remove")),
    h("div", { class: "fields" },
      h("label", { for: id("motion") }, "motion"), choose,
      ...(isHeld(of) ? [
        ...field("contractions [%]", id("held"), percents(of.held ?? []), (v) => edit(i, { held: shares(v) }), { most: 100, example: "2, 10" }),
        ...field("pressure [bar]", id("pressures"), bars([Math.min(...of.pressures_pa), Math.max(...of.pressures_pa)]), (v) => edit(i, { pressures_pa: pascals(v) }), { least: 2, most: 2, example: "0.5, 6" }),
      ] : [
        ...field("pressures [bar]", id("pressures"), bars(of.pressures_pa), (v) => edit(i, { pressures_pa: pascals(v) }), { most: 100, example: "2, 3, 4" }),
        ...field("contraction [%]", id("contraction"), percents(of.contraction), ([low, high]) => edit(i, { contraction: [low / 100, high / 100] }), { least: 2, most: 2, example: "1, 20" }),
      ]),
      ...(isStatic(of) ? [] : [...one("period_s", "period [s]", "60"), ...one("cycles", "cycles", "3")]),
      ...(its ? [
        ...field("steps up", id("steps"), [its.steps], ([steps]) => edit(i, { path: { stairs: { ...its, ...stairs(test().blocks[i]), steps } } }), { example: "6", isWhole: true, low: 1 }),
        ...field("hold [s]", id("hold"), [its.hold_s], ([hold_s]) => edit(i, { path: { stairs: { ...its, ...stairs(test().blocks[i]), hold_s } } }), { example: "5" }),
      ] : []),
      ...one("rows", isStatic(of) ? "rows" : "rows a cycle", "50"), ...one("repeats", "repeats", "2")),
  );
}

/** @param {PlannedEffect} one */
const effectRow = (one) => h(
  "tr", { class: wanted.has(one.effect) ? "wanted" : null }, h("td", null, one.effect),
  h("td", { class: "n", title: "least RMS change of the force that is seen, 3.3 standard deviations" }, newtons(one.detection_limit_n)), h("td", { class: "n", title: "standard deviations at its usual size" }, `${number(one.usual_sigma, 2)} σ`),
);

/** @param {Planned} of @returns {import("./dom.js").Child[]} */
function answer({ plan, seconds }) {
  const seen = plan.effects.filter((one) => one.detection_limit_n !== null);
  // What the model has already is no question.
  const isKnown = (/** @type {PlannedEffect} */ one) => state.effects.some((effect) => effect.name === one.effect);
  const unseen = plan.effects.filter((one) => one.detection_limit_n === null && !isKnown(one));
  const first = (/** @type {Pair} */ pair) => pair.effects.filter((name) => wanted.has(name)).length;
  const pairs = [...plan.confused].sort((a, b) => first(b) - first(a) || b.cosine - a.cosine);
  const head = h("thead", null, h("tr", null, h("th", null, "effect"), h("th", { class: "n" }, "seen from"), h("th", { class: "n" }, "usual size")));
  return [
    h("p", { class: "facts", id: "plan-facts" }, `${counted(plan.rows, "row")} in ${counted(plan.sweeps, "sweep")}`, seconds ? `, ${seconds < 120 ? `${number(seconds)} s` : seconds < 7200 ? `${number(seconds / 60)} min` : `${number(seconds / 3600)} h`}` : "", `; noise: ${plan.noise.says}`),
    h("table", { id: "plan-pairs" }, h("caption", null, "hardly told apart"), h("tbody", null, ...(pairs.length ? pairs.slice(0, MOST_PAIRS).map((pair) => h(
      "tr", { title: pair.separate, class: first(pair) ? "wanted" : null }, h("td", null, pair.effects.join(" / ")), h("td", { class: "n" }, `${number(pair.sigma, 2)} σ`), h("td", { class: "n" }, pair.repeats === null ? "never" : pair.repeats <= 1 ? "once" : `${number(pair.repeats, 2)} times`),
    )) : [h("tr", null, h("td", null, "no two effects look alike in this test"))]))),
    pairs.length ? h("p", { class: "facts" }, "Standard deviations between the two, each at its usual size, and how often the test must be made to tell them apart. Point at a pair to read what would separate them.") : null,
    h("table", { id: "plan-effects" }, h("caption", null, "what it would show"), head, h("tbody", null, ...seen.slice(0, MOST_EFFECTS).map(effectRow))),
    seen.length > MOST_EFFECTS ? h("details", { "data-more": "effects" }, h("summary", null, `${seen.length - MOST_EFFECTS} more, harder to see`), h("table", null, h("tbody", null, ...seen.slice(MOST_EFFECTS).map(effectRow)))) : null,
    unseen.length ? h("details", { "data-more": "unseen" }, h("summary", null, `${unseen.length} cannot be seen`), h("ul", null, ...unseen.map((one) => h("li", null, h("b", null, one.effect), one.why ? `: ${one.why}` : "")))) : null,
    ...plan.warnings.map((text) => h("p", { class: "remark" }, text)),
  ];
}

function draw() {
  if (!isShown()) return;
  keepingFocus(byId("plan-panel"), () => {
    const { blocks } = test();
    const drawnBefore = state.session?.view.plan?.blocks;
    fill(
      byId("plan-panel"),
      h("p", { class: "empty" }, drawnBefore ? "Drag a rectangle for loops at three pressures, an upright line for one pressure, a level one for a held length." : "What would a test show that is not made yet? This is about the one of the data, as far as blocks describe it. Drag to add to it, or clear it and draw another: a rectangle for loops at three pressures, an upright line for one pressure, a level one for a held length."),
      h("div", { id: "plan-room" }),
      h("div", { class: "row" },
        h("button", { type: "button", class: "small", id: "add-block", onclick: () => keep({ blocks: [...test().blocks, block({ ...test().blocks.at(-1) })] }) }, "Add a block"),
        h("button", { type: "button", class: "small", id: "plan-data", disabled: !measured.blocks.length, onclick: () => keep({ blocks: measured.blocks }) }, "About as the data"),
        h("button", { type: "button", class: "small", id: "clear-plan", disabled: !blocks.length, onclick: () => {
          cleared = blocks;
          keep({ blocks: [] });
        } }, "Clear"),
        cleared.length && !blocks.length ? h("button", { type: "button", class: "small", id: "unclear-plan", onclick: () => keep({ blocks: cleared }) }, "Bring them back") : null,
        h("button", { type: "button", class: "small", id: "save-protocol", disabled: !planned, onclick: () => planned && download(new Blob([planned.toml], { type: "application/toml" }), "protocol.toml") }, "Save as TOML")),
      h("p", { class: "error", id: "plan-error", role: "alert" }),
      h("div", { id: "plan-answer" }),
      h("h4", null, "the test"),
      ...blocks.map((one, i) => blockForm(one, i)),
      h("div", { class: "fields" }, ...field("noise of the force [N]", "plan-noise", [noise()], ([value]) => keepField({ noise_n: value }), { example: "2, or 0 for that of the muscle's file", low: 0 })),
    );
    drawPlane();
    drawAnswer();
  });
}

function drawPlane() {
  const { blocks } = test();
  // The theme may have changed.
  document.querySelectorAll(".block-mark").forEach((mark, i) => {
    /** @type {HTMLElement} */ (mark).style.background = blockColour(i, blocks.length);
  });
  fill(byId("plan-room"), plane({ rows: state.rows, blocks, usual: blocks.at(-1) ?? block({}), add: (made) => keep({ blocks: [...test().blocks, made] }) }));
}

function drawAnswer() {
  if (!document.getElementById("plan-answer")) return;
  byId("plan-error").textContent = failure;
  byId("plan-error").hidden = !failure;
  button("save-protocol").disabled = !planned;
  const place = byId("plan-answer");
  place.classList.toggle("pending", isPlanning);
  place.setAttribute("aria-busy", String(isPlanning));
  keepingFocus(place, () => fill(place, ...(planned && test().blocks.length ? answer(planned) : isPlanning ? [h("p", { class: "facts" }, "Looking at what it would show.")] : [])));
}

export function startPlan() {
  for (const topic of /** @type {const} */ (["documents", "held-out", "theme"])) on(topic, () => {
    // As long as nobody has drawn a test it follows the data; the fields of one that is drawn stay as they are.
    if (state.session?.view.plan && document.getElementById("plan-room")) drawPlane();
    else draw();
    ask();
    void lookAtData();
  });
  on("tab", () => {
    draw();
    ask();
    void lookAtData();
  });
  on("diagnosed", (names) => {
    wanted = new Set(names);
    drawAnswer();
  });
}
