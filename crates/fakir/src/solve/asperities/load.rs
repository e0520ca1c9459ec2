//! Undeformed gap between the indenter and an asperity.

use crate::halfspace::disc::basis::UNIT_FORCE;
use crate::halfspace::disc::mode_rule::ModeRule;
use crate::halfspace::layer::discs::LayerField;
use crate::halfspace::layer::force::AroundForce;
use crate::problem::point::turned;
use crate::problem::{Asperity, LensShape, Point, ShapedLens};
use std::sync::Arc;

/// Fraction of the radius of a sphere or a cylinder beyond which the shape is extrapolated with constant slope. No allowed contact comes near.
const STEEPEST: f64 = 0.9;

/// Largest number of steps of the search for a summit, and the relative change at which it ends, in radii of curvature.
const SUMMIT_STEPS: usize = 50;
const SUMMIT_TOLERANCE: f64 = 1e-15;

/// A height with its gradient and its second derivatives `[xx, xy, yy]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Jet {
    pub(crate) value: f64,
    pub(crate) slope: Point,
    pub(crate) bend: [f64; 3],
}

/// The indenter: a lens of any shape, or a level plate. Lengths in any unit.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Shape(pub(crate) Option<ShapedLens>);

impl Shape {
    /// Height above the lowest point, or of a tilted plate above its point on the axis.
    pub(crate) fn at(&self, point: Point) -> Jet {
        let level = Jet {
            value: 0.0,
            slope: [0.0; 2],
            bend: [0.0; 3],
        };
        let Some(lens) = &self.0 else {
            return level;
        };
        // Spheres and cylinders have an equator: beyond a part of their radius they are continued with constant slope.
        let widest = match lens.shape {
            LensShape::Sphere { radius } | LensShape::Cylinder { radius, .. } => STEEPEST * radius,
            _ => f64::INFINITY,
        };
        let distance = lens.distance(point);
        let inside = if distance > widest {
            let part = widest / distance;
            match lens.shape {
                LensShape::Cylinder { angle, .. } => {
                    let [along, across] = turned(point, -angle);
                    turned([along, part * across], angle)
                }
                _ => point.map(|x| part * x),
            }
        } else {
            point
        };
        lens.jet(inside).map_or(level, |jet| {
            let beyond = [0, 1].map(|k| jet.gradient[k] * (point[k] - inside[k]));
            Jet {
                value: jet.value + beyond[0] + beyond[1],
                slope: jet.gradient,
                bend: jet.hessian,
            }
        })
    }
}

/// The asperities and the indenter. Lengths in any unit, pressures in units of the reduced modulus.
#[derive(Debug, Clone)]
pub(crate) struct Layout {
    pub(crate) asperities: Vec<Asperity>,
    pub(crate) shape: Shape,
    /// First contact point of each asperity by itself.
    pub(crate) summits: Vec<Summit>,
    /// Adhesion: see [`Disc::grip`](crate::state::discs::Disc).
    pub(crate) grip: f64,
    /// Correction for layers; `None` on half-spaces.
    pub(crate) layers: Option<Arc<AroundForce>>,
}

/// The point of an asperity that is closest to the indenter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Summit {
    pub(crate) place: Point,
    /// Height above the common level minus the height of the indenter above its lowest point: the asperity is touched at an indentation of
    /// minus this value.
    pub(crate) height: f64,
    /// Mean curvature relative to the indenter.
    pub(crate) curvature: f64,
}

impl Layout {
    /// The layout, with a work of adhesion in units of the modulus and the length.
    pub(crate) fn new(asperities: Vec<Asperity>, shape: Shape, work: f64) -> Self {
        let summits = asperities
            .iter()
            .map(|asperity| summit(asperity, &shape))
            .collect();
        Self {
            asperities,
            shape,
            summits,
            grip: (2.0 * work / std::f64::consts::PI).sqrt(),
            layers: None,
        }
    }

    /// The same on layers, with the correction around a force on them.
    pub(crate) fn on_layers(self, layers: Option<Arc<AroundForce>>) -> Self {
        Self { layers, ..self }
    }

    /// The first asperity alone, without a rim.
    pub(crate) fn only_first(&self) -> Self {
        let alone = |asperity: &Asperity| Asperity {
            rim_radius: None,
            ..*asperity
        };
        Self {
            asperities: self.asperities.iter().take(1).map(alone).collect(),
            summits: self.summits.iter().take(1).copied().collect(),
            shape: self.shape.clone(),
            grip: self.grip,
            layers: self.layers.clone(),
        }
    }

    /// Overlap of an asperity with the indenter at zero indentation.
    pub(crate) fn overlap(&self, asperity: usize, point: Point) -> Jet {
        overlap(&self.asperities[asperity], &self.shape, point)
    }

    /// The same if forces on the floor displace the surface.
    pub(crate) fn overlap_with(&self, floor: &FloorForces, asperity: usize, point: Point) -> Jet {
        let mut jet = self.overlap(asperity, point);
        floor.subtract(point, &mut jet);
        jet
    }

    /// Indentation at which the first asperity is touched.
    pub(crate) fn first_touch(&self) -> f64 {
        let heights = self.summits.iter().map(|summit| -summit.height);
        heights.fold(f64::INFINITY, f64::min)
    }
}

fn overlap(asperity: &Asperity, shape: &Shape, point: Point) -> Jet {
    let sag = shape.at(point);
    let [x, y] = [0, 1].map(|k| point[k] - asperity.apex[k]);
    let curvature = asperity.top_radius.recip();
    Jet {
        value: asperity.raised - sag.value - 0.5 * curvature * (x * x + y * y),
        slope: [-sag.slope[0] - curvature * x, -sag.slope[1] - curvature * y],
        bend: [
            -sag.bend[0] - curvature,
            -sag.bend[1],
            -sag.bend[2] - curvature,
        ],
    }
}

fn summit(asperity: &Asperity, shape: &Shape) -> Summit {
    let mut place = asperity.apex;
    for _ in 0..SUMMIT_STEPS {
        let step = to_summit(&overlap(asperity, shape, place));
        place = [place[0] + step[0], place[1] + step[1]];
        if step[0].hypot(step[1]) <= SUMMIT_TOLERANCE * asperity.top_radius {
            break;
        }
    }
    let jet = overlap(asperity, shape, place);
    Summit {
        place,
        height: jet.value,
        curvature: -0.5 * (jet.bend[0] + jet.bend[2]),
    }
}

/// The Newton step to the highest point of a surface with these derivatives.
pub(crate) fn to_summit(jet: &Jet) -> Point {
    let [xx, xy, yy] = jet.bend;
    let [x, y] = jet.slope;
    let determinant = xx * yy - xy * xy;
    [
        (xy * y - yy * x) / determinant,
        (xy * x - xx * y) / determinant,
    ]
}

/// Forces on cells of the floor, as point forces at the centres of the cells: they displace the surface under the tops.
#[derive(Debug, Clone, Default)]
pub(crate) struct FloorForces {
    /// Position and force of every cell in contact; the force is divided by pi, in units of the modulus.
    forces: Vec<(Point, f64)>,
    layers: Option<LayerField>,
}

impl FloorForces {
    pub(crate) fn new(layout: &Layout, forces: impl Iterator<Item = (Point, f64)>) -> Self {
        let scaled = forces.map(|(at, force)| (at, force / std::f64::consts::PI));
        let forces: Vec<_> = scaled.collect();
        let layers = layout.layers.as_ref();
        Self {
            layers: layers.map(|around| LayerField::of_forces(around, forces.clone())),
            forces,
        }
    }

    /// Their displacement at a point.
    pub(crate) fn displacement(&self, [x, y]: Point) -> f64 {
        let forces = self.forces.iter();
        let of_half_space = forces.map(|([u, v], force)| force / (x - u).hypot(y - v));
        let layers = self.layers.as_ref();
        of_half_space.sum::<f64>() + layers.map_or(0.0, |layers| layers.value([x, y]))
    }

    /// Subtracts their displacement from an overlap.
    pub(super) fn subtract(&self, [x, y]: Point, overlap: &mut Jet) {
        let (mut value, mut slope, mut bend) = (0.0, [0.0; 2], [0.0; 3]);
        for ([u, v], force) in &self.forces {
            let (dx, dy) = (x - u, y - v);
            let square = (dx * dx + dy * dy).recip();
            let own = force * square.sqrt();
            let [first, second] = [own * square, 3.0 * own * square * square];
            value += own;
            slope[0] += first * dx;
            slope[1] += first * dy;
            bend[0] += second * dx * dx - first;
            bend[1] += second * dx * dy;
            bend[2] += second * dy * dy - first;
        }
        overlap.value -= value;
        overlap.slope = [0, 1].map(|k| overlap.slope[k] + slope[k]);
        overlap.bend = [0, 1, 2].map(|k| overlap.bend[k] - bend[k]);
        if let Some(layers) = &self.layers {
            let by_layers = layers.jet([x, y]);
            overlap.value -= by_layers.value;
            overlap.slope = [0, 1].map(|k| overlap.slope[k] - by_layers.gradient[k]);
            overlap.bend = [0, 1, 2].map(|k| overlap.bend[k] - by_layers.hessian[k]);
        }
    }
}

/// Projects the overlap over a disc onto the pressure modes.
#[derive(Debug, Clone)]
pub(crate) struct LoadRule(ModeRule);

/// Load coefficients of the overlap over a disc, and their derivatives with respect to its position along x and y and its radius.
#[derive(Debug, Clone)]
pub(crate) struct DiscLoad {
    pub(crate) value: Vec<f64>,
    pub(crate) slopes: [Vec<f64>; 3],
}

impl LoadRule {
    pub(crate) fn new(degree: usize) -> Self {
        // Exact for overlaps of degree 4 and less.
        Self(ModeRule::new(degree, degree / 2 + 3, 2 * degree + 7))
    }

    pub(crate) fn workspace(&self) -> DiscLoad {
        let row = || vec![0.0; self.0.count()];
        DiscLoad {
            value: row(),
            slopes: [row(), row(), row()],
        }
    }

    /// The points on the unit disc, each with the weight times every mode.
    pub(super) fn rows(&self) -> impl Iterator<Item = (&Point, &[f64])> {
        self.0.rows()
    }

    /// Projects a function of the position over a disc.
    pub(crate) fn project(&self, disc: (Point, f64), value: impl Fn(Point) -> f64) -> Vec<f64> {
        let mut projected = vec![0.0; self.0.count()];
        self.0.project(disc, |at, _| value(at), &mut projected);
        projected
    }

    /// Projects an overlap over a disc.
    pub(crate) fn fill(
        &self,
        overlap: impl Fn(Point) -> Jet,
        (centre, radius): (Point, f64),
        load: &mut DiscLoad,
    ) {
        load.value.fill(0.0);
        load.slopes.iter_mut().for_each(|slope| slope.fill(0.0));
        // The overlap at the centre is treated separately, so that the remainder is of the order of the contact size.
        let middle = overlap(centre).value;
        for (point, row) in self.0.rows() {
            let at = [0, 1].map(|k| centre[k] + radius * point[k]);
            let jet = overlap(at);
            let [x, y] = jet.slope;
            let parts = [jet.value - middle, x, y, x * point[0] + y * point[1]];
            let [along_x, along_y, outwards] = &mut load.slopes;
            for (place, weight) in row.iter().enumerate() {
                load.value[place] += weight * parts[0];
                along_x[place] += weight * parts[1];
                along_y[place] += weight * parts[2];
                outwards[place] += weight * parts[3];
            }
        }
        load.value[0] += UNIT_FORCE * middle;
    }
}
