// The part of the map that is shown: buttons, keys, wheel and pointer.

import { halfWidth } from "./map.js";
import { engineeringText, significant } from "./numbers.js";
import { byId } from "./screen.js";

/**
 * @import { MapContents } from "./map.js"
 * @import { MapView, State, Store } from "./store.js"
 */

/** Factor of a step of the zoom, and the largest magnification. */
const STEP = 1.5;
const MOST = 64;

/** An arrow key moves the map by this fraction of its width. */
const SHIFT = 0.15;

/** Pixels that the wheel turns for a factor e of the magnification. */
const WHEEL = 400;

/**
 * Connects the map with its buttons, keys, wheel and pointer. `contentsOf` returns what the map shows.
 * @param {Store} store
 * @param {(state: State) => MapContents | null} contentsOf
 */
export function zoomable(store, contentsOf) {
  const [frame, canvas] = [byId("map-frame"), byId("map", HTMLCanvasElement)];
  /**
   * Changes the view: `change` receives the present one, and half the width of the whole map, m.
   * @param {(view: MapView, half: number) => MapView} change
   */
  const look = (change) => {
    const contents = contentsOf(store.state);
    if (contents === null) return;
    const half = halfWidth(contents);
    const view = within(change(within(store.state.chosen.view, half) ?? { zoom: 1, x: 0, y: 0 }, half), half);
    store.choose({ view }, performance.now());
  };
  /**
   * Magnifies by a factor; the place at these fractions of half the width from the centre stays where it is.
   * @param {number} factor
   * @param {number} [right]
   * @param {number} [up]
   */
  const magnify = (factor, right = 0, up = 0) =>
    look((view, half) => {
      const zoom = Math.min(MOST, Math.max(1, view.zoom * factor));
      const moved = half / view.zoom - half / zoom;
      return { zoom, x: view.x + right * moved, y: view.y + up * moved };
    });
  /**
   * Moves the view by fractions of half its width.
   * @param {number} right
   * @param {number} up
   */
  const move = (right, up) =>
    look(({ zoom, x, y }, half) => ({ zoom, x: x + (right * half) / zoom, y: y + (up * half) / zoom }));
  const whole = () => store.choose({ view: null }, performance.now());

  byId("zoom-in").addEventListener("click", () => magnify(STEP));
  byId("zoom-out").addEventListener("click", () => magnify(1 / STEP));
  byId("zoom-whole").addEventListener("click", whole);
  /** @type {Readonly<Record<string, () => void>>} */
  const keys = {
    "+": () => magnify(STEP),
    "=": () => magnify(STEP),
    "-": () => magnify(1 / STEP),
    0: whole,
    ArrowLeft: () => move(-2 * SHIFT, 0),
    ArrowRight: () => move(2 * SHIFT, 0),
    ArrowUp: () => move(0, 2 * SHIFT),
    ArrowDown: () => move(0, -2 * SHIFT),
  };
  frame.addEventListener("keydown", (event) => {
    const act = keys[event.key];
    // Arrow keys scroll the page while the whole map is shown, and keys of the browser stay its own.
    const isIdle = event.key.startsWith("Arrow") && store.state.chosen.view === null;
    if (act === undefined || isIdle || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    act();
  });
  canvas.addEventListener(
    "wheel",
    (event) => {
      // Without a modifier the wheel scrolls the page. Two fingers on a touchpad arrive with the control key.
      if (!event.ctrlKey && !event.metaKey && !event.shiftKey) return;
      event.preventDefault();
      const side = canvas.clientWidth;
      const turned = event.deltaY === 0 ? event.deltaX : event.deltaY;
      magnify(Math.exp(-turned / WHEEL), (2 * event.offsetX) / side - 1, 1 - (2 * event.offsetY) / side);
    },
    { passive: false },
  );
  canvas.addEventListener("pointerdown", (event) => {
    if (store.state.chosen.view === null || event.button !== 0) return;
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointermove", ({ pointerId, movementX, movementY }) => {
    if (!canvas.hasPointerCapture(pointerId)) return;
    const half = canvas.clientWidth / 2;
    move(-movementX / half, movementY / half);
  });
}

/**
 * The view within the whole map; null for the whole map.
 * @param {MapView | null} view
 * @param {number} half
 * @returns {MapView | null}
 */
function within(view, half) {
  if (view === null || !(view.zoom > 1.001)) return null;
  const most = half * (1 - 1 / view.zoom);
  /** @type {(at: number) => number} */
  const inside = (at) => Number(Math.min(most, Math.max(-most, at)).toPrecision(6));
  return { zoom: Number(view.zoom.toPrecision(6)), x: inside(view.x), y: inside(view.y) };
}

/**
 * Shows which part of the map is seen, and which buttons have an effect.
 * @param {State} state
 */
export function drawZoom({ chosen: { view } }) {
  byId("map").classList.toggle("zoomed", view !== null);
  for (const id of ["zoom-out", "zoom-whole"]) byId(id, HTMLButtonElement).disabled = view === null;
  byId("zoom-in", HTMLButtonElement).disabled = view !== null && view.zoom >= MOST;
  /** @type {(at: number) => string} */
  const length = (at) => (at === 0 ? "0" : engineeringText(at, "length", 3));
  byId("zoom-words").textContent =
    view === null ? "" : `× ${significant(view.zoom, 3)}, centre x = ${length(view.x)}, y = ${length(view.y)}`;
}
