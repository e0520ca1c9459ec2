// The contact of the lens with a height map that the user gives, in a panel of its own.

import { Refused } from "./engine.js";
import { drawColourBar, drawRelief } from "./map.js";
import { engineeringText, significant, withPrefixes, withUnit, write } from "./numbers.js";
import { byId } from "./screen.js";
import { sectionInto } from "./section.js";
import { onScheme } from "./theme.js";

/**
 * @import { Engine, GivenFile, Start, SurfaceShown, Values } from "./engine.js"
 * @import { Store } from "./store.js"
 * @import { Colours } from "./theme.js"
 */

/** Tables of the case that a height map takes over. */
const TABLES = /^(lens|substrate)\./;

/** Fields of what a file may leave out, and their keys. */
const FIELDS = /** @type {const} */ ({
  "map-width": "surface.width",
  "map-unit": "surface.height_unit",
  "map-range": "surface.height_range",
});

/** The contact is requested when nothing has changed for this time, ms. */
const CALM = 120;

/** Number of steps of the slider, and the indentation at its end relative to the range of the heights. */
const STEPS = 500;
const FARTHEST = 2;

/**
 * Connects the panel of the height map, which shows the case that the page begins with if that is one; returns a function that shows a file in it.
 * @param {Store} store
 * @param {Engine} engine
 * @returns {(name: string, base64: string) => void}
 */
export function surfaces(store, engine) {
  const panel = byId("surface");
  const slider = byId("map-indentation", HTMLInputElement);
  /** @type {{ map: GivenFile | null, case: Values } | null} */
  let given = null;
  /** @type {SurfaceShown | null} */
  let shown = null;
  /** @type {number | null} */
  let indentation = null;
  /** @type {number | undefined} */
  let timer;
  let number = 0;
  /** @returns {Values} */
  const values = () => {
    /** @type {Values} */
    const own = { ...Object.fromEntries(Object.entries(store.state.chosen.case).filter(([key]) => TABLES.test(key))), ...given?.case };
    for (const [id, key] of Object.entries(FIELDS)) {
      const text = withUnit(byId(id, HTMLInputElement).value.trim(), "µm");
      if (text !== "") own[key] = text.replace(/[µμ]/, "u");
    }
    if (byId("map-fill", HTMLInputElement).checked) own["surface.missing_points"] = "fill";
    return own;
  };
  const draw = () => {
    if (shown !== null) drawSurface(shown, store.state.start.colours);
  };
  const ask = async () => {
    if (given === null) return;
    number += 1;
    const own = number;
    const question = { case: values(), map: given.map, ...(indentation !== null && { indentation_m: indentation }) };
    byId("map-words").textContent = "computing …";
    try {
      await engine.ask("surface", "surface", question, ({ surface }) => {
        if (surface === undefined || own !== number) return;
        shown = surface;
        byId("surface-answer").hidden = false;
        const farthest = FARTHEST * surface.relief_m;
        if (document.activeElement !== slider) slider.value = String(Math.round((STEPS * surface.indentation_m) / farthest));
        slider.setAttribute("aria-valuetext", engineeringText(surface.indentation_m, "length", 3));
        byId("map-words").textContent = stageWords(surface);
        draw();
      });
    } catch (error) {
      if (own !== number) return;
      const { message, accepted } = error instanceof Refused ? error.refusal : { message: String(error), accepted: null };
      byId("map-words").textContent = withPrefixes(accepted === null ? message : `${message}: ${accepted}`);
    }
  };
  const later = () => {
    window.clearTimeout(timer);
    timer = window.setTimeout(() => void ask(), CALM);
  };
  for (const id of [...Object.keys(FIELDS), "map-fill"]) {
    byId(id).addEventListener("change", () => {
      indentation = null;
      later();
    });
  }
  slider.addEventListener("input", () => {
    if (shown === null) return;
    indentation = Number((((Math.max(1, Number(slider.value)) / STEPS) * FARTHEST * shown.relief_m)).toPrecision(4));
    later();
  });
  let bodies = JSON.stringify(values());
  store.listen(() => {
    if (given === null) return;
    const now = JSON.stringify(values());
    if (now === bodies) return;
    bodies = now;
    later();
  });
  byId("close-map").addEventListener("click", () => {
    engine.cancel("surface");
    number += 1;
    given = shown = indentation = null;
    panel.hidden = byId("surface-answer").hidden = true;
  });
  for (const id of ["surface-map", "surface-section"]) new ResizeObserver(draw).observe(byId(id, Element));
  onScheme(draw);
  /** @param {NonNullable<Start["surface"]>} surface */
  const take = (surface) => {
    given = surface;
    shown = indentation = null;
    bodies = JSON.stringify(values());
    panel.hidden = false;
    byId("surface-answer").hidden = true;
    byId("map-name").textContent = surface.map?.name ?? "of the case";
    for (const id of [...Object.keys(FIELDS), "map-fill"]) byId(id, HTMLInputElement).disabled = surface.map === null;
    panel.scrollIntoView({ block: "start" });
    void ask();
  };
  const { surface: first } = store.state.start;
  if (first) take(first);
  return (name, base64) => take({ map: { name, base64 }, case: {} });
}

/**
 * On which cells the answer was computed.
 * @param {SurfaceShown} surface
 * @returns {string}
 */
function stageWords({ approximate, cells, file_cells, wall_time_s, warnings }) {
  /** @type {(pair: readonly [number, number]) => string} */
  const words = ([columns, rows]) => `${columns} × ${rows}`;
  const time = wall_time_s < 1 ? `${significant(1e3 * wall_time_s, 2)} ms` : `${significant(wall_time_s, 3)} s`;
  const part = cells[0] === file_cells[0] ? "all points" : `means of ${words(file_cells)} points`;
  const next = approximate ? "; refining …" : "";
  return [`${words(cells)} cells (${part}), solved in ${time}${next}`, ...warnings].join("; ");
}

/**
 * @param {SurfaceShown} surface
 * @param {Colours} colours
 */
function drawSurface(surface, colours) {
  const { summary } = surface;
  const canvas = byId("surface-map", HTMLCanvasElement);
  drawRelief(canvas, surface, colours);
  drawColourBar(byId("surface-bar", HTMLCanvasElement), colours);
  write(byId("surface-most"), engineeringText(surface.largest_pressure_Pa, "pressure", 3));
  sectionInto(byId("surface-section", SVGSVGElement), surface.section, null);
  const error = summary.relative_error_estimate;
  /** @type {(value: number | null | undefined) => string} */
  const words = (value) => (value === null || value === undefined ? "" : ` (error ${significant(value, 1)})`);
  const numbers = [
    `ζ = ${engineeringText(surface.indentation_m, "length", 3)}`,
    `F = ${engineeringText(summary.force_N, "force", 3)}${words(error?.force)}`,
    `contact area ${engineeringText(summary.contact_area_m2 * 1e12, "number", 3)} µm^{2}${words(error?.contact_area)}`,
    `heights from lowest to highest ${engineeringText(surface.relief_m, "length", 3)}`,
  ];
  write(byId("surface-numbers"), numbers.join(",  "));
  byId("surface-command").textContent = surface.command;
  byId("surface-case").textContent = surface.toml.trimEnd();
}
