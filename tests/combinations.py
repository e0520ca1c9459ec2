"""Every combination of question, lens, arrangement and physics, each with a random case: is it answered or refused with a reason,
and does a second computation agree within the stated errors?

    cargo xtask campaign --combinations [--cells N] [--seed S] [--limit SECONDS] [--only QUESTION,LENS,ARRANGEMENT,PHYSICS]

The second computation of a case is one of these, as far as it has a meaning: the same in other units (powers of two, which change no
digit), rotated as a whole, the force at the indentation and back, the other accuracy, the same pillars as a list, boundary elements
(`verify`), differences for derivatives, and for adhesion the balance of the energy. A disagreement, a failure and an answer with an
error above 0.5 that does not say so are printed with the case, and end the program with status 1.
"""

from __future__ import annotations

import argparse
import itertools
import json
import math
import os
import random
import resource
import signal
import subprocess
import sys
import tempfile
import zlib
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

QUESTIONS = ("press", "force", "floor", "transition", "approach", "cycle", "gradient", "verify")
LENSES = ("sphere", "paraboloid", "profile", "cylinder", "plate")
ARRANGEMENTS = ("hexagonal", "square", "rectangular", "oblique", "scattered", "finite", "listed", "unequal")
PHYSICS = ("plain", "layers", "elastic", "adhesive tops", "adhesive floor", "rounded", "adhesive rounded", "elements")

ROUNDING = 1e-9
"""Relative difference that rounding may cause in a sum over many pillars, beside the stated errors."""

SECONDS = 300
"""Limit of one computation in processor time, which does not depend on what else the machine does."""

SLOW = 20.0
"""Processor time of one computation, in s, above which it is printed."""


@dataclass(frozen=True)
class Case:
    """A random case: lengths in m before scaling, angles in rad."""

    question: str
    lens: str
    arrangement: str
    physics: str
    diameter: float
    height: float
    radius: float
    moduli: tuple[float, float]
    ratios: tuple[float, float]
    pitch: float
    offset: tuple[float, float]
    angle: float
    tilt: float
    thickness: float
    work: float
    scatter: float
    seed: int
    depth: float
    length: float = 1.0
    """Factor of all lengths."""
    modulus: float = 1.0
    """Factor of all moduli."""
    rotation: float = 0.0
    """Rotation of lens and pillars together."""
    as_list: bool = False
    extra: tuple[tuple[str, str], ...] = field(default=())

    @property
    def is_finite(self) -> bool:
        return self.arrangement in ("finite", "listed", "unequal") or self.is_rounded

    @property
    def is_rounded(self) -> bool:
        return self.physics in ("rounded", "adhesive rounded")

    @property
    def rise(self) -> float:
        """By how much the first contact may be above the level from which indentations are measured."""
        tilted = 2 * self.pitch * math.tan(self.tilt) if self.lens == "plate" else 0.0
        # The highest of some tens of pillars is two standard deviations above the others.
        return tilted + (2 * self.scatter * self.height if self.arrangement == "scattered" else 0.0)

    @property
    def name(self) -> str:
        return ", ".join([self.question, self.lens, self.arrangement, self.physics])


def drawn(cell: tuple[str, str, str, str], seed: int) -> Case:
    """The random case of a cell: always the same for a seed."""
    numbers = random.Random(zlib.crc32(repr((cell, seed)).encode()))

    def logarithmic(low: float, high: float) -> float:
        return math.exp(numbers.uniform(math.log(low), math.log(high)))

    question, lens, arrangement, physics = cell
    diameter = logarithmic(2e-6, 20e-6)
    height = diameter * numbers.uniform(0.15, 0.5)
    pitch = diameter * numbers.uniform(1.7, 3.5)
    # A contact at the transition of some tens of pillars.
    radius = numbers.uniform(1.0, 3.0) * pitch**2 / height
    return Case(
        *cell,
        diameter=diameter,
        height=height,
        radius=max(radius, 40 * pitch),
        moduli=(logarithmic(5e5, 1e8), logarithmic(5e5, 1e7)),
        ratios=(numbers.uniform(0.2, 0.5), numbers.choice([0.5, 0.45])),
        pitch=pitch,
        offset=(numbers.choice([0.0, numbers.uniform(0, 0.6)]), numbers.uniform(0, 6.2)),
        angle=numbers.uniform(0, 3.1),
        tilt=numbers.uniform(0.0005, 0.004),
        thickness=diameter * numbers.uniform(2.5, 30),
        work=logarithmic(0.01, 0.1),
        scatter=numbers.uniform(0.01, 0.05),
        seed=numbers.randrange(1000),
        depth=numbers.uniform(0.15, 0.8),
    )


def pillars(case: Case) -> list[tuple[float, float, float, float]]:
    """Position from the lens axis, height and diameter of every pillar of a finite arrangement, unscaled and not rotated."""
    numbers = random.Random(case.seed)
    rows = []
    for i, j in itertools.product(range(-2, 3), repeat=2):
        x, y = i * case.pitch, j * case.pitch
        height, diameter = case.height, case.diameter
        if case.arrangement in ("listed", "unequal"):
            space = 0.45 * (case.pitch - 1.3 * case.diameter)
            x, y = x + numbers.uniform(-space, space), y + numbers.uniform(-space, space)
        if case.arrangement == "unequal":
            height *= numbers.uniform(0.97, 1.0)
            diameter *= numbers.uniform(0.7, 1.3)
        rows.append((x, y, height, diameter))
    return rows


def turned(x: float, y: float, angle: float) -> tuple[float, float]:
    cos, sin = math.cos(angle), math.sin(angle)
    return x * cos - y * sin, x * sin + y * cos


def written(case: Case, folder: Path) -> Path:
    """Writes the case file, with its tables."""
    unit, modulus = case.length, case.modulus
    lines = ["[lens]"]
    if case.lens in ("sphere", "paraboloid", "cylinder"):
        lines.append(f"radius = {case.radius * unit!r}")
    if case.lens != "sphere":
        lines.append(f'shape = "{case.lens}"')
    if case.lens == "cylinder":
        lines.append(f"angle = {case.angle + case.rotation!r}")
    if case.lens == "plate":
        lines += [f"tilt = {case.tilt!r}", f"tilt_direction = {case.angle + case.rotation!r}"]
    if case.lens == "profile":
        table = folder / "profile.csv"
        radii = [case.radius * unit * (k / 150) ** 1.2 * 0.7 for k in range(151)]
        heights = [r * r / (2 * case.radius * unit) * (1 + 0.1 * (r / (case.radius * unit)) ** 2) for r in radii]
        rows = [f"{r!r},{h!r}" for r, h in zip(radii, heights, strict=True)]
        table.write_text("\n".join(["radius_m,height_m", *rows]) + "\n")
        lines.append('profile = "profile.csv"')
    lines += [f"young_modulus = {case.moduli[0] * modulus!r}", f"poisson_ratio = {case.ratios[0]!r}"]
    lines += ["[substrate]", f"young_modulus = {case.moduli[1] * modulus!r}"]
    lines.append(f"poisson_ratio = {case.ratios[1]!r}")
    if case.physics == "layers":
        lines.append(f"thickness = {(case.thickness + case.height) * unit!r}")
    diameter, height, pitch = (value * unit for value in (case.diameter, case.height, case.pitch))
    offset = [f"offset = {case.offset[0]!r}", f"offset_angle = {case.offset[1]!r}"]
    if case.physics == "elements":
        lattice = "hexagonal" if case.arrangement == "hexagonal" else "square"
        width = 2.6 * math.sqrt(2 * case.radius * unit * 1.5 * height) + 4 * pitch
        lines += ["[surface]", f'arrangement = "{lattice}"', f"pitch = {pitch!r}", *offset]
        if case.arrangement == "scattered":
            lines += [f"height_half_width = {case.scatter!r}", f"seed = {case.seed}"]
        lines += ["[surface.pillar]", f"diameter = {diameter!r}", f"height = {height!r}", 'compliance = "none"']
        lines += ["[surface.grid]", "cells_per_diameter = 8", f"width = {width!r}"]
    else:
        lines.append("[pattern]")
        if case.as_list or case.arrangement in ("listed", "unequal"):
            rows = []
            for x, y, own_height, own_diameter in pillars(case):
                u, v = turned(x, y, case.rotation)
                rows.append(",".join(repr(value * unit) for value in (u, v, own_height, own_diameter)))
            (folder / "pillars.csv").write_text("\n".join(["x_m,y_m,height_m,diameter_m", *rows]) + "\n")
            lines += ['lattice = "listed"', 'pillars = "pillars.csv"']
        else:
            form = {"scattered": "square", "finite": "square"}.get(case.arrangement, case.arrangement)
            lines += [f'lattice = "{form}"', f"pitch = {pitch!r}"]
            if form in ("rectangular", "oblique"):
                lines.append(f"pitch_y = {1.25 * pitch!r}")
            if form == "oblique":
                lines.append("lattice_angle = 1.2")
            if case.is_finite or case.lens in ("cylinder", "plate"):
                lines.append("columns = 5")
            else:
                lines += offset
            if case.rotation:
                lines.append(f"rotation = {case.rotation!r}")
            if case.arrangement == "scattered":
                lines += [f"height_standard_deviation = {case.scatter!r}", f"seed = {case.seed}"]
        if case.is_rounded:
            lines.append(f"top_radius = {3 * diameter!r}")
        lines.append("[pattern.pillar]")
        if not (case.as_list or case.arrangement in ("listed", "unequal")):
            lines += [f"diameter = {diameter!r}", f"height = {height!r}"]
        compliance = "elastic" if case.physics == "elastic" else "column"
        if case.physics == "adhesive tops":
            compliance = ("none", "column")[case.seed % 2]
        lines.append(f'compliance = "{compliance}"')
    if case.physics.startswith("adhesive"):
        lines += ["[adhesion]", f"work = {case.work * unit * modulus!r}"]
        if case.physics == "adhesive floor":
            lines.append("floor = true")
    path = folder / "case.toml"
    path.write_text("\n".join(lines) + "\n")
    return path


class Refused(Exception):
    """The combination is refused, with a reason."""


class Failed(Exception):
    """No result, and no reason."""


def run(fakir: str, arguments: list[str]) -> dict[str, Any]:
    """The JSON of a command."""
    command = [fakir, *arguments, "--json", "--quiet"]
    with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as err:
        process = subprocess.Popen(command, stdout=out, stderr=err)
        # Waited for here and not by `subprocess`, which does not return the processor time of one program.
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = code = os.waitstatus_to_exitcode(status)
        for stream in (out, err):
            stream.seek(0)
        printed, messages = out.read(), err.read()
    if code == -signal.SIGXCPU:
        raise Failed("longer than the limit of processor time")
    if code == 2:
        # The message stands before the excerpt of the case file.
        words = messages.split("╭─", 1)[0]
        raise Refused(" ".join(words.replace("×", " ").replace("│", " ").split()))
    if code not in (0, 1) or not printed:
        raise Failed(f"status {code}: {messages.strip()[-300:]}")
    answer = json.loads(printed)
    answer["processor_seconds"] = used.ru_utime + used.ru_stime
    if code == 1 and answer.get("converged", True) and not answer.get("unresolved"):
        verdict = answer.get("verdict")
        if verdict in (None, "agree"):
            raise Failed("status 1 without a reason in the result")
    answer["status"] = code
    return answer


def asked(case: Case, load: dict[str, float] | None = None) -> list[str]:
    """The command and its load, without the case file; lengths in the units of the case."""
    depth = case.depth * case.height * case.length
    options = [f"--set={key}={value}" for key, value in case.extra]
    if load:
        return ["press", *options, *(f"--{name}={value!r}" for name, value in load.items())]
    deep = [f"--indentation={depth!r}"]
    match case.question:
        case "force":
            return ["press", *options, f"--force={rough_force(case)!r}"]
        case "floor":
            return ["press", *options, f"--indentation={3.0 * case.height * case.length!r}"]
        case "gradient":
            return ["press", *options, *deep, "--gradient"]
        case "cycle":
            return ["cycle", *options, f"--to={depth!r}"]
        case "transition":
            return ["transition", *options]
        case "approach":
            return ["approach", *options, f"--to={depth!r}"]
    return [case.question, *options, *deep]


def rough_force(case: Case) -> float:
    """A force that reaches about the depth, from Hertz."""
    compliance = sum(
        (1 - ratio**2) / (modulus * case.modulus) for modulus, ratio in zip(case.moduli, case.ratios, strict=True)
    )
    depth = 0.3 * case.depth * case.height * case.length
    return 4 / 3 / compliance * math.sqrt(case.radius * case.length) * depth**1.5


@dataclass
class Finding:
    """The outcome of a cell."""

    cell: str
    outcome: str
    lines: list[str] = field(default_factory=list)
    seconds: float = 0.0
    """Processor time of its longest computation."""


def errors_of(answer: dict[str, Any]) -> dict[str, float]:
    """Relative errors of force and indentation."""
    errors = answer.get("relative_error_estimate") or {}
    found = {"force": 0.0, "indentation": 0.0}
    for name in found:
        for key in (name, f"critical_{name}"):
            if isinstance(errors.get(key), float):
                found[name] = errors[key]
    if isinstance(answer.get("force_error_estimate"), float):
        found["force"] = answer["force_error_estimate"]
    if isinstance(errors.get("indentation_m"), float) and answer.get("indentation_m"):
        found["indentation"] = errors["indentation_m"] / abs(answer["indentation_m"])
    return found


def numbers_of(answer: dict[str, Any]) -> dict[str, float]:
    """Force and indentation of a contact or a critical state."""
    numbers = {}
    for name, unit in (("force", "N"), ("indentation", "m")):
        for key in (f"{name}_{unit}", f"critical_{name}_{unit}"):
            if isinstance(answer.get(key), float):
                numbers[name] = answer[key]
    return numbers


def error_of_cycle(answer: dict[str, Any], name: str) -> float:
    """Relative error of a number of a cycle: with flat tops it has several parts, of which the numerical one is used."""
    error = (answer.get("relative_error_estimate") or {}).get(name)
    return (error.get("numerical") if isinstance(error, dict) else error) or 0.0


class Checks:
    """All computations for one cell."""

    def __init__(self, fakir: str, case: Case, folder: Path) -> None:
        self.fakir, self.case, self.folder = fakir, case, folder
        self.lines: list[str] = []
        self.compared = 0
        self.made = 0
        self.seconds = 0.0

    def answer(self, case: Case, load: dict[str, float] | None = None) -> dict[str, Any]:
        self.made += 1
        folder = self.folder / str(self.made)
        folder.mkdir()
        command, *options = asked(case, load)
        found = run(self.fakir, [command, str(written(case, folder)), *options])
        self.seconds = max(self.seconds, found["processor_seconds"])
        return found

    def compare(self, check: str, one: float, other: float, allowed: float, least: float = 0.0) -> None:
        """Two values of a number, with the sum of their errors relative to them or to a least value."""
        self.compared += 1
        scale = max(abs(one), abs(other), least)
        if scale > 0 and not abs(one - other) <= (allowed + ROUNDING) * scale:
            self.lines.append(f"{check}: {one!r} and {other!r} differ by {abs(one - other) / scale:.2e}, allowed {allowed:.2e}")

    def states(self, check: str, one: dict[str, Any], other: dict[str, Any], factors: tuple[float, float]) -> None:
        """Two contacts, of which the second is in other units."""
        errors, other_errors = errors_of(one), errors_of(other)
        for name, factor in zip(("force", "indentation"), factors, strict=True):
            values, others = numbers_of(one), numbers_of(other)
            if name in values and name in others:
                # An error of the prescribed number is one of the other.
                both = max(errors.values()) + max(other_errors.values())
                # The error of an indentation is relative to the depth below the first contact, which may be above zero.
                least = self.case.rise * factor if name == "indentation" else 0.0
                self.compare(f"{check}, {name}", values[name] * factor, others[name], both, least)

    def cycles(self, check: str, one: dict[str, Any], other: dict[str, Any], factors: tuple[float, float]) -> None:
        """Two cycles: pull-off force and hysteresis."""
        force, length = factors
        for key, name, factor in (
            ("pull_off_force_N", "pull_off_force", force),
            ("hysteresis_J", "hysteresis", force * length),
        ):
            if one.get(key) is not None and other.get(key) is not None:
                allowed = error_of_cycle(one, name) + error_of_cycle(other, name)
                self.compare(f"{check}, {name}", one[key] * factor, other[key], allowed)

    def examine(self) -> str:
        """Makes the computations; returns the outcome."""
        case = self.case
        first = self.answer(case)
        if first["status"] == 1 and case.question != "verify":
            return "not resolved"
        if case.question == "verify":
            if first.get("verdict") == "disagree":
                self.lines.append(f"verify disagrees: {first}")
            self.compared += 1
            return "verified" if first.get("verdict") == "agree" else "not resolved"
        compare = self.cycles if case.question == "cycle" else self.states
        compare_last = case.question == "approach"
        if compare_last:
            first = last_of(first)
        for check, other, factors in self.copies():
            try:
                answer = self.answer(other)
            except Refused as refused:
                self.lines.append(f"{check}: refused: {refused}")
                continue
            if answer["status"] == 1:
                continue
            compare(check, first, last_of(answer) if compare_last else answer, factors)
        if case.question == "cycle" and first.get("dissipation_J") and first.get("hysteresis_J"):
            allowed = 1e-3 + error_of_cycle(first, "hysteresis")
            self.compare("energy balance", first["hysteresis_J"], first["dissipation_J"], allowed)
        if case.question == "press" and first.get("force_N", 0) > 0 and not case.physics.startswith("adhesive"):
            back = self.answer(case, {"force": first["force_N"]})
            if back["status"] == 0:
                self.states("force and back", first, back, (1.0, 1.0))
        if case.question == "gradient":
            self.differences(first)
        return "compared" if self.compared else "answered"

    def copies(self) -> list[tuple[str, Case, tuple[float, float]]]:
        """The same case in other forms, with the factors of force and length."""
        case = self.case
        units = replace(case, length=2.0, modulus=0.5)
        copies = [("other units", units, (2.0, 2.0))]
        if case.physics == "adhesive floor":
            # Each cycle takes seconds.
            return copies
        is_fixed = case.physics == "elements" or (case.arrangement == "scattered")
        if not is_fixed:
            copies.append(("rotated", replace(case, rotation=0.7), (1.0, 1.0)))
        if not case.is_rounded and case.physics != "elements" and case.question != "cycle":
            accurate = replace(case, extra=(("method.accuracy", "accurate"),))
            copies.append(("accurate", accurate, (1.0, 1.0)))
        if case.arrangement == "finite" and case.physics != "elements":
            copies.append(("as a list", replace(case, as_list=True), (1.0, 1.0)))
        return copies

    def differences(self, first: dict[str, Any]) -> None:
        """Derivatives with respect to the moduli, by central differences."""
        case = self.case
        derivatives = (first.get("gradient") or {}).get("force_N") or {}
        derivative = derivatives.get("substrate.young_modulus")
        if derivative is None:
            self.lines.append("no derivative with respect to substrate.young_modulus")
            return
        step, forces = 1e-3, []
        for sign in (-1, 1):
            lens, substrate = case.moduli
            other = replace(case, question="press", moduli=(lens, substrate * (1 + sign * step)))
            forces.append(self.answer(other)["force_N"])
        found = (forces[1] - forces[0]) / (2 * step * case.moduli[1])
        # The set of touched pillars may change within the step.
        self.compare("derivative by substrate.young_modulus", derivative, found, 2e-2)


def last_of(approach: dict[str, Any]) -> dict[str, Any]:
    """The last state of a loading, with the status and the errors of the whole."""
    states = approach.get("states") or approach.get("stations") or []
    return {**states[-1], "status": approach["status"]} if states else approach


def examined(fakir: str, cell: tuple[str, str, str, str], seed: int) -> Finding:
    """The outcome of one cell."""
    case = drawn(cell, seed)
    with tempfile.TemporaryDirectory(prefix="combinations-") as folder:
        checks = Checks(fakir, case, Path(folder))
        try:
            outcome = checks.examine()
        except Refused as refused:
            return Finding(case.name, f"refused:{str(refused).partition(':')[2]}")
        except Failed as failed:
            outcome, checks.lines = "failed", [*checks.lines, str(failed)]
        if checks.lines:
            text = written(case, Path(folder)).read_text()
            command = " ".join(asked(case))
            outcome = "disagreement" if outcome != "failed" else outcome
            return Finding(case.name, outcome, [*checks.lines, command, text], checks.seconds)
        return Finding(case.name, outcome, [], checks.seconds)


def has_meaning(cell: tuple[str, str, str, str]) -> bool:
    """Whether the words of a cell describe something: a cycle has adhesion, elements have lattices."""
    question, _, arrangement, physics = cell
    if question == "cycle" and not physics.startswith("adhesive"):
        return False
    if physics == "elements":
        return arrangement in ("hexagonal", "square", "scattered")
    return not (physics in ("rounded", "adhesive rounded") and arrangement == "unequal")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fakir", required=True, help="the command")
    parser.add_argument("--cells", type=int, default=500, help="number of cells, drawn among all")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", help="one cell: QUESTION,LENS,ARRANGEMENT,PHYSICS")
    parser.add_argument("--limit", type=int, default=SECONDS, help="processor time of one computation, s")
    arguments = parser.parse_args()
    # Inherited by the command; this program needs a few seconds itself.
    resource.setrlimit(resource.RLIMIT_CPU, (arguments.limit, resource.getrlimit(resource.RLIMIT_CPU)[1]))
    cells = [cell for cell in itertools.product(QUESTIONS, LENSES, ARRANGEMENTS, PHYSICS) if has_meaning(cell)]
    if arguments.only:
        parts = tuple(part.strip() for part in arguments.only.split(","))
        cells = [cell for cell in cells if all(want in ("", have) for want, have in zip(parts, cell, strict=True))]
    else:
        total = len(cells)
        cells = random.Random(arguments.seed).sample(cells, min(arguments.cells, total))
    outcomes: Counter[str] = Counter()
    reasons: Counter[str] = Counter()
    slowest = Finding("none", "")
    bad = 0
    with ThreadPoolExecutor(max_workers=os.cpu_count()) as pool:
        for finding in pool.map(lambda cell: examined(arguments.fakir, cell, arguments.seed), cells):
            kind, _, reason = finding.outcome.partition(":")
            outcomes[kind] += 1
            if reason:
                reasons[reason.strip()] += 1
            if finding.lines:
                bad += 1
                print(f"{finding.cell}: {finding.outcome}", *finding.lines, sep="\n    ", flush=True)
            elif finding.outcome == "not resolved" or finding.seconds > SLOW:
                print(f"{finding.cell}: {finding.outcome}, {finding.seconds:.0f} s", flush=True)
            slowest = max(slowest, finding, key=lambda one: one.seconds)
    print(f"{len(cells)} cells, seed {arguments.seed}: " + ", ".join(f"{count} {kind}" for kind, count in outcomes.most_common()))
    print(f"  slowest computation: {slowest.seconds:.1f} s of processor time ({slowest.cell})")
    for reason, count in reasons.most_common():
        print(f"  {count:4} refused {reason[:300]}")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
