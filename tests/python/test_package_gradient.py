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
    assert json.loads(done.stdout)["gradient"] == found.to_dict()


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


def test_unavailable_gradients_are_refused():
    with pytest.raises(fakir.SolveError, match="no pillar is touched"):
        fakir.System.from_file(CASE, overrides=SPARSE).gradient(indentation=0)
