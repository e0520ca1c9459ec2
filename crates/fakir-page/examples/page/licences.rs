//! The licences of the libraries in the module, from the packages that cargo has downloaded.

use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::error::Error;
use std::fs;
use std::path::Path;
use std::process::Command;

/// Beginnings of the names of files with licences.
const NAMES: [&str; 5] = ["license", "licence", "copying", "notice", "unlicense"];

/// Every licence with the libraries that it applies to.
pub(crate) fn of_module() -> Result<String, Box<dyn Error>> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = Command::new(cargo)
        .args(["metadata", "--format-version", "1", "--locked"])
        .args(["--filter-platform", "wasm32-unknown-unknown"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into());
    }
    let data: Value = serde_json::from_slice(&output.stdout)?;
    let list = |value: &Value| value.as_array().cloned().unwrap_or_default();
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let by_id = |list: Vec<Value>| -> BTreeMap<String, Value> {
        list.into_iter().map(|it| (text(&it["id"]), it)).collect()
    };
    let packages = by_id(list(&data["packages"]));
    let nodes = by_id(list(&data["resolve"]["nodes"]));
    let own = packages.iter().find(|(_, it)| it["name"] == "fakir-page");
    let mut waiting: Vec<String> = own.map(|(id, _)| id.clone()).into_iter().collect();
    let mut found = BTreeSet::new();
    while let Some(id) = waiting.pop() {
        if !found.insert(id.clone()) {
            continue;
        }
        for dependency in list(&nodes[&id]["deps"]) {
            let kinds = list(&dependency["dep_kinds"]);
            if kinds.iter().any(|kind| kind["kind"].is_null()) {
                waiting.push(text(&dependency["pkg"]));
            }
        }
    }
    let mut licences: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for package in found.iter().filter_map(|id| packages.get(id)) {
        if package["source"].is_null() {
            continue;
        }
        let name = format!(
            "{} {} ({})",
            text(&package["name"]),
            text(&package["version"]),
            text(&package["license"])
        );
        let manifest = text(&package["manifest_path"]);
        let folder = Path::new(&manifest).parent().unwrap_or(Path::new("."));
        for file in fs::read_dir(folder)? {
            let file = file?.path();
            let of_file = file
                .file_name()
                .unwrap_or_default()
                .to_string_lossy()
                .to_lowercase();
            if file.is_file() && NAMES.iter().any(|start| of_file.starts_with(start)) {
                let licence = fs::read_to_string(&file)?.replace('\r', "");
                licences
                    .entry(licence.trim().to_owned())
                    .or_default()
                    .push(name.clone());
            }
        }
    }
    let mut words = "fakir is licensed under MIT or Apache-2.0 (LICENSE-MIT, LICENSE-APACHE). It contains the font Roboto \
        (Apache-2.0), the standard library of Rust (MIT or Apache-2.0), and the libraries below.\n"
        .to_owned();
    for (licence, names) in licences {
        let line = "-".repeat(80);
        words += &format!("\n{line}\n{}\n{line}\n{licence}\n", names.join(", "));
    }
    Ok(words)
}
