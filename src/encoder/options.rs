//! What the caller may choose, and what comes back.

use crate::descent::MAX_LEVELS;
use crate::descriptors::{Descriptor, Window};
use crate::mesh::repair::RepairReport;
use crate::{EncodeError, Optimize, Partition, Profile, StreamInfo};

/// How to encode. `Default` gives the defaults named below.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct EncodeOptions {
    /// Saliency of vertices. Default harris3d.
    pub descriptor: Descriptor,
    /// Window of the descriptor at the finest level. Default 4 rings, radius 3 mean edges.
    pub window: Window,
    /// Factor of the radius from each level to the next coarser one. Default 1.5.
    pub growth: f64,
    /// Bits per coordinate, 1 to 30. Default 12.
    pub quantization: u32,
    /// Number of levels above the base mesh; `None` goes on until the base is small. Default `None`.
    pub levels: Option<u32>,
    /// How odd vertices are chosen and removed. Default balanced.
    pub partition: Partition,
    /// What the balanced partition aims at. Default balanced.
    pub optimize: Optimize,
    /// Grid steps to the mean edge of a level, from which its precision follows; `None` follows the
    /// error of each level instead, which makes better prefixes. Default `None`.
    pub steps_per_edge: Option<f64>,
    /// How the passes are coded. Default small.
    pub profile: Profile,
}

impl Default for EncodeOptions {
    fn default() -> Self {
        Self {
            descriptor: Descriptor::default(),
            window: Window::default(),
            growth: 1.5,
            quantization: 12,
            levels: None,
            partition: Partition::default(),
            optimize: Optimize::default(),
            steps_per_edge: None,
            profile: Profile::default(),
        }
    }
}

impl EncodeOptions {
    pub(super) fn check(&self) -> Result<(), EncodeError> {
        let fail = |option, value: String, allowed| Err(EncodeError::Option { option, value, allowed });
        if !(1..=30).contains(&self.quantization) {
            return fail("quantization", self.quantization.to_string(), "1 to 30 bits");
        }
        if self.levels.is_some_and(|n| n > MAX_LEVELS) {
            return fail("levels", self.levels.unwrap_or(0).to_string(), "0 to 128");
        }
        if !self.profile.is_supported() {
            return fail("profile", self.profile.name().to_owned(), "one that this build supports");
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

/// A stream and how it came about.
#[derive(Clone, Debug)]
pub struct Encoded {
    /// The stream.
    pub bytes: Vec<u8>,
    /// Its levels and passes.
    pub info: StreamInfo,
    /// What had to be cut or dropped.
    pub repair: RepairReport,
}

/// How far an encoder is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// What it does now.
    pub stage: &'static str,
    /// Share of the whole work done, 0 to 1.
    pub fraction: f64,
}
