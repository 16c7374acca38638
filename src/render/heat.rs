//! Heat maps: values made colours, and the legend that says which.

use super::{Image, RenderError, sequential};

/// Values of a field as shares of the range that is shown.
#[derive(Clone, Debug, PartialEq)]
pub struct Heat {
    /// In [0, 1], one per vertex.
    pub values: Vec<f64>,
    /// What 0 stands for.
    pub low: f64,
    /// What 1 stands for.
    pub high: f64,
}

impl Heat {
    /// Spreads `values` over [0, 1].
    ///
    /// The lowest and highest `clip` percent (0 to 50) are cut off first: they get the colours of the
    /// ends. Without, a few isolated maxima leave one colour for all the rest. All is 0 if the range is
    /// empty.
    pub fn new(values: &[f64], clip: f64) -> Self {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        let last = sorted.len().saturating_sub(1);
        let cut = (last as f64 * clip.clamp(0.0, 50.0) / 100.0).floor() as usize;
        let (low, high) = match (sorted.get(cut), sorted.get(last - cut)) {
            (Some(&low), Some(&high)) => (low, high),
            _ => (0.0, 0.0),
        };
        let share =
            |&value: &f64| if high > low { ((value - low) / (high - low)).clamp(0.0, 1.0) } else { 0.0 };
        Self { values: values.iter().map(share).collect(), low, high }
    }
}

/// Width of the legend, pixels per pixel of text height.
const WIDTH: f32 = 7.0;

/// `picture` with a bar of colours on its right: the ends of the range and its middle, under `title`.
///
/// # Errors
/// If the picture becomes too large.
pub fn with_legend(
    picture: &Image,
    title: &str,
    heat: &Heat,
    background: [u8; 4],
) -> Result<Image, RenderError> {
    let height = picture.height();
    let text = (height as f32 / 30.0).clamp(9.0, 22.0);
    let margin = text.ceil() as i64;
    let numbers = [(0.0, heat.low), (0.5, (heat.low + heat.high) / 2.0), (1.0, heat.high)];
    let labels = numbers.map(|(share, value)| (share, label(value)));
    let widest = labels.iter().map(|(_, label)| Image::text_width(label, text)).fold(0.0, f32::max);
    let bar = margin + margin / 2;
    let width = (margin as f32 * 3.0 + bar as f32 + widest).max(Image::text_width(title, text) + 2.0 * text);
    let width = width.max(WIDTH * text).ceil() as u32;
    let mut image = Image::new(picture.width() + width, height, background)?;
    image.paste(picture, 0, 0);
    let left = i64::from(picture.width()) + margin;
    let ink = if background[3] > 0 && background[..3].iter().all(|&c| c < 110) { [235; 3] } else { [40; 3] };
    image.text(title, [left as f32, margin as f32], text, ink);
    let (top, bottom) = (3 * margin, i64::from(height) - 2 * margin);
    let length = (bottom - top).max(1);
    for row in 0..length {
        let [r, g, b] = sequential(1.0 - row as f64 / (length - 1).max(1) as f64);
        image.fill([left, top + row], [bar, 1], [r, g, b, 255]);
    }
    for (share, label) in &labels {
        let y = top as f32 + (1.0 - *share as f32) * length as f32 - 0.58 * text;
        image.text(label, [(left + bar + margin / 2) as f32, y], text, ink);
    }
    Ok(image)
}

/// A number in three digits.
fn label(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 {
        "0".into()
    } else if (1e-3..1e4).contains(&size) {
        let digits = (2 - size.log10().floor() as i32).max(0) as usize;
        format!("{value:.digits$}")
    } else {
        format!("{value:.1e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clipping_keeps_isolated_maxima_from_ruling() {
        let mut values: Vec<f64> = (0..100).map(f64::from).collect();
        values.push(1e6);
        let all = Heat::new(&values, 0.0);
        assert_eq!((all.low, all.high, all.values[100]), (0.0, 1e6, 1.0));
        assert!(all.values[99] < 1e-3);
        let clipped = Heat::new(&values, 1.0);
        assert_eq!((clipped.low, clipped.high), (1.0, 99.0));
        assert_eq!((clipped.values[0], clipped.values[50], clipped.values[100]), (0.0, 0.5, 1.0));
    }

    #[test]
    fn constant_and_missing_values_are_all_low() {
        assert_eq!(Heat::new(&[3.0, 3.0], 0.0).values, [0.0, 0.0]);
        assert_eq!(Heat::new(&[], 2.0), Heat { values: vec![], low: 0.0, high: 0.0 });
    }

    #[test]
    fn labels_have_three_digits() {
        let labels = [0.0, 1.0, 0.012345, 123.456, 9876.0, 1e-5, 2.5e7].map(label);
        assert_eq!(labels, ["0", "1.00", "0.0123", "123", "9876", "1.0e-5", "2.5e7"]);
    }

    #[test]
    fn the_legend_shows_both_ends_of_the_map() {
        let picture = Image::new(200, 200, [255; 4]).unwrap();
        let heat = Heat { values: vec![], low: 0.0, high: 1.0 };
        let image = with_legend(&picture, "pca", &heat, [255; 4]).unwrap();
        assert!(image.width() > 240 && image.height() == 200);
        for share in [0.0, 1.0] {
            let [r, g, b] = sequential(share);
            assert!(image.rgba().as_chunks::<4>().0.contains(&[r, g, b, 255]), "{share}");
        }
    }
}
