"""Friction in the Python package: lateral forces of results, and the fit of shear stresses."""

from math import pi

import numpy as np
import pint
import pytest
from conftest import EXAMPLES

import fakir

TOPS, FLOOR = 0.4e6, 0.15e6
STRESSES = {"friction.shear_stress_tops": TOPS, "friction.shear_stress_floor": FLOOR}


def sparse(overrides=None):
    given = {"pattern.surface_fraction": 0.01} | (overrides or {})
    return fakir.System.from_file(EXAMPLES / "paper-intermediate.toml", given)


def test_a_flat_surface_slides_with_the_area_of_hertz():
    rubber = {"young_modulus": 2e6, "poisson_ratio": 0.5}
    system = fakir.FlatSystem(fakir.ParaboloidLens(2e-3, **rubber), fakir.Substrate(**rubber))
    assert system.press(force=1e-3).friction is None
    contact = system.replace({"friction.shear_stress_tops": TOPS}).press(force=1e-3)
    # a^3 = 3 F R/(4 E*), E* = 4/3 MPa
    area = pi * (0.75 * 1e-3 * 2e-3 / (4e6 / 3)) ** (2 / 3)
    assert contact.friction.lateral_force == pytest.approx(TOPS * area, rel=1e-9)
    assert contact.friction.floor_contact_area is None


def test_pillars_have_both_areas_and_the_sum_of_their_errors():
    critical = sparse(STRESSES).transition()
    assert critical.friction.floor_force == 0.0
    contact = sparse(STRESSES).press(force=2 * critical.force)
    friction = contact.friction
    assert friction.floor_contact_area == contact.floor.contact_area
    parts = TOPS * friction.tops_contact_area, FLOOR * friction.floor_contact_area
    assert friction.lateral_force == pytest.approx(sum(parts), rel=1e-14)
    error = parts[0] * friction.error.tops_contact_area + parts[1] * friction.error.floor_contact_area
    assert friction.error.lateral_force == pytest.approx(error / sum(parts), rel=1e-12)
    assert contact.to_dict()["friction"]["lateral_force_N"] == friction.lateral_force


def test_columns_are_what_their_units_say():
    units = pint.UnitRegistry()
    rubber = {"young_modulus": 2e6, "poisson_ratio": 0.5}
    system = fakir.FlatSystem(fakir.Lens(2e-3, **rubber), fakir.Substrate(**rubber))
    plain = {"force_N": [1e-3, 2e-3, 4e-3], "lateral_force_N": [1e-3, 1.6e-3, 2.5e-3]}
    given = {"load": [1.0, 2.0, 4.0] * units.mN, "friction": [1.0, 1.6, 2.5] * units.mN}
    fits = [fakir.fit_friction(data, system).tops.value for data in (plain, given)]
    assert fits[0] == pytest.approx(fits[1], rel=1e-12)
    in_um = {"indentation_um": [1.0, 2.0, 3.0] * units.um, "load": [0.1, 0.3, 0.5] * units.mN}
    assert fakir.fit(in_um, system, ["substrate.young_modulus"]).to_dict()["rows"] == 3
    with pytest.raises(ValueError, match="load is in volt: give a quantity in m, N or s"):
        fakir.fit({**in_um, "load": [1.0, 2.0, 3.0] * units.V}, system, ["substrate.young_modulus"])


def test_a_fit_of_arrays_finds_both_stresses():
    forces = np.array([1e-5, 3e-5, 6e-5, 9e-5, 1.5e-4, 2.5e-4, 4e-4])
    system = sparse(STRESSES)
    lateral = [system.press(force=force).friction.lateral_force for force in forces]
    sign = np.array([1, -1, -1, 1, 1, -1, 1])
    fit = fakir.fit_friction({"force_N": forces, "lateral_force_N": lateral + 5e-7 * sign}, sparse())
    for stress, expected in ((fit.tops, TOPS), (fit.floor, FLOOR)):
        low, high = stress.interval
        assert low < expected < high and stress.value == pytest.approx(expected, rel=0.05)
    assert fit.determined and fit.correlation < 0 and fit.covariance.shape == (2, 2)
    assert fit.system.press(force=1e-4).friction.lateral_force > 0
    assert len(fit.to_pandas()) == len(forces) and fit.curve.shape[1] == 4
    assert "standard error" in str(fit)


def test_a_floor_that_is_not_reached_is_not_determined():
    data = {"force_uN": np.array([5.0, 10.0, 20.0]), "Friction force [uN]": np.array([30.0, 50.0, 80.0])}
    with pytest.warns(fakir.FakirWarning, match="no row is past the transition"):
        fit = fakir.fit_friction(data, sparse(), lateral_error="1 uN")
    assert not fit.determined and fit.floor.value is None and fit.tops.determined


def test_data_without_lateral_forces_are_refused():
    with pytest.raises(fakir.FitError, match="lateral_force_N"):
        fakir.fit_friction({"force_N": np.ones(3), "contact_radius_m": np.ones(3)}, sparse())


def test_answers_without_lateral_force_warn_as_the_command_does():
    words = 'friction.shear_stress_tops has no effect: the answer of "{}" does not contain the lateral force'
    lone = sparse({"friction.shear_stress_tops": TOPS, "pattern.surface_fraction": 0.002})
    with pytest.warns(fakir.FakirWarning, match=words.format("compare")) as caught:
        lone.compare()
    # At the line of the caller.
    assert caught[0].filename == __file__
    rubber = {"young_modulus": 2e6, "poisson_ratio": 0.5}
    flat = fakir.FlatSystem(fakir.ParaboloidLens(2e-3, **rubber), fakir.Substrate(**rubber))
    flat = flat.replace({"friction.shear_stress_tops": TOPS})
    data = {"indentation_m": [1e-6, 2e-6, 3e-6], "force_N": [0.8e-4, 2.2e-4, 4.1e-4]}
    with pytest.warns(fakir.FakirWarning, match=words.format("fit")) as caught:
        fakir.fit(data, flat, ["substrate.young_modulus"])
    assert all(warning.filename == __file__ for warning in caught)


def test_the_force_is_used_where_the_load_is_given_twice():
    """Exact data of 300 kPa on a flat surface, with indentations that are five times too large."""
    rubber = {"young_modulus": 2e6, "poisson_ratio": 0.5}
    flat = fakir.FlatSystem(fakir.ParaboloidLens(2e-3, **rubber), fakir.Substrate(**rubber))
    forces = [1e-5, 3e-5, 6e-5]
    contacts = [flat.press(force=force) for force in forces]
    data = {
        "force_N": forces,
        "indentation_m": [5 * contact.indentation for contact in contacts],
        "lateral_force_N": [300e3 * contact.contact_area for contact in contacts],
    }
    fitted = fakir.fit_friction(data, flat)
    assert fitted.tops.value == pytest.approx(300e3, rel=1e-6)
    assert list(fitted.to_pandas()["force_N"]) == pytest.approx(forces, rel=1e-12)
