// The numbers: the critical state of the case, and the load that is shown.

import type {
  CycleError,
  CycleSummary,
  ExpectedCells,
  FloorSummary,
  Limit,
  Progress,
  SolvedCycle,
  StationState,
  StuckFloor,
  TransitionSummary,
} from "./engine.js";
import {
  digitsFor,
  engineering,
  engineeringText,
  plain,
  radiusDigits,
  significant,
  write,
  type Dimension,
} from "./numbers.js";
import { byId } from "./screen.js";
import { stationShown } from "./diagrams.js";
import { floorAt, holesWords } from "./scene.js";
import {
  floorBears,
  floorSticks,
  isBeyond,
  isBusy,
  isCalledOff,
  isCritical,
  isCriticalStation,
  isOlder,
  isWhole,
  stationAt,
  sticks,
  type Estimate,
  type State,
} from "./store.js";

interface Readout {
  readonly id: string;
  readonly value: number;
  readonly dimension: Dimension;
  readonly digits: number;
  readonly remark: string;
}

/** The critical state of the case, or its estimate until it is solved for. */
export function drawCritical(state: State): void {
  const { estimate, critical } = state;
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

/** The readouts of an estimate, in the digits that it is good for. */
function estimated(estimate: Estimate): readonly Readout[] {
  const [digits, remark] = [3, "estimate, being solved"];
  const { force_N: force, contact_radius_m: radius, indentation_m: indentation } = estimate;
  return [
    { id: "force", value: force, dimension: "force", digits, remark },
    { id: "radius", value: radius, dimension: "length", digits, remark },
    { id: "indentation", value: indentation, dimension: "length", digits, remark },
  ];
}

function solved(summary: TransitionSummary): readonly Readout[] {
  const error = summary.relative_error_estimate;
  const model = summary.method === "homogenised";
  const digits = (value: number | null): number => (model ? 4 : digitsFor(value));
  const words = (value: number | null): string => {
    if (model) return "error of the model";
    if (value === null) return "error not estimated";
    return value > 0 ? `error ${significant(value, 1)}` : "exact";
  };
  const reduced = summary.normalized;
  const ratio = significant(reduced.contact_radius, radiusDigits(error.contact_radius));
  const tops = engineeringText(summary.top_contact_radius_m, "length", radiusDigits(error.top_contact_radius ?? null));
  return [
    {
      id: "force",
      value: summary.critical_force_N,
      dimension: "force",
      digits: digits(error.force),
      remark: `F γ_{int}/(h d) = ${significant(reduced.force, 4)},  ${words(error.force)}`,
    },
    {
      id: "radius",
      value: summary.critical_contact_radius_m,
      dimension: "length",
      digits: radiusDigits(error.contact_radius),
      remark: `a/e = ${ratio},  on the tops ${tops},  ${words(error.contact_radius)}`,
    },
    {
      id: "indentation",
      value: summary.critical_indentation_m,
      dimension: "length",
      digits: digits(error.indentation),
      remark: `ζ/h = ${significant(reduced.indentation, 4)},  ${words(error.indentation)}`,
    },
  ];
}

/** What else is known of the critical state, and of how it was solved for. */
export function drawFacts(state: State): void {
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
      `${all} ${all === 1 ? "pillar" : "pillars"} in contact, ${part} in part`;
  }
  byId("status").textContent = statusWords(state);
  const warnings = byId("warnings");
  const answer = answerOf(state);
  warnings.textContent = answer?.warnings.join("; ") ?? "";
  warnings.hidden = warnings.textContent === "";
  drawLimits(state.solved?.is.summary.limits ?? []);
}

/** What the limits of the model are called. */
const LIMITS: Readonly<Record<string, string>> = {
  slope: "slope of the lens",
  contact_radius_over_lens_radius: "contact radius over lens radius",
  contact_radius_over_lens_thickness: "contact radius over thickness of the lens",
  lens_thickness_over_radius: "thickness of the lens over its radius",
  indentation_over_thickness: "indentation over the smallest thickness",
  thickness_over_diameter: "smallest thickness over pillar diameter",
  pillar_stress: "stress of a pillar over its modulus",
  buckling: "force on a pillar over its buckling load",
  pillar_compliance: "compliance of pillars beside elastic ones",
  kendall_strain: "strain of pillars at pull-off",
};

/** A quiet line about where the model holds, marked where it does not. */
function drawLimits(limits: readonly Limit[]): void {
  const line = byId("limits");
  const known = limits.flatMap(({ name, value, threshold, strained }) => {
    const words = LIMITS[name];
    if (words === undefined || threshold === null) return [];
    // Some values are to be small, and some large.
    const isAbove = value > threshold;
    const part = isAbove === strained ? value / threshold : threshold / value;
    return [{ words: `${words} ${significant(value, 2)} of ${plain(threshold)}`, part, strained }];
  });
  const strained = known.filter((limit) => limit.strained);
  const [nearest] = [...known].sort((one, other) => other.part - one.part);
  line.classList.toggle("strained", strained.length > 0);
  line.hidden = nearest === undefined;
  const told = strained.map((limit) => limit.words).join("; ");
  line.textContent =
    strained.length > 0 ? `model strained: ${told}` : `limits of the model kept, the nearest: ${nearest?.words ?? ""}`;
}

/** How the contact or the cycle that is shown was solved; null while there is none. */
function answerOf({ solved, cycle }: State): Answer | null {
  if (solved !== null) return { of: solved.of, ...solved.is.summary, warnings: solved.is.warnings };
  const summary = cycle?.is.solved?.summary;
  return cycle === null || summary === undefined ? null : { of: cycle.of, ...summary };
}

interface Answer {
  readonly of: State["question"];
  readonly method: string;
  readonly wall_time_s: number;
  readonly warnings: readonly string[];
}

function statusWords(state: State): string {
  const { progress, refusal } = state;
  const answer = answerOf(state);
  if (progress !== null) {
    const { stage, step, touched } = progress.is;
    return `${stage}, step ${step}, ${touched} pillars touched …`;
  }
  if (isCalledOff(state)) return "called off";
  if (refusal !== null && !isOlder(state, refusal, "load")) return "no result";
  if (answer === null) return "starting …";
  if (isOlder(state, { of: answer.of, is: answer }, "load")) return "solving …";
  const { method, wall_time_s } = answer;
  return `${method}, solved in ${seconds(wall_time_s)}`;
}

function seconds(time: number): string {
  return time < 1 ? `${significant(1e3 * time, 2)} ms` : `${significant(time, 3)} s`;
}

/** Cycles that take less than this, ms, are solved without a word about how far they are. */
const SHORT = 400;

/** How far the cycle that is being solved has come, or that it was called off; and before that whether it takes long. */
export function drawCycleProgress(state: State): void {
  const { asking, cycle, elapsed, expected, progress, question } = state;
  const under = asking.contact?.question;
  const isUnder = under !== undefined && sticks(under.case) && elapsed > SHORT;
  const calledOff = isCalledOff(state) && under === undefined;
  byId("cycle-progress").hidden = !isUnder && !calledOff;
  byId("cycle-share").hidden = byId("call-off").hidden = !isUnder;
  byId("ask-again").hidden = !calledOff;
  const way = isUnder && progress?.of.number === under.number ? progress.is.way : undefined;
  const share = byId<HTMLProgressElement>("cycle-share");
  if (way === undefined) share.removeAttribute("value");
  else share.value = way.share;
  byId("cycle-stage").textContent = calledOff
    ? "called off"
    : isUnder
      ? `${stageWords(progress?.is ?? null)}, ${significant(elapsed / 1e3, elapsed < 1e4 ? 2 : 3)} s`
      : "";
  const isTold = expected?.of.number === question.number && !(cycle?.of.number === question.number && cycle.is.solved !== null);
  const cells = isTold ? cellsWords(expected.is) : "";
  byId("cells-note").textContent = cells;
  byId("cells-note").hidden = cells === "";
}

/** What is being solved of a cycle, and where the lens is. */
function stageWords(progress: Progress | null): string {
  if (progress === null || progress.way === undefined) return "critical state";
  const { stage, step, way } = progress;
  const percent = `about ${Math.round(100 * way.share)} %`;
  if (stage === "error estimate") return `error estimate, ${percent}`;
  const at = engineeringText(way.indentation_m, "length", 3);
  const fronts = stage === "fronts on the floor" ? `, ${stage}, round ${step}` : "";
  return `${way.loading ? "loading" : "unloading"}, ζ = ${at}${fronts}, ${percent}`;
}

/** What is said of the cells of a floor that sticks before they are solved for; nothing of those that are quick and fine. */
function cellsWords({ cells, across_ring, many, coarse }: ExpectedCells): string {
  const rounded = Number(cells.toPrecision(2)).toLocaleString("en").replaceAll(",", "\u202f");
  const time = many ? `The floor is laid out in about ${rounded} cells, which can take minutes. ` : "";
  const rings = `Only about ${significant(across_ring, 2)} cells are across the free ring round a pillar`;
  return time + (coarse ? `${rings}: what the floor does will be an order of magnitude, and it sticks too long.` : "");
}

/** The load: words and slider follow what is chosen, the numbers are those of the state solved for. */
export function drawLoad(state: State): void {
  const sticky = sticks(state.chosen.case);
  const stuck = floorSticks(state.chosen.case);
  byId("to-pull-off").hidden = !sticky;
  byId("to-jump").hidden = !stuck;
  byId("cycle-numbers").hidden = !sticky || state.cycle === null || state.cycle.is.solved === null;
  byId("load-end").textContent = sticky ? "last release" : "beyond";
  for (const id of ["load-track", "loading-legend", "export-menu"]) byId(id).classList.toggle("cycle", sticky);
  for (const id of ["loading-legend", "cycle-numbers"]) byId(id).classList.toggle("stuck", stuck);
  if (sticky) {
    drawCycleLoad(state);
    return;
  }
  byId<HTMLInputElement>("load").disabled = false;
  const { load } = state.chosen;
  const words = loadWords(load);
  const beyond = isBeyond(load);
  byId("load-words").textContent = words;
  const bears = floorBears(state.chosen.case);
  byId("load-words").classList.toggle("beyond", beyond && !bears);
  byId("beyond-note").hidden = !beyond || bears;
  for (const part of [byId("load").parentElement, byId("loading-legend")]) {
    part?.classList.toggle("through-floor", !bears);
  }
  setSlider(0.002, state.start.farthest_load, 1, load, words);
  if (state.solved === null) return;
  const { summary } = state.solved.is;
  const error = summary.relative_error_estimate;
  const digits = (value: number | null): number => Math.min(4, digitsFor(value));
  const force = engineeringText(summary.force_N, "force", digits(error.force));
  const indentation = engineeringText(summary.indentation_m, "length", digits(error.indentation));
  const { contact_radius_m: reached, top_contact_radius_m: tops = reached } = summary;
  const whole = isCritical(state.solved.is.fraction) ? criticalRadius(state, reached) : reached;
  const radius = radiusWords(whole, tops, digits(error.contact_radius));
  write(byId("load-numbers"), `F = ${force},  ζ = ${indentation},  ${radius}`);
  write(byId("floor-gap"), engineeringText(summary.smallest_floor_gap_m, "length", digits(error.indentation)));
  drawFloor(summary.floor);
}

/** The radius of the critical state, with the place where the lens reaches the floor; that on the tops until it is known. */
function criticalRadius({ critical, question }: State, tops: number): number {
  const isKnown = critical !== null && critical.of.name === question.name;
  return isKnown ? Math.max(tops, critical.is.critical_contact_radius_m) : tops;
}

/** The contact radius, and that of the contact on the pillar tops where the floor is reached farther out. */
function radiusWords(whole: number, tops: number, digits: number): string {
  const [all, part] = [whole, tops].map((radius) => engineeringText(radius, "length", digits));
  return `a = ${all}${whole > tops ? `,  on the tops ${part}` : ""}`;
}

/** The slider of the load: its steps, its end, where the critical state is, its value and that in words. */
function setSlider(step: number, end: number, critical: number, value: number, words: string): void {
  const slider = byId<HTMLInputElement>("load");
  slider.step = String(step);
  slider.max = String(end);
  slider.value = String(value);
  slider.setAttribute("aria-valuetext", words);
  byId("load-track").style.setProperty("--farthest", String(end / critical));
}

/** Indentations below this, m, are none: a part in 1e6 of the smallest pillars. */
const NO_LENGTH = 1e-13;

/** The way of the lens with adhesion: the slider has a step for every state. */
function drawCycleLoad(state: State): void {
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
        ? "called off"
        : state.refusal === null
          ? "being solved"
          : "no result"
      : wayWords(shown, station, solved);
  write(byId("load-words"), words);
  const slider = byId<HTMLInputElement>("load");
  slider.disabled = !isWhole(cycle);
  byId<HTMLButtonElement>("to-jump").disabled = slider.disabled || (summary?.floor?.jump ?? null) === null;
  byId<HTMLButtonElement>("to-pull-off").disabled =
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
  // The first contact is found a little beyond where it is.
  const zeta = engineeringText(Math.abs(indentation_m) < NO_LENGTH ? 0 : indentation_m, "length", 4);
  const whole = isCriticalStation(solved, shown) ? criticalRadius(state, contact_radius_m) : contact_radius_m;
  const radius = radiusWords(whole, contact_radius_m, 4);
  const force = engineeringText(force_N, "force", 4);
  const all = shown.pillar_forces_N.length;
  const holding = all === 0 ? "nothing in contact" : `${all} in contact, ${shown.parts.length} in part, ${pulled} pulled`;
  const floor = floorAt(solved, shown);
  const onFloor =
    floor === null
      ? ""
      : `\nfloor: ${holesWords(floor.filled_holes)} filled, ${areaText(floor.floor_contact_area_m2, 3)}, ` +
        engineeringText(floor.floor_force_N, "force", 2);
  write(byId("load-numbers"), `F = ${force},  ζ = ${zeta},  ${radius}\n${holding}${onFloor}`);
}

/** The critical state, while the rest of the cycle is being solved: the lens jumps from it onto a floor that sticks. */
function drawCriticalBefore(state: State): void {
  const { solved, question } = state;
  if (solved === null || solved.of.number !== question.number) return;
  const { force_N, indentation_m, contact_radius_m, pillars_in_contact } = solved.is.summary;
  const zeta = engineeringText(indentation_m, "length", 4);
  const radius = radiusWords(criticalRadius(state, contact_radius_m), contact_radius_m, 4);
  const force = engineeringText(force_N, "force", 4);
  write(byId("load-words"), `critical state, the rest ${isCalledOff(state) ? "called off" : "is being solved"}`);
  write(byId("load-numbers"), `F = ${force},  ζ = ${zeta},  ${radius}\n${pillars_in_contact} in contact`);
}

function areaText(area_m2: number | null, digits: number): string {
  return area_m2 === null ? "an unresolved area" : `${significant(1e12 * area_m2, digits)} µm^{2}`;
}

/** Where the lens is on its way. */
function wayWords(
  state: StationState,
  station: CycleSummary["stations"][number],
  cycle: SolvedCycle,
): string {
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

/** What loading and unloading come to. */
export function drawCycleNumbers(state: State): void {
  const cycle = state.cycle?.is.solved;
  if (cycle === undefined || cycle === null) return;
  const { summary } = cycle;
  const errors = summary.relative_error_estimate;
  const number = (value: number | null, dimension: Dimension, error: CycleError | null): string =>
    value === null ? "–" : engineeringText(value, dimension, Math.min(5, digitsFor(error?.numerical ?? null)));
  const pull = summary.pull_off_force_N;
  const pillars = summary.pull_off_pillars_in_contact ?? 0;
  const texts: Record<string, string> = {
    "pull-off-force": pull === null ? "nothing pulls" : number(pull, "force", errors.pull_off_force),
    "pull-off-error": pull === null ? "" : errorWords(errors.pull_off_force),
    "pull-off-held":
      pull === null
        ? ""
        : `${pillars} ${pillars === 1 ? "pillar" : "pillars"}, ζ = ${engineeringText(summary.pull_off_indentation_m ?? 0, "length", 3)}`,
    "sticky-critical": number(summary.critical_force_N, "force", errors.critical_force),
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
  byId("stuck-floor").hidden = floor === null;
  byId("stuck-floor").classList.toggle("strained", floor?.coarse ?? false);
  if (floor !== null) write(byId("stuck-floor"), stuckFloorWords(floor));
}

/** The jump onto a floor that sticks, and its loss, with what is known of their errors. */
function stuckFloorWords(floor: StuckFloor): string {
  const { jump, last, force_before_jump_N: before, relative_error_estimate: errors } = floor;
  const { indentation_after_loss_m: after, force_after_loss_N: lighter } = floor;
  const words: string[] = [];
  // Of coarse cells no error is known.
  const digits = (error: number): number => (error < 0.1 ? 3 : 2);
  const about = (error: number): string => (error < 1 ? ` (error ${significant(error, 1)})` : "");
  const force = (value: number | null, error: number): string =>
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
      `Floor lost between ζ = ${from} and ${to}${about(error)}, force from ${force(last.force_N, error)} to ${force(lighter, error)}.`,
    );
  } else {
    words.push("The floor is not lost.");
  }
  if (floor.coarse) {
    const across = significant(floor.cells_across_ring, 2);
    words.push(`Only ${across} cells are across the free ring round a pillar: these are orders of magnitude.`);
  } else if (Math.max(errors.jump_force, errors.jump_contact_area, errors.lost_indentation) >= 1) {
    words.push("What has no error here is an order of magnitude.");
  }
  return words.join(" ");
}

/** The numerical error, and that of the model apart. */
function errorWords(error: CycleError | null): string {
  if (error === null) return "";
  const numerical = `error ${significant(error.numerical, 1)}`;
  const model = error.model_fronts + error.model_columns;
  return model > 0 ? `${numerical}, of the model ${significant(model, 1)}` : numerical;
}

/** A condition of the model, marked where it does not hold. */
function drawLimit({ name, value, threshold, strained }: Limit): void {
  const shown = document.getElementById(`limit-${name}`);
  if (shown === null || threshold === null) return;
  write(shown, `${significant(value, 2)} ${strained ? ">" : "<"} ${plain(threshold)}`);
  shown.parentElement?.classList.toggle("strained", strained);
}

/** What the floor bears, in the digits that its errors leave. */
function drawFloor(floor: FloorSummary | null): void {
  byId("floor-numbers").hidden = floor === null;
  if (floor === null) return;
  const { share, contact_area } = floor.relative_error_estimate;
  const known = (error: number | null): number =>
    error !== null && error > 0.1 ? 1 : Math.min(4, digitsFor(error));
  const about = (error: number | null): string =>
    error === null ? "" : `error ${significant(error, 1)}`;
  const area = significant(1e12 * floor.contact_area_m2, known(contact_area));
  const texts = {
    "floor-force": engineeringText(floor.force_N, "force", known(share)),
    "floor-force-error": about(share),
    "floor-share": `${significant(100 * floor.share, known(share))} %`,
    "floor-area": `${area} µm^{2}`,
    "floor-area-error": about(contact_area),
    // Two grids differ where bridges between patches are narrow.
    "floor-patches": floor.patches === null ? "not resolved" : String(floor.patches),
    "floor-rim": engineeringText(floor.smallest_distance_to_rim_m, "length", 3),
  };
  for (const [id, text] of Object.entries(texts)) write(byId(id), text);
}

function loadWords(fraction: number): string {
  if (fraction === 0) return "first touch";
  if (isCritical(fraction)) return "critical state";
  const percent = `${significant(100 * fraction, 3)} %`;
  return fraction < 1
    ? `${percent} of the way to the critical state`
    : `${percent}, beyond the transition`;
}

/** What listeners are told of a result that has come to rest; null while there is none. */
export function announcement(state: State): string | null {
  const { critical, solved, refusal, question } = state;
  if (critical === null || refusal !== null || isBusy(state)) return null;
  if (critical.of.name !== question.name) return null;
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
      (pull === null ? "Nothing pulls. " : `Pull-off force ${engineeringText(pull, "force", 2)}. `) +
      `Load shown: ${wayWords(shown, station, cycle)}.`
    );
  }
  if (solved === null) return null;
  return (
    `Critical force ${force}, contact radius ${radius}, indentation ${indentation}. ` +
    `Load shown: ${loadWords(solved.is.fraction)}.` +
    (solved.is.summary.floor === null
      ? ""
      : ` The floor bears ${significant(100 * solved.is.summary.floor.share, 2)} % of the force.`)
  );
}
