//! The figures of the study.

use super::findings::{Checked, RUBBER, TYPICAL};
use super::scaling::{Form, Group, Reduced};
use super::study::{Cases, FloorCase, Scope, same};
use crate::PaperError;
use crate::figures::Plate;
use crate::grid::{Substrate, system};
use fakir::problem::{Adhesion, Load, Method, System};
use fakir::solve::collapsed_floor::CollapsedCycle;
use fakir::state::{Run, SolveError};
use fakir_figure::{
    Axis, Dash, LineChart, Marker, PhaseDiagram, Series, Style, Tint, lines, phase_diagram,
    phase_point,
};
use fakir_study::{FloorOutcome, Validity, collapse_path};

/// Rounds a number of an axis to remove rounding errors.
fn rounded(value: f64) -> f64 {
    (1e9 * value).round() / 1e9
}

/// States of a loading on the tops.
const STEPS: u32 = 24;

/// Loading and unloading of the lens, for a figure.
struct Way {
    system: System,
    label: String,
    /// Indentation, force and radius of the contact on the tops, up to the critical state.
    tops: Vec<[f64; 3]>,
    floor: CollapsedCycle,
}

fn way(fraction: f64, work: f64, run: &Run<'_>) -> Result<Way, PaperError> {
    let bare = system(Substrate::Intermediate, 0.0, fraction)?;
    let adhesive = bare
        .with_adhesion(Adhesion::new(work))
        .map_err(SolveError::from)?;
    let critical = fakir::transition(&bare, Method::default(), run)?.contact;
    let mut tops = Vec::new();
    for step in 1..STEPS {
        let part = f64::from(step) / f64::from(STEPS);
        let control = Load::Indentation(part * part * critical.indentation);
        let state = fakir::press(&bare, control, Method::default(), run)?;
        tops.push([state.indentation, state.force, state.contact_radius]);
    }
    tops.push([
        critical.indentation,
        critical.force,
        critical.contact_radius,
    ]);
    Ok(Way {
        label: format!("*φ* = {fraction}, *w* = {} mJ/m^{{2}}", rounded(1e3 * work)),
        floor: collapse_path(&adhesive, critical.indentation, run)?,
        system: bare,
        tops,
    })
}

impl Way {
    /// Points of loading and unloading with floor contact as three numbers; loading starts at the critical state.
    fn branches(&self) -> [Vec<[f64; 3]>; 2] {
        let [down, up] = [false, true].map(|unloading| {
            let points = self.floor.points.iter();
            points
                .filter(|point| point.unloading == unloading)
                .map(|point| [point.indentation, point.force, point.contact_radius])
                .collect::<Vec<_>>()
        });
        [
            self.tops.last().copied().into_iter().chain(down).collect(),
            up,
        ]
    }
}

const TINTS: [Tint; 4] = [Tint::Blue, Tint::Vermillion, Tint::Green, Tint::Purple];

/// Lines of both branches: solid for loading, dashed for unloading. Loading on the tops, which does not depend on the work of adhesion, is
/// grey.
fn branches(ways: &[Way], point: impl Fn(&Way, [f64; 3]) -> [f64; 2]) -> Vec<Series> {
    let points = |way: &Way, branch: &[[f64; 3]]| -> Vec<[f64; 2]> {
        branch.iter().map(|values| point(way, *values)).collect()
    };
    let grey = Style::line(0).in_tint(Tint::Grey);
    let on_tops = ways.iter().map(|way| {
        let points = points(way, &way.tops);
        Series::new("loading, tops only", points, grey)
    });
    let mut series: Vec<Series> = on_tops.collect();
    for (way, tint) in ways.iter().zip(TINTS) {
        let [down, up] = way.branches();
        let solid = Style::line(0).in_tint(tint);
        series.push(Series::new(way.label.as_str(), points(way, &down), solid));
        let dashed = solid.with_line(Dash::Dashed);
        series.push(Series::unnamed(points(way, &up), dashed));
    }
    series.push(in_legend("unloading", grey.with_line(Dash::Dashed)));
    series
}

/// An entry of the legend that explains a style of several series.
fn in_legend(label: &str, style: Style) -> Series {
    Series::new(label, Vec::new(), style)
}

/// All figures, in the order of the report.
///
/// # Errors
/// [`PaperError`]
pub fn plates(
    scope: &Scope,
    cases: &Cases,
    laws: &[Checked],
    run: &Run<'_>,
) -> Result<Vec<Plate>, PaperError> {
    let single = Run {
        pool: None,
        ..run.clone()
    };
    let ways = [(TYPICAL, 10e-3), (TYPICAL, RUBBER), (0.06, RUBBER)]
        .into_iter()
        .map(|(fraction, work)| way(fraction, work, &single))
        .collect::<Result<Vec<Way>, PaperError>>()?;
    let mut plates = vec![cycles(&ways), phases(&ways)?];
    plates.extend(Substrate::ALL.map(|substrate| regions(cases, substrate)));
    plates.push(withdrawals(cases));
    plates.extend(laws.iter().map(|law| collapse(cases, law)));
    plates.push(pull_offs(scope, cases));
    plates.push(hystereses(scope, cases));
    plates.push(sizes(scope, cases));
    Ok(plates)
}

fn plate(chart: &LineChart, name: &str, title: &str, caption: &str) -> Plate {
    Plate::new(lines(chart), name, title, caption)
}

fn cycles(ways: &[Way]) -> Plate {
    let series = branches(ways, |way, [indentation, force, _]| {
        let last = way.tops[way.tops.len() - 1];
        [indentation / last[0], force / last[1]]
    });
    let chart = LineChart {
        x: Axis::linear("indentation *ζ*/*ζ*_{c}"),
        y: Axis::linear("force *F*/*F*_{c}"),
        series,
    };
    plate(
        &chart,
        "cycles",
        "Force over indentation on loading and unloading, adhesive floor",
        "Force against indentation, both over those of the critical state, intermediate substrate, lens axis on a pillar: solid on loading, with the jump at the first floor contact, \
         dashed on unloading as long as the floor is attached. Fast model, in which shells of pillars cause the steps; up to the critical state tops only, without adhesion.",
    )
}

fn phases(ways: &[Way]) -> Result<Plate, PaperError> {
    let paths = branches(ways, |way, [_, force, radius]| {
        phase_point(&way.system, force, radius)
    });
    let critical = ways.iter().map(|way| {
        let [_, force, radius] = way.tops[way.tops.len() - 1];
        phase_point(&way.system, force, radius)
    });
    let marks = Style::marks(0).in_tint(Tint::Black);
    let figure = phase_diagram(&PhaseDiagram {
        system: system(Substrate::Intermediate, 0.0, TYPICAL)?,
        critical: vec![Series::new(
            "first floor contact",
            critical.collect::<Vec<_>>(),
            marks,
        )],
        paths,
        shares: Vec::new(),
    });
    Ok(Plate::new(
        figure,
        "phase-diagram",
        "Phase diagram with an adhesive floor",
        "Reduced force against the radius of the contact in pitches, intermediate substrate: solid on loading, dashed on unloading. On loading the lens reaches the transition curve and the force drops; on unloading the floor remains attached \
         far inside the region in which, without adhesion, only the tops are in contact. Forces below zero are not shown.",
    ))
}

/// Regions of floor behaviour over surface fraction and work of adhesion.
fn regions(cases: &Cases, substrate: Substrate) -> Plate {
    let mut line: Vec<[f64; 2]> = Vec::new();
    for case in cases.on_pillar(substrate) {
        let point = [case.found.surface_fraction, 1e3 * case.found.collapse_work];
        if line.last().is_none_or(|last| last[0] < point[0]) {
            line.push(point);
        }
    }
    let mut series = vec![Series::new(
        "collapse threshold *w*_{c}, flat lattice",
        line,
        Style::line(0).in_tint(Tint::Black),
    )];
    let points = |of: &dyn Fn(&FloorCase) -> bool| -> Vec<[f64; 2]> {
        let chosen = cases.on_pillar(substrate).filter(|case| of(case));
        chosen
            .map(|case| [case.found.surface_fraction, 1e3 * case.found.work])
            .collect()
    };
    let good = |case: &FloorCase| case.fate().is_some();
    let mark = |tint, marker| Style {
        tint,
        line: None,
        marker: Some(marker),
    };
    let is =
        |fate: FloorOutcome| move |case: &FloorCase| case.fate().unwrap_or(case.found.fate) == fate;
    let classes = [
        (
            "attached at zero load",
            FloorOutcome::HeldThroughZero,
            Tint::Vermillion,
            Marker::Disc,
        ),
        (
            "detached under load",
            FloorOutcome::LostUnderLoad,
            Tint::Blue,
            Marker::Square,
        ),
    ];
    for (label, fate, tint, marker) in classes {
        series.push(Series::new(
            label,
            points(&|case| good(case) && is(fate)(case)),
            mark(tint, marker),
        ));
    }
    series.push(Series::new(
        "attached, outside the model",
        points(&|case| !good(case) && is(FloorOutcome::HeldThroughZero)(case)),
        mark(Tint::Orange, Marker::Ring),
    ));
    series.push(Series::new(
        "detached, outside the model",
        points(&|case| !good(case) && is(FloorOutcome::LostUnderLoad)(case)),
        mark(Tint::Sky, Marker::Ring),
    ));
    series.push(Series::new(
        "tops only, or not known",
        points(&|case| is(FloorOutcome::NoPatch)(case) || is(FloorOutcome::Unknown)(case)),
        mark(Tint::Grey, Marker::Cross),
    ));
    series.retain(|series| !series.points.is_empty());
    let chart = LineChart {
        x: Axis::logarithmic("surface fraction *φ*"),
        y: Axis::logarithmic("work of adhesion *w* (mJ/m^{2})"),
        series,
    };
    plate(
        &chart,
        &format!("regions-{}", substrate.name()),
        "State of the adhesive floor on unloading",
        &format!(
            "Work of adhesion against surface fraction, {} substrate, lens axis on a pillar, loaded to 1.2 times the critical indentation: whether the floor is still attached at zero load. Full marks: cells of the floor, or the fast model \
             in its range; rings: its result outside of its range. Crosses: no bonded region, because annuli meet, none is left where unloading starts, or no front is stable, and there is no solution on cells. The line is the collapse threshold of the flat lattice without load.",
            substrate.name()
        ),
    )
}

/// Withdrawal against the collapse threshold alone.
fn withdrawals(cases: &Cases) -> Plate {
    let mut groups: Vec<(f64, &str, Vec<[f64; 2]>)> = Vec::new();
    for substrate in [Substrate::Rigid, Substrate::Intermediate] {
        for case in cases.on_pillar(substrate) {
            let Some(value) = Reduced::Withdrawal.of(case) else {
                continue;
            };
            let fraction = case.found.surface_fraction;
            let point = [Group::Threshold.of(case), value];
            let known = groups
                .iter_mut()
                .find(|(of, name, _)| same(*of, fraction) && *name == substrate.name());
            match known {
                Some((_, _, points)) => points.push(point),
                None => groups.push((fraction, substrate.name(), vec![point])),
            }
        }
    }
    let places = |name: &str| {
        if name == Substrate::Rigid.name() {
            Dash::Dashed
        } else {
            Dash::Solid
        }
    };
    let mut fractions: Vec<f64> = groups.iter().map(|group| group.0).collect();
    fractions.sort_by(f64::total_cmp);
    fractions.dedup_by(|a, b| same(*a, *b));
    let series = groups.into_iter().map(|(fraction, name, points)| {
        let place = fractions.iter().position(|other| same(*other, fraction));
        let style = Style::marks(place.unwrap_or(0)).with_line(places(name));
        if name == Substrate::Intermediate.name() {
            Series::new(format!("*φ* = {}", rounded(fraction)), points, style)
        } else {
            Series::unnamed(points, style)
        }
    });
    let substrates = [Substrate::Intermediate, Substrate::Rigid].map(|substrate| {
        let style = Style::line(0).in_tint(Tint::Black);
        let label = format!("{} substrate", substrate.name());
        in_legend(&label, style.with_line(places(substrate.name())))
    });
    let chart = LineChart {
        x: Axis::logarithmic("work of adhesion over collapse threshold *w*/*w*_{c}"),
        y: Axis::logarithmic(named(Reduced::Withdrawal)),
        series: series.chain(substrates).collect(),
    };
    plate(
        &chart,
        "withdrawal",
        "Withdrawal at the detachment of the floor over the work of adhesion",
        "Withdrawal at which the floor detaches, over the critical indentation, against the work of adhesion over the collapse threshold, on cells or by the fast model in its range; solid: intermediate, dashed: rigid substrate. \
         The threshold alone does not make the curves coincide.",
    )
}

/// Name of a quantity.
fn quantity(reduced: Reduced) -> &'static str {
    match reduced {
        Reduced::Withdrawal => "withdrawal",
        Reduced::Area => "floor contact area",
        Reduced::Drop => "force drop",
        Reduced::PullOff => "pull-off force",
        Reduced::Hysteresis => "hysteresis",
    }
}

/// Label of an axis: name and formula of a quantity.
fn named(reduced: Reduced) -> String {
    format!("{} {}", quantity(reduced), reduced.formula())
}

/// Values compared with their law.
fn collapse(cases: &Cases, (law, held): &Checked) -> Plate {
    let reduced = law.reduced;
    let points = |of: &mut dyn Iterator<Item = &FloorCase>| -> Vec<[f64; 2]> {
        of.filter(|case| case.has_laws())
            .filter_map(|case| Some([law.at(case), reduced.of(case)?]))
            .collect()
    };
    let mut series = Vec::new();
    for (place, substrate) in [Substrate::Rigid, Substrate::Intermediate]
        .into_iter()
        .enumerate()
    {
        let values = points(&mut cases.on_pillar(substrate));
        series.push(Series::new(
            format!("{} substrate", substrate.name()),
            values,
            Style::marks(place),
        ));
    }
    series.push(Series::new(
        "other sizes",
        points(&mut cases.sizes.iter()),
        Style::marks(2),
    ));
    let others = points(&mut cases.check.iter());
    let ring = Style {
        tint: Tint::Black,
        line: None,
        marker: Some(Marker::Ring),
    };
    series.push(Series::new("systems not used in the fit", others, ring));
    series.retain(|series| !series.points.is_empty());
    let all = series
        .iter()
        .flat_map(|series| series.points.iter().map(|point| point[0]));
    let (low, high) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
        (low.min(x), high.max(x))
    });
    series.push(Series::new(
        "law",
        vec![[low, low], [high, high]],
        Style::line(0).in_tint(Tint::Black),
    ));
    let form = reduced.form();
    let mut label = format!("{:.3}", law.prefactor);
    for (group, [exponent, _]) in law.groups.iter().zip(&law.exponents) {
        let term = match form {
            Form::Powers => format!(" {}^{{{exponent:.2}}}", group.label()),
            Form::Sum => {
                let sign = if *exponent < 0.0 { '-' } else { '+' };
                format!(" {sign} {:.2} {}", exponent.abs(), group.label())
            }
        };
        label.push_str(&term.replace('-', "−"));
    }
    let axis = match form {
        Form::Powers => Axis::logarithmic,
        Form::Sum => Axis::linear,
    };
    let chart = LineChart {
        x: axis(label.as_str()),
        y: axis(named(reduced).as_str()),
        series,
    };
    let unit = law.unit();
    let mut caption = format!(
        "{} against its law, on cells or in the range of the fast model: {} cases scatter about the line by {:.1} %{unit}, {:.1} % at most.",
        match reduced {
            Reduced::Withdrawal => "Relative withdrawal at which the floor detaches",
            Reduced::Area => "Area of the floor contact after the jump over that of the contact",
            Reduced::Drop => "Relative drop of the force at the jump",
            Reduced::PullOff => "Pull-off force with the floor over that of a smooth sphere",
            Reduced::Hysteresis => "Hysteresis of the floor over critical force and indentation",
        },
        law.points,
        100.0 * law.scatter,
        100.0 * law.largest
    );
    if let Some(held) = held {
        caption.push_str(&format!(
            " Rings: {} systems that are not used in the fit, {:.1} %{unit} from the law, {:.1} % at most; {} are within the {:.1} % in which 19 of 20 are expected.",
            held.points,
            100.0 * held.scatter,
            100.0 * held.largest,
            held.in_band,
            100.0 * law.band
        ));
    }
    plate(
        &chart,
        &format!("law-{}", reduced.name().replace('_', "-")),
        &format!("Scaling law of the {}", quantity(reduced)),
        &caption,
    )
}

/// Pull-off force over the surface fraction.
fn pull_offs(scope: &Scope, cases: &Cases) -> Plate {
    let mut series = Vec::new();
    let smooth_lines = [
        Style::line(0).in_tint(Tint::Grey).with_line(Dash::Dotted),
        Style::line(0)
            .in_tint(Tint::Black)
            .with_line(Dash::DashDotted),
    ];
    for (place, substrate) in [Substrate::Rigid, Substrate::Intermediate]
        .into_iter()
        .enumerate()
    {
        let at: Vec<&FloorCase> = scope
            .fractions
            .iter()
            .filter_map(|fraction| cases.at(substrate, *fraction, RUBBER))
            .collect();
        let floor = at.iter().filter_map(|case| {
            let good = case.found.unloading_validity == Validity::InRange;
            let pull = case.found.pull_off.filter(|_| good)?;
            Some([case.found.surface_fraction, -1e3 * pull])
        });
        let name = substrate.name();
        let floor: Vec<_> = floor.collect();
        series.push(Series::new(
            format!("{name}, tops and floor"),
            floor,
            Style::marks(place).with_line(Dash::Solid),
        ));
        let tops = at.iter().filter_map(|case| {
            let pull = cases.tops_of(case)?.pull_off?;
            Some([case.found.surface_fraction, -1e3 * pull])
        });
        let tops: Vec<_> = tops.collect();
        series.push(Series::new(
            format!("{name}, tops only"),
            tops,
            Style::marks(place + 2).with_line(Dash::Dashed),
        ));
        let smooth = at.iter().filter_map(|case| {
            Some([
                case.found.surface_fraction,
                -1e3 * case.found.smooth_pull_off?,
            ])
        });
        let smooth: Vec<_> = smooth.collect();
        series.push(Series::new(
            format!("{name}, smooth floor"),
            smooth,
            smooth_lines[place],
        ));
    }
    series.retain(|series| !series.points.is_empty());
    let chart = LineChart {
        x: Axis::logarithmic("surface fraction *φ*"),
        y: Axis::logarithmic("pull-off force |*F*_{off}| (mN)"),
        series,
    };
    plate(
        &chart,
        "pull-off",
        "Pull-off force over the surface fraction, with and without the floor",
        "Pull-off force with 50 mJ/m^2 against the surface fraction, lens axis on a pillar: with an adhesive floor (fast model in its range, where the floor is attached at zero load), of the tops alone (exact), \
         and of a smooth floor (closed form).",
    )
}

/// Hysteresis over the work of adhesion.
fn hystereses(scope: &Scope, cases: &Cases) -> Plate {
    let mut series = Vec::new();
    for (place, fraction) in scope.fractions.iter().enumerate() {
        let at = scope
            .works
            .iter()
            .filter_map(|work| cases.at(Substrate::Intermediate, *fraction, *work))
            .filter(|case| case.found.unloading_validity == Validity::InRange);
        let values =
            at.filter_map(|case| Some([1e3 * case.found.work, 1e9 * case.found.hysteresis?]));
        let values: Vec<_> = values.collect();
        if values.len() > 1 {
            let style = Style::marks(place).with_line(Dash::Solid);
            series.push(Series::new(format!("*φ* = {fraction}"), values, style));
        }
    }
    let chart = LineChart {
        x: Axis::logarithmic("work of adhesion *w* (mJ/m^{2})"),
        y: Axis::logarithmic("hysteresis *W* (nJ)"),
        series,
    };
    plate(
        &chart,
        "hysteresis",
        "Hysteresis of the adhesive floor over the work of adhesion",
        "Area between loading and unloading as long as the floor is attached, intermediate substrate, lens axis on a pillar, loaded to 1.2 times the critical indentation: fast model in its range.",
    )
}

/// Withdrawal over the pillar height, for every diameter.
fn sizes(scope: &Scope, cases: &Cases) -> Plate {
    let mut series = Vec::new();
    let fraction = scope.sized_fractions[scope.sized_fractions.len() / 2];
    for (place, diameter) in scope.diameters.iter().enumerate() {
        for (number, work) in scope.sized_works.iter().rev().take(2).enumerate() {
            let values = cases.sizes.iter().filter(|case| {
                same(case.diameter, *diameter)
                    && same(case.found.work, *work)
                    && same(case.found.surface_fraction, fraction)
            });
            let values =
                values.filter_map(|case| Some([1e6 * case.height, Reduced::Withdrawal.of(case)?]));
            let values: Vec<_> = values.collect();
            let dash = if number == 0 {
                Dash::Solid
            } else {
                Dash::Dashed
            };
            let label = format!(
                "*d* = {} µm, *w* = {} mJ/m^{{2}}",
                rounded(1e6 * diameter),
                rounded(1e3 * work)
            );
            if !values.is_empty() {
                series.push(Series::new(
                    label,
                    values,
                    Style::marks(place).with_line(dash),
                ));
            }
        }
    }
    let chart = LineChart {
        x: Axis::logarithmic("height of the pillars *h* (µm)"),
        y: Axis::logarithmic(named(Reduced::Withdrawal)),
        series,
    };
    plate(
        &chart,
        "sizes",
        "Withdrawal at the detachment of the floor over the pillar height",
        &format!(
            "Withdrawal at which the floor detaches against the height of the pillars, for several diameters, intermediate substrate, φ = {fraction}: fast model in its range."
        ),
    )
}
