"""Adhesive floor: the cycle is drawn while it is solved and can be cancelled; the jump, the hollow sites in contact and the detachment are shown."""

import re
import time

import pytest
from test_cycle import adhesive, asked, command_line, force, quantity

# A cycle with an adhesive floor takes too long in the module.
pytestmark = pytest.mark.server

ADHESIVE_FLOOR = "adhesion.floor=true"

# Contact at six hollow sites; takes about a second.
QUICK = adhesive(0.03, 0.001, ADHESIVE_FLOOR)

# Takes most of a minute: the free annuli around pillars are narrow.
LONG = adhesive(0.03, 0.05, ADHESIVE_FLOOR)


@pytest.fixture(scope="module")
def expected():
    settings = ("pattern.surface_fraction=0.03", "adhesion.work=1mJ/m2", ADHESIVE_FLOOR)
    return command_line(*(part for setting in settings for part in ("--set", setting)))


def until_solving(page):
    """Waits until a long cycle has reached the floor."""
    page.until("/fronts on the floor, round/.test(document.getElementById('cycle-stage').textContent)")


def floor_pixels(page):
    """Number of pixels in the middle of the map with the colour of tension on the floor, purple; pillars are farther out only."""
    return page.page.evaluate(
        """() => {
            const map = document.getElementById("map");
            const third = Math.round(map.width / 3);
            const { data } = map.getContext("2d").getImageData(third, third, third, third);
            let found = 0;
            for (let k = 0; k < data.length; k += 4) {
                const [red, green, blue] = data.slice(k, k + 3);
                if (red > green + 12 && blue > green + 8) found += 1;
            }
            return found;
        }"""
    )


@pytest.mark.server
def test_the_jump_and_the_loss_of_the_floor_are_described(explore, expected):
    page = explore(QUICK)
    assert asked(page, "/api/cycle") == 1 and asked(page, "/api/contact") == 0
    assert page.text("load-words") == "after the jump onto the floor"
    assert force(page) == pytest.approx(expected["turn_force_N"], rel=1e-3)
    floor = expected["floor"]
    jump, last = floor["jump"], floor["last"]
    words = page.text("adhesive-floor")
    printed = re.match(
        r"Jump onto the floor at ζ = (.*?): (\d+) holes? filled, ([\d ]+) µm2 in contact \(error (.*?)\), "
        r"force from (.*?) to (.*?) \(error (.*?)\)\. "
        r"Floor detaches between ζ = (.*?) and (.*?) \(error (.*?)\), force from (.*?) to (.*?)\.$",
        words,
    )
    assert printed, words
    at, holes, area, area_error, before, after, force_error, lost, gone, lost_error, held, free = printed.groups()
    assert quantity(at) == pytest.approx(jump["indentation_m"], rel=0.01)
    assert int(holes) == jump["filled_holes"] == 6
    assert float(area.replace(" ", "")) == pytest.approx(1e12 * jump["floor_contact_area_m2"], rel=0.01)
    assert quantity(before) == pytest.approx(floor["force_before_jump_N"], rel=0.01)
    assert quantity(after) == pytest.approx(jump["force_N"], rel=0.01)
    assert quantity(lost) == pytest.approx(last["indentation_m"], rel=0.01)
    assert quantity(gone) == pytest.approx(floor["indentation_after_loss_m"], rel=0.01)
    assert quantity(held) == pytest.approx(last["force_N"], rel=0.01)
    assert quantity(free) == pytest.approx(floor["force_after_loss_N"], rel=0.01)
    errors = floor["relative_error_estimate"]
    for shown, name in ((area_error, "jump_contact_area"), (force_error, "jump_force"), (lost_error, "lost_indentation")):
        assert float(shown) == pytest.approx(errors[name], rel=0.5), name
    locate = page.page.locator
    for name in ("critical-point", "floor-jump", "floor-lost", "pull-off", "first-contact", "last-release"):
        assert locate(f"#loading circle.{name}").count() == 1, name
    assert locate("#loading path.floor-jump").count() == 1
    assert page.page.is_visible("#loading-legend .floor-jump")
    note = re.sub(r"\s+", " ", page.page.locator("#cycle-numbers > .remark").inner_text())
    assert "has jumped onto it" in note and "is not adhesive" not in note


@pytest.mark.server
def test_the_slider_passes_the_jump_and_the_loss(explore, expected):
    page = explore(QUICK)
    page.page.click("#to-critical")
    assert page.text("load-words") == "critical state"
    assert force(page) == pytest.approx(expected["critical_force_N"], rel=1e-3)
    assert "floor" not in page.text("load-numbers")
    page.page.focus("#load")
    page.press("ArrowRight")
    assert page.text("load-words") == "after the jump onto the floor"
    assert "6 holes filled" in page.text("load-numbers")
    forces = []
    while "floor" in page.text("load-numbers"):
        assert len(forces) < 200
        forces.append(force(page))
        page.press("ArrowRight")
    floor = expected["floor"]
    # The states before and after the detachment are among those that are stored.
    assert forces[-1] == pytest.approx(floor["last"]["force_N"], rel=1e-3)
    assert force(page) == pytest.approx(floor["force_after_loss_N"], rel=1e-3)
    page.page.click("#to-pull-off")
    assert force(page) == pytest.approx(expected["pull_off_force_N"], rel=1e-3)
    page.page.click("#to-jump")
    assert page.text("load-words") == "after the jump onto the floor"
    assert asked(page, "/api/cycle") == 1


def test_filled_holes_are_on_the_map_and_in_the_section(explore):
    page = explore(QUICK)
    label = "() => document.getElementById('map').getAttribute('aria-label')"
    assert page.page.evaluate(label).endswith("adhesive floor, 6 holes filled")
    assert page.page.is_visible("#floor-pull-key") and page.text("floor-pull-most").startswith("−")
    assert page.page.locator("#section path.floor-part").count() > 0
    on_floor = floor_pixels(page)
    page.page.click("#to-critical")
    assert not page.page.is_visible("#floor-key") and page.page.is_visible("#touch-key")
    assert "floor" not in page.page.evaluate(label)
    assert page.page.locator("#section path.floor-part").count() == 0
    assert on_floor > 500 and floor_pixels(page) == 0


def test_a_long_cycle_grows_reports_progress_and_is_cancelled_at_once(explore):
    plain = explore(adhesive(0.03, 0.05))
    began = time.monotonic()
    page = explore(LONG, rests=False)
    until_solving(page)
    # Before the jump the results are shown, as without the floor.
    assert page.results() == plain.results()
    assert page.text("load-words") == "critical state, the rest is being solved"
    assert page.text("pillars") == plain.text("pillars")
    assert "55 in contact" in page.text("load-numbers")
    # Many cells, with a sufficient number across the free annuli around pillars.
    assert "220\u202f000 cells" in page.text("cells-note") and "orders of magnitude" not in page.text("cells-note")
    assert page.page.evaluate("() => document.body.dataset.busy") == "yes"
    # The computation and the curve continue.
    stage = page.text("cycle-stage")
    assert re.match(r"loading, ζ = .* µm, fronts on the floor, round \d+, about \d+ %, [\d.]+ s$", stage), stage
    page.until("document.getElementById('cycle-stage').textContent.startsWith('unloading, ')")
    loading = time.monotonic() - began
    outline = "document.querySelector('#loading path.unloading').getAttribute('d')"
    before = page.page.evaluate(f"() => {outline}")
    page.until(f"{outline} !== {before!r}")
    share = page.page.evaluate("() => document.getElementById('cycle-share').value")
    assert 0.2 < share < 0.6
    start = time.monotonic()
    page.page.click("#call-off")
    page.rest()
    # At once, and whatever else the machine does: a small part of what has been computed.
    assert time.monotonic() - start < 0.1 * loading
    assert page.text("cycle-stage") == page.text("status") == "cancelled"
    assert page.text("load-words") == "critical state, the rest cancelled"
    assert page.page.locator("#loading path.unloading").count() == 1
    # The next answer uses all threads.
    start = time.monotonic()
    page.enter("adhesion.work", "1 mJ/m2")
    assert page.text("load-words") == "after the jump onto the floor"
    assert time.monotonic() - start < 0.5 * loading
    assert not page.page.is_visible("#request-again") and page.text("cells-note") == ""


def test_a_cancelled_request_is_sent_again_and_is_replaced_by_another_slider(explore):
    page = explore(QUICK)
    page.change("adhesion.work", "50 mJ/m2")
    until_solving(page)
    page.page.click("#call-off")
    page.rest()
    page.page.click("#request-again")
    until_solving(page)
    assert page.page.is_visible("#call-off") and not page.page.is_visible("#request-again")
    page.page.focus("#adhesion-work-slider")
    page.press("Home")
    page.rest()
    # Without a work of adhesion the floor is not adhesive either.
    assert page.text("load-words") == "critical state"
    for name in ("#cycle-progress", "#cells-note", "#to-jump", "#adhesion-floor"):
        assert not page.page.is_visible(name), name
    assert "adhesion" not in page.text("case-file")


def test_rings_too_narrow_for_cells_cause_a_note_before_they_are_solved(explore):
    page = explore(QUICK)
    page.change("adhesion.work", "200 mJ/m2")
    page.until("/orders of magnitude/.test(document.getElementById('cells-note').textContent)")
    assert "220\u202f000 cells" in page.text("cells-note")
    page.page.click("#call-off")
    page.rest()


def test_the_floor_can_be_made_adhesive_on_the_page(explore):
    page = explore(adhesive(0.03, 0.001))
    assert not page.page.is_visible("#adhesive-floor") and not page.page.is_visible("#to-jump")
    assert page.text("load-words") == "critical state"
    page.page.check("#adhesion-floor")
    page.rest()
    assert page.page.is_visible("#adhesive-floor") and page.page.is_visible("#to-jump")
    assert "floor = true" in page.text("case-file")
    assert "adhesion.floor=true" in page.text("command")
    assert "floor=True" in page.text("python")
    # The substrates of the paper do not change it.
    page.page.click("[data-preset=rigid]")
    page.rest()
    assert page.page.is_checked("#adhesion-floor")
    page.page.click("[data-preset=intermediate]")
    page.rest()
    # A floor whose contact is ignored is not adhesive.
    page.page.uncheck("#floor-contact")
    page.rest()
    assert not page.page.is_checked("#adhesion-floor") and not page.page.is_visible("#problem")
    page.page.check("#floor-contact")
    page.page.check("#adhesion-floor")
    page.rest()
    # It is available between elastic pillars too.
    page.page.select_option("#pattern-pillar-compliance", "elastic")
    page.rest()
    assert not page.page.is_visible("#problem")


@pytest.mark.server
def test_coarse_cells_are_orders_of_magnitude(explore):
    """A result on coarse cells is marked as such."""

    def coarse(route):
        response = route.fetch()
        text = response.text().replace('"coarse":false', '"coarse":true')
        route.fulfill(response=response, body=text)

    page = explore(QUICK, before=lambda page: page.route("**/api/cycle", coarse))
    assert "these are orders of magnitude" in page.text("adhesive-floor")
    assert page.page.locator("#adhesive-floor.strained").count() == 1


@pytest.mark.parametrize("width, height", [(390, 844), (1400, 900)])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_an_adhesive_floor_fits_every_screen(explore, width, height, scheme):
    page = explore(QUICK, width, height, color_scheme=scheme)
    assert page.page.evaluate("() => document.documentElement.scrollWidth - innerWidth") <= 0
    page.picture(f"adhesive-floor-{width}-{scheme}")
