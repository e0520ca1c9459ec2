// Draws the state: every view once a frame, if what it shows has changed.

import type { State, Store } from "./store.js";

interface View {
  readonly parts: (state: State) => readonly unknown[];
  readonly draw: (state: State) => void;
  /** What it was drawn from; null if it has to be drawn anew. */
  drawn: readonly unknown[] | null;
}

export class Screen {
  readonly #views: View[] = [];
  #waiting = false;

  constructor(
    private readonly store: Store,
    /** Called after everything has been drawn. */
    private readonly shown: (state: State) => void,
  ) {
    store.listen(() => this.#wait());
  }

  /** Draws whenever one of `parts` is another one, or one of the elements has another size. */
  add(
    parts: (state: State) => readonly unknown[],
    draw: (state: State) => void,
    elements: readonly Element[] = [],
  ): void {
    const view: View = { parts, draw, drawn: null };
    this.#views.push(view);
    const sizes = new ResizeObserver(() => {
      if (view.drawn !== null) draw(this.store.state);
    });
    for (const element of elements) sizes.observe(element);
    this.#wait();
  }

  /** Draws everything anew, as in other colours. */
  redraw(): void {
    for (const view of this.#views) view.drawn = null;
    this.#wait();
  }

  #wait(): void {
    if (this.#waiting) return;
    this.#waiting = true;
    requestAnimationFrame(() => this.#draw());
  }

  #draw(): void {
    this.#waiting = false;
    const state = this.store.state;
    for (const view of this.#views) {
      const parts = view.parts(state);
      if (view.drawn?.every((part, k) => part === parts[k])) continue;
      view.drawn = parts;
      view.draw(state);
    }
    this.shown(state);
  }
}

export function byId<T extends Element = HTMLElement>(id: string): T {
  const found = document.getElementById(id);
  if (found === null) throw new Error(`no element ${id}`);
  return found as Element as T;
}

/** Makes something grey that is of an older case or load, or not any more. */
export function age(element: Element, older: boolean): void {
  element.classList.toggle("older", older);
  element.setAttribute("aria-busy", String(older));
}
