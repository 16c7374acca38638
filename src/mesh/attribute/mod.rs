//! What a mesh carries besides positions and triangles.
//!
//! An [`Attribute`] is a table of values and, unless every element has its own entry, an array that says which
//! entry an element has. A seam is two corners at one vertex with different entries: it does not split the vertex.
//!
//! ```
//! use lwc::TriMesh;
//! use lwc::mesh::{Attribute, Domain, NO_ENTRY, Semantic, Values};
//!
//! let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
//! let mesh = TriMesh::new(square.to_vec(), vec![[0, 1, 2], [0, 2, 3]])?;
//! // Five texture coordinates for four vertices, none at the last corner.
//! let uv = Attribute {
//!     indices: Some(vec![0, 1, 2, 3, 4, NO_ENTRY]),
//!     ..Attribute::new(
//!         "vt",
//!         Semantic::TexCoord(0),
//!         Domain::Corner,
//!         2,
//!         Values::F32(vec![0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.5, 0.5, 0.9, 0.9]),
//!     )
//! };
//! uv.validate(&mesh)?;
//! assert_eq!((uv.entry(3), uv.entry(5)), (Some(3), None));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod values;

pub use values::{ComponentType, Values};

use super::{SceneTable, TriMesh};
use std::fmt;
use std::sync::Arc;
use thiserror::Error;

/// In [`Attribute::indices`]: this element has no value.
pub const NO_ENTRY: u32 = u32::MAX;

/// The most components that an entry may have, those of a 4 × 4 matrix.
pub const MAX_COMPONENTS: usize = 16;

/// What the values mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Semantic {
    /// Direction away from the surface, three components.
    Normal,
    /// Place in a texture, this set of several.
    TexCoord(u32),
    /// Red, green, blue and perhaps opacity, this set of several.
    Color(u32),
    /// Which material: a name, or a number.
    Material,
    /// Which group of faces (OBJ `g`).
    Group,
    /// Which object (OBJ `o`) or part of a scene (a node of glTF).
    Object,
    /// Anything else; the name says what.
    Generic,
}

impl Semantic {
    /// Name in reports and in Python.
    pub fn name(self) -> &'static str {
        match self {
            Self::Normal => "normal",
            Self::TexCoord(_) => "texcoord",
            Self::Color(_) => "color",
            Self::Material => "material",
            Self::Group => "group",
            Self::Object => "object",
            Self::Generic => "generic",
        }
    }

    /// Which of several sets; 0 where there is one only.
    pub fn set_index(self) -> u32 {
        match self {
            Self::TexCoord(set) | Self::Color(set) => set,
            _ => 0,
        }
    }
}

/// What has a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Domain {
    /// Every vertex.
    Vertex,
    /// Every corner of a triangle; corner `c` of triangle `t` is element `3 t + c`.
    Corner,
    /// Every triangle.
    Triangle,
}

impl Domain {
    /// Every domain, in the order of the variants.
    pub const ALL: [Self; 3] = [Self::Vertex, Self::Corner, Self::Triangle];

    /// How many elements `mesh` has.
    pub fn num_elements(self, mesh: &TriMesh) -> usize {
        match self {
            Self::Vertex => mesh.num_vertices(),
            Self::Corner => 3 * mesh.num_triangles(),
            Self::Triangle => mesh.num_triangles(),
        }
    }
}

impl fmt::Display for Domain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Vertex => "vertices",
            Self::Corner => "corners",
            Self::Triangle => "triangles",
        })
    }
}

/// A table of values, and which element has which entry of it.
///
/// Only [`Self::validate`] keeps these fields consistent: whoever makes an attribute, or changes the mesh
/// under it, calls that before somebody else uses both.
#[derive(Clone, Debug, PartialEq)]
pub struct Attribute {
    /// What the file calls it: an OBJ statement (`vt`), an attribute of glTF (`TEXCOORD_0`), the names of PLY
    /// properties with a space between (`nx ny nz`), a field of LAS (`classification`).
    pub name: String,
    /// What the values mean.
    pub semantic: Semantic,
    /// What has a value.
    pub domain: Domain,
    /// Values of an entry, 1 to [`MAX_COMPONENTS`]; 1 for names.
    pub num_components: usize,
    /// Whether integers stand for fractions: [`ComponentType::one`] is 1.
    pub is_normalized: bool,
    /// The table, entry by entry.
    pub values: Values,
    /// The entry of each element, or [`NO_ENTRY`]. `None`: element k has entry k.
    pub indices: Option<Vec<u32>>,
}

/// Why an attribute does not fit a mesh, or itself.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum AttributeError {
    /// No components, too many, or names of several.
    #[error("entries of {num_components} components")]
    Components {
        /// How many there are.
        num_components: usize,
    },
    /// The last entry is incomplete.
    #[error("{num_values} values are no whole number of entries of {num_components}")]
    Ragged {
        /// Values in the table.
        num_values: usize,
        /// Values of an entry.
        num_components: usize,
    },
    /// There is not one entry, or index, for each element.
    #[error("{found} entries or indices for {expected} {domain}")]
    Count {
        /// What should have one each.
        domain: Domain,
        /// How many of these the mesh has.
        expected: usize,
        /// How many entries or indices there are.
        found: usize,
    },
    /// An index names an entry that does not exist.
    #[error("element {element} has entry {index}, but there are {num_entries}")]
    IndexOutOfRange {
        /// Zero-based element.
        element: usize,
        /// The index it holds.
        index: u32,
        /// Entries of the table.
        num_entries: usize,
    },
}

impl Attribute {
    /// An attribute whose element k has entry k, not normalised. Not validated.
    pub fn new(
        name: impl Into<String>,
        semantic: Semantic,
        domain: Domain,
        num_components: usize,
        values: Values,
    ) -> Self {
        Self {
            name: name.into(),
            semantic,
            domain,
            num_components,
            is_normalized: false,
            values,
            indices: None,
        }
    }

    /// Entries of the table.
    pub fn num_entries(&self) -> usize {
        self.values.len() / self.num_components.max(1)
    }

    /// The entry of an element, `None` if it has none.
    pub fn entry(&self, element: usize) -> Option<usize> {
        match &self.indices {
            None => Some(element).filter(|&entry| entry < self.num_entries()),
            Some(indices) => {
                indices.get(element).filter(|&&entry| entry != NO_ENTRY).map(|&entry| entry as usize)
            }
        }
    }

    /// The entry at a corner of a triangle of `mesh`, whatever the domain.
    pub fn entry_at_corner(&self, mesh: &TriMesh, triangle: usize, corner: usize) -> Option<usize> {
        match self.domain {
            Domain::Vertex => self.entry(*mesh.triangles().get(triangle)?.get(corner)? as usize),
            Domain::Corner => self.entry(3 * triangle + corner),
            Domain::Triangle => self.entry(triangle),
        }
    }

    /// Component `k` of an entry as a number: a fraction if the attribute is normalised. `None` for names and
    /// beyond the end.
    pub fn number(&self, entry: usize, k: usize) -> Option<f64> {
        let value = self.values.number(entry * self.num_components + k)?;
        let one = self.values.component_type()?.one();
        // The most negative integer stands for -1 as well.
        Some(if self.is_normalized { (value / one).max(-1.0) } else { value })
    }

    /// The same attribute on the vertices, if all corners at each vertex have equal values: an attribute of
    /// corners without a seam. `None` otherwise, and for other domains.
    pub fn without_seams(&self, mesh: &TriMesh) -> Option<Self> {
        if self.domain != Domain::Corner {
            return None;
        }
        let mut entries = vec![None; mesh.num_vertices()];
        for (t, triangle) in mesh.triangles().iter().enumerate() {
            for (c, &vertex) in triangle.iter().enumerate() {
                let entry = self.entry(3 * t + c);
                match entries[vertex as usize] {
                    None => entries[vertex as usize] = Some(entry),
                    Some(first) if first == entry || self.entries_are_equal(first?, entry?) => {}
                    Some(_) => return None,
                }
            }
        }
        let index = |entry: Option<Option<usize>>| entry.flatten().map_or(NO_ENTRY, |entry| entry as u32);
        let indices = Some(entries.into_iter().map(index).collect());
        Some(Self { domain: Domain::Vertex, indices, ..self.clone() })
    }

    fn entries_are_equal(&self, a: usize, b: usize) -> bool {
        let n = self.num_components;
        match &self.values {
            Values::Names(names) => names.get(a) == names.get(b),
            values => (0..n).all(|k| values.bits(a * n + k) == values.bits(b * n + k)),
        }
    }

    /// Checks that the table is whole and every element of `mesh` has an entry of it or none.
    ///
    /// # Errors
    /// The first of these rules that is broken, in the order of the variants of [`AttributeError`].
    pub fn validate(&self, mesh: &TriMesh) -> Result<(), AttributeError> {
        let (num_values, num_components) = (self.values.len(), self.num_components);
        let most = if self.values.names().is_some() { 1 } else { MAX_COMPONENTS };
        if num_components == 0 || num_components > most {
            return Err(AttributeError::Components { num_components });
        }
        if !num_values.is_multiple_of(num_components) {
            return Err(AttributeError::Ragged { num_values, num_components });
        }
        let num_entries = self.num_entries();
        let (domain, expected) = (self.domain, self.domain.num_elements(mesh));
        let found = self.indices.as_ref().map_or(num_entries, Vec::len);
        if found != expected {
            return Err(AttributeError::Count { domain, expected, found });
        }
        let indices = self.indices.as_deref().unwrap_or_default();
        let is_bad = |&index: &u32| index != NO_ENTRY && index as usize >= num_entries;
        match indices.iter().position(is_bad) {
            Some(element) => {
                Err(AttributeError::IndexOutOfRange { element, index: indices[element], num_entries })
            }
            None => Ok(()),
        }
    }
}

/// All attributes of a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Attributes {
    /// In the order of the file.
    pub list: Vec<Attribute>,
    /// What OBJ's `mtllib` statements name, each as it was written: files of materials. All meshes of a scene share
    /// them.
    pub material_libraries: Arc<[String]>,
    /// How the materials of a glTF file look.
    pub gltf_materials: Option<GltfMaterials>,
    /// What else is known of the whole, as pairs of a key and a text: `crs.wkt` and the like of LAS, the coordinate
    /// reference system. Keys are unique. Carried, not looked into; all meshes of a scene share it.
    pub metadata: Arc<[(String, String)]>,
    /// If the mesh is several meshes of a scene, where they stand.
    pub scene: Option<SceneTable>,
}

/// The materials of a glTF file, identified by their names, with all that they refer to. Carried, not looked
/// into.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct GltfMaterials {
    /// An object of the lists `materials`, `textures`, `images`, `samplers`, `extensionsUsed` and
    /// `extensionsRequired`, as in glTF, but that `bufferView` of an image is an index into `images` here.
    pub json: String,
    /// The bytes of images that are in no file of their own.
    pub images: Vec<Vec<u8>>,
}

impl Attributes {
    /// The first attribute with this meaning.
    pub fn find(&self, semantic: Semantic) -> Option<&Attribute> {
        self.list.iter().find(|attribute| attribute.semantic == semantic)
    }

    /// Whether there is nothing at all.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two_triangles() -> TriMesh {
        let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        TriMesh::new(square.to_vec(), vec![[0, 1, 2], [0, 2, 3]]).unwrap()
    }

    fn uv(indices: &[u32]) -> Attribute {
        let values = Values::F32(vec![0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 1.0, 1.0]);
        let indices = Some(indices.to_vec());
        Attribute { indices, ..Attribute::new("vt", Semantic::TexCoord(0), Domain::Corner, 2, values) }
    }

    #[test]
    fn each_broken_rule_has_its_error() {
        let mesh = two_triangles();
        let good = uv(&[0, 1, 2, 0, 2, NO_ENTRY]);
        assert_eq!(good.validate(&mesh), Ok(()));
        let components = |n| Attribute { num_components: n, ..good.clone() }.validate(&mesh);
        assert_eq!(components(0), Err(AttributeError::Components { num_components: 0 }));
        assert_eq!(components(17), Err(AttributeError::Components { num_components: 17 }));
        assert_eq!(components(3), Err(AttributeError::Ragged { num_values: 8, num_components: 3 }));
        let names = Attribute { values: Values::Names(vec!["a".into(); 2]), ..good.clone() };
        assert_eq!(names.validate(&mesh), Err(AttributeError::Components { num_components: 2 }));
        let count = |domain, expected, found| Err(AttributeError::Count { domain, expected, found });
        assert_eq!(uv(&[0; 5]).validate(&mesh), count(Domain::Corner, 6, 5));
        let own_entries = |domain| Attribute { domain, indices: None, ..good.clone() }.validate(&mesh);
        assert_eq!(own_entries(Domain::Triangle), count(Domain::Triangle, 2, 4));
        assert_eq!(own_entries(Domain::Vertex), Ok(()));
        let beyond = AttributeError::IndexOutOfRange { element: 4, index: 4, num_entries: 4 };
        assert_eq!(uv(&[0, 1, 2, 3, 4, 5]).validate(&mesh), Err(beyond));
    }

    #[test]
    fn entries_are_found_in_every_domain() {
        let mesh = two_triangles();
        let corner = uv(&[0, 1, 2, 3, NO_ENTRY, 2]);
        assert_eq!([0, 1, 2].map(|c| corner.entry_at_corner(&mesh, 1, c)), [Some(3), None, Some(2)]);
        let vertex = Attribute { domain: Domain::Vertex, indices: None, ..corner.clone() };
        assert_eq!([0, 1, 2].map(|c| vertex.entry_at_corner(&mesh, 1, c)), [Some(0), Some(2), Some(3)]);
        let face = Attribute { domain: Domain::Triangle, indices: Some(vec![1, 2]), ..corner };
        assert_eq!([0, 1, 2].map(|c| face.entry_at_corner(&mesh, 1, c)), [Some(2); 3]);
        assert_eq!((face.entry(2), face.entry_at_corner(&mesh, 2, 0)), (None, None));
    }

    #[test]
    fn corners_without_seam_are_attributes_of_vertices() {
        let mesh = two_triangles();
        // Entries 2 and 3 are equal, entries 0 and 1 are not.
        let vertex = uv(&[0, 1, 2, 0, 3, 1]).without_seams(&mesh).unwrap();
        assert_eq!(vertex.validate(&mesh), Ok(()));
        assert_eq!(vertex.indices, Some(vec![0, 1, 2, 1]));
        assert_eq!(uv(&[0, 1, 2, 1, 2, 1]).without_seams(&mesh), None);
        assert_eq!(uv(&[0, 1, 2, NO_ENTRY, 2, 1]).without_seams(&mesh), None);
        assert_eq!(vertex.without_seams(&mesh), None);
    }

    #[test]
    fn normalised_integers_are_fractions() {
        let values = Values::I8(vec![-128, -127, 0, 127]);
        let raw = Attribute::new("n", Semantic::Generic, Domain::Vertex, 1, values);
        let fraction = Attribute { is_normalized: true, ..raw.clone() };
        assert_eq!([0, 1, 2, 3].map(|entry| raw.number(entry, 0)), [-128.0, -127.0, 0.0, 127.0].map(Some));
        assert_eq!([0, 1, 2, 3].map(|entry| fraction.number(entry, 0)), [-1.0, -1.0, 0.0, 1.0].map(Some));
    }
}
