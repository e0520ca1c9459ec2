"""Past the transition: the floor on the map, in the section, in the numbers and in the curve of the loading."""

import json
import os
import re
import subprocess

import pytest
from test_explorer import paper

# Colour of the map at a fraction of its width and height.
PIXEL = """([x, y]) => {
    const map = document.getElementById("map");
    const at = [Math.floor(x * map.width), Math.floor(y * map.height)];
    return [...map.getContext("2d").getImageData(...at, 1, 1).data].slice(0, 3);
}"""

# Positions on the map, as fractions of its width and height, at which its note describes the floor.
ON_FLOOR = """() => {
    const map = document.getElementById("map");
    const { left, top, width, height } = map.getBoundingClientRect();
    const found = [];
    for (let x = 0.02; x < 1; x += 0.02) {
        for (let y = 0.02; y < 1; y += 0.02) {
            const place = { clientX: left + x * width, clientY: top + y * height };
            map.dispatchEvent(new PointerEvent("pointermove", place));
            const note = document.getElementById("map-note").textContent;
            if (note.startsWith("floor in contact, about")) found.push([x, y]);
        }
    }
    return found;
}"""


def mixed(surface_fraction, load, *more):
    return "#" + "&".join([*paper(surface_fraction), f"load={load}", *more])


def quantity(text):
    """A number with its unit, in SI units."""
    number, unit = re.match(r"([\d.]+) (\S+)", text).groups()
    return float(number) * {"nN": 1e-9, "µN": 1e-6, "mN": 1e-3, "µm": 1e-6, "nm": 1e-9}[unit]


def test_the_load_slider_continues_into_mixed_contact(explore, tmp_path):
    page = explore("#" + "&".join(paper(0.03)))
    assert not page.page.is_visible("#floor-numbers")
    assert not page.page.is_visible("#floor-key")
    assert float(page.page.get_attribute("#load", "max")) >= 2.5
    page.slide("load", 1.8)
    assert page.page.is_visible("#floor-numbers")
    assert not page.page.is_visible("#beyond-note")
    # The numbers are those of the program, rounded to their errors.
    command = page.text("command").replace("fakir ", os.environ["FAKIR"] + " ")
    done = subprocess.run(
        command + " --json", shell=True, cwd=tmp_path, check=True, capture_output=True, text=True
    )
    floor = json.loads("{" + done.stdout.split("{", 1)[1])["floor"]
    assert quantity(page.text("floor-force")) == pytest.approx(floor["force_N"], rel=0.05)
    share = float(page.text("floor-share").split()[0])
    assert share == pytest.approx(100 * floor["share"], rel=0.05)
    assert "error" in page.text("floor-force-error") and "error" in page.text("floor-area-error")
    area = float(page.text("floor-area").split()[0])
    assert area == pytest.approx(1e12 * floor["contact_area_m2"], rel=0.05)
    rim = quantity(page.text("floor-rim"))
    assert rim == pytest.approx(floor["smallest_distance_to_rim_m"], rel=0.01)
    patches = "not resolved" if floor["patches"] is None else str(floor["patches"])
    assert page.text("floor-patches") == patches
    page.slide("load", 0.9)
    assert not page.page.is_visible("#floor-numbers")


@pytest.mark.smoke
def test_the_floor_in_contact_is_on_the_map_and_in_the_section(explore):
    page = explore(mixed(0.03, 1.8))
    assert page.page.is_visible("#floor-key")
    assert "Pa" in page.text("floor-most")
    assert not page.page.is_visible("#touch-key")
    assert "the floor is in contact" in page.page.get_attribute("#map", "aria-label")
    places = page.page.evaluate(ON_FLOOR)
    assert len(places) > 20
    # Between the colours of the smallest and the largest pressure.
    for place in places[:: len(places) // 20]:
        red, green, blue = page.page.evaluate(PIXEL, place)
        assert red < green < blue, (place, red, green, blue)
    assert page.page.locator("#section path.floor-part").count() > 0
    page.slide("load", 1)
    assert not page.page.is_visible("#floor-key") and page.page.is_visible("#touch-key")
    assert page.page.evaluate(ON_FLOOR) == []
    assert page.page.locator("#section path.floor-part").count() == 0


def test_without_floor_contact_the_floor_is_ignored(explore):
    page = explore(mixed(0.03, 1.8))
    force = quantity(re.search(r"F = ([^,]+)", page.text("load-numbers")).group(1))
    assert page.page.is_checked("#floor-contact")
    page.page.uncheck("#floor-contact")
    page.rest()
    assert not page.page.is_visible("#floor-numbers") and not page.page.is_visible("#floor-key")
    assert page.page.is_visible("#beyond-note")
    # A negative gap, as in the paper.
    assert re.search(r"gap\s+−[\d.]+ (nm|µm)", page.text("beyond-note"))
    through = quantity(re.search(r"F = ([^,]+)", page.text("load-numbers")).group(1))
    assert through < 0.97 * force
    assert "contact = false" in page.text("case-file")
    assert "floor_contact=False" in page.text("python")
    assert "floor.contact=false" in page.text("command")
    # The substrates of the paper do not change it.
    assert page.page.get_attribute("[data-preset=intermediate]", "aria-pressed") == "true"
    page.page.click("[data-preset=soft]")
    page.rest()
    assert not page.page.is_checked("#floor-contact")
    page.page.click("[data-preset=intermediate]")
    page.rest()
    page.page.check("#floor-contact")
    page.rest()
    assert page.page.is_visible("#floor-numbers")


def test_other_methods_report_that_they_do_not_support_floor_contact(explore):
    page = explore(mixed(0.01, 1.5))
    page.page.select_option("#method-name", "punch")
    page.rest()
    assert page.page.is_visible("#beyond-note")
    assert not page.page.is_visible("#floor-numbers")


def test_the_loading_is_drawn_through_the_transition(explore):
    page = explore(mixed(0.01, 1.8))
    page.until("document.querySelector('#loading path.floor-force') !== null")
    assert page.page.locator("#loading circle.critical-point").count() == 1
    # The force, and that on the floor.
    assert page.page.locator("#loading circle.load-point").count() == 2
    assert page.page.locator("#loading path.floor-path").count() == 1
    page.page.uncheck("#floor-contact")
    page.rest()
    page.until("document.querySelector('#loading path.fiction-path') !== null")
    assert page.page.locator("#loading path.floor-force").count() == 0
    assert page.page.locator("#loading circle.load-point").count() == 1


def test_the_pillar_tops_alone_are_shown_until_the_floor_is_solved(explore):
    page = explore(mixed(0.1, 1.2))
    stages = page.page.evaluate(
        """async () => {
            const stages = [];
            document.addEventListener("picture", (event) => stages.push(event.detail.stage));
            const slider = document.getElementById("load");
            slider.value = 1.5;
            slider.dispatchEvent(new Event("input", { bubbles: true }));
            while (!stages.includes("exact")) await new Promise((next) => setTimeout(next, 5));
            return stages;
        }"""
    )
    assert stages[-1] == "exact" and "pillars" in stages
    page.rest()
    assert page.page.is_visible("#floor-numbers")


@pytest.mark.parametrize("width, height", [(390, 844), (1400, 900)])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_mixed_contact_fits_every_screen(explore, width, height, scheme):
    page = explore(mixed(0.03, 1.8), width, height, color_scheme=scheme)
    page.until("document.querySelector('#loading path.floor-force') !== null")
    assert page.page.evaluate("() => document.documentElement.scrollWidth - innerWidth") <= 0
    # No number of the floor is cut off.
    cut = page.page.evaluate(
        """() => [...document.querySelectorAll("#floor-numbers dd, #floor-key span")]
            .filter((x) => x.scrollWidth > x.clientWidth + 1 && getComputedStyle(x).display !== "inline")
            .map((x) => x.id)"""
    )
    assert cut == []
    page.picture(f"mixed-{width}-{scheme}")
