"""A load on viscoelastic bodies that is held over time."""

import math
import re
import tomllib
from pathlib import Path

import pytest
from test_explorer import paper

UNITS = {"N": 1, "mN": 1e-3, "µN": 1e-6, "m": 1, "µm": 1e-6, "nm": 1e-9, "s": 1, "ms": 1e-3}

# One term of strength 1 and a relaxation time of 10 s.
RELAXING = ["relaxation.strengths=1", "relaxation.times=10 s"]


def number(words, symbol):
    """The value of a quantity in a line of numbers, in SI units."""
    value, unit = re.search(rf"{symbol} = (\S+) ([^\s,;]+)", words).groups()
    return float(value.replace("−", "-")) * UNITS[unit]


def held(page):
    page.until("!document.getElementById('time-box').hidden && document.getElementById('hold-words').textContent === ''")
    page.rest()


def test_a_held_force_creeps_onto_the_floor(explore):
    """At 1.2 times the relaxed critical force the lens reaches the floor after 2 tau ln 3 = 21.97 s: J(t) = 1 - exp(-t/(2 tau))/2."""
    page = explore("#" + "&".join(paper(0.01)))
    assert page.page.locator("#over-time").is_hidden()
    page.enter("relaxation.strengths", "1")
    # A strength without a time is given one.
    assert page.page.input_value("#relaxation-times") == "10 s"
    page.page.click("#hold-button")
    held(page)
    critical = number(f"F = {page.text('force-value')} {page.text('force-unit')}", "F")
    for name, value in [("load", f"{1.2e6 * critical:.6g} uN"), ("ramp", "0"), ("for", "1 min")]:
        page.page.fill(f"#hold-{name}", value)
        page.page.press(f"#hold-{name}", "Enter")
    page.until("document.getElementById('hold-results').textContent.includes('floor contact after')")
    held(page)
    time = number(page.text("hold-results").replace("floor contact after ", "floor contact = "), "floor contact")
    assert time == pytest.approx(20 * math.log(3), rel=2e-3)
    # The end is shown: the floor carries load, and the indentation creeps from the elastic one at twice the modulus.
    assert float(page.page.input_value("#load")) > 1
    end = page.text("time-numbers")
    assert number(end, "F") == pytest.approx(1.2 * critical, rel=2e-3)
    picture = page.page.evaluate("() => document.getElementById('section').innerHTML")
    page.page.focus("#time")
    page.press("Home")
    page.rest()
    begin = page.text("time-numbers")
    assert page.text("time-words") == "t = 0 s"
    assert number(begin, "ζ") < number(end, "ζ")
    assert number(begin, "F") == pytest.approx(number(end, "F"), rel=1e-3)
    assert page.page.get_attribute("#time", "aria-valuetext") == "t = 0 s"
    # Section and load follow the time: the contact of half the force on relaxed bodies.
    assert page.page.evaluate("() => document.getElementById('section').innerHTML") != picture
    assert number(page.text("load-numbers"), "F") == pytest.approx(0.5 * number(begin, "F"), rel=2e-3)
    assert number(page.text("load-numbers"), "ζ") == pytest.approx(number(begin, "ζ"), rel=2e-3)
    for _ in range(2):
        page.press("ArrowRight")
    page.rest()
    assert page.text("time-words") != "t = 0 s"
    page.picture("hold")
    # A text that is being typed stays when the history arrives.
    page.page.focus("#hold-for")
    page.page.keyboard.press("Control+A")
    page.page.keyboard.type("7")
    page.slide("load", 0.7)
    assert page.page.input_value("#hold-for") == "7"
    for chart, name in [("force", "F"), ("indentation", "ζ"), ("radius", "a"), ("share", "floor force/F")]:
        labels = page.page.eval_on_selector_all(f"#hold-{chart} .label", "(all) => all.map((x) => x.textContent)")
        # The lowest one has the axis of all.
        assert labels == (["time t"] if chart == "share" else []) + [name]
    # A load of its own leaves the history.
    assert page.text("time-words") == "the load was moved by itself"


def test_a_link_and_the_files_carry_the_load_over_time(explore):
    page = explore("#" + "&".join([*paper(0.01), *RELAXING, "hold=indentation 0.000002 1 30", "time=5"]))
    held(page)
    shown = page.text("time-words")
    assert number(shown, "t") == pytest.approx(5, rel=0.1)
    page.until("location.hash.includes('time=')")
    again = explore("#" + page.page.url.split("#")[1])
    held(again)
    assert again.text("time-words") == shown
    assert again.text("time-numbers") == page.text("time-numbers")
    assert again.page.input_value("#hold-load") == "2 µm"
    assert "fakir hold case.toml --indentation 2um --ramp 1s --for 30s" in page.text("command")
    assert "system.hold(indentation=\"2 um\"" in page.text("python")
    # In relaxation the force falls to half the force that a step would have.
    page.page.click("#export-menu summary")
    for name, check in [
        ("case.toml", lambda text: tomllib.loads(text)["relaxation"] == {"strengths": [1], "times": ["10 s"]} and "--indentation 2um --ramp 1s --for 30s" in text.splitlines()[0]),
        ("history.csv", lambda text: text.startswith("time_s,") and len(text.splitlines()) > 40),
        ("history.svg", lambda text: "<svg" in text),
    ]:
        with page.page.expect_download() as saved:
            page.page.click(f"[data-file='{name}']")
        assert check(Path(saved.value.path()).read_text()), name


@pytest.mark.parametrize(
    "parts, words",
    [
        (["adhesion.work=0.05"], "adhesi"),
        (["pattern.surface_fraction=0.25"], "takes too long for the page"),
    ],
)
def test_what_is_not_computed_over_time_is_refused_in_words(explore, parts, words):
    parts = [*paper(0.01), *RELAXING, *parts, "hold=force 0.00005 0 60"]
    page = explore("#" + "&".join(parts))
    page.until(f"document.getElementById('hold-words').textContent.includes({words!r})")
    assert page.page.locator("#time-box").is_hidden()
    field = page.page.locator("#hold-load")
    field.fill("a lot")
    field.press("Enter")
    assert "a lot is no force" in page.text("hold-words")
