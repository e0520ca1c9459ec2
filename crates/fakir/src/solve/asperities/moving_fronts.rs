//! The fronts of an adhesive floor on the [path](super::follow) of rounded tops.
//!
//! At a constant indentation the fronts move by one cell in each round, together with the tops, until they rest: on loading forwards, on unloading
//! backwards. Tops detach that have no stable equilibrium with the moved fronts, and others jump into contact. All of that is one jump, which
//! dissipates the energy that it releases.

use super::equations::Equations;
use super::follow::{Ended, Path};
use super::loaded_floor::LoadedFloor;
use super::newton::{Aim, Trouble};
use crate::problem::load::Prescribed;
use crate::solve::rules::bonded_floor::Rounds;
use crate::solve::rules::fronts::Course;
use crate::state::Branch;
use crate::state::discs::Contacts;
use std::sync::Arc;

/// Largest number of rounds at one load.
const ROUND_LIMIT: usize = 1000;

impl Path<'_, '_, '_> {
    /// Whether there is an adhesive floor that is in contact or may come into contact.
    pub(super) fn is_on_floor(&self) -> bool {
        let is_adhesive = self.equations.has_fronts();
        let is_bonded = !self.here.settled.contacts.bonded.is_empty();
        is_adhesive && (is_bonded || self.branch == Branch::Loading)
    }

    /// Brings the deepest cell of an adhesive floor into contact, with those around it.
    pub(super) fn touch_floor(&mut self) -> Result<(), Ended> {
        let ground = self.equations.ground.as_ref();
        let seed = ground.and_then(|ground| Some(ground.around(ground.deepest()?.0)));
        seed.map_or(Ok(()), |seed| self.bond(&seed, None))
    }

    /// Moves the fronts at a constant indentation, and records the jump. Returns whether any moved.
    pub(super) fn rest(&mut self) -> Result<bool, Ended> {
        if !self.equations.has_fronts() {
            return Ok(false);
        }
        let before = self.energy();
        let old = self.here.settled.contacts.clone();
        let number = self.changes.len();
        let moves = self.until_rest(None)?;
        if moves {
            self.finish_jump(before, old, None, number);
        }
        Ok(moves)
    }

    /// Moves the fronts until they rest and no other top is touched, under a load or at a constant indentation. Returns whether anything moved.
    pub(super) fn until_rest(&mut self, load: Option<Aim>) -> Result<bool, Ended> {
        let mut rounds = Rounds::new(match self.branch {
            Branch::Loading => Course::Loading,
            Branch::Unloading => Course::Unloading,
        });
        if let Some(ground) = &mut self.equations.ground {
            ground.lift_bans();
        }
        for round in 0..ROUND_LIMIT {
            let contacts = self.here.settled.contacts.clone();
            // The last floor may be that of an attempt.
            self.equations.close_floor(&contacts);
            let ground = self.equations.ground.as_mut();
            let moved = ground.and_then(|ground| ground.next_round(&mut rounds));
            if let Some(bonded) = moved {
                self.bond(&bonded, load)?;
            } else if self.equations.largest_overlap(&contacts) > 0.0 {
                self.touch_all(0.0)?;
            } else {
                return Ok(round > 0);
            }
        }
        Err(Ended::Trouble(Trouble::Unsettled))
    }

    /// Moves to the equilibrium with these cells of the floor in contact: cell by cell, if it is not found at once. Tops that have none detach.
    fn bond(&mut self, bonded: &Arc<[usize]>, load: Option<Aim>) -> Result<(), Ended> {
        let old = &self.here.settled.contacts;
        let here = Aim::Load(Prescribed::Indentation(old.indentation));
        let changed = difference(&old.bonded, bonded);
        let contacts = Contacts {
            bonded: bonded.clone(),
            ..old.clone()
        };
        match self.at(&contacts, load.unwrap_or(here)) {
            Ok(next) if next.is_stable(self.sign) != Some(false) || contacts.discs.is_empty() => {
                self.here = next;
            }
            Ok(_) | Err(Ended::Trouble(Trouble::Unsettled)) if changed.len() > 1 => {
                let half = difference(&contacts.bonded, &changed[..changed.len() / 2]);
                self.bond(&half.into(), load)?;
                self.bond(bonded, load)?;
            }
            Ok(_) | Err(Ended::Trouble(Trouble::Unsettled)) if !contacts.discs.is_empty() => {
                self.detach(&contacts, self.fastest_of(&self.here))?;
            }
            Ok(_) => {}
            Err(error) => return Err(error),
        }
        Ok(())
    }
}

/// The numbers that are in one of two increasing lists.
fn difference(one: &[usize], other: &[usize]) -> Vec<usize> {
    let only = |list: &'_ [usize], other: &'_ [usize]| -> Vec<usize> {
        let numbers = list.iter().copied();
        numbers
            .filter(|number| other.binary_search(number).is_err())
            .collect()
    };
    let mut all = [only(one, other), only(other, one)].concat();
    all.sort_unstable();
    all
}

impl Equations<'_> {
    /// Whether the floor is part of the equations, with adhesion.
    pub(super) fn has_fronts(&self) -> bool {
        self.ground.as_ref().is_some_and(LoadedFloor::is_adhesive)
    }

    /// Overlap with an adhesive floor that is not in contact; minus infinity without one, or in contact. The floor must be closed.
    pub(super) fn floor_overlap(&self) -> f64 {
        let deepest = self.ground.as_ref().and_then(LoadedFloor::deepest);
        deepest.map_or(f64::NEG_INFINITY, |(_, depth)| depth)
    }
}
