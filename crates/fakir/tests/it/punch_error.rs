//! The error estimate of the punch lattice covers its difference from the spectral method, also if the edge of the contact crosses most of
//! the few touched pillars.

use crate::common::{paper_lattice, paper_system};
use fakir::problem::{Method, PillarCompliance, PunchForm};
use fakir::state::Run;

#[test]
fn the_stated_error_covers_what_a_punch_lattice_leaves_out() {
    check_fractions(7);
}

#[test]
#[ignore = "slow: seven times as many surface fractions"]
fn the_stated_error_covers_what_a_punch_lattice_leaves_out_everywhere() {
    check_fractions(1);
}

/// At surface fractions between contact of the first ring of pillars and contact of a hundred pillars, in steps of 2 % of which every
/// `every`-th is used.
fn check_fractions(every: usize) {
    let run = Run::default();
    let fractions = (0..150).step_by(every);
    let fractions: Vec<f64> = fractions.map(|k| 0.0025 * 1.02f64.powi(k)).collect();
    for modulus in [1e9, 2e6, 2e3] {
        for offset in [0.0, 0.5, 0.75f64.sqrt()] {
            for fraction in &fractions {
                let lattice = paper_lattice(*fraction, offset);
                let system = paper_system(lattice, modulus, PillarCompliance::Column);
                let punch = Method::Punch(PunchForm::Corrected);
                let punch = fakir::transition(&system, punch, &run).unwrap();
                let exact = fakir::transition(&system, Method::default(), &run).unwrap();
                let difference = punch.contact.force / exact.contact.force - 1.0;
                let stated = punch.contact.error.force;
                println!("{modulus} {offset:.3} {fraction:.5} {difference:+.4} {stated:.4}");
                assert!(
                    difference.abs() < stated,
                    "{modulus} Pa, offset {offset}, surface fraction {fraction}: {difference}, stated {stated}"
                );
            }
        }
    }
}
