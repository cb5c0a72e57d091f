// @ts-check
// The colours of the reports, on light and on dark ground.

/** @typedef {[number, number, number]} Rgb */

/** Stops of a scale from cold to hot; on dark ground its cold end is lifted, so that it stays visible. @type {Record<"light" | "dark", Rgb[]>} */
const STOPS = {
  light: [[13, 8, 135], [126, 3, 168], [204, 71, 120], [240, 140, 50]],
  dark: [[122, 132, 255], [190, 98, 224], [238, 110, 150], [250, 190, 100]],
};

/** Below zero, zero, above zero. @type {Record<"light" | "dark", [Rgb, Rgb, Rgb]>} */
const SIGNED = {
  light: [[22, 82, 150], [205, 210, 214], [184, 78, 8]],
  dark: [[96, 170, 255], [74, 80, 88], [255, 150, 70]],
};

export const INKS = {
  light: { ink: "#222222", soft: "#605c55", grid: "#e9e5dd", axis: "#b9b3a8", ground: "#ffffff", base: "#9ea4aa", alert: "#be4e0a", mark: "#111111", halo: "#ffffff", aside: "#a8a29a" },
  dark: { ink: "#e8e6e1", soft: "#a5a19a", grid: "#2c2f34", axis: "#565a61", ground: "#1b1d21", base: "#6d737b", alert: "#ffa061", mark: "#ffffff", halo: "#1b1d21", aside: "#6d6a66" },
};

/** @returns {"light" | "dark"} */
export function ground() {
  const chosen = document.documentElement.dataset.theme;
  if (chosen === "light" || chosen === "dark") return chosen;
  return matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
}

export const inks = () => INKS[ground()];

/** @param {Rgb} a @param {Rgb} b @param {number} share @returns {Rgb} */
const between = (a, b, share) => /** @type {Rgb} */ (a.map((v, i) => Math.round(v + share * (b[i] - v))));

/** @param {Rgb} rgb */
const css = (rgb) => `rgb(${rgb.join(",")})`;

/** @param {number} share between 0 and 1 @returns {Rgb} */
export function rampAt(share) {
  const stops = STOPS[ground()];
  const place = Math.min(1, Math.max(0, share)) * (stops.length - 1);
  const below = Math.min(stops.length - 2, Math.floor(place));
  return between(stops[below], stops[below + 1], place - below);
}

/** Colour of sweep `i` of `n`. @param {number} i @param {number} n */
export const sweepColour = (i, n) => css(rampAt(n > 1 ? i / (n - 1) : 0.3));

/** Colour of the model's line of sweep `i`: that of its points, nearer to the ink, so that it stands out from them. @param {number} i @param {number} n */
export function lineColour(i, n) {
  const ink = /** @type {Rgb} */ (ground() === "dark" ? [255, 255, 255] : [0, 0, 0]);
  return css(between(rampAt(n > 1 ? i / (n - 1) : 0.3), ink, 0.4));
}

/** Colour of a signed value between -1 and 1. @param {number} value */
export function signedColour(value) {
  const [low, zero, high] = SIGNED[ground()];
  return css(between(zero, value < 0 ? low : high, Math.min(1, Math.abs(value))));
}

/** As a CSS gradient from left to right. @param {(share: number) => string} colour */
export const gradient = (colour) => `linear-gradient(90deg, ${Array.from({ length: 11 }, (_, i) => colour(i / 10)).join(", ")})`;

/** @param {number} share */
export const rampColour = (share) => css(rampAt(share));
