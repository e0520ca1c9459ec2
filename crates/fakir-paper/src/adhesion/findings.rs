//! Findings of the study, as sentences with numbers from the tables.

use super::scaling::{HeldOut, Law, Reduced};
use super::study::{Cases, FloorCase, Scope, same};
use crate::claims::{percent, short};
use crate::grid::Substrate;
use fakir::solve::collapsed_floor::{MODEL_ERROR_OF_AREA, MODEL_ERROR_OF_FORCE};
use fakir_study::{FloorOutcome, MODEL_ERROR_OF_LOSS, Validity};
use std::fmt::Write;

/// The work of adhesion of the paper's rubber, J/m^2.
pub const RUBBER: f64 = 50e-3;

/// Surface fraction of findings about a single surface.
pub const TYPICAL: f64 = 0.03;

/// Deviation from a law beyond which the report calls the law a trend.
const NO_LAW: f64 = 0.4;

/// A finding with its numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// Short name for references.
    pub name: &'static str,
    /// Subject.
    pub title: &'static str,
    /// Text.
    pub text: String,
    /// Numbers in the text, with names that end in their unit.
    pub numbers: Vec<(String, f64)>,
}

/// A law with its test on cases that were not used in its fit.
pub type Checked = (Law, Option<HeldOut>);

/// All findings.
#[must_use]
pub fn findings(scope: &Scope, cases: &Cases, laws: &[Checked]) -> Vec<Finding> {
    let mut all = vec![coverage(cases), on_cells(cases)];
    all.extend([tops(cases), thresholds(cases)]);
    all.extend([jump(cases), border(cases), pulls(cases), losses(cases)]);
    all.push(rubber(scope, cases));
    all.extend(laws.iter().map(|law| Some(scaling(law))));
    all.extend([offsets(cases), sizes(scope, cases)]);
    all.into_iter().flatten().collect()
}

fn named<const N: usize>(numbers: [(&str, f64); N]) -> Vec<(String, f64)> {
    numbers
        .map(|(name, value)| (name.to_owned(), value))
        .to_vec()
}

fn share(part: usize, of: usize) -> f64 {
    part as f64 / of.max(1) as f64
}

fn coverage(cases: &Cases) -> Option<Finding> {
    let all = cases.floor.len();
    let of = |validity: Validity| {
        let cases = cases.floor.iter();
        cases
            .filter(|case| case.found.unloading_validity == validity)
            .count()
    };
    let [good, narrow, wide, meet, none] = [
        Validity::InRange,
        Validity::FrontNarrow,
        Validity::AnnuliWide,
        Validity::AnnuliMeet,
        Validity::NoFront,
    ]
    .map(of);
    let steep = |case: &&FloorCase| {
        case.found.unloading_validity == Validity::InRange
            && case.found.annulus_slope.is_some_and(|slope| slope > 1.0)
    };
    let steep = cases.floor.iter().filter(steep).count();
    let beyond = |case: &&FloorCase| case.found.unloading_validity != Validity::InRange;
    let on_cells = |case: &&FloorCase| case.cells.is_some();
    let solved = cases.floor.iter().filter(beyond).filter(on_cells).count();
    (all > 0).then(|| Finding {
        name: "coverage",
        title: "What the numbers are worth",
        text: format!(
            "Of {all} cases of an adhesive floor the fast model is in its range in {good} ({}): one bonded region of at least two pitches in radius, annuli \
             below 0.3 pitches. There its force is accurate to {} of that of the tops, its area to {}, and the indentation of detachment to {} ζ_c, by comparison with cells on the floor. In {narrow} the bonded \
             region is too small for a disc, in {wide} annuli are too wide, in {meet} they would meet and the model was not evaluated, and in {none} no front is in equilibrium: {solved} of those are solved \
             on cells of the floor, with separate errors. \
             In {steep} of those in range the step beside a pillar is steeper than 1, where linear elasticity itself is doubtful.",
            percent(share(good, all)),
            percent(MODEL_ERROR_OF_FORCE),
            percent(MODEL_ERROR_OF_AREA),
            short(MODEL_ERROR_OF_LOSS),
        ),
        numbers: named([
            ("model_error_of_force", MODEL_ERROR_OF_FORCE),
            ("model_error_of_area", MODEL_ERROR_OF_AREA),
            ("model_error_of_loss", MODEL_ERROR_OF_LOSS),
            ("floor_cases", all as f64),
            ("in_range", good as f64),
            ("front_narrow", narrow as f64),
            ("annuli_wide", wide as f64),
            ("annuli_meet", meet as f64),
            ("no_front", none as f64),
            ("solved_on_cells", solved as f64),
            ("in_range_and_steep", steep as f64),
        ]),
    })
}

fn counted(cases: usize) -> String {
    format!("{cases} {}", if cases == 1 { "case" } else { "cases" })
}

/// Comparison of the fast model with floor cells.
fn on_cells(cases: &Cases) -> Option<Finding> {
    // Differences, each with the estimated error of the cells.
    let mut force: Vec<[f64; 2]> = Vec::new();
    let mut area: Vec<[f64; 2]> = Vec::new();
    let mut loss: Vec<[f64; 2]> = Vec::new();
    let all = cases.floor.iter().chain(&cases.check);
    let solved: Vec<&FloorCase> = all.filter(|case| case.cells.is_some()).collect();
    for case in &solved {
        let Some(floor) = case.cells else {
            continue;
        };
        let model = &case.found;
        if let Some(jump) = model.jump
            && model.jump_validity == Validity::InRange
        {
            let [by_model, by_cells] =
                [jump.force, floor.jump.force].map(|force| force / model.critical_force);
            let error = floor.jump_force_error * by_cells.abs();
            force.push([(by_model - by_cells).abs(), error]);
            let ratio = jump.floor_area / floor.jump.floor_area;
            area.push([(ratio - 1.0).abs(), floor.jump_area_error]);
        }
        if let (Some(by_model), Some(by_cells)) = (model.lost, floor.lost)
            && model.unloading_validity == Validity::InRange
        {
            let [by_model, by_cells] =
                [by_model, by_cells].map(|lost| lost.indentation / model.critical_indentation);
            let error = floor.lost_indentation_error * by_cells.abs();
            loss.push([(by_model - by_cells).abs(), error]);
        }
    }
    let largest = |of: &[[f64; 2]]| [0, 1].map(|k| of.iter().map(|it| it[k]).fold(0.0, f64::max));
    let [of_force, of_area, of_loss] = [&force, &area, &loss].map(|of| largest(of));
    let mut text = format!(
        "Tops and floor were solved together, on cells of the floor, for {}.",
        counted(solved.len())
    );
    if !force.is_empty() {
        let [[force_change, force_error], [area_change, area_error]] =
            [of_force, of_area].map(|of| of.map(percent));
        let _ = write!(
            text,
            " After the jump the fast model is in its range for {}: its force differs by {force_change} of the critical force at most, and its area by {area_change}; the estimated \
             errors of the cells are {force_error} and {area_error}.",
            counted(force.len()),
        );
    }
    if !loss.is_empty() {
        let [change, error] = of_loss.map(short);
        let _ = write!(
            text,
            " At the unloading point it is for {}: the indentation at which the floor detaches differs by {change} ζ_c at most; the error of the cells is {error} ζ_c.",
            counted(loss.len()),
        );
    }
    (!(force.is_empty() && loss.is_empty())).then(|| Finding {
        name: "cells",
        title: "The fast model beside cells",
        text,
        numbers: named([
            ("cases_on_cells", solved.len() as f64),
            ("cases_in_range_after_jump", force.len() as f64),
            ("largest_change_of_force_over_critical_force", of_force[0]),
            (
                "largest_error_of_force_of_cells_over_critical_force",
                of_force[1],
            ),
            ("largest_relative_change_of_area", of_area[0]),
            ("largest_relative_error_of_area_of_cells", of_area[1]),
            ("cases_in_range_at_turn", loss.len() as f64),
            (
                "largest_change_of_loss_over_critical_indentation",
                of_loss[0],
            ),
            (
                "largest_error_of_loss_of_cells_over_critical_indentation",
                of_loss[1],
            ),
        ]),
    })
}

/// Effect of adhesive tops on the critical force.
fn tops(cases: &Cases) -> Option<Finding> {
    let changes = cases.floor.iter().filter_map(|case| {
        let tops = cases.tops_of(case)?;
        let with = tops.critical_force?;
        let hard = !same(case.young_modulus, Substrate::Soft.young_modulus());
        (case.found.critical_force > 0.0 && hard).then(|| with / case.found.critical_force - 1.0)
    });
    let (low, high) = range(changes)?;
    Some(Finding {
        name: "critical-force",
        title: "The load at which the floor is touched",
        text: format!(
            "Adhesion acts after first contact: on the rigid and the intermediate substrate adhesive tops change the critical force by {} at most.",
            percent(low.abs().max(high.abs()))
        ),
        numbers: named([
            ("smallest_change_of_critical_force", low),
            ("largest_change_of_critical_force", high),
        ]),
    })
}

fn range(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    values.fold(None, |range: Option<(f64, f64)>, value| {
        Some(range.map_or((value, value), |(low, high)| {
            (low.min(value), high.max(value))
        }))
    })
}

fn thresholds(cases: &Cases) -> Option<Finding> {
    let at = |substrate| {
        let mut found = cases
            .on_pillar(substrate)
            .filter(|case| same(case.found.surface_fraction, TYPICAL));
        found.next().map(|case| 1e3 * case.found.collapse_work)
    };
    let [rigid, intermediate, soft] = Substrate::ALL.map(at);
    let (rigid, intermediate, soft) = (rigid?, intermediate?, soft?);
    Some(Finding {
        name: "thresholds",
        title: "The threshold of the flat lattice",
        text: format!(
            "Without load the flat lattice at φ = {TYPICAL} collapses onto the floor above w_c = {}, {} and {} mJ/m^2 on the rigid, the intermediate and the soft \
             substrate (closed form).",
            short(rigid),
            short(intermediate),
            short(soft)
        ),
        numbers: named([
            ("collapse_work_rigid_mJ_per_m2", rigid),
            ("collapse_work_intermediate_mJ_per_m2", intermediate),
            ("collapse_work_soft_mJ_per_m2", soft),
        ]),
    })
}

fn jump(cases: &Cases) -> Option<Finding> {
    let case = cases.at(Substrate::Intermediate, TYPICAL, RUBBER)?;
    let jump = case.found.jump?;
    let drop = 1.0 - jump.force / case.found.critical_force;
    let area = 1e12 * jump.floor_area;
    Some(Finding {
        name: "jump",
        title: "The jump",
        text: format!(
            "With 50 mJ/m^2 on the intermediate substrate at φ = {TYPICAL} the first touch draws the lens onto the floor over {} µm^2 and {} holes, and the force falls \
             by {} of {} mN.",
            short(area),
            jump.holes,
            percent(drop),
            short(1e3 * case.found.critical_force)
        ),
        numbers: named([
            ("jump_area_um2", area),
            ("jump_holes", jump.holes as f64),
            ("jump_force_drop", drop),
            ("critical_force_mN", 1e3 * case.found.critical_force),
        ]),
    })
}

/// Range of works of adhesion, in units of the work of collapse, beyond which the floor remains
/// attached at zero load.
fn border(cases: &Cases) -> Option<Finding> {
    let ratio = |fate: FloorOutcome| {
        let on = [Substrate::Rigid, Substrate::Intermediate].into_iter();
        on.flat_map(|substrate| cases.on_pillar(substrate))
            .filter(move |case| case.fate() == Some(fate))
            .map(|case| case.found.work_over_collapse_work)
    };
    let (_, last) = range(ratio(FloorOutcome::LostUnderLoad))?;
    let (first, _) = range(ratio(FloorOutcome::HeldThroughZero))?;
    Some(Finding {
        name: "border",
        title: "Attachment of the floor without load",
        text: format!(
            "On the rigid and the intermediate substrate, on cells or in the range of the model, the floor detaches under load up to w/w_c = {} and is attached at zero load from w/w_c = {} on. \
             The threshold of the flat lattice is 1: shells of pillars pin an existing front.",
            short(last),
            short(first)
        ),
        numbers: named([
            ("largest_ratio_lost_under_load", last),
            ("smallest_ratio_held_through_zero", first),
        ]),
    })
}

fn pulls(cases: &Cases) -> Option<Finding> {
    let case = cases.at(Substrate::Intermediate, TYPICAL, RUBBER)?;
    let tops = -1e3 * cases.tops_of(case)?.pull_off?;
    let floor = -1e3 * case.found.pull_off?;
    let smooth = -1e3 * case.found.smooth_pull_off?;
    Some(Finding {
        name: "pull-off",
        title: "Pull-off",
        text: format!(
            "There the pull-off force of the floor is {} mN, {} times the {} mN of the tops alone; treated as smooth (closed form) it is {} mN.",
            short(floor),
            short(floor / tops),
            short(tops),
            short(smooth)
        ),
        numbers: named([
            ("floor_pull_off_mN", floor),
            ("floor_over_tops_pull_off", floor / tops),
            ("tops_pull_off_mN", tops),
            ("smooth_pull_off_mN", smooth),
        ]),
    })
}

fn losses(cases: &Cases) -> Option<Finding> {
    let ratios = cases.floor.iter().filter_map(|case| {
        let tops = cases.tops_of(case)?.hysteresis?;
        let in_range = case.found.unloading_validity == Validity::InRange;
        (in_range && tops > 0.0).then_some(case.found.hysteresis? / tops)
    });
    let (low, high) = range(ratios)?;
    Some(Finding {
        name: "hysteresis",
        title: "Hysteresis",
        text: format!(
            "The hysteresis of an adhesive floor is {} to {} times that of the tops alone, over all cases in range; that of the floor is for unloading from 1.2 ζ_c.",
            short(low),
            short(high)
        ),
        numbers: named([
            ("smallest_ratio_of_hysteresis", low),
            ("largest_ratio_of_hysteresis", high),
        ]),
    })
}

/// Predictions for the experiments of the paper.
fn rubber(scope: &Scope, cases: &Cases) -> Option<Finding> {
    let mut sentences = Vec::new();
    let mut numbers = Vec::new();
    for fraction in &scope.fractions {
        let Some(case) = cases.at(Substrate::Intermediate, *fraction, RUBBER) else {
            continue;
        };
        let found = &case.found;
        let good = found.unloading_validity == Validity::InRange;
        let (Some(jump), true) = (found.jump, good) else {
            sentences.push(format!(
                "φ = {fraction}: out of the range of the fast model"
            ));
            continue;
        };
        let drop = 1.0 - jump.force / found.critical_force;
        let lost = found
            .lost
            .map(|lost| lost.indentation / found.critical_indentation);
        let mut push = |name: &str, value: f64| {
            numbers.push((format!("{name}_at_{fraction}"), value));
            value
        };
        let force = push("rubber_critical_force_mN", 1e3 * found.critical_force);
        let mut text = format!(
            "φ = {fraction}: at {} mN {} holes are filled at once and the force falls by {}",
            short(force),
            jump.holes,
            percent(push("rubber_force_drop", drop))
        );
        push("rubber_holes", jump.holes as f64);
        if let Some(pull) = found.pull_off {
            let pull = push("rubber_pull_off_mN", -1e3 * pull);
            text.push_str(&format!(
                ", on the way back it pulls with up to {} mN",
                short(pull)
            ));
        } else {
            text.push_str(", during unloading it is under compression throughout");
        }
        if let Some(lost) = lost {
            text.push_str(&format!(
                " until the floor detaches at {} ζ_c",
                short(push("rubber_lost_over_critical", lost))
            ));
        }
        sentences.push(text);
    }
    (!numbers.is_empty()).then(|| Finding {
        name: "rubber",
        title: "What experiments with 50 mJ/m² see",
        text: format!(
            "On the intermediate substrate, loaded to 1.2 ζ_c at given displacement: {}.",
            sentences.join("; ")
        ),
        numbers,
    })
}

fn scaling((law, held): &Checked) -> Finding {
    let mut numbers = vec![
        (format!("{}_prefactor", law.reduced.name()), law.prefactor),
        (format!("{}_scatter", law.reduced.name()), law.scatter),
        (format!("{}_largest", law.reduced.name()), law.largest),
        (format!("{}_left_out", law.reduced.name()), law.left_out),
        (format!("{}_cases", law.reduced.name()), law.points as f64),
    ];
    for (group, [exponent, error]) in law.groups.iter().zip(&law.exponents) {
        let stem = format!("{}_exponent_of_{}", law.reduced.name(), group.name());
        numbers.push((stem.clone(), *exponent));
        numbers.push((format!("{stem}_standard_error"), *error));
    }
    let ranges: Vec<String> = law
        .groups
        .iter()
        .zip(&law.ranges)
        .map(|(group, [from, to])| {
            format!("{} from {} to {}", group.name(), short(*from), short(*to))
        })
        .collect();
    for (group, [from, to]) in law.groups.iter().zip(&law.ranges) {
        let stem = format!("{}_range_of_{}", law.reduced.name(), group.name());
        numbers.push((format!("{stem}_from"), *from));
        numbers.push((format!("{stem}_to"), *to));
    }
    let name = law.reduced.name();
    let unit = law.unit();
    let mut text = format!(
        "{} = {}: {} cases scatter about it by {}{unit}, {} at most; of 20 cases of other systems 19 are expected within {}{unit}. Standard errors assume that the residuals \
         are noise, which they are not.",
        law.reduced.plain(),
        law.words(),
        law.points,
        percent(law.scatter),
        percent(law.largest),
        percent(law.band),
    );
    numbers.push((format!("{name}_band"), law.band));
    text.push_str(&format!(" It is fitted to {}.", ranges.join(", ")));
    if law.band > NO_LAW {
        text.push_str(" As some cases deviate that much, it is a trend, not a law.");
    }
    if let Some(held) = held {
        text.push_str(&format!(
            " Of {} systems with other lenses, pillars and moduli {} are within that; they are {}{unit} from it, {} at most.",
            held.points,
            held.in_band,
            percent(held.scatter),
            percent(held.largest)
        ));
        numbers.push((format!("{name}_held_out_scatter"), held.scatter));
        numbers.push((format!("{name}_held_out_largest"), held.largest));
        numbers.push((format!("{name}_held_out_cases"), held.points as f64));
        numbers.push((format!("{name}_held_out_in_band"), held.in_band as f64));
    }
    Finding {
        name: match law.reduced {
            Reduced::Withdrawal => "law-withdrawal",
            Reduced::Area => "law-area",
            Reduced::Drop => "law-force-drop",
            Reduced::PullOff => "law-pull-off",
            Reduced::Hysteresis => "law-hysteresis",
        },
        title: match law.reduced {
            Reduced::Withdrawal => "Law of the loss of the floor",
            Reduced::Area => "Law of the area after the jump",
            Reduced::Drop => "Law of the fall of the force",
            Reduced::PullOff => "Law of the pull-off",
            Reduced::Hysteresis => "Law of the hysteresis",
        },
        text,
        numbers,
    }
}

/// Differences between cases that differ only in the offset.
fn offsets(cases: &Cases) -> Option<Finding> {
    let largest = |of: Reduced| {
        let pairs = cases.floor.iter().filter(|case| case.offset > 0.0);
        let pairs = pairs.filter_map(|case| {
            let other = cases.floor.iter().find(|other| {
                other.offset.abs() < 1e-12
                    && same(other.young_modulus, case.young_modulus)
                    && same(other.found.surface_fraction, case.found.surface_fraction)
                    && same(other.found.work, case.found.work)
            })?;
            Some((of.of(case)? / of.of(other)?).ln().abs().exp_m1())
        });
        range(pairs).map(|(_, high)| high)
    };
    let (back, area) = (largest(Reduced::Withdrawal)?, largest(Reduced::Area)?);
    Some(Finding {
        name: "offset",
        title: "Where the lens lands",
        text: format!(
            "With the axis 0.3 pitches beside a pillar instead of on it, the withdrawal until the floor detaches changes by {} at most and the area after the jump by {}, over all cases in range.",
            percent(back),
            percent(area)
        ),
        numbers: named([
            ("largest_change_of_withdrawal_by_offset", back),
            ("largest_change_of_area_by_offset", area),
        ]),
    })
}

/// Exponents of height and diameter between their first and last values; other parameters are as in
/// the paper.
fn sizes(scope: &Scope, cases: &Cases) -> Option<Finding> {
    let (middle_height, middle_diameter) = (
        scope.heights.get(scope.heights.len() / 2)?,
        scope.diameters.get(scope.diameters.len() / 2)?,
    );
    let exponent = |by_height: bool, of: &dyn Fn(&FloorCase) -> Option<f64>| {
        let mut found = Vec::new();
        for fraction in &scope.sized_fractions {
            for work in &scope.sized_works {
                let at = |size: f64| {
                    let (height, diameter) = if by_height {
                        (size, *middle_diameter)
                    } else {
                        (*middle_height, size)
                    };
                    cases.sizes.iter().find(|case| {
                        same(case.height, height)
                            && same(case.diameter, diameter)
                            && same(case.found.surface_fraction, *fraction)
                            && same(case.found.work, *work)
                            && case.found.unloading_validity == Validity::InRange
                    })
                };
                let sizes = if by_height {
                    &scope.heights
                } else {
                    &scope.diameters
                };
                let [first, last] = [*sizes.first()?, *sizes.last()?];
                if let (Some(first_case), Some(last_case)) = (at(first), at(last))
                    && let (Some(low), Some(high)) = (of(first_case), of(last_case))
                {
                    found.push((high / low).ln() / (last / first).ln());
                }
            }
        }
        range(found.into_iter())
    };
    let back = |case: &FloorCase| Reduced::Withdrawal.of(case);
    let lost = |case: &FloorCase| case.found.hysteresis;
    let (height, diameter) = (exponent(true, &back)?, exponent(false, &back)?);
    let (lost_height, lost_diameter) = (exponent(true, &lost)?, exponent(false, &lost)?);
    Some(Finding {
        name: "sizes",
        title: "Height and diameter of the pillars",
        text: format!(
            "At the same surface fraction and work of adhesion, on the intermediate substrate: 1 - ζ_lost/ζ_c is a power of the height with exponents from {} to {} and of the diameter with exponents from {} to {}; for the hysteresis they are \
             from {} to {} and from {} to {}.",
            short(height.0),
            short(height.1),
            short(diameter.0),
            short(diameter.1),
            short(lost_height.0),
            short(lost_height.1),
            short(lost_diameter.0),
            short(lost_diameter.1),
        ),
        numbers: named([
            ("withdrawal_by_height_from", height.0),
            ("withdrawal_by_height_to", height.1),
            ("withdrawal_by_diameter_from", diameter.0),
            ("withdrawal_by_diameter_to", diameter.1),
            ("hysteresis_by_height_from", lost_height.0),
            ("hysteresis_by_height_to", lost_height.1),
            ("hysteresis_by_diameter_from", lost_diameter.0),
            ("hysteresis_by_diameter_to", lost_diameter.1),
        ]),
    })
}
