"""Code that the workers of a sweep run."""

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
    """Journal lines for some cases of a study, and the computing time in seconds.

    ``attempt`` distinguishes a repeated batch from the one that was lost.
    """
    parsed = _study(study)
    start = time.perf_counter()
    lines = _fakir.solve_cases(parsed, cases, memory_limit)
    return lines, time.perf_counter() - start
