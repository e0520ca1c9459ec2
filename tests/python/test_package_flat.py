"""Flat surfaces: fakir.FlatSystem and fakir.problem with fakir.Flat."""

import math
import os
import pickle
import subprocess

import numpy as np
import pytest
from conftest import EXAMPLES

import fakir

RADIUS, WORK = 2.2e-3, 50e-3
RUBBER = fakir.Substrate("2 MPa", 0.5)


def lens(kind=fakir.Lens):
    return kind(RADIUS, "70 GPa", 0.22)


def test_systems_are_sent_to_other_processes():
    system = fakir.FlatSystem(lens(), RUBBER, adhesion=WORK)
    copy = pickle.loads(pickle.dumps(system))
    assert copy == system and hash(copy) == hash(system)
    assert copy != system.replace({"lens.radius": "1 mm"})


def test_a_paraboloid_is_hertz():
    system = fakir.problem(lens(fakir.ParaboloidLens), RUBBER, fakir.Flat())
    contact = system.press(indentation="1 um")
    radius = math.sqrt(RADIUS * 1e-6)
    force = 4 / 3 * system.reduced_modulus * radius**3 / RADIUS
    assert contact.force == pytest.approx(force, rel=1e-10)
    assert contact.contact_radius == pytest.approx(radius, rel=1e-10)
    assert contact.converged and contact.error.force < 1e-9
    # p = p0 sqrt(1 - r^2/a^2)
    ratio = contact.pressure([[0.6 * radius, 2 * radius]]) / contact.pressure_on_axis
    assert ratio == pytest.approx(np.array([[0.8, 0.0]]), abs=1e-7)


def test_fields_beside_the_contact_are_those_of_hertz():
    """K. L. Johnson, Contact Mechanics, eq. 3.42a, as a map of both coordinates."""
    system = fakir.problem(lens(fakir.ParaboloidLens), RUBBER, fakir.Flat())
    contact = system.press(indentation="1 um")
    a = contact.contact_radius
    axis = np.linspace(-3 * a, 3 * a, 61)
    r = np.hypot(*np.meshgrid(axis, axis))
    outside = r > a
    r_out = r[outside]
    hertz = (2 * a**2 - r_out**2) * np.arcsin(a / r_out) + a * np.sqrt(r_out**2 - a**2)
    displacement, gap = contact.displacement(r), contact.gap(r)
    assert displacement[outside] == pytest.approx(hertz / (math.pi * RADIUS), rel=1e-4)
    assert displacement[~outside] == pytest.approx(1e-6 - r[~outside] ** 2 / (2 * RADIUS), rel=1e-9)
    assert (gap == 0).sum() == (~outside).sum() and (gap[outside] > 0).all()
    force = contact.pressure(r).sum() * (axis[1] - axis[0]) ** 2
    assert force == pytest.approx(contact.force, rel=0.01)
    punch = fakir.problem(fakir.FlatPunch("50 um", "70 GPa", 0.22), RUBBER, fakir.Flat())
    assert punch.press(force="1 mN").gap([40e-6, 60e-6]).tolist() == [0, math.inf]


def test_a_lens_is_designed():
    """Hertz's force and the pull-off of Johnson, Kendall and Roberts."""
    system = fakir.problem(lens(fakir.ParaboloidLens), RUBBER, fakir.Flat())
    found = fakir.design(system, "lens.radius", force="1 mN", at_indentation="1 um")
    radius = (3e-3 / (4 * system.reduced_modulus * 1e-6**1.5)) ** 2
    assert found.value == pytest.approx(radius, rel=1e-6)
    assert found.sensitivity == pytest.approx(0.5, rel=1e-3)
    assert found.state.force == pytest.approx(1e-3) and found.system.lens.radius == found.value
    with pytest.raises(fakir.DesignError, match="no critical state"):
        found.critical
    wide = fakir.design(system, "lens.radius", contact_radius="80 um", at_force="1 mN")
    assert wide.value == pytest.approx(4 * system.reduced_modulus * 80e-6**3 / 3e-3, rel=1e-6)
    adhesive = system.replace({"adhesion.work": WORK})
    pulled = fakir.design(adhesive, "adhesion.work", pull_off="0.5 mN", at_indentation="2 um")
    assert pulled.value == pytest.approx(0.5e-3 / (1.5 * math.pi * RADIUS), rel=1e-6)
    assert pulled.cycle.pull_off_force == pytest.approx(-0.5e-3)
    assert "J/m²" in str(pulled)
    with pytest.raises(fakir.FakirError, match="flat surface"):
        fakir.design(system, "lens.radius", critical_force="1 mN")


def test_a_cycle_is_that_of_johnson_kendall_and_roberts():
    system = fakir.FlatSystem(lens(fakir.ParaboloidLens), RUBBER, adhesion=WORK)
    cycle = system.cycle(to="10 um")
    assert cycle.pull_off_force == pytest.approx(-1.5 * math.pi * WORK * RADIUS, rel=1e-10)
    assert cycle.force.min() == pytest.approx(cycle.pull_off_force, rel=1e-3)
    assert cycle.to_pandas().shape == (len(cycle.force), 4)
    assert set(cycle.branch) == {"loading", "unloading"}
    with pytest.raises(TypeError, match="where the loading ends"):
        system.cycle()


def test_a_punch_on_a_film():
    film = fakir.Substrate("2 MPa", 0.5, thickness="40 um")
    punch = fakir.FlatPunch("50 um", "70 GPa", 0.22)
    on_film, on_half_space = (
        fakir.problem(punch, body, fakir.Flat()).press(indentation="1 um").force for body in (film, RUBBER)
    )
    assert on_film > 2 * on_half_space


def test_a_punch_on_pillars_is_a_plate_on_those_that_it_covers():
    punch = fakir.FlatPunch("25 um", "2 MPa", 0.5)
    plate = fakir.PlateLens("2 MPa", 0.5)
    lattice = fakir.HexagonalPattern("6 um", "2 um", pitch="20 um")
    system = fakir.System(punch, RUBBER, lattice)
    assert system.lens == punch
    contact = system.press(indentation="0.5 um")
    assert len(contact.pillars) == 7 and not contact.warnings
    pillars = fakir.Pillars(contact.pillars["x_m"], contact.pillars["y_m"], 2e-6, 6e-6)
    same = fakir.System(plate, RUBBER, pillars).press(indentation="0.5 um")
    assert contact.force == pytest.approx(same.force, rel=1e-9)
    with pytest.raises(fakir.CaseError, match="crosses none, as 2.3"):
        fakir.System(fakir.FlatPunch("20 um", "2 MPa", 0.5), RUBBER, lattice)
    assert fakir.System.from_toml(system.to_toml()).press(indentation="0.5 um").force == contact.force


def test_a_map_under_a_punch_without_its_floor():
    at = (np.arange(128) + 0.5) * 0.25e-6 - 16e-6
    step = np.where(np.hypot(*np.meshgrid(at, at)) < 5e-6, 1e-6, 0.0)
    punch = fakir.FlatPunch("12 um", "2 MPa", 0.5)
    with pytest.raises(ValueError, match="give floor, a height"):
        fakir.bem.Surface(step, punch, RUBBER, cell_size="0.25 um", floor_contact=False)
    surfaces = [
        fakir.bem.Surface(step, punch, RUBBER, cell_size="0.25 um", floor="0.5 um", floor_contact=contact)
        for contact in (True, False)
    ]
    assert surfaces[0].indenter == punch
    whole, without = (surface.press(indentation="1.5 um") for surface in surfaces)
    # One top as a flat punch, 2 E* a d (Sneddon 1965), with E* of two bodies of 2 MPa.
    sneddon = 2 * (4 / 3 * 1e6) * 5e-6 * 1.5e-6
    assert without.force == pytest.approx(sneddon, rel=without.error.force)
    assert any("as if the floor were not there" in warning for warning in without.warnings)
    assert whole.force > 1.05 * without.force and not whole.warnings


def test_files_and_other_values(tmp_path):
    system = fakir.FlatSystem(lens(), RUBBER, adhesion=fakir.Adhesion("50 mJ/m2", "80 mJ/m2"))
    path = tmp_path / "flat.toml"
    path.write_text(system.to_toml())
    again = fakir.read_case(path)
    assert isinstance(again, fakir.FlatSystem)
    assert again.lens == lens() and again.substrate == RUBBER
    assert again.adhesion == system.adhesion
    assert again.press(force="1 mN").to_dict().keys() == system.press(force="1 mN").to_dict().keys()
    smaller = again.replace({"lens.radius": "1 mm"})
    assert smaller.lens.radius == 1e-3
    loading = smaller.approach("0.5 um", to="2 um")
    assert len(loading) == 5 and loading.to_pandas()["force_N"].is_monotonic_increasing
    assert "0.05" in repr(system) or "50 mJ" in repr(system)


def test_a_cycle_is_driven_as_one_on_pillars():
    system = fakir.FlatSystem(lens(), RUBBER, adhesion=WORK)
    with pytest.raises(ValueError, match="no drive"):
        system.cycle(to="1 um", drive="wobble")
    with pytest.raises(TypeError, match="go together"):
        system.cycle(to="1 um", drive="machine")
    with pytest.raises(TypeError, match="one end"):
        system.cycle(to="1 um", to_force="1 mN")
    by_force = system.cycle(to="1 um", drive="force")
    assert by_force.hysteresis is None and by_force.pull_off_force < 0


def test_modulus_and_work_of_adhesion_from_a_reference_measurement():
    """The true values are those of crates/fakir-inverse/examples/synthetic_retraction.rs."""
    glass = fakir.Lens("2 mm", "70 GPa", 0.22)
    system = fakir.problem(
        glass, fakir.Substrate("1 MPa", 0.5), fakir.Flat(), adhesion=fakir.Adhesion("20 mJ/m2", "40 mJ/m2")
    )
    free = ["substrate.young_modulus", "adhesion.work", "adhesion.work_receding", "contact_point"]
    path = EXAMPLES / "fit" / "reference.txt"
    fit = fakir.fit(path, system, free, machine_compliance=1.5e-3)
    for name, true in zip(free, [1.7e6, 30e-3, 55e-3, 800e-9], strict=True):
        estimate = fit[name]
        assert abs(estimate.value - true) < 3 * estimate.standard_error
    assert isinstance(fit.system, fakir.FlatSystem)
    assert fit.system.substrate.young_modulus == fit["substrate.young_modulus"].value
    assert fit.describes_data
    with pytest.raises(fakir.FitError, match="flat surface"):
        fakir.fit(path, system, ["pattern.pitch"])


def test_derivatives_and_a_second_method():
    """Hertz: F is proportional to the square root of the radius at a given indentation."""
    system = fakir.problem(lens(fakir.ParaboloidLens), RUBBER, fakir.Flat())
    found = system.gradient(indentation="1 um")
    assert found.force is not None and found.indentation is None
    assert found.force["lens.radius"] == pytest.approx(found.state.force / (2 * system.lens.radius), rel=1e-9)
    assert found.stiffness == pytest.approx(found.state.stiffness, rel=1e-12)
    assert found.contact_area is not None and len(found.pillars) == 0
    with pytest.raises(fakir.SolveError, match="not touched"):
        system.gradient(force=0.0)
    verified = system.verify(force="1 mN", cells_per_diameter=48)
    coarse, fine = verified.elements
    assert verified.agrees and (coarse.cells_per_diameter, fine.cells_per_diameter) == (24, 48)
    assert fine.indentation == pytest.approx(verified.disc.indentation, rel=2e-3)
    assert fine.contact_radius == pytest.approx(verified.disc.contact_radius, rel=0.05)
    assert "the answers agree" in str(verified)
    adhesive = fakir.FlatSystem(lens(), RUBBER, adhesion=WORK).verify(force="1 mN", cells_per_diameter=48)
    assert adhesive.agrees and abs(adhesive.contact_area.relative) < adhesive.contact_area.allowed < 0.2
    assert adhesive.elements[1].contact_area > verified.elements[1].contact_area


def test_what_to_cite_for_a_flat_surface():
    """Expected: what `fakir cite` prints for the example."""
    case = EXAMPLES / "flat.toml"
    printed = subprocess.run([os.environ["FAKIR"], "cite", str(case), "--bibtex"], capture_output=True, text=True, check=True).stdout
    system = fakir.FlatSystem.from_file(case)
    entries = fakir.cite(system)
    assert len(entries) == sum(line.startswith("@") for line in printed.splitlines()) > 2
    assert entries == fakir.cite(system.press(indentation="1 um"))
    with pytest.raises(TypeError, match="does not contain its system"):
        fakir.cite(system.gradient(indentation="1 um"))
