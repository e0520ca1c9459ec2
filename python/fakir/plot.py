"""Figures with matplotlib.

Every function draws on ``ax`` (or on the axes of a new figure) and returns it; functions with several panels accept and return
sequences of axes. Needs matplotlib: ``pip install fakir[plot]``.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from . import theory
from ._bodies import CylinderLens, Lens, Pillars, PlateLens
from ._cycle import Cycle
from ._fit import Fit
from ._fits import Fits, JointFit
from ._friction import FrictionFit
from ._loading import Approach
from ._state import ContactState, CriticalState
from ._sweep import Sweep
from ._system import System
from .bem import SurfaceApproach, SurfaceContact, SurfaceTransition

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = [
    "approach",
    "critical_curves",
    "cycle",
    "fit",
    "fits",
    "floor_gap_map",
    "gap_map",
    "lateral_force",
    "lattice_sums",
    "phase_diagram",
    "pillar_pressure",
    "pressure_map",
    "profiles",
    "pull_off_curves",
    "top_view",
]

State: TypeAlias = ContactState | CriticalState
OnCells: TypeAlias = SurfaceContact | SurfaceTransition
"""A contact with a general surface, resolved on cells."""

MICRO = 1e6
"""Lengths are shown in µm."""

CUT = 3.0
"""Pressures are shown up to this multiple of the pressure at the centre of the central pillar: they are infinite at the edge of
a pillar top in full contact."""


def critical_curves(
    curves: Mapping[str, Iterable[CriticalState]] | Iterable[CriticalState] | Sweep,
    ax: Sequence[Axes] | None = None,
) -> Sequence[Axes]:
    """Plots reduced critical force, contact radius and indentation against the surface fraction.

    ``curves`` are critical states by name, or those of one curve, or a sweep of critical states; ``ax`` are three axes.
    """
    axes = _axes(ax, 3, 1, (3.4, 6.4), sharex=True)
    for name, (fraction, values) in _curves(curves).items():
        order = np.argsort(fraction)
        for axis, value in zip(axes, values):
            with np.errstate(invalid="ignore"):
                shown = np.where(value > 0.0, value, np.nan)
            axis.plot(fraction[order], shown[order], ".-", label=name or None)
    labels = [
        r"critical force $F_c\,\gamma_{int}/(h\,d)$",
        r"contact radius $a_c/e$",
        r"indentation $\zeta_c/h$",
    ]
    for axis, label in zip(axes, labels):
        axis.set_xscale("log")
        axis.set_yscale("log")
        axis.set_ylabel(label)
    axes[-1].set_xlabel(r"surface fraction $\phi$")
    _legend(axes[0])
    return axes


def profiles(
    states: State | OnCells | Sequence[State | OnCells], ax: Axes | Sequence[Axes] | None = None
) -> Sequence[Axes]:
    """Plots sections through lens and substrate along x, through the lens axis: one panel for every state.

    Heights are relative to the undeformed floor. The displacement is divided between the bodies in proportion to their
    compliance; pillars also shorten under their force.
    """
    single = (ContactState, CriticalState, SurfaceContact, SurfaceTransition)
    several = [states] if isinstance(states, single) else list(states)
    given = [ax] if ax is not None and not isinstance(ax, Sequence | np.ndarray) else ax
    axes = _axes(given, len(several), 1, (6.4, 1.8 * len(several)), sharex=True)
    for axis, item in zip(axes, several):
        if isinstance(item, (SurfaceContact, SurfaceTransition)):
            _profile_of_cells(axis, _on_cells(item))
        else:
            _profile(axis, _contact(item))
    axes[0].text(0.5, 0.96, _upper_body(several[0]), ha="center", va="top", transform=axes[0].transAxes)
    axes[0].text(0.02, 0.04, "substrate", transform=axes[0].transAxes)
    axes[-1].set_xlabel("x (µm)")
    return axes


def _upper_body(item: State | OnCells) -> str:
    if isinstance(item, (SurfaceContact, SurfaceTransition)):
        return "lens" if isinstance(_on_cells(item).surface.indenter, Lens) else "plate"
    return "plate" if isinstance(_contact(item).system.lens, PlateLens) else "lens"


def _profile(axis: Axes, state: ContactState) -> None:
    system = state.system
    lens, substrate = system.lens, system.substrate
    reach = max(1.3 * state.contact_radius, 1.6 * system.pitch)
    x = np.linspace(-reach, reach, 1201)
    top = state.on_pillar(x, 0.0)
    displacement, gap = state.displacement(x, 0.0), state.gap(x, 0.0)
    of_lens = (1.0 - lens.poisson_ratio**2) / lens.young_modulus
    of_substrate = (1.0 - substrate.poisson_ratio**2) / substrate.young_modulus
    share = of_lens / (of_lens + of_substrate)
    sag = np.array([system._case.sag(float(at), 0.0) for at in x])
    _, height = system._pillar
    under = height + sag - state.indentation + share * displacement
    ground = under - gap
    floor = min(float(ground.min()), 0.0) - 0.25 * height
    _bodies(axis, x, under, ground, top, floor)
    axis.set_xlim(-MICRO * reach, MICRO * reach)


def _bodies(axis: Axes, x: Any, under: Any, ground: Any, top: Any, floor: float) -> None:
    """Draws the outlines of both bodies; heights are shown from ``floor``."""
    axis.fill_between(MICRO * x, MICRO * under, MICRO * under.max(), color="#c6ddf0", lw=0)
    axis.fill_between(MICRO * x, MICRO * floor, MICRO * ground, color="#e2d6c4", lw=0)
    axis.plot(MICRO * x, MICRO * under, lw=0.9, color="#1f5f99")
    # Tops and floor are drawn separately, without slopes at the edges.
    for part in [top, ~top]:
        axis.plot(MICRO * x, MICRO * np.where(part, ground, np.nan), lw=0.9, color="#7a5c2e")
    axis.set_ylabel("height (µm)")


def _profile_of_cells(axis: Axes, contact: SurfaceContact) -> None:
    """Draws the row of cells closest to the lens axis."""
    surface = contact.surface
    reach = _reach(contact)
    row = int(np.argmin(np.abs(surface.y)))
    shown = np.abs(surface.x) <= reach
    shown &= np.isfinite(contact.gap_map[row])
    moved = contact.displacement_map[row]
    top = np.zeros(surface.x.shape, dtype=bool)
    shortening = np.zeros(surface.x.shape)
    pillars = surface._surface.pillars()
    if pillars is not None:
        labels, compliance = pillars
        width, height = surface._surface.cell
        force = np.bincount(
            labels[labels >= 0],
            weights=contact.pressure_map[labels >= 0] * width * height,
            minlength=len(compliance),
        )
        top = labels[row] >= 0
        shortening[top] = (force * compliance)[labels[row][top]]
    substrate, indenter = surface.substrate, surface.indenter
    of_substrate = (1.0 - substrate.poisson_ratio**2) / substrate.young_modulus
    of_indenter = 0.0
    if indenter.young_modulus is not None and indenter.poisson_ratio is not None:
        of_indenter = (1.0 - indenter.poisson_ratio**2) / indenter.young_modulus
    share = of_substrate / (of_substrate + of_indenter)
    ground = surface.heights[row] - shortening - share * (moved - shortening)
    under = ground + contact.gap_map[row]
    low, high = float(ground[shown].min()), float(ground[shown].max())
    depth = high - low if high > low else float(under[shown].max()) - low
    x = surface.x[shown]
    _bodies(axis, x, under[shown], ground[shown], top[shown], low - 0.25 * depth)
    axis.set_ylim(MICRO * (low - 0.25 * depth), MICRO * (high + 0.75 * depth))
    axis.set_xlim(MICRO * x[0], MICRO * x[-1])


def approach(
    loading: Approach | SurfaceApproach, ax: Sequence[Axes] | None = None
) -> Sequence[Axes]:
    """Plots force and contact radius over the indentation, with the critical state marked if it is reached.

    Two axes. The fraction of the load carried by the floor is shown if there is one, and states past the transition that ignore
    floor contact are dashed. Under a plate the contact area replaces the radius.
    """
    axes = _axes(ax, 2, 1, (4.2, 5.2), sharex=True)
    rows = loading.to_dict()["states"]
    plate = any(row["contact_radius_m"] is None for row in rows)
    second = "contact_area_m2" if plate else "contact_radius_m"
    scale = MICRO**2 if plate else MICRO
    bare = [bool(row["beyond_transition"]) and row["floor_force_N"] is None for row in rows]
    at = np.array([row["indentation_m"] for row in rows])
    on_floor = any(row["floor_force_N"] for row in rows)
    for axis, name, factor in zip(axes, ["force_N", second], [MICRO, scale]):
        values = np.array([row[name] for row in rows], dtype=float)
        past = np.array(bare) | np.append(np.array(bare)[1:], False)
        words = "total force" if on_floor and name == "force_N" else _words(name)
        axis.plot(MICRO * at, factor * np.where(bare, np.nan, values), ".-", label=words)
        if any(bare):
            axis.plot(
                MICRO * at, factor * np.where(past, values, np.nan), "--", color="0.6", label="floor contact ignored"
            )
        for row in rows:
            if row["critical"]:
                place = MICRO * row["indentation_m"], factor * row[name]
                axis.plot(*place, "D", color="#c0392b", ms=4, label="critical state")
    if on_floor:
        floor = np.array([row["floor_force_N"] for row in rows], dtype=float)
        axes[0].plot(MICRO * at, MICRO * floor, "--", label="floor force")
    axes[0].set_ylabel("force $F$ (µN)")
    axes[1].set_ylabel("contact area $A$ (µm²)" if plate else "contact radius $a$ (µm)")
    axes[1].set_xlabel(r"indentation $\zeta$ (µm)")
    _legend(axes[0])
    return axes


def cycle(result: Cycle, ax: Sequence[Axes] | None = None) -> Sequence[Axes]:
    """Plots the force over the indentation of a loading and unloading cycle, the same close to pull-off, and the number of
    pillars in contact.

    Three axes. Attachment and detachment of pillars, the critical state and pull-off are marked.

    >>> import fakir.plot
    >>> system = fakir.System.from_file("examples/adhesive.toml")
    >>> axes = fakir.plot.cycle(system.cycle())
    """
    axes = _axes(ax, 3, 1, (4.2, 7.6), height_ratios=[3, 3, 2])
    up, styles = result.unloading, {False: ("-", "#0072b2"), True: ("--", "#d55e00")}
    for branch, (line, colour) in styles.items():
        shown = up == branch
        label = "unloading" if branch else "loading"
        at = MICRO * result.indentation[shown]
        for axis in axes[:2]:
            axis.plot(at, MICRO * result.force[shown], line, color=colour, lw=1.2, label=label)
        axes[2].plot(at, result.pillars_in_contact[shown], line, color=colour, lw=1.2)
    for kind, mark, colour, label in [
        ("snap_in", "o", "#0072b2", "attachment"),
        ("release", "x", "#d55e00", "detachment"),
    ]:
        events = [event for event in result.events if event["event"] == kind]
        at = [MICRO * event["indentation_m"] for event in events]
        force = [MICRO * event["force_N"] for event in events]
        for axis in axes[:2] if events else []:
            axis.plot(at, force, mark, color=colour, mfc="none", ms=3.5, label=label)
    if result.critical is not None:
        place = MICRO * result.critical.indentation, MICRO * result.critical.force
        axes[0].plot(*place, "D", color="k", ms=4, label="critical state")
    if result.pull_off is not None:
        place = MICRO * result.pull_off.indentation, MICRO * result.pull_off.force
        for axis in axes[:2]:
            axis.plot(*place, "s", color="#009e73", ms=4.5, label="pull-off")
        # A symmetric range of forces, and the corresponding range of the curve.
        size = -MICRO * result.pull_off.force
        near = MICRO * result.indentation[MICRO * result.force <= size]
        margin = 0.05 * (near.max() - near.min())
        axes[1].set_ylim(-1.15 * size, 1.15 * size)
        axes[1].set_xlim(near.min() - margin, near.max() + margin)
        axes[1].axhline(0.0, color="0.6", lw=0.6, zorder=0)
    for axis in axes[:2]:
        axis.set_ylabel("force $F$ (µN)")
    axes[2].set_ylabel("pillars in contact")
    axes[2].set_xlabel(r"indentation $\zeta$ (µm)")
    _legend(axes[0])
    return axes


def pull_off_curves(sweep: Sweep, ax: Sequence[Axes] | None = None) -> Sequence[Axes]:
    """Plots pull-off force and hysteresis of a sweep of cycles over its surface fractions, one curve for every combination of the
    other axes.

    Four axes: the pull-off force, its ratio to the force of a single flat pillar (Kendall), the hysteresis, and its ratio to the
    work of adhesion of the largest contact area of tops.
    """
    from matplotlib.ticker import LogLocator, NullFormatter, ScalarFormatter

    axes = _axes(ax, 2, 2, (7.0, 5.2), sharex=True)
    panels = [
        ("pull_off_force_N", -MICRO, r"pull-off force $|F_p|$ (µN)"),
        ("normalized_pull_off_force", 1.0, r"pull-off force $|F_p|/F_{Kendall}$"),
        ("hysteresis_J", 1e12, r"hysteresis $E_{loop}$ (pJ)"),
        ("normalized_hysteresis", 1.0, r"hysteresis $E_{loop}/(w\,A_{tops})$"),
    ]
    names = [name for name, _, _ in panels]
    for name, (fraction, values) in _curves_of_sweep(sweep, "cycle", names).items():
        order = np.argsort(fraction)
        for axis, value, (_, factor, _) in zip(axes, values, panels):
            axis.plot(fraction[order], factor * value[order], ".-", label=name or None)
    for axis, (name, _, label) in zip(axes, panels):
        axis.set_xscale("log")
        axis.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.xaxis.set_major_formatter(ScalarFormatter())
        axis.xaxis.set_minor_formatter(NullFormatter())
        if name != "normalized_hysteresis":
            axis.set_yscale("log")
        axis.set_ylabel(label)
    for axis in axes[2:]:
        axis.set_xlabel(r"surface fraction $\phi$")
    # Above the axes, because the curves of cycles leave no space.
    _legend(axes[0], loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2)
    return axes


def _words(name: str) -> str:
    return name.rsplit("_", 1)[0].replace("_", " ")


def gap_map(state: OnCells, ax: Axes | None = None) -> Axes:
    """Plots the gap between the deformed bodies on the cells of a general surface; grey in contact.

    Gaps larger than most of those shown have the last colour.
    """
    contact = _on_cells(state)
    axis = _axis(ax)
    surface = contact.surface
    open_gap = np.where(contact.pressure_map > 0.0, np.nan, contact.gap_map)
    x, y = np.meshgrid(surface.x, surface.y)
    reach = _reach(contact)
    seen = open_gap[(np.abs(x) < reach) & (np.abs(y) < reach) & np.isfinite(open_gap)]
    if seen.size == 0:
        raise ValueError("there is no gap to show: all of the surface is in contact")
    image = axis.pcolormesh(
        MICRO * surface.x,
        MICRO * surface.y,
        MICRO * open_gap,
        cmap="viridis",
        shading="nearest",
        vmin=0.0,
        vmax=MICRO * float(np.quantile(seen, 0.85)),
    )
    axis.set_facecolor("0.47")
    _marks(axis, state)
    _frame(axis, contact)
    axis.figure.colorbar(image, ax=axis, label="gap (µm)", extend="max")
    _key(axis, {"in contact": "0.47"})
    return axis


def _pressure_of_cells(state: OnCells, ax: Axes | None) -> Axes:
    from matplotlib.patches import Circle

    contact = _on_cells(state)
    axis = _axis(ax)
    surface = contact.surface
    pressed = np.where(contact.pressure_map > 0.0, contact.pressure_map, np.nan)
    if np.isnan(pressed).all():
        raise ValueError("there is no pressure to show: nothing is in contact")
    image = axis.pcolormesh(
        MICRO * surface.x,
        MICRO * surface.y,
        pressed / 1e3,
        cmap="viridis",
        shading="nearest",
        vmin=0.0,
        vmax=float(np.nanquantile(pressed, 0.98)) / 1e3,
    )
    axis.set_facecolor("0.94")
    if contact.contact_radius:
        edge = MICRO * contact.contact_radius
        circle = Circle((0, 0), edge, fill=False, ls="--", lw=0.8, color="grey", label="edge of contact")
        axis.add_patch(circle)
    _marks(axis, state)
    _frame(axis, contact)
    axis.figure.colorbar(image, ax=axis, label="pressure (kPa)", extend="max")
    _key(axis, {"no contact": "0.94"})
    return axis


def _marks(axis: Axes, state: OnCells) -> None:
    if isinstance(state, SurfaceTransition):
        x, y = state.floor_contact
        axis.plot([MICRO * x], [MICRO * y], "x", color="#c0392b", label="floor contact")


def _frame(axis: Axes, contact: SurfaceContact) -> None:
    """Limits the axes to the contact of a lens on a free surface; otherwise to all cells."""
    reach = _reach(contact)
    if np.isfinite(reach):
        _square(axis, reach)
    else:
        axis.set_aspect("equal")
        axis.set_xlabel("x (µm)")
        axis.set_ylabel("y (µm)")


def _reach(contact: SurfaceContact) -> float:
    """Distance from the lens axis shown in a figure; infinite for all cells."""
    surface = contact.surface
    if surface.periodic or not isinstance(surface.indenter, Lens):
        return float("inf")
    whole = 0.5 * max(float(np.ptp(surface.x)), float(np.ptp(surface.y)))
    return min(max(1.25 * (contact.contact_radius or 0.0), 0.2 * whole), whole)


def pressure_map(state: State | OnCells, ax: Axes | None = None) -> Axes:
    """Plots the mean pressure on every pillar top; those in partial contact are outlined.

    The dashed circle is the edge of the contact; under a cylinder or a plate there is none.

    On a general surface, plots the pressure on every cell.
    """
    from matplotlib.collections import PatchCollection
    from matplotlib.patches import Circle

    if isinstance(state, (SurfaceContact, SurfaceTransition)):
        return _pressure_of_cells(state, ax)
    contact = _contact(state)
    axis = _axis(ax)
    pillars = contact.pillars
    if len(pillars) == 0:
        raise ValueError(f'there are no pillars to show (method "{contact.method}")')
    pattern = contact.system.pattern
    if isinstance(pattern, Pillars):
        radii = 0.5 * pattern.diameter[pillars["i"]]
    else:
        radii = np.full(len(pillars), 0.5 * pattern.diameter)
    circles = [
        Circle((MICRO * x, MICRO * y), MICRO * radius)
        for (x, y), radius in zip(_centres(pillars), radii, strict=True)
    ]
    partial = pillars["status"] == "partial"
    collection = PatchCollection(
        circles, cmap="viridis", edgecolors=np.where(partial, "#c0392b", "none").tolist(), lw=0.8
    )
    collection.set_array(pillars["force_N"] / (np.pi * radii**2) / 1e3)
    axis.add_collection(collection)
    if not isinstance(contact.system.lens, (CylinderLens, PlateLens)):
        edge = Circle(
            (0, 0), MICRO * contact.top_contact_radius, fill=False, ls="--", lw=0.8, color="grey", label="edge of contact"
        )
        axis.add_patch(edge)
    if isinstance(state, CriticalState):
        x, y = state.floor_contact
        axis.plot([MICRO * x], [MICRO * y], "x", color="#c0392b", label="floor contact")
    _key(axis, {}, {"partial contact": "#c0392b"} if partial.any() else {})
    _square(axis, 1.08 * contact.top_contact_radius + float(radii.max()))
    axis.figure.colorbar(collection, ax=axis, label="mean pressure on pillar top (kPa)")
    return axis


def pillar_pressure(state: State, ax: Axes | None = None, points: int = 401) -> Axes:
    """Plots the pressure across the central pillar and the outermost one, along the line from the lens axis.

    The axis ends at three times the pressure at the centre of the central pillar: at the edge of a pillar top in full contact the
    pressure is infinite.
    """
    contact = _contact(state)
    axis = _axis(ax)
    pillars = contact.pillars
    if len(pillars) == 0:
        raise ValueError(f'there are no pillars to show (method "{contact.method}")')
    radius = 0.5 * contact.system._pillar[0]
    distance = np.hypot(pillars["x_m"], pillars["y_m"])
    partial = pillars["status"] == "partial"
    rim = int(np.argmax(np.where(partial, distance, -1.0) if partial.any() else distance))
    reference = max(pillars["centre_pressure_Pa"][0], pillars["centre_pressure_Pa"][rim])
    if reference <= 0.0:
        reference = pillars["force_N"][0] / (np.pi * radius**2)
    along = radius * np.linspace(-1.0, 1.0, points)
    shown = {"central pillar": 0} if rim == 0 else {"central pillar": 0, "rim pillar": rim}
    for name, number in shown.items():
        x, y = pillars["x_m"][number], pillars["y_m"][number]
        far = np.hypot(x, y)
        ux, uy = (x / far, y / far) if far > 1e-9 * radius else (1.0, 0.0)
        # Slightly inside, so that rounding does not exclude the ends.
        inside = (1.0 - 1e-9) * along
        pressure = contact.pressure(x + inside * ux, y + inside * uy)
        axis.plot(along / radius, pressure / 1e3, label=name)
    axis.set_xlabel("radial position on the top $2s/d$")
    axis.set_ylabel("pressure $p$ (kPa)")
    # Higher pressures are clipped by the frame.
    axis.set_ylim(0.0, CUT * reference / 1e3)
    _legend(axis)
    return axis


def phase_diagram(
    system: System,
    critical: Iterable[CriticalState] = (),
    paths: Iterable[Approach] = (),
    ax: Axes | None = None,
) -> Axes:
    """Plots the phase diagram: reduced force against the radius of the contact on the pillar tops.

    Below the transition curve of the paper the lens rests on the tops alone, above it also on the floor; left of one pitch the
    state depends on the landing position. Critical states are drawn at their ``top_contact_radius``, where loading paths end.
    """
    axis = _axis(ax)
    diameter, height = system._pillar
    unit = height * diameter / theory.constants(system).internal_compliance
    loadings = [[state for state in path if state.force > 0.0] for path in paths]
    points = [state for state in critical if state.force > 0.0]
    reached = [state.top_contact_radius / state.system.pitch for path in loadings for state in path]
    reached += [point.top_contact_radius / point.system.pitch for point in points]
    ends = min([0.3, *(0.7 * a for a in reached)]), max([40.0, *(1.4 * a for a in reached)])
    radii = np.geomspace(*ends, 300)
    curve = theory.transition_force(system, radii * system.pitch) / unit
    axis.fill_between(radii, 1e-3, curve, color="#ddebf7", lw=0)
    axis.fill_between(radii, curve, 1e6, color="#fae4d0", lw=0)
    axis.plot(radii, curve, "k", lw=1.0, label="transition curve")
    axis.axvline(1.0, color="k", ls=":", lw=0.8, label="one pitch, $a = e$")
    for loaded in loadings:
        across = [state.top_contact_radius / state.system.pitch for state in loaded]
        fraction = f"loading, $\\phi$ = {loaded[0].system.surface_fraction:.3g}" if loaded else None
        axis.plot(across, [state.force / unit for state in loaded], ".-", ms=3, lw=0.8, label=fraction)
    if points:
        across = [point.top_contact_radius / point.system.pitch for point in points]
        forces = [point.normalized.force for point in points]
        axis.plot(across, forces, "o", ms=4, label="critical states")
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.set_xlim(*ends)
    axis.set_ylim(0.3, 1e4)
    axis.set_xlabel(r"radius of the contact on the tops over pitch $a/e$")
    axis.set_ylabel(r"reduced force $F\,\gamma_{int}/(h\,d)$")
    axis.text(0.97, 0.05, "tops only", style="italic", ha="right", transform=axis.transAxes)
    axis.text(0.03, 0.95, "tops and floor", style="italic", va="top", transform=axis.transAxes)
    _legend(axis, loc="upper left", bbox_to_anchor=(0.0, 0.92))
    return axis


def floor_gap_map(state: State, ax: Axes | None = None, points: int = 221) -> Axes:
    """Plots the gap between lens and floor around the lens axis, with the pillars: dark if they are in contact.

    A cross marks the smallest gap, unless it is known on the undeformed lens only (under a cylinder or a plate).
    """
    contact = _contact(state)
    axis = _axis(ax)
    pitch = contact.system.pitch
    x, y = contact.smallest_gap_position
    reach = max(1.7 * pitch, float(np.hypot(x, y)) + 0.6 * pitch)
    line = np.linspace(-reach, reach, points)
    grid = np.meshgrid(line, line)
    gap = contact.gap(*grid)
    top = contact.on_pillar(*grid)
    image = axis.pcolormesh(
        MICRO * line, MICRO * line, np.where(top, np.nan, MICRO * gap), cmap="viridis", shading="nearest"
    )
    touched = contact.pressure(*grid) > 0.0
    shade = np.where(top, np.where(touched, 0.45, 0.88), np.nan)
    axis.pcolormesh(
        MICRO * line, MICRO * line, shade, cmap="gray", vmin=0.0, vmax=1.0, shading="nearest"
    )
    known = not isinstance(contact.system.lens, (CylinderLens, PlateLens))
    if known and not contact.on_pillar(x, y):
        axis.plot([MICRO * x], [MICRO * y], "x", color="#c0392b", label="smallest gap")
    _key(axis, {"pillar in contact": "0.45", "pillar, no contact": "0.88"})
    _square(axis, reach)
    axis.figure.colorbar(image, ax=axis, label="gap to the floor (µm)")
    return axis


def lattice_sums(
    largest_radius: float = 32.0, ax: Sequence[Axes] | None = None
) -> Sequence[Axes]:
    """Plots the lattice sums G0, G and G1 against the contact radius, with the fits of the paper."""
    axes = _axes(ax, 1, 3, (9.0, 3.0))
    radii = np.geomspace(1.01, max(largest_radius, 1.1), 300)
    exact, fitted = theory.lattice_sums(radii), theory.fitted_lattice_sums(radii)
    for axis, name, sums, fit in zip(axes, ["$G_0$", "$G$", "$G_1$"], exact, fitted):
        axis.plot(radii, np.where(sums > 0.0, sums, np.nan), "k", lw=1.0, label="exact sums")
        axis.plot(radii, fit, "--", label="fit of the paper")
        axis.set_xscale("log")
        axis.set_xlabel(r"contact radius over pitch $a/e$")
        axis.set_ylabel(f"lattice sum {name}")
    for axis in axes[:2]:
        axis.set_yscale("log")
    _legend(axes[0])
    return axes


def fit(result: Fit, ax: Sequence[Axes] | None = None) -> Sequence[Axes]:
    """Plots measured points with the fitted curve, and the residuals below: two axes for every quantity."""
    data, curve = result.columns(), result.curve
    names = result.compared
    axes = _axes(ax, 2, len(names), (4.2 * len(names), 4.6), sharex=True, height_ratios=[2, 1])
    # Without drifts, because the curve refers to the first row.
    none = np.zeros(len(data["used"]))
    drifts = {name: data.get(name.replace("_", "_drift_"), none) for name in ("displacement_m", "force_N")}
    at = data[result.load] - drifts.get(result.load, none)
    used = np.array(data["used"], dtype=bool)
    for name, upper, lower in zip(names, axes, axes[len(names) :]):
        quantity, unit = name.rsplit("_", 1)
        shown = used & np.isfinite(data[name])
        error = MICRO * data[f"{quantity}_error_{unit}"]
        measured, rest = MICRO * (data[name] - drifts.get(name, none)), MICRO * data[f"{quantity}_residual_{unit}"]
        back = result.unloading
        branches = [("", np.ones(len(at), dtype=bool), ~back, "C0")]
        if back.any():
            unloading = np.asarray(data["branch"]) == "unloading"
            branches = [
                (", loading", ~unloading, ~back, "C0"),
                (", unloading", unloading, back, "C3"),
            ]
        for branch, rows, points, colour in branches:
            across = MICRO * curve[result.load][points]
            line = "--" if branch == ", unloading" else "-"
            # Above the points, which would hide it.
            above: dict[str, Any] = {"color": "k", "lw": 1.0, "zorder": 5}
            upper.plot(across, MICRO * curve[name][points], line, label=f"fitted{branch}", **above)
            marks: dict[str, Any] = {"fmt": f"{colour}.", "ms": 4, "lw": 0.8}
            on = shown & rows
            upper.errorbar(MICRO * at[on], measured[on], error[on], label=f"measured{branch}", **marks)
            lower.errorbar(MICRO * at[on], rest[on], error[on], **marks)
        if not used.all():
            upper.plot(MICRO * at[~used], measured[~used], ".", color="0.6", label="past the transition, not fitted")
        lower.axhline(0.0, lw=0.8, color="k", zorder=5)
        upper.set_ylabel(f"{quantity.replace('_', ' ')} (µ{unit})")
        lower.set_ylabel(f"residual (µ{unit})")
        load = result.load.removeprefix("measured_").rsplit("_", 1)
        lower.set_xlabel(f"{load[0].replace('_', ' ')} (µ{load[1]})")
    if not result.describes_data:
        axes[0].set_title("the fit does not describe the data")
    _legend(axes[0])
    return axes


def lateral_force(result: FrictionFit, ax: Sequence[Axes] | None = None) -> Sequence[Axes]:
    """Plots measured lateral forces over the normal force with the curve of the fitted stresses; below, the part of the floor."""
    data, curve = dict(result._fitted.table()), result.curve
    upper, lower = axes = _axes(ax, 2, 1, (4.2, 4.6), sharex=True, height_ratios=[2, 1])
    used = np.array(data["used"], dtype=bool)
    error = MICRO * data["lateral_force_error_N"]
    for rows, colour, label in ((used, "C0", "measured"), (~used, "0.6", "not fitted")):
        if rows.any():
            force, lateral = MICRO * data["force_N"][rows], MICRO * data["lateral_force_N"][rows]
            bars = np.where(np.isfinite(error), error, 0.0)[rows]
            upper.errorbar(force, lateral, bars, fmt=".", color=colour, ms=4, lw=0.8, label=label)
    force, whole = MICRO * curve[:, 0], MICRO * curve[:, 1]
    tops = MICRO * (result.tops.value or 0.0) * curve[:, 2]
    upper.plot(force, whole, "k-", lw=1.0, label="fitted")
    if (curve[:, 3] > 0.0).any():
        upper.plot(force, tops, "C3--", lw=1.0, label="on tops")
    upper.set_ylabel("lateral force (µN)")
    upper.legend()
    with np.errstate(invalid="ignore", divide="ignore"):
        share = np.where(whole > 0.0, 1.0 - tops / whole, 0.0)
    lower.plot(force, share, "k-", lw=1.0)
    lower.set_xlabel("normal force (µN)")
    lower.set_ylabel("share of the floor")
    return axes


def fits(result: Fits | JointFit, ax: Sequence[Axes] | None = None) -> Sequence[Axes]:
    """Plots the fitted values of several curves with their standard errors, one axes for every parameter.

    A line is the mean in the band of the standard deviation. In a joint fit it is the shared value in the band of its standard error,
    with the values of the separate fits.
    """
    curves = [(number, curve.fit) for number, curve in enumerate(result.curves) if curve.fit is not None]
    names = list(curves[0][1].parameters)
    axes = _axes(ax, 1, len(names), (3.6 * len(names), 3.2))
    for name, axis in zip(names, axes):
        level, half, label = None, None, "mean"
        estimates = [(number, fit[name]) for number, fit in curves]
        if isinstance(result, Fits):
            level, half = result[name].mean, result[name].standard_deviation
        elif name in result.parameters:
            level, half, label = result[name].value, result[name].standard_error, "shared value"
            estimates = [(number, result.separate[number][name]) for number, _ in curves]
        largest = max(abs(one.value) for _, one in estimates)
        power = 3 * int(np.floor(np.log10(largest) / 3)) if largest > 0.0 else 0
        scale = 10.0**power
        errors = [(one.standard_error or 0.0) / scale for _, one in estimates]
        values = [one.value / scale for _, one in estimates]
        axis.errorbar([number + 1 for number, _ in estimates], values, errors, fmt="ko", ms=4, lw=0.8)
        if level is not None:
            axis.axhline(level / scale, label=label)
            if half is not None:
                axis.axhspan((level - half) / scale, (level + half) / scale, color="0.88", zorder=0)
            axis.legend()
        unit = estimates[0][1].unit
        prefix = {0: "", 3: "k", 6: "M", 9: "G", -3: "m", -6: "µ", -9: "n", -12: "p"}.get(power)
        words = f"{prefix}{unit}" if prefix is not None and unit in {"m", "N", "Pa"} else f"10^{power} {unit}"
        axis.set_ylabel(f"{name} ({words})")
        axis.set_xticks(range(1, len(result) + 1), [curve.name.rsplit("/", 1)[-1] for curve in result.curves])
        axis.tick_params(axis="x", rotation=45)
    return axes


def top_view(
    state: State,
    ax: Axes | None = None,
    wavelength: float | None = None,
    points: int = 501,
) -> Axes:
    """Plots the contact from above: dark where lens and pillar touch, grey where lens and floor touch.

    With a ``wavelength`` (m; ``550e-9`` is green), plots the interference of light reflected at the lens and at the surface below
    it: dark in contact.
    """
    contact = _contact(state)
    axis = _axis(ax)
    margin = 1.1 if wavelength is None else 1.4
    of_floor = 0.0 if contact.floor is None else contact.floor.radius
    reach = max(margin * max(contact.contact_radius, of_floor), 1.4 * contact.system.pitch)
    line = np.linspace(-reach, reach, points)
    grid = np.meshgrid(line, line)
    if wavelength is None:
        top = contact.on_pillar(*grid)
        touched = contact.pressure(*grid) > 0.0
        shades = {"top in contact": "0.10", "top, no contact": "0.92", "floor, no contact": "0.80"}
        if of_floor > 0.0:
            shades["floor in contact"] = "0.45"
        _key(axis, shades)
        shade = np.where(top, np.where(touched, 0.10, 0.92), np.where(touched, 0.45, 0.80))
    else:
        shade = 0.5 * (1.0 - np.cos(4.0 * np.pi * contact.gap(*grid) / wavelength))
    axis.pcolormesh(
        MICRO * line, MICRO * line, shade, cmap="gray", vmin=0.0, vmax=1.0, shading="nearest"
    )
    _square(axis, reach)
    return axis


def _curves(
    curves: Mapping[str, Iterable[CriticalState]] | Iterable[CriticalState] | Sweep,
) -> dict[str, tuple[Any, list[Any]]]:
    """Surface fractions and the three reduced variables, by name."""
    if isinstance(curves, Sweep):
        names = ["normalized_force", "normalized_contact_radius", "normalized_indentation"]
        return _curves_of_sweep(curves, "transition", names)
    named = curves if isinstance(curves, Mapping) else {"": curves}
    found = {}
    for name, states in named.items():
        listed = list(states)
        reduced = np.array([state.normalized for state in listed], dtype=float).reshape(-1, 3)
        fraction = np.array([state.system.surface_fraction for state in listed])
        found[name] = (fraction, list(reduced.T))
    return found


def _curves_of_sweep(
    sweep: Sweep, question: str, names: Sequence[str]
) -> dict[str, tuple[Any, list[Any]]]:
    """Columns of the results of a sweep: one curve for every combination of the other axes."""
    rows = [row for row in sweep.rows if not row["problem"]]
    if rows and names[0] not in rows[0]:
        answers = "critical states" if question == "transition" else "cycles"
        raise ValueError(f"these are no {answers}: sweep the question {question}")
    across = ("pattern.surface_fraction", "pattern.pitch")
    others = [name for name in sweep.axes if not name.startswith(across)]
    groups: dict[str, list[dict[str, Any]]] = {}
    for row in rows:
        words = [_setting(name.split(".")[-1], row[name]) for name in others]
        groups.setdefault(", ".join(words), []).append(row)
    return {
        name: (
            np.array([row["surface_fraction"] for row in group]),
            [np.array([row[name] for row in group], dtype=float) for name in names],
        )
        for name, group in groups.items()
    }


def _setting(name: str, value: Any) -> str:
    if name.endswith("_J_per_m2"):
        return f"{name.removesuffix('_J_per_m2')} {_short(1e3 * value)} mJ/m²"
    return f"{name} {_short(value)}"


def _short(value: Any) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def _on_cells(state: OnCells) -> SurfaceContact:
    return state.contact if isinstance(state, SurfaceTransition) else state


def _contact(state: State) -> ContactState:
    return state.state if isinstance(state, CriticalState) else state


def _centres(pillars: Any) -> Iterable[tuple[float, float]]:
    return zip(pillars["x_m"], pillars["y_m"])


def _square(axis: Axes, reach: float) -> None:
    axis.set_xlim(-MICRO * reach, MICRO * reach)
    axis.set_ylim(-MICRO * reach, MICRO * reach)
    axis.set_aspect("equal")
    axis.set_xlabel("x (µm)")
    axis.set_ylabel("y (µm)")


def _key(axis: Axes, shades: Mapping[str, str], outlines: Mapping[str, str] | None = None) -> None:
    """Explains the filled areas, the outlines and the named marks of a map, below it."""
    from matplotlib.patches import Patch

    handles: list[Any] = [Patch(fc=shade, ec="0.4", lw=0.4, label=name) for name, shade in shades.items()]
    handles += [Patch(fc="none", ec=edge, label=name) for name, edge in (outlines or {}).items()]
    handles += axis.get_legend_handles_labels()[0]
    where: dict[str, Any] = {"loc": "upper center", "bbox_to_anchor": (0.5, -0.2), "ncols": 2}
    if handles:
        axis.legend(handles=handles, frameon=False, fontsize="small", **where)


def _legend(axis: Axes, **where: Any) -> None:
    if axis.get_legend_handles_labels()[0]:
        axis.legend(frameon=False, fontsize="small", **where)


def _axis(ax: Axes | None) -> Axes:
    if ax is not None:
        return ax
    import matplotlib.pyplot as plt

    return plt.subplots(figsize=(4.2, 3.6), layout="constrained")[1]


def _axes(
    ax: Sequence[Axes] | None, rows: int, columns: int, size: tuple[float, float], **options: Any
) -> Sequence[Axes]:
    if ax is None:
        import matplotlib.pyplot as plt

        figure = plt.figure(figsize=size, layout="constrained")
        ax = list(figure.subplots(rows, columns, squeeze=False, **options).flat)
    required = rows * columns
    if len(ax) != required:
        raise ValueError(f"{len(ax)} axes were given: this figure has {required}")
    return ax
