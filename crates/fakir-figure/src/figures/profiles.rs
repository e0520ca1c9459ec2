//! Section of the deformed lens and substrate.

use crate::axis::Span;
use crate::cells::SurfaceState;
use crate::chart::MARGIN;
use crate::error::FigureError;
use crate::figure::{Figure, PAGE};
use crate::font::Bounds;
use crate::frame::{ASCENT, DESCENT, Frame, Lettering, NOTE_SIZE};
use crate::map::RED;
use crate::scene::{Anchor, Colour, Fill, Item, Label, Path, Stroke};
use crate::section::{Section, SectionDetail};
use crate::text::Text;
use crate::unit::{Unit, significant};
use fakir::problem::{Indenter, Point};
use fakir::state::{ContactState, Run};

const LENS: Colour = Colour([198, 221, 240]);
const SUBSTRATE: Colour = Colour([226, 214, 196]);

/// A state and its name in the figure.
#[derive(Debug, Clone)]
pub struct ProfileState<'a> {
    /// Label of the panel, such as `mid load`.
    pub label: Text,
    /// The state.
    pub state: &'a ContactState,
    /// Point of first floor contact, m, if there is one.
    pub floor_contact: Option<Point>,
}

/// Section through lens and substrate along x, through the lens axis: one panel for every state,
/// all with the same scales.
///
/// The outlines are those of [`Section`]. The vertical exaggeration is stated. An arrow marks the first floor contact if it
/// or a symmetric copy is in the section; past the transition the floor in contact is red.
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
    let half_width = Section::half_width(widest.state);
    let detail = SectionDetail::Print;
    let panels: Result<Vec<Panel>, FigureError> = states
        .iter()
        .map(
            |ProfileState {
                 label,
                 state,
                 floor_contact,
             }| {
                Ok(Panel {
                    label: label.clone(),
                    force: state.force,
                    indentation: state.indentation,
                    floor_contact: *floor_contact,
                    section: Section::new(state, half_width, *floor_contact, detail, run)?,
                })
            },
        )
        .collect();
    let heights = [0.0, widest.state.system.pillar().height];
    panel_figure(&panels?, heights, [-half_width, half_width], UNDER_LENS)
}

/// Content of the figure, for its description.
const UNDER_LENS: [&str; 2] = ["Section along x through the lens axis", "lens"];
const UNDER_PLATE: [&str; 2] = ["Section along x", "plate"];

/// Section along x through the lens axis on the cells of a general surface: one panel for every
/// state, all with the same scales. It shows the contact of a lens, or the whole grid if the
/// indenter is a plate or the grid is periodic.
///
/// The displacement is divided between the two bodies in proportion to their compliances; pillars
/// also shorten under their force. Heights are measured as on the undeformed surface.
///
/// # Errors
/// [`FigureError::TooFewData`] without states, or if one shows fewer than two cells.
pub fn surface_profiles(states: &[SurfaceState<'_>]) -> Result<Figure, FigureError> {
    let panels: Result<Vec<Panel>, FigureError> = states
        .iter()
        .map(|state| {
            Ok(Panel {
                label: state.label.clone(),
                force: state.contact.force,
                indentation: state.contact.indentation,
                floor_contact: state.floor_contact,
                section: state.section()?,
            })
        })
        .collect();
    let panels = panels?;
    let ends = |values: &mut dyn Iterator<Item = f64>| {
        values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
            [low.min(value), high.max(value)]
        })
    };
    let sections = || panels.iter().map(|panel| &panel.section);
    let x = ends(&mut sections().flat_map(|section| section.x.iter().copied()));
    let mut heights = ends(&mut sections().flat_map(|section| section.surface.iter().copied()));
    if heights[1] <= heights[0] {
        // An undeformed flat surface: only the indenter has a shape.
        heights = ends(&mut sections().flat_map(|section| section.lens.iter().copied()));
    }
    let under_plate =
        |state: &SurfaceState<'_>| matches!(state.system.indenter(), Indenter::Flat(_));
    let words = if states.iter().any(under_plate) {
        UNDER_PLATE
    } else {
        UNDER_LENS
    };
    panel_figure(&panels, heights, x, words)
}

/// A section with its labels.
struct Panel {
    label: Text,
    /// Force, N.
    force: f64,
    /// m
    indentation: f64,
    /// Point of first floor contact, m, if there is one.
    floor_contact: Option<Point>,
    section: Section,
}

/// Sections one above the other, over a range of x (m), of surfaces whose undeformed heights are in
/// a given range (m).
fn panel_figure(
    panels: &[Panel],
    undeformed: [f64; 2],
    ends: [f64; 2],
    [section, body]: [&str; 2],
) -> Result<Figure, FigureError> {
    let Some(last) = panels.len().checked_sub(1) else {
        return Err(FigureError::TooFewData {
            fewest: 1,
            given: 0,
        });
    };
    let heights = heights(panels, undeformed);
    let x_unit = Unit::of_length(ends[1].max(-ends[0]));
    let y_unit = Unit::of_length(heights[1].max(-heights[0]));
    let x = Span::linear(x_unit.of(ends[0]), x_unit.of(ends[1]));
    let y = Span::linear(y_unit.of(heights[0]), y_unit.of(heights[1]));
    let names = [
        Text::from(format!("*x* ({})", x_unit.name)),
        Text::from(format!("height ({})", y_unit.name)),
    ];
    let height = 92.0;
    let left = MARGIN + Frame::left_space(y, height, Lettering::All(&names[1]));
    let bounds = |top| Bounds::new(left, top, PAGE - left - MARGIN - 6.0, height);
    let mut items = Vec::new();
    let mut top = MARGIN + 2.0;
    for (k, panel) in panels.iter().enumerate() {
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
        page.draw(&panel.section, &mut items);
        frame.draw(&mut items, across, Lettering::All(&names[1]));
        if k == 0 {
            page.name_bodies(body, &mut items);
        }
        let letter = ('a'..='z').nth(k).filter(|_| last > 0);
        title(&page, panel, letter, &mut items);
        top += height + Frame::bottom_space(across) + 3.0;
    }
    let figure = Figure::new("profiles", [PAGE, top + MARGIN - 3.0], items);
    Ok(figure.with_description(
        "Section through the deformed lens and substrate",
        &format!(
            "{section}, a panel for every state: the {body} above, the substrate with its pillars below, \
             heights exaggerated as stated."
        ),
    ))
}

/// Range of heights shown, m.
fn heights(panels: &[Panel], [low, high]: [f64; 2]) -> [f64; 2] {
    let surfaces = panels.iter().flat_map(|panel| &panel.section.surface);
    let lowest = surfaces.copied().fold(low, f64::min);
    let depth = high - lowest;
    [lowest - 0.3 * depth, high + 0.75 * depth]
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

    /// Vertical exaggeration: the scale of heights over the scale of x.
    fn exaggeration(&self) -> f64 {
        let [a, b] = [self.place([0.0, 0.0]), self.place([1e-6, 1e-6])];
        (a[1] - b[1]) / (b[0] - a[0])
    }

    fn draw(&self, section: &Section, items: &mut Vec<Item>) {
        let bounds = self.frame.bounds;
        let body = |heights: &[f64], far: f64, fill: Colour| {
            let outline = section.x.iter().zip(heights);
            let places: Vec<[f64; 2]> = outline.map(|(x, z)| self.place([*x, *z])).collect();
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
        inside.extend(body(&section.surface, bounds.bottom + 5.0, SUBSTRATE));
        for [start, end] in &section.floor_patches {
            let outline = section.x.iter().zip(&section.surface);
            let within = outline.filter(|(x, _)| (*start..=*end).contains(x));
            let places = within.map(|(x, z)| self.place([*x, *z]));
            inside.push(Item::stroked(Path::line(places), Stroke::solid(RED, 1.6)));
        }
        for contact in &section.floor_contacts {
            self.arrow(*contact, &mut inside);
        }
        items.push(Item::clipped(bounds, inside));
    }

    /// Writes the names of the bodies into them: above in the middle, and below at the left, beside the arrows.
    fn name_bodies(&self, upper: &str, items: &mut Vec<Item>) {
        let bounds = self.frame.bounds;
        let above = bounds.top + 5.0 + ASCENT * NOTE_SIZE;
        let below = bounds.bottom - 5.0;
        for (name, at) in [
            (upper, [bounds.centre()[0], above]),
            ("substrate", [bounds.left + 30.0, below]),
        ] {
            items.push(Item::Label(Label::new(name, at, NOTE_SIZE, Anchor::Middle)));
        }
    }

    /// Draws an arrow from below to the point of first floor contact.
    fn arrow(&self, contact: Point, items: &mut Vec<Item>) {
        let [x, y] = self.place(contact);
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

/// Writes above the panel: its letter and state at the left, the exaggeration at the right.
fn title(page: &Page, panel: &Panel, letter: Option<char>, items: &mut Vec<Item>) {
    let bounds = page.frame.bounds;
    let y = bounds.top - DESCENT * NOTE_SIZE - 1.0;
    let letter = letter.map_or(String::new(), |letter| format!("({letter}) "));
    let force = Unit::of_force(panel.force);
    let length = Unit::of_length(panel.indentation);
    let name = Text::plain(&letter)
        .followed_by(panel.label.clone())
        .followed_by(format!(
            ": *F* = {}, *ζ* = {}",
            or_zero(force, panel.force),
            or_zero(length, panel.indentation)
        ));
    items.push(Item::Label(Label::new(
        name,
        [bounds.left, y],
        NOTE_SIZE,
        Anchor::Start,
    )));
    let note = match floor_note(panel) {
        Some(floor) => format!(
            "{floor}heights exaggerated × {}",
            significant(page.exaggeration(), 2)
        ),
        None => format!(
            "heights exaggerated × {}",
            significant(page.exaggeration(), 2)
        ),
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

/// Position of the first floor contact, if it is outside the section.
fn floor_note(panel: &Panel) -> Option<String> {
    if !panel.section.floor_patches.is_empty() {
        return Some("red: floor in contact; ".to_owned());
    }
    let [x, y] = panel.floor_contact?;
    if !panel.section.floor_contacts.is_empty() {
        return Some("arrows: first floor contact; ".to_owned());
    }
    let unit = Unit::of_length(x.hypot(y));
    Some(format!(
        "floor contact outside the section, at ({}, {}) {}; ",
        significant(unit.of(x), 3),
        significant(unit.of(y), 3),
        unit.name
    ))
}
