//! `lwc info --plot`: how near each prefix of a stream comes to its finest mesh.

use super::bar::Part;
use super::decoding::Decoding;
use super::exit::Failure;
use super::output::{Destination, has_ending, pixels_of, say_written};
use super::quantity::counted;
use super::stream::StreamSource;
use super::ui::Ui;
use anyhow::Context;
use lwc::metrics::{CompareOptions, compare};
use lwc::render::{Chart, Series, log_ticks};
use lwc::{DecodeError, DecodeOptions, Decoder, Limits};
use std::path::Path;

/// Samples of each surface; the curve is drawn, not tabulated.
const SAMPLES: usize = 50_000;

/// One prefix.
struct Point {
    bytes: u64,
    /// −20 log₁₀ of the root mean square distance over the diagonal.
    db: f64,
}

/// Decodes the stream twice, as meshes of all passes would fill memory, and draws.
pub fn run(input: Option<&Path>, limits: Limits, plot: &Path, ui: &Ui) -> anyhow::Result<()> {
    let destination = Destination::new(plot.to_owned());
    if !has_ending(plot, "svg") && !has_ending(plot, "png") {
        let what = "unknown ending; plots are written as .svg or .png".to_owned();
        return Err(Failure::Usage(what)).with_context(|| destination.name());
    }
    let source = StreamSource::new(input)?;
    destination.check(source.path(), true)?;
    let bytes = source.read()?;
    let bar = ui.bar();
    let parts = bar.split([("decoding", 20.0), ("measuring", 80.0)]);
    let points = measure(&bytes, limits, parts).with_context(|| source.name())?;
    drop(bar);
    let name = source.path().and_then(Path::file_name).unwrap_or_default().to_string_lossy().into_owned();
    let chart =
        chart(name, &points).ok_or_else(|| Failure::Usage("a stream of one pass has no curve".into()))?;
    let passes = counted(points.len(), "pass", "passes");
    let what = if has_ending(plot, "svg") {
        let text = chart.to_svg()?;
        destination.write(|out| out.write_all(text.as_bytes()))?;
        format!("chart of {passes}")
    } else {
        let image = chart.to_image()?;
        destination.write(|out| image.write_png(out))?;
        format!("chart of {passes}, {}", pixels_of(&image))
    };
    say_written(&destination, &what, ui);
    Ok(())
}

fn measure(bytes: &[u8], limits: Limits, [decoding, measuring]: [Part; 2]) -> anyhow::Result<Vec<Point>> {
    let options = DecodeOptions::new().limits(limits);
    let mut whole = Decoding::new(options, None, None, decoding);
    whole.take(bytes, |_| ())?;
    let finest = whole.decoder.preview().ok_or(DecodeError::NoMesh)?;
    let num_passes = whole.decoder.passes_done();
    let mut decoder = Decoder::with_options(options);
    decoder.feed(bytes)?;
    let mut points = Vec::new();
    while let Some(update) = decoder.step()? {
        let mesh = decoder.mesh().ok_or(DecodeError::NoMesh)?.to_tri_mesh();
        let distance = compare(&finest, &mesh, &CompareOptions::new().samples(SAMPLES))?;
        points.push(Point { bytes: update.pass.end, db: distance.psnr_db() });
        measuring.set(points.len() as f64 / num_passes as f64);
    }
    Ok(points)
}

/// `None` if fewer than two prefixes differ from the finest mesh.
fn chart(title: String, points: &[Point]) -> Option<Chart> {
    let finite: Vec<&Point> = points.iter().filter(|point| point.db.is_finite()).collect();
    let (first, last) = (finite.first()?.bytes as f64, points.last()?.bytes as f64);
    let lowest = finite.iter().map(|point| point.db).fold(f64::INFINITY, f64::min);
    let highest = finite.iter().map(|point| point.db).fold(f64::NEG_INFINITY, f64::max);
    let line = finite.iter().map(|point| ((point.bytes as f64).log10(), point.db)).collect();
    (finite.len() > 1).then(|| Chart {
        title,
        labels: ["bytes".into(), "dB (finest mesh, of the diagonal)".into()],
        x_range: [first.log10() - 0.05, last.log10() + 0.05],
        x_ticks: log_ticks(first * 0.9, last * 1.1, short),
        y_range: [lowest - 2.0, highest + 2.0],
        series: vec![Series { name: String::new(), points: line, colour: [38, 100, 150] }],
    })
}

/// 2000 → `2 k`.
fn short(bytes: f64) -> String {
    let (unit, name) = if bytes >= 1e6 {
        (1e6, " M")
    } else if bytes >= 1e3 {
        (1e3, " k")
    } else {
        (1.0, "")
    };
    format!("{}{name}", bytes / unit)
}
