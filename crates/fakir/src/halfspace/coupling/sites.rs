//! The pillars that may be touched: those of an arrangement within a radius of the lens axis.

use super::window::Window;
use crate::numerics::neighbours::{Nearest, Neighbours};
use crate::problem::column::Column;
use crate::problem::pillar_field::{Counted, PillarBody, PillarField};
use crate::problem::{HexagonalLattice, Point};
use std::sync::OnceLock;

/// Pillars with their positions and bodies.
#[derive(Debug, Clone)]
pub(crate) struct Sites {
    places: Places,
    /// Body of the first pillar, and of all pillars if `bodies` is empty.
    common: PillarBody,
    bodies: Vec<PillarBody>,
    /// Radius that contains all pillars, relative to the lens axis.
    radius: f64,
    neighbours: OnceLock<Neighbours>,
}

#[derive(Debug, Clone)]
enum Places {
    /// Equal tops on a lattice without gaps.
    Window {
        window: Window,
        /// The lattice of equal pillars, if it is hexagonal.
        hexagonal: Option<HexagonalLattice>,
    },
    /// In order of increasing index.
    Listed {
        indices: Vec<(i64, i64)>,
        centres: Vec<Point>,
    },
}

impl Sites {
    /// The pillars within a radius of the lens axis, or those near it if there are none.
    pub(crate) fn within(field: &PillarField, radius: f64) -> Self {
        if let PillarField::Hexagonal {
            lattice, column, ..
        } = field
        {
            let window = Window::new(lattice, radius);
            return Self::of_window(window, *lattice, *column);
        }
        let mut radius = radius;
        let (pillars, all) = loop {
            let (pillars, all) = field.listed_within(radius);
            if !pillars.is_empty() {
                break (pillars, all);
            }
            radius = 2.0 * radius.max(field.spacing());
        };
        let common = pillars[0].1.body;
        let bodies: Vec<PillarBody> = pillars.iter().map(|(_, pillar)| pillar.body).collect();
        let are_alike = bodies.iter().all(|body| *body == common);
        let places = || {
            pillars
                .iter()
                .map(|(index, pillar)| (*index, pillar.centre))
        };
        let window = field.vectors_of_unit_tops().and_then(|vectors| {
            Window::without_gaps(vectors, &places().collect::<Vec<_>>(), radius)
        });
        Self {
            places: match window {
                Some(window) => Places::Window {
                    window,
                    hexagonal: None,
                },
                None => Places::Listed {
                    indices: places().map(|(index, _)| index).collect(),
                    centres: places().map(|(_, centre)| centre).collect(),
                },
            },
            common,
            bodies: if are_alike { Vec::new() } else { bodies },
            radius: if all { f64::INFINITY } else { radius },
            neighbours: OnceLock::new(),
        }
    }

    /// The same pillars with all distances from the lens axis multiplied by a factor.
    pub(crate) fn stretched(&self, factor: f64) -> Self {
        let centres = self.centres().iter();
        Self {
            places: Places::Listed {
                indices: (0..self.len()).map(|pillar| self.index(pillar)).collect(),
                centres: centres.map(|centre| centre.map(|x| x * factor)).collect(),
            },
            radius: self.radius * factor,
            neighbours: OnceLock::new(),
            ..self.clone()
        }
    }

    /// Pillars with these centres and radii, which may overlap; `None` if there are none.
    pub(crate) fn of_bodies(pillars: Vec<(Point, f64)>) -> Option<Self> {
        let body = |radius: f64| PillarBody {
            radius,
            ..PillarBody::of_column(0.0)
        };
        let common = body(pillars.first()?.1);
        let bodies: Vec<PillarBody> = pillars.iter().map(|(_, radius)| body(*radius)).collect();
        let are_alike = bodies.iter().all(|body| *body == common);
        Some(Self {
            places: Places::Listed {
                indices: (0..pillars.len() as i64).map(|k| (k, 0)).collect(),
                centres: pillars.into_iter().map(|(centre, _)| centre).collect(),
            },
            common,
            bodies: if are_alike { Vec::new() } else { bodies },
            radius: f64::INFINITY,
            neighbours: OnceLock::new(),
        })
    }

    /// Pillars of a hexagonal lattice.
    pub(crate) fn of_window(
        window: Window,
        lattice: HexagonalLattice,
        column: impl Into<Column>,
    ) -> Self {
        Self {
            radius: window.radius(),
            places: Places::Window {
                window,
                hexagonal: Some(lattice),
            },
            common: PillarBody::of_column(column),
            bodies: Vec::new(),
            neighbours: OnceLock::new(),
        }
    }

    /// The part of a lattice of equal tops without gaps, if the sites are one.
    pub(crate) fn window(&self) -> Option<&Window> {
        match &self.places {
            Places::Window { window, .. } => Some(window),
            Places::Listed { .. } => None,
        }
    }

    /// The hexagonal lattice of equal pillars of the sites, if there is one.
    pub(crate) fn hexagonal_lattice(&self) -> Option<&HexagonalLattice> {
        match &self.places {
            Places::Window { hexagonal, .. } => hexagonal.as_ref(),
            Places::Listed { .. } => None,
        }
    }

    /// The positions on the lattice of the field; `None` for a list.
    pub(crate) fn on_lattice(&self, field: &PillarField) -> Option<Counted> {
        match &self.places {
            Places::Window {
                window,
                hexagonal: Some(_),
            } => Some(Counted {
                places: window.places().to_vec(),
                vectors: window.vectors(),
            }),
            Places::Window { .. } | Places::Listed { .. } => field.counted(self.centres()),
        }
    }

    /// Number of pillars.
    pub(crate) fn len(&self) -> usize {
        self.centres().len()
    }

    /// Centre of every pillar.
    pub(crate) fn centres(&self) -> &[Point] {
        match &self.places {
            Places::Window { window, .. } => window.centres(),
            Places::Listed { centres, .. } => centres,
        }
    }

    /// The body of a pillar.
    pub(crate) fn body(&self, pillar: usize) -> &PillarBody {
        self.bodies.get(pillar).unwrap_or(&self.common)
    }

    /// Whether all pillars have the common body.
    pub(crate) fn are_alike(&self) -> bool {
        self.bodies.is_empty()
    }

    /// Whether they are a part, around the lens axis, of an infinite lattice of equal pillars.
    pub(crate) fn are_regular(&self) -> bool {
        self.window().is_some() && self.are_alike() && self.radius.is_finite()
    }

    /// The common body, or that of the first pillar.
    pub(crate) fn common_body(&self) -> &PillarBody {
        &self.common
    }

    /// Identifies a pillar independently of which part of the arrangement the sites are.
    pub(crate) fn index(&self, pillar: usize) -> (i64, i64) {
        match &self.places {
            Places::Window { window, .. } => window.index(pillar),
            Places::Listed { indices, .. } => indices[pillar],
        }
    }

    /// Position in the list of the pillar with this index.
    pub(crate) fn find(&self, index: (i64, i64)) -> Option<usize> {
        match &self.places {
            Places::Window { window, .. } => window.find(index),
            Places::Listed { indices, .. } => indices.binary_search(&index).ok(),
        }
    }

    /// Distance of the farthest centre within a radius from the lens axis, along x and along y.
    pub(crate) fn extent(&self, within: f64) -> Point {
        let near = self.centres().iter().filter(|[x, y]| x.hypot(*y) <= within);
        near.fold([0.0, 0.0], |[along_x, along_y], [x, y]| {
            [f64::max(along_x, x.abs()), f64::max(along_y, y.abs())]
        })
    }

    /// Radius that contains all pillars.
    pub(crate) fn radius(&self) -> f64 {
        self.radius
    }

    /// Search structure of the pillars, with their indices in the list.
    pub(crate) fn neighbours(&self) -> &Neighbours {
        self.neighbours.get_or_init(|| {
            let centres = self.centres().iter().enumerate();
            Neighbours::new(centres.map(|(pillar, centre)| (*centre, self.body(pillar).radius)))
        })
    }

    /// Distance of a point from the edge of the nearest pillar; negative inside it.
    pub(crate) fn clearance(&self, point: Point) -> f64 {
        let nearest = self.neighbours().nearest(point, Nearest::Edge, 0.0, None);
        nearest.map_or(f64::INFINITY, |(_, distance)| distance)
    }
}
