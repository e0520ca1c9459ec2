// The page: which view is drawn from which part of the state, and how inputs change the state.

import { copy, drawNotices, save, saveShown } from "./actions.js";
import { chosenIn, fragment, pinnedIn } from "./address.js";
import { compare, drawComparison, drawPinned } from "./compare.js";
import { Controls } from "./controls.js";
import { drawCurves, drawCurvesStatus, drawLoading, drawPhase } from "./diagrams.js";
import { drawHistory, drawHold, overTime } from "./hold.js";
import { lecture } from "./lecture.js";
import { drawMeasured, measure } from "./measured.js";
import { drawColourBar, drawFloorBar, drawFloorPullBar, drawMap, drawPullBar, wordsAt } from "./map.js";
import { Module } from "./module.js";
import { engineeringText, withPrefixes, write } from "./numbers.js";
import { announcement, drawCritical, drawCycleNumbers, drawCycleProgress, drawFacts, drawLoad } from "./readouts.js";
import { answerQuestions } from "./requests.js";
import { byId, Screen } from "./screen.js";
import { drawSection } from "./section.js";
import { Server } from "./server.js";
import { explainFocus } from "./sketch.js";
import {
  FLAT,
  FLOOR,
  FRACTION,
  hasFlatTops,
  isBusy,
  isCriticalStation,
  isFlat,
  isOlder,
  mapScale,
  PITCH,
  RECEDING,
  refusedAt,
  isCycle,
  Store,
  STRENGTHS,
  TIMES,
  ADHESIVE_FLOOR,
  WORK,
} from "./store.js";
import { surfaces } from "./surface.js";
import { tables } from "./table.js";
import { onScheme } from "./theme.js";
import { drawZoom, zoomable } from "./zoom.js";

/**
 * @import { Engine, Start, Texts, Values } from "./engine.js"
 * @import { MapContents } from "./map.js"
 * @import { Chosen, Of, State } from "./store.js"
 */

/**
 * Young's moduli of the paper's three substrates, Pa.
 * @type {Record<string, number>}
 */
const SUBSTRATES = { rigid: 1e9, intermediate: 2e6, soft: 2e3 };

/**
 * Keys that the buttons of the paper's substrates do not change: spacing of pillars, floor contact, adhesion,
 * thicknesses and relaxation.
 */
const KEPT = [FRACTION, PITCH, FLOOR, WORK, RECEDING, ADHESIVE_FLOOR, "substrate.thickness", "lens.thickness", STRENGTHS, TIMES];

/** A load set with the pointer snaps to the critical one within this distance. */
const SNAP = 0.012;

/** The address is updated when the choice has not changed for this time, ms. */
const REMEMBER = 250;

/** Screen readers announce a result when it has not changed for this time, ms. */
const REST = 800;

/**
 * The paper's case with one of its substrates, without the keys that are kept.
 * @param {Start} start
 * @param {string} name
 * @returns {Values}
 */
function preset(start, name) {
  /** @type {Values} */
  const values = { ...start.paper, "substrate.young_modulus": SUBSTRATES[name] ?? 2e6 };
  for (const key of KEPT) delete values[key];
  return values;
}

/**
 * @param {string} data
 * @returns {NodeListOf<HTMLButtonElement>}
 */
function buttons(data) {
  return /** @type {NodeListOf<HTMLButtonElement>} */ (document.querySelectorAll(`[data-${data}]`));
}

/**
 * The entries of a legend with this mark.
 * @param {string} name
 * @param {string} mark
 * @returns {Element[]}
 */
function legend(name, mark) {
  return [...byId(`${name}-legend`).querySelectorAll(mark)];
}

// --- Showing ------------------------------------------------------------------------------------

/** @param {Store} store */
function show(store) {
  const { start } = store.state;
  const controls = new Controls(byId("fields"), start.keys, (...change) =>
    store.setValue(...change),
  );
  const screen = new Screen(store, (state) => {
    if (!isBusy(state)) document.body.dataset["busy"] = "no";
  });

  const defaults = new Map(start.keys.map((key) => [key.key, key.default]));
  screen.add(
    ({ chosen, typed }) => [chosen.case, typed],
    ({ chosen, typed }) => {
      controls.show(chosen.case, typed);
      for (const button of buttons("preset")) {
        const settings = Object.entries(preset(start, button.dataset["preset"] ?? ""));
        const same = settings.every(([key, value]) => (chosen.case[key] ?? defaults.get(key)) === value);
        button.setAttribute("aria-pressed", String(same && hasFlatTops(chosen.case)));
      }
      byId("flat-reference").setAttribute("aria-pressed", String(isFlat(chosen.case)));
    },
  );
  screen.add(
    ({ refusal }) => [refusal],
    (state) => showRefusal(state, controls),
  );
  screen.add((state) => [state.critical, state.estimate, state.loadScale], drawCritical);
  screen.add(
    (state) => [
      ...[state.critical, state.loadScale, state.solved, state.reference, state.cycle?.is.solved],
      ...[state.progress, state.refusal, state.calledOff],
    ],
    drawFacts,
  );
  screen.add(
    (state) => [
      ...[state.chosen.load, state.chosen.case, state.solved, state.cycle, state.refusal],
      ...[state.calledOff, state.question],
    ],
    drawLoad,
  );
  screen.add(
    (state) => [
      ...[state.question, state.asking.contact, state.elapsed, state.progress],
      ...[state.expected, state.calledOff, state.cycle?.is.solved],
    ],
    drawCycleProgress,
  );
  screen.add((state) => [state.cycle?.is.solved], drawCycleNumbers);

  const floorBar = byId("floor-bar", HTMLCanvasElement);
  const pullBar = byId("pull-bar", HTMLCanvasElement);
  const [canvas, bar] = [byId("map", HTMLCanvasElement), byId("colour-bar", HTMLCanvasElement)];
  screen.add(
    (state) => [state.picture, ...Object.values(mapContents(state) ?? {})],
    (state) => {
      const contents = mapContents(state);
      if (state.picture === null || contents === null) return;
      drawMap(canvas, contents, state.start.colours);
      write(byId("colour-most"), engineeringText(contents.force, "force", 3));
      const { floor, floorIsOlder, pull_N } = contents.scene;
      for (const id of ["pull-key", "pull-words"]) byId(id).hidden = pull_N === 0;
      if (pull_N !== 0) {
        write(byId("pull-most"), engineeringText(pull_N, "force", 3));
        drawPullBar(pullBar);
      }
      byId("floor-key").hidden = floor === null;
      for (const part of [floorBar, byId("floor-most")]) part.classList.toggle("older", floorIsOlder);
      byId("touch-key").hidden = floor !== null;
      if (floor !== null) {
        write(byId("floor-most"), engineeringText(floor.largest_pressure_Pa, "pressure", 3));
        drawFloorBar(floorBar);
      }
      const pulled = floor !== null && floor.largest_pull_Pa < 0;
      for (const id of ["floor-pull-key", "floor-pull-words"]) byId(id).hidden = !pulled;
      if (pulled) {
        write(byId("floor-pull-most"), engineeringText(floor.largest_pull_Pa, "pressure", 3));
        drawFloorPullBar(byId("floor-pull-bar", HTMLCanvasElement));
      }
      const { of, is } = state.picture;
      const detail = { asked: of.asked, stage: is.stage };
      screen.whenShown(() => document.dispatchEvent(new CustomEvent("picture", { detail })));
    },
    [canvas],
  );
  screen.add(({ chosen }) => [chosen.view], drawZoom);
  screen.add(
    () => [],
    ({ start }) => drawColourBar(bar, start.colours),
    [bar],
  );
  const [section, phase] = [byId("section"), byId("phase")];
  const [loading, pull] = [byId("loading"), byId("pull")];
  screen.add((state) => [state.section, state.chosen.exaggeration], drawSection, [section]);
  screen.addLate(
    (state) => [
      ...[state.phase, state.critical, state.solved, state.cycle, state.chosen.load],
      isOlder(state, state.solved, "load"),
    ],
    drawPhase,
    [phase],
  );
  screen.addLate(
    (state) => [
      ...[state.measured, state.contactPoint, state.pinned, state.loadScale],
      ...[state.phase, state.critical, state.solved, state.cycle, state.chosen.load],
      isOlder(state, state.solved, "load"),
    ],
    drawLoading,
    [loading, pull],
  );
  screen.add(
    (state) => [state.chosen, state.history, state.critical, state.solved],
    drawHold,
  );
  screen.addLate(
    (state) => [state.chosen, state.history],
    drawHistory,
    ["force", "indentation", "radius", "share"].map((name) => byId(`hold-${name}`)),
  );
  screen.add(
    ({ pinned, pinning }) => [pinned, pinning],
    (state) => drawPinned(state, mapContents),
    [byId("pinned-map"), byId("pinned-section")],
  );
  screen.addLate(
    (state) => [state.pinned, state.chosen, state.critical, state.solved, state.cycle, isOlder(state, state.solved, "load")],
    drawComparison,
  );
  const residuals = byId("residuals");
  screen.addLate(
    (state) => [state.measured, state.contactPoint, state.dataWords, state.phase, state.cycle, state.answered, state.fitted],
    drawMeasured,
    [residuals],
  );
  const curves = ["force", "radius", "indentation"].map((name) => byId(`curve-${name}`));
  screen.addLate((state) => [state.curves, state.critical], drawCurves, curves);
  screen.add(
    ({ asking, answered, question }) => [asking.curves, answered, question.name],
    drawCurvesStatus,
  );
  screen.addLate((state) => [state.texts, state.history, state.chosen.hold, isOlder(state, state.texts, "load")], showTexts);

  screen.age((state) => state.estimate ?? state.critical, "case", [byId("critical")]);
  const facts = [byId("regime"), byId("pillars")];
  const ofCase = [...legend("phase", ".dot"), ...legend("curves", ".dot")];
  screen.age((state) => state.critical, "case", [...facts, phase, ...curves, ...ofCase]);
  screen.age((state) => state.phase, "case", legend("phase", ".line"));
  screen.age((state) => state.curves, "case", legend("curves", ".line"));
  /** @type {(state: State) => Of<unknown> | null} */
  const known = (state) => state.cycle ?? state.critical ?? state.loadScale;
  screen.age(known, "case", [loading, pull, byId("cycle-numbers"), ...legend("loading", ".dot")]);
  screen.age((state) => state.cycle ?? state.phase, "case", legend("loading", ".line"));
  screen.age((state) => state.picture, "load", [canvas, byId("map-key")]);
  const numbers = ["load-numbers", "floor-numbers", "beyond-note", "warnings", "limits"].map((id) => byId(id));
  screen.age((state) => state.solved ?? state.picture, "load", numbers);
  screen.age((state) => state.section, "load", [section]);
  const texts = [byId("command"), byId("python"), byId("case-file")];
  screen.age((state) => state.texts, "load", texts);
  screen.add((state) => [state.notices], drawNotices);
  screen.add(
    (state) => [state.announcement],
    (state) => (byId("announcement").textContent = state.announcement),
  );
  screen.add(
    () => [],
    ({ start }) => (byId("version").textContent = `fakir ${start.version}`),
  );

  // The page is marked as busy at once: what is still shown is not the answer.
  const begin = () => {
    if (isBusy(store.state)) document.body.dataset["busy"] = "yes";
  };
  store.listen(begin);
  begin();
  onScheme(() => screen.redraw());
  canvas.addEventListener("pointermove", (event) => {
    const contents = mapContents(store.state);
    byId("map-note").textContent = contents === null ? "" : wordsAt(canvas, contents, event);
  });
  canvas.addEventListener("pointerleave", () => (byId("map-note").textContent = ""));
}

/**
 * @param {State} state
 * @returns {MapContents | null}
 */
function mapContents(state) {
  const { picture, chosen } = state;
  return picture && { scene: picture.is.scene, ...mapScale(state, picture), view: chosen.view };
}

/**
 * @param {State} state
 * @param {Controls} controls
 */
function showRefusal(state, controls) {
  const refusal = state.refusal?.is ?? null;
  const key = refusedAt(state);
  const problem = byId("problem");
  problem.hidden = refusal === null;
  problem.textContent = "";
  if (refusal === null) {
    controls.refuse(null, "");
    return;
  }
  const accepted = refusal.accepted === null ? "" : `: ${refusal.accepted}`;
  const words = withPrefixes(`${refusal.message}${accepted}`);
  // The message is about the key that the server names, which may be another than the one that was changed.
  const about = state.start.keys.find((each) => each.key === refusal.key);
  const atField = controls.refuse(key, about === undefined || key === about.key ? words : `${about.label}: ${words}`);
  problem.textContent = atField
    ? `${refusal.key ?? ""}: ${withPrefixes(refusal.message)}. The last valid result is shown.`
    : words;
}

/**
 * The texts of the load over time, if there is one, or else of the load that is shown.
 * @param {State} state
 * @returns {Texts | null}
 */
function textsOf({ chosen, history, texts }) {
  const isNewest = chosen.hold !== null && history?.words === "";
  return (isNewest ? history.is?.case : null) ?? texts?.is ?? null;
}

/** @param {State} state */
function showTexts(state) {
  const older = isOlder(state, state.texts, "load");
  for (const [name, id] of /** @type {const} */ ([
    ["command", "command"],
    ["python", "python"],
    ["toml", "case-file"],
  ])) {
    byId(id).textContent = textsOf(state)?.[name].trimEnd() ?? "";
  }
  for (const button of buttons("copy")) button.disabled = older || state.texts === null;
}

// --- Acting -------------------------------------------------------------------------------------

/**
 * @param {Store} store
 * @param {Engine} engine
 */
function listen(store, engine) {
  rememberInAddress(store);
  explainFocus(store.state.start.keys);
  lecture(store);
  const takeMap = surfaces(store, engine);
  measure(store, engine, takeMap);
  overTime(store, engine);
  zoomable(store, mapContents);
  compare(store);
  tables(store, engine, takeMap);
  const slider = byId("load", HTMLInputElement);
  let pointing = false;
  slider.addEventListener("pointerdown", () => (pointing = true));
  slider.addEventListener("pointerup", () => (pointing = false));
  slider.addEventListener("input", () => {
    const value = Number(slider.value);
    const { chosen, cycle } = store.state;
    if (isCycle(chosen.case)) {
      // With adhesion the slider has a step for each state.
      const state = cycle?.is.states[value];
      if (state !== undefined) store.choose({ load: state.load }, performance.now());
      return;
    }
    const load = pointing && Math.abs(value - 1) < SNAP ? 1 : value;
    store.choose({ load }, performance.now());
  });
  byId("to-critical").addEventListener("click", () => {
    const solved = store.state.cycle?.is.solved ?? null;
    const state = solved && store.state.cycle?.is.states.find((state) => isCriticalStation(solved, state));
    store.choose({ load: state?.load ?? 1 }, performance.now());
  });
  byId("to-jump").addEventListener("click", () => store.choose({ load: 1 }, performance.now()));
  byId("call-off").addEventListener("click", () => store.callOff());
  byId("request-again").addEventListener("click", () => store.requestAgain(performance.now()));
  byId("to-pull-off").addEventListener("click", () => {
    const { cycle } = store.state;
    const stations = cycle?.is.solved?.summary.stations;
    const pull = cycle?.is.solved?.summary.pull_off_force_N;
    const state = cycle?.is.states.find(({ place, load }) => load > 1 && stations?.[place]?.force_N === pull);
    if (state !== undefined) store.choose({ load: state.load }, performance.now());
  });
  const exaggeration = byId("exaggeration", HTMLInputElement);
  exaggeration.addEventListener("input", () => {
    const factor = Number((10 ** Number(exaggeration.value)).toPrecision(3));
    store.choose({ exaggeration: factor }, performance.now());
  });
  byId("exaggeration-fit").addEventListener("click", () =>
    store.choose({ exaggeration: null }, performance.now()),
  );
  for (const button of buttons("preset")) {
    button.addEventListener("click", () => {
      const { start, chosen } = store.state;
      const values = preset(start, button.dataset["preset"] ?? "");
      for (const key of KEPT) {
        const value = chosen.case[key];
        if (value !== undefined) values[key] = value;
      }
      store.choose({ case: values }, performance.now());
    });
  }
  byId("flat-reference").addEventListener("click", () => {
    const flat = isFlat(store.state.chosen.case);
    store.setValue(FLAT, flat ? "false" : "true", false, performance.now());
  });
  for (const button of buttons("file")) {
    button.addEventListener("click", () => void save(store, engine, button.dataset["file"] ?? ""));
  }
  for (const button of buttons("shown")) {
    button.addEventListener("click", () => void saveShown(store, button.dataset["shown"] ?? ""));
  }
  for (const button of buttons("copy")) {
    const name = /** @type {keyof Texts} */ (button.dataset["copy"]);
    button.addEventListener("click", () => void copy(store, name, textsOf(store.state)?.[name] ?? ""));
  }
  const menu = byId("export-menu", HTMLDetailsElement);
  document.addEventListener("keydown", (event) => {
    if (event.key !== "Escape" || !menu.open) return;
    menu.open = false;
    menu.querySelector("summary")?.focus();
  });
  document.addEventListener("click", (event) => {
    if (!menu.contains(/** @type {Node} */ (event.target))) menu.open = false;
  });
}

/**
 * Writes what is chosen to the address, as a new entry of the history, and reads it from there when the user goes back or forward or
 * changes the address.
 * @param {Store} store
 */
function rememberInAddress(store) {
  let known = location.hash;
  let place = placeInHistory() ?? 0;
  let last = place;
  const [undo, redo] = [byId("undo", HTMLButtonElement), byId("redo", HTMLButtonElement)];
  const show = () => {
    undo.disabled = place === 0;
    redo.disabled = place >= last;
  };
  /** @param {boolean} adds Whether the entry is a new one. */
  const write = (adds) => {
    const hash = hashOf(store.state);
    // An address that was just entered, before its event arrives, is not overwritten.
    if (location.hash !== known || hash === known) return;
    if (adds) place = last = place + 1;
    history[adds ? "pushState" : "replaceState"]({ place }, "", hash);
    known = location.hash;
    show();
  };
  write(false);
  afterwards(store, REMEMBER, hashOf, () => write(true));
  byId("copy-link").addEventListener("click", () => {
    write(true);
    void copy(store, "link", location.href);
  });
  undo.addEventListener("click", () => history.back());
  redo.addEventListener("click", () => history.forward());
  byId("reset").addEventListener("click", () => {
    // Another table may have been opened since.
    const { table } = store.state.start;
    if (table !== null) store.setTable({ ...table, number: (store.state.table?.number ?? 0) + 1 });
    store.choose({ case: store.state.start.case, load: 1, exaggeration: null, hold: null, time: null, view: null }, performance.now());
  });
  window.addEventListener("hashchange", () => {
    known = location.hash;
    const found = placeInHistory();
    if (found === null) {
      // An address that the user has entered.
      place = last = place + 1;
      history.replaceState({ place }, "");
    } else {
      place = found;
    }
    show();
    const chosen = chosenIn(known);
    if (chosen === null || known === hashOf(store.state)) return;
    open(store, chosen, pinnedIn(known));
  });
  show();
}

/**
 * The fragment of the address for what is chosen and pinned.
 * @param {State} state
 * @returns {string}
 */
function hashOf({ chosen, pinned, pinning }) {
  const then = pinning?.then ?? null;
  return then === null ? fragment(chosen, pinned?.chosen) : fragment(then, chosen);
}

/**
 * Shows a case, and the one beside it, which is solved first unless it is pinned already.
 * @param {Store} store
 * @param {Chosen} chosen
 * @param {Chosen | null} beside
 */
function open(store, chosen, beside) {
  const { pinned } = store.state;
  if (beside === null) {
    if (pinned !== null) store.unpin();
    store.choose(chosen, performance.now());
  } else if (pinned !== null && fragment(pinned.chosen) === fragment(beside)) {
    store.choose(chosen, performance.now());
  } else {
    store.choose(beside, performance.now());
    store.pinWhenComplete(chosen);
  }
}

/**
 * Number of the entry of the history; null for an entry that the page has not written.
 * @returns {number | null}
 */
function placeInHistory() {
  const place = /** @type {{ place?: unknown } | null} */ (history.state)?.place;
  return typeof place === "number" ? place : null;
}

/**
 * Calls `act` when the part of the state that `of` returns has not changed for `delay`, ms.
 * @template T
 * @param {Store} store
 * @param {number} delay
 * @param {(state: State) => T} of
 * @param {(it: T) => void} act
 */
function afterwards(store, delay, of, act) {
  /** @type {T | undefined} */
  let last;
  /** @type {number | undefined} */
  let timer;
  store.listen(() => {
    const now = of(store.state);
    if (now === last) return;
    last = now;
    window.clearTimeout(timer);
    timer = window.setTimeout(() => act(now), delay);
  });
}

/** @type {Engine} */
const engine = document.documentElement.dataset["engine"] === "module" ? new Module() : new Server();
const start = await engine.start();
const linked = chosenIn(location.hash);
const beside = linked && pinnedIn(location.hash);
const first = beside ?? linked ?? { case: start.case, load: 1, exaggeration: null, hold: null, time: null, view: null };
const store = new Store(start, first, performance.now());
if (beside !== null) store.pinWhenComplete(linked);
show(store);
listen(store, engine);
afterwards(store, REST, announcement, (words) => {
  if (words !== null) store.announce(words);
});
answerQuestions(store, engine);
