// The quantities of a case: a slider and a field with unit for each, and what is wrong with it.
import { editable, engineeringText, parse, unitOf, withUnit } from "./numbers.js";
import { FRACTION, PITCH, RECEDING, sticks, STUCK, WORK, withSpacing } from "./store.js";
const DEGREE = Math.PI / 180;
/** The tables of a case file that stand first on the page, before all others in their order. */
const FIRST_TABLES = ["texture", "texture.pillar"];
/** The words of a key that is either so or not. */
const [TRUE, FALSE] = ["true", "false"];
/** Steps of a slider. */
const STEPS = 1000;
/** What a field says that has no value: of a thickness, which half-spaces do not have. */
const ENDLESS = "endless";
/** All fields of a case. */
export class Controls {
    changed;
    widgets = new Map();
    /** The keys with a control: where there is only one word there is nothing to choose. */
    keys;
    constructor(container, keys, changed) {
        this.changed = changed;
        this.keys = keys.filter((key) => key.words.length !== 1);
        for (const table of new Set([...FIRST_TABLES, ...this.keys.map((key) => key.table)])) {
            const set = document.createElement("fieldset");
            const title = document.createElement("legend");
            title.textContent = titleOf(table);
            set.append(title);
            for (const key of this.keys.filter((key) => key.table === table)) {
                const widget = isField(key) ? this.field(key) : isFlag(key) ? this.flag(key) : this.choice(key);
                this.widgets.set(key.key, widget);
                set.append(widget.box);
            }
            container.append(set);
        }
    }
    /** Shows a case everywhere but in the field that was just `typed` into. */
    show(values, typed) {
        const shown = withReceding(withSpacing(values));
        this.widgets.get(FRACTION)?.box.classList.toggle("derived", values[FRACTION] === undefined);
        this.widgets.get(PITCH)?.box.classList.toggle("derived", values[PITCH] === undefined);
        const valueOf = (key) => shown[key.key] ?? key.default ?? "";
        for (const key of this.keys) {
            const widget = this.widgets.get(key.key);
            if (widget === undefined)
                continue;
            const condition = key.goes_with;
            const choice = this.keys.find(({ key }) => key === condition?.key);
            if (condition !== null && choice !== undefined) {
                widget.box.hidden = !condition.words.includes(String(valueOf(choice)));
            }
            widget.show(valueOf(key), key.key === typed);
        }
        const receding = this.widgets.get(RECEDING)?.box;
        receding?.classList.toggle("derived", values[RECEDING] === undefined);
        receding?.toggleAttribute("hidden", shown[RECEDING] === undefined);
        this.widgets.get(STUCK)?.box.toggleAttribute("hidden", !sticks(values) && values[STUCK] === undefined);
    }
    /** Shows what is wrong at its field, and nothing at others; false if it is at no field. */
    refuse(refusal) {
        let found = false;
        for (const [key, widget] of this.widgets) {
            const wrong = refusal !== null && refusal.key === key;
            const accepted = wrong && refusal.accepted !== null ? `: ${refusal.accepted}` : "";
            widget.note.textContent = wrong ? `${refusal.message}${accepted}` : "";
            widget.note.hidden = !wrong;
            widget.box.classList.toggle("wrong", wrong);
            for (const input of widget.inputs) {
                if (wrong)
                    input.setAttribute("aria-invalid", "true");
                else
                    input.removeAttribute("aria-invalid");
            }
            found ||= wrong;
        }
        return found;
    }
    field(field) {
        const { box, note, id, describedBy } = frame(field);
        const text = document.createElement("input");
        text.id = id;
        text.type = "text";
        text.inputMode = "decimal";
        text.spellcheck = false;
        text.autocomplete = "off";
        text.setAttribute("aria-describedby", describedBy);
        const slider = document.createElement("input");
        slider.id = `${id}-slider`;
        slider.type = "range";
        slider.min = "0";
        slider.max = String(STEPS);
        slider.setAttribute("aria-label", `${field.label}, slider`);
        slider.setAttribute("aria-describedby", describedBy);
        // A bare number has the unit of the value that it replaces.
        let unit = unitOf(editable(ends(field)[0], field.dimension));
        text.addEventListener("change", () => {
            text.value = withUnit(text.value, unit);
            unit = unitOf(text.value) || unit;
            const isEndless = field.endless && ["", ENDLESS, "∞"].includes(text.value.trim());
            const value = isEndless ? "" : (parse(text.value, field.dimension) ?? text.value);
            this.changed(field.key, value, true, performance.now());
        });
        const slide = () => {
            const value = sliderValue(field, Number(slider.value));
            this.changed(field.key, value, false, performance.now());
        };
        text.addEventListener("keydown", (event) => {
            const step = event.key === "ArrowUp" ? 5 : event.key === "ArrowDown" ? -5 : 0;
            if (step === 0)
                return;
            event.preventDefault();
            slider.value = String(Number(slider.value) + step);
            slide();
        });
        slider.addEventListener("input", slide);
        // A key that follows another one unless it is given needs no slider.
        slider.hidden = field.usual === null && field.default === null;
        box.append(text, slider, note);
        const show = (value, typed) => {
            if (typeof value !== "number") {
                const isEndless = field.endless && value === "";
                if (!typed)
                    text.value = isEndless ? ENDLESS : value;
                if (isEndless) {
                    slider.value = String(STEPS);
                    slider.setAttribute("aria-valuetext", ENDLESS);
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
    flag(key) {
        const { box, note, id, describedBy } = frame(key);
        const check = document.createElement("input");
        check.id = id;
        check.type = "checkbox";
        check.setAttribute("aria-describedby", describedBy);
        check.addEventListener("change", () => {
            this.changed(key.key, check.checked ? TRUE : FALSE, false, performance.now());
        });
        box.classList.add("flag");
        box.append(check, note);
        return { box, note, show: (value) => (check.checked = String(value) === TRUE), inputs: [check] };
    }
    choice(key) {
        const { box, note, id, describedBy } = frame(key);
        const select = document.createElement("select");
        select.id = id;
        select.setAttribute("aria-describedby", describedBy);
        for (const word of key.words)
            select.add(new Option(word, word));
        select.addEventListener("change", () => {
            this.changed(key.key, select.value, false, performance.now());
        });
        box.classList.add("choice");
        box.append(select, note);
        return { box, note, show: (value) => (select.value = String(value)), inputs: [select] };
    }
}
/** A case with the work of adhesion where contact is broken, which is that where it is made unless it is given; none where nothing sticks. */
function withReceding(values) {
    const work = values[WORK];
    if (values[RECEDING] !== undefined || typeof work !== "number" || work <= 0)
        return values;
    return { ...values, [RECEDING]: work };
}
/** Whether a key is either so or not. */
function isFlag({ words }) {
    return words.length === 2 && words.includes(TRUE) && words.includes(FALSE);
}
function isField(key) {
    return key.dimension !== null;
}
/** The heading of a table: `Pillar` for `texture.pillar`. */
function titleOf(table) {
    const name = table.slice(table.lastIndexOf(".") + 1);
    return name.charAt(0).toUpperCase() + name.slice(1);
}
/** A field with its label and its help, still without what can be changed. */
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
/** Whether the slider of a field begins at zero, before the usual values: what is zero unless it is given can be left out. */
function beginsAtZero({ default: value, usual }) {
    return value === 0 && usual !== null && usual[0] > 0;
}
/** Where a slider begins and ends. */
function ends({ usual, least, greatest }) {
    return usual ?? [least ?? 0, greatest ?? 1];
}
/** The value at a place of the slider, in three digits; nothing at the end of one that goes on without end. */
function sliderValue(field, place) {
    const [low, high] = ends(field);
    const part = place / STEPS;
    if (place === STEPS && field.endless)
        return "";
    if (place === 0 && beginsAtZero(field))
        return 0;
    // Where zero is not among them values go over decades.
    const value = low > 0 ? low * (high / low) ** part : low + (high - low) * part;
    if (field.whole)
        return Math.round(value);
    if (field.dimension === "angle")
        return Math.round(value / DEGREE) * DEGREE;
    return Number(value.toPrecision(3));
}
function sliderPlace(field, value) {
    const [low, high] = ends(field);
    const part = low > 0 ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low);
    return String(Math.round(STEPS * Math.min(1, Math.max(0, part))));
}
