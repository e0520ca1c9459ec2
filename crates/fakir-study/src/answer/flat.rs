//! A flat surface.

use super::kind::{Context, Found, Kind, Reached, Saved, saved_curve};
use super::request::{AnswerError, Details, Maps, Request, Running};
use crate::citations::Topic;
use crate::fields::FieldMap;
use crate::figures::saved;
use crate::numbers::{LENGTH_DIGITS, digits, seconds, significant};
use crate::provenance::{FLAT_METHOD, Provenance};
use crate::record::{FlatAnswer, GradientObject, Record, flat_indenter_name};
use crate::report::state::{
    QuantityList, adhesion_words, drive_words, lens_words, range_warnings, remark,
};
use crate::result::{csv, json};
use fakir::problem::{CyclePlan, Interactions, Load, Solver, UnloadingPoint};
use fakir::state::{FlatContact, FlatCycle, Limit, Regime, Run, Solution};
use fakir_case::FlatCase;
use fakir_case::unit::Dimension;
use fakir_figure::{flat_cycle, flat_pressure};
use serde::Serialize;

/// Number of rows of the table of pressures.
const PRESSURES: usize = 129;

/// Distance of the row closest to the rim, as a fraction of the radius: with adhesion the pressure at the rim is infinite.
const NEAREST_TO_RIM: f64 = 0.999;

impl Kind for FlatCase {
    type Problem = Self;

    fn problem(&self) -> &Self {
        self
    }

    fn solver(&self) -> Solver {
        Solver::Flat
    }

    fn indenter(&self) -> &'static str {
        flat_indenter_name(&self.system)
    }

    fn lines(&self) -> [String; 2] {
        [
            format!("flat surface under a {}", lens_words(&self.system)),
            self.method(),
        ]
    }

    fn method(&self) -> String {
        FLAT_METHOD.to_owned()
    }

    fn interactions(&self) -> &Interactions {
        self.system.interactions()
    }

    fn topics(&self, range: Option<f64>) -> Vec<Topic> {
        Topic::of_flat(self, range)
    }

    fn text(&self) -> String {
        self.to_toml()
    }

    fn check(
        &self,
        request: &Request,
        details: &Details,
        run: &Run<'_>,
    ) -> Result<(), AnswerError> {
        if let Request::Cycle(plan) = request {
            if self.system.adhesion().is_none() {
                return Err(AnswerError::Refused(
                    "a cycle needs adhesion: give adhesion.work in the case file, or --set adhesion.work=50mJ/m2",
                ));
            }
            if matches!(plan.turn, UnloadingPoint::Critical(_)) {
                return Err(AnswerError::Refused(
                    "a flat surface has no critical state at which the loading could end: give --to or --to-force",
                ));
            }
        }
        if let (Request::Contact(_), Maps::Points(Some(points))) = (request, details.maps) {
            FieldMap::check_memory([points; 2], run)?;
        }
        details.check_range(self.system.adhesion())
    }

    fn with_gradient(
        &self,
        load: Load,
        run: &Run<'_>,
    ) -> Result<(Reached<FlatContact>, GradientObject), AnswerError> {
        let found = self.system.gradient(load, run)?;
        let gradient = GradientObject::from(&found);
        Ok((Reached::Contact(found.contact), gradient))
    }

    fn cycle(
        &self,
        plan: CyclePlan,
        running: &Running<'_>,
    ) -> Result<Box<dyn Found<Self>>, AnswerError> {
        Ok(Box::new(self.system.cycle(&plan, &running.run)?))
    }

    fn record(&self, found: &Reached<FlatContact>) -> Record {
        Record::of(&FlatAnswer {
            system: &self.system,
            contact: found.contact(),
        })
    }

    fn limits(&self, contact: &FlatContact, range: Option<f64>) -> Option<Vec<Limit>> {
        Some(contact.limits(&self.system, range))
    }

    fn meets(&self, _: Regime) -> String {
        String::new() // a flat surface has no critical state
    }

    fn quantities(&self, found: &Reached<FlatContact>) -> QuantityList {
        quantities_of_flat(found.contact())
    }

    fn solution(&self, list: &mut QuantityList, contact: &FlatContact, wall_time: f64) {
        list.row(
            "solution",
            contact.termination.description().to_owned(),
            "",
            &format!("in {}", seconds(wall_time)),
        );
    }

    fn files(
        &self,
        found: &Reached<FlatContact>,
        points: Option<usize>,
        provenance: &Provenance,
        running: &Running<'_>,
    ) -> Result<Saved, AnswerError> {
        let contact = found.contact();
        let place = |k: usize| k as f64 / (PRESSURES - 1) as f64;
        let distances: Vec<f64> = (0..PRESSURES)
            // More rows near the rim, where the pressure changes most.
            .map(|k| {
                let angle = 0.5 * std::f64::consts::PI * place(k);
                NEAREST_TO_RIM * contact.contact_radius * angle.sin()
            })
            .collect();
        let pressures = self.system.pressure(contact, &distances);
        let rows = distances.iter().zip(&pressures);
        let rows = rows.map(|(distance, pressure)| PressureRow {
            radius_m: *distance,
            pressure_Pa: *pressure,
        });
        let mut files = Vec::new();
        if contact.contact_radius > 0.0 {
            files.push(csv("pressure.csv", rows));
        }
        (running.next)("fields");
        let map = FieldMap::of_flat(&self.system, contact, points, &running.run)?;
        files.extend(map.files(provenance));
        if let Ok(figure) = flat_pressure(contact, &distances, &pressures) {
            files.extend(saved(figure, provenance));
        }
        Ok(Saved {
            files,
            warnings: Vec::new(),
        })
    }
}

/// The numbers of a contact with a flat surface in a report.
#[must_use]
pub fn quantities_of_flat(contact: &FlatContact) -> QuantityList {
    let error = contact.error;
    let mut list = QuantityList::default();
    list.force_and_indentation([
        [contact.force, error.force],
        [contact.indentation, error.indentation],
    ])
    .radius(
        "contact radius",
        contact.contact_radius,
        error.contact_radius,
        String::new(),
    )
    .area(
        "contact area",
        contact.contact_area,
        digits(error.contact_radius),
        "",
    )
    .quantity(
        "mean pressure",
        contact.mean_pressure(),
        Dimension::Pressure,
        LENGTH_DIGITS,
        String::new(),
    )
    .quantity(
        "pressure on the axis",
        contact.pressure_on_axis,
        Dimension::Pressure,
        LENGTH_DIGITS,
        String::new(),
    )
    .row(
        "stiffness",
        significant(contact.stiffness, LENGTH_DIGITS),
        "N/m",
        "on loading",
    );
    list
}

/// The end of loading and the pull-off of a cycle on a flat surface.
pub fn turn_and_pull_off_of_flat(list: &mut QuantityList, cycle: &FlatCycle) {
    add_state(list, "loaded up to a force of", &cycle.turn);
    if let Some(pull_off) = &cycle.pull_off {
        add_state(list, "pull-off force", pull_off);
    }
}

fn add_state(list: &mut QuantityList, name: &str, contact: &FlatContact) {
    let error = contact.error.force;
    list.state(
        name,
        [contact.force, error],
        contact.indentation,
        remark(error),
    )
    .length(
        "  with a contact radius of",
        contact.contact_radius,
        String::new(),
    );
}

/// A row of `pressure.csv`.
#[derive(Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
struct PressureRow {
    /// Distance from the lens axis, m.
    radius_m: f64,
    /// Contact pressure, Pa; negative for tension.
    pressure_Pa: f64,
}

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
    /// Contact radius, m.
    contact_radius_m: f64,
}

impl Found<FlatCase> for FlatCycle {
    fn question(&self) -> String {
        "loading and unloading with adhesion".to_owned()
    }

    fn records(&self, _: &FlatCase) -> Vec<Record> {
        vec![Record::of(self)]
    }

    fn is_answer(&self) -> bool {
        Solution::is_answer(self)
    }

    fn problem(&self) -> Option<String> {
        Solution::problem(self)
    }

    fn json(&self, of: &Context<'_, FlatCase>) -> String {
        let object =
            crate::result::flat_cycle(self, &of.case.system, of.details.range, of.wall_time);
        json(&object)
    }

    fn text(&self, of: &Context<'_, FlatCase>) -> String {
        let [case, method] = of.case.lines();
        let mut list = QuantityList::default();
        add_state(&mut list, "jump into contact", &self.jump);
        turn_and_pull_off_of_flat(&mut list, self);
        if let Some(indentation) = self.separation {
            list.length("detachment", indentation, String::new());
        }
        list.works(
            self.work_of_separation,
            self.loop_area,
            self.loop_area_error,
        );
        list.interactions(&Record::of(self));
        list.limits(&self.limits(of));
        of.case.solution(&mut list, &self.turn, of.wall_time);
        format!(
            "Loading and unloading with adhesion\n{case}\n{}, {}\n{method}\n\n{}",
            adhesion_words(of.case.system.adhesion()),
            drive_words(self.plan.drive),
            list.text()
        )
    }

    fn limits(&self, of: &Context<'_, FlatCase>) -> Vec<Limit> {
        self.turn.limits(&of.case.system, of.details.range)
    }

    fn warnings(
        &self,
        of: &Context<'_, FlatCase>,
        _: &Running<'_>,
    ) -> Result<Vec<String>, AnswerError> {
        let mut warnings = crate::result::warnings(&self.turn);
        warnings.extend(range_warnings(&self.limits(of)));
        Ok(warnings)
    }

    fn files(
        &self,
        _: &FlatCase,
        _: Option<usize>,
        provenance: &Provenance,
        _: &Running<'_>,
    ) -> Result<Saved, AnswerError> {
        let rows = self.load_steps.iter().map(|step| CycleRow {
            branch: step.branch.name(),
            indentation_m: step.indentation,
            force_N: step.force,
            contact_radius_m: step.contact_radius,
        });
        Ok(saved_curve(rows, flat_cycle(self), provenance))
    }
}
