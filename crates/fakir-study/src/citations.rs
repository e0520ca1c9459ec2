//! What to cite for what was computed: the sources that the code paths name, as data.
//!
//! A [`Topic`] is something that was made use of; [`citations`] gives the sources of several, each
//! with a few words on why. The formulas themselves are cited where the crate `fakir` has them.

use fakir::problem::MeshLayout;
use fakir::problem::{Method, PunchForm};
use serde::{Deserialize, Serialize};
use std::fmt::Write;

/// DOI of the paper whose problem this is: R. Ledesma-Alonso, E. Raphaël, F. Restagno,
/// C. Poulard, Phys. Rev. E 104, 055007 (2021).
pub const REFERENCE_DOI: &str = "10.1103/PhysRevE.104.055007";

/// Something whose sources are to be cited.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Topic {
    /// A method for lattices of pillars.
    Method(Method),
    /// The closed forms of the paper, with their lattice sums.
    ClosedForms,
    /// Fits of measured curves.
    LeastSquares,
    /// Elements of constant pressure on a height map.
    Surface {
        /// Whether the surface repeats itself; it stands free otherwise.
        periodic: bool,
        /// Whether its pillars are placed at random.
        random: bool,
    },
}

/// What kind of work is cited.
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

/// A work to be cited, and why.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Citation {
    /// A name for it, as in BibTeX.
    pub key: String,
    /// What it is.
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
    /// Digital object identifier, where known for certain.
    pub doi: Option<String>,
    /// What it was used for.
    pub why: String,
}

impl Citation {
    /// In a line: authors, title, journal or publisher, year, and the link of the DOI.
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

    /// An entry for BibTeX.
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
            // Braces keep capitals, as of names.
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

    /// Authors joined by `and`; those of a program are one name.
    fn bibtex_authors(&self) -> String {
        match self.kind {
            Kind::Software => format!("{{{}}}", self.authors.join(", ")),
            _ => self.authors.join(" and "),
        }
    }
}

/// Letters as the commands that every TeX knows.
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
            '&' => escaped.push_str("\\&"),
            other => escaped.push(other),
        }
    }
    escaped
}

/// What to cite for these topics: the paper and fakir itself, then the sources of each, those of
/// several topics once, with all reasons.
#[must_use]
pub fn citations(topics: &[Topic]) -> Vec<Citation> {
    let mut citations = vec![
        LEDESMA_ALONSO_2021.because("the problem, its symbols and reduced variables"),
        fakir(),
    ];
    for (work, why) in topics.iter().flat_map(Topic::sources) {
        match citations.iter_mut().find(|known| known.key == work.key) {
            None => citations.push(work.because(why)),
            Some(known) if known.why.contains(why) => {}
            Some(known) => {
                known.why.push_str("; ");
                known.why.push_str(why);
            }
        }
    }
    citations
}

/// The program that was run.
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

type Source = (&'static Work, &'static str);

impl Topic {
    fn sources(&self) -> Vec<Source> {
        match self {
            Self::Method(method) => method_sources(*method),
            Self::ClosedForms => vec![
                (&LEDESMA_ALONSO_2021, "the closed forms"),
                (&HERTZ_1882, "the lens on the bare substrate"),
                (&BORWEIN_2013, "lattice sums in closed form"),
            ],
            Self::LeastSquares => vec![
                (&LEVENBERG_1944, "the best fit"),
                (&MARQUARDT_1963, "the best fit"),
                (&OREAR_1982, "errors of the load in a fit"),
            ],
            Self::Surface { periodic, random } => {
                let mut sources = ELEMENTS.to_vec();
                if *periodic {
                    sources.push((&JOHNSON_1985, "waves of pressure on a periodic half-space"));
                } else {
                    sources.push(FREE_SPACE);
                }
                if *random {
                    sources.push((&FEDER_1980, "placing pillars at random"));
                }
                sources
            }
        }
    }
}

fn method_sources(method: Method) -> Vec<Source> {
    match method {
        Method::Spectral(_) => vec![
            (
                &COPSON_1947,
                "the eigenfunctions of the loaded disc, in which the pressure is expanded",
            ),
            (
                &FABRIKANT_1991,
                "the eigenfunctions of the loaded disc, in which the pressure is expanded",
            ),
            (&WATSON_1944, "the integrals that couple two pillars"),
            (&JOHNSON_1985, "displacement around a flat punch"),
            (&BOS_1991, "the points at which pressures are kept positive"),
            (&JUDICE_1994, "the contact conditions on a pillar top"),
        ],
        Method::Punch(PunchForm::Plain) => vec![
            (
                &LEDESMA_ALONSO_2021,
                "pillars that act on each other as flat punches",
            ),
            (&JOHNSON_1985, "displacement around a flat punch"),
        ],
        Method::Punch(PunchForm::Corrected) => vec![
            (&JOHNSON_1985, "displacement around a flat punch"),
            (&WATSON_1944, "the integrals that couple two pillars"),
        ],
        Method::Love(mesh) => {
            let mut sources = ELEMENTS.to_vec();
            sources.insert(
                0,
                (&LEDESMA_ALONSO_2016, "the paper's own numerical method"),
            );
            if mesh.layout == MeshLayout::Pattern {
                sources.push(FREE_SPACE);
            }
            sources
        }
        Method::Homogenised => vec![
            (
                &BORWEIN_2013,
                "potential of a lattice of charges in closed form",
            ),
            (
                &SNEDDON_1966,
                "the lens on a half-space under a layer of springs",
            ),
        ],
        _ => Vec::new(), // methods to come name their sources here
    }
}

const ELEMENTS: [Source; 4] = [
    (&LOVE_1929, "displacement by pressure on a rectangle"),
    (&JOHNSON_1985, "displacement by pressure on a rectangle"),
    (
        &POLONSKY_1999,
        "conjugate gradients with contact conditions",
    ),
    (&FRANK_1956, "the bound on the error of the solution"),
];

const FREE_SPACE: Source = (
    &CRANDALL_1994,
    "transforms of the free half-space, without padding",
);

/// A work as it is written down here.
struct Work {
    key: &'static str,
    kind: Kind,
    authors: &'static [&'static str],
    title: &'static str,
    published_in: &'static str,
    volume: &'static str,
    pages: &'static str,
    year: u16,
    doi: &'static str,
}

impl Work {
    fn because(&self, why: &str) -> Citation {
        let some = |text: &str| (!text.is_empty()).then(|| text.to_owned());
        Citation {
            key: self.key.to_owned(),
            kind: self.kind,
            authors: self.authors.iter().map(ToString::to_string).collect(),
            title: self.title.to_owned(),
            published_in: some(self.published_in),
            volume: some(self.volume),
            pages: some(self.pages),
            year: Some(self.year),
            version: None,
            doi: some(self.doi),
            why: why.to_owned(),
        }
    }
}

const fn article(
    key: &'static str,
    authors: &'static [&'static str],
    title: &'static str,
    [journal, volume, pages]: [&'static str; 3],
    year: u16,
    doi: &'static str,
) -> Work {
    Work {
        key,
        kind: Kind::Article,
        authors,
        title,
        published_in: journal,
        volume,
        pages,
        year,
        doi,
    }
}

const fn book(
    key: &'static str,
    authors: &'static [&'static str],
    title: &'static str,
    publisher: &'static str,
    year: u16,
    doi: &'static str,
) -> Work {
    Work {
        key,
        kind: Kind::Book,
        authors,
        title,
        published_in: publisher,
        volume: "",
        pages: "",
        year,
        doi,
    }
}

static LEDESMA_ALONSO_2021: Work = article(
    "LedesmaAlonso2021",
    &[
        "R. Ledesma-Alonso",
        "E. Raphaël",
        "F. Restagno",
        "C. Poulard",
    ],
    "Effect of the density of pillar-patterned substrates on the contact mechanics: Transition from \
     top to mixed contact with a detailed pressure-field description",
    ["Phys. Rev. E", "104", "055007"],
    2021,
    REFERENCE_DOI,
);
static LEDESMA_ALONSO_2016: Work = article(
    "LedesmaAlonso2016",
    &[
        "R. Ledesma-Alonso",
        "E. Raphaël",
        "L. Léger",
        "F. Restagno",
        "C. Poulard",
    ],
    "Stress concentration in periodically rough Hertzian contact: Hertz to soft-flat-punch \
     transition",
    ["Proc. R. Soc. A", "472", "20160235"],
    2016,
    "10.1098/rspa.2016.0235",
);
static HERTZ_1882: Work = article(
    "Hertz1882",
    &["H. Hertz"],
    "Ueber die Berührung fester elastischer Körper",
    ["J. reine angew. Math.", "92", "156-171"],
    1882,
    "10.1515/crll.1882.92.156",
);
static LEVENBERG_1944: Work = article(
    "Levenberg1944",
    &["K. Levenberg"],
    "A method for the solution of certain non-linear problems in least squares",
    ["Q. Appl. Math.", "2", "164-168"],
    1944,
    "10.1090/qam/10666",
);
static MARQUARDT_1963: Work = article(
    "Marquardt1963",
    &["D. W. Marquardt"],
    "An algorithm for least-squares estimation of nonlinear parameters",
    ["J. Soc. Ind. Appl. Math.", "11", "431-441"],
    1963,
    "10.1137/0111030",
);
static OREAR_1982: Work = article(
    "Orear1982",
    &["J. Orear"],
    "Least squares when both variables have uncertainties",
    ["Am. J. Phys.", "50", "912-916"],
    1982,
    "10.1119/1.12972",
);
static LOVE_1929: Work = article(
    "Love1929",
    &["A. E. H. Love"],
    "The stress produced in a semi-infinite solid by pressure on part of the boundary",
    ["Phil. Trans. R. Soc. A", "228", "377-420"],
    1929,
    "10.1098/rsta.1929.0009",
);
static COPSON_1947: Work = article(
    "Copson1947",
    &["E. T. Copson"],
    "On the problem of the electrified disc",
    ["Proc. Edinb. Math. Soc.", "8", "14"],
    1947,
    "",
);
static FRANK_1956: Work = article(
    "Frank1956",
    &["M. Frank", "P. Wolfe"],
    "An algorithm for quadratic programming",
    ["Nav. Res. Logist. Q.", "3", "95-110"],
    1956,
    "10.1002/nav.3800030109",
);
static FEDER_1980: Work = article(
    "Feder1980",
    &["J. Feder"],
    "Random sequential adsorption",
    ["J. Theor. Biol.", "87", "237-254"],
    1980,
    "10.1016/0022-5193(80)90358-6",
);
static BOS_1991: Work = article(
    "Bos1991",
    &["L. Bos"],
    "On certain configurations of points in R^n which are unisolvent for polynomial interpolation",
    ["J. Approx. Theory", "64", "271"],
    1991,
    "",
);
static CRANDALL_1994: Work = article(
    "Crandall1994",
    &["R. E. Crandall", "B. Fagin"],
    "Discrete weighted transforms and large-integer arithmetic",
    ["Math. Comp.", "62", "305"],
    1994,
    "",
);
static JUDICE_1994: Work = article(
    "Judice1994",
    &["J. J. Júdice", "F. M. Pires"],
    "A block principal pivoting algorithm for large-scale strictly monotone linear complementarity \
     problems",
    ["Comput. Oper. Res.", "21", "587"],
    1994,
    "",
);
static POLONSKY_1999: Work = article(
    "Polonsky1999",
    &["I. A. Polonsky", "L. M. Keer"],
    "A numerical method for solving rough contact problems based on the multi-level \
     multi-summation and conjugate gradient techniques",
    ["Wear", "231", "206-219"],
    1999,
    "10.1016/S0043-1648(99)00113-1",
);
static WATSON_1944: Work = book(
    "Watson1944",
    &["G. N. Watson"],
    "A treatise on the theory of Bessel functions, second edition",
    "Cambridge University Press",
    1944,
    "",
);
static SNEDDON_1966: Work = book(
    "Sneddon1966",
    &["I. N. Sneddon"],
    "Mixed boundary value problems in potential theory",
    "North-Holland",
    1966,
    "",
);
static JOHNSON_1985: Work = book(
    "Johnson1985",
    &["K. L. Johnson"],
    "Contact mechanics",
    "Cambridge University Press",
    1985,
    "10.1017/CBO9781139171731",
);
static FABRIKANT_1991: Work = book(
    "Fabrikant1991",
    &["V. I. Fabrikant"],
    "Mixed boundary value problems of potential theory and their applications in engineering",
    "Kluwer",
    1991,
    "",
);
static BORWEIN_2013: Work = book(
    "Borwein2013",
    &[
        "J. M. Borwein",
        "M. L. Glasser",
        "R. C. McPhedran",
        "J. G. Wan",
        "I. J. Zucker",
    ],
    "Lattice sums then and now",
    "Cambridge University Press",
    2013,
    "10.1017/CBO9781139626804",
);

#[cfg(test)]
mod tests {
    use super::*;
    use fakir::problem::ElementMesh;

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
                Topic::ClosedForms,
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

    #[test]
    fn works_are_cited_once_with_all_reasons() {
        let citations = citations(&every_topic());
        let mut keys: Vec<_> = citations.iter().map(|citation| &citation.key).collect();
        keys.sort();
        keys.dedup();
        assert_eq!(keys.len(), citations.len());
        let johnson = citations.iter().find(|c| c.key == "Johnson1985").unwrap();
        assert_eq!(johnson.why.matches("flat punch").count(), 1);
        assert_eq!(johnson.why.matches("; ").count(), 2);
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
