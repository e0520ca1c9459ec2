// Draws the state: every view of which something has changed, all together.

import { isOlder, type Of, type State, type Store } from "./store.js";

interface View {
  readonly parts: (state: State) => readonly unknown[];
  readonly draw: (state: State) => void;
  /** The parts of the state that it was drawn from; null if it has to be drawn anew. */
  drawn: readonly unknown[] | null;
}

export class Screen {
  readonly #views: View[] = [];
  #frameAwaited = false;
  /** Functions to be called once the screen shows what was drawn. */
  #afterwards: (() => void)[] = [];

  constructor(
    private readonly store: Store,
    /** Called in every frame in which something is drawn. */
    private readonly framed: (state: State) => void,
  ) {
    store.listen(() => this.#changed());
  }

  /** Calls `draw` whenever one of `parts` has changed, or one of the elements has another size. */
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
    this.#changed();
  }

  /** Makes elements grey while what they show is of an older case, or of an older load. */
  age(
    shown: (state: State) => Of<unknown> | null,
    dependsOn: "case" | "load",
    elements: readonly Element[],
  ): void {
    const older = (state: State): boolean => isOlder(state, shown(state), dependsOn);
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

  /** Draws everything anew, for example in other colours. */
  redraw(): void {
    for (const view of this.#views) view.drawn = null;
    this.#changed();
  }

  /** Calls `act` after the next frame, when the screen shows what was drawn. */
  whenShown(act: () => void): void {
    this.#afterwards.push(act);
  }

  /** Draws a change at once. Further changes before the next frame are drawn in that frame. */
  #changed(): void {
    if (this.#frameAwaited) return;
    this.#frameAwaited = true;
    queueMicrotask(() => this.#draw());
    requestAnimationFrame(() => this.#frame());
  }

  #frame(): void {
    this.#frameAwaited = false;
    this.#draw();
    this.framed(this.store.state);
    const afterwards = this.#afterwards;
    if (afterwards.length === 0) return;
    this.#afterwards = [];
    const channel = new MessageChannel();
    channel.port1.onmessage = () => afterwards.forEach((act) => act());
    channel.port2.postMessage(null);
  }

  #draw(): void {
    const state = this.store.state;
    for (const view of this.#views) {
      const parts = view.parts(state);
      if (view.drawn?.every((part, k) => part === parts[k])) continue;
      view.drawn = parts;
      view.draw(state);
    }
  }
}

export function byId<T extends Element = HTMLElement>(id: string): T {
  const found = document.getElementById(id);
  if (found === null) throw new Error(`no element ${id}`);
  return found as Element as T;
}
