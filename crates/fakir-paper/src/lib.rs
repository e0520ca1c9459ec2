//! The results of R. Ledesma-Alonso, E. Raphaël, F. Restagno, C. Poulard, Phys. Rev. E 104, 055007
//! (2021), reproduced: tables, figures, and a report that compares every claim with them.
//!
//! [`reproduce`] writes the results to a folder:
//!
//! | file | content |
//! |---|---|
//! | `critical-states/` | a [sweep](fakir_study::sweep_into) over substrates, offsets and surface fractions |
//! | `dense-states/` | the same up to a surface fraction of 0.29, on request |
//! | `tables/` | the numbers of claims, power laws, loading paths and pillars |
//! | `figures/` | every figure as SVG and PNG |
//! | `report.html` | claims, figures and numbers on one page |
//! | `provenance.json` | version, study, what to cite |

pub mod adhesion;
pub mod analysis;
pub mod claims;
pub mod figures;
pub mod grid;
pub mod measured;
pub mod report;
pub mod states;
pub mod tables;

use claims::{Claim, Evidence, claims};
use fakir::state::{Run, SolveError};
use fakir::theory::lattice_sums::SumFit;
use fakir_case::{CaseError, Study};
use fakir_figure::Measured;
use fakir_study::citations::Topic;
use fakir_study::output::{File, OutputError, save};
use fakir_study::provenance::Provenance;
use fakir_study::results::remove_results;
use fakir_study::{DamagedLine, Existing, Row, StudyError, Summary, sweep_into};
use figures::{DrawingError, Material, Plate, plates};
use grid::{Fractions, Grid, Substrate};
use rayon::prelude::*;
use report::Report;
use states::{StateError, States};
use std::fs::ReadDir;
use std::path::Path;

/// Why the paper could not be reproduced.
#[derive(Debug, thiserror::Error)]
pub enum PaperError {
    /// The sweep failed.
    #[error(transparent)]
    Study(#[from] StudyError),
    /// An invalid case.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// A contact that could not be computed.
    #[error(transparent)]
    Solve(#[from] SolveError),
    /// A figure that could not be drawn.
    #[error(transparent)]
    Figure(#[from] fakir_figure::FigureError),
    /// Files that could not be saved.
    #[error(transparent)]
    Output(#[from] OutputError),
}

impl From<StateError> for PaperError {
    fn from(error: StateError) -> Self {
        match error {
            StateError::Case(error) => error.into(),
            StateError::Solve(error) => error.into(),
        }
    }
}

impl From<DrawingError> for PaperError {
    fn from(error: DrawingError) -> Self {
        match error {
            DrawingError::Case(error) => error.into(),
            DrawingError::Solve(error) => error.into(),
            DrawingError::Figure(error) => error.into(),
        }
    }
}

/// What is reproduced.
#[derive(Debug, Clone)]
pub struct Scope {
    /// Surface fractions of the sweep.
    pub fractions: Fractions,
    /// Extend the surface fraction to 0.29, which takes longer than everything else.
    pub dense: bool,
    /// Measured points to draw on the curves.
    pub measured: Vec<(Substrate, Measured)>,
}

/// Progress.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Progress {
    /// Progress of the sweep.
    Sweep(fakir_study::Progress),
    /// Progress of the sweep of dense patterns.
    Dense(fakir_study::Progress),
    /// Single states are computed; with the fraction that is finished.
    States(f64),
    /// The figures are drawn.
    Figures,
}

/// Result of the reproduction.
#[derive(Debug)]
pub struct Reproduction {
    /// The claims.
    pub claims: Vec<Claim>,
    /// The number of cases of all sweeps.
    pub cases: usize,
    /// Number of cases without a result.
    pub failed: usize,
    /// Invalid lines of journals, whose cases were computed again.
    pub damaged: Vec<DamagedLine>,
    /// The figures.
    pub plates: Vec<Plate>,
}

/// Folder of the sweep.
pub const CRITICAL_STATES: &str = "critical-states";

/// Folder of the sweep of dense patterns.
pub const DENSE_STATES: &str = "dense-states";

/// Contact radii, in pitches, of the fits of the lattice sums, as in the paper.
const FIT: ([f64; 2], usize) = ([1.0, 32.0], 1000);

/// Writes all results to a folder. [`Existing::Resume`] continues an interrupted run.
///
/// # Errors
/// [`PaperError`]
pub fn reproduce(
    scope: &Scope,
    folder: &Path,
    existing: Existing,
    run: &Run<'_>,
    on_progress: &(dyn Fn(Progress) + Sync),
) -> Result<Reproduction, PaperError> {
    prepare(folder, existing, &[CRITICAL_STATES, DENSE_STATES])?;
    let mut damaged = Vec::new();
    let mut sweep = |fractions, name, report: fn(fakir_study::Progress) -> Progress| {
        let study = grid::study(fractions)?;
        let listener = |progress| on_progress(report(progress));
        let summary = swept(&study, &folder.join(name), existing, run, &listener)?;
        damaged.extend(summary.damaged);
        Ok::<_, PaperError>((study, summary.rows))
    };
    let mut parts: Vec<(Study, Vec<Row>)> =
        vec![sweep(scope.fractions, CRITICAL_STATES, Progress::Sweep)?];
    if scope.dense {
        parts.push(sweep(Fractions::DENSE, DENSE_STATES, Progress::Dense)?);
    }
    let by_study: Vec<(&Study, &[Row])> = parts.iter().map(|(s, r)| (s, &r[..])).collect();
    let grid = Grid::new(&by_study);
    let states = States::compute(run, &|part| on_progress(Progress::States(part)))?;
    let Some(fit) = SumFit::least_squares(FIT.0, FIT.1) else {
        unreachable!("the range of the fit is a valid one");
    };
    on_progress(Progress::Figures);
    let material = Material {
        grid: &grid,
        states: &states,
        fit: &fit,
        measured: &scope.measured,
    };
    let plates = plates(&material, run)?;
    let evidence = Evidence {
        grid: &grid,
        dense: &states.dense.contact,
        fit: &fit,
        loading: states
            .loadings
            .last()
            .map_or(&[], |loading| &loading.states),
        mixed: &states.mixed,
    };
    let claims = claims(&evidence)?;
    let rows = || parts.iter().flat_map(|(_, rows)| rows);
    let failed = rows().filter(|row| row.problem.is_some()).count();
    let provenance = provenance(&parts[0].0);
    let report = Report {
        claims: &claims,
        plates: &plates,
        grid: &grid,
        citations: &provenance.citations,
        failed,
    };
    let mut files = tables::tables(&grid, &states, &claims);
    files.extend(pictures(&plates, &provenance, run));
    files.push(File::new("report.html", report.html()));
    let names = files.iter().map(|file| file.name.as_ref());
    files.push(provenance.file(names));
    save(folder, &files)?;
    Ok(Reproduction {
        cases: rows().count(),
        failed,
        damaged,
        plates,
        claims,
    })
}

/// Prepares a folder: refuses a folder that is not empty, or removes the files of a previous run.
fn prepare(folder: &Path, existing: Existing, parts: &[&str]) -> Result<(), PaperError> {
    let is_empty = |mut entries: ReadDir| entries.next().is_none();
    if existing == Existing::Refuse && !folder.read_dir().map_or(true, is_empty) {
        return Err(StudyError::NotEmpty(folder.to_owned()).into());
    }
    if existing == Existing::Overwrite {
        remove_results(folder, parts)?;
    }
    Ok(())
}

/// Sweeps a study into a folder with the settings of a run.
fn swept(
    study: &Study,
    folder: &Path,
    existing: Existing,
    run: &Run<'_>,
    report: &dyn Fn(fakir_study::Progress),
) -> Result<Summary, StudyError> {
    let mut listener = |progress| report(progress);
    let mut options = fakir_study::Options {
        threads: run.pool.map_or(1, rayon::ThreadPool::current_num_threads),
        cancel: run.cancel.clone(),
        memory_limit: run.memory_limit,
        on_progress: Some(&mut listener),
        ..fakir_study::Options::default()
    };
    sweep_into(study, folder, existing, &mut options)
}

fn provenance(study: &Study) -> Provenance {
    let sweep = Provenance::of_study(study);
    let topics = [Topic::of_study(study), vec![Topic::ClosedForms]].concat();
    Provenance::new(
        "the results of the paper",
        sweep.method,
        &topics,
        study.to_toml(),
    )
}

/// Every figure as SVG and PNG.
fn pictures(plates: &[Plate], provenance: &Provenance, run: &Run<'_>) -> Vec<File> {
    let source = format!(
        "fakir {}, {}, https://doi.org/{}",
        provenance.fakir_version, provenance.method, provenance.reference_doi
    );
    let draw = |plate: &Plate| {
        let figure = plate.figure.clone().with_provenance(&source);
        let name = |extension: &str| format!("figures/{}.{extension}", figure.name());
        [
            File::new(name("svg"), figure.svg()),
            File::new(name("png"), figure.png()),
        ]
    };
    match run.pool {
        Some(pool) => pool.install(|| plates.par_iter().flat_map_iter(draw).collect()),
        None => plates.iter().flat_map(draw).collect(),
    }
}
