"""Rounded tops, flat surfaces, and lenses without a critical state."""

import re

FORCE = re.compile(r"F = ([−-]?[\d.]+) (nN|µN|mN)")


def force(explorer):
    """The force of the load shown, µN."""
    number, unit = FORCE.search(explorer.text("load-numbers")).groups()
    return float(number.replace("−", "-")) * {"nN": 1e-3, "µN": 1, "mN": 1e3}[unit]


def is_hidden(explorer, name):
    return explorer.page.evaluate("(name) => document.getElementById(name).hidden", name)


def rounded(explore, **options):
    explorer = explore(**options)
    explorer.enter("pattern.surface_fraction", "0.01")
    explorer.enter("pattern.top_radius", "20 um")
    explorer.until("document.body.dataset.busy === 'no'")
    return explorer


def test_rounded_tops_have_a_slider_and_a_critical_state(explore):
    explorer = rounded(explore)
    # Arrays of rounded tops are finite.
    assert explorer.page.locator("#pattern-columns").input_value() == "15"
    first = explorer.text("force-value")
    assert first != "–" and "–" not in explorer.text("force-remark")
    assert is_hidden(explorer, "diagram") and is_hidden(explorer, "curves")
    label = explorer.page.locator("#map").get_attribute("aria-label")
    assert "pillars in contact" in label
    # The curve of loading is drawn in the background.
    explorer.until("document.querySelectorAll('#loading path').length > 3")
    explorer.slide("load", 0.5)
    assert "50" in explorer.text("load-words")
    assert 0 < force(explorer)
    assert "fakir-case.toml" in explorer.text("command")
    assert "top_radius" in explorer.text("case-file")
    # A rounder top has a smaller contact at the same load, so that the lens reaches the floor under less force.
    explorer.slide("load", 1)
    explorer.enter("pattern.top_radius", "10 um")
    explorer.until("document.body.dataset.busy === 'no'")
    assert explorer.text("force-value") != first
    explorer.picture("rounded")


def test_rounded_tops_are_in_the_link_and_can_be_flat_again(explore):
    explorer = rounded(explore)
    value = explorer.text("force-value")
    explorer.until("location.hash.includes('top_radius')")
    other = explore(explorer.page.url.partition("#")[1] + explorer.page.url.partition("#")[2])
    other.until("document.body.dataset.busy === 'no'")
    assert other.text("force-value") == value
    other.enter("pattern.top_radius", "")
    assert other.page.locator("#pattern-top_radius").input_value() == "flat"
    # The infinite lattice is back.
    assert other.page.locator("#pattern-columns").input_value() == ""
    assert not is_hidden(other, "diagram")


def test_the_flat_reference_removes_pillars_and_brings_them_back(explore):
    explorer = explore()
    explorer.enter("pattern.surface_fraction", "0.02")
    value = explorer.text("force-value")
    button = explorer.page.locator("#flat-reference")
    button.focus()
    explorer.press("Enter")
    explorer.rest()
    assert button.get_attribute("aria-pressed") == "true"
    assert explorer.page.locator("#surface-flat").is_checked()
    assert "No critical state" in explorer.text("no-critical")
    assert is_hidden(explorer, "critical")
    assert not explorer.page.locator("#pattern-lattice").is_visible()
    # Hertz under R/1000: 4/3 E* sqrt(R) (R/1000)^(3/2), with E* = 4/3 MPa; the sphere is 0.1 % stiffer or softer.
    hertz = 4 / 3 * (4 / 3 * 1e6) * 2.2e-3**0.5 * 2.2e-6**1.5 * 1e6
    assert abs(force(explorer) / hertz - 1) < 1e-3
    explorer.slide("load", 2)
    assert abs(force(explorer) / (hertz * 2**1.5) - 1) < 2e-3
    explorer.picture("flat")
    # Adhesion: JKR, whose unloading is drawn.
    explorer.enter("adhesion.work", "50 mJ/m2")
    explorer.until("!document.getElementById('unloading-key').hidden")
    button.click()
    explorer.enter("adhesion.work", "0")
    explorer.slide("load", 1)
    assert explorer.page.locator("#pattern-surface_fraction").input_value() == "0.02"
    assert explorer.text("force-value") == value


def test_cylinder_and_plate_on_a_finite_array(explore):
    explorer = explore()
    for shape in ["cylinder", "plate"]:
        explorer.page.locator("#lens-shape").select_option(shape)
        explorer.rest()
        assert explorer.page.locator("#pattern-columns").input_value() == "15"
        assert "No critical state" in explorer.text("no-critical")
        first = force(explorer)
        explorer.slide("load", 0.5)
        assert 0 < force(explorer) < first
        explorer.slide("load", 1)
    explorer.picture("plate")
    explorer.page.locator("#lens-shape").select_option("sphere")
    explorer.rest()
    assert explorer.page.locator("#lens-radius").input_value() == "2.2 mm"
    assert not is_hidden(explorer, "critical")


def test_a_cylinder_on_a_flat_surface_has_no_force(explore):
    explorer = explore()
    explorer.page.locator("#flat-reference").click()
    explorer.rest()
    explorer.page.locator("#lens-shape").select_option("cylinder")
    explorer.until("!document.getElementById('problem').hidden")
    assert "no finite force" in explorer.text("problem")


def test_files_of_rounded_tops_are_saved(explore):
    explorer = rounded(explore)
    explorer.page.locator("#export-menu summary").click()
    for name in ["case.toml", "pillars.csv", "pressure-map.svg"]:
        with explorer.page.expect_download() as download:
            explorer.page.locator(f"[data-file='{name}']").click()
        assert download.value.suggested_filename == f"fakir-{name}"
