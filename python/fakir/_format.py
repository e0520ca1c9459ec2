"""Formatting of numbers and tables."""

from __future__ import annotations

import math
from collections.abc import Iterable
from html import escape
from typing import ClassVar

PREFIXES = {3: "G", 2: "M", 1: "k", 0: "", -1: "m", -2: "µ", -3: "n"}


def engineering(value: float, unit: str, digits: int = 6) -> str:
    """A value with a suitable unit prefix: ``4.44813 mN``."""
    if value == 0.0 or not math.isfinite(value) or not unit:
        return f"{value:.{digits}g} {unit}".strip()
    step = math.floor(math.log10(abs(value)) / 3 + 1e-9)
    highest = 0 if unit in {"m", "N"} else 3
    step = min(max(step, -3), highest)
    rounded = float(f"{value / 10.0 ** (3 * step):.{digits - 1}e}")
    return f"{rounded:.12g} {PREFIXES[step]}{unit}"


def known_digits(error: float) -> int:
    """Number of significant digits of a value with this relative error, one to six."""
    if not 0.0 < error < 1.0:
        return 6 if error == 0.0 else 1
    return min(max(math.ceil(-math.log10(error)), 1), 6)


def remark(error: float) -> str:
    """Remark on the error of a number, if it has one."""
    return f" (estimated error {error:.0e})" if error > 0.0 else ""


Row = tuple[str, str]


def text_table(title: str, rows: Iterable[Row]) -> str:
    """A list of names and values."""
    pairs = list(rows)
    width = max((len(name) for name, _ in pairs), default=0)
    return "\n".join([title, *(f"  {name:<{width}}  {value}" for name, value in pairs)])


def html_table(title: str, rows: Iterable[Row]) -> str:
    """A list of names and values in HTML, for a notebook."""
    cells = "".join(
        f"<tr><th style='text-align:left'>{escape(name)}</th>"
        f"<td style='text-align:left'>{escape(value)}</td></tr>"
        for name, value in rows
    )
    return f"<table><caption><b>{escape(title)}</b></caption><tbody>{cells}</tbody></table>"


class Shown:
    """A table of names and values for terminals and notebooks."""

    __slots__ = ()
    _titles: ClassVar[tuple[str, str]]
    """Titles of the table, in a terminal and in a notebook."""

    def _rows(self) -> list[Row]:
        raise NotImplementedError

    def __repr__(self) -> str:
        return text_table(self._titles[0], self._rows())

    def _repr_html_(self) -> str:
        return html_table(self._titles[1], self._rows())
