"""A held force on viscoelastic pillars with floor, compared with Tamaas's Maxwell material; see README.md. Written to results/viscoelastic.md."""

import json

import common
from adhesion import measured
from common import HERE, RESULTS, log

# Square pillars of 6 um on a pitch of 12 um under a parabola; micrometres, megapascals, seconds and micronewtons.
PROBLEM = {"side": 256, "size": 96.0, "pitch": 12.0, "pillar_height": 0.05, "lens_radius": 2000.0, "force": 14.0}
MATERIAL = {"strength": 1.0, "relaxation_time": 5.0}
DURATION = 40.0
STEPS = {"full": 400, "quick": 40}
# Step of the test of the material, so short that it has no effect.
SHORT = 2e-3
# Fractions of the duration at which contacts are compared.
COMPARED = [0.05, 0.1, 0.25, 0.5, 1.0]

CASE = """
[lens]
shape = "paraboloid"
radius = "{radius} um"
young_modulus = "1e6 GPa"
poisson_ratio = 0.0
[substrate]
young_modulus = "{modulus} MPa"
poisson_ratio = 0.0
[surface]
height_map = "{file}"
cell_size = "{cell} um"
floor = "{floor} um"
[relaxation]
strengths = [{strength}]
times = ["{time} s"]
"""


def peer(python, **order):
    return measured([python, HERE / "viscoelastic_worker.py", json.dumps(order)], env=common.settings(1))


def single_branch(values, step):
    """Relaxed modulus, strength and relaxation time of a branch whose stress was computed by Euler's backward steps."""
    first, second = values[1] - values[0], values[2] - values[1]
    ratio = second / first
    relaxed = values[0] + first / (1.0 - ratio)
    instantaneous = relaxed + (values[0] - relaxed) / ratio
    return relaxed, instantaneous / relaxed - 1.0, step * ratio / (1.0 - ratio)


def extrapolated(fine, coarse):
    """Euler's backward steps have an error that is proportional to their length."""
    return {"time_s": fine["time_s"]} | {name: 2.0 * fine[name] - coarse[name] for name in ("tops", "floor", "share")}


def run(options):
    program = common.build("-p", "fakir-cli") / "fakir"
    python = common.environment(options.folder)
    steps = STEPS["quick" if options.quick else "full"]
    problem = PROBLEM | {"file": str(options.folder / "pillars.npy"), "step": DURATION / steps, "steps": steps}
    problem |= MATERIAL | {"tolerance": 1e-8}
    values = peer(python, task="material", **problem | {"step": SHORT, "steps": 3, "tolerance": 1e-12})[0]["modulus"]
    relaxed, strength, relaxation_time = single_branch(values, SHORT)
    log(f"material: {relaxed:.4f}, {strength:.4f}, {relaxation_time:.4f} s")
    peer(python, task="heights", **problem)
    states, spent = peer(python, task="creep", **problem)
    coarse, _ = peer(python, task="creep", **problem | {"step": 2.0 * problem["step"], "steps": steps // 2})
    case = options.folder / "viscoelastic.toml"
    case.write_text(CASE.format(
        radius=problem["lens_radius"], modulus=relaxed, file=problem["file"], cell=problem["size"] / problem["side"],
        floor=-problem["pillar_height"], strength=strength, time=relaxation_time,
    ))
    rows = []
    for part in COMPARED:
        state = extrapolated(*(of["states"][round(part * len(of["states"])) - 1] for of in (states, coarse)))
        held, own = measured([
            program, "hold", case, "--json", "--quiet", "--threads", "1",
            "--force", f"{problem['force']}uN", "--for", f"{state['time_s']}s",
        ])
        level = held["states"][-1]["contact_indentation_m"]
        contact, _ = measured([program, "press", case, "--json", "--quiet", "--indentation", str(level)])
        areas = {name: 1e12 * contact[name]["contact_area_m2"] for name in ("tops", "floor")}
        rows.append((state, areas, held["end"]["floor_share"], own))
        log(f"{state} {areas} {held['end']['floor_share']}")
    folder = options.folder / "quick" if options.quick else RESULTS
    folder.mkdir(parents=True, exist_ok=True)
    material = (relaxed, strength, relaxation_time)
    (folder / "viscoelastic.md").write_text(report(rows, material, states["processor_s"], spent, steps))


def report(rows, material, solving, spent, steps):
    relaxed, strength, relaxation_time = material
    lines = [
        "# A held force on viscoelastic pillars with floor",
        "",
        f"{common.versions()}; {common.processor()}, one thread; {common.now()}, load average {common.load_average()}.",
        "",
        f"Tamaas: {steps} backward steps of Euler, {solving:.1f} s of processor time ({spent:.1f} s for the process), extrapolated with half as many to steps",
        "without length. Its material in full contact, where the strain is held, has",
        f"a relaxed modulus of {relaxed:.4f}, a strength of {strength:.4f} and a relaxation time of {relaxation_time:.4f} s, for a modulus of 1, a strength of {MATERIAL['strength']:g} and {MATERIAL['relaxation_time']:g} s that",
        "it was given. fakir uses the former. Areas in um^2, on equal cells.",
        "",
        "| time (s) | tops, Tamaas | fakir | difference | floor, Tamaas | fakir | difference | floor share, Tamaas | fakir | difference | fakir: processor time (s) |",
        "|---|---|---|---|---|---|---|---|---|---|---|",
    ]
    for state, areas, share, own in rows:
        pairs = [(state["tops"], areas["tops"], "{:.1f}"), (state["floor"], areas["floor"], "{:.1f}"), (state["share"], share, "{:.5f}")]
        cells = [f"{form.format(peer)} | {form.format(found)} | {found / peer - 1.0:+.2%}" for peer, found, form in pairs]
        lines.append(f"| {state['time_s']:g} | " + " | ".join(cells) + f" | {own:.2f} |")
    return "\n".join([*lines, ""])
