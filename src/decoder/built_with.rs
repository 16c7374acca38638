//! What the features of the crate leave in the decoder.

use crate::bitstream::profile::Profile;

/// Whether the decoder reads what a stream holds in addition to the surface. Otherwise it skips all of that like unknown
/// chunks, and the compiler leaves out the code that would read it.
pub(super) const ASSETS: bool = cfg!(feature = "assets");

/// Whether the decoder reads the profile *fast*. Otherwise the compiler leaves out the code that would.
pub(super) const STREAMS: bool = Profile::Fast.is_supported();
