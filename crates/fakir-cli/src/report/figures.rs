//! Figures of a contact, saved with `--output`: each as SVG and PNG.

use super::maps::Maps;
use crate::failure::Failure;
use crate::session::Session;
use fakir::problem::Point;
use fakir::state::ContactState;
use fakir_figure::{
    Figure, FigureError, ProfileState, Text, View, floor_gap_map, pillar_pressure, pressure_map,
    profiles, top_view,
};
use fakir_study::output::File;
use fakir_study::provenance::Provenance;

/// The figures that the state has; none unless maps are wanted. `floor_contact` is in m.
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
        top_view(state, View::Contact, &run),
    ];
    let mut files = Vec::new();
    for figure in figures {
        match figure {
            Ok(figure) => files.extend(saved(figure, provenance)),
            Err(FigureError::Solve(error)) => return Err(error.into()),
            // Of this state or by this method there is no such figure.
            Err(_) => {}
        }
    }
    Ok(files)
}

/// A figure as files.
pub(crate) fn saved(figure: Figure, provenance: &Provenance) -> [File; 2] {
    let figure = figure.with_provenance(&provenance.stamp());
    let name = figure.name();
    [
        File::new(format!("{name}.svg"), figure.svg()),
        File::new(format!("{name}.png"), figure.png()),
    ]
}
