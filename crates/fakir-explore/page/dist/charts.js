// Charts on logarithmic or linear axes, as SVG: colours and lettering are those of the style sheet.
import { engineering, significant, write } from "./numbers.js";
import { letterSize } from "./theme.js";
const SVG = "http://www.w3.org/2000/svg";
/** Fills an SVG element with a chart. */
export function drawChart(svg, axes, contents) {
    const { width, height } = svg.getBoundingClientRect();
    if (width < 40 || height < 40)
        return;
    const em = letterSize();
    const frame = {
        left: 4.9 * em,
        right: width - 0.9 * em,
        top: 0.7 * em,
        bottom: height - (axes.bare ? 0.5 : 2.9) * em,
    };
    const [scale, ticks] = axes.linear ? [linear, evenTicks] : [logarithmic, decadeTicks];
    const across = scale(contents.x, frame.left, frame.right);
    const up = scale(contents.y, frame.bottom, frame.top);
    const placed = ({ points }) => points.map(([x, y]) => [across(x), up(y)]);
    const clip = `${svg.id}-frame`;
    const box = rectangle(frame.left, frame.top, frame.right, frame.bottom);
    svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    const inside = element("g", { "clip-path": `url(#${clip})` });
    const grid = element("g", { class: "grid" });
    const lettering = element("g", { class: "lettering" });
    for (const { value, label } of ticks(contents.x, (frame.right - frame.left) / (3.4 * em))) {
        const x = across(value).toFixed(1);
        grid.append(path(`M${x} ${frame.top}V${frame.bottom}`, label ? "major" : "minor"));
        if (label && !axes.bare) {
            const words = wordsOf(value, axes.xDimension ?? "number", axes);
            lettering.append(text(words, across(value), frame.bottom + 1.15 * em, "middle"));
        }
    }
    for (const { value, label } of ticks(contents.y, (frame.bottom - frame.top) / (1.3 * em))) {
        const y = up(value).toFixed(1);
        grid.append(path(`M${frame.left} ${y}H${frame.right}`, label ? "major" : "minor"));
        if (label) {
            const words = wordsOf(value, axes.yDimension, axes);
            lettering.append(text(words, frame.left - 0.45 * em, up(value) + 0.32 * em, "end"));
        }
    }
    for (const series of contents.series) {
        if (series.kind === "points") {
            for (const [x, y] of placed(series).filter(isPlace)) {
                const [cx, cy] = [x.toFixed(1), y.toFixed(1)];
                inside.append(element("circle", { cx, cy, class: series.style, r: String(0.24 * em) }));
            }
        }
        else if (series.kind === "vertical") {
            for (const [x] of series.points) {
                const d = `M${across(x).toFixed(1)} ${frame.top}V${frame.bottom}`;
                inside.append(path(d, series.style));
            }
        }
        else if (series.kind === "ticks-above" || series.kind === "ticks-below") {
            const above = series.kind === "ticks-above";
            const [from, to] = above
                ? [frame.top, frame.top + 0.5 * em]
                : [frame.bottom, frame.bottom - 0.5 * em];
            const places = new Set(series.points.map(([x]) => across(x).toFixed(1)));
            inside.append(path([...places].map((x) => `M${x} ${from}V${to}`).join(""), series.style));
        }
        else if (series.points.length > 0) {
            const close = series.kind === "area" ? "Z" : "";
            inside.append(path(`${through(placed(series))}${close}`, series.style));
        }
    }
    for (const { place, text: words, style } of contents.names ?? []) {
        const name = text(words, across(place[0]), up(place[1]), "middle");
        name.setAttribute("class", style);
        inside.append(name);
    }
    if (!axes.bare) {
        const middle = (frame.left + frame.right) / 2;
        const label = text(axes.xLabel, middle, height - 0.45 * em, "middle");
        label.setAttribute("class", "label");
        lettering.append(label);
    }
    const side = text(axes.yLabel, 0, 0, "middle");
    const middle = (frame.top + frame.bottom) / 2;
    side.setAttribute("transform", `translate(${0.95 * em} ${middle}) rotate(-90)`);
    side.setAttribute("class", "label");
    lettering.append(side);
    const clipping = element("clipPath", { id: clip });
    clipping.append(path(box, ""));
    svg.replaceChildren(clipping, grid, inside, path(box, "frame"), lettering);
}
/** Whether both axes have a place for a point: 0 is on no logarithmic one. */
function isPlace(place) {
    return place.every(Number.isFinite);
}
/** A path through the places, interrupted where there is none. */
function through(places) {
    let step = "M";
    return places
        .map((place) => {
        const drawn = isPlace(place) ? `${step}${place.map((value) => value.toFixed(1)).join(" ")}` : "";
        step = drawn === "" ? "M" : "L";
        return drawn;
    })
        .join("");
}
/** A number in words, as a power of ten where it would be long. */
function number(value) {
    const power = Math.round(Math.log10(value));
    const isPower = Math.abs(value / 10 ** power - 1) < 1e-9;
    if (isPower && (power > 3 || power < -2))
        return `10^{${String(power).replace("-", "−")}}`;
    return significant(value, 1);
}
/** A tick in words. */
function wordsOf(value, dimension, { linear }) {
    if (value === 0)
        return "0";
    if (dimension === "number")
        return number(value);
    const { number: digits, unit } = engineering(value, dimension, linear ? 3 : 1);
    // Even ticks have at most three digits, of which zeros at the end are not written.
    return `${linear ? digits.replace(/\.0+$|(\.\d*?)0+$/, "$1") : digits} ${unit}`;
}
function linear([low, high], first, last) {
    return (value) => first + ((value - low) / (high - low)) * (last - first);
}
/** Ticks at whole multiples of a round step, as many as there is room for. The range need not begin with one. */
function evenTicks([low, high], room) {
    const least = (high - low) / Math.max(2, Math.min(6, room));
    const power = 10 ** Math.floor(Math.log10(least));
    const step = [1, 2, 5, 10].map((round) => round * power).find((round) => round >= least) ?? least;
    const [first, last] = [Math.ceil(low / step - 1e-4), Math.floor(high / step + 1e-4)];
    return Array.from({ length: Math.max(0, last - first + 1) }, (_, k) => ({
        value: Number(((first + k) * step).toPrecision(12)),
        label: true,
    }));
}
function logarithmic([low, high], first, last) {
    const [start, length] = [Math.log(low), Math.log(high) - Math.log(low)];
    return (value) => first + ((Math.log(value) - start) / length) * (last - first);
}
/** Ticks at whole numbers of every decade; labels at as many as there is room for. */
function decadeTicks([low, high], room) {
    const [first, last] = [Math.floor(Math.log10(low)), Math.ceil(Math.log10(high))];
    const decades = Math.log10(high / low);
    const every = Math.max(1, Math.ceil(decades / Math.max(1, room)));
    const digits = 3 * decades + 1 <= room ? [1, 2, 5] : [1];
    const result = [];
    for (let power = first; power <= last; power += 1) {
        for (let digit = 1; digit < 10; digit += 1) {
            const value = Number(`${digit}e${power}`);
            if (value < low * 0.9999 || value > high * 1.0001)
                continue;
            const label = digits.includes(digit) && power % every === 0;
            if (label || (every === 1 && decades < 7))
                result.push({ value, label });
        }
    }
    return result;
}
/** The range of values with some room around them. */
export function range(values, room = 1.3) {
    const positive = values.filter((value) => value > 0 && Number.isFinite(value));
    if (positive.length === 0)
        return [1, 10];
    const [low, high] = [Math.min(...positive) / room, Math.max(...positive) * room];
    return high / low < 4 ? [low / 1.5, high * 1.5] : [low, high];
}
export function element(name, attributes) {
    const made = document.createElementNS(SVG, name);
    for (const [key, value] of Object.entries(attributes))
        made.setAttribute(key, value);
    return made;
}
export function path(d, style) {
    return element("path", { d, class: style });
}
export function rectangle(left, top, right, bottom) {
    return `M${left} ${top}H${right}V${bottom}H${left}Z`;
}
export function text(words, x, y, anchor) {
    const made = element("text", { x: x.toFixed(1), y: y.toFixed(1), "text-anchor": anchor });
    write(made, words);
    return made;
}
