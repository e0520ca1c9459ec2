"""The built program and a real browser: their paths are in the environment variables FAKIR and CHROMIUM.

If PAGE names the folder of the page without a server, the tests run against both engines, except those of the server itself
(mark `server`).
"""

import functools
import http.server
import os
import re
import shutil
import signal
import subprocess
import threading
import time
from contextlib import contextmanager

import pytest
from playwright.sync_api import sync_playwright

ARGUMENTS = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]
NAMES = ["chromium", "chromium-browser", "google-chrome"]


@contextmanager
def exploring(*arguments):
    """Runs `fakir explore` and returns the address of its page."""
    command = [os.environ["FAKIR"], "explore", "--no-browser", *arguments]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    try:
        first = process.stderr.readline()
        found = re.search(r"http://127\.0\.0\.1:\d+/[0-9a-f]{32}/", first)
        assert found, first
        yield found.group(0)
    finally:
        process.send_signal(signal.SIGINT)
        assert process.wait(timeout=20) == 0
        process.stderr.close()


class Quiet(http.server.SimpleHTTPRequestHandler):
    """A plain server of files without a log."""

    def log_message(self, *_):
        pass


@contextmanager
def serving(folder):
    """Serves the files of a folder and returns the address."""
    handler = functools.partial(Quiet, directory=folder)
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}/"
        server.shutdown()


ENGINES = ["server"] + [pytest.param("module", marks=pytest.mark.module)] * bool(os.environ.get("PAGE"))


def pytest_collection_modifyitems(items):
    for item in items:
        if item.get_closest_marker("module") and item.get_closest_marker("server"):
            item.add_marker(pytest.mark.skip(reason="a test of the server"))


@pytest.fixture(scope="session", params=ENGINES)
def address(request):
    engine = exploring() if request.param == "server" else serving(os.environ["PAGE"])
    with engine as address:
        yield address


@pytest.fixture(scope="session")
def browser():
    program = os.environ.get("CHROMIUM") or next(filter(None, map(shutil.which, NAMES)), None)
    assert program, "no Chromium: name one in the environment variable CHROMIUM"
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=ARGUMENTS)
        yield browser
        browser.close()


class Explorer:
    """The page, with the actions of a user."""

    def __init__(self, page, requests):
        self.page = page
        self.requests = requests

    def until(self, condition, seconds=600):
        """Waits until a condition in JavaScript is true; the page itself does not allow evaluated scripts. The end is for pages that hang only:
        how fast a page is is measured by benchmarks, as tests run beside compilers."""
        end = time.monotonic() + seconds
        while not self.page.evaluate(f"() => {condition}"):
            assert time.monotonic() < end, f"not within {seconds} s: {condition}; {self.account()}"
            time.sleep(0.02)

    def account(self):
        """The state of the page, for the message of a failure."""
        stage = self.page.evaluate("() => document.getElementById('cycle-stage')?.textContent")
        return f"the page is at {self.page.url}, busy: {self.page.evaluate('() => document.body.dataset.busy')}, stage: {stage!r}"

    def press(self, key):
        """Presses a key, and waits until its change is drawn."""
        self.page.keyboard.press(key)
        self.frame()

    def text(self, name):
        return self.page.evaluate(f"() => document.getElementById('{name}').textContent")

    def overlap(self, selector):
        """Whether any two of these elements overlap."""
        return self.page.evaluate(
            """(selector) => {
                const boxes = [...document.querySelectorAll(selector)].map((x) => x.getBoundingClientRect());
                return boxes.some((a, i) => boxes.some((b, j) => i < j
                    && a.left < b.right - 1 && b.left < a.right - 1
                    && a.top < b.bottom - 1 && b.top < a.bottom - 1));
            }""",
            selector,
        )

    def picture(self, name):
        """Saves the whole page as a picture, if the environment variable SCREENSHOTS names a folder."""
        folder = os.environ.get("SCREENSHOTS")
        if folder:
            self.page.wait_for_timeout(3000)
            self.page.screenshot(path=f"{folder}/{name}.png", full_page=True)

    def rest(self):
        """Waits until the page has the answers to all its requests, and has drawn them.

        A change that asks nothing, as one of the exaggeration, does not make the page busy: it is drawn in the next frame.
        """
        self.until("document.body.dataset.busy === 'no'")
        self.frame()

    def frame(self):
        """Waits for the end of a frame, in which all changes until then are drawn together."""
        self.page.evaluate("() => new Promise((drawn) => requestAnimationFrame(() => drawn()))")

    def change(self, key, value):
        """Enters a value without waiting for the answer."""
        field = self.page.locator(f"#{key.replace('.', '-')}")
        field.fill(value)
        field.press("Enter")

    def enter(self, key, value):
        """Enters a value and waits for the answer."""
        self.change(key, value)
        self.rest()

    def slide(self, name, value):
        """Moves a slider as a pointer does."""
        self.page.evaluate(
            """([name, value]) => {
                const slider = document.getElementById(name);
                slider.value = value;
                slider.dispatchEvent(new Event("input", { bubbles: true }));
            }""",
            [name, str(value)],
        )
        self.rest()

    def results(self):
        return [self.text(f"{name}-value") for name in ("force", "radius", "indentation")]


@pytest.fixture
def explore(browser, address):
    """Opens the page and waits for its answer if it `rests`; `before` is called with the empty page.

    Requests to other machines are blocked, and fail the test.
    """
    contexts = []

    def open_page(fragment="", width=1440, height=900, address=address, rests=True, before=None, **options):
        context = browser.new_context(
            viewport={"width": width, "height": height}, accept_downloads=True, **options
        )
        requests, problems = [], []

        def route(route):
            url = route.request.url
            requests.append(url)
            if url.startswith(("http://127.0.0.1:", "data:", "blob:")):
                route.continue_()
            else:
                route.abort()

        context.route("**/*", route)
        page = context.new_page()
        page.on("pageerror", lambda error: problems.append(str(error)))
        contexts.append((context, requests, problems))
        if before is not None:
            before(page)
        page.goto(address + fragment)
        explorer = Explorer(page, requests)
        if rests:
            explorer.rest()
        return explorer

    yield open_page
    for context, requests, problems in contexts:
        context.close()
        assert not problems
        assert requests
        assert all(url.startswith(("http://127.0.0.1:", "data:", "blob:")) for url in requests)
