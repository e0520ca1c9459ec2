"""Writes rectangle.csv: the potential of rectangles with 60 digits, rounded to double.

Love's closed form (Johnson, Contact Mechanics, eq. 3.25) evaluated by mpmath at the exact values
of the doubles; a sample is checked against adaptive quadrature of the inner integral.

    pip install mpmath
    python rectangle.py > rectangle.csv
"""

import math
import random
import sys

from mpmath import asinh, mp, mpf, quad, sqrt

mp.dps = 60


def corner(x, y):
    """x asinh(y/|x|) + y asinh(x/|y|)"""
    value = mpf(0)
    if x != 0:
        value += x * asinh(y / abs(x))
    if y != 0:
        value += y * asinh(x / abs(y))
    return value


def potential(width, height, x, y):
    a, b, x, y = mpf(width) / 2, mpf(height) / 2, mpf(x), mpf(y)
    return corner(x + a, y + b) - corner(x - a, y + b) - corner(x + a, y - b) + corner(x - a, y - b)


def by_quadrature(width, height, x, y):
    """At points well to the right of the rectangle, where the inner integral is smooth."""
    a, b, x, y = mpf(width) / 2, mpf(height) / 2, mpf(x), mpf(y)
    return quad(lambda s: asinh((y + b) / s) - asinh((y - b) / s), [x - a, x + a])


def points(width, height, rng):
    a, b = 0.5 * width, 0.5 * height
    half_diagonal = math.hypot(a, b)
    yield from [(0.0, 0.0), (a, 0.0), (0.0, b), (a, b), (0.5 * a, b), (a, 0.5 * b)]
    for tiny in [1e-300, 1e-30, 1e-16, 1e-12, 1e-8, 1e-4, 1e-2]:
        yield from [(tiny, tiny), (a, b + tiny), (a + tiny, b + tiny), (a - tiny, b - tiny), (a - tiny, b)]
        for far in [1.5, 3.0, 7.0, 100.0]:  # next to the line of an edge
            yield from [(far * a, b + tiny), (far * a, b - tiny), (a + tiny, far * b), (a - tiny, far * b)]
    for far in [1.5, 3.0, 7.0, 100.0]:
        yield from [(far * a, b), (a, far * b), (far * a, 0.0), (0.0, far * b), (far * a, far * b)]
    for ratio in [4.3, 4.47, 4.4721, 4.4722, 4.5, 5.0, 6.0, 9.0, 20.0, 60.0, 1e3, 1e7, 1e8, 1e9, 1e150, 1e290]:
        for _ in range(3):
            angle = rng.uniform(0.0, 0.5 * math.pi)
            yield ratio * half_diagonal * math.cos(angle), ratio * half_diagonal * math.sin(angle)
    for _ in range(40):
        angle, ratio = rng.uniform(0.0, 2.0 * math.pi), 10.0 ** rng.uniform(-2.0, 1.5)
        yield ratio * half_diagonal * math.cos(angle), ratio * half_diagonal * math.sin(angle)


def main():
    rng = random.Random(1929)
    print("width,height,x,y,potential")
    for width, height in [(1.0, 1.0), (0.3e-6, 0.3e-6), (2.0, 1.0), (1.0, 3.0), (4.0, 1.0), (0.7, 2.8)]:
        for index, (x, y) in enumerate(points(width, height, rng)):
            if max(abs(x), abs(y)) > 1e40 * width:  # the closed form cancels more digits than there are
                value = mpf(width) * mpf(height) / sqrt(mpf(x) ** 2 + mpf(y) ** 2)
            else:
                with mp.workdps(200):
                    value = potential(width, height, x, y)
            if index % 20 == 0 and width < x < 1e3 * width:
                assert abs(by_quadrature(width, height, x, y) / value - 1) < 1e-25
            print(f"{width!r},{height!r},{x!r},{y!r},{float(value)!r}")


sys.exit(main())
