//! `fakir press` of pillars with rounded tops.

use crate::failure::Failure;
use crate::numbers::{LENGTH_DIGITS, digits, seconds, significant};
use crate::report::Report;
use crate::report::asperities::{case_line, method_line};
use crate::report::maps::Maps;
use crate::report::state::{QuantityList, error_remark};
use crate::session::Session;
use fakir::problem::Load;
use fakir::state::{PillarStatus, Solution};
use fakir_case::AsperityCase;
use fakir_case::unit::Dimension;
use fakir_figure::asperity_map;
use fakir_study::citations::Topic;
use fakir_study::figures::saved;
use fakir_study::provenance::Provenance;
use fakir_study::record::AsperityAnswer;
use fakir_study::result::{
    asperity_pillars, asperity_press, asperity_warnings, control_words, json, left_out_words,
};
use std::time::Instant;

pub(crate) fn press(
    case: &AsperityCase,
    control: Load,
    maps: Maps,
    session: &Session,
) -> Result<Report, Failure> {
    let start = Instant::now();
    let contact = case.field.press(control, case.accuracy, &session.run())?;
    let wall_time = start.elapsed().as_secs_f64();
    let provenance = Provenance::new(
        control_words(control),
        method_line(case.accuracy),
        &[Topic::Asperities],
        case.to_toml(),
    );
    let answer = AsperityAnswer::of(case, &contact);
    let mut tables = maps.table(|| asperity_pillars(answer).some_csv("pillars.csv"));
    if maps != Maps::None {
        tables.extend(saved(asperity_map(&case.field, &contact), &provenance));
    }
    Ok(Report {
        json: json(&asperity_press(answer, wall_time)),
        text: text(case, answer, wall_time),
        provenance,
        tables,
        warnings: asperity_warnings(answer),
        converged: contact.is_answer(),
        strained: Vec::new(),
    })
}

fn text(case: &AsperityCase, answer: AsperityAnswer<'_>, wall_time: f64) -> String {
    let contact = answer.contact;
    let error = contact.error.unwrap_or_default();
    let relative = |error: f64, value: f64| if value > 0.0 { error / value } else { 0.0 };
    let remark = |error: f64| {
        let remark = error_remark(error);
        remark.trim_start_matches([',', ' ']).to_owned()
    };
    let depth = relative(error.indentation, contact.indentation.abs());
    let mut list = QuantityList::default();
    list.quantity(
        "force",
        contact.force,
        Dimension::Force,
        digits(error.force),
        remark(error.force),
    )
    .quantity(
        "indentation",
        contact.indentation,
        Dimension::Length,
        digits(depth),
        remark(depth),
    )
    .area(
        "contact area",
        contact.area,
        digits(error.area),
        &remark(error.area),
    );
    if let Some(radius) = contact.contact_radius {
        list.length("contact radius", radius, String::new());
    }
    let full = contact
        .asperities
        .iter()
        .filter(|asperity| asperity.status == PillarStatus::Full);
    let full = match full.count() {
        0 => String::new(),
        full => format!(", {full} of them up to the rim"),
    };
    list.row(
        "pillars in contact",
        contact.touched().to_string(),
        "",
        &format!("of {}{full}", contact.asperities.len()),
    );
    if contact.touched() > 0 {
        let most = |of: fn(&fakir::state::AsperityState) -> f64| {
            contact.asperities.iter().map(of).fold(0.0, f64::max)
        };
        list.length(
            "largest contact on a top",
            most(|asperity| asperity.radius),
            "radius".to_owned(),
        )
        .quantity(
            "largest force on a pillar",
            most(|asperity| asperity.force),
            Dimension::Force,
            LENGTH_DIGITS,
            String::new(),
        )
        .row(
            "stiffness",
            significant(contact.slopes.force_with_indentation, LENGTH_DIGITS),
            "N/m",
            "",
        );
    }
    list.row(
        "Newton steps",
        contact.iterations.to_string(),
        "",
        &format!(
            "{}, in {}",
            contact.termination.description(),
            seconds(wall_time)
        ),
    );
    format!(
        "Contact under load\n{}\n{}; {}\n\n{}",
        case_line(case),
        method_line(case.accuracy),
        left_out_words(answer),
        list.text()
    )
}
