//! Columns of measured curves, and errors in their values.

use fakir::state::Branch;
use fakir_case::unit::Dimension;

/// A column of measured values, in SI units; the branch is 0 for loading and 1 for unloading.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)] // see `Column::name`
pub enum Column {
    Displacement,
    DisplacementError,
    Indentation,
    IndentationError,
    Force,
    ForceError,
    ContactRadius,
    ContactRadiusError,
    LateralForce,
    LateralForceError,
    Time,
    Branch,
}

impl Column {
    /// All columns.
    pub const ALL: [Self; 12] = [
        Self::Displacement,
        Self::DisplacementError,
        Self::Indentation,
        Self::IndentationError,
        Self::Force,
        Self::ForceError,
        Self::ContactRadius,
        Self::ContactRadiusError,
        Self::LateralForce,
        Self::LateralForceError,
        Self::Time,
        Self::Branch,
    ];

    /// Heading: `"displacement_m"`, `"force_error_N"`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Displacement => "displacement_m",
            Self::DisplacementError => "displacement_error_m",
            Self::Indentation => "indentation_m",
            Self::IndentationError => "indentation_error_m",
            Self::Force => "force_N",
            Self::ForceError => "force_error_N",
            Self::ContactRadius => "contact_radius_m",
            Self::ContactRadiusError => "contact_radius_error_m",
            Self::LateralForce => "lateral_force_N",
            Self::LateralForceError => "lateral_force_error_N",
            Self::Time => "time_s",
            Self::Branch => "branch",
        }
    }

    /// Name of the quantity without a unit: `"displacement"`, `"force_error"`.
    #[must_use]
    pub fn quantity(self) -> &'static str {
        match self {
            Self::Displacement => "displacement",
            Self::DisplacementError => "displacement_error",
            Self::Indentation => "indentation",
            Self::IndentationError => "indentation_error",
            Self::Force => "force",
            Self::ForceError => "force_error",
            Self::ContactRadius => "contact_radius",
            Self::ContactRadiusError => "contact_radius_error",
            Self::LateralForce => "lateral_force",
            Self::LateralForceError => "lateral_force_error",
            Self::Time => "time",
            Self::Branch => "branch",
        }
    }

    /// Dimension; `None` for times and branches.
    pub(super) fn dimension(self) -> Option<Dimension> {
        match self {
            Self::Force | Self::ForceError | Self::LateralForce | Self::LateralForceError => {
                Some(Dimension::Force)
            }
            Self::Time | Self::Branch => None,
            _ => Some(Dimension::Length),
        }
    }

    /// For a column of standard errors, the column to which they belong.
    pub(super) fn errors_of(self) -> Option<Self> {
        match self {
            Self::DisplacementError => Some(Self::Displacement),
            Self::IndentationError => Some(Self::Indentation),
            Self::ForceError => Some(Self::Force),
            Self::ContactRadiusError => Some(Self::ContactRadius),
            Self::LateralForceError => Some(Self::LateralForce),
            _ => None,
        }
    }

    pub(super) fn problem(self, value: f64) -> Option<&'static str> {
        match self {
            _ if !value.is_finite() => Some("must be a finite number"),
            Self::Branch if branch(value).is_none() => {
                Some("a branch is 0 for loading or 1 for unloading")
            }
            Self::DisplacementError | Self::IndentationError if value < 0.0 => {
                Some("a standard error cannot be negative")
            }
            Self::ForceError | Self::ContactRadiusError | Self::LateralForceError
                if value <= 0.0 =>
            {
                Some(
                    "a standard error must be greater than 0; leave the column out and the scatter \
                 is estimated",
                )
            }
            Self::ContactRadius if value < 0.0 => Some("a contact radius cannot be negative"),
            _ => None,
        }
    }
}

/// Branch that corresponds to a value of the column.
pub(super) fn branch(value: f64) -> Option<Branch> {
    let mut named = [(0.0, Branch::Loading), (1.0, Branch::Unloading)].into_iter();
    named.find_map(|(number, branch)| value.total_cmp(&number).is_eq().then_some(branch))
}

/// An error in measured values.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{name}{}: {}{problem}", .line.map_or(String::new(), |line| format!(":{line}")),
        .column.as_ref().map_or(String::new(), |column| format!("{column}: ")))]
pub struct DataError {
    /// The file.
    pub name: String,
    /// The line in it.
    pub line: Option<u64>,
    /// The column.
    pub column: Option<String>,
    /// Description of the error, and what is accepted.
    pub problem: String,
}
