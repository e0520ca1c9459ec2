//! A contact disc inside the rim of one top, with its edge in equilibrium.

use super::records::{AttachedTop, CENTRED, Change, ChangedTop};
use crate::halfspace::disc::exterior::Exterior;
use crate::numerics::roots;
use crate::problem::Point;
use crate::problem::layer::WeightedLayer;
use crate::solve::floor::{Discs, LoadedDiscs};
use crate::solve::rules::fronts::{Domain, LEVELS, critical_stress_intensity_factor};
use crate::solve::rules::patch::{Patch, PatchSolver};
use crate::state::Run;
use std::convert::Infallible;
use std::f64::consts::PI;

/// Smallest radius of a disc that is followed, relative to the largest: without adhesion its force is proportional to the third power of
/// the radius.
const SMALLEST: f64 = 1e-6;

/// Golden-section steps in the logarithm of the radius where the disc is about to detach.
const SECTIONS: usize = 60;

/// The contact disc and its top.
pub(crate) struct InsideTop {
    pub(super) solver: PatchSolver,
    /// On half-spaces, where it does not depend on the radius of the disc.
    pub(super) exterior: Exterior,
    pub(super) layers: Vec<WeightedLayer>,
    pub(super) index: (i64, i64),
    pub(super) centre: Point,
    /// Radius of the top, and its height above the common level.
    pub(super) top: f64,
    pub(super) raised: f64,
    /// Radius at which the disc reaches the rim.
    pub(super) largest: f64,
    /// The disc, with the indentation relative to the height of the top.
    pub(super) patch: Patch,
}

impl InsideTop {
    pub(crate) fn force(&self) -> f64 {
        self.patch.force
    }

    pub(crate) fn radius(&self) -> f64 {
        self.patch.radius
    }

    /// Passes the disc as the loaded one to a function.
    pub(super) fn with_discs<R>(
        &self,
        run: &Run<'_>,
        ask: impl FnOnce(&LoadedDiscs<'_>) -> R,
    ) -> R {
        self.with_patch(&self.patch, run, ask)
    }

    pub(super) fn with_patch<R>(
        &self,
        patch: &Patch,
        run: &Run<'_>,
        ask: impl FnOnce(&LoadedDiscs<'_>) -> R,
    ) -> R {
        let on_layers = (!self.layers.is_empty()).then(|| patch.exterior(&self.layers));
        let exterior = on_layers.as_ref().unwrap_or(&self.exterior);
        let discs = LoadedDiscs {
            exterior,
            discs: Discs::around_axis(patch.radius, &patch.coefficients[..exterior.count()]),
            run,
        };
        ask(&discs)
    }

    pub(super) fn area(&self) -> f64 {
        PI * self.patch.radius * self.patch.radius
    }

    pub(super) fn energy(&self) -> f64 {
        self.solver.energy(&self.patch)
    }

    /// The disc as a top in contact.
    pub(super) fn attached_top(&self) -> AttachedTop {
        AttachedTop {
            index: self.index,
            centre: self.centre,
            radius: self.top,
            raised: self.raised,
            domain: Domain::OUT,
            coefficients: self.patch.coefficients.clone(),
            disc: Some(self.patch.radius),
        }
    }

    /// Fraction of the top in a disc of this radius.
    pub(super) fn part(&self, radius: f64) -> f64 {
        (radius / self.top).powi(2)
    }

    /// The change between these fractions of the top in contact, before and after.
    pub(super) fn changed(&self, [before, after]: [f64; 2]) -> Change {
        let area = PI * self.top * self.top;
        Change {
            gained: area * (after - before).max(0.0),
            lost: area * (before - after).max(0.0),
            tops: vec![ChangedTop {
                index: self.index,
                centre: self.centre,
                parts: [before, after],
                levels: LEVELS,
            }],
        }
    }

    pub(super) fn is_centred(&self) -> bool {
        self.centre[0].hypot(self.centre[1]) < CENTRED
    }

    /// Indentation relative to the common height.
    pub(super) fn indentation(&self, patch: &Patch) -> f64 {
        patch.indentation - self.raised
    }
}

/// Equilibrium of the edge of a disc on a top.
#[derive(Clone, Copy)]
pub(super) struct Edge<'a> {
    pub(super) inside: &'a InsideTop,
    pub(super) sag: &'a dyn Fn(f64) -> f64,
    pub(super) work: f64,
}

impl Edge<'_> {
    pub(super) fn at(&self, radius: f64) -> Patch {
        let edge = -critical_stress_intensity_factor(self.work / radius);
        self.inside.solver.with_edge(radius, self.sag, edge)
    }

    /// The radius that minimises a measure.
    pub(super) fn least(&self, measure: impl Fn(&Patch) -> f64) -> f64 {
        let largest = self.inside.largest;
        let of_logarithm = |logarithm: f64| measure(&self.at(logarithm.exp()));
        let ends = [SMALLEST * largest, largest].map(f64::ln);
        roots::least(ends, SECTIONS, of_logarithm).exp()
    }

    /// The radius in an interval at which an increasing measure has a value.
    pub(super) fn find(
        &self,
        [low, high]: [f64; 2],
        value: f64,
        measure: impl Fn(&Patch) -> f64,
    ) -> f64 {
        let excess = |radius: f64| measure(&self.at(radius)) - value;
        let ends = [low, high].map(|position| roots::Point {
            position,
            value: excess(position),
        });
        let root = roots::find(ends, 0.0, |radius| Ok::<_, Infallible>(excess(radius)));
        let root = root.unwrap_or_else(|never| match never {});
        root.map_or(high, |root| root.closest().position)
    }
}
