"""The JSON Schema of case and study files: it accepts every example, and rejects every malformed file of the tests that it can."""

import json
import os
import re
import subprocess
import sysconfig
import tomllib
from pathlib import Path

import jsonschema
import pytest

ROOT = Path(__file__).parents[2]
PUBLISHED = ROOT / "book" / "pages" / "reference" / "case.schema.json"
MALFORMED = ROOT / "crates" / "fakir-case" / "tests"

# Malformed files that a schema cannot reject, by the reason. The program rejects them when it reads the case.
REASONS = {
    "a comparison of numbers, or of quantities in units": [
        "adhesion_receding_below_advancing",
        "adhesion_axis_above_receding",
        "case_bad_by_the_axis_alone",
        "case_bad_with_other_axis",
        "case_first_bad",
        "case_first_bad_in_the_same_file",
        "diameter_above_pitch",
        "film_lower_than_its_pillars",
        "film_thinner_than_a_quarter_pillar",
        "height_above_lens_radius",
        "height_standard_deviation_too_large",
        "oblique_overlap",
        "pillars_drop_above_height",
        "pillars_minimum_distance_too_small",
        "pillars_overlap",
        "pillars_too_crowded",
        "pillars_too_many_cells",
        "range_decreasing",
        "range_into_the_impossible",
        "range_of_nothing",
        "square_too_dense",
    ],
    "a count over several axes": ["too_many_cases", "zip_of_unequal_lengths"],
    "JSON has no such number": ["list_with_nan", "map_floor_nan", "nan", "press_load_nan", "range_infinite", "surface_fraction_nan"],
    "what a method supports": [
        "adhesion_of_another_method",
        "adhesion_with_axis_of_methods",
        "cycle_of_a_surface",
        "cycle_of_a_work_of_zero",
        "cycle_without_adhesion",
    ],
    "the content of another file": [
        "axis_of_a_surface",
        "bad_case_in_the_case_file",
        "case_of_a_surface",
        "case_with_key_of_another_method",
        "listed_pillars_without_file",
        "map_no_numbers",
        "map_no_such_array",
        "map_not_numpy",
        "map_of_one_dimension",
        "map_ragged",
        "map_several_arrays",
        "map_with_nan",
        "map_without_size",
        "no_such_case",
    ],
}
BEYOND = {name: reason for reason, names in REASONS.items() for name in names}

SCHEMA = json.loads(PUBLISHED.read_text(encoding="utf-8"))
VALIDATOR = jsonschema.Draft7Validator(SCHEMA)
# Without conditions between keys: for parts of files.
PARTS = jsonschema.Draft7Validator({**SCHEMA, "allOf": []})


def problems(text, validator=VALIDATOR):
    """What is wrong with a text, or nothing."""
    try:
        document = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        return [str(error)]
    return [error.message for error in validator.iter_errors(document)]


def test_the_program_prints_the_published_schema():
    printed = subprocess.run([os.environ["FAKIR"], "init", "--schema"], capture_output=True, text=True, check=True)
    assert json.loads(printed.stdout) == SCHEMA, "fakir init --schema > book/pages/reference/case.schema.json"
    jsonschema.Draft7Validator.check_schema(SCHEMA)


def examples():
    folders = [ROOT / "examples", ROOT / "book" / "scripts", ROOT / "crates" / "fakir-cli" / "tests" / "it"]
    return sorted(path for folder in folders for path in folder.rglob("*.toml"))


@pytest.mark.parametrize("path", examples(), ids=lambda path: path.name)
def test_every_example_is_accepted(path):
    assert problems(path.read_text(encoding="utf-8")) == []


def test_the_case_to_start_from_is_accepted():
    printed = subprocess.run([os.environ["FAKIR"], "init", "-"], capture_output=True, text=True, check=True)
    assert problems(printed.stdout) == []


def test_every_block_of_the_manual_is_accepted():
    found = 0
    pages = [*(ROOT / "book" / "pages").rglob("*.md"), ROOT / "README.md"]
    for page in pages:
        for block in re.findall(r"^```toml\n(.*?)^```", page.read_text(encoding="utf-8"), re.M | re.S):
            assert problems(block, PARTS) == [], page
            found += 1
    assert found >= 3


def malformed():
    folders = ["malformed", "malformed_studies", "malformed_surfaces"]
    return sorted(path for folder in folders for path in (MALFORMED / folder).glob("*.toml"))


@pytest.mark.parametrize("path", malformed(), ids=lambda path: f"{path.parent.name}/{path.stem}")
def test_malformed_files_are_rejected(path):
    try:
        text = path.read_text(encoding="utf-8")
    except UnicodeDecodeError:
        return
    found = problems(text)
    if path.stem in BEYOND:
        assert found == [], f"a schema can reject it: leave it out of the list ({BEYOND[path.stem]})"
    else:
        assert found != []


@pytest.mark.parametrize(
    ("key", "value", "is_valid"),
    [
        ("lens.radius", '"2200 µm"', True),
        ("lens.radius", '"2.2e3um"', True),
        ("lens.radius", '" .22 cm "', True),
        ("lens.radius", '"22000000 Å"', True),
        ("lens.radius", "0.0022", True),
        ("lens.radius", "2200", False),
        ("lens.radius", '"-2.2 mm"', False),
        ("lens.radius", '"0.0 mm"', False),
        ("lens.radius", '"2.2 MPa"', False),
        ("lens.radius", '"2,2 mm"', False),
        ("lens.young_modulus", "2e6", True),
        ("lens.young_modulus", "2", False),
        ("pattern.offset_angle", '"-30 deg"', True),
        ("pattern.surface_fraction", '"10 %"', True),
        ("pattern.surface_fraction", '"10"', False),
        ("pattern.columns", "21.0", True),
        ("pattern.columns", "21.5", False),
        ("floor.contact", "false", True),
        ("floor.contact", '"false"', True),
        ("floor.contact", "0", False),
        ("adhesion.work", '"50 mJ/m^2"', True),
        ("adhesion.work", '"50 mN/m"', True),
        ("adhesion.work", '"-0 mJ/m2"', True),
        ("adhesion.work", '"50 mN"', False),
        ("method.cells_per_diameter", "16", False),
    ],
)
def test_values_are_judged_as_by_the_program(key, value, is_valid, tmp_path):
    """The schema and the program agree about a value in an example."""
    table, name = key.rsplit(".", 1)
    tables = (ROOT / "examples" / "paper-intermediate.toml").read_text(encoding="utf-8").split("\n[")
    heading = f"{table}]\n"
    if not any(part.startswith(heading) for part in tables):
        tables.append(heading)
    for number, part in enumerate(tables):
        if part.startswith(heading):
            rest = re.sub(rf"^{name} = .*\n", "", part.removeprefix(heading), flags=re.M)
            tables[number] = f"{heading}{name} = {value}\n{rest}"
    text = "\n[".join(tables)
    case = tmp_path / "case.toml"
    case.write_text(text, encoding="utf-8")
    # Reads the case, and computes nothing.
    run = [os.environ["FAKIR"], "cite", str(case)]
    done = subprocess.run(run, capture_output=True, text=True)
    assert (done.returncode == 0) == is_valid, done.stderr
    assert (problems(text) == []) == is_valid, problems(text)


@pytest.mark.parametrize(
    ("name", "expected"), [("examples/square-pillars.toml", 0), ("examples/study-disorder.toml", 0), ("malformed", 1)]
)
def test_an_editor_of_toml_understands_the_schema(name, expected, tmp_path):
    """Taplo is what Even Better TOML runs in an editor."""
    path = ROOT / name
    if name == "malformed":
        path = MALFORMED / "malformed" / "unit_of_wrong_dimension.toml"
    copy = tmp_path / "file.toml"
    copy.write_text(path.read_text(encoding="utf-8"), encoding="utf-8")
    program = Path(sysconfig.get_path("scripts")) / ("taplo.exe" if os.name == "nt" else "taplo")
    run = [program, "lint", "--no-auto-config", "--schema", PUBLISHED.as_uri(), str(copy)]
    done = subprocess.run(run, capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == expected, done.stderr
