// Colours: those of the style sheet, which follow the scheme of the system, and the map of forces.

/** The colour map of fakir's figures, dark for the smallest. */
export type Colours = readonly (readonly [number, number, number])[];

/** The colour of an entry of the map. */
export function colour(colours: Colours, index: number): string {
  const [r, g, b] = colours[index] ?? [0, 0, 0];
  return `rgb(${r} ${g} ${b})`;
}

/** What lies between two colours such as `#1f5f99`. */
export function mixed(low: string, high: string, part: number): [number, number, number] {
  const [from, to] = [low, high].map((text) =>
    [1, 3, 5].map((at) => parseInt(text.slice(at, at + 2), 16)),
  );
  const between = (k: number): number => (1 - part) * (from?.[k] ?? 0) + part * (to?.[k] ?? 0);
  return [Math.round(between(0)), Math.round(between(1)), Math.round(between(2))];
}

/** A colour of the style sheet by the name of its property. */
export function tint(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

/** Size of the letters of the page, px. */
export function letterSize(): number {
  return parseFloat(getComputedStyle(document.documentElement).fontSize);
}

/** Calls back when the system changes between light and dark. */
export function onScheme(changed: () => void): void {
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", changed);
}
