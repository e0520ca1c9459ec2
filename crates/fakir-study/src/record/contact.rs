//! The numbers of contacts and critical states with pillars, and those that every contact has.

use super::interactions;
use super::named::{Kind, Named, Recorded};
use fakir::state::{
    AsperityContact, Contact, ContactState, Critical, CriticalState, FloorContact, Solution,
};

/// Force, indentation and radius of any contact.
pub(super) fn load<T: Contact + 'static>() -> [Named<T>; 3] {
    [
        Named::number("force_N", "normal force on the lens", T::force).symbol("F"),
        Named::number(
            "indentation_m",
            "displacement of the lens from the position in which its lowest point is level with the pillar tops",
            T::indentation,
        )
        .symbol("ζ"),
        Named::number_if_any(
            "contact_radius_m",
            "distance between the lens axis and the farthest point in contact, on a pillar top or on the floor; `null` under a plate",
            T::contact_radius,
        )
        .symbol("a"),
    ]
}

/// Indentation and force after the first contact of a cycle, if there is one.
pub(super) fn first_contact<T: 'static>(of: fn(&T) -> Option<[f64; 2]>) -> [Named<T>; 2] {
    [
        Named::number_if_any(
            "first_contact_indentation_m",
            "indentation at first contact",
            move |it: &T| Some(of(it)?[0]),
        )
        .in_objects(),
        Named::number_if_any(
            "first_contact_force_N",
            "force after first contact",
            move |it: &T| Some(of(it)?[1]),
        )
        .in_objects(),
    ]
}

/// Force and indentation at the end of the loading of a cycle.
pub(super) fn turn<T: 'static>(of: fn(&T) -> [f64; 2]) -> [Named<T>; 2] {
    [
        Named::number(
            "turn_force_N",
            "force at the end of loading",
            move |it: &T| of(it)[0],
        ),
        Named::number(
            "turn_indentation_m",
            "indentation at the end of loading",
            move |it: &T| of(it)[1],
        ),
    ]
}

/// Force and indentation at the pull-off of a cycle, if there is one.
pub(super) fn pull_off<T: 'static>(
    meaning: &'static str,
    of: fn(&T) -> Option<[f64; 2]>,
) -> [Named<T>; 2] {
    [
        Named::number_if_any("pull_off_force_N", meaning, move |it: &T| Some(of(it)?[0])),
        Named::number_if_any(
            "pull_off_indentation_m",
            "indentation at pull-off",
            move |it: &T| Some(of(it)?[1]),
        ),
    ]
}

/// What the pull-off force is.
pub(super) const PULL_OFF: &str =
    "largest tensile force on unloading, negative; `null` if there is none";

/// The same for any critical state, and what is met first.
pub(super) fn critical_load<C: Contact + 'static>() -> [Named<Critical<C>>; 5] {
    [
        Named::word(
            "regime",
            "`top_first`, or `bottom_first` if the lens reaches the floor before any pillar",
            |it: &Critical<C>| Some(it.regime.name()),
        ),
        Named::number(
            "critical_force_N",
            "force at which the lens just reaches the floor",
            |it: &Critical<C>| it.contact.force(),
        )
        .symbol("F_c"),
        Named::number(
            "critical_indentation_m",
            "indentation at which the lens just reaches the floor",
            |it: &Critical<C>| it.contact.indentation(),
        )
        .symbol("ζ_c"),
        Named::point(
            "bottom_contact_m",
            "the older name of `floor_contact_m`",
            |it: &Critical<C>| Some(it.floor_contact),
        ),
        Named::point(
            "floor_contact_m",
            "position of the floor contact relative to the lens axis; under a plate, which has no axis, in the coordinates of the grid",
            |it: &Critical<C>| Some(it.floor_contact),
        ),
    ]
}

/// Numbers of every answer: a row added here is part of all contacts, critical states, cycles and states of loadings.
pub(super) fn common<T: Solution + 'static>() -> Vec<Named<T>> {
    vec![
        Named::flag("converged", "whether the solver converged", T::converged).in_objects(),
        Named::word(
            "unresolved",
            "a quantity whose estimated relative error is above 0.5, if any; the command then ends with exit status 1",
            |it: &T| it.unresolved().map(|found| found.quantity),
        )
        .optional()
        .in_objects(),
    ]
}

/// Numbers of every state of a loading: a single flag for whether its numbers are an answer, and what is [common](common).
pub(super) fn common_of_states<T: Solution + 'static>() -> Vec<Named<T>> {
    let mut rows = vec![Named::flag(
        "converged",
        "whether the solver converged and all numbers are resolved",
        T::is_answer,
    )];
    let further = common().into_iter();
    rows.extend(further.filter(|row| !matches!(row.entry.path, "converged" | "unresolved")));
    rows
}

/// A contact that may extend to the floor.
pub trait MayReachFloor: 'static {
    /// The contact with the floor, if its load is computed.
    fn on_floor(&self) -> Option<&FloorContact>;

    /// Whether the lens has certainly not reached the floor.
    fn is_before_floor(&self) -> bool;
}

impl MayReachFloor for ContactState {
    fn on_floor(&self) -> Option<&FloorContact> {
        self.floor.as_ref()
    }

    fn is_before_floor(&self) -> bool {
        !self.beyond_transition()
    }
}

impl MayReachFloor for AsperityContact {
    fn on_floor(&self) -> Option<&FloorContact> {
        self.floor.as_ref()
    }

    fn is_before_floor(&self) -> bool {
        self.beyond_transition() == Some(false)
    }
}

/// A number of the floor contact: zero before the floor is touched, none past the transition if its load is not computed.
#[must_use]
pub fn of_floor<C: MayReachFloor>(state: &C, number: impl Fn(&FloorContact) -> f64) -> Option<f64> {
    match state.on_floor() {
        Some(floor) => Some(number(floor)),
        None => state.is_before_floor().then_some(0.0),
    }
}

/// Numbers of the pillars in contacts and critical states.
fn pillars() -> [Named<ContactState>; 3] {
    [
        Named::number(
            "top_contact_radius_m",
            "distance between the lens axis and the farthest point in contact on a pillar top",
            |it: &ContactState| it.contact_radius,
        ),
        Named::count(
            "pillars_in_contact",
            "number of pillars in contact",
            |it: &ContactState| it.pillars_in_contact,
        ),
        Named::count(
            "pillars_partially_in_contact",
            "number of pillars that the edge of the contact crosses",
            |it: &ContactState| it.pillars_partially_in_contact,
        ),
    ]
}

/// Numbers of the solution of contacts and critical states.
fn solution() -> [Named<ContactState>; 2] {
    [
        Named::word(
            "method",
            "`spectral`, `love`, `punch` or `homogenised`",
            |it: &ContactState| Some(it.method.name()),
        ),
        Named::word(
            "lens_shape",
            "shape of the lens, as `lens.shape` in case files",
            |it: &ContactState| Some(it.system.lens().shape_name()),
        )
        .in_objects(),
    ]
}

fn errors() -> [Named<ContactState>; 2] {
    [
        Named::number(
            "relative_error_estimate.force",
            "estimated relative error of the force",
            |it: &ContactState| it.error.force,
        ),
        Named::number(
            "relative_error_estimate.indentation",
            "estimated relative error of the indentation",
            |it: &ContactState| it.error.indentation,
        ),
    ]
}

fn iterations() -> Named<ContactState> {
    Named::count("iterations", "solver iterations", |it: &ContactState| {
        it.iterations
    })
}

/// Numbers of the floor contact. A table has zeros before the transition, where the object has no floor.
pub(super) fn floor<C: MayReachFloor>() -> Vec<Named<C>> {
    vec![
        Named::number_if_any("floor.force_N", "force on the floor", |it: &C| {
            of_floor(it, |floor| floor.force)
        })
        .always(),
        Named::number_if_any("floor.share", "floor force over total force", |it: &C| {
            of_floor(it, |floor| floor.share)
        })
        .always(),
        Named::number_if_any(
            "floor.contact_area_m2",
            "contact area on the floor",
            |it: &C| of_floor(it, |floor| floor.area),
        )
        .always(),
        Named::number_if_any(
            "floor.radius_m",
            "distance between the lens axis and the farthest floor contact",
            |it: &C| it.on_floor().map(|floor| floor.radius),
        )
        .in_objects()
        .decides(),
        Named::number_if_any(
            "floor.smallest_distance_to_rim_m",
            "smallest distance between the floor contact and the rim of a pillar",
            |it: &C| it.on_floor().map(|floor| floor.smallest_distance_to_rim),
        )
        .always()
        .in_objects(),
        Named::count_if_any(
            "floor.patches",
            "number of separate floor contacts; `null` if two grids differ",
            |it: &C| {
                let floor = it.on_floor()?;
                floor.patches_agree.then_some(floor.patches)
            },
        )
        .in_objects(),
        Named::point(
            "floor.cell_m",
            "cell sides of the floor pressure; the cells rotate with the lattice",
            |it: &C| it.on_floor().map(FloorContact::cell),
        )
        .in_objects(),
    ]
}

/// Errors of the floor contact.
pub(super) fn floor_errors<C: MayReachFloor>() -> [Named<C>; 2] {
    [
        Named::number_if_any(
            "floor.relative_error_estimate.share",
            "estimated relative error of the fraction carried by the floor",
            |it: &C| of_floor(it, |floor| floor.error.share),
        ),
        Named::number_if_any(
            "floor.relative_error_estimate.contact_area",
            "estimated relative error of the area",
            |it: &C| of_floor(it, |floor| floor.error.area),
        ),
    ]
    .map(Named::always)
}

impl Recorded for ContactState {
    const KIND: Kind = Kind::Press;

    fn rows() -> Vec<Named<Self>> {
        let mut rows = Vec::from(solution());
        rows.extend(load().map(Named::always));
        rows.extend(pillars().map(|row| match row.entry.path {
            "top_contact_radius_m" => row.in_objects(),
            _ => row,
        }));
        rows.push(Named::number(
            "smallest_floor_gap_m",
            "smallest gap between lens and floor; beyond the transition 0, or negative if the floor is ignored; under a cylinder or a plate, the gap to the undeformed lens between the outermost pillars",
            |it: &Self| it.smallest_floor_gap,
        ));
        rows.push(Named::flag(
            "beyond_transition",
            "whether the lens has reached the floor, or would have if the floor were not ignored",
            Self::beyond_transition,
        ));
        rows.extend(floor());
        rows.extend(errors());
        rows.push(Named::number(
            "relative_error_estimate.contact_radius",
            "estimated relative error of the contact radius",
            Self::relative_whole_contact_radius_error,
        ));
        rows.extend(floor_errors());
        rows.extend(interactions::rows());
        rows.extend(common());
        rows.push(iterations());
        rows
    }
}

impl Recorded for CriticalState {
    const KIND: Kind = Kind::Transition;

    fn rows() -> Vec<Named<Self>> {
        let contact = |rows: Vec<Named<ContactState>>| {
            rows.into_iter()
                .map(|row| row.of_part(|it: &Self| &it.contact))
        };
        let [regime, force, indentation, older, floor] = critical_load();
        let [top_radius, in_contact, partially] = pillars();
        let mut rows: Vec<Named<Self>> = contact(Vec::from(solution())).collect();
        rows.extend([
            regime,
            Named::number(
                "surface_fraction",
                "surface fraction of the pillar tops",
                |it: &Self| it.contact.system.pattern().surface_fraction(),
            )
            .symbol("φ"),
            Named::number(
                "pitch_m",
                "distance between neighbouring pillars",
                |it: &Self| it.contact.system.pitch(),
            )
            .symbol("e"),
            force,
            indentation,
            Named::number(
                "critical_contact_radius_m",
                "the larger of `top_contact_radius_m` and the distance between the lens axis and the floor contact",
                Self::contact_radius,
            )
            .symbol("a_c"),
        ]);
        rows.extend(contact(vec![top_radius]));
        rows.extend([older, floor]);
        rows.extend(contact(vec![in_contact, partially]));
        rows.extend([
            Named::number(
                "normalized.force",
                "critical force over hd/γ_int",
                |it: &Self| it.normalized().force,
            ),
            Named::number(
                "normalized.contact_radius",
                "critical contact radius over the pitch",
                |it: &Self| it.normalized().contact_radius,
            ),
            Named::number(
                "normalized.indentation",
                "critical indentation over the height of the pillars",
                |it: &Self| it.normalized().indentation,
            ),
        ]);
        rows.extend(contact(Vec::from(errors())));
        rows.push(Named::number(
            "relative_error_estimate.contact_radius",
            "estimated relative error of the critical contact radius",
            Self::relative_contact_radius_error,
        ));
        rows.push(
            Named::number(
                "relative_error_estimate.top_contact_radius",
                "estimated relative error of the top contact radius",
                |it: &Self| it.contact.relative_contact_radius_error(),
            )
            .in_objects(),
        );
        rows.extend(interactions::rows());
        rows.extend(contact(common()));
        rows.extend(contact(vec![iterations()]));
        rows
    }
}
