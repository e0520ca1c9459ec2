//! Contacts in SI units, with gradients and error estimates.

use super::climb::Found;
use super::equations::Equations;
use super::follow::{Ended, Here, Path};
use super::load::{Layout, Shape};
use super::newton::{self, Aim, Settled, Trouble};
use crate::halfspace::disc::basis::{UNIT_FORCE, eigenvalue, mode_count};
use crate::halfspace::layer::discs::around_force;
use crate::numerics::dense::Lu;
use crate::problem::layer::WeightedLayer;
use crate::problem::load::Prescribed;
use crate::problem::{
    Accuracy, Asperity, AsperityArray, Feature, Load, Quantity, Question, Requirement, Solver,
};
use crate::solve::rules::fronts::Works;
use crate::state::asperity_contact::{
    AsperityContact, AsperityErrors, AsperitySlopes, AsperityState,
};
use crate::state::discs::{Contacts, Hold};
use crate::state::{Branch, PillarStatus, Run, SolveError, Termination};
use std::f64::consts::PI;
use std::sync::Arc;

/// Relative increase of force and of area of a contact with the principal curvatures `k (1 + e)` and `k (1 - e)`, compared to the disc of
/// curvature `k` at the same depth, divided by `e^2`: the first terms of Hertz's solution for ellipses (K. L. Johnson, Contact Mechanics,
/// section 4.2). On neighbouring contacts, boundary elements give half of that difference or less.
const OVAL: [f64; 2] = [1.0 / 3.0, 4.0 / 9.0];

/// Next terms of both series relative to the first, divided by `e^2` and `e^4`: within 2 % of Hertz's solution up to `e = 0.7`, where the
/// ratio of the curvatures is nearly 6.
const OVAL_HIGHER: [f64; 2] = [0.75, 0.9];

/// Error of a pressure of a lower degree, divided by its difference from the solution two degrees higher. Above 1 because the higher
/// solution has an error too, of a fiftieth or so.
pub(super) const DEGREES: f64 = 1.5;

/// Relative error of the force on a contact that leans on the rim, or fills the top with tension at its edge, divided by the square of the
/// largest edge tension (relative to the mean): a quarter to a third according to boundary elements.
const DRAWN: f64 = 0.5;

/// Degree of the pressure on a contact. The error is estimated with a degree higher by two.
pub(super) fn degree(accuracy: Accuracy) -> usize {
    match accuracy {
        Accuracy::Default => 2,
        Accuracy::Accurate => 4,
    }
}

/// Units of an asperity array: length (m) and pressure (Pa).
#[derive(Debug, Clone, Copy)]
pub(super) struct Units {
    pub(super) length: f64,
    pub(super) pressure: f64,
}

impl Units {
    pub(super) fn force(self) -> f64 {
        self.pressure * self.length * self.length
    }

    pub(super) fn stiffness(self) -> f64 {
        self.pressure * self.length
    }

    pub(super) fn energy(self) -> f64 {
        self.force() * self.length
    }
}

/// Data shared by all contacts of an asperity array.
pub(super) struct Bench {
    pub(super) layout: Layout,
    /// The bodies that are layers, in the unit of length.
    pub(super) layers: Vec<WeightedLayer>,
    pub(super) units: Units,
    /// Works of adhesion of an adhesive floor, in units of modulus and length.
    pub(super) floor_works: Option<Works>,
}

impl Bench {
    pub(super) fn new(field: &AsperityArray) -> Self {
        let radii = field
            .asperities()
            .iter()
            .map(|asperity| asperity.top_radius);
        let units = Units {
            length: radii.fold(0.0, f64::max),
            pressure: field.reduced_modulus(),
        };
        let scaled = |asperity: &Asperity| Asperity {
            apex: asperity.apex.map(|x| x / units.length),
            raised: asperity.raised / units.length,
            top_radius: asperity.top_radius / units.length,
            rim_radius: asperity.rim_radius.map(|radius| radius / units.length),
            column_compliance: asperity.column_compliance * units.pressure * units.length,
        };
        let lens = field.indenter().lens();
        let shape = Shape(lens.map(|lens| lens.in_unit(units.length)));
        let adhesion = field.adhesion();
        let [work, receding] =
            [adhesion.work, adhesion.receding()].map(|work| work / (units.pressure * units.length));
        let works = Works {
            advancing: work,
            receding,
        };
        let asperities = field.asperities().iter().map(scaled).collect();
        let layers = field.weighted_layers(units.length);
        Self {
            layout: Layout::new(asperities, shape, work).on_layers(around_force(&layers)),
            layers,
            units,
            floor_works: (adhesion.floor && work > 0.0).then_some(works),
        }
    }

    pub(super) fn target(&self, load: Load) -> Result<Prescribed, SolveError> {
        let Units { length, pressure } = self.units;
        let load = match load {
            Load::Indentation(value) => {
                Requirement::Finite.check(Quantity::Indentation, value)?;
                load
            }
            other => other.checked(length, pressure)?,
        };
        let scaled = load.map(|value| value / length, |force| force / self.units.force());
        scaled.prescribed().ok_or(SolveError::NoFloor)
    }

    /// Returns the contact with the reason for termination.
    pub(super) fn found(
        &self,
        equations: &mut Equations<'_>,
        found: Found,
    ) -> Result<(Settled, Termination), SolveError> {
        let (settled, termination) = match found {
            Found::Settled(settled) => (settled, Termination::Converged),
            Found::Merging(asperities, contacts) => {
                return Err(SolveError::ContactsMerge {
                    asperities,
                    indentation: contacts.indentation * self.units.length,
                    force: equations.force(&contacts) * self.units.force(),
                });
            }
            Found::Lost(trouble, contacts) => {
                let termination = match trouble {
                    Trouble::NotFinite => Termination::NotFinite,
                    Trouble::Unsettled | Trouble::Crowded(_) => Termination::Stagnated,
                };
                let settled = Settled {
                    contacts,
                    factors: None,
                    steps: newton::STEP_LIMIT,
                };
                (settled, termination)
            }
        };
        self.check(equations, &settled.contacts)?;
        Ok((settled, termination))
    }

    /// Refuses contacts that reach too far from the lens axis, and an asperity that is touched at its rim.
    pub(super) fn check(
        &self,
        equations: &mut Equations<'_>,
        contacts: &Contacts,
    ) -> Result<(), SolveError> {
        if let Some(lens) = &self.layout.shape.0 {
            let reaches = contacts.discs.iter();
            let reaches = reaches.map(|disc| lens.distance(disc.centre) + disc.radius);
            let reach = reaches.fold(0.0, f64::max);
            if reach > lens.largest_contact() {
                return Err(SolveError::beyond(lens, reach, self.units.length));
            }
        }
        if let Some(asperity) = equations.touched_at_rim(contacts) {
            return Err(SolveError::TouchedAtRim {
                asperity,
                rim_radius: equations.rim(asperity) * self.units.length,
            });
        }
        Ok(())
    }

    /// Why a path ended before its end.
    pub(super) fn ended(
        &self,
        ended: Ended,
        contacts: &Contacts,
        force: f64,
    ) -> Result<Termination, SolveError> {
        match ended {
            Ended::Error(error) => Err(error),
            Ended::Trouble(Trouble::Crowded(asperities)) => Err(SolveError::ContactsMerge {
                asperities,
                indentation: contacts.indentation * self.units.length,
                force: force * self.units.force(),
            }),
            Ended::Trouble(Trouble::NotFinite) => Ok(Termination::NotFinite),
            Ended::Trouble(Trouble::Unsettled) => Ok(Termination::Stagnated),
        }
    }

    /// The contact of a state with adhesion, without an error estimate.
    pub(super) fn contact_of(
        &self,
        equations: &Equations<'_>,
        here: &Here,
        accuracy: Accuracy,
    ) -> AsperityContact {
        let Settled {
            contacts, factors, ..
        } = &here.settled;
        let slopes = equations.slopes(contacts, factors.as_ref());
        let steps = here.settled.steps;
        self.assemble(
            equations,
            (contacts.clone(), slopes),
            (Termination::Converged, steps),
            accuracy,
        )
    }

    /// Assembles the result, without an error estimate.
    pub(super) fn contact(
        &self,
        equations: &Equations<'_>,
        settled: Settled,
        termination: Termination,
        accuracy: Accuracy,
    ) -> AsperityContact {
        let slopes = equations.slopes(&settled.contacts, settled.factors.as_ref());
        self.assemble(
            equations,
            (settled.contacts, slopes),
            (termination, settled.steps),
            accuracy,
        )
    }

    fn assemble(
        &self,
        equations: &Equations<'_>,
        (contacts, slopes): (Contacts, [Vec<f64>; 2]),
        (termination, iterations): (Termination, usize),
        accuracy: Accuracy,
    ) -> AsperityContact {
        let Units { length, .. } = self.units;
        let size = equations.modes();
        let mut asperities: Vec<AsperityState> = contacts
            .nearest
            .iter()
            .zip(&contacts.gaps)
            .map(|(place, gap)| AsperityState {
                status: PillarStatus::Untouched,
                centre: place.map(|x| x * length),
                radius: 0.0,
                force: 0.0,
                gap: gap * length,
            })
            .collect();
        for (number, disc) in contacts.discs.iter().enumerate() {
            asperities[disc.asperity] = AsperityState {
                status: match disc.hold {
                    Hold::Whole => PillarStatus::Full,
                    Hold::Free | Hold::Leaning { .. } => PillarStatus::Partial,
                },
                centre: disc.centre.map(|x| x * length),
                radius: disc.radius * length,
                force: UNIT_FORCE * contacts.moments[number * size] * self.units.force(),
                gap: 0.0,
            };
        }
        let area: f64 = contacts.discs.iter().map(|disc| disc.radius.powi(2)).sum();
        let has_axis = self.layout.shape.0.is_some();
        let stiffness = self.units.pressure * length;
        AsperityContact {
            accuracy,
            indentation: contacts.indentation * length,
            force: equations.force(&contacts) * self.units.force(),
            area: PI * area * length * length,
            contact_radius: has_axis.then(|| contacts.reach() * length),
            asperities,
            slopes: AsperitySlopes {
                force_with_indentation: slopes[0].iter().sum::<f64>() * stiffness,
                area_with_indentation: slopes[1].iter().sum::<f64>() * length,
                force_with_height: slopes[0].iter().map(|slope| slope * stiffness).collect(),
                area_with_height: slopes[1].iter().map(|slope| slope * length).collect(),
            },
            error: None,
            floor_gap: None,
            floor: None,
            termination,
            iterations,
            contacts: Arc::new(contacts),
        }
    }
}

impl Equations<'_> {
    /// Error of the force, and relative error of the area, because contacts are modelled as discs rather than ovals, and because of tension
    /// at the edges of contacts that lean on the rim or fill the top.
    pub(super) fn shape_errors(&self, contacts: &Contacts) -> [f64; 2] {
        let size = self.modes();
        // Amplitude of `rho^2 cos(2 theta)` per unit coefficient of its mode.
        let oval = 4.0 / 15.0 * 15f64.sqrt() * PI / UNIT_FORCE;
        let second = eigenvalue(2, 2);
        let (mut doubts, mut total) = ([0.0; 2], 0.0);
        for (disc, moments) in contacts
            .discs
            .iter()
            .zip(contacts.moments.chunks_exact(size))
        {
            let area = disc.radius * disc.radius;
            total += area;
            // The parts of the force with and without adhesion may cancel.
            let [pull, _] = disc.pull();
            let pressed = moments[0].abs() + UNIT_FORCE * pull;
            let curvature = self.layout.summits[disc.asperity].curvature;
            let uneven = moments[4].hypot(moments[5]) * second / (oval * disc.radius);
            let uneven = uneven / (0.5 * curvature * area);
            let square = uneven * uneven;
            let [next, last] = OVAL_HIGHER;
            let mut doubt =
                OVAL.map(|part| part * square * (1.0 + square * (next + square * last)));
            if disc.hold != Hold::Free {
                let [mean, x, y] = self.edge.excess(disc, moments);
                let drawn = (x.hypot(y) - mean).max(0.0) / (pressed / UNIT_FORCE);
                doubt = match disc.hold {
                    Hold::Whole => [0.0; 2],
                    _ => doubt,
                };
                // A disc leaves out most of a narrow contact along the rim of a top whose highest point is beyond it.
                let rim = self.rim(disc.asperity);
                let is_narrow =
                    !self.is_inside(disc.asperity, self.layout.summits[disc.asperity].place);
                let covered = if is_narrow { disc.radius / rim } else { 1.0 };
                doubt[0] += DRAWN * (drawn / covered).powi(2);
                doubt[1] += drawn;
            }
            doubts[0] += pressed * doubt[0];
            doubts[1] += area * doubt[1];
        }
        [UNIT_FORCE * doubts[0], doubts[1] / total]
    }

    /// Derivatives of force and area with respect to the height of every asperity, at constant indentation.
    pub(crate) fn slopes(&self, contacts: &Contacts, factors: Option<&Lu>) -> [Vec<f64>; 2] {
        let mut slopes = [0, 1].map(|_| vec![0.0; self.layout.asperities.len()]);
        let Some(factors) = factors else {
            return slopes;
        };
        let size = self.modes();
        for (slopes, mut adjoint) in slopes.iter_mut().zip(self.rows_of_totals(contacts)) {
            factors.solve_transposed(&mut adjoint);
            for (disc, mean) in contacts.discs.iter().zip(adjoint.iter().step_by(size)) {
                slopes[disc.asperity] = UNIT_FORCE * mean;
            }
        }
        slopes
    }
}

impl Bench {
    /// The contact with adhesion on loading, from first touch on.
    fn loaded(
        &self,
        equations: &mut Equations<'_>,
        target: Prescribed,
        accuracy: Accuracy,
        run: &Run<'_>,
    ) -> Result<AsperityContact, SolveError> {
        let mut path = Path::new(equations, None, run)?;
        let ended = path.follow(Branch::Loading, target.into()).err();
        let Path {
            equations, here, ..
        } = path;
        self.check(equations, &here.settled.contacts)?;
        let mut contact = self.contact_of(equations, &here, accuracy);
        if let Some(ended) = ended {
            contact.termination = self.ended(ended, &here.settled.contacts, here.force)?;
        } else if let Prescribed::Force(force) = target {
            // The iteration ends next to the prescribed force, by rounding.
            contact.force = force * self.units.force();
        }
        Ok(contact)
    }
}

/// The same contacts with a different number of pressure modes.
pub(super) fn with_modes(contacts: &Contacts, from: usize, to: usize) -> Contacts {
    let pad = |moments: &[f64]| -> Vec<f64> {
        let rest = std::iter::repeat_n(0.0, to - from);
        moments.iter().copied().chain(rest).collect()
    };
    Contacts {
        moments: contacts.moments.chunks_exact(from).flat_map(pad).collect(),
        ..contacts.clone()
    }
}

impl AsperityArray {
    /// Computes the contact at a prescribed load, with an error estimate.
    ///
    /// The pressure on a contact has degree 2 with [`Accuracy::Default`] and 4 with [`Accuracy::Accurate`]. The error estimate combines the
    /// difference from the solution two degrees higher with the error of modelling oval contacts as discs, which is computed from the
    /// difference of the curvatures along the two axes.
    ///
    /// With [adhesion](AsperityArray::adhesion) the result is the contact during loading, from first touch on: asperities jump into contact where
    /// they touch the lens. For a prescribed force, it is the first state that reaches this force; for zero force, the lens is in equilibrium
    /// after the jump. The error of the force is then relative to the force or to the sum of the pull-off forces `3/2 pi w R` of all contacts,
    /// whichever is larger, since the force may be zero.
    ///
    /// Past the transition tops and floor are solved together, if the [floor carries load](AsperityArray::is_floor_loaded): it carries
    /// pressures only, unless it is [adhesive](crate::problem::Adhesion::floor) too.
    ///
    /// # Errors
    /// An invalid load, contacts that merge ([`SolveError::ContactsMerge`]), with adhesion an asperity touched at its rim ([`SolveError::TouchedAtRim`]),
    /// a contact too large for the lens or for the memory limit, or cancellation. [`Load::FloorContact`] is the contact of the
    /// [critical state](Self::transition), with [`SolveError::NoFloor`] for an array without a floor. A solution that did not converge is not an error; it is reported by [`AsperityContact::termination`].
    pub fn press(
        &self,
        control: Load,
        accuracy: Accuracy,
        run: &Run<'_>,
    ) -> Result<AsperityContact, SolveError> {
        Question::Press.check(Solver::Asperities, &Feature::of_asperities(self))?;
        if control == Load::FloorContact {
            return Ok(self.transition(accuracy, run)?.contact);
        }
        let bench = Bench::new(self);
        let target = bench.target(control)?;
        let alone = self.solve(&bench, target, (accuracy, None), run);
        if let Some(contact) = self.past_transition(&bench, target, &alone, (accuracy, run))? {
            return contact.checked();
        }
        let mut contact = alone?;
        if contact.converged() {
            contact.error = if self.adhesion().work > 0.0 {
                bench.errors_of(&contact, Aim::Load(target), run)?
            } else {
                bench.estimate(&contact, target, run)?
            };
            if let Some(depth) = self.floor() {
                contact.floor_gap = bench.floor_gap(&contact, depth, run)?;
            }
        }
        contact.checked()
    }

    /// The contact with tops and floor, from that with the tops alone; `None` if the floor carries no load, or if its load is not computed.
    fn past_transition(
        &self,
        bench: &Bench,
        target: Prescribed,
        alone: &Result<AsperityContact, SolveError>,
        (accuracy, run): (Accuracy, &Run<'_>),
    ) -> Result<Option<AsperityContact>, SolveError> {
        let Some(depth) = self.floor().filter(|_| self.is_floor_loaded()) else {
            return Ok(None);
        };
        match alone {
            Ok(alone) if alone.converged() => {
                let floor = bench.floor_gap(alone, depth, run)?;
                match floor.is_some_and(|floor| floor.gap < 0.0) {
                    true => bench.with_floor(target, alone, depth, run),
                    false => Ok(None),
                }
            }
            Err(SolveError::Interrupted) => Ok(None),
            // Contacts that would merge on the tops alone may not with a floor.
            _ => {
                let critical = match self.transition(accuracy, run) {
                    Ok(critical) => critical.contact,
                    Err(SolveError::Interrupted) => return Err(SolveError::Interrupted),
                    Err(_) => return Ok(None),
                };
                let is_past = match target {
                    Prescribed::Indentation(value) => {
                        value * bench.units.length > critical.indentation
                    }
                    Prescribed::Force(force) => force * bench.units.force() > critical.force,
                };
                match is_past && critical.converged() {
                    true => bench.with_floor(target, &critical, depth, run),
                    false => Ok(None),
                }
            }
        }
    }

    /// Computes the contact at a prescribed load without an error estimate. The iteration starts from the contact `near`, if given: one of
    /// an array with asperities in the same places and with the same accuracy, for instance at a slightly different load.
    ///
    /// # Errors
    /// As [`press`](Self::press).
    pub fn press_quickly(
        &self,
        control: Load,
        accuracy: Accuracy,
        near: Option<&AsperityContact>,
        run: &Run<'_>,
    ) -> Result<AsperityContact, SolveError> {
        let bench = Bench::new(self);
        let target = bench.target(control)?;
        let is_alike = |near: &&AsperityContact| {
            near.accuracy == accuracy && near.contacts.nearest.len() == self.asperities().len()
        };
        let near = near.filter(is_alike).map(|near| &*near.contacts);
        self.solve(&bench, target, (accuracy, near), run)?.checked()
    }

    pub(super) fn solve(
        &self,
        bench: &Bench,
        target: Prescribed,
        (accuracy, near): (Accuracy, Option<&Contacts>),
        run: &Run<'_>,
    ) -> Result<AsperityContact, SolveError> {
        let mut equations = Equations::new(&bench.layout, degree(accuracy));
        if self.adhesion().work > 0.0 {
            return bench.loaded(&mut equations, target, accuracy, run);
        }
        let found = equations.find(target, near, run)?;
        let (settled, termination) = bench.found(&mut equations, found)?;
        Ok(bench.contact(&equations, settled, termination, accuracy))
    }
}

impl Bench {
    /// Error estimate of a contact; `None` if the solution of higher degree is not found.
    fn estimate(
        &self,
        contact: &AsperityContact,
        target: Prescribed,
        run: &Run<'_>,
    ) -> Result<Option<AsperityErrors>, SolveError> {
        self.refined(contact, Aim::Load(target), |fine, start| {
            let found = fine.find(target, Some(&start), run)?;
            let (settled, termination) = self.found(fine, found)?;
            Ok((termination == Termination::Converged).then_some(settled))
        })
    }

    /// Error estimate of a contact with adhesion: the asperities in contact are those of the solution, since they depend on the path.
    pub(super) fn errors_of(
        &self,
        contact: &AsperityContact,
        aim: Aim,
        run: &Run<'_>,
    ) -> Result<Option<AsperityErrors>, SolveError> {
        self.refined(contact, aim, |fine, start| {
            Ok(fine.settle_same(start, aim, run)?.ok())
        })
    }

    /// Difference from the solution of higher degree that `find` returns for the contacts to begin with.
    fn refined(
        &self,
        contact: &AsperityContact,
        aim: Aim,
        find: impl FnOnce(&mut Equations<'_>, Contacts) -> Result<Option<Settled>, SolveError>,
    ) -> Result<Option<AsperityErrors>, SolveError> {
        if contact.contacts.discs.is_empty() {
            return Ok(Some(AsperityErrors::default()));
        }
        let low = degree(contact.accuracy);
        let mut fine = Equations::new(&self.layout, low + 2);
        let start = with_modes(&contact.contacts, mode_count(low), fine.modes());
        let settled = find(&mut fine, start)?;
        Ok(settled.map(|settled| {
            let fine = self.contact(&fine, settled, Termination::Converged, contact.accuracy);
            self.difference(contact, &fine, aim)
        }))
    }

    pub(super) fn difference(
        &self,
        contact: &AsperityContact,
        fine: &AsperityContact,
        aim: Aim,
    ) -> AsperityErrors {
        let coarse = Equations::new(&self.layout, degree(contact.accuracy));
        let [force, area] = coarse.shape_errors(&contact.contacts);
        let force = force * self.units.force();
        let scale = contact
            .force
            .abs()
            .max(self.pull_off_scale(&contact.contacts));
        let stiffness = contact.slopes.force_with_indentation;
        let mut errors = AsperityErrors {
            force: (DEGREES * (fine.force - contact.force).abs() + force) / scale,
            area: DEGREES * (fine.area / contact.area - 1.0).abs() + area,
            indentation: DEGREES * (fine.indentation - contact.indentation).abs()
                + force / stiffness.abs(),
        };
        match aim {
            Aim::Load(Prescribed::Indentation(_)) => errors.indentation = 0.0,
            Aim::Load(Prescribed::Force(_)) => errors.force = 0.0,
            Aim::Machine { .. } | Aim::Radius { .. } => {}
        }
        errors
    }

    /// Sum of the pull-off forces of all contacts as isolated ones, N: `3/2 pi w R`. Zero without adhesion.
    pub(super) fn pull_off_scale(&self, contacts: &Contacts) -> f64 {
        let pull = PI * self.layout.grip;
        let forces = contacts.discs.iter().map(|disc| {
            // pi w R, with `w = pi grip^2/2` in units of the modulus.
            0.75 * pull * pull / self.layout.summits[disc.asperity].curvature
        });
        forces.sum::<f64>() * self.units.force()
    }
}
