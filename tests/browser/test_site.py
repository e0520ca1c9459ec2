"""The static site, served on this machine: a visitor clicks through it; every link leads somewhere; nothing is loaded from elsewhere."""

import json
import os
import re
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urljoin, urlsplit

import pytest

ROOT = Path(__file__).parents[2]
SCRIPT = ROOT / "book" / "website.py"
SITE = os.environ.get("SITE")
needs_site = pytest.mark.skipif(not SITE, reason="the site was not built: cargo xtask site")


@pytest.fixture(scope="module")
def served():
    command = [sys.executable, str(SCRIPT), "serve", SITE, "--port", "0"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    try:
        yield process.stdout.readline().strip()
    finally:
        process.terminate()
        process.wait(timeout=10)
        process.stdout.close()


@pytest.fixture(params=[1400, 390])
def visit(request, browser, served):
    """Opens a page of the site at a width of the screen; errors and requests to other machines fail the test."""
    context = browser.new_context(viewport={"width": request.param, "height": 900})
    tab = context.new_page()
    problems = []
    tab.on("pageerror", lambda error: problems.append(str(error)))
    tab.on("request", lambda asked: asked.url.startswith((served, "data:", "blob:")) or problems.append(asked.url))
    tab.on("response", lambda answer: answer.status >= 400 and problems.append(f"{answer.url}: {answer.status}"))
    tab.goto(served)
    yield tab, request.param
    context.close()
    assert not problems


def picture(tab, name, width):
    """Saves a picture, if the environment variable SCREENSHOTS names a folder."""
    folder = os.environ.get("SCREENSHOTS")
    if folder:
        tab.screenshot(path=f"{folder}/{name}-{width}.png")


@needs_site
def test_a_visitor_finds_every_part(visit):
    tab, width = visit
    assert tab.title() == "fakir"
    picture(tab, "site", width)
    assert tab.evaluate("document.documentElement.scrollWidth") <= width
    for name, heading in [
        ("Manual", "What fakir computes"),
        ("Start in ten minutes", "Start in ten minutes"),
        ("Gallery", "Gallery of figures"),
        ("Which program?", "Which program for which question?"),
        ("Python package", "Python and Rust"),
    ]:
        tab.locator("ul.parts").get_by_role("link", name=name, exact=True).click()
        assert heading in tab.locator("main h1").first.inner_text()
        picture(tab, f"site-{heading.split()[0]}", width)
        tab.go_back()
    tab.locator("ul.parts").get_by_role("link", name="Libraries in Rust", exact=True).click()
    assert "fakir" in tab.locator("h1").first.inner_text()
    picture(tab, "site-rust", width)


@needs_site
def test_the_page_runs_or_its_absence_is_stated(visit):
    tab, width = visit
    link = tab.get_by_role("link", name="Try it in the browser")
    newest = json.loads((Path(SITE) / "versions.json").read_text(encoding="utf-8"))[0]
    if (Path(SITE) / newest / "page" / "index.html").is_file():
        link.click()
        # An attribute of the document: the page does not allow evaluated scripts.
        tab.locator("body[data-busy='no']").wait_for(timeout=60_000)
        # The critical force of the paper's case, mN.
        assert float(tab.locator("#force-value").inner_text()) == pytest.approx(4.448, rel=1e-3)
        picture(tab, "site-page", width)
    else:
        assert link.count() == 0
        assert "does not contain the page" in tab.locator("li.absent").inner_text()


@needs_site
def test_versions_lead_to_each_other(visit):
    tab, _ = visit
    newest = json.loads((Path(SITE) / "versions.json").read_text(encoding="utf-8"))[0]
    tab.locator("table.versions a").first.click()
    assert tab.url.endswith(f"/{newest}/index.html")
    tab.get_by_role("link", name="All versions").click()
    assert tab.title() == "fakir"


@needs_site
@pytest.mark.parametrize("word, page", [("pull-off", "howto/pull-off"), ("offset_angle", "reference/keys")])
def test_the_search_of_the_manual_finds(visit, served, word, page):
    tab, _ = visit
    tab.get_by_role("link", name="Manual", exact=True).click()
    # The button works once the scripts have run, and keys before it has shown the field would go to the page.
    tab.wait_for_url("**/manual/**")
    tab.locator("#mdbook-search-toggle").click()
    tab.locator("#mdbook-searchbar").wait_for()
    tab.locator("#mdbook-searchbar").press_sequentially(word)
    results = tab.locator("#mdbook-searchresults li a")
    results.first.wait_for()
    found = [result.get_attribute("href") for result in results.all()]
    assert any(f"{page}.html" in address for address in found), found
    results.first.click()
    assert word.split("_")[0] in tab.locator("main").inner_text().lower()


@needs_site
def test_the_search_of_the_libraries_finds(visit, served):
    tab, width = visit
    newest = json.loads((Path(SITE) / "versions.json").read_text(encoding="utf-8"))[0]
    tab.goto(f"{served}{newest}/rust/fakir/index.html?search=ContactState")
    results = tab.locator("#search a")
    results.first.wait_for()
    assert any("ContactState" in (address.get_attribute("href") or "") for address in results.all())
    picture(tab, "site-rust-search", width)


class Links(HTMLParser):
    """What a page points at and loads, and what in it can be pointed at."""

    def __init__(self):
        super().__init__(convert_charrefs=True)
        self.links, self.anchors, self.moved_to = [], set(), None

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        if attributes.get("http-equiv") == "refresh":
            self.moved_to = attributes["content"].split("URL=", 1)[-1]
        for name in ["href", "src"]:
            if attributes.get(name):
                self.links.append(attributes[name])
        for name in ["id", "name"]:
            if attributes.get(name):
                self.anchors.add(attributes[name])


def broken(site):
    """Links inside a site that lead nowhere."""
    pages = {}
    for path in site.rglob("*.html"):
        parser = Links()
        parser.feed(path.read_text(encoding="utf-8"))
        pages[path.relative_to(site).as_posix()] = parser
    problems = []
    for page, parser in pages.items():
        # The page of what is not found is served from anywhere; the one to print repeats the others; rustdoc's pages about itself lead
        # to a page of all crates, which is not there.
        if Path(page).name in {"404.html", "print.html", "toc.html", "help.html", "settings.html"}:
            continue
        for link in parser.links:
            address = urlsplit(urljoin(f"http://site/{page}", link))
            if address.netloc != "site" or address.scheme != "http":
                continue
            target = unquote(address.path).lstrip("/")
            if target == "" or target.endswith("/"):
                target += "index.html"
            # A page that has moved hands the anchor on.
            while target in pages and pages[target].moved_to:
                target = unquote(urlsplit(urljoin(f"http://site/{target}", pages[target].moved_to)).path).lstrip("/")
            anchor = unquote(address.fragment)
            # Lines of source code, and search, are shown by scripts.
            if not (site / target).exists():
                problems.append(f"{page}: {link}")
            elif anchor and target in pages and "/src/" not in target and not {anchor, address.fragment} & pages[target].anchors:
                problems.append(f"{page}: {link}")
    return len(pages), problems


@needs_site
def test_every_link_of_the_site_is_held():
    pages, problems = broken(Path(SITE))
    assert pages > 200
    assert not problems, "\n".join(problems[:50])


def assembled(folder, version, **parts):
    command = [sys.executable, str(SCRIPT), "assemble", str(folder), version]
    for name, part in parts.items():
        command += [f"--{name}", str(part)]
    return subprocess.run(command, capture_output=True, text=True)


def made(folder, files):
    for name in files:
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(f"<h1>{name}</h1>", encoding="utf-8")
    return folder


def test_versions_are_kept_side_by_side(tmp_path):
    site = tmp_path / "site"
    manual = made(tmp_path / "manual", ["index.html", "gallery.html"])
    rust = made(tmp_path / "rust", ["fakir/index.html"])
    for version in ["0.9.0", "dev", "0.10.0"]:
        done = assembled(site, version, manual=manual, rust=rust)
        assert done.returncode == 0, done.stderr
    assert json.loads((site / "versions.json").read_text()) == ["0.10.0", "0.9.0", "dev"]
    front = (site / "index.html").read_text()
    assert "Version 0.10.0" in front and "does not contain the page" in front
    # A version is replaced as a whole, and has the page from then on.
    page = made(tmp_path / "page", ["index.html"])
    (manual / "gallery.html").unlink()
    assert assembled(site, "0.10.0", manual=manual, rust=rust, page=page).returncode == 0
    assert not (site / "0.10.0" / "manual" / "gallery.html").exists()
    front = (site / "index.html").read_text()
    assert 'href="0.10.0/page/index.html"' in front and "does not contain" not in front
    _, problems = broken(site)
    assert not problems


def test_what_is_not_built_is_refused(tmp_path):
    manual = made(tmp_path / "manual", ["index.html"])
    rust = made(tmp_path / "rust", ["fakir/index.html"])
    done = assembled(tmp_path / "site", "0.9.0", manual=tmp_path, rust=rust)
    assert done.returncode != 0 and "does not contain index.html: build it first" in done.stderr
    done = assembled(tmp_path / "site", "../x", manual=manual, rust=rust)
    assert done.returncode != 0 and "is not a version" in done.stderr
    assert not re.search(r"Traceback", done.stderr)
