"""The manual in a browser, from files and without a network: search, and pages as wide as the screen."""

import os
from pathlib import Path

import pytest

BOOK = os.environ.get("BOOK")
pytestmark = pytest.mark.skipif(not BOOK, reason="the manual was not built: cargo xtask book")


def at(page):
    return (Path(BOOK) / f"{page}.html").absolute().as_uri()


@pytest.mark.parametrize("word, page", [("pull-off", "howto/pull-off"), ("offset_angle", "reference/keys")])
def test_search_finds(browser, word, page):
    tab = browser.new_page()
    tab.goto(f"{at('index')}?search={word}")
    results = tab.locator("#mdbook-searchresults li a")
    results.first.wait_for()
    addresses = [result.get_attribute("href") for result in results.all()]
    assert any(f"{page}.html" in address for address in addresses), addresses
    tab.close()


# Colours do not change the layout: every width and every scheme once.
@pytest.mark.parametrize("width, scheme", [(1400, "light"), (390, "dark")])
def test_pages_fit_the_screen_and_load_nothing_from_elsewhere(browser, width, scheme):
    context = browser.new_context(viewport={"width": width, "height": 900}, color_scheme=scheme)
    tab = context.new_page()
    asked, wrong = [], []
    tab.on("request", lambda request: asked.append(request.url))
    tab.on("pageerror", lambda error: wrong.append(str(error)))
    # Requests that are open when a page is left are cancelled.
    tab.on(
        "requestfailed",
        lambda request: request.failure == "net::ERR_ABORTED" or wrong.append(request.url),
    )
    pages = [path for path in Path(BOOK).rglob("*.html") if path.stem not in {"404", "print", "toc"}]
    assert len(pages) > 30
    for page in pages:
        tab.goto(page.absolute().as_uri())
        assert tab.evaluate("document.documentElement.scrollWidth") <= width, page
    assert not wrong
    assert all(url.startswith(("file:", "data:")) for url in asked)
    # Formulas are formulas.
    tab.goto(at("theory/spectral"))
    assert tab.locator("math").count() > 50
    context.close()
