"""The paper's texture solved by a peer: prints one JSON object.

    python texture_worker.py '{"peer": "Tamaas", "question": "transition", "cells": 512, ...}'

Runs in the environment that run.py makes, in a separate process for every measurement. Lengths
are in um, moduli in MPa, forces in uN.

The grid is the smallest square that contains the contact. Its cells on pillar tops are those whose centre
is on one. The others are lowered so far that they carry no load, and the gap to the real floor is
read from the displacements there; so states past the critical one are solved, and can be
interpolated between. In mixed contact they are the floor and carry load. Each grid starts from Hertz's pressure on the tops and, on the same grid, from the
solution before. The load starts at the true one on the coarsest grid, and where the coarser grids
point to on the others, which are solved first, in the same process and time. It is moved along the
slope that the gap had, until the step left is so small that it can be taken without another
solution.
"""

import json
import math
import resource
import sys

import numpy as np

# A coarser grid is solved first unless it has fewer cells across a pillar than this.
COARSEST = 2.4
# Steps of the load, relative, that need no other solution.
STEP = 1e-2
MOST_SOLUTIONS = 20
# What is moved with the load.
LOADS = ["force", "indentation", "floor_force"]
SHARE = "extrapolated_floor_share"
# How much the square may be wider than the contact.
MARGINS = np.linspace(1.005, 1.045, 21)
BLOCK = 64


def status(key):
    with open("/proc/self/status") as lines:
        return next(1024 * int(line.split()[1]) for line in lines if line.startswith(key))


def processor_time():
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime


def fitting_width(order, cells):
    """Width of the square for which the cells on the tops of the pillars in contact have the area of these, as
    nearly as can be: where cells and lattice are in step, all pillars would be too large, or too small."""
    radius, diameter, pitch = order["contact_radius"], order["diameter"], order["pitch"]
    count = math.ceil(radius / pitch) + 1
    i, j = np.meshgrid(*[np.arange(-2 * count, 2 * count + 1)] * 2)
    x, y = math.sqrt(3) / 2 * pitch * (i + j), pitch / 2 * (i - j)
    near = np.hypot(x, y) < radius
    x, y = x[near], y[near]

    def excess(width):
        cell = width / cells
        reach = math.ceil(diameter / cell / 2) + 1
        local = np.arange(-reach, reach + 1) + 0.5
        squared = [((local - (c / cell % 1.0)[:, None]) * cell) ** 2 for c in (x, y)]
        pairs = zip(*squared)
        counts = sum(np.count_nonzero(row[:, None] + column < diameter**2 / 4) for row, column in pairs)
        return abs(counts * cell**2 / (len(x) * math.pi * diameter**2 / 4) - 1.0)

    return min((2 * margin * radius for margin in MARGINS), key=excess)


class Texture:
    """The lens over the pillars, on a grid."""

    def __init__(self, order, cells):
        self.lens, self.height = order["lens_radius"], order["height"]
        self.cells, self.width = cells, order["width"]
        self.cell = self.width / cells
        self.modulus = order["contact_modulus"]
        self.line = (np.arange(cells) + 0.5) * self.cell - self.width / 2
        self.top = np.zeros((cells, cells), bool)
        pitch, diameter = order["pitch"], order["diameter"]
        # Two rectangular lattices make the hexagonal one.
        for shift in [0.0, 0.5]:
            u = math.sqrt(3) * pitch * ((self.line / (math.sqrt(3) * pitch) - shift + 0.5) % 1.0 - 0.5)
            v = pitch * ((self.line / pitch - shift + 0.5) % 1.0 - 0.5)
            self.top |= u[:, None] ** 2 + v**2 < diameter**2 / 4
        # The floor, or below any indentation that is looked at.
        self.depth = self.height if order["question"] == "mixed" else order["indentation"] + self.height

    def sag(self, rows):
        return self.lens - np.sqrt(self.lens**2 - self.line[rows, None] ** 2 - self.line**2)

    def rows(self):
        return [slice(start, start + BLOCK) for start in range(0, self.cells, BLOCK)]

    def heights(self):
        """Of the pillars below the lens, upside down: the separation with the sign changed."""
        heights = np.empty((self.cells, self.cells))
        for rows in self.rows():
            heights[rows] = -self.sag(rows)
        heights[~self.top] -= self.depth
        return heights

    def floor_gap(self, displacement, indentation):
        """The smallest gap to the real floor."""
        smallest = np.inf
        for rows in self.rows():
            gap = self.sag(rows) + self.height + displacement[rows] - indentation
            smallest = gap[~self.top[rows]].min(initial=smallest)
        return float(smallest)

    def floor_force(self, pressure):
        """The load of the cells outside the tops."""
        return float(pressure[~self.top].sum()) * self.cell**2

    def hertz(self, force):
        """Pressure of the lens without a texture, on the pillar tops alone."""
        radius = (3 * force * self.lens / (4 * self.modulus)) ** (1 / 3)
        squared = (self.line[:, None] ** 2 + self.line**2) / radius**2
        return self.scaled(np.sqrt(np.maximum(0.0, 1.0 - squared)), force)

    def scaled(self, pressure, force):
        pressure *= self.top
        pressure *= force / (pressure.sum() * self.cell**2)
        return pressure


class ContactMechanics:
    """Takes an indentation. The dual minimisation is several times faster than the solver of Polonsky
    and Keer there, and both give the same."""

    takes = "indentation"

    def __init__(self, texture, tolerance):
        from ContactMechanics import FreeFFTElasticHalfSpace
        from ContactMechanics.Systems import NonSmoothContactSystem
        from SurfaceTopography import Topography

        self.texture = texture
        sizes = (texture.width, texture.width)
        self.half_space = FreeFFTElasticHalfSpace(texture.top.shape, texture.modulus, sizes)
        topography = Topography(texture.heights(), physical_sizes=sizes)
        self.system = NonSmoothContactSystem(self.half_space, topography)
        # The largest gap or interpenetration in contact.
        self.tolerance = tolerance * texture.height

    def solve(self, indentation, pressure):
        area = self.texture.cell**2
        pressure *= area
        result = self.system.dual_minimize_proxy(
            indentation, init_force=pressure, gtol=self.tolerance, maxiter=10_000
        )
        if not result.success:
            raise RuntimeError(str(result.message))
        forces = result.x.reshape(pressure.shape)
        cells = self.texture.cells
        displacement = self.half_space.evaluate_disp(-forces)[:cells, :cells]
        return {
            "force": float(forces.sum()),
            "indentation": indentation,
            "floor_gap": self.texture.floor_gap(displacement, indentation),
            "floor_force": self.texture.floor_force(forces / area),
            "iterations": int(result.nit),
        }, forces / area


class Tamaas:
    """Solves for a force, given as mean pressure; starts from the pressure of the model."""

    takes = "force"

    def __init__(self, texture, tolerance):
        import tamaas

        tamaas.initialize(1)
        tamaas.set_log_level(tamaas.LogLevel.error)
        self.texture = texture
        sizes = [texture.width, texture.width]
        self.model = tamaas.ModelFactory.createModel(
            tamaas.model_type.basic_2d, sizes, list(texture.top.shape)
        )
        self.model.E, self.model.nu = texture.modulus, 0.0
        tamaas.ModelFactory.registerNonPeriodic(self.model, "free")
        self.surface = texture.heights()
        self.solver = tamaas.PolonskyKeerRey(self.model, self.surface, tolerance)
        self.solver.setIntegralOperator("free")
        self.solver.max_iter = 10_000

    def solve(self, force, pressure):
        model, texture = self.model, self.texture
        if pressure is not model.traction:
            model.traction[:] = pressure
        error = self.solver.solve(force / texture.width**2)
        if error > self.solver.tolerance:
            raise RuntimeError(f"stopped at {error:e}")
        # Its displacement does not include the indentation, which follows from the cells in contact.
        pressure, displacement = model.traction, model.displacement
        model.operators["free"](pressure, displacement)
        load = pressure.sum()
        indentation = float(
            (np.vdot(pressure, displacement) - np.vdot(pressure, self.surface)) / load
        )
        return {
            "force": force,
            "indentation": indentation,
            "floor_gap": texture.floor_gap(displacement, indentation),
            "floor_force": texture.floor_force(pressure),
        }, pressure


PEERS = {"ContactMechanics": ContactMechanics, "Tamaas": Tamaas}


def residual(question, order, state):
    """What is to vanish, in units in which it is about linear in the logarithm of the load."""
    if question == "transition":
        return state["floor_gap"] / order["height"]
    return math.log(state["indentation"] / order["indentation"])


class Search:
    """Finds the load at which the residual vanishes, on one grid after the other."""

    def __init__(self, order):
        self.order, self.question = order, order["question"]
        self.kind = PEERS[order["peer"]]
        self.solutions, self.found, self.log = 0, [], []
        # By the logarithm of the load: of the residual, and of the force and the indentation.
        self.slopes = None

    def first_load(self):
        """Where the coarser grids point to: their errors fall in proportion to the cells."""
        loads = [found[self.kind.takes] for found in self.found]
        if len(loads) < 2:
            return loads[-1] if loads else self.order[self.kind.takes]
        return loads[-1] + 0.5 * (loads[-1] - loads[-2])

    def on(self, texture):
        peer = self.kind(texture, self.order["tolerance"])
        load, previous = self.first_load(), None
        pressure = texture.hertz(self.found[-1]["force"] if self.found else self.order["force"])
        for _ in range(MOST_SOLUTIONS):
            state, pressure = peer.solve(load, pressure)
            self.solutions += 1
            self.log.append({"cells": texture.cells, **state})
            if self.question != "transition" and self.kind.takes == "indentation":
                return state
            here = (load, residual(self.question, self.order, state), state)
            if previous:
                self.slopes = slopes(previous, here)
            # The coarsest grid has no previous slope; the step is large enough to determine one.
            step = -here[1] / self.slopes["residual"] if self.slopes else 0.02
            if self.slopes and abs(step) < STEP:
                for key in LOADS:
                    state[key] *= math.exp(self.slopes[key] * step)
                return state
            previous, load = here, load * math.exp(max(-0.2, min(0.2, step)))
        raise RuntimeError(f"no load found with {MOST_SOLUTIONS} solutions on one grid")

    def run(self):
        cells = [self.order["cells"]]
        width = self.order["width"]
        alone = self.question != "transition" and self.kind.takes == "indentation"
        while not alone and cells[0] % 2 == 0 and cells[0] / 2 * self.order["diameter"] / width > COARSEST:
            cells.insert(0, cells[0] // 2)
        for count in cells:
            self.found.append(self.on(Texture(self.order, count)))
        return self.found[-1]


def slopes(previous, here):
    step = math.log(here[0] / previous[0])
    pairs = {key: (previous[2][key], here[2][key]) for key in LOADS}
    # Nothing on the floor stays nothing.
    loads = {key: math.log(b / a) / step if a > 0 and b > 0 else 0.0 for key, (a, b) in pairs.items()}
    return {"residual": (here[1] - previous[1]) / step, **loads}


def extrapolated(found):
    """Of the two finest grids, whose errors fall in proportion to the cells."""
    names = {"force": "extrapolated_force_N", "indentation": "extrapolated_indentation_m"}
    if len(found) < 2:
        return dict.fromkeys([*names.values(), SHARE])
    shares = [state["floor_force"] / state["force"] for state in found[-2:]]
    loads = {name: 1e-6 * (2 * found[-1][key] - found[-2][key]) for key, name in names.items()}
    return {**loads, SHARE: 2 * shares[1] - shares[0] or None}


def main():
    order = json.loads(sys.argv[1])
    # The modules are loaded by a small problem of the same kind, which is not counted.
    radius = order["contact_radius"]
    small = {**order, "cells": 16, "width": 2.04 * radius, "diameter": radius, "question": "press"}
    Search(small).on(Texture(small, 16))
    baseline, start = status("VmRSS"), processor_time()
    search = Search({**order, "width": fitting_width(order, order["cells"])})
    state = search.run()
    print(
        json.dumps(
            {
                "processor_s": processor_time() - start,
                "peak_bytes": status("VmHWM"),
                "net_bytes": status("VmHWM") - baseline,
                "force_N": 1e-6 * state["force"],
                "indentation_m": 1e-6 * state["indentation"],
                "floor_share": state["floor_force"] / state["force"] if search.question == "mixed" else None,
                **extrapolated(search.found),
                "solutions": search.solutions,
                "log": search.log,
            }
        )
    )


if __name__ == "__main__":
    main()
