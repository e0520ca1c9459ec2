"""Runs the tutorial and writes it as pages: Markdown, with figures beside it.

    python python/tutorial/render.py FOLDER [SCRIPT ...]

The scripts are in the percent format, which notebooks and editors read: ``# %%`` begins a cell of
code, ``# %% [markdown]`` one of text. What a cell prints, the value of its last line and its figures
come after it.
"""

import ast
import contextlib
import io
import re
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402

CELL = re.compile(r"^# %%(?P<kind> \[markdown\])?.*\n", re.MULTILINE)


def cells(text):
    """Pairs of whether it is code, and the text of a cell."""
    marks = [*CELL.finditer(text)]
    ends = [mark.start() for mark in marks[1:]] + [len(text)]
    for mark, end in zip(marks, ends):
        body = text[mark.end() : end].strip("\n")
        if mark["kind"]:
            body = "\n".join(line.removeprefix("#").removeprefix(" ") for line in body.splitlines())
        yield mark["kind"] is None, body


def run(code, name, names):
    """Runs a cell; gives what it printed, with the value of its last line if that has one."""
    tree = ast.parse(code, name)
    last = None
    if tree.body and isinstance(tree.body[-1], ast.Expr) and not code.rstrip().endswith(";"):
        last = ast.Expression(tree.body.pop().value)
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(tree, name, "exec"), names)
        if last is not None:
            value = eval(compile(last, name, "eval"), names)
            if value is not None:
                print(value)
    return printed.getvalue().rstrip()


def render(script, folder):
    """The page of a script."""
    page, figures = [], 0
    names = {"__name__": "__main__"}
    for is_code, body in cells(script.read_text(encoding="utf-8")):
        if not is_code:
            page.append(body)
            continue
        page.append(f"```python\n{body}\n```")
        output = run(body, script.name, names)
        if output:
            page.append(f"```text\n{output}\n```")
        for number in plt.get_fignums():
            figures += 1
            name = f"{script.stem}-{figures}.png"
            plt.figure(number).savefig(folder / name, dpi=120)
            page.append(f"![Figure {figures}]({name})")
        plt.close("all")
    path = folder / f"{script.stem}.md"
    path.write_text("\n\n".join(page) + "\n", encoding="utf-8")
    return path


def main(arguments):
    if not arguments:
        sys.exit(__doc__)
    folder = Path(arguments[0])
    folder.mkdir(parents=True, exist_ok=True)
    here = Path(__file__)
    scripts = [Path(name) for name in arguments[1:]]
    for script in scripts or sorted(set(here.parent.glob("*.py")) - {here}):
        print(render(script, folder))


if __name__ == "__main__":
    main(sys.argv[1:])
