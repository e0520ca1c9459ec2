"""All results on the screen belong to one case and load, or are grey.

Here answers are delayed, completely or from one of their lines on, so that intermediate states can be tested.
"""

import pytest
from test_explorer import paper

# Answers are delayed on their way from the server.
pytestmark = pytest.mark.server

# Elements that show the critical state of a case, and those that show a state at a load.
CASE = ["#force-value", "#radius-value", "#indentation-value", "#regime", "#pillars"]
LOAD = ["#map", "#colour-bar", "#colour-most", "#map-key .partial", "#section", "#load-numbers", "#limits"]
TEXTS = ["#command", "#python", "#case-file"]
CURVES = [
    *("#curve-force .exact-curve", "#curve-radius .exact-curve", "#curve-indentation .exact-curve"),
    "#curves-legend .exact-curve",
]
PHASE = [
    *("#phase .transition", "#phase path.path", "#phase .top-region"),
    *("#phase-legend .transition", "#loading-legend .path"),
]
NOW = [
    *("#phase .critical-point", "#curve-force .load-point"),
    *("#phase-legend .critical-point", "#curves-legend .load-point", "#loading-legend .critical-point"),
]

# Opacity of an element, including that of the elements that contain it.
OPACITY = """([selector]) => {
    let opacity = 1;
    for (let at = document.querySelector(selector); at !== null; at = at.parentElement) {
        opacity *= Number(getComputedStyle(at).opacity);
    }
    return opacity;
}"""

# Answers to contacts reach the page only up to the line that is to be delayed.
HOLD_LINES = """([key]) => {
    const original = window.fetch;
    let release;
    const released = new Promise((resolve) => (release = resolve));
    window.release = () => {
        window.fetch = original;
        release();
    };
    window.fetch = async (address, options) => {
        const response = await original(address, options);
        if (!String(address).endsWith("/api/contact") || !response.ok) return response;
        let text = "";
        const lines = new TransformStream({
            async transform(part, sink) {
                text += part;
                const whole = text.split("\\n");
                text = whole.pop();
                for (const line of whole) {
                    if (line.startsWith(`{"${key}"`)) await released;
                    sink.enqueue(line + "\\n");
                }
            },
        });
        const body = response.body
            .pipeThrough(new TextDecoderStream())
            .pipeThrough(lines)
            .pipeThrough(new TextEncoderStream());
        return new Response(body, { status: response.status });
    };
}"""


class Delayed:
    """A page of which some requests are delayed until they are released."""

    def __init__(self, explorer, *kinds):
        self.routes = []
        for kind in kinds:
            explorer.page.route(f"**/api/{kind}", self.hold)

    def hold(self, route):
        if self.routes is None:
            route.fallback()
        else:
            self.routes.append(route)

    def release(self):
        # Requests that arrive during the release are not delayed.
        routes, self.routes = self.routes, None
        for route in routes:
            route.continue_()


def opacity(explorer, selector):
    return explorer.page.evaluate(OPACITY, [selector])


def grey(explorer, selectors):
    """Waits until all of this is grey."""
    for selector in selectors:
        explorer.until(f"({OPACITY})(['{selector}']) < 0.6")


def plain(explorer, selectors):
    """Waits until all of this is as usual."""
    for selector in selectors:
        explorer.until(f"({OPACITY})(['{selector}']) === 1")


def move(explorer, name, value):
    """Moves a slider without waiting for the answer."""
    explorer.page.evaluate(
        """([name, value]) => {
            const slider = document.getElementById(name);
            slider.value = value;
            slider.dispatchEvent(new Event("input", { bubbles: true }));
        }""",
        [name, str(value)],
    )


@pytest.fixture
def filled(explore):
    """A page with its curves and its loading path."""

    def open_page(surface_fraction=0.01, **options):
        page = explore("#" + "&".join(paper(surface_fraction)), **options)
        page.until("document.querySelectorAll('#curve-force .exact-point').length > 20")
        page.until("document.querySelector('#phase path.beyond-path') !== null")
        return page

    return open_page


def test_everything_is_grey_until_the_new_case_is_solved(filled):
    page = filled()
    before = page.results()
    delayed = Delayed(page, "contact")
    move(page, "pattern-pillar-height-slider", 700)
    grey(page, CASE + LOAD + TEXTS + CURVES + PHASE + NOW)
    assert page.results() == before
    assert page.page.get_attribute("#section", "aria-busy") == "true"
    assert page.text("status") == "solving …"
    # Texts that are out of date cannot be copied.
    assert page.page.is_disabled("[data-copy=command]")
    delayed.release()
    page.rest()
    plain(page, CASE + LOAD + TEXTS + CURVES + PHASE + NOW)
    assert page.results() != before


def test_another_load_greys_what_depends_on_it(filled):
    page = filled()
    delayed = Delayed(page, "contact")
    move(page, "load", 0.5)
    grey(page, LOAD + TEXTS + ["#phase .load-point"])
    # The critical state belongs to the case, independent of the load.
    plain(page, CASE + CURVES + PHASE + NOW)
    # The text beside the slider belongs to its position.
    assert page.text("load-words").startswith("50")
    delayed.release()
    page.rest()
    plain(page, LOAD + TEXTS + ["#phase .load-point"])


def test_a_section_that_is_late_is_grey_beside_the_new_map(filled):
    page = filled()
    before = page.results()
    outline = page.page.get_attribute("#section path.lens", "d")
    page.page.evaluate(HOLD_LINES, ["section"])
    move(page, "pattern-pillar-height-slider", 700)
    page.until(f"document.getElementById('force-value').textContent !== '{before[0]}'")
    grey(page, ["#section"])
    assert page.page.get_attribute("#section path.lens", "d") == outline
    plain(page, CASE + ["#map", "#colour-bar", "#load-numbers"])
    page.page.evaluate("() => window.release()")
    page.rest()
    plain(page, CASE + LOAD)
    assert page.page.get_attribute("#section path.lens", "d") != outline


def test_curves_of_the_case_before_are_grey_beside_the_new_point(filled):
    page = filled()
    delayed = Delayed(page, "curves", "phase")
    place = page.page.get_attribute("#phase .critical-point", "cy")
    page.slide("pattern-pillar-height-slider", 600)
    grey(page, CURVES + PHASE)
    plain(page, NOW + CASE + LOAD)
    assert page.page.get_attribute("#phase .critical-point", "cy") != place
    delayed.release()
    plain(page, PHASE)
    page.until("document.querySelectorAll('#curve-force .exact-point').length > 3")
    plain(page, CURVES)


def test_beside_an_estimate_the_solution_of_the_case_before_is_grey(explore):
    # Enough pillars for an estimate to be drawn first.
    page = explore("#" + "&".join(paper(0.12)))
    most = page.text("colour-most")
    page.page.evaluate(HOLD_LINES, ["state"])
    move(page, "pattern-pillar-height-slider", 800)
    page.until("document.getElementById('force-value').textContent.startsWith('≈')")
    grey(page, ["#section", "#load-numbers", "#regime", "#pillars"] + TEXTS)
    plain(page, ["#force-value", "#radius-value", "#map", "#colour-bar"])
    # The colour scale belongs to the map that is shown.
    assert page.text("colour-most") != most
    page.page.evaluate("() => window.release()")
    page.rest()
    plain(page, CASE + LOAD + TEXTS)
    assert not page.results()[0].startswith("≈")


def test_after_an_error_all_that_is_shown_is_grey(filled):
    page = filled()
    before = page.results()
    page.enter("pattern.pillar.height", "5 mm")
    grey(page, CASE + LOAD + TEXTS + CURVES + PHASE + NOW)
    plain(page, ["#status", "#problem", "#pattern-pillar-height-note"])
    page.enter("pattern.pillar.height", "2.2 um")
    plain(page, CASE + LOAD + TEXTS + CURVES + PHASE + NOW)
    assert page.results() == before


def test_the_case_before_is_shown_again_at_once(filled):
    """After the return to an earlier case nothing is grey, although its answer has not arrived yet."""
    page = filled()
    Delayed(page, "contact")
    move(page, "pattern-pillar-height-slider", 700)
    grey(page, CASE + LOAD)
    page.page.fill("#pattern-pillar-height", "2.2 um")
    page.page.press("#pattern-pillar-height", "Enter")
    plain(page, CASE + LOAD + CURVES)


def test_the_store_takes_no_line_of_a_question_that_was_called_off(explore):
    page = explore("#" + "&".join(paper(0.01)))
    taken = page.page.evaluate(
        """async () => {
            const { Store, isOlder, isBusy } = await import("./store.js");
            const start = { version: "", case: {}, keys: [], colours: [], farthest_load: 1.5 };
            const chosen = { case: { "lens.radius": 1 }, load: 1, exaggeration: null };
            const store = new Store(start, chosen, 0);
            const line = (toml) => ({ case: { toml, command: "", python: "" } });
            const first = store.state.question;
            store.send("contact", first, 1);
            store.setValue("lens.radius", 2, false, 2);
            const second = store.state.question;
            const numbers = [first.number, second.number];
            store.end("contact", first.number, false, null);
            store.receive("contact", first.number, line("late"), 3);
            const late = store.state.texts;
            store.send("contact", second, 4);
            store.receive("contact", first.number, line("later"), 5);
            const later = store.state.texts;
            store.receive("contact", second.number, line("second"), 6);
            const { texts } = store.state;
            store.choose({ load: 0.5 }, 7);
            store.overdue(store.state.question);
            const older = ["case", "load"].map((what) => isOlder(store.state, texts, what));
            return { numbers, late, later, of: texts.of.number, toml: texts.is.toml, older,
                     busy: isBusy(store.state) };
        }"""
    )
    assert taken == {
        "numbers": [1, 2],
        "late": None,
        "later": None,
        "of": 2,
        "toml": "second",
        "older": [False, True],
        "busy": True,
    }


def test_parts_of_the_case_before_turn_grey_with_the_first_part_of_the_next(filled):
    """At the moment at which the critical force changes, not a fifth of a second later."""
    page = filled()
    page.page.evaluate(HOLD_LINES, ["section"])
    page.page.evaluate(
        """() => {
            window.seen = [];
            const ages = () => window.seen.push(
                document.getElementById("section").classList.contains("older"),
            );
            new MutationObserver(ages)
                .observe(document.getElementById("force-value"), { childList: true });
        }"""
    )
    move(page, "pattern-pillar-height-slider", 700)
    page.until("window.seen.length > 0")
    assert page.page.evaluate("() => window.seen") == [True]
    page.page.evaluate("() => window.release()")
    page.rest()
    plain(page, CASE + LOAD)


@pytest.mark.parametrize("line", ["critical", "case", "section"])
def test_the_store_ages_all_that_is_older_than_what_it_takes(explore, line):
    page = explore("#" + "&".join(paper(0.01)))
    aged = page.page.evaluate(
        """async ([name]) => {
            const { Store, isOlder } = await import("./store.js");
            const start = { version: "", case: {}, keys: [], colours: [], farthest_load: 1.5 };
            const chosen = { case: { "lens.radius": 1 }, load: 1, exaggeration: null };
            const store = new Store(start, chosen, 0);
            const lines = {
                critical: { critical: {} },
                case: { case: { toml: "", command: "", python: "" } },
                section: { section: null },
            };
            const parts = { critical: "critical", case: "texts", section: "section" };
            store.send("contact", store.state.question, 1);
            for (const line of Object.values(lines)) store.receive("contact", 1, line, 2);
            store.end("contact", 1, true, null);
            store.setValue("lens.radius", 2, false, 3);
            store.send("contact", store.state.question, 4);
            const older = () => Object.fromEntries(Object.entries(parts).map(
                ([line, part]) => [line, isOlder(store.state, store.state[part], "load")],
            ));
            store.receive("contact", 2, { progress: {} }, 5);
            const before = older();
            store.receive("contact", 2, lines[name], 6);
            return [before, older()];
        }""",
        [line],
    )
    parts = ["critical", "case", "section"]
    assert aged == [{part: False for part in parts}, {part: part != line for part in parts}]


def test_the_section_is_shown_at_first_touch_too(explore):
    page = explore("#" + "&".join(paper(0.01)))
    page.slide("load", 0)
    assert page.page.locator("#section path.lens").count() == 1
    assert page.page.locator("#section path.floor-mark").count() == 0


def test_the_floor_contact_is_marked_in_the_critical_state_only(explore):
    # By symmetry the floor is touched along x, on both sides of the axis.
    page = explore("#" + "&".join(paper(0.01)))
    assert page.page.locator("#section path.floor-mark").count() == 2
    page.slide("load", 0.9)
    assert page.page.locator("#section path.floor-mark").count() == 0


def test_a_value_that_is_typed_moves_its_slider(explore):
    page = explore("#" + "&".join(paper(0.01)))
    place = page.page.input_value("#pattern-pillar-height-slider")
    page.enter("pattern.pillar.height", "3 um")
    assert page.page.input_value("#pattern-pillar-height") == "3 um"
    assert int(page.page.input_value("#pattern-pillar-height-slider")) > int(place)


def test_a_button_pressed_twice_has_its_label_again(explore):
    page = explore("#" + "&".join(paper(0.01)))
    page.page.click("#copy-link")
    page.until("document.getElementById('copy-link').textContent !== 'copy link'")
    page.page.click("#copy-link")
    # The text disappears after 1.2 s.
    page.page.wait_for_timeout(2500)
    assert page.text("copy-link") == "copy link"
