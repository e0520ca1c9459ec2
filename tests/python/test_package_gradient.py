"""Exact derivatives of contacts."""

import json
import os
import subprocess
from pathlib import Path

import fakir
import numpy as np
import pytest

CASE = Path(__file__).parents[2] / "examples" / "paper-intermediate.toml"
SPARSE = {"pattern.surface_fraction": 0.01}


def test_gradients_are_those_of_the_program():
    found = fakir.System.from_file(CASE, overrides=SPARSE).gradient()
    run = [os.environ["FAKIR"], "transition", str(CASE), "--gradient", "--json", "--quiet"]
    done = subprocess.run(
        [*run, "--set", "pattern.surface_fraction=0.01"], capture_output=True, text=True
    )
    printed, given = json.loads(done.stdout), found.to_dict()
    assert printed["gradient"] == given["gradient"]
    assert (printed["critical_force_N"], printed["method"]) == (given["force_N"], given["method"])


def test_gradients_are_differences():
    system = fakir.System.from_file(CASE, overrides=SPARSE)
    found = system.gradient(indentation="1 um")
    assert found.indentation is None
    assert found.force is not None
    half = 1e-4 * system.pattern.height

    def force(height):
        changed = system.replace({"pattern.pillar.height": height})
        return changed.press(indentation="1 um").force

    height = system.pattern.height
    expected = (force(height + half) - force(height - half)) / (2 * half)
    assert found.force["pattern.pillar.height"] == pytest.approx(expected, rel=1e-4)
    # All pillars higher, and the lens as much higher: longer columns alone.
    alone = np.sum(found.pillars["force_N_per_m"]) - found.stiffness
    assert found.force["pattern.pillar.height"] == pytest.approx(alone, rel=1e-6)


def test_past_the_transition_as_well():
    """The length of columns and the depth of the floor are exact: compared with differences, in which cells at the edge of the contact change."""
    system = fakir.System.from_file(CASE, overrides=SPARSE)
    found = system.gradient(indentation="4 um")
    assert found.force is not None and found.state.floor is not None
    # The force is proportional to the square of all lengths.
    lengths = ("lens.radius", "pattern.pillar.height", "pattern.pillar.diameter", "pattern.pitch")
    values = (system.lens.radius, system.pattern.height, system.pattern.diameter, system.pitch)
    changes = [found.force[key] * value for key, value in zip(lengths, values, strict=True)]
    total = sum(changes) + found.stiffness * found.state.indentation
    assert total == pytest.approx(2 * found.state.force, rel=1e-6)
    by_height = changes[1]

    def force(factor):
        height = system.pattern.height * factor
        return system.replace({"pattern.pillar.height": height}).press(indentation="4 um").force

    assert by_height == pytest.approx((force(1.01) - force(0.99)) / 0.02, rel=0.01)


def test_unavailable_gradients_are_refused():
    with pytest.raises(fakir.SolveError, match="no pillar is touched"):
        fakir.System.from_file(CASE, overrides=SPARSE).gradient(indentation=0)
