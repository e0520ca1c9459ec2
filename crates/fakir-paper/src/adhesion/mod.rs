//! The parametric study of adhesion that the paper announces, with an adhesive floor.
//!
//! [`reproduce_adhesion`] writes the study to a folder:
//!
//! | file | content |
//! |---|---|
//! | `floor/`, `tops/`, `sizes/`, `offsets/`, `check/`, `cells/` | [sweeps](fakir_study::sweep_into), each a study that can be run by itself |
//! | `tables/` | findings, laws, candidates of laws, ways of the lens |
//! | `figures/` | every figure as SVG and PNG |
//! | `report.html` | findings, laws and figures on one page |
//! | `provenance.json` | version, study, what to cite |
//!
//! The floor is computed with the fast model of a collapsed floor and with closed forms, the tops exactly. Every number of the model has its
//! [validity](fakir_study::Validity). Cases outside the range of the model are solved on floor cells if that takes seconds; some cases within the range
//! are solved on cells too, to check the model.

pub mod figures;
pub mod findings;
mod page;
pub mod scaling;
pub mod study;

use crate::figures::Plate;
use crate::{PaperError, pictures, prepare, swept};
use fakir::state::Run;
use fakir_case::Study;
use fakir_study::citations::Topic;
use fakir_study::output::{File, csv_file, save};
use fakir_study::provenance::Provenance;
use fakir_study::{DamagedLine, Existing, Row};
use findings::{Checked, Finding, findings};
use page::Page;
use scaling::{HeldOut, Law, Reduced, candidates, chosen};
use serde::Serialize;
use std::path::Path;
use study::{Cases, FloorCase, Part, Scope, floor_cases, top_cases};

/// Progress.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Progress {
    /// Progress of a part.
    Sweep(Part, fakir_study::Progress),
    /// The figures are drawn.
    Figures,
}

/// Result of the study.
#[derive(Debug)]
pub struct AdhesionStudy {
    /// Findings.
    pub findings: Vec<Finding>,
    /// Laws, each with its test on other systems.
    pub laws: Vec<Checked>,
    /// The cases.
    pub cases: Cases,
    /// The number of cases of all sweeps.
    pub count: usize,
    /// Number of cases without a result.
    pub failed: usize,
    /// Invalid lines of journals, whose cases were computed again.
    pub damaged: Vec<DamagedLine>,
    /// The figures.
    pub plates: Vec<Plate>,
}

#[derive(Serialize)]
struct FindingRow<'a> {
    finding: &'a str,
    number: &'a str,
    value: f64,
}

#[derive(Serialize)]
struct LawRow {
    quantity: &'static str,
    chosen: bool,
    form: &'static str,
    groups: String,
    exponents: String,
    standard_errors: String,
    ranges: String,
    prefactor: f64,
    cases: usize,
    scatter: f64,
    largest_distance: f64,
    scatter_left_out: f64,
    band: f64,
}

/// Cases to which laws are fitted: rigid and intermediate substrate with the lens axis on a pillar, and the other sizes, if [laws apply](FloorCase::has_laws). The soft substrate is excluded, because it
/// collapses completely at nearly all works of adhesion of the study.
#[must_use]
pub fn cases_of_laws(cases: &Cases) -> Vec<&FloorCase> {
    use crate::grid::Substrate;
    let hard = [Substrate::Rigid, Substrate::Intermediate].into_iter();
    hard.flat_map(|substrate| cases.on_pillar(substrate))
        .chain(&cases.sizes)
        .filter(|case| case.has_laws())
        .collect()
}

/// Writes the study to a folder. [`Existing::Resume`] continues an interrupted study.
///
/// # Errors
/// [`PaperError`]
pub fn reproduce_adhesion(
    scope: &Scope,
    folder: &Path,
    existing: Existing,
    run: &Run<'_>,
    on_progress: &(dyn Fn(Progress) + Sync),
) -> Result<AdhesionStudy, PaperError> {
    prepare(folder, existing, &Part::ALL.map(Part::folder))?;
    let mut damaged = Vec::new();
    let (mut count, mut failed) = (0, 0);
    let mut sweep = |part: Part, known: &Cases| -> Result<(Study, Vec<Row>), PaperError> {
        let study = scope.study(part, known)?;
        let report = |progress| on_progress(Progress::Sweep(part, progress));
        let summary = swept(&study, &folder.join(part.folder()), existing, run, &report)?;
        damaged.extend(summary.damaged);
        count += summary.rows.len();
        let failures = summary.rows.iter().filter(|row| row.problem.is_some());
        failed += failures.count();
        Ok((study, summary.rows))
    };
    let mut cases = Cases::default();
    let (of_floor, found) = sweep(Part::Floor, &cases)?;
    cases.floor = floor_cases(&of_floor, &found);
    let (study, found) = sweep(Part::Tops, &cases)?;
    cases.tops = top_cases(&study, &found);
    let (study, found) = sweep(Part::Sizes, &cases)?;
    cases.sizes = floor_cases(&study, &found);
    let (study, found) = sweep(Part::Offsets, &cases)?;
    cases.floor.extend(floor_cases(&study, &found));
    let (study, found) = sweep(Part::Check, &cases)?;
    cases.check = floor_cases(&study, &found);
    let (_, found) = sweep(Part::Cells, &cases)?;
    cases.take_cells(scope, &found);
    let of_laws = cases_of_laws(&cases);
    let all: Vec<Vec<Law>> = Reduced::ALL
        .into_iter()
        .map(|reduced| candidates(reduced, &of_laws))
        .collect();
    let laws: Vec<Checked> = all
        .iter()
        .filter_map(|laws| chosen(laws))
        .map(|law| (law.clone(), HeldOut::new(law, &cases.check)))
        .collect();
    let found = findings(scope, &cases, &laws);
    on_progress(Progress::Figures);
    let plates = figures::plates(scope, &cases, &laws, run)?;
    let provenance = provenance(&of_floor);
    let page = Page {
        findings: &found,
        laws: &laws,
        plates: &plates,
        cases: &cases,
        citations: &provenance.citations,
        count,
        failed,
    };
    let mut files = vec![
        csv_file("tables/findings.csv", finding_rows(&found)),
        csv_file("tables/laws.csv", law_rows(&all)),
    ];
    files.extend(pictures(&plates, &provenance, run));
    files.push(File::new("report.html", page.html()));
    let names = files.iter().map(|file| file.name.as_ref());
    files.push(provenance.file(names));
    save(folder, &files)?;
    Ok(AdhesionStudy {
        findings: found,
        laws,
        cases,
        count,
        failed,
        damaged,
        plates,
    })
}

fn provenance(study: &Study) -> Provenance {
    let sweep = Provenance::of_study(study);
    let topics = [
        Topic::of_study(study),
        vec![Topic::ClosedForms, Topic::LeastSquares],
    ]
    .concat();
    Provenance::new(
        "adhesion of lens and patterned surface, with an adhesive floor",
        sweep.method,
        &topics,
        study.to_toml(),
    )
}

fn finding_rows(findings: &[Finding]) -> impl Iterator<Item = FindingRow<'_>> {
    findings.iter().flat_map(|finding| {
        finding.numbers.iter().map(|(number, value)| FindingRow {
            finding: finding.name,
            number,
            value: *value,
        })
    })
}

fn law_rows(all: &[Vec<Law>]) -> impl Iterator<Item = LawRow> + '_ {
    all.iter().flat_map(|laws| {
        let best = chosen(laws);
        laws.iter().map(move |law| {
            let joined = |of: &dyn Fn(usize) -> String| {
                let parts: Vec<String> = (0..law.groups.len()).map(of).collect();
                parts.join("; ")
            };
            LawRow {
                quantity: law.reduced.name(),
                chosen: best.is_some_and(|best| best == law),
                form: law.reduced.form().name(),
                groups: joined(&|k| law.groups[k].name().to_owned()),
                exponents: joined(&|k| law.exponents[k][0].to_string()),
                standard_errors: joined(&|k| law.exponents[k][1].to_string()),
                ranges: joined(&|k| {
                    let [from, to] = law.ranges[k];
                    format!("{from} to {to}")
                }),
                prefactor: law.prefactor,
                cases: law.points,
                scatter: law.scatter,
                largest_distance: law.largest,
                scatter_left_out: law.left_out,
                band: law.band,
            }
        })
    })
}
