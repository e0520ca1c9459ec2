//! The figures of the paper, from the computed numbers.

use crate::analysis::{PowerLaw, Quantity};
use crate::claims::{LAW_RANGES, percent};
use crate::grid::Critical;
use crate::grid::{Grid, OFFSETS, Substrate, system};
use crate::states::{Approach, PAST, SHARES, States};
use fakir::problem::Method;
use fakir::state::{ContactState, Normalized, Run, SolveError};
use fakir::theory::closed_forms;
use fakir::theory::closed_forms::Form;
use fakir::theory::lattice_sums::SumFit;
use fakir_case::CaseError;
use fakir_figure::{
    Axis, CriticalColumn, CriticalCurve, CriticalPoint, Dash, Figure, FigureError, LineChart,
    Measured, PhaseDiagram, ProfileState, Series, Style, Text, Tint, View, critical_curves,
    floor_gap_map, floor_pressure_map, lattice_sums, lines, phase_diagram, phase_point,
    pillar_pressure, pressure_map, profiles, top_view,
};
use fakir_study::closed_forms::touches_one_pillar;
use rayon::prelude::*;

/// Errors of a figure.
#[derive(Debug, thiserror::Error)]
pub enum DrawingError {
    /// An invalid system.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// A contact that could not be computed.
    #[error(transparent)]
    Solve(#[from] SolveError),
    /// A figure that cannot be drawn.
    #[error(transparent)]
    Figure(#[from] FigureError),
}

/// Data of the figures.
#[derive(Clone, Copy)]
pub struct Material<'a> {
    /// The critical states of the sweep.
    pub grid: &'a Grid,
    /// Single states.
    pub states: &'a States,
    /// The fit of the lattice sums.
    pub fit: &'a SumFit,
    /// Measured points of the user.
    pub measured: &'a [(Substrate, Measured)],
}

/// A figure with its caption.
#[derive(Debug, Clone)]
pub struct Plate {
    /// The figure.
    pub figure: Figure,
    /// Caption.
    pub caption: String,
}

impl Plate {
    pub(crate) fn new(figure: Figure, name: &str, title: &str, caption: &str) -> Self {
        Self {
            figure: figure.named(name).with_description(title, caption),
            caption: caption.to_owned(),
        }
    }
}

type Draw<'a> = Box<dyn Fn() -> Result<Vec<Plate>, DrawingError> + Send + Sync + 'a>;

/// All figures, in the order of the report.
///
/// # Errors
/// [`DrawingError`]
pub fn plates(material: &Material<'_>, run: &Run<'_>) -> Result<Vec<Plate>, DrawingError> {
    // Threads share the figures; each figure is drawn by one thread.
    let single = Run {
        pool: None,
        ..run.clone()
    };
    let m = *material;
    let single = &single;
    let mut parts: Vec<Draw<'_>> = vec![
        Box::new(move || Ok(vec![curves(m)?])),
        Box::new(move || Ok(vec![power_laws(m)])),
        Box::new(move || Ok(vec![phases(m)?])),
        Box::new(move || Ok(vec![sums(m)])),
    ];
    for (substrate, approach) in &m.states.approaches {
        parts.push(Box::new(move || {
            Ok(vec![section(*substrate, approach, single)?])
        }));
    }
    let dense = &m.states.dense;
    parts.push(Box::new(move || {
        let map = pressure_map(&dense.contact, Some(dense.floor_contact))?;
        let caption = format!(
            "Mean pressure on every pillar top in the critical state, intermediate substrate, \
             {}: dashed the edge of the contact, crosses the floor contact in all its symmetric \
             places. Beside it, pressure at the centre of every pillar against its distance from the \
             axis, with a Hertzian distribution.",
            fraction_label(&dense.contact)
        );
        Ok(vec![Plate::new(
            map,
            "pressure-map",
            "Pressure on all pillar tops in the critical state",
            &caption,
        )])
    }));
    parts.push(Box::new(move || {
        let figure = pillar_pressure(&dense.contact, single)?;
        let caption = format!(
            "Pressure inside the top of the central pillar and of one at the rim of the contact, \
             intermediate substrate, {}. At the edge of a covered pillar top the pressure is \
             infinite; the maps are cut off.",
            fraction_label(&dense.contact)
        );
        Ok(vec![Plate::new(
            figure,
            "pillar-pressure",
            "Pressure within the tops of two pillars",
            &caption,
        )])
    }));
    let mixed = &m.states.mixed;
    parts.push(Box::new(move || mixed_contact(mixed, single)));
    if let Some(approach) = m.states.intermediate() {
        let contact = &approach.critical.contact;
        parts.push(Box::new(move || {
            let caption = format!(
                "Gap between lens and floor in the critical state, intermediate substrate, {}; \
                 pillars in grey. The lens touches the floor at the marked places.",
                fraction_label(contact)
            );
            let figure = floor_gap_map(contact, single)?;
            Ok(vec![Plate::new(
                figure,
                "floor-gap",
                "Gap between lens and floor in the critical state",
                &caption,
            )])
        }));
        for (state, view, name, title, words) in [
            (
                &approach.middle,
                View::Contact,
                "top-view-before",
                "Contact from above before the transition",
                "under 0.3 of the critical force",
            ),
            (
                contact,
                View::Contact,
                "top-view-critical",
                "Contact from above in the critical state",
                "in the critical state",
            ),
            (
                contact,
                View::GREEN,
                "newton-rings",
                "Interference fringes in the critical state",
                "in the critical state, with the interference of green light (550 nm)",
            ),
        ] {
            parts.push(Box::new(move || {
                let caption = format!(
                    "The contact as seen in a reflection microscope {words}, intermediate \
                     substrate, {}: contact spots are dark.",
                    fraction_label(state)
                );
                let figure = top_view(state, view, single)?;
                Ok(vec![Plate::new(figure, name, title, &caption)])
            }));
        }
    }
    let draw = || -> Result<Vec<Vec<Plate>>, DrawingError> {
        parts.par_iter().map(|part| part()).collect()
    };
    let plates = match run.pool {
        Some(pool) => pool.install(draw)?,
        None => parts.iter().map(|part| part()).collect::<Result<_, _>>()?,
    };
    Ok(plates.into_iter().flatten().collect())
}

/// The surface fraction of a state as a label: `φ = 0.1`.
fn fraction_label(state: &ContactState) -> String {
    format!("φ = {:.3}", state.system.pattern().surface_fraction())
}

fn point(state: &Critical) -> CriticalPoint {
    CriticalPoint {
        surface_fraction: state.surface_fraction,
        reduced: normalized(state),
    }
}

fn normalized(state: &Critical) -> Normalized {
    Normalized {
        force: state.normalized_force,
        contact_radius: state.normalized_contact_radius,
        indentation: state.normalized_indentation,
    }
}

fn offset_label(offset: usize) -> Text {
    Text::from(format!("*δx*/*e* = {}", OFFSETS[offset].1))
}

/// Critical force, radius and indentation over the surface fraction, all offsets and substrates.
fn curves(material: Material<'_>) -> Result<Plate, DrawingError> {
    let titles = [
        "rigid, *E*_{s} = 1 GPa",
        "intermediate, *E*_{s} = 2 MPa",
        "soft, *E*_{s} = 2 kPa",
    ];
    let mut columns = Vec::new();
    for (substrate, title) in Substrate::ALL.into_iter().zip(titles) {
        let mut curves: Vec<CriticalCurve> = material
            .grid
            .of(substrate)
            .map(|curve| CriticalCurve {
                label: offset_label(curve.offset),
                points: curve.states.iter().map(point).collect(),
                style: Style::line(curve.offset),
            })
            .collect();
        curves.extend(models(material.grid, substrate)?);
        columns.push(CriticalColumn {
            title: Text::from(title),
            curves,
            measured: material
                .measured
                .iter()
                .filter(|(other, _)| *other == substrate)
                .map(|(_, measured)| *measured)
                .collect(),
        });
    }
    Ok(Plate::new(
        critical_curves(&columns),
        "critical-curves",
        "Critical force, contact radius and indentation over the surface fraction",
        "Reduced critical force, contact radius and indentation against the surface fraction, for \
         six positions of the lens axis and three substrates; with the paper's formulas for \
         small and large contacts as printed, and the homogenised lattice. Where a curve has no \
         force, the lens meets the floor before any pillar.",
    ))
}

/// The paper's formulas and the homogenised lattice, at the surface fractions of the sweep.
fn models(grid: &Grid, substrate: Substrate) -> Result<Vec<CriticalCurve>, DrawingError> {
    let (mut small, mut large, mut homogenised) = (Vec::new(), Vec::new(), Vec::new());
    for state in &grid.on_pillar(substrate).states {
        let system = system(substrate, 0.0, state.surface_fraction)?;
        if touches_one_pillar(&system) {
            let estimate = closed_forms::small_contact(&system);
            small.push(CriticalPoint::of_estimate(&system, &estimate));
            continue;
        }
        let estimate = closed_forms::large_contact(&system, Form::AsPrinted);
        large.push(CriticalPoint::of_estimate(&system, &estimate));
        let run = Run::default();
        match fakir::transition(&system, Method::Homogenised, &run) {
            Ok(critical) => homogenised.push(CriticalPoint::from(&critical)),
            Err(SolveError::PatternTooDense { .. }) => {}
            Err(error) => return Err(error.into()),
        }
    }
    let curve = |label: &str, points, style| CriticalCurve {
        label: Text::from(label),
        points,
        style,
    };
    let formula = Style::line(0).in_tint(Tint::Grey);
    Ok(vec![
        curve(
            "formula, small contact",
            small,
            formula.with_line(Dash::Solid),
        ),
        curve(
            "formula, large contact",
            large,
            formula.with_line(Dash::Dashed),
        ),
        curve(
            "homogenised lattice",
            homogenised,
            formula.in_tint(Tint::Black).with_line(Dash::Dotted),
        ),
    ])
}

/// Power laws on the intermediate substrate.
fn power_laws(material: Material<'_>) -> Plate {
    let curve = material.grid.on_pillar(Substrate::Intermediate);
    let points: Vec<[f64; 2]> = curve
        .states
        .iter()
        .map(|state| [state.surface_fraction, 1e6 * state.force])
        .collect();
    let mut series = vec![Series::new(
        "computed",
        points,
        Style::marks(4).in_tint(Tint::Sky),
    )];
    // Drawn over the markers, so that both are visible.
    let lines_over_marks = [
        Style::line(0).in_tint(Tint::Black),
        Style::line(0).in_tint(Tint::Vermillion),
    ];
    for (k, range) in LAW_RANGES.into_iter().enumerate() {
        let Some(law) = PowerLaw::of(curve, Quantity::Force, range) else {
            continue;
        };
        let ends = law.range.map(|phi| [phi, 1e6 * law.at(phi)]);
        let label = format!(
            "*F*_{{c}} ~ *φ*^{{{:.2}}}, deviation up to {}",
            law.exponent,
            percent(law.largest_deviation)
        );
        series.push(Series::new(label, ends.to_vec(), lines_over_marks[k % 2]));
    }
    let figure = lines(&LineChart {
        x: Axis::logarithmic("surface fraction *φ*"),
        y: Axis::logarithmic("critical force *F*_{c} (µN)"),
        series,
    });
    Plate::new(
        figure,
        "power-laws",
        "Critical force over the surface fraction, with power laws",
        "Critical force on the intermediate substrate, lens axis on a pillar, with power laws fitted \
         by least squares over two ranges of the surface fraction, and the largest deviation of the \
         curve from them: no single exponent applies.",
    )
}

/// Line styles of loading paths, different from those of the transition curve and the markers.
const PATHS: [Style; 2] = [
    Style {
        tint: Tint::Vermillion,
        line: Some(Dash::Solid),
        marker: None,
    },
    Style {
        tint: Tint::Green,
        line: Some(Dash::Dashed),
        marker: None,
    },
];

fn phases(material: Material<'_>) -> Result<Plate, DrawingError> {
    let critical = material
        .grid
        .of(Substrate::Intermediate)
        .map(|curve| {
            let points = curve.states.iter().map(|state| {
                [
                    state.top_contact_radius / state.pitch,
                    state.normalized_force,
                ]
            });
            Series::new(
                Text::from("critical, ").followed_by(offset_label(curve.offset)),
                points.collect::<Vec<_>>(),
                Style::marks(curve.offset),
            )
        })
        .collect();
    let paths = material
        .states
        .loadings
        .iter()
        .enumerate()
        .map(|(k, loading)| {
            let past = material.states.shared.iter();
            let past =
                past.filter(|s| (s.surface_fraction - loading.surface_fraction).abs() < 1e-12);
            let states = loading
                .states
                .iter()
                .chain(past.map(|shared| &shared.state));
            let points = states.map(|s| phase_point(&s.system, s.force, s.contact_radius));
            let label = format!("loading, *φ* = {}", loading.surface_fraction);
            let style = PATHS[k % PATHS.len()];
            Series::new(label, points.collect::<Vec<_>>(), style)
        })
        .collect();
    let shares = SHARES.into_iter().enumerate().map(|(k, share)| {
        let states = material.states.shared.iter();
        let states = states.filter(|shared| (shared.share - share).abs() < 1e-12);
        let points = states
            .map(|shared| &shared.state)
            .map(|s| phase_point(&s.system, s.force, s.contact_radius));
        let points = points.collect::<Vec<_>>();
        let label = format!("{:.0} % of *F* on the floor", 100.0 * share);
        let style = Style::line(k + 2).in_tint(Tint::Grey);
        Series::new(label, points, style)
    });
    let shares = shares.collect();
    let figure = phase_diagram(&PhaseDiagram {
        system: system(Substrate::Intermediate, 0.0, 0.01)?,
        critical,
        paths,
        shares,
    });
    Ok(Plate::new(
        figure,
        "phase-diagram",
        "Phase diagram: reduced force over the contact radius",
        "Reduced force against the radius of the contact on the pillar tops in pitches, \
         intermediate substrate: where the lens \
         rests on pillar tops only and where it touches the floor too, with the paper's transition \
         curve, computed critical states of six offsets, and two loading paths, of which that at the \
         smaller surface fraction continues into mixed contact. Grey lines join states in which the floor \
         carries the same fraction of the load. Below one pitch the state depends on the position of the lens axis.",
    ))
}

/// The contact past the transition: from above, in section, and the pressure on the floor.
fn mixed_contact(state: &ContactState, run: &Run<'_>) -> Result<Vec<Plate>, DrawingError> {
    let where_and_when = format!(
        "intermediate substrate, {}, at {PAST} times the critical indentation",
        fraction_label(state)
    );
    let section = ProfileState {
        label: Text::from("mixed contact"),
        state,
        floor_contact: None,
    };
    let plate = |figure: Figure, name: &str, title: &str, caption: String| {
        Plate::new(figure, name, title, &caption)
    };
    Ok(vec![
        plate(
            top_view(state, View::Contact, run)?,
            "top-view-mixed",
            "Mixed contact from above",
            format!(
                "The contact past the transition as seen from above, {where_and_when}: contact on \
                 pillar tops dark, on the floor grey. It is what figure 2b of the paper sketches."
            ),
        ),
        plate(
            profiles(&[section], run)?,
            "profiles-mixed",
            "Mixed contact in section",
            format!(
                "Section along x through the lens axis, {where_and_when}: the floor in contact is red."
            ),
        ),
        plate(
            floor_pressure_map(state)?,
            "floor-pressure-map",
            "Pressure on the floor",
            format!(
                "Pressure on the floor, {where_and_when}: around every pillar the floor is not in contact."
            ),
        ),
    ])
}

fn sums(material: Material<'_>) -> Plate {
    Plate::new(
        lattice_sums(material.fit, material.fit.range[1]),
        "lattice-sums",
        "Lattice sums over the contact radius",
        "The lattice sums G0, G and G1 against the contact radius in pitches, with a least-squares fit, the \
         coefficients of the paper, the limits of wide contacts, and the relative error of the fit.",
    )
}

fn section(
    substrate: Substrate,
    approach: &Approach,
    run: &Run<'_>,
) -> Result<Plate, DrawingError> {
    let state = |label: &str, state, floor_contact| ProfileState {
        label: Text::from(label),
        state,
        floor_contact,
    };
    let critical = &approach.critical;
    let states = [
        state("before contact", &approach.before, None),
        state("0.3 of the critical force", &approach.middle, None),
        state(
            "critical state",
            &critical.contact,
            Some(critical.floor_contact),
        ),
    ];
    let caption = format!(
        "Section through lens and substrate along x before and at the critical state, {} substrate, \
         {}. The vertical scale is exaggerated as stated.",
        substrate.name(),
        fraction_label(&critical.contact)
    );
    Ok(Plate::new(
        profiles(&states, run)?,
        &format!("profiles-{}", substrate.name()),
        "Section through the deformed lens and substrate",
        &caption,
    ))
}
