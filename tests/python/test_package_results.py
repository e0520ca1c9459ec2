"""Results of the package: to the bit those of the command line."""

import json
import os
import pickle
import pydoc
import subprocess

import numpy as np
import pytest
from conftest import EXAMPLES

import fakir
from fakir._record import Record

OVERRIDES = [
    ("paper-intermediate.toml", {}),
    ("paper-soft.toml", {"pattern.surface_fraction": 0.03}),
    ("paper-rigid.toml", {"pattern.pitch": "25 um", "pattern.offset": 0.25}),
    ("paper-intermediate.toml", {"method.name": "homogenised"}),
    ("paper-intermediate.toml", {"method.name": "punch", "pattern.pillar.compliance": "none"}),
]


def program(command, case, overrides, *arguments):
    """What ``fakir COMMAND --json`` prints."""
    settings = [f"--set={key}={value}" for key, value in overrides.items()]
    run = [os.environ["FAKIR"], command, str(EXAMPLES / case), "--json", "--quiet"]
    done = subprocess.run([*run, *settings, *arguments], capture_output=True, text=True)
    return json.loads(done.stdout)


def without_times(result):
    if isinstance(result, dict):
        return {k: without_times(v) for k, v in result.items() if k != "wall_time_s"}
    return [without_times(v) for v in result] if isinstance(result, list) else result


@pytest.mark.filterwarnings("ignore::fakir.FakirWarning")
@pytest.mark.parametrize(("case", "overrides"), OVERRIDES)
def test_bit_for_bit_as_the_program(case, overrides):
    system = fakir.System.from_file(EXAMPLES / case, overrides=overrides)
    expected = program("transition", case, overrides)
    assert list(system.transition().to_dict()) == list(expected)
    assert without_times(system.transition().to_dict()) == without_times(expected)
    expected = program("press", case, overrides, "--force", "20uN")
    pressed = system.press(force="20 uN").to_dict()
    assert list(pressed) == list(expected)
    assert without_times(pressed) == without_times(expected)


@pytest.mark.parametrize(
    ("arguments", "options"),
    [
        ([], {}),
        (["--until", "2um"], {"until": "2 um"}),
        (["--to", "4um"], {"to": 4e-6}),
        (["--to-force", "50uN", "--without-floor"], {"to_force": "50 uN"}),
    ],
)
def test_the_approach_is_that_of_the_program(arguments, options):
    overrides = {"pattern.surface_fraction": 0.01}
    case = "paper-intermediate.toml"
    expected = program("approach", case, overrides, "--step", "1um", *arguments)
    if "--without-floor" in arguments:
        overrides["floor.contact"] = False
    system = fakir.System.from_file(EXAMPLES / case, overrides=overrides)
    approach = system.approach("1 um", **options)
    assert without_times(approach.to_dict()) == without_times(expected)
    assert len(approach.to_pandas()) == len(approach) == len(expected["states"])


def test_a_system_made_here_is_that_of_the_file():
    made = fakir.System(
        fakir.Lens(radius="2200 um", young_modulus="2 MPa", poisson_ratio=0.5),
        fakir.Substrate(young_modulus=2e6, poisson_ratio=0.5),
        fakir.HexagonalPattern(diameter="6 um", height=2.2e-6, surface_fraction=0.1),
    )
    read = fakir.System.from_file(EXAMPLES / "paper-intermediate.toml")
    assert made == read
    assert made.to_toml() == read.to_toml()
    assert pickle.loads(pickle.dumps(made)) == made
    assert fakir.System(made.lens, made.substrate, made.pattern).pitch == made.pitch
    assert made.replace({"pattern.pitch": 20e-6}).pitch == 20e-6
    a, b = made.transition().to_dict(), read.transition().to_dict()
    assert without_times(a) == without_times(b)


@pytest.fixture(scope="module")
def system():
    return fakir.System.from_file(
        EXAMPLES / "paper-intermediate.toml", overrides={"pattern.surface_fraction": 0.01}
    )


def test_pillars_are_a_table(system):
    critical = system.transition()
    pillars = critical.pillars
    assert len(pillars) == critical.pillars_in_contact == 13
    assert pillars["force_N"].sum() == pytest.approx(critical.force, rel=1e-12)
    centres = [system.pillar_centre(int(p["i"]), int(p["j"])) for p in pillars]
    assert np.allclose(centres, np.stack([pillars["x_m"], pillars["y_m"]], axis=1), atol=1e-18)
    with pytest.raises(ValueError, match="read-only"):
        pillars["force_N"][0] = 0.0


def test_fields_are_broadcast(system):
    state = system.press(force="20 uN")
    x = np.linspace(-30e-6, 30e-6, 7)
    gap = state.gap(x, x[:, np.newaxis])
    assert gap.shape == (7, 7)
    assert state.gap(x[2], x[4]) == pytest.approx(gap[4, 2], rel=1e-12)
    assert isinstance(state.gap(0.0, 0.0), float)
    assert state.pressure(0.0, 0.0) == state.pillars["centre_pressure_Pa"][0]
    assert state.gap([], []).shape == (0,)
    data = state.on_grid(x, x[:4])
    assert dict(data.sizes) == {"y": 4, "x": 7}
    assert data.gap.attrs["units"] == "m"
    assert np.array_equal(data.gap.values, state.gap(*np.meshgrid(x, x[:4])))
    # Force balance needs the whole contact: gap and pressure exclude each other.
    whole = state.to_xarray(101)
    both = whole.pressure.where(whole.gap > 1e-9, 0.0)
    assert float(abs(both).max()) < 1e-3 * float(whole.pressure.max())
    # Before contact there is the lens alone.
    above = system.press(indentation=0.0)
    assert above.pressure(x, 0.0).max() == 0.0
    assert above.gap(0.0, 0.0) == pytest.approx(0.0, abs=1e-20)
    with pytest.raises(fakir.FakirError, match="does not resolve pillars"):
        system.press(force="20 uN", method="homogenised").gap(0.0, 0.0)


def test_results_show_themselves(system):
    critical = system.transition()
    for shown in [critical, critical.state, system, system.approach("2 um")]:
        assert "<table>" in shown._repr_html_()
        assert "nan" not in repr(shown)
    assert "92.306 µN" in repr(critical)


def test_numbers_are_those_of_the_record(system):
    """Values by path from the JSON object, attributes by the rule: without units and ``critical_``."""
    critical = system.transition()
    state, printed = critical.state, critical.to_dict()
    assert isinstance(critical, fakir.Critical) and isinstance(state, fakir.Contact)
    assert critical.force == printed["critical_force_N"] == state.force
    assert critical.floor_contact == tuple(printed["floor_contact_m"])
    assert critical.normalized._asdict() == printed["normalized"]
    assert critical.error._asdict() == {**printed["relative_error_estimate"], "contact_area": None}
    assert critical.unresolved is None and critical.wall_time == printed["wall_time_s"]
    assert not hasattr(critical, "bottom_contact")
    assert fakir.ContactState.force.__doc__ == "Normal force on the lens, F (N)."
    assert "Data descriptors" in pydoc.render_doc(fakir.ContactState)
    with pytest.raises(AttributeError, match="cannot be set"):
        state.force = 1.0
    record = Record().answers
    for answer, name in [(state, "PressNumbers"), (critical, "TransitionNumbers")]:
        for attribute in [*record[name][1], *record[record[name][0]][1]]:
            # Friction is there if the case has shear stresses.
            may_be_none = attribute in ("unresolved", "friction")
            assert getattr(answer, attribute) is not None or may_be_none


def test_methods_side_by_side(system):
    comparison = system.compare()
    assert comparison.reference == "spectral_accurate"
    rows = {row["method"]: row for row in comparison.rows}
    assert abs(rows["spectral_default"]["force_difference"]) < 1e-5
    # As the design document has it: -6.6 % at this surface fraction.
    assert rows["homogenised"]["force_difference"] == pytest.approx(-0.066, abs=0.001)
    verification = system.verify()
    assert verification.agrees and verification.verdict == "agree" and verification.doubt is None
    # Between the centres of all cells: boundary elements find no force, and the comparison is inconclusive.
    light = system.verify(indentation=1e-12)
    assert light.verdict == "cannot tell" and not light.agrees
    assert "no digit is significant" in light.doubt and "inconclusive" in repr(light)
    assert abs(verification.force.relative) <= verification.force.allowed


def test_a_second_opinion_on_listed_pillars():
    angle = np.linspace(0.0, 2.0 * np.pi, 6, endpoint=False)
    ring = fakir.Pillars(20e-6 * np.cos(angle), 20e-6 * np.sin(angle), 2.2e-6, np.linspace(5e-6, 7e-6, 6))
    rubber = {"young_modulus": "2 MPa", "poisson_ratio": 0.5}
    pillars = fakir.System(fakir.Lens("2.2 mm", **rubber), fakir.Substrate(**rubber), ring)
    verification = pillars.verify(force="20 uN")
    assert verification.agrees and abs(verification.indentation.relative) < 1e-3


def test_theory(system):
    # Ewald sums and exact limits of the design document.
    assert fakir.theory.site_potential() == pytest.approx(-4.213422636, rel=1e-9)
    assert fakir.theory.hollow_potential() == pytest.approx(-1.542219722, rel=1e-9)
    limits = fakir.theory.sum_coefficients("limit")
    assert limits.displacement == pytest.approx(np.pi**2 / np.sqrt(3), rel=1e-12)
    fit = fakir.theory.fit_sum_coefficients()
    assert fit.displacement == pytest.approx(fakir.theory.sum_coefficients().displacement, rel=1e-3)
    # Six neighbours at distance 1 within 1.5 pitches, with forces as of Hertz.
    for wrong in (-1.0, 1e9):
        with pytest.raises(ValueError, match="in pitches: give values from 0 to 1000"):
            fakir.theory.lattice_sums(wrong)
    with pytest.raises(ValueError, match="other than 2, where the sum diverges"):
        fakir.theory.inverse_power_sum(2)
    sums = fakir.theory.lattice_sums(1.5)
    assert sums.displacement == pytest.approx(6.0 * np.sqrt(1.0 - 1.5**-2), rel=1e-12)
    curve = fakir.theory.transition_force(system, np.array([2.0, 4.0]) * system.pitch)
    assert curve.shape == (2,)
    assert curve[1] > curve[0]
    assert fakir.theory.phase(system, 0.5 * curve[0], 2.0 * system.pitch).region == "top"
    model = fakir.homogenised(system)
    assert model.critical.force == system.transition("homogenised").force
    hertz = fakir.theory.hertz_contact_radius(system, 1e-3)
    modulus = fakir.theory.constants(system).reduced_modulus
    assert hertz == pytest.approx((0.75 * 1e-3 * system.lens.radius / modulus) ** (1 / 3), rel=1e-12)


@pytest.mark.slow
def test_design_and_spread_and_citations(system):
    found = fakir.design(system, "pattern.surface_fraction", critical_force="200 uN")
    assert found.critical.force == pytest.approx(200e-6, rel=1e-8)
    assert found.system.transition().force == found.critical.force
    with pytest.raises(fakir.OutOfReach) as error:
        fakir.design(system, "pattern.surface_fraction", critical_force="1 nN")
    assert error.value.nearest
    spread = fakir.spread(system, {"pattern.pillar.height": "3 %"}, samples=8, seed=1)
    again = fakir.spread(system, {"pattern.pillar.height": "3 %"}, samples=8, seed=1, threads=1)
    assert np.array_equal(spread.force, again.force)
    assert len(spread.to_pandas()) == 8
    assert any("104, 055007" in entry.text for entry in fakir.cite(found.critical))


def test_spread_of_pillars_that_scatter(system):
    square = fakir.System.from_file(EXAMPLES / "square.toml")
    spread = fakir.spread(square, {}, samples=4, landing="as_given", force_at=["2 um", 3e-6])
    assert len(set(spread.force)) == 4
    assert (spread.force_at(0) < spread.force_at(1)).all()
    # Pillars that are missing have no derivative.
    assert spread.first_order is None
    heights = square.replace({"pattern.vacancy_fraction": 0})
    spread = fakir.spread(heights, {}, samples=3, landing="as_given")
    force, indentation = spread.first_order
    assert 0.0 < force < 0.1 * spread.force[0] and 0.0 < indentation < 1e-6


def test_design_of_a_floor_share(system):
    found = fakir.design(system, "pitch", floor_share="20 %", at_force="1 mN")
    floor = found.system.press(force="1 mN").floor
    assert abs(floor.share / 0.2 - 1.0) <= floor.error.share < 0.01
    assert found.state.floor.share == floor.share and "fraction on the floor" in repr(found)
    # Past the transition, whose load is below that of the design.
    assert found.critical.force < found.state.force == 1e-3
    value, solved, reached = fakir.design(system, "pitch", critical_force="1 mN")._found
    assert value < found.value and reached.force == solved.transition().force
    for wrong, match in [
        ({"floor_share": 0.2}, "exactly one of at_force and at_indentation"),
        ({"floor_share": 0.2, "at_force": 1e-3, "at_indentation": 1e-6}, "exactly one of at_force"),
        ({"critical_force": 1e-3, "at_force": 1e-3}, "give one of these"),
        ({"critical_force": 1e-3, "floor_share": 0.2, "at_force": 1e-3}, "exactly one of critical_force"),
    ]:
        with pytest.raises(TypeError, match=match):
            fakir.design(system, "pitch", **wrong)
    with pytest.raises(fakir.errors.DesignError, match="less than 1"):
        fakir.design(system, "pitch", floor_share=20, at_force="1 mN")


class Topography:
    """As those of SurfaceTopography."""

    def __init__(self, heights, sizes, unit=None):
        self._heights, self.physical_sizes, self.unit = heights, sizes, unit

    def heights(self):
        return self._heights


@pytest.mark.filterwarnings("ignore:the contact reaches the border")
def test_height_maps():
    lens, substrate = fakir.Lens("1 mm", "2 MPa", 0.5), fakir.Substrate("2 MPa", 0.5)
    surface = fakir.bem.Surface(np.zeros((64, 64), np.float32), lens, substrate, cell_size="1 um")
    contact = surface.press(indentation="0.5 um")
    # Hertz: F = 4/3 E* sqrt(R) zeta^(3/2), 1/E* = 2 (1 - 1/4)/E.
    modulus = 2e6 / 1.5
    hertz = 4 / 3 * modulus * np.sqrt(1e-3) * 0.5e-6**1.5
    assert contact.force == pytest.approx(hertz, rel=2e-3)
    error = contact.error.contact_area
    assert error < 0.2 and contact.contact_area == pytest.approx(np.pi * 1e-3 * 0.5e-6, rel=error)
    assert "estimated error" in repr(contact)
    assert contact.pressure_map.sum() * 1e-12 == pytest.approx(contact.force, rel=1e-9)
    # A topography is [x, y]; here a ridge along y, in um, as wide as the lens reaches.
    heights = np.zeros((96, 112))
    heights[46:50] = 0.1
    topography = Topography(heights, (96.0, 112.0), "um")
    ridge = fakir.bem.Surface(topography, lens, substrate, floor=0.0)
    assert ridge.heights.shape == (112, 96)
    assert ridge.heights.max() == pytest.approx(0.1e-6)
    found = ridge.press(force="1 uN").to_xarray()
    assert dict(found.sizes) == {"y": 112, "x": 96}
    assert float(found.pressure.sel(x=0, y=0, method="nearest")) > 0.0
    assert ridge.transition().force > 0.0
    with pytest.raises(ValueError, match="heights has the shape"):
        fakir.bem.Surface(np.zeros(3), lens, substrate, cell_size=1e-6)
    with pytest.raises(TypeError, match="exactly one of cell_size and width"):
        fakir.bem.Surface(np.zeros((8, 8)), lens, substrate)


def test_the_module_of_height_maps_has_an_older_name():
    with pytest.warns(FutureWarning, match="fakir.love is now called fakir.bem"):
        assert fakir.love.Surface is fakir.bem.Surface
    with pytest.warns(FutureWarning, match="fakir.bem"):
        from fakir.love import Plate
    assert Plate is fakir.bem.Plate
    with pytest.raises(AttributeError):
        fakir.love.Lens_
