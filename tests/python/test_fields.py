"""fields.nc and fields.vti, as xarray and VTK read them."""

import json

import numpy as np
import pytest
import xarray
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLImageDataReader

UNITS = {"pressure": "Pa", "gap": "m", "displacement": "m"}


def read_vti(folder):
    reader = vtkXMLImageDataReader()
    reader.SetFileName(str(folder / "fields.vti"))
    reader.Update()
    return reader.GetOutput()


def force_of(data):
    """Integral of the pressure, cell by cell."""
    cell = float(data.x[1] - data.x[0]) * float(data.y[1] - data.y[0])
    return float(data.pressure.sum()) * cell


def test_dimensions_coordinates_and_units(critical):
    folder, summary = critical
    with xarray.open_dataset(folder / "fields.nc") as data:
        assert data.sizes == {"y": 1001, "x": 1001}
        for name in ["x", "y"]:
            assert data[name].dims == (name,)
            assert data[name].attrs["units"] == "m"
            assert data[name].attrs["long_name"].endswith(name)
            assert np.ptp(np.diff(data[name])) < 1e-12 * float(data[name].max())
        # The contact and a pitch more on each side.
        reach = summary["top_contact_radius_m"] + summary["pitch_m"]
        assert float(data.x[-1]) == pytest.approx(reach, rel=1e-12)
        for name, unit in UNITS.items():
            assert data[name].dims == ("y", "x")
            assert data[name].dtype == np.float64
            assert data[name].attrs["units"] == unit
            assert np.isfinite(data[name]).all()
        assert data.on_pillar.dtype == np.int8
        assert set(np.unique(data.on_pillar)) == {0, 1}
        assert data.attrs["Conventions"] == "CF-1.8"
        assert "10.1103/PhysRevE.104.055007" in data.attrs["references"]
        assert data.attrs["force_N"] == summary["critical_force_N"]
        assert data.attrs["indentation_m"] == summary["critical_indentation_m"]


def test_the_file_has_the_case_it_is_from(critical):
    folder, summary = critical
    provenance = json.loads((folder / "provenance.json").read_text())
    with xarray.open_dataset(folder / "fields.nc") as data:
        assert data.attrs["case"] == provenance["case"]
        assert data.attrs["method"] == provenance["method"]
        assert data.attrs["source"] == "fakir " + summary["fakir_version"]


def test_pillars_carry_the_force(critical):
    folder, summary = critical
    with xarray.open_dataset(folder / "fields.nc") as data:
        assert float(data.pressure.where(data.on_pillar == 0).max()) == 0.0
        # The pressure is singular at the rims: a sum over points converges as their distance to
        # the power 1/2 only, here a 25th of the pillar radius.
        force = summary["critical_force_N"]
        assert force_of(data) == pytest.approx(force, rel=0.05)
        # The fraction of points on pillars is the surface fraction, 0.01, up to the border.
        fraction = float(data.on_pillar.mean())
        assert fraction == pytest.approx(summary["surface_fraction"], rel=0.2)


def test_the_lens_just_reaches_the_floor(critical):
    folder, summary = critical
    with xarray.open_dataset(folder / "fields.nc") as data:
        floor = data.gap.where(data.on_pillar == 0)
        # Quadratic around the floor contact: far less than the height of 2.2 um, never negative.
        assert 0.0 <= float(floor.min()) < 1e-4 * 2.2e-6
        x, y = summary["floor_contact_m"]
        nearest = floor.sel(x=x, y=y, method="nearest")
        assert float(nearest) < 1e-3 * 2.2e-6
        # In contact the gap is zero.
        loaded = data.gap.where(data.pressure > 0.0)
        assert float(np.abs(loaded).max()) < 1e-3 * 2.2e-6


def test_vtk_has_the_same_numbers(critical):
    folder, _ = critical
    image = read_vti(folder)
    with xarray.open_dataset(folder / "fields.nc") as data:
        assert image.GetDimensions() == (1001, 1001, 1)
        for axis, name in enumerate("xy"):
            values = data[name].values
            assert image.GetOrigin()[axis] == values[0]
            last = image.GetOrigin()[axis] + 1000 * image.GetSpacing()[axis]
            assert last == values[-1]
        points = image.GetPointData()
        assert points.GetScalars().GetName() == "pressure_Pa"
        names = {f"{name}_{unit}": name for name, unit in UNITS.items()}
        for name, variable in {**names, "on_pillar": "on_pillar"}.items():
            values = vtk_to_numpy(points.GetArray(name)).reshape(1001, 1001)
            assert values.dtype == data[variable].dtype
            assert np.array_equal(values, data[variable].values)
        texts = image.GetFieldData()
        for name in ["title", "source", "method", "references", "case"]:
            assert texts.GetAbstractArray(name).GetValue(0) == data.attrs[name]
        for name in ["force_N", "indentation_m"]:
            assert texts.GetArray(name).GetValue(0) == data.attrs[name]


def test_an_untouched_pattern_is_bare(fakir):
    folder, _ = fakir("press", "paper-intermediate.toml", "--indentation", "0um")
    with xarray.open_dataset(folder / "fields.nc") as data:
        assert data.sizes["x"] % 2 == 1  # the lens axis is a point
        assert float(np.abs(data.pressure).max()) == 0.0
        assert float(np.abs(data.displacement).max()) == 0.0
        # The sphere of 2.2 mm above tops and floor.
        sag = 2.2e-3 - np.sqrt(2.2e-3**2 - data.x**2 - data.y**2)
        expected = sag + xarray.where(data.on_pillar == 1, 0.0, 2.2e-6)
        assert float(np.abs(data.gap - expected).max()) < 1e-15


def test_a_surface_has_the_fields_of_its_cells(surface):
    folder, summary = surface
    image = read_vti(folder)
    with xarray.open_dataset(folder / "fields.nc") as data:
        assert data.sizes["x"] == summary["grid"]["columns"]
        cell = summary["grid"]["cell_m"]
        assert float(data.x[1] - data.x[0]) == pytest.approx(cell[0], rel=1e-9)
        left = summary["grid"]["origin_m"][0] + 0.5 * cell[0]
        assert float(data.x[0]) == pytest.approx(left, rel=1e-12)
        # Constant on each cell, so that the sum is the force.
        assert force_of(data) == pytest.approx(summary["force_N"], rel=1e-9)
        for name in ["pressure", "gap"]:
            assert np.array_equal(data[name], np.load(folder / f"{name}.npy"))
        assert np.array_equal(data.height, np.load(folder / "heights.npy"))
        pressure = vtk_to_numpy(image.GetPointData().GetArray("pressure_Pa"))
        assert np.array_equal(pressure.reshape(data.pressure.shape), data.pressure)


def test_a_flat_surface_has_maps_around_its_axis(fakir):
    """Without adhesion, whose tension at the rim is infinite, the sum of the pressure is the force; the gap is zero in the contact alone."""
    dry = ["--set", "adhesion.work=0", "--set", "adhesion.work_receding=0"]
    folder, summary = fakir("press", "flat.toml", "--force", "5mN", "--field-points", "100", *dry)
    with xarray.open_dataset(folder / "fields.nc") as data:
        assert data.sizes == {"y": 100, "x": 100} and "on_pillar" not in data
        assert force_of(data) == pytest.approx(summary["force_N"], rel=2e-3)
        for name in UNITS:
            values = data[name].values
            for other in (values.T, values[::-1], values[:, ::-1]):
                np.testing.assert_allclose(values, other, rtol=1e-9, atol=0)
        inside = np.hypot(*np.meshgrid(data.x, data.y)) <= summary["contact_radius_m"]
        assert (data.gap.values[inside] == 0).all() and (data.gap.values[~inside] > 0).all()
