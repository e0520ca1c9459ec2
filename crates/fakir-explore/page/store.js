// The state of the page, and the only functions that change it.
//
// Every change of the case or the load makes a new question, with a number. Each answer is stored with its question, so
// that results of the newest question are distinguished from older ones.

import { largestForceOf, sceneOf, sceneOfPreview, sceneOfStation, withFloorBefore } from "./scene.js";

/**
 * @import {
 *   Background, ContactState, CurvePoint, CurveStation, ExpectedCells, Fitted, History, Kind, Line, Measured, PathState, Point,
 *   PressSummary, Progress, Refusal, Section, SolvedCycle, Start, StationState, Texts, TransitionSummary, Value, Values,
 * } from "./engine.js"
 * @import { Scene } from "./scene.js"
 */

export const FRACTION = "pattern.surface_fraction";
export const FLOOR = "floor.contact";
export const PITCH = "pattern.pitch";
export const PILLARS = "pattern.pillars";
/** Its columns and their unit, if its headings do not name them. */
const TABLE_COLUMNS = "pattern.pillar_columns";
const TABLE_UNIT = "pattern.pillar_unit";
/** The lattice of pillars that a table lists. */
export const LISTED = "listed";
export const LATTICE = "pattern.lattice";
const PITCH_Y = "pattern.pitch_y";
const LATTICE_ANGLE = "pattern.lattice_angle";
const DIAMETER = "pattern.pillar.diameter";
export const WORK = "adhesion.work";
export const RECEDING = "adhesion.work_receding";
export const ADHESIVE_FLOOR = "adhesion.floor";
export const STRENGTHS = "relaxation.strengths";
export const TIMES = "relaxation.times";

/**
 * Strength and time of the first term of bodies that begin to relax.
 * @type {Readonly<Record<string, string>>}
 */
const FIRST_TERM = { [STRENGTHS]: "1", [TIMES]: "10 s" };

/** Flat surfaces, the radius of rounded tops, and the shape of the lens. */
export const FLAT = "surface.flat";
export const TOP_RADIUS = "pattern.top_radius";
const COLUMNS = "pattern.columns";
const SHAPE = "lens.shape";
const RADIUS = "lens.radius";

/** Columns of an array of pillars that must be finite, unless they are given: its critical state takes seconds at most. */
const FEW_COLUMNS = 15;

/** Lenses that are closest to the floor outside of the pillars, so that there is no critical state, under finitely many pillars. */
const WITHOUT_AXIS = ["cylinder", "plate"];

/** The load of the last release. With adhesion, loads from 1 to this value are those of unloading. */
const LAST_RELEASE = 2;

/**
 * What the user has chosen.
 * @typedef {object} Chosen
 * @property {Values} case
 * @property {number} load The load as a fraction of the way from first contact to the critical state. Above 1 it is
 *   beyond the critical state or, with adhesion, on unloading, with the last release at 2.
 * @property {number | null} exaggeration Exaggeration of heights in the section; null to fill the view.
 * @property {Hold | null} hold The load that is held over time, on viscoelastic bodies; null to show contacts without time.
 * @property {number | null} time The time that is shown, s; null if the load was chosen by itself.
 * @property {MapView | null} view The part of the map that is shown; null for the whole map.
 */

/**
 * A load that is reached in a time and then held.
 * @typedef {object} Hold
 * @property {"indentation" | "force"} by
 * @property {number} load Indentation, m, or force, N.
 * @property {number} ramp_s
 * @property {number} hold_s
 */

/**
 * The load over time: the last history, and the name of the question that is being answered or was answered.
 * @typedef {object} OverTime
 * @property {string} name
 * @property {History | null} is
 * @property {string} words What is being done, or why there is no history.
 */

/**
 * A part of the map.
 * @typedef {object} MapView
 * @property {number} zoom Magnification, above 1.
 * @property {number} x Its centre relative to the lens axis, m.
 * @property {number} y
 */

/**
 * A case and a load that the server has to solve.
 * @typedef {object} Question
 * @property {number} number
 * @property {Values} case
 * @property {string} name The case as text: two questions are about the same case if their names are equal.
 * @property {number} load
 * @property {number} asked Time of the change that led to this question, ms.
 */

/**
 * A result, and the question that it answers.
 * @template T
 * @typedef {object} Of
 * @property {Question} of
 * @property {T} is
 */

/**
 * Origin of a map: the homogenised lattice (`estimate`), the punch lattice or a solution without the floor
 * (`pillars`), or the method of the case (`exact`).
 * @typedef {"estimate" | "pillars" | "exact"} Stage
 */

/**
 * A contact map.
 * @typedef {object} Picture
 * @property {Stage} stage
 * @property {Scene} scene
 */

/**
 * An estimate of the critical state, which is shown until it is solved.
 * @typedef {object} Estimate
 * @property {number} force_N
 * @property {number} contact_radius_m
 * @property {number} indentation_m
 */

/**
 * The phase diagram.
 * @typedef {object} Phase
 * @property {readonly Point[]} transition
 * @property {readonly PathState[]} path States of the loading, in order of increasing load.
 * @property {TransitionSummary | null} critical The critical state of the same case, if there is one.
 * @property {readonly Point[]} unloading Indentations, m, and forces, N, of unloading, where they differ from those of loading.
 */

/**
 * The indentation to which loads are relative where there is no critical state.
 * @typedef {object} LoadScale
 * @property {number} indentation_m
 * @property {string} why Why there is none.
 */

/**
 * Critical states against the surface fraction.
 * @typedef {object} Curves
 * @property {readonly CurvePoint[]} small
 * @property {readonly CurvePoint[]} large
 * @property {readonly CurvePoint[]} homogenised
 * @property {readonly CurvePoint[]} exact The solved critical states, sorted by surface fraction.
 */

/**
 * A cycle of loading and unloading with adhesion.
 * @typedef {object} Cycle
 * @property {readonly CurveStation[]} curve The part of the curve that has been computed.
 * @property {SolvedCycle | null} solved The cycle, once it is solved.
 * @property {readonly StationState[]} states The states received so far, in order.
 */

/**
 * A question in progress, and the time at which it was sent, ms.
 * @typedef {object} Asking
 * @property {Question} question
 * @property {number} since
 */

/** @typedef {"export" | "link" | keyof Texts} Notice */

/**
 * A table of pillars; `number` distinguishes tables of one name.
 * @typedef {object} Table
 * @property {string} name
 * @property {string} base64
 * @property {number} number
 */

/**
 * @typedef {object} Parts
 * @property {Start} start
 * @property {Chosen} chosen
 * @property {string | null} typed Key of the field whose text stays as it was typed.
 * @property {Question} question The newest question.
 * @property {number} sent Number of the newest question that was sent.
 * @property {{ [kind in Kind]: Asking | null }} asking The question of each kind that the server is answering.
 * @property {number} lastTime How long the last picture took, ms.
 * @property {Question | null} reference The newest question that has a result shown, is overdue or was refused.
 *   Results of older questions are greyed out.
 * @property {Of<Picture> | null} picture The contact map that is shown.
 * @property {Of<ContactState> | null} solved The last contact that was solved.
 * @property {Of<TransitionSummary> | null} critical The last critical state that was solved.
 * @property {Of<LoadScale> | null} loadScale The scale of loads of the last case without a critical state.
 * @property {Of<TransitionSummary> | null} criticalBefore The critical state of the previous case, whose map may
 *   still be shown.
 * @property {Of<Estimate> | null} estimate An estimate of a critical state that is not solved yet.
 * @property {Of<number> | null} largestForce The largest force on the colour scale of a case, N.
 * @property {Of<Section | null> | null} section
 * @property {Of<Cycle> | null} cycle Loading and unloading, with adhesion only. It replaces the contact.
 * @property {Of<Texts> | null} texts
 * @property {Of<Progress> | null} progress
 * @property {Of<ExpectedCells> | null} expected Expected grid on an adhesive floor.
 * @property {Question | null} calledOff The last question that the user cancelled.
 * @property {number} elapsed Time since the question was sent, ms.
 * @property {Of<Refusal> | null} refusal
 * @property {Of<Phase> | null} phase
 * @property {Of<Curves> | null} curves
 * @property {{ [kind in Background]: Of<string> | null }} answered Background questions that were answered (empty
 *   text) or refused (the message).
 * @property {{ readonly [about in Notice]?: string }} notices Short messages beside buttons, shown for a moment.
 * @property {Measured | null} measured The measured curve that the user has given.
 * @property {number} contactPoint Position of the measured curve at which the lens is level with the pillar tops, m.
 * @property {Table | null} table The table of pillars that the user has given.
 * @property {Fitted | null} fitted The fit of the measured curve.
 * @property {string} dataWords How reading or fitting of the curve went.
 * @property {OverTime | null} history The load that is held over time.
 * @property {State | null} pinned The state of the case that stays beside the present one.
 * @property {{ then: Chosen | null } | null} pinning Whether the present case is to be pinned once it is complete, and what is chosen
 *   afterwards.
 * @property {string} announcement The text that screen readers read out.
 */

/**
 * The state: a change makes a new one.
 * @typedef {Readonly<Parts>} State
 */

export class Store {
  /** @type {State} */
  #state;
  /** @type {(() => void)[]} */
  #listeners = [];
  /** Keys of the pillars before the surface became flat. @type {Values} */
  #pillars = {};

  /**
   * @param {Start} start
   * @param {Chosen} first
   * @param {number} asked
   */
  constructor(start, first, asked) {
    const chosen = { ...first, load: within(first.load, first.case, start) };
    const table = start.table && { ...start.table, number: 1 };
    this.#state = {
      start,
      chosen,
      typed: null,
      question: newQuestion(1, chosen, asked, table),
      sent: 0,
      asking: { contact: null, curves: null, phase: null },
      lastTime: 100,
      reference: null,
      picture: null,
      solved: null,
      critical: null,
      loadScale: null,
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
      measured: null,
      contactPoint: 0,
      fitted: null,
      dataWords: "",
      table,
      history: null,
      pinned: null,
      pinning: null,
      announcement: "",
    };
  }

  /** @returns {State} */
  get state() {
    return this.#state;
  }

  /**
   * `listener` is called after every change.
   * @param {() => void} listener
   */
  listen(listener) {
    this.#listeners.push(listener);
  }

  /** @param {Partial<State>} part */
  #change(part) {
    this.#state = { ...this.#state, ...part };
    for (const listener of this.#listeners) listener();
  }

  // --- Changes by the user ---

  /**
   * Changes what the user has chosen; the rest stays. `asked` is the time of the change, ms.
   * @param {Partial<Chosen>} choice
   * @param {number} asked
   * @param {string | null} [typed]
   */
  choose(choice, asked, typed = null) {
    const before = this.#state.chosen;
    const values = choice.case ?? before.case;
    const [previous, turned] = [choice.load ?? before.load, isCycle(values) !== isCycle(before.case)];
    // A load above 1 is beyond the critical state without adhesion, and on unloading with it.
    const load = within(turned && choice.load === undefined ? Math.min(1, previous) : previous, values, this.#state.start);
    // A load that is chosen by itself belongs to no time.
    const moved = choice.load !== undefined && choice.time === undefined;
    const chosen = { ...before, ...choice, load, ...(moved && { time: null }) };
    if (choice.case === undefined && choice.load === undefined) {
      this.#change({ chosen });
      return;
    }
    if (choice.case === undefined && isCycle(values)) {
      // All states of the cycle have arrived, or will.
      this.#change({ chosen, ...shownAt(this.#state.cycle, load) });
      return;
    }
    const question = newQuestion(this.#state.question.number + 1, chosen, asked, this.#state.table);
    this.#change({ chosen, typed, question });
  }

  /**
   * Sets a key of the case; `typed` if the text of its field must stay as written.
   * @param {string} key
   * @param {Value} value
   * @param {boolean} typed
   * @param {number} asked
   */
  setValue(key, value, typed, asked) {
    const values = { ...this.#state.chosen.case };
    for (const other of this.#state.start.keys) {
      const condition = other.goes_with;
      const leaves = condition?.key === key && !condition.words.includes(String(value));
      if (other.alternative === key || leaves) delete values[other.key];
    }
    values[key] = value;
    if (key === FLAT) this.#makeFlat(values, String(value) === "true");
    if (key === SHAPE && !WITHOUT_AXIS.includes(String(value))) values[RADIUS] ??= this.#state.start.paper[RADIUS] ?? 1e-3;
    if (key === SHAPE && value === "cylinder") values[RADIUS] ??= this.#state.start.paper[RADIUS] ?? 1e-3;
    const isFinite = isRounded(values) || WITHOUT_AXIS.includes(String(values[SHAPE]));
    if ((key === TOP_RADIUS || key === SHAPE) && isFinite && !isFlat(values) && values[PILLARS] === undefined) values[COLUMNS] ??= FEW_COLUMNS;
    const wasAdded = values[COLUMNS] === FEW_COLUMNS && this.#state.start.case[COLUMNS] === undefined;
    if ((key === TOP_RADIUS || key === SHAPE) && !isFinite && wasAdded) delete values[COLUMNS];
    if (key === LATTICE) Object.assign(values, spacingOn(String(value), this.#state.chosen.case));
    if (values[PILLARS] !== undefined && value !== LISTED && key === LATTICE) {
      // Without a table the pattern is that of the first case, as far as it is not given.
      delete values[PILLARS];
      for (const [own, first] of Object.entries(this.#state.start.case)) {
        if (own.startsWith("pattern.") && own !== LATTICE) values[own] ??= first;
      }
      if (values[PITCH] !== undefined) delete values[FRACTION];
    }
    // Without adhesion neither its work on unloading nor the adhesion of the floor has a meaning.
    if (key === WORK && value === 0) {
      delete values[RECEDING];
      delete values[ADHESIVE_FLOOR];
    }
    // A floor whose contact is ignored is not adhesive.
    if (key === FLOOR && value === "false") delete values[ADHESIVE_FLOOR];
    // A term has a strength and a time; without one of them the bodies are elastic.
    for (const [one, other] of [[STRENGTHS, TIMES], [TIMES, STRENGTHS]]) {
      if (key !== one || one === undefined || other === undefined) continue;
      if (value === "") {
        delete values[one];
        delete values[other];
      } else {
        values[other] ??= FIRST_TERM[other] ?? "";
      }
    }
    const isInfinite = this.#state.start.keys.some((known) => known.key === key && known.infinite);
    if (key === FLAT && value !== "true") delete values[FLAT];
    const isOptional = [STRENGTHS, TIMES, WORK, RECEDING, TABLE_COLUMNS, TABLE_UNIT].includes(key);
    const isEmptied = value === "" && (isOptional || isInfinite);
    if (isEmptied) delete values[key];
    this.choose({ case: values }, asked, typed && !isEmptied ? key : null);
  }

  /**
   * Removes what belongs to pillars, or brings it back.
   * @param {Values} values
   * @param {boolean} isFlat
   */
  #makeFlat(values, isFlat) {
    const { keys, case: first, paper } = this.#state.start;
    const ofPillars = keys.filter(({ on_flat }) => !on_flat).map(({ key }) => key);
    ofPillars.push(PILLARS);
    if (isFlat) {
      this.#pillars = {};
      for (const key of ofPillars) {
        if (values[key] !== undefined) this.#pillars[key] = values[key];
        delete values[key];
      }
      if (!WITHOUT_AXIS.includes(String(values[SHAPE]))) return;
      delete values[SHAPE];
      values[RADIUS] ??= paper[RADIUS] ?? 1e-3;
      return;
    }
    const source = [this.#pillars, first, paper].find((source) => ofPillars.some((key) => source[key] !== undefined)) ?? {};
    for (const key of ofPillars) if (source[key] !== undefined) values[key] = source[key];
  }

  /** Cancels the question in progress. Results received so far stay. */
  callOff() {
    const under = this.#state.asking.contact?.question;
    if (under !== undefined) this.#change({ calledOff: under });
  }

  /**
   * Sends the same question again.
   * @param {number} asked
   */
  requestAgain(asked) {
    this.choose({ case: this.#state.chosen.case }, asked);
  }

  /**
   * Shows a message beside a button, or removes it.
   * @param {Notice} about
   * @param {string | null} words
   */
  notify(about, words) {
    const notices = { ...this.#state.notices };
    if (words === null) delete notices[about];
    else notices[about] = words;
    this.#change({ notices });
  }

  /**
   * Changes what belongs to the measured curve.
   * @param {Partial<Pick<State, "measured" | "contactPoint" | "fitted" | "dataWords">>} part
   */
  setData(part) {
    this.#change(part);
  }

  /**
   * Pins the present case once it is complete; `then` is chosen afterwards.
   * @param {Chosen | null} then
   */
  pinWhenComplete(then) {
    this.#change({ pinning: { then }, pinned: null });
  }

  /**
   * Keeps a state beside those that follow.
   * @param {State} state
   */
  pin(state) {
    this.#change({ pinning: null, pinned: { ...state, pinned: null, pinning: null } });
  }

  /** Removes the pinned case. */
  unpin() {
    this.#change({ pinning: null, pinned: null });
  }

  /** @param {OverTime | null} history */
  setHistory(history) {
    if (history !== this.#state.history) this.#change({ history });
  }

  /** @param {Table} table */
  setTable(table) {
    this.#change({ table });
  }

  /** @param {string} announcement */
  announce(announcement) {
    this.#change({ announcement });
  }

  // --- Answers of the server ---

  /**
   * Records that a question has been sent.
   * @param {Kind} kind
   * @param {Question} question
   * @param {number} now
   */
  send(kind, question, now) {
    const asking = { ...this.#state.asking, [kind]: { question, since: now } };
    this.#change(
      kind === "contact" ? { asking, sent: question.number, progress: null, elapsed: 0 } : { asking },
    );
  }

  /**
   * Updates the elapsed time.
   * @param {number} now
   */
  tick(now) {
    const asking = this.#state.asking.contact;
    if (asking !== null) this.#change({ elapsed: now - asking.since });
  }

  /**
   * Handles a line of the answer to a question. Lines of a cancelled question are dropped.
   * @param {Kind} kind
   * @param {number} number
   * @param {Line} line
   * @param {number} now
   */
  receive(kind, number, line, now) {
    const asking = this.#state.asking[kind];
    if (asking === null || asking.question.number !== number) return;
    const taken = {
      contact: () => contactLine(this.#state, asking, line, now),
      phase: () => phaseLine(this.#state, asking.question, line),
      curves: () => curvesLine(this.#state, asking.question, line),
    }[kind]();
    // Results of an older case or load are greyed out at the same moment.
    const isShown = Object.keys(taken).some((part) => part !== "progress" && part !== "expected");
    const reference = newer(this.#state.reference, asking.question);
    this.#change(isShown ? { ...taken, reference } : taken);
  }

  /**
   * Handles the end of an answer: `whole` if the question was not cancelled, `refusal` if it was refused.
   * @param {Kind} kind
   * @param {number} number
   * @param {boolean} whole
   * @param {Refusal | null} refusal
   */
  end(kind, number, whole, refusal) {
    const state = this.#state;
    const of = state.asking[kind]?.question;
    if (of === undefined || of.number !== number) return;
    const asking = { ...state.asking, [kind]: null };
    if (kind !== "contact") {
      const words = refusal?.message ?? "";
      const done = whole || refusal !== null;
      const answered = { ...state.answered, ...(done && { [kind]: { of, is: words } }) };
      // A refused question has no result that would replace that of an older case.
      const isOfBefore = refusal !== null && state[kind]?.of.name !== of.name;
      this.#change({ asking, answered, ...(isOfBefore && { [kind]: null }) });
    } else if (refusal !== null) {
      const reference = newer(state.reference, of);
      this.#change({ asking, reference, progress: null, refusal: { of, is: refusal } });
    } else {
      this.#change({ asking, progress: null });
    }
  }

  /**
   * Greys out older results because a question has been open for too long.
   * @param {Question} question
   */
  overdue(question) {
    const reference = newer(this.#state.reference, question);
    if (reference !== this.#state.reference) this.#change({ reference });
  }
}

// --- Derived from the state ---

/**
 * Whether the newest question is not answered yet.
 * @param {State} state
 * @returns {boolean}
 */
export function isBusy(state) {
  return state.sent < state.question.number || state.asking.contact !== null;
}

/**
 * Whether a result belongs to an older case or, if it depends on the load, to an older load.
 * @param {State} state
 * @param {Of<unknown> | null} shown
 * @param {"case" | "load"} dependsOn
 * @returns {boolean}
 */
export function isOlder({ reference }, shown, dependsOn) {
  if (shown === null || reference === null || shown.of.number >= reference.number) return false;
  const sameLoad = dependsOn === "case" || shown.of.load === reference.load;
  return shown.of.name !== reference.name || !sameLoad;
}

/**
 * The surface fraction at which pillars touch each other: the pitch equals their diameter.
 * @param {Value | undefined} lattice
 * @returns {number}
 */
function densest(lattice) {
  return lattice === "square" ? Math.PI / 4 : Math.PI / Math.sqrt(12);
}

/**
 * Adds surface fraction or pitch, whichever is not given, to a case on a lattice with one pitch.
 * @param {Values} values
 * @returns {Values}
 */
export function withSpacing(values) {
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

/**
 * Keys that a new lattice needs, derived from the previous one: its pitch along both directions, and an angle of 60
 * degrees.
 * @param {string} lattice
 * @param {Values} before
 * @returns {Values}
 */
function spacingOn(lattice, before) {
  if (lattice !== "rectangular" && lattice !== "oblique") return {};
  const pitch = withSpacing(before)[PITCH];
  /** @type {Values} */
  const own = pitch === undefined ? {} : { [PITCH]: pitch, [PITCH_Y]: before[PITCH_Y] ?? pitch };
  if (lattice === "oblique") own[LATTICE_ANGLE] = Math.PI / 3;
  return own;
}

/**
 * Rounds a derived value to the digits that are shown.
 * @param {number} value
 * @returns {number}
 */
function rounded(value) {
  return Number(value.toPrecision(6));
}

/**
 * Whether the surface is flat, without pillars.
 * @param {Values} values
 * @returns {boolean}
 */
export function isFlat(values) {
  return String(values[FLAT] ?? "false") === "true";
}

/**
 * Whether pillars have rounded tops.
 * @param {Values} values
 * @returns {boolean}
 */
export function isRounded(values) {
  return (values[TOP_RADIUS] ?? "") !== "";
}

/**
 * Whether there is a critical state, to which loads are relative.
 * @param {Values} values
 * @returns {boolean}
 */
export function hasCritical(values) {
  return !isFlat(values) && !WITHOUT_AXIS.includes(String(values[SHAPE] ?? ""));
}

/**
 * Whether pillars have flat tops and the lens reaches the floor among them: of these the page shows whole cycles, loads over time and phase
 * diagrams.
 * @param {Values} values
 * @returns {boolean}
 */
export function hasFlatTops(values) {
  return hasCritical(values) && !isRounded(values);
}

/**
 * Whether contacts are adhesive.
 * @param {Values} values
 * @returns {boolean}
 */
export function isAdhesive(values) {
  return [WORK, RECEDING].some((key) => Number(values[key] ?? 0) !== 0);
}

/**
 * Whether loading and unloading are shown step by step: of adhesive flat tops.
 * @param {Values} values
 * @returns {boolean}
 */
export function isCycle(values) {
  return isAdhesive(values) && hasFlatTops(values);
}

/**
 * Whether the bodies are viscoelastic and their contact is shown over time.
 * @param {Values} values
 * @returns {boolean}
 */
export function isRelaxing(values) {
  return hasFlatTops(values) && [STRENGTHS, TIMES].every((key) => (values[key] ?? "") !== "");
}

/**
 * Whether the floor is adhesive too.
 * @param {Values} values
 * @returns {boolean}
 */
export function hasAdhesiveFloor(values) {
  return isCycle(values) && String(values[ADHESIVE_FLOOR] ?? "false") === "true";
}

/**
 * The field at which a refused case is wrong: that of the only key changed since the last solved case, or else that of
 * the key which the server names; null if it names none.
 * @param {State} state
 * @returns {string | null}
 */
export function refusedAt({ refusal, critical }) {
  if (refusal === null || refusal.is.key === null) return null;
  const [now, before] = [refusal.of.case, critical?.of.case ?? {}];
  const changed = Object.keys(now).filter((key) => now[key] !== before[key]);
  return (changed.length === 1 ? changed[0] : undefined) ?? refusal.is.key;
}

/**
 * Whether the user cancelled the newest question.
 * @param {State} state
 * @returns {boolean}
 */
export function isCalledOff({ calledOff, question }) {
  return calledOff?.number === question.number;
}

/**
 * Whether a state of a cycle is the critical state: the last one before the jump onto an adhesive floor, or the one
 * where unloading starts.
 * @param {SolvedCycle} solvedCycle
 * @param {StationState} stationState
 * @returns {boolean}
 */
export function isCriticalStation({ summary }, { place, load }) {
  const jump = summary.floor?.jump ?? null;
  return jump === null ? load === 1 : place === jump.station - 1;
}

/**
 * The state of a cycle nearest to a load; null while there is none.
 * @param {Of<Cycle> | null} cycle
 * @param {number} load
 * @returns {StationState | null}
 */
export function stationAt(cycle, load) {
  /** @type {(state: StationState) => number} */
  const distance = (state) => Math.abs(state.load - load);
  return (cycle?.is.states ?? []).reduce(
    (nearest, state) => (nearest === null || distance(state) < distance(nearest) ? state : nearest),
    /** @type {StationState | null} */ (null),
  );
}

/**
 * Whether all states of a cycle have arrived.
 * @param {Of<Cycle> | null} cycle
 * @returns {cycle is Of<Cycle> & { is: { solved: SolvedCycle } }}
 */
export function isWhole(cycle) {
  return cycle !== null && cycle.is.solved !== null && cycle.is.states.length === cycle.is.solved.states;
}

/**
 * The critical state for a question; null if it is not solved yet.
 * @param {State} state
 * @param {Question} question
 * @returns {TransitionSummary | null}
 */
export function knownCritical({ critical }, { name }) {
  return critical?.of.name === name ? critical.is : null;
}

/**
 * The scales of the map: the critical contact radius, m, where it is known or estimated, and the largest force on the
 * colour scale, N.
 * @param {State} state
 * @param {Of<Picture>} picture
 * @returns {{ radius: number, force: number }}
 */
export function mapScale(state, { of, is }) {
  const estimate = state.estimate?.of.name === of.name ? state.estimate.is : null;
  const criticals = [state.critical, state.criticalBefore];
  const known = criticals.find((each) => each?.of.name === of.name)?.is.critical_contact_radius_m;
  const largest = state.largestForce?.of.name === of.name ? state.largestForce.is : 0;
  return {
    radius: known ?? estimate?.contact_radius_m ?? 0,
    force: Math.max(largest, largestForceOf(is.scene)),
  };
}

/**
 * @param {number} fraction
 * @returns {boolean}
 */
export function isCritical(fraction) {
  return Math.abs(fraction - 1) < 1e-9;
}

/**
 * Whether floor contact is computed beyond the transition, which only the spectral method supports; otherwise it is
 * ignored.
 * @param {Values} values
 * @returns {boolean}
 */
export function floorCarriesLoad(values) {
  /** @type {(key: string, word: string) => boolean} */
  const isOf = (key, word) => (values[key] ?? word) === word;
  return isOf(FLOOR, "true") && isOf("method.name", "spectral") && !(isRounded(values) && isAdhesive(values));
}

/**
 * Whether a state is computed without the floor; the one with the floor follows.
 * @param {ContactState} contactState
 * @returns {boolean}
 */
export function isWithoutFloor({ approximate, summary }) {
  return approximate && summary.method === "spectral";
}

/**
 * @param {number} fraction
 * @returns {boolean}
 */
export function isBeyond(fraction) {
  return fraction > 1 + 1e-9;
}

// --- Transitions between states ---

/**
 * @param {number} number
 * @param {Chosen} chosen
 * @param {number} asked
 * @param {Table | null} table
 * @returns {Question}
 */
function newQuestion(number, chosen, asked, table) {
  const { case: values, load } = chosen;
  const version = values[PILLARS] === undefined ? "" : String(table?.number ?? 0);
  return { number, case: values, name: `${JSON.stringify(values)}${version}`, load, asked };
}

/**
 * The part of a question that contains the table of pillars, if the case has one.
 * @param {Pick<State, "table">} state
 * @param {Values} values
 * @returns {{ table?: { name: string, base64: string } }}
 */
export function tableOf({ table }, values) {
  if (table === null || values[PILLARS] !== table.name) return {};
  return { table: { name: table.name, base64: table.base64 } };
}

/**
 * The load nearest to `load` on the slider; the critical one if `load` is not a number.
 * @param {number} load
 * @param {Values} values
 * @param {Start} start
 * @returns {number}
 */
function within(load, values, { farthest_load }) {
  const farthest = isCycle(values) ? LAST_RELEASE : farthest_load;
  return Number.isFinite(load) ? Math.min(farthest, Math.max(0, load)) : 1;
}

/**
 * @param {Question | null} a
 * @param {Question} b
 * @returns {Question}
 */
function newer(a, b) {
  return a !== null && a.number > b.number ? a : b;
}

/**
 * @param {State} state
 * @param {Asking} asking
 * @param {Line} line
 * @param {number} now
 * @returns {Partial<State>}
 */
function contactLine(state, { question: of, since }, line, now) {
  const known = knownCritical(state, of) !== null;
  if (line.progress) return { progress: { of, is: line.progress } };
  if (line.reference) {
    return { loadScale: { of, is: line.reference }, critical: null, criticalBefore: null, estimate: null };
  }
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
    // This line was delayed, and the state with the floor has arrived already.
    if (before?.of.number === of.number && before.is.stage === "exact") return {};
    const own = sceneOf({ ...line.state, summary: withPartial(line.state.summary) });
    const scene = isWithoutFloor(line.state) ? withFloorBefore(own, before?.is.scene ?? null) : own;
    /** @type {Of<Picture>} */
    const picture = { of, is: { stage: "pillars", scene } };
    // While the critical state itself is being solved, this state is the best estimate of it.
    const isEstimate = isCritical(of.load) && line.state.fraction !== null;
    const estimate = isEstimate ? { of, is: line.state.summary } : state.estimate;
    return { picture, estimate: known ? null : estimate, refusal: null };
  }
  if (line.state) {
    const solved = { ...line.state, summary: withPartial(line.state.summary) };
    const scene = sceneOf(solved);
    const largest = state.largestForce;
    // The colour scale is kept while the load changes, and reset at the critical state.
    const continues = !isCritical(of.load) && largest?.of.name === of.name;
    const force = Math.max(continues ? largest.is : 0, largestForceOf(scene));
    return {
      picture: { of, is: { stage: "exact", scene } },
      solved: { of, is: solved },
      largestForce: { of, is: force },
      // In a cycle this is the critical state; the rest is still being solved.
      cycle: isCycle(of.case) && state.cycle?.of.number === of.number ? state.cycle : null,
      estimate: known || !hasCritical(of.case) ? null : state.estimate,
      lastTime: now - since,
      refusal: null,
    };
  }
  if (line.summary) {
    const { solved } = state;
    if (solved?.of.number !== of.number) return {};
    const warnings = line.warnings ?? solved.is.warnings;
    return { solved: { of, is: { ...solved.is, summary: withPartial(line.summary), warnings } } };
  }
  if (line.critical) {
    const critical = { of, is: withPartial(line.critical) };
    return { critical, loadScale: null, estimate: null, ...(!known && { criticalBefore: state.critical }) };
  }
  if (line.case) return { texts: { of, is: line.case } };
  if (line.section !== undefined) return { section: { of, is: line.section } };
  return {};
}

/**
 * The summary of a state, whose numbers have the same names on all surfaces: relative errors, and pillars partially in contact. With rounded tops
 * the error of the indentation is a length, and tops that are fully in contact are counted.
 * @template {PressSummary | TransitionSummary} T
 * @param {T} summary
 * @returns {T}
 */
function withPartial(summary) {
  const { pillars_in_contact: all, pillars_fully_in_contact: full, relative_error_estimate: error } = summary;
  const indentation = "indentation_m" in summary ? summary.indentation_m : summary.critical_indentation_m;
  const part = full === undefined ? summary.pillars_partially_in_contact : all - full;
  const relative = error?.indentation ?? (error?.indentation_m === undefined ? null : error.indentation_m / Math.abs(indentation || 1));
  return {
    ...summary,
    pillars_partially_in_contact: part,
    relative_error_estimate: { ...error, force: error?.force ?? null, indentation: relative, contact_radius: error?.contact_radius ?? null },
  };
}

/**
 * Handles a line of a cycle.
 * @param {State} state
 * @param {Question} of
 * @param {number} since
 * @param {Line} line
 * @param {number} now
 * @returns {Partial<State>}
 */
function cycleLine(state, of, since, line, now) {
  const critical = knownCritical(state, of);
  if (line.transition) {
    if (critical === null) return {};
    return { phase: { of, is: { transition: line.transition, path: [], unloading: [], critical } } };
  }
  const own = state.cycle?.of.number === of.number ? state.cycle.is : null;
  /** @type {Cycle} */
  const before = own ?? { curve: [], solved: null, states: [] };
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
  // The first state received is that of the load when the question was sent.
  const shows = states.length === 1 || isWhole(cycle);
  return { cycle, ...(shows && shownAt(cycle, state.chosen.load)) };
}

/**
 * The picture and the section of a cycle at a load.
 * @param {Of<Cycle> | null} cycle
 * @param {number} load
 * @returns {Partial<State>}
 */
function shownAt(cycle, load) {
  const state = stationAt(cycle, load);
  if (cycle === null || cycle.is.solved === null || state === null) return {};
  const { of } = cycle;
  return {
    picture: { of, is: { stage: "exact", scene: sceneOfStation(cycle.is.solved, state) } },
    section: { of, is: state.section },
  };
}

/**
 * The loading of a cycle as a path in the phase diagram.
 * @param {SolvedCycle} cycle
 * @param {TransitionSummary} critical
 * @returns {PathState[]}
 */
function loadingPath(cycle, critical) {
  const unit = (critical.normalized?.force ?? NaN) / critical.critical_force_N;
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

/**
 * @param {State} state
 * @param {Question} of
 * @param {Line} line
 * @returns {Partial<State>}
 */
function phaseLine(state, of, line) {
  const critical = knownCritical(state, of);
  const phase = state.phase;
  if (line.transition && (critical !== null || state.loadScale?.of.name === of.name)) {
    return { phase: { of, is: { transition: line.transition, path: [], unloading: [], critical } } };
  }
  if (line.unloading && phase?.of.number === of.number) {
    return { phase: { of, is: { ...phase.is, unloading: line.unloading } } };
  }
  if (line.path && phase?.of.number === of.number) {
    const path = [...phase.is.path, line.path].sort((a, b) => a.fraction - b.fraction);
    return { phase: { of, is: { ...phase.is, path } } };
  }
  return {};
}

/**
 * @param {State} state
 * @param {Question} of
 * @param {Line} line
 * @returns {Partial<State>}
 */
function curvesLine(state, of, line) {
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
