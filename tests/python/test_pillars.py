"""pillars.csv, as pandas reads it."""

import numpy as np
import pandas
import pytest
import xarray


def test_forces_add_up(critical):
    folder, summary = critical
    pillars = pandas.read_csv(folder / "pillars.csv")
    assert len(pillars) == summary["pillars_in_contact"]
    partial = (pillars.status == "partial").sum()
    assert partial == summary["pillars_partially_in_contact"]
    # As many digits as identify every number.
    assert pillars.force_N.sum() == pytest.approx(summary["critical_force_N"], rel=1e-12)
    # Nearest to the lens axis first, equal distances up to rounding.
    radius = np.hypot(pillars.x_m, pillars.y_m)
    assert np.all(np.diff(radius) > -1e-12 * radius.max())


def test_centre_pressures_are_those_of_the_map(critical):
    folder, _ = critical
    pillars = pandas.read_csv(folder / "pillars.csv")
    with xarray.open_dataset(folder / "fields.nc") as data:
        # The lens axis is a point of the map and the centre of the first pillar.
        at_axis = data.pressure.sel(x=0.0, y=0.0)
        # The map has means over cells, of a side s in pillar radii: over such a cell the pressure of a flat
        # punch, p/sqrt(1 - r^2), is p (1 + s^2/12) on the average; the lens is a little curved.
        side = float(data.x[1] - data.x[0]) / 3e-6
        mean = pillars.centre_pressure_Pa[0] * (1.0 + side**2 / 12.0)
        assert float(at_axis) == pytest.approx(mean, rel=2e-4)
