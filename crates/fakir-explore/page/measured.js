// A measured curve: read by the program as for `fakir fit`, drawn over the model with its residuals, and fitted.

import { drawChart, extremes } from "./charts.js";
import { Refused } from "./engine.js";
import { engineeringText, significant, withPrefixes, write } from "./numbers.js";
import { byId } from "./screen.js";
import { isCycle, tableOf } from "./store.js";
import { base64Of, contentsOf, takeTable } from "./table.js";

/**
 * @import { Place } from "./charts.js"
 * @import { Engine, Fitted, FittedValue, Measured } from "./engine.js"
 * @import { Dimension } from "./numbers.js"
 * @import { State, Store } from "./store.js"
 * @import { TakeMap } from "./table.js"
 */

/** Largest file, bytes. */
const LARGEST = 8_000_000;

/** Number of steps of the slider of the contact point. */
const STEPS = 1000;

/**
 * Connects the controls of the measured curve. A height map that is dropped is given to `takeMap`.
 * @param {Store} store
 * @param {Engine} engine
 * @param {TakeMap} takeMap
 */
export function measure(store, engine, takeMap) {
  /** The file as it was given; it is sent again for a fit. @type {{ name: string, base64: string } | null} */
  let curve = null;
  /** @param {File} file */
  const open = async (file) => {
    if (file.size > LARGEST) {
      store.setData({ dataWords: `${file.name} is larger than ${LARGEST / 1e6} MB, which no curve is` });
      return;
    }
    curve = { name: file.name, base64: await base64Of(file) };
    store.setData({ measured: null, fitted: null, dataWords: `reading ${file.name} …` });
    await ask([]);
  };
  /** @param {readonly string[]} free */
  const ask = async (free) => {
    if (curve === null) return;
    const { chosen, contactPoint } = store.state;
    const point = free.length > 0 ? { contact_point_m: contactPoint } : {};
    try {
      await engine.ask("fit", "fit", { case: chosen.case, curve, free, ...point, ...tableOf(store.state, chosen.case) }, (line) => {
        if (line.progress) store.setData({ dataWords: `fitting: ${line.progress.stage} …` });
        if (line.measured && free.length === 0) {
          store.setData({ measured: line.measured, contactPoint: firstPoint(line.measured), dataWords: line.measured.notes.join("; ") });
        }
        if (line.fitted) take(line.fitted);
      });
    } catch (error) {
      const { message, accepted } = error instanceof Refused ? error.refusal : { message: String(error), accepted: null };
      store.setData({ dataWords: withPrefixes(accepted === null ? message : `${message}: ${accepted}`) });
    }
  };
  /** @param {Fitted} fitted */
  const take = (fitted) => {
    const values = { ...store.state.chosen.case };
    for (const { name, is_key, value } of fitted.estimates) if (is_key) values[name] = Number(value.toPrecision(6));
    store.choose({ case: values }, performance.now());
    store.setData({ fitted, contactPoint: fitted.contact_point_m, dataWords: wordsOf(fitted) });
  };
  // Residuals of a fit belong to the fitted case.
  let shown = store.state.chosen.case;
  store.listen(() => {
    const { chosen, fitted } = store.state;
    if (chosen.case === shown) return;
    shown = chosen.case;
    if (fitted !== null) store.setData({ fitted: null });
  });
  /**
   * Takes a file that was dropped: a table of pillars, a height map, or a curve.
   * @param {File} file
   */
  const dropped = async (file) => {
    const contents = await contentsOf(store, engine, file);
    if (contents?.kind === "heights") takeMap(file.name, await base64Of(file));
    else if (contents?.kind === "pillars") await takeTable(store, file, contents);
    else if (contents !== null) await open(file);
  };
  const input = byId("curve-file", HTMLInputElement);
  byId("open-curve").addEventListener("click", () => input.click());
  input.addEventListener("change", () => {
    const file = input.files?.[0];
    input.value = "";
    if (file !== undefined) void open(file);
  });
  document.addEventListener("dragover", (event) => event.preventDefault());
  document.addEventListener("drop", (event) => {
    event.preventDefault();
    const file = event.dataTransfer?.files[0];
    if (file !== undefined) void dropped(file);
  });
  byId("contact-point").addEventListener("input", () => {
    const { measured } = store.state;
    if (measured === null) return;
    const [low, high] = extremes(measured.position_m);
    const part = Number(byId("contact-point", HTMLInputElement).value) / STEPS;
    store.setData({ contactPoint: low + part * (high - low), fitted: null });
  });
  byId("fit").addEventListener("click", () => {
    const isDisplacement = store.state.measured?.position === "displacement";
    store.setData({ dataWords: "fitting …" });
    void ask(["substrate.young_modulus", ...(isDisplacement ? ["contact_point"] : [])]);
  });
  byId("close-curve").addEventListener("click", () => {
    engine.cancel("fit");
    curve = null;
    store.setData({ measured: null, fitted: null, dataWords: "" });
  });
}

/**
 * Shows the controls and the residuals.
 * @param {State} state
 */
export function drawMeasured(state) {
  const { measured, contactPoint, dataWords } = state;
  write(byId("data-words"), dataWords);
  byId("data").hidden = measured === null;
  if (measured === null) return;
  byId("contact-point-box").hidden = measured.position !== "displacement";
  const [low, high] = extremes(measured.position_m);
  const slider = byId("contact-point", HTMLInputElement);
  slider.value = String(Math.round((STEPS * (contactPoint - low)) / (high - low || 1)));
  const words = engineeringText(contactPoint, "length", 4);
  slider.setAttribute("aria-valuetext", words);
  byId("contact-point-words").textContent = words;
  const residuals = residualsOf(state);
  const most = Math.max(...residuals.map(([, force]) => Math.abs(force)), 0);
  if (most === 0) return;
  const [from, to] = extremes(residuals.map(([x]) => x));
  drawChart(
    byId("residuals", SVGSVGElement),
    { xLabel: "indentation ζ", xDimension: "length", yLabel: "ΔF", yDimension: "force", linear: true },
    {
      x: [Math.min(0, from), to + 0.02 * (to - from)],
      y: [-1.1 * most, 1.1 * most],
      series: [
        { kind: "line", style: "zero", points: [[-1, 0], [1, 0]] },
        { kind: "points", style: "measured", points: residuals },
      ],
    },
  );
}

/**
 * The measured curve as indentations and forces.
 * @param {State} state
 * @returns {Place[]}
 */
export function measuredPlaces({ measured, contactPoint }) {
  if (measured === null) return [];
  const shift = measured.position === "displacement" ? contactPoint : 0;
  return measured.position_m.map((at, k) => [at - shift, measured.force_N[k] ?? NaN]);
}

/**
 * Measured minus computed force: those of the fit, or else from the computed loading, between whose states the force is
 * interpolated as a power of the indentation.
 * @param {State} state
 * @returns {Place[]}
 */
function residualsOf(state) {
  const { answered, critical, cycle, fitted, phase, chosen, measured, question } = state;
  if (fitted !== null && measured !== null) {
    const shift = measured.position === "displacement" ? fitted.contact_point_m : 0;
    return fitted.residuals.map(([at, force]) => [at - shift, force]);
  }
  // A loading with gaps would show differences that are none.
  if (!isCycle(chosen.case) && answered.phase?.of.name !== question.name) return [];
  /** @type {Place[]} */
  const model = isCycle(chosen.case)
    ? (cycle?.is.solved?.summary.stations ?? [])
        .filter(({ branch }) => branch === "loading")
        .map(({ indentation_m, force_N }) => [indentation_m, force_N])
    : [
        ...(phase?.is.path ?? []).map(/** @returns {Place} */ ({ indentation_m, force_N }) => [indentation_m, force_N]),
        ...(critical === null
          ? []
          : [/** @type {Place} */ ([critical.is.critical_indentation_m, critical.is.critical_force_N])]),
      ];
  model.sort(([a], [b]) => a - b);
  return measuredPlaces(state).flatMap(([x, force], k) => {
    if (measured?.unloading[k]) return [];
    const next = model.findIndex(([at]) => at >= x);
    const [right, left] = [model[next], model[next - 1]];
    if (right === undefined || left === undefined) return [];
    const isPower = Math.min(left[0], left[1]) > 0;
    const part = isPower ? Math.log(x / left[0]) / Math.log(right[0] / left[0]) : (x - left[0]) / (right[0] - left[0]);
    const computed = isPower ? left[1] * (right[1] / left[1]) ** part : left[1] + part * (right[1] - left[1]);
    return Number.isFinite(computed) ? [/** @type {Place} */ ([x, force - computed])] : [];
  });
}

/**
 * A first contact point: the position from which on the force stays above a hundredth of its largest value.
 * @param {Measured} measured
 * @returns {number}
 */
function firstPoint({ position, position_m, force_N }) {
  if (position === "indentation") return 0;
  const most = Math.max(...force_N);
  const last = force_N.reduce((found, force, k) => (force < 0.01 * most && (position_m[k] ?? 0) > found ? (position_m[k] ?? 0) : found), -Infinity);
  return Number.isFinite(last) ? last : Math.min(...position_m);
}

/**
 * @param {Fitted} fitted
 * @returns {string}
 */
function wordsOf({ estimates, warnings, summary }) {
  /** @type {(estimate: FittedValue) => string} */
  const one = ({ name, value, standard_error }) => {
    /** @type {Dimension} */
    const dimension = name.endsWith("young_modulus") ? "pressure" : "length";
    const error = standard_error === null ? "not determined" : `standard error ${engineeringText(standard_error, dimension, 2)}`;
    return `${name} = ${engineeringText(value, dimension, 4)} (${error})`;
  };
  const time = `fitted in ${significant(summary.wall_time_s, 2)} s`;
  return [...estimates.map(one), ...warnings, summary.converged ? time : "the fit did not converge"].join("; ");
}
