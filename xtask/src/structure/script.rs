//! Imports of a module of the page.

use super::tree::Imports;

/// Prefix of the name of a module in the same folder.
const BEFORE: [&str; 3] = ["from \"./", "import \"./", "import(\"./"];

/// The imports of a module in the folder of the page, including those of types.
pub(super) fn imports(text: &str) -> Imports {
    let places = BEFORE.iter().flat_map(|before| {
        let ends = text.match_indices(before);
        ends.map(|(place, before)| place + before.len())
    });
    let module = |place: usize| {
        let name = text[place..].split(['"', '.']).next()?;
        Some(vec![name.to_owned()])
    };
    Imports {
        uses: places.filter_map(module).collect(),
        ..Imports::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn imports_of_all_kinds_are_found() {
        let text = "/** @import { Key } from \"./engine.js\" */\nimport {\n  copy,\n  save,\n} from \"./actions.js\";\n\
                    export { write } from \"./numbers.js\";\nimport \"./theme.js\";\nconst map = await import(\"./map.js\");\n\
                    import { other } from \"elsewhere\";\n";
        let mut found: Vec<String> = imports(text).uses.concat();
        found.sort();
        assert_eq!(found, ["actions", "engine", "map", "numbers", "theme"]);
    }
}
