//! The touched pillars of a contact.

use crate::table::{Column, Table, Values};
use fakir::state::{ContactState, PillarState};

/// The touched pillars, sorted by distance from the lens axis: `pillars.csv`. Without rows if there are none, or if the method does not
/// resolve them.
#[must_use]
pub fn pillars(state: &ContactState) -> Table {
    pillars_of(&state.pillars)
}

/// The same for a given list of pillars, such as those attached at pull-off.
#[must_use]
pub fn pillars_of(pillars: &[PillarState]) -> Table {
    let counts = |name: &str, of: fn(&PillarState) -> i64| Column {
        name: name.to_owned(),
        values: Values::Counts(pillars.iter().map(|pillar| Some(of(pillar))).collect()),
    };
    let numbers = |name: &str, of: fn(&PillarState) -> Option<f64>| Column {
        name: name.to_owned(),
        values: Values::Numbers(pillars.iter().map(of).collect()),
    };
    let status = |pillar: &PillarState| Some(pillar.status.name().to_owned());
    Table {
        columns: vec![
            counts("i", |pillar| pillar.index.0),
            counts("j", |pillar| pillar.index.1),
            numbers("x_m", |pillar| Some(pillar.centre[0])),
            numbers("y_m", |pillar| Some(pillar.centre[1])),
            Column {
                name: "status".to_owned(),
                values: Values::Words(pillars.iter().map(status).collect()),
            },
            numbers("force_N", |pillar| Some(pillar.force)),
            numbers("centre_pressure_Pa", |pillar| Some(pillar.centre_pressure)),
            numbers("smallest_stress_intensity_factor_Pa", |pillar| {
                pillar.stress_intensity_factor.map(|[smallest, _]| smallest)
            }),
            numbers("largest_stress_intensity_factor_Pa", |pillar| {
                pillar.stress_intensity_factor.map(|[_, largest]| largest)
            }),
        ],
    }
}
