// The input controls of a case: a field with unit and a slider for each quantity, and error messages.

import { editable, engineeringText, parse, unitOf, withUnit } from "./numbers.js";
import { FRACTION, PITCH, RECEDING, isCycle, isFlat, isRounded, ADHESIVE_FLOOR, WORK, withSpacing } from "./store.js";

/**
 * @import { Key, Value, Values } from "./engine.js"
 * @import { Dimension } from "./numbers.js"
 */

/**
 * A key that takes a number.
 * @typedef {Key & { dimension: Dimension }} Field
 */

const DEGREE = Math.PI / 180;

/** Tables of the case file that come first on the page; the others follow in their order. */
const FIRST_TABLES = ["surface", "pattern", "pattern.pillar"];

/** The two words of a key that is true or false. */
const [TRUE, FALSE] = ["true", "false"];

/** Number of steps of a slider. */
const STEPS = 1000;


/**
 * @typedef {object} Widget
 * @property {HTMLElement} box
 * @property {HTMLElement} note
 * @property {(value: Value, typed: boolean) => void} show Shows a value; a text that was just `typed` is not
 *   replaced.
 * @property {readonly HTMLElement[]} inputs
 */

/**
 * Called when a control changes; `typed` if the text of the field must stay as written.
 * @typedef {(key: string, value: Value, typed: boolean, asked: number) => void} Changed
 */

/** All controls of a case. */
export class Controls {
  /** @type {Map<string, Widget>} */
  #widgets = new Map();
  /**
   * The keys with a control. A key with only one word leaves no choice and has none.
   * @type {readonly Key[]}
   */
  #keys;
  /** @type {Changed} */
  #changed;
  /** @type {HTMLFieldSetElement[]} */
  #sets = [];

  /**
   * @param {HTMLElement} container
   * @param {readonly Key[]} keys
   * @param {Changed} changed
   */
  constructor(container, keys, changed) {
    this.#changed = changed;
    this.#keys = keys.filter((key) => key.words.length !== 1);
    for (const table of new Set([...FIRST_TABLES, ...this.#keys.map((key) => key.table)])) {
      const set = document.createElement("fieldset");
      const title = document.createElement("legend");
      title.textContent = titleOf(table);
      set.append(title);
      for (const key of this.#keys.filter((key) => key.table === table)) {
        const widget = this.#widget(key);
        this.#widgets.set(key.key, widget);
        set.append(widget.box);
      }
      this.#sets.push(set);
      container.append(set);
    }
  }

  /**
   * Shows a case in all controls but the field that was just `typed` into.
   * @param {Values} values
   * @param {string | null} typed
   */
  show(values, typed) {
    const shown = withReceding(withSpacing(values));
    this.#widgets.get(FRACTION)?.box.classList.toggle("derived", values[FRACTION] === undefined);
    this.#widgets.get(PITCH)?.box.classList.toggle("derived", values[PITCH] === undefined);
    const flat = isFlat(values);
    /** @type {(key: Key) => Value} */
    const valueOf = (key) => shown[key.key] ?? key.default ?? "";
    for (const key of this.#keys) {
      const widget = this.#widgets.get(key.key);
      if (widget === undefined) continue;
      const condition = key.goes_with;
      const choice = this.#keys.find(({ key }) => key === condition?.key);
      const isIdle = condition !== null && choice !== undefined && !condition.words.includes(String(valueOf(choice)));
      widget.box.hidden = isIdle || (flat && !key.on_flat);
      widget.show(valueOf(key), key.key === typed);
    }
    const receding = this.#widgets.get(RECEDING)?.box;
    receding?.classList.toggle("derived", values[RECEDING] === undefined);
    // Rounded tops have one work of adhesion.
    const hasReceding = shown[RECEDING] !== undefined && (!isRounded(values) || values[RECEDING] !== undefined);
    receding?.toggleAttribute("hidden", !hasReceding);
    this.#widgets.get(ADHESIVE_FLOOR)?.box.toggleAttribute("hidden", !isCycle(values) && values[ADHESIVE_FLOOR] === undefined);
    for (const set of this.#sets) set.hidden = ![...set.querySelectorAll(".field")].some((box) => !box.hasAttribute("hidden"));
  }

  /**
   * Shows an error at the field of a key and clears all others; false if there is no such field.
   * @param {string | null} wrongKey
   * @param {string} words
   * @returns {boolean}
   */
  refuse(wrongKey, words) {
    let found = false;
    for (const [key, widget] of this.#widgets) {
      const wrong = key === wrongKey;
      widget.note.textContent = wrong ? words : "";
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

  /**
   * @param {Key} key
   * @returns {Widget}
   */
  #widget(key) {
    if (isField(key)) return key.list ? this.#list(key) : this.#field(key);
    if (key.text) return this.#text(key);
    return isFlag(key) ? this.#flag(key) : this.#choice(key);
  }

  /**
   * A text; without one the key is not given.
   * @param {Key} key
   * @returns {Widget}
   */
  #text(key) {
    const { box, note, text } = textField(key);
    text.placeholder = key.default === null ? "headings" : String(key.default);
    text.addEventListener("change", () => this.#changed(key.key, text.value.trim(), true, performance.now()));
    box.append(text, note);
    /** @type {(value: Value, typed: boolean) => void} */
    const show = (value, typed) => {
      if (!typed) text.value = String(value);
    };
    return { box, note, show, inputs: [text] };
  }

  /**
   * @param {Field} field
   * @returns {Widget}
   */
  #field(field) {
    const { box, note, text, slider } = textAndSlider(field);
    text.inputMode = "decimal";
    // An empty field of a number without a default: the lattice has no end.
    if (field.default === null && field.whole) text.placeholder = "no end";
    // A number without a unit gets the unit of the value that it replaces.
    let unit = unitOf(editable(ends(field)[0], field.dimension));
    text.addEventListener("change", () => {
      text.value = withUnit(text.value, unit);
      unit = unitOf(text.value) || unit;
      const isInfinite = field.infinite && ["", field.infinite, "∞"].includes(text.value.trim());
      const value = isInfinite ? "" : (parse(text.value, field.dimension) ?? text.value);
      this.#changed(field.key, value, true, performance.now());
    });
    const slide = () => {
      const value = sliderValue(field, Number(slider.value));
      this.#changed(field.key, value, false, performance.now());
    };
    text.addEventListener("keydown", (event) => {
      const step = event.key === "ArrowUp" ? 5 : event.key === "ArrowDown" ? -5 : 0;
      if (step === 0) return;
      event.preventDefault();
      slider.value = String(Number(slider.value) + step);
      slide();
    });
    slider.addEventListener("input", slide);
    // A key that takes the value of another key by default has no slider.
    slider.hidden = field.usual === null && field.default === null;
    box.append(text, slider, note);
    /** @type {(value: Value, typed: boolean) => void} */
    const show = (value, typed) => {
      if (typeof value !== "number") {
        const infinite = value === "" ? field.infinite : null;
        if (!typed) text.value = infinite ?? value;
        if (infinite !== null) {
          slider.value = String(STEPS);
          slider.setAttribute("aria-valuetext", infinite);
        }
        return;
      }
      if (!typed) {
        text.value = editable(value, field.dimension);
        unit = unitOf(text.value);
      }
      if (document.activeElement !== slider || sliderPlace(field, value) !== slider.value) {
        slider.value = sliderPlace(field, value);
      }
      const words = engineeringText(value, field.dimension, 3).replace(/[{}]/g, "");
      slider.setAttribute("aria-valuetext", words);
    };
    return { box, note, show, inputs: [text, slider] };
  }

  /**
   * A list of numbers. The slider sets the number of a list with one.
   * @param {Field} field
   * @returns {Widget}
   */
  #list(field) {
    const { box, note, text, slider } = textAndSlider(field);
    text.placeholder = "elastic";
    /** @type {(value: Value) => string} */
    const wordsOf = (value) => (typeof value === "number" ? editable(value, field.dimension) : value);
    text.addEventListener("change", () => {
      const unit = unitOf(editable(ends(field)[1], field.dimension));
      const items = text.value.split(",").map((item) => withUnit(item.trim(), unit));
      this.#changed(field.key, items.join(", "), true, performance.now());
    });
    slider.addEventListener("input", () => {
      this.#changed(field.key, wordsOf(sliderValue(field, Number(slider.value))), false, performance.now());
    });
    box.append(text, slider, note);
    /** @type {(value: Value, typed: boolean) => void} */
    const show = (value, typed) => {
      const words = wordsOf(value);
      if (!typed) text.value = words;
      const number = parse(words, field.dimension);
      slider.hidden = words !== "" && number === null;
      slider.value = sliderPlace(field, number ?? ends(field)[0]);
      slider.setAttribute("aria-valuetext", words === "" ? text.placeholder : words);
    };
    return { box, note, show, inputs: [text, slider] };
  }

  /**
   * @param {Key} key
   * @returns {Widget}
   */
  #flag(key) {
    const { box, note, id, describedBy } = frame(key);
    const check = document.createElement("input");
    check.id = id;
    check.type = "checkbox";
    check.setAttribute("aria-describedby", describedBy);
    check.addEventListener("change", () => {
      this.#changed(key.key, check.checked ? TRUE : FALSE, false, performance.now());
    });
    box.classList.add("flag");
    box.append(check, note);
    return { box, note, show: (value) => (check.checked = String(value) === TRUE), inputs: [check] };
  }

  /**
   * @param {Key} key
   * @returns {Widget}
   */
  #choice(key) {
    const { box, note, id, describedBy } = frame(key);
    const select = document.createElement("select");
    select.id = id;
    select.setAttribute("aria-describedby", describedBy);
    for (const word of key.words) select.add(new Option(word, word));
    select.addEventListener("change", () => {
      this.#changed(key.key, select.value, false, performance.now());
    });
    box.classList.add("choice");
    box.append(select, note);
    /** @param {Value} value */
    const show = (value) => {
      const word = String(value);
      // A word that the page does not offer, but was given: the lattice of a table of pillars.
      if (word !== "" && ![...select.options].some((option) => option.value === word)) select.add(new Option(word, word));
      select.value = word;
    };
    return { box, note, show, inputs: [select] };
  }
}

/**
 * Adds the work of adhesion on unloading, which by default equals that on loading. A case without adhesion stays as
 * it is.
 * @param {Values} values
 * @returns {Values}
 */
function withReceding(values) {
  const work = values[WORK];
  if (values[RECEDING] !== undefined || typeof work !== "number" || work <= 0) return values;
  return { ...values, [RECEDING]: work };
}

/**
 * Whether a key is true or false.
 * @param {Key} key
 * @returns {boolean}
 */
function isFlag({ words }) {
  return words.length === 2 && words.includes(TRUE) && words.includes(FALSE);
}

/**
 * @param {Key} key
 * @returns {key is Field}
 */
function isField(key) {
  return key.dimension !== null;
}

/**
 * The heading of a table: `Pillar` for `pattern.pillar`.
 * @param {string} table
 * @returns {string}
 */
function titleOf(table) {
  const name = table.slice(table.lastIndexOf(".") + 1);
  return name.charAt(0).toUpperCase() + name.slice(1);
}

/**
 * @typedef {object} Frame
 * @property {HTMLElement} box
 * @property {HTMLElement} note
 * @property {string} id
 * @property {string} describedBy IDs of the elements with the meaning of the key and the error in its value.
 */

/**
 * The field of a text or a number, with its label and the note for errors.
 * @param {Key} key
 */
function textField(key) {
  const { box, note, id, describedBy } = frame(key);
  const text = document.createElement("input");
  text.id = id;
  text.type = "text";
  text.spellcheck = false;
  text.autocomplete = "off";
  text.setAttribute("aria-describedby", describedBy);
  return { box, note, text, id, describedBy };
}

/**
 * The frame of a control with a text and a slider, which are not in it yet.
 * @param {Field} field
 */
function textAndSlider(field) {
  const { box, note, text, id, describedBy } = textField(field);
  const slider = document.createElement("input");
  slider.id = `${id}-slider`;
  slider.type = "range";
  slider.min = "0";
  slider.max = String(STEPS);
  slider.setAttribute("aria-label", `${field.label}, slider`);
  slider.setAttribute("aria-describedby", describedBy);
  return { box, note, text, slider };
}

/**
 * A box with label and help of a key, to which the input is added.
 * @param {Key} key
 * @returns {Frame}
 */
function frame({ key, label, symbol, meaning }) {
  const id = key.replaceAll(".", "-");
  const box = document.createElement("div");
  box.className = "field";
  const name = document.createElement("label");
  name.htmlFor = id;
  name.title = meaning;
  name.textContent = label.replace("'", "’");
  if (symbol !== null) {
    const [letter = "", index = ""] = symbol.split("_");
    const italic = document.createElement("i");
    italic.textContent = letter;
    name.append(" ", italic);
    if (index !== "") {
      const sub = document.createElement("sub");
      sub.textContent = index;
      name.append(sub);
    }
  }
  const help = document.createElement("span");
  help.id = `${id}-help`;
  help.className = "unseen";
  help.textContent = meaning;
  const note = document.createElement("p");
  note.id = `${id}-note`;
  note.className = "note";
  note.hidden = true;
  box.append(name, help);
  return { box, note, id, describedBy: `${help.id} ${note.id}` };
}

/**
 * Whether the slider begins at zero, below the usual values: this is so for keys whose default is zero.
 * @param {Field} field
 * @returns {boolean}
 */
function beginsAtZero({ default: value, usual }) {
  return value === 0 && usual !== null && usual[0] > 0;
}

/**
 * The values at both ends of a slider.
 * @param {Field} field
 * @returns {readonly [number, number]}
 */
function ends({ usual, least, greatest }) {
  return usual ?? [least ?? 0, greatest ?? 1];
}

/**
 * The value at a position of the slider, to three digits; empty at the end of a slider that ends at infinity.
 * @param {Field} field
 * @param {number} place
 * @returns {Value}
 */
function sliderValue(field, place) {
  const [low, high] = ends(field);
  const part = place / STEPS;
  if (place === STEPS && field.infinite) return "";
  if (place === 0 && beginsAtZero(field)) return 0;
  // The scale is logarithmic unless it includes zero.
  const value = low > 0 ? low * (high / low) ** part : low + (high - low) * part;
  if (field.whole) return Math.round(value);
  if (field.dimension === "angle") return Math.round(value / DEGREE) * DEGREE;
  return Number(value.toPrecision(3));
}

/**
 * @param {Field} field
 * @param {number} value
 * @returns {string}
 */
function sliderPlace(field, value) {
  const [low, high] = ends(field);
  const part =
    low > 0 ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low);
  return String(Math.round(STEPS * Math.min(1, Math.max(0, part))));
}
