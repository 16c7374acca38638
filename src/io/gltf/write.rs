//! Writing glTF 2.0: one primitive for each material of a mesh, one buffer.

use super::instances::Nodes;
use crate::{
    io::{Scene, WriteError, WriteReport, texture::oriented},
    mesh::{
        Attribute, Attributes, ComponentType, Domain, GltfMaterials, NO_ENTRY, Semantic, TriMesh, Values,
    },
};
use base64::Engine;
use serde_json::{Map, Value, json};
use std::{
    collections::{HashMap, HashSet},
    io::Write,
};

/// What holds document and buffer together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::io) enum Container {
    /// Binary, `.glb`.
    Glb,
    /// Text with the buffer inside, `.gltf`.
    Text,
}

const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// Writes `mesh` and those of its (valid) attributes that glTF can hold, and says which it cannot.
/// Coordinates are rounded to float32.
pub(in crate::io) fn write(
    out: &mut impl Write,
    mesh: &TriMesh,
    attributes: &Attributes,
    container: Container,
) -> Result<WriteReport, WriteError> {
    if mesh.num_triangles() == 0 {
        return Err(unrepresentable("glTF has no meshes without triangles".to_owned()));
    }
    let mut writer = Writer::default();
    writer.carry(attributes.gltf_materials.as_ref());
    writer.mesh(mesh, attributes)?;
    writer.finish(out, json!([{ "mesh": 0 }]), &[0], container)
}

/// Writes the meshes of a scene, those without triangles left out, each in its places.
pub(in crate::io) fn write_scene(
    out: &mut impl Write,
    scene: &Scene,
    container: Container,
) -> Result<WriteReport, WriteError> {
    let mut writer = Writer::default();
    writer.carry(scene.gltf_materials.as_ref());
    let mut written = vec![None; scene.meshes.len()];
    for (file, index) in scene.meshes.iter().zip(&mut written) {
        if file.mesh.num_triangles() > 0 {
            *index = Some(writer.mesh(&file.mesh, &file.attributes)?);
        }
    }
    if writer.meshes.is_empty() {
        return Err(unrepresentable("glTF has no meshes without triangles".to_owned()));
    }
    let mut nodes = Nodes::default();
    for instance in &scene.instances {
        if let Some(mesh) = written.get(instance.mesh).copied().flatten() {
            nodes.add(instance, mesh);
        }
    }
    let Nodes { list, roots } = nodes;
    writer.finish(out, list.into(), &roots, container)
}

fn unrepresentable(message: String) -> WriteError {
    WriteError::Unrepresentable { message }
}

/// An attribute as it is written.
struct Column<'a> {
    attribute: &'a Attribute,
    name: &'a str,
    gltf_name: String,
    /// The table in a type that glTF has.
    values: Values,
    is_normalized: bool,
}

/// Chooses names and types.
fn columns(attributes: &Attributes) -> (Vec<Column<'_>>, WriteReport) {
    let mut report = WriteReport::default();
    let mut columns: Vec<Column> = Vec::new();
    let mut num_sets = [0; 2];
    let has_normals = attributes.list.iter().any(|a| a.semantic == Semantic::Normal && a.num_components == 3);
    for attribute in &attributes.list {
        if first_material(attributes).is_some_and(|material| std::ptr::eq(attribute, material)) {
            continue;
        }
        let (n, is_normal) = (attribute.num_components, attribute.semantic == Semantic::Normal);
        let mut next_set = |k: usize, prefix: &str| {
            num_sets[k] += 1;
            format!("{prefix}_{}", num_sets[k] - 1)
        };
        let gltf_name = match attribute.semantic {
            _ if attribute.values.names().is_some() || attribute.domain == Domain::Triangle => None,
            Semantic::Normal if n == 3 => Some("NORMAL".to_owned()),
            Semantic::TexCoord(_) if n == 2 => Some(next_set(0, "TEXCOORD")),
            Semantic::Color(_) if n == 3 || n == 4 => Some(next_set(1, "COLOR")),
            _ if is_tangent(attribute) && has_normals => Some(TANGENT.to_owned()),
            // They mean something together with others that are not here.
            _ if is_dependent(&attribute.name) => None,
            _ if n <= 4 => Some(custom_name(&attribute.name)),
            _ => None,
        };
        let is_new = |name: &String| columns.iter().all(|column| column.gltf_name != *name);
        let written = match gltf_name.as_deref() {
            Some(TANGENT) => Some(unit_directions(attribute, [1.0, 0.0, 0.0])),
            _ if is_normal => Some(unit_directions(attribute, UP)),
            _ => representable(&oriented(attribute, true)),
        };
        match (gltf_name.filter(is_new), written) {
            (Some(gltf_name), Some(values)) if attribute.num_entries() > 0 => columns.push(Column {
                attribute,
                name: &attribute.name,
                gltf_name,
                // A type that changed is a float.
                is_normalized: attribute.is_normalized
                    && values.component_type().is_some_and(ComponentType::is_integer),
                values,
            }),
            _ => report.ignored.push(attribute.name.clone()),
        }
    }
    report.ignored.extend(attributes.material_libraries.first().map(|_| "mtllib".to_owned()));
    (columns, report)
}

fn first_material(attributes: &Attributes) -> Option<&Attribute> {
    let is_material = |a: &&Attribute| {
        a.semantic == Semantic::Material && a.domain == Domain::Triangle && a.values.names().is_some()
    };
    attributes.list.iter().find(is_material)
}

const TANGENT: &str = "TANGENT";
const UP: [f32; 3] = [0.0, 0.0, 1.0];

fn is_tangent(attribute: &Attribute) -> bool {
    attribute.name == TANGENT && attribute.num_components == 4
}

fn is_dependent(name: &str) -> bool {
    name == TANGENT || name.starts_with("JOINTS_") || name.starts_with("WEIGHTS_")
}

fn custom_name(name: &str) -> String {
    let clean = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_uppercase() } else { '_' };
    let name: String = name.chars().map(clean).collect();
    if name.starts_with('_') { name } else { format!("_{name}") }
}

/// The table as it is if glTF has such values there, else as float32; `None` if that would lose something
/// that is not only rounding, or is not finite.
fn representable(attribute: &Attribute) -> Option<Values> {
    let scalar = attribute.values.component_type()?;
    let is_free = !matches!(attribute.semantic, Semantic::TexCoord(_) | Semantic::Color(_));
    let is_kept = match scalar {
        ComponentType::U8 | ComponentType::U16 => is_free || attribute.is_normalized,
        ComponentType::I8 | ComponentType::I16 => is_free,
        _ => false,
    };
    if is_kept {
        return Some(attribute.values.clone());
    }
    let number = |k| attribute.number(k / attribute.num_components, k % attribute.num_components);
    let floats = (0..attribute.values.len()).map(|k| {
        let (number, float) = (number(k)?, number(k)? as f32);
        let is_exact = !scalar.is_integer() || attribute.is_normalized || f64::from(float) == number;
        Some(float).filter(|float| float.is_finite() && is_exact)
    });
    Some(Values::F32(floats.collect::<Option<Vec<f32>>>()?))
}

/// Directions of length 1, as glTF wants them, those that are nearly so as they are; what has no direction has the one
/// that is given. Those of tangents are followed by a sign.
fn unit_directions(attribute: &Attribute, other: [f32; 3]) -> Values {
    /// Lengths that rounding explains.
    const NEARLY: f64 = 1e-5;
    let unit = |row: usize| {
        let number = |k: usize| attribute.number(row, k).unwrap_or(0.0);
        let direction = [0, 1, 2].map(number);
        let length = direction.iter().map(|c| c * c).sum::<f64>().sqrt();
        let is_direction = length > 0.0 && length.is_finite();
        let length = if (length - 1.0).abs() < NEARLY { 1.0 } else { length };
        let unit = if is_direction { direction.map(|c| (c / length) as f32) } else { other };
        let sign = (attribute.num_components > 3).then(|| if number(3) < 0.0 { -1.0 } else { 1.0 });
        unit.into_iter().chain(sign)
    };
    Values::F32((0..attribute.num_entries()).flat_map(unit).collect())
}

/// Vertices as glTF has them: one for each combination of rows at a vertex.
struct Split {
    /// The vertex of the mesh that each is.
    sources: Vec<u32>,
    /// The rows of each, column by column.
    rows: Vec<u32>,
    triangles: Vec<[u32; 3]>,
}

impl Split {
    fn new(mesh: &TriMesh, columns: &[Column]) -> Result<Self, WriteError> {
        let mut split = Self { sources: Vec::new(), rows: Vec::new(), triangles: Vec::new() };
        let mut known: HashMap<Vec<u32>, u32> = HashMap::new();
        let mut is_used = vec![false; mesh.num_vertices()];
        let mut key = Vec::new();
        let mut place = |split: &mut Self, key: &Vec<u32>| {
            if let Some(&vertex) = known.get(key) {
                return vertex;
            }
            let vertex = split.sources.len() as u32;
            known.insert(key.clone(), vertex);
            split.sources.push(key[0]);
            split.rows.extend(&key[1..]);
            vertex
        };
        let has_corners = columns.iter().any(|column| column.attribute.domain == Domain::Corner);
        let row = |row: Option<usize>| row.map_or(NO_ENTRY, |row| row as u32);
        if !has_corners {
            split.sources = (0..mesh.num_vertices() as u32).collect();
            let rows = |v: &u32| {
                columns.iter().map(move |c| row(c.attribute.entry(*v as usize))).collect::<Vec<_>>()
            };
            split.rows = split.sources.iter().flat_map(rows).collect();
            split.triangles = mesh.triangles().to_vec();
            return Ok(split);
        }
        for (t, triangle) in mesh.triangles().iter().enumerate() {
            let mut corners = [0; 3];
            for (c, corner) in corners.iter_mut().enumerate() {
                key.clear();
                key.push(triangle[c]);
                key.extend(columns.iter().map(|column| row(column.attribute.entry_at_corner(mesh, t, c))));
                *corner = place(&mut split, &key);
                is_used[triangle[c] as usize] = true;
            }
            split.triangles.push(corners);
        }
        for vertex in (0..mesh.num_vertices()).filter(|&vertex| !is_used[vertex]) {
            key.clear();
            key.push(vertex as u32);
            key.extend(columns.iter().map(|column| match column.attribute.domain {
                Domain::Vertex => row(column.attribute.entry(vertex)),
                _ => NO_ENTRY,
            }));
            place(&mut split, &key);
        }
        if split.sources.len() >= NO_ENTRY as usize {
            let message = format!("{} vertices after splitting", split.sources.len());
            return Err(WriteError::Unrepresentable { message });
        }
        Ok(split)
    }
}

/// Document and buffer so far.
#[derive(Default)]
struct Writer {
    buffer: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    meshes: Vec<Value>,
    materials: Vec<Value>,
    /// What else there is about materials.
    lists: Map<String, Value>,
    /// Materials are identified by their names.
    material_of: HashMap<String, usize>,
    /// What else is known of the whole.
    metadata: Map<String, Value>,
    report: WriteReport,
}

impl Writer {
    /// Takes over materials as they are.
    fn carry(&mut self, materials: Option<&GltfMaterials>) {
        let Some(materials) = materials else { return };
        self.lists = super::materials::lists(materials, |bytes| {
            let start = self.begin();
            self.buffer.extend(bytes);
            self.end(start, None, None)
        });
        if let Some(Value::Array(list)) = self.lists.remove("materials") {
            self.materials = list;
        }
        let name =
            |material: &Value| material.get("name").and_then(Value::as_str).unwrap_or_default().to_owned();
        self.material_of =
            self.materials.iter().enumerate().map(|(k, material)| (name(material), k)).collect();
    }

    /// Adds a mesh that has triangles, and says which it is.
    fn mesh(&mut self, mesh: &TriMesh, attributes: &Attributes) -> Result<usize, WriteError> {
        let is_far = |p: &[f64; 3]| p.iter().any(|&c| (c as f32).is_infinite());
        if let Some(vertex) = mesh.positions().iter().position(is_far) {
            let message =
                format!("vertex {} is too far away for the float32 coordinates of glTF", vertex + 1);
            return Err(unrepresentable(message));
        }
        let metadata = attributes.metadata.iter();
        self.metadata.extend(metadata.map(|(key, text)| (key.clone(), text.as_str().into())));
        let (columns, report) = columns(attributes);
        self.report.ignored.extend(report.ignored);
        let split = Split::new(mesh, &columns)?;
        let positions = split.sources.iter().flat_map(|&v| mesh.positions()[v as usize].map(|c| c as f32));
        let positions: Vec<f32> = positions.collect();
        let mut named = serde_json::Map::new();
        named.insert("POSITION".to_owned(), self.positions(&positions).into());
        for (k, column) in columns.iter().enumerate() {
            let rows: Vec<u32> = split.rows.iter().skip(k).step_by(columns.len()).copied().collect();
            if rows.contains(&NO_ENTRY) {
                self.report.zeroed.push(column.name.to_owned());
            }
            named.insert(column.gltf_name.clone(), self.column(column, &rows).into());
        }
        let primitives = self.primitives(attributes, &split.triangles, named.into());
        self.meshes.push(json!({ "primitives": primitives }));
        Ok(self.meshes.len() - 1)
    }

    fn finish(
        self,
        out: &mut impl Write,
        nodes: Value,
        roots: &[usize],
        container: Container,
    ) -> Result<WriteReport, WriteError> {
        let Self { mut buffer, views, accessors, meshes, materials, lists, metadata, mut report, .. } = self;
        for names in [&mut report.ignored, &mut report.zeroed] {
            let mut known = HashSet::new();
            names.retain(|name| known.insert(name.clone()));
        }
        let mut document = json!({
            "asset": { "version": "2.0", "generator": "lwc" },
            "meshes": meshes,
            "buffers": [{ "byteLength": buffer.len() }],
            "bufferViews": views,
            "accessors": accessors,
        });
        if !metadata.is_empty() {
            document["asset"]["extras"] = metadata.into();
        }
        // Lists may not be empty.
        if !roots.is_empty() {
            document["scene"] = 0.into();
            document["scenes"] = json!([{ "nodes": roots }]);
            document["nodes"] = nodes;
        }
        if !materials.is_empty() {
            document["materials"] = materials.into();
        }
        for (name, list) in lists {
            document[name] = list;
        }
        if container == Container::Text {
            let data = base64::engine::general_purpose::STANDARD.encode(&buffer);
            document["buffers"][0]["uri"] = format!("data:application/octet-stream;base64,{data}").into();
            out.write_all(document.to_string().as_bytes())?;
            return Ok(report);
        }
        let mut text = document.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        buffer.resize(buffer.len().next_multiple_of(4), 0);
        let length = u32::try_from(12 + 8 + text.len() + 8 + buffer.len());
        let length =
            length.map_err(|_| unrepresentable("more than 4 GiB are too much for GLB".to_owned()))?;
        out.write_all(b"glTF\x02\0\0\0")?;
        out.write_all(&length.to_le_bytes())?;
        out.write_all(&(text.len() as u32).to_le_bytes())?;
        out.write_all(b"JSON")?;
        out.write_all(&text)?;
        out.write_all(&(buffer.len() as u32).to_le_bytes())?;
        out.write_all(b"BIN\0")?;
        out.write_all(&buffer)?;
        Ok(report)
    }

    /// Begins a view at the end of the buffer. Its length is that of what follows.
    fn begin(&mut self) -> usize {
        self.buffer.resize(self.buffer.len().next_multiple_of(4), 0);
        self.buffer.len()
    }

    fn end(&mut self, start: usize, target: Option<u32>, stride: Option<usize>) -> usize {
        let mut view = json!({
            "buffer": 0,
            "byteOffset": start,
            "byteLength": self.buffer.len() - start,
        });
        if let Some(target) = target {
            view["target"] = target.into();
        }
        if let Some(stride) = stride {
            view["byteStride"] = stride.into();
        }
        self.views.push(view);
        self.views.len() - 1
    }

    fn accessor(&mut self, accessor: Value) -> usize {
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    fn positions(&mut self, positions: &[f32]) -> usize {
        let start = self.begin();
        self.buffer.extend(positions.iter().flat_map(|c| c.to_le_bytes()));
        let view = self.end(start, Some(ARRAY_BUFFER), Some(12));
        let bound = |f: fn(f32, f32) -> f32| -> [f64; 3] {
            let (points, _) = positions.as_chunks::<3>();
            std::array::from_fn(|axis| points.iter().map(|p| p[axis]).reduce(f).map_or(0.0, f64::from))
        };
        self.accessor(json!({
            "bufferView": view,
            "componentType": 5126,
            "count": positions.len() / 3,
            "type": "VEC3",
            "min": bound(f32::min),
            "max": bound(f32::max),
        }))
    }

    /// Writes the rows of a column, for vertices without one zeros, or some direction.
    fn column(&mut self, column: &Column, rows: &[u32]) -> usize {
        let scalar = column.values.component_type().unwrap_or(ComponentType::F32);
        let (n, size) = (column.attribute.num_components, scalar.num_bytes());
        let stride = (n * size).next_multiple_of(4);
        let missing: &[f32] = match () {
            () if column.attribute.semantic == Semantic::Normal => &UP,
            () if column.gltf_name == TANGENT => &[1.0, 0.0, 0.0, 1.0],
            () => &[],
        };
        let start = self.begin();
        for &row in rows {
            for k in 0..n {
                let other = missing.get(k).map_or(0, |x| u64::from(x.to_bits()));
                let bits = if row == NO_ENTRY { None } else { column.values.bits(row as usize * n + k) };
                self.buffer.extend(&bits.unwrap_or(other).to_le_bytes()[..size]);
            }
            self.buffer.resize(self.buffer.len().next_multiple_of(4), 0);
        }
        let view = self.end(start, Some(ARRAY_BUFFER), Some(stride));
        let code = match scalar {
            ComponentType::I8 => 5120,
            ComponentType::U8 => 5121,
            ComponentType::I16 => 5122,
            ComponentType::U16 => 5123,
            _ => 5126,
        };
        let shape = ["SCALAR", "VEC2", "VEC3", "VEC4"][n - 1];
        let mut accessor = json!({
            "bufferView": view,
            "componentType": code,
            "count": rows.len(),
            "type": shape,
        });
        if column.is_normalized {
            accessor["normalized"] = true.into();
        }
        self.accessor(accessor)
    }

    /// One primitive for each material, in the order of the table, and one for triangles without. All
    /// share the vertices.
    fn primitives(&mut self, attributes: &Attributes, triangles: &[[u32; 3]], named: Value) -> Vec<Value> {
        let material = first_material(attributes);
        let row = |t: usize| material.and_then(|material| material.entry(t));
        let mut order: Vec<(Option<usize>, usize)> = (0..triangles.len()).map(|t| (row(t), t)).collect();
        order.sort_by_key(|&(row, _)| row);
        let mut primitives = Vec::new();
        for group in order.chunk_by(|a, b| a.0 == b.0) {
            let corners = group.iter().flat_map(|&(_, t)| triangles[t]);
            // The largest number of either type is not a vertex.
            let is_short = corners.clone().all(|corner| corner < u32::from(u16::MAX));
            let start = self.begin();
            if is_short {
                self.buffer.extend(corners.flat_map(|corner| (corner as u16).to_le_bytes()));
            } else {
                self.buffer.extend(corners.flat_map(u32::to_le_bytes));
            }
            let view = self.end(start, Some(ELEMENT_ARRAY_BUFFER), None);
            let indices = self.accessor(json!({
                "bufferView": view,
                "componentType": if is_short { 5123 } else { 5125 },
                "count": 3 * group.len(),
                "type": "SCALAR",
            }));
            let mut primitive = json!({ "attributes": named, "indices": indices });
            if let Some(name) = group[0].0.and_then(|row| material?.values.names()?.get(row)) {
                primitive["material"] = self.material(name).into();
            }
            primitives.push(primitive);
        }
        primitives
    }

    fn material(&mut self, name: &str) -> usize {
        if let Some(&known) = self.material_of.get(name) {
            return known;
        }
        self.materials.push(if name.is_empty() { json!({}) } else { json!({ "name": name }) });
        self.material_of.insert(name.to_owned(), self.materials.len() - 1);
        self.materials.len() - 1
    }
}
