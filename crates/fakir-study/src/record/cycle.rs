//! The numbers of cycles of loading and unloading.

use super::contact::{PULL_OFF, common, first_contact, pull_off, turn};
use super::interactions;
use super::named::{Kind, Named, Recorded};
use fakir::problem::Method;
use fakir::state::{CriticalState, Cycle, CycleError, CycleLoadStep, FloorResolution, HeldFloor};
use fakir::theory::adhesion::kendall_pull_off;

/// The errors of one result, which a cycle may not have.
macro_rules! errors {
    ($figure:literal, $of:expr) => {{
        let of: fn(&Cycle) -> Option<CycleError> = $of;
        [
            Named::number_if_any(
                concat!("relative_error_estimate.", $figure, ".numerical"),
                "estimated relative error of the numerical solution: the sum of the next three; the whole object is `null` where the cycle has no such figure",
                move |it: &Cycle| Some(of(it)?.numerical()),
            )
            .column(concat!("relative_error_estimate_", $figure))
            .decides(),
            Named::number_if_any(
                concat!("relative_error_estimate.", $figure, ".levels"),
                "part of it from the discrete positions of the fronts on pillar tops",
                move |it: &Cycle| Some(of(it)?.levels),
            )
            .in_objects(),
            Named::number_if_any(
                concat!("relative_error_estimate.", $figure, ".rim_angles"),
                "part of it from the angular resolution along the rims",
                move |it: &Cycle| Some(of(it)?.rim_angles),
            )
            .in_objects(),
            Named::number_if_any(
                concat!("relative_error_estimate.", $figure, ".degree"),
                "part of it from the degree of the pressure on pillar tops",
                move |it: &Cycle| Some(of(it)?.degree),
            )
            .in_objects(),
            Named::number_if_any(
                concat!("relative_error_estimate.", $figure, ".model"),
                "estimated relative error of the model: the sum of the next three",
                move |it: &Cycle| Some(of(it)?.model()),
            )
            .column(concat!("relative_model_error_", $figure)),
            Named::number_if_any(
                concat!("relative_error_estimate.", $figure, ".model_fronts"),
                "part of it from the possible shapes of the fronts",
                move |it: &Cycle| Some(of(it)?.fronts),
            )
            .in_objects(),
            Named::number_if_any(
                concat!("relative_error_estimate.", $figure, ".model_columns"),
                "part of it because columns do not tilt under eccentric tension as real pillars do",
                move |it: &Cycle| Some(of(it)?.columns),
            )
            .in_objects(),
            Named::number_if_any(
                concat!("relative_error_estimate.", $figure, ".model_corners"),
                "part of it because the stress at the corners of elastic pillars is less singular than that at the rim of a flat punch: the increase for flaws of 1 % of the radius at the rims",
                move |it: &Cycle| Some(of(it)?.corners),
            )
            .in_objects(),
        ]
        .map(Named::always)
    }};
}

/// Pull-off force of one pillar with a flat top alone (Kendall), N, negative.
fn kendall(cycle: &Cycle) -> f64 {
    let system = &cycle.system;
    let radius = 0.5 * system.pillar().diameter;
    kendall_pull_off(
        system.reduced_modulus(),
        radius,
        system.adhesion().receding(),
    )
}

/// Work of separation of the largest area of tops that was in contact, J.
fn parting(cycle: &Cycle) -> f64 {
    let areas = cycle.stations.iter().map(|station| station.contact_area);
    cycle.system.adhesion().receding() * areas.fold(0.0, f64::max)
}

/// The floor after the jump onto it, and the state then.
fn jump(cycle: &Cycle) -> Option<(&CycleLoadStep, HeldFloor)> {
    cycle.floor?;
    let [_, after] = cycle.floor_jump()?;
    Some((after, after.floor?))
}

fn loading() -> Vec<Named<Cycle>> {
    let mut rows: Vec<Named<Cycle>> = first_contact(|it: &Cycle| {
        let step = it.stations.get(it.first_contact?)?;
        Some([step.indentation, step.force])
    })
    .into();
    rows.extend([
        Named::number_if_any(
            "zero_load_indentation_m",
            "equilibrium indentation of a lens without load",
            |it: &Cycle| it.zero_load_indentation,
        )
        .in_objects(),
        Named::number_if_any(
            "critical_force_N",
            "critical force; `null`, as the whole critical state, if the loading does not reach it",
            |it: &Cycle| Some(it.critical.as_ref()?.contact.force),
        )
        .symbol("F_c"),
        Named::number_if_any(
            "critical_indentation_m",
            "critical indentation",
            |it: &Cycle| Some(it.critical.as_ref()?.contact.indentation),
        )
        .symbol("ζ_c"),
        Named::number_if_any(
            "critical_contact_radius_m",
            "critical contact radius",
            |it: &Cycle| it.critical.as_ref().map(CriticalState::contact_radius),
        )
        .symbol("a_c"),
        Named::count_if_any(
            "critical_pillars_in_contact",
            "pillars in contact in the critical state",
            |it: &Cycle| Some(it.critical.as_ref()?.contact.pillars_in_contact),
        )
        .in_objects(),
        Named::count_if_any(
            "critical_pillars_partially_in_contact",
            "those of them that are in contact in part",
            |it: &Cycle| Some(it.critical.as_ref()?.contact.pillars_partially_in_contact),
        )
        .in_objects(),
    ]);
    rows.extend(turn(|it: &Cycle| [it.turn.force, it.turn.indentation]));
    rows.extend([
        Named::number(
            "turn_contact_radius_m",
            "contact radius at the end of loading",
            |it: &Cycle| it.turn.contact_radius,
        )
        .in_objects(),
        Named::count(
            "turn_pillars_in_contact",
            "pillars in contact at the end of loading",
            |it: &Cycle| it.turn.pillars_in_contact,
        ),
        Named::count(
            "turn_pillars_partially_in_contact",
            "those of them that are in contact in part",
            |it: &Cycle| it.turn.pillars_partially_in_contact,
        )
        .in_objects(),
        Named::flag(
            "stopped_by_floor",
            "always `false`: loading continues on the floor",
            |_: &Cycle| false,
        )
        .in_objects(),
    ]);
    rows
}

fn unloading() -> Vec<Named<Cycle>> {
    let mut rows: Vec<Named<Cycle>> = pull_off(PULL_OFF, |it: &Cycle| {
        let contact = it.pull_off.as_ref()?;
        Some([contact.force, contact.indentation])
    })
    .into();
    rows.extend([
        Named::count_if_any(
            "pull_off_pillars_in_contact",
            "pillars in contact at pull-off",
            |it: &Cycle| Some(it.pull_off.as_ref()?.pillars.len()),
        ),
        Named::number(
            "kendall_pull_off_force_N",
            "pull-off force of a single pillar of the common diameter with a flat top (Kendall)",
            kendall,
        ),
        Named::number_if_any(
            "normalized_pull_off_force",
            "pull-off force over that of a single pillar of the common diameter: the equivalent number of independent pillars",
            |it: &Cycle| Some(it.pull_off.as_ref()?.force / kendall(it)),
        ),
        Named::number_if_any(
            "last_release_indentation_m",
            "indentation at which the last pillar detaches; `null` if something is still in contact",
            |it: &Cycle| it.separation,
        ),
        Named::number_if_any(
            "work_of_separation_J",
            "work against tensile forces during unloading; `null` under a prescribed force, where the lens leaves at once",
            Cycle::work_of_separation,
        ),
        Named::number_if_any(
            "hysteresis_J",
            "area of the loop of force over indentation; `null` for a path that is not closed, and under a prescribed force",
            Cycle::hysteresis,
        ),
        Named::number_if_any(
            "normalized_hysteresis",
            "hysteresis over the receding work of adhesion times the largest top area that was in contact; 2 (1 + κ) for flat pillars that detach one by one",
            |it: &Cycle| Some(it.hysteresis()? / parting(it)),
        ),
        Named::number(
            "dissipation_J",
            "energy dissipated by all events, summed independently",
            |it: &Cycle| it.dissipation,
        )
        .in_objects(),
        Named::number_if_any(
            "certificate",
            "relative difference of `dissipation_J` from the area of the loop; `null` for a path that is not closed",
            Cycle::certificate,
        ),
    ]);
    rows
}

/// Columns for an adhesive floor in tables; the object `floor` contains more numbers.
fn adhesive_floor() -> [Named<Cycle>; 10] {
    [
        Named::flag(
            "floor_is_coarse",
            "whether the cells of an adhesive floor are so coarse that its results are orders of magnitude",
            |it: &Cycle| it.floor.is_some_and(FloorResolution::is_coarse),
        ),
        Named::number_if_any(
            "jump_force_N",
            "force after the jump into contact with an adhesive floor",
            |it: &Cycle| Some(jump(it)?.0.force),
        ),
        Named::number_if_any(
            "jump_floor_area_m2",
            "contact area on the floor after the jump; none if it is not resolved",
            |it: &Cycle| match it.unresolved_jump_area() {
                Some(_) => None,
                None => Some(jump(it)?.1.area),
            },
        ),
        Named::number_if_any(
            "jump_front_radius_m",
            "distance between the lens axis and the farthest floor contact after the jump",
            |it: &Cycle| Some(jump(it)?.1.radius),
        ),
        Named::count_if_any(
            "jump_holes",
            "number of hollow sites between three pillars in contact after the jump",
            |it: &Cycle| jump(it)?.1.holes,
        ),
        Named::number_if_any(
            "floor_lost_indentation_m",
            "indentation of the last state on unloading with the floor in contact; `null` if the floor is still in contact",
            |it: &Cycle| Some(it.floor_lost()?[0].indentation),
        ),
        Named::number_if_any("floor_lost_force_N", "force in that state", |it: &Cycle| {
            Some(it.floor_lost()?[0].force)
        }),
        Named::number_if_any(
            "relative_error_estimate_jump_force",
            "estimated relative error of the force after the jump",
            |it: &Cycle| jump(it).and(Some(it.floor?.errors.jump_force)),
        ),
        Named::number_if_any(
            "relative_error_estimate_jump_floor_area",
            "estimated relative error of the area after the jump",
            |it: &Cycle| jump(it).and(Some(it.floor?.errors.jump_area)),
        ),
        Named::number_if_any(
            "relative_error_estimate_floor_lost_indentation",
            "estimated relative error of the indentation at which the floor detaches",
            |it: &Cycle| jump(it).and(Some(it.floor?.errors.lost_indentation)),
        ),
    ]
    .map(Named::in_tables)
}

impl Recorded for Cycle {
    const KIND: Kind = Kind::Cycle;

    fn rows() -> Vec<Named<Self>> {
        let mut rows = vec![
            Named::word("method", "`spectral`", |it: &Self| {
                Some(Method::Spectral(it.accuracy).name())
            }),
            Named::number(
                "surface_fraction",
                "surface fraction of the pillar tops",
                |it: &Self| it.system.pattern().surface_fraction(),
            )
            .symbol("φ"),
            Named::number(
                "pitch_m",
                "distance between neighbouring pillars",
                |it: &Self| it.system.pitch(),
            )
            .symbol("e"),
            Named::number(
                "work_of_adhesion_J_per_m2",
                "energy per area released when contact forms",
                |it: &Self| it.system.adhesion().work,
            )
            .symbol("w"),
            Named::number(
                "receding_work_of_adhesion_J_per_m2",
                "energy per area required to separate the contact",
                |it: &Self| it.system.adhesion().receding(),
            ),
            Named::word(
                "drive",
                "loading mode, the quantity that is constant during a jump: `displacement`, `force` or `machine`",
                |it: &Self| Some(it.plan.drive.name()),
            ),
            Named::number_if_any(
                "machine_stiffness_N_per_m",
                "stiffness of the machine, if the loading mode is `machine`",
                |it: &Self| it.plan.drive.stiffness(),
            ),
        ];
        rows.extend(loading());
        rows.extend(unloading());
        rows.extend(adhesive_floor());
        rows.push(Named::number(
            "kendall_strain",
            "tensile stress on a pillar at its detachment over the modulus of the substrate",
            |it: &Cycle| it.system.kendall_strain(),
        ));
        rows.extend(errors!("critical_force", |it| {
            it.critical.as_ref().map(|_| it.errors.critical_force)
        }));
        rows.extend(errors!("critical_indentation", |it| {
            it.critical.as_ref().map(|_| it.errors.critical_indentation)
        }));
        rows.extend(errors!("pull_off_force", |it| {
            it.pull_off.as_ref().map(|_| it.errors.pull_off_force)
        }));
        rows.extend(errors!("hysteresis", |it| {
            it.certificate().map(|_| it.errors.loop_area)
        }));
        rows.extend(interactions::rows());
        rows.extend(common());
        rows
    }
}
