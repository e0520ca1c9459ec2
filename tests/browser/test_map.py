"""The part of the map that is shown: buttons, keys, wheel, pointer and fingers, with values under the pointer and files."""

import re
from pathlib import Path

import pytest
from test_explorer import paper

# The note of the map at a fraction of its width and height.
NOTE = """([across, down]) => {
    const map = document.getElementById("map");
    const { left, top, width, height } = map.getBoundingClientRect();
    const place = { bubbles: true, clientX: left + across * width, clientY: top + down * height };
    map.dispatchEvent(new PointerEvent("pointermove", place));
    return document.getElementById("map-note").textContent;
}"""

WORDS = re.compile(r"× (\S+), centre x = (\S+)(?: (\S+))?, y = (\S+)(?: (\S+))?")
UNITS = {None: 1, "µm": 1, "mm": 1e3, "nm": 1e-3}


def view(page):
    """Magnification and centre of the map, um."""
    zoom, x, unit_x, y, unit_y = WORDS.fullmatch(page.text("zoom-words")).groups()
    return [float(zoom), *(float(value.replace("−", "-")) * UNITS[unit] for value, unit in ((x, unit_x), (y, unit_y)))]


def note(page, across, down):
    return page.page.evaluate(NOTE, [across, down])


def distance(words):
    value, unit = re.search(r"(\S+) (nm|µm|mm) from the axis", words).groups()
    return float(value) * UNITS[unit]


def test_keys_magnify_and_move_the_map(explore):
    page = explore("#" + "&".join(paper(0.03)))
    corner = distance(note(page, 0.99, 0.5))
    page.page.focus("#map-frame")
    for _ in range(4):
        page.press("+")
    # Every step magnifies by 1.5.
    zoom = 1.5**4
    assert view(page) == pytest.approx([zoom, 0, 0], rel=2e-3)
    assert distance(note(page, 0.99, 0.5)) == pytest.approx(corner / zoom, rel=0.02)
    page.press("ArrowRight")
    page.press("ArrowUp")
    _, x, y = view(page)
    # An arrow moves by 0.3 of half the width.
    assert x == pytest.approx(0.3 * corner / 0.98 / zoom, rel=0.02) and y == pytest.approx(x)
    assert distance(note(page, 0.5, 0.5)) == pytest.approx(2**0.5 * x, rel=0.02)
    for _ in range(30):
        page.press("ArrowLeft")
    # It ends at the side of the whole map.
    assert view(page)[1] == pytest.approx(-(1 - 1 / zoom) * corner / 0.98, rel=0.02)
    page.press("-")
    assert view(page)[0] == pytest.approx(1.5**3, rel=1e-2)
    page.press("0")
    assert page.text("zoom-words") == ""
    assert page.page.is_disabled("#zoom-out") and page.page.is_disabled("#zoom-whole")


def touch(page, kind, *places):
    """A touch of the screen by fingers at these fractions of the width and height of the map."""
    box = page.page.locator("#map").bounding_box()
    points = [{"x": box["x"] + x * box["width"], "y": box["y"] + y * box["height"], "id": k} for k, (x, y) in enumerate(places)]
    page.cdp.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})


def test_two_fingers_magnify_the_map(explore):
    """The places under the fingers follow them: their distance is the magnification, their middle stays or moves the map."""
    page = explore("#" + "&".join(paper(0.03)), has_touch=True)
    page.cdp = page.page.context.new_cdp_session(page.page)
    page.page.locator("#map").scroll_into_view_if_needed()
    top = page.page.evaluate("() => scrollY")
    corner = distance(note(page, 0.99, 0.5)) / 0.98
    touch(page, "touchStart", (0.5, 0.3))
    touch(page, "touchStart", (0.5, 0.3), (0.7, 0.3))
    for k in range(1, 6):
        touch(page, "touchMove", (0.5 - 0.02 * k, 0.3), (0.7 + 0.02 * k, 0.3))
    page.until("document.getElementById('zoom-words').textContent !== ''")
    # From 0.2 to 0.4 of the width, around the place at 0.6 and 0.3: 0.1 and 0.2 of the width beside the axis.
    zoom, x, y = view(page)
    assert zoom == pytest.approx(2, rel=0.02)
    assert [x, y] == pytest.approx([0.2 * corner / 2, 0.4 * corner / 2], rel=0.05)
    # Both to the left, by a tenth of the width: the map follows.
    for k in range(1, 6):
        touch(page, "touchMove", (0.4 - 0.02 * k, 0.3), (0.8 - 0.02 * k, 0.3))
    page.until(f"!document.getElementById('zoom-words').textContent.includes('x = {x:.3g}')")
    page.page.wait_for_timeout(100)
    assert view(page)[0] == pytest.approx(2, rel=0.02)
    assert view(page)[1] == pytest.approx(x + 0.2 * corner / 2, rel=0.05)
    touch(page, "touchEnd")
    assert page.page.evaluate("() => scrollY") == top
    # One finger moves the magnified map, as a pointer does.
    before = view(page)[2]
    touch(page, "touchStart", (0.5, 0.5))
    for k in range(1, 6):
        touch(page, "touchMove", (0.5, 0.5 - 0.02 * k))
    touch(page, "touchEnd")
    page.page.wait_for_timeout(100)
    assert view(page)[2] == pytest.approx(before - 0.2 * corner / 2, rel=0.1)


def test_the_wheel_magnifies_around_the_pointer(explore):
    """The value under the pointer stays; without a modifier the wheel scrolls the page."""
    page = explore("#" + "&".join(paper(0.03)))
    before = distance(note(page, 0.75, 0.4))
    box = page.page.locator("#map").bounding_box()
    page.page.mouse.move(box["x"] + 0.75 * box["width"], box["y"] + 0.4 * box["height"])
    page.page.mouse.wheel(0, -120)
    page.page.wait_for_timeout(200)
    assert page.text("zoom-words") == ""
    page.page.evaluate("() => scrollTo(0, 0)")
    page.page.keyboard.down("Control")
    page.page.mouse.wheel(0, -600)
    page.page.keyboard.up("Control")
    page.until("document.getElementById('zoom-words').textContent !== ''")
    assert view(page)[0] == pytest.approx(2.718**1.5, rel=0.05)
    assert distance(note(page, 0.75, 0.4)) == pytest.approx(before, rel=0.02)


def test_the_map_is_dragged_and_the_link_restores_it(explore):
    page = explore("#" + "&".join(paper(0.03)))
    for _ in range(4):
        page.page.click("#zoom-in")
    box = page.page.locator("#map").bounding_box()
    middle = (box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    before = distance(note(page, 0.25, 0.5))
    page.page.mouse.move(*middle)
    page.page.mouse.down()
    page.page.mouse.move(middle[0] + box["width"] / 4, middle[1], steps=5)
    page.page.mouse.up()
    # What was a quarter of the width left of the centre is now the centre.
    assert -view(page)[1] == pytest.approx(before, rel=0.03)
    # The address follows after a while; the button writes it at once.
    page.page.click("#copy-link")
    again = explore("#" + page.page.url.split("#")[1])
    assert view(again) == view(page)
    assert again.text("force-value") == page.text("force-value")
    page.page.click("#reset")
    page.until("document.getElementById('zoom-words').textContent === ''")


def test_the_map_is_saved_as_shown(explore, tmp_path):
    """The saved picture has the magnified pillars."""
    page = explore("#" + "&".join(paper(0.03)))
    pictures = []
    for name in ("whole", "part"):
        if name == "part":
            for _ in range(6):
                page.page.click("#zoom-in")
        page.page.click("#export-menu summary")
        with page.page.expect_download() as saved:
            page.page.click("[data-shown='map.png']")
        pictures.append(Path(saved.value.path()).read_bytes())
        page.page.keyboard.press("Escape")
    assert all(picture.startswith(b"\x89PNG") for picture in pictures)
    assert pictures[0] != pictures[1]


def test_a_printed_page_is_light_and_has_no_controls(explore):
    """The map is a picture with three pixels for each of the screen, in which the pillars are seen."""
    page = explore("#" + "&".join(paper(0.03)), color_scheme="dark")
    page.page.emulate_media(media="print", color_scheme="dark")
    page.until("document.getElementById('map').width === 3 * document.getElementById('map').clientWidth")
    assert page.page.evaluate("() => getComputedStyle(document.documentElement).colorScheme") == "light"
    colours = page.page.evaluate("""() => {
        const map = document.getElementById("map");
        const context = map.getContext("2d");
        return [[0.05, 0.5], [0.508, 0.506]].map(([x, y]) =>
            [...context.getImageData(Math.floor(x * map.width), Math.floor(y * map.height), 1, 1).data]);
    }""")
    # The floor of the light style, and the pillar at the axis, beside its cross, in the last colour of the map.
    assert min(colours[0][:3]) > 150
    assert colours[1][0] > 200 and colours[1][2] < 100
    for button in ("#open-table", "#open-curve", "#zoom-in", "#compare-button", "#play"):
        assert page.page.locator(button).is_hidden()
