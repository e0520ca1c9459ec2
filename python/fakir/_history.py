"""The contact of viscoelastic bodies over time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from . import _fakir
from ._format import Row, Shown, engineering
from ._numbers import HistoryNumbers
from ._quantity import FloatArray, Quantity, array, finite, several
from ._run import Progress, options, warn

if TYPE_CHECKING:
    import pandas


class Relaxation(Shown):
    """The relaxation function of all bodies: E(t) = E (1 + sum strengths exp(-t/times)), with E the relaxed modulus.

    Parameters
    ----------
    strengths
        Moduli of the terms relative to the relaxed modulus.
    times
        Relaxation times (s).

    Examples
    --------
    >>> fakir.Relaxation([1.0, 0.5], ["10 s", "2 min"]).modulus(0.0)
    2.5
    """

    _titles = ("fakir.Relaxation", "Relaxation function")

    __slots__ = ("strengths", "times")
    strengths: list[float]
    """Moduli of the terms relative to the relaxed modulus."""
    times: list[float]
    """Relaxation times, s."""

    def __init__(self, strengths: Sequence[float] | float, times: Sequence[Quantity] | Quantity) -> None:
        self.strengths = [finite(value, "number", "strengths") for value in several(strengths)]
        self.times = [finite(value, "time", "times") for value in several(times)]
        if len(self.strengths) != len(self.times):
            raise ValueError(
                f"{len(self.strengths)} strengths and {len(self.times)} times: every term needs both"
            )
        for value in [*self.strengths, *self.times]:
            if value <= 0.0:
                raise ValueError(f"{value} in a relaxation: strengths and times must be greater than 0")

    def modulus(self, time: float) -> float:
        """The modulus at a time (s) after a step, relative to the relaxed modulus."""
        if not time >= 0.0:
            raise ValueError(f"time is {time}: give the time after the step, 0 or greater")
        terms = zip(self.strengths, self.times)
        return 1.0 + float(sum(g * np.exp(-time / tau) for g, tau in terms))

    def _rows(self) -> list[Row]:
        return [
            (f"strength {strength:g}", engineering(time, "s"))
            for strength, time in zip(self.strengths, self.times)
        ]


class History(HistoryNumbers):
    """The contact of viscoelastic bodies over time. Numbers are in SI units; arrays have one value for every state."""

    _titles = ("fakir.History", "Viscoelastic contact over time")

    __slots__ = ("contact_radius", "floor_force", "force", "indentation", "time")
    time: FloatArray
    """Time, s."""
    force: FloatArray
    """Normal force, N."""
    indentation: FloatArray
    """Indentation, m."""
    contact_radius: FloatArray
    """Contact radius, m; NaN under a plate."""
    floor_force: FloatArray
    """Force on the floor, N; NaN without a floor."""

    def __init__(self, answer: _fakir.Answer) -> None:
        super().__init__(answer)
        for name, key in (
            ("time", "time_s"),
            ("force", "force_N"),
            ("indentation", "indentation_m"),
            ("contact_radius", "contact_radius_m"),
            ("floor_force", "floor_force_N"),
        ):
            states = self._summary["states"]
            values = [np.nan if row[key] is None else row[key] for row in states]
            setattr(self, name, np.array(values, dtype=np.float64))

    @property
    def events(self) -> list[dict[str, Any]]:
        """The events in order: ``time_s``, ``event``, ``force_N`` and ``indentation_m``."""
        return [dict(event) for event in self._summary["events"]]

    def to_pandas(self) -> pandas.DataFrame:
        """A table: the columns of ``history.csv``."""
        import pandas

        return pandas.DataFrame(self._summary["states"])

    def _rows(self) -> list[Row]:
        time = self.time_to_floor_contact
        rows = [
            ("force at the end", engineering(self.force[-1], "N")),
            ("indentation at the end", engineering(self.indentation[-1], "m")),
        ]
        if self.critical_force is not None:
            reached = "never" if time is None else engineering(time, "s")
            rows.append(("time to floor contact", reached))
        return rows


class Viscoelastic:
    """Problems whose bodies can be viscoelastic."""

    __slots__ = ()

    def _problem(self) -> Any:
        raise NotImplementedError

    def hold(
        self,
        *,
        force: Quantity | None = None,
        indentation: Quantity | None = None,
        duration: Quantity,
        ramp: Quantity = 0.0,
        back: bool = False,
        relaxation: Relaxation | None = None,
        threads: int = 1,
        progress: Progress | None = None,
        memory_limit: int | None = None,
    ) -> History:
        """Computes the contact under a held force (N) or at a held indentation (m) over time: creep or relaxation.

        Parameters
        ----------
        duration
            Duration of the hold (s).
        ramp
            Time in which the load is reached (s), and with ``back`` taken back; 0 for a step.
        back
            Whether the load is taken back after the hold.
        relaxation
            Relaxation function of all bodies; default: that of the case. The moduli of the bodies are the relaxed ones.
        """
        if (force is None) == (indentation is None):
            raise TypeError("give either force or indentation: what is held")
        is_force = force is not None
        if force is not None:
            value = finite(force, "force", "force")
        else:
            value = finite(indentation or 0.0, "length", "indentation")
        rise = finite(ramp, "time", "ramp")
        if rise < 0.0:
            raise ValueError(f"ramp is {rise}: give a time of 0 or greater")
        segments = [
            (is_force, value, rise),
            (is_force, value, finite(duration, "time", "duration")),
        ]
        if not isinstance(back, (bool, np.bool_)):
            raise TypeError(f"back is {back!r}: give True or False")
        if back:
            segments.append((is_force, 0.0, rise))
        return self._followed(segments, relaxation, options(threads, progress, memory_limit))

    def history(
        self,
        time: ArrayLike,
        *,
        force: ArrayLike | None = None,
        indentation: ArrayLike | None = None,
        relaxation: Relaxation | None = None,
        threads: int = 1,
        progress: Progress | None = None,
        memory_limit: int | None = None,
    ) -> History:
        """Computes the contact under a force (N) or an indentation (m) that is given at times (s) and linear between them.

        Times of the result count from the first one, at which the first load is reached at once.
        """
        if (force is None) == (indentation is None):
            raise TypeError("give either force or indentation over time")
        is_force = force is not None
        times = array(time, "time", "time")
        if force is not None:
            values = array(force, "force", "force")
        else:
            values = array(indentation, "length", "indentation")
        if times.ndim != 1 or times.shape != values.shape or times.size == 0:
            raise ValueError(
                f"time has the shape {times.shape} and the load {values.shape}: give one value for every time"
            )
        steps = np.diff(times, prepend=times[:1])
        segments = [
            (is_force, float(value), float(step)) for value, step in zip(values, steps)
        ]
        return self._followed(segments, relaxation, options(threads, progress, memory_limit))

    def _followed(
        self,
        segments: list[tuple[bool, float, float]],
        relaxation: Relaxation | None,
        run: _fakir.Options,
    ) -> History:
        terms = None if relaxation is None else (relaxation.strengths, relaxation.times)
        answer = _fakir.history(self._problem(), segments, terms, run)
        warn(answer.warnings, depth=3)
        return History(answer)
