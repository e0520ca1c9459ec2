"""Actions of a user on the page, in a real browser."""

import json
import os
import re
import subprocess
import tomllib

import pytest
from conftest import exploring


@pytest.mark.smoke
def test_starts_with_the_case_of_fakir_init(explore):
    # The numbers are those of the README: spectral method, checked against boundary elements.
    page = explore()
    assert page.results() == ["4.44813", "199", "15.1643"]
    assert page.text("force-unit") == "mN"
    assert page.text("regime").startswith("top first")
    assert page.text("pillars") == "451 pillars in contact, 30 partially"
    assert "error" in page.text("force-remark")
    label = page.page.locator("#map").get_attribute("aria-label")
    assert label.startswith("Contact from above: 451 pillars in contact")


@pytest.mark.server
def test_starts_with_the_case_of_a_file(explore, tmp_path):
    case = tmp_path / "case.toml"
    subprocess.run([os.environ["FAKIR"], "init", str(case)], check=True, stdout=subprocess.DEVNULL)
    with exploring(str(case), "--set", "pattern.pitch=40um") as address:
        page = explore(address=address)
        assert page.page.input_value("#pattern-pitch") == "40 µm"
        assert page.page.locator(".field.derived #pattern-surface_fraction").count() == 1


@pytest.mark.smoke
def test_presets_are_the_substrates_of_the_paper(explore):
    page = explore("#" + "&".join(paper(0.001)))
    forces = {}
    for name in ("rigid", "intermediate", "soft"):
        page.page.click(f"[data-preset={name}]")
        page.rest()
        assert page.page.get_attribute(f"[data-preset={name}]", "aria-pressed") == "true"
        forces[name] = (float(page.results()[0]), page.text("force-unit"))
    # One pillar: rigid about 1e-5 N, soft about 1e-8 N, intermediate below half of rigid.
    assert forces["rigid"][1] == "µN" and 10 < forces["rigid"][0] < 100
    assert forces["soft"][1] == "nN" and 10 < forces["soft"][0] < 100
    assert forces["intermediate"][1] == "µN"
    assert forces["intermediate"][0] < 0.5 * forces["rigid"][0]
    assert page.page.input_value("#pattern-surface_fraction") == "0.001"


def test_a_square_lattice_with_scatter(explore, tmp_path):
    """Another lattice keeps the common parameters; vacancies and heights are drawn from the seed, as in the program."""
    page = explore("#" + "&".join(paper(0.02)))
    hexagonal = page.results()
    page.page.select_option("#pattern-lattice", "square")
    page.rest()
    assert page.page.input_value("#pattern-surface_fraction") == "0.02"
    square = page.results()
    assert square != hexagonal
    page.enter("pattern.vacancy_fraction", "0.1")
    page.enter("pattern.height_standard_deviation", "0.03")
    page.enter("pattern.seed", "5")
    found = page.results()
    assert found != square
    case = tmp_path / "case.toml"
    case.write_text(page.text("case-file"))
    answer = subprocess.run(
        [os.environ["FAKIR"], "transition", str(case), "--json"], check=True, capture_output=True
    )
    force = json.loads(answer.stdout)["critical_force_N"]
    scale = {"mN": 1e3, "µN": 1e6}[page.text("force-unit")]
    assert float(found[0]) == pytest.approx(scale * force, rel=1e-3)
    assert "fakir.SquarePattern(" in page.text("python")
    page.page.select_option("#pattern-lattice", "hexagonal")
    for key in ("vacancy_fraction", "height_standard_deviation", "seed"):
        page.enter(f"pattern.{key}", "0")
    assert page.results() == hexagonal


def test_rectangular_and_oblique_lattices(explore, tmp_path):
    """A lattice with two pitches starts from the parameters of the previous lattice; the numbers are those of the program."""
    page = explore("#" + "&".join(paper(0.02)))
    hexagonal = page.results()
    page.page.select_option("#pattern-lattice", "oblique")
    page.rest()
    # Rows of one pitch at 60 degrees are the hexagonal lattice. Six digits of the pitch are kept, four of the force.
    assert page.page.input_value("#pattern-lattice_angle") == "60 deg"
    assert [float(value) for value in page.results()[:2]] == pytest.approx(
        [float(value) for value in hexagonal[:2]], rel=1e-3
    )
    assert not page.page.locator("#pattern-surface_fraction").is_visible()
    page.page.select_option("#pattern-lattice", "rectangular")
    page.rest()
    assert not page.page.locator("#pattern-lattice_angle").is_visible()
    page.enter("pattern.pitch", "30 um")
    page.enter("pattern.pitch_y", "45 um")
    found = page.results()
    case = tmp_path / "case.toml"
    case.write_text(page.text("case-file"))
    assert tomllib.loads(case.read_text())["pattern"]["pitch_y"] == "45 um"
    answer = subprocess.run(
        [os.environ["FAKIR"], "transition", str(case), "--json"], check=True, capture_output=True
    )
    force = json.loads(answer.stdout)["critical_force_N"]
    scale = {"mN": 1e3, "µN": 1e6}[page.text("force-unit")]
    assert float(found[0]) == pytest.approx(scale * force, rel=1e-3)
    assert "fakir.RectangularPattern(" in page.text("python")
    # An error is shown at its key, with the message of the program.
    page.enter("pattern.pitch_y", "1 um")
    assert "at least the pillar diameter" in page.text("pattern-pitch_y-note")
    page.page.select_option("#pattern-lattice", "square")
    page.rest()
    assert page.page.input_value("#pattern-pitch") == "30 µm"
    assert not page.page.locator("#pattern-pitch_y").is_visible()


@pytest.mark.smoke
def test_sliders_change_the_result(explore):
    page = explore("#" + "&".join(paper(0.02)))
    before = page.results()
    page.slide("pattern-pillar-height-slider", 700)
    assert page.results() != before
    assert page.page.input_value("#pattern-pillar-height") != "2.2 µm"
    page.enter("pattern.pillar.height", "2200 nm")
    assert page.results() == before
    # A pitch replaces the surface fraction.
    page.enter("pattern.pitch", "40.4 um")
    assert 'pitch = "40.4 um"' in page.text("case-file")
    assert "surface_fraction" not in page.text("case-file").split("[pattern]")[1].split("#")[0]


def test_a_substrate_becomes_a_film_and_again_infinite(explore):
    page = explore("#" + "&".join(paper(0.03)))
    before = page.results()
    assert page.page.input_value("#substrate-thickness") == "infinite"
    page.enter("substrate.thickness", "0.2 mm")
    assert page.results() != before
    assert 'thickness = "200 um"' in page.text("case-file")
    page.slide("lens-thickness-slider", 600)
    assert page.page.input_value("#lens-thickness") != "infinite"
    page.slide("lens-thickness-slider", 1000)
    assert page.page.input_value("#lens-thickness") == "infinite"
    page.enter("substrate.thickness", "infinite")
    assert page.results() == before
    assert "thickness" not in page.text("case-file")


def test_exceeded_limits_of_a_film_are_marked(explore):
    film = ["substrate.thickness=4e-5"]
    page = explore("#" + "&".join([*paper(0.03), *film]))
    page.rest()
    assert page.text("limits").startswith("limit exceeded: indentation over the smallest thickness")
    assert "strained" in page.page.locator("#limits").get_attribute("class")
    # Rounded values cannot be equal to the limit that they exceed.
    assert " > 0.05" in page.text("limits")


@pytest.mark.server
@pytest.mark.smoke
def test_the_controls_are_those_of_the_key_table(explore):
    """Labels, symbols, help, units, ranges and words are those of the program."""
    page = explore("#" + "&".join(paper(0.01)))
    start = page.page.evaluate("async () => (await fetch('start.json')).json()")
    units = ["length", "pressure", "energy per area", "angle", "time", "number", "fraction"]
    for key in start["keys"]:
        name = key["key"].replace(".", "-")
        control = page.page.locator(f"#{name}")
        # A key with only one word has no selection.
        assert control.count() == (len(key["words"]) != 1), name
        if control.count() == 0:
            continue
        label = page.page.locator(f"label[for='{name}']")
        symbol = (key["symbol"] or "").replace("_", "")
        assert label.text_content() == f"{key['label']} {symbol}".strip().replace("'", "’")
        assert label.get_attribute("title") == key["meaning"]
        assert page.text(f"{name}-help") == key["meaning"]
        assert f"{name}-help" in control.get_attribute("aria-describedby")
        if key["words"] == ["true", "false"]:
            assert control.get_attribute("type") == "checkbox"
            assert control.is_checked() == (key["default"] == "true")
            continue
        if key["words"]:
            assert control.locator("option").all_text_contents() == key["words"]
            continue
        if key["text"]:
            assert control.get_attribute("type") == "text"
        else:
            assert key["dimension"] in units
        # Only keys of the selected method and lattice are shown; the receding work only with adhesion.
        recedes = key["key"] == "adhesion.work_receding"
        condition = key["goes_with"]
        defaults = {each["key"]: each["default"] for each in start["keys"]}
        belongs = condition is None or {**defaults, **start["case"]}[condition["key"]] in condition["words"]
        assert control.is_visible() == (belongs and not recedes), name
    for place, end in [(0, 0), (1000, 1)]:
        page.slide("lens-radius-slider", place)
        number, unit = page.page.input_value("#lens-radius").split()
        usual = next(key["usual"] for key in start["keys"] if key["key"] == "lens.radius")
        value = float(number) * {"m": 1, "mm": 1e-3, "µm": 1e-6}[unit]
        assert abs(value / usual[end] - 1) < 1e-9
    # A single pillar, which boundary elements solve quickly.
    page = explore("#" + "&".join(paper(0.001)))
    page.page.select_option("#method-name", "love")
    page.rest()
    assert page.page.input_value("#method-cells_per_diameter") == "16"
    page.slide("method-cells_per_diameter-slider", 0)
    assert "cells_per_diameter = 8 " in page.text("case-file")


@pytest.mark.smoke
def test_the_load_ranges_from_first_touch_past_the_critical_state(explore):
    page = explore("#" + "&".join(paper(0.03)))
    critical = page.results()
    forces = []
    for load in (0.2, 0.6, 1, 1.2):
        page.slide("load", load)
        numbers = page.text("load-numbers")
        number, unit = re.search(r"F = ([\d.]+) (\w+)", numbers).groups()
        forces.append(float(number) * {"µN": 1e-6, "mN": 1e-3}[unit])
        assert page.results() == critical
        # The load of the floor is shown past the critical state.
        assert page.page.is_visible("#floor-numbers") == (load > 1)
        assert not page.page.is_visible("#beyond-note")
    assert forces == sorted(forces)
    assert "beyond the transition" in page.text("load-words")
    assert "fakir press case.toml --indentation" in page.text("command")
    page.page.click("#to-critical")
    page.rest()
    assert page.text("load-words") == "critical state"


def test_curves_and_path_fill_in(explore):
    page = explore("#" + "&".join(paper(0.01)))
    page.until("document.querySelectorAll('#curve-force .exact-point').length > 20")
    page.until("document.querySelector('#phase path.beyond-path') !== null")
    assert page.page.locator("#curve-indentation path.homogenised-curve").count() == 1


def test_slow_cases_report_progress_and_do_not_block(explore):
    page = explore("#" + "&".join(paper(0.03)))
    page.page.evaluate(
        """() => {
            window.messages = [];
            window.longest = 0;
            let last = performance.now();
            const frame = (now) => {
                window.longest = Math.max(window.longest, now - last);
                last = now;
                requestAnimationFrame(frame);
            };
            requestAnimationFrame(frame);
            const status = document.getElementById("status");
            new MutationObserver(() => window.messages.push(status.textContent))
                .observe(status, { childList: true, characterData: true, subtree: true });
            const method = document.getElementById("method-accuracy");
            method.value = "accurate";
            method.dispatchEvent(new Event("change"));
            const slider = document.getElementById("pattern-surface_fraction-slider");
            slider.value = 915;
            slider.dispatchEvent(new Event("input"));
        }"""
    )
    page.until("window.messages.some((words) => /step \\d+, \\d+ pillars touched/.test(words))")
    # A newer request is answered at once, even during another computation.
    page.enter("pattern.surface_fraction", "0.01")
    assert page.text("pillars").startswith("13 pillars")
    # Frames are drawn meanwhile; their rate depends on the machine.
    assert page.page.evaluate("() => window.longest") < 2000


@pytest.mark.smoke
def test_an_error_is_at_its_field_and_the_picture_stays(explore):
    page = explore("#" + "&".join(paper(0.02)))
    before = page.results()
    page.enter("pattern.pillar.height", "5 mm")
    assert page.text("pattern-pillar-height-note").startswith("cannot be 5 mm: it must be")
    assert page.page.get_attribute("#pattern-pillar-height", "aria-invalid") == "true"
    assert "last valid result" in page.text("problem")
    assert page.results() == before
    page.enter("pattern.pillar.height", "2.2 furlongs")
    assert "not a known unit" in page.text("pattern-pillar-height-note")
    page.enter("pattern.surface_fraction", "0.8")
    page.enter("pattern.pillar.height", "2.2 um")
    assert "pillars would be touched" in page.text("pattern-surface_fraction-note")
    page.enter("pattern.surface_fraction", "0.02")
    assert not page.page.is_visible("#problem")
    assert page.results() == before


def test_a_bare_number_has_the_unit_that_is_shown(explore):
    page = explore("#" + "&".join(paper(0.02)))
    for key, bare, shown in [
        ("pattern.pillar.height", "2.5", "2.5 µm"),
        ("lens.radius", "3", "3 mm"),
        ("substrate.young_modulus", "3", "3 MPa"),
        ("pattern.offset_angle", "30", "30 deg"),
        # In the unit that was typed last.
        ("pattern.pillar.height", "2400 nm", "2400 nm"),
        ("pattern.pillar.height", "2300", "2300 nm"),
        ("pattern.surface_fraction", "0.03", "0.03"),
    ]:
        field = f"#{key.replace('.', '-')}"
        page.enter(key, bare)
        assert page.page.input_value(field) == shown
    assert not page.page.is_visible("#problem")
    case = tomllib.loads(page.text("case-file"))
    assert case["pattern"]["pillar"]["height"] == "2.3 um" and case["lens"]["radius"] == "3 mm"
    assert case["pattern"]["offset_angle"] == "30 deg" and case["substrate"]["young_modulus"] == "3 MPa"


def test_messages_have_the_units_of_the_controls(explore):
    page = explore("#" + "&".join(paper(0.02)))
    page.enter("pattern.pitch", "5 um")
    assert "at least the pillar diameter, 6 µm" in page.text("pattern-pitch-note")


def test_an_error_is_at_the_field_that_was_changed(explore):
    """Thinner pillars at one surface fraction are more pillars, for which the server names the surface fraction."""
    page = explore("#" + "&".join(paper(0.12)))
    page.slide("pattern-pillar-diameter-slider", 100)
    note = page.text("pattern-pillar-diameter-note")
    assert note.startswith("surface fraction: about ") and "pillars would be touched" in note
    assert page.page.get_attribute("#pattern-pillar-diameter", "aria-invalid") == "true"
    assert page.page.get_attribute("#pattern-surface_fraction", "aria-invalid") is None
    page.enter("pattern.pillar.diameter", "6 um")
    assert not page.page.is_visible("#problem")


def test_legends_contain_what_is_drawn(explore):
    """Closed forms, and the transition curve, exist only for the hexagonal lattice."""
    curves = ["exact", "homogenised", "large", "small"]
    names = [f"#curves-legend .{name}-curve" for name in curves] + ["#phase-legend .transition", "#phase-legend .path"]
    page = explore("#" + "&".join(paper(0.01)))
    page.until("document.querySelector('#curve-force path.exact-curve') !== null")
    assert [page.page.is_visible(name) for name in names] == [True] * 6
    page.page.select_option("#pattern-lattice", "oblique")
    page.until("document.querySelector('#curves-legend .small-curve').hidden")
    page.until("document.querySelector('#phase-legend .transition').hidden")
    page.until("document.querySelector('#curve-force path.exact-curve') !== null")
    assert [page.page.is_visible(name) for name in names] == [True, False, False, False, False, True]
    assert page.page.locator("#phase .region").count() == 0


@pytest.mark.parametrize("width, height", [(1400, 900), (700, 450), (360, 800)])
def test_the_focus_is_never_hidden(explore, width, height):
    """At 200 % a window of 1400 by 900 pixels has 700 by 450."""
    page = explore("#" + "&".join(paper(0.01)), width, height)
    hidden = []
    for key in ["Tab"] * 75 + ["Shift+Tab"] * 75:
        page.page.keyboard.press(key)
        found = page.page.evaluate(
            """() => {
                const focused = document.activeElement;
                if (focused === document.body) return null;
                const { left, right, top, bottom } = focused.getBoundingClientRect();
                const x = (left + right) / 2;
                const y = (Math.max(0, top) + Math.min(innerHeight, bottom)) / 2;
                const above = document.elementFromPoint(x, y);
                return focused.contains(above) ? null : `${focused.id} ${focused.textContent.slice(0, 20)}`;
            }"""
        )
        if found is not None:
            hidden.append(found)
    assert hidden == []


def test_forced_colours_leave_marks_and_states_visible(explore):
    page = explore("#" + "&".join(paper(0.01)), forced_colors="active")
    colour = """([selector, pseudo, property]) =>
        getComputedStyle(document.querySelector(selector), pseudo || null)[property]"""

    def of(selector, pseudo, name):
        return page.page.evaluate(colour, [selector, pseudo, name])

    page.until("document.querySelector('#phase .lettering text') !== null")
    behind = of("body", "", "backgroundColor")
    lines = [f"#curves-legend .{name}-curve" for name in ("exact", "homogenised", "large")]
    assert len({of(line, "::before", "borderTopColor") for line in lines}) == 3
    assert of(".sign.floor", "::before", "backgroundColor") != behind
    pressed, other = (f"[data-preset={name}]" for name in ("intermediate", "soft"))
    assert of(pressed, "", "backgroundColor") != of(other, "", "backgroundColor")
    assert of("#phase .lettering text", "", "fill") != behind
    assert of("#load", "", "forcedColorAdjust") == "none"
    page.picture("forced-colours")


@pytest.mark.parametrize("load", [1, 0.5])
def test_one_name_for_one_radius(explore, load):
    # One pillar of 3 µm is pressed, and the floor is reached beside it.
    page = explore("#" + "&".join(paper(0.001)))
    page.slide("load", load)
    above = f"{page.text('radius-value')} {page.text('radius-unit')}"
    assert "on the tops 3.0" in page.text("radius-remark")
    below = re.search(r"a = ([\d.]+ µm)(?:,  on the tops ([\d.]+ µm))?", page.text("load-numbers"))
    if load == 1:
        assert float(below.group(1).split()[0]) == pytest.approx(float(above.split()[0]), rel=1e-2)
        assert below.group(2).startswith("3.0")
    else:
        assert float(below.group(1).split()[0]) < 3.01 and below.group(2) is None


def test_the_section_is_cut_by_its_frame(explore):
    # With ten times the exaggeration every height is ten times as far from the middle, also outside of the picture.
    page = explore("#" + "&".join(paper(0.02)))
    heights = []
    for power in (1, 2):
        page.slide("exaggeration", power)
        outline = page.page.locator("#section path.outline").nth(1).get_attribute("d")
        heights.append([float(place.split()[1]) for place in outline.removeprefix("M").split("L")])
    size = page.page.locator("#section").bounding_box()["height"]
    middle = 0.56 * size
    assert min(heights[1]) < -2 * size
    for once, tenfold in zip(*heights, strict=True):
        assert tenfold - middle == pytest.approx(10 * (once - middle), abs=1)


def test_the_exaggeration_is_fitted_again(explore):
    page = explore("#" + "&".join(paper(0.02)))
    fit = page.page.locator("#exaggeration-fit")
    fitted = page.text("exaggeration-words")
    assert fit.get_attribute("aria-pressed") == "true"
    page.slide("exaggeration", 2.5)
    assert fit.get_attribute("aria-pressed") == "false"
    assert page.text("exaggeration-words") != fitted
    page.page.click("#exaggeration-fit")
    page.rest()
    assert fit.get_attribute("aria-pressed") == "true"
    assert page.text("exaggeration-words") == fitted


def test_an_address_that_is_entered_is_not_written_over(explore):
    """The event of an entered address is delivered late: after the time at which the page writes its own address."""

    def deliver_the_address_late(page):
        page.add_init_script(
            """addEventListener("hashchange", (event) => {
                if (!event.isTrusted) return;
                event.stopImmediatePropagation();
                setTimeout(() => dispatchEvent(new HashChangeEvent("hashchange")), 1000);
            });"""
        )

    page = explore("#" + "&".join(paper(0.03)), before=deliver_the_address_late)
    page.change("pattern.surface_fraction", "0.04")
    entered = "#" + "&".join(paper(0.05))
    page.page.evaluate("(entered) => { location.hash = entered; }", entered)
    page.until("document.getElementById('pattern-surface_fraction').value === '0.05'")
    page.rest()
    assert "surface_fraction=0.05" in page.page.url


def test_a_link_restores_the_state(explore, browser):
    page = explore()
    page.page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    page.enter("pattern.surface_fraction", "0.013")
    page.enter("lens.radius", "3.3 mm")
    page.slide("load", 0.5)
    page.slide("exaggeration", 1.5)
    page.page.click("#copy-link")
    link = page.page.evaluate("() => navigator.clipboard.readText()")
    again = explore("#" + link.split("#")[1])
    assert again.results() == page.results()
    assert again.text("load-numbers") == page.text("load-numbers")
    assert again.page.input_value("#lens-radius") == "3.3 mm"
    assert again.text("exaggeration-words") == page.text("exaggeration-words")


@pytest.mark.smoke
@pytest.mark.parametrize(
    "name, start",
    [
        ("case.toml", b"# A lens pressed"),
        ("summary.json", b"{"),
        ("pillars.csv", b"i,j,x_m,y_m,status,force_N"),
        ("pressure-map.svg", b"<svg"),
        ("profiles.png", b"\x89PNG"),
        ("top-view.svg", b"<svg"),
        ("phase-diagram.png", b"\x89PNG"),
    ],
)
def test_exports_are_saved(explore, tmp_path, name, start):
    page = explore("#" + "&".join(paper(0.01)))
    page.page.click("#export-menu summary")
    with page.page.expect_download() as download:
        page.page.click(f"[data-file='{name}']")
    assert download.value.suggested_filename == f"fakir-{name}"
    path = tmp_path / name
    download.value.save_as(path)
    contents = path.read_bytes()
    assert contents.lstrip().startswith(start)
    if name == "case.toml":
        case = tomllib.loads(contents.decode())
        assert case["pattern"]["surface_fraction"] == 0.01
    if name == "summary.json":
        force = json.loads(contents)["critical_force_N"]
        assert f"{1e6 * force:.4f}".startswith(page.results()[0][:5])


@pytest.mark.smoke
def test_the_command_gives_the_same_result(explore, tmp_path):
    page = explore("#" + "&".join(paper(0.01)))
    page.enter("pattern.pillar.diameter", "7 um")
    command = page.text("command").replace("fakir ", os.environ["FAKIR"] + " ")
    done = subprocess.run(
        command + " --json", shell=True, cwd=tmp_path, check=True, capture_output=True, text=True
    )
    force = json.loads("{" + done.stdout.split("{", 1)[1])["critical_force_N"]
    number = float(page.results()[0]) * {"µN": 1e-6, "mN": 1e-3}[page.text("force-unit")]
    assert abs(force / number - 1) < 1e-5


def test_the_command_needs_no_option_for_an_existing_case(explore, tmp_path):
    page = explore("#" + "&".join(paper(0.01)))
    other = tmp_path / "case.toml"
    subprocess.run([os.environ["FAKIR"], "init", str(other)], check=True, stdout=subprocess.DEVNULL)
    other.write_text(other.read_text(encoding="utf-8").replace('"2.2 mm"', '"9 mm"'), encoding="utf-8")
    command = page.text("command").replace("fakir ", os.environ["FAKIR"] + " ")
    done = subprocess.run(command, shell=True, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 2 and done.stdout == ""
    assert "choose another name" in done.stderr


def test_everything_is_reached_by_keyboard(explore):
    page = explore("#" + "&".join(paper(0.01)))
    seen = []
    for _ in range(80):
        page.page.keyboard.press("Tab")
        seen.append(page.page.evaluate("() => document.activeElement.id"))
    for name in ("lens-radius", "lens-radius-slider", "load", "exaggeration", "copy-link", "method-name"):
        assert name in seen, name
    outline = page.page.evaluate("() => getComputedStyle(document.activeElement).outlineStyle")
    assert outline != "none"
    page.page.focus("#load")
    before = page.text("load-numbers")
    for _ in range(20):
        page.page.keyboard.press("ArrowLeft")
    page.rest()
    assert page.text("load-numbers") != before
    unlabelled = page.page.evaluate(
        """() => [...document.querySelectorAll("input, select, button")]
            .filter((x) => !x.labels?.length && !x.ariaLabel && !x.textContent.trim())
            .map((x) => x.id)"""
    )
    assert unlabelled == []


@pytest.mark.smoke
def test_results_are_announced(explore):
    page = explore("#" + "&".join(paper(0.01)))
    page.until("document.getElementById('announcement').textContent.includes('Critical force')")


@pytest.mark.parametrize("width, height", [(1400, 900), (1000, 850)])
def test_nothing_covers_the_command(explore, width, height):
    page = explore("#" + "&".join(paper(0.02)), width, height)
    covered = page.page.evaluate(
        """() => {
            scrollTo(0, document.documentElement.scrollHeight);
            const box = document.getElementById("command").closest("figure");
            const { left, top, width, height } = box.getBoundingClientRect();
            const parts = [0.02, 0.25, 0.5, 0.75, 0.98];
            return parts.flatMap((x) => parts.map((y) => {
                const found = document.elementFromPoint(left + x * width, top + y * height);
                return box.contains(found) ? null : found?.outerHTML.slice(0, 80);
            })).filter((found) => found !== null);
        }"""
    )
    assert not covered


@pytest.mark.parametrize("width, height", [(360, 800), (820, 1180), (1280, 800), (3840, 2160)])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_fits_every_screen(explore, width, height, scheme, tmp_path):
    page = explore("#" + "&".join(paper(0.02)), width, height, color_scheme=scheme)
    over = page.page.evaluate("() => document.documentElement.scrollWidth - innerWidth")
    assert over <= 0
    dark = page.page.evaluate(
        "() => getComputedStyle(document.documentElement).backgroundColor.match(/\\d+/g)[0] < 128"
    )
    assert dark == (scheme == "dark")
    assert not page.overlap("main section, header, footer")
    page.picture(f"{width}-{scheme}")


def test_motion_is_reduced_on_wish(explore):
    page = explore(reduced_motion="reduce")
    moving = page.page.evaluate(
        """() => [...document.querySelectorAll("*")]
            .some((x) => parseFloat(getComputedStyle(x).transitionDuration) > 0)"""
    )
    assert not moving


@pytest.mark.server
def test_nothing_else_gets_in(explore, browser, address):
    context = browser.new_context()
    page = context.new_page()
    root = address.rsplit("/", 2)[0]
    assert page.goto(root + "/").status == 403
    assert page.goto(root + "/" + "0" * 32 + "/").status == 403
    context.close()


# The number of lines in charts below the first screen, and the size of the map as a file, at the first picture.
AT_FIRST_PICTURE = """document.addEventListener("picture", () => {
    globalThis.first = {
        late: ["phase", "loading", "curve-force"].map((id) => document.querySelectorAll(`#${id} path`).length),
        map: document.getElementById("map").toDataURL().length,
    };
}, { once: true });"""


def test_the_first_picture_waits_for_nothing_below_it(explore):
    """The map is drawn in a frame without the charts below, which follow."""
    page = explore(before=lambda page: page.add_init_script(AT_FIRST_PICTURE))
    first = page.page.evaluate("() => globalThis.first")
    assert first["late"] == [0, 0, 0], first
    # An empty map is a picture of some hundred bytes.
    assert first["map"] > 5000, first
    page.until("['phase', 'loading', 'curve-force'].every((id) => document.querySelectorAll(`#${id} path`).length > 0)")


@pytest.mark.server
def test_scripts_and_data_are_requested_at_once(explore):
    """The document names every script that is loaded, and the initial data, so that none waits for another script."""
    page = explore()
    named = page.page.eval_on_selector_all(
        "link[rel=modulepreload], link[rel=preload]", "(links) => links.map((link) => link.getAttribute('href'))"
    )
    entries = page.page.evaluate(
        "() => performance.getEntriesByType('resource').map(({ name, initiatorType }) => [name.split('/').pop(), initiatorType])"
    )
    loaded = [name for name, _ in entries if name.endswith(".js") or name == "start.json"]
    assert len(loaded) > 20
    assert set(loaded) <= set(named), set(loaded) - set(named)
    # Each is loaded once.
    assert sorted(loaded) == sorted(set(loaded))
    # A script that another one asks for has the kind `script`.
    assert all(kind != "script" for name, kind in entries if name.endswith(".js") and name != "main.js"), entries


def paper(surface_fraction):
    """The paper's intermediate substrate, as the parts of a link."""
    return [
        "lens.radius=0.0022",
        "lens.young_modulus=2000000",
        "lens.poisson_ratio=0.5",
        "substrate.young_modulus=2000000",
        "substrate.poisson_ratio=0.5",
        "pattern.offset=0",
        "pattern.offset_angle=0",
        "pattern.pillar.diameter=0.000006",
        "pattern.pillar.height=0.0000022",
        "pattern.pillar.compliance=column",
        "method.name=spectral",
        "method.accuracy=default",
        f"pattern.surface_fraction={surface_fraction}",
    ]
