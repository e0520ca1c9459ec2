//! `fakir friction`: shear stresses on tops and floor from measured lateral forces.

use crate::arguments::Friction as Options;
use crate::failure::Failure;
use crate::numbers::{significant, with_unit};
use crate::session::Session;
use fakir::problem::Question;
use fakir_case::CaseFile;
use fakir_case::unit::Dimension;
use fakir_figure::{LateralModel, LateralPoint, lateral_force};
use fakir_inverse::fit::friction::{FrictionFit, LateralForces, ShearStress, fit_friction};
use fakir_study::answer::{Running, described};
use fakir_study::citations::Topic;
use fakir_study::figures::saved;
use fakir_study::output::File;
use fakir_study::provenance::Provenance;
use fakir_study::report::Report;
use fakir_study::report::table::{Column, table};
use fakir_study::result::json;
use std::time::Instant;

pub(crate) fn run(
    file: &CaseFile,
    data: &LateralForces,
    session: &Session,
) -> Result<Report, Failure> {
    let start = Instant::now();
    let running = Running {
        run: session.run(),
        next: &|part| session.part(part),
    };
    let fitted = fit_friction(file, data, &running)?;
    let wall_time = start.elapsed().as_secs_f64();
    let case = described(&fitted.file.any_case(&[Question::Press])?)?;
    let mut topics = case.topics.clone();
    topics.extend([Topic::LeastSquares, Topic::Interaction("friction")]);
    let provenance = Provenance::new(
        "least squares for shear stresses".to_owned(),
        case.method.clone(),
        &topics,
        case.text.clone(),
    );
    let tables = session.files(|| {
        let mut files = vec![File::new("fitted.csv", fitted.table().to_csv())];
        files.extend(saved(figure(&fitted), &provenance));
        files
    });
    let misfit = fitted
        .p_value
        .is_some_and(|p| p < fakir_inverse::fit::LEVEL);
    Ok(Report {
        json: json(&fitted.summary(data, wall_time)),
        text: text(data, &case.lines, &fitted, wall_time),
        provenance,
        tables,
        warnings: fitted.warnings.clone(),
        converged: fitted.rows.iter().all(|row| row.contact.converged),
        exceeded: Vec::from_iter(misfit.then(|| "the fit does not describe the data".to_owned())),
    })
}

/// The data of a file, with the error given as an argument where the file has none.
pub(crate) fn data(options: &Options) -> Result<LateralForces, Failure> {
    let data = LateralForces::read(&options.data, &options.hints())?;
    Ok(match options.lateral_error {
        Some(error) => data.with_error(error),
        None => data,
    })
}

fn text(data: &LateralForces, case: &[String; 2], fitted: &FrictionFit, wall_time: f64) -> String {
    let used = fitted
        .rows
        .iter()
        .filter(|row| row.computed.is_some())
        .count();
    let mut text = format!(
        "{}: {used} of {} rows used\n",
        data.name(),
        fitted.rows.len()
    );
    for line in data.layout().lines() {
        text += &format!("  {line}\n");
    }
    text += &format!(
        "{}\n{}, in {}\n\n",
        case[0],
        case[1],
        crate::numbers::seconds(wall_time)
    );
    fn stress(value: f64) -> String {
        with_unit(value, Dimension::Pressure, 4)
    }
    text += &table(
        &fitted.stresses,
        &[
            Column::text("", |it: &ShearStress| it.key.path().to_owned()),
            Column::right("value", |it| match it.standard_error {
                Some(_) => stress(it.value),
                None => "-".to_owned(),
            }),
            Column::right("standard error", |it| match it.standard_error {
                Some(error) => with_unit(error, Dimension::Pressure, 2),
                None => "not determined".to_owned(),
            }),
            Column::right("95 % interval", |it| match it.interval {
                Some([low, high]) => format!("{} to {}", stress(low), stress(high)),
                None => "-".to_owned(),
            }),
            Column::right("by errors of areas", |it| {
                with_unit(it.area_error, Dimension::Pressure, 1)
            }),
        ],
    );
    text.push('\n');
    if let Some(correlation) = fitted.correlation() {
        text += &format!("correlation of both stresses: {correlation:.3}\n");
    }
    text += &match (fitted.estimated_error, fitted.p_value) {
        (Some(error), _) => format!(
            "no errors given, standard error of a lateral force estimated as {}; {} degrees of freedom, intervals of Student's distribution\n",
            with_unit(error, Dimension::Force, 3),
            fitted.degrees_of_freedom
        ),
        (None, Some(p)) => format!(
            "chi-square {} for {} degrees of freedom, p = {}; normal intervals\n",
            significant(fitted.chi_square, 4),
            fitted.degrees_of_freedom,
            significant(p, 2)
        ),
        (None, None) => "as many rows as stresses; normal intervals\n".to_owned(),
    };
    text += "the shear does not change the normal contact in this model: exact between incompressible half-spaces, without peeling by shear\n";
    text
}

fn figure(fitted: &FrictionFit) -> fakir_figure::Figure {
    let points: Vec<LateralPoint> = fitted
        .rows
        .iter()
        .map(|row| LateralPoint {
            force: row.contact.force,
            measured: row.measured.lateral.value,
            error: row.error.or(row.measured.lateral.error).unwrap_or(0.0),
            used: row.computed.is_some(),
        })
        .collect();
    let tops = fitted.stresses.first().map_or(0.0, |stress| stress.value);
    let model: Vec<LateralModel> = fitted
        .curve
        .iter()
        .map(|(contact, whole)| LateralModel {
            force: contact.force,
            tops: contact.tops.value * tops,
            floor: whole - contact.tops.value * tops,
        })
        .collect();
    lateral_force(&points, &model)
}
