"""Loading and unloading with adhesive pillar tops; same results as the command line."""

from concurrent.futures import ThreadPoolExecutor

import fakir
import numpy as np
import pytest
from conftest import EXAMPLES
from fakir import theory
from test_package_results import program, without_times

CASE = "adhesive.toml"


@pytest.fixture(scope="module")
def system():
    return fakir.System.from_file(EXAMPLES / CASE)


@pytest.fixture(scope="module")
def cycle(system):
    return system.cycle()


def test_a_cycle_agrees_with_the_command(cycle):
    expected = program("cycle", CASE, {})
    assert without_times(cycle.to_dict()) == without_times(expected)
    assert cycle.events == expected["events"]
    assert cycle.force.tolist() == [station["force_N"] for station in expected["stations"]]
    assert cycle.pull_off.force == expected["pull_off_force_N"]
    assert cycle.pull_off.indentation == expected["pull_off_indentation_m"]
    assert cycle.hysteresis == expected["hysteresis_J"]
    assert cycle.last_release_indentation == expected["last_release_indentation_m"]
    assert cycle.critical.force == expected["critical_force_N"]
    assert "pull-off" in repr(cycle) and "<table>" in cycle._repr_html_()


def test_the_curve_contains_the_pull_off_and_the_hysteresis(cycle):
    """The force is linear between load steps: the loop is a sum of trapezia, the pull-off is at a load step."""
    assert cycle.force[cycle.unloading].min() == cycle.pull_off.force
    assert cycle.pull_off.pillars["force_N"].sum() == pytest.approx(cycle.pull_off.force, rel=1e-6)
    loop = np.sum(0.5 * (cycle.force[1:] + cycle.force[:-1]) * np.diff(cycle.indentation))
    assert loop == pytest.approx(cycle.hysteresis, rel=1e-6)
    assert cycle.certificate < 1e-4
    # The model error is separate, and larger than the numerical one.
    assert cycle.pull_off.error.model > cycle.pull_off.error.numerical > 0.0


def test_adhesion_is_part_of_a_system(system):
    assert system.adhesion == fakir.Adhesion("50 mJ/m2")
    parts = system.lens, system.substrate, system.pattern
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


def test_an_adhesive_floor_is_part_of_a_system(system):
    parts = system.lens, system.substrate, system.pattern
    adhesive = fakir.System(*parts, adhesion=fakir.Adhesion("10 mJ/m2", floor=True))
    assert adhesive.adhesion == fakir.Adhesion(0.01, floor=True)
    assert "of the floor too" in repr(adhesive)
    assert not system.adhesion.floor
    with pytest.raises(fakir.CaseError) as refused:
        fakir.System(*parts, adhesion=fakir.Adhesion(0.01, floor=True), floor_contact=False)
    assert refused.value.key == "adhesion.floor"
    # Loading ends before the floor: nothing of it is in contact.
    assert adhesive.cycle(to="0.5 um").floor is None


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


def test_a_cycle_has_the_given_unloading_point(system):
    shorter = system.cycle(to="2 um", retract=False)
    assert shorter.turn_indentation == pytest.approx(2e-6, rel=1e-6)
    assert shorter.critical is None and shorter.pull_off is None
    assert shorter.hysteresis is None and not shorter.unloading.any()
    without = system.replace({"adhesion.work": 0})
    with pytest.raises(fakir.SolveError, match="without adhesion"):
        without.cycle()


def test_closed_forms_of_adhesion_are_those_of_the_program(system):
    found = theory.adhesion(system, attraction_range="5 nm")
    expected = program("theory", CASE, {}, "--attraction-range", "5nm")["adhesion"]
    assert found.tabor_number == expected["tabor_number"]
    assert found.kendall_strain == expected["kendall_strain"]
    forces = {row["formula"]: row["force_N"] for row in expected["pull_off"]}
    assert {name: form.force for name, form in found.pull_off.items()} == forces
    assert theory.to_dict(system, "5 nm")["adhesion"] == expected
    assert theory.adhesion(system).tabor_number is None
    with pytest.raises(ValueError, match="no adhesion"):
        theory.adhesion(system.replace({"adhesion.work": 0}))
    with pytest.raises(ValueError, match="range of the attraction"):
        theory.adhesion(system, attraction_range=0.0)


def test_a_sweep_of_cycles_is_that_of_single_ones(system):
    study = {
        "system": system,
        "study": {"question": "cycle"},
        "axes": {"surface_fraction": [0.003, 0.006], "adhesion.work": ["10 mJ/m2", "50 mJ/m2"]},
    }
    found = fakir.sweep(study)
    assert len(found) == 4 and not found.failed
    with ThreadPoolExecutor(2) as pool:
        assert fakir.sweep(study, pool).to_csv() == found.to_csv()
    row = found.rows[3]
    alone = system.replace({"pattern.surface_fraction": 0.006}).cycle()
    assert row["pull_off_force_N"] == alone.pull_off.force
    assert row["hysteresis_J"] == alone.hysteresis
    assert row["relative_model_error_pull_off_force"] == alone.pull_off.error.model


def test_pull_off_scatters_with_the_work_of_adhesion(system):
    few = system.replace({"pattern.surface_fraction": 0.003})
    spread = fakir.spread(few, {"adhesion.work": "20 %"}, samples=5, landing="as_given")
    assert (spread.pull_off_force < 0.0).all() and (spread.hysteresis > 0.0).all()
    assert "pull-off force" in repr(spread)
    plain = few.replace({"adhesion.work": 0})
    spread = fakir.spread(plain, {"pattern.pillar.height": "2 %"}, samples=3)
    assert spread.pull_off_force is None and spread.hysteresis is None


def test_elements_give_a_second_opinion_on_adhesion(system):
    few = system.replace({"pattern.surface_fraction": 0.1, "lens.radius": "0.5 mm"})
    found = few.verify(indentation="0.3 um")
    assert found.agrees and abs(found.contact_area.relative) < found.contact_area.allowed < 0.2
    assert "difference in contact area" in str(found)
