//! Solution methods.

/// The solution method.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Method {
    /// Spectral expansion of the pressure on every pillar top; the method without model errors.
    Spectral(Accuracy),
    /// One flat punch per pillar.
    Punch(PunchForm),
    /// Elements of constant pressure; independent of the spectral method.
    Love(ElementMesh),
    /// The lattice replaced by a layer of springs on a half-space.
    Homogenised,
}

impl Default for Method {
    fn default() -> Self {
        Self::Spectral(Accuracy::Default)
    }
}

impl Method {
    /// The name used in case files and results.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Spectral(_) => "spectral",
            Self::Punch(_) => "punch",
            Self::Love(_) => "love",
            Self::Homogenised => "homogenised",
        }
    }
}

/// Resolution of the pressure in the spectral method.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Accuracy {
    /// About 1e-6 in force if all touched pillars are fully covered, 1e-5 if the contact edge crosses a few of many pillar tops, 1e-4 if it
    /// crosses most of them.
    #[default]
    Default,
    /// About 1e-8, 1e-6 and 1e-5 in these cases, at about twenty times the cost. Cells of an adhesive floor are 0.6 times as large.
    Accurate,
}

/// The two forms of the punch lattice.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PunchForm {
    /// As in the approximations of the paper: pillars interact as flat punches evaluated at the centre of the receiving pillar, and the
    /// lens shape is evaluated at the pillar centre.
    Plain,
    /// Both are averaged over the receiving pillar top: the lowest degree of the spectral method.
    #[default]
    Corrected,
}

/// Division of pillar tops into square elements.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ElementMesh {
    /// Number of cells along a pillar's diameter, at least 8; an approximate number for a single grid over the pattern.
    pub cells_per_diameter: usize,
    /// Position of the grids.
    pub layout: MeshLayout,
    /// Whether cells are matched to the compliance of a flat punch.
    pub matched: bool,
}

/// Position of the grids of elements.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum MeshLayout {
    /// A separate grid centred on each pillar.
    #[default]
    Pillars,
    /// A single grid over the whole pattern, as in the paper.
    Pattern,
}

impl Default for ElementMesh {
    /// Sixteen matched cells across each pillar.
    fn default() -> Self {
        Self {
            cells_per_diameter: 16,
            layout: MeshLayout::Pillars,
            matched: true,
        }
    }
}
