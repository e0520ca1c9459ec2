"""The surfaces of surfaces.py, and their contacts by aspher, timed: prints one JSON object.

    surfaces_worker.py '{"task": "problems", "folder": "...", "side": 1024}'
    surfaces_worker.py '{"task": "solve", "problem": {...}, "way": {...}, "tolerance": 1e-5}'

Runs in the environment that surfaces.py makes. The contact modulus and the side of every surface are 1. Memory is the increase of the process
from the state with the separation read and the modules loaded.
"""

import json
import sys
import time
from pathlib import Path

import numpy as np

# Forces that bring about a hundredth, a tenth and half of the rough surface into contact.
ROUGH = {"rough 1 %": 0.004, "rough 10 %": 0.05, "rough 50 %": 0.27}


def status(key):
    with open("/proc/self/status") as lines:
        for line in lines:
            if line.startswith(key):
                return 1024 * int(line.split()[1])
    raise RuntimeError(f"no {key} in the status of the process")


def rough_heights(side):
    """Waves from a quarter of the period down to eight cells, random phases, Hurst exponent 0.8, an rms slope of 1."""
    waves = np.hypot(np.fft.fftfreq(side, 1 / side)[:, None], np.fft.rfftfreq(side, 1 / side))
    inside = (waves >= 4) & (waves <= side / 8)
    amplitude = np.where(inside, np.maximum(waves, 1) ** -1.8, 0.0)
    phases = np.random.default_rng(2021).uniform(0, 2 * np.pi, waves.shape)
    heights = np.fft.irfft2(amplitude * np.exp(1j * phases))
    power = np.abs(np.fft.fft2(heights)) ** 2
    k = 2 * np.pi * np.fft.fftfreq(side, 1 / side)
    return heights / (np.sqrt((power * (k[:, None] ** 2 + k**2)).sum()) / side**2)


def problems(folder, side):
    rough = rough_heights(side)
    line = (np.arange(side) + 0.5) / side - 0.5
    x, y = np.meshgrid(line, line)
    sphere = (x * x + y * y) / 2
    # Square tops of half the pitch, 16 pitches along a side; the floor is 0.02 below them.
    on_top = np.logical_and(*((at * 16) % 1.0 < 0.5 for at in (x, y)))
    cases = [(name, "periodic", rough.max() - rough, force) for name, force in ROUGH.items()]
    # A sphere of radius 1 on the same roughness, of a fiftieth of its height; about 0.5 % of the square in contact.
    cases.append(("sphere on rough", "free", sphere + 0.02 * (rough.max() - rough), 1e-4))
    cases.append(("square pillars", "free", sphere + np.where(on_top, 0.0, 0.02), 5e-3))
    found = []
    for name, boundary, separation, force in cases:
        path = Path(folder) / f"{name.replace(' ', '-').replace('%', 'percent')}-{side}.f64"
        (separation - separation.min()).astype("<f8").tofile(path)
        found.append({"name": name, "separation": str(path), "side": side, "boundary": boundary, "force": force})
    return found


def solve(problem, way, tolerance):
    import aspher

    side = problem["side"]
    gap = np.fromfile(problem["separation"]).reshape(side, side)
    line = np.linspace(-1, 1, 64) ** 2
    aspher.solve_nested(64, np.add.outer(line, line), 1e-3, backend=way["backend"], tol=1e-3)  # loads what is loaded late
    baseline = status("VmRSS")
    start, processor = time.perf_counter(), time.process_time()
    # The side is 1, so that the force is the mean pressure.
    result = aspher.solve_nested(side, gap, problem["force"], tol=tolerance, light_result=True, **way)
    return {
        "total_s": time.perf_counter() - start,
        "processor_s": time.process_time() - processor,
        "memory_bytes": status("VmHWM") - baseline,
        "indentation": result.approach,
        "products": result.matvec_count,
        "loaded": round(result.contact_area * side**2),
        "ended": result.status,
    }


if __name__ == "__main__":
    order = json.loads(sys.argv[1])
    print(json.dumps({"problems": problems, "solve": solve}[order.pop("task")](**order)))
