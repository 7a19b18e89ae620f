//! Data arrays of VTK's XML files: as text, in base64 or appended; of any number type, byte order and header; zlib or no compression.

use std::io::Read;
use std::path::Path;

use flate2::bufread::ZlibDecoder;

use crate::lines::syntax;
use crate::{MeshIoError, base64, xml};

/// More values than this in one array are a mistake in a length.
const VALUES: usize = 1 << 31;

/// The text of a file and what its first tag says about arrays.
pub(super) struct Arrays<'a> {
    pub path: &'a Path,
    pub bytes: &'a [u8],
    /// The XML, up to appended data.
    pub text: &'a str,
    pub big_endian: bool,
    /// Bytes of a length: 4 or 8.
    pub header: usize,
    pub compressed: bool,
    /// Where appended data begin, and whether they are base64.
    pub appended: Option<(usize, bool)>,
}

impl Arrays<'_> {
    /// The line of a byte of the text.
    pub fn line(&self, position: usize) -> usize {
        self.text.as_bytes()[..position.min(self.text.len())].iter().filter(|&&b| b == b'\n').count() + 1
    }

    pub fn error(&self, position: usize, value: impl ToString, remedy: impl ToString) -> MeshIoError {
        syntax(self.path, self.line(position), value.to_string(), remedy.to_string())
    }

    /// The values of the array whose tag this is. Whole numbers are exact up to 2^53.
    pub fn values(&self, tag: &xml::Tag) -> Result<Vec<f64>, MeshIoError> {
        let bad = |remedy: &str| self.error(tag.end, tag.text, remedy);
        let rest = &self.text[tag.end..];
        let content = &rest[..rest.find('<').unwrap_or(rest.len())];
        let blob = match tag.attribute("format") {
            Some("ascii") => {
                let parsed: Option<Vec<f64>> = content.split_whitespace().map(|token| token.parse().ok()).collect();
                return parsed.ok_or_else(|| bad("the array has something that is no number"));
            }
            Some("binary") => self.blob(content.trim().as_bytes(), true),
            Some("appended") => {
                let offset = tag.attribute("offset").and_then(|o| o.parse::<usize>().ok());
                let (Some((start, base64)), Some(offset)) = (self.appended, offset) else {
                    return Err(bad("an appended array needs an offset and the file appended data"));
                };
                let data = start.checked_add(offset).and_then(|begin| self.bytes.get(begin..));
                data.and_then(|data| self.blob(data, base64))
            }
            _ => return Err(bad("the format of an array is ascii, binary or appended")),
        };
        let blob =
            blob.ok_or_else(|| bad("the data are cut off or damaged: their length or their encoding is wrong"))?;
        let kind = tag.attribute("type").unwrap_or_default();
        let values = match kind {
            "Int8" => self.numbers(&blob, |[b]: [u8; 1]| f64::from(b as i8)),
            "UInt8" => self.numbers(&blob, |[b]: [u8; 1]| f64::from(b)),
            "Int16" => self.numbers(&blob, |b| f64::from(i16::from_le_bytes(b))),
            "UInt16" => self.numbers(&blob, |b| f64::from(u16::from_le_bytes(b))),
            "Int32" => self.numbers(&blob, |b| f64::from(i32::from_le_bytes(b))),
            "UInt32" => self.numbers(&blob, |b| f64::from(u32::from_le_bytes(b))),
            "Int64" => self.numbers(&blob, |b| i64::from_le_bytes(b) as f64),
            "UInt64" => self.numbers(&blob, |b| u64::from_le_bytes(b) as f64),
            "Float32" => self.numbers(&blob, |b| f64::from(f32::from_le_bytes(b))),
            "Float64" => self.numbers(&blob, f64::from_le_bytes),
            _ => return Err(bad("the type of an array is Int8 to UInt64, Float32 or Float64")),
        };
        values.ok_or_else(|| bad("the length of the data does not fit their type"))
    }

    fn numbers<const N: usize>(&self, blob: &[u8], value: impl Fn([u8; N]) -> f64) -> Option<Vec<f64>> {
        let (chunks, rest) = blob.as_chunks::<N>();
        let ordered = |mut chunk: [u8; N]| {
            if self.big_endian {
                chunk.reverse();
            }
            chunk
        };
        rest.is_empty().then(|| chunks.iter().map(|&chunk| value(ordered(chunk))).collect())
    }

    /// The content of an array that begins here: a length and bytes, or a table of blocks and the compressed blocks.
    fn blob(&self, data: &[u8], base64: bool) -> Option<Vec<u8>> {
        // Lengths and content are one piece of base64, or two if the content is compressed.
        let take = |from: usize, count: usize| -> Option<Vec<u8>> {
            if !base64 {
                return data.get(from..from.checked_add(count)?).map(<[u8]>::to_vec);
            }
            let text = data.get(from..from.checked_add(count.div_ceil(3).checked_mul(4)?)?)?;
            let mut bytes = base64::decode(std::str::from_utf8(text).ok()?)?;
            (bytes.len() >= count).then(|| {
                bytes.truncate(count);
                bytes
            })
        };
        let length = |bytes: &[u8], i: usize| -> Option<usize> {
            let mut number = [0; 8];
            let chunk = bytes.get(i * self.header..(i + 1) * self.header)?;
            number[..self.header].copy_from_slice(chunk);
            if self.big_endian {
                number[..self.header].reverse();
            }
            usize::try_from(u64::from_le_bytes(number)).ok().filter(|&n| n < VALUES)
        };
        if !self.compressed {
            let count = length(&take(0, self.header)?, 0)?;
            if let Some(mut bytes) = take(0, self.header + count) {
                return Some(bytes.split_off(self.header));
            }
            // Some programs encode the length by itself.
            return take(self.header.div_ceil(3) * 4, count).filter(|_| base64);
        }
        let blocks = length(&take(0, self.header)?, 0)?;
        let table_length = blocks.checked_add(3)?.checked_mul(self.header)?;
        let table = take(0, table_length)?;
        let (block, last) = (length(&table, 1)?, length(&table, 2)?);
        let sizes: Vec<usize> = (0..blocks).map(|b| length(&table, 3 + b)).collect::<Option<_>>()?;
        let start = if base64 { table_length.div_ceil(3) * 4 } else { table_length };
        let all = take(start, sizes.iter().try_fold(0_usize, |sum, &s| sum.checked_add(s))?)?;
        let (mut out, mut from) = (Vec::new(), 0);
        for (b, size) in sizes.into_iter().enumerate() {
            let expected = if b + 1 == blocks && last > 0 { last } else { block };
            out.extend(zlib(all.get(from..from + size)?, expected)?);
            from += size;
        }
        Some(out)
    }
}

/// The content of a zlib stream of `expected` bytes; `None` if it is no such stream, or has another length or check sum.
fn zlib(bytes: &[u8], expected: usize) -> Option<Vec<u8>> {
    let mut out = Vec::new();
    ZlibDecoder::new(bytes).take(expected as u64 + 1).read_to_end(&mut out).ok()?;
    (out.len() == expected).then_some(out)
}
