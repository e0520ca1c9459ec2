// The page: what it shows and what it asks, in step with its address.
import { Chart, range } from "./charts.js";
import { Controls } from "./controls.js";
import { ask, cancel, fetchFile, Refused, start, } from "./engine.js";
import { ContactMap, sceneOf, sceneOfPreview } from "./map.js";
import { digitsFor, engineering, engineeringText, radiusDigits, significant, write } from "./numbers.js";
import { SectionView, times } from "./section.js";
import { onScheme, onSize, setColours } from "./theme.js";
/** The paper's lens and pillars, and its three substrates. */
const PAPER = {
    "lens.radius": 2.2e-3,
    "lens.young_modulus": 2e6,
    "lens.poisson_ratio": 0.5,
    "substrate.poisson_ratio": 0.5,
    "texture.offset": 0,
    "texture.offset_angle": 0,
    "texture.pillar.diameter": 6e-6,
    "texture.pillar.height": 2.2e-6,
    "texture.pillar.compliance": "column",
    "method.name": "spectral",
    "method.accuracy": "default",
};
const SUBSTRATES = { rigid: 1e9, intermediate: 2e6, soft: 2e3 };
/** Farthest load on the slider, critical loads. */
const FARTHEST = 1.3;
/** A load this close to the critical one is meant to be it, when it comes from a pointer. */
const SNAP = 0.012;
/** A computation that takes longer than this, ms, is given up for a newer one; shorter ones are
 * shown, so that the picture moves while a slider does. */
const GRACE = [120, 700];
/** What is computed in the background waits so long, ms, for the next change. */
const CALM = 200;
function byId(id) {
    const found = document.getElementById(id);
    if (found === null)
        throw new Error(`no element ${id}`);
    return found;
}
const controls = new Controls(byId("fields"), (asked) => changed(asked));
const map = new ContactMap(byId("map"), byId("colour-bar"), byId("map-note"));
const section = new SectionView(byId("section"), (factor) => {
    byId("exaggeration-words").textContent = times(factor);
    const slider = byId("exaggeration");
    if (exaggeration === null)
        slider.value = String(Math.log10(factor));
    slider.setAttribute("aria-valuetext", times(factor));
});
const phaseChart = new Chart(byId("phase"), {
    xLabel: "contact radius over pitch, a/e",
    yLabel: "F γ_{int}/(h d)",
    yDimension: "number",
});
const curveCharts = {
    force: new Chart(byId("curve-force"), {
        xLabel: "",
        yLabel: "F_{c}",
        yDimension: "force",
        bare: true,
    }),
    radius: new Chart(byId("curve-radius"), {
        xLabel: "",
        yLabel: "a_{c}",
        yDimension: "length",
        bare: true,
    }),
    indentation: new Chart(byId("curve-indentation"), {
        xLabel: "surface fraction φ",
        yLabel: "ζ_{c}",
        yDimension: "length",
    }),
};
let load = 1;
let exaggeration = null;
/** The case that `critical` belongs to, and the one that the curves belong to. */
let criticalOf = "";
let curvesOf = "";
let critical = null;
let state = null;
let largestForce = 0;
let texts = null;
let curves = { method: "", small: [], large: [], homogenised: [], exact: [] };
let transition = [];
let loadingPath = [];
let wanted = null;
let solving = false;
let pictured = true;
let sent = 0;
let lastTime = 100;
let calm;
/** Something was changed: asks for a new picture. */
function changed(asked) {
    const values = controls.case;
    const name = JSON.stringify(values);
    wanted = { case: values, name, load, asked };
    document.body.dataset["busy"] = "yes";
    if (name !== curvesOf) {
        cancel("curves");
        cancel("phase");
        curvesOf = "";
    }
    window.clearTimeout(calm);
    remember();
    if (!solving) {
        void solve();
        return;
    }
    const grace = Math.min(GRACE[1], Math.max(GRACE[0], 2 * lastTime));
    window.setTimeout(() => {
        if (wanted !== null && !pictured)
            cancel("contact");
    }, Math.max(0, grace - (performance.now() - sent)));
}
async function solve() {
    solving = true;
    while (wanted !== null) {
        const question = wanted;
        wanted = null;
        pictured = false;
        sent = performance.now();
        try {
            await answer(question);
        }
        catch (error) {
            refuse(error);
        }
    }
    solving = false;
    // After what is still to be drawn.
    requestAnimationFrame(() => {
        if (!solving)
            document.body.dataset["busy"] = "no";
    });
    calm = window.setTimeout(() => void background(), CALM);
}
async function answer(question) {
    const known = question.name === criticalOf ? critical : null;
    const point = known === null
        ? { fraction: question.load }
        : {
            fraction: question.load,
            critical_indentation_m: known.critical_indentation_m,
        };
    const body = { case: question.case, load: point };
    const whole = await ask("contact", body, (line) => {
        if (line.progress)
            tellProgress(line);
        if (line.preview)
            preview(line.preview, question);
        if (line.state)
            picture(line.state, question);
        if (line.critical) {
            critical = line.critical;
            criticalOf = question.name;
            if (pictured)
                requestAnimationFrame(numbers);
        }
        if (line.case)
            showTexts(line.case);
        if (line.section !== undefined)
            section.show(line.section, state);
    });
    if (whole && state !== null) {
        byId("work").textContent = `${state.summary.method}, solved in ${milliseconds(state)}`;
    }
}
/** Shows a state. */
function picture(next, question) {
    if (next.approximate) {
        const scene = sceneOf(next);
        sketch(scene, scene.contact_radius_m, question);
        if (question.load === 1 && question.name !== criticalOf) {
            const { force_N: force, indentation_m: indentation } = next.summary;
            estimate(force, next.summary.contact_radius_m, indentation);
        }
        onScreen(question, "pillars");
        return;
    }
    pictured = true;
    lastTime = performance.now() - sent;
    if (Math.abs(next.fraction - 1) < 1e-9 || question.name !== largestOf)
        largestForce = 0;
    largestOf = question.name;
    state = next;
    const known = question.name === criticalOf ? critical : null;
    map.show(sceneOf(next), known?.critical_contact_radius_m ?? 0, largestForce);
    largestForce = map.largestForce;
    accept();
    onScreen(question, "exact");
    if (known !== null)
        requestAnimationFrame(numbers);
}
/** Shows what is known at once. */
function preview(next, question) {
    sketch(sceneOfPreview(next), next.critical_contact_radius_m, question);
    if (question.name !== criticalOf) {
        estimate(next.critical_force_N, next.critical_contact_radius_m, next.critical_indentation_m);
    }
    onScreen(question, "estimate");
}
/** Draws nearly what will be solved for; if more has been asked since, that is enough. */
function sketch(scene, radius, question) {
    const known = question.name === criticalOf ? critical : null;
    const largest = question.name === largestOf ? largestForce : 0;
    map.show(scene, known?.critical_contact_radius_m ?? radius, largest);
    accept();
    byId("readouts").classList.toggle("estimated", known === null);
    if (wanted !== null)
        cancel("contact");
}
/** Shows a critical state in the digits that an estimate has. */
function estimate(force, radius, indentation) {
    const shown = [
        ["force", engineering(force, "force", 3)],
        ["radius", engineering(radius, "length", 3)],
        ["indentation", engineering(indentation, "length", 3)],
    ];
    for (const [name, { number, unit }] of shown) {
        write(byId(`${name}-value`), `≈ ${number}`);
        byId(`${name}-unit`).textContent = unit;
        byId(`${name}-remark`).textContent = "estimate, being solved";
    }
}
/** Everything that goes with a state that is drawn. */
function numbers() {
    if (state === null)
        return;
    byId("readouts").classList.remove("estimated");
    showNumbers(state);
    showPhase();
    showCurves();
}
function accept() {
    controls.accept();
    byId("problem").hidden = true;
    document.body.classList.remove("outdated");
}
/** Tells when what was just drawn has been shown: after the next frame. */
function onScreen({ asked }, stage) {
    requestAnimationFrame(() => {
        const channel = new MessageChannel();
        channel.port1.onmessage = () => document.dispatchEvent(new CustomEvent("picture", { detail: { asked, stage } }));
        channel.port2.postMessage(null);
    });
}
let largestOf = "";
/** Curves and phase diagram, once nothing else is asked. */
async function background() {
    const values = controls.case;
    const name = JSON.stringify(values);
    if (name === curvesOf || name !== criticalOf || critical === null)
        return;
    curvesOf = name;
    const point = {
        fraction: 1,
        critical_indentation_m: critical.critical_indentation_m,
    };
    byId("curves-work").textContent = "computing …";
    const path = [];
    const phase = ask("phase", { case: values, load: point }, (line) => {
        if (line.transition) {
            transition = line.transition;
            loadingPath = path;
        }
        if (line.path)
            path.push(line.path);
        showPhase();
    });
    let fresh = null;
    const points = ask("curves", { case: values }, (line) => {
        if (line.formulas) {
            const { method, small_contact: small, large_contact: large } = line.formulas;
            fresh = { method, small, large, homogenised: [], exact: [] };
            curves = fresh;
        }
        if (fresh !== null && line.homogenised)
            fresh.homogenised = line.homogenised;
        if (fresh !== null && line.point) {
            fresh.exact.push(line.point);
            fresh.exact.sort((a, b) => a.surface_fraction - b.surface_fraction);
        }
        if (line.complete)
            byId("curves-work").textContent = "";
        showCurves();
    });
    try {
        await Promise.all([phase, points]);
    }
    catch (error) {
        if (error instanceof Refused)
            byId("curves-work").textContent = error.message;
    }
}
// --- Showing --------------------------------------------------------------------------------
function tellProgress(line) {
    const progress = line.progress;
    if (progress === undefined)
        return;
    byId("work").textContent =
        `${progress.stage}, step ${progress.step}, ${progress.touched} pillars touched …`;
}
function refuse(error) {
    pictured = true;
    const refusal = error instanceof Refused
        ? error.refusal
        : { key: null, message: String(error), accepted: null };
    controls.accept();
    const atField = controls.refuse(refusal);
    const problem = byId("problem");
    const accepted = refusal.accepted === null ? "" : `: ${refusal.accepted}`;
    problem.textContent = atField
        ? `${refusal.key ?? ""}: ${refusal.message}. This is the last good picture.`
        : `${refusal.message}${accepted}`;
    problem.hidden = false;
    document.body.classList.add("outdated");
    byId("work").textContent = "no result";
}
function showNumbers(shown) {
    if (critical === null)
        return;
    const summary = critical;
    const error = summary.relative_error_estimate;
    const model = summary.method === "homogenised";
    const digits = (value) => (model ? 4 : digitsFor(value));
    const estimate = (value) => {
        if (model)
            return "error of the model";
        return value > 0 ? `error ${significant(value, 1)}` : "exact";
    };
    const reduced = summary.normalized;
    const readouts = [
        {
            id: "force",
            value: summary.critical_force_N,
            dimension: "force",
            digits: digits(error.force),
            remark: `F γ_{int}/(h d) = ${significant(reduced.force, 4)},  ${estimate(error.force)}`,
        },
        {
            id: "radius",
            value: summary.critical_contact_radius_m,
            dimension: "length",
            digits: radiusDigits(error.contact_radius),
            remark: `a/e = ${significant(reduced.contact_radius, radiusDigits(error.contact_radius))},  ${estimate(error.contact_radius)}`,
        },
        {
            id: "indentation",
            value: summary.critical_indentation_m,
            dimension: "length",
            digits: digits(error.indentation),
            remark: `ζ/h = ${significant(reduced.indentation, 4)},  ${estimate(error.indentation)}`,
        },
    ];
    for (const { id, value, dimension, digits, remark } of readouts) {
        const { number, unit } = engineering(value, dimension, digits);
        write(byId(`${id}-value`), number);
        byId(`${id}-unit`).textContent = unit;
        write(byId(`${id}-remark`), remark);
    }
    const bottom = summary.regime === "bottom_first";
    byId("regime").textContent = bottom
        ? "bottom first: the lens reaches the floor before any pillar"
        : "top first: the lens rests on pillar tops before it reaches the floor";
    byId("regime").classList.toggle("beyond", bottom);
    byId("pillars").textContent =
        `${summary.pillars_in_contact} ${summary.pillars_in_contact === 1 ? "pillar" : "pillars"} ` +
            "in contact, " +
            `${summary.pillars_partially_in_contact} in part`;
    const warnings = [...shown.warnings];
    byId("warnings").textContent = warnings.join("; ");
    byId("warnings").hidden = warnings.length === 0;
    write(byId("colour-most"), engineeringText(map.largestForce, "force", 3));
    showLoad(shown);
    announce(shown);
    showPresets();
}
function milliseconds(shown) {
    const time = 1e3 * shown.summary.wall_time_s;
    return time < 1000 ? `${significant(time, 2)} ms` : `${significant(time / 1000, 3)} s`;
}
function showLoad(shown) {
    const { summary } = shown;
    const force = engineeringText(summary.force_N, "force", 4);
    const indentation = engineeringText(summary.indentation_m, "length", 4);
    const digits = radiusDigits(summary.relative_error_estimate.contact_radius);
    const radius = engineeringText(summary.contact_radius_m, "length", Math.min(4, digits));
    const words = loadWords(shown.fraction);
    const beyond = shown.fraction > 1 + 1e-9;
    byId("load-words").textContent = words;
    byId("load-words").classList.toggle("beyond", beyond);
    byId("beyond-note").hidden = !beyond;
    write(byId("load-numbers"), `F = ${force},  ζ = ${indentation},  a = ${radius}`);
    const slider = byId("load");
    slider.setAttribute("aria-valuetext", words);
}
function loadWords(fraction) {
    if (fraction === 0)
        return "first touch";
    if (Math.abs(fraction - 1) < 1e-9)
        return "critical state";
    const percent = `${significant(100 * fraction, 3)} %`;
    return fraction < 1
        ? `${percent} of the way to the critical state`
        : `${percent}, beyond the transition`;
}
let announcing;
/** Tells listeners the result once it has come to rest. */
function announce(shown) {
    window.clearTimeout(announcing);
    announcing = window.setTimeout(() => {
        if (critical === null)
            return;
        const summary = critical;
        const force = engineeringText(summary.critical_force_N, "force", 4);
        const digits = radiusDigits(summary.relative_error_estimate.contact_radius);
        const radius = engineeringText(summary.critical_contact_radius_m, "length", Math.min(4, digits));
        const indentation = engineeringText(summary.critical_indentation_m, "length", 4);
        byId("announcement").textContent =
            `Critical force ${force}, contact radius ${radius}, indentation ${indentation}. ` +
                `Load shown: ${loadWords(shown.fraction)}.`;
    }, 800);
}
function showPhase() {
    if (critical === null || state === null || transition.length === 0)
        return;
    const { contact_radius: radius, force } = critical.normalized;
    const done = [...loadingPath].sort((a, b) => a[0] - b[0]);
    const below = done.filter(([fraction]) => fraction < 1);
    const at = [radius, force];
    const path = [...below.map(([, x, y]) => [x, y]), at];
    const beyond = done.filter(([fraction]) => fraction > 1).map(([, x, y]) => [x, y]);
    const xs = [...path, ...beyond].map(([x]) => x);
    const ys = [...path, ...beyond].map(([, y]) => y);
    const x = range([0.4, 12, ...xs.filter((value) => value > 0.004)]);
    const floor = transition[0]?.[1] ?? 1;
    const y = range([0.2 * floor, 30 * floor, ...ys.filter((value) => value > 1e-3 * floor)], 1.8);
    const curve = transition.filter(([a]) => a > x[0] / 2 && a < x[1] * 2);
    const inside = curve.filter(([a]) => a >= x[0] && a <= x[1]);
    const edge = (level) => [
        [x[1] * 2, level],
        [x[0] / 2, level],
    ];
    const series = [
        { kind: "area", style: "top-region", points: [...curve, ...edge(y[0])] },
        { kind: "area", style: "mixed-region", points: [...curve, ...edge(y[1])] },
        { kind: "vertical", style: "one-pitch", points: [[1, y[0]]] },
        { kind: "line", style: "transition", points: curve },
        { kind: "line", style: "path", points: path },
        { kind: "line", style: "path beyond-path", points: beyond.length > 0 ? [at, ...beyond] : [] },
        { kind: "points", style: "critical-point", points: [at] },
        {
            kind: "points",
            style: state.fraction > 1 + 1e-9 ? "load-point beyond" : "load-point",
            points: [
                Math.abs(state.fraction - 1) < 1e-9 ? at : [state.normalized[1], state.normalized[0]],
            ],
        },
    ];
    const at40 = inside[Math.floor(inside.length * 0.3)] ?? [1, floor];
    const at75 = inside[Math.floor(inside.length * 0.78)] ?? [1, floor];
    const names = [
        { place: [at40[0], Math.sqrt(at40[1] * y[1])], text: "tops and floor" },
        { place: [at75[0], Math.sqrt(at75[1] * y[0])], text: "pillar tops only" },
    ];
    phaseChart.show({ x, y, series, names });
}
function showCurves() {
    const all = [...curves.small, ...curves.large];
    if (critical === null || all.length === 0)
        return;
    const summary = critical;
    const fractions = all.map((point) => point.surface_fraction);
    const present = summary.surface_fraction;
    const x = [Math.min(present, ...fractions), Math.max(present, ...fractions)];
    const quantities = [
        ["force", (p) => p.force_N, summary.critical_force_N],
        ["radius", (p) => p.contact_radius_m, summary.critical_contact_radius_m],
        ["indentation", (p) => p.indentation_m, summary.critical_indentation_m],
    ];
    for (const [name, of, now] of quantities) {
        const places = (points) => points
            .filter((point) => of(point) > 0)
            .map((point) => [point.surface_fraction, of(point)]);
        const exact = places(curves.exact);
        const shown = [...exact, ...places(curves.homogenised), ...places(curves.small)];
        const y = range([now, ...shown.map(([, value]) => value)], 1.5);
        curveCharts[name].show({
            x,
            y,
            series: [
                { kind: "vertical", style: "present", points: [[present, now]] },
                { kind: "line", style: "small-curve", points: places(curves.small) },
                { kind: "line", style: "large-curve", points: places(curves.large) },
                { kind: "line", style: "homogenised-curve", points: places(curves.homogenised) },
                { kind: "line", style: "exact-curve", points: exact },
                { kind: "points", style: "exact-point", points: exact },
                { kind: "points", style: "load-point", points: now > 0 ? [[present, now]] : [] },
            ],
        });
    }
}
function showTexts(next) {
    texts = next;
    byId("command").textContent = next.command.trimEnd();
    byId("python").textContent = next.python.trimEnd();
    byId("case-file").textContent = next.toml.trimEnd();
}
function showPresets() {
    const values = controls.case;
    for (const button of document.querySelectorAll("[data-preset]")) {
        const wanted = preset(button.dataset["preset"] ?? "");
        const same = Object.entries(wanted).every(([key, value]) => values[key] === value);
        button.setAttribute("aria-pressed", String(same));
    }
}
function preset(name) {
    return { ...PAPER, "substrate.young_modulus": SUBSTRATES[name] ?? 2e6 };
}
// --- The address ----------------------------------------------------------------------------
let remembering;
/** Keeps the state in the address, a moment later. */
function remember() {
    window.clearTimeout(remembering);
    remembering = window.setTimeout(() => history.replaceState(null, "", fragment()), 250);
}
function fragment() {
    const parameters = new URLSearchParams();
    for (const [key, value] of Object.entries(controls.case))
        parameters.set(key, String(value));
    parameters.set("load", String(load));
    if (exaggeration !== null)
        parameters.set("exaggeration", String(exaggeration));
    return `#${parameters.toString()}`;
}
/** Takes over the state in the address, if there is one. */
function restore() {
    const parameters = new URLSearchParams(location.hash.slice(1));
    const values = {};
    for (const [key, text] of parameters) {
        if (!key.includes("."))
            continue;
        const number = Number(text);
        values[key] = text === "" || Number.isNaN(number) ? text : number;
    }
    if (Object.keys(values).length === 0)
        return false;
    controls.case = values;
    setLoad(Number(parameters.get("load") ?? 1));
    const factor = Number(parameters.get("exaggeration"));
    setExaggeration(factor > 0 ? factor : null);
    return true;
}
// --- Acting ---------------------------------------------------------------------------------
function setLoad(fraction) {
    load = Number.isFinite(fraction) ? Math.min(FARTHEST, Math.max(0, fraction)) : 1;
    byId("load").value = String(load);
}
function setExaggeration(factor) {
    exaggeration = factor;
    byId("exaggeration-fit").setAttribute("aria-pressed", String(factor === null));
    if (factor !== null)
        byId("exaggeration").value = String(Math.log10(factor));
    section.exaggerate(factor);
}
function listen() {
    const slider = byId("load");
    let pointing = false;
    slider.addEventListener("pointerdown", () => (pointing = true));
    slider.addEventListener("pointerup", () => (pointing = false));
    slider.addEventListener("input", () => {
        const asked = performance.now();
        const value = Number(slider.value);
        setLoad(pointing && Math.abs(value - 1) < SNAP ? 1 : value);
        changed(asked);
    });
    byId("to-critical").addEventListener("click", () => {
        setLoad(1);
        changed(performance.now());
    });
    byId("exaggeration").addEventListener("input", (event) => {
        const power = Number(event.target.value);
        setExaggeration(Number((10 ** power).toPrecision(3)));
        remember();
    });
    byId("exaggeration-fit").addEventListener("click", () => {
        setExaggeration(null);
        remember();
    });
    for (const button of document.querySelectorAll("[data-preset]")) {
        button.addEventListener("click", () => {
            const spacing = Object.entries(controls.case).filter(([key]) => key === "texture.surface_fraction" || key === "texture.pitch");
            controls.case = { ...preset(button.dataset["preset"] ?? ""), ...Object.fromEntries(spacing) };
            changed(performance.now());
        });
    }
    for (const button of document.querySelectorAll("[data-file]")) {
        button.addEventListener("click", () => void save(button.dataset["file"] ?? ""));
    }
    byId("copy-link").addEventListener("click", (event) => {
        history.replaceState(null, "", fragment());
        void copy(location.href, event.currentTarget);
    });
    for (const button of document.querySelectorAll("[data-copy]")) {
        button.addEventListener("click", () => {
            const name = button.dataset["copy"];
            void copy(texts?.[name] ?? "", button);
        });
    }
    const menu = byId("export-menu");
    document.addEventListener("keydown", (event) => {
        if (event.key !== "Escape" || !menu.open)
            return;
        menu.open = false;
        menu.querySelector("summary")?.focus();
    });
    document.addEventListener("click", (event) => {
        if (!menu.contains(event.target))
            menu.open = false;
    });
    window.addEventListener("hashchange", () => {
        if (location.hash !== fragment() && restore())
            changed(performance.now());
    });
    onScheme(() => map.draw());
    onSize(byId("map"), () => map.draw());
}
/** Saves a file, or says why there is none. */
async function save(name) {
    const told = byId("export-note");
    told.textContent = `${name} …`;
    const known = JSON.stringify(controls.case) === criticalOf ? critical : null;
    const point = {
        fraction: load,
        ...(known && { critical_indentation_m: known.critical_indentation_m }),
    };
    try {
        const file = await fetchFile({ case: controls.case, load: point, file: name });
        if (file === null)
            return;
        const link = document.createElement("a");
        link.href = URL.createObjectURL(file);
        link.download = `fakir-${name}`;
        link.click();
        window.setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
        told.textContent = `${name} saved`;
    }
    catch (error) {
        told.textContent = error instanceof Error ? error.message : String(error);
    }
}
async function copy(words, button) {
    const before = button.textContent;
    try {
        await navigator.clipboard.writeText(words);
        button.textContent = "copied";
    }
    catch {
        button.textContent = "not allowed";
    }
    byId("announcement").textContent = button.textContent;
    window.setTimeout(() => (button.textContent = before), 1200);
}
const begin = await start();
setColours(begin.colours);
byId("version").textContent = `fakir ${begin.version}`;
listen();
setExaggeration(null);
if (!restore())
    controls.case = begin.case;
showPresets();
changed(performance.now());
