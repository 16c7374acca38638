//! From the surface that passes refine to the mesh that was encoded: stitched vertices, isolated vertices and
//! degenerate faces, exact floats, the order of the file (`format/SPEC.md`, section 9).

use super::attributes::AttributeDecoder;
use super::forecast;
use super::refused::Refused;
use super::stream_info::TrailingKind;
use crate::bitstream::chunk::kind;
use crate::bitstream::grid::Grid;
use crate::entropy::range_coder::RangeDecoder;
use crate::error::DecodeError;
use crate::limits::Limits;
use crate::mesh::surface::turns;
use crate::mesh::{Attribute, Attributes, Domain, NO_ENTRY, TriMesh, has_three_vertices};
use crate::passes::attribute::{Declarations, Entries};
use crate::passes::cost::{self, Counts};
use crate::passes::isolated_and_degenerate::{self, Loose};
use crate::passes::order::{self, Order};
use crate::passes::stitching::{self, StitchingModels};
use crate::passes::values::{self, Elements, Told};
use crate::passes::{GridMesh, Malformed, exact};

/// What the trailing chunks received so far say about the finest mesh.
#[derive(Default)]
pub(crate) struct Extras {
    /// For each vertex the first that is the same; those beyond the end are separate vertices.
    pub(crate) roots: Vec<u32>,
    pub(crate) stitching: StitchingModels,
    pub(crate) loose: Option<Loose>,
    pub(crate) positions: Option<Vec<[f64; 3]>>,
    /// What the chunk of exact values says about each attribute.
    pub(crate) values: Vec<Told>,
    pub(crate) order: Option<Order>,
}

impl Extras {
    /// Bytes of memory that this takes.
    pub(super) fn memory(&self) -> u64 {
        let loose = self.loose.as_ref().map_or(0, |loose| size_of::<[u32; 3]>() as u64 * loose.len());
        let of_values = |told: &Told| 8 * told.values.len() + size_of::<u32>() * told.of.len();
        let exact = self.positions.as_ref().map_or(0, |positions| size_of::<[f64; 3]>() * positions.len());
        let values: usize = self.values.iter().map(of_values).sum();
        let order = self.order.as_ref().map_or(0, |order| order.vertices.len() + order.corners.len());
        loose + (size_of::<u32>() * (self.roots.capacity() + order) + exact + values) as u64
    }

    /// Whether all that is known fits the vertices and triangles of `mesh` and the isolated and degenerate
    /// ones: in whatever order the chunks came, no index is out of range.
    fn fit(&self, mesh: &GridMesh) -> bool {
        let joined = self.joined(mesh.positions.len());
        let num_vertices = joined.first.len() + self.num_loose(Domain::Vertex);
        let num_faces = joined.faces(&mesh.surface.triangles).count() + self.num_loose(Domain::Triangle);
        let loose = self.loose.iter().flat_map(|loose| loose.faces.iter().flatten());
        loose.into_iter().all(|&v| (v as usize) < num_vertices)
            && self.positions.as_ref().is_none_or(|positions| positions.len() == num_vertices)
            && self
                .order
                .as_ref()
                .is_none_or(|order| (order.vertices.len(), order.corners.len()) == (num_vertices, num_faces))
    }
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

    /// Elements of the surface in the order of the joined mesh; of a corner also its joined vertex, else 0.
    fn elements(&self, triangles: &[[u32; 3]], domain: Domain) -> Vec<[u32; 2]> {
        let faces = || self.faces(triangles);
        match domain {
            Domain::Vertex => self.first.iter().map(|&v| [v, 0]).collect(),
            Domain::Triangle => faces().map(|(face, _)| [face, 0]).collect(),
            Domain::Corner => {
                faces().flat_map(|(face, t)| [0, 1, 2].map(|k| [3 * face + k, t[k as usize]])).collect()
            }
        }
    }
}

impl Extras {
    pub(crate) fn joined(&self, num_vertices: usize) -> Joined {
        Joined::new(&self.roots, num_vertices)
    }

    /// A value for all vertices, given the values `of` those of the surface: first the stitched vertices,
    /// then the isolated ones, from their cells.
    fn of_vertices<T: Copy>(&self, joined: &Joined, of: &[T], give: impl Fn([i32; 3]) -> T) -> Vec<T> {
        let loose = self.loose.iter().flat_map(|loose| &loose.cells);
        joined.first.iter().map(|&v| of[v as usize]).chain(loose.map(|&cell| give(cell))).collect()
    }

    /// All triangles, given those of the surface: first these, of stitched vertices, then the degenerate
    /// faces.
    pub(crate) fn triangles(&self, joined: &Joined, triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
        let loose = self.loose.iter().flat_map(|loose| &loose.faces);
        joined.faces(triangles).map(|(_, triangle)| triangle).chain(loose.copied()).collect()
    }

    /// The mesh whose surface has these `triangles`; `positions` gives those of the vertices, isolated ones
    /// are on the `grid`.
    pub(super) fn assemble(
        &self,
        grid: &Grid,
        positions: impl FnOnce() -> Vec<[f64; 3]>,
        num_vertices: usize,
        triangles: &[[u32; 3]],
    ) -> TriMesh {
        let joined = self.joined(num_vertices);
        let faces = self.triangles(&joined, triangles);
        let positions = match &self.positions {
            Some(positions) => positions.clone(),
            None => {
                self.of_vertices(&joined, &positions(), |cell| grid.position(cell, grid.quantization_bits))
            }
        };
        match &self.order {
            Some(order) => order.apply(&positions, &faces),
            None => TriMesh::from_decoded_parts(positions, faces),
        }
    }
}

impl Extras {
    /// Number of isolated vertices, or of degenerate faces or their corners.
    fn num_loose(&self, domain: Domain) -> usize {
        let Some(loose) = &self.loose else { return 0 };
        match domain {
            Domain::Vertex => loose.cells.len(),
            Domain::Corner => 3 * loose.faces.len(),
            Domain::Triangle => loose.faces.len(),
        }
    }

    /// What has values of an attribute that has these `entries` on the surface.
    pub(crate) fn elements<'a>(
        &self,
        joined: &Joined,
        triangles: &[[u32; 3]],
        entries: &'a Entries,
        domain: Domain,
    ) -> Elements<'a> {
        Elements {
            entries,
            on_surface: joined.elements(triangles, domain),
            num_loose: self.num_loose(domain),
        }
    }

    /// The attributes of the assembled mesh, from those of the surface. Isolated vertices and degenerate
    /// faces have values only if a chunk gave them.
    pub(super) fn assemble_attributes(
        &self,
        num_vertices: usize,
        triangles: &[[u32; 3]],
        mut attributes: Attributes,
    ) -> Attributes {
        let is_whole = self.roots.iter().zip(0..).all(|(&root, v)| root == v);
        let is_alone = self.loose.is_none() && self.values.is_empty() && self.order.is_none();
        if attributes.list.is_empty() || is_whole && is_alone {
            return attributes;
        }
        let joined = self.joined(num_vertices);
        for (k, attribute) in attributes.list.iter_mut().enumerate() {
            self.assemble_one(&joined, triangles, self.values.get(k), attribute);
        }
        attributes
    }

    fn assemble_one(
        &self,
        joined: &Joined,
        triangles: &[[u32; 3]],
        told: Option<&Told>,
        attribute: &mut Attribute,
    ) {
        let mut entries: Vec<u32> = match told {
            Some(told) if told.is_exact => {
                attribute.values = told.values.clone();
                told.of.clone()
            }
            _ => {
                let entry = |[element, _]: [u32; 2]| attribute.entry(element as usize);
                let elements = joined.elements(triangles, attribute.domain).into_iter();
                elements.map(|element| entry(element).map_or(NO_ENTRY, |entry| entry as u32)).collect()
            }
        };
        if let Some(told) = told.filter(|told| !told.is_exact) {
            let first = attribute.num_entries() as u32;
            attribute.values.append(told.values.clone());
            entries.extend(
                told.of.iter().map(|&entry| if entry == NO_ENTRY { NO_ENTRY } else { first + entry }),
            );
        }
        if told.is_none() {
            entries.extend(std::iter::repeat_n(NO_ENTRY, self.num_loose(attribute.domain)));
        }
        if let Some(order) = &self.order {
            entries = match attribute.domain {
                Domain::Vertex => order.vertices.iter().map(|&v| entries[v as usize]).collect(),
                Domain::Corner => {
                    order.corners.iter().flat_map(|&c| turns(c).map(|c| entries[c as usize])).collect()
                }
                Domain::Triangle => order.corners.iter().map(|&c| entries[(c / 3) as usize]).collect(),
            };
        }
        attribute.indices = Some(entries);
    }
}

/// Bytes of memory that a vertex and a face may take for each kind of chunk, working space included.
const STITCHING_PER_VERTEX: u64 = 28;
const LOOSE_EACH: u64 = 24;
const EXACT_PER_VERTEX: u64 = 240;
/// Of an element, and of each component of its value.
const VALUE_EACH: u64 = 130;
const VALUE_PER_COMPONENT: u64 = 60;
const ORDER_PER_VERTEX: u64 = 24;
const ORDER_PER_FACE: u64 = 48;

/// A trailing chunk, and what it refers to.
#[derive(Clone, Copy)]
pub(super) struct NewChunk<'a> {
    pub(super) payload: &'a [u8],
    pub(super) mesh: &'a GridMesh,
    pub(super) grid: &'a Grid,
    pub(super) limits: &'a Limits,
    /// Memory that is taken already.
    pub(super) used: u64,
    /// Units of work that are left.
    pub(super) work: u64,
}

impl NewChunk<'_> {
    fn check_memory(&self, more: u64) -> Result<(), DecodeError> {
        Limits::check("memory", self.used + more, self.limits.max_memory)
    }
}

/// Units of work of a chunk for the vertices and faces of the surface.
fn units_on_surface(kind: u8, mesh: &GridMesh, declared: Option<&Declarations>) -> u64 {
    let (vertices, faces) = (mesh.positions.len() as u64, mesh.surface.triangles.len() as u64);
    let surface = Counts { vertices, triangles: faces };
    let none = Declarations::default();
    match kind {
        kind::STITCHING => cost::stitching(surface),
        _ => forecast::of_trailing(TrailingKind::new(kind), surface, declared.unwrap_or(&none)),
    }
}

impl Extras {
    /// Takes a chunk that follows a pass, or is skipped, and returns the units of work that this took.
    ///
    /// # Errors
    /// If it names something that no encoder writes, does not fit what is there, or is beyond a limit.
    pub(super) fn read(
        &mut self,
        kind: u8,
        chunk: NewChunk,
        attributes: Option<&AttributeDecoder>,
    ) -> Result<u64, Refused> {
        let declared = attributes.map(|attributes| &attributes.declarations);
        let units = units_on_surface(kind, chunk.mesh, declared);
        match (kind, attributes) {
            (kind::STITCHING, _) => self.read_stitching(chunk)?,
            (kind::LOOSE, _) => self.read_loose(chunk)?,
            (kind::EXACT, _) => self.read_exact(chunk)?,
            (kind::VALUES, Some(attributes)) => self.read_values(chunk, attributes)?,
            (kind::VALUES, None) => return Err(Malformed("values of no attributes").into()),
            (kind::ORDER, _) => self.read_order(chunk)?,
            _ => return Ok(units),
        }
        if kind != kind::STITCHING && !self.fit(chunk.mesh) {
            return Err(Malformed("a chunk that does not fit the mesh").into());
        }
        let loose = self.loose.as_ref().filter(|_| kind == kind::LOOSE);
        Ok(units + loose.map_or(0, |loose| cost::loose(loose.len())))
    }

    /// Stitches the vertices added since the last time.
    fn read_stitching(&mut self, chunk: NewChunk) -> Result<(), Refused> {
        chunk.check_memory(STITCHING_PER_VERTEX * chunk.mesh.positions.len() as u64)?;
        let known = self.roots.len();
        let mut coder = RangeDecoder::new(chunk.payload);
        let result = stitching::code(&mut coder, &mut self.stitching, chunk.mesh, &mut self.roots, None);
        if result.is_err() {
            self.roots.truncate(known);
        }
        Ok(result?)
    }

    /// Takes the isolated vertices and the degenerate faces.
    fn read_loose(&mut self, chunk: NewChunk) -> Result<(), Refused> {
        let NewChunk { payload, mesh, grid, limits, .. } = chunk;
        let mut coder = RangeDecoder::new(payload);
        let counts = isolated_and_degenerate::code_counts(&mut coder, payload.len(), None)?;
        let num_joined = self.joined(mesh.positions.len()).first.len();
        Limits::check("vertices", num_joined as u64 + counts[0], u64::from(limits.max_vertices))?;
        let count = counts[0] + counts[1];
        chunk.check_memory(LOOSE_EACH * count)?;
        Limits::check("work", cost::loose(count), chunk.work)?;
        self.loose = Some(isolated_and_degenerate::code(
            &mut coder,
            grid.quantization_bits,
            num_joined,
            counts,
            None,
        )?);
        Ok(())
    }

    /// Takes the exact positions.
    fn read_exact(&mut self, chunk: NewChunk) -> Result<(), Refused> {
        let NewChunk { payload, mesh, grid, .. } = chunk;
        let ladders = exact::read_ladders(payload).ok_or(Malformed("the kinds of exact numbers"))?;
        let cells = self.of_vertices(&self.joined(mesh.positions.len()), &mesh.positions, |cell| cell);
        chunk.check_memory(EXACT_PER_VERTEX * cells.len() as u64)?;
        let mut coder = RangeDecoder::new(&payload[exact::LADDER_BYTES..]);
        self.positions = Some(exact::code(&mut coder, grid, ladders, &cells, None)?);
        Ok(())
    }

    /// Takes values of attributes: exact ones, and those of isolated vertices and degenerate faces.
    fn read_values(&mut self, chunk: NewChunk, attributes: &AttributeDecoder) -> Result<(), Refused> {
        let NewChunk { payload, mesh, .. } = chunk;
        let triangles = &mesh.surface.triangles;
        let list = &attributes.declarations.list;
        let (ladders, used) =
            values::read_head(payload, list).ok_or(Malformed("the kinds of exact values"))?;
        let joined = self.joined(mesh.positions.len());
        let elements = |k: usize, entries| self.elements(&joined, triangles, entries, list[k].domain);
        let memory = |k: usize| {
            let on_surface = match list[k].domain {
                Domain::Vertex => mesh.positions.len(),
                Domain::Corner => 3 * triangles.len(),
                Domain::Triangle => triangles.len(),
            };
            let count = self.num_loose(list[k].domain) + if ladders[k].is_some() { on_surface } else { 0 };
            (VALUE_EACH + VALUE_PER_COMPONENT * list[k].num_components as u64) * count as u64
        };
        chunk.check_memory((0..list.len()).map(memory).sum())?;
        let mut coder = RangeDecoder::new(&payload[used..]);
        let mut told = Vec::with_capacity(list.len());
        for (k, entries) in attributes.entries().enumerate() {
            let elements = elements(k, entries);
            told.push(values::code(&mut coder, &list[k], &ladders[k], &elements, None)?);
        }
        self.values = told;
        Ok(())
    }

    /// Takes the order of the file.
    fn read_order(&mut self, chunk: NewChunk) -> Result<(), Refused> {
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
