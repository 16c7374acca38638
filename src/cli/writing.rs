//! How mesh files are written: options of several commands.

use clap::builder::{PossibleValuesParser, TypedValueParser};
use lwc::io::{ColorSpace, ColorType, PositionType, UpAxis, WriteOptions};
use lwc::{Decoder, TrailingKind, TriMesh};

/// How mesh files are written.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Options of mesh files")]
pub struct Writing {
    /// Type of positions in .ply, and digits in .obj. auto: float if that moves no vertex by more than an eighth of the
    /// grid's step, and after `--lossless` none at all; else double. The other formats have float.
    #[arg(long, value_name = "TYPE", default_value = "auto", value_parser = position_type_parser())]
    pub position_type: PositionType,
    /// Type of colours in .ply: uchar is 0 to 255, ushort 0 to 65535, float 0 to 1; keep is what they are.
    #[arg(long, value_name = "TYPE", default_value = "uchar", value_parser = color_type_parser())]
    pub color_type: ColorType,
    /// convert: colours become linear in .glb and .gltf, and sRGB in .ply and .obj. keep: their numbers stay.
    #[arg(long, value_name = "HOW", default_value = "convert", value_parser = color_space_parser())]
    pub color_space: ColorSpace,
    /// Repeat vertices at seams in .ply and .obj, so that each vertex has one texture coordinate, normal and colour. .glb
    /// and .gltf always do.
    #[arg(long)]
    pub split_seams: bool,
    /// Axis that points up in the mesh. With z, .glb and .gltf get a node that turns it to y.
    #[arg(long, value_name = "AXIS", default_value = "y", value_parser = up_parser())]
    pub up: UpAxis,
}

impl Writing {
    /// For what a decoder has: on the grid of the stream, or exact.
    pub fn options_for_decoded(&self, decoder: &Decoder) -> WriteOptions {
        let options = self.options();
        let Some(info) = decoder.info() else { return options };
        let is_exact = info.trailing().iter().any(|trailing| trailing.kind == TrailingKind::Exact);
        let smallest = info.step().into_iter().fold(f64::INFINITY, f64::min);
        if is_exact && decoder.is_complete() { options } else { options.step(smallest) }
    }

    /// For a mesh that was computed from another: float32 if that one was.
    pub fn options_for_changed(&self, source: &TriMesh) -> WriteOptions {
        let is_float = source.positions().iter().flatten().all(|&c| f64::from(c as f32) == c);
        let options = self.options();
        if is_float && self.position_type == PositionType::Auto {
            options.position_type(PositionType::Float)
        } else {
            options
        }
    }

    fn options(&self) -> WriteOptions {
        WriteOptions::new()
            .position_type(self.position_type)
            .color_type(self.color_type)
            .color_space(self.color_space)
            .split_seams(self.split_seams)
            .up(self.up)
    }
}

/// A parser of one of some names.
fn parser<T: Copy + Send + Sync + 'static>(
    known: &'static [(&'static str, T)],
) -> impl TypedValueParser<Value = T> {
    let names = known.iter().map(|(name, _)| *name);
    PossibleValuesParser::new(names).try_map(move |name| {
        let found = known.iter().find(|(known, _)| *known == name);
        found.map(|(_, value)| *value).ok_or("unknown name")
    })
}

fn position_type_parser() -> impl TypedValueParser<Value = PositionType> {
    parser(&[("auto", PositionType::Auto), ("float", PositionType::Float), ("double", PositionType::Double)])
}

fn color_type_parser() -> impl TypedValueParser<Value = ColorType> {
    parser(&[
        ("uchar", ColorType::Uchar),
        ("ushort", ColorType::Ushort),
        ("float", ColorType::Float),
        ("keep", ColorType::Keep),
    ])
}

fn color_space_parser() -> impl TypedValueParser<Value = ColorSpace> {
    parser(&[("convert", ColorSpace::Convert), ("keep", ColorSpace::Keep)])
}

fn up_parser() -> impl TypedValueParser<Value = UpAxis> {
    parser(&[("y", UpAxis::Y), ("z", UpAxis::Z)])
}
