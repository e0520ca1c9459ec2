//! Every kind of figure, and what holds for all of them.

use crate::samples::{self, system};
use crate::{
    Axis, CriticalColumn, CriticalCurve, CriticalPoint, CriticalStateCurve, CriticalStatePoint,
    DesignedCurve, DesignedQuantity, DesignedValues, Figure, FittedCurve, FittedLoad,
    FittedParameter, FittedPoint, FittedQuantity, FittedValue, Histogram, HistoryPoint,
    LateralModel, LateralPoint, LineChart, LoadingPoint, PhaseDiagram, ProfileState, PullOffCurve,
    PullOffPoint, Series, Style, SurfaceState, Text, View,
};
use fakir::problem::pattern::{Pattern, PillarShape};
use fakir::problem::{
    Accuracy, Adhesion, Asperity, AsperityArray, Boundary, CyclePlan, FlatSystem, Floor, Grid,
    HexagonalLattice, Indenter, Lens, Load, Material, Method, SurfaceSystem, UnloadingPoint,
};
use fakir::state::{Normalized, Run};
use fakir::theory::lattice_sums::SumFit;
use std::collections::BTreeSet;

const RUBBER: Material = Material {
    young_modulus: 2e6,
    poisson_ratio: 0.5,
};

/// Figures with the names of the functions that draw them.
type Drawn = Vec<(&'static str, Figure)>;

/// Figures of states of a patterned system: at the transition, and past it.
fn of_states() -> Drawn {
    let run = Run::default();
    let lattice = HexagonalLattice::with_surface_fraction(0.01, samples::DIAMETER);
    let system = system(lattice);
    let critical = fakir::transition(&system, Method::default(), &run).unwrap();
    let past = Load::Force(1.5 * critical.contact.force);
    let past = fakir::press(&system, past, Method::default(), &run).unwrap();
    let (state, floor_contact) = (&critical.contact, Some(critical.floor_contact));
    let section = |state, floor_contact| ProfileState {
        label: Text::from("state"),
        state,
        floor_contact,
    };
    let sections = [section(state, floor_contact), section(&past, None)];
    vec![
        ("profiles", crate::profiles(&sections, &run).unwrap()),
        (
            "pressure_map",
            crate::pressure_map(state, floor_contact).unwrap(),
        ),
        ("pressure_map", crate::pressure_map(&past, None).unwrap()),
        (
            "pillar_pressure",
            crate::pillar_pressure(state, &run).unwrap(),
        ),
        ("floor_gap_map", crate::floor_gap_map(state, &run).unwrap()),
        ("floor_gap_map", crate::floor_gap_map(&past, &run).unwrap()),
        (
            "floor_pressure_map",
            crate::floor_pressure_map(&past).unwrap(),
        ),
        (
            "top_view",
            crate::top_view(&past, View::Contact, &run).unwrap(),
        ),
        (
            "top_view",
            crate::top_view(state, View::GREEN, &run).unwrap(),
        ),
    ]
}

fn of_cycles() -> Drawn {
    let run = Run::default();
    let lattice = HexagonalLattice::with_surface_fraction(0.003, samples::DIAMETER);
    let sticky = system(lattice).with_adhesion(Adhesion::new(50e-3)).unwrap();
    let plan = CyclePlan::default();
    let cycle = fakir::cycle(&sticky, plan, Method::default(), &run).unwrap();
    let lens = Lens {
        radius: 2.2e-3,
        material: RUBBER,
    };
    let flat = FlatSystem::new(lens, RUBBER).unwrap();
    let flat = flat.with_adhesion(Adhesion::new(50e-3)).unwrap();
    let contact = flat.press(Load::Indentation(2e-6), &run).unwrap();
    let distances: Vec<f64> = (0..50)
        .map(|k| contact.contact_radius * f64::from(k) / 50.0)
        .collect();
    let pressures = flat.pressure(&contact, &distances);
    let plan = CyclePlan {
        turn: UnloadingPoint::Indentation(2e-6),
        ..plan
    };
    let flat_cycle = flat.cycle(&plan, &run).unwrap();
    vec![
        ("cycle_curve", crate::cycle_curve(&cycle).unwrap()),
        ("release_map", crate::release_map(&cycle).unwrap()),
        (
            "flat_pressure",
            crate::flat_pressure(&contact, &distances, &pressures).unwrap(),
        ),
        ("flat_cycle", crate::flat_cycle(&flat_cycle).unwrap()),
    ]
}

fn of_surfaces() -> Drawn {
    let run = Run::default();
    let lens = Lens {
        radius: 1e-3,
        material: RUBBER,
    };
    let pillar = PillarShape::cylinder(6e-6, 0.5e-6);
    let pattern = Pattern::new(pillar, HexagonalLattice::new(16e-6));
    let grid = Grid::centred(64, 64, 1e-6).unwrap();
    let surface = pattern.height_map(&grid, &RUBBER).unwrap();
    let surface = SurfaceSystem::new(lens.into(), RUBBER, surface, Boundary::FreeSpace)
        .unwrap()
        .with_floor(Floor::OffPillars);
    let contact = surface.press(Load::Indentation(3e-7), &run).unwrap();
    let state = SurfaceState {
        label: Text::from("contact"),
        system: &surface,
        contact: &contact,
        floor_contact: Some([8e-6, 0.0]),
    };
    let asperities = (0..4u32).map(|k| {
        let apex = [1e-4 * f64::from(k % 2), 1e-4 * f64::from(k / 2)];
        Asperity::new(apex, 1e-4).raised_by(-4e-7 * f64::from(k))
    });
    let field = AsperityArray::new(Indenter::Flat(None), RUBBER, asperities.collect()).unwrap();
    let load = Load::Indentation(1e-6);
    let pressed = field.press_quickly(load, Accuracy::Default, None, &run);
    let adhesive = field.clone().with_adhesion(Adhesion::new(20e-3)).unwrap();
    let plan = CyclePlan {
        turn: UnloadingPoint::Indentation(1e-6),
        ..CyclePlan::default()
    };
    let cycle = adhesive.cycle(plan, Accuracy::Default, &run).unwrap();
    let adhesive = surface.clone().with_adhesion(Adhesion::new(5e-3)).unwrap();
    let plan = CyclePlan {
        turn: UnloadingPoint::Indentation(2e-7),
        ..plan
    };
    let on_cells = adhesive.cycle(plan, &run).unwrap();
    vec![
        ("surface_cycle", crate::surface_cycle(&on_cells).unwrap()),
        (
            "asperity_cycle_curve",
            crate::asperity_cycle_curve(&cycle).unwrap(),
        ),
        (
            "surface_profiles",
            crate::surface_profiles(std::slice::from_ref(&state)).unwrap(),
        ),
        (
            "surface_pressure_map",
            crate::surface_pressure_map(&state).unwrap(),
        ),
        ("surface_gap_map", crate::surface_gap_map(&state).unwrap()),
        (
            "asperity_map",
            crate::asperity_map(&field, &pressed.unwrap()),
        ),
    ]
}

/// Charts of numbers that are in no order and leave the frames that can be given.
fn of_numbers() -> Drawn {
    let wild = |k: u32| 10f64.powf(4.0 * (1.7 * f64::from(k)).sin());
    let loading = (0..20).map(|k| LoadingPoint {
        indentation: 1e-7 * f64::from(k),
        force: 1e-6 * wild(k),
        floor_force: Some(1e-7 * wild(k)),
        contact_radius: Some(1e-5 * wild(k + 1)),
        pillars: Some([k as usize, 1]),
        without_floor: k > 15,
    });
    let loading: Vec<LoadingPoint> = loading.collect();
    let over_time = (0..20).map(|k| HistoryPoint {
        time: 40.0 * f64::from(k),
        indentation: 1e-6 * wild(k + 2),
        force: 1e-6 * wild(k),
        contact_radius: Some(1e-5 * wild(k + 1)),
        floor_share: Some(1e-2 * wild(k)),
    });
    let over_time: Vec<HistoryPoint> = over_time.collect();
    let critical = |k: u32| CriticalPoint {
        surface_fraction: 0.001 * f64::from(k + 1),
        reduced: Normalized {
            force: wild(k),
            contact_radius: wild(k + 1),
            indentation: wild(k + 2),
        },
    };
    let column = CriticalColumn {
        curves: vec![CriticalCurve {
            label: Text::from("curve"),
            points: (0..20).map(critical).collect(),
            style: Style::line(0),
        }],
        ..CriticalColumn::default()
    };
    let designed = DesignedCurve {
        load: DesignedQuantity::Force,
        value: DesignedQuantity::Area,
        points: (1..20)
            .map(|k| DesignedValues {
                load: 1e-3 * f64::from(k),
                wanted: 1e-9 * f64::from(k),
                designed: 1e-9 * wild(k),
                scatter: Some(1e-10),
                ignored: 1e-9 * wild(k + 1),
            })
            .collect(),
    };
    let fitted = FittedCurve {
        quantity: FittedQuantity::Force,
        points: (0..20)
            .map(|k| FittedPoint {
                load: 1e-7 * f64::from(k),
                measured: 1e-6 * wild(k),
                computed: 1e-6,
                error: 1e-7,
                used: k < 15,
                unloading: k % 2 > 0,
            })
            .collect(),
        curve: vec![[0.0, 0.0], [1e-6, 1e-2]],
        unloading: vec![[0.0, -1e-2], [1e-6, 1e-2]],
    };
    let several = FittedParameter {
        name: "modulus".to_owned(),
        unit: "MPa".to_owned(),
        values: (0..20)
            .map(|k| FittedValue {
                curve: 1 + k as usize,
                value: wild(k),
                error: Some(1e3),
                outlier: k % 5 == 0,
            })
            .collect(),
        mean: Some([1.0, 1e3]),
    };
    let pull_off = PullOffCurve {
        label: Text::from("curve"),
        points: (0..20)
            .map(|k| PullOffPoint {
                x: f64::from(k),
                force: -wild(k),
                normalized_force: wild(k),
                hysteresis: wild(k + 1),
                normalized_hysteresis: wild(k + 2),
            })
            .collect(),
    };
    let swept = CriticalStateCurve {
        label: Text::from("curve"),
        points: (0..20)
            .map(|k| CriticalStatePoint {
                x: f64::from(k),
                force: wild(k),
                contact_radius: f64::NAN,
                indentation: wild(k + 1),
            })
            .collect(),
    };
    let points: Vec<[f64; 2]> = (0..60).map(|k| [f64::from(k), wild(k)]).collect();
    let errors = vec![[3.0, 1e3]; points.len()];
    let style = Style::marks(0).with_line(crate::Dash::Solid);
    let outside = Series::new("series", points.clone(), style).with_errors(errors);
    let lattice = HexagonalLattice::with_surface_fraction(0.01, samples::DIAMETER);
    let diagram = PhaseDiagram {
        system: system(lattice),
        critical: vec![Series::new("critical", points.clone(), Style::marks(0))],
        paths: vec![Series::new("loading", points.clone(), Style::line(1))],
        shares: vec![Series::new("share", points, Style::line(2))],
    };
    let laterals: Vec<LateralPoint> = (0..20)
        .map(|k| LateralPoint {
            force: f64::from(k),
            measured: wild(k),
            error: 1.0,
            used: k % 5 != 0,
        })
        .collect();
    let of_model: Vec<LateralModel> = (0..20)
        .map(|k| LateralModel {
            force: f64::from(k),
            tops: wild(k),
            floor: wild(k + 1),
        })
        .collect();
    let histogram = Histogram {
        label: Text::from("quantity (µN)"),
        unit: Text::from("µN"),
        values: (0..60).map(wild).collect(),
        percentiles: vec![5.0, 50.0, 95.0],
    };
    vec![
        (
            "approach",
            crate::approach(&loading, Some(loading[7])).unwrap(),
        ),
        ("history", crate::history(&over_time, Some(100.0)).unwrap()),
        ("critical_curves", crate::critical_curves(&[column])),
        (
            "critical_states",
            crate::critical_states(&Axis::linear("x"), &[swept]),
        ),
        ("designed_curve", crate::designed_curve(&designed)),
        (
            "fit_curves",
            crate::fit_curves(FittedLoad::Displacement, &[fitted], true),
        ),
        ("fits", crate::fits(&[several], 20, false)),
        ("lateral_force", crate::lateral_force(&laterals, &of_model)),
        (
            "pull_off_curves",
            crate::pull_off_curves(&Axis::linear("x"), &[pull_off]),
        ),
        (
            "lines",
            crate::lines(&LineChart {
                x: Axis::linear("x").over(10.0, 50.0),
                y: Axis::linear("y").over(1.0, 100.0),
                series: vec![outside],
            }),
        ),
        ("phase_diagram", crate::phase_diagram(&diagram)),
        ("histogram", crate::histogram(&histogram).unwrap()),
        (
            "lattice_sums",
            crate::lattice_sums(&SumFit::least_squares([1.0, 8.0], 30).unwrap(), 8.0),
        ),
    ]
}

fn every() -> Drawn {
    let parts = [of_states(), of_cycles(), of_surfaces(), of_numbers()];
    parts.into_iter().flatten().collect()
}

/// The names of the functions that draw figures, as `lib.rs` exports them.
fn exported() -> BTreeSet<&'static str> {
    let source = include_str!("lib.rs");
    let uses = source.split("pub use figures::").skip(1);
    let names = uses.flat_map(|part| {
        let (_, names) = part.split(';').next().unwrap().split_once("::").unwrap();
        names.split(|c: char| !(c.is_alphanumeric() || c == '_'))
    });
    let functions = names.filter(|name| name.starts_with(|c: char| c.is_ascii_lowercase()));
    // It returns a point, not a figure.
    functions.filter(|name| *name != "phase_point").collect()
}

/// Shapes of an SVG that are positioned by data and are in no group with a clip path.
fn unclipped(svg: &str) -> Vec<&str> {
    let mut clips = 0;
    let mut found = Vec::new();
    for line in svg.lines() {
        let is_shape = [
            "<path",
            "<circle",
            "<image",
            "<polyline",
            "<line ",
            "<polygon",
        ]
        .iter()
        .any(|shape| line.starts_with(shape));
        if line.starts_with("<g clip-path=") {
            clips += 1;
        } else if line.starts_with("</g>") {
            clips -= 1;
        } else if is_shape && clips == 0 && !line.contains(" class=\"fixed\"") {
            found.push(line);
        }
    }
    assert_eq!(clips, 0, "groups are closed");
    found
}

/// A curve, a marker, an error bar or a map that leaves its frame ends there: in every kind of figure, everything that is positioned by
/// data is in a group with a clip path.
#[test]
fn every_figure_clips_its_data() {
    let figures = every();
    let drawn: BTreeSet<&str> = figures.iter().map(|(name, _)| *name).collect();
    assert_eq!(drawn, exported(), "a kind of figure is not in this test");
    for (name, figure) in figures {
        let svg = figure.svg_for_page();
        assert_eq!(unclipped(&svg), Vec::<&str>::new(), "{name}");
        assert!(svg.contains("<g clip-path="), "{name} shows no data");
        assert_eq!(figure.faults(), Vec::<String>::new(), "{name}");
    }
}

/// Points outside the frame are neither drawn nor moved onto it: all places of the markers are those of points inside.
#[test]
fn markers_outside_the_frame_are_left_out() {
    let points = vec![
        [0.0, 5.0],
        [5.0, 5.0],
        [20.0, 5.0],
        [5.0, -3.0],
        [5.0, 1e30],
    ];
    let figure = crate::lines(&LineChart {
        x: Axis::linear("x").over(1.0, 10.0),
        y: Axis::linear("y").over(1.0, 10.0),
        series: vec![Series::unnamed(points, Style::marks(0))],
    });
    let svg = figure.svg_for_page();
    let marks = svg.lines().filter(|line| line.starts_with("<circle"));
    assert_eq!(marks.count(), 1);
}
