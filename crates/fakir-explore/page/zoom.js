// The part of the map that is shown: buttons, keys, wheel, pointer and two fingers.

import { halfWidth } from "./map.js";
import { engineeringText, significant } from "./numbers.js";
import { byId } from "./screen.js";

/**
 * @import { Place } from "./charts.js"
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
  /** Places of the fingers on the map, in pixels. @type {Map<number, Place>} */
  const fingers = new Map();
  canvas.addEventListener("pointerdown", (event) => {
    if (event.pointerType === "touch") fingers.set(event.pointerId, [event.offsetX, event.offsetY]);
    const isDrag = store.state.chosen.view !== null && event.button === 0;
    if (isDrag || fingers.size === 2) canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointermove", (event) => {
    const { pointerId, movementX, movementY } = event;
    const half = canvas.clientWidth / 2;
    if (fingers.size === 2 && fingers.has(pointerId)) {
      const before = spread([...fingers.values()]);
      fingers.set(pointerId, [event.offsetX, event.offsetY]);
      const after = spread([...fingers.values()]);
      // The places under the fingers follow them.
      magnify(after.apart / before.apart, before.middle[0] / half - 1, 1 - before.middle[1] / half);
      move((before.middle[0] - after.middle[0]) / half, (after.middle[1] - before.middle[1]) / half);
      return;
    }
    if (fingers.has(pointerId)) fingers.set(pointerId, [event.offsetX, event.offsetY]);
    if (canvas.hasPointerCapture(pointerId)) move(-movementX / half, movementY / half);
  });
  for (const end of /** @type {const} */ (["pointerup", "pointercancel"])) {
    canvas.addEventListener(end, ({ pointerId }) => fingers.delete(pointerId));
  }
  // One finger scrolls the page while the whole map is shown; two never do.
  for (const touch of /** @type {const} */ (["touchstart", "touchmove"])) {
    canvas.addEventListener(
      touch,
      (event) => {
        if (event.touches.length > 1) event.preventDefault();
      },
      { passive: false },
    );
  }
}

/** Smallest distance of two fingers, pixels. */
const CLOSEST = 10;

/**
 * Distance of two fingers, and the place in the middle between them.
 * @param {readonly Place[]} fingers
 * @returns {{ apart: number, middle: Place }}
 */
function spread([[x, y] = [0, 0], [u, v] = [0, 0]]) {
  return { apart: Math.max(CLOSEST, Math.hypot(x - u, y - v)), middle: [(x + u) / 2, (y + v) / 2] };
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
