//! `fakir press`: the contact under a load.

use super::{asperities, surface};
use crate::arguments::Press;
use crate::failure::Failure;
use crate::numbers::{significant, with_unit};
use crate::report::Report;
use crate::report::figures;
use crate::report::maps::Maps;
use crate::report::state::{
    QuantityList, radius_digits, strained_range, strained_words, texture_line, with_derivatives,
};
use crate::session::Session;
use fakir::problem::{FloorModel, Load, Method};
use fakir::state::{ContactState, CriticalState, Normalized, Solution, SolveError};
use fakir_case::unit::Dimension;
use fakir_case::{AnyCase, Case};
use fakir_study::citations::Topic;
use fakir_study::provenance::{Provenance, method_words};
use fakir_study::record::GradientObject;
use fakir_study::result::{self, control_words, json, pillars, warnings};
use std::time::Instant;

/// The contact of a case of any kind.
pub(crate) fn run(case: &AnyCase, options: &Press, session: &Session) -> Result<Report, Failure> {
    let (load, maps) = (options.load.load(), options.maps());
    match case {
        AnyCase::Pillars(case) => {
            let range = options.adhesion.of(case)?;
            let with_gradient = options.gradient.question().is_some();
            of_pillars(case, load, range, with_gradient, maps, session)
        }
        AnyCase::Asperities(case) => asperities::press(case, load, maps, session),
        AnyCase::HeightMap(file) => surface::press(file, load, maps, session),
    }
}

fn of_pillars(
    case: &Case,
    control: Load,
    range: Option<f64>,
    with_gradient: bool,
    maps: Maps,
    session: &Session,
) -> Result<Report, Failure> {
    maps.check_memory(session)?;
    let start = Instant::now();
    let (state, gradient) = if with_gradient {
        let found = fakir::gradient(&case.system, control, case.method, &session.run())?;
        let gradient = GradientObject::from(&found);
        (found.contact, Some(gradient))
    } else {
        let state = fakir::press(&case.system, control, case.method, &session.run())?;
        (state, None)
    };
    let wall_time = start.elapsed().as_secs_f64();
    let mut warnings = warnings(&state);
    warnings.extend(strained_range(&state.limits(range)));
    if state.smallest_floor_gap < 0.0 {
        session.part("critical state");
        warnings.push(beyond(case, session)?);
    }
    let provenance = Provenance::new(
        control_words(control),
        method_words(case.method),
        &Topic::of_case_with_range(case, range),
        case.to_toml(),
    );
    let mut tables = maps.table(|| pillars(&state).some_csv("pillars.csv"));
    tables.extend(maps.files(&state, &provenance, session)?);
    let figures = figures::files(&state, None, maps, &provenance, session)?;
    tables.extend(figures);
    Ok(Report {
        text: with_derivatives(text(&state, range, wall_time), gradient.as_ref()),
        json: json(&result::press(&state, range, gradient, wall_time)),
        provenance,
        tables,
        warnings,
        converged: state.is_answer(),
        strained: strained_words(&state.limits(range)),
    })
}

/// The warning past the transition where the floor is ignored, with the load that should not have been exceeded.
fn beyond(case: &Case, session: &Session) -> Result<String, Failure> {
    let critical = match fakir::transition(&case.system, case.method, &session.run()) {
        Ok(critical) => critical_load(&critical),
        Err(SolveError::Interrupted) => return Err(SolveError::Interrupted.into()),
        Err(error) => format!("at a load that could not be computed ({error})"),
    };
    let advice = match (case.system.floor_model(), case.method) {
        (FloorModel::Contact, Method::Love(_) | Method::Punch(_) | Method::Homogenised) => {
            ": only the method spectral knows what it bears"
        }
        _ => "",
    };
    Ok(format!(
        "past the transition: the lens reaches the floor {critical}; this contact is computed as \
         if the floor were not there{advice}"
    ))
}

fn critical_load(critical: &CriticalState) -> String {
    format!(
        "at a force of {} and an indentation of {}",
        with_unit(critical.contact.force, Dimension::Force, 6),
        with_unit(critical.contact.indentation, Dimension::Length, 6)
    )
}

fn text(state: &ContactState, range: Option<f64>, wall_time: f64) -> String {
    let radius = state.whole_contact_radius();
    let reduced = Normalized::new(&state.system, state.force, radius, state.indentation);
    let gap = if state.floor.is_some() {
        "in contact: past the transition"
    } else if state.beyond_transition() {
        "negative: past the transition"
    } else {
        ""
    };
    let radius_error = state.relative_whole_contact_radius_error();
    let mut list = QuantityList::default();
    list.load(state, &reduced).radius(
        "contact radius",
        radius,
        radius_error,
        format!(
            "a/e = {}",
            significant(reduced.contact_radius, radius_digits(radius_error))
        ),
    );
    if radius > state.contact_radius {
        list.quantity(
            "  on the pillar tops",
            state.contact_radius,
            Dimension::Length,
            radius_digits(state.relative_contact_radius_error()),
            String::new(),
        );
    }
    list.pillars(state)
        .length(
            "smallest floor gap",
            state.smallest_floor_gap,
            gap.to_owned(),
        )
        .floor(state)
        .range(&state.limits(range))
        .model(&state.limits(range))
        .solution(state, wall_time);
    format!(
        "Contact under load\n{}\n{}\n\n{}",
        texture_line(&state.system),
        method_words(state.method),
        list.text()
    )
}
