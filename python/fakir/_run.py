"""Execution options: threads, memory, progress; and warnings."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable
from typing import TypeAlias

from . import _fakir
from ._quantity import whole
from .errors import FakirWarning

Progress: TypeAlias = Callable[[str, int, int, int], object]
"""Called with the stage, its step, the number of pillars being solved and the number touched so far."""


def options(
    threads: int = 1,
    progress: Callable[..., object] | None = None,
    memory_limit: int | None = None,
    arguments: str = "stage, step, pillars, touched",
) -> _fakir.Options:
    """Validated options for the extension module; ``arguments`` are those of ``progress``."""
    warn_of_threads(threads, depth=3)
    limit = None if memory_limit is None else whole(memory_limit, "memory_limit (bytes)")
    if limit is not None and limit <= 0:
        raise ValueError(f"memory_limit is {limit}: give a number of bytes")
    if progress is not None and not callable(progress):
        raise TypeError(
            f"progress must be a function of ({arguments}), not {type(progress).__name__}"
        )
    return {"threads": int(threads), "memory_limit": limit, "progress": progress}


def warn_of_threads(threads: int, depth: int = 2) -> None:
    """Raises an error for invalid numbers of threads, and warns if there are more than processors."""
    if whole(threads, "threads") < 0:
        raise ValueError(f"threads is {threads}: give 1 or more, or 0 for all processors")
    warning = _fakir.threads_warning(threads)
    if warning is not None:
        warn([warning], depth)


def warn_of_interactions(
    case: _fakir.Case | _fakir.Flat | _fakir.Surface | _fakir.Asperities,
    question: str,
    depth: int = 2,
) -> None:
    """Warns if shear stresses are given, as the answer of ``question`` does not contain the lateral force."""
    warn(_fakir.without_interactions(case, question), depth + 1)


def warn(texts: Iterable[str], depth: int = 2) -> None:
    """Warns the caller of the package, this many stack levels up."""
    for text in texts:
        warnings.warn(text, FakirWarning, stacklevel=depth + 2)
