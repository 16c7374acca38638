//! Meshes with attributes.

use super::*;
use lwc::mesh::{Attribute, Attributes, ComponentType, Domain, NO_ENTRY, Semantic, Values};

pub fn all(list: Vec<Attribute>) -> Attributes {
    let mut attributes = Attributes::default();
    attributes.list = list;
    attributes
}

pub fn positions(mesh: &TriMesh) -> impl Iterator<Item = [f64; 3]> + '_ {
    mesh.positions().iter().copied()
}

pub fn colours(mesh: &TriMesh) -> Attribute {
    let values = positions(mesh).flat_map(|p| p.map(|x| (127.0 + 60.0 * (2.0 * x).sin()) as u8)).collect();
    Attribute::new("red green blue", Semantic::Color(0), Domain::Vertex, 3, Values::U8(values))
}

/// A torus of n × m cut open into one rectangle: seams along both circles, which meet once.
pub fn atlas(n: u32, m: u32) -> (TriMesh, Attribute) {
    let mesh = torus(n, m);
    let mut values = Vec::new();
    for triangle in mesh.triangles() {
        let places = triangle.map(|v| [v / m, v % m]);
        for [i, j] in places {
            let round = |x: u32, k: usize, all: u32| {
                let is_far = places.iter().any(|p| p[k] == all - 1);
                f64::from(if x == 0 && is_far { all } else { x }) / f64::from(all)
            };
            values.extend([round(i, 0, n) as f32, round(j, 1, m) as f32]);
        }
    }
    let uv = Attribute::new("texcoord", Semantic::TexCoord(0), Domain::Corner, 2, Values::F32(values));
    (mesh, uv)
}

pub fn flat_normals(mesh: &TriMesh) -> Attribute {
    let mut values = Vec::new();
    for t in mesh.triangles() {
        let [a, b, c] = t.map(|v| mesh.positions()[v as usize]);
        let (u, v) = ([b[0] - a[0], b[1] - a[1], b[2] - a[2]], [c[0] - a[0], c[1] - a[1], c[2] - a[2]]);
        let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        let length = n.iter().map(|x| x * x).sum::<f64>().sqrt();
        (0..3).for_each(|_| values.extend(n.map(|x| (x / length) as f32)));
    }
    Attribute::new("vn", Semantic::Normal, Domain::Corner, 3, Values::F32(values))
}

pub fn materials(mesh: &TriMesh) -> Attribute {
    let names = ["north", "south", "middle"].map(String::from).to_vec();
    let centre = |t: &[u32; 3]| t.iter().map(|&v| mesh.positions()[v as usize][2]).sum::<f64>() / 3.0;
    let index = |z: f64| {
        if z > 0.3 {
            0
        } else if z < -0.3 {
            1
        } else {
            2
        }
    };
    let indices = mesh.triangles().iter().map(|t| index(centre(t))).collect();
    Attribute {
        indices: Some(indices),
        ..Attribute::new("usemtl", Semantic::Material, Domain::Triangle, 1, Values::Names(names))
    }
}

/// Directions at vertices, as floats and as bytes.
pub fn vertex_normals(mesh: &TriMesh) -> Vec<Attribute> {
    let length = |p: [f64; 3]| p.iter().map(|x| x * x).sum::<f64>().sqrt();
    let unit = positions(mesh).map(|[x, y, z]| [x.sin(), (0.7 * y).cos() - 0.5, 0.3 + z]);
    let unit: Vec<f64> = unit.flat_map(|p| p.map(|x| x / length(p))).collect();
    let floats = Values::F32(unit.iter().map(|&x| x as f32).collect());
    let bytes = Values::I8(unit.iter().map(|&x| (x * 127.0).round() as i8).collect());
    let normal = |name, values| Attribute::new(name, Semantic::Normal, Domain::Vertex, 3, values);
    vec![normal("NORMAL", floats), Attribute { is_normalized: true, ..normal("packed", bytes) }]
}

/// Two to four channels of different kinds and types.
pub fn of_many_channels(mesh: &TriMesh) -> Vec<Attribute> {
    let list = |f: &dyn Fn([f64; 3]) -> Vec<f64>| positions(mesh).flat_map(f).collect::<Vec<f64>>();
    let rgba = list(&|[x, y, z]| vec![x.sin(), y.cos(), z, 0.5 * x - 0.2 * y]);
    let rgba = Values::U16(rgba.iter().map(|x| (20000.0 + 9000.0 * x) as u16).collect());
    let layers = list(&|[x, y, z]| vec![0.1 * x, 0.1 * y, z]);
    let ramp = list(&|[x, _, z]| vec![x + z]);
    let ways = Values::I16(list(&|[x, y, _]| vec![90.0 * x, -50.0 * y]).iter().map(|&x| x as i16).collect());
    let few = Values::F64(list(&|[x, y, _]| vec![(x + y).round() * 0.1, 1e300]));
    let vertex = |name, semantic, n, values| Attribute::new(name, semantic, Domain::Vertex, n, values);
    vec![
        vertex("rgba", Semantic::Color(1), 4, rgba),
        vertex("layers", Semantic::TexCoord(0), 3, Values::F64(layers)),
        vertex("ramp", Semantic::TexCoord(3), 1, Values::F32(ramp.iter().map(|&x| x as f32).collect())),
        vertex("ways", Semantic::Generic, 2, ways),
        vertex("few", Semantic::Generic, 2, few),
    ]
}

/// Of corners, with seams and gaps anywhere, and of faces.
pub fn torn(mesh: &TriMesh) -> Vec<Attribute> {
    let at = |corner: usize| mesh.positions()[mesh.triangles()[corner / 3][corner % 3] as usize];
    let side = |corner: usize| (at(corner / 3 * 3)[0] * 3.0).sin() > 0.4;
    let corners = 0..3 * mesh.num_triangles();
    let place = |c| if side(c) { [at(c)[0], at(c)[1]] } else { [at(c)[1] + 5.0, at(c)[2]] };
    let places = corners.clone().flat_map(|c| place(c).map(|x| x as f32)).collect();
    let rows = corners.map(|c| if c % 41 < 5 { NO_ENTRY } else { c as u32 }).collect();
    let uv = Attribute::new("torn", Semantic::TexCoord(0), Domain::Corner, 2, Values::F32(places));
    let heights = (0..mesh.num_triangles()).map(|t| (10.0 * at(3 * t)[2]) as i32).collect();
    let heights = Attribute::new("heights", Semantic::Group, Domain::Triangle, 1, Values::I32(heights));
    let spread = (0..mesh.num_vertices()).map(|v| (v % 5) as u8 * 60).collect();
    let spread = Attribute::new("spread", Semantic::Generic, Domain::Vertex, 1, Values::U8(spread));
    vec![Attribute { indices: Some(rows), ..uv }, heights, spread]
}

/// Numbers of all types for the elements of a mesh: small, large, far apart, and those that are no numbers.
pub fn nasty(
    mesh: &TriMesh,
    domain: Domain,
    scalar: ComponentType,
    semantic: Semantic,
    seed: u64,
) -> Attribute {
    let mut random = Random(seed);
    let num_components = if semantic == Semantic::Normal { 3 } else { 1 + seed as usize % 4 };
    let mut values = Values::new(scalar);
    let count = domain.num_elements(mesh);
    let has_no_numbers = seed.is_multiple_of(2);
    for k in 0..count * num_components {
        let bits = match (scalar, random.next() % 8) {
            (ComponentType::F32, 0) => u64::from((-0.0_f32).to_bits()),
            (ComponentType::F32, 1) => {
                u64::from(f32::from_bits(random.next() as u32 & 0x007f_ffff).to_bits())
            }
            (ComponentType::F32, 2) if has_no_numbers => 0x7fc0_0001 + random.next() % 9,
            (ComponentType::F32, 3) if has_no_numbers => u64::from(f32::NEG_INFINITY.to_bits()),
            (ComponentType::F32, 4) => u64::from((0.001 * (k % 1000) as f32).to_bits()),
            (ComponentType::F32, _) => u64::from((random.unit() as f32).to_bits()),
            (ComponentType::F64, 0) => (-0.0_f64).to_bits(),
            (ComponentType::F64, 1) => random.next() & 0x000f_ffff_ffff_ffff,
            (ComponentType::F64, 2) if has_no_numbers => f64::NAN.to_bits() | (random.next() % 99),
            (ComponentType::F64, 3) if has_no_numbers => f64::MAX.to_bits(),
            (ComponentType::F64, _) => (random.unit() * 1e6).to_bits(),
            (ComponentType::U32 | ComponentType::I32, _) => random.next() >> 32 >> (seed % 2 * 20),
            (scalar, _) => random.next() & (u64::MAX >> (64 - 8 * scalar.num_bytes())),
        };
        values.push_bits(bits);
    }
    let indices = seed.is_multiple_of(3).then(|| {
        let index = |k: u32| if random.next().is_multiple_of(5) { NO_ENTRY } else { k };
        (0..count as u32).map(index).collect()
    });
    let name = format!("{scalar:?} of {domain}");
    Attribute { indices, ..Attribute::new(name, semantic, domain, num_components, values) }
}

/// Directions from the origin, as floats and as doubles.
pub fn smooth_normals(mesh: &TriMesh) -> [Attribute; 2] {
    let unit = |p: [f64; 3]| {
        let length = p.iter().map(|x| x * x).sum::<f64>().sqrt();
        p.map(|x| x / length)
    };
    let doubles: Vec<f64> = positions(mesh).flat_map(unit).collect();
    let floats = doubles.iter().map(|&x| x as f32).collect();
    [Values::F32(floats), Values::F64(doubles)]
        .map(|values| Attribute::new("n", Semantic::Normal, Domain::Vertex, 3, values))
}
