//! Common parts of the reports of contact states.

use super::table::list;
use crate::numbers::{DIGITS, LENGTH_DIGITS, digits, scaled, seconds, significant, with_unit};
use crate::record::{GradientObject, MayReachFloor, Record, interactions};
use fakir::Difference;
use fakir::problem::{
    Adhesion, Arrangement, Base, Disorder, FlatSystem, Layer, LensShape, LoadingMode, Method,
    ShapedLens, System,
};
use fakir::state::{ContactState, ErrorEstimate, FloorErrors, Limit, Normalized};
use fakir_case::unit::{Dimension, format_quantity};
use std::f64::consts::PI;
use std::fmt::Write;

/// Largest number of digits of contact radii.
const RADIUS_DIGITS: usize = 5;

/// Significant digits of a contact radius with this relative error.
pub fn radius_digits(relative_error: f64) -> usize {
    digits(relative_error).min(RADIUS_DIGITS)
}

/// A text followed by derivatives, if there are any.
pub(crate) fn with_derivatives(text: String, gradient: Option<&GradientObject>) -> String {
    match gradient {
        Some(gradient) => format!("{text}\n\n{}", gradient.text()),
        None => text,
    }
}

/// Description of the pattern in one line: `surface fraction 0.1, pitch 18.0692 um, lens axis on a pillar`.
pub fn pillar_pattern_line(system: &System) -> String {
    let fraction = surface_fraction(system.pattern().surface_fraction());
    let pitch = with_unit(system.pitch(), Dimension::Length, DIGITS);
    let line = match system.arrangement() {
        Arrangement::Hexagonal(lattice) => format!(
            "surface fraction {fraction}, pitch {pitch}, {}",
            axis(lattice.offset, lattice.offset_angle)
        ),
        Arrangement::Lattice(lattice) => {
            let mut line = format!(
                "{} lattice, surface fraction {fraction}, pitch {pitch}, {}",
                lattice.form.name(),
                axis(lattice.offset, lattice.offset_angle)
            );
            if lattice.rotation != 0.0 {
                let _ = write!(
                    line,
                    ", turned by {} deg",
                    plain(lattice.rotation.to_degrees())
                );
            }
            if let Some(columns) = lattice.columns {
                let _ = write!(line, ", {columns} by {columns} pillars");
            }
            let disorder = lattice.disorder;
            let Disorder { heights, missing } = disorder;
            if !heights.is_none() {
                let percent = plain(100.0 * heights.parameter);
                let _ = write!(line, ", heights spread by {percent} %");
            }
            if missing > 0.0 {
                let _ = write!(line, ", {} % missing", plain(100.0 * missing));
            }
            if !disorder.is_none() {
                let _ = write!(line, " (seed {})", heights.seed);
            }
            line
        }
        Arrangement::Listed(list) => format!(
            "{} listed pillars, surface fraction {fraction}, mean distance {pitch}",
            list.pillars().len()
        ),
        other => format!("{} pillars, surface fraction {fraction}", other.name()),
    };
    let layers = layers_part([system.substrate_layer(), system.lens_layer()]);
    format!("{line}{}{layers}", lens_part(system))
}

/// Description of bodies that are not half-spaces: `, on a film 200 um thick; indentations are the approach of the backs`.
pub(super) fn layers_part([substrate, lens]: [Option<&Layer>; 2]) -> String {
    let thickness = |layer: &Layer| {
        let base = match layer.base {
            Base::Frictionless => ", free to slide on its base",
            Base::Elastic(_) => ", on an elastic base",
            _ => "",
        };
        format!(
            "{}{base}",
            with_unit(layer.thickness, Dimension::Length, DIGITS)
        )
    };
    let mut line = String::new();
    if let Some(layer) = lens {
        let _ = write!(line, ", under a layer of thickness {}", thickness(layer));
    }
    if let Some(layer) = substrate {
        let _ = write!(line, ", on a film of thickness {}", thickness(layer));
    }
    if !line.is_empty() {
        line.push_str("; the indentation is the approach of the backs");
    }
    line
}

/// Description of a lens that is not a sphere: `, under a cylinder of radius 2.2 mm`.
fn lens_part(system: &System) -> String {
    let length = |value: f64| with_unit(value, Dimension::Length, DIGITS);
    let degrees = |angle: f64| plain(angle.to_degrees());
    match &system.lens().shape {
        LensShape::Sphere { .. } => String::new(),
        LensShape::Paraboloid { radius } => {
            format!(", under a paraboloid of radius {}", length(*radius))
        }
        LensShape::Cylinder { radius, angle } => format!(
            ", under a cylinder of radius {} along {} deg from x",
            length(*radius),
            degrees(*angle)
        ),
        LensShape::Plate { tilt, .. } if *tilt == 0.0 => ", under a plate".to_owned(),
        LensShape::Plate { tilt, direction } => format!(
            ", under a plate that rises by {} deg towards {} deg from x",
            degrees(*tilt),
            degrees(*direction)
        ),
        LensShape::Punch { radius } => format!(", under a punch of radius {}", length(*radius)),
        LensShape::Profile(profile) => format!(
            ", under a lens of {} rows up to {}",
            profile.radii().len(),
            length(profile.range())
        ),
        _ => format!(", under a {}", system.lens().shape_name()),
    }
}

/// Position of the lens axis, for an offset in pitches and its direction in rad.
fn axis(offset: f64, angle: f64) -> String {
    if offset == 0.0 {
        return "lens axis on a pillar".to_owned();
    }
    let angle = angle.to_degrees();
    let direction = if angle == 0.0 {
        "along x".to_owned()
    } else {
        format!("at {} deg from x", plain(angle))
    };
    format!(
        "lens axis {} pitches from a pillar, {direction}",
        plain(offset)
    )
}

/// A number with at most six digits, without trailing zeros.
fn plain(value: f64) -> String {
    let rounded: f64 = format!("{value:.*e}", DIGITS - 1).parse().unwrap_or(value);
    rounded.to_string()
}

/// A surface fraction; that of touching pillars is rounded down, because a larger one is refused in a case file.
fn surface_fraction(value: f64) -> String {
    const UNIT: f64 = 1e-6;
    let touching = PI / (2.0 * 3f64.sqrt());
    let rounded_up = value <= touching && plain(value).parse().is_ok_and(|it: f64| it > touching);
    if rounded_up {
        plain((value / UNIT).floor() * UNIT)
    } else {
        plain(value)
    }
}

/// Description of a work of adhesion.
pub(crate) fn adhesion_words(adhesion: Adhesion) -> String {
    let words = |work| format_quantity(work, Dimension::EnergyPerArea);
    let receding = adhesion
        .work_receding
        .map(|work| format!(" ({} to part)", words(work)));
    let floor = if adhesion.floor {
        ", of the floor too"
    } else {
        ""
    };
    format!(
        "work of adhesion {}{}{floor}",
        words(adhesion.work),
        receding.unwrap_or_default()
    )
}

/// Description of the quantity that is prescribed during a cycle.
pub(crate) fn drive_words(drive: LoadingMode) -> String {
    match drive {
        LoadingMode::Displacement => "under a prescribed indentation".to_owned(),
        LoadingMode::Force => "under a prescribed force".to_owned(),
        LoadingMode::Machine(stiffness) => format!(
            "by a machine of {}",
            format_quantity(stiffness, Dimension::Stiffness)
        ),
    }
}

/// Description of the shape of a lens.
pub(crate) fn shape_words(lens: &ShapedLens) -> String {
    let length = |value| with_unit(value, Dimension::Length, LENGTH_DIGITS);
    match &lens.shape {
        LensShape::Plate { tilt, .. } => {
            format!(
                "plate tilted by {}",
                with_unit(*tilt, Dimension::Angle, LENGTH_DIGITS)
            )
        }
        LensShape::Punch { radius } => format!("flat punch of radius {}", length(*radius)),
        _ => match lens.radius() {
            Some(radius) => format!("{} of radius {}", lens.shape_name(), length(radius)),
            None => "lens with a table of heights".to_owned(),
        },
    }
}

/// Description of the lens or punch on a flat surface, and of its layers.
pub(crate) fn lens_words(system: &FlatSystem) -> String {
    let length = |value| with_unit(value, Dimension::Length, LENGTH_DIGITS);
    let mut words = shape_words(system.lens());
    let names = ["substrate", "lens"];
    for (name, layer) in names.into_iter().zip(system.layers()) {
        if let Some(layer) = layer {
            words += &format!(", {name} {} thick", length(layer.thickness));
        }
    }
    words
}

/// Kind of a row of a loading.
pub(crate) fn loading_remark(converged: bool, critical: bool, beyond: bool) -> &'static str {
    match (converged, critical, beyond) {
        (false, ..) => "no answer",
        (_, true, _) => "critical",
        (_, _, true) => "past it",
        _ => "",
    }
}

/// Location of a critical state beyond the end of a loading.
pub(crate) fn further_on(indentation: f64, force: f64) -> String {
    format!(
        "\nThe critical state is further on, at an indentation of {} and a force of {}.\n",
        with_unit(indentation, Dimension::Length, DIGITS),
        with_unit(force, Dimension::Force, DIGITS)
    )
}

/// Description of the difference of two answers; empty for the prescribed quantity.
pub fn difference(name: &str, difference: Difference) -> String {
    if difference.allowed == 0.0 || difference.is_of_rounding() {
        return String::new();
    }
    format!(
        "Difference in {name}: {:.1e}, allowed {:.1e}\n",
        difference.relative.abs(),
        difference.allowed
    )
}

/// Warnings if the range of the attraction is too large for the short-range assumption.
pub(crate) fn range_warnings(limits: &[Limit]) -> Vec<String> {
    let exceeded = limits.iter().filter(|limit| limit.strained);
    exceeded
        .filter(|limit| limit.name == RANGE)
        .filter_map(|limit| {
            Some(format!(
                "the range of the attraction is too large for the model, the JKR limit (Tabor number {} below {}): \
                 pull-off is more gradual than computed",
                significant(limit.value, 2),
                limit.threshold?
            ))
        })
        .chain(limits.iter().filter(|it| it.name == UNRESOLVED && it.strained).map(|limit| {
            format!(
                "{} % of the summits in contact are as narrow as a cell: whether the range of the attraction is small there cannot be judged",
                significant(100.0 * limit.value, 2)
            )
        }))
        .collect()
}

/// Description of a validity limit.
fn limit_words(name: &'static str) -> &'static str {
    match name {
        "kendall_strain" => "strain of pillars at pull-off",
        "slope" => "slope of the lens",
        "contact_on_top" => "contact over radius of a top",
        "contact_radius_over_lens_radius" => "contact over lens radius",
        "contact_radius_over_lens_thickness" => "contact over lens thickness",
        "lens_table_error_over_indentation" => "error of the table of the lens over indentation",
        "lens_thickness_over_radius" => "lens thickness over radius",
        "indentation_over_thickness" => "indentation over thickness",
        "thickness_over_diameter" => "thickness over diameter",
        "pillar_stress" | "contact_stress" => "stress over modulus",
        "surface_slope" => "slope of the surface",
        CELLS => "cells in contact",
        "buckling" => "force over buckling load",
        "pillar_compliance" => "error of the columns",
        ELASTIC_ERROR => "error of the pillars",
        RANGE => "Tabor number",
        UNRESOLVED => "fraction of unresolved summits",
        other => other,
    }
}

/// The value of a limit with the smallest number of digits, at least `digits`, for which it is on the correct side of the threshold.
fn limit_value(limit: &Limit, digits: usize) -> String {
    if limit.name == CELLS {
        return limit.value.to_string();
    }
    let side = |value: f64| limit.threshold.map(|threshold| value.total_cmp(&threshold));
    let mut written = (digits..=17).map(|digits| significant(limit.value, digits));
    let shown = written.find(|text| text.parse().ok().and_then(side) == side(limit.value));
    shown.unwrap_or_else(|| significant(limit.value, digits))
}

/// Descriptions of the limits that are exceeded.
pub fn exceeded_limits(limits: &[Limit]) -> Vec<String> {
    let exceeded = limits.iter().filter(|limit| limit.strained);
    let words = exceeded.filter_map(|limit| {
        Some(format!(
            "{}: {}, where the model is doubtful {}",
            limit_words(limit.name),
            limit_value(limit, 3),
            match limit.threshold? {
                threshold if limit.value < threshold => format!("below {threshold}"),
                threshold => format!("from {threshold} on"),
            }
        ))
    });
    words.collect()
}

/// Model error of elastic pillars.
const ELASTIC_ERROR: &str = "elastic_pillar_error";

/// The limit that is a number of cells.
const CELLS: &str = "cells_in_contact";

/// The limit that depends on the range of the attraction.
const RANGE: &str = "tabor_number";

/// The smallest of several such numbers, the number of summits that they are of, and the fraction without a number.
const SMALLEST: &str = "smallest_tabor_number";
const SUMMITS: &str = "summits_in_contact";
const UNRESOLVED: &str = "unresolved_summits";

/// A list of the quantities of a state, built row by row.
#[derive(Debug, Default)]
pub struct QuantityList(Vec<[String; 4]>);

impl QuantityList {
    /// A quantity with a unit.
    pub fn quantity(
        &mut self,
        name: &str,
        value: f64,
        dimension: Dimension,
        digits: usize,
        remark: String,
    ) -> &mut Self {
        let (number, unit) = scaled(value, dimension, digits);
        self.0
            .push([name.to_owned(), number, unit.to_owned(), remark]);
        self
    }

    /// Force and indentation, each with its relative error.
    pub(crate) fn force_and_indentation(&mut self, rows: [[f64; 2]; 2]) -> &mut Self {
        let names = [
            ("force", Dimension::Force),
            ("indentation", Dimension::Length),
        ];
        for ((name, dimension), [value, error]) in names.into_iter().zip(rows) {
            self.quantity(name, value, dimension, digits(error), remark(error));
        }
        self
    }

    /// A state of a cycle: its force with a remark, and its indentation.
    pub(crate) fn state(
        &mut self,
        name: &str,
        [force, error]: [f64; 2],
        indentation: f64,
        remark: String,
    ) -> &mut Self {
        self.quantity(name, force, Dimension::Force, digits(error), remark)
            .length("  at an indentation of", indentation, String::new())
    }

    /// A contact radius, with the digits that its relative error leaves.
    pub fn radius(&mut self, name: &str, value: f64, error: f64, remark: String) -> &mut Self {
        let estimate = error_remark(error);
        let remark = if remark.is_empty() {
            alone(&estimate)
        } else {
            remark + &estimate
        };
        self.quantity(name, value, Dimension::Length, radius_digits(error), remark)
    }

    /// A length without an error estimate.
    pub fn length(&mut self, name: &str, value: f64, remark: String) -> &mut Self {
        self.quantity(name, value, Dimension::Length, LENGTH_DIGITS, remark)
    }

    /// Adds a row of any other kind.
    pub fn row(&mut self, name: &str, value: String, unit: &str, remark: &str) -> &mut Self {
        self.0
            .push([name.to_owned(), value, unit.to_owned(), remark.to_owned()]);
        self
    }

    /// Force and indentation, with the digits that their errors leave.
    pub fn load(&mut self, state: &ContactState, reduced: &Normalized) -> &mut Self {
        let remark = |name: &str, value, error: f64| {
            let estimate = error_remark(error);
            format!("{name} = {}{estimate}", significant(value, digits(error)))
        };
        let ErrorEstimate { force, indentation } = state.error;
        self.quantity(
            "force",
            state.force,
            Dimension::Force,
            digits(force),
            remark("F gamma_int/(h d)", reduced.force, force),
        )
        .quantity(
            "indentation",
            state.indentation,
            Dimension::Length,
            digits(indentation),
            remark("zeta/h", reduced.indentation, indentation),
        )
    }

    /// The load of the floor, if it is touched.
    pub fn floor(&mut self, state: &impl MayReachFloor) -> &mut Self {
        let Some(floor) = state.on_floor() else {
            return self;
        };
        let FloorErrors { force, share, area } = floor.error;
        let known = |error| digits(error).min(DIGITS);
        let remark = |error| alone(&error_remark(error));
        // The error of the fraction is that of the force, unless the floor pulls with more than the load.
        let of_share = match share > 2.0 * force {
            true => remark(share),
            false => String::new(),
        };
        let [x, y] = floor.cell();
        let cells = format!(
            "on cells of {} by {}",
            with_unit(x, Dimension::Length, 3),
            with_unit(y, Dimension::Length, 3)
        );
        self.quantity(
            "force on the floor",
            floor.force,
            Dimension::Force,
            known(force),
            remark(force),
        )
        .row(
            "fraction on the floor",
            significant(floor.share, known(share)),
            "",
            &of_share,
        )
        .area(
            "contact area on the floor",
            floor.area,
            known(area),
            &remark(area),
        )
        .length("radius of the floor contact", floor.radius, cells)
        .length(
            "its distance from a rim",
            floor.smallest_distance_to_rim,
            String::new(),
        );
        if floor.patches_agree {
            self.row("patches on the floor", floor.patches.to_string(), "", "");
        }
        self
    }

    /// Validity limits of a contact with adhesion.
    pub fn limits(&mut self, limits: &[Limit]) -> &mut Self {
        for limit in limits {
            let name = limit_words(limit.name);
            let Some(threshold) = limit.threshold else {
                continue;
            };
            let remark = match (limit.name, limit.strained) {
                (RANGE, false) => {
                    format!("above {threshold}: the range is small enough (JKR limit)")
                }
                (RANGE, true) => {
                    format!("below {threshold}: the range is too large (JKR limit)")
                }
                // Limits with a lower threshold.
                (_, true) if limit.value < threshold => {
                    format!("below {threshold}, where the model is doubtful")
                }
                (_, false) if limit.value > threshold => format!("above {threshold}"),
                (_, true) => format!("beyond {threshold}, where the model is doubtful"),
                (_, false) => format!("below {threshold}, where the model is doubtful"),
            };
            let digits = if limit.strained { 3 } else { 2 };
            self.row(name, limit_value(limit, digits), "", &remark);
        }
        self
    }

    /// Whether a contact is within the limits of the model: the closest limit, or those that are exceeded.
    pub fn model(&mut self, limits: &[Limit]) -> &mut Self {
        if let Some(error) = limits.iter().find(|limit| limit.name == ELASTIC_ERROR) {
            let remark = "of the model, the largest found beside finite elements";
            self.row(
                limit_words(error.name),
                significant(error.value, 2),
                "",
                remark,
            );
        }
        let exceeded: Vec<Limit> = limits.iter().filter(|l| l.strained).copied().collect();
        if !exceeded.is_empty() {
            let of = limits.iter().filter(|l| l.threshold.is_some()).count();
            let count = format!("{} of {of}", exceeded.len());
            self.row("limits of the model", count, "", "exceeded:");
            return self.limits(&exceeded);
        }
        let with_nearness = limits.iter().filter_map(|l| Some((l, l.nearness()?)));
        let nearest = with_nearness.max_by(|(_, one), (_, other)| one.total_cmp(other));
        if let Some((limit, _)) = nearest {
            let threshold = limit.threshold.unwrap_or(f64::NAN);
            let side = if limit.value > threshold {
                "below"
            } else {
                "from"
            };
            let remark = format!(
                "nearest: {} {}, doubtful {side} {threshold}",
                limit_words(limit.name),
                limit_value(limit, 2),
            );
            self.row("limits of the model", "kept".to_owned(), "", &remark);
        }
        self
    }

    /// The limit that depends on the range of the attraction, if the range is given.
    pub fn range(&mut self, limits: &[Limit]) -> &mut Self {
        let of_range = limits.iter().filter(|limit| limit.name == RANGE);
        self.limits(&of_range.copied().collect::<Vec<Limit>>())
            .summits(limits)
    }

    /// The summits of a height map whose largest Tabor number is that of the contact, and what it assumes.
    pub(crate) fn summits(&mut self, limits: &[Limit]) -> &mut Self {
        let value = |name: &str| {
            let found = limits.iter().find(|limit| limit.name == name);
            found.map(|limit| limit.value)
        };
        let (Some(summits), Some(part)) = (value(SUMMITS), value(UNRESOLVED)) else {
            return self;
        };
        let numbers = value(SMALLEST).map(|least| {
            format!(
                "Tabor numbers from {} to that above, if the cells resolve a summit: its curvature is that of 3 x 3 of them; ",
                significant(least, 2)
            )
        });
        let narrow = format!(
            "{} as narrow as a cell, without one",
            (part * summits).round()
        );
        let remark = numbers.unwrap_or_default() + &narrow;
        self.row("summits in contact", summits.to_string(), "", &remark)
    }

    /// Work of separation and hysteresis (J) of a cycle, as far as they are known; `error` is the relative error of the second one.
    pub(crate) fn works(
        &mut self,
        separation: Option<f64>,
        hysteresis: Option<f64>,
        error: f64,
    ) -> &mut Self {
        let known = digits(error);
        if let Some(work) = separation {
            self.row("work of separation", significant(work, known), "J", "");
        }
        if let Some(area) = hysteresis {
            self.row("hysteresis", significant(area, known), "J", &remark(error));
        }
        self
    }

    /// An area, in the square of the unit that suits its root.
    pub fn area(&mut self, name: &str, area: f64, digits: usize, remark: &str) -> &mut Self {
        let unit = Dimension::Length.unit_for(area.sqrt());
        let (size, symbol) = unit.map_or((1.0, "m"), |unit| (unit.in_si(), unit.symbol));
        self.row(
            name,
            significant(area / (size * size), digits),
            &format!("{symbol}^2"),
            remark,
        )
    }

    /// What interactions add to an answer.
    pub(crate) fn interactions(&mut self, record: &Record) -> &mut Self {
        for line in interactions::lines(record) {
            let known = line.relative_error.map_or(LENGTH_DIGITS, digits);
            let error = line.relative_error.map_or(String::new(), error_remark);
            let remark = alone(&(line.remark + &error));
            match (line.value, line.dimension) {
                (None, _) => self.row(line.name, "-".to_owned(), "", &remark),
                (Some(area), None) => self.area(line.name, area, known, &remark),
                (Some(value), Some(dimension)) => {
                    self.quantity(line.name, value, dimension, known, remark)
                }
            };
        }
        self
    }

    /// Number of pillars in contact.
    pub fn pillars(&mut self, state: &ContactState) -> &mut Self {
        let remark = match state.method {
            Method::Homogenised => "by lattice cells in the contact circle".to_owned(),
            _ => format!("{} of them partially", state.pillars_partially_in_contact),
        };
        self.row(
            "pillars in contact",
            state.pillars_in_contact.to_string(),
            "",
            &remark,
        );
        if let Some(largest) = largest_pillar_force(state) {
            self.quantity(
                "largest force on a pillar",
                largest,
                Dimension::Force,
                digits(state.error.force).min(5),
                String::new(),
            );
        }
        self
    }

    /// Adds the number of steps, the convergence status and the computing time.
    pub fn solution(&mut self, state: &ContactState, wall_time: f64) -> &mut Self {
        let outcome = match state.method {
            Method::Homogenised | Method::Love(_) => "iterations",
            _ => "Newton steps",
        };
        self.row(
            outcome,
            state.iterations.to_string(),
            "",
            &format!(
                "{}, in {}",
                state.termination.description(),
                seconds(wall_time)
            ),
        )
    }

    /// The list as text.
    #[must_use]
    pub fn text(self) -> String {
        list(self.0)
    }
}

fn largest_pillar_force(state: &ContactState) -> Option<f64> {
    state
        .pillars
        .iter()
        .map(|pillar| pillar.force)
        .max_by(f64::total_cmp)
}

/// An estimated error as the end of a remark; empty if there is none.
#[must_use]
pub fn error_remark(error: f64) -> String {
    if error > 0.0 {
        format!(", estimated error {}", significant(error, 1))
    } else {
        String::new()
    }
}

/// The same as a separate remark.
pub(crate) fn remark(error: f64) -> String {
    alone(&error_remark(error))
}

/// The end of a remark as a separate remark, without the leading comma.
pub(crate) fn alone(remark: &str) -> String {
    remark.trim_start_matches([',', ' ']).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A value rounded to its threshold would be exceeded and satisfied with the same digits.
    #[test]
    fn limits_are_shown_on_their_side_of_the_threshold() {
        for (value, shown) in [
            (0.3004, "0.3004"),
            (0.299_96, "0.29996"),
            (0.3, "0.30"),
            (0.42, "0.42"),
            (1.234e-5, "1.2e-5"),
        ] {
            let limit = Limit {
                name: "slope",
                value,
                threshold: Some(0.3),
                strained: value > 0.3,
            };
            assert_eq!(limit_value(&limit, 2), shown);
        }
    }
}
