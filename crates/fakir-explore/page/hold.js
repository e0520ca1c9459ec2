// Viscoelastic bodies over time: a load that is reached in a time and held. The slider of the time moves the load along the history.

import { drawChart } from "./charts.js";
import { Refused } from "./engine.js";
import { digitsFor, editable, engineeringText, parse, significant, withPrefixes, withUnit, write } from "./numbers.js";
import { byId } from "./screen.js";
import { isRelaxing, knownCritical, tableOf } from "./store.js";

/**
 * @import { Axes, Place, Series } from "./charts.js"
 * @import { Engine, History, HistoryState } from "./engine.js"
 * @import { Dimension } from "./numbers.js"
 * @import { Hold, State, Store } from "./store.js"
 */

/** The history is requested when nothing has changed for this time, ms. */
const CALM = 250;

/** Duration of a first ramp and of a first hold, s. */
const FIRST = { ramp_s: 1, hold_s: 60 };

/**
 * @typedef {object} TimeChart
 * @property {string} id
 * @property {Axes} axes
 * @property {(state: HistoryState) => number | null} of
 */

/** @type {readonly TimeChart[]} */
const CHARTS = [
  { id: "hold-force", axes: axesOf("F", "force", true), of: (state) => state.force_N },
  { id: "hold-indentation", axes: axesOf("ζ", "length", true), of: (state) => state.indentation_m },
  { id: "hold-radius", axes: axesOf("a", "length", true), of: (state) => state.contact_radius_m },
  { id: "hold-share", axes: axesOf("floor force/F", "number", false), of: (state) => state.floor_share },
];

/**
 * @param {string} yLabel
 * @param {Dimension} yDimension
 * @param {boolean} bare
 * @returns {Axes}
 */
function axesOf(yLabel, yDimension, bare) {
  return { xLabel: "time t", xDimension: "time", yLabel, yDimension, bare, linear: true };
}

/**
 * Connects the controls of the load over time, and requests its history.
 * @param {Store} store
 * @param {Engine} engine
 */
export function overTime(store, engine) {
  let asked = "";
  /** @type {number | undefined} */
  let timer;
  /**
   * @param {string} name
   * @param {State} state
   */
  const ask = async (name, { chosen, table }) => {
    const { hold } = chosen;
    if (hold === null) return;
    try {
      const question = { case: chosen.case, hold, ...tableOf({ table }, chosen.case) };
      await engine.ask("hold", "hold", question, (line) => {
        if (line.history && name === asked) take(name, line.history);
      });
    } catch (error) {
      if (name !== asked) return;
      const { message, accepted } = error instanceof Refused ? error.refusal : { message: String(error), accepted: null };
      store.setHistory({ name, is: null, words: withPrefixes(accepted === null ? message : `${message}: ${accepted}`) });
    }
  };
  /**
   * @param {string} name
   * @param {History} history
   */
  const take = (name, history) => {
    store.setHistory({ name, is: history, words: "" });
    const { time } = store.state.chosen;
    moveTo(time === null ? history.loads.length - 1 : placeAt(history, time));
  };
  /** @param {number} place */
  const moveTo = (place) => {
    const history = store.state.history?.is ?? null;
    const time = history?.summary.states[place]?.time_s;
    if (history === null || time === undefined) return;
    const at = placeAt(history, time);
    const [state, load] = [history.summary.states[at], history.loads[at]];
    if (state === undefined || load === undefined) return;
    const { chosen } = store.state;
    if (chosen.time === state.time_s && chosen.load === load) return;
    store.choose({ load, time: state.time_s }, performance.now());
  };
  const follow = () => {
    const name = nameOf(store.state);
    if (name === asked) return;
    asked = name;
    window.clearTimeout(timer);
    engine.cancel("hold");
    if (name === "") {
      store.setHistory(null);
      return;
    }
    store.setHistory({ name, is: store.state.history?.is ?? null, words: "computing the history …" });
    timer = window.setTimeout(() => void ask(name, store.state), CALM);
  };
  store.listen(follow);
  follow();

  byId("time", HTMLInputElement).addEventListener("input", () => moveTo(Number(byId("time", HTMLInputElement).value)));
  /** @param {Partial<Hold>} part */
  const change = (part) => {
    const { chosen } = store.state;
    store.choose({ hold: { ...(chosen.hold ?? firstHold(store.state)), ...part } }, performance.now());
  };
  byId("hold-button").addEventListener("click", () => {
    const { chosen } = store.state;
    store.choose(chosen.hold === null ? { hold: firstHold(store.state) } : { hold: null, time: null }, performance.now());
  });
  const by = byId("hold-by", HTMLSelectElement);
  by.addEventListener("change", () => {
    const word = by.value === "force" ? "force" : "indentation";
    change({ by: word, load: firstHold(store.state, word).load });
  });
  for (const [id, part] of /** @type {const} */ ([["hold-load", "load"], ["hold-ramp", "ramp_s"], ["hold-for", "hold_s"]])) {
    const field = byId(id, HTMLInputElement);
    field.addEventListener("change", () => {
      const hold = store.state.chosen.hold ?? firstHold(store.state);
      const dimension = part !== "load" ? "time" : hold.by === "force" ? "force" : "length";
      const unit = editable(hold[part], dimension).split(" ")[1] ?? "";
      const value = parse(withUnit(field.value, unit), dimension);
      const isRight = value !== null && value >= 0 && !(part === "load" && value === 0);
      if (isRight) field.removeAttribute("aria-invalid");
      else field.setAttribute("aria-invalid", "true");
      if (isRight) change({ [part]: value });
      else byId("hold-words").textContent = `${field.value} is no ${dimension === "length" ? "indentation" : dimension}: give a number with a unit, as ${editable(hold[part], dimension)}`;
    });
  }
}

/**
 * The first load that is held: the one that is shown, which is reached in a second and held for a minute.
 * @param {State} state
 * @param {"indentation" | "force"} [by]
 * @returns {Hold}
 */
function firstHold(state, by = "force") {
  const { chosen, question, solved } = state;
  const critical = knownCritical(state, question);
  const shown = solved?.of.name === question.name && solved.is.fraction === chosen.load ? solved.is.summary : null;
  const load =
    by === "force"
      ? (shown?.force_N ?? critical?.critical_force_N ?? 1e-3)
      : (shown?.indentation_m ?? critical?.critical_indentation_m ?? 1e-6);
  return { by, load: Number(load.toPrecision(3)), ...FIRST };
}

/**
 * The question for a history as a text; empty without a load that is held, and for elastic bodies.
 * @param {State} state
 * @returns {string}
 */
function nameOf({ chosen, table }) {
  if (chosen.hold === null || !isRelaxing(chosen.case)) return "";
  return JSON.stringify([chosen.case, chosen.hold, table?.number ?? 0]);
}

/**
 * Index of the state nearest to a time: the last one, as a step has two states at one time.
 * @param {History} history
 * @param {number} time
 * @returns {number}
 */
function placeAt({ summary: { states } }, time) {
  /** @type {(k: number) => number} */
  const distance = (k) => Math.abs((states[k]?.time_s ?? Infinity) - time);
  return states.reduce((best, _, k) => (distance(k) <= distance(best) ? k : best), 0);
}

/**
 * Shows controls, slider and numbers of the load over time.
 * @param {State} state
 */
export function drawHold(state) {
  const { chosen, history } = state;
  const relaxing = isRelaxing(chosen.case);
  const { hold } = chosen;
  byId("over-time").hidden = !relaxing;
  byId("export-menu").classList.toggle("holding", relaxing && hold !== null);
  byId("time-box").hidden = byId("hold-charts").hidden = !relaxing || hold === null || history?.is === null || history === null;
  byId("hold-button").textContent = hold === null ? "show over time" : "remove";
  byId("hold-button").setAttribute("aria-pressed", String(hold !== null));
  const shown = hold ?? firstHold(state);
  byId("hold-by", HTMLSelectElement).value = shown.by;
  /** @type {(id: string, value: number, dimension: Dimension) => void} */
  const field = (id, value, dimension) => {
    const input = byId(id, HTMLInputElement);
    // A text that is being typed stays.
    const isTyped = document.activeElement === input && input.value !== input.dataset["shown"];
    if (!isTyped) input.value = editable(value, dimension);
    if (!isTyped || parse(input.value, dimension) === value) input.dataset["shown"] = input.value;
  };
  field("hold-load", shown.load, shown.by === "force" ? "force" : "length");
  field("hold-ramp", shown.ramp_s, "time");
  field("hold-for", shown.hold_s, "time");
  byId("hold-words").textContent = history?.words ?? "";
  for (const id of ["hold-charts", "time-numbers"]) byId(id).classList.toggle("older", (history?.words ?? "") !== "");
  if (!relaxing || hold === null || history === null || history.is === null) return;
  const { summary } = history.is;
  const place = chosen.time === null ? summary.states.length - 1 : placeAt(history.is, chosen.time);
  const at = summary.states[place];
  if (at === undefined) return;
  const slider = byId("time", HTMLInputElement);
  slider.max = String(summary.states.length - 1);
  slider.value = String(place);
  const time = engineeringText(at.time_s, "time", 4);
  slider.setAttribute("aria-valuetext", `t = ${time}`);
  byId("time-words").textContent = chosen.time === null ? "the load was moved by itself" : `t = ${time}`;
  const error = summary.relative_error_estimate;
  /** @type {(value: number) => number} */
  const digits = (value) => Math.min(4, digitsFor(value));
  const parts = [
    `F = ${engineeringText(at.force_N, "force", digits(error.force))}`,
    `ζ = ${engineeringText(at.indentation_m, "length", digits(error.indentation))}`,
  ];
  if (at.contact_radius_m !== null) parts.push(`a = ${engineeringText(at.contact_radius_m, "length", 3)}`);
  if (at.floor_share !== null) parts.push(`${significant(100 * at.floor_share, 3)} % on the floor`);
  write(byId("time-numbers"), `${parts.join(",  ")}  (error ${significant(Math.max(error.force, error.indentation), 1)})`);
  byId("hold-results").textContent = resultWords(history.is);
}

/**
 * Time to floor contact, equilibrium and modulus.
 * @param {History} history
 * @returns {string}
 */
function resultWords({ summary }) {
  const { time_to_floor_contact_s: floor, time_to_equilibrium_s: rest, end, warnings } = summary;
  const words = [];
  if (floor === null) words.push("floor contact: never");
  else if (floor === 0) words.push("floor contact: at once");
  else words.push(`floor contact after ${engineeringText(floor, "time", 4)}${floor > end.time_s ? ", if the load is held longer" : ""}`);
  if (rest !== null) words.push(`within 1 % of equilibrium after ${engineeringText(rest, "time", 3)}`);
  words.push(`modulus at once ${significant(summary.instantaneous_modulus_ratio, 3)} times the relaxed one`);
  return [...words, ...warnings].join("; ");
}

/**
 * Draws force, indentation, contact radius and fraction of the floor over time.
 * @param {State} state
 */
export function drawHistory(state) {
  const { chosen, history } = state;
  if (chosen.hold === null || history === null || history.is === null || !isRelaxing(chosen.case)) return;
  const { summary } = history.is;
  const { states, time_to_floor_contact_s: floor } = summary;
  const last = states[states.length - 1]?.time_s ?? 1;
  const at = chosen.time === null ? undefined : states[placeAt(history.is, chosen.time)];
  for (const { id, axes, of } of CHARTS) {
    /** @type {(of: readonly HistoryState[]) => Place[]} */
    const places = (some) =>
      some.flatMap((one) => {
        const value = of(one);
        return value === null ? [] : [/** @type {Place} */ ([one.time_s, value])];
      });
    const line = places(states);
    const most = Math.max(...line.map(([, y]) => y), 0);
    /** @type {Series[]} */
    const series = [
      { kind: "vertical", style: "one-pitch", points: floor === null || floor > last ? [] : [[floor, 0]] },
      { kind: "line", style: "path", points: line },
      { kind: "points", style: "load-point", points: at === undefined ? [] : places([at]) },
    ];
    drawChart(byId(id, SVGSVGElement), axes, { x: [0, last], y: [0, most > 0 ? 1.08 * most : 1], series });
  }
}
