"""Sweeps: every case of a study, on this machine or on any executor."""

from __future__ import annotations

import math
import os
import time
from collections import deque
from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Executor, Future, wait
from contextlib import closing
from dataclasses import dataclass
from os import PathLike, fspath
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from . import _fakir
from ._format import Row, html_table, text_table
from ._run import warn, warn_of_threads
from ._settings import Overrides, overrides_of
from ._study import StudyLike, read_study
from ._worker import solve_batch
from .errors import WorkersLost

if TYPE_CHECKING:
    import pandas
    import xarray

SweepProgress: TypeAlias = Callable[[int, int, int, int], object]
"""Called with the number of cases done, found in the journal, failed, and in total."""

BATCH_SECONDS = 1.0
"""Target duration of a batch of cases, s: long compared to its transfer to a worker, short compared to the sweep."""

GROWTH = 4
"""Largest growth factor of the number of cases from batch to batch, because costs are unknown at first."""

ATTEMPTS = 3
"""Number of times that a batch is sent again after its worker was lost."""

LOST = {"KilledWorker", "CommClosedError", "TimeoutError"}
"""Exceptions of Dask that mean that the worker was lost, not that the batch is invalid."""

UNITS = {"_m": "m", "_N": "N", "_Pa": "Pa", "_rad": "rad"}


class Sweep:
    """The table of a sweep: a row for every case."""

    def __init__(
        self, study: _fakir.Study, columns: list[tuple[str, Any]], csv: str, found: int
    ) -> None:
        self._study, self._columns, self._csv, self._found = study, dict(columns), csv, found

    @property
    def found(self) -> int:
        """Number of cases found in the journal at the start."""
        return self._found

    @property
    def axes(self) -> list[str]:
        """The columns that are axes."""
        return [name for name, _, _ in self._study.axes()]

    @property
    def rows(self) -> list[dict[str, Any]]:
        """A dictionary for every case; missing results are None."""
        columns = {name: _values(values) for name, values in self._columns.items()}
        return [dict(zip(columns, row)) for row in zip(*columns.values())]

    @property
    def failed(self) -> list[dict[str, Any]]:
        """The rows without a reliable result; ``problem`` gives the reason."""
        return [row for row in self.rows if row["problem"]]

    def __len__(self) -> int:
        return self._study.cases

    def to_csv(self) -> str:
        """The table as in ``table.csv`` of the command line, byte for byte."""
        return self._csv

    def to_pandas(self) -> pandas.DataFrame:
        """The table, one row for every case."""
        import pandas

        return pandas.DataFrame(self._columns).set_index("case")

    def to_xarray(self) -> xarray.Dataset:
        """The table with the axes as dimensions; with ``combine = "zip"`` by case.

        Names are those of the columns, units are in the attributes.
        """
        import xarray

        axes = self._study.axes()
        columns = {name: values for name, values in self._columns.items() if name != "case"}
        if self._study.is_product:
            dimensions = tuple(name for name, _, _ in axes)
            shape = tuple(len(values) for _, _, values in axes)
            coordinates = {name: (name, values, _units(name)) for name, _, values in axes}
        else:
            dimensions, shape = ("case",), (len(self),)
            coordinates = {"case": ("case", list(range(len(self))), {})}
            for name, _, values in axes:
                coordinates[name] = ("case", values, _units(name))
        along = {name for name, _, _ in axes}
        variables = {
            name: (dimensions, _array(values).reshape(shape), _units(name))
            for name, values in columns.items()
            if name not in along
        }
        attributes = {
            "title": f"Lens on a surface: {self._study.question}, {len(self)} cases",
            "source": f"fakir {_fakir.__version__}",
            "study": self._study.to_toml(),
        }
        return xarray.Dataset(variables, coordinates, attributes)

    def _rows(self) -> list[Row]:
        axes = [
            (name, f"{len(values)} values, {values[0]} to {values[-1]}")
            for name, _, values in self._study.axes()
        ]
        failed = len(self.failed)
        return [*axes, ("cases", f"{len(self)}, {failed} without an answer to be relied on")]

    def __repr__(self) -> str:
        return text_table(f"fakir.Sweep: {self._study.question}", self._rows())

    def _repr_html_(self) -> str:
        return html_table(f"Sweep: {self._study.question}", self._rows())


def sweep(
    study: StudyLike,
    executor: Executor | Callable[[], Executor] | None = None,
    output: str | PathLike[str] | None = None,
    *,
    overrides: Overrides | None = None,
    resume: bool = False,
    overwrite: bool = False,
    threads: int = 0,
    progress: SweepProgress | None = None,
    memory_limit: int | None = None,
    set: Overrides | None = None,
) -> Sweep:
    """Computes every case of a study.

    Parameters
    ----------
    study
        A study file, its text, or a dictionary of its tables, in which a `System`, or a `fakir.bem.Surface` of a case file, can
        be the case: ``{"system": system, "axes": {"surface_fraction": [0.01, 0.1]}}``. Critical states are computed unless
        ``"study": {"question": "press"}``, ``"cycle"``, ``"collapse"`` or ``"hold"`` is given.
    executor
        Executor of the cases: any executor of ``concurrent.futures`` (threads, processes, ``mpi4py.futures``) or of Dask
        (``client.get_executor()``). A function that creates one, such as ``functools.partial(ProcessPoolExecutor, 4)``, is called
        again when its workers are lost. Without it, all processors of this machine are used.
    output
        A folder for table and journal, as for ``fakir sweep --output``.
    overrides
        Values of keys of the case, as ``--set`` of the command line; ``set`` is its deprecated name.
    resume, overwrite
        Continue the sweep in ``output``, or start again there. A damaged line of its journal is reported in a `FakirWarning`, and
        its case is computed again.
    threads
        Number of threads without an executor; 0 for all processors, which is the maximum.
    progress
        Called in this process with the number of cases done, found before, failed, and in total. It need not be picklable.
    memory_limit
        Memory limit of a case in bytes; 8 GB if not given.

    Returns
    -------
    Sweep
        The table, which does not depend on the executor.

    Raises
    ------
    WorkersLost
        If workers are lost repeatedly. The journal contains every result obtained before.
    """
    if resume and overwrite:
        raise TypeError("resume and overwrite exclude each other")
    if (resume or overwrite) and output is None:
        raise TypeError("resume and overwrite need output: the folder of the sweep")
    if progress is not None and not callable(progress):
        raise TypeError("progress must be a function of (done, found, failed, cases)")
    if executor is not None and not callable(executor) and not isinstance(executor, Executor):
        raise TypeError(
            f"executor is of type {type(executor).__name__}: give one of concurrent.futures, a "
            "function that makes one, or client.get_executor() of a Dask client"
        )
    warn_of_threads(threads)
    parsed = read_study(study, overrides_of(overrides, set))
    warn(parsed.without_effect, depth=1)
    existing = "resume" if resume else "overwrite" if overwrite else "refuse"
    folder = None if output is None else fspath(output)
    with closing(_fakir.Ledger(parsed, folder, existing, memory_limit)) as ledger:
        warn((f"{line}; its case is computed again" for line in ledger.damaged), depth=1)
        if executor is None:
            ledger.run(threads, progress)
        else:
            kept = folder is not None
            _Shipping(parsed, ledger, executor, memory_limit, progress, kept).run()
        found = ledger.found
        columns, csv = ledger.finish()
    return Sweep(parsed, columns, csv, found)


@dataclass
class _Batch:
    """Cases that are sent together."""

    groups: list[list[int]]
    attempt: int = 0

    @property
    def cases(self) -> list[int]:
        return [case for group in self.groups for case in group]


_Result: TypeAlias = tuple[list[str], float]


class _Shipping:
    """Batches sent to an executor, and their results for the ledger."""

    def __init__(
        self,
        study: _fakir.Study,
        ledger: _fakir.Ledger,
        executor: Executor | Callable[[], Executor],
        memory_limit: int | None,
        progress: SweepProgress | None,
        kept: bool,
    ) -> None:
        self.text, self.cases, self.ledger = study.to_toml(), study.cases, ledger
        self.memory_limit, self.progress, self.kept = memory_limit, progress, kept
        self.make = None if isinstance(executor, Executor) else executor
        self.executor = executor if isinstance(executor, Executor) else executor()
        self.workers = _workers(self.executor)
        self.waiting = deque(ledger.remaining())
        self.lost: list[_Batch] = []
        self.pending: dict[Future[_Result], _Batch] = {}
        self.seconds_per_case: float | None = None
        self.largest = 0
        self.breaks = 0
        self.reported = 0.0

    def run(self) -> None:
        """Sends everything, and waits for the results."""
        try:
            while self.waiting or self.lost or self.pending:
                self.ship()
                done, _ = wait(self.pending, timeout=0.1, return_when=FIRST_COMPLETED)
                self.collect(done)
                self.report()
            self.report(last=True)
        finally:
            for future in self.pending:
                future.cancel()
            if self.make is not None:
                self.executor.shutdown(wait=False, cancel_futures=True)

    def ship(self) -> None:
        """Sends batches until every worker has one and one more is waiting."""
        while len(self.pending) < 2 * self.workers and (self.lost or self.waiting):
            batch = self.lost.pop() if self.lost else self.next_batch()
            try:
                future = self.executor.submit(
                    solve_batch, self.text, batch.cases, self.memory_limit, batch.attempt
                )
            except BrokenExecutor as error:
                self.lost.append(batch)
                self.broke(error)
                return
            self.pending[future] = batch

    def next_batch(self) -> _Batch:
        """The next cases that together take about `BATCH_SECONDS`."""
        required = 1
        if self.seconds_per_case is not None:
            left = sum(len(group) for group in self.waiting)
            required = min(
                math.ceil(BATCH_SECONDS / max(self.seconds_per_case, 1e-6)),
                GROWTH * self.largest,
                # The last batches should end at about the same time.
                math.ceil(left / (2 * self.workers)),
            )
        groups = [self.waiting.popleft()]
        while self.waiting and sum(len(group) for group in groups) < required:
            groups.append(self.waiting.popleft())
        return _Batch(groups)

    def collect(self, done: set[Future[_Result]]) -> None:
        """Adds results to the ledger, and puts lost batches back into the queue."""
        broken: BrokenExecutor | None = None
        wrong: BaseException | None = None
        lines: list[str] = []
        for future in done:
            batch = self.pending.pop(future)
            try:
                answers, seconds = future.result()
            except BrokenExecutor as error:
                self.lost.append(batch)
                broken = error
            except CancelledError as error:
                wrong = WorkersLost(f"the executor was shut down; {self.kept_words()}")
                wrong.__cause__ = error
            except Exception as error:
                if type(error).__name__ in LOST and batch.attempt < ATTEMPTS:
                    self.lost.append(_Batch(batch.groups, batch.attempt + 1))
                elif type(error).__name__ in LOST:
                    words = f"the workers of a batch were lost {ATTEMPTS + 1} times ({error})"
                    wrong = WorkersLost(f"{words}; {self.kept_words()}")
                    wrong.__cause__ = error
                else:
                    wrong = error
            else:
                lines += answers
                self.learn(len(answers), seconds)
        # Available results are added to the ledger before an exception is raised.
        if lines:
            self.ledger.append(lines)
        if wrong is not None:
            raise wrong
        if broken is not None:
            self.broke(broken)

    def learn(self, cases: int, seconds: float) -> None:
        """Updates the estimate of the time per case. Recent batches have a larger weight."""
        cost = seconds / cases
        known = self.seconds_per_case
        self.seconds_per_case = cost if known is None else 0.5 * (known + cost)
        self.largest = max(self.largest, cases)

    def broke(self, error: BrokenExecutor) -> None:
        """Replaces an executor that can no longer be used, if a new one can be created."""
        # All of its batches will fail, but some of them may have completed before.
        rest = set(self.pending)
        wait(rest, timeout=5.0)
        finished = {future for future in rest if future.done()}
        for future in rest - finished:
            self.lost.append(self.pending.pop(future))
        lines = []
        for future in finished:
            batch = self.pending.pop(future)
            if future.cancelled() or future.exception() is not None:
                self.lost.append(batch)
            else:
                lines += future.result()[0]
        if lines:
            self.ledger.append(lines)
        self.breaks += 1
        if self.make is None:
            raise WorkersLost(
                f"a worker died and its {type(self.executor).__name__} cannot be used any more; "
                f"{self.kept_words()}; give a function that makes executors in place of an executor "
                "to have them replaced"
            ) from error
        if self.breaks > ATTEMPTS:
            raise WorkersLost(
                f"workers died with {self.breaks} executors, one after the other; "
                f"{self.kept_words()}"
            ) from error
        self.executor.shutdown(wait=False, cancel_futures=True)
        self.executor = self.make()

    def kept_words(self) -> str:
        """Message with the number of cases that are done and kept."""
        done = self.ledger.done
        if self.kept:
            return f"{done} of {self.cases} cases are in the journal: go on with resume=True"
        return (
            f"{done} of {self.cases} cases had been answered, and are lost: with an output folder they "
            "would have been kept"
        )

    def report(self, last: bool = False) -> None:
        """Reports the progress, at most 20 times a second."""
        now = time.monotonic()
        if self.progress is not None and (last or now - self.reported > 0.05):
            self.reported = now
            ledger = self.ledger
            self.progress(ledger.done, ledger.found, ledger.failed, self.cases)


def _workers(executor: Executor) -> int:
    """Number of cases that an executor computes at the same time, if available."""
    client = getattr(executor, "_client", None)
    if client is not None:
        return max(1, int(sum(client.nthreads().values())))
    for name in ["_max_workers", "num_workers"]:
        workers = getattr(executor, name, None)
        if isinstance(workers, int) and workers > 0:
            return workers
    return os.cpu_count() or 1


def _units(name: str) -> dict[str, str]:
    unit = next((unit for suffix, unit in UNITS.items() if name.endswith(suffix)), None)
    return {} if unit is None else {"units": unit}


def _values(values: Any) -> list[Any]:
    if isinstance(values, np.ndarray):
        return [None if math.isnan(value) else value for value in values.tolist()]
    return list(values)


def _array(values: Any) -> Any:
    """An array; integers and flags with missing values become numbers with NaN."""
    if isinstance(values, np.ndarray):
        return values
    if any(value is None for value in values):
        if all(value is None or isinstance(value, (int, bool)) for value in values):
            return np.array([math.nan if value is None else value for value in values])
        return np.array(["" if value is None else value for value in values])
    return np.array(values)
