//! A contact with a flat surface as one disc, and with boundary elements.

use super::{Difference, InconclusiveReason, Verdict};
use crate::problem::{FlatSystem, Load};
use crate::solve::elements::flat::press_flat;
use crate::state::{FlatContact, Run, SolveError, SurfaceContact, Termination};

/// The contact with a flat surface by both methods, and their differences.
#[derive(Debug, Clone)]
pub struct FlatVerification {
    /// The contact as one disc.
    pub disc: FlatContact,
    /// The contacts with boundary elements, with half as many cells across the contact and with all.
    pub elements: [SurfaceContact; 2],
    /// Cells across the contact of each.
    pub cells: [usize; 2],
    /// Relative difference of the force with elements from that of the disc.
    pub force: Difference,
    /// Relative difference of the indentation with elements from that of the disc.
    pub indentation: Difference,
    /// Relative difference of the contact area with elements from that of the disc.
    pub area: Difference,
}

impl FlatVerification {
    /// The verdict of the comparison.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        let disc = (None, self.disc.termination);
        let elements = self.cells.iter().zip(&self.elements);
        let elements = elements.map(|(cells, contact)| (Some(*cells), contact.termination));
        let failed = std::iter::once(disc)
            .chain(elements)
            .find(|(_, termination)| *termination != Termination::Converged)
            .map(
                |(cells, termination)| InconclusiveReason::FlatNotConverged { cells, termination },
            );
        Verdict::of(failed, &[self.force, self.indentation, self.area])
    }

    /// Whether both methods converged and agree within their error estimates.
    #[must_use]
    pub fn agrees(&self) -> bool {
        self.verdict() == Verdict::Agree
    }
}

/// Solves a contact with a flat surface as one disc, and with boundary elements on `cells` square cells across the contact and on half as many.
///
/// Elements find the extent of the contact; it is not prescribed, except under a punch. Both methods share the elastic response of the bodies: a kernel
/// for an axisymmetric pressure and one for a pressure on a square. With adhesion the energy release rate at the rim is that of the disc as a
/// whole in one, and follows from the pressures and gaps of cells along the edge in the other.
///
/// # Errors
/// As [`FlatSystem::press`].
pub fn verify_flat(
    system: &FlatSystem,
    load: Load,
    cells: usize,
    run: &Run<'_>,
) -> Result<FlatVerification, SolveError> {
    let disc = system.press(load, run)?;
    let cells = [cells / 2, cells];
    let solve = |cells| press_flat(system, load, &disc, cells, run);
    let elements = [solve(cells[0])?, solve(cells[1])?];
    let difference =
        |of: fn(&SurfaceContact) -> f64, estimate: Option<f64>, [disc, of_disc]: [f64; 2]| {
            let [coarse, fine] = elements.each_ref().map(of);
            let estimate = estimate.unwrap_or(f64::NAN);
            // The estimate of one mesh may be small by coincidence: the difference between the meshes is added.
            let between = Difference::of(coarse, fine, 0.0).relative.abs();
            Difference::of(fine, disc, estimate + between + of_disc)
        };
    let error = elements[1].error;
    Ok(FlatVerification {
        force: difference(
            |contact| contact.force,
            error.map(|error| error.force),
            [disc.force, disc.error.force],
        ),
        indentation: difference(
            |contact| contact.indentation,
            error.map(|error| error.indentation),
            [disc.indentation, disc.error.indentation],
        ),
        area: difference(
            |contact| contact.contact_area,
            elements[1].area_error,
            [disc.contact_area, 2.0 * disc.error.contact_radius],
        ),
        cells,
        elements,
        disc,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::{Adhesion, Layer, Lens, LensProfile, LensShape, Material, ShapedLens};
    use std::sync::Arc;

    const RUBBER: Material = Material {
        young_modulus: 2e6,
        poisson_ratio: 0.5,
    };
    const STIFF: Material = Material {
        young_modulus: 7e6,
        poisson_ratio: 0.3,
    };

    fn sphere() -> FlatSystem {
        let lens = Lens {
            radius: 2e-3,
            material: RUBBER,
        };
        FlatSystem::new(lens, STIFF).unwrap()
    }

    fn punch() -> FlatSystem {
        FlatSystem::punch(50e-6, RUBBER, STIFF).unwrap()
    }

    fn verified(system: &FlatSystem, load: Load) -> FlatVerification {
        let found = verify_flat(system, load, 64, &Run::default()).unwrap();
        println!("{:?} {:?} {:?}", found.force, found.indentation, found.area);
        found
    }

    /// Within the tolerances; what is prescribed is the same.
    fn agree(system: &FlatSystem, load: Load, tolerance: f64) {
        let found = verified(system, load);
        assert_eq!(found.verdict(), Verdict::Agree, "{load:?}");
        for difference in [found.force, found.indentation] {
            assert!(difference.relative.abs() < tolerance, "{difference:?}");
            assert!(difference.allowed < 0.1, "{difference:?}");
        }
        let areas = [found.elements[1].contact_area, found.disc.contact_area];
        assert!((areas[0] / areas[1] - 1.0).abs() < 0.05, "{areas:?}");
    }

    #[test]
    fn both_methods_agree_under_every_lens() {
        let radii: Vec<f64> = (0..100).map(|k| 4e-6 * f64::from(k)).collect();
        let height = |r: &f64| r * r / 8e-3 + (r / 100e-6).powi(4) * 1e-6;
        let heights = radii.iter().map(height).collect();
        let steep = LensShape::Profile(Arc::new(LensProfile::new(radii, heights).unwrap()));
        let paraboloid = LensShape::Paraboloid { radius: 2e-3 };
        let of = |shape| FlatSystem::new(ShapedLens::new(shape, RUBBER), STIFF).unwrap();
        for system in [sphere(), of(paraboloid), of(steep)] {
            agree(&system, Load::Indentation(3e-6), 2e-3);
            agree(&system, Load::Force(1e-3), 2e-3);
        }
    }

    /// Cells of constant pressure make a disc of 64 cells 0.5 % stiffer or more compliant.
    #[test]
    fn both_methods_agree_under_a_punch() {
        agree(&punch(), Load::Indentation(1e-6), 1e-2);
        agree(&punch(), Load::Force(1e-4), 1e-2);
    }

    /// A film that is thinner than the contact is wide, bonded to a rigid base, on an incompressible and a compressible material.
    #[test]
    fn both_methods_agree_on_films() {
        for (system, tolerance) in [(sphere(), 5e-3), (punch(), 2e-2)] {
            for thickness in [200e-6, 30e-6] {
                let film = Layer::new(thickness);
                let substrate = system.clone().with_layers(Some(film), None).unwrap();
                agree(&substrate, Load::Indentation(0.5e-6), tolerance);
                let lens = system.clone().with_layers(None, Some(film)).unwrap();
                agree(&lens, Load::Force(1e-4), tolerance);
            }
        }
    }

    #[test]
    fn nothing_touched_is_the_same_in_both() {
        for load in [Load::Indentation(0.0), Load::Force(0.0)] {
            for system in [sphere(), punch()] {
                let found = verified(&system, load);
                assert_eq!((found.disc.force, found.elements[1].force), (0.0, 0.0));
                assert_ne!(found.verdict(), Verdict::Disagree, "{load:?}");
            }
        }
    }

    /// A modulus that is wrong in one of the methods by 2 % is found.
    #[test]
    fn a_wrong_force_is_a_disagreement() {
        let mut found = verified(&sphere(), Load::Indentation(3e-6));
        found.force = Difference::of(
            found.elements[1].force,
            1.02 * found.disc.force,
            found.force.allowed,
        );
        assert_eq!(found.verdict(), Verdict::Disagree);
    }

    #[test]
    fn too_few_cells_and_failed_solutions_are_inconclusive() {
        let few = verify_flat(&sphere(), Load::Force(1e-3), 16, &Run::default()).unwrap();
        let doubt = few.verdict().doubt().unwrap().to_string();
        assert!(doubt.contains("too few cells"), "{doubt}");
        let mut failed = verified(&sphere(), Load::Force(1e-3));
        failed.elements[0].termination = Termination::IterationLimit;
        let doubt = failed.verdict().doubt().unwrap().to_string();
        assert!(doubt.contains("32 cells across the contact"), "{doubt}");
        failed.disc.termination = Termination::Stagnated;
        let doubt = failed.verdict().doubt().unwrap().to_string();
        assert!(doubt.contains("one disc"), "{doubt}");
        assert!(!failed.agrees());
    }

    /// The disc is that of K. L. Johnson, K. Kendall & A. D. Roberts, Proc. R. Soc. A 324, 301 (1971); on a film and under a punch, whose rim is
    /// that of K. Kendall, J. Phys. D 4, 1186 (1971), it is a solution of an integral equation.
    #[test]
    fn both_methods_agree_with_adhesion() {
        let adhesive = |system: FlatSystem| system.with_adhesion(Adhesion::new(50e-3)).unwrap();
        let film = sphere().with_layers(Some(Layer::new(100e-6)), None);
        let (film, punch) = (adhesive(film.unwrap()), adhesive(punch()));
        for (system, load) in [
            (adhesive(sphere()), Load::Indentation(1e-8)),
            (adhesive(sphere()), Load::Indentation(1e-6)),
            (adhesive(sphere()), Load::Force(1e-4)),
            (film, Load::Indentation(0.5e-6)),
            (punch, Load::Indentation(0.5e-6)),
        ] {
            let found = verified(&system, load);
            assert_eq!(found.verdict(), Verdict::Agree, "{load:?}");
            for difference in [found.force, found.indentation, found.area] {
                // An eighth of the work of adhesion, by which fronts on cells may be off, changes the force of a gentle contact by up to a quarter.
                assert!(difference.allowed < 0.35, "{load:?}: {difference:?}");
            }
        }
    }

    /// The contact on small cells is 5 % too wide in area, whatever their size: its error covers the force of Johnson, Kendall and Roberts all the same.
    #[test]
    fn errors_with_adhesion_cover_on_small_cells() {
        let adhesive = sphere().with_adhesion(Adhesion::new(50e-3)).unwrap();
        for indentation in [0.1e-6, 0.5e-6] {
            let load = Load::Indentation(indentation);
            let found = verify_flat(&adhesive, load, 128, &Run::default()).unwrap();
            for difference in [found.force, found.area] {
                let Difference { relative, allowed } = difference;
                assert!(relative < allowed && allowed < 0.4, "{difference:?}");
            }
        }
    }

    /// At the first touch the lens jumps into contact, but not with the centre of a cell.
    #[test]
    fn the_jump_into_contact_is_inconclusive() {
        let adhesive = sphere().with_adhesion(Adhesion::new(50e-3)).unwrap();
        let found = verified(&adhesive, Load::Indentation(0.0));
        let doubt = found.verdict().doubt();
        assert!(matches!(doubt, Some(InconclusiveReason::NoDigits { .. })));
    }

    #[test]
    fn impossible_loads_are_refused() {
        let run = Run::default();
        let refused = verify_flat(&sphere(), Load::FloorContact, 64, &run).unwrap_err();
        assert_eq!(refused, SolveError::NoFloor);
        let refused = verify_flat(&sphere(), Load::Force(f64::NAN), 64, &run).unwrap_err();
        assert!(refused.to_string().contains("force"), "{refused}");
    }
}
