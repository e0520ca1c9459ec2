// The section through lens and surface, deformed, with heights exaggerated.
import { element, path, text } from "./charts.js";
import { engineeringText, significant } from "./numbers.js";
import { letterSize, onSize } from "./theme.js";
/** An SVG element with the section. */
export class SectionView {
    svg;
    told;
    section = null;
    state = null;
    wanted = null;
    constructor(svg, told) {
        this.svg = svg;
        this.told = told;
        onSize(svg, () => this.draw());
    }
    show(section, state) {
        this.section = section;
        this.state = state;
        this.draw();
    }
    /** Heights over widths; null for what fills the view. */
    exaggerate(factor) {
        this.wanted = factor;
        this.draw();
    }
    draw() {
        const { width, height } = this.svg.getBoundingClientRect();
        if (width < 40 || height < 40)
            return;
        this.svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
        const em = letterSize();
        const section = this.section;
        if (section === null) {
            const words = "this method does not resolve the section";
            const note = text(words, width / 2, height / 2, "middle");
            note.setAttribute("class", "region");
            this.svg.replaceChildren(note);
            return;
        }
        const half = section.x_m[section.x_m.length - 1] ?? 1;
        const [low, high] = span(section, 0.01 * half);
        const across = width / (2 * half);
        const fitting = (0.62 * height) / (high - low) / across;
        const factor = this.wanted ?? fitting;
        this.told(factor);
        const up = across * factor;
        const middle = (low + high) / 2;
        const place = (x, z) => `${((x + half) * across).toFixed(1)} ${clamp(height * 0.56 - (z - middle) * up, height)}`;
        const outline = (heights) => section.x_m.map((x, k) => place(x, heights[k] ?? 0)).join("L");
        const lens = outline(section.lens_m);
        const surface = outline(section.surface_m);
        const parts = [
            path(`M${surface}L${width} ${height + 9}L0 ${height + 9}Z`, "substrate"),
            path(`M${lens}L${width} -9L0 -9Z`, "lens"),
            path(`M${surface}`, "outline"),
            path(`M${lens}`, "outline"),
        ];
        parts.push(...this.floorMarks(section, place, em));
        parts.push(...this.names(width, height, em, across));
        this.svg.replaceChildren(...parts);
    }
    /** Where the floor is touched in the plane of the section. */
    floorMarks(section, place, em) {
        const state = this.state;
        if (state === null || Math.abs(state.fraction - 1) > 1e-9)
            return [];
        return state.floor_contacts_m
            .filter(([, y]) => Math.abs(y) < 0.02 * state.pitch_m)
            .map(([x]) => {
            const nearest = section.x_m.reduce((best, value, k) => Math.abs(value - x) < Math.abs((section.x_m[best] ?? 0) - x) ? k : best, 0);
            const [cx = "0", cy = "0"] = place(x, section.surface_m[nearest] ?? 0).split(" ");
            const tip = Number(cy) + 0.15 * em;
            const d = `M${cx} ${tip}l${-0.35 * em} ${0.7 * em}h${0.7 * em}Z`;
            return path(d, "floor-mark");
        });
    }
    names(width, height, em, across) {
        const lens = text("lens", width / 2, 1.4 * em, "middle");
        const substrate = text("substrate", 0.7 * em, height - 0.8 * em, "start");
        const longest = (0.2 * width) / across;
        const power = 10 ** Math.floor(Math.log10(longest));
        const length = power * Math.max(...[1, 2, 5].filter((step) => step * power <= longest));
        const end = width - 0.8 * em;
        const y = height - 0.7 * em;
        const bar = element("path", {
            d: `M${end - length * across} ${y}H${end}`,
            class: "scale-bar",
        });
        const label = text(engineeringText(length, "length", 1), end, y - 0.45 * em, "end");
        for (const name of [lens, substrate, label])
            name.setAttribute("class", "body-name");
        return [lens, substrate, bar, label];
    }
}
/** Lowest and highest point of the surface; at least so far apart that rounding is not seen. */
function span(section, least) {
    let [low, high] = [Infinity, -Infinity];
    for (const z of section.surface_m) {
        low = Math.min(low, z);
        high = Math.max(high, z);
    }
    const rest = Math.max(0, least - (high - low)) / 2;
    return [low - rest, high + rest];
}
function clamp(y, height) {
    return Math.min(height + 9, Math.max(-9, y)).toFixed(1);
}
/** An exaggeration in words. */
export function times(factor) {
    return `heights × ${significant(factor, factor >= 100 ? 3 : 2)}`;
}
