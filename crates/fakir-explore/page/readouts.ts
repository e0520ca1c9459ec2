// The numbers: the critical state of the case, and the load that is shown.

import type { FloorSummary, TransitionSummary } from "./engine.js";
import {
  digitsFor,
  engineering,
  engineeringText,
  radiusDigits,
  significant,
  write,
  type Dimension,
} from "./numbers.js";
import { byId } from "./screen.js";
import { floorBears, isBeyond, isBusy, isCritical, isOlder, type Estimate, type State } from "./store.js";

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
      remark: `a/e = ${ratio},  ${words(error.contact_radius)}`,
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
  const { critical, solved } = state;
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
  warnings.textContent = solved?.is.warnings.join("; ") ?? "";
  warnings.hidden = warnings.textContent === "";
}

function statusWords(state: State): string {
  const { progress, refusal, solved } = state;
  if (progress !== null) {
    const { stage, step, touched } = progress.is;
    return `${stage}, step ${step}, ${touched} pillars touched …`;
  }
  if (refusal !== null && !isOlder(state, refusal, "load")) return "no result";
  if (solved === null) return "starting …";
  if (isOlder(state, solved, "load")) return "solving …";
  const { method, wall_time_s } = solved.is.summary;
  return `${method}, solved in ${seconds(wall_time_s)}`;
}

function seconds(time: number): string {
  return time < 1 ? `${significant(1e3 * time, 2)} ms` : `${significant(time, 3)} s`;
}

/** The load: words and slider follow what is chosen, the numbers are those of the state solved for. */
export function drawLoad(state: State): void {
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
  const slider = byId<HTMLInputElement>("load");
  slider.value = String(load);
  slider.setAttribute("aria-valuetext", words);
  if (state.solved === null) return;
  const { summary } = state.solved.is;
  const error = summary.relative_error_estimate;
  const digits = (value: number | null): number => Math.min(4, digitsFor(value));
  const force = engineeringText(summary.force_N, "force", digits(error.force));
  const indentation = engineeringText(summary.indentation_m, "length", digits(error.indentation));
  const radius = engineeringText(summary.contact_radius_m, "length", digits(error.contact_radius));
  write(byId("load-numbers"), `F = ${force},  ζ = ${indentation},  a = ${radius}`);
  write(byId("floor-gap"), engineeringText(summary.smallest_floor_gap_m, "length", digits(error.indentation)));
  drawFloor(summary.floor);
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
  if (critical === null || solved === null || refusal !== null || isBusy(state)) return null;
  if (critical.of.name !== question.name) return null;
  const summary = critical.is;
  const force = engineeringText(summary.critical_force_N, "force", 4);
  const digits = radiusDigits(summary.relative_error_estimate.contact_radius);
  const radius = engineeringText(summary.critical_contact_radius_m, "length", Math.min(4, digits));
  const indentation = engineeringText(summary.critical_indentation_m, "length", 4);
  return (
    `Critical force ${force}, contact radius ${radius}, indentation ${indentation}. ` +
    `Load shown: ${loadWords(solved.is.fraction)}.` +
    (solved.is.summary.floor === null
      ? ""
      : ` The floor bears ${significant(100 * solved.is.summary.floor.share, 2)} % of the force.`)
  );
}
