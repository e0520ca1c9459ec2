// Files of what the page shows: charts and section as SVG and PNG, the values of charts as CSV, the map as PNG.

import { chartOf } from "./charts.js";
import { byId } from "./screen.js";

/** @import { Dimension } from "./numbers.js" */

/** Properties of style that the file contains. */
const STYLES = [
  ..."fill stroke stroke-width stroke-dasharray opacity font-size font-family font-style text-anchor paint-order".split(" "),
];

/** SI units. @type {Readonly<Record<Dimension, string>>} */
const UNITS = {
  length: " (m)",
  pressure: " (Pa)",
  force: " (N)",
  energy: " (J)",
  "energy per area": " (J/m^2)",
  time: " (s)",
  angle: " (rad)",
  fraction: "",
  number: "",
};

/** Pixels of a PNG for each of the screen. */
const SCALE = 3;

/**
 * The file with this name, for example `loading.svg`; null if nothing is shown.
 * @param {string} name
 * @returns {Promise<Blob | null>}
 */
export async function fileShown(name) {
  const [id = "", form = ""] = name.split(".");
  if (id === "map") return toBlob(byId("map", HTMLCanvasElement));
  const svg = byId(id, SVGSVGElement);
  if (form === "csv") return csv(svg);
  const { width, height } = svg.getBoundingClientRect();
  if (width === 0) return null;
  const picture = new Blob([drawing(svg, width, height)], { type: "image/svg+xml" });
  return form === "svg" ? picture : png(picture, width, height);
}

/**
 * The values of a chart: the name of the curve, and both coordinates in SI units.
 * @param {SVGSVGElement} svg
 * @returns {Blob | null}
 */
function csv(svg) {
  const chart = chartOf(svg);
  if (chart === null) return null;
  const { axes, contents } = chart;
  /** @type {(label: string, dimension: Dimension) => string} */
  const head = (label, dimension) => `"${label.replace(/[_^]\{(.*?)\}/g, "_$1")}${UNITS[dimension]}"`;
  const x = axes.xLabel === "" ? "surface fraction φ" : axes.xLabel;
  const rows = contents.series
    .filter(({ kind, style }) => kind !== "area" && kind !== "vertical" && style !== "zero")
    .flatMap(({ style, points }) => points.map(([x, y]) => `${style.replace(" older", "")},${x},${y}`));
  const lines = [`curve,${head(x, axes.xDimension ?? "number")},${head(axes.yLabel, axes.yDimension)}`, ...rows];
  return new Blob([`${lines.join("\n")}\n`], { type: "text/csv" });
}

/**
 * The picture with its style, independent of the page.
 * @param {SVGSVGElement} svg
 * @param {number} width
 * @param {number} height
 * @returns {string}
 */
function drawing(svg, width, height) {
  const copy = /** @type {SVGSVGElement} */ (svg.cloneNode(true));
  copy.querySelector(".value")?.remove();
  const [own, copies] = [svg, copy].map((root) => [root, ...root.querySelectorAll(":not(.value, .value *)")]);
  own?.forEach((element, k) => {
    const computed = getComputedStyle(element);
    const text = STYLES.map((name) => `${name}:${computed.getPropertyValue(name)}`).join(";");
    copies?.[k]?.setAttribute("style", text);
  });
  copy.setAttribute("xmlns", "http://www.w3.org/2000/svg");
  copy.setAttribute("width", String(width));
  copy.setAttribute("height", String(height));
  copy.setAttribute("viewBox", svg.getAttribute("viewBox") ?? `0 0 ${width} ${height}`);
  return new XMLSerializer().serializeToString(copy);
}

/**
 * @param {Blob} picture
 * @param {number} width
 * @param {number} height
 * @returns {Promise<Blob | null>}
 */
async function png(picture, width, height) {
  const image = new Image();
  image.src = URL.createObjectURL(picture);
  await image.decode();
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [SCALE * width, SCALE * height];
  const context = canvas.getContext("2d");
  if (context === null) return null;
  context.fillStyle = getComputedStyle(document.documentElement).getPropertyValue("--panel");
  context.fillRect(0, 0, canvas.width, canvas.height);
  context.drawImage(image, 0, 0, canvas.width, canvas.height);
  URL.revokeObjectURL(image.src);
  return toBlob(canvas);
}

/**
 * @param {HTMLCanvasElement} canvas
 * @returns {Promise<Blob | null>}
 */
function toBlob(canvas) {
  return new Promise((resolve) => canvas.toBlob(resolve));
}
