//! What positions and attributes become on their way into a file, and what they lose there.

mod colours;
mod dropped;
mod floats;
mod join;
mod neutral;
mod positions;
mod seams;
mod texture;

pub(super) use colours::{ColourFormat, ColourNumbers, converted};
pub(super) use dropped::{SPLIT_SEAMS, dropped};
pub(super) use floats::as_float32;
pub(super) use join::joined;
pub(super) use neutral::{Neutral, filled};
#[cfg(feature = "gltf")]
pub(super) use positions::Rounding;
pub(super) use positions::{check_float32, is_float32, loss_of, rounding};
pub(super) use seams::Split;
pub(super) use texture::oriented;
