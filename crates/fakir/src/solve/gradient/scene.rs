//! Derivatives of a solved state with respect to the parameters of its scene, exact as long as no pillar changes its state.
//!
//! With the states linearized, the moments satisfy `A m = b` with a symmetric `A = S + C`; on partially touched tops, within the subspace
//! of moments for which the nodes without pressure stay at zero. A change of the scene that changes the load by `db` and the operator by
//! `dA` therefore changes a result `w·m` by
//!
//! ```text
//! v·(db - dA m),      A v = w.
//! ```
//!
//! The force is `b1·m`, and its `v` is the response `m1` to a unit indentation. The floor is reached where `zeta = h + f(x) + W(x)·m`;
//! since `zeta` is minimal at that `x`, the motion of the point drops out:
//!
//! ```text
//! d zeta_c = (dh + df + dW·m + v·(db - dA m))/(1 - W·m1),      A v = W.
//! ```
//!
//! On layers `C` and `W` depend on these too: the contribution of layers is linear in `Phi - 1`, so that its change is linear in the change
//! of `Phi`.
//!
//! On partially touched tops `m` and `v` include all moments, not only those that act on other pillars, because the lens shape works on all
//! of them. Since `S` is proportional to the inverse radius `1/a`, and constraints do no work, `v·dS m = -v·l da/a` on each top with the
//! total load `l`.
//!
//! If the floor carries load, its cells are places like tops, and both `m` and `v` include their coefficients. The cells move with the
//! distances of the pillars. The product of cell and pillar depends on the ratio of their distance to the radius of the pillar alone, so that
//! its derivative with respect to the logarithm of the radii is that with respect to the distances with the opposite sign; on layers their
//! thickness counts as another length. Derivatives of the products with the floor with respect to distances and layers are differences of
//! two products.
//!
//! A narrow contact at a rim is solved on cells that move with its load `l`. There `dm = (P + E) dl` with the [motion](Motion) `E`, which
//! is not symmetric, and `v = (P + E')(w - C v)`. This is solved by iteration: `E` is of the order of a hundredth of `P`.

use crate::halfspace::coupling::derivative::CouplingChange;
use crate::halfspace::coupling::lattice::LatticeCoupling;
use crate::halfspace::coupling::operator::Coupling;
use crate::halfspace::coupling::pair::PairCoupling;
use crate::halfspace::disc::basis::{TILT_COMPLIANCE, UNIT_FORCE};
use crate::halfspace::disc::exterior::Exterior;
use crate::numerics::convergence::{larger, within};
use crate::numerics::vector::{add_scaled, dot, subtract};
use crate::problem::Point;
use crate::problem::column::Column;
use crate::problem::layer::WeightedLayer;
use crate::solve::floor::{Discs, FloorDisplacement, FloorPoint, LoadedDiscs};
use crate::solve::mixed;
use crate::solve::newton::{FLOOR_LINEAR_TOLERANCE, LINEAR_TOLERANCE, Newton};
use crate::solve::rules::floor::{lens_load, lens_load_by_radius};
use crate::solve::rules::rim::Motion;
use crate::solve::rules::unilateral::LocalSolver;
use crate::state::{PillarStatus, SolveError};
use std::f64::consts::PI;

/// Derivatives of one result, in solver units. Vectors refer to the touched pillars.
#[derive(Debug, Clone)]
pub(crate) struct OfScene {
    /// With respect to the height of every touched pillar, at constant column compliance.
    pub(crate) raised: Vec<f64>,
    /// With respect to the shortening ratio and the tilt of the column of every touched pillar.
    pub(crate) column: Vec<Column>,
    /// With respect to the radius of every touched pillar, at constant column; `None` on a hexagonal lattice, and if the floor carries load.
    pub(crate) radii: Option<Vec<f64>>,
    /// With respect to the logarithm of all radii together, at constant columns; see [`SceneDerivatives::has_distances`].
    pub(crate) all_radii: f64,
    /// With respect to the logarithm of all distances of the pillars from the lens axis; the same.
    pub(crate) distances: f64,
    pub(crate) lens_radius: f64,
    /// With respect to the depth of the floor below the tops, with the tops fixed.
    pub(crate) depth: f64,
    /// With respect to every change of the layers.
    pub(crate) layers: Vec<f64>,
}

/// Derivatives of a solved state.
#[derive(Debug, Clone)]
pub(crate) struct SceneDerivatives {
    /// The touched pillars.
    pub(crate) places: Vec<usize>,
    /// Whether the derivatives with respect to radii and distances were computed.
    pub(crate) has_distances: bool,
    /// Derivative of the force with respect to the indentation.
    pub(crate) stiffness: f64,
    /// Derivatives of the force at constant indentation.
    pub(crate) force: OfScene,
    /// Derivatives of the indentation at which the floor is reached, if that is the target.
    pub(crate) floor: Option<OfScene>,
}

/// A response `v` to a load `w`.
struct Adjoint {
    coefficients: Vec<f64>,
    /// `w - C v`
    load: Vec<f64>,
}

/// Largest number of iterations for narrow contacts at rims; three to six are typical.
const STEP_LIMIT: usize = 40;

/// Change of the response in the last step, relative to its largest coefficient.
const TOLERANCE: f64 = 1e-10;

/// Pillars with a narrow contact at the rim, and the motion of that contact.
type RimContacts = Vec<(usize, Vec<Motion>)>;

/// Derivatives of a converged solution, including those with respect to changes of the layers. If the floor carries load, those with respect to
/// radii and distances require two more sets of kernels of the floor, and are computed only if `wants_distances`.
pub(crate) fn scene_derivatives(
    newton: &mut Newton<'_>,
    floor: Option<FloorPoint>,
    of_layers: &[Vec<WeightedLayer>],
    wants_distances: bool,
) -> Result<SceneDerivatives, SolveError> {
    // The last entry is the derivative with respect to the logarithm of all thicknesses.
    let mut of_layers = of_layers.to_vec();
    of_layers.extend(by_thickness(&newton.scene.layers));
    if wants_distances || !of_layers.is_empty() {
        mixed::check_memory_of_derivatives(newton)?;
    }
    let rim_contacts = rim_contacts(newton)?;
    let modes = newton.contact.modes();
    let tops = newton.contact.tops();
    let mut unit_load = vec![newton.contact.unit_cell(); newton.contact.len()];
    unit_load[..tops].fill(0.0);
    for load in unit_load[..tops].iter_mut().step_by(modes) {
        *load = UNIT_FORCE;
    }
    let mut adjoints = vec![Adjoint::new(newton, &rim_contacts, &unit_load)?];
    let stiffness = dot(&adjoints[0].coefficients, &unit_load);
    let mut amplification = 0.0;
    if let Some(point) = floor {
        let load = newton.point_load(point.position);
        let adjoint = Adjoint::new(newton, &rim_contacts, &load)?;
        amplification = (1.0 - dot(&adjoint.coefficients, &unit_load)).recip();
        adjoints.push(adjoint);
    }
    let far_of_tops = far_of_tops(newton);
    let sites = &newton.tops.sites;
    let is_touched = |place: &usize| newton.tops.status[*place] != PillarStatus::Untouched;
    let places: Vec<usize> = (0..sites.len()).filter(is_touched).collect();
    let pair = PairCoupling::of_scene(newton.degree(), &newton.scene);
    let mut moments = vec![&newton.contact.coefficients()[..tops]];
    moments.extend(adjoints.iter().map(|adjoint| &adjoint.coefficients[..tops]));
    let workers = newton.run.workers();
    let change = CouplingChange::new(sites, &pair, &places, &moments, workers);
    newton.run.check_cancelled()?;
    let by_layers: Vec<Vec<f64>> = of_layers
        .iter()
        .map(|layers| {
            let pair = pair.of_layers_alone(layers);
            let mut loads = vec![0.0; tops];
            LatticeCoupling::of_sites(sites, &pair, workers).apply(moments[0], &mut loads, workers);
            loads
        })
        .collect();
    newton.run.check_cancelled()?;
    let change = (&change, &far_of_tops[..], &by_layers[..]);
    let mut of_adjoints = by_load_and_operator(newton, &places, &adjoints, &rim_contacts, change);
    add_floor_cells(
        newton,
        &adjoints,
        &of_layers,
        wants_distances,
        &mut of_adjoints,
    );
    newton.run.check_cancelled()?;
    let mut of_adjoints = of_adjoints.into_iter();
    let force = of_adjoints.next();
    let floor = of_adjoints.next().zip(floor).map(|(mut of_scene, point)| {
        add_floor(newton, &places, point.position, &of_layers, &mut of_scene);
        of_scene.scale(amplification);
        of_scene
    });
    Ok(SceneDerivatives {
        has_distances: wants_distances || newton.cells.is_none(),
        stiffness,
        force: force.unwrap_or_else(|| OfScene::none(places.len(), false, of_layers.len())),
        floor,
        places,
    })
}

/// `B m` of the tops alone.
fn far_of_tops(newton: &mut Newton<'_>) -> Vec<f64> {
    let tops = newton.contact.tops();
    if newton.cells.is_none() {
        return newton.contact.present.far.clone();
    }
    let mut of_tops = newton.contact.coefficients().to_vec();
    of_tops[tops..].fill(0.0);
    let mut far = newton.contact.coupled(&of_tops);
    far.truncate(tops);
    far
}

/// Change of layers with the logarithm of their thicknesses, if there are layers: by central differences, with an error of 1e-9.
fn by_thickness(layers: &[WeightedLayer]) -> Option<Vec<WeightedLayer>> {
    const CHANGE: f64 = 1e-5;
    let sides = [-CHANGE, CHANGE].map(|by| {
        let scaled = layers.iter().map(|layer| WeightedLayer {
            thickness: layer.thickness * f64::exp(by),
            ..*layer
        });
        scaled.collect()
    });
    (!layers.is_empty()).then(|| WeightedLayer::change(sides, 2.0 * CHANGE))
}

fn rim_contacts(newton: &Newton<'_>) -> Result<RimContacts, SolveError> {
    let mut solver = LocalSolver::new(&newton.tops.top);
    let one = |place: usize| {
        let load = newton.full_load(place);
        let motions = newton.tops.rim_contact_motions(place, &load, &mut solver);
        motions
            .map(|motions| (place, motions))
            .ok_or(SolveError::NoGradient {
                why: "a pillar is only just touched at its rim; change the load a little",
            })
    };
    newton.tops.rim_contacts().map(one).collect()
}

impl Adjoint {
    fn new(
        newton: &mut Newton<'_>,
        rim_contacts: &RimContacts,
        source: &[f64],
    ) -> Result<Self, SolveError> {
        let modes = newton.contact.modes();
        let tolerance = match newton.cells {
            Some(_) => FLOOR_LINEAR_TOLERANCE,
            None => LINEAR_TOLERANCE,
        };
        // `v = P (w - C v) + k` with `k = E' (w - C v)`: the response to `w - C k`, plus `k`.
        let mut moved = vec![0.0; source.len()];
        for _ in 0..STEP_LIMIT {
            let mut source_left = source.to_vec();
            subtract(&mut source_left, &newton.contact.coupled(&moved));
            let response = newton.respond_to(&source_left, tolerance)?;
            let (mut coefficients, mut load) = (response.coefficients, source_left);
            add_scaled(&mut coefficients, 1.0, &moved);
            subtract(&mut load, &response.far);
            let largest = coefficients.iter().fold(0.0, |a, c| larger(a, c.abs()));
            let mut change = 0.0;
            for (place, motions) in rim_contacts {
                let own = place * modes..(place + 1) * modes;
                let mut next = vec![0.0; modes];
                add_motions(motions, &load[own.clone()], &mut next);
                for (before, next) in moved[own].iter_mut().zip(next) {
                    change = larger(change, (next - *before).abs());
                    *before = next;
                }
            }
            if within(change, TOLERANCE * largest) {
                return Ok(Self { coefficients, load });
            }
        }
        Err(SolveError::NoGradient {
            why: "its equations did not converge",
        })
    }
}

/// Adds `E'` times a load, in as many modes as `response` has.
fn add_motions(motions: &[Motion], load: &[f64], response: &mut [f64]) {
    for Motion {
        coefficients,
        by_load,
    } in motions
    {
        let factor = work(coefficients, load);
        for (response, by_load) in response.iter_mut().zip(by_load) {
            *response += factor * by_load;
        }
    }
}

impl OfScene {
    fn none(pillars: usize, with_radii: bool, layers: usize) -> Self {
        Self {
            raised: vec![0.0; pillars],
            column: vec![Column::default(); pillars],
            radii: with_radii.then(|| vec![0.0; pillars]),
            all_radii: 0.0,
            distances: 0.0,
            lens_radius: 0.0,
            depth: 0.0,
            layers: vec![0.0; layers],
        }
    }

    fn scale(&mut self, factor: f64) {
        let columns = self.column.iter_mut();
        let columns = columns.flat_map(|by| [&mut by.shortening, &mut by.rocking]);
        let values = self.raised.iter_mut().chain(columns);
        let values = values.chain(self.radii.iter_mut().flatten());
        let values = values.chain(&mut self.layers);
        let sums = [
            &mut self.all_radii,
            &mut self.distances,
            &mut self.lens_radius,
            &mut self.depth,
        ];
        for value in values.chain(sums) {
            *value *= factor;
        }
    }
}

/// `v·(db - dA m)` for every adjoint.
fn by_load_and_operator(
    newton: &Newton<'_>,
    places: &[usize],
    adjoints: &[Adjoint],
    rim_contacts: &RimContacts,
    (change, far_of_tops, by_layers): (&CouplingChange, &[f64], &[Vec<f64>]),
) -> Vec<OfScene> {
    let modes = newton.contact.modes();
    let (tops, sites) = (&newton.tops, &newton.tops.sites);
    let lens = &newton.scene.lens;
    let present = newton.contact.coefficients();
    let one = |solver: &mut LocalSolver, number: usize| -> Vec<OfPillar> {
        let place = places[number];
        let own = place * modes..(place + 1) * modes;
        let body = sites.body(place);
        let [x, y] = sites.centres()[place];
        let is_partial = tops.status[place] == PillarStatus::Partial;
        let (load, moments, responses) = if is_partial {
            let load = newton.full_load(place);
            let changes: Vec<&[f64]> = adjoints
                .iter()
                .map(|adjoint| &adjoint.load[own.clone()])
                .collect();
            let (moments, responses) = tops.fixed_responses(place, &load, &changes, solver);
            (load, moments, responses)
        } else {
            let mut load = vec![0.0; modes];
            newton.contact.load(place, &mut load);
            let of_adjoint = |adjoint: &Adjoint| adjoint.coefficients[own.clone()].to_vec();
            let responses = adjoints.iter().map(of_adjoint).collect();
            (load, present[own.clone()].to_vec(), responses)
        };
        // Changes of the load with the lens radius, and with the logarithms of the distances and of the radius.
        let project = |change: &dyn Fn(Point, Point) -> f64| {
            let mut changes = vec![0.0; load.len()];
            tops.project_function(place, change, &mut changes);
            changes
        };
        let by_lens = project(&|at, _| -lens.by_radius(at));
        let by_distance = project(&|at, _| {
            let [u, v] = lens.gradient(at);
            -(u * x + v * y)
        });
        let by_radius = project(&|at, on_disc| {
            let [u, v] = lens.gradient(at);
            -body.radius * (u * on_disc[0] + v * on_disc[1])
        });
        let of_adjoint = |(number, adjoint): (usize, &Adjoint)| {
            let fixed: &Vec<f64> = &responses[number];
            let mut response = fixed.clone();
            if let Some((_, motions)) = rim_contacts.iter().find(|(of, _)| *of == place) {
                add_motions(motions, &adjoint.load[own.clone()], &mut response);
            }
            let leading = &adjoint.coefficients[own.clone()];
            let by_coupling = dot(leading, &change.by_distance[own.clone()]);
            // The derivatives with respect to the logarithms of all distances and of all radii add up to the negative coupling.
            let far = &far_of_tops[own.clone()];
            let all_radii = dot(leading, far) + by_coupling;
            let layers: Vec<f64> = by_layers
                .iter()
                .map(|loads| -dot(leading, &loads[own.clone()]))
                .collect();
            // On layers, so does the derivative with respect to the logarithm of all thicknesses, the last of these.
            let all_radii = all_radii - layers.last().copied().unwrap_or(0.0);
            let own_radius = work(&response, &load) + work(&response, &by_radius);
            let radius = change.by_receiver.as_ref().map(|of_sets| {
                // The first set belongs to the present moments.
                let feels = dot(leading, &of_sets[0][own.clone()]);
                let makes = dot(&present[own.clone()], &of_sets[number + 1][own.clone()]);
                (own_radius - feels - makes) / body.radius
            });
            OfPillar {
                raised: UNIT_FORCE * response[0],
                // The column deforms under a narrow contact without moving it.
                column: Column {
                    shortening: -PI / body.radius * fixed[0] * moments[0],
                    rocking: -TILT_COMPLIANCE / body.radius * work(&fixed[1..3], &moments[1..3]),
                },
                radius,
                all_radii: own_radius + all_radii,
                distance: work(&response, &by_distance) - by_coupling,
                lens_radius: work(&response, &by_lens),
                layers,
            }
        };
        adjoints.iter().enumerate().map(of_adjoint).collect()
    };
    let solver = || LocalSolver::new(&tops.top);
    let of_pillars = newton.run.workers().map(places.len(), 1, solver, one);
    let with_radii = change.by_receiver.is_some();
    let none = OfScene::none(places.len(), with_radii, by_layers.len());
    let mut sums = vec![none; adjoints.len()];
    for (number, of_pillar) in of_pillars.iter().enumerate() {
        for (sum, of_pillar) in sums.iter_mut().zip(of_pillar) {
            sum.raised[number] = of_pillar.raised;
            sum.column[number] = of_pillar.column;
            if let (Some(radii), Some(radius)) = (&mut sum.radii, of_pillar.radius) {
                radii[number] = radius;
            }
            sum.all_radii += of_pillar.all_radii;
            sum.distances += of_pillar.distance;
            sum.lens_radius += of_pillar.lens_radius;
            add_scaled(&mut sum.layers, 1.0, &of_pillar.layers);
        }
    }
    sums
}

/// Contributions of one pillar to the derivatives.
struct OfPillar {
    raised: f64,
    column: Column,
    radius: Option<f64>,
    all_radii: f64,
    distance: f64,
    lens_radius: f64,
    layers: Vec<f64>,
}

/// Work of moments on a load that may have fewer modes.
fn work(moments: &[f64], load: &[f64]) -> f64 {
    moments.iter().zip(load).map(|(m, b)| m * b).sum()
}

/// Adds what the cells of the floor contribute to the derivatives of the force, if they carry load.
fn add_floor_cells(
    newton: &Newton<'_>,
    adjoints: &[Adjoint],
    of_layers: &[Vec<WeightedLayer>],
    wants_distances: bool,
    of_adjoints: &mut [OfScene],
) {
    /// Relative change of the distances.
    const STRETCH: f64 = 1e-4;
    let Some(cells) = &newton.cells else {
        return;
    };
    let (scene, root) = (&newton.scene, cells.unit_cell());
    let tops = newton.contact.tops();
    let forms = |factor: f64, layers: &[WeightedLayer]| {
        let with: Vec<&[f64]> = adjoints.iter().map(|a| &a.coefficients[..]).collect();
        newton.floor_forms(factor, layers, &with)
    };
    let difference =
        |ends: [&[f64; 2]; 2], over: f64| [0, 1].map(|k| (ends[1][k] - ends[0][k]) / over);
    let stretched = wants_distances.then(|| {
        [1.0 - STRETCH, 1.0 + STRETCH].map(|factor| {
            let lens: Vec<f64> = lens_load(&cells.grid.stretched(factor), scene).collect();
            (forms(factor, &scene.layers), lens)
        })
    });
    let by_radius: Vec<f64> = lens_load_by_radius(&cells.grid, scene).collect();
    // The products are linear in the layers.
    let without = (!of_layers.is_empty()).then(|| forms(1.0, &[]));
    let with_layers = of_layers.iter().map(|layers| forms(1.0, layers));
    let with_layers: Vec<Vec<[f64; 2]>> = with_layers.collect();
    for (number, (of_scene, adjoint)) in of_adjoints.iter_mut().zip(adjoints).enumerate() {
        let of_floor = &adjoint.coefficients[tops..];
        let total = root * of_floor.iter().sum::<f64>();
        of_scene.depth -= total;
        of_scene.lens_radius += dot(of_floor, &by_radius);
        of_scene.radii = None;
        if let Some(stretched) = &stretched {
            let [between, alone] = difference(
                stretched.each_ref().map(|(forms, _)| &forms[number]),
                2.0 * STRETCH,
            );
            let [low, high] = stretched.each_ref().map(|(_, lens)| dot(of_floor, lens));
            let by_lens = (high - low) / (2.0 * STRETCH);
            // The first two: a unit load on a cell is proportional to the root of its area.
            of_scene.distances +=
                newton.contact.floor_force() + newton.contact.indentation() * total + by_lens
                    - between
                    - alone;
            of_scene.all_radii += between;
        }
        for (layer, with) in with_layers.iter().enumerate() {
            let Some(without) = &without else { continue };
            let [between, alone] = difference([&without[number], &with[number]], 1.0);
            of_scene.layers[layer] -= between + alone;
            if layer + 1 == with_layers.len() {
                of_scene.all_radii += between;
            }
        }
    }
}

/// Adds `dh + df + dW·m`.
fn add_floor(
    newton: &Newton<'_>,
    places: &[usize],
    point: Point,
    of_layers: &[Vec<WeightedLayer>],
    of_scene: &mut OfScene,
) {
    let lens = &newton.scene.lens;
    let modes = newton.contact.modes();
    let radii = newton.scene.field.radii();
    let exteriors: Vec<Exterior> = of_layers
        .iter()
        .map(|layers| Exterior::new(newton.exterior.degree()).with_layers(layers, &radii))
        .collect();
    let mut values = vec![0.0; newton.exterior.count()];
    of_scene.depth += 1.0;
    of_scene.lens_radius += lens.by_radius(point);
    for (number, &place) in places.iter().enumerate() {
        let centre = newton.tops.sites.centres()[place];
        let radius = newton.tops.sites.body(place).radius;
        let moments = &newton.contact.coefficients()[place * modes..(place + 1) * modes];
        let load_of = |_: usize, mode: usize| moments[mode] / (radius * radius);
        let disc = LoadedDiscs {
            exterior: &newton.exterior,
            discs: Discs::new([1, modes], |_| centre, |_| radius, [Some(&load_of), None]),
            run: newton.run,
        };
        let [field, _] = disc.displacement(point);
        let along = |[x, y]: Point| x * field.gradient[0] + y * field.gradient[1];
        // At a distance D from a disc of radius a, moments m cause a displacement m·w(D/a)/a.
        let away = [0, 1].map(|k| point[k] - centre[k]);
        let mut by_radius = -field.value - along(away);
        for (number, exterior) in exteriors.iter().enumerate() {
            exterior.layer_values(modes, away.map(|x| x / radius), radius, &mut values);
            let count = values.len().min(modes);
            let by_layers = dot(&values[..count], &moments[..count]) / radius;
            of_scene.layers[number] += by_layers;
            if number + 1 == exteriors.len() {
                by_radius -= by_layers;
            }
        }
        of_scene.distances -= along(centre);
        of_scene.all_radii += by_radius;
        if let Some(radii) = &mut of_scene.radii {
            radii[number] += by_radius / radius;
        }
    }
}
