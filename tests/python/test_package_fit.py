"""Fits: the same as those of the program, bit for bit, and refused input."""

import copy
import json
import os
import subprocess

import matplotlib
import numpy as np
import pandas
import pint
import pytest

matplotlib.use("Agg")

from conftest import EXAMPLES  # noqa: E402

import fakir  # noqa: E402

pytestmark = pytest.mark.filterwarnings("ignore:4 states .* are past the transition")

WHOLE = EXAMPLES / "fit" / "loading.csv"
CASE = EXAMPLES / "fit" / "case.toml"
FREE = ["substrate.young_modulus", "contact_point", "machine_compliance"]


@pytest.fixture(scope="module")
def system():
    return fakir.System.from_file(CASE)


# The last four states of the example are past the transition, which takes most of the time of a fit; the manual fits them too.
@pytest.fixture(scope="module")
def data(tmp_path_factory):
    path = tmp_path_factory.mktemp("fit") / WHOLE.name
    path.write_text("".join(WHOLE.read_text().splitlines(keepends=True)[:-4]))
    return path


@pytest.fixture
def table(data):
    return pandas.read_csv(data, comment="#")


@pytest.fixture(scope="module")
def fitted(data, system):
    return fakir.fit(data, system, FREE)


@pytest.mark.slow
def test_the_fit_of_the_program(data, fitted, tmp_path):
    run = [os.environ["FAKIR"], "fit", data, "--case", CASE, "--free", ",".join(FREE)]
    done = subprocess.run(
        [*run, "--json", "--quiet", "--output", tmp_path / "out"], capture_output=True, check=True
    )
    expected = json.loads(done.stdout)
    found = fitted.to_dict()
    assert list(found) == list(expected)
    del found["wall_time_s"], expected["wall_time_s"]
    assert found == expected
    saved = pandas.read_csv(tmp_path / "out" / "fitted.csv")
    assert list(saved.columns) == list(fitted.to_pandas().columns)
    assert np.array_equal(saved.force_N, fitted.to_pandas().force_N, equal_nan=True)


def test_the_truth_is_in_the_intervals(fitted):
    # The truth of the synthetic data, in crates/fakir-study/examples/synthetic_loading.rs.
    for name, truth in [
        ("substrate.young_modulus", 1.4e6),
        ("contact_point", 3e-6),
        ("machine_compliance", 2e-3),
    ]:
        low, high = fitted[name].interval
        assert low < truth < high, name
    assert fitted["substrate.young_modulus"].unit == "Pa"
    assert fitted.system.substrate.young_modulus == fitted["substrate.young_modulus"].value
    assert fitted.correlation.shape == (3, 3)
    assert fitted.undetermined == []
    assert "95 % interval" in repr(fitted)
    assert "<table>" in fitted._repr_html_()


def test_limits_and_one_sided_intervals(fitted):
    summary = fitted.to_dict()
    assert fitted.limits and [limit._asdict() for limit in fitted.limits] == summary["limits"]
    assert not any(fitted[name].one_sided for name in FREE)
    vanishing = {
        "name": "adhesion.work",
        "value_J_per_m2": 0.0,
        "start_J_per_m2": 0.03,
        "one_sided": True,
        "standard_error_J_per_m2": 1e-3,
        "confidence_interval_95_J_per_m2": [0.0, 2e-3],
    }
    summary["parameters"] = [vanishing]
    fitted = copy.copy(fitted)
    fitted._summary = summary
    assert fitted["adhesion.work"].one_sided
    assert "one-sided 95 % interval" in repr(fitted)


@pytest.mark.slow
def test_columns_tables_and_units(table, system, fitted):
    of_table = fakir.fit(table, system, FREE)
    assert of_table["contact_point"].value == fitted["contact_point"].value
    units = pint.UnitRegistry()
    columns = {
        "displacement": units.Quantity(table.displacement_m.to_numpy() * 1e6, "um"),
        "force": units.Quantity(table.force_N.to_numpy() * 1e6, "uN"),
    }
    of_units = fakir.fit(columns, system, FREE, contact_point="3 um")
    found, expected = of_units["substrate.young_modulus"], fitted["substrate.young_modulus"]
    assert abs(found.value - expected.value) < 0.01 * expected.standard_error


@pytest.mark.slow
def test_given_errors_and_figure(table, system):
    given = fakir.fit(table, system, FREE, force_error="0.5 uN", threads=1)
    assert 0.5 < given.reduced_chi_square < 2.0
    axes = fakir.plot.fit(given)
    assert len(axes) == 2
    assert all(axis.has_data() for axis in axes)


@pytest.mark.slow
def test_headings_of_instruments_and_columns_by_hand(table, system, fitted):
    columns = {
        "Sample": ["a"] * len(table),
        "Z position [um]": table.displacement_m * 1e6,
        "Channel 2": -table.force_N * 1e3,
    }
    found = fakir.fit(columns, system, FREE, columns={"force": "-Channel 2 [mN]"})
    for name in FREE:
        assert abs(found[name].value - fitted[name].value) < 1e-3 * fitted[name].standard_error
    assert found.understood == [
        'not used: column 1 "Sample"',
        'displacement: column 2 "Z position [um]", in um',
        'force: column 3 "Channel 2", in mN, with the opposite sign, named by hand',
    ]
    assert found.describes_data and fitted.describes_data
    with pytest.raises(ValueError, match="is no quantity of measurements"):
        fakir.fit(columns, system, FREE, columns={"mass": "Channel 2"})


@pytest.mark.slow
def test_a_fit_that_does_not_describe_the_data_warns(system):
    exact = system.replace({"method.name": "spectral"})
    with pytest.warns(fakir.FakirWarning, match="most likely wrong: machine_compliance"):
        poor = fakir.fit(WHOLE, exact, FREE[:2])
    assert not poor.describes_data and "does not describe" in repr(poor)
    most = poor.left_out[0]
    assert most.name == "machine_compliance" and most.wanted and most.p_value < 1e-9
    assert 1e-3 < most.value < 3e-3
    assert poor.runs[0].runs < poor.runs[0].expected and poor.chi_square_p_value is None
    assert fakir.plot.fit(poor)[0].get_title() == "the fit does not describe the data"


@pytest.mark.slow
def test_drifts_and_starts(table, system):
    table["time_s"] = np.arange(len(table)) * 2.0
    table["force_N"] += 4e-6 * table.time_s / table.time_s.max()
    found = fakir.fit(table, system, [*FREE, "force_drift"], starts=2)
    low, high = found["force_drift"].interval
    assert low < 4e-6 < high and found.force_drift == found["force_drift"].value
    assert len(found.to_dict()["starts"]) == 2 and found.to_dict()["drift_over"] == "time"
    assert fakir.plot.fit(found)[0].has_data()
    with pytest.raises(ValueError, match="starts is 0"):
        fakir.fit(table, system, FREE, starts=0)


@pytest.mark.slow
def test_undetermined_parameters_are_reported(table, system):
    free = ["substrate.young_modulus", "lens.young_modulus", "contact_point"]
    known = system.replace({"pattern.pillar.compliance": "none"})
    with pytest.warns(fakir.FakirWarning, match="lens.young_modulus"):
        both = fakir.fit(table, known, free)
    assert not both["lens.young_modulus"].determined
    assert both["contact_point"].determined
    assert both.undetermined
    assert "not determined" in repr(both)


@pytest.mark.parametrize(
    ("columns", "words"),
    [
        ({"force_N": [1e-6]}, "data"),
        ({"force": [1e-6]}, "force: no unit"),
        ({"mass": [1.0]}, 'seen were "mass", not understood'),
        ({"Load [um]": [1.0], "z_um": [1.0]}, "um is a unit of length, not of force"),
        ({"force_N": [1e-6], "contact_radius_m": [1e-6, 2e-6]}, "has 2 values"),
        ({"force_N": [[1e-6]], "contact_radius_m": [1e-6]}, "a column of numbers"),
        ({"force_N": ["a"], "contact_radius_m": [1e-6]}, "a column of numbers"),
        ({"force_N": [np.inf], "contact_radius_m": [1e-6]}, "force_N"),
    ],
)
def test_data_that_cannot_be(system, columns, words):
    with pytest.raises(ValueError, match=words):
        fakir.fit(columns, system, ["substrate.young_modulus"])


def test_arguments_that_cannot_be(data, system):
    for free, words in [
        (["substrate.young_moduls"], "cannot be fitted: give some of substrate.young_modulus"),
        (["lens.poisson_ratio"], "cannot be fitted"),
        ([], "nothing is free"),
        (["contact_point", "contact_point"], "given twice"),
    ]:
        with pytest.raises(ValueError, match=words):
            fakir.fit(data, system, free)
    with pytest.raises(TypeError, match="give a list of names"):
        fakir.fit(data, system, "contact_point")
    with pytest.raises(TypeError, match="measurements are of type int"):
        fakir.fit(3, system, FREE)
    with pytest.raises(fakir.FitError, match="no-such.csv: cannot read"):
        fakir.fit("no-such.csv", system, FREE)
    with pytest.raises(ValueError, match="force_error is -1.0: it must be greater than 0"):
        fakir.fit(data, system, FREE, force_error=-1)
    with pytest.raises(ValueError, match="MPa is a unit of pressure"):
        fakir.fit(data, system, FREE, contact_point="3 MPa")


@pytest.mark.slow
def test_a_retraction_is_fitted_and_a_pull_off_designed():
    adhesive = fakir.System.from_file(EXAMPLES / "fit" / "retraction.toml")
    table = pandas.read_csv(EXAMPLES / "fit" / "retraction.csv", comment="#")
    free = ["adhesion.work", "contact_point", "force_offset", "substrate.young_modulus"]
    found = fakir.fit(table, adhesive, free)
    # As crates/fakir-inverse/examples/synthetic_retraction.rs has them.
    for name, truth in zip(free, [0.035, 3e-6, 2e-6, 1.4e6]):
        low, high = found[name].interval
        assert low < truth < high
    assert found["adhesion.work"].unit == "J/m^2" and found["force_offset"].unit == "N"
    assert found.force_offset == found["force_offset"].value
    assert found.pull_off.measured < 0 and found.pull_off.model_error >= 0.05
    assert found.unloading.any() and "pull-off" in repr(found)
    assert {"loading", "unloading"} == set(found.columns()["branch"])
    axes = fakir.plot.fit(found)
    assert "fitted, unloading" in axes[0].get_legend_handles_labels()[1]
    with pytest.raises(fakir.errors.FitError, match="loading"):
        fakir.fit({**table, "branch": ["up"] * len(table)}, adhesive, free)
    assert any("Kendall" in work.text for work in fakir.cite(adhesive))
    sparse = adhesive.replace({"pattern.surface_fraction": 0.01})
    designed = fakir.design(sparse, "substrate.young_modulus", pull_off="15 uN")
    error = designed.cycle.pull_off.error.numerical
    assert abs(designed.cycle.pull_off.force / -15e-6 - 1) <= error
    assert "pull-off" in repr(designed) and designed.critical.force > 0
    with pytest.raises(TypeError, match="exactly one of"):
        fakir.design(sparse, "lens.radius", pull_off="15 uN", critical_force="1 mN")


class Curve:
    """What `fakir.fit` uses of a curve of afmformats, whose columns are in SI units."""

    metadata = {"spring constant": 0.05}  # noqa: RUF012

    def __init__(self):
        height = np.concatenate([np.linspace(2e-6, 1e-6, 10), np.full(2, 1e-6), np.linspace(1e-6, 2e-6, 10)])
        self._columns = {
            "force": np.maximum(1.5e-6 - height, 0.0) * 1e-3,
            "height (measured)": height,
            "time": np.arange(22.0),
            "segment": np.repeat([0, 2, 1], [10, 2, 10]).astype(np.uint8),
        }

    @property
    def columns(self):
        return list(self._columns)

    def __getitem__(self, name):
        return self._columns[name]

    def __contains__(self, name):
        return name in self._columns


def test_whatever_has_arrays_is_read():
    understood = fakir._fit._data(Curve(), {}, None).understood()
    assert understood[:4] == [
        'displacement: column 1 "displacement_m", in m',
        'force: column 2 "force_N", in N',
        'time: column 3 "time_s", in s',
        'branch: column 4 "branch"',
    ]
    rows = np.array([(1.0, 2.0), (2.0, 3.0)], dtype=[("z_um", float), ("force_uN", float)])
    expected = ['displacement: column 1 "z_um", in um', 'force: column 2 "force_uN", in uN']
    assert fakir._fit._data(rows, {}, None).understood() == expected
    xarray = pytest.importorskip("xarray")
    force = ("z", [2.0, 3.0], {"units": "uN"})
    dataset = xarray.Dataset({"force": force}, coords={"z": ("z", [1.0, 2.0], {"units": "um"})})
    found = fakir._fit._data(dataset, {}, None).understood()
    assert sorted(line.split(":")[0] for line in found) == ["displacement", "force"]
    assert all(", in u" in line for line in found)


def test_rows_are_selected(tmp_path):
    path = tmp_path / "cycles.csv"
    cycle = [0, 1, 2, 3, 4, 3, 2, 1]
    path.write_text("z_um,force_uN\n" + "".join(f"{z},{z * z}\n" for z in cycle + cycle))
    data = fakir._fit._data(path, {}, None)
    chosen = data.select([None, None], 2, "loading", [1.5e-6, None])
    assert "skipped: 13 rows not selected (lines 2 to 17)" in chosen.understood()
    with pytest.raises(fakir.FitError, match="there is no cycle 3"):
        data.select([None, None], 3, None, [None, None])
    with pytest.raises(ValueError, match='give "loading" or "unloading"'):
        data.select([None, None], None, "up", [None, None])


def test_the_relaxation_of_viscoelastic_bodies():
    """Expected: under an indentation that is reached at once and held F = F_relaxed (1 + 0.8 exp(-t/12 s)), exactly."""
    rubber = fakir.Substrate(1.6e6, 0.5)
    system = fakir.FlatSystem(fakir.ParaboloidLens(2e-3, 70e9, 0.2), rubber)
    relaxed = system.press(indentation=3e-6).force
    times = np.arange(0.0, 60.0, 1.0)
    data = {
        "time_s": times,
        "indentation_m": np.full(times.size, 3e-6),
        "force_N": relaxed * (1.0 + 0.8 * np.exp(-times / 12.0)) * (1.0 + 1e-5 * np.cos(7.0 * times)),
    }
    start = system.replace({"relaxation.strengths": "[0.5]", "relaxation.times": "[30 s]"})
    free = ["substrate.young_modulus", "relaxation.strengths[0]", "relaxation.times[0]"]
    with pytest.warns(fakir.FakirWarning, match="the first row is in contact already"):
        found = fakir.fit(data, start, free)
    values = [found[name].value for name in free]
    assert values == pytest.approx([1.6e6, 0.8, 12.0], rel=1e-4)
    with pytest.warns(fakir.FakirWarning, match="the forces depend on the rate"):
        fakir.fit(data, system, ["substrate.young_modulus"])
