//! Decompression of zlib streams (RFC 1950, RFC 1951), as VTK's compressed arrays need it.

/// Longest code word.
const BITS: usize = 15;
/// Lengths of the code words of the length codes come in this order.
const ORDER: [usize; 19] = [16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15];
/// Smallest length and number of extra bits of the symbols from 257.
const LENGTHS: [(usize, u32); 29] = [
    (3, 0),
    (4, 0),
    (5, 0),
    (6, 0),
    (7, 0),
    (8, 0),
    (9, 0),
    (10, 0),
    (11, 1),
    (13, 1),
    (15, 1),
    (17, 1),
    (19, 2),
    (23, 2),
    (27, 2),
    (31, 2),
    (35, 3),
    (43, 3),
    (51, 3),
    (59, 3),
    (67, 4),
    (83, 4),
    (99, 4),
    (115, 4),
    (131, 5),
    (163, 5),
    (195, 5),
    (227, 5),
    (258, 0),
];

/// Bits from the lowest of each byte on.
struct Bits<'a> {
    bytes: &'a [u8],
    position: usize,
}

impl Bits<'_> {
    fn take(&mut self, count: u32) -> Option<usize> {
        let mut value = 0;
        for i in 0..count {
            let byte = *self.bytes.get(self.position / 8)?;
            value |= usize::from(byte >> (self.position % 8) & 1) << i;
            self.position += 1;
        }
        Some(value)
    }
}

/// A canonical Huffman code: how many words of each length, and the symbols in the order of their words.
struct Code {
    counts: [usize; BITS + 1],
    symbols: Vec<usize>,
}

impl Code {
    fn new(lengths: &[usize]) -> Code {
        let mut counts = [0; BITS + 1];
        lengths.iter().for_each(|&l| counts[l] += 1);
        counts[0] = 0;
        let mut symbols: Vec<usize> = (0..lengths.len()).filter(|&s| lengths[s] > 0).collect();
        symbols.sort_by_key(|&s| (lengths[s], s));
        Code { counts, symbols }
    }

    fn symbol(&self, bits: &mut Bits) -> Option<usize> {
        let (mut word, mut first, mut index) = (0, 0, 0);
        for count in &self.counts[1..] {
            word |= bits.take(1)?;
            if word < first + count {
                return self.symbols.get(index + word - first).copied();
            }
            index += count;
            first = (first + count) << 1;
            word <<= 1;
        }
        None
    }
}

/// The content of a zlib stream of `expected` bytes; `None` if it is no such stream, or has another length or check sum.
pub(crate) fn zlib(bytes: &[u8], expected: usize) -> Option<Vec<u8>> {
    let (&[method, flags], rest) = bytes.split_first_chunk::<2>()?;
    let (data, &sum) = rest.split_last_chunk::<4>()?;
    let is_zlib = method & 15 == 8 && u16::from_be_bytes([method, flags]).is_multiple_of(31) && flags & 32 == 0;
    let out = if is_zlib { inflate(data, expected)? } else { return None };
    (out.len() == expected && adler(&out) == u32::from_be_bytes(sum)).then_some(out)
}

fn adler(bytes: &[u8]) -> u32 {
    let (a, b) = bytes.iter().fold((1, 0), |(a, b), &byte| {
        let a = (a + u32::from(byte)) % 65521;
        (a, (b + a) % 65521)
    });
    b << 16 | a
}

fn inflate(bytes: &[u8], expected: usize) -> Option<Vec<u8>> {
    let mut bits = Bits { bytes, position: 0 };
    let mut out = Vec::new();
    loop {
        let is_last = bits.take(1)? == 1;
        match bits.take(2)? {
            0 => {
                let start = bits.position.div_ceil(8);
                let length = u16::from_le_bytes(bytes.get(start..start + 2)?.try_into().ok()?);
                let inverse = u16::from_le_bytes(bytes.get(start + 2..start + 4)?.try_into().ok()?);
                let end = start + 4 + usize::from(length);
                if length != !inverse || out.len() + usize::from(length) > expected {
                    return None;
                }
                out.extend_from_slice(bytes.get(start + 4..end)?);
                bits.position = 8 * end;
            }
            1 => {
                let length = |s| {
                    if s < 144 {
                        8
                    } else if s < 256 {
                        9
                    } else if s < 280 {
                        7
                    } else {
                        8
                    }
                };
                let lengths: Vec<usize> = (0..288).map(length).collect();
                block(&mut bits, &Code::new(&lengths), &Code::new(&[5; 30]), &mut out, expected)?;
            }
            2 => {
                let (literals, distances) = codes(&mut bits)?;
                block(&mut bits, &literals, &distances, &mut out, expected)?;
            }
            _ => return None,
        }
        if is_last {
            return Some(out);
        }
    }
}

/// The codes that stand at the beginning of a block.
fn codes(bits: &mut Bits) -> Option<(Code, Code)> {
    let (literals, distances, count) = (bits.take(5)? + 257, bits.take(5)? + 1, bits.take(4)? + 4);
    let mut lengths = [0; 19];
    for &place in &ORDER[..count] {
        lengths[place] = bits.take(3)?;
    }
    let code = Code::new(&lengths);
    let mut lengths = Vec::with_capacity(literals + distances);
    while lengths.len() < literals + distances {
        let (value, repeat) = match code.symbol(bits)? {
            16 => (*lengths.last()?, 3 + bits.take(2)?),
            17 => (0, 3 + bits.take(3)?),
            18 => (0, 11 + bits.take(7)?),
            length => (length, 1),
        };
        lengths.extend(std::iter::repeat_n(value, repeat));
    }
    (lengths.len() == literals + distances).then(|| (Code::new(&lengths[..literals]), Code::new(&lengths[literals..])))
}

fn block(bits: &mut Bits, literals: &Code, distances: &Code, out: &mut Vec<u8>, expected: usize) -> Option<()> {
    loop {
        match literals.symbol(bits)? {
            256 => return Some(()),
            literal @ 0..256 => out.push(literal as u8),
            symbol => {
                let (base, extra) = *LENGTHS.get(symbol - 257)?;
                let length = base + bits.take(extra)?;
                let symbol = distances.symbol(bits)?;
                // Distances grow as 1, 2, 3, 4, 5, 7, 9, 13, ...: two symbols for each number of extra bits.
                let (base, extra) = if symbol < 4 {
                    (symbol + 1, 0)
                } else if symbol < 30 {
                    let extra = symbol / 2 - 1;
                    (((2 + symbol % 2) << extra) + 1, extra as u32)
                } else {
                    return None;
                };
                let from = out.len().checked_sub(base + bits.take(extra)?)?;
                for i in from..from + length {
                    out.push(out[i]);
                }
            }
        }
        if out.len() > expected {
            return None;
        }
    }
}
