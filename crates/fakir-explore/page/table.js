// A table of pillars that the user gives: their positions, and heights and diameters where they differ.

import { Refused } from "./engine.js";
import { byId } from "./screen.js";
import { LATTICE, LISTED, PILLARS } from "./store.js";

/**
 * @import { Engine, FileContents, Values } from "./engine.js"
 * @import { Store } from "./store.js"
 */

/** Largest file, bytes: every request of the page contains it, a third longer, and the server accepts one megabyte. */
const LARGEST = 700_000;

/**
 * Shows a height map with this name and these contents.
 * @typedef {(name: string, base64: string) => void} TakeMap
 */

/** Largest file of which the program is asked what it contains, bytes. */
const LARGEST_READ = 8_000_000;

/**
 * What a file contains, as the program reads it; null if it cannot be read, for which the reason is shown.
 * @param {Store} store
 * @param {Engine} engine
 * @param {File} file
 * @returns {Promise<FileContents | null>}
 */
export async function contentsOf(store, engine, file) {
  if (file.size > LARGEST_READ) {
    store.setData({ dataWords: `${file.name} is larger than ${LARGEST_READ / 1e6} MB, the limit of the page` });
    return null;
  }
  /** @type {FileContents | null} */
  let contents = null;
  try {
    const given = { name: file.name, base64: await base64Of(file) };
    await engine.ask("read", "read", { file: given }, (line) => (contents = line.read ?? contents));
  } catch (error) {
    store.setData({ dataWords: error instanceof Refused ? error.refusal.message : String(error) });
  }
  return contents;
}

/**
 * Shows the pillars of a table in place of those of a lattice.
 * @param {Store} store
 * @param {File} file
 * @param {FileContents} contents
 */
export async function takeTable(store, file, contents) {
  if (file.size > LARGEST) {
    store.setData({ dataWords: `${file.name} is larger than ${LARGEST / 1e6} MB, the limit of the page` });
    return;
  }
  const base64 = await base64Of(file);
  // A column of the table replaces the value for all pillars.
  const [height, diameter] = contents.kind === "pillars" ? [contents.height, contents.diameter] : [false, false];
  /** @type {Values} */
  const values = {};
  for (const [key, value] of Object.entries(store.state.chosen.case)) {
    const isOfPillar = key.startsWith("pattern.pillar.");
    const isColumn = (height && key.endsWith("height")) || (diameter && key.endsWith("diameter"));
    if (!key.startsWith("pattern.") || (isOfPillar && !isColumn)) values[key] = value;
  }
  values[LATTICE] = LISTED;
  values[PILLARS] = file.name;
  const { table } = store.state;
  store.setTable({ name: file.name, base64, number: (table?.number ?? 0) + 1 });
  store.choose({ case: values, load: 1, view: null }, performance.now());
}

/**
 * Connects the button that opens a table of pillars, or a height map, which is given to `takeMap`.
 * @param {Store} store
 * @param {Engine} engine
 * @param {TakeMap} takeMap
 */
export function tables(store, engine, takeMap) {
  /** @param {File} file */
  const open = async (file) => {
    const contents = await contentsOf(store, engine, file);
    if (contents?.kind === "heights") takeMap(file.name, await base64Of(file));
    else if (contents !== null) await takeTable(store, file, contents);
  };
  const input = byId("table-file", HTMLInputElement);
  byId("open-table").addEventListener("click", () => input.click());
  input.addEventListener("change", () => {
    const file = input.files?.[0];
    input.value = "";
    if (file !== undefined) void open(file);
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
