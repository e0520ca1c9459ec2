//! The tables of all kinds of answers.

use super::asperities::AsperityAnswer;
use super::flat::FlatAnswer;
use super::loading::LoadingState;
use super::named::{Entry, Kind, Recorded};
use super::surface::SurfaceAnswer;
use std::sync::LazyLock;

impl Kind {
    /// All of them.
    pub const ALL: [Self; 12] = [
        Self::Press,
        Self::Transition,
        Self::SurfacePress,
        Self::SurfaceTransition,
        Self::AsperityPress,
        Self::Cycle,
        Self::Loading,
        Self::SurfaceLoading,
        Self::AsperityLoading,
        Self::FlatPress,
        Self::FlatCycle,
        Self::FlatLoading,
    ];

    /// Its name in journals and in the schema.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Press => "press",
            Self::Transition => "transition",
            Self::SurfacePress => "surface_press",
            Self::SurfaceTransition => "surface_transition",
            Self::AsperityPress => "asperity_press",
            Self::Cycle => "cycle",
            Self::Loading => "loading",
            Self::SurfaceLoading => "surface_loading",
            Self::AsperityLoading => "asperity_loading",
            Self::FlatPress => "flat_press",
            Self::FlatCycle => "flat_cycle",
            Self::FlatLoading => "flat_loading",
        }
    }

    /// What the reference calls it.
    pub(super) fn heading(self) -> &'static str {
        match self {
            Self::Press => "A contact",
            Self::Transition => "A critical state",
            Self::SurfacePress => "A contact with a height map",
            Self::SurfaceTransition => "A critical state with a height map",
            Self::AsperityPress => "A contact with rounded tops",
            Self::Cycle => "A cycle",
            Self::Loading => "A state of a loading",
            Self::SurfaceLoading => "A state of a loading of a height map",
            Self::AsperityLoading => "A state of a loading of rounded tops",
            Self::FlatPress => "A contact with a flat surface",
            Self::FlatCycle => "A cycle with a flat surface",
            Self::FlatLoading => "A state of a loading of a flat surface",
        }
    }

    /// Whether it is a part of another answer, of which there are many.
    #[must_use]
    pub fn is_a_row(self) -> bool {
        matches!(
            self,
            Self::Loading | Self::SurfaceLoading | Self::AsperityLoading | Self::FlatLoading
        )
    }

    /// Its numbers, in the order of the JSON object.
    #[must_use]
    pub fn entries(self) -> &'static [Entry] {
        fn of<T: Recorded>() -> Vec<Entry> {
            T::rows().iter().map(|row| row.entry).collect()
        }
        static ALL: LazyLock<[Vec<Entry>; 12]> = LazyLock::new(|| {
            Kind::ALL.map(|kind| match kind {
                Kind::Press => of::<fakir::state::ContactState>(),
                Kind::Transition => of::<fakir::state::CriticalState>(),
                Kind::SurfacePress => of::<SurfaceAnswer<'_, fakir::state::SurfaceContact>>(),
                Kind::SurfaceTransition => {
                    of::<SurfaceAnswer<'_, fakir::state::SurfaceTransition>>()
                }
                Kind::AsperityPress => of::<AsperityAnswer<'_>>(),
                Kind::Cycle => of::<fakir::state::Cycle>(),
                Kind::Loading => of::<LoadingState<&fakir::state::ContactState>>(),
                Kind::SurfaceLoading => {
                    of::<LoadingState<SurfaceAnswer<'_, fakir::state::SurfaceContact>>>()
                }
                Kind::AsperityLoading => of::<LoadingState<AsperityAnswer<'_>>>(),
                Kind::FlatPress => of::<FlatAnswer<'_>>(),
                Kind::FlatCycle => of::<fakir::state::FlatCycle>(),
                Kind::FlatLoading => of::<LoadingState<&fakir::state::FlatContact>>(),
            })
        });
        &ALL[self as usize]
    }
}
