//! Text with italics, subscripts and superscripts.

use crate::font::{Bounds, Face};

/// Size of subscripts and superscripts, relative to the text.
const SCRIPT_SIZE: f64 = 0.72;

/// Shift of subscripts down and superscripts up, in font sizes of the text.
const SUBSCRIPT_DROP: f64 = 0.19;
const SUPERSCRIPT_RISE: f64 = 0.36;

/// A line of text with italics, subscripts and superscripts.
///
/// Markup: `*F*_{c}` is an italic F with an upright subscript c, `10^{-3}` is ten to the minus
/// three. A backslash escapes the next character. A hyphen before a digit becomes a minus sign.
///
/// ```
/// use fakir_figure::Text;
/// let label = Text::from("*F*_{c} *γ*_{int}/(*h* *d*)");
/// assert_eq!(label.to_string(), "Fc γint/(h d)");
/// assert_eq!(Text::plain("a_b*c").to_string(), "a_b*c");
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Text {
    runs: Vec<Run>,
}

/// A piece of text in one style.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Run {
    pub(crate) text: String,
    pub(crate) face: Face,
    level: Level,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Level {
    Base,
    Subscript,
    Superscript,
}

impl Run {
    /// Size relative to the text.
    pub(crate) fn size(&self) -> f64 {
        match self.level {
            Level::Base => 1.0,
            Level::Subscript | Level::Superscript => SCRIPT_SIZE,
        }
    }

    /// Shift of the baseline downwards, in font sizes of the text.
    pub(crate) fn drop(&self) -> f64 {
        match self.level {
            Level::Base => 0.0,
            Level::Subscript => SUBSCRIPT_DROP,
            Level::Superscript => -SUPERSCRIPT_RISE,
        }
    }

    fn advance(&self) -> f64 {
        self.size() * self.face.advance(&self.text)
    }
}

impl From<&str> for Text {
    fn from(markup: &str) -> Self {
        let mut parser = Parser::default();
        let mut characters = markup.chars().peekable();
        while let Some(character) = characters.next() {
            let next = characters.peek().copied();
            match (character, next) {
                ('\\', Some(next)) => {
                    parser.push(next);
                    characters.next();
                }
                ('*', _) => parser.italic = !parser.italic,
                ('_', Some('{')) => {
                    parser.level = Level::Subscript;
                    characters.next();
                }
                ('^', Some('{')) => {
                    parser.level = Level::Superscript;
                    characters.next();
                }
                ('}', _) if parser.level != Level::Base => parser.level = Level::Base,
                ('-', Some('0'..='9')) if !parser.after_word() => parser.push('−'),
                _ => parser.push(character),
            }
        }
        Self { runs: parser.runs }
    }
}

impl From<String> for Text {
    fn from(markup: String) -> Self {
        Self::from(markup.as_str())
    }
}

struct Parser {
    runs: Vec<Run>,
    italic: bool,
    level: Level,
}

impl Default for Parser {
    fn default() -> Self {
        Self {
            runs: Vec::new(),
            italic: false,
            level: Level::Base,
        }
    }
}

impl Parser {
    fn push(&mut self, character: char) {
        if character.is_control() {
            return;
        }
        let face = if self.italic {
            Face::Italic
        } else {
            Face::Upright
        };
        match self.runs.last_mut() {
            Some(run) if run.face == face && run.level == self.level => run.text.push(character),
            _ => self.runs.push(Run {
                text: character.to_string(),
                face,
                level: self.level,
            }),
        }
    }

    /// Whether a letter or digit of the same level directly precedes.
    fn after_word(&self) -> bool {
        self.runs.last().is_some_and(|run| {
            run.level == self.level && run.text.ends_with(|c: char| c.is_alphanumeric())
        })
    }
}

impl std::fmt::Display for Text {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.runs.iter().try_for_each(|run| f.write_str(&run.text))
    }
}

impl Text {
    /// Text without markup: all characters are literal.
    #[must_use]
    pub fn plain(text: &str) -> Self {
        let mut parser = Parser::default();
        text.chars().for_each(|character| parser.push(character));
        Self { runs: parser.runs }
    }

    /// Appends another text.
    #[must_use]
    pub fn followed_by(mut self, other: impl Into<Self>) -> Self {
        self.runs.extend(other.into().runs);
        self
    }

    pub(crate) fn runs(&self) -> &[Run] {
        &self.runs
    }

    /// Advance width, in font sizes.
    pub(crate) fn width(&self) -> f64 {
        self.runs.iter().map(Run::advance).sum()
    }

    /// Every run with the distance of its start from the start of the text, in font sizes.
    pub(crate) fn placed(&self) -> impl Iterator<Item = (f64, &Run)> {
        self.runs.iter().scan(0.0, |start, run| {
            let at = *start;
            *start += run.advance();
            Some((at, run))
        })
    }

    /// Bounding box of the glyphs, in font sizes, with the start of the baseline as the origin.
    pub(crate) fn ink(&self) -> Option<Bounds> {
        self.placed()
            .filter_map(|(start, run)| {
                let ink = run.face.ink(&run.text)?;
                let size = run.size();
                Some(Bounds {
                    left: start + size * ink.left,
                    top: run.drop() + size * ink.top,
                    right: start + size * ink.right,
                    bottom: run.drop() + size * ink.bottom,
                })
            })
            .reduce(Bounds::union)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn styles(text: &Text) -> Vec<(&str, Face, Level)> {
        text.runs
            .iter()
            .map(|run| (run.text.as_str(), run.face, run.level))
            .collect()
    }

    #[test]
    fn markup_makes_runs() {
        use Face::{Italic, Upright};
        let text = Text::from("*a*_{c}/*e*^{-2}");
        assert_eq!(
            styles(&text),
            [
                ("a", Italic, Level::Base),
                ("c", Upright, Level::Subscript),
                ("/", Upright, Level::Base),
                ("e", Italic, Level::Base),
                ("−2", Upright, Level::Superscript),
            ]
        );
    }

    #[test]
    fn signs_that_are_no_markup_stay() {
        let text = Text::from(r"5\*3 a_b x^2 } -5 2021-10");
        assert_eq!(text.to_string(), "5*3 a_b x^2 } −5 2021-10");
        assert!(Text::from("").width().abs() < 1e-12);
        assert!(Text::from("  ").ink().is_none());
    }

    #[test]
    fn width_is_the_sum_of_runs_and_contains_the_ink() {
        let text = Text::from("10^{-3}");
        let ten = Text::from("10").width();
        let exponent = Text::from("−3").width();
        assert!((text.width() - ten - SCRIPT_SIZE * exponent).abs() < 1e-12);
        let ink = text.ink().unwrap();
        assert!(ink.left >= 0.0 && ink.right <= text.width());
    }
}
