"""The table of a sweep, as pandas reads it."""

import json
import os
import subprocess

import numpy as np
import pandas
import pytest

STUDY = """
[study]
case = "{case}"
[axes]
"pattern.offset" = [0, 0.5]
surface_fraction = {{ from = 1e-3, to = 1e-2, points = 5, spacing = "log" }}
"""


@pytest.fixture(scope="module")
def swept(tmp_path_factory):
    """The folder of a sweep of ten cases."""
    from conftest import EXAMPLES

    folder = tmp_path_factory.mktemp("sweep")
    study = folder / "study.toml"
    study.write_text(STUDY.format(case=EXAMPLES / "paper-intermediate.toml"))
    output = folder / "results"
    command = [os.environ["FAKIR"], "sweep", str(study), "--output", str(output)]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return output


def test_pandas_reads_the_table_and_converts_it_to_parquet(swept, tmp_path):
    csv = pandas.read_csv(swept / "table.csv")
    csv.to_parquet(tmp_path / "table.parquet")
    parquet = pandas.read_parquet(tmp_path / "table.parquet")
    assert len(csv) == 10
    assert list(csv.columns) == list(parquet.columns)
    for name in csv.columns.drop("problem"):  # empty: no numbers
        if csv[name].dtype == float:
            assert np.array_equal(csv[name], parquet[name], equal_nan=True), name
    assert csv.converged.all() and parquet.converged.all()
    assert np.allclose(csv["pattern.surface_fraction"], csv["surface_fraction"], rtol=1e-12)


def test_a_sweep_saves_no_other_table_and_its_provenance(swept):
    provenance = json.loads((swept / "provenance.json").read_text())
    assert provenance["reference_doi"] == "10.1103/PhysRevE.104.055007"
    figures = ["critical-states.svg", "critical-states.png"]
    assert provenance["files"] == ["journal.jsonl", "study.toml", "table.csv", *figures]
    assert not (swept / "table.parquet").exists()
