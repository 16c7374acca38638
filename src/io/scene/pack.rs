//! A scene as one mesh, and back: what a stream holds.

use super::{Scene, merge::Merger, merge::Motion, unify::Layouts};
use crate::{
    io::{MeshFile, ReadError, ReadReport},
    mesh::{Attribute, Attributes, Domain, NO_ENTRY, SceneTable, TriMesh, Values},
};
use std::collections::HashMap;

/// The attribute that says of which mesh of a scene a triangle is.
pub const SCENE_MESH: &str = "scene mesh";

impl Scene {
    /// One mesh of all meshes, each once and in its own coordinates times a power of two: about as large as its
    /// largest instance is in the scene, so that one grid does for all. [`SCENE_MESH`] says which is which.
    ///
    /// # Errors
    /// As [`Scene::merge`].
    pub fn pack(&self) -> Result<MeshFile, ReadError> {
        let exponents: Vec<i8> = (0..self.meshes.len()).map(|mesh| self.exponent(mesh)).collect();
        let mut merger = Merger::new(self);
        let layouts = Layouts::of(self);
        for (mesh, (file, &exponent)) in self.meshes.iter().zip(&exponents).enumerate() {
            let name = || self.instances.iter().find(|i| i.mesh == mesh).map(|i| i.name.as_str());
            let file = layouts.convert(file);
            merger.add(&file, name().unwrap_or_default(), Motion::Scaling(power_of_two(exponent)))?;
        }
        if self.meshes.len() > 1 {
            let numbers = Values::U32((0..self.meshes.len() as u32).collect());
            merger.add_numbers(SCENE_MESH, numbers, (0..self.meshes.len()).map(|m| self.num_triangles(m)));
        }
        let mut file = merger.finish()?;
        file.attributes.scene = Some(SceneTable { exponents, instances: self.instances.clone() });
        Ok(file)
    }

    /// The power of two closest to how much larger a mesh is in the scene than in its own coordinates.
    fn exponent(&self, mesh: usize) -> i8 {
        let places = self.instances.iter().filter(|instance| instance.mesh == mesh);
        let scale = |[x, y, z]: [[f64; 4]; 3]| {
            let squares = [x, y, z].map(|row| row[..3].iter().map(|e| e * e).sum::<f64>());
            (squares.iter().sum::<f64>() / 3.0).sqrt()
        };
        let largest = places.map(|instance| scale(instance.transform)).fold(0.0, f64::max);
        // A mesh that is nowhere is as large as it is.
        let scale = if largest > 0.0 && largest.is_finite() { largest } else { 1.0 };
        libm::log2(scale).round().clamp(-100.0, 100.0) as i8
    }

    /// The scene that a mesh packed by [`Scene::pack`] is, at any level; `None` if it is not such a mesh.
    ///
    /// Vertices come in the order of the packed mesh. Nothing says of which mesh a vertex without triangles is: it goes to
    /// that of the last vertex before it that has some, or else to the first.
    ///
    /// # Errors
    /// If the meshes repeat names out of proportion to how often the stream has them.
    pub fn unpack(mesh: &TriMesh, attributes: &Attributes) -> Result<Option<Self>, ReadError> {
        let Some(table) = &attributes.scene else { return Ok(None) };
        let which = attributes.list.iter().position(is_scene_mesh);
        let number = |t: usize| {
            let attribute = &attributes.list[which?];
            attribute.number(attribute.entry(t)?, 0)
        };
        let parts = parts(mesh, table.exponents.len(), |t| number(t).map_or(0, |number| number as usize));
        let listed = attributes.list.iter().enumerate().filter(|&(k, _)| Some(k) != which);
        let listed: Vec<&Attribute> = listed.map(|(_, attribute)| attribute).collect();
        // Meshes and instances may repeat what the stream has once, but not beyond reason.
        let num_bytes = size_of::<[f64; 6]>() * mesh.num_vertices();
        let mut names = NameBytes::of(&listed, num_bytes);
        let mut local = vec![NO_ENTRY; mesh.num_vertices()];
        let mut meshes = Vec::with_capacity(parts.len());
        for (part, &exponent) in parts.iter().zip(&table.exponents) {
            let mut file =
                part.extract(mesh, &mut local, &listed, power_of_two(exponent).recip(), &mut names)?;
            file.attributes.material_libraries = attributes.material_libraries.clone();
            file.attributes.metadata = attributes.metadata.clone();
            meshes.push(file);
        }
        Ok(Some(Self {
            meshes,
            instances: table.instances.clone(),
            gltf_materials: attributes.gltf_materials.clone(),
            report: ReadReport::default(),
            scales: table.exponents.iter().map(|&exponent| power_of_two(exponent).recip()).collect(),
            num_bytes,
        }))
    }
}

/// Bytes of names that meshes may still copy from the tables they share.
struct NameBytes {
    left: usize,
}

/// Bytes of names in all meshes for each byte that the stream has, and in any scene.
const MAX_NAME_COPIES: usize = 16;
const MIN_MAX_NAME_BYTES: usize = 1 << 20;

impl NameBytes {
    fn of(attributes: &[&Attribute], num_bytes: usize) -> Self {
        let names = attributes.iter().flat_map(|attribute| attribute.values.names().unwrap_or_default());
        let in_tables: usize = names.map(String::len).sum();
        Self { left: ((num_bytes + in_tables).saturating_mul(MAX_NAME_COPIES)).max(MIN_MAX_NAME_BYTES) }
    }

    fn take(&mut self, attribute: &Attribute) -> Result<(), ReadError> {
        let copied: usize = attribute.values.names().unwrap_or_default().iter().map(String::len).sum();
        let message = || format!("names of `{}` repeated in many meshes", attribute.name);
        self.left =
            self.left.checked_sub(copied).ok_or_else(|| ReadError::TooLarge { message: message() })?;
        Ok(())
    }
}

fn is_scene_mesh(attribute: &Attribute) -> bool {
    attribute.name == SCENE_MESH && attribute.domain == Domain::Triangle && attribute.values.names().is_none()
}

fn power_of_two(exponent: i8) -> f64 {
    2f64.powi(i32::from(exponent))
}

/// What is of one mesh, in the order of the packed mesh.
#[derive(Clone, Default)]
struct Part {
    vertices: Vec<u32>,
    triangles: Vec<usize>,
}

/// The meshes, given which of them each triangle is of. Triangles of others are of none.
fn parts(mesh: &TriMesh, num_parts: usize, part_of: impl Fn(usize) -> usize) -> Vec<Part> {
    let mut parts = vec![Part::default(); num_parts];
    // Of each vertex the mesh of its last triangle.
    let mut owners = vec![None; mesh.num_vertices()];
    for (t, triangle) in mesh.triangles().iter().enumerate() {
        let owner = part_of(t);
        triangle.iter().for_each(|&vertex| owners[vertex as usize] = Some(owner));
        if let Some(part) = parts.get_mut(owner) {
            part.triangles.push(t);
            part.vertices.extend(triangle);
        }
    }
    let mut last = 0;
    for (vertex, owner) in owners.into_iter().enumerate() {
        match (owner, parts.get_mut(last.min(num_parts.saturating_sub(1)))) {
            (Some(owner), _) => last = owner,
            (None, Some(part)) => part.vertices.push(vertex as u32),
            (None, None) => {}
        }
    }
    for part in &mut parts {
        part.vertices.sort_unstable();
        part.vertices.dedup();
    }
    parts
}

impl Part {
    /// `local` has room for a number of each vertex of the packed mesh; what is in it does not matter.
    fn extract(
        &self,
        mesh: &TriMesh,
        local: &mut [u32],
        attributes: &[&Attribute],
        factor: f64,
        names: &mut NameBytes,
    ) -> Result<MeshFile, ReadError> {
        let vertices = &self.vertices;
        vertices.iter().zip(0..).for_each(|(&vertex, number)| local[vertex as usize] = number);
        let triangle = |&t: &usize| mesh.triangles()[t].map(|vertex| local[vertex as usize]);
        let triangles = self.triangles.iter().map(triangle).collect();
        let positions = vertices.iter().map(|&v| mesh.positions()[v as usize].map(|c| c * factor)).collect();
        let mut file =
            MeshFile { mesh: TriMesh::from_valid_parts(positions, triangles), ..MeshFile::default() };
        let corners = |&t: &usize| [3 * t, 3 * t + 1, 3 * t + 2];
        for attribute in attributes {
            let part = match attribute.domain {
                Domain::Vertex => selected(attribute, vertices.iter().map(|&v| v as usize)),
                Domain::Corner => selected(attribute, self.triangles.iter().flat_map(corners)),
                Domain::Triangle => selected(attribute, self.triangles.iter().copied()),
            };
            part.iter().try_for_each(|part| names.take(part))?;
            file.attributes.list.extend(part);
        }
        // What has no seam in this mesh may have one in another.
        for attribute in &mut file.attributes.list {
            if let Some(smooth) = attribute.without_seams(&file.mesh) {
                *attribute = smooth;
            }
        }
        Ok(file)
    }
}

/// The attribute on some elements, with the rows that these have; `None` if they have none.
fn selected(attribute: &Attribute, elements: impl Iterator<Item = usize>) -> Option<Attribute> {
    let n = attribute.num_components;
    let mut values = attribute.values.emptied();
    let mut row_of: HashMap<usize, u32> = HashMap::new();
    let mut copy = |row: usize| {
        let next = row_of.len() as u32;
        *row_of.entry(row).or_insert_with(|| {
            match (&mut values, &attribute.values) {
                (Values::Names(to), Values::Names(from)) => to.push(from[row].clone()),
                (to, from) => (row * n..(row + 1) * n).for_each(|k| to.push_bits(from.bits(k).unwrap_or(0))),
            }
            next
        })
    };
    let rows: Vec<u32> =
        elements.map(|element| attribute.entry(element).map_or(NO_ENTRY, &mut copy)).collect();
    let is_plain = rows.iter().zip(0..).all(|(&row, k)| row == k) && rows.len() == row_of.len();
    let indices = if is_plain { None } else { Some(rows) };
    (!row_of.is_empty()).then(|| Attribute { values, indices, ..attribute.clone() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{IDENTITY, Instance, Semantic};

    fn triangle(at: f64) -> TriMesh {
        TriMesh::new(vec![[at, 0.0, -0.0], [at + 1.0, 0.0, 0.0], [at, 1.0, 0.1]], vec![[0, 1, 2]]).unwrap()
    }

    fn scene() -> Scene {
        let vertex = |name: &str, values| Attribute::new(name, Semantic::Generic, Domain::Vertex, 1, values);
        let mut first = MeshFile { mesh: triangle(0.0), ..MeshFile::default() };
        first.attributes.list = vec![vertex("heat", Values::F32(vec![0.5, -0.0, f32::NAN]))];
        let mut second = MeshFile { mesh: triangle(5.0), ..MeshFile::default() };
        let wood = Values::Names(vec!["wood".into()]);
        second.attributes.list = vec![Attribute::new("m", Semantic::Material, Domain::Triangle, 1, wood)];
        let mut scene = Scene { meshes: vec![first, second], ..Scene::default() };
        let scaled = IDENTITY.map(|row| row.map(|e| 9.0 * e));
        scene.instances = vec![
            Instance { mesh: 1, name: "small".into(), transform: IDENTITY },
            Instance { mesh: 1, name: "large".into(), transform: scaled },
        ];
        scene
    }

    #[test]
    fn scenes_come_back_bit_for_bit() {
        let scene = scene();
        let file = scene.pack().unwrap();
        assert_eq!(file.attributes.scene.as_ref().unwrap().exponents, [0, 3]);
        assert_eq!(file.mesh.positions()[3], [40.0, 0.0, 0.0]);
        let again = Scene::unpack(&file.mesh, &file.attributes).unwrap().unwrap();
        assert_eq!((&again.meshes, &again.instances), (&scene.meshes, &scene.instances));
        let zero = again.meshes[1].mesh.positions()[0][2];
        assert!(zero == 0.0 && zero.is_sign_negative());
    }

    /// A mesh for each of many triangles, all with one long name and many libraries.
    #[test]
    fn what_meshes_share_is_not_copied_into_each() {
        let count = 2000;
        let (mut positions, mut triangles) = (Vec::new(), Vec::new());
        for i in 0..count {
            positions.extend_from_slice(triangle(f64::from(i)).positions());
            triangles.push([0, 1, 2].map(|k| 3 * i + k));
        }
        let mesh = TriMesh::new(positions, triangles).unwrap();
        let on_faces = |name: &str, values, indices| Attribute {
            indices: Some(indices),
            ..Attribute::new(name, Semantic::Material, Domain::Triangle, 1, values)
        };
        let with_name = |length: usize| Attributes {
            list: vec![
                on_faces(SCENE_MESH, Values::U32((0..count).collect()), (0..count).collect()),
                on_faces("m", Values::Names(vec!["x".repeat(length)]), vec![0; count as usize]),
            ],
            material_libraries: vec![String::new(); 2000].into(),
            scene: Some(SceneTable { exponents: vec![0; count as usize], instances: Vec::new() }),
            ..Attributes::default()
        };
        let attributes = with_name(100);
        let scene = Scene::unpack(&mesh, &attributes).unwrap().unwrap();
        let libraries = |file: &MeshFile| file.attributes.material_libraries.as_ptr();
        assert!(scene.meshes.iter().all(|file| libraries(file) == attributes.material_libraries.as_ptr()));
        assert!(Scene::unpack(&mesh, &with_name(100_000)).is_err());
    }

    #[test]
    fn a_table_that_knows_fewer_meshes_is_harmless() {
        let mut file = scene().pack().unwrap();
        let table = file.attributes.scene.as_mut().unwrap();
        table.exponents.truncate(1);
        table.instances.clear();
        let again = Scene::unpack(&file.mesh, &file.attributes).unwrap().unwrap();
        assert_eq!(again.meshes, scene().meshes[..1]);
    }
}
