//! Pixels, and text on them.

use super::RenderError;
use super::font::font;
use ab_glyph::{Font, Glyph, ScaleFont, point};
use rayon::prelude::*;
use std::io;

/// Longest side of a picture, pixels.
const MAX_SIDE: u32 = 16_384;

/// A picture: rows from the top, 8 bits each of red, green, blue and opacity (not premultiplied), sRGB.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    width: u32,
    height: u32,
    rgba: Vec<u8>,
}

impl Image {
    /// A picture of one colour.
    ///
    /// # Errors
    /// If a side is 0 or more than 16384 pixels.
    pub fn new(width: u32, height: u32, colour: [u8; 4]) -> Result<Self, RenderError> {
        if !(1..=MAX_SIDE).contains(&width) || !(1..=MAX_SIDE).contains(&height) {
            return Err(RenderError::Size { width, height });
        }
        let rgba = colour.repeat(width as usize * height as usize);
        Ok(Self { width, height, rgba })
    }

    /// A picture that is made small before anybody sees it, of any size.
    pub(super) fn oversized([width, height]: [usize; 2], colour: [u8; 4]) -> Self {
        Self { width: width as u32, height: height as u32, rgba: colour.repeat(width * height) }
    }

    pub(super) fn par_rows_mut(&mut self) -> impl IndexedParallelIterator<Item = &mut [u8]> {
        self.rgba.par_chunks_exact_mut(4 * self.width as usize)
    }

    /// Opaque pixels, three bytes each.
    pub(super) fn from_rgb(width: u32, height: u32, rgb: &[u8]) -> Self {
        let rgba = rgb.as_chunks::<3>().0.iter().flat_map(|&[r, g, b]| [r, g, b, 255]).collect();
        Self { width, height, rgba }
    }

    /// The picture `factor` times smaller in each direction; each pixel is the mean of those it covers,
    /// weighed by their opacity. Pixels that do not fill one are left out.
    pub(super) fn reduced(&self, factor: u32) -> Self {
        let (width, height) = ((self.width / factor).max(1), (self.height / factor).max(1));
        let row_bytes = 4 * self.width as usize;
        let mut rgba = vec![0; 4 * width as usize * height as usize];
        rgba.par_chunks_exact_mut(4 * width as usize).enumerate().for_each(|(y, row)| {
            for (x, pixel) in row.as_chunks_mut::<4>().0.iter_mut().enumerate() {
                let mut sums = [0_u32; 4];
                for line in 0..factor as usize {
                    let begin = (y * factor as usize + line) * row_bytes + 4 * x * factor as usize;
                    let Some(covered) = self.rgba.get(begin..begin + 4 * factor as usize) else { continue };
                    for &[r, g, b, opacity] in covered.as_chunks::<4>().0 {
                        let weight = u32::from(opacity);
                        for (sum, value) in sums.iter_mut().zip([r, g, b, 1]) {
                            *sum += weight * u32::from(value);
                        }
                    }
                }
                let [r, g, b, opacity] = sums;
                let mean = |sum: u32| ((sum + opacity / 2) / opacity.max(1)) as u8;
                let area = factor * factor;
                *pixel = [mean(r), mean(g), mean(b), ((opacity + area / 2) / area) as u8];
            }
        });
        Self { width, height, rgba }
    }

    /// Pixels across.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Pixels down.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Four bytes per pixel, rows from the top.
    pub fn rgba(&self) -> &[u8] {
        &self.rgba
    }

    /// Colour at column `x` of row `y`, `None` outside.
    pub fn pixel(&self, x: u32, y: u32) -> Option<[u8; 4]> {
        let at = self.index(i64::from(x), i64::from(y))?;
        self.rgba[at..at + 4].try_into().ok()
    }

    fn index(&self, x: i64, y: i64) -> Option<usize> {
        let inside = (0..i64::from(self.width)).contains(&x) && (0..i64::from(self.height)).contains(&y);
        inside.then(|| 4 * (y as usize * self.width as usize + x as usize))
    }

    /// Lays `colour` over a pixel; `cover` is its share of it, 0 to 1. Nothing happens outside.
    pub fn blend(&mut self, x: i64, y: i64, colour: [u8; 3], cover: f32) {
        let Some(at) = self.index(x, y) else { return };
        let cover = cover.clamp(0.0, 1.0);
        let under = f32::from(self.rgba[at + 3]) / 255.0 * (1.0 - cover);
        let opacity = cover + under;
        if opacity <= 0.0 {
            return;
        }
        for (byte, over) in self.rgba[at..at + 3].iter_mut().zip(colour) {
            *byte = ((f32::from(*byte) * under + f32::from(over) * cover) / opacity).round() as u8;
        }
        self.rgba[at + 3] = (opacity * 255.0).round() as u8;
    }

    /// Fills a rectangle; what lies outside is left out.
    pub fn fill(&mut self, [x, y]: [i64; 2], [width, height]: [i64; 2], colour: [u8; 4]) {
        for row in y..y + height {
            for column in x..x + width {
                if let Some(at) = self.index(column, row) {
                    self.rgba[at..at + 4].copy_from_slice(&colour);
                }
            }
        }
    }

    /// Copies `other` with its upper left corner at `x`, `y`.
    pub fn paste(&mut self, other: &Image, x: i64, y: i64) {
        for (row, pixels) in other.rgba.chunks_exact(4 * other.width as usize).enumerate() {
            for (column, pixel) in pixels.chunks_exact(4).enumerate() {
                if let Some(at) = self.index(x + column as i64, y + row as i64) {
                    self.rgba[at..at + 4].copy_from_slice(pixel);
                }
            }
        }
    }

    /// Width that [`Image::text`] takes, pixels.
    pub fn text_width(text: &str, size: f32) -> f32 {
        font().map_or(0.0, |font| layout(&font, text, size).1)
    }

    /// Writes one line of `text`, `size` pixels high, its upper left corner at `x`, `y`. Signs that the
    /// font lacks become boxes.
    pub fn text(&mut self, text: &str, [x, y]: [f32; 2], size: f32, colour: [u8; 3]) {
        let Some(font) = font() else { return };
        let ascent = font.as_scaled(size).ascent();
        for mut glyph in layout(&font, text, size).0 {
            glyph.position += point(x, y + ascent);
            let Some(outline) = font.outline_glyph(glyph) else { continue };
            let bounds = outline.px_bounds();
            outline.draw(|column, row, cover| {
                let at = [bounds.min.x as i64 + i64::from(column), bounds.min.y as i64 + i64::from(row)];
                self.blend(at[0], at[1], colour, cover);
            });
        }
    }

    /// Writes the picture as PNG.
    ///
    /// # Errors
    /// If `out` fails.
    pub fn write_png(&self, out: impl io::Write) -> io::Result<()> {
        let mut encoder = png::Encoder::new(out, self.width, self.height);
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&self.rgba)?;
        Ok(writer.finish()?)
    }
}

/// Glyphs on a line from 0 on, and the width of the line.
fn layout(font: &impl Font, text: &str, size: f32) -> (Vec<Glyph>, f32) {
    let scaled = font.as_scaled(size);
    let mut at = 0.0;
    let glyphs = text.chars().map(|c| {
        let id = scaled.glyph_id(c);
        let glyph = id.with_scale_and_position(size, point(at, 0.0));
        at += scaled.h_advance(id);
        glyph
    });
    (glyphs.collect(), at)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_png_reads_back() {
        let mut image = Image::new(7, 5, [10, 20, 30, 0]).unwrap();
        image.fill([2, 1], [100, 2], [1, 2, 3, 255]);
        let mut bytes = Vec::new();
        image.write_png(&mut bytes).unwrap();
        let mut reader = png::Decoder::new(io::Cursor::new(&bytes)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut pixels).unwrap();
        assert_eq!((info.width, info.height, &pixels[..]), (7, 5, image.rgba()));
        assert_eq!((image.pixel(2, 2), image.pixel(1, 2)), (Some([1, 2, 3, 255]), Some([10, 20, 30, 0])));
    }

    #[test]
    fn text_stays_within_its_width() {
        let width = Image::text_width("Mesh 17", 20.0);
        let mut image = Image::new(120, 30, [255; 4]).unwrap();
        image.text("Mesh 17", [10.0, 4.0], 20.0, [0; 3]);
        let dark = |x: u32| (0..30).any(|y| image.pixel(x, y).is_some_and(|p| p[0] < 128));
        let columns: Vec<u32> = (0..120).filter(|&x| dark(x)).collect();
        assert!(columns.len() > 30 && columns[0] >= 10);
        assert!(f64::from(*columns.last().unwrap()) < 10.0 + f64::from(width));
    }

    #[test]
    fn reduction_averages_what_is_there() {
        let mut image = Image::new(5, 4, [0, 0, 0, 0]).unwrap();
        image.fill([0, 0], [1, 2], [200, 0, 0, 255]);
        let small = image.reduced(2);
        assert_eq!((small.width(), small.height()), (2, 2));
        assert_eq!((small.pixel(0, 0), small.pixel(1, 1)), (Some([200, 0, 0, 128]), Some([0; 4])));
    }

    #[test]
    fn blending_over_nothing_keeps_the_colour() {
        let mut image = Image::new(1, 1, [0, 0, 0, 0]).unwrap();
        image.blend(0, 0, [200, 100, 50], 0.5);
        assert_eq!(image.pixel(0, 0), Some([200, 100, 50, 128]));
        image.blend(9, 0, [200, 100, 50], 0.5);
        assert!(Image::new(0, 4, [0; 4]).is_err());
    }
}
