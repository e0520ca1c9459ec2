// A table of pillars that the user gives: their positions, and heights and diameters where they differ.

import { byId } from "./screen.js";
import { LATTICE, LISTED, PILLARS } from "./store.js";

/**
 * @import { Values } from "./engine.js"
 * @import { Store } from "./store.js"
 */

/** Largest file, bytes: every request of the page contains it, a third longer, and the server accepts one megabyte. */
const LARGEST = 700_000;

/** Endings of the names of height maps that are no text. */
const MAPS = /\.(npy|npz|tiff?|png|jpe?g|bmp|nc|h5|hdf5|sdf|plu|plux|gwy|spm|nid|al3d|x3p)$/i;

/** Headings of the columns of a table, in any unit: positions, and what may differ between pillars. */
const COLUMNS = { x: /^x($|_|\s|\[|\()/i, y: /^y($|_|\s|\[|\()/i, height: /^(height|h$|h_)/i, diameter: /^(diam|d$|d_|area|radius)/i };

/**
 * Headings of a table: the last line of text before the first line of numbers.
 * @param {string} text
 * @returns {readonly string[]}
 */
function headings(text) {
  const lines = text.split(/\r?\n/, 200).filter((line) => line.trim() !== "");
  const first = lines.findIndex((line) => cells(line).every((cell) => cell !== "" && Number.isFinite(Number(cell))));
  for (const line of lines.slice(0, first).reverse()) {
    const found = cells(line.replace(/^#\s*/, ""));
    if (found.some((cell) => COLUMNS.x.test(cell))) return found;
  }
  return [];
}

/**
 * @param {string} line
 * @returns {string[]}
 */
function cells(line) {
  return line.split(/[,;\t]/).flatMap((cell) => (/[,;\t]/.test(line) ? [cell] : cell.trim().split(/\s+/))).map((cell) => cell.trim().replace(/^"|"$/g, ""));
}

/**
 * Whether a text is a table of pillars: it has columns x and y.
 * @param {string} text
 * @returns {boolean}
 */
export function isTable(text) {
  const names = headings(text);
  return [COLUMNS.x, COLUMNS.y].every((column) => names.some((name) => column.test(name)));
}

/**
 * Why a file cannot be shown: height maps are computed by the commands. Null for other files.
 * @param {string} name
 * @param {string} text
 * @returns {string | null}
 */
export function refusedMap(name, text) {
  const rows = text.split(/\r?\n/, 12).filter((line) => line.trim() !== "" && !line.startsWith("#"));
  const isMatrix = rows.length > 7 && rows.every((row) => cells(row).length > 7 && cells(row).every((cell) => Number.isFinite(Number(cell))));
  if (!MAPS.test(name) && !isMatrix) return null;
  return (
    `${name} is a height map, which the page does not compute: give it to \`fakir press\` in a case with ` +
    `[surface] and height_map = "${name}" (see "Which files can be read" in the manual)`
  );
}

/**
 * Shows the pillars of a table in place of those of a lattice.
 * @param {Store} store
 * @param {File} file
 */
export async function takeTable(store, file) {
  if (file.size > LARGEST) {
    store.setData({ dataWords: `${file.name} is larger than ${LARGEST / 1e6} MB, the limit of the page` });
    return;
  }
  const [text, base64] = [await file.text(), await base64Of(file)];
  const words = refusedMap(file.name, text);
  if (words !== null) {
    store.setData({ dataWords: words });
    return;
  }
  const names = headings(text);
  /** @type {Values} */
  const values = {};
  for (const [key, value] of Object.entries(store.state.chosen.case)) {
    const isOfPillar = key.startsWith("pattern.pillar.");
    // A column of the table replaces the value for all pillars.
    const isColumn = names.some((name) => (key.endsWith("height") && COLUMNS.height.test(name)) || (key.endsWith("diameter") && COLUMNS.diameter.test(name)));
    if (!key.startsWith("pattern.") || (isOfPillar && !isColumn)) values[key] = value;
  }
  values[LATTICE] = LISTED;
  values[PILLARS] = file.name;
  const { table } = store.state;
  store.setTable({ name: file.name, base64, number: (table?.number ?? 0) + 1 });
  store.choose({ case: values, load: 1, view: null }, performance.now());
}

/**
 * Connects the button that opens a table.
 * @param {Store} store
 */
export function tables(store) {
  const input = byId("table-file", HTMLInputElement);
  byId("open-table").addEventListener("click", () => input.click());
  input.addEventListener("change", () => {
    const file = input.files?.[0];
    input.value = "";
    if (file !== undefined) void takeTable(store, file);
  });
}

/**
 * Contents of a file as text that JSON can contain.
 * @param {File} file
 * @returns {Promise<string>}
 */
export async function base64Of(file) {
  const bytes = new Uint8Array(await file.arrayBuffer());
  let text = "";
  for (let k = 0; k < bytes.length; k += 0x8000) text += String.fromCharCode(...bytes.subarray(k, k + 0x8000));
  return btoa(text);
}
