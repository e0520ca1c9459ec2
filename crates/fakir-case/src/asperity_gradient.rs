//! Derivatives of contacts with rounded tops with respect to the keys of their case.

use crate::asperities::AsperityCase;
use crate::key::Key;
use fakir::problem::{LatticeForm, Load, Material, PlaneLattice, Point, Quantity, ShapedLens};
use fakir::state::{
    AsperityContact, AsperityDerivatives, Critical, Derivatives, Gradient, Run, SolveError,
};

/// Relative step, in radians for angles, of differences of the places of pillars on a lattice. They are linear in lengths, and differences of
/// fourth order are exact for them; for angles their error is the fourth power of the step, below rounding.
const STEP: f64 = 1e-3;

/// Changes a number of a lattice by a step.
type Change = fn(&mut PlaneLattice, f64);

/// A contact with rounded tops, or the critical state, with its derivatives by the quantities of its case.
#[derive(Debug, Clone)]
pub struct AsperityCaseGradient {
    /// The contact and its derivatives. The index of a pillar is the number of its top, in the order of `pillars.csv`, and 0.
    pub gradient: Gradient<AsperityContact>,
    /// The critical state, if the load is that of the floor contact.
    pub critical: Option<Critical<AsperityContact>>,
}

impl AsperityCase {
    /// Computes the contact at a load, or the critical state, with its exact derivatives with respect to the numbers of the case, each with all
    /// other keys constant.
    ///
    /// Those by the height of a pillar include its longer column. On a lattice, the height of all pillars scales their scattered heights; with
    /// the pitch, positions in units of the pitch are constant.
    ///
    /// # Errors
    /// As [`fakir::problem::AsperityArray::gradient`].
    pub fn gradient(&self, load: Load, run: &Run<'_>) -> Result<AsperityCaseGradient, SolveError> {
        let found = self.field.gradient(load, self.accuracy, run)?;
        let places = self.by_places();
        let convert = |derivatives: &AsperityDerivatives| {
            self.by_quantities(&found.contact, derivatives, &places)
        };
        Ok(AsperityCaseGradient {
            gradient: Gradient {
                stiffness: found.stiffness,
                force: found.force.as_ref().map(convert),
                indentation: found.indentation.as_ref().map(convert),
                area: Some(convert(&found.area)),
                contact: found.contact,
            },
            critical: found.critical,
        })
    }

    fn by_quantities(
        &self,
        contact: &AsperityContact,
        of: &AsperityDerivatives,
        places: &[(Quantity, Vec<Point>)],
    ) -> Derivatives {
        let asperities = self.field.asperities();
        let heights = self.heights();
        // By the logarithm of the compliance of every column.
        let columns: Vec<f64> = (0..asperities.len())
            .map(|k| of.column_compliance[k] * asperities[k].column_compliance)
            .collect();
        let in_columns: f64 = columns.iter().sum();
        // A column is proportional to its height.
        let longer = |k: usize| {
            if heights[k] > 0.0 {
                columns[k] / heights[k]
            } else {
                0.0
            }
        };
        let mut quantities = Vec::new();
        if self.lens_radius().is_some() {
            quantities.push((Quantity::LensRadius, of.lens_radius));
        }
        let modulus = self.field.reduced_modulus();
        // `1/E*` is the sum of the compliances of both bodies.
        let by_compliance = -of.reduced_modulus * modulus * modulus;
        let young = |material: &Material| {
            -by_compliance * material.plane_strain_compliance() / material.young_modulus
        };
        let poisson = |material: &Material| {
            -by_compliance * 2.0 * material.poisson_ratio / material.young_modulus
        };
        if let Some(lens) = self.field.indenter().material() {
            quantities.extend([
                (Quantity::LensYoungModulus, young(&lens)),
                (Quantity::LensPoissonRatio, poisson(&lens)),
            ]);
        }
        let substrate = self.field.substrate();
        let by_columns = -in_columns / substrate.young_modulus;
        quantities.extend([
            (
                Quantity::SubstrateYoungModulus,
                young(substrate) + by_columns,
            ),
            (Quantity::SubstratePoissonRatio, poisson(substrate)),
        ]);
        if let Some(diameter) = self
            .number(Key::PillarDiameter)
            .filter(|_| self.lattice().is_some())
        {
            let rims: f64 = of.rim_radius.iter().sum();
            quantities.push((
                Quantity::PillarDiameter,
                0.5 * rims - 2.0 * in_columns / diameter,
            ));
        }
        if let Some(height) = self.number(Key::PillarHeight) {
            let numbers = 0..asperities.len();
            let of_pillars: f64 = match self.lattice() {
                Some(_) => numbers
                    .map(|k| {
                        of.raised[k] * asperities[k].raised / height
                            + longer(k) * heights[k] / height
                    })
                    .sum(),
                // Listed pillars have heights of their own, above a floor at the depth of the common height.
                None => -of.raised.iter().sum::<f64>(),
            };
            quantities.push((Quantity::PillarHeight, of_pillars + of.floor));
        }
        quantities.push((Quantity::TopRadius, of.top_radius.iter().sum()));
        for (quantity, by) in places {
            let pairs = of.apex.iter().zip(by);
            let moved = pairs.map(|(slope, by)| slope[0] * by[0] + slope[1] * by[1]);
            quantities.push((*quantity, moved.sum()));
        }
        if !self.field.adhesion().is_none() {
            quantities.push((Quantity::WorkOfAdhesion, of.work_of_adhesion));
        }
        // Moduli of bodies are there already: on layers they also share the compliance between the bodies.
        for (quantity, slope) in &of.layers {
            let known = quantities.iter_mut().find(|(known, _)| known == quantity);
            match known {
                Some((_, sum)) => *sum += slope,
                None => quantities.push((*quantity, *slope)),
            }
        }
        let mut touched: Vec<usize> = (0..asperities.len())
            .filter(|k| contact.asperities[*k].radius > 0.0)
            .collect();
        let away = |k: &usize| asperities[*k].apex[0].hypot(asperities[*k].apex[1]);
        touched.sort_by(|one, two| away(one).total_cmp(&away(two)));
        Derivatives {
            heights: touched
                .iter()
                .map(|k| ((*k as i64, 0), of.raised[*k] + longer(*k)))
                .collect(),
            quantities,
            column_compliance: of.column_compliance.iter().sum(),
        }
    }

    fn lens_radius(&self) -> Option<f64> {
        self.field.indenter().lens().and_then(ShapedLens::radius)
    }

    /// Derivatives of the places of all pillars of a lattice by its numbers.
    fn by_places(&self) -> Vec<(Quantity, Vec<Point>)> {
        let Some(lattice) = self.lattice() else {
            return Vec::new();
        };
        let pitch = lattice.form.pitch();
        let changes: [(Quantity, f64, Change); 6] = [
            (Quantity::Pitch, pitch, |lattice, step| {
                lattice.form = changed(lattice.form, [step, 0.0, 0.0]);
            }),
            (Quantity::PitchY, pitch, |lattice, step| {
                lattice.form = changed(lattice.form, [0.0, step, 0.0]);
            }),
            (Quantity::LatticeAngle, 1.0, |lattice, step| {
                lattice.form = changed(lattice.form, [0.0, 0.0, step]);
            }),
            (Quantity::Offset, 1.0, |lattice, step| {
                lattice.offset += step;
            }),
            (Quantity::OffsetAngle, 1.0, |lattice, step| {
                lattice.offset_angle += step;
            }),
            (Quantity::Rotation, 1.0, |lattice, step| {
                lattice.rotation += step;
            }),
        ];
        let mut found = Vec::new();
        for (quantity, size, change) in changes {
            if Key::of(quantity).is_none_or(|key| self.number(key).is_none()) {
                continue;
            }
            let at = |times: f64| {
                let mut changed = lattice;
                change(&mut changed, times * STEP * size);
                let pillars = changed.cut_pillars(0.0).ok().flatten();
                pillars.filter(|pillars| pillars.len() == self.field.asperities().len())
            };
            let sides = [at(-2.0), at(-1.0), at(1.0), at(2.0)];
            let [Some(a), Some(b), Some(c), Some(d)] = sides else {
                continue;
            };
            let slopes = (0..a.len()).map(|n| {
                [0, 1].map(|k| {
                    let [a, b, c, d] = [&a, &b, &c, &d].map(|side| side[n].0[k]);
                    (8.0 * (c - b) - (d - a)) / (12.0 * STEP * size)
                })
            });
            found.push((quantity, slopes.collect()));
        }
        found
    }
}

/// A lattice with both pitches and its angle changed by these.
fn changed(form: LatticeForm, [along, across, wider]: [f64; 3]) -> LatticeForm {
    match form {
        LatticeForm::Hexagonal { pitch } => LatticeForm::Hexagonal {
            pitch: pitch + along,
        },
        LatticeForm::Square { pitch } => LatticeForm::Square {
            pitch: pitch + along,
        },
        LatticeForm::Rectangular { pitch, pitch_y } => LatticeForm::Rectangular {
            pitch: pitch + along,
            pitch_y: pitch_y + across,
        },
        LatticeForm::Oblique {
            pitch,
            pitch_y,
            angle,
        } => LatticeForm::Oblique {
            pitch: pitch + along,
            pitch_y: pitch_y + across,
            angle: angle + wider,
        },
    }
}
