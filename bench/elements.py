"""Comparison of boundary element solvers: one product, one solution; see README.md.

Everything is measured in one session, one process at a time, the programs taking turns; medians
of the repeats are written to results/elements.md.
"""

import json
import statistics
import subprocess

import common
from common import HERE, PEERS, RESULTS, log

SIDES = [256, 512, 1024, 2048]
THREADS = [1, 2]

# Every program solves to this error, relative to a solution with an energy bound of 1e-12.
ERROR = 1e-5
# Tolerances tried, from the loosest, until the error is small enough.
LADDER = [10.0 ** (-k) for k in range(1, 12)]


class Programs:
    """Starts a program on a task and reads its answer."""

    def __init__(self, folder):
        self.python = common.environment(folder)
        self.peer = common.build("-p", "fakir", "--example", "peer") / "examples" / "peer"

    def run(self, command, threads):
        command = [str(word) for word in command]
        done = subprocess.run(
            command, env=common.settings(threads), capture_output=True, text=True, check=False
        )
        if done.returncode != 0:
            raise RuntimeError(f"{command}\n{done.stderr}")
        answer = json.loads(done.stdout.splitlines()[-1])
        # Tamaas logs its iterations to the standard error, numbered from zero.
        numbers = [line.split()[0] for line in done.stderr.splitlines() if line.strip()]
        iterations = [1 + int(number) for number in numbers if number.isdigit()]
        return {"iterations": max(iterations), **answer} if iterations else answer

    def product(self, program, side, threads, repeats):
        if program == "fakir":
            command = [self.peer, "product", f"side={side}", f"threads={threads}"]
            return self.run([*command, f"repeats={repeats}"], threads)
        order = {"task": "product", "peer": program, "side": side, "threads": threads}
        return self.worker({**order, "repeats": repeats}, threads)

    def solve(self, program, problem, tolerance, threads, verbose=False):
        load = problem["load"] if program in problem["takes"] else problem["other_load"]
        if program == "fakir":
            words = [f"{key}={problem[key]}" for key in ["separation", "columns", "rows", "cell", "boundary"]]
            words += [f"{key}={load[key]!r}" for key in ["force", "indentation"] if key in load]
            words += [f"reach={problem['reach']!r}"] if "reach" in problem else []
            return self.run([self.peer, "solve", *words, f"tolerance={tolerance!r}", f"threads={threads}"], threads)
        keys = ["separation", "columns", "rows", "cell", "boundary"]
        given = {key: problem[key] for key in keys}
        order = {"task": "solve", "peer": program, "problem": given, "load": load}
        return self.worker({**order, "tolerance": tolerance, "threads": threads, "verbose": verbose}, threads)

    def worker(self, order, threads):
        return self.run([self.python, HERE / "elements_worker.py", json.dumps(order)], threads)

    def problems(self, folder):
        command = [self.python, HERE / "problems.py", folder]
        return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def median(answers, key):
    return statistics.median(answer[key] for answer in answers)


def in_turns(measure, programs, repeats):
    """Answers of every program with every number of threads, measured in turns."""
    answers = {(threads, program): [] for threads in THREADS for program in programs}
    for _ in range(repeats):
        for (threads, program), measured in answers.items():
            measured.append(measure(program, threads))
    return answers


def products(programs, repeats, sides):
    rows = []
    for side in sides:
        inner = max(3, 4_000_000 // side**2)
        answers = in_turns(
            lambda program, threads: programs.product(program, side, threads, inner),
            ["fakir", "scipy", *PEERS],
            repeats,
        )
        # ContactMechanics evaluates the closed form of Love with cancellation.
        checks = [measured[0]["check"] for measured in answers.values()]
        assert max(checks) - min(checks) < 1e-6 * abs(checks[0]), checks
        for (threads, program), measured in answers.items():
            rows.append((side, threads, program, measured))
            log(f"product {side} {threads} {program}: {1e3 * median(measured, 'product_s'):.1f} ms")
    return rows


def reference(programs, problem):
    exact = programs.solve("fakir", problem, 1e-12, 1)
    assert exact["ended"] == "converged", exact
    problem["exact"] = exact
    if "indentation" in problem["load"]:
        # For programs that prescribe the force alone.
        problem["other_load"] = {"force": exact["force"], "scale": problem["load"]["scale"]}


def error(problem, answer):
    exact = problem["exact"]
    return max(abs(answer[key] / exact[key] - 1.0) for key in ["force", "indentation"])


def calibrate(programs, program, problem):
    """The largest tolerance with a sufficient accuracy, with its cost."""
    for tolerance in LADDER:
        answer = programs.solve(program, problem, tolerance, 1, verbose=True)
        answer["error"] = error(problem, answer)
        log(f"{problem['name']}, {program} at {tolerance:.0e}: {answer}")
        if answer["error"] <= ERROR and answer["ended"] == "converged":
            return tolerance, answer
    return None, answer


def solutions(programs, folder, repeats, names):
    rows = []
    for problem in programs.problems(folder):
        if names and problem["name"] not in names:
            continue
        reference(programs, problem)
        tolerances = {}
        for program in ["fakir", *PEERS]:
            tolerances[program] = calibrate(programs, program, problem)
        able = [program for program, (tolerance, _) in tolerances.items() if tolerance is not None]
        answers = in_turns(
            lambda program, threads: programs.solve(program, problem, tolerances[program][0], threads),
            able,
            repeats,
        )
        for threads in THREADS:
            for program, (tolerance, first) in tolerances.items():
                measured = answers.get((threads, program), [])
                rows.append((problem, threads, program, tolerance, first, measured))
                if measured:
                    log(f"{problem['name']} {threads} {program}: {median(measured, 'total_s'):.3f} s")
    return rows


def product_table(rows):
    lines = [
        "| cells | threads | program | product, ms | set-up, ms | memory, MB | time over fakir's |",
        "|---|---|---|---|---|---|---|",
    ]
    own = {(side, threads): median(a, "product_s") for side, threads, name, a in rows if name == "fakir"}
    for side, threads, name, answers in rows:
        time = median(answers, "product_s")
        lines.append(
            f"| {side}² | {threads} | {name} | {1e3 * time:.1f} | {1e3 * median(answers, 'setup_s'):.0f} "
            f"| {median(answers, 'memory_bytes') / 1e6:.0f} | {time / own[side, threads]:.1f} |"
        )
    return lines


def solution_table(rows):
    lines = [
        "| problem | threads | program | time, s | iterations | products | memory, MB "
        "| tolerance | error | time over fakir's |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    own = {(p["name"], t): median(a, "total_s") for p, t, name, _, _, a in rows if name == "fakir"}
    for problem, threads, program, tolerance, first, answers in rows:
        start = f"| {problem['name']}² | {threads} | {program} "
        if not answers:
            lines.append(start + f"| not to {ERROR:.0e} | | | | | {first['error']:.0e} | |")
            continue
        time = median(answers, "total_s")
        lines.append(
            start + f"| {time:.2f} | {first['iterations']} | {first.get('products') or ''} "
            f"| {median(answers, 'memory_bytes') / 1e6:.0f} | {tolerance:.0e} | {first['error']:.0e} "
            f"| {time / own[problem['name'], threads]:.1f} |"
        )
    return lines


def run(options):
    """Measures and writes the table."""
    results = options.folder / "quick" if options.quick else RESULTS
    names = options.problem or (["sphere 512"] if options.quick else [])
    repeats = 1 if options.quick else options.repeats
    programs = Programs(options.folder)
    before = common.load_average()
    parts = []
    if not options.no_products:
        rows = products(programs, repeats, SIDES[:2] if options.quick else SIDES)
        parts += ["", "## One product with the free half-space", "", *product_table(rows)]
    rows = solutions(programs, options.folder, repeats, names)
    parts += ["", f"## One solution to a relative error of {ERROR:.0e}", "", *solution_table(rows)]
    head = [
        "# Solvers of elements, measured",
        "",
        f"{common.versions()}; {common.processor()}; {common.now()[:10]}; medians of {repeats} runs, the programs "
        f"taking turns. Command: `python3 bench/run.py elements --repeats {repeats}`. "
        "What is compared, and how: [README.md](../README.md).",
        f"Load average of the machine before and after: {before:.1f} and {common.load_average():.1f}.",
    ]
    results.mkdir(parents=True, exist_ok=True)
    (results / "elements.md").write_text("\n".join(head + parts) + "\n")
