"""Puts the manual, the documentation of the libraries and the page of the browser together to one static site.

    python book/website.py assemble SITE VERSION --manual FOLDER --rust FOLDER [--page FOLDER]
    python book/website.py index SITE
    python book/website.py serve SITE [--port N]

`assemble` writes the folder SITE/VERSION, replaces it if it is there, and writes SITE/index.html with all versions that SITE contains.
VERSION is a number, as 0.2.0, or `dev` for the main branch. Without --page the site states that it has no page.

`index` writes SITE/index.html alone, after versions were added or removed.

`serve` serves the folder on this machine only. `cargo xtask site` builds the parts and runs `assemble`.
"""

import argparse
import functools
import html
import http.server
import json
import re
import shutil
import sys
from pathlib import Path

TITLE = "fakir"
# Crates of the checks.
UNPUBLISHED = ("fakir_checks", "fakir_manual", "xtask")
LEAD = "Contact of an elastic lens with a surface patterned with micro-pillars, and the load at which it reaches the floor between them."

STYLE = """\
:root { color-scheme: light dark; --ink: #1a2430; --paper: #fff; --line: #c9d2dc; --accent: #0b5cad; --soft: #f3f6f9; }
@media (prefers-color-scheme: dark) { :root { --ink: #dfe6ee; --paper: #12181f; --line: #36424f; --accent: #7db8f2; --soft: #1a222b; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--paper); color: var(--ink); font: 1rem/1.55 system-ui, sans-serif; }
main { max-width: 64rem; margin: 0 auto; padding: 2rem 1.25rem 4rem; }
h1 { font-size: 2.2rem; margin: 0 0 .25rem; }
h2 { margin: 2.5rem 0 .75rem; font-size: 1.25rem; }
a { color: var(--accent); }
.lead { font-size: 1.15rem; margin: 0 0 2rem; max-width: 44rem; }
ul.parts { list-style: none; margin: 0; padding: 0; display: grid; gap: 1rem; grid-template-columns: repeat(auto-fill, minmax(min(100%, 18rem), 1fr)); }
ul.parts li { border: 1px solid var(--line); border-radius: .5rem; padding: 1rem 1.1rem; background: var(--soft); }
ul.parts a, ul.parts strong { font-size: 1.1rem; font-weight: 600; }
ul.parts p { margin: .35rem 0 0; }
table { border-collapse: collapse; }
th, td { text-align: left; padding: .35rem 1.5rem .35rem 0; border-bottom: 1px solid var(--line); }
img { max-width: 100%; height: auto; border-radius: .5rem; border: 1px solid var(--line); background: #fff; }
"""

# Address in the folder of a version, name, what it contains.
PARTS = [
    ("manual/index.html", "Manual", "What fakir computes, installation, tutorials, how-to guides, theory, validation and reference."),
    ("manual/start.html", "Start in ten minutes", "From a case file to a critical state, a curve and a figure."),
    ("manual/gallery.html", "Gallery", "Figures of all kinds of results, with the commands that draw them."),
    ("manual/other-programs.html", "Which program?", "fakir and other programs for contact and for force curves, and when to use which."),
    ("rust/fakir/index.html", "Libraries in Rust", "The documentation of all crates."),
    ("manual/reference/libraries.html", "Python package", "Its functions and classes, and where they correspond to commands."),
]
PAGE = ("page/index.html", "Try it in the browser", "Move sliders and see pressure, section and curves. Nothing is installed and nothing leaves your machine.")
NO_PAGE = "This version of the site does not contain the page that runs in the browser. With the program installed, `fakir explore` opens it."


def document(title, body):
    return f"""<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{html.escape(title)}</title>
<link rel="icon" href="data:,">
<style>
{STYLE}</style>
</head>
<body>
<main>
{body}
</main>
</body>
</html>
"""


def card(address, name, content):
    return f'<li><a href="{address}">{html.escape(name)}</a><p>{html.escape(content)}</p></li>'


def parts(folder, prefix=""):
    """The list of what a version contains."""
    cards = [card(prefix + address, name, content) for address, name, content in PARTS if (folder / address).is_file()]
    address, name, content = PAGE
    if (folder / address).is_file():
        cards.insert(0, card(prefix + address, name, content))
    else:
        words = re.sub(r"`([^`]+)`", r"<code>\1</code>", html.escape(NO_PAGE))
        cards.append(f'<li class="absent"><strong>{html.escape(name)}</strong><p>{words}</p></li>')
    return '<ul class="parts">\n' + "\n".join(cards) + "\n</ul>"


def order(version):
    """Numbers from the newest to the oldest, the main branch last."""
    numbers = tuple(int(number) for number in re.findall(r"\d+", version))
    return (version != "dev", numbers)


def versions(site):
    found = [path.name for path in site.iterdir() if (path / "manual" / "index.html").is_file()]
    return sorted(found, key=order, reverse=True)


def name_of(version):
    return "main branch" if version == "dev" else f"version {version}"


def write_version(site, version):
    body = f'<p><a href="../index.html">All versions</a></p>\n<h1>{TITLE}, {name_of(version)}</h1>\n<p class="lead">{LEAD}</p>\n'
    body += parts(site / version)
    (site / version / "index.html").write_text(document(f"{TITLE}, {name_of(version)}", body), encoding="utf-8")


def write_front(site):
    """The first page of the site: the newest version, and a table of all."""
    known = versions(site)
    if not known:
        raise SystemExit(f"{site} contains no version of the manual")
    newest = known[0]
    body = f'<h1>{TITLE}</h1>\n<p class="lead">{LEAD}</p>\n'
    picture = site / newest / "manual" / "sketch.svg"
    body += f"<h2>{name_of(newest).capitalize()}</h2>\n" + parts(site / newest, f"{newest}/")
    if picture.is_file():
        body += f'\n<p><img src="{newest}/manual/sketch.svg" alt="A lens on pillars, in section and from above"></p>'
    rows = []
    for version in known:
        cells = [f'<a href="{version}/index.html">{name_of(version)}</a>', f'<a href="{version}/manual/index.html">manual</a>']
        cells.append(f'<a href="{version}/rust/fakir/index.html">Rust</a>')
        rows.append("<tr>" + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>")
    body += '\n<h2>All versions</h2>\n<table class="versions">\n' + "\n".join(rows) + "\n</table>"
    (site / "index.html").write_text(document(TITLE, body), encoding="utf-8")
    (site / "versions.json").write_text(json.dumps(known, indent=1) + "\n", encoding="utf-8")
    # Folders whose names begin with an underscore are served as they are.
    (site / ".nojekyll").touch()


def assemble(site, version, manual, rust, page):
    if not re.fullmatch(r"dev|\d+(\.\d+)*", version):
        raise SystemExit(f"{version} is not a version: give a number such as 0.2.0, or dev")
    for folder, file in [(manual, "index.html"), (rust, "fakir/index.html"), (page, "index.html")]:
        if folder is not None and not (folder / file).is_file():
            raise SystemExit(f"{folder} does not contain {file}: build it first")
    target = site / version
    making = site / f".{version}.tmp"
    shutil.rmtree(making, ignore_errors=True)
    making.mkdir(parents=True)
    for folder, name in [(manual, "manual"), (rust, "rust"), (page, "page")]:
        if folder is not None:
            # The locks and listings of cargo, and the crates of the checks, are not part of the documentation.
            shutil.copytree(folder, making / name, ignore=shutil.ignore_patterns(".lock", "*.tmp", *UNPUBLISHED))
    forward = '<meta http-equiv="refresh" content="0; url=fakir/index.html">'
    index = making / "rust" / "index.html"
    if not index.is_file():
        link = '<p><a href="fakir/index.html">The libraries of fakir</a></p>'
        index.write_text(document("The libraries of fakir", link).replace("</head>", f"{forward}\n</head>"), encoding="utf-8")
    shutil.rmtree(target, ignore_errors=True)
    making.rename(target)
    write_version(site, version)
    write_front(site)
    print(f"the site: {site / 'index.html'}, with {', '.join(name_of(known) for known in versions(site))}")


def serve(site, port):
    """Serves the site on this machine; prints its address."""
    if not (site / "index.html").is_file():
        raise SystemExit(f"{site} contains no site: run cargo xtask site first")
    handler = functools.partial(http.server.SimpleHTTPRequestHandler, directory=str(site))
    with http.server.ThreadingHTTPServer(("127.0.0.1", port), handler) as server:
        print(f"http://127.0.0.1:{server.server_address[1]}/", flush=True)
        try:
            server.serve_forever()
        except KeyboardInterrupt:
            pass


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    making = commands.add_parser("assemble")
    making.add_argument("site", type=Path)
    making.add_argument("version")
    making.add_argument("--manual", type=Path, required=True)
    making.add_argument("--rust", type=Path, required=True)
    making.add_argument("--page", type=Path)
    listing = commands.add_parser("index")
    listing.add_argument("site", type=Path)
    serving = commands.add_parser("serve")
    serving.add_argument("site", type=Path)
    serving.add_argument("--port", type=int, default=8000)
    options = parser.parse_args(arguments)
    if options.command == "serve":
        serve(options.site, options.port)
    elif options.command == "index":
        write_front(options.site)
    else:
        options.site.mkdir(parents=True, exist_ok=True)
        assemble(options.site, options.version, options.manual, options.rust, options.page)


if __name__ == "__main__":
    main(sys.argv[1:])
