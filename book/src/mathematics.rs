//! Formulas in Markdown, from TeX to MathML.

use pulldown_cmark::{Event, Options, Parser};
use pulldown_latex::config::DisplayMode;
use pulldown_latex::{Parser as Tex, RenderConfig, Storage, push_mathml};

/// A text in which every `$formula$` and `$$formula$$` is MathML.
pub(crate) fn render(markdown: &str) -> Result<String, String> {
    let options = Options::ENABLE_MATH | Options::ENABLE_TABLES | Options::ENABLE_FOOTNOTES;
    let mut rendered = String::with_capacity(markdown.len());
    let mut copied = 0;
    for (event, place) in Parser::new_ext(markdown, options).into_offset_iter() {
        let (formula, display) = match event {
            Event::InlineMath(formula) => (formula, DisplayMode::Inline),
            Event::DisplayMath(formula) => (formula, DisplayMode::Block),
            _ => continue,
        };
        rendered += &markdown[copied..place.start];
        rendered += &mathml(&formula, display)?;
        copied = place.end;
    }
    Ok(rendered + &markdown[copied..])
}

fn mathml(formula: &str, display_mode: DisplayMode) -> Result<String, String> {
    let storage = Storage::new();
    // What cannot be understood would be shown in red; it is an error.
    for event in Tex::new(formula, &storage) {
        event.map_err(|error| format!("in the formula {formula}: {error}"))?;
    }
    let storage = Storage::new();
    let mut text = String::new();
    let config = RenderConfig {
        display_mode,
        ..RenderConfig::default()
    };
    push_mathml(&mut text, Tex::new(formula, &storage), config)
        .map_err(|error| format!("in the formula {formula}: {error}"))?;
    Ok(plain(&text))
}

/// MathML on one line in which every character between tags is itself, in HTML and in Markdown.
fn plain(mathml: &str) -> String {
    let mut text = String::with_capacity(mathml.len());
    let mut in_tag = false;
    let mut characters = mathml.chars().peekable();
    while let Some(c) = characters.next() {
        let tag_begins = |next: Option<&char>| next.is_some_and(|n| n.is_alphabetic() || *n == '/');
        match c {
            '\n' => text.push(' '),
            '>' if in_tag => {
                in_tag = false;
                text.push(c);
            }
            '<' if tag_begins(characters.peek()) => {
                in_tag = true;
                text.push(c);
            }
            '*' | '_' | '[' | ']' | '`' | '|' | '~' | '$' | '\\' | '^' | '<' | '>' if !in_tag => {
                text += &format!("&#{};", u32::from(c));
            }
            _ => text.push(c),
        }
    }
    // The library omits a space that HTML requires.
    text.replace("\"minsize", "\" minsize")
}
