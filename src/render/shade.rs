//! From visible triangles to colours.

use super::camera::Camera;
use super::projected::Projected;
use super::raster::{NOTHING, Visible};
use super::{Image, Paint, RenderError, Shading, Style};
use crate::TriMesh;
use crate::util::count::Count;
use glam::DVec3;
use rayon::prelude::*;

/// Directions to the lights as right, up, towards the viewer; not unit vectors.
const KEY: DVec3 = DVec3::new(-0.45, 0.55, 0.75);
const FILL: DVec3 = DVec3::new(0.7, 0.0, 0.7);
/// Shares of the light that does not come from the lamps, and of each lamp.
const AMBIENT: f64 = 0.16;
const KEY_SHARE: f64 = 0.72;
const FILL_SHARE: f64 = 0.2;
/// Strength and sharpness of the highlight.
const GLOSS: f64 = 0.1;
const SHARPNESS: i32 = 24;
/// How much less shade a painted surface has: its colours are to be read.
const HEAT_SOFTNESS: f64 = 0.6;
/// Colour of wires and outlines.
const INK: [u8; 3] = [25, 28, 35];
/// Half the width of a wire, pixels of the picture.
const HALF_WIRE: f64 = 0.4;
/// How opaque a wire is.
const WIRE: f64 = 0.65;
/// A step in depth of this part of the picture's smaller side is an outline.
const OUTLINE_STEP: f32 = 0.02;
/// Large pictures are oversampled less, so that they take at most this many samples, 12 bytes each.
const MAX_SAMPLES: u64 = 1 << 28;

/// Takes a picture of `mesh` with `camera`.
///
/// # Errors
/// If the size is out of range or the paint does not fit the mesh.
pub fn render(mesh: &TriMesh, paint: Paint, camera: &Camera, style: &Style) -> Result<Image, RenderError> {
    render_with_progress(mesh, paint, camera, style, &|_| ())
}

/// As [`render`], calling `progress` with the share of the work done, 0 to 1.
///
/// # Errors
/// As [`render`].
pub fn render_with_progress(
    mesh: &TriMesh,
    paint: Paint,
    camera: &Camera,
    style: &Style,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Image, RenderError> {
    paint.check(mesh)?;
    let [width, height] = style.size;
    let pixels = u64::from(width) * u64::from(height);
    let fits = |scale: &u32| pixels * u64::from(scale * scale) <= MAX_SAMPLES;
    let scale = (1..=style.oversampling.clamp(1, 8)).rev().find(fits).unwrap_or(1);
    let mut image = Image::new(width, height, style.background)?;
    let samples = [width as usize * scale as usize, height as usize * scale as usize];
    // Each row has its triangles, then its colours, and is made smaller.
    let count = Count::new(3 * samples[1], progress);
    let scene = Scene::new(mesh, paint, camera, style, samples);
    let visible = Visible::new(&scene.triangles, samples[0], samples[1], &count);
    let mut large = Image::oversized(samples, style.background);
    large.par_rows_mut().enumerate().for_each(|(row, pixels)| {
        for (column, pixel) in pixels.as_chunks_mut::<4>().0.iter_mut().enumerate() {
            let outline = style.silhouettes && is_outline(&visible, column, row, scale as usize, samples);
            let colour =
                if outline { Some(INK) } else { scene.colour(&visible, column, row, f64::from(scale)) };
            if let Some([r, g, b]) = colour {
                *pixel = [r, g, b, 255];
            }
        }
        count.add(1);
    });
    image.paste(&large.reduced(scale), 0, 0);
    count.finish();
    Ok(image)
}

/// Everything that a sample's colour depends on.
struct Scene<'a> {
    mesh: &'a TriMesh,
    paint: Paint<'a>,
    style: &'a Style,
    triangles: Vec<Projected>,
    /// Unit normals as right, up, towards the viewer: per vertex if smooth, else per triangle.
    normals: Vec<DVec3>,
}

impl<'a> Scene<'a> {
    fn new(
        mesh: &'a TriMesh,
        paint: Paint<'a>,
        camera: &Camera,
        style: &'a Style,
        samples: [usize; 2],
    ) -> Self {
        let [width, height] = samples.map(|n| n as f64);
        let places: Vec<[f64; 3]> =
            mesh.positions().par_iter().map(|&p| camera.project(p, width, height)).collect();
        let triangles = mesh.triangles().par_iter();
        let normals = match style.shading {
            Shading::Smooth => vertex_normals(mesh),
            Shading::Flat => mesh.triangles().iter().map(|&t| area_vector(mesh, t)).collect(),
        };
        Self {
            mesh,
            paint,
            style,
            triangles: triangles.map(|t| Projected(t.map(|v| places[v as usize]))).collect(),
            normals: normals.par_iter().map(|&n| camera.turn(n).normalize_or_zero()).collect(),
        }
    }

    /// Colour of a sample; `None` for the background.
    fn colour(&self, visible: &Visible, column: usize, row: usize, scale: f64) -> Option<[u8; 3]> {
        let face = visible.triangle[row * visible.width + column];
        if face == NOTHING {
            return None;
        }
        let projected = &self.triangles[face as usize];
        let weights = projected.weights(column as f64 + 0.5, row as f64 + 0.5)?;
        let corners = self.mesh.triangles()[face as usize].map(|v| v as usize);
        let normal = match self.style.shading {
            Shading::Flat => self.normals[face as usize],
            Shading::Smooth => {
                let sum: DVec3 = (0..3).map(|i| self.normals[corners[i]] * weights[i]).sum();
                sum.normalize_or_zero()
            }
        };
        let painted = self.paint.at(self.mesh, face as usize, weights);
        let softness = if painted.is_some() { HEAT_SOFTNESS } else { 0.0 };
        let mut colour = lit(painted.unwrap_or(self.style.colour), normal, softness);
        if self.style.wireframe {
            // Half a sample to each side, so that wires do not fade where the picture is not oversampled.
            let cover = HALF_WIRE * scale + 0.5 - projected.distance_to_sides(weights);
            let share = WIRE * cover.clamp(0.0, 1.0);
            for (c, ink) in colour.iter_mut().zip(INK) {
                *c = (f64::from(*c) * (1.0 - share) + f64::from(ink) * share) as u8;
            }
        }
        Some(colour)
    }
}

/// A colour under the lamps, seen from the side that faces the viewer. Light adds up in a space where
/// bytes are square roots, close to sRGB.
fn lit(base: [u8; 3], normal: DVec3, softness: f64) -> [u8; 3] {
    let normal = if normal.z < 0.0 { -normal } else { normal };
    let key = normal.dot(KEY.normalize()).max(0.0);
    let fill = normal.dot(FILL.normalize()).max(0.0);
    let light = softness + (1.0 - softness) * (AMBIENT + KEY_SHARE * key + FILL_SHARE * fill);
    let halfway = (KEY.normalize() + DVec3::Z).normalize();
    let highlight = (1.0 - softness) * GLOSS * normal.dot(halfway).max(0.0).powi(SHARPNESS);
    base.map(|c| {
        let linear = (f64::from(c) / 255.0).powi(2) * light + highlight;
        (linear.sqrt() * 255.0).round().min(255.0) as u8
    })
}

/// True at a surface next to which, one pixel away, there is nothing or something much farther away.
fn is_outline(visible: &Visible, column: usize, row: usize, scale: usize, samples: [usize; 2]) -> bool {
    let at = row * visible.width + column;
    if visible.triangle[at] == NOTHING {
        return false;
    }
    let step = OUTLINE_STEP * samples[0].min(samples[1]) as f32;
    let reach = scale as i64;
    [(reach, 0), (-reach, 0), (0, reach), (0, -reach)].iter().any(|&(dx, dy)| {
        let (x, y) = (column as i64 + dx, row as i64 + dy);
        let inside = (0..visible.width as i64).contains(&x) && (0..visible.height as i64).contains(&y);
        let beside = y as usize * visible.width + x as usize;
        inside && (visible.triangle[beside] == NOTHING || visible.near[at] - visible.near[beside] > step)
    })
}

/// Twice the area of a triangle along its normal.
fn area_vector(mesh: &TriMesh, triangle: [u32; 3]) -> DVec3 {
    let [a, b, c] = triangle.map(|v| DVec3::from_array(mesh.positions()[v as usize]));
    (b - a).cross(c - a)
}

/// Sums of the area vectors at each vertex.
fn vertex_normals(mesh: &TriMesh) -> Vec<DVec3> {
    let mut normals = vec![DVec3::ZERO; mesh.num_vertices()];
    for &triangle in mesh.triangles() {
        let area = area_vector(mesh, triangle);
        triangle.iter().for_each(|&v| normals[v as usize] += area);
    }
    normals
}
