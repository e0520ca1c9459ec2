//! Descriptions of cases with general surfaces.

use crate::numbers::{DIGITS, LENGTH_DIGITS, significant, with_unit};
use fakir::problem::pattern::{CrossSection, Pattern};
use fakir::problem::{Arrangement, Boundary};
use fakir_case::unit::Dimension;
use fakir_case::{SurfaceCase, SurfaceOrigin};

/// Description of the surface and of the method, one line each.
#[must_use]
pub fn description(case: &SurfaceCase) -> [String; 2] {
    let surface = match &case.origin {
        SurfaceOrigin::HeightMap(path) => format!("height map {}", path.display()),
        SurfaceOrigin::Pattern(pattern) => pattern_line(pattern),
    };
    let grid = case.system.surface().grid();
    let length = |value: f64| with_unit(value, Dimension::Length, LENGTH_DIGITS);
    let [width, height] = grid.cell();
    let sizes = [
        width,
        height,
        width * grid.columns() as f64,
        height * grid.rows() as f64,
    ];
    let [width, height, across, along] = sizes.map(length);
    let around = match case.system.boundary() {
        Boundary::FreeSpace => "free around it",
        Boundary::Periodic => "periodic",
    };
    let cells = format!(
        "elements, {} by {} cells of {width} by {height}; {across} by {along}, {around}",
        grid.columns(),
        grid.rows()
    );
    [surface, cells]
}

/// Description of a pattern in one line: `square pillars on a square lattice, surface fraction 0.2`.
fn pattern_line(pattern: &Pattern) -> String {
    let outline = match pattern.pillar.cross_section {
        CrossSection::Circle { .. } => "round".to_owned(),
        CrossSection::Square { .. } => "square".to_owned(),
        CrossSection::Polygon { sides, .. } => format!("{sides}-sided"),
        CrossSection::Ellipse { .. } => "elliptical".to_owned(),
    };
    let arrangement = &pattern.arrangement;
    let place = match arrangement {
        Arrangement::Random(places) => format!("at random, seed {}", places.disorder.heights.seed),
        lattice => format!(
            "on a {} lattice, pitch {}",
            lattice.name(),
            with_unit(lattice.pitch(), Dimension::Length, DIGITS)
        ),
    };
    format!(
        "{outline} pillars {place}, surface fraction {}",
        significant(pattern.surface_fraction(), LENGTH_DIGITS)
    )
}
