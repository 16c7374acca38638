//! Vertices repeated at seams, so that each has one value of every attribute.

use crate::{
    io::WriteError,
    losses::{Loss, LossKind, Losses, Stage},
    mesh::{Attribute, Domain, NO_ENTRY, TriMesh, Values},
};
use std::collections::HashMap;

/// A mesh with a vertex for each combination of values at a vertex, in the order of the vertices that they are of.
pub struct Split {
    /// The vertex of the mesh that each is.
    pub sources: Vec<u32>,
    pub triangles: Vec<[u32; 3]>,
    /// A corner of the mesh that has what each vertex has; [`NO_ENTRY`] of those without triangles.
    corners: Vec<u32>,
}

impl Split {
    /// Vertices are repeated where attributes of corners or triangles differ in value.
    ///
    /// # Errors
    /// If that is more than 32-bit indices can name.
    pub fn new<'a>(
        mesh: &TriMesh,
        attributes: impl Iterator<Item = &'a Attribute>,
    ) -> Result<Self, WriteError> {
        let mut names: Vec<u32> = mesh.triangles().as_flattened().to_vec();
        let mut is_split = false;
        for attribute in attributes.filter(|attribute| attribute.domain != Domain::Vertex) {
            refine(&mut names, attribute);
            is_split = true;
        }
        let all = 0..mesh.num_vertices() as u32;
        if !is_split {
            let (sources, triangles) = (all.collect(), mesh.triangles().to_vec());
            return Ok(Self { corners: first_corners(mesh), sources, triangles });
        }
        let most = names.len() + mesh.num_vertices();
        if most >= NO_ENTRY as usize {
            let message = format!("up to {most} vertices after splitting");
            return Err(WriteError::Unrepresentable { message });
        }
        Ok(Self::numbered(mesh, &names))
    }

    /// How many vertices are repeated, if any.
    pub fn loss(&self, mesh: &TriMesh) -> Losses {
        let count = self.sources.len() - mesh.num_vertices();
        let loss = Loss::new(Stage::Writing, LossKind::VerticesSplit, "").count(count);
        Some(loss).filter(|_| count > 0).into_iter().collect()
    }

    /// The mesh with its vertices repeated.
    pub fn mesh(&self, mesh: &TriMesh) -> TriMesh {
        let positions = self.sources.iter().map(|&vertex| mesh.positions()[vertex as usize]).collect();
        TriMesh::from_valid_parts(positions, self.triangles.clone())
    }

    /// An attribute on the repeated vertices, one of those that they were made for.
    pub fn on_vertices(&self, attribute: &Attribute) -> Attribute {
        let entry = |(&vertex, &corner): (&u32, &u32)| {
            let corner = Some(corner as usize).filter(|_| corner != NO_ENTRY);
            let entry = match attribute.domain {
                Domain::Vertex => attribute.entry(vertex as usize),
                Domain::Corner => corner.and_then(|corner| attribute.entry(corner)),
                Domain::Triangle => corner.and_then(|corner| attribute.entry(corner / 3)),
            };
            entry.map_or(NO_ENTRY, |entry| entry as u32)
        };
        let indices = Some(self.sources.iter().zip(&self.corners).map(entry).collect());
        Attribute { domain: Domain::Vertex, indices, ..attribute.clone() }
    }

    /// Numbers the vertices of the corners: by the vertex of the mesh, then by first use.
    fn numbered(mesh: &TriMesh, names: &[u32]) -> Self {
        let corners = mesh.triangles().as_flattened();
        // The first corner of each name, by vertex. Names are given by first use.
        let mut first: Vec<u32> = Vec::new();
        for (corner, &name) in names.iter().enumerate() {
            if name as usize == first.len() {
                first.push(corner as u32);
            }
        }
        let mut starts = vec![0u32; mesh.num_vertices() + 1];
        first.iter().for_each(|&corner| starts[corners[corner as usize] as usize] += 1);
        let mut total = 0;
        for start in &mut starts {
            // A vertex without triangles stays.
            let count = (*start).max(1);
            *start = total;
            total += count;
        }
        let num_split = starts.last().copied().unwrap_or(0) as usize;
        let mut split =
            Self { sources: vec![0; num_split], triangles: Vec::new(), corners: vec![NO_ENTRY; num_split] };
        for (vertex, pair) in starts.windows(2).enumerate() {
            split.sources[pair[0] as usize..pair[1] as usize].fill(vertex as u32);
        }
        let mut number_of = Vec::with_capacity(first.len());
        for &corner in &first {
            let next = &mut starts[corners[corner as usize] as usize];
            split.corners[*next as usize] = corner;
            number_of.push(*next);
            *next += 1;
        }
        let (triples, _) = names.as_chunks::<3>();
        split.triangles = triples.iter().map(|triple| triple.map(|name| number_of[name as usize])).collect();
        split
    }
}

/// A corner of each vertex.
fn first_corners(mesh: &TriMesh) -> Vec<u32> {
    let mut first = vec![NO_ENTRY; mesh.num_vertices()];
    for (corner, &vertex) in mesh.triangles().as_flattened().iter().enumerate() {
        if first[vertex as usize] == NO_ENTRY {
            first[vertex as usize] = corner as u32;
        }
    }
    first
}

/// Gives corners of one name different names where they have different values. Names are numbers by first use.
fn refine(names: &mut [u32], attribute: &Attribute) {
    let row_of = equal_rows(attribute);
    let row = |corner: usize| {
        let element = if attribute.domain == Domain::Triangle { corner / 3 } else { corner };
        attribute.entry(element).map_or(NO_ENTRY, |row| row_of[row])
    };
    let mut known: HashMap<(u32, u32), u32> = HashMap::new();
    for (corner, name) in names.iter_mut().enumerate() {
        let next = known.len() as u32;
        *name = *known.entry((*name, row(corner))).or_insert(next);
    }
}

/// A number for each row of a table of numbers, the same for rows of the same bits.
fn equal_rows(attribute: &Attribute) -> Vec<u32> {
    let n = attribute.num_components;
    let mut numbers = vec![0; attribute.num_entries()];
    if matches!(attribute.values, Values::Names(_)) {
        return (0..numbers.len() as u32).collect();
    }
    for k in 0..n {
        let mut known: HashMap<(u32, u64), u32> = HashMap::new();
        for (row, number) in numbers.iter_mut().enumerate() {
            let next = known.len() as u32;
            let bits = attribute.values.bits(row * n + k).unwrap_or(0);
            *number = *known.entry((*number, bits)).or_insert(next);
        }
    }
    numbers
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Semantic;

    /// Two triangles at an edge, and a vertex without triangles between their vertices.
    fn square() -> TriMesh {
        let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [9.0; 3], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        TriMesh::new(positions, vec![[4, 0, 3], [0, 1, 3]]).unwrap()
    }

    fn uv(domain: Domain, indices: &[u32]) -> Attribute {
        // The first two rows are equal.
        let values = Values::F32(vec![0.0, 1.0, 0.0, 1.0, 0.5, 0.5]);
        let indices = Some(indices.to_vec());
        Attribute { indices, ..Attribute::new("vt", Semantic::TexCoord(0), domain, 2, values) }
    }

    #[test]
    fn vertices_are_repeated_where_values_differ() {
        let (mesh, uv) = (square(), uv(Domain::Corner, &[0, 2, 0, 0, NO_ENTRY, 1]));
        let split = Split::new(&mesh, [&uv].into_iter()).unwrap();
        assert_eq!(split.sources, [0, 0, 1, 2, 3, 4]);
        assert_eq!(split.triangles, [[5, 0, 4], [1, 2, 4]]);
        assert_eq!(split.loss(&mesh).to_string(), "1 vertex repeated");
        let on_vertices = split.on_vertices(&uv);
        assert_eq!(on_vertices.validate(&split.mesh(&mesh)), Ok(()));
        assert_eq!(on_vertices.indices, Some(vec![2, 0, NO_ENTRY, NO_ENTRY, 0, 0]));
    }

    #[test]
    fn values_of_triangles_are_those_of_their_corners() {
        let (mesh, of_faces) = (square(), uv(Domain::Triangle, &[0, 2]));
        let split = Split::new(&mesh, [&of_faces].into_iter()).unwrap();
        assert_eq!(split.sources, [0, 0, 1, 2, 3, 3, 4]);
        assert_eq!(split.on_vertices(&of_faces).indices, Some(vec![0, 2, 2, NO_ENTRY, 0, 2, 0]));
    }

    #[test]
    fn a_mesh_without_seams_stays() {
        let (mesh, smooth) = (square(), uv(Domain::Vertex, &[0, 1, 2, NO_ENTRY, 0]));
        let split = Split::new(&mesh, [&smooth].into_iter()).unwrap();
        assert_eq!((split.mesh(&mesh), split.loss(&mesh).len()), (square(), 0));
        assert_eq!(split.on_vertices(&smooth).indices, smooth.indices);
    }
}
