"""Tamaas's Maxwell material, in the environment of the peers: prints one JSON object.

    viscoelastic_worker.py '{"task": "material", ...}'     the stress of a wave in full contact, whose strain is held
    viscoelastic_worker.py '{"task": "heights", ...}'      writes the pillars with floor
    viscoelastic_worker.py '{"task": "creep", ...}'        a force that is held on them

Units are micrometres, megapascals and seconds. The model has a relaxed contact modulus of 1 as given to Tamaas.
"""

import json
import sys
import time

import numpy as np


def model(side, size):
    import tamaas

    tamaas.initialize(1)
    tamaas.set_log_level(tamaas.LogLevel.error)
    found = tamaas.ModelFactory.createModel(tamaas.model_type.basic_2d, [size, size], [side, side])
    found.nu, found.E = 0.0, 1.0
    return tamaas, found


def solver_of(tamaas, found, shape, order):
    # The shear modulus of the model is 1/2.
    moduli, times = [0.5 * order["strength"]], [order["relaxation_time"]]
    solver = tamaas.MaxwellViscoelastic(found, shape, order["tolerance"], order["step"], moduli, times)
    solver.max_iter = 10_000
    return solver


def material(order):
    """The relaxation function: in full contact the displacement is the wave, and its stress relaxes."""
    side, height = 32, 1e-3
    wave = np.cos(2 * np.pi * np.arange(side) / side) * np.ones((side, 1))
    tamaas, found = model(side, 1.0)
    solver = solver_of(tamaas, found, height * wave, order)
    values = []
    for _ in range(order["steps"]):
        solver.solve(0.1)
        stress = np.array(found.traction).reshape(side, side)
        values.append(2.0 * float((stress * wave).mean()) / (np.pi * height))
    return {"modulus": values}


def coordinates(order):
    line = (np.arange(order["side"]) + 0.5) * order["size"] / order["side"] - 0.5 * order["size"]
    return np.meshgrid(line, line)


def heights(order):
    """Square tops of half the pitch on a square lattice, the lens axis on a top; the floor is below them."""
    x, y = coordinates(order)
    on_top = np.logical_and(*((at / order["pitch"] + 0.25) % 1.0 < 0.5 for at in (x, y)))
    np.save(order["file"], 1e-6 * np.where(on_top, 0.0, -order["pillar_height"]))
    return {"tops": int(on_top.sum())}


def creep(order):
    x, y = coordinates(order)
    surface = 1e6 * np.load(order["file"])
    is_top = surface > -0.5 * order["pillar_height"]
    # The parabola of the lens is part of the heights.
    shape = surface - (x**2 + y**2) / (2.0 * order["lens_radius"])
    side, size = order["side"], order["size"]
    tamaas, found = model(side, size)
    tamaas.ModelFactory.registerNonPeriodic(found, "free")
    solver = solver_of(tamaas, found, shape, order)
    solver.setIntegralOperator("free")
    start = time.process_time()
    cell = (size / side) ** 2
    states = []
    for number in range(1, order["steps"] + 1):
        solver.solve(order["force"] / size**2)
        pressure = np.array(found.traction).reshape(side, side)
        states.append({
            "time_s": number * order["step"],
            "tops": cell * float(((pressure > 0.0) & is_top).sum()),
            "floor": cell * float(((pressure > 0.0) & ~is_top).sum()),
            "share": float(pressure[~is_top].sum() / pressure.sum()),
        })
    return {"processor_s": time.process_time() - start, "states": states}


if __name__ == "__main__":
    asked = json.loads(sys.argv[1])
    print(json.dumps({"material": material, "heights": heights, "creep": creep}[asked["task"]](asked)))
