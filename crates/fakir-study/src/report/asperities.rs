//! Common parts of the reports of rounded pillar tops.

use crate::numbers::{LENGTH_DIGITS, with_unit};
use crate::provenance::method_words;
use crate::report::state::{layers_part, shape_words};
use fakir::problem::{Accuracy, Asperity, Indenter, Method};
use fakir_case::AsperityCase;
use fakir_case::unit::Dimension;

/// Description of the case in one line: `64 rounded pillar tops, radius of curvature 526.0 um, under a plate`.
pub fn case_line(case: &AsperityCase) -> String {
    let asperities = case.field.asperities();
    let radius = asperities
        .first()
        .map_or(0.0, |asperity: &Asperity| asperity.top_radius);
    let indenter = match case.field.indenter() {
        Indenter::Flat(_) => "a plate".to_owned(),
        Indenter::Lens(lens) => match lens.sphere() {
            Some(sphere) => format!(
                "a lens of radius {}",
                with_unit(sphere.radius, Dimension::Length, LENGTH_DIGITS)
            ),
            None => format!("a {}", shape_words(lens)),
        },
    };
    format!(
        "{} rounded pillar tops, radius of curvature {}, under {indenter}{}",
        asperities.len(),
        with_unit(radius, Dimension::Length, LENGTH_DIGITS),
        layers_part(case.field.layers())
    )
}

/// Description of the method.
pub fn method_line(accuracy: Accuracy) -> String {
    method_words(Method::Spectral(accuracy))
}
