//! The problem in the units of the solvers: lengths in pillar radii, pressures in units of the
//! reduced modulus, so that forces are in units of `E* (d/2)^2`.

use super::lattice::HexagonalLattice;
use super::pillar_field::PillarField;
use super::point::Point;
use super::system::{Lens, System};

/// Lens radius, in pillar radii, below which the sphere differs from a paraboloid over a single pillar top:
/// by `1/(2R)^2`, so that truncation at degree 2 makes an error of 2e-5 at 8 and 1e-6 here.
pub(crate) const SMALL_LENS: f64 = 40.0;

/// A system in scaled units.
#[derive(Debug, Clone)]
pub(crate) struct Problem {
    /// Lens radius.
    pub(crate) lens: Lens,
    /// Pillar height.
    pub(crate) height: f64,
    pub(crate) lattice: HexagonalLattice,
    /// `kappa`
    pub(crate) column_compliance_ratio: f64,
    /// Unit of length, `d/2`, m.
    pub(crate) length: f64,
    /// Unit of pressure, `E*`, Pa.
    pub(crate) pressure: f64,
}

/// A lens over pillars of any arrangement on a floor. Lengths are in units of a pillar radius: of the only one there is, or of any.
#[derive(Debug, Clone)]
pub(crate) struct Scene {
    /// A [plate](Lens::is_flat) has an infinite radius.
    pub(crate) lens: Lens,
    /// Common height of the pillars: the depth of the floor.
    pub(crate) height: f64,
    pub(crate) field: PillarField,
    /// Unit of length, m.
    pub(crate) length: f64,
}

impl Problem {
    pub(crate) fn new(system: &System) -> Self {
        let length = 0.5 * system.pillar().diameter;
        Self {
            lens: Lens {
                radius: system.lens().radius / length,
                ..*system.lens()
            },
            height: system.pillar().height / length,
            lattice: HexagonalLattice {
                pitch: system.lattice().pitch / length,
                ..*system.lattice()
            },
            column_compliance_ratio: system.column_compliance_ratio(),
            length,
            pressure: system.reduced_modulus(),
        }
    }

    /// Unit of force, N.
    pub(crate) fn force(&self) -> f64 {
        self.pressure * self.length * self.length
    }

    /// Height of the undeformed lens at a point, above its lowest point.
    pub(crate) fn sag(&self, [x, y]: Point) -> f64 {
        self.lens.sag_at_square(x * x + y * y)
    }

    /// The same with a [brim](Lens::sag_with_brim).
    pub(crate) fn sag_with_brim(&self, point: Point) -> f64 {
        self.lens.sag_with_brim(point)
    }

    /// What the solvers of pillars need of it.
    pub(crate) fn scene(&self) -> Scene {
        Scene {
            lens: self.lens,
            height: self.height,
            field: PillarField::Hexagonal {
                lattice: self.lattice,
                column_compliance_ratio: self.column_compliance_ratio,
            },
            length: self.length,
        }
    }

    /// Distance of the nearest pillar top from the lens axis; 0 if the axis is on one.
    pub(crate) fn nearest_edge(&self) -> f64 {
        let (i, j) = self.lattice.nearest_pillar([0.0, 0.0]);
        let [x, y] = self.lattice.centre(i, j);
        (x.hypot(y) - 1.0).max(0.0)
    }

    /// Whether the lens reaches the floor before any pillar.
    pub(crate) fn touches_floor_first(&self) -> bool {
        self.lens.sag(self.nearest_edge()) >= self.height
    }

    /// A point in metres.
    pub(crate) fn metres(&self, point: Point) -> Point {
        [point[0] * self.length, point[1] * self.length]
    }
}
