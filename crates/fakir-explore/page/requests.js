// Sends the questions of the store to the engine, and puts the answers into the store.

import { Refused } from "./engine.js";
import { isBusy, hasCritical, hasFlatTops, isWithoutFloor, knownCritical, isCycle, tableOf } from "./store.js";

/**
 * @import { ApiPath, Background, Engine, Kind, Refusal } from "./engine.js"
 * @import { Question, Store } from "./store.js"
 */

/**
 * Bounds of the time, ms, after which a computation is cancelled for a newer one. Shorter ones are shown, so that the
 * picture follows a moving slider.
 */
const GRACE = /** @type {const} */ ([120, 700]);

/** Background questions are sent when nothing has changed for this time, ms. */
const CALM = 200;

/**
 * Older results are greyed out this long after a change, ms, or with the first new result, so that results of two
 * cases never look alike.
 */
const OVERDUE = 200;

/** The elapsed time of a cycle is updated at this interval, ms. */
const TICK = 200;

/** A state without the floor is shown if the floor is not solved within this time, ms. */
const WITHOUT_FLOOR = 60;

/** @type {readonly Background[]} */
const BACKGROUND = ["phase", "curves"];

/**
 * Starts sending the questions of the store.
 * @param {Store} store
 * @param {Engine} engine
 */
export function answerQuestions(store, engine) {
  let newest = 0;
  /** @type {number | undefined} */
  let calm;

  function follow() {
    const { question } = store.state;
    if (question.number > newest) {
      newest = question.number;
      begin(question);
    }
    callOffSketched();
    const { asking, calledOff, sent } = store.state;
    if (calledOff !== null && asking.contact?.question.number === calledOff.number) engine.cancel("contact");
    if (asking.contact === null && sent < question.number) void contact(question);
  }

  /**
   * Handles a new question.
   * @param {Question} question
   */
  function begin(question) {
    window.clearTimeout(calm);
    window.setTimeout(() => store.overdue(question), OVERDUE);
    const { asking, lastTime } = store.state;
    for (const kind of BACKGROUND) {
      if (asking[kind] !== null && asking[kind].question.name !== question.name) engine.cancel(kind);
    }
    if (asking.contact === null) return;
    const { question: before, since } = asking.contact;
    const grace = Math.min(GRACE[1], Math.max(GRACE[0], 2 * lastTime));
    window.setTimeout(
      () => callOffLate(before),
      Math.max(0, grace - (performance.now() - since)),
    );
  }

  /**
   * Cancels a question that has an estimated picture, or the first state of a cycle, if there is a newer question.
   */
  function callOffSketched() {
    const { asking, picture, question } = store.state;
    const under = asking.contact?.question;
    if (under === undefined || under.number >= question.number) return;
    const continues = picture?.is.stage !== "exact" || isCycle(under.case);
    if (picture?.of.number === under.number && continues) {
      engine.cancel("contact");
    }
  }

  /**
   * Cancels a question that has no picture yet.
   * @param {Question} question
   */
  function callOffLate(question) {
    const { asking, picture } = store.state;
    if (asking.contact?.question.number !== question.number) return;
    if (picture?.of.number === question.number && picture.is.stage === "exact") return;
    engine.cancel("contact");
  }

  /** @param {Question} question */
  async function contact(question) {
    const known = knownCritical(store.state, question);
    // A cycle can take minutes: its elapsed time is shown meanwhile.
    const clock = isCycle(question.case) ? window.setInterval(() => store.tick(performance.now()), TICK) : undefined;
    await ask("contact", isCycle(question.case) ? "cycle" : "contact", question, {
      case: question.case,
      load: {
        fraction: question.load,
        ...(known && { critical_indentation_m: known.critical_indentation_m }),
      },
    });
    window.clearInterval(clock);
    if (!isBusy(store.state)) calm = window.setTimeout(background, CALM);
  }

  /** Requests curves and phase diagram when no other question is open. */
  function background() {
    const { question, asking, answered } = store.state;
    const critical = knownCritical(store.state, question);
    if (critical === null && hasCritical(question.case)) return;
    const questions = {
      phase: {
        case: question.case,
        load: { fraction: 1, ...(critical && { critical_indentation_m: critical.critical_indentation_m }) },
      },
      curves: { case: question.case },
    };
    /** @type {(values: typeof question.case) => boolean} */
    const loads = (values) => !isCycle(values);
    // With adhesion the phase diagram shows the loading of the cycle.
    for (const kind of BACKGROUND.filter((kind) => (kind === "curves" ? hasFlatTops : loads)(question.case))) {
      const names = [asking[kind]?.question.name, answered[kind]?.of.name];
      if (!names.includes(question.name)) void ask(kind, kind, question, questions[kind]);
    }
  }

  /**
   * @param {Kind} kind
   * @param {ApiPath} path
   * @param {Question} question
   * @param {object} body
   */
  async function ask(kind, path, question, body) {
    store.send(kind, question, performance.now());
    let whole = false;
    /** @type {Refusal | null} */
    let refusal = null;
    try {
      whole = await engine.ask(kind, path, { ...body, ...tableOf(store.state, question.case) }, (line) => {
        const take = () => store.receive(kind, question.number, line, performance.now());
        if (line.state && isWithoutFloor(line.state)) window.setTimeout(take, WITHOUT_FLOOR);
        else take();
      });
    } catch (error) {
      refusal =
        error instanceof Refused
          ? error.refusal
          : { key: null, message: String(error), accepted: null };
    }
    store.end(kind, question.number, whole, refusal);
  }

  store.listen(follow);
  follow();
}
