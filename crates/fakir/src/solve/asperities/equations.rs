//! Equations of contacts with variable position and radius, and their derivatives.
//!
//! For disc `n` with load coefficients `b_n` of the undeformed overlap: `S_n m_n + sum_k C_nk m_k = b_n + zeta b1`, with the conditions on
//! the [edges](super::edge). `S = lambda/r`; the column adds `2 pi K` to the mean, and layers their smooth correction to all `C_nk`, which then
//! include `C_nn`.

use super::edge::Edge;
use super::load::{DiscLoad, FloorForces, Jet, Layout, LoadRule};
use super::loaded_floor::LoadedFloor;
use crate::halfspace::coupling::moving::{MovingPair, PairBlock};
use crate::halfspace::disc::basis::{UNIT_FORCE, eigenvalue};
use crate::numerics::dense::Matrix;
use crate::problem::Point;
use crate::state::discs::{Contacts, Disc};
use std::f64::consts::PI;

/// Data of the equations, for one degree of the pressure.
pub(crate) struct Equations<'a> {
    pub(crate) layout: &'a Layout,
    /// Forces on the floor between the tops.
    pub(crate) floor: FloorForces,
    /// The floor between the tops, if the forces on it are part of the solution.
    pub(crate) ground: Option<LoadedFloor>,
    pub(crate) edge: Edge,
    pub(crate) pair: MovingPair,
    pub(crate) rule: LoadRule,
    /// `lambda` of every mode.
    pub(crate) eigenvalues: Vec<f64>,
    /// Adhesion at the edge of a new contact: see [`Disc::grip`](crate::state::discs::Disc).
    pub(crate) grip: f64,
}

/// The equations linearised at given contacts.
pub(crate) struct Linearised {
    /// Residual displacement, disc by disc.
    pub(crate) missing: Vec<f64>,
    /// Derivatives of the residual with respect to the steps of all discs.
    pub(crate) matrix: Matrix,
}

impl<'a> Equations<'a> {
    pub(crate) fn new(layout: &'a Layout, degree: usize) -> Self {
        let pair = MovingPair::new(degree).on_layers(layout.layers.as_ref());
        let eigenvalues = pair.modes().iter();
        let eigenvalues = eigenvalues.map(|mode| eigenvalue(mode.degree, mode.order));
        Self {
            layout,
            edge: Edge::new(pair.modes()),
            eigenvalues: eigenvalues.collect(),
            rule: LoadRule::new(degree),
            grip: layout.grip,
            floor: FloorForces::default(),
            ground: None,
            pair,
        }
    }

    /// Degree of the pressure.
    pub(crate) fn degree(&self) -> usize {
        self.pair
            .modes()
            .iter()
            .map(|mode| mode.degree)
            .max()
            .unwrap_or(0)
    }

    /// Number of modes of a disc.
    pub(crate) fn modes(&self) -> usize {
        self.eigenvalues.len()
    }

    /// Memory of the equations of this many discs, bytes.
    pub(crate) fn memory(&self, discs: usize) -> usize {
        // The matrix and its factors.
        let size = (discs * self.modes()) as f64;
        (3.0 * 8.0 * size * size) as usize
    }

    /// Radius of the top that carries a disc.
    pub(crate) fn rim(&self, asperity: usize) -> f64 {
        self.layout.asperities[asperity]
            .rim_radius
            .unwrap_or(f64::INFINITY)
    }

    /// Overlap of an asperity with the indenter at zero indentation, less the displacement due to forces on the floor.
    pub(crate) fn overlap(&self, asperity: usize, point: Point) -> Jet {
        self.layout.overlap_with(&self.floor, asperity, point)
    }

    /// The load of this overlap on a disc.
    pub(crate) fn fill_load(&self, disc: &Disc, load: &mut DiscLoad) {
        let overlap = |point| self.overlap(disc.asperity, point);
        self.rule.fill(overlap, (disc.centre, disc.radius), load);
    }

    fn own_compliance(&self, contacts: &Contacts, disc: usize, mode: usize) -> f64 {
        let disc = &contacts.discs[disc];
        let column = if mode == 0 {
            2.0 * PI * self.layout.asperities[disc.asperity].column_compliance
        } else {
            0.0
        };
        self.eigenvalues[mode] / disc.radius + column
    }

    pub(crate) fn prepare(&mut self, contacts: &Contacts) {
        let closest = contacts.closest().map_or(0.0, |(_, part)| part);
        self.pair.prepare(closest);
    }

    fn fill_pair(&self, contacts: &Contacts, [one, two]: [usize; 2], block: &mut PairBlock) {
        let [one, two] = [one, two].map(|k| &contacts.discs[k]);
        let offset = [0, 1].map(|k| one.centre[k] - two.centre[k]);
        self.pair.fill(offset, [one.radius, two.radius], block);
    }

    /// Linearises the equations at contacts that do not overlap. The floor must be [closed](Self::close_floor) under these contacts.
    pub(crate) fn linearised(&mut self, contacts: &Contacts) -> Linearised {
        self.linearised_with(contacts, None)
    }

    /// The same, with the derivatives of the residual with respect to the position along x and y, the radius and the first moment of every
    /// disc: four columns for each disc, whatever its edge condition.
    pub(crate) fn linearised_with(
        &mut self,
        contacts: &Contacts,
        mut unconstrained: Option<&mut Matrix>,
    ) -> Linearised {
        self.prepare(contacts);
        let size = self.modes();
        let count = contacts.discs.len();
        let moments = |disc: usize| &contacts.moments[disc * size..(disc + 1) * size];
        let mut missing = vec![0.0; count * size];
        let mut matrix = Matrix::zeros(count * size, count * size);
        // Derivatives with respect to the position and radius of the disc itself.
        let mut own = vec![[0.0; 3]; count * size];
        let mut load = self.rule.workspace();
        for (number, disc) in contacts.discs.iter().enumerate() {
            self.fill_load(disc, &mut load);
            self.add_own(contacts, number, &load, &mut missing, &mut own);
        }
        let mut block = self.pair.workspace();
        let mut columns = vec![0.0; size * size];
        let mut reduced = vec![0.0; size * size];
        let mut geometry: [Vec<f64>; 3] = std::array::from_fn(|_| vec![0.0; size]);
        for one in 0..count {
            for two in one + 1..count {
                self.fill_pair(contacts, [one, two], &mut block);
                for forward in [true, false] {
                    let (receiver, source) = if forward { (one, two) } else { (two, one) };
                    // Derivatives of the block with respect to the position and radius of the receiver and of the source; in the opposite
                    // direction the block is transposed.
                    let sign = if forward { 1.0 } else { -1.0 };
                    let [of_receiver, of_source] = if forward { [2, 3] } else { [3, 2] };
                    let acting = moments(source);
                    geometry.iter_mut().for_each(|slope| slope.fill(0.0));
                    for row in 0..size {
                        let place = receiver * size + row;
                        for (column, moment) in acting.iter().enumerate() {
                            let at = if forward {
                                row * size + column
                            } else {
                                column * size + row
                            };
                            let value = block.value[at];
                            columns[column * size + row] = value;
                            missing[place] += value * moment;
                            let along = [0, 1].map(|k| sign * block.slopes[k][at] * moment);
                            own[place][0] += along[0];
                            own[place][1] += along[1];
                            own[place][2] += block.slopes[of_receiver][at] * moment;
                            geometry[0][row] -= along[0];
                            geometry[1][row] -= along[1];
                            geometry[2][row] += block.slopes[of_source][at] * moment;
                        }
                    }
                    self.place(
                        contacts,
                        [receiver, source],
                        &columns,
                        &geometry,
                        &mut reduced,
                        (&mut matrix, unconstrained.as_deref_mut()),
                    );
                }
            }
        }
        for number in 0..count {
            columns.fill(0.0);
            if self
                .pair
                .fill_own(contacts.discs[number].radius, &mut block)
            {
                let acting = moments(number);
                for row in 0..size {
                    let place = number * size + row;
                    for (column, moment) in acting.iter().enumerate() {
                        let at = row * size + column;
                        columns[column * size + row] = block.value[at];
                        missing[place] += block.value[at] * moment;
                        own[place][2] += block.slopes[2][at] * moment;
                    }
                }
            }
            for row in 0..size {
                columns[row * size + row] += self.own_compliance(contacts, number, row);
                for (k, slope) in geometry.iter_mut().enumerate() {
                    slope[row] = own[number * size + row][k];
                }
            }
            self.place(
                contacts,
                [number, number],
                &columns,
                &geometry,
                &mut reduced,
                (&mut matrix, unconstrained.as_deref_mut()),
            );
        }
        self.linearise_floor(contacts, &mut matrix);
        Linearised { missing, matrix }
    }

    fn add_own(
        &self,
        contacts: &Contacts,
        number: usize,
        load: &DiscLoad,
        missing: &mut [f64],
        own: &mut [[f64; 3]],
    ) {
        let size = self.modes();
        let radius = contacts.discs[number].radius;
        for mode in 0..size {
            let place = number * size + mode;
            let moment = contacts.moments[place];
            missing[place] +=
                self.own_compliance(contacts, number, mode) * moment - load.value[mode];
            for k in 0..3 {
                own[place][k] -= load.slopes[k][mode];
            }
            own[place][2] -= self.eigenvalues[mode] / (radius * radius) * moment;
        }
        missing[number * size] -= UNIT_FORCE * contacts.indentation;
    }

    fn place(
        &self,
        contacts: &Contacts,
        [receiver, source]: [usize; 2],
        columns: &[f64],
        geometry: &[Vec<f64>; 3],
        reduced: &mut [f64],
        (matrix, unconstrained): (&mut Matrix, Option<&mut Matrix>),
    ) {
        let size = self.modes();
        let disc = &contacts.discs[source];
        if let Some(unconstrained) = unconstrained {
            let [x, y, radius] = geometry;
            for (k, column) in [&x[..], y, radius, &columns[..size]]
                .into_iter()
                .enumerate()
            {
                let place = receiver * size..(receiver + 1) * size;
                unconstrained.column_mut(4 * source + k)[place].copy_from_slice(column);
            }
        }
        let geometry = [0, 1, 2].map(|k| geometry[k].as_slice());
        self.edge
            .reduce(disc, self.rim(disc.asperity), columns, geometry, reduced);
        for (k, column) in reduced.chunks_exact(size).enumerate() {
            let place = receiver * size..(receiver + 1) * size;
            matrix.column_mut(source * size + k)[place].copy_from_slice(column);
        }
    }
}
