//! Contacts with general surfaces for figures: the cells around the lens axis, and sections of the
//! deformed bodies.

use crate::error::FigureError;
use crate::map::Window;
use crate::section::Section;
use crate::text::Text;
use fakir::problem::{Boundary, Grid, HeightMap, Indenter, Point, SurfaceSystem};
use fakir::state::SurfaceContact;
use std::ops::Range;

/// A contact with a general surface, and its label in a figure.
#[derive(Debug, Clone)]
pub struct SurfaceState<'a> {
    /// Label of a panel, such as `mid load`.
    pub label: Text,
    /// The system.
    pub system: &'a SurfaceSystem,
    /// The contact.
    pub contact: &'a SurfaceContact,
    /// Point of first floor contact of a critical state, m.
    pub floor_contact: Option<Point>,
}

/// Margin around the contact, in contact radii.
const PADDING: f64 = 1.25;

/// Smallest fraction of a grid that is shown for a small contact.
const LEAST: f64 = 0.2;

impl SurfaceState<'_> {
    pub(crate) fn grid(&self) -> &Grid {
        &self.contact.grid
    }

    fn is_periodic(&self) -> bool {
        self.system.boundary() == Boundary::Periodic
    }

    /// Centre and half-width of the window, m: the contact of a lens with a margin, or the whole
    /// grid if the indenter is a plate or the grid is periodic.
    pub(crate) fn view(&self) -> (Point, f64) {
        let (start, sides) = (self.grid().origin(), sides(self.grid()));
        let centre = [0, 1].map(|axis| start[axis] + 0.5 * sides[axis]);
        let whole = 0.5 * sides[0].max(sides[1]);
        match (self.contact.contact_radius, self.system.indenter()) {
            (Some(radius), Indenter::Lens(lens))
                if !self.is_periodic() && lens.is_axisymmetric() =>
            {
                let [x, y] = self.floor_contact.unwrap_or_default();
                let wanted = PADDING * radius.max(x.hypot(y));
                let half_width = wanted.max(LEAST * whole).min(whole);
                ([0.0, 0.0], half_width.min(0.7 * lens.widest()))
            }
            _ => (centre, whole),
        }
    }

    /// Cells shown by every pixel of a window, along x and along y. A periodic grid is repeated;
    /// outside the grid of a free surface there are no cells.
    pub(crate) fn cells(&self, window: &Window, pixels: usize) -> [Vec<Option<Range<usize>>>; 2] {
        let middles = window.pixel_coordinates(pixels);
        let half = window.half_width / pixels as f64;
        let (start, cell) = (self.grid().origin(), self.grid().cell());
        let counts = [self.grid().columns(), self.grid().rows()];
        [0, 1].map(|axis| {
            let count = counts[axis] as f64;
            let shown = |middle: &f64| {
                let at = (middle - start[axis]) / cell[axis];
                let turns = if self.is_periodic() {
                    (at / count).floor() * count
                } else {
                    0.0
                };
                let at = at - turns;
                // The centre of a cell is half a cell from its start.
                let reach = half / cell[axis];
                let first = (at - reach - 0.5).ceil().max(0.0);
                let last = (at + reach - 0.5).ceil().min(count);
                if !(0.0..count).contains(&at) {
                    None
                } else if last > first {
                    Some(first as usize..last as usize)
                } else {
                    // A pixel smaller than a cell.
                    Some(at as usize..at as usize + 1)
                }
            };
            middles[axis].iter().map(shown).collect()
        })
    }

    /// Fraction of the displacement that belongs to the indenter.
    fn indenter_share(&self) -> f64 {
        let material = self.system.indenter().material();
        let compliance = material.map_or(0.0, |material| material.plane_strain_compliance());
        compliance / self.system.contact_compliance()
    }

    /// Section along x through the lens axis, or through the row of the grid nearest to it, within
    /// the window.
    ///
    /// # Errors
    /// [`FigureError::TooFewData`] if fewer than two cells are shown.
    pub fn section(&self) -> Result<Section, FigureError> {
        let grid = self.grid();
        let row = (-grid.origin()[1] / grid.cell()[1]).floor();
        let row = (row.max(0.0) as usize).min(grid.rows() - 1);
        let (centre, half_width) = self.view();
        let columns: Vec<usize> = (0..grid.columns())
            .filter(|column| (grid.centre(*column, row)[0] - centre[0]).abs() <= half_width)
            .collect();
        if columns.len() < 2 {
            return Err(FigureError::TooFewData {
                fewest: 2,
                given: columns.len(),
            });
        }
        let surface = self.system.surface();
        let share = self.indenter_share();
        let shortening = self.shortening();
        let cell = |column: &usize| row * grid.columns() + column;
        let height = |column: &usize| {
            let cell = cell(column);
            let column = match self.pillar(cell) {
                HeightMap::NO_PILLAR => 0.0,
                pillar => shortening[pillar as usize],
            };
            let of_halfspaces = self.contact.displacement[cell] - column;
            surface.heights()[cell] - column - (1.0 - share) * of_halfspaces
        };
        let mut section = Section {
            x: Vec::new(),
            lens: Vec::new(),
            surface: Vec::new(),
            floor_contacts: Vec::new(),
            floor_patches: Vec::new(),
        };
        let mut push = |x: f64, lens: f64, surface: f64| {
            section.x.push(x);
            section.lens.push(lens);
            section.surface.push(surface);
        };
        let mut before: Option<(u32, [f64; 3])> = None;
        for column in &columns {
            let label = self.pillar(cell(column));
            let x = grid.centre(*column, row)[0];
            let ground = height(column);
            let lens = ground + self.contact.gap[cell(column)];
            if let Some((last_label, [last_x, last_lens, last_ground])) = before
                && last_label != label
            {
                // The side of a pillar is vertical.
                let (x, lens) = (0.5 * (x + last_x), 0.5 * (lens + last_lens));
                push(x, lens, last_ground);
                push(x, lens, ground);
            }
            push(x, lens, ground);
            before = Some((label, [x, lens, ground]));
        }
        if let Some([x, y]) = self.floor_contact
            && (y - grid.centre(0, row)[1]).abs() < grid.cell()[1]
        {
            let at = |column: &&usize| (grid.centre(**column, row)[0] - x).abs();
            let nearest = columns.iter().min_by(|a, b| at(a).total_cmp(&at(b)));
            section.floor_contacts = nearest
                .map(|column| [x, height(column)])
                .into_iter()
                .collect();
        }
        Ok(section)
    }

    /// The pillar of a cell.
    fn pillar(&self, cell: usize) -> u32 {
        let pillars = self.system.surface().pillars();
        pillars.map_or(HeightMap::NO_PILLAR, |pillars| pillars.labels[cell])
    }

    /// Shortening of every pillar, m.
    fn shortening(&self) -> Vec<f64> {
        let Some(pillars) = self.system.surface().pillars() else {
            return Vec::new();
        };
        let mut force = vec![0.0; pillars.compliance.len()];
        for (cell, pressure) in self.contact.pressure.iter().enumerate() {
            if self.pillar(cell) != HeightMap::NO_PILLAR {
                force[self.pillar(cell) as usize] += pressure * self.grid().cell_area();
            }
        }
        let pillars = force.iter().zip(&pillars.compliance);
        pillars
            .map(|(force, compliance)| force * compliance)
            .collect()
    }
}

/// Extents of a grid, m.
fn sides(grid: &Grid) -> [f64; 2] {
    let counts = [grid.columns(), grid.rows()];
    [0, 1].map(|axis| counts[axis] as f64 * grid.cell()[axis])
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use fakir::problem::pattern::{CrossSection, Pattern, PillarShape, Top};
    use fakir::problem::{Floor, LatticeForm, Load, Material, PillarCompliance, PlaneLattice};
    use fakir::state::Run;

    const HEIGHT: f64 = 1e-6;
    const RUBBER: Material = Material {
        young_modulus: 2e6,
        poisson_ratio: 0.5,
    };

    /// Square rubber pillars with columns, on four periods, under a plate.
    fn system(plate: Option<Material>, substrate: Material) -> SurfaceSystem {
        let pillar = PillarShape {
            cross_section: CrossSection::Square { side: 6e-6 },
            orientation: 0.0,
            height: HEIGHT,
            top: Top::Flat,
            compliance: PillarCompliance::Column,
        };
        let square = PlaneLattice::new(LatticeForm::Square { pitch: 16e-6 });
        let grid = Grid::centred(64, 64, 1e-6).unwrap();
        let surface = Pattern::new(pillar, square).periodic_height_map(&grid, &substrate);
        let plate = Indenter::Flat(plate);
        let system =
            SurfaceSystem::new(plate, substrate, surface.unwrap(), Boundary::Periodic).unwrap();
        system.with_floor(Floor::OffPillars)
    }

    fn section(system: &SurfaceSystem, load: Load) -> (Section, SurfaceContact) {
        let contact = system.press(load, &Run::default()).unwrap();
        let state = SurfaceState {
            label: Text::default(),
            system,
            contact: &contact,
            floor_contact: None,
        };
        (state.section().unwrap(), contact)
    }

    /// A rigid plate remains flat, at the height of the tops minus the indentation, for any
    /// displacement of half-space and pillars: the displacement is divided correctly.
    #[test]
    fn a_rigid_plate_is_flat_in_section() {
        let system = system(None, RUBBER);
        let (section, contact) = section(&system, Load::Force(1e-4));
        let level = HEIGHT - contact.indentation;
        for lens in &section.lens {
            // The relative error of the gap is at most 1e-6 of the indentation.
            assert!((lens - level).abs() < 1e-6 * contact.indentation, "{lens}");
        }
        let lowest = section.surface.iter().copied().fold(0.0, f64::min);
        assert!(lowest < 0.0, "the floor is pulled down beside the pillars");
    }

    /// An almost rigid surface keeps its shape under an elastic plate: the floor is at 0, the tops
    /// are at their height, and the sides are vertical.
    #[test]
    fn a_rigid_substrate_keeps_its_outline() {
        let rigid = Material::new(2e15, 0.5);
        let (section, _) = section(&system(Some(RUBBER), rigid), Load::Force(1e-4));
        for ground in &section.surface {
            let wrong = ground.abs().min((ground - HEIGHT).abs());
            assert!(wrong < 1e-6 * HEIGHT, "{ground}");
        }
        let steps = section.surface.windows(2).zip(section.x.windows(2));
        let steps = steps.filter(|(z, _)| (z[1] - z[0]).abs() > 0.5 * HEIGHT);
        let mut sides = 0;
        for (_, x) in steps {
            assert!((x[1] - x[0]).abs() < 1e-18);
            sides += 1;
        }
        assert_eq!(sides, 8, "both sides of each of four pillars");
    }

    /// Pixels larger than cells show every cell once, smaller pixels the cell around them. A
    /// periodic surface is repeated; there is nothing outside a free surface.
    #[test]
    fn pixels_show_the_cells_that_they_cover() {
        let periodic = system(None, RUBBER);
        let contact = periodic.press(Load::Force(1e-4), &Run::default());
        let contact = contact.unwrap();
        let state = |system| SurfaceState {
            label: Text::default(),
            system,
            contact: &contact,
            floor_contact: None,
        };
        let window = Window::new([0.0, 0.0], 100.0, [0.0, 0.0], 32e-6);
        let [across, _] = state(&periodic).cells(&window, 16);
        assert!(
            across
                .iter()
                .enumerate()
                .all(|(k, cells)| *cells == Some(4 * k..4 * k + 4))
        );
        let [across, up] = state(&periodic).cells(&window, 128);
        assert_eq!(across, up);
        assert!(
            across
                .iter()
                .enumerate()
                .all(|(k, cells)| *cells == Some(k / 2..k / 2 + 1))
        );
        let wide = Window::new([0.0, 0.0], 100.0, [0.0, 0.0], 64e-6);
        let [across, _] = state(&periodic).cells(&wide, 128);
        assert_eq!(across[0], Some(32..33));
        let map = periodic.surface().clone();
        let free = periodic.indenter().clone();
        let free = SurfaceSystem::new(free, RUBBER, map, Boundary::FreeSpace).unwrap();
        let [across, _] = state(&free).cells(&wide, 128);
        assert_eq!((across[31].clone(), across[32].clone()), (None, Some(0..1)));
    }
}
