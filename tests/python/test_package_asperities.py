"""Rounded pillar tops, and heights that are designed for a curve."""

import json
import os
import pickle
import subprocess

import numpy as np
import pytest
from conftest import EXAMPLES

import fakir
from fakir.bem import Plate

RUBBER, GLASS = fakir.Substrate("1.5 MPa", 0.5), Plate("70 GPa", 0.22)
PITCH = 1.5e-3
X, Y = np.meshgrid(PITCH * np.arange(3.0), PITCH * np.arange(3.0))


def tops(**options):
    return fakir.AsperityArray(X, Y, 200e-6, "526 um", GLASS, RUBBER, **options)


def test_one_top_is_a_contact_of_hertz():
    """F = 4/3 E* sqrt(R) zeta^(3/2), A = pi R zeta."""
    one = fakir.AsperityArray(0.0, 0.0, "200 um", "526 um", GLASS, RUBBER)
    contact = one.press(indentation="2 um")
    modulus = 1 / (0.75 / 1.5e6 + (1 - 0.22**2) / 70e9)
    assert contact.force == pytest.approx(4 / 3 * modulus * np.sqrt(526e-6) * 2e-6**1.5, rel=1e-9)
    assert contact.contact_area == pytest.approx(np.pi * 526e-6 * 2e-6, rel=1e-9)
    assert contact.radius == pytest.approx([np.sqrt(526e-6 * 2e-6)], rel=1e-9)
    assert contact.contact_radius is None and contact.converged
    assert contact.to_dict()["left_out"] == ["floor", "adhesion"]


def test_a_case_file_and_arrays_are_the_same(tmp_path):
    made = tops(diameter="1 mm")
    (tmp_path / "case.toml").write_text(made.to_toml())
    made.to_csv(tmp_path / "pillars.csv")
    read = fakir.AsperityArray.from_file(tmp_path / "case.toml")
    one, other = made.press(force="10 mN"), read.press(force="10 mN")
    assert one.contact_area == pytest.approx(other.contact_area, rel=1e-12)
    assert len(other.to_pandas()) == 9
    sent = pickle.loads(pickle.dumps(made))
    assert np.array_equal(sent.height, made.height) and sent.press(force="10 mN").contact_area == one.contact_area
    made.to_stl(tmp_path / "surface.stl")
    assert (tmp_path / "surface.stl").stat().st_size > 1000
    assert "9 tops" in repr(read) and "9 of 9" in repr(one)


def test_heights_for_a_linear_interface():
    force = np.array([10e-3, 15e-3, 20e-3])
    found = fakir.design_heights(tops(), force=force, area=6e-6 * force, height_error="0.1 um")
    assert found.found, found.statement
    assert np.abs(found.residual).max() < 1e-5
    assert found.scatter is not None and (found.scatter > 0).all()
    again = found.tops.press(force=15e-3)
    assert again.contact_area == pytest.approx(6e-6 * 15e-3, rel=2e-5)
    assert found.to_dict()["design"]["status"] == "found"
    assert len(found.to_pandas()) == 3
    assert "HeightDesign" in repr(found)


def test_lenses_of_every_shape(tmp_path):
    """A tilted plate shifts the contact of one top by R tan(tilt) and leaves its pull-off, 3/2 pi w R (Johnson, Kendall, Roberts); the
    curvatures of a paraboloid and a top add."""
    glass = {"young_modulus": "70 GPa", "poisson_ratio": 0.22}

    def one(lens, **options):
        return fakir.AsperityArray(0.0, 0.0, "200 um", "526 um", lens, RUBBER, **options)

    tilted = fakir.PlateLens(**glass, tilt=0.01, tilt_direction=0.4)
    cycle = one(tilted, adhesion="50 mJ/m2").cycle(to="2 um")
    assert cycle.pull_off_force == pytest.approx(-1.5 * np.pi * 50e-3 * 526e-6, rel=1e-6)
    contact = one(fakir.ParaboloidLens("5 mm", **glass)).press(indentation="2 um")
    modulus = 1 / (0.75 / 1.5e6 + (1 - 0.22**2) / 70e9)
    radius = 1 / (1 / 526e-6 + 1 / 5e-3)
    assert contact.force == pytest.approx(4 / 3 * modulus * np.sqrt(radius) * 2e-6**1.5, rel=1e-9)
    assert contact.to_dict()["lens_shape"] == "paraboloid"
    level = tops().press(indentation="2 um").force
    assert one(Plate("70 GPa", 0.22)).press(indentation="2 um").to_dict()["lens_shape"] is None
    rows = np.linspace(0.0, 4e-3, 200)
    (tmp_path / "lens.csv").write_text("radius_m,height_m\n" + "".join(f"{r!r},{r * r / 1000.0!r}\n" for r in rows.tolist()))
    lenses = [
        fakir.CylinderLens("500 m", **glass, angle=0.3),
        fakir.ProfileLens(tmp_path / "lens.csv", **glass),
        fakir.PlateLens(**glass, tilt=1e-7),
    ]
    for lens in lenses:
        made = fakir.AsperityArray(X - PITCH, Y - PITCH, 200e-6, "526 um", lens, RUBBER)
        assert made.indenter == lens
        force = made.press(indentation="2 um").force
        # Within the array, the lenses are level to some nanometres.
        assert force == pytest.approx(level, rel=0.02)
        (tmp_path / "case.toml").write_text(made.to_toml())
        made.to_csv(tmp_path / "pillars.csv")
        read = fakir.AsperityArray.from_file(tmp_path / "case.toml")
        assert read.indenter == lens
        assert read.press(indentation="2 um").force == pytest.approx(force, rel=1e-12)
    with pytest.raises(ValueError, match="tilt"):
        one(fakir.PlateLens(**glass, tilt=0.5))


def test_what_cannot_be_is_refused():
    force = [10e-3, 20e-3]
    with pytest.raises(TypeError, match="give two of force, indentation and area"):
        fakir.design_heights(tops(), force=force)
    with pytest.raises(ValueError, match="does not increase"):
        fakir.design_heights(tops(), force=force, area=[6e-8, 5e-8])
    with pytest.raises(fakir.DesignError, match="if all carry the same"):
        fakir.design_heights(tops(), force=force, area=[6e-8, 6e-6])
    with pytest.raises(ValueError, match="give one for each other"):
        fakir.design_heights(tops(), force=force, area=[6e-8])
    with pytest.raises(TypeError, match="lens or a Plate"):
        fakir.AsperityArray(0.0, 0.0, 1e-4, 5e-4, RUBBER, RUBBER)
    with pytest.raises(ValueError, match="top radius"):
        fakir.AsperityArray(0.0, 0.0, 1e-4, -5e-4, GLASS, RUBBER)
    with pytest.raises(fakir.CaseError, match="flat pillar tops only"):
        fakir.System.from_toml(tops(diameter="1 mm").to_toml())


def test_a_second_method():
    """Boundary elements on every top find the contacts of the discs, under a plate Hertz's."""
    one = fakir.AsperityArray(0.0, 0.0, "200 um", "526 um", GLASS, RUBBER)
    found = one.verify(indentation="4 um", cells_per_diameter=32)
    coarse, fine = found.elements
    assert found.agrees and (coarse.cells_per_diameter, fine.cells_per_diameter) == (16, 32)
    modulus = 1.0 / (0.75 / 1.5e6 + (1.0 - 0.22**2) / 70e9)
    hertz = 4.0 / 3.0 * modulus * np.sqrt(526e-6) * 4e-6**1.5
    assert found.discs.force == pytest.approx(hertz, rel=1e-9)
    assert fine.force == pytest.approx(hertz, rel=1e-3)
    assert found.force.relative == pytest.approx(fine.force / hertz - 1.0, rel=1e-6)
    assert abs(found.contact_area.relative) < found.contact_area.allowed < 0.1
    assert fine.pillars_in_contact == 1 and fine.contact_radius is None
    assert "the answers agree" in str(found) and "difference in contact area" in str(found)
    many = tops().verify(force="20 mN", cells_per_diameter=16)
    assert many.agrees and many.elements[1].pillars_in_contact == many.discs.pillars_in_contact
    with pytest.raises(ValueError, match="give 16 to 1024"):
        one.verify(force="1 mN", cells_per_diameter=8)
    adhesive = fakir.AsperityArray(0.0, 0.0, "200 um", "526 um", GLASS, RUBBER, adhesion="50 mJ/m2")
    # Where the lens presses: in gentler contacts the force is a small difference, of which few cells leave no digit.
    jkr = adhesive.verify(indentation="3 um", cells_per_diameter=32)
    assert jkr.agrees and abs(jkr.force.relative) < 0.1 and jkr.discs.force < 0.9 * one.press(indentation="3 um").force


def test_fields_of_one_top_are_those_of_hertz():
    """p = 2 E* a/(pi R) sqrt(1 - (r/a)^2); the gap vanishes in the contact; the limits contain a/R."""
    one = fakir.AsperityArray(0.0, 0.0, "200 um", "526 um", GLASS, RUBBER)
    contact = one.press(indentation="4 um")
    radius = np.sqrt(526e-6 * 4e-6)
    modulus = 1.0 / (0.75 / 1.5e6 + (1.0 - 0.22**2) / 70e9)
    x = radius * np.array([0.0, 0.3, 0.9, 1.1])
    hertz = 2.0 * modulus * radius / (np.pi * 526e-6) * np.sqrt(np.maximum(1.0 - (x / radius) ** 2, 0.0))
    assert contact.pressure(x, 0.0) == pytest.approx(hertz, rel=1e-9)
    assert np.abs(contact.surface_gap(x[:3], 0.0)).max() < 1e-14 < contact.surface_gap(x[3], 0.0)
    assert contact.displacement(0.0, 0.0) == pytest.approx(4e-6, rel=1e-9)
    assert contact.pressure(np.zeros((2, 3)), 0.0).shape == (2, 3)


def test_a_fit_finds_the_modulus_and_the_curvature(tmp_path):
    """The data are Hertz's: F = 4/3 E* sqrt(R) zeta^(3/2); zeta is the reading less the contact point."""
    one = fakir.AsperityArray(0.0, 0.0, "200 um", "526 um", GLASS, fakir.Substrate("1 MPa", 0.5))
    (tmp_path / "case.toml").write_text(one.to_toml())
    one.to_csv(tmp_path / "pillars.csv")
    read = fakir.read_case(tmp_path / "case.toml")
    modulus = 1.0 / (0.75 / 1.5e6 + (1.0 - 0.22**2) / 70e9)
    depth = np.linspace(-1e-6, 6e-6, 36)
    force = 4.0 / 3.0 * modulus * np.sqrt(526e-6) * np.maximum(depth, 0.0) ** 1.5
    data = {"displacement_m": depth + 3e-6, "force_N": force}
    fitted = fakir.fit(data, read, ["substrate.young_modulus", "contact_point"])
    assert fitted["substrate.young_modulus"].value == pytest.approx(1.5e6, rel=1e-3)
    assert fitted["contact_point"].value == pytest.approx(3e-6, abs=5e-9)
    assert isinstance(fitted.system, fakir.AsperityArray) and fitted.to_dict()["method"] == "rounded tops"
    assert fitted.system.substrate.young_modulus == fitted["substrate.young_modulus"].value
    fitted = fakir.fit(data, fitted.system, ["pattern.top_radius", "contact_point"])
    assert fitted["pattern.top_radius"].value == pytest.approx(526e-6, rel=2e-3)
    with pytest.raises(ValueError, match="save them with to_toml"):
        fakir.fit(data, tops(), ["substrate.young_modulus"])


def test_what_to_cite_for_rounded_tops():
    keys = [entry.bibtex.split("{")[1].split(",")[0] for entry in fakir.cite(tops())]
    assert "Hertz1882" in keys and "Aymard2024" not in keys


def test_every_kind_of_surface_has_one_entry(tmp_path):
    pillars = fakir.Pillars(X, Y, 200e-6, 1e-3, axis=(PITCH, PITCH))
    made = fakir.problem(GLASS, RUBBER, pillars, top_radius="526 um")
    by_hand = fakir.AsperityArray(X - PITCH, Y - PITCH, 200e-6, "526 um", GLASS, RUBBER, diameter="1 mm")
    assert made.press(force="10 mN").indentation == by_hand.press(force="10 mN").indentation
    lens = fakir.Lens("2.2 mm", "2 MPa", 0.5)
    assert isinstance(fakir.problem(lens, RUBBER, pillars), fakir.System)
    flat = fakir.problem(GLASS, RUBBER, np.zeros((8, 8)), cell_size="1 um", periodic=True)
    assert isinstance(flat, fakir.bem.Surface) and flat.periodic
    with pytest.raises(TypeError, match="top_radius is that of Pillars"):
        fakir.problem(GLASS, RUBBER, np.zeros((8, 8)), top_radius="1 um")
    (tmp_path / "case.toml").write_text(made.to_toml())
    made.to_csv(tmp_path / "pillars.csv")
    assert len(fakir.read_case(tmp_path / "case.toml")) == 9
    with pytest.raises(fakir.CaseError, match="flat pillar tops only"):
        fakir.System.from_file(tmp_path / "case.toml")


def test_adhesion_of_one_top_is_that_of_johnson_kendall_and_roberts():
    """-(3/2) pi w R under a plate, whatever the moduli."""
    one = fakir.AsperityArray(0.0, 0.0, "200 um", "526 um", GLASS, RUBBER, adhesion="50 mJ/m2")
    assert one.adhesion == fakir.Adhesion("50 mJ/m2")
    cycle = one.cycle(to="5 um")
    assert cycle.pull_off_force == pytest.approx(-1.5 * np.pi * 50e-3 * 526e-6, rel=1e-8)
    assert [event["event"] for event in cycle.events] == ["snap_in", "release"]
    assert cycle.hysteresis == pytest.approx(cycle.dissipation, rel=1e-4)
    assert cycle.force.min() == pytest.approx(cycle.pull_off_force)
    contact = one.press(force="1 mN")
    plain = fakir.AsperityArray(0.0, 0.0, "200 um", "526 um", GLASS, RUBBER).press(force="1 mN")
    assert contact.contact_area > plain.contact_area and contact.left_out == ["floor"]


def test_the_floor_is_reached_at_the_transition():
    """The contact under the critical force has the critical indentation and no gap."""
    lens = fakir.Lens("20 mm", "70 GPa", 0.22)
    low = fakir.AsperityArray(1e-3 * X / PITCH, 1e-3 * Y / PITCH, "40 um", "526 um", lens, RUBBER, diameter="0.5 mm")
    critical = low.transition()
    assert critical.regime == "top_first" and critical.smallest_floor_gap == 0
    assert critical.contact.force == critical.force > 0
    contact = low.press(force=critical.force)
    assert contact.indentation == pytest.approx(critical.indentation, rel=1e-6)
    assert low.press(force=0.9 * critical.force).smallest_floor_gap > 0
    assert "Critical state" in repr(critical) or "AsperityTransition" in repr(critical)
    with pytest.raises(fakir.FakirError, match="outside the pillars"):
        tops().transition()


def test_an_adhesive_floor_is_kept_and_needs_an_axis():
    """As case files: a plate has no point that is closest to the floor."""
    floor = fakir.Adhesion(0.05, floor=True)
    lens = fakir.Lens("20 mm", "70 GPa", 0.22)
    found = fakir.AsperityArray(0.0, 0.0, "40 um", "526 um", lens, RUBBER, diameter="0.5 mm", adhesion=floor)
    assert found.adhesion == floor
    plate = fakir.AsperityArray(0.0, 0.0, "1 um", "0.5 mm", GLASS, RUBBER, adhesion=floor)
    with pytest.raises(fakir.FakirError, match="floor contact is not computed"):
        plate.press(force="1 mN")


LOW = """
[lens]
radius = "3 mm"
young_modulus = "70 GPa"
poisson_ratio = 0.2
[substrate]
young_modulus = "2 MPa"
poisson_ratio = 0.5
[pattern]
lattice = "square"
pitch = "60 um"
columns = 3
top_radius = "100 um"
[pattern.pillar]
height = "2 um"
diameter = "24 um"
"""


def test_designs_and_samples_of_rounded_tops():
    """The tops that are found have the target; the moduli of samples scale their forces (the lens is almost rigid)."""
    low = fakir.AsperityArray.from_toml(LOW)
    force = low.transition().force
    found = fakir.design(low, "pattern.top_radius", critical_force=1.05 * force)
    assert isinstance(found.system, fakir.AsperityArray) and found.system.top_radius == found.value
    assert found.system.transition().force == pytest.approx(1.05 * force, rel=1e-8)
    assert found.critical.force == pytest.approx(1.05 * force, rel=1e-8) and "sensitivity" in str(found)
    assert found.state.force == found.critical.force and found.to_dict()["tops"] == "rounded"
    spread = fakir.spread(low, {"substrate.young_modulus": "10 %"}, samples=3, landing="as_given")
    moduli = spread.to_pandas()["substrate.young_modulus_Pa"].to_numpy()
    assert spread.force == pytest.approx(force * moduli / 2e6, rel=1e-4)
    adhesive = fakir.AsperityArray.from_toml(LOW.replace("columns = 3", "columns = 1"), {"adhesion.work": "20 mJ/m2"})
    pulled = fakir.design(adhesive, "pattern.top_radius", pull_off="5 uN")
    curvature = 1 / pulled.value + 1 / 3e-3
    assert 1.5 * np.pi * 20e-3 / curvature == pytest.approx(5e-6, rel=1e-6)
    assert pulled.cycle.pull_off_force == pytest.approx(-5e-6, rel=1e-6)
    whole = adhesive.cycle()
    assert whole.turn_indentation == pytest.approx(adhesive.transition().indentation, rel=1e-9)


@pytest.mark.slow
def test_rounded_tops_for_a_floor_share():
    """The tops that are found have the share, whose error is known, under the load."""
    low = fakir.AsperityArray.from_toml(LOW)
    force = 3 * low.transition().force
    found = fakir.design(low, "pattern.pillar.height", floor_share="20 %", at_force=force)
    floor = found.system.press(force=force).floor
    assert floor.share == pytest.approx(0.2, abs=floor.error.share)


def test_derivatives_of_rounded_tops():
    """Central differences, and Hertz: R dF/dR = F/2 under a plate."""
    one = fakir.AsperityArray(0.0, 0.0, "200 um", "526 um", GLASS, RUBBER)
    found = one.gradient(indentation="2 um")
    assert 526e-6 * found.force["pattern.top_radius"] == pytest.approx(0.5 * found.state.force, rel=1e-9)
    assert found.indentation is None and found.contact_area is not None and len(found.pillars) == 1
    low = fakir.AsperityArray.from_toml(LOW)
    gradient = low.gradient()
    forces = [
        fakir.AsperityArray.from_toml(LOW, {"pattern.pitch": pitch}).transition().force
        for pitch in (60e-6 - 1e-10, 60e-6 + 1e-10)
    ]
    assert gradient.force["pattern.pitch"] == pytest.approx((forces[1] - forces[0]) / 2e-10, rel=1e-4)
    assert gradient.stiffness > 0 and "stiffness" in str(gradient)


def test_the_loading_is_that_of_the_program():
    case = EXAMPLES / "asperities.toml"
    overrides = {"pattern.columns": 2, "lens.shape": "sphere", "lens.radius": "60 mm"}
    array = fakir.AsperityArray.from_file(case, overrides)
    sets = [part for key, value in overrides.items() for part in ("--set", f"{key}={value}")]
    run = [os.environ["FAKIR"], "approach", str(case), *sets, "--step=5um", "--until=20um", "--json", "--quiet"]
    expected = json.loads(subprocess.run(run, capture_output=True, text=True, check=True).stdout)
    loading = array.approach("5 um", until="20 um")
    assert [row["force_N"] for row in loading.to_dict()["states"]] == [row["force_N"] for row in expected["states"]]
    assert [state.force for state in loading] == list(loading.to_pandas()["force_N"])
    assert (loading.critical is None) == (expected["critical"] is None)


def test_pillars_with_rounded_tops_keep_their_compliance():
    """Expected: the array with the same options."""
    x = np.array([0.0, 2e-3])
    for options in ({"compliance": "none"}, {"reference_height": "150 um"}):
        made = fakir.problem(GLASS, RUBBER, fakir.Pillars(x, 0 * x, 200e-6, 1e-3, **options), top_radius="526 um")
        by_hand = fakir.AsperityArray(x, 0 * x, 200e-6, "526 um", GLASS, RUBBER, diameter="1 mm", **options)
        assert made.press(force="1 mN").indentation == by_hand.press(force="1 mN").indentation
    with pytest.raises(ValueError, match="compliance is 'elastic'"):
        fakir.problem(GLASS, RUBBER, fakir.Pillars(x, 0 * x, 200e-6, 1e-3, compliance="elastic"), top_radius="526 um")
