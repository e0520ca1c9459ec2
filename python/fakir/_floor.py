"""Contact with the floor between the pillars."""

from __future__ import annotations

from ._format import Row, engineering, known_digits, remark
from ._numbers import FloorNumbers
from ._quantity import FloatArray
from ._result import Numbered


class FloorContact(FloorNumbers):
    """The contact with the floor between the pillars. Numbers are in SI units.

    Its pressure is constant on the cells of a grid that is aligned and rotated with the lattice: ``x``, ``y`` and ``pressure``
    are arrays with one value for every cell in contact.
    """

    _titles = ("fakir.FloorContact", "Contact with the floor")

    __slots__ = ("pressure", "x", "y")

    x: FloatArray
    """Centres of the cells in contact along x, m from the lens axis."""
    y: FloatArray
    """Centres of the cells in contact along y, m from the lens axis."""
    pressure: FloatArray
    """Pressure on the cells in contact, Pa."""

    def __init__(self, contact: Numbered, cells: list[FloatArray]) -> None:
        self._numbers, self._summary = contact._numbers, contact._summary["floor"]
        self.x, self.y, self.pressure = cells
        for array in cells:
            array.flags.writeable = False

    def _share_rows(self) -> list[Row]:
        error = self.error.share
        digits = known_digits(error)
        return [
            ("force on the floor", engineering(self.force, "N", digits) + remark(error)),
            ("fraction on the floor", f"{self.share:.{digits}g}"),
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
