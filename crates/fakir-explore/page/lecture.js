// For a lecture: the load moves by itself, and only the main pictures are shown, in large type.

import { byId } from "./screen.js";
import { isCycle } from "./store.js";

/** @import { State, Store } from "./store.js" */

/** Duration of the way from first contact to the farthest load, ms. */
const DURATION = 8000;

/** Number of steps if the system asks for reduced motion, and the time for each, ms. */
const STEPS = 8;
const STEP = 1500;

/**
 * Connects the buttons "play" and "present".
 * @param {Store} store
 */
export function lecture(store) {
  const [play, present] = [byId("play"), byId("present")];
  const still = matchMedia("(prefers-reduced-motion: reduce)");
  /** @type {number | undefined} */
  let timer;
  const stop = () => {
    window.clearTimeout(timer);
    timer = undefined;
    play.textContent = "play";
    play.setAttribute("aria-pressed", "false");
  };
  /**
   * @param {number} start
   * @param {number} from
   */
  const step = (start, from) => {
    const part = Math.min(1, from + (performance.now() - start) / DURATION);
    const shown = still.matches ? Math.round(STEPS * part) / STEPS : part;
    store.choose({ load: loadAt(store.state, shown) }, performance.now());
    if (part >= 1) stop();
    else timer = window.setTimeout(() => step(start, from), still.matches ? STEP : 40);
  };
  play.addEventListener("click", () => {
    if (timer !== undefined) {
      stop();
      return;
    }
    const farthest = loadAt(store.state, 1);
    const at = store.state.chosen.load / farthest;
    play.textContent = "stop";
    play.setAttribute("aria-pressed", "true");
    // From the end, and from the critical state that the page begins with, it starts at first contact.
    step(performance.now(), at > 0.999 || store.state.chosen.load === 1 ? 0 : at);
  });
  for (const event of ["pointerdown", "keydown"]) byId("load").addEventListener(event, stop);
  byId("fields").addEventListener("input", stop);
  present.addEventListener("click", () => {
    const presents = document.body.classList.toggle("presents");
    present.setAttribute("aria-pressed", String(presents));
  });
}

/**
 * The load at a part of the way to the farthest one.
 * @param {State} state
 * @param {number} part
 * @returns {number}
 */
function loadAt({ chosen, cycle, start }, part) {
  if (!isCycle(chosen.case)) return Number((part * start.farthest_load).toFixed(3));
  const states = cycle?.is.states ?? [];
  return states[Math.round(part * (states.length - 1))]?.load ?? 2 * part;
}
