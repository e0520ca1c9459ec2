"""What the floor between the pillars bears."""

from __future__ import annotations

import copy
from typing import Any, NamedTuple

from ._format import Row, engineering, html_table, known_digits, remark, text_table
from ._quantity import FloatArray


class FloorErrors(NamedTuple):
    """Estimated relative errors of what the floor bears (not of the model)."""

    share: float
    """Of the force on the floor, and so of its share."""
    contact_area: float
    """Of the area in contact."""


class FloorContact:
    """The contact with the floor between the pillars. Numbers are in SI units.

    Its pressure is constant on the cells of a grid that is aligned with the lattice, and turned with it:
    ``x``, ``y`` and ``pressure`` are arrays with a number for every cell in contact.
    """

    __slots__ = ("_summary", "pressure", "x", "y")

    x: FloatArray
    """Centres of the cells in contact along x, m from the lens axis."""
    y: FloatArray
    """Centres of the cells in contact along y, m from the lens axis."""
    pressure: FloatArray
    """Pressure on the cells in contact, Pa."""

    def __init__(self, summary: dict[str, Any], cells: list[FloatArray]) -> None:
        self._summary = summary
        self.x, self.y, self.pressure = cells
        for array in cells:
            array.flags.writeable = False

    @property
    def force(self) -> float:
        """Normal force on the floor, N."""
        return float(self._summary["force_N"])

    @property
    def share(self) -> float:
        """That force over the whole one."""
        return float(self._summary["share"])

    @property
    def contact_area(self) -> float:
        """Area in contact, m^2: of the cells, less what those along its border count too much."""
        return float(self._summary["contact_area_m2"])

    @property
    def radius(self) -> float:
        """Distance of the farthest contact with the floor from the lens axis, m."""
        return float(self._summary["radius_m"])

    @property
    def smallest_distance_to_rim(self) -> float:
        """Smallest distance between a contact with the floor and the rim of a pillar, m."""
        return float(self._summary["smallest_distance_to_rim_m"])

    @property
    def patches(self) -> int | None:
        """Number of separate patches; None where two grids differ, so that it is not known."""
        patches = self._summary["patches"]
        return None if patches is None else int(patches)

    @property
    def cell(self) -> tuple[float, float]:
        """Sides of a cell along x and y, before a lattice is turned, m."""
        width, height = self._summary["cell_m"]
        return float(width), float(height)

    @property
    def error(self) -> FloorErrors:
        """Estimated relative errors of share and contact area."""
        return FloorErrors(**self._summary["relative_error_estimate"])

    def to_dict(self) -> dict[str, Any]:
        """The object ``floor`` that ``fakir press --json`` prints: same names, same numbers."""
        return copy.deepcopy(self._summary)

    def _share_rows(self) -> list[Row]:
        error = self.error.share
        digits = known_digits(error)
        return [
            ("force on the floor", engineering(self.force, "N", digits) + remark(error)),
            ("share of the floor", f"{self.share:.{digits}g}"),
        ]

    def _rows(self) -> list[Row]:
        error = self.error
        area = known_digits(error.contact_area)
        patches = "not known: two grids differ" if self.patches is None else str(self.patches)
        width, height = (engineering(side, "m", 3) for side in self.cell)
        return [
            *self._share_rows(),
            (
                "contact area on the floor",
                f"{1e12 * self.contact_area:.{area}g} µm^2" + remark(error.contact_area),
            ),
            ("radius of the floor contact", engineering(self.radius, "m", 4)),
            ("its distance from a rim", engineering(self.smallest_distance_to_rim, "m", 4)),
            ("patches on the floor", patches),
            ("cells in contact", f"{len(self.pressure)}, each of {width} by {height}"),
        ]

    def __repr__(self) -> str:
        return text_table("fakir.FloorContact", self._rows())

    def _repr_html_(self) -> str:
        return html_table("Contact with the floor", self._rows())
