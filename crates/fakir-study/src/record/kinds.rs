//! The rows of all kinds of answers.

use super::asperities::{AsperityAnswer, AsperityCritical};
use super::flat::FlatAnswer;
use super::history::{HistoryAnswer, HistoryRow};
use super::loading::LoadingState;
use super::named::{Entry, Kind, Recorded};
use super::surface::SurfaceAnswer;
use fakir_case::study::Asked;
use fakir_case::{Study, SurfaceKind};
use std::sync::LazyLock;

impl Kind {
    /// The kind of numbers of a study; none for a collapse.
    pub(crate) fn of(study: &Study) -> Option<Self> {
        use SurfaceKind::{Asperities, Flat, HeightMap, Pillars};
        match (study.asked(), study.surface_kind()) {
            (Asked::Transition, Pillars | Flat) => Some(Self::Transition),
            (Asked::Transition, Asperities) => Some(Self::AsperityTransition),
            (Asked::Transition, HeightMap) => Some(Self::SurfaceTransition),
            (Asked::Press, Asperities) => Some(Self::AsperityPress),
            (Asked::Press, Pillars) => Some(Self::Press),
            (Asked::Press, HeightMap) => Some(Self::SurfacePress),
            (Asked::Press, Flat) => Some(Self::FlatPress),
            (Asked::Cycle, Flat) => Some(Self::FlatCycle),
            (Asked::Cycle, Asperities) => Some(Self::AsperityCycle),
            (Asked::Cycle, HeightMap) => Some(Self::SurfaceCycle),
            (Asked::Cycle, Pillars) => Some(Self::Cycle),
            (Asked::Hold, _) => Some(Self::History),
            (Asked::Collapse, _) => None,
        }
    }

    /// Whether it is a part of another answer, of which there are many.
    #[must_use]
    pub fn is_a_row(self) -> bool {
        matches!(
            self,
            Self::Loading
                | Self::SurfaceLoading
                | Self::AsperityLoading
                | Self::FlatLoading
                | Self::HistoryState
                | Self::HistoryEvent
        )
    }

    /// Its numbers, in the order of the JSON object.
    #[must_use]
    pub fn entries(self) -> &'static [Entry] {
        fn of<T: Recorded>() -> Vec<Entry> {
            T::rows().iter().map(|row| row.entry).collect()
        }
        static ALL: LazyLock<[Vec<Entry>; Kind::ALL.len()]> = LazyLock::new(|| {
            Kind::ALL.map(|kind| match kind {
                Kind::Press => of::<fakir::state::ContactState>(),
                Kind::Transition => of::<fakir::state::CriticalState>(),
                Kind::SurfacePress => of::<SurfaceAnswer<'_, fakir::state::SurfaceContact>>(),
                Kind::SurfaceTransition => {
                    of::<SurfaceAnswer<'_, fakir::state::SurfaceTransition>>()
                }
                Kind::SurfaceCycle => of::<SurfaceAnswer<'_, fakir::state::SurfaceCycle>>(),
                Kind::AsperityPress => of::<AsperityAnswer<'_>>(),
                Kind::AsperityTransition => of::<AsperityCritical<'_>>(),
                Kind::AsperityCycle => of::<fakir::state::AsperityCycle>(),
                Kind::Cycle => of::<fakir::state::Cycle>(),
                Kind::Loading => of::<LoadingState<&fakir::state::ContactState>>(),
                Kind::SurfaceLoading => {
                    of::<LoadingState<SurfaceAnswer<'_, fakir::state::SurfaceContact>>>()
                }
                Kind::AsperityLoading => of::<LoadingState<AsperityAnswer<'_>>>(),
                Kind::FlatPress => of::<FlatAnswer<'_>>(),
                Kind::FlatCycle => of::<fakir::state::FlatCycle>(),
                Kind::FlatLoading => of::<LoadingState<FlatAnswer<'_>>>(),
                Kind::History => of::<HistoryAnswer<'_>>(),
                Kind::HistoryState => of::<HistoryRow<'_>>(),
                Kind::HistoryEvent => of::<fakir::state::HistoryEvent>(),
            })
        });
        &ALL[self as usize]
    }
}
