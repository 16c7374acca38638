//! What may be typed after `lwc render`, and about pictures elsewhere.

use crate::cli::args::{LimitArgs, Reading, WindowArgs};
use crate::cli::quantity;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::value_parser;
use lwc::descriptors::Descriptor;
use lwc::mesh::{Attribute, Attributes, Semantic};
use lwc::render::{Shading, Style, Up, View};
use std::path::PathBuf;

/// Draw a picture of a mesh or of a stream, at any level or from its first bytes.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  lwc render model.lwc -o model.png --level 6 --wireframe
  lwc render terrain.ply -o heat.png --up z --color-by harris3d --clip 2
  lwc render textured.lwc -o texcoord.png --bytes 20K --color-by texcoord
  lwc render model.lwc -o levels.png --montage --levels 0,4,8,12 --shading flat")]
pub struct Render {
    /// Mesh (.obj .ply .stl .glb .gltf .las .laz, or compressed, such as .obj.gz) or stream (.lwc).
    #[arg(value_name = "INPUT")]
    pub input: PathBuf,
    /// Picture to write (.png), `-` for standard output.
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Stop at this level of a stream; 0 is the base mesh. Default: the finest.
    #[arg(short, long, value_name = "K")]
    pub level: Option<u32>,
    /// Decode the first N bytes of a stream only, e.g. 5000 or 20K. Default: all.
    #[arg(short, long, value_name = "N", value_parser = quantity::bytes)]
    pub bytes: Option<u64>,
    #[command(flatten)]
    pub picture: Picture,
    /// Colour by a descriptor, its values spread over [0, 1], or by an attribute: `color`, `normal`, or `texcoord` as
    /// red and green with a pattern of squares. Magenta where there is no value.
    #[arg(long, value_name = "NAME", value_parser = color_by_parser())]
    pub color_by: Option<ColorBy>,
    #[command(flatten)]
    pub heat: HeatArgs,
    #[command(flatten)]
    pub window: WindowArgs,
    /// Show all levels of a stream side by side, with vertices, bytes and the distance from the finest.
    #[arg(long, conflicts_with_all = ["level", "bytes"])]
    pub montage: bool,
    /// Levels of the montage, separated by commas. Default: all.
    #[arg(long, value_name = "K,…", value_delimiter = ',', requires = "montage")]
    pub levels: Vec<u32>,
    /// Pictures in a row of the montage, 1 to 64. Default: as many as make the montage about square.
    #[arg(long, value_name = "N", requires = "montage", value_parser = value_parser!(u32).range(1..=64))]
    pub columns: Option<u32>,
    #[command(flatten)]
    pub reading: Reading,
    #[command(flatten)]
    pub limits: LimitArgs,
}

/// What colours a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ColorBy {
    Descriptor(Descriptor),
    Attribute(AttributeKind),
}

/// An attribute that can be shown, the first of its kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AttributeKind {
    Color,
    Normal,
    TexCoord,
}

impl AttributeKind {
    const NAMES: [(&str, Self); 3] =
        [("color", Self::Color), ("normal", Self::Normal), ("texcoord", Self::TexCoord)];

    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, kind)| *kind == self).map_or("", |(name, _)| name)
    }

    pub fn find(self, attributes: &Attributes) -> Option<&Attribute> {
        attributes.list.iter().find(|attribute| match self {
            Self::Color => matches!(attribute.semantic, Semantic::Color(_)),
            Self::Normal => attribute.semantic == Semantic::Normal,
            Self::TexCoord => matches!(attribute.semantic, Semantic::TexCoord(_)),
        })
    }
}

/// How a picture looks.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Picture options")]
pub struct Picture {
    /// Width and height in pixels, each 1 to 16384; in a montage, of each picture.
    #[arg(long, value_name = "WxH", default_value = "800x600", value_parser = size)]
    pub size: [u32; 2],
    /// Where to look from: front, back, left, right, top, bottom, or degrees to the right and up, e.g. 30,20.
    #[arg(long, value_name = "VIEW", default_value = "30,20", allow_hyphen_values = true)]
    pub view: View,
    /// Axis of the model that points up.
    #[arg(long, value_name = "AXIS", default_value = "y", value_parser = up_parser())]
    pub up: Up,
    /// How triangles are shaded.
    #[arg(long, value_name = "HOW", default_value = "smooth", value_parser = shading_parser())]
    pub shading: Shading,
    /// Draw the edges of the triangles.
    #[arg(long)]
    pub wireframe: bool,
    /// Draw the outlines of the surface.
    #[arg(long)]
    pub silhouettes: bool,
    /// Colour of the background: white, black, transparent or RRGGBB.
    #[arg(long, value_name = "COLOUR", default_value = "white", value_parser = background)]
    pub background: [u8; 4],
    /// Colour of the surface, RRGGBB. Default: a light blue-grey.
    #[arg(long, value_name = "RRGGBB", value_parser = colour)]
    pub color: Option<[u8; 3]>,
    /// Samples per pixel in each direction, 1 to 8.
    #[arg(long, value_name = "N", default_value_t = Style::default().oversampling)]
    #[arg(value_parser = value_parser!(u32).range(1..=8))]
    pub antialias: u32,
}

impl Picture {
    /// How long drawing takes, where reading a mesh of usual size takes 50.
    pub fn work(&self) -> f64 {
        let [width, height] = self.size.map(f64::from);
        5.0 + width * height / 1e5
    }

    pub fn style(&self) -> Style {
        let usual = Style::default();
        Style {
            size: self.size,
            shading: self.shading,
            wireframe: self.wireframe,
            silhouettes: self.silhouettes,
            background: self.background,
            colour: self.color.unwrap_or(usual.colour),
            oversampling: self.antialias,
        }
    }
}

/// How values become colours.
#[derive(Debug, clap::Args)]
pub struct HeatArgs {
    /// Percent of the values at either end that share the colour of that end, 0 to 50. With 0, a few extreme values
    /// can leave one colour for all others.
    #[arg(long, value_name = "PERCENT", default_value_t = 0.0, value_parser = quantity::number(0.0, 50.0))]
    pub clip: f64,
}

fn size(text: &str) -> Result<[u32; 2], String> {
    let side = |text: &str| text.parse().ok().filter(|n| (1..=16_384).contains(n));
    let sides = text.split_once('x').and_then(|(w, h)| Some([side(w)?, side(h)?]));
    sides.ok_or_else(|| "it is no size like 800x600, each side 1 to 16384".into())
}

fn colour(text: &str) -> Result<[u8; 3], String> {
    let digits = text.strip_prefix('#').unwrap_or(text);
    let is_hex = digits.len() == 6 && digits.bytes().all(|b| b.is_ascii_hexdigit());
    let number = is_hex.then(|| u32::from_str_radix(digits, 16).ok()).flatten();
    let number = number.ok_or_else(|| "it is no colour like ffa040".to_owned())?;
    Ok([number >> 16, number >> 8, number].map(|byte| byte as u8))
}

fn background(text: &str) -> Result<[u8; 4], String> {
    match text {
        "transparent" => Ok([255, 255, 255, 0]),
        "white" => Ok([255; 4]),
        "black" => Ok([0, 0, 0, 255]),
        _ => colour(text).map(|[r, g, b]| [r, g, b, 255]),
    }
}

fn color_by_parser() -> impl TypedValueParser<Value = ColorBy> {
    let attributes = AttributeKind::NAMES.map(|(name, _)| name);
    let names = Descriptor::ALL.map(Descriptor::name).into_iter().chain(attributes);
    PossibleValuesParser::new(names).try_map(|name| {
        let kind = AttributeKind::NAMES.iter().find(|(known, _)| *known == name);
        match kind {
            Some((_, kind)) => Ok(ColorBy::Attribute(*kind)),
            None => name.parse().map(ColorBy::Descriptor),
        }
    })
}

fn up_parser() -> impl TypedValueParser<Value = Up> {
    PossibleValuesParser::new(["y", "z"]).map(|name| if name == "z" { Up::Z } else { Up::Y })
}

fn shading_parser() -> impl TypedValueParser<Value = Shading> {
    PossibleValuesParser::new(["smooth", "flat"])
        .map(|name| if name == "flat" { Shading::Flat } else { Shading::Smooth })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_and_colours() {
        assert_eq!(size("640x480"), Ok([640, 480]));
        assert!(["640", "0x5", "5x16385", "x", "-1x5"].iter().all(|text| size(text).is_err()));
        assert_eq!(colour("#ffA040"), Ok([255, 160, 64]));
        assert!(["fff", "gggggg", "+12345", "ff00ff0"].iter().all(|text| colour(text).is_err()));
        assert_eq!(background("transparent").map(|c| c[3]), Ok(0));
        assert_eq!(background("102030"), Ok([16, 32, 48, 255]));
    }
}
