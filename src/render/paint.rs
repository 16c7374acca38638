//! What colours a surface has.

use super::{RenderError, sequential};
use crate::mesh::{
    Attribute, Semantic, TriMesh,
    srgb::{is_linear, srgb_of},
};

/// Where colours come from.
#[derive(Clone, Copy, Debug, Default)]
pub enum Paint<'a> {
    /// One colour, that of the style.
    #[default]
    Plain,
    /// One value in [0, 1] per vertex, coloured by [`sequential`].
    Values(&'a [f64]),
    /// An attribute as colours.
    Corners(&'a CornerPaint),
}

/// An attribute as colours: three numbers at each corner, which become a colour at each pixel.
#[derive(Clone, Debug)]
pub struct CornerPaint {
    values: Vec<[f64; 3]>,
    colour: fn([f64; 3]) -> [u8; 3],
}

/// Squares of the pattern to a unit of texture coordinates.
const SQUARES: f64 = 16.0;
/// Colour where there is no value, magenta.
const MISSING: [f64; 3] = [f64::NAN; 3];

impl CornerPaint {
    /// Colours as they are, those of glTF from linear to sRGB, normals as (n + 1) / 2, texture coordinates as red and green with a pattern of
    /// squares; `None` for anything else. What has no value is magenta.
    pub fn new(mesh: &TriMesh, attribute: &Attribute) -> Option<Self> {
        let colour: fn([f64; 3]) -> [u8; 3] = match (attribute.semantic, attribute.num_components) {
            (Semantic::Color(_), 1 | 3 | 4) if is_linear(attribute) => |linear| bytes(linear.map(srgb_of)),
            (Semantic::Color(_), 1 | 3 | 4) => bytes,
            (Semantic::Normal, 3) => |n| bytes(n.map(|c| 0.5 * (c + 1.0))),
            (Semantic::TexCoord(_), 2) => texture,
            _ => return None,
        };
        // Integers that nobody called normalised are colours of their range.
        let one = match (attribute.semantic, attribute.values.component_type()) {
            (Semantic::Color(_), Some(scalar)) if !attribute.is_normalized => scalar.one(),
            _ => 1.0,
        };
        let last = attribute.num_components.min(3) - 1;
        let at = |t: usize, corner: usize| {
            let value = |row| [0, 1, 2].map(|k| attribute.number(row, k.min(last)).map_or(0.0, |x| x / one));
            attribute.entry_at_corner(mesh, t, corner).map_or(MISSING, value)
        };
        let values = (0..mesh.num_triangles()).flat_map(|t| [0, 1, 2].map(|corner| at(t, corner))).collect();
        Some(Self { values, colour })
    }
}

fn bytes(colour: [f64; 3]) -> [u8; 3] {
    if colour[0].is_nan() {
        return [255, 0, 255];
    }
    colour.map(|c| (c.clamp(0.0, 1.0) * 255.0).round() as u8)
}

fn texture([u, v, _]: [f64; 3]) -> [u8; 3] {
    let is_dark = ((u * SQUARES).floor() + (v * SQUARES).floor()).rem_euclid(2.0) >= 1.0;
    let [r, g] = [u, v].map(|c| c - c.floor());
    bytes([r, g, 0.5].map(|c| if is_dark { 0.75 * c } else { c }))
}

impl Paint<'_> {
    pub(super) fn check(&self, mesh: &TriMesh) -> Result<(), RenderError> {
        let fits = match self {
            Self::Plain => true,
            Self::Values(values) => values.len() == mesh.num_vertices(),
            Self::Corners(paint) => paint.values.len() == 3 * mesh.num_triangles(),
        };
        if fits { Ok(()) } else { Err(RenderError::Values) }
    }

    /// The colour at a place of a triangle, `None` for that of the style.
    pub(super) fn at(&self, mesh: &TriMesh, triangle: usize, weights: [f64; 3]) -> Option<[u8; 3]> {
        match self {
            Self::Plain => None,
            Self::Values(values) => {
                let corners = mesh.triangles()[triangle];
                Some(sequential((0..3).map(|i| values[corners[i] as usize] * weights[i]).sum()))
            }
            Self::Corners(paint) => {
                let corners = &paint.values[3 * triangle..3 * triangle + 3];
                let sum = |k: usize| (0..3).map(|i| corners[i][k] * weights[i]).sum();
                Some((paint.colour)([sum(0), sum(1), sum(2)]))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Domain, NO_ENTRY, Values};

    #[test]
    fn attributes_have_their_colours() {
        let mesh = TriMesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]).unwrap();
        let paint = |semantic, n, values| {
            let indices = Some(vec![0, 1, 1]);
            let attribute = Attribute::new("a", semantic, Domain::Vertex, n, values);
            CornerPaint::new(&mesh, &Attribute { indices, ..attribute })
        };
        let at = |paint: &Option<CornerPaint>, corner: usize| {
            let mut weights = [0.0; 3];
            weights[corner] = 1.0;
            paint.as_ref().and_then(|paint| Paint::Corners(paint).at(&mesh, 0, weights))
        };
        let colour = paint(Semantic::Color(0), 3, Values::U8(vec![255, 0, 51, 0, 102, 255]));
        assert_eq!(at(&colour, 0), Some([255, 0, 51]));
        assert_eq!(at(&colour, 1), Some([0, 102, 255]));
        let linear =
            Attribute::new("COLOR_0", Semantic::Color(0), Domain::Vertex, 3, Values::F32(vec![0.2159; 9]));
        assert_eq!(at(&CornerPaint::new(&mesh, &linear), 0), Some([128; 3]), "glTF has linear colours");
        let normal = paint(Semantic::Normal, 3, Values::F32(vec![0.0, 0.0, 1.0, -1.0, 0.0, 0.0]));
        assert_eq!(at(&normal, 0), Some([128, 128, 255]));
        let uv = paint(Semantic::TexCoord(0), 2, Values::F32(vec![0.51, 0.26, 1.01, -0.01]));
        assert_eq!(at(&uv, 0), Some([130, 66, 128]));
        assert_eq!(at(&uv, 1), Some([2, 189, 96]), "beyond the unit square, and dark");
        assert!(paint(Semantic::Generic, 1, Values::U8(vec![0; 2])).is_none());
        let values = Values::U8(vec![9; 3]);
        let attribute = Attribute::new("c", Semantic::Color(0), Domain::Triangle, 3, values);
        let without = CornerPaint::new(&mesh, &Attribute { indices: Some(vec![NO_ENTRY]), ..attribute });
        assert_eq!(at(&without, 2), Some([255, 0, 255]));
    }
}
