"""Fits of several curves: those of the program, to the bit, and the same as single fits."""

import json
import os
import subprocess

import matplotlib
import numpy as np
import pandas
import pytest

matplotlib.use("Agg")

from conftest import EXAMPLES  # noqa: E402

import fakir  # noqa: E402

CASE = EXAMPLES / "fit" / "case.toml"
FILES = [EXAMPLES / "fit" / f"spot-{number}.csv" for number in (1, 2, 3)]
FREE = ["substrate.young_modulus", "contact_point"]
COMPLIANCE = {"machine_compliance": 0.002}


@pytest.fixture(scope="module")
def system():
    return fakir.System.from_file(CASE, overrides={"method.name": "punch"})


@pytest.fixture(scope="module")
def fits(system):
    return fakir.fit_many(FILES, system, FREE, **COMPLIANCE)


def program(files, *options):
    run = [os.environ["FAKIR"], "fit", *files, "--case", CASE, "--free", ",".join(FREE), *options]
    run += ["--machine-compliance", "0.002", "--set", "method.name=punch", "--json", "--quiet"]
    return json.loads(subprocess.run(run, capture_output=True, check=True).stdout)


def timeless(value):
    if isinstance(value, dict):
        return {name: timeless(part) for name, part in value.items() if name != "wall_time_s"}
    return [timeless(part) for part in value] if isinstance(value, list) else value


def test_the_fits_of_the_program(fits):
    assert timeless(fits.to_dict()) == timeless(program(FILES))


def test_curves_and_statistics(fits, system):
    assert len(fits) == 3 and fits.converged and fits.describes_data and not fits.failed
    assert [curve.name for curve in fits.curves] == [str(path) for path in FILES]
    alone = fakir.fit(FILES[1], system, FREE, **COMPLIANCE)
    second = fits.curves[1].fit
    assert second["contact_point"] == alone["contact_point"]
    assert second.understood == alone.understood
    values = [curve.fit["substrate.young_modulus"].value for curve in fits.curves]
    found = fits["substrate.young_modulus"]
    assert found.curves == 3 and found.unit == "Pa" and found.outliers == []
    assert np.isclose(found.mean, np.mean(values), rtol=1e-12)
    assert np.isclose(found.standard_deviation, np.std(values, ddof=1), rtol=1e-9)
    assert abs(found.mean - 1.4e6) < 4 * found.standard_error
    table = fits.table()
    assert isinstance(table, pandas.DataFrame)
    assert list(table["substrate.young_modulus_Pa"]) == values
    assert "standard deviation" in repr(fits)
    axes = fakir.plot.fits(fits)
    assert [axis.get_ylabel() for axis in axes] == ["substrate.young_modulus (MPa)", "contact_point (µm)"]


def test_curves_that_cannot_be_fitted(system, tmp_path):
    empty = tmp_path / "empty.csv"
    empty.write_text("displacement_m,force_N\n")
    done = []
    with pytest.warns(fakir.FakirWarning, match="no fit of .*empty.csv"):
        fits = fakir.fit_many(
            [FILES[0], empty], system, FREE, **COMPLIANCE, progress=lambda *count: done.append(count)
        )
    assert done[-1] == (2, 2)
    assert [curve.name for curve in fits.failed] == [str(empty)]
    assert fits.curves[1].fit is None and not fits.converged
    assert fits["contact_point"].curves == 1
    assert fits["contact_point"].standard_deviation is None
    with pytest.raises(fakir.FitError, match=r"empty\.csv"):
        fakir.fit_many([empty], system, FREE)
    with pytest.raises(TypeError, match="fakir.fit_many"):
        fakir.fit([FILES[0], FILES[1]], system, FREE)


def test_curves_of_a_flat_surface():
    """Hertz under a rigid paraboloid: F = 4/3 E* sqrt(R) zeta^(3/2), of 1.7 MPa."""
    system = fakir.FlatSystem(fakir.ParaboloidLens("2 mm", 1e18, 0.3), fakir.Substrate("1 MPa", 0.5))
    depth = np.linspace(-0.5e-6, 3e-6, 40)
    force = 4 / 3 * 1.7e6 / 0.75 * 2e-3**0.5 * np.maximum(depth, 0) ** 1.5 + 1e-7 * (-1.0) ** np.arange(40)
    curves = {name: {"displacement_m": depth + point, "force_N": force} for name, point in (("a", 0), ("b", 1e-6))}
    fits = fakir.fit_many(curves, system, FREE)
    assert fits["substrate.young_modulus"].mean == pytest.approx(1.7e6, rel=1e-3)
    alone = fakir.fit(curves["b"], system, FREE)
    assert fits.curves[1].fit["contact_point"] == alone["contact_point"]


def test_masked_values_are_not_measured():
    system = fakir.FlatSystem(fakir.ParaboloidLens("2 mm", 1e18, 0.3), fakir.Substrate("1 MPa", 0.5))
    depth = np.linspace(-0.5e-6, 3e-6, 40)
    force = 4 / 3 * 1.7e6 / 0.75 * 2e-3**0.5 * np.maximum(depth, 0) ** 1.5 + 1e-7 * (-1.0) ** np.arange(40)
    force[20] *= 2.0
    masked = np.ma.array(force, mask=np.arange(40) == 20)
    holes = np.where(masked.mask, np.nan, force)
    one, other = (fakir.fit({"displacement_m": depth, "force_N": it}, system, FREE) for it in (masked, holes))
    assert one["contact_point"] == other["contact_point"]
    assert one["substrate.young_modulus"].value == pytest.approx(1.7e6, rel=1e-3)
    heights = np.ma.array(np.zeros((8, 8)), mask=np.eye(8) > 0)
    with pytest.raises(ValueError, match=r"heights\[0, 0\] is nan"):
        fakir.bem.Surface(heights, fakir.Lens("2 mm", "2 MPa", 0.5), fakir.Substrate("2 MPa", 0.5), cell_size="1 um")
    x = np.ma.array([0.0, 20e-6, 40e-6], mask=[0, 0, 1])
    with pytest.raises(ValueError, match=r"x\[2\] is masked: leave this pillar out"):
        fakir.Pillars(x, np.zeros(3), 2.2e-6, 6e-6)


@pytest.fixture(scope="module")
def joint(system):
    return fakir.fit_many(FILES[:2], system, FREE, joint=True, **COMPLIANCE)


def test_a_joint_fit(joint, fits):
    modulus = joint["substrate.young_modulus"]
    low, high = modulus.interval
    assert low < 1.4e6 < high
    assert list(joint.parameters) == ["substrate.young_modulus"]
    points = [curve.fit["contact_point"].value for curve in joint.curves]
    assert np.allclose(points, [3e-6, 3.4e-6], atol=5e-8)
    assert joint.agreement.agree and joint.agreement.test == "f"
    assert len(joint.agreement.degrees_of_freedom) == 2
    assert joint.separate[1]["substrate.young_modulus"].value == pytest.approx(
        fits.curves[1].fit["substrate.young_modulus"].value, rel=1e-9
    )
    assert "95 % interval" in repr(joint)
    shared = fakir.plot.fits(joint)[0].lines[-1].get_ydata()[0]
    assert shared == pytest.approx(1e-6 * modulus.value)


def test_the_joint_fit_of_the_program(joint):
    assert timeless(joint.to_dict()) == timeless(program(FILES[:2], "--joint"))


def test_a_joint_fit_of_named_curves(system, joint):
    named = dict(zip("ab", FILES[:2]))
    both = fakir.fit_many(named, system, FREE, joint=True, shared=FREE[:1], **COMPLIANCE)
    assert both["substrate.young_modulus"] == joint["substrate.young_modulus"]
    assert [curve.name for curve in both.curves] == ["a", "b"]


def test_bad_input(system):
    with pytest.raises(TypeError, match="curves is the file"):
        fakir.fit_many(str(FILES[0]), system, FREE)
    with pytest.raises(ValueError, match="curves is empty"):
        fakir.fit_many([], system, FREE)
    with pytest.raises(ValueError, match="is given twice"):
        fakir.fit_many([FILES[0], FILES[0]], system, FREE)
    with pytest.raises(TypeError, match="shared needs joint=True"):
        fakir.fit_many(FILES, system, FREE, shared=FREE[:1])
    with pytest.raises(fakir.FitError, match="force_offset is shared, but not free"):
        fakir.fit_many(FILES, system, FREE, joint=True, shared=["force_offset"])
    with pytest.raises(fakir.FitError, match="cannot read"):
        fakir.fit_many([FILES[0], "missing.csv"], system, FREE, joint=True)


def test_a_joint_fit_of_adhesive_pillars_and_a_flat_reference():
    """Modulus and work of adhesion of both, 2 MPa and 50 mJ/m^2; contact points of 1 um and 0.3 um."""
    rubber = fakir.Substrate("2 MPa", 0.5)
    flat = fakir.problem(fakir.Lens("2.2 mm", "2 MPa", 0.5), rubber, fakir.Flat(), adhesion="50 mJ/m2")
    pillars = fakir.System.from_file(EXAMPLES / "adhesive.toml")
    random = np.random.default_rng(1)
    curves, systems = {}, []
    for name, system, to, point, noise in [("flat", flat, 5e-6, 1e-6, 2e-6), ("pillars", pillars, 6e-7, 3e-7, 2e-7)]:
        steps = system.cycle(to=to).to_pandas()
        branches, displacements, forces = [], [], []
        for branch in ("loading", "unloading"):
            of_branch = steps[steps["branch"] == branch]
            places, values = (of_branch[name].to_numpy() for name in ("indentation_m", "force_N"))
            order = np.argsort(places, kind="stable")
            low, high = places.min(), places.max()
            at = low + (high - low) * (np.arange(50) + 0.5) / 50
            at = at if branch == "loading" else at[::-1]
            branches += [branch] * 50
            displacements += list(at + point)
            forces += list(np.interp(at, places[order], values[order]) + noise * random.normal(size=50))
        curves[name] = {"branch": branches, "displacement_m": displacements, "force_N": forces}
        systems.append(system.replace({"substrate.young_modulus": "2.5 MPa", "adhesion.work": "40 mJ/m2"}))
    free = ["substrate.young_modulus", "adhesion.work", "contact_point"]
    found = fakir.fit_many(curves, systems, free, joint=True)
    for name, truth in [("substrate.young_modulus", 2e6), ("adhesion.work", 50e-3)]:
        low, high = found[name].interval
        assert low < truth < high and high - low < 0.04 * truth
    for curve, point in zip(found.curves, [1e-6, 3e-7], strict=True):
        low, high = curve.fit["contact_point"].interval
        assert low < point < high
    assert found.agreement.agree
    with pytest.raises(ValueError, match="2 systems for 1 curves"):
        fakir.fit_many({"flat": curves["flat"]}, systems, free, joint=True)
