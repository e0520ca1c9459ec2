"""Figures: axes in, axes out."""

import matplotlib
import numpy as np
import pytest

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402
from conftest import EXAMPLES  # noqa: E402

import fakir  # noqa: E402


@pytest.fixture(scope="module")
def system():
    return fakir.System.from_file(
        EXAMPLES / "paper-intermediate.toml", overrides={"pattern.surface_fraction": 0.03}
    )


@pytest.fixture(autouse=True)
def closed():
    yield
    plt.close("all")


@pytest.mark.parametrize("name", ["pressure_map", "pillar_pressure", "floor_gap_map", "top_view"])
def test_a_state_on_axes(system, name):
    critical = system.transition()
    draw = getattr(fakir.plot, name)
    axes = plt.figure().subplots()
    assert draw(critical, axes) is axes
    assert axes.has_data()
    assert draw(critical.state) is not axes


def test_newton_rings(system):
    assert fakir.plot.top_view(system.transition(), wavelength=550e-9, points=51).has_data()


def test_several_panels(system):
    critical = system.transition()
    axes = fakir.plot.profiles([system.press(indentation="1 um"), critical])
    assert len(axes) == 2
    assert len(fakir.plot.profiles(critical, plt.figure().subplots())) == 1
    assert all(axis.has_data() for axis in fakir.plot.lattice_sums(8.0))
    with pytest.raises(ValueError, match="2 axes were given: this figure has 3"):
        fakir.plot.critical_curves([critical], axes)


def test_critical_curves_and_phase_diagram(system):
    study = {"system": system, "axes": {"surface_fraction": [0.01, 0.03]}}
    done = fakir.sweep(study)
    axes = fakir.plot.critical_curves(done)
    forces = axes[0].lines[0].get_ydata()
    assert forces[1] == system.transition().normalized.force
    several = {**study, "axes": {**study["axes"], "pattern.offset": [0.0, 0.5]}}
    lines = fakir.plot.critical_curves(fakir.sweep(several))[0].lines
    assert [line.get_label() for line in lines] == ["offset 0", "offset 0.5"]
    assert np.array_equal(lines[0].get_ydata(), forces)
    assert fakir.plot.critical_curves({"offset 0": [system.transition()]})[0].get_legend()
    diagram = fakir.plot.phase_diagram(system, [system.transition()], [system.approach("2 um")])
    assert diagram.has_data()
    # The floor is reached farther from the axis than a lone pillar is wide, but the radius is one and the same.
    thin = system.replace({"pattern.surface_fraction": "0.1 %"})
    alone = fakir.plot.phase_diagram(thin, [thin.transition()], [thin.approach("1 um")])
    path, point = (line for line in alone.lines if line.get_marker() in (".", "o"))
    assert path.get_xdata()[-1] == pytest.approx(point.get_xdata()[0], rel=1e-6)
    assert alone.get_xlim()[0] < point.get_xdata()[0]


def test_states_without_pillars(system):
    with pytest.raises(ValueError, match="no pillars to show"):
        fakir.plot.pressure_map(system.transition("homogenised"))


@pytest.fixture(scope="module")
def surface():
    return fakir.System.from_file(
        EXAMPLES / "square-pillars.toml", overrides={"surface.grid.cells_per_diameter": 8}
    )


@pytest.mark.parametrize("name", ["pressure_map", "gap_map"])
def test_a_contact_on_cells(surface, name):
    critical = surface.transition()
    axes = plt.figure().subplots()
    draw = getattr(fakir.plot, name)
    assert draw(critical, axes) is axes
    assert axes.has_data()
    reach = axes.get_xlim()[1]
    assert 1e6 * critical.contact.contact_radius < reach < 81
    assert draw(critical.contact).get_xlim()[1] == reach


def test_nothing_to_show_on_cells(surface):
    untouched = surface.press(force=0.0)
    with pytest.raises(ValueError, match="nothing is in contact"):
        fakir.plot.pressure_map(untouched)


def test_a_rigid_plate_is_flat_in_section():
    overrides = {
        "surface.grid.cells_per_diameter": 8,
        "surface.grid.width": "40 um",
        "surface.boundary": "periodic",
        "surface.indenter": "plate",
        "lens.young_modulus": "1e9 GPa",
    }
    plate = fakir.System.from_file(EXAMPLES / "square-pillars.toml", overrides=overrides)
    contact = plate.press(force="30 uN")
    (axes,) = fakir.plot.profiles(contact)
    outline = axes.lines[0].get_ydata()
    level = 1e6 * (0.5e-6 - contact.indentation)
    assert np.allclose(outline, level, atol=1e-6 * 1e6 * contact.indentation)
    assert len(fakir.plot.profiles([contact, contact])) == 2


def test_loadings(system, surface):
    for loading in [
        system.approach("2 um"),
        system.approach("2 um", to="6 um"),
        system.replace({"floor.contact": False}).approach("2 um", to="6 um"),
        surface.approach("1 um", to="3 um"),
    ]:
        force, radius = fakir.plot.approach(loading)
        assert force.has_data() and radius.has_data()
        labels = [line.get_label() for line in force.lines]
        assert "critical state" in labels
        borne = [row["floor_force_N"] for row in loading.to_dict()["states"]]
        assert ("floor force" in labels) == any(borne)
        assert ("floor contact ignored" in labels) == (None in borne)


def test_a_cycle_shows_its_branches_and_its_pull_off():
    few = {"pattern.surface_fraction": 0.01}
    cycle = fakir.System.from_file(EXAMPLES / "adhesive.toml", overrides=few).cycle()
    axes = fakir.plot.cycle(cycle)
    assert len(axes) == 3 and all(axis.has_data() for axis in axes)
    names = [line.get_label() for line in axes[0].lines]
    assert names == ["loading", "unloading", "attachment", "detachment", "critical state", "pull-off"]
    assert axes[0].lines[-1].get_ydata()[0] == 1e6 * cycle.pull_off.force
    # The range of the second chart is symmetric about zero, so that the tension is visible.
    low, high = axes[1].get_ylim()
    assert low < 1e6 * cycle.pull_off.force and high == -low
    assert fakir.plot.cycle(cycle, plt.figure().subplots(3))[0] is not axes[0]
    loaded = fakir.System.from_file(EXAMPLES / "adhesive.toml", overrides=few).cycle(retract=False)
    assert fakir.plot.cycle(loaded)[0].has_data()


def test_cycles_of_a_sweep_have_a_curve_for_every_work_of_adhesion(system):
    study = {
        "system": system,
        "study": {"question": "cycle"},
        "axes": {"surface_fraction": [0.003, 0.006], "adhesion.work": ["10 mJ/m2", "50 mJ/m2"]},
    }
    done = fakir.sweep(study)
    axes = fakir.plot.pull_off_curves(done)
    assert len(axes) == 4
    assert [len(axis.lines) for axis in axes] == [2, 2, 2, 2]
    assert axes[0].lines[0].get_ydata()[1] == -1e6 * done.rows[2]["pull_off_force_N"]
    with pytest.raises(ValueError, match="these are no cycles"):
        fakir.plot.pull_off_curves(fakir.sweep({**study, "study": {"question": "transition"}}))
    with pytest.raises(ValueError, match="these are no critical states"):
        fakir.plot.critical_curves(done)
