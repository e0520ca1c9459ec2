//! Phase diagram: force against contact radius, with the region of top contact.

use crate::axis::Axis;
use crate::chart::{Chart, MARGIN, Shade};
use crate::colour::Tint;
use crate::figure::{COLUMN, Figure};
use crate::font::Bounds;
use crate::frame::{ASCENT, DESCENT, Frame, Lettering, NOTE_SIZE};
use crate::legend::{Legend, place_where};
use crate::scene::{Anchor, Colour, Item, Label};
use crate::series::{Dash, Series, Style};
use crate::text::Text;
use fakir::problem::System;
use fakir::state::Normalized;
use fakir::theory::closed_forms::{Region, phase, transition_force};

/// Data drawn in the phase diagram.
#[derive(Debug, Clone, PartialEq)]
pub struct PhaseDiagram {
    /// Lens, substrate and pillars; the pitch does not matter in reduced variables.
    pub system: System,
    /// Critical states: points (`a/e`, `F_c gamma_int/(h d)`) from [`phase_point`], for example a
    /// series for every offset.
    pub critical: Vec<Series>,
    /// Loading paths: points (`a/e`, `F gamma_int/(h d)`) by increasing load, for example a series
    /// for every surface fraction. A path that ends at its critical state ends at the corresponding
    /// point.
    pub paths: Vec<Series>,
    /// Lines in the region of mixed contact: points (`a/e`, `F gamma_int/(h d)`) of equal floor
    /// share.
    pub shares: Vec<Series>,
}

/// Returns the point (`a/e`, `F gamma_int/(h d)`) of a state under `force` (N), for the series of a
/// [`PhaseDiagram`].
///
/// Here `a` is the radius of the contact on the pillar tops (m), also for critical states: their critical
/// contact radius may be the distance of the floor contact, which is not defined on a loading path.
#[must_use]
pub fn phase_point(system: &System, force: f64, top_contact_radius: f64) -> [f64; 2] {
    let reduced = Normalized::new(system, force, top_contact_radius, 0.0);
    [reduced.contact_radius, reduced.force]
}

const TOP: Colour = Colour([221, 235, 247]);
const MIXED: Colour = Colour([250, 228, 208]);

/// The phase diagram of the paper: reduced force against the radius of the contact on the pillar tops, in
/// pitches, with the regions of [`phase`].
///
/// Below the transition curve ([`transition_force`]) the lens rests on pillar tops only; above it,
/// it also touches the floor. Beyond a contact radius of one pitch, force and contact radius
/// determine which; below (paler background) the position of the lens axis matters too, and the
/// curve applies to an axis on a pillar.
#[must_use]
pub fn phase_diagram(diagram: &PhaseDiagram) -> Figure {
    let mut series = diagram.paths.clone();
    series.extend(diagram.shares.iter().cloned());
    series.extend(diagram.critical.iter().cloned());
    let x = Axis::logarithmic("radius of the contact on the tops over pitch *a*/*e*");
    let y = Axis::logarithmic("reduced force *F* *γ*_{int}/(*h* *d*)");
    let mut spans = [
        x.span(series.iter().flat_map(|s| s.values(0)).chain([0.3, 10.0])),
        y.span(series.iter().flat_map(|s| s.values(1)).chain([0.3, 100.0])),
    ];
    // Extra space for the names of the regions.
    spans[1].range[0] *= 0.7;
    spans[1].range[1] *= 2.0;
    let [x_span, y_span] = spans;
    let curve = transition_curve(&diagram.system, x_span.range);
    let transition = Series::new(
        "transition curve",
        curve.clone(),
        Style::line(0).in_tint(Tint::Black),
    );
    series.insert(0, transition);
    let one_pitch = vec![[1.0, y_span.range[0]], [1.0, y_span.range[1]]];
    let boundary = Style::line(0).in_tint(Tint::Black).with_line(Dash::Dotted);
    series.insert(1, Series::new("one pitch, *a* = *e*", one_pitch, boundary));

    let mut chart = Chart::new(x, y, series);
    chart.shades = shades(&curve, x_span.range, y_span.range);
    let lettering = [
        Lettering::All(&chart.x.label),
        Lettering::All(&chart.y.label),
    ];
    let height = 0.86 * COLUMN;
    let left = MARGIN + Frame::left_space(y_span, height, lettering[1]);
    let frame = Frame {
        bounds: Bounds::new(left, MARGIN + 2.0, COLUMN - left - MARGIN - 4.0, height),
        x: x_span,
        y: y_span,
    };
    let (ground, data) = chart.contents(&frame);
    let mut items = ground;
    items.extend(data.iter().cloned());
    // Two legends, one for lines and one for markers, fit between the data more easily than one.
    let (marked, drawn) = chart
        .series
        .iter()
        .partition::<Vec<_>, _>(|s| s.style.line.is_none());
    let mut taken = data;
    let mut left = Legend::default();
    for legend in [Legend::of(drawn), Legend::of(marked)] {
        match legend.inside(&frame.bounds, &taken) {
            Some(legend) => {
                items.extend(legend.iter().cloned());
                taken.extend(legend);
            }
            None => left.extend(&legend),
        }
    }
    items.extend(region_names(&diagram.system, &frame, &taken));
    frame.draw(&mut items, lettering[0], lettering[1]);
    let mut end = frame.bounds.bottom + Frame::bottom_space(lettering[0]) + MARGIN;
    end += left.draw_below([0.5 * COLUMN, end], COLUMN - 2.0 * MARGIN, &mut items);
    Figure::new("phase-diagram", [COLUMN, end + MARGIN], items).with_description(
        "Phase diagram: reduced force over the contact radius",
        "Reduced force against the radius of the contact on the pillar tops, in pitches. Below the transition curve the lens rests on \
         pillar tops only, above it also touches the floor between them; left of one pitch the \
         outcome depends on where the lens lands.",
    )
}

/// The transition force is constant below one pitch and continuous: both parts are 1 at one pitch.
fn transition_curve(system: &System, [first, last]: [f64; 2]) -> Vec<[f64; 2]> {
    let pillar = system.pillar();
    let reduce = system.internal_compliance() / (pillar.height * pillar.diameter);
    let pitch = system.pitch();
    (0..=240)
        .map(|k| {
            let ratio = first * (last / first).powf(f64::from(k) / 240.0);
            [ratio, reduce * transition_force(system, ratio * pitch)]
        })
        .collect()
}

fn shades(curve: &[[f64; 2]], x: [f64; 2], y: [f64; 2]) -> Vec<Shade> {
    let side = |discrete: bool, above: bool| {
        let edge = if above { y[1] } else { y[0] };
        let inside = |p: &&[f64; 2]| (p[0] <= 1.0) == discrete;
        let mut corners: Vec<[f64; 2]> = curve.iter().filter(inside).copied().collect();
        let level = curve[0][1];
        if discrete {
            corners.push([1.0, level]);
            corners.extend([[1.0, edge], [x[0], edge]]);
        } else {
            corners.insert(0, [1.0, level]);
            corners.extend([[x[1], edge], [1.0, edge]]);
        }
        let colour = if above { MIXED } else { TOP };
        let colour = if discrete {
            colour.lighter(0.55)
        } else {
            colour
        };
        Shade { corners, colour }
    };
    [(true, false), (true, true), (false, false), (false, true)]
        .into_iter()
        .map(|(discrete, above)| side(discrete, above))
        .collect()
}

/// Name of every region, at the emptiest place well inside it.
fn region_names(system: &System, frame: &Frame, data: &[Item]) -> Vec<Item> {
    let pitch = system.pitch();
    let pillar = system.pillar();
    let reduce = system.internal_compliance() / (pillar.height * pillar.diameter);
    let names = [
        (Region::Top, false, "top"),
        (Region::Mixed, false, "mixed"),
        (Region::Top, true, "deterministic, top"),
        (Region::Mixed, true, "deterministic, mixed"),
    ];
    let mut labels: Vec<Item> = Vec::new();
    for (region, deterministic, name) in names {
        let text = Text::from(format!("*{name}*"));
        let size = [NOTE_SIZE * text.width(), NOTE_SIZE * (ASCENT + DESCENT)];
        let inside = |bounds: &Bounds| {
            let corners = [
                [bounds.left, bounds.top],
                [bounds.right, bounds.bottom],
                [bounds.left, bounds.bottom],
                [bounds.right, bounds.top],
            ];
            corners.iter().all(|place| {
                let [ratio, force] = frame.value(*place);
                let phase = phase(system, force / reduce, ratio * pitch);
                phase.region == region && phase.deterministic == deterministic
            })
        };
        let free = |bounds: &Bounds| {
            let padded = bounds.grown(2.0);
            inside(bounds)
                && !data
                    .iter()
                    .chain(&labels)
                    .any(|item| item.comes_into(&padded))
        };
        let centre = |[x, y]: [f64; 2]| (x - 0.5).abs() + (y - 0.5).abs();
        if let Some([x, y]) = place_where(&frame.bounds, size, centre, free) {
            let at = [x, y + ASCENT * NOTE_SIZE];
            labels.push(Item::Label(Label::new(text, at, NOTE_SIZE, Anchor::Start)));
        }
    }
    labels
}
