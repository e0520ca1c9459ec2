"""The manual: the script that executes its pages reports a wrong page, and its lists of names are complete; and the
lines of the READMEs in a new environment, with the command in the package."""

import csv
import importlib.util
import json
import os
import re
import subprocess
import sys
import venv
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
BOOK = ROOT / "book"
FAKIR = Path(os.environ["FAKIR"])

PAGE = """# A page

```console
$ fakir transition examples/paper-intermediate.toml | head -4
Critical state: the lens rests on pillar tops and just reaches the floor
surface fraction 0.1, pitch 18.0689 um, lens axis on a pillar
spectral method, default accuracy
```

```python
import fakir

system = fakir.System.from_file("examples/paper-intermediate.toml")
system.transition().pillars_in_contact
```

```text
451
```

```console
$ echo solved in 12 ms
solved in 3.4 s
```
"""


def run_page(text, folder, *options):
    """The page after its execution, and the result of the execution."""
    pages = folder / "pages"
    pages.mkdir()
    page = pages / "page.md"
    page.write_text(text, encoding="utf-8")
    path = os.pathsep.join([str(FAKIR.parent), str(Path(sys.executable).parent), os.environ["PATH"]])
    done = subprocess.run(
        [sys.executable, str(BOOK / "pages.py"), str(pages), str(folder / "out"), "--only", "page.md"]
        + list(options),
        env={**os.environ, "PATH": path},
        capture_output=True,
        text=True,
    )
    return page.read_text(encoding="utf-8"), done


def test_a_page_that_agrees_with_the_output_passes(tmp_path):
    page, done = run_page(PAGE, tmp_path)
    assert done.returncode == 0, done.stderr
    assert page == PAGE


@pytest.mark.parametrize(
    "right, wrong",
    [("pitch 18.0689 um", "pitch 18.0687 um"), ("\n451\n", "\n450\n")],
    ids=["of a command", "of lines of Python"],
)
def test_a_page_with_one_number_changed_fails(right, wrong, tmp_path):
    page, done = run_page(PAGE.replace(right, wrong), tmp_path)
    assert done.returncode == 1
    assert f"-{wrong.strip()}" in done.stderr or wrong in done.stderr
    assert wrong in page


def test_a_page_is_corrected_where_it_differs(tmp_path):
    page, done = run_page(PAGE.replace("18.0689", "18.0687"), tmp_path, "--update")
    assert done.returncode == 0, done.stderr
    assert page == PAGE


def test_a_block_that_agrees_is_not_rewritten(tmp_path):
    last_digit = PAGE.replace("18.0689", "18.0688")
    page, done = run_page(last_digit, tmp_path, "--update")
    assert done.returncode == 0, done.stderr
    assert page == last_digit


def pages_module():
    """The module `book/pages.py`."""
    found = importlib.util.spec_from_file_location("pages", BOOK / "pages.py")
    module = importlib.util.module_from_spec(found)
    found.loader.exec_module(module)
    return module


AGREE = [
    ("pitch 18.0689 um", "pitch 18.0688 um"),
    ("pitch  18.07 um", "pitch     18.0689 um"),
    ("radius 199 um", "radius 200 um"),
    ('"force_N": 0.004448128913214337,', '"force_N": 0.004448128913,'),
    ("zero 0.000", "zero -1e-17"),
    ("met to 2.7e-8 % at every load", "met to 1.1e-13 % at every load"),
    ("estimated error 8e-6", "estimated error 1.2e-5"),
    ("Difference in force: 8.0e-5, allowed 5.2e-4", "Difference in force: 6.0e-5, allowed 7.0e-4"),
    ('"force_error_estimate": 1.0e-8', '"force_error_estimate": 1.4e-8'),
    ("Newton steps   5  converged, in 12 ms", "Newton steps  12  converged, in 3 s"),
]
DIFFER = [
    ("pitch 18.0689 um", "pitch 18.0687 um"),
    ("pitch 18.07 um", "pitch 18.05 um"),
    ("pitch 18.0689 um", "pitch -18.0689 um"),
    ("pitch 18.0689 um", "pitch 18.0689 nm"),
    ("451 pillars", "450 pillars"),
    ("diameter 6 um", "diameter 7 um"),
    ("radius 199 um", "radius 201 um"),
    ('"force_N": 0.0044481,', '"force_N": 0.0044483,'),
    ("share 2.0e-3 %", "share 1.0e-3 %"),
    ("estimated error 8e-6", "estimated error 1.3e-5"),
    ("standard error 540 nN", "standard error 550 nN"),
    ("value 8.0e-6", "value 9.0e-6"),
    ("fakir 0.2.0", "fakir 0.2.1"),
    ("paper-1.svg", "paper-2.svg"),
    ("one line", "one line\nand another"),
]


@pytest.mark.parametrize("expected, actual", AGREE)
def test_texts_that_agree(expected, actual):
    difference = pages_module().difference
    assert difference("page", expected, actual) is None
    assert difference("page", actual, expected) is None


@pytest.mark.parametrize("expected, actual", DIFFER)
def test_texts_that_differ(expected, actual):
    difference = pages_module().difference
    assert f"+{actual}" in difference("page", expected, actual).splitlines() or "\n" in actual
    assert difference("page", actual, expected) is not None


def test_a_command_that_fails_is_reported(tmp_path):
    _, done = run_page("```console\n$ fakir transition nowhere.toml | cat; exit 2\n```\n", tmp_path)
    assert done.returncode == 1
    assert "the status of" in done.stderr


def test_pages_that_create_the_same_folder_are_reported(tmp_path):
    pages = pages_module()
    used = pages.prepare(tmp_path / "run")
    (tmp_path / "run" / "results" / "figures").mkdir(parents=True)
    (tmp_path / "run" / "examples" / "mine.toml").touch()
    made = pages.created(tmp_path / "run", used)
    assert made == {Path("results"), Path("examples/mine.toml")}
    assert pages.created_twice({"one.md": made, "other.md": {Path("heights.npy")}}) == []
    problems = pages.created_twice({"one.md": made, "other.md": {Path("results")}})
    assert problems == ["other.md: creates results as one.md does: use another name"]


CASE = "examples/paper-intermediate.toml"
WIDE = ["--set", "pattern.surface_fraction=0.01"]
FREE = ["--free", "substrate.young_modulus,contact_point", "--set", "method.name=punch"]
TOLERANCE = ["--tolerance", "pattern.pillar.height=3%", "--samples", "3"]
QUESTIONS = {
    "transition": ["transition", CASE],
    "press": ["press", CASE, "--force", "1mN"],
    "approach": ["approach", CASE, "--step", "5um"],
    "verify": ["verify", CASE, "--set", "pattern.surface_fraction=0.002"],
    "theory": ["theory", CASE],
    "compare": ["compare", CASE, *WIDE],
    "design": ["design", CASE, "--free", "pitch", "--critical-force", "1mN", *TOLERANCE],
    "fit": ["fit", "examples/fit/loading.csv", "--case", "examples/fit/case.toml", *FREE],
    "fits": [
        "fit",
        *(f"examples/fit/spot-{number}.csv" for number in (1, 2, 3)),
        "--case",
        "examples/fit/case.toml",
        *FREE,
    ],
    "friction": ["friction", CASE, "examples/lateral.csv", "--set", "pattern.surface_fraction=0.03"],
    "rounded": ["press", "examples/asperities.toml", "--force", "69mN"],
    "heights": [
        "design",
        "examples/asperities.toml",
        "--free",
        "heights",
        "--target",
        "examples/linear.csv",
        "--height-error",
        "0.1um",
    ],
    "sweep": ["sweep", "examples/study-surface-fraction.toml"],
    "surface": ["press", "examples/square-pillars.toml", "--indentation", "1um"],
    "surface approach": ["approach", "examples/square-pillars.toml", "--step", "1um"],
}

# The last part of a name: the unit of a parameter, a design or an axis.
UNITS = r"_(Pa|m|N|rad|m_per_N)$"


def names(value):
    """All names in a JSON value."""
    if isinstance(value, dict):
        for name, part in value.items():
            yield name
            yield from names(part)
    elif isinstance(value, list):
        for part in value:
            yield from names(part)


@pytest.mark.slow
def test_every_name_of_a_result_is_in_the_reference(tmp_path):
    page = (BOOK / "pages" / "reference" / "results.md").read_text(encoding="utf-8")
    printed = subprocess.run([FAKIR, "results"], check=True, capture_output=True, text=True).stdout
    page = re.sub(r"^```.*?^```", "", page, flags=re.M | re.S)
    listed = set(re.findall(r"`([^`]+)`", page + printed))
    # Objects and their content.
    listed |= {name for path in listed for name in path.split(".")}
    found = set()
    for name, question in QUESTIONS.items():
        folder = tmp_path / name
        done = subprocess.run(
            [FAKIR, *question, "--output", folder, "--quiet"], cwd=ROOT, capture_output=True, text=True
        )
        assert done.returncode == 0, done.stderr
        if (folder / "summary.json").exists():
            found |= set(names(json.loads((folder / "summary.json").read_text(encoding="utf-8"))))
        for table in folder.glob("*.csv"):
            with table.open(encoding="utf-8", newline="") as rows:
                found |= set(next(csv.reader(rows)))
    # Percentiles, and axes and samples by the names of their keys.
    found = {name for name in found if not re.fullmatch(r"[\d.]+", name) and "pattern." not in name}
    missing = {name for name in found if name not in listed and re.sub(UNITS, "", name) not in listed}
    assert not missing


def python_lines(path):
    """The blocks of Python in a file of Markdown."""
    return re.findall(r"^```python\n(.*?)^```", path.read_text(encoding="utf-8"), re.M | re.S)


@pytest.mark.slow
@pytest.mark.skipif("FAKIR_WHEEL" not in os.environ, reason="no wheel was built")
def test_the_wheel_alone_in_a_new_environment(tmp_path):
    venv.create(tmp_path / "new", with_pip=True)
    programs = tmp_path / "new" / ("Scripts" if sys.platform == "win32" else "bin")
    python = str(programs / "python")
    install = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
    environment["MPLBACKEND"] = "Agg"
    wheel = os.environ["FAKIR_WHEEL"] + "[plot,xarray,dask]"
    versions = str(Path(__file__).with_name("requirements.txt"))
    subprocess.run([*install, "--constraint", versions, wheel], check=True, env=environment)
    for path in [ROOT / "README.md", ROOT / "python" / "README.md"]:
        lines = python_lines(path)
        assert lines
        done = subprocess.run(
            [python, "-"], input="\n".join(lines), cwd=tmp_path, env=environment, text=True
        )
        assert done.returncode == 0, path

    # The command in the package is the program.
    def answer(*command):
        return subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True)

    assert answer(programs / "fakir", "init").returncode == 0
    ask = ["transition", "case.toml", "--json"]
    brought, built = (json.loads(answer(p, *ask).stdout) for p in [programs / "fakir", FAKIR])
    assert brought["critical_force_N"] == built["critical_force_N"]
    assert answer(python, "-m", "fakir", "transition", "nowhere.toml").returncode == 2
