//! Writes pixels as PNG.

use crate::scene::{Colour, Pixels};
use png::{BitDepth, ColorType, Compression, Encoder, PixelDimensions, Unit};

/// A text chunk: keyword and text.
pub(crate) type Remark<'a> = (&'static str, &'a str);

/// Encodes pixels as PNG, without resolution and text chunks.
pub(crate) fn pixels(pixels: &Pixels) -> Vec<u8> {
    encode(pixels, None, &[])
}

/// Encodes an image with a resolution in dots per inch and text chunks: Latin-1 (`tEXt`) if it has
/// all characters, otherwise UTF-8 (`iTXt`).
pub(crate) fn picture(pixels: &Pixels, dots_per_inch: f64, remarks: &[Remark<'_>]) -> Vec<u8> {
    encode(pixels, Some(dots_per_inch), remarks)
}

/// Encodes 16-bit grey pixels, row by row from the top, as PNG. The file contains the pixel size (given in m), rounded to whole pixels per
/// metre.
///
/// # Panics
/// If the number of values differs from the number of pixels.
#[must_use]
pub fn grey_map([columns, rows]: [usize; 2], values: &[u16], pixel: f64) -> Vec<u8> {
    assert_eq!(values.len(), columns * rows, "one value for every pixel");
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, columns as u32, rows as u32);
    encoder.set_color(ColorType::Grayscale);
    encoder.set_depth(BitDepth::Sixteen);
    let per_metre = pixel.recip().round() as u32;
    encoder.set_pixel_dims(Some(PixelDimensions {
        xppu: per_metre,
        yppu: per_metre,
        unit: Unit::Meter,
    }));
    let data: Vec<u8> = values
        .iter()
        .flat_map(|value| value.to_be_bytes())
        .collect();
    let written = encoder.write_header().and_then(|mut writer| {
        writer.write_image_data(&data)?;
        writer.finish()
    });
    written.expect("memory takes every byte, and the number of pixels is right");
    bytes
}

fn encode(pixels: &Pixels, dots_per_inch: Option<f64>, remarks: &[Remark<'_>]) -> Vec<u8> {
    let mut bytes = Vec::new();
    try_encode(&mut bytes, pixels, dots_per_inch, remarks)
        .expect("memory takes every byte, and the number of pixels is right");
    bytes
}

fn try_encode(
    bytes: &mut Vec<u8>,
    pixels: &Pixels,
    dots_per_inch: Option<f64>,
    remarks: &[Remark<'_>],
) -> Result<(), png::EncodingError> {
    let mut encoder = Encoder::new(bytes, pixels.width as u32, pixels.height as u32);
    let grey = pixels
        .colours
        .iter()
        .all(|Colour([r, g, b])| r == g && g == b);
    encoder.set_color(if grey {
        ColorType::Grayscale
    } else {
        ColorType::Rgb
    });
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(Compression::Fast);
    if let Some(dots_per_inch) = dots_per_inch {
        let per_metre = (dots_per_inch / 0.0254).round() as u32;
        encoder.set_pixel_dims(Some(PixelDimensions {
            xppu: per_metre,
            yppu: per_metre,
            unit: Unit::Meter,
        }));
    }
    for (keyword, text) in remarks {
        if text.chars().all(|c| u32::from(c) < 256) {
            encoder.add_text_chunk((*keyword).to_owned(), (*text).to_owned())?;
        } else {
            encoder.add_itxt_chunk((*keyword).to_owned(), (*text).to_owned())?;
        }
    }
    let mut data = Vec::with_capacity(3 * pixels.colours.len());
    for Colour([r, g, b]) in &pixels.colours {
        if grey {
            data.push(*r);
        } else {
            data.extend_from_slice(&[*r, *g, *b]);
        }
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&data)?;
    writer.finish()
}
