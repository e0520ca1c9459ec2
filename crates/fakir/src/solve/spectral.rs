//! The spectral method and the punch lattice: sites, starts and growth around [`Newton`](super::newton::Newton).

use super::newton::{Degrees, Newton, Outcome, Purpose};
use super::outside::farthest_entered;
use super::rules::unilateral::PillarTop;
use crate::halfspace::coupling::lattice::{memory_estimate, memory_estimate_of_sites};
use crate::halfspace::coupling::pair::PairCoupling;
use crate::halfspace::coupling::sites::Sites;
use crate::halfspace::coupling::window::Window;
use crate::halfspace::disc::basis::mode_count;
use crate::halfspace::disc::nodes::Resolution;
use crate::problem::pillar_field::{ListedPillar, PillarField};
use crate::problem::scaled::{SMALL_LENS, Scene};
use crate::problem::{Accuracy, HexagonalLattice, Load, PunchForm};
use crate::state::{Run, SolveError, Stage, Termination};

/// Degrees for an accuracy: of the coupling, which must be higher the denser the pattern and the more the lens differs from a paraboloid
/// over a pillar top, and of the nodes on partially touched pillars.
pub(crate) fn degrees(accuracy: Accuracy, scene: &Scene) -> Degrees {
    // Errors of degree p are proportional to pitch^-(2p + 2); at p = 2 they are 3e-7 for phi = 0.2, where the pitch is 4.26 pillar radii.
    // For discs of different radii the gap relative to the smaller radius matters.
    let pitch = 2.0 + scene.field.least_gap();
    let small_lens = scene.lens.quadratic_radius() < SMALL_LENS;
    let layered = |degree: usize, accurate: usize| {
        // Errors of degree p due to a layer as thick as the diameter are 3e-6 at p = 2; for a layer half as thick they are 2e-5 at p = 4.
        let [largest, _] = scene.field.bounds();
        let thicknesses = scene.layers.iter().map(|layer| layer.thickness / largest);
        let diameters = thicknesses.map(|thickness| 0.5 * thickness);
        match diameters.fold(f64::INFINITY, f64::min) {
            thick if thick >= 1.0 => degree,
            half if half >= 0.5 => degree.max(4 + accurate),
            _ => degree.max(8),
        }
    };
    match accuracy {
        Accuracy::Default => Degrees {
            coupling: layered(if pitch > 3.9 && !small_lens { 2 } else { 4 }, 0),
            tops: Resolution {
                nodes: 8,
                turn: 0.0,
                rings: 10,
            },
        },
        Accuracy::Accurate => Degrees {
            coupling: layered(if pitch > 3.0 && !small_lens { 4 } else { 6 }, 2),
            tops: Resolution {
                nodes: 32,
                turn: 0.0,
                rings: 20,
            },
        },
    }
}

/// A solution with its convergence history.
pub(crate) struct Solution<'a> {
    pub(crate) newton: Newton<'a>,
    pub(crate) outcome: Outcome,
    /// Newton steps of all stages.
    pub(crate) steps: usize,
}

/// Number of touched pillars above which narrow contacts along rims are treated by the nodes: their fraction of the force is then
/// negligible.
const FEW_PILLARS: usize = 20;

/// For pillars that are touched at their centre or not at all.
const CENTRES: Resolution = Resolution::of_nodes(0);

/// Solves the punch lattice, in which pillars are touched completely or not at all.
pub(crate) fn solve_punch<'a>(
    scene: &Scene,
    target: Load,
    contact_radius: Option<f64>,
    form: PunchForm,
    purpose: Purpose,
    run: &'a Run<'a>,
) -> Result<Solution<'a>, SolveError> {
    let pitch = scene.field.spacing();
    let mut contact = contact_radius.unwrap_or_else(|| rough_contact_radius(scene, target));
    let mut radius = 1.05 * contact + 1.5 * pitch + 1.0;
    let mut entered = entered_at(scene, target);
    let pair = match form {
        PunchForm::Plain => PairCoupling::of_flat_punches(),
        PunchForm::Corrected => PairCoupling::new(0),
    };
    let pair = pair.on_layers_of(scene);
    let mut steps = 0;
    loop {
        let radius_used = limited(scene, radius);
        let sites = checked_sites(scene, radius_used, 1, run)?;
        let top = PillarTop::shared(CENTRES, 0, sites.common_body().column);
        let mut newton = Newton::new(scene, run, Stage::Punch, sites, &pair, top);
        if form == PunchForm::Plain {
            newton.load_at_centres();
        }
        match entered.take() {
            Some(indentation) => newton.tops.touch_entered(indentation),
            None => newton.tops.touch_within(contact),
        }
        let outcome = newton.solve(target, purpose)?;
        steps += outcome.steps;
        match growth(&newton)? {
            Some(larger) => (radius, contact) = (larger, newton.tops.reach()),
            None => {
                return Ok(Solution {
                    newton,
                    outcome,
                    steps,
                });
            }
        }
    }
}

/// Solves the full problem, starting from the corrected punch lattice.
pub(crate) fn solve_spectral<'a>(
    scene: &Scene,
    target: Load,
    punch: Solution<'a>,
    mut degrees: Degrees,
    run: &'a Run<'a>,
) -> Result<Solution<'a>, SolveError> {
    let mut steps = punch.steps;
    let mut coarse = punch.newton;
    let mut pair = PairCoupling::of_scene(degrees.coupling, scene);
    let mut radius = coarse.tops.reach() + 1.5 * scene.field.spacing();
    loop {
        // Release the coupling before the one with more modes is allocated.
        coarse.release_coupling();
        let modes = mode_count(degrees.coupling);
        let sites = checked_sites(scene, limited(scene, radius), modes, run)?;
        let mut tops = degrees.tops;
        if coarse.touched() > FEW_PILLARS {
            tops.rings = 0;
        }
        let top = PillarTop::shared(tops, degrees.coupling, sites.common_body().column);
        let mut newton = Newton::new(scene, run, Stage::Spectral, sites, &pair, top);
        newton.start_from(&coarse);
        // Release its vectors.
        drop(coarse);
        let outcome = newton.solve(target, Purpose::Answer)?;
        steps += outcome.steps;
        if let Some(larger) = growth(&newton)? {
            radius = larger;
        } else if newton.touched() <= FEW_PILLARS && newton.has_marginal_pillars() {
            degrees.coupling += 2;
            pair = PairCoupling::of_scene(degrees.coupling, scene);
        } else {
            return Ok(Solution {
                newton,
                outcome,
                steps,
            });
        }
        coarse = newton;
    }
}

/// A rough estimate of the contact radius.
pub(crate) fn rough_contact_radius(scene: &Scene, target: Load) -> f64 {
    let lens = &scene.lens;
    if !lens.is_axisymmetric() {
        // All pillars there are.
        return scene.field.extent().unwrap_or(scene.field.spacing());
    }
    if let Some(radius) = lens.radius() {
        return radius_under_paraboloid(scene, radius, target);
    }
    // That of a paraboloid as high at the end of the contact, which is found by halving: a contact grows with the radius of that.
    let (mut low, mut high) = (0.0, lens.widest());
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if radius_under_paraboloid(scene, lens.radius_through(middle), target) > middle {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

/// Number of bisection steps of the estimate.
const HALVINGS: usize = 30;

/// [`rough_contact_radius`] under a sphere or a paraboloid of this radius.
fn radius_under_paraboloid(scene: &Scene, lens: f64, target: Load) -> f64 {
    let pitch = scene.field.spacing();
    match target {
        // Half the area in which the undeformed lens penetrates pillar tops, as in Hertz's contact.
        Load::Indentation(indentation) => {
            let depth = if indentation > 0.0 {
                indentation
            } else {
                indentation - scene.first_touch()
            };
            (depth.max(0.0).min(lens) * lens).sqrt()
        }
        Load::Force(force) => {
            // The larger of Hertz's radius and that on independent pillars.
            let hertz = (0.75 * lens * force).cbrt();
            let cell = scene.field.cell_area();
            let layer = 0.5 * cell * (1.0 + scene.field.column().shortening);
            let springs = (4.0 * lens * layer * force / std::f64::consts::PI).powf(0.25);
            hertz.max(springs)
        }
        // The paper's a_c = e sqrt(1 + (k phi)^2), which is e sqrt(1 + (R h/e^2)^2).
        Load::FloorContact => pitch.hypot(lens * scene.height / pitch),
    }
}

/// Approximate indentation at which a lens that is not axisymmetric penetrates the pillars touched in the end; `None` for axisymmetric
/// lenses, which touch the pillars closest to their axis.
fn entered_at(scene: &Scene, target: Load) -> Option<f64> {
    let extent = scene
        .field
        .extent()
        .filter(|_| !scene.lens.is_axisymmetric())?;
    Some(match target {
        Load::Indentation(indentation) => indentation,
        Load::FloorContact => 2.0 * scene.height,
        Load::Force(force) => {
            // The indentation at which non-interacting pillars carry the same force: it increases with the force and is found by bisection.
            let (pillars, _) = scene.field.listed_within(extent);
            let springs: Vec<[f64; 2]> = pillars
                .iter()
                .map(|(_, ListedPillar { centre, body })| {
                    let stiffness = 2.0 * body.radius / (1.0 + body.column.shortening);
                    let touched_at = scene.lens.sag_with_brim(*centre) - body.raised;
                    [stiffness, touched_at]
                })
                .collect();
            let carried = |indentation: f64| -> f64 {
                let one = |[stiffness, touched_at]: &[f64; 2]| {
                    stiffness * (indentation - touched_at).max(0.0)
                };
                springs.iter().map(one).sum()
            };
            let first = scene.first_touch();
            let mut high = scene.height;
            while high < f64::MAX && carried(first + high) < force {
                high *= 2.0;
            }
            let mut low = 0.0;
            for _ in 0..HALVINGS {
                let middle = 0.5 * (low + high);
                if carried(first + middle) < force {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            first + high
        }
    })
}

/// Limits a radius to that of the largest contact that is solved.
pub(super) fn limited(scene: &Scene, radius: f64) -> f64 {
    if !scene.lens.is_axisymmetric() {
        return radius;
    }
    radius.min(scene.lens.largest_contact() + 2.0 * scene.field.spacing())
}

/// The window of a radius, if it fits in the memory limit.
pub(crate) fn checked_window(
    lattice: &HexagonalLattice,
    radius: f64,
    modes: usize,
    run: &Run<'_>,
) -> Result<Window, SolveError> {
    let pillars = Window::expected_len(lattice, radius);
    check_memory(pillars, memory_estimate(pillars, modes), run)?;
    Ok(Window::new(lattice, radius))
}

fn check_memory(pillars: f64, bytes: f64, run: &Run<'_>) -> Result<(), SolveError> {
    let limit = run.memory_limit();
    if bytes > limit as f64 {
        return Err(SolveError::TooLarge {
            pillars: pillars as usize,
            bytes: bytes as usize,
            limit,
        });
    }
    Ok(())
}

/// The sites of a radius, if they fit in the memory limit.
pub(crate) fn checked_sites(
    scene: &Scene,
    radius: f64,
    modes: usize,
    run: &Run<'_>,
) -> Result<Sites, SolveError> {
    if let PillarField::Hexagonal {
        lattice, column, ..
    } = &scene.field
    {
        let window = checked_window(lattice, radius, modes, run)?;
        return Ok(Sites::of_window(window, *lattice, *column));
    }
    // Memory is needed for the pillars before their arrangement is determined; this is a lower bound.
    let pillars = scene.field.expected_len(radius);
    check_memory(pillars, 8.0 * pillars * modes as f64, run)?;
    let sites = Sites::within(&scene.field, radius);
    check_memory(
        sites.len() as f64,
        memory_estimate_of_sites(&sites, modes, !scene.layers.is_empty()),
        run,
    )?;
    Ok(sites)
}

/// More sites if the contact is close to the edge of the current ones.
pub(crate) fn wider_sites(newton: &Newton<'_>, run: &Run<'_>) -> Result<Option<Sites>, SolveError> {
    let Some(radius) = growth(newton)? else {
        return Ok(None);
    };
    let scene = &newton.scene;
    checked_sites(scene, limited(scene, radius), newton.contact.modes(), run).map(Some)
}

/// A state without contact, with a window of pillars for this contact radius.
pub(crate) fn untouched<'a>(
    scene: &Scene,
    indentation: f64,
    contact_radius: f64,
    degrees: Degrees,
    run: &'a Run<'a>,
) -> Result<Solution<'a>, SolveError> {
    let pair = PairCoupling::of_scene(degrees.coupling, scene);
    let radius = limited(scene, contact_radius + 1.5 * scene.field.spacing() + 1.0);
    let sites = checked_sites(scene, radius, mode_count(degrees.coupling), run)?;
    let kappa = sites.common_body().column;
    let top = PillarTop::shared(degrees.tops, degrees.coupling, kappa);
    let mut newton = Newton::new(scene, run, Stage::Spectral, sites, &pair, top);
    newton.contact.move_to(indentation);
    let outcome = Outcome {
        indentation,
        termination: Termination::Converged,
        steps: 0,
        floor: None,
        mismatch: 0.0,
    };
    Ok(Solution {
        newton,
        outcome,
        steps: 0,
    })
}

/// The error for a contact that extends too far from the lowest point of the lens.
pub(crate) fn exceeds_lens(scene: &Scene, reach: f64) -> SolveError {
    SolveError::beyond(&scene.lens, reach, scene.length)
}

/// A larger radius if the contact is close to the edge of the sites, or if the lens penetrates a pillar beyond.
fn growth(newton: &Newton<'_>) -> Result<Option<f64>, SolveError> {
    let scene = &newton.scene;
    let reach = newton.tops.reach();
    check_contact(scene, newton.tops.reach_from_lowest())?;
    let radius = newton.tops.sites.radius();
    let pitch = scene.field.spacing();
    if reach + pitch > radius {
        return Ok(Some((1.3 * radius).max(reach + 2.0 * pitch)));
    }
    let indentation = newton.contact.indentation();
    let entered = farthest_entered(scene, radius, indentation, &newton.forces());
    if let Some(distance) = entered {
        check_contact(scene, distance)?;
    }
    Ok(entered.map(|distance| distance + pitch))
}

/// Returns an error if a pillar at a distance from the lens axis is beyond the largest contact that is solved.
pub(super) fn check_contact(scene: &Scene, distance: f64) -> Result<(), SolveError> {
    if distance - 1.0 > scene.lens.largest_contact() {
        return Err(exceeds_lens(scene, distance));
    }
    Ok(())
}

#[cfg(test)]
mod arrangements;
#[cfg(test)]
mod tests {
    use super::*;
    use crate::halfspace::coupling::direct::DirectCoupling;
    use crate::halfspace::coupling::lattice::LatticeCoupling;
    use crate::halfspace::coupling::on_grid::GridCoupling;
    use crate::numerics::convergence::Judgement;
    use crate::numerics::neighbours::tests::random_discs;
    use crate::problem::pillar_field::{PillarBody, PillarList};
    use crate::problem::{Lens, Material};
    use crate::solve::linearized::{LinearizedContact, Source};
    use crate::solve::rules::groups::{GroupedTops, Groups};
    use crate::solve::rules::tops::Tops;
    use std::sync::Arc;

    /// A plate on many pillars of several radii at random positions, some of which are close to each other.
    fn scene(count: usize, gap: f64) -> Scene {
        let pillar = |(centre, radius)| ListedPillar {
            centre,
            body: PillarBody {
                radius,
                ..PillarBody::of_column(0.0)
            },
        };
        let pillars = random_discs(count, 0.2, gap, 5).into_iter().map(pillar);
        Scene {
            layers: Vec::new(),
            lens: Lens {
                radius: f64::INFINITY,
                material: Material::new(1.0, 0.5),
            }
            .into(),
            height: 1.0,
            field: PillarField::Listed(Arc::new(PillarList::new(pillars.collect()).unwrap())),
            length: 1.0,
            pressure: 1.0,
            rotation: 0.0,
        }
    }

    /// Force at unit indentation, and the number of products that it took, with one type of coupling, with or without groups of pillars.
    fn stiffness(
        scene: &Scene,
        degree: usize,
        on_grid: bool,
        grouped: bool,
        run: &Run<'_>,
    ) -> (f64, usize) {
        let sites = Sites::within(&scene.field, f64::INFINITY);
        let (pair, workers) = (PairCoupling::new(degree), run.workers());
        let radius = |pillar: usize| sites.body(pillar).radius;
        let coupling = if on_grid {
            LatticeCoupling::Grid(Box::new(GridCoupling::new(&sites, &pair, workers).unwrap()))
        } else {
            let direct = DirectCoupling::new(sites.centres(), radius, &pair, workers);
            LatticeCoupling::Direct(direct)
        };
        let top = PillarTop::shared(Resolution::of_nodes(8), degree, 0.0);
        let mut tops = Tops::new(&scene.lens, sites, top, degree);
        tops.touch_within(f64::INFINITY);
        let own_load = vec![0.0; tops.sites.len() * mode_count(degree)];
        let mut contact = LinearizedContact::new(run, coupling, mode_count(degree), own_load);
        let mut groups = grouped.then(|| Groups::new(&tops, workers).unwrap());
        let mut places = GroupedTops::new(&tops, groups.as_mut());
        let solved = contact.solve(&mut places, Source::Unit, 1e-11).unwrap();
        assert_eq!(solved, Judgement::Good);
        (contact.stiffness(), contact.products())
    }

    #[test]
    fn critical_state_on_a_compressible_film() {
        // tests/reference/layer.csv: there, the Poisson's ratio of 0.45 applies only to the response of the layer.
        use crate::halfspace::layer::tests::rows;
        let mut scene = Scene::new(&crate::theory::reference::intermediate(0.03));
        scene.layers = vec![crate::problem::layer::WeightedLayer {
            weight: 0.5,
            thickness: 100.0 / 3.0,
            poisson_ratio: 0.45,
            base: crate::problem::layer::LayerBase::Bonded {
                shear_ratio: 0.0,
                poisson_ratio: 0.0,
            },
        }];
        let run = Run::default();
        let target = Load::FloorContact;
        let form = PunchForm::Corrected;
        for (accuracy, tolerance) in [(Accuracy::Default, 1e-4), (Accuracy::Accurate, 5e-5)] {
            let punch = solve_punch(&scene, target, None, form, Purpose::Start, &run).unwrap();
            let solution =
                solve_spectral(&scene, target, punch, degrees(accuracy, &scene), &run).unwrap();
            for (quantity, found) in [
                ("critical F^", 9.0 * solution.newton.force()),
                ("critical zeta", 3.0 * solution.outcome.indentation),
            ] {
                let rows = rows(quantity);
                let (_, value) = rows.iter().find(|row| row.0.contains("bonded.45")).unwrap();
                let difference = found / value - 1.0;
                assert!(difference.abs() < tolerance, "{quantity}: {difference:e}");
            }
        }
    }

    #[test]
    fn forces_on_a_grid_are_those_of_all_pairs() {
        let (scene, run) = (scene(450, 0.05), Run::default());
        let (by_pairs, _) = stiffness(&scene, 4, false, false, &run);
        let (by_grid, alone) = stiffness(&scene, 4, true, false, &run);
        let (in_groups, together) = stiffness(&scene, 4, true, true, &run);
        println!(
            "{:e}, {alone} and {together} products",
            by_grid / by_pairs - 1.0
        );
        // Degrees 3 and 4 are omitted for wide gaps; the effect is far below the error of degree 4 at small gaps.
        assert!((by_grid / by_pairs - 1.0).abs() < 1e-7);
        assert!((in_groups / by_grid - 1.0).abs() < 1e-10);
        // Groups need fewer products.
        assert!(together < alone, "{together} {alone}");
    }

    #[test]
    fn what_takes_too_much_memory_is_refused() {
        let scene = scene(2000, 0.5);
        let run = Run {
            memory_limit: Some(4_000_000),
            ..Run::default()
        };
        let refused = checked_sites(&scene, f64::INFINITY, 6, &run);
        assert!(
            matches!(refused, Err(SolveError::TooLarge { pillars: 2000, bytes, .. })
            if bytes > 8_000_000 && bytes < 40_000_000)
        );
    }
}
