"""What the workers of a sweep run, wherever they are."""

from __future__ import annotations

import time
from collections.abc import Sequence
from functools import lru_cache

from . import _fakir


@lru_cache(maxsize=4)
def _study(text: str) -> _fakir.Study:
    return _fakir.Study.parse("study", text, [])


def solve_batch(
    study: str, cases: Sequence[int], memory_limit: int | None, attempt: int
) -> tuple[list[str], float]:
    """Lines of a journal for some cases of a study, and the seconds they took.

    ``attempt`` tells a batch that is tried again from the one that was lost.
    """
    parsed = _study(study)
    start = time.perf_counter()
    lines = _fakir.solve_cases(parsed, cases, memory_limit)
    return lines, time.perf_counter() - start
