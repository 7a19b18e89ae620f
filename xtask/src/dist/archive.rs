//! A tar archive (POSIX ustar), compressed: files in the order given, owned by nobody in particular, all of one time.

use std::io::Write;

use flate2::{Compression, GzBuilder};

use crate::workspace::Outcome;

const BLOCK: usize = 512;

/// A file to be.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Path below the folder of the archive, with slashes.
    pub path: String,
    content: Vec<u8>,
    mode: u32,
}

impl Entry {
    /// A file that is read.
    pub fn file(path: &str, content: Vec<u8>) -> Self {
        Self { path: path.to_owned(), content, mode: 0o644 }
    }

    /// A file that is run.
    pub fn program(path: &str, content: Vec<u8>) -> Self {
        Self { mode: 0o755, ..Self::file(path, content) }
    }
}

/// The compressed archive, with everything below `folder`; `time` in seconds since 1970.
pub fn tar_gz(folder: &str, entries: &[Entry], time: u64) -> Outcome<Vec<u8>> {
    let mut out = GzBuilder::new().write(Vec::new(), Compression::best());
    for entry in entries {
        let path = format!("{folder}/{}", entry.path);
        out.write_all(&header(&path, entry.content.len(), entry.mode, time)?)?;
        out.write_all(&entry.content)?;
        out.write_all(&[0; BLOCK][..entry.content.len().next_multiple_of(BLOCK) - entry.content.len()])?;
    }
    out.write_all(&[0; 2 * BLOCK])?;
    Ok(out.finish()?)
}

/// The block before a file.
fn header(path: &str, size: usize, mode: u32, time: u64) -> Outcome<[u8; BLOCK]> {
    let (prefix, name) = split(path).ok_or_else(|| format!("{path} is too long a path for a tar archive"))?;
    let mut block = [0; BLOCK];
    let mut put = |at: usize, bytes: &[u8]| block[at..at + bytes.len()].copy_from_slice(bytes);
    put(0, name.as_bytes());
    put(100, format!("{mode:07o}\0").as_bytes());
    put(108, b"0000000\0");
    put(116, b"0000000\0");
    put(124, format!("{size:011o}\0").as_bytes());
    put(136, format!("{time:011o}\0").as_bytes());
    // The sum is taken with blanks in its own place.
    put(148, b"        ");
    put(156, b"0");
    put(257, b"ustar\x0000");
    put(345, prefix.as_bytes());
    let sum: u32 = block.iter().map(|&byte| u32::from(byte)).sum();
    block[148..156].copy_from_slice(format!("{sum:06o}\0 ").as_bytes());
    Ok(block)
}

/// Folder and name such that they have room in a header (155 and 100 bytes); nothing if there is no such place.
fn split(path: &str) -> Option<(&str, &str)> {
    if path.len() <= 100 {
        return Some(("", path));
    }
    let mut places = path.match_indices('/').map(|(at, _)| (&path[..at], &path[at + 1..]));
    places.rfind(|(prefix, name)| prefix.len() <= 155 && name.len() <= 100)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Read;

    fn octal(bytes: &[u8]) -> u64 {
        let text = std::str::from_utf8(bytes).unwrap().trim_matches(['\0', ' ']);
        u64::from_str_radix(text, 8).unwrap()
    }

    fn text(bytes: &[u8]) -> &str {
        std::str::from_utf8(bytes).unwrap().trim_end_matches('\0')
    }

    /// Reads an archive as the standard says, without anything of the writer.
    fn unpack(archive: &[u8]) -> Vec<(String, u64, Vec<u8>)> {
        let mut tar = Vec::new();
        flate2::read::GzDecoder::new(archive).read_to_end(&mut tar).unwrap();
        let (mut at, mut found) = (0, Vec::new());
        while tar[at] != 0 {
            let block = &tar[at..at + 512];
            let sum: u64 = block
                .iter()
                .enumerate()
                .map(|(k, &byte)| if (148..156).contains(&k) { 32 } else { u64::from(byte) })
                .sum();
            assert_eq!(octal(&block[148..156]), sum);
            assert_eq!(&block[257..265], b"ustar\x0000");
            let (size, prefix) = (octal(&block[124..136]) as usize, text(&block[345..500]));
            let name = format!("{prefix}{}{}", if prefix.is_empty() { "" } else { "/" }, text(&block[..100]));
            found.push((name, octal(&block[100..108]), tar[at + 512..at + 512 + size].to_vec()));
            at += 512 + size.div_ceil(512) * 512;
        }
        assert_eq!(tar.len(), at + 1024);
        found
    }

    #[test]
    fn what_is_packed_is_unpacked() {
        let long = format!("{}/{}", "d".repeat(90), "f".repeat(90));
        let entries = [
            Entry::program("stoss", vec![7; 1024]),
            Entry::file("empty", Vec::new()),
            Entry::file(&long, b"content".to_vec()),
        ];
        let archive = tar_gz("a", &entries, 1_700_000_000).unwrap();
        let expected: Vec<_> = [
            ("a/stoss".to_owned(), 0o755, vec![7; 1024]),
            ("a/empty".to_owned(), 0o644, vec![]),
            (format!("a/{long}"), 0o644, b"content".to_vec()),
        ]
        .into();
        assert_eq!(unpack(&archive), expected);
        assert_eq!(archive, tar_gz("a", &entries, 1_700_000_000).unwrap());
    }

    #[test]
    fn paths_without_room_are_refused() {
        assert!(tar_gz("a", &[Entry::file(&"x".repeat(120), Vec::new())], 0).is_err());
    }
}
