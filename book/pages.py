"""Executes the blocks of the pages of the manual, and compares the output with the pages.

    python book/pages.py PAGES OUTPUT [--update] [--only NAME]

Runs every page below the folder PAGES, each in a separate working folder, and writes the pages of the book to OUTPUT.
A working folder contains the files that pages use, at the paths that they have in the repository: a reader can run every
line from the root of a clone. No two pages may create the same file or folder there, so that a reader can also run all
pages one after another, in any order. Blocks that are run:

```console          commands after "$ " (a line that ends with \\ is continued), each followed by its output;
                    "console,status=2" gives the exit status of the last one, otherwise 0
```python           lines of Python, in one interpreter for the whole page; their output, and the value of the
                    last line, is the block ```text that follows; "python,hidden" is run and not shown
```generate         a command that is replaced by its output; "generate,toml" names a language of that block,
                    "generate,markdown" makes it a part of the page

Other blocks are not run. With --update blocks that differ are replaced by the output.

Numbers are compared as numbers, so that a page stays the same when sums are computed in another order. Two numbers agree

* if they differ by at most one unit in the last printed digit of the coarser one (18.07 and 18.0689, 199 um and 200 um),
  or by 1e-6 of the larger one;
* in per cent, if they differ by at most 1e-4 %, which is 1e-6 of the whole;
* as error estimates and differences between methods (after the word "error", "difference" or "allowed"), if one is at most 1.5
  times the other.

A whole number is a count and must be equal, unless it has two digits or more and a unit follows. Words must be equal.
Times, counts of the solvers' steps and widths of columns are not compared.
"""

import ast
import concurrent.futures
import contextlib
import difflib
import io
import os
import re
import shutil
import subprocess
import sys
from decimal import Decimal
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]

# Files and folders of the repository that commands and scripts of the pages use.
USED = ["examples", "bench", "book/scripts", "crates/fakir/tests/reference", "CHANGELOG.md"]

# Pages outside the folder of pages: they are run as well, and those of theory are a part of the book.
THEORY = ROOT / "crates" / "fakir" / "doc"
README = ROOT / "README.md"

BLOCK = re.compile(r"^```(?P<kind>[\w,=+-]*)\n(?P<body>.*?)^```\n", re.MULTILINE | re.DOTALL)
PICTURE = re.compile(r"!\[(?P<caption>[^\]]*)\]\((?P<path>[^):]+)\)")
TIMES = re.compile(r"\b\d+(\.\d+)?(e-?\d+)? (ns|us|ms|s|min)\b|(?<=wall_time_s\": )[\d.e-]+")
STEPS = re.compile(r"\b(Newton steps|load steps|stations|iterations|rounds|converged in) +\d+\b")

# A number that is not a part of a word, a name or a version.
NUMBER = re.compile(r"(?<![\w.-])([-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?)(?!\w|\.\d)")
# Words after a whole number that show that it was measured.
UNIT = re.compile(r" ?(%|°|(rad|deg|[pnuµmkMG]?(m|N|J|Pa))\b)")
# Words before a number that show that it is an error estimate.
ESTIMATE = re.compile(r"(?<!standard )\berror|_error|difference|allowed", re.IGNORECASE)


class Different(Exception):
    """A page that differs from the output of its commands."""


def compared(text):
    """The lines of a text, without times, counts of steps and widths of columns."""
    lines = [STEPS.sub(r"\1  STEPS", TIMES.sub("TIME", line)) for line in text.strip("\n").splitlines()]
    return [re.sub(r"─+", "─", re.sub(r"  +", "  ", re.sub(r" *TIME", "  TIME", line))).rstrip() for line in lines]


def numbers_agree(one, other, before, after):
    """Whether two numbers, as printed, agree between the words `before` and `after` them."""
    if one == other:
        return True
    if all(re.fullmatch(r"[-+]?\d+", number) for number in [one, other]):
        measured = UNIT.match(after) and all(re.search(r"\d\d", number) for number in [one, other])
        if not measured:
            return False
    pair = [Decimal(one), Decimal(other)]
    small, large = sorted(map(abs, pair))
    allowed = [Decimal(1).scaleb(number.as_tuple().exponent) for number in pair] + [large * Decimal("1e-6")]
    if re.match(" ?%", after):
        allowed.append(Decimal("1e-4"))
    estimates = ESTIMATE.search(before) and min(pair) > 0 and large <= small * Decimal("1.5")
    return bool(estimates) or abs(pair[0] - pair[1]) <= max(allowed)


def lines_agree(expected, actual):
    """Whether two lines have the same words, and numbers that agree."""
    # Words are at even places, numbers between them.
    one, other = NUMBER.split(expected), NUMBER.split(actual)
    return one[::2] == other[::2] and all(
        numbers_agree(one[k], other[k], one[k - 1], one[k + 1]) for k in range(1, len(one), 2)
    )


def difference(place, expected, actual):
    """The differences between a page and its program, as text; None if they agree."""
    shown, printed = compared(expected), compared(actual)
    if len(shown) == len(printed) and all(map(lines_agree, shown, printed)):
        return None
    # Lines that agree are not shown as a difference.
    printed = [next((line for line in shown if lines_agree(line, new)), new) for new in printed]
    lines = difflib.unified_diff(shown, printed, f"{place}, on the page", "as printed", "", "", 1, "")
    return "\n".join(lines)


class Page:
    """One page, run in a folder."""

    def __init__(self, path, folder, update):
        self.path, self.folder, self.update = path, folder, update
        self.text = path.read_text(encoding="utf-8")
        self.problems = []
        self.names = {"__name__": "__main__"}

    def run(self):
        """The page with its output; `text` is corrected if it is to be updated."""
        shown, kept, end = [], [], 0
        blocks = [*BLOCK.finditer(self.text)]
        for number, block in enumerate(blocks):
            if block.start() < end:
                continue
            between = self.text[end : block.start()]
            kind, *words = block["kind"].split(",")
            source, laid_out, end = block[0], block[0], block.end()
            if kind == "console":
                source = laid_out = self.console(block, words)
                laid_out = laid_out.replace(f"```{block['kind']}", "```console", 1)
            elif kind == "python":
                following = self.output_after(blocks, number)
                if following is not None:
                    end = following.end()
                source, laid_out = self.python(block, words, following)
            elif kind == "generate":
                laid_out = self.generated(block, words)
            shown += [between, laid_out]
            kept += [between, source]
        shown.append(self.text[end:])
        kept.append(self.text[end:])
        self.text = "".join(kept)
        return "".join(shown)

    def place(self, block):
        line = self.text.count("\n", 0, block.start()) + 1
        return f"{self.path}:{line}"

    def output_after(self, blocks, number):
        """The block of text right after a block, if there is one."""
        if number + 1 == len(blocks):
            return None
        block, following = blocks[number], blocks[number + 1]
        near = self.text[block.end() : following.start()].strip() == ""
        return following if near and following["kind"] == "text" else None

    def differs(self, block, expected, actual):
        problem = difference(self.place(block), expected, actual)
        if problem and not self.update:
            self.problems.append(problem)
        return problem is not None

    def command(self, command, expected, block):
        done = subprocess.run(
            ["bash", "-c", command],
            cwd=self.folder,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            stdin=subprocess.DEVNULL,
            timeout=300,
            text=True,
        )
        if done.returncode != expected:
            self.problems.append(
                f"{self.place(block)}: the status of `{command}` is {done.returncode}:\n{done.stdout}"
            )
        return "\n".join(line.rstrip() for line in done.stdout.strip("\n").splitlines())

    def console(self, block, words):
        status = next((int(w.removeprefix("status=")) for w in words if w.startswith("status=")), 0)
        commands = []
        for line in block["body"].splitlines():
            if line.startswith("$ "):
                commands.append([[line], []])
            elif not commands:
                self.problems.append(f"{self.place(block)}: the block does not begin with a command")
                return block[0]
            elif commands[-1][0][-1].endswith("\\"):
                commands[-1][0].append(line)
            else:
                commands[-1][1].append(line)
        lines = [f"```{block['kind']}"]
        for number, (command, output) in enumerate(commands):
            expected = status if number + 1 == len(commands) else 0
            printed = self.command("\n".join(command).removeprefix("$ "), expected, block)
            shown = "\n".join(output)
            if self.differs(block, shown, printed):
                shown = printed
            lines += command + [shown] * bool(shown)
        return "\n".join(lines) + "\n```\n"

    def python(self, block, words, following):
        printed = self.value(block)
        shown = following["body"].strip("\n") if following else ""
        if self.differs(block, shown, printed):
            shown = printed
        output = f"\n```text\n{shown}\n```\n" if shown else ""
        source = block[0] + output
        shown = output if "hidden" in words else block[0].replace(",hidden", "") + output
        return source, shown

    def value(self, block):
        """What a block of Python prints, with the value of its last line if that has one."""
        code, name = block["body"], self.place(block)
        printed = io.StringIO()
        here = Path.cwd()
        os.chdir(self.folder)
        try:
            tree = ast.parse(code, name)
            last = None
            shown = not code.rstrip().endswith(";")
            if tree.body and isinstance(tree.body[-1], ast.Expr) and shown:
                last = ast.Expression(tree.body.pop().value)
            with contextlib.redirect_stdout(printed):
                exec(compile(tree, name, "exec"), self.names)
                if last is not None:
                    value = eval(compile(last, name, "eval"), self.names)
                    if value is not None:
                        print(value)
        except Exception as error:
            self.problems.append(f"{name}: {type(error).__name__}: {error}")
        finally:
            os.chdir(here)
        if "matplotlib.pyplot" in sys.modules:
            sys.modules["matplotlib.pyplot"].close("all")
        return "\n".join(line.rstrip() for line in printed.getvalue().strip("\n").splitlines())

    def generated(self, block, words):
        printed = self.command(block["body"].strip(), 0, block)
        if words == ["markdown"]:
            return printed + "\n"
        return f"```{words[0] if words else 'text'}\n{printed}\n```\n"


def prepare(folder):
    """Creates a working folder that contains only the files that pages use, and returns their paths."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for name in USED:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, folder / name)
        else:
            shutil.copy(ROOT / name, folder / name)
    return set(folder.rglob("*"))


def created(folder, before):
    """The files and folders that a page has created in its working folder: the outermost ones, none from `before`."""
    new = {path for path in folder.rglob("*") if path not in before and path.name != "__pycache__"}
    return {path.relative_to(folder) for path in new if new.isdisjoint(path.parents)}


def created_twice(made):
    """The problems of pages that create the same file or folder, from what each page creates."""
    first = {}
    problems = []
    for page, names in made.items():
        for name in sorted(names):
            if name in first:
                problems.append(f"{page}: creates {name} as {first[name]} does: use another name")
            first.setdefault(name, page)
    return problems


def pictures(text, source, page, folder, output):
    """The text, with the pictures that the page has created copied into the book."""

    def taken(match):
        if (ROOT / match["path"]).is_file() or (source.parent / match["path"]).is_file():
            return match[0]
        made = folder / match["path"]
        if not made.is_file():
            raise Different(f"{page}: there is no picture {match['path']}")
        name = match["path"].replace("/", "-")
        target = output / page.parent / f"{page.stem}-{name}"
        shutil.copyfile(made, target)
        return f"![{match['caption']}]({target.name})"

    return PICTURE.sub(taken, text)


def run_page(path, page, output, update):
    """Runs a page and writes it to the output; returns its problems and what it has created."""
    folder = output.parent / f"{output.name}-run" / page.with_suffix("")
    before = prepare(folder)
    run = Page(path, folder.resolve(), update)
    text = run.text
    shown = run.run()
    (output / page).parent.mkdir(parents=True, exist_ok=True)
    if update and run.text != text:
        path.write_text(run.text, encoding="utf-8")
        print(f"{path}: rewritten", flush=True)
    try:
        shown = pictures(shown, path, page, folder, output)
    except Different as problem:
        run.problems.append(str(problem))
    (output / page).write_text(shown, encoding="utf-8")
    return run.problems, created(folder, before)


def main(arguments):
    update = "--update" in arguments
    only = arguments[arguments.index("--only") + 1] if "--only" in arguments else ""
    pages, output = Path(arguments[0]), Path(arguments[1])
    sources = [(path, path.relative_to(pages)) for path in sorted(pages.rglob("*.md"))]
    sources += [(path, Path("theory") / path.name) for path in sorted(THEORY.glob("*.md"))]
    sources.append((README, Path("README.md")))
    required = [source for source in sources if only in str(source[1])]
    problems, made = [], {}
    # As many at a time as there are processors.
    with concurrent.futures.ProcessPoolExecutor() as processes:
        running = [processes.submit(run_page, *source, output, update) for source in required]
        for (_, page), run in zip(required, running):
            found, made[page] = run.result()
            problems += found
    problems += created_twice(made)
    # Files that pages refer to and that are not created by a page.
    for path in [*pages.rglob("*.json"), *pages.rglob("*.svg")]:
        target = output / path.relative_to(pages)
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(path, target)
    for problem in problems:
        print(problem, file=sys.stderr)
    return 1 if problems else 0


if __name__ == "__main__":
    os.environ.setdefault("MPLBACKEND", "Agg")
    sys.exit(main(sys.argv[1:]))
