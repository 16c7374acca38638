//! Ways to encode that are compared.

use lwc::descriptors::Descriptor;
use lwc::{EncodeOptions, GridChoice, Optimize, Partition, Profile};
use std::fmt;
use std::str::FromStr;

/// An aim, another profile with the usual aim, or Algorithm 1, and a descriptor if not the usual one.
#[derive(Clone, Copy, Debug)]
pub struct Variant {
    /// `None` is Algorithm 1.
    aim: Option<Optimize>,
    /// `None` is that of the aim.
    profile: Option<Profile>,
    descriptor: Option<Descriptor>,
    /// Not in one piece, though that be smaller.
    keeps_levels: bool,
    /// Vertices of coarse meshes are shown where they lie.
    is_lazy: bool,
}

/// The smallest streams that have beginnings.
const LEVELS: &str = "levels";
/// The usual streams, beginnings as they are without compensation.
const LAZY: &str = "lazy";
/// More than any mesh has.
const ALL_LEVELS: u32 = 128;

impl Variant {
    /// Whether beginnings are shown where they shrink less.
    pub fn compensates(self) -> bool {
        !self.is_lazy
    }

    pub fn options(self, bits: u32) -> EncodeOptions {
        let mut options = EncodeOptions::default();
        options.quantization_bits = bits;
        options.grid = GridChoice::Cube;
        options.profile = self.profile;
        options.descriptor = self.descriptor.unwrap_or_default();
        match self.aim {
            Some(aim) => options.optimize = aim,
            None => options.partition = Partition::Algorithm1,
        }
        if self.keeps_levels {
            options.levels = Some(ALL_LEVELS);
        }
        options
    }
}

impl fmt::Display for Variant {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let name = self.aim.map_or(Partition::Algorithm1.name(), Optimize::name);
        f.write_str(match self.profile {
            Some(profile) => profile.name(),
            None if self.keeps_levels => LEVELS,
            None if self.is_lazy => LAZY,
            None => name,
        })?;
        self.descriptor.map_or(Ok(()), |descriptor| write!(f, ":{}", descriptor.name()))
    }
}

impl FromStr for Variant {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (aim, descriptor) = match text.split_once(':') {
            Some((aim, name)) => {
                (aim, Some(name.parse().map_err(|e: lwc::descriptors::UnknownDescriptor| e.to_string())?))
            }
            None => (text, None),
        };
        let aim_of_most = Some(Optimize::default());
        let usual = Self { aim: None, profile: None, descriptor, keeps_levels: false, is_lazy: false };
        if aim == Partition::Algorithm1.name() {
            return Ok(usual);
        }
        if let Some(profile) = [Profile::Max, Profile::Fast].into_iter().find(|p| p.name() == aim) {
            return Ok(Self { aim: aim_of_most, profile: Some(profile), ..usual });
        }
        if aim == LAZY {
            return Ok(Self { aim: aim_of_most, is_lazy: true, ..usual });
        }
        if aim == LEVELS {
            return Ok(Self { aim: Some(Optimize::Size), keeps_levels: true, ..usual });
        }
        let found = Optimize::ALL.into_iter().find(|known| known.name() == aim);
        found.map(|aim| Self { aim: Some(aim), ..usual }).ok_or_else(|| {
            format!("`{aim}` is neither size, levels, balanced, lazy, prefix, max, fast nor algorithm1")
        })
    }
}
