// Readouts: the critical state, the load that is shown, and how they were solved.

import { digitsFor, engineering, engineeringText, plain, radiusDigits, significant, write } from "./numbers.js";
import { byId } from "./screen.js";
import { stationShown } from "./diagrams.js";
import { floorAt, holesWords } from "./scene.js";
import {
  floorCarriesLoad,
  hasAdhesiveFloor,
  hasCritical,
  hasFlatTops,
  isFlat,
  isRounded,
  isBeyond,
  isBusy,
  isCalledOff,
  isCritical,
  isCriticalStation,
  isOlder,
  isWhole,
  stationAt,
  isCycle,
} from "./store.js";

/**
 * @import {
 *   CycleError, CycleStation, ExpectedCells, AdhesiveFloor, FloorSummary, FrictionSummary, Limit, Progress, SolvedCycle, StationState,
 *   TransitionSummary, Value,
 * } from "./engine.js"
 * @import { Dimension } from "./numbers.js"
 * @import { Estimate, Question, State } from "./store.js"
 */

/**
 * @typedef {object} Readout
 * @property {string} id
 * @property {number} value
 * @property {Dimension} dimension
 * @property {number} digits
 * @property {string} remark
 */

/**
 * Shows the critical state of the case, or its estimate until it is solved.
 * @param {State} state
 */
export function drawCritical(state) {
  const { estimate, critical, loadScale } = state;
  const none = byId("no-critical");
  byId("critical").hidden = loadScale !== null;
  none.hidden = loadScale === null;
  if (loadScale !== null) {
    const length = engineeringText(loadScale.is.indentation_m, "length", 3);
    write(none, `No critical state: ${loadScale.is.why}. Loads are relative to an indentation of ${length}.`);
  }
  byId("readouts").classList.toggle("estimated", estimate !== null);
  const readouts =
    estimate !== null ? estimated(estimate.is) : critical === null ? [] : solved(critical.is);
  for (const { id, value, dimension, digits, remark } of readouts) {
    const { number, unit } = engineering(value, dimension, digits);
    write(byId(`${id}-value`), estimate === null ? number : `≈ ${number}`);
    byId(`${id}-unit`).textContent = unit;
    write(byId(`${id}-remark`), remark);
  }
}

/**
 * The readouts of an estimate, to three digits.
 * @param {Estimate} estimate
 * @returns {readonly Readout[]}
 */
function estimated(estimate) {
  const [digits, remark] = [3, "estimate, being solved"];
  const { force_N: force, contact_radius_m: radius, indentation_m: indentation } = estimate;
  return [
    { id: "force", value: force, dimension: "force", digits, remark },
    { id: "radius", value: radius, dimension: "length", digits, remark },
    { id: "indentation", value: indentation, dimension: "length", digits, remark },
  ];
}

/**
 * @param {TransitionSummary} summary
 * @returns {readonly Readout[]}
 */
function solved(summary) {
  const error = summary.relative_error_estimate;
  const model = summary.method === "homogenised";
  /** @type {(value: number | null) => number} */
  const digits = (value) => (model ? 4 : digitsFor(value));
  /** @type {(value: number | null) => string} */
  const words = (value) => {
    if (model) return "model error";
    if (value === null) return "error not estimated";
    return value > 0 ? `error ${significant(value, 1)}` : "exact";
  };
  // The reduced variables are those of flat tops.
  const reduced = summary.normalized;
  /** @type {(text: (of: NonNullable<typeof reduced>) => string) => string} */
  const ofTops = (text) => (reduced === undefined ? "" : text(reduced));
  const ratio = ofTops((of) => `a/e = ${significant(of.contact_radius, radiusDigits(error.contact_radius))},  `);
  const tops = engineeringText(summary.top_contact_radius_m, "length", radiusDigits(error.top_contact_radius ?? null));
  return [
    {
      id: "force",
      value: summary.critical_force_N,
      dimension: "force",
      digits: digits(error.force),
      remark: `${ofTops((of) => `F γ_{int}/(h d) = ${significant(of.force, 4)},  `)}${words(error.force)}`,
    },
    {
      id: "radius",
      value: summary.critical_contact_radius_m,
      dimension: "length",
      digits: radiusDigits(error.contact_radius),
      remark: `${ratio}on the tops ${tops},  ${words(error.contact_radius)}`,
    },
    {
      id: "indentation",
      value: summary.critical_indentation_m,
      dimension: "length",
      digits: digits(error.indentation),
      remark: `${ofTops((of) => `ζ/h = ${significant(of.indentation, 4)},  `)}${words(error.indentation)}`,
    },
  ];
}

/**
 * Shows regime, pillars, status, warnings and limits of the model.
 * @param {State} state
 */
export function drawFacts(state) {
  const { critical } = state;
  if (critical !== null) {
    const regime = byId("regime");
    const { pillars_in_contact: all, pillars_partially_in_contact: part } = critical.is;
    const bottom = critical.is.regime === "bottom_first";
    regime.textContent = bottom
      ? "bottom first: the lens reaches the floor before any pillar"
      : "top first: the lens rests on pillar tops before it reaches the floor";
    regime.classList.toggle("beyond", bottom);
    byId("pillars").textContent =
      `${all} ${all === 1 ? "pillar" : "pillars"} in contact, ${part} partially`;
  }
  if (state.loadScale !== null) {
    const pillars = state.solved?.is.summary.pillars_in_contact;
    byId("regime").textContent = "";
    byId("pillars").textContent = pillars === undefined ? "" : `${pillars} ${pillars === 1 ? "pillar" : "pillars"} in contact`;
  }
  byId("status").textContent = statusWords(state);
  const warnings = byId("warnings");
  const answer = answerOf(state);
  warnings.textContent = answer?.warnings.join("; ") ?? "";
  warnings.hidden = warnings.textContent === "";
  drawLimits(state.solved?.is.summary.limits ?? [], isPaper(state));
}

/**
 * Names of the limits of the model.
 * @type {Readonly<Record<string, string>>}
 */
const LIMITS = {
  slope: "slope of the lens",
  contact_on_top: "contact radius over radius of curvature of a top",
  contact_radius_over_lens_radius: "contact radius over lens radius",
  contact_radius_over_lens_thickness: "contact radius over thickness of the lens",
  lens_thickness_over_radius: "thickness of the lens over its radius",
  indentation_over_thickness: "indentation over the smallest thickness",
  thickness_over_diameter: "smallest thickness over pillar diameter",
  pillar_stress: "stress of a pillar over its modulus",
  buckling: "force on a pillar over its buckling load",
  pillar_compliance: "error of the column model",
  kendall_strain: "strain of pillars at pull-off",
};

/** Why the first case of the page exceeds a limit. */
const WHY =
  ": this is the intermediate case of the paper, in which the pillars at the centre are compressed by 30 %, where the " +
  "small strains of the column model end";

/**
 * Whether the case that is shown is the intermediate case of the paper, and nothing else.
 * @param {State} state
 * @returns {boolean}
 */
function isPaper({ start, solved }) {
  const shown = solved?.of.case;
  if (shown === undefined) return false;
  const isUnset = /** @type {(value: Value | undefined) => boolean} */ ((value) => value === undefined || value === "");
  const others = start.keys.filter(({ key }) => start.paper[key] === undefined);
  return (
    Object.entries(start.paper).every(([key, value]) => shown[key] === value) &&
    others.every(({ key, default: usual }) => isUnset(shown[key]) || shown[key] === usual)
  );
}

/**
 * Shows the closest limit of the model, or the limits that are exceeded.
 * @param {readonly Limit[]} limits
 * @param {boolean} explains Whether the limit of the paper's case is explained.
 */
function drawLimits(limits, explains) {
  const line = byId("limits");
  const known = limits.flatMap(({ name, value, threshold, strained }) => {
    const words = LIMITS[name];
    if (words === undefined || threshold === null) return [];
    // Some values must be below their limits, others above.
    const isAbove = value > threshold;
    const part = isAbove === strained ? value / threshold : threshold / value;
    // Three digits: with two, 0.303 beyond 0.3 would be written as 0.30.
    const size = significant(value, 3);
    const beyond = isAbove ? `${size} > ${plain(threshold)}` : `${size} < ${plain(threshold)}`;
    const sentence = strained ? beyond : `${size}, limit ${plain(threshold)}`;
    return [{ words: `${words} ${sentence}`, part, strained }];
  });
  const strained = known.filter((limit) => limit.strained);
  const [nearest] = [...known].sort((one, other) => other.part - one.part);
  line.classList.toggle("strained", strained.length > 0);
  line.hidden = nearest === undefined;
  const words = strained.map((limit) => limit.words).join("; ");
  line.textContent =
    strained.length > 0
      ? `limit exceeded: ${words}${explains ? WHY : ""}`
      : `within the limits of the model; closest: ${nearest?.words ?? ""}`;
}

/**
 * How the contact or the cycle that is shown was solved; null while there is none.
 * @param {State} state
 * @returns {Answer | null}
 */
function answerOf({ solved, cycle }) {
  if (solved !== null) return { of: solved.of, ...solved.is.summary, warnings: solved.is.warnings };
  const summary = cycle?.is.solved?.summary;
  return cycle === null || summary === undefined ? null : { of: cycle.of, ...summary };
}

/**
 * @typedef {object} Answer
 * @property {Question} of
 * @property {string} method
 * @property {number} wall_time_s
 * @property {readonly string[]} warnings
 */

/**
 * @param {State} state
 * @returns {string}
 */
function statusWords(state) {
  const { progress, refusal } = state;
  const answer = answerOf(state);
  if (progress !== null) {
    const { stage, step, touched } = progress.is;
    return `${stage}, step ${step}, ${touched} pillars touched …`;
  }
  if (isCalledOff(state)) return "cancelled";
  if (refusal !== null && !isOlder(state, refusal, "load")) return "no result";
  if (answer === null) return "starting …";
  if (isOlder(state, { of: answer.of, is: answer }, "load")) return "solving …";
  const { method, wall_time_s } = answer;
  return `${method}, solved in ${seconds(wall_time_s)}`;
}

/**
 * @param {number} time
 * @returns {string}
 */
function seconds(time) {
  return time < 1 ? `${significant(1e3 * time, 2)} ms` : `${significant(time, 3)} s`;
}

/** Progress is shown for cycles that take longer than this, ms. */
const SHORT = 400;

/**
 * Shows the progress of the cycle that is being solved or that it was cancelled, and a note on the cells of the
 * floor.
 * @param {State} state
 */
export function drawCycleProgress(state) {
  const { asking, cycle, elapsed, expected, progress, question } = state;
  const under = asking.contact?.question;
  const isUnder = under !== undefined && isCycle(under.case) && elapsed > SHORT;
  const calledOff = isCalledOff(state) && under === undefined;
  byId("cycle-progress").hidden = !isUnder && !calledOff;
  byId("cycle-share").hidden = byId("call-off").hidden = !isUnder;
  byId("request-again").hidden = !calledOff;
  const way = isUnder && progress?.of.number === under.number ? progress.is.way : undefined;
  const share = byId("cycle-share", HTMLProgressElement);
  if (way === undefined) share.removeAttribute("value");
  else share.value = way.share;
  byId("cycle-stage").textContent = calledOff
    ? "cancelled"
    : isUnder
      ? `${stageWords(progress?.is ?? null)}, ${significant(elapsed / 1e3, elapsed < 1e4 ? 2 : 3)} s`
      : "";
  const isSolved = cycle?.of.number === question.number && cycle.is.solved !== null;
  const cells = expected?.of.number === question.number && !isSolved ? cellsWords(expected.is) : "";
  byId("cells-note").textContent = cells;
  byId("cells-note").hidden = cells === "";
}

/**
 * The stage of the computation of a cycle, and the position of the lens.
 * @param {Progress | null} progress
 * @returns {string}
 */
function stageWords(progress) {
  if (progress === null || progress.way === undefined) return "critical state";
  const { stage, step, way } = progress;
  const percent = `about ${Math.round(100 * way.share)} %`;
  if (stage === "error estimate") return `error estimate, ${percent}`;
  const at = engineeringText(way.indentation_m, "length", 3);
  const fronts = stage === "fronts on the floor" ? `, ${stage}, round ${step}` : "";
  return `${way.loading ? "loading" : "unloading"}, ζ = ${at}${fronts}, ${percent}`;
}

/**
 * A note on the cells of an adhesive floor before they are solved; empty if they are quick and fine.
 * @param {ExpectedCells} expectedCells
 * @returns {string}
 */
function cellsWords({ cells, across_ring, many, coarse }) {
  const rounded = Number(cells.toPrecision(2)).toLocaleString("en").replaceAll(",", "\u202f");
  const time = many ? `The floor has about ${rounded} cells, which can take minutes. ` : "";
  const rings = `Only about ${significant(across_ring, 2)} cells across the free ring around a pillar`;
  return time + (coarse ? `${rings}: results for the floor are orders of magnitude, and it detaches too late.` : "");
}

/**
 * Shows the load: text and slider follow the choice, numbers are those of the solved state.
 * @param {State} state
 */
export function drawLoad(state) {
  const adhesive = isCycle(state.chosen.case);
  const floorIsAdhesive = hasAdhesiveFloor(state.chosen.case);
  byId("to-pull-off").hidden = !adhesive;
  byId("to-jump").hidden = !floorIsAdhesive;
  byId("cycle-numbers").hidden = !adhesive || state.cycle === null || state.cycle.is.solved === null;
  const critical = hasCritical(state.chosen.case);
  byId("load-end").textContent = adhesive ? "last release" : critical ? "beyond" : `× ${state.start.farthest_load}`;
  byId("load-at").textContent = critical ? "critical" : "× 1";
  byId("to-critical").hidden = !critical;
  byId("force-words").textContent = isFlat(state.chosen.case) ? "force" : "force on a pillar";
  byId("partial-key").hidden = isRounded(state.chosen.case) || isFlat(state.chosen.case);
  byId("main").classList.toggle("few", !hasFlatTops(state.chosen.case));
  byId("touch-key").classList.toggle("absent", !critical);
  for (const id of ["diagram", "curves"]) byId(id).hidden = !hasFlatTops(state.chosen.case);
  for (const id of ["load-track", "loading-legend", "export-menu"]) byId(id).classList.toggle("cycle", adhesive);
  for (const id of ["loading-legend", "cycle-numbers"]) byId(id).classList.toggle("with-adhesive-floor", floorIsAdhesive);
  if (adhesive) {
    drawCycleLoad(state);
    return;
  }
  byId("load", HTMLInputElement).disabled = false;
  const { load } = state.chosen;
  const words = loadWords(load, critical);
  const beyond = isBeyond(load) && critical;
  byId("load-words").textContent = words;
  const carries = floorCarriesLoad(state.chosen.case);
  byId("load-words").classList.toggle("beyond", beyond && !carries);
  byId("beyond-note").hidden = !beyond || carries;
  byId("beyond-why").textContent = isRounded(state.chosen.case)
    ? "Under adhesive rounded tops it is not computed; without adhesion it is."
    : "The spectral method with floor contact computes the floor force.";
  for (const part of [byId("load").parentElement, byId("loading-legend")]) {
    part?.classList.toggle("through-floor", !carries && critical);
  }
  byId("loading-legend").classList.toggle("no-critical", !critical);
  setSlider(0.002, state.start.farthest_load, 1, load, words);
  if (state.solved === null) return;
  const { summary } = state.solved.is;
  const error = summary.relative_error_estimate;
  /** @type {(value: number | null) => number} */
  const digits = (value) => Math.min(4, digitsFor(value));
  const force = engineeringText(summary.force_N, "force", digits(error.force));
  const indentation = engineeringText(summary.indentation_m, "length", digits(error.indentation));
  const { contact_radius_m: reached, top_contact_radius_m: tops = reached } = summary;
  const whole = isCritical(state.solved.is.fraction ?? 0) && critical ? criticalRadius(state, reached) : reached;
  const radius = radiusWords(whole, tops, digits(error.contact_radius));
  write(byId("load-numbers"), `F = ${force},  ζ = ${indentation},  ${radius}${lateralWords(summary.friction)}`);
  write(byId("floor-gap"), engineeringText(summary.smallest_floor_gap_m ?? NaN, "length", digits(error.indentation)));
  drawFloor(summary.floor ?? null);
}

/**
 * The lateral force of a sliding contact, with the part of the floor; empty without shear stresses.
 * @param {FrictionSummary | undefined} friction
 * @returns {string}
 */
function lateralWords(friction) {
  if (friction === undefined || friction.lateral_force_N === null) return "";
  const digits = Math.min(4, digitsFor(friction.relative_error_estimate.lateral_force));
  const share = friction.floor_share ?? 0;
  const floor = share > 0 ? ` (${significant(100 * share, 2)} % on the floor)` : "";
  return `,  lateral force ${engineeringText(friction.lateral_force_N, "force", digits)}${floor}`;
}

/**
 * The contact radius of the critical state, including the point where the lens reaches the floor; that on the tops
 * until it is known.
 * @param {State} state
 * @param {number} tops
 * @returns {number}
 */
function criticalRadius({ critical, question }, tops) {
  const isKnown = critical !== null && critical.of.name === question.name;
  return isKnown ? Math.max(tops, critical.is.critical_contact_radius_m) : tops;
}

/**
 * The contact radius, and that on the pillar tops if floor contact extends farther.
 * @param {number} whole
 * @param {number} tops
 * @param {number} digits
 * @returns {string}
 */
function radiusWords(whole, tops, digits) {
  const [all, part] = [whole, tops].map((radius) => engineeringText(radius, "length", digits));
  return `a = ${all}${whole > tops ? `,  on the tops ${part}` : ""}`;
}

/**
 * Sets the load slider: step, end, position of the critical state, value and its text.
 * @param {number} step
 * @param {number} end
 * @param {number} critical
 * @param {number} value
 * @param {string} words
 */
function setSlider(step, end, critical, value, words) {
  const slider = byId("load", HTMLInputElement);
  slider.step = String(step);
  slider.max = String(end);
  slider.value = String(value);
  slider.setAttribute("aria-valuetext", words);
  byId("load-track").style.setProperty("--farthest", String(end / critical));
}

/** Indentations below this, m, are shown as 0: 1e-6 of the smallest pillars. */
const NO_LENGTH = 1e-13;

/**
 * Shows the load of a cycle: the slider has a step for each state.
 * @param {State} state
 */
function drawCycleLoad(state) {
  const { cycle, chosen } = state;
  byId("beyond-note").hidden = true;
  byId("floor-numbers").hidden = true;
  byId("load-words").classList.remove("beyond");
  byId("load-track").classList.remove("through-floor");
  const states = cycle?.is.states ?? [];
  const shown = stationAt(cycle, chosen.load);
  const station = stationShown(state);
  const solved = cycle?.is.solved ?? null;
  const summary = solved?.summary;
  const words =
    shown === null || station === null || solved === null
      ? isCalledOff(state)
        ? "cancelled"
        : state.refusal === null
          ? "being solved"
          : "no result"
      : wayWords(shown, station, solved);
  write(byId("load-words"), words);
  const slider = byId("load", HTMLInputElement);
  slider.disabled = !isWhole(cycle);
  byId("to-jump", HTMLButtonElement).disabled = slider.disabled || (summary?.floor?.jump ?? null) === null;
  byId("to-pull-off", HTMLButtonElement).disabled =
    slider.disabled || (summary?.pull_off_force_N ?? null) === null;
  const spoken = words.replace(/[_^]\{(.*?)\}/g, "$1");
  const turn = states.findIndex(({ load }) => load === 1);
  if (slider.disabled || shown === null || turn < 1) setSlider(0.01, 2, 1, chosen.load, spoken);
  else setSlider(1, states.length - 1, turn, states.indexOf(shown), spoken);
  if (shown === null || station === null || solved === null) {
    drawCriticalBefore(state);
    return;
  }
  const { indentation_m, force_N, contact_radius_m } = station;
  const pulled = shown.pillar_forces_N.filter((force) => force < 0).length;
  // The first contact is found slightly beyond zero.
  const zeta = engineeringText(Math.abs(indentation_m) < NO_LENGTH ? 0 : indentation_m, "length", 4);
  const whole = isCriticalStation(solved, shown) ? criticalRadius(state, contact_radius_m) : contact_radius_m;
  const radius = radiusWords(whole, contact_radius_m, 4);
  const force = engineeringText(force_N, "force", 4);
  const all = shown.pillar_forces_N.length;
  const part = shown.parts.length;
  const contact = all === 0 ? "no contact" : `${all} in contact, ${part} partially, ${pulled} in tension`;
  const floor = floorAt(solved, shown);
  const onFloor =
    floor === null
      ? ""
      : `\nfloor: ${holesWords(floor.filled_holes)} filled, ${areaText(floor.floor_contact_area_m2, 3)}, ` +
        engineeringText(floor.floor_force_N, "force", 2);
  write(byId("load-numbers"), `F = ${force},  ζ = ${zeta},  ${radius}\n${contact}${onFloor}`);
}

/**
 * Shows the critical state while the rest of the cycle is being solved.
 * @param {State} state
 */
function drawCriticalBefore(state) {
  const { solved, question } = state;
  if (solved === null || solved.of.number !== question.number) return;
  const { force_N, indentation_m, contact_radius_m, pillars_in_contact } = solved.is.summary;
  const zeta = engineeringText(indentation_m, "length", 4);
  const radius = radiusWords(criticalRadius(state, contact_radius_m), contact_radius_m, 4);
  const force = engineeringText(force_N, "force", 4);
  write(byId("load-words"), `critical state, the rest ${isCalledOff(state) ? "cancelled" : "is being solved"}`);
  write(byId("load-numbers"), `F = ${force},  ζ = ${zeta},  ${radius}\n${pillars_in_contact} in contact`);
}

/**
 * @param {number | null} area_m2
 * @param {number} digits
 * @returns {string}
 */
function areaText(area_m2, digits) {
  return area_m2 === null ? "an unresolved area" : `${significant(1e12 * area_m2, digits)} µm^{2}`;
}

/**
 * The position of the lens in the cycle.
 * @param {StationState} state
 * @param {CycleStation} station
 * @param {SolvedCycle} cycle
 * @returns {string}
 */
function wayWords(state, station, cycle) {
  const { load } = state;
  const { summary } = cycle;
  if (isCriticalStation(cycle, state)) return "critical state";
  if (load === 1) return "after the jump onto the floor";
  if (load === 0) return "first contact";
  if (station.pillars_in_contact === 0) return "last release";
  if (station.force_N === summary.pull_off_force_N) return "unloading, pull-off";
  const { first_contact_indentation_m: first, last_release_indentation_m: last } = summary;
  const turn = summary.turn_indentation_m;
  const down = station.branch === "loading";
  const [from, to] = down ? [first ?? 0, turn] : [turn, last ?? 0];
  const part = significant((100 * (station.indentation_m - from)) / (to - from), 2);
  return `${station.branch}, ${part} % of the way to the ${down ? "critical state" : "last release"}`;
}

/**
 * Shows the results of a cycle.
 * @param {State} state
 */
export function drawCycleNumbers(state) {
  const cycle = state.cycle?.is.solved;
  if (cycle === undefined || cycle === null) return;
  const { summary } = cycle;
  const errors = summary.relative_error_estimate;
  /** @type {(value: number | null, dimension: Dimension, error: CycleError | null) => string} */
  const number = (value, dimension, error) =>
    value === null ? "–" : engineeringText(value, dimension, Math.min(5, digitsFor(error?.numerical ?? null)));
  const pull = summary.pull_off_force_N;
  const pillars = summary.pull_off_pillars_in_contact ?? 0;
  /** @type {Record<string, string>} */
  const texts = {
    "pull-off-force": pull === null ? "no tension" : number(pull, "force", errors.pull_off_force),
    "pull-off-error": pull === null ? "" : errorWords(errors.pull_off_force),
    "pull-off-pillars":
      pull === null
        ? ""
        : `${pillars} ${pillars === 1 ? "pillar" : "pillars"}, ` +
          `ζ = ${engineeringText(summary.pull_off_indentation_m ?? 0, "length", 3)}`,
    "adhesive-critical": number(summary.critical_force_N, "force", errors.critical_force),
    "plain-critical": `${engineeringText(cycle.critical_force_without_adhesion_N, "force", 5)} without adhesion`,
    "last-release":
      summary.last_release_indentation_m === null
        ? "–"
        : engineeringText(summary.last_release_indentation_m, "length", 3),
    "separation-work": number(summary.work_of_separation_J, "energy", errors.hysteresis),
    "loop-area": number(summary.hysteresis_J, "energy", errors.hysteresis),
    "loop-error": errorWords(errors.hysteresis),
  };
  for (const [id, text] of Object.entries(texts)) write(byId(id), text);
  for (const limit of summary.limits) drawLimit(limit);
  const floor = summary.floor ?? null;
  byId("adhesive-floor").hidden = floor === null;
  byId("adhesive-floor").classList.toggle("strained", floor?.coarse ?? false);
  if (floor !== null) write(byId("adhesive-floor"), adhesiveFloorWords(floor));
}

/**
 * Describes the jump onto an adhesive floor and its detachment, with estimated errors.
 * @param {AdhesiveFloor} floor
 * @returns {string}
 */
function adhesiveFloorWords(floor) {
  const { jump, last, force_before_jump_N: before, relative_error_estimate: errors } = floor;
  const { indentation_after_loss_m: after, force_after_loss_N: lighter } = floor;
  /** @type {string[]} */
  const words = [];
  // Coarse cells have no error estimate.
  /** @type {(error: number) => number} */
  const digits = (error) => (error < 0.1 ? 3 : 2);
  /** @type {(error: number) => string} */
  const about = (error) => (error < 1 ? ` (error ${significant(error, 1)})` : "");
  /** @type {(value: number | null, error: number) => string} */
  const force = (value, error) =>
    value === null ? "–" : engineeringText(value, "force", digits(error));
  if (jump !== null) {
    const area = areaText(jump.floor_contact_area_m2, digits(errors.jump_contact_area));
    words.push(
      `Jump onto the floor at ζ = ${engineeringText(jump.indentation_m, "length", 3)}: ` +
        `${holesWords(jump.filled_holes)} filled, ${area} in contact${about(errors.jump_contact_area)}, ` +
        `force from ${force(before, 0)} to ${force(jump.force_N, errors.jump_force)}${about(errors.jump_force)}.`,
    );
  }
  if (last !== null && after !== null) {
    const error = errors.lost_indentation;
    const [from, to] = [last.indentation_m, after].map((zeta) => engineeringText(zeta, "length", 3));
    words.push(
      `Floor detaches between ζ = ${from} and ${to}${about(error)}, ` +
        `force from ${force(last.force_N, error)} to ${force(lighter, error)}.`,
    );
  } else {
    words.push("The floor does not detach.");
  }
  if (floor.coarse) {
    const across = significant(floor.cells_across_ring, 2);
    words.push(`Only ${across} cells across the free ring around a pillar: these are orders of magnitude.`);
  } else if (Math.max(errors.jump_force, errors.jump_contact_area, errors.lost_indentation) >= 1) {
    words.push("Values without an error are orders of magnitude.");
  }
  return words.join(" ");
}

/**
 * The numerical error and the model error.
 * @param {CycleError | null} error
 * @returns {string}
 */
function errorWords(error) {
  if (error === null) return "";
  const numerical = `error ${significant(error.numerical, 1)}`;
  const model = error.model_fronts + error.model_columns + error.model_corners;
  return model > 0 ? `${numerical}, model error ${significant(model, 1)}` : numerical;
}

/**
 * Shows a limit of the model, marked if it is exceeded.
 * @param {Limit} limit
 */
function drawLimit({ name, value, threshold, strained }) {
  const shown = document.getElementById(`limit-${name}`);
  if (shown === null || threshold === null) return;
  write(shown, `${significant(value, 2)} ${strained ? ">" : "<"} ${plain(threshold)}`);
  shown.parentElement?.classList.toggle("strained", strained);
}

/**
 * Shows force and contact on the floor, rounded to the estimated errors.
 * @param {FloorSummary | null} floor
 */
function drawFloor(floor) {
  byId("floor-numbers").hidden = floor === null;
  if (floor === null) return;
  const { share, contact_area } = floor.relative_error_estimate;
  /** @type {(error: number | null) => number} */
  const known = (error) =>
    error !== null && error > 0.1 ? 1 : Math.min(4, digitsFor(error));
  /** @type {(error: number | null) => string} */
  const about = (error) =>
    error === null ? "" : `error ${significant(error, 1)}`;
  const area = significant(1e12 * floor.contact_area_m2, known(contact_area));
  const texts = {
    "floor-force": engineeringText(floor.force_N, "force", known(share)),
    "floor-force-error": about(share),
    "floor-share": `${significant(100 * floor.share, known(share))} %`,
    "floor-area": `${area} µm^{2}`,
    "floor-area-error": about(contact_area),
    // Two grids give different numbers if bridges between patches are narrow.
    "floor-patches": floor.patches === null ? "not resolved" : String(floor.patches),
    "floor-rim": engineeringText(floor.smallest_distance_to_rim_m, "length", 3),
  };
  for (const [id, text] of Object.entries(texts)) write(byId(id), text);
}

/**
 * @param {number} fraction
 * @param {boolean} hasCritical Whether loads are relative to a critical state.
 * @returns {string}
 */
function loadWords(fraction, hasCritical) {
  if (fraction === 0) return "first contact";
  const percent = `${significant(100 * fraction, 3)} %`;
  if (!hasCritical) return `${percent} of the reference indentation`;
  if (isCritical(fraction)) return "critical state";
  return fraction < 1
    ? `${percent} of the way to the critical state`
    : `${percent}, beyond the transition`;
}

/**
 * The text for screen readers once the result is complete; null before.
 * @param {State} state
 * @returns {string | null}
 */
export function announcement(state) {
  const { critical, loadScale, solved, refusal, question } = state;
  if (refusal !== null || isBusy(state)) return null;
  if (loadScale?.of.name === question.name && solved !== null) {
    const force = engineeringText(solved.is.summary.force_N, "force", 4);
    const indentation = engineeringText(solved.is.summary.indentation_m, "length", 4);
    return `No critical state. Force ${force}, indentation ${indentation}. Load shown: ${loadWords(state.chosen.load, false)}.`;
  }
  if (critical === null || critical.of.name !== question.name) return null;
  const summary = critical.is;
  const force = engineeringText(summary.critical_force_N, "force", 4);
  const digits = radiusDigits(summary.relative_error_estimate.contact_radius);
  const radius = engineeringText(summary.critical_contact_radius_m, "length", Math.min(4, digits));
  const indentation = engineeringText(summary.critical_indentation_m, "length", 4);
  const station = stationShown(state);
  const cycle = state.cycle?.is.solved ?? null;
  const shown = stationAt(state.cycle, state.chosen.load);
  if (station !== null && cycle !== null && shown !== null) {
    const pull = cycle.summary.pull_off_force_N;
    return (
      `Critical force ${force}, contact radius ${radius}, indentation ${indentation}. ` +
      (pull === null ? "No tension. " : `Pull-off force ${engineeringText(pull, "force", 2)}. `) +
      `Load shown: ${wayWords(shown, station, cycle)}.`
    );
  }
  if (solved === null) return null;
  return (
    `Critical force ${force}, contact radius ${radius}, indentation ${indentation}. ` +
    `Load shown: ${loadWords(solved.is.fraction ?? 1, true)}.` +
    (!solved.is.summary.floor
      ? ""
      : ` The floor carries ${significant(100 * solved.is.summary.floor.share, 2)} % of the force.`)
  );
}
