"""Two cases side by side: map, section, curve and numbers of the pinned case stay while the other changes."""

import re

import pytest
from test_explorer import paper

PICTURE = "(name) => document.getElementById(name).toDataURL().length"
ROWS = """() => Object.fromEntries([...document.querySelectorAll("#comparison tr")].map((row) =>
    [row.cells[0].textContent, [...row.cells].slice(1).map((cell) => cell.textContent)]))"""


def rows(page):
    return page.page.evaluate(ROWS)


def pin(page):
    page.page.click("#compare-button")
    page.until("!document.getElementById('compare').hidden")


def test_a_case_stays_beside_the_next_one(explore):
    page = explore("#" + "&".join(paper(0.01)))
    pin(page)
    outline = page.page.get_attribute("#pinned-section path", "d")
    force = page.text("force-value")
    assert page.page.evaluate(PICTURE, "pinned-map") > 1000
    page.enter("substrate.young_modulus", "4 MPa")
    page.until("document.querySelector('#comparison.older') === null")
    found = rows(page)
    modulus = next(cells for name, cells in found.items() if name.startswith("Young"))
    assert modulus == ["2 MPa", "4 MPa", ""]
    pinned, live, change = found["critical force Fc"]
    assert pinned.split()[0] == force and live.split()[0] == page.text("force-value")
    ratio = float(live.split()[0]) / float(pinned.split()[0])
    assert float(re.match(r"\+(\S+) %", change).group(1)) == pytest.approx(100 * (ratio - 1), rel=0.1)
    # The pinned pictures are those of before; its curve is drawn in the chart of the live case.
    assert page.page.get_attribute("#pinned-section path", "d") == outline
    assert page.page.get_attribute("#section path", "d") != outline
    assert page.page.locator("#loading path.pinned-path").count() == 1
    page.page.click("#compare-button")
    page.until("document.getElementById('compare').hidden")
    assert page.page.locator("#loading path.pinned-path").count() == 0


def test_a_case_that_changes_at_once_is_not_the_pinned_one(explore):
    """The curve of the first case is not complete when the radius changes; the case that was shown is the one that stays."""
    page = explore("#" + "&".join(paper(0.01)))
    page.page.click("#compare-button")
    page.enter("lens.radius", "1 mm")
    page.until("!document.getElementById('compare').hidden")
    page.rest()
    page.until("document.querySelector('#comparison.older') === null")
    radius = next(cells for name, cells in rows(page).items() if name.startswith("radius"))
    assert radius == ["2.2 mm", "1 mm", ""]


def test_a_link_opens_both_cases(explore):
    page = explore("#" + "&".join([*paper(0.01), "load=0.6"]))
    pin(page)
    page.until("location.hash.includes('compare=')")
    page.enter("pattern.surface_fraction", "0.02")
    page.until("location.hash.includes('compare=') && location.hash.includes('surface_fraction=0.02')")
    page.until("document.querySelector('#comparison.older') === null")
    again = explore("#" + page.page.url.split("#")[1])
    again.until("!document.getElementById('compare').hidden")
    again.rest()
    again.until("document.querySelector('#comparison.older') === null")
    assert rows(again) == rows(page)
    assert again.page.url.split("#")[1] == page.page.url.split("#")[1]
    # Back removes the pinned case.
    for _ in range(2):
        page.page.go_back()
    page.until("document.getElementById('compare').hidden")


def test_cycles_are_compared(explore):
    """The pull-off force of adhesive tops, beside a case without adhesion, which has none."""
    page = explore("#" + "&".join(paper(0.005)))
    pin(page)
    page.enter("adhesion.work", "0.05")
    page.until("!document.getElementById('cycle-numbers').hidden")
    page.until("document.querySelector('#comparison.older') === null")
    pinned, live, change = rows(page)["pull-off force"]
    assert pinned == "–" and change == ""
    # Both are rounded to the estimated error.
    assert live == page.text("pull-off-force")
    assert page.page.locator("#loading path.pinned-path").count() == 1
