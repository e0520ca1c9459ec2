//! Reads the part of XML that files of measurements use: elements, their attributes and texts, in their order. Namespaces are dropped.

/// A part of a document.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Part<'a> {
    /// Start of an element: its name without a namespace, and the text of its attributes.
    Start(&'a str, &'a str),
    /// End of an element.
    End(&'a str),
    /// Text between elements.
    Text(String),
}

/// Parts of a document, in their order. Comments, declarations and what cannot be understood are left out.
pub(crate) fn parts(document: &str) -> Vec<Part<'_>> {
    let mut parts = Vec::new();
    let mut rest = document;
    while let Some(start) = rest.find('<') {
        let text = &rest[..start];
        if !text.is_empty() {
            parts.push(Part::Text(plain(text)));
        }
        rest = &rest[start..];
        let special = [
            ("<!--", "-->"),
            ("<![CDATA[", "]]>"),
            ("<?", "?>"),
            ("<!", ">"),
        ];
        let found = special.into_iter().find(|(open, _)| rest.starts_with(open));
        let (open, close) = found.unwrap_or(("<", ">"));
        let Some(end) = rest[open.len()..].find(close) else {
            break;
        };
        let inside = &rest[open.len()..open.len() + end];
        rest = &rest[open.len() + end + close.len()..];
        match open {
            "<![CDATA[" => parts.push(Part::Text(inside.to_owned())),
            "<" => element(inside, &mut parts),
            _ => {}
        }
    }
    parts
}

fn element<'a>(inside: &'a str, parts: &mut Vec<Part<'a>>) {
    if let Some(name) = inside.strip_prefix('/') {
        parts.push(Part::End(local(name.trim())));
        return;
    }
    let is_empty = inside.ends_with('/');
    let inside = inside.trim_end_matches('/');
    let (name, attributes) = inside
        .split_once(char::is_whitespace)
        .unwrap_or((inside, ""));
    parts.push(Part::Start(local(name), attributes));
    if is_empty {
        parts.push(Part::End(local(name)));
    }
}

/// A name without its namespace.
fn local(name: &str) -> &str {
    name.rsplit_once(':').map_or(name, |(_, local)| local)
}

/// Value of an attribute, by its name without a namespace.
pub(crate) fn attribute(attributes: &str, name: &str) -> Option<String> {
    let mut rest = attributes;
    loop {
        let (key, after) = rest.split_once('=')?;
        let after = after.trim_start();
        let quote = after.chars().next()?;
        let (value, next) = after.get(1..)?.split_once(quote)?;
        if local(key.trim()) == name {
            return Some(plain(value));
        }
        rest = next;
    }
}

/// Text with its entities replaced.
fn plain(text: &str) -> String {
    if !text.contains('&') {
        return text.to_owned();
    }
    let mut plain = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('&') {
        plain.push_str(before);
        let Some((name, next)) = after.split_once(';') else {
            rest = after;
            break;
        };
        let number = |text: &str, radix| {
            u32::from_str_radix(text, radix)
                .ok()
                .and_then(char::from_u32)
        };
        let character = match name {
            "amp" => Some('&'),
            "lt" => Some('<'),
            "gt" => Some('>'),
            "quot" => Some('"'),
            "apos" => Some('\''),
            _ => match name.strip_prefix("#x") {
                Some(digits) => number(digits, 16),
                None => name.strip_prefix('#').and_then(|digits| number(digits, 10)),
            },
        };
        plain.extend(character);
        rest = next;
    }
    plain + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_attributes_and_texts() {
        let found = parts("<?xml?><!-- <a> --><p:a x=\"1\" r:id='&lt;2'>5 &#181;m<b/></p:a>");
        assert_eq!(
            found,
            [
                Part::Start("a", "x=\"1\" r:id='&lt;2'"),
                Part::Text("5 \u{b5}m".to_owned()),
                Part::Start("b", ""),
                Part::End("b"),
                Part::End("a"),
            ]
        );
        assert_eq!(
            attribute("x=\"1\" r:id='&lt;2'", "id").as_deref(),
            Some("<2")
        );
        assert_eq!(attribute("x=\"1\"", "y"), None);
    }
}
