//! Writes figures as SVG 1.1.

use crate::figure::{Figure, POINTS_PER_INCH};
use crate::font::{Bounds, FAMILY, Face};
use crate::png;
use crate::scene::{Anchor, Colour, Fill, Item, Label, Path, Stroke};
use base64::Engine;
use base64::engine::general_purpose::STANDARD as BASE64;
use std::fmt::Write;

const MILLIMETRES_PER_INCH: f64 = 25.4;

/// Whether the font is embedded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Font {
    Embedded,
    OfThePage,
}

impl Figure {
    /// The figure as SVG with the embedded font.
    #[must_use]
    pub fn svg(&self) -> String {
        write(self, Font::Embedded)
    }

    /// The figure as SVG without the font, for a page that includes [`font_css`](crate::font_css).
    #[must_use]
    pub fn svg_for_page(&self) -> String {
        write(self, Font::OfThePage)
    }
}

/// CSS rules (`@font-face`) that define the font of all figures for a page.
///
/// A page with several figures includes them once and uses [`Figure::svg_for_page`], which leaves
/// the font out.
#[must_use]
pub fn font_css() -> String {
    rules([Face::Upright, Face::Italic])
}

fn rules(faces: impl IntoIterator<Item = Face>) -> String {
    faces.into_iter().fold(String::new(), |mut css, face| {
        put(
            &mut css,
            format_args!(
                "@font-face{{font-family:{FAMILY};font-style:{};font-weight:400;\
                 src:url(data:font/ttf;base64,{}) format(\"truetype\")}}\n",
                face.style(),
                BASE64.encode(face.data())
            ),
        );
        css
    })
}

fn write(figure: &Figure, font: Font) -> String {
    let mut writer = Writer {
        out: String::new(),
        name: figure.name(),
        definitions: 0,
        class: "",
    };
    writer.head(figure, font);
    figure.items.iter().for_each(|item| writer.item(item));
    writer.out.push_str("</svg>\n");
    writer.out
}

fn put(out: &mut String, arguments: std::fmt::Arguments<'_>) {
    out.write_fmt(arguments).expect("memory takes every byte");
}

/// Formats a coordinate to hundredths of a point, which are 3.5 micrometres on paper.
fn number(value: f64) -> String {
    let rounded = (value * 100.0).round() / 100.0;
    if rounded == 0.0 {
        "0".to_owned()
    } else {
        rounded.to_string()
    }
}

fn colour(Colour([r, g, b]): Colour) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Escapes text for XML; control characters, which XML does not allow, are left out.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\n' | '\t' => out.push(character),
            '\u{fffe}' | '\u{ffff}' => {}
            c if c.is_control() => {}
            c => out.push(c),
        }
    }
    out
}

struct Writer<'a> {
    out: String,
    /// Prefix of all ids, so that ids of different figures on a page differ.
    name: &'a str,
    /// Number of ids used so far.
    definitions: usize,
    /// Attribute of the shapes that are not positioned by data.
    class: &'static str,
}

/// Attribute of shapes that are not positioned by data. All other shapes are in a group with a clip path.
const FIXED: &str = " class=\"fixed\"";

impl Writer<'_> {
    fn head(&mut self, figure: &Figure, font: Font) {
        let [width, height] = figure.size;
        let millimetres = MILLIMETRES_PER_INCH / POINTS_PER_INCH;
        let (name, title) = (self.name, escaped(figure.title()));
        put(
            &mut self.out,
            format_args!(
                "<svg xmlns=\"http://www.w3.org/2000/svg\" \
                 xmlns:xlink=\"http://www.w3.org/1999/xlink\" version=\"1.1\" \
                 width=\"{}mm\" height=\"{}mm\" viewBox=\"0 0 {} {}\" role=\"img\" \
                 aria-labelledby=\"{name}-title {name}-description\" \
                 font-family=\"{FAMILY}, Arial, Helvetica, sans-serif\">\n\
                 <title id=\"{name}-title\">{title}</title>\n\
                 <desc id=\"{name}-description\">{}</desc>\n\
                 <metadata xmlns:dc=\"http://purl.org/dc/elements/1.1/\">\
                 <dc:title>{title}</dc:title>",
                number(width * millimetres),
                number(height * millimetres),
                number(width),
                number(height),
                escaped(figure.description()),
            ),
        );
        if !figure.provenance().is_empty() {
            let source = escaped(figure.provenance());
            put(
                &mut self.out,
                format_args!("<dc:source>{source}</dc:source>"),
            );
        }
        self.out.push_str("</metadata>\n");
        if font == Font::Embedded {
            let rules = rules(figure.faces());
            put(
                &mut self.out,
                format_args!("<defs><style>\n{rules}</style></defs>\n"),
            );
        }
        put(
            &mut self.out,
            format_args!(
                "<rect width=\"{}\" height=\"{}\" fill=\"#ffffff\"/>\n",
                number(width),
                number(height)
            ),
        );
    }

    fn new_id(&mut self) -> String {
        self.definitions += 1;
        format!("{}-{}", self.name, self.definitions)
    }

    fn item(&mut self, item: &Item) {
        match item {
            Item::Path { path, fill, stroke } => {
                let fill = self.fill(fill.as_ref());
                let (data, stroke) = (path_data(path), strokes(stroke.as_ref()));
                put(
                    &mut self.out,
                    format_args!("<path{} d=\"{data}\"{fill}{stroke}/>\n", self.class),
                );
            }
            Item::Disc {
                centre,
                radius,
                fill,
                stroke,
            } => {
                let fill = self.fill(fill.map(Fill::Colour).as_ref());
                put(
                    &mut self.out,
                    format_args!(
                        "<circle{} cx=\"{}\" cy=\"{}\" r=\"{}\"{fill}{}/>\n",
                        self.class,
                        number(centre[0]),
                        number(centre[1]),
                        number(*radius),
                        strokes(stroke.as_ref())
                    ),
                );
            }
            Item::Label(label) => self.label(label),
            Item::Image { bounds, pixels } => put(
                &mut self.out,
                format_args!(
                    "<image{} preserveAspectRatio=\"none\" \
                     xlink:href=\"data:image/png;base64,{}\"/>\n",
                    rectangle(bounds),
                    BASE64.encode(png::pixels(pixels))
                ),
            ),
            Item::Clipped { bounds, items } => {
                let id = self.new_id();
                put(
                    &mut self.out,
                    format_args!(
                        "<clipPath id=\"{id}\"><rect{}/></clipPath>\n\
                         <g clip-path=\"url(#{id})\">\n",
                        rectangle(bounds)
                    ),
                );
                items.iter().for_each(|item| self.item(item));
                self.out.push_str("</g>\n");
            }
            Item::Fixed(item) => {
                self.class = FIXED;
                self.item(item);
                self.class = "";
            }
        }
    }

    fn fill(&mut self, fill: Option<&Fill>) -> String {
        match fill {
            None => " fill=\"none\"".to_owned(),
            Some(Fill::Colour(plain)) => format!(" fill=\"{}\"", colour(*plain)),
            Some(Fill::Gradient(steps)) => {
                let id = self.new_id();
                put(
                    &mut self.out,
                    format_args!(
                        "<linearGradient id=\"{id}\" x1=\"0\" y1=\"1\" x2=\"0\" y2=\"0\">"
                    ),
                );
                let last = steps.len().saturating_sub(1).max(1) as f64;
                for (k, step) in steps.iter().enumerate() {
                    put(
                        &mut self.out,
                        format_args!(
                            "<stop offset=\"{:.4}\" stop-color=\"{}\"/>",
                            k as f64 / last,
                            colour(*step)
                        ),
                    );
                }
                self.out.push_str("</linearGradient>\n");
                format!(" fill=\"url(#{id})\"")
            }
        }
    }

    fn label(&mut self, label: &Label) {
        let [x, y] = label.at.map(number);
        let anchor = match label.anchor {
            Anchor::Start => "",
            Anchor::Middle => " text-anchor=\"middle\"",
            Anchor::End => " text-anchor=\"end\"",
        };
        let place = if label.upwards {
            format!(" transform=\"translate({x} {y}) rotate(-90)\"")
        } else {
            format!(" x=\"{x}\" y=\"{y}\"")
        };
        let rim = if label.rim {
            format!(
                " stroke=\"#ffffff\" stroke-width=\"{}\" stroke-linejoin=\"round\" \
                 paint-order=\"stroke\"",
                number(label.rim_width())
            )
        } else {
            String::new()
        };
        put(
            &mut self.out,
            format_args!(
                "<text{place} font-size=\"{}\"{anchor} fill=\"{}\"{rim} xml:space=\"preserve\">",
                number(label.size),
                colour(label.colour)
            ),
        );
        let mut level = 0.0;
        for run in label.text.runs() {
            let text = escaped(&run.text);
            let step = run.drop() - level;
            level = run.drop();
            let mut style = String::new();
            if step != 0.0 {
                put(
                    &mut style,
                    format_args!(" dy=\"{}\"", number(step * label.size)),
                );
            }
            if run.size() < 1.0 {
                let size = number(run.size() * label.size);
                put(&mut style, format_args!(" font-size=\"{size}\""));
            }
            if run.face == Face::Italic {
                style.push_str(" font-style=\"italic\"");
            }
            if style.is_empty() {
                self.out.push_str(&text);
            } else {
                put(&mut self.out, format_args!("<tspan{style}>{text}</tspan>"));
            }
        }
        self.out.push_str("</text>\n");
    }
}

fn rectangle(bounds: &Bounds) -> String {
    format!(
        " x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"",
        number(bounds.left),
        number(bounds.top),
        number(bounds.width()),
        number(bounds.height())
    )
}

fn strokes(stroke: Option<&Stroke>) -> String {
    let Some(stroke) = stroke else {
        return String::new();
    };
    let mut text = format!(
        " stroke=\"{}\" stroke-width=\"{}\" stroke-linejoin=\"round\"",
        colour(stroke.colour),
        number(stroke.width)
    );
    if !stroke.dashes.is_empty() {
        let dashes: Vec<String> = stroke.dashes.iter().map(|d| number(*d)).collect();
        put(
            &mut text,
            format_args!(" stroke-dasharray=\"{}\"", dashes.join(" ")),
        );
    }
    text
}

/// Writes an absolute first position, then relative steps, which are shorter. Steps are between
/// rounded positions, so that rounding errors do not accumulate.
fn path_data(path: &Path) -> String {
    let mut data = String::new();
    for piece in &path.pieces {
        let hundredths = |place: [f64; 2]| place.map(|v| (v * 100.0).round() as i64);
        let mut places = piece.places.iter().map(|place| hundredths(*place));
        let Some(mut last) = places.next() else {
            continue;
        };
        put(
            &mut data,
            format_args!(
                "M{} {}l",
                number(last[0] as f64 / 100.0),
                number(last[1] as f64 / 100.0)
            ),
        );
        let mut steps = 0;
        for place in places {
            let step = [place[0] - last[0], place[1] - last[1]];
            if step != [0, 0] {
                let separator = if steps > 0 { " " } else { "" };
                put(
                    &mut data,
                    format_args!(
                        "{separator}{} {}",
                        number(step[0] as f64 / 100.0),
                        number(step[1] as f64 / 100.0)
                    ),
                );
                steps += 1;
                last = place;
            }
        }
        if steps == 0 {
            data.push_str("0 0");
        }
        if piece.closed {
            data.push('z');
        }
    }
    data
}
