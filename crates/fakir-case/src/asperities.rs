//! Cases whose pillars have rounded tops.

use crate::case::{Spacing, bounds_beside, lower, write_toml};
use crate::error::CaseError;
use crate::file::CaseFile;
use crate::key::{Key, Setting};
use crate::parts::{Flag, MethodName, Parts};
use crate::pillars::{HEIGHT, check_rounded, overlap};
use crate::table::Part;
use fakir::problem::{
    Accuracy, Asperity, AsperityArray, FloorModel, Indenter, InvalidAsperities, InvalidQuantity,
    Layer, LensForm, Material, PillarCompliance, PlaneLattice, Point, Question, ShapedLens, Solver,
};
use std::f64::consts::PI;
use std::ops::Bound;

/// Largest number of pillars with rounded tops: all pillars in contact are solved together.
const MOST_PILLARS: usize = 20_000;

/// Modulus of a rigid plate in a case file: so large that its compliance has no effect in double
/// precision.
const RIGID: Material = Material {
    young_modulus: 1e30,
    poisson_ratio: 0.5,
};

/// Pillars with rounded tops, the indenter and the accuracy, as a case file with `pattern.top_radius` describes them.
///
/// Indentations are measured from the position in which the lens or plate is level with the common pillar,
/// `pattern.pillar.height` above the floor.
#[derive(Debug, Clone, PartialEq)]
pub struct AsperityCase {
    /// The tops and the indenter.
    pub field: AsperityArray,
    /// Accuracy of contacts.
    pub accuracy: Accuracy,
    /// Height of the common pillar above the floor, m.
    pub height: f64,
    compliance: PillarCompliance,
    /// All given keys and their values, as written in a case file.
    settings: Vec<(Key, String)>,
    /// The finite numbers among them, in SI units.
    numbers: Vec<(Key, f64)>,
    /// The finite lattice of the pillars; none if they are listed.
    lattice: Option<PlaneLattice>,
    /// Keys of a lens and their values; empty for a level plate.
    lens: Vec<(Key, Setting)>,
}

impl AsperityCase {
    /// A case of asperities on pillars with the same radius of curvature. `height` is the height of the common pillar, relative to which asperities are
    /// raised. `lens` contains the keys of the lens and their values ([`CaseFile::lens_settings`]); it has no effect for a level plate.
    ///
    /// # Errors
    /// Pillars that are columns and end below the floor.
    pub fn new(
        field: AsperityArray,
        accuracy: Accuracy,
        height: f64,
        compliance: PillarCompliance,
        lens: Vec<(Key, Setting)>,
    ) -> Result<Self, InvalidAsperities> {
        let mut lens = match field.indenter() {
            Indenter::Lens(_) => lens,
            Indenter::Flat(_) => Vec::new(),
        };
        let mut parts = Parts {
            substrate: *field.substrate(),
            ..Parts::default()
        };
        let top_radius = field
            .asperities()
            .first()
            .map_or(f64::NAN, |asperity| asperity.top_radius);
        parts.pattern.top_radius = top_radius;
        parts.pattern.pillar.height = height;
        parts.pattern.pillar.compliance = compliance;
        parts.method.accuracy = accuracy;
        parts.interactions = *field.interactions();
        let mut keys = vec![
            Key::SubstrateYoungModulus,
            Key::SubstratePoissonRatio,
            Key::TopRadius,
            Key::PillarHeight,
            Key::Accuracy,
        ];
        if field.floor_model() == FloorModel::Ignored {
            parts.pattern.floor = FloorModel::Ignored;
            keys.push(Key::FloorContact);
        }
        let adhesion = field.adhesion();
        if !adhesion.is_none() {
            parts.pattern.adhesion.work = adhesion.work;
            keys.push(Key::WorkOfAdhesion);
        }
        if adhesion.floor {
            parts.pattern.adhesion.floor = Flag(true);
            keys.push(Key::AdhesiveFloor);
        }
        if let Some(receding) = adhesion.work_receding {
            parts.pattern.adhesion.work_receding = receding;
            keys.push(Key::RecedingWorkOfAdhesion);
        }
        if field
            .asperities()
            .iter()
            .any(|asperity| asperity.rim_radius.is_some())
        {
            keys.push(Key::PillarCompliance);
        }
        if let Indenter::Flat(material) = field.indenter() {
            parts.shape.form = LensForm::Plate;
            parts.lens.material = material.unwrap_or(RIGID);
            keys.extend([Key::LensShape, Key::LensYoungModulus, Key::LensPoissonRatio]);
        }
        let of_interactions = Key::ALL.into_iter();
        keys.extend(
            of_interactions
                .filter(|key| [Part::Interactions, Part::InteractionsOnFloor].contains(&key.part()))
                .filter(|key| !(key.row().unwritten)(&parts)),
        );
        // The layer of a lens is among its keys.
        let [film, of_indenter] = field.layers();
        parts.substrate_layer.set(film);
        parts.lens_layer.set(of_indenter);
        lens.retain(|(key, _)| !key.is_of_layers());
        for key in Key::ALL.into_iter().filter(|key| key.is_of_layers()) {
            if (key.row().unwritten)(&parts) || key.idle_with(&mut parts).is_some() {
                continue;
            }
            if key.table() == "lens" && field.indenter().lens().is_some() {
                lens.push((key, key.get(&mut parts)));
            } else {
                keys.push(key);
            }
        }
        let of_keys = keys.into_iter().map(|key| (key, key.get(&mut parts)));
        let given: Vec<(Key, Setting)> = of_keys.chain(lens.iter().cloned()).collect();
        let settings = given.iter().map(|(key, value)| (*key, key.written(value)));
        let raised: Vec<f64> = field
            .asperities()
            .iter()
            .map(|asperity| asperity.raised)
            .collect();
        let made = Self {
            settings: settings.collect(),
            numbers: given.iter().filter_map(finite).collect(),
            lattice: None,
            lens,
            field,
            accuracy,
            height,
            compliance,
        };
        made.with_heights(&raised)
    }

    /// The case as a case file with comments. It contains the given keys, with the absolute path of a table of pillars; reading it gives the same case,
    /// bit for bit.
    #[must_use]
    pub fn to_toml(&self) -> String {
        write_toml(|key| self.value(key))
    }

    /// The case as a case file with the pillars in a table next to it, which replaces the description of their
    /// positions.
    #[must_use]
    pub fn to_toml_with_table(&self, name: &str) -> String {
        write_toml(|key| match key {
            Key::Pillars => Some(toml::Value::from(name).to_string()),
            Key::Lattice | Key::AxisX | Key::AxisY | Key::PillarColumns | Key::PillarUnit => None,
            _ => {
                let of_lattice = key.goes_with().is_some_and(|(choice, words)| {
                    choice == Key::Lattice && !words.contains(&"listed")
                });
                self.value(key).filter(|_| !of_lattice)
            }
        })
    }

    /// The value of a key as it is written in a case file; none if it was not given.
    pub(crate) fn value(&self, key: Key) -> Option<String> {
        let setting = self.settings.iter().find(|(given, _)| *given == key);
        setting.map(|(_, value)| value.clone())
    }

    /// The value of a key; none if it was not given.
    #[must_use]
    pub fn setting(&self, key: Key) -> Option<Setting> {
        let written = self.value(key)?;
        let number = self.given_number(key).map(Setting::Number);
        Some(number.unwrap_or_else(|| Setting::Word(written.trim_matches('"').to_owned())))
    }

    /// Finite number of a key, in SI units; `None` if the key was not given. The pitch of a lattice has a number also if its surface
    /// fraction was given.
    #[must_use]
    pub fn number(&self, key: Key) -> Option<f64> {
        let of_lattice = || {
            let lattice = self.lattice.filter(|_| key == Key::Pitch)?;
            Some(lattice.form.pitch())
        };
        self.given_number(key).or_else(of_lattice)
    }

    /// Finite number of a key, if it was given.
    fn given_number(&self, key: Key) -> Option<f64> {
        let mut numbers = self.numbers.iter();
        let given = numbers.find(|(given, _)| *given == key);
        given.map(|(_, value)| *value)
    }

    /// Smallest and largest valid number of a key for fixed values of all other keys, in SI units.
    #[must_use]
    pub fn allowed(&self, key: Key) -> (Bound<f64>, Bound<f64>) {
        let (mut least, mut greatest) = bounds_beside(
            key,
            |other| self.number(other),
            |other| self.given_number(other),
        );
        // A layer is at least as thick as a quarter of the widest pillar.
        let tops = self.field.asperities().iter();
        let widest = tops.filter_map(|top| top.rim_radius).fold(0.0, f64::max);
        match key {
            Key::SubstrateThickness | Key::LensThickness if widest > 0.0 => {
                least = Bound::Included(0.5 * widest);
            }
            Key::PillarDiameter => {
                for layer in self.field.layers().into_iter().flatten() {
                    greatest = lower(greatest, Some(4.0 * layer.thickness));
                }
            }
            _ => {}
        }
        (least, greatest)
    }

    /// The finite lattice of the pillars, with their scatter; `None` for listed pillars.
    #[must_use]
    pub fn lattice(&self) -> Option<PlaneLattice> {
        self.lattice
    }

    /// Smallest distance of neighbouring tops, m; 0 of a single one.
    #[must_use]
    pub fn spacing(&self) -> f64 {
        let asperities = self.field.asperities();
        let places = asperities.iter().enumerate();
        let distances = places.flat_map(|(place, one)| {
            let others = asperities[place + 1..].iter();
            others.map(|other| (one.apex[0] - other.apex[0]).hypot(one.apex[1] - other.apex[1]))
        });
        distances.reduce(f64::min).unwrap_or(0.0)
    }

    /// Keys of the lens and their values; empty for a level plate.
    #[must_use]
    pub fn lens_settings(&self) -> &[(Key, Setting)] {
        &self.lens
    }

    /// Height of every pillar above the floor, m.
    #[must_use]
    pub fn heights(&self) -> Vec<f64> {
        let asperities = self.field.asperities().iter();
        asperities
            .map(|asperity| self.height + asperity.raised)
            .collect()
    }

    /// The table for `pattern.pillars`: position of every pillar relative to the lens axis, its height above the floor, and its diameter if it has one.
    #[must_use]
    pub fn pillar_table(&self) -> String {
        let asperities = self.field.asperities();
        let with_rims = asperities
            .iter()
            .any(|asperity| asperity.rim_radius.is_some());
        let mut text = String::from("x_m,y_m,height_m");
        text.push_str(if with_rims { ",diameter_m\n" } else { "\n" });
        for (asperity, height) in asperities.iter().zip(self.heights()) {
            let [x, y] = asperity.apex;
            text.push_str(&format!("{x:?},{y:?},{height:?}"));
            match asperity.rim_radius {
                Some(radius) if with_rims => text.push_str(&format!(",{:?}\n", 2.0 * radius)),
                _ => text.push('\n'),
            }
        }
        text
    }

    /// The same case with other heights of pillars above the common level, m.
    ///
    /// # Errors
    /// A height that is not finite.
    ///
    /// # Panics
    /// If the number of heights differs from the number of pillars.
    pub fn with_heights(&self, raised: &[f64]) -> Result<Self, InvalidAsperities> {
        let raised = self.field.with_heights(raised)?;
        let modulus = self.field.substrate().young_modulus;
        let asperities = raised.asperities().iter().map(|asperity| Asperity {
            column_compliance: column_compliance(
                self.compliance,
                modulus,
                self.height + asperity.raised,
                asperity.rim_radius.map(|rim| 2.0 * rim),
            ),
            ..*asperity
        });
        let field = AsperityArray::new(
            raised.indenter().clone(),
            *raised.substrate(),
            asperities.collect(),
        )?
        .with_interactions(*raised.interactions())?;
        let [film, of_indenter] = raised.layers().map(Option::<&Layer>::copied);
        let field = field
            .with_adhesion(raised.adhesion())?
            .with_layers(film, of_indenter)?;
        let field = above_floor(field, self.height)?;
        let field = field.with_floor_model(self.field.floor_model());
        Ok(Self {
            field,
            ..self.clone()
        })
    }
}

/// A key with its value, if that is a finite number.
fn finite((key, value): &(Key, Setting)) -> Option<(Key, f64)> {
    match value {
        Setting::Number(value) if value.is_finite() => Some((*key, *value)),
        _ => None,
    }
}

/// The tops above a floor at the foot of the common pillar; without a floor if that has no height.
fn above_floor(field: AsperityArray, height: f64) -> Result<AsperityArray, InvalidQuantity> {
    if height > 0.0 {
        field.with_floor(height)
    } else {
        Ok(field)
    }
}

/// Shortening of a pillar by a unit force, m/N; zero without a diameter.
fn column_compliance(
    compliance: PillarCompliance,
    young_modulus: f64,
    height: f64,
    diameter: Option<f64>,
) -> f64 {
    match (compliance, diameter) {
        (PillarCompliance::Column, Some(diameter)) => {
            4.0 * height / (PI * young_modulus * diameter.powi(2))
        }
        _ => 0.0,
    }
}

/// A lattice with x, y, height and diameter of its pillars, m.
type LatticePillars = (PlaneLattice, Vec<[f64; 4]>);

impl CaseFile {
    /// Whether pillars have rounded tops: `pattern.top_radius`, in the file or as an override.
    #[must_use]
    pub fn is_rounded(&self) -> bool {
        self.entry(Key::TopRadius).is_some()
    }

    /// The case with rounded pillar tops that the file and its overrides describe.
    ///
    /// # Errors
    /// [`CaseError`] for a missing key or an invalid value, an infinite lattice, a method other than the spectral one, and pillars that
    /// cannot be read or that overlap.
    pub fn asperity_case(&self) -> Result<AsperityCase, CaseError> {
        let mut parts = self.parts(Part::OF_PILLARS)?;
        let pillar = parts.pattern.pillar;
        if !self.is_rounded() {
            return Err(self.missing(Key::TopRadius));
        }
        self.check_common_pillar()?;
        self.refuse_with_rounded(&parts)?;
        self.check_bases(&parts)?;
        self.relaxation_of(&parts)?;
        let adhesion = self.adhesion(&parts);
        if adhesion.work_receding.is_some() {
            return Err(self
                .problem(
                    Key::RecedingWorkOfAdhesion,
                    "rounded pillar tops support one work of adhesion",
                )
                .accepted(format!(
                    "leave it out; as {} it gives the pull-off force",
                    Key::WorkOfAdhesion
                )));
        }
        self.check_adhesive_floor(adhesion, parts.pattern.floor)?;
        let top_radius = parts.pattern.top_radius;
        let asperity = |[x, y, height, diameter]: [f64; 4], common: f64| Asperity {
            apex: [x, y],
            raised: height - common,
            top_radius,
            rim_radius: (!diameter.is_nan()).then_some(0.5 * diameter),
            column_compliance: column_compliance(
                pillar.compliance,
                parts.substrate.young_modulus,
                height,
                Some(diameter).filter(|diameter| !diameter.is_nan()),
            ),
        };
        let (shape, _) = self.lens_shape(&parts)?;
        let indenter = Indenter::from(ShapedLens::new(shape, parts.lens.material));
        let lens = match &indenter {
            Indenter::Lens(_) => self.lens_settings()?,
            Indenter::Flat(_) => Vec::new(),
        };
        let field = |pillars: &[[f64; 4]], common: f64| {
            let asperities = pillars.iter().map(|values| asperity(*values, common));
            AsperityArray::new(indenter.clone(), parts.substrate, asperities.collect())?
                .with_interactions(parts.interactions)
                .map_err(InvalidAsperities::Body)
        };
        let (lattice, pillars) = self.lattice_pillars(&parts)?.unzip();
        let (field, height) = match pillars {
            Some(pillars) => {
                self.check_number(Key::Columns, pillars.len())?;
                let field = field(&pillars, pillar.height);
                (
                    field.map_err(|invalid| self.no_asperities(&invalid))?,
                    pillar.height,
                )
            }
            None => {
                let (table, _) = self.pillar_table(&parts.pattern)?;
                check_rounded(&table).map_err(|error| self.no_pillars(&error))?;
                let height = match pillar.height {
                    given if given.is_finite() => given,
                    _ => table.rows.iter().map(|row| row[HEIGHT]).fold(0.0, f64::max),
                };
                self.check_number(Key::Pillars, table.rows.len())?;
                let [x, y] = parts.pattern.axis;
                let moved = table.rows.iter();
                let moved =
                    moved.map(|[a, b, height, diameter]| [a - x, b - y, *height, *diameter]);
                let field = field(&moved.collect::<Vec<_>>(), height);
                let field = field.map_err(|invalid| match invalid {
                    InvalidAsperities::TooClose {
                        asperities,
                        distance,
                        least,
                    } => self.no_pillars(&overlap(&table, asperities, distance, least)),
                    other => self.no_asperities(&other),
                })?;
                (field, height)
            }
        };
        let field = field
            .with_adhesion(adhesion)
            .and_then(|field| {
                field.with_layers(parts.substrate_layer.layer(), parts.lens_layer.layer())
            })
            .and_then(|field| above_floor(field, height))
            .map_err(|invalid| self.impossible(&invalid))?
            .with_floor_model(parts.pattern.floor);
        let keys = self.entries.keys.keys();
        let numbers = keys
            .filter_map(|key| finite(&(*key, key.get(&mut parts))))
            .collect();
        Ok(AsperityCase {
            field,
            accuracy: parts.method.accuracy,
            height,
            compliance: pillar.compliance,
            numbers,
            lattice,
            settings: self.settings(parts),
            lens,
        })
    }

    /// Refuses keys that rounded tops do not support.
    fn refuse_with_rounded(&self, parts: &Parts) -> Result<(), CaseError> {
        self.answers(Question::Press, Solver::Asperities, &self.features(parts))?;
        if parts.method.name != MethodName::Spectral {
            return Err(self
                .problem(
                    Key::MethodName,
                    format!(
                        "this method has flat pillar tops only, and {} is given",
                        Key::TopRadius
                    ),
                )
                .accepted(format!(
                    "{} = \"spectral\" has rounded ones",
                    Key::MethodName
                )));
        }
        let needs_diameter = self.entry(Key::PillarCompliance).is_some()
            && parts.pattern.pillar.compliance == PillarCompliance::Column
            && self.entry(Key::Pillars).is_none();
        if needs_diameter && self.entry(Key::PillarDiameter).is_none() {
            return Err(self.missing(Key::PillarDiameter).accepted(format!(
                "give it, as {} = \"column\" shortens pillars by it; or \"none\"",
                Key::PillarCompliance
            )));
        }
        Ok(())
    }

    /// A lattice with x and y relative to the lens axis, height and diameter of its pillars, m; `None` for listed pillars.
    fn lattice_pillars(&self, parts: &Parts) -> Result<Option<LatticePillars>, CaseError> {
        let pattern = &parts.pattern;
        let diameter = pattern.pillar.diameter;
        let spacing = self.spacing(pattern)?;
        if matches!(spacing, Spacing::SurfaceFraction(_)) && diameter.is_nan() {
            return Err(self.missing(Key::PillarDiameter).accepted(format!(
                "give it, as {} needs it; or give {}",
                Key::SurfaceFraction,
                Key::Pitch
            )));
        }
        let pitch = spacing.pitch(pattern.name, diameter);
        let Some(lattice) = pattern.plane_lattice(pitch) else {
            return Ok(None);
        };
        if lattice.columns.is_none_or(|columns| {
            let columns = columns as usize;
            columns * columns <= 2 * MOST_PILLARS
        }) {
            let apart = if diameter.is_nan() { 0.0 } else { diameter };
            let pillars = lattice
                .cut_pillars(apart)
                .map_err(|invalid| self.impossible(&invalid))?;
            let Some(pillars) = pillars else {
                return Err(self.missing(Key::Columns).accepted(
                    "rounded tops, pattern.top_radius, are those of a finite lattice, or of pattern.pillars",
                ));
            };
            let row =
                |([x, y], ratio): (Point, f64)| [x, y, ratio * pattern.pillar.height, diameter];
            return Ok(Some((lattice, pillars.into_iter().map(row).collect())));
        }
        self.check_number(Key::Columns, usize::MAX)?;
        Ok(None)
    }

    /// Refuses too many pillars.
    fn check_number(&self, key: Key, pillars: usize) -> Result<(), CaseError> {
        if pillars <= MOST_PILLARS {
            return Ok(());
        }
        Err(self
            .problem(key, "these are too many pillars with rounded tops")
            .accepted(format!(
                "at most {MOST_PILLARS}: all that are touched are solved together"
            )))
    }

    /// Error for invalid tops.
    fn no_asperities(&self, invalid: &InvalidAsperities) -> CaseError {
        match invalid {
            InvalidAsperities::Body(invalid) => self.impossible(invalid),
            InvalidAsperities::Concave { .. } => {
                self.problem(Key::LensProfile, invalid.to_string())
            }
            other => self.problem(Key::TopRadius, other.to_string()),
        }
    }
}
