//! `fakir press` and `fakir transition` of a case with a general surface.

use crate::failure::Failure;
use crate::report::Report;
use crate::report::surface::{pressed, reached};
use crate::session::Session;
use fakir::contact::Load;
use fakir_case::SurfaceCase;
use std::time::Instant;

pub(crate) fn press(case: &SurfaceCase, load: Load, session: &Session) -> Result<Report, Failure> {
    let start = Instant::now();
    let contact = case.system.press(load, &session.run())?;
    Ok(pressed(case, &contact, start.elapsed().as_secs_f64()))
}

pub(crate) fn transition(case: &SurfaceCase, session: &Session) -> Result<Report, Failure> {
    let Some(floor) = case.floor else {
        return Err(Failure::Argument(
            "surface.floor is missing: a height map has no pillars that would tell which part of \
             it is the floor; give the height at or below which it is"
                .to_owned(),
        ));
    };
    let start = Instant::now();
    let critical = case.system.transition(floor, &session.run())?;
    Ok(reached(case, &critical, start.elapsed().as_secs_f64()))
}
