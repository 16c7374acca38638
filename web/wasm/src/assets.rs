//! Attributes and the places of meshes, for pages that ask for them.

use crate::drawing::Drawing;
use crate::with;
use lwc::Decoder;
use lwc::mesh::{Instance, SceneTable};
use std::fmt::Write;

/// The last mesh that was made ready for drawing.
#[derive(Default)]
pub struct Assets {
    counts: [u32; 6],
    drawing: Drawing,
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    scene: String,
}

impl Assets {
    /// `positions` and `normals` of the vertices of the mesh; there may be no normals.
    pub fn draw(&mut self, decoder: &Decoder, positions: &[[f32; 3]], normals: &[[f32; 3]]) {
        let Some(mesh) = decoder.mesh() else { return };
        let attributes = decoder.attributes();
        self.drawing = Drawing::new(mesh, &attributes);
        let Drawing { sources, triangles, parts, colors, uvs, normals: stored } = &mut self.drawing;
        self.positions = sources.iter().map(|&v| positions[v as usize]).collect();
        let shaded = |&v: &u32| normals.get(v as usize).copied();
        if stored.is_empty() {
            self.normals = sources.iter().filter_map(shaded).collect();
        } else {
            self.normals = std::mem::take(stored);
            // What has no normal in the stream has that of the surface.
            for (normal, source) in self.normals.iter_mut().zip(&*sources) {
                if *normal == [0.0; 3] {
                    *normal = shaded(source).unwrap_or_default();
                }
            }
        }
        let lengths =
            [sources.len(), triangles.len(), parts.len(), colors.len(), uvs.len(), self.normals.len()];
        self.counts = lengths.map(|length| length as u32);
        if let Some(scene) = &attributes.scene
            && self.scene.is_empty()
        {
            self.scene = json(scene);
        }
    }
}

/// `{"exponents": […], "instances": [{"mesh", "name", "transform": 12 numbers, row by row}]}`
fn json(scene: &SceneTable) -> String {
    let mut text = format!("{{\"exponents\":{:?},\"instances\":[", scene.exponents);
    for (i, Instance { mesh, name, transform }) in scene.instances.iter().enumerate() {
        let comma = if i > 0 { "," } else { "" };
        let _ = write!(text, "{comma}{{\"mesh\":{mesh},\"name\":\"");
        for c in name.chars() {
            match c {
                '"' | '\\' => text.extend(['\\', c]),
                c if c < ' ' => {
                    let _ = write!(text, "\\u{:04x}", c as u32);
                }
                c => text.push(c),
            }
        }
        let _ = write!(text, "\",\"transform\":{:?}}}", transform.as_flattened());
    }
    text + "]}"
}

/// Makes the mesh with its attributes ready; numbers of vertices, triangles, ends of parts, colours, texture
/// coordinates and normals. What the functions below point to is valid until the next call.
#[unsafe(no_mangle)]
pub extern "C" fn draw(handle: u32) -> *const u32 {
    with(handle, |slot| slot.draw().counts.as_ptr())
}

/// Positions, n × 3.
#[unsafe(no_mangle)]
pub extern "C" fn drawn_positions(handle: u32) -> *const f32 {
    with(handle, |slot| slot.assets().positions.as_ptr().cast())
}

/// Normals, n × 3.
#[unsafe(no_mangle)]
pub extern "C" fn drawn_normals(handle: u32) -> *const f32 {
    with(handle, |slot| slot.assets().normals.as_ptr().cast())
}

/// Linear red, green, blue and opacity in 65535ths, n × 4.
#[unsafe(no_mangle)]
pub extern "C" fn drawn_colors(handle: u32) -> *const u16 {
    with(handle, |slot| slot.assets().drawing.colors.as_ptr().cast())
}

/// Texture coordinates, n × 2.
#[unsafe(no_mangle)]
pub extern "C" fn drawn_uvs(handle: u32) -> *const f32 {
    with(handle, |slot| slot.assets().drawing.uvs.as_ptr().cast())
}

/// The vertex of the mesh that each vertex is.
#[unsafe(no_mangle)]
pub extern "C" fn drawn_sources(handle: u32) -> *const u32 {
    with(handle, |slot| slot.assets().drawing.sources.as_ptr())
}

/// Vertices of the triangles, m × 3.
#[unsafe(no_mangle)]
pub extern "C" fn drawn_triangles(handle: u32) -> *const u32 {
    with(handle, |slot| slot.assets().drawing.triangles.as_ptr().cast())
}

/// First triangle of each mesh of a scene, and the end of the last.
#[unsafe(no_mangle)]
pub extern "C" fn drawn_parts(handle: u32) -> *const u32 {
    with(handle, |slot| slot.assets().drawing.parts.as_ptr())
}

/// The instances of the meshes of a scene, as JSON.
#[unsafe(no_mangle)]
pub extern "C" fn scene(handle: u32) -> *const u8 {
    with(handle, |slot| slot.assets().scene.as_ptr())
}

/// Bytes of [`scene`], 0 if it is no scene.
#[unsafe(no_mangle)]
pub extern "C" fn scene_length(handle: u32) -> u32 {
    with(handle, |slot| slot.assets().scene.len() as u32)
}

/// Bytes of attributes decoded so far.
#[unsafe(no_mangle)]
pub extern "C" fn attribute_bytes(handle: u32) -> f64 {
    with(handle, |slot| slot.attribute_bytes() as f64)
}

/// Checksum of the values of all attributes (`format/SPEC.md`, section 9).
#[unsafe(no_mangle)]
pub extern "C" fn attribute_checksum(handle: u32) -> u32 {
    with(handle, |slot| slot.attribute_checksum())
}
