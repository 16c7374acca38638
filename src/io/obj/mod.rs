//! Wavefront OBJ.
//!
//! Statements are taken apart here, numbers and indices are parsed by `tobj`. On its own `tobj` forgets the
//! order of the vertices, drops unused ones, splits those with several texture coordinates, has no line
//! numbers in its errors and does not know continuation lines. So it is fed one statement at a time
//! ([`StatementFeed`]): only `v` and `f`, reduced to positions, behind a first polygon that names every
//! vertex in order. That polygon fixes the numbering, and the statement fed last is where an error is.
//! What a corner has besides its position is gathered beside it ([`Gathered`]).

mod gathered;
mod statements;
mod write;

pub(super) use write::write;

use super::{
    MeshFile, Place, ReadError,
    builder::MeshBuilder,
    text::{parse_number, quoted},
};
use gathered::Gathered;
use statements::Statements;
use std::{
    fmt::Write as _,
    io::{self, BufRead, Read},
};

/// The longest word that is passed over as a statement we do not know; anything else is damage.
const MAX_KEYWORD_BYTES: usize = 32;

/// Reads an OBJ file. Points, lines, curves and surfaces are ignored.
pub(super) fn read(bytes: &[u8]) -> Result<MeshFile, ReadError> {
    let num_vertices = Statements::new(bytes).filter(|s| s.keyword() == b"v").count();
    if num_vertices >= u32::MAX as usize {
        return Err(ReadError::TooLarge { message: format!("{num_vertices} vertices") });
    }
    let mut feed = StatementFeed::new(bytes, num_vertices);
    // Polygons stay whole: the fan is the builder's.
    let options = tobj::LoadOptions::default();
    let loaded = tobj::load_obj_buf(&mut feed, &options, |_| Err(tobj::LoadError::OpenFileFailed));
    if let Some(error) = feed.error {
        return Err(error);
    }
    let models = match loaded {
        Ok((models, _)) => models,
        Err(tobj::LoadError::FaceVertexOutOfBounds) => return Err(bad_index(bytes, num_vertices)),
        Err(error) => return Err(bad_statement(&feed, &error)),
    };
    let parsed = models.into_iter().next().map(|model| model.mesh).unwrap_or_default();

    feed.gathered.check_references(bytes)?;
    let mut builder = feed.builder;
    builder.positions = parsed.positions.as_chunks::<3>().0.to_vec();
    if let Some(vertex) = builder.positions.iter().position(|p| !p.iter().all(|c| c.is_finite())) {
        return Err(not_finite(bytes, vertex));
    }
    let only_triangles = parsed.face_arities.is_empty();
    let arities = if only_triangles { vec![3; parsed.indices.len() / 3] } else { parsed.face_arities };
    // The first polygon is the numbering.
    let (numbering, faces) = arities.split_at(usize::from(num_vertices > 0).min(arities.len()));
    let num_numbered = numbering.iter().map(|&arity| arity as usize).sum();
    let (_, mut rest) = parsed.indices.split_at(num_numbered);
    for &arity in faces {
        let (corners, after) = rest.split_at(arity as usize);
        rest = after;
        builder.push_polygon(corners);
    }
    builder.attributes = feed.gathered.into_attributes(faces, builder.triangles.len());
    builder.finish()
}

/// The file as `tobj` gets to see it, one statement at a time.
struct StatementFeed<'a> {
    statements: Statements<'a>,
    /// The line that `current` comes from.
    line: usize,
    current: Vec<u8>,
    num_consumed: usize,
    /// Takes notes of what is left out.
    builder: MeshBuilder,
    gathered: Gathered,
    error: Option<ReadError>,
}

impl<'a> StatementFeed<'a> {
    fn new(bytes: &'a [u8], num_vertices: usize) -> Self {
        let mut numbering = String::new();
        if num_vertices > 0 {
            numbering.push('f');
            for index in 1..=num_vertices {
                // Writing to a string cannot fail.
                let _ = write!(numbering, " {index}");
            }
            numbering.push('\n');
        }
        Self {
            statements: Statements::new(bytes),
            line: 0,
            current: numbering.into_bytes(),
            num_consumed: 0,
            builder: MeshBuilder::for_file(bytes.len()),
            gathered: Gathered::default(),
            error: None,
        }
    }

    /// Makes the next vertex or face the current statement; leaves nothing at the end of the file.
    fn advance(&mut self) {
        self.current.clear();
        self.num_consumed = 0;
        for statement in self.statements.by_ref() {
            let mut words = statement.words();
            let keyword = words.next().unwrap_or_default();
            let gathered = match keyword {
                b"" => continue,
                b"v" => {
                    self.current.push(b'v');
                    for coordinate in words.by_ref().take(3) {
                        self.current.push(b' ');
                        self.current.extend_from_slice(coordinate);
                    }
                    self.gathered.vertex(words, &mut self.builder.report)
                }
                b"f" => {
                    self.current.push(b'f');
                    for corner in statement.words().skip(1) {
                        let position = corner.split(|&b| b == b'/').next().unwrap_or_default();
                        self.current.push(b' ');
                        // A corner without position, as `/1`, must not vanish: let it be refused.
                        self.current.extend_from_slice(if position.is_empty() { corner } else { position });
                    }
                    self.gathered.face(words)
                }
                b"vt" | b"vn" | b"usemtl" | b"g" | b"o" | b"s" | b"mtllib" => {
                    match self.gathered.statement(&statement, &mut self.builder.report) {
                        Ok(()) => continue,
                        refused => refused,
                    }
                }
                _ if keyword.len() <= MAX_KEYWORD_BYTES && keyword.iter().all(u8::is_ascii_graphic) => {
                    self.builder.report.ignore(&String::from_utf8_lossy(keyword));
                    continue;
                }
                _ => Err("not an OBJ statement"),
            };
            if let Err(cause) = gathered {
                let message = format!("{cause}: {}", quoted(&statement.text));
                self.error = Some(ReadError::syntax(Place::Line(statement.line), message));
                self.current.clear();
                return;
            }
            self.line = statement.line;
            self.current.push(b'\n');
            return;
        }
    }
}

impl Read for StatementFeed<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let num_read = self.fill_buf()?.read(buffer)?;
        self.consume(num_read);
        Ok(num_read)
    }
}

impl BufRead for StatementFeed<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.num_consumed == self.current.len() && self.error.is_none() {
            self.advance();
        }
        Ok(&self.current[self.num_consumed..])
    }

    fn consume(&mut self, amount: usize) {
        self.num_consumed += amount;
    }
}

/// The error in the statement that `tobj` has just refused.
fn bad_statement(feed: &StatementFeed, error: &tobj::LoadError) -> ReadError {
    let cause = match error {
        tobj::LoadError::PositionParseError => "a vertex needs three numbers",
        tobj::LoadError::FaceParseError => "a corner of a face is not a vertex index",
        tobj::LoadError::ReadError => "text is not UTF-8",
        _ => "not understood",
    };
    ReadError::syntax(Place::Line(feed.line), format!("{cause}: {}", quoted(&feed.current)))
}

/// Finds the first index that no vertex has: 0, too large, or counting back beyond the first.
fn bad_index(bytes: &[u8], num_vertices: usize) -> ReadError {
    let mut num_so_far = 0i128;
    for statement in Statements::new(bytes) {
        match statement.keyword() {
            b"v" => num_so_far += 1,
            b"f" => {
                for corner in statement.words().skip(1) {
                    let index = corner.split(|&b| b == b'/').next().unwrap_or_default();
                    let number = std::str::from_utf8(index).ok().and_then(|index| index.parse::<i128>().ok());
                    let exists =
                        number.is_some_and(|n| n != 0 && n >= -num_so_far && n <= num_vertices as i128);
                    if !exists {
                        let message = format!(
                            "there is no vertex {}: {num_so_far} are defined above, {num_vertices} in the file",
                            quoted(index)
                        );
                        return ReadError::syntax(Place::Line(statement.line), message);
                    }
                }
            }
            _ => {}
        }
    }
    // Cannot happen: the same indices were out of bounds a moment ago.
    ReadError::syntax(Place::Line(1), "an index is out of range")
}

fn not_finite(bytes: &[u8], vertex: usize) -> ReadError {
    let found = Statements::new(bytes).filter(|s| s.keyword() == b"v").nth(vertex);
    let line = found.as_ref().map_or(1, |s| s.line);
    let is_bad = |word: &&[u8]| parse_number(word).is_some_and(|c| !c.is_finite());
    let word = found.as_ref().and_then(|s| s.words().find(is_bad)).unwrap_or_default();
    let message = format!("vertex {} has a coordinate that is not finite: {}", vertex + 1, quoted(word));
    ReadError::syntax(Place::Line(line), message)
}
