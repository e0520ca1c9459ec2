//! Checks of every figure: texts are on the page and do not overlap, another program renders the
//! SVG in the same way, and the PNG has the correct size.

#![allow(clippy::unwrap_used)]

use fakir::problem::pattern::{Pattern, PillarShape};
use fakir::problem::{
    Adhesion, Asperity, AsperityArray, Boundary, CyclePlan, Floor, Grid, HeightMap,
    HexagonalLattice, Indenter, Lens, Load, LoadingMode, Material, Method, Pillar,
    PillarCompliance, PillarPattern, SurfaceSystem, System, UnloadingPoint,
};
use fakir::state::{ContactState, CriticalState, Run};
use fakir::theory::closed_forms;
use fakir::theory::closed_forms::Form;
use fakir::theory::lattice_sums::SumFit;
use fakir_figure::{
    Axis, CriticalColumn, CriticalCurve, CriticalPoint, DesignedCurve, DesignedQuantity,
    DesignedValues, Figure, FigureError, FittedCurve, FittedLoad, FittedPoint, FittedQuantity,
    Histogram, LineChart, LoadingPoint, Measured, PhaseDiagram, ProfileState, RESOLUTION, Section,
    SectionDetail, Series, Style, SurfaceState, Text, View, approach, asperity_map,
    critical_curves, cycle_curve, designed_curve, fit_curves, floor_gap_map, floor_pressure_map,
    histogram, lattice_sums, lines, phase_diagram, phase_point, pillar_pressure, pressure_map,
    profiles, release_map, surface_gap_map, surface_pressure_map, surface_profiles, top_view,
};
use png::{ColorType, Decoder};
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{self, Node, fontdb};
use std::sync::Arc;

fn system(modulus: f64, surface_fraction: f64, offset: f64) -> System {
    let pillar = Pillar {
        diameter: 6e-6,
        height: 2.2e-6,
        compliance: PillarCompliance::Column,
    };
    let lattice = HexagonalLattice::with_surface_fraction(surface_fraction, pillar.diameter);
    let lens = Lens {
        radius: 2.2e-3,
        material: Material::new(2e6, 0.5),
    };
    let pattern = PillarPattern::new(pillar, lattice.offset_by(offset));
    System::new(lens, Material::new(modulus, 0.5), pattern).unwrap()
}

fn transition(system: &System, method: Method) -> CriticalState {
    fakir::transition(system, method, &Run::default()).unwrap()
}

fn press(system: &System, force: f64) -> ContactState {
    let load = Load::Force(force);
    fakir::press(system, load, Method::default(), &Run::default()).unwrap()
}

/// Figures of one critical state.
fn figures_of(critical: &CriticalState) -> Vec<Figure> {
    let (state, run) = (&critical.contact, Run::default());
    let middle = press(&state.system, 0.4 * state.force);
    let before = press(&state.system, 0.0);
    let profile = |label: &str, state, floor_contact| ProfileState {
        label: Text::from(label),
        state,
        floor_contact,
    };
    vec![
        pressure_map(state, Some(critical.floor_contact)).unwrap(),
        pillar_pressure(state, &run).unwrap(),
        floor_gap_map(state, &run).unwrap(),
        top_view(state, View::Contact, &run).unwrap(),
        top_view(state, View::GREEN, &run).unwrap(),
        profiles(
            &[
                profile("before contact", &before, None),
                profile("mid load", &middle, None),
                profile("critical state", state, Some(critical.floor_contact)),
            ],
            &run,
        )
        .unwrap(),
    ]
}

fn curve(modulus: f64, offset: f64, style: Style) -> CriticalCurve {
    let points = [5e-4, 2e-3, 6e-3, 0.02]
        .iter()
        .map(|phi| {
            CriticalPoint::from(&transition(
                &system(modulus, *phi, offset),
                Method::default(),
            ))
        })
        .collect();
    CriticalCurve {
        label: Text::from(format!("*δx*/*e* = {offset:.2}")),
        points,
        style,
    }
}

fn column(modulus: f64) -> CriticalColumn {
    let mut curves: Vec<CriticalCurve> = [0.0, 1.0 / 3.0, 0.866_025_403_784_438_6]
        .iter()
        .enumerate()
        .map(|(k, offset)| curve(modulus, *offset, Style::marks(k)))
        .collect();
    let printed = (1..40)
        .map(|k| {
            let system = system(modulus, 5e-4 * 1.12f64.powi(k), 0.0);
            let estimate = closed_forms::large_contact(&system, Form::AsPrinted);
            CriticalPoint::of_estimate(&system, &estimate)
        })
        .collect();
    curves.push(CriticalCurve {
        label: Text::from("closed form"),
        points: printed,
        style: Style::line(4),
    });
    CriticalColumn {
        title: Text::from(format!("*E*_{{s}} = {modulus} Pa")),
        curves,
        measured: vec![Measured {
            surface_fraction: [0.01, 1e-3],
            force: Some([6.0, 7.0]),
            contact_radius: None,
            indentation: Some([1.3, 0.1]),
        }],
    }
}

fn figures_of_many_states() -> Vec<Figure> {
    let intermediate = column(2e6);
    let dense = system(2e6, 0.1, 0.0);
    let diagram = PhaseDiagram {
        system: system(2e6, 0.01, 0.0),
        critical: vec![Series::new(
            "critical",
            vec![phase_point(&dense, 4.4e-3, 199e-6)],
            Style::marks(0),
        )],
        paths: vec![Series::new(
            "loading",
            vec![[0.1, 0.01], [0.8, 0.5], [2.0, 4.0]],
            Style::line(1),
        )],
        shares: Vec::new(),
    };
    vec![
        critical_curves(std::slice::from_ref(&intermediate)),
        critical_curves(&[column(1e9), intermediate, column(2e3)]),
        phase_diagram(&diagram),
        lattice_sums(&SumFit::least_squares([1.0, 16.0], 50).unwrap(), 16.0),
        histogram(&Histogram {
            label: Text::from("critical force *F*_{c} (µN)"),
            unit: Text::from("µN"),
            values: (0..500)
                .map(|k| 90.0 + (f64::from(k) * 0.37).sin())
                .collect(),
            percentiles: vec![5.0, 50.0, 95.0],
        })
        .unwrap(),
        fit_curves(
            FittedLoad::Displacement,
            &[fitted(FittedQuantity::Force)],
            true,
        )
        .named("fit-force"),
        fit_curves(
            FittedLoad::Force,
            &[FittedQuantity::Force, FittedQuantity::ContactRadius].map(fitted),
            true,
        ),
        fit_curves(
            FittedLoad::Displacement,
            &[fitted(FittedQuantity::Force)],
            false,
        )
        .named("fit-misfit"),
    ]
}

/// Contacts on cells: a lens on the pillars of a free surface at its critical state, a plate on a
/// period that is not square, and a lens with a very small contact on a rough map.
fn figures_of_surfaces() -> Vec<Figure> {
    let rubber = Material::new(2e6, 0.5);
    let lens = Indenter::from(Lens {
        radius: 1e-3,
        material: rubber,
    });
    let pillar = PillarShape::cylinder(6e-6, 0.5e-6);
    let lattice = HexagonalLattice::new(16e-6);
    let pattern = Pattern::new(pillar, lattice);
    let grid = Grid::centred(128, 128, 1e-6).unwrap();
    let surface = pattern.height_map(&grid, &rubber).unwrap();
    let free = SurfaceSystem::new(lens.clone(), rubber, surface, Boundary::FreeSpace)
        .unwrap()
        .with_floor(Floor::OffPillars);
    let critical = free.transition(&Run::default()).unwrap();

    let period = pattern.period().unwrap();
    let grid = Grid::new(
        32,
        56,
        [period[0] / 32.0, period[1] * 2.0 / 56.0],
        [-8e-6, -8e-6],
    );
    let surface = pattern
        .periodic_height_map(&grid.unwrap(), &rubber)
        .unwrap();
    let plate = Indenter::Flat(None);
    let plate = SurfaceSystem::new(plate, rubber, surface, Boundary::Periodic).unwrap();
    let pressed = plate.press(Load::Force(3e-5), &Run::default()).unwrap();

    let grid = Grid::centred(64, 64, 1e-6).unwrap();
    let waves = |[x, y]: [f64; 2]| 1e-7 * ((4e5 * x).sin() + (3e5 * y).cos());
    let rough = HeightMap::from_height(grid, waves).unwrap();
    let rough = SurfaceSystem::new(lens, rubber, rough, Boundary::FreeSpace).unwrap();
    let touched = rough
        .press(Load::Indentation(1e-8), &Run::default())
        .unwrap();

    let state = |system, contact, floor_contact| SurfaceState {
        label: Text::plain("contact"),
        system,
        contact,
        floor_contact,
    };
    let floor_contact = Some(critical.floor_contact);
    [
        state(&free, &critical.contact, floor_contact),
        state(&plate, &pressed, None),
        state(&rough, &touched, None),
    ]
    .iter()
    .flat_map(|state| {
        let profiles = surface_profiles(std::slice::from_ref(state)).unwrap();
        let pressure = surface_pressure_map(state).unwrap();
        [profiles, pressure, surface_gap_map(state).unwrap()]
    })
    .collect()
}

/// Loadings with and without a contact radius, up to the critical state, past it, and ending before it.
fn figures_of_loadings() -> Vec<Figure> {
    let point = |indentation: f64| LoadingPoint {
        indentation,
        force: 1e3 * indentation.powf(1.5),
        floor_force: None,
        contact_radius: Some((1e-3 * indentation).sqrt()),
        pillars: Some([(2e6 * indentation) as usize, 1]),
        without_floor: indentation > 4.2e-6,
    };
    let path = |last: i32| -> Vec<LoadingPoint> {
        (0..=last).map(|k| point(0.5e-6 * f64::from(k))).collect()
    };
    let on_plate = |point: LoadingPoint| LoadingPoint {
        contact_radius: None,
        floor_force: Some((point.force - 5e-6).max(0.0)),
        pillars: None,
        without_floor: false,
        ..point
    };
    let plate: Vec<LoadingPoint> = path(10).into_iter().map(on_plate).collect();
    let with_floor = |point: LoadingPoint| LoadingPoint {
        pillars: point.pillars,
        contact_radius: point.contact_radius,
        ..on_plate(point)
    };
    let pattern: Vec<LoadingPoint> = path(12).into_iter().map(with_floor).collect();
    let critical = Some(point(4.2e-6));
    vec![
        approach(&path(8), critical).unwrap(),
        approach(&path(12), critical).unwrap(),
        approach(&path(3), critical).unwrap(),
        approach(&plate, critical.map(on_plate)).unwrap(),
        approach(&plate, None).unwrap(),
        approach(&pattern, critical.map(with_floor)).unwrap(),
    ]
}

/// Points on a line, one of them past the transition.
fn fitted(quantity: FittedQuantity) -> FittedCurve {
    let point = |k: i32| FittedPoint {
        load: 1e-7 * f64::from(k),
        measured: 2e-6 * f64::from(k) + 3e-7 * f64::from(k).sin(),
        computed: 2e-6 * f64::from(k),
        error: 2e-7,
        used: k < 15,
        unloading: false,
    };
    FittedCurve {
        quantity,
        points: (-2..16).map(point).collect(),
        curve: vec![[-2e-7, -4e-6], [1.4e-6, 2.8e-5]],
        unloading: Vec::new(),
    }
}

fn charts_of_odd_data() -> Vec<Figure> {
    let chart = |x: Axis, y: Axis, points: Vec<[f64; 2]>| {
        let series = vec![
            Series::new(
                Text::plain("a < b & \"c\" *_{}\u{1}"),
                points.clone(),
                Style::line(0),
            ),
            Series::new("again", points, Style::marks(1)),
        ];
        lines(&LineChart { x, y, series })
    };
    let (linear, logarithmic) = (Axis::linear("*x* (µm)"), Axis::logarithmic("*y*"));
    vec![
        chart(linear.clone(), logarithmic.clone(), Vec::new()),
        chart(linear.clone(), logarithmic.clone(), vec![[1.0, 3e-9]]),
        chart(linear.clone(), linear.clone(), vec![[0.0, 0.0]]),
        chart(
            logarithmic.clone(),
            logarithmic.clone(),
            vec![
                [1.0, f64::NAN],
                [2.0, -1.0],
                [0.0, 5.0],
                [4.0, f64::INFINITY],
            ],
        ),
        chart(
            linear.clone(),
            linear.clone(),
            (0..300)
                .map(|k| [f64::from(k), (f64::from(k) * 1.7).sin() * 1e-7])
                .collect(),
        ),
        chart(
            logarithmic,
            linear,
            (0..40)
                .map(|k| [10f64.powi(k - 20), f64::from(k) * 1e7])
                .collect(),
        ),
    ]
}

/// The figure in another program, with its own fonts and without those of the system.
fn parsed(svg: &str) -> usvg::Tree {
    let mut fonts = fontdb::Database::new();
    for face in ["Regular", "Italic"] {
        let path = format!(
            "{}/../crates/fakir-figure/fonts/Roboto-{face}-subset.ttf",
            env!("CARGO_MANIFEST_DIR")
        );
        fonts.load_font_data(std::fs::read(path).unwrap());
    }
    let options = usvg::Options {
        fontdb: Arc::new(fonts),
        ..usvg::Options::default()
    };
    usvg::Tree::from_str(svg, &options).unwrap()
}

fn texts(group: &usvg::Group, boxes: &mut Vec<(String, usvg::Rect)>) {
    for node in group.children() {
        match node {
            Node::Group(group) => texts(group, boxes),
            Node::Text(text) => {
                let words = text.chunks().iter().map(usvg::TextChunk::text).collect();
                boxes.push((words, text.abs_bounding_box()));
            }
            _ => {}
        }
    }
}

/// All text is on the page in the layout of the other program.
fn assert_text_on_page(figure: &Figure, tree: &usvg::Tree) {
    let mut boxes = Vec::new();
    texts(tree.root(), &mut boxes);
    assert!(!boxes.is_empty(), "{}", figure.name());
    let size = tree.size();
    for (words, bounds) in &boxes {
        let inside = bounds.left() >= 0.0
            && bounds.top() >= -2.0 // its box is that of the font, not of the glyphs
            && bounds.right() <= size.width()
            && bounds.bottom() <= size.height() + 2.0;
        assert!(inside, "{}: {words} at {bounds:?}", figure.name());
    }
}

/// Difference between two pictures, 0 to 255, on average.
fn difference(a: &[u8], b: &[u8]) -> f64 {
    assert_eq!(a.len(), b.len());
    let sum: u64 = a
        .iter()
        .zip(b)
        .map(|(a, b)| u64::from(a.abs_diff(*b)))
        .sum();
    sum as f64 / a.len() as f64
}

fn assert_same_picture(figure: &Figure, tree: &usvg::Tree) {
    let [width, height] = figure.pixels();
    let mut pixmap = Pixmap::new(width, height).unwrap();
    let scale = (RESOLUTION / 96.0) as f32; // of the unit px
    let transform = Transform::from_scale(scale, scale);
    resvg::render(tree, transform, &mut pixmap.as_mut());
    let other: Vec<u8> = pixmap
        .pixels()
        .iter()
        .flat_map(|p| [p.red(), p.green(), p.blue()])
        .collect();
    let mine = decoded(&figure.png(), [width, height]);
    // Rounded coordinates and another rasteriser only change edges; a missing or shifted label
    // changes the mean by about 0.1, a missing map by 10.
    let difference = difference(&mine, &other);
    // Fringes are as fine as pixels, and images are interpolated in other ways.
    let limit = if figure.name() == "newton-rings" {
        5.0
    } else {
        0.5
    };
    assert!(difference < limit, "{}: {difference}", figure.name());
}

/// Colours of a PNG, three bytes each.
fn decoded(bytes: &[u8], size: [u32; 2]) -> Vec<u8> {
    let mut reader = Decoder::new(std::io::Cursor::new(bytes))
        .read_info()
        .unwrap();
    let mut data = vec![0; reader.output_buffer_size().unwrap()];
    let frame = reader.next_frame(&mut data).unwrap();
    assert_eq!([frame.width, frame.height], size);
    let info = reader.info();
    assert_eq!(info.pixel_dims.unwrap().xppu, 11811); // 300/25.4e-3
    match frame.color_type {
        ColorType::Grayscale => data.into_iter().flat_map(|v| [v; 3]).collect(),
        _ => data,
    }
}

fn check(figures: &[Figure]) {
    for figure in figures {
        assert_eq!(figure.faults(), Vec::<String>::new(), "{}", figure.name());
        let svg = figure.svg();
        assert_eq!(svg, figure.clone().svg());
        let tree = parsed(&svg);
        assert_text_on_page(figure, &tree);
        assert_same_picture(figure, &tree);
        let widths = figure.size()[0] * 1e3;
        assert!((60.0..=178.5).contains(&widths), "{} mm", widths);
    }
}

#[test]
fn one_pillar() {
    check(&figures_of(&transition(
        &system(2e6, 1e-3, 0.0),
        Method::default(),
    )));
}

/// Past the transition the figures include the floor.
#[test]
fn mixed_contact() {
    let run = Run::default();
    let critical = transition(&system(2e6, 0.02, 0.0), Method::default()).contact;
    let state = press(&critical.system, 1.5 * critical.force);
    let floor = state.floor.as_ref().unwrap();
    let section = ProfileState {
        label: Text::from("mixed contact"),
        state: &state,
        floor_contact: None,
    };
    check(&[
        pressure_map(&state, None).unwrap(),
        floor_pressure_map(&state).unwrap(),
        floor_gap_map(&state, &run).unwrap(),
        top_view(&state, View::Contact, &run).unwrap(),
        profiles(&[section], &run).unwrap(),
    ]);
    // In the section the gap is zero where the floor carries load, within the resolution of its cells.
    let half_width = Section::half_width(&state);
    let section = Section::new(&state, half_width, None, SectionDetail::Screen, &run).unwrap();
    assert!(!section.floor_patches.is_empty());
    let [across, _] = floor.cell();
    for (x, (lens, surface)) in section
        .x
        .iter()
        .zip(section.lens.iter().zip(&section.surface))
    {
        let inside = |[start, end]: &[f64; 2]| start + across < *x && *x < end - across;
        if section.floor_patches.iter().any(inside) {
            assert!((lens - surface).abs() < 5e-3 * 2.2e-6, "at {x}");
        }
    }
    // Without floor contact no figure of the floor is possible.
    assert_eq!(
        floor_pressure_map(&critical).unwrap_err(),
        FigureError::NoFloorContact
    );
}

#[test]
fn some_pillars_off_the_axis() {
    check(&figures_of(&transition(
        &system(2e6, 0.01, 0.2),
        Method::default(),
    )));
}

#[test]
fn many_pillars() {
    check(&figures_of(&transition(
        &system(2e3, 0.04, 0.0),
        Method::default(),
    )));
}

#[test]
fn charts() {
    check(&figures_of_many_states());
}

#[test]
fn odd_data() {
    check(&charts_of_odd_data());
}

#[test]
fn the_floor_before_any_pillar() {
    let critical = transition(
        &system(2e6, 5e-4, 0.866_025_403_784_438_6),
        Method::default(),
    );
    let state = &critical.contact;
    let section = ProfileState {
        label: Text::from("critical state"),
        state,
        floor_contact: Some(critical.floor_contact),
    };
    check(&[profiles(&[section], &Run::default()).unwrap()]);
    let refused = pressure_map(state, Some(critical.floor_contact)).unwrap_err();
    assert_eq!(refused, FigureError::NoPillars { method: "spectral" });
}

#[test]
fn methods_without_pillars_are_refused() {
    let critical = transition(&system(2e6, 0.01, 0.0), Method::Homogenised);
    let (state, run) = (&critical.contact, Run::default());
    let refused = FigureError::NoPillars {
        method: "homogenised",
    };
    assert_eq!(pressure_map(state, None).unwrap_err(), refused);
    let section = ProfileState {
        label: Text::default(),
        state,
        floor_contact: None,
    };
    assert_eq!(profiles(&[section], &run).unwrap_err(), refused);
    assert_eq!(floor_gap_map(state, &run).unwrap_err(), refused);
    assert_eq!(pillar_pressure(state, &run).unwrap_err(), refused);
    assert_eq!(top_view(state, View::Contact, &run).unwrap_err(), refused);
    assert_eq!(
        histogram(&Histogram {
            label: Text::from("x"),
            unit: Text::default(),
            values: vec![f64::NAN, 1.0],
            percentiles: Vec::new(),
        }),
        Err(FigureError::TooFewData {
            fewest: 2,
            given: 1
        })
    );
}

#[test]
fn metadata_of_a_figure_is_in_its_files() {
    let [title, description, source] =
        ["F < G & φ", "Ångström, \"quoted\"", "fakir 0.1.0, φ = 0.1"];
    let figure = charts_of_odd_data()
        .remove(0)
        .with_description(title, description)
        .with_provenance(source)
        .named("a b/c");
    assert_eq!(figure.name(), "a-b-c");
    let svg = figure.svg();
    let document = usvg::roxmltree::Document::parse(&svg).unwrap();
    let text = |name: &str| {
        let mut nodes = document.descendants();
        nodes
            .find(|node| node.tag_name().name() == name)
            .and_then(|node| node.text())
    };
    assert_eq!(text("title"), Some(title));
    assert_eq!(text("desc"), Some(description));
    assert_eq!(text("source"), Some(source));
    assert!(svg.contains("@font-face") && !figure.svg_for_page().contains("@font-face"));

    let bytes = figure.png();
    let reader = Decoder::new(std::io::Cursor::new(&bytes))
        .read_info()
        .unwrap();
    let info = reader.info();
    let latin = &info.uncompressed_latin1_text;
    assert!(
        latin
            .iter()
            .any(|chunk| chunk.keyword == "Description" && chunk.text == description)
    );
    let others: Vec<String> = info
        .utf8_text
        .iter()
        .map(|chunk| chunk.get_text().unwrap())
        .collect();
    assert_eq!(others, [title, source]);
}

#[test]
fn text_over_text_is_a_fault() {
    let long =
        "a label that is much too long for the height of the chart, by any measure, and is cut";
    let chart = LineChart {
        x: Axis::linear("x"),
        y: Axis::linear(long),
        series: vec![Series::unnamed(
            vec![[0.0, 0.0], [1.0, 1.0]],
            Style::line(0),
        )],
    };
    assert!(!lines(&chart).faults().is_empty());
}

#[test]
fn contacts_with_surfaces() {
    check(&figures_of_surfaces());
}

/// A cycle in both loading modes, one with an early unloading point, and a loading only, which has no map.
/// Rounded tops, with and without an edge, in contact and not; and every kind of curve of a design.
#[test]
fn rounded_tops() {
    let field = |rim: Option<f64>| {
        let asperity = |k: u32| Asperity {
            rim_radius: rim,
            ..Asperity::new([1e-4 * f64::from(k % 3), 1e-4 * f64::from(k / 3)], 1e-4)
                .raised_by(-4e-7 * f64::from(k))
        };
        let asperities = (0..9).map(asperity).collect();
        AsperityArray::new(Indenter::Flat(None), Material::new(2e6, 0.5), asperities).unwrap()
    };
    let map = |rim| {
        let field = field(rim);
        let load = Load::Indentation(2e-6);
        let contact = field.press_quickly(
            load,
            fakir::problem::Accuracy::Default,
            None,
            &Run::default(),
        );
        asperity_map(&field, &contact.unwrap())
    };
    use DesignedQuantity as Q;
    let curve = |load, value, scatter: Option<f64>| {
        let size = |quantity| match quantity {
            Q::Force => 1e-3,
            Q::Indentation => 1e-6,
            Q::Area => 1e-9,
        };
        let points = (1..8).map(|k| DesignedValues {
            load: f64::from(k) * size(load),
            wanted: f64::from(k) * size(value),
            designed: f64::from(k) * size(value) * (1.0 + 1e-8),
            scatter: scatter.map(|part| part * f64::from(k) * size(value)),
            ignored: f64::from(k) * size(value) * (1.0 - 0.01 * f64::from(k)),
        });
        designed_curve(&DesignedCurve {
            load,
            value,
            points: points.collect(),
        })
    };
    check(&[
        map(None),
        map(Some(4e-5)),
        curve(Q::Force, Q::Area, Some(0.01)),
        curve(Q::Indentation, Q::Force, None),
        curve(Q::Indentation, Q::Area, None),
    ]);
}

#[test]
fn cycles() {
    let adhesive = system(2e6, 0.01, 0.0)
        .with_adhesion(Adhesion::new(50e-3))
        .unwrap();
    let dense = system(2e6, 0.03, 0.3)
        .with_adhesion(Adhesion::new(5e-3))
        .unwrap();
    let cycle = |system: &System, plan: CyclePlan| {
        fakir::cycle(system, plan, Method::default(), &Run::default()).unwrap()
    };
    let plan = CyclePlan::default();
    let by_force = CyclePlan {
        drive: LoadingMode::Force,
        ..plan
    };
    let early = CyclePlan {
        turn: UnloadingPoint::Indentation(0.5e-6),
        ..plan
    };
    for (system, plan) in [
        (&adhesive, plan),
        (&dense, plan),
        (&adhesive, by_force),
        (&adhesive, early),
    ] {
        let cycle = cycle(system, plan);
        check(&[cycle_curve(&cycle).unwrap(), release_map(&cycle).unwrap()]);
    }
    let loading = CyclePlan {
        retract: false,
        ..plan
    };
    let loading = cycle(&adhesive, loading);
    check(&[cycle_curve(&loading).unwrap()]);
    let none = release_map(&loading).unwrap_err();
    assert!(matches!(none, FigureError::NoPillars { .. }));
}

#[test]
fn loadings() {
    check(&figures_of_loadings());
    let alone = LoadingPoint {
        indentation: 0.0,
        force: 0.0,
        floor_force: None,
        contact_radius: None,
        pillars: None,
        without_floor: false,
    };
    let too_few = approach(&[alone], None).unwrap_err();
    assert!(matches!(too_few, FigureError::TooFewData { given: 1, .. }));
}
