//! The deformed lens and substrate in section.

use crate::axis::Span;
use crate::chart::MARGIN;
use crate::error::FigureError;
use crate::figure::{Figure, PAGE};
use crate::font::Bounds;
use crate::frame::{ASCENT, DESCENT, Frame, Lettering, NOTE_SIZE};
use crate::map::RED;
use crate::scene::{Anchor, Colour, Fill, Item, Label, Path, Stroke};
use crate::text::Text;
use crate::unit::{Unit, significant};
use fakir::problem::Point;
use fakir::state::{ContactState, Run};
use std::collections::HashMap;

const LENS: Colour = Colour([198, 221, 240]);
const SUBSTRATE: Colour = Colour([226, 214, 196]);

/// Places along x at which the surfaces are drawn, besides pillar edges.
const SAMPLES: usize = 600;

/// Places beside a pillar, in pillar radii from its edge.
const BESIDE: [f64; 8] = [1e-6, 3e-3, 0.01, 0.03, 0.06, 0.1, 0.2, 0.35];

/// A state and its name in the figure.
#[derive(Debug, Clone)]
pub struct ProfileState<'a> {
    /// What stands in the panel, such as `mid load`.
    pub label: Text,
    /// The state.
    pub state: &'a ContactState,
    /// Where it touches the floor, m, if it does.
    pub floor_contact: Option<Point>,
}

/// Section through lens and substrate along x, through the lens axis, one panel for every state,
/// all on the same scales.
///
/// Heights are over the undeformed floor. The displacement `w` belongs to both bodies, to each in
/// proportion to its compliance `(1 - nu^2)/E`; pillars also shorten under their force. The gap is
/// that of the solution, whichever the shares. The vertical exaggeration is stated. An arrow marks
/// the floor contact if it is in the section or a symmetric copy of it is.
///
/// # Errors
/// [`FigureError::TooFewData`] without states, [`FigureError::NoPillars`] if one carries a force but
/// has no fields, interruption.
pub fn profiles(states: &[ProfileState<'_>], run: &Run<'_>) -> Result<Figure, FigureError> {
    let Some(widest) = states
        .iter()
        .max_by(|a, b| a.state.contact_radius.total_cmp(&b.state.contact_radius))
    else {
        return Err(FigureError::TooFewData {
            fewest: 1,
            given: 0,
        });
    };
    let system = &widest.state.system;
    let [x, y] = widest.state.smallest_gap_position;
    let half_width = (1.3 * widest.state.contact_radius)
        .max(3.0 * x.hypot(y))
        .max(6.0 * system.pillar().diameter);
    let sections: Result<Vec<Section>, FigureError> = states
        .iter()
        .map(|state| Section::new(state.state, half_width, run))
        .collect();
    let sections = sections?;
    let heights = heights(&sections, system.pillar().height);
    let x_unit = Unit::of_length(half_width);
    let y_unit = Unit::of_length(heights[1].max(-heights[0]));
    let x = Span::linear(-x_unit.of(half_width), x_unit.of(half_width));
    let y = Span::linear(y_unit.of(heights[0]), y_unit.of(heights[1]));
    let names = [
        Text::from(format!("*x* ({})", x_unit.name)),
        Text::from(format!("height ({})", y_unit.name)),
    ];
    let height = 92.0;
    let left = MARGIN + Frame::left_room(y, height, Lettering::All(&names[1]));
    let bounds = |top| Bounds::new(left, top, PAGE - left - MARGIN - 6.0, height);
    let mut items = Vec::new();
    let mut top = MARGIN + 2.0;
    let last = sections.len() - 1;
    for (k, (section, state)) in sections.iter().zip(states).enumerate() {
        top += NOTE_SIZE * (ASCENT + DESCENT);
        let frame = Frame {
            bounds: bounds(top),
            x,
            y,
        };
        let across = if k == last {
            Lettering::All(&names[0])
        } else {
            Lettering::None
        };
        let page = Page {
            frame,
            x_unit,
            y_unit,
        };
        page.draw(section, state, &mut items);
        frame.draw(&mut items, across, Lettering::All(&names[1]));
        let letter = ('a'..='z').nth(k).filter(|_| last > 0);
        title(&page, state, letter, &mut items);
        top += height + Frame::bottom_room(across) + 3.0;
    }
    let figure = Figure::new("profiles", [PAGE, top + MARGIN - 3.0], items);
    Ok(figure.with_description(
        "Deformed lens and substrate in section",
        "Section along x through the lens axis, a panel for every state: the lens above, the \
         substrate with its pillars below, heights exaggerated as stated.",
    ))
}

/// Range of heights shown, m.
fn heights(sections: &[Section], pillar_height: f64) -> [f64; 2] {
    let floors = sections.iter().flat_map(|s| &s.substrate).map(|p| p[1]);
    let lowest = floors.fold(0.0, f64::min);
    let depth = pillar_height - lowest;
    [lowest - 0.3 * depth, pillar_height + 0.75 * depth]
}

/// Outlines of both bodies, m.
struct Section {
    lens: Vec<[f64; 2]>,
    substrate: Vec<[f64; 2]>,
}

impl Section {
    fn new(state: &ContactState, half_width: f64, run: &Run<'_>) -> Result<Self, FigureError> {
        let system = &state.system;
        let stretches = pillar_stretches(state, half_width);
        let mut across: Vec<f64> = (0..=SAMPLES)
            .map(|k| half_width * (2.0 * k as f64 / SAMPLES as f64 - 1.0))
            .collect();
        let inside = |x: &f64| x.abs() <= half_width;
        let radius = 0.5 * system.pillar().diameter;
        for ([start, end], _) in &stretches {
            across.extend([*start, *end]);
            // Beside a pillar the surfaces are steep.
            for distance in BESIDE {
                across.extend([start - distance * radius, end + distance * radius]);
            }
        }
        across.retain(inside);
        across.sort_by(f64::total_cmp);
        across.dedup();

        let displacement = match state.fields.as_deref() {
            Some(fields) => fields.on_grid(&across, &[0.0], run)?.displacement,
            None if state.force > 0.0 => {
                return Err(FigureError::NoPillars {
                    method: state.method.name(),
                });
            }
            None => vec![0.0; across.len()],
        };
        let lens_share =
            system.lens().material.plane_strain_compliance() / system.contact_compliance();
        let height = system.pillar().height;
        let lens = across
            .iter()
            .zip(&displacement)
            .map(|(x, w)| {
                let sag = system.lens().sag(x.abs());
                [*x, height + sag - state.indentation + lens_share * w]
            })
            .collect();
        let mut substrate = Vec::new();
        let mut was_on: Option<usize> = None;
        for (x, w) in across.iter().zip(&displacement) {
            let floor = -(1.0 - lens_share) * w;
            let on = stretches
                .iter()
                .position(|([start, end], _)| (start..=end).contains(&x));
            let top = |k: usize| floor + height - stretches[k].1;
            // A pillar's side is where its first and last points are.
            match (was_on, on) {
                (None, Some(k)) => substrate.extend([[*x, floor], [*x, top(k)]]),
                (_, Some(k)) => substrate.push([*x, top(k)]),
                (_, None) => substrate.push([*x, floor]),
            }
            was_on = on;
        }
        Ok(Self { lens, substrate })
    }
}

/// Where pillars are cut by the section, and by how much each is shortened.
fn pillar_stretches(state: &ContactState, half_width: f64) -> Vec<([f64; 2], f64)> {
    let (lattice, pillar) = (state.system.lattice(), state.system.pillar());
    let force: HashMap<(i64, i64), f64> =
        state.pillars.iter().map(|p| (p.index, p.force)).collect();
    let radius = 0.5 * pillar.diameter;
    let (middle_i, middle_j) = lattice.nearest_pillar([0.0, 0.0]);
    let reach = (1.3 * (half_width + pillar.diameter) / lattice.pitch).ceil() as i64 + 2;
    let mut stretches = Vec::new();
    for i in -reach..=reach {
        for j in -reach..=reach {
            let index = (middle_i + i, middle_j + j);
            let [x, y] = lattice.centre(index.0, index.1);
            let half = (radius * radius - y * y).max(0.0).sqrt();
            if half > 0.0 && x.abs() - half < half_width {
                let sink = force
                    .get(&index)
                    .map_or(0.0, |force| force * state.system.column_compliance());
                stretches.push(([x - half, x + half], sink));
            }
        }
    }
    stretches.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]));
    stretches
}

struct Page {
    frame: Frame,
    x_unit: Unit,
    y_unit: Unit,
}

impl Page {
    fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        self.frame.place([self.x_unit.of(x), self.y_unit.of(y)])
    }

    /// Heights on the page over heights to the scale of x.
    fn exaggeration(&self) -> f64 {
        let [a, b] = [self.place([0.0, 0.0]), self.place([1e-6, 1e-6])];
        (a[1] - b[1]) / (b[0] - a[0])
    }

    fn draw(&self, section: &Section, state: &ProfileState<'_>, items: &mut Vec<Item>) {
        let bounds = self.frame.bounds;
        let body = |outline: &[[f64; 2]], far: f64, fill: Colour| {
            let places: Vec<[f64; 2]> = outline.iter().map(|p| self.place(*p)).collect();
            let ends = places.first().zip(places.last());
            let corners = ends.map_or(Vec::new(), |(first, last)| {
                vec![[last[0], far], [first[0], far]]
            });
            [
                Item::Path {
                    path: Path::polygon(places.iter().copied().chain(corners)),
                    fill: Some(Fill::Colour(fill)),
                    stroke: None,
                },
                Item::stroked(Path::line(places), Stroke::solid(Colour::BLACK, 0.6)),
            ]
        };
        let mut inside = Vec::new();
        inside.extend(body(&section.lens, bounds.top - 5.0, LENS));
        inside.extend(body(&section.substrate, bounds.bottom + 5.0, SUBSTRATE));
        for x in floor_contacts_in_section(state) {
            self.arrow(section, x, &mut inside);
        }
        items.push(Item::Clipped {
            bounds,
            items: inside,
        });
    }

    /// From below, to the floor at x.
    fn arrow(&self, section: &Section, x: f64, items: &mut Vec<Item>) {
        let near = |p: &&[f64; 2]| (p[0] - x).abs();
        let Some(point) = section
            .lens
            .iter()
            .min_by(|a, b| near(a).total_cmp(&near(b)))
        else {
            return;
        };
        let [x, y] = self.place([x, point[1]]);
        let tip = y + 1.2;
        items.push(Item::stroked(
            Path::line([[x, tip + 3.0], [x, tip + 12.0]]),
            Stroke::solid(RED, 1.0),
        ));
        items.push(Item::filled(
            Path::polygon([[x, tip], [x - 2.0, tip + 4.5], [x + 2.0, tip + 4.5]]),
            RED,
        ));
    }
}

/// Places x at which symmetric copies of the floor contact lie in the section.
fn floor_contacts_in_section(state: &ProfileState<'_>) -> Vec<f64> {
    let lattice = state.state.system.lattice();
    let Some(point) = state.floor_contact else {
        return Vec::new();
    };
    crate::map::symmetric_copies(lattice, point)
        .into_iter()
        .filter(|[_, y]| y.abs() < 0.02 * lattice.pitch)
        .map(|[x, _]| x)
        .collect()
}

/// Above the panel: its letter and state at the left, exaggeration at the right.
fn title(page: &Page, state: &ProfileState<'_>, letter: Option<char>, items: &mut Vec<Item>) {
    let bounds = page.frame.bounds;
    let y = bounds.top - DESCENT * NOTE_SIZE - 1.0;
    let letter = letter.map_or(String::new(), |letter| format!("({letter}) "));
    let force = Unit::of_force(state.state.force);
    let length = Unit::of_length(state.state.indentation);
    let name = Text::plain(&letter)
        .followed_by(state.label.clone())
        .followed_by(format!(
            ": *F* = {}, *ζ* = {}",
            or_zero(force, state.state.force),
            or_zero(length, state.state.indentation)
        ));
    items.push(Item::Label(Label::new(
        name,
        [bounds.left, y],
        NOTE_SIZE,
        Anchor::Start,
    )));
    let note = match floor_note(state) {
        Some(floor) => format!("{floor}heights × {}", significant(page.exaggeration(), 2)),
        None => format!("heights × {}", significant(page.exaggeration(), 2)),
    };
    items.push(Item::Label(Label::new(
        note,
        [bounds.right, y],
        NOTE_SIZE,
        Anchor::End,
    )));
}

fn or_zero(unit: Unit, value: f64) -> String {
    if value == 0.0 {
        "0".to_owned()
    } else {
        unit.text(value, 3)
    }
}

/// Where the floor is touched, if the section does not show it.
fn floor_note(state: &ProfileState<'_>) -> Option<String> {
    let [x, y] = state.floor_contact?;
    if !floor_contacts_in_section(state).is_empty() {
        return Some("arrows: floor contact; ".to_owned());
    }
    let unit = Unit::of_length(x.hypot(y));
    Some(format!(
        "floor contact outside the section, at ({}, {}) {}; ",
        significant(unit.of(x), 3),
        significant(unit.of(y), 3),
        unit.name
    ))
}
