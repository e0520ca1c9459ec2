//! `report.html` of the study: findings, laws and figures in one self-contained file.

use super::findings::{Checked, Finding, RUBBER};
use super::study::{Cases, LEAST_THRESHOLD, same};
use crate::claims::{percent, short};
use crate::figures::Plate;
use crate::grid::Substrate;
use crate::report::{figures, formatted, page, symbols};
use fakir_study::VERSION;
use fakir_study::citations::Citation;
use maud::{Markup, html};

/// Content of the report.
#[derive(Clone, Copy)]
pub(crate) struct Page<'a> {
    pub(crate) findings: &'a [Finding],
    pub(crate) laws: &'a [Checked],
    pub(crate) plates: &'a [Plate],
    pub(crate) cases: &'a Cases,
    pub(crate) citations: &'a [Citation],
    pub(crate) count: usize,
    pub(crate) failed: usize,
}

const TITLE: &str = "The adhesive fakir: adhesion on tops and floor";

const SYMBOLS: [(&str, &str); 11] = [
    (
        "φ",
        "surface fraction: fraction of the surface covered by pillar tops",
    ),
    ("d, h, a", "diameter, height and radius of a pillar"),
    (
        "R, E",
        "radius of the lens, reduced modulus of lens and substrate",
    ),
    ("w", "work of adhesion, of tops and floor alike"),
    (
        "w_c",
        "work of adhesion above which the flat lattice collapses onto the floor without load (closed form)",
    ),
    (
        "κ",
        "compliance of a pillar as a column, over that as a flat punch",
    ),
    (
        "F_c, ζ_c, a_c",
        "force, indentation and contact radius at first contact with the floor",
    ),
    (
        "F, A",
        "force, and area of the bonded floor, just after the jump at ζ_c",
    ),
    (
        "ζ_lost",
        "indentation at which the floor is lost on the way back",
    ),
    ("F_off", "largest tensile force while the floor is attached"),
    (
        "W",
        "hysteresis: area between loading and unloading until the floor detaches, for unloading from 1.2 ζ_c",
    ),
];

impl Page<'_> {
    /// The page.
    pub(crate) fn html(&self) -> String {
        page(
            TITLE,
            &html! {
                (self.head())
                (symbols(&SYMBOLS))
                (self.found())
                (self.power_laws())
                (self.rubber())
                (figures(self.plates))
                (self.end())
            },
        )
    }

    fn head(&self) -> Markup {
        html! {
            h1 { (TITLE) }
            p {
                "The parametric study that was announced at the end of R. Ledesma-Alonso, E. Raphaël, F. Restagno, C. Poulard, "
                a href="https://doi.org/10.1103/PhysRevE.104.055007" { "Phys. Rev. E 104, 055007 (2021)" }
                ", by fakir " (VERSION) ": " (self.count) " cases. "
                @if self.failed > 0 {
                    strong { (self.failed) " of them have no solution: see the tables." }
                }
            }
            p {
                "Methods: the critical state and the tops alone are exact; the adhesive floor is computed by the fast model of a collapsed floor (free annuli as cracks in a bonded disc, \
                 a circular front), with its validity in the columns " code { "jump_validity" } " and " code { "unloading_validity" } " of every row, and beyond its range at small works of adhesion, where the floor bonds at each hollow site separately, on cells, each with its error; \
                 thresholds, annuli and the smooth floor are closed forms."
            }
        }
    }

    fn found(&self) -> Markup {
        html! {
            h2 { "What was found" }
            div.scroll { table { tbody {
                @for finding in self.findings {
                    tr id=(finding.name) {
                        td { strong { (finding.title) } }
                        td { (formatted(&finding.text)) }
                    }
                }
            } } }
            p { "The numbers, in full, are in " code { "tables/findings.csv" } "." }
        }
    }

    fn power_laws(&self) -> Markup {
        html! {
            h2 { "Laws" }
            p {
                "Least squares, in logarithms but for the pull-off, over the rigid and the intermediate substrate and other heights and diameters, on cells or in the range of the model, from w = " (LEAST_THRESHOLD) " w" sub { "c" } " on: below, patches that are small compared with the hollow sites detach like spheres and are not affected by the pillars. Heights and lengths along the surface scale independently, so that no \
                 other groups are possible. Selected is the smallest number of groups whose residual in cross-validation, in which each system is compared with a law fitted to the others, is within 15 % of the smallest; all candidates are in "
                code { "tables/laws.csv" } "."
            }
            div.scroll { table {
                thead { tr {
                    th { "Quantity" } th { "Law" } th.n { "cases" } th.n { "scatter" } th.n { "largest" } th.n { "19 of 20 within" } th.n { "other systems" } th.n { "of them within" }
                } }
                tbody {
                    @for (law, held) in self.laws {
                        tr {
                            td { (formatted(law.reduced.plain())) }
                            td { (formatted(&law.words())) }
                            td.n { (law.points) }
                            td.n { (percent(law.scatter)) }
                            td.n { (percent(law.largest)) }
                            td.n { (percent(law.band)) (formatted(law.unit())) }
                            @if let Some(held) = held {
                                td.n { (percent(held.scatter)) ", " (percent(held.largest)) " at most" }
                                td.n { (held.in_band) " of " (held.points) }
                            } @else {
                                td.n { "-" } td.n { "-" }
                            }
                        }
                    }
                }
            } }
        }
    }

    fn rubber(&self) -> Markup {
        let force = |value: Option<f64>| value.map_or("-".to_owned(), |value| short(1e3 * value));
        html! {
            h2 { "The paper's experiments with 50 mJ/m" sup { "2" } }
            p {
                "Intermediate substrate, lens axis on a pillar, by the fast model. Rows outside its range state the reason, and are orders of magnitude."
            }
            div.scroll { table {
                thead { tr {
                    th.n { "φ" } th.n { "w/w" sub { "c" } } th.n { "F" sub { "c" } " (mN)" } th.n { "after the jump (mN)" }
                    th.n { "holes" } th.n { "lost at ζ/ζ" sub { "c" } } th.n { "pull-off with the floor (mN)" } th.n { "tops alone (mN)" } th { "validity" }
                } }
                tbody {
                    @for case in self.cases.on_pillar(Substrate::Intermediate).filter(|case| same(case.found.work, RUBBER)) {
                        @let found = &case.found;
                        tr {
                            td.n { (format!("{:.3}", found.surface_fraction)) }
                            td.n { (short(found.work_over_collapse_work)) }
                            td.n { (short(1e3 * found.critical_force)) }
                            td.n { (force(found.jump.map(|jump| jump.force))) }
                            td.n { @if let Some(jump) = found.jump { (jump.holes) } @else { "-" } }
                            td.n {
                                @if let Some(lost) = found.lost { (format!("{:.2}", lost.indentation / found.critical_indentation)) }
                                @else { "-" }
                            }
                            td.n { (force(found.pull_off)) }
                            td.n { (force(self.cases.tops_of(case).and_then(|tops| tops.pull_off))) }
                            td { (found.unloading_validity.name().replace('_', " ")) }
                        }
                    }
                }
            } }
        }
    }

    fn end(&self) -> Markup {
        html! {
            h2 { "What is left out" }
            p {
                "In the fast model, fronts that are not circles, partially bonded tops while the floor is attached, and regions of one patch per hollow site; on cells, hysteresis, as those cycles are unloaded from first contact; in both, works of adhesion that differ between making and breaking contact, friction, the finite range of \
                 attraction, and strains beyond linear elasticity, which occur at steps steeper than 1 beside pillars."
            }
            h2 { "Files, and how to make them again" }
            p {
                "Made by " code { "fakir reproduce adhesion --output FOLDER" } ". The folders " code { "floor" } ", " code { "tops" } ", " code { "sizes" } ", " code { "offsets" } ", " code { "check" } " and " code { "cells" } " are those of "
                code { "fakir sweep" } ": the " code { "study.toml" } " of each can be run by itself. Every figure is in " code { "figures" } " as SVG and PNG, the tables are in " code { "tables" } "."
            }
            h2 { "To be cited" }
            ul { @for citation in self.citations { li { (citation.text()) } } }
        }
    }
}
