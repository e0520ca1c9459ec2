"""The examples in the docstrings of the package, as printed, after `import fakir` and `import numpy as np`."""

import doctest
import importlib
import pkgutil
import warnings
from pathlib import Path

import fakir
import numpy as np
import pytest

MODULES = ["fakir", *(f"fakir.{module.name}" for module in pkgutil.iter_modules(fakir.__path__) if module.name not in {"_fakir", "__main__"})]


def examples():
    found = {}
    for name in MODULES:
        module = importlib.import_module(name)
        for test in doctest.DocTestFinder(exclude_empty=True).find(module, name, globs={"fakir": fakir, "np": np}):
            if test.examples:
                found[test.name] = test
    return found


EXAMPLES = examples()


def test_there_are_examples():
    assert len(EXAMPLES) > 10


@pytest.mark.parametrize("name", EXAMPLES)
def test_examples_of_docstrings(name, monkeypatch):
    monkeypatch.chdir(Path(__file__).parents[2])
    printed = []
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", fakir.FakirWarning)
        runner.run(EXAMPLES[name], out=printed.append)
    assert runner.failures == 0, "".join(printed)
