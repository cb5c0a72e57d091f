// @ts-check
// What the page knows, and the one way in which it changes: a change goes to the server, its documents come back, everybody who listens redraws.

import { get, getRows, isAborted, Lost, post, putSession, Refusal } from "./api.js";
import * as topics from "./topics.js";

/** @typedef {import("./types.js").Session} Session */
/** @typedef {import("./types.js").Rows} Rows */
/** @typedef {import("./types.js").Comparison} Comparison */
/** @typedef {import("./types.js").Card} Card */
/** @typedef {"session" | "documents" | "held-out" | "cards" | "selection" | "hover" | "theme" | "view" | "refused" | "lost" | "outdated" | "found" | "busy" | "numbers" | "tab" | "diagnosed"} Topic */

/** @type {Session | null} */
let session = null;
/** @type {Rows | null} */
let rows = null;
/** @type {Comparison | null} */
let comparison = null;
/** @type {Card[]} */
let cards = [];
/** Rest after which held-out errors are asked for [ms]: they take both cores. */
const HELD_OUT_AFTER = 400;
let heldOutIsPending = false;
let isLost = false;
/** What of the view isn't with the server yet. @type {import("./types.js").View} */
let unsaved = {};
let runs = 0;
let waiting = 0;
/** When what was last asked for has been drawn. @type {Promise<unknown>} */
let drawn = Promise.resolve();
let computing = new AbortController();
/** The content of the session that the documents belong to. */
let computedFor = "";
let cardsFor = "";

/** @type {(topic: Topic, then: (detail?: any) => void) => void} */
export const on = topics.on;
/** @type {(topic: Topic, detail?: unknown) => void} */
export const tell = topics.tell;

export const state = {
  get session() { return session; },
  get rows() { return rows; },
  get comparison() { return comparison; },
  get cards() { return cards; },
  get heldOutIsPending() { return heldOutIsPending; },
  get isLost() { return isLost; },
  /** @param {string} name @returns {Card | undefined} */
  card(name) { return cards.find((card) => card.name === name); },
  get effects() { return session?.effects ?? []; },
};

function showState() {
  const next = isLost ? "error" : waiting > 0 ? "busy" : "ready";
  if (document.body.dataset.state !== next) {
    document.body.dataset.state = next;
    tell("busy", next === "busy");
  }
}

/** Counts what is under way, so that the page can say that it is busy. @template T @param {() => Promise<T>} work @returns {Promise<T>} */
async function counted(work) {
  waiting += 1;
  showState();
  try {
    return await work();
  } finally {
    waiting -= 1;
    showState();
  }
}

/** @param {unknown} error @param {string} [where] */
export function report(error, where) {
  if (isAborted(error)) return;
  if (error instanceof Lost) {
    isLost = true;
    showState();
    tell("lost", error.message);
    return;
  }
  if (error instanceof Refusal) {
    tell("refused", { says: error.message, where: where ?? error.where });
    return;
  }
  throw error;
}

/** All that the documents depend on. @param {Session} of */
const content = (of) => JSON.stringify([of.data, of.columns, of.muscle.toml, of.effects, of.own_effects, of.excluded]);

/** Takes a session as the current one, unless a newer one is there. @param {Session} next @param {boolean} [again] computes the documents even so */
function take(next, again = false) {
  if (session && next.revision < session.revision && !again) return;
  session = { ...next, view: { ...next.view, ...unsaved } };
  // The documents are on their way while the choices are drawn.
  if (!next.problem && (again || content(next) !== computedFor)) void compute(content(next));
  tell("session");
  if (next.problem) refuseAll(next.problem);
}

/** What is drawn belongs to older choices: plots are shown as such, and no number stands under a name that it wasn't computed for. */
function isOutdated() {
  document.body.dataset.stale = "true";
  comparison = null;
  tell("outdated");
}

/** Nothing can be computed with these choices. @param {{error: string, where: string}} problem */
function refuseAll(problem) {
  computing.abort();
  runs += 1;
  computedFor = "";
  heldOutIsPending = false;
  document.body.dataset.heldOut = "done";
  isOutdated();
  tell("refused", { says: problem.error, where: problem.where, blocks: true });
  void loadCards();
}

/** Fetches what belongs to the session; an older run is aborted, and what it may still bring is dropped. @param {string} key */
async function compute(key) {
  computing.abort();
  computing = new AbortController();
  const { signal } = computing;
  runs += 1;
  const mine = runs;
  computedFor = key;
  heldOutIsPending = true;
  document.body.dataset.heldOut = "pending";
  try {
    const drawing = counted(async () => {
      const [quick, all] = await Promise.all([get("comparison?held_out=0", signal), getRows(signal)]);
      if (mine !== runs) return;
      comparison = quick;
      rows = all;
      delete document.body.dataset.stale;
      performance.mark("documents:here");
      tell("documents");
      performance.mark("documents:drawn");
    });
    drawn = drawing.catch(() => undefined);
    await drawing;
    if (mine !== runs) return;
    void loadCards();
    // What is asked in a quick succession waits for nothing but its own fit.
    await new Promise((then) => setTimeout(then, HELD_OUT_AFTER));
    if (mine !== runs) return;
    const full = await get("comparison?held_out=1", signal);
    if (mine !== runs) return;
    comparison = full;
  } catch (error) {
    if (mine === runs) {
      computedFor = "";
      if (error instanceof Refusal) {
        isOutdated();
        tell("refused", { says: error.message, where: error.where, blocks: true });
        // The same choices may be possible with what is changed next.
        void loadCards();
      } else report(error);
    }
  }
  if (mine === runs) {
    heldOutIsPending = false;
    document.body.dataset.heldOut = "done";
    tell("held-out");
  }
}

/** The catalogue depends on muscle, data and own effects, not on what is switched on. */
async function loadCards() {
  if (!session) return;
  const key = JSON.stringify([session.muscle.toml, session.own_effects, session.data.names, session.columns]);
  if (key === cardsFor) return;
  try {
    cards = (await get("effects")).effects;
    cardsFor = key;
    tell("cards");
  } catch (error) {
    report(error);
  }
}

/** @type {Promise<unknown>} */
let queue = Promise.resolve();

/**
 * One change after the other; each is made from the session that the one before it left.
 *
 * @param {(session: Session) => Record<string, unknown> | null} make
 * @param {string} [where] the part of the page that a refusal belongs to
 * @returns {Promise<boolean>} whether the server took it
 */
export function change(make, where) {
  const mine = queue.then(() => counted(async () => {
    const patch = session && make(session);
    if (!patch) return false;
    try {
      take(await putSession(patch));
      return true;
    } catch (error) {
      report(error, where);
      // Switches that were moved ahead of the answer go back.
      tell("session", "refused");
      return false;
    }
  }));
  queue = mine.catch(() => undefined);
  return mine;
}

let preparing = new AbortController();

/** Has the server get ready for effects that may be switched on next: an older wish is given up. @param {(session: Session) => import("./types.js").ChosenEffect[]} make */
export function prepare(make) {
  preparing.abort();
  // Whatever runs now comes first, and a muscle that can't be compared has nothing to get ready for.
  if (!session || session.problem || isLost) return;
  preparing = new AbortController();
  // It is a wish: an answer that fails says so when the effect is switched on.
  post("prepare", JSON.stringify(make(session)), preparing.signal).catch(() => undefined);
}

let sliding = false;
/** @type {(() => void) | null} */
let slideNext = null;
/** @type {Promise<unknown>} */
let slid = Promise.resolve();

/** Once the last position of a slider has been drawn. */
export async function whenSlid() {
  while (sliding) await slid;
}

/** For sliders: at most one change is under way until it is drawn, and of those that follow the last one counts. @param {(session: Session) => Record<string, unknown> | null} make */
export function changeSoon(make) {
  if (sliding) {
    slideNext = () => changeSoon(make);
    return;
  }
  sliding = true;
  slid = change(make).then(() => drawn).finally(() => {
    sliding = false;
    const next = slideNext;
    slideNext = null;
    next?.();
  });
}

/** @param {"undo" | "redo"} which */
export function step(which) {
  const mine = queue.then(() => counted(async () => {
    try {
      take(await post(which), true);
    } catch (error) {
      report(error);
    }
  }));
  queue = mine.catch(() => undefined);
  return mine;
}

/**
 * @param {Blob} file
 * @param {string} name
 * @param {{add?: boolean}} [how]
 */
export function sendFile(file, name, how = {}) {
  const query = new URLSearchParams({ name });
  if (how.add) query.set("add", "1");
  const mine = queue.then(() => counted(async () => {
    take(await post(`data?${query}`, file), true);
  }));
  queue = mine.catch(() => undefined);
  return mine;
}

/** Asks for the session: at the start, after a reconnection, and when another tab has changed it. */
export async function load() {
  try {
    const next = await counted(() => get("session"));
    if (isLost) {
      isLost = false;
      // A new server counts its revisions from the start.
      session = null;
      computedFor = cardsFor = "";
      showState();
      tell("found");
    }
    take(next);
  } catch (error) {
    const isElsewhere = error instanceof Refusal && (error.status === 403 || error.status === 404);
    report(isElsewhere ? new Lost("This address has ended: open the one that bulge open prints now.") : error);
  }
}

let saveTimer = 0;

/** Keeps axes and the like with the session; nothing is computed again. @param {import("./types.js").View} part */
export function keepView(part) {
  if (!session) return;
  unsaved = { ...unsaved, ...part };
  session.view = { ...session.view, ...part };
  tell("view");
  clearTimeout(saveTimer);
  saveTimer = window.setTimeout(() => {
    const part = unsaved;
    unsaved = {};
    void change((now) => ({ view: { ...now.view, ...part } }));
  }, 400);
}
