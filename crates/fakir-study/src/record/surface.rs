//! The numbers of contacts and critical states with height maps.

use super::contact::{PULL_OFF, common, critical_load, first_contact, load, pull_off, turn};
use super::interactions::{self, Interacting};
use super::named::{Kind, Named, Recorded};
use super::object::Object;
use fakir::problem::{
    Boundary, ContactAreas, Grid, Indenter, Interactions, ShapedLens, SurfaceSystem,
};
use fakir::state::{
    ErrorEstimate, SurfaceContact, SurfaceCycle, SurfaceCycleErrors, SurfaceTransition,
};

/// An answer about a height map, and its case.
#[derive(Debug, Clone, Copy)]
pub struct SurfaceAnswer<'a, T> {
    /// What was solved.
    pub system: &'a SurfaceSystem,
    /// The contact or the critical state.
    pub answer: &'a T,
}

/// The name of what is pressed: `"lens"` or `"plate"`.
#[must_use]
pub fn indenter_name(indenter: &Indenter) -> &'static str {
    match indenter {
        Indenter::Lens(_) => "lens",
        Indenter::Flat(_) => "plate",
    }
}

pub(crate) fn boundary_name(boundary: Boundary) -> &'static str {
    match boundary {
        Boundary::FreeSpace => "free",
        Boundary::Periodic => "periodic",
    }
}

/// Method, indenter and grid of a height map, for a summary of many contacts.
pub(crate) fn surface_head(system: &SurfaceSystem) -> Object {
    let method = Named::word("method", "`love`: elements", |_: &SurfaceSystem| {
        Some(METHOD)
    });
    let mut rows = vec![method];
    rows.extend(surface());
    let grid = grid().into_iter();
    rows.extend(grid.map(|row| row.of_part(|it: &SurfaceSystem| it.surface().grid())));
    Object::of_rows(&rows, system)
}

/// What is pressed, and what is around the grid.
fn surface() -> [Named<SurfaceSystem>; 3] {
    [
        Named::word("indenter", "`lens` or `plate`", |it: &SurfaceSystem| {
            Some(indenter_name(it.indenter()))
        })
        .in_objects(),
        Named::word("lens_shape", "shape of a lens", |it: &SurfaceSystem| {
            it.indenter().lens().map(ShapedLens::shape_name)
        })
        .in_objects(),
        Named::word("boundary", "`free` or `periodic`", |it: &SurfaceSystem| {
            Some(boundary_name(it.boundary()))
        })
        .in_objects(),
    ]
}

/// The case and its cells.
fn question<'a, T: 'static>(grid: fn(&T) -> &Grid) -> Vec<Named<SurfaceAnswer<'a, T>>> {
    let of_grid = |rows: Vec<Named<Grid>>| {
        rows.into_iter()
            .map(move |row| row.of_part(move |it: &SurfaceAnswer<'a, T>| grid(it.answer)))
    };
    let of_system = |row: Named<SurfaceSystem>| row.of_part(|it: &SurfaceAnswer<'a, T>| it.system);
    let mut rows: Vec<_> = surface().map(of_system).into();
    rows.extend(of_grid(self::grid()));
    rows
}

/// The cells.
fn grid() -> Vec<Named<Grid>> {
    vec![
        Named::count("grid.columns", "cells along x", Grid::columns),
        Named::count("grid.rows", "cells along y", Grid::rows),
        Named::point("grid.cell_m", "sides of a cell", |it: &Grid| {
            Some(it.cell())
        }),
        Named::point(
            "grid.origin_m",
            "lower left corner of the grid, relative to the lens axis",
            |it: &Grid| Some(it.origin()),
        )
        .in_objects(),
    ]
}

/// How well it was answered.
fn solution() -> Vec<Named<SurfaceContact>> {
    let error =
        |of: fn(&ErrorEstimate) -> f64| move |it: &SurfaceContact| it.error.as_ref().map(of);
    let mut rows = vec![
        Named::number_if_any(
            "relative_error_estimate.force",
            "estimated relative error of the force; the whole object is `null` on too few cells",
            error(|it| it.force),
        )
        .decides(),
        Named::number_if_any(
            "relative_error_estimate.indentation",
            "estimated relative error of the indentation",
            error(|it| it.indentation),
        )
        .always(),
        Named::number_if_any(
            "relative_error_estimate.contact_radius",
            "estimated relative error of the contact radius: a cell from corner to corner",
            SurfaceContact::relative_contact_radius_error,
        ),
        Named::number_if_any(
            "relative_error_estimate.contact_area",
            "estimated relative error of the contact area, at least a part of the cells along its edge",
            |it: &SurfaceContact| it.area_error,
        ),
        Named::number(
            "certificate.energy_bound",
            "upper bound of the energy error of the solution on its cells, over the elastic energy; with adhesion the largest gap of a cell in contact, over the indentation",
            |it: &SurfaceContact| it.certificate.energy_bound,
        )
        .column("energy_bound"),
        Named::number(
            "certificate.interpenetration_m",
            "deepest interpenetration anywhere",
            |it: &SurfaceContact| it.certificate.interpenetration,
        )
        .in_objects(),
        Named::number(
            "certificate.gap_under_pressure_m",
            "largest gap of a cell in contact",
            |it: &SurfaceContact| it.certificate.gap_under_pressure,
        )
        .in_objects(),
    ];
    rows.extend(common());
    rows.push(Named::count(
        "iterations",
        "solver iterations on the last grid",
        |it: &SurfaceContact| it.products,
    ));
    rows
}

fn method() -> Named<SurfaceContact> {
    Named::word("method", "`love`: elements", |_: &SurfaceContact| {
        Some(METHOD)
    })
}

fn area() -> Named<SurfaceContact> {
    Named::number(
        "contact_area_m2",
        "area of the cells in contact",
        |it: &SurfaceContact| it.contact_area,
    )
    .symbol("A")
}

/// By which method height maps are solved.
pub(crate) const METHOD: &str = "love";

impl Recorded for SurfaceAnswer<'_, SurfaceContact> {
    const KIND: Kind = Kind::SurfacePress;

    fn rows() -> Vec<Named<Self>> {
        let contact = |rows: Vec<Named<SurfaceContact>>| {
            rows.into_iter()
                .map(|row| row.of_part(|it: &Self| it.answer))
        };
        let [force, indentation, radius] = load();
        let mut rows: Vec<Named<Self>> = contact(vec![method(), force, indentation]).collect();
        rows.extend(contact(vec![
            Named::number_if_any(
                "tops.force_N",
                "force on the tops, all that is not floor; `tops` and `floor` are `null` if it is not known which part is the floor",
                |it: &SurfaceContact| Some(it.shares?.tops.force),
            )
            .decides(),
            Named::number_if_any(
                "tops.contact_area_m2",
                "contact area of the tops",
                |it: &SurfaceContact| Some(it.shares?.tops.area),
            )
            .always(),
            Named::number_if_any("floor.force_N", "force on the floor", |it: &SurfaceContact| {
                Some(it.shares?.floor.force)
            })
            .decides(),
            Named::number_if_any(
                "floor.contact_area_m2",
                "contact area on the floor",
                |it: &SurfaceContact| Some(it.shares?.floor.area),
            )
            .always(),
        ]));
        rows.extend(contact(vec![area(), radius]));
        rows.extend(question(|it: &SurfaceContact| &it.grid));
        rows.extend(interactions::rows());
        rows.extend(contact(solution()));
        rows
    }
}

impl Recorded for SurfaceAnswer<'_, SurfaceTransition> {
    const KIND: Kind = Kind::SurfaceTransition;

    fn rows() -> Vec<Named<Self>> {
        let contact = |rows: Vec<Named<SurfaceContact>>| {
            rows.into_iter()
                .map(|row| row.of_part(|it: &Self| &it.answer.contact))
        };
        let [regime, force, indentation, older, floor] =
            critical_load().map(|row| row.of_part(|it: &Self| it.answer));
        let [_, _, radius] = load();
        let mut rows: Vec<Named<Self>> = contact(vec![method()]).collect();
        rows.extend([regime, force, indentation, older, floor]);
        rows.extend(contact(vec![area(), radius]));
        rows.extend(question(|it: &SurfaceTransition| &it.contact.grid));
        rows.extend(interactions::rows());
        rows.extend(contact(solution()));
        rows
    }
}

/// Loading and unloading.
fn cycle() -> Vec<Named<SurfaceCycle>> {
    let error = |path, meaning, of: fn(&SurfaceCycleErrors) -> f64| {
        Named::number_if_any(path, meaning, move |it: &SurfaceCycle| {
            it.errors.as_ref().map(of)
        })
    };
    let mut rows = vec![Named::word(
        "drive",
        "loading mode, the quantity that is constant during a jump: `displacement`",
        |it: &SurfaceCycle| Some(it.plan.drive.name()),
    )];
    rows.extend(first_contact(|it: &SurfaceCycle| {
        let step = it.load_steps.get(it.first_contact?)?;
        Some([step.indentation, step.force])
    }));
    rows.extend(turn(|it: &SurfaceCycle| {
        [it.turn.force, it.turn.indentation]
    }));
    rows.push(Named::number(
        "turn_contact_area_m2",
        "contact area at the end of loading",
        |it: &SurfaceCycle| it.turn.contact_area,
    ));
    rows.extend(pull_off(PULL_OFF, |it: &SurfaceCycle| {
        let contact = it.pull_off.as_ref()?;
        Some([contact.force, contact.indentation])
    }));
    rows.extend([
        Named::number_if_any(
            "pull_off_contact_area_m2",
            "contact area at pull-off",
            |it: &SurfaceCycle| Some(it.pull_off.as_ref()?.contact_area),
        ),
        Named::number_if_any(
            "last_release_indentation_m",
            "indentation at which the surfaces detach; `null` without unloading",
            |it: &SurfaceCycle| it.separation,
        ),
        Named::number_if_any(
            "work_of_separation_J",
            "work against tensile forces during unloading; `null` without unloading",
            |it: &SurfaceCycle| it.work_of_separation,
        ),
        Named::number_if_any(
            "hysteresis_J",
            "area of the loop of force over indentation; `null` without unloading",
            |it: &SurfaceCycle| it.loop_area,
        ),
        Named::number_if_any(
            "relative_error_estimate.turn_force",
            "estimated relative error of the force at the end of loading; `null`, as all estimates, on too few cells",
            |it: &SurfaceCycle| it.turn.error.map(|error| error.force),
        ),
        error(
            "relative_error_estimate.pull_off_force",
            "estimated relative error of the pull-off force",
            |it| it.pull_off_force,
        ),
        error(
            "relative_error_estimate.work_of_separation",
            "estimated relative error of the work of separation",
            |it| it.work_of_separation,
        ),
        error(
            "relative_error_estimate.hysteresis",
            "estimated relative error of the hysteresis",
            |it| it.loop_area,
        ),
    ]);
    rows
}

impl Recorded for SurfaceAnswer<'_, SurfaceCycle> {
    const KIND: Kind = Kind::SurfaceCycle;

    fn rows() -> Vec<Named<Self>> {
        let of_turn = |row: Named<SurfaceContact>| row.of_part(|it: &Self| &it.answer.turn);
        let mut rows: Vec<Named<Self>> = vec![of_turn(method())];
        let of_cycle = cycle().into_iter();
        rows.extend(of_cycle.map(|row| row.of_part(|it: &Self| it.answer)));
        rows.extend(question(|it: &SurfaceCycle| &it.turn.grid));
        rows.extend(interactions::rows());
        let common: Vec<Named<SurfaceCycle>> = common();
        rows.extend(
            common
                .into_iter()
                .map(|row| row.of_part(|it: &Self| it.answer)),
        );
        rows
    }
}

impl Interacting for SurfaceAnswer<'_, SurfaceCycle> {
    fn interactions(&self) -> &Interactions {
        self.system.interactions()
    }

    fn areas(&self) -> ContactAreas {
        self.answer.turn.areas()
    }
}

impl Interacting for SurfaceAnswer<'_, SurfaceContact> {
    fn interactions(&self) -> &Interactions {
        self.system.interactions()
    }

    fn areas(&self) -> ContactAreas {
        self.answer.areas()
    }
}

impl Interacting for SurfaceAnswer<'_, SurfaceTransition> {
    fn interactions(&self) -> &Interactions {
        self.system.interactions()
    }

    fn areas(&self) -> ContactAreas {
        self.answer.contact.areas()
    }
}
