//! Search for the contact at a load: from the point-force start if that succeeds, otherwise step by step from first contact.

use super::equations::Equations;
use super::newton::{Settled, Trouble};
use super::start::point_forces;
use crate::problem::load::Prescribed;
use crate::state::discs::Contacts;
use crate::state::{Run, SolveError};

/// Largest number of steps, length of the first step as a fraction of the whole way, and growth factor from one step to the next.
const STEP_LIMIT: usize = 400;
const FIRST_STEP: f64 = 0.125;
const LONGER: f64 = 1.6;

/// Smallest step, as a fraction of the distance covered so far: the search ends if it fails.
const SHORTEST: f64 = 1e-3;

/// Result of a search.
pub(crate) enum Found {
    Settled(Settled),
    /// The contacts of two asperities merge before the target. Contains the last contacts before merging.
    Merging([usize; 2], Contacts),
    /// The iteration did not converge. Contains the last converged contacts.
    Lost(Trouble, Contacts),
}

impl Equations<'_> {
    /// Finds the contacts at the target, starting from the contacts `near` if given.
    pub(crate) fn find(
        &mut self,
        target: Prescribed,
        near: Option<&Contacts>,
        run: &Run<'_>,
    ) -> Result<Found, SolveError> {
        let first = self.layout.first_touch();
        let nothing = match target {
            Prescribed::Indentation(indentation) => (indentation <= first).then_some(indentation),
            Prescribed::Force(force) => (force <= 0.0).then_some(first),
        };
        if let Some(indentation) = nothing {
            return Ok(Found::Settled(Settled {
                contacts: self.layout.untouched(indentation),
                factors: None,
                steps: 0,
            }));
        }
        if let Some(near) = near.filter(|near| !near.discs.is_empty())
            && let Ok(settled) = self.settle(near.clone(), target, run)?
        {
            return Ok(Found::Settled(settled));
        }
        let start = self.contacts_of(&point_forces(self.layout, target));
        if !start.discs.is_empty()
            && let Ok(settled) = self.settle(start, target, run)?
        {
            return Ok(Found::Settled(settled));
        }
        self.climb(target, run)
    }

    /// Finds the contacts at the target by load steps from first contact.
    pub(crate) fn climb(&mut self, target: Prescribed, run: &Run<'_>) -> Result<Found, SolveError> {
        let first = self.layout.first_touch();
        let end = match target {
            Prescribed::Indentation(indentation) => indentation,
            Prescribed::Force(_) => point_forces(self.layout, target).indentation,
        };
        let mut step = FIRST_STEP * (end - first);
        let mut good = self.layout.untouched(first);
        for _ in 0..STEP_LIMIT {
            let reached = good.indentation;
            let next = match target {
                Prescribed::Indentation(end) => end.min(reached + step),
                Prescribed::Force(_) => reached + step,
            };
            let trouble = match self.climb_to(next, &good, run)? {
                Ok(settled) => match target {
                    Prescribed::Indentation(end) if next >= end => {
                        return Ok(Found::Settled(settled));
                    }
                    Prescribed::Force(force) if self.force(&settled.contacts) >= force => {
                        match self.settle(settled.contacts, target, run)? {
                            Ok(settled) => return Ok(Found::Settled(settled)),
                            Err(trouble) => trouble,
                        }
                    }
                    _ => {
                        good = settled.contacts;
                        step *= LONGER;
                        continue;
                    }
                },
                Err(trouble) => trouble,
            };
            step *= 0.5;
            if step <= SHORTEST * (good.indentation - first) || reached + step <= reached {
                return Ok(match trouble {
                    Trouble::Crowded(asperities) => Found::Merging(asperities, good),
                    other => Found::Lost(other, good),
                });
            }
        }
        Ok(Found::Lost(Trouble::Unsettled, good))
    }

    fn climb_to(
        &mut self,
        next: f64,
        good: &Contacts,
        run: &Run<'_>,
    ) -> Result<Result<Settled, Trouble>, SolveError> {
        let target = Prescribed::Indentation(next);
        let start = if good.discs.is_empty() {
            self.contacts_of(&point_forces(self.layout, target))
        } else {
            good.clone()
        };
        self.settle(start, target, run)
    }
}
