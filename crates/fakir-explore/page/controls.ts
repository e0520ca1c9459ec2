// The quantities of a case: a slider and a field with unit for each, and what is wrong with it.

import type { Refusal, Value, Values } from "./engine.js";
import { editable, engineeringText, parse, type Dimension } from "./numbers.js";
import { FRACTION, METHOD, PITCH } from "./store.js";

interface Field {
  readonly key: string;
  readonly label: string;
  readonly symbol: string;
  readonly dimension: Dimension;
  readonly range: readonly [number, number];
  readonly logarithmic: boolean;
}

interface Choice {
  readonly key: string;
  readonly label: string;
  readonly options: readonly (readonly [string, string])[];
  /** Only with this method. */
  readonly method?: string;
}

interface Group {
  readonly title: string;
  readonly fields: readonly (Field | Choice)[];
}

const DEGREE = Math.PI / 180;
const MAXIMUM_FRACTION = Math.PI / (2 * Math.sqrt(3));

function quantity(
  key: string,
  label: string,
  symbol: string,
  dimension: Dimension,
  range: readonly [number, number],
  logarithmic = true,
): Field {
  return { key, label, symbol, dimension, range, logarithmic };
}

const DIAMETER = "texture.pillar.diameter";

const GROUPS: readonly Group[] = [
  {
    title: "Texture",
    fields: [
      quantity(FRACTION, "surface fraction", "φ", "number", [3e-4, 0.3]),
      quantity(PITCH, "pitch", "e", "length", [1e-6, 1e-3]),
      quantity("texture.offset", "axis off a pillar", "dx/e", "number", [0, 1], false),
      quantity("texture.offset_angle", "in direction", "", "angle", [0, 90 * DEGREE], false),
    ],
  },
  {
    title: "Pillars",
    fields: [
      quantity(DIAMETER, "diameter", "d", "length", [1e-7, 1e-4]),
      quantity("texture.pillar.height", "height", "h", "length", [1e-8, 1e-4]),
      {
        key: "texture.pillar.compliance",
        label: "under load they",
        options: [
          ["column", "shorten as columns"],
          ["none", "keep their length"],
        ],
      },
    ],
  },
  {
    title: "Substrate",
    fields: [
      quantity("substrate.young_modulus", "Young’s modulus", "E_{s}", "pressure", [1e3, 1e11]),
      quantity("substrate.poisson_ratio", "Poisson’s ratio", "ν_{s}", "number", [0, 0.5], false),
    ],
  },
  {
    title: "Lens",
    fields: [
      quantity("lens.radius", "radius", "R", "length", [1e-5, 1e-1]),
      quantity("lens.young_modulus", "Young’s modulus", "E_{l}", "pressure", [1e3, 1e11]),
      quantity("lens.poisson_ratio", "Poisson’s ratio", "ν_{l}", "number", [0, 0.5], false),
    ],
  },
  {
    title: "Method",
    fields: [
      {
        key: METHOD,
        label: "solved by",
        options: [
          ["spectral", "spectral, exact"],
          ["love", "Love elements"],
          ["punch", "punch lattice"],
          ["homogenised", "homogenised lattice"],
        ],
      },
      {
        key: "method.accuracy",
        label: "accuracy",
        method: "spectral",
        options: [
          ["default", "default"],
          ["accurate", "accurate"],
        ],
      },
      {
        key: "method.form",
        label: "form",
        method: "punch",
        options: [
          ["corrected", "corrected"],
          ["plain", "plain"],
        ],
      },
      {
        key: "method.cells_per_diameter",
        label: "cells across a pillar",
        method: "love",
        options: [
          ["8", "8"],
          ["16", "16"],
          ["24", "24"],
          ["32", "32"],
        ],
      },
    ],
  },
];

/** Steps of a slider. */
const STEPS = 1000;

interface Widget {
  readonly box: HTMLElement;
  readonly note: HTMLElement;
  /** Shows a value; the text stays as it is if it was just `typed`. */
  readonly show: (value: Value, typed: boolean) => void;
  readonly inputs: readonly HTMLElement[];
}

/** What was done at a field: `typed` if its text is to stay as it was written. */
type Changed = (key: string, value: Value, typed: boolean, asked: number) => void;

/** All fields of a case. */
export class Controls {
  private readonly widgets = new Map<string, Widget>();

  constructor(
    container: HTMLElement,
    private readonly changed: Changed,
  ) {
    for (const group of GROUPS) {
      const set = document.createElement("fieldset");
      const title = document.createElement("legend");
      title.textContent = group.title;
      set.append(title);
      for (const field of group.fields) {
        const widget = "options" in field ? this.choice(field) : this.field(field);
        this.widgets.set(field.key, widget);
        set.append(widget.box);
      }
      container.append(set);
    }
  }

  /** Shows a case everywhere but in the field that was just `typed` into. */
  show(values: Values, typed: string | null): void {
    const shown: Values = { ...values };
    const [fraction, pitch, diameter] = [shown[FRACTION], shown[PITCH], shown[DIAMETER]];
    if (typeof diameter === "number") {
      if (typeof fraction === "number" && fraction > 0) {
        shown[PITCH] = rounded(diameter * Math.sqrt(MAXIMUM_FRACTION / fraction));
      } else if (typeof pitch === "number" && pitch > 0) {
        shown[FRACTION] = rounded(MAXIMUM_FRACTION * (diameter / pitch) ** 2);
      }
    }
    this.widgets.get(FRACTION)?.box.classList.toggle("derived", pitch !== undefined);
    this.widgets.get(PITCH)?.box.classList.toggle("derived", pitch === undefined);
    for (const group of GROUPS) {
      for (const field of group.fields) {
        const widget = this.widgets.get(field.key);
        if (widget === undefined) continue;
        if ("options" in field && field.method !== undefined) {
          widget.box.hidden = field.method !== (shown[METHOD] ?? "spectral");
        }
        const value = shown[field.key] ?? initial(field);
        if (value !== undefined) widget.show(value, field.key === typed);
      }
    }
  }

  /** Shows what is wrong at its field, and nothing at others; false if it is at no field. */
  refuse(refusal: Refusal | null): boolean {
    let found = false;
    for (const [key, widget] of this.widgets) {
      const wrong = refusal !== null && refusal.key === key;
      const accepted = wrong && refusal.accepted !== null ? `: ${refusal.accepted}` : "";
      widget.note.textContent = wrong ? `${refusal.message}${accepted}` : "";
      widget.note.hidden = !wrong;
      widget.box.classList.toggle("wrong", wrong);
      for (const input of widget.inputs) {
        if (wrong) input.setAttribute("aria-invalid", "true");
        else input.removeAttribute("aria-invalid");
      }
      found ||= wrong;
    }
    return found;
  }

  private field(field: Field): Widget {
    const { box, note, id } = frame(field.key, field.label, field.symbol);
    const text = document.createElement("input");
    text.id = id;
    text.type = "text";
    text.inputMode = "decimal";
    text.spellcheck = false;
    text.autocomplete = "off";
    text.setAttribute("aria-describedby", note.id);
    const slider = document.createElement("input");
    slider.id = `${id}-slider`;
    slider.type = "range";
    slider.min = "0";
    slider.max = String(STEPS);
    slider.setAttribute("aria-label", `${field.label}, slider`);
    slider.setAttribute("aria-describedby", note.id);
    text.addEventListener("change", () => {
      const value = parse(text.value, field.dimension) ?? text.value;
      this.changed(field.key, value, true, performance.now());
    });
    const slide = (): void => {
      const value = sliderValue(field, Number(slider.value));
      this.changed(field.key, value, false, performance.now());
    };
    text.addEventListener("keydown", (event) => {
      const step = event.key === "ArrowUp" ? 5 : event.key === "ArrowDown" ? -5 : 0;
      if (step === 0) return;
      event.preventDefault();
      slider.value = String(Number(slider.value) + step);
      slide();
    });
    slider.addEventListener("input", slide);
    box.append(text, slider, note);
    const show = (value: Value, typed: boolean): void => {
      if (typeof value !== "number") {
        if (!typed) text.value = value;
        return;
      }
      if (!typed) text.value = editable(value, field.dimension);
      if (document.activeElement !== slider || sliderPlace(field, value) !== slider.value) {
        slider.value = sliderPlace(field, value);
      }
      const words = engineeringText(value, field.dimension, 3).replace(/[{}]/g, "");
      slider.setAttribute("aria-valuetext", words);
    };
    return { box, note, show, inputs: [text, slider] };
  }

  private choice(field: Choice): Widget {
    const { box, note, id } = frame(field.key, field.label, "");
    const select = document.createElement("select");
    select.id = id;
    select.setAttribute("aria-describedby", note.id);
    for (const [value, words] of field.options) select.add(new Option(words, value));
    select.addEventListener("change", () => {
      const number = Number(select.value);
      const value = Number.isNaN(number) ? select.value : number;
      this.changed(field.key, value, false, performance.now());
    });
    box.classList.add("choice");
    box.append(select, note);
    return { box, note, show: (value) => (select.value = String(value)), inputs: [select] };
  }
}

/** What a key is when a case does without it. */
function initial(field: Field | Choice): Value | undefined {
  return "options" in field
    ? field.key === "method.cells_per_diameter"
      ? 16
      : field.options[0]?.[0]
    : 0;
}

function frame(
  key: string,
  label: string,
  symbol: string,
): { box: HTMLElement; note: HTMLElement; id: string } {
  const id = key.replaceAll(".", "-");
  const box = document.createElement("div");
  box.className = "field";
  const name = document.createElement("label");
  name.htmlFor = id;
  name.textContent = label;
  if (symbol !== "") {
    const [letter = "", index] = symbol.split(/_\{|\}/);
    const italic = document.createElement("i");
    italic.textContent = letter;
    name.append(" ", italic);
    if (index !== undefined && index !== "") {
      const sub = document.createElement("sub");
      sub.textContent = index;
      name.append(sub);
    }
  }
  const note = document.createElement("p");
  note.id = `${id}-note`;
  note.className = "note";
  note.hidden = true;
  box.append(name);
  return { box, note, id };
}

/** The value at a place of the slider, in three digits. */
function sliderValue(field: Field, place: number): number {
  const [low, high] = field.range;
  const part = place / STEPS;
  const value = field.logarithmic ? low * (high / low) ** part : low + (high - low) * part;
  if (field.dimension === "angle") return Math.round(value / DEGREE) * DEGREE;
  return Number(value.toPrecision(3));
}

function sliderPlace(field: Field, value: number): string {
  const [low, high] = field.range;
  const part = field.logarithmic
    ? Math.log(value / low) / Math.log(high / low)
    : (value - low) / (high - low);
  return String(Math.round(STEPS * Math.min(1, Math.max(0, part))));
}

/** A value that follows from others, in the digits that are shown. */
function rounded(value: number): number {
  return Number(value.toPrecision(6));
}
