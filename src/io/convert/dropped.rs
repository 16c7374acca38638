//! What a format has no place for.

use crate::losses::{Loss, LossKind, Stage};

/// Something that is left out, and what keeps it.
pub fn dropped(name: &str, remedy: &str) -> Loss {
    Loss::new(Stage::Writing, LossKind::Dropped, name).remedy(remedy)
}

/// What keeps an attribute that has seams, where a format has no corners for it.
pub const SPLIT_SEAMS: &str = "it has seams, which `--split-seams` repeats vertices for";
