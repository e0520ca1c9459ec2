//! References to cite for a computation, from `citations.toml`.
//!
//! A [`Topic`] is a feature that was used; [`citations`] returns the references of several topics, each with a short reason. The formulas
//! themselves are cited in the crate `fakir`.

use fakir::problem::{Arrangement, Boundary, Interactions, MeshLayout, Method, PunchForm};
use fakir_case::study::Asked;
use fakir_case::{AsperityCase, Case, FlatCase, Study, SurfaceCase, SurfaceKind, SurfaceOrigin};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::sync::LazyLock;

/// DOI of the paper that defines the problem: R. Ledesma-Alonso, E. Raphaël, F. Restagno, C. Poulard, Phys. Rev. E 104, 055007 (2021).
pub const REFERENCE_DOI: &str = "10.1103/PhysRevE.104.055007";

/// A feature with references to cite.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Topic {
    /// A method for lattices of pillars.
    Method(Method),
    /// Adhesive pillar tops.
    Adhesion,
    /// The range of the attraction of adhesive tops.
    AttractionRange,
    /// The closed forms of an adhesive floor.
    AdhesiveFloor,
    /// The closed forms of the paper, with their lattice sums.
    ClosedForms,
    /// Fits of measured curves.
    LeastSquares,
    /// Bodies of finite thickness.
    Layers,
    /// A flat surface.
    Flat,
    /// Rounded pillar tops.
    Asperities,
    /// An interaction that does not change the normal contact, by its [name](fakir::problem::Interactions::names).
    Interaction(&'static str),
    /// Viscoelastic bodies over time.
    Viscoelastic,
    /// Adhesion of rounded pillar tops.
    AdhesiveAsperities,
    /// Adhesion on a height map.
    AdhesiveSurface,
    /// Heights of rounded tops for a target curve.
    DesignedHeights,
    /// Boundary elements on a height map.
    Surface {
        /// Whether the surface is periodic; otherwise it is free.
        periodic: bool,
        /// Whether its pillars are placed at random.
        random: bool,
    },
}

impl Topic {
    /// Topics of a case.
    #[must_use]
    pub fn of_case(case: &Case) -> Vec<Self> {
        Self::of_case_with_range(case, None)
    }

    /// Topics of a case with an optional range of the attraction (m).
    #[must_use]
    pub fn of_case_with_range(case: &Case, range: Option<f64>) -> Vec<Self> {
        let adhesive = !case.system.adhesion().is_none();
        [Self::Method(case.method)]
            .into_iter()
            .chain(adhesive.then_some(Self::Adhesion))
            .chain(case.system.adhesion().floor.then_some(Self::AdhesiveFloor))
            .chain(case.system.has_layers().then_some(Self::Layers))
            .chain(range.map(|_| Self::AttractionRange))
            .collect()
    }

    /// Topics of a case with rounded tops, with an optional range of the attraction (m).
    #[must_use]
    pub fn of_asperities(case: &AsperityCase, range: Option<f64>) -> Vec<Self> {
        let adhesive = !case.field.adhesion().is_none();
        [Self::Asperities]
            .into_iter()
            .chain(adhesive.then_some(Self::AdhesiveAsperities))
            .chain(case.field.adhesion().floor.then_some(Self::AdhesiveSurface))
            .chain(case.field.has_layers().then_some(Self::Layers))
            .chain(range.map(|_| Self::AttractionRange))
            .collect()
    }

    /// The same for a flat surface.
    #[must_use]
    pub fn of_flat(case: &FlatCase, range: Option<f64>) -> Vec<Self> {
        let system = &case.system;
        [Self::Flat]
            .into_iter()
            .chain((!system.adhesion().is_none()).then_some(Self::Adhesion))
            .chain(system.has_layers().then_some(Self::Layers))
            .chain(range.map(|_| Self::AttractionRange))
            .collect()
    }

    /// Topics of interactions that do not change the normal contact.
    #[must_use]
    pub fn of_interactions(interactions: &Interactions) -> Vec<Self> {
        let names = interactions.names().into_iter();
        names.map(Self::Interaction).collect()
    }

    /// Topics of a case with a general surface.
    #[must_use]
    pub fn of_surface(case: &SurfaceCase) -> Vec<Self> {
        let random = match &case.origin {
            SurfaceOrigin::HeightMap(_) => false,
            SurfaceOrigin::Pattern(pattern) => {
                matches!(pattern.arrangement, Arrangement::Random(_))
            }
        };
        let surface = Self::Surface {
            periodic: case.system.boundary() == Boundary::Periodic,
            random,
        };
        let is_adhesive = !case.system.adhesion().is_none();
        let adhesion = is_adhesive.then_some(Self::AdhesiveSurface);
        std::iter::once(surface).chain(adhesion).collect()
    }

    /// Topics of the cases of a study.
    #[must_use]
    pub fn of_study(study: &Study) -> Vec<Self> {
        let patterns = study.methods().into_iter().map(Self::Method);
        let surfaces = study.surfaces().iter().map(|surface| Self::Surface {
            periodic: surface.boundary == Boundary::Periodic,
            random: surface.is_random,
        });
        let adhesion = study.has_adhesion().then_some(match study.surface_kind() {
            SurfaceKind::Asperities => Self::AdhesiveAsperities,
            SurfaceKind::HeightMap => Self::AdhesiveSurface,
            _ => Self::Adhesion,
        });
        let floor = (study.asked() == Asked::Collapse).then_some(Self::AdhesiveFloor);
        let layers = study.has_layers().then_some(Self::Layers);
        let viscoelastic = (study.asked() == Asked::Hold).then_some(Self::Viscoelastic);
        let of_kind = match study.surface_kind() {
            SurfaceKind::Asperities => Some(Self::Asperities),
            SurfaceKind::Flat => Some(Self::Flat),
            SurfaceKind::Pillars | SurfaceKind::HeightMap => None,
        };
        patterns
            .chain(adhesion)
            .chain(floor)
            .chain(layers)
            .chain(viscoelastic)
            .chain(of_kind)
            .chain(surfaces)
            .chain(study.interactions().iter().copied().map(Self::Interaction))
            .collect()
    }
}

/// Kind of reference.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// An article in a journal.
    Article,
    /// A book.
    Book,
    /// A program.
    Software,
}

/// A reference to cite, and the reason.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Citation {
    /// Its BibTeX key.
    pub key: String,
    /// Whether it is an article, a book or a program.
    pub kind: Kind,
    /// Its authors, with their initials first.
    pub authors: Vec<String>,
    /// Its title.
    pub title: String,
    /// The journal of an article, the publisher of a book.
    pub published_in: Option<String>,
    /// Volume of the journal.
    pub volume: Option<String>,
    /// Pages, or the number of the article.
    pub pages: Option<String>,
    /// Year of publication; none for a program.
    pub year: Option<u16>,
    /// Version of a program.
    pub version: Option<String>,
    /// Digital object identifier, if known with certainty.
    pub doi: Option<String>,
    /// The reason for citing it.
    pub why: String,
}

impl Citation {
    /// The citation in one line: authors, title, journal or publisher, year, and the link of the DOI.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = format!("{}, {}", self.authors.join(", "), self.title);
        let journal = self.kind == Kind::Article;
        for (part, separator) in [
            (&self.published_in, ", "),
            (&self.volume, " "),
            (&self.pages, ", "),
            (&self.version, " "),
        ] {
            if let Some(part) = part {
                let _ = write!(text, "{separator}{part}");
            }
        }
        if let Some(year) = self.year {
            let _ = match journal {
                true => write!(text, " ({year})"),
                false => write!(text, ", {year}"),
            };
        }
        if let Some(doi) = &self.doi {
            let _ = write!(text, ", https://doi.org/{doi}");
        }
        text
    }

    /// A BibTeX entry.
    #[must_use]
    pub fn bibtex(&self) -> String {
        let (entry, container) = match self.kind {
            Kind::Article => ("article", "journal"),
            Kind::Book => ("book", "publisher"),
            Kind::Software => ("software", "organization"),
        };
        let pages = self.pages.as_ref().map(|pages| pages.replace('-', "--"));
        let fields = [
            ("author", Some(self.bibtex_authors())),
            // Braces preserve capitals, for instance of names.
            ("title", Some(format!("{{{}}}", self.title))),
            (container, self.published_in.clone()),
            ("volume", self.volume.clone()),
            ("pages", pages),
            ("year", self.year.map(|year| year.to_string())),
            ("version", self.version.clone()),
            ("doi", self.doi.clone()),
        ];
        let mut text = format!("@{entry}{{{},\n", self.key);
        for (name, value) in fields {
            if let Some(value) = value {
                let _ = writeln!(text, "  {name} = {{{}}},", escaped(&value));
            }
        }
        text + "}\n"
    }

    /// Authors joined by `and`; those of a program as one name.
    fn bibtex_authors(&self) -> String {
        match self.kind {
            Kind::Software => format!("{{{}}}", self.authors.join(", ")),
            _ => self.authors.join(" and "),
        }
    }
}

/// Replaces letters beyond ASCII by commands that every TeX supports.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '^' => escaped.push_str("\\^{}"),
            'é' => escaped.push_str("{\\'e}"),
            'ë' => escaped.push_str("{\\\"e}"),
            'ü' => escaped.push_str("{\\\"u}"),
            'ö' => escaped.push_str("{\\\"o}"),
            'ä' => escaped.push_str("{\\\"a}"),
            'ú' => escaped.push_str("{\\'u}"),
            'ß' => escaped.push_str("{\\ss}"),
            '&' => escaped.push_str("\\&"),
            other => escaped.push(other),
        }
    }
    escaped
}

/// References for these topics: the paper and fakir itself, then those of each topic; a reference of several topics appears once, with all
/// reasons.
#[must_use]
pub fn citations(topics: &[Topic]) -> Vec<Citation> {
    let mut citations: Vec<Citation> = sources("reference").collect();
    citations.push(fakir());
    let names = topics.iter().flat_map(Topic::names);
    for source in names.flat_map(sources) {
        match citations.iter_mut().find(|known| known.key == source.key) {
            None => citations.push(source),
            Some(known) if known.why.contains(&source.why) => {}
            Some(known) => {
                known.why.push_str("; ");
                known.why.push_str(&source.why);
            }
        }
    }
    citations
}

/// Reference to the program.
fn fakir() -> Citation {
    Citation {
        key: "fakir".to_owned(),
        kind: Kind::Software,
        authors: vec!["the fakir developers".to_owned()],
        title: "fakir".to_owned(),
        published_in: None,
        volume: None,
        pages: None,
        year: None,
        version: Some(env!("CARGO_PKG_VERSION").to_owned()),
        doi: None,
        why: "the program; its version belongs to the result".to_owned(),
    }
}

impl Topic {
    /// The corresponding topics in the data.
    fn names(&self) -> Vec<&'static str> {
        match self {
            Self::Method(Method::Spectral(_)) => vec!["spectral"],
            Self::Method(Method::Punch(PunchForm::Plain)) => vec!["punch_plain"],
            Self::Method(Method::Punch(PunchForm::Corrected)) => vec!["punch_corrected"],
            Self::Method(Method::Love(mesh)) if mesh.layout == MeshLayout::Pattern => {
                vec!["love", "elements", "free_space"]
            }
            Self::Method(Method::Love(_)) => vec!["love", "elements"],
            Self::Method(Method::Homogenised) => vec!["homogenised"],
            Self::Method(_) => Vec::new(), // a new method must name its sources here
            Self::Adhesion => vec!["adhesion"],
            Self::AttractionRange => vec!["attraction_range"],
            Self::AdhesiveFloor => vec!["stuck_floor"],
            Self::ClosedForms => vec!["closed_forms"],
            Self::LeastSquares => vec!["least_squares"],
            Self::Layers => vec!["layers"],
            Self::Flat => vec!["flat"],
            Self::Asperities => vec!["rounded_tops"],
            Self::Interaction(name) => vec![name],
            Self::Viscoelastic => vec!["viscoelastic"],
            Self::AdhesiveAsperities => vec!["adhesive_rounded_tops"],
            Self::AdhesiveSurface => vec!["adhesive_surface"],
            Self::DesignedHeights => vec!["designed_heights"],
            Self::Surface { periodic, random } => {
                let around = if *periodic { "periodic" } else { "free_space" };
                let mut names = vec!["elements", around];
                if *random {
                    names.push("random");
                }
                names
            }
        }
    }
}

/// The works and topics of `citations.toml`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Data {
    works: Vec<Work>,
    topics: BTreeMap<String, Vec<Source>>,
}

/// A reference in `citations.toml`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Work {
    key: String,
    kind: Kind,
    authors: Vec<String>,
    title: String,
    published_in: String,
    volume: Option<String>,
    pages: Option<String>,
    year: u16,
    doi: Option<String>,
}

/// A reason to cite a reference.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Source {
    work: String,
    why: String,
}

static DATA: LazyLock<Data> = LazyLock::new(|| {
    toml::from_str(include_str!("citations.toml")).expect("the tests read this file")
});

/// The sources of a topic of the data.
fn sources(topic: &str) -> impl Iterator<Item = Citation> {
    DATA.topics[topic].iter().map(|source| {
        let mut works = DATA.works.iter();
        let work = works.find(|work| work.key == source.work);
        let work = work.expect("the tests find every work");
        Citation {
            key: work.key.clone(),
            kind: work.kind,
            authors: work.authors.clone(),
            title: work.title.clone(),
            published_in: Some(work.published_in.clone()),
            volume: work.volume.clone(),
            pages: work.pages.clone(),
            year: Some(work.year),
            version: None,
            doi: work.doi.clone(),
            why: source.why.clone(),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use fakir::problem::ElementMesh;
    use fakir_case::{CaseFile, StudyFile};

    fn every_topic() -> Vec<Topic> {
        let mesh = ElementMesh::default();
        let methods = [
            Method::default(),
            Method::Punch(PunchForm::Plain),
            Method::Punch(PunchForm::Corrected),
            Method::Love(mesh),
            Method::Love(ElementMesh {
                layout: MeshLayout::Pattern,
                ..mesh
            }),
            Method::Homogenised,
        ];
        let surface = |periodic, random| Topic::Surface { periodic, random };
        methods
            .map(Topic::Method)
            .into_iter()
            .chain([
                Topic::Adhesion,
                Topic::AttractionRange,
                Topic::AdhesiveFloor,
                Topic::ClosedForms,
                Topic::Layers,
                Topic::Flat,
                Topic::Asperities,
                Topic::Interaction("friction"),
                Topic::Viscoelastic,
                Topic::AdhesiveAsperities,
                Topic::AdhesiveSurface,
                Topic::DesignedHeights,
                surface(true, false),
                surface(false, true),
            ])
            .collect()
    }

    #[test]
    fn every_topic_has_sources_beyond_the_paper_and_the_program() {
        for topic in every_topic() {
            let citations = citations(&[topic]);
            assert_eq!(citations[0].doi.as_deref(), Some(REFERENCE_DOI));
            assert_eq!(citations[1].key, "fakir");
            assert!(citations.len() > 2, "{topic:?}");
        }
        assert_eq!(citations(&[]).len(), 2);
    }

    /// Every topic of the data refers to existing references, every reference is cited, and the paper is the one whose DOI is in the
    /// provenance of results.
    #[test]
    fn the_data_are_complete() {
        let mut cited: Vec<String> = DATA
            .topics
            .keys()
            .flat_map(|topic| sources(topic))
            .map(|citation| citation.key)
            .collect();
        cited.sort();
        cited.dedup();
        let mut works: Vec<&String> = DATA.works.iter().map(|work| &work.key).collect();
        works.sort();
        assert_eq!(cited.iter().collect::<Vec<_>>(), works);
        let topics = [every_topic(), vec![Topic::LeastSquares]].concat();
        let named = topics.iter().flat_map(Topic::names).chain(["reference"]);
        let mut named: Vec<&str> = named.collect();
        named.sort_unstable();
        named.dedup();
        assert_eq!(named, DATA.topics.keys().collect::<Vec<_>>());
        assert_eq!(citations(&[])[0].doi.as_deref(), Some(REFERENCE_DOI));
    }

    #[test]
    fn adhesive_cases_cite_adhesion() {
        let mut file = CaseFile::parse("case", &Case::example().to_toml()).unwrap();
        let method = Topic::Method(Method::default());
        assert_eq!(Topic::of_case(&file.case().unwrap()), [method]);
        file.set("adhesion.work=50mJ/m2").unwrap();
        let adhesive = Topic::of_case(&file.case().unwrap());
        assert_eq!(adhesive, [method, Topic::Adhesion]);
        let cited = citations(&adhesive);
        assert!(cited.iter().any(|work| work.key == "Kendall1971"));
        // A study cites it if any of its cases has adhesion.
        let study = |works: &str| {
            let example = Case::example().to_toml();
            let text = format!("[axes]\n\"adhesion.work\" = [{works}]\n{example}");
            Topic::of_study(&StudyFile::parse("study", &text).unwrap().study().unwrap())
        };
        assert_eq!(study("0, 0.05"), adhesive);
        assert_eq!(study("0"), [method]);
    }

    #[test]
    fn works_are_cited_once_with_all_reasons() {
        let citations = citations(&every_topic());
        let mut keys: Vec<_> = citations.iter().map(|citation| &citation.key).collect();
        keys.sort();
        keys.dedup();
        assert_eq!(keys.len(), citations.len());
        let johnson = citations.iter().find(|c| c.key == "Johnson1985").unwrap();
        assert_eq!(johnson.why.matches("flat punch").count(), 1);
        assert_eq!(johnson.why.matches("; ").count(), 4);
    }

    #[test]
    fn texts_and_entries() {
        let all = citations(&every_topic());
        let text = |form: fn(&Citation) -> String| all.iter().map(form).collect::<Vec<_>>();
        insta::assert_snapshot!("citations_text", text(Citation::text).join("\n"));
        insta::assert_snapshot!("citations_bibtex", text(Citation::bibtex).join("\n"));
    }

    #[test]
    fn citations_survive_json() {
        for citation in citations(&every_topic()) {
            let json = serde_json::to_string(&citation).unwrap();
            assert_eq!(serde_json::from_str::<Citation>(&json).unwrap(), citation);
        }
    }
}
