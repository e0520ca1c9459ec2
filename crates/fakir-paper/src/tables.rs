//! The numbers of the report and the figures, as CSV.

use crate::analysis::{PowerLaw, Quantity, offset_spread};
use crate::claims::{Claim, LAW_RANGES, Verdict};
use crate::grid::{Grid, Substrate};
use crate::states::States;
use fakir_study::output::{File, csv_file};
use serde::Serialize;

#[derive(Serialize)]
struct ClaimRow<'a> {
    claim: &'a str,
    verdict: Verdict,
    number: &'a str,
    value: f64,
}

#[derive(Serialize)]
struct LawRow {
    quantity: &'static str,
    substrate: &'static str,
    surface_fraction_from: f64,
    surface_fraction_to: f64,
    points: usize,
    exponent: f64,
    exponent_uncertainty: f64,
    largest_deviation: f64,
    prefactor: f64,
}

#[derive(Serialize)]
struct SpreadRow {
    substrate: &'static str,
    surface_fraction: f64,
    critical_force: f64,
    critical_contact_radius: f64,
    critical_indentation: f64,
}

#[derive(Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
struct LoadingRow {
    surface_fraction: f64,
    indentation_m: f64,
    force_N: f64,
    contact_radius_m: f64,
    pillars_in_contact: usize,
    smallest_floor_gap_m: f64,
}

#[derive(Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
struct PillarRow {
    x_m: f64,
    y_m: f64,
    status: &'static str,
    force_N: f64,
    centre_pressure_Pa: f64,
}

#[derive(Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
struct SharedRow {
    surface_fraction: f64,
    indentation_m: f64,
    force_N: f64,
    contact_radius_m: f64,
    floor_share: f64,
    floor_contact_area_m2: f64,
    floor_share_error_estimate: f64,
}

/// All tables.
#[must_use]
pub fn tables(grid: &Grid, states: &States, claims: &[Claim]) -> Vec<File> {
    vec![
        csv_file("tables/claims.csv", claim_rows(claims)),
        csv_file("tables/power-laws.csv", law_rows(grid)),
        csv_file("tables/offset-spread.csv", spread_rows(grid)),
        csv_file("tables/loading-paths.csv", loading_rows(states)),
        csv_file("tables/pillars.csv", pillar_rows(states)),
        csv_file("tables/floor-shares.csv", shared_rows(states)),
    ]
}

fn claim_rows(claims: &[Claim]) -> impl Iterator<Item = ClaimRow<'_>> {
    claims.iter().flat_map(|claim| {
        claim.numbers.iter().map(|(number, value)| ClaimRow {
            claim: claim.name,
            verdict: claim.verdict,
            number,
            value: *value,
        })
    })
}

fn law_rows(grid: &Grid) -> impl Iterator<Item = LawRow> + '_ {
    let curves = Quantity::ALL
        .into_iter()
        .flat_map(|quantity| Substrate::ALL.map(|substrate| (quantity, substrate)));
    curves.flat_map(move |(quantity, substrate)| {
        LAW_RANGES.into_iter().filter_map(move |range| {
            let law = PowerLaw::of(grid.on_pillar(substrate), quantity, range)?;
            Some(LawRow {
                quantity: quantity.name(),
                substrate: substrate.name(),
                surface_fraction_from: law.range[0],
                surface_fraction_to: law.range[1],
                points: law.points,
                exponent: law.exponent,
                exponent_uncertainty: law.uncertainty,
                largest_deviation: law.largest_deviation,
                prefactor: law.prefactor,
            })
        })
    })
}

/// Largest over smallest value of all offsets, less 1.
fn spread_rows(grid: &Grid) -> impl Iterator<Item = SpreadRow> + '_ {
    Substrate::ALL.into_iter().flat_map(move |substrate| {
        let [force, radius, indentation] =
            Quantity::ALL.map(|quantity| offset_spread(grid, substrate, quantity));
        force
            .into_iter()
            .zip(radius)
            .zip(indentation)
            .map(move |((force, radius), indentation)| SpreadRow {
                substrate: substrate.name(),
                surface_fraction: force.surface_fraction,
                critical_force: force.spread,
                critical_contact_radius: radius.spread,
                critical_indentation: indentation.spread,
            })
    })
}

fn loading_rows(states: &States) -> impl Iterator<Item = LoadingRow> + '_ {
    states.loadings.iter().flat_map(|loading| {
        loading.states.iter().map(|state| LoadingRow {
            surface_fraction: loading.surface_fraction,
            indentation_m: state.indentation,
            force_N: state.force,
            contact_radius_m: state.contact_radius,
            pillars_in_contact: state.pillars_in_contact,
            smallest_floor_gap_m: state.smallest_floor_gap,
        })
    })
}

fn shared_rows(states: &States) -> impl Iterator<Item = SharedRow> + '_ {
    states.shared.iter().filter_map(|shared| {
        let (state, floor) = (&shared.state, shared.state.floor.as_ref()?);
        Some(SharedRow {
            surface_fraction: shared.surface_fraction,
            indentation_m: state.indentation,
            force_N: state.force,
            contact_radius_m: state.contact_radius,
            floor_share: floor.share,
            floor_contact_area_m2: floor.area,
            floor_share_error_estimate: floor.error.share,
        })
    })
}

fn pillar_rows(states: &States) -> impl Iterator<Item = PillarRow> + '_ {
    states.dense.contact.pillars.iter().map(|pillar| PillarRow {
        x_m: pillar.centre[0],
        y_m: pillar.centre[1],
        status: pillar.status.name(),
        force_N: pillar.force,
        centre_pressure_Pa: pillar.centre_pressure,
    })
}
