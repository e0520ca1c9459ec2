//! Lenses that are not spheres: paraboloids, cylinders, plates and tables of heights.

use fakir::problem::{
    Accuracy, Arrangement, Boundary, Grid, HeightMap, HexagonalLattice, Indenter, InvalidQuantity,
    LatticeForm, Lens, LensProfile, LensShape, ListedPillar, Load, Material, Method, Pillar,
    PillarCompliance, PillarList, PillarPattern, PlaneLattice, Point, PunchForm, Quantity,
    Requirement, ShapedLens, SurfaceSystem, System, Unsupported,
};
use fakir::state::{ContactState, Run, SolveError, Warning};
use std::f64::consts::PI;
use std::sync::Arc;

/// With two bodies of this material the reduced modulus is 1 MPa.
const MATERIAL: Material = Material {
    young_modulus: 1.5e6,
    poisson_ratio: 0.5,
};
const MODULUS: f64 = 1e6;

const RADIUS: f64 = 2.2e-3;

fn pillar(compliance: PillarCompliance) -> Pillar {
    Pillar {
        diameter: 6e-6,
        height: 2.2e-6,
        compliance,
    }
}

fn of_shape(
    shape: LensShape,
    compliance: PillarCompliance,
    arrangement: impl Into<Arrangement>,
) -> Result<System, InvalidQuantity> {
    let lens = ShapedLens::new(shape, MATERIAL);
    System::new(
        lens,
        MATERIAL,
        PillarPattern::new(pillar(compliance), arrangement),
    )
}

/// Without columns.
fn system(shape: LensShape, arrangement: impl Into<Arrangement>) -> System {
    of_shape(shape, PillarCompliance::None, arrangement).expect("a valid system")
}

fn sphere(radius: f64) -> LensShape {
    LensShape::Sphere { radius }
}

fn cylinder(angle: f64) -> LensShape {
    LensShape::Cylinder {
        radius: RADIUS,
        angle,
    }
}

fn plate(tilt: f64, direction: f64) -> LensShape {
    LensShape::Plate { tilt, direction }
}

fn pressed_by(system: &System, control: Load, accuracy: Accuracy) -> ContactState {
    let state = fakir::press(system, control, Method::Spectral(accuracy), &Run::default())
        .expect("a solution");
    assert!(state.converged(), "{:?}", state.termination);
    state
}

fn pressed(system: &System, control: Load) -> ContactState {
    pressed_by(system, control, Accuracy::Default)
}

/// Equal pillars.
fn list(places: &[Point]) -> PillarList {
    let one = |centre: &Point| ListedPillar {
        centre: *centre,
        height: 2.2e-6,
        diameter: 6e-6,
    };
    PillarList::new(places.iter().map(one).collect()).expect("a valid list")
}

fn turned([x, y]: Point, angle: f64) -> Point {
    let (sin, cos) = angle.sin_cos();
    [cos * x - sin * y, sin * x + cos * y]
}

fn force_on(state: &ContactState, index: (i64, i64)) -> f64 {
    let pillar = state.pillars.iter().find(|pillar| pillar.index == index);
    pillar.map_or(0.0, |pillar| pillar.force)
}

/// Hertz (K. L. Johnson, Contact Mechanics, eq. 4.22 to 4.24), which is exact for a paraboloid: `a^2 = R zeta`,
/// `F = 4/3 E* sqrt(R) zeta^1.5`.
#[test]
fn a_paraboloid_inside_a_wide_pillar_is_hertz() {
    let wide = ListedPillar {
        centre: [4e-6, -3e-6],
        height: 2.2e-6,
        diameter: 200e-6,
    };
    let list = PillarList::new(vec![wide]).unwrap();
    let system = system(LensShape::Paraboloid { radius: RADIUS }, list);
    for depth in [0.05e-6, 0.5e-6, 1.5e-6] {
        let hertz = 4.0 / 3.0 * MODULUS * RADIUS.sqrt() * f64::powf(depth, 1.5);
        let state = pressed(&system, Load::Indentation(depth));
        assert!((state.force / hertz - 1.0).abs() < 1e-12, "{depth}");
        let area = state.contact_radius.powi(2) / (RADIUS * depth);
        assert!((area - 1.0).abs() < 1e-12, "{depth}");
        let back = pressed(&system, Load::Force(hertz));
        assert!((back.indentation / depth - 1.0).abs() < 1e-12, "{depth}");
    }
}

/// Without columns the problem is linear in heights: for `R -> R/s` and `h -> s h`, forces and indentations are multiplied by `s`. A sphere
/// differs from this by the square of the ratio of contact radius to lens radius.
#[test]
fn paraboloids_scale_exactly_and_spheres_do_not() {
    let critical = |shape: &dyn Fn(f64) -> LensShape, stretch: f64| {
        let lattice = PlaneLattice::new(LatticeForm::Square { pitch: 30e-6 });
        let pillar = Pillar {
            height: 2.2e-6 * stretch,
            ..pillar(PillarCompliance::None)
        };
        let lens = ShapedLens::new(shape(RADIUS / stretch), MATERIAL);
        let system = System::new(lens, MATERIAL, PillarPattern::new(pillar, lattice)).unwrap();
        let method = Method::Spectral(Accuracy::Default);
        let state = fakir::transition(&system, method, &Run::default()).unwrap();
        assert!(state.contact.converged());
        [state.contact.force, state.contact.indentation].map(|value| value / stretch)
    };
    let paraboloid = |radius| LensShape::Paraboloid { radius };
    let [one, other] = [1.0, 0.25].map(|stretch| critical(&paraboloid, stretch));
    for (one, other) in one.into_iter().zip(other) {
        assert!((one / other - 1.0).abs() < 1e-9, "{one} {other}");
    }
    let away = [1.0, 0.25].map(|stretch| critical(&sphere, stretch)[0] / one[0] - 1.0);
    println!("{away:?}");
    assert!(away[0].abs() < 1e-3 && away[0].abs() > 1e-6);
    assert!((away[0] / away[1] / 16.0 - 1.0).abs() < 0.05, "{away:?}");
}

/// On the infinite hexagonal lattice, a paraboloid is solved like a sphere; comparison with the homogenised lattice, which is formulated
/// for `r^2/(2R)`.
#[test]
fn paraboloids_on_dense_lattices_are_those_of_the_homogenised_one() {
    let difference = |fraction: f64| {
        let lattice = HexagonalLattice::with_surface_fraction(fraction, 6e-6);
        let shape = LensShape::Paraboloid { radius: RADIUS };
        let exact = of_shape(shape, PillarCompliance::Column, lattice).unwrap();
        let layer = of_shape(sphere(RADIUS), PillarCompliance::Column, lattice).unwrap();
        let control = Load::Indentation(6e-6);
        let exact = pressed(&exact, control);
        let layer = fakir::press(&layer, control, Method::Homogenised, &Run::default()).unwrap();
        layer.force / exact.force - 1.0
    };
    let differences = [0.05, 0.1, 0.2].map(difference);
    println!("{differences:?}");
    assert!(
        differences.iter().all(|d| d.abs() < 3e-3),
        "{differences:?}"
    );
}

/// Potential of a square lattice of unit pitch and unit charges in a neutralising background at a lattice site, without its own charge:
/// twice the energy of the square Wigner crystal (L. Bonsall, A. A. Maradudin, Phys. Rev. B 15, 1959 (1977)).
const SQUARE_SITE_POTENTIAL: f64 = -3.900_264_920;

/// Line contact on a half-space covered by springs: `(c/pi) ∫ p(t) 2 ln(1/|x - t|) dt + beta p(x) = const - x^2/(2R)` for `|x| < b`,
/// `p(b) = 0`, with piecewise linear pressures, in units of `c = 1`. Returns the half-width for a load per length, and the pressure at some
/// positions.
///
/// Without springs the result is Hertz's `P = pi E* b^2/(4R)` (Johnson, eq. 4.43).
fn line_contact(layer: f64, load: f64, radius: f64, places: &[f64]) -> (f64, Vec<f64>) {
    const NODES: usize = 160;
    // For a strip: the integral of ln|x - t| from 0 to x.
    let primitive = |x: f64| if x == 0.0 { 0.0 } else { x * x.abs().ln() - x };
    let second = |x: f64| {
        if x == 0.0 {
            0.0
        } else {
            0.5 * x * x * x.abs().ln() - 0.75 * x * x
        }
    };
    let solve = |half: f64| -> Vec<f64> {
        // Even: nodes from 0 to b, with zero pressure at the last one; the constant is an additional unknown.
        let step = half / NODES as f64;
        let hat = |x: f64| {
            // ∫ (1 - |t|/step) ln|x - t| dt over the hat.
            let _ = primitive;
            (second(x + step) - 2.0 * second(x) + second(x - step)) / step
        };
        let size = NODES + 1;
        let mut matrix = vec![vec![0.0; size + 1]; size];
        for (row, equation) in matrix.iter_mut().enumerate() {
            let x = row as f64 * step;
            for (column, entry) in equation.iter_mut().take(NODES).enumerate() {
                let t = column as f64 * step;
                let both = if column == 0 {
                    hat(x)
                } else {
                    hat(x - t) + hat(x + t)
                };
                *entry = -2.0 / PI * both;
            }
            if row < NODES {
                equation[row] += layer;
            }
            equation[NODES] = -1.0;
            equation[size] = -x * x / (2.0 * radius);
        }
        eliminate(matrix)
    };
    let load_of = |half: f64, pressures: &[f64]| {
        let step = half / NODES as f64;
        step * (pressures[0] + 2.0 * pressures[1..NODES].iter().sum::<f64>())
    };
    // The load increases with the width.
    let (mut low, mut high) = (0.0, 1.0);
    while load_of(high, &solve(high)) < load {
        high *= 2.0;
    }
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if load_of(middle, &solve(middle)) < load {
            low = middle;
        } else {
            high = middle;
        }
    }
    let pressures = solve(high);
    let step = high / NODES as f64;
    let at = |x: &f64| {
        let place = x.abs() / step;
        let node = (place as usize).min(NODES - 1);
        let next = if node + 1 < NODES {
            pressures[node + 1]
        } else {
            0.0
        };
        let rest = place - node as f64;
        if rest > 1.0 {
            0.0
        } else {
            (1.0 - rest) * pressures[node] + rest * next
        }
    };
    (high, places.iter().map(at).collect())
}

/// Gaussian elimination with pivoting.
fn eliminate(mut matrix: Vec<Vec<f64>>) -> Vec<f64> {
    let size = matrix.len();
    for column in 0..size {
        let pivot = (column..size)
            .max_by(|a, b| {
                matrix[*a][column]
                    .abs()
                    .total_cmp(&matrix[*b][column].abs())
            })
            .unwrap_or(column);
        matrix.swap(column, pivot);
        let (above, below) = matrix.split_at_mut(column + 1);
        for row in below {
            let factor = row[column] / above[column][column];
            for (value, other) in row.iter_mut().zip(&above[column]).skip(column) {
                *value -= factor * other;
            }
        }
    }
    let mut solution = vec![0.0; size];
    for row in (0..size).rev() {
        let rest: f64 = (row + 1..size).map(|k| matrix[row][k] * solution[k]).sum();
        solution[row] = (matrix[row][size] - rest) / matrix[row][row];
    }
    solution
}

#[test]
fn the_line_contact_of_the_tests_is_hertz_without_springs() {
    let (half, pressures) = line_contact(0.0, 0.3, 7.0, &[0.0]);
    let hertz = (4.0 * 7.0 * 0.3 / PI).sqrt();
    // The pressure, 2 P/(pi b) at the centre, ends as a square root, which the linear pieces approximate roughly.
    assert!((half / hertz - 1.0).abs() < 5e-3, "{half} {hertz}");
    assert!((pressures[0] * PI * hertz / 0.6 - 1.0).abs() < 5e-3);
}

/// The pressure of a cylinder along long rows of pillars approaches that on a half-space covered by springs with increasing number of rows.
/// The springs are those of the homogenised lattice: an isolated pillar, and the potential of all others minus that of the uniform load.
#[test]
fn cylinders_on_dense_rows_are_line_contacts() {
    let difference = |rows: i32, pitch: f64, depth: f64| {
        let along = 12 * rows;
        let places: Vec<Point> = (-along..=along)
            .flat_map(|i| (-rows..=rows).map(move |j| [f64::from(i), f64::from(j)]))
            .map(|place| place.map(|x| x * pitch))
            .collect();
        let system = of_shape(cylinder(0.0), PillarCompliance::Column, list(&places)).unwrap();
        let state = pressed(&system, Load::Indentation(depth));
        let width = 2 * rows + 1;
        let middle = |j: i32| force_on(&state, (i64::from(along * width + j + rows), 0));
        let forces: Vec<f64> = (-rows..=rows).map(middle).collect();
        assert!(
            forces[0] == 0.0,
            "the outermost rows are beside the contact"
        );
        // Per length, divided by E*.
        let load = forces.iter().sum::<f64>() / pitch / MODULUS;
        let cell = pitch * pitch;
        let own = system.internal_compliance() / system.pillar().diameter;
        let springs = own + system.external_compliance() * SQUARE_SITE_POTENTIAL / (2.0 * pitch);
        let places: Vec<f64> = (-rows..=rows).map(|j| f64::from(j) * pitch).collect();
        let (half, pressures) = line_contact(cell * springs * MODULUS, load, RADIUS, &places);
        let largest = forces.iter().copied().fold(0.0, f64::max);
        let away = |(force, pressure): (&f64, &f64)| (force - pressure * MODULUS * cell).abs();
        // At the edge, the discreteness of the lattice is visible.
        let inside = forces.iter().zip(&pressures).zip(&places);
        let inside = inside.filter(|(_, place)| place.abs() < 0.7 * half);
        let off = inside.map(|(pair, _)| away(pair)).fold(0.0, f64::max) / largest;
        println!(
            "{rows} rows: half-width {:.2} pitches, {off:e}",
            half / pitch
        );
        off
    };
    // Finer lattices of the same surface fraction under the same contact would require other pillars: the contact grows instead.
    let coarse = difference(5, 12e-6, 0.6e-6);
    let fine = difference(10, 12e-6, 1.7e-6);
    assert!(fine < 0.01 && fine < 0.7 * coarse, "{coarse:e} {fine:e}");
}

/// `F = zeta/(1/(2 E* a) + 4 h/(pi E_s d^2))` (Johnson, eq. 3.36, and Hooke) for any tilt of the plate, provided that it touches the whole
/// top: the force of a tilted flat punch is determined by the indentation at its centre.
#[test]
fn a_plate_on_one_pillar_is_a_flat_punch() {
    let place = [5e-6, -2e-6];
    let column = 4.0 * 2.2e-6 / (PI * 1.5e6 * 36e-12);
    for (tilt, direction) in [(0.0, 0.0), (0.002, 0.7), (0.004, -2.0)] {
        let system = of_shape(
            plate(tilt, direction),
            PillarCompliance::Column,
            list(&[place]),
        )
        .unwrap();
        let rise = f64::tan(tilt) * turned(place, -direction)[0];
        let depth = 0.4e-6;
        let state = pressed(&system, Load::Indentation(depth));
        let punch = (depth - rise) / (1.0 / (MODULUS * 6e-6) + column);
        assert!((state.force / punch - 1.0).abs() < 1e-10, "{tilt}");
        let back = pressed(&system, Load::Force(punch));
        assert!((back.indentation / depth - 1.0).abs() < 1e-9, "{tilt}");
    }
}

/// Nine pillars of five radii under a plate: 27.8797845791 E* um^2 at 1 um (`any.csv` of the prototype).
#[test]
fn plates_on_listed_pillars_as_the_prototype() {
    let pillars = include_str!("../any/nine.csv").lines().skip(1).map(|line| {
        let numbers: Vec<f64> = line.split(',').map(|x| x.trim().parse().unwrap()).collect();
        let [x, y, radius, raised] = [0, 1, 2, 3].map(|k| 1e-6 * numbers[k]);
        ListedPillar {
            centre: [x, y],
            height: 2.2e-6 + raised,
            diameter: 2.0 * radius,
        }
    });
    let list = PillarList::new(pillars.collect()).unwrap();
    let system = system(plate(0.0, 0.0), list);
    let state = pressed_by(&system, Load::Indentation(1e-6), Accuracy::Accurate);
    assert_eq!(state.pillars.len(), 9);
    assert!(
        (state.force / 27.8797845791e-6 - 1.0).abs() < 1e-7,
        "{}",
        state.force
    );
    let back = pressed_by(&system, Load::Force(state.force), Accuracy::Accurate);
    assert!((back.indentation / 1e-6 - 1.0).abs() < 1e-9);
}

/// All tops are fully in contact, so that forces are linear in the tilt: those under opposite tilts have the mean of the level plate, and
/// mirrored pillars have mirrored forces.
#[test]
fn tilted_plates_press_linearly_and_symmetrically() {
    let places: Vec<Point> = [[-20.0, 0.0], [20.0, 0.0], [0.0, 12.0], [0.0, -12.0]]
        .map(|place| place.map(|x| 1e-6 * x))
        .to_vec();
    let control = Load::Indentation(0.5e-6);
    let forces = |tilt: f64, direction: f64| {
        let state = pressed(&system(plate(tilt, direction), list(&places)), control);
        [0, 1, 2, 3].map(|k| force_on(&state, (k, 0)))
    };
    let level = forces(0.0, 0.0);
    // Bitwise equal: without tilt, the direction has no effect.
    assert_eq!(level.map(f64::to_bits), forces(0.0, 1.3).map(f64::to_bits));
    let [up, down] = [0.0, PI].map(|direction| forces(0.003, direction));
    for k in 0..4 {
        let mean = 0.5 * (up[k] + down[k]);
        assert!((mean / level[k] - 1.0).abs() < 1e-9, "{k}");
    }
    assert!((up[0] / down[1] - 1.0).abs() < 1e-9 && (up[1] / down[0] - 1.0).abs() < 1e-9);
    assert!((up[2] / up[3] - 1.0).abs() < 1e-9);
    // The plate rises to the right: the force on the left pillar is larger.
    assert!(up[0] > 1.2 * up[1]);
    // Equivalent to pillars whose heights differ by the tilt, except for the tilt of the plate over every top, which hardly affects distant
    // pillars.
    let raised = places.iter().map(|&centre| ListedPillar {
        centre,
        height: 2.2e-6 - f64::tan(0.003) * centre[0],
        diameter: 6e-6,
    });
    let raised = system(plate(0.0, 0.0), PillarList::new(raised.collect()).unwrap());
    let raised = pressed(&raised, control);
    for k in 0..4 {
        let away = force_on(&raised, (k, 0)) / up[k as usize] - 1.0;
        assert!(away.abs() < 2e-3, "{k}: {away:e}");
    }
}

/// A tilted plate touches its first pillar at a negative indentation. The contact there is that of higher pillars at a lower indentation.
#[test]
fn tilted_plates_press_from_their_first_touch() {
    let places: Vec<Point> = [-40e-6, 0.0, 40e-6].map(|x| [x, 0.0]).to_vec();
    let tilted = plate(0.004, 0.0);
    let level = system(tilted.clone(), list(&places));
    let first = level.first_touch();
    assert!(
        (first / (-f64::tan(0.004) * 43e-6) - 1.0).abs() < 1e-9,
        "{first:e}"
    );
    let by = 0.4e-6;
    let higher = places.iter().map(|&centre| ListedPillar {
        centre,
        height: 2.2e-6 + by,
        diameter: 6e-6,
    });
    let higher = system(tilted, PillarList::new(higher.collect()).unwrap());
    for indentation in [-0.1e-6, -0.01e-6] {
        let found = pressed(&level, Load::Indentation(indentation));
        let expected = pressed(&higher, Load::Indentation(indentation - by));
        assert_eq!(found.pillars_in_contact, 1);
        assert!((found.force / expected.force - 1.0).abs() < 1e-9);
    }
    let run = Run::default();
    let above = Load::Indentation(1.01 * first);
    assert!(fakir::press(&level, above, Method::default(), &run).is_err());
}

fn profile(range: f64, rows: usize, height: impl Fn(f64) -> f64) -> LensShape {
    let radii: Vec<f64> = (0..=rows).map(|k| range * k as f64 / rows as f64).collect();
    let heights = radii.iter().map(|r| height(*r)).collect();
    let table = LensProfile::new(radii, heights).expect("heights that rise");
    LensShape::Profile(Arc::new(table))
}

/// A sphere as a table: the differences in the results are proportional to the fourth power of the row spacing, as for the spline.
#[test]
fn profiles_of_a_sphere_are_the_sphere() {
    let small = 150e-6;
    let exact = Lens {
        radius: small,
        material: MATERIAL,
    };
    let lattice = PlaneLattice::new(LatticeForm::Square { pitch: 16e-6 });
    let force = |shape: LensShape| {
        let system = system(shape, lattice);
        let state = pressed_by(&system, Load::Indentation(4e-6), Accuracy::Accurate);
        state.force
    };
    let of_sphere = force(sphere(small));
    let away = [4, 8, 16].map(|rows| {
        let of_table = force(profile(70e-6, rows, |r| exact.sag(r)));
        (of_table / of_sphere - 1.0).abs()
    });
    println!("{away:?}");
    assert!(away[0] < 1e-3 && away[2] < 1e-6, "{away:?}");
    // 16 for half the spacing; four rows are too few for this.
    assert!((12.0..20.0).contains(&(away[1] / away[2])), "{away:?}");
}

/// On the hexagonal lattice, with the floor.
#[test]
fn a_profile_of_a_sphere_meets_the_floor_as_the_sphere() {
    let lattice = HexagonalLattice::new(30e-6).offset_by(0.2);
    let critical = |shape: LensShape| {
        let system = system(shape, lattice);
        let method = Method::Spectral(Accuracy::Accurate);
        fakir::transition(&system, method, &Run::default()).unwrap()
    };
    let exact = Lens {
        radius: RADIUS,
        material: MATERIAL,
    };
    let (table, whole) = (
        critical(profile(300e-6, 40, |r| exact.sag(r))),
        critical(sphere(RADIUS)),
    );
    let away = [
        table.contact.force / whole.contact.force - 1.0,
        table.contact.indentation / whole.contact.indentation - 1.0,
    ];
    println!("{away:?}");
    assert!(away.iter().all(|a| a.abs() < 1e-5), "{away:?}");
}

/// Inside one top: Sneddon's `F = 2 E* ∫ r^2 f'/sqrt(a^2 - r^2) dr` and `zeta = ∫ a f'/sqrt(a^2 - r^2) dr` for `f = r^2/(2R) + r^3/B`:
/// `F = 2 E* (2 a^3/(3R) + 9 pi a^4/(16 B))`, `zeta = a^2/R + 3 pi a^3/(4 B)`.
#[test]
fn a_profile_inside_a_wide_pillar_is_sneddon() {
    let (radius, cube) = (RADIUS, 1e-7);
    let shape = profile(150e-6, 60, |r| r * r / (2.0 * radius) + r.powi(3) / cube);
    let wide = ListedPillar {
        centre: [0.0; 2],
        height: 2.2e-6,
        diameter: 200e-6,
    };
    let system = system(shape, PillarList::new(vec![wide]).unwrap());
    let a: f64 = 35e-6;
    let depth = a * a / radius + 0.75 * PI * a.powi(3) / cube;
    let force =
        2.0 * MODULUS * (2.0 * a.powi(3) / (3.0 * radius) + 9.0 * PI * a.powi(4) / (16.0 * cube));
    let state = pressed(&system, Load::Indentation(depth));
    let away = state.force / force - 1.0;
    println!("{away:e}, claimed {:e}", state.error.force);
    // The accuracy of the quadrature is 1e-7.
    assert!(away.abs() < state.error.force && state.error.force < 3e-7);
    let off = (state.contact_radius - a).abs();
    println!("{off:e}, claimed {:e}", state.contact_radius_error);
    // A cubic is not an even function, for which the modes converge slowly at the edge.
    assert!(off < 1.01 * state.contact_radius_error && off < 0.01 * a);
}

/// A contact that reaches the end of the table is refused, with the end in the message.
#[test]
fn profiles_are_used_as_far_as_they_go() {
    let exact = Lens {
        radius: RADIUS,
        material: MATERIAL,
    };
    let lattice = HexagonalLattice::new(20e-6);
    let short = system(profile(60e-6, 20, |r| exact.sag(r)), lattice);
    let press = |depth: f64| {
        fakir::press(
            &short,
            Load::Indentation(depth),
            Method::default(),
            &Run::default(),
        )
    };
    assert!(press(0.3e-6).unwrap().converged());
    let error = press(6e-6).unwrap_err();
    assert!(
        matches!(error, SolveError::ProfileEnds { end, .. } if (end / 60e-6 - 1.0).abs() < 1e-12),
        "{error}"
    );
    assert!(error.to_string().contains("ends at 6.000e-5 m"), "{error}");
    // The lowest point of the lens above the floor is at the rim of the pillar, 3 um from its axis, beyond the end of this table.
    let shorter = system(profile(2.5e-6, 20, |r| exact.sag(r)), lattice);
    let light = Load::Indentation(1e-9);
    let error = fakir::press(&shorter, light, Method::default(), &Run::default()).unwrap_err();
    assert!(matches!(error, SolveError::ProfileEnds { .. }), "{error}");
}

#[test]
fn turning_all_changes_nothing() {
    let places: Vec<Point> = [
        [0.0, 3.0],
        [15.0, -4.0],
        [-14.0, 1.0],
        [3.0, 17.0],
        [30.0, 5.0],
    ]
    .map(|place| place.map(|x| 1e-6 * x))
    .to_vec();
    let by = 0.83;
    let moved: Vec<Point> = places.iter().map(|place| turned(*place, by)).collect();
    type Turned<'a> = &'a dyn Fn(f64) -> LensShape;
    let shapes: [(Turned<'_>, f64); 2] = [
        (&|angle| cylinder(0.2 + angle), 0.5e-6),
        (&|angle| plate(0.002, 0.4 + angle), 0.3e-6),
    ];
    for (shape, depth) in shapes {
        let control = Load::Indentation(depth);
        let straight = pressed_by(
            &system(shape(0.0), list(&places)),
            control,
            Accuracy::Accurate,
        );
        let copy = pressed_by(
            &system(shape(by), list(&moved)),
            control,
            Accuracy::Accurate,
        );
        let claimed = (straight.error.force + copy.error.force).max(1e-10);
        let away = copy.force / straight.force - 1.0;
        println!("{away:e} {claimed:e}");
        assert!(away.abs() < claimed);
    }
    // For a rotated lattice the result is the same to the last digits: it is solved in the standard orientation.
    let lattice = |rotation: f64| PlaneLattice {
        rotation,
        columns: Some(6),
        ..PlaneLattice::new(LatticeForm::Square { pitch: 14e-6 })
    };
    for (shape, depth) in shapes {
        let control = Load::Indentation(depth);
        let [straight, copy] =
            [0.0, by].map(|by| pressed(&system(shape(by), lattice(by)), control));
        assert!((copy.force / straight.force - 1.0).abs() < 1e-10);
        assert!((copy.contact_radius / straight.contact_radius - 1.0).abs() < 1e-6);
        let [a, b] = [&straight, &copy].map(|state| state.pillars.len());
        assert_eq!(a, b);
        for (one, other) in straight.pillars.iter().zip(&copy.pillars) {
            let place = turned(one.centre, by);
            let off = (place[0] - other.centre[0]).hypot(place[1] - other.centre[1]);
            assert!(off < 1e-12);
        }
    }
}

/// Independent comparison: elements have the same gap as a plate above tops that are lowered by the lens shape. The error of the cells on a
/// disc is divided out with the force under a level plate.
#[test]
fn boundary_elements_agree_for_a_cylinder_and_a_tilted_plate() {
    let places: Vec<Point> = [[0.0, 3.0], [15.0, -4.5], [-13.5, 1.5], [3.0, 16.5]]
        .map(|place| place.map(|x| 1e-6 * x))
        .to_vec();
    let depth = 0.3e-6;
    let by_elements = |lens: &ShapedLens| {
        let cell = 0.1875e-6;
        let grid = Grid::centred(256, 256, cell).unwrap();
        let height = |[x, y]: Point| {
            let on_top = |place: &&Point| (x - place[0]).hypot(y - place[1]) <= 3e-6;
            if places.iter().any(|place| on_top(&place)) {
                2.2e-6 - lens.sag([x, y])
            } else {
                0.0
            }
        };
        let map = HeightMap::from_height(grid, height).unwrap();
        let highest = map.heights().iter().copied().fold(0.0, f64::max);
        let indenter = Indenter::Flat(Some(MATERIAL));
        let surface = SurfaceSystem::new(indenter, MATERIAL, map, Boundary::FreeSpace).unwrap();
        // Relative to the highest point of the map.
        let control = Load::Indentation(depth - (2.2e-6 - highest));
        surface.press(control, &Run::default()).unwrap().force
    };
    let exactly = |shape: LensShape| {
        pressed_by(
            &system(shape, list(&places)),
            Load::Indentation(depth),
            Accuracy::Accurate,
        )
        .force
    };
    let level = plate(0.0, 0.0);
    let of = |shape: &LensShape| by_elements(&ShapedLens::new(shape.clone(), MATERIAL));
    let unit = of(&level) / exactly(level.clone());
    for shape in [cylinder(0.4), plate(0.01, 2.0)] {
        let away = of(&shape) / exactly(shape.clone()) / unit - 1.0;
        println!("{shape:?}: {away:e} ({:e})", unit - 1.0);
        assert!(away.abs() < 3e-3, "{shape:?}: {away:e}");
    }
}

/// Compares derivatives with central differences.
#[test]
fn gradients_include_the_shape() {
    let lattice = |pitch: f64| PlaneLattice {
        columns: Some(5),
        rotation: 0.3,
        ..PlaneLattice::new(LatticeForm::Square { pitch })
    };
    let exact = Lens {
        radius: 400e-6,
        material: MATERIAL,
    };
    let table = profile(120e-6, 30, |r| exact.sag(r));
    type Shape<'a> = &'a dyn Fn(f64) -> LensShape;
    let shapes: [(Shape<'_>, bool); 4] = [
        (&|radius| LensShape::Cylinder { radius, angle: 0.5 }, true),
        (&|radius| LensShape::Paraboloid { radius }, true),
        (&|_| plate(0.003, 0.5), false),
        (&|_| table.clone(), false),
    ];
    for (shape, has_radius) in shapes {
        let of = |radius: f64, pitch: f64| system(shape(radius), lattice(pitch));
        let (radius, pitch) = (400e-6, 14e-6);
        let control = Load::Indentation(0.9e-6);
        let force = |radius: f64, pitch: f64| {
            let system = of(radius, pitch);
            let gradient = fakir::gradient(&system, control, Method::default(), &Run::default());
            gradient.expect("a gradient")
        };
        let gradient = force(radius, pitch).force.expect("it is not prescribed");
        let step = 1e-5;
        let by = |one: f64, other: f64, length: f64| (one - other) / (2.0 * step * length);
        let forces = |radius: f64, pitch: f64| force(radius, pitch).contact.force;
        let [more, less] = [1.0, -1.0].map(|sign| forces(radius, pitch * (1.0 + sign * step)));
        let away = gradient.by(Quantity::Pitch).unwrap() / by(more, less, pitch) - 1.0;
        println!("pitch: {away:e}");
        assert!(away.abs() < 1e-4, "{away:e}");
        assert_eq!(gradient.by(Quantity::LensRadius).is_some(), has_radius);
        if let Some(by_radius) = gradient.by(Quantity::LensRadius) {
            let [more, less] = [1.0, -1.0].map(|sign| forces(radius * (1.0 + sign * step), pitch));
            let away = by_radius / by(more, less, radius) - 1.0;
            println!("radius: {away:e}");
            assert!(away.abs() < 1e-4, "{away:e}");
        }
    }
}

#[test]
fn what_cannot_be_is_refused_with_its_reason() {
    let lattice = PlaneLattice::new(LatticeForm::Square { pitch: 14e-6 });
    for shape in [cylinder(0.0), plate(0.0, 0.0)] {
        for infinite in [
            Arrangement::from(lattice),
            HexagonalLattice::new(14e-6).into(),
        ] {
            let refused = of_shape(shape.clone(), PillarCompliance::None, infinite).unwrap_err();
            assert!(matches!(refused.requirement, Requirement::FiniteUnder(_)));
            assert!(
                refused.to_string().contains("infinite number of pillars"),
                "{refused}"
            );
        }
    }
    let cut = PlaneLattice {
        columns: Some(5),
        ..lattice
    };
    let refused = |shape: LensShape| {
        of_shape(shape, PillarCompliance::None, cut)
            .unwrap_err()
            .quantity
    };
    for tilt in [-0.01, 0.2, f64::NAN] {
        assert_eq!(refused(plate(tilt, 0.0)), Quantity::LensTilt);
    }
    assert_eq!(
        refused(plate(0.0, f64::INFINITY)),
        Quantity::LensTiltDirection
    );
    assert_eq!(refused(cylinder(f64::NAN)), Quantity::LensAngle);
    for radius in [0.0, f64::NAN] {
        assert_eq!(
            refused(LensShape::Paraboloid { radius }),
            Quantity::LensRadius
        );
    }
    let low = LensShape::Cylinder {
        radius: 2e-6,
        angle: 0.0,
    };
    assert_eq!(refused(low), Quantity::PillarHeight);
}

/// Functions for spheres refuse other shapes.
#[test]
fn what_is_made_for_a_sphere_is_refused_under_others() {
    let hexagonal = HexagonalLattice::new(40e-6);
    let paraboloid = system(LensShape::Paraboloid { radius: RADIUS }, hexagonal);
    let run = Run::default();
    let control = Load::Indentation(1e-6);
    for method in [Method::Punch(PunchForm::Corrected), Method::Homogenised] {
        let error = fakir::press(&paraboloid, control, method, &run).unwrap_err();
        let expected = SolveError::Unsupported(Unsupported::BUT_FOR_A_SPHERE);
        assert_eq!(error, expected, "{error}");
    }
    for shape in [cylinder(0.0), plate(0.001, 0.0)] {
        let few = system(shape, list(&[[0.0, 0.0], [20e-6, 0.0]]));
        let error = fakir::transition(&few, Method::default(), &run).unwrap_err();
        assert!(error.to_string().contains("has no transition"), "{error}");
        let error = fakir::gradient(&few, Load::FloorContact, Method::default(), &run).unwrap_err();
        assert!(error.to_string().contains("has no transition"), "{error}");
        let deep = pressed(&few, Load::Indentation(2.5e-6));
        let beside = |warning: &Warning| matches!(warning, Warning::FloorBeside { .. });
        assert!(deep.warnings.iter().any(beside) && deep.smallest_floor_gap < 0.0);
    }
}

/// A tilted plate touches the pillars on its lower side while its centre is still above them.
#[test]
fn a_tilted_plate_has_contacts_at_negative_indentations() {
    let few = system(plate(0.01, 0.0), list(&[[-30e-6, 0.0], [30e-6, 0.0]]));
    let first = few.first_touch();
    assert!(first < 0.0);
    let contact = pressed(&few, Load::Indentation(0.5 * first));
    assert!(contact.force > 0.0 && contact.pillars_in_contact == 1);
    let back = pressed(&few, Load::Force(contact.force));
    assert!((back.indentation / contact.indentation - 1.0).abs() < 1e-8);
    let run = Run::default();
    let above = Load::Indentation(1.1 * first);
    assert!(fakir::press(&few, above, Method::default(), &run).is_err());
}
