"""Files and objects of other libraries: curves, height maps and tables of pillars, as these libraries write them.

Curves are those of Hertz (paraboloid on a half-space): a fit finds the modulus and the contact point with which they were computed. Height maps are compared with the arrays from which they were written. `other-libraries.txt` lists the libraries; they are imported
in the tests, so that one that is missing is an error.
"""

import json
import math

import numpy as np
import pandas
import pytest

import fakir

pytestmark = pytest.mark.slow

RADIUS, MODULUS, CONTACT, STIFFNESS = 1e-3, 2e6, 0.5e-6, 5.0
FREE = ["substrate.young_modulus", "contact_point"]
NAMES = ["z [um]", "Force [uN]"]


@pytest.fixture(scope="module")
def system():
    lens = fakir.ParaboloidLens(RADIUS, "70 GPa", 0.22)
    return fakir.FlatSystem(lens, fakir.Substrate("1 MPa", 0.5))


@pytest.fixture(scope="module")
def curve(system):
    """Positions (m) and forces (N): F = 4/3 E* sqrt(R) d^(3/2)."""
    z = np.linspace(-1e-6, 4e-6, 51)
    reduced = 1 / ((1 - 0.5**2) / MODULUS + (1 - 0.22**2) / 70e9)
    return z, 4 / 3 * reduced * math.sqrt(RADIUS) * np.maximum(z - CONTACT, 0) ** 1.5


@pytest.fixture(scope="module")
def rows(curve):
    """In um and uN."""
    return np.column_stack(curve) * 1e6


@pytest.fixture
def check(system):
    """Fits what a library wrote."""

    def fit(measurements, **options):
        found = fakir.fit(measurements, system, FREE, **options)
        assert found["substrate.young_modulus"].value == pytest.approx(MODULUS, rel=1e-4)
        assert found.contact_point == pytest.approx(CONTACT, abs=1e-10)
        return found

    return fit


def refused(measurements, system, *words, **options):
    with pytest.raises((fakir.FitError, TypeError)) as error:
        fakir.fit(measurements, system, FREE, **options)
    for word in words:
        assert word in str(error.value)


# Curves of AFMs


def afm_curve(curve, position, kind, segments):
    """A curve of afmformats; the segments are numbers, and what happens in them."""
    import afmformats.afm_data
    import afmformats.mod_creep_compliance
    import afmformats.mod_force_distance
    import afmformats.mod_stress_relaxation

    z, force = curve
    parts = {
        "approach": (z, force),
        "retract": (z[::-1], force[::-1]),
        # Not a state of the system: the force of a pause differs from that of the approach.
        "pause": (np.full(20, z[-1]), np.full(20, 0.5 * force[-1])),
    }
    base, load = (np.concatenate([parts[name][axis] for _, name in segments]) for axis in (0, 1))
    number = np.concatenate([np.full(len(parts[name][0]), k) for k, name in segments])
    if position != "tip position":
        base = base + load / STIFFNESS
    columns = {
        "force": load,
        position: 20e-6 - base,
        "segment": number.astype(np.uint8),
        "time": np.arange(len(load)) * 1e-3,
    }
    metadata = {
        "spring constant": STIFFNESS,
        "imaging mode": kind,
        "enum": 0,
        "path": "curve.jpk-force",
        "point count": len(load),
    }
    classes = {
        "force-distance": afmformats.mod_force_distance.AFMForceDistance,
        "creep-compliance": afmformats.mod_creep_compliance.AFMCreepCompliance,
        "stress-relaxation": afmformats.mod_stress_relaxation.AFMStressRelaxation,
    }
    return classes[kind](columns, metadata)


KINDS = [
    ("force-distance", [(0, "approach"), (1, "retract")]),
    ("creep-compliance", [(0, "approach"), (1, "pause"), (2, "retract")]),
    ("stress-relaxation", [(0, "pause"), (1, "approach"), (2, "pause"), (3, "retract")]),
]


@pytest.mark.parametrize("position", ["tip position", "height (measured)", "height (piezo)"])
@pytest.mark.parametrize(("kind", "segments"), KINDS)
def test_curves_of_afmformats(curve, system, position, kind, segments):
    made = afm_curve(curve, position, kind, segments)
    found = fakir.fit(made, system, FREE)
    assert found["substrate.young_modulus"].value == pytest.approx(MODULUS, rel=1e-4)
    # The positions are 20 um minus the heights.
    assert found.contact_point + 20e-6 == pytest.approx(CONTACT, abs=1e-10)
    assert found.machine_compliance == pytest.approx(0.0 if position == "tip position" else 1 / STIFFNESS)
    count = len(curve[0])
    assert found.degrees_of_freedom == 2 * count - 2
    assert fakir.fit(made, system, FREE, branch="unloading").degrees_of_freedom == count - 2


def test_files_and_groups_of_afmformats(curve, system, tmp_path):
    import afmformats

    kind, segments = KINDS[0]
    made = afm_curve(curve, "height (measured)", kind, segments)
    made.export_data(tmp_path / "curve.tab")
    found = fakir.fit(tmp_path / "curve.tab", system, FREE)
    # Eight digits are in the file.
    assert found["substrate.young_modulus"].value == pytest.approx(MODULUS, rel=1e-3)
    assert found.machine_compliance == pytest.approx(1 / STIFFNESS)
    made.export_data(tmp_path / "curve.h5", fmt="hdf5")
    refused(tmp_path / "curve.h5", system, "HDF5", "h5py", "afmformats")
    group = afmformats.load_data(tmp_path / "curve.h5")
    refused(group, system, "give one of its curves")
    refused(afmformats.AFMGroup(tmp_path / "curve.h5"), system, "give one of its curves")
    refused(group[0].appr, system, "a whole curve of afmformats")
    assert fakir.fit(group[0], system, FREE).machine_compliance == pytest.approx(1 / STIFFNESS)


# Spreadsheets


def workbook(path, *sheets):
    import openpyxl

    book = openpyxl.Workbook()
    book.remove(book.active)
    for name, rows in sheets:
        sheet = book.create_sheet(name)
        for row in rows:
            sheet.append(list(row))
    book.save(path)
    return path


def test_spreadsheets_of_openpyxl(rows, check, tmp_path):
    data = [[float(z), float(force)] for z, force in rows]
    remarks = [[*row, "contact" if index == 30 else None] for index, row in enumerate(data)]
    notes = [["Experiment", 12], ["Radius", 1.0, "mm"], [], ["by hand"]]
    above = [["Sample 3"], ["Radius", 1.0, "mm"], []]
    texts = [[f"{value:.9f}".replace(".", ",") for value in row] for row in data]
    for number, sheets in enumerate([
        [("data", [NAMES, *data])],
        [("data", [["z", "Force"], ["um", "uN"], *data])],
        [("data", [*above, ["z", "Force", "remark"], ["um", "uN"], [], *remarks])],
        [("notes", notes), ("empty", []), ("data", [NAMES, *data])],
        [("data", [[], [None, *NAMES], *([None, *row] for row in data)])],
        [("data", [NAMES, *texts])],
        [("data", [[*NAMES, "Time [s]"], *data, [9.0, None, None], [None, None, 3.0]])],
    ]):
        check(workbook(tmp_path / f"{number}.xlsx", *sheets))


def test_formulas(rows, check, system, tmp_path):
    import xlsxwriter

    formulas = [[float(z), f"=A{line}^1.5"] for line, (z, _) in enumerate(rows, start=2)]
    path = workbook(tmp_path / "open.xlsx", ("data", [NAMES, *formulas]))
    refused(path, system, "cell B2 contains a formula and no value", "save it again")
    path = workbook(tmp_path / "open.xlsx", ("notes", [["Sample 3"]]), ("data", [NAMES, *formulas]))
    refused(path, system, "cell B2 contains a formula and no value")
    path = tmp_path / "values.xlsx"
    with xlsxwriter.Workbook(path) as book:
        sheet = book.add_worksheet("data")
        percent = book.add_format({"num_format": "0.00%"})
        sheet.write_row(0, 0, NAMES)
        for line, (z, force) in enumerate(rows, start=1):
            sheet.write_number(line, 0, z, percent)
            sheet.write_formula(line, 1, f"=A{line + 1}^1.5", None, force if line > 3 else "#NUM!")
    check(path)


# Text


def test_tables_of_pandas_and_numpy(rows, check, system, tmp_path):
    table = pandas.DataFrame(rows, columns=NAMES)
    check(table)
    for number, options in enumerate([
        {},
        {"sep": "\t"},
        {"sep": ";", "decimal": ","},
        {"sep": ";", "decimal": ",", "encoding": "utf-16"},
        {"sep": ";", "decimal": ",", "encoding": "utf-8-sig", "index": False},
        {"decimal": ","},
        {"float_format": "%.8e", "quoting": 1},
        {"compression": "gzip"},
    ]):
        table.to_csv(tmp_path / f"{number}.csv", **options)
        check(tmp_path / f"{number}.csv")
    table.to_excel(tmp_path / "pandas.xlsx")
    check(tmp_path / "pandas.xlsx")
    path = tmp_path / "numpy.txt"
    for options in [
        {"header": "z_um force_uN"},
        {"header": ",".join(NAMES), "delimiter": ","},
        {"header": "\t".join(NAMES), "delimiter": "\t", "comments": "", "fmt": "%.8g"},
        {"header": "Sample 3\nz_um; force_uN", "delimiter": ";", "comments": "% "},
    ]:
        np.savetxt(path, rows, **options)
        check(path)
    np.savetxt(path, rows)
    refused(path, system, "name them by hand by their numbers")
    check(path, columns={"displacement": "#1 [um]", "force": "#2 [uN]"})


def test_what_is_not_read(rows, system, tmp_path):
    import h5py

    table = pandas.DataFrame(rows, columns=NAMES)
    for suffix, write, words in [
        ("npz", lambda path: np.savez(path, z=rows), ["NumPy arrays", "numpy.load"]),
        ("npy", lambda path: np.save(path, rows), ["NumPy", "numpy.savetxt"]),
        ("h5", lambda path: h5py.File(path, "w").close(), ["HDF5", "h5py"]),
        ("parquet", table.to_parquet, ["Parquet", "pandas"]),
        ("feather", table.to_feather, ["Feather", "pandas"]),
        ("zip", lambda path: table.to_csv(path), ["unpack it first"]),
        ("zst", lambda path: path.write_bytes(b"\x28\xb5\x2f\xfd\x24\x00"), ["unzstd"]),
        ("nc", lambda path: table.to_xarray().to_netcdf(path, format="NETCDF3_64BIT"), ["NetCDF", "xarray"]),
        ("pkl", table.to_pickle, ["is no text", "CSV"]),
    ]:
        path = tmp_path / f"table.{suffix}"
        write(path)
        refused(path, system, *words)


# Tables of pillars


def test_pillars(tmp_path):
    places = np.array([[10.0, 0.0], [30.0, 5.0], [10.0, 40.0]])
    names = ["x [um]", "y [um]", "diameter [um]"]
    table = pandas.DataFrame(np.column_stack([places, [4.0, 6.0, np.nan]]), columns=names)
    notes = ("notes", [["Wafer", 7]])
    cells = [[*row[:2], None if math.isnan(row[2]) else row[2]] for row in table.to_numpy().tolist()]
    written = [
        workbook(tmp_path / "openpyxl.xlsx", notes, ("data", [names, *cells])),
        workbook(tmp_path / "units.xlsx", ("data", [["x", "y", "diameter"], ["um"] * 3, *cells])),
    ]
    table.to_excel(tmp_path / "pandas.xlsx")
    written.append(tmp_path / "pandas.xlsx")
    for number, options in enumerate([{}, {"sep": ";", "decimal": ","}, {"sep": "\t", "index": False}]):
        written.append(tmp_path / f"{number}.csv")
        table.to_csv(written[-1], **options)
    for path in written:
        case = (
            'lens = { radius = "1 mm", young_modulus = "2 MPa", poisson_ratio = 0.5 }\n'
            'substrate = { young_modulus = "2 MPa", poisson_ratio = 0.5 }\n'
            f'[pattern]\npillars = {json.dumps(str(path))}\npillar = {{ height = "2 um", diameter = "5 um" }}\n'
        )
        pattern = fakir.System.from_toml(case).pattern
        assert np.allclose([pattern.x, pattern.y], 1e-6 * places.T, rtol=1e-12), path
        assert np.allclose(pattern.diameter, [4e-6, 6e-6, 5e-6], rtol=1e-12), path


# Height maps

GREY = np.random.default_rng(7).integers(0, 65536, (37, 29)).astype(np.uint16)
HEIGHTS = GREY * 1e-12


def surface(path, size='cell_size = "1 um"'):
    return fakir.bem.Surface.from_toml(
        'lens = { radius = "1 mm", young_modulus = "2 MPa", poisson_ratio = 0.5 }\n'
        'substrate = { young_modulus = "2 MPa", poisson_ratio = 0.5 }\n'
        f"[surface]\nheight_map = {json.dumps(str(path))}\n{size}\n"
    )


RANGE = 'cell_size = "1 um"\nheight_range = "65.535 nm"'


def check_image(path, heights):
    """The first row of an image has the largest y."""
    found = surface(path, RANGE if heights.dtype == np.uint16 else 'cell_size = "1 um"')
    expected = HEIGHTS if heights.dtype == np.uint16 else heights
    assert np.allclose(found.heights, expected[::-1], rtol=1e-12, atol=1e-24), path


@pytest.mark.parametrize("kind", ["u2", "f4", "f8"])
def test_images_of_tifffile(kind, tmp_path):
    import tifffile

    heights = GREY if kind == "u2" else HEIGHTS.astype(kind)
    for number, options in enumerate([
        {},
        {"byteorder": ">"},
        {"rowsperstrip": 5},
        {"tile": (16, 32)},
        {"resolution": (1e4, 1e4), "resolutionunit": "CENTIMETER"},
        {"compression": "deflate"},
        {"compression": "deflate", "predictor": True, "byteorder": ">"},
        {"compression": "lzw", "predictor": True},
        {"compression": "lzw", "tile": (32, 16), "predictor": True},
        {"compression": "packbits", "rowsperstrip": 1},
    ]):
        path = tmp_path / f"{number}.tif"
        tifffile.imwrite(path, heights, **options)
        check_image(path, heights)
    if kind != "f8":
        tifffile.imwrite(path, heights, imagej=True, resolution=(2.0, 2.0), metadata={"unit": "um"})
        check_image(path, heights)


def test_images_that_are_not_read(tmp_path):
    import tifffile
    from PIL import Image

    path = tmp_path / "image.tif"
    for heights, options, words in [
        (GREY, {"compression": "zstd"}, "packed by method 50000"),
        (GREY, {"bigtiff": True}, "bigtiff=False"),
        (GREY.astype("i2"), {}, "1 signed integers of 16 bits"),
        (GREY.astype("u1"), {}, "1 unsigned integers of 8 bits"),
        (np.stack([GREY] * 3, axis=-1), {"photometric": "rgb"}, "3 unsigned integers of 16 bits"),
    ]:
        tifffile.imwrite(path, heights, **options)
        with pytest.raises(fakir.CaseError, match=words):
            surface(path, RANGE)
    Image.fromarray((GREY >> 8).astype(np.uint8)).save(tmp_path / "grey.png")
    with pytest.raises(fakir.CaseError, match="8 bits: export the heights as a grey image of 16 bits"):
        surface(tmp_path / "grey.png", RANGE)


def test_images_of_pillow(tmp_path):
    from PIL import Image

    for optimize in (False, True):
        Image.fromarray(GREY).save(tmp_path / "grey.png", optimize=optimize)
        check_image(tmp_path / "grey.png", GREY)
    for compression in ["raw", "tiff_lzw", "tiff_adobe_deflate", "packbits"]:
        for heights in (GREY, HEIGHTS.astype("f4")):
            Image.fromarray(heights).save(tmp_path / "image.tif", compression=compression)
            check_image(tmp_path / "image.tif", heights)


LENS, RUBBER = fakir.Lens("1 mm", "2 MPa", 0.5), fakir.Substrate("2 MPa", 0.5)


def topography(missing=False, **options):
    """Heights in um on 6 by 4 points of 2 um, the first index along x."""
    import SurfaceTopography

    heights = np.random.default_rng(1).normal(0.0, 0.1, (6, 4))
    if missing:
        heights = np.ma.masked_array(heights, mask=heights == heights[1, 2])
    return SurfaceTopography.Topography(heights, physical_sizes=(12.0, 8.0), unit="um", **options)


def test_objects_of_surface_topography():
    made = topography()
    expected = 1e-6 * made.heights().T
    for given in (made, made.to_unit("nm")):
        found = fakir.bem.Surface(given, LENS, RUBBER)
        assert np.allclose(found.heights, expected, rtol=1e-12)
        assert np.allclose([np.diff(found.x), np.diff(found.x)], 2e-6) and not found.periodic
    assert fakir.bem.Surface(topography(periodic=True), LENS, RUBBER).periodic
    assert fakir.bem.Surface(made.detrend(), LENS, RUBBER).heights.shape == (4, 6)
    holes = topography(missing=True)
    with pytest.raises(ValueError, match="interpolate_undefined_data"):
        fakir.bem.Surface(holes, LENS, RUBBER)
    filled = fakir.bem.Surface(holes.interpolate_undefined_data(), LENS, RUBBER).heights
    assert np.isclose(filled, expected, rtol=1e-12).sum() == 23


def test_files_of_surface_topography(tmp_path):
    made = topography()
    made.to_matrix(tmp_path / "map.txt")
    np.save(tmp_path / "map.npy", made.heights().T)
    for kind in "DFLI":
        made.to_x3p(tmp_path / f"{kind}.x3p", dtype=kind)
    range_um = np.ptp(made.heights())
    for name, digits in [
        ("map.txt", 1e-15),
        ("D.x3p", 1e-15),
        ("F.x3p", 2**-24),
        ("L.x3p", range_um / 2**32),
        # Heights are rounded to 65536 values.
        ("I.x3p", range_um / 2**16),
    ]:
        found = surface(tmp_path / name, "")
        assert np.abs(found.heights - 1e-6 * made.heights().T).max() < 1e-6 * digits, name
        assert np.allclose(np.diff(found.x), 2e-6), name
    from_array = surface(tmp_path / "map.npy", 'cell_size = "2 um"\nheight_unit = "1 um"')
    assert np.allclose(from_array.heights, 1e-6 * made.heights().T, rtol=1e-12)
    holes = topography(missing=True)
    for kind in "DI":
        holes.to_x3p(tmp_path / "holes.x3p", dtype=kind)
        with pytest.raises(fakir.CaseError, match="1 of 24 heights are missing"):
            surface(tmp_path / "holes.x3p", "")
    made.to_netcdf(tmp_path / "map.nc")
    with pytest.raises(fakir.CaseError, match="a NetCDF file: read it with SurfaceTopography"):
        surface(tmp_path / "map.nc", "")
    made.to_gwy(str(tmp_path / "map.gwy"))
    with pytest.raises(fakir.CaseError, match="a Gwyddion file: open it in Gwyddion"):
        surface(tmp_path / "map.gwy", "")


def test_files_of_surfalize(tmp_path):
    import surfalize

    heights = np.random.default_rng(1).normal(0.0, 0.1, (4, 6))
    made = surfalize.Surface(heights, 2.0, 2.0)
    for name, options in [("map.x3p", {}), ("binary.sdf", {}), ("ascii.sdf", {"binary": False})]:
        made.save(tmp_path / name, **options)
        found = surface(tmp_path / name, "")
        assert np.abs(found.heights - 1e-6 * heights).max() < 1e-16, name
        assert np.allclose(np.diff(found.x), 2e-6), name
    for name, words in [("map.sur", "a Digital Surf file"), ("map.al3d", "an Alicona file")]:
        made.save(tmp_path / name)
        with pytest.raises(fakir.CaseError, match=f"{words}: open it in Gwyddion"):
            surface(tmp_path / name, "")
    heights[1, 2] = np.nan
    surfalize.Surface(heights, 2.0, 2.0).save(tmp_path / "holes.sdf")
    with pytest.raises(fakir.CaseError, match="1 of 24 heights are missing"):
        surface(tmp_path / "holes.sdf", "")
