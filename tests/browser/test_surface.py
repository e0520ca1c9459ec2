"""A height map that is dropped on the page: the lens on it, first on large cells."""

import base64
import json
import os
import struct
import subprocess

import pytest
from conftest import exploring
from test_explorer import paper
from test_table import DROP

# Drops a file with this name and these bytes on the page.
DROP_BYTES = """([name, text]) => {
    const data = new DataTransfer();
    data.items.add(new File([Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0))], name));
    document.body.dispatchEvent(new DragEvent("drop", { bubbles: true, cancelable: true, dataTransfer: data }));
}"""

WIDTH = 200e-6
BUMP = 1e-3
LENS = 2.2e-3


def bump(side):
    """A round bump as an array of NumPy, in metres."""
    at = [WIDTH * ((k + 0.5) / side - 0.5) for k in range(side)]
    heights = [-(x * x + y * y) / (2 * BUMP) for y in at for x in at]
    head = f"{{'descr': '<f4', 'fortran_order': False, 'shape': ({side}, {side}), }}".ljust(117) + "\n"
    start = b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head))
    return base64.b64encode(start + head.encode() + struct.pack(f"<{len(heights)}f", *heights)).decode()


def hertz(indentation):
    """Force of two spheres of 2 MPa and Poisson's ratio 0.5."""
    radius = 1 / (1 / LENS + 1 / BUMP)
    return 4 / 3 * (2e6 * 2 / 3) * radius**0.5 * indentation**1.5


def force(page):
    value, unit = page.text("surface-numbers").split("F = ")[1].split()[:2]
    return float(value) * {"mN": 1e-3, "µN": 1e-6}[unit.rstrip(",")]


def test_a_height_map_is_answered_and_refined(explore):
    page = explore("#" + "&".join(paper(0.01)))
    before = page.results()
    page.page.evaluate(DROP_BYTES, ["bump.npy", bump(192)])
    # The file states no size: the answer names the key.
    page.until("document.getElementById('map-words').textContent.includes('surface.width')")
    page.page.fill("#map-width", "200 um")
    page.page.press("#map-width", "Enter")
    page.until("document.getElementById('map-words').textContent.startsWith('192 × 192 cells (all points)')")
    # At first half the range of the heights: 5 um of the corners of the bump.
    assert force(page) == pytest.approx(hertz(0.5 * (WIDTH * 191 / 192) ** 2 / (4 * BUMP)), rel=2e-2)
    page.page.focus("#map-indentation")
    for _ in range(25):
        page.press("ArrowLeft")
    page.until("document.getElementById('map-indentation').getAttribute('aria-valuetext') === '4.00 µm' "
               "|| document.getElementById('map-indentation').getAttribute('aria-valuetext').startsWith('3.9')")
    page.until("document.getElementById('map-words').textContent.startsWith('192 × 192')")
    depth = float(page.page.get_attribute("#map-indentation", "aria-valuetext").split()[0]) * 1e-6
    assert force(page) == pytest.approx(hertz(depth), rel=2e-2)
    assert page.page.eval_on_selector_all("#surface-section path", "(all) => all.length") > 3
    assert 'height_map = "bump.npy"' in page.text("surface-case") and "fakir press" in page.text("surface-command")
    page.picture("surface")
    # The contact is where the pressure is: the middle of the map is coloured, its corner grey.
    colours = page.page.evaluate("""() => {
        const map = document.getElementById("surface-map");
        const at = (part) => [...map.getContext("2d").getImageData(part * map.width, part * map.height, 1, 1).data.slice(0, 3)];
        return [at(0.52), at(0.15)];
    }""")
    assert len(set(colours[0])) > 1 and len(set(colours[1])) == 1, colours
    # A stiffer lens and substrate: the force is proportional to the modulus.
    soft = force(page)
    numbers = "F = " + page.page.text_content("#surface-numbers").split("F = ")[1].split(",")[0]
    page.enter("substrate.young_modulus", "4 MPa")
    page.enter("lens.young_modulus", "4 MPa")
    page.until(f"document.getElementById('surface-case').textContent.includes('young_modulus = \"4 MPa\"')")
    page.page.wait_for_timeout(500)
    # In one look: the words of the map before stay until the first coarse map of the new case.
    page.until("document.getElementById('map-words').textContent.startsWith('192 × 192') "
               f"&& !document.getElementById('surface-numbers').textContent.includes({numbers!r})")
    assert force(page) == pytest.approx(2 * soft, rel=1e-2)
    page.page.click("#close-map")
    assert page.page.locator("#surface").is_hidden()
    assert page.results() != before


BODIES = """
[lens]
radius = "2.2 mm"
young_modulus = "2 MPa"
poisson_ratio = 0.5

[substrate]
young_modulus = "2 MPa"
poisson_ratio = 0.5
"""

BUMP_CASE = BODIES + """
[surface]
height_map = "maps/bump.npy"
width = "200 um"
"""

SQUARES = BODIES + """
[adhesion]
work = "5 mJ/m2"

[surface]
arrangement = "square"
pitch = "30 um"

[surface.pillar]
cross_section = "square"
side = "12 um"
height = "4 um"

[surface.grid]
width = "160 um"
cells_per_diameter = 6
"""


@pytest.mark.server
@pytest.mark.parametrize("name, text, cells", [("bump.npy", BUMP_CASE, "192 × 192"), ("of the case", SQUARES, "")])
def test_a_case_with_a_surface_is_where_the_page_begins(explore, tmp_path, name, text, cells):
    (tmp_path / "maps").mkdir()
    (tmp_path / "maps" / "bump.npy").write_bytes(base64.b64decode(bump(192)))
    case = tmp_path / "case.toml"
    case.write_text(text)
    with exploring(str(case)) as address:
        page = explore(address=address)
        page.until("/^[0-9]+ × [0-9]+ cells .all points/.test(document.getElementById('map-words').textContent)")
        assert page.text("map-name") == name and page.text("map-words").startswith(cells)
        assert page.page.input_value("#lens-radius") == "2.2 mm"
        # The numbers are those of the command that the page shows.
        indentation = page.text("surface-command").split("--indentation ")[1]
        command = [os.environ["FAKIR"], "press", str(case), "--indentation", indentation, "--json"]
        answer = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
        assert force(page) == pytest.approx(answer["force_N"], rel=5e-3)
        page.picture(f"surface-{name}")


@pytest.mark.server
def test_a_surface_that_cannot_be_read_is_an_error_of_the_command(tmp_path):
    case = tmp_path / "case.toml"
    case.write_text(BUMP_CASE)
    ended = subprocess.run([os.environ["FAKIR"], "explore", "--no-browser", str(case)], capture_output=True, text=True, timeout=20)
    assert ended.returncode == 2
    assert "case.toml" in ended.stderr and "surface.height_map" in ended.stderr and "bump.npy" in ended.stderr


@pytest.mark.parametrize(
    "name, text, words",
    [
        ("heights.npy", "\x93NUMPY", "heights.npy"),
        ("heights.txt", "\n".join(["0.1 " * 20] * 20), "surface.width"),
        ("heights.npz", "PK", "save one array as .npy"),
        ("heights.asc", "ncols 3\nnrows 2\n", "heights.asc"),
    ],
)
def test_maps_that_cannot_be_placed_are_refused_in_words(explore, name, text, words):
    page = explore("#" + "&".join(paper(0.01)))
    page.page.evaluate(DROP, [name, text])
    page.until(f"document.getElementById('map-words').textContent.includes({words!r})")
    assert page.page.locator("#surface-answer").is_hidden()
    assert page.page.locator("#problem").is_hidden()
