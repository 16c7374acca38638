//! Wavefront OBJ.
//!
//! The reader is our own. `tobj` forgets the order of the vertices, drops unused ones, splits those with several
//! texture coordinates, has no line numbers in its errors and does not know continuation lines. This one goes
//! through the file once, statement by statement, so that a compressed file is never in memory as a whole.
//! What vertices, faces and corners have in addition to positions is gathered separately ([`Gathered`]).

mod colours;
mod corner_tables;
mod layout;
#[cfg(feature = "gltf")]
mod mtl;
mod references;
mod rows;
mod statements;
mod write;

pub(super) use write::Plan;

use super::{
    MeshFile, Place, ReadError,
    beside::Folder,
    builder::MeshBuilder,
    source::Source,
    text::{parse_number, quoted},
};
use corner_tables::Gathered;
use references::References;
use statements::{COLOURS, Statement, Statements};

/// The longest word that is passed over as a statement we do not know; anything else is damage.
const MAX_KEYWORD_BYTES: usize = 32;

/// Reads an OBJ file, and the materials that it uses from the libraries in `folder`. Points, lines, curves and
/// surfaces are ignored.
#[cfg_attr(not(feature = "gltf"), allow(unused_variables))]
pub(super) fn read(source: &mut Source, folder: &mut Folder) -> Result<MeshFile, ReadError> {
    let mut parser = Parser::default();
    let mut statements = Statements::new(source);
    while let Some(statement) = statements.next() {
        parser.take(&statement).map_err(|fault| fault.in_statement(&statement))?;
    }
    parser.builder.num_bytes = source.offset();
    #[cfg_attr(not(feature = "gltf"), allow(unused_mut))]
    let mut file = parser.finish()?;
    #[cfg(feature = "gltf")]
    mtl::attach(&mut file, folder);
    Ok(file)
}

/// What is wrong with a statement.
enum Fault {
    /// The message quotes the statement.
    Statement(&'static str),
    Message(String),
}

impl From<&'static str> for Fault {
    fn from(cause: &'static str) -> Self {
        Self::Statement(cause)
    }
}

impl Fault {
    fn in_statement(self, statement: &Statement) -> ReadError {
        let message = match self {
            Self::Statement(cause) => format!("{cause}: {}", quoted(statement.text)),
            Self::Message(message) => message,
        };
        ReadError::syntax(Place::Line(statement.line), message)
    }
}

/// The mesh so far.
#[derive(Default)]
struct Parser {
    builder: MeshBuilder,
    gathered: Gathered,
    /// Corners that name vertices further down in the file.
    vertices: References,
    /// Of each face.
    num_corners: Vec<u32>,
    corners: Vec<u32>,
}

impl Parser {
    fn take(&mut self, statement: &Statement) -> Result<(), Fault> {
        let keyword = statement.keyword();
        match keyword {
            b"" => {}
            b"v" => self.vertex(statement)?,
            b"f" => self.face(statement)?,
            b"vt" | b"vn" | b"usemtl" | b"g" | b"o" | b"s" | b"mtllib" | COLOURS => {
                self.gathered.statement(statement, &mut self.builder.report)?;
            }
            _ if keyword.len() <= MAX_KEYWORD_BYTES && keyword.iter().all(u8::is_ascii_graphic) => {
                self.builder.report.ignore(&String::from_utf8_lossy(keyword));
            }
            _ => return Err("not an OBJ statement".into()),
        }
        Ok(())
    }

    fn vertex(&mut self, statement: &Statement) -> Result<(), Fault> {
        let mut words = statement.words().skip(1);
        let mut position = [0.0; 3];
        for coordinate in &mut position {
            let word = words.next();
            *coordinate = word.and_then(parse_number).ok_or("a vertex needs three numbers")?;
            if let Some(word) = word.filter(|_| !coordinate.is_finite()) {
                let (vertex, word) = (self.builder.positions.len() + 1, quoted(word));
                let message = format!("vertex {vertex} has a coordinate that is not finite: {word}");
                return Err(Fault::Message(message));
            }
        }
        self.builder.positions.push(position);
        Ok(self.gathered.vertex(words, &mut self.builder.report)?)
    }

    fn face(&mut self, statement: &Statement) -> Result<(), Fault> {
        self.corners.clear();
        let num_vertices = self.builder.positions.len();
        for corner in statement.words().skip(1) {
            let index = corner.split(|&byte| byte == b'/').next().unwrap_or_default();
            let found = self.vertices.resolve(index, num_vertices, statement.line);
            let found = found.ok_or("a corner of a face is not a vertex index")?;
            let no_vertex =
                || format!("there is no vertex {}: {num_vertices} are defined above", quoted(index));
            // Whoever counts beyond 32 bits is refused at the end.
            self.corners.push(found.ok_or_else(|| Fault::Message(no_vertex()))?);
        }
        self.num_corners.push(u32::try_from(self.corners.len()).map_err(|_| "too many corners")?);
        self.builder.push_polygon(&self.corners);
        Ok(self.gathered.face(statement, &mut self.builder.report)?)
    }

    fn finish(self) -> Result<MeshFile, ReadError> {
        let Self { mut builder, gathered, vertices, num_corners, .. } = self;
        let num_vertices = builder.positions.len();
        if let Some((line, index)) = vertices.first_beyond(num_vertices) {
            let message = format!("there is no vertex `{index}`: the file has {num_vertices}");
            return Err(ReadError::syntax(Place::Line(line), message));
        }
        gathered.check_references(&mut builder.report)?;
        builder.attributes =
            gathered.into_attributes(&num_corners, builder.triangles.len(), &mut builder.report);
        builder.finish()
    }
}
