"""The retraction of a lens from a few rigid pillar tops by the Adhesion package: prints one JSON object.

Lengths are in micrometres, the contact modulus is 1. The tops are hard walls that attract by the gap `g` with the energy
`-w exp(-g/range)` per area; what is not a top is out of reach. The lens is withdrawn step by step, and near the pull-off again
in smaller steps.
"""

import json
import sys
import time

import numpy as np
from Adhesion.Interactions import Exponential
from Adhesion.System import BoundedSmoothContactSystem
from ContactMechanics import FreeFFTElasticHalfSpace
from SurfaceTopography import Topography

OUT_OF_REACH = 1e3
STEPS = [0.1, 0.02, 0.004]


class Retraction:
    def __init__(self, order):
        side, size = order["side"], order["size"]
        places = (np.arange(side) + 0.5) * size / side - 0.5 * size
        x, y = np.meshgrid(places, places, indexing="ij")
        top = np.zeros((side, side), dtype=bool)
        for u, v in order["centres"]:
            top |= (x - u) ** 2 + (y - v) ** 2 < order["pillar_radius"] ** 2
        squares = x**2 + y**2
        sag = squares / (order["lens_radius"] + np.sqrt(order["lens_radius"] ** 2 - squares))
        sizes = (size, size)
        substrate = FreeFFTElasticHalfSpace((side, side), 1.0, sizes)
        topography = Topography(np.where(top, -sag, -OUT_OF_REACH), physical_sizes=sizes)
        self.system = BoundedSmoothContactSystem(
            substrate, Exponential(np.where(top, order["work"], 0.0), order["range"]), topography
        )
        self.cell_force = substrate.area_per_pt * order["work"] / order["range"]
        self.tolerance = order["tolerance"]
        self.iterations = 0
        self.cells_of_top = int(top.sum()) / len(order["centres"])

    def force(self, indentation, start):
        """The force, and the displacement from which the next step starts."""
        result = self.system.minimize_proxy(
            offset=indentation, initial_displacements=start,
            options={"gtol": self.tolerance * self.cell_force, "ftol": 0, "maxiter": 100_000, "maxcor": 10},
        )
        self.iterations += int(result.nit)
        return float(self.system.compute_normal_force()), np.array(self.system.disp)

    def pull_off(self, indentation):
        """The smallest force, and its indentation; the force decreases until the first top detaches."""
        least, kept = np.inf, None
        for step in STEPS:
            at = indentation if kept is None else kept[0]
            start = None if kept is None else kept[1]
            while True:
                force, displacement = self.force(at, start)
                if force > least:
                    break
                least, kept, start = force, (at, displacement), displacement
                at -= step
            indentation = kept[0]
        return {"pull_off": least, "indentation": indentation}


def main():
    order = json.loads(sys.argv[1])
    start = time.process_time()
    retraction = Retraction(order)
    answer = retraction.pull_off(order["indentation"])
    answer |= {
        "time_s": time.process_time() - start,
        "iterations": retraction.iterations,
        "cells_of_top": retraction.cells_of_top,
    }
    print(json.dumps(answer))


if __name__ == "__main__":
    main()
