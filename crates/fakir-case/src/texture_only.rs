//! What has a meaning for a texture only: why, and what to ask of a general surface in its place.

use crate::error::CaseError;
use crate::file::CaseFile;

/// A question that has no meaning for a case with a general surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TextureOnly {
    /// The critical state by every method, side by side.
    Compare,
    /// The closed forms.
    Theory,
    /// The value of a key that gives a wanted critical state, and the spread of samples.
    Design,
    /// Least squares on a measured loading curve.
    Fit,
    /// The page with sliders.
    Explore,
    /// Loading and unloading with adhesion.
    Cycle,
    /// The range of the attraction.
    Adhesion,
    /// Exact derivatives of a contact.
    Gradient,
}

impl TextureOnly {
    /// Why a general surface has no answer.
    fn reason(self) -> &'static str {
        match self {
            Self::Compare => {
                "compare sets several methods side by side, and a [surface] has only one: elements"
            }
            Self::Theory => {
                "the closed forms are those of a [texture], round pillars on a hexagonal lattice; a \
                 [surface] has none"
            }
            Self::Design => {
                "design follows a critical state that changes smoothly with the free key; on a \
                 [surface] it changes by whole cells, and takes seconds each time"
            }
            Self::Fit => {
                "a fit needs derivatives of the contact; on a [surface] it changes by whole cells, and \
                 takes seconds each time"
            }
            Self::Explore => {
                "the sliders of the page need an answer in milliseconds, and a [surface] takes seconds"
            }
            Self::Gradient => {
                "derivatives are those of a contact of the method spectral; on a [surface] it changes \
                 by whole cells"
            }
            Self::Cycle | Self::Adhesion => {
                "adhesion is that of the round tops of a [texture]; a [surface] has none"
            }
        }
    }

    /// What to use in its place.
    fn instead(self) -> &'static str {
        match self {
            Self::Compare => {
                "use fakir verify, which solves pillars on a lattice on two meshes, or press and \
                 transition, which estimate their error"
            }
            Self::Theory => "use fakir transition and fakir approach, which solve it by elements",
            Self::Design => {
                "use fakir sweep with the free key as an axis, and read the value from its table"
            }
            Self::Fit => {
                "use fakir approach for a loading curve to lay over the measured one, or fakir sweep \
                 with the modulus and the indentation as axes"
            }
            Self::Explore => "use fakir press or fakir approach with --output, which save figures",
            Self::Cycle => {
                "ask for the loading alone: without adhesion the lens is withdrawn the way it came"
            }
            Self::Gradient => {
                "use fakir sweep with a key as an axis, and take differences over several cells"
            }
            Self::Adhesion => "leave the range of the attraction out",
        }
    }
}

impl CaseFile {
    /// Refuses a general surface where it has no meaning.
    ///
    /// # Errors
    /// [`CaseError`] that says why, and what to use in its place.
    pub fn refuse_surface_for(&self, question: TextureOnly) -> Result<(), CaseError> {
        self.refuse_surface(question.reason(), question.instead())
    }
}
