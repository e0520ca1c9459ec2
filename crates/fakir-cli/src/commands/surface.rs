//! `fakir press`, `transition` and `verify` of a case with a general surface.

use crate::failure::Failure;
use crate::report::Report;
use crate::report::maps::Maps;
use crate::report::surface::{pressed, reached, verified};
use crate::session::Session;
use fakir::problem::Load;
use fakir::state::SolveError;
use fakir_case::{CaseFile, SurfaceCase};
use fakir_study::fields::{FieldMap, MOST_POINTS};
use fakir_study::surfaces;
use std::time::Instant;

pub(crate) fn press(
    file: &CaseFile,
    control: Load,
    maps: Maps,
    session: &Session,
) -> Result<Report, Failure> {
    let start = Instant::now();
    let (case, contact, widened) = on_wide_enough_a_grid(file, session, |case| {
        check_maps(case, maps, session)?;
        Ok(case.system.press(control, &session.run())?)
    })?;
    let wall_time = start.elapsed().as_secs_f64();
    let mut report = pressed(&case, control, &contact, maps, wall_time);
    report.warnings.extend(widened);
    Ok(report)
}

/// The case and what is asked of it, on a grid that is wide enough; a sentence if that of the file is
/// not.
pub(super) fn on_wide_enough_a_grid<T>(
    file: &CaseFile,
    session: &Session,
    ask: impl FnMut(&SurfaceCase) -> Result<T, Failure>,
) -> Result<(SurfaceCase, T, Option<String>), Failure> {
    let needed = |failure: &Failure| match failure {
        Failure::Solve(SolveError::SurfaceEnds { needed, .. }) => Some(*needed),
        _ => None,
    };
    let limit = session.run().memory_limit();
    let answered = surfaces::on_wide_enough_a_grid(file, limit, needed, ask)?;
    Ok((answered.case, answered.answer, answered.widened))
}

pub(crate) fn transition(
    file: &CaseFile,
    maps: Maps,
    session: &Session,
) -> Result<Report, Failure> {
    let start = Instant::now();
    let (case, critical, widened) = on_wide_enough_a_grid(file, session, |case| {
        check_maps(case, maps, session)?;
        if case.system.floor().is_none() {
            return Err(Failure::Argument(
                "surface.floor is missing: a height map has no pillars that would tell which part \
                 of it is the floor; give the height at or below which it is"
                    .to_owned(),
            ));
        }
        Ok(case.system.transition(&session.run())?)
    })?;
    let wall_time = start.elapsed().as_secs_f64();
    let mut report = reached(&case, &critical, maps, wall_time);
    report.warnings.extend(widened);
    Ok(report)
}

/// Pillars of any form on two meshes.
pub(crate) fn verify(
    file: &CaseFile,
    control: Load,
    cells_per_diameter: usize,
    session: &Session,
) -> Result<Report, Failure> {
    let start = Instant::now();
    let next = |part: &str| session.part(part);
    let found = surfaces::verify(file, control, cells_per_diameter, &session.run(), &next)?;
    let wall_time = start.elapsed().as_secs_f64();
    let mut report = verified(control, &found, wall_time);
    let [coarse, fine] = found.answers;
    report.warnings.extend(fine.widened.or(coarse.widened));
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
