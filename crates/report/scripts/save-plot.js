// @ts-check
// A plot as a file: PNG at twice the size, or SVG, drawn once more by ECharts' own SVG renderer.

import { download } from "./dom.js";
import { inks } from "./palette.js";
import { init } from "./vendor/echarts.js";

/** @typedef {import("./plot.js").Plot} Plot */

/** @param {Plot} plot */
export function asPng(plot) {
  return plot.chart.getDataURL({ type: "png", pixelRatio: 2, backgroundColor: inks().ground });
}

/** @param {Plot} plot */
export function asSvg(plot) {
  const { clientWidth: width, clientHeight: height } = plot.element;
  const chart = init(null, null, { renderer: "svg", ssr: true, width, height });
  // Large mode knows no SVG: each point is a shape of its own.
  const series = plot.series().map((one) => ({ ...one, large: false, symbol: one.symbol === "rect" ? "circle" : one.symbol }));
  chart.setOption({ animation: false, backgroundColor: inks().ground, ...plot.axes(), series });
  const text = chart.renderToSVGString();
  chart.dispose();
  return text;
}

/** @param {Record<string, Plot>} plots */
export function startSaving(plots) {
  document.addEventListener("click", (event) => {
    const button = /** @type {HTMLElement} */ (event.target).closest?.("[data-save]");
    if (!button) return;
    const [name, kind] = (/** @type {HTMLElement} */ (button).dataset.save ?? "").split(":");
    const plot = plots[name];
    if (!plot?.content) return;
    if (kind === "png") download(asPng(plot), `${name}.png`);
    else download(new Blob([asSvg(plot)], { type: "image/svg+xml" }), `${name}.svg`);
  });
}
