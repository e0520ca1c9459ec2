//! The contact of the lens with a height map that the user gives: first on large cells, which takes a fraction of a second, then on smaller ones.

use crate::clock::Moment;
use crate::refusal::Refusal;
use crate::request::{self, GivenFile, Ticket, Values};
use crate::shown::Section;
use crate::worker::{Failure, Worker};
use fakir::problem::{Grid, HeightMap, Load, Point, SurfaceSystem};
use fakir::state::SurfaceContact;
use fakir_case::unit::{Dimension, format_quantity};
use fakir_case::{CaseError, CaseFile, Key, Setting};
use fakir_figure::{SurfaceState, Text};
use fakir_study::record::{Object, Record, SurfaceAnswer};
use fakir_study::result::warnings;
use serde::{Deserialize, Serialize};

/// Largest number of cells of the first answer: about a third of a second in the browser.
const FIRST_CELLS: usize = 96 * 96;

/// Largest number of cells that the page computes: seconds.
const MOST_CELLS: usize = 512 * 512;

/// The same with adhesion, whose fronts move cell by cell.
const MOST_ADHESIVE_CELLS: usize = 192 * 192;

/// Largest number of cells of the drawn map along each side.
const DRAWN: usize = 192;

/// Number of shades, one for each letter.
const SHADES: f64 = 26.0;

/// Indentation of the first answer, relative to the range of the heights.
const FIRST_LOAD: f64 = 0.5;

/// `POST /api/surface`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Request {
    pub(crate) ticket: Ticket,
    /// Lens and substrate, and size and height unit of the map where the file does not state them; or pillars on a grid.
    case: Values,
    /// The map; without it the case describes pillars.
    #[serde(default)]
    map: Option<GivenFile>,
    /// Indentation, m; half the range of the heights if it is not given.
    #[serde(default)]
    indentation_m: Option<f64>,
}

/// Largest file with a height map, bytes.
const LARGEST: u64 = 8_000_000;

/// A case with a height map, or with pillars on a grid, that the page shows first.
#[derive(Debug, Serialize)]
pub(crate) struct First {
    map: Option<GivenFile>,
    /// All values but those of lens and substrate that have controls.
    case: Values,
}

impl First {
    /// The case of a file.
    ///
    /// # Errors
    /// [`CaseError`] for a case that is invalid, or that the page does not show.
    pub(crate) fn of(file: &CaseFile, memory_limit: usize) -> Result<Self, CaseError> {
        let map = file.height_map_contents(LARGEST)?;
        let case = Key::ALL
            .into_iter()
            .filter(|key| *key != Key::HeightMap && !request::is_of_bodies(*key))
            .filter_map(|key| Some((key.path().to_owned(), file.setting(key)?)))
            .collect();
        if file.setting(Key::LensProfile).is_some() {
            let why = "the page does not show the table of a lens beside a [surface]";
            return Err(file.refusal(Key::LensProfile, why, "use `fakir press`, or another lens"));
        }
        let read = match (&map, file.setting(Key::HeightMap)) {
            (Some((_, contents)), Some(Setting::Word(name))) => {
                file.clone().with_table(&name, contents)
            }
            _ => file.clone(),
        };
        read.surface_case(memory_limit)?;
        let map = map.map(|(name, contents)| GivenFile::new(name, &contents));
        Ok(Self { map, case })
    }
}

#[derive(Serialize)]
struct SurfaceLine {
    surface: Shown,
}

/// A contact for display.
#[derive(Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
struct Shown {
    /// Whether the same follows on smaller cells.
    approximate: bool,
    /// Cells of the file, and those of this answer, along x and y.
    file_cells: [usize; 2],
    cells: [usize; 2],
    /// Range of the heights, m.
    relief_m: f64,
    indentation_m: f64,
    /// As `fakir press --json` prints it.
    summary: Object,
    wall_time_s: f64,
    warnings: Vec<String>,
    /// Number of drawn cells along x and y, lower left corner relative to the lens axis, and their size.
    drawn: [usize; 2],
    corner_m: Point,
    cell_m: [f64; 2],
    /// Heights, a letter for each cell in rows from the smallest y on, from `a` (lowest) to `z`; and pressures, a blank without contact.
    heights: String,
    pressures: String,
    largest_pressure_Pa: f64,
    section: Section,
    /// The case file and the command for the whole map.
    toml: String,
    command: String,
}

/// `POST /api/surface`
pub(crate) fn answer(request: &Request, worker: &Worker) -> Result<(), Failure> {
    let run = worker.run();
    let mut settings = request::settings(&request.case)?;
    let map = Key::HeightMap;
    // No file is read from the disk.
    settings.retain(|(key, _)| ![map, Key::LensProfile].contains(key));
    let file = match &request.map {
        None => CaseFile::from_settings("the page", settings),
        Some(given) => {
            settings.push((map, Setting::Word(given.name.clone())));
            CaseFile::from_settings("the page", settings)
                .with_table(&given.name, &given.bytes(map.path())?)
        }
    };
    let case = file
        .surface_case(run.memory_limit())
        .map_err(Refusal::from)?;
    file.refuse_absurd_heights(&case).map_err(Refusal::from)?;
    let whole = &case.system;
    let surface = whole.surface();
    let relief = surface.highest() - surface.lowest();
    let indentation = match request.indentation_m {
        None => FIRST_LOAD * relief,
        Some(value) if value > 0.0 && value.is_finite() => value,
        Some(value) => {
            return Err(
                Refusal::impossible(format!("the indentation cannot be {value} m"))
                    .at("indentation_m")
                    .accepted("a length greater than 0")
                    .into(),
            );
        }
    };
    let stated = Whole {
        cells: [surface.grid().columns(), surface.grid().rows()],
        relief,
        toml: case.to_toml(),
        command: format!(
            "fakir press fakir-surface.toml --indentation {}",
            format_quantity(indentation, Dimension::Length).replace(' ', "")
        ),
    };
    let count = surface.grid().cell_count();
    let most = match whole.adhesion().is_none() {
        true => MOST_CELLS,
        false => MOST_ADHESIVE_CELLS,
    };
    let factor = |most: usize| (1..).find(|k| count / (k * k) <= most).unwrap_or(1);
    let mut factors = match &request.map {
        Some(_) => vec![factor(FIRST_CELLS), factor(most)],
        // Pillars are drawn on the cells that the case gives.
        None if count <= most => vec![1],
        None => {
            return Err(Refusal::impossible(format!(
                "the page computes {most} cells at most, and these are {count}"
            ))
            .at(Key::GridCells.path())
            .accepted("a smaller number, or `fakir press`")
            .into());
        }
    };
    factors.dedup();
    let last = factors.len() - 1;
    for (step, factor) in factors.into_iter().enumerate() {
        let start = Moment::now();
        let coarse;
        let system = match factor {
            1 => whole,
            _ => {
                coarse = coarser(whole, factor)?;
                &coarse
            }
        };
        let contact = system.press(Load::Indentation(indentation), &run)?;
        let wall_time = start.elapsed().as_secs_f64();
        let surface = shown(&stated, system, &contact, step < last, wall_time)?;
        worker.send(&SurfaceLine { surface });
    }
    Ok(())
}

/// What is said of the file whatever the cells of an answer.
struct Whole {
    cells: [usize; 2],
    /// Range of the heights, m.
    relief: f64,
    toml: String,
    command: String,
}

/// The same with the mean heights of squares of cells.
fn coarser(system: &SurfaceSystem, factor: usize) -> Result<SurfaceSystem, Refusal> {
    let surface = system.surface();
    let grid = surface.grid();
    let mean = |heights: &mut dyn Iterator<Item = f64>| {
        let (count, sum) = heights.fold((0.0, 0.0), |(count, sum), height| {
            (count + 1.0, sum + height)
        });
        sum / count
    };
    let (grid, heights) = blocks(grid, surface.heights(), factor, mean)?;
    let wrong = |error: String| Refusal::impossible(error).at(Key::HeightMap.path());
    let surface = HeightMap::new(grid, heights).map_err(|error| wrong(error.to_string()))?;
    let coarse = SurfaceSystem::new(
        system.indenter().clone(),
        *system.substrate(),
        surface,
        system.boundary(),
    );
    let [substrate, lens] = system.layers();
    let coarse = coarse
        .and_then(|coarse| coarse.with_layers(substrate.copied(), lens.copied()))
        .and_then(|coarse| coarse.with_adhesion(system.adhesion()))
        .map_err(|error| wrong(error.to_string()))?;
    Ok(match system.floor() {
        Some(floor) => coarse
            .with_floor(floor)
            .with_floor_model(system.floor_model()),
        None => coarse,
    })
}

/// A value of each square of `factor` by `factor` cells; cells at the end that fill no square are left out.
fn blocks(
    grid: &Grid,
    values: &[f64],
    factor: usize,
    of: impl Fn(&mut dyn Iterator<Item = f64>) -> f64,
) -> Result<(Grid, Vec<f64>), Refusal> {
    let [columns, rows] = [grid.columns(), grid.rows()].map(|count| (count / factor).max(1));
    let [width, height] = grid.cell();
    let cell = [factor as f64 * width, factor as f64 * height];
    let blocks = Grid::new(columns, rows, cell, grid.origin())
        .map_err(|error| Refusal::impossible(error.to_string()).at(Key::HeightMap.path()))?;
    let ends = [grid.columns(), grid.rows()];
    let mut found = Vec::with_capacity(columns * rows);
    for row in 0..rows {
        for column in 0..columns {
            let within = |first: usize, end: usize| first * factor..((first + 1) * factor).min(end);
            let mut inside = within(row, ends[1])
                .flat_map(|row| {
                    within(column, ends[0]).map(move |column| row * grid.columns() + column)
                })
                .map(|cell| values[cell]);
            found.push(of(&mut inside));
        }
    }
    Ok((blocks, found))
}

fn shown(
    stated: &Whole,
    system: &SurfaceSystem,
    contact: &SurfaceContact,
    approximate: bool,
    wall_time: f64,
) -> Result<Shown, Failure> {
    let grid = &contact.grid;
    let factor = grid.columns().max(grid.rows()).div_ceil(DRAWN);
    let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(f64::NEG_INFINITY, f64::max);
    let (drawn, heights) = blocks(grid, system.surface().heights(), factor, largest)?;
    let (_, pressures) = blocks(grid, &contact.pressure, factor, largest)?;
    let (low, high) = (system.surface().lowest(), system.surface().highest());
    let most = contact.pressure.iter().copied().fold(0.0, f64::max);
    let letter = |part: f64| {
        // Below 26, and 0 for NaN.
        let place = (SHADES * part).clamp(0.0, SHADES - 1.0) as u8;
        char::from(b'a' + place)
    };
    let state = SurfaceState {
        label: Text::from(""),
        system,
        contact,
        floor_contact: None,
    };
    let section = state.section()?;
    let answer = SurfaceAnswer {
        system,
        answer: contact,
    };
    Ok(Shown {
        approximate,
        file_cells: stated.cells,
        cells: [grid.columns(), grid.rows()],
        relief_m: stated.relief,
        indentation_m: contact.indentation,
        summary: Record::of(&answer).object(),
        wall_time_s: wall_time,
        warnings: warnings(contact),
        drawn: [drawn.columns(), drawn.rows()],
        corner_m: drawn.origin(),
        cell_m: drawn.cell(),
        heights: heights
            .iter()
            .map(|height| letter((height - low) / (high - low)))
            .collect(),
        pressures: pressures
            .iter()
            // In tension as at the smallest pressure: it is in contact.
            .map(|pressure| match pressure.abs() > 0.0 {
                true => letter(pressure / most),
                false => ' ',
            })
            .collect(),
        largest_pressure_Pa: most,
        section: section.into(),
        toml: stated.toml.clone(),
        command: stated.command.clone(),
    })
}
