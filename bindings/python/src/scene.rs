//! Scenes: `lwc.Scene` of Python from that of the library.

use crate::attributes::{class, mesh};
use crate::error::scene_error;
use lwc::TriMesh;
use lwc::io::{MeshFile, Scene};
use lwc::losses::Losses;
use lwc::mesh::{Attributes, IDENTITY, Instance};
use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyList};

/// A `lwc.Scene`. What is no scene is one mesh that is where its coordinates say.
pub fn scene<'py>(
    py: Python<'py>,
    (tri_mesh, mut attributes, losses): (TriMesh, Attributes, Losses),
) -> PyResult<Bound<'py, PyAny>> {
    let unpacked = py.detach(|| Scene::unpack(&tri_mesh, &attributes));
    let unpacked = unpacked.map_err(|error| scene_error(py, error))?;
    let metadata = PyDict::new(py);
    attributes.metadata.iter().try_for_each(|(key, text)| metadata.set_item(key, text))?;
    let materials = attributes.gltf_materials.take().unwrap_or_default();
    let (meshes, instances): (Vec<_>, _) = match unpacked {
        Some(scene) => {
            let one = |file: MeshFile| (file.mesh, file.attributes, losses.clone());
            let meshes = scene.meshes.into_iter().map(one).collect();
            (meshes, scene.instances)
        }
        None => {
            let alone = Instance { mesh: 0, name: String::new(), transform: IDENTITY };
            (vec![(tri_mesh, attributes, losses)], vec![alone])
        }
    };
    let meshes: PyResult<Vec<_>> = meshes.into_iter().map(|one| mesh(py, one)).collect();
    let instances: PyResult<Vec<_>> = instances.into_iter().map(|one| instance(py, one)).collect();
    let json = (!materials.json.is_empty()).then_some(materials.json);
    let images = materials.images.iter().map(|image| PyBytes::new(py, image));
    class(py, "Scene")?.call1((
        PyList::new(py, meshes?)?,
        PyList::new(py, instances?)?,
        json,
        PyList::new(py, images.collect::<Vec<_>>())?,
        metadata,
    ))
}

fn instance<'py>(py: Python<'py>, instance: Instance) -> PyResult<Bound<'py, PyAny>> {
    let mut rows = instance.transform.as_flattened().to_vec();
    rows.extend([0.0, 0.0, 0.0, 1.0]);
    let transform = rows.into_pyarray(py).call_method1("reshape", ((4, 4),))?;
    class(py, "Instance")?.call1((instance.mesh, instance.name, transform))
}
