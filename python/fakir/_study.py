"""Studies as files, strings and dictionaries."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from os import PathLike, fspath
from typing import Any, TypeAlias

import numpy as np

from . import _fakir
from ._quantity import WithUnit
from ._settings import Overrides, magnitude, settings
from ._system import System
from .bem import Surface

StudyLike: TypeAlias = str | PathLike[str] | Mapping[str, Any]
"""A study file, its text, or a dictionary."""


def read_study(study: StudyLike, overrides: Overrides | None) -> _fakir.Study:
    """The study, with all cases validated."""
    given = settings(overrides)
    if isinstance(study, Mapping):
        return _fakir.Study.parse("study", _to_toml(study), given)
    if isinstance(study, str) and "\n" in study:
        return _fakir.Study.parse("study.toml", study, given)
    if isinstance(study, (str, PathLike)):
        return _fakir.Study.read(fspath(study), given)
    raise TypeError(
        "a study is a path, the text of a study file, or a dictionary with the tables of one, "
        f"not {type(study).__name__}"
    )


def _to_toml(tables: Mapping[str, Any]) -> str:
    """Converts a dictionary to a study file; the value of ``"system"``, a `System` or a `Surface` of a case file, is the case."""
    texts = []
    for name, table in tables.items():
        if isinstance(table, System) and not table._has_file():
            raise TypeError(
                "a study reads listed pillars from a file: write the table by the pattern's to_csv, and give the path of "
                "a case file with it, by to_toml"
            )
        if isinstance(table, (System, Surface)):
            texts.append(table.to_toml())
            continue
        if not isinstance(table, Mapping):
            raise TypeError(
                f"{name} is of type {type(table).__name__}: a study is made of dictionaries, such "
                'as {"system": system, "axes": {"surface_fraction": [0.01, 0.1]}}'
            )
        lines = [f"{_key(key)} = {_value(value, key)}" for key, value in table.items()]
        texts.append("\n".join([f"[{name}]", *lines]))
    # A case contains tables and therefore comes last.
    texts.sort(key=lambda text: text.lstrip().startswith("#"))
    return "\n\n".join(texts) + "\n"


def _key(key: object) -> str:
    return '"' + str(key).replace("\\", "\\\\").replace('"', '\\"') + '"'


def _value(value: Any, name: object) -> str:
    if isinstance(value, WithUnit) and np.ndim(value.magnitude) == 0:
        value = magnitude(value, str(name))
    elif isinstance(value, WithUnit):
        value = [magnitude(item, str(name)) for item in value]  # type: ignore[attr-defined]
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return _key(value)
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, Mapping):
        # The values of an axis, as its ends, have the unit of its key.
        items = (f"{_key(key)} = {_value(item, name)}" for key, item in value.items())
        return "{ " + ", ".join(items) + " }"
    if isinstance(value, Sequence):
        return "[" + ", ".join(_value(item, name) for item in value) + "]"
    raise TypeError(f"{name} is of type {type(value).__name__}: give numbers, texts or lists of them")
