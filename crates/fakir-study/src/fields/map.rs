//! Fields of a contact on a regular grid.

use fakir::numerics::convergence::clamped;
use fakir::problem::{FlatSystem, Indenter, Point, SurfaceSystem};
use fakir::state::{
    AsperityContact, ContactState, FieldSamples, FlatContact, Run, SolveError, SurfaceContact,
};
use fakir_case::AsperityCase;

/// Largest number of points across: three fields of this number squared take 100 MB.
pub const MOST_POINTS: usize = 2048;

/// Memory per point of a map in addition to sampling, bytes: fields and both files take more than sampling does, but after it. The measured
/// total is 118 bytes per point.
const BYTES_PER_POINT: usize = 48;

/// Points across a pillar, unless that makes more than [`USUAL_POINTS`].
const POINTS_PER_DIAMETER: f64 = 12.0;

/// Largest default number of points across; odd, so that the lens axis is one of them.
const USUAL_POINTS: usize = 511;

/// Default number of points across a flat surface, and the half width of its map in contact radii.
const FLAT_POINTS: usize = 201;
const FLAT_RADII: f64 = 2.5;

/// Pitches shown on each side if nothing is touched.
const BARE_PITCHES: f64 = 2.0;

/// Largest ratio of the half width of a map to the lens radius: the lens extends beyond its corners.
const LARGEST_WIDTH: f64 = 0.7;

/// Equally spaced coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axis {
    /// The first coordinate, m.
    pub start: f64,
    /// Distance between coordinates, m.
    pub spacing: f64,
    /// Number of coordinates.
    pub count: usize,
}

impl Axis {
    /// From `-half_width` (m) to `half_width`.
    pub(super) fn symmetric(half_width: f64, count: usize) -> Self {
        let middle = (count - 1) as f64 / 2.0;
        let spacing = half_width / middle;
        Self {
            start: -middle * spacing,
            spacing,
            count,
        }
    }

    /// The coordinates, m.
    #[must_use]
    pub fn coordinates(&self) -> Vec<f64> {
        (0..self.count)
            .map(|k| self.start + k as f64 * self.spacing)
            .collect()
    }
}

/// A field with its description.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Variable {
    /// Its name; in files without units, the unit is appended.
    pub(super) name: &'static str,
    /// Its name in words.
    pub(super) long_name: &'static str,
    /// Note on its values.
    pub(super) comment: String,
    pub(super) values: Values,
}

/// Values at all points, x fastest.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Values {
    /// Numbers with a unit.
    Numbers(&'static str, Vec<f64>),
    /// 1 for yes, 0 for no.
    Flags(Vec<i8>),
}

/// Fields of a contact on a grid of points.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldMap {
    pub(super) x: Axis,
    pub(super) y: Axis,
    /// Force on the lens, N.
    pub(super) force: f64,
    /// Indentation, m.
    pub(super) indentation: f64,
    /// Whether x and y are relative to the lens axis; a plate has none.
    pub(super) around_axis: bool,
    pub(super) variables: Vec<Variable>,
}

impl FieldMap {
    /// The fields of a contact with a pillar pattern, on a square around the lens axis that contains the contact and one more pitch, or two
    /// pitches on each side if nothing is touched. `points` across; by default 12 across a pillar, but at most 511.
    ///
    /// `None` for methods without fields.
    ///
    /// # Errors
    /// [`SolveError::Interrupted`] if `run` is cancelled, and [`SolveError::TooManyPoints`] if the memory limit would be exceeded.
    ///
    /// # Panics
    /// If fewer than two points are requested.
    pub fn of_contact(
        state: &ContactState,
        points: Option<usize>,
        run: &Run<'_>,
    ) -> Result<Option<Self>, SolveError> {
        let Some(fields) = &state.fields else {
            return Ok(None);
        };
        let axis = axis_around(state, points);
        Self::check_memory([axis.count; 2], run)?;
        let coordinates = axis.coordinates();
        let samples = fields.on_grid(&coordinates, &coordinates, run)?;
        let positions = || positions(&coordinates, &coordinates);
        let on_pillar: Vec<i8> = positions()
            .map(|position| fields.is_on_pillar(position).into())
            .collect();
        let variables = sampled(
            samples,
            [
                "The mean over the cell around each point, half a spacing each way: at the rim of a covered pillar the pressure itself is infinite. The \
                 sum over points times the area of a cell is the force.",
                "To the pillar top where there is one, to the floor elsewhere.",
                WITHOUT_PILLARS,
            ],
            Some(on_pillar),
        );
        Ok(Some(Self {
            x: axis,
            y: axis,
            force: state.force,
            indentation: state.indentation,
            around_axis: true,
            variables,
        }))
    }

    /// The fields of a contact with rounded tops, on a square that contains all tops. `points` across; by default 12 across the largest contact,
    /// but at most as many as take about a second. `None` for a contact of another case.
    ///
    /// # Errors
    /// As [`of_contact`](Self::of_contact).
    ///
    /// # Panics
    /// If fewer than two points are requested.
    pub fn of_asperities(
        case: &AsperityCase,
        contact: &AsperityContact,
        points: Option<usize>,
        run: &Run<'_>,
    ) -> Result<Option<Self>, SolveError> {
        let Some(fields) = contact.fields(&case.field, case.height) else {
            return Ok(None);
        };
        let [x, y] = axes_around(case, contact, points);
        Self::check_memory([x.count, y.count], run)?;
        let (along_x, along_y) = (x.coordinates(), y.coordinates());
        let samples = fields.on_grid(&along_x, &along_y, run)?;
        let on_top = positions(&along_x, &along_y).map(|at| fields.is_on_top(at).into());
        let variables = sampled(
            samples,
            [
                MEAN_OF_SIXTEEN,
                "To the top where there is one, to the floor elsewhere, which is not touched.",
                WITHOUT_PILLARS,
            ],
            Some(on_top.collect()),
        );
        Ok(Some(Self {
            x,
            y,
            force: contact.force,
            indentation: contact.indentation,
            around_axis: case.field.indenter().lens().is_some(),
            variables,
        }))
    }

    /// The fields of a contact with a flat surface, on a square around the axis of 2.5 contact radii on each side. `points` across, by default
    /// 201.
    ///
    /// # Errors
    /// As [`of_contact`](Self::of_contact).
    ///
    /// # Panics
    /// If fewer than two points are requested.
    pub fn of_flat(
        system: &FlatSystem,
        contact: &FlatContact,
        points: Option<usize>,
        run: &Run<'_>,
    ) -> Result<Self, SolveError> {
        let lens = system.lens();
        let widest = match lens.punch_radius() {
            Some(_) => f64::INFINITY,
            None => LARGEST_WIDTH * lens.widest(),
        };
        let half_width = match contact.contact_radius > 0.0 {
            true => (FLAT_RADII * contact.contact_radius).min(widest),
            // Any width shows a lens that touches nothing; a paraboloid has no end.
            false => [0.1 * widest, contact.indentation.abs(), 1e-6]
                .into_iter()
                .find(|width| width.is_finite() && *width > 0.0)
                .unwrap_or(1e-6),
        };
        let axis = Axis::symmetric(half_width, points.unwrap_or(FLAT_POINTS));
        Self::check_memory([axis.count; 2], run)?;
        let coordinates = axis.coordinates();
        let fields = system.fields(contact, half_width * std::f64::consts::SQRT_2);
        // One quarter, as the contact is symmetric: with two points at least, whose distance is the side of a cell.
        let first = axis.count / 2 - 1;
        let quarter = &coordinates[first..];
        let side = quarter.len();
        let place = |k: usize| k.max(axis.count - 1 - k) - first;
        let whole = |values: Vec<f64>| {
            let row = |y: usize| (0..axis.count).map(move |x| [place(x), place(y)]);
            let places = (0..axis.count).flat_map(row);
            places.map(|[x, y]| values[y * side + x]).collect()
        };
        let samples = fields.on_grid(quarter, quarter, run)?;
        let variables = sampled(
            FieldSamples {
                displacement: whole(samples.displacement),
                gap: whole(samples.gap),
                pressure: whole(samples.pressure),
            },
            [
                MEAN_OF_SIXTEEN,
                "To the flat surface; not a number beyond the rim of a punch.",
                "Sum over both bodies.",
            ],
            None,
        );
        Ok(Self {
            x: axis,
            y: axis,
            force: contact.force,
            indentation: contact.indentation,
            around_axis: true,
            variables,
        })
    }

    /// Returns an error if a map with these numbers of points, and its files, exceed the memory limit.
    ///
    /// # Errors
    /// [`SolveError::TooManyPoints`]
    pub fn check_memory(sides: [usize; 2], run: &Run<'_>) -> Result<(), SolveError> {
        let points = sides[0].saturating_mul(sides[1]);
        FieldSamples::check_memory(points, BYTES_PER_POINT, run)
    }

    /// The fields of a contact with a general surface, at the centres of its cells; cells that are not [floor](SurfaceSystem::floor) count
    /// as pillar. `None` if there are more than [`MOST_POINTS`] squared.
    #[must_use]
    pub fn of_surface(system: &SurfaceSystem, contact: &SurfaceContact) -> Option<Self> {
        let grid = &contact.grid;
        if grid.cell_count() > MOST_POINTS * MOST_POINTS {
            return None;
        }
        let [x, y] = grid.centre(0, 0);
        let axis = |start, spacing, count| Axis {
            start,
            spacing,
            count,
        };
        let numbers = |name, unit, long_name, comment, values: &[f64]| {
            numbers(name, unit, long_name, comment, values.to_owned())
        };
        let surface = system.surface();
        let mut variables = vec![
            numbers(
                "pressure",
                "Pa",
                "contact pressure",
                "Constant on each cell.",
                &contact.pressure,
            ),
            numbers(
                "gap",
                "m",
                "gap between the two deformed surfaces",
                "At the centre of each cell.",
                &contact.gap,
            ),
            numbers(
                "displacement",
                "m",
                "by how much the pressure has moved the two surfaces apart",
                "Sum over both bodies, with the shortening of pillars.",
                &contact.displacement,
            ),
            numbers(
                "height",
                "m",
                "height of the undeformed surface",
                "Counted from any level.",
                surface.heights(),
            ),
        ];
        if let Some(floor) = system.floor() {
            let on_pillar = |cell| i8::from(!floor.contains(surface, cell));
            let flags = (0..grid.cell_count()).map(on_pillar).collect();
            variables.push(on_pillar_variable(flags));
        }
        Some(Self {
            x: axis(x, grid.cell()[0], grid.columns()),
            y: axis(y, grid.cell()[1], grid.rows()),
            force: contact.force,
            indentation: contact.indentation,
            around_axis: matches!(system.indenter(), Indenter::Lens(_)),
            variables,
        })
    }
}

fn numbers(
    name: &'static str,
    unit: &'static str,
    long_name: &'static str,
    comment: &str,
    values: Vec<f64>,
) -> Variable {
    Variable {
        name,
        long_name,
        comment: comment.to_owned(),
        values: Values::Numbers(unit, values),
    }
}

const MEAN_OF_SIXTEEN: &str = "The mean of 16 points in the cell around each point, half a spacing each way. The sum over points times the area of \
                               a cell is about the force.";
const WITHOUT_PILLARS: &str = "Sum over both bodies, without the shortening of the pillars.";

/// The fields of discs of contact, with notes on pressure, gap and displacement, and where pillars are, if there are any.
fn sampled(
    samples: FieldSamples,
    [on_pressure, on_gap, on_displacement]: [&str; 3],
    on_pillar: Option<Vec<i8>>,
) -> Vec<Variable> {
    let mut variables = vec![
        numbers(
            "pressure",
            "Pa",
            "contact pressure",
            on_pressure,
            samples.pressure,
        ),
        numbers(
            "gap",
            "m",
            "gap between the lens and the surface below it",
            on_gap,
            samples.gap,
        ),
        numbers(
            "displacement",
            "m",
            "by how much the pressure has moved the two surfaces apart",
            on_displacement,
            samples.displacement,
        ),
    ];
    variables.extend(on_pillar.map(on_pillar_variable));
    variables
}

/// Both axes of a map of rounded tops, with the same spacing.
fn axes_around(case: &AsperityCase, contact: &AsperityContact, points: Option<usize>) -> [Axis; 2] {
    /// Evaluations of a contact at a point in about a second.
    const IN_A_SECOND: f64 = 4e6;
    let states = || case.field.asperities().iter().zip(&contact.asperities);
    let widest = states().map(|(_, state)| state.radius).fold(0.0, f64::max);
    let own = states().map(|(asperity, _)| asperity.rim_radius.unwrap_or(0.0));
    let own = own.fold(widest, f64::max);
    let ends = |axis: usize| {
        let places = states().map(|(asperity, _)| asperity.apex[axis]);
        places.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
            [low.min(x), high.max(x)]
        })
    };
    let spans = [ends(0), ends(1)];
    let half_width = spans
        .iter()
        .map(|[low, high]| 0.5 * (high - low))
        .fold(0.0, f64::max);
    let around = own.max(0.1 * half_width);
    // A single top that is not touched.
    let around = if around > 0.0 {
        around
    } else {
        0.1 * case.height
    };
    let half_width = half_width + 1.5 * around;
    let usual = || {
        let touched = contact.touched().max(1) as f64;
        let affordable = (IN_A_SECOND / touched).sqrt();
        let fine = if widest > 0.0 {
            POINTS_PER_DIAMETER * half_width / widest
        } else {
            0.0
        };
        // Odd, so that the centre is one of them.
        let count = clamped(fine.min(affordable), 33.0, USUAL_POINTS as f64);
        2 * (0.5 * count) as usize + 1
    };
    let count = points.unwrap_or_else(usual);
    spans.map(|[low, high]| {
        let axis = Axis::symmetric(half_width, count);
        Axis {
            start: axis.start + 0.5 * (low + high),
            ..axis
        }
    })
}

fn on_pillar_variable(flags: Vec<i8>) -> Variable {
    Variable {
        name: "on_pillar",
        long_name: "whether there is a pillar top, rather than the floor",
        comment: "1 on a pillar top, 0 on the floor.".to_owned(),
        values: Values::Flags(flags),
    }
}

fn axis_around(state: &ContactState, points: Option<usize>) -> Axis {
    let pitch = state.system.pitch();
    let half_width = if state.whole_contact_radius() > 0.0 {
        state.whole_contact_radius() + pitch
    } else {
        BARE_PITCHES * pitch
    };
    let half_width = half_width.min(LARGEST_WIDTH * state.system.lens().widest());
    let count = points.unwrap_or_else(|| {
        let wanted = half_width / state.system.pillar().diameter * POINTS_PER_DIAMETER;
        (2 * wanted.ceil() as usize + 1).min(USUAL_POINTS)
    });
    Axis::symmetric(half_width, count)
}

/// Points of a grid, x fastest.
fn positions(x: &[f64], y: &[f64]) -> impl Iterator<Item = Point> {
    y.iter().flat_map(|&y| x.iter().map(move |&x| [x, y]))
}
