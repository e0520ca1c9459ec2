"""The paper's texture: error of every program against processor time and memory; see README.md."""

import json
import math
import subprocess
import sys

import common
import texture_report
from common import HERE, PEERS, RESULTS, log
from texture_rows import (
    FAKIR,
    INDENTATIONS,
    MOST_BYTES,
    MOST_SECONDS,
    PRESSED,
    QUESTIONS,
    TRUTH,
    WITH_FLOOR,
    Row,
    Table,
)

# The lens and the pillars of fakir's case below, in um and MPa, for the peers.
LENS = {"lens_radius": 2200.0, "diameter": 6.0, "height": 2.2, "contact_modulus": 4 / 3}
CASE = """\
[lens]
radius = "2.2 mm"
young_modulus = "2 MPa"
poisson_ratio = 0.5

[substrate]
young_modulus = "2 MPa"
poisson_ratio = 0.5

[pattern]
lattice = "hexagonal"
surface_fraction = 0.1

[pattern.pillar]
diameter = "6 um"
height = "2.2 um"
compliance = "none"
"""

# Looser ones no longer let the search find the load; tighter ones change nothing that is seen.
TOLERANCES = {"ContactMechanics": 1e-3, "Tamaas": 3e-4}
SIDES = {
    0.01: [128, 256, 512, 1024, 2048],
    0.03: [128, 256, 512, 1024, 2048],
    0.1: [256, 512, 768, 1024, 1536, 2048, 3072, 4096],
}
QUICK_SIDES = [128, 256, 512]
# The force at an indentation needs no finer grid.
FINEST_PRESSED = 2048
# Runs of what takes less than so many seconds.
RUNS = [(1.0, 5), (10.0, 3), (math.inf, 1)]


class Failed(Exception):
    pass


def launched(command):
    """Answer of a program and what its process took, by the system."""
    command = [sys.executable, "-I", "-S", HERE / "launch.py", 3 * int(MOST_SECONDS), *command]
    done = subprocess.run(
        [str(word) for word in command], env=common.settings(1), capture_output=True, text=True, check=False
    )
    printed, process = done.stdout.rstrip().rsplit("\n", 1)
    process = json.loads(process)
    if process["status"] != 0:
        messages = (done.stderr or printed).strip().splitlines()
        raise Failed(messages[-1] if messages else f"ended with {process['status']}")
    return printed, process


class Programs:
    def __init__(self, folder):
        self.python = common.environment(folder)
        self.fakir = common.build("-p", "fakir-cli") / "fakir"
        self.versions = {"fakir": common.fakir_version(), **common.pinned()}
        self.case = folder / "texture.toml"
        self.case.write_text(CASE)
        # What the process of fakir has before it computes anything.
        _, process = launched([self.fakir, "--version"])
        self.baseline = process["peak_bytes"]
        self.truths = {}

    def measure(self, fraction, question, program, setting):
        if program == "fakir":
            found = self.ask_fakir(fraction, question, setting)
        else:
            found = self.ask_peer(fraction, question, program, int(setting))
        here = {"date": common.now(), "load_average": common.load_average(), "processor": common.processor()}
        return {**here, "version": self.versions[program], **found}

    def ask_fakir(self, fraction, question, setting):
        words = [f"pattern.surface_fraction={fraction}", *FAKIR[setting]]
        words = [word for text in words for word in ("--set", text)]
        printed, process = launched([*self.question(fraction, question), *words, "--threads", "1"])
        answer = json.loads(printed)
        prefix = "critical_" if question == "transition" else ""
        floor = answer.get("floor")
        return {
            "processor_s": process["processor_s"],
            "peak_bytes": process["peak_bytes"],
            "net_bytes": process["peak_bytes"] - self.baseline,
            "force_N": answer[prefix + "force_N"],
            "indentation_m": answer[prefix + "indentation_m"],
            "extrapolated_force_N": None,
            "extrapolated_indentation_m": None,
            "solutions": None,
            "estimated_force_error": answer["relative_error_estimate"]["force"],
            "floor_share": floor and floor["share"],
            "estimated_share_error": floor and floor["relative_error_estimate"]["share"],
        }

    def question(self, fraction, question):
        """The command of fakir for this question."""
        if question == "transition":
            return [self.fakir, question, self.case, "--quiet", "--json"]
        load = ["--indentation", repr(INDENTATIONS[question][fraction])]
        return [self.fakir, "press", self.case, *load, "--quiet", "--json"]

    def truth(self, fraction, question):
        """What a peer's search starts from on its coarsest grid, and the square that it needs."""
        if (fraction, question) not in self.truths:
            words = ["--set", f"pattern.surface_fraction={fraction}", "--set", FAKIR[TRUTH][0]]
            printed, _ = launched([*self.question(fraction, question), *words])
            answer = json.loads(printed)
            critical = question == "transition"
            self.truths[fraction, question] = {
                "force": 1e6 * answer["critical_force_N" if critical else "force_N"],
                "indentation": 1e6 * answer["critical_indentation_m" if critical else "indentation_m"],
                "contact_radius": 1e6 * answer["top_contact_radius_m" if critical else "contact_radius_m"],
            }
        return self.truths[fraction, question]

    def ask_peer(self, fraction, question, peer, cells):
        pitch = LENS["diameter"] * math.sqrt(math.pi / (2 * math.sqrt(3) * fraction))
        order = {"peer": peer, "question": question, "cells": cells, "tolerance": TOLERANCES[peer]}
        order |= {"pitch": pitch, **LENS, **self.truth(fraction, question)}
        printed, _ = launched([self.python, HERE / "texture_worker.py", json.dumps(order)])
        answer = json.loads(printed.splitlines()[-1])
        answer.pop("log")
        return {**answer, "estimated_force_error": None, "estimated_share_error": None}


def wanted_runs(seconds):
    return next(runs for most, runs in RUNS if seconds < most)


def too_much(rows, fraction, question, peer, cells):
    """Whether a grid would take more than is allowed, by the finest grid measured so far."""
    known = [row for row in rows if row.what[:3] == (fraction, question, peer) and int(row.setting) < cells]
    if not known:
        return False
    last = max(known, key=lambda row: int(row.setting))
    finer = (cells / int(last.setting)) ** 2
    # A few more iterations, and slower transforms.
    return last.processor_s * finer**1.1 > MOST_SECONDS or last.net_bytes * finer > MOST_BYTES


def measure(programs, table, fractions, quick):
    for fraction in fractions:
        tasks = [("fakir", setting) for setting in FAKIR]
        sides = QUICK_SIDES if quick else SIDES[fraction]
        tasks += [(peer, str(side)) for side in sides for peer in PEERS]
        # In turns: all of them once, then again those that are to be run more often.
        for turn in range(1 if quick else RUNS[0][1]):
            for program, setting in tasks:
                for question in QUESTIONS:
                    take(programs, table, (fraction, question, program, setting), turn)


def take(programs, table, what, turn):
    fraction, question, program, setting = what
    if question != "transition" and program != "fakir" and int(setting) > FINEST_PRESSED:
        return
    if question == "mixed" and (
        fraction not in INDENTATIONS[question] or (program == "fakir" and setting not in WITH_FLOOR)
    ):
        return
    before = [row for row in table.rows if row.what == what]
    enough = before and wanted_runs(before[0].processor_s) <= turn
    if len(before) > turn or enough or (turn and not before):
        return
    if program != "fakir" and too_much(table.rows, fraction, question, program, int(setting)):
        log(f"{what}: left out, beyond {MOST_SECONDS:.0f} s or {MOST_BYTES / 1e9:.0f} GB")
        return
    try:
        found = programs.measure(*what)
    except Failed as failure:
        log(f"{what}: {failure}")
        return
    row = Row(*what, run=turn + 1, **found)
    table.add(row)
    log(f"{what}: {row.processor_s:.3f} s, {row.peak_bytes / 1e6:.0f} MB, {row.force_N:.8e} N")


def run(options):
    """Measures, unless only the report is requested, and writes the results."""
    fractions = options.surface_fraction or ([0.01] if options.quick else list(PRESSED))
    results = options.folder / "quick" if options.quick else RESULTS
    table = Table(results)
    if options.report:
        python = common.environment(options.folder)
    else:
        programs = Programs(options.folder)
        python = programs.python
        if not options.resume:
            table.rows = [row for row in table.rows if row.surface_fraction not in fractions]
        measure(programs, table, fractions, options.quick)
    texture_report.write(table.rows, results)
    subprocess.run([python, HERE / "texture_figure.py", results], check=True)
    log(f"written: {results}/texture.csv, texture.md, and figures")
