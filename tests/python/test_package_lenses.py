"""Lenses of other shapes in the package."""

import json
import os
import pickle
import subprocess
from pathlib import Path

import fakir
import numpy as np
import pytest

EXAMPLES = Path(__file__).parents[2] / "examples"
RUBBER = ("2 MPa", 0.5)
CUT = fakir.SquarePattern("6 um", "2.2 um", pitch="20 um", columns=7)


def shape_of(lens):
    return type(lens).__name__.removesuffix("Lens").lower() or "sphere"


LENSES = [
    fakir.Lens("2.2 mm", *RUBBER),
    fakir.ParaboloidLens("2.2 mm", *RUBBER),
    fakir.CylinderLens("2.2 mm", *RUBBER, angle="30 deg"),
    fakir.PlateLens(*RUBBER, tilt="0.1 deg", tilt_direction="60 deg"),
    fakir.ProfileLens(EXAMPLES / "profile.csv", *RUBBER),
]


@pytest.mark.parametrize("lens", LENSES, ids=lambda lens: type(lens).__name__)
def test_a_lens_is_what_was_given(lens):
    system = fakir.System(lens, fakir.Substrate(*RUBBER), CUT)
    assert system.lens == lens
    assert pickle.loads(pickle.dumps(system)) == system
    state = system.press(force="20 uN")
    assert state.converged
    shape = state.to_dict()["lens_shape"]
    assert (shape == "sphere") == isinstance(lens, fakir.Lens)
    # Nothing of the lens is below the pillars that it touches.
    assert np.all(state.gap(np.linspace(-4e-5, 4e-5, 81), 0.0) > -1e-9)


def test_the_command_agrees():
    case = str(EXAMPLES / "cylinder.toml")
    run = [os.environ["FAKIR"], "press", case, "--indentation", "1um", "--json", "--quiet"]
    done = subprocess.run(run, capture_output=True, text=True)
    printed = json.loads(done.stdout)
    state = fakir.System.from_file(case).press(indentation="1 um")
    assert printed["lens_shape"] == "cylinder"
    assert printed["force_N"] == state.force


@pytest.mark.parametrize("lens", LENSES, ids=lambda lens: type(lens).__name__)
def test_a_height_map_takes_every_lens(lens):
    place = 3e-5 * np.linspace(-1, 1, 128)
    bump = -(place**2 + place[:, np.newaxis] ** 2) / 2e-4
    surface = fakir.bem.Surface(bump, lens, fakir.Substrate(*RUBBER), width=6e-5)
    assert surface.indenter == lens
    contact = surface.press(force="1 uN")
    assert contact.to_dict()["lens_shape"] == shape_of(lens)
    # The curvatures of both bodies add up (Johnson, Contact Mechanics, section 4.1): close to Hertz on the bump.
    modulus, radius = 2e6 / (2 * (1 - 0.5**2)), 1e-4
    hertz = (0.75e-6 / modulus / np.sqrt(radius)) ** (2 / 3)
    assert contact.indentation == pytest.approx(hertz, rel=0.1)


def test_a_level_plate_on_a_height_map_is_a_plate():
    plate = fakir.PlateLens(*RUBBER)
    surface = fakir.bem.Surface(np.zeros((8, 8)), plate, fakir.Substrate(*RUBBER), cell_size=1e-6)
    assert surface.indenter == fakir.bem.Plate(*RUBBER)


def test_what_cannot_be_is_refused():
    infinite = fakir.HexagonalPattern("6 um", "2.2 um", pitch="20 um")
    with pytest.raises(fakir.CaseError, match="infinitely many pillars"):
        fakir.System(fakir.PlateLens(*RUBBER), fakir.Substrate(*RUBBER), infinite)
    system = fakir.System(LENSES[2], fakir.Substrate(*RUBBER), CUT)
    with pytest.raises(fakir.SolveError, match="has no transition"):
        system.transition()
    with pytest.raises(TypeError, match="give a lens or a Plate"):
        fakir.bem.Surface(np.zeros((4, 4)), "lens", fakir.Substrate(*RUBBER), cell_size=1e-6)
    # What is made for a sphere gives no number.
    paper = fakir.HexagonalPattern("6 um", "2.2 um", surface_fraction=0.1)
    other = fakir.System(LENSES[1], fakir.Substrate(*RUBBER), paper)
    with pytest.raises(ValueError, match="only spherical lenses are supported"):
        fakir.theory.phase(other, 1e-3, 1e-4)


@pytest.mark.parametrize("name", ["cylinder.toml", "plate"])
def test_a_loading_without_a_critical_state(name):
    """Expected: what `fakir approach --json` prints."""
    lens = fakir.PlateLens(*RUBBER)
    system = fakir.System(lens, fakir.Substrate(*RUBBER), CUT)
    if name != "plate":
        system = fakir.System.from_file(EXAMPLES / name)
    loading = system.approach("0.05 um", to="0.1 um")
    assert loading.critical is None and len(loading) == len(loading.to_pandas())
    assert "critical" not in repr(loading)
    if name != "plate":
        run = [os.environ["FAKIR"], "approach", str(EXAMPLES / name), "--step=0.05um", "--to=0.1um", "--json", "--quiet"]
        expected = json.loads(subprocess.run(run, capture_output=True, text=True, check=True).stdout)
        assert [state.force for state in loading] == [row["force_N"] for row in expected["states"]]
