"""The contact problems that every program solves: writes files of separations to a folder and
prints their data as JSON.

The contact modulus is 1. Each problem lists the programs that take its load as it is; the others are
given the corresponding force. The scale of a load is that of its interpenetrations.
"""

import json
import sys
from pathlib import Path

import numpy as np

ALL = ["fakir", "ContactMechanics", "Tamaas"]


def problem(name, cell, boundary, separation):
    path = Path(sys.argv[1]) / (name.replace(" ", "-") + ".f64")
    separation.astype("<f8").tofile(path)
    rows, columns = separation.shape
    grid = {"columns": columns, "rows": rows, "cell": cell, "boundary": boundary}
    return {"name": name, "separation": str(path), **grid}


def centres(count, width):
    line = (np.arange(count) + 0.5) * (width / count) - width / 2
    return np.meshgrid(line, line)


def sphere(count):
    """A paraboloid of radius 1 pressed to a contact of radius 0.1, on a square of side 0.25."""
    x, y = centres(count, 0.25)
    # Hertz: F = 4/3 a^3 E*/R, and the indentation is a^2/R.
    load = {"force": 4 / 3 * 1e-3, "scale": 1e-2}
    return {**problem(f"sphere {count}", 0.25 / count, "free", (x * x + y * y) / 2), "load": load, "takes": ALL}


def pillars(count):
    """The paper's lens on its pillars at a surface fraction of 0.03, in micrometres, on one grid.

    At an indentation of 3.3 the floor, 2.2 below the tops of the pillars, is not reached.
    """
    radius, diameter, height, indentation = 2200.0, 6.0, 2.2, 3.3
    pitch = diameter * np.sqrt(np.pi / (2 * np.sqrt(3) * 0.03))
    x, y = centres(count, 256.0)
    on_pillar = np.zeros(x.shape, bool)
    # Two rectangular lattices make the hexagonal one.
    for shift in [0.0, 0.5]:
        u = (x / (np.sqrt(3) * pitch) - shift + 0.5) % 1.0 - 0.5
        v = (y / pitch - shift + 0.5) % 1.0 - 0.5
        on_pillar |= np.hypot(np.sqrt(3) * pitch * u, pitch * v) < diameter / 2
    separation = radius - np.sqrt(radius**2 - x * x - y * y) + np.where(on_pillar, 0.0, height)
    found = problem(f"pillars {count}", 256.0 / count, "free", separation)
    load = {"indentation": indentation, "scale": indentation}
    # Cells with a separation above the indentation cannot carry load.
    return {**found, "load": load, "reach": indentation, "takes": ["fakir", "ContactMechanics"]}


def rough(count):
    """A periodic surface with waves from a quarter of its period down to eight cells, random
    phases, Hurst exponent 0.8 and an rms slope of 1; about a tenth of it in contact."""
    waves = np.hypot(np.fft.fftfreq(count, 1 / count)[:, None], np.fft.rfftfreq(count, 1 / count))
    inside = (waves >= 4) & (waves <= count / 8)
    amplitude = np.where(inside, np.maximum(waves, 1) ** -1.8, 0.0)
    phases = np.random.default_rng(2021).uniform(0, 2 * np.pi, waves.shape)
    spectrum = amplitude * np.exp(1j * phases)
    heights = np.fft.irfft2(spectrum)
    # Slopes of the interpolant, from the heights' own transform.
    power = np.abs(np.fft.fft2(heights)) ** 2
    k = 2 * np.pi * np.fft.fftfreq(count, 1 / count)
    slope = np.sqrt((power * (k[:, None] ** 2 + k**2)).sum()) / count**2
    heights /= slope
    load = {"force": 0.05, "scale": float(np.ptp(heights))}
    return {**problem(f"rough {count}", 1 / count, "periodic", heights.max() - heights), "load": load, "takes": ALL}


if __name__ == "__main__":
    print(json.dumps([sphere(512), sphere(1024), pillars(512), rough(512), rough(1024)]))
