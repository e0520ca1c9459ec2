"""The page without a server: the module of WebAssembly, from a plain server of files and from a disk.

The folder of the page is in the environment variable PAGE; `cargo xtask page` builds it.
"""

import math
import os
import random
import statistics
import time
from pathlib import Path

import pytest
from conftest import Explorer, exploring, serving
from test_explorer import paper
from test_latency import MEASURE, MOVES

PAGE = os.environ.get("PAGE")
pytestmark = pytest.mark.skipif(not PAGE, reason="the page was not built: cargo xtask page")

# Sends a request to a new worker with the module, and returns the lines of its answer.
ASK = """async ([path, question]) => {
    const source = document.getElementById("worker-source").textContent;
    const worker = new Worker(URL.createObjectURL(new Blob([source], { type: "text/javascript" })));
    globalThis.compiled ??= WebAssembly.compile(await (await fetch("fakir.wasm")).arrayBuffer());
    worker.postMessage(await globalThis.compiled);
    await new Promise((resolve) => { worker.onmessage = resolve; });
    const lines = [];
    await new Promise((resolve, reject) => {
        worker.onmessage = ({ data }) => {
            if (data.line) lines.push(JSON.parse(data.line));
            if (data.end) resolve();
            if (data.failed) reject(new Error(data.failed));
        };
        const ticket = { session: "test", sequence: 1 };
        worker.postMessage(`${path}\\n${JSON.stringify({ ticket, ...question })}`);
    });
    worker.terminate();
    return lines;
}"""

# The same from the server of the page.
ASK_SERVER = """async ([path, question, sequence]) => {
    const ticket = { session: "test", sequence };
    const headers = { "content-type": "application/json", "x-fakir-token": location.pathname.split("/")[1] };
    const body = JSON.stringify({ ticket, ...question });
    const response = await fetch(`/api/${path}`, { method: "POST", headers, body });
    const text = await response.text();
    if (!response.ok) return [{ refused: JSON.parse(text) }];
    return text.trim().split("\\n").map((line) => JSON.parse(line));
}"""


@pytest.fixture(scope="module")
def static():
    with serving(PAGE) as address:
        yield address


@pytest.fixture(scope="module")
def server():
    with exploring() as address:
        yield address


def differences(one, other, where=""):
    """Where two answers differ by more than a relative 1e-9; differences of computing times do not count."""
    if isinstance(one, dict) and isinstance(other, dict):
        assert one.keys() == other.keys(), where
        ignored = {"wall_time_s"}
        points = [answer.get("floor_contact_m") for answer in (one, other)]
        if None not in points and math.dist(*points) > 1e-9:
            # From another of the symmetric copies of a point, the solution may take other steps to the same numbers.
            ignored.add("iterations")
        for key in one.keys() - ignored:
            yield from differences(one[key], other[key], f"{where}.{key}")
    elif where.endswith(("floor_contact_m", "bottom_contact_m")):
        # Rounding decides which of the symmetric copies of a point is found.
        yield from differences(math.hypot(*one), math.hypot(*other), f"{where} from the axis")
    elif isinstance(one, list) and isinstance(other, list) and len(one) == len(other):
        # Parts of a list are compared relative to the largest: heights in a section pass through zero.
        numbers = [x for x in one if isinstance(x, float)]
        scale = max(map(abs, numbers), default=0.0)
        for k, (a, b) in enumerate(zip(one, other)):
            if isinstance(a, float) and isinstance(b, float):
                if abs(a - b) > 1e-9 * scale:
                    yield f"{where}[{k}]: {a} {b}"
            else:
                yield from differences(a, b, f"{where}[{k}]")
    elif isinstance(one, (int, float)) and isinstance(other, (int, float)):
        # Estimated errors are differences of two solutions, with few digits.
        allowed = 1e-9 if "relative_error_estimate" not in where else 1e-2
        if abs(one - other) > allowed * max(abs(one), abs(other)) + 1e-18:
            yield f"{where}: {one} {other}"
    elif one != other:
        yield f"{where}: {one} {other}"


def test_twenty_random_cases_agree(explore_at, static, server):
    """Every number of critical states and contacts, from the module and from the native program."""
    module, native = explore_at(static), explore_at(server)
    draw = random.Random(49)
    cases = []
    for _ in range(20):
        values = {
            "lens.radius": 2.2e-3 * draw.uniform(0.5, 2),
            "lens.young_modulus": 10 ** draw.uniform(5, 7),
            "lens.poisson_ratio": draw.uniform(0.3, 0.5),
            "substrate.young_modulus": 10 ** draw.uniform(5, 8),
            "substrate.poisson_ratio": draw.uniform(0.3, 0.5),
            "pattern.surface_fraction": 10 ** draw.uniform(-2.7, -1.2),
            "pattern.pillar.diameter": 6e-6 * draw.uniform(0.7, 1.5),
            "pattern.pillar.height": 2.2e-6 * draw.uniform(0.5, 1.5),
            "pattern.lattice": draw.choice(["hexagonal", "square"]),
            "pattern.offset": draw.choice([0, 0.2]),
        }
        cases.append({"case": values, "load": {"fraction": draw.choice([0.4, 1, 1.3])}})
    for number, question in enumerate(cases):
        found = module.page.evaluate(ASK, ["contact", question])
        expected = native.page.evaluate(ASK_SERVER, ["contact", question, number + 1])
        final = [
            {name: part for line in lines for name, part in line.items() if name in ("critical", "summary", "section", "refused")}
            for lines in (found, expected)
        ]
        assert [f"{number}: {found}" for found in differences(*final)] == [], question
        assert final[0].keys() >= {"critical", "section"} or "refused" in final[0]


@pytest.fixture
def explore_at(browser):
    contexts = []

    def open_page(address, before=None, rests=True, **options):
        context = browser.new_context(viewport={"width": 1400, "height": 900}, accept_downloads=True, **options)
        contexts.append(context)
        page = context.new_page()
        asked = []
        page.on("request", lambda request: asked.append(request.url))
        if before:
            page.add_init_script(before)
        page.goto(address)
        explorer = Explorer(page, asked)
        if rests:
            explorer.rest()
        return explorer

    yield open_page
    for context in contexts:
        context.close()


def test_one_file_works_from_a_disk_without_a_network(explore_at):
    page = explore_at((Path(PAGE) / "fakir.html").absolute().as_uri())
    assert page.results() == ["4.44813", "199", "15.1643"]
    page.enter("pattern.surface_fraction", "0.02")
    assert page.results() != ["4.44813", "199", "15.1643"]
    assert "spectral, solved in" in page.text("status")
    with page.page.expect_download() as saved:
        page.page.click("summary")
        page.page.click("[data-file='profiles.svg']")
    assert Path(saved.value.path()).read_text().startswith("<svg")
    assert all(url.startswith(("file:", "data:", "blob:")) for url in page.requests), page.requests


@pytest.mark.latency
def test_the_first_picture_needs_no_module(explore_at, static, capsys):
    """Time from the begin of the document to its first picture, and to the first answer of the module."""
    begin = "document.addEventListener('picture', () => { globalThis.firstPicture ??= performance.now(); });"
    times = [explore_at(static, before=begin).page.evaluate("() => globalThis.firstPicture") for _ in range(5)]
    page = explore_at(f"{static}#{'&'.join(paper(0.03))}", before=begin)
    answer = page.page.evaluate("() => globalThis.firstPicture")
    with capsys.disabled():
        print(f"\nfirst picture {statistics.median(times):.0f} ms; first answer of the module {answer:.0f} ms")
    assert statistics.median(times) < 300
    assert answer < 2000


def test_the_first_picture_is_drawn_before_the_module_is_read(explore_at):
    """In the one file the module is 2.7 MB of text: it is decoded and compiled after the first picture."""
    watch = """globalThis.order = [];
        document.addEventListener("picture", () => globalThis.order.push("picture"), { once: true });
        for (const [of, name] of [[globalThis, "atob"], [WebAssembly, "compile"], [globalThis, "Worker"]]) {
            const own = of[name];
            of[name] = function (...given) {
                globalThis.order.push(name);
                return new.target ? new own(...given) : own.apply(of, given);
            };
        }"""
    page = explore_at((Path(PAGE) / "fakir.html").absolute().as_uri(), before=watch)
    page.until("globalThis.order.includes('Worker')")
    assert page.page.evaluate("() => globalThis.order.slice(0, 4)") == ["picture", "atob", "compile", "Worker"]
    is_after = "(a, b) => a.compareDocumentPosition(b) === Node.DOCUMENT_POSITION_FOLLOWING"
    script = "[...document.scripts].filter((part) => part.type === '').at(-1)"
    for name in ("module", "licences"):
        assert page.page.evaluate(f"() => ({is_after})({script}, document.getElementById('{name}'))")


@pytest.mark.latency
@pytest.mark.parametrize("fraction, load", [(0.01, 1), (0.03, 1), (0.1, 1), (0.01, 1.5), (0.03, 1.5), (0.1, 1.5)])
def test_the_module_follows_the_slider(explore_at, static, server, capsys, fraction, load):
    """Medians from the motion of the slider to the exact map."""
    medians = {}
    for engine, address in [("module", static), ("server", server)]:
        page = explore_at(f"{address}#{'&'.join([*paper(fraction), f'load={load}'])}")
        page.page.evaluate(MEASURE, [3])
        medians[engine] = statistics.median(page.page.evaluate(MEASURE, [MOVES])["exact"])
    ratio = medians["module"] / medians["server"]
    with capsys.disabled():
        print(f"\nslider to map at {fraction}, load {load}: {medians}, ratio {ratio:.2f}")
    assert ratio < 2.5


def test_a_link_opens_on_another_address(explore_at, static, server):
    link = "#" + "&".join([*paper(0.02), "load=0.7"])
    pages = [explore_at(address + link) for address in (static, server, (Path(PAGE) / "fakir.html").absolute().as_uri())]
    shown = [(page.results(), page.text("load-words"), page.text("load-numbers")) for page in pages]
    assert shown[0] == shown[1] == shown[2]


def test_a_computation_is_cancelled_by_ending_its_worker(explore_at, static):
    """Tops and floor at a surface fraction of 0.2 take many seconds; a newer question does not wait for them."""
    page = explore_at(f"{static}#{'&'.join([*paper(0.2), 'load=1.5'])}", rests=False)
    page.until("document.getElementById('force-value').textContent !== '–'")
    start = time.monotonic()
    page.enter("pattern.surface_fraction", "0.01")
    assert time.monotonic() - start < 10
    assert "spectral, solved in" in page.text("status")
    assert page.page.locator("#problem").is_hidden()


def test_a_floor_with_many_cells_is_refused_with_the_command(explore_at, static):
    page = explore_at(f"{static}#{'&'.join([*paper(0.1), 'adhesion.work=0.05', 'adhesion.floor=true'])}")
    words = page.text("adhesion-floor-note")
    assert "takes minutes in the browser" in words
    assert "fakir cycle case.toml" in words


@pytest.mark.parametrize(
    "without, words",
    [
        ("delete globalThis.WebAssembly;", "no WebAssembly"),
        ("WebAssembly.validate = () => false;", "no vector instructions"),
    ],
)
def test_a_browser_without_webassembly_is_told_what_to_use(explore_at, static, without, words):
    page = explore_at(static, before=without)
    assert page.results() == ["4.44813", "199", "15.1643"], "the first state needs no module"
    page.enter("pattern.surface_fraction", "0.02")
    assert words in page.text("problem")
    assert "fakir explore" in page.text("problem")


def test_a_worker_that_fails_is_started_again(explore_at, static):
    fails = """globalThis.Good = Worker;
        globalThis.Worker = class extends Worker {
            postMessage(it) {
                if (typeof it === "string") setTimeout(() => this.onerror({ message: "out of memory" }));
                else super.postMessage(it);
            }
        };"""
    page = explore_at(static, before=fails)
    page.enter("pattern.surface_fraction", "0.02")
    assert "out of memory" in page.text("problem") and "fakir explore" in page.text("problem")
    # The spare worker fails as well; those after it do not.
    page.page.evaluate("() => { globalThis.Worker = globalThis.Good; }")
    for fraction in ("0.03", "0.02", "0.03"):
        page.enter("pattern.surface_fraction", fraction)
    assert page.page.locator("#problem").is_hidden()


@pytest.mark.parametrize("engine", ["static", "server"])
def test_a_measured_curve_is_drawn_and_fitted(explore_at, static, server, engine, tmp_path):
    """The curve is that of the page for 2 MPa, 1 um further; the fit begins at 2.2 MPa."""
    page = explore_at({"static": static, "server": server}[engine] + "#" + "&".join(paper(0.01)))
    drawn = "document.querySelectorAll('#loading path.path').length > 0"
    page.until(f"{drawn} && document.getElementById('curves-status').textContent === ''")
    page.page.click("summary")
    with page.page.expect_download() as saved:
        page.page.click("[data-shown='loading.csv']")
    rows = [row.split(",") for row in Path(saved.value.path()).read_text().splitlines() if row.startswith("path,")]
    curve = tmp_path / "curve.csv"
    curve.write_text("displacement_m,force_N\n" + "".join(f"{float(x) + 1e-6},{y}\n" for _, x, y in rows))
    page.page.keyboard.press("Escape")
    page.page.set_input_files("#curve-file", str(curve))
    page.until("document.getElementById('data-words').textContent.includes('displacement')")
    assert page.page.locator("#loading circle.measured").count() == len(rows)
    page.enter("substrate.young_modulus", "2.2 MPa")
    page.page.click("#fit")
    page.until("document.getElementById('data-words').textContent.includes('fitted in')")
    page.rest()
    modulus, unit = page.page.input_value("#substrate-young_modulus").split()
    assert unit == "MPa" and float(modulus) == pytest.approx(2, rel=1e-3)
    number, unit = page.text("contact-point-words").split()
    assert unit == "µm" and float(number) == pytest.approx(1, rel=1e-2)
    picture = tmp_path / "picture.png"
    picture.write_bytes(b"\x89PNG\r\n")
    page.page.set_input_files("#curve-file", str(picture))
    page.until("document.getElementById('data-words').textContent.includes('picture.png')")
    assert page.page.locator("#data").is_hidden()


@pytest.mark.parametrize("engine", ["static", "server"])
def test_changes_are_undone_and_redone(explore_at, static, server, engine):
    page = explore_at({"static": static, "server": server}[engine])
    fraction = "document.getElementById('pattern-surface_fraction').value"
    for value in ("0.02", "0.03"):
        page.enter("pattern.surface_fraction", value)
        page.until(f"location.hash.includes('surface_fraction={value}&')")
    page.page.click("#undo")
    page.until(f"{fraction} === '0.02'")
    page.page.go_back()
    page.until(f"{fraction} === '0.1'")
    assert page.page.is_disabled("#undo")
    page.page.click("#redo")
    page.until(f"{fraction} === '0.02'")
    page.page.click("#reset")
    page.until(f"{fraction} === '0.1'")
    page.until("!document.getElementById('undo').disabled && document.getElementById('redo').disabled")


def test_licences_are_beside_the_module():
    text = (Path(PAGE) / "licences.txt").read_text()
    for library in ("rustfft", "rayon", "serde", "Roboto"):
        assert library in text
