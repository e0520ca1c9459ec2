//! The floor that sticks, on the [path](super::path) of loading and unloading.
//!
//! With the tops and the floor cells in contact frozen all is one linear problem, with pressures of either sign. After every step of the
//! indentation, at a fixed one, the [fronts](super::rules::floor_fronts) on the floor move a cell at a time as long as they release more energy than it
//! takes, together with the tops. States before that are none: on loading the lens enters the floor in them.

use super::floor::FloorPoint;
use super::floor_start::FloorPressures;
use super::mixed::checked_floor;
use super::newton::FLOOR_DEGREE;
use super::path::Path;
use super::rules::floor::FloorCells;
use super::rules::floor_fronts::{FloorFronts, FloorMove};
use super::rules::fronts::Course;
use crate::halfspace::floor::coupling::{FloorCoupling, FloorKernels, PillarExtent, SurfaceCoupling};
use crate::halfspace::floor::grid::Division;
use crate::problem::Point;
use crate::state::SolveError;

/// Cells between the contact with the floor and the end of the window at the least, and by how much that becomes wider, in distances of pillars.
const WINDOW_CELLS: f64 = 5.0;
const WIDER: f64 = 1.5;

/// Pillars so much farther from the lens axis than those in contact are coupled with the floor, in distances of pillars.
const REACH_MARGIN: f64 = 1.0;

/// A gap below zero by this part of the height of the pillars is one.
const ENTERED: f64 = 1e-5;

/// Rounds in which cells are taken back after an advance.
pub(super) const TAKE_BACKS: usize = 12;

/// The floor where it sticks.
pub(crate) struct StuckFloor<'a> {
    pub(crate) cells: FloorCells<'a>,
    fronts: FloorFronts,
    /// Pillars up to this distance from the lens axis are coupled with it.
    reach: f64,
    kernels: FloorKernels,
}

/// What of the floor is in contact.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct FloorStation {
    pub(crate) force: f64,
    pub(crate) area: f64,
    /// Distance of the farthest cell in contact from the lens axis.
    pub(crate) radius: f64,
    /// Middles between three pillars of a hexagonal lattice that are in contact.
    pub(crate) holes: usize,
}

impl StuckFloor<'_> {
    /// Number of cells in contact.
    pub(super) fn bonded(&self) -> usize {
        self.cells.bears().iter().filter(|bonded| **bonded).count()
    }

    /// Area in contact.
    pub(super) fn area(&self) -> f64 {
        self.bonded() as f64 * self.cells.grid.division.cell_area()
    }

    /// Distance of the farthest cell in contact from the lens axis.
    pub(super) fn radius(&self) -> f64 {
        let cells = self.cells.grid.cells.centres().zip(self.cells.bears());
        let bonded = cells.filter(|(_, bonded)| **bonded);
        bonded.map(|([x, y], _)| x.hypot(y)).fold(0.0, f64::max)
    }
}

impl<'a> Path<'a> {
    /// Lays the cells of a grid, of which those at the points that are `known` are in contact: under the present load and under a
    /// unit indentation they have these pressures.
    pub(super) fn lay_floor(
        &mut self,
        division: Division,
        radius: f64,
        known: &dyn Fn(Point) -> Option<[f64; 2]>,
    ) -> Result<(), SolveError> {
        let reach = self.reach() + REACH_MARGIN * self.scene.field.spacing();
        let on_grid = self.scene.field.pillar_grid().is_some();
        let extent = PillarExtent::new(&self.sites, reach, on_grid);
        let Some(grid) = checked_floor(self.scene, division, radius, extent, self.run)? else {
            return Ok(());
        };
        let mut cells = FloorCells::new(grid, self.run.pool);
        let mut fronts = FloorFronts::new(&cells.grid, self.works);
        let unit_cell = cells.unit_cell();
        let centres: Vec<Point> = cells.grid.cells.centres().collect();
        let known: Vec<Option<[f64; 2]>> = centres.into_iter().map(known).collect();
        for (cell, pressure) in known.iter().enumerate() {
            fronts.set(&mut cells, cell, pressure.is_some());
        }
        let start = |cell: usize| known[cell].unwrap_or_default().map(|p| unit_cell * p);
        let kernels = self.floor.take().map(|floor| floor.kernels);
        let (sites, run, modes) = (&self.sites, self.run, self.contact.modes());
        let degree = FLOOR_DEGREE.min(self.tops.fronts.degree());
        let mut kept = None;
        let couple = |coupling: &mut SurfaceCoupling<'a>| {
            coupling.floor = None;
            let floor = FloorCoupling::new(
                &cells.grid,
                (sites, reach),
                modes,
                degree,
                kernels,
                run.workers(),
                run.pool,
            );
            kept = Some(floor.kernels());
            coupling.floor = Some(Box::new(floor));
        };
        let own_load = cells.lens_load(self.scene);
        self.contact.set_floor(unit_cell, own_load, start, couple);
        if let Some(kernels) = kept {
            self.floor = Some(StuckFloor {
                cells,
                fronts,
                reach,
                kernels,
            });
        }
        self.find_loads();
        Ok(())
    }

    /// The pressure on the floor, if it is in contact.
    pub(super) fn floor_pressures(&self) -> Option<FloorPressures> {
        let floor = self.floor.as_ref()?;
        Some(FloorPressures::of(&floor.cells, &self.contact))
    }

    /// Lays them again: with a window of another radius, or coupled with other pillars.
    pub(super) fn lay_floor_again(
        &mut self,
        pressures: &FloorPressures,
        radius: f64,
    ) -> Result<(), SolveError> {
        let known = |point| pressures.at(point);
        self.lay_floor(pressures.grid.division, radius, &known)
    }

    /// Takes the first cells into contact: those around the lowest one, and others as low.
    pub(super) fn seed_floor(&mut self, lowest: FloorPoint) {
        let Some(floor) = &mut self.floor else {
            return;
        };
        let away = |[x, y]: Point| (x - lowest.position[0]).hypot(y - lowest.position[1]);
        let centres = floor.cells.grid.cells.centres().enumerate();
        let nearest = centres.min_by(|(_, a), (_, b)| away(*a).total_cmp(&away(*b)));
        let Some((nearest, _)) = nearest else {
            return;
        };
        let loads: Vec<f64> = self.contact.floor_load().collect();
        let around = floor.fronts.around(nearest);
        let least = around.map(|cell| loads[cell]).fold(f64::INFINITY, f64::min);
        for (cell, load) in loads.iter().enumerate() {
            if *load >= least {
                floor.fronts.set(&mut floor.cells, cell, true);
            }
        }
    }

    /// The floor is not in contact any more.
    pub(super) fn lift_floor(&mut self) {
        self.floor = None;
        let none = std::iter::empty();
        let lift = |coupling: &mut SurfaceCoupling<'a>| coupling.floor = None;
        self.contact.set_floor(0.0, none, |_| [0.0; 2], lift);
        self.find_loads();
    }

    /// Moves the fronts on the floor by a cell. Returns whether any moved.
    pub(super) fn move_fronts(&mut self, which: FloorMove) -> bool {
        let Some(floor) = &mut self.floor else {
            return false;
        };
        let scale = floor.cells.unit_cell().recip();
        let pressures = self.contact.floor_coefficients().iter().map(|c| scale * c);
        let bonded = floor.cells.bears();
        if which != FloorMove::TakeBack {
            floor
                .fronts
                .measure(bonded, self.contact.floor_load(), pressures);
        }
        let moves = floor
            .fronts
            .moves(bonded, which, ENTERED * self.scene.height);
        let bonds = which == FloorMove::Advance;
        for cell in &moves {
            floor.fronts.set(&mut floor.cells, *cell, bonds);
        }
        !moves.is_empty()
    }

    /// All cells may come into contact again.
    pub(super) fn lift_bans(&mut self) {
        if let Some(floor) = &mut self.floor {
            floor.fronts.lift_bans();
        }
    }

    /// A window that is wide enough for the contact with the floor, and coupled with all pillars in contact.
    pub(super) fn fit_floor(&mut self) -> Result<(), SolveError> {
        let Some(floor) = &self.floor else {
            return Ok(());
        };
        let grid = &floor.cells.grid;
        let needed = floor.radius() + WINDOW_CELLS * grid.division.longest();
        let wider = needed > grid.radius;
        if !wider && self.reach() <= floor.reach {
            return Ok(());
        }
        let radius = if wider {
            needed + WIDER * self.scene.field.spacing()
        } else {
            grid.radius
        };
        match self.floor_pressures() {
            Some(pressures) => self.lay_floor_again(&pressures, radius),
            None => Ok(()),
        }
    }

    /// What of the floor is in contact.
    pub(super) fn floor_station(&self) -> Option<FloorStation> {
        let floor = self.floor.as_ref()?;
        Some(FloorStation {
            force: self.contact.floor_force(),
            area: floor.area(),
            radius: floor.radius(),
            holes: self.filled_holes(),
        })
    }

    fn filled_holes(&self) -> usize {
        let (Some(floor), Some(lattice)) = (&self.floor, self.scene.hexagonal_lattice()) else {
            return 0;
        };
        let grid = &floor.cells.grid;
        let columns = grid.cells.grid().columns();
        let mut bonded = vec![false; grid.cells.grid().cell_count()];
        for (index, own) in grid.cells.indices().zip(floor.cells.bears()) {
            bonded[index] = *own;
        }
        let hole = lattice.pitch / 3f64.sqrt();
        let centres = self.sites.centres().iter();
        let holes = centres.flat_map(|[x, y]| [[x - hole, *y], [x + hole, *y]]);
        holes
            .filter(|point| {
                grid.position_of(*point)
                    .is_some_and(|[column, row]| bonded[row * columns + column])
            })
            .count()
    }
}

/// How fronts go on a course.
pub(super) fn natural(course: Course) -> FloorMove {
    match course {
        Course::Loading => FloorMove::Advance,
        Course::Unloading => FloorMove::Recede,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::scaled::Scene;
    use crate::problem::{HexagonalLattice, PillarCompliance};
    use crate::solve::frozen::Source;
    use crate::solve::path::{End, Held, Stop};
    use crate::solve::rules::floor_fronts::tests::{asymptotes, tables};
    use crate::solve::rules::fronts::{Fronts, Works};
    use crate::state::Run;
    use crate::theory::reference;
    use std::f64::consts::PI;

    /// A lens above a floor of which no pillar is near.
    fn bare(pitch: f64) -> Scene {
        let lattice = reference::lattice(0.03);
        let system = reference::on_lattice(lattice, reference::INTERMEDIATE, PillarCompliance::None);
        Scene {
            field: crate::problem::pillar_field::PillarField::Hexagonal {
                lattice: HexagonalLattice {
                    offset: 1.0 / 3f64.sqrt(),
                    ..HexagonalLattice::new(pitch)
                },
                column_compliance_ratio: 0.0,
            },
            ..Scene::new(&system)
        }
    }

    fn path<'a>(scene: &'a Scene, run: &'a Run<'a>, works: [f64; 2]) -> Path<'a> {
        let [advancing, receding] = works;
        let works = Works {
            advancing,
            receding,
        };
        Path::new(scene, run, Fronts::new(2, 0.0, works, true), Held::Indentation).unwrap()
    }

    /// A flat round punch that pulls: its contact is given, in cells.
    fn flat_punch(path: &mut Path<'_>, division: Division, centre: Point, radius: f64) {
        let near = |[x, y]: Point| (x - centre[0]).hypot(y - centre[1]) < radius;
        path.lay_floor(division, radius + 8.0, &|point| {
            near(point).then_some([0.0; 2])
        })
        .unwrap();
        let tops = path.contact.tops();
        path.contact.own_load_mut()[tops..].fill(0.0);
        path.contact.move_to(-1.0);
        path.solve_within(Source::Present, 1e-7).unwrap();
    }

    #[test]
    fn tables_are_those_of_flat_punches() {
        let run = Run::default();
        let scene = bare(200.0);
        let division = Division::new(&scene.field, 100);
        let side = division.cell_area().sqrt();
        let mut sums = [vec![[0.0; 2]; 9], vec![[0.0; 2]; 13]];
        for (k, radius) in [18.3, 22.1, 26.7, 29.9].into_iter().enumerate() {
            let mut path = path(&scene, &run, [1.0; 2]);
            let centre = [0.37 * k as f64, 0.21 * k as f64];
            flat_punch(&mut path, division, centre, radius);
            let floor = path.floor.as_ref().unwrap();
            let bonded = floor.bonded();
            let effective = (bonded as f64 * division.cell_area() / PI).sqrt();
            // p = -1/(pi sqrt(r^2 - s^2)): K = 1/sqrt(pi r).
            let k = 1.0 / (PI * effective).sqrt();
            let distances = floor.fronts.distances();
            let loads = path.contact.floor_load();
            let pressures = path.contact.floor_coefficients();
            for (((distance, load), pressure), bonded) in distances
                .iter()
                .zip(loads)
                .zip(pressures)
                .zip(floor.cells.bears())
            {
                let [phi, psi] = asymptotes(distance.abs());
                let (which, value, first) = if *bonded {
                    let pressure = pressure / side;
                    (0, -pressure * side.sqrt() / (k * phi), 1.0)
                } else {
                    (1, -load / (k * side.sqrt() * psi), 0.2)
                };
                let at = ((distance.abs() - first) / 0.2).round();
                if at >= 0.0
                    && let Some([sum, count]) = sums[which].get_mut(at as usize)
                    && (distance.abs() - first - 0.2 * at).abs() < 0.1
                {
                    *sum += value;
                    *count += 1.0;
                }
            }
        }
        for ((first, table), sums) in tables().iter().zip(&sums) {
            for (k, (own, [sum, count])) in table.iter().zip(sums).enumerate() {
                println!(
                    "{:.1} {own} {:.3} {count}",
                    first + 0.2 * k as f64,
                    sum / count
                );
            }
        }
    }

    /// A sphere on a flat floor that sticks (Johnson, Kendall & Roberts): pull-off `1.5 pi w R`.
    fn sphere(cells: f64, works: [f64; 2]) {
        let run = Run::default();
        let scene = bare(200.0);
        let lens = scene.lens.sphere_radius();
        let radius: f64 = 12.0;
        // Radius without load: a^3 = 9 pi w R^2/2.
        let work = |radius: f64| 2.0 * radius.powi(3) / (9.0 * PI * lens * lens);
        let w = work(radius);
        let mut path = path(&scene, &run, works.map(|part| part * w));
        let Stop::Floor(lowest) = path.go(Course::Loading, End::Floor, true).unwrap() else {
            panic!("the floor is reached");
        };
        let division = Division::new(&scene.field, (100.0 * cells / radius) as usize);
        path.stick(lowest, division, 25.0).unwrap();
        let jump = path.stations.last().unwrap();
        let found = (jump.floor.unwrap().area / PI).sqrt();
        // At the indentation zero: a^3 = 2 pi w R^2.
        let exact = (2.0 * PI * w * works[0] * lens * lens).cbrt();
        println!(
            "cells {cells}: jump {} | {} cells, events {} products {}",
            found / division.cell_area().sqrt(),
            exact / division.cell_area().sqrt(),
            path.stations.len(),
            path.contact.products()
        );
        path.go(Course::Loading, End::Indentation(scene.height + 0.2), false)
            .unwrap();
        path.go(Course::Unloading, End::Separation, false).unwrap();
        let pull = path.stations.iter().map(|s| s.force).fold(0.0, f64::min);
        println!(
            "pull-off {} products {} stations {} work {} dissipation {}",
            pull / (-1.5 * PI * w * works[1] * lens),
            path.contact.products(),
            path.stations.len(),
            path.energies.work,
            path.energies.dissipation
        );
    }

    #[test]
    fn sphere_on_a_flat_floor() {
        for cells in [5.0, 8.0, 12.0, 25.0] {
            sphere(cells, [1.0; 2]);
        }
    }
}
