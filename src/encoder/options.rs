//! What the caller may choose, and what the encoder returns.

use super::grid_choice::GridChoice;
use super::grid_error::GridError;
use crate::bitstream::profile::Profile;
use crate::decoder::StreamInfo;
use crate::descriptors::{Descriptor, FeatureChoice, Window};
use crate::error::EncodeError;
use crate::losses::Losses;
use crate::mesh::repair::RepairReport;
use crate::mesh::{Attributes, TriMesh};
use crate::simplification::hierarchy::MAX_LEVELS;
use crate::simplification::partition::Partition;
use crate::simplification::vertex_selection::Optimize;

/// How to encode: change fields of the `Default`, whose values are named below. The encoder checks the ranges.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct EncodeOptions {
    /// Saliency of vertices. Default harris3d.
    pub descriptor: Descriptor,
    /// Window of the descriptor at the finest level: 1 to 64 rings, radius above 0 to 1e6 mean edges. Default 4 rings, radius 3 mean edges.
    pub window: Window,
    /// Factor of the radius from each level to the next coarser one, 1 to 16. Default 1.5.
    pub growth: f64,
    /// Attributes that the descriptor uses in addition to positions, if it is pca or pca-qem. Default none.
    pub descriptor_attributes: Vec<FeatureChoice>,
    /// Bits per coordinate, 1 to 30, unless [`grid`](Self::grid) is a lattice, from which they follow. Default 12.
    pub quantization_bits: u32,
    /// Where vertices may lie. Default [`GridChoice::Auto`].
    pub grid: GridChoice,
    /// Number of levels above the base mesh, 0 to 128; `None` goes on until the base is small. Default `None`.
    pub levels: Option<u32>,
    /// How odd vertices are chosen and removed. Default weighted error.
    pub partition: Partition,
    /// What the partition by weighted error aims at. Default balanced.
    pub optimize: Optimize,
    /// Grid steps to the mean edge of a level, 0.5 to 1e9, from which its quantization bits follow; `None` follows the
    /// error of each level instead, which makes better prefixes. Where the axes have steps of their own, each component of
    /// an edge counts in the steps of its axis. Default `None`.
    pub steps_per_edge: Option<f64>,
    /// Bits of each of the two coordinates of a normal on the octahedron, 2 to 30. Default 8.
    pub normal_bits: u32,
    /// Bits of a texture coordinate, 1 to 30. Default 10.
    pub texcoord_bits: u32,
    /// Bits of a component of a colour, 1 to 30. Default 8: colours of 8 bits are kept exactly.
    pub color_bits: u32,
    /// Bits of a component of any other attribute, 1 to 30. Whole numbers, which may name things, are kept exactly whatever
    /// the bits, except `intensity` and `nir`. Default 12.
    pub generic_bits: u32,
    /// Keep vertices that no triangle has. Default false: they are dropped and counted.
    pub keep_isolated: bool,
    /// Keep triangles that name a vertex twice, and the vertices they name. Default false: they are dropped
    /// and counted.
    pub keep_degenerate: bool,
    /// Keep all coordinates and values of attributes bit for bit, after the last pass. Default false.
    pub lossless: bool,
    /// Keep the order of vertices and triangles and the first corner of each, after the last pass. Default
    /// false.
    pub keep_order: bool,
    /// How the passes are coded; `None`: max where only the size of the file counts ([`Optimize::Size`]), else small.
    /// Default `None`.
    pub profile: Option<Profile>,
    /// Time that may be spent, 0 to 9. Below [`LOW_EFFORT`](Self::LOW_EFFORT) the partition by weighted error ignores the
    /// descriptor, which takes a third less time, and one stream is made. From there on [`Optimize::Size`] also tries all
    /// bits at once and a mesh without levels, from [`HIGH_EFFORT`](Self::HIGH_EFFORT) on two more ways to spread the bits,
    /// with 9 other largest valences; the smallest stream is kept. Default 5.
    pub effort: u32,
}

impl Default for EncodeOptions {
    fn default() -> Self {
        Self {
            descriptor: Descriptor::default(),
            window: Window::default(),
            growth: 1.5,
            descriptor_attributes: Vec::new(),
            quantization_bits: 12,
            grid: GridChoice::default(),
            levels: None,
            partition: Partition::default(),
            optimize: Optimize::default(),
            steps_per_edge: None,
            normal_bits: 8,
            texcoord_bits: 10,
            color_bits: 8,
            generic_bits: 12,
            keep_isolated: false,
            keep_degenerate: false,
            lossless: false,
            keep_order: false,
            profile: None,
            effort: 5,
        }
    }
}

impl EncodeOptions {
    /// Below this effort the descriptor does not affect the partition by weighted error.
    pub const LOW_EFFORT: u32 = 3;
    /// From this effort on more ways to spread the bits over the passes are tried.
    pub const HIGH_EFFORT: u32 = 7;
    /// From this effort on other partitions are tried as well.
    const HIGHEST_EFFORT: u32 = 9;

    /// The profile that these options ask for.
    pub(super) fn profile_used(&self) -> Profile {
        let usual = if self.optimize == Optimize::Size { Profile::Max } else { Profile::Small };
        self.profile.unwrap_or(usual)
    }

    /// Ways down that are tried, the usual one first.
    pub(super) fn hierarchies_tried(&self) -> Vec<Attempt> {
        let usual = Attempt { levels: self.levels, max_valence: None };
        let mut tried = vec![usual];
        let is_for_size = self.optimize == Optimize::Size && self.partition == Partition::WeightedError;
        if is_for_size && self.effort >= Self::HIGHEST_EFFORT {
            tried.extend([5, 7].map(|valence| Attempt { max_valence: Some(valence), ..usual }));
        }
        // Many surfaces are smallest in one piece.
        if is_for_size && self.levels.is_none() && self.effort >= Self::LOW_EFFORT {
            tried.push(Attempt { levels: Some(0), ..usual });
        }
        tried
    }

    /// Quantization bits that are tried, as grid steps to the mean edge; `None` follows the errors.
    pub(super) fn steps_tried(&self) -> Vec<Option<f64>> {
        const AT_ONCE: Option<f64> = Some(f64::MAX);
        if self.steps_per_edge.is_some() {
            return vec![self.steps_per_edge];
        }
        let tried: &[_] = match (self.optimize, self.effort) {
            (Optimize::Size, Self::HIGH_EFFORT..) => &[None, AT_ONCE, Some(32.0), Some(64.0)],
            // Only a trial shows which surfaces are smaller with all bits at once.
            (Optimize::Size, Self::LOW_EFFORT..) => &[None, AT_ONCE],
            _ => &[None],
        };
        tried.to_vec()
    }

    pub(super) fn check(&self) -> Result<(), EncodeError> {
        self.grid.check()?;
        let fail = |option, value: String, allowed| Err(EncodeError::Option { option, value, allowed });
        if !(1..=30).contains(&self.quantization_bits) {
            return fail("quantization bits", self.quantization_bits.to_string(), "1 to 30");
        }
        for (option, bits, least) in [
            ("normal bits", self.normal_bits, 2),
            ("texcoord bits", self.texcoord_bits, 1),
            ("color bits", self.color_bits, 1),
            ("generic bits", self.generic_bits, 1),
        ] {
            if !(least..=30).contains(&bits) {
                return fail(option, bits.to_string(), if least == 2 { "2 to 30" } else { "1 to 30" });
            }
        }
        if self.levels.is_some_and(|n| n > MAX_LEVELS) {
            return fail("levels", self.levels.unwrap_or(0).to_string(), "0 to 128");
        }
        if self.effort > 9 {
            return fail("effort", self.effort.to_string(), "0 to 9");
        }
        if let Some(profile) = self.profile.filter(|profile| !profile.is_supported()) {
            return fail("profile", profile.name().to_owned(), "one that this build supports");
        }
        if !(1..=64).contains(&self.window.rings) {
            return fail("rings", self.window.rings.to_string(), "1 to 64");
        }
        if !(self.window.radius > 0.0 && self.window.radius <= 1e6) {
            return fail("radius", self.window.radius.to_string(), "above 0, at most 1000000 mean edges");
        }
        if !(1.0..=16.0).contains(&self.growth) {
            return fail("growth", self.growth.to_string(), "1 to 16");
        }
        if let Some(steps) = self.steps_per_edge.filter(|steps| !(0.5..=1e9).contains(steps)) {
            return fail("steps per edge", steps.to_string(), "0.5 to 1e9");
        }
        Ok(())
    }
}

/// What is encoded, and how.
#[derive(Clone, Copy)]
pub(super) struct Input<'a> {
    pub(super) mesh: &'a TriMesh,
    pub(super) attributes: &'a Attributes,
    pub(super) options: &'a EncodeOptions,
}

/// A way down that is tried.
#[derive(Clone, Copy)]
pub(super) struct Attempt {
    /// `None` goes on until the base is small.
    pub(super) levels: Option<u32>,
    /// Largest valence of odd vertices, if not the usual one.
    pub(super) max_valence: Option<u32>,
}

/// A stream and how it came about.
#[derive(Clone, Debug)]
pub struct Encoded {
    /// The stream.
    pub bytes: Vec<u8>,
    /// Its levels and passes.
    pub info: StreamInfo,
    /// What had to be cut or dropped.
    pub repair: RepairReport,
    /// What the stream does not give back.
    pub losses: Losses,
    /// What rounding to the grid does to the mesh.
    pub grid_error: GridError,
}

/// How far an encoder is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// What it does now: `levels` or `passes`, which alternate if several ways are tried.
    pub stage: &'static str,
    /// Share of the whole work done, 0 to 1. It never falls, and ends at 1.
    pub fraction: f64,
}
