//! The floor in contact with adhesive tops beside it: its cells and the fronts on them.

use super::floor::FloorCells;
use super::floor_fronts::{FloorFronts, FloorMove};
use super::fronts::Course;
use crate::halfspace::floor::coupling::FloorKernels;

/// Largest number of rounds in which cells are removed again after an advance.
pub(crate) const TAKE_BACKS: usize = 12;

/// Penetration, relative to the pillar height, above which a gap counts as negative.
pub(crate) const ENTERED: f64 = 1e-5;

/// The rounds in which fronts move by one cell each, until they rest.
pub(crate) struct Rounds {
    course: Course,
    take_backs: usize,
}

impl Rounds {
    pub(crate) fn new(course: Course) -> Self {
        Self {
            course,
            take_backs: 0,
        }
    }

    /// The moves of the next round, in the direction of the course. If nothing moves on loading, cells that have attached too far are removed.
    pub(crate) fn next<T>(
        &mut self,
        mut moves: impl FnMut(FloorMove) -> T,
        is_rest: impl Fn(&T) -> bool,
    ) -> T {
        let natural = moves(natural(self.course));
        let takes_back = self.course == Course::Loading && self.take_backs < TAKE_BACKS;
        if !is_rest(&natural) || !takes_back {
            return natural;
        }
        self.take_backs += 1;
        moves(FloorMove::TakeBack)
    }
}

/// The floor in contact.
pub(crate) struct BondedFloor<'a> {
    pub(crate) cells: FloorCells<'a>,
    pub(crate) fronts: FloorFronts,
    /// Pillars up to this distance from the lens axis are coupled with it.
    pub(crate) reach: f64,
    /// Kernels of its grid.
    pub(crate) kernels: Option<FloorKernels>,
}

/// State of the floor contact.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct FloorStation {
    pub(crate) force: f64,
    pub(crate) area: f64,
    /// Distance of the farthest cell in contact from the lens axis.
    pub(crate) radius: f64,
    /// Number of centres between three pillars of a hexagonal lattice that are in contact; `None` for other arrangements.
    pub(crate) holes: Option<usize>,
}

impl BondedFloor<'_> {
    /// Number of cells in contact.
    pub(crate) fn bonded(&self) -> usize {
        self.cells.loaded().iter().filter(|bonded| **bonded).count()
    }

    /// Contact area.
    pub(crate) fn area(&self) -> f64 {
        self.bonded() as f64 * self.cells.grid.division.cell_area()
    }

    /// Distance of the farthest cell in contact from the lens axis.
    pub(crate) fn radius(&self) -> f64 {
        let cells = self.cells.grid.cells.centres().zip(self.cells.loaded());
        let bonded = cells.filter(|(_, bonded)| **bonded);
        let squared = bonded.map(|([x, y], _)| x * x + y * y);
        squared.fold(0.0, f64::max).sqrt()
    }
}

/// Motion of fronts in the direction of the course.
pub(crate) fn natural(course: Course) -> FloorMove {
    match course {
        Course::Loading => FloorMove::Advance,
        Course::Unloading => FloorMove::Recede,
    }
}
