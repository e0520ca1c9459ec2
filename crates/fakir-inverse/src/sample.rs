//! Critical state, pull-off and forces of one sample of any surface.

use fakir::problem::{CyclePlan, Load, SurfaceSystem};
use fakir::state::{Contact, Run, Solution, SolveError, SurfaceContact, SurfaceTransition};
use fakir_case::{AnyCase, CaseError, CaseFile};
use fakir_study::approach::Loadable;
use fakir_study::surfaces::on_wide_enough_a_grid;

/// Values of a critical state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Critical {
    /// `F_c`, N.
    pub force: f64,
    /// `zeta_c`, m.
    pub indentation: f64,
    /// `a_c`, m; not a number under a plate, which has none.
    pub contact_radius: f64,
    /// Values of the unloading; `None` without adhesion.
    pub pull_off: Option<PullOff>,
}

/// Values of the unloading from the critical state, with adhesive tops.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PullOff {
    /// Pull-off force, N, negative.
    pub force: f64,
    /// Area of the loop of force over indentation, J.
    pub hysteresis: f64,
}

/// The numbers of a sample.
#[derive(Debug, Clone, PartialEq)]
pub struct Numbers {
    /// Its critical state.
    pub critical: Critical,
    /// Forces (N) at the given indentations.
    pub forces: Vec<f64>,
}

/// The numbers of a sample with their estimated errors.
pub(crate) struct Answers {
    pub(crate) numbers: Numbers,
    /// The numbers at the ends of their estimated errors, on the side of larger cells; `None` without cells, and if the errors are not estimated.
    pub(crate) at_errors: Option<Numbers>,
}

/// Errors of a sample.
#[derive(Debug)]
pub(crate) enum SampleError {
    /// Drawn values that are no surface.
    Case(CaseError),
    Solve(SolveError),
}

impl From<CaseError> for SampleError {
    fn from(error: CaseError) -> Self {
        Self::Case(error)
    }
}

impl From<SolveError> for SampleError {
    fn from(error: SolveError) -> Self {
        Self::Solve(error)
    }
}

impl SampleError {
    /// Width, m, of a grid that contains the contact.
    fn needed_width(&self) -> Option<f64> {
        match self {
            Self::Solve(error) => error.needed_width(),
            _ => None,
        }
    }
}

/// Critical state of a sample and forces at the indentations, or the reason why there are no reliable values.
pub(crate) fn answers(
    case: &AnyCase,
    indentations: &[f64],
    run: &Run<'_>,
) -> Result<Result<Answers, String>, SampleError> {
    if let AnyCase::HeightMap(file) = case {
        return OnMap { file, run }.answers(indentations);
    }
    let critical = match outcome(case, run)? {
        Ok(critical) => critical,
        Err(problem) => return Ok(Err(problem)),
    };
    let mut forces = Vec::with_capacity(indentations.len());
    for indentation in indentations {
        let load = Load::Indentation(*indentation);
        let force = match case {
            AnyCase::Pillars(case) => force(&**case, load, run),
            AnyCase::Asperities(case) => force(&**case, load, run),
            AnyCase::HeightMap(_) | AnyCase::Flat(_) => Err(SolveError::NoFloor),
        };
        match force? {
            Ok(force) => forces.push(force),
            Err(problem) => return Ok(Err(problem)),
        }
    }
    Ok(Ok(Answers {
        numbers: Numbers { critical, forces },
        at_errors: None,
    }))
}

/// Force of a sample at a load, or the reason why there is no reliable one.
fn force(
    case: &impl Loadable,
    load: Load,
    run: &Run<'_>,
) -> Result<Result<f64, String>, SolveError> {
    let contact = case.press(load, run)?;
    Ok(contact.problem().map_or_else(|| Ok(contact.force()), Err))
}

/// Critical state of a sample, or the reason why there is no reliable one.
fn outcome(case: &AnyCase, run: &Run<'_>) -> Result<Result<Critical, String>, SolveError> {
    match case {
        AnyCase::Pillars(case) if case.system.adhesion().is_none() => {
            let critical = fakir::transition(&case.system, case.method, run)?;
            Ok(Critical::found(
                &critical.contact,
                critical.contact_radius(),
            ))
        }
        AnyCase::Pillars(case) => {
            let cycle = fakir::cycle(&case.system, CyclePlan::default(), case.method, run)?;
            if let Some(problem) = cycle.problem() {
                return Ok(Err(problem));
            }
            let critical = cycle.critical.as_ref();
            let critical = critical.map(|it| Ok(Critical::of(&it.contact, it.contact_radius())));
            let hysteresis = cycle.hysteresis();
            let force = cycle.pull_off.as_ref().map(|it| it.force);
            Ok(pulled_off(critical, force, hysteresis))
        }
        AnyCase::Asperities(case) if case.field.adhesion().is_none() => {
            let critical = case.field.transition(case.accuracy, run)?;
            Ok(Critical::found(
                &critical.contact,
                critical.contact_radius(),
            ))
        }
        AnyCase::Asperities(case) => {
            let cycle = case.field.cycle(CyclePlan::default(), case.accuracy, run)?;
            if let Some(problem) = cycle.problem() {
                return Ok(Err(problem));
            }
            let critical = cycle.critical.as_ref();
            let critical = critical.map(|it| Critical::found(&it.contact, it.contact_radius()));
            let force = cycle.pull_off.as_ref().map(|it| it.force);
            Ok(pulled_off(critical, force, cycle.loop_area))
        }
        AnyCase::HeightMap(_) | AnyCase::Flat(_) => Err(SolveError::NoFloor),
    }
}

/// Critical state and pull-off of a cycle. Without tensile force the lens detaches without a pull-off force; without hysteresis it does not detach.
fn pulled_off(
    critical: Option<Result<Critical, String>>,
    force: Option<f64>,
    hysteresis: Option<f64>,
) -> Result<Critical, String> {
    let (Some(critical), Some(hysteresis)) = (critical, hysteresis) else {
        return Err("the lens does not detach".to_owned());
    };
    let pull_off = Some(PullOff {
        force: force.unwrap_or(0.0),
        hysteresis,
    });
    critical.map(|critical| Critical {
        pull_off,
        ..critical
    })
}

impl Critical {
    fn of(contact: &impl Contact, contact_radius: f64) -> Self {
        Self {
            force: contact.force(),
            indentation: contact.indentation(),
            contact_radius,
            pull_off: None,
        }
    }

    /// The values, or the reason why they are not reliable.
    fn found(contact: &impl Contact, contact_radius: f64) -> Result<Self, String> {
        let problem = contact.problem();
        problem.map_or_else(|| Ok(Self::of(contact, contact_radius)), Err)
    }
}

/// A sample on a height map.
struct OnMap<'a> {
    file: &'a CaseFile,
    run: &'a Run<'a>,
}

/// A number, and the same at the end of its estimated error.
type WithError = (f64, Option<f64>);

impl OnMap<'_> {
    fn answers(&self, indentations: &[f64]) -> Result<Result<Answers, String>, SampleError> {
        let (critical, at_error) = match self.critical()? {
            Ok(found) => found,
            Err(problem) => return Ok(Err(problem)),
        };
        let mut forces: Vec<WithError> = Vec::with_capacity(indentations.len());
        for indentation in indentations {
            let load = Load::Indentation(*indentation);
            let contact = self.solved(|system| system.press(load, self.run))?;
            if let Some(problem) = contact.problem() {
                return Ok(Err(problem));
            }
            forces.push((contact.force, with_errors(&contact).map(|[force, _]| force)));
        }
        let (forces, forces_at_error): (Vec<f64>, Vec<Option<f64>>) = forces.into_iter().unzip();
        let forces_at_error: Option<Vec<f64>> = forces_at_error.into_iter().collect();
        let at_errors = at_error.zip(forces_at_error);
        Ok(Ok(Answers {
            numbers: Numbers { critical, forces },
            at_errors: at_errors.map(|(critical, forces)| Numbers { critical, forces }),
        }))
    }

    /// The critical state, also at the ends of its estimated errors; with adhesion also the unloading from it.
    fn critical(&self) -> Result<Result<(Critical, Option<Critical>), String>, SampleError> {
        if self.file.surface_adhesion()?.is_none() {
            let found = self.solved(|system| system.transition(self.run))?;
            return Ok(
                Critical::on_map(&found).map(|critical| (critical, critical.at_errors_of(&found)))
            );
        }
        let cycle = self.solved(|system| system.cycle(CyclePlan::default(), self.run))?;
        if let Some(problem) = cycle.problem() {
            return Ok(Err(problem));
        }
        let found = cycle.critical.as_ref().map(Critical::on_map);
        let force = cycle.pull_off.as_ref().map(|it| it.force);
        let found = pulled_off(found, force, cycle.loop_area);
        let errors = cycle.errors.zip(cycle.larger_cells);
        let at_errors = |critical: Critical| -> Option<Critical> {
            let moved = critical.at_errors_of(cycle.critical.as_ref()?)?;
            let (errors, [force, hysteresis]) = errors?;
            let PullOff {
                force: of_force,
                hysteresis: of_loop,
            } = critical.pull_off?;
            Some(Critical {
                pull_off: Some(PullOff {
                    force: at_error(of_force, errors.pull_off_force, force),
                    hysteresis: at_error(of_loop, errors.loop_area, hysteresis),
                }),
                ..moved
            })
        };
        Ok(found.map(|critical| (critical, at_errors(critical))))
    }

    fn solved<T>(
        &self,
        ask: impl Fn(&SurfaceSystem) -> Result<T, SolveError>,
    ) -> Result<T, SampleError> {
        let limit = self.run.memory_limit();
        let answered = on_wide_enough_a_grid(self.file, limit, SampleError::needed_width, |case| {
            Ok(ask(&case.system)?)
        });
        answered.map(|it| it.answer)
    }
}

impl Critical {
    fn on_map(found: &SurfaceTransition) -> Result<Self, String> {
        // A plate has no contact radius.
        let radius = found.contact_radius().unwrap_or(f64::NAN);
        Self::found(&found.contact, radius)
    }

    /// The same at the ends of its estimated errors.
    fn at_errors_of(&self, found: &SurfaceTransition) -> Option<Self> {
        let [force, indentation] = with_errors(&found.contact)?;
        let [x, y] = found.floor_contact;
        let larger = found.contact.larger_cells?.contact_radius;
        let larger = larger.unwrap_or(0.0).max(x.hypot(y));
        let error = found.contact.relative_contact_radius_error();
        Some(Self {
            force,
            indentation,
            contact_radius: at_error(self.contact_radius, error.unwrap_or(0.0), larger),
            pull_off: None,
        })
    }
}

/// Force and indentation at the ends of their estimated errors.
fn with_errors(contact: &SurfaceContact) -> Option<[f64; 2]> {
    let (error, larger) = (contact.error?, contact.larger_cells?);
    Some([
        at_error(contact.force, error.force, larger.force),
        at_error(contact.indentation, error.indentation, larger.indentation),
    ])
}

/// A value that is moved by its relative error towards that on larger cells.
fn at_error(value: f64, error: f64, on_larger_cells: f64) -> f64 {
    value + (error * value.abs()).copysign(on_larger_cells - value)
}
