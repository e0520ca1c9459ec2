//! Tests of drawn patterns.

use crate::problem::pattern::*;
use crate::problem::{
    Disorder, Grid, HeightMap, HexagonalLattice, LatticeForm, ListedPillar, Material,
    PillarCompliance, PillarList, PlaneLattice, RandomPlaces, Scatter,
};
use proptest::prelude::*;

const HEIGHT: f64 = 2.0e-6;

fn rubber() -> Material {
    Material::new(2.0e6, 0.5)
}

fn pillar(cross_section: CrossSection, orientation: f64) -> PillarShape {
    PillarShape {
        cross_section,
        orientation,
        ..PillarShape::cylinder(1.0, HEIGHT)
    }
}

/// Outlines of about 6 um, with their rotations.
fn pillars() -> [PillarShape; 5] {
    [
        pillar(CrossSection::Circle { diameter: 6.0e-6 }, 0.0),
        pillar(CrossSection::Square { side: 5.0e-6 }, 0.3),
        pillar(
            CrossSection::Polygon {
                sides: 3,
                diameter: 6.0e-6,
            },
            1.0,
        ),
        pillar(
            CrossSection::Polygon {
                sides: 6,
                diameter: 6.0e-6,
            },
            0.2,
        ),
        pillar(
            CrossSection::Ellipse {
                length: 7.0e-6,
                width: 3.0e-6,
            },
            0.7,
        ),
    ]
}

fn hexagonal(pitch: f64) -> PlaneLattice {
    HexagonalLattice::new(pitch).into()
}

fn square(pitch: f64) -> PlaneLattice {
    PlaneLattice {
        offset: 0.2f64.hypot(0.3),
        offset_angle: 0.3f64.atan2(0.2),
        ..PlaneLattice::new(LatticeForm::Square { pitch })
    }
}

/// Pillars with uniformly distributed heights, some of which are missing.
fn disordered(lattice: PlaneLattice, half_width: f64, missing: f64, seed: u64) -> PlaneLattice {
    let heights = Scatter::uniform(half_width, seed);
    PlaneLattice {
        disorder: Disorder { heights, missing },
        ..lattice
    }
}

fn covered(surface: &HeightMap) -> f64 {
    let labels = surface.pillars().map_or(&[][..], |pillars| &pillars.labels);
    let on_pillars = labels.iter().filter(|l| **l != HeightMap::NO_PILLAR);
    on_pillars.count() as f64 / labels.len() as f64
}

#[test]
fn surface_fraction_is_that_of_the_cells() {
    // Complete periods, with cells of a fiftieth of a pillar.
    let pitch = 9.0e-6;
    let grids = |lattice: &PlaneLattice| match lattice.form {
        LatticeForm::Hexagonal { .. } => {
            let [width, height] = [3f64.sqrt() * pitch, pitch];
            Grid::new(120, 70, [width / 120.0, height / 70.0], [0.3e-6, -1.0e-6])
        }
        _ => Grid::new(80, 80, [pitch / 80.0; 2], [0.1e-6, 0.2e-6]),
    };
    for pillar in pillars() {
        for lattice in [hexagonal(pitch), square(pitch)] {
            let pattern = Pattern::new(pillar, lattice);
            let grid = grids(&lattice).unwrap();
            let surface = pattern.height_map(&grid, &rubber()).unwrap();
            let error = covered(&surface) / pattern.surface_fraction() - 1.0;
            assert!(error.abs() < 0.01, "{pattern:?}: {error}");
        }
        let area = pillar.cross_section.area();
        let places = RandomPlaces::with_surface_fraction(0.1, area, 7.5e-6);
        let pattern = Pattern::new(pillar, places);
        let grid = Grid::centred(1000, 800, 0.2e-6).unwrap();
        let surface = pattern.height_map(&grid, &rubber()).unwrap();
        // Half a pillar of 113 to 274, and the discretisation by cells.
        let error = covered(&surface) / pattern.surface_fraction() - 1.0;
        assert!(error.abs() < 0.006, "{pattern:?}: {error}");
    }
}

/// The centres of 24 by 24 cells do not include the apex of a cone, from which indentations are nevertheless measured.
#[test]
fn a_surface_is_as_high_as_the_apex_of_a_cone() {
    let grid = Grid::centred(24, 24, 1e-6).unwrap();
    let cone = PillarShape {
        top: Top::Cone { drop: 0.5 * HEIGHT },
        ..pillar(CrossSection::Circle { diameter: 16e-6 }, 0.0)
    };
    let surface = Pattern::new(cone, hexagonal(30e-6)).height_map(&grid, &rubber());
    let surface = surface.unwrap();
    let cells = surface.heights().iter().copied().fold(0.0, f64::max);
    assert!(cells < 0.99 * HEIGHT);
    assert_eq!(surface.highest().to_bits(), HEIGHT.to_bits());
    // The apex is outside this grid.
    let beside = Grid::new(24, 24, [1e-6; 2], [2e-6, 2e-6]).unwrap();
    let part = Pattern::new(cone, hexagonal(60e-6)).height_map(&beside, &rubber());
    assert!(part.unwrap().highest() < 0.99 * HEIGHT);
}

#[test]
fn symmetric_patterns_are_symmetric() {
    let grid = Grid::centred(301, 301, 0.13e-6).unwrap();
    let hexagon = CrossSection::Polygon {
        sides: 6,
        diameter: 5.0e-6,
    };
    let on_axis = |cross_section, lattice: PlaneLattice| {
        Pattern::new(pillar(cross_section, 0.0), lattice)
            .height_map(&grid, &rubber())
            .unwrap()
    };
    let at = |surface: &HeightMap, column: usize, row: usize| surface.heights()[row * 301 + column];
    let circle = CrossSection::Circle { diameter: 5.0e-6 };
    for outline in [circle, hexagon] {
        let surface = on_axis(outline, hexagonal(8.1e-6));
        for row in 0..301 {
            for column in 0..301 {
                let height = at(&surface, column, row).to_bits();
                assert_eq!(height, at(&surface, 300 - column, row).to_bits());
                assert_eq!(height, at(&surface, column, 300 - row).to_bits());
            }
        }
    }
    let lattice = PlaneLattice::new(LatticeForm::Square { pitch: 8.1e-6 });
    let surface = on_axis(CrossSection::Square { side: 5.0e-6 }, lattice);
    for row in 0..301 {
        for column in 0..301 {
            let turned = at(&surface, 300 - row, column).to_bits();
            assert_eq!(at(&surface, column, row).to_bits(), turned);
        }
    }
}

#[test]
fn the_seed_decides_and_the_grid_does_not() {
    let pattern = |seed| {
        let lattice = disordered(hexagonal(9.0e-6), 0.1, 0.2, seed);
        Pattern::new(pillars()[0], lattice)
    };
    let small = Grid::centred(200, 160, 0.5e-6).unwrap();
    let large = Grid::centred(400, 300, 0.5e-6).unwrap();
    let drawn = |pattern: &Pattern, grid| pattern.height_map(grid, &rubber()).unwrap();
    let first = drawn(&pattern(11), &small);
    assert_eq!(first, drawn(&pattern(11), &small));
    assert_ne!(first, drawn(&pattern(12), &small));
    let wide = drawn(&pattern(11), &large);
    for (cell, height) in first.heights().iter().enumerate() {
        let (column, row) = (cell % 200 + 100, cell / 200 + 70);
        assert_eq!(
            height.to_bits(),
            wide.heights()[row * 400 + column].to_bits()
        );
    }
}

#[test]
fn vacancies_have_the_requested_number() {
    let pattern = |missing| {
        let lattice = disordered(square(8.0e-6), 0.0, missing, 5);
        Pattern::new(pillars()[0], lattice)
    };
    let grid = Grid::centred(400, 400, 1.0e-6).unwrap();
    let count = |missing| {
        let surface = pattern(missing).height_map(&grid, &rubber()).unwrap();
        surface
            .pillars()
            .map_or(0, |pillars| pillars.compliance.len()) as f64
    };
    let all = count(0.0);
    // Four standard deviations of the binomial distribution.
    let deviation = 4.0 * (all * 0.3 * 0.7).sqrt();
    assert!((count(0.3) - 0.7 * all).abs() < deviation);
}

#[test]
fn columns_follow_hooke() {
    // 4 h/(pi E d^2).
    let grid = Grid::centred(40, 40, 0.5e-6).unwrap();
    let pattern = Pattern::new(PillarShape::cylinder(6.0e-6, HEIGHT), hexagonal(60.0e-6));
    let compliance = |pattern: &Pattern| {
        let surface = pattern.height_map(&grid, &rubber()).unwrap();
        surface.pillars().unwrap().compliance.clone()
    };
    let expected = 4.0 * HEIGHT / (std::f64::consts::PI * 2.0e6 * 36.0e-12);
    let found = compliance(&pattern);
    assert!(found.len() == 1 && (found[0] / expected - 1.0).abs() < 1e-14);
    let mut stiff = pattern;
    stiff.pillar.compliance = PillarCompliance::None;
    assert!(compliance(&stiff)[0].abs() < f64::MIN_POSITIVE);
}

#[test]
fn tops_are_drawn_with_their_form() {
    let grid = Grid::centred(64, 64, 0.1e-6).unwrap();
    let drawn = |top| {
        let pillar = PillarShape {
            top,
            ..PillarShape::cylinder(6.0e-6, HEIGHT)
        };
        Pattern::new(pillar, hexagonal(60.0e-6))
            .height_map(&grid, &rubber())
            .unwrap()
    };
    let cone = drawn(Top::Cone { drop: 1.0e-6 });
    let rounded = drawn(Top::Rounded { radius: 1.0e-6 });
    for (cell, [x, y]) in grid.centres().enumerate() {
        let r = x.hypot(y);
        let inside = r < 3.0e-6;
        let expected = HEIGHT - r / 3.0;
        let expected = if inside { expected } else { 0.0 };
        assert!((cone.heights()[cell] - expected).abs() < 1e-20);
        // A torus of radii 2 um and 1 um.
        let beyond = (r - 2.0e-6).max(0.0);
        let fillet = HEIGHT - 1.0e-6 + (1.0e-12 - beyond * beyond).max(0.0).sqrt();
        let expected = if inside { fillet } else { 0.0 };
        assert!((rounded.heights()[cell] - expected).abs() < 1e-18);
    }
}

#[test]
fn what_cannot_be_is_refused() {
    let grid = Grid::centred(20, 20, 1.0e-6).unwrap();
    let refused = |pattern: Pattern| pattern.height_map(&grid, &rubber()).unwrap_err();
    let [circle, square_pillar, ..] = pillars();
    assert!(matches!(
        refused(Pattern::new(circle, hexagonal(5.9e-6))),
        InvalidPattern::Overlap { .. }
    ));
    // Unrotated squares fit, rotated ones do not.
    let upright = PillarShape {
        orientation: 0.0,
        ..square_pillar
    };
    assert!(Pattern::new(upright, square(5.0e-6)).check().is_ok());
    assert!(matches!(
        refused(Pattern::new(square_pillar, square(5.0e-6))),
        InvalidPattern::Overlap { .. }
    ));
    let quantity = |pattern: Pattern| match refused(pattern) {
        InvalidPattern::Value { quantity, .. } => quantity,
        other => panic!("{other}"),
    };
    let good = hexagonal(9.0e-6);
    let with_top = |top| Pattern::new(PillarShape { top, ..circle }, good);
    use PatternQuantity as Q;
    for (pattern, expected) in [
        (
            Pattern::new(circle, disordered(good, 0.0, 1.0, 0)),
            Q::Missing,
        ),
        (
            Pattern::new(circle, disordered(good, f64::NAN, 0.0, 0)),
            Q::HeightHalfWidth,
        ),
        (Pattern::new(circle, hexagonal(-1.0)), Q::Pitch),
        (with_top(Top::Cone { drop: 3.0e-6 }), Q::Drop),
        (with_top(Top::Rounded { radius: 2.5e-6 }), Q::EdgeRadius),
        (
            with_top(Top::Chamfer {
                width: 3.1e-6,
                drop: 0.0,
            }),
            Q::ChamferWidth,
        ),
        (
            Pattern::new(
                pillar(
                    CrossSection::Polygon {
                        sides: 2,
                        diameter: 1.0,
                    },
                    0.0,
                ),
                good,
            ),
            Q::Sides,
        ),
        (
            Pattern::new(
                circle,
                RandomPlaces::with_surface_fraction(0.1, circle.cross_section.area(), 5.0e-6),
            ),
            Q::MinimumDistance,
        ),
    ] {
        assert_eq!(quantity(pattern), expected);
    }
    let listed = ListedPillar {
        centre: [0.0; 2],
        height: HEIGHT,
        diameter: 6.0e-6,
    };
    let list = PillarList::new(vec![listed]).unwrap();
    assert_eq!(refused(Pattern::new(circle, list)), InvalidPattern::Listed);
    let turned = PlaneLattice {
        rotation: 0.1,
        ..good
    };
    let periodic = Pattern::new(circle, turned).periodic_height_map(&grid, &rubber());
    assert_eq!(periodic.unwrap_err(), InvalidPattern::NoPeriod);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn cells_are_floor_or_pillar(
        which in 0usize..5,
        on_square in any::<bool>(),
        pitch in 8.0e-6..30.0e-6,
        missing in 0.0..0.9,
        spread in 0.0..0.5,
        seed in any::<u64>(),
    ) {
        let lattice = if on_square { square(pitch) } else { hexagonal(pitch) };
        let pattern = Pattern::new(pillars()[which], disordered(lattice, spread, missing, seed));
        let grid = Grid::centred(90, 70, 0.7e-6).unwrap();
        let surface = pattern.height_map(&grid, &rubber()).unwrap();
        let pillars = surface.pillars().unwrap();
        let mut heights = vec![None; pillars.compliance.len()];
        for (label, height) in pillars.labels.iter().zip(surface.heights()) {
            if *label == HeightMap::NO_PILLAR {
                prop_assert!(height.abs() < f64::MIN_POSITIVE);
            } else {
                prop_assert!((HEIGHT * (1.0 - spread)..=HEIGHT * (1.0 + spread)).contains(height));
                // Flat tops are level.
                let own = heights[*label as usize].get_or_insert(*height);
                prop_assert_eq!(own.to_bits(), height.to_bits());
            }
        }
        // Every label is used.
        prop_assert!(heights.iter().all(Option::is_some));
    }
}
