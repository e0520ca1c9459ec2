//! How a contact changes with the numbers of its case.

use fakir::problem::Quantity;
use fakir::state::{Derivatives, Gradient};
use fakir_case::Key;
use serde::Serialize;
use std::collections::BTreeMap;

/// Derivatives by the keys of the case, each in the unit of the result over the SI unit of the key.
type ByKey = BTreeMap<&'static str, f64>;

/// Exact derivatives of a contact: what `--gradient` adds.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
pub struct GradientObject {
    /// None where the force is prescribed.
    force_N: Option<ByKey>,
    /// None where the indentation is prescribed.
    indentation_m: Option<ByKey>,
    /// None where the edge of the contact crosses a pillar.
    contact_area_m2: Option<ByKey>,
    stiffness_N_per_m: f64,
    pillars: Vec<PillarGradient>,
}

/// Derivatives by the height of one pillar.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
struct PillarGradient {
    i: i64,
    j: i64,
    force_N_per_m: Option<f64>,
    indentation_m_per_m: Option<f64>,
}

fn by_key(derivatives: &Derivatives) -> ByKey {
    let named = |(quantity, value): &(Quantity, f64)| Some((Key::of(*quantity)?.path(), *value));
    derivatives.quantities.iter().filter_map(named).collect()
}

impl<C> From<&Gradient<C>> for GradientObject {
    fn from(gradient: &Gradient<C>) -> Self {
        let by_keys = |derivatives: &Option<Derivatives>| derivatives.as_ref().map(by_key);
        let parts = [&gradient.force, &gradient.indentation];
        let listed = parts.into_iter().flatten().next();
        let heights = listed.map_or(&[][..], |derivatives| &derivatives.heights);
        let of = |derivatives: &Option<Derivatives>, number: usize| {
            derivatives.as_ref().map(|all| all.heights[number].1)
        };
        let pillar = |(number, ((i, j), _)): (usize, &((i64, i64), f64))| PillarGradient {
            i: *i,
            j: *j,
            force_N_per_m: of(&gradient.force, number),
            indentation_m_per_m: of(&gradient.indentation, number),
        };
        Self {
            force_N: by_keys(&gradient.force),
            indentation_m: by_keys(&gradient.indentation),
            contact_area_m2: by_keys(&gradient.area),
            stiffness_N_per_m: gradient.stiffness,
            pillars: heights.iter().enumerate().map(pillar).collect(),
        }
    }
}

impl GradientObject {
    /// A table for people: by every key, the derivatives of force and indentation.
    #[must_use]
    pub fn text(&self) -> String {
        let mut lines = vec!["Derivatives, in N and m over the SI unit of the key".to_owned()];
        let parts = [
            ("force", &self.force_N),
            ("indentation", &self.indentation_m),
        ];
        for (what, derivatives) in parts {
            for (key, value) in derivatives.iter().flatten() {
                lines.push(format!("  {what:<12} {key:<26} {value:>14.6e}"));
            }
        }
        lines.join("\n")
    }
}
