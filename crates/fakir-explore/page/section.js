// Draws the deformed section through lens and surface, with exaggerated heights.

import { element, path, text } from "./charts.js";
import { engineeringText, significant } from "./numbers.js";
import { byId } from "./screen.js";
import { letterSize } from "./theme.js";

/**
 * @import { Section } from "./engine.js"
 * @import { State } from "./store.js"
 */

/** @param {State} state */
export function drawSection(state) {
  const svg = byId("section", SVGSVGElement);
  const given = state.chosen.exaggeration;
  byId("exaggeration-fit").setAttribute("aria-pressed", String(given === null));
  if (given !== null) showExaggeration(given);
  if (state.section === null) return;
  const factor = sectionInto(svg, state.section.is, given);
  if (given === null && factor !== null) showExaggeration(factor);
}

/**
 * Draws a section; returns the exaggeration of its heights, which fills the view unless it is given, or null without a section.
 * @param {SVGSVGElement} svg
 * @param {Section | null} section
 * @param {number | null} given
 * @returns {number | null}
 */
export function sectionInto(svg, section, given) {
  const { width, height } = svg.getBoundingClientRect();
  if (width < 40 || height < 40) return null;
  svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
  if (section === null) {
    const note = text("this method does not compute the section", width / 2, height / 2, "middle");
    note.setAttribute("class", "region");
    svg.replaceChildren(note);
    return null;
  }
  const half = section.x_m[section.x_m.length - 1] ?? 1;
  const [low, high] = span(section, 0.01 * half);
  const across = width / (2 * half);
  const factor = given ?? (0.62 * height) / (high - low) / across;
  const up = across * factor;
  const middle = (low + high) / 2;
  /** @type {(x: number, z: number) => [string, string]} */
  const place = (x, z) => [
    ((x + half) * across).toFixed(1),
    // The frame clips what is above or below the picture.
    (height * 0.56 - (z - middle) * up).toFixed(1),
  ];
  /** @type {(heights: readonly number[]) => string} */
  const outline = (heights) =>
    section.x_m.map((x, k) => place(x, heights[k] ?? 0).join(" ")).join("L");
  const lens = outline(section.lens_m);
  const surface = outline(section.surface_m);
  const em = letterSize();
  svg.replaceChildren(
    path(`M${surface}L${width} ${height + 9}L0 ${height + 9}Z`, "substrate"),
    path(`M${lens}L${width} -9L0 -9Z`, "lens"),
    path(`M${surface}`, "outline"),
    path(`M${lens}`, "outline"),
    ...section.floor_m.map((ends) => floorPart(section, ends, place)),
    ...section.floor_contacts_m.map(([x, z]) => floorMark(place(x, z), em)),
    ...names(width, height, em, across),
  );
  return factor;
}

/**
 * Shows the exaggeration beside its slider, and on it.
 * @param {number} factor
 */
function showExaggeration(factor) {
  const words = `heights × ${significant(factor, factor >= 100 ? 3 : 2)}`;
  const slider = byId("exaggeration", HTMLInputElement);
  slider.value = String(Math.log10(factor));
  slider.setAttribute("aria-valuetext", words);
  byId("exaggeration-words").textContent = words;
}

/**
 * A line along the floor where it is in contact.
 * @param {Section} section
 * @param {readonly [number, number]} ends
 * @param {(x: number, z: number) => [string, string]} place
 * @returns {SVGElement}
 */
function floorPart(section, [start, end], place) {
  const inside = section.x_m
    .map(/** @returns {[number, number]} */ (x, k) => [x, section.surface_m[k] ?? 0])
    .filter(([x]) => x > start && x < end);
  // Between two points of the outline the height is that of the next point.
  const next = section.x_m.findIndex((x) => x >= end);
  const height = section.surface_m[next] ?? 0;
  const points = [
    /** @type {const} */ ([start, inside[0]?.[1] ?? height]),
    ...inside,
    /** @type {const} */ ([end, inside[inside.length - 1]?.[1] ?? height]),
  ];
  return path(`M${points.map(([x, z]) => place(x, z).join(" ")).join("L")}`, "floor-part");
}

/**
 * An arrow from below to a point contact with the floor.
 * @param {[string, string]} tip
 * @param {number} em
 * @returns {SVGElement}
 */
function floorMark([x, y], em) {
  const tip = Number(y) + 0.15 * em;
  return path(`M${x} ${tip}l${-0.35 * em} ${0.7 * em}h${0.7 * em}Z`, "floor-mark");
}

/**
 * @param {number} width
 * @param {number} height
 * @param {number} em
 * @param {number} across
 * @returns {SVGElement[]}
 */
function names(width, height, em, across) {
  const lens = text("lens", width / 2, 1.4 * em, "middle");
  const substrate = text("substrate", 0.7 * em, height - 0.8 * em, "start");
  const longest = (0.2 * width) / across;
  const power = 10 ** Math.floor(Math.log10(longest));
  const length = power * Math.max(...[1, 2, 5].filter((step) => step * power <= longest));
  const end = width - 0.8 * em;
  const y = height - 0.7 * em;
  const bar = element("path", {
    d: `M${end - length * across} ${y}H${end}`,
    class: "scale-bar",
  });
  const label = text(engineeringText(length, "length", 1), end, y - 0.45 * em, "end");
  lens.setAttribute("class", "body-name");
  for (const name of [substrate, label]) name.setAttribute("class", "body-name below");
  return [lens, substrate, bar, label];
}

/**
 * Lowest and highest point of the surface, at least `least` apart, so that rounding errors are not visible.
 * @param {Section} section
 * @param {number} least
 * @returns {[number, number]}
 */
function span(section, least) {
  let [low, high] = [Infinity, -Infinity];
  for (const z of section.surface_m) {
    low = Math.min(low, z);
    high = Math.max(high, z);
  }
  const rest = Math.max(0, least - (high - low)) / 2;
  return [low - rest, high + rest];
}
