//! Base64 (RFC 4648), as VTK's inline binary arrays need it.

use std::io::{self, Write};

const ALPHABET: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/// Encodes what is written to it; [`Encoder::finish`] writes the rest with its padding.
pub(crate) struct Encoder<W: Write> {
    out: W,
    pending: [u8; 3],
    count: usize,
}

impl<W: Write> Encoder<W> {
    pub fn new(out: W) -> Encoder<W> {
        Encoder { out, pending: [0; 3], count: 0 }
    }

    pub fn push(&mut self, bytes: &[u8]) -> io::Result<()> {
        for &byte in bytes {
            self.pending[self.count] = byte;
            self.count += 1;
            if self.count == 3 {
                self.flush_group()?;
            }
        }
        Ok(())
    }

    fn flush_group(&mut self) -> io::Result<()> {
        let [a, b, c] = self.pending.map(u32::from);
        let bits = a << 16 | b << 8 | c;
        let mut group: [u8; 4] = std::array::from_fn(|i| ALPHABET[(bits >> (18 - 6 * i) & 63) as usize]);
        group[self.count + 1..].fill(b'=');
        (self.pending, self.count) = ([0; 3], 0);
        self.out.write_all(&group)
    }

    pub fn finish(mut self) -> io::Result<()> {
        if self.count > 0 { self.flush_group() } else { Ok(()) }
    }
}

/// Decodes; white space is skipped. `None` if the text is not base64.
pub(crate) fn decode(text: &str) -> Option<Vec<u8>> {
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3);
    let (mut bits, mut count, mut padding) = (0u32, 0, 0);
    for c in text.bytes().filter(|c| !c.is_ascii_whitespace()) {
        let value = match c {
            b'A'..=b'Z' => c - b'A',
            b'a'..=b'z' => c - b'a' + 26,
            b'0'..=b'9' => c - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            b'=' => {
                padding += 1;
                0
            }
            _ => return None,
        };
        if padding > 0 && c != b'=' {
            return None;
        }
        bits = bits << 6 | u32::from(value);
        count += 1;
        if count % 4 == 0 {
            bytes.extend_from_slice(&bits.to_be_bytes()[1..]);
            bits = 0;
        }
    }
    if count % 4 != 0 || padding > 2 {
        return None;
    }
    bytes.truncate(bytes.len() - padding);
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn encode(bytes: &[u8]) -> String {
        let mut out = Vec::new();
        let mut encoder = Encoder::new(&mut out);
        encoder.push(bytes).unwrap();
        encoder.finish().unwrap();
        String::from_utf8(out).unwrap()
    }

    /// The test vectors of RFC 4648, section 10.
    #[test]
    fn vectors_of_the_standard() {
        let rows = [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("fooba", "Zm9vYmE="),
            ("foobar", "Zm9vYmFy"),
        ];
        for (plain, coded) in rows {
            assert_eq!(encode(plain.as_bytes()), coded);
            assert_eq!(decode(coded).unwrap(), plain.as_bytes());
        }
        for bad in ["Zg=", "Z===", "Zg==Zg==", "Z*==", "====", "Zm9vY"] {
            assert_eq!(decode(bad), None, "{bad}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]
        #[test]
        fn round_trip(bytes in prop::collection::vec(any::<u8>(), 0..100)) {
            prop_assert_eq!(decode(&encode(&bytes)), Some(bytes));
        }
    }
}
