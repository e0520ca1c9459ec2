//! Compression of TIFF images (TIFF 6.0, Adobe, 1992): LZW, `PackBits` and deflate, and the differences of neighbouring pixels that make
//! images easier to compress.

use flate2::read::ZlibDecoder;
use std::io::Read;

/// How the pixels of an image are packed, by the numbers of the tag `Compression`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Packing {
    None,
    Lzw,
    Deflate,
    PackBits,
}

impl Packing {
    /// The packing of a number, if it is read.
    pub(crate) fn of(number: u64) -> Option<Self> {
        match number {
            1 => Some(Self::None),
            5 => Some(Self::Lzw),
            8 | 32_946 => Some(Self::Deflate),
            32_773 => Some(Self::PackBits),
            _ => None,
        }
    }

    /// The first `length` bytes of a packed block; `None` if it is damaged or has fewer.
    pub(crate) fn unpack(self, packed: &[u8], length: usize) -> Option<Vec<u8>> {
        let mut bytes = match self {
            Self::None => packed.get(..length)?.to_vec(),
            Self::Lzw => lzw(packed, length)?,
            Self::PackBits => pack_bits(packed, length)?,
            Self::Deflate => {
                let mut bytes = Vec::new();
                let mut unpacker = ZlibDecoder::new(packed).take(length as u64);
                unpacker.read_to_end(&mut bytes).ok()?;
                bytes
            }
        };
        bytes.truncate(length);
        (bytes.len() == length).then_some(bytes)
    }
}

/// Unpacks runs and literal bytes (TIFF 6.0, section 9).
fn pack_bits(packed: &[u8], length: usize) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut rest = packed;
    while bytes.len() < length {
        let (count, after) = rest.split_first()?;
        rest = match i8::from_le_bytes([*count]) {
            i8::MIN => after,
            count if count < 0 => {
                let (byte, after) = after.split_first()?;
                let run = usize::from(count.unsigned_abs()) + 1;
                bytes.extend(std::iter::repeat_n(*byte, run));
                after
            }
            count => {
                let (literal, after) =
                    after.split_at_checked(usize::from(count.unsigned_abs()) + 1)?;
                bytes.extend_from_slice(literal);
                after
            }
        };
    }
    Some(bytes)
}

/// Unpacks LZW (TIFF 6.0, section 13): codes of 9 to 12 bits, the most significant bit first.
fn lzw(packed: &[u8], length: usize) -> Option<Vec<u8>> {
    const CLEAR: usize = 256;
    const END: usize = 257;
    const FIRST: usize = 258;
    const MOST_ENTRIES: usize = 4096 - FIRST;
    const WIDTHS: [u32; 2] = [9, 12];
    let mut bytes: Vec<u8> = Vec::new();
    // Every string of the table occurs in the unpacked bytes: its start and its length.
    let mut table: Vec<(usize, usize)> = Vec::new();
    let mut last: Option<(usize, usize)> = None;
    let (mut width, mut bits, mut count) = (WIDTHS[0], 0_u32, 0_u32);
    let mut packed = packed.iter();
    while bytes.len() < length {
        while count < width {
            bits = bits << 8 | u32::from(*packed.next()?);
            count += 8;
        }
        count -= width;
        let code = (bits >> count) as usize;
        bits &= (1 << count) - 1;
        match code {
            CLEAR => {
                table.clear();
                last = None;
                width = WIDTHS[0];
                continue;
            }
            END => break,
            _ => {}
        }
        // The last string and the byte that follows it, which is the first one of this string.
        if let Some((start, length)) = last.filter(|_| table.len() < MOST_ENTRIES) {
            table.push((start, length + 1));
        }
        let start = bytes.len();
        if code < CLEAR {
            bytes.push(code as u8);
        } else {
            let (from, length) = *table.get(code - FIRST)?;
            for place in from..from + length {
                bytes.push(*bytes.get(place)?);
            }
        }
        last = Some((start, bytes.len() - start));
        // Codes become longer one code before the table needs it.
        if FIRST + table.len() >= (1 << width) - 1 && width < WIDTHS[1] {
            width += 1;
        }
    }
    Some(bytes)
}

/// Differences of neighbouring pixels, by the numbers of the tag `Predictor`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Predictor {
    None,
    /// Of integers.
    Horizontal,
    /// Of the bytes of floating-point numbers, the most significant ones of a row first (Adobe Photoshop TIFF Technical Note 3, 2005).
    FloatingPoint,
}

impl Predictor {
    pub(crate) fn of(number: u64) -> Option<Self> {
        match number {
            1 => Some(Self::None),
            2 => Some(Self::Horizontal),
            3 => Some(Self::FloatingPoint),
            _ => None,
        }
    }

    /// The bits of the pixels of a row, each of `size` bytes. `number` returns those of the bytes of one.
    pub(crate) fn row(self, row: &[u8], size: usize, number: impl Fn(&[u8]) -> u64) -> Vec<u64> {
        match self {
            Self::None => row.chunks_exact(size).map(number).collect(),
            Self::Horizontal => {
                let mask = u64::MAX >> (64 - 8 * size);
                let differences = row.chunks_exact(size).map(number);
                let sums = differences.scan(0_u64, |sum, difference| {
                    *sum = sum.wrapping_add(difference) & mask;
                    Some(*sum)
                });
                sums.collect()
            }
            Self::FloatingPoint => {
                let sums = row.iter().scan(0_u8, |sum, difference| {
                    *sum = sum.wrapping_add(*difference);
                    Some(*sum)
                });
                let bytes: Vec<u8> = sums.collect();
                let count = row.len() / size;
                let pixel = |place: usize| {
                    let bytes = (0..size).map(|byte| bytes[byte * count + place]);
                    bytes.fold(0, |bits, byte| bits << 8 | u64::from(byte))
                };
                (0..count).map(pixel).collect()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn examples_of_the_specification() {
        // TIFF 6.0, section 9.
        let packed = [
            0xfe, 0xaa, 0x02, 0x80, 0x00, 0x2a, 0xfd, 0xaa, 0x03, 0x80, 0x00, 0x2a, 0x22, 0xf7,
            0xaa,
        ];
        let mut expected = vec![0xaa, 0xaa, 0xaa, 0x80, 0x00, 0x2a, 0xaa, 0xaa, 0xaa, 0xaa];
        expected.extend([0x80, 0x00, 0x2a, 0x22]);
        expected.extend([0xaa; 10]);
        assert_eq!(Packing::PackBits.unpack(&packed, 24), Some(expected));
        assert_eq!(Packing::PackBits.unpack(&packed, 25), None);
        // TIFF 6.0, section 13: codes 256, 7, 258, 8, 8, 258, 6, 6, 257 of 9 bits.
        let codes = [256_u32, 7, 258, 8, 8, 258, 6, 6, 257];
        let bits = codes
            .iter()
            .flat_map(|code| (0..9).rev().map(move |bit| code >> bit & 1));
        let bits: Vec<u32> = bits.collect();
        let byte =
            |bits: &[u32]| bits.iter().fold(0, |byte, bit| byte << 1 | *bit) << (8 - bits.len());
        let packed: Vec<u8> = bits.chunks(8).map(|bits| byte(bits) as u8).collect();
        let expected = vec![7, 7, 7, 8, 8, 7, 7, 6, 6];
        assert_eq!(Packing::Lzw.unpack(&packed, 9), Some(expected));
        assert_eq!(Packing::Lzw.unpack(&packed, 10), None);
        assert_eq!(Packing::Lzw.unpack(&[0xff; 9], 10), None);
    }

    #[test]
    fn differences_of_pixels() {
        let number = |bytes: &[u8]| u64::from(u16::from_be_bytes([bytes[0], bytes[1]]));
        let row = [0, 5, 0, 1, 0xff, 0xfd];
        assert_eq!(Predictor::None.row(&row, 2, number), [5, 1, 0xfffd]);
        assert_eq!(Predictor::Horizontal.row(&row, 2, number), [5, 6, 3]);
        // 1.5 is 0x3fc0_0000, and -2 is 0xc000_0000: bytes 3f c0 | c0 00 | 00 00 | 00 00, and their differences.
        let row = [0x3f, 0x81, 0x00, 0x40, 0x00, 0x00, 0x00, 0x00];
        let bits = Predictor::FloatingPoint.row(&row, 4, number);
        assert_eq!(
            bits,
            [1.5_f32, -2.0].map(|value| u64::from(value.to_bits()))
        );
    }
}
