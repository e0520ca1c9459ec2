"""The draft of the article in `paper`: every number of its text follows from the ledger's files, from the manual or from the program; and it can
be built."""

import csv
import json
import os
import re
import subprocess
import sys
from decimal import ROUND_HALF_UP, Decimal
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAPER = ROOT / "paper" / "paper.md"
RESULTS = ROOT / "bench" / "results"
CASE = ROOT / "examples" / "paper-intermediate.toml"

TEXT = re.sub(r"\s+", " ", PAPER.read_text(encoding="utf-8").split("\n---\n", 1)[1])


def rows(name, heading):
    """The rows of the table of a file of results whose columns begin so, as dictionaries."""
    lines = (RESULTS / name).read_text(encoding="utf-8").splitlines()
    start = next(number for number, line in enumerate(lines) if line.startswith(heading))
    names = cells(lines[start])
    table = []
    for line in lines[start + 2 :]:
        if not line.startswith("|"):
            break
        table.append(dict(zip(names, cells(line), strict=True)))
    return table


def cells(line):
    return [cell.strip() for cell in line.strip().strip("|").split("|")]


def critical(*options):
    run = [os.environ["FAKIR"], "transition", str(CASE), "--json", "--quiet", *options]
    return json.loads(subprocess.run(run, check=True, capture_output=True, text=True).stdout)


def about_the_critical_state():
    found = critical()
    pillars, force = found["pillars_in_contact"], 1e3 * found["critical_force_N"]
    estimate = found["relative_error_estimate"]["force"]
    assert found["surface_fraction"] == pytest.approx(0.1)
    assert 0.005 < found["wall_time_s"] < 1.0
    return (
        f"the critical state with {pillars} pillars in contact is computed in hundredths of a second, "
        f"with a force of {force:.5f} mN and an estimated relative error of {estimate:.0e}".replace("e-0", "e-")
    )


def about_the_published_formula():
    run = [os.environ["FAKIR"], "compare", str(CASE), "--set", "pattern.surface_fraction=0.03", "--json", "--quiet"]
    done = subprocess.run(run, check=True, capture_output=True, text=True)
    methods = {row["method"]: row for row in json.loads(done.stdout)["methods"]}
    excess = methods["large_contact_as_printed"]["force_difference"]
    return f"at a surface fraction of 0.03, the published formula for many pillars gives a critical force that is {100 * excess:.0f} % too large"


def about_the_table_of_critical_states():
    page = (ROOT / "book" / "pages" / "validation" / "known.md").read_text(encoding="utf-8")
    number = re.search(r"^(\d+) critical states: every difference", page, re.M)[1]
    default, accurate = (re.search(rf"^Largest relative difference, {name}: (.*)$", page, re.M)[1] for name in ["default", "accurate"])
    table = (ROOT / "crates" / "fakir" / "tests" / "reference" / "critical_states.csv").read_text(encoding="utf-8")
    states = csv.DictReader(line for line in table.splitlines() if not line.startswith("#"))
    assert sum(float(state["critical_force_N"]) > 0 for state in states) == int(number)
    return (
        f"For its {number} critical states the largest relative difference of the force is {default} with default "
        f"and {accurate} with accurate settings"
    )


def about_the_critical_force_on_grids():
    """From the heading "surface fraction 0.1, critical state", to 1 %."""
    text = (RESULTS / "texture.md").read_text(encoding="utf-8")
    part = text.split("## Surface fraction 0.1, critical state, at equal error of the force", 1)[1]
    part = part.split("### To 1 %", 1)[1].split("###", 1)[0]
    times = {}
    for line in part.splitlines():
        if ", extrapolated |" in line:
            name, _, _, _, over, *_ = cells(line)
            times[name.removesuffix(", extrapolated")] = over
    return (
        "For an error of 1 % of the critical force at a surface fraction of 0.1, extrapolated from two grids, ContactMechanics takes "
        f"{times['ContactMechanics']} times and Tamaas {times['Tamaas']} times the processor time of the spectral method"
    )


def about_equal_cells():
    table = [
        row
        for row in rows("elements.md", "| problem | threads |")
        if row["threads"] == "1" and row["program"] != "fakir"
    ]
    ratio = "time over fakir's"
    # The settings of the comparison, stated in bench/README.md, and the errors of the table.
    allowed = "within 1e-5 of a solution" in (ROOT / "bench" / "README.md").read_text(encoding="utf-8") and 1e-5
    assert all(float(row["error"]) < allowed for row in rows("elements.md", "| problem | threads |"))
    spans = []
    for program in ["ContactMechanics", "Tamaas"]:
        times = [Decimal(row[ratio]) for row in table if row["program"] == program]
        least, greatest = (time.quantize(Decimal(1), ROUND_HALF_UP) for time in [min(times), max(times)])
        spans.append(f"{program} takes {least} to {greatest} times".replace("Tamaas takes", "Tamaas"))
    peers = []
    for line in (RESULTS / "surfaces.md").read_text(encoding="utf-8").splitlines():
        if "| aspher (" in line:
            peers.append(float(cells(line)[-1].split(",")[0]))
    return (
        "For contacts on equal cells on one thread, each to an error below 1e-5 of the resulting force or indentation, "
        f"{' and '.join(spans)} the time of the boundary elements of `fakir`; aspher, with the same bound of the energy error, takes "
        f"{min(peers):.1f} to {max(peers):.0f} times as long"
    )


def about_pull_off():
    table = [row for row in rows("adhesion.md", "| tops attached |") if row["tops attached"] == "1"]
    own = next(row for row in table if row["program"] == "fakir, default")
    peers = [row for row in table if row["program"].startswith("Adhesion")]
    assert len(peers) == 4
    best = min(peers, key=lambda row: abs(float(row["error"])))
    error = f"{abs(float(own['error'])):.0e}".replace("e-0", "e-")
    milliseconds = 1e3 * float(own["processor time (s)"])
    return (
        f"the relative error of `fakir` is {error} after {milliseconds:.0f} ms; with an attraction of finite range on a grid, the best of four "
        f"solutions has an error of {100 * abs(float(best['error'])):.0f} % after {float(best['processor time (s)']):.0f} s"
    )


SENTENCES = [
    about_the_critical_state,
    about_the_published_formula,
    about_the_table_of_critical_states,
    about_the_critical_force_on_grids,
    about_equal_cells,
    about_pull_off,
]


@pytest.mark.parametrize("sentence", SENTENCES, ids=lambda sentence: sentence.__name__)
def test_numbers_follow_from_the_files(sentence):
    assert sentence() in TEXT


def test_no_other_numbers_are_in_the_text():
    """Citations and references aside, every digit is part of a sentence that is derived above."""
    text = TEXT
    for sentence in SENTENCES:
        text = text.replace(sentence(), "")
    text = re.sub(r"@\w+", "", text)
    assert re.findall(r"\S*\d\S*", text) == []


def test_nothing_is_invented():
    """Names, affiliations, the date, users, the disclosure and acknowledgements are filled in by those who submit it."""
    whole = PAPER.read_text(encoding="utf-8")
    head = whole.split("\n---\n", 1)[0]
    for line in ["  - name: TO BE FILLED IN", "  - name: TO BE FILLED IN\n    index: 1", "date: TO BE FILLED IN"]:
        assert line in head
    for heading in ["Acknowledgements", "AI usage disclosure"]:
        assert f"# {heading}\n\nTO BE FILLED IN\n" in whole


def test_every_reference_is_cited_and_defined():
    library = (ROOT / "paper" / "paper.bib").read_text(encoding="utf-8")
    defined = set(re.findall(r"^@\w+\{(\w+),", library, re.M))
    assert set(re.findall(r"@(\w+)", TEXT)) == defined
    # The same works in the references of the program have the same DOI.
    works = (ROOT / "crates" / "fakir-study" / "src" / "citations.toml").read_text(encoding="utf-8")
    known = re.findall(r'^key = "(\w+)"\n(?:.+\n)*?doi = "(.+)"', works, re.M)
    for key, doi in known:
        if key in defined:
            assert f"doi = {{{doi}}}" in library, key


def test_its_sections_and_length_are_those_of_the_journal():
    """As required by the page "JOSS Paper Format" of the journal (2026): 750 to 1750 words, and these sections."""
    assert 750 < len(TEXT.split()) < 1750
    headings = re.findall(r"^# (.+)$", PAPER.read_text(encoding="utf-8"), re.M)
    assert headings == [
        "Summary",
        "Statement of need",
        "State of the field",
        "Software design",
        "Research impact statement",
        "AI usage disclosure",
        "Acknowledgements",
        "References",
    ]


@pytest.mark.slow
def test_the_table_of_critical_states_is_derived_again(tmp_path):
    """The largest differences, from the script of the manual."""
    script = ROOT / "book" / "scripts" / "reference.py"
    run = [sys.executable, str(script), str(tmp_path / "reference.svg")]
    done = subprocess.run(run, cwd=ROOT, check=True, capture_output=True, text=True)
    page = (ROOT / "book" / "pages" / "validation" / "known.md").read_text(encoding="utf-8")
    assert done.stdout.strip() in page


@pytest.mark.slow
def test_the_article_is_built(tmp_path):
    """With pandoc from the package pypandoc_binary, as HTML with all references resolved."""
    import pypandoc

    target = tmp_path / "paper.html"
    options = ["--citeproc", "--mathml", "--standalone", "--fail-if-warnings", f"--resource-path={PAPER.parent}"]
    pypandoc.convert_file(
        str(PAPER), "html", outputfile=str(target), extra_args=[*options, f"--bibliography={PAPER.parent / 'paper.bib'}"]
    )
    page = target.read_text(encoding="utf-8")
    library = (ROOT / "paper" / "paper.bib").read_text(encoding="utf-8")
    assert page.count('class="csl-entry"') == len(re.findall(r"^@", library, re.M))
    assert "???" not in page
