// Colours: those of the style sheet, which follow the colour scheme of the system, and the colour map of forces.

/**
 * The colour map of fakir's figures, from the smallest value (dark) to the largest.
 * @typedef {readonly (readonly [number, number, number])[]} Colours
 */

/**
 * The colour of an entry of the map.
 * @param {Colours} colours
 * @param {number} index
 * @returns {string}
 */
export function colour(colours, index) {
  const [r, g, b] = colours[index] ?? [0, 0, 0];
  return `rgb(${r} ${g} ${b})`;
}

/**
 * Interpolates between two colours such as `#1f5f99`.
 * @param {string} low
 * @param {string} high
 * @param {number} part
 * @returns {[number, number, number]}
 */
export function mixed(low, high, part) {
  const [from, to] = [low, high].map((text) =>
    [1, 3, 5].map((at) => parseInt(text.slice(at, at + 2), 16)),
  );
  /** @type {(k: number) => number} */
  const between = (k) => (1 - part) * (from?.[k] ?? 0) + part * (to?.[k] ?? 0);
  return [Math.round(between(0)), Math.round(between(1)), Math.round(between(2))];
}

/**
 * A colour of the style sheet by the name of its property.
 * @param {string} name
 * @returns {string}
 */
export function tint(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

/**
 * Font size of the page, px.
 * @returns {number}
 */
export function letterSize() {
  return parseFloat(getComputedStyle(document.documentElement).fontSize);
}

/**
 * Calls `changed` when the system changes between light and dark, or the page is printed, which is always light.
 * @param {() => void} changed
 */
export function onScheme(changed) {
  for (const query of ["(prefers-color-scheme: dark)", "print"]) {
    matchMedia(query).addEventListener("change", changed);
  }
}
