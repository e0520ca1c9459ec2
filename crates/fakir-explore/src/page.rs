//! The page: document, style sheet and scripts in `page/`, embedded in the program, so that nothing is
//! loaded from elsewhere.

use crate::http::{Response, whole};
use hyper::StatusCode;

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
    (
        "",
        "text/html; charset=utf-8",
        include_str!("../page/index.html"),
    ),
    ("style.css", CSS, include_str!("../page/style.css")),
    script!("actions"),
    script!("address"),
    script!("charts"),
    script!("compare"),
    script!("controls"),
    script!("diagrams"),
    script!("engine"),
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
    script!("table"),
    script!("theme"),
    script!("zoom"),
];

const CSS: &str = "text/css; charset=utf-8";
const SCRIPT: &str = "text/javascript; charset=utf-8";

/// Returns a file of the page; `start` is the initial data for the script.
pub(crate) fn file(name: &str, start: &str) -> Option<Response> {
    let found = FILES.iter().find(|(own, _, _)| *own == name);
    match (found, name) {
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
