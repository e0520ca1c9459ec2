//! Writes every figure, for the paper's lens and pillars, to the folder given as argument.

use fakir::problem::{
    HexagonalLattice, Lens, Load, Material, Method, Pillar, PillarCompliance, PillarPattern, System,
};
use fakir::state::{CriticalState, Run};
use fakir::theory::closed_forms;
use fakir::theory::closed_forms::Form;
use fakir::theory::lattice_sums::SumFit;
use fakir_figure::{
    Axis, CriticalColumn, CriticalCurve, CriticalPoint, Dash, Figure, FigureError, Histogram,
    LineChart, Measured, PhaseDiagram, ProfileState, Series, Style, Text, Tint, View,
    critical_curves, floor_gap_map, histogram, lattice_sums, lines, phase_diagram, phase_point,
    pillar_pressure, pressure_map, profiles, top_view,
};
use std::error::Error;
use std::path::{Path, PathBuf};
use std::time::Instant;

const OFFSETS: [(&str, f64); 6] = [
    ("0", 0.0),
    ("1/6", 1.0 / 6.0),
    ("1/3", 1.0 / 3.0),
    ("1/2", 0.5),
    ("2/3", 2.0 / 3.0),
    ("√3/2", 0.866_025_403_784_438_6),
];

fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or("figures".to_owned()));
    std::fs::create_dir_all(&folder)?;
    let intermediate = curves(2e6, 14)?;
    save(
        &folder,
        &critical_curves(&[CriticalColumn {
            measured: measured(),
            ..column("", 2e6, intermediate.clone())?
        }]),
    )?;
    let all = critical_curves(&[
        column("rigid, *E*_{s} = 1 GPa", 1e9, curves(1e9, 9)?)?,
        column("intermediate, *E*_{s} = 2 MPa", 2e6, intermediate)?,
        column("soft, *E*_{s} = 2 kPa", 2e3, curves(2e3, 9)?)?,
    ]);
    save(&folder, &all.named("critical-curves-of-substrates"))?;
    for (surface_fraction, offset) in [(0.03, 0.0), (0.01, 1.0 / 6.0), (0.001, 0.0), (0.1, 0.0)] {
        states(&folder, surface_fraction, offset)?;
    }
    save(&folder, &phases()?)?;
    let fit = SumFit::least_squares([1.0, 32.0], 497).ok_or("no fit")?;
    save(&folder, &lattice_sums(&fit, 32.0))?;
    save(&folder, &spread()?)?;
    save(&folder, &power_law())?;
    Ok(())
}

/// Figures of single states.
fn states(folder: &Path, surface_fraction: f64, offset: f64) -> Result<(), Box<dyn Error>> {
    let run = Run::default();
    let system = system(2e6, surface_fraction, offset)?;
    let critical = fakir::transition(&system, Method::default(), &run)?;
    let at = |share: f64| {
        let load = Load::Force(share * critical.contact.force);
        fakir::press(&system, load, Method::default(), &run)
    };
    let (before, middle) = (at(0.0)?, at(0.3)?);
    let state = |label: &str, state| ProfileState {
        label: Text::from(label),
        state,
        floor_contact: None,
    };
    let section = profiles(
        &[
            state("before contact", &before),
            state("mid load", &middle),
            ProfileState {
                floor_contact: Some(critical.floor_contact),
                ..state("critical state", &critical.contact)
            },
        ],
        &run,
    )?;
    let contact = &critical.contact;
    println!("surface fraction {surface_fraction}, offset {offset:.3}");
    type Draw<'a> = Box<dyn Fn() -> Result<Figure, FigureError> + 'a>;
    let figures: [Draw<'_>; 5] = [
        Box::new(|| pressure_map(contact, Some(critical.floor_contact))),
        Box::new(|| pillar_pressure(contact, &run)),
        Box::new(|| floor_gap_map(contact, &run)),
        Box::new(|| top_view(contact, View::Contact, &run)),
        Box::new(|| top_view(contact, View::GREEN, &run)),
    ];
    let mut drawn = vec![section];
    for draw in figures {
        let start = Instant::now();
        let figure = draw()?;
        let time = 1e3 * start.elapsed().as_secs_f64();
        println!("{:32} {time:6.1} ms to compute", figure.name());
        drawn.push(figure);
    }
    for figure in drawn {
        let name = format!("{}-{surface_fraction}", figure.name()).replace('.', "_");
        save(folder, &figure.named(&name))?;
    }
    Ok(())
}

fn phases() -> Result<Figure, Box<dyn Error>> {
    let run = Run::default();
    let mut paths = Vec::new();
    for (k, phi) in [0.001, 0.01, 0.05].into_iter().enumerate() {
        let system = system(2e6, phi, 0.0)?;
        let critical = fakir::transition(&system, Method::default(), &run)?;
        let mut points = Vec::new();
        for step in 1..=24 {
            let share = (f64::from(step) / 20.0).powi(2);
            let load = Load::Force(share * critical.contact.force);
            let state = fakir::press(&system, load, Method::default(), &run)?;
            points.push(phase_point(&system, state.force, state.contact_radius));
        }
        let dash = [Dash::LongDashed, Dash::Dashed, Dash::DashDotted][k];
        let style = Style::line(0).in_tint(Tint::Grey).with_line(dash);
        let label = format!("loading, *φ* = {phi}");
        paths.push(Series::new(label, points, style));
    }
    let critical = curves(2e6, 14)?
        .into_iter()
        .enumerate()
        .map(|(k, curve)| {
            let points = curve.points.iter().map(|p| p.reduced);
            let points = points.map(|p| [p.contact_radius, p.force]).collect();
            Series::new(curve.label, points, Style::marks(k))
        })
        .collect();
    Ok(phase_diagram(&PhaseDiagram {
        system: system(2e6, 0.01, 0.0)?,
        critical,
        paths,
        shares: Vec::new(),
    }))
}

/// Critical forces for pillars whose heights scatter by five per cent.
fn spread() -> Result<Figure, Box<dyn Error>> {
    let mut values = Vec::new();
    for k in 0..2000 {
        // Quantiles of the normal distribution, to a per cent (K. D. Tocher, 1963).
        let share = (f64::from(k) + 0.5) / 2000.0;
        let normal = (share / (1.0 - share)).ln() / 1.702;
        let system = system(2e6, 0.02, 0.0)?;
        let mut pattern = system.pattern().clone();
        pattern.pillar.height *= 1.0 + 0.05 * normal;
        let system = System::new(system.lens().clone(), *system.substrate(), pattern)?;
        let critical = fakir::transition(&system, Method::Homogenised, &Run::default())?;
        values.push(critical.contact.force * 1e6);
    }
    Ok(histogram(&Histogram {
        label: Text::from("critical force *F*_{c} (µN)"),
        unit: Text::from("µN"),
        values,
        percentiles: vec![5.0, 50.0, 95.0],
    })?)
}

fn power_law() -> Figure {
    let points: Vec<[f64; 2]> = (0..12)
        .map(|k| {
            let x = 1e-4 * 1.8f64.powi(k);
            [
                x,
                3e3 * x.powf(1.48) * (1.0 + 0.08 * (7.0 * f64::from(k)).sin()),
            ]
        })
        .collect();
    let errors = points.iter().map(|[_, y]| [0.0, 0.1 * y]).collect();
    let fit = points
        .iter()
        .map(|[x, _]| [*x, 3e3 * x.powf(1.48)])
        .collect();
    lines(&LineChart {
        x: Axis::logarithmic("surface fraction *φ*"),
        y: Axis::logarithmic("*F*_{c} (µN)"),
        series: vec![
            Series::new("computed", points, Style::marks(0)).with_errors(errors),
            Series::new(
                "fit, *F*_{c} ∼ *φ*^{1.48 ± 0.02}".replace('∼', "="),
                fit,
                Style::line(1),
            ),
        ],
    })
}

fn save(folder: &Path, figure: &Figure) -> Result<(), Box<dyn Error>> {
    let figure = figure.clone().with_provenance(
        "fakir, gallery of figures; system of Phys. Rev. E 104, 055007 (2021), \
         https://doi.org/10.1103/PhysRevE.104.055007",
    );
    let start = Instant::now();
    let svg = figure.svg();
    let middle = Instant::now();
    let png = figure.png();
    println!(
        "{:32} SVG {:5} kB {:6.1} ms, PNG {:5} kB {:6.1} ms",
        figure.name(),
        svg.len() / 1000,
        1e3 * (middle - start).as_secs_f64(),
        png.len() / 1000,
        1e3 * middle.elapsed().as_secs_f64()
    );
    for fault in figure.faults() {
        println!("    {fault}");
    }
    std::fs::write(folder.join(figure.name()).with_extension("svg"), svg)?;
    std::fs::write(folder.join(figure.name()).with_extension("png"), png)?;
    Ok(())
}

fn system(modulus: f64, surface_fraction: f64, offset: f64) -> Result<System, Box<dyn Error>> {
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
    Ok(System::new(lens, Material::new(modulus, 0.5), pattern)?)
}

fn spaced(count: usize) -> impl Iterator<Item = f64> {
    let (first, last) = (5e-4f64, 0.1f64);
    (0..count).map(move |k| first * (last / first).powf(k as f64 / (count - 1) as f64))
}

fn curves(modulus: f64, count: usize) -> Result<Vec<CriticalCurve>, Box<dyn Error>> {
    OFFSETS
        .iter()
        .enumerate()
        .map(|(k, (name, offset))| {
            let states: Result<Vec<CriticalState>, Box<dyn Error>> = spaced(count)
                .map(|phi| {
                    let system = system(modulus, phi, *offset)?;
                    Ok(fakir::transition(
                        &system,
                        Method::default(),
                        &Run::default(),
                    )?)
                })
                .collect();
            Ok(CriticalCurve {
                label: Text::from(format!("*δx*/*e* = {name}")),
                points: states?.iter().map(CriticalPoint::from).collect(),
                style: Style::marks(k).with_line(Style::line(k).line.unwrap_or(Dash::Solid)),
            })
        })
        .collect()
}

/// The curves with closed forms and the homogenised lattice.
fn column(
    title: &str,
    modulus: f64,
    mut curves: Vec<CriticalCurve>,
) -> Result<CriticalColumn, Box<dyn Error>> {
    let (mut printed, mut homogenised) = (Vec::new(), Vec::new());
    for phi in spaced(60) {
        let system = system(modulus, phi, 0.0)?;
        let estimate = if phi < closed_forms::small_contact_limit(&system) {
            closed_forms::small_contact(&system)
        } else {
            closed_forms::large_contact(&system, Form::AsPrinted)
        };
        printed.push(CriticalPoint::of_estimate(&system, &estimate));
        let critical = fakir::transition(&system, Method::Homogenised, &Run::default())?;
        homogenised.push(CriticalPoint::from(&critical));
    }
    curves.push(CriticalCurve {
        label: Text::from("formulas of the paper"),
        points: printed,
        style: Style::line(3).in_tint(Tint::Grey),
    });
    curves.push(CriticalCurve {
        label: Text::from("homogenised lattice"),
        points: homogenised,
        style: Style::line(0).in_tint(Tint::Black),
    });
    Ok(CriticalColumn {
        title: Text::from(title),
        curves,
        measured: Vec::new(),
    })
}

/// Invented points, to show the style of measured points.
fn measured() -> Vec<Measured> {
    [(0.004, 3.0), (0.012, 9.0), (0.05, 150.0)]
        .into_iter()
        .map(|(phi, force)| Measured {
            surface_fraction: [phi, 0.1 * phi],
            force: Some([force, 0.2 * force]),
            contact_radius: None,
            indentation: None,
        })
        .collect()
}
