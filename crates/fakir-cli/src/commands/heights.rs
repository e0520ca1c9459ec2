//! `fakir design --free heights`: heights of rounded pillar tops for a target curve.

use crate::arguments::HeightsQuestion;
use crate::commands::design::Designed;
use crate::failure::Failure;
use crate::numbers::{LENGTH_DIGITS, seconds, significant, with_unit};
use crate::session::Session;
use fakir::state::Solution;
use fakir_case::CaseFile;
use fakir_case::unit::Dimension;
use fakir_figure::{DesignedCurve, DesignedQuantity, DesignedValues, asperity_map, designed_curve};
use fakir_inverse::HeightsSummary;
use fakir_inverse::heights::{DesignedPoint, HeightDesignError};
use fakir_inverse::pillar_heights::{PillarHeights, PillarHeightsError, design_pillars};
use fakir_inverse::target::Target;
use fakir_study::citations::Topic;
use fakir_study::figures::saved;
use fakir_study::output::File;
use fakir_study::provenance::Provenance;
use fakir_study::record::AsperityAnswer;
use fakir_study::report::Report;
use fakir_study::report::asperities::{case_line, method_line};
use fakir_study::report::state::QuantityList;
use fakir_study::report::table::{Column, table};
use fakir_study::result::{asperity_warnings, control_words, json};
use fakir_study::workshop::Relief;
use std::time::Instant;

/// The table of pillars that was designed, which the saved case names.
const PILLARS: &str = "pillars.csv";

pub(crate) fn run(
    file: &CaseFile,
    question: &HeightsQuestion<'_>,
    session: &Session,
) -> Result<Designed, Failure> {
    let case = file.asperity_case()?;
    let target = Target::read(question.target)?;
    let start = Instant::now();
    session.part("heights");
    let found = design_pillars(
        &case,
        target.curve,
        &target.points,
        question.seed,
        &session.run(),
    );
    let found = found.map_err(|error| located(error, &target))?;
    let wall_time = start.elapsed().as_secs_f64();
    let case = &found.case;
    let mut warnings = asperity_warnings(AsperityAnswer::of(case, &found.last));
    warnings.extend(unresolved_before_last(&found));
    if let Some(error) = question.height_error {
        warnings.extend(large_scatter(&found, error));
    }
    let provenance = Provenance::new(
        format!(
            "heights for a target {}, seed {}",
            found.curve.words(),
            question.seed
        ),
        method_line(case.accuracy),
        &[Topic::Asperities, Topic::DesignedHeights],
        case.to_toml_with_table(PILLARS),
    );
    let tables = session.files(|| files(&found, question.height_error, &provenance));
    let report = Report {
        json: json(&HeightsSummary::new(
            &found,
            question.seed,
            question.height_error,
            wall_time,
        )),
        text: text(&found, question.height_error, wall_time),
        provenance,
        tables,
        warnings,
        converged: found.is_answer(),
        exceeded: Vec::new(),
    };
    Ok(Designed {
        report,
        found: found.design.is_reached(),
    })
}

/// Why the heights are no answer, if that is so under another load than the largest, of which [`asperity_warnings`] are.
fn unresolved_before_last(found: &PillarHeights) -> Option<String> {
    let (load, unresolved) = found.unresolved?;
    let largest = found.design.points.last()?.wanted.load;
    let words = control_words(found.curve.control(load));
    (load < largest).then(|| format!("{words}: {unresolved}"))
}

/// The failure, at its line of the target curve if it is one of its points.
fn located(error: PillarHeightsError, target: &Target) -> Failure {
    use HeightDesignError as E;
    let number = match &error {
        PillarHeightsError::Heights(
            E::WantedPoint { number, .. }
            | E::Falls { number, .. }
            | E::AreaOutOfReach { number, .. },
        ) => *number,
        _ => return error.into(),
    };
    let at = target.at_point(number, error.to_string());
    match error {
        PillarHeightsError::Heights(E::AreaOutOfReach { .. }) => Failure::OutOfReach(at),
        _ => at.into(),
    }
}

/// Warning if errors of the heights are as large as contacts are deep: the scatter of values is then larger or smaller than computed from the derivatives.
fn large_scatter(found: &PillarHeights, height_error: f64) -> Option<String> {
    let asperities = found
        .case
        .field
        .asperities()
        .iter()
        .zip(&found.last.asperities);
    // The overlap of a contact by Hertz is the square of its radius over that of curvature.
    let depths =
        asperities.map(|(asperity, state)| state.radius * state.radius / asperity.top_radius);
    let deepest = depths.fold(0.0, f64::max);
    (height_error > 0.1 * deepest).then(|| {
        format!(
            "errors of heights of {} are no small part of the deepest contact, {}: the scatter, by derivatives, is only its size",
            with_unit(height_error, Dimension::Length, LENGTH_DIGITS),
            with_unit(deepest, Dimension::Length, LENGTH_DIGITS)
        )
    })
}

fn files(found: &PillarHeights, height_error: Option<f64>, provenance: &Provenance) -> Vec<File> {
    let case = &found.case;
    let relief = Relief::new(&case.field, case.height);
    let mut files = vec![
        File::new(PILLARS, case.pillar_table()),
        File::new("curve.csv", found.table(height_error).to_csv()),
        File::new("surface.stl", relief.stl()),
    ];
    if let Some(picture) = relief.picture() {
        files.push(File::new("heights.png", picture.png()));
        files.push(File::new("heights.npy", picture.npy()));
    }
    let quantity = |name: &str| match name {
        "force" => DesignedQuantity::Force,
        "indentation" => DesignedQuantity::Indentation,
        _ => DesignedQuantity::Area,
    };
    let points = found.design.points.iter().map(|point| DesignedValues {
        load: point.wanted.load,
        wanted: point.wanted.value,
        designed: point.value,
        scatter: height_error.map(|error| point.scatter(error) * point.value),
        ignored: point.of_independent_design,
    });
    let curve = DesignedCurve {
        load: quantity(found.curve.load_name()),
        value: quantity(found.curve.value_name()),
        points: points.collect(),
    };
    files.extend(saved(designed_curve(&curve), provenance));
    files.extend(saved(asperity_map(&case.field, &found.last), provenance));
    files
}

/// A load of the report.
struct Row {
    load: String,
    wanted: String,
    off: String,
    ignored: String,
    pillars: String,
    scatter: String,
}

fn text(found: &PillarHeights, height_error: Option<f64>, wall_time: f64) -> String {
    let points = &found.design.points;
    let loads = Scale::of(
        found.curve.load_name(),
        points.iter().map(|point| point.wanted.load),
    );
    let values = Scale::of(
        found.curve.value_name(),
        points.iter().map(|point| point.wanted.value),
    );
    let row = |point: &DesignedPoint| Row {
        load: loads.number(point.wanted.load),
        wanted: values.number(point.wanted.value),
        off: percentage(point.residual()),
        ignored: percentage(point.of_independent_design / point.wanted.value - 1.0),
        pillars: point.touched.to_string(),
        scatter: height_error.map_or_else(String::new, |error| {
            significant(100.0 * point.scatter(error), 3)
        }),
    };
    let rows: Vec<Row> = points.iter().map(row).collect();
    let mut columns = vec![
        Column::right(&loads.heading(""), |row: &Row| row.load.clone()),
        Column::right(&values.heading("target "), |row: &Row| row.wanted.clone()),
        Column::right("off by (%)", |row: &Row| row.off.clone()),
        Column::right("interactions ignored (%)", |row: &Row| row.ignored.clone()),
        Column::right("pillars", |row: &Row| row.pillars.clone()),
    ];
    if height_error.is_some() {
        columns.push(Column::right("scatter (%)", |row: &Row| {
            row.scatter.clone()
        }));
    }
    let [lowest, highest] = found.range();
    let mut list = QuantityList::default();
    list.length("lowest pillar", lowest, String::new()).length(
        "highest pillar",
        highest,
        String::new(),
    );
    if let Some(error) = height_error {
        list.length(
            "error of heights",
            error,
            "standard deviation, independent from pillar to pillar".to_owned(),
        );
    }
    let known = found.relative_error.map_or_else(
        || "no error estimate".to_owned(),
        |error| {
            format!(
                "estimated relative error of the values {}",
                significant(error, 2)
            )
        },
    );
    list.row(
        "rounds",
        found.design.rounds.to_string(),
        "",
        &format!("of least squares; {known}, in {}", seconds(wall_time)),
    );
    format!(
        "{}\n{}\n{}\n\n{}\n{}",
        found.statement(),
        case_line(&found.case),
        method_line(found.case.accuracy),
        table(&rows, &columns),
        list.text()
    )
}

/// How a column of quantities is shown.
struct Scale {
    name: &'static str,
    size: f64,
    unit: String,
}

impl Scale {
    fn of(name: &'static str, values: impl Iterator<Item = f64>) -> Self {
        let largest = values.fold(0.0, f64::max);
        let (dimension, size) = match name {
            "force" => (Dimension::Force, largest),
            "indentation" => (Dimension::Length, largest),
            _ => (Dimension::Length, largest.sqrt()),
        };
        let unit = dimension.unit_for(size);
        let (size, symbol) = unit.map_or((1.0, ""), |unit| (unit.in_si(), unit.symbol));
        match name {
            "area" => Self {
                name,
                size: size * size,
                unit: format!("{symbol}^2"),
            },
            _ => Self {
                name,
                size,
                unit: symbol.to_owned(),
            },
        }
    }

    fn heading(&self, before: &str) -> String {
        format!("{before}{} ({})", self.name, self.unit)
    }

    fn number(&self, value: f64) -> String {
        significant(value / self.size, LENGTH_DIGITS)
    }
}

/// A relative difference in per cent; differences that are no more than rounding are none.
fn percentage(relative: f64) -> String {
    if relative.abs() < 5e-6 {
        "0.000".to_owned()
    } else {
        significant(100.0 * relative, 3)
    }
}
