//! LAS and LAZ point clouds of terrain, triangulated in the plane.
//!
//! The vertices are points of the file at their coordinates, the triangles those of Delaunay seen from above,
//! counter-clockwise from there. Overhangs are not for a surface like this: among several points above each
//! other one remains.

mod columns;
mod compressed;
mod crs;
mod gps_time;
mod header;
mod points;
mod quiet;
mod thin;

use super::{MeshFile, Place, ReadError, ReadReport, builder::MeshBuilder};
use crate::mesh::{Attribute, Domain, Semantic, Values};
use columns::Column;
use points::{Cloud, Point};
use spade::{DelaunayTriangulation, Point2, Triangulation};
use std::collections::HashSet;

/// Which points of a cloud become vertices.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct TerrainOptions {
    /// Only the last return of each pulse, which is the one that got furthest down. Default: all returns.
    pub last_returns_only: bool,
    /// At most one point in each square of this size in units of the file, the one nearest to its middle.
    /// Positive. Default: no thinning.
    pub cell_size: Option<f64>,
    /// At most this many points, by squares as large as that takes. Default: all.
    pub max_points: Option<usize>,
    /// Only points of these classes, such as 2 (ground) and 9 (water). Default: all classes.
    pub classes: Option<Vec<u8>>,
    /// No triangle with a longer edge in the plane, in units of the file, positive: they close bays and gaps. Default: all
    /// triangles of the convex hull.
    pub longest_edge: Option<f64>,
}

/// Axes of the plane may differ in scale by this factor; any real file has the same for both.
const MAX_SCALE_RATIO: f64 = 1000.0;

/// Reads and triangulates.
pub(super) fn read(bytes: &[u8], options: &TerrainOptions) -> Result<MeshFile, ReadError> {
    let cloud = points::read(bytes)?;
    let Cloud { mut points, scale, offset, .. } = cloud;
    let num_points = points.len();
    if let Some(classes) = &options.classes {
        points.retain(|point| classes.contains(&point.classification));
    }
    if options.last_returns_only {
        points.retain(|point| point.is_last_return);
    }
    thin::keep_lowest(&mut points);
    if let Some(cell_size) = options.cell_size {
        thin::keep_one_per_cell(&mut points, [cell_size / scale[0], cell_size / scale[1]]);
    }
    if let Some(max_points) = options.max_points {
        thin::keep_at_most(&mut points, max_points, scale);
    }
    if points.len() >= u32::MAX as usize {
        return Err(ReadError::TooLarge { message: format!("{} points", points.len()) });
    }

    let mut builder = MeshBuilder::for_file(bytes.len());
    builder.report.points_left_out = num_points - points.len();
    builder.report.points_withheld = cloud.num_withheld;
    builder.triangles = triangulate(&points, scale)?;
    if let Some(longest) = options.longest_edge {
        builder.triangles.retain(|&triangle| longest_edge(triangle, &points, scale) <= longest);
    }
    let position = |point: &Point| [0, 1, 2].map(|k| f64::from(point.grid[k]) * scale[k] + offset[k]);
    builder.positions = points.iter().map(position).collect();
    builder.attributes.list = attributes(&points, cloud.has_colour, &cloud.columns, &mut builder.report);
    let header = header::read_header(bytes)?;
    builder.attributes.metadata = crs::metadata(&header, bytes, &mut builder.report).into();
    builder.report.ignore("returns, angles, times, sources, flags and user data of points");
    cloud.other_bytes.iter().for_each(|name| builder.report.ignore(name));
    if header::has_other_records(&header, bytes) {
        builder.report.ignore("other variable length records");
    }
    builder.finish()
}

/// The length in the plane of the longest edge of a triangle.
fn longest_edge(triangle: [u32; 3], points: &[Point], scale: [f64; 3]) -> f64 {
    let corner = |v: u32| [0, 1].map(|k| f64::from(points[v as usize].grid[k]) * scale[k]);
    let length = |a: [f64; 2], b: [f64; 2]| libm::hypot(a[0] - b[0], a[1] - b[1]);
    let [a, b, c] = triangle.map(corner);
    length(a, b).max(length(b, c)).max(length(c, a))
}

fn attributes(
    points: &[Point],
    has_colour: bool,
    columns: &[Column],
    report: &mut ReadReport,
) -> Vec<Attribute> {
    let of_vertices =
        |name: &str, semantic, n, values| Attribute::new(name, semantic, Domain::Vertex, n, values);
    let classes = Values::U8(points.iter().map(|point| point.classification).collect());
    let intensities = Values::U16(points.iter().map(|point| point.intensity).collect());
    let mut list = vec![
        of_vertices("classification", Semantic::Generic, 1, classes),
        of_vertices("intensity", Semantic::Generic, 1, intensities),
    ];
    if has_colour {
        let colours = colours(points);
        if matches!(colours, Values::U8(_)) && points.iter().any(|point| point.colour != [0; 3]) {
            report.colours_of_8_bits = points.len();
        }
        let colour = of_vertices("red green blue", Semantic::Color(0), 3, colours);
        list.push(Attribute { is_normalized: true, ..colour });
    }
    let mut taken: HashSet<String> = TAKEN.iter().map(|&name| name.to_owned()).collect();
    for column in columns {
        let attribute = column.attribute(points.iter().map(|point| point.index));
        let name = free_name(&attribute.name, &taken);
        if let Some(own) = column.other_name(&name) {
            report.rename(own, &name);
        }
        taken.insert(name.clone());
        list.push(Attribute { name, ..attribute });
    }
    list
}

/// What other formats would have twice.
const TAKEN: [&str; 9] =
    ["x", "y", "z", "classification", "intensity", "red", "green", "blue", "red green blue"];

/// A described field may have any name.
fn free_name(name: &str, taken: &HashSet<String>) -> String {
    let numbered = (2..).map(|k| format!("{name}_{k}"));
    let mut names = std::iter::once(name.to_owned()).chain(numbered);
    names.find(|name| !taken.contains(name)).unwrap_or_default()
}

/// Colours in 16 bits; in 8 where none is larger, since some scanners store 0 to 255 in fields of 16 bits.
fn colours(points: &[Point]) -> Values {
    let all = points.iter().flat_map(|point| point.colour);
    let is_small = all.clone().all(|channel| channel <= u16::from(u8::MAX));
    if is_small { Values::U8(all.map(|channel| channel as u8).collect()) } else { Values::U16(all.collect()) }
}

/// The triangles of Delaunay in the plane. The points are all at different places there.
fn triangulate(points: &[Point], scale: [f64; 3]) -> Result<Vec<[u32; 3]>, ReadError> {
    let place = Place::Byte(131);
    let ratio = scale[0] / scale[1];
    if !(1.0 / MAX_SCALE_RATIO..=MAX_SCALE_RATIO).contains(&ratio) {
        let message = format!("scales of {} and {} in the plane", scale[0], scale[1]);
        return Err(ReadError::Unsupported { place, message });
    }
    let lowest = |axis: usize| points.iter().map(|p| i64::from(p.grid[axis])).min().unwrap_or(0);
    let (x0, y0) = (lowest(0), lowest(1));
    // On the grid of the file the triangulation does not depend on rounding.
    let in_plane = |p: &Point| {
        let (x, y) = (i64::from(p.grid[0]) - x0, i64::from(p.grid[1]) - y0);
        Point2::new(x as f64 * ratio, y as f64)
    };
    let plane = points.iter().map(in_plane).collect();
    let bad = |what: String| ReadError::syntax(place, what);
    let triangulation = DelaunayTriangulation::<Point2<f64>>::bulk_load_stable(plane)
        .map_err(|error| bad(format!("cannot be triangulated: {error}")))?;
    if triangulation.num_vertices() != points.len() {
        return Err(bad("cannot be triangulated: points at one place".to_owned()));
    }
    let triangle = |face: [u32; 3]| {
        // The order of faces and their first corners is that of the algorithm.
        let first = (0..3).min_by_key(|&k| face[k]).unwrap_or(0);
        [face[first], face[(first + 1) % 3], face[(first + 2) % 3]]
    };
    let faces = triangulation.inner_faces().map(|face| face.vertices().map(|v| v.fix().index() as u32));
    let mut triangles: Vec<[u32; 3]> = faces.map(triangle).collect();
    triangles.sort_unstable();
    Ok(triangles)
}
