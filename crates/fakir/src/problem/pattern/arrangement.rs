//! Pillars of one form on a lattice or at random, drawn on a grid.

use super::invalid::{InvalidPattern, PatternQuantity};
use super::placement::{Random, Site};
use super::shape::PillarShape;
use crate::numerics::convergence::clamped;
use crate::problem::column::PillarCompliance;
use crate::problem::grid::Grid;
use crate::problem::height_map::{HeightMap, PillarColumns};
use crate::problem::lattice::HexagonalLattice;
use crate::problem::lens::Material;
use crate::problem::pattern::placement;
use crate::problem::point::Point;

/// Where the pillars stand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Arrangement {
    /// On a hexagonal lattice.
    Hexagonal(HexagonalLattice),
    /// On a square lattice with its rows along x and y.
    Square {
        /// Distance between the centres of neighbouring pillars, m.
        pitch: f64,
        /// From a pillar centre to the lens axis, m.
        offset: Point,
    },
    /// At random within the rectangle of the grid, one after the other, each wherever it keeps
    /// its distance from those before (random sequential addition). The rectangle is filled as
    /// one period, so that the pattern can be continued.
    Random {
        /// Fraction of the surface that is pillar; the number of pillars is rounded.
        surface_fraction: f64,
        /// Smallest distance between centres, m.
        minimum_distance: f64,
    },
}

/// A surface patterned with pillars.
///
/// ```
/// use fakir::problem::Grid;
/// use fakir::problem::pattern::{Arrangement, CrossSection, Pattern, PillarShape};
/// use fakir::problem::Material;
///
/// // Square pillars on a square lattice, one in ten missing.
/// let pillar = PillarShape {
///     cross_section: CrossSection::Square { side: 6.0e-6 },
///     ..PillarShape::cylinder(6.0e-6, 2.2e-6)
/// };
/// let arrangement = Arrangement::Square { pitch: 20.0e-6, offset: [0.0, 0.0] };
/// let pattern = Pattern { missing: 0.1, seed: 7, ..Pattern::new(pillar, arrangement) };
/// assert!((pattern.surface_fraction() - 0.9 * 36.0 / 400.0).abs() < 1e-12);
/// let grid = Grid::centred(200, 200, 1.0e-6)?;
/// let surface = pattern.height_map(&grid, &Material::new(2.0e6, 0.5))?;
/// assert_eq!(surface.highest(), 2.2e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pattern {
    /// One pillar.
    pub pillar: PillarShape,
    /// Where they stand.
    pub arrangement: Arrangement,
    /// Fraction of the pillars that are missing; each is with this probability.
    pub missing: f64,
    /// Relative variation of heights: those of the pillars are spread evenly between
    /// `1 - height_half_width` and `1 + height_half_width` times the height.
    pub height_half_width: f64,
    /// Decides everything that is random.
    pub seed: u64,
}

impl Pattern {
    /// A pattern with no pillar missing and all of one height.
    #[must_use]
    pub fn new(pillar: PillarShape, arrangement: Arrangement) -> Self {
        Self {
            pillar,
            arrangement,
            missing: 0.0,
            height_half_width: 0.0,
            seed: 0,
        }
    }

    /// Fraction of the surface that is pillar, on average.
    #[must_use]
    pub fn surface_fraction(&self) -> f64 {
        let area = self.pillar.cross_section.area();
        let complete = match self.arrangement {
            Arrangement::Hexagonal(lattice) => area / lattice.cell_area(),
            Arrangement::Square { pitch, .. } => area / (pitch * pitch),
            Arrangement::Random {
                surface_fraction, ..
            } => surface_fraction,
        };
        (1.0 - self.missing) * complete
    }

    /// The surface on the cells of a grid, whose origin of coordinates is the lens axis. Columns
    /// are of the material `substrate`.
    ///
    /// # Errors
    /// A value that cannot be, pillars that overlap, or more of them than find a place at
    /// random: see [`InvalidPattern`].
    pub fn height_map(
        &self,
        grid: &Grid,
        substrate: &Material,
    ) -> Result<HeightMap, InvalidPattern> {
        self.check()?;
        self.draw(grid, &self.sites(grid)?, substrate)
    }

    /// The surface on the cells of a grid that is one period of it: pillars that reach over its
    /// border go on at the other side, as the same pillar. A grid border should not pass through
    /// centres of pillars.
    ///
    /// # Errors
    /// As [`height_map`](Self::height_map); [`InvalidPattern::NotAPeriod`] if the sides of the
    /// grid are not whole multiples of those of [`period`](Self::period).
    pub fn periodic_height_map(
        &self,
        grid: &Grid,
        substrate: &Material,
    ) -> Result<HeightMap, InvalidPattern> {
        self.check()?;
        let sites = self.sites(grid)?;
        let Some(period) = self.period() else {
            return self.draw(grid, &sites, substrate);
        };
        let extent = placement::extent(grid);
        for (side, period) in extent.into_iter().zip(period) {
            let count = side / period;
            if count < 0.5 || (count - count.round()).abs() > 1e-9 * count {
                return Err(InvalidPattern::NotAPeriod { side, period });
            }
        }
        self.draw(grid, &placement::continued(sites, grid), substrate)
    }

    /// Sides of the smallest rectangle along x and y that repeats on the complete lattice, m; none
    /// of a random arrangement, which takes any rectangle as its period.
    #[must_use]
    pub fn period(&self) -> Option<Point> {
        match self.arrangement {
            Arrangement::Hexagonal(lattice) => {
                let [x, y] = lattice.lattice_vector(1, 0);
                Some([2.0 * x, 2.0 * y])
            }
            Arrangement::Square { pitch, .. } => Some([pitch, pitch]),
            Arrangement::Random { .. } => None,
        }
    }

    fn draw(
        &self,
        grid: &Grid,
        sites: &[Site],
        substrate: &Material,
    ) -> Result<HeightMap, InvalidPattern> {
        PatternQuantity::YoungModulus.positive(substrate.young_modulus)?;
        let mut drawing = Drawing::new(grid);
        for site in sites {
            let mut random = site.random(self.seed);
            if random.uniform() < self.missing {
                continue;
            }
            let spread = self.height_half_width * (2.0 * random.uniform() - 1.0);
            let height = self.pillar.height * (1.0 + spread);
            let compliance = match self.pillar.compliance {
                PillarCompliance::Column => {
                    height / (substrate.young_modulus * self.pillar.cross_section.area())
                }
                // Elastic ones are refused.
                PillarCompliance::None | PillarCompliance::Elastic => 0.0,
            };
            drawing.add(&self.pillar, site, height, compliance);
        }
        Ok(drawing.finish())
    }

    fn sites(&self, grid: &Grid) -> Result<Vec<Site>, InvalidPattern> {
        let reach = 0.5 * self.pillar.cross_section.outer_diameter();
        match self.arrangement {
            Arrangement::Hexagonal(lattice) => Ok(placement::hexagonal(&lattice, grid, reach)),
            Arrangement::Square { pitch, offset } => {
                Ok(placement::square(pitch, offset, grid, reach))
            }
            Arrangement::Random {
                surface_fraction,
                minimum_distance,
            } => {
                let area = grid.cell_count() as f64 * grid.cell_area();
                let count = surface_fraction * area / self.pillar.cross_section.area();
                let mut random = Random::new(self.seed);
                placement::random(count.round() as usize, minimum_distance, grid, &mut random)
            }
        }
    }

    /// Checks every value, and that pillars do not overlap.
    ///
    /// # Errors
    /// The first of them that cannot be.
    pub fn check(&self) -> Result<(), InvalidPattern> {
        use PatternQuantity as Q;
        let is_fraction = |value: &f64| (0.0..1.0).contains(value);
        Q::Missing.within(
            self.missing,
            is_fraction(&self.missing),
            "from 0 to below 1",
        )?;
        let spread = self.height_half_width;
        Q::HeightHalfWidth.within(spread, is_fraction(&spread), "from 0 to below 1")?;
        self.pillar.check(spread)?;
        if self.pillar.compliance == PillarCompliance::Elastic {
            return Err(InvalidPattern::NotElastic);
        }
        let outer = self.pillar.cross_section.outer_diameter();
        match self.arrangement {
            Arrangement::Hexagonal(lattice) => {
                Q::Pitch.positive(lattice.pitch)?;
                Q::Offset.within(lattice.offset, true, "a finite number")?;
                Q::OffsetAngle.within(lattice.offset_angle, true, "a finite number")?;
                self.check_overlap(lattice.pitch, |i, j| lattice.lattice_vector(i, j))
            }
            Arrangement::Square { pitch, offset } => {
                Q::Pitch.positive(pitch)?;
                for coordinate in offset {
                    Q::Offset.within(coordinate, true, "a finite number")?;
                }
                self.check_overlap(pitch, |i, j| [pitch * i as f64, pitch * j as f64])
            }
            Arrangement::Random {
                surface_fraction: fraction,
                minimum_distance: distance,
            } => {
                Q::SurfaceFraction.within(fraction, is_fraction(&fraction), "from 0 to below 1")?;
                let wanted = "at least the outer diameter of a pillar";
                Q::MinimumDistance.within(distance, distance >= outer, wanted)
            }
        }
    }

    fn check_overlap(
        &self,
        pitch: f64,
        vector: impl Fn(i64, i64) -> Point,
    ) -> Result<(), InvalidPattern> {
        let outline = &self.pillar.cross_section;
        // In a hexagonal lattice a step along each vector brings at least half a pitch.
        let reach = (2.0 * outline.outer_diameter() / pitch)
            .ceil()
            .min(LONGEST_REACH) as i64;
        let mut neighbours = (-reach..=reach)
            .flat_map(|i| (-reach..=reach).map(move |j| (i, j)))
            .filter(|place| *place != (0, 0));
        if neighbours.any(|(i, j)| outline.overlaps(self.pillar.turned_back(vector(i, j)))) {
            return Err(InvalidPattern::Overlap {
                pitch,
                outer_diameter: outline.outer_diameter(),
            });
        }
        Ok(())
    }
}

/// Pillars longer than this many pitches are checked for overlap with neighbours as far only:
/// they overlap with the nearest ones long before.
const LONGEST_REACH: f64 = 30.0;

/// Heights and labels while pillars are drawn on them.
struct Drawing<'a> {
    grid: &'a Grid,
    heights: Vec<f64>,
    labels: Vec<u32>,
    compliance: Vec<f64>,
    /// Height of the highest middle of a pillar on the grid: that of a cone is not the centre of a cell.
    summit: f64,
}

impl<'a> Drawing<'a> {
    fn new(grid: &'a Grid) -> Self {
        Self {
            grid,
            heights: vec![0.0; grid.cell_count()],
            labels: vec![HeightMap::NO_PILLAR; grid.cell_count()],
            compliance: Vec::new(),
            summit: f64::NEG_INFINITY,
        }
    }

    /// Draws a pillar at all places of its site; pillars without a cell get no label.
    fn add(&mut self, pillar: &PillarShape, site: &Site, height: f64, compliance: f64) {
        let label = self.compliance.len() as u32;
        let reach = 0.5 * pillar.cross_section.outer_diameter();
        let mut drawn = false;
        for centre in &site.centres {
            let [columns, rows] = [0, 1].map(|axis| self.span(axis, centre[axis], reach));
            for row in rows {
                for column in columns.clone() {
                    let [x, y] = self.grid.centre(column, row);
                    if let Some(depth) = pillar.depth_at([x - centre[0], y - centre[1]]) {
                        let cell = row * self.grid.columns() + column;
                        self.heights[cell] = height - depth;
                        self.labels[cell] = label;
                        drawn = true;
                    }
                }
            }
            if [0, 1]
                .into_iter()
                .all(|axis| self.holds(axis, centre[axis]))
            {
                self.summit = self.summit.max(height);
            }
        }
        if drawn {
            self.compliance.push(compliance);
        }
    }

    /// Whether a coordinate is on the grid.
    fn holds(&self, axis: usize, coordinate: f64) -> bool {
        let count = [self.grid.columns(), self.grid.rows()][axis] as f64;
        let place = (coordinate - self.grid.origin()[axis]) / self.grid.cell()[axis];
        (0.0..=count).contains(&place)
    }

    /// The columns or rows of cells within `reach` of a coordinate.
    fn span(&self, axis: usize, centre: f64, reach: f64) -> std::ops::Range<usize> {
        let count = [self.grid.columns(), self.grid.rows()][axis] as f64;
        let place =
            |coordinate: f64| (coordinate - self.grid.origin()[axis]) / self.grid.cell()[axis];
        let first = clamped(place(centre - reach).floor(), 0.0, count);
        let last = clamped(place(centre + reach).ceil(), 0.0, count);
        first as usize..last as usize
    }

    fn finish(self) -> HeightMap {
        HeightMap::new(*self.grid, self.heights)
            .map(|surface| surface.with_summit(self.summit))
            .and_then(|surface| {
                surface.with_pillars(PillarColumns {
                    labels: self.labels,
                    compliance: self.compliance,
                })
            })
            .expect("checked patterns have finite heights and compliances")
    }
}
