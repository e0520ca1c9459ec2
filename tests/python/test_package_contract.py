"""Results have one contract: the program, the package and the page give the same object."""

import json
import os
import re
import signal
import subprocess
import tomllib
import urllib.request
from contextlib import contextmanager
from pathlib import Path

import fakir
import fastjsonschema
import numpy as np
import pytest

EXAMPLES = Path(__file__).parents[2] / "examples"
OVERRIDES = {"pattern.surface_fraction": 0.01}


def program(command, case, *arguments):
    """What ``fakir COMMAND --json`` prints."""
    run = [os.environ["FAKIR"], command, str(case), "--json", "--quiet", *arguments]
    done = subprocess.run(run, capture_output=True, text=True)
    assert done.stdout, done.stderr
    return json.loads(done.stdout)


def table(folder, name):
    """Columns of a table that was saved."""
    heading, *_ = (folder / name).read_text().splitlines()
    return heading.split(",")


def timeless(result):
    """A result with its names in their order, without values that differ between runs."""
    if isinstance(result, dict):
        return [(k, timeless(v)) for k, v in result.items() if not k.endswith("time_s")]
    return [timeless(v) for v in result] if isinstance(result, list) else result


@pytest.mark.parametrize(
    ("kind", "command", "case", "arguments"),
    [
        ("press", "press", "paper-intermediate.toml", ["--indentation", "1um", "--gradient"]),
        ("press", "press", "paper-intermediate.toml", ["--indentation", "3um"]),
        ("press", "press", "adhesive.toml", ["--indentation", "1um"]),
        ("transition", "transition", "paper-intermediate.toml", []),
        ("transition", "transition", "square.toml", []),
        ("surface_press", "press", "square-pillars.toml", ["--indentation", "0.5um"]),
        ("surface_transition", "transition", "square-pillars.toml", []),
        ("asperity_press", "press", "asperities.toml", ["--indentation", "1um"]),
        ("cycle", "cycle", "adhesive.toml", ["--set", "pattern.surface_fraction=0.003"]),
    ],
)
def test_results_match_the_schema(kind, command, case, arguments):
    printed = subprocess.run(
        [os.environ["FAKIR"], "results", "--schema"], capture_output=True, text=True, check=True
    )
    schema = json.loads(printed.stdout)
    published = Path(__file__).parents[2] / "book" / "pages" / "reference" / "results.schema.json"
    assert schema == json.loads(published.read_text()), "fakir results --schema writes it"
    of_kind = {**schema, "anyOf": [{"$ref": f"#/definitions/{kind}"}]}
    result = program(command, EXAMPLES / case, *arguments)
    fastjsonschema.validate(of_kind, result)
    for name in ["force_N", "critical_force_N"]:
        result.pop(name, None)
    with pytest.raises(fastjsonschema.JsonSchemaException):
        fastjsonschema.validate(of_kind, result)


@contextmanager
def exploring():
    """Runs the server of the page, and returns a function that sends requests as the page does."""
    command = [os.environ["FAKIR"], "explore", "--no-browser"]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    try:
        first = process.stderr.readline()
        address = re.search(r"(http://127\.0\.0\.1:\d+)/([0-9a-f]{32})/", first)
        asked = 0

        def ask(path, case, **more):
            nonlocal asked
            asked += 1
            ticket = {"session": "test", "sequence": asked}
            question = json.dumps({"ticket": ticket, "case": case, **more})
            headers = {"content-type": "application/json", "x-fakir-token": address.group(2)}
            request = urllib.request.Request(address.group(1) + path, question.encode(), headers)
            with urllib.request.urlopen(request) as answer:
                return answer.read().decode()

        yield ask
    finally:
        process.send_signal(signal.SIGINT)
        process.wait(timeout=20)
        process.stderr.close()


def keys(values, path=""):
    """The keys of a case file with their values."""
    found = {}
    for name, value in values.items():
        inner = f"{path}{name}"
        found |= keys(value, f"{inner}.") if isinstance(value, dict) else {inner: value}
    return found


def test_program_package_and_page_give_the_same_object():
    case = EXAMPLES / "paper-intermediate.toml"
    system = fakir.System.from_file(case, overrides=OVERRIDES)
    values = keys(tomllib.loads(case.read_text())) | OVERRIDES
    setting = "--set=pattern.surface_fraction=0.01"
    with exploring() as ask:
        expected = timeless(program("transition", case, setting))
        assert timeless(system.transition().to_dict()) == expected
        of_page = json.loads(ask("/api/export", values, file="summary.json"))
        assert timeless(of_page) == expected
        half = {"fraction": 0.5}
        of_page = json.loads(ask("/api/export", values, file="summary.json", load=half))
        indentation = of_page["indentation_m"]
        expected = timeless(program("press", case, setting, f"--indentation={indentation!r}m"))
        assert timeless(of_page) == expected
        pressed = system.press(indentation=indentation)
        assert timeless(pressed.to_dict()) == expected
        # The page draws the same object, before errors are estimated.
        lines = ask("/api/contact", values, load=half).splitlines()
        drawn = [json.loads(line) for line in lines]
        summary = next(line["state"]["summary"] for line in drawn if "state" in line)
        assert list(summary["relative_error_estimate"]) == list(pressed.error._asdict())[:3]
        summary["relative_error_estimate"] = of_page["relative_error_estimate"]
        assert timeless(summary) == expected
        heading = ask("/api/export", values, file="pillars.csv").splitlines()[0]
        assert heading.split(",") == list(system.transition().pillars.dtype.names)


def height_map(folder, *, floor=True):
    """A ridge along y under a lens: a case file, and the same in Python."""
    heights = np.zeros((96, 112))
    heights[:, 54:58] = 0.1e-6
    np.save(folder / "heights.npy", heights)
    case = folder / "case.toml"
    given = ", floor = 0" if floor else ""
    case.write_text(
        'lens = { radius = "1 mm", young_modulus = "2 MPa", poisson_ratio = 0.5 }\n'
        'substrate = { young_modulus = "2 MPa", poisson_ratio = 0.5 }\n'
        f'surface = {{ height_map = "heights.npy", cell_size = "1 um"{given} }}\n'
    )
    lens, substrate = fakir.Lens("1 mm", "2 MPa", 0.5), fakir.Substrate("2 MPa", 0.5)
    surface = fakir.bem.Surface(
        heights, lens, substrate, cell_size="1 um", floor=0.0 if floor else None
    )
    return case, surface


@pytest.mark.filterwarnings("ignore:the contact reaches the border")
@pytest.mark.parametrize("floor", [True, False])
def test_a_height_map_gives_the_same_object(tmp_path, floor):
    case, surface = height_map(tmp_path, floor=floor)
    expected = program("press", case, "--force=1uN")
    contact = surface.press(force="1 uN")
    pressed = contact.to_dict()
    assert timeless(pressed) == timeless(expected)
    assert {limit.name for limit in contact.limits} >= {"contact_stress", "cells_in_contact"}
    assert (pressed["tops"] is None) == (not floor)
    if floor:
        assert pressed["tops"]["contact_area_m2"] > 0.0
        expected = program("transition", case)
        assert timeless(surface.transition().to_dict()) == timeless(expected)


def test_a_surface_of_a_case_file_has_the_results_of_the_command(tmp_path):
    case = EXAMPLES / "square-pillars.toml"
    overrides = {"surface.grid.cells_per_diameter": 8}
    setting = "--set=surface.grid.cells_per_diameter=8"
    surface = fakir.bem.Surface.from_file(case, overrides=overrides)
    again = fakir.bem.Surface.from_toml(case.read_text(), overrides=overrides)
    assert np.array_equal(surface.heights, again.heights)
    assert surface.heights.shape == (len(surface.y), len(surface.x))
    assert surface.indenter == fakir.Lens("1 mm", "2 MPa", 0.5) and not surface.periodic
    expected = program("press", case, setting, "--indentation=1um")
    assert timeless(surface.press(indentation="1 um").to_dict()) == timeless(expected)
    path = ["--step=1um", "--to=3um", f"--output={tmp_path / 'out'}"]
    expected = program("approach", case, setting, *path)
    loading = surface.approach("1 um", to="3 um")
    assert timeless(loading.to_dict()) == timeless(expected)
    assert table(tmp_path / "out", "approach.csv") == list(loading.to_pandas())
    assert loading.critical is not None
    assert [state is loading.critical.contact for state in loading] == [
        row["critical"] for row in expected["states"]
    ]
    assert "critical" in repr(loading)
    expected = program("verify", case, "--indentation=0.6um")
    verification = surface.verify(indentation="0.6 um")
    assert timeless(verification.to_dict()) == timeless(expected)
    coarse, fine = verification.elements
    assert verification.agrees and coarse.surface.heights.size < fine.surface.heights.size
    assert "the answers agree" in repr(verification)


def test_a_loading_on_a_map_without_a_floor_needs_its_end(tmp_path):
    _, surface = height_map(tmp_path, floor=False)
    with pytest.raises(ValueError, match="give surface.floor"):
        surface.approach("0.1 um")
    loading = surface.approach("0.1 um", until="0.2 um")
    assert loading.critical is None and len(loading) == 3
    with pytest.raises(ValueError, match="defined on its own cells only"):
        surface.verify(indentation="0.1 um")


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::fakir.FakirWarning")
def test_tables_and_other_answers_are_the_same(tmp_path):
    case = EXAMPLES / "paper-intermediate.toml"
    overrides = {"pattern.surface_fraction": 0.003}
    system = fakir.System.from_file(case, overrides=overrides)

    def saved(command, *arguments):
        folder = tmp_path / command
        setting = "--set=pattern.surface_fraction=0.003"
        return folder, program(command, case, setting, "--output", str(folder), *arguments)

    folder, expected = saved("compare", "--threads=1")
    compared = system.compare(threads=1)
    assert timeless(compared.to_dict()) == timeless(expected)
    assert table(folder, "compare.csv") == list(compared.rows[0])
    assert compared.reference == expected["reference"]
    forms = [row["method"] for row in expected["methods"]]
    assert forms[: -len(compared.states)] == list(fakir.theory.closed_forms(system))

    _, expected = saved("verify", "--cells=16")
    assert timeless(system.verify(cells_per_diameter=16).to_dict()) == timeless(expected)

    _, expected = saved("theory")
    assert timeless(fakir.theory.to_dict(system)) == timeless(expected)
    constants = expected["constants"]
    assert fakir.theory.constants(system).reduced_modulus == constants["reduced_modulus_Pa"]
    # Names that are not in the list, as they are null there, can still be requested separately.
    assert fakir.theory.small_contact(system).force > 0.0

    _, expected = saved("design", "--free=pitch", "--critical-force=50uN")
    found = fakir.design(system, "pattern.pitch", critical_force="50 uN")
    assert found.to_dict()["design"]["statement"] == expected["design"]["statement"]
    assert timeless(found.to_dict()) == timeless(expected)

    _, expected = saved("design", "--free=pitch", "--floor-share=20%", "--at-indentation=8um", "--overwrite")
    found = fakir.design(system, "pattern.pitch", floor_share="20%", at_indentation="8 um")
    assert timeless(found.to_dict()) == timeless(expected)

    sampled = ["--tolerance=pattern.pillar.height=3%", "--samples=5", "--seed=1"]
    folder = tmp_path / "spread"
    setting = "--set=pattern.surface_fraction=0.003"
    expected = program("design", case, setting, *sampled, f"--output={folder}")
    spread = fakir.spread(system, {"pattern.pillar.height": "3 %"}, samples=5, seed=1)
    assert timeless(spread.to_dict()) == timeless(expected)
    assert table(folder, "samples.csv") == list(spread.to_pandas())


CASES = [path for path in sorted(EXAMPLES.glob("**/*.toml")) if "[axes]" not in path.read_text()]


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_every_example_of_a_case_is_read(path):
    text = path.read_text()
    if "top_radius = " in text:
        assert len(fakir.AsperityArray.from_file(path)) > 1
        return
    if "\n[surface" not in text and "\n[pattern" not in text:
        flat = fakir.read_case(path)
        assert type(flat) is fakir.FlatSystem
        assert fakir.FlatSystem.from_toml(flat.to_toml()).to_toml() == flat.to_toml()
        return
    kind = fakir.bem.Surface if "[surface]" in text else fakir.System
    systems = [fakir.System.from_file(path)]
    # A text has no folder in which a table of pillars, or of heights of a lens, could be.
    if "pillars = " not in text and "profile = " not in text:
        systems.append(fakir.System.from_toml(text))
    for system in systems:
        assert type(system) is kind
        again = fakir.System.from_toml(system.to_toml())
        assert again.to_toml() == system.to_toml()


def test_a_surface_of_an_array_has_no_case_file(tmp_path):
    case, surface = height_map(tmp_path)
    with pytest.raises(ValueError, match="save the array"):
        surface.to_toml()
    read = fakir.System.from_file(case, overrides={"surface.floor": "10 nm"})
    assert isinstance(read, fakir.bem.Surface)
    assert str(tmp_path / "heights.npy") in read.to_toml()


@pytest.mark.slow
def test_a_study_of_surfaces_gives_the_table_of_the_program(tmp_path):
    study = EXAMPLES / "study-square-pillars.toml"
    out = tmp_path / "out"
    arguments = ["sweep", str(study), "--output", str(out), "--quiet"]
    subprocess.run([os.environ["FAKIR"], *arguments], check=True, stdout=subprocess.DEVNULL)
    table = (out / "table.csv").read_text()
    assert fakir.sweep(study).to_csv() == table
    surface = fakir.System.from_file(
        EXAMPLES / "square-pillars.toml", overrides={"surface.grid.cells_per_diameter": 8}
    )
    tables = {
        "study": {"question": "press"},
        "system": surface,
        "axes": {
            "surface.surface_fraction": [0.2],
            "surface.pillar.height": ["0.6 um"],
            "indentation": ["2 um"],
        },
    }
    done = fakir.sweep(tables)
    row = done.rows[0]
    assert [row["force_N"], row["contact_area_m2"]] == [
        float(value) for value in (table.splitlines()[11].split(",")[i] for i in (6, 12))
    ]
    assert done.to_xarray().floor_force_N.attrs == {"units": "N"}
