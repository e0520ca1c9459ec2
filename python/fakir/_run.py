"""How computations are run: threads, memory, progress; and what is done about their warnings."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable
from typing import TypeAlias

from . import _fakir
from .errors import FakirWarning

Progress: TypeAlias = Callable[[str, int, int, int], object]
"""Called with the stage, the step in it, the pillars being solved and those touched so far."""


def options(
    threads: int = 1,
    progress: Progress | None = None,
    memory_limit: int | None = None,
) -> _fakir.Options:
    """Checked options for the extension module."""
    warn_of_threads(threads, depth=3)
    if memory_limit is not None and memory_limit <= 0:
        raise ValueError(f"memory_limit is {memory_limit}: give a number of bytes")
    if progress is not None and not callable(progress):
        raise TypeError(
            "progress must be a function of (stage, step, pillars, touched), "
            f"not {type(progress).__name__}"
        )
    limit = None if memory_limit is None else int(memory_limit)
    return {"threads": threads, "memory_limit": limit, "progress": progress}


def warn_of_threads(threads: int, depth: int = 2) -> None:
    """Refuses numbers that cannot be, and warns of more than there are processors."""
    if threads < 0:
        raise ValueError(f"threads is {threads}: give 1 or more, or 0 for all processors")
    warning = _fakir.threads_warning(threads)
    if warning is not None:
        warn([warning], depth)


def warn(texts: Iterable[str], depth: int = 2) -> None:
    """Warns the caller of the package, who is this many calls up."""
    for text in texts:
        warnings.warn(text, FakirWarning, stacklevel=depth + 2)
