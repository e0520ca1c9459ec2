//! The floor between pillars bonded to the lens: free annuli around the pillars, and the threshold of collapse.
//!
//! `E*` is the reduced modulus (Pa), `a` the radius of a pillar (m), `h` its height (m), `w` the work of adhesion (J/m^2). Forces and
//! pressures are positive in compression. Adhesion has a short range (Johnson, Kendall and Roberts), so that the edge of a contact is in
//! equilibrium where the energy release rate `K^2/(2 E*)` equals `w`.
#![doc = ""]
#![doc = include_str!("../../doc/rendered/stuck-floor.md")]
//!
//! Sources: I. N. Sneddon, M. Lowengrub, Crack Problems in the Classical Theory of Elasticity (Wiley, 1969) (penny-shaped cracks by Abel
//! transforms); W. Gautschi, SIAM Rev. 9, 24 (1967) (Legendre functions of the second kind); Y. Y. Huang et al., Langmuir 21, 8058 (2005)
//! (roof collapse of grooves); K. L. Johnson, K. Kendall, A. D. Roberts, Proc. R. Soc. A 324, 301 (1971).

use super::adhesion::sphere_pull_off_by_force;
use crate::numerics::cholesky::{factorise, solve_lower};
use crate::numerics::elliptic::{dilogarithm, elliptic_ratio, legendre_q};
use crate::numerics::roots::{Point, find, least};
use crate::problem::quantity::Requirement;
use crate::problem::{InvalidQuantity, Quantity, System, Unsupported};
use crate::state::SolveError;
use std::convert::Infallible;
use std::f64::consts::PI;

/// Smallest ratio of the radius of an annulus to that of its pillar for which coefficients are available: 570 modes are summed at this
/// ratio.
pub const LEAST_RADIUS_RATIO: f64 = 1.0001;

/// The pressure of a pillar is resolved by `RESOLUTION/acosh(b/a) + FEWEST_MODES` modes. The coefficients decrease as
/// `exp(-2 n acosh(b/a))`.
const RESOLUTION: f64 = 8.0;
const FEWEST_MODES: usize = 6;

/// A free annulus `a < r < b` around a pillar of unit radius, in units of the reduced modulus. The effects of the step `h`, which opens it,
/// and of the far-field pressure `p_0`, which closes it, add up: `F = F_1 h + V_1 p_0`, `V = V_1 h - D p_0`, `K = K_1 h - K_2 p_0`, and the
/// energy is `F_1 h^2/2 + V_1 h p_0 - D p_0^2/2`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AnnulusCoefficients {
    /// `F_1`: force on the pillar per step. To be multiplied by `a` for a radius `a`.
    pub force_per_step: f64,
    /// `V_1`: opened volume per step, and force on the pillar per pressure. To be multiplied by `a^2`.
    pub volume_per_step: f64,
    /// `D`: closed volume per pressure. To be multiplied by `a^3`.
    pub volume_per_pressure: f64,
    /// `K_1`: stress intensity factor at the outer edge per step. To be divided by `sqrt(a)`.
    pub intensity_per_step: f64,
    /// `K_2`: reduction of the stress intensity factor per pressure. To be multiplied by `sqrt(a)`.
    pub intensity_per_pressure: f64,
}

impl AnnulusCoefficients {
    /// Computes the coefficients for the ratio `b/a` of the outer radius to that of the pillar. All are accurate to about 10 digits, `D` to
    /// fewer close to the pillar.
    ///
    /// # Errors
    /// A ratio that is not above [`LEAST_RADIUS_RATIO`] or not finite.
    ///
    /// ```
    /// use fakir::theory::stuck_floor::AnnulusCoefficients;
    ///
    /// let twice = AnnulusCoefficients::new(2.0)?;
    /// assert!((twice.force_per_step - 2.5493).abs() < 5e-5);
    /// assert!((twice.intensity_per_pressure - 1.185).abs() < 5e-4);
    /// # Ok::<(), fakir::problem::InvalidQuantity>(())
    /// ```
    pub fn new(radius_ratio: f64) -> Result<Self, InvalidQuantity> {
        Requirement::Above(LEAST_RADIUS_RATIO).check(Quantity::AnnulusRadius, radius_ratio)?;
        Ok(Self::of(radius_ratio))
    }

    pub(crate) fn of(ratio: f64) -> Self {
        let CrackSystem {
            factor,
            mut step,
            mut pressure,
            mut edge,
        } = CrackSystem::new(ratio);
        let size = step.len();
        for right in [&mut step, &mut pressure, &mut edge] {
            solve_lower(&factor, size, right);
        }
        let product = |x: &[f64], y: &[f64]| -> f64 { x.iter().zip(y).map(|(x, y)| x * y).sum() };
        let intensity = 2.0 / (PI * ratio).sqrt();
        Self {
            force_per_step: product(&step, &step),
            volume_per_step: product(&step, &pressure),
            volume_per_pressure: 8.0 / 3.0 * ratio.powi(3) - product(&pressure, &pressure),
            intensity_per_step: intensity * product(&edge, &step),
            intensity_per_pressure: intensity * (ratio - product(&edge, &pressure)),
        }
    }
}

/// The equations for the pressure `sum c_j P_2j(y)/(P_2j(0) y)`, `y = sqrt(1 - r^2)`, of the pillar on the lens: `M c = h F + p_0 m`.
///
/// The Abel transform of a mode is `Q_2j(t)` for `t < 1` and for `t > 1`, so that `M_ij = 8 int_0^b Q_2i Q_2j dt`,
/// `m_j = 8 int_0^b t Q_2j dt`, `F_j = 2 pi` for `j = 0` and 0 for others. The integrals follow from Legendre's equation; those of squares
/// from `(2 n + 3) int Q_{n+1}^2 - (2 n + 1) int Q_n^2 = b (Q_n^2 + Q_{n+1}^2) - 2 Q_n Q_{n+1}` (all at `b`), and that of `Q_0^2` is a
/// dilogarithm.
struct CrackSystem {
    /// Cholesky factor of `M`.
    factor: Vec<f64>,
    /// `F`.
    step: Vec<f64>,
    /// `m`.
    pressure: Vec<f64>,
    /// `Q_2j(b)`.
    edge: Vec<f64>,
}

impl CrackSystem {
    fn new(b: f64) -> Self {
        let modes = (RESOLUTION / b.acosh()).ceil() as usize + FEWEST_MODES;
        let mut q = vec![0.0; 2 * modes];
        legendre_q(b, &mut q);
        // (1 - b^2) Q_n'(b).
        let slope = |n: usize| match n {
            0 => 1.0,
            n => n as f64 * (q[n - 1] - b * q[n]),
        };
        let order = |n: usize| (n * (n + 1)) as f64;
        let mut matrix = vec![0.0; modes * modes];
        let mut square = first_square(b);
        for j in 0..modes {
            let n = 2 * j;
            matrix[j * modes + j] = 8.0 * square;
            for (k, m) in [(n, n + 1), (n + 1, n + 2)] {
                if m < q.len() {
                    let ends = b * (q[k] * q[k] + q[m] * q[m]) - 2.0 * q[k] * q[m];
                    square = ((2 * k + 1) as f64 * square + ends) / (2 * k + 3) as f64;
                }
            }
            for i in j + 1..modes {
                let m = 2 * i;
                let product = slope(m) * q[n] - slope(n) * q[m];
                matrix[j * modes + i] = 8.0 * product / (order(n) - order(m));
            }
        }
        let pressure = (0..modes).map(|j| {
            let n = 2 * j;
            8.0 * ((1.0 - b * b) * q[n] - b * slope(n)) / (order(n) - 2.0)
        });
        let pressure = pressure.collect();
        let positive = factorise(&mut matrix, modes);
        debug_assert!(positive, "{b}");
        let mut step = vec![0.0; modes];
        step[0] = 2.0 * PI;
        Self {
            factor: matrix,
            step,
            pressure,
            edge: q.iter().step_by(2).copied().collect(),
        }
    }
}

/// `int_0^b Q_0^2 dt`: the integral to infinity, `pi^2/4`, minus the part beyond `b`.
fn first_square(b: f64) -> f64 {
    let q = 0.5 * (2.0 / (b - 1.0)).ln_1p();
    let z = (b - 1.0) / (b + 1.0);
    // The integral of x/(e^x - 1) from 0 to 2 Q_0.
    let debye = PI * PI / 6.0 + 2.0 * q * (-z).ln_1p() - dilogarithm(z);
    PI * PI / 4.0 - (debye - (b - 1.0) * q * q)
}

/// A pillar in a floor that is bonded to the lens except for a free annulus.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BondedFloorPillar {
    modulus: f64,
    radius: f64,
    step: f64,
    column_compliance: f64,
}

/// Former name of [`BondedFloorPillar`].
#[deprecated(note = "renamed to `BondedFloorPillar`")]
pub type StuckPillar = BondedFloorPillar;

/// A free annulus around a pillar.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FreeAnnulus {
    /// Outer radius `b`, m.
    pub outer_radius: f64,
    /// Height of the step between the floor and the top of the shortened column, m.
    pub step: f64,
    /// Force on the pillar, N.
    pub pillar_force: f64,
    /// Volume between lens and floor, m^3.
    pub opened_volume: f64,
    /// Stress intensity factor at the outer edge, Pa m^(1/2). If negative, the surfaces would overlap: the annulus closes.
    pub stress_intensity: f64,
    /// Energy release rate at the outer edge, `K |K|/(2 E*)`, J/m^2.
    pub energy_release_rate: f64,
    /// Energy of pillar and surroundings, J: its derivatives with respect to step and pressure are force and opened volume; the derivative
    /// with respect to the area inside the outer radius is minus the energy release rate.
    pub energy: f64,
}

/// Equilibrium position of the outer edge of a free annulus for a work of adhesion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AnnulusEdge {
    /// At this outer radius, m.
    At(f64),
    /// At the pillar, within [`LEAST_RADIUS_RATIO`]: the pillar is compressed down to the floor, or the work of adhesion is extremely
    /// large.
    Closed,
    /// None: the tension is so large that the floor detaches completely.
    Runs,
}

/// Largest radius, in radii of the pillar, in the search for an edge.
const FARTHEST: f64 = 1e10;

/// Ratio of consecutive widths of an annulus in the search for its edge.
const STRIDE: f64 = 1.3;

/// Number of golden-section steps for a minimum in a bracket of two strides: position to 1e-8, value to full precision.
const SECTIONS: usize = 40;

impl BondedFloorPillar {
    /// A pillar of a radius (m) and height (m), with a column compliance (m/N), and the reduced modulus (Pa) of lens and substrate.
    ///
    /// # Errors
    /// A modulus, radius or height that is not positive and finite, and a compliance that is negative or not finite.
    pub fn new(
        modulus: f64,
        radius: f64,
        height: f64,
        column_compliance: f64,
    ) -> Result<Self, InvalidQuantity> {
        use Quantity as Q;
        Requirement::UpTo(f64::MAX).check(Q::ColumnCompliance, column_compliance)?;
        Ok(Self {
            modulus: Requirement::Positive.check(Q::ReducedModulus, modulus)?,
            radius: Requirement::Positive.check(Q::PillarRadius, radius)?,
            step: Requirement::Positive.check(Q::PillarHeight, height)?,
            column_compliance,
        })
    }

    /// The common pillar of a system.
    #[must_use]
    pub fn of(system: &System) -> Self {
        Self {
            modulus: system.reduced_modulus(),
            radius: 0.5 * system.pillar().diameter,
            step: system.pillar().height,
            column_compliance: system.column_compliance(),
        }
    }

    /// Radius of the pillar, m.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// The annulus with an outer radius (m) under a far-field pressure (Pa, negative for tension).
    ///
    /// # Errors
    /// An outer radius not above [`LEAST_RADIUS_RATIO`] radii of the pillar, and a pressure that is not finite.
    pub fn annulus(
        &self,
        outer_radius: f64,
        pressure: f64,
    ) -> Result<FreeAnnulus, InvalidQuantity> {
        let least = Requirement::Above(LEAST_RADIUS_RATIO * self.radius);
        least.check(Quantity::AnnulusRadius, outer_radius)?;
        Requirement::Finite.check(Quantity::BackgroundPressure, pressure)?;
        let coefficients = AnnulusCoefficients::of(outer_radius / self.radius);
        Ok(self.annulus_with(&coefficients, outer_radius, pressure))
    }

    /// [`annulus`](Self::annulus) with precomputed coefficients for its radius.
    #[must_use]
    pub fn annulus_with(
        &self,
        coefficients: &AnnulusCoefficients,
        outer_radius: f64,
        pressure: f64,
    ) -> FreeAnnulus {
        let a = self.radius;
        let f = self.modulus * coefficients.force_per_step * a;
        let v = coefficients.volume_per_step * a * a;
        let d = coefficients.volume_per_pressure * a.powi(3) / self.modulus;
        let column = self.column_compliance;
        let step = (self.step - column * v * pressure) / (1.0 + column * f);
        let pillar_force = f * step + v * pressure;
        let stress_intensity = self.modulus * coefficients.intensity_per_step / a.sqrt() * step
            - coefficients.intensity_per_pressure * a.sqrt() * pressure;
        FreeAnnulus {
            outer_radius,
            step,
            pillar_force,
            opened_volume: v * step - d * pressure,
            stress_intensity,
            energy_release_rate: 0.5 * stress_intensity * stress_intensity.abs() / self.modulus,
            energy: 0.5 * f * step * step + v * step * pressure - 0.5 * d * pressure * pressure
                + 0.5 * column * pillar_force * pillar_force,
        }
    }

    /// Equilibrium position of the outer edge for a work of adhesion (J/m^2) and a far-field pressure (Pa): the innermost radius beyond
    /// which the energy release rate is below the work.
    ///
    /// # Errors
    /// A work that is not positive and finite, and a pressure that is not finite.
    pub fn edge(&self, work: f64, pressure: f64) -> Result<AnnulusEdge, InvalidQuantity> {
        Requirement::Positive.check(Quantity::WorkOfAdhesion, work)?;
        Requirement::Finite.check(Quantity::BackgroundPressure, pressure)?;
        let critical = (2.0 * work * self.modulus).sqrt();
        Ok(match self.edge_in_ratios(critical, pressure) {
            Ok(ratio) => AnnulusEdge::At(ratio * self.radius),
            Err(edge) => edge,
        })
    }

    /// Width, m, of the free annulus around the pillar for a work of adhesion (J/m^2), without far-field pressure; 0 for an annulus that
    /// closes, `None` for one that grows without limit.
    ///
    /// # Errors
    /// A work that is not positive and finite.
    pub fn free_ring(&self, work: f64) -> Result<Option<f64>, InvalidQuantity> {
        Ok(match self.edge(work, 0.0)? {
            AnnulusEdge::At(radius) => Some(radius - self.radius),
            AnnulusEdge::Closed => Some(0.0),
            AnnulusEdge::Runs => None,
        })
    }

    /// Stress intensity factor divided by its critical value, minus one, at a relative width `b/a - 1`.
    fn excess(&self, width: f64, pressure: f64, critical: f64) -> f64 {
        let coefficients = AnnulusCoefficients::of(1.0 + width);
        let annulus = self.annulus_with(&coefficients, (1.0 + width) * self.radius, pressure);
        annulus.stress_intensity / critical - 1.0
    }

    fn edge_in_ratios(&self, critical: f64, pressure: f64) -> Result<f64, AnnulusEdge> {
        let point = |width: f64| Point {
            position: width,
            value: self.excess(width, pressure, critical),
        };
        let least_width = LEAST_RADIUS_RATIO - 1.0;
        let mut inner = point(0.1);
        while inner.value <= 0.0 {
            if inner.position <= least_width {
                return Err(AnnulusEdge::Closed);
            }
            inner = point((inner.position / 4.0).max(least_width));
        }
        // Searches outwards from an unstable edge to a stable one, or past the minimum of the stress intensity factor.
        let mut before = inner;
        let outer = loop {
            let next = point(inner.position * STRIDE);
            if next.value <= 0.0 {
                break next;
            }
            if next.value > inner.value {
                let bracket = [before.position, next.position];
                let valley = least(bracket, SECTIONS, |width| {
                    self.excess(width, pressure, critical)
                });
                let valley = point(valley);
                if valley.value > 0.0 {
                    return Err(AnnulusEdge::Runs);
                }
                inner = before;
                break valley;
            }
            if next.position > FARTHEST {
                return Err(AnnulusEdge::Runs);
            }
            (before, inner) = (inner, next);
        };
        let found = find([inner, outer], 0.0, |width| {
            Ok::<_, Infallible>(self.excess(width, pressure, critical))
        });
        match found {
            Ok(root) => Ok(1.0 + root.map_or(outer.position, |root| root.closest().position)),
        }
    }

    /// The largest far-field tension (Pa, positive) at which the edge of an annulus is in equilibrium, and its outer radius (m). Under
    /// larger tension the floor detaches completely. In a lattice it detaches earlier, when annuli meet.
    ///
    /// # Errors
    /// A work that is not positive and finite.
    pub fn largest_tension(&self, work: f64) -> Result<(f64, f64), InvalidQuantity> {
        Requirement::Positive.check(Quantity::WorkOfAdhesion, work)?;
        let critical = (2.0 * work * self.modulus).sqrt();
        // The tension that results in K = K_c at every radius, by linearity; the maximum over radii is sought.
        let tension = |logarithm: f64| {
            let ratio = 1.0 + logarithm.exp();
            let coefficients = AnnulusCoefficients::of(ratio);
            let at = |pressure| {
                let annulus = self.annulus_with(&coefficients, ratio * self.radius, pressure);
                annulus.stress_intensity / critical
            };
            let unit = critical / self.radius.sqrt();
            let (without, with) = (at(0.0), at(-unit));
            (1.0 - without) / (with - without) * unit
        };
        let last = FARTHEST.ln();
        let start = largest_on_grid([(0.01f64).ln(), last], tension);
        let stride = STRIDE.ln();
        let best = least([start - stride, start + stride], SECTIONS, |x| -tension(x));
        Ok((tension(best), (1.0 + best.exp()) * self.radius))
    }
}

/// The grid point in an interval at which a function is largest.
fn largest_on_grid([first, last]: [f64; 2], function: impl Fn(f64) -> f64) -> f64 {
    let stride = STRIDE.ln();
    let count = ((last - first) / stride).ceil() as usize;
    let places = (0..=count).map(|k| first + stride * k as f64);
    let valued = places.map(|place| (place, function(place)));
    let best = valued.max_by(|x, y| x.1.total_cmp(&y.1));
    best.map_or(first, |(place, _)| place)
}

/// The floor of a lattice of equal pillars, completely bonded to a flat lens except for an annulus around every pillar. The interaction of
/// annuli is neglected, which is accurate for `b` below about 0.3 of the pitch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AdhesiveFloor {
    pillar: BondedFloorPillar,
    cell_area: f64,
}

/// Former name of [`AdhesiveFloor`].
#[deprecated(note = "renamed to `AdhesiveFloor`")]
pub type StuckFloor = AdhesiveFloor;

/// The threshold at which a flat lattice without load collapses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CollapseThreshold {
    /// Work of adhesion above which the bonded floor has the lower energy, J/m^2.
    pub work: f64,
    /// Outer radius of the annuli at the threshold, m.
    pub annulus_radius: f64,
}

impl AdhesiveFloor {
    /// A floor with the given surface area per pillar (m^2), including the top.
    ///
    /// # Errors
    /// An area that is not larger than that of the pillar.
    pub fn new(pillar: BondedFloorPillar, cell_area: f64) -> Result<Self, InvalidQuantity> {
        let smallest = PI * (LEAST_RADIUS_RATIO * pillar.radius).powi(2);
        Requirement::Above(smallest).check(Quantity::CellArea, cell_area)?;
        Ok(Self { pillar, cell_area })
    }

    /// The floor of a system.
    ///
    /// # Errors
    /// [`Unsupported`] unless the pillars are equal and on the infinite hexagonal lattice; pillars that cover the whole surface.
    pub fn of(system: &System) -> Result<Self, SolveError> {
        let lattice = system.hexagonal_lattice();
        let lattice = lattice.ok_or(Unsupported::BUT_FOR_THE_LATTICE)?;
        Ok(Self::new(
            BondedFloorPillar::of(system),
            lattice.cell_area(),
        )?)
    }

    /// One of the pillars.
    #[must_use]
    pub fn pillar(&self) -> &BondedFloorPillar {
        &self.pillar
    }

    /// The work of adhesion at which the flat lattice collapses without load: the minimum of `U(b)/(A - pi b^2)` over the radius `b` of the
    /// annuli, with `U` the energy of an annulus and `A` the area of a cell. At this radius it equals the energy release rate.
    #[must_use]
    pub fn collapse_threshold(&self) -> CollapseThreshold {
        let a = self.pillar.radius;
        let widest = (self.cell_area / PI).sqrt() / a - 1.0;
        let work = |logarithm: f64| {
            let ratio = 1.0 + logarithm.exp();
            let coefficients = AnnulusCoefficients::of(ratio);
            let annulus = self.pillar.annulus_with(&coefficients, ratio * a, 0.0);
            annulus.energy / (self.cell_area - PI * (ratio * a).powi(2))
        };
        let narrowest = (LEAST_RADIUS_RATIO - 1.0).max(1e-3 * widest);
        let bracket = [narrowest.ln(), (widest * (1.0 - 1e-9)).ln()];
        let best = least(bracket, 2 * SECTIONS, work);
        CollapseThreshold {
            work: work(best),
            annulus_radius: (1.0 + best.exp()) * a,
        }
    }

    /// Energy gain per area when the floor bonds to the lens for a work of adhesion (J/m^2), `w (1 - pi b^2/A) - U/A` with the annuli at
    /// the equilibrium radius, J/m^2. Negative below the [threshold](Self::collapse_threshold). `None` if the annuli would be wider than a
    /// cell, so that no floor is bonded.
    ///
    /// # Errors
    /// A work that is not positive and finite.
    pub fn net_work(&self, work: f64) -> Result<Option<f64>, InvalidQuantity> {
        let AnnulusEdge::At(radius) = self.pillar.edge(work, 0.0)? else {
            return Ok(None);
        };
        let left = self.cell_area - PI * radius * radius;
        if left <= 0.0 {
            return Ok(None);
        }
        let energy = self.pillar.annulus(radius, 0.0)?.energy;
        Ok(Some((work * left - energy) / self.cell_area))
    }

    /// Pull-off force (N, negative) of a lens of a radius (m) from the bonded floor as a smooth surface: Johnson, Kendall and Roberts with
    /// the [net work](Self::net_work), `-(3/2) pi w_net R`. `None` if the net work is not positive, so that the floor detaches earlier.
    /// Pinning of the edge by pillars increases the force.
    ///
    /// # Errors
    /// A lens radius or work that is not positive and finite.
    pub fn pull_off(&self, lens_radius: f64, work: f64) -> Result<Option<f64>, InvalidQuantity> {
        Requirement::Positive.check(Quantity::LensRadius, lens_radius)?;
        let net = self.net_work(work)?.filter(|net| *net > 0.0);
        let force = |net| sphere_pull_off_by_force(self.pillar.modulus, lens_radius, net).force;
        Ok(net.map(force))
    }
}

/// Parallel ridges with grooves between them in plane strain, whose floor (the "roof" of a stamp) is bonded along a strip in the middle of
/// every groove.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grooves {
    modulus: f64,
    period: f64,
    ridge_width: f64,
    depth: f64,
}

/// The threshold at which grooves collapse without load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GrooveThreshold {
    /// Work of adhesion, J/m^2.
    pub work: f64,
    /// Width of the bonded strip at the threshold, m.
    pub strip_width: f64,
}

impl Grooves {
    /// Ridges of a width (m) with a period (m), with grooves of a depth (m), and the reduced modulus (Pa) of both bodies.
    ///
    /// # Errors
    /// A modulus, period or depth that is not positive and finite, and ridges as wide as the period.
    pub fn new(
        modulus: f64,
        period: f64,
        ridge_width: f64,
        depth: f64,
    ) -> Result<Self, InvalidQuantity> {
        use Quantity as Q;
        Ok(Self {
            modulus: Requirement::Positive.check(Q::ReducedModulus, modulus)?,
            period: Requirement::Positive.check(Q::Pitch, period)?,
            ridge_width: Requirement::Between(0.0, period).check(Q::StripWidth, ridge_width)?,
            depth: Requirement::Positive.check(Q::PillarHeight, depth)?,
        })
    }

    /// Energy per period and length with a bonded strip of a width (m), J/m: `E* h^2/2 K(k)/K(k')` with
    /// `k = tan(pi r/(2 P)) tan(pi s/(2 P))` for ridges of width `r` and strips of width `s` with the period `P` (Y. Y. Huang et al.,
    /// Langmuir 21, 8058 (2005)).
    ///
    /// # Errors
    /// A strip that is not narrower than the groove, or not positive and finite.
    pub fn energy(&self, strip_width: f64) -> Result<f64, InvalidQuantity> {
        let fits = Requirement::Between(0.0, self.period - self.ridge_width);
        fits.check(Quantity::StripWidth, strip_width)?;
        Ok(self.energy_of(strip_width))
    }

    fn energy_of(&self, strip_width: f64) -> f64 {
        let tangent = |width: f64| (0.5 * PI * width / self.period).tan();
        let k = tangent(self.ridge_width) * tangent(strip_width);
        0.5 * self.modulus * self.depth.powi(2) * elliptic_ratio(k)
    }

    /// The work of adhesion at which the grooves collapse without load: the minimum of the energy divided by the width of the strip.
    #[must_use]
    pub fn threshold(&self) -> GrooveThreshold {
        let groove = self.period - self.ridge_width;
        let work = |part: f64| self.energy_of(part * groove) / (part * groove);
        let part = least([1e-6, 1.0 - 1e-6], SECTIONS, work);
        GrooveThreshold {
            work: work(part),
            strip_width: part * groove,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::cholesky::solve_upper;
    use crate::problem::PillarCompliance;
    use crate::theory::reference;

    fn coefficients(ratio: f64) -> AnnulusCoefficients {
        AnnulusCoefficients::new(ratio).unwrap()
    }

    fn list(of: &AnnulusCoefficients) -> [f64; 5] {
        [
            of.force_per_step,
            of.volume_per_step,
            of.volume_per_pressure,
            of.intensity_per_step,
            of.intensity_per_pressure,
        ]
    }

    /// The paper's pillars on a substrate with this modulus (MPa), at this surface fraction.
    fn system(surface_fraction: f64, young_modulus: f64) -> System {
        reference::paper(
            surface_fraction,
            young_modulus * 1e6,
            PillarCompliance::Column,
        )
    }

    /// The integral over (low, high) by the tanh-sinh rule, which handles all integrable singularities at the ends.
    fn integral(low: f64, high: f64, function: impl Fn(f64) -> f64) -> f64 {
        let step = 1.0 / 32.0;
        let sum = (-130..=130).map(|k| {
            let t = step * f64::from(k);
            let (u, slope) = (0.5 * PI * t.sinh(), 0.5 * PI * t.cosh());
            // The distance to the nearer end, without cancellation.
            let part = 1.0 / (1.0 + (2.0 * u.abs()).exp());
            let near = (high - low) * part;
            let x = if u < 0.0 { low + near } else { high - near };
            let weight = 0.5 * (high - low) * slope / u.cosh().powi(2);
            let inside = x > low && x < high && weight > 0.0;
            if inside { weight * function(x) } else { 0.0 }
        });
        step * sum.sum::<f64>()
    }

    /// Eight modes of another series, by quadrature: 4 digits.
    #[test]
    fn coefficients_are_those_of_another_series() {
        let table = [
            (3.5 / 3.0, [3.5957, 3.6396, 0.1487, 0.7849, 0.5030]),
            (4.0 / 3.0, [3.1150, 4.1130, 0.6421, 0.4748, 0.7029]),
            (5.0 / 3.0, [2.7281, 5.0265, 2.952, 0.2635, 0.9780]),
            (2.0, [2.5493, 5.9170, 7.515, 0.1779, 1.185]),
            (3.0, [2.3218, 8.5322, 40.61, 0.0834, 1.648]),
            (4.0, [2.2291, 11.113, 115.2, 0.0511, 2.002]),
        ];
        for (ratio, expected) in table {
            for (found, expected) in list(&coefficients(ratio)).iter().zip(expected) {
                assert!(
                    (found / expected - 1.0).abs() < 7e-4,
                    "{ratio}: {found} {expected}"
                );
            }
        }
    }

    /// `dF_1/db = -2 pi b K_1^2`, `dV_1/db = 2 pi b K_1 K_2`, `dD/db = 2 pi b K_2^2`.
    #[test]
    fn energy_released_is_that_of_the_stress_intensity() {
        for ratio in [1.01f64, 1.1, 1.4, 2.0, 5.0, 20.0] {
            let step = 1e-4 * (ratio - 1.0);
            let at = |moves: f64| list(&coefficients(ratio + moves * step));
            let (near, far) = ([at(-1.0), at(1.0)], [at(-2.0), at(2.0)]);
            let slope = |k: usize| {
                (8.0 * (near[1][k] - near[0][k]) - (far[1][k] - far[0][k])) / (12.0 * step)
            };
            let here = coefficients(ratio);
            let (k1, k2) = (here.intensity_per_step, here.intensity_per_pressure);
            let around = 2.0 * PI * ratio;
            for (k, expected) in [
                (0, -around * k1 * k1),
                (1, around * k1 * k2),
                (2, around * k2 * k2),
            ] {
                let found = slope(k);
                assert!(
                    (found / expected - 1.0).abs() < 1e-6,
                    "{ratio}: {found} {expected}"
                );
            }
        }
    }

    /// Limits: close to the pillar, a crack along a rigid wall; far from it, a point force on a penny-shaped crack.
    #[test]
    fn limits_of_narrow_and_wide_annuli() {
        let x = 2e-4f64;
        let narrow = coefficients(1.0 + x);
        let expected = [
            (1.0 / x).ln() + 5.0 * 2f64.ln() - 2.0,
            PI,
            0.5 * (PI * x).powi(2),
            1.0 / (2.0 * PI * x).sqrt(),
            (0.5 * PI * x).sqrt(),
        ];
        for (found, expected) in list(&narrow).iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 2e-3, "{found} {expected}");
        }
        let b = 1e5f64;
        let wide = coefficients(b);
        let expected = [
            2.0,
            8.0 / PI * b,
            8.0 / 3.0 * b.powi(3),
            2.0 / (PI * b).powf(1.5),
            2.0 * (b / PI).sqrt(),
        ];
        for (found, expected) in list(&wide).iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 2e-5, "{found} {expected}");
        }
        // The number of modes changes between the two ratios.
        let pair = [1.05, 1.05 + 1e-12].map(coefficients);
        for (one, other) in list(&pair[0]).iter().zip(list(&pair[1])) {
            assert!((one / other - 1.0).abs() < 1e-9);
        }
    }

    /// The opening `4/pi int_r^b g(t)/sqrt(t^2 - r^2) dt` of the crack by quadrature, with `g` the Abel transform of the pressure: it
    /// equals the step on the pillar, its volume is that of the coefficients, and `g(b)` the stress intensity factor.
    #[test]
    fn the_crack_opens_by_the_step_on_the_pillar() {
        for b in [1.05f64, 1.3, 2.5] {
            for (h, p) in [(1.0, 0.0), (0.0, 1.0), (0.7, -0.2)] {
                let crack = CrackSystem::new(b);
                let size = crack.step.len();
                let loads = crack.step.iter().zip(&crack.pressure);
                let mut modes: Vec<f64> = loads.map(|(f, m)| h * f + p * m).collect();
                solve_lower(&crack.factor, size, &mut modes);
                solve_upper(&crack.factor, size, &mut modes);
                // On and outside the pillar.
                let transform = |t: f64| {
                    let mut values = vec![0.0; 2 * size];
                    if t > 1.0001 {
                        legendre_q(t, &mut values);
                    } else {
                        // Upward recurrence, which is stable inside and close to the rim.
                        let from_rim = (1.0 - t).abs().max(1e-17);
                        values[0] = 0.5 * ((1.0 + t) / from_rim).ln();
                        values[1] = t * values[0] - 1.0;
                        for n in 1..2 * size - 1 {
                            let k = n as f64;
                            values[n + 1] =
                                ((2.0 * k + 1.0) * t * values[n] - k * values[n - 1]) / (k + 1.0);
                        }
                    }
                    let even = values.iter().step_by(2).zip(&modes);
                    even.map(|(q, c)| q * c).sum::<f64>() - p * t
                };
                let opening = |r: f64| {
                    let part = |low: f64, high: f64| {
                        // t^2 = r^2 + u^2.
                        let ends = [low, high].map(|t| ((t - r) * (t + r)).max(0.0).sqrt());
                        integral(ends[0], ends[1], |u| {
                            let t = r.hypot(u);
                            transform(t) / t
                        })
                    };
                    let sum = if r < 1.0 {
                        part(r, 1.0) + part(1.0, b)
                    } else {
                        part(r, b)
                    };
                    4.0 / PI * sum
                };
                for r in [0.1, 0.5, 0.8, 0.97] {
                    let found = opening(r);
                    assert!((found - h).abs() < 2e-6, "{b} {r}: {found} {h}");
                }
                let expected = coefficients(b);
                let volume = PI * h + integral(1.0, b, |r| 2.0 * PI * r * opening(r));
                let exact = expected.volume_per_step * h - expected.volume_per_pressure * p;
                assert!((volume - exact).abs() < 2e-5, "{b}: {volume} {exact}");
                let intensity = 2.0 / (PI * b).sqrt() * transform(b);
                let exact = expected.intensity_per_step * h - expected.intensity_per_pressure * p;
                assert!((intensity - exact).abs() < 1e-10);
            }
        }
    }

    /// Compares the energy with force, volume and energy release rate of a pillar with a compliant column.
    #[test]
    fn energy_of_an_annulus_has_the_right_slopes() {
        let pillar = BondedFloorPillar::of(&system(0.03, 2.0));
        let (b, p) = (4.9e-6, 1.5e4);
        let here = pillar.annulus(b, p).unwrap();
        let slope = |up: f64, down: f64, change: f64| (up - down) / (2.0 * change);
        let other_step = |change: f64| BondedFloorPillar {
            step: pillar.step + change,
            ..pillar
        };
        let energy = |change: f64| other_step(change).annulus(b, p).unwrap().energy;
        let force = slope(energy(1e-10), energy(-1e-10), 1e-10);
        assert!((force / here.pillar_force - 1.0).abs() < 1e-8);
        let energy = |change: f64| pillar.annulus(b, p + change).unwrap().energy;
        let volume = slope(energy(10.0), energy(-10.0), 10.0);
        assert!((volume / here.opened_volume - 1.0).abs() < 1e-8);
        let energy = |change: f64| pillar.annulus(b + change, p).unwrap().energy;
        let released = -slope(energy(1e-10), energy(-1e-10), 1e-10) / (2.0 * PI * b);
        assert!((released / here.energy_release_rate - 1.0).abs() < 1e-6);
    }

    /// Without column compliance and pressure, 8 modes by quadrature: force in um E*, energy release rate divided by E* in um (`a = 3 um`,
    /// `h = 2.2 um`).
    #[test]
    fn annuli_without_column_and_pressure() {
        let pillar = BondedFloorPillar::new(1.0, 3.0, 2.2, 0.0).unwrap();
        for (b, force, rate) in [
            (3.5, 23.73, 0.4970),
            (4.0, 20.56, 0.1819),
            (5.0, 18.01, 0.0560),
            (6.0, 16.83, 0.02554),
            (9.0, 15.32, 0.00562),
            (12.0, 14.71, 0.00211),
        ] {
            let found = pillar.annulus(b, 0.0).unwrap();
            assert!((found.pillar_force / force - 1.0).abs() < 4e-4, "{b}");
            assert!((found.energy_release_rate / rate - 1.0).abs() < 2e-3, "{b}");
        }
    }

    /// Edges with and without pressure, and cases without an edge, in um: roots of the table of another series, interpolated, to its
    /// digits.
    #[test]
    fn edges_are_in_equilibrium_with_the_work_of_adhesion() {
        let pillar = BondedFloorPillar::of(&system(0.03, 2.0));
        let modulus = pillar.modulus;
        let at = |work: f64, pressure: f64| match pillar.edge(work * 1e-3, pressure * modulus) {
            Ok(AnnulusEdge::At(radius)) => radius * 1e6,
            other => panic!("{other:?}"),
        };
        for (work, expected) in [
            (1.0, 13.8),
            (3.0, 9.8),
            (5.0, 8.5),
            (10.0, 7.0),
            (20.0, 5.8),
            (50.0, 4.67),
        ] {
            assert!((at(work, 0.0) / expected - 1.0).abs() < 6e-3, "{work}");
        }
        let stiff = BondedFloorPillar::of(&system(0.03, 1000.0));
        let edge = stiff.edge(10e-3, 0.0).unwrap();
        assert!(matches!(edge, AnnulusEdge::At(b) if (b * 1e6 - 10.1).abs() < 0.06));
        let ring = stiff.free_ring(10e-3).unwrap().unwrap();
        assert!(matches!(edge, AnnulusEdge::At(b) if (b - stiff.radius() - ring).abs() < 1e-20));
        let pressures = [-0.05, -0.02, -0.01, 0.0, 0.01, 0.02, 0.05, 0.1, 0.2];
        let table = [6.02, 5.00, 4.82, 4.67, 4.55, 4.44, 4.20, 3.93, 3.63];
        for (pressure, expected) in pressures.into_iter().zip(table) {
            assert!((at(50.0, pressure) - expected).abs() < 0.012, "{pressure}");
        }
        let table = [11.25, 8.04, 6.96, 6.33, 5.90, 5.13, 4.50, 3.92];
        for (pressure, expected) in pressures.into_iter().skip(1).zip(table) {
            assert!((at(10.0, pressure) - expected).abs() < 0.012, "{pressure}");
        }
        for (work, tension, radius) in [
            (1.0, 0.0046, 32.0),
            (10.0, 0.0218, 15.0),
            (50.0, 0.0655, 9.0),
        ] {
            let (found, there) = pillar.largest_tension(work * 1e-3).unwrap();
            assert!((found / modulus - tension).abs() < 6e-5, "{work}: {found}");
            assert!((there * 1e6 / radius - 1.0).abs() < 0.06, "{work}: {there}");
            let edge = |part: f64| pillar.edge(work * 1e-3, -part * found).unwrap();
            assert!(matches!(edge(0.9999), AnnulusEdge::At(b) if b < there));
            assert_eq!(edge(1.0001), AnnulusEdge::Runs);
        }
        // For the smallest work of adhesion that a system accepts: a point force on a crack, b^3 = F^2/(2 pi^3 w E*), up to terms of order
        // a/b.
        let least = 1e-12;
        let force = pillar.step / (0.5 / (modulus * pillar.radius) + pillar.column_compliance);
        let far = (force * force / (2.0 * PI.powi(3) * least * modulus)).cbrt();
        let edge = pillar.edge(least, 0.0).unwrap();
        assert!(matches!(edge, AnnulusEdge::At(b) if (b / far - 1.0).abs() < pillar.radius / far));
        // The column shortens by the whole step.
        let flush = 2.0 * pillar.step / (pillar.column_compliance * PI * pillar.radius.powi(2));
        assert_eq!(pillar.edge(10e-3, flush).unwrap(), AnnulusEdge::Closed);
    }

    /// Thresholds of flat lattices in mJ/m^2 by 8 modes and quadrature; the pull-off force in the only case with positive net work.
    #[test]
    fn flat_lattices_collapse_above_their_threshold() {
        for (young_modulus, expected) in [(2.0, [6.4, 21.0, 87.0]), (1000.0, [17.0, 59.0, 253.0])] {
            for (phi, expected) in [0.01, 0.03, 0.1].into_iter().zip(expected) {
                let floor = AdhesiveFloor::of(&system(phi, young_modulus)).unwrap();
                let found = floor.collapse_threshold();
                assert!(
                    (found.work * 1e3 / expected - 1.0).abs() < 0.03,
                    "{phi}: {found:?}"
                );
                // Griffith's criterion at the minimum, where the net work is zero.
                let annulus = floor.pillar.annulus(found.annulus_radius, 0.0).unwrap();
                assert!((annulus.energy_release_rate / found.work - 1.0).abs() < 1e-6);
                let net = |part: f64| floor.net_work(part * found.work).unwrap();
                assert!(net(1.0).unwrap().abs() < 1e-8 * found.work);
                assert!(net(1.01).unwrap() > 0.0 && net(0.99).unwrap() < 0.0);
                assert_eq!(floor.pull_off(2.2e-3, 0.99 * found.work).unwrap(), None);
            }
        }
        let floor = AdhesiveFloor::of(&system(0.03, 2.0)).unwrap();
        let pull = floor.pull_off(2.2e-3, 50e-3).unwrap().unwrap();
        assert!((pull + 0.27e-3).abs() < 0.005e-3, "{pull}");
        // The annuli fill the cells for such a small work of adhesion.
        assert_eq!(floor.net_work(1e-6).unwrap(), None);
    }

    /// Proportional to `h^2` if the annuli are wide and columns are rigid.
    #[test]
    fn thresholds_of_low_pillars_grow_as_the_square_of_the_height() {
        let cell = 4000e-12;
        let work = |height: f64| {
            let pillar = BondedFloorPillar::new(1e6, 1e-6, height, 0.0).unwrap();
            AdhesiveFloor::new(pillar, cell)
                .unwrap()
                .collapse_threshold()
                .work
        };
        assert!((work(2e-6) / work(1e-6) - 4.0).abs() < 1e-9);
    }

    /// The energy from pressures `T_2k(x)/sqrt(1 - x^2)` on ridges and strips of a periodic array, with the logarithm integrated by
    /// Chebyshev rules.
    fn energy_by_pressures(ridge: f64, strip: f64) -> f64 {
        const COUNT: usize = 16;
        const NODES: usize = 64;
        let halves = [0.5 * ridge, 0.5 * strip];
        let centres = [0.0, 0.5];
        let chebyshev = |k: usize, x: f64| (k as f64 * x.acos()).cos();
        let nodes =
            |count: usize| (0..count).map(move |k| (PI * (k as f64 + 0.5) / count as f64).cos());
        // u = -2/(pi E*) int p ln|2 sin(pi (x - s))| ds up to a constant, with E* = 1 and period 1.
        let influence = |part: usize, mode: usize, at: f64, on: usize| -> f64 {
            let x = centres[on] + halves[on] * at;
            let weight = PI / NODES as f64;
            let smooth: f64 = nodes(NODES)
                .map(|node| {
                    let s = centres[part] + halves[part] * node;
                    let sine = (PI * (x - s)).sin().abs();
                    let kernel = if part == on {
                        let ratio = if (at - node).abs() < 1e-13 {
                            2.0 * PI * halves[on]
                        } else {
                            2.0 * sine / (at - node).abs()
                        };
                        ratio.ln()
                    } else {
                        (2.0 * sine).ln()
                    };
                    weight * chebyshev(2 * mode, node) * kernel
                })
                .sum();
            let singular = match (part == on, mode) {
                (false, _) => 0.0,
                (true, 0) => -PI * 2f64.ln(),
                (true, _) => -PI / (2 * mode) as f64 * chebyshev(2 * mode, at),
            };
            -2.0 / PI * halves[part] * (smooth + singular)
        };
        let size = 2 * COUNT + 1;
        let mut rows = vec![vec![0.0; size + 1]; size];
        for on in 0..2 {
            // The even half of the nodes.
            for (place, at) in nodes(2 * COUNT).take(COUNT).enumerate() {
                let row = &mut rows[on * COUNT + place];
                for part in 0..2 {
                    for mode in 0..COUNT {
                        row[part * COUNT + mode] = influence(part, mode, at, on);
                    }
                }
                row[size - 1] = 1.0;
                row[size] = if on == 0 { 1.0 } else { 0.0 };
            }
        }
        // The force on ridges balances that on strips.
        rows[size - 1][0] = halves[0];
        rows[size - 1][COUNT] = halves[1];
        for k in 0..size {
            let pivot = (k..size)
                .max_by(|i, j| rows[*i][k].abs().total_cmp(&rows[*j][k].abs()))
                .unwrap_or(k);
            rows.swap(k, pivot);
            let top = rows[k].clone();
            for (i, row) in rows.iter_mut().enumerate() {
                if i != k {
                    let factor = row[k] / top[k];
                    for (value, above) in row.iter_mut().zip(&top).skip(k) {
                        *value -= factor * above;
                    }
                }
            }
        }
        0.5 * PI * halves[0] * rows[0][size] / rows[0][0]
    }

    #[test]
    fn energy_of_grooves_is_that_of_their_pressures() {
        for (ridge, strip) in [(0.5, 0.2), (0.25, 0.6), (0.3, 0.3)] {
            let grooves = Grooves::new(1.0, 1.0, ridge, 1.0).unwrap();
            let (found, expected) = (
                grooves.energy(strip).unwrap(),
                energy_by_pressures(ridge, strip),
            );
            assert!((found / expected - 1.0).abs() < 1e-8, "{found} {expected}");
        }
    }

    /// In `E* h^2` divided by half a groove: ridges of 3/4, 1/2 and 1/4 of the period, by another program.
    #[test]
    fn thresholds_of_grooves() {
        for (ridge, expected) in [(0.75, 0.34447), (0.5, 0.31722), (0.25, 0.26189)] {
            let grooves = Grooves::new(1.0, 1.0, ridge, 1.0).unwrap();
            let found = grooves.threshold();
            let reduced = found.work * 0.5 * (1.0 - ridge);
            assert!((reduced - expected).abs() < 6e-6, "{ridge}: {reduced}");
            // At the minimum energy per width, this equals the energy release rate: two edges.
            let step = 1e-5;
            let energy = |change: f64| grooves.energy(found.strip_width + change).unwrap();
            let slope = (energy(step) - energy(-step)) / (2.0 * step);
            assert!((slope / found.work - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn what_cannot_be_is_refused() {
        assert!(AnnulusCoefficients::new(1.0).is_err());
        assert!(AnnulusCoefficients::new(f64::NAN).is_err());
        let refused = BondedFloorPillar::new(1e6, -3e-6, 2e-6, 0.0).unwrap_err();
        assert_eq!(refused.quantity, Quantity::PillarRadius);
        assert!(BondedFloorPillar::new(1e6, 3e-6, 2e-6, -1.0).is_err());
        let pillar = BondedFloorPillar::new(1e6, 3e-6, 2e-6, 0.0).unwrap();
        assert!(pillar.annulus(2e-6, 0.0).is_err());
        assert!(pillar.annulus(5e-6, f64::INFINITY).is_err());
        assert!(pillar.edge(0.0, 0.0).is_err());
        assert!(AdhesiveFloor::new(pillar, 20e-12).is_err());
        assert!(Grooves::new(1e6, 1e-6, 1e-6, 1e-6).is_err());
        let grooves = Grooves::new(1e6, 1e-6, 0.4e-6, 1e-6).unwrap();
        assert!(grooves.energy(0.6e-6).is_err());
    }
}
