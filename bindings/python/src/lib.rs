//! Python package: the functions and errors of the Rust library, with numpy arrays.

mod error;

mod attributes;
mod interrupt;
mod losses;
mod options;
mod scene;

use error::{DecodeError, EncodeError, decode_error, encode_error};
use lwc::descriptors::Descriptor;
use lwc::losses::Losses;
use lwc::mesh::Attributes;
use lwc::{StreamInfo, TriMesh};
use numpy::{PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

#[pymodule]
mod _lwc {
    #[pymodule_export]
    use super::{DecodeError, Decoder, EncodeError, Update, decode, decode_scene, descriptors, encode, info};

    #[pymodule_export]
    #[allow(non_upper_case_globals)]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}

/// Names of the descriptors.
#[pyfunction]
fn descriptors() -> Vec<&'static str> {
    Descriptor::ALL.into_iter().map(Descriptor::name).collect()
}

/// Encodes a mesh: vertices n × 3, faces m × 3 (counter-clockwise), attributes by name: lwc.Attribute, or arrays of
/// values of vertices. Options are those of `lwc encode`; what is left out has its default. With strict any loss is an
/// error. Returns the stream, bytes with a list of losses.
#[pyfunction]
#[pyo3(signature = (vertices, faces, *, attributes=None, strict=false, **options))]
fn encode<'py>(
    py: Python<'py>,
    vertices: &Bound<'py, PyAny>,
    faces: &Bound<'py, PyAny>,
    attributes: Option<&Bound<'py, PyDict>>,
    strict: bool,
    options: Option<&Bound<'py, PyDict>>,
) -> PyResult<Bound<'py, PyAny>> {
    let options = options::encode(py, options)?;
    let mesh = tri_mesh(py, vertices, faces)?;
    let attributes = attributes.map_or(Ok(Attributes::default()), |dict| attributes::read(py, dict))?;
    let encoded = interrupt::interruptible(py, move |go_on| {
        lwc::encode_with_attributes(&mesh, &attributes, &options, &|_| go_on.check())
    })?;
    let encoded = encoded.map_err(|error| encode_error(py, error))?;
    if strict && !encoded.losses.is_empty() {
        return Err(error::loss_error(py, &encoded.losses));
    }
    losses::stream(py, &encoded.bytes, &encoded.losses)
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

/// Decodes a stream, or the beginning of one. Returns a lwc.Mesh.
#[pyfunction]
#[pyo3(signature = (stream, *, level=None, shrinkage_compensation=true, max_memory=None, max_vertices=None, max_levels=None, max_work=None))]
#[allow(clippy::too_many_arguments)] // Each is a keyword of Python.
fn decode<'py>(
    py: Python<'py>,
    stream: &[u8],
    level: Option<u32>,
    shrinkage_compensation: bool,
    max_memory: Option<u64>,
    max_vertices: Option<u32>,
    max_levels: Option<u32>,
    max_work: Option<u64>,
) -> PyResult<Bound<'py, PyAny>> {
    attributes::mesh(
        py,
        decoded(
            py,
            stream,
            options::decode(level, shrinkage_compensation, max_memory, max_vertices, max_levels, max_work),
        )?,
    )
}

/// Decodes a stream, or the beginning of one, as a lwc.Scene: a mesh alone is a scene of one instance.
#[pyfunction]
#[pyo3(signature = (stream, *, level=None, shrinkage_compensation=true, max_memory=None, max_vertices=None, max_levels=None, max_work=None))]
#[allow(clippy::too_many_arguments)] // Each is a keyword of Python.
fn decode_scene<'py>(
    py: Python<'py>,
    stream: &[u8],
    level: Option<u32>,
    shrinkage_compensation: bool,
    max_memory: Option<u64>,
    max_vertices: Option<u32>,
    max_levels: Option<u32>,
    max_work: Option<u64>,
) -> PyResult<Bound<'py, PyAny>> {
    scene::scene(
        py,
        decoded(
            py,
            stream,
            options::decode(level, shrinkage_compensation, max_memory, max_vertices, max_levels, max_work),
        )?,
    )
}

/// A mesh, its attributes, and what it lacks of the stream.
type Decoded = (TriMesh, Attributes, Losses);

fn decoded(py: Python<'_>, stream: &[u8], options: lwc::DecodeOptions) -> PyResult<Decoded> {
    let decoded = py.detach(|| {
        let mut decoder = lwc::Decoder::with_options(options);
        decoder.push(stream)?;
        let (mesh, attributes) = decoder.preview_with_attributes().ok_or(lwc::DecodeError::NoMesh)?;
        Ok((mesh, attributes, decoder.losses()))
    });
    decoded.map_err(|error| decode_error(py, error))
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
            row.set_item("quantization_bits", pass.quantization_bits)?;
            row.set_item("vertices", pass.vertices)?;
            row.set_item("faces", pass.triangles)?;
            row.set_item("bytes", pass.bytes)?;
            row.set_item("end", pass.end)?;
            Ok(row)
        })
        .collect();
    let [x, y, z] = info.origin();
    let dict = PyDict::new(py);
    dict.set_item("quantization_bits", info.quantization_bits())?;
    dict.set_item("origin", (x, y, z))?;
    dict.set_item("side", info.side())?;
    let [x, y, z] = info.step();
    dict.set_item("step", (x, y, z))?;
    let tuple = |[x, y, z]: [f64; 3]| (x, y, z);
    dict.set_item("lattice_origin", info.lattice().map(|lattice| tuple(lattice.origin)))?;
    dict.set_item("levels", info.finest_level())?;
    dict.set_item("total_bytes", info.total_bytes())?;
    dict.set_item("profile", info.profile().name())?;
    dict.set_item("passes", passes?)?;
    let attributes: PyResult<Vec<_>> = info.attributes().iter().map(|one| attribute_dict(py, one)).collect();
    dict.set_item("attributes", attributes?)?;
    let metadata = PyDict::new(py);
    info.metadata().iter().try_for_each(|(key, text)| metadata.set_item(key, text))?;
    dict.set_item("metadata", metadata)?;
    Ok(dict)
}

fn attribute_dict<'py>(py: Python<'py>, attribute: &lwc::AttributeInfo) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("name", &attribute.name)?;
    dict.set_item("semantic", attribute.semantic.name())?;
    dict.set_item("set_index", attribute.semantic.set_index())?;
    dict.set_item("domain", attributes::domain(attribute.domain))?;
    dict.set_item("components", attribute.num_components)?;
    dict.set_item("bits", attribute.bits)?;
    Ok(dict)
}

/// What one finished pass changed. Indices of vertices and faces never move.
#[pyclass(frozen, get_all)]
struct Update {
    /// base, split or refine.
    kind: &'static str,
    level: u32,
    quantization_bits: u32,
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
        let Self { kind, level, quantization_bits, vertices, faces, .. } = self;
        format!("Update({kind}: level {level}, {quantization_bits} bits, {vertices} vertices, {faces} faces)")
    }
}

impl From<lwc::Update> for Update {
    fn from(update: lwc::Update) -> Self {
        let pair = |range: std::ops::Range<u32>| (range.start, range.end);
        Self {
            kind: update.pass.kind.name(),
            level: update.pass.level,
            quantization_bits: update.pass.quantization_bits,
            vertices: update.pass.vertices,
            faces: update.pass.triangles,
            end: update.pass.end,
            changed_vertices: pair(update.vertices),
            new_faces: pair(update.new_triangles),
            rewritten_faces: update.rewritten_triangles.into_iter().map(pair).collect(),
        }
    }
}

/// Decodes a stream as it arrives.
// In a separate box: Python's memory is aligned to 16 bytes, and a decoder wants 128.
#[pyclass]
struct Decoder(Box<lwc::Decoder>);

#[pymethods]
impl Decoder {
    #[new]
    #[pyo3(signature = (*, level=None, shrinkage_compensation=true, max_memory=None, max_vertices=None, max_levels=None, max_work=None))]
    fn new(
        level: Option<u32>,
        shrinkage_compensation: bool,
        max_memory: Option<u64>,
        max_vertices: Option<u32>,
        max_levels: Option<u32>,
        max_work: Option<u64>,
    ) -> Self {
        let options =
            options::decode(level, shrinkage_compensation, max_memory, max_vertices, max_levels, max_work);
        Self(Box::new(lwc::Decoder::with_options(options)))
    }

    /// Takes the next bytes, however they are cut, and applies every pass that is complete.
    fn push(&mut self, py: Python<'_>, piece: &[u8]) -> PyResult<Vec<Update>> {
        let updates = py.detach(|| self.0.push(piece)).map_err(|error| decode_error(py, error))?;
        Ok(updates.into_iter().map(Update::from).collect())
    }

    /// The finest complete mesh, a lwc.Mesh; None before the base mesh. Attributes are collected anew by each call,
    /// unless they are not wanted.
    #[pyo3(signature = (*, attributes=true))]
    fn mesh<'py>(&self, py: Python<'py>, attributes: bool) -> PyResult<Option<Bound<'py, PyAny>>> {
        let found = if attributes {
            self.0.to_tri_mesh_with_attributes()
        } else {
            self.0.mesh().map(|mesh| (mesh.to_tri_mesh(), Attributes::default()))
        };
        let found = found.map(|(mesh, attributes)| (mesh, attributes, self.0.losses()));
        found.map(|found| attributes::mesh(py, found)).transpose()
    }

    /// Information about the stream; None before its table of passes has arrived.
    fn info<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        self.0.info().map(|info| info_dict(py, info)).transpose()
    }

    /// What the mesh lacks of what the stream holds, a list of lwc.Loss; empty once all has come.
    #[getter]
    fn losses<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, pyo3::types::PyList>> {
        losses::list(py, &self.0.losses())
    }

    /// Checksum of the mesh, equal on every platform; None before the base mesh.
    fn checksum(&self) -> Option<u32> {
        self.0.mesh().map(|mesh| mesh.checksum())
    }

    /// Checksum of the values of all attributes, equal on every platform; 0 without any.
    fn attribute_checksum(&self) -> u32 {
        self.0.attribute_checksum()
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
