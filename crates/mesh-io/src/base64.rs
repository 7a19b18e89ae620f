//! Base64 with line breaks, as VTK's files have it.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

/// The content of a text in base64, in which white space is skipped; `None` if it is none.
pub(crate) fn decode(text: &str) -> Option<Vec<u8>> {
    if !text.contains(|c: char| c.is_ascii_whitespace()) {
        return STANDARD.decode(text).ok();
    }
    let dense: Vec<u8> = text.bytes().filter(|c| !c.is_ascii_whitespace()).collect();
    STANDARD.decode(dense).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_space_is_skipped_and_damage_seen() {
        assert_eq!(decode(" Zm9v\nYmE= ").unwrap(), b"fooba");
        for bad in ["Zg=", "Z===", "Zg==Zg==", "Z*==", "====", "Zm9vY"] {
            assert_eq!(decode(bad), None, "{bad}");
        }
    }
}
