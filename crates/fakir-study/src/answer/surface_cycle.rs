//! Cycles of loading and unloading of height maps with adhesion.

use super::kind::{Context, Found, Kind, Saved, saved_curve};
use super::request::{AnswerError, Running};
use crate::numbers::{LENGTH_DIGITS, seconds};
use crate::provenance::Provenance;
use crate::record::{Record, SurfaceAnswer};
use crate::report::state::{QuantityList, drive_words, range_warnings, remark};
use crate::result::{json, surface_cycle, surface_cycle_warnings};
use fakir::problem::{CyclePlan, LoadingMode, UnloadingPoint};
use fakir::state::{Limit, Solution, SurfaceCycle};
use fakir_case::SurfaceCase;
use serde::Serialize;

/// A row of `cycle.csv`.
#[derive(Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
struct CycleRow {
    /// `loading` or `unloading`.
    branch: &'static str,
    /// Indentation, m.
    indentation_m: f64,
    /// Normal force, N.
    force_N: f64,
    /// Contact area, m^2.
    contact_area_m2: f64,
}

/// Refuses a cycle that a case does not support.
pub(super) fn check_cycle(case: &SurfaceCase, plan: &CyclePlan) -> Result<(), AnswerError> {
    if case.system.adhesion().is_none() {
        return Err(AnswerError::Refused(
            "a cycle needs adhesion: give adhesion.work in the case file, or --set adhesion.work=50mJ/m2",
        ));
    }
    if plan.drive != LoadingMode::Displacement {
        return Err(AnswerError::Refused(
            "a cycle on a height map controls the indentation: leave out --drive and --machine-stiffness; its pull-off force is \
             the largest tensile force in every mode",
        ));
    }
    if matches!(plan.turn, UnloadingPoint::Critical(_)) && case.system.floor().is_none() {
        return Err(AnswerError::Refused(
            "a height map without a floor has no critical state at which the loading could end: give --to or --to-force, or surface.floor",
        ));
    }
    Ok(())
}

impl Found<SurfaceCase> for SurfaceCycle {
    fn question(&self) -> String {
        "loading and unloading with adhesion".to_owned()
    }

    fn records(&self, case: &SurfaceCase) -> Vec<Record> {
        vec![Record::of(&answer(self, case))]
    }

    fn is_answer(&self) -> bool {
        Solution::is_answer(self)
    }

    fn problem(&self) -> Option<String> {
        Solution::problem(self)
    }

    fn json(&self, of: &Context<'_, SurfaceCase>) -> String {
        let answer = answer(self, of.case);
        json(&surface_cycle(&answer, of.details.range, of.wall_time))
    }

    fn text(&self, of: &Context<'_, SurfaceCase>) -> String {
        let [case, method] = of.case.lines();
        let mut list = QuantityList::default();
        turn_and_pull_off_of_surface(&mut list, self);
        if let Some(indentation) = self.separation {
            list.length("last release", indentation, String::new());
        }
        let error = self.errors.map_or(f64::NAN, |errors| errors.loop_area);
        list.works(self.work_of_separation, self.loop_area, error);
        list.interactions(&Record::of(&answer(self, of.case)));
        let limits = self.limits(of);
        list.limits(&limits).summits(&limits);
        list.row(
            "load steps",
            self.load_steps.len().to_string(),
            "",
            &format!(
                "{}, in {}",
                self.termination.description(),
                seconds(of.wall_time)
            ),
        );
        format!(
            "Loading and unloading with adhesion\n{case}\n{}\n{method}\n\n{}",
            drive_words(self.plan.drive),
            list.text()
        )
    }

    fn limits(&self, of: &Context<'_, SurfaceCase>) -> Vec<Limit> {
        self.turn.limits(&of.case.system, of.details.range)
    }

    fn warnings(
        &self,
        of: &Context<'_, SurfaceCase>,
        _: &Running<'_>,
    ) -> Result<Vec<String>, AnswerError> {
        let mut warnings = surface_cycle_warnings(self);
        warnings.extend(range_warnings(&self.limits(of)));
        Ok(warnings)
    }

    fn files(
        &self,
        _: &SurfaceCase,
        _: Option<usize>,
        provenance: &Provenance,
        _: &Running<'_>,
    ) -> Result<Saved, AnswerError> {
        let rows = self.load_steps.iter().map(|step| CycleRow {
            branch: step.branch.name(),
            indentation_m: step.indentation,
            force_N: step.force,
            contact_area_m2: step.contact_area,
        });
        Ok(saved_curve(
            rows,
            fakir_figure::surface_cycle(self),
            provenance,
        ))
    }
}

fn answer<'a>(cycle: &'a SurfaceCycle, case: &'a SurfaceCase) -> SurfaceAnswer<'a, SurfaceCycle> {
    SurfaceAnswer {
        system: &case.system,
        answer: cycle,
    }
}

/// The end of loading and the pull-off of a cycle.
pub fn turn_and_pull_off_of_surface(list: &mut QuantityList, cycle: &SurfaceCycle) {
    let turn = &cycle.turn;
    let error = turn.error.map_or(f64::NAN, |error| error.force);
    list.state(
        "loaded up to a force of",
        [turn.force, error],
        turn.indentation,
        remark(error),
    )
    .area(
        "  with a contact area of",
        turn.contact_area,
        LENGTH_DIGITS,
        "",
    );
    if let Some(pull_off) = &cycle.pull_off {
        let error = cycle
            .errors
            .map_or(f64::NAN, |errors| errors.pull_off_force);
        list.state(
            "pull-off force",
            [pull_off.force, error],
            pull_off.indentation,
            remark(error),
        )
        .area(
            "  with a contact area of",
            pull_off.contact_area,
            LENGTH_DIGITS,
            "",
        );
    }
}
