"""Types: the package passes mypy, and the stubs are those of the extension module."""

import re
import subprocess
import sys
from pathlib import Path

import pytest
from stubs import FILE, stubs

PACKAGE = Path(__file__).parents[2] / "python"


def mypy(*arguments):
    done = subprocess.run(
        [sys.executable, "-m", *arguments], cwd=PACKAGE, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.slow
def test_the_package_is_strictly_typed(tmp_path):
    mypy("mypy", "--strict", "--cache-dir", str(tmp_path), "--package", "fakir")


def test_the_stubs_name_what_there_is():
    import fakir._fakir as module

    stub = (PACKAGE / "fakir" / "_fakir.pyi").read_text()
    for name in dir(module):
        if name.startswith("_"):
            continue
        assert re.search(rf"^(def {name}\(|class {name}\b)", stub, re.M), name
        members = vars(getattr(module, name)) if isinstance(getattr(module, name), type) else {}
        for member in members:
            assert member.startswith("_") or f"def {member}(" in stub, f"{name}.{member}"


def test_the_stubs_of_numbers_are_those_of_the_record():
    assert FILE.read_text() == stubs(), "python tests/python/stubs.py writes them"
