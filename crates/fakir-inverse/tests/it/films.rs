//! Designs of cases whose bodies are layers.

use fakir::state::Run;
use fakir_case::{Case, CaseFile, Key};
use fakir_inverse::design::{Design, Wanted, design, free_keys};

/// Takes the critical force of a film and a lens that are layers on elastic bases, removes one of their quantities, and finds it again; also the
/// thickness of a film that is not given.
#[test]
#[ignore = "slow: fits on layers"]
fn layers_are_found_again() {
    let run = Run::default();
    let mut half_spaces = CaseFile::parse("paper", &Case::example().to_toml()).unwrap();
    half_spaces.set_number(Key::SurfaceFraction, 0.05);
    let with_layers = |settings: &[&str]| {
        let mut file = half_spaces.clone();
        for setting in settings {
            file.set(setting).unwrap();
        }
        file
    };
    let on_bases = with_layers(&[
        "substrate.thickness=0.2 mm",
        "substrate.base=elastic",
        "substrate.base_young_modulus=5 MPa",
        "substrate.base_poisson_ratio=0.4",
        "lens.thickness=0.3 mm",
        "lens.base=elastic",
        "lens.base_young_modulus=5 MPa",
        "lens.base_poisson_ratio=0.4",
    ]);
    let film = with_layers(&["substrate.thickness=0.2 mm"]);
    let of_layers = free_keys().into_iter().filter(|key| key.is_of_layers());
    let mut searches: Vec<(Key, &CaseFile, f64)> =
        of_layers.map(|key| (key, &on_bases, 0.7)).collect();
    assert_eq!(searches.len(), 4);
    searches.push((Key::SubstrateThickness, &film, f64::NAN));
    searches.push((Key::PillarHeight, &film, 2.0));
    for (free, file, part) in searches {
        let case = file.case().unwrap();
        let truth = file.given(free).unwrap().unwrap();
        let critical = fakir::transition(&case.system, case.method, &run).unwrap();
        let mut other = file.clone();
        if part.is_nan() {
            other = half_spaces.clone();
        } else {
            other.set_number(free, truth * part);
        }
        let wanted = Wanted::Force(critical.contact.force);
        let Design::Found {
            candidate: found, ..
        } = design(&other, free, wanted, &run).unwrap()
        else {
            panic!("{} can be had", free.path());
        };
        let error = (found.value / truth - 1.0).abs();
        assert!(error < 1e-6, "{}: {error:e}", free.path());
    }
    let error = design(
        &film,
        Key::SubstrateBaseYoungModulus,
        Wanted::Force(1e-3),
        &run,
    );
    let message = error.unwrap_err().to_string();
    assert!(message.contains("substrate.base"), "{message}");
}

/// A film is at least as thick as its pillars are high, and a layer at least a quarter of their diameter thick; the
/// bounds also apply to height and diameter.
#[test]
fn thicknesses_and_pillars_bound_each_other() {
    use std::ops::Bound::{Included, Unbounded};
    let mut file = CaseFile::parse("paper", &Case::example().to_toml()).unwrap();
    let half_spaces = file.case().unwrap();
    let thinnest = |key: Key| half_spaces.allowed(key);
    assert_eq!(
        thinnest(Key::SubstrateThickness),
        (Included(2.2e-6), Unbounded)
    );
    assert_eq!(thinnest(Key::LensThickness), (Included(1.5e-6), Unbounded));
    file.set("substrate.thickness=20 um").unwrap();
    let film = file.case().unwrap();
    assert_eq!(film.allowed(Key::PillarHeight).1, Included(20e-6));
    file.set("lens.thickness=10 um").unwrap();
    let both = file.case().unwrap();
    assert_eq!(both.allowed(Key::PillarDiameter).1, Included(40e-6));
}
