//! Rounded tops on bodies of finite thickness: lenses on flat films, limits, boundary elements and derivatives.

use fakir::problem::{
    Accuracy, Adhesion, Asperity, AsperityArray, Base, Boundary, CyclePlan, FlatSystem, Floor,
    FloorModel, Grid, HeightMap, Indenter, Layer, LensShape, Load, Material, Point, Quantity,
    ShapedLens, SurfaceSystem, UnloadingPoint,
};
use fakir::state::{AsperityContact, AsperityDerivatives, Run};
use fakir::{Verdict, verify_asperities};

const UM: f64 = 1e-6;
const TOP: f64 = 100.0 * UM;

const RUBBER: Material = Material {
    young_modulus: 2e6,
    poisson_ratio: 0.5,
};
const GEL: Material = Material {
    young_modulus: 0.7e6,
    poisson_ratio: 0.42,
};

/// Films with every base.
fn films(thickness: f64) -> [Layer; 4] {
    let soft = Material::new(0.1e6, 0.3);
    let stiff = Material::new(50e6, 0.3);
    [
        Base::Rigid,
        Base::Frictionless,
        Base::Elastic(soft),
        Base::Elastic(stiff),
    ]
    .map(|base| Layer { thickness, base })
}

fn array(
    indenter: Indenter,
    tops: &[[f64; 3]],
    [substrate, of_indenter]: [Option<Layer>; 2],
) -> AsperityArray {
    let tops = tops
        .iter()
        .map(|[x, y, raised]| Asperity::new([x * UM, y * UM], TOP).raised_by(raised * UM));
    AsperityArray::new(indenter, RUBBER, tops.collect())
        .and_then(|array| Ok(array.with_layers(substrate, of_indenter)?))
        .expect("an array")
}

fn plate() -> Indenter {
    Indenter::Flat(Some(GEL))
}

fn sphere() -> Indenter {
    ShapedLens::new(LensShape::Paraboloid { radius: 1e-3 }, GEL).into()
}

fn pressed(array: &AsperityArray, load: Load, accuracy: Accuracy) -> AsperityContact {
    let contact = array
        .press(load, accuracy, &Run::default())
        .expect("a contact");
    assert!(contact.converged());
    contact
}

fn relative(found: f64, expected: f64) -> f64 {
    (found / expected - 1.0).abs()
}

/// The same bodies without a top: a paraboloid of the relative radius on a flat surface.
fn flat(layers: [Option<Layer>; 2]) -> FlatSystem {
    let lens = ShapedLens::new(LensShape::Paraboloid { radius: TOP }, GEL);
    let [substrate, of_lens] = layers;
    FlatSystem::new(lens, RUBBER)
        .and_then(|flat| Ok(flat.with_layers(substrate, of_lens)?))
        .expect("a system")
}

/// One top under a plate is a paraboloid on a flat surface, whose contact is computed with the kernel of the layers in closed form. The contact
/// radius is 0.1 to 5.5 of the thickness.
#[test]
#[ignore = "slow: contacts on films of several thicknesses"]
fn one_top_is_a_lens_on_a_flat_film() {
    let run = Run::default();
    for thickness in [8.0 * UM, 20.0 * UM, 70.0 * UM, 250.0 * UM] {
        for film in films(thickness) {
            for layers in [
                [Some(film), None],
                [Some(film), Some(Layer::new(2.0 * thickness))],
            ] {
                let one = array(plate(), &[[3.0, 7.0, 0.0]], layers);
                let load = Load::Force(200e-6);
                let expected = flat(layers).press(load, &run).expect("a contact");
                let ratio = expected.contact_radius / thickness;
                for accuracy in [Accuracy::Default, Accuracy::Accurate] {
                    let found = pressed(&one, load, accuracy);
                    let error = found.error.expect("an estimate");
                    let off = (found.indentation - expected.indentation).abs();
                    let of_area = relative(found.area, expected.contact_area);
                    println!(
                        "{ratio:.3} {film:?} {accuracy:?} {off:e} {:e} {of_area:e} {:e}",
                        error.indentation, error.area
                    );
                    // The other solution has errors up to 1e-9.
                    assert!(off <= error.indentation + 1e-8 * expected.indentation);
                    assert!(of_area <= error.area + 1e-8);
                    if ratio < 0.2 {
                        assert!(off < 1e-4 * expected.indentation && of_area < 1e-4);
                    }
                }
            }
        }
    }
}

/// Without adhesion as above; with it, at its pull-off force and its work of separation.
#[test]
fn adhesion_of_one_top_is_that_of_a_lens_on_a_film() {
    let run = Run::default();
    let layers = [Some(Layer::new(60.0 * UM)), None];
    let adhesion = Adhesion::new(50e-3);
    let one = array(plate(), &[[0.0, 0.0, 0.0]], layers).with_adhesion(adhesion);
    let system = flat(layers).with_adhesion(adhesion);
    let plan = CyclePlan {
        turn: UnloadingPoint::Force(20e-6),
        ..CyclePlan::default()
    };
    let found = one
        .expect("adhesion")
        .cycle(plan, Accuracy::Accurate, &run)
        .expect("a cycle");
    let expected = system
        .expect("adhesion")
        .cycle(&plan, &run)
        .expect("a cycle");
    let [found_off, expected_off] = [
        found.pull_off.as_ref().expect("tension").force,
        expected.pull_off.as_ref().expect("tension").force,
    ];
    let error = found.errors.pull_off_force;
    println!("{found_off:e} {expected_off:e} {error:e}");
    assert!(relative(found_off, expected_off) <= error + 1e-6);
    assert!(error < 1e-3);
    let (at_turn, expected) = (found.turn.indentation, expected.turn.indentation);
    let error = found.turn.error.expect("an estimate").indentation;
    println!("{at_turn:e} {expected:e} {error:e}");
    assert!((at_turn - expected).abs() <= error + 1e-6 * expected.abs());
}

/// Films a million times as thick as the contact is wide are half-spaces, but for a shift of the order of the ratio.
#[test]
fn thick_films_are_half_spaces() {
    let tops = [[0.0, 0.0, 0.0], [30.0, 0.0, 0.3], [-20.0, 25.0, -0.1]];
    let load = Load::Force(40e-6);
    let half = pressed(&array(sphere(), &tops, [None; 2]), load, Accuracy::Default);
    let thick = [Some(Layer::new(100.0)), Some(Layer::new(200.0))];
    let thick = pressed(&array(sphere(), &tops, thick), load, Accuracy::Default);
    assert!(relative(thick.indentation, half.indentation) < 2e-6);
    assert!(relative(thick.area, half.area) < 1e-9);
}

/// Two tops farther apart than a hundred thicknesses of a film on a rigid base do not act on each other.
#[test]
fn far_tops_on_a_film_are_alone() {
    let layers = [Some(Layer::new(20.0 * UM)), None];
    let of = |tops: &[[f64; 3]]| array(Indenter::Flat(None), tops, layers);
    let load = Load::Indentation(0.4 * UM);
    let [one, other] = [0.0, -0.15].map(|raised| {
        let alone = of(&[[0.0, 0.0, raised]]);
        pressed(&alone, load, Accuracy::Default).force
    });
    let both = of(&[[0.0, 0.0, 0.0], [2500.0, 0.0, -0.15]]);
    let both = pressed(&both, load, Accuracy::Default).force;
    assert!(relative(both, one + other) < 1e-9, "{both} {one} {other}");
}

/// Contacts on every top with boundary elements, on a film and under a layer.
#[test]
#[ignore = "slow: several tops on films, against boundary elements"]
fn boundary_elements_agree_on_films() {
    let tops = [
        [0.0, 0.0, 0.0],
        [26.0, 3.0, 0.2],
        [-20.0, 25.0, -0.1],
        [-9.0, -24.0, 0.1],
    ];
    for film in films(25.0 * UM) {
        let layers = [Some(film), Some(Layer::new(60.0 * UM))];
        let some = array(sphere(), &tops, layers);
        let load = Load::Force(40e-6);
        let found = verify_asperities(&some, load, 24, &Run::default()).expect("two contacts");
        println!("{:?} {:?} {:?}", found.force, found.indentation, found.area);
        assert_eq!(found.verdict(), Verdict::Agree);
        assert!(found.indentation.allowed < 0.03);
    }
}

/// Three full tops and the floor between them on films, against boundary elements on the height map of the same pillars. Beside the pillars an
/// incompressible film rises.
#[test]
#[ignore = "slow: tops and floor on films, against boundary elements"]
fn tops_and_floor_on_films_are_those_of_boundary_elements() {
    let pillars = [
        ([9.0, 4.0], 12.0, 0.0),
        ([-24.0, 0.0], 12.0, 0.2),
        ([2.0, 33.0], 12.0, 0.0),
    ];
    let depth = 1.5;
    let rigid = Material::new(1e300, 0.0);
    let lens = || ShapedLens::new(LensShape::Paraboloid { radius: 1e-3 }, rigid);
    for (ratio, thickness, indentation) in [(0.5, 40.0, 2.6), (0.3, 15.0, 2.4)] {
        let film = Some(Layer::new(thickness * UM));
        let material = Material::new(1e6, ratio);
        let tops = pillars.map(|([x, y], rim, raised)| Asperity {
            rim_radius: Some(rim * UM),
            ..Asperity::new([x * UM, y * UM], TOP).raised_by(raised * UM)
        });
        let array = AsperityArray::new(lens().into(), material, tops.to_vec())
            .and_then(|it| Ok(it.with_layers(film, None)?.with_floor(depth * UM)?))
            .expect("an array");
        let found = pressed(
            &array,
            Load::Indentation(indentation * UM),
            Accuracy::Default,
        );
        let on_floor = found.floor.as_ref().expect("a floor in contact");
        let (half, cell) = (84.0, 0.8);
        let count = (2.0 * half / cell) as usize;
        let grid = Grid::new(count, count, [cell * UM; 2], [-half * UM; 2]).expect("a grid");
        let height = |[x, y]: Point| {
            let heights = pillars.iter().map(|([u, v], rim, raised)| {
                let away = (x / UM - u).hypot(y / UM - v);
                let top = raised - away * away / (2.0 * TOP / UM);
                if away < *rim { top } else { -depth }
            });
            UM * heights.fold(-depth, f64::max)
        };
        let map = HeightMap::from_height(grid, height).expect("a map");
        let load = Load::Indentation(indentation * UM + map.highest());
        let other = SurfaceSystem::new(lens().into(), material, map, Boundary::FreeSpace)
            .and_then(|it| it.with_layers(film, None))
            .expect("a system")
            .with_floor(Floor::AtOrBelow(-(depth - 1e-6) * UM))
            .press(load, &Run::default())
            .expect("a contact");
        let share = other.shares.as_ref().expect("shares").floor.force / other.force;
        let [force, shared] = [found.force / other.force, on_floor.share / share].map(|x| x - 1.0);
        let [own, of_other] = [
            found.error.expect("an estimate").force,
            other.error.expect("an estimate").force,
        ];
        let of_share = other.floor_error.expect("an estimate").share;
        println!(
            "force {force:e} ({own:e}, {of_other:e}), share {share:.5}: {shared:e} ({:e}, {of_share:e})",
            on_floor.error.share
        );
        assert!(share > 0.05, "{share}");
        assert!(own < 0.01 && on_floor.error.share < 0.02);
        assert!(force.abs() < own + of_other);
        assert!(shared.abs() < on_floor.error.share + of_share);
        // The map of the gap contains both bodies: it is zero in the middle of the floor contact, and nowhere negative on the floor.
        let fields = found.fields(&array, depth * UM).expect("fields");
        let (largest, at) = on_floor.largest_pressure();
        assert!(largest > 0.0 && fields.gap(at).abs() < 2e-3 * depth * UM);
    }
}

/// The critical state is where the gap is zero in the contact at the same indentation, whose field the maps compute, and the displacement
/// beside the tops of an incompressible film is smaller than on a half-space.
#[test]
fn critical_states_on_films() {
    let run = Run::default();
    let tops = [[0.0, 17.0, 0.0], [15.0, -9.0, 0.0], [-15.0, -9.0, 0.0]];
    let of = |layers: [Option<Layer>; 2]| {
        array(sphere(), &tops, layers)
            .with_floor(1.0 * UM)
            .expect("a floor")
    };
    let mut last = None;
    for layers in [[None; 2], [Some(Layer::new(20.0 * UM)), None]] {
        let array = of(layers);
        let critical = array.transition(Accuracy::Default, &run).expect("a state");
        assert!(critical.contact.converged());
        let fields = critical.contact.fields(&array, UM).expect("fields");
        let gap = fields.gap(critical.floor_contact);
        assert!(gap.abs() < 1e-9 * UM, "{gap:e}");
        let beside = [0, 1].map(|k| critical.floor_contact[k] + [0.3, -0.2][k] * UM);
        assert!(fields.gap(beside) > 0.0);
        let sink = fields.displacement(critical.floor_contact);
        let part = sink / critical.contact.force;
        if let Some(on_half_space) = last.replace(part) {
            assert!(part < on_half_space, "{part:e} {on_half_space:e}");
        }
    }
}

/// Exact derivatives against central differences over 1e-4 of every quantity, at an indentation, under a force, and at the critical state.
#[test]
#[ignore = "slow: derivatives by all layers, against differences"]
fn derivatives_with_layers_are_those_of_differences() {
    let run = Run::default();
    let base = Material::new(5e6, 0.3);
    let build = |film: f64, of_lens: f64, moduli: [f64; 3]| {
        let [substrate, lens, below] = moduli;
        let tops = [[0.0, 12.0, 0.0], [15.0, -9.0, 0.1], [-17.0, -9.0, 0.0]];
        let tops = tops
            .iter()
            .map(|[x, y, raised]| Asperity::new([x * UM, y * UM], TOP).raised_by(raised * UM));
        let shape = LensShape::Paraboloid { radius: 1e-3 };
        let indenter = ShapedLens::new(shape, Material::new(lens * 1e6, 0.42));
        let substrate = Material::new(substrate * 1e6, 0.48);
        let film = Layer {
            thickness: film * UM,
            base: Base::Elastic(Material {
                young_modulus: below * 1e6,
                ..base
            }),
        };
        AsperityArray::new(indenter.into(), substrate, tops.collect())
            .and_then(|it| Ok(it.with_layers(Some(film), Some(Layer::new(of_lens * UM)))?))
            .and_then(|it| Ok(it.with_floor(1.0 * UM)?))
            .expect("an array")
            .with_floor_model(FloorModel::Ignored)
    };
    let values = [30.0, 80.0, 2.0, 0.7, 5.0];
    let names = [
        Quantity::SubstrateThickness,
        Quantity::LensThickness,
        Quantity::SubstrateYoungModulus,
        Quantity::LensYoungModulus,
        Quantity::SubstrateBaseYoungModulus,
    ];
    let with = |v: [f64; 5]| build(v[0], v[1], [v[2], v[3], v[4]]);
    let units = [UM, UM, 1e6, 1e6, 1e6];
    let whole = with(values);
    for load in [
        Load::Indentation(0.8 * UM),
        Load::Force(50e-6),
        Load::FloorContact,
    ] {
        let gradient = whole
            .gradient(load, Accuracy::Default, &run)
            .expect("derivatives");
        for (number, quantity) in names.into_iter().enumerate() {
            let step = 1e-4 * values[number];
            let at = |by: f64| {
                let mut changed = values;
                changed[number] += by;
                let array = with(changed);
                let contact = array
                    .press(load, Accuracy::Default, &run)
                    .expect("a contact");
                (array.reduced_modulus(), contact)
            };
            let (above, below) = (at(step), at(-step));
            let width = 2.0 * step * units[number];
            let by_modulus = (above.0 - below.0) / width;
            let derivative = |of: &AsperityDerivatives| {
                let layers = of.layers.iter().find(|(name, _)| *name == quantity);
                of.reduced_modulus * by_modulus + layers.expect("a derivative").1
            };
            let check = |of: Option<&AsperityDerivatives>, value: fn(&AsperityContact) -> f64| {
                let Some(of) = of else {
                    return;
                };
                let found = derivative(of);
                let expected = (value(&above.1) - value(&below.1)) / width;
                let scale = value(&gradient.contact) / (values[number] * units[number]);
                println!("{load:?} {quantity:?} {found:e} {expected:e}");
                // Iterations end at a relative change of 1e-9.
                let off = (found - expected).abs();
                assert!(off < 1e-5 * expected.abs() + 1e-6 * scale, "{off:e}");
            };
            check(gradient.force.as_ref(), |it| it.force);
            check(gradient.indentation.as_ref(), |it| it.indentation);
            check(Some(&gradient.area), |it| it.area);
        }
    }
}
