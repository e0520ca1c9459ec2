//! Rough surfaces: for any surface, load and initial guess, the solver finds the solution and bounds its error.

use super::{Indenter, dot, grid};
use fakir::halfspace::elements::{FreeSpaceConvolution, Operator, PeriodicConvolution};
use fakir::problem::Cells;
use fakir::solve::elements::solver::{ElementContact, Prescribed};
use std::f64::consts::PI;

const ACROSS: usize = 64;

/// Random numbers between 0 and 1 from a seed (Marsaglia's xorshift).
struct Numbers(u64);

impl Iterator for Numbers {
    type Item = f64;

    fn next(&mut self) -> Option<f64> {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        Some((self.0 >> 11) as f64 / (1u64 << 53) as f64)
    }
}

/// Waves of random phase with a spectrum of Hurst exponent 0.8, with wavelengths down to four cells; period 1.
fn heights(seed: u64) -> impl Fn([f64; 2]) -> f64 {
    let mut numbers = Numbers(seed);
    let limit = ACROSS as i32 / 4;
    let waves: Vec<[f64; 4]> = (0..=limit)
        .flat_map(|k| (-limit..=limit).map(move |l| (f64::from(k), f64::from(l))))
        .filter(|(k, l)| k.hypot(*l) >= 1.0 && k.hypot(*l) <= f64::from(limit))
        .map(|(k, l)| {
            let amplitude = k.hypot(l).powf(-1.8);
            [
                k,
                l,
                amplitude,
                2.0 * PI * numbers.next().unwrap_or_default(),
            ]
        })
        .collect();
    move |[x, y]| {
        waves
            .iter()
            .map(|[k, l, amplitude, phase]| amplitude * (2.0 * PI * (k * x + l * y) + phase).cos())
            .sum()
    }
}

fn grid_cells() -> Cells {
    Cells::all(&grid(ACROSS, ACROSS, 1.0 / ACROSS as f64))
}

fn free(seed: u64) -> Indenter<FreeSpaceConvolution<'static>> {
    Indenter::free(grid_cells(), heights(seed))
}

fn periodic(seed: u64) -> Indenter<PeriodicConvolution<'static>> {
    Indenter::periodic(grid_cells(), heights(seed))
}

fn fraction(contact: &ElementContact) -> f64 {
    let loaded = contact.pressure.iter().filter(|p| **p > 0.0).count();
    loaded as f64 / contact.pressure.len() as f64
}

/// Energy under the load divided by the area of a cell: `p·(u/2 + s)`, and `- zeta Σp` for a prescribed indentation.
fn energy(contact: &ElementContact, separation: &[f64], load: Prescribed) -> f64 {
    let at = match load {
        Prescribed::Indentation(indentation) => indentation,
        Prescribed::Force(_) => 0.0,
    };
    contact
        .pressure
        .iter()
        .zip(&contact.gap)
        .zip(separation)
        .map(|((p, gap), s)| p * (0.5 * (gap + contact.indentation - s) + s - at))
        .sum()
}

fn elastic_energy(contact: &ElementContact, separation: &[f64]) -> f64 {
    contact
        .pressure
        .iter()
        .zip(&contact.gap)
        .zip(separation)
        .map(|((p, gap), s)| 0.5 * p * (gap + contact.indentation - s))
        .sum()
}

/// Compares the energy bound of rough solutions with the energy of a much more accurate solution.
fn check_certificate<O: Operator>(indenter: &mut Indenter<O>, load: Prescribed) {
    let best = indenter.press_from(load, 1e-12, None);
    for tolerance in [0.3, 1e-2, 1e-4, 1e-7] {
        let contact = indenter.press_from(load, tolerance, None);
        let separation = &indenter.separation;
        let error = energy(&contact, separation, load) - energy(&best, separation, load);
        let elastic = elastic_energy(&contact, separation);
        assert!(
            error <= contact.certificate.energy_bound * elastic * (1.0 + 1e-9) + 1e-12 * elastic,
            "{load:?} at {tolerance:e}: {:e} of at most {:e}",
            error / elastic,
            contact.certificate.energy_bound
        );
        assert!(error >= -1e-11 * elastic);
    }
}

/// The same solution from zero, from noise, and from other solutions as initial guesses.
fn check_starts<O: Operator>(indenter: &mut Indenter<O>, load: Prescribed, others: &[Vec<f64>]) {
    let cold = indenter.press(load);
    let noise: Vec<f64> = Numbers(99)
        .take(cold.pressure.len())
        .map(|number| 10.0 * (number - 0.5))
        .collect();
    let norm = dot(&cold.pressure, &cold.pressure).sqrt();
    for start in others.iter().chain([&noise]) {
        let warm = indenter.press_from(load, 1e-10, Some(start));
        assert!((warm.force / cold.force - 1.0).abs() < 1e-7);
        assert!((warm.indentation - cold.indentation).abs() < 1e-7 * cold.indentation.abs());
        let difference: Vec<f64> = warm
            .pressure
            .iter()
            .zip(&cold.pressure)
            .map(|(a, b)| a - b)
            .collect();
        assert!(dot(&difference, &difference).sqrt() < 1e-3 * norm);
    }
}

/// Loads from first contact to nearly full contact, as forces and as indentations.
fn check_all_loads<O: Operator>(indenter: &mut Indenter<O>, forces: &[f64]) {
    let mut states = Vec::new();
    let mut fractions = Vec::new();
    for &force in forces {
        let contact = indenter.press(Prescribed::Force(force));
        let same = indenter.press(Prescribed::Indentation(contact.indentation));
        assert!((same.force / contact.force - 1.0).abs() < 1e-6);
        let expected = (contact.force - force).abs();
        assert!(expected < 1e-12 * force);
        fractions.push(fraction(&contact));
        println!(
            "rough surface: {:.3} in contact, {} and {} products",
            fraction(&contact),
            contact.products,
            same.products
        );
        for load in [
            Prescribed::Force(force),
            Prescribed::Indentation(contact.indentation),
        ] {
            check_certificate(indenter, load);
        }
        states.push(contact);
    }
    assert!(fractions.is_sorted(), "{fractions:?}");
    assert!(
        fractions[0] < 0.08 && fractions[fractions.len() - 1] > 0.95,
        "{fractions:?}"
    );
    let lightest = states[0].pressure.clone();
    let heaviest = states[states.len() - 1].pressure.clone();
    let middle = states.len() / 2;
    for load in [
        Prescribed::Force(forces[middle]),
        Prescribed::Indentation(states[middle].indentation),
    ] {
        check_starts(indenter, load, &[lightest.clone(), heaviest.clone()]);
    }
}

#[test]
fn periodic_half_space() {
    for seed in [1, 2] {
        check_all_loads(&mut periodic(seed), &[0.2, 1.5, 6.0, 18.0]);
    }
}

#[test]
fn free_half_space() {
    for seed in [3, 4] {
        check_all_loads(&mut free(seed), &[0.2, 1.5, 6.0, 30.0]);
    }
}
