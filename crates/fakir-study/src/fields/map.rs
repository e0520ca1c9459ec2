//! Fields of a contact on a regular grid.

use fakir::problem::{Indenter, Point, SurfaceSystem};
use fakir::state::{ContactState, FieldSamples, Run, SolveError, SurfaceContact};

/// Most points across: three fields of so many squared take 100 MB.
pub const MOST_POINTS: usize = 2048;

/// Memory that a point of a map takes besides what it is sampled with, bytes: its fields and both
/// files take more than sampling does, but after it. Measured are 118 bytes a point in all.
const BYTES_PER_POINT: usize = 48;

/// Points across a pillar, unless that makes more than [`USUAL_POINTS`].
const POINTS_PER_DIAMETER: f64 = 12.0;

/// Most points across if no number is asked for; odd, so that the lens axis is one of them.
const USUAL_POINTS: usize = 511;

/// Pitches shown on each side where nothing is touched.
const BARE_PITCHES: f64 = 2.0;

/// Half width of a map over the radius of the lens, at most: there is lens above its corners.
const LARGEST_WIDTH: f64 = 0.7;

/// Equally spaced coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axis {
    /// The first coordinate, m.
    pub start: f64,
    /// The distance from one coordinate to the next, m.
    pub spacing: f64,
    /// How many coordinates there are.
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

/// A field and what it is.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Variable {
    /// Its name; files without units have that of the unit behind it.
    pub(super) name: &'static str,
    /// Its name in words.
    pub(super) long_name: &'static str,
    /// What to know about its values.
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
    /// Whether x and y are counted from the lens axis: a plate has none.
    pub(super) around_axis: bool,
    pub(super) variables: Vec<Variable>,
}

impl FieldMap {
    /// The fields of a contact with a texture, on a square around the lens axis that holds the
    /// contact and a pitch more, or two pitches each way where nothing is touched. `points` across;
    /// 12 across a pillar if not given, but no more than 511.
    ///
    /// `None` for methods that have no fields.
    ///
    /// # Errors
    /// [`SolveError::Interrupted`] if `run` is cancelled, and [`SolveError::TooManyPoints`] for more
    /// than there is memory for.
    ///
    /// # Panics
    /// If fewer than two points are asked for.
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
        let variables = vec![
            Variable {
                name: "pressure",
                long_name: "contact pressure",
                comment: "The mean over the cell around each point, half a spacing each way: at the \
                          rim of a covered pillar the pressure itself is infinite. The sum over points \
                          times the area of a cell is the force."
                    .to_owned(),
                values: Values::Numbers("Pa", samples.pressure),
            },
            Variable {
                name: "gap",
                long_name: "gap between the lens and the surface below it",
                comment: "To the pillar top where there is one, to the floor elsewhere.".to_owned(),
                values: Values::Numbers("m", samples.gap),
            },
            Variable {
                name: "displacement",
                long_name: "by how much the pressure has moved the two surfaces apart",
                comment: "Sum over both bodies, without the shortening of the pillars.".to_owned(),
                values: Values::Numbers("m", samples.displacement),
            },
            on_pillar_variable(on_pillar),
        ];
        Ok(Some(Self {
            x: axis,
            y: axis,
            force: state.force,
            indentation: state.indentation,
            around_axis: true,
            variables,
        }))
    }

    /// Whether a map of so many points along its sides, and its files, fit the memory allowed.
    ///
    /// # Errors
    /// [`SolveError::TooManyPoints`]
    pub fn check_memory(sides: [usize; 2], run: &Run<'_>) -> Result<(), SolveError> {
        let points = sides[0].saturating_mul(sides[1]);
        FieldSamples::check_memory(points, BYTES_PER_POINT, run)
    }

    /// The fields of a contact with a general surface, at the centres of its cells; on pillars is
    /// what is not [floor](SurfaceSystem::floor). `None` if that is more than [`MOST_POINTS`] squared.
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
        let numbers = |name, unit, long_name, comment: &str, values: &[f64]| Variable {
            name,
            long_name,
            comment: comment.to_owned(),
            values: Values::Numbers(unit, values.to_owned()),
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
