// Charts with logarithmic or linear axes, as SVG. Colours and lettering come from the style sheet.

import { engineering, engineeringText, significant, write } from "./numbers.js";
import { letterSize } from "./theme.js";

/** @import { Dimension } from "./numbers.js" */

/** @typedef {readonly [number, number]} Place */

/**
 * A line, markers or an area; `style` is its class in the style sheet.
 * @typedef {object} Series
 * @property {"line" | "points" | "area" | "vertical" | "ticks-above" | "ticks-below"} kind
 * @property {string} style
 * @property {readonly Place[]} points
 */

/**
 * A text in the chart; `style` is its class in the style sheet.
 * @typedef {object} Lettering
 * @property {Place} place
 * @property {string} text
 * @property {string} style
 */

/**
 * @typedef {object} Contents
 * @property {Place} x
 * @property {Place} y
 * @property {readonly Series[]} series
 * @property {readonly Lettering[]} [names]
 */

/**
 * @typedef {object} Axes
 * @property {string} xLabel
 * @property {Dimension} [xDimension] Dimension of the numbers on x; none if it is left out.
 * @property {string} yLabel
 * @property {Dimension} yDimension Dimension of the numbers on y; numbers without one are written as powers of ten.
 * @property {boolean} [bare] Whether numbers on x are omitted because the chart below shows them.
 * @property {boolean} [linear] Whether both axes are linear.
 */

const SVG = "http://www.w3.org/2000/svg";

/**
 * Draws a chart into an SVG element.
 * @param {SVGSVGElement} svg
 * @param {Axes} axes
 * @param {Contents} contents
 */
export function drawChart(svg, axes, contents) {
  const { width, height } = svg.getBoundingClientRect();
  if (width < 40 || height < 40) return;
  const em = letterSize();
  const frame = {
    left: 4.9 * em,
    right: width - 0.9 * em,
    top: 0.7 * em,
    bottom: height - (axes.bare ? 0.5 : 2.9) * em,
  };
  const [scale, ticks] = axes.linear ? [linear, evenTicks] : [logarithmic, decadeTicks];
  const across = scale(contents.x, frame.left, frame.right);
  const up = scale(contents.y, frame.bottom, frame.top);
  /** @type {(series: Series) => Place[]} */
  const placed = ({ points }) => points.map(([x, y]) => [across(x), up(y)]);
  const clip = `${svg.id}-frame`;
  const box = rectangle(frame.left, frame.top, frame.right, frame.bottom);
  svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
  const inside = element("g", { "clip-path": `url(#${clip})` });
  const grid = element("g", { class: "grid" });
  const lettering = element("g", { class: "lettering" });
  for (const { value, label } of ticks(contents.x, (frame.right - frame.left) / (3.4 * em))) {
    const x = across(value).toFixed(1);
    grid.append(path(`M${x} ${frame.top}V${frame.bottom}`, label ? "major" : "minor"));
    if (label && !axes.bare) {
      const words = wordsOf(value, axes.xDimension ?? "number", axes);
      lettering.append(text(words, across(value), frame.bottom + 1.15 * em, "middle"));
    }
  }
  for (const { value, label } of ticks(contents.y, (frame.bottom - frame.top) / (1.3 * em))) {
    const y = up(value).toFixed(1);
    grid.append(path(`M${frame.left} ${y}H${frame.right}`, label ? "major" : "minor"));
    if (label) {
      const words = wordsOf(value, axes.yDimension, axes);
      lettering.append(text(words, frame.left - 0.45 * em, up(value) + 0.32 * em, "end"));
    }
  }
  for (const series of contents.series) {
    if (series.kind === "points") {
      for (const [x, y] of placed(series).filter(isPlace)) {
        const [cx, cy] = [x.toFixed(1), y.toFixed(1)];
        inside.append(element("circle", { cx, cy, class: series.style, r: String(0.24 * em) }));
      }
    } else if (series.kind === "vertical") {
      for (const [x] of series.points) {
        const d = `M${across(x).toFixed(1)} ${frame.top}V${frame.bottom}`;
        inside.append(path(d, series.style));
      }
    } else if (series.kind === "ticks-above" || series.kind === "ticks-below") {
      const above = series.kind === "ticks-above";
      const [from, to] = above
        ? [frame.top, frame.top + 0.5 * em]
        : [frame.bottom, frame.bottom - 0.5 * em];
      const places = new Set(series.points.map(([x]) => across(x).toFixed(1)));
      inside.append(path([...places].map((x) => `M${x} ${from}V${to}`).join(""), series.style));
    } else if (series.points.length > 0) {
      const close = series.kind === "area" ? "Z" : "";
      inside.append(path(`${through(placed(series))}${close}`, series.style));
    }
  }
  for (const { place, text: words, style } of contents.names ?? []) {
    const name = text(words, across(place[0]), up(place[1]), "middle");
    name.setAttribute("class", style);
    inside.append(name);
  }
  if (!axes.bare) {
    const middle = (frame.left + frame.right) / 2;
    const label = text(axes.xLabel, middle, height - 0.45 * em, "middle");
    label.setAttribute("class", "label");
    lettering.append(label);
  }
  const side = text(axes.yLabel, 0, 0, "middle");
  const middle = (frame.top + frame.bottom) / 2;
  side.setAttribute("transform", `translate(${0.95 * em} ${middle}) rotate(-90)`);
  side.setAttribute("class", "label");
  lettering.append(side);
  const clipping = element("clipPath", { id: clip });
  clipping.append(path(box, ""));
  svg.replaceChildren(clipping, grid, inside, path(box, "frame"), lettering);
  if (!drawn.has(svg)) {
    svg.addEventListener("pointermove", (event) => showValue(svg, event));
    svg.addEventListener("pointerleave", () => svg.querySelector(".value")?.remove());
  }
  drawn.set(svg, { axes, contents, across, up, frame });
}

/**
 * A chart as it was drawn.
 * @typedef {object} Drawn
 * @property {Axes} axes
 * @property {Contents} contents
 * @property {(x: number) => number} across
 * @property {(y: number) => number} up
 * @property {{ left: number, right: number, top: number, bottom: number }} frame
 */

/** @type {WeakMap<SVGSVGElement, Drawn>} */
const drawn = new WeakMap();

/**
 * The axes and the series of a chart that was drawn; null if it was not.
 * @param {SVGSVGElement} svg
 * @returns {{ axes: Axes, contents: Contents } | null}
 */
export function chartOf(svg) {
  return drawn.get(svg) ?? null;
}

/** Distance from the pointer within which a value is shown, in font sizes. */
const NEAR = 3;

/**
 * Shows the point of a curve nearest to the pointer.
 * @param {SVGSVGElement} svg
 * @param {PointerEvent} event
 */
function showValue(svg, event) {
  const chart = drawn.get(svg);
  svg.querySelector(".value")?.remove();
  if (chart === undefined) return;
  const { axes, contents, across, up, frame } = chart;
  const em = letterSize();
  const { left, top } = svg.getBoundingClientRect();
  const [x, y] = [event.clientX - left, event.clientY - top];
  const points = contents.series
    .filter(({ kind, style }) => kind === "points" || (kind === "line" && style !== "zero"))
    .flatMap(({ points }) => points)
    .map((value) => ({ value, place: /** @type {Place} */ ([across(value[0]), up(value[1])]) }))
    .filter(({ place: [a, b] }) => a >= frame.left && a <= frame.right && b >= frame.top && b <= frame.bottom);
  /** @type {(place: Place) => number} */
  const distance = ([a, b]) => Math.hypot(a - x, b - y);
  const [first, ...others] = points;
  if (first === undefined) return;
  const nearest = others.reduce((best, one) => (distance(one.place) < distance(best.place) ? one : best), first);
  if (distance(nearest.place) > NEAR * em) return;
  const [a, b] = nearest.place;
  const words =
    `${engineeringText(nearest.value[0], axes.xDimension ?? "number", 4)}, ` +
    engineeringText(nearest.value[1], axes.yDimension, 4);
  const group = element("g", { class: "value" });
  const isRight = a > (frame.left + frame.right) / 2;
  const label = text(words, a + (isRight ? -0.7 : 0.7) * em, Math.max(b - 0.6 * em, frame.top + em), isRight ? "end" : "start");
  group.append(element("circle", { cx: a.toFixed(1), cy: b.toFixed(1), r: String(0.3 * em) }), label);
  svg.append(group);
}

/**
 * Whether a point can be drawn: 0 has no place on a logarithmic axis.
 * @param {Place} place
 * @returns {boolean}
 */
function isPlace(place) {
  return place.every(Number.isFinite);
}

/**
 * A path through the places, interrupted at those that cannot be drawn.
 * @param {readonly Place[]} places
 * @returns {string}
 */
function through(places) {
  let step = "M";
  return places
    .map((place) => {
      const drawn = isPlace(place) ? `${step}${place.map((value) => value.toFixed(1)).join(" ")}` : "";
      step = drawn === "" ? "M" : "L";
      return drawn;
    })
    .join("");
}

/**
 * Formats a number, as a power of ten where it would be long.
 * @param {number} value
 * @returns {string}
 */
function number(value) {
  const power = Math.round(Math.log10(value));
  const isPower = Math.abs(value / 10 ** power - 1) < 1e-9;
  if (isPower && (power > 3 || power < -2)) return `10^{${String(power).replace("-", "−")}}`;
  return significant(value, 1);
}

/**
 * The label of a tick.
 * @param {number} value
 * @param {Dimension} dimension
 * @param {Axes} axes
 * @returns {string}
 */
function wordsOf(value, dimension, { linear }) {
  if (value === 0) return "0";
  if (dimension === "number") return number(value);
  const { number: digits, unit } = engineering(value, dimension, linear ? 3 : 1);
  // Linear ticks have at most three digits; trailing zeros are dropped.
  return `${linear ? digits.replace(/\.0+$|(\.\d*?)0+$/, "$1") : digits} ${unit}`;
}

/**
 * @param {Place} place
 * @param {number} first
 * @param {number} last
 * @returns {(value: number) => number}
 */
function linear([low, high], first, last) {
  return (value) => first + ((value - low) / (high - low)) * (last - first);
}

/**
 * Ticks at multiples of a round step, as many as fit. The range need not begin at a tick.
 * @param {Place} place
 * @param {number} space
 * @returns {Tick[]}
 */
function evenTicks([low, high], space) {
  const least = (high - low) / Math.max(2, Math.min(6, space));
  const power = 10 ** Math.floor(Math.log10(least));
  const step = [1, 2, 5, 10].map((round) => round * power).find((round) => round >= least) ?? least;
  const [first, last] = [Math.ceil(low / step - 1e-4), Math.floor(high / step + 1e-4)];
  return Array.from({ length: Math.max(0, last - first + 1) }, (_, k) => ({
    value: Number(((first + k) * step).toPrecision(12)),
    label: true,
  }));
}

/**
 * @param {Place} place
 * @param {number} first
 * @param {number} last
 * @returns {(value: number) => number}
 */
function logarithmic([low, high], first, last) {
  const [start, length] = [Math.log(low), Math.log(high) - Math.log(low)];
  return (value) => first + ((Math.log(value) - start) / length) * (last - first);
}

/**
 * @typedef {object} Tick
 * @property {number} value
 * @property {boolean} label
 */

/**
 * Ticks at the integers 1 to 9 of every decade, with as many labels as fit.
 * @param {Place} place
 * @param {number} space
 * @returns {Tick[]}
 */
function decadeTicks([low, high], space) {
  const [first, last] = [Math.floor(Math.log10(low)), Math.ceil(Math.log10(high))];
  const decades = Math.log10(high / low);
  const every = Math.max(1, Math.ceil(decades / Math.max(1, space)));
  const digits = 3 * decades + 1 <= space ? [1, 2, 5] : [1];
  /** @type {Tick[]} */
  const result = [];
  for (let power = first; power <= last; power += 1) {
    for (let digit = 1; digit < 10; digit += 1) {
      const value = Number(`${digit}e${power}`);
      if (value < low * 0.9999 || value > high * 1.0001) continue;
      const label = digits.includes(digit) && power % every === 0;
      if (label || (every === 1 && decades < 7)) result.push({ value, label });
    }
  }
  return result;
}

/**
 * The smallest and the largest value.
 * @param {readonly number[]} values
 * @returns {Place}
 */
export function extremes(values) {
  return values.reduce(
    /** @returns {Place} */ ([low, high], value) => [Math.min(low, value), Math.max(high, value)],
    /** @type {Place} */ ([Infinity, -Infinity]),
  );
}

/**
 * The range of the positive values, with a margin around them.
 * @param {readonly number[]} values
 * @param {number} [space]
 * @returns {Place}
 */
export function range(values, space = 1.3) {
  const positive = values.filter((value) => value > 0 && Number.isFinite(value));
  if (positive.length === 0) return [1, 10];
  const [low, high] = [Math.min(...positive) / space, Math.max(...positive) * space];
  return high / low < 4 ? [low / 1.5, high * 1.5] : [low, high];
}

/**
 * @param {string} name
 * @param {Record<string, string>} attributes
 * @returns {SVGElement}
 */
export function element(name, attributes) {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  return made;
}

/**
 * @param {string} d
 * @param {string} style
 * @returns {SVGElement}
 */
export function path(d, style) {
  return element("path", { d, class: style });
}

/**
 * @param {number} left
 * @param {number} top
 * @param {number} right
 * @param {number} bottom
 * @returns {string}
 */
export function rectangle(left, top, right, bottom) {
  return `M${left} ${top}H${right}V${bottom}H${left}Z`;
}

/**
 * @param {string} words
 * @param {number} x
 * @param {number} y
 * @param {string} anchor
 * @returns {SVGElement}
 */
export function text(words, x, y, anchor) {
  const made = element("text", { x: x.toFixed(1), y: y.toFixed(1), "text-anchor": anchor });
  write(made, words);
  return made;
}
