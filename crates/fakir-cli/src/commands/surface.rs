//! `fakir press` and `fakir transition` of a case with a general surface.

use crate::failure::Failure;
use crate::numbers::with_unit;
use crate::report::Report;
use crate::report::maps::Maps;
use crate::report::surface::{pressed, reached};
use crate::session::Session;
use fakir::problem::Load;
use fakir::state::SurfaceError;
use fakir_case::unit::Dimension;
use fakir_case::{CaseFile, Key, SurfaceCase};
use fakir_study::fields::{FieldMap, MOST_POINTS};
use std::time::Instant;

/// Digits shown of a width.
const WIDTH_DIGITS: usize = 4;

pub(crate) fn press(
    file: &CaseFile,
    load: Load,
    maps: Maps,
    session: &Session,
) -> Result<Report, Failure> {
    let start = Instant::now();
    let (case, contact, widened) = on_wide_enough_a_grid(file, session, |case| {
        check_maps(case, maps, session)?;
        Ok(case.system.press(load, &session.run())?)
    })?;
    let wall_time = start.elapsed().as_secs_f64();
    let mut report = pressed(&case, load, &contact, maps, wall_time);
    report.warnings.extend(widened);
    Ok(report)
}

/// The case and what is asked of it. A grid that turns out too narrow for the contact is made wider
/// where that shows more of the surface; a sentence says so.
fn on_wide_enough_a_grid<T>(
    file: &CaseFile,
    session: &Session,
    ask: impl Fn(&SurfaceCase) -> Result<T, Failure>,
) -> Result<(SurfaceCase, T, Option<String>), Failure> {
    let mut file = file.clone();
    let mut widened = None;
    loop {
        let case = file.surface_case(session.run().memory_limit())?;
        match ask(&case) {
            Err(Failure::Surface(SurfaceError::SurfaceEnds { needed, .. })) if case.can_grow() => {
                file.set_number(Key::GridWidth, needed);
                widened = Some(format!(
                    "the contact goes beyond the grid of the case: solved with surface.grid.width = \
                     {}",
                    with_unit(needed, Dimension::Length, WIDTH_DIGITS)
                ));
            }
            answer => return Ok((case, answer?, widened)),
        }
    }
}

pub(crate) fn transition(
    file: &CaseFile,
    maps: Maps,
    session: &Session,
) -> Result<Report, Failure> {
    let start = Instant::now();
    let (case, critical, widened) = on_wide_enough_a_grid(file, session, |case| {
        check_maps(case, maps, session)?;
        let Some(floor) = case.floor else {
            return Err(Failure::Argument(
                "surface.floor is missing: a height map has no pillars that would tell which part \
                 of it is the floor; give the height at or below which it is"
                    .to_owned(),
            ));
        };
        Ok(case.system.transition(floor, &session.run())?)
    })?;
    let wall_time = start.elapsed().as_secs_f64();
    let mut report = reached(&case, &critical, maps, wall_time);
    report.warnings.extend(widened);
    Ok(report)
}

/// A surface has its fields on its own cells, which are saved if there are not too many.
fn check_maps(case: &SurfaceCase, maps: Maps, session: &Session) -> Result<(), Failure> {
    let grid = case.system.surface().grid();
    match maps {
        Maps::Points(None) if grid.cell_count() <= MOST_POINTS * MOST_POINTS => {
            let sides = [grid.columns(), grid.rows()];
            Ok(FieldMap::check_memory(sides, &session.run())?)
        }
        Maps::Points(Some(_)) => Err(Failure::Argument(
            "--field-points is for textures: the fields of a surface are saved on its own cells, as \
             many as its file or surface.grid gives"
                .to_owned(),
        )),
        _ => Ok(()),
    }
}
