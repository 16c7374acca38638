//! Where a picture is taken from.

use crate::TriMesh;
use glam::DVec3;
use std::str::FromStr;
use thiserror::Error;

/// Axis of the model that points up in the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Up {
    /// As most scans have it.
    #[default]
    Y,
    /// As terrain and CAD models have it.
    Z,
}

/// Direction from the model to the viewer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Degrees to the right of the front.
    pub azimuth: f64,
    /// Degrees above the horizon, −90 to 90.
    pub elevation: f64,
}

impl Default for View {
    /// From the front, a little to the right and above.
    fn default() -> Self {
        Self { azimuth: 30.0, elevation: 20.0 }
    }
}

/// The text is not a view.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("it is neither front, back, left, right, top, bottom nor AZIMUTH,ELEVATION in degrees")]
pub struct UnknownView;

impl FromStr for View {
    type Err = UnknownView;

    fn from_str(text: &str) -> Result<Self, UnknownView> {
        let at = |azimuth, elevation| Ok(Self { azimuth, elevation });
        match text {
            "front" => at(0.0, 0.0),
            "right" => at(90.0, 0.0),
            "back" => at(180.0, 0.0),
            "left" => at(-90.0, 0.0),
            "top" => at(0.0, 90.0),
            "bottom" => at(0.0, -90.0),
            _ => {
                let (azimuth, elevation) = text.split_once(',').ok_or(UnknownView)?;
                let number = |text: &str| text.trim().parse::<f64>().map_err(|_| UnknownView);
                let view = Self { azimuth: number(azimuth)?, elevation: number(elevation)? };
                let in_range = view.azimuth.is_finite() && view.elevation.abs() <= 90.0;
                if in_range { Ok(view) } else { Err(UnknownView) }
            }
        }
    }
}

/// A parallel projection: which part of space fills a picture.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    /// Right, up and towards the viewer, unit vectors.
    axes: [DVec3; 3],
    /// A point near the model, so that far origins cost no digits.
    origin: DVec3,
    /// Middle of the picture along `axes`, from `origin`.
    centre: [f64; 2],
    /// Half of what the picture shows of the directions right and up, model units.
    half: [f64; 2],
}

/// Share of the picture's sides that the model takes.
const FILL: f64 = 0.92;

impl Camera {
    /// A camera that sees all triangles of `mesh` as large as they fit into a picture of `width` by
    /// `height`.
    pub fn fit(mesh: &TriMesh, view: View, up: Up, width: u32, height: u32) -> Self {
        let axes = axes(view, up);
        let used: Vec<DVec3> = mesh
            .triangles()
            .iter()
            .flatten()
            .map(|&v| DVec3::from_array(mesh.positions()[v as usize]))
            .collect();
        let origin = used.first().copied().unwrap_or_default();
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for p in used {
            for k in 0..2 {
                let along = axes[k].dot(p - origin);
                low[k] = low[k].min(along);
                high[k] = high[k].max(along);
            }
        }
        let extent: [f64; 2] = std::array::from_fn(|k| if high[k] > low[k] { high[k] - low[k] } else { 0.0 });
        let aspect = f64::from(width) / f64::from(height);
        let half_height = (extent[1].max(extent[0] / aspect) / 2.0 / FILL).max(f64::MIN_POSITIVE);
        Self {
            axes,
            origin,
            centre: std::array::from_fn(|k| if extent[k] > 0.0 { (low[k] + high[k]) / 2.0 } else { 0.0 }),
            half: [half_height * aspect, half_height],
        }
    }

    /// Column and row from the upper left corner of a picture of `width` by `height`, and nearness in
    /// the same unit.
    pub(super) fn project(&self, p: [f64; 3], width: f64, height: f64) -> [f64; 3] {
        let from_origin = DVec3::from_array(p) - self.origin;
        let [right, up, near] = self.axes.map(|axis| axis.dot(from_origin));
        let per_unit = height / (2.0 * self.half[1]);
        [
            width / 2.0 + (right - self.centre[0]) * per_unit,
            height / 2.0 - (up - self.centre[1]) * per_unit,
            near * per_unit,
        ]
    }

    /// A direction as right, up, towards the viewer.
    pub(super) fn turn(&self, direction: DVec3) -> DVec3 {
        DVec3::from_array(self.axes.map(|axis| axis.dot(direction)))
    }
}

fn axes(view: View, up: Up) -> [DVec3; 3] {
    let (sin_a, cos_a) = view.azimuth.to_radians().sin_cos();
    let (sin_e, cos_e) = view.elevation.to_radians().sin_cos();
    // With y up the front looks along −z, with z up along y.
    let stand = |right: f64, up_: f64, front: f64| match up {
        Up::Y => DVec3::new(right, up_, front),
        Up::Z => DVec3::new(right, -front, up_),
    };
    [
        stand(cos_a, 0.0, -sin_a),
        stand(-sin_e * sin_a, cos_e, -sin_e * cos_a),
        stand(cos_e * sin_a, sin_e, cos_e * cos_a),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_right_handed_and_orthonormal() {
        for view in ["front", "back", "left", "right", "top", "bottom", "30,20", "-140,-70.5"] {
            for up in [Up::Y, Up::Z] {
                let [right, above, near] = axes(view.parse().unwrap(), up);
                assert!((right.cross(above) - near).length() < 1e-12, "{view}");
                assert!((above.cross(near) - right).length() < 1e-12 && right.dot(above).abs() < 1e-12);
            }
        }
        let front = axes("front".parse().unwrap(), Up::Y);
        assert_eq!(front, [DVec3::X, DVec3::Y, DVec3::Z]);
        let [right, above, near] = axes("top".parse().unwrap(), Up::Z);
        assert!(
            (right - DVec3::X).length() + (above - DVec3::Y).length() + (near - DVec3::Z).length() < 1e-12
        );
    }

    #[test]
    fn other_texts_are_no_views() {
        for text in ["", "above", "1", "1,2,3", "0,91", "nan,0", "inf,0"] {
            assert_eq!(text.parse::<View>(), Err(UnknownView), "{text}");
        }
    }

    #[test]
    fn the_model_fits() {
        let positions = vec![[1e7, 0.0, 0.0], [1e7 + 4.0, 0.0, 0.0], [1e7, 1.0, 3.0], [9e9, 0.0, 0.0]];
        let mesh = TriMesh::new(positions, vec![[0, 1, 2]]).unwrap();
        let camera = Camera::fit(&mesh, View::default(), Up::Z, 300, 200);
        let places = mesh.positions()[..3].iter().map(|&p| camera.project(p, 300.0, 200.0));
        let places: Vec<[f64; 3]> = places.collect();
        assert!(
            places.iter().all(|p| (0.0..300.0).contains(&p[0]) && (0.0..200.0).contains(&p[1])),
            "{places:?}"
        );
        // The longer side decides.
        let extent = |k: usize| {
            let along = places.iter().map(|p| p[k]);
            along.clone().fold(f64::MIN, f64::max) - along.fold(f64::MAX, f64::min)
        };
        assert!(((extent(0) / 300.0).max(extent(1) / 200.0) - FILL).abs() < 1e-9);
    }
}
