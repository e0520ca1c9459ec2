//! Loading and unloading of adhesive pillars.

use super::branches::{self, BRANCHES, largest, mark};
use crate::axis::Axis;
use crate::chart::{Chart, Grid};
use crate::colour::{ColourMap, Tint};
use crate::error::FigureError;
use crate::figure::{COLUMN, Figure};
use crate::map::{ColourBar, KeySign, Sheet, ringed};
use crate::scene::{Colour, Item};
use crate::series::{Marker, Series};
use crate::unit::Unit;
use fakir::problem::{Method, PlacedPillar};
use fakir::state::{Branch, Cycle, CycleLoadStep, PullOff};
use std::collections::{BTreeMap, HashSet};

/// A point in SI units: indentation (m), and force (N) or a number.
type Point = [f64; 2];

/// Force over indentation on both branches, an enlarged view near the pull-off, and the number of pillars in contact. Marks show where pillars come into
/// contact and detach, the critical state, and the pull-off. With an adhesive floor there is a panel for its contact area, and marks for the jump onto the
/// floor and its detachment.
///
/// # Errors
/// [`FigureError::TooFewData`] if the curve has fewer than two load steps.
pub fn cycle_curve(cycle: &Cycle) -> Result<Figure, FigureError> {
    let stations = &cycle.stations;
    branches::check_length(stations.len())?;
    let across = Unit::of_length(largest(stations, |station| station.indentation));
    let x = || Axis::linear(format!("indentation *ζ* ({})", across.name));
    let force = Unit::of_force(largest(stations, |station| station.force));
    let mut charts = vec![force_chart(cycle, x(), [across, force])];
    let mut heights = vec![122.0];
    if let Some(pull_off) = &cycle.pull_off {
        charts.push(pull_off_chart(cycle, pull_off, x(), across));
        heights.push(122.0);
    }
    let mut of_branches = |name: &str, value: &dyn Fn(&CycleLoadStep) -> f64| {
        let series = branches::lines(false, |branch| {
            let on_branch = stations.iter().filter(|station| station.branch == branch);
            on_branch
                .map(|station| [across.of(station.indentation), value(station)])
                .collect()
        });
        charts.push(Chart::new(x(), Axis::linear(name), series));
        heights.push(96.0);
    };
    of_branches("pillars in contact", &|it| it.pillars_in_contact as f64);
    if cycle.floor.is_some() {
        let area = |station: &CycleLoadStep| station.floor.map_or(0.0, |floor| floor.area);
        of_branches("floor contact area (µm^{2})", &|it| 1e12 * area(it));
    }
    let figure = Grid {
        name: "cycle",
        width: COLUMN,
        columns: 1,
        heights,
        charts,
        common_x: false,
        common_y: false,
        titles: Vec::new(),
        tagged: true,
    }
    .figure();
    Ok(figure.with_description(
        "Force and pillars in contact over indentation on loading and unloading",
        "Force over indentation on loading and unloading, the same close to the pull-off, and the number of pillars in contact; \
         marks show where pillars attach and detach, the critical state and the pull-off. With an adhesive floor its contact \
         area is below, and the jump into floor contact and the detachment of the floor are marked.",
    ))
}

/// Colour of pillars that were never in contact.
const UNTOUCHED: Colour = Colour::grey(226);

fn force_chart(cycle: &Cycle, x: Axis, [across, up]: [Unit; 2]) -> Chart {
    let y = Axis::linear(format!("force *F* ({})", up.name));
    Chart::new(x, y, force_series(cycle, [across, up]))
}

/// The same chart restricted to forces no larger in magnitude than the pull-off force.
fn pull_off_chart(cycle: &Cycle, pull_off: &PullOff, x: Axis, across: Unit) -> Chart {
    let up = Unit::of_force(pull_off.force);
    let seen = BRANCHES.map(|(branch, ..)| up_to(&curve(cycle, branch), -pull_off.force));
    let seen = || seen.iter().flatten();
    let whole = force_chart(cycle, x, [across, up]);
    Chart {
        x: whole
            .x
            .around(seen().map(|[indentation, _]| across.of(*indentation))),
        y: whole.y.around(seen().map(|[_, force]| up.of(*force))),
        ..whole
    }
}

/// Force over indentation on a branch.
fn curve(cycle: &Cycle, branch: Branch) -> Vec<Point> {
    let on_branch = cycle.stations.iter().filter(|it| it.branch == branch);
    on_branch.map(|it| [it.indentation, it.force]).collect()
}

/// Both branches with their events.
fn force_series(cycle: &Cycle, [across, up]: [Unit; 2]) -> Vec<Series> {
    let at = |[indentation, force]: Point| [across.of(indentation), up.of(force)];
    let mut series = branches::lines(true, |branch| {
        curve(cycle, branch).into_iter().map(at).collect()
    });
    series.extend(branches::changes(|kind| {
        let events = cycle.events.iter().filter(|event| event.kind == kind);
        events
            .map(|event| at([event.indentation, event.force]))
            .collect()
    }));
    let critical = cycle.critical.as_ref().map(|it| &it.contact);
    if let Some(state) = critical {
        let place = at([state.indentation, state.force]);
        let style = mark(Tint::Black, Marker::Diamond);
        series.push(Series::new("critical state", vec![place], style));
    }
    let jump = cycle.floor_jump().map(|[_, after]| after);
    let lost = cycle.floor_lost().map(|[last, _]| last);
    for (station, name, tint) in [
        (jump, "jump into floor contact", Tint::Orange),
        (lost, "floor detachment", Tint::Purple),
    ] {
        if let Some(station) = station {
            let place = at([station.indentation, station.force]);
            let style = mark(tint, Marker::Triangle);
            series.push(Series::new(name, vec![place], style));
        }
    }
    if let Some(pull_off) = &cycle.pull_off {
        series.push(branches::pull_off(at([
            pull_off.indentation,
            pull_off.force,
        ])));
    }
    series
}

/// Points of a curve with forces of at most `largest` (N), and its crossings of that force.
fn up_to(points: &[Point], largest: f64) -> Vec<Point> {
    let mut seen = Vec::new();
    for (k, point) in points.iter().enumerate() {
        let before = k.checked_sub(1).map(|k| points[k]);
        if let Some(before) = before.filter(|it| (it[1] > largest) != (point[1] > largest)) {
            let part = (largest - before[1]) / (point[1] - before[1]);
            seen.push([before[0] + part * (point[0] - before[0]), largest]);
        }
        if point[1] <= largest {
            seen.push(*point);
        }
    }
    seen
}

/// Map of all pillars that were in contact: the indentation of the last detachment of each, and which of them were attached at the
/// pull-off.
///
/// # Errors
/// [`FigureError::NoPillars`] if no pillar detached.
pub fn release_map(cycle: &Cycle) -> Result<Figure, FigureError> {
    let released: BTreeMap<(i64, i64), ([f64; 2], f64)> = cycle
        .release_order()
        .into_iter()
        .filter(|event| event.branch == Branch::Unloading)
        .filter_map(|event| {
            let pillar = event.pillar?;
            Some((pillar.index, (pillar.centre, event.indentation)))
        })
        .collect();
    if released.is_empty() {
        return Err(FigureError::NoPillars {
            method: Method::Spectral(cycle.accuracy).name(),
        });
    }
    let indentations = || released.values().map(|(_, indentation)| *indentation);
    let low = indentations().fold(f64::INFINITY, f64::min);
    let high = indentations().fold(f64::NEG_INFINITY, f64::max);
    let unit = Unit::of_length(low.abs().max(high.abs()));
    let bar = ColourBar::over(
        ColourMap::Viridis,
        unit.of(low),
        unit.of(high),
        format!("indentation at detachment ({})", unit.name),
    );
    let farthest = released.values().map(|([x, y], _)| x.hypot(*y));
    let half_width = farthest.fold(0.0, f64::max) + cycle.system.pitch();
    let sheet = Sheet::new([0.0, 0.0], half_width, &bar);
    let window = &sheet.window;
    let pulling = cycle.pull_off.iter().flat_map(|it| &it.pillars);
    let pulling: HashSet<(i64, i64)> = pulling.map(|pillar| pillar.index).collect();
    let discs = window.pillars(&cycle.system);
    let has_untouched = discs
        .iter()
        .any(|pillar| !released.contains_key(&pillar.index));
    let discs = discs.into_iter().flat_map(|pillar| {
        let PlacedPillar { index, centre, .. } = pillar;
        let radius = window.length(0.5 * pillar.diameter);
        let found = released.get(&index);
        let colour = found.map_or(UNTOUCHED, |(_, at)| bar.colour(unit.of(*at)));
        let centre = window.place(centre);
        if pulling.contains(&index) {
            return ringed(centre, radius, colour).to_vec();
        }
        vec![Item::Disc {
            centre,
            radius,
            fill: Some(colour),
            stroke: None,
        }]
    });
    let mut signs = Vec::new();
    if !pulling.is_empty() {
        signs.push((KeySign::Ring, "attached at pull-off"));
    }
    if has_untouched {
        signs.push((KeySign::Disc(UNTOUCHED), "never in contact"));
    }
    let figure = sheet.figure("releases", &bar, discs.collect(), &signs);
    Ok(figure.with_description(
        "Indentation at which each pillar detaches",
        &format!(
            "Map of the {} pillars that were in contact, coloured by the indentation at which each detached; the {} that \
             were attached at the pull-off have a ring.",
            released.len(),
            pulling.len()
        ),
    ))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::samples;
    use fakir::problem::{Adhesion, CyclePlan, HexagonalLattice};
    use fakir::state::Run;

    /// A force that leaves the enlarged view, returns and leaves it again is drawn completely and
    /// clipped by the frame.
    #[test]
    fn the_close_up_shows_the_same_curve() {
        let lattice = HexagonalLattice::with_surface_fraction(0.001, samples::DIAMETER);
        let system = samples::system(lattice);
        let system = system.with_adhesion(Adhesion::new(50e-3)).unwrap();
        let plan = CyclePlan::default();
        let mut cycle = fakir::cycle(&system, plan, Method::default(), &Run::default()).unwrap();
        let pull_off = cycle.pull_off.clone().unwrap();
        for (k, station) in cycle.stations.iter_mut().enumerate() {
            let times = [-1.0, 0.5, 9.0, 7.0, 0.2, 3.0][k % 6];
            station.force = times * pull_off.force.abs();
        }
        let unit = Unit::of_length(1e-6);
        let close_up = pull_off_chart(&cycle, &pull_off, Axis::linear("x"), unit);
        let force = Unit::of_force(pull_off.force);
        let drawn = close_up.series[..2]
            .iter()
            .flat_map(|series| &series.points);
        let drawn: Vec<[f64; 2]> = drawn.copied().collect();
        let computed: Vec<[f64; 2]> = BRANCHES
            .iter()
            .flat_map(|(branch, ..)| curve(&cycle, *branch))
            .map(|[indentation, value]| [unit.of(indentation), force.of(value)])
            .collect();
        assert_eq!(drawn, computed);
        let top = close_up.y.range.unwrap()[1];
        assert!(top < 1.2 * force.of(pull_off.force.abs()), "{top}");
    }
}
