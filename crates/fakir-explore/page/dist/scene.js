// What the map shows of a state, or of what is nearly one.
import { engineeringText, radiusDigits, significant } from "./numbers.js";
/** A state as it is drawn. */
export function sceneOf(state) {
    const { summary } = state;
    if (summary.method === "homogenised") {
        const { force_N, contact_radius_m } = summary;
        return sceneOfPreview({ ...state, force_N, contact_radius_m });
    }
    const { pillars_in_contact: all, pillars_partially_in_contact: part } = summary;
    const edge = summary.top_contact_radius_m ?? summary.contact_radius_m;
    const radius = engineeringText(edge, "length", Math.min(3, radiusDigits(summary.relative_error_estimate.contact_radius)));
    return {
        fraction: state.fraction,
        pitch_m: state.pitch_m,
        diameter_m: state.diameter_m,
        lattice: state.lattice,
        contact_radius_m: edge,
        pillars: state.pillars,
        forces_N: state.pillar_forces_N,
        statuses: state.pillar_statuses,
        parts: [],
        pull_N: state.pillar_forces_N.reduce((least, force) => Math.min(least, force), 0),
        floor_contacts_m: state.floor_contacts_m,
        floor: state.floor,
        floorIsOlder: false,
        words: `Contact from above: ${all} pillars in contact, ${part} of them in part, ` +
            `within ${radius} of the lens axis, a/e = ${significant(state.normalized[1], 3)}` +
            (summary.floor === null
                ? ""
                : `; the floor is in contact within ${engineeringText(summary.floor.radius_m, "length", 3)}`),
    };
}
/** A state of a cycle as it is drawn. */
export function sceneOfStation(cycle, state) {
    const station = cycle.summary.stations[state.place];
    const forces = state.pillar_forces_N;
    const partial = new Set(state.parts.map(({ pillar }) => pillar));
    const pulled = forces.filter((force) => force < 0).length;
    const [all, radius] = [forces.length, station?.contact_radius_m ?? 0];
    const onFloor = floorAt(cycle, state);
    return {
        fraction: state.load,
        pitch_m: cycle.pitch_m,
        diameter_m: cycle.diameter_m,
        lattice: cycle.lattice,
        contact_radius_m: radius,
        pillars: state.pillars,
        forces_N: forces,
        statuses: forces.map((_, k) => (partial.has(k) ? "p" : "f")).join(""),
        parts: state.parts,
        pull_N: cycle.largest_pull_N,
        floor_contacts_m: state.floor_contacts_m,
        floor: state.floor,
        floorIsOlder: false,
        words: `Contact from above, ${station?.branch ?? "loading"}: ${all} pillars in contact, ` +
            `${partial.size} of them in part, ${pulled} pulled, ` +
            `within ${engineeringText(radius, "length", 3)} of the lens axis` +
            (onFloor === null ? "" : `; the floor sticks, ${holesWords(onFloor.filled_holes)} filled`),
    };
}
/** What of a floor that sticks is in contact at a station; null if nothing is. */
export function floorAt(cycle, state) {
    return cycle.summary.floor?.stations.find(({ station }) => station === state.place) ?? null;
}
export function holesWords(holes) {
    return `${holes} ${holes === 1 ? "hole" : "holes"}`;
}
/** A preview as it is drawn: forces fall off as under a sphere, and bear the load together. */
export function sceneOfPreview(preview) {
    const { contact_radius_m: radius, lattice } = preview;
    const pillars = [];
    const forces = [];
    let sum = 0;
    for (const [i, j, x, y] of pillarsWithin(lattice, radius)) {
        const squared = (x * x + y * y) / (radius * radius);
        if (squared >= 1)
            continue;
        const force = Math.sqrt(1 - squared);
        sum += force;
        pillars.push(i, j);
        forces.push(force);
    }
    return {
        fraction: preview.fraction,
        pitch_m: preview.pitch_m,
        diameter_m: preview.diameter_m,
        lattice,
        contact_radius_m: radius,
        pillars,
        forces_N: forces.map((force) => (force * preview.force_N) / sum),
        statuses: "",
        parts: [],
        pull_N: 0,
        floor_contacts_m: [],
        floor: null,
        floorIsOlder: false,
        words: "Contact from above, estimated by the homogenised lattice",
    };
}
/** A scene of the pillar tops alone, with the floor of the scene before, grey, if that has the same pillars. */
export function withFloorBefore(scene, before) {
    const pillars = ({ diameter_m, lattice: { vectors_m, origin_m } }) => [diameter_m, ...vectors_m.flat(), ...origin_m].join();
    if (before === null || before.floor === null || pillars(before) !== pillars(scene))
        return scene;
    return { ...scene, floor: before.floor, floorIsOlder: true, floor_contacts_m: [] };
}
/** Whether the floor is touched, or would be, where the scene says. */
export function touchesFloor({ fraction }) {
    return fraction > 1 - 1e-9;
}
/** Centre of the k-th touched pillar, m. */
export function centre(scene, k) {
    return place(scene.lattice, scene.pillars[2 * k] ?? 0, scene.pillars[2 * k + 1] ?? 0);
}
function place({ vectors_m: [a, b], origin_m }, i, j) {
    return [origin_m[0] + i * a[0] + j * b[0], origin_m[1] + i * a[1] + j * b[1]];
}
/** All pillars with centres in a square around the lens axis, of this half width (m): indices and centre of each. */
export function* pillarsWithin(lattice, half) {
    const [[a, b], [c, d]] = lattice.vectors_m;
    const [x0, y0] = lattice.origin_m;
    const area = a * d - b * c;
    if (area === 0)
        return;
    const missing = new Set();
    for (let k = 0; k + 1 < lattice.missing.length; k += 2) {
        missing.add(`${lattice.missing[k] ?? 0} ${lattice.missing[k + 1] ?? 0}`);
    }
    // The indices of the corners of the square bound those of all pillars in it.
    const corners = [-half, half].flatMap((x) => [-half, half].map((y) => [x - x0, y - y0]));
    const rows = corners.map(([x, y]) => (x * d - y * c) / area);
    const [low, high] = lattice.range ?? [-Infinity, Infinity];
    const first = Math.max(low, Math.ceil(Math.min(...rows)));
    const last = Math.min(high - 1, Math.floor(Math.max(...rows)));
    for (let i = first; i <= last; i += 1) {
        // Along a row the square is entered and left where x or y are at its sides.
        const [x, y] = place(lattice, i, 0);
        const [from, to] = within([x, c, half], within([y, d, half], [low, high - 1]));
        for (let j = Math.ceil(from); j <= Math.floor(to); j += 1) {
            if (missing.size > 0 && missing.has(`${i} ${j}`))
                continue;
            yield [i, j, x + j * c, y + j * d];
        }
    }
}
/** The part of a range of t in which start + t step is no farther from 0 than that. */
function within([start, step, limit], [low, high]) {
    if (step === 0)
        return Math.abs(start) <= limit ? [low, high] : [1, 0];
    const ends = [(-limit - start) / step, (limit - start) / step];
    return [Math.max(low, Math.min(...ends)), Math.min(high, Math.max(...ends))];
}
/** The largest force on a pillar, N. */
export function largestForceOf(scene) {
    return scene.forces_N.reduce((largest, force) => Math.max(largest, force), 0);
}
