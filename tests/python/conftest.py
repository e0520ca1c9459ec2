"""The built program, run in a separate folder; its path is in the environment variable FAKIR."""

import json
import os
import subprocess
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.fixture(scope="session")
def fakir(tmp_path_factory):
    """Runs a command with `--output` and returns the folder and the summary."""
    program = os.environ["FAKIR"]

    def run(command, example, *arguments):
        folder = tmp_path_factory.mktemp(command)
        case = str(EXAMPLES / example)
        subprocess.run(
            [program, command, case, *arguments, "--output", str(folder)],
            check=True,
            stdout=subprocess.DEVNULL,
        )
        return folder, json.loads((folder / "summary.json").read_text())

    return run


@pytest.fixture(scope="session")
def critical(fakir):
    """The critical state of the paper's intermediate substrate with 13 pillars in contact."""
    return fakir(
        "transition",
        "paper-intermediate.toml",
        "--set",
        "pattern.surface_fraction=0.01",
        "--field-points",
        "1001",
    )


@pytest.fixture(scope="session")
def surface(fakir):
    """Square pillars, with boundary elements."""
    coarse = ["--set", "surface.grid.cells_per_diameter=8"]
    return fakir("press", "square-pillars.toml", "--indentation", "3um", *coarse)
