//! Height maps, and pillars of any cross-section on them.

use super::kind::{Found, Kind, Reached, Saved};
use super::request::{AnswerError, Details, Maps, Request, Running};
use super::surface_cycle::check_cycle;
use crate::citations::Topic;
use crate::fields::{FieldMap, MOST_POINTS};
use crate::figures::{question_in_figure, saved};
use crate::numbers::{DIGITS, LENGTH_DIGITS, digits, seconds, significant, with_unit};
use crate::output::File;
use crate::provenance::Provenance;
use crate::record::{GradientObject, Record, SurfaceAnswer, indenter_name};
use crate::report::state::{QuantityList, adhesion_words};
use crate::report::surface::description;
use fakir::problem::{CyclePlan, Indenter, Interactions, Load, Solver, SurfaceSystem};
use fakir::state::{Limit, LoadSharing, Regime, Run, SurfaceContact};
use fakir_case::SurfaceCase;
use fakir_case::height_map::to_npy;
use fakir_case::unit::Dimension;
use fakir_figure::{SurfaceState, surface_gap_map, surface_pressure_map, surface_profiles};

/// Digits shown of contact areas, which change by whole cells.
const AREA_DIGITS: usize = 4;

impl Kind for SurfaceCase {
    type Problem = SurfaceSystem;

    fn problem(&self) -> &SurfaceSystem {
        &self.system
    }

    fn solver(&self) -> Solver {
        Solver::HeightMap
    }

    fn indenter(&self) -> &'static str {
        indenter_name(self.system.indenter())
    }

    fn lines(&self) -> [String; 2] {
        let [surface, cells] = description(self);
        let adhesion = self.system.adhesion();
        if adhesion.is_none() {
            return [surface, cells];
        }
        [format!("{surface}, {}", adhesion_words(adhesion)), cells]
    }

    fn method(&self) -> String {
        let grid = self.system.surface().grid();
        format!(
            "boundary elements, {} by {} cells",
            grid.columns(),
            grid.rows()
        )
    }

    fn interactions(&self) -> &Interactions {
        self.system.interactions()
    }

    fn topics(&self, range: Option<f64>) -> Vec<Topic> {
        let topics = Topic::of_surface(self).into_iter();
        topics
            .chain(range.map(|_| Topic::AttractionRange))
            .collect()
    }

    fn cited_as(&self) -> String {
        "elements on a surface".to_owned()
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
        details.check_range(self.system.adhesion())?;
        if let Request::Cycle(plan) = request {
            return check_cycle(self, plan);
        }
        let Request::Contact(load) = request else {
            return Ok(());
        };
        // The fields are on the cells of the surface, and are saved if there are not too many of them.
        let grid = self.system.surface().grid();
        match details.maps {
            Maps::Points(None) if grid.cell_count() <= MOST_POINTS * MOST_POINTS => {
                FieldMap::check_memory([grid.columns(), grid.rows()], run)?;
            }
            Maps::Points(Some(_)) => {
                return Err(AnswerError::Refused(
                    "--field-points is for pillar patterns: the fields of a surface are saved on its own cells, as \
                     many as its file or surface.grid gives",
                ));
            }
            _ => {}
        }
        if matches!(load, Load::FloorContact) && self.system.floor().is_none() {
            return Err(AnswerError::Refused(
                "surface.floor is missing: a height map has no pillars that define which part \
                 of it is the floor; give the height at or below which it is",
            ));
        }
        Ok(())
    }

    fn cycle(
        &self,
        plan: CyclePlan,
        running: &Running<'_>,
    ) -> Result<Box<dyn Found<Self>>, AnswerError> {
        Ok(Box::new(self.system.cycle(plan, &running.run)?))
    }

    fn with_gradient(
        &self,
        load: Load,
        run: &Run<'_>,
    ) -> Result<(Reached<SurfaceContact>, GradientObject), AnswerError> {
        let found = self.system.gradient(load, run)?;
        let gradient = GradientObject::from(&found);
        Ok((Reached::Contact(found.contact), gradient))
    }

    fn record(&self, found: &Reached<SurfaceContact>) -> Record {
        let system = &self.system;
        match found {
            Reached::Contact(answer) => Record::of(&SurfaceAnswer { system, answer }),
            Reached::Critical(answer) => Record::of(&SurfaceAnswer { system, answer }),
        }
    }

    fn limits(&self, contact: &SurfaceContact, range: Option<f64>) -> Option<Vec<Limit>> {
        Some(contact.limits(&self.system, range))
    }

    fn meets(&self, regime: Regime) -> String {
        let indenter = self.indenter();
        match regime {
            Regime::TopFirst => {
                format!("the {indenter} rests on the tops and just reaches the floor")
            }
            Regime::BottomFirst => format!("the {indenter} reaches the floor before anything else"),
        }
    }

    fn quantities(&self, found: &Reached<SurfaceContact>) -> QuantityList {
        let contact = found.contact();
        let mut list = QuantityList::default();
        add_load(&mut list, contact);
        add_area(&mut list, contact);
        let place = |value: f64| with_unit(value, Dimension::Length, LENGTH_DIGITS);
        match (
            found.floor_contact(),
            self.system.indenter(),
            contact.shares,
        ) {
            (Some([x, y]), Indenter::Lens(lens), _) if lens.is_axisymmetric() => {
                list.length(
                    "floor contact",
                    x.hypot(y),
                    format!("from the lens axis, at x = {}, y = {}", place(x), place(y)),
                );
            }
            // A plate or a cylinder has no axis to count a distance from.
            (Some([x, y]), ..) => {
                list.length("floor contact, x", x, String::new()).length(
                    "floor contact, y",
                    y,
                    String::new(),
                );
            }
            (None, _, Some(shares)) => add_shares(&mut list, &shares, contact),
            (None, _, None) => {}
        }
        list
    }

    fn solution(&self, list: &mut QuantityList, contact: &SurfaceContact, wall_time: f64) {
        add_solution(list, contact, wall_time);
    }

    fn files(
        &self,
        found: &Reached<SurfaceContact>,
        _: Option<usize>,
        provenance: &Provenance,
        _: &Running<'_>,
    ) -> Result<Saved, AnswerError> {
        let contact = found.contact();
        let field = |name, values| File::new(name, to_npy(&contact.grid, values));
        let mut saved_files = Saved::default();
        let files = &mut saved_files.files;
        files.extend([
            field("pressure.npy", &contact.pressure),
            field("gap.npy", &contact.gap),
            field("heights.npy", self.system.surface().heights()),
        ]);
        match FieldMap::of_surface(&self.system, contact) {
            Some(map) => files.extend(map.files(provenance)),
            None => saved_files.warnings.push(format!(
                "more cells than {MOST_POINTS} by {MOST_POINTS}: the fields are saved as .npy only"
            )),
        }
        let state = SurfaceState {
            label: question_in_figure(&provenance.question),
            system: &self.system,
            contact,
            floor_contact: found.floor_contact(),
        };
        let figures = [
            surface_profiles(std::slice::from_ref(&state)),
            surface_pressure_map(&state),
            surface_gap_map(&state),
        ];
        // Some do not exist for a surface without contact, or in contact everywhere.
        for figure in figures.into_iter().flatten() {
            saved_files.files.extend(saved(figure, provenance));
        }
        Ok(saved_files)
    }
}

/// Load, area and the parts of tops and floor of a contact.
pub fn load_and_shares(list: &mut QuantityList, contact: &SurfaceContact) {
    add_load(list, contact);
    add_area(list, contact);
    if let Some(shares) = &contact.shares {
        add_shares(list, shares, contact);
    }
}

fn add_load(list: &mut QuantityList, contact: &SurfaceContact) {
    let error = contact.error;
    let rows = [
        (
            "force",
            contact.force,
            Dimension::Force,
            error.map(|error| error.force),
        ),
        (
            "indentation",
            contact.indentation,
            Dimension::Length,
            error.map(|error| error.indentation),
        ),
    ];
    for (name, value, dimension, error) in rows {
        let (digits, remark) = as_known(error, DIGITS);
        list.quantity(name, value, dimension, digits, remark);
    }
}

/// The number of significant digits for an estimated error, up to a maximum, and a remark on the error.
fn as_known(error: Option<f64>, most: usize) -> (usize, String) {
    match error {
        None => (AREA_DIGITS, "error not estimated: too few cells".to_owned()),
        Some(error) if error > 0.0 => {
            let remark = format!("estimated error {}", significant(error, 1));
            (digits(error).min(most), remark)
        }
        Some(_) => (most, String::new()),
    }
}

fn add_area(list: &mut QuantityList, contact: &SurfaceContact) {
    let (digits, remark) = as_known(contact.area_error, AREA_DIGITS);
    list.area("contact area", contact.contact_area, digits, &remark);
    if let Some(radius) = contact.contact_radius {
        let error = contact.relative_contact_radius_error().unwrap_or(0.0);
        list.radius("contact radius", radius, error, String::new());
    }
}

fn add_shares(list: &mut QuantityList, shares: &LoadSharing, contact: &SurfaceContact) {
    let known = contact
        .error
        .map_or(AREA_DIGITS, |error| digits(error.force));
    let part = |value: f64, whole: f64| {
        if value > 0.0 {
            format!("{} % of it", significant(100.0 * value / whole, 3))
        } else {
            String::new()
        }
    };
    for (name, share) in [("tops", shares.tops), ("floor", shares.floor)] {
        list.quantity(
            &format!("force on the {name}"),
            share.force,
            Dimension::Force,
            known.min(AREA_DIGITS),
            part(share.force, contact.force),
        );
        list.area(
            &format!("contact area on the {name}"),
            share.area,
            AREA_DIGITS,
            &part(share.area, contact.contact_area),
        );
    }
}

fn add_solution(list: &mut QuantityList, contact: &SurfaceContact, wall_time: f64) {
    list.row(
        "energy error, at most",
        significant(contact.certificate.energy_bound, 1),
        "",
        "of the solution on these cells, relative",
    )
    .row(
        "iterations",
        contact.products.to_string(),
        "",
        &format!(
            "{}, in {}",
            contact.termination.description(),
            seconds(wall_time)
        ),
    );
}
