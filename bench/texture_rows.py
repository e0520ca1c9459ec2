"""Runs of the texture, kept in a table, and what follows from them: errors, costs at an error."""

import csv
import math
import os
from collections import defaultdict
from dataclasses import asdict, dataclass, fields, replace
from statistics import median

QUESTIONS = ["transition", "press", "mixed"]
# Indentations to press to, by surface fraction: a little below the critical ones; and 1.5 times the critical ones.
PRESSED = {0.01: 2.9e-6, 0.03: 4.9e-6, 0.1: 26e-6}
INDENTATIONS = {"press": PRESSED, "mixed": {0.03: 7.48e-6, 0.1: 40.2e-6}}
FAKIR = {
    "spectral": [],
    "spectral, accurate": ["method.accuracy=accurate"],
    "punch": ["method.name=punch"],
    "homogenised": ["method.name=homogenised"],
    "love 8": ["method.name=love", "method.cells_per_diameter=8"],
    "love 16": ["method.name=love", "method.cells_per_diameter=16"],
    "love 32": ["method.name=love", "method.cells_per_diameter=32"],
}
TRUTH = "spectral, accurate"
# Methods of fakir that include floor contact.
WITH_FLOOR = ["spectral", TRUTH]
# What a program may take for one measurement.
MOST_SECONDS, MOST_BYTES = 300.0, 8e9
EXTRAPOLATED = ", extrapolated"
COSTS = ["processor_s", "peak_bytes", "net_bytes"]


@dataclass
class Row:
    """One run of one program."""

    surface_fraction: float
    question: str
    program: str
    setting: str
    run: int
    processor_s: float
    peak_bytes: int
    net_bytes: int
    force_N: float
    indentation_m: float
    # By first-order extrapolation from the grid of twice the cell, where that was solved.
    extrapolated_force_N: float | None
    extrapolated_indentation_m: float | None
    solutions: int | None
    # Of fakir, of itself.
    estimated_force_error: float | None
    date: str
    load_average: float
    version: str
    # Unknown of the first runs.
    processor: str = ""
    # Of mixed contact alone.
    floor_share: float | None = None
    extrapolated_floor_share: float | None = None
    estimated_share_error: float | None = None

    @property
    def what(self):
        return (self.surface_fraction, self.question, self.program, self.setting)


class Table:
    """The file of all runs."""

    def __init__(self, results):
        self.path = results / "texture.csv"
        self.rows = self.read() if self.path.exists() else []

    def read(self):
        kinds = {field.name: field.type for field in fields(Row)}

        def value(name, text):
            kind = kinds[name]
            if kind in (str, int, float):
                return kind(text)
            return float(text) if text else None

        with open(self.path, newline="") as file:
            return [
                Row(**{name: value(name, text) for name, text in row.items()})
                for row in csv.DictReader(file)
            ]

    def add(self, row):
        self.rows.append(row)
        self.rows.sort(key=lambda row: (row.surface_fraction, QUESTIONS.index(row.question)))
        self.path.parent.mkdir(parents=True, exist_ok=True)
        partial = self.path.with_suffix(".tmp")
        with open(partial, "w", newline="") as file:
            writer = csv.DictWriter(file, [field.name for field in fields(Row)], lineterminator="\n")
            writer.writeheader()
            writer.writerows(asdict(row) for row in self.rows)
        os.replace(partial, self.path)


@dataclass
class Point:
    """What a program does with one setting: medians of its runs."""

    program: str
    setting: str
    processor_s: float
    peak_bytes: float
    net_bytes: float
    force_error: float
    indentation_error: float
    # None if the floor carries no load.
    share_error: float | None
    # Smaller errors cannot be distinguished from those of the reference: of force and indentation, and of the share.
    resolution: float
    share_resolution: float | None
    runs: int
    solutions: int | None

    @property
    def shown_error(self):
        return max(abs(self.force_error), self.resolution)

    @property
    def of_share(self):
        """The same point with the error of the floor's share in the place of that of the force."""
        return replace(self, force_error=self.share_error, resolution=self.share_resolution)

    @property
    def memory(self):
        """Without the modules of the peers, with all that fakir has."""
        return self.peak_bytes if self.program == "fakir" else self.net_bytes


def points(rows, fraction, question):
    """Of all programs, in the order of their settings, and of the peers also with extrapolation."""
    groups = defaultdict(list)
    for row in rows:
        if row.what[:2] == (fraction, question):
            groups[row.program, row.setting].append(row)
    if ("fakir", TRUTH) not in groups:
        return []
    truth = groups["fakir", TRUTH][0]

    def point(name, group, force, indentation, share):
        costs = [median(getattr(row, key) for row in group) for key in COSTS]
        errors = [force / truth.force_N - 1, indentation / truth.indentation_m - 1]
        errors.append(share / truth.floor_share - 1 if share and truth.floor_share else None)
        first = group[0]
        resolutions = [truth.estimated_force_error, truth.estimated_share_error]
        return Point(name, first.setting, *costs, *errors, *resolutions, len(group), first.solutions)

    found = [
        point(program, group, group[0].force_N, group[0].indentation_m, group[0].floor_share)
        for (program, _), group in groups.items()
    ]
    for (program, setting), group in groups.items():
        if program == "fakir":
            continue
        name, first = program + EXTRAPOLATED, group[0]
        coarser = groups.get((program, str(int(setting) // 2)))
        if first.extrapolated_force_N is not None:
            # The coarser grid was solved on the way.
            further = [first.extrapolated_force_N, first.extrapolated_indentation_m, first.extrapolated_floor_share]
            found.append(point(name, group, *further))
        elif coarser:
            share = 2 * first.floor_share - coarser[0].floor_share if first.floor_share else None
            both = point(name, group, 2 * first.force_N - coarser[0].force_N, first.indentation_m, share)
            both.processor_s += median(row.processor_s for row in coarser)
            found.append(both)
    return found


def curve(found, program):
    """Errors that are not undercut by luck: of a grid, the largest of it and all finer ones."""
    known = sorted((p for p in found if p.program == program), key=lambda p: int(p.setting))
    errors = [max(p.shown_error for p in known[place:]) for place in range(len(known))]
    return known, errors


def at_error(found, program, error, cost):
    """Cost at which a program reaches an error, on its curve, both logarithmic; None if it does not."""
    known, errors = curve(found, program)
    previous = None
    for point, reached in zip(known, errors):
        here = (math.log(reached), math.log(cost(point)))
        if reached <= error:
            if previous is None or previous[0] == here[0]:
                return cost(point)
            part = (math.log(error) - previous[0]) / (here[0] - previous[0])
            return math.exp(previous[1] + part * (here[1] - previous[1]))
        previous = here
    return None


def extrapolated_cost(found, program, error, cost):
    """Cost at an error beyond the finest grid, by the order of the last grids over two octaves; None where they show
    no order near the first."""
    known, errors = curve(found, program)
    sizes = [int(point.setting) for point in known]
    first = next((place for place, size in enumerate(sizes) if 4 * size >= sizes[-1]), 0)
    octaves = math.log(sizes[-1] / sizes[first])
    order = math.log(errors[first] / errors[-1]) / octaves if octaves else 0.0
    if not 0.7 < order < 1.5:
        return None
    growth = math.log(cost(known[-1]) / cost(known[first])) / octaves
    return cost(known[-1]) * (errors[-1] / error) ** (growth / order)


def best_of_fakir(found, error, cost, methods):
    able = [p for p in found if p.program == "fakir" and p.setting in methods and p.shown_error <= error]
    return min(able, key=cost, default=None)
