//! The little XML that VTK's files need: escaping, and finding elements in files that this crate wrote.

use std::fmt::Write;

/// Text for an attribute value; `None` if XML cannot hold it (control characters).
pub(crate) fn escape(text: &str) -> Option<String> {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            c if (c as u32) < 0x20 || c == '\u{fffe}' || c == '\u{ffff}' => return None,
            // beyond ASCII as a reference, so that no reader has to guess the encoding
            c if !c.is_ascii() => write!(out, "&#{};", c as u32).ok()?,
            c => out.push(c),
        }
    }
    Some(out)
}

/// The inverse of [`escape`].
pub(crate) fn unescape(text: &str) -> Option<String> {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('&') {
        out.push_str(before);
        let (reference, after) = after.split_once(';')?;
        out.push(match reference {
            "amp" => '&',
            "lt" => '<',
            "gt" => '>',
            "quot" => '"',
            "apos" => '\'',
            _ => char::from_u32(reference.strip_prefix('#')?.parse().ok()?)?,
        });
        rest = after;
    }
    out.push_str(rest);
    Some(out)
}

/// A tag: everything between `<` and `>`, and where the text after it begins.
pub(crate) struct Tag<'a> {
    pub text: &'a str,
    pub end: usize,
}

impl<'a> Tag<'a> {
    /// The tag's name; a closing tag's begins with a slash.
    pub fn name(&self) -> &'a str {
        self.text.split(|c: char| c.is_whitespace()).next().unwrap_or_default().trim_end_matches('/')
    }

    /// Value of an attribute, still escaped.
    pub fn attribute(&self, name: &str) -> Option<&'a str> {
        let mut rest = self.text;
        loop {
            let (before, after) = rest.split_once("=\"")?;
            let (value, next) = after.split_once('"')?;
            if before.split_whitespace().next_back() == Some(name) {
                return Some(value);
            }
            rest = next;
        }
    }
}

/// The next tag from a position on. Attribute values hold no `>`: [`escape`] saw to that.
pub(crate) fn next_tag(text: &str, from: usize) -> Option<Tag<'_>> {
    let start = from + text.get(from..)?.find('<')? + 1;
    let end = start + text[start..].find('>')?;
    Some(Tag { text: &text[start..end], end: end + 1 })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]
        #[test]
        fn escaping_is_reversible(text in "[ -~äσ€😀]{0,40}") {
            let escaped = escape(&text).unwrap();
            prop_assert!(escaped.is_ascii() && !escaped.contains(['<', '>', '"']));
            prop_assert_eq!(unescape(&escaped), Some(text.clone()));
            let tag_text = format!("<A b=\"1\" name=\"{escaped}\"/>");
            let tag = next_tag(&tag_text, 0).unwrap();
            prop_assert_eq!(tag.name(), "A");
            prop_assert_eq!(tag.attribute("name"), Some(escaped.as_str()));
            prop_assert_eq!(tag.attribute("ame"), None);
        }
    }

    #[test]
    fn what_is_no_xml() {
        assert_eq!(escape("a\u{1}"), None);
        assert_eq!(unescape("&unknown;"), None);
        assert_eq!(unescape("&#1114112;"), None);
        assert_eq!(unescape("& no end"), None);
        assert!(next_tag("no tag < at all", 0).is_none());
        assert!(next_tag("x", 7).is_none());
    }
}
