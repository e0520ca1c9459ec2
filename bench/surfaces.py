"""Any surfaces under a force by fakir and by aspher; see README.md.

One process at a time, one thread, the programs taking turns; medians of the repeats are written to results/surfaces.md.
"""

import json
import statistics
import subprocess
import venv

import common
from common import HERE, RESULTS, log

SIDES = [1024, 2048]
TOLERANCES = [1e-5, 1e-8]
# Of aspher the faster way that converges is taken: of a free half-space there are two.
WAYS = {
    "periodic": {"periodic": {"backend": "periodic"}},
    "free": {"H2, active set": {"backend": "h2", "active_set": True}, "FFT": {"backend": "fft"}},
}
HEAD = """\
# Any surface under a force, measured

fakir {version} and {aspher}; {processor}; {day}; medians of {repeats}, the programs taking turns, one thread. Command: `{command}`.
Load average of the machine before and after: {before} and {after}; times are processor time, user and system, of the solution with its setting up.
*Error*: of the indentation, relative to fakir's with an energy bound of 1e-12. Products are those on the
finest cells for fakir, and what aspher counts. What is compared, and how: [README.md](../README.md).

| surface | tolerance | program | time, s | memory, MB | products | in contact | error | time and memory over fakir's |
|---|---|---|---|---|---|---|---|---|
"""


class Programs:
    def __init__(self, folder):
        python = folder / "environment-aspher"
        if not python.exists():
            venv.create(python, with_pip=True)
        self.python = python / "bin" / "python"
        requirements = HERE / "requirements-aspher.txt"
        subprocess.run([self.python, "-m", "pip", "install", "-q", "-r", requirements], check=True)
        self.peer = common.build("--workspace", "--example", "peer") / "examples" / "peer"

    def run(self, *command):
        words = [str(word) for word in command]
        done = subprocess.run(words, env=common.settings(1), check=True, capture_output=True, text=True)
        return json.loads(done.stdout.splitlines()[-1])

    def work(self, **order):
        return self.run(self.python, HERE / "surfaces_worker.py", json.dumps(order))

    def fakir(self, problem, tolerance):
        side = problem["side"]
        words = [f"columns={side}", f"rows={side}", f"cell={1 / side!r}", "threads=1", f"tolerance={tolerance!r}"]
        words += [f"{key}={problem[key]}" for key in ["separation", "boundary", "force"]]
        return self.run(self.peer, "solve", *words)


def rows_of(programs, problem, repeats):
    exact = programs.fakir(problem, 1e-12)
    assert exact["ended"] == "converged", exact
    for tolerance in TOLERANCES:
        ways = WAYS[problem["boundary"]]
        solve = {"fakir": lambda: programs.fakir(problem, tolerance)}
        if len(ways) > 1:
            tried = {name: programs.work(task="solve", problem=problem, way=way, tolerance=tolerance)
                     for name, way in ways.items()}
            good = [name for name in tried if tried[name]["ended"] == "converged"] or list(tried)
            ways = {name: ways[name] for name in [min(good, key=lambda name: tried[name]["processor_s"])]}
        for name, way in ways.items():
            solve[f"aspher ({name})"] = lambda way=way: programs.work(
                task="solve", problem=problem, way=way, tolerance=tolerance)
        answers = {name: [] for name in solve}
        for _ in range(repeats):
            for name, once in solve.items():
                answers[name].append(once())
        middle = {name: {key: statistics.median(a[key] for a in measured) for key in ["processor_s", "memory_bytes"]}
                  for name, measured in answers.items()}
        for name, measured in answers.items():
            last, own = measured[-1], middle["fakir"]
            error = abs(last["indentation"] / exact["indentation"] - 1.0)
            times, memory = middle[name]["processor_s"], middle[name]["memory_bytes"]
            ratios = f"{times / own['processor_s']:.1f}, {memory / own['memory_bytes']:.1f}"
            ended = "" if last["ended"] == "converged" else f" ({last['ended']})"
            share = 100 * last["loaded"] / problem["side"] ** 2
            yield (f"| {problem['name']}, {problem['side']}² | {tolerance:.0e} | {name}{ended} | {times:.2f} | {memory / 1e6:.0f} "
                   f"| {last['products']} | {share:.2g} % | {error:.0e} | {ratios} |")


def run(options):
    """Measures and writes the table."""
    repeats = 1 if options.quick else options.repeats
    programs = Programs(options.folder)
    before = common.load_average()
    rows = []
    for side in [256] if options.quick else SIDES:
        for problem in programs.work(task="problems", folder=str(options.folder), side=side):
            if options.problem and f"{problem['name']} {side}" not in options.problem:
                continue
            for row in rows_of(programs, problem, repeats):
                log(row)
                rows.append(row)
    head = HEAD.format(
        version=common.fakir_version(), processor=common.processor(), day=common.now()[:10], repeats=repeats,
        aspher=(HERE / "requirements-aspher.txt").read_text().split()[-1],
        command=f"python3 bench/run.py surfaces --repeats {repeats}", before=before, after=common.load_average(),
    )
    results = options.folder / "quick" if options.quick else RESULTS
    results.mkdir(parents=True, exist_ok=True)
    (results / "surfaces.md").write_text(head + "\n".join(rows) + "\n")
