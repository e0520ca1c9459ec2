"""Makes notebooks of the tutorials of the manual, in the folder `notebooks`.

    python book/notebooks.py [FOLDER]

Each page of `book/pages/tutorials` with commands or lines of Python becomes a notebook with the same text, in the same order. Its cells
are the blocks that `pages.py` executes, with the output that the page shows:

```python          a cell; the block ```text that follows is its output
```console         a cell for each command, which runs it in a shell, with its output
```generate        a cell that prints the output of the command

Links lead to the pages of the manual on the site, if the repository is named in Cargo.toml. The first cell of a notebook installs fakir
where it is missing, as on Colab, and changes to the folder with the examples.
"""

import json
import re
import sys
import tomllib
from pathlib import Path

from pages import BLOCK, PICTURE, ROOT

TUTORIALS = ROOT / "book" / "pages" / "tutorials"
NOTEBOOKS = ROOT / "notebooks"
LINK = re.compile(r"(?<!!)\[(?P<words>[^\]]+)\]\((?P<address>[^)]+)\)")
WORKSPACE = tomllib.loads((ROOT / "Cargo.toml").read_text(encoding="utf-8"))["workspace"]["package"]
REPOSITORY = WORKSPACE.get("repository")

# Changes to the folder with `examples`, above a notebook in its clone; elsewhere the source archive is downloaded or uploaded.
PREPARATION = """\
import importlib.util
import os
import sys
from pathlib import Path

if importlib.util.find_spec("fakir") is None:
    get_ipython().run_line_magic("pip", "install --quiet fakir[dask,plot,xarray]=={version}")
# Without moving lines of progress.
os.environ["TERM"] = "dumb"
os.environ["PATH"] = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
here = Path.cwd()
root = next((folder for folder in [here, *here.parents] if (folder / "examples").is_dir()), None)
{clone}assert root, "put the folder `examples` of the source archive next to this notebook"
os.chdir(root)"""
CLONE = """\
if root is None:
    get_ipython().system("git clone --quiet --depth 1 {repository} fakir-source")
    root = here / "fakir-source"
"""


def markdown(text):
    """A cell of text. Links to other pages keep their words; without a site they lead nowhere."""
    def linked(match):
        address = match["address"]
        return match[0] if "//" in address else match["words"]

    return {"cell_type": "markdown", "metadata": {}, "source": LINK.sub(linked, text).strip().splitlines(keepends=True)}


def code(source, output=None, metadata=None):
    """A cell of Python with the text that it prints."""
    outputs = []
    if output:
        outputs.append({"name": "stdout", "output_type": "stream", "text": output.splitlines(keepends=True)})
    return {
        "cell_type": "code",
        "execution_count": None,
        "metadata": metadata or {},
        "outputs": outputs,
        "source": source.strip("\n").splitlines(keepends=True),
    }


def shell(command):
    """A command of a shell as a cell; lines that end with \\ are continued."""
    if re.search(r"[{}$]", command):
        raise ValueError(f"a notebook would replace names in this command: {command}")
    return "!" + command


def commands(body):
    """The commands of a block of a console, each with its output."""
    found = []
    for line in body.splitlines():
        if line.startswith("$ "):
            found.append([[line.removeprefix("$ ")], []])
        elif found and found[-1][0][-1].endswith("\\"):
            found[-1][0].append(line)
        else:
            found[-1][1].append(line)
    return [("\n".join(command), "\n".join(output)) for command, output in found]


def pictures(text):
    """The text in pieces: words, and pictures that cells before have made, as names of files."""
    end = 0
    for match in PICTURE.finditer(text):
        yield "words", text[end : match.start()]
        yield "picture", match
        end = match.end()
    yield "words", text[end:]


def cells_of_text(text, before=""):
    """Cells of text and pictures. A figure that the lines `before` have drawn is shown below them already."""
    for kind, piece in pictures(text):
        if kind == "words":
            if piece.strip():
                yield markdown(piece)
        elif f'savefig("{piece["path"]}")' in before:
            yield markdown(f"*{piece['caption']}*")
        else:
            viewer = "SVG" if piece["path"].endswith(".svg") else "Image"
            yield code(f'from IPython.display import {viewer}\n\n{viewer}("{piece["path"]}")')
            yield markdown(f"*{piece['caption']}*")


def cells(text):
    """The cells of a page."""
    end, before = 0, ""
    blocks = [*BLOCK.finditer(text)]
    for number, block in enumerate(blocks):
        if block.start() < end:
            continue
        yield from cells_of_text(text[end : block.start()], before)
        before = block["body"]
        kind, *words = block["kind"].split(",")
        end = block.end()
        if kind == "python":
            following = blocks[number + 1] if number + 1 < len(blocks) else None
            output = None
            if following and following["kind"] == "text" and not text[end : following.start()].strip():
                output, end = following["body"], following.end()
            yield code(block["body"], output)
        elif kind == "console":
            for command, output in commands(block["body"]):
                yield code(shell(command), output)
        elif kind == "generate":
            yield code(shell(block["body"].strip()), metadata={"tags": ["not-on-the-page"]})
        else:
            yield markdown(block[0])
    yield from cells_of_text(text[end:], before)


def notebook(page):
    """The notebook of a page; None if nothing of it can be run outside of the manual."""
    text = page.read_text(encoding="utf-8")
    kinds = {block["kind"].split(",")[0] for block in BLOCK.finditer(text)}
    if not kinds & {"python", "console"}:
        return None
    made = list(cells(text))
    clone = CLONE.format(repository=REPOSITORY) if REPOSITORY else ""
    preparation = PREPARATION.format(version=WORKSPACE["version"], clone=clone)
    made.insert(1, code(preparation, metadata={"tags": ["preparation"]}))
    for number, cell in enumerate(made):
        cell["id"] = f"{page.stem}-{number}"
    return {
        "cells": made,
        "metadata": {
            "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
            "language_info": {"name": "python"},
        },
        "nbformat": 4,
        "nbformat_minor": 5,
    }


def notebooks():
    """All notebooks, by their names."""
    made = {page.stem: notebook(page) for page in sorted(TUTORIALS.glob("*.md"))}
    return {f"{name}.ipynb": json.dumps(book, indent=1, ensure_ascii=False) + "\n" for name, book in made.items() if book}


def main(folder):
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in notebooks().items():
        path = folder / name
        if not path.is_file() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")
            print(f"{path}: written")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else NOTEBOOKS)
