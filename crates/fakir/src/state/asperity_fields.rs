//! Displacement, gap and pressure at any point of a contact with rounded tops.

use super::asperity_contact::AsperityContact;
use super::discs::Contacts;
use super::error::SolveError;
use super::run::Run;
use super::samples::{FieldSamples, sample_cells, sample_points};
use crate::halfspace::disc::basis::{BasisEvaluator, compliances, degree_with};
use crate::halfspace::disc::exterior::Exterior;
use crate::halfspace::floor::load::FloorLoad;
use crate::halfspace::layer::discs::{LayerField, around_force};
use crate::problem::{Asperity, AsperityArray, Point};
use std::sync::Arc;

/// The contact with rounded tops as functions of position, in m from the lens axis.
pub struct AsperityFields {
    array: AsperityArray,
    contacts: Arc<Contacts>,
    /// Forces on all tops, N.
    forces: Vec<f64>,
    /// Level of the floor relative to that of zero indentation, m.
    floor: f64,
    indentation: f64,
    /// Unit of length of the contacts, m.
    length: f64,
    modes: usize,
    compliances: Vec<f64>,
    exterior: Exterior,
    /// Correction for layers, in the unit of the contacts; `None` on half-spaces.
    layers: Option<LayerField>,
    pressed: Option<FloorLoad>,
}

impl AsperityContact {
    /// The fields of this contact of an array, with a floor at a depth (m) below the level of zero indentation, which ends the surface between
    /// the tops. `None` for a contact of another array.
    #[must_use]
    pub fn fields(&self, array: &AsperityArray, depth: f64) -> Option<AsperityFields> {
        let contacts = Arc::clone(&self.contacts);
        let modes = match contacts.discs.len() {
            0 => 1,
            discs => contacts.moments.len() / discs,
        };
        let degree = degree_with(modes);
        let radii = array
            .asperities()
            .iter()
            .map(|asperity| asperity.top_radius);
        let length = radii.fold(0.0, f64::max);
        let around = around_force(&array.weighted_layers(length));
        (array.asperities().len() == self.asperities.len()).then(|| AsperityFields {
            forces: self.asperities.iter().map(|state| state.force).collect(),
            array: array.clone(),
            floor: -depth,
            indentation: self.indentation,
            length,
            modes,
            compliances: compliances(degree, 0.0),
            exterior: Exterior::new(degree),
            layers: (around.as_ref())
                .map(|around| LayerField::of_discs(around, degree, contacts.loaded())),
            pressed: (self.floor.as_ref())
                .map(|floor| FloorLoad::new(floor.cells.clone(), floor.pressure.clone()))
                .map(|floor| floor.with_layers(&array.weighted_layers(1.0))),
            contacts,
        })
    }
}

impl AsperityFields {
    /// Positions of a point relative to every contact, in its radii, with the number of the contact.
    fn offsets(&self, position: Point) -> impl Iterator<Item = (usize, Point)> + '_ {
        let discs = self.contacts.discs.iter().enumerate();
        discs.map(move |(number, disc)| {
            let at = |k: usize| (position[k] / self.length - disc.centre[k]) / disc.radius;
            (number, [at(0), at(1)])
        })
    }

    fn moments(&self, number: usize) -> &[f64] {
        &self.contacts.moments[number * self.modes..(number + 1) * self.modes]
    }

    /// Relative normal displacement of the two surfaces due to the pressure, m, without the shortening of pillars.
    #[must_use]
    pub fn displacement(&self, position: Point) -> f64 {
        let mut values = vec![0.0; self.modes];
        let of_disc = |(number, at): (usize, Point)| {
            let moments = self.moments(number);
            let radius = self.contacts.discs[number].radius;
            let inside = at[0] * at[0] + at[1] * at[1] <= 1.0;
            if inside {
                BasisEvaluator::new(degree_with(self.modes)).evaluate(at, &mut values);
            } else {
                self.exterior.values(at, radius, &mut values);
            }
            let modes = moments.iter().zip(&values).zip(&self.compliances);
            let sum: f64 = modes
                .map(|((moment, value), compliance)| {
                    moment * value * if inside { *compliance } else { 1.0 }
                })
                .sum();
            sum / radius
        };
        let layers = self.layers.as_ref();
        let by_layers = layers.map_or(0.0, |it| it.value(position.map(|x| x / self.length)));
        let by_tops = self.offsets(position).map(of_disc).sum::<f64>() + by_layers;
        let by_tops = self.length * by_tops;
        let floor = self.pressed.as_ref();
        let by_floor = floor.map_or(0.0, |floor| floor.displacement(position));
        by_tops + by_floor / self.array.reduced_modulus()
    }

    /// Contact pressure, Pa: zero outside of the contacts, negative where adhesion pulls; infinite at the rim of a full top, and at the edge of
    /// a contact with adhesion.
    #[must_use]
    pub fn pressure(&self, position: Point) -> f64 {
        let mut values = vec![0.0; self.modes];
        for (number, at) in self.offsets(position) {
            let inside = 1.0 - at[0] * at[0] - at[1] * at[1];
            if inside <= 0.0 {
                continue;
            }
            BasisEvaluator::new(degree_with(self.modes)).evaluate(at, &mut values);
            let moments = self.moments(number).iter().zip(&values);
            let density: f64 = moments.map(|(moment, value)| moment * value).sum();
            let disc = &self.contacts.discs[number];
            let density = density / (disc.radius * disc.radius);
            // Without adhesion, tension is an error of the degree of the pressure.
            let density = if disc.grip > 0.0 {
                density
            } else {
                density.max(0.0)
            };
            return density / inside.sqrt() * self.array.reduced_modulus();
        }
        let floor = self.pressed.as_ref();
        floor.map_or(0.0, |floor| floor.pressure(position))
    }

    /// The top at a position: the one with this position within its rim, or the highest of those without a rim, if it is above the floor.
    fn top(&self, [x, y]: Point) -> Option<(usize, f64)> {
        let height = |(number, asperity): (usize, &Asperity)| {
            let [u, v] = [x - asperity.apex[0], y - asperity.apex[1]];
            let square = u * u + v * v;
            let rim = asperity.rim_radius.unwrap_or(f64::INFINITY);
            let own = asperity.raised - 0.5 * square / asperity.top_radius;
            (square <= rim * rim && own > self.floor).then_some((number, own))
        };
        let tops = self.array.asperities().iter().enumerate();
        tops.filter_map(height)
            .max_by(|one, other| one.1.total_cmp(&other.1))
    }

    /// Whether a position is on a top rather than on the floor.
    #[must_use]
    pub fn is_on_top(&self, position: Point) -> bool {
        self.top(position).is_some()
    }

    /// Gap between the lens and the surface below it, m: the top where there is one, otherwise the floor.
    #[must_use]
    pub fn gap(&self, position: Point) -> f64 {
        let [_, gap] = self.displacement_and_gap(position);
        gap
    }

    fn displacement_and_gap(&self, position: Point) -> [f64; 2] {
        let (height, sink) = match self.top(position) {
            Some((number, height)) => {
                let asperity = &self.array.asperities()[number];
                (height, asperity.column_compliance * self.forces[number])
            }
            None => (self.floor, 0.0),
        };
        let lens = self.array.indenter().lens();
        let sag = lens.map_or(0.0, |lens| lens.sag_with_brim(position));
        let displacement = self.displacement(position);
        let gap = sag + displacement + sink - self.indentation - height;
        [displacement, gap]
    }

    /// Displacement, gap and pressure at points, in the same order.
    ///
    /// # Errors
    /// [`SolveError::TooManyPoints`] if the memory limit would be exceeded; interruption.
    pub fn sample(&self, points: &[Point], run: &Run<'_>) -> Result<FieldSamples, SolveError> {
        sample_points(
            points,
            |at| self.displacement_and_gap(at),
            |at| self.pressure(at),
            run,
        )
    }

    /// The same on a grid of equidistant points, x fastest; the pressure is the mean of 16 points in the cell around each point.
    ///
    /// # Errors
    /// As [`sample`](Self::sample).
    pub fn on_grid(&self, x: &[f64], y: &[f64], run: &Run<'_>) -> Result<FieldSamples, SolveError> {
        let others = |at| self.displacement_and_gap(at);
        sample_cells([x, y], others, |at| self.pressure(at), run)
    }
}

/// Omits the tables used for evaluation.
impl std::fmt::Debug for AsperityFields {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("AsperityFields")
            .field("tops", &self.forces.len())
            .finish_non_exhaustive()
    }
}
