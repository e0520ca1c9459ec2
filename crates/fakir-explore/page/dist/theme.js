// Colours: those of the style sheet, which follow the scheme of the system, and the map of forces.
let colours = [];
/** The colour map of fakir's figures, dark for the smallest. */
export function setColours(map) {
    colours = map;
}
/** Number of colours in the map. */
export function colourCount() {
    return colours.length;
}
/** The colour of an entry of the map. */
export function colour(index) {
    const [r, g, b] = colours[index] ?? [0, 0, 0];
    return `rgb(${r} ${g} ${b})`;
}
/** A colour of the style sheet by the name of its property. */
export function tint(name) {
    return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}
/** Size of the letters of the page, px. */
export function letterSize() {
    return parseFloat(getComputedStyle(document.documentElement).fontSize);
}
/** Calls back when the system changes between light and dark. */
export function onScheme(changed) {
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", changed);
}
/** Calls back when an element has another size. */
export function onSize(element, changed) {
    new ResizeObserver(changed).observe(element);
}
