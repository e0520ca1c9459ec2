//! A figure: the drawing with its title, description and provenance.

use crate::font::{Bounds, Face};
use crate::png;
use crate::raster;
use crate::scene::{Item, Label};

/// Lengths on the page are in points of 1/72 inch.
pub(crate) const POINTS_PER_INCH: f64 = 72.0;

/// Resolution of PNG pictures, dots per inch.
pub const RESOLUTION: f64 = 300.0;

/// Width of one column of Phys. Rev. E, 86 mm, in points.
pub(crate) const COLUMN: f64 = 86.0 / 25.4 * POINTS_PER_INCH;

/// Width of a page of Phys. Rev. E, 178 mm, in points.
pub(crate) const PAGE: f64 = 178.0 / 25.4 * POINTS_PER_INCH;

/// A drawing that can be written as SVG or PNG, in the size it has on paper.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    name: String,
    /// Width and height, points.
    pub(crate) size: [f64; 2],
    pub(crate) items: Vec<Item>,
    title: String,
    description: String,
    provenance: String,
}

impl Figure {
    /// `name` is a file name of letters, digits and hyphens, without an extension.
    pub(crate) fn new(name: &str, size: [f64; 2], items: Vec<Item>) -> Self {
        Self {
            name: name.to_owned(),
            size,
            items,
            title: name.replace('-', " "),
            description: String::new(),
            provenance: String::new(),
        }
    }

    /// The same figure with another title and description, for readers who cannot see it or who
    /// have only the file.
    #[must_use]
    pub fn with_description(self, title: &str, description: &str) -> Self {
        Self {
            title: title.to_owned(),
            description: description.to_owned(),
            ..self
        }
    }

    /// The same figure with its provenance: program, version, case, reference.
    #[must_use]
    pub fn with_provenance(self, provenance: &str) -> Self {
        Self {
            provenance: provenance.to_owned(),
            ..self
        }
    }

    /// The same figure under another name. Letters, digits, hyphens and underscores are kept; other
    /// characters are replaced by hyphens.
    #[must_use]
    pub fn named(self, name: &str) -> Self {
        let kept = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
        Self {
            name: name
                .chars()
                .map(|c| if kept(c) { c } else { '-' })
                .collect(),
            ..self
        }
    }

    /// Name, usable as a file name without extension; unique among the figures of a page.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its title.
    #[must_use]
    pub fn title(&self) -> &str {
        &self.title
    }

    /// Description of its content.
    #[must_use]
    pub fn description(&self) -> &str {
        &self.description
    }

    /// Provenance.
    #[must_use]
    pub fn provenance(&self) -> &str {
        &self.provenance
    }

    /// Width and height, m.
    #[must_use]
    pub fn size(&self) -> [f64; 2] {
        self.size.map(|points| points * 0.0254 / POINTS_PER_INCH)
    }

    /// Width and height of the PNG, pixels.
    #[must_use]
    pub fn pixels(&self) -> [u32; 2] {
        self.size
            .map(|points| (points * RESOLUTION / POINTS_PER_INCH).round() as u32)
    }

    /// The figure as PNG, at 300 dots per inch.
    #[must_use]
    pub fn png(&self) -> Vec<u8> {
        let pixels = raster::draw(&self.items, self.pixels(), RESOLUTION / POINTS_PER_INCH);
        let remarks: Vec<png::Remark<'_>> = [
            ("Title", self.title.as_str()),
            ("Description", self.description.as_str()),
            ("Source", self.provenance.as_str()),
        ]
        .into_iter()
        .filter(|(_, text)| !text.is_empty())
        .collect();
        png::picture(&pixels, RESOLUTION, &remarks)
    }

    /// Font faces used by its text.
    pub(crate) fn faces(&self) -> Vec<Face> {
        let labels = self.labels();
        [Face::Upright, Face::Italic]
            .into_iter()
            .filter(|face| {
                let mut runs = labels.iter().flat_map(|label| label.text.runs());
                runs.any(|run| run.face == *face)
            })
            .collect()
    }

    fn labels(&self) -> Vec<&Label> {
        let mut labels = Vec::new();
        collect_labels(&self.items, &mut labels);
        labels
    }

    /// Checks the layout and returns the faults found: text that is off the page, overlaps other text or data, is too small, has
    /// characters missing from the font, or a unit such as `um` that is printed as `µm`; shapes positioned by data that are not
    /// clipped; and axes that leave the page. The list is empty if there is none.
    #[must_use]
    pub fn faults(&self) -> Vec<String> {
        let page = Bounds::new(0.0, 0.0, self.size[0], self.size[1]);
        let inked: Vec<(&Label, Bounds)> = self
            .labels()
            .into_iter()
            .filter_map(|label| Some((label, label.ink()?)))
            .collect();
        let mut faults = Vec::new();
        for item in &self.items {
            match item {
                Item::Path { .. } => faults.push("a line or an area is not clipped".to_owned()),
                Item::Disc { .. } => faults.push("a disc is not clipped".to_owned()),
                Item::Image { .. } => faults.push("a map is not clipped".to_owned()),
                Item::Fixed(item) => {
                    if let Some(place) = item.place_outside(&page) {
                        faults.push(format!("a line leaves the page: {place:?}"));
                    }
                }
                Item::Label(_) | Item::Clipped { .. } => {}
            }
        }
        for (k, (label, ink)) in inked.iter().enumerate() {
            if !page.holds(ink) {
                faults.push(format!("\"{}\" leaves the page: {ink:?}", label.text));
            }
            if label.size < SMALLEST_TEXT {
                faults.push(format!(
                    "\"{}\" is too small: {} pt",
                    label.text, label.size
                ));
            }
            let words = label.text.to_string();
            if let Some(unit) = words
                .split([' ', '(', ')', '/', ','])
                .find(|word| ["um", "uN", "uJ", "um2", "uPa"].contains(word))
            {
                faults.push(format!("\"{words}\": the unit {unit} is printed with a µ"));
            }
            for run in label.text.runs() {
                if let Some(missing) = run.text.chars().find(|c| !run.face.has(*c)) {
                    faults.push(format!("\"{}\": the font has no {missing}", label.text));
                }
            }
            let drawn = self
                .items
                .iter()
                .filter(|item| !matches!(item, Item::Label(_)));
            if drawn.into_iter().any(|item| item.comes_into(ink)) {
                faults.push(format!("\"{}\" is crossed by what is drawn", label.text));
            }
            for (other, other_ink) in &inked[k + 1..] {
                if ink.overlaps(other_ink) {
                    faults.push(format!("\"{}\" is over \"{}\"", other.text, label.text));
                }
            }
        }
        faults
    }
}

/// Smallest text, points; subscripts may be smaller.
const SMALLEST_TEXT: f64 = 6.0;

fn collect_labels<'a>(items: &'a [Item], labels: &mut Vec<&'a Label>) {
    for item in items {
        match item {
            Item::Label(label) => labels.push(label),
            Item::Clipped { items, .. } => collect_labels(items, labels),
            Item::Fixed(item) => collect_labels(std::slice::from_ref(item), labels),
            Item::Path { .. } | Item::Disc { .. } | Item::Image { .. } => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Anchor, Colour, Path, Stroke};

    #[test]
    fn every_fault_is_found() {
        let label = |x, size| Item::Label(Label::new("text", [x, 30.0], size, Anchor::Start));
        let of_data = |y| {
            Item::stroked(
                Path::line([[0.0, y], [100.0, y]]),
                Stroke::solid(Colour::BLACK, 1.0),
            )
        };
        let line = |y| Item::fixed(of_data(y));
        let unit = Label::new("6 um", [10.0, 30.0], 8.0, Anchor::Start);
        let disc = Item::Disc {
            centre: [50.0, 25.0],
            radius: 2.0,
            fill: Some(Colour::BLACK),
            stroke: None,
        };
        let clipped = |items| Item::clipped(Bounds::new(0.0, 0.0, 100.0, 50.0), items);
        let faults = |items: Vec<Item>| Figure::new("test", [100.0, 50.0], items).faults();
        assert!(faults(vec![label(10.0, 8.0), label(50.0, 8.0), line(40.0)]).is_empty());
        assert!(faults(vec![clipped(vec![of_data(400.0), disc.clone()])]).is_empty());
        for (items, fault) in [
            (vec![label(90.0, 8.0)], "leaves the page"),
            (vec![label(10.0, 5.0)], "is too small"),
            (vec![label(10.0, 8.0), label(18.0, 8.0)], "is over"),
            (vec![line(28.0), label(10.0, 8.0)], "is crossed"),
            (vec![line(51.0)], "a line leaves the page"),
            (vec![of_data(40.0)], "not clipped"),
            (vec![disc], "not clipped"),
            (vec![Item::Label(unit)], "printed with a µ"),
        ] {
            let found = faults(items);
            assert!(found.len() == 1 && found[0].contains(fault), "{found:?}");
        }
    }
}
