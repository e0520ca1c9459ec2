//! Contacts of the paper that figures show one by one.

use crate::grid::{Substrate, system};
use fakir::problem::{Control, Method};
use fakir::state::{ContactState, CriticalState, Run, SolveError};
use fakir_case::CaseError;
use rayon::prelude::*;

/// Why there are no states.
#[derive(Debug, thiserror::Error)]
pub enum StateError {
    /// A system that cannot be.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// A contact that could not be computed.
    #[error(transparent)]
    Solve(#[from] SolveError),
}

/// A critical state, and the contact before it.
#[derive(Debug, Clone)]
pub struct Approach {
    /// The lens just above the pillars.
    pub before: ContactState,
    /// Under a third of the critical force.
    pub middle: ContactState,
    /// The critical state.
    pub critical: CriticalState,
}

/// The contact under rising loads, up to the critical state.
#[derive(Debug, Clone)]
pub struct Loading {
    /// Surface fraction.
    pub surface_fraction: f64,
    /// The states, by rising indentation.
    pub states: Vec<ContactState>,
}

/// What the figures show.
#[derive(Debug, Clone)]
pub struct States {
    /// An approach on every substrate, at the surface fraction [`SECTION`].
    pub approaches: Vec<(Substrate, Approach)>,
    /// The intermediate substrate at [`DENSE`], in the critical state.
    pub dense: CriticalState,
    /// The intermediate substrate at each of [`LOADINGS`].
    pub loadings: Vec<Loading>,
    /// The intermediate substrate at [`SECTION`], at [`PAST`] times the critical indentation: mixed contact.
    pub mixed: ContactState,
    /// Mixed contact on the intermediate substrate at each of [`MIXED`] with each of [`SHARES`], as far as it was found.
    pub shared: Vec<SharedLoad>,
}

/// A state in which the floor bears a wanted share of the load, to within [`SHARE_TOLERANCE`].
#[derive(Debug, Clone)]
pub struct SharedLoad {
    /// Surface fraction.
    pub surface_fraction: f64,
    /// The share that was wanted.
    pub share: f64,
    /// The state.
    pub state: ContactState,
}

/// Indentation of the mixed contact that is shown, over the critical one.
pub const PAST: f64 = 1.5;

/// Surface fractions of the lines of equal share.
pub const MIXED: [f64; 5] = [0.001, 0.003, 0.01, 0.03, 0.08];

/// Shares of the floor on these lines.
pub const SHARES: [f64; 3] = [0.1, 0.3, 0.5];

/// Relative tolerance of these shares.
pub const SHARE_TOLERANCE: f64 = 0.01;

/// The most steps in which a share is sought.
const MOST_SHARE_STEPS: usize = 10;

/// Surface fraction of the sections and the maps of the floor gap.
pub const SECTION: f64 = 0.03;

/// Surface fraction of the pressures.
pub const DENSE: f64 = 0.1;

/// Surface fractions of the loading paths.
pub const LOADINGS: [f64; 2] = [0.001, 0.2];

/// States of a loading path.
const STEPS: u32 = 24;

/// Force in the middle of an approach, over the critical one.
const MIDDLE: f64 = 0.3;

impl States {
    /// Computes all of them. `done` is told which part of all is done.
    ///
    /// # Errors
    /// [`StateError`]
    pub fn compute(run: &Run<'_>, done: &(dyn Fn(f64) + Sync)) -> Result<Self, StateError> {
        // Every state is computed by one thread.
        let single = Run {
            pool: None,
            ..run.clone()
        };
        let shared = |work: &mut (dyn FnMut() -> Result<Self, StateError> + Send)| match run.pool {
            Some(pool) => pool.install(work),
            None => work(),
        };
        shared(&mut || {
            let (dense, (approaches, loadings, mixed, shared)) = rayon::join(
                || critical(Substrate::Intermediate, DENSE, &single),
                || {
                    let approaches: Result<Vec<_>, StateError> = Substrate::ALL
                        .into_par_iter()
                        .map(|substrate| Ok((substrate, approach(substrate, &single)?)))
                        .collect();
                    done(0.2);
                    let loadings: Result<Vec<_>, StateError> = LOADINGS
                        .into_iter()
                        .map(|phi| loading(phi, &single))
                        .collect();
                    done(0.4);
                    let mixed = past_transition(&single);
                    let shared: Result<Vec<_>, StateError> = MIXED
                        .into_par_iter()
                        .map(|fraction| shared_loads(fraction, &single))
                        .collect();
                    done(1.0);
                    (approaches, loadings, mixed, shared)
                },
            );
            Ok(Self {
                approaches: approaches?,
                dense: dense?,
                loadings: loadings?,
                mixed: mixed?,
                shared: shared?.into_iter().flatten().flatten().collect(),
            })
        })
    }

    /// The approach on the intermediate substrate.
    #[must_use]
    pub fn intermediate(&self) -> Option<&Approach> {
        self.approaches
            .iter()
            .find(|(substrate, _)| *substrate == Substrate::Intermediate)
            .map(|(_, approach)| approach)
    }
}

fn critical(
    substrate: Substrate,
    surface_fraction: f64,
    run: &Run<'_>,
) -> Result<CriticalState, StateError> {
    let system = system(substrate, 0.0, surface_fraction)?;
    Ok(fakir::transition(&system, Method::default(), run)?)
}

fn approach(substrate: Substrate, run: &Run<'_>) -> Result<Approach, StateError> {
    let critical = critical(substrate, SECTION, run)?;
    let system = &critical.contact.system;
    let press = |load| fakir::press(system, load, Method::default(), run);
    Ok(Approach {
        before: press(Control::Indentation(0.0))?,
        middle: press(Control::Force(MIDDLE * critical.contact.force))?,
        critical,
    })
}

fn loading(surface_fraction: f64, run: &Run<'_>) -> Result<Loading, StateError> {
    let critical = critical(Substrate::Intermediate, surface_fraction, run)?;
    let system = critical.contact.system.clone();
    let mut states: Vec<ContactState> = (1..STEPS)
        .into_par_iter()
        .map(|step| {
            let share = f64::from(step) / f64::from(STEPS);
            let load = Control::Indentation(share * share * critical.contact.indentation);
            fakir::press(&system, load, Method::default(), run)
        })
        .collect::<Result<_, _>>()?;
    states.push(critical.contact);
    Ok(Loading {
        surface_fraction,
        states,
    })
}

/// The mixed contact that is shown.
fn past_transition(run: &Run<'_>) -> Result<ContactState, StateError> {
    let critical = critical(Substrate::Intermediate, SECTION, run)?.contact;
    let control = Control::Indentation(PAST * critical.indentation);
    Ok(fakir::press(
        &critical.system,
        control,
        Method::default(),
        run,
    )?)
}

/// The states in which the floor bears each of [`SHARES`], as far as they are found.
fn shared_loads(
    surface_fraction: f64,
    run: &Run<'_>,
) -> Result<Vec<Option<SharedLoad>>, StateError> {
    let critical = critical(Substrate::Intermediate, surface_fraction, run)?.contact;
    let mut known = Vec::new();
    SHARES
        .into_iter()
        .map(|share| shared_load(surface_fraction, &critical, share, &mut known, run))
        .collect()
}

/// Logarithms of the indentation beyond the critical one, over it, and of what the floor bears, over what the tops bear. The one is nearly linear in the other.
type Known = [f64; 2];

/// Of a share of the floor.
fn log_of_odds(share: f64) -> f64 {
    (share / (1.0 - share)).ln()
}

/// Where the floor is to bear so much: by the nearest two of the states that are known, and the change of their slope to a third.
fn guess(odds: f64, known: &[Known]) -> f64 {
    let mut nearest = known.to_vec();
    nearest.sort_by(|a, b| (a[1] - odds).abs().total_cmp(&(b[1] - odds).abs()));
    let slope = |a: Known, b: Known| (b[0] - a[0]) / (b[1] - a[1]);
    // Shares grow as the power 3/2 at first.
    let first = |a: Known| a[0] + (odds - a[1]) / 1.3;
    match nearest[..] {
        [] => (odds + std::f64::consts::LN_2) / 1.5,
        [a] => first(a),
        [a, b, ..] => {
            let of_two = slope(a, b);
            let bend = nearest.get(2).map_or(0.0, |c| {
                (slope(b, *c) - of_two) / (c[1] - a[1]) * (odds - b[1])
            });
            let along = a[0] + (of_two + bend) * (odds - a[1]);
            if along.is_finite() { along } else { first(a) }
        }
    }
}

/// The state in which the floor bears a share of the load; what is found on the way becomes known.
fn shared_load(
    surface_fraction: f64,
    critical: &ContactState,
    share: f64,
    known: &mut Vec<Known>,
    run: &Run<'_>,
) -> Result<Option<SharedLoad>, StateError> {
    let mut last: Option<f64> = None;
    for _ in 0..MOST_SHARE_STEPS {
        let mut position = guess(log_of_odds(share), known);
        if let Some(last) = last {
            position = position.clamp(last - 1.0, last + 1.0);
        }
        last = Some(position);
        let control = Control::Indentation((1.0 + position.exp()) * critical.indentation);
        let state = fakir::press(&critical.system, control, Method::default(), run)?;
        let found = state.floor.as_ref().map_or(0.0, |floor| floor.share);
        let odds = log_of_odds(found);
        if !state.converged() || !odds.is_finite() {
            return Ok(None);
        }
        known.push([position, odds]);
        if (found / share).ln().abs() < SHARE_TOLERANCE {
            return Ok(Some(SharedLoad {
                surface_fraction,
                share,
                state,
            }));
        }
    }
    Ok(None)
}
