// Scenes: what the map shows of a state or of an estimate.

import { engineeringText, radiusDigits, significant } from "./numbers.js";

/**
 * @import {
 *   ContactState, FloorCells, FloorStation, Lattice, PartialTop, Point, Preview, SolvedCycle, StationState,
 * } from "./engine.js"
 */

/**
 * @typedef {object} Scene
 * @property {number | null} fraction
 * @property {number} pitch_m
 * @property {number} diameter_m
 * @property {Lattice} lattice
 * @property {number} contact_radius_m
 * @property {readonly number[]} pillars
 * @property {readonly number[]} forces_N
 * @property {string} statuses A letter for each pillar: `f` for full, `p` for partial contact; empty if unknown.
 * @property {readonly (readonly [number, number, number])[]} contacts Centre and radius of the contact on each pillar, m, with rounded tops; else
 *   empty.
 * @property {readonly PartialTop[]} parts Bonded regions of the partial contacts, where known.
 * @property {number} pull_N Largest tension of a pillar on the colour scale, N, negative; 0 without adhesion.
 * @property {readonly Point[]} floor_contacts_m
 * @property {FloorCells | null} floor
 * @property {boolean} floorIsOlder Whether the floor belongs to an earlier state of the same pillars; it is greyed
 *   out.
 * @property {string} words
 */

/**
 * The scene of a contact state.
 * @param {ContactState} state
 * @returns {Scene}
 */
export function sceneOf(state) {
  const { summary } = state;
  if (summary.method === "homogenised") {
    const { force_N, contact_radius_m } = summary;
    return sceneOfPreview({ ...state, fraction: state.fraction ?? 1, force_N, contact_radius_m });
  }
  /** A flat surface has no pillars. @type {{ pillars_in_contact?: number, pillars_partially_in_contact?: number }} */
  const { pillars_in_contact: all, pillars_partially_in_contact: part } = summary;
  const edge = summary.top_contact_radius_m ?? summary.contact_radius_m;
  const radius = engineeringText(
    edge,
    "length",
    Math.min(3, radiusDigits(summary.relative_error_estimate.contact_radius)),
  );
  return {
    fraction: state.fraction,
    pitch_m: state.pitch_m,
    diameter_m: state.diameter_m,
    lattice: state.lattice,
    contact_radius_m: edge,
    pillars: state.pillars,
    forces_N: state.pillar_forces_N,
    statuses: state.pillar_statuses,
    contacts: state.contacts_m ?? [],
    parts: [],
    pull_N: pullOf(state.pillar_forces_N),
    floor_contacts_m: state.floor_contacts_m,
    floor: state.floor,
    floorIsOlder: false,
    words:
      (all === undefined
        ? `Contact from above: one disc of radius ${radius}`
        : `Contact from above: ${all} pillars in contact, ${part} of them partially, within ${radius} of the lens axis`) +
      (state.normalized === null ? "" : `, a/e = ${significant(state.normalized[1], 3)}`) +
      (!summary.floor
        ? ""
        : `; the floor is in contact within ${engineeringText(summary.floor.radius_m, "length", 3)}`),
  };
}

/**
 * The largest tension of a pillar, negative; 0 where it is only the rounding of a force that vanishes.
 * @param {readonly number[]} forces
 * @returns {number}
 */
function pullOf(forces) {
  const least = forces.reduce((least, force) => Math.min(least, force), 0);
  const most = forces.reduce((most, force) => Math.max(most, Math.abs(force)), 0);
  return least < -1e-12 * most ? least : 0;
}

/**
 * The scene of a state of a cycle.
 * @param {SolvedCycle} cycle
 * @param {StationState} state
 * @returns {Scene}
 */
export function sceneOfStation(cycle, state) {
  const station = cycle.summary.stations[state.place];
  const forces = state.pillar_forces_N;
  const partial = new Set(state.parts.map(({ pillar }) => pillar));
  const pulled = forces.filter((force) => force < 0).length;
  const [all, radius] = [forces.length, station?.contact_radius_m ?? 0];
  const onFloor = floorAt(cycle, state);
  return {
    fraction: state.load,
    pitch_m: cycle.pitch_m,
    diameter_m: cycle.diameter_m,
    lattice: cycle.lattice,
    contact_radius_m: radius,
    pillars: state.pillars,
    forces_N: forces,
    contacts: [],
    statuses: forces.map((_, k) => (partial.has(k) ? "p" : "f")).join(""),
    parts: state.parts,
    pull_N: cycle.largest_pull_N,
    floor_contacts_m: state.floor_contacts_m,
    floor: state.floor,
    floorIsOlder: false,
    words:
      `Contact from above, ${station?.branch ?? "loading"}: ${all} pillars in contact, ` +
      `${partial.size} of them partially, ${pulled} in tension, ` +
      `within ${engineeringText(radius, "length", 3)} of the lens axis` +
      (onFloor === null ? "" : `; adhesive floor, ${holesWords(onFloor.filled_holes)} filled`),
  };
}

/**
 * Contact with an adhesive floor at a state of a cycle; null if there is none.
 * @param {SolvedCycle} cycle
 * @param {StationState} state
 * @returns {FloorStation | null}
 */
export function floorAt(cycle, state) {
  return cycle.summary.floor?.stations.find(({ station }) => station === state.place) ?? null;
}

/**
 * @param {number} holes
 * @returns {string}
 */
export function holesWords(holes) {
  return `${holes} ${holes === 1 ? "hole" : "holes"}`;
}

/**
 * The data from which pillar forces are estimated when pillars are not resolved.
 * @typedef {Pick< Preview, "fraction" | "pitch_m" | "diameter_m" | "lattice" | "force_N" | "contact_radius_m" >}
 *   Smooth
 */

/**
 * The scene of a preview: pillar forces follow the pressure under a sphere and add up to the load.
 * @param {Smooth} preview
 * @returns {Scene}
 */
export function sceneOfPreview(preview) {
  const { contact_radius_m: radius, lattice } = preview;
  /** @type {number[]} */
  const pillars = [];
  /** @type {number[]} */
  const forces = [];
  let sum = 0;
  for (const [i, j, x, y] of pillarsWithin(lattice, radius)) {
    const squared = (x * x + y * y) / (radius * radius);
    if (squared >= 1) continue;
    const force = Math.sqrt(1 - squared);
    sum += force;
    pillars.push(i, j);
    forces.push(force);
  }
  return {
    fraction: preview.fraction,
    pitch_m: preview.pitch_m,
    diameter_m: preview.diameter_m,
    lattice,
    contact_radius_m: radius,
    pillars,
    forces_N: forces.map((force) => (force * preview.force_N) / sum),
    statuses: "",
    contacts: [],
    parts: [],
    pull_N: 0,
    floor_contacts_m: [],
    floor: null,
    floorIsOlder: false,
    words: "Contact from above, estimated with the homogenised lattice",
  };
}

/**
 * Adds the floor of the previous scene, greyed out, to a scene without floor, if both have the same pillars.
 * @param {Scene} scene
 * @param {Scene | null} before
 * @returns {Scene}
 */
export function withFloorBefore(scene, before) {
  /** @type {(scene: Scene) => string} */
  const pillars = ({ diameter_m, lattice: { vectors_m, origin_m } }) =>
    [diameter_m, ...vectors_m.flat(), ...origin_m].join();
  if (before === null || before.floor === null || pillars(before) !== pillars(scene)) return scene;
  return { ...scene, floor: before.floor, floorIsOlder: true, floor_contacts_m: [] };
}

/**
 * Whether the lens reaches the floor: at the critical state and beyond it.
 * @param {Scene} scene
 * @returns {boolean}
 */
export function touchesFloor({ fraction }) {
  return fraction !== null && fraction > 1 - 1e-9;
}

/**
 * Centre of the k-th pillar in contact, m.
 * @param {Scene} scene
 * @param {number} k
 * @returns {[number, number]}
 */
export function centre(scene, k) {
  return place(scene.lattice, scene.pillars[2 * k] ?? 0, scene.pillars[2 * k + 1] ?? 0);
}

/**
 * @param {Lattice} lattice
 * @param {number} i
 * @param {number} j
 * @returns {[number, number]}
 */
function place({ vectors_m: [a, b], origin_m, listed }, i, j) {
  const own = listed?.[i];
  if (own !== undefined) return [own[0], own[1]];
  return [origin_m[0] + i * a[0] + j * b[0], origin_m[1] + i * a[1] + j * b[1]];
}

/**
 * Indices and centres of all pillars in a square with this half width, m, around the lens axis or another centre.
 * @param {Lattice} lattice
 * @param {number} half
 * @param {Point} [middle]
 * @returns {Generator<readonly [number, number, number, number]>}
 */
export function* pillarsWithin(lattice, half, [right, up] = [0, 0]) {
  for (const [k, [x, y]] of (lattice.listed ?? []).entries()) {
    if (Math.abs(x - right) <= half && Math.abs(y - up) <= half) yield [k, 0, x, y];
  }
  const [[a, b], [c, d]] = lattice.vectors_m;
  const [x0, y0] = lattice.origin_m;
  const area = a * d - b * c;
  if (area === 0) return;
  /** @type {Set<string>} */
  const missing = new Set();
  for (let k = 0; k + 1 < lattice.missing.length; k += 2) {
    missing.add(`${lattice.missing[k] ?? 0} ${lattice.missing[k + 1] ?? 0}`);
  }
  // The indices of the corners of the square bound those of all pillars in it.
  const corners = [-half, half].flatMap((x) => [-half, half].map((y) => /** @type {const} */ ([right + x - x0, up + y - y0])));
  const rows = corners.map(([x, y]) => (x * d - y * c) / area);
  const [low, high] = lattice.range ?? [-Infinity, Infinity];
  const first = Math.max(low, Math.ceil(Math.min(...rows)));
  const last = Math.min(high - 1, Math.floor(Math.max(...rows)));
  for (let i = first; i <= last; i += 1) {
    // A row enters and leaves the square where x or y reaches one of its sides.
    const [x, y] = place(lattice, i, 0);
    const [from, to] = within([x - right, c, half], within([y - up, d, half], [low, high - 1]));
    for (let j = Math.ceil(from); j <= Math.floor(to); j += 1) {
      if (missing.size > 0 && missing.has(`${i} ${j}`)) continue;
      yield [i, j, x + j * c, y + j * d];
    }
  }
}

/**
 * Radius of the top of a pillar with this first index, m.
 * @param {Scene} scene
 * @param {number | undefined} i
 * @returns {number}
 */
export function topRadius({ diameter_m, lattice }, i) {
  return (lattice.listed?.[i ?? -1]?.[2] ?? diameter_m) / 2;
}

/**
 * The part of a range of t with |start + t step| ≤ limit.
 * @param {readonly [number, number, number]} line
 * @param {readonly [number, number]} range
 * @returns {readonly [number, number]}
 */
function within([start, step, limit], [low, high]) {
  if (step === 0) return Math.abs(start) <= limit ? [low, high] : [1, 0];
  const ends = [(-limit - start) / step, (limit - start) / step];
  return [Math.max(low, Math.min(...ends)), Math.min(high, Math.max(...ends))];
}

/**
 * The largest force on a pillar, N.
 * @param {Scene} scene
 * @returns {number}
 */
export function largestForceOf(scene) {
  return scene.forces_N.reduce((largest, force) => Math.max(largest, force), 0);
}
