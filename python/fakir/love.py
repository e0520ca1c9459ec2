"""Deprecated name of `fakir.bem`."""

import warnings
from typing import Any

from . import bem

__all__ = bem.__all__


def __getattr__(name: str) -> Any:
    """Looks up a name in `fakir.bem`."""
    found = getattr(bem, name)
    warnings.warn("fakir.love is now called fakir.bem", FutureWarning, stacklevel=2)
    return found
