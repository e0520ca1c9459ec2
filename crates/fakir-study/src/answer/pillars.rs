//! Pillars with flat tops.

use super::kind::{Found, Kind, Reached, Saved};
use super::request::{AnswerError, Details, Maps, Request, Running};
use crate::citations::Topic;
use crate::fields::FieldMap;
use crate::figures::{question_in_figure, saved};
use crate::numbers::{significant, with_unit};
use crate::provenance::{Provenance, method_words};
use crate::record::{GradientObject, Record};
use crate::report::state::{QuantityList, pillar_pattern_line, radius_digits};
use crate::result::pillars;
use fakir::problem::{CyclePlan, FloorModel, Interactions, Load, Method, Solver, System};
use fakir::state::{ContactState, CriticalState, Limit, Normalized, Regime, Run, SolveError};
use fakir_case::Case;
use fakir_case::unit::Dimension;
use fakir_figure::{
    FigureError, ProfileState, View, floor_gap_map, floor_pressure_map, pillar_pressure,
    pressure_map, profiles, top_view,
};

impl Kind for Case {
    type Problem = Self;

    fn problem(&self) -> &Self {
        self
    }

    fn solver(&self) -> Solver {
        self.method.into()
    }

    fn indenter(&self) -> &'static str {
        "lens"
    }

    fn lines(&self) -> [String; 2] {
        [pillar_pattern_line(&self.system), self.method()]
    }

    fn method(&self) -> String {
        method_words(self.method)
    }

    fn interactions(&self) -> &Interactions {
        self.system.interactions()
    }

    fn topics(&self, range: Option<f64>) -> Vec<Topic> {
        Topic::of_case_with_range(self, range)
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
        match request {
            Request::Cycle(_) if self.system.adhesion().is_none() => Err(AnswerError::Refused(
                "a cycle needs adhesive pillar tops: give adhesion.work in the case file, or --set \
                 adhesion.work=50mJ/m2; without adhesion, unloading follows the curve of loading",
            )),
            Request::Contact(_) => match details.maps {
                Maps::Points(Some(points)) => Ok(FieldMap::check_memory([points; 2], run)?),
                _ => Ok(()),
            },
            Request::Cycle(_) | Request::Loading(_) | Request::History(_) => Ok(()),
        }
    }

    fn with_gradient(
        &self,
        load: Load,
        run: &Run<'_>,
    ) -> Result<(Reached<ContactState>, GradientObject), AnswerError> {
        let found = fakir::gradient(&self.system, load, self.method, run)?;
        let gradient = GradientObject::from(&found);
        let reached = match load {
            Load::FloorContact => Reached::Critical(found.critical_state()?),
            _ => Reached::Contact(found.contact),
        };
        Ok((reached, gradient))
    }

    fn cycle(
        &self,
        plan: CyclePlan,
        running: &Running<'_>,
    ) -> Result<Box<dyn Found<Self>>, AnswerError> {
        (running.next)("cycle");
        let cycle = fakir::cycle(&self.system, plan, self.method, &running.run)?;
        Ok(Box::new(cycle))
    }

    fn record(&self, found: &Reached<ContactState>) -> Record {
        match found {
            Reached::Contact(contact) => Record::of(contact),
            Reached::Critical(critical) => Record::of(critical),
        }
    }

    fn limits(&self, contact: &ContactState, range: Option<f64>) -> Option<Vec<Limit>> {
        Some(contact.limits(range))
    }

    fn meets(&self, regime: Regime) -> String {
        match regime {
            Regime::TopFirst => "the lens rests on pillar tops and just reaches the floor",
            Regime::BottomFirst => "the lens reaches the floor before any pillar",
        }
        .to_owned()
    }

    fn quantities(&self, found: &Reached<ContactState>) -> QuantityList {
        match found {
            Reached::Contact(state) => of_contact(state),
            Reached::Critical(critical) => of_critical_state(critical),
        }
    }

    fn solution(&self, list: &mut QuantityList, contact: &ContactState, wall_time: f64) {
        list.solution(contact, wall_time);
    }

    fn further_warnings(
        &self,
        contact: &ContactState,
        running: &Running<'_>,
    ) -> Result<Vec<String>, AnswerError> {
        if contact.smallest_floor_gap < 0.0 {
            (running.next)("critical state");
            return Ok(vec![beyond(self, &running.run)?]);
        }
        Ok(Vec::new())
    }

    fn files(
        &self,
        found: &Reached<ContactState>,
        points: Option<usize>,
        provenance: &Provenance,
        running: &Running<'_>,
    ) -> Result<Saved, AnswerError> {
        let Running { run, next } = running;
        let (state, floor_contact) = (found.contact(), found.floor_contact());
        let mut files = Vec::from_iter(pillars(state).some_csv("pillars.csv"));
        next("fields");
        if let Some(map) = FieldMap::of_contact(state, points, run)? {
            files.extend(map.files(provenance));
        }
        next("figures");
        let section = ProfileState {
            label: question_in_figure(&provenance.question),
            state,
            floor_contact,
        };
        let figures = [
            profiles(&[section], run),
            pressure_map(state, floor_contact),
            pillar_pressure(state, run),
            floor_gap_map(state, run),
            floor_pressure_map(state),
            top_view(state, View::Contact, run),
        ];
        for figure in figures {
            match figure {
                Ok(figure) => files.extend(saved(figure, provenance)),
                Err(FigureError::Solve(error)) => return Err(error.into()),
                // There is no such figure for this state or method.
                Err(_) => {}
            }
        }
        Ok(Saved {
            files,
            warnings: Vec::new(),
        })
    }
}

/// The warning past the transition if the floor is ignored, with the critical load.
fn beyond(case: &Case, run: &Run<'_>) -> Result<String, AnswerError> {
    let critical = match fakir::transition(&case.system, case.method, run) {
        Ok(critical) => critical_load(&critical),
        Err(SolveError::Interrupted) => return Err(SolveError::Interrupted.into()),
        Err(error) => format!("at a load that could not be computed ({error})"),
    };
    let advice = match (case.system.floor_model(), case.method) {
        (FloorModel::Contact, Method::Love(_) | Method::Punch(_) | Method::Homogenised) => {
            ": only the method spectral computes its load"
        }
        _ => "",
    };
    Ok(format!(
        "past the transition: the lens reaches the floor {critical}; this contact is computed as \
         if the floor were not there{advice}"
    ))
}

fn critical_load(critical: &CriticalState) -> String {
    format!(
        "at a force of {} and an indentation of {}",
        with_unit(critical.contact.force, Dimension::Force, 6),
        with_unit(critical.contact.indentation, Dimension::Length, 6)
    )
}

/// The contact radius, rounded to its estimated error.
fn add_radius(list: &mut QuantityList, radius: f64, error: f64, reduced: &Normalized) {
    let remark = significant(reduced.contact_radius, radius_digits(error));
    list.radius("contact radius", radius, error, format!("a/e = {remark}"));
}

fn add_top_radius(list: &mut QuantityList, state: &ContactState) {
    list.quantity(
        "  on the pillar tops",
        state.contact_radius,
        Dimension::Length,
        radius_digits(state.relative_contact_radius_error()),
        String::new(),
    );
}

fn of_contact(state: &ContactState) -> QuantityList {
    let radius = state.whole_contact_radius();
    let reduced = Normalized::new(&state.system, state.force, radius, state.indentation);
    let gap = if state.floor.is_some() {
        "in contact: past the transition"
    } else if state.beyond_transition() {
        "negative: past the transition"
    } else {
        ""
    };
    let mut list = QuantityList::default();
    list.load(state, &reduced);
    let error = state.relative_whole_contact_radius_error();
    add_radius(&mut list, radius, error, &reduced);
    if radius > state.contact_radius {
        add_top_radius(&mut list, state);
    }
    list.pillars(state)
        .length(
            "smallest floor gap",
            state.smallest_floor_gap,
            gap.to_owned(),
        )
        .floor(state);
    list
}

fn of_critical_state(critical: &CriticalState) -> QuantityList {
    let (state, reduced) = (&critical.contact, critical.normalized());
    let mut list = QuantityList::default();
    list.load(state, &reduced);
    let error = critical.relative_contact_radius_error();
    add_radius(&mut list, critical.contact_radius(), error, &reduced);
    add_top_radius(&mut list, state);
    list.length(
        "  of the floor contact",
        critical.floor_contact_distance(),
        place(critical),
    )
    .pillars(state);
    list
}

/// Position of the floor contact; one of the symmetric copies.
fn place(critical: &CriticalState) -> String {
    let rounding = 1e-9 * critical.floor_contact_distance();
    let [x, y] = critical.floor_contact.map(|value| {
        let value = if value.abs() > rounding { value } else { 0.0 };
        with_unit(value, Dimension::Length, 5)
    });
    format!("at x = {x}, y = {y}")
}

/// A rough estimate of the cost of the critical state of a case, in pillars: the number of pillars touched, and a constant for
/// every case. The contact radius is the paper's for large contacts,
/// `e sqrt(1 + (k phi)^2)`, with `k = 4 R h/d^2`, but half the lens radius at most. With adhesive tops every pillar is followed
/// through its own events.
pub(super) fn cost(system: &System, method: Method) -> f64 {
    const OVERHEAD: f64 = 20.0;
    const SOME_PILLARS: f64 = 500.0;
    let pillar = system.pillar();
    let lens = system.lens().widest();
    if lens.is_infinite() {
        // A plate, which touches all pillars.
        return OVERHEAD + SOME_PILLARS;
    }
    let growth = 4.0 * lens * pillar.height / pillar.diameter.powi(2);
    let radius = (growth * system.pattern().surface_fraction()).hypot(1.0); // in pitches
    let radius = radius.min(0.5 * lens / system.pitch());
    let pillars = radius * radius;
    match method {
        Method::Love(mesh) => OVERHEAD + pillars * (mesh.cells_per_diameter as f64).powi(2),
        Method::Homogenised => OVERHEAD,
        _ if !system.adhesion().is_none() => OVERHEAD + pillars * pillars,
        _ => OVERHEAD + pillars,
    }
}
