"""Accepted input of the package, and the errors of other input."""

import numpy as np
import pint
import pytest

import fakir

UNITS = pint.UnitRegistry()


def system(**changes):
    values = {"radius": 2.2e-3, "young_modulus": 2e6, "poisson_ratio": 0.5, **changes}
    pattern = fakir.HexagonalPattern(6e-6, 2.2e-6, surface_fraction=0.01)
    return fakir.System(fakir.Lens(**values), fakir.Substrate(2e6, 0.5), pattern)


def test_names_of_arguments_that_do_not_exist():
    with pytest.raises(TypeError, match="takes no surface_fracton: it takes diameter, height, pitch, surface_fraction"):
        fakir.HexagonalPattern("5 um", "2 um", surface_fracton=0.1)
    with pytest.raises(TypeError, match="takes no thicknes: it takes radius, young_modulus, poisson_ratio, thickness, base"):
        fakir.Lens("1 mm", "2 MPa", 0.5, thicknes="1 mm")
    with pytest.raises(TypeError, match="surface is the name of a file, map.npy: read an array"):
        fakir.problem(fakir.Lens("1 mm", "2 MPa", 0.5), fakir.Substrate("2 MPa", 0.5), "map.npy")


def test_quantities_with_and_without_units():
    for radius in [
        2.2e-3,
        "2200 um",
        "2.2 mm",
        "2200 \u00b5m",
        np.float64(2.2e-3),
        np.array(2.2e-3),
        UNITS.Quantity("2.2 mm"),
        UNITS.Quantity(2.2e-3, "m"),
    ]:
        assert fakir.Lens(radius, 1, 0.5).radius == pytest.approx(2.2e-3, rel=1e-15), radius
    assert fakir.Lens("2200 um", 1, 0.5).radius == 2.2e-3
    assert fakir.Lens(np.float32(0.5), 1, 0.5).radius == 0.5
    assert fakir.Substrate(UNITS.Quantity(2, "MPa"), 0.5).young_modulus == 2e6
    pattern = fakir.HexagonalPattern("6 um", "2 um", pitch="20 um", offset_angle="30 deg")
    assert pattern.offset_angle == pytest.approx(np.pi / 6)
    state = system().press(force=UNITS.Quantity(20, "micronewton"))
    assert state.force == pytest.approx(20e-6, rel=1e-14)
    assert state.gap(UNITS.Quantity([0.0, 20.0], "um"), 0.0)[1] == state.gap(20e-6, 0.0)


@pytest.mark.parametrize(
    ("radius", "error", "words"),
    [
        ("2 MPa", ValueError, "lens.radius: MPa is a unit of pressure, not of length"),
        ("wide", ValueError, 'lens.radius: "wide" does not start with a number'),
        ("2 UM", ValueError, r"did you mean um\?"),
        ([1, 2], TypeError, "lens.radius is of type list: give a number in m"),
        (None, TypeError, "lens.radius is of type NoneType"),
        (True, TypeError, "lens.radius is True"),
        (1j, TypeError, "lens.radius is of type complex"),
        (UNITS.Quantity(1, "Pa"), ValueError, "lens.radius: Cannot convert"),
        (-1.0, fakir.CaseError, "lens.radius: cannot be -1 m; it must be a finite number greater"),
        (float("nan"), fakir.CaseError, "lens.radius: cannot be NaN m"),
        (np.inf, fakir.CaseError, "lens.radius: cannot be inf m"),
    ],
)
def test_what_is_no_radius(radius, error, words):
    with pytest.raises(error, match=words):
        system(radius=radius)


def test_errors_have_the_key_and_the_place(tmp_path):
    with pytest.raises(fakir.CaseError) as error:
        system(poisson_ratio=0.6)
    assert isinstance(error.value, ValueError)
    assert isinstance(error.value, fakir.FakirError)
    assert error.value.key == "lens.poisson_ratio"
    path = tmp_path / "case.toml"
    path.write_text(system().to_toml().replace('"2.2 mm"', '"2.2 furlong"'))
    with pytest.raises(fakir.CaseError) as error:
        fakir.System.from_file(path)
    assert (error.value.key, error.value.file) == ("lens.radius", str(path))
    assert error.value.line is not None
    with pytest.raises(fakir.CaseError, match="did you mean pattern.pitch"):
        system().replace({"pattern.pich": 1})


def test_exactly_one_of_each_pair():
    with pytest.raises(TypeError, match="exactly one of pitch and surface_fraction"):
        fakir.HexagonalPattern("6 um", "2 um")
    for load in [{}, {"force": 1e-6, "indentation": 1e-6}]:
        with pytest.raises(TypeError, match="exactly one of indentation and force"):
            system().press(**load)
    with pytest.raises(TypeError, match="a system takes a Lens"):
        fakir.System(fakir.Substrate(1, 0.5), fakir.Lens(1, 1, 0.5), None)


def test_methods_and_their_settings():
    with pytest.raises(fakir.CaseError, match='method.name: "spectrum" is not known; give "spectral"'):
        system().transition("spectrum")
    with pytest.raises(fakir.CaseError, match='only the method "spectral" has this key'):
        system().transition("love", accuracy="accurate")
    with pytest.raises(ValueError, match="threads is -1"):
        system().transition(threads=-1)
    with pytest.raises(TypeError, match="progress must be a function"):
        system().transition(progress=3)


def test_loads_that_cannot_be():
    with pytest.raises(ValueError, match="invalid force -1"):
        system().press(force="-1 N")
    with pytest.raises(ValueError, match="invalid indentation NaN"):
        system().press(indentation=float("nan"))
    with pytest.raises(fakir.SolveError, match="more than half the lens radius"):
        system().press(indentation="3 mm")
    dense = system().replace({"pattern.surface_fraction": 0.2})
    with pytest.raises(fakir.SolveError, match="the limit is 1.0 MB"):
        dense.transition(memory_limit=1_000_000)
    with pytest.raises(ValueError, match="at most 10000"):
        system().approach("0.0001 nm")
    assert system().press(indentation="5 um").beyond_transition


def test_fields_count_against_the_memory_limit():
    pytest.importorskip("xarray")
    state = system().press(force="20 uN")
    few = state.to_xarray(50, memory_limit=1_000_000)
    assert few.sizes == {"x": 50, "y": 50}
    for ask in [
        lambda: state.to_xarray(100_000),  # 80 GB of coordinates alone
        lambda: state.on_grid(np.zeros(100_000), np.zeros(100_000)),
        lambda: state.gap(np.zeros((100_000, 1)), np.zeros(100_000)),
    ]:
        with pytest.raises(fakir.SolveError, match="fields at 10000000000 points take 1360.0 GB"):
            ask()
    with pytest.raises(fakir.SolveError, match="at most 7352 points, such as 85 by 85"):
        state.pressure(np.zeros(10_000), 0.0, memory_limit=1_000_000)


def test_arrays_of_points():
    state = system().press(force="20 uN")
    points = np.linspace(0, 30e-6, 5)
    double = state.gap(points.astype(np.float32).astype(float), 0.0)
    assert np.array_equal(state.gap(points.astype(np.float32), np.float32(0)), double)
    assert state.gap(points[::-2], 0.0).shape == (3,)  # not contiguous
    for bad, words in [
        (points * 1j, "x is an array of complex128"),
        (points > 0, "x is an array of bool"),
        (np.array(["a"]), "x is an array of <U1"),
        (points.astype(np.longdouble), "x is an array of (float128|longdouble|float96)"),
        (np.array([None]), "x is an array of object"),
    ]:
        with pytest.raises(TypeError, match=words):
            state.gap(bad, 0.0)
    with pytest.raises(ValueError, match=r"y\[1, 0\] is nan"):
        state.pressure(0.0, [[0.0], [np.nan]])
    with pytest.raises(ValueError, match=r"x of shape \(3,\) and y of shape \(2,\) cannot"):
        state.pressure(np.zeros(3), np.zeros(2))
    with pytest.raises(ValueError, match=r"x has the shape \(2, 2\)"):
        state.on_grid(np.zeros((2, 2)), [0.0])


def test_fractions_in_per_cent():
    pattern = fakir.HexagonalPattern(6e-6, 2.2e-6, surface_fraction="3 %")
    assert pattern.surface_fraction == 0.03
    overridden = system().replace({"pattern.surface_fraction": "3%"})
    assert overridden.surface_fraction == system().replace({"pattern.surface_fraction": 0.03}).surface_fraction
    with pytest.raises(ValueError, match="not of length"):
        fakir.Lens("3 %", 1, 0.5)


def test_older_names_of_arguments_cause_warnings():
    with pytest.warns(FutureWarning, match="force is now called critical_force"):
        older = fakir.design(system(), "pitch", force="50 uN")
    assert older.value == fakir.design(system(), "pattern.pitch", critical_force="50 uN").value
    with pytest.raises(TypeError, match="give only critical_force"):
        fakir.design(system(), "pitch", force="50 uN", critical_force="50 uN")


def test_older_names_of_the_scatter_of_heights_cause_warnings():
    def square(**options):
        return fakir.SquarePattern("6 um", "2.2 um", pitch="20 um", **options)

    newer = square(height_standard_deviation="3 %")
    with pytest.warns(FutureWarning, match="height_spread is now called height_standard_deviation"):
        assert square(height_spread="3 %") == newer
    with pytest.warns(FutureWarning, match="height_spread is now called"):
        assert newer.height_spread == 0.03
    with pytest.raises(TypeError, match="give only height_standard_deviation"):
        square(height_spread=0.03, height_standard_deviation=0.03)
    with pytest.warns(FutureWarning, match="use pattern.height_standard_deviation"):
        older = system().replace({"pattern.height_spread": 0.03})
    assert older == system().replace({"pattern.height_standard_deviation": 0.03})


def test_former_names_of_classes_and_arguments_cause_warnings(tmp_path):
    with pytest.warns(FutureWarning, match="fakir.SquareTexture is now called fakir.SquarePattern"):  # former name
        assert fakir.SquareTexture is fakir.SquarePattern  # former name
    with pytest.warns(FutureWarning, match="fakir.RoundedTops is now called fakir.AsperityArray"):  # former name
        assert fakir.RoundedTops is fakir.AsperityArray  # former name
    with pytest.warns(FutureWarning, match="fakir.StuckFloor is now called fakir.AdhesiveFloor"):  # former name
        assert fakir.StuckFloor is fakir.AdhesiveFloor  # former name
    with pytest.warns(FutureWarning, match="is now called fakir.theory.AdhesiveSphere"):
        assert fakir.theory.StickySphere is fakir.theory.AdhesiveSphere  # former name
    with pytest.raises(AttributeError, match="has no attribute 'HexagonalTextures'"):
        fakir.HexagonalTextures  # noqa: B018
    pattern = fakir.SquarePattern("6 um", "2.2 um", pitch="20 um", vacancy_fraction="10 %")
    with pytest.warns(FutureWarning, match="missing is now called vacancy_fraction"):
        assert fakir.SquarePattern("6 um", "2.2 um", pitch="20 um", missing="10 %") == pattern
    with pytest.warns(FutureWarning, match="missing is now called vacancy_fraction"):
        assert pattern.missing == pattern.vacancy_fraction
    bodies = fakir.Lens("2.2 mm", "2 MPa", 0.5), fakir.Substrate("2 MPa", 0.5)
    new = fakir.System(*bodies, pattern)
    with pytest.warns(FutureWarning, match="texture is now called pattern"):  # former name
        assert fakir.System(*bodies, texture=pattern) == new  # former name
    with pytest.warns(FutureWarning, match="texture is now called pattern"):  # former name
        assert new.texture == new.pattern  # former name
    with pytest.warns(FutureWarning, match="set is now called overrides"):
        older = new.replace(set={"pattern.pitch": "30 um"})  # former name
    assert older == new.replace({"pattern.pitch": "30 um"})
    with pytest.warns(FutureWarning, match=r"\[texture\] is deprecated: use \[pattern\]"):  # former name
        assert new.replace({"texture.pitch": "30 um"}) == older  # former name
    with pytest.raises(TypeError, match="give only overrides"):
        new.replace({}, set={})  # former name
    case = tmp_path / "case.toml"
    case.write_text(new.to_toml().replace("[pattern", "[texture"))  # former name
    with pytest.warns(FutureWarning, match=r"\[texture\] is deprecated"):  # former name
        assert fakir.System.from_file(case) == new
    with pytest.warns(FutureWarning, match="texture.pitch is deprecated: use pattern.pitch"):  # former name
        fakir.design(system(), "texture.pitch", critical_force="50 uN")  # former name


def test_pillars_without_a_reference_count_from_the_highest():
    x = np.arange(7) * 1e-5
    pillars = fakir.Pillars(x, 0.0 * x, 1e-6, 0.1e-6 * 3.0)
    lens, substrate = fakir.Lens("2.2 mm", "2 MPa", 0.5), fakir.Substrate("2 MPa", 0.5)
    common = fakir.System(lens, substrate, pillars)._pillar
    assert common == (0.1e-6 * 3.0, 1e-6)
    given = fakir.Pillars(x, 0.0 * x, 1e-6, 3e-7, reference_height="2 um")
    assert fakir.System(lens, substrate, given)._pillar == (pytest.approx(3e-7, rel=1e-15), 2e-6)


@pytest.mark.slow
def test_spread_draws_what_the_command_line_draws(tmp_path):
    import json
    import os
    import subprocess

    case = tmp_path / "case.toml"
    case.write_text(system().replace({"pattern.surface_fraction": "0.05 %"}).to_toml())
    printed = subprocess.run(
        [os.environ["FAKIR"], "design", case, "--tolerance", "pattern.pillar.height=3%", "--json", "--quiet"],
        stdout=subprocess.PIPE,
        check=True,
    )
    drawn = fakir.spread(fakir.System.from_file(case), {"pattern.pillar.height": "3%"})
    assert drawn.to_dict()["spread"] == json.loads(printed.stdout)["spread"]


def test_bodies_of_a_height_map_can_have_a_thickness() -> None:
    """A film on glass is stiffer than a half-space, and a case file gives the same bodies as Python does."""
    lens = fakir.Lens("1 mm", "2 MPa", 0.5)
    heights = np.zeros((48, 48))
    thin = fakir.Substrate("2 MPa", 0.5, thickness="10 um")
    soft = fakir.Substrate("2 MPa", 0.5, thickness="10 um", base=fakir.ElasticBase("2 MPa", 0.5))
    half_space = fakir.Substrate("2 MPa", 0.5)

    def force(substrate: fakir.Substrate) -> float:
        surface = fakir.bem.Surface(heights, lens, substrate, cell_size="1 um")
        assert surface.substrate == substrate
        return surface.press(indentation="0.2 um").force

    assert force(thin) > 1.05 * force(half_space)
    # A film on a half-space of the same material is a half-space.
    assert abs(force(soft) / force(half_space) - 1.0) < 1e-3
    case = """
        lens = { radius = "1 mm", young_modulus = "2 MPa", poisson_ratio = 0.5 }
        [substrate]
        young_modulus = "2 MPa"
        poisson_ratio = 0.5
        thickness = "10 um"
        [surface]
        arrangement = "square"
        pitch = "20 um"
        [surface.pillar]
        side = "6 um"
        cross_section = "square"
        height = "1 um"
        [surface.grid]
        width = "60 um"
    """
    assert fakir.bem.Surface.from_toml(case).substrate == thin


def test_bodies_of_rounded_tops_can_have_a_thickness(tmp_path) -> None:
    """A film on glass is stiffer than a half-space, and case files keep both bodies."""
    thick = fakir.Lens("1 mm", "2 MPa", 0.5, thickness="80 um", base="frictionless")
    thin = fakir.Substrate("2 MPa", 0.5, thickness="20 um")
    same = fakir.Substrate("2 MPa", 0.5, thickness="20 um", base=fakir.ElasticBase("2 MPa", 0.5))
    half_space = fakir.Substrate("2 MPa", 0.5)

    def tops(substrate: fakir.Substrate, lens: fakir.Lens = thick) -> fakir.AsperityArray:
        found = fakir.AsperityArray([0.0, 3e-5], [0.0, 0.0], "1 um", "0.5 mm", lens, substrate)
        assert (found.indenter, found.substrate) == (lens, substrate)
        return found

    def force(substrate: fakir.Substrate) -> float:
        return tops(substrate).press(indentation="0.2 um").force

    assert force(thin) > 1.05 * force(half_space)
    # A film on a half-space of the same material is a half-space.
    assert abs(force(same) / force(half_space) - 1.0) < 1e-9
    on_film = tops(thin)
    on_film.to_csv(tmp_path / "pillars.csv")
    (tmp_path / "case.toml").write_text(on_film.to_toml())
    read = fakir.AsperityArray.from_file(tmp_path / "case.toml")
    assert (read.indenter, read.substrate) == (thick, thin)
    assert read.press(indentation="0.2 um").force == on_film.press(indentation="0.2 um").force


def test_overrides_with_units_have_those_of_their_keys():
    """Numbers of overrides are in SI units, whatever the base units of a registry; another dimension is refused."""
    small = UNITS.__class__(system="cgs")
    for registry in (UNITS, small):
        other = system().replace({"lens.radius": 1.1 * registry.mm, "substrate.young_modulus": 3 * registry.MPa})
        assert other.lens.radius == pytest.approx(1.1e-3) and other.substrate.young_modulus == pytest.approx(3e6)
    with pytest.raises(ValueError, match="lens.radius: Cannot convert from 'newton'"):
        system().replace({"lens.radius": 1e-3 * UNITS.N})
    with pytest.raises(ValueError, match="pitch: Cannot convert from 'newton'"):
        fakir.sweep({"system": system(), "axes": {"pitch": [5e-5 * UNITS.N]}})
    rows = fakir.sweep({"system": system(), "axes": {"pitch": [6e-5, 7e-5] * UNITS.m}}).rows
    assert [row["pitch_m"] for row in rows] == [6e-5, 7e-5]


def test_pillars_with_units_are_copied():
    x = np.array([0.0, 20.0, 0.0])
    plain = fakir.Pillars(1e-6 * x, [0.0, 0.0, 20e-6], 2.2e-6, "6 um")
    given = fakir.Pillars(x * UNITS.um, [0.0, 0.0, 20.0] * UNITS.um, "2.2 um", 6 * UNITS.um)
    for name in ("x", "y", "height", "diameter"):
        np.testing.assert_allclose(getattr(given, name), getattr(plain, name), rtol=1e-15)
    mine = 1e-6 * x
    copied = fakir.Pillars(mine, mine, 2.2e-6, 6e-6)
    mine[:] = 0.0
    assert copied.x[1] == plain.x[1]


def test_listed_pillars_as_a_file(tmp_path):
    pillars = fakir.Pillars([0.0, 20e-6], [0.0, 0.0], [2.2e-6, 2e-6], 6e-6)
    made = fakir.System(fakir.Lens("2.2 mm", "2 MPa", 0.5), fakir.Substrate("2 MPa", 0.5), pillars)
    (tmp_path / "case.toml").write_text(made.to_toml())
    pillars.to_csv(tmp_path / "pillars.csv")
    assert fakir.System.from_file(tmp_path / "case.toml").press(force="1 uN").indentation == made.press(force="1 uN").indentation
    with pytest.raises(TypeError, match="reads listed pillars from a file"):
        fakir.sweep({"system": made, "axes": {"lens.radius": ["1 mm"]}})
    with pytest.raises(fakir.errors.DesignError, match="the table gives it for every pillar"):
        fakir.spread(made, {"pattern.pillar.diameter": "5 %"}, samples=3, landing="as_given")


def test_yes_and_no_are_not_words():
    relaxation = fakir.Relaxation([1.0], ["10 s"])
    with pytest.raises(TypeError, match="give True or False"):
        system().hold(force="20 uN", duration="1 s", back="no", relaxation=relaxation)


def test_closed_forms_are_refused_where_they_are_not_valid():
    theory, lens, substrate = fakir.theory, fakir.Lens("2.2 mm", "2 MPa", 0.5), fakir.Substrate("2 MPa", 0.5)
    square = fakir.System(lens, substrate, fakir.SquarePattern(6e-6, 2.2e-6, pitch=5e-5))
    with pytest.raises(ValueError, match="infinite hexagonal lattice"):
        theory.transition_force(square, 1e-4)
    with pytest.raises(ValueError, match="infinite hexagonal lattice"):
        theory.phase(square, 1e-5, 1e-5)
    # Hertz's contact is with a smooth surface.
    smooth = (0.75 * 1e-3 * 2.2e-3 / (4e6 / 3)) ** (1 / 3)
    assert theory.hertz_contact_radius(square, 1e-3) == pytest.approx(smooth, rel=1e-12)
    film = system().replace({"substrate.thickness": "50 um"})
    with pytest.raises(ValueError, match="half-spaces"):
        theory.hertz_contact_radius(film, 1e-3)
    with pytest.raises(ValueError, match="force is -0.001: give a number that is not negative"):
        theory.hertz_contact_radius(system(), -1e-3)
    with pytest.raises(ValueError, match="contact_radius is -0.000001"):
        theory.phase(system(), 1e-3, -1e-6)


def test_single_values_and_whole_numbers():
    assert fakir.Relaxation(1.0, "10 s").times == [10.0]
    assert fakir.Relaxation([1.0, 0.5], [1.0, 10.0] * UNITS.s).times == [1.0, 10.0]
    with pytest.raises(TypeError, match="memory_limit .* is '8 GB': give a whole number"):
        system().press(force="1 uN", memory_limit="8 GB")
    with pytest.raises(TypeError, match="threads is '2': give a whole number"):
        system().press(force="1 uN", threads="2")
    with pytest.raises(TypeError, match="pattern.columns is True: give a whole number"):
        fakir.HexagonalPattern(6e-6, 2.2e-6, pitch=5e-5, columns=True)
    with pytest.raises(ValueError, match="2\\^53 at most"):
        fakir.HexagonalPattern(6e-6, 2.2e-6, pitch=5e-5, seed=2**53 + 1)


def test_what_is_no_body_or_surface_is_named():
    lens, substrate = fakir.Lens("2.2 mm", "2 MPa", 0.5), fakir.Substrate("2 MPa", 0.5)
    with pytest.raises(TypeError, match="the indenter is of type str: give a lens"):
        fakir.FlatSystem("x", substrate)
    with pytest.raises(TypeError, match="substrate is of type str: give a Substrate"):
        fakir.AsperityArray([0.0], [0.0], 1e-4, 5e-4, fakir.bem.Plate(7e10, 0.2), "x")
    with pytest.raises(TypeError, match="surface is the class Flat: give one of its objects"):
        fakir.problem(lens, substrate, fakir.Flat)
    with pytest.raises(ValueError, match="height is -1e-06: heights are above the floor"):
        fakir.AsperityArray([0.0], [0.0], -1e-6, 5e-4, lens, substrate)
    tops = fakir.AsperityArray([0.0], [0.0], 1e-6, 5e-4, lens, substrate)
    with pytest.raises(ValueError, match="read-only"):
        tops.x[0] = 1.0
