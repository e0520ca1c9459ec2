// What the map shows of a state, or of what is nearly one.
import { engineeringText, radiusDigits, significant } from "./numbers.js";
export const HALF_SQRT_3 = Math.sqrt(3) / 2;
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
        pillars: state.pillars,
        forces_N: state.pillar_forces_N,
        statuses: state.pillar_statuses,
        parts: [],
        pull_N: 0,
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
    return {
        fraction: state.load,
        pitch_m: cycle.pitch_m,
        diameter_m: cycle.diameter_m,
        offset_m: cycle.offset_m,
        contact_radius_m: radius,
        pillars: state.pillars,
        forces_N: forces,
        statuses: forces.map((_, k) => (partial.has(k) ? "p" : "f")).join(""),
        parts: state.parts,
        pull_N: cycle.largest_pull_N,
        floor_contacts_m: state.floor_contacts_m,
        floor: null,
        floorIsOlder: false,
        words: `Contact from above, ${station?.branch ?? "loading"}: ${all} pillars in contact, ` +
            `${partial.size} of them in part, ${pulled} pulled, ` +
            `within ${engineeringText(radius, "length", 3)} of the lens axis`,
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
    const pillars = ({ pitch_m, diameter_m, offset_m }) => [pitch_m, diameter_m, ...offset_m].join();
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
    const i = scene.pillars[2 * k] ?? 0;
    const j = scene.pillars[2 * k + 1] ?? 0;
    return [
        HALF_SQRT_3 * scene.pitch_m * (i + j) - scene.offset_m[0],
        0.5 * scene.pitch_m * (i - j) - scene.offset_m[1],
    ];
}
/** The largest force on a pillar, N. */
export function largestForceOf(scene) {
    return scene.forces_N.reduce((largest, force) => Math.max(largest, force), 0);
}
