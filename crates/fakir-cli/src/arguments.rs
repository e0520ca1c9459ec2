//! Command-line arguments (clap) with their help texts.

use crate::failure::Failure;
use crate::session::{RunArguments, Session, memory};
use crate::standard::case_file;
use clap::{ArgGroup, Args, Parser, Subcommand, ValueEnum};
use fakir::problem::{CyclePlan, Load, LoadingMode, Prescribed, Question};
use fakir::state::Branch;
use fakir_case::unit::{Dimension, QuantityError, parse_plausible, parse_rate};
use fakir_case::{CaseError, CaseFile, Key, Kind, SurfaceKind, read_protocol};
use fakir_inverse::design::{PressedQuantity, Wanted, free_key, free_names};
use fakir_inverse::fit::{
    FitOptions, Hints, MOST_STARTS, Measurements, NamedColumn, Parameter, Selection,
    has_relaxation, shared_by_default,
};
use fakir_inverse::spread::{Deviation, Landing, Sampling, Tolerance};
use fakir_study::answer::{Details, Maps, Request};
use fakir_study::approach::{LoadingEnd, LoadingPath};
use fakir_study::fields::MOST_POINTS;
use fakir_study::history::HistoryCourse;
use fakir_study::output::Replace;
use fakir_study::{Existing, Shard};
use std::ffi::OsString;
use std::path::{Path, PathBuf};

const ABOUT: &str = "\
Contact between a smooth elastic lens and a surface patterned with pillars, and the load at which \
the lens turns from resting on pillar tops to touching the floor between them.

Start with `fakir init`, which writes a case file, and `fakir transition case.toml`.";

const EXIT_STATUS: &str = "\
Exit status:
  0    done
  1    a solution did not converge, an estimated relative error is above 0.5, cases of a sweep
       failed, verify found a disagreement or is inconclusive, or with --strict a validity limit of
       the model is exceeded or a fit does not describe the data; the result is still printed and
       saved
  2    bad input: arguments, case file, a combination that is not supported, or a file that cannot be
       read or written
  3    no answer: the contact is too large for the lens, for the surface or for memory, the pattern
       is too dense for the method, or numbers became infinite
  130  interrupted by Ctrl-C; nothing is saved, but a sweep keeps its journal";

#[derive(Debug, Parser)]
#[command(name = "fakir", version, long_about = ABOUT, after_help = EXIT_STATUS)]
#[command(
    about = "Contact of an elastic lens on pillars, and the load at which it reaches the floor"
)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// Replaces the deprecated `approach --retract` by `cycle` in the arguments. Returns whether it was used.
pub(crate) fn renamed(mut arguments: Vec<OsString>) -> (Vec<OsString>, bool) {
    let options = arguments.iter().take_while(|word| *word != "--");
    let place = options.into_iter().position(|word| word == "--retract");
    match (arguments.get(1), place) {
        (Some(command), Some(place)) if command == "approach" => {
            arguments.remove(place);
            arguments[1] = "cycle".into();
            (arguments, true)
        }
        _ => (arguments, false),
    }
}

/// Warnings about deprecated names of keys in `--free` and `--tolerance`; those in `--set` are among the warnings of the case.
pub(crate) fn deprecated_keys(arguments: &[OsString]) -> Vec<String> {
    let words = arguments.iter().filter_map(|word| word.to_str());
    let mut is_value = false;
    let mut warnings = Vec::new();
    for word in words.take_while(|word| *word != "--") {
        let value = match word.split_once('=') {
            Some(("--free" | "--tolerance", value)) => Some(value),
            _ => is_value.then_some(word),
        };
        is_value = ["--free", "--tolerance"].contains(&word);
        for item in value.into_iter().flat_map(|value| value.split(',')) {
            let name = item.split_once('=').map_or(item, |(name, _)| name).trim();
            if let Some(key) = Key::at_former(name) {
                warnings.push(format!("{name} is deprecated: use {key}"));
            }
        }
    }
    warnings
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Write a commented case file to start from
    #[command(after_help = "Examples:
  fakir init soft.toml
  fakir init --schema > fakir.schema.json")]
    Init(Init),
    /// List the names, units and meanings of the numbers in results
    #[command(after_help = "Examples:
  fakir results
  fakir results --schema > fakir.schema.json")]
    Results(Results),
    /// Compute the critical state, in which the lens just reaches the floor
    #[command(
        after_help = "Example: fakir transition case.toml --set pattern.surface_fraction=0.2"
    )]
    Transition(Transition),
    /// Compute the contact at an indentation or under a force
    ///
    /// Past the transition the floor between the pillars carries part of the load, which only the method spectral computes. With the other
    /// methods, and with --without-floor, floor contact is ignored, as in the paper: the smallest floor gap is then negative, and a warning
    /// gives the critical load.
    #[command(after_help = "Example: fakir press case.toml --force 20uN")]
    Press(Press),
    /// Compute loading step by step, as in the experiment: up to the critical state, or beyond with --to
    ///
    /// Past the critical state the floor carries part of the load; this is available on a pillar pattern with the method spectral, and on a
    /// general surface (a case with a [surface]). A height map without surface.floor has no critical state: its loading ends at --to. With
    /// --output the states are saved as a table, and force, contact radius and the fraction of the load carried by the floor are plotted
    /// over the indentation.
    ///
    /// `fakir cycle` also computes unloading, for adhesive pillar tops (a case with [adhesion]).
    #[command(
        after_help = "Example: fakir approach case.toml --to 18um --output through-the-transition"
    )]
    Approach(Approach),
    /// Compute loading and unloading with adhesive pillar tops (a case with [adhesion])
    ///
    /// Loading ends at --to or --to-force, or at the critical state. Past the critical state the floor carries load too, and is adhesive
    /// with adhesion.floor = true; --without-floor ignores it. Every change of contact on the tops alone is located exactly, so that the
    /// result does not depend on a step size; on the floor it is located to the cells and the steps, and the errors are estimated. With
    /// --output the curve, the events and the pillars attached at pull-off are saved as tables and figures.
    ///
    /// `fakir approach --retract` is the older name of this command.
    #[command(after_help = "Example: fakir cycle case.toml --set adhesion.work=50mJ/m2")]
    Cycle(Cycle),
    /// Compute the contact of viscoelastic bodies over time (a case with [relaxation]): creep, relaxation, time to floor contact
    ///
    /// A force or an indentation is reached at once, or in the time --ramp, held --for a time, and with --back taken back. Or --protocol is
    /// a table of ramps: a column time_s, and one of displacement_m, indentation_m or force_N, also in other units (time_min,
    /// displacement_um), with times counted from its first row. young_modulus is the relaxed modulus of all bodies. While the contact grows, the result is a superposition of
    /// elastic contacts, which is exact; from the first receding on, it is computed in time steps with an estimated error.
    ///
    /// time_to_floor_contact_s of the JSON is the time at which the lens reaches the floor, also after the end if the last load is held, and
    /// null if it never does. With --output the states and the events are saved as tables, and plotted over time.
    ///
    /// Adhesive cases are refused: compute their limits of slow and fast loads with `fakir press`, without and with --instantaneous.
    #[command(after_help = "Examples:
  fakir hold case.toml --force 1mN --for 10min
  fakir hold case.toml --set relaxation.strengths=[1.0] --set relaxation.times=30s --force 0.4mN --for 5min
  fakir hold case.toml --indentation 4um --ramp 10s --for 1min --back --output history
  fakir hold case.toml --protocol ramps.csv")]
    Hold(Hold),
    /// Compare the spectral method with boundary elements on the same problem
    ///
    /// Boundary elements (BEM) on two meshes are compared with the accurate spectral method; both methods estimate their errors. The
    /// problem is the critical state, or the contact under a load if one is given. Past the transition the elements cover pillar tops and
    /// floor, and the floor forces are compared too. Exit status 1: the results differ by more than the error estimates, or the comparison
    /// is inconclusive because a method did not converge or its result has no significant digit. Of the case's [method] only the mesh of
    /// the elements is used. On a general surface (a case with a [surface]) only elements are available: pillars on a lattice are solved on
    /// both meshes; height maps, which have a single mesh, and random pillars are refused. Both methods contain the adhesion of a case
    /// with [adhesion].
    #[command(after_help = "Example: fakir verify case.toml --cells 32")]
    Verify(Verify),
    /// Evaluate closed forms: lattice sums, critical state and transition curve
    ///
    /// Formulas that are inconsistent in print are given as printed and as corrected. The closed forms apply to a lens axis on a pillar.
    /// With adhesive pillar tops (a case with [adhesion]) the pull-off forces of one pillar and of the bare substrate are included; the
    /// formulas for the critical state neglect adhesion.
    #[command(
        after_help = "Example: fakir theory case.toml --set pattern.surface_fraction=0.001
         fakir theory case.toml --set adhesion.work=50mJ/m2 --attraction-range 5nm"
    )]
    Theory(Theory),
    /// Compute the critical state by every method, approximate to exact
    ///
    /// Differences are relative to the most accurate method. Boundary elements take most of the time: seconds for a few hundred pillars,
    /// minutes for a few thousand. With adhesive pillar tops only the method spectral applies; closed forms are given without adhesion.
    #[command(after_help = "Example: fakir compare case.toml")]
    Compare(Compare),
    /// Explore a case interactively in the browser: a slider for every quantity
    ///
    /// Starts a server for this machine only, with a random token in its address; the page needs no network. It starts with the given case,
    /// or with the one that `fakir init` writes. With adhesion the load is increased to the critical state and decreased to the last
    /// detachment. Ctrl-C stops the server.
    #[cfg(feature = "explore")]
    #[command(after_help = "Examples:
  fakir explore
  fakir explore case.toml --set pattern.surface_fraction=0.2 --port 8080 --no-browser
  fakir explore case.toml --set adhesion.work=50mJ/m2")]
    Explore(Explore),
    /// Print the references to cite for a result, a case, a study or a method
    #[command(after_help = "Example: fakir cite results --bibtex")]
    Cite(Cite),
    /// Reproduce every result of the paper, or the study of adhesion that it announced: tables, figures and a report
    ///
    /// paper: 6 landing positions, 60 surface fractions and 3 substrates, in half a minute; with report.html, a self-contained page of
    /// claims, figures and numbers.
    ///
    /// adhesion: surface fractions, works of adhesion, substrates and offsets with adhesive tops and floor: jump-in to the floor, its
    /// detachment, pull-off and hysteresis, with scaling laws, figures and a report. The floor is computed by the fast model of a collapsed
    /// floor in its range, and by floor cells below it. Ctrl-C interrupts; --resume continues.
    #[command(after_help = "Examples:
  fakir reproduce paper --output paper
  fakir reproduce adhesion --output adhesion --quick")]
    Reproduce(Reproduce),
    /// Find the pitch, size or modulus for a target critical state, pull-off force or floor share; heights of rounded tops for a target
    /// curve; and the scatter of real samples
    ///
    /// All other quantities are taken from the case file. If the case file gives the pitch, the pitch is kept constant, otherwise the
    /// surface fraction. Exit status 3: the target is unattainable; the closest attainable value is printed. For samples with adhesion,
    /// unloading from the critical state is computed too, for the scatter of the pull-off force and the hysteresis.
    ///
    /// With --free heights a case with pattern.top_radius gives the positions of the pillars and the curvature of their tops, and --target
    /// the target curve: a CSV file with the columns force and area, indentation and force, or indentation and area, as in
    /// force_mN,area_um2. With --output the heights are saved as pillars.csv with a case that reads it, as a solid (surface.stl) and as
    /// height maps (heights.png of 16 bits, heights.npy).
    #[command(after_help = "Examples:
  fakir design case.toml --free pitch --critical-force 1mN
  fakir design case.toml --free pitch --critical-force 1mN \\
      --tolerance pattern.pillar.height=3% --tolerance substrate.young_modulus=10%
  fakir design case.toml --free pitch --floor-share 20% --at-force 1mN
  fakir design adhesive.toml --free pitch --pull-off 0.1mN
  fakir design case.toml --samples 1000
  fakir design asperities.toml --free heights --target curve.csv --height-error 0.2um --output designed")]
    Design(Design),
    /// Fit moduli, work of adhesion and instrument parameters to measured curves, by least squares
    ///
    /// DATA has a heading with units and a row for every state, with two or more of the columns displacement_m (reading of the instrument,
    /// increasing with depth) or indentation_m, force_N and contact_radius_m. Standard errors are in columns of the same names with _error
    /// before the unit, as in force_error_N; if a force or contact radius has no errors, its scatter is estimated from the residuals. Cells
    /// may be empty; lines that begin with # are ignored.
    ///
    /// If a displacement or indentation is given, it is the load, otherwise the force. The indentation is displacement - contact_point -
    /// machine_compliance * force. States past the transition are used with the method spectral, which computes the floor force, and left
    /// out with the others and with floor.contact=false. A parameter that the data do not determine has no confidence interval.
    ///
    /// With adhesive pillar tops (a case with [adhesion], or adhesion.work free) the data are one cycle of loading and unloading. A column
    /// branch contains loading or unloading in every row; without it unloading begins after the largest load. Pull-off is the smallest
    /// force, negative as measured; it determines the initial value of the work of adhesion.
    ///
    /// With viscoelastic bodies (a case with [relaxation]) and a column time_s the rows are one history of ramps and holds, in the order of
    /// time; between rows the indentation is linear in time, and before the first row there was no contact. young_modulus is the relaxed
    /// modulus, and relaxation.strengths[0], relaxation.times[0] and those of further terms can be free. With elastic bodies a column of
    /// times is used to test whether the forces depend on the rate.
    ///
    /// Several files are fitted separately, with the same case and options. Printed are the values of every file and, for every parameter,
    /// mean, standard deviation, standard error of the mean, and weighted mean; with at least 5 files, a value is named as an outlier if
    /// its modified z-score, 0.6745 (value - median)/(median absolute deviation), is beyond 3.5. It remains in the mean. If a file cannot
    /// be read or its fit does not converge, it is named, the others are fitted, and the exit status is 1.
    ///
    /// With --joint all files are fitted together: moduli, sizes and works of adhesion have one value, and contact points and other
    /// parameters of the instrument a value for every file, unless --shared names the shared parameters. Printed is a test of whether the
    /// files agree on the shared values. All files must contain the same quantities, and all of them must be readable.
    #[command(after_help = "Examples:
  fakir fit data.csv --case case.toml --free substrate.young_modulus,contact_point
  fakir fit data.csv --case case.toml --free substrate.young_modulus --free contact_point \\
      --machine-compliance 2e-3 --force-error 0.5uN --output fitted
  fakir fit retraction.csv --case sticky.toml --free adhesion.work,contact_point,force_offset
  fakir fit relaxation.csv --case rubber.toml --free 'substrate.young_modulus,relaxation.strengths[0],relaxation.times[0]'
  fakir fit measured/*.csv --case case.toml --free substrate.young_modulus,contact_point \\
      --threads 0 --output fitted
  fakir fit measured/*.csv --case case.toml --free substrate.young_modulus,contact_point --joint")]
    Fit(Fit),
    /// Fit the shear stresses of friction on tops and floor to measured lateral forces
    ///
    /// DATA has a heading with units and a row for every normal load, with the columns lateral_force_N (also called friction, tangential or
    /// shear force) and force_N (normal force) or indentation_m. The contact of every row is solved; its areas on pillar tops and on the floor
    /// determine both stresses by linear least squares. Standard errors are in a column lateral_force_error_N, or given as --lateral-error;
    /// otherwise they are estimated from the residuals.
    ///
    /// A stress that the data do not determine has no interval: the one of the floor if no row is past the transition. On a flat surface, on
    /// rounded tops whose floor carries no load, and on a height map without surface.floor there is one stress, of the whole
    /// contact.
    ///
    /// The shear does not change the normal contact in this model: this is exact between incompressible half-spaces; contacts are not peeled
    /// by shear.
    #[command(after_help = "Examples:
  fakir friction case.toml lateral.csv
  fakir friction case.toml lateral.csv --lateral-error 5uN --output friction")]
    Friction(Friction),
    /// Compute many cases: a study file with axes along which a case is varied
    ///
    /// The case has a [pattern] or a [surface]; an axis is any of its keys, or a load. Computed is the critical state; with question =
    /// "press" the contact under a load, with "cycle" the pull-off from adhesive tops, with "collapse" the jump-in and detachment of an
    /// adhesive floor. Every case is one row of a table; a row of a case that failed contains the reason. With --output a journal is kept
    /// in the folder, so that an interrupted or killed sweep continues with --resume; the tables are identical, byte for byte, to those of
    /// an uninterrupted sweep. Without --output the table is printed as CSV.
    #[command(after_help = "Example: fakir sweep study.toml --output results")]
    Sweep(Sweep),
    /// Merge the shards of a sweep, with the same result as an undivided sweep
    #[command(after_help = "Example: fakir merge results shard-1 shard-2 shard-3")]
    Merge(Merge),
    /// Print a script that completes commands and options in a shell
    #[command(after_help = "Examples:
  fakir completions bash > ~/.local/share/bash-completion/completions/fakir
  fakir completions fish > ~/.config/fish/completions/fakir.fish")]
    Completions(Completions),
    /// Print a page of the manual, for man
    #[command(after_help = "Examples:
  fakir man > fakir.1
  fakir man transition > fakir-transition.1")]
    Man(Man),
}

impl Command {
    /// Whether a result fails if a validity limit of the model is exceeded.
    pub(crate) fn is_strict(&self) -> bool {
        match self {
            Self::Transition(options) => options.limits.strict,
            Self::Press(options) => options.limits.strict,
            Self::Fit(options) => options.strict,
            Self::Friction(options) => options.strict,
            _ => false,
        }
    }

    pub(crate) fn name(&self) -> &'static str {
        match self {
            Self::Init(_) => "init",
            Self::Results(_) => "results",
            Self::Transition(_) => "transition",
            Self::Press(_) => "press",
            Self::Approach(_) => "approach",
            Self::Cycle(_) => "cycle",
            Self::Hold(_) => "hold",
            Self::Verify(_) => "verify",
            Self::Theory(_) => "theory",
            Self::Compare(_) => "compare",
            #[cfg(feature = "explore")]
            Self::Explore(_) => "explore",
            Self::Cite(_) => "cite",
            Self::Reproduce(_) => "reproduce",
            Self::Design(_) => "design",
            Self::Fit(_) => "fit",
            Self::Friction(_) => "friction",
            Self::Sweep(_) => "sweep",
            Self::Merge(_) => "merge",
            Self::Completions(_) => "completions",
            Self::Man(_) => "man",
        }
    }
}

#[derive(Debug, Args)]
pub(crate) struct Friction {
    #[command(flatten)]
    pub(crate) case: CaseArguments,
    /// Table of lateral forces under normal loads (text, .gz, .xlsx): columns lateral_force_N and one of force_N (normal force) and
    /// indentation_m, in any unit
    #[arg(value_name = "DATA")]
    pub(crate) data: PathBuf,
    /// Assign a column explicitly, as in lateral_force="Channel 2 [mN]" or force="#2 [mN]"; may be repeated
    #[arg(long = "column", value_name = "QUANTITY=HEADING", value_parser = NamedColumn::parse)]
    columns: Vec<NamedColumn>,
    /// Standard error of lateral forces without one in the file (N, mN, uN, nN)
    #[arg(long, value_name = "FORCE", value_parser = positive_force)]
    pub(crate) lateral_error: Option<f64>,
    /// Exit with status 1 if the fit does not describe the data; the result is still printed and saved
    #[arg(long)]
    pub(crate) strict: bool,
    #[command(flatten)]
    pub(crate) run: RunArguments,
}

impl Friction {
    pub(crate) fn hints(&self) -> Hints {
        Hints {
            named: self.columns.clone(),
            ..Hints::default()
        }
    }
}

fn positive_force(text: &str) -> Result<f64, String> {
    let value = force(text).map_err(|error| error.to_string())?;
    match value > 0.0 && value.is_finite() {
        true => Ok(value),
        false => Err("must be greater than 0".to_owned()),
    }
}

#[derive(Debug, Args)]
pub(crate) struct Results {
    /// Print a JSON Schema of --json and summary.json instead
    #[arg(long)]
    pub(crate) schema: bool,
    /// Print which commands support which kind of surface instead, and why others do not
    #[arg(long, conflicts_with = "schema")]
    pub(crate) surfaces: bool,
}

#[derive(Debug, Args)]
pub(crate) struct Init {
    /// File to write; `-` for standard output
    #[arg(default_value = "case.toml")]
    pub(crate) file: PathBuf,
    /// Replace an existing file
    #[arg(long)]
    pub(crate) force: bool,
    /// Write no case; print a reference of all keys of case files as Markdown
    #[arg(long, conflicts_with_all = ["file", "force"])]
    pub(crate) keys: bool,
    /// Write no case; print a JSON Schema of case and study files, for editors of TOML
    #[arg(long, conflicts_with_all = ["file", "force", "keys"])]
    pub(crate) schema: bool,
}

#[derive(Debug, Args)]
pub(crate) struct Transition {
    #[command(flatten)]
    pub(crate) case: CaseArguments,
    #[command(flatten)]
    pub(crate) adhesion: RangeArguments,
    #[command(flatten)]
    pub(crate) limits: LimitArguments,
    #[command(flatten)]
    pub(crate) gradient: GradientArguments,
    #[command(flatten)]
    modulus: ModulusArguments,
    #[command(flatten)]
    fields: FieldArguments,
    #[command(flatten)]
    pub(crate) run: RunArguments,
}

/// A question about a case, and the options that go with it.
pub(crate) struct Asked<'a> {
    pub(crate) case: &'a CaseArguments,
    pub(crate) run: &'a RunArguments,
    pub(crate) floor: Option<&'a FloorArguments>,
    pub(crate) range: Option<RangeArguments>,
    /// Questions that the case must support.
    pub(crate) questions: Vec<Question>,
    pub(crate) request: Request,
    /// Without the range of the attraction.
    pub(crate) details: Details,
    /// A course over time, for which the request is a history of viscoelastic bodies.
    pub(crate) course: Option<HistoryCourse>,
    /// Whether the moduli are the instantaneous ones.
    pub(crate) instantaneous: bool,
}

impl<'a> Asked<'a> {
    /// A history, whose course is still to be set.
    fn over_time(
        case: &'a CaseArguments,
        run: &'a RunArguments,
        floor: &'a FloorArguments,
    ) -> Self {
        Self {
            case,
            run,
            floor: Some(floor),
            range: None,
            questions: vec![Question::Hold],
            request: Request::Contact(Load::FloorContact),
            details: case.details(),
            course: None,
            instantaneous: false,
        }
    }
}

impl Transition {
    pub(crate) fn asked(&self) -> Asked<'_> {
        let options = [self.adhesion.question(), self.gradient.question()];
        Asked {
            case: &self.case,
            run: &self.run,
            floor: None,
            range: Some(self.adhesion),
            questions: [Question::Transition]
                .into_iter()
                .chain(options.into_iter().flatten())
                .collect(),
            request: Request::Contact(Load::FloorContact),
            details: Details {
                gradient: self.gradient.gradient,
                maps: self.fields.maps(&self.case),
                ..Details::default()
            },
            course: None,
            instantaneous: self.modulus.instantaneous,
        }
    }
}

#[derive(Debug, Args)]
#[command(group = ArgGroup::new("load").required(true).args(["indentation", "force"]))]
pub(crate) struct Press {
    #[command(flatten)]
    pub(crate) case: CaseArguments,
    #[command(flatten)]
    pub(crate) load: LoadArguments,
    #[command(flatten)]
    pub(crate) adhesion: RangeArguments,
    #[command(flatten)]
    pub(crate) floor: FloorArguments,
    #[command(flatten)]
    pub(crate) limits: LimitArguments,
    #[command(flatten)]
    pub(crate) gradient: GradientArguments,
    #[command(flatten)]
    modulus: ModulusArguments,
    #[command(flatten)]
    fields: FieldArguments,
    #[command(flatten)]
    pub(crate) run: RunArguments,
}

impl Press {
    pub(crate) fn asked(&self) -> Asked<'_> {
        let options = [
            self.adhesion.question(),
            self.limits.strict.then_some(Question::Limits),
            self.fields.field_points.map(|_| Question::Fields),
            self.gradient.question(),
        ];
        Asked {
            case: &self.case,
            run: &self.run,
            floor: Some(&self.floor),
            range: Some(self.adhesion),
            questions: [Question::Press]
                .into_iter()
                .chain(options.into_iter().flatten())
                .collect(),
            request: Request::Contact(self.load.load()),
            details: Details {
                gradient: self.gradient.gradient,
                maps: self.fields.maps(&self.case),
                ..Details::default()
            },
            course: None,
            instantaneous: self.modulus.instantaneous,
        }
    }
}

#[derive(Debug, Args)]
pub(crate) struct Approach {
    #[command(flatten)]
    pub(crate) case: CaseArguments,
    /// Indentation step between states (m, mm, um, nm; a bare number in m); default as in the experiments
    #[arg(long, value_name = "LENGTH", default_value = "1um", value_parser = length, allow_hyphen_values = true)]
    step: f64,
    /// Continue to this indentation, past the critical state if that is reached earlier (m, mm, um, nm)
    #[arg(long, value_name = "LENGTH", value_parser = length, allow_hyphen_values = true, conflicts_with_all = ["to_force", "until"])]
    to: Option<f64>,
    /// Continue to this force, past the critical state if that is reached earlier (N, mN, uN, nN)
    #[arg(long, value_name = "FORCE", value_parser = force, allow_hyphen_values = true, conflicts_with = "until")]
    to_force: Option<f64>,
    /// Stop at this indentation, or at the critical state if that is reached earlier
    #[arg(long, value_name = "LENGTH", value_parser = length, allow_hyphen_values = true)]
    until: Option<f64>,
    /// Load viscoelastic bodies (a case with [relaxation]) at this rate of the indentation or of the force, as 1um/s or 10uN/s; the states
    /// are then those of the time steps
    #[arg(long, value_name = "RATE", value_parser = rate, allow_hyphen_values = true)]
    rate: Option<(f64, Dimension)>,
    /// Continue --until past the critical state, as --to does
    #[arg(long, requires = "until", hide = true)]
    past_transition: bool,
    #[command(flatten)]
    pub(crate) floor: FloorArguments,
    #[command(flatten)]
    pub(crate) run: RunArguments,
}

impl Approach {
    pub(crate) fn asked(&self) -> Result<Asked<'_>, Failure> {
        let path = self.path()?;
        if let Some(course) = ramp_at(self.rate, path.end, false)? {
            return Ok(Asked {
                course: Some(course),
                ..Asked::over_time(&self.case, &self.run, &self.floor)
            });
        }
        Ok(Asked {
            case: &self.case,
            run: &self.run,
            floor: Some(&self.floor),
            range: None,
            questions: vec![Question::Approach],
            request: Request::Loading(path),
            details: self.case.details(),
            course: None,
            instantaneous: false,
        })
    }

    fn path(&self) -> Result<LoadingPath, Failure> {
        if !(self.step > 0.0 && self.step.is_finite()) {
            return Err(Failure::Argument(
                "--step must be a length greater than 0".to_owned(),
            ));
        }
        Ok(LoadingPath {
            step: self.step,
            end: LoadingEnd::of(self.until, self.past_transition, self.to, self.to_force)?,
        })
    }
}

/// A load over time, of viscoelastic bodies.
#[derive(Debug, Args)]
#[command(group = ArgGroup::new("held").required(true).args(["indentation", "force", "protocol"]))]
pub(crate) struct Hold {
    #[command(flatten)]
    pub(crate) case: CaseArguments,
    #[command(flatten)]
    load: LoadArguments,
    /// Table of ramps: a column time_s, and one of displacement_m, indentation_m or force_N, in any unit; the first value is reached at once
    #[arg(long, value_name = "CSV")]
    protocol: Option<PathBuf>,
    /// Duration of the hold (s, ms, min, h)
    #[arg(long = "for", value_name = "TIME", value_parser = time, allow_hyphen_values = true, required_unless_present = "protocol", conflicts_with = "protocol")]
    duration: Option<f64>,
    /// Time in which the load is reached (s, ms, min, h)
    #[arg(long, value_name = "TIME", value_parser = time, allow_hyphen_values = true, default_value = "0", conflicts_with = "protocol")]
    ramp: f64,
    /// Take the load back after the hold, in the time --ramp
    #[arg(long, conflicts_with = "protocol")]
    back: bool,
    #[command(flatten)]
    pub(crate) floor: FloorArguments,
    #[command(flatten)]
    pub(crate) run: RunArguments,
}

impl Hold {
    /// The question, of which the relaxation is added from the case.
    pub(crate) fn asked(&self) -> Result<Asked<'_>, Failure> {
        let course = match &self.protocol {
            Some(path) => HistoryCourse::Protocol(read_protocol(path).map_err(Failure::Argument)?),
            None => HistoryCourse::Hold {
                load: self.load.load(),
                ramp: not_negative("--ramp", self.ramp)?,
                duration: not_negative("--for", self.duration.unwrap_or(0.0))?,
                back: self.back,
            },
        };
        Ok(Asked {
            course: Some(course),
            ..Asked::over_time(&self.case, &self.run, &self.floor)
        })
    }
}

fn not_negative(option: &str, value: f64) -> Result<f64, Failure> {
    if value >= 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err(Failure::Argument(format!(
            "{option} is {value} s: it must be 0 or greater"
        )))
    }
}

/// A ramp at a rate, if one is given.
fn ramp_at(
    rate: Option<(f64, Dimension)>,
    end: LoadingEnd,
    back: bool,
) -> Result<Option<HistoryCourse>, Failure> {
    let Some((rate, dimension)) = rate else {
        return Ok(None);
    };
    if !(rate > 0.0 && rate.is_finite()) {
        return Err(Failure::Argument(
            "--rate must be greater than 0, as 1um/s".to_owned(),
        ));
    }
    let prescribed = match dimension {
        Dimension::Force => Prescribed::Force,
        _ => Prescribed::Indentation,
    };
    let end = match end {
        LoadingEnd::At(load) => load,
        LoadingEnd::CriticalOr(_) => {
            return Err(Failure::Argument(
                "with --rate give --to or --to-force instead of --until".to_owned(),
            ));
        }
    };
    match (prescribed, end) {
        (Prescribed::Force, Load::Indentation(_)) | (Prescribed::Indentation, Load::Force(_)) => {
            Err(Failure::Argument(
                "a rate of the indentation, as 1um/s, goes with --to, a rate of the force, as 10uN/s, with --to-force".to_owned(),
            ))
        }
        _ => Ok(Some(HistoryCourse::Ramp {
            prescribed,
            rate,
            end,
            back,
        })),
    }
}

#[derive(Debug, Args)]
pub(crate) struct Cycle {
    #[command(flatten)]
    pub(crate) case: CaseArguments,
    /// Load and unload viscoelastic bodies (a case with [relaxation]) at this rate of the indentation or of the force, as 1um/s or 10uN/s
    #[arg(long, value_name = "RATE", value_parser = rate, allow_hyphen_values = true, conflicts_with_all = ["drive", "machine_stiffness", "attraction_range"])]
    rate: Option<(f64, Dimension)>,
    /// Load to this indentation (m, mm, um, nm)
    #[arg(long, value_name = "LENGTH", value_parser = length, allow_hyphen_values = true, conflicts_with = "to_force")]
    to: Option<f64>,
    /// Load to this force (N, mN, uN, nN)
    #[arg(long, value_name = "FORCE", value_parser = force, allow_hyphen_values = true)]
    to_force: Option<f64>,
    /// Quantity held fixed while contacts attach or detach
    #[arg(long, value_name = "WHAT", value_enum, default_value_t = HeldLoad::Displacement)]
    drive: HeldLoad,
    /// Move the lens by a testing machine of this stiffness, whose crosshead position is fixed while contacts attach or detach (N/m, mN/m,
    /// kN/m; a bare number in N/m)
    #[arg(long, value_name = "STIFFNESS", value_parser = stiffness, allow_hyphen_values = true, conflicts_with = "drive")]
    machine_stiffness: Option<f64>,
    #[command(flatten)]
    pub(crate) adhesion: RangeArguments,
    #[command(flatten)]
    pub(crate) floor: FloorArguments,
    #[command(flatten)]
    pub(crate) run: RunArguments,
}

impl Cycle {
    pub(crate) fn asked(&self) -> Result<Asked<'_>, Failure> {
        let end = LoadingEnd::of(None, false, self.to, self.to_force)?;
        if let Some(course) = ramp_at(self.rate, end, true)? {
            return Ok(Asked {
                course: Some(course),
                ..Asked::over_time(&self.case, &self.run, &self.floor)
            });
        }
        Ok(Asked {
            case: &self.case,
            run: &self.run,
            floor: Some(&self.floor),
            range: Some(self.adhesion),
            questions: vec![Question::Cycle],
            request: Request::Cycle(self.plan()?),
            details: self.case.details(),
            course: None,
            instantaneous: false,
        })
    }

    fn plan(&self) -> Result<CyclePlan, Failure> {
        let turn = match LoadingEnd::of(None, false, self.to, self.to_force)? {
            LoadingEnd::At(load) => load,
            LoadingEnd::CriticalOr(indentation) => Load::Indentation(indentation),
        };
        let drive = match (self.machine_stiffness, self.drive) {
            (Some(stiffness), _) => LoadingMode::Machine(stiffness),
            (None, HeldLoad::Displacement) => LoadingMode::Displacement,
            (None, HeldLoad::Force) => LoadingMode::Force,
        };
        Ok(CyclePlan {
            turn: turn.into(),
            drive,
            retract: true,
        })
    }
}

/// Quantity held fixed while contacts attach or detach.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum HeldLoad {
    /// The indentation
    Displacement,
    /// The force
    Force,
}

#[derive(Debug, Args)]
#[command(group = ArgGroup::new("load").args(["indentation", "force"]))]
pub(crate) struct Verify {
    #[command(flatten)]
    pub(crate) case: CaseArguments,
    #[command(flatten)]
    pub(crate) load: LoadArguments,
    /// Square cells across a pillar on the finer mesh, 16 if not given, across the contact with a flat surface, 64 if not given, or across every
    /// contact on rounded tops, 32 if not given; the other mesh has half as many
    #[arg(long, value_name = "N", value_parser = cells)]
    pub(crate) cells: Option<usize>,
    #[command(flatten)]
    pub(crate) floor: FloorArguments,
    #[command(flatten)]
    pub(crate) run: RunArguments,
}

#[derive(Debug, Args)]
pub(crate) struct Theory {
    #[command(flatten)]
    pub(crate) case: CaseArguments,
    #[command(flatten)]
    pub(crate) adhesion: RangeArguments,
}

#[derive(Debug, Args)]
pub(crate) struct Compare {
    #[command(flatten)]
    pub(crate) case: CaseArguments,
    #[command(flatten)]
    pub(crate) run: RunArguments,
}

#[cfg(feature = "explore")]
#[derive(Debug, Args)]
pub(crate) struct Explore {
    /// Case file (TOML) to start with; `-` for standard input
    pub(crate) case: Option<PathBuf>,
    /// Override a key of the case, as in pattern.pitch=20um; may be repeated
    #[arg(long, value_name = "KEY=VALUE")]
    pub(crate) set: Vec<String>,
    /// Port to listen on; default: any free port
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) port: Option<u16>,
    /// Print the address without opening the browser
    #[arg(long)]
    pub(crate) no_browser: bool,
    /// Threads; 0 for the number of processors, which is the maximum
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(crate) threads: usize,
    /// Memory limit of a computation (kB, MB, GB)
    #[arg(long, value_name = "SIZE", default_value = "2GB", value_parser = memory)]
    pub(crate) memory_limit: usize,
    /// Do not print refused requests
    #[arg(long, short)]
    pub(crate) quiet: bool,
}

#[derive(Debug, Args)]
pub(crate) struct Completions {
    /// The shell
    pub(crate) shell: clap_complete::Shell,
}

#[derive(Debug, Args)]
pub(crate) struct Man {
    /// The command; without it, the page of fakir itself
    pub(crate) command: Option<String>,
}

#[derive(Debug, Args)]
pub(crate) struct Cite {
    /// Folder of results, case file or study file; without it, the references for any use of fakir
    pub(crate) what: Option<PathBuf>,
    /// Cite for this method instead
    #[arg(long, conflicts_with = "what")]
    pub(crate) method: Option<CitedMethod>,
    /// Print entries for BibTeX
    #[arg(long, conflicts_with = "json")]
    pub(crate) bibtex: bool,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// The methods by their names in case files, and the closed forms.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum CitedMethod {
    Spectral,
    Love,
    Punch,
    Homogenised,
    /// The closed forms of `fakir theory`
    Theory,
}

#[derive(Debug, Args)]
#[command(
    group = ArgGroup::new("wanted").args(["critical_force", "critical_contact_radius", "force", "contact_radius", "floor_share", "pull_off", "target"]).requires("free"),
    group = ArgGroup::new("loaded").args(["floor_share", "pull_off", "force", "contact_radius"]),
    group = ArgGroup::new("at").args(["at_force", "at_indentation"]).requires("loaded")
)]
pub(crate) struct Design {
    #[command(flatten)]
    pub(crate) case: CaseArguments,
    #[arg(long, value_name = "KEY", value_parser = free, requires = "wanted", help = format!(
        "Parameter to determine: {}; or heights: the heights of all pillars with rounded tops. The last name is enough if it is unique, as in --free pitch",
        free_names()
    ))]
    free: Option<Free>,
    /// Target critical force (N, mN, uN, nN)
    #[arg(long, value_name = "FORCE", value_parser = force, allow_hyphen_values = true)]
    critical_force: Option<f64>,
    /// Target critical contact radius (m, mm, um, nm)
    #[arg(long, value_name = "LENGTH", value_parser = length, allow_hyphen_values = true)]
    critical_contact_radius: Option<f64>,
    /// Target force of the contact at --at-indentation (N, mN, uN, nN)
    #[arg(long, value_name = "FORCE", value_parser = force, allow_hyphen_values = true, requires = "at_indentation")]
    force: Option<f64>,
    /// Target contact radius at --at-force or --at-indentation (m, mm, um, nm)
    #[arg(long, value_name = "LENGTH", value_parser = length, allow_hyphen_values = true, requires = "at")]
    contact_radius: Option<f64>,
    /// Target pull-off force after the critical state, or after the contact at --at-force or --at-indentation, for a case with adhesion, as a
    /// positive number (N, mN, uN, nN)
    #[arg(long, value_name = "FORCE", value_parser = force, allow_hyphen_values = true)]
    pull_off: Option<f64>,
    /// Target fraction of the load carried by the floor, past the transition: 0.2 or 20%
    #[arg(long, value_name = "SHARE", value_parser = fraction, allow_hyphen_values = true, requires = "at")]
    floor_share: Option<f64>,
    /// Force at which the floor share or the contact radius is specified, or from which the lens is pulled off (N, mN, uN, nN)
    #[arg(long, value_name = "FORCE", value_parser = force, allow_hyphen_values = true)]
    at_force: Option<f64>,
    /// Indentation at which the floor share, the force or the contact radius is specified, or from which the lens is pulled off (m, mm, um, nm)
    #[arg(long, value_name = "LENGTH", value_parser = length, allow_hyphen_values = true)]
    at_indentation: Option<f64>,
    /// Target curve, with --free heights: a CSV file with a heading such as force_mN,area_um2
    #[arg(long, value_name = "CSV", conflicts_with_all = ["tolerance", "samples", "keep_offset"])]
    target: Option<PathBuf>,
    /// Standard deviation of manufactured heights (m, mm, um, nm), for the scatter of the curve
    #[arg(long, value_name = "LENGTH", value_parser = length, allow_hyphen_values = true, requires = "target")]
    height_error: Option<f64>,
    /// Quantity that varies, normally distributed, with its standard deviation as a quantity or in per cent: pattern.pillar.height=0.05um,
    /// substrate.young_modulus=10%; may be repeated
    #[arg(long, value_name = "KEY=DEVIATION", value_parser = tolerance)]
    tolerance: Vec<Tolerance>,
    #[arg(long, value_name = "N", help = format!(
        "Number of samples drawn with these tolerances; {} if there are any, and {} on a height map", Sampling::SAMPLES, Sampling::SAMPLES_ON_MAP
    ))]
    samples: Option<usize>,
    #[arg(long, value_name = "N", help = format!(
        "Seed for the samples, and for the assignment of heights to pillars; default: {}", Sampling::SEED
    ))]
    seed: Option<u64>,
    /// Keep the landing position of the case file, instead of random positions on the lattice
    #[arg(long)]
    keep_offset: bool,
    /// Indentation at which the force of every sample is reported too (m, mm, um, nm); with commas, or repeated
    #[arg(long, value_name = "LENGTH", value_parser = length, value_delimiter = ',', allow_hyphen_values = true)]
    force_at: Vec<f64>,
    #[command(flatten)]
    pub(crate) run: RunArguments,
}

impl Design {
    /// The free parameter and the target.
    pub(crate) fn question(&self) -> Result<Option<(Key, Wanted)>, Failure> {
        let load = Load::given(self.at_indentation, self.at_force);
        let pressed = |value: Option<f64>, quantity| {
            let (value, load) = value.zip(load)?;
            Some(Wanted::Pressed {
                quantity,
                value,
                load,
            })
        };
        let wanted = self
            .critical_force
            .map(Wanted::Force)
            .or(self.critical_contact_radius.map(Wanted::ContactRadius))
            .or(self.pull_off.map(|force| Wanted::PullOff {
                force,
                load: load.unwrap_or(Load::FloorContact),
            }))
            .or(pressed(self.force, PressedQuantity::Force))
            .or(pressed(self.contact_radius, PressedQuantity::ContactRadius))
            .or(self
                .floor_share
                .zip(load)
                .map(|(share, load)| Wanted::FloorShare { share, load }));
        let free = match self.free {
            Some(Free::Heights) => {
                return Err(Failure::Argument(
                    "--free heights requires --target, the target curve".to_owned(),
                ));
            }
            Some(Free::Key(key)) => Some(key),
            None => None,
        };
        if free.is_none() && !self.is_spread() {
            return Err(Failure::Argument(
                "nothing to do: give --free and --critical-force, --force, --pull-off or --floor-share for a design, or \
                 --tolerance or --samples for a spread"
                    .to_owned(),
            ));
        }
        Ok(free.zip(wanted))
    }

    /// The problem of finding heights for a curve, if requested.
    pub(crate) fn heights(&self) -> Result<Option<HeightsQuestion<'_>>, Failure> {
        let Some(target) = &self.target else {
            // The requirement of the target is not checked where it excludes another target that is given.
            return match self.height_error {
                Some(_) => Err(Failure::Argument(
                    "--height-error is of --free heights with --target: for the scatter of another answer give --tolerance \
                     pattern.pillar.height=0.1um"
                        .to_owned(),
                )),
                None => self.check_sampling().map(|()| None),
            };
        };
        if self.free != Some(Free::Heights) {
            return Err(Failure::Argument(
                "--target is the curve of --free heights: give these as what is free".to_owned(),
            ));
        }
        if let Some(error) = self.height_error
            && !(error > 0.0 && error.is_finite())
        {
            return Err(Failure::Argument(
                "--height-error must be a length greater than 0".to_owned(),
            ));
        }
        Ok(Some(HeightsQuestion {
            target,
            height_error: self.height_error,
            seed: self.seed.unwrap_or(Sampling::SEED),
        }))
    }

    /// Refuses options of samples without samples.
    fn check_sampling(&self) -> Result<(), Failure> {
        let given = [
            ("--seed", self.seed.is_some()),
            ("--keep-offset", self.keep_offset),
        ];
        match given.iter().find(|(_, is_given)| *is_given) {
            Some((name, _)) if !self.is_spread() => Err(Failure::Argument(format!(
                "{name} is for the samples of --samples or --tolerance: give one of these too"
            ))),
            _ => Ok(()),
        }
    }

    /// Whether a scatter is requested.
    fn is_spread(&self) -> bool {
        !self.tolerance.is_empty() || self.samples.is_some() || !self.force_at.is_empty()
    }

    /// The sampling, if a scatter is requested.
    pub(crate) fn sampling(&self, kind: SurfaceKind) -> Option<Sampling> {
        self.is_spread().then(|| Sampling {
            tolerances: self.tolerance.clone(),
            landing: if self.keep_offset {
                Landing::AsGiven
            } else {
                Landing::Anywhere
            },
            indentations: self.force_at.clone(),
            samples: self.samples.unwrap_or(Sampling::default_samples(kind)),
            seed: self.seed.unwrap_or(Sampling::SEED),
        })
    }
}

/// Free parameter of a design.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Free {
    /// The value of a key.
    Key(Key),
    /// The heights of all pillars with rounded tops.
    Heights,
}

/// A key that can be free, or all heights.
fn free(text: &str) -> Result<Free, String> {
    if text == "heights" {
        return Ok(Free::Heights);
    }
    let key = free_key(text).map_err(|advice| format!("{advice}, or heights"))?;
    Ok(Free::Key(key))
}

/// A target curve for heights.
#[derive(Debug, Clone, Copy)]
pub(crate) struct HeightsQuestion<'a> {
    /// File of the curve.
    pub(crate) target: &'a Path,
    /// Standard deviation of manufactured heights, m.
    pub(crate) height_error: Option<f64>,
    /// Seed for the assignment of heights to pillars.
    pub(crate) seed: u64,
}

#[derive(Debug, Args)]
pub(crate) struct Fit {
    /// Measured curve of loading, or of loading and unloading: a table as written by instruments (text, .gz, .xlsx), with commas, semicolons,
    /// tabs or blanks, and a unit in the heading of every column, as in force_uN or Load [mN]; several files are fitted separately
    #[arg(required = true, value_name = "DATA")]
    pub(crate) data: Vec<PathBuf>,
    /// Assign a column explicitly, as in force="Channel 2 [mN]" or force="#2 [mN]"; a minus sign before the heading reverses the sign of its values,
    /// and a sensitivity after it converts them, as in force="Deflection [V]*25 nN/V"; may be repeated
    #[arg(long = "column", value_name = "QUANTITY=HEADING", value_parser = NamedColumn::parse)]
    columns: Vec<NamedColumn>,
    /// Spring constant of a cantilever (N/m, mN/m): its deflection is read as the force, and its compliance is the default of
    /// --machine-compliance
    #[arg(long, value_name = "STIFFNESS", value_parser = spring_constant)]
    spring_constant: Option<f64>,
    /// Use these rows alone, numbered from 1: 100:500, 100: or :500
    #[arg(long, value_name = "FIRST:LAST", value_parser = rows)]
    rows: Option<Rows>,
    /// Use one cycle of loading and unloading, numbered from 1
    #[arg(long, value_name = "NUMBER")]
    cycle: Option<usize>,
    /// Use one branch alone
    #[arg(long, value_name = "BRANCH", value_parser = ["loading", "unloading"])]
    branch: Option<String>,
    /// Use loads from this one: a displacement or indentation (m, mm, um, nm), or a force (N, mN, uN, nN) if there is no position
    #[arg(long, value_name = "LOAD", allow_hyphen_values = true)]
    from: Option<String>,
    /// Use loads up to this one
    #[arg(long, value_name = "LOAD", allow_hyphen_values = true)]
    to: Option<String>,
    /// Case file (TOML) with all known quantities and the initial values; `-` for standard input; of files measured on several surfaces, as pillars and a
    /// flat reference, repeated: one for every file, in the same order
    #[arg(long, required = true)]
    case: Vec<PathBuf>,
    /// Free parameters: substrate.young_modulus, lens.young_modulus, lens.radius,
    /// substrate.thickness, lens.thickness, pattern.pillar.height, pattern.pillar.diameter, pattern.top_radius,
    /// pattern.pitch, pattern.offset, pattern.offset_angle, surface.height_unit, surface.height_range, adhesion.work, adhesion.work_receding, contact_point, machine_compliance,
    /// force_offset, displacement_drift, force_drift, force_slope, and with a column of times relaxation.strengths[0],
    /// relaxation.times[0] up to [3]; with commas, or repeated
    #[arg(long, value_name = "KEY", required = true, value_delimiter = ',', value_parser = fitted)]
    pub(crate) free: Vec<Parameter>,
    /// Fit all files together: shared parameters have one value for all files, the others a value for every file
    #[arg(long)]
    pub(crate) joint: bool,
    /// Parameters that are shared, of those that are free; default: all keys of the case, except pattern.offset and pattern.offset_angle
    #[arg(long, value_name = "KEY", requires = "joint", value_delimiter = ',', value_parser = fitted)]
    shared: Vec<Parameter>,
    /// Displacement at which the lens would touch the pillar tops (m, mm, um, nm), or its initial value; default: 0, or estimated from the
    /// data
    #[arg(long, value_name = "LENGTH", value_parser = reading, allow_hyphen_values = true)]
    contact_point: Option<f64>,
    /// Compliance of the instrument, in m/N, or its initial value; default: 0, or the compliance of the cantilever
    #[arg(long, value_name = "M/N", allow_hyphen_values = true)]
    machine_compliance: Option<f64>,
    /// Reading of the instrument at zero force (N, mN, uN, nN), or its initial value; contained in all measured forces
    #[arg(long, value_name = "FORCE", value_parser = force, allow_hyphen_values = true, default_value = "0")]
    force_offset: f64,
    /// Drift of the displacement from the first row to the last (m, mm, um, nm), or its initial value: linear in time if there is a column
    /// of times, otherwise in the row number
    #[arg(long, value_name = "LENGTH", value_parser = length, allow_hyphen_values = true, default_value = "0")]
    displacement_drift: f64,
    /// The same for the force (N, mN, uN, nN)
    #[arg(long, value_name = "FORCE", value_parser = force, allow_hyphen_values = true, default_value = "0")]
    force_drift: f64,
    /// Slope of the reading without any force over the displacement from the first row on (N/m, mN/m), or its initial value: a tilted base
    /// line
    #[arg(long, value_name = "STIFFNESS", value_parser = stiffness, allow_hyphen_values = true, default_value = "0")]
    force_slope: f64,
    /// Start from this many points, the first of which is the case, and take the best fit: avoids local minima; at least 4 if contact_point and
    /// force_slope are free, or if the first search on a flat surface does not converge
    #[arg(long, value_name = "COUNT", default_value_t = 1, value_parser = starts)]
    starts: usize,
    /// Standard error of forces without one in the file (N, mN, uN, nN)
    #[arg(long, value_name = "FORCE", value_parser = force, allow_hyphen_values = true)]
    force_error: Option<f64>,
    /// Standard error of contact radii without one in the file (m, mm, um, nm)
    #[arg(long, value_name = "LENGTH", value_parser = length, allow_hyphen_values = true)]
    contact_radius_error: Option<f64>,
    /// Standard error of displacements or indentations without one in the file (m, mm, um, nm)
    #[arg(long, value_name = "LENGTH", value_parser = length, allow_hyphen_values = true)]
    position_error: Option<f64>,
    /// Override a key of the case file, as in pattern.pitch=20um; may be repeated
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Print JSON instead of tables, in SI units
    #[arg(long)]
    json: bool,
    /// Save the result in this folder, which must be empty or not exist: summary.json, fitted.csv with data and model, the figure fit.svg
    /// and fit.png, the case with the fitted values, and its provenance; for several files fits.csv, the figure fits.svg and fits.png,
    /// fitted.csv and fit.svg of every file in the folder curves, and the case with the mean or shared values
    #[arg(long, value_name = "FOLDER")]
    output: Option<PathBuf>,
    /// Replace all results in the folder; a folder with other files is not changed
    #[arg(long, requires = "output")]
    overwrite: bool,
    /// No progress and no warnings, except if the fit does not describe the data
    #[arg(long, short)]
    quiet: bool,
    /// Exit with status 1 if a validity limit of the model is exceeded under the largest load, or if the fit does not describe the data;
    /// the result is still printed and saved
    #[arg(long)]
    pub(crate) strict: bool,
    #[command(flatten)]
    pub(crate) run: RunArguments,
}

impl Fit {
    /// Cases of single files: one for every file, or none if all have the same.
    pub(crate) fn cases(&self) -> Result<Vec<CaseFile>, Failure> {
        let (cases, files) = (self.case.len(), self.data.len());
        if cases == 1 {
            return Ok(Vec::new());
        }
        if cases != files {
            return Err(Failure::Argument(format!(
                "{cases} cases for {files} files: give one --case for all files, or one for every file"
            )));
        }
        let read = |path: &PathBuf| case_file(path, &self.set);
        self.case.iter().map(read).collect()
    }

    /// The case, of several the first.
    pub(crate) fn case(&self) -> CaseArguments {
        CaseArguments {
            case: self.case[0].clone(),
            set: self.set.clone(),
            json: self.json,
            output: self.output.clone(),
            overwrite: self.overwrite,
            quiet: self.quiet,
        }
    }

    /// The data of a file for its case, with the errors given as arguments where the file has none.
    pub(crate) fn measurements(
        &self,
        path: &Path,
        case: &CaseFile,
    ) -> Result<Measurements, Failure> {
        let hints = Hints {
            named: self.columns.clone(),
            spring_constant: self.spring_constant,
            last_row: self.rows.and_then(|rows| rows.0[1]),
            has_pauses: has_relaxation(case, &self.free)?,
        };
        let mut data = Measurements::read_with(path, &hints)?;
        let dimension = data.load_dimension();
        let load = |name: &str, text: &Option<String>| {
            let load = text.as_deref().map(|text| match dimension {
                Dimension::Force => force(text),
                _ => reading(text),
            });
            load.transpose()
                .map_err(|error| Failure::Argument(format!("{name}: {error}")))
        };
        let branch = self.branch.as_ref().map(|name| match &name[..] {
            "unloading" => Branch::Unloading,
            _ => Branch::Loading,
        });
        data = data.select(&Selection {
            rows: self.rows.map_or([None; 2], |rows| rows.0),
            cycle: self.cycle,
            branch,
            from: load("--from", &self.from)?,
            to: load("--to", &self.to)?,
        })?;
        for (name, error) in [
            ("--force-error", self.force_error),
            ("--contact-radius-error", self.contact_radius_error),
            ("--position-error", self.position_error),
        ] {
            if error.is_some_and(|error| !(error > 0.0 && error.is_finite())) {
                return Err(Failure::Argument(format!("{name} must be greater than 0")));
            }
        }
        if let Some(error) = self.force_error {
            data = data.with_force_error(error);
        }
        if let Some(error) = self.contact_radius_error {
            data = data.with_contact_radius_error(error);
        }
        if let Some(error) = self.position_error {
            data = data.with_position_error(error);
        }
        Ok(data)
    }

    /// The shared parameters of a joint fit.
    pub(crate) fn shared(&self) -> Vec<Parameter> {
        match &self.shared[..] {
            [] => shared_by_default(&self.free),
            shared => shared.to_vec(),
        }
    }

    pub(crate) fn known(&self, data: &Measurements) -> FitOptions {
        let cantilever = data.layout().cantilever_compliance;
        FitOptions {
            contact_point: self.contact_point,
            machine_compliance: self.machine_compliance.or(cantilever).unwrap_or(0.0),
            force_offset: self.force_offset,
            displacement_drift: self.displacement_drift,
            force_drift: self.force_drift,
            force_slope: self.force_slope,
            starts: self.starts,
        }
    }
}

/// The first and the last row.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rows([Option<usize>; 2]);

fn rows(text: &str) -> Result<Rows, String> {
    Selection::parse_rows(text).map(Rows)
}

fn spring_constant(text: &str) -> Result<f64, String> {
    let constant = stiffness(text).map_err(|error| error.to_string())?;
    match constant > 0.0 && constant.is_finite() {
        true => Ok(constant),
        false => Err("a spring constant must be greater than 0".to_owned()),
    }
}

/// Parses a parameter that can be fitted.
fn fitted(text: &str) -> Result<Parameter, String> {
    let named = Parameter::all_named(text.trim());
    match named[..] {
        [parameter] => Ok(parameter),
        [] => Err(one_of(Parameter::names())),
        _ => Err(one_of(named.into_iter().map(Parameter::name))),
    }
}

/// Advice that lists the accepted names.
fn one_of<'a>(names: impl Iterator<Item = &'a str>) -> String {
    format!("give one of {}", names.collect::<Vec<_>>().join(", "))
}

/// Parses `KEY=DEVIATION`, with the deviation as a quantity or in per cent.
fn tolerance(text: &str) -> Result<Tolerance, String> {
    let (path, deviation) = text
        .split_once('=')
        .ok_or("give KEY=DEVIATION, as in pattern.pillar.height=3%")?;
    let path = path.trim();
    let key = match Key::named(path, false)[..] {
        [key] => key,
        [] => return Err(format!("{path} is no key of a case file")),
        ref several => return Err(one_of(several.iter().map(|key| key.path()))),
    };
    if !matches!(key.kind(), Kind::Number(_)) {
        return Err(format!("{path} is no number"));
    }
    let deviation = Deviation::parse(key, deviation).map_err(|error| error.to_string())?;
    Ok(Tolerance { key, deviation })
}

#[derive(Debug, Args)]
pub(crate) struct Sweep {
    /// Study file (TOML): a case file, or the name of one, with the tables [study] and [axes]; `-` for standard input
    pub(crate) study: PathBuf,
    /// Override a key of the case that is not an axis, as in lens.radius=2mm; may be repeated
    #[arg(long, value_name = "KEY=VALUE")]
    pub(crate) set: Vec<String>,
    /// Keep the journal in this folder, and save table.csv, study.toml and provenance.json; builds with the feature parquet also save
    /// table.parquet
    #[arg(long, value_name = "FOLDER")]
    pub(crate) output: Option<PathBuf>,
    /// Continue the sweep in the folder, if there is one
    #[arg(long, requires = "output", conflicts_with = "overwrite")]
    resume: bool,
    /// Start again, and replace all results in the folder; a folder with other files is not changed
    #[arg(long, requires = "output")]
    overwrite: bool,
    /// Compute only this part of the cases, for `fakir merge`: 1/4 to 4/4 for a sweep in four shards
    #[arg(long, value_name = "N/OF", default_value = "1/1", requires = "output")]
    pub(crate) shard: Shard,
    /// Threads that share the cases; 0 for the number of processors, which is the maximum
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(crate) threads: usize,
    /// Memory limit of a single case (kB, MB, GB)
    #[arg(long, value_name = "SIZE", default_value = "8GB", value_parser = memory)]
    pub(crate) memory_limit: usize,
    /// Print JSON, in SI units; without --output with all rows
    #[arg(long)]
    pub(crate) json: bool,
    /// No progress and no warnings
    #[arg(long, short)]
    pub(crate) quiet: bool,
}

impl Sweep {
    pub(crate) fn existing(&self) -> Existing {
        existing(self.resume, self.overwrite)
    }
}

/// Publications that can be reproduced.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Publication {
    /// Phys. Rev. E 104, 055007 (2021)
    Paper,
    /// The study of adhesion that it announced, with an adhesive floor
    Adhesion,
}

#[derive(Debug, Args)]
pub(crate) struct Reproduce {
    /// Publication to reproduce
    #[arg(value_enum)]
    pub(crate) publication: Publication,
    /// Folder for the results, which must be empty or not exist
    #[arg(long, value_name = "FOLDER")]
    pub(crate) output: PathBuf,
    /// Continue to a surface fraction of 0.29, beyond the range in which the experiments reached the transition; takes several times as
    /// long
    #[arg(long)]
    pub(crate) dense: bool,
    /// Surface fractions of the paper from 0.0003 to 0.21; 60 if not given
    #[arg(long, value_name = "N", value_parser = points)]
    pub(crate) points: Option<usize>,
    /// The study of adhesion with fewer cases, in two minutes instead of half an hour
    #[arg(long)]
    pub(crate) quick: bool,
    /// Measured points to plot with the curves: a CSV file with a column surface_fraction, any of critical_force_N,
    /// critical_contact_radius_m and critical_indentation_m, the same with _error before the unit, and substrate (rigid, intermediate or
    /// soft)
    #[arg(long, value_name = "CSV")]
    pub(crate) measured: Option<PathBuf>,
    /// Continue an interrupted run
    #[arg(long, conflicts_with = "overwrite")]
    resume: bool,
    /// Start again, and replace all results in the folder; a folder with other files is not changed
    #[arg(long)]
    overwrite: bool,
    /// Threads; 0 for the number of processors, which is the maximum
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(crate) threads: usize,
    /// Memory limit of a single case (kB, MB, GB)
    #[arg(long, value_name = "SIZE", default_value = "8GB", value_parser = memory)]
    pub(crate) memory_limit: usize,
    /// No progress and no warnings
    #[arg(long, short)]
    pub(crate) quiet: bool,
}

impl Reproduce {
    /// Refuses options of the other publication.
    pub(crate) fn check(&self) -> Result<(), Failure> {
        let (other, options) = match self.publication {
            Publication::Paper => ("adhesion", vec![("--quick", self.quick)]),
            Publication::Adhesion => (
                "paper",
                vec![
                    ("--dense", self.dense),
                    ("--points", self.points.is_some()),
                    ("--measured", self.measured.is_some()),
                ],
            ),
        };
        match options.into_iter().find(|(_, is_given)| *is_given) {
            None => Ok(()),
            Some((name, _)) => Err(Failure::Argument(format!(
                "{name} is for fakir reproduce {other}: leave it out"
            ))),
        }
    }

    pub(crate) fn existing(&self) -> Existing {
        existing(self.resume, self.overwrite)
    }
}

fn existing(resume: bool, overwrite: bool) -> Existing {
    match (resume, overwrite) {
        (true, _) => Existing::Resume,
        (_, true) => Existing::Overwrite,
        _ => Existing::Refuse,
    }
}

/// Parses the number of surface fractions of a curve.
fn points(text: &str) -> Result<usize, String> {
    text.parse()
        .ok()
        .filter(|points| (5..=1000).contains(points))
        .ok_or_else(|| "give a number from 5 to 1000".to_owned())
}

#[derive(Debug, Args)]
pub(crate) struct Merge {
    /// Folder to create for the whole sweep
    pub(crate) folder: PathBuf,
    /// Folders of all shards, in any order
    #[arg(required = true)]
    pub(crate) shards: Vec<PathBuf>,
    /// Replace all results in the folder; a folder with other files is not changed
    #[arg(long)]
    overwrite: bool,
    /// Print JSON, in SI units
    #[arg(long)]
    pub(crate) json: bool,
}

impl Merge {
    pub(crate) fn existing(&self) -> Existing {
        existing(false, self.overwrite)
    }
}

/// Arguments of every command that reads a case.
#[derive(Debug, Args)]
pub(crate) struct CaseArguments {
    /// Case file (TOML); `-` for standard input
    pub(crate) case: PathBuf,
    /// Override a key of the case file, as in pattern.pitch=20um; may be repeated
    ///
    /// The value is TOML, or a bare word or quantity. The last name of a key is sufficient if it is unique, as in pitch=20um. A pitch
    /// replaces the surface fraction of the file and vice versa; method.name replaces the whole table.
    #[arg(long, value_name = "KEY=VALUE")]
    pub(crate) set: Vec<String>,
    /// Print JSON instead of tables, in SI units
    #[arg(long)]
    pub(crate) json: bool,
    /// Save the result in this folder, which must be empty or not exist: summary.json, tables as CSV, fields, figures, the case as it was
    /// solved, and its provenance
    #[arg(long, value_name = "FOLDER")]
    pub(crate) output: Option<PathBuf>,
    /// Replace all results in the folder; a folder with other files is not changed
    #[arg(long, requires = "output")]
    pub(crate) overwrite: bool,
    /// No progress and no warnings
    #[arg(long, short)]
    pub(crate) quiet: bool,
}

impl CaseArguments {
    pub(crate) fn session(&self, run: &RunArguments) -> Result<Session, Failure> {
        Session::start(run, self.quiet, self.output.is_some())
    }

    /// Whether existing results are replaced.
    pub(crate) fn replace(&self) -> Replace {
        if self.overwrite {
            Replace::Allowed
        } else {
            Replace::Refused
        }
    }

    /// All files, if the result is saved.
    fn details(&self) -> Details {
        let maps = match self.output {
            None => Maps::None,
            Some(_) => Maps::Points(None),
        };
        Details {
            maps,
            ..Details::default()
        }
    }
}

/// A load, by an indentation or by a force.
#[derive(Debug, Args)]
pub(crate) struct LoadArguments {
    /// Depth of the lens below the position in which its lowest point is level with the pillar tops: with a unit of length (m, mm, um, nm),
    /// or in m
    #[arg(long, value_name = "LENGTH", value_parser = length, allow_hyphen_values = true)]
    indentation: Option<f64>,
    /// Normal force on the lens: with a unit (N, mN, uN, nN), or in N
    #[arg(long, value_name = "FORCE", value_parser = force, allow_hyphen_values = true)]
    force: Option<f64>,
}

impl LoadArguments {
    /// The given load; the critical state if none is given.
    pub(crate) fn load(&self) -> Load {
        Load::given(self.indentation, self.force).unwrap_or(Load::FloorContact)
    }
}

/// Treatment of the floor.
#[derive(Debug, Args)]
pub(crate) struct FloorArguments {
    /// Ignore floor contact past the transition, as in the paper: floor.contact=false
    #[arg(long)]
    without_floor: bool,
}

impl FloorArguments {
    /// Overrides the corresponding key of the case.
    pub(crate) fn apply(&self, file: &mut CaseFile) -> Result<(), CaseError> {
        if self.without_floor {
            file.set(&format!("{}=false", Key::FloorContact))?;
        }
        Ok(())
    }
}

/// Which modulus of viscoelastic bodies applies.
#[derive(Debug, Clone, Copy, Args)]
pub(crate) struct ModulusArguments {
    /// Use the instantaneous moduli of viscoelastic bodies (a case with [relaxation]), those of fast loads, instead of the relaxed ones
    #[arg(long)]
    instantaneous: bool,
}

/// Whether derivatives are requested.
#[derive(Debug, Clone, Copy, Args)]
pub(crate) struct GradientArguments {
    /// Compute the exact derivatives of force and indentation too, with respect to the numbers of the case and to the height of every
    /// pillar: with the method spectral and without adhesion, also past the transition; or on rounded tops or a flat surface
    #[arg(long)]
    gradient: bool,
}

impl GradientArguments {
    /// The question, if requested.
    pub(crate) fn question(self) -> Option<Question> {
        self.gradient.then_some(Question::Gradient)
    }
}

/// Treatment of results that exceed a validity limit of the model.
#[derive(Debug, Clone, Copy, Args)]
pub(crate) struct LimitArguments {
    /// Exit with status 1 if a validity limit of the model is exceeded; the result is still printed and saved
    #[arg(long)]
    pub(crate) strict: bool,
}

/// Properties of the attraction between lens and pillar tops besides its work.
#[derive(Debug, Clone, Copy, Args)]
pub(crate) struct RangeArguments {
    /// Range of the attraction between lens and adhesive pillar tops (m, mm, um, nm), which determines whether the short-range assumption
    /// of the model holds
    #[arg(long, value_name = "LENGTH", value_parser = attraction, allow_hyphen_values = true)]
    attraction_range: Option<f64>,
}

impl RangeArguments {
    /// The range (m), if it is given; an error for a case that is not adhesive.
    pub(crate) fn of(self, adhesive: bool) -> Result<Option<f64>, Failure> {
        let Some(range) = self.attraction_range else {
            return Ok(None);
        };
        if !(range > 0.0 && range.is_finite()) {
            return Err(Failure::Argument(
                "--attraction-range must be a length greater than 0".to_owned(),
            ));
        }
        if !adhesive {
            return Err(Failure::Argument(
                "--attraction-range needs adhesive pillar tops: give adhesion.work in the case \
                 file, or --set adhesion.work=50mJ/m2"
                    .to_owned(),
            ));
        }
        Ok(Some(range))
    }

    /// The question, if a range is given.
    pub(crate) fn question(self) -> Option<Question> {
        self.attraction_range.map(|_| Question::AttractionRange)
    }
}

/// How the fields of a contact are saved.
#[derive(Debug, Args)]
struct FieldArguments {
    /// Points across the maps of pressure, gap and displacement, fields.nc and fields.vti; with --output
    ///
    /// The maps contain the contact and one more pitch on each side. Default: 12 points across a pillar, but at most 511 in total; on a flat
    /// surface, 201.
    #[arg(long, value_name = "N", requires = "output", value_parser = field_points)]
    field_points: Option<usize>,
}

impl FieldArguments {
    fn maps(&self, case: &CaseArguments) -> Maps {
        match case.output {
            None => Maps::None,
            Some(_) => Maps::Points(self.field_points),
        }
    }
}

/// Parses a quantity of a dimension; a number without a unit must be plausible.
fn quantity(text: &str, dimension: Dimension) -> Result<f64, QuantityError> {
    parse_plausible(text, dimension, dimension.usual())
}

fn length(text: &str) -> Result<f64, QuantityError> {
    quantity(text, Dimension::Length)
}

/// Parses a reading of an instrument, with an arbitrary zero within its travel.
fn reading(text: &str) -> Result<f64, QuantityError> {
    const USUAL: [f64; 2] = [1e-8, 0.1];
    parse_plausible(text, Dimension::Length, Some(USUAL))
}

/// Parses the range of an attraction, at least the size of an atom.
fn attraction(text: &str) -> Result<f64, QuantityError> {
    const USUAL: [f64; 2] = [1e-10, 1e-7];
    parse_plausible(text, Dimension::Length, Some(USUAL))
}

fn force(text: &str) -> Result<f64, QuantityError> {
    quantity(text, Dimension::Force)
}

fn time(text: &str) -> Result<f64, QuantityError> {
    quantity(text, Dimension::Time)
}

/// Parses a rate of the indentation or of the force.
fn rate(text: &str) -> Result<(f64, Dimension), String> {
    parse_rate(text, [Dimension::Length, Dimension::Force])
}

fn stiffness(text: &str) -> Result<f64, QuantityError> {
    quantity(text, Dimension::Stiffness)
}

fn fraction(text: &str) -> Result<f64, QuantityError> {
    quantity(text, Dimension::Fraction)
}

/// Parses the number of points across a map: at least the two ends.
fn field_points(text: &str) -> Result<usize, String> {
    text.parse()
        .ok()
        .filter(|points| (2..=MOST_POINTS).contains(points))
        .ok_or_else(|| format!("give a whole number from 2 to {MOST_POINTS}"))
}

/// Parses the number of starts of a fit.
fn starts(text: &str) -> Result<usize, String> {
    text.parse()
        .ok()
        .filter(|starts| (1..=MOST_STARTS).contains(starts))
        .ok_or_else(|| format!("give a whole number from 1 to {MOST_STARTS}"))
}

/// Parses the number of cells across a pillar; half as many must be sufficient for an error estimate.
fn cells(text: &str) -> Result<usize, String> {
    text.parse()
        .ok()
        .filter(|cells| (16..=1024).contains(cells))
        .ok_or_else(|| "give a whole number from 16 to 1024".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn deprecated_names_of_keys_are_found() {
        let found = |line: &str| {
            let arguments: Vec<OsString> = line.split(' ').map(OsString::from).collect();
            deprecated_keys(&arguments)
        };
        let warning = "texture.pitch is deprecated: use pattern.pitch"; // former name
        for line in [
            "fakir design case.toml --free texture.pitch", // former name
            "fakir fit --free=lens.radius,texture.pitch",  // former name
            "fakir design --tolerance texture.pitch=3%",   // former name
        ] {
            assert_eq!(found(line), [warning], "{line}");
        }
        for line in [
            "fakir design case.toml --free pattern.pitch",
            "fakir design case.toml --set texture.pitch=20um", // former name
        ] {
            assert!(found(line).is_empty(), "{line}");
        }
    }

    /// `cycle` takes the same options; any other use of `approach` is unchanged.
    #[test]
    fn approach_with_retract_is_cycle() {
        let renamed = |line: &str| {
            let arguments = line.split(' ').map(OsString::from).collect();
            let (arguments, renamed) = renamed(arguments);
            let words = arguments.iter().map(|word| word.to_str().unwrap());
            (words.collect::<Vec<_>>().join(" "), renamed)
        };
        let new = renamed("fakir approach case.toml --retract --to 3um");
        assert_eq!(new, ("fakir cycle case.toml --to 3um".to_owned(), true));
        for line in [
            "fakir approach case.toml",
            "fakir press case.toml --retract",
            "fakir approach -- --retract",
        ] {
            assert_eq!(renamed(line), (line.to_owned(), false));
        }
    }
}
