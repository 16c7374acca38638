//! What the features of the crate leave in the decoder.

use crate::bitstream::profile::Profile;

/// Whether the decoder knows what stands beside the surface. Without that all of it is skipped as chunks that nobody
/// knows, and the compiler leaves out what would read it.
pub(super) const ASSETS: bool = cfg!(feature = "assets");

/// Whether the decoder reads the profile *fast*. Without it the compiler leaves out what would.
pub(super) const STREAMS: bool = Profile::Fast.is_supported();
