//! CPU time over size on meshes that are hard on algorithms, beside a regular grid.
//!
//! ```text
//! cargo bench --bench pathological                                # all meshes, all operations
//! cargo bench --bench pathological -- --only fan --operation encode
//! cargo bench --bench pathological -- --faces 50000 --svg times.svg
//! ```
//!
//! For each operation a table: seconds with half of the faces and with all of them on one thread, how often the grid's
//! that is, and by how much twice the faces take longer. `--svg` draws how the time of `encode` grows.

#![allow(missing_docs)]

mod meshes;

use lwc::descriptors::{self, Descriptor, Window};
use lwc::metrics::{CompareOptions, compare};

use lwc::render::{Camera, Chart, Paint, Series, Style, Up, View, log_ticks, render};
use lwc::{DecodeOptions, EncodeOptions, Optimize, Partition, TriMesh};
use meshes::{ALL, GRID, Generator};
use std::time::Duration;

/// One thing done to a mesh. What it needs is made by `prepare`, which is not measured.
struct Operation {
    name: &'static str,
    prepare: fn(&TriMesh) -> TriMesh,
    run: fn(&TriMesh, &TriMesh),
}

const OPERATIONS: [Operation; 14] = [
    alone("encode", |mesh, _| encode(mesh, |_| ())),
    alone("encode --partition algorithm1", |mesh, _| encode(mesh, |o| o.partition = Partition::Algorithm1)),
    alone("encode -d nfv", |mesh, _| encode(mesh, |o| o.descriptor = Descriptor::Nfv)),
    alone("encode -d pca-qem", |mesh, _| encode(mesh, |o| o.descriptor = Descriptor::PcaQem)),
    alone("encode --lossless --keep-order", |mesh, _| {
        encode(mesh, |o| (o.lossless, o.keep_order) = (true, true));
    }),
    alone("encode --optimize size", |mesh, _| encode(mesh, |o| o.optimize = Optimize::Size)),
    alone("describe", |mesh, _| describe(mesh, Descriptor::default())),
    alone("describe -d nfv", |mesh, _| describe(mesh, Descriptor::Nfv)),
    alone("describe -d pca-qem", |mesh, _| describe(mesh, Descriptor::PcaQem)),
    alone("compare with itself", |mesh, _| compare_both(mesh, mesh)),
    Operation { name: "compare with its stream", prepare: decoded, run: compare_both },
    Operation { name: "compare with a sphere around it", prepare: sphere_around, run: compare_both },
    Operation { name: "compare with a tiny one in it", prepare: tiny_in_the_middle, run: compare_both },
    alone("render", |mesh, _| {
        let camera = Camera::fit(mesh, View::default(), Up::Z, 800, 600);
        render(mesh, Paint::Plain, &camera, &Style::default()).expect("a picture");
    }),
];

const fn alone(name: &'static str, run: fn(&TriMesh, &TriMesh)) -> Operation {
    Operation { name, prepare: |_| TriMesh::default(), run }
}

fn encode(mesh: &TriMesh, set: impl Fn(&mut EncodeOptions)) {
    let mut options = EncodeOptions::default();
    set(&mut options);
    lwc::encode(mesh, &options).expect("an encodable mesh");
}

fn describe(mesh: &TriMesh, descriptor: Descriptor) {
    let mean_edge = descriptors::mean_edge_length(mesh);
    descriptors::evaluate(descriptor, mesh, &Window::default(), mean_edge);
}

fn decoded(mesh: &TriMesh) -> TriMesh {
    let stream = lwc::encode(mesh, &EncodeOptions::default()).expect("an encodable mesh");
    lwc::decode(&stream.bytes, DecodeOptions::new()).expect("a sound stream")
}

/// As far from any point of the mesh in all directions.
fn sphere_around(mesh: &TriMesh) -> TriMesh {
    let (low, high) = mesh.bounding_box().expect("vertices");
    let middle = [0, 1, 2].map(|k| (low[k] + high[k]) / 2.0);
    let radius = 50.0 * (0..3).map(|k| high[k] - low[k]).fold(1e-3, f64::max);
    let sphere = meshes::sphere(mesh.num_triangles().max(12));
    let place = |p: &[f64; 3]| [0, 1, 2].map(|k| middle[k] + radius * p[k]);
    TriMesh::new(sphere.positions().iter().map(place).collect(), sphere.triangles().to_vec())
        .expect("a valid mesh")
}

/// About as far from all points of a round mesh.
fn tiny_in_the_middle(mesh: &TriMesh) -> TriMesh {
    let (low, high) = mesh.bounding_box().expect("vertices");
    let size = 1e-3 * (0..3).map(|k| high[k] - low[k]).fold(1e-3, f64::max);
    let at = |corner: [f64; 3]| [0, 1, 2].map(|k| (low[k] + high[k]) / 2.0 + size * corner[k]);
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(at);
    TriMesh::new(corners.to_vec(), vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]).expect("a valid mesh")
}

fn compare_both(a: &TriMesh, b: &TriMesh) {
    compare(a, b, &CompareOptions::new()).expect("vertices");
}

/// CPU time of this process.
#[cfg(unix)]
fn now() -> Duration {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Duration::new(time.tv_sec as u64, time.tv_nsec as u32)
}

/// The clock on the wall, where there is no other.
#[cfg(not(unix))]
fn now() -> Duration {
    static START: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    START.get_or_init(std::time::Instant::now).elapsed()
}

/// Seconds of CPU: the least of several runs, of few if they take long.
fn seconds(operation: &Operation, mesh: &TriMesh) -> f64 {
    let other = (operation.prepare)(mesh);
    let mut least = f64::INFINITY;
    let mut total = 0.0;
    for _ in 0..5 {
        let before = now();
        (operation.run)(mesh, &other);
        let spent = (now() - before).as_secs_f64();
        least = least.min(spent);
        total += spent;
        if total > 1.0 {
            break;
        }
    }
    least
}

struct Arguments {
    faces: usize,
    only: Vec<String>,
    operations: Vec<String>,
    svg: Option<String>,
}

fn arguments() -> Arguments {
    let mut all = Arguments { faces: 50_000, only: Vec::new(), operations: Vec::new(), svg: None };
    let mut words = std::env::args().skip(1).filter(|word| word != "--bench");
    while let Some(word) = words.next() {
        let value = words.next().unwrap_or_else(|| panic!("{word} needs a value"));
        match &word[..] {
            "--faces" => all.faces = value.parse().expect("a number of faces"),
            "--only" => all.only.push(value),
            "--operation" => all.operations.push(value),
            "--svg" => all.svg = Some(value),
            _ => panic!("unknown option {word}: there are --faces, --only, --operation and --svg"),
        }
    }
    all
}

/// More than so many seconds with a quarter of the faces: the rest would take too long.
const TOO_LONG: f64 = 8.0;

/// One line: seconds with half of the faces and with all, beside the grid's, and how they grow.
fn print_line(operation: &Operation, (name, make): (&str, Generator), faces: usize, grid: f64) -> f64 {
    let quarter = seconds(operation, &make(faces / 4));
    if quarter > TOO_LONG {
        println!("{name:<26} {quarter:>9.3} with a quarter of the faces: too long");
        return f64::INFINITY;
    }
    let half = seconds(operation, &make(faces / 2));
    let whole = seconds(operation, &make(faces));
    let ratio = if grid.is_nan() { 1.0 } else { whole / grid };
    println!("{name:<26} {half:>9.4} {whole:>9.4} {ratio:>9.2} {:>9.2}", whole / half);
    whole
}

fn is_wanted(name: &str, wanted: &[String]) -> bool {
    wanted.is_empty() || wanted.iter().any(|w| w == name)
}

/// Time of `encode` over the number of faces, for all meshes.
fn chart(faces: usize, only: &[String]) -> Chart {
    let sizes: Vec<usize> = (0..6).rev().map(|k| faces >> k).collect();
    let kinds = std::iter::once(GRID).chain(ALL.into_iter().filter(|(name, _)| is_wanted(name, only)));
    let mut series = Vec::new();
    for (i, (name, make)) in kinds.enumerate() {
        let time = |&n: &usize| ((n as f64).log10(), seconds(&OPERATIONS[0], &make(n)).log10());
        let points = sizes.iter().map(time).collect();
        let hue = [i * 97 % 200, i * 57 % 200, i * 151 % 200].map(|c| c as u8);
        series.push(Series { name: name.into(), points, colour: hue });
    }
    let times = series.iter().flat_map(|s: &Series| &s.points).map(|&(_, y)| y);
    let [low, high] =
        times.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], y| [low.min(y), high.max(y)]);
    Chart {
        title: "Time of encode over faces".into(),
        labels: ["faces".into(), "log10 of CPU seconds".into()],
        x_range: [(sizes[0] as f64).log10() - 0.9, (faces as f64).log10() + 0.05],
        x_ticks: log_ticks(sizes[0] as f64, faces as f64, |n| format!("{n}")),
        y_range: [low - 0.1, high + 0.1],
        series,
    }
}

fn main() {
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().expect("one thread");
    let Arguments { faces, only, operations, svg } = arguments();
    for operation in OPERATIONS.iter().filter(|o| is_wanted(o.name, &operations)) {
        println!("\n{:<26} {:>9} {:>9} {:>9} {:>9}", operation.name, faces / 2, faces, "× grid", "× half");
        let grid = print_line(operation, GRID, faces, f64::NAN);
        for kind in ALL.into_iter().filter(|(name, _)| is_wanted(name, &only)) {
            print_line(operation, kind, faces, grid);
        }
    }
    if let Some(path) = svg {
        let svg = chart(faces, &only).to_svg().expect("a chart");
        std::fs::write(&path, svg).unwrap_or_else(|error| panic!("{path}: {error}"));
    }
}
