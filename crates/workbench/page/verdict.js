// @ts-check
// A diagnosis as an offer: the sentences and numbers of its document, with what can be done about each claim.

import { h } from "./dom.js";
import { interval as intervalOf, newtons, number, percent, quantity, sentence } from "./format.js";

/** @typedef {import("./types.js").Diagnosis} Diagnosis */
/** @typedef {import("./types.js").Claim} Claim */
/**
 * @typedef {object} Does
 * @property {(name: string) => boolean} has
 * @property {(names: string[]) => void} accept
 * @property {(claim: string, rival: string) => void} tryInstead
 * @property {(names: string[]) => void} showMe
 * @property {(protocol: import("./protocol.js").Protocol, repeats: number) => void} plan
 */

/** Rivals that are offered. */
const MOST_RIVALS = 3;

/** What was fitted is what is switched on. @param {Claim} claim */
const fittedName = (claim) => claim.fitted ?? claim.effect;

/** @param {Diagnosis} found @param {Does} does @returns {import("./dom.js").Child[]} */
export function verdict(found, does) {
  const names = found.missing.map(fittedName);
  const isBent = found.ladder.some((rung) => rung.bent && rung.adequate);
  return [
    h("div", { class: `verdict ${found.verdict}${isBent ? " bent" : ""}`, id: "verdict", "data-verdict": found.verdict }, found.says.startsWith(found.verdict) ? null : h("h3", null, found.verdict.replaceAll("-", " ")), h("p", { class: "headline" }, found.says), isBent ? h("p", { class: "facts" }, "In the form that these data want, that is: what can be switched on are the formulas, and by them something is left, see the steps.") : null),
    names.length > 1 ? h(
      "div", { class: "row" },
      h("button", { type: "button", class: "primary", id: "accept-all", onclick: () => does.accept(names), disabled: names.every(does.has) }, `Accept all ${names.length}`),
      h("button", { type: "button", id: "show-all", onclick: () => does.showMe(names) }, "Show me"),
    ) : null,
    ...found.missing.map((claim, i) => claimBox(claim, names.slice(0, i + 1), does, true)),
    ...((found.nearest ?? []).length ? [h("h4", null, "nearest"), .../** @type {Claim[]} */ (found.nearest).map((claim) => claimBox(claim, [fittedName(claim)], does, false))] : []),
    ladder(found),
    where(found),
    ...asides(found),
    next(found, does),
  ];
}

/** @param {Claim} claim @param {string[]} names up to it, as the ladder was built @param {Does} does @param {boolean} isClaim */
function claimBox(claim, names, does, isClaim) {
  const name = fittedName(claim);
  const others = claim.class?.filter((other) => other !== claim.effect) ?? [];
  const isThere = does.has(name);
  const facts = [
    ["mechanism", claim.mechanism?.replaceAll("-", " "), claim.confidence_mechanism],
    ["family", claim.family, claim.confidence],
    ["form", name, claim.confidence_form],
  ];
  return h(
    "section", { class: "claim", "data-claim": name },
    h("h4", null, claim.effect),
    h("table", { class: "sure" }, h("caption", { class: "visually-hidden" }, "How often such a claim is right"), h("tbody", null, ...facts.map(([term, what, confidence]) => h(
      "tr", null, h("th", { scope: "row" }, term), h("td", null, what), h("td", { class: "n", title: "on data like these such a claim is right so often" }, confidence === null || confidence === undefined ? "" : `right ${percent(Number(confidence))}`),
    )))),
    others.length ? h("p", null, h("span", { class: "label" }, "not told apart here: "), others.join(", ")) : null,
    claim.forms?.length ? h("p", null, h("span", { class: "label" }, "other forms of it: "), claim.forms.join(", ")) : null,
    claim.form_error?.share ? h("p", null, h("span", { class: "label" }, "the data bend its formula by "), `${percent(claim.form_error.share)}, ${newtons(claim.form_error.rms_n)} RMS`) : null,
    ...Object.entries(claim.parameters ?? {}).map(([key, p]) => h("p", null, h("span", { class: "label" }, `${key.replaceAll("_", " ")} `), h("b", null, quantity(p.value, p.unit, 4)), p.low !== null && p.high !== null ? h("span", { class: "interval" }, ` 95 %: ${intervalOf(p.low, p.high)}`) : null)),
    claim.plausible === false ? h("p", { class: "tag bad" }, "implausible number") : null,
    h(
      "div", { class: "row" },
      h("button", { type: "button", class: isClaim ? "small primary" : "small", "data-accept": name, disabled: isThere, onclick: () => does.accept([name]) }, isThere ? "On" : "Accept"),
      h("button", { type: "button", class: "small", "data-show": name, title: `Plots with ${names.join(", ")}`, onclick: () => does.showMe(names) }, "Show me"),
    ),
    rivals(claim, name, does),
  );
}

/** How much less likely a rival is, by how far its log evidence lies behind. @param {number | null} behind */
function odds(behind) {
  if (behind === null || !Number.isFinite(behind)) return "";
  if (behind < 0.7) return "as likely";
  const times = behind < 7 ? number(Math.exp(behind), 2) : `10^${Math.round(behind / Math.LN10)}`;
  return `${times} times less likely`;
}

/** @param {Claim} claim @param {string} name @param {Does} does */
function rivals(claim, name, does) {
  const near = [...(claim.rivals ?? [])].sort((a, b) => (a.behind ?? Infinity) - (b.behind ?? Infinity)).slice(0, MOST_RIVALS);
  if (!near.length) return null;
  return h(
    "details", { class: "rivals", "data-rivals": name }, h("summary", null, `Rivals: ${near.map((rival) => rival.effect).join(", ")}`),
    h("ul", null, ...near.map((rival) => h(
      "li", null, h("span", { class: "rival" }, rival.effect), h("span", { class: "facts", title: `behind by ${number(rival.behind)} in log evidence; ${number(rival.separation)} standard deviations between the two` }, odds(rival.behind)),
      h("button", { type: "button", class: "small", "data-rival": rival.effect, title: `${rival.effect} instead of ${name}`, onclick: () => does.tryInstead(name, rival.effect) }, "try instead"),
    ))),
  );
}

/** @param {Diagnosis} found */
function ladder(found) {
  const stated = found.geometry?.as_stated_rmse_n ?? null;
  const first = found.ladder[0]?.rmse_n ?? null;
  // What its data sheets leave open is fitted along; the headline's error is that of the muscle as stated.
  const isFitted = stated !== null && first !== null && Math.abs(stated - first) > 0.01 * stated;
  const asked = isFitted ? "with what the files leave open fitted" : "as asked";
  return h("table", { class: "steps" }, h("caption", null, "steps"), h("thead", null, h("tr", null, h("th", null, "model"), h("th", { class: "n" }, "error"), h("th", { class: "n" }, "held out"), h("th", null, "adequate"))), h("tbody", null, isFitted ? h("tr", null, h("td", null, "exactly as stated"), h("td", { class: "n" }, newtons(stated)), h("td", { class: "n" }, ""), h("td", null, "")) : null, ...found.ladder.map((rung) => h(
    "tr", null, h("td", null, rung.added ? `+ ${rung.added}${rung.bent ? ", as the data want it" : ""}` : asked), h("td", { class: "n" }, newtons(rung.rmse_n)), h("td", { class: "n" }, newtons(rung.held_out_rmse_n)), h("td", null, rung.adequate ? "yes" : "no"),
  ))));
}

/** On what the misfit depends. @param {Diagnosis} found */
function where(found) {
  const those = (found.where ?? []).filter((one) => one.share >= 0.005);
  if (!those.length) return null;
  return h("table", { class: "where" }, h("caption", null, "where the misfit is"), h("tbody", null, ...those.map((one) => h("tr", null, h("td", null, one.variable), h("td", { class: "n" }, percent(one.share)), h("td", null, one.says)))));
}

/** @param {Diagnosis} found */
function asides(found) {
  const { remaining } = found;
  const hints = (remaining?.hints ?? []).map(sentence);
  const unlooked = (found.not_looked_for ?? []).map((one) => (typeof one === "string" ? one : `${one.effect ?? ""}: ${sentence(one)}`));
  const list = [...hints, found.geometry?.says, ...unlooked, ...(found.warnings ?? [])].filter(Boolean);
  const interval = remaining?.misfit_interval_n;
  return [
    remaining ? h("p", { class: "facts" }, `remaining misfit ${newtons(remaining.misfit_n)}`, interval ? ` (95 %: ${number(interval[0])} to ${newtons(interval[1])})` : "") : null,
    found.noise?.law?.says ? h("p", { class: "facts" }, `noise: ${found.noise.law.says}`) : null,
    ...list.map((text) => h("p", { class: "remark" }, text)),
  ];
}

/** @param {Diagnosis} found @param {Does} does */
function next(found, does) {
  const says = sentence(found.next_experiment);
  const protocol = found.next_experiment?.protocol;
  return says ? h(
    "div", { class: "next", id: "next-experiment" }, h("h4", null, "next experiment"), h("p", null, says),
    protocol ? h("div", { class: "row" }, h("button", { type: "button", class: "small", id: "plan-next", onclick: () => does.plan(protocol, found.next_experiment?.repeats ?? 1) }, "Draw it in the plan")) : null,
  ) : null;
}
