"""Fits and designs on height maps: pillars of square cross-section on cells of boundary elements."""

import pickle
from pathlib import Path

import numpy as np
import pytest

import fakir
from fakir.bem import Surface

CASE = Path(__file__).parents[2] / "examples" / "square-pillars.toml"
COARSE = {"surface.grid.cells_per_diameter": 5}


def test_surfaces_of_case_files_are_sent_to_other_processes():
    surface = fakir.read_case(CASE, COARSE)
    copy = pickle.loads(pickle.dumps(surface))
    assert copy.to_toml() == surface.to_toml() and np.array_equal(copy.heights, surface.heights)
    heights = np.random.default_rng(1).normal(0.0, 1e-7, (16, 16))
    bodies = fakir.Lens("2 mm", "2 MPa", 0.5), fakir.Substrate("2 MPa", 0.5)
    made = Surface(heights, *bodies, cell_size="1 um", periodic=True)
    copy = pickle.loads(pickle.dumps(pickle.loads(pickle.dumps(made))))
    assert copy.periodic and np.array_equal(copy.heights, heights) and np.array_equal(copy.x, made.x)
    assert copy.press(indentation="10 nm").force == made.press(indentation="10 nm").force


def test_units_of_heights():
    heights = np.random.default_rng(1).normal(0.0, 50.0, (16, 16))
    bodies = fakir.Lens("2 mm", "2 MPa", 0.5), fakir.Substrate("2 MPa", 0.5)
    with pytest.raises(ValueError, match="heights differ by .* on a map of 16 um: give them in metres"):
        Surface(heights, *bodies, cell_size="1 um")

    class Topography:
        """As an object of SurfaceTopography without a unit."""

        unit, physical_sizes = None, (16.0, 16.0)

        def heights(self):
            return heights.T

    with pytest.raises(ValueError, match="the topography has no unit"):
        Surface(Topography(), *bodies)
    xarray = pytest.importorskip("xarray")
    in_nm = xarray.DataArray(heights, dims=("y", "x"), attrs={"units": "nm"})
    assert np.allclose(Surface(in_nm, *bodies, cell_size="1 um").heights, 1e-9 * heights)
    with pytest.raises(ValueError, match="V"):
        Surface(in_nm.assign_attrs(units="V"), *bodies, cell_size="1 um")


@pytest.mark.filterwarnings("ignore::fakir.FakirWarning")
def test_a_modulus_is_in_proportion_to_the_forces():
    """On rigid pillars under a glass lens F = E* f(zeta): forces that are 1.5 times larger are those of 1.5 times the modulus."""
    others = {"surface.pillar.compliance": "none", "lens.young_modulus": "70 GPa", "substrate.young_modulus": "1 MPa"}
    surface = fakir.read_case(CASE, COARSE | others)
    indentation = np.linspace(0.2e-6, 1.5e-6, 6)
    force = np.array([1.5 * surface.press(indentation=float(value)).force for value in indentation])
    found = fakir.fit({"indentation_m": indentation, "force_N": force}, surface, ["substrate.young_modulus"])
    assert found.converged and found.parameters["substrate.young_modulus"].value == pytest.approx(1.5e6, rel=2e-3)


@pytest.mark.filterwarnings("ignore::fakir.FakirWarning")
def test_heights_for_a_floor_share():
    """The share of the designed surface is the target to within the error that the value has, by the sensitivity."""
    surface = fakir.read_case(CASE, COARSE)
    found = fakir.design(surface, "surface.pillar.height", floor_share=0.5, at_indentation="2 um")
    assert isinstance(found.system, Surface) and found.relative_error > 0
    again = found.system.press(indentation="2 um")
    share = again.floor.force / again.force
    assert share == pytest.approx(0.5, abs=0.5 * abs(found.sensitivity) * found.relative_error)
    assert found.state.floor.force == pytest.approx(again.floor.force, rel=1e-9)
    with pytest.raises(fakir.SolveError, match="without adhesion"):
        _ = found.cycle


@pytest.mark.filterwarnings("ignore::fakir.FakirWarning")
def test_a_sphere_is_pulled_off_a_flat_map():
    """F = -3/2 pi w R (Johnson, Kendall and Roberts), within the estimated error, and as much as `fakir.FlatSystem` has."""
    lens, substrate = fakir.Lens("0.2 mm", "2 MPa", 0.5), fakir.Substrate("2 MPa", 0.5)
    surface = Surface(np.zeros((64, 64)), lens, substrate, cell_size="2 um", adhesion="50 mJ/m2")
    assert surface.adhesion == fakir.Adhesion(0.05)
    cycle = surface.cycle(to="0.2 um")
    flat = fakir.FlatSystem(lens, substrate, adhesion="50 mJ/m2").cycle(to="0.2 um")
    # A sphere, which is not quite the paraboloid of the closed form.
    assert flat.pull_off_force == pytest.approx(-1.5 * np.pi * 0.05 * 0.2e-3, rel=5e-3)
    assert cycle.pull_off_force == pytest.approx(flat.pull_off_force, rel=cycle.error.pull_off_force)
    assert cycle.turn.pressure_map.min() < 0 < cycle.turn.pressure_map.max()
    assert cycle.pull_off.force == cycle.force.min() == cycle.pull_off_force
    assert len(cycle.to_pandas()) == len(cycle.branch) == len(cycle.contact_area)
    with pytest.raises(ValueError, match="no critical state"):
        surface.cycle()
    with pytest.raises(ValueError, match="floor"):
        Surface(np.zeros((64, 64)), lens, substrate, cell_size="2 um", adhesion=fakir.Adhesion(0.05, floor=True))


@pytest.mark.filterwarnings("ignore::fakir.FakirWarning")
def test_samples_are_solved_again_on_their_cells():
    """Forces on rigid pillars under a lens that is nearly rigid are in proportion to the modulus of the sample (F = E* f, with 1/E* = sum (1 - nu^2)/E)."""
    others = {"surface.pillar.compliance": "none", "lens.young_modulus": "70 GPa", "surface.pillar.height": "0.2 um"}
    surface = fakir.read_case(CASE, {"surface.grid.cells_per_diameter": 8} | others)
    force = surface.transition().force
    found = fakir.spread(surface, {"substrate.young_modulus": "10 %"}, samples=3, landing="as_given")
    moduli = found.to_pandas()["substrate.young_modulus_Pa"].to_numpy()
    assert found.force == pytest.approx(force * moduli / 2e6, rel=1e-4)
    of_mean, of_deviation = found.errors()
    assert of_mean > 0 and of_deviation / np.std(found.force, ddof=1) == pytest.approx(of_mean / np.mean(found.force), rel=1e-3)
    assert "errors of cells" in str(found) and found.first_order is None
    with pytest.raises(fakir.DesignError, match=r"have surface\.pillar\.height"):
        fakir.spread(surface, {"pattern.pillar.height": "5 %"}, samples=3)
