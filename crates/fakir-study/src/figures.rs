//! Figures of a sweep, and figures as files.

use crate::approach::Loadable;
use crate::history::Followed;
use crate::numbers::{column_unit, scaled};
use crate::output::File;
use crate::provenance::Provenance;
use crate::record::Record;
use crate::row::{Row, RowAnswer};
use fakir_case::Key;
use fakir_case::Study;
use fakir_case::study::{Asked, Axis, Combine, Coordinate, Variable};
use fakir_case::unit::Dimension;
use fakir_figure::{
    Axis as FigureAxis, CriticalStateCurve, CriticalStatePoint, Figure, FigureError, HistoryPoint,
    PullOffCurve, PullOffPoint, Text, critical_states, history, pull_off_curves,
};
use std::collections::BTreeMap;

/// A figure as files.
#[must_use]
pub fn saved(figure: Figure, provenance: &Provenance) -> [File; 2] {
    let figure = figure.with_provenance(&provenance.stamp());
    let name = figure.name();
    [
        File::new(format!("{name}.svg"), figure.svg()),
        File::new(format!("{name}.png"), figure.png()),
    ]
}

/// The figure of a history of viscoelastic bodies.
///
/// # Errors
/// [`FigureError::TooFewData`] for fewer than two states.
pub fn history_figure<P: Loadable>(found: &Followed<P>) -> Result<Figure, FigureError> {
    let rows = found.rows();
    let number = |row: &Record, name: &str| row.number(name);
    let points: Vec<HistoryPoint> = rows
        .iter()
        .map(|row| HistoryPoint {
            time: number(row, "time_s").unwrap_or(f64::NAN),
            indentation: number(row, "indentation_m").unwrap_or(f64::NAN),
            force: number(row, "force_N").unwrap_or(f64::NAN),
            contact_radius: number(row, "contact_radius_m"),
            floor_share: number(row, "floor_share"),
        })
        .collect();
    history(&points, found.history.time_to_floor_contact)
}

/// The label and the points of a curve.
type Labelled<P> = (Text, Vec<P>);

/// Largest number of curves in a figure: the number of distinguishable lines and marks.
const MOST_CURVES: usize = 6;

/// Answers of one curve, each with its abscissa in SI units.
type Answers<'a> = Vec<(f64, &'a Record)>;

/// The figure of a study of cycles (pull-off and hysteresis) or of critical states (force, contact radius and indentation): over the surface
/// fraction if that is an axis, otherwise over the longest numeric axis; one curve for every combination of the others, or a selection if
/// there are too many. `None` for another question, an axis with a single value, or a part of a study.
#[must_use]
pub fn of_study(study: &Study, rows: &[Row]) -> Option<Figure> {
    match study.asked() {
        Asked::Cycle => {
            let (axis, curves) = curves(study, rows, cycle_point)?;
            let curves = curves.into_iter();
            let curves = curves.map(|(label, points)| PullOffCurve { label, points });
            Some(pull_off_curves(&axis, &curves.collect::<Vec<_>>()))
        }
        Asked::Transition => {
            let (axis, curves) = curves(study, rows, critical_point)?;
            let curves = curves.into_iter();
            let curves = curves.map(|(label, points)| CriticalStateCurve { label, points });
            Some(critical_states(&axis, &curves.collect::<Vec<_>>()))
        }
        Asked::Press | Asked::Collapse | Asked::Hold => None,
    }
}

fn cycle_point(x: f64, cycle: &Record) -> PullOffPoint {
    let number = |path| cycle.number(path).unwrap_or(f64::NAN);
    PullOffPoint {
        x,
        force: number("pull_off_force_N"),
        normalized_force: number("normalized_pull_off_force"),
        hysteresis: number("hysteresis_J"),
        normalized_hysteresis: number("normalized_hysteresis"),
    }
}

fn critical_point(x: f64, state: &Record) -> CriticalStatePoint {
    let number = |path| state.number(path).unwrap_or(f64::NAN);
    // On general surfaces it has the name that it has in every contact.
    let radius = state.number("critical_contact_radius_m");
    CriticalStatePoint {
        x,
        force: number("critical_force_N"),
        contact_radius: radius.unwrap_or_else(|| number("contact_radius_m")),
        indentation: number("critical_indentation_m"),
    }
}

/// The curves of a study with their labels, each by increasing abscissa in the unit of the axis; `None` if no curve has two points, and for a
/// part of a study.
fn curves<P>(
    study: &Study,
    rows: &[Row],
    point: fn(f64, &Record) -> P,
) -> Option<(FigureAxis, Vec<Labelled<P>>)> {
    if rows.len() < study.cases() {
        return None;
    }
    let axes: Vec<&Axis> = study.axes().collect();
    let across = across(study, &axes)?;
    let mut curves: BTreeMap<Vec<usize>, (Text, Answers<'_>)> = BTreeMap::new();
    let mut seen: Vec<Vec<&Coordinate>> = axes.iter().map(|_| Vec::new()).collect();
    for row in rows {
        let mut place = Vec::new();
        let mut words = Vec::new();
        for (number, coordinate) in row.coordinates.iter().enumerate() {
            if number == across || study.combine() == Combine::Zip {
                continue;
            }
            let known = &mut seen[number];
            let step = known.iter().position(|other| *other == coordinate);
            place.push(step.unwrap_or(known.len()));
            if step.is_none() {
                known.push(coordinate);
            }
            if axes[number].len() > 1 {
                words.push(setting(axes[number].variable(), coordinate));
            }
        }
        let curve = curves.entry(place);
        let (_, points) = curve.or_insert_with(|| (Text::from(words.join(", ")), Vec::new()));
        if let (Coordinate::Number(x), Some(RowAnswer::Numbers(numbers)), None) =
            (&row.coordinates[across], &row.answer, &row.problem)
        {
            points.push((*x, numbers));
        }
    }
    let curves: Vec<(Text, Answers<'_>)> = curves.into_values().collect();
    let values = curves.iter().flat_map(|(_, points)| points);
    let values: Vec<f64> = values.map(|(x, _)| *x).collect();
    let (axis, size) = figure_axis(axes[across].variable(), &values);
    let last = curves.len().saturating_sub(1);
    let shown = curves.len().min(MOST_CURVES);
    // From the first to the last.
    let shown = (0..shown).map(|k| if shown > 1 { k * last / (shown - 1) } else { 0 });
    let shown: Vec<Labelled<P>> = shown
        .map(|k| {
            let (label, points) = &curves[k];
            let mut points = points.clone();
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            let points = points.into_iter();
            let points = points.map(|(x, numbers)| point(x / size, numbers));
            (label.clone(), points.collect())
        })
        .collect();
    let drawn = shown.iter().any(|(_, points)| points.len() > 1);
    drawn.then_some((axis, shown))
}

/// Index of the axis used as abscissa.
fn across(study: &Study, axes: &[&Axis]) -> Option<usize> {
    let numbers = || (0..axes.len()).filter(|k| axes[*k].is_numeric() && axes[*k].len() > 1);
    if study.combine() == Combine::Zip {
        return numbers().next();
    }
    let fraction = Variable::Key(Key::SurfaceFraction);
    let of_fraction = numbers().find(|k| axes[*k].variable() == fraction);
    // The first of several of equal length.
    of_fraction.or_else(|| numbers().rev().max_by_key(|k| axes[*k].len()))
}

/// The axis of a variable, and the size of its unit in SI. Values that differ by more than a factor of five have a logarithmic axis.
fn figure_axis(variable: Variable, values: &[f64]) -> (FigureAxis, f64) {
    let dimension = variable.dimension().unwrap_or(Dimension::Number);
    let unit = column_unit(values.iter().copied(), dimension);
    let name = match variable {
        Variable::Key(key) => match key.symbol() {
            Some(symbol) => format!("{} {}", key.label(), markup(symbol)),
            None => key.label(),
        },
        Variable::Indentation => "indentation at the turn *ζ*".to_owned(),
        Variable::Force => "force at the turn *F*".to_owned(),
        Variable::RampTime => "duration of the ramp".to_owned(),
        Variable::IndentationRate => "rate of indentation".to_owned(),
        Variable::ForceRate => "rate of the force".to_owned(),
        Variable::HoldTime => "duration of the hold".to_owned(),
    };
    let label = match unit {
        Some(unit) => format!("{name} ({})", printed(unit.symbol)),
        None => name,
    };
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(0.0, f64::max);
    let axis = if low > 0.0 && high > 5.0 * low {
        FigureAxis::logarithmic(label)
    } else {
        FigureAxis::linear(label)
    };
    (axis, unit.map_or(1.0, |unit| unit.in_si()))
}

/// A value of a variable: `*w* = 50 mJ/m^{2}`.
fn setting(variable: Variable, value: &Coordinate) -> String {
    let name = match variable {
        Variable::Key(key) => key.symbol().map_or_else(|| key.label(), markup),
        Variable::Indentation => "*ζ*".to_owned(),
        Variable::Force => "*F*".to_owned(),
        Variable::RampTime => "ramp".to_owned(),
        Variable::IndentationRate | Variable::ForceRate => "rate".to_owned(),
        Variable::HoldTime => "hold".to_owned(),
    };
    let value = match value {
        Coordinate::Word(word) => return word.replace('_', " "),
        Coordinate::Number(value) => *value,
    };
    let (number, unit) = scaled(value, variable.dimension().unwrap_or(Dimension::Number), 3);
    format!("{name} = {number} {}", printed(unit))
        .trim_end()
        .to_owned()
}

/// A symbol of the paper in italics, with upright subscripts.
fn markup(symbol: &str) -> String {
    match symbol.split_once('_') {
        Some((symbol, lowered)) => format!("*{symbol}*_{{{lowered}}}"),
        None => format!("*{symbol}*"),
    }
}

/// A unit as printed in a figure: `mJ/m^{2}`, `µm`.
#[must_use]
pub fn printed(unit: &str) -> String {
    unit.replace("m2", "m^{2}").replace('u', "µ")
}

/// A question such as `contact at an indentation of 6 um` as the label of a panel: units as printed.
#[must_use]
pub fn question_in_figure(question: &str) -> Text {
    let mut before_is_number = false;
    let words = question.split(' ').map(|word| {
        let word = if before_is_number {
            word.replace('u', "µ")
        } else {
            word.to_owned()
        };
        before_is_number = word.parse::<f64>().is_ok();
        word
    });
    Text::plain(&words.collect::<Vec<_>>().join(" "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::{Options, sweep};
    use fakir_case::{Case, StudyFile};

    fn study(tables: &str) -> Study {
        let text = format!("{tables}\n{}", Case::example().to_toml());
        let mut file = StudyFile::parse("study.toml", &text).unwrap();
        file.set("pattern.pillar.height=0.3um").unwrap();
        file.study().unwrap()
    }

    /// The surface fraction is the abscissa regardless of the order of the axes, and every work of adhesion has a curve.
    #[test]
    fn cycles_are_drawn_over_the_surface_fraction() {
        let study = study(
            "[study]\nquestion = \"cycle\"\n[axes]\nsurface_fraction = [0.001, 0.003]\n\
             \"adhesion.work\" = [\"5 mJ/m2\", \"20 mJ/m2\", \"50 mJ/m2\"]",
        );
        let rows = sweep(&study, &mut Options::default()).unwrap();
        let figure = of_study(&study, &rows).unwrap();
        assert_eq!(figure.name(), "pull-off");
        assert_eq!(figure.faults(), Vec::<String>::new());
        let text = figure.svg();
        for words in ["surface fraction", "5.00 mJ/m", "50.0 mJ/m", "hysteresis"] {
            assert!(text.contains(words), "{words}");
        }
        // A part of the study has no figure.
        assert!(of_study(&study, &rows[1..]).is_none());
    }

    /// A sweep of critical states has a curve for every other setting.
    #[test]
    fn critical_states_are_drawn_over_the_surface_fraction() {
        let study =
            study("[axes]\nsurface_fraction = [0.001, 0.003]\n\"pattern.offset\" = [0, 0.5]");
        let rows = sweep(&study, &mut Options::default()).unwrap();
        let figure = of_study(&study, &rows).unwrap();
        assert_eq!(figure.name(), "critical-states");
        assert_eq!(figure.faults(), Vec::<String>::new());
        let text = figure.svg();
        for words in [
            "surface fraction",
            "critical force",
            "contact radius",
            "0.500",
        ] {
            assert!(text.contains(words), "{words}");
        }
        assert!(of_study(&study, &rows[1..]).is_none());
    }

    #[test]
    fn other_questions_have_no_figure() {
        let study = study(
            "[study]\nquestion = \"press\"\nindentation = \"0.2 um\"\n[axes]\nsurface_fraction = [0.001, 0.003]",
        );
        let rows = sweep(&study, &mut Options::default()).unwrap();
        assert!(of_study(&study, &rows).is_none());
    }

    /// Figures print the unit of a question with its prefix.
    #[test]
    fn questions_as_printed() {
        for (question, printed) in [
            (
                "contact at an indentation of 6 um",
                "contact at an indentation of 6 µm",
            ),
            (
                "contact under a force of 0.5 uN",
                "contact under a force of 0.5 µN",
            ),
            (
                "contact under a force of 2 mN",
                "contact under a force of 2 mN",
            ),
            ("critical state", "critical state"),
        ] {
            assert_eq!(question_in_figure(question), Text::plain(printed));
        }
    }

    #[test]
    fn symbols_and_units_as_printed() {
        assert_eq!(markup("E_s"), "*E*_{s}");
        assert_eq!(printed("mJ/m2"), "mJ/m^{2}");
        let work = Variable::Key(Key::WorkOfAdhesion);
        let text = setting(work, &Coordinate::Number(50e-3));
        assert_eq!(text, "*w* = 50.0 mJ/m^{2}");
    }
}
