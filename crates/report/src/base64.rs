//! Standard base64 with padding (RFC 4648 §4), as VTK writes it.

/// Decodes; blanks and line ends are skipped, several padded blocks may follow each other.
pub fn decode(text: &str) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3);
    let mut quad = [0u8; 4];
    let mut filled = 0;
    let mut padding = 0;
    for (place, byte) in text.bytes().enumerate() {
        let value = match byte {
            b'A'..=b'Z' => byte - b'A',
            b'a'..=b'z' => byte - b'a' + 26,
            b'0'..=b'9' => byte - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            b'=' => {
                padding += 1;
                0
            }
            b' ' | b'\n' | b'\r' | b'\t' => continue,
            _ => return Err(format!("byte {byte:#04x} at {place} is not base64")),
        };
        if byte != b'=' && padding > 0 {
            return Err(format!("padding inside a group at {place}"));
        }
        quad[filled] = value;
        filled += 1;
        if filled == 4 {
            if padding > 2 {
                return Err(format!("too much padding at {place}"));
            }
            let word = quad.iter().fold(0u32, |word, value| word << 6 | u32::from(*value));
            bytes.extend_from_slice(&word.to_be_bytes()[1..4 - padding]);
            (filled, padding) = (0, 0);
        }
    }
    if filled != 0 {
        return Err("base64 ends inside a group".into());
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::decode;

    /// RFC 4648 §10.
    #[test]
    fn test_vectors_of_the_standard() {
        let pairs =
            [("", ""), ("Zg==", "f"), ("Zm8=", "fo"), ("Zm9v", "foo"), ("Zm9vYg==", "foob"), ("Zm9vYmFy", "foobar")];
        for (code, plain) in pairs {
            assert_eq!(decode(code).unwrap(), plain.as_bytes());
        }
        assert_eq!(decode("Zg==\n Zm8=").unwrap(), b"ffo");
        assert_eq!(decode("+/+/").unwrap(), [0xfb, 0xff, 0xbf]);
    }

    #[test]
    fn broken_codes_are_refused() {
        for code in ["Z", "Zg=", "Z===", "Zg=v", "Zm9*"] {
            assert!(decode(code).is_err(), "{code}");
        }
    }
}
