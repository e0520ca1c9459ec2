"""Pillars of a table that is opened or dropped on the page, and files that are refused."""

import json
import os
import subprocess
import time
from pathlib import Path

import pytest
from conftest import exploring
from test_explorer import paper

# Drops a file with this name and text on the page.
DROP = """([name, text]) => {
    const data = new DataTransfer();
    data.items.add(new File([text], name));
    document.body.dispatchEvent(new DragEvent("drop", { bubbles: true, cancelable: true, dataTransfer: data }));
}"""


def square(pitch, count, sizes=""):
    """A square of pillars, with coordinates from a corner, um."""
    places = [(i, k) for i in range(count) for k in range(count)]
    rows = [f"{i * pitch},{k * pitch}{sizes and f',{2.2 - 0.2 * (i % 2)},{6 + (k % 2)}'}" for i, k in places]
    return "\n".join([f"x_um,y_um{sizes}", *rows]) + "\n"


def dropped(page, name, text):
    page.page.evaluate(DROP, [name, text])


def test_a_table_of_pillars_is_dropped(explore):
    """The numbers are those of the finite square lattice with the same pillars, which has a control for its columns."""
    lattice = explore("#" + "&".join([
        *(each for each in paper(0.01) if "surface_fraction" not in each),
        "pattern.lattice=square", "pattern.pitch=0.00003", "pattern.columns=9",
    ]))
    page = explore("#" + "&".join(paper(0.01)))
    start = time.monotonic()
    dropped(page, "sample.csv", square(30, 9))
    page.until("location.hash.includes('sample.csv')")
    page.rest()
    assert time.monotonic() - start < 10
    assert page.results() == lattice.results()
    assert page.text("pillars") == lattice.text("pillars")
    assert page.page.input_value("#pattern-lattice") == "listed"
    assert "pillars = \"sample.csv\"" in page.text("case-file")
    # A quantity is changed, and the table stays.
    for each in (page, lattice):
        each.enter("substrate.young_modulus", "4 MPa")
    assert page.results() == lattice.results()
    # The curves need a lattice, and say so.
    page.until("document.getElementById('curves-status').textContent.includes('surface fraction')")
    page.page.select_option("#pattern-lattice", "hexagonal")
    page.rest()
    assert page.page.locator("#problem").is_hidden()
    assert page.page.input_value("#pattern-surface_fraction") != ""


def test_heights_and_diameters_of_a_table_are_used(explore, tmp_path):
    page = explore("#" + "&".join(paper(0.01)))
    table = tmp_path / "sizes.csv"
    table.write_text(square(30, 7, ",height_um,diameter_um"))
    page.page.set_input_files("#table-file", str(table))
    page.until("location.hash.includes('sizes.csv')")
    page.rest()
    assert page.page.locator("#problem").is_hidden()
    assert page.results()[0] != "–"
    page.page.click("#export-menu summary")
    with page.page.expect_download() as saved:
        page.page.click("[data-file='case.toml']")
    text = Path(saved.value.path()).read_text()
    assert 'pillars = "sizes.csv"' in text and "axis_x" in text
    # A link does not contain the table.
    again = explore("#" + page.page.url.split("#")[1])
    assert "not part of a link" in again.text("pattern-lattice-note")


def test_columns_of_a_table_are_named(explore, tmp_path):
    """A table in pixels, with columns of another program, has the numbers of the same table in micrometres."""
    plain = explore("#" + "&".join(paper(0.01)))
    dropped(plain, "sample.csv", square(30, 7))
    plain.until("location.hash.includes('sample.csv')")
    plain.rest()
    table = tmp_path / "spots.csv"
    _, *rows = square(60, 7).split()
    table.write_text("\n".join(["row,column,QUALITY", *(f"{row.split(',')[1]},{row.split(',')[0]},0.9" for row in rows)]))
    page = explore("#" + "&".join(paper(0.01)))
    page.page.set_input_files("#table-file", str(table))
    page.until("document.getElementById('problem').textContent.includes('pillar_columns')")
    page.enter("pattern.pillar_columns", "x = column, y = row")
    page.enter("pattern.pillar_unit", "0.5 um")
    page.rest()
    assert page.page.locator("#problem").is_hidden()
    assert page.results() == plain.results()
    assert 'pillar_columns = "x = column, y = row"' in page.text("case-file")
    page.page.select_option("#pattern-lattice", "hexagonal")
    page.rest()
    assert page.page.locator("#pattern-pillar_columns").is_hidden()


@pytest.mark.parametrize(
    "name, text, words",
    [
        ("apart.csv", "x_um,y_um\n0,zero\n", "line 2"),
        ("apart.csv", "x_um,y_um\n0,0\n3,0\n", "overlaps"),
    ],
)
def test_other_files_are_refused_in_words(explore, name, text, words):
    page = explore("#" + "&".join(paper(0.01)))
    before = page.results()
    dropped(page, name, text)
    found = "document.getElementById('data-words').textContent + document.getElementById('problem').textContent"
    page.until(f"({found}).includes({words!r})")
    assert page.results() == before


@pytest.mark.server
@pytest.mark.parametrize("tops", ["", 'top_radius = "20 um"'])
def test_the_table_of_a_case_is_where_the_page_begins(explore, tmp_path, tops):
    """The numbers are those of the command, and return with *reset* after another table was dropped."""
    (tmp_path / "tops.csv").write_text(square(15, 7))
    case = tmp_path / "case.toml"
    case.write_text(CASE.format(tops))
    command = [os.environ["FAKIR"], "transition", str(case), "--json"]
    answer = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    force = answer["critical_force_N"] * 1e6
    shown = "Number(document.getElementById('force-value').textContent)"
    shows = f"Math.abs({shown} - {force}) < 1e-4 * {force}"
    with exploring(str(case)) as address:
        page = explore(address=address)
        page.until(shows)
        assert page.page.input_value("#pattern-lattice") == "listed"
        dropped(page, "other.csv", square(20, 5))
        page.until(f"!({shows})")
        page.page.click("#reset")
        page.until(shows)
        page.picture(f"table-{'rounded' if tops else 'flat'}")


CASE = """
[lens]
radius = "2.2 mm"
young_modulus = "2 MPa"
poisson_ratio = 0.5

[substrate]
young_modulus = "2 MPa"
poisson_ratio = 0.5

[pattern]
lattice = "listed"
pillars = "tops.csv"
{}

[pattern.pillar]
diameter = "6 um"
height = "2.2 um"
"""
