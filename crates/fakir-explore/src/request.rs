//! Requests: a case by its keys, and a load on the path to the critical state.

use crate::refusal::Refusal;
use base64::Engine;
use base64::engine::general_purpose::STANDARD as BASE64;
use fakir::numerics::roots::{self, Point};
use fakir::problem::{
    Arrangement, Base, HexagonalLattice, LensForm, Load, PlaneLattice, Point as Point2, Question,
    ShapedLens, System,
};
use fakir::solve::homogenised;
use fakir_case::table_text::unpack_table;
use fakir_case::unit::{Dimension, format_quantity};
use fakir_case::{AnyCase, AsperityCase, Case, CaseFile, Key, Kind, Setting, SurfaceKind};
use fakir_study::history::HistoryCourse;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::convert::Infallible;
use std::f64::consts::PI;
use std::path::Path;

/// Longest text of a value, bytes.
const LONGEST_TEXT: usize = 100;

/// Longest text of a list of numbers, bytes: some hundred relaxation times with all digits.
const LONGEST_LIST: usize = 4000;

/// Largest number of pillars in a computation; more would take minutes.
pub(crate) const MOST_PILLARS: f64 = 20_000.0;

/// Largest number of rounded tops in contact: seconds.
const MOST_TOPS: usize = 300;

/// Largest number of pillars in a table.
const MOST_LISTED: f64 = 5_000.0;

/// Largest load of a request; the critical state is at 1.
pub(crate) const FARTHEST: f64 = 2.5;

/// Identifies the page of a request, and the request of that page. Of all requests of one kind from
/// a page, only the newest is computed.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
#[cfg_attr(
    not(feature = "server"),
    expect(dead_code, reason = "only the server has several pages")
)]
pub(crate) struct Ticket {
    pub(crate) session: String,
    pub(crate) sequence: u64,
}

/// A case by its keys, as `{"lens.radius": 2.2e-3, ...}`.
pub(crate) type Values = BTreeMap<String, Setting>;

/// A file that the page sends.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct GivenFile {
    pub(crate) name: String,
    /// Its contents.
    base64: String,
}

/// Longest name of a file, bytes.
const LONGEST_NAME: usize = 250;

impl GivenFile {
    pub(crate) fn new(name: String, contents: &[u8]) -> Self {
        let base64 = BASE64.encode(contents);
        Self { name, base64 }
    }

    /// Its contents, unpacked, of at most `largest` bytes. `key` names it in errors.
    pub(crate) fn contents(&self, key: &str, largest: u64) -> Result<Vec<u8>, Refusal> {
        unpack_table(Path::new(&self.name), self.bytes(key)?, largest)
            .map_err(|error| Refusal::impossible(format!("{}: {error}", self.name)).at(key))
    }

    /// Its contents as they were given. `key` names it in errors.
    pub(crate) fn bytes(&self, key: &str) -> Result<Vec<u8>, Refusal> {
        if self.name.len() > LONGEST_NAME {
            return Err(Refusal::impossible("the name of the file is too long").at(key));
        }
        BASE64
            .decode(&self.base64)
            .map_err(|error| Refusal::malformed(format!("not such a file: {error}")))
    }
}

/// `POST /api/contact`, `/api/cycle`, and `/api/phase`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct AtLoad {
    pub(crate) ticket: Ticket,
    pub(crate) case: Values,
    /// Contents of the table of pillars, if the case names one.
    #[serde(default)]
    pub(crate) table: Option<GivenFile>,
    #[serde(default)]
    pub(crate) load: LoadPoint,
}

/// `POST /api/curves`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Curves {
    pub(crate) ticket: Ticket,
    pub(crate) case: Values,
    /// Contents of the table of pillars, if the case names one.
    #[serde(default)]
    pub(crate) table: Option<GivenFile>,
}

/// `POST /api/export`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Export {
    pub(crate) ticket: Ticket,
    pub(crate) case: Values,
    /// Contents of the table of pillars, if the case names one.
    #[serde(default)]
    pub(crate) table: Option<GivenFile>,
    #[serde(default)]
    pub(crate) load: LoadPoint,
    /// The load over time, if it is shown.
    #[serde(default)]
    pub(crate) hold: Option<GivenHold>,
    pub(crate) file: String,
}

/// A load, as a position on the path from first contact to the critical state; with adhesion, 1 to 2 is the unloading, up to the
/// last detachment.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct LoadPoint {
    /// 0 at first contact, 1 at the critical state, larger beyond it.
    pub(crate) fraction: f64,
    /// Critical indentation, m, if known.
    #[serde(default)]
    pub(crate) critical_indentation_m: Option<f64>,
}

impl Default for LoadPoint {
    fn default() -> Self {
        Self {
            fraction: 1.0,
            critical_indentation_m: None,
        }
    }
}

impl LoadPoint {
    pub(crate) fn is_critical(&self) -> bool {
        (self.fraction - 1.0).abs() < 1e-9
    }

    pub(crate) fn check(&self) -> Result<(), Refusal> {
        if !(0.0..=FARTHEST).contains(&self.fraction) {
            return Err(Refusal::impossible(format!("cannot be {}", self.fraction))
                .at("load.fraction")
                .accepted(format!(
                    "it must be from 0, first touch, to {FARTHEST}; the critical state is at 1"
                )));
        }
        match self.critical_indentation_m {
            Some(value) if !(value > 0.0 && value.is_finite()) => {
                Err(Refusal::impossible(format!("cannot be {value}"))
                    .at("load.critical_indentation_m")
                    .accepted("leave it out, or give a length in m greater than 0"))
            }
            _ => Ok(()),
        }
    }
}

/// Longest duration of a ramp or a hold, s: thirty years.
const LONGEST: f64 = 1e9;

/// A load that is reached in a time and then held.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(non_snake_case)] // names end in the symbol of the unit
pub(crate) struct GivenHold {
    /// Whether an indentation or a force is held.
    by: By,
    /// Indentation, m, or force, N.
    load: f64,
    /// Duration of the ramp, s; 0 for a step.
    ramp_s: f64,
    /// Duration of the hold, s.
    hold_s: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
enum By {
    Indentation,
    Force,
}

impl GivenHold {
    pub(crate) fn load(&self) -> Load {
        match self.by {
            By::Indentation => Load::Indentation(self.load),
            By::Force => Load::Force(self.load),
        }
    }

    pub(crate) fn times(&self) -> [f64; 2] {
        [self.ramp_s, self.hold_s]
    }

    pub(crate) fn course(&self) -> HistoryCourse {
        HistoryCourse::Hold {
            load: self.load(),
            ramp: self.ramp_s,
            duration: self.hold_s,
            back: false,
        }
    }

    pub(crate) fn check(&self) -> Result<(), Refusal> {
        let refused = |name: &str, value: f64, accepted: &str| {
            Err(Refusal::impossible(format!("{name} cannot be {value}"))
                .at(format!("hold.{name}"))
                .accepted(accepted))
        };
        if !(self.load > 0.0 && self.load.is_finite()) {
            return refused("load", self.load, "a load greater than 0");
        }
        let is_time = |time: f64| (0.0..=LONGEST).contains(&time);
        if !is_time(self.ramp_s) {
            return refused("ramp", self.ramp_s, "a time from 0 s to 1e9 s");
        }
        if !(is_time(self.hold_s) && self.hold_s + self.ramp_s > 0.0) {
            return refused(
                "hold",
                self.hold_s,
                "a time up to 1e9 s, greater than 0 without a ramp",
            );
        }
        Ok(())
    }
}

/// Shapes of the lens that the page supports. A table of heights is a file, and a punch is no lens.
pub(crate) const LENSES: [&str; 4] = ["sphere", "paraboloid", "cylinder", "plate"];

/// Arrangements that the page supports.
pub(crate) const LATTICES: [&str; 4] = ["hexagonal", "square", "rectangular", "oblique"];

/// Whether the page has a control for a key: it supports [lattices](LATTICES), but no listed
/// pillars.
pub(crate) fn is_on_page(key: Key) -> bool {
    let without_control = [
        Key::Pillars,
        Key::AxisX,
        Key::AxisY,
        Key::LensProfile,
        Key::RelaxationTable,
    ];
    let is_of_other_bases = key.is_of_layers() && !is_thickness(key);
    let is_of_maps = key.is_of_surface() && key != Key::Flat;
    !without_control.contains(&key) && !is_of_other_bases && !is_of_maps
}

/// Whether a key is the thickness of a body, which is a half-space unless it is given.
pub(crate) fn is_thickness(key: Key) -> bool {
    [Key::SubstrateThickness, Key::LensThickness].contains(&key)
}

/// Whether a key is one of the lens or the substrate that has a control on the page.
pub(crate) fn is_of_bodies(key: Key) -> bool {
    is_on_page(key) && key.is_on_flat() && key.table() != "adhesion"
}

/// The values of a case with any surface, in SI units; of a height map those of its bodies, which are the others of the example.
pub(crate) fn of_any_case(case: &AnyCase) -> Values {
    let given = |setting: &dyn Fn(Key) -> Option<Setting>| {
        let on_page = Key::ALL.into_iter().filter(|key| is_on_page(*key));
        on_page
            .filter_map(|key| Some((key.path().to_owned(), setting(key)?)))
            .collect()
    };
    match case {
        AnyCase::Pillars(case) => of_case(case),
        AnyCase::Asperities(case) => given(&|key| case.setting(key)),
        AnyCase::Flat(case) => {
            let mut values: Values = given(&|key| case.setting(key));
            values.insert(
                Key::Flat.path().to_owned(),
                Setting::Word("true".to_owned()),
            );
            values
        }
        AnyCase::HeightMap(file) => {
            let mut values = of_case(&Case::example());
            let of_bodies = Key::ALL.into_iter().filter(|key| is_of_bodies(*key));
            for key in of_bodies {
                if let Some(setting) = file.setting(key) {
                    values.insert(key.path().to_owned(), setting);
                }
            }
            values
        }
    }
}

/// The values of a case, in SI units. A relaxation that was fitted to a table is given by its terms.
pub(crate) fn of_case(case: &Case) -> Values {
    let mut values: Values = Key::ALL
        .into_iter()
        .filter(|key| is_on_page(*key))
        .filter_map(|key| Some((key.path().to_owned(), case.setting(key)?)))
        .collect();
    if let Some(relaxation) = &case.relaxation {
        let terms = || relaxation.terms().iter();
        let strengths = terms().map(|term| format_quantity(term.strength, Dimension::Number));
        let times = terms().map(|term| format_quantity(term.time, Dimension::Time));
        for (key, items) in [
            (Key::RelaxationStrengths, strengths.collect::<Vec<_>>()),
            (Key::RelaxationTimes, times.collect()),
        ] {
            values.insert(key.path().to_owned(), Setting::Word(items.join(", ")));
        }
    }
    values
}

/// Largest size of a table of pillars, unpacked, bytes.
const LARGEST_TABLE: u64 = 8_000_000;

/// The keys of the given values.
pub(crate) fn settings(values: &Values) -> Result<Vec<(Key, Setting)>, Refusal> {
    let each = values.iter();
    each.map(|(path, value)| {
        let key = known(path)?;
        Ok((key, short(key, value)?.clone()))
    })
    .collect()
}

/// The case of the given values, as a case file.
pub(crate) fn file(values: &Values, table: Option<&GivenFile>) -> Result<CaseFile, Refusal> {
    let file = CaseFile::from_settings("the page", settings(values)?);
    let Some(Setting::Word(named)) = values.get(Key::Pillars.path()) else {
        return Ok(file);
    };
    // No file is read from the disk.
    let Some(table) = table.filter(|table| table.name == *named) else {
        let words = format!("the table of pillars `{named}` is not part of a link");
        return Err(Refusal::impossible(words)
            .at(Key::Lattice.path())
            .accepted("open the file again, or choose a lattice"));
    };
    let contents = table.contents(Key::Lattice.path(), LARGEST_TABLE)?;
    let file = file.with_table(named, &contents);
    let axis = [Key::AxisX, Key::AxisY];
    if axis.iter().any(|key| values.contains_key(key.path())) {
        return Ok(file);
    }
    let centres: Vec<Point2> = match file.any_case(&[])? {
        AnyCase::Pillars(case) => match case.system.arrangement() {
            Arrangement::Listed(list) => list.pillars().iter().map(|it| it.centre).collect(),
            _ => return Ok(file),
        },
        AnyCase::Asperities(case) => {
            let tops = case.field.asperities().iter();
            tops.map(|top| top.apex).collect()
        }
        AnyCase::HeightMap(_) | AnyCase::Flat(_) => return Ok(file),
    };
    let middle = middle_pillar(&centres).map(Setting::Number);
    let settings = settings(values)?.into_iter();
    let settings = settings.chain(axis.into_iter().zip(middle));
    Ok(CaseFile::from_settings("the page", settings).with_table(named, &contents))
}

/// Position of the pillar nearest to the middle of all pillars, m: the lens axis, unless it is given.
fn middle_pillar(centres: &[Point2]) -> Point2 {
    let middle = [0, 1].map(|axis| {
        let ends = centres.iter().map(|centre| centre[axis]);
        let (low, high) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| {
            (low.min(at), high.max(at))
        });
        0.5 * (low + high)
    });
    let distance = |[x, y]: Point2| (x - middle[0]).hypot(y - middle[1]);
    let nearest = centres.iter().copied();
    nearest
        .min_by(|one, other| distance(*one).total_cmp(&distance(*other)))
        .unwrap_or_default()
}

/// Builds the case of the given values, with any surface that the page shows beside the sliders.
pub(crate) fn any_case(values: &Values, table: Option<&GivenFile>) -> Result<AnyCase, Refusal> {
    let file = file(values, table)?;
    if file.surface_kind() == SurfaceKind::Pillars {
        return Ok(AnyCase::Pillars(Box::new(case(values, table)?)));
    }
    let case = file.any_case(&[Question::Explore])?;
    if let AnyCase::Asperities(case) = &case {
        check_tops(case)?;
    }
    Ok(case)
}

/// Refusal of a height map among the sliders.
pub(crate) fn on_a_height_map() -> Refusal {
    Refusal::impossible("a height map is shown in a panel of its own")
        .at(Key::HeightMap.path())
        .accepted("open the file on the page, or give the case to fakir explore")
}

/// Refuses so many rounded tops that their contact takes minutes, with the command that computes it.
fn check_tops(case: &AsperityCase) -> Result<(), Refusal> {
    // Under a load at which the undeformed lens reaches the floor far from its axis.
    let lens = case.field.indenter().lens();
    let radius = lens.and_then(ShapedLens::radius).unwrap_or(f64::INFINITY);
    let reach = 2.0 * (2.0 * radius * case.height).sqrt();
    let is_reached = |[x, y]: Point2| x.hypot(y) < reach;
    let tops = case.field.asperities().iter();
    let touched = tops.filter(|top| is_reached(top.apex)).count();
    if touched <= MOST_TOPS {
        return Ok(());
    }
    let key = match case.lattice() {
        Some(_) => Key::Columns,
        None => Key::Lattice,
    };
    let words = format!(
        "about {touched} rounded tops would be touched, whose critical state takes minutes"
    );
    Err(Refusal::impossible(words).at(key.path()).accepted(format!(
        "at most {MOST_TOPS}: fewer columns, a wider pitch or lower pillars; or save the case file, for `fakir transition fakir-case.toml`"
    )))
}

/// Builds the case of the given values.
pub(crate) fn case(values: &Values, table: Option<&GivenFile>) -> Result<Case, Refusal> {
    let file = file(values, table)?;
    if file.surface_kind() != SurfaceKind::Pillars {
        let words = "the page shows this for pillars with flat tops";
        return Err(Refusal::impossible(words)
            .at(match file.surface_kind() {
                SurfaceKind::Asperities => Key::TopRadius.path(),
                _ => Key::Flat.path(),
            })
            .accepted(
                "save the case file: `fakir cycle`, `fakir hold` and `fakir fit` compute it",
            ));
    }
    let case = file.case()?;
    if let Arrangement::Listed(list) = case.system.arrangement() {
        let pillars = list.pillars().len();
        if pillars as f64 > MOST_LISTED {
            let words = format!(
                "a table of {pillars} pillars is more than the page computes while one waits"
            );
            return Err(Refusal::impossible(words)
                .at(Key::Lattice.path())
                .accepted(format!(
                    "at most {MOST_LISTED} pillars; `fakir transition` has no such limit"
                )));
        }
    }
    if let Some((key, shown, words)) = not_shown(&case) {
        let accepted = format!("{words}; fakir transition and fakir press answer all others");
        return Err(Refusal::impossible(shown).at(key.path()).accepted(accepted));
    }
    check_size(&case)?;
    Ok(case)
}

/// First part of a case that the page does not support: its key, what the page supports, and the
/// accepted values.
pub(crate) fn not_shown(case: &Case) -> Option<(Key, &'static str, &'static str)> {
    let is_shown = LATTICES.contains(&case.system.arrangement().name());
    if !is_shown && table_of(case.setting(Key::Pillars)).is_none() {
        let words = "the page shows pillars on lattices and those of a table";
        return Some((
            Key::Lattice,
            words,
            "hexagonal, square, rectangular, oblique or listed",
        ));
    }
    if case.system.lens().form() == LensForm::Profile {
        return Some((
            Key::LensShape,
            "the page has no tables of heights of a lens",
            "sphere, paraboloid, cylinder or plate",
        ));
    }
    for (layer, key) in [
        (case.system.substrate_layer(), Key::SubstrateBase),
        (case.system.lens_layer(), Key::LensBase),
    ] {
        if layer.is_some_and(|layer| layer.base != Base::Rigid) {
            let words = "the page shows layers bonded to a rigid base";
            return Some((key, words, "rigid"));
        }
    }
    None
}

/// The file with the pillars of a case, from its setting of [`Key::Pillars`].
pub(crate) fn table_of(pillars: Option<Setting>) -> Option<String> {
    match pillars {
        Some(Setting::Word(path)) if !path.is_empty() => Some(path),
        _ => None,
    }
}

/// Returns the key with that path.
fn known(path: &str) -> Result<Key, Refusal> {
    Key::at(path).ok_or_else(|| {
        let shown: String = path.chars().take(LONGEST_TEXT).collect();
        Refusal::impossible("unknown key")
            .at(shown)
            .accepted("the keys of a case file, as in pattern.pillar.diameter")
    })
}

/// Returns the value, unless it is a text longer than any valid one.
fn short(key: Key, value: &Setting) -> Result<&Setting, Refusal> {
    let longest = match key.kind() {
        Kind::List(_) => LONGEST_LIST,
        _ => LONGEST_TEXT,
    };
    match value {
        Setting::Word(text) if text.len() > longest => {
            Err(Refusal::impossible("this text is too long")
                .at(key.path())
                .accepted(format!("at most {longest} bytes")))
        }
        _ => Ok(value),
    }
}

/// Refuses a pattern with too many pillars in contact.
fn check_size(case: &Case) -> Result<(), Refusal> {
    let pillars = expected_pillars(&case.system);
    if pillars <= MOST_PILLARS {
        return Ok(());
    }
    let (key, accepted) = match case.value(Key::Pitch) {
        None => {
            let limit = largest_fraction(&case.system, MOST_PILLARS);
            let limit = (limit * 1e3).floor() / 1e3;
            (Key::SurfaceFraction, format!("up to {limit}"))
        }
        Some(_) => {
            let limit = largest_fraction(&case.system, MOST_PILLARS);
            // If the other pitch is fixed, the surface fraction is inversely proportional to this one.
            let ratio = case.system.pattern().surface_fraction() / limit;
            let power = if case.value(Key::PitchY).is_some() {
                1.0
            } else {
                0.5
            };
            let pitch = case.system.pitch() * ratio.powf(power);
            (Key::Pitch, format!("from {:.4} um", pitch * 1e6))
        }
    };
    Err(Refusal::impossible(format!(
        "about {} pillars would be touched, more than can be solved for while one waits",
        significant(pillars)
    ))
    .at(key.path())
    .accepted(format!(
        "with all else as it is, {accepted}; or lower pillars, a smaller lens, or \
         `fakir transition`, which has no such limit"
    )))
}

/// Formats a number with two digits.
pub(crate) fn significant(value: f64) -> String {
    let size = 10f64.powf(value.abs().log10().floor() - 1.0);
    format!("{}", (value / size).round() * size)
}

/// The same without adhesion.
pub(crate) fn without_adhesion(case: &Case) -> Case {
    let mut plain = case.clone();
    plain.system = case.system.without_adhesion();
    plain
}

/// Approximate number of pillars in contact at the critical state, from the dense limit of the
/// homogenised lattice; the error is at most 30 % if there are many.
pub(crate) fn expected_pillars(system: &System) -> f64 {
    let lens = system.lens();
    let radius = match (lens.sphere(), lens.radius()) {
        // A contact cannot be wider than the lens.
        (Some(sphere), _) => homogenised::dense_limit(system)
            .contact_radius()
            .min(sphere.radius),
        // Twice as wide as where the undeformed lens reaches the floor.
        (None, Some(radius)) if lens.is_axisymmetric() => {
            2.0 * (2.0 * radius * system.pillar().height).sqrt()
        }
        _ => f64::INFINITY,
    };
    let pillars = PI * radius * radius / system.arrangement().cell_area();
    let all = match system.arrangement() {
        Arrangement::Lattice(PlaneLattice {
            columns: Some(columns),
            ..
        }) => f64::from(*columns).powi(2),
        _ => f64::MAX,
    };
    if pillars.is_nan() {
        all
    } else {
        pillars.min(all)
    }
}

/// Largest surface fraction at which at most the given number of pillars is expected to be in
/// contact.
pub(crate) fn largest_fraction(system: &System, pillars: f64) -> f64 {
    /// At this surface fraction pillars are so far apart that no lens is in contact with too many
    /// of them.
    const LEAST: f64 = 1e-6;
    let excess = |fraction: f64| {
        at_fraction(system, fraction).map_or(f64::INFINITY, |system| {
            (expected_pillars(&system) / pillars).ln()
        })
    };
    let ends = [LEAST, system.pattern().surface_fraction()].map(|position| Point {
        position,
        value: excess(position),
    });
    match roots::find(ends, 0.0, |fraction| Ok::<_, Infallible>(excess(fraction))) {
        Ok(root) => root.map_or(LEAST, |root| root.below.position),
    }
}

/// The same system at another surface fraction; `None` for listed pillars.
pub(crate) fn at_fraction(system: &System, fraction: f64) -> Option<System> {
    let diameter = system.pillar().diameter;
    let arrangement = match system.arrangement() {
        Arrangement::Hexagonal(lattice) => Arrangement::from(HexagonalLattice {
            pitch: HexagonalLattice::with_surface_fraction(fraction, diameter).pitch,
            ..*lattice
        }),
        Arrangement::Lattice(lattice) => {
            let ratio = (system.arrangement().surface_fraction(diameter) / fraction).sqrt();
            Arrangement::from(lattice.stretched(ratio))
        }
        _ => return None,
    };
    system.with_arrangement(arrangement).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The values as in a case file, quantities with their units.
    fn values(case: &Case) -> Values {
        Key::ALL
            .into_iter()
            .filter_map(|key| {
                let text = case.value(key)?;
                let value = match text.parse() {
                    Ok(number) => Setting::Number(number),
                    Err(_) => Setting::Word(text.trim_matches('"').to_owned()),
                };
                Some((key.path().to_owned(), value))
            })
            .collect()
    }

    #[test]
    fn the_case_is_that_of_a_case_file_to_the_bit() {
        let example = Case::example();
        assert_eq!(case(&values(&example), None).unwrap(), example);
        let mut in_si = values(&example);
        in_si.insert("lens.radius".to_owned(), Setting::Number(2.2e-3));
        assert_eq!(case(&in_si, None).unwrap(), example);
        assert_eq!(case(&of_case(&example), None).unwrap(), example);
    }

    /// A table of moduli over ten decades has up to forty terms.
    #[test]
    fn relaxing_bodies_are_given_by_their_terms() {
        let mut relaxing = values(&Case::example());
        let word = |unit: &str| {
            let terms = (0..40).map(|k| format!("{}{unit}", 1.0 / 3.0 + f64::from(k)));
            Setting::Word(terms.collect::<Vec<_>>().join(", "))
        };
        relaxing.insert(Key::RelaxationStrengths.path().to_owned(), word(""));
        relaxing.insert(Key::RelaxationTimes.path().to_owned(), word(" s"));
        let found = case(&relaxing, None).unwrap();
        assert_eq!(found.relaxation.as_ref().unwrap().terms().len(), 40);
        // The values of the case give the same case again.
        assert_eq!(case(&of_case(&found), None).unwrap(), found);
    }

    /// A half-space has no thickness; only rigid bases are supported.
    #[test]
    fn films_are_shown_on_rigid_bases() {
        let mut film = values(&Case::example());
        assert!(!film.keys().any(|path| path.ends_with("thickness")));
        film.insert("substrate.thickness".to_owned(), Setting::Number(2e-4));
        let layered = case(&film, None).unwrap();
        let expected = fakir::problem::Layer::new(2e-4);
        assert_eq!(layered.system.substrate_layer(), Some(&expected));
        assert_eq!(
            of_case(&layered)["substrate.thickness"],
            Setting::Number(2e-4)
        );
        let sliding = Setting::Word("frictionless".to_owned());
        film.insert("substrate.base".to_owned(), sliding);
        let message = serde_json::to_string(&case(&film, None).unwrap_err()).unwrap();
        assert!(message.contains("\"key\":\"substrate.base\""), "{message}");
    }

    #[test]
    fn too_many_pillars_are_refused_with_what_is_accepted() {
        let mut dense = values(&Case::example());
        dense.insert("pattern.surface_fraction".to_owned(), Setting::Number(0.6));
        let refusal = case(&dense, None).unwrap_err();
        let message = serde_json::to_string(&refusal).unwrap();
        assert!(
            message.contains("\"key\":\"pattern.surface_fraction\""),
            "{message}"
        );
        assert!(
            message.contains("with all else as it is, up to 0."),
            "{message}"
        );
    }

    /// At the largest surface fraction, the expected number of pillars equals the allowed number.
    #[test]
    fn the_largest_surface_fraction_has_the_most_pillars() {
        let system = at_fraction(&Case::example().system, 0.6).unwrap();
        let fraction = largest_fraction(&system, MOST_PILLARS);
        let pillars = expected_pillars(&at_fraction(&system, fraction).unwrap());
        assert!((pillars / MOST_PILLARS - 1.0).abs() < 1e-12, "{pillars}");
    }

    #[test]
    fn texts_cannot_break_out_of_their_quotes() {
        for text in ["\"\nlens.radius = 1", "\\", "\u{7f}\u{0}", "a\"b"] {
            let mut odd = values(&Case::example());
            odd.insert("method.name".to_owned(), Setting::Word(text.to_owned()));
            let message = serde_json::to_string(&case(&odd, None).unwrap_err()).unwrap();
            assert!(message.contains("\"key\":\"method.name\""), "{message}");
        }
    }
}
