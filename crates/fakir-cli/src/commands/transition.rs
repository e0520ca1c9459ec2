//! `fakir transition`: the critical state.

use super::surface;
use crate::arguments::Transition;
use crate::failure::{Failure, not_answered};
use crate::numbers::{significant, with_unit};
use crate::report::Report;
use crate::report::figures;
use crate::report::maps::Maps;
use crate::report::state::{
    QuantityList, radius_digits, strained_range, strained_words, texture_line, with_derivatives,
};
use crate::session::Session;
use fakir::problem::{Load, Question};
use fakir::state::{CriticalState, Regime, Solution};
use fakir_case::unit::Dimension;
use fakir_case::{AnyCase, Case};
use fakir_study::citations::Topic;
use fakir_study::provenance::{Provenance, method_words};
use fakir_study::record::GradientObject;
use fakir_study::result::{self, json, pillars, warnings};
use std::time::Instant;

/// The critical state of a case of any kind that has one.
pub(crate) fn run(
    case: &AnyCase,
    options: &Transition,
    session: &Session,
) -> Result<Report, Failure> {
    let maps = options.maps();
    match case {
        AnyCase::Pillars(case) => {
            let range = options.adhesion.of(case)?;
            let with_gradient = options.gradient.question().is_some();
            of_pillars(case, range, with_gradient, maps, session)
        }
        AnyCase::HeightMap(file) => surface::transition(file, maps, session),
        AnyCase::Asperities(_) => Err(not_answered(Question::Transition)),
    }
}

fn of_pillars(
    case: &Case,
    range: Option<f64>,
    with_gradient: bool,
    maps: Maps,
    session: &Session,
) -> Result<Report, Failure> {
    maps.check_memory(session)?;
    let start = Instant::now();
    let (critical, gradient) = if with_gradient {
        let floor = Load::FloorContact;
        let found = fakir::gradient(&case.system, floor, case.method, &session.run())?;
        (found.critical_state()?, Some(GradientObject::from(&found)))
    } else {
        let critical = fakir::transition(&case.system, case.method, &session.run())?;
        (critical, None)
    };
    let wall_time = start.elapsed().as_secs_f64();
    let state = &critical.contact;
    let provenance = Provenance::new(
        "critical state",
        method_words(case.method),
        &Topic::of_case_with_range(case, range),
        case.to_toml(),
    );
    let mut tables = maps.table(|| pillars(state).some_csv("pillars.csv"));
    tables.extend(maps.files(state, &provenance, session)?);
    let floor_contact = Some(critical.floor_contact);
    let figures = figures::files(state, floor_contact, maps, &provenance, session)?;
    tables.extend(figures);
    Ok(Report {
        text: with_derivatives(text(&critical, range, wall_time), gradient.as_ref()),
        json: json(&result::transition(&critical, range, gradient, wall_time)),
        provenance,
        tables,
        warnings: [warnings(state), strained_range(&state.limits(range))].concat(),
        converged: state.is_answer(),
        strained: strained_words(&state.limits(range)),
    })
}

fn text(critical: &CriticalState, range: Option<f64>, wall_time: f64) -> String {
    let state = &critical.contact;
    let reduced = critical.normalized();
    let radius_error = critical.relative_contact_radius_error();
    let mut list = QuantityList::default();
    list.load(state, &reduced)
        .radius(
            "contact radius",
            critical.contact_radius(),
            radius_error,
            format!(
                "a/e = {}",
                significant(reduced.contact_radius, radius_digits(radius_error))
            ),
        )
        .quantity(
            "  on the pillar tops",
            state.contact_radius,
            Dimension::Length,
            radius_digits(state.relative_contact_radius_error()),
            String::new(),
        )
        .length(
            "  of the floor contact",
            critical.floor_contact_distance(),
            place(critical),
        )
        .pillars(state)
        .range(&state.limits(range))
        .model(&state.limits(range))
        .solution(state, wall_time);
    let first = match critical.regime {
        Regime::TopFirst => "the lens rests on pillar tops and just reaches the floor",
        Regime::BottomFirst => "the lens reaches the floor before any pillar",
    };
    format!(
        "Critical state: {first}\n{}\n{}\n\n{}",
        texture_line(&state.system),
        method_words(state.method),
        list.text()
    )
}

/// Where the floor is touched, of the symmetric copies the one that is reported.
fn place(critical: &CriticalState) -> String {
    let rounding = 1e-9 * critical.floor_contact_distance();
    let [x, y] = critical.floor_contact.map(|value| {
        let value = if value.abs() > rounding { value } else { 0.0 };
        with_unit(value, Dimension::Length, 5)
    });
    format!("at x = {x}, y = {y}")
}
