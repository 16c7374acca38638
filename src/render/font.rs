//! The one font, part of the program.

use ab_glyph::FontRef;
use plotters::style::{FontStyle, register_font};
use std::sync::OnceLock;

const BYTES: &[u8] = include_bytes!("../../assets/fonts/DejaVuSans-subset.ttf");

/// Name under which charts know the font; viewers of SVG have one of this name.
pub(super) const NAME: &str = "sans-serif";

/// The font, for text on pictures.
pub(super) fn font() -> Option<FontRef<'static>> {
    FontRef::try_from_slice(BYTES).ok()
}

/// Makes the font known to the charts. Returns whether it is.
pub(super) fn register() -> bool {
    static DONE: OnceLock<bool> = OnceLock::new();
    *DONE.get_or_init(|| register_font(NAME, FontStyle::Normal, BYTES).is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;
    use ab_glyph::Font;

    #[test]
    fn the_font_has_what_labels_use() {
        let font = font().unwrap();
        for c in (' '..='~').chain("–—…·×°²−≤≥λ".chars()) {
            assert_ne!(font.glyph_id(c).0, 0, "{c:?}");
        }
        assert!(register());
    }
}
