//! Charts like figures 11 to 18 of the paper: descriptors side by side, one line per step.

use super::results::{Run, Subject};
use anyhow::Context;
use lwc::experiment::Step;
use lwc::render::{Chart, Series, sequential};
use std::io;
use std::path::Path;

/// Draws the runs of one mesh: the distances, and their ratio to the mean of all descriptors.
///
/// # Errors
/// If a file cannot be written.
pub fn write(folder: &Path, subject: &Subject, runs: &[&Run]) -> anyhow::Result<()> {
    let num_steps = runs.iter().map(|run| run.steps.len()).max().unwrap_or(0);
    if num_steps == 0 {
        return Ok(());
    }
    let title = subject.title();
    save(folder, &title, &distances(&title, runs, num_steps))?;
    if runs.len() > 1 {
        save(folder, &format!("{title}-relative"), &relative(&title, runs, num_steps))?;
    }
    Ok(())
}

fn distances(title: &str, runs: &[&Run], num_steps: usize) -> Chart {
    let apd = |_: usize, step: &Step| step.apd;
    let mut chart = chart(title, "apd, mean edges of the mesh", runs, num_steps, apd);
    chart.y_range = [0.0, 1.08 * highest(&chart).max(f64::MIN_POSITIVE)];
    chart
}

fn relative(title: &str, runs: &[&Run], num_steps: usize) -> Chart {
    let mean = |i: usize| {
        let values: Vec<f64> = runs.iter().filter_map(|run| Some(run.steps.get(i)?.apd)).collect();
        values.iter().sum::<f64>() / values.len().max(1) as f64
    };
    let means: Vec<f64> = (0..num_steps).map(mean).collect();
    let ratio =
        |i: usize, step: &Step| if means[i] > 0.0 { 100.0 * (step.apd / means[i] - 1.0) } else { 0.0 };
    let mut chart = chart(title, "apd over the mean of the descriptors, %", runs, num_steps, ratio);
    let reach = chart.series.iter().flat_map(|s| &s.points).map(|p| p.1.abs()).fold(1.0, f64::max);
    chart.y_range = [-1.1 * reach, 1.1 * reach];
    chart
}

fn chart(
    title: &str,
    label: &str,
    runs: &[&Run],
    num_steps: usize,
    value: impl Fn(usize, &Step) -> f64,
) -> Chart {
    let series = |i: usize| {
        let points = runs.iter().zip(0_u32..).filter_map(|(run, x)| {
            let step = run.steps.get(i)?;
            Some((f64::from(x), value(i, step)))
        });
        let place = (i as f64 + 0.5) / num_steps as f64;
        Series { name: format!("step {}", i + 1), points: points.collect(), colour: sequential(0.92 * place) }
    };
    let names = runs.iter().zip(0_u32..).map(|(run, x)| (f64::from(x), run.descriptor.clone()));
    Chart {
        title: title.to_owned(),
        labels: [String::new(), label.to_owned()],
        // Room for the legend on the left.
        x_range: [-1.2, runs.len() as f64 - 0.6],
        x_ticks: names.collect(),
        y_range: [0.0, 1.0],
        // The coarsest step is the highest line, and the first in the legend.
        series: (0..num_steps).rev().map(series).collect(),
    }
}

fn highest(chart: &Chart) -> f64 {
    chart.series.iter().flat_map(|series| &series.points).map(|point| point.1).fold(0.0, f64::max)
}

fn save(folder: &Path, name: &str, chart: &Chart) -> anyhow::Result<()> {
    let svg = folder.join(format!("{name}.svg"));
    let text = chart.to_svg().with_context(|| svg.display().to_string())?;
    let written: io::Result<()> = lwc::io::write_atomic(&svg, |out| out.write_all(text.as_bytes()));
    written.with_context(|| svg.display().to_string())?;
    let png = folder.join(format!("{name}.png"));
    let image = chart.to_image().with_context(|| png.display().to_string())?;
    let written: io::Result<()> = lwc::io::write_atomic(&png, |out| image.write_png(out));
    written.with_context(|| png.display().to_string())
}
