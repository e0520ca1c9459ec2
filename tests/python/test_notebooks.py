"""The notebooks of the tutorials: they are those that the pages of the manual give, and they run with the results of the pages."""

import importlib.util
import os
import re
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))


def of_the_book(name):
    """A script of the manual as a module."""
    sys.path.insert(0, str(ROOT / "book"))
    try:
        found = importlib.util.spec_from_file_location(name, ROOT / "book" / f"{name}.py")
        module = importlib.util.module_from_spec(found)
        found.loader.exec_module(module)
        return module
    finally:
        sys.path.pop(0)


def test_notebooks_are_made_from_the_pages():
    made = of_the_book("notebooks").notebooks()
    kept = {path.name: path.read_text(encoding="utf-8") for path in NOTEBOOKS}
    assert set(kept) == set(made)
    for name, text in made.items():
        assert kept[name] == text, f"{name} is not what its page gives: run python book/notebooks.py"


def test_every_tutorial_with_code_is_a_notebook():
    pages = {path.stem for path in (ROOT / "book" / "pages" / "tutorials").glob("*.md")}
    # The explorer is used with a pointer.
    assert {path.stem for path in NOTEBOOKS} == pages - {"explorer"}


@pytest.mark.slow
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebooks_run_with_the_results_of_the_pages(path, tmp_path, monkeypatch):
    import nbformat
    from nbclient import NotebookClient

    pages = of_the_book("pages")
    folder = tmp_path / "clone"
    pages.prepare(folder)
    (folder / "notebooks").mkdir()
    # The command of the package is next to Python.
    monkeypatch.setenv("PATH", os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]]))
    book = nbformat.read(path, as_version=4)
    nbformat.validate(book)
    expected = [cell.get("outputs", []) for cell in book.cells]
    client = NotebookClient(book, timeout=300, kernel_name="python3", resources={"metadata": {"path": str(folder / "notebooks")}})
    client.execute()
    compared = 0
    for number, (cell, outputs) in enumerate(zip(book.cells, expected, strict=True)):
        if cell.cell_type == "code" and outputs:
            difference = pages.difference(f"{path.name}, cell {number}", outputs[0]["text"], printed(cell))
            assert difference is None, difference
            compared += 1
    assert compared > 0
    assert not list((folder / "notebooks").iterdir()), "files are written to the folder of the examples"


def printed(cell):
    """What a cell prints, with the value of its last line; warnings of Python are not on the pages."""
    parts = []
    for output in cell.outputs:
        if output.output_type == "stream" and output.name == "stdout":
            parts.append(output.text)
        elif output.output_type == "execute_result":
            parts.append(output.data["text/plain"])
    text = "".join(parts).replace("\r\n", "\n")
    # Without the colours of a terminal.
    text = re.sub(r"\x1b\[[0-9;]*m", "", text)
    return "\n".join(line.rstrip() for line in text.strip("\n").splitlines())
