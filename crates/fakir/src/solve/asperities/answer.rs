//! Contacts in SI units, with gradients and error estimates.

use super::climb::Found;
use super::equations::Equations;
use super::load::{Layout, Shape};
use super::newton::{self, Settled, Trouble};
use crate::halfspace::disc::basis::{UNIT_FORCE, eigenvalue, mode_count};
use crate::numerics::dense::Lu;
use crate::problem::load::Prescribed;
use crate::problem::{Accuracy, Asperity, AsperityArray, Load, Quantity, Requirement};
use crate::state::asperity_contact::{
    AsperityContact, AsperityErrors, AsperitySlopes, AsperityState,
};
use crate::state::discs::{Contacts, Hold};
use crate::state::{PillarStatus, Run, SolveError, Termination};
use std::f64::consts::PI;
use std::sync::Arc;

/// Relative increase of force and of area of a contact with the principal curvatures `k (1 + e)` and `k (1 - e)`, compared to the disc of
/// curvature `k` at the same depth, divided by `e^2`: the first terms of Hertz's solution for ellipses (K. L. Johnson, Contact Mechanics,
/// section 4.2). On neighbouring contacts, boundary elements give half of that difference or less.
const OVAL: [f64; 2] = [1.0 / 3.0, 4.0 / 9.0];

/// Error of a pressure of a lower degree, divided by its difference from the solution two degrees higher. Above 1 because the higher
/// solution has an error too, of a fiftieth or so.
const DEGREES: f64 = 1.5;

/// Relative error of the force on a contact that leans on the rim, or fills the top with tension at its edge, divided by the square of the
/// largest edge tension (relative to the mean): a quarter to a third according to boundary elements.
const DRAWN: f64 = 0.5;

/// Largest contact allowed, as a fraction of the lens radius.
const LARGEST_CONTACT: f64 = 0.5;

/// Degree of the pressure on a contact. The error is estimated with a degree higher by two.
fn degree(accuracy: Accuracy) -> usize {
    match accuracy {
        Accuracy::Default => 2,
        Accuracy::Accurate => 4,
    }
}

/// Units of an asperity array: length (m) and pressure (Pa).
#[derive(Debug, Clone, Copy)]
struct Units {
    length: f64,
    pressure: f64,
}

impl Units {
    fn force(self) -> f64 {
        self.pressure * self.length * self.length
    }
}

/// Data shared by all contacts of an asperity array.
struct Bench {
    layout: Layout,
    units: Units,
}

impl Bench {
    fn new(field: &AsperityArray) -> Self {
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
        let shape = Shape {
            radius: field.lens_radius() / units.length,
        };
        Self {
            layout: Layout::new(field.asperities().iter().map(scaled).collect(), shape),
            units,
        }
    }

    fn target(&self, load: Load) -> Result<Prescribed, SolveError> {
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
    fn found(
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
        let reach = reach(&settled.contacts);
        let lens_radius = self.layout.shape.radius;
        if reach > LARGEST_CONTACT * lens_radius {
            return Err(SolveError::ContactExceedsLens {
                contact_radius: reach * self.units.length,
                lens_radius: lens_radius * self.units.length,
            });
        }
        if let Some(asperity) = equations.touched_at_rim(&settled.contacts) {
            return Err(SolveError::TouchedAtRim {
                asperity,
                rim_radius: equations.rim(asperity) * self.units.length,
            });
        }
        Ok((settled, termination))
    }

    /// Assembles the result, without an error estimate.
    fn contact(
        &self,
        equations: &Equations<'_>,
        settled: Settled,
        termination: Termination,
        accuracy: Accuracy,
    ) -> AsperityContact {
        let Units { length, .. } = self.units;
        let size = equations.modes();
        let contacts = settled.contacts;
        let slopes = equations.slopes(&contacts, settled.factors.as_ref());
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
        let lens = self.layout.shape.radius.is_finite();
        let stiffness = self.units.pressure * length;
        AsperityContact {
            accuracy,
            indentation: contacts.indentation * length,
            force: equations.force(&contacts) * self.units.force(),
            area: PI * area * length * length,
            contact_radius: lens.then(|| reach(&contacts) * length),
            asperities,
            slopes: AsperitySlopes {
                force_with_indentation: slopes[0].iter().sum::<f64>() * stiffness,
                area_with_indentation: slopes[1].iter().sum::<f64>() * length,
                force_with_height: slopes[0].iter().map(|slope| slope * stiffness).collect(),
                area_with_height: slopes[1].iter().map(|slope| slope * length).collect(),
            },
            error: None,
            termination,
            iterations: settled.steps,
            contacts: Arc::new(contacts),
        }
    }
}

/// Distance from the lens axis to the farthest point in contact.
fn reach(contacts: &Contacts) -> f64 {
    let reaches = contacts.discs.iter();
    let reaches = reaches.map(|disc| disc.centre[0].hypot(disc.centre[1]) + disc.radius);
    reaches.fold(0.0, f64::max)
}

impl Equations<'_> {
    /// Relative errors of force and area because contacts are modelled as discs rather than ovals, and because of tension at the edges of
    /// contacts that lean on the rim or fill the top.
    fn shape_errors(&self, contacts: &Contacts) -> [f64; 2] {
        let size = self.modes();
        // Amplitude of `rho^2 cos(2 theta)` per unit coefficient of its mode.
        let oval = 4.0 / 15.0 * 15f64.sqrt() * PI / UNIT_FORCE;
        let second = eigenvalue(2, 2);
        let (mut doubts, mut totals) = ([0.0; 2], [0.0; 2]);
        for (disc, moments) in contacts
            .discs
            .iter()
            .zip(contacts.moments.chunks_exact(size))
        {
            let area = disc.radius * disc.radius;
            totals[0] += moments[0];
            totals[1] += area;
            let curvature = self.layout.summits[disc.asperity].curvature;
            let uneven = moments[4].hypot(moments[5]) * second / (oval * disc.radius);
            let uneven = uneven / (0.5 * curvature * area);
            let mut doubt = OVAL.map(|part| part * uneven * uneven);
            if disc.hold != Hold::Free {
                let [mean, x, y] = self.edge.values(moments);
                let drawn = (x.hypot(y) - mean).max(0.0) / (moments[0] / UNIT_FORCE);
                doubt = match disc.hold {
                    Hold::Whole => [0.0; 2],
                    _ => doubt,
                };
                doubt[0] += DRAWN * drawn * drawn;
                doubt[1] += drawn;
            }
            doubts[0] += moments[0] * doubt[0];
            doubts[1] += area * doubt[1];
        }
        [doubts[0] / totals[0], doubts[1] / totals[1]]
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

/// The same contacts with a different number of pressure modes.
fn with_modes(contacts: &Contacts, from: usize, to: usize) -> Contacts {
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
    /// # Errors
    /// An invalid load, contacts that merge ([`SolveError::ContactsMerge`]), an asperity touched at its rim ([`SolveError::TouchedAtRim`]),
    /// a contact too large for the lens or for the memory limit, or cancellation. [`Load::FloorContact`] returns [`SolveError::NoFloor`]:
    /// asperities have no floor. A solution that did not converge is not an error; it is reported by [`AsperityContact::termination`].
    pub fn press(
        &self,
        control: Load,
        accuracy: Accuracy,
        run: &Run<'_>,
    ) -> Result<AsperityContact, SolveError> {
        let bench = Bench::new(self);
        let target = bench.target(control)?;
        let mut contact = self.solve(&bench, target, (accuracy, None), run)?;
        if contact.converged() {
            contact.error = bench.estimate(&contact, target, run)?;
        }
        contact.checked()
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

    fn solve(
        &self,
        bench: &Bench,
        target: Prescribed,
        (accuracy, near): (Accuracy, Option<&Contacts>),
        run: &Run<'_>,
    ) -> Result<AsperityContact, SolveError> {
        let mut equations = Equations::new(&bench.layout, degree(accuracy));
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
        if contact.contacts.discs.is_empty() {
            return Ok(Some(AsperityErrors::default()));
        }
        let low = degree(contact.accuracy);
        let mut fine = Equations::new(&self.layout, low + 2);
        let start = with_modes(&contact.contacts, mode_count(low), fine.modes());
        let found = fine.find(target, Some(&start), run)?;
        let (settled, termination) = self.found(&mut fine, found)?;
        if termination != Termination::Converged {
            return Ok(None);
        }
        let fine = self.contact(&fine, settled, termination, contact.accuracy);
        let coarse = Equations::new(&self.layout, low);
        let [force, area] = coarse.shape_errors(&contact.contacts);
        let stiffness = contact.slopes.force_with_indentation;
        let relative = |a: f64, b: f64| (a / b - 1.0).abs();
        let mut errors = AsperityErrors {
            force: DEGREES * relative(fine.force, contact.force) + force,
            area: DEGREES * relative(fine.area, contact.area) + area,
            indentation: DEGREES * (fine.indentation - contact.indentation).abs()
                + force * contact.force / stiffness,
        };
        match target {
            Prescribed::Indentation(_) => errors.indentation = 0.0,
            Prescribed::Force(_) => errors.force = 0.0,
        }
        Ok(Some(errors))
    }
}
