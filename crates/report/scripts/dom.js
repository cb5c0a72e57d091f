// @ts-check
// Elements are made here and nowhere from text: what a file calls its columns never becomes markup.

/** @typedef {Node | string | number | null | undefined | false} Child */

/**
 * @template {keyof HTMLElementTagNameMap} K
 * @param {K} tag
 * @param {Record<string, any> | null} [properties] `on...` are listeners, the rest attributes; false and null leave one out
 * @param {...Child} children
 * @returns {HTMLElementTagNameMap[K]}
 */
export function h(tag, properties, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(properties ?? {})) {
    if (value === null || value === undefined) continue;
    // ARIA says "false" with a word, other attributes by not being there.
    if (name.startsWith("aria-")) element.setAttribute(name, String(value));
    else if (value === false) continue;
    else if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (name === "value") /** @type {any} */ (element).value = value;
    else element.setAttribute(name, value === true ? "" : String(value));
  }
  append(element, children);
  return element;
}

/** @param {Element} element @param {Child[]} children */
export function append(element, children) {
  for (const child of children) {
    if (child === null || child === undefined || child === false) continue;
    element.append(child instanceof Node ? child : String(child));
  }
}

/** @param {Element} element @param {...Child} children */
export function fill(element, ...children) {
  element.replaceChildren();
  append(element, children);
}

/**
 * @param {string} tag
 * @param {Record<string, string | number>} attributes
 * @returns {SVGElement}
 */
export function svg(tag, attributes) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, String(value));
  return element;
}

/** The element of index.html that has this id. @param {string} id @returns {HTMLElement} */
export function byId(id) {
  const element = document.getElementById(id);
  if (!element) throw new Error(`the page lacks #${id}`);
  return element;
}

/** @param {string} id @returns {HTMLInputElement} */
export const input = (id) => /** @type {HTMLInputElement} */ (byId(id));
/** @param {string} id @returns {HTMLSelectElement} */
export const select = (id) => /** @type {HTMLSelectElement} */ (byId(id));
/** @param {string} id @returns {HTMLButtonElement} */
export const button = (id) => /** @type {HTMLButtonElement} */ (byId(id));

/** Calls back once things have been quiet for so long. @template {any[]} A @param {number} ms @param {(...a: A) => void} then @returns {(...a: A) => void} */
export function afterRest(ms, then) {
  let timer = 0;
  return (...values) => {
    clearTimeout(timer);
    timer = window.setTimeout(() => then(...values), ms);
  };
}

/** Hands a file to the reader. @param {Blob | string} what a blob or an address @param {string} name */
export function download(what, name) {
  const address = typeof what === "string" ? what : URL.createObjectURL(what);
  const link = h("a", { href: address, download: name });
  document.body.append(link);
  link.click();
  link.remove();
  if (typeof what !== "string") setTimeout(() => URL.revokeObjectURL(address), 10_000);
}

/** What an element is known by after it has been drawn anew. @param {Element} element */
function mark(element) {
  if (element.id) return `#${CSS.escape(element.id)}`;
  const found = [...element.attributes].filter((one) => one.name.startsWith("data-") && one.value && !["data-held-by-hand", "data-rmse"].includes(one.name));
  return found.length ? `${element.tagName}${found.map((one) => `[${one.name}="${CSS.escape(one.value)}"]`).join("")}` : null;
}

/** Draws a part of the page anew; whoever was at one of its controls with the keyboard stays there, and what was unfolded stays open. @param {Element} part @param {() => void} draw */
export function keepingFocus(part, draw) {
  const at = document.activeElement;
  const selector = at && part.contains(at) ? mark(at) : null;
  const unfolded = [...part.querySelectorAll("details[open]")].map(mark);
  draw();
  for (const one of unfolded) if (one) part.querySelector(one)?.setAttribute("open", "");
  if (selector) /** @type {HTMLElement | null} */ (part.querySelector(selector))?.focus({ preventScroll: true });
}
