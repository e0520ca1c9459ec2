//! The floor as part of the equations of the tops: its effect on their residual, and the derivatives of this effect.

use super::equations::Equations;
use super::load::{FloorForces, Jet, Layout};
use super::loaded_floor::{FloorRates, LoadedFloor};
use crate::halfspace::disc::basis::UNIT_FORCE;
use crate::numerics::dense::Matrix;
use crate::numerics::vector::dot;
use crate::problem::Point;
use crate::state::discs::Contacts;

impl Equations<'_> {
    /// The pressures on all discs as point forces at the points of the rule.
    fn as_forces(&self, contacts: &Contacts) -> FloorForces {
        let of_disc = |((centre, radius), moments): ((Point, f64), &[f64])| {
            let force = |(point, row): (&Point, &[f64])| {
                let at = [0, 1].map(|k| centre[k] + radius * point[k]);
                (at, dot(row, moments))
            };
            self.rule.rows().map(force).collect::<Vec<_>>()
        };
        FloorForces::new(self.layout, contacts.loaded().flat_map(of_disc))
    }

    /// Solves the floor, if it is part of the equations, under these tops. Returns whether the cells in contact were found.
    pub(crate) fn close_floor(&mut self, contacts: &Contacts) -> bool {
        let Some(mut ground) = self.ground.take() else {
            return true;
        };
        let is_closed = ground.close(&self.as_forces(contacts), contacts);
        self.floor = FloorForces::new(self.layout, ground.point_forces());
        self.ground = Some(ground);
        is_closed
    }

    /// Adds the changes of the forces on the floor to the derivatives of the residual.
    pub(super) fn linearise_floor(&mut self, contacts: &Contacts, matrix: &mut Matrix) {
        if let Some(mut ground) = self.ground.take() {
            ground.rates = self.floor_rates_of(&ground, contacts, matrix);
            self.ground = Some(ground);
        }
    }

    /// Derivatives of the force on the floor, if it is part of the equations.
    pub(crate) fn floor_rates(&self) -> Option<&FloorRates> {
        self.ground.as_ref().map(|ground| &ground.rates)
    }

    /// Force on the floor, if it is part of the equations.
    pub(crate) fn force_on_floor(&self) -> f64 {
        self.ground.as_ref().map_or(0.0, LoadedFloor::force)
    }

    /// Derivatives of the forces on the floor; its effect is subtracted from those of the residual of the tops.
    fn floor_rates_of(
        &self,
        floor: &LoadedFloor,
        contacts: &Contacts,
        matrix: &mut Matrix,
    ) -> FloorRates {
        let (size, unknowns) = (self.modes(), contacts.moments.len());
        let count = floor.touched().len();
        // By rows: those of the residual for every cell, and by columns: the displacement of every cell with every component of a step.
        let mut acting = Matrix::zeros(unknowns, count);
        let mut sinking = Matrix::zeros(count, unknowns);
        let mut load = self.rule.workspace();
        let mut reduced = vec![0.0; size];
        for (k, centre) in floor.touched().enumerate() {
            let one = std::iter::once((centre, 1.0));
            let force = FloorForces::new(self.layout, one);
            let potential = |at| force.potential(at);
            for (number, (disc, moments)) in (contacts
                .discs
                .iter()
                .zip(contacts.moments.chunks_exact(size)))
            .enumerate()
            {
                self.rule
                    .fill(potential, (disc.centre, disc.radius), &mut load);
                let place = number * size..(number + 1) * size;
                acting.column_mut(k)[place.clone()].copy_from_slice(&load.value);
                let moved = [0, 1, 2].map(|along| dot(&load.slopes[along], moments));
                let rim = self.rim(disc.asperity);
                (self.edge).reduce_scalar(disc, rim, (&load.value, moved), &mut reduced);
                for (column, value) in place.zip(&reduced) {
                    sinking.column_mut(column)[k] = *value;
                }
            }
        }
        let mut row = vec![0.0; unknowns];
        for (column, row) in row.iter_mut().enumerate() {
            let column = sinking.column_mut(column);
            floor.solve(column);
            *row = -column.iter().sum::<f64>();
        }
        matrix.add_product(-1.0, &acting, &sinking);
        let mut by_indentation = vec![1.0; count];
        floor.solve(&mut by_indentation);
        FloorRates {
            residual: acting.times(&by_indentation),
            force: by_indentation.iter().sum(),
            row,
        }
    }
}

impl FloorForces {
    /// Their displacement at a point, with its derivatives.
    fn potential(&self, at: Point) -> Jet {
        let mut jet = Jet {
            value: 0.0,
            slope: [0.0; 2],
            bend: [0.0; 3],
        };
        self.subtract(at, &mut jet);
        Jet {
            value: -jet.value,
            slope: jet.slope.map(|x| -x),
            bend: jet.bend.map(|x| -x),
        }
    }
}

impl Layout {
    /// Largest height to which the surface is lifted beside these contacts: that of the edge of one of them, where it is highest.
    pub(super) fn lifted_edges(&self, contacts: &Contacts) -> f64 {
        let discs = contacts.discs.iter().zip(contacts.loaded());
        let edges = discs.map(|(disc, (_, moments))| {
            let middle = self.overlap(disc.asperity, disc.centre).value + contacts.indentation;
            let curvature = self.summits[disc.asperity].curvature;
            let column = self.asperities[disc.asperity].column_compliance;
            let shortened = column * UNIT_FORCE * moments[0].abs();
            0.5 * curvature * disc.radius * disc.radius + shortened - middle
        });
        edges.fold(0.0, f64::max)
    }
}
