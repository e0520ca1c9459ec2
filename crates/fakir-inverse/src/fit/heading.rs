//! Headings of columns: the quantity, the unit and the branch that their words name.

use super::column::Column;
use super::units::is_unit;
use fakir::state::Branch;

/// Text without brackets around all of it.
pub(super) fn without_brackets(text: &str) -> &str {
    let text = text.trim();
    let pairs = [('[', ']'), ('(', ')'), ('{', '}')];
    let mut inside = pairs
        .into_iter()
        .filter_map(|(open, close)| text.strip_prefix(open)?.strip_suffix(close));
    inside.next().map_or(text, str::trim)
}

/// The name and the unit of a heading.
pub(super) fn split_unit(heading: &str) -> (String, Option<String>) {
    let heading = heading.trim();
    for (open, close) in [('[', ']'), ('(', ')'), ('{', '}')] {
        if let Some(start) = heading
            .strip_suffix(close)
            .and_then(|rest| rest.rfind(open))
        {
            let inside = heading[start + 1..heading.len() - 1].trim();
            let name = heading[..start].trim().to_owned();
            // Words in brackets are not a unit.
            let is_word = words(inside)
                .iter()
                .all(|word| FILLERS.contains(&&word[..]));
            if !inside.is_empty() && (!is_word || is_unit(inside)) {
                return (name, Some(inside.to_owned()));
            }
            return (format!("{name} {inside}"), None);
        }
    }
    for separator in ['/', ',', '_', ' ', '-', '.'] {
        if let Some((name, unit)) = heading.rsplit_once(separator)
            && !name.trim().is_empty()
            && is_unit(unit.trim())
            // The letter at the end of `Force A` names a channel.
            && unit.trim() != "A"
        {
            return (name.trim().to_owned(), Some(unit.trim().to_owned()));
        }
    }
    (heading.to_owned(), None)
}

/// Words of a name, in lower case: `ContactRadius` has two.
fn words(name: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut last_is_small = false;
    for character in name.chars() {
        let begins = !character.is_alphanumeric() || (last_is_small && character.is_uppercase());
        if begins {
            words.push(String::new());
        }
        if character.is_alphanumeric()
            && let Some(word) = words.last_mut()
        {
            word.extend(character.to_lowercase());
        }
        last_is_small = character.is_lowercase();
    }
    words.retain(|word| !word.is_empty());
    words
}

/// Words that name a quantity.
const QUANTITIES: [(&str, Column); 58] = [
    ("time", Column::Time),
    ("elapsed", Column::Time),
    ("branch", Column::Branch),
    ("segment", Column::Branch),
    ("direction", Column::Branch),
    ("phase", Column::Branch),
    ("indentation", Column::Indentation),
    ("displacement", Column::Displacement),
    ("disp", Column::Displacement),
    ("position", Column::Displacement),
    ("travel", Column::Displacement),
    ("extension", Column::Displacement),
    ("stroke", Column::Displacement),
    ("crosshead", Column::Displacement),
    ("force", Column::Force),
    ("load", Column::Force),
    ("radius", Column::ContactRadius),
    // German.
    ("zeit", Column::Time),
    ("laufzeit", Column::Time),
    ("pr\u{fc}fzeit", Column::Time),
    ("kraft", Column::Force),
    ("standardkraft", Column::Force),
    ("pr\u{fc}fkraft", Column::Force),
    ("normalkraft", Column::Force),
    ("last", Column::Force),
    ("standardweg", Column::Displacement),
    ("traversenweg", Column::Displacement),
    ("kolbenweg", Column::Displacement),
    ("stempelweg", Column::Displacement),
    ("verschiebung", Column::Displacement),
    ("eindringtiefe", Column::Displacement),
    // French.
    ("temps", Column::Time),
    ("d\u{e9}placement", Column::Displacement),
    ("enfoncement", Column::Displacement),
    // Spanish, Portuguese and Italian.
    ("tiempo", Column::Time),
    ("tempo", Column::Time),
    ("fuerza", Column::Force),
    ("for\u{e7}a", Column::Force),
    ("forza", Column::Force),
    ("carga", Column::Force),
    ("carico", Column::Force),
    ("desplazamiento", Column::Displacement),
    ("deslocamento", Column::Displacement),
    ("spostamento", Column::Displacement),
    // Polish.
    ("czas", Column::Time),
    ("si\u{142}a", Column::Force),
    ("obci\u{105}\u{17c}enie", Column::Force),
    ("przemieszczenie", Column::Displacement),
    // Chinese and Japanese.
    ("\u{65f6}\u{95f4}", Column::Time),
    ("\u{6642}\u{9593}", Column::Time),
    ("\u{529b}", Column::Force),
    ("\u{8f7d}\u{8377}", Column::Force),
    ("\u{8377}\u{91cd}", Column::Force),
    ("\u{8a66}\u{9a13}\u{529b}", Column::Force),
    ("\u{4f4d}\u{79fb}", Column::Displacement),
    ("\u{5909}\u{4f4d}", Column::Displacement),
    ("\u{538b}\u{5165}\u{6df1}\u{5ea6}", Column::Displacement),
    (
        "\u{62bc}\u{8fbc}\u{307f}\u{6df1}\u{3055}",
        Column::Displacement,
    ),
];

/// Words that name a quantity unless another word does: `z position`, `normal force fz`.
const SYMBOLS: [(&str, Column); 14] = [
    ("z", Column::Displacement),
    ("zsnsr", Column::Displacement),
    ("depth", Column::Displacement),
    ("pd", Column::Displacement),
    ("distance", Column::Displacement),
    ("ramp", Column::Displacement),
    ("weg", Column::Displacement),
    ("course", Column::Displacement),
    ("pos", Column::Displacement),
    ("f", Column::Force),
    ("fn", Column::Force),
    ("fz", Column::Force),
    ("t", Column::Time),
    ("p", Column::Force),
];

/// Words that change a quantity into its standard error.
const ERRORS: [&str; 9] = [
    "error",
    "errors",
    "err",
    "std",
    "stdev",
    "sd",
    "sigma",
    "uncertainty",
    "deviation",
];

/// Words that change a force into a lateral force.
const LATERAL: [&str; 6] = [
    "lateral",
    "friction",
    "frictional",
    "tangential",
    "shear",
    "transverse",
];

/// Words without effect that may accompany the name.
const FILLERS: [&str; 41] = [
    "normal",
    "measured",
    "contact",
    "raw",
    "corrected",
    "applied",
    "stage",
    "sensor",
    "sense",
    "cell",
    "channel",
    "ch",
    "a",
    "total",
    "piezo",
    "vertical",
    "head",
    "machine",
    "axial",
    "compressive",
    "actual",
    "sample",
    "standard",
    "of",
    "the",
    "in",
    "into",
    "on",
    "surface",
    "mean",
    "average",
    "avg",
    "crosshead",
    "test",
    "running",
    "penetration",
    "calc",
    "de",
    "d",
    "essai",
    "ensayo",
];

/// Quantity that a name denotes, if all of its words are known.
pub(super) fn quantity_of(name: &str) -> Option<Column> {
    let words = words(name);
    let is_error = words.iter().any(|word| ERRORS.contains(&&word[..]));
    let mut strong = Vec::new();
    let mut weak = Vec::new();
    let of = |table: &[(&str, Column)], word: &str| {
        let found = table.iter().find(|(known, _)| *known == word);
        found.map(|(_, column)| *column)
    };
    for word in &words {
        let is_other = ERRORS.contains(&&word[..])
            || LATERAL.contains(&&word[..])
            || FILLERS.contains(&&word[..])
            || word.chars().all(|c| c.is_ascii_digit());
        match (of(&QUANTITIES, word), of(&SYMBOLS, word)) {
            (Some(column), _) => strong.push((column, word)),
            (None, Some(column)) => weak.push((column, word)),
            (None, None) if is_other => {}
            (None, None) => return None,
        }
    }
    // `crosshead load` is a load.
    if strong.iter().any(|(_, word)| *word != "crosshead") {
        strong.retain(|(_, word)| *word != "crosshead");
    }
    let named = if strong.is_empty() { &weak } else { &strong };
    // Friction alone is a force; of the other words for it, none is.
    let is_friction = words.iter().any(|word| word == "friction");
    let first = match named.first() {
        Some((column, _)) => *column,
        None if is_friction => Column::Force,
        None => return None,
    };
    if named.iter().any(|(column, _)| *column != first) {
        return None;
    }
    let is_lateral = words.iter().any(|word| LATERAL.contains(&&word[..]));
    let first = match (is_lateral, first) {
        (false, _) => first,
        (true, Column::Force) => Column::LateralForce,
        (true, _) => return None,
    };
    match (is_error, first) {
        (false, _) => Some(first),
        (true, _) => Column::ALL
            .into_iter()
            .find(|column| column.errors_of() == Some(first)),
    }
}

/// Whether a name contains a power or a factor: `1000*Load`, `Load/1000`, `Load 10^-3`.
pub(super) fn has_factor(name: &str) -> bool {
    const TIMES: [char; 5] = ['*', '/', '\u{d7}', '\u{b7}', ':'];
    let plain: Vec<char> = name.chars().filter(|c| !c.is_whitespace()).collect();
    let is_digit = |c: Option<&char>| c.is_some_and(char::is_ascii_digit);
    plain.contains(&'^')
        || plain.iter().enumerate().any(|(place, c)| {
            let before = place.checked_sub(1).and_then(|place| plain.get(place));
            TIMES.contains(c) && (is_digit(before) || is_digit(plain.get(place + 1)))
        })
}

/// The branch that a word names.
pub(super) fn branch_of(text: &str) -> Option<Branch> {
    const LOADING: [&str; 10] = [
        "loading",
        "load",
        "approach",
        "approaching",
        "advance",
        "advancing",
        "extend",
        "forward",
        "trace",
        "indent",
    ];
    const UNLOADING: [&str; 12] = [
        "unloading",
        "unload",
        "retract",
        "retraction",
        "retracting",
        "retrace",
        "withdraw",
        "withdrawal",
        "backward",
        "receding",
        "return",
        "pull-off",
    ];
    let text = without_brackets(text).to_lowercase();
    let text = text
        .trim_start_matches("segment")
        .trim_start_matches([':', ' ']);
    if LOADING.contains(&text) {
        Some(Branch::Loading)
    } else if UNLOADING.contains(&text) {
        Some(Branch::Unloading)
    } else {
        None
    }
}

/// Whether a word names a pause between the branches.
pub(super) fn is_pause(text: &str) -> bool {
    const PAUSES: [&str; 5] = ["pause", "dwell", "hold", "holding", "creep"];
    PAUSES.contains(&&without_brackets(text).to_lowercase()[..])
}

/// The unit of voltage at the end of a heading without brackets: `Defl_V`.
pub(super) fn volts_of(heading: &str) -> Option<String> {
    let (_, unit) = heading.rsplit_once(['_', ' ', '/', ','])?;
    let unit = unit.trim();
    ["V", "mV", "uV"].contains(&unit).then(|| unit.to_owned())
}

/// Words of a heading that contains the columns of one branch, beside those of the other: `Defl_pN_Ex`.
const BRANCH_WORDS: [(&str, Branch); 14] = [
    ("ex", Branch::Loading),
    ("extend", Branch::Loading),
    ("approach", Branch::Loading),
    ("loading", Branch::Loading),
    ("trace", Branch::Loading),
    ("forward", Branch::Loading),
    ("adv", Branch::Loading),
    ("rt", Branch::Unloading),
    ("retract", Branch::Unloading),
    ("withdraw", Branch::Unloading),
    ("unloading", Branch::Unloading),
    ("retrace", Branch::Unloading),
    ("backward", Branch::Unloading),
    ("ret", Branch::Unloading),
];

/// The branch that a heading names, and the heading without it.
pub(super) fn split_branch(heading: &str) -> Option<(Branch, String)> {
    let is_between = |c: char| !c.is_alphanumeric();
    let mut start = 0;
    for word in heading.split(is_between) {
        let end = start + word.len();
        let lower = word.to_lowercase();
        let found = BRANCH_WORDS.iter().find(|(known, _)| *known == lower);
        if let Some((_, branch)) = found {
            let before = heading[..start].trim_end_matches(|c| is_between(c) && !"])}".contains(c));
            let after = heading[end..].trim_start_matches(|c| is_between(c) && !"[({".contains(c));
            let joint = if before.is_empty() || after.is_empty() {
                ""
            } else {
                " "
            };
            return Some((*branch, format!("{before}{joint}{after}")));
        }
        start = end + heading[end..].chars().next().map_or(0, char::len_utf8);
    }
    None
}

/// Quantities that columns may stand for if no other column has the quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Substitute {
    /// Position that decreases as the lens moves down, without the deflection of the cantilever.
    Tip,
    /// Position of the base that decreases as the lens moves down; measured.
    MeasuredHeight,
    /// The same; set or smoothed.
    Height,
    /// Deflection of a cantilever.
    Deflection,
}

/// What a name may stand for.
pub(super) fn substitute(name: &str) -> Option<Substitute> {
    const HEIGHT: [&str; 4] = ["height", "gap", "separation", "distance"];
    const DEFLECTION: [&str; 5] = ["deflection", "defl", "vdeflection", "cantilever", "bending"];
    const OTHERS: [&str; 11] = [
        "tip", "position", "vertical", "smoothed", "set", "sensor", "measured", "surface", "z",
        "grip", "to",
    ];
    let words = words(name);
    let has = |known: &[&str]| words.iter().any(|word| known.contains(&&word[..]));
    let is_known = |word: &String| {
        let word = &word[..];
        HEIGHT.contains(&word)
            || DEFLECTION.contains(&word)
            || OTHERS.contains(&word)
            || FILLERS.contains(&word)
    };
    if words.is_empty() || !words.iter().all(is_known) {
        return None;
    }
    match () {
        () if has(&DEFLECTION) && !has(&HEIGHT) => Some(Substitute::Deflection),
        () if has(&["tip"]) && has(&["position", "separation"]) => Some(Substitute::Tip),
        () if has(&HEIGHT) && has(&["measured", "sensor"]) && !has(&["smoothed"]) => {
            Some(Substitute::MeasuredHeight)
        }
        () if has(&HEIGHT) => Some(Substitute::Height),
        () => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headings_of_instruments() {
        for (heading, quantity, unit) in [
            ("displacement_um", "displacement", "um"),
            ("Load [mN]", "force", "mN"),
            ("Force (mN)", "force", "mN"),
            ("F / mN", "force", "mN"),
            ("Fz, uN", "force", "uN"),
            ("Z-Sense(nm)", "displacement", "nm"),
            ("Z Position (\u{b5}m)", "displacement", "\u{b5}m"),
            ("Load On Sample (uN)", "force", "uN"),
            ("Displacement Into Surface [nm]", "displacement", "nm"),
            ("Ch 1 Kraft [kN]", "force", "kN"),
            ("Force A [mN]", "force", "mN"),
            ("Temps d'essai [s]", "time", "s"),
            ("\u{4f4d}\u{79fb}(mm)", "displacement", "mm"),
            ("Force setpoint A", "", ""),
            ("ContactRadius_um", "contact_radius", "um"),
            ("Contact radius [mm]", "contact_radius", "mm"),
            ("Crosshead load N", "force", "N"),
            ("Crosshead (mm)", "displacement", "mm"),
            ("Indentation depth (nm)", "indentation", "nm"),
            ("Force error [mN]", "force_error", "mN"),
            ("force_error_N", "force_error", "N"),
            ("Time (s)", "time", "s"),
            ("Normal Force (raw) [mN]", "force", "mN"),
            ("Friction force [mN]", "lateral_force", "mN"),
            ("friction_uN", "lateral_force", "uN"),
            ("lateral_force_uN", "lateral_force", "uN"),
            ("Lateral force error (mN)", "lateral_force_error", "mN"),
            ("Tangential displacement (um)", "", ""),
            ("Lens radius [mm]", "", ""),
            ("Force setpoint [mN]", "", ""),
        ] {
            let (name, found) = split_unit(heading);
            let column = quantity_of(&name);
            assert_eq!(column.map_or("", Column::quantity), quantity, "{heading}");
            if column.is_some() {
                assert_eq!(found.as_deref(), Some(unit), "{heading}");
            }
        }
    }

    #[test]
    fn factors_in_headings() {
        for heading in [
            "1000*Load (N)",
            "Load*1000 (N)",
            "Load / 1000 (N)",
            "Load/10 mN",
            "Load^2 (mN)",
            "Load 10^-3 (N)",
        ] {
            assert!(has_factor(&split_unit(heading).0), "{heading}");
        }
        for heading in ["F / mN", "Load* (N)", "Force 1 [mN]", "Force/Load (N)"] {
            assert!(!has_factor(&split_unit(heading).0), "{heading}");
        }
    }

    #[test]
    fn branches_in_headings() {
        for (heading, branch, rest) in [
            ("Defl_pN_Ex", Branch::Loading, "Defl_pN"),
            ("Height_Sensor_nm_Rt", Branch::Unloading, "Height_Sensor_nm"),
            ("Retract force [nN]", Branch::Unloading, "force [nN]"),
            ("Force (approach) [nN]", Branch::Loading, "Force [nN]"),
            ("Z [nm] extend", Branch::Loading, "Z [nm]"),
        ] {
            assert_eq!(split_branch(heading), Some((branch, rest.to_owned())));
        }
        assert_eq!(split_branch("Extension [mm]"), None);
        assert_eq!(
            substitute("Height (measured)"),
            Some(Substitute::MeasuredHeight)
        );
        assert_eq!(substitute("Vertical Tip Position"), Some(Substitute::Tip));
        assert_eq!(substitute("Height of the pillar"), None);
    }
}
