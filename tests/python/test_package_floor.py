"""Past the transition: pillar tops and floor together; same results as the command line."""

import pickle
import warnings

import fakir
import numpy as np
import pytest
from conftest import EXAMPLES
from test_package_results import program, without_times

CASE = "paper-intermediate.toml"
OVERRIDES = {"pattern.surface_fraction": 0.01}


@pytest.fixture(scope="module")
def system():
    return fakir.System.from_file(EXAMPLES / CASE, overrides=OVERRIDES)


@pytest.fixture(scope="module")
def state(system):
    # Warnings are errors: with the floor nothing is wrong past the transition.
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return system.press(indentation="4 um")


def test_the_load_of_the_floor_agrees_with_the_command(state):
    expected = program("press", CASE, OVERRIDES, "--indentation", "4um")
    assert without_times(state.to_dict()) == without_times(expected)
    floor = state.floor
    assert floor.to_dict() == expected["floor"]
    assert state.beyond_transition
    assert floor.force == expected["floor"]["force_N"]
    assert floor.share == pytest.approx(floor.force / state.force, rel=1e-12)
    assert floor.contact_area == expected["floor"]["contact_area_m2"]
    assert floor.radius == expected["floor"]["radius_m"]
    assert floor.smallest_distance_to_rim == expected["floor"]["smallest_distance_to_rim_m"]
    assert floor.patches == expected["floor"]["patches"]
    assert list(floor.cell) == expected["floor"]["cell_m"]
    assert floor.error._asdict() == expected["floor"]["relative_error_estimate"]
    assert "fraction on the floor" in repr(floor) and "fraction on the floor" in repr(state)
    assert "<table>" in floor._repr_html_()


def test_the_cells_of_the_floor_carry_its_force(state):
    floor = state.floor
    width, height = floor.cell
    assert width * height * floor.pressure.sum() == pytest.approx(floor.force, rel=1e-9)
    assert not state.on_pillar(floor.x, floor.y).any()
    # The farthest corner of a cell is at most half its diagonal from the centre.
    farthest = np.hypot(floor.x, floor.y).max()
    assert 0.0 <= floor.radius - farthest <= np.hypot(width, height)
    with pytest.raises(ValueError, match="read-only"):
        floor.pressure[0] = 0.0


def test_fields_have_the_floor_in_them(state):
    floor = state.floor
    some = slice(None, None, 7)
    x, y = floor.x[some], floor.y[some]
    assert np.allclose(state.pressure(x, y), floor.pressure[some], rtol=1e-12)
    # Gaps are zero up to the resolution of the cells, far below the indentation.
    assert np.abs(state.gap(x, y)).max() < 2e-3 * state.indentation
    data = state.to_xarray(301)
    assert data.attrs["floor_force_N"] == floor.force
    assert data.attrs["floor_share"] == floor.share
    assert data.attrs["floor_contact_area_m2"] == floor.contact_area
    # All of the contact is in the grid, and pressures are means over its cells.
    cell = float(data.x[1] - data.x[0]) * float(data.y[1] - data.y[0])
    assert cell * float(data.pressure.sum()) == pytest.approx(state.force, rel=1e-3)


def test_without_the_floor_the_force_is_smaller(system, state):
    ignored = system.replace({"floor.contact": False})
    with pytest.warns(fakir.FakirWarning, match="as if the floor were not there"):
        through = ignored.press(indentation="4 um")
    assert through.floor is None and through.beyond_transition
    assert through.smallest_floor_gap < 0.0
    assert state.force > through.force > state.force - state.floor.force
    with pytest.warns(fakir.FakirWarning, match="the method punch does not compute the load of the floor"):
        assert system.press(indentation="4 um", method="punch").floor is None
    # Before the transition it makes no difference.
    with_floor, without = system.press(indentation="1 um"), ignored.press(indentation="1 um")
    assert with_floor.floor is None and with_floor.force == without.force


def test_a_system_keeps_whether_there_is_floor_contact(system, tmp_path):
    parts = (system.lens, system.substrate, system.pattern)
    ignored = fakir.System(*parts, floor_contact=False)
    assert fakir.System(*parts).floor_contact and not ignored.floor_contact
    assert ignored != fakir.System(*parts)
    assert "floor" not in repr(system) and "contact ignored" in repr(ignored)
    file = tmp_path / "case.toml"
    file.write_text(ignored.to_toml())
    assert "contact = false" in ignored.to_toml()
    for again in [
        fakir.System.from_file(file),
        fakir.System.from_toml(ignored.to_toml()),
        pickle.loads(pickle.dumps(ignored)),
        fakir.System(*parts).replace({"floor.contact": "false"}),
    ]:
        assert again == ignored and not again.floor_contact
    with pytest.raises(TypeError, match="floor_contact is of type str"):
        fakir.System(*parts, floor_contact="false")


def test_a_loading_continues_through_the_transition(system):
    loading = system.approach("1 um", to="4 um")
    table = loading.to_pandas()
    assert table.indentation_m.iloc[-1] == pytest.approx(4e-6, rel=1e-12)
    assert table.critical.sum() == 1
    before = ~table.beyond_transition | table.critical
    assert (table.floor_force_N[~before] > 0.0).all()
    assert (table.floor_force_N[before] == 0.0).all()
    last = loading[len(loading) - 1]
    assert last.floor.force == table.floor_force_N.iloc[-1]
    assert "on the floor" in repr(loading)
    by_force = system.approach("1 um", to_force=last.force)
    assert by_force[len(by_force) - 1].indentation == pytest.approx(4e-6, rel=1e-4)


def test_a_loading_has_one_end(system):
    with pytest.warns(FutureWarning, match="give the last indentation as to"):
        old = system.approach("2 um", until="4 um", past_transition=True)
    new = system.approach("2 um", to="4 um")
    assert without_times(old.to_dict()) == without_times(new.to_dict())
    with pytest.raises(TypeError, match="one of until, to and to_force"):
        system.approach("2 um", until="4 um", to="4 um")
    with pytest.raises(TypeError, match="past_transition needs until"):
        system.approach("2 um", to="4 um", past_transition=True)
    with pytest.raises(ValueError, match="to_force is 0.0 N: it must be greater than 0"):
        system.approach("2 um", to_force=0.0)
    with pytest.raises(ValueError, match="step is -1.0 m: it must be greater than 0"):
        system.approach(-1.0)


def test_sweeps_have_columns_of_the_floor(system, state):
    study = {
        "study": {"question": "press", "indentation": "4 um"},
        "system": system,
        "axes": {"offset": [0.0, 0.5]},
    }
    table = fakir.sweep(study, threads=1)
    first, second = table.rows
    assert first["floor_force_N"] == state.floor.force
    assert first["floor_share"] == state.floor.share
    assert first["relative_error_estimate_floor_share"] == state.floor.error.share
    assert second["floor_contact_area_m2"] > 0.0
