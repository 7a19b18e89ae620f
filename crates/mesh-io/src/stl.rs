//! Surfaces from STL files, text and binary.
//!
//! A text file has any number of blocks
//!
//! ```text
//! solid NAME
//!   facet normal NX NY NZ
//!     outer loop
//!       vertex X Y Z        (three times)
//!     endloop
//!   endfacet
//! endsolid NAME
//! ```
//!
//! with keywords in any case, one a line. A binary file is little-endian: a header of 80 bytes without meaning, the
//! number of facets (`u32`), and 50 bytes a facet: normal and three vertices (twelve `f32`) and two bytes without
//! meaning.
//!
//! The two are distinguished by the length, which the number of facets of a binary file fixes; a binary header may begin
//! with `solid`.
//!
//! Normals are not used: the order of the vertices says where outside is. A file has no units either; the caller may
//! scale the nodes.

use std::collections::{BTreeMap, HashMap};
use std::path::Path;

use stoss_mesh::SurfaceMesh;

use crate::MeshIoError;
use crate::lines::{Lines, syntax};

/// Bytes before the number of facets, and before the facets.
const COUNT: usize = 80;
const FACETS: usize = 84;
/// Bytes of a facet, and of its normal.
const FACET: usize = 50;
const NORMAL: usize = 12;

/// A surface as read, and how many facets were left out of it.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceFile {
    /// The surface, checked.
    pub surface: SurfaceMesh,
    /// Number of facets without area ([`SurfaceMesh::is_degenerate`]), which were dropped.
    pub dropped: usize,
}

/// Reads the surface of an STL file, text or binary. Vertices with the same coordinates become one node; facets without
/// area are dropped; each `solid NAME` of a text becomes a facet set, and solids of one name one set. The surface is
/// checked ([`SurfaceMesh::check`]), but it need not be closed.
///
/// # Errors
/// [`MeshIoError::Io`], [`MeshIoError::Syntax`] with the line of a text, [`MeshIoError::Binary`] with the place in a
/// binary file, [`MeshIoError::UnknownFormat`], [`MeshIoError::Mesh`] if no facet is left.
pub fn read_surface(path: impl AsRef<Path>) -> Result<SurfaceMesh, MeshIoError> {
    let path = path.as_ref();
    let bytes = std::fs::read(path).map_err(|source| MeshIoError::Io { path: path.to_owned(), source })?;
    read_surface_from_bytes(path, &bytes)
}

/// [`read_surface`] for the content of a file in memory; `path` is used in messages.
///
/// # Errors
/// The errors of [`read_surface`].
pub fn read_surface_from_bytes(path: impl AsRef<Path>, bytes: &[u8]) -> Result<SurfaceMesh, MeshIoError> {
    Ok(read_surface_counted(path, bytes)?.surface)
}

/// [`read_surface_from_bytes`], and how many facets were dropped.
///
/// # Errors
/// The errors of [`read_surface`].
pub fn read_surface_counted(path: impl AsRef<Path>, bytes: &[u8]) -> Result<SurfaceFile, MeshIoError> {
    let path = path.as_ref();
    let mut surface = if is_binary(bytes) {
        binary(path, bytes)?
    } else if is_text(bytes) {
        // Names of solids may be in any encoding; everything else is ASCII.
        text(path, &String::from_utf8_lossy(bytes))?
    } else if bytes.len() < FACETS {
        return Err(MeshIoError::UnknownFormat {
            path: path.to_owned(),
            known: vec!["STL, text or binary (.stl)".into()],
        });
    } else {
        return Err(wrong_length(path, bytes));
    };
    let dropped = surface.drop_degenerate();
    surface.check().map_err(|source| MeshIoError::Mesh { path: path.to_owned(), source })?;
    Ok(SurfaceFile { surface, dropped })
}

/// Number of facets that a binary file claims.
fn claimed(bytes: &[u8]) -> Option<u32> {
    bytes.get(COUNT..)?.first_chunk().map(|b| u32::from_le_bytes(*b))
}

/// True if the length is the one that the number of facets demands. In a text the four bytes are characters, and the
/// length would be gigabytes.
fn is_binary(bytes: &[u8]) -> bool {
    claimed(bytes).is_some_and(|count| bytes.len() as u64 == FACETS as u64 + u64::from(count) * FACET as u64)
}

/// True if it begins with `solid` and has no zero byte where a binary file of less than 2^24 facets has one.
fn is_text(bytes: &[u8]) -> bool {
    let content = bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(bytes).trim_ascii_start();
    let word = content.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    word && !bytes[..bytes.len().min(FACETS)].contains(&0)
}

fn wrong_length(path: &Path, bytes: &[u8]) -> MeshIoError {
    let count = claimed(bytes).unwrap_or(0);
    let value = format!("{count} facets");
    let length = FACETS as u64 + u64::from(count) * FACET as u64;
    let remedy = format!(
        "a binary STL file with so many has {length} bytes, and this file {}: it is cut off, or damaged, or no STL \
         file; write it again",
        bytes.len()
    );
    MeshIoError::Binary { path: path.to_owned(), offset: COUNT as u64, value, remedy }
}

/// Nodes by coordinates, triangles of them.
#[derive(Default)]
struct Builder {
    surface: SurfaceMesh,
    numbers: HashMap<[u64; 3], u32>,
}

impl Builder {
    /// The node at a place, or `None` if there are more of them than numbers. The two zeros are one place.
    fn node(&mut self, x: [f64; 3]) -> Option<u32> {
        let x = x.map(|c| c + 0.0);
        let next = u32::try_from(self.surface.nodes.len()).ok()?;
        let node = *self.numbers.entry(x.map(f64::to_bits)).or_insert(next);
        if node == next {
            self.surface.nodes.push(x);
        }
        Some(node)
    }

    fn facet(&mut self, nodes: [u32; 3]) {
        self.surface.facets.push(nodes.into());
    }
}

/// A file whose length fits the number of facets.
fn binary(path: &Path, bytes: &[u8]) -> Result<SurfaceMesh, MeshIoError> {
    let error = |offset: usize, value: String, remedy: &str| MeshIoError::Binary {
        path: path.to_owned(),
        offset: offset as u64,
        value,
        remedy: remedy.to_owned(),
    };
    let mut builder = Builder::default();
    for (f, facet) in bytes[FACETS..].chunks_exact(FACET).enumerate() {
        let mut nodes = [0; 3];
        for (v, vertex) in facet[NORMAL..].chunks_exact(12).enumerate() {
            let offset = FACETS + f * FACET + NORMAL + 12 * v;
            let mut x = [0.0; 3];
            for (c, number) in vertex.as_chunks().0.iter().enumerate() {
                let value = f32::from_le_bytes(*number);
                if !value.is_finite() {
                    return Err(error(
                        offset + 4 * c,
                        value.to_string(),
                        "coordinates must be finite; write the file again",
                    ));
                }
                x[c] = f64::from(value);
            }
            nodes[v] = builder.node(x).ok_or_else(|| {
                error(offset, "too many vertices".into(), "at most 2^32 different ones; use a coarser surface")
            })?;
        }
        builder.facet(nodes);
    }
    Ok(builder.surface)
}

fn text(path: &Path, text: &str) -> Result<SurfaceMesh, MeshIoError> {
    let mut lines = Lines::new(path, text);
    let mut builder = Builder::default();
    let mut sets: BTreeMap<String, Vec<u32>> = BTreeMap::new();
    while let Some(line) = lines.next() {
        let Some(name) = after(line, "solid") else {
            return Err(lines.error(line, "expected \"solid\""));
        };
        let first = builder.surface.facets.len() as u32;
        solid(&mut lines, &mut builder)?;
        let next = builder.surface.facets.len() as u32;
        if !name.is_empty() && first < next {
            sets.entry(name.to_owned()).or_default().extend(first..next);
        }
    }
    builder.surface.facet_sets = sets;
    Ok(builder.surface)
}

/// The facets of a solid up to its end.
fn solid(lines: &mut Lines, builder: &mut Builder) -> Result<(), MeshIoError> {
    loop {
        let line = lines.expect("\"facet\" or \"endsolid\"")?;
        if after(line, "endsolid").is_some() {
            return Ok(());
        }
        if after(line, "facet").is_none() {
            return Err(lines.error(line, "expected \"facet\" or \"endsolid\""));
        }
        words(lines, &["outer", "loop"])?;
        let mut nodes = [0; 3];
        for node in &mut nodes {
            let line = lines.expect("\"vertex\" and three coordinates")?;
            let Some(rest) = after(line, "vertex") else {
                return Err(lines.error(line, "expected \"vertex\": a facet has three of them"));
            };
            let mut numbers = rest.split_whitespace();
            let mut x = [0.0; 3];
            for c in &mut x {
                *c = lines.parse_real(numbers.next(), "a coordinate")?;
            }
            if let Some(more) = numbers.next() {
                return Err(lines.error(more, "expected the end of the line after three coordinates"));
            }
            *node = builder.node(x).ok_or_else(|| {
                syntax(
                    lines.path,
                    lines.number,
                    "too many vertices",
                    "at most 2^32 different ones; use a coarser surface",
                )
            })?;
        }
        words(lines, &["endloop"])?;
        words(lines, &["endfacet"])?;
        builder.facet(nodes);
    }
}

/// The rest of a line that begins with this word, whatever its case.
fn after<'a>(line: &'a str, word: &str) -> Option<&'a str> {
    let (first, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
    first.eq_ignore_ascii_case(word).then(|| rest.trim())
}

/// A line of these words and nothing else.
fn words(lines: &mut Lines, words: &[&str]) -> Result<(), MeshIoError> {
    let what = words.join(" ");
    let line = lines.expect(&format!("\"{what}\""))?;
    let mut found = line.split_whitespace();
    if words.iter().all(|w| found.next().is_some_and(|f| f.eq_ignore_ascii_case(w))) && found.next().is_none() {
        Ok(())
    } else {
        Err(lines.error(line, format!("expected \"{what}\": facets are triangles, with one keyword a line")))
    }
}
