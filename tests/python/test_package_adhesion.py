"""Loading and unloading of pillar tops that stick, as the command line tells it."""

import fakir
import numpy as np
import pytest
from conftest import EXAMPLES
from test_package_results import program, without_times

CASE = "adhesive.toml"


@pytest.fixture(scope="module")
def system():
    return fakir.System.from_file(EXAMPLES / CASE)


@pytest.fixture(scope="module")
def cycle(system):
    return system.cycle()


def test_a_cycle_is_what_the_program_says(cycle):
    expected = program("approach", CASE, {}, "--retract")
    assert without_times(cycle.to_dict()) == without_times(expected)
    assert cycle.events == expected["events"]
    assert cycle.force.tolist() == [station["force_N"] for station in expected["stations"]]
    assert cycle.pull_off.force == expected["pull_off_force_N"]
    assert cycle.pull_off.indentation == expected["pull_off_indentation_m"]
    assert cycle.hysteresis == expected["hysteresis_J"]
    assert cycle.last_release_indentation == expected["last_release_indentation_m"]
    assert cycle.critical.force == expected["critical_force_N"]
    assert "pull-off" in repr(cycle) and "<table>" in cycle._repr_html_()


def test_the_curve_holds_the_pull_off_and_the_hysteresis(cycle):
    """The force is linear between stations: the loop is a sum of trapezia, the largest pull a station."""
    assert cycle.force[cycle.unloading].min() == cycle.pull_off.force
    assert cycle.pull_off.pillars["force_N"].sum() == pytest.approx(cycle.pull_off.force, rel=1e-6)
    loop = np.sum(0.5 * (cycle.force[1:] + cycle.force[:-1]) * np.diff(cycle.indentation))
    assert loop == pytest.approx(cycle.hysteresis, rel=1e-6)
    assert cycle.certificate < 1e-4
    # The model has an error of its own, which is larger than the numerical one.
    assert cycle.pull_off.error.model > cycle.pull_off.error.numerical > 0.0


def test_adhesion_is_part_of_a_system(system):
    assert system.adhesion == fakir.Adhesion("50 mJ/m2")
    parts = system.lens, system.substrate, system.texture
    for adhesion in ["50 mJ/m2", 0.05, "50 mN/m", fakir.Adhesion(0.05)]:
        assert fakir.System(*parts, adhesion=adhesion).adhesion == fakir.Adhesion(0.05)
    assert fakir.System(*parts).adhesion is None
    receding = fakir.System(*parts, adhesion=fakir.Adhesion(0.05, "80 mJ/m2"))
    assert receding.adhesion.work_receding == 0.08
    assert "80 mJ/m2 to part" in repr(receding)
    with pytest.raises(fakir.CaseError) as refused:
        fakir.System(*parts, adhesion=-0.05)
    assert refused.value.key == "adhesion.work"
    with pytest.raises(fakir.CaseError) as refused:
        fakir.System(*parts, adhesion=fakir.Adhesion(0.05, 0.04))
    assert refused.value.key == "adhesion.work_receding"
    with pytest.raises(ValueError, match="unit of force, not of energy per area"):
        fakir.Adhesion("50 mN")


def test_what_drives_the_lens(system, cycle):
    for drive in [
        {"drive": "force"},
        {"drive": "machine", "machine_stiffness": "20 N/m"},
    ]:
        other = system.cycle(**drive)
        assert other.to_dict()["drive"] == drive["drive"]
        assert other.pull_off.force == pytest.approx(cycle.pull_off.force, rel=1e-6)
    with pytest.raises(TypeError, match="go together"):
        system.cycle(drive="machine")
    with pytest.raises(ValueError, match="no drive"):
        system.cycle(drive="hand")
    with pytest.raises(TypeError, match="one end"):
        system.cycle(to="1 um", to_force="1 uN")


def test_a_cycle_turns_where_it_is_told_to(system):
    shorter = system.cycle(to="2 um", retract=False)
    assert shorter.turn_indentation == pytest.approx(2e-6, rel=1e-6)
    assert shorter.critical is None and shorter.pull_off is None
    assert shorter.hysteresis is None and not shorter.unloading.any()
    without = system.replace({"adhesion.work": 0})
    with pytest.raises(fakir.SolveError, match="without adhesion"):
        without.cycle()
