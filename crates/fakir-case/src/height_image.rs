//! Height maps from grey images of 16 bits: PNG and TIFF. The image is seen with y upwards: its first row has the largest y.

use crate::height_table::{HeightMapError, Source, Stated, Table};
use crate::tiff_packing::{Packing, Predictor};
use std::io::Cursor;

/// Largest grey value of 16 bits.
const WHITE: f64 = 65_535.0;

/// Accepted images.
const REQUIRED_FORMAT: &str =
    "export the heights as a grey image of 16 bits, or as a TIFF image of floating-point numbers";

fn wrong(source: &Source<'_>, problem: impl Into<String>) -> HeightMapError {
    HeightMapError::Image {
        file: source.file.to_owned(),
        problem: problem.into(),
    }
}

/// A table of grey values, given from the top row downwards.
fn table(columns: usize, rows: usize, from_top: &[f64], white: Option<f64>) -> Table {
    let upwards = from_top.rchunks_exact(columns.max(1));
    Table {
        columns,
        rows,
        values: upwards.flatten().copied().collect(),
        stated: Stated {
            white,
            ..Stated::default()
        },
        first_missing: None,
    }
}

/// Reads a PNG image.
pub(crate) fn png(source: &Source<'_>, bytes: &[u8]) -> Result<Table, HeightMapError> {
    let damaged = |error: png::DecodingError| wrong(source, format!("it is damaged: {error}"));
    let mut reader = png::Decoder::new(Cursor::new(bytes))
        .read_info()
        .map_err(damaged)?;
    let info = reader.info();
    let (columns, rows) = (info.width as usize, info.height as usize);
    if info.color_type != png::ColorType::Grayscale || info.bit_depth != png::BitDepth::Sixteen {
        let problem = format!(
            "it has {:?} pixels of {} bits: {REQUIRED_FORMAT}",
            info.color_type, info.bit_depth as u8
        );
        return Err(wrong(source, problem));
    }
    let count = (columns * rows) as u64;
    source.check_memory(count, || format!("{columns} by {rows} points"))?;
    let mut pixels = vec![0; 2 * columns * rows];
    reader.next_frame(&mut pixels).map_err(damaged)?;
    let grey = |pair: &[u8]| f64::from(u16::from_be_bytes([pair[0], pair[1]]));
    let values: Vec<f64> = pixels.chunks_exact(2).map(grey).collect();
    Ok(table(columns, rows, &values, Some(WHITE)))
}

/// Byte order of a TIFF image.
#[derive(Clone, Copy, PartialEq)]
enum Order {
    Little,
    Big,
}

impl Order {
    /// The unsigned number of up to eight bytes.
    fn number(self, bytes: &[u8]) -> u64 {
        let add = |number: u64, byte: &u8| (number << 8) | u64::from(*byte);
        match self {
            Self::Little => bytes.iter().rev().fold(0, add),
            Self::Big => bytes.iter().fold(0, add),
        }
    }
}

/// A page of a TIFF image and the fields of its directory.
struct Tiff<'a> {
    bytes: &'a [u8],
    order: Order,
    fields: Vec<(u16, Vec<u64>)>,
}

/// Kinds of fields: bytes of each value.
fn size_of_kind(kind: u16) -> Option<usize> {
    match kind {
        1 => Some(1),
        3 => Some(2),
        4 => Some(4),
        _ => None,
    }
}

impl<'a> Tiff<'a> {
    /// Reads the first page that is neither a mask nor an image of reduced resolution, or the first one, and counts such pages.
    fn read(bytes: &'a [u8]) -> Option<(Self, usize)> {
        /// Pages that are looked through, as a directory may point back to another one.
        const MOST: usize = 1000;
        const REDUCED_OR_MASK: u64 = 0b101;
        let order = if bytes.starts_with(b"II") {
            Order::Little
        } else {
            Order::Big
        };
        let (mut found, mut next) =
            Self::page(bytes, order, order.number(bytes.get(4..8)?) as usize)?;
        let is_full = |page: &Self| page.value(tag::SUBFILE_TYPE, 0) & REDUCED_OR_MASK == 0;
        let mut count = usize::from(is_full(&found));
        for _ in 1..MOST {
            // Pages behind a damaged one are not found.
            let Some((page, after)) = Self::page(bytes, order, next).filter(|_| next != 0) else {
                break;
            };
            if is_full(&page) {
                count += 1;
                if count == 1 {
                    found = page;
                }
            }
            next = after;
        }
        Some((found, count))
    }

    /// Reads a directory, and the place of the next one.
    fn page(bytes: &'a [u8], order: Order, start: usize) -> Option<(Self, usize)> {
        let mut tiff = Self {
            bytes,
            order,
            fields: Vec::new(),
        };
        let count = tiff.number(start, 2)? as usize;
        for entry in 0..count {
            let place = start + 2 + 12 * entry;
            let (tag, kind) = (
                tiff.number(place, 2)? as u16,
                tiff.number(place + 2, 2)? as u16,
            );
            let length = tiff.number(place + 4, 4)? as usize;
            let Some(size) = size_of_kind(kind) else {
                continue;
            };
            let total = size
                .checked_mul(length)
                .filter(|total| *total <= bytes.len())?;
            let data = match total <= 4 {
                true => place + 8,
                false => tiff.number(place + 8, 4)? as usize,
            };
            let values = (0..length).map(|k| tiff.number(data + k * size, size));
            let values = values.collect::<Option<Vec<u64>>>()?;
            tiff.fields.push((tag, values));
        }
        let next = tiff.number(start + 2 + 12 * count, 4).unwrap_or(0);
        Some((tiff, next as usize))
    }

    /// An unsigned number of so many bytes.
    fn number(&self, place: usize, size: usize) -> Option<u64> {
        let bytes = self.bytes.get(place..place.checked_add(size)?)?;
        Some(self.order.number(bytes))
    }

    fn values(&self, tag: u16) -> &[u64] {
        let found = self.fields.iter().find(|(known, _)| *known == tag);
        found.map_or(&[], |(_, values)| values)
    }

    fn value(&self, tag: u16, otherwise: u64) -> u64 {
        self.values(tag).first().copied().unwrap_or(otherwise)
    }
}

/// Tags of TIFF 6.0.
mod tag {
    pub(super) const SUBFILE_TYPE: u16 = 254;
    pub(super) const WIDTH: u16 = 256;
    pub(super) const LENGTH: u16 = 257;
    pub(super) const BITS: u16 = 258;
    pub(super) const COMPRESSION: u16 = 259;
    pub(super) const PHOTOMETRIC: u16 = 262;
    pub(super) const STRIP_OFFSETS: u16 = 273;
    pub(super) const SAMPLES: u16 = 277;
    pub(super) const ROWS_PER_STRIP: u16 = 278;
    pub(super) const STRIP_BYTES: u16 = 279;
    pub(super) const PREDICTOR: u16 = 317;
    pub(super) const TILE_WIDTH: u16 = 322;
    pub(super) const TILE_LENGTH: u16 = 323;
    pub(super) const TILE_OFFSETS: u16 = 324;
    pub(super) const TILE_BYTES: u16 = 325;
    pub(super) const SAMPLE_FORMAT: u16 = 339;
}

/// Strips or tiles of a TIFF image.
struct Blocks<'a> {
    /// Pixels along x and y of all of them, also of tiles at the border of the image.
    size: [usize; 2],
    /// Number of them side by side.
    across: usize,
    offsets: &'a [u64],
    lengths: &'a [u64],
}

impl<'a> Blocks<'a> {
    fn of(tiff: &'a Tiff<'_>, columns: usize, rows: usize) -> Self {
        let tile = [tag::TILE_WIDTH, tag::TILE_LENGTH].map(|tag| tiff.value(tag, 0) as usize);
        if tile.contains(&0) {
            let strip = tiff.value(tag::ROWS_PER_STRIP, u64::MAX);
            return Self {
                size: [columns, strip.min(rows as u64).max(1) as usize],
                across: 1,
                offsets: tiff.values(tag::STRIP_OFFSETS),
                lengths: tiff.values(tag::STRIP_BYTES),
            };
        }
        Self {
            size: tile,
            across: columns.div_ceil(tile[0]),
            offsets: tiff.values(tag::TILE_OFFSETS),
            lengths: tiff.values(tag::TILE_BYTES),
        }
    }
}

/// Reads the image of a TIFF file: grey values of 16 bits, or heights as floating-point numbers of 32 or 64 bits.
pub(crate) fn tiff(source: &Source<'_>, bytes: &[u8]) -> Result<Table, HeightMapError> {
    let damaged = || wrong(source, "it is damaged: save it as TIFF or PNG again");
    let (tiff, pages) = Tiff::read(bytes).ok_or_else(damaged)?;
    if pages > 1 {
        let problem =
            format!("it has {pages} pages: save the page of the heights as an image by itself");
        return Err(wrong(source, problem));
    }
    let columns = tiff.value(tag::WIDTH, 0) as usize;
    let rows = tiff.value(tag::LENGTH, 0) as usize;
    let (bits, samples) = (tiff.value(tag::BITS, 1), tiff.value(tag::SAMPLES, 1));
    let format = tiff.value(tag::SAMPLE_FORMAT, 1);
    if samples != 1 || !matches!((bits, format), (16, 1) | (32 | 64, 3)) {
        let kind = match format {
            1 => "unsigned integers",
            2 => "signed integers",
            3 => "floating-point numbers",
            _ => "values",
        };
        let problem =
            format!("it has {samples} {kind} of {bits} bits for each pixel: {REQUIRED_FORMAT}");
        return Err(wrong(source, problem));
    }
    let packing = tiff.value(tag::COMPRESSION, 1);
    let unknown = |what: &str, number: u64| {
        let problem = format!(
            "its pixels are packed by {what} {number}: save it without compression, or with deflate, LZW or PackBits"
        );
        wrong(source, problem)
    };
    let packing = Packing::of(packing).ok_or_else(|| unknown("method", packing))?;
    let predictor = tiff.value(tag::PREDICTOR, 1);
    let found =
        Predictor::of(predictor).filter(|found| *found != Predictor::FloatingPoint || format == 3);
    let predictor = found.ok_or_else(|| unknown("predictor", predictor))?;
    let count = (columns as u64).saturating_mul(rows as u64);
    source.check_memory(count, || format!("{columns} by {rows} points"))?;
    let blocks = Blocks::of(&tiff, columns, rows);
    let [width, height] = blocks.size;
    let of_block = (width as u64).saturating_mul(height as u64);
    source.check_memory(of_block, || format!("tiles of {width} by {height} points"))?;
    let size = bits as usize / 8;
    let mut values = vec![f64::NAN; columns * rows];
    let is_inverted = tiff.value(tag::PHOTOMETRIC, 1) == 0;
    let value = |number: u64| match bits {
        16 if is_inverted => WHITE - number as f64,
        16 => number as f64,
        32 => f64::from(f32::from_bits(number as u32)),
        _ => f64::from_bits(number),
    };
    let needed = if count == 0 {
        0
    } else {
        blocks.across * rows.div_ceil(height)
    };
    if blocks.offsets.len().min(blocks.lengths.len()) < needed {
        return Err(damaged());
    }
    let places = blocks.offsets.iter().zip(blocks.lengths).take(needed);
    for (block, (offset, length)) in places.enumerate() {
        let left = block % blocks.across * width;
        let top = block / blocks.across * height;
        let (start, length) = (*offset as usize, *length as usize);
        let end = start.checked_add(length).ok_or_else(damaged)?;
        let packed = bytes.get(start..end).ok_or_else(damaged)?;
        // The last strip has only the rows that are left.
        let inside = height.min(rows - top);
        let unpacked = packing.unpack(packed, width * inside * size);
        let unpacked = unpacked.ok_or_else(damaged)?;
        for (row, line) in unpacked.chunks_exact(width * size).enumerate() {
            let numbers = predictor.row(line, size, |bytes| tiff.order.number(bytes));
            let first = (top + row) * columns + left;
            let seen = width.min(columns - left);
            for (value_at, number) in values[first..first + seen].iter_mut().zip(numbers) {
                *value_at = value(number);
            }
        }
    }
    Ok(table(columns, rows, &values, (bits == 16).then_some(WHITE)))
}
