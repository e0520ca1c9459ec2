"""The tutorial runs, and what it asserts holds; and the lines of the README in a new environment."""

import os
import re
import subprocess
import sys
import venv
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
TUTORIAL = ROOT / "python" / "tutorial"
SCRIPTS = sorted(set(TUTORIAL.glob("*.py")) - {TUTORIAL / "render.py"})


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.stem)
def test_tutorial(script, tmp_path):
    renderer = [sys.executable, str(TUTORIAL / "render.py"), str(tmp_path), str(script)]
    done = subprocess.run(renderer, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    page = (tmp_path / f"{script.stem}.md").read_text(encoding="utf-8")
    assert page.startswith("# ")
    figures = re.findall(r"!\[.*\]\((.*\.png)\)", page)
    assert figures
    assert all((tmp_path / name).stat().st_size > 1000 for name in figures)


def python_lines(path):
    """The blocks of Python in a file of Markdown."""
    return re.findall(r"^```python\n(.*?)^```", path.read_text(encoding="utf-8"), re.M | re.S)


@pytest.mark.skipif("FAKIR_WHEEL" not in os.environ, reason="no wheel was built")
def test_the_lines_of_the_readmes_in_a_new_environment(tmp_path):
    venv.create(tmp_path / "new", with_pip=True)
    folder = "Scripts" if sys.platform == "win32" else "bin"
    python = str(tmp_path / "new" / folder / "python")
    install = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
    environment["MPLBACKEND"] = "Agg"
    wheel = os.environ["FAKIR_WHEEL"] + "[plot,xarray,dask]"
    versions = str(Path(__file__).with_name("requirements.txt"))
    subprocess.run([*install, "--constraint", versions, wheel], check=True, env=environment)
    case = str(ROOT / "examples" / "paper-intermediate.toml")
    results = [os.environ["FAKIR"], "transition", case, "--output", "results", "--quiet"]
    subprocess.run(results, check=True, cwd=tmp_path, stdout=subprocess.DEVNULL)
    for path in [ROOT / "README.md", ROOT / "python" / "README.md"]:
        lines = python_lines(path)
        assert lines
        done = subprocess.run(
            [python, "-"], input="\n".join(lines), cwd=tmp_path, env=environment, text=True
        )
        assert done.returncode == 0, path
