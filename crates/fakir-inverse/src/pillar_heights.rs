//! Heights of the pillars of a case for a target curve. The contact is solved again with the
//! designed pillars.

use crate::heights::{
    Curve, DesignedPoint, HeightDesign, HeightDesignError, WantedPoint, design_heights,
};
use fakir::problem::{Asperity, AsperityArray, Unsupported};
use fakir::state::{AsperityContact, Run, Solution, SolveError, Termination, Unresolved};
use fakir_case::AsperityCase;
use fakir_study::{Column, Table, Values};

/// Largest number of repetitions of the search (the compliance of a pillar depends on its height), and the relative change of compliance
/// below which it ends.
const COLUMN_ROUNDS: usize = 6;
const SAME_COMPLIANCE: f64 = 1e-7;

/// Relative height of the lowest pillar above the floor that the advised common height leaves.
const MARGIN: f64 = 1.05;

/// Designed pillars.
#[derive(Debug, Clone)]
pub struct PillarHeights {
    /// The case with their heights.
    pub case: AsperityCase,
    /// Kind of target curve.
    pub curve: Curve,
    /// Result. The values are those of the designed pillars.
    pub design: HeightDesign,
    /// Largest estimated relative error of the values over all loads; `None` without an estimate.
    pub relative_error: Option<f64>,
    /// The first load (N or m) under which a number of the contact is not resolved, with that number.
    pub unresolved: Option<(f64, Unresolved)>,
    /// The contact under the largest load.
    pub last: AsperityContact,
}

impl Solution for PillarHeights {
    fn termination(&self) -> Termination {
        self.last.termination
    }

    fn unresolved(&self) -> Option<Unresolved> {
        self.unresolved.map(|(_, unresolved)| unresolved)
    }
}

/// Errors of a design of pillars.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PillarHeightsError {
    /// No heights were found.
    #[error(transparent)]
    Heights(#[from] HeightDesignError),
    /// The contact with the designed heights could not be solved.
    #[error("the contact with the designed heights cannot be solved: {0}")]
    Solve(#[from] SolveError),
    /// The solution for the designed heights did not converge.
    #[error(
        "the contact with the designed heights did not converge under the load {load:e} (SI units): try another seed"
    )]
    NotConverged {
        /// The load, N or m.
        load: f64,
    },
    /// The top of a pillar would be below the floor.
    #[error(
        "the lowest pillar would end {:.4e} m below the floor: give pattern.pillar.height as {:.3e} m or more", -.lowest, .needed
    )]
    BelowFloor {
        /// Height of the lowest pillar, m; not above 0.
        lowest: f64,
        /// Common height for which it would be above the floor, m.
        needed: f64,
    },
}

/// Finds heights of the pillars of a case for a target curve, and solves the contact with these pillars, with error estimates. The compliance of columns
/// follows the heights. See [`design_heights`].
///
/// # Errors
/// See [`PillarHeightsError`].
pub fn design_pillars(
    case: &AsperityCase,
    curve: Curve,
    wanted: &[WantedPoint],
    seed: u64,
    run: &Run<'_>,
) -> Result<PillarHeights, PillarHeightsError> {
    if !case.field.adhesion().is_none() {
        let reason = Unsupported::HEIGHTS_OF_ADHESIVE_TOPS;
        return Err(SolveError::from(reason).into());
    }
    let mut field = case.field.clone();
    let mut round = 1;
    let (made, mut design) = loop {
        let design = design_heights(&field, curve, wanted, seed, run)?;
        let lowest = design.heights.iter().copied().fold(f64::INFINITY, f64::min);
        if case.height + lowest <= 0.0 {
            return Err(PillarHeightsError::BelowFloor {
                lowest: case.height + lowest,
                needed: -MARGIN * lowest,
            });
        }
        let made = case
            .with_heights(&design.heights)
            .map_err(HeightDesignError::from)?;
        if round == COLUMN_ROUNDS || have_same_columns(&field, &made.field) {
            break (made, design);
        }
        field = made.field;
        round += 1;
    };
    let mut errors = Vec::new();
    let (mut last, mut unresolved) = (None, None);
    for point in &mut design.points {
        let load = point.wanted.load;
        let contact = made.field.press(curve.control(load), made.accuracy, run);
        let contact = contact.map_err(|error| match error {
            SolveError::Interrupted => HeightDesignError::Interrupted.into(),
            other => PillarHeightsError::Solve(other),
        })?;
        if !contact.converged() {
            return Err(PillarHeightsError::NotConverged { load });
        }
        point.value = curve.value(&contact);
        point.touched = contact.touched();
        errors.push(contact.error.map(|error| match curve {
            Curve::AreaOfForce | Curve::AreaOfIndentation => error.area,
            Curve::ForceOfIndentation => error.force,
        }));
        unresolved = unresolved.or_else(|| Some((load, contact.unresolved()?)));
        last = Some(contact);
    }
    let errors: Option<Vec<f64>> = errors.into_iter().collect();
    Ok(PillarHeights {
        case: made,
        curve,
        design,
        relative_error: errors.map(|errors| errors.into_iter().fold(0.0, f64::max)),
        unresolved,
        last: last.ok_or(HeightDesignError::NoPoints)?,
    })
}

fn have_same_columns(one: &AsperityArray, other: &AsperityArray) -> bool {
    let pairs = one.asperities().iter().zip(other.asperities());
    pairs
        .into_iter()
        .all(|(one, other): (&Asperity, &Asperity)| {
            let [a, b] = [one, other].map(|asperity| asperity.column_compliance);
            (a - b).abs() <= SAME_COMPLIANCE * a.max(b)
        })
}

impl PillarHeights {
    /// Height of the lowest and the highest pillar above the floor, m.
    #[must_use]
    pub fn range(&self) -> [f64; 2] {
        let heights = self.case.heights();
        let lowest = heights.iter().copied().fold(f64::INFINITY, f64::min);
        let highest = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        [lowest, highest]
    }

    /// Result as a sentence.
    #[must_use]
    pub fn statement(&self) -> String {
        let pillars = self.case.field.asperities().len();
        format!(
            "{pillars} heights for the {}: {}",
            self.curve.words(),
            self.design.verdict()
        )
    }

    /// Table `curve.csv`: the target at every load, the value of the designed heights, and that of a design without interactions. If the
    /// standard deviation of the heights (m) is given, also the relative standard deviation of the values.
    #[must_use]
    pub fn table(&self, height_error: Option<f64>) -> Table {
        let points = &self.design.points;
        let unit = |name: &str| match name {
            "force" => "N",
            "indentation" => "m",
            _ => "m2",
        };
        let [load, value] = [self.curve.load_name(), self.curve.value_name()];
        let value_unit = unit(value);
        let numbers = |name: String, values: Vec<f64>| Column {
            name,
            values: Values::Numbers(values.into_iter().map(Some).collect()),
        };
        let of = |of: fn(&DesignedPoint) -> f64| points.iter().map(of).collect();
        let mut columns = vec![
            numbers(
                format!("{load}_{}", unit(load)),
                of(|point| point.wanted.load),
            ),
            numbers(
                format!("wanted_{value}_{value_unit}"),
                of(|point| point.wanted.value),
            ),
            numbers(format!("{value}_{value_unit}"), of(|point| point.value)),
            numbers("residual".to_owned(), of(DesignedPoint::residual)),
            numbers(
                format!("interactions_ignored_{value}_{value_unit}"),
                of(|point| point.of_independent_design),
            ),
            Column {
                name: "pillars_in_contact".to_owned(),
                values: Values::Counts(
                    points
                        .iter()
                        .map(|point| i64::try_from(point.touched).ok())
                        .collect(),
                ),
            },
        ];
        if let Some(error) = height_error {
            let scatter = points.iter().map(|point| point.scatter(error)).collect();
            columns.push(numbers("scatter".to_owned(), scatter));
        }
        Table { columns }
    }
}
