// Draws the state: all views whose parts of the state have changed, together.

import { isOlder } from "./store.js";

/** @import { Of, State, Store } from "./store.js" */

/**
 * @typedef {object} View
 * @property {(state: State) => readonly unknown[]} parts
 * @property {(state: State) => void} draw
 * @property {readonly unknown[] | null} drawn The parts of the state that it was drawn from; null if it must be
 *   redrawn.
 * @property {readonly Element[]} elements Elements whose size it depends on.
 * @property {string} size The size of these elements when it was drawn.
 * @property {boolean} isLate Whether it is left out of the first frame.
 */

export class Screen {
  /** @type {Store} */
  #store;
  /**
   * Called in every frame in which something is drawn.
   * @type {(state: State) => void}
   */
  #framed;
  /** @type {View[]} */
  #views = [];
  #frameAwaited = false;
  /** Whether the first picture is on the screen, after which the late views are drawn. */
  #isOpen = false;
  /**
   * Functions to be called once the screen shows what was drawn.
   * @type {(() => void)[]}
   */
  #afterwards = [];

  /**
   * @param {Store} store
   * @param {(state: State) => void} framed
   */
  constructor(store, framed) {
    this.#store = store;
    this.#framed = framed;
    store.listen(() => this.#changed());
    // The first frame draws everything, with the answers that the document contains.
    this.#frameAwaited = true;
    requestAnimationFrame(() => this.#frame());
  }

  /**
   * Calls `draw` whenever one of `parts` has changed, or an element has changed its size.
   * @param {(state: State) => readonly unknown[]} parts
   * @param {(state: State) => void} draw
   * @param {readonly Element[]} [elements]
   */
  add(parts, draw, elements = []) {
    this.#add(parts, draw, elements, false);
  }

  /**
   * As `add`, for what is below the first screen: it is drawn after the first picture is shown.
   * @param {(state: State) => readonly unknown[]} parts
   * @param {(state: State) => void} draw
   * @param {readonly Element[]} [elements]
   */
  addLate(parts, draw, elements = []) {
    this.#add(parts, draw, elements, true);
  }

  /**
   * @param {(state: State) => readonly unknown[]} parts
   * @param {(state: State) => void} draw
   * @param {readonly Element[]} elements
   * @param {boolean} isLate
   */
  #add(parts, draw, elements, isLate) {
    /** @type {View} */
    const view = { parts, draw, drawn: null, elements, size: "", isLate };
    this.#views.push(view);
    // It is also called for the first size, in which the view was drawn.
    const sizes = new ResizeObserver(() => {
      if (view.drawn !== null && view.size !== sizeOf(elements)) drawView(view, this.#store.state);
    });
    for (const element of elements) sizes.observe(element);
    this.#changed();
  }

  /**
   * Greys out elements while they show results of an older case or load.
   * @param {(state: State) => Of<unknown> | null} shown
   * @param {"case" | "load"} dependsOn
   * @param {readonly Element[]} elements
   */
  age(shown, dependsOn, elements) {
    /** @type {(state: State) => boolean} */
    const older = (state) => isOlder(state, shown(state), dependsOn);
    this.add(
      (state) => [older(state)],
      (state) => {
        for (const element of elements) {
          element.classList.toggle("older", older(state));
          element.setAttribute("aria-busy", String(older(state)));
        }
      },
    );
  }

  /** Redraws everything, for example in other colours. */
  redraw() {
    for (const view of this.#views) view.drawn = null;
    this.#changed();
  }

  /**
   * Calls `act` after the next frame, when the screen shows what was drawn.
   * @param {() => void} act
   */
  whenShown(act) {
    this.#afterwards.push(act);
  }

  /** Draws a change at once. Further changes before the next frame are drawn in that frame. */
  #changed() {
    if (this.#frameAwaited) return;
    this.#frameAwaited = true;
    queueMicrotask(() => this.#draw());
    requestAnimationFrame(() => this.#frame());
  }

  #frame() {
    this.#frameAwaited = false;
    this.#draw();
    this.#framed(this.#store.state);
    const afterwards = this.#afterwards;
    if (afterwards.length === 0) {
      this.#open();
      return;
    }
    this.#afterwards = [];
    const channel = new MessageChannel();
    channel.port1.onmessage = () => {
      afterwards.forEach((act) => act());
      this.#open();
    };
    channel.port2.postMessage(null);
  }

  /** Draws the late views. */
  #open() {
    if (this.#isOpen) return;
    this.#isOpen = true;
    this.#changed();
  }

  #draw() {
    const state = this.#store.state;
    for (const view of this.#views) {
      if (view.isLate && !this.#isOpen) continue;
      const parts = view.parts(state);
      if (view.drawn?.every((part, k) => part === parts[k])) continue;
      view.drawn = parts;
      drawView(view, state);
    }
  }
}

/**
 * @param {View} view
 * @param {State} state
 */
function drawView(view, state) {
  view.size = sizeOf(view.elements);
  view.draw(state);
}

/**
 * The sizes of elements, as a text to compare.
 * @param {readonly Element[]} elements
 * @returns {string}
 */
function sizeOf(elements) {
  return elements
    .map((element) => {
      const { width, height } = element.getBoundingClientRect();
      return `${width} ${height}`;
    })
    .join();
}

/**
 * The element with this ID, of a certain class if one is given.
 * @template {Element} [T=HTMLElement]
 * @param {string} id
 * @param {new () => T} [kind]
 * @returns {T}
 */
export function byId(id, kind) {
  const found = document.getElementById(id);
  if (found === null || (kind && !(found instanceof kind))) throw new Error(`no element ${id}`);
  return /** @type {T} */ (/** @type {Element} */ (found));
}
