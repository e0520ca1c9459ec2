"""The rules of axe-core on the page and on the manual: contrast, labels, roles, order of headings and the like, in light and dark."""

from pathlib import Path

import axe_playwright_python
import pytest
from test_explorer import paper
from test_hold import RELAXING
from test_manual import BOOK, at
from test_other_surfaces import rounded
from test_surface import DROP_BYTES, bump
from test_table import dropped, square

RULES = (Path(axe_playwright_python.__file__).parent / "axe.min.js").read_text(encoding="utf-8")
VIOLATIONS = """async ([part, rules]) => (await axe.run(part, { rules })).violations.flatMap((rule) =>
    rule.nodes.map((node) => `${rule.id} (${rule.help}) at ${node.target.join(" ")}`))"""

# What scrolls is given the focus by the browser itself, which axe-core does not take into account.
BY_THE_BROWSER = {"scrollable-region-focusable": {"enabled": False}}

SCHEMES = pytest.mark.parametrize("scheme", ["light", "dark"])


def violations(tab, part="html", rules=None):
    # What is folded is part of the page.
    tab.evaluate("() => document.querySelectorAll('details').forEach((each) => { each.open = true; })")
    tab.evaluate(RULES)
    return tab.evaluate(VIOLATIONS, [part, rules or {}])


def opened(fragment):
    def state(explore, **options):
        return explore("#" + "&".join(fragment), **options)

    return state


def with_a_table(explore, **options):
    page = opened(paper(0.01))(explore, **options)
    # A table has no surface fraction to vary: the curves of the lattice before must not stay, grey for ever.
    page.until("document.querySelectorAll('#curve-force .exact-point').length > 0")
    dropped(page, "sample.csv", square(30, 5))
    page.until("location.hash.includes('sample.csv')")
    return page


def with_a_height_map(explore, **options):
    page = opened(paper(0.01))(explore, **options)
    page.page.evaluate(DROP_BYTES, ["bump.npy", bump(64)])
    page.until("document.getElementById('map-words').textContent.includes('surface.width')")
    page.page.fill("#map-width", "200 um")
    page.page.press("#map-width", "Enter")
    page.until("document.getElementById('map-words').textContent.startsWith('64')")
    return page


def with_a_curve(explore, **options):
    page = opened(paper(0.01))(explore, **options)
    dropped(page, "curve.csv", "displacement_m,force_N\n" + "".join(f"{step}e-6,{step**1.5}e-6\n" for step in range(1, 12)))
    page.until("document.querySelectorAll('#loading circle').length > 3")
    return page


def clicked(fragment, button):
    def state(explore, **options):
        page = opened(fragment)(explore, **options)
        page.page.click(button)
        page.rest()
        return page

    return state


STATES = {
    "pillars": opened([]),
    "floor": opened([*paper(0.03), "load=1.5"]),
    "adhesion": opened([*paper(0.03), "adhesion.work=0.05"]),
    "rounded tops": rounded,
    "flat": clicked(paper(0.01), "#flat-reference"),
    "table": with_a_table,
    "height map": with_a_height_map,
    "curve": with_a_curve,
    "hold": clicked([*paper(0.01), *RELAXING], "#hold-button"),
    "two cases": clicked(paper(0.01), "#compare-button"),
    "presentation": clicked(paper(0.01), "#present"),
    "refused": opened([*paper(0.01), "pattern.pillar_height=1e9"]),
}


@pytest.mark.server
@SCHEMES
@pytest.mark.parametrize("state", STATES)
def test_the_page_keeps_the_rules(explore, state, scheme):
    """The document is the same for both engines, so that one of them is enough."""
    page = STATES[state](explore, color_scheme=scheme, bypass_csp=True)
    page.rest()
    # Results of the case before are grey until the new ones are there.
    page.until("[...document.querySelectorAll('.older')].every((each) => !each.checkVisibility())")
    assert violations(page.page) == []


@pytest.mark.skipif(not BOOK, reason="the manual was not built: cargo xtask book")
@SCHEMES
def test_the_manual_keeps_the_rules(browser, scheme):
    """Pages of each kind: text, formulas, figures, tables, keys, cases. The list of pages and the buttons above are those of mdBook."""
    context = browser.new_context(color_scheme=scheme)
    tab = context.new_page()
    found = []
    for page in ["index", "experimenters", "theory/spectral", "howto/choose-a-method", "reference/keys", "reference/studies"]:
        tab.goto(at(page))
        found += [f"{page}: {each}" for each in violations(tab, "main", BY_THE_BROWSER)]
    assert found == []
    context.close()
