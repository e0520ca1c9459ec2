//! Assembles the page without a server: `cargo xtask page` calls it with the module and the folder to write to.
//!
//! | file | content |
//! |---|---|
//! | `index.html`, `fakir.wasm` | the page and its module, for a web server |
//! | `fakir.html` | both in one file, which also works from a disk |
//! | `licences.txt`, `LICENSE-*` | licences of fakir and of the libraries in the module |

mod bundle;
mod first;
mod licences;

use base64::Engine;
use base64::engine::general_purpose::STANDARD as BASE64;
use flate2::Compression;
use flate2::write::GzEncoder;
use serde_json::Value;
use std::error::Error;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Rules of the document: it loads nothing but its own module.
const RULES: &str = "default-src 'none'; script-src 'unsafe-inline' 'wasm-unsafe-eval' blob:; \
    worker-src blob:; style-src 'unsafe-inline'; img-src data: blob:; font-src data:; base-uri 'none'; form-action 'none'";

/// Starts to load the fonts before they are first used: text is then laid out once.
const FONTS: &str = "<script>for (const style of [\"\", \"italic \"]) document.fonts.load(`${style}1em Roboto`);</script>";

fn main() -> ExitCode {
    let mut arguments = std::env::args_os().skip(1).map(PathBuf::from);
    let (Some(module), Some(folder)) = (arguments.next(), arguments.next()) else {
        eprintln!("usage: page MODULE FOLDER");
        return ExitCode::from(2);
    };
    match write(&module, &folder) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn write(module: &Path, folder: &Path) -> Result<(), Box<dyn Error>> {
    let module = fs::read(module).map_err(|error| format!("{}: {error}", module.display()))?;
    fs::create_dir_all(folder)?;
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let licences = licences::of_module()?;
    let mut packed = GzEncoder::new(Vec::new(), Compression::best());
    packed.write_all(&module)?;
    let inside = BASE64.encode(packed.finish()?);
    let page = root.join("../fakir-explore/page");
    let first = first::data();
    let save = |name: &str, contents: &[u8]| fs::write(folder.join(name), contents);
    save("fakir.wasm", &module)?;
    save(
        "index.html",
        document(&page, &first, &licences, None)?.as_bytes(),
    )?;
    save(
        "fakir.html",
        document(&page, &first, &licences, Some(&inside))?.as_bytes(),
    )?;
    save("licences.txt", licences.as_bytes())?;
    for name in ["LICENSE-APACHE", "LICENSE-MIT"] {
        save(name, &fs::read(root.join(name))?)?;
    }
    Ok(())
}

/// The document with style sheets, scripts and first answers, and with the module if it is given.
fn document(
    page: &Path,
    first: &Value,
    licences: &str,
    module: Option<&str>,
) -> Result<String, Box<dyn Error>> {
    let read = |name: &str| fs::read_to_string(page.join(name));
    let text = |id: &str, kind: &str, contents: &str| {
        let contents = contents.replace("</script", "<\\/script");
        format!("<script type=\"{kind}\" id=\"{id}\">{contents}</script>\n")
    };
    let connections = if module.is_some() { "'none'" } else { "'self'" };
    let rules = format!(
        "<meta http-equiv=\"Content-Security-Policy\" content=\"{RULES}; connect-src {connections}\">"
    );
    let script = bundle::bundle("main", &|name| read(&format!("{name}.js")))?;
    // A plain script runs as soon as it is parsed, one of type `module` after the whole document: the first picture is drawn before
    // the long texts that follow are read.
    let parts = [
        // In JSON every `<` can be escaped.
        text(
            "first",
            "application/json",
            &first.to_string().replace('<', "\\u003c"),
        ),
        text("worker-source", "text/plain", &read("worker.js")?),
        format!(
            "<script>\n\"use strict\";\n(async () => {{\n{}}})();\n</script>\n",
            script.replace("</script", "<\\/script")
        ),
        text("module", "text/plain", module.unwrap_or_default()),
        text("licences", "text/plain", licences),
    ];
    let mut html = read("index.html")?;
    for (from, to) in [
        (
            "data-engine=\"server\"",
            "data-engine=\"module\"".to_owned(),
        ),
        (
            "<meta charset=\"utf-8\">",
            format!("<meta charset=\"utf-8\">\n    {rules}"),
        ),
        (
            "<link rel=\"stylesheet\" href=\"font.css\">",
            format!("<style>{}</style>\n    {FONTS}", fakir_explore::font_css()),
        ),
        (
            "<link rel=\"stylesheet\" href=\"style.css\">",
            format!("<style>{}</style>", read("style.css")?),
        ),
        (
            "<script type=\"module\" src=\"main.js\"></script>",
            String::new(),
        ),
        ("  </body>", format!("{}  </body>", parts.concat())),
    ] {
        if html.matches(from).count() != 1 {
            return Err(format!("index.html does not contain {from} once").into());
        }
        html = html.replace(from, &to);
    }
    Ok(html)
}
