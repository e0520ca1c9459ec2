//! Maps of the fields of a contact, saved with `--output`.

use crate::failure::Failure;
use crate::session::Session;
use fakir::state::ContactState;
use fakir_study::fields::FieldMap;
use fakir_study::output::File;
use fakir_study::provenance::Provenance;

/// Which maps are wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Maps {
    /// Nothing is saved.
    None,
    /// Maps of so many points across, or as many as suit the pillars.
    Points(Option<usize>),
}

impl Maps {
    /// A table that is saved with the maps; none if nothing is saved, as long tables take their time.
    pub(crate) fn table(self, make: impl FnOnce() -> Option<File>) -> Vec<File> {
        match self {
            Self::None => Vec::new(),
            Self::Points(_) => Vec::from_iter(make()),
        }
    }

    /// Whether maps of so many points as were asked for fit the memory: better known before a long
    /// computation than after it.
    pub(crate) fn check_memory(self, session: &Session) -> Result<(), Failure> {
        match self {
            Self::Points(Some(points)) => Ok(FieldMap::check_memory([points; 2], &session.run())?),
            _ => Ok(()),
        }
    }

    /// The files of a contact, stamped; none for methods without fields.
    pub(crate) fn files(
        self,
        state: &ContactState,
        provenance: &Provenance,
        session: &Session,
    ) -> Result<Vec<File>, Failure> {
        let Self::Points(points) = self else {
            return Ok(Vec::new());
        };
        session.part("fields");
        let map = FieldMap::of_contact(state, points, &session.run())?;
        Ok(map.map_or(Vec::new(), |map| map.files(provenance).into()))
    }
}
