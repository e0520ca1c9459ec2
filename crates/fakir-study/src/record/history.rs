//! The numbers of a history of viscoelastic bodies, of its states and of its events.

use super::named::{Kind, Named, Recorded};
use super::numbers::Record;
use crate::approach::Loadable;
use crate::history::Followed;
use fakir::solve::elastic_curve::ElasticCurve;
use fakir::state::{Contact, HistoryEvent, HistoryState};

/// A state of a history, with the elastic curve from which its contact is read.
#[derive(Debug, Clone, Copy)]
pub struct HistoryRow<'a> {
    /// The state.
    pub state: HistoryState,
    /// The elastic curve.
    pub curve: &'a ElasticCurve,
    /// Whether the surface defines a floor.
    pub has_floor: bool,
}

impl HistoryRow<'_> {
    fn contact_radius(&self) -> Option<f64> {
        self.curve.contact_radius_at(self.state.contact_indentation)
    }

    fn floor_force(&self) -> Option<f64> {
        self.has_floor.then_some(self.state.floor_force)
    }

    fn floor_share(&self) -> Option<f64> {
        let on_floor = self.floor_force()?;
        Some(if self.state.force > 0.0 {
            on_floor / self.state.force
        } else {
            0.0
        })
    }
}

impl<'a> Recorded for HistoryRow<'a> {
    const KIND: Kind = Kind::HistoryState;

    fn rows() -> Vec<Named<Self>> {
        vec![
            Named::number(
                "time_s",
                "time since the beginning of the protocol",
                |it: &HistoryRow<'a>| it.state.time,
            )
            .symbol("t"),
            Named::number("indentation_m", "indentation", |it: &HistoryRow<'a>| {
                it.state.indentation
            })
            .symbol("ζ"),
            Named::number(
                "force_N",
                "normal force on the lens",
                |it: &HistoryRow<'a>| it.state.force,
            )
            .symbol("F"),
            Named::number_if_any(
                "contact_radius_m",
                "contact radius; `null` under a plate",
                |it: &HistoryRow<'a>| it.contact_radius(),
            )
            .symbol("a"),
            Named::number(
                "contact_indentation_m",
                "indentation of the elastic contact that covers the same area",
                |it: &HistoryRow<'a>| it.state.contact_indentation,
            ),
            Named::count_if_any(
                "pillars_in_contact",
                "number of pillars in contact, between computed contacts that of the smaller one; `null` on other surfaces",
                |it: &HistoryRow<'a>| it.curve.pillars_at(it.state.contact_indentation),
            ),
            Named::number_if_any(
                "floor_force_N",
                "force on the floor; `null` where it is not known what the floor is",
                |it: &HistoryRow<'a>| it.floor_force(),
            ),
            Named::number_if_any(
                "floor_share",
                "floor force over total force",
                |it: &HistoryRow<'a>| it.floor_share(),
            ),
            Named::word(
                "by",
                "`superposition` of elastic contacts while the contact grows, or `steps` in time",
                |it: &HistoryRow<'a>| Some(it.state.by.name()),
            ),
        ]
    }
}

impl Recorded for HistoryEvent {
    const KIND: Kind = Kind::HistoryEvent;

    fn rows() -> Vec<Named<Self>> {
        vec![
            Named::number("time_s", "time of the event", |it: &Self| it.time).symbol("t"),
            Named::number(
                "time_error_s",
                "estimated error of the time, without that of the elastic contacts",
                |it: &Self| it.time_error,
            ),
            Named::word(
                "event",
                "`first contact`, `contact again`, `floor contact`, `largest contact`, `smallest contact`, `floor lost` or `detachment`",
                |it: &Self| Some(it.kind.name()),
            ),
            Named::number("force_N", "normal force on the lens", |it: &Self| it.force).symbol("F"),
            Named::number("indentation_m", "indentation", |it: &Self| it.indentation).symbol("ζ"),
        ]
    }
}

impl<P: Loadable> Followed<P> {
    /// The states as records.
    #[must_use]
    pub fn rows(&self) -> Vec<Record> {
        let row = |state: &HistoryState| {
            Record::of(&HistoryRow {
                state: *state,
                curve: &self.curve,
                has_floor: self.has_floor(),
            })
        };
        self.history.states.iter().map(row).collect()
    }
}

/// The numbers of a history, of any kind of surface.
#[derive(Debug, Clone, Copy)]
pub struct HistoryAnswer<'a> {
    /// Time to floor contact, s.
    time_to_floor_contact: Option<f64>,
    /// Time from which the state is near equilibrium, s.
    time_to_equilibrium: Option<f64>,
    critical: Option<[f64; 2]>,
    end: HistoryRow<'a>,
    equilibrium: HistoryRow<'a>,
    largest_force: f64,
    modulus_ratio: f64,
    errors: [f64; 2],
    converged: bool,
}

impl<'a> HistoryAnswer<'a> {
    /// The numbers of a history; `None` if it has no states.
    #[must_use]
    pub fn of<P: Loadable>(found: &'a Followed<P>) -> Option<Self> {
        let history = &found.history;
        let row = |state: HistoryState| HistoryRow {
            state,
            curve: &found.curve,
            has_floor: found.has_floor(),
        };
        let critical = found.critical.as_ref();
        let of_curve = found.curve.error();
        Some(Self {
            time_to_floor_contact: history.time_to_floor_contact,
            time_to_equilibrium: history.time_to_equilibrium,
            critical: critical.map(|it| [it.contact.indentation(), it.contact.force()]),
            end: row(*history.states.last()?),
            equilibrium: row(history.equilibrium),
            largest_force: history.states.iter().map(|it| it.force).fold(0.0, f64::max),
            modulus_ratio: found.modulus_ratio,
            errors: [
                history.force_error + of_curve,
                history.indentation_error + of_curve,
            ],
            converged: found.converged,
        })
    }

    /// Estimated errors of force and indentation, relative to the largest.
    #[must_use]
    pub fn errors(&self) -> [f64; 2] {
        self.errors
    }

    /// The last state.
    #[must_use]
    pub fn end(&self) -> HistoryRow<'a> {
        self.end
    }

    /// The relaxed state under the last load.
    #[must_use]
    pub fn equilibrium(&self) -> HistoryRow<'a> {
        self.equilibrium
    }
}

impl<'a> Recorded for HistoryAnswer<'a> {
    const KIND: Kind = Kind::History;

    fn rows() -> Vec<Named<Self>> {
        type Answer<'a> = HistoryAnswer<'a>;
        let mut rows = vec![
            Named::number_if_any(
                "time_to_floor_contact_s",
                "time at which the lens reaches the floor, in the protocol or later if its last load is held; `null` if it never does, or without a floor",
                |it: &Answer<'a>| it.time_to_floor_contact,
            ),
            Named::number_if_any(
                "time_to_equilibrium_s",
                "time from which force and indentation stay within 1 % of equilibrium, in the protocol or later if its last load is held; `null` if that is later and the contact has receded",
                |it: &Answer<'a>| it.time_to_equilibrium,
            ),
            Named::number_if_any(
                "critical_force_N",
                "critical force of slow loading, at the relaxed modulus; `null` without a floor",
                |it: &Answer<'a>| Some(it.critical?[1]),
            )
            .symbol("F_c"),
            Named::number_if_any(
                "critical_indentation_m",
                "critical indentation, the same at every rate; `null` without a floor",
                |it: &Answer<'a>| Some(it.critical?[0]),
            )
            .symbol("ζ_c"),
            Named::number(
                "instantaneous_modulus_ratio",
                "instantaneous modulus over relaxed modulus",
                |it: &Answer<'a>| it.modulus_ratio,
            ),
            Named::number(
                "largest_force_N",
                "largest force of the history",
                |it: &Answer<'a>| it.largest_force,
            ),
        ];
        rows.extend([
            Named::number("end.time_s", "time at the end", |it: &Answer<'a>| {
                it.end.state.time
            }),
            Named::number(
                "end.indentation_m",
                "indentation at the end",
                |it: &Answer<'a>| it.end.state.indentation,
            ),
            Named::number("end.force_N", "force at the end", |it: &Answer<'a>| {
                it.end.state.force
            }),
            Named::number_if_any(
                "end.contact_radius_m",
                "contact radius at the end; `null` under a plate",
                |it: &Answer<'a>| it.end.contact_radius(),
            ),
            Named::number_if_any(
                "end.floor_share",
                "floor force over total force at the end; `null` without a floor",
                |it: &Answer<'a>| it.end.floor_share(),
            ),
        ]);
        rows.extend([
            Named::number(
                "equilibrium.indentation_m",
                "indentation in equilibrium, if the last load is held",
                |it: &Answer<'a>| it.equilibrium.state.indentation,
            ),
            Named::number(
                "equilibrium.force_N",
                "force in equilibrium",
                |it: &Answer<'a>| it.equilibrium.state.force,
            ),
            Named::number_if_any(
                "equilibrium.contact_radius_m",
                "contact radius in equilibrium; `null` under a plate",
                |it: &Answer<'a>| it.equilibrium.contact_radius(),
            ),
            Named::number_if_any(
                "equilibrium.floor_share",
                "floor force over total force in equilibrium; `null` without a floor",
                |it: &Answer<'a>| it.equilibrium.floor_share(),
            ),
        ]);
        rows.extend([
            Named::number(
                "relative_error_estimate.force",
                "estimated error of the forces, relative to the largest",
                |it: &Answer<'a>| it.errors[0],
            ),
            Named::number(
                "relative_error_estimate.indentation",
                "estimated error of the indentations, relative to the largest",
                |it: &Answer<'a>| it.errors[1],
            ),
            Named::flag(
                "converged",
                "whether all elastic contacts converged",
                |it: &Answer<'a>| it.converged,
            ),
        ]);
        rows
    }
}
