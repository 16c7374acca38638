//! Keywords of Python as options of the library.

use crate::error::option_error;
use lwc::descriptors::Descriptor;
use lwc::{DecodeOptions, EncodeOptions, GridChoice, Lattice, Limits, Optimize, Partition, Profile};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The options of `encode`. What is missing or None has its default.
pub fn encode(py: Python<'_>, keywords: Option<&Bound<'_, PyDict>>) -> PyResult<EncodeOptions> {
    let mut options = EncodeOptions::default();
    let mut grid = GridKeywords::default();
    for (key, value) in keywords.into_iter().flatten().filter(|(_, value)| !value.is_none()) {
        let key: String = key.extract()?;
        let name = || value.extract::<String>();
        match key.as_str() {
            "descriptor" => {
                options.descriptor = find(py, &key, &Descriptor::ALL, Descriptor::name, &name()?)?;
            }
            "partition" => options.partition = find(py, &key, &Partition::ALL, Partition::name, &name()?)?,
            "optimize" => options.optimize = find(py, &key, &Optimize::ALL, Optimize::name, &name()?)?,
            "profile" => options.profile = Some(find(py, &key, &Profile::ALL, Profile::name, &name()?)?),
            "rings" => options.window.rings = value.extract()?,
            "radius" => options.window.radius = value.extract()?,
            "growth" => options.growth = value.extract()?,
            "quantization_bits" => options.quantization_bits = value.extract()?,
            "step" => grid.step = Some(steps(&value)?),
            "grid_origin" => grid.origin = Some(value.extract()?),
            "cubic_grid" => grid.is_cubic = value.extract()?,
            "levels" => options.levels = Some(value.extract()?),
            "steps_per_edge" => options.steps_per_edge = Some(value.extract()?),
            "normal_bits" => options.normal_bits = value.extract()?,
            "texcoord_bits" => options.texcoord_bits = value.extract()?,
            "color_bits" => options.color_bits = value.extract()?,
            "generic_bits" => options.generic_bits = value.extract()?,
            "effort" => options.effort = value.extract()?,
            "lossless" => options.lossless = value.extract()?,
            "keep_order" => options.keep_order = value.extract()?,
            "keep_isolated" => options.keep_isolated = value.extract()?,
            "keep_degenerate" => options.keep_degenerate = value.extract()?,
            _ => {
                return Err(PyTypeError::new_err(format!(
                    "encode() got an unexpected keyword argument '{key}'"
                )));
            }
        }
    }
    options.grid = grid.choice()?;
    Ok(options)
}

/// The keywords about the grid.
#[derive(Default)]
struct GridKeywords {
    step: Option<[f64; 3]>,
    origin: Option<[f64; 3]>,
    is_cubic: bool,
}

impl GridKeywords {
    fn choice(self) -> PyResult<GridChoice> {
        match self {
            Self { step: Some(step), origin, is_cubic: false } => {
                Ok(GridChoice::Lattice(Lattice { origin: origin.unwrap_or_default(), step }))
            }
            Self { step: None, origin: None, is_cubic: true } => Ok(GridChoice::Cube),
            Self { step: None, origin: None, is_cubic: false } => Ok(GridChoice::Auto),
            Self { step: None, .. } => Err(PyTypeError::new_err("grid_origin needs a step")),
            Self { .. } => Err(PyTypeError::new_err("a step makes no cubic_grid")),
        }
    }
}

/// One step for all axes, or three.
fn steps(value: &Bound<'_, PyAny>) -> PyResult<[f64; 3]> {
    value.extract().map(|step| [step; 3]).or_else(|_| value.extract())
}

fn find<T: Copy>(
    py: Python<'_>,
    option: &str,
    all: &[T],
    name_of: fn(T) -> &'static str,
    name: &str,
) -> PyResult<T> {
    all.iter().copied().find(|&one| name_of(one) == name).ok_or_else(|| option_error(py, option, name))
}

pub fn decode(
    level: Option<u32>,
    shrinkage_compensation: bool,
    max_memory: Option<u64>,
    max_vertices: Option<u32>,
    max_levels: Option<u32>,
    max_work: Option<u64>,
) -> DecodeOptions {
    let default = Limits::default();
    let options = DecodeOptions::new().shrinkage_compensation(shrinkage_compensation).limits(Limits {
        max_memory: max_memory.unwrap_or(default.max_memory),
        max_vertices: max_vertices.unwrap_or(default.max_vertices),
        max_levels: max_levels.unwrap_or(default.max_levels),
        max_work,
    });
    level.map_or(options, |level| options.level(level))
}
