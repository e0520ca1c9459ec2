//! Draws pillars of one shape, on a lattice or at random positions, on a grid.

use super::invalid::{InvalidPattern, PatternQuantity};
use super::placement::{self, Site};
use super::shape::PillarShape;
use crate::numerics::convergence::clamped;
use crate::problem::arrangement::{Arrangement, LatticeForm, PlaneLattice, RandomPlaces, reduced};
use crate::problem::column::PillarCompliance;
use crate::problem::grid::Grid;
use crate::problem::height_map::{HeightMap, PillarColumns};
use crate::problem::lens::Material;
use crate::problem::point::{Point, combined};
use std::f64::consts::PI;

/// A surface patterned with pillars.
///
/// ```
/// use fakir::problem::pattern::{CrossSection, Pattern, PillarShape};
/// use fakir::problem::{Disorder, Grid, LatticeForm, Material, PlaneLattice, Scatter};
///
/// // Square pillars on a square lattice, one in ten missing.
/// let pillar = PillarShape {
///     cross_section: CrossSection::Square { side: 6.0e-6 },
///     ..PillarShape::cylinder(6.0e-6, 2.2e-6)
/// };
/// let lattice = PlaneLattice {
///     disorder: Disorder { heights: Scatter::uniform(0.0, 7), missing: 0.1 },
///     ..PlaneLattice::new(LatticeForm::Square { pitch: 20.0e-6 })
/// };
/// let pattern = Pattern::new(pillar, lattice);
/// assert!((pattern.surface_fraction() - 0.9 * 36.0 / 400.0).abs() < 1e-12);
/// let grid = Grid::centred(200, 200, 1.0e-6)?;
/// let surface = pattern.height_map(&grid, &Material::new(2.0e6, 0.5))?;
/// assert_eq!(surface.highest(), 2.2e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Pattern {
    /// Shape of the pillars.
    pub pillar: PillarShape,
    /// Positions, on a lattice or at random, and variation of heights.
    pub arrangement: Arrangement,
}

impl Pattern {
    /// Pillars of one shape in an arrangement.
    #[must_use]
    pub fn new(pillar: PillarShape, arrangement: impl Into<Arrangement>) -> Self {
        Self {
            pillar,
            arrangement: arrangement.into(),
        }
    }

    /// Mean fraction of the surface that is covered by pillars.
    #[must_use]
    pub fn surface_fraction(&self) -> f64 {
        self.pillar.cross_section.area() / self.arrangement.cell_area()
    }

    /// The surface on the cells of a grid, with the lens axis at the origin of coordinates. Columns consist of the material `substrate`.
    ///
    /// # Errors
    /// An invalid value, overlapping pillars, or random positions that cannot be placed: see [`InvalidPattern`].
    pub fn height_map(
        &self,
        grid: &Grid,
        substrate: &Material,
    ) -> Result<HeightMap, InvalidPattern> {
        self.check()?;
        self.draw(grid, &self.sites(grid)?, substrate)
    }

    /// The surface on the cells of a grid that is one period of it: pillars that cross its border continue on the opposite side, as the
    /// same pillar. The grid border should not pass through centres of pillars.
    ///
    /// # Errors
    /// As for [`height_map`](Self::height_map); [`InvalidPattern::NoPeriod`] for an infinite lattice that is rotated or oblique, and
    /// [`InvalidPattern::NotAPeriod`] if the sides of the grid are not integer multiples of those of [`period`](Self::period).
    pub fn periodic_height_map(
        &self,
        grid: &Grid,
        substrate: &Material,
    ) -> Result<HeightMap, InvalidPattern> {
        self.check()?;
        let sites = self.sites(grid)?;
        let Some(lattice) = self.arrangement.lattice() else {
            return self.draw(grid, &sites, substrate);
        };
        if lattice.columns.is_none() {
            let period = self.period().ok_or(InvalidPattern::NoPeriod)?;
            let extent = placement::extent(grid);
            for (side, period) in extent.into_iter().zip(period) {
                let count = side / period;
                if count < 0.5 || (count - count.round()).abs() > 1e-9 * count {
                    return Err(InvalidPattern::NotAPeriod { side, period });
                }
            }
        }
        self.draw(grid, &placement::continued(sites, grid), substrate)
    }

    /// Sides of the smallest rectangular period along x and y of the complete lattice, m; `None` for a lattice that is rotated, oblique or
    /// finite. For a finite number of pillars, and for random positions, any rectangle is a period.
    #[must_use]
    pub fn period(&self) -> Option<Point> {
        let lattice = self.arrangement.lattice()?;
        if lattice.columns.is_some() || lattice.rotation != 0.0 {
            return None;
        }
        match lattice.form {
            LatticeForm::Hexagonal { .. } => {
                let [[x, y], _] = lattice.vectors();
                Some([2.0 * x, 2.0 * y])
            }
            LatticeForm::Square { pitch } => Some([pitch, pitch]),
            LatticeForm::Rectangular { pitch, pitch_y } => Some([pitch, pitch_y]),
            LatticeForm::Oblique { .. } => None,
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
        let disorder = self.arrangement.disorder();
        for site in sites {
            let Some(ratio) = disorder.height_ratio(site.index) else {
                continue;
            };
            let height = self.pillar.height * ratio;
            let compliance = match self.pillar.compliance {
                PillarCompliance::Column => {
                    height / (substrate.young_modulus * self.pillar.cross_section.area())
                }
                // Elastic pillars are refused.
                PillarCompliance::None | PillarCompliance::Elastic => 0.0,
            };
            drawing.add(&self.pillar, site, height, compliance);
        }
        Ok(drawing.finish())
    }

    fn sites(&self, grid: &Grid) -> Result<Vec<Site>, InvalidPattern> {
        let reach = 0.5 * self.pillar.cross_section.outer_diameter();
        match (&self.arrangement, self.arrangement.lattice()) {
            (_, Some(lattice)) => Ok(placement::on_lattice(&lattice, grid, reach)),
            (Arrangement::Random(places), None) => placement::random(places, grid),
            _ => Err(InvalidPattern::Listed),
        }
    }

    /// Checks every value, and that pillars do not overlap.
    ///
    /// # Errors
    /// The first invalid value.
    pub fn check(&self) -> Result<(), InvalidPattern> {
        use PatternQuantity as Q;
        let is_fraction = |value: f64| (0.0..1.0).contains(&value);
        let disorder = self.arrangement.disorder();
        Q::Missing.within(
            disorder.missing,
            is_fraction(disorder.missing),
            "from 0 to below 1",
        )?;
        let most = disorder.heights.most();
        Q::HeightHalfWidth.within(most, is_fraction(most), "from 0 to below 1")?;
        self.pillar.check(most)?;
        if self.pillar.compliance == PillarCompliance::Elastic {
            return Err(InvalidPattern::NotElastic);
        }
        let outline = &self.pillar.cross_section;
        match (&self.arrangement, self.arrangement.lattice()) {
            (_, Some(lattice)) => self.check_lattice(&lattice),
            (Arrangement::Random(places), None) => {
                let RandomPlaces {
                    cell_area,
                    minimum_distance: distance,
                    ..
                } = *places;
                let fraction = outline.area() / cell_area;
                Q::SurfaceFraction.within(fraction, is_fraction(fraction), "from 0 to below 1")?;
                let wanted = "at least the outer diameter of a pillar";
                Q::MinimumDistance.within(distance, distance >= outline.outer_diameter(), wanted)
            }
            _ => Err(InvalidPattern::Listed),
        }
    }

    fn check_lattice(&self, lattice: &PlaneLattice) -> Result<(), InvalidPattern> {
        use PatternQuantity as Q;
        Q::Pitch.positive(lattice.form.pitch())?;
        match lattice.form {
            LatticeForm::Hexagonal { .. } | LatticeForm::Square { .. } => {}
            LatticeForm::Rectangular { pitch_y, .. } => Q::Pitch.positive(pitch_y)?,
            LatticeForm::Oblique { pitch_y, angle, .. } => {
                Q::Pitch.positive(pitch_y)?;
                let spans = angle > 0.0 && angle < PI && angle.sin() > FLATTEST;
                Q::LatticeAngle.within(
                    angle,
                    spans,
                    "between the rows, above 0 and below 180 deg",
                )?;
            }
        }
        for (quantity, value) in [
            (Q::Offset, lattice.offset),
            (Q::OffsetAngle, lattice.offset_angle),
            (Q::Rotation, lattice.rotation),
        ] {
            quantity.within(value, true, "a finite number")?;
        }
        let outline = &self.pillar.cross_section;
        let vectors = reduced(lattice.vectors());
        let pitch = vectors[0][0].hypot(vectors[0][1]);
        // A step along a reduced vector covers at least half the shortest vector.
        let reach = (2.0 * outline.outer_diameter() / pitch)
            .ceil()
            .min(LONGEST_REACH) as i64;
        let mut neighbours = (-reach..=reach)
            .flat_map(|i| (-reach..=reach).map(move |j| (i, j)))
            .filter(|index| *index != (0, 0))
            .map(|(i, j)| combined(vectors, [i as f64, j as f64]));
        if neighbours.any(|vector| outline.overlaps(self.pillar.turned_back(vector))) {
            return Err(InvalidPattern::Overlap {
                pitch: lattice.form.pitch(),
                outer_diameter: outline.outer_diameter(),
            });
        }
        Ok(())
    }
}

/// Smallest sine of the angle between the rows of a lattice: pillars of flatter lattices overlap.
const FLATTEST: f64 = 1e-9;

/// Largest number of pitches over which pillars are checked for overlap: pillars longer than this overlap with their nearest neighbours.
const LONGEST_REACH: f64 = 30.0;

/// Heights and labels while pillars are drawn on them.
struct Drawing<'a> {
    grid: &'a Grid,
    heights: Vec<f64>,
    labels: Vec<u32>,
    compliance: Vec<f64>,
    /// Height of the highest pillar centre on the grid: the apex of a cone is not the centre of a cell.
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

    /// Draws a pillar at all positions of its site; pillars without a cell are not labelled.
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
