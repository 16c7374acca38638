//! STL as text.
//!
//! Programs write keywords in either case and `end loop` in two words, and some have lines of their own, such as
//! `color`.

use super::weld::Welder;
use crate::io::{
    MeshFile, Place, ReadError,
    source::{Line, Source},
    text::{parse_number, quoted, words},
};

/// The longest word that is passed over as a statement we do not know; anything else is damage.
const MAX_KEYWORD_BYTES: usize = 32;

/// What a line says, as far as a mesh needs it.
enum Statement {
    Vertex,
    BeginLoop,
    EndLoop,
    Solid,
    /// Normals, and names that came before.
    Else,
    Unknown,
}

/// Reads `vertex` lines between `outer loop` and `endloop`. The other statements carry nothing we need.
pub(super) fn read(source: &mut Source) -> Result<MeshFile, ReadError> {
    let mut parser = Parser::default();
    loop {
        source.skip_empty_lines();
        let Some(line) = source.line() else { break };
        parser.take(line)?;
    }
    if parser.is_in_loop {
        return Err(ReadError::syntax(Place::Line(source.num_lines()), "the file ends in a facet"));
    }
    parser.welder.builder.finish()
}

#[derive(Default)]
struct Parser {
    welder: Welder,
    /// Of the loop so far.
    corners: Vec<u32>,
    is_in_loop: bool,
}

impl Parser {
    fn take(&mut self, line: Line) -> Result<(), ReadError> {
        let bad = |cause: &str| {
            ReadError::syntax(Place::Line(line.number), format!("{cause}: {}", quoted(line.text)))
        };
        if line.text.contains(&0) {
            return Err(bad("neither a text nor a binary file of the size it declares"));
        }
        let mut words = words(line.text);
        match (statement(&mut words), self.is_in_loop) {
            (Statement::Vertex, true) => {
                let position = position(words).ok_or_else(|| bad("a vertex needs three numbers"))?;
                self.corners.push(self.welder.vertex(position, Place::Line(line.number))?);
            }
            (Statement::BeginLoop, false) => self.is_in_loop = true,
            (Statement::EndLoop, true) => self.end_loop(),
            (Statement::Vertex | Statement::BeginLoop | Statement::EndLoop, _) => {
                return Err(bad("out of place"));
            }
            (Statement::Solid, _) => {
                if words.next().is_some() {
                    self.welder.builder.report.ignore("names of solids");
                }
            }
            (Statement::Else, _) => {}
            (Statement::Unknown, false) if self.pass_over(line.text) => {}
            (Statement::Unknown, _) => return Err(bad("not an STL statement")),
        }
        Ok(())
    }

    fn end_loop(&mut self) {
        self.is_in_loop = false;
        self.welder.builder.push_polygon(&self.corners);
        self.corners.clear();
    }

    /// Passes over a line of another program, unless it is damage.
    fn pass_over(&mut self, line: &[u8]) -> bool {
        let keyword = words(line).next().unwrap_or_default();
        let is_keyword = keyword.len() <= MAX_KEYWORD_BYTES && keyword.iter().all(u8::is_ascii_graphic);
        if is_keyword {
            self.welder.builder.report.ignore(&String::from_utf8_lossy(keyword));
        }
        is_keyword
    }
}

fn statement<'a>(words: &mut impl Iterator<Item = &'a [u8]>) -> Statement {
    let Some(keyword) = words.next() else { return Statement::Else };
    let is = |name: &str| keyword.eq_ignore_ascii_case(name.as_bytes());
    if is("vertex") {
        Statement::Vertex
    } else if is("facet") || is("endfacet") {
        Statement::Else
    } else if is("outer") {
        Statement::BeginLoop
    } else if is("endloop") {
        Statement::EndLoop
    } else if is("solid") {
        Statement::Solid
    } else if is("endsolid") {
        Statement::Else
    } else if is("end") {
        end_of(words.next().unwrap_or_default())
    } else {
        Statement::Unknown
    }
}

/// `end loop` and the like.
fn end_of(what: &[u8]) -> Statement {
    let is = |name: &str| what.eq_ignore_ascii_case(name.as_bytes());
    if is("loop") {
        Statement::EndLoop
    } else if is("facet") || is("solid") {
        Statement::Else
    } else {
        Statement::Unknown
    }
}

/// Three numbers, which follow the keyword.
fn position<'a>(mut words: impl Iterator<Item = &'a [u8]>) -> Option<[f64; 3]> {
    let mut position = [0.0; 3];
    for coordinate in &mut position {
        *coordinate = words.next().and_then(parse_number)?;
    }
    Some(position)
}
