//! The critical states of the paper: three substrates, six positions of the lens axis, and surface
//! fractions from one pillar in contact to many.

use fakir::problem::System;
use fakir_case::{Case, CaseError, CaseFile, Key, Study, StudyFile};
use fakir_study::record::Record;
use fakir_study::{Row, RowAnswer};

/// A substrate of the paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Substrate {
    /// The rigid substrate, of 1000 MPa.
    Rigid,
    /// The intermediate substrate, of 2 MPa as the lens.
    Intermediate,
    /// The soft substrate, of 0.002 MPa.
    Soft,
}

impl Substrate {
    /// All three, in the order of the tables.
    pub const ALL: [Self; 3] = [Self::Rigid, Self::Intermediate, Self::Soft];

    /// Young's modulus, Pa.
    #[must_use]
    pub fn young_modulus(self) -> f64 {
        match self {
            Self::Rigid => 1e9,
            Self::Intermediate => 2e6,
            Self::Soft => 2e3,
        }
    }

    /// Name in the paper.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Rigid => "rigid",
            Self::Intermediate => "intermediate",
            Self::Soft => "soft",
        }
    }
}

/// Distances of the lens axis from a pillar centre, in pitches along x, with their names.
pub const OFFSETS: [(f64, &str); 6] = [
    (0.0, "0"),
    (1.0 / 6.0, "1/6"),
    (1.0 / 3.0, "1/3"),
    (0.5, "1/2"),
    (2.0 / 3.0, "2/3"),
    (0.866_025_403_784_438_6, "√3/2"),
];

/// Surface fractions of the sweep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fractions {
    /// The smallest.
    pub from: f64,
    /// The largest.
    pub to: f64,
    /// The number of surface fractions, equally spaced on a logarithmic scale.
    pub points: usize,
}

impl Fractions {
    /// Range in which the paper's experiments reached the transition.
    pub const OBSERVED: Self = Self {
        from: 3e-4,
        to: 0.21,
        points: 60,
    };
    /// Range beyond it, up to the densest pattern of the paper.
    pub const DENSE: Self = Self {
        from: 0.23,
        to: 0.29,
        points: 4,
    };
}

/// A system of the paper.
///
/// # Errors
/// [`CaseError`] for an invalid surface fraction.
pub fn system(
    substrate: Substrate,
    offset: f64,
    surface_fraction: f64,
) -> Result<System, CaseError> {
    let mut file = CaseFile::parse("the paper", &Case::example().to_toml())?;
    file.set_number(Key::SubstrateYoungModulus, substrate.young_modulus());
    file.set_number(Key::Offset, offset);
    file.set_number(Key::SurfaceFraction, surface_fraction);
    Ok(file.case()?.system)
}

/// The sweep over substrates, offsets and surface fractions, as a study.
///
/// # Errors
/// [`CaseError`] for invalid surface fractions.
pub fn study(fractions: Fractions) -> Result<Study, CaseError> {
    let moduli = Substrate::ALL.map(|substrate| format!("{:e}", substrate.young_modulus()));
    let offsets = OFFSETS.map(|(offset, _)| offset.to_string());
    let Fractions { from, to, points } = fractions;
    let text = format!(
        "{}\n[axes]\n\"substrate.young_modulus\" = [{}]\n\"pattern.offset\" = [{}]\n\
         \"pattern.surface_fraction\" = {{ from = {from:e}, to = {to:e}, points = {points}, \
         spacing = \"log\" }}\n",
        Case::example().to_toml(),
        moduli.join(", "),
        offsets.join(", "),
    );
    StudyFile::parse("the paper", &text)?.study()
}

/// The rows of [`study`], by substrate and offset.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    curves: Vec<Curve>,
}

/// Values of a critical state that figures and claims use, by the names of results.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Critical {
    /// Fraction of the surface that is pillar top.
    pub surface_fraction: f64,
    /// Distance of neighbouring pillars, m.
    pub pitch: f64,
    /// Critical force, N.
    pub force: f64,
    /// Critical indentation, m.
    pub indentation: f64,
    /// Critical contact radius, m.
    pub contact_radius: f64,
    /// Radius of the contact on the pillar tops, m.
    pub top_contact_radius: f64,
    /// Distance of the first floor contact from the lens axis, m.
    pub floor_contact: [f64; 2],
    /// Number of pillars in contact.
    pub pillars_in_contact: usize,
    /// Number of pillars crossed by the edge of the contact.
    pub pillars_partially_in_contact: usize,
    /// Estimated relative error of the force.
    pub relative_error_estimate_force: f64,
    /// `F gamma_int/(h d)`.
    pub normalized_force: f64,
    /// `a/e`.
    pub normalized_contact_radius: f64,
    /// `zeta/h`.
    pub normalized_indentation: f64,
}

impl From<&Record> for Critical {
    fn from(record: &Record) -> Self {
        let number = |path: &str| record.number(path).unwrap_or(f64::NAN);
        let count = |path: &str| record.count(path).unwrap_or(0);
        Self {
            surface_fraction: number("surface_fraction"),
            pitch: number("pitch_m"),
            force: number("critical_force_N"),
            indentation: number("critical_indentation_m"),
            contact_radius: number("critical_contact_radius_m"),
            top_contact_radius: number("top_contact_radius_m"),
            floor_contact: record.point("floor_contact_m").unwrap_or([f64::NAN; 2]),
            pillars_in_contact: count("pillars_in_contact"),
            pillars_partially_in_contact: count("pillars_partially_in_contact"),
            relative_error_estimate_force: number("relative_error_estimate.force"),
            normalized_force: number("normalized.force"),
            normalized_contact_radius: number("normalized.contact_radius"),
            normalized_indentation: number("normalized.indentation"),
        }
    }
}

/// Critical states along the surface fraction.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// The substrate.
    pub substrate: Substrate,
    /// The index of its offset in [`OFFSETS`].
    pub offset: usize,
    /// States by increasing surface fraction; cases without a result are left out.
    pub states: Vec<Critical>,
}

impl Grid {
    /// Sorts the rows of one or more studies: curves continue from one study to the next.
    #[must_use]
    pub fn new(studies: &[(&Study, &[Row])]) -> Self {
        let mut curves: Vec<Curve> = Substrate::ALL
            .into_iter()
            .flat_map(|substrate| {
                (0..OFFSETS.len()).map(move |offset| Curve {
                    substrate,
                    offset,
                    states: Vec::new(),
                })
            })
            .collect();
        for (study, rows) in studies {
            let count = study.cases() / curves.len();
            for row in *rows {
                if let Some(RowAnswer::Numbers(record)) = &row.answer
                    && row.problem.is_none()
                {
                    curves[row.index / count].states.push(record.into());
                }
            }
        }
        Self { curves }
    }

    /// All curves, substrate by substrate.
    #[must_use]
    pub fn curves(&self) -> &[Curve] {
        &self.curves
    }

    /// The curves of a substrate, in the order of [`OFFSETS`].
    pub fn of(&self, substrate: Substrate) -> impl Iterator<Item = &Curve> {
        self.curves
            .iter()
            .filter(move |curve| curve.substrate == substrate)
    }

    /// The curve of a substrate with the lens axis on a pillar.
    #[must_use]
    pub fn on_pillar(&self, substrate: Substrate) -> &Curve {
        let place = Substrate::ALL.iter().position(|other| *other == substrate);
        &self.curves[place.unwrap_or(0) * OFFSETS.len()]
    }
}
