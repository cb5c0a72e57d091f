// @ts-check
// What is known of an effect: equation, source, signature, twins, numbers with their bounds.

import { h } from "./dom.js";
import { number } from "./format.js";

/** @typedef {import("./types.js").Card} Card */

/** @param {string} term @param {...import("./dom.js").Child} what */
const entry = (term, ...what) => [h("dt", null, term), h("dd", null, ...what)];

/** @param {import("./types.js").Parameter} parameter */
function bounds(parameter) {
  const of = parameter.multiple_of ? ` times ${parameter.multiple_of.replaceAll("_", " ")}` : parameter.unit === "1" ? "" : ` ${parameter.unit}`;
  const scale = parameter.logarithmic ? ", logarithmic" : "";
  return `${number(parameter.low)} to ${number(parameter.high)}${of}${scale}`;
}

/** @param {Card} card */
export function details(card) {
  const { signature } = card;
  const shape = signature ? [signature.shape, signature.parity && `${signature.parity} in the direction`, signature.pressure && `pressure to the power ${signature.pressure}`].filter(Boolean).join("; ") : "";
  return h(
    "dl", { class: "card" },
    ...(card.about ? [h("dt", { class: "visually-hidden" }, "about"), h("dd", { class: "about" }, card.about)] : []),
    ...(card.equation ? entry("equation", h("code", null, card.equation)) : []),
    ...(card.source ? entry("source", card.source) : []),
    ...(shape ? entry("signature", shape) : []),
    ...(card.separate ? entry("tell apart by", card.separate) : []),
    ...(card.twins?.length ? entry("twins", h("ul", null, ...card.twins.map((twin) => h("li", null, h("code", null, twin.name), twin.how ? ` ${twin.how}` : "")))) : []),
    ...(card.parameters?.length ? entry("numbers", h("ul", null, ...card.parameters.map((one) => h("li", null, h("b", null, one.name), one.unit && one.unit !== "1" ? ` [${one.unit}]` : "", `: ${one.about}, ${bounds(one)}`)))) : []),
  );
}
