//! The page: a document, a style and scripts, built from `page/` and part of the program, so that
//! nothing is loaded from elsewhere.

use crate::request::{FARTHEST, MOST_PILLARS};
use axum::body::Body;
use axum::http::{HeaderValue, StatusCode, header};
use axum::response::Response;
use fakir::problem::MeshLayout;
use fakir::problem::PillarCompliance;
use fakir::problem::{Accuracy, Method, PunchForm};
use fakir_case::{Case, Key};
use serde_json::{Map, Value, json};

/// A script of the page, by its name.
macro_rules! script {
    ($name:literal) => {
        (
            concat!($name, ".js"),
            SCRIPT,
            include_str!(concat!("../page/dist/", $name, ".js")),
        )
    };
}

/// The files of the page, by their names below the token.
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
    script!("controls"),
    script!("diagrams"),
    script!("engine"),
    script!("main"),
    script!("map"),
    script!("numbers"),
    script!("readouts"),
    script!("requests"),
    script!("scene"),
    script!("screen"),
    script!("section"),
    script!("store"),
    script!("theme"),
];

const CSS: &str = "text/css; charset=utf-8";
const SCRIPT: &str = "text/javascript; charset=utf-8";

/// A file of the page; `start` is what the script begins with.
pub(crate) fn file(name: &str, start: &str) -> Option<Response> {
    let found = FILES.iter().find(|(own, _, _)| *own == name);
    match (found, name) {
        (Some((_, kind, text)), _) => Some(whole(kind, *text)),
        (None, "start.json") => Some(whole("application/json", start.to_owned())),
        (None, "font.css") => Some(whole(CSS, fakir_figure::font_css())),
        (None, _) => None,
    }
}

/// An answer to whoever follows a link by hand.
pub(crate) fn message(status: StatusCode, text: &str) -> Response {
    let mut response = whole("text/plain; charset=utf-8", format!("{text}\n"));
    *response.status_mut() = status;
    response
}

fn whole(kind: &'static str, text: impl Into<Body>) -> Response {
    let mut response = Response::new(text.into());
    let kind = HeaderValue::from_static(kind);
    response.headers_mut().insert(header::CONTENT_TYPE, kind);
    response
}

/// What the page begins with: the case, and what it cannot know by itself.
pub(crate) fn start(case: &Case) -> String {
    let colours: Vec<[u8; 3]> = (0..=255u32)
        .map(|k| {
            let colorous::Color { r, g, b } =
                colorous::VIRIDIS.eval_continuous(f64::from(k) / 255.0);
            [r, g, b]
        })
        .collect();
    json!({
        "version": fakir_study::VERSION,
        "case": values(case),
        "colours": colours,
        "most_pillars": MOST_PILLARS,
        "farthest_load": FARTHEST,
    })
    .to_string()
}

/// The case by its keys, in SI units.
fn values(case: &Case) -> Map<String, Value> {
    let system = &case.system;
    let (lens, pillar, lattice) = (system.lens(), system.pillar(), system.lattice());
    let mut values = Map::new();
    let mut put = |key: Key, value: Value| {
        values.insert(key.path().to_owned(), value);
    };
    put(Key::LensRadius, lens.radius.into());
    put(Key::LensYoungModulus, lens.material.young_modulus.into());
    put(Key::LensPoissonRatio, lens.material.poisson_ratio.into());
    put(
        Key::SubstrateYoungModulus,
        system.substrate().young_modulus.into(),
    );
    put(
        Key::SubstratePoissonRatio,
        system.substrate().poisson_ratio.into(),
    );
    match case.value(Key::Pitch) {
        Some(_) => put(Key::Pitch, lattice.pitch.into()),
        // As it was given: derived from the pitch it could differ in the last digit.
        None => put(
            Key::SurfaceFraction,
            case.value(Key::SurfaceFraction)
                .and_then(|text| text.parse::<f64>().ok())
                .unwrap_or_else(|| system.texture().surface_fraction())
                .into(),
        ),
    }
    put(Key::Offset, lattice.offset.into());
    put(Key::OffsetAngle, lattice.offset_angle.into());
    put(Key::PillarDiameter, pillar.diameter.into());
    put(Key::PillarHeight, pillar.height.into());
    let compliance = match pillar.compliance {
        PillarCompliance::Column => "column",
        PillarCompliance::None => "none",
    };
    put(Key::PillarCompliance, compliance.into());
    put(Key::MethodName, case.method.name().into());
    match case.method {
        Method::Spectral(accuracy) => {
            let accurate = accuracy == Accuracy::Accurate;
            put(
                Key::Accuracy,
                if accurate { "accurate" } else { "default" }.into(),
            );
        }
        Method::Punch(form) => {
            let plain = form == PunchForm::Plain;
            put(Key::Form, if plain { "plain" } else { "corrected" }.into());
        }
        Method::Love(mesh) => {
            put(Key::CellsPerDiameter, mesh.cells_per_diameter.into());
            let pattern = mesh.layout == MeshLayout::Pattern;
            put(
                Key::Mesh,
                if pattern { "pattern" } else { "pillars" }.into(),
            );
            put(
                Key::Cells,
                if mesh.matched { "matched" } else { "plain" }.into(),
            );
        }
        _ => {}
    }
    values
}
