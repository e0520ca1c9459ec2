//! Renders figures as pixels.

use crate::font::Bounds;
use crate::scene::{Colour, Fill, Item, Label, Path, Pixels, Stroke};
use tiny_skia::{
    Color, FillRule, FilterQuality, GradientStop, LinearGradient, Mask, Paint, PathBuilder,
    Pattern, Pixmap, PixmapPaint, Point, Rect, Shader, SpreadMode, StrokeDash, Transform,
};

/// Pixels of a page of the given size in points, with `scale` pixels per point, on white.
pub(crate) fn draw(items: &[Item], [width, height]: [u32; 2], scale: f64) -> Pixels {
    let mut pixmap = Pixmap::new(width.max(1), height.max(1)).expect("pages have a size");
    pixmap.fill(Color::WHITE);
    let mut painter = Painter {
        pixmap: &mut pixmap,
        transform: Transform::from_scale(scale as f32, scale as f32),
        mask: None,
    };
    items.iter().for_each(|item| painter.item(item));
    Pixels {
        width: pixmap.width() as usize,
        height: pixmap.height() as usize,
        colours: pixmap
            .pixels()
            .iter()
            .map(|pixel| Colour([pixel.red(), pixel.green(), pixel.blue()]))
            .collect(),
    }
}

fn solid(Colour([r, g, b]): Colour) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color_rgba8(r, g, b, 255);
    paint.anti_alias = true;
    paint
}

struct Painter<'a> {
    pixmap: &'a mut Pixmap,
    transform: Transform,
    /// Clip mask; `None` for the whole page.
    mask: Option<Mask>,
}

impl Painter<'_> {
    fn item(&mut self, item: &Item) {
        match item {
            Item::Path { path, fill, stroke } => {
                if let Some(outline) = outline(path) {
                    self.shape(&outline, fill.as_ref(), stroke.as_ref());
                }
            }
            Item::Disc {
                centre,
                radius,
                fill,
                stroke,
            } => {
                let [x, y] = centre.map(|v| v as f32);
                let mut builder = PathBuilder::new();
                builder.push_circle(x, y, *radius as f32);
                if let Some(outline) = builder.finish() {
                    self.shape(&outline, fill.map(Fill::Colour).as_ref(), stroke.as_ref());
                }
            }
            Item::Label(label) => self.label(label),
            Item::Image { bounds, pixels } => self.image(bounds, pixels),
            Item::Clipped { bounds, items } => {
                let outside = self.mask.take();
                self.mask = self.mask_of(bounds);
                items.iter().for_each(|item| self.item(item));
                self.mask = outside;
            }
            Item::Fixed(item) => self.item(item),
        }
    }

    fn mask_of(&self, bounds: &Bounds) -> Option<Mask> {
        let mut mask = Mask::new(self.pixmap.width(), self.pixmap.height())?;
        let rectangle = outline(&Path::rectangle(bounds))?;
        mask.fill_path(&rectangle, FillRule::Winding, true, self.transform);
        Some(mask)
    }

    fn shape(&mut self, outline: &tiny_skia::Path, fill: Option<&Fill>, stroke: Option<&Stroke>) {
        let (transform, mask) = (self.transform, self.mask.as_ref());
        if let Some(fill) = fill {
            let paint = match fill {
                Fill::Colour(colour) => solid(*colour),
                Fill::Gradient(steps) => gradient(steps, outline.bounds()),
            };
            self.pixmap
                .fill_path(outline, &paint, FillRule::Winding, transform, mask);
        }
        if let Some(stroke) = stroke {
            let pen = tiny_skia::Stroke {
                width: stroke.width as f32,
                line_join: tiny_skia::LineJoin::Round,
                dash: StrokeDash::new(stroke.dashes.iter().map(|d| *d as f32).collect(), 0.0),
                ..tiny_skia::Stroke::default()
            };
            self.pixmap
                .stroke_path(outline, &solid(stroke.colour), &pen, transform, mask);
        }
    }

    fn label(&mut self, label: &Label) {
        let mut builder = PathBuilder::new();
        for (start, run) in label.text.placed() {
            let x = start * label.size - label.lead();
            let at = [x, run.drop() * label.size];
            run.face
                .outline(&run.text, at, run.size() * label.size, &mut builder);
        }
        let [x, y] = label.at.map(|v| v as f32);
        let place = if label.upwards {
            Transform::from_row(0.0, -1.0, 1.0, 0.0, x, y)
        } else {
            Transform::from_translate(x, y)
        };
        let Some(outline) = builder.finish().and_then(|path| path.transform(place)) else {
            return;
        };
        if label.rim {
            let rim = Stroke::solid(Colour::WHITE, label.rim_width());
            self.shape(&outline, None, Some(&rim));
        }
        let (transform, mask) = (self.transform, self.mask.as_ref());
        self.pixmap.fill_path(
            &outline,
            &solid(label.colour),
            FillRule::Winding,
            transform,
            mask,
        );
    }

    fn image(&mut self, bounds: &Bounds, pixels: &Pixels) {
        let Some(mut image) = Pixmap::new(pixels.width as u32, pixels.height as u32) else {
            return;
        };
        for (to, Colour([r, g, b])) in image.pixels_mut().iter_mut().zip(&pixels.colours) {
            *to = tiny_skia::ColorU8::from_rgba(*r, *g, *b, 255).premultiply();
        }
        let Some(rectangle) = Rect::from_ltrb(
            bounds.left as f32,
            bounds.top as f32,
            bounds.right as f32,
            bounds.bottom as f32,
        ) else {
            return;
        };
        let to_page = Transform::from_row(
            (bounds.width() / pixels.width as f64) as f32,
            0.0,
            0.0,
            (bounds.height() / pixels.height as f64) as f32,
            bounds.left as f32,
            bounds.top as f32,
        );
        let paint = Paint {
            shader: Pattern::new(
                image.as_ref(),
                SpreadMode::Pad,
                FilterQuality::Bilinear,
                PixmapPaint::default().opacity,
                to_page,
            ),
            anti_alias: true,
            ..Paint::default()
        };
        self.pixmap
            .fill_rect(rectangle, &paint, self.transform, self.mask.as_ref());
    }
}

/// Converts a path for `tiny-skia`; `None` if it has no extent.
fn outline(path: &Path) -> Option<tiny_skia::Path> {
    let mut builder = PathBuilder::new();
    for piece in &path.pieces {
        for (k, [x, y]) in piece.places.iter().enumerate() {
            let (x, y) = (*x as f32, *y as f32);
            if k == 0 {
                builder.move_to(x, y);
            } else {
                builder.line_to(x, y);
            }
        }
        if piece.closed {
            builder.close();
        }
    }
    builder.finish()
}

fn gradient(steps: &[Colour], bounds: Rect) -> Paint<'static> {
    let last = steps.len().saturating_sub(1).max(1) as f32;
    let stops = steps
        .iter()
        .enumerate()
        .map(|(k, Colour([r, g, b]))| {
            GradientStop::new(k as f32 / last, Color::from_rgba8(*r, *g, *b, 255))
        })
        .collect();
    let shader = LinearGradient::new(
        Point::from_xy(bounds.left(), bounds.bottom()),
        Point::from_xy(bounds.left(), bounds.top()),
        stops,
        SpreadMode::Pad,
        Transform::identity(),
    );
    Paint {
        shader: shader.unwrap_or(Shader::SolidColor(Color::BLACK)),
        anti_alias: true,
        ..Paint::default()
    }
}
