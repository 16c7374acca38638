//! One mesh of all meshes of a scene.

use super::{Scene, unify::Layouts};
use crate::{
    io::{MeshFile, ReadError, builder::MeshBuilder},
    mesh::{Attribute, Domain, IDENTITY, Instance, NO_ENTRY, Semantic, TriMesh, Values},
};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// Vertices and triangles of all instances for each byte of the file, and in any file: a thousand trees are
/// one tree in the file, a billion are an attack.
const MAX_ELEMENTS_PER_BYTE: usize = 16;
const MIN_MAX_ELEMENTS: usize = 1 << 20;

/// Keys of the metadata of all meshes.
const MAX_KEYS: usize = 64;

impl Scene {
    /// One mesh of all instances in their places. If there are several, each triangle says which it belongs
    /// to, as attribute `node`. Normals turn with their surface; a mirrored instance keeps its outside.
    ///
    /// A single mesh that is where its coordinates say stays as it is, bit for bit.
    ///
    /// # Errors
    /// If that is more than 32-bit indices can name, out of proportion to the file, or too far away for a
    /// float64.
    pub fn merge(mut self) -> Result<MeshFile, ReadError> {
        if self.is_single() {
            let mut file = self.meshes.remove(0);
            file.report.add(&self.report);
            file.attributes.gltf_materials = self.gltf_materials;
            return Ok(file);
        }
        self.check_size()?;
        let mut merger = Merger::new(&self);
        let layouts = Layouts::of(&self);
        let is_moved = self.instances.iter().any(|instance| instance.transform != IDENTITY);
        let layouts = if is_moved { layouts.turning() } else { layouts };
        let mut is_used = vec![false; self.meshes.len()];
        for instance in &self.instances {
            let motion = match instance.transform {
                IDENTITY => Motion::Scaling(1.0),
                transform => Motion::Affine(transform),
            };
            merger.add(&layouts.convert(&self.meshes[instance.mesh]), &instance.name, motion)?;
            is_used[instance.mesh] = true;
        }
        if is_used.contains(&false) {
            merger.builder.report.ignore("meshes outside the scene");
        }
        if self.instances.len() > 1 {
            let names = self.instances.iter().map(|instance| instance.name.clone()).collect();
            let numbers = self.instances.iter().map(|instance| self.num_triangles(instance.mesh));
            merger.add_numbers("node", Values::Names(names), numbers);
        }
        merger.finish()
    }

    pub(super) fn num_triangles(&self, mesh: usize) -> usize {
        self.meshes[mesh].mesh.num_triangles()
    }

    fn check_size(&self) -> Result<(), ReadError> {
        let elements = |instance: &Instance| {
            let file = &self.meshes[instance.mesh];
            // Every attribute may need an index at each corner.
            let per_triangle = 1 + 3 * (1 + file.attributes.list.len());
            let in_tables: usize = file.attributes.list.iter().map(|attribute| attribute.values.len()).sum();
            file.mesh.num_vertices() + per_triangle * file.mesh.num_triangles() + in_tables
        };
        let total = self.instances.iter().fold(0usize, |sum, i| sum.saturating_add(elements(i)));
        if total <= self.num_bytes.saturating_mul(MAX_ELEMENTS_PER_BYTE).max(MIN_MAX_ELEMENTS) {
            return Ok(());
        }
        let message = format!("{} instances out of proportion to the file", self.instances.len());
        Err(ReadError::TooLarge { message })
    }
}

/// How a mesh comes to its place.
#[derive(Clone, Copy)]
pub(super) enum Motion {
    /// Exact for powers of two. Directions stay.
    Scaling(f64),
    Affine([[f64; 4]; 3]),
}

impl Motion {
    fn moved(&self, p: [f64; 3]) -> [f64; 3] {
        match self {
            Self::Scaling(factor) => p.map(|c| c * factor),
            Self::Affine(rows) => rows.map(|[a, b, c, d]| a * p[0] + b * p[1] + c * p[2] + d),
        }
    }
}

/// All meshes so far.
pub(super) struct Merger {
    builder: MeshBuilder,
    columns: Vec<Column>,
    /// Each once, in order of appearance.
    libraries: IndexedNames,
    /// Of several texts for a key the first.
    metadata: Vec<(String, String)>,
}

/// Names, each once.
#[derive(Default)]
struct IndexedNames {
    list: Vec<String>,
    known: HashSet<String>,
    /// What was added last: all meshes of a stream share it.
    last: Arc<[String]>,
}

impl IndexedNames {
    fn add(&mut self, names: &Arc<[String]>) {
        if !Arc::ptr_eq(&self.last, names) {
            self.last = names.clone();
            self.list.extend(names.iter().filter(|&name| self.known.insert(name.clone())).cloned());
        }
    }
}

/// An attribute of all instances, by corners or triangles: an instance may have a seam where another has none.
struct Column {
    attribute: Attribute,
    rows: Vec<u32>,
    /// Vertices without triangles, and their rows.
    loose: Vec<(u32, u32)>,
    /// Of names, each of which is there once.
    row_of: HashMap<String, u32>,
}

impl Column {
    fn new(attribute: Attribute, rows: Vec<u32>) -> Self {
        Self { attribute, rows, loose: Vec::new(), row_of: HashMap::new() }
    }

    /// Adds a table; gives the row in this one that each of its rows is now.
    fn append(&mut self, other: &Attribute) -> Vec<u32> {
        let first = self.attribute.num_entries() as u32;
        let Values::Names(known) = &mut self.attribute.values else {
            self.attribute.values.append(other.values.clone());
            return (0..other.num_entries() as u32).map(|row| first + row).collect();
        };
        let mut row = |name: &String| {
            *self.row_of.entry(name.clone()).or_insert_with(|| {
                known.push(name.clone());
                known.len() as u32 - 1
            })
        };
        other.values.names().unwrap_or_default().iter().map(&mut row).collect()
    }
}

impl Merger {
    pub(super) fn new(scene: &Scene) -> Self {
        let mut builder = MeshBuilder::for_file(scene.num_bytes);
        builder.report = scene.report.clone();
        builder.attributes.gltf_materials.clone_from(&scene.gltf_materials);
        Self { builder, columns: Vec::new(), libraries: IndexedNames::default(), metadata: Vec::new() }
    }

    /// Adds a mesh; `name` is for errors.
    pub(super) fn add(&mut self, file: &MeshFile, name: &str, motion: Motion) -> Result<(), ReadError> {
        let MeshFile { mesh, attributes, report } = file;
        self.libraries.add(&attributes.material_libraries);
        self.add_metadata(&attributes.metadata);
        let builder = &mut self.builder;
        builder.report.add(report);
        let is_mirrored = matches!(motion, Motion::Affine(transform) if determinant(&transform) < 0.0);
        let first_vertex = u32::try_from(builder.positions.len()).unwrap_or(NO_ENTRY);
        let num_before = builder.triangles.len();
        builder.positions.extend(mesh.positions().iter().map(|&p| motion.moved(p)));
        if builder.positions.len() >= NO_ENTRY as usize {
            return Err(ReadError::TooLarge { message: format!("{} vertices", builder.positions.len()) });
        }
        if builder.positions[first_vertex as usize..].iter().flatten().any(|c| !c.is_finite()) {
            return Err(ReadError::TooLarge { message: format!("coordinates of node `{name}`") });
        }
        let corners = if is_mirrored { [0, 2, 1] } else { [0, 1, 2] };
        let triangle = |t: &[u32; 3]| corners.map(|corner| first_vertex + t[corner]);
        builder.triangles.extend(mesh.triangles().iter().map(triangle));

        let place = Place { first_vertex, num_before, corners, loose: loose_vertices(mesh) };
        for attribute in &attributes.list {
            let turned;
            let attribute = match motion {
                Motion::Affine(transform) if is_translation(&transform) => attribute,
                Motion::Affine(transform) if attribute.semantic == Semantic::Normal => {
                    turned = turned_normals(attribute, &transform);
                    &turned
                }
                Motion::Affine(_) if attribute.name == "TANGENT" => {
                    self.builder.report.ignore(&attribute.name);
                    continue;
                }
                _ => attribute,
            };
            self.add_attribute(mesh, attribute, &place)?;
        }
        Ok(())
    }

    /// A file has few keys; what the meshes of a stream have is the same.
    fn add_metadata(&mut self, metadata: &[(String, String)]) {
        for (key, text) in metadata.iter().take(MAX_KEYS) {
            match self.metadata.iter().find(|(known, _)| known == key) {
                None if self.metadata.len() < MAX_KEYS => self.metadata.push((key.clone(), text.clone())),
                Some((_, known)) if known == text => {}
                _ => self.builder.report.ignore(&format!("another {key}")),
            }
        }
    }

    fn add_attribute(
        &mut self,
        mesh: &TriMesh,
        attribute: &Attribute,
        place: &Place,
    ) -> Result<(), ReadError> {
        let domain = if attribute.domain == Domain::Triangle { Domain::Triangle } else { Domain::Corner };
        let is_like = |column: &Column| {
            let known = &column.attribute;
            known.name == attribute.name
                && known.semantic == attribute.semantic
                && known.domain == domain
                && known.num_components == attribute.num_components
                && known.is_normalized == attribute.is_normalized
                && known.values.component_type() == attribute.values.component_type()
        };
        let known = self.columns.iter().position(is_like).unwrap_or_else(|| {
            let empty = attribute.values.emptied();
            let attribute = Attribute { domain, values: empty, indices: None, ..attribute.clone() };
            self.columns.push(Column::new(attribute, Vec::new()));
            self.columns.len() - 1
        });
        let num_elements = self.builder.positions.len().max(3 * self.builder.triangles.len());
        self.builder.check_rows(self.columns.len(), num_elements)?;
        let column = &mut self.columns[known];
        let num_rows = column.attribute.num_entries() + attribute.num_entries();
        if num_rows >= NO_ENTRY as usize {
            return Err(ReadError::TooLarge { message: format!("{num_rows} values") });
        }
        let row_of = column.append(attribute);
        let rows = &mut column.rows;
        let per_triangle = if domain == Domain::Triangle { 1 } else { 3 };
        rows.resize(per_triangle * place.num_before, NO_ENTRY);
        for t in 0..mesh.num_triangles() {
            rows.extend(place.corners[..per_triangle].iter().map(|&corner| {
                let row = attribute.entry_at_corner(mesh, t, corner);
                row.map_or(NO_ENTRY, |row| row_of[row])
            }));
        }
        if attribute.domain == Domain::Vertex {
            let row = |&vertex: &u32| {
                Some((place.first_vertex + vertex, row_of[attribute.entry(vertex as usize)?]))
            };
            column.loose.extend(place.loose.iter().filter_map(row));
        }
        Ok(())
    }

    /// Adds an attribute that says of each triangle which of the meshes it is of, given how many each has.
    pub(super) fn add_numbers(
        &mut self,
        name: &str,
        table: Values,
        num_triangles: impl Iterator<Item = usize>,
    ) {
        let rows = num_triangles.zip(0..).flat_map(|(count, row)| std::iter::repeat_n(row, count)).collect();
        let attribute = Attribute::new(name, Semantic::Object, Domain::Triangle, 1, table);
        self.columns.push(Column::new(attribute, rows));
    }

    pub(super) fn finish(mut self) -> Result<MeshFile, ReadError> {
        let mut loose = Vec::with_capacity(self.columns.len());
        for Column { attribute, rows, loose: of_column, .. } in self.columns {
            loose.push(of_column);
            self.builder.attributes.list.push(Attribute { indices: Some(rows), ..attribute });
        }
        self.builder.attributes.metadata = self.metadata.into();
        self.builder.attributes.material_libraries = self.libraries.list.into();
        let mut file = self.builder.finish()?;
        // Where no instance has a seam, corners are more than is needed.
        for (attribute, loose) in file.attributes.list.iter_mut().zip(loose) {
            if let Some(smooth) = attribute.without_seams(&file.mesh) {
                *attribute = smooth;
                // Vertices have rows of their own then.
                let indices = attribute.indices.get_or_insert_default();
                loose.iter().for_each(|&(vertex, row)| indices[vertex as usize] = row);
            } else if !loose.is_empty() {
                file.report.ignore(&format!("{} of isolated vertices", attribute.name));
            }
        }
        Ok(file)
    }
}

/// Where a mesh is among all.
struct Place {
    first_vertex: u32,
    /// Triangles before it.
    num_before: usize,
    /// Corner k of a triangle is corner `corners[k]` of the triangle before.
    corners: [usize; 3],
    /// Vertices of the mesh without triangles: values at corners do not reach them.
    loose: Vec<u32>,
}

fn loose_vertices(mesh: &TriMesh) -> Vec<u32> {
    let mut is_loose = vec![true; mesh.num_vertices()];
    mesh.triangles().as_flattened().iter().for_each(|&vertex| is_loose[vertex as usize] = false);
    (0..mesh.num_vertices() as u32).filter(|&vertex| is_loose[vertex as usize]).collect()
}

/// Directions stay as they are then, bit for bit.
fn is_translation(transform: &[[f64; 4]; 3]) -> bool {
    transform.iter().zip(&IDENTITY).all(|(row, identity)| row[..3] == identity[..3])
}

fn determinant([[a, b, c, _], [d, e, f, _], [g, h, i, _]]: &[[f64; 4]; 3]) -> f64 {
    a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
}

/// Normals as float32, turned by the transpose of the inverse: its rows, except for their length, are the
/// cross products of those of the matrix.
fn turned_normals(attribute: &Attribute, transform: &[[f64; 4]; 3]) -> Attribute {
    let cross = |u: &[f64; 4], v: &[f64; 4]| {
        [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
    };
    let [x, y, z] = transform;
    let sign = determinant(transform).signum();
    let rows = [cross(y, z), cross(z, x), cross(x, y)].map(|row| row.map(|entry| sign * entry));
    let mut values = Vec::with_capacity(attribute.values.len());
    for row in 0..attribute.num_entries() {
        let normal = [0, 1, 2].map(|k| attribute.number(row, k).unwrap_or(0.0));
        let turned = rows.map(|[a, b, c]| a * normal[0] + b * normal[1] + c * normal[2]);
        let length = turned.iter().map(|c| c * c).sum::<f64>().sqrt();
        let scale = if length > 0.0 && length.is_finite() { 1.0 / length } else { 1.0 };
        values.extend(turned.map(|c| (c * scale) as f32));
    }
    Attribute { values: Values::F32(values), is_normalized: false, ..attribute.clone() }
}
