//! Elastic loading curves for fits of viscoelastic bodies, of rounded tops and of height maps.
//!
//! The contact of viscoelastic bodies at any history follows from the elastic loading curve, as the elastic contact with rounded tops and with height maps does. If all moduli are multiplied by a factor, so are the
//! forces at given indentations. Therefore one curve, in units of the reduced modulus, is used for all moduli, strengths and relaxation times of a
//! fit; another is computed where a size changes, or the ratio of moduli.

use super::error::FitError;
use super::subject::Subject;
use fakir::numerics::convergence::larger;
use fakir::problem::Load;
use fakir::solve::elastic_curve::ElasticCurve;
use fakir::state::{Contact, ElasticSample, Run, Solution, SolveError};
use fakir_case::Key;
use fakir_study::approach::Loadable;
use fakir_study::surfaces::on_wide_enough_a_grid;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// Relative difference of ratios of moduli that has no effect: much less than the accuracy of a curve.
const SAME_RATIO: f64 = 1e-4;

/// Factor by which a curve is longer than needed, so that it can be used for other contact points.
const MARGIN: f64 = 1.1;

/// Number of curves kept.
const KEPT: usize = 32;

/// How far a curve is needed.
#[derive(Debug, Clone, Copy)]
pub(super) enum Reach {
    /// To an indentation, m.
    Indentation(f64),
    /// To the relaxed contact under a force, N.
    Force(f64),
}

/// An elastic curve of a case.
#[derive(Debug, Clone)]
pub(super) struct CaseCurve {
    /// At the moduli of the case, the relaxed ones.
    pub(super) elastic: ElasticCurve,
    /// Indentation (m) beyond which the lens would be through the floor, which the method or the case ignores.
    pub(super) through_floor: Option<f64>,
    /// Whether all contacts are solved.
    pub(super) converged: bool,
    /// Whether their errors are estimated.
    pub(super) has_errors: bool,
}

/// A curve with everything but the modulus on which it depends.
struct Entry {
    sizes: Vec<Option<f64>>,
    ratios: Vec<Option<f64>>,
    modulus: f64,
    curve: CaseCurve,
}

/// The curves of a fit.
#[derive(Default)]
pub(super) struct Curves {
    entries: Mutex<Vec<Arc<Entry>>>,
}

/// Sizes on which a contact depends, of the keys that can be fitted.
const SIZES: [Key; 11] = [
    Key::LensRadius,
    Key::TopRadius,
    Key::SubstrateThickness,
    Key::LensThickness,
    Key::PillarHeight,
    Key::PillarDiameter,
    Key::Pitch,
    Key::Offset,
    Key::OffsetAngle,
    Key::HeightUnit,
    Key::HeightRange,
];

/// Moduli whose ratio to the reduced modulus matters: that of the columns and the layer below them, and those of a layer of the lens and of bases.
fn ratios(subject: &Subject) -> Vec<Option<f64>> {
    let modulus = subject.reduced_modulus();
    let is_layer = |key: Key| subject.number(key).is_some();
    let [substrate, lens] = [Key::SubstrateThickness, Key::LensThickness].map(is_layer);
    let matters = [
        (
            Key::SubstrateYoungModulus,
            substrate || subject.has_columns(),
        ),
        (Key::SubstrateBaseYoungModulus, substrate),
        (Key::LensYoungModulus, lens),
        (Key::LensBaseYoungModulus, lens),
    ];
    let ratio = |(key, matters): (Key, bool)| {
        subject
            .number(key)
            .filter(|_| matters)
            .map(|it| it / modulus)
    };
    matters.map(ratio).to_vec()
}

fn same(one: &[Option<f64>], other: &[Option<f64>], tolerance: f64) -> bool {
    let pairs = one.iter().zip(other);
    let mut equal = pairs.map(|pair| match pair {
        (Some(one), Some(other)) => (one - other).abs() <= tolerance * one.abs(),
        (None, None) => true,
        _ => false,
    });
    equal.all(|equal| equal)
}

impl Curves {
    /// The curve of a case, computed only if no similar case has one; `solved` counts its contacts.
    pub(super) fn of(
        &self,
        subject: &Subject,
        reach: Reach,
        run: &Run<'_>,
        solved: &AtomicUsize,
    ) -> Result<CaseCurve, FitError> {
        let modulus = subject.reduced_modulus();
        let ratios = ratios(subject);
        let sizes: Vec<Option<f64>> = SIZES.iter().map(|key| subject.number(*key)).collect();
        let known = {
            let entries = self.entries.lock().unwrap_or_else(PoisonError::into_inner);
            let suits = |entry: &&Arc<Entry>| {
                let elastic = &entry.curve.elastic;
                let reaches = match reach {
                    Reach::Indentation(indentation) => elastic.last() >= indentation,
                    Reach::Force(force) => {
                        let last = elastic.force_at(elastic.last());
                        last * modulus / entry.modulus >= force
                    }
                };
                reaches
                    && same(&entry.sizes, &sizes, 0.0)
                    && same(&entry.ratios, &ratios, SAME_RATIO)
            };
            entries.iter().rev().find(suits).map(Arc::clone)
        };
        let entry = match known {
            Some(entry) => entry,
            None => {
                let curve = match subject {
                    Subject::Pillars(case) => sampled(&**case, reach, run, solved, |contact| {
                        contact.smallest_floor_gap
                    }),
                    Subject::Asperities(tops) => {
                        sampled(&tops.case, reach, run, solved, |_| f64::INFINITY)
                    }
                    Subject::HeightMap(map) => on_wide_enough_a_grid(
                        &map.file,
                        run.memory_limit(),
                        FitError::needed_width,
                        |case| sampled(&case.system, reach, run, solved, |_| f64::INFINITY),
                    )
                    .map(|answered| answered.answer),
                    Subject::Flat(case) => sampled(&**case, reach, run, solved, |_| f64::INFINITY),
                }?;
                let entry = Arc::new(Entry {
                    sizes,
                    ratios,
                    modulus,
                    curve,
                });
                let mut entries = self.entries.lock().unwrap_or_else(PoisonError::into_inner);
                entries.push(Arc::clone(&entry));
                if entries.len() > KEPT {
                    entries.remove(0);
                }
                entry
            }
        };
        let curve = &entry.curve;
        Ok(CaseCurve {
            elastic: curve.elastic.scaled(modulus / entry.modulus),
            ..curve.clone()
        })
    }
}

/// Samples the curve of a problem; `gap` is the smallest gap between lens and floor, m.
fn sampled<P: Loadable>(
    problem: &P,
    reach: Reach,
    run: &Run<'_>,
    solved: &AtomicUsize,
    gap: impl Fn(&P::Contact) -> f64,
) -> Result<CaseCurve, FitError> {
    let press = |load: Load| -> Result<P::Contact, SolveError> {
        solved.fetch_add(1, Ordering::Relaxed);
        problem.press(load, run)
    };
    let first = problem.first_touch();
    let needed = match reach {
        Reach::Indentation(indentation) => indentation,
        Reach::Force(force) => press(Load::Force(force))?.indentation(),
    };
    // Beyond it the lens may end, or the model.
    let far = first + MARGIN * larger(needed - first, 0.0);
    let farthest = (far > first).then(|| press(Load::Indentation(far)));
    let (last, mut farthest) = match farthest.transpose() {
        Ok(contact) => (far, contact),
        Err(SolveError::Interrupted) => return Err(SolveError::Interrupted.into()),
        Err(_) => (needed, None),
    };
    let (mut converged, mut has_errors) = (true, true);
    let mut gaps: Vec<[f64; 2]> = Vec::new();
    let mut sample = |indentation: f64| -> Result<ElasticSample, SolveError> {
        let known = farthest.take_if(|contact| contact.indentation() >= indentation);
        let contact = match known {
            Some(contact) => contact,
            None => press(Load::Indentation(indentation))?,
        };
        converged &= contact.converged();
        has_errors &= !contact.force_error().is_nan();
        gaps.push([indentation, gap(&contact)]);
        Ok(contact.elastic_sample())
    };
    let (tolerance, most) = problem.curve_accuracy();
    let elastic = ElasticCurve::sampled([first, last], &[], tolerance, most, &mut sample)?;
    gaps.sort_by(|one, other| one[0].total_cmp(&other[0]));
    let crossing = gaps.windows(2).find(|pair| pair[1][1] < 0.0);
    let through_floor = crossing.map(|pair| {
        let [[low, above], [high, below]] = [pair[0], pair[1]];
        low + (high - low) * (above / (above - below)).clamp(0.0, 1.0)
    });
    Ok(CaseCurve {
        elastic,
        through_floor: through_floor.filter(|it| it.is_finite()),
        converged,
        has_errors,
    })
}
