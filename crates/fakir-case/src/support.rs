//! Which question has an answer for which kind of surface: the one table, with the reason where there is none.

/// A kind of surface that a case can have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SurfaceKind {
    /// Pillars with flat tops: a `[texture]`.
    Pillars,
    /// Pillars with rounded tops: a `[texture]` with `top_radius`.
    Asperities,
    /// A height map, or pillars of any cross-section on one: a `[surface]`.
    HeightMap,
}

/// What can be asked of a case.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Capability {
    /// A contact under a load.
    Press,
    /// The critical state.
    Transition,
    /// Loading step by step.
    Approach,
    /// Loading and unloading with adhesion.
    Cycle,
    /// A second method or mesh.
    Verify,
    /// Exact derivatives of a contact.
    Gradient,
    /// The Tabor number of an attraction of a given range.
    AttractionRange,
    /// Validity limits of the model, and `--strict`.
    Limits,
    /// Maps of pressure, gap and displacement.
    Fields,
    /// The closed forms.
    Theory,
    /// The critical state by every method.
    Compare,
    /// The value of a key that gives a wanted result, and the spread of samples.
    Design,
    /// Least squares on a measured curve.
    Fit,
    /// Many cases.
    Sweep,
    /// The page with sliders.
    Explore,
}

/// Why there is no answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Unsupported {
    /// The reason.
    pub why: &'static str,
    /// What to do in its place.
    pub instead: &'static str,
}

impl SurfaceKind {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Pillars, Self::Asperities, Self::HeightMap];

    /// What the table calls it.
    fn heading(self) -> &'static str {
        match self {
            Self::Pillars => "flat pillars (`[texture]`)",
            Self::Asperities => "rounded tops (`texture.top_radius`)",
            Self::HeightMap => "height map (`[surface]`)",
        }
    }
}

impl Capability {
    /// All of them.
    pub const ALL: [Self; 15] = [
        Self::Press,
        Self::Transition,
        Self::Approach,
        Self::Cycle,
        Self::Verify,
        Self::Gradient,
        Self::AttractionRange,
        Self::Limits,
        Self::Fields,
        Self::Theory,
        Self::Compare,
        Self::Design,
        Self::Fit,
        Self::Sweep,
        Self::Explore,
    ];

    /// What the table calls it: the command or the option.
    fn heading(self) -> &'static str {
        match self {
            Self::Press => "`press`",
            Self::Transition => "`transition`",
            Self::Approach => "`approach`",
            Self::Cycle => "`cycle`",
            Self::Verify => "`verify`",
            Self::Gradient => "`--gradient`",
            Self::AttractionRange => "`--attraction-range`",
            Self::Limits => "validity limits, `--strict`",
            Self::Fields => "maps, `--field-points`",
            Self::Theory => "`theory`",
            Self::Compare => "`compare`",
            Self::Design => "`design`",
            Self::Fit => "`fit`",
            Self::Sweep => "`sweep`",
            Self::Explore => "`explore`",
        }
    }

    /// Whether it has an answer for a kind of surface.
    ///
    /// # Errors
    /// [`Unsupported`]: why not, and what to do in its place.
    pub fn of(self, surface: SurfaceKind) -> Result<(), Unsupported> {
        let unsupported = |why, instead| Err(Unsupported { why, instead });
        match (surface, self) {
            (SurfaceKind::Pillars, _)
            | (SurfaceKind::Asperities, Self::Press)
            | (
                SurfaceKind::HeightMap,
                Self::Press
                | Self::Transition
                | Self::Approach
                | Self::Verify
                | Self::Limits
                | Self::Fields
                | Self::Sweep,
            ) => Ok(()),
            (SurfaceKind::Asperities, Self::Gradient) => unsupported(
                "--gradient is for flat pillar tops",
                "leave it out: the result of rounded tops has the stiffness",
            ),
            (SurfaceKind::Asperities, Self::AttractionRange) => unsupported(
                "--attraction-range is for tops that stick, and rounded ones (texture.top_radius) do not",
                "leave it out",
            ),
            (SurfaceKind::Asperities, Self::Limits) => unsupported(
                "--strict is for flat pillars of a [texture] and for a [surface]: contacts with rounded tops have no limits of the model",
                "leave it out",
            ),
            (SurfaceKind::Asperities, Self::Fields) => unsupported(
                "--field-points is for flat tops: there are no maps of the pressure on rounded ones",
                "leave it out: the contacts are in pillars.csv",
            ),
            (SurfaceKind::Asperities, _) => unsupported(
                "this is computed for flat pillar tops only",
                "leave it out; rounded tops are known to `fakir press` and `fakir design --free heights`, in Python to fakir.RoundedTops",
            ),
            (SurfaceKind::HeightMap, Self::Compare) => unsupported(
                "compare sets several methods side by side, and a [surface] has only one: elements",
                "use fakir verify, which solves pillars on a lattice on two meshes, or press and transition, which estimate their error",
            ),
            (SurfaceKind::HeightMap, Self::Theory) => unsupported(
                "the closed forms are those of a [texture], round pillars on a hexagonal lattice; a [surface] has none",
                "use fakir transition and fakir approach, which solve it by elements",
            ),
            (SurfaceKind::HeightMap, Self::Design) => unsupported(
                "design follows a critical state that changes smoothly with the free key; on a [surface] it changes by whole cells, and takes seconds each time",
                "use fakir sweep with the free key as an axis, and read the value from its table",
            ),
            (SurfaceKind::HeightMap, Self::Fit) => unsupported(
                "a fit needs derivatives of the contact; on a [surface] it changes by whole cells, and takes seconds each time",
                "use fakir approach for a loading curve to lay over the measured one, or fakir sweep with the modulus and the indentation as axes",
            ),
            (SurfaceKind::HeightMap, Self::Explore) => unsupported(
                "the sliders of the page need an answer in milliseconds, and a [surface] takes seconds",
                "use fakir press or fakir approach with --output, which save figures",
            ),
            (SurfaceKind::HeightMap, Self::Gradient) => unsupported(
                "derivatives are those of a contact of the method spectral; on a [surface] it changes by whole cells",
                "use fakir sweep with a key as an axis, and take differences over several cells",
            ),
            (SurfaceKind::HeightMap, Self::Cycle) => unsupported(
                "adhesion is that of the round tops of a [texture]; a [surface] has none",
                "ask for the loading alone: without adhesion the lens is withdrawn the way it came",
            ),
            (SurfaceKind::HeightMap, Self::AttractionRange) => unsupported(
                "adhesion is that of the round tops of a [texture]; a [surface] has none",
                "leave the range of the attraction out",
            ),
        }
    }
}

/// What has an answer for which kind of surface, as a table in Markdown, and the reasons where there is none.
#[must_use]
pub fn support() -> String {
    let mut notes: Vec<Unsupported> = Vec::new();
    let headings = SurfaceKind::ALL.map(SurfaceKind::heading);
    let mut lines = vec![
        format!("| | {} |", headings.join(" | ")),
        "|---|---|---|---|".to_owned(),
    ];
    for capability in Capability::ALL {
        let cells = SurfaceKind::ALL.map(|surface| match capability.of(surface) {
            Ok(()) => "yes".to_owned(),
            Err(unsupported) => {
                let known = notes.iter().position(|note| *note == unsupported);
                let number = known.unwrap_or_else(|| {
                    notes.push(unsupported);
                    notes.len() - 1
                });
                format!("no ({})", number + 1)
            }
        });
        lines.push(format!(
            "| {} | {} |",
            capability.heading(),
            cells.join(" | ")
        ));
    }
    lines.push(String::new());
    for (number, note) in notes.iter().enumerate() {
        lines.push(format!("{}. {}; {}.", number + 1, note.why, note.instead));
    }
    lines.join("\n") + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every reason ends in something to do, and flat pillars can do everything.
    #[test]
    fn reasons_are_given_with_what_to_do() {
        for capability in Capability::ALL {
            assert_eq!(capability.of(SurfaceKind::Pillars), Ok(()));
            for surface in SurfaceKind::ALL {
                if let Err(Unsupported { why, instead }) = capability.of(surface) {
                    assert!(!why.is_empty() && !instead.is_empty());
                }
            }
        }
        let table = support();
        assert!(table.contains("| `press` | yes | yes | yes |"), "{table}");
        assert!(
            table.contains("| `transition` | yes | no (1) | yes |"),
            "{table}"
        );
    }
}
