"""Sweeps of the package: on any executor the same table as the command line's, byte for byte."""

import functools
import json
import os
import signal
import subprocess
import threading
import time
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool

import numpy as np
import pytest

import fakir

STUDY = """
[axes]
surface_fraction = { from = 0.002, to = 0.05, points = 5, spacing = "log" }
"pattern.offset" = { from = 0, to = 0.5, points = 4 }

[lens]
radius = "2200 um"
young_modulus = "2 MPa"
poisson_ratio = 0.5

[substrate]
young_modulus = "2 MPa"
poisson_ratio = 0.5

[pattern.pillar]
diameter = "6 um"
height = "2.2 um"
"""
CASES = 20

LARGE = STUDY.replace("points = 5", "points = 20").replace("points = 4", "points = 10")
"""200 cases."""


def by_program(folder, study):
    """The table by the command line."""
    path = folder / "study.toml"
    path.write_text(study)
    program = os.environ["FAKIR"]
    arguments = ["sweep", str(path), "--output", str(folder / "out"), "--quiet"]
    subprocess.run([program, *arguments], check=True, stdout=subprocess.DEVNULL)
    return (folder / "out" / "table.csv").read_text()


@pytest.fixture(scope="module")
def table(tmp_path_factory):
    return by_program(tmp_path_factory.mktemp("sweep"), STUDY)


def test_all_processors_and_executors_give_the_table_of_the_program(table, tmp_path):
    assert fakir.sweep(STUDY).to_csv() == table
    with ThreadPoolExecutor(2) as executor:
        done = fakir.sweep(STUDY, executor, tmp_path / "threads")
    assert done.to_csv() == table
    assert (tmp_path / "threads" / "table.csv").read_text() == table
    with ProcessPoolExecutor(2) as executor:
        assert fakir.sweep(STUDY, executor).to_csv() == table
    journal = (tmp_path / "threads" / "journal.jsonl").read_text().splitlines()
    assert len(journal) == 1 + CASES
    # The program continues from the journal of the package, and has nothing to do.
    program = os.environ["FAKIR"]
    study = tmp_path / "study.toml"
    study.write_text(STUDY)
    resume = ["sweep", str(study), "--output", str(tmp_path / "threads"), "--resume", "--quiet"]
    subprocess.run([program, *resume], check=True, stdout=subprocess.DEVNULL)
    assert (tmp_path / "threads" / "table.csv").read_text() == table


def test_studies_as_dictionaries_and_files(table, tmp_path):
    system = fakir.System(
        fakir.Lens("2200 um", "2 MPa", 0.5),
        fakir.Substrate("2 MPa", 0.5),
        fakir.HexagonalPattern("6 um", "2.2 um", surface_fraction=0.1),
    )
    axes = {
        "surface_fraction": {"from": 0.002, "to": 0.05, "points": 5, "spacing": "log"},
        "pattern.offset": {"from": 0, "to": 0.5, "points": 4},
    }
    assert fakir.sweep({"system": system, "axes": axes}).to_csv() == table
    path = tmp_path / "study.toml"
    path.write_text(STUDY)
    assert fakir.sweep(path).to_csv() == table
    lists = {"system": system, "axes": {"pitch": np.array([20e-6, 30e-6])}}
    assert len(fakir.sweep(lists, overrides={"pattern.pillar.height": "2 um"})) == 2


def test_the_table_as_pandas_xarray_and_rows():
    done = fakir.sweep(STUDY)
    frame = done.to_pandas()
    assert len(frame) == len(done) == CASES
    data = done.to_xarray()
    assert dict(data.sizes) == {"pattern.surface_fraction": 5, "pattern.offset": 4}
    assert data.critical_force_N.attrs["units"] == "N"
    row = done.rows[7]  # the last axis varies fastest
    at = data.isel({"pattern.surface_fraction": 1, "pattern.offset": 3})
    assert float(at.critical_force_N) == row["critical_force_N"] == frame.critical_force_N[7]
    assert done.failed == []
    zipped = '[study]\ncombine = "zip"\n' + STUDY.replace("points = 4", "points = 5")
    assert dict(fakir.sweep(zipped).to_xarray().sizes) == {"case": 5}


def test_progress_stays_here_and_stops_the_sweep(tmp_path):
    news = []
    with ProcessPoolExecutor(1) as executor:
        # A closure over a lock cannot be pickled, and need not be.
        lock = threading.Lock()
        fakir.sweep(STUDY, executor, progress=lambda *a: (lock, news.append(a)))
    assert news[-1] == (CASES, 0, 0, CASES)

    def refuse(*_):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        fakir.sweep(STUDY, output=tmp_path / "out", progress=refuse)
    with ThreadPoolExecutor(1) as executor, pytest.raises(RuntimeError, match="enough"):
        fakir.sweep(STUDY, executor, tmp_path / "pool", progress=refuse)
    done = fakir.sweep(STUDY, output=tmp_path / "pool", resume=True)
    assert len(done.rows) == CASES


def test_folders_are_not_overwritten(tmp_path):
    (tmp_path / "something").touch()
    with pytest.raises(fakir.StudyError, match="not empty"):
        fakir.sweep(STUDY, output=tmp_path)
    with pytest.raises(TypeError, match="exclude each other"):
        fakir.sweep(STUDY, output=tmp_path, resume=True, overwrite=True)
    with pytest.raises(TypeError, match="need output"):
        fakir.sweep(STUDY, resume=True)


def test_overwriting_replaces_results_and_nothing_else(table, tmp_path):
    folder = tmp_path / "out"
    case = fakir.System.from_toml(STUDY.split("[lens]")[1].join(["[lens]", "[pattern]\npitch = 2e-5\n"]))
    program = os.environ["FAKIR"]
    (tmp_path / "case.toml").write_text(case.to_toml())
    theory = [program, "theory", str(tmp_path / "case.toml"), "--output", str(folder), "--quiet"]
    subprocess.run(theory, check=True, stdout=subprocess.DEVNULL)
    with pytest.raises(fakir.StudyError, match="not empty"):
        fakir.sweep(STUDY, output=folder)
    assert fakir.sweep(STUDY, output=folder, overwrite=True).to_csv() == table
    assert not (folder / "summary.json").exists()
    (folder / "notes.txt").write_text("mine")
    with pytest.raises(fakir.StudyError, match=r"notes\.txt is not among the files"):
        fakir.sweep(STUDY, output=folder, overwrite=True)
    assert (folder / "table.csv").read_text() == table


def test_a_damaged_line_is_named_and_its_case_computed_again(table, tmp_path):
    fakir.sweep(STUDY, output=tmp_path / "out")
    journal = tmp_path / "out" / "journal.jsonl"
    lines = journal.read_text().splitlines(keepends=True)
    lines[4] = lines[4].replace("top_first", "bottom_first")
    journal.write_text("".join(lines))
    with pytest.warns(fakir.FakirWarning, match=r"journal\.jsonl:5: this line is damaged") as news:
        done = fakir.sweep(STUDY, output=tmp_path / "out", resume=True)
    assert len(news) == 1 and news[0].filename == __file__
    assert done.found == CASES - 1
    assert done.to_csv() == table


def test_a_key_without_effect_is_named():
    angle = '"pattern.offset_angle" = ["10 deg", "20 deg"]'
    study = STUDY.replace('"pattern.offset" = { from = 0, to = 0.5, points = 4 }', angle)
    with pytest.warns(fakir.FakirWarning, match="pattern.offset_angle has no effect: the lens axis"):
        assert len(fakir.sweep(study)) == 10


def test_what_is_no_study_or_no_executor():
    with pytest.raises(fakir.CaseError, match=r"axes"):
        fakir.sweep(STUDY.replace("surface_fraction =", "surface_friction ="))
    with pytest.raises(fakir.CaseError, match="cannot read"):
        fakir.sweep("no-such-study.toml")
    with pytest.raises(TypeError, match="a study is a path"):
        fakir.sweep(3)
    with pytest.raises(TypeError, match="a study is made of dictionaries"):
        fakir.sweep({"axes": 3})
    with pytest.raises(TypeError, match="executor is of type int"):
        fakir.sweep(STUDY, 3)


class Dying(Executor):
    """A pool whose worker dies after some batches."""

    def __init__(self, batches):
        self.batches = batches
        self._max_workers = 1

    def submit(self, function, /, *arguments, **options):
        future = Future()
        if self.batches == 0:
            future.set_exception(BrokenProcessPool("a child process terminated abruptly"))
        else:
            self.batches -= 1
            future.set_result(function(*arguments, **options))
        return future


def test_a_broken_pool_loses_nothing_that_was_answered(table, tmp_path):
    folder = tmp_path / "out"
    with pytest.raises(fakir.WorkersLost, match="resume=True") as error:
        fakir.sweep(STUDY, Dying(2), folder)
    assert "Dying cannot be used any more" in str(error.value)
    kept = len((folder / "journal.jsonl").read_text().splitlines()) - 1
    assert 0 < kept < CASES
    news = []
    done = fakir.sweep(STUDY, Dying(-1), folder, resume=True, progress=lambda *a: news.append(a))
    assert done.found == kept == news[-1][1]
    assert done.to_csv() == table


def test_broken_pools_are_replaced_as_long_as_it_helps(table, tmp_path):
    pools = iter([Dying(1), Dying(0), Dying(-1)])
    assert fakir.sweep(STUDY, lambda: next(pools)).to_csv() == table
    with pytest.raises(fakir.WorkersLost, match="are lost: with an output folder"):
        fakir.sweep(STUDY, functools.partial(Dying, 0))


class KilledWorker(Exception):
    """As Dask calls it."""


class Losing(Dying):
    """Loses the first attempts of every batch."""

    def __init__(self, attempts):
        super().__init__(-1)
        self.attempts = attempts

    def submit(self, function, /, *arguments, **options):
        if arguments[-1] >= self.attempts:
            return super().submit(function, *arguments, **options)
        future = Future()
        future.set_exception(KilledWorker("the worker died"))
        return future


def test_lost_batches_are_tried_three_times_more(table):
    assert fakir.sweep(STUDY, Losing(3)).to_csv() == table
    with pytest.raises(fakir.WorkersLost, match="lost 4 times"):
        fakir.sweep(STUDY, Losing(4))


def kill_one(cluster, folder):
    """Kills a worker as soon as there is something in the journal."""
    journal = folder / "journal.jsonl"
    while not journal.exists() or len(journal.read_text().splitlines()) < 20:
        time.sleep(0.02)
    worker = next(iter(cluster.workers.values()))
    os.kill(worker.process.pid, signal.SIGKILL)


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no SIGKILL here")
def test_dask_with_a_worker_killed_gives_the_serial_table(tmp_path):
    distributed = pytest.importorskip("distributed")
    serial = fakir.sweep(LARGE, threads=1).to_csv()
    folder = tmp_path / "out"
    options = {"n_workers": 2, "threads_per_worker": 1, "processes": True}
    with (
        distributed.LocalCluster(**options, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        killer = threading.Thread(target=kill_one, args=(cluster, folder))
        killer.start()
        done = fakir.sweep(LARGE, client.get_executor(), folder)
        killer.join()
    assert len(done) == 200
    assert done.to_csv() == serial
    assert (folder / "table.csv").read_text() == serial
    answers = [json.loads(line) for line in (folder / "journal.jsonl").read_text().splitlines()[1:]]
    assert sorted(answer["case"] for answer in answers) == list(range(200))
