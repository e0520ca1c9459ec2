// The state of the page, and the only functions that change it.
//
// Every change of the case or the load makes a new question, with a number. What comes back is kept
// with the question that it answers, so that everything shown can be told to be of the newest
// question or of an older one.

import type {
  Background,
  ContactState,
  CurvePoint,
  CurveStation,
  ExpectedCells,
  Kind,
  Line,
  PathState,
  Point,
  Progress,
  Refusal,
  Section,
  SolvedCycle,
  Start,
  StationState,
  Texts,
  TransitionSummary,
  Value,
  Values,
} from "./engine.js";
import {
  largestForceOf,
  sceneOf,
  sceneOfPreview,
  sceneOfStation,
  withFloorBefore,
  type Scene,
} from "./scene.js";

export const FRACTION = "texture.surface_fraction";
export const FLOOR = "floor.contact";
export const PITCH = "texture.pitch";
export const LATTICE = "texture.lattice";
const PITCH_Y = "texture.pitch_y";
const LATTICE_ANGLE = "texture.lattice_angle";
const DIAMETER = "texture.pillar.diameter";
export const WORK = "adhesion.work";
export const RECEDING = "adhesion.work_receding";
export const STUCK = "adhesion.floor";

/** With adhesion the load goes on to the last release, on the way back. */
const LAST_RELEASE = 2;

/** What the user has chosen. */
export interface Chosen {
  readonly case: Values;
  /** The load, as a part of the way from first touch to the critical state; more than 1 is beyond it, and with adhesion on the way
   * back to the last release, at 2. */
  readonly load: number;
  /** How much heights are exaggerated in the section; null for as much as fills the view. */
  readonly exaggeration: number | null;
}

export interface Question {
  readonly number: number;
  readonly case: Values;
  /** The case in one text: two questions are about the same case if this is the same. */
  readonly name: string;
  readonly load: number;
  /** When the user made the change that led to this question, ms. */
  readonly asked: number;
}

/** Something that the server answered, and the question that it answers. */
export interface Of<T> {
  readonly of: Question;
  readonly is: T;
}

/** What a map comes from: the homogenised lattice, then the punch lattice or the pillar tops alone, then the method of the
 * case. */
export type Stage = "estimate" | "pillars" | "exact";

export interface Picture {
  readonly stage: Stage;
  readonly scene: Scene;
}

/** An estimate of the critical state, which is shown until it is solved. */
export interface Estimate {
  readonly force_N: number;
  readonly contact_radius_m: number;
  readonly indentation_m: number;
}

export interface Phase {
  readonly transition: readonly Point[];
  /** States of the loading, by rising load. */
  readonly path: readonly PathState[];
  /** The critical state of the same case. */
  readonly critical: TransitionSummary;
}

export interface Curves {
  readonly small: readonly CurvePoint[];
  readonly large: readonly CurvePoint[];
  readonly homogenised: readonly CurvePoint[];
  /** The solved critical states, sorted by surface fraction. */
  readonly exact: readonly CurvePoint[];
}

/** A cycle of loading and unloading with adhesion. */
export interface Cycle {
  /** The curve, as far as the lens has gone. */
  readonly curve: readonly CurveStation[];
  /** The cycle, once the lens is back. */
  readonly solved: SolvedCycle | null;
  /** States along it, in their order, as far as they have come. */
  readonly states: readonly StationState[];
}

/** A question under way, and when it was sent, ms. */
interface Asking {
  readonly question: Question;
  readonly since: number;
}

export type Notice = "export" | "link" | keyof Texts;

export interface State {
  readonly start: Start;
  readonly chosen: Chosen;
  /** Key of the field whose text stays as it was typed. */
  readonly typed: string | null;

  /** The newest question. */
  readonly question: Question;
  /** Number of the newest question that was sent. */
  readonly sent: number;
  /** The question of each kind that the server is answering. */
  readonly asking: { readonly [kind in Kind]: Asking | null };
  /** How long the last picture took, ms. */
  readonly lastTime: number;
  /** The newest question of which something is shown, or that is overdue or was refused: whatever is of an older
   * one is grey. */
  readonly reference: Question | null;

  /** The contact map that is shown. */
  readonly picture: Of<Picture> | null;
  /** The last contact that was solved. */
  readonly solved: Of<ContactState> | null;
  /** The last critical state that was solved. */
  readonly critical: Of<TransitionSummary> | null;
  /** The one of the case before, of which the map may still be shown. */
  readonly criticalBefore: Of<TransitionSummary> | null;
  /** An estimate of a critical state that is not solved yet. */
  readonly estimate: Of<Estimate> | null;
  /** The largest force that the colours of a case have to show, N. */
  readonly largestForce: Of<number> | null;
  readonly section: Of<Section | null> | null;
  /** Loading and unloading, with adhesion only: then no contact is solved besides. */
  readonly cycle: Of<Cycle> | null;
  readonly texts: Of<Texts> | null;
  readonly progress: Of<Progress> | null;
  /** What the cells of a floor that sticks are going to be. */
  readonly expected: Of<ExpectedCells> | null;
  /** The last question that the user called off. */
  readonly calledOff: Question | null;
  /** How long a cycle has been solved, ms. */
  readonly elapsed: number;
  readonly refusal: Of<Refusal> | null;

  readonly phase: Of<Phase> | null;
  readonly curves: Of<Curves> | null;
  /** Questions of the background that were answered, or refused with these words. */
  readonly answered: { readonly [kind in Background]: Of<string> | null };

  /** Short messages beside buttons, which go after a moment. */
  readonly notices: { readonly [about in Notice]?: string };
  /** The text that screen readers read out. */
  readonly announcement: string;
}

export class Store {
  #state: State;
  readonly #listeners: (() => void)[] = [];

  constructor(start: Start, first: Chosen, asked: number) {
    const chosen = { ...first, load: within(first.load, first.case, start) };
    this.#state = {
      start,
      chosen,
      typed: null,
      question: newQuestion(1, chosen, asked),
      sent: 0,
      asking: { contact: null, curves: null, phase: null },
      lastTime: 100,
      reference: null,
      picture: null,
      solved: null,
      critical: null,
      criticalBefore: null,
      estimate: null,
      largestForce: null,
      section: null,
      cycle: null,
      texts: null,
      progress: null,
      expected: null,
      calledOff: null,
      elapsed: 0,
      refusal: null,
      phase: null,
      curves: null,
      answered: { curves: null, phase: null },
      notices: {},
      announcement: "",
    };
  }

  get state(): State {
    return this.#state;
  }

  /** `listener` is called after every change. */
  listen(listener: () => void): void {
    this.#listeners.push(listener);
  }

  #change(part: Partial<State>): void {
    this.#state = { ...this.#state, ...part };
    for (const listener of this.#listeners) listener();
  }

  // --- What the user does ---------------------------------------------------------------------

  /** Changes what the user has chosen; what `choice` does not name stays. `asked` is the time of the change, ms. */
  choose(choice: Partial<Chosen>, asked: number, typed: string | null = null): void {
    const before = this.#state.chosen;
    const values = choice.case ?? before.case;
    const [wanted, turned] = [choice.load ?? before.load, sticks(values) !== sticks(before.case)];
    // What is past the critical state is another way with adhesion than without.
    const load = within(turned && choice.load === undefined ? Math.min(1, wanted) : wanted, values, this.#state.start);
    const chosen = { ...before, ...choice, load };
    if (choice.case === undefined && choice.load === undefined) {
      this.#change({ chosen });
      return;
    }
    if (choice.case === undefined && sticks(values)) {
      // The states of the whole way are there, or come.
      this.#change({ chosen, ...shownAt(this.#state.cycle, load) });
      return;
    }
    const question = newQuestion(this.#state.question.number + 1, chosen, asked);
    this.#change({ chosen, typed, question });
  }

  /** Gives a key of the case another value; `typed` if it is to stay as the user wrote it. */
  setValue(key: string, value: Value, typed: boolean, asked: number): void {
    const values = { ...this.#state.chosen.case };
    for (const other of this.#state.start.keys) {
      const condition = other.goes_with;
      const leaves = condition?.key === key && !condition.words.includes(String(value));
      if (other.alternative === key || leaves) delete values[other.key];
    }
    values[key] = value;
    if (key === LATTICE) Object.assign(values, spacingOn(String(value), this.#state.chosen.case));
    // Without adhesion nothing recedes; what is not given is as the work of adhesion.
    if (key === WORK && value === 0) {
      delete values[RECEDING];
      delete values[STUCK];
    }
    // A floor that the lens goes through does not stick.
    if (key === FLOOR && value === "false") delete values[STUCK];
    const isEndless = this.#state.start.keys.some((known) => known.key === key && known.endless);
    const isEmptied = value === "" && (key === WORK || key === RECEDING || isEndless);
    if (isEmptied) delete values[key];
    this.choose({ case: values }, asked, typed && !isEmptied ? key : null);
  }

  /** Calls off what is being solved. What has come of it stays. */
  callOff(): void {
    const under = this.#state.asking.contact?.question;
    if (under !== undefined) this.#change({ calledOff: under });
  }

  /** Asks the same again. */
  askAgain(asked: number): void {
    this.choose({ case: this.#state.chosen.case }, asked);
  }

  /** Shows a message beside a button, or removes it. */
  tell(about: Notice, words: string | null): void {
    const notices = { ...this.#state.notices };
    if (words === null) delete notices[about];
    else notices[about] = words;
    this.#change({ notices });
  }

  announce(announcement: string): void {
    this.#change({ announcement });
  }

  // --- What comes back ------------------------------------------------------------------------

  /** A question has been sent. */
  send(kind: Kind, question: Question, now: number): void {
    const asking = { ...this.#state.asking, [kind]: { question, since: now } };
    this.#change(
      kind === "contact" ? { asking, sent: question.number, progress: null, elapsed: 0 } : { asking },
    );
  }

  /** Time has passed. */
  tick(now: number): void {
    const asking = this.#state.asking.contact;
    if (asking !== null) this.#change({ elapsed: now - asking.since });
  }

  /** Takes a line of the answer to a question. Lines of a question that was called off are dropped. */
  receive(kind: Kind, number: number, line: Line, now: number): void {
    const asking = this.#state.asking[kind];
    if (asking === null || asking.question.number !== number) return;
    const taken = {
      contact: () => contactLine(this.#state, asking, line, now),
      phase: () => phaseLine(this.#state, asking.question, line),
      curves: () => curvesLine(this.#state, asking.question, line),
    }[kind]();
    // What is still shown of an older case or load turns grey in the same moment.
    const isShown = Object.keys(taken).some((part) => part !== "progress" && part !== "expected");
    const reference = newer(this.#state.reference, asking.question);
    this.#change(isShown ? { ...taken, reference } : taken);
  }

  /** The answer to a question has ended: `whole` if it was not called off, or with a refusal. */
  end(kind: Kind, number: number, whole: boolean, refusal: Refusal | null): void {
    const state = this.#state;
    const of = state.asking[kind]?.question;
    if (of === undefined || of.number !== number) return;
    const asking = { ...state.asking, [kind]: null };
    if (kind !== "contact") {
      const words = refusal?.message ?? "";
      const done = whole || refusal !== null;
      const answered = { ...state.answered, ...(done && { [kind]: { of, is: words } }) };
      this.#change({ asking, answered });
    } else if (refusal !== null) {
      const reference = newer(state.reference, of);
      this.#change({ asking, reference, progress: null, refusal: { of, is: refusal } });
    } else {
      this.#change({ asking, progress: null });
    }
  }

  /** A question has been open for so long that what is older must not look as if it were current. */
  overdue(question: Question): void {
    const reference = newer(this.#state.reference, question);
    if (reference !== this.#state.reference) this.#change({ reference });
  }
}

// --- What follows from the state ----------------------------------------------------------------

/** Whether the answer to the newest question is still to come. */
export function isBusy(state: State): boolean {
  return state.sent < state.question.number || state.asking.contact !== null;
}

/** Whether something shown is of an older case, or, if it depends on the load, of an older load. */
export function isOlder(
  { reference }: State,
  shown: Of<unknown> | null,
  dependsOn: "case" | "load",
): boolean {
  if (shown === null || reference === null || shown.of.number >= reference.number) return false;
  const sameLoad = dependsOn === "case" || shown.of.load === reference.load;
  return shown.of.name !== reference.name || !sameLoad;
}

/** The surface fraction of a lattice at which pillars touch each other: there the pitch is their diameter. */
function densest(lattice: Value | undefined): number {
  return lattice === "square" ? Math.PI / 4 : Math.PI / Math.sqrt(12);
}

/** A case on a lattice of one pitch with both surface fraction and pitch: that which is not given follows from the other. */
export function withSpacing(values: Values): Values {
  const [fraction, pitch, diameter] = [values[FRACTION], values[PITCH], values[DIAMETER]];
  const most = densest(values[LATTICE]);
  if (typeof diameter !== "number") return values;
  if (typeof fraction === "number" && fraction > 0) {
    return { ...values, [PITCH]: rounded(diameter * Math.sqrt(most / fraction)) };
  }
  if (typeof pitch === "number" && pitch > 0 && values[PITCH_Y] === undefined) {
    return { ...values, [FRACTION]: rounded(most * (diameter / pitch) ** 2) };
  }
  return values;
}

/** What a lattice needs that the one before it had not: the pitch of that along both rows, and the angle between the rows of a hexagonal one. */
function spacingOn(lattice: string, before: Values): Values {
  if (lattice !== "rectangular" && lattice !== "oblique") return {};
  const pitch = withSpacing(before)[PITCH];
  const own: Values = pitch === undefined ? {} : { [PITCH]: pitch, [PITCH_Y]: before[PITCH_Y] ?? pitch };
  if (lattice === "oblique") own[LATTICE_ANGLE] = Math.PI / 3;
  return own;
}

/** A value that follows from others, in the digits that are shown. */
function rounded(value: number): number {
  return Number(value.toPrecision(6));
}

/** Whether pillar tops stick. */
export function sticks(values: Values): boolean {
  return [WORK, RECEDING].some((key) => Number(values[key] ?? 0) !== 0);
}

/** Whether the floor sticks too. */
export function floorSticks(values: Values): boolean {
  return sticks(values) && String(values[STUCK] ?? "false") === "true";
}

/** Whether the newest question was called off by the user. */
export function isCalledOff({ calledOff, question }: State): boolean {
  return calledOff?.number === question.number;
}

/** The place of the critical state of a cycle among its stations: before the jump onto a floor that sticks, or where the lens turns. */
export function isCriticalStation({ summary }: SolvedCycle, { place, load }: StationState): boolean {
  const jump = summary.floor?.jump ?? null;
  return jump === null ? load === 1 : place === jump.station - 1;
}

/** The state of a cycle nearest to a load; null while there is none. */
export function stationAt(cycle: Of<Cycle> | null, load: number): StationState | null {
  const distance = (state: StationState): number => Math.abs(state.load - load);
  return (cycle?.is.states ?? []).reduce<StationState | null>(
    (nearest, state) => (nearest === null || distance(state) < distance(nearest) ? state : nearest),
    null,
  );
}

/** Whether all states of a cycle are there. */
export function isWhole(cycle: Of<Cycle> | null): cycle is Of<Cycle> & { is: { solved: SolvedCycle } } {
  return cycle !== null && cycle.is.solved !== null && cycle.is.states.length === cycle.is.solved.states;
}

/** The critical state of a case, where it has been solved for. */
export function knownCritical({ critical }: State, { name }: Question): TransitionSummary | null {
  return critical?.of.name === name ? critical.is : null;
}

/** What the map needs besides its scene: the critical contact radius, m, where it is known or
 * estimated, and the largest force that the colours show, N. */
export function mapScale(state: State, { of, is }: Of<Picture>): { radius: number; force: number } {
  const estimate = state.estimate?.of.name === of.name ? state.estimate.is : null;
  const criticals = [state.critical, state.criticalBefore];
  const known = criticals.find((each) => each?.of.name === of.name)?.is.critical_contact_radius_m;
  const largest = state.largestForce?.of.name === of.name ? state.largestForce.is : 0;
  return {
    radius: known ?? estimate?.contact_radius_m ?? 0,
    force: Math.max(largest, largestForceOf(is.scene)),
  };
}

export function isCritical(fraction: number): boolean {
  return Math.abs(fraction - 1) < 1e-9;
}

/** Whether the floor of a case bears its part past the transition, which only the spectral method knows; if not, the
 * lens goes through the floor. */
export function floorBears(values: Values): boolean {
  const isOf = (key: string, word: string): boolean => (values[key] ?? word) === word;
  return isOf(FLOOR, "true") && isOf("method.name", "spectral");
}

/** Whether a state is that on the pillar tops alone, before the one with the floor. */
export function isWithoutFloor({ approximate, summary }: ContactState): boolean {
  return approximate && summary.method === "spectral";
}

export function isBeyond(fraction: number): boolean {
  return fraction > 1 + 1e-9;
}

// --- From one state to the next ----------------------------------------------------------------------------------------

function newQuestion(number: number, chosen: Chosen, asked: number): Question {
  const { case: values, load } = chosen;
  return { number, case: values, name: JSON.stringify(values), load, asked };
}

/** The load nearest to `load` that the slider can have; the critical one if `load` is no number. */
function within(load: number, values: Values, { farthest_load }: Start): number {
  const farthest = sticks(values) ? LAST_RELEASE : farthest_load;
  return Number.isFinite(load) ? Math.min(farthest, Math.max(0, load)) : 1;
}

function newer(a: Question | null, b: Question): Question {
  return a !== null && a.number > b.number ? a : b;
}

function contactLine(
  state: State,
  { question: of, since }: Asking,
  line: Line,
  now: number,
): Partial<State> {
  const known = knownCritical(state, of) !== null;
  if (line.progress) return { progress: { of, is: line.progress } };
  if (line.expected_cells) return { expected: { of, is: line.expected_cells } };
  if (line.curve || line.cycle || line.station || line.transition) return cycleLine(state, of, since, line, now);
  if (line.preview) {
    const { critical_force_N, critical_contact_radius_m, critical_indentation_m } = line.preview;
    const estimate = {
      force_N: critical_force_N,
      contact_radius_m: critical_contact_radius_m,
      indentation_m: critical_indentation_m,
    };
    return {
      picture: { of, is: { stage: "estimate", scene: sceneOfPreview(line.preview) } },
      estimate: known ? null : { of, is: estimate },
      refusal: null,
    };
  }
  if (line.state?.approximate) {
    const before = state.picture;
    // It was held back, and the state with the floor is there already.
    if (before?.of.number === of.number && before.is.stage === "exact") return {};
    const own = sceneOf(line.state);
    const scene = isWithoutFloor(line.state) ? withFloorBefore(own, before?.is.scene ?? null) : own;
    const picture: Of<Picture> = { of, is: { stage: "pillars", scene } };
    // While the critical state itself is being solved, this state is the best estimate of it.
    const estimate = isCritical(of.load) ? { of, is: line.state.summary } : state.estimate;
    return { picture, estimate: known ? null : estimate, refusal: null };
  }
  if (line.state) {
    const scene = sceneOf(line.state);
    const largest = state.largestForce;
    // Colours keep their scale while the load changes, and begin anew at the critical state.
    const goesOn = !isCritical(of.load) && largest?.of.name === of.name;
    const force = Math.max(goesOn ? largest.is : 0, largestForceOf(scene));
    return {
      picture: { of, is: { stage: "exact", scene } },
      solved: { of, is: line.state },
      largestForce: { of, is: force },
      // Of a cycle it is the critical state, while the rest is being solved.
      cycle: sticks(of.case) && state.cycle?.of.number === of.number ? state.cycle : null,
      estimate: known ? null : state.estimate,
      lastTime: now - since,
      refusal: null,
    };
  }
  if (line.summary) {
    const { solved } = state;
    if (solved?.of.number !== of.number) return {};
    const warnings = line.warnings ?? solved.is.warnings;
    return { solved: { of, is: { ...solved.is, summary: line.summary, warnings } } };
  }
  if (line.critical) {
    const critical = { of, is: line.critical };
    return { critical, estimate: null, ...(!known && { criticalBefore: state.critical }) };
  }
  if (line.case) return { texts: { of, is: line.case } };
  if (line.section !== undefined) return { section: { of, is: line.section } };
  return {};
}

/** A line of a cycle. */
function cycleLine(state: State, of: Question, since: number, line: Line, now: number): Partial<State> {
  const critical = knownCritical(state, of);
  if (line.transition) {
    if (critical === null) return {};
    return { phase: { of, is: { transition: line.transition, path: [], critical } } };
  }
  const own = state.cycle?.of.number === of.number ? state.cycle.is : null;
  const before: Cycle = own ?? { curve: [], solved: null, states: [] };
  if (line.curve) {
    return { cycle: { of, is: { ...before, curve: [...before.curve, ...line.curve] } } };
  }
  if (line.cycle) {
    const { phase } = state;
    const path = critical === null ? [] : loadingPath(line.cycle, critical);
    return {
      cycle: { of, is: { ...before, solved: line.cycle } },
      ...(phase?.of.number === of.number && { phase: { of, is: { ...phase.is, path } } }),
      solved: null,
      largestForce: { of, is: line.cycle.largest_force_N },
      lastTime: now - since,
      refusal: null,
    };
  }
  if (!line.station) return {};
  const states = [...before.states, line.station].sort((a, b) => a.load - b.load);
  const cycle = { of, is: { ...before, states } };
  // The first state is that of the load when it was asked for.
  const shows = states.length === 1 || isWhole(cycle);
  return { cycle, ...(shows && shownAt(cycle, state.chosen.load)) };
}

/** What is shown of a cycle at a load. */
function shownAt(cycle: Of<Cycle> | null, load: number): Partial<State> {
  const state = stationAt(cycle, load);
  if (cycle === null || cycle.is.solved === null || state === null) return {};
  const { of } = cycle;
  return {
    picture: { of, is: { stage: "exact", scene: sceneOfStation(cycle.is.solved, state) } },
    section: { of, is: state.section },
  };
}

/** The loading of a cycle as the phase diagram shows it. */
function loadingPath(cycle: SolvedCycle, critical: TransitionSummary): PathState[] {
  const unit = critical.normalized.force / critical.critical_force_N;
  return cycle.summary.stations
    .filter(({ branch, force_N }) => branch === "loading" && force_N > 0)
    .map(({ indentation_m, force_N, contact_radius_m }) => ({
      fraction: Math.min(0.999, indentation_m / critical.critical_indentation_m),
      indentation_m,
      force_N,
      floor_force_N: null,
      normalized: [contact_radius_m / cycle.pitch_m, force_N * unit],
    }));
}

function phaseLine(state: State, of: Question, line: Line): Partial<State> {
  const critical = knownCritical(state, of);
  const phase = state.phase;
  if (line.transition && critical !== null) {
    return { phase: { of, is: { transition: line.transition, path: [], critical } } };
  }
  if (line.path && phase?.of.number === of.number) {
    const path = [...phase.is.path, line.path].sort((a, b) => a.fraction - b.fraction);
    return { phase: { of, is: { ...phase.is, path } } };
  }
  return {};
}

function curvesLine(state: State, of: Question, line: Line): Partial<State> {
  if (line.formulas) {
    const { small_contact: small, large_contact: large } = line.formulas;
    return { curves: { of, is: { small, large, homogenised: [], exact: [] } } };
  }
  const curves = state.curves;
  if (curves?.of.number !== of.number) return {};
  if (line.homogenised) return { curves: { of, is: { ...curves.is, homogenised: line.homogenised } } };
  if (line.point) {
    const exact = [...curves.is.exact, line.point];
    exact.sort((a, b) => a.surface_fraction - b.surface_fraction);
    return { curves: { of, is: { ...curves.is, exact } } };
  }
  return {};
}
