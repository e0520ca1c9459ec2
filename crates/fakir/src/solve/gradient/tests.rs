//! Derivatives compared to central differences of solutions that converged to rounding and have identical contact states.

use super::*;
use crate::problem::column::Column;
use crate::problem::layer::WeightedLayer;
use crate::problem::pillar_field::{ListedPillar, PillarBody, PillarField, PillarList};
use crate::problem::scaled::Scene;
use crate::problem::{
    Disorder, HexagonalLattice, Lens, Pillar, PillarCompliance, PillarPattern, PlaneLattice,
    Scatter,
};
use crate::solve::newton::Degrees;
use crate::solve::spectral::Solution;
use crate::theory::reference;
use std::sync::Arc;

/// Largest relative error of derivatives compared to central differences.
const TOLERANCE: f64 = 1e-6;

/// Reproducible numbers between 0 and 1.
struct Dice(u64);

impl Dice {
    fn roll(&mut self) -> f64 {
        // The multiplier of D. E. Knuth's MMIX.
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.roll()
    }
}

/// The contact states of all pillars of a solution.
#[derive(PartialEq)]
struct States {
    status: Vec<((i64, i64), PillarStatus)>,
    partial: Vec<((i64, i64), Vec<bool>)>,
    degrees: Degrees,
}

impl States {
    fn of(newton: &Newton<'_>) -> Self {
        let sites = &newton.tops.sites;
        let places = (0..sites.len()).filter(|p| newton.tops.status[*p] != PillarStatus::Untouched);
        let partial = newton.tops.partial_states().into_iter();
        Self {
            status: places
                .map(|p| (sites.index(p), newton.tops.status[p]))
                .collect(),
            partial: partial
                .map(|(p, active)| (sites.index(p), active))
                .collect(),
            degrees: newton.degrees(),
        }
    }

    fn has_partial(&self) -> bool {
        !self.partial.is_empty()
    }

    fn has_rim_contact(&self) -> bool {
        let nodes = crate::halfspace::disc::basis::mode_count(self.degrees.tops.nodes);
        self.partial.iter().any(|(_, active)| active.len() != nodes)
    }
}

/// `None` if the contact is too large for the lens.
fn solve<'a>(scene: &Scene, target: Load, run: &'a Run<'a>) -> Option<Solution<'a>> {
    let (form, purpose) = (PunchForm::Corrected, Purpose::Start);
    let punch = solve_punch(scene, target, None, form, purpose, run).ok()?;
    let degrees = degrees(Accuracy::Default, scene);
    let solution = solve_spectral(scene, target, punch, degrees, run).ok()?;
    assert_eq!(solution.outcome.termination, Termination::Converged);
    Some(solution)
}

/// A solution that converged to rounding, and its states; `None` if the states do not settle.
fn sharp<'a>(scene: &Scene, target: Load, run: &'a Run<'a>) -> Option<(Solution<'a>, States)> {
    let mut solution = solve(scene, target, run)?;
    let settled = solution
        .newton
        .sharpen(target, &mut solution.outcome)
        .unwrap();
    let states = States::of(&solution.newton);
    settled.then_some((solution, states))
}

/// Central difference of force and indentation along a change of the scene, extrapolated to zero step for narrow contacts at rims; `None`
/// if a state changes within the step.
fn difference(
    scene: &dyn Fn(f64) -> Scene,
    target: Load,
    states: &States,
    step: f64,
) -> Option<[f64; 2]> {
    let over = |step: f64| {
        let mut ends = [[0.0; 2]; 2];
        for (end, sign) in ends.iter_mut().zip([1.0, -1.0]) {
            let run = Run::default();
            let (solution, there) = sharp(&scene(sign * step), target, &run)?;
            if there != *states {
                return None;
            }
            *end = [solution.newton.force(), solution.outcome.indentation];
        }
        Some([0, 1].map(|k| (ends[0][k] - ends[1][k]) / (2.0 * step)))
    };
    let whole = over(step)?;
    if !states.has_rim_contact() {
        return Some(whole);
    }
    let half = over(0.5 * step)?;
    Some([0, 1].map(|k| (4.0 * half[k] - whole[k]) / 3.0))
}

/// Parameter of a scene of listed pillars that is changed.
#[derive(Debug, Clone, Copy)]
enum Along {
    Raised(usize),
    AllRaised,
    Column(usize),
    AllColumns,
    Rocking(usize),
    Radius(usize),
    AllRadii,
    Distances,
    LensRadius,
    Depth,
    Thickness,
}

#[derive(Clone)]
struct Listed {
    layers: Vec<WeightedLayer>,
    pillars: Vec<ListedPillar>,
    lens: f64,
    depth: f64,
}

impl Listed {
    /// Pillars on a perturbed square lattice around the axis, with random radii, heights and columns.
    fn random(dice: &mut Dice) -> Self {
        let side = 3 + (3.0 * dice.roll()) as i32;
        let pitch = dice.between(3.4, 7.0);
        let lens = pitch * pitch * dice.between(3.0, 60.0);
        let rough = dice.between(0.0, 0.3) * pitch * pitch / lens;
        let shift = [dice.roll(), dice.roll()];
        let mut pillars = Vec::new();
        for i in 0..side {
            for j in 0..side {
                let place = |k: usize, index: i32, dice: &mut Dice| {
                    let middle = 0.5 * f64::from(side) - shift[k];
                    pitch * (f64::from(index) - middle + dice.between(-0.1, 0.1))
                };
                let centre = [place(0, i, dice), place(1, j, dice)];
                let [radius, raised] = [dice.between(0.7, 1.2), dice.between(-rough, rough)];
                let shortening = dice.between(0.1, 1.0);
                let body = PillarBody {
                    radius,
                    raised,
                    column: Column {
                        shortening,
                        rocking: 3.0 * shortening,
                    },
                };
                pillars.push(ListedPillar { centre, body });
            }
        }
        Self {
            layers: Vec::new(),
            pillars,
            lens,
            depth: dice.between(0.3, 0.8) * pitch * pitch / lens,
        }
    }

    fn scene(&self) -> Scene {
        let list = PillarList::new(self.pillars.clone()).unwrap();
        Scene {
            layers: self.layers.clone(),
            lens: Lens {
                radius: self.lens,
                material: Material::new(1.0, 0.5),
            }
            .into(),
            height: self.depth,
            field: PillarField::Listed(Arc::new(list)),
            length: 1.0,
            pressure: 1.0,
            rotation: 0.0,
        }
    }

    fn changed(&self, along: Along, by: f64) -> Scene {
        let mut changed = self.clone();
        match along {
            Along::LensRadius => changed.lens += by,
            Along::Depth => changed.depth += by,
            Along::Thickness => {
                for layer in &mut changed.layers {
                    layer.thickness *= by.exp();
                }
            }
            _ => {}
        }
        for (number, pillar) in changed.pillars.iter_mut().enumerate() {
            let ListedPillar { centre, body } = pillar;
            match along {
                Along::Raised(one) if one == number => body.raised += by,
                Along::AllRaised => body.raised += by,
                Along::Column(one) if one == number => body.column.shortening += by,
                Along::AllColumns => body.column.shortening += by,
                Along::Rocking(one) if one == number => body.column.rocking += by,
                Along::Radius(one) if one == number => body.radius += by,
                Along::AllRadii => body.radius *= by.exp(),
                Along::Distances => *centre = centre.map(|x| x * by.exp()),
                _ => {}
            }
        }
        changed.scene()
    }
}

fn derivative(of_scene: &OfScene, along: Along, places: &[usize]) -> f64 {
    let of = |values: &[f64], one: usize| {
        let number = places.iter().position(|place| *place == one).unwrap();
        values[number]
    };
    let columns = of_scene.column.iter();
    let (shortening, rocking): (Vec<_>, Vec<_>) =
        columns.map(|by| (by.shortening, by.rocking)).unzip();
    match along {
        Along::Raised(one) => of(&of_scene.raised, one),
        Along::AllRaised => of_scene.raised.iter().sum(),
        Along::Column(one) => of(&shortening, one),
        Along::AllColumns => shortening.iter().sum(),
        Along::Rocking(one) => of(&rocking, one),
        Along::Radius(one) => of(of_scene.radii.as_ref().unwrap(), one),
        Along::AllRadii => of_scene.all_radii,
        Along::Distances => of_scene.distances,
        Along::LensRadius => of_scene.lens_radius,
        Along::Depth => of_scene.depth,
        Along::Thickness => of_scene.layers.last().copied().unwrap_or(0.0),
    }
}

/// Largest relative errors, separately for states with partially touched pillars.
#[derive(Default)]
struct Errors {
    full: f64,
    partial: f64,
    rim_contact: f64,
    compared: usize,
}

impl Errors {
    fn add(&mut self, states: &States, error: f64) {
        let of = match (states.has_rim_contact(), states.has_partial()) {
            (true, _) => &mut self.rim_contact,
            (false, true) => &mut self.partial,
            (false, false) => &mut self.full,
        };
        *of = of.max(error);
        self.compared += 1;
    }
}

const EVERY: [Along; 11] = [
    Along::Raised(0),
    Along::AllRaised,
    Along::Column(0),
    Along::AllColumns,
    Along::Rocking(0),
    Along::Radius(0),
    Along::AllRadii,
    Along::Distances,
    Along::LensRadius,
    Along::Depth,
    Along::Thickness,
];

#[test]
fn any_arrangement() {
    compare_arrangements(4, &[], &EVERY);
}

#[test]
#[ignore = "slow: 96 systems more"]
fn many_arrangements() {
    compare_arrangements(100, &[], &EVERY);
}

/// A layer as thick as the largest pillar.
#[test]
fn several_radii_on_a_layer() {
    let film = crate::halfspace::layer::tests::film();
    compare_arrangements(1, &[film], &[Along::AllRadii, Along::Thickness]);
}

#[test]
#[ignore = "slow: every parameter, with more systems"]
fn many_radii_on_a_layer() {
    let film = crate::halfspace::layer::tests::film();
    compare_arrangements(6, &[film], &EVERY);
}

/// Arbitrary pillars: at a fixed indentation, at a fixed force, and at first contact with the floor. On layers there are no derivatives with
/// respect to one radius.
fn compare_arrangements(count: usize, layers: &[WeightedLayer], parameters: &[Along]) {
    let mut dice = Dice(7);
    let run = Run::default();
    let mut errors = Table::new();
    let mut systems = 0;
    while systems < count {
        let listed = Listed {
            layers: layers.to_vec(),
            ..Listed::random(&mut dice)
        };
        let scene = listed.scene();
        let target = if systems % 2 == 0 {
            Load::FloorContact
        } else {
            Load::Indentation(dice.between(0.3, 2.0) * listed.depth)
        };
        let Some((mut solution, states)) = sharp(&scene, target, &run) else {
            continue;
        };
        if solution.newton.touched() == 0 {
            continue;
        }
        systems += 1;
        let mut found =
            scene_derivatives(&mut solution.newton, solution.outcome.floor, &[], true).unwrap();
        // Pillars of a list are identified by their index in it.
        for place in &mut found.places {
            *place = solution.newton.tops.sites.index(*place).0 as usize;
        }
        let any = found.places[(dice.roll() * found.places.len() as f64) as usize];
        let scale = solution.newton.force();
        for along in parameters {
            let along = match along {
                Along::Radius(_) if !layers.is_empty() => continue,
                Along::Thickness if layers.is_empty() => continue,
                Along::Raised(_) => Along::Raised(any),
                Along::Column(_) => Along::Column(any),
                Along::Rocking(_) => Along::Rocking(any),
                Along::Radius(_) => Along::Radius(any),
                other => *other,
            };
            // The step in height changes the contact about as much as that of another parameter.
            let step = 1e-4
                * match along {
                    Along::Raised(_) | Along::AllRaised | Along::Depth => listed.depth,
                    Along::LensRadius => listed.lens,
                    _ => 1.0,
                };
            // A narrow contact at a rim may double its depth within a small fraction of the pitch.
            let step = if states.has_rim_contact() {
                0.1 * step
            } else {
                step
            };
            let changed = |by: f64| listed.changed(along, by);
            let Some([force, indentation]) = difference(&changed, target, &states, step) else {
                continue;
            };
            let of_force = derivative(&found.force, along, &found.places);
            let mut compare = |what: &str, found: f64, expected: f64, unit: f64| {
                // A derivative that vanishes has no relative error: compare with the effect of a change of one per cent.
                let error = (found - expected).abs() / expected.abs().max(1e-2 * unit);
                let kind = format!("{what} by {along:?}");
                let kind = kind.split('(').next().unwrap().to_owned();
                add(&mut errors, &kind, &states, error);
            };
            let unit = if states.has_rim_contact() { 1e-5 } else { 1e-4 } / step;
            if let Some(floor) = &found.floor {
                let of_floor = derivative(floor, along, &found.places);
                compare(
                    "critical indentation",
                    of_floor,
                    indentation,
                    unit * listed.depth,
                );
                let critical = of_force + found.stiffness * of_floor;
                compare("critical force", critical, force, unit * scale);
            } else if !matches!(along, Along::Depth) {
                compare("force", of_force, force, unit * scale);
                if systems % 4 == 0 {
                    let at_force = Load::Force(scale);
                    if let Some([_, moved]) = difference(&changed, at_force, &states, step) {
                        let by = -of_force / found.stiffness;
                        compare("indentation", by, moved, unit * listed.depth);
                    }
                }
            }
        }
        if let Some(radii) = &found.force.radii {
            let sum: f64 = found
                .places
                .iter()
                .zip(radii)
                .map(|(place, by)| by * listed.pillars[*place].body.radius)
                .sum();
            let error = (sum - found.force.all_radii).abs();
            assert!(error < 1e-9 * scale, "{sum} {}", found.force.all_radii);
        }
        let results = [scale, solution.outcome.indentation];
        for (kind, error) in euler(&listed, &found, results) {
            add(&mut errors, kind, &states, error.abs());
        }
    }
    check(&errors);
}

/// Errors by compared quantity.
type Table = Vec<(String, Errors)>;

fn add(table: &mut Table, kind: &str, states: &States, error: f64) {
    let place = table.iter().position(|(known, _)| known == kind);
    let place = place.unwrap_or_else(|| {
        table.push((kind.to_owned(), Errors::default()));
        table.len() - 1
    });
    table[place].1.add(states, error);
}

fn check(table: &Table) {
    for (kind, errors) in table {
        println!(
            "{kind}: {} compared, {:.1e}, in part {:.1e}, at a rim {:.1e}",
            errors.compared, errors.full, errors.partial, errors.rim_contact
        );
    }
    for (kind, errors) in table {
        let largest = errors.full.max(errors.partial).max(errors.rim_contact);
        assert!(largest < TOLERANCE, "{kind}");
    }
}

/// Scaling all lengths by `s` scales the force by `s^2` and the indentation by `s`, with `E* = 1`. Returns the relative errors of Euler's
/// identity.
fn euler(
    listed: &Listed,
    found: &SceneDerivatives,
    [force, indentation]: [f64; 2],
) -> Vec<(&'static str, f64)> {
    let along_all = |of_scene: &OfScene| {
        let raised: f64 = found
            .places
            .iter()
            .zip(&of_scene.raised)
            .map(|(place, by)| by * listed.pillars[*place].body.raised)
            .sum();
        raised
            + of_scene.all_radii
            + of_scene.distances
            + of_scene.lens_radius * listed.lens
            + of_scene.depth * listed.depth
            + derivative(of_scene, Along::Thickness, &found.places)
    };
    let of_force = along_all(&found.force) + found.stiffness * indentation;
    let of_floor = found.floor.as_ref().map(&along_all);
    std::iter::once(("Euler, force", of_force / (2.0 * force) - 1.0))
        .chain(of_floor.map(|sum| ("Euler, floor", sum / indentation - 1.0)))
        .collect()
}

/// The quantities of a random system of the public interface.
#[derive(Debug, Clone, Copy)]
struct Hexagonal {
    values: [f64; 8],
    offset: [f64; 2],
    compliance: PillarCompliance,
    /// Seed of the scattered heights of a square lattice; `None` for a hexagonal lattice.
    scatter: Option<u64>,
}

/// Quantities with derivatives, in the order of [`Hexagonal::values`].
const QUANTITIES: [Quantity; 8] = [
    Quantity::LensRadius,
    Quantity::LensYoungModulus,
    Quantity::LensPoissonRatio,
    Quantity::SubstrateYoungModulus,
    Quantity::SubstratePoissonRatio,
    Quantity::PillarDiameter,
    Quantity::PillarHeight,
    Quantity::Pitch,
];

impl Hexagonal {
    fn random(dice: &mut Dice) -> Self {
        let diameter = 6e-6 * dice.between(0.5, 2.0);
        let lattice = HexagonalLattice::with_surface_fraction(dice.between(0.015, 0.25), diameter);
        let height = diameter * dice.between(0.2, 0.8);
        let radius = lattice.pitch * lattice.pitch / height * dice.between(0.8, 5.0);
        Self {
            values: [
                radius,
                1e6 * dice.between(0.5, 5.0),
                dice.between(0.2, 0.49),
                1e6 * dice.between(0.5, 5.0),
                dice.between(0.2, 0.49),
                diameter,
                height,
                lattice.pitch,
            ],
            offset: [dice.roll(), dice.roll()],
            compliance: if dice.roll() < 0.7 {
                PillarCompliance::Column
            } else {
                PillarCompliance::None
            },
            scatter: None,
        }
    }

    fn system(&self) -> System {
        let [
            radius,
            lens,
            lens_ratio,
            substrate,
            ratio,
            diameter,
            height,
            pitch,
        ] = self.values;
        let pillar = Pillar {
            diameter,
            height,
            compliance: self.compliance,
        };
        let [offset, offset_angle] = self.offset;
        let lattice = HexagonalLattice {
            pitch,
            offset,
            offset_angle,
        };
        let material = Material::new(lens, lens_ratio);
        let lens = Lens { radius, material };
        let pattern = match self.scatter {
            None => PillarPattern::new(pillar, lattice),
            Some(seed) => PillarPattern::new(
                pillar,
                PlaneLattice {
                    offset,
                    offset_angle,
                    rotation: 0.3,
                    disorder: Disorder {
                        heights: Scatter::normal(0.04, seed),
                        missing: 0.1,
                    },
                    ..PlaneLattice::new(LatticeForm::Square { pitch })
                },
            ),
        };
        System::new(lens, Material::new(substrate, ratio), pattern).unwrap()
    }

    fn scaled(&self, which: usize, by: f64) -> System {
        let mut scaled = *self;
        scaled.values[which] *= 1.0 + by;
        scaled.system()
    }
}

/// Converts a load to solver units.
fn target(control: Load, scene: &Scene) -> Load {
    match control {
        Load::Indentation(indentation) => Load::Indentation(indentation / scene.length),
        Load::Force(force) => Load::Force(force / scene.force()),
        Load::FloorContact => Load::FloorContact,
    }
}

/// Force (N) and indentation (m), and the states; `None` if the states do not settle.
fn answer(system: &System, control: Load) -> Option<([f64; 2], States)> {
    let (scene, run) = (Scene::new(system), Run::default());
    let (solution, states) = sharp(&scene, target(control, &scene), &run)?;
    let force = solution.newton.force() * scene.force();
    Some(([force, solution.outcome.indentation * scene.length], states))
}

/// Central differences with respect to the logarithm of a quantity; `None` if a state changes within the step, or if the differences over
/// two steps disagree: the influence between cells of a narrow contact at a rim is computed by one of two formulas, with a small jump
/// between them.
fn answer_difference(
    hexagonal: &Hexagonal,
    which: usize,
    control: Load,
    states: &States,
    step: f64,
) -> Option<[f64; 2]> {
    let over = |step: f64| {
        let mut ends = [[0.0; 2]; 2];
        for (end, sign) in ends.iter_mut().zip([1.0, -1.0]) {
            let (values, there) = answer(&hexagonal.scaled(which, sign * step), control)?;
            if there != *states {
                return None;
            }
            *end = values;
        }
        Some([0, 1].map(|k| (ends[0][k] - ends[1][k]) / (2.0 * step)))
    };
    let found = over(step)?;
    if states.has_rim_contact() {
        let other = over(0.4 * step)?;
        let ([force, indentation], _) = answer(&hexagonal.system(), control)?;
        let differ = |k: usize, value: f64| {
            let scale = found[k].abs().max(1e-2 * value);
            (found[k] - other[k]).abs() > TOLERANCE * scale
        };
        if differ(0, force) || differ(1, indentation) {
            println!("jumps by {}: {found:?} {other:?}", QUANTITIES[which]);
            return None;
        }
    }
    Some(found)
}

#[test]
fn hexagonal_lattices() {
    compare_systems(8, 3, false);
}

#[test]
#[ignore = "slow: 92 systems more"]
fn many_hexagonal_lattices() {
    compare_systems(100, 3, false);
}

#[test]
fn scattered_square_lattices() {
    compare_systems(4, 4, true);
}

#[test]
#[ignore = "slow: 26 systems more"]
fn many_scattered_square_lattices() {
    compare_systems(30, 4, true);
}

/// The public gradient compared to differences for every quantity: at an indentation, at a force, and at first contact with the floor. On
/// hexagonal lattices, or on rotated square ones with scattered heights and missing pillars.
fn compare_systems(count: usize, seed: u64, scatters: bool) {
    let mut dice = Dice(seed);
    let run = Run::default();
    let mut errors = Table::new();
    let mut systems = 0;
    while systems < count {
        let mut hexagonal = Hexagonal::random(&mut dice);
        hexagonal.scatter = scatters.then_some(systems as u64);
        let system = hexagonal.system();
        let height = system.pillar().height;
        let depth = Load::Indentation(height * dice.between(0.3, 1.5));
        let mut control = [Load::FloorContact, depth][systems % 2];
        if systems % 4 == 3 {
            let Some(([force, _], _)) = answer(&system, control) else {
                continue;
            };
            control = Load::Force(force);
        }
        let found = gradient(&system, control, Accuracy::Default, None, &run);
        let (Ok(found), Some((_, states))) = (found, answer(&system, control)) else {
            continue;
        };
        systems += 1;
        let values = [found.contact.force, found.contact.indentation];
        // A narrow contact at a rim may double its depth within a small fraction of the pitch.
        let step = if states.has_rim_contact() { 1e-5 } else { 1e-4 };
        for (which, quantity) in QUANTITIES.into_iter().enumerate() {
            let Some(expected) = answer_difference(&hexagonal, which, control, &states, step)
            else {
                continue;
            };
            let parts = [("force", &found.force), ("indentation", &found.indentation)];
            for (k, (what, derivatives)) in parts.into_iter().enumerate() {
                let Some(derivatives) = derivatives else {
                    assert!(expected[k].abs() < 1e-8 * values[k], "{what} is prescribed");
                    continue;
                };
                let by = derivatives.by(quantity).unwrap() * hexagonal.values[which];
                let error = (by - expected[k]).abs() / expected[k].abs().max(1e-2 * values[k]);
                add(
                    &mut errors,
                    &format!("{what} by {quantity:?}"),
                    &states,
                    error,
                );
            }
        }
        for (kind, error) in identities(&hexagonal, control, &found) {
            // Scattered heights change in proportion, not all by the same amount.
            if scatters && kind == "heights" {
                continue;
            }
            add(&mut errors, kind, &states, error.abs());
        }
    }
    check(&errors);
}

/// Identities that follow from scaling of lengths and moduli, and from raising all pillars together: relative errors.
fn identities(hexagonal: &Hexagonal, control: Load, found: &Gradient) -> Vec<(&'static str, f64)> {
    let sum = |derivatives: &Derivatives, of: &[Quantity]| -> f64 {
        let term = |(quantity, value): (Quantity, f64)| {
            let counts = of.contains(&quantity);
            if counts {
                derivatives.by(quantity).unwrap() * value
            } else {
                0.0
            }
        };
        QUANTITIES.into_iter().zip(hexagonal.values).map(term).sum()
    };
    use Quantity as Q;
    let lengths = [Q::LensRadius, Q::PillarDiameter, Q::PillarHeight, Q::Pitch];
    let moduli = [Q::LensYoungModulus, Q::SubstrateYoungModulus];
    let ContactState {
        force, indentation, ..
    } = found.contact;
    let raised = |derivatives: &Derivatives| -> f64 {
        let all = derivatives.heights.iter().map(|(_, by)| by);
        all.sum::<f64>() - derivatives.by(Q::PillarHeight).unwrap()
    };
    let mut errors = Vec::new();
    match (control, &found.force, &found.indentation) {
        (Load::Indentation(_), Some(of), _) => {
            let all = sum(of, &lengths) + found.stiffness * indentation;
            errors.push(("lengths", all / (2.0 * force) - 1.0));
            errors.push(("moduli", sum(of, &moduli) / force - 1.0));
            errors.push(("heights", raised(of) / found.stiffness - 1.0));
        }
        (Load::Force(_), _, Some(of)) => {
            let all = sum(of, &lengths) + 2.0 * force / found.stiffness;
            errors.push(("lengths", all / indentation - 1.0));
            let all = sum(of, &moduli) + force / found.stiffness;
            errors.push(("moduli", all / indentation));
            errors.push(("heights", raised(of) + 1.0));
        }
        (_, Some(of_force), Some(of)) => {
            errors.push(("lengths", sum(of_force, &lengths) / (2.0 * force) - 1.0));
            errors.push(("lengths", sum(of, &lengths) / indentation - 1.0));
            errors.push(("moduli", sum(of_force, &moduli) / force - 1.0));
            errors.push(("moduli", sum(of, &moduli) / indentation));
            errors.push(("heights", raised(of) + 1.0));
            errors.push(("heights", raised(of_force) * indentation / force));
        }
        _ => {}
    }
    errors
}

#[test]
fn many_pillars() {
    compare_pattern(0.1);
}

#[test]
#[ignore = "slow: twice as dense"]
fn very_many_pillars() {
    compare_pattern(0.2);
}

/// The paper's patterns with many pillars, where the coupling is a convolution.
fn compare_pattern(phi: f64) {
    let run = Run::default();
    let lattice = reference::lattice(phi).offset_by(0.2);
    let column = PillarCompliance::Column;
    let system = reference::on_lattice(lattice, reference::INTERMEDIATE, column);
    let found = gradient(&system, Load::FloorContact, Accuracy::Default, None, &run).unwrap();
    let (_, states) = answer(&system, Load::FloorContact).unwrap();
    let pillar = system.pillar();
    let hexagonal = Hexagonal {
        values: [
            system.lens().sphere_radius(),
            2e6,
            0.5,
            2e6,
            0.5,
            pillar.diameter,
            pillar.height,
            lattice.pitch,
        ],
        offset: [0.2, 0.0],
        compliance: column,
        scatter: None,
    };
    let force = found.force.as_ref().unwrap();
    let mut compared = 0;
    for which in [0, 5, 6, 7] {
        // With many nodes, some change their states within a small step.
        let steps = [1e-4, 1e-5, 1e-6];
        let mut differences = steps.into_iter().filter_map(|step| {
            answer_difference(&hexagonal, which, Load::FloorContact, &states, step)
        });
        let Some([expected, _]) = differences.next() else {
            continue;
        };
        compared += 1;
        let by = force.by(QUANTITIES[which]).unwrap() * hexagonal.values[which];
        println!(
            "{phi}, {} pillars, {:?}: {:e}",
            found.contact.pillars.len(),
            QUANTITIES[which],
            by / expected - 1.0
        );
        assert!((by / expected - 1.0).abs() < TOLERANCE);
    }
    assert!(compared > 0, "{phi}");
    for (kind, error) in identities(&hexagonal, Load::FloorContact, &found) {
        println!("{kind} {error:e}");
        assert!(error.abs() < TOLERANCE, "{kind}: {error:e}");
    }
}

/// `F = 2 E* a zeta/(1 + kappa)` (Johnson, Contact Mechanics, eq. 3.36, and Hooke).
#[test]
fn a_single_flat_punch() {
    let body = PillarBody {
        radius: 2.5,
        raised: 0.1,
        column: 0.25.into(),
    };
    let centre = [3.0, 1.0];
    let listed = Listed {
        layers: Vec::new(),
        pillars: vec![ListedPillar { centre, body }],
        lens: f64::INFINITY,
        depth: 2.2,
    };
    let run = Run::default();
    let mut solution = solve(&listed.scene(), Load::Indentation(0.4), &run).unwrap();
    let found = scene_derivatives(&mut solution.newton, None, &[], true).unwrap();
    let OfScene {
        raised,
        column,
        radii,
        all_radii,
        distances,
        lens_radius,
        ..
    } = found.force;
    let stiffness = 5.0 / 1.25;
    for (found, expected) in [
        (found.stiffness, stiffness),
        (raised[0], stiffness),
        (column[0].shortening, -stiffness * 0.5 / 1.25),
        (radii.unwrap()[0], stiffness * 0.5 / 2.5),
        (all_radii, stiffness * 0.5),
    ] {
        assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
    }
    assert!(distances.abs() < 1e-12 && lens_radius.abs() < 1e-12);
}

/// Past the transition, at an indentation or at the force there: identities, and differences of forces over a finite step, which contain the
/// noise of cells whose states change.
fn compare_past_transition(hexagonal: &Hexagonal, by_force: bool, tolerance: [f64; 2]) {
    let run = Run::default();
    let system = hexagonal.system();
    let depth = 1.6 * system.pillar().height;
    let at = |system: &System, control| {
        let contact = super::super::answers::press(
            system,
            control,
            PillarMethod::Spectral(Accuracy::Default),
            &run,
        );
        contact.unwrap()
    };
    let state = at(&system, Load::Indentation(depth));
    let share = state.floor.as_ref().unwrap().share;
    assert!(share > 0.05, "{share}");
    let control = match by_force {
        true => Load::Force(state.force),
        false => Load::Indentation(depth),
    };
    let found = gradient(&system, control, Accuracy::Default, None, &run).unwrap();
    assert!((found.contact.force / state.force - 1.0).abs() < 1e-7);
    assert!(found.area.is_none());
    for (kind, error) in identities(hexagonal, control, &found) {
        println!("{kind} {error:e}");
        let scattered = kind == "heights" && hexagonal.scatter.is_some();
        assert!(scattered || error.abs() < tolerance[0], "{kind}: {error:e}");
    }
    let derivatives = [&found.force, &found.indentation];
    let derivatives = derivatives[usize::from(by_force)].as_ref().unwrap();
    let all = QUANTITIES.into_iter().zip(hexagonal.values);
    let all = all.map(|(quantity, value)| derivatives.by(quantity).unwrap() * value);
    let largest = all.fold(0.0, |largest: f64, by| largest.max(by.abs()));
    let step = 2e-3;
    for (which, quantity) in QUANTITIES.into_iter().enumerate() {
        let value = |by: f64| {
            let contact = at(&hexagonal.scaled(which, by), control);
            if by_force {
                contact.indentation
            } else {
                contact.force
            }
        };
        let expected = (value(step) - value(-step)) / (2.0 * step);
        let by = derivatives.by(quantity).unwrap() * hexagonal.values[which];
        let error = (by - expected).abs() / largest;
        println!("{quantity:?}: {by:e} {expected:e} {error:.1e}");
        assert!(error < tolerance[1], "{quantity:?}: {error:e}");
    }
}

/// A lattice on which the floor is reached early.
fn open_lattice() -> Hexagonal {
    let (diameter, height, pitch) = (6e-6, 2.2e-6, 60e-6);
    Hexagonal {
        values: [0.6e-3, 2e6, 0.45, 1.5e6, 0.4, diameter, height, pitch],
        offset: [0.3, 0.2],
        compliance: PillarCompliance::Column,
        scatter: None,
    }
}

#[test]
fn past_the_transition() {
    compare_past_transition(&open_lattice(), false, [1e-6, 1e-3]);
}

/// Past the transition, derivatives with respect to some quantities are those of all; pitch and diameter are left out unless one of them is wanted.
/// Before floor contact nothing is left out.
#[test]
fn some_derivatives_are_those_of_all() {
    let run = Run::default();
    let system = open_lattice().system();
    let of = |depth: f64, wanted: Option<&[Quantity]>| {
        let control = Load::Indentation(depth * system.pillar().height);
        gradient(&system, control, Accuracy::Default, wanted, &run).unwrap()
    };
    let all = of(1.6, None);
    let known = all.force.as_ref().unwrap();
    let distances = [Quantity::Pitch, Quantity::PillarDiameter];
    for (wanted, complete) in [
        (&[Quantity::LensRadius][..], false),
        (&distances[..1], true),
    ] {
        let some = of(1.6, Some(wanted));
        let force = some.force.unwrap();
        assert!((some.stiffness / all.stiffness - 1.0).abs() < 1e-12);
        for (quantity, value) in &known.quantities {
            match force.by(*quantity) {
                Some(by) => assert!((by / value - 1.0).abs() < 1e-9, "{quantity:?}"),
                None => assert!(distances.contains(quantity) && !complete, "{quantity:?}"),
            }
        }
        let left = known.quantities.len() - force.quantities.len();
        assert_eq!(left, if complete { 0 } else { 2 });
    }
    let before = of(0.5, Some(&[])).force.unwrap();
    assert_eq!(before.quantities.len(), known.quantities.len());
}

#[test]
#[ignore = "slow: a prescribed force, scattered heights, and elastic pillars"]
fn past_the_transition_by_force_and_on_other_pillars() {
    let open = open_lattice();
    compare_past_transition(&open, true, [1e-6, 1e-3]);
    let scattered = Hexagonal {
        scatter: Some(2),
        ..open
    };
    compare_past_transition(&scattered, false, [1e-6, 1e-3]);
    let elastic = Hexagonal {
        compliance: PillarCompliance::Elastic,
        ..open
    };
    compare_past_transition(&elastic, false, [1e-6, 1e-3]);
}

#[test]
fn what_has_no_gradient_is_refused() {
    let lattice = reference::lattice(0.1);
    let system = reference::on_lattice(lattice, reference::INTERMEDIATE, PillarCompliance::Column);
    let why = |control| match gradient(&system, control, Accuracy::Default, None, &Run::default()) {
        Err(SolveError::NoGradient { why }) => why,
        other => panic!("{other:?}"),
    };
    assert!(why(Load::Indentation(0.0)).contains("no pillar is touched"));
    assert!(why(Load::Indentation(1e-9)).contains("one pillar top"));
}
