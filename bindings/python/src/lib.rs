//! Python package: the functions and errors of the Rust library, with numpy arrays.

mod error;

use error::{DecodeError, EncodeError, decode_error, encode_error, option_error};
use lwc::descriptors::{Descriptor, Window};
use lwc::{DecodeOptions, EncodeOptions, Limits, Optimize, Partition, StreamInfo, TriMesh};
use numpy::{IntoPyArray, PyArray2, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

type Arrays<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<u32>>);

#[pymodule]
mod _lwc {
    #[pymodule_export]
    use super::{DecodeError, Decoder, EncodeError, Update, decode, descriptors, encode, info};

    #[pymodule_export]
    #[allow(non_upper_case_globals)]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}

/// Names of the descriptors.
#[pyfunction]
fn descriptors() -> Vec<&'static str> {
    Descriptor::ALL.into_iter().map(Descriptor::name).collect()
}

/// Encodes a mesh: vertices n × 3, faces m × 3 (counter-clockwise). What is left out has the default of
/// `lwc encode`. Returns the stream.
#[pyfunction]
#[pyo3(signature = (vertices, faces, *, descriptor=None, quantization=None, levels=None, rings=None,
    radius=None, growth=None, partition=None, optimize=None, steps_per_edge=None,
    lossless=false, keep_order=false, keep_isolated=false, keep_degenerate=false))]
#[allow(clippy::too_many_arguments)] // They are keywords in Python.
fn encode<'py>(
    py: Python<'py>,
    vertices: &Bound<'py, PyAny>,
    faces: &Bound<'py, PyAny>,
    descriptor: Option<&str>,
    quantization: Option<u32>,
    levels: Option<u32>,
    rings: Option<u32>,
    radius: Option<f64>,
    growth: Option<f64>,
    partition: Option<&str>,
    optimize: Option<&str>,
    steps_per_edge: Option<f64>,
    lossless: bool,
    keep_order: bool,
    keep_isolated: bool,
    keep_degenerate: bool,
) -> PyResult<Bound<'py, pyo3::types::PyBytes>> {
    let mut options = EncodeOptions::default();
    if let Some(name) = descriptor {
        options.descriptor = name.parse().map_err(|_| option_error(py, "descriptor", name))?;
    }
    if let Some(name) = partition {
        let found = Partition::ALL.into_iter().find(|partition| partition.name() == name);
        options.partition = found.ok_or_else(|| option_error(py, "partition", name))?;
    }
    if let Some(name) = optimize {
        let found = Optimize::ALL.into_iter().find(|optimize| optimize.name() == name);
        options.optimize = found.ok_or_else(|| option_error(py, "optimize", name))?;
    }
    let Window { rings: default_rings, radius: default_radius } = options.window;
    options.window =
        Window { rings: rings.unwrap_or(default_rings), radius: radius.unwrap_or(default_radius) };
    options.quantization = quantization.unwrap_or(options.quantization);
    options.levels = levels.or(options.levels);
    options.growth = growth.unwrap_or(options.growth);
    options.steps_per_edge = steps_per_edge.or(options.steps_per_edge);
    options.lossless = lossless;
    options.keep_order = keep_order;
    options.keep_isolated = keep_isolated;
    options.keep_degenerate = keep_degenerate;

    let mesh = tri_mesh(py, vertices, faces)?;
    let encoded = py.detach(|| lwc::encode(&mesh, &options)).map_err(|error| encode_error(py, error))?;
    Ok(pyo3::types::PyBytes::new(py, &encoded.bytes))
}

/// Numbers of any type in any layout, as numpy would convert them.
fn tri_mesh<'py>(
    py: Python<'py>,
    vertices: &Bound<'py, PyAny>,
    faces: &Bound<'py, PyAny>,
) -> PyResult<TriMesh> {
    let numpy = py.import("numpy")?;
    let vertices = numpy.call_method1("ascontiguousarray", (vertices, "float64"))?;
    let vertices: PyReadonlyArray2<f64> = vertices.extract()?;
    let faces = numpy.call_method1("ascontiguousarray", (faces, "int64"))?;
    let faces: PyReadonlyArray2<i64> = faces.extract()?;
    for (name, width) in [("vertices", vertices.shape()[1]), ("faces", faces.shape()[1])] {
        if width != 3 {
            let sentence = format!("{name} must have 3 columns, not {width}");
            return Err(pyo3::exceptions::PyValueError::new_err(sentence));
        }
    }
    let positions = vertices.as_slice()?.as_chunks::<3>().0.to_vec();
    // An index that does not fit is out of range, and said to be.
    let index = |v: i64| u32::try_from(v).unwrap_or(u32::MAX);
    let triangles = faces.as_slice()?.as_chunks::<3>().0.iter().map(|t| t.map(index)).collect();
    TriMesh::new(positions, triangles).map_err(|error| error::mesh_error(py, error))
}

fn decode_options(level: Option<u32>, max_memory: Option<u64>, max_vertices: Option<u32>) -> DecodeOptions {
    let default = Limits::default();
    let options = DecodeOptions::new().limits(Limits {
        max_memory: max_memory.unwrap_or(default.max_memory),
        max_vertices: max_vertices.unwrap_or(default.max_vertices),
        ..default
    });
    level.map_or(options, |level| options.level(level))
}

fn arrays<'py>(py: Python<'py>, mesh: TriMesh) -> PyResult<Arrays<'py>> {
    let (positions, triangles) = mesh.into_parts();
    let vertices = positions.into_flattened().into_pyarray(py);
    let faces = triangles.into_flattened().into_pyarray(py);
    let shaped = |array: &Bound<'py, PyAny>| array.call_method1("reshape", (-1, 3));
    Ok((shaped(vertices.as_any())?.cast_into()?, shaped(faces.as_any())?.cast_into()?))
}

/// Decodes a stream, or the beginning of one. Returns vertices (n × 3, float64) and faces (m × 3, uint32).
#[pyfunction]
#[pyo3(signature = (stream, *, level=None, max_memory=None, max_vertices=None))]
fn decode<'py>(
    py: Python<'py>,
    stream: &[u8],
    level: Option<u32>,
    max_memory: Option<u64>,
    max_vertices: Option<u32>,
) -> PyResult<Arrays<'py>> {
    let options = decode_options(level, max_memory, max_vertices);
    let mesh = py.detach(|| lwc::decode(stream, options)).map_err(|error| decode_error(py, error))?;
    arrays(py, mesh)
}

/// What a stream says of itself; None if its table of passes has not come yet. Nothing is decoded.
#[pyfunction]
fn info<'py>(py: Python<'py>, stream: &[u8]) -> PyResult<Option<Bound<'py, PyDict>>> {
    let info = StreamInfo::read(stream).map_err(|error| decode_error(py, error))?;
    info.map(|info| info_dict(py, &info)).transpose()
}

fn info_dict<'py>(py: Python<'py>, info: &StreamInfo) -> PyResult<Bound<'py, PyDict>> {
    let passes: PyResult<Vec<_>> = info
        .passes()
        .iter()
        .map(|pass| {
            let row = PyDict::new(py);
            row.set_item("kind", pass.kind.name())?;
            row.set_item("level", pass.level)?;
            row.set_item("precision", pass.precision)?;
            row.set_item("vertices", pass.vertices)?;
            row.set_item("faces", pass.faces)?;
            row.set_item("bytes", pass.bytes)?;
            row.set_item("end", pass.end)?;
            Ok(row)
        })
        .collect();
    let [x, y, z] = info.origin();
    let dict = PyDict::new(py);
    dict.set_item("precision", info.precision())?;
    dict.set_item("origin", (x, y, z))?;
    dict.set_item("side", info.side())?;
    dict.set_item("levels", info.finest_level())?;
    dict.set_item("total_bytes", info.total_bytes())?;
    dict.set_item("passes", passes?)?;
    Ok(dict)
}

/// What one finished pass changed. Indices of vertices and faces never move.
#[pyclass(frozen, get_all)]
struct Update {
    /// base, split or refine.
    kind: &'static str,
    level: u32,
    precision: u32,
    vertices: u32,
    faces: u32,
    /// Bytes of the stream up to the end of the pass.
    end: u64,
    /// First and end of the vertices that are new or have moved.
    changed_vertices: (u32, u32),
    /// First and end of the faces that are new.
    new_faces: (u32, u32),
    /// First and end of each run of older faces with other vertices.
    rewritten_faces: Vec<(u32, u32)>,
}

#[pymethods]
impl Update {
    fn __repr__(&self) -> String {
        let Self { kind, level, precision, vertices, faces, .. } = self;
        format!("Update({kind}: level {level}, {precision} bits, {vertices} vertices, {faces} faces)")
    }
}

impl From<lwc::Update> for Update {
    fn from(update: lwc::Update) -> Self {
        let pair = |range: std::ops::Range<u32>| (range.start, range.end);
        Self {
            kind: update.pass.kind.name(),
            level: update.pass.level,
            precision: update.pass.precision,
            vertices: update.pass.vertices,
            faces: update.pass.faces,
            end: update.pass.end,
            changed_vertices: pair(update.vertices),
            new_faces: pair(update.new_triangles),
            rewritten_faces: update.rewritten_triangles.into_iter().map(pair).collect(),
        }
    }
}

/// Decodes a stream as it arrives.
#[pyclass]
struct Decoder(lwc::Decoder);

#[pymethods]
impl Decoder {
    #[new]
    #[pyo3(signature = (*, level=None, max_memory=None, max_vertices=None))]
    fn new(level: Option<u32>, max_memory: Option<u64>, max_vertices: Option<u32>) -> Self {
        Self(lwc::Decoder::with_options(decode_options(level, max_memory, max_vertices)))
    }

    /// Takes the next bytes, however they are cut, and applies every pass that is complete.
    fn push(&mut self, py: Python<'_>, piece: &[u8]) -> PyResult<Vec<Update>> {
        let updates = py.detach(|| self.0.push(piece)).map_err(|error| decode_error(py, error))?;
        Ok(updates.into_iter().map(Update::from).collect())
    }

    /// Vertices and faces of the finest complete mesh; None before the base mesh.
    fn mesh<'py>(&self, py: Python<'py>) -> PyResult<Option<Arrays<'py>>> {
        self.0.mesh().map(|mesh| arrays(py, mesh.to_tri_mesh())).transpose()
    }

    /// What the stream says of itself; None before its table of passes has come.
    fn info<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        self.0.info().map(|info| info_dict(py, info)).transpose()
    }

    /// Checksum of the mesh, equal on every platform; None before the base mesh.
    fn checksum(&self) -> Option<u32> {
        self.0.mesh().map(|mesh| mesh.checksum())
    }

    /// True once the last pass of the stream, or of the wanted level, has been applied.
    #[getter]
    fn is_complete(&self) -> bool {
        self.0.is_complete()
    }

    /// Number of passes applied.
    #[getter]
    fn passes_done(&self) -> usize {
        self.0.passes_done()
    }
}
