"""Adhesion: the load moves back and forth along one computed path, on the map, in the section, in the chart and in numbers."""

import json
import os
import re
import subprocess
import tomllib

import pytest
from conftest import exploring
from test_explorer import paper

# Number of pixels of the map with about the colour of tension: much more red, neither orange nor grey.
RED = """() => {
    const map = document.getElementById("map");
    const { data } = map.getContext("2d").getImageData(0, 0, map.width, map.height);
    let found = 0;
    for (let k = 0; k < data.length; k += 4) {
        const [red, green, blue] = data.slice(k, k + 3);
        if (red > green + 40 && red > blue + 40 && Math.abs(green - blue) < 40) found += 1;
    }
    return found;
}"""

# Content of the map, as one text.
PICTURE = "() => document.getElementById('map').toDataURL()"


def adhesive(surface_fraction, work, *more):
    return "#" + "&".join([*paper(surface_fraction), f"adhesion.work={work}", *more])


def command_line(*arguments):
    """Output of the command line for the paper's case with adhesion."""
    command = [os.environ["FAKIR"], "cycle", "-", "--json", "--quiet", *arguments]
    text = subprocess.run(
        [os.environ["FAKIR"], "init", "-"], check=True, capture_output=True, text=True
    ).stdout
    done = subprocess.run(command, input=text, check=True, capture_output=True, text=True)
    return json.loads(done.stdout)


def quantity(text):
    """A number with its unit, in SI units."""
    number, unit = re.match(r"([−\d.]+) (\S+)", text).groups()
    units = {"m": 1, "N": 1, "nN": 1e-9, "µN": 1e-6, "mN": 1e-3, "µm": 1e-6, "nm": 1e-9, "pJ": 1e-12, "fJ": 1e-15}
    return float(number.replace("−", "-")) * units[unit.rstrip(",")]


def force(page):
    return quantity(page.text("load-numbers").removeprefix("F = "))


def asked(page, path):
    return sum(url.endswith(path) for url in page.requests)


@pytest.fixture
def expected(tmp_path):
    return command_line("--set", "pattern.surface_fraction=0.03", "--set", "adhesion.work=10mJ/m2")


@pytest.mark.server
def test_the_slider_moves_back_and_forth_along_the_computed_path(explore, expected):
    page = explore(adhesive(0.03, 0.01))
    assert page.text("load-words") == "critical state"
    assert asked(page, "/api/cycle") == 1
    assert asked(page, "/api/contact") == 0
    states = int(page.page.get_attribute("#load", "max")) + 1
    assert states > 80
    # The keyboard moves from one state to the next, without any other request.
    page.page.focus("#load")
    page.press("Home")
    assert page.text("load-words") == "first contact"
    forces, words = [], []
    for _ in range(states):
        forces.append(force(page))
        words.append(page.text("load-words"))
        page.press("ArrowRight")
    assert asked(page, "/api/cycle") == 1
    turn = words.index("critical state")
    assert forces[turn] == pytest.approx(expected["critical_force_N"], rel=1e-3)
    assert forces[turn] == max(forces)
    assert min(forces) == forces[words.index("unloading, pull-off")]
    assert min(forces) == pytest.approx(expected["pull_off_force_N"], rel=1e-3)
    assert words[-1] == "last release" and words.count("critical state") == 1
    assert all(word.startswith("loading, ") for word in words[1:turn])
    assert all(word.startswith("unloading, ") for word in words[turn + 1 : -1])
    assert "no contact" in page.text("load-numbers")
    page.page.click("#to-pull-off")
    assert page.text("load-words") == "unloading, pull-off"
    assert page.page.get_attribute("#load", "aria-valuetext") == "unloading, pull-off"
    page.page.click("#to-critical")
    assert page.text("load-words") == "critical state"


@pytest.mark.server
def test_a_step_of_the_slider_is_shown_in_the_next_frame(explore):
    page = explore(adhesive(0.05, 0.05))
    late = page.page.evaluate(
        """async () => {
            const slider = document.getElementById("load");
            const words = (id) => document.getElementById(id);
            const late = [];
            for (let k = 0; k <= Number(slider.max); k += 3) {
                slider.value = k;
                slider.dispatchEvent(new Event("input", { bubbles: true }));
                const busy = document.body.dataset.busy;
                await new Promise(requestAnimationFrame);
                await new Promise(requestAnimationFrame);
                const shown = words("load-numbers").textContent.match(/(\\d+|nothing) in contact/)[1];
                const label = words("map").getAttribute("aria-label");
                const drawn = label.match(/: (\\d+) pillars in contact/)[1];
                if (busy !== "no" || Number(slider.value) !== k || drawn !== shown.replace("nothing", "0")) {
                    late.push(k);
                }
            }
            return late;
        }"""
    )
    assert late == []
    assert asked(page, "/api/cycle") == 1


def test_the_chart_has_both_branches_and_what_happens_on_them(explore, expected):
    page = explore(adhesive(0.03, 0.01))
    locate = page.page.locator
    assert locate("#loading path.path").count() == 2
    assert locate("#loading path.unloading").count() == 1
    for name in ("critical-point", "pull-off", "first-contact", "last-release", "load-point"):
        assert locate(f"#loading circle.{name}").count() == 1, name
    # Ticks are at the indentations of the events, one for all that are at the same place on the screen.
    for style, event in (("snap-in", "snap_in"), ("release", "release")):
        ticks = locate(f"#loading path.{style}").get_attribute("d").count("M")
        of_kind = {e["indentation_m"] for e in expected["events"] if e["event"] == event}
        assert 3 < ticks <= len(of_kind)
    # The tension is small compared with the load: it has a separate chart.
    assert page.page.is_visible("#pull")
    assert locate("#pull circle.pull-off").count() == 1
    assert "pull-off" in locate("#pull .pull-name").text_content()
    dot = "#loading circle.load-point"
    before = locate(dot).get_attribute("cx")
    page.slide("load", 3)
    assert float(locate(dot).get_attribute("cx")) < float(before)
    assert page.page.is_visible("#loading-legend .unloading")


@pytest.mark.smoke
def test_the_numbers_are_those_of_the_command_line(explore, expected):
    page = explore(adhesive(0.03, 0.01))
    numbers = {
        "pull-off-force": expected["pull_off_force_N"],
        "adhesive-critical": expected["critical_force_N"],
        "last-release": expected["last_release_indentation_m"],
        "separation-work": expected["work_of_separation_J"],
        "loop-area": expected["hysteresis_J"],
    }
    for name, value in numbers.items():
        # Rounded to the estimated errors: two digits for the pull-off.
        assert quantity(page.text(name)) == pytest.approx(value, rel=0.05), name
    error = expected["relative_error_estimate"]["pull_off_force"]
    assert error["model_fronts"] == 0.05
    model = error["model_fronts"] + error["model_columns"] + error["model_corners"]
    assert page.text("pull-off-error") == f"error 0.03, model error {model:.1g}"
    assert page.text("pull-off-pillars").startswith(f"{expected['pull_off_pillars_in_contact']} pillars")
    assert page.text("plain-critical").endswith("without adhesion")
    assert quantity(page.text("plain-critical")) > expected["critical_force_N"]
    note = page.page.locator("#cycle-numbers > .remark").text_content()
    assert "model error, about 5 %" in note and "is not adhesive" in re.sub(r"\s+", " ", note)
    assert page.page.locator("#cycle-numbers .strained").count() == 0
    assert page.text("limit-kendall_strain").endswith("< 0.3")
    # On a soft substrate the strain of pillars exceeds the range of the model.
    page.page.click("[data-preset=soft]")
    page.rest()
    assert page.page.input_value("#adhesion-work") == "10 mJ/m²"
    assert page.page.locator("#cycle-numbers .strained").count() == 1
    assert page.text("limit-kendall_strain").endswith("> 0.3")


def test_pulled_and_partial_pillars_are_on_the_map(explore):
    page = explore(adhesive(0.03, 0.003, "pattern.offset=0.3"))
    assert page.page.is_visible("#pull-key")
    assert page.text("pull-most").startswith("−")
    page.page.focus("#load")
    page.press("Home")
    loaded = page.page.evaluate(PICTURE)
    page.page.click("#to-pull-off")
    page.rest()
    assert page.page.evaluate(PICTURE) != loaded
    assert page.page.evaluate(RED) > 20
    all_pulled = re.search(r"(\d+) in contact, (\d+) partially, (\d+) in tension", page.text("load-numbers"))
    in_contact, in_part, pulled = map(int, all_pulled.groups())
    assert 0 < pulled <= in_contact and 0 < in_part
    label = page.page.get_attribute("#map", "aria-label")
    assert f"{in_part} of them partially, {pulled} in tension" in label
    # The note under the pointer shows the bonded fraction of a top.
    notes = page.page.evaluate(
        """() => {
            const map = document.getElementById("map");
            const { left, top, width, height } = map.getBoundingClientRect();
            const found = new Set();
            for (let x = 0.1; x < 0.9; x += 0.006) {
                for (let y = 0.1; y < 0.9; y += 0.006) {
                    const place = { clientX: left + x * width, clientY: top + y * height };
                    map.dispatchEvent(new PointerEvent("pointermove", place));
                    found.add(document.getElementById("map-note").textContent);
                }
            }
            return [...found];
        }"""
    )
    assert any(re.match(r"pillar −.*, \d.* % of its top bonded", note) for note in notes)


def test_the_section_follows(explore):
    page = explore(adhesive(0.03, 0.05))
    outlines = []
    for load in ("#to-critical", "#to-pull-off"):
        page.page.click(load)
        outlines.append(page.page.locator("#section path.lens").get_attribute("d"))
    assert outlines[0] != outlines[1]
    assert page.page.get_attribute("#section", "aria-busy") == "false"


@pytest.mark.server
def test_a_case_file_with_adhesion_is_where_the_page_begins(explore, tmp_path):
    case = tmp_path / "case.toml"
    subprocess.run([os.environ["FAKIR"], "init", str(case)], check=True, stdout=subprocess.DEVNULL)
    with exploring(str(case), "--set", "adhesion.work=80mJ/m2", "--set", "pattern.pitch=60um") as address:
        page = explore(address=address)
        assert page.page.input_value("#adhesion-work") == "80 mJ/m²"
        assert page.text("load-words") == "critical state"
        assert page.page.is_visible("#cycle-numbers")


def test_links_files_and_the_command_carry_adhesion(explore, tmp_path):
    page = explore(adhesive(0.02, 0.05, "adhesion.work_receding=0.08", "load=1.5"))
    assert page.text("load-words").startswith("unloading, ")
    assert page.page.input_value("#adhesion-work_receding") == "80 mJ/m²"
    page.page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    page.page.click("#copy-link")
    link = page.page.evaluate("() => navigator.clipboard.readText()")
    again = explore("#" + link.split("#")[1])
    assert again.text("load-numbers") == page.text("load-numbers")
    assert again.text("pull-off-force") == page.text("pull-off-force")
    page.page.click("#export-menu summary")
    for name, start in (("case.toml", b"# A lens"), ("releases.svg", b"<svg"), ("cycle.png", b"\x89PNG")):
        with page.page.expect_download() as download:
            page.page.click(f"[data-file='{name}']")
        path = tmp_path / name
        download.value.save_as(path)
        assert path.read_bytes().lstrip().startswith(start)
    adhesion = tomllib.loads((tmp_path / "case.toml").read_text())["adhesion"]
    assert adhesion == {"work": "50 mJ/m2", "work_receding": "80 mJ/m2"}
    command = page.text("command").replace("case.toml", "page.toml").replace("fakir ", os.environ["FAKIR"] + " ")
    done = subprocess.run(
        command + " --json", shell=True, cwd=tmp_path, check=True, capture_output=True, text=True
    )
    printed = json.loads("{" + done.stdout.split("{", 1)[1])
    assert quantity(page.text("pull-off-force")) == pytest.approx(printed["pull_off_force_N"], rel=0.05)


def test_works_that_cannot_be_are_refused_at_their_field(explore):
    page = explore(adhesive(0.01, 0.05))
    shown = page.text("pull-off-force")
    page.enter("adhesion.work", "-20 mJ/m2")
    assert page.text("adhesion-work-note").startswith("cannot be -20 mJ/m2: it must be 0, or")
    assert "last valid result" in page.text("problem")
    page.enter("adhesion.work", "50 mN/m")
    assert not page.page.is_visible("#problem")
    page.enter("adhesion.work_receding", "10 mJ/m2")
    assert "at least" in page.text("adhesion-work_receding-note")
    # An empty value is equal to the work of adhesion.
    page.enter("adhesion.work_receding", "")
    assert page.page.input_value("#adhesion-work_receding") == "50 mJ/m²"
    assert page.page.locator(".field.derived #adhesion-work_receding").count() == 1
    assert page.text("pull-off-force") == shown
    page.page.select_option("#method-name", "punch")
    page.rest()
    assert 'the method "punch": only the spectral method supports adhesion' in page.text("problem")


@pytest.mark.server
def test_without_adhesion_the_page_is_as_before(explore):
    """At a work of zero, from the start or on the way back from another one."""
    plain = explore("#" + "&".join(paper(0.02)))
    back = explore(adhesive(0.02, 0.05, "load=1.7"))
    back.page.focus("#adhesion-work-slider")
    back.page.keyboard.press("Home")
    back.rest()
    zero = explore(adhesive(0.02, 0))
    for page in (back, zero):
        assert page.page.input_value("#adhesion-work") == "0 mJ/m²"
        assert page.results() == plain.results()
        assert page.text("load-words") == "critical state"
        assert page.text("load-numbers") == plain.text("load-numbers")
        assert page.page.evaluate(PICTURE) == plain.page.evaluate(PICTURE)
        page.until("document.querySelector('#loading path.beyond-path') !== null")
        for name in ("#cycle-numbers", "#pull", "#pull-key", "#to-pull-off", "#adhesion-work_receding"):
            assert not page.page.is_visible(name), name
        assert page.page.locator("#loading path.unloading").count() == 0
        assert page.page.get_attribute("#load", "max") == plain.page.get_attribute("#load", "max")
        assert page.text("load-end") == "beyond"
    assert asked(zero, "/api/cycle") == 0


def test_a_newer_work_is_answered_at_once(explore):
    # Hundreds of pillars with weak adhesion take seconds.
    page = explore(adhesive(0.01, 0.05))
    page.page.evaluate(
        """() => {
            const field = document.getElementById("pattern-surface_fraction");
            field.value = "0.2";
            field.dispatchEvent(new Event("change"));
        }"""
    )
    page.until("/loading and unloading, step \\d+/.test(document.getElementById('status').textContent)")
    assert page.page.is_disabled("#load")
    # The curve is extended meanwhile.
    page.until("document.querySelector('#loading path.path') !== null")
    page.enter("pattern.surface_fraction", "0.01")
    assert page.text("pillars").startswith("13 pillars")
    assert not page.page.is_disabled("#load")


@pytest.mark.server
def test_what_is_of_a_cycle_before_is_grey(explore):
    page = explore(adhesive(0.02, 0.05, "load=1.5"))
    held = []
    page.page.route("**/api/cycle", lambda route: held.append(route))
    page.page.fill("#adhesion-work", "20 mJ/m2")
    page.page.press("#adhesion-work", "Enter")
    shown = ["map", "section", "load-numbers", "loading", "cycle-numbers", "critical", "phase"]
    older = "(id) => document.getElementById(id).classList.contains('older')"
    page.until("document.getElementById('map').classList.contains('older')")
    assert all(page.page.evaluate(older, name) for name in shown)
    before = page.text("load-numbers")
    held[0].continue_()
    page.rest()
    assert not any(page.page.evaluate(older, name) for name in shown)
    assert page.text("load-numbers") != before
    assert page.text("load-words").startswith("unloading, ")


@pytest.mark.parametrize("width, height", [(390, 844), (1400, 900)])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_a_cycle_fits_every_screen(explore, width, height, scheme):
    page = explore(adhesive(0.03, 0.01), width, height, color_scheme=scheme)
    page.page.click("#to-pull-off")
    assert page.page.evaluate("() => document.documentElement.scrollWidth - innerWidth") <= 0
    cut = page.page.evaluate(
        """() => [...document.querySelectorAll("#cycle-numbers dd, #bar span, .load-buttons button")]
            .filter((x) => x.scrollWidth > x.clientWidth + 1 && getComputedStyle(x).display !== "inline")
            .map((x) => x.id)"""
    )
    assert cut == []
    assert not page.overlap("#cycle-numbers dl > div, #cycle-numbers > .remark, #loading, #pull")
    page.picture(f"cycle-{width}-{scheme}")
