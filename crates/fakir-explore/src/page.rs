//! The page: document, style sheet and scripts in `page/`, embedded in the program, so that nothing is
//! loaded from elsewhere.

use crate::http::{Response, whole};
use hyper::StatusCode;
use std::sync::LazyLock;

/// A script of the page, by its name.
macro_rules! script {
    ($name:literal) => {
        (
            concat!($name, ".js"),
            SCRIPT,
            include_str!(concat!("../page/", $name, ".js")),
        )
    };
}

/// Files of the page, by their names below the token.
const FILES: &[(&str, &str, &str)] = &[
    ("style.css", CSS, include_str!("../page/style.css")),
    script!("actions"),
    script!("address"),
    script!("charts"),
    script!("compare"),
    script!("controls"),
    script!("diagrams"),
    script!("engine"),
    script!("hold"),
    script!("lecture"),
    script!("main"),
    script!("map"),
    script!("measured"),
    script!("module"),
    script!("numbers"),
    script!("readouts"),
    script!("requests"),
    script!("scene"),
    script!("screen"),
    script!("section"),
    script!("server"),
    script!("shown"),
    script!("sketch"),
    script!("store"),
    script!("surface"),
    script!("table"),
    script!("theme"),
    script!("zoom"),
];

const CSS: &str = "text/css; charset=utf-8";
const SCRIPT: &str = "text/javascript; charset=utf-8";

/// The script with which the page starts.
const MAIN: &str = "<script type=\"module\" src=\"main.js\"></script>";

/// The document. The browser is told of all scripts and of the initial data at once, in place of one script after the other.
static DOCUMENT: LazyLock<String> = LazyLock::new(|| {
    let scripts = FILES.iter().filter(|(_, kind, _)| *kind == SCRIPT);
    let early: String = scripts
        .map(|(name, ..)| format!("<link rel=\"modulepreload\" href=\"{name}\">\n    "))
        .collect();
    let data = "<link rel=\"preload\" href=\"start.json\" as=\"fetch\" crossorigin>\n    ";
    include_str!("../page/index.html").replace(MAIN, &format!("{early}{data}{MAIN}"))
});

/// Returns a file of the page; `start` is the initial data for the script.
pub(crate) fn file(name: &str, start: &str) -> Option<Response> {
    let found = FILES.iter().find(|(own, _, _)| *own == name);
    match (found, name) {
        (_, "") => Some(whole("text/html; charset=utf-8", DOCUMENT.as_str())),
        (Some((_, kind, text)), _) => Some(whole(kind, *text)),
        (None, "start.json") => Some(whole("application/json", start.to_owned())),
        (None, "font.css") => Some(whole(CSS, fakir_figure::font_css())),
        (None, _) => None,
    }
}

/// Response to a browser that opens an unknown address.
pub(crate) fn message(status: StatusCode, text: &str) -> Response {
    let mut response = whole("text/plain; charset=utf-8", format!("{text}\n"));
    *response.status_mut() = status;
    response
}
