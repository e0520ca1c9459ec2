//! Derivatives of a contact with rounded tops with respect to the numbers of its array.
//!
//! The residual `R` depends on the contacts and on the numbers. A number changes `R` at fixed contacts; where a contact touches the rim of its
//! top, it also moves the contact with the rim, and the work of adhesion changes the pressure at the edge. For a result `S` of the contacts, with
//! `M v = s` transposed, where `s` are the derivatives of `S` with respect to the steps of Newton's method and `M` is their matrix, the total
//! derivative is `dS - v·dR`, with the changes `dS` and `dR` at constant steps.
//!
//! The indentation `z` of the critical state satisfies `h + f(x) + w(x) = z` at the point `x` of the floor that is nearest to the lens, with the
//! shape `f` of the lens and the displacement `w` of the floor, a result of the contacts like the force. As the gap is the smallest one, its
//! position changes it to second order only.
//!
//! Quantities of layers change the displacement of the surface at fixed contacts, which is evaluated at the points of the load of every contact.

use super::answer::{Bench, degree};
use super::equations::Equations;
use crate::halfspace::disc::basis::UNIT_FORCE;
use crate::halfspace::layer::discs::{LayerField, around_force};
use crate::numerics::dense::{Lu, Matrix};
use crate::numerics::vector::dot;
use crate::problem::layer::WeightedLayer;
use crate::problem::{Accuracy, AsperityArray, Load, Point, Quantity};
use crate::state::asperity_contact::AsperityContact;
use crate::state::asperity_gradient::{AsperityDerivatives, AsperityGradient};
use crate::state::discs::{Contacts, Hold};
use crate::state::{Run, SolveError};
use std::f64::consts::PI;

/// Radius of the disc over which the displacement of the floor is averaged, as a fraction of the smallest distance from an edge of a contact.
const FEELER: f64 = 1e-4;

/// Fraction of the distance between the floor and the centre of a contact that its radius may fill.
const BESIDE: f64 = 0.98;

/// A result of the contacts: its derivatives with respect to the moments, and to position and radius of every disc.
struct Scalar {
    moments: Vec<f64>,
    geometry: Vec<[f64; 3]>,
}

impl Scalar {
    fn none(equations: &Equations<'_>, contacts: &Contacts) -> Self {
        Self {
            moments: vec![0.0; contacts.discs.len() * equations.modes()],
            geometry: vec![[0.0; 3]; contacts.discs.len()],
        }
    }

    fn force(equations: &Equations<'_>, contacts: &Contacts) -> Self {
        let mut scalar = Self::none(equations, contacts);
        let means = scalar.moments.iter_mut().step_by(equations.modes());
        means.for_each(|mean| *mean = UNIT_FORCE);
        scalar
    }

    fn area(equations: &Equations<'_>, contacts: &Contacts) -> Self {
        let mut scalar = Self::none(equations, contacts);
        for (slopes, disc) in scalar.geometry.iter_mut().zip(&contacts.discs) {
            slopes[2] = 2.0 * PI * disc.radius;
        }
        scalar
    }

    /// Displacement at a point outside all contacts; `None` too close to one.
    fn displacement(equations: &mut Equations<'_>, contacts: &Contacts, at: Point) -> Option<Self> {
        let mut scalar = Self::none(equations, contacts);
        let gaps = contacts.discs.iter();
        let gaps = gaps.map(|disc| disc.distance(at) - disc.radius);
        let feeler = FEELER * gaps.fold(f64::INFINITY, f64::min);
        let filled = contacts.discs.iter();
        let filled = filled.map(|disc| (disc.radius + feeler) / disc.distance(at));
        let filled = filled.fold(0.0, f64::max);
        if feeler.is_nan() || feeler <= 0.0 || filled > BESIDE {
            return None;
        }
        equations.pair.prepare(filled);
        let size = equations.modes();
        let mut block = equations.pair.workspace();
        for (number, disc) in contacts.discs.iter().enumerate() {
            let offset = [0, 1].map(|k| at[k] - disc.centre[k]);
            equations
                .pair
                .fill(offset, [feeler, disc.radius], &mut block);
            let place = number * size..(number + 1) * size;
            let acting = &contacts.moments[place.clone()];
            let mean = |values: &[f64]| dot(&values[..size], acting) / UNIT_FORCE;
            let by = block.value[..size].iter().map(|value| value / UNIT_FORCE);
            let moments = scalar.moments[place].iter_mut();
            moments.zip(by).for_each(|(moment, value)| *moment = value);
            let [x, y, _, radius] = &block.slopes;
            scalar.geometry[number] = [-mean(x), -mean(y), mean(radius)];
        }
        Some(scalar)
    }
}

/// Derivatives of one result, in the units of the contacts.
struct Derived {
    asperities: AsperityDerivatives,
    /// With respect to the indentation.
    indentation: f64,
    /// With respect to the [grip](crate::state::discs::Disc) of adhesion.
    grip: f64,
}

/// A quantity of layers, and the derivative of the displacement at fixed contacts.
type LayerChange = (Quantity, LayerField);

/// The linearised equations of a contact.
struct Linear<'a, 'e> {
    equations: &'a Equations<'e>,
    contacts: &'a Contacts,
    factors: Lu,
    /// Derivatives of the residual with respect to position, radius and first moment of every disc.
    unconstrained: Matrix,
    layers: Vec<LayerChange>,
}

impl Linear<'_, '_> {
    fn derived(&self, scalar: &Scalar) -> Derived {
        let Self {
            equations,
            contacts,
            ..
        } = self;
        let layout = equations.layout;
        let size = equations.modes();
        let mut adjoint = vec![0.0; contacts.moments.len()];
        for (number, disc) in contacts.discs.iter().enumerate() {
            let place = number * size..(number + 1) * size;
            let of = (&scalar.moments[place.clone()], scalar.geometry[number]);
            let rim = equations.rim(disc.asperity);
            let reduced = &mut adjoint[place];
            equations.edge.reduce_scalar(disc, rim, of, reduced);
        }
        self.factors.solve_transposed(&mut adjoint);
        let count = layout.asperities.len();
        let mut all = AsperityDerivatives {
            apex: vec![[0.0; 2]; count],
            raised: vec![0.0; count],
            top_radius: vec![0.0; count],
            rim_radius: vec![0.0; count],
            column_compliance: vec![0.0; count],
            lens_radius: 0.0,
            reduced_modulus: 0.0,
            work_of_adhesion: 0.0,
            floor: 0.0,
            layers: (self.layers.iter())
                .map(|(quantity, _)| (*quantity, 0.0))
                .collect(),
        };
        let (mut indentation, mut grip) = (0.0, 0.0);
        for (number, disc) in contacts.discs.iter().enumerate() {
            let asperity = &layout.asperities[disc.asperity];
            let own = &adjoint[number * size..(number + 1) * size];
            let along = |value: &dyn Fn(Point) -> f64| {
                let load = equations.rule.project((disc.centre, disc.radius), value);
                dot(own, &load)
            };
            let column = |k: usize| dot(&adjoint, self.unconstrained.column(4 * number + k));
            let moved = [0, 1, 2].map(|k| scalar.geometry[number][k] - column(k));
            let curvature = asperity.top_radius.recip();
            let away = |point: Point, k: usize| point[k] - asperity.apex[k];
            let raised = UNIT_FORCE * own[0];
            indentation += raised;
            all.raised[disc.asperity] = raised;
            all.column_compliance[disc.asperity] =
                -2.0 * PI * own[0] * contacts.moments[number * size];
            all.top_radius[disc.asperity] = along(&|point| {
                let [x, y] = [0, 1].map(|k| away(point, k));
                0.5 * curvature * curvature * (x * x + y * y)
            });
            let mut apex = [0, 1].map(|k| along(&|point| curvature * away(point, k)));
            match disc.hold {
                Hold::Free => {}
                Hold::Leaning { angle, .. } => {
                    let (sin, cos) = angle.sin_cos();
                    all.rim_radius[disc.asperity] = cos * moved[0] + sin * moved[1];
                    apex = [0, 1].map(|k| apex[k] + moved[k]);
                }
                Hold::Whole => {
                    all.rim_radius[disc.asperity] = moved[2];
                    apex = [0, 1].map(|k| apex[k] + moved[k]);
                }
            }
            all.apex[disc.asperity] = apex;
            if let Some(lens) = &layout.shape.0 {
                all.lens_radius -= along(&|point| lens.by_radius(point));
            }
            for ((_, sum), (_, change)) in all.layers.iter_mut().zip(&self.layers) {
                *sum -= along(&|point| change.value(point));
            }
            let by_moment = scalar.moments[number * size] - column(3);
            grip += by_moment * equations.edge.moment_by_grip(disc);
        }
        Derived {
            asperities: all,
            indentation,
            grip,
        }
    }
}

impl Bench {
    /// Derivatives in SI units. `unit` is that of the result; `by_modulus` is its derivative with respect to the logarithm of the reduced
    /// modulus at constant contacts.
    fn in_si(&self, derived: &Derived, unit: f64, by_modulus: f64) -> AsperityDerivatives {
        let (length, pressure) = (self.units.length, self.units.pressure);
        let by_length = |values: &[f64]| -> Vec<f64> {
            values.iter().map(|value| value * unit / length).collect()
        };
        let of = &derived.asperities;
        let compliances = self.layout.asperities.iter();
        let compliances = compliances.map(|asperity| asperity.column_compliance);
        let pairs = of.column_compliance.iter().zip(compliances);
        let by_columns: f64 = pairs.map(|(slope, compliance)| slope * compliance).sum();
        // The grip is the root of `2 w/(pi E* L)`.
        let by_work = 0.5 * derived.grip * self.layout.grip;
        let work = 0.5 * PI * self.layout.grip.powi(2) * pressure * length;
        AsperityDerivatives {
            apex: of
                .apex
                .iter()
                .map(|slopes| slopes.map(|slope| slope * unit / length))
                .collect(),
            raised: by_length(&of.raised),
            top_radius: by_length(&of.top_radius),
            rim_radius: by_length(&of.rim_radius),
            column_compliance: of
                .column_compliance
                .iter()
                .map(|slope| slope * unit * pressure * length)
                .collect(),
            lens_radius: of.lens_radius * unit / length,
            reduced_modulus: (by_modulus + unit * (by_columns - by_work)) / pressure,
            work_of_adhesion: if work > 0.0 {
                unit * by_work / work
            } else {
                0.0
            },
            floor: of.floor * unit / length,
            layers: (of.layers.iter())
                .map(|(quantity, slope)| (*quantity, slope * unit))
                .collect(),
        }
    }
}

fn refused(why: &'static str) -> SolveError {
    SolveError::NoGradient { why }
}

impl AsperityArray {
    /// Computes the contact at a prescribed load, or the critical state ([`Load::FloorContact`]), with its exact derivatives with respect to all
    /// numbers of the array. With [adhesion](AsperityArray::adhesion) they are those of the contact on loading.
    ///
    /// ```
    /// use fakir::problem::{Accuracy, Asperity, AsperityArray, Indenter, Load, Material};
    /// use fakir::state::Run;
    ///
    /// // Hertz: F = 4/3 E* sqrt(R) zeta^(3/2), so that R dF/dR = F/2.
    /// let asperities = vec![Asperity::new([0.0, 0.0], 1.0e-4)];
    /// let array = AsperityArray::new(Indenter::Flat(None), Material::new(2.0e6, 0.5), asperities)?;
    /// let load = Load::Indentation(1.0e-6);
    /// let gradient = array.gradient(load, Accuracy::Default, &Run::default())?;
    /// let by_radius = gradient.force.ok_or("it is not prescribed")?.top_radius[0];
    /// assert!((1.0e-4 * by_radius / gradient.contact.force - 0.5).abs() < 1e-9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`press`](Self::press) and [`transition`](Self::transition); [`SolveError::NoGradient`] if nothing is touched, if the floor carries
    /// load, if the contact did not converge, and if the critical state is not differentiable.
    pub fn gradient(
        &self,
        load: Load,
        accuracy: Accuracy,
        run: &Run<'_>,
    ) -> Result<AsperityGradient, SolveError> {
        let critical = match load {
            Load::FloorContact => Some(self.transition(accuracy, run)?),
            _ => None,
        };
        let contact = match &critical {
            Some(critical) => critical.contact.clone(),
            None => self.press(load, accuracy, run)?,
        };
        if !contact.converged() {
            return Err(refused("the contact did not converge"));
        }
        if contact.contacts.discs.is_empty() {
            return Err(refused("no pillar is touched; raise the load"));
        }
        if contact.floor.is_some() {
            return Err(refused(
                "the floor carries load, and its derivatives are not computed under rounded tops; lower the load, or ignore the load of the floor",
            ));
        }
        run.check_cancelled()?;
        let bench = Bench::new(self);
        let mut equations = Equations::new(&bench.layout, degree(accuracy));
        let contacts = &*contact.contacts;
        let mut unconstrained = Matrix::zeros(contacts.moments.len(), 4 * contacts.discs.len());
        let linearised = equations.linearised_with(contacts, Some(&mut unconstrained));
        let on_floor = match &critical {
            Some(_) => {
                let depth = self.floor().ok_or(SolveError::NoFloor)?;
                Some(bench.on_floor(&mut equations, &contact, depth)?)
            }
            None => None,
        };
        let linear = Linear {
            equations: &equations,
            contacts,
            factors: Lu::new(linearised.matrix),
            unconstrained,
            layers: bench.layer_changes(self, &equations, contacts),
        };
        let units = bench.units;
        let of_force = linear.derived(&Scalar::force(&equations, contacts));
        let of_area = linear.derived(&Scalar::area(&equations, contacts));
        let stiffness = of_force.indentation * units.stiffness();
        let spread = of_area.indentation * units.length;
        let force = bench.in_si(&of_force, units.force(), contact.force);
        let area = bench.in_si(&of_area, units.length.powi(2), 0.0);
        let indentation = match (load, on_floor) {
            (Load::Indentation(_), _) => None,
            (Load::Force(_), _) => Some(force.times(-stiffness.recip())),
            (Load::FloorContact, Some((at, scalar))) => {
                let mut of_floor = linear.derived(&scalar);
                let lens = bench.layout.shape.0.as_ref();
                let by_shape = lens.map_or(0.0, |lens| lens.by_radius(at));
                of_floor.asperities.lens_radius += by_shape;
                of_floor.asperities.floor = 1.0;
                let changes = of_floor.asperities.layers.iter_mut().zip(&linear.layers);
                changes.for_each(|((_, slope), (_, change))| *slope += change.value(at));
                let rest = 1.0 - of_floor.indentation;
                let found = bench.in_si(&of_floor, units.length, 0.0);
                Some(found.times(rest.recip()))
            }
            (Load::FloorContact, None) => return Err(refused("the floor is not reached anywhere")),
        };
        let gradient = AsperityGradient {
            stiffness,
            area: match &indentation {
                Some(indentation) => area.plus(spread, indentation),
                None => area,
            },
            force: match (load, &indentation) {
                (Load::Force(_), _) => None,
                (_, Some(indentation)) => Some(force.plus(stiffness, indentation)),
                (_, None) => Some(force),
            },
            indentation,
            contact,
            critical,
        };
        gradient.checked()
    }
}

impl Bench {
    fn layer_changes(
        &self,
        array: &AsperityArray,
        equations: &Equations<'_>,
        contacts: &Contacts,
    ) -> Vec<LayerChange> {
        let changes = array.layer_changes(self.units.length).into_iter();
        let field = |(quantity, layers): (Quantity, Vec<WeightedLayer>)| {
            let around = around_force(&layers)?;
            let discs = contacts.loaded();
            let field = LayerField::of_discs(&around, equations.degree(), discs);
            Some((quantity, field))
        };
        changes.filter_map(field).collect()
    }

    /// The point at which the floor is reached, and the displacement there.
    fn on_floor(
        &self,
        equations: &mut Equations<'_>,
        contact: &AsperityContact,
        depth: f64,
    ) -> Result<(Point, Scalar), SolveError> {
        let floor = contact.floor_gap.filter(|floor| floor.gap <= 0.0);
        let floor = floor.ok_or_else(|| {
            refused("the floor is reached while a top jumps into contact; change the load a little")
        })?;
        let at = floor.position.map(|x| x / self.units.length);
        if self.is_at_edge(at, depth / self.units.length) {
            return Err(refused(
                "the lens reaches the floor at the edge of a pillar, which moves with the pillar; derivatives at a load below are supported",
            ));
        }
        let scalar = Scalar::displacement(equations, &contact.contacts, at);
        let scalar = scalar.ok_or_else(|| {
            refused("the lens reaches the floor beside the edge of a contact; derivatives at a load below are supported")
        })?;
        Ok((at, scalar))
    }
}
