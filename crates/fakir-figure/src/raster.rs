//! Renders figures as pixels.

use crate::font::Bounds;
use crate::scene::{Colour, Fill, Item, Label, Path, Pixels, Stroke};
use std::collections::HashMap;
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

/// Number of discs of a clipped group from which on they are copied from images of discs.
const MANY: usize = 1000;

/// Number of positions of a disc within a pixel, along each side, that have an image.
const WITHIN_PIXEL: f64 = 8.0;

/// A disc's radius and colours, width and colour of its rim, and position within a pixel: discs with the same have the same image.
type Look = (u64, Option<[u8; 3]>, Option<([u8; 3], u64)>, [u32; 2]);

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
                let is_disc = |item: &&Item| matches!(item, Item::Disc { .. });
                if items.iter().filter(is_disc).count() < MANY {
                    items.iter().for_each(|item| self.item(item));
                } else {
                    let mut images = HashMap::new();
                    for item in items {
                        if !self.copied(item, &mut images) {
                            self.item(item);
                        }
                    }
                }
                self.mask = outside;
            }
            Item::Fixed(item) => self.item(item),
        }
    }

    /// Draws a disc as a copy of an image of it, at one of the [positions within a pixel](WITHIN_PIXEL); returns whether it did.
    fn copied(&mut self, item: &Item, images: &mut HashMap<Look, Pixmap>) -> bool {
        let Item::Disc {
            centre,
            radius,
            fill,
            stroke,
        } = item
        else {
            return false;
        };
        let scale = f64::from(self.transform.sx);
        let places = centre.map(|at| (at * scale * WITHIN_PIXEL).round());
        let rim = stroke.as_ref();
        let is_plain = rim.is_none_or(|rim| rim.dashes.is_empty());
        if !is_plain || !places.iter().all(|place| place.abs() < 1e8) {
            return false;
        }
        let pixels = places.map(|place| (place / WITHIN_PIXEL).floor());
        let within = [0, 1].map(|k| (places[k] - pixels[k] * WITHIN_PIXEL) as u32);
        let look = (
            radius.to_bits(),
            fill.map(|Colour(rgb)| rgb),
            rim.map(|rim| (rim.colour.0, rim.width.to_bits())),
            within,
        );
        let reach = scale * (radius + rim.map_or(0.0, |rim| 0.5 * rim.width));
        let half = reach.ceil() as i32 + 1;
        let image = images.entry(look).or_insert_with(|| {
            let side = 2 * half.unsigned_abs() + 1;
            let mut image = Pixmap::new(side, side).expect("a disc has a size");
            let [x, y] = within.map(|k| f64::from(half) + f64::from(k) / WITHIN_PIXEL);
            let mut painter = Painter {
                pixmap: &mut image,
                transform: Transform::from_scale(scale as f32, scale as f32),
                mask: None,
            };
            painter.item(&Item::Disc {
                centre: [x / scale, y / scale],
                radius: *radius,
                fill: *fill,
                stroke: stroke.clone(),
            });
            image
        });
        let [x, y] = pixels.map(|pixel| pixel as i32 - half);
        let paint = PixmapPaint::default();
        let mask = self.mask.as_ref();
        self.pixmap
            .draw_pixmap(x, y, image.as_ref(), &paint, Transform::identity(), mask);
        true
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Copies of images of discs are the discs, at most a sixteenth of a pixel away.
    #[test]
    fn many_discs_look_like_single_ones() {
        let disc = |k: usize| Item::Disc {
            centre: [5.0 + 0.0373 * k as f64, 20.0 + 8.0 * (0.7 * k as f64).sin()],
            radius: 1.9,
            fill: Some(Colour([30, 90, 160])),
            stroke: Some(Stroke::solid(Colour::WHITE, 0.3)),
        };
        let bounds = Bounds {
            left: 8.0,
            top: 4.0,
            right: 60.0,
            bottom: 36.0,
        };
        let discs: Vec<Item> = (0..MANY + 200).map(disc).collect();
        let few = discs.chunks(MANY / 2);
        let few = few.map(|some| Item::clipped(bounds, some.to_vec()));
        let few: Vec<Item> = few.collect();
        let many = vec![Item::clipped(bounds, discs.clone())];
        let [few, many] = [few, many].map(|items| draw(&items, [140, 80], 2.0));
        let difference = |(a, b): (&Colour, &Colour)| {
            let pairs = a.0.iter().zip(b.0);
            pairs.map(|(a, b)| f64::from(a.abs_diff(b))).sum::<f64>() / 3.0
        };
        let differences: Vec<f64> = few
            .colours
            .iter()
            .zip(&many.colours)
            .map(difference)
            .collect();
        let mean = differences.iter().sum::<f64>() / differences.len() as f64;
        let drawn = few
            .colours
            .iter()
            .filter(|colour| **colour != Colour::WHITE);
        assert!(drawn.count() > 2000);
        // Edges that move by up to a sixteenth of a pixel change by 16 of 255.
        assert!(mean < 4.0, "{mean}");
        assert!(differences.iter().fold(0.0, |a: f64, b| a.max(*b)) < 80.0);
    }
}
