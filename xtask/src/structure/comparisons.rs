//! Comparisons that panic if a number is NaN.

use super::files::{collect, read, root};
use std::path::Path;

/// Comparisons of all crates that panic if a number is NaN.
pub(super) fn problems() -> Result<Vec<String>, String> {
    let root = root();
    let mut files = Vec::new();
    for folder in ["crates", "checks", "xtask"] {
        collect(&root.join(folder), "rs", &mut files)?;
    }
    let is_test = |path: &Path| {
        let mut names = path.components().map(std::path::Component::as_os_str);
        names.any(|name| name == "tests" || name == "tests.rs" || name == "target")
    };
    let mut problems = Vec::new();
    for file in &files {
        let inside = file.strip_prefix(&root).unwrap_or(file);
        if is_test(inside) {
            continue;
        }
        let text = read(file)?;
        let found = comparisons(&text).into_iter();
        problems
            .extend(found.map(|(line, advice)| format!("{}:{line}: {advice}", inside.display())));
    }
    Ok(problems)
}

/// Lines, from 1, of comparisons that panic if a number is NaN, each with what to write instead. `f64::clamp` also panics if its bounds are in the wrong
/// order: only constant bounds are accepted.
fn comparisons(text: &str) -> Vec<(usize, &'static str)> {
    let code: Vec<&str> = text
        .split("#[cfg(test)]\nmod tests {")
        .next()
        .unwrap_or_default()
        .lines()
        .map(|line| line.split("//").next().unwrap_or_default())
        .collect();
    let code = code.join("\n");
    let line = |place: usize| code[..place].matches('\n').count() + 1;
    let mut found = Vec::new();
    for (place, name) in code.match_indices("partial_cmp") {
        if code[place + name.len()..].starts_with('(') && !code[..place].ends_with("fn ") {
            found.push((line(place), "partial_cmp: use total_cmp"));
        }
    }
    for (place, name) in code.match_indices(".clamp(") {
        if !is_constant(inside_parentheses(&code[place + name.len()..])) {
            let advice = "clamp by a bound that is computed: use numerics::convergence::clamped, or max and min of whole numbers";
            found.push((line(place), advice));
        }
    }
    found
}

/// The text up to the closing parenthesis.
fn inside_parentheses(text: &str) -> &str {
    let mut depth = 1;
    let end = text.find(|c: char| {
        depth += match c {
            '(' => 1,
            ')' => -1,
            _ => 0,
        };
        depth == 0
    });
    &text[..end.unwrap_or(text.len())]
}

/// Whether an expression contains only numbers and constants, whose names are in capitals.
fn is_constant(expression: &str) -> bool {
    let separators = |c: char| !(c.is_alphanumeric() || c == '_' || c == '.' || c == ':');
    expression.split(separators).all(|word| {
        let name = word.rsplit("::").next().unwrap_or_default();
        name.starts_with(|c: char| c.is_ascii_digit()) || !name.contains(|c: char| c.is_lowercase())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_comparisons_that_nan_ends() {
        let text = "a.partial_cmp(&b).unwrap();\n// c.clamp(d, e)\nx.clamp(0.0, 1e5 - Self::MOST_SIDES);\n\
                    x.abs()\n    .clamp(\n        least(0.5),\n        1.0,\n    );\nn.clamp(1, 2_000);\n\
                    fn partial_cmp(&self) {}\n#[cfg(test)]\nmod tests { x.clamp(a, b) }";
        let lines: Vec<usize> = comparisons(text).iter().map(|found| found.0).collect();
        assert_eq!(lines, [1, 5]);
        assert!(!is_constant("0.1 * target, target") && is_constant("-1e-12, DIGITS"));
    }
}
