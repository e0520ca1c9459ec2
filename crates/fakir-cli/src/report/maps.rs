//! Maps of the fields of a contact, saved with `--output`.

use crate::failure::Failure;
use crate::session::Session;
use fakir::state::ContactState;
use fakir_study::fields::FieldMap;
use fakir_study::output::File;
use fakir_study::provenance::Provenance;

/// Requested maps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Maps {
    /// Nothing is saved.
    None,
    /// Maps with this number of points across, or a default that resolves the pillars.
    Points(Option<usize>),
}

impl Maps {
    /// A table that is saved with the maps; not created if nothing is saved, because long tables take time.
    pub(crate) fn table(self, make: impl FnOnce() -> Option<File>) -> Vec<File> {
        match self {
            Self::None => Vec::new(),
            Self::Points(_) => Vec::from_iter(make()),
        }
    }

    /// Checks that maps with the requested number of points fit in memory, before a long computation starts.
    pub(crate) fn check_memory(self, session: &Session) -> Result<(), Failure> {
        match self {
            Self::Points(Some(points)) => Ok(FieldMap::check_memory([points; 2], &session.run())?),
            _ => Ok(()),
        }
    }

    /// The files of a contact, with provenance; none for methods without fields.
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
