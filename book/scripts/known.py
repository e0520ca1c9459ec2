"""fakir against what is known in closed form: a table in Markdown, and what fails if one is off."""

import math

import numpy as np

import fakir

MODULUS, RATIO = 2e6, 0.5
REDUCED = MODULUS / (1 - RATIO**2) / 2
DIAMETER, HEIGHT = 6e-6, 2.2e-6


def lone_pillar(lens_radius, compliance="none"):
    """One pillar far from all others, under the axis of a lens."""
    return fakir.System(
        fakir.Lens(lens_radius, MODULUS, RATIO),
        fakir.Substrate(MODULUS, RATIO),
        fakir.HexagonalPattern(
            diameter=DIAMETER, height=HEIGHT, surface_fraction=1e-6, compliance=compliance
        ),
    )


rows = []


def compare(what, source, found, known, allowed):
    error = abs(found / known - 1)
    assert error < allowed, (what, found, known, error)
    rows.append(f"| {what} | {source} | {known:.6g} | {found:.6g} | {error:.0e} |")


depth = 1e-6
shape = DIAMETER**2 / 12  # A paraboloid of radius R lifts a flat punch by the mean a^2/3R.
for compliance, column in [("none", 0.0), ("column", 4 * HEIGHT / (math.pi * MODULUS * DIAMETER))]:
    force = lone_pillar(1.0, compliance).press(indentation=depth).force
    known = DIAMETER * (depth - shape) / (1 / REDUCED + column)
    name = "flat punch" if compliance == "none" else "flat punch on a column"
    compare(f"{name}: force, N", "Johnson, eq. 3.36; Hooke", force, known, 1e-6)

state = lone_pillar(1.0).press(indentation=depth)
for distance in [3.5e-6, 6e-6, 30e-6]:
    known = 2 / math.pi * depth * math.asin(DIAMETER / 2 / distance)
    found = float(state.displacement(distance, 0.0))
    name = f"displacement {distance * 1e6:g} um from its centre, m"
    compare(name, "Johnson, eq. 3.37", found, known, 1e-5)

radius = 1e-4
for depth in [1e-9, 1e-8, 2e-8]:
    force = lone_pillar(radius).press(indentation=depth).force
    known = 4 / 3 * REDUCED * math.sqrt(radius) * depth**1.5
    name = f"Hertz inside one pillar top, {depth * 1e9:g} nm deep: force, N"
    compare(name, "Hertz (1882)", force, known, 1e-3)

# Elements on a flat surface: Hertz again, by another method.
flat = fakir.bem.Surface(
    np.zeros((256, 256)),
    fakir.Lens("2.2 mm", MODULUS, RATIO),
    fakir.Substrate(MODULUS, RATIO),
    cell_size="0.5 um",
)
contact = flat.press(indentation="1 um")
known = 4 / 3 * REDUCED * math.sqrt(2.2e-3) * 1e-6**1.5
compare("Hertz, boundary elements: force, N", "Hertz (1882)", contact.force, known, 2e-3)

# Lattice sums: sum of 1/r^3 over a hexagonal lattice is 6 zeta(3/2) L(3/2), L of the character mod 3.
numbers = np.arange(1, 2_000_001)


def tail(power, start):
    """The rest of a sum of powers, to the third term of Euler and Maclaurin."""
    return start ** (1 - power) / (power - 1) + start**-power / 2 + power * start ** (-power - 1) / 12


end = float(numbers[-1] + 1)
zeta = np.sum(numbers**-1.5) + tail(1.5, end)
character = np.sum((3.0 * numbers - 2) ** -1.5 - (3.0 * numbers - 1) ** -1.5)
character += ((3 * end - 2.5) ** -1.5) / 3
compare(
    "sum of 1/r^3 over the lattice",
    "Borwein et al. (2013)",
    fakir.theory.inverse_power_sum(3.0),
    6 * zeta * character,
    1e-9,
)

# All lengths ten times as large: indentations too, forces a hundredfold.
small = fakir.System.from_file("examples/paper-intermediate.toml")
large = small.replace(
    {"lens.radius": "22 mm", "pattern.pillar.diameter": "60 um", "pattern.pillar.height": "22 um"}
)
first, second = small.transition(), large.transition()
compare("all lengths tenfold: force over first", "dimensions", second.force / first.force, 100, 1e-9)
found = second.indentation / first.indentation
compare("all lengths tenfold: indentation over first", "dimensions", found, 10, 1e-9)

print("| what | source | known | fakir | relative difference |\n|---|---|---|---|---|")
print("\n".join(rows).replace("e-", "e\u2011"))  # A hyphen at which no line breaks.
