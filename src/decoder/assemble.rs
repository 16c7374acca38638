//! From the surface that passes refine to the mesh that was encoded: vertices joined where it was cut, what
//! lies loose beside it, exact floats, the order of the file (`format/SPEC.md`, section 9).

use crate::bitstream::header::Grid;
use crate::bitstream::range_coder::RangeDecoder;
use crate::limits::Limits;
use crate::mesh::{Attributes, Domain, GltfMaterials, NO_ROW, has_three_vertices};
use crate::passes::glue::{self, GlueModels};
use crate::passes::loose::{self, Loose};
use crate::passes::order::{self, Order};
use crate::passes::{GridMesh, Malformed, exact};
use crate::{DecodeError, TriMesh, scene};

/// What the chunks beside the passes tell of the finest mesh, as far as they have come.
#[derive(Default)]
pub(crate) struct Extras {
    /// For each vertex the first that is the same; those beyond the end are vertices of their own.
    pub(crate) roots: Vec<u32>,
    pub(crate) glue: GlueModels,
    pub(crate) loose: Option<Loose>,
    pub(crate) positions: Option<Vec<[f64; 3]>>,
    pub(crate) order: Option<Order>,
}

/// The vertices of a surface, joined.
pub(crate) struct Joined {
    /// Joined vertex of each vertex.
    pub(crate) place: Vec<u32>,
    /// First vertex of each joined one.
    pub(crate) first: Vec<u32>,
}

impl Joined {
    pub(crate) fn new(roots: &[u32], num_vertices: usize) -> Self {
        let mut joined = Self { place: Vec::with_capacity(num_vertices), first: Vec::new() };
        for v in 0..num_vertices {
            let root = roots.get(v).map_or(v, |&root| root as usize);
            if root < v {
                joined.place.push(joined.place[root]);
            } else {
                joined.place.push(joined.first.len() as u32);
                joined.first.push(v as u32);
            }
        }
        joined
    }

    /// The triangles of joined vertices that keep three of them, each with its place among all.
    fn faces<'a>(&'a self, triangles: &'a [[u32; 3]]) -> impl Iterator<Item = (u32, [u32; 3])> + 'a {
        let joined = (0..).zip(triangles.iter().map(|t| t.map(|v| self.place[v as usize])));
        joined.filter(|(_, triangle)| has_three_vertices(triangle))
    }
}

impl Extras {
    pub(crate) fn joined(&self, num_vertices: usize) -> Joined {
        Joined::new(&self.roots, num_vertices)
    }

    /// Cells of all vertices, given those of the surface: these joined, then the loose ones.
    fn cells(&self, joined: &Joined, cells: &[[i32; 3]]) -> Vec<[i32; 3]> {
        let loose = self.loose.iter().flat_map(|loose| &loose.cells);
        joined.first.iter().map(|&v| cells[v as usize]).chain(loose.copied()).collect()
    }

    /// All triangles, given those of the surface: these of joined vertices, then the loose ones.
    pub(crate) fn triangles(&self, joined: &Joined, triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
        let loose = self.loose.iter().flat_map(|loose| &loose.faces);
        joined.faces(triangles).map(|(_, triangle)| triangle).chain(loose.copied()).collect()
    }

    /// The mesh whose surface has these `cells`, of `precision` bits, and `triangles`.
    pub(super) fn assemble(
        &self,
        grid: &Grid,
        precision: u32,
        cells: &[[i32; 3]],
        triangles: &[[u32; 3]],
    ) -> TriMesh {
        let joined = self.joined(cells.len());
        let faces = self.triangles(&joined, triangles);
        let positions = match &self.positions {
            Some(positions) => positions.clone(),
            None => {
                self.cells(&joined, cells).into_iter().map(|cell| grid.position(cell, precision)).collect()
            }
        };
        match &self.order {
            Some(order) => order.apply(&positions, &faces),
            None => TriMesh::from_valid_parts(positions, faces),
        }
    }
}

/// What the parts of an assembled mesh are on the surface, `None` if they lie loose.
struct Elements {
    vertices: Vec<Option<u32>>,
    /// Of each triangle the corner that is its first one.
    corners: Vec<Option<u32>>,
}

impl Elements {
    fn of(&self, domain: Domain) -> Vec<Option<u32>> {
        let corner = |c: u32, k: u32| c / 3 * 3 + (c + k) % 3;
        match domain {
            Domain::Vertex => self.vertices.clone(),
            Domain::Corner => {
                let of_face = |c: &Option<u32>| [0, 1, 2].map(|k| c.map(|c| corner(c, k)));
                self.corners.iter().flat_map(of_face).collect()
            }
            Domain::Face => self.corners.iter().map(|c| c.map(|c| c / 3)).collect(),
        }
    }
}

impl Extras {
    fn elements(&self, num_vertices: usize, triangles: &[[u32; 3]]) -> Elements {
        let joined = self.joined(num_vertices);
        let (num_loose, num_loose_faces) =
            self.loose.as_ref().map_or((0, 0), |loose| (loose.cells.len(), loose.faces.len()));
        let loose = |count| std::iter::repeat_n(None, count);
        let vertices = joined.first.iter().map(|&v| Some(v)).chain(loose(num_loose)).collect();
        let corners = joined.faces(triangles).map(|(face, _)| Some(3 * face));
        let in_place = Elements { vertices, corners: corners.chain(loose(num_loose_faces)).collect() };
        let Some(order) = &self.order else { return in_place };
        let corner = |&c: &u32| in_place.corners[(c / 3) as usize].map(|first| first + c % 3);
        Elements {
            vertices: order.vertices.iter().map(|&v| in_place.vertices[v as usize]).collect(),
            corners: order.corners.iter().map(corner).collect(),
        }
    }

    /// The attributes of the assembled mesh, from those of the surface. What lies loose has none.
    pub(super) fn assemble_attributes(
        &self,
        num_vertices: usize,
        triangles: &[[u32; 3]],
        mut attributes: Attributes,
    ) -> Attributes {
        let is_whole = self.roots.iter().zip(0..).all(|(&root, v)| root == v);
        if attributes.list.is_empty() || is_whole && self.loose.is_none() && self.order.is_none() {
            return attributes;
        }
        let elements = self.elements(num_vertices, triangles);
        for attribute in &mut attributes.list {
            let row = |element: Option<u32>| attribute.row(element? as usize).map(|row| row as u32);
            let rows =
                elements.of(attribute.domain).into_iter().map(|element| row(element).unwrap_or(NO_ROW));
            attribute.indices = Some(rows.collect());
        }
        attributes
    }
}

/// Why a chunk is refused.
pub(super) enum Refused {
    Malformed(Malformed),
    Limit(DecodeError),
}

impl Refused {
    pub(super) fn at(self, offset: u64) -> DecodeError {
        match self {
            Self::Malformed(Malformed(what)) => DecodeError::Malformed { what, offset },
            Self::Limit(error) => error,
        }
    }
}

impl From<Malformed> for Refused {
    fn from(malformed: Malformed) -> Self {
        Self::Malformed(malformed)
    }
}

impl From<DecodeError> for Refused {
    fn from(error: DecodeError) -> Self {
        Self::Limit(error)
    }
}

/// Bytes of memory that a vertex and a face may take for each kind of chunk, working space included.
const GLUE_PER_VERTEX: u64 = 28;
const LOOSE_EACH: u64 = 24;
const EXACT_PER_VERTEX: u64 = 240;
const ORDER_PER_VERTEX: u64 = 24;
const ORDER_PER_FACE: u64 = 48;

/// A chunk beside the passes, and what it tells of.
#[derive(Clone, Copy)]
pub(super) struct Beside<'a> {
    pub(super) payload: &'a [u8],
    pub(super) mesh: &'a GridMesh,
    pub(super) grid: &'a Grid,
    pub(super) limits: &'a Limits,
    /// Memory that is taken already.
    pub(super) used: u64,
}

impl Beside<'_> {
    fn check_memory(&self, more: u64) -> Result<(), DecodeError> {
        Limits::check("memory", self.used + more, self.limits.max_memory)
    }
}

impl Extras {
    /// Joins vertices that have come since the last time.
    pub(super) fn read_glue(&mut self, chunk: Beside) -> Result<(), Refused> {
        chunk.check_memory(GLUE_PER_VERTEX * chunk.mesh.positions.len() as u64)?;
        let known = self.roots.len();
        let mut coder = RangeDecoder::new(chunk.payload);
        let result = glue::code(&mut coder, &mut self.glue, chunk.mesh, &mut self.roots, None);
        if result.is_err() {
            self.roots.truncate(known);
        }
        Ok(result?)
    }

    /// Takes what lies loose beside the finest surface.
    pub(super) fn read_loose(&mut self, chunk: Beside) -> Result<(), Refused> {
        let Beside { payload, mesh, grid, limits, .. } = chunk;
        let mut coder = RangeDecoder::new(payload);
        let counts = loose::code_counts(&mut coder, payload.len(), None)?;
        let num_joined = self.joined(mesh.positions.len()).first.len();
        Limits::check("vertices", num_joined as u64 + counts[0], u64::from(limits.max_vertices))?;
        chunk.check_memory(LOOSE_EACH * (counts[0] + counts[1]))?;
        self.loose = Some(loose::code(&mut coder, grid.precision, num_joined, counts, None)?);
        Ok(())
    }

    /// Takes the exact positions.
    pub(super) fn read_exact(&mut self, chunk: Beside) -> Result<(), Refused> {
        let Beside { payload, mesh, grid, .. } = chunk;
        let ladders = exact::read_ladders(payload).ok_or(Malformed("the kinds of exact numbers"))?;
        let cells = self.cells(&self.joined(mesh.positions.len()), &mesh.positions);
        chunk.check_memory(EXACT_PER_VERTEX * cells.len() as u64)?;
        let mut coder = RangeDecoder::new(&payload[exact::LADDER_BYTES..]);
        self.positions = Some(exact::code(&mut coder, grid, ladders, &cells, None)?);
        Ok(())
    }

    /// Takes the order of the file.
    pub(super) fn read_order(&mut self, chunk: Beside) -> Result<(), Refused> {
        let mesh = chunk.mesh;
        let joined = self.joined(mesh.positions.len());
        let num_vertices = joined.first.len() + self.loose.as_ref().map_or(0, |loose| loose.cells.len());
        let faces = self.triangles(&joined, &mesh.surface.triangles);
        chunk.check_memory(ORDER_PER_VERTEX * num_vertices as u64 + ORDER_PER_FACE * faces.len() as u64)?;
        let mut coder = RangeDecoder::new(chunk.payload);
        self.order = Some(order::code(&mut coder, num_vertices, &faces, None)?);
        Ok(())
    }
}

/// Takes how materials look, from a chunk before the passes or behind them.
pub(super) fn read_materials(payload: &[u8], limits: &Limits, used: u64) -> Result<GltfMaterials, Refused> {
    Limits::check("memory", used + payload.len() as u64, limits.max_memory)?;
    Ok(scene::read_materials(payload).ok_or(Malformed("materials"))?)
}
