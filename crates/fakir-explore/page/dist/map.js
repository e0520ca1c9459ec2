// The contact map: pillars from above, coloured by the force they bear.
import { engineeringText, radiusDigits, significant } from "./numbers.js";
import { colour, colourCount, letterSize, tint } from "./theme.js";
const HALF_SQRT_3 = Math.sqrt(3) / 2;
/** Lengths of the scale bar are one of these times a power of ten. */
const ROUND = [1, 2, 5];
/** The canvas and what is on it. */
export class ContactMap {
    canvas;
    bar;
    note;
    state = null;
    criticalRadius = 0;
    largest = 0;
    scale = 1;
    constructor(canvas, bar, note) {
        this.canvas = canvas;
        this.bar = bar;
        this.note = note;
        canvas.addEventListener("pointermove", (event) => this.tell(event));
        canvas.addEventListener("pointerleave", () => (this.note.textContent = ""));
    }
    /** Shows a state; `criticalRadius` keeps the scale while the load changes. */
    show(scene, criticalRadius, largestForce) {
        this.state = scene;
        this.criticalRadius = criticalRadius;
        this.largest = Math.max(largestForce, ...chunkMaxima(scene.forces_N));
        this.draw();
    }
    /** The largest force on the colour bar, N. */
    get largestForce() {
        return this.largest;
    }
    draw() {
        const state = this.state;
        const context = this.canvas.getContext("2d");
        if (state === null || context === null)
            return;
        const ratio = window.devicePixelRatio || 1;
        const side = Math.round(this.canvas.clientWidth * ratio);
        if (side === 0)
            return;
        if (this.canvas.width !== side)
            this.canvas.width = this.canvas.height = side;
        const floor = touchesFloor(state)
            ? Math.max(0, ...state.floor_contacts_m.map(([x, y]) => Math.hypot(x, y)))
            : 0;
        const contact = Math.max(1.12 * this.criticalRadius, 1.12 * state.contact_radius_m, 1.3 * floor);
        // A few pillars, unless they are far apart.
        const few = contact > 0 ? Math.min(2.3 * state.pitch_m, 5 * contact) : 1.3 * state.pitch_m;
        const halfWidth = Math.max(contact, few);
        this.scale = side / (2 * halfWidth);
        context.setTransform(1, 0, 0, 1, 0, 0);
        context.fillStyle = tint("--floor");
        context.fillRect(0, 0, side, side);
        context.setTransform(this.scale, 0, 0, -this.scale, side / 2, side / 2);
        const pixel = ratio / this.scale;
        // Pillars are always seen, if need be larger than they are.
        const radius = Math.max(state.diameter_m / 2, 1.2 * pixel);
        this.drawUntouched(context, state, halfWidth, radius);
        this.drawPillars(context, state, pixel, radius);
        this.drawMarks(context, state, pixel);
        context.setTransform(1, 0, 0, 1, 0, 0);
        this.drawScaleBar(context, side, ratio);
        this.drawColourBar(ratio);
        this.canvas.setAttribute("aria-label", state.words);
    }
    /** Every pillar top in view, as if untouched. */
    drawUntouched(context, state, halfWidth, radius) {
        const { pitch_m: pitch, offset_m: offset } = state;
        const reach = Math.ceil((halfWidth + radius) / (HALF_SQRT_3 * pitch)) + 1;
        const limit = halfWidth + radius;
        const shift = Math.round(offset[0] / (HALF_SQRT_3 * pitch));
        context.beginPath();
        for (let column = shift - reach; column <= shift + reach; column += 1) {
            const x = HALF_SQRT_3 * pitch * column - offset[0];
            if (Math.abs(x) > limit)
                continue;
            const first = Math.ceil((offset[1] - limit) / pitch - column / 2);
            const last = Math.floor((offset[1] + limit) / pitch - column / 2);
            for (let row = first; row <= last; row += 1) {
                const y = pitch * (row + column / 2) - offset[1];
                context.moveTo(x + radius, y);
                context.arc(x, y, radius, 0, 2 * Math.PI);
            }
        }
        context.fillStyle = tint("--pillar");
        context.fill();
    }
    drawPillars(context, state, pixel, radius) {
        const count = colourCount() / 4;
        const groups = Array.from({ length: count }, () => new Path2D());
        const partial = new Path2D();
        // A ring around the rim.
        const width = Math.max(1.5 * pixel, 0.3 * radius);
        state.forces_N.forEach((force, k) => {
            const [x, y] = centre(state, k);
            const group = Math.round((force / this.largest) * (count - 1));
            const path = groups[Math.min(count - 1, Math.max(0, group))];
            path?.moveTo(x + radius, y);
            path?.arc(x, y, radius, 0, 2 * Math.PI);
            if (state.statuses[k] === "p") {
                const rim = radius + width / 2;
                partial.moveTo(x + rim, y);
                partial.arc(x, y, rim, 0, 2 * Math.PI);
            }
        });
        groups.forEach((path, k) => {
            context.fillStyle = colour(k * 4 + 2);
            context.fill(path);
        });
        context.strokeStyle = tint("--partial");
        context.lineWidth = width;
        context.stroke(partial);
    }
    /** Edge of the contact, lens axis, and where the floor is touched. */
    drawMarks(context, state, pixel) {
        const edge = state.contact_radius_m;
        const circle = (x, y, radius) => {
            context.beginPath();
            context.arc(x, y, radius, 0, 2 * Math.PI);
        };
        if (edge > 0) {
            circle(0, 0, edge);
            context.setLineDash([6 * pixel, 4 * pixel]);
            context.lineWidth = 1.4 * pixel;
            context.strokeStyle = tint("--ink");
            context.stroke();
            context.setLineDash([]);
        }
        const size = letterSize() * 0.32 * pixel;
        const touches = touchesFloor(state);
        for (const [x, y] of state.floor_contacts_m) {
            circle(x, y, size);
            context.lineWidth = 1.6 * pixel;
            context.strokeStyle = tint("--panel");
            context.fillStyle = tint("--mark");
            if (touches)
                context.fill();
            context.stroke();
            context.lineWidth = 1.2 * pixel;
            context.strokeStyle = tint("--mark");
            if (!touches)
                context.stroke();
        }
        context.beginPath();
        context.moveTo(-size, 0);
        context.lineTo(size, 0);
        context.moveTo(0, -size);
        context.lineTo(0, size);
        context.lineWidth = 1.5 * pixel;
        context.strokeStyle = tint("--axis-cross");
        context.stroke();
    }
    drawScaleBar(context, side, ratio) {
        const longest = (0.3 * side) / this.scale;
        const power = 10 ** Math.floor(Math.log10(longest));
        const length = power * Math.max(...ROUND.filter((step) => step * power <= longest));
        const size = letterSize() * ratio;
        const width = length * this.scale;
        const text = engineeringText(length, "length", 1);
        context.font = `${0.82 * size}px Roboto, system-ui, sans-serif`;
        const box = Math.max(width, context.measureText(text).width) + size;
        const [left, top] = [0.6 * size, side - 2.5 * size];
        context.fillStyle = tint("--veil");
        context.beginPath();
        context.roundRect(left, top, box, 1.95 * size, 0.25 * size);
        context.fill();
        context.fillStyle = tint("--ink");
        context.textAlign = "center";
        context.fillText(text, left + box / 2, top + 0.95 * size);
        context.fillRect(left + (box - width) / 2, top + 1.3 * size, width, 0.2 * size);
    }
    drawColourBar(ratio) {
        const context = this.bar.getContext("2d");
        if (context === null)
            return;
        const [width, height] = [this.bar.clientWidth * ratio, this.bar.clientHeight * ratio];
        this.bar.width = Math.max(1, Math.round(width));
        this.bar.height = Math.max(1, Math.round(height));
        for (let x = 0; x < this.bar.width; x += 1) {
            context.fillStyle = colour(Math.floor((x / this.bar.width) * colourCount()));
            context.fillRect(x, 0, 1, this.bar.height);
        }
    }
    /** The pillar under the pointer, in words. */
    tell(event) {
        const state = this.state;
        if (state === null)
            return;
        const ratio = window.devicePixelRatio || 1;
        const half = this.canvas.clientWidth / 2;
        const x = ((event.offsetX - half) * ratio) / this.scale;
        const y = ((half - event.offsetY) * ratio) / this.scale;
        const place = `${engineeringText(Math.hypot(x, y), "length", 3)} from the axis`;
        let words = place;
        for (let k = 0; k < state.forces_N.length; k += 1) {
            const [a, b] = centre(state, k);
            if (Math.hypot(a - x, b - y) <= state.diameter_m / 2) {
                const force = engineeringText(state.forces_N[k] ?? 0, "force", 4);
                const partly = state.statuses[k] === "p" ? ", in contact in part" : "";
                words = `pillar ${force}${partly}, ${place}`;
            }
        }
        this.note.textContent = words.replace(/\^\{(.*?)\}/g, "^$1");
    }
}
/** A state as it is drawn. */
export function sceneOf(state) {
    const { summary } = state;
    if (summary.method === "homogenised") {
        const { force_N, contact_radius_m } = summary;
        return sceneOfPreview({ ...state, force_N, contact_radius_m });
    }
    const { pillars_in_contact: all, pillars_partially_in_contact: part } = summary;
    const radius = engineeringText(summary.contact_radius_m, "length", Math.min(3, radiusDigits(summary.relative_error_estimate.contact_radius)));
    return {
        fraction: state.fraction,
        pitch_m: state.pitch_m,
        diameter_m: state.diameter_m,
        offset_m: state.offset_m,
        contact_radius_m: summary.contact_radius_m,
        beyond: state.fraction > 1 + 1e-9,
        pillars: state.pillars,
        forces_N: state.pillar_forces_N,
        statuses: state.pillar_statuses,
        floor_contacts_m: state.floor_contacts_m,
        words: `Contact from above: ${all} pillars in contact, ${part} of them in part, ` +
            `within ${radius} of the lens axis, a/e = ${significant(state.normalized[1], 3)}`,
    };
}
/** A preview as it is drawn: forces fall off as under a sphere, and bear the load together. */
export function sceneOfPreview(preview) {
    const { pitch_m: pitch, contact_radius_m: radius, offset_m: offset } = preview;
    const pillars = [];
    const forces = [];
    const reach = Math.ceil((1.2 * (radius + Math.hypot(...offset))) / pitch) + 1;
    let sum = 0;
    for (let i = -reach; i <= reach; i += 1) {
        for (let j = -reach; j <= reach; j += 1) {
            const x = HALF_SQRT_3 * pitch * (i + j) - offset[0];
            const y = 0.5 * pitch * (i - j) - offset[1];
            const squared = (x * x + y * y) / (radius * radius);
            if (squared >= 1)
                continue;
            const force = Math.sqrt(1 - squared);
            sum += force;
            pillars.push(i, j);
            forces.push(force);
        }
    }
    return {
        fraction: preview.fraction,
        pitch_m: pitch,
        diameter_m: preview.diameter_m,
        offset_m: offset,
        contact_radius_m: radius,
        beyond: false,
        pillars,
        forces_N: forces.map((force) => (force * preview.force_N) / sum),
        statuses: "",
        floor_contacts_m: [],
        words: "Contact from above, estimated by the homogenised lattice",
    };
}
function touchesFloor(scene) {
    return Math.abs(scene.fraction - 1) < 1e-9 || scene.beyond;
}
/** Centre of the k-th touched pillar, m. */
function centre(state, k) {
    const i = state.pillars[2 * k] ?? 0;
    const j = state.pillars[2 * k + 1] ?? 0;
    return [
        HALF_SQRT_3 * state.pitch_m * (i + j) - state.offset_m[0],
        0.5 * state.pitch_m * (i - j) - state.offset_m[1],
    ];
}
/** Largest of every thousand values: there are too many to be arguments of one call. */
function chunkMaxima(values) {
    const maxima = [0];
    for (let start = 0; start < values.length; start += 1000) {
        maxima.push(Math.max(...values.slice(start, start + 1000)));
    }
    return maxima;
}
