"""Overrides of keys, and loads."""

from __future__ import annotations

import warnings
from collections.abc import Mapping

import numpy as np

from . import _fakir
from ._quantity import Quantity, WithUnit, si

Overrides = Mapping[str, Quantity]

SEED = _fakir.sampling_seed()
"""Default seed of random samples."""


def load(
    indentation: Quantity | None, force: Quantity | None
) -> tuple[float | None, float | None]:
    """The given one of both, in SI units."""
    if (indentation is None) == (force is None):
        raise TypeError("give exactly one of indentation and force")
    if indentation is not None:
        return si(indentation, "length", "indentation"), None
    assert force is not None
    return None, si(force, "force", "force")


def load_or_critical(
    indentation: Quantity | None, force: Quantity | None
) -> tuple[float | None, float | None]:
    """As :func:`load`; the critical state if neither is given."""
    return (None, None) if indentation is None and force is None else load(indentation, force)


def overrides_of(overrides: Overrides | None, former: Overrides | None) -> Overrides | None:
    """Overrides that may be given by the deprecated name ``set``, with a warning."""
    if former is None:
        return overrides
    if overrides is not None:
        raise TypeError("set is the older name of overrides: give only overrides")
    warnings.warn("set is now called overrides", FutureWarning, stacklevel=3)
    return former


def settings(overrides: Overrides | None) -> list[str]:
    """Overrides as arguments of ``--set``."""
    return [f"{key}={_written(key, value)}" for key, value in (overrides or {}).items()]


def magnitude(value: WithUnit, key: str) -> float:
    """The number of a quantity in the SI unit of a key of a case; what is no key, as a setting of a study, has the base units of its registry."""
    try:
        dimension = _fakir.dimension(key)
    except ValueError:
        return float(value.to_base_units().magnitude)  # type: ignore[attr-defined]
    return si(value, dimension, key)


def _written(key: str, value: Quantity) -> str:
    if isinstance(value, str):
        return value
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, WithUnit):
        return repr(magnitude(value, key))
    return repr(value.item() if hasattr(value, "item") else value)
