//! The touched pillars of a contact as a table.

use crate::output::File;
use fakir::state::ContactState;
use serde::Serialize;

/// A pillar in `pillars.csv`.
#[derive(Debug, Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
struct PillarRow {
    i: i64,
    j: i64,
    x_m: f64,
    y_m: f64,
    status: &'static str,
    force_N: f64,
    centre_pressure_Pa: f64,
    smallest_edge_coefficient_Pa: Option<f64>,
    largest_edge_coefficient_Pa: Option<f64>,
}

/// The touched pillars as `pillars.csv`; none if there are none, or the method does not resolve them.
#[must_use]
pub fn table(state: &ContactState) -> Option<File> {
    if state.pillars.is_empty() {
        return None;
    }
    let mut writer = csv::Writer::from_writer(Vec::new());
    for pillar in &state.pillars {
        let row = PillarRow {
            i: pillar.index.0,
            j: pillar.index.1,
            x_m: pillar.centre[0],
            y_m: pillar.centre[1],
            status: pillar.status.name(),
            force_N: pillar.force,
            centre_pressure_Pa: pillar.centre_pressure,
            smallest_edge_coefficient_Pa: pillar.edge_coefficient.map(|range| range[0]),
            largest_edge_coefficient_Pa: pillar.edge_coefficient.map(|range| range[1]),
        };
        writer.serialize(row).expect("flat structs are CSV records");
    }
    let bytes = writer.into_inner().expect("memory takes every byte");
    Some(File::new("pillars.csv", bytes))
}
