// The contact map: pillars from above, coloured by their force, and the floor where it is in contact.

import { engineeringText, significant } from "./numbers.js";
import { centre, pillarsWithin, topRadius, touchesFloor } from "./scene.js";
import { colour, letterSize, mixed, tint } from "./theme.js";

/**
 * @import { FloorCells, Point, SurfaceShown } from "./engine.js"
 * @import { Scene } from "./scene.js"
 * @import { MapView } from "./store.js"
 * @import { Colours } from "./theme.js"
 */

/**
 * What is drawn, and the scales.
 * @typedef {object} MapContents
 * @property {Scene} scene
 * @property {number} radius Critical contact radius, m; it sets the scale of lengths for all loads.
 * @property {number} force Force of a pillar with the last colour, N.
 * @property {MapView | null} view The part that is shown; null for the whole map.
 */

/**
 * @typedef {object} Canvas
 * @property {CanvasRenderingContext2D | OffscreenCanvasRenderingContext2D} context
 * @property {number} halfWidth Half the width of the part that is shown, m.
 * @property {Point} middle Its centre, m.
 * @property {number} pixel Width of a pixel of the screen, m.
 * @property {number} pillar Radius of pillars as drawn, m.
 */

/**
 * A canvas whose coordinates are metres from the lens axis.
 * @typedef {MapContents & Canvas} Sheet
 */

/** Pixels of a printed map for each of the screen. */
const PRINTED = 3;

/** Distances between ticks are one of these times a power of ten. */
const ROUND = [1, 2, 5, 10];

/**
 * Half the width of the whole map, m.
 * @param {MapContents} mapContents
 * @returns {number}
 */
export function halfWidth({ scene, radius }) {
  const floor = touchesFloor(scene)
    ? Math.max(0, ...scene.floor_contacts_m.map(([x, y]) => Math.hypot(x, y)))
    : 0;
  const cells = scene.floor === null ? 0 : reach(scene.floor);
  // The contact radius is the distance of the farthest pillar in contact: none for a single pillar on the lens axis.
  const discs = Math.max(0, ...scene.contacts.map(([x, y, disc]) => Math.hypot(x, y) + disc));
  const contact = Math.max(1.12 * radius, 1.12 * scene.contact_radius_m, 1.12 * discs, 1.3 * floor, 1.08 * cells);
  // Show a few pillars, unless they are far apart.
  const few = contact > 0 ? Math.min(2.3 * scene.pitch_m, 5 * contact) : 1.3 * scene.pitch_m;
  return Math.max(contact, few);
}

/**
 * Half the width of the part that is shown, and its centre, m. The part is inside of the whole map, which changes with the case.
 * @param {MapContents} contents
 * @returns {{ half: number, middle: Point }}
 */
function shownPart(contents) {
  const whole = halfWidth(contents);
  if (contents.view === null) return { half: whole, middle: [0, 0] };
  const { zoom, x, y } = contents.view;
  const half = whole / zoom;
  /** @type {(at: number) => number} */
  const inside = (at) => Math.min(whole - half, Math.max(half - whole, at));
  return { half, middle: [inside(x), inside(y)] };
}

/**
 * @param {HTMLCanvasElement} canvas
 * @param {MapContents} contents
 * @param {Colours} colours
 */
export function drawMap(canvas, contents, colours) {
  const own = canvas.getContext("2d");
  if (own === null) return;
  // A printed canvas would repeat the lines, with too few digits for coordinates in metres: paper has a picture, with finer pixels.
  const isPrinted = matchMedia("print").matches;
  const ratio = isPrinted ? PRINTED : window.devicePixelRatio || 1;
  const side = Math.round(canvas.clientWidth * ratio);
  if (side === 0) return;
  if (canvas.width !== side) canvas.width = canvas.height = side;
  const context = isPrinted ? new OffscreenCanvas(side, side).getContext("2d") : own;
  if (context === null) return;
  const { half, middle } = shownPart(contents);
  const scale = side / (2 * half);
  context.setTransform(1, 0, 0, 1, 0, 0);
  context.fillStyle = tint("--floor");
  context.fillRect(0, 0, side, side);
  context.setTransform(scale, 0, 0, -scale, side / 2 - scale * middle[0], side / 2 + scale * middle[1]);
  const pixel = ratio / scale;
  // Pillars too small to be visible are drawn larger.
  const listed = contents.scene.lattice.listed?.map(([, , diameter]) => diameter / 2) ?? [];
  const pillar = Math.max(listed.length > 0 ? Math.min(...listed) : contents.scene.diameter_m / 2, 1.2 * pixel);
  /** @type {Sheet} */
  const sheet = { ...contents, context, halfWidth: half, middle, pixel, pillar };
  drawFloor(sheet);
  drawUntouched(sheet);
  drawPillars(sheet, colours);
  drawMarks(sheet);
  context.setTransform(1, 0, 0, 1, 0, 0);
  drawAxes(context, side, scale, middle, ratio);
  if (context !== own) own.drawImage(context.canvas, 0, 0);
  canvas.setAttribute("aria-label", contents.scene.words);
}

/**
 * Draws a height map from above: heights from dark to light, and pressures in colours over them.
 * @param {HTMLCanvasElement} canvas
 * @param {SurfaceShown} surface
 * @param {Colours} colours
 */
export function drawRelief(canvas, { drawn: [columns, rows], corner_m, cell_m, heights, pressures }, colours) {
  const context = canvas.getContext("2d");
  if (context === null) return;
  const ratio = window.devicePixelRatio || 1;
  const side = Math.round(canvas.clientWidth * ratio);
  if (side === 0) return;
  if (canvas.width !== side) canvas.width = canvas.height = side;
  const [width, height] = [columns * cell_m[0], rows * cell_m[1]];
  const scale = side / Math.max(width, height);
  const image = new ImageData(columns, rows);
  for (let k = 0; k < heights.length; k += 1) {
    const pressure = pressures.charCodeAt(k) - PRESS;
    const grey = 70 + (170 * (heights.charCodeAt(k) - PRESS)) / (SHADES - 1);
    const entry = Math.round(((colours.length - 1) * pressure) / (SHADES - 1));
    const [red, green, blue] = colours[entry] ?? [grey, grey, grey];
    // The first row has the smallest y, and is the lowest on the screen.
    const row = rows - 1 - Math.floor(k / columns);
    image.data.set([red, green, blue, 255], 4 * (row * columns + (k % columns)));
  }
  const picture = new OffscreenCanvas(columns, rows);
  picture.getContext("2d")?.putImageData(image, 0, 0);
  context.setTransform(1, 0, 0, 1, 0, 0);
  context.fillStyle = tint("--floor");
  context.fillRect(0, 0, side, side);
  context.imageSmoothingEnabled = false;
  const [right, down] = [(side - width * scale) / 2, (side - height * scale) / 2];
  context.drawImage(picture, right, down, width * scale, height * scale);
  drawAxes(context, side, scale, [corner_m[0] + width / 2, corner_m[1] + height / 2], ratio);
}

/**
 * Largest distance of a side of the grid on the floor from the lens axis, m.
 * @param {FloorCells} floorCells
 * @returns {number}
 */
function reach({ corner_m: [x, y], cell_m: [width, height], columns, rows }) {
  return Math.max(-x, -y, x + columns * width, y + rows * height);
}

/** Number of shades of the pressure on the floor, one for each letter. */
const SHADES = 26;

/**
 * The colours of the shades, from the smallest pressure or tension to the largest.
 * @param {"press" | "pull"} kind
 * @returns {Colours}
 */
function floorColours(kind) {
  const prefix = { press: "--floor", pull: "--floor-pull" }[kind];
  const [low, high] = [tint(`${prefix}-low`), tint(`${prefix}-high`)];
  return Array.from({ length: SHADES }, (_, k) => mixed(low, high, k / (SHADES - 1)));
}

/** Character codes of the first letters for pressure (`a`) and tension (`A`). */
const [PRESS, PULL] = [97, 65];

/**
 * Draws the floor cells in contact, one pixel each.
 * @param {Sheet} sheet
 */
function drawFloor({ context, scene }) {
  const { floor } = scene;
  if (floor === null || floor.columns === 0) return;
  const { columns, rows, segments, shades } = floor;
  const picture = new OffscreenCanvas(columns, rows);
  const own = picture.getContext("2d");
  if (own === null) return;
  const pixels = own.createImageData(columns, rows);
  const [pressing, pulling] = [floorColours("press"), floorColours("pull")];
  let cell = 0;
  for (let k = 0; k + 2 < segments.length; k += 3) {
    const [row = 0, first = 0, count = 0] = segments.slice(k, k + 3);
    for (let column = first; column < first + count; column += 1) {
      const letter = shades.charCodeAt(cell);
      const [red, green, blue] = (letter < PRESS ? pulling[letter - PULL] : pressing[letter - PRESS]) ?? [0, 0, 0];
      pixels.data.set([red, green, blue, 255], 4 * (row * columns + column));
      cell += 1;
    }
  }
  own.putImageData(pixels, 0, 0);
  const [[x, y], [width, height]] = [floor.corner_m, floor.cell_m];
  context.globalAlpha = scene.floorIsOlder ? 0.4 : 1;
  context.filter = scene.floorIsOlder ? "grayscale(0.85)" : "none";
  context.rotate(floor.turned_rad);
  context.drawImage(picture, x, y, columns * width, rows * height);
  context.rotate(-floor.turned_rad);
  context.globalAlpha = 1;
  context.filter = "none";
}

/**
 * The pressure at a place on the floor, Pa, from the shade of its cell; null if the cell is not in contact.
 * @param {FloorCells} floor
 * @param {number} x
 * @param {number} y
 * @returns {number | null}
 */
function floorPressure(floor, x, y) {
  const [cos, sin] = [Math.cos(floor.turned_rad), Math.sin(floor.turned_rad)];
  const column = Math.floor((cos * x + sin * y - floor.corner_m[0]) / floor.cell_m[0]);
  const row = Math.floor((cos * y - sin * x - floor.corner_m[1]) / floor.cell_m[1]);
  let cell = 0;
  for (let k = 0; k + 2 < floor.segments.length; k += 3) {
    const [at = 0, first = 0, count = 0] = floor.segments.slice(k, k + 3);
    if (at === row && column >= first && column < first + count) {
      const letter = floor.shades.charCodeAt(cell + column - first);
      const [from, most] = letter < PRESS ? [PULL, floor.largest_pull_Pa] : [PRESS, floor.largest_pressure_Pa];
      return ((letter - from + 0.5) / SHADES) * most;
    }
    cell += count;
  }
  return null;
}

/**
 * Draws all pillar tops in view as not in contact.
 * @param {Sheet} sheet
 */
function drawUntouched({ context, scene, halfWidth, middle, pillar: least }) {
  context.beginPath();
  for (const [i, , x, y] of pillarsWithin(scene.lattice, halfWidth + least, middle)) {
    const radius = Math.max(least, topRadius(scene, i));
    context.moveTo(x + radius, y);
    context.arc(x, y, radius, 0, 2 * Math.PI);
  }
  context.fillStyle = tint("--pillar");
  context.fill();
}

/**
 * Draws the pillars in contact, with a quarter of the colours: pillars of one colour are drawn together.
 * @param {Sheet} sheet
 * @param {Colours} colours
 */
function drawPillars(sheet, colours) {
  const { context, scene, pixel, pillar } = sheet;
  const count = colours.length / 4;
  /** @type {Path2D[]} */
  const groups = Array.from({ length: count }, () => new Path2D());
  /** @type {Path2D[]} */
  const pulls = Array.from({ length: PULLS }, () => new Path2D());
  const parts = new Map(scene.parts.map((part) => [part.pillar, part.outline]));
  const partial = new Path2D();
  // Width of the ring around a partial contact.
  const width = Math.max(1.5 * pixel, 0.3 * pillar);
  scene.forces_N.forEach((force, k) => {
    const [x, y] = centre(scene, k);
    const radius = Math.max(topRadius(scene, scene.pillars[2 * k]), 1.2 * pixel);
    const path =
      force < 0
        ? pulls[shade(force / scene.pull_N, PULLS)]
        : groups[shade(force / sheet.force, count)];
    const outline = parts.get(k);
    const disc = scene.contacts[k];
    if (disc !== undefined) {
      // The contact on a rounded top, which is drawn below it.
      const [right, up, own] = [disc[0], disc[1], Math.max(disc[2], 1.2 * pixel)];
      path?.moveTo(right + own, up);
      path?.arc(right, up, own, 0, 2 * Math.PI);
      return;
    }
    if (outline === undefined) {
      path?.moveTo(x + radius, y);
      path?.arc(x, y, radius, 0, 2 * Math.PI);
    } else {
      addOutline(path, outline, x, y, radius);
    }
    if (scene.statuses[k] === "p") {
      const rim = radius + width / 2;
      partial.moveTo(x + rim, y);
      partial.arc(x, y, rim, 0, 2 * Math.PI);
    }
  });
  groups.forEach((path, k) => {
    context.fillStyle = colour(colours, k * 4 + 2);
    context.fill(path);
  });
  const colourOfPull = pullColours();
  pulls.forEach((path, k) => {
    context.fillStyle = colour(colourOfPull, k);
    context.fill(path);
  });
  context.strokeStyle = tint("--partial");
  context.lineWidth = width;
  context.stroke(partial);
}

/** Number of shades of tension. */
const PULLS = 16;

/**
 * The colours of tension, from zero to the largest.
 * @returns {Colours}
 */
function pullColours() {
  const [low, high] = [tint("--pull-low"), tint("--pull-high")];
  return Array.from({ length: PULLS }, (_, k) => mixed(low, high, k / (PULLS - 1)));
}

/**
 * Index of the shade, out of `count`, for a fraction of the largest value.
 * @param {number} part
 * @param {number} count
 * @returns {number}
 */
function shade(part, count) {
  return Math.min(count - 1, Math.max(0, Math.round(part * (count - 1))));
}

/**
 * Adds the bonded region of a top.
 * @param {Path2D | undefined} path
 * @param {readonly number[]} outline
 * @param {number} x
 * @param {number} y
 * @param {number} radius
 */
function addOutline(path, outline, x, y, radius) {
  for (let k = 0; k + 1 < outline.length; k += 2) {
    const corner = /** @type {const} */ ([x + radius * (outline[k] ?? 0), y + radius * (outline[k + 1] ?? 0)]);
    if (k === 0) path?.moveTo(...corner);
    else path?.lineTo(...corner);
  }
  path?.closePath();
}

/**
 * Draws the edge of the contact, the lens axis and point contacts with the floor.
 * @param {Sheet} sheet
 */
function drawMarks({ context, scene, pixel }) {
  const edge = scene.contact_radius_m;
  /** @type {(x: number, y: number, radius: number) => void} */
  const circle = (x, y, radius) => {
    context.beginPath();
    context.arc(x, y, radius, 0, 2 * Math.PI);
  };
  if (edge > 0) {
    circle(0, 0, edge);
    context.setLineDash([6 * pixel, 4 * pixel]);
    context.lineWidth = 1.4 * pixel;
    context.strokeStyle = tint("--ink");
    context.stroke();
    context.setLineDash([]);
  }
  const size = letterSize() * 0.32 * pixel;
  const touches = touchesFloor(scene);
  for (const [x, y] of scene.floor_contacts_m) {
    circle(x, y, size);
    context.lineWidth = 1.6 * pixel;
    context.strokeStyle = tint("--panel");
    context.fillStyle = tint("--mark");
    if (touches) context.fill();
    context.stroke();
    context.lineWidth = 1.2 * pixel;
    context.strokeStyle = tint("--mark");
    if (!touches) context.stroke();
  }
  context.beginPath();
  context.moveTo(-size, 0);
  context.lineTo(size, 0);
  context.moveTo(0, -size);
  context.lineTo(0, size);
  context.lineWidth = 1.5 * pixel;
  context.strokeStyle = tint("--axis-cross");
  context.stroke();
}

/**
 * Draws ticks with their distances from the lens axis along the lower and the left edge.
 * @param {CanvasRenderingContext2D | OffscreenCanvasRenderingContext2D} context
 * @param {number} side
 * @param {number} scale
 * @param {Point} middle
 * @param {number} ratio
 */
function drawAxes(context, side, scale, middle, ratio) {
  const size = letterSize() * ratio;
  const least = (0.2 * side) / scale;
  const power = 10 ** Math.floor(Math.log10(least));
  const step = power * Math.min(...ROUND.filter((round) => round * power >= least));
  context.font = `${0.8 * size}px Roboto, system-ui, sans-serif`;
  /** @type {(centre: number) => { words: string, at: number, width: number }[]} */
  const ticks = (centre) => {
    const [from, to] = [-1, 1].map((end) => Math.round((centre + (end * side) / 2 / scale) / step));
    return Array.from({ length: (to ?? 0) - (from ?? 0) + 1 }, (_, k) => {
      const value = ((from ?? 0) + k) * step;
      const words = tickWords(value, step);
      return { words, at: side / 2 + (value - centre) * scale, width: context.measureText(words).width };
    });
  };
  // Labels that would leave the map are left out.
  for (const { words, at, width } of ticks(middle[0])) {
    if (at - width / 2 <= 2.2 * size || at + width / 2 >= side - 0.3 * size) continue;
    label(context, words, at - width / 2, side - 0.75 * size, width, size);
    context.fillRect(at - 0.5 * ratio, side - 0.45 * size, ratio, 0.45 * size);
  }
  for (const { words, at, width } of ticks(middle[1])) {
    const up = side - at;
    if (up <= 2.6 * size || up >= side - 2.4 * size) continue;
    label(context, words, 0.7 * size, up + 0.28 * size, width, size);
    context.fillRect(0, up - 0.5 * ratio, 0.45 * size, ratio);
  }
  label(context, "x", side - 1.1 * size, side - 2.1 * size, context.measureText("x").width, size);
  label(context, "y", 0.7 * size, 1.4 * size, context.measureText("y").width, size);
}

/**
 * A tick with as many digits as distinguish it from its neighbours.
 * @param {number} value
 * @param {number} step
 * @returns {string}
 */
function tickWords(value, step) {
  if (value === 0) return "0";
  const digits = Math.floor(Math.log10(Math.abs(value)) + 1e-9) - Math.floor(Math.log10(step) + 1e-9) + 1;
  return engineeringText(value, "length", Math.max(2, digits)).replace(/(\.\d*?)0+(?= )/, "$1").replace(/\.(?= )/, "");
}

/**
 * Writes words on a veil, and leaves the colour of the ink.
 * @param {CanvasRenderingContext2D | OffscreenCanvasRenderingContext2D} context
 * @param {string} words
 * @param {number} left
 * @param {number} base
 * @param {number} width
 * @param {number} size
 */
function label(context, words, left, base, width, size) {
  context.fillStyle = tint("--veil");
  context.fillRect(left - 0.15 * size, base - 0.75 * size, width + 0.3 * size, size);
  context.fillStyle = tint("--ink");
  context.textAlign = "left";
  context.fillText(words, left, base);
}

/**
 * Draws the colour bar of the pressure on the floor, from zero to the largest.
 * @param {HTMLCanvasElement} bar
 */
export function drawFloorBar(bar) {
  drawColourBar(bar, floorColours("press"));
}

/**
 * Draws the colour bar of the tension on the floor, from the largest to zero.
 * @param {HTMLCanvasElement} bar
 */
export function drawFloorPullBar(bar) {
  drawColourBar(bar, [...floorColours("pull")].reverse());
}

/**
 * Draws the colour bar of the tension of pillars, from the largest to zero.
 * @param {HTMLCanvasElement} bar
 */
export function drawPullBar(bar) {
  drawColourBar(bar, [...pullColours()].reverse());
}

/**
 * Draws a colour bar, from the first colour to the last.
 * @param {HTMLCanvasElement} bar
 * @param {Colours} colours
 */
export function drawColourBar(bar, colours) {
  const context = bar.getContext("2d");
  if (context === null) return;
  const ratio = window.devicePixelRatio || 1;
  bar.width = Math.max(1, Math.round(bar.clientWidth * ratio));
  bar.height = Math.max(1, Math.round(bar.clientHeight * ratio));
  const own = new ImageData(colours.length, 1);
  colours.forEach(([red, green, blue], k) => own.data.set([red, green, blue, 255], 4 * k));
  const picture = new OffscreenCanvas(colours.length, 1);
  picture.getContext("2d")?.putImageData(own, 0, 0);
  context.imageSmoothingEnabled = false;
  context.drawImage(picture, 0, 0, bar.width, bar.height);
}

/**
 * Describes what is under the pointer.
 * @param {HTMLCanvasElement} canvas
 * @param {MapContents} contents
 * @param {PointerEvent} event
 * @returns {string}
 */
export function wordsAt(canvas, contents, event) {
  const { scene } = contents;
  const half = canvas.clientWidth / 2;
  const part = shownPart(contents);
  const metres = part.half / half;
  const x = part.middle[0] + (event.offsetX - half) * metres;
  const y = part.middle[1] + (half - event.offsetY) * metres;
  const place = `${engineeringText(Math.hypot(x, y), "length", 3)} from the axis`;
  const pressure = scene.floor === null || scene.floorIsOlder ? null : floorPressure(scene.floor, x, y);
  let words =
    pressure === null
      ? place
      : `floor in contact, about ${engineeringText(pressure, "pressure", 2)}, ${place}`;
  for (let k = 0; k < scene.forces_N.length; k += 1) {
    const [a, b] = centre(scene, k);
    const disc = scene.contacts[k];
    if (Math.hypot(a - x, b - y) <= Math.max(topRadius(scene, scene.pillars[2 * k]), disc?.[2] ?? 0)) {
      const force = engineeringText(scene.forces_N[k] ?? 0, "force", 4);
      const covered = scene.parts.find(({ pillar }) => pillar === k)?.covered;
      const partly =
        covered !== undefined
          ? `, ${significant(100 * covered, 2)} % of its top bonded`
          : scene.statuses[k] === "p"
            ? ", partial contact"
            : "";
      const radius = disc === undefined ? "" : `, contact radius ${engineeringText(disc[2], "length", 3)}`;
      words = `${scene.lattice.listed?.length === 1 && disc !== undefined ? "contact" : "pillar"} ${force}${disc === undefined ? partly : radius}, ${place}`;
    }
  }
  return words.replace(/\^\{(.*?)\}/g, "^$1");
}
