//! All scripts of the page in one: browsers do not load scripts from other files of a disk.
//!
//! Every script becomes a function that returns what it exports. Only the forms of `import` and `export` that the page uses are
//! read; others are refused.

use std::collections::BTreeSet;
use std::io;

/// The script `name` with all scripts that it imports, in the order in which they are needed.
pub(crate) fn bundle(
    name: &str,
    read: &dyn Fn(&str) -> io::Result<String>,
) -> Result<String, String> {
    let mut whole = String::new();
    let text = read(name).map_err(|error| format!("{name}.js: {error}"))?;
    let (body, exported) = part(name, &text, read, &mut BTreeSet::new(), &mut whole)?;
    if !exported.is_empty() {
        return Err(format!("{name}.js exports something"));
    }
    Ok(whole + &body)
}

/// The script without imports and exports, and the names that it exports. Scripts that it imports are added to `whole`.
fn part(
    name: &str,
    text: &str,
    read: &dyn Fn(&str) -> io::Result<String>,
    done: &mut BTreeSet<String>,
    whole: &mut String,
) -> Result<(String, Vec<String>), String> {
    let mut body = String::new();
    let mut exported = Vec::new();
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        if line.starts_with("import ") {
            let mut statement = line.to_owned();
            while !statement.contains(';') {
                statement += lines.next().ok_or_else(|| format!("{name}.js: {line}"))?;
            }
            let (names, from) = statement
                .strip_prefix("import {")
                .and_then(|rest| rest.split_once("} from \"./"))
                .and_then(|(names, from)| Some((names, from.strip_suffix(".js\";")?)))
                .ok_or_else(|| format!("{name}.js: {statement}"))?;
            if names.contains(" as ") {
                return Err(format!("{name}.js: {statement}"));
            }
            if done.insert(from.to_owned()) {
                let text = read(from).map_err(|error| format!("{from}.js: {error}"))?;
                let (inside, exported) = part(from, &text, read, done, whole)?;
                let exported = exported.join(", ");
                *whole += &format!(
                    "const ${from} = (() => {{\n{inside}return {{ {exported} }};\n}})();\n"
                );
            }
            body += &format!("const {{{names}}} = ${from};\n");
            continue;
        }
        let Some(declared) = line.strip_prefix("export ") else {
            body += line;
            body.push('\n');
            continue;
        };
        let words = [
            "async function* ",
            "async function ",
            "function* ",
            "function ",
            "class ",
            "const ",
        ];
        let rest = words.iter().find_map(|word| declared.strip_prefix(word));
        let end = |letter: char| !(letter.is_alphanumeric() || letter == '_' || letter == '$');
        let own = rest.and_then(|rest| rest.split(end).next()).unwrap_or("");
        if own.is_empty() {
            return Err(format!("{name}.js: {line}"));
        }
        exported.push(own.to_owned());
        body += declared;
        body.push('\n');
    }
    Ok((body, exported))
}
