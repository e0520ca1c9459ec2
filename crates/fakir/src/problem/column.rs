//! Compliance of pillars below their tops: rigid, columns, or elastic bodies.

use super::lens::Material;
use super::quantity::{InvalidQuantity, Quantity, Requirement};
use crate::numerics::dual::{Dual, Number};
use std::f64::consts::PI;

/// Compliance model of the pillars, in addition to the indentation of their tops.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PillarCompliance {
    /// The displacement of the pillar top is uniform and exceeds that of the floor around its foot by `4 h F/(pi E_s d^2)` (Hooke), as in
    /// the paper.
    #[default]
    Column,
    /// The pillar is an elastic cylinder attached to the half-space: the spreading of the load at its foot is included in its shortening,
    /// and it tilts under a moment. Fitted to finite element solutions; valid for ratios of height to diameter in [`ELASTIC_SLENDERNESS`]
    /// and Poisson's ratios in [`ELASTIC_POISSON_RATIO`]. All methods include the shortening; only the spectral method includes the tilt.
    Elastic,
    /// Pillars are as stiff as the half-space below them.
    None,
}

/// A cylindrical pillar, of the material of the substrate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pillar {
    /// Diameter `d`, m.
    pub diameter: f64,
    /// Height `h`, m.
    pub height: f64,
    /// Compliance model.
    pub compliance: PillarCompliance,
}

/// Range of the ratio of height to diameter for which the compliance of elastic pillars is available.
pub const ELASTIC_SLENDERNESS: [f64; 2] = [0.02, 5.0];

/// Range of Poisson's ratio for which the compliance of elastic pillars is available.
pub const ELASTIC_POISSON_RATIO: [f64; 2] = [0.3, 0.5];

/// Compliance of a pillar below its top, relative to the half-space of which the top would otherwise be a part.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Column {
    /// `kappa`: shortening relative to the indentation of the top as a flat punch.
    pub(crate) shortening: f64,
    /// Rotation under a moment relative to the tilt of the top as a flat punch.
    pub(crate) rocking: f64,
}

/// A column that does not tilt.
impl From<f64> for Column {
    fn from(shortening: f64) -> Self {
        Self {
            shortening,
            rocking: 0.0,
        }
    }
}

impl Column {
    /// Whether both compliances are zero or positive.
    pub(crate) fn is_valid(self) -> bool {
        self.shortening >= 0.0 && self.rocking >= 0.0
    }

    /// The sum of the products of both parts.
    pub(crate) fn times(self, other: Self) -> f64 {
        self.shortening * other.shortening + self.rocking * other.rocking
    }
}

/// Parameters of elastic pillars: the ratio of height to diameter `x`, Poisson's ratio of the substrate, and its fraction `S` of the
/// contact compliance.
#[derive(Debug, Clone, Copy)]
struct Elastic<N> {
    slenderness: N,
    poisson_ratio: N,
    share: N,
}

impl<N: Number> Elastic<N> {
    /// `kappa = S 4x/(pi (1 - nu^2))`, after Hooke.
    fn column(self) -> N {
        self.share * self.slenderness * (4.0 / PI) / self.plane_strain()
    }

    /// `1 - nu^2`
    fn plane_strain(self) -> N {
        N::constant(1.0) - self.poisson_ratio.powi(2)
    }

    /// `kappa_eff = kappa - 2 delta`: compliance measured by a rigid flat punch, or by a flat lens of any modulus, on a cylinder attached
    /// to a half-space of the same material, without friction. `delta` is fitted to 156 finite element solutions (heights of 0.02 to 5
    /// diameters, Poisson's ratios of 0.3, 0.4 and 0.5, fractions `S` of 0.1 to 1), with an error of `1 + kappa_eff` of at most 4.4e-4 and
    /// a root mean square error of 1e-4.
    fn shortening(self) -> N {
        let one = N::constant(1.0);
        let (x, share) = (self.slenderness, self.share);
        let e = N::constant(0.5) - self.poisson_ratio;
        let line = |value: f64, slope: f64| N::constant(value) + e * slope;
        let parabola = |value: f64, slope: f64, bend: f64| line(value, slope) + e * e * bend;
        // `1 - exp(-p x - q x^2)`
        let rise = |p: N, q: N| one - (N::constant(0.0) - p * x - q * x * x).exp();
        let b = line(0.8841, 0.1782);
        let of_punch = parabola(0.0308, -0.0402, -0.0177)
            * rise(line(10.0561, -16.3172), line(12.4057, 42.6532));
        let of_soft_lens = N::constant(0.0)
            - parabola(0.0434, 0.0506, 0.0097) * rise(line(2.3898, 6.1747), N::constant(7.1342))
            - line(1.6542, -2.2136) * x * x * (x * -7.5391).exp();
        let part = (one + b) * share / (one + b * share);
        let delta = share * (of_soft_lens + (of_punch - of_soft_lens) * part);
        self.column() - delta * 2.0
    }

    /// `lambda_11` increases by `S (8/3) (h/a)/(1 - nu^2)`: the rotation of the end of a beam under a moment, `M h/(E I)` with
    /// `I = pi a^4/4`, added to that of a punch on a half-space, `lambda_11 = pi/2`.
    fn rocking(self) -> N {
        self.share * self.slenderness * (32.0 / (3.0 * PI)) / self.plane_strain()
    }
}

/// Compliance of the pillars of a system as a function of their individual height and diameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ColumnLaw {
    compliance: PillarCompliance,
    /// `kappa` of a column of the common height and diameter, after Hooke.
    common: f64,
    slenderness: f64,
    poisson_ratio: f64,
    share: f64,
    leaning: bool,
}

impl ColumnLaw {
    /// Creates the law for pillars similar to the given one, between the materials of lens and substrate, with or without tilt.
    pub(crate) fn new(pillar: &Pillar, [lens, substrate]: [Material; 2], leaning: bool) -> Self {
        let of_substrate = substrate.plane_strain_compliance();
        let contact_compliance = lens.plane_strain_compliance() + of_substrate;
        let compliance = pillar.compliance;
        let hooke = 4.0 * pillar.height / (PI * substrate.young_modulus * pillar.diameter.powi(2));
        Self {
            compliance,
            common: match compliance {
                PillarCompliance::None => 0.0,
                _ => hooke * pillar.diameter * contact_compliance.recip(),
            },
            slenderness: pillar.height / pillar.diameter,
            poisson_ratio: substrate.poisson_ratio,
            share: of_substrate / contact_compliance,
            leaning,
        }
    }

    /// Tilt compliance of the common pillar as a beam, for any compliance model.
    pub(crate) fn beam_rocking(self) -> f64 {
        let elastic = Elastic {
            slenderness: self.slenderness,
            poisson_ratio: self.poisson_ratio,
            share: self.share,
        };
        elastic.rocking()
    }

    /// The same with the common pillar as an elastic body, for any compliance model; `None` outside the range of validity.
    pub(crate) fn as_elastic(self) -> Option<Self> {
        let compliance = PillarCompliance::Elastic;
        let law = Self { compliance, ..self };
        let (x, nu) = (self.slenderness, self.poisson_ratio);
        let [least, most] = ELASTIC_SLENDERNESS;
        let [smallest, largest] = ELASTIC_POISSON_RATIO;
        ((least..=most).contains(&x) && (smallest..=largest).contains(&nu)).then_some(law)
    }

    /// Compliance of the common pillar.
    pub(crate) fn of_common(self) -> Column {
        self.of(1.0, 1.0)
    }

    /// Compliance of a pillar whose slenderness relative to the common pillar is the ratio of the two numbers.
    pub(crate) fn of(self, times: f64, over: f64) -> Column {
        match self.compliance {
            PillarCompliance::Elastic => {
                let elastic = Elastic {
                    slenderness: self.slenderness * times / over,
                    poisson_ratio: self.poisson_ratio,
                    share: self.share,
                };
                Column {
                    shortening: elastic.shortening(),
                    rocking: if self.leaning { elastic.rocking() } else { 0.0 },
                }
            }
            PillarCompliance::Column | PillarCompliance::None => {
                (self.common * times / over).into()
            }
        }
    }

    /// Derivatives of the compliance with respect to its parameters, for a pillar with this compliance and relative slenderness.
    pub(crate) fn slopes(self, column: Column, times: f64) -> ColumnSlopes {
        if self.compliance != PillarCompliance::Elastic {
            let by = |factor: f64| Column::from(factor * column.shortening);
            return ColumnSlopes {
                slenderness: column,
                contact_compliance: by(-1.0),
                young_modulus: by(-1.0),
                poisson_ratio: by(0.0),
            };
        }
        let elastic = Elastic {
            slenderness: Dual::<3>::variable(self.slenderness * times, 0),
            poisson_ratio: Dual::variable(self.poisson_ratio, 1),
            share: Dual::variable(self.share, 2),
        };
        let shortening = elastic.shortening();
        let rocking = if self.leaning {
            elastic.rocking()
        } else {
            Dual::constant(0.0)
        };
        let by = |variable: usize, factor: f64| Column {
            shortening: factor * shortening.derivatives[variable],
            rocking: factor * rocking.derivatives[variable],
        };
        // The fraction of the compliance is `(1 - nu^2)/(E_s c)`.
        let by_share = by(2, self.share);
        let nu = self.poisson_ratio;
        let of_share = -2.0 * nu / (1.0 - nu * nu);
        let direct = by(1, 1.0);
        ColumnSlopes {
            slenderness: by(0, self.slenderness * times),
            contact_compliance: by(2, -self.share),
            young_modulus: by(2, -self.share),
            poisson_ratio: Column {
                shortening: direct.shortening + of_share * by_share.shortening,
                rocking: direct.rocking + of_share * by_share.rocking,
            },
        }
    }

    /// Refuses elastic pillars outside the range of validity; the slenderness is relative to the common pillar.
    pub(crate) fn check(self, times: f64) -> Result<(), InvalidQuantity> {
        if self.compliance != PillarCompliance::Elastic {
            return Ok(());
        }
        let [least, most] = ELASTIC_POISSON_RATIO;
        Requirement::KnownElastic { least, most }
            .check(Quantity::SubstratePoissonRatio, self.poisson_ratio)?;
        let [least, most] = ELASTIC_SLENDERNESS;
        // The ends of the range are accepted despite rounding.
        let slenderness = self.slenderness * times;
        let end = [least, most].into_iter();
        let mut end = end.filter(|end| (slenderness / end - 1.0).abs() < 1e-9);
        let slenderness = end.next().unwrap_or(slenderness);
        Requirement::KnownElastic { least, most }
            .check(Quantity::PillarSlenderness, slenderness)?;
        Ok(())
    }
}

/// Derivatives of the compliance of a pillar with respect to the logarithms of its height over its diameter, of the contact compliance `c`
/// and of Young's modulus of the substrate, and with respect to Poisson's ratio of the substrate; each at constant values of the others.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ColumnSlopes {
    pub(crate) slenderness: Column,
    pub(crate) contact_compliance: Column,
    pub(crate) young_modulus: Column,
    pub(crate) poisson_ratio: Column,
}
