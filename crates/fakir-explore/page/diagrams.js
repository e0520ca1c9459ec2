// The phase diagram, the force against the indentation, and the critical state against the surface fraction.

import { drawChart, extremes, range } from "./charts.js";
import { measuredPlaces } from "./measured.js";
import { digitsFor, engineeringText } from "./numbers.js";
import { byId } from "./screen.js";
import { floorCarriesLoad, isCritical, isOlder, stationAt, isCycle } from "./store.js";

/**
 * @import { Axes, Contents, Lettering, Place, Series } from "./charts.js"
 * @import { CurvePoint, CurveStation, CycleStation, TransitionSummary, Values } from "./engine.js"
 * @import { Cycle, Of, State } from "./store.js"
 */

/** @type {Axes} */
const PHASE = {
  xLabel: "contact radius on the tops over pitch, a/e",
  yLabel: "F γ_{int}/(h d)",
  yDimension: "number",
};

/**
 * @typedef {object} CurveChart
 * @property {string} id
 * @property {Axes} axes
 * @property {(point: CurvePoint) => number} of
 */

/** @type {readonly CurveChart[]} */
const CURVES = [
  {
    id: "curve-force",
    axes: { xLabel: "", yLabel: "F_{c}", yDimension: "force", bare: true },
    of: (point) => point.force_N,
  },
  {
    id: "curve-radius",
    axes: { xLabel: "", yLabel: "a_{c}", yDimension: "length", bare: true },
    of: (point) => point.contact_radius_m,
  },
  {
    id: "curve-indentation",
    axes: { xLabel: "surface fraction φ", yLabel: "ζ_{c}", yDimension: "length" },
    of: (point) => point.indentation_m,
  },
];

/**
 * A style, greyed out if the series belongs to an older case or load.
 * @param {string} style
 * @param {boolean} older
 * @returns {string}
 */
function aged(style, older) {
  return older ? `${style} older` : style;
}

/**
 * Whether a result belongs to another case than the critical state.
 * @param {Of<unknown>} shown
 * @param {Of<unknown>} critical
 * @returns {boolean}
 */
function isBefore(shown, critical) {
  return shown.of.name !== critical.of.name;
}

/** @param {State} state */
export function drawPhase(state) {
  const contents = phaseContents(state);
  if (contents === null) return;
  drawChart(byId("phase", SVGSVGElement), PHASE, contents);
  hideUndrawn("phase-legend", contents.series);
}

/**
 * Hides the entries of a legend whose lines are not drawn: closed forms exist only for some lattices.
 * @param {string} id
 * @param {readonly Series[]} series
 */
function hideUndrawn(id, series) {
  const drawn = series.filter(({ kind, points }) => kind === "line" && points.length > 0);
  const names = drawn.map(({ style }) => style.split(" ")[0] ?? "");
  for (const entry of byId(id).querySelectorAll(".line")) {
    entry.toggleAttribute("hidden", !names.some((name) => entry.classList.contains(name)));
  }
}

/**
 * @param {State} state
 * @returns {Contents | null}
 */
function phaseContents(state) {
  const { phase, critical, solved } = state;
  if (phase === null || critical === null) return null;
  const older = isBefore(phase, critical);
  const { transition } = phase.is;
  // The contact radius on the pillar tops, as along the loading path.
  /** @type {(summary: TransitionSummary) => Place} */
  const placeOf = (summary) => [summary.top_contact_radius_m / summary.pitch_m, summary.normalized?.force ?? NaN];
  if (phase.is.critical === null || critical.is.normalized === undefined) return null;
  const unit = critical.is.normalized.force / critical.is.critical_force_N;
  const at = placeOf(critical.is);
  const end = placeOf(phase.is.critical);
  /** @type {(of: (fraction: number) => boolean) => Place[]} */
  const places = (of) =>
    phase.is.path.flatMap(({ fraction, normalized }) => (of(fraction) && normalized !== null ? [/** @type {Place} */ (normalized)] : []));
  const path = [...places((fraction) => fraction < 1), end];
  const beyond = places((fraction) => fraction > 1);
  const all = [at, ...path, ...beyond];
  const x = range([0.4, 12, ...all.map(([a]) => a).filter((a) => a > 0.004)]);
  const floor = transition[0]?.[1] ?? 1;
  const forces = all.map(([, force]) => force).filter((force) => force > 1e-3 * floor);
  const y = range([0.2 * floor, 30 * floor, ...forces], 1.8);
  const curve = transition.filter(([a]) => a > x[0] / 2 && a < x[1] * 2);
  const inside = curve.filter(([a]) => a >= x[0] && a <= x[1]);
  /** @type {(level: number) => Place[]} */
  const edge = (level) => [
    [x[1] * 2, level],
    [x[0] / 2, level],
  ];
  /** @type {Series[]} */
  const series = [
    { kind: "area", style: aged("top-region", older), points: [...curve, ...edge(y[0])] },
    { kind: "area", style: aged("mixed-region", older), points: [...curve, ...edge(y[1])] },
    { kind: "vertical", style: "one-pitch", points: [[1, y[0]]] },
    { kind: "line", style: aged("transition", older), points: curve },
    { kind: "line", style: aged("path", older), points: path },
    {
      kind: "line",
      style: aged(`path beyond-path ${pastStyle(phase.of.case)}`, older),
      points: beyond.length > 0 ? [end, ...beyond] : [],
    },
    { kind: "points", style: "critical-point", points: [at] },
  ];
  const normalized = solved?.is.normalized ?? null;
  if (solved !== null && solved.of.name === critical.of.name && normalized !== null) {
    const fraction = solved.is.fraction ?? 1;
    series.push({
      kind: "points",
      style: aged("load-point", isOlder(state, solved, "load")),
      points: [isCritical(fraction) ? at : [normalized[1], normalized[0]]],
    });
  }
  const station = stationShown(state);
  if (station !== null && state.cycle?.of.name === critical.of.name && station.force_N > 0) {
    /** @type {Place} */
    const place = [station.contact_radius_m / critical.is.pitch_m, station.force_N * unit];
    series.push({ kind: "points", style: "load-point", points: [place] });
  }
  /** @type {(share: number) => Place} */
  const part = (share) => inside[Math.floor(inside.length * share)] ?? [1, floor];
  const [left, right] = [part(0.3), part(0.78)];
  const style = aged("region", older);
  /** @type {Lettering[]} */
  const names = [
    { place: [left[0], Math.sqrt(left[1] * y[1])], text: "tops and floor", style },
    { place: [right[0], Math.sqrt(right[1] * y[0])], text: "pillar tops only", style },
  ];
  // Without a transition curve there are no regions.
  return { x, y, series, names: curve.length > 0 ? names : [] };
}

/**
 * The style of the path beyond the transition: with floor contact, or with floor contact ignored.
 * @param {Values} values
 * @returns {string}
 */
function pastStyle(values) {
  return floorCarriesLoad(values) ? "floor-path" : "fiction-path";
}

/** @type {Axes} */
const LOADING = {
  xLabel: "indentation ζ",
  xDimension: "length",
  yLabel: "F",
  yDimension: "force",
  linear: true,
};

/** A pull-off force larger than this fraction of the height of the chart needs no close-up. */
const WELL_SEEN = 0.25;

/**
 * Force against indentation of the pinned case.
 * @param {State} state
 * @returns {Place[]}
 */
function pinnedPlaces({ pinned }) {
  if (pinned === null) return [];
  const cycle = pinned.cycle?.is.solved ?? null;
  if (cycle !== null) return cycle.summary.stations.map(placeOf);
  const { critical, phase } = pinned;
  if (phase === null) return [];
  /** @type {Place[]} */
  const end = critical === null ? [] : [[critical.is.critical_indentation_m, critical.is.critical_force_N]];
  return [...phase.is.path.map(placeOf), ...end].sort(([a], [b]) => a - b);
}

/**
 * The load step of the cycle that is shown.
 * @param {State} state
 * @returns {CycleStation | null}
 */
export function stationShown({ cycle, chosen }) {
  const shown = stationAt(cycle, chosen.load);
  return (shown && cycle?.is.solved?.summary.stations[shown.place]) ?? null;
}

/**
 * Draws loading and unloading with their events.
 * @param {State} state
 * @param {Cycle} cycle
 */
function drawCycle(state, cycle) {
  const curve = cycle.solved === null ? cycle.curve.map(placeOf) : cycle.solved.summary.stations.map(placeOf);
  const pull = cycle.solved?.summary.pull_off_force_N ?? null;
  const series = cycleSeries(state, cycle);
  const all = [...curve, ...pinnedPlaces(state)];
  const [x, y] = [withPadding(all.map(([x]) => x)), withPadding(all.map(([, y]) => y))];
  const force = engineeringText(pull ?? 0, "force", digitsFor(numericalErrorOf(cycle)));
  /** @type {(place: Place) => Lettering} */
  const name = (place) => ({ place, text: `pull-off ${force}`, style: "pull-name" });
  // A large pull-off force needs no close-up.
  const isSeen = pull !== null && -pull > WELL_SEEN * (y[1] - y[0]);
  const at = cycle.solved?.summary.pull_off_indentation_m ?? 0;
  const names = isSeen ? [name([Math.max(at, x[0] + 0.2 * (x[1] - x[0])), pull - 0.09 * (y[1] - y[0])])] : [];
  drawChart(byId("loading", SVGSVGElement), LOADING, {
    x,
    y: isSeen ? [y[0] - 0.12 * (y[1] - y[0]), y[1]] : y,
    series,
    names,
  });
  byId("pull-box").hidden = pull === null || isSeen;
  if (pull === null || isSeen || cycle.solved === null) return;
  const { stations, last_release_indentation_m: last } = cycle.solved.summary;
  // The close-up covers the part of unloading with a force below half the pull-off force.
  const held = stations.filter(({ branch, force_N }) => branch === "unloading" && force_N < -0.5 * pull);
  const [left, right] = extremes([0, last ?? 0, ...held.map(({ indentation_m }) => indentation_m)]);
  const space = 0.06 * (right - left);
  drawChart(byId("pull", SVGSVGElement), LOADING, {
    x: [left - space, right + space],
    y: [1.42 * pull, -0.55 * pull],
    series,
    names: [name([Math.max(at, left + 0.2 * (right - left)), 1.26 * pull])],
  });
}

/**
 * The range of values on a linear axis, with a margin for marks.
 * @param {readonly number[]} values
 * @returns {Place}
 */
function withPadding(values) {
  const [low, high] = extremes(values);
  if (!(high > low)) return [0, 1];
  return [low - 0.04 * (high - low), high + 0.06 * (high - low)];
}

/**
 * @param {Cycle} cycle
 * @returns {number | null}
 */
function numericalErrorOf(cycle) {
  return cycle.solved?.summary.relative_error_estimate.pull_off_force?.numerical ?? null;
}

/**
 * @param {{ indentation_m: number, force_N: number }} state
 * @returns {Place}
 */
function placeOf({ indentation_m, force_N }) {
  return [indentation_m, force_N];
}

/**
 * The series of both charts of a cycle.
 * @param {State} state
 * @param {Cycle} cycle
 * @returns {Series[]}
 */
function cycleSeries(state, { curve, solved }) {
  /** @type {(station: CurveStation | CycleStation) => boolean} */
  const isDown = (station) =>
    "loading" in station ? station.loading : station.branch === "loading";
  /** @type {readonly (CurveStation | CycleStation)[]} */
  const all = solved?.summary.stations ?? curve;
  const down = all.filter(isDown).map(placeOf);
  const up = all.filter((station) => !isDown(station)).map(placeOf);
  const turn = down[down.length - 1];
  /** @type {Series[]} */
  const lines = [
    { kind: "points", style: "measured", points: measuredPlaces(state) },
    { kind: "line", style: "pinned-path", points: pinnedPlaces(state) },
    { kind: "line", style: "zero", points: [[-1, 0], [1, 0]] },
    { kind: "line", style: "path", points: down },
    { kind: "line", style: "path unloading", points: turn === undefined ? up : [turn, ...up] },
  ];
  if (solved === null) return lines;
  const { events, pull_off_force_N: pull, pull_off_indentation_m: at } = solved.summary;
  const { first_contact_indentation_m: first, first_contact_force_N: force } = solved.summary;
  /** @type {(kind: string, branch: string) => Place[]} */
  const placesOf = (kind, branch) =>
    events.filter((event) => event.event === kind && event.branch === branch).map(placeOf);
  const floor = placesOf("floor_contact", "loading");
  const last = up[up.length - 1];
  lines.unshift({ kind: "area", style: "loop-area", points: [...down, ...up] });
  lines.push(
    { kind: "ticks-above", style: "snap-in", points: placesOf("snap_in", "loading") },
    { kind: "ticks-below", style: "release", points: placesOf("release", "unloading") },
    { kind: "points", style: "first-contact", points: first === null || force === null ? [] : [[first, force]] },
    { kind: "points", style: "last-release", points: last === undefined || pull === null ? [] : [last] },
    { kind: "points", style: "critical-point", points: floor },
    { kind: "points", style: "pull-off", points: pull === null || at === null ? [] : [[at, pull]] },
  );
  const { jump, last: lost, force_before_jump_N: before } = solved.summary.floor ?? {};
  if (jump && before !== null && before !== undefined) {
    /** @type {Place[]} */
    const ends = [[jump.indentation_m, before], placeOf(jump)];
    lines.push({ kind: "line", style: "floor-jump", points: ends });
    lines.push({ kind: "points", style: "floor-jump", points: ends.slice(1) });
  }
  if (lost) lines.push({ kind: "points", style: "floor-lost", points: [placeOf(lost)] });
  const shown = stationShown(state);
  if (shown !== null) lines.push({ kind: "points", style: "load-point", points: [placeOf(shown)] });
  return lines;
}

/** @param {State} state */
export function drawLoading(state) {
  const adhesive = isCycle(state.chosen.case);
  if (adhesive && state.cycle !== null) drawCycle(state, state.cycle.is);
  if (adhesive) return;
  byId("pull-box").hidden = true;
  const contents = loadingContents(state);
  if (contents !== null) drawChart(byId("loading", SVGSVGElement), LOADING, contents);
}

/**
 * @param {State} state
 * @returns {Contents | null}
 */
function loadingContents(state) {
  const { phase, critical, loadScale, solved } = state;
  const known = critical ?? loadScale;
  if (phase === null || known === null) return null;
  const older = isBefore(phase, known);
  const { path, critical: end, unloading } = phase.is;
  byId("unloading-key").hidden = byId("branch-note").hidden = unloading.length === 0;
  // Without a critical state the whole path is one line.
  const split = end === null ? Infinity : 1;
  /** @type {Place[]} */
  const ends = end === null ? [] : [[end.critical_indentation_m, end.critical_force_N]];
  /** @type {(of: (fraction: number) => boolean) => Place[]} */
  const places = (of) => path.filter(({ fraction }) => of(fraction)).map(placeOf);
  const past = places((fraction) => fraction > split);
  const onFloor = path.flatMap(/** @returns {Place[]} */ ({ fraction, indentation_m, floor_force_N }) =>
    fraction > split && floor_force_N !== null ? [[indentation_m, floor_force_N]] : [],
  );
  /** @type {Series[]} */
  const series = [
    { kind: "vertical", style: "one-pitch", points: ends },
    { kind: "line", style: aged("path unloading", older), points: [...unloading] },
    { kind: "line", style: aged("path", older), points: [...places((f) => f < split), ...ends] },
    {
      kind: "line",
      style: aged(`path beyond-path ${pastStyle(phase.of.case)}`, older),
      points: past.length > 0 ? [...ends, ...past] : [],
    },
    {
      kind: "line",
      style: aged("floor-force", older),
      points: onFloor.length > 0 ? [...ends.map(/** @returns {Place} */ ([x]) => [x, 0]), ...onFloor] : [],
    },
    {
      kind: "points",
      style: "critical-point",
      points: critical === null ? [] : [[critical.is.critical_indentation_m, critical.is.critical_force_N]],
    },
  ];
  /** @type {Place[]} */
  const shown = [];
  if (solved !== null && solved.of.name === known.of.name) {
    const { summary } = solved.is;
    shown.push([summary.indentation_m, summary.force_N]);
    const style = aged("load-point", isOlder(state, solved, "load"));
    if (summary.floor) {
      /** @type {Place} */
      const point = [summary.indentation_m, summary.floor.force_N];
      series.push({ kind: "points", style, points: [point] });
    }
    series.push({ kind: "points", style, points: shown });
  }
  const measured = measuredPlaces(state);
  const pinned = pinnedPlaces(state);
  series.unshift(
    { kind: "points", style: "measured", points: measured },
    { kind: "line", style: "pinned-path", points: pinned },
  );
  /** @type {(k: 0 | 1) => number} */
  const most = (k) =>
    1.05 * Math.max(...[...ends, ...places(() => true), ...shown, ...measured, ...pinned].map((place) => place[k]).filter(Number.isFinite));
  const [least] = extremes([0, ...[...measured, ...pinned, ...unloading, ...places(() => true)].map(([, force]) => 1.05 * force)]);
  const [first] = extremes([0, ...unloading.map(([x]) => 1.05 * x)]);
  if (least < 0) series.unshift({ kind: "line", style: "zero", points: [[-1, 0], [1, 0]] });
  return { x: [first, most(0)], y: [least, most(1)], series };
}

/** @param {State} state */
export function drawCurves(state) {
  for (const chart of CURVES) {
    const svg = byId(chart.id, SVGSVGElement);
    // They were refused: those of the case before are not left under the words that say so.
    if (state.curves === null) svg.replaceChildren();
    const contents = curveContents(state, chart);
    if (contents === null) continue;
    drawChart(svg, chart.axes, contents);
    hideUndrawn("curves-legend", contents.series);
  }
}

/**
 * @param {State} state
 * @param {CurveChart} curveChart
 * @returns {Contents | null}
 */
function curveContents(state, { of }) {
  const { curves, critical } = state;
  if (curves === null || critical === null) return null;
  const { small, large, homogenised, exact } = curves.is;
  // Closed forms exist only for the hexagonal lattice on half-spaces.
  const all = [...small, ...large, ...homogenised, ...exact];
  if (all.length === 0) return null;
  const older = isBefore(curves, critical);
  const now = of(pointOf(critical.is));
  const present = critical.is.surface_fraction;
  const fractions = all.map((point) => point.surface_fraction);
  /** @type {(points: readonly CurvePoint[]) => Place[]} */
  const places = (points) =>
    points
      .filter((point) => of(point) > 0)
      .map(/** @returns {Place} */ (point) => [point.surface_fraction, of(point)]);
  const shown = places([...exact, ...homogenised, ...small]);
  /** @type {(style: string, points: readonly CurvePoint[]) => Series} */
  const line = (style, points) => ({
    kind: "line",
    style: aged(style, older),
    points: places(points),
  });
  return {
    x: [Math.min(present, ...fractions), Math.max(present, ...fractions)],
    y: range([now, ...shown.map(([, value]) => value)], 1.5),
    series: [
      { kind: "vertical", style: "present", points: [[present, now]] },
      line("small-curve", small),
      line("large-curve", large),
      line("homogenised-curve", homogenised),
      line("exact-curve", exact),
      { kind: "points", style: aged("exact-point", older), points: places(exact) },
      { kind: "points", style: "load-point", points: now > 0 ? [[present, now]] : [] },
    ],
  };
}

/**
 * A critical state as a point of the curves.
 * @param {TransitionSummary} critical
 * @returns {CurvePoint}
 */
function pointOf(critical) {
  return {
    surface_fraction: critical.surface_fraction,
    force_N: critical.critical_force_N,
    contact_radius_m: critical.critical_contact_radius_m,
    indentation_m: critical.critical_indentation_m,
    normalized: [critical.normalized?.contact_radius ?? NaN, critical.normalized?.force ?? NaN],
  };
}

/**
 * Shows whether the curves are being computed, or why there are none.
 * @param {State} state
 */
export function drawCurvesStatus({ asking, answered, question }) {
  const refused = [answered.curves, answered.phase]
    .filter((each) => each?.of.name === question.name)
    .map((each) => each?.is ?? "");
  const words = asking.curves !== null ? "computing …" : refused.find((words) => words !== "") ?? "";
  byId("curves-status").textContent = [isCycle(question.case) ? "without adhesion" : "", words]
    .filter((part) => part !== "")
    .join(", ");
}
