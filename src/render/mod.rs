//! Pictures of meshes and charts of numbers, without a display and without fonts of the system.
//!
//! ```
//! use lwc::render::{Camera, Paint, Style, Up, View, render};
//!
//! # let mesh = lwc::TriMesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
//! let style = Style { size: [320, 240], ..Style::default() };
//! let camera = Camera::fit(&mesh, View::default(), Up::Y, 320, 240);
//! let mut png = Vec::new();
//! render(&mesh, Paint::Plain, &camera, &style)?.write_png(&mut png)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod band;
mod camera;
mod chart;
mod colour;
mod error;
mod font;
mod heat;
mod image;
mod paint;
mod projected;
mod raster;
mod shade;

pub use camera::{Camera, UnknownView, Up, View};
pub use chart::{Chart, Series, log_ticks};
pub use colour::sequential;
pub use error::RenderError;
pub use heat::{Heat, with_legend};
pub use image::Image;
pub use paint::{CornerPaint, Paint};
pub use shade::{render, render_with_progress};

/// How a surface looks.
#[derive(Clone, Debug, PartialEq)]
pub struct Style {
    /// Pixels across and down, each 1 to 16384. Default 800 by 600.
    pub size: [u32; 2],
    /// Default smooth.
    pub shading: Shading,
    /// Draws the sides of the triangles. Default no.
    pub wireframe: bool,
    /// Draws outlines. Default no.
    pub silhouettes: bool,
    /// Red, green, blue, opacity of what no triangle covers. Default white.
    pub background: [u8; 4],
    /// Colour of the surface. Default a light blue-grey.
    pub colour: [u8; 3],
    /// Samples per pixel in each direction, 1 to 8. Default 3; the time grows with its square.
    pub oversampling: u32,
}

impl Default for Style {
    fn default() -> Self {
        Self {
            size: [800, 600],
            shading: Shading::Smooth,
            wireframe: false,
            silhouettes: false,
            background: [255; 4],
            colour: [190, 202, 218],
            oversampling: 3,
        }
    }
}

/// Where normals come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shading {
    /// From the vertices.
    #[default]
    Smooth,
    /// From the triangles.
    Flat,
}
