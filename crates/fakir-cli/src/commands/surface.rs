//! `fakir press` and `fakir transition` of a case with a general surface.

use crate::failure::Failure;
use crate::report::Report;
use crate::report::maps::Maps;
use crate::report::surface::{pressed, reached};
use crate::session::Session;
use fakir::contact::Load;
use fakir_case::SurfaceCase;
use fakir_study::fields::{FieldMap, MOST_POINTS};
use std::time::Instant;

pub(crate) fn press(
    case: &SurfaceCase,
    load: Load,
    maps: Maps,
    session: &Session,
) -> Result<Report, Failure> {
    check_maps(case, maps, session)?;
    let start = Instant::now();
    let contact = case.system.press(load, &session.run())?;
    let wall_time = start.elapsed().as_secs_f64();
    Ok(pressed(case, load, &contact, maps, wall_time))
}

pub(crate) fn transition(
    case: &SurfaceCase,
    maps: Maps,
    session: &Session,
) -> Result<Report, Failure> {
    check_maps(case, maps, session)?;
    let Some(floor) = case.floor else {
        return Err(Failure::Argument(
            "surface.floor is missing: a height map has no pillars that would tell which part of \
             it is the floor; give the height at or below which it is"
                .to_owned(),
        ));
    };
    let start = Instant::now();
    let critical = case.system.transition(floor, &session.run())?;
    let wall_time = start.elapsed().as_secs_f64();
    Ok(reached(case, &critical, maps, wall_time))
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
