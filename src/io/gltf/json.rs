//! The parts of a glTF document that we read. What is `null` is as if it were not there.

use super::nulls::{or_default, without_nulls};
use serde::{Deserialize, de::IgnoredAny};
use serde_json::{Map, Value};
use std::collections::BTreeMap;

/// Extensions of any object, by name.
pub(super) type Extensions = BTreeMap<String, IgnoredAny>;

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Document {
    #[serde(deserialize_with = "or_default")]
    pub asset: Asset,
    #[serde(deserialize_with = "or_default")]
    pub extensions_required: Vec<String>,
    #[serde(deserialize_with = "or_default")]
    pub extensions_used: Vec<String>,
    #[serde(deserialize_with = "or_default")]
    pub buffers: Vec<Buffer>,
    #[serde(deserialize_with = "or_default")]
    pub buffer_views: Vec<BufferView>,
    #[serde(deserialize_with = "or_default")]
    pub accessors: Vec<Accessor>,
    #[serde(deserialize_with = "or_default")]
    pub meshes: Vec<Mesh>,
    #[serde(deserialize_with = "or_default")]
    pub nodes: Vec<Node>,
    #[serde(deserialize_with = "or_default")]
    pub scenes: Vec<Scene>,
    pub extras: Option<IgnoredAny>,
    pub scene: Option<usize>,
    #[serde(deserialize_with = "or_default")]
    pub materials: Vec<Map<String, Value>>,
    #[serde(deserialize_with = "or_default")]
    pub textures: Vec<Map<String, Value>>,
    #[serde(deserialize_with = "or_default")]
    pub images: Vec<Map<String, Value>>,
    #[serde(deserialize_with = "or_default")]
    pub samplers: Vec<Map<String, Value>>,
    #[serde(deserialize_with = "or_default")]
    pub animations: Vec<IgnoredAny>,
    #[serde(deserialize_with = "or_default")]
    pub skins: Vec<IgnoredAny>,
    #[serde(deserialize_with = "or_default")]
    pub cameras: Vec<IgnoredAny>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Asset {
    #[serde(deserialize_with = "or_default")]
    pub version: String,
    pub min_version: Option<String>,
    pub copyright: Option<IgnoredAny>,
    #[serde(deserialize_with = "or_default")]
    pub extras: Value,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Buffer {
    pub byte_length: u64,
    pub uri: Option<String>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct BufferView {
    pub buffer: usize,
    #[serde(default, deserialize_with = "or_default")]
    pub byte_offset: u64,
    pub byte_length: u64,
    pub byte_stride: Option<u64>,
    #[serde(default, deserialize_with = "or_default")]
    pub extensions: Extensions,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Accessor {
    pub buffer_view: Option<usize>,
    #[serde(default, deserialize_with = "or_default")]
    pub byte_offset: u64,
    pub component_type: u32,
    #[serde(default, deserialize_with = "or_default")]
    pub normalized: bool,
    pub count: u64,
    #[serde(rename = "type")]
    pub shape: String,
    pub sparse: Option<Sparse>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Sparse {
    pub count: u64,
    pub indices: SparsePart,
    pub values: SparsePart,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparsePart {
    pub buffer_view: usize,
    #[serde(default, deserialize_with = "or_default")]
    pub byte_offset: u64,
    /// Of the indices only.
    pub component_type: Option<u32>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Mesh {
    pub extras: Option<IgnoredAny>,
    #[serde(default, deserialize_with = "or_default")]
    pub name: String,
    pub primitives: Vec<Primitive>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Primitive {
    #[serde(deserialize_with = "without_nulls")]
    pub attributes: BTreeMap<String, usize>,
    pub indices: Option<usize>,
    pub material: Option<usize>,
    pub extras: Option<IgnoredAny>,
    pub mode: Option<u32>,
    #[serde(default, deserialize_with = "or_default")]
    pub targets: Vec<IgnoredAny>,
    #[serde(default, deserialize_with = "or_default")]
    pub extensions: Extensions,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Node {
    #[serde(deserialize_with = "or_default")]
    pub name: String,
    #[serde(deserialize_with = "or_default")]
    pub children: Vec<usize>,
    pub extras: Option<IgnoredAny>,
    pub mesh: Option<usize>,
    /// Column by column.
    pub matrix: Option<Box<[f64; 16]>>,
    pub translation: Option<[f64; 3]>,
    pub rotation: Option<[f64; 4]>,
    pub scale: Option<[f64; 3]>,
    #[serde(deserialize_with = "or_default")]
    pub extensions: NodeExtensions,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct NodeExtensions {
    #[serde(rename = "EXT_mesh_gpu_instancing")]
    pub instancing: Option<Instancing>,
}

/// The mesh of a node in many places: an accessor for each part of their transforms.
#[derive(Debug, Deserialize)]
pub(super) struct Instancing {
    #[serde(default, deserialize_with = "without_nulls")]
    pub attributes: BTreeMap<String, usize>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Scene {
    #[serde(deserialize_with = "or_default")]
    pub name: String,
    pub extras: Option<IgnoredAny>,
    #[serde(deserialize_with = "or_default")]
    pub nodes: Vec<usize>,
}
