//! What all readers do with vertices and faces once they have them.

use super::polygon::{Cut, Cutter, quad_fits, recut};
use super::{MeshFile, ReadError, ReadReport};
use crate::mesh::{Attributes, Domain, NO_ENTRY, TriMesh};

/// How many different names of ignored things a report lists: a damaged text has a new one on every line.
const MAX_IGNORED_NAMES: usize = 64;

/// How many indices of attributes there may be for each byte of a file, and how many in any file. Every
/// triangle of a polygon repeats the rows of all its attributes, so few bytes can ask for much memory.
const MAX_ROWS_PER_BYTE: usize = 16;
const MIN_MAX_ROWS: usize = 1 << 20;

/// A mesh and its report while they are read.
#[derive(Default)]
pub(super) struct MeshBuilder {
    pub positions: Vec<[f64; 3]>,
    pub triangles: Vec<[u32; 3]>,
    /// Indices of faces and corners may end early: the triangles that follow have no row.
    pub attributes: Attributes,
    pub report: ReadReport,
    /// Bytes of the file, as far as they are read.
    pub num_bytes: usize,
    /// The faces of more than three corners. They are fans until the end: vertices may follow.
    polygons: Vec<Polygon>,
}

/// A fan among the triangles.
struct Polygon {
    first_triangle: u32,
    num_corners: u32,
}

impl MeshBuilder {
    /// For a file of this many bytes.
    #[cfg(any(feature = "gltf", feature = "las"))]
    pub fn for_file(num_bytes: usize) -> Self {
        Self { num_bytes, ..Self::default() }
    }

    /// Whether this many attributes may have an index for each of `num_elements`.
    ///
    /// # Errors
    /// If that is out of proportion to the file.
    pub fn check_rows(&self, num_attributes: usize, num_elements: usize) -> Result<(), ReadError> {
        let max_rows = self.num_bytes.saturating_mul(MAX_ROWS_PER_BYTE).max(MIN_MAX_ROWS);
        if num_attributes.saturating_mul(num_elements) <= max_rows {
            return Ok(());
        }
        let message = format!("{num_attributes} attributes of {num_elements} triangles or corners");
        Err(ReadError::TooLarge { message })
    }

    /// Adds a face of any number of corners, as the fan of its first one for now: values of its corners are in
    /// this order, too, until [`MeshBuilder::finish`].
    pub fn push_polygon(&mut self, corners: &[u32]) {
        let first_triangle = self.triangles.len() as u32;
        self.triangles.extend(fan(corners.len()).map(|triangle| triangle.map(|k| corners[k])));
        match corners.len() {
            0..3 => self.report.faces_skipped += 1,
            3 => {}
            num_corners => {
                self.report.polygons_triangulated += 1;
                // What is too many for 32 bits is refused with the triangles.
                self.polygons.push(Polygon { first_triangle, num_corners: num_corners as u32 });
            }
        }
    }

    /// Cuts those polygons by ears of which the fan leaves them.
    fn cut_polygons(&mut self) {
        let mut cutter = Cutter::default();
        let mut corners = Vec::new();
        for Polygon { first_triangle, num_corners } in std::mem::take(&mut self.polygons) {
            let first = first_triangle as usize;
            if num_corners == 4 && self.is_plain_quad(first) {
                continue;
            }
            let fan = first..first + num_corners as usize - 2;
            corners.clear();
            corners.extend(corners_of(&self.triangles[fan.clone()]).map(|v| self.positions[v as usize]));
            match cutter.cut(&corners) {
                Cut::Fan => {}
                Cut::Overlapping => self.report.polygons_overlapping += 1,
                Cut::Ears(ears) => self.recut(3 * fan.start..3 * fan.end, &ears),
            }
        }
    }

    /// Whether the two triangles from `first` on are a quad that is a fan.
    fn is_plain_quad(&self, first: usize) -> bool {
        let [[a, b, c], [_, _, d]] = [self.triangles[first], self.triangles[first + 1]];
        quad_fits([a, b, c, d].map(|v| &self.positions[v as usize]))
    }

    /// `corners`: those of a fan, of which these are the triangles instead.
    fn recut(&mut self, corners: std::ops::Range<usize>, triangles: &[[u32; 3]]) {
        recut(&mut self.triangles.as_flattened_mut()[corners.clone()], triangles);
        for attribute in self.attributes.list.iter_mut().filter(|a| a.domain == Domain::Corner) {
            if let Some(rows) = attribute.indices.as_mut().and_then(|rows| rows.get_mut(corners.clone())) {
                recut(rows, triangles);
            }
        }
    }

    /// Adds a triangle strip. Every second triangle of a strip has the opposite winding.
    pub fn push_strip(&mut self, corners: &[u32]) {
        let turned =
            |(k, t): (usize, &[u32])| if k % 2 == 0 { [t[0], t[1], t[2]] } else { [t[1], t[0], t[2]] };
        self.triangles.extend(corners.windows(3).enumerate().map(turned));
    }

    pub fn finish(mut self) -> Result<MeshFile, ReadError> {
        let num_indexed = self.attributes.list.iter().filter(|a| a.indices.is_some()).count();
        self.check_rows(num_indexed, self.positions.len().max(3 * self.triangles.len()))?;
        let num_triangles = self.triangles.len();
        if num_triangles <= u32::MAX as usize {
            self.cut_polygons();
        }
        let mesh = TriMesh::new(self.positions, self.triangles)?;
        for attribute in &mut self.attributes.list {
            let num_rows = attribute.num_entries();
            if let Some(indices) = &mut attribute.indices {
                indices.resize(attribute.domain.num_elements(&mesh), NO_ENTRY);
                if indices.len() == num_rows && indices.iter().enumerate().all(|(k, &row)| k == row as usize)
                {
                    attribute.indices = None;
                }
            }
            // Readers count as they go: this is about more values than 32-bit indices can name.
            let too_large = |error| ReadError::TooLarge { message: format!("{}: {error}", attribute.name) };
            attribute.validate(&mesh).map_err(too_large)?;
        }
        Ok(MeshFile { mesh, attributes: self.attributes, report: self.report })
    }
}

/// The corners of a polygon of which this is the fan.
fn corners_of(fan: &[[u32; 3]]) -> impl Iterator<Item = u32> {
    let first_two = fan.first().into_iter().flat_map(|triangle| [triangle[0], triangle[1]]);
    first_two.chain(fan.iter().map(|triangle| triangle[2]))
}

/// The triangles of a polygon, as positions in its list of corners: the fan of the first corner.
pub(super) fn fan(num_corners: usize) -> impl Iterator<Item = [usize; 3]> {
    (1..num_corners.saturating_sub(1)).map(|k| [0, k, k + 1])
}

impl ReadReport {
    /// Notes that something called `name` was left out.
    pub(super) fn ignore(&mut self, name: &str) {
        if self.ignored.len() < MAX_IGNORED_NAMES && !self.ignored.iter().any(|known| known == name) {
            self.ignored.push(name.to_owned());
        }
    }

    /// Notes that what the file calls `from` is `to` in the mesh.
    #[cfg(any(feature = "gltf", feature = "las"))]
    pub(super) fn rename(&mut self, from: &str, to: &str) {
        self.note_renamed(format!("{} ({})", plain(from), plain(to)));
    }

    #[cfg(any(feature = "gltf", feature = "las"))]
    fn note_renamed(&mut self, entry: String) {
        if self.renamed.len() < MAX_IGNORED_NAMES && !self.renamed.contains(&entry) {
            self.renamed.push(entry);
        }
    }

    /// Adds the counts and names of another report.
    #[cfg(feature = "gltf")]
    pub(super) fn add(&mut self, other: &Self) {
        self.polygons_triangulated += other.polygons_triangulated;
        self.polygons_overlapping += other.polygons_overlapping;
        self.faces_skipped += other.faces_skipped;
        self.corners_welded += other.corners_welded;
        self.points_left_out += other.points_left_out;
        self.points_withheld += other.points_withheld;
        self.colours_of_8_bits += other.colours_of_8_bits;
        other.renamed.iter().for_each(|entry| self.note_renamed(entry.clone()));
        other.ignored.iter().for_each(|name| self.ignore(name));
    }
}

/// A name for a message: control characters are spelled, and it is no longer than a line.
#[cfg(any(feature = "gltf", feature = "las"))]
pub(super) fn plain(name: &str) -> String {
    const MAX_CHARS: usize = 60;
    let mut plain = String::new();
    for c in name.chars().take(MAX_CHARS) {
        if c.is_control() { plain.extend(c.escape_default()) } else { plain.push(c) }
    }
    if name.chars().nth(MAX_CHARS).is_some() {
        plain.push('…');
    }
    plain
}
