//! `report.html`: one self-contained file with a row for every claim, all figures and the numbers.

use crate::analysis::{PowerLaw, Quantity, state_near};
use crate::claims::{Claim, LAW_RANGES, Verdict, percent};
use crate::figures::Plate;
use crate::grid::{Grid, Substrate};
use fakir_figure::font_css;
use fakir_study::VERSION;
use fakir_study::citations::Citation;
use maud::{DOCTYPE, Markup, PreEscaped, html};

/// Content of the report.
#[derive(Clone, Copy)]
pub struct Report<'a> {
    /// The claims.
    pub claims: &'a [Claim],
    /// The figures.
    pub plates: &'a [Plate],
    /// The numbers.
    pub grid: &'a Grid,
    /// References.
    pub citations: &'a [Citation],
    /// Cases of the sweep without a result.
    pub failed: usize,
}

const STYLE: &str = "
body{font:16px/1.5 system-ui,sans-serif;color:#1a1a1a;background:#fff;margin:0 auto;
max-width:74rem;padding:1.5rem}
h1{font-size:1.7rem;line-height:1.2;margin:.5rem 0}
h2{font-size:1.25rem;margin:2.2rem 0 .6rem;border-bottom:1px solid #ccc;padding-bottom:.2rem}
p{max-width:48rem}
table{border-collapse:collapse;width:100%;font-size:.9rem}
th{text-align:left;border-bottom:2px solid #444;padding:.35rem .6rem;vertical-align:bottom}
td{border-bottom:1px solid #ddd;padding:.45rem .6rem;vertical-align:top}
td.n,th.n{text-align:right;font-variant-numeric:tabular-nums;white-space:nowrap}
.scroll{overflow-x:auto}
.verdict{display:inline-block;white-space:nowrap;padding:0 .5em;border-radius:.8em;border:1px solid}
.agrees{color:#00543d;background:#e0f3ec}
.partly{color:#6b4a00;background:#fdf1d6}
.differs{color:#7c2d00;background:#fbe4d8}
.beyond{color:#003c61;background:#e1eff8}
figure{margin:1.6rem 0}
figure svg{width:min(100%,30rem);height:auto;display:block}
figure.wide svg{width:min(100%,56rem)}
figcaption{font-size:.9rem;max-width:48rem;margin-top:.4rem}
code{font-family:ui-monospace,monospace;font-size:.92em;background:#f3f3f3;padding:0 .25em}
@media print{body{max-width:none;padding:0}figure{break-inside:avoid}}
";

/// Symbols of claims and figures, and their meanings.
const SYMBOLS: [(&str, &str); 14] = [
    (
        "φ",
        "surface fraction: fraction of the surface covered by pillar tops",
    ),
    (
        "e, d, h",
        "pitch of the lattice, diameter and height of a pillar",
    ),
    ("R", "radius of the lens"),
    ("E_s", "Young's modulus of substrate and pillars"),
    (
        "δx/e",
        "offset of the lens axis from a pillar centre, in pitches",
    ),
    (
        "F, a, ζ",
        "force, radius of the contact on the pillar tops, indentation",
    ),
    (
        "F_c, a_c, ζ_c",
        "the same in the critical state, where the lens just reaches the floor; a_c is the larger of a and r_c",
    ),
    ("r_c", "distance of the floor contact from the lens axis"),
    (
        "c",
        "sum of the compliances of lens and substrate, each (1 - ν^2)/E",
    ),
    (
        "γ_int",
        "compliance of a single pillar and the lens: compression γ_int F/d",
    ),
    (
        "k",
        "(2√3/π) Rh/d^2, in the paper's formulas for large contacts",
    ),
    ("μ_c", "r_c^2/2Rh, in the paper's formulas"),
    (
        "β",
        "half of η C_01 γ_ext/γ_int, in the same formulas, with η = d/2e√φ and the fitted coefficient C_01 of the \
         lattice sum G_0; γ_ext: a force moves the surfaces apart by γ_ext F/2r at a distance r",
    ),
    (
        "S",
        "force on the central pillar in the critical state, over hd/γ_int",
    ),
];

/// Symbols and their meanings.
pub(crate) fn symbols(symbols: &[(&str, &str)]) -> Markup {
    html! {
        h2 { "Symbols" }
        div.scroll { table { tbody {
            @for (symbol, meaning) in symbols {
                tr { td { (formatted(symbol)) } td { (formatted(meaning)) } }
            }
        } } }
    }
}

impl Report<'_> {
    /// The page.
    #[must_use]
    pub fn html(&self) -> String {
        page(
            "The unhappy elastic fakir, reproduced",
            &html! {
                (self.head())
                (symbols(&SYMBOLS))
                (self.claims())
                (self.power_laws())
                (self.critical_states())
                (figures(self.plates))
                (self.end())
            },
        )
    }

    fn head(&self) -> Markup {
        let count = |verdict| self.claims.iter().filter(|c| c.verdict == verdict).count();
        html! {
            h1 { "The unhappy elastic fakir, reproduced" }
            p {
                "Every result of R. Ledesma-Alonso, E. Raphaël, F. Restagno, C. Poulard, "
                a href="https://doi.org/10.1103/PhysRevE.104.055007" {
                    "Phys. Rev. E 104, 055007 (2021)"
                }
                ", against the exact solution of the same equations by fakir " (VERSION) "."
            }
            p {
                (self.claims.len()) " claims: " (count(Verdict::Agrees)) " agree, "
                (count(Verdict::Partly)) " agree within limits given here, "
                (count(Verdict::Differs)) " differ for reasons given, "
                (count(Verdict::Beyond)) " beyond what was measured. "
                @if self.failed > 0 {
                    strong { (self.failed) " cases of the sweep have no solution: see the table." }
                }
            }
        }
    }

    fn claims(&self) -> Markup {
        html! {
            h2 { "Claims" }
            div.scroll { table {
                thead { tr { th { "The paper" } th { "Found" } th { "Verdict" } th { "Why" } } }
                tbody {
                    @for claim in self.claims {
                        tr id=(claim.name) {
                            td { (formatted(&claim.claim)) }
                            td { (formatted(&claim.finding)) }
                            td {
                                span class=(format!("verdict {}", class(claim.verdict))) {
                                    (claim.verdict.words())
                                }
                            }
                            td { (formatted(&claim.reason)) }
                        }
                    }
                }
            } }
            p { "The numbers, in full, are in " code { "tables/claims.csv" } "." }
        }
    }

    fn power_laws(&self) -> Markup {
        html! {
            h2 { "Power laws in the surface fraction" }
            p {
                "Exponents by least squares in logarithms, lens axis on a pillar, and the largest deviation of \
                 the curve from the power law. Printed: the paper's large-contact formulas far beyond kφ = 1. Dense: the \
                 limit of a lens on a bare half-space."
            }
            div.scroll { table {
                thead { tr {
                    th { "Quantity" } th { "Substrate" }
                    @for [from, to] in LAW_RANGES { th.n { "φ " (from) " to " (to) } }
                    th.n { "printed" } th.n { "dense" }
                } }
                tbody {
                    @for quantity in Quantity::ALL { @for substrate in Substrate::ALL {
                        tr {
                            td { (quantity.name()) }
                            td { (substrate.name()) }
                            @for range in LAW_RANGES {
                                td.n { (law(self.grid, substrate, quantity, range)) }
                            }
                            td.n { (quantity.printed_exponent()) }
                            td.n { (quantity.dense_exponent()) }
                        }
                    } }
                }
            } }
        }
    }

    fn critical_states(&self) -> Markup {
        html! {
            h2 { "Critical states" }
            p {
                "Lens axis on a pillar; the surface fractions of the sweep nearest to round ones. All \
                 " code { "critical-states/table.csv" } "."
            }
            div.scroll { table {
                thead { tr {
                    th { "Substrate" } th.n { "φ" } th.n { "F" sub { "c" } " (N)" }
                    th.n { "estimated error" } th.n { "ζ" sub { "c" } " (µm)" }
                    th.n { "a" sub { "c" } " (µm)" } th.n { "pillars" } th.n { "partly" }
                } }
                tbody {
                    @for substrate in Substrate::ALL { @for phi in [0.001, 0.003, 0.01, 0.03, 0.1, 0.2] {
                        @if let Some(state) = state_near(self.grid.on_pillar(substrate), phi) {
                            tr {
                                td { (substrate.name()) }
                                td.n { (format!("{:.5}", state.surface_fraction)) }
                                td.n { (format!("{:.5e}", state.force)) }
                                td.n { (format!("{:.0e}", state.relative_error_estimate_force)) }
                                td.n { (format!("{:.4}", 1e6 * state.indentation)) }
                                td.n { (format!("{:.2}", 1e6 * state.contact_radius)) }
                                td.n { (state.pillars_in_contact) }
                                td.n { (state.pillars_partially_in_contact) }
                            }
                        }
                    } }
                }
            } }
        }
    }

    fn end(&self) -> Markup {
        html! {
            h2 { "Files, and how to make them again" }
            p {
                "Made by " code { "fakir reproduce paper --output FOLDER" } ". "
                code { "critical-states" } " is a folder of " code { "fakir sweep" }
                ": its " code { "study.toml" } " can be run by itself. Every figure is in "
                code { "figures" } " as SVG and PNG, the tables are in " code { "tables" } "."
            }
            h2 { "To be cited" }
            ul { @for citation in self.citations { li { (citation.text()) } } }
        }
    }
}

/// A self-contained page with the given body.
pub(crate) fn page(title: &str, body: &Markup) -> String {
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) }
                style { (PreEscaped(font_css())) (PreEscaped(STYLE)) }
            }
            body { (body) }
        }
    }
    .into_string()
}

/// All figures with their captions.
pub(crate) fn figures(plates: &[Plate]) -> Markup {
    html! {
        h2 { "Figures" }
        @for (number, plate) in (1..).zip(plates) {
            figure.wide[plate.figure.size()[0] > 0.1] id=(plate.figure.name()) {
                (PreEscaped(plate.figure.svg_for_page()))
                figcaption { strong { "Figure " (number) ". " } (plate.caption) }
            }
        }
    }
}

/// Text with subscripts (`γ_int`), superscripts (`x^2`, `x^(1/3)`) and code (between backticks).
pub(crate) fn formatted(text: &str) -> Markup {
    let mut rest = text;
    let mut parts: Vec<Markup> = Vec::new();
    while let Some(start) = rest.find(['_', '^', '`']) {
        parts.push(html! { (&rest[..start]) });
        let mark = rest.as_bytes()[start];
        let after = &rest[start + 1..];
        let (inner, left) = match (mark, after.strip_prefix('(')) {
            (b'`', _) => after.split_once('`').unwrap_or((after, "")),
            (b'^', Some(bracketed)) => bracketed.split_once(')').unwrap_or((bracketed, "")),
            _ => {
                let joined = |c: char| c.is_ascii_alphanumeric() || (mark == b'^' && c == '.');
                after.split_at(after.find(|c| !joined(c)).unwrap_or(after.len()))
            }
        };
        parts.push(match mark {
            b'_' => html! { sub { (inner) } },
            b'^' => html! { sup { (inner) } },
            _ => html! { code { (inner) } },
        });
        rest = left;
    }
    html! { @for part in &parts { (part) } (rest) }
}

fn class(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Agrees => "agrees",
        Verdict::Partly => "partly",
        Verdict::Differs => "differs",
        Verdict::Beyond => "beyond",
    }
}

fn law(grid: &Grid, substrate: Substrate, quantity: Quantity, range: [f64; 2]) -> String {
    PowerLaw::of(grid.on_pillar(substrate), quantity, range).map_or("-".to_owned(), |law| {
        format!(
            "{:.3}, within {}",
            law.exponent,
            percent(law.largest_deviation)
        )
    })
}

#[cfg(test)]
mod tests {
    use super::formatted;

    #[test]
    fn scripts_and_code() {
        let page = |text| formatted(text).into_string();
        assert_eq!(page("F_c = x^(1/3)"), "F<sub>c</sub> = x<sup>1/3</sup>");
        assert_eq!(page("φ^2.5, γ_int/2"), "φ<sup>2.5</sup>, γ<sub>int</sub>/2");
        assert_eq!(page("r_c²"), "r<sub>c</sub>²");
        assert_eq!(page("`a b` < c"), "<code>a b</code> &lt; c");
    }
}
