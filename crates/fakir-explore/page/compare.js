// Two cases side by side: the pinned one stays while the other changes.

import { stationShown } from "./diagrams.js";
import { drawMap } from "./map.js";
import { digitsFor, editable, engineeringText, radiusDigits, significant, write } from "./numbers.js";
import { byId } from "./screen.js";
import { sectionInto } from "./section.js";
import { isCycle, isBusy, isOlder, withSpacing } from "./store.js";

/**
 * @import { Key, Value } from "./engine.js"
 * @import { MapContents } from "./map.js"
 * @import { Dimension } from "./numbers.js"
 * @import { State, Store } from "./store.js"
 */

/**
 * Connects the button "compare", and pins a case as soon as its curve is complete.
 * @param {Store} store
 */
export function compare(store) {
  byId("compare-button").addEventListener("click", () => {
    const { pinned, pinning } = store.state;
    if (pinned !== null || pinning !== null) store.unpin();
    else store.pinWhenComplete(null);
  });
  /**
   * The state of the case that is to be pinned, while its curve is being computed.
   * @type {State | null}
   */
  let waiting = null;
  const follow = () => {
    const { pinning, question } = store.state;
    const before = waiting;
    waiting = pinning === null ? null : store.state;
    if (pinning === null) return;
    if (before !== null && before.question.name !== question.name) {
      // The case changed before its curve was complete: it is pinned with what is known of it.
      waiting = null;
      if (isBusy(before)) store.unpin();
      else store.pin({ ...before, phase: before.phase?.of.name === before.question.name ? before.phase : null });
      return;
    }
    if (!isComplete(store.state)) return;
    store.pin(store.state);
    if (pinning.then !== null) store.choose(pinning.then, performance.now());
  };
  store.listen(follow);
}

/**
 * Whether all parts of the state that are pinned belong to the newest question, or there is no answer to it.
 * @param {State} state
 * @returns {boolean}
 */
function isComplete(state) {
  const { answered, question, refusal } = state;
  if (isBusy(state)) return false;
  if (refusal !== null || isCycle(question.case)) return true;
  return answered.phase?.of.name === question.name;
}

/**
 * Shows the pinned case.
 * @param {State} state
 * @param {(state: State) => MapContents | null} contentsOf
 */
export function drawPinned(state, contentsOf) {
  const { pinned, pinning, start } = state;
  const button = byId("compare-button");
  button.setAttribute("aria-pressed", String(pinned !== null));
  button.textContent = pinning === null ? "compare" : "compare …";
  byId("compare").hidden = pinned === null;
  byId("pinned-key").hidden = pinned === null;
  byId("main").classList.toggle("comparing", pinned !== null);
  if (pinned === null) return;
  const contents = contentsOf(pinned);
  if (contents !== null) {
    drawMap(byId("pinned-map", HTMLCanvasElement), contents, start.colours);
    const most = engineeringText(contents.force, "force", 3);
    write(byId("pinned-force"), `largest force on a pillar ${most}`);
  }
  const svg = byId("pinned-section", SVGSVGElement);
  const factor = sectionInto(svg, pinned.section?.is ?? null, pinned.chosen.exaggeration);
  byId("pinned-exaggeration").textContent = factor === null ? "" : `heights × ${significant(factor, factor >= 100 ? 3 : 2)}`;
}

/**
 * A number of a case; null where it has none.
 * @typedef {object} Quantity
 * @property {string} name
 * @property {Dimension} dimension
 * @property {number | null} value
 * @property {number} digits
 */

/**
 * Shows the numbers of both cases, and the quantities that differ.
 * @param {State} state
 */
export function drawComparison(state) {
  const { pinned, start } = state;
  if (pinned === null) return;
  const [one, other] = [withSpacing(pinned.chosen.case), withSpacing(state.chosen.case)];
  const body = byId("comparison");
  body.replaceChildren();
  for (const key of start.keys) {
    const [before, now] = [one[key.key] ?? key.default, other[key.key] ?? key.default];
    if (before === now) continue;
    body.append(row(`${key.label}${key.symbol === null ? "" : ` ${key.symbol.replace(/_(.+)/, "_{$1}")}`}`, valueWords(key, before), valueWords(key, now), ""));
  }
  const now = quantities(state);
  quantities(pinned).forEach(({ name, dimension, value, digits }, k) => {
    const live = now[k]?.value ?? null;
    if (value === null && live === null) return;
    const words = [[value, digits], [live, now[k]?.digits ?? 3]].map(([number, size]) =>
      number === null || number === undefined ? "–" : dimension === "number" ? String(number) : engineeringText(number, dimension, size ?? 3),
    );
    const change = value !== null && live !== null && value > 0 ? 100 * (live / value - 1) : null;
    const percent = change === null ? "" : Math.abs(change) < 0.05 ? "0 %" : `${change > 0 ? "+" : ""}${significant(change, Math.abs(change) >= 100 ? 3 : 2)} %`;
    body.append(row(name, words[0] ?? "", words[1] ?? "", percent));
  });
  const older = isOlder(state, state.solved ?? state.critical, "load");
  body.classList.toggle("older", older);
}

/**
 * @param {Key} key
 * @param {Value | null} value
 * @returns {string}
 */
function valueWords(key, value) {
  if (value === null || value === "") return key.infinite ?? "–";
  return typeof value === "number" && key.dimension !== null ? editable(value, key.dimension) : String(value);
}

/**
 * The numbers that are compared, in the same order for every case.
 * @param {State} state
 * @returns {readonly Quantity[]}
 */
function quantities(state) {
  const critical = state.critical?.is ?? null;
  const error = critical?.relative_error_estimate;
  /** @type {(error: number | null | undefined) => number} */
  const digits = (error) => digitsFor(error ?? null);
  const station = stationShown(state);
  const summary = station ?? (isCycle(state.chosen.case) ? null : (state.solved?.is.summary ?? null));
  const cycle = state.cycle?.is.solved?.summary ?? null;
  const floor = state.solved?.is.summary.floor ?? null;
  /** @type {(name: string, dimension: Dimension, value: number | null | undefined, digits: number) => Quantity} */
  const quantity = (name, dimension, value, digits) => ({ name, dimension, value: value ?? null, digits });
  return [
    quantity("critical force F_{c}", "force", critical?.critical_force_N, digits(error?.force)),
    quantity("critical contact radius a_{c}", "length", critical?.critical_contact_radius_m, radiusDigits(error?.contact_radius ?? null)),
    quantity("critical indentation ζ_{c}", "length", critical?.critical_indentation_m, digits(error?.indentation)),
    quantity("pillars in contact, critical", "number", critical?.pillars_in_contact, 4),
    quantity("pull-off force", "force", cycle?.pull_off_force_N, Math.min(5, digits(cycle?.relative_error_estimate.pull_off_force?.numerical))),
    quantity("force F, load shown", "force", summary?.force_N, 4),
    quantity("indentation ζ, load shown", "length", summary?.indentation_m, 4),
    quantity("contact radius a, load shown", "length", summary?.contact_radius_m, 3),
    quantity("pillars in contact, load shown", "number", summary?.pillars_in_contact, 4),
    quantity("floor force, load shown", "force", floor?.force_N, 3),
  ];
}

/**
 * @param {string} name
 * @param {...string} cells
 * @returns {HTMLTableRowElement}
 */
function row(name, ...cells) {
  const made = document.createElement("tr");
  const head = document.createElement("th");
  head.scope = "row";
  write(head, name);
  made.append(head);
  for (const words of cells) {
    const cell = document.createElement("td");
    write(cell, words);
    made.append(cell);
  }
  return made;
}
