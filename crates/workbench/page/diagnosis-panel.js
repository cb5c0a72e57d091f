// @ts-check
// Diagnose: a run with its progress, then the verdict as an offer. A preview switches the plots to a claim until it is kept or discarded.

import { diagnose, get, isAborted, Lost } from "./api.js";
import { byId, button, fill, h, keepingFocus } from "./dom.js";
import { notice } from "./notices.js";
import { drawInPlan } from "./plan-panel.js";
import { change, on, report, state, step, tell } from "./store.js";
import { showTab } from "./tabs.js";
import { verdict } from "./verdict.js";

/** @typedef {import("./types.js").Diagnosis} Diagnosis */
/** @typedef {import("./types.js").ChosenEffect} ChosenEffect */

/** In the browser's own memory of this tab while a diagnosis runs. */
const UNDER_WAY = "diagnosis under way";

/** @type {Diagnosis | null} */
let found = null;
/** How often there was another one, or none. */
let founds = 0;
/** The effects that the model had when it was diagnosed. @type {ChosenEffect[]} */
let askedWith = [];
let askedFor = "";
/** @type {AbortController | null} */
let running = null;
/** @type {{before: ChosenEffect[], names: string[], revision: number} | null} */
let preview = null;
/** @type {{share: number, what: string}} */
let progress = { share: 0, what: "" };

/** Takes what a diagnosis has found. @param {Diagnosis} result */
function take(result) {
  found = result;
  founds += 1;
  document.body.dataset.diagnosis = "done";
  tell("diagnosed", [...result.missing, ...(result.nearest ?? [])].flatMap((claim) => [claim.effect, ...(claim.class ?? []), ...(claim.rivals ?? []).slice(0, 3).map((rival) => rival.effect)]));
}

/** What a diagnosis is about, beside the effects. */
const subject = () => JSON.stringify([state.session?.data, state.session?.columns, state.session?.muscle.toml, state.session?.excluded]);

async function run() {
  showTab("diagnosis");
  running?.abort();
  running = new AbortController();
  const mine = running;
  progress = { share: 0, what: "" };
  askedWith = state.effects;
  askedFor = subject();
  found = null;
  failure = "";
  founds += 1;
  await endPreview(true);
  document.body.dataset.diagnosis = "running";
  draw();
  // Who leaves the page ends it; whoever comes back is told.
  sessionStorage.setItem(UNDER_WAY, "1");
  try {
    const result = await diagnose(mine.signal, (now) => {
      if (mine !== running) return;
      progress = now;
      drawProgress();
    });
    if (mine !== running) return;
    take(result);
  } catch (error) {
    if (mine !== running) return;
    document.body.dataset.diagnosis = "failed";
    if (!isAborted(error)) {
      // It is told until there is another answer: once the program runs again, this one is still missing.
      failure = error instanceof Lost ? "The diagnosis was interrupted, because the program ended: begin it again." : error instanceof Error ? error.message : "";
      report(error, "diagnosis");
    }
  } finally {
    if (mine === running) {
      running = null;
      sessionStorage.removeItem(UNDER_WAY);
      draw();
    }
  }
}

/** A diagnosis that is there already, of this session or of another tab. @param {import("./types.js").Session} session */
async function restore(session) {
  if (!session.diagnosis || running || found) return;
  try {
    const result = await get("diagnosis.json");
    if (running || found) return;
    askedWith = session.diagnosis.effects;
    askedFor = session.diagnosis.is_current ? subject() : "";
    take(result);
    draw();
  } catch (error) {
    report(error, "diagnosis");
  }
}

let failure = "";

function drawProgress() {
  const bar = /** @type {HTMLProgressElement | null} */ (document.getElementById("diagnosis-progress"));
  if (!bar) return;
  bar.value = progress.share;
  byId("diagnosis-what").textContent = `${Math.round(100 * progress.share)} %${progress.what ? `: ${progress.what}` : ""}`;
}

/** What the panel shows: it is filled anew only when this has changed, so that no button goes away below a click. */
let shown = "";

function draw() {
  const isStale = askedFor !== subject();
  const key = JSON.stringify([Boolean(running), founds, failure, isStale, preview?.names, state.effects]);
  if (key === shown) return;
  shown = key;
  keepingFocus(byId("diagnosis-panel"), fillPanel);
}

function fillPanel() {
  const panel = byId("diagnosis-panel");
  button("diagnose").textContent = running ? "Diagnosing" : "Diagnose";
  button("diagnose").classList.toggle("running", Boolean(running));
  if (running) {
    fill(
      panel, h("p", null, "Looking for what the model lacks."), h("progress", { id: "diagnosis-progress", max: 1, value: 0, "aria-label": "Progress of the diagnosis" }),
      h("p", { id: "diagnosis-what", role: "status", class: "facts" }), h("button", { type: "button", id: "diagnosis-cancel", class: "small", onclick: cancel }, "Cancel"),
    );
    drawProgress();
    return;
  }
  if (!found) {
    fill(
      panel, failure ? h("p", { class: "error" }, failure) : null,
      h("p", { class: "empty" }, "Which physical effect is missing, and how sure that is: press Diagnose. What is found is an offer; nothing is switched on by itself."),
      h("button", { type: "button", class: "primary", onclick: () => void run() }, "Diagnose"),
    );
    return;
  }
  const isStale = askedFor !== subject();
  const on = askedWith.map((one) => one.name);
  const claimed = [...on, ...found.missing.map((claim) => claim.effect)];
  const isOther = !isStale && !(on.every((name) => state.effects.some((one) => one.name === name)) && state.effects.every((one) => claimed.includes(one.name)));
  fill(
    panel, failure ? h("p", { class: "error" }, failure) : null, isStale ? h("p", { class: "remark" }, "Data or muscle have changed since this diagnosis.") : null,
    isOther ? h("p", { class: "remark", id: "diagnosed-with" }, `This is about the model with ${on.length ? on.join(", ") : "no effect"} on; since then effects were switched.`) : null,
    preview ? previewBox(preview) : null,
    ...verdict(found, { has: isKept, accept, tryInstead, showMe, plan: drawInPlan }),
    h("div", { class: "row end" }, h("button", { type: "button", id: "diagnose-again", class: "primary", onclick: () => void run() }, "Go on: diagnose again with what is on"), h("a", { href: "api/diagnosis-report", target: "_blank", rel: "noopener", class: "button small" }, "Report")),
  );
}

/** @param {{names: string[]}} of */
function previewBox(of) {
  return h(
    "div", { class: "preview", id: "preview", role: "status" }, h("p", null, "Preview: the plots show the model with ", h("b", null, of.names.join(", ")), "."),
    h("button", { type: "button", class: "small primary", id: "preview-keep", onclick: () => void endPreview(true) }, "Keep"), " ",
    h("button", { type: "button", class: "small", id: "preview-discard", onclick: () => void endPreview(false) }, "Discard"),
  );
}

function cancel() {
  const was = running;
  running = null;
  was?.abort();
  document.body.dataset.diagnosis = "cancelled";
  draw();
  notice("The diagnosis is cancelled.");
}

/** @param {ChosenEffect[]} effects @param {string[]} names those that it lacks, behind it */
const withNames = (effects, names) => [...effects, ...names.filter((name) => !effects.some((effect) => effect.name === name)).map((name) => ({ name }))];

/** Whether the model has an effect beyond a preview. @param {string} name */
const isKept = (name) => (preview?.before ?? state.effects).some((effect) => effect.name === name);

/** @param {string[]} names */
async function accept(names) {
  // What was shown as a preview becomes the answer.
  preview = null;
  await change((now) => ({ effects: withNames(now.effects, names) }), "effects");
  draw();
}

/** @param {string} claim @param {string} rival */
async function tryInstead(claim, rival) {
  preview = null;
  await change((now) => ({ effects: withNames(now.effects.filter((effect) => effect.name !== claim), [rival]) }), "effects");
  draw();
}

/** Shows the plots with the model as diagnosed and these effects. @param {string[]} names */
async function showMe(names) {
  const before = preview?.before ?? state.effects;
  const isTaken = await change((now) => {
    const effects = withNames(askedWith, names);
    return JSON.stringify(effects) === JSON.stringify(now.effects) ? null : { effects };
  }, "effects");
  if (isTaken) preview = { before, names, revision: state.session?.revision ?? 0 };
  draw();
}

/** @param {boolean} isKept */
async function endPreview(isKept) {
  const was = preview;
  preview = null;
  if (was && !isKept) {
    // Where nothing came after it, the preview leaves no trace in what can be undone.
    if (state.session?.revision === was.revision && JSON.stringify(was.before) !== JSON.stringify(state.effects)) await step("undo");
    if (JSON.stringify(was.before) !== JSON.stringify(state.effects)) await change(() => ({ effects: was.before }), "effects");
  }
  draw();
}

export function startDiagnosis() {
  if (sessionStorage.getItem(UNDER_WAY)) failure = "The last diagnosis was given up, because the page was left: begin it again.";
  sessionStorage.removeItem(UNDER_WAY);
  button("diagnose").addEventListener("click", () => (running ? showTab("diagnosis") : void run()));
  on("session", () => {
    // An undo, or a switch, may take a preview away.
    if (preview && !preview.names.every((name) => state.effects.some((effect) => effect.name === name))) preview = null;
    draw();
    if (state.session) void restore(state.session);
  });
  draw();
}
