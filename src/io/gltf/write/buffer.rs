//! The buffer, with its views and accessors.

use crate::mesh::{Attribute, ComponentType};
use serde_json::{Value, json};

const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// The buffer so far.
#[derive(Default)]
pub(super) struct Buffer {
    pub bytes: Vec<u8>,
    pub views: Vec<Value>,
    pub accessors: Vec<Value>,
}

impl Buffer {
    /// Adds bytes of any kind; gives their view.
    pub fn image(&mut self, bytes: &[u8]) -> usize {
        let start = self.begin();
        self.bytes.extend(bytes);
        self.end(start, None, None)
    }

    /// Adds positions; gives their accessor.
    pub fn positions(&mut self, positions: &[[f32; 3]]) -> usize {
        let start = self.begin();
        self.bytes.extend(positions.as_flattened().iter().flat_map(|c| c.to_le_bytes()));
        let view = self.end(start, Some(ARRAY_BUFFER), Some(12));
        let bound = |f: fn(f32, f32) -> f32| -> [f64; 3] {
            std::array::from_fn(|axis| positions.iter().map(|p| p[axis]).reduce(f).map_or(0.0, f64::from))
        };
        self.accessor(json!({
            "bufferView": view,
            "componentType": 5126,
            "count": positions.len(),
            "type": "VEC3",
            "min": bound(f32::min),
            "max": bound(f32::max),
        }))
    }

    /// Adds an attribute, which has a value at each of so many vertices; gives its accessor.
    pub fn column(&mut self, attribute: &Attribute, num_vertices: usize) -> usize {
        let scalar = attribute.values.component_type().unwrap_or(ComponentType::F32);
        let (n, size) = (attribute.num_components, scalar.num_bytes());
        let stride = (n * size).next_multiple_of(4);
        let start = self.begin();
        for vertex in 0..num_vertices {
            let row = attribute.entry(vertex);
            for k in 0..n {
                let bits = row.and_then(|row| attribute.values.bits(row * n + k)).unwrap_or(0);
                self.bytes.extend(&bits.to_le_bytes()[..size]);
            }
            self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
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
        let mut accessor =
            json!({ "bufferView": view, "componentType": code, "count": num_vertices, "type": shape });
        if attribute.is_normalized {
            accessor["normalized"] = true.into();
        }
        self.accessor(accessor)
    }

    /// Adds the corners of triangles; gives their accessor.
    pub fn indices(&mut self, triangles: impl Iterator<Item = [u32; 3]> + Clone) -> usize {
        let corners = triangles.flatten();
        // The largest number of either type is not a vertex.
        let is_short = corners.clone().all(|corner| corner < u32::from(u16::MAX));
        let count = corners.clone().count();
        let start = self.begin();
        if is_short {
            self.bytes.extend(corners.flat_map(|corner| (corner as u16).to_le_bytes()));
        } else {
            self.bytes.extend(corners.flat_map(u32::to_le_bytes));
        }
        let view = self.end(start, Some(ELEMENT_ARRAY_BUFFER), None);
        let code = if is_short { 5123 } else { 5125 };
        self.accessor(json!({ "bufferView": view, "componentType": code, "count": count, "type": "SCALAR" }))
    }

    /// Begins a view at the end of the buffer. Its length is that of what follows.
    fn begin(&mut self) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.bytes.len()
    }

    fn end(&mut self, start: usize, target: Option<u32>, stride: Option<usize>) -> usize {
        let mut view = json!({ "buffer": 0, "byteOffset": start, "byteLength": self.bytes.len() - start });
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
}
