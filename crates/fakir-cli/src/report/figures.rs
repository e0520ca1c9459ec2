//! Figures of a contact, saved with `--output`: each as SVG and PNG.

use super::maps::Maps;
use crate::failure::Failure;
use crate::session::Session;
use fakir::problem::{Point, SurfaceSystem};
use fakir::state::{Contact, ContactState, SurfaceContact};
use fakir_figure::{
    FigureError, LoadingPoint, ProfileState, SurfaceState, Text, View, approach, floor_gap_map,
    floor_pressure_map, pillar_pressure, pressure_map, profiles, surface_gap_map,
    surface_pressure_map, surface_profiles, top_view,
};
use fakir_study::approach::{Approach, Loadable};
pub(crate) use fakir_study::figures::saved;
use fakir_study::output::File;
use fakir_study::provenance::Provenance;
use fakir_study::record::Record;

/// The figures of a state; none unless maps are requested. `floor_contact` is in m.
pub(crate) fn files(
    state: &ContactState,
    floor_contact: Option<Point>,
    maps: Maps,
    provenance: &Provenance,
    session: &Session,
) -> Result<Vec<File>, Failure> {
    if maps == Maps::None {
        return Ok(Vec::new());
    }
    session.part("figures");
    let run = session.run();
    let section = ProfileState {
        label: Text::plain(&provenance.question),
        state,
        floor_contact,
    };
    let figures = [
        profiles(&[section], &run),
        pressure_map(state, floor_contact),
        pillar_pressure(state, &run),
        floor_gap_map(state, &run),
        floor_pressure_map(state),
        top_view(state, View::Contact, &run),
    ];
    let mut files = Vec::new();
    for figure in figures {
        match figure {
            Ok(figure) => files.extend(saved(figure, provenance)),
            Err(FigureError::Solve(error)) => return Err(error.into()),
            // This figure does not exist for this state or method.
            Err(_) => {}
        }
    }
    Ok(files)
}

/// The figures of a contact with a general surface.
pub(crate) fn of_surface(
    system: &SurfaceSystem,
    contact: &SurfaceContact,
    floor_contact: Option<Point>,
    provenance: &Provenance,
) -> Vec<File> {
    let state = SurfaceState {
        label: Text::plain(&provenance.question),
        system,
        contact,
        floor_contact,
    };
    let figures = [
        surface_profiles(std::slice::from_ref(&state)),
        surface_pressure_map(&state),
        surface_gap_map(&state),
    ];
    // On a surface without contact, or in full contact, some figures do not exist.
    let figures = figures.into_iter().flatten();
    figures
        .flat_map(|figure| saved(figure, provenance))
        .collect()
}

/// The figure of a loading; none for a single state.
pub(crate) fn of_loading<P: Loadable>(
    found: &Approach<P>,
    point: fn(&Record) -> LoadingPoint,
    provenance: &Provenance,
) -> Vec<File> {
    let points: Vec<LoadingPoint> = found.rows.iter().map(point).collect();
    let critical = found.critical.as_ref().map(|critical| LoadingPoint {
        indentation: critical.contact.indentation(),
        force: critical.contact.force(),
        floor_force: None,
        contact_radius: critical.contact.contact_radius(),
        pillars: None,
        without_floor: false,
    });
    let figure = approach(&points, critical);
    figure.map_or(Vec::new(), |figure| saved(figure, provenance).into())
}
