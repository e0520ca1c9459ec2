//! Single contacts of the paper that are shown in figures.

use crate::grid::{Substrate, system};
use fakir::problem::{Load, Method};
use fakir::state::{ContactState, CriticalState, Run, SolveError};
use fakir_case::CaseError;
use rayon::prelude::*;

/// Errors of the states.
#[derive(Debug, thiserror::Error)]
pub enum StateError {
    /// An invalid system.
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
    /// Contact under a third of the critical force.
    pub middle: ContactState,
    /// The critical state.
    pub critical: CriticalState,
}

/// The contact under increasing loads, up to the critical state.
#[derive(Debug, Clone)]
pub struct Loading {
    /// Surface fraction.
    pub surface_fraction: f64,
    /// States, by increasing indentation.
    pub states: Vec<ContactState>,
}

/// States shown in figures.
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
    /// Mixed contact on the intermediate substrate at each of [`MIXED`] with each of [`SHARES`], if it was found.
    pub shared: Vec<SharedLoad>,
}

/// A state with a given floor share.
#[derive(Debug, Clone)]
pub struct SharedLoad {
    /// Surface fraction.
    pub surface_fraction: f64,
    /// Floor share.
    pub share: f64,
    /// The state.
    pub state: ContactState,
}

/// Indentation of the mixed contact that is shown, over the critical one.
pub const PAST: f64 = 1.5;

/// Surface fractions of the lines of equal share.
pub const MIXED: [f64; 5] = [0.001, 0.003, 0.01, 0.03, 0.08];

/// Fractions of the load carried by the floor on these lines.
pub const SHARES: [f64; 3] = [0.1, 0.3, 0.5];

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
    /// Computes all states. `done` receives the fraction that is finished.
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
                shared: shared?.into_iter().flatten().collect(),
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
        before: press(Load::Indentation(0.0))?,
        middle: press(Load::Force(MIDDLE * critical.contact.force))?,
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
            let load = Load::Indentation(share * share * critical.contact.indentation);
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
    let control = Load::Indentation(PAST * critical.indentation);
    Ok(fakir::press(
        &critical.system,
        control,
        Method::default(),
        run,
    )?)
}

/// States with each floor share of [`SHARES`], if they are found.
fn shared_loads(surface_fraction: f64, run: &Run<'_>) -> Result<Vec<SharedLoad>, StateError> {
    let critical = critical(Substrate::Intermediate, surface_fraction, run)?;
    let states = fakir::press_to_floor_shares(&critical, &SHARES, run)?;
    let shared = |(state, share)| SharedLoad {
        surface_fraction,
        share,
        state,
    };
    let all = states.into_iter().zip(SHARES);
    let found = all.filter(|(state, _)| state.converged());
    Ok(found.map(shared).collect())
}
