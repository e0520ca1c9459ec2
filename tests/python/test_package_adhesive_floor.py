"""Closed forms for an adhesive floor, compared with the output of the command and with each other."""

import math

import fakir
import numpy as np
import pytest
from conftest import EXAMPLES
from fakir import theory
from test_package_results import program

CASE = "adhesive.toml"


@pytest.fixture(scope="module")
def system():
    return fakir.System.from_file(EXAMPLES / CASE)


def test_functions_agree_with_the_command(system):
    found = program("theory", CASE, {})["adhesion"]
    floor = found["stuck_floor"]
    assert theory.annulus_radius(system) == floor["annulus_radius_m"]
    threshold = theory.collapse_threshold(system)
    assert threshold == (floor["collapse_work_J_per_m2"], floor["collapse_annulus_radius_m"])
    assert theory.net_work(system) == floor["net_work_J_per_m2"]
    assert theory.largest_tension(system).tension == floor["largest_tension_Pa"]
    pull_off = {row["formula"]: row["force_N"] for row in found["pull_off"]}
    assert theory.stuck_floor_pull_off(system) == pytest.approx(pull_off["stuck_floor"], rel=1e-12)
    patch = theory.patch(system, system.lens.radius)
    assert patch.radius == floor["patch_radius_m"] and patch.force == floor["patch_force_N"]


def test_annuli_are_arrays_of_coefficients_in_units_of_the_pillar(system):
    """The table of the page of theory, and the pillar with its column in units."""
    found = theory.annulus_coefficients([4 / 3, 2.0, 4.0])
    assert found.force_per_step == pytest.approx([3.1150, 2.5493, 2.2291], abs=1e-4)
    assert found.volume_per_step == pytest.approx([4.1130, 5.9170, 11.113], abs=1e-3)
    assert found.intensity_per_pressure == pytest.approx([0.7029, 1.1853, 2.0020], abs=1e-4)
    annulus = theory.free_annulus(system, "6 um", "-20 kPa")
    modulus = theory.constants(system).reduced_modulus
    two = theory.annulus_coefficients(2.0)
    force = modulus * two.force_per_step * 3e-6 * annulus.step - two.volume_per_step * 9e-12 * 20e3
    assert annulus.pillar_force == pytest.approx(force, rel=1e-12)
    assert annulus.energy_release_rate == pytest.approx(annulus.stress_intensity**2 / (2 * modulus))


def test_edges_are_in_equilibrium_close_or_run(system):
    radius = theory.annulus_radius(system, "10 kPa")
    annulus = theory.free_annulus(system, radius, "10 kPa")
    assert annulus.energy_release_rate == pytest.approx(system.adhesion.work, rel=1e-9)
    tension, there = theory.largest_tension(system)
    assert theory.annulus_radius(system, -0.999 * tension) < there
    assert math.isinf(theory.annulus_radius(system, -1.001 * tension))
    assert theory.annulus_radius(system, "1 GPa") == pytest.approx(3e-6)
    assert theory.annulus_radius(system, work="10 mJ/m2") > theory.annulus_radius(system)


def test_little_work_bonds_no_floor(system):
    assert theory.stuck_floor_pull_off(system, "10 mJ/m2") is None
    assert theory.net_work(system, "0.001 mJ/m2") is None
    # A sphere with the curvature of the lens detaches 2.3 um above first touch: 3/4 (pi^2 w^2 R/E*^2)^(1/3).
    assert theory.patch(system, "2.2 mm", "-2.2 um") is not None
    assert theory.patch(system, "2.2 mm", "-2.4 um") is None


def test_a_collapsed_floor_bonds_to_the_lens(system):
    """The tension on cells of the floor is 0.388 mN; the model is accurate to 10 %."""
    first = 4.0765e-6
    steps = np.arange(1.5, -0.5, -0.05) * first
    cycle = theory.collapsed_cycle(system, [first, 1.5 * first], steps)
    assert cycle.force.min() == pytest.approx(-0.388e-3, rel=0.1)
    assert cycle.unloading.sum() + 2 == len(cycle.force)
    assert cycle.floor_lost is not None and cycle.floor_lost < 0.2e-6
    assert cycle.in_range[:2].all()
    with pytest.raises(ValueError, match="empty"):
        theory.collapsed_cycle(system, [])
    with pytest.raises(ValueError, match="work of adhesion"):
        theory.collapsed_cycle(system.replace({"adhesion.work": 0}), [first])


def test_grooves():
    """Ridges of half the period: 0.31722 E* h^2 over half a groove."""
    grooves = theory.Grooves("1 MPa", "20 um", "10 um", "1 um")
    found = grooves.threshold()
    assert found.work == pytest.approx(0.31722 * 1e6 * 1e-12 / 5e-6, rel=2e-5)
    assert grooves.energy(found.strip_width) == pytest.approx(found.work * found.strip_width)
    assert np.isfinite(grooves.energy("1 nm"))


def test_what_cannot_be_is_refused(system):
    with pytest.raises(ValueError, match="radius of a free annulus"):
        theory.free_annulus(system, "2 um")
    with pytest.raises(ValueError, match="radius of a free annulus"):
        theory.annulus_coefficients(1.0)
    with pytest.raises(ValueError, match="no adhesion"):
        theory.annulus_radius(system.replace({"adhesion.work": 0}))
    with pytest.raises(ValueError, match="work of adhesion"):
        theory.net_work(system, -1.0)
    with pytest.raises(ValueError, match="width of a strip"):
        theory.Grooves("1 MPa", "20 um", "20 um", "1 um")
    with pytest.raises(ValueError, match="infinite hexagonal lattice"):
        theory.collapse_threshold(system.replace({"pattern.lattice": "square"}))
