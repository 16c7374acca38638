//! Attributes: `lwc.Attribute` of Python and that of the library.

use crate::losses;
use lwc::TriMesh;
use lwc::losses::Losses;
use lwc::mesh::{Attribute, Attributes, Domain, NO_ENTRY, Semantic, Values};
use numpy::{Element, IntoPyArray, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

const DOMAINS: [(&str, Domain); 3] =
    [("vertex", Domain::Vertex), ("corner", Domain::Corner), ("face", Domain::Triangle)];

fn from_python(semantic: &str, set_index: u32) -> PyResult<Semantic> {
    Ok(match semantic {
        "normal" => Semantic::Normal,
        "texcoord" => Semantic::TexCoord(set_index),
        "color" => Semantic::Color(set_index),
        "material" => Semantic::Material,
        "group" => Semantic::Group,
        "object" => Semantic::Object,
        "generic" => Semantic::Generic,
        _ => {
            return Err(PyValueError::new_err(format!(
                "there is no semantic {semantic}: use normal, texcoord, color, material, group, object or generic"
            )));
        }
    })
}

pub fn domain(domain: Domain) -> &'static str {
    DOMAINS.iter().find(|(_, other)| *other == domain).map_or("vertex", |(name, _)| name)
}

/// A class of the Python part of the package.
pub fn class<'py>(py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
    py.import("lwc._types")?.getattr(name)
}

/// The attributes of a dict: name to `lwc.Attribute`, or to an array of values of vertices.
pub fn read(py: Python<'_>, dict: &Bound<'_, PyDict>) -> PyResult<Attributes> {
    let class = class(py, "Attribute")?;
    let mut attributes = Attributes::default();
    for (name, item) in dict {
        let item = class.call_method1("of", (item,))?;
        let semantic: String = item.getattr("semantic")?.extract()?;
        let domain: String = item.getattr("domain")?.extract()?;
        let domain = DOMAINS.iter().find(|(other, _)| *other == domain).map(|&(_, domain)| domain);
        let (values, num_components) = read_table(&item.call_method0("_table")?)?;
        let indices: Option<PyReadonlyArray1<i64>> = item.call_method0("_indices")?.extract()?;
        // An index that does not fit is out of range, and said to be.
        let entry =
            |&index: &i64| if index == -1 { NO_ENTRY } else { u32::try_from(index).unwrap_or(NO_ENTRY - 1) };
        let indices = indices.as_ref().map(|entries| entries.as_slice()).transpose()?;
        attributes.list.push(Attribute {
            is_normalized: item.getattr("normalized")?.extract()?,
            indices: indices.map(|entries| entries.iter().map(entry).collect()),
            ..Attribute::new(
                name.extract::<String>()?,
                from_python(&semantic, item.getattr("set_index")?.extract()?)?,
                domain.ok_or_else(|| PyValueError::new_err("a domain is vertex, corner or face"))?,
                num_components,
                values,
            )
        });
    }
    Ok(attributes)
}

/// Values and components of an entry.
fn read_table(table: &Bound<'_, PyAny>) -> PyResult<(Values, usize)> {
    if let Ok(names) = table.extract::<Vec<String>>() {
        return Ok((Values::Names(names), 1));
    }
    fn numbers<T: Element + Copy>(
        table: &Bound<'_, PyAny>,
        wrap: fn(Vec<T>) -> Values,
    ) -> Option<PyResult<(Values, usize)>> {
        let table: PyReadonlyArray2<T> = table.extract().ok()?;
        Some(table.as_slice().map(|slice| (wrap(slice.to_vec()), table.shape()[1])).map_err(PyErr::from))
    }
    numbers(table, Values::I8)
        .or_else(|| numbers(table, Values::U8))
        .or_else(|| numbers(table, Values::I16))
        .or_else(|| numbers(table, Values::U16))
        .or_else(|| numbers(table, Values::I32))
        .or_else(|| numbers(table, Values::U32))
        .or_else(|| numbers(table, Values::F32))
        .or_else(|| numbers(table, Values::F64))
        .unwrap_or_else(|| Err(PyTypeError::new_err("values of an attribute are numbers or names")))
}

/// A dict of `lwc.Attribute`. Of several with one name, the later ones have a number after the name.
fn write<'py>(py: Python<'py>, attributes: Attributes) -> PyResult<Bound<'py, PyDict>> {
    let (class, dict) = (class(py, "Attribute")?, PyDict::new(py));
    for attribute in attributes.list {
        let Attribute { name, semantic, domain: of, num_components, is_normalized, values, indices } =
            attribute;
        let values = match values {
            Values::I8(v) => table(py, v, num_components),
            Values::U8(v) => table(py, v, num_components),
            Values::I16(v) => table(py, v, num_components),
            Values::U16(v) => table(py, v, num_components),
            Values::I32(v) => table(py, v, num_components),
            Values::U32(v) => table(py, v, num_components),
            Values::F32(v) => table(py, v, num_components),
            Values::F64(v) => table(py, v, num_components),
            Values::Names(names) => names.into_pyobject(py),
        }?;
        let entry = |entry: u32| if entry == NO_ENTRY { -1 } else { i64::from(entry) };
        let indices =
            indices.map(|entries| entries.into_iter().map(entry).collect::<Vec<_>>().into_pyarray(py));
        let (semantic, set_index) = (semantic.name(), semantic.set_index());
        let made = class.call1((values, domain(of), semantic, set_index, is_normalized, indices))?;
        let mut key = name.clone();
        let mut number = 2;
        while dict.contains(&key)? {
            key = format!("{name} ({number})");
            number += 1;
        }
        dict.set_item(key, made)?;
    }
    Ok(dict)
}

/// Entries × components, or entries if these have one.
fn table<'py, T: Element>(py: Python<'py>, values: Vec<T>, components: usize) -> PyResult<Bound<'py, PyAny>> {
    let flat = values.into_pyarray(py).into_any();
    if components == 1 { Ok(flat) } else { flat.call_method1("reshape", ((-1, components),)) }
}

/// A `lwc.Mesh`.
pub fn mesh<'py>(
    py: Python<'py>,
    (mesh, attributes, losses): (TriMesh, Attributes, Losses),
) -> PyResult<Bound<'py, PyAny>> {
    let (positions, triangles) = mesh.into_parts();
    let vertices = positions.into_flattened().into_pyarray(py).call_method1("reshape", ((-1, 3),))?;
    let faces = triangles.into_flattened().into_pyarray(py).call_method1("reshape", ((-1, 3),))?;
    let losses = losses::list(py, &losses)?;
    class(py, "Mesh")?.call1((vertices, faces, write(py, attributes)?, losses))
}
