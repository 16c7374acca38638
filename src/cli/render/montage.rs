//! All levels of a stream side by side.

use super::args::Render;
use crate::cli::bar::Part;
use crate::cli::exit::Failure;
use crate::cli::input_file::is_stream;
use crate::cli::stream::StreamSource;
use anyhow::Context;
use lwc::metrics::{CompareOptions, compare_with_progress};
use lwc::render::{Camera, Image, Paint, RenderError, render};
use lwc::{DecodeError, Decoder, TriMesh};

/// Distances are shown with a tenth of a decibel: this many samples are plenty.
const SAMPLES: usize = 50_000;

/// One level: the mesh with the precision it has when the next split begins.
struct Level {
    level: u32,
    mesh: TriMesh,
    /// Bytes of the stream up to here.
    end: u64,
}

pub(super) fn montage(args: &Render, part: Part) -> anyhow::Result<Image> {
    let name = args.input.display().to_string();
    if !is_stream(&args.input) {
        let what = "a montage shows the levels of a stream (.lwc)".to_owned();
        return Err(Failure::Usage(what)).context(name);
    }
    let bytes = StreamSource::File(args.input.clone()).read()?;
    let [decoding, drawing] = part.split([("decoding", 20.0), ("drawing", 80.0)]);
    let levels = decode(&bytes, args, decoding).with_context(|| name.clone())?;
    let finest = levels.last().ok_or(DecodeError::NoMesh).with_context(|| name.clone())?;
    let wanted = |level: &&Level| args.levels.is_empty() || args.levels.contains(&level.level);
    let shown: Vec<&Level> = levels.iter().filter(wanted).collect();
    if shown.is_empty() {
        let what = format!("none of these levels is there, the finest is {}", finest.level);
        return Err(Failure::Usage(what)).context(name);
    }

    let style = args.picture.style();
    let [width, height] = style.size;
    let camera = Camera::fit(&finest.mesh, args.picture.view, args.picture.up, width, height);
    let mut cells = Vec::new();
    for (i, level) in shown.iter().enumerate() {
        let part = drawing.between(i as f64 / shown.len() as f64, (i + 1) as f64 / shown.len() as f64);
        part.set(0.0);
        let picture = render(&level.mesh, Paint::Plain, &camera, &style)?;
        let options = CompareOptions::new().samples(SAMPLES);
        let distance = compare_with_progress(&finest.mesh, &level.mesh, &options, &|done| part.set(done))
            .with_context(|| name.clone())?;
        let db = distance.psnr_db();
        let quality = if db.is_finite() { format!("{db:.1} dB") } else { "complete".to_owned() };
        let vertices = grouped(level.mesh.num_vertices() as u64);
        let caption = [
            format!("level {}: {vertices} vertices", level.level),
            format!("{} bytes, {quality}", grouped(level.end)),
        ];
        cells.push((picture, caption));
    }
    Ok(arrange(&cells, args.columns, style.background)?)
}

/// Every level in turn; a level lasts until the next split begins.
fn decode(bytes: &[u8], args: &Render, part: Part) -> Result<Vec<Level>, DecodeError> {
    let mut decoder = Decoder::new(args.limits.limits());
    decoder.feed(bytes)?;
    let mut levels: Vec<Level> = Vec::new();
    while let Some(update) = decoder.step()? {
        let pass = update.pass;
        part.set(pass.end as f64 / bytes.len() as f64);
        let passes = decoder.info().map_or(&[][..], |info| info.passes());
        let next = passes.get(decoder.passes_done());
        // Only the last mesh of a level is copied.
        if next.is_some_and(|next| next.level == pass.level) {
            continue;
        }
        if let Some(mesh) = decoder.mesh() {
            levels.push(Level { level: pass.level, mesh: mesh.to_tri_mesh(), end: pass.end });
        }
    }
    Ok(levels)
}

fn arrange(
    cells: &[(Image, [String; 2])],
    columns: Option<u32>,
    background: [u8; 4],
) -> Result<Image, RenderError> {
    let (cell_width, cell_height) =
        cells.first().map_or((1, 1), |(image, _)| (image.width(), image.height()));
    let size = (cell_width as f32 / 17.0).clamp(8.0, 20.0);
    let line = (1.3 * size).ceil() as u32;
    let caption_height = 2 * line + line / 2;
    let count = cells.len() as u32;
    let square = (f64::from(count) * f64::from(cell_height + caption_height) / f64::from(cell_width)).sqrt();
    let columns = columns.unwrap_or_else(|| square.ceil() as u32).clamp(1, count.max(1));
    let rows = count.div_ceil(columns);
    let (width, height) =
        (columns.saturating_mul(cell_width), rows.saturating_mul(cell_height + caption_height));
    let mut sheet = Image::new(width, height, background)?;
    let is_dark = background[3] > 0 && background[..3].iter().all(|&c| c < 110);
    let ink = if is_dark { [235; 3] } else { [40; 3] };
    for ((image, caption), i) in cells.iter().zip(0..) {
        let (x, y) = (i % columns * cell_width, i / columns * (cell_height + caption_height));
        sheet.paste(image, i64::from(x), i64::from(y));
        for (text, k) in caption.iter().zip(0_u32..) {
            let left = (x as f32 + (cell_width as f32 - Image::text_width(text, size)) / 2.0).max(0.0);
            sheet.text(text, [left, (y + cell_height + k * line) as f32], size, ink);
        }
    }
    Ok(sheet)
}

/// 1234567 → `1,234,567`.
fn grouped(n: u64) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_groups_of_three() {
        let grouped = [0, 12, 999, 1000, 123_456, 1_234_567].map(grouped);
        assert_eq!(grouped, ["0", "12", "999", "1,000", "123,456", "1,234,567"]);
    }

    #[test]
    fn cells_fill_rows() {
        let cell = || (Image::new(100, 50, [9; 4]).unwrap(), ["a".to_owned(), "b".to_owned()]);
        let sheet = arrange(&[cell(), cell(), cell()], Some(2), [255; 4]).unwrap();
        assert_eq!((sheet.width(), sheet.height()), (200, 2 * (50 + 27)));
        assert_eq!(sheet.pixel(150, 25), Some([9; 4]));
        assert_eq!(sheet.pixel(150, 100), Some([255; 4]));
    }
}
