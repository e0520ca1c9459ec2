"""Pull-off of a lens from adhesive pillar tops, compared with the Adhesion package; see README.md.

One process at a time on one thread; processor time of the whole process. Written to results/adhesion.md.
"""

import json
import math
import resource
import subprocess

import common
from common import HERE, RESULTS, ROOT, log

# The paper's pillars at a surface fraction of 0.03, rigid, and its lens; micrometres, megapascals, and J/m^2.
PITCH, PILLAR_RADIUS, LENS_RADIUS = 32.98911, 3.0, 2200.0
MODULUS = 4.0 / 3.0
WORK = 0.05
# By the number of attached tops: side of the square of the peer, and the indentation at the start of unloading.
SIZES = {1: (16.0, 0.02), 7: (80.0, 0.3)}
# Cells along a side, and range of the attraction: the cells must resolve it, and the tops must be large compared with it.
GRIDS = {1: [(64, 0.1), (128, 0.1), (128, 0.05), (256, 0.05)], 7: [(256, 0.2)]}
QUICK = {1: [(64, 0.1)], 7: []}
# Residual force on a cell, relative to the largest attraction of a cell.
TOLERANCE = 1e-3


def measured(command, **settings):
    """The last line of the output of a command, and its processor time."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([str(word) for word in command], check=True, capture_output=True, text=True, **settings)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return json.loads(done.stdout), spent


def fakir(program, tops, accuracy):
    case = ROOT / "examples" / "adhesive.toml"
    return measured([
        program, "cycle", case, "--json", "--quiet", "--threads", "1", "--to", f"{SIZES[tops][1]}um",
        "--set", "pattern.pillar.compliance=none", "--set", f"method.accuracy={accuracy}",
    ])


def peer(python, tops, side, attraction):
    size, indentation = SIZES[tops]
    around = [(PITCH * math.cos(k * math.pi / 3), PITCH * math.sin(k * math.pi / 3)) for k in range(6)]
    order = {
        "side": side, "size": size, "centres": [(0.0, 0.0), *around][:tops], "pillar_radius": PILLAR_RADIUS,
        "lens_radius": LENS_RADIUS, "work": WORK / MODULUS, "range": attraction,
        "indentation": indentation, "tolerance": TOLERANCE,
    }
    return measured([python, HERE / "adhesion_worker.py", json.dumps(order)], env=common.settings(1))


def lone_top():
    """Pull-off from one top under the middle of the lens, in micronewtons (K. Kendall, J. Phys. D 4, 1186 (1971))."""
    sag = 2.0 * PILLAR_RADIUS**2 / (3.0 * LENS_RADIUS)
    opening = math.sqrt(2.0 * math.pi * PILLAR_RADIUS * WORK / MODULUS)
    return 2.0 * PILLAR_RADIUS * MODULUS * (sag - opening)


def run(options):
    program = common.build("-p", "fakir-cli") / "fakir"
    python = common.environment(options.folder)
    rows = []
    for tops, grids in (QUICK if options.quick else GRIDS).items():
        exact, _ = fakir(program, tops, "accurate")
        truth = lone_top() if tops == 1 else 1e6 * exact["pull_off_force_N"]
        estimate = exact["relative_error_estimate"]["pull_off_force"]
        for accuracy in ["default", "accurate"] if tops == 1 else ["default"]:
            found, spent = fakir(program, tops, accuracy)
            rows.append((tops, f"fakir, {accuracy}", 1e6 * found["pull_off_force_N"], truth, spent))
        for side, attraction in grids:
            found, spent = peer(python, tops, side, attraction)
            name = f"Adhesion, {side}² cells, range {1e3 * attraction:g} nm"
            rows.append((tops, name, MODULUS * found["pull_off"], truth, spent))
            log(f"{tops} tops, {name}: {rows[-1]}")
    folder = options.folder / "quick" if options.quick else RESULTS
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "adhesion.md").write_text(report(rows, estimate))


def report(rows, estimate):
    lines = [
        "# Pull-off from adhesive pillar tops",
        "",
        f"{common.versions()}; {common.processor()}, one thread; {common.now()}, load average {common.load_average()}.",
        "",
        "One top: the error is that to Kendall's pull-off under a round lens, in closed form. Seven: to fakir's accurate form, whose estimates are that the",
        f"levels of its fronts may be {estimate['levels']:.0%} of the force and their shapes {estimate['model_fronts']:.0%}. The attraction of the peer has a range, which lowers the pull-off; cells have to resolve it.",
        "",
        "| tops attached | program | pull-off (uN) | error | processor time (s) |",
        "|---|---|---|---|---|",
    ]
    lines += [
        f"| {tops} | {name} | {found:.4f} | {found / truth - 1.0:+.1e} | {spent:.3f} |"
        for tops, name, found, truth, spent in rows
    ]
    return "\n".join([*lines, ""])
