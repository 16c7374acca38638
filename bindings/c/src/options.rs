//! Options as plain structs.

use crate::error::{Status, tell};
use lwc::descriptors::{Descriptor, Window};
use lwc::{GridChoice, Lattice, Limits, Optimize, Partition, Profile};
use std::ffi::{CStr, c_char};

/// How to decode, and the limits for an untrusted stream.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct DecodeOptions {
    /// Last level wanted, 0 is the base mesh; negative for all.
    pub level: i32,
    /// Most bytes of memory the decoder may hold.
    pub max_memory: u64,
    /// Most vertices of the finest mesh decoded.
    pub max_vertices: u32,
    /// Most levels.
    pub max_levels: u32,
    /// Most units of work, each about a tenth of a microsecond; 0: in proportion to the bytes of the stream.
    pub max_work: u64,
    /// Leave the vertices of coarse levels where they are in the finest mesh.
    pub no_shrinkage_compensation: bool,
}

/// How to encode. See `EncodeOptions` of the Rust library for what the numbers mean.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct EncodeOptions {
    /// Name of the descriptor, such as "harris3d"; null for the default.
    pub descriptor: *const c_char,
    /// Name of the partition, "weighted-error" or "algorithm1"; null for the default.
    pub partition: *const c_char,
    /// What the partition by weighted error aims at, "size", "balanced" or "prefix"; null for the default.
    pub optimize: *const c_char,
    /// Topological radius of the window, in edges.
    pub rings: u32,
    /// Euclidean radius of the window, in mean edges.
    pub radius: f64,
    /// Factor of the radius from each level to the next coarser one.
    pub growth: f64,
    /// Bits per coordinate, 1 to 30; not looked at where `step` is set.
    pub quantization_bits: u32,
    /// Keep the cubic grid even if more than 1 % of the triangles collapse or turn over in it.
    pub cubic_grid: bool,
    /// Steps of a lattice along the axes, model units, above 0; all 0 for the grid of `quantization_bits`.
    pub step: [f64; 3],
    /// A point of that lattice, model units. Streams with the same step and origin share borders bit for bit.
    pub grid_origin: [f64; 3],
    /// Levels above the base mesh; negative: until the base mesh is small.
    pub levels: i32,
    /// Grid steps to the mean edge of a level; 0: by the error of each level.
    pub steps_per_edge: f64,
    /// Bits of each of the two coordinates of a normal, 2 to 30.
    pub normal_bits: u32,
    /// Bits of a texture coordinate, 1 to 30.
    pub texcoord_bits: u32,
    /// Bits of a component of a colour, 1 to 30.
    pub color_bits: u32,
    /// Bits of a component of any other attribute, 1 to 30.
    pub generic_bits: u32,
    /// How the passes are coded, "max", "small" or "fast"; null for max where `optimize` is "size", else small.
    pub profile: *const c_char,
    /// Time that may be spent, 0 to 9.
    pub effort: u32,
    /// Keep all coordinates bit for bit.
    pub lossless: bool,
    /// Keep the order of vertices and triangles and the first corner of each.
    pub keep_order: bool,
    /// Keep vertices that no triangle has.
    pub keep_isolated: bool,
    /// Keep triangles that name a vertex twice.
    pub keep_degenerate: bool,
}

/// All levels, the limits of the Rust library.
#[unsafe(no_mangle)]
pub extern "C" fn lwc_decode_options_default() -> DecodeOptions {
    let Limits { max_memory, max_vertices, max_levels, max_work } = Limits::default();
    let max_work = max_work.unwrap_or(0);
    DecodeOptions {
        level: -1,
        max_memory,
        max_vertices,
        max_levels,
        max_work,
        no_shrinkage_compensation: false,
    }
}

/// The defaults of the Rust library.
#[unsafe(no_mangle)]
pub extern "C" fn lwc_encode_options_default() -> EncodeOptions {
    let options = lwc::EncodeOptions::default();
    EncodeOptions {
        descriptor: std::ptr::null(),
        partition: std::ptr::null(),
        optimize: std::ptr::null(),
        rings: options.window.rings,
        radius: options.window.radius,
        growth: options.growth,
        quantization_bits: options.quantization_bits,
        cubic_grid: false,
        step: [0.0; 3],
        grid_origin: [0.0; 3],
        levels: options.levels.map_or(-1, |levels| levels as i32),
        steps_per_edge: options.steps_per_edge.unwrap_or(0.0),
        normal_bits: options.normal_bits,
        texcoord_bits: options.texcoord_bits,
        color_bits: options.color_bits,
        generic_bits: options.generic_bits,
        profile: std::ptr::null(),
        effort: options.effort,
        lossless: options.lossless,
        keep_order: options.keep_order,
        keep_isolated: options.keep_isolated,
        keep_degenerate: options.keep_degenerate,
    }
}

pub fn decode(options: Option<&DecodeOptions>) -> lwc::DecodeOptions {
    let Some(&DecodeOptions {
        level,
        max_memory,
        max_vertices,
        max_levels,
        max_work,
        no_shrinkage_compensation,
    }) = options
    else {
        return lwc::DecodeOptions::new();
    };
    let max_work = (max_work != 0).then_some(max_work);
    let limits = Limits { max_memory, max_vertices, max_levels, max_work };
    let options = lwc::DecodeOptions::new().limits(limits).shrinkage_compensation(!no_shrinkage_compensation);
    u32::try_from(level).map_or(options, |level| options.level(level))
}

pub fn encode(from: &EncodeOptions) -> Result<lwc::EncodeOptions, Status> {
    let mut options = lwc::EncodeOptions::default();
    if let Some(name) = name(from.descriptor) {
        options.descriptor = name.parse::<Descriptor>().map_err(|_| unknown("descriptor", &name))?;
    }
    if let Some(name) = name(from.partition) {
        let found = Partition::ALL.into_iter().find(|partition| partition.name() == name);
        options.partition = found.ok_or_else(|| unknown("partition", &name))?;
    }
    if let Some(name) = name(from.optimize) {
        let found = Optimize::ALL.into_iter().find(|optimize| optimize.name() == name);
        options.optimize = found.ok_or_else(|| unknown("aim", &name))?;
    }
    if let Some(name) = name(from.profile) {
        let found = Profile::ALL.into_iter().find(|profile| profile.name() == name);
        options.profile = Some(found.ok_or_else(|| unknown("profile", &name))?);
    }
    options.window = Window { rings: from.rings, radius: from.radius };
    options.growth = from.growth;
    options.quantization_bits = from.quantization_bits;
    options.grid = grid(from);
    options.levels = u32::try_from(from.levels).ok();
    options.steps_per_edge = (from.steps_per_edge != 0.0).then_some(from.steps_per_edge);
    options.normal_bits = from.normal_bits;
    options.texcoord_bits = from.texcoord_bits;
    options.color_bits = from.color_bits;
    options.generic_bits = from.generic_bits;
    options.effort = from.effort;
    options.lossless = from.lossless;
    options.keep_order = from.keep_order;
    options.keep_isolated = from.keep_isolated;
    options.keep_degenerate = from.keep_degenerate;
    Ok(options)
}

/// The grid that is asked for. What makes no lattice is refused by the encoder.
fn grid(from: &EncodeOptions) -> GridChoice {
    match from.step {
        [0.0, 0.0, 0.0] if from.cubic_grid => GridChoice::Cube,
        [0.0, 0.0, 0.0] => GridChoice::Auto,
        step => GridChoice::Lattice(Lattice { origin: from.grid_origin, step }),
    }
}

fn unknown(option: &str, name: &str) -> Status {
    tell(Status::Option, &format!("there is no {option} {name}"))
}

fn name(text: *const c_char) -> Option<String> {
    // SAFETY: the header asks for null or a string that ends in a zero, alive during the call.
    (!text.is_null()).then(|| unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned())
}
