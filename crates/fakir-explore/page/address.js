// The fragment of the address, which contains what the user has chosen.

/**
 * @import { Values } from "./engine.js"
 * @import { Chosen } from "./store.js"
 */

/** The table of the pillar pattern in the names of keys, and its former name, which older addresses contain. */
const TABLE = "pattern.";
const FORMER_TABLE = "texture."; // former name

/**
 * The present name of a key.
 * @param {string} key
 * @returns {string}
 */
function present(key) {
  const path = key.startsWith(FORMER_TABLE) ? TABLE + key.slice(FORMER_TABLE.length) : key;
  return path.replace(/\.missing$/, ".vacancy_fraction");
}

/**
 * The fragment for what is chosen, and for the case beside it.
 * @param {Chosen} chosen
 * @param {Chosen | null} [pinned]
 * @returns {string}
 */
export function fragment(chosen, pinned = null) {
  const parameters = new URLSearchParams();
  for (const [key, value] of Object.entries(chosen.case)) parameters.set(key, String(value));
  parameters.set("load", String(chosen.load));
  if (chosen.exaggeration !== null) parameters.set("exaggeration", String(chosen.exaggeration));
  const { hold, time, view } = chosen;
  if (hold !== null) parameters.set("hold", [hold.by, hold.load, hold.ramp_s, hold.hold_s].join(" "));
  if (hold !== null && time !== null) parameters.set("time", String(time));
  if (view !== null) parameters.set("map", [view.zoom, view.x, view.y].join(" "));
  if (pinned !== null) parameters.set("compare", fragment(pinned).slice(1));
  return `#${parameters.toString()}`;
}

/**
 * Reads the case that the fragment of an address compares with; null if there is none.
 * @param {string} hash
 * @returns {Chosen | null}
 */
export function pinnedIn(hash) {
  const pinned = new URLSearchParams(hash.slice(1)).get("compare");
  return pinned === null ? null : chosenIn(`#${pinned}`);
}

/**
 * Reads the fragment of an address; null if it contains no case.
 * @param {string} hash
 * @returns {Chosen | null}
 */
export function chosenIn(hash) {
  const parameters = new URLSearchParams(hash.slice(1));
  /** @type {Values} */
  const values = {};
  for (const [key, text] of parameters) {
    if (!key.includes(".")) continue;
    const number = Number(text);
    values[present(key)] = text === "" || !Number.isFinite(number) ? text : number;
  }
  if (Object.keys(values).length === 0) return null;
  const factor = Number(parameters.get("exaggeration"));
  const [zoom = NaN, x = NaN, y = NaN] = (parameters.get("map") ?? "").split(" ").map(Number);
  const [by = "", ...numbers] = (parameters.get("hold") ?? "").split(" ");
  const [held = NaN, ramp_s = NaN, hold_s = NaN] = numbers.map(Number);
  const isHold = (by === "force" || by === "indentation") && Number.isFinite(held + ramp_s + hold_s);
  const time = Number(parameters.get("time") ?? NaN);
  const isView = zoom > 1 && Number.isFinite(zoom + x + y);
  return {
    case: values,
    load: Number(parameters.get("load") ?? 1),
    exaggeration: factor > 0 ? factor : null,
    hold: isHold ? { by, load: held, ramp_s, hold_s } : null,
    time: isHold && Number.isFinite(time) ? time : null,
    view: isView ? { zoom, x, y } : null,
  };
}
