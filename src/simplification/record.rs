//! What one level removed.

/// Stars of the odd vertices of one level, in order of removal.
#[derive(Clone, Debug, Default)]
pub(crate) struct LevelRecord {
    vertices: Vec<u32>,
    ring_ends: Vec<u32>,
    /// Neighbours, counter-clockwise; an open ring goes from boundary to boundary.
    rings: Vec<u32>,
    face_ends: Vec<u32>,
    /// Slots of the star's faces, face i at ring edge i. The first `ring − 2` slots hold the patch
    /// afterwards, the others are free.
    faces: Vec<u32>,
    /// Per attribute of corners the entries of each of these faces at both ends of its ring edge and at the vertex, per
    /// attribute of faces the entry of each face.
    entries: Vec<Vec<u32>>,
}

/// One removed vertex with what stood around it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Removed<'a> {
    pub(crate) vertex: u32,
    pub(crate) ring: &'a [u32],
    pub(crate) faces: &'a [u32],
    /// Where these faces are among all of the level.
    pub(crate) first_face: usize,
}

impl Removed<'_> {
    pub(crate) fn is_closed(&self) -> bool {
        self.ring.len() == self.faces.len()
    }

    /// Slots of the patch after removal.
    pub(crate) fn patch(&self) -> &[u32] {
        &self.faces[..self.ring.len() - 2]
    }
}

impl LevelRecord {
    pub(crate) fn push(&mut self, vertex: u32, ring: &[u32], faces: &[u32]) {
        self.vertices.push(vertex);
        self.rings.extend_from_slice(ring);
        self.ring_ends.push(self.rings.len() as u32);
        self.faces.extend_from_slice(faces);
        self.face_ends.push(self.faces.len() as u32);
    }

    /// The entries of attributes at the faces of the vertex that was pushed last.
    pub(crate) fn push_entries(&mut self, attribute: usize, entries: impl Iterator<Item = u32>) {
        if self.entries.len() <= attribute {
            self.entries.resize(attribute + 1, Vec::new());
        }
        self.entries[attribute].extend(entries);
    }

    /// All entries of an attribute.
    pub(crate) fn entries(&self, attribute: usize) -> &[u32] {
        &self.entries[attribute]
    }

    pub(crate) fn len(&self) -> usize {
        self.vertices.len()
    }

    pub(crate) fn get(&self, index: usize) -> Removed<'_> {
        let start = |ends: &[u32]| if index == 0 { 0 } else { ends[index - 1] as usize };
        Removed {
            vertex: self.vertices[index],
            ring: &self.rings[start(&self.ring_ends)..self.ring_ends[index] as usize],
            faces: &self.faces[start(&self.face_ends)..self.face_ends[index] as usize],
            first_face: start(&self.face_ends),
        }
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = Removed<'_>> {
        (0..self.len()).map(|i| self.get(i))
    }

    /// Gives back what `Vec` growth left over.
    pub(crate) fn shrink_to_fit(&mut self) {
        for v in
            [&mut self.vertices, &mut self.ring_ends, &mut self.rings, &mut self.face_ends, &mut self.faces]
        {
            v.shrink_to_fit();
        }
    }
}
