//! By which method a question is answered.

/// How a question is answered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Method {
    /// Spectral expansion of the pressure on every pillar top; the exact method.
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

/// How finely the spectral method resolves the pressure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Accuracy {
    /// About 1e-6 in force where all touched pillars are fully covered, 1e-5 where the
    /// contact edge crosses a few of many pillar tops, 1e-4 where it crosses most of them.
    #[default]
    Default,
    /// About 1e-8, 1e-6 and 1e-5, at ten times the cost. A floor that sticks has cells of 0.6 times the size.
    Accurate,
}

/// The two forms of the punch lattice.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PunchForm {
    /// As in the paper's approximations: pillars act on each other as flat punches seen
    /// from their centre, and meet the lens at their centre.
    Plain,
    /// Both averaged over the receiving pillar top: the lowest degree of the spectral method.
    #[default]
    Corrected,
}

/// How pillar tops are divided into squares.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ElementMesh {
    /// Cells along a pillar's diameter, at least 8; about as many on a grid over the pattern.
    pub cells_per_diameter: usize,
    /// Where the grids lie.
    pub layout: MeshLayout,
    /// Whether cells are matched to the compliance of a flat punch.
    pub matched: bool,
}

/// Where the grids of elements lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum MeshLayout {
    /// A grid centred on each pillar.
    #[default]
    Pillars,
    /// One grid over the whole pattern, as in the paper.
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
