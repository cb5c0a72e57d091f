// @ts-check
// What one part of a page tells the others: `documents` (there are other rows, or another model), `selection`, `hover`, `theme`; a page may have more.

/** @type {Map<string, Set<(detail?: any) => void>>} */
const listeners = new Map();

/** @param {string} topic @param {(detail?: any) => void} then */
export function on(topic, then) {
  const those = listeners.get(topic) ?? new Set();
  those.add(then);
  listeners.set(topic, those);
}

/** @param {string} topic @param {unknown} [detail] */
export function tell(topic, detail) {
  for (const then of listeners.get(topic) ?? []) then(detail);
}
