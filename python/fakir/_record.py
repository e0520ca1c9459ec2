"""Classes for the record of all numbers of contacts, critical states and cycles.

The extension module has a row for every number. Here each is an attribute, named by its path without the unit:
``smallest_floor_gap_m`` is ``smallest_floor_gap``, and ``floor.force_N`` is ``floor.force``; groups before a dot are named
tuples. The exceptions are `NAMES` and `OMITTED`.
"""

from __future__ import annotations

import re
from collections import namedtuple
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

from . import _fakir
from ._result import Answer, Number, Numbered

NAMES = {
    "relative_error_estimate": "error",
    # Among relative errors, the one that is not relative keeps its unit.
    "relative_error_estimate.indentation_m": "indentation_m",
}
"""Attributes whose name is not their path without the unit. In critical states names are without ``critical_``."""

OMITTED = {
    "transition.bottom_contact_m",
    "surface_transition.bottom_contact_m",
    "asperity_press.tops",
    "asperity_transition.tops",
    "asperity_transition.bottom_contact_m",
}
"""Entries of the JSON only: an older name, and information given by the class."""

GROUPS = {
    "certificate": "Certificate",
    "error": "ErrorEstimate",
    "error.critical_force": "CycleError",
    "error.critical_indentation": "CycleError",
    "error.pull_off_force": "CycleError",
    "error.hysteresis": "CycleError",
    "surface_cycle.error": "SurfaceCycleErrors",
    "flat_cycle.error": "FlatCycleErrors",
    "history.error": "HistoryErrors",
    "floor.error": "FloorErrors",
    "friction": "Friction",
    "friction.error": "FrictionErrors",
    "grid": "Grid",
    "normalized": "Normalized",
    "cycle.error": "CycleErrors",
    "asperity_cycle.error": "AsperityCycleErrors",
    "asperity_press.error": "AsperityErrors",
    "asperity_transition.error": "AsperityErrors",
}
"""Named tuples by kind and attribute, or by attribute; the others are named by both."""

OBJECTS = {"press.floor": "FloorNumbers", "asperity_press.floor": "FloorNumbers"}
"""Groups with more than numbers: their classes are written by hand and derived from these."""

FAMILIES = {"Contact": "press", "Critical": "transition"}
"""Base classes for the common numbers of all kinds of results whose names have this suffix."""

Numbers = Mapping[str, Any]


class Row(NamedTuple):
    """A row of the record."""

    path: str
    unit: str
    symbol: str
    meaning: str
    type: str
    optional: bool
    """Whether it can be None in an object that is present."""
    decides: bool
    """Whether the object that contains it is None without it."""


@dataclass(frozen=True)
class Field:
    """An attribute: a number, or a named tuple."""

    type: str
    optional: bool
    doc: str
    read: Callable[[Numbers], Any]

    @property
    def annotation(self) -> str:
        """Its type annotation as text."""
        return f"{self.type} | None" if self.optional else self.type


Fields = dict[str, Field]


class Record:
    """All classes that are created from the record."""

    groups: dict[str, Fields]
    """The fields of named tuples."""
    answers: dict[str, tuple[str, Fields]]
    """The base class and the own attributes of each result class."""
    tuples: dict[str, Any]
    """The named tuples, once created."""

    def __init__(self) -> None:
        self.answers, self.tuples = {}, {}
        self._found: dict[str, list[Fields]] = {}
        objects: dict[str, tuple[str, Fields]] = {}
        for kind, rows in _fakir.record():
            fields = self._fields(kind, "", [Row(*row) for row in rows])
            for attribute in [name for name in fields if f"{kind}.{name}" in OBJECTS]:
                name = OBJECTS[f"{kind}.{attribute}"]
                objects[name] = "Numbered", self._found.pop(fields.pop(attribute).type)[0]
            self.answers[_camel(f"{kind}_numbers")] = "Answer", fields
        self._share()
        self.answers = objects | self.answers
        self.groups = {name: _union(found) for name, found in self._found.items()}

    def _fields(self, kind: str, group: str, rows: list[Row]) -> Fields:
        """The attributes of a result, or of a group in it."""
        names = dict.fromkeys(row.path.removeprefix(group).partition(".")[0] for row in rows)
        fields = {}
        for name in names:
            path = group + name
            inner = [row for row in rows if row.path.startswith(f"{path}.")]
            if inner:
                fields[_attribute(kind, path)] = self._group(kind, path, inner)
            elif f"{kind}.{path}" not in OMITTED:
                row = next(row for row in rows if row.path == path)
                fields[_attribute(kind, path, row.unit)] = _field(row)
        return fields

    def _group(self, kind: str, path: str, rows: list[Row]) -> Field:
        place = ".".join(_attribute(kind, part) for part in path.split("."))
        own = f"{kind}.{place}"
        name = GROUPS.get(own) or GROUPS.get(place) or _camel(own.replace(".", "_"))
        fields = self._fields(kind, f"{path}.", rows)
        self._found.setdefault(name, []).append(fields)
        depth = path.count(".") + 1
        deciding = [row.path for row in rows if row.decides and row.path.count(".") == depth]

        def read(numbers: Numbers) -> Any:
            if any(numbers[decider] is None for decider in deciding):
                return None
            return self.tuples[name](**{key: field.read(numbers) for key, field in fields.items()})

        return Field(name, bool(deciding), f"`{name}` with {', '.join(fields)}.", read)

    def _share(self) -> None:
        """Moves the common attributes of a family to its base class."""
        for family, ending in FAMILIES.items():
            kinds = [name for name in self.answers if name.lower().endswith(f"{ending}numbers")]
            first, *others = (self.answers[name][1] for name in kinds)
            common = {
                name: field
                for name, field in first.items()
                if all(_same(field, fields.get(name)) for fields in others)
            }
            for name in kinds:
                fields = self.answers[name][1]
                own = {key: field for key, field in fields.items() if key not in common}
                self.answers[name] = family, own
            self.answers = {family: ("Answer", common)} | self.answers

    def classes(self, module: str) -> dict[str, Any]:
        """All classes by name."""
        made: dict[str, Any] = {"Answer": Answer, "Numbered": Numbered}
        for name, fields in self.groups.items():
            missing = [None for field in fields.values() if field.optional]
            self.tuples[name] = namedtuple(name, list(fields), defaults=missing, module=module)
            for key, field in fields.items():
                getattr(self.tuples[name], key).__doc__ = field.doc
        for name, (base, fields) in self.answers.items():
            members: dict[str, Any] = {key: Number(it.read, it.doc) for key, it in fields.items()}
            members |= {"__slots__": (), "__module__": module, "__doc__": made[base].__doc__}
            made[name] = type(name, (made[base],), members)
        return self.tuples | made


def _field(row: Row) -> Field:
    # The meanings contain names of numbers, which are without units too.
    meaning = re.sub(r"`(\w+?)_(m|N|J)`", r"`\1`", row.meaning.replace("`null`", "None"))
    path, (what, *remarks) = row.path, meaning.split("; ")
    symbol, unit = row.symbol and f", {row.symbol}", row.unit and f" ({row.unit})"
    doc = "; ".join([f"{what[0].upper()}{what[1:]}{symbol}{unit}", *remarks])
    return Field(row.type, row.optional, f"{doc}.", lambda numbers: numbers[path])


def _attribute(kind: str, path: str, unit: str = "") -> str:
    """The name of an attribute."""
    name = path.rpartition(".")[2]
    if path in NAMES or name in NAMES:
        return NAMES.get(path) or NAMES[name]
    if unit:
        name = name.removesuffix("_" + unit.replace("/", "_per_").replace("^", ""))
    return name.removeprefix("critical_") if kind.endswith(FAMILIES["Critical"]) else name


def _union(found: list[Fields]) -> Fields:
    """The fields of a named tuple of several kinds: fields that are missing in one of them come last, and can be None."""
    fields = {}
    for name in dict.fromkeys(name for one in found for name in one):
        known = [one[name] for one in found if name in one]
        optional = len(known) < len(found) or any(field.optional for field in known)
        fields[name] = replace(known[0], optional=optional)
    return dict(sorted(fields.items(), key=lambda item: item[1].optional))


def _same(one: Field, other: Field | None) -> bool:
    return other is not None and (one.annotation, one.doc) == (other.annotation, other.doc)


def _camel(words: str) -> str:
    return "".join(word.capitalize() for word in words.split("_"))
