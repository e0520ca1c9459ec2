"""One product or one solution by a peer, timed: prints one JSON object.

Runs in the environment that run.py makes. The compliance of the half-space is 1, so that the
contact modulus is 1. Memory is the increase of the process from before the operator was
made.
"""

import json
import sys
import time

import numpy as np


def status(key):
    with open("/proc/self/status") as lines:
        for line in lines:
            if line.startswith(key):
                return 1024 * int(line.split()[1])
    raise RuntimeError(f"no {key} in the status of the process")


def wave(side):
    return np.sin(np.arange(side * side, dtype=float)).reshape(side, side)


def love_kernel(side):
    """Potential of a unit square at the centres of the others, on a padded grid."""
    index = np.arange(2 * side)
    distance = np.where(index <= side, index, 2 * side - index).astype(float)
    x, y = distance[:, None], distance[None, :]

    def corner(x, y):
        return x * np.arcsinh(y / np.abs(x)) + y * np.arcsinh(x / np.abs(y))

    a = 0.5
    corners = corner(x + a, y + a) - corner(x - a, y + a) - corner(x + a, y - a) + corner(x - a, y - a)
    return corners / np.pi


class Scipy:
    """The textbook product: padded to twice the size, real transforms of SciPy."""

    def __init__(self, side, threads):
        from scipy import fft

        self.fft, self.side, self.threads = fft, side, threads
        self.kernel = fft.rfft2(love_kernel(side), workers=threads)

    def __call__(self, pressure):
        shape = (2 * self.side, 2 * self.side)
        spectrum = self.fft.rfft2(pressure, s=shape, workers=self.threads)
        spectrum *= self.kernel
        return self.fft.irfft2(spectrum, s=shape, workers=self.threads)[: self.side, : self.side]


class ContactMechanics:
    """evaluate_disp of the free half-space, of forces at points of the padded grid."""

    def __init__(self, side, _threads):
        from ContactMechanics import FreeFFTElasticHalfSpace

        self.half_space = FreeFFTElasticHalfSpace((side, side), 1.0, (float(side), float(side)))
        self.side = side
        self.forces = np.zeros((2 * side, 2 * side))

    def __call__(self, pressure):
        self.forces[: self.side, : self.side] = -pressure
        return self.half_space.evaluate_disp(self.forces)[: self.side, : self.side]


def tamaas_model(shape, sizes, threads):
    import tamaas

    tamaas.initialize(threads)
    tamaas.set_log_level(tamaas.LogLevel.error)
    model = tamaas.ModelFactory.createModel(tamaas.model_type.basic_2d, list(sizes), list(shape))
    model.E, model.nu = 1.0, 0.0
    return tamaas, model


class Tamaas:
    """The non-periodic operator of Tamaas."""

    def __init__(self, side, threads):
        tamaas, self.model = tamaas_model((side, side), (float(side), float(side)), threads)
        tamaas.ModelFactory.registerNonPeriodic(self.model, "free")
        self.operator = self.model.operators["free"]
        self.displacement = np.zeros((side, side))

    def __call__(self, pressure):
        self.operator(pressure, self.displacement)
        return self.displacement


PRODUCTS = {"scipy": Scipy, "ContactMechanics": ContactMechanics, "Tamaas": Tamaas}


def product(peer, side, threads, repeats):
    kind = PRODUCTS[peer]
    kind(8, threads)(wave(8))  # imports
    pressure = wave(side)
    baseline = status("VmRSS")
    start = time.perf_counter()
    operator = kind(side, threads)
    setup = time.perf_counter() - start
    displacement = operator(pressure)
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        operator(pressure)
        times.append(time.perf_counter() - start)
    return {
        "setup_s": setup,
        "product_s": float(np.median(times)),
        "memory_bytes": status("VmHWM") - baseline,
        "check": float(displacement.flat[side * side // 2]),
    }


def solve_contact_mechanics(separation, cell, boundary, load, tolerance, _threads, _verbose):
    from ContactMechanics import FreeFFTElasticHalfSpace, PeriodicFFTElasticHalfSpace
    from ContactMechanics.Systems import NonSmoothContactSystem
    from SurfaceTopography import Topography

    rows, columns = separation.shape
    sizes = (rows * cell, columns * cell)
    start = time.perf_counter()
    half_space = FreeFFTElasticHalfSpace if boundary == "free" else PeriodicFFTElasticHalfSpace
    substrate = half_space((rows, columns), 1.0, sizes)
    topography = Topography(-separation, physical_sizes=sizes, periodic=boundary == "periodic")
    system = NonSmoothContactSystem(substrate, topography)
    # The deepest interpenetration accepted, relative to the indentation or the roughness.
    gap = tolerance * load["scale"]
    if "force" in load:
        result = system.minimize_proxy(pentol=gap, maxiter=100_000, external_force=load["force"])
        forces = result.jac
    else:
        # Needs fewer products than minimize_proxy; it takes no force.
        nothing = np.zeros(separation.shape)
        result = system.dual_minimize_proxy(load["indentation"], init_force=nothing, gtol=gap, maxiter=100_000)
        forces = result.x.reshape(separation.shape)
    total = time.perf_counter() - start
    memory = status("VmHWM")
    displacement = substrate.evaluate_disp(-forces)
    if boundary == "periodic":
        # Its mean displacement is not zero but that of the longest wave.
        displacement = displacement - displacement.mean()
    return {
        "total_s": total,
        "peak_bytes": memory,
        "iterations": int(result.nit),
        "products": int(result.get("nfev", 0)) or None,
        "force": float(forces.sum()),
        "indentation": float((forces * (displacement + separation)).sum() / forces.sum()),
        "ended": "converged" if result.success else str(result.message),
    }


def solve_tamaas(separation, cell, boundary, load, tolerance, threads, verbose):
    rows, columns = separation.shape
    start = time.perf_counter()
    tamaas, model = tamaas_model((rows, columns), (rows * cell, columns * cell), threads)
    surface = np.ascontiguousarray(-separation)
    solver = tamaas.PolonskyKeerRey(model, surface, tolerance)
    if boundary == "free":
        tamaas.ModelFactory.registerNonPeriodic(model, "free")
        solver.setIntegralOperator("free")
    solver.max_iter = 100_000
    mean_pressure = load["force"] / (rows * cell * columns * cell)
    if verbose:
        # It prints its iterations to the standard error only; run.py reads them there.
        solver.dump_freq = 1
        tamaas.set_log_level(tamaas.LogLevel.info)
    error = solver.solve(mean_pressure)
    total = time.perf_counter() - start
    memory = status("VmHWM")
    pressure = model.traction
    displacement = np.zeros_like(pressure)
    if boundary == "free":
        model.operators["free"](pressure, displacement)
    else:
        k = 2 * np.pi * np.fft.fftfreq(rows, cell)
        waves = np.hypot(k[:, None], 2 * np.pi * np.fft.rfftfreq(columns, cell))
        waves[0, 0] = np.inf
        displacement = np.fft.irfft2(2 / waves * np.fft.rfft2(pressure))
    return {
        "total_s": total,
        "peak_bytes": memory,
        "force": float(pressure.sum()) * cell * cell,
        "indentation": float((pressure * (displacement + separation)).sum() / pressure.sum()),
        "ended": "converged" if error <= tolerance else f"stopped at {error:e}",
    }


SOLVERS = {"ContactMechanics": solve_contact_mechanics, "Tamaas": solve_tamaas}


def solve(peer, problem, load, tolerance, threads, verbose=False):
    separation = np.fromfile(problem["separation"]).reshape(problem["rows"], problem["columns"])
    solver = SOLVERS[peer]
    line = np.linspace(-1, 1, 8) ** 2
    small = {"force": 1e-2, "scale": 1.0}
    solver(np.add.outer(line, line), 0.25, problem["boundary"], small, 1e-3, threads, False)  # imports
    baseline = status("VmRSS")
    answer = solver(separation, problem["cell"], problem["boundary"], load, tolerance, threads, verbose)
    answer["memory_bytes"] = answer.pop("peak_bytes") - baseline
    return answer


def main():
    order = json.loads(sys.argv[1])
    task = {"product": product, "solve": solve}[order.pop("task")]
    print(json.dumps(task(**order)))


if __name__ == "__main__":
    main()
