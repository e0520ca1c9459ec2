//! The states of a loading: the rows of its table.

use super::asperities::{AsperityAnswer, largest};
use super::contact::{MayReachFloor, common_of_states, of_floor};
use super::interactions::{self, Interacting};
use super::named::{Kind, Named, Recorded};
use super::surface::SurfaceAnswer;
use fakir::problem::{ContactAreas, Interactions};
use fakir::state::{AsperityContact, AsperityErrors, ContactState, FloorContact, SurfaceContact};

/// A state of a loading.
#[derive(Debug, Clone, Copy)]
pub struct LoadingState<A> {
    /// The contact.
    pub answer: A,
    /// Where in the loading it is.
    pub place: Place,
}

/// A place in the order of a loading.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    /// Whether it is the critical state.
    pub critical: bool,
    /// Whether it is past that; none where it is not known what the floor is.
    pub beyond: Option<bool>,
}

impl<A: Interacting> Interacting for LoadingState<A> {
    fn interactions(&self) -> &Interactions {
        self.answer.interactions()
    }

    fn areas(&self) -> ContactAreas {
        self.answer.areas()
    }
}

impl<A> LoadingState<A> {
    /// The same state with its case.
    pub(crate) fn of<B>(&self, answer: B) -> LoadingState<B> {
        let place = self.place;
        LoadingState { answer, place }
    }
}

fn force<C: 'static>(of: fn(&C) -> f64) -> Named<C> {
    Named::number("force_N", "normal force on the lens", of).symbol("F")
}

fn indentation<C: 'static>(of: fn(&C) -> f64) -> Named<C> {
    Named::number("indentation_m", "indentation", of).symbol("ζ")
}

fn place() -> [Named<Place>; 2] {
    [
        Named::flag(
            "critical",
            "whether it is the critical state",
            |it: &Place| it.critical,
        ),
        Named::flag_if_any(
            "beyond_transition",
            "whether the floor is in contact, or would be if it were not ignored; `null` where it is not known what the floor is",
            |it: &Place| it.beyond,
        ),
    ]
}

/// Numbers of the floor contact.
fn floor<C: MayReachFloor>() -> [Named<C>; 4] {
    let number = |name, meaning, of: fn(&FloorContact) -> f64| {
        Named::number_if_any(name, meaning, move |it: &C| of_floor(it, of))
    };
    [
        number(
            "floor_force_N",
            "force on the floor; `null` past the transition where it is ignored or not computed",
            |it| it.force,
        ),
        number("floor_share", "floor force over total force", |it| it.share),
        number("floor_contact_area_m2", "contact area on the floor", |it| {
            it.area
        }),
        number(
            "floor_radius_m",
            "distance between the lens axis and the farthest floor contact",
            |it| it.radius,
        ),
    ]
}

/// Errors of the floor contact.
fn floor_errors<C: MayReachFloor>() -> [Named<C>; 2] {
    let error = |name, meaning, of: fn(&FloorContact) -> f64| {
        Named::number_if_any(name, meaning, move |it: &C| it.on_floor().map(of))
    };
    [
        error(
            "floor_share_error_estimate",
            "estimated relative error of the fraction of the load carried by the floor",
            |it| it.error.share,
        ),
        error(
            "floor_contact_area_error_estimate",
            "estimated relative error of the contact area on the floor",
            |it| it.error.area,
        ),
    ]
}

impl Recorded for LoadingState<&ContactState> {
    const KIND: Kind = Kind::Loading;

    fn rows() -> Vec<Named<Self>> {
        let contact = |rows: Vec<Named<ContactState>>| {
            rows.into_iter()
                .map(|row| row.of_part(|it: &Self| it.answer))
        };
        let mut rows: Vec<Named<Self>> = contact(
            vec![
                indentation(|it: &ContactState| it.indentation),
                force(|it: &ContactState| it.force),
                Named::number(
                    "contact_radius_m",
                    "contact radius",
                    ContactState::whole_contact_radius,
                )
                .symbol("a"),
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
                Named::number(
                    "smallest_floor_gap_m",
                    "smallest gap between lens and floor; past the transition negative if the floor is ignored",
                    |it: &ContactState| it.smallest_floor_gap,
                ),
            ],
        )
        .collect();
        rows.extend(contact(floor().into()));
        rows.extend(contact(vec![
            Named::number(
                "force_error_estimate",
                "estimated relative error of the force",
                |it: &ContactState| it.error.force,
            ),
            Named::number(
                "contact_radius_error_estimate",
                "estimated relative error of the contact radius",
                ContactState::relative_whole_contact_radius_error,
            ),
        ]));
        rows.extend(contact(floor_errors().into()));
        rows.extend(interactions::rows());
        rows.extend(place().map(|row| row.of_part(|it: &Self| &it.place)));
        rows.extend(contact(common_of_states()));
        rows
    }
}

impl Recorded for LoadingState<SurfaceAnswer<'_, SurfaceContact>> {
    const KIND: Kind = Kind::SurfaceLoading;

    fn rows() -> Vec<Named<Self>> {
        let contact = |rows: Vec<Named<SurfaceContact>>| {
            rows.into_iter()
                .map(|row| row.of_part(|it: &Self| it.answer.answer))
        };
        let mut rows: Vec<Named<Self>> = contact(vec![
            indentation(|it: &SurfaceContact| it.indentation),
            force(|it: &SurfaceContact| it.force),
            Named::number(
                "contact_area_m2",
                "area of the cells in contact",
                |it: &SurfaceContact| it.contact_area,
            )
            .symbol("A"),
            Named::number_if_any(
                "contact_radius_m",
                "contact radius; `null` under a plate",
                |it: &SurfaceContact| it.contact_radius,
            )
            .symbol("a"),
            Named::number_if_any(
                "tops_force_N",
                "force on the tops; `null` where it is not known what the floor is",
                |it: &SurfaceContact| Some(it.shares?.tops.force),
            ),
            Named::number_if_any(
                "tops_contact_area_m2",
                "contact area of the tops",
                |it: &SurfaceContact| Some(it.shares?.tops.area),
            ),
            Named::number_if_any(
                "floor_force_N",
                "force on the floor",
                |it: &SurfaceContact| Some(it.shares?.floor.force),
            ),
            Named::number_if_any(
                "floor_contact_area_m2",
                "contact area on the floor",
                |it: &SurfaceContact| Some(it.shares?.floor.area),
            ),
            Named::number_if_any(
                "force_error_estimate",
                "estimated relative error of the force; `null` on too few cells",
                |it: &SurfaceContact| Some(it.error?.force),
            ),
            Named::number_if_any(
                "contact_radius_error_estimate",
                "estimated relative error of the contact radius",
                SurfaceContact::relative_contact_radius_error,
            ),
            Named::number_if_any(
                "contact_area_error_estimate",
                "estimated relative error of the contact area; `null` on too few cells",
                |it: &SurfaceContact| it.area_error,
            ),
        ])
        .collect();
        rows.extend(interactions::rows());
        rows.extend(place().map(|row| row.of_part(|it: &Self| &it.place)));
        rows.extend(contact(common_of_states()));
        rows
    }
}

impl Recorded for LoadingState<AsperityAnswer<'_>> {
    const KIND: Kind = Kind::AsperityLoading;

    fn rows() -> Vec<Named<Self>> {
        let contact = |rows: Vec<Named<AsperityContact>>| {
            rows.into_iter()
                .map(|row| row.of_part(|it: &Self| it.answer.contact))
        };
        let error =
            |of: fn(&AsperityErrors) -> f64| move |it: &AsperityContact| it.error.as_ref().map(of);
        let mut rows: Vec<Named<Self>> = contact(vec![
            indentation(|it: &AsperityContact| it.indentation),
            force(|it: &AsperityContact| it.force),
            Named::number(
                "contact_area_m2",
                "area of all contacts on tops",
                |it: &AsperityContact| it.area,
            )
            .symbol("A"),
            Named::number_if_any(
                "contact_radius_m",
                "contact radius; `null` under a plate",
                |it: &AsperityContact| it.contact_radius,
            )
            .symbol("a"),
            Named::count(
                "pillars_in_contact",
                "number of pillars in contact",
                AsperityContact::touched,
            ),
            Named::number(
                "largest_pillar_force_N",
                "largest force on a pillar",
                |it: &AsperityContact| largest(it, |asperity| asperity.force),
            ),
            Named::number_if_any(
                "smallest_floor_gap_m",
                "smallest gap between lens and floor; past the transition 0, or negative with adhesion, where the load of the floor is neglected; `null` under a plate and a cylinder",
                |it: &AsperityContact| it.floor_gap.map(|floor| floor.gap),
            ),
            Named::number(
                "stiffness_N_per_m",
                "change of the force with the indentation",
                |it: &AsperityContact| it.slopes.force_with_indentation,
            ),
            Named::number_if_any(
                "force_error_estimate",
                "estimated relative error of the force",
                error(|it| it.force),
            ),
            Named::number_if_any(
                "contact_area_error_estimate",
                "estimated relative error of the contact area",
                error(|it| it.area),
            ),
        ])
        .collect();
        rows.extend(contact(floor().into()));
        rows.extend(contact(floor_errors().into()));
        rows.push(Named::flag(
            "floor_out_of_reach",
            "whether the floor is certainly not reached",
            |it: &Self| it.answer.floor_is_out_of_reach(),
        ));
        rows.extend(place().map(|row| row.of_part(|it: &Self| &it.place)));
        rows.extend(contact(common_of_states()));
        rows
    }
}
