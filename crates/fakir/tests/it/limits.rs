//! Validity limits of the model: each is exceeded once and compared with closed forms.

use crate::common::{INTERMEDIATE, paper_lattice, paper_lens, paper_pillar, paper_system};
use fakir::problem::{
    FloorModel, HexagonalLattice, Layer, Lens, ListedPillar, Load, Material, Method, Pillar,
    PillarCompliance, PillarList, PillarPattern, System,
};
use fakir::state::{ContactState, Limit, Run};
use std::f64::consts::PI;

const COLUMN: PillarCompliance = PillarCompliance::Column;

fn critical(system: &System) -> ContactState {
    let found = fakir::transition(system, Method::default(), &Run::default());
    found.expect("a critical state").contact
}

fn press(system: &System, control: Load) -> ContactState {
    let found = fakir::press(system, control, Method::default(), &Run::default());
    found.expect("a contact")
}

fn limit(state: &ContactState, name: &str) -> Limit {
    let limits = state.limits(None);
    let found = limits.iter().find(|limit| limit.name == name);
    *found.unwrap_or_else(|| panic!("no {name} in {limits:?}"))
}

/// The lens and pillars of the paper with another pillar height, on the given substrate.
fn of_height(height: f64, phi: f64, modulus: f64) -> System {
    let pillar = Pillar {
        height,
        ..paper_pillar(COLUMN)
    };
    System::new(
        paper_lens(),
        Material::new(modulus, 0.5),
        PillarPattern::new(pillar, paper_lattice(phi, 0.0)),
    )
    .expect("a valid system")
}

/// Two pillars on a floor that carries most of the load: the farthest contact is on the floor.
#[test]
fn the_floor_beyond_the_pillars_is_part_of_the_contact() {
    let lens = Lens {
        radius: 150e-6,
        material: Material::new(INTERMEDIATE, 0.5),
    };
    let pillar = |x: f64| ListedPillar {
        centre: [x, 0.0],
        height: 2.2e-6,
        diameter: 6e-6,
    };
    let list = PillarList::new(vec![pillar(-5e-6), pillar(5e-6)]).expect("pillars apart");
    let pattern = PillarPattern::new(paper_pillar(COLUMN), list);
    let system = System::new(lens, Material::new(INTERMEDIATE, 0.5), pattern);
    let state = press(&system.expect("a valid system"), Load::Indentation(30e-6));
    let floor = state.floor.as_ref().expect("a floor in contact");
    assert!(floor.radius > 3.0 * state.contact_radius);
    assert!((state.whole_contact_radius() / floor.radius - 1.0).abs() < 1e-15);
    // The slope of a sphere is reported as that of a paraboloid, r/R.
    for name in ["contact_radius_over_lens_radius", "slope"] {
        let found = limit(&state, name);
        let ratio = floor.radius / 150e-6;
        assert!(found.strained && (found.value / ratio - 1.0).abs() < 1e-12);
    }
    // The error is that of a cell.
    let error = state.relative_whole_contact_radius_error() * floor.radius;
    assert!(error > floor.cell()[0] && error < 2.0 * floor.cell()[0]);
}

#[test]
fn a_light_contact_strains_nothing() {
    let system = paper_system(paper_lattice(0.1, 0.0), INTERMEDIATE, COLUMN);
    let state = press(&system, Load::Force(5e-6));
    let limits = state.limits(None);
    assert!(limits.iter().all(|limit| !limit.strained), "{limits:?}");
    assert!(
        limits
            .iter()
            .all(|limit| limit.nearness().unwrap_or(0.0) < 1.0)
    );
    // Without a force, no effect can change it.
    let untouched = press(&system, Load::Force(0.0)).limits(None);
    assert!(untouched.iter().all(|limit| limit.threshold.is_some()));
}

/// `a = sqrt(R zeta)` for Hertz's contact is a quarter of the lens radius, and the slope has the same value.
#[test]
fn wide_contacts() {
    let lens = Lens {
        radius: 100e-6,
        material: Material::new(INTERMEDIATE, 0.5),
    };
    let pillar = paper_pillar(COLUMN);
    let lattice = HexagonalLattice::with_surface_fraction(0.2, pillar.diameter);
    let substrate = Material::new(INTERMEDIATE, 0.5);
    let system = System::new(lens, substrate, PillarPattern::new(pillar, lattice)).unwrap();
    let state = press(&system, Load::Indentation(8e-6));
    let ratio = state.contact_radius / 100e-6;
    for name in ["slope", "contact_radius_over_lens_radius"] {
        let found = limit(&state, name);
        assert!((found.value / ratio - 1.0).abs() < 1e-12);
        assert!(found.strained && found.value > 0.2, "{found:?}");
    }
}

/// For a single pillar under the axis, the force is that of the contact.
#[test]
fn hard_pressed_and_slender_pillars() {
    let alone = of_height(2.2e-6, 1e-3, INTERMEDIATE).with_floor(FloorModel::Ignored);
    let state = press(&alone, Load::Force(20e-6));
    assert_eq!(state.pillars.len(), 1);
    let stress = 20e-6 / (PI * 9e-12) / INTERMEDIATE;
    let found = limit(&state, "pillar_stress");
    assert!((found.value / stress - 1.0).abs() < 1e-12);
    assert!(found.strained && !limit(&state, "buckling").strained);
    // `F h^2/(pi^2 E I)` with `I = pi d^4/64`.
    let slender = of_height(24e-6, 1e-3, INTERMEDIATE);
    let state = press(&slender, Load::Force(5e-6));
    let second_moment = PI * 6e-6_f64.powi(4) / 64.0;
    let expected = 5e-6 * 24e-6_f64.powi(2) / (PI * PI * INTERMEDIATE * second_moment);
    let found = limit(&state, "buckling");
    assert!((found.value / expected - 1.0).abs() < 1e-12);
    assert!(found.strained && !limit(&state, "pillar_stress").strained);
}

/// The column compared with finite elements (`reference/pillar_compliance.csv`, h/d = 0.3667): 3.9 % too compliant under a rigid punch, to
/// which the lens is equivalent on a soft substrate, and 0.2 % for equal moduli.
#[test]
fn columns_beside_elastic_pillars() {
    for (modulus, expected, strained) in [(2e3, 0.0385, true), (INTERMEDIATE, 0.0020, false)] {
        let system = paper_system(paper_lattice(0.1, 0.0), modulus, COLUMN);
        let found = limit(&critical(&system), "pillar_compliance");
        assert!((found.value - expected).abs() < 1e-3, "{found:?}");
        assert_eq!(found.strained, strained);
    }
    let system = paper_system(paper_lattice(0.1, 0.0), 2e3, PillarCompliance::Elastic);
    let found = limit(&critical(&system), "elastic_pillar_error");
    assert!(found.threshold.is_none() && found.value < 2e-3);
    // A pillar without compliance is too stiff by the whole compliance.
    let system = paper_system(
        paper_lattice(0.1, 0.0),
        INTERMEDIATE,
        PillarCompliance::None,
    );
    assert!(limit(&critical(&system), "pillar_compliance").strained);
    // For other materials no data are available.
    let cork = Material::new(INTERMEDIATE, 0.1);
    let pattern = PillarPattern::new(paper_pillar(COLUMN), paper_lattice(0.1, 0.0));
    let system = System::new(paper_lens(), cork, pattern).unwrap();
    let limits = critical(&system).limits(None);
    assert!(limits.iter().all(|limit| limit.name != "pillar_compliance"));
}

/// Critical states on films of the paper's intermediate substrate, solved with layers: at 1 mm the indentation is 0.70 %, 2.0 % and 6.3 %
/// lower at surface fractions of 0.01, 0.03 and 0.1, at 2 mm 0.35 %, 0.99 % and 3.1 %, at 0.5 mm 1.4 %, 3.9 % and 12.8 %.
#[test]
fn thickness_that_would_matter() {
    // Bounds of the thickness for a change of 1 %, in mm.
    for (phi, name, thinner, thicker) in [
        (0.01, "substrate_thickness_of_one_percent_m", 0.66, 0.74),
        (0.03, "substrate_thickness_of_one_percent_m", 1.9, 2.05),
        (0.1, "substrate_thickness_of_one_percent_m", 6.0, 6.6),
    ] {
        let system = paper_system(paper_lattice(phi, 0.0), INTERMEDIATE, COLUMN);
        let state = critical(&system);
        let found = limit(&state, name);
        println!("{phi} {name} {:e}", found.value);
        assert!(
            (thinner..thicker).contains(&(1e3 * found.value)),
            "{found:?}"
        );
        // The lens consists of the same material.
        let of_lens = limit(&state, &name.replace("substrate", "lens"));
        assert!((of_lens.value / found.value - 1.0).abs() < 1e-12);
        assert!(!found.strained && found.threshold.is_none());
        // A tenth of the thickness changes the indentation by about ten times as much, except for the effect of the curvature.
        let tenth = limit(&state, "substrate_thickness_of_ten_percent_m");
        assert!(
            (9.5..11.5).contains(&(found.value / tenth.value)),
            "{tenth:?}"
        );
    }
}

/// At the reported work of adhesion, the pull-off force of `N` of Kendall's punches, `sqrt(8 pi w E* a^3)` each, is a hundredth of the
/// force.
#[test]
fn adhesion_that_would_matter() {
    let system = paper_system(paper_lattice(0.03, 0.0), INTERMEDIATE, COLUMN);
    let state = critical(&system);
    let work = limit(&state, "work_of_adhesion_of_one_percent_J_per_m2").value;
    let one = fakir::theory::adhesion::kendall_pull_off(system.reduced_modulus(), 3e-6, work);
    let all = one * state.pillars.len() as f64;
    assert!((-100.0 * all / state.force - 1.0).abs() < 1e-12);
    // With adhesion the value is not reported.
    let adhesive = system
        .with_adhesion(fakir::problem::Adhesion::new(1e-3))
        .unwrap();
    let limits = critical(&adhesive).limits(None);
    assert_eq!(limits[0].name, "kendall_strain");
    assert!(limits.iter().all(|limit| !limit.name.starts_with("work")));
}

/// For layers, each limit is exceeded once; the thickness at which a finite thickness would be significant is not reported for them.
#[test]
fn layers_beyond_their_range_of_validity() {
    let system = paper_system(paper_lattice(0.05, 0.0), INTERMEDIATE, COLUMN);
    let with = |film: Option<f64>, lens: Option<f64>| {
        let layers = [film, lens].map(|thickness| thickness.map(Layer::new));
        system.with_layers(layers[0], layers[1]).unwrap()
    };
    let names = |state: &ContactState| -> Vec<&str> {
        let limits = state.limits(None);
        limits.into_iter().map(|limit| limit.name).collect()
    };
    // At 3 um the contact extends to 80 um.
    let load = Load::Indentation(3e-6);
    let thick = press(&with(Some(1e-3), Some(1e-3)), load);
    let limits = thick.limits(None);
    assert!(limits.iter().all(|limit| !limit.strained), "{limits:?}");
    assert!(names(&thick).iter().all(|name| !name.contains("percent_m")));
    let ratio = thick.contact_radius / 1e-3;
    for (name, value, threshold) in [
        ("contact_radius_over_substrate_thickness", ratio, None),
        ("contact_radius_over_lens_thickness", ratio, Some(1.0)),
        ("lens_thickness_over_radius", 1.0 / 2.2, Some(0.5)),
        ("indentation_over_thickness", 3e-3, Some(0.05)),
        ("thickness_over_diameter", 1000.0 / 6.0, Some(2.0)),
    ] {
        let found = limit(&thick, name);
        assert!((found.value / value - 1.0).abs() < 1e-12, "{found:?}");
        assert_eq!(found.threshold, threshold);
    }
    let near_half_a_sphere = press(&with(None, Some(1.2e-3)), load);
    assert!(limit(&near_half_a_sphere, "lens_thickness_over_radius").strained);
    let of_film = names(&near_half_a_sphere);
    assert!(of_film.contains(&"substrate_thickness_of_one_percent_m"));
    assert!(!of_film.contains(&"lens_thickness_of_one_percent_m"));
    let thin_lens = press(&with(None, Some(40e-6)), load);
    for name in [
        "contact_radius_over_lens_thickness",
        "indentation_over_thickness",
    ] {
        assert!(limit(&thin_lens, name).strained, "{name}");
    }
    assert!(!limit(&thin_lens, "thickness_over_diameter").strained);
    // A flat film is valid for any width of the contact.
    let film = press(&with(Some(40e-6), None), load);
    let wide = limit(&film, "contact_radius_over_substrate_thickness");
    assert!(wide.value > 1.0 && !wide.strained && wide.threshold.is_none());
    let thin = press(&with(Some(11e-6), None), Load::Indentation(0.5e-6));
    assert!(limit(&thin, "thickness_over_diameter").strained);
    assert!(!limit(&thin, "indentation_over_thickness").strained);
}
