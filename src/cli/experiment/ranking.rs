//! Which descriptor leaves the smallest distances, over all meshes of a folder.

use super::results::{Results, Run};
use lwc::descriptors::Descriptor;
use lwc::experiment::Step;
use std::io::{self, Write};

/// One descriptor over all subjects.
#[derive(Debug, PartialEq)]
pub struct Rank {
    pub descriptor: &'static str,
    /// Mean over the subjects of the mean apd.
    pub mean_apd: f64,
    /// Mean apd over that of all descriptors on the same subject: mean, least and most.
    pub relative: [f64; 3],
    /// As the mean of `relative`, but at the same numbers of vertices: a descriptor that removes fewer in a
    /// step is on a finer mesh after as many steps.
    pub same_vertices: f64,
    /// On how many subjects it is the best.
    pub wins: usize,
    /// Seconds in the descriptor over those of all descriptors on the same subject, mean.
    pub cost: f64,
}

/// The descriptors that every subject has, with noise or without, best first, and the number of subjects.
pub fn rank(results: &Results, with_noise: bool) -> (Vec<Rank>, usize) {
    let mut groups = results.by_subject();
    groups.retain(|(subject, _)| subject.noise.is_some() == with_noise);
    let everywhere: Vec<&'static str> = Descriptor::ALL
        .map(Descriptor::name)
        .into_iter()
        .filter(|name| groups.iter().all(|(_, runs)| runs.iter().any(|run| run.descriptor == *name)))
        .collect();
    let table: Vec<Vec<Cell>> = groups
        .iter()
        .map(|(_, runs)| {
            let runs = runs.iter().filter(|run| everywhere.contains(&run.descriptor.as_str()));
            row(&runs.copied().collect::<Vec<_>>())
        })
        .collect();
    let mut ranks: Vec<Rank> =
        everywhere.iter().enumerate().map(|(i, descriptor)| rank_one(descriptor, i, &table)).collect();
    ranks.sort_by(|a, b| a.relative[0].total_cmp(&b.relative[0]));
    (ranks, groups.len())
}

/// One run.
#[derive(Clone, Copy)]
struct Cell {
    apd: f64,
    apd_at_same_vertices: f64,
    seconds: f64,
}

/// Numbers of vertices at which the runs of a subject are compared.
const PLACES: u32 = 16;

/// The runs of a subject.
fn row(runs: &[&Run]) -> Vec<Cell> {
    let vertices = |step: Option<&Step>| step.map_or(1.0, |step| step.vertices as f64);
    let most = runs.iter().map(|run| vertices(run.steps.first())).fold(f64::INFINITY, f64::min);
    let least = runs.iter().map(|run| vertices(run.steps.last())).fold(1.0, f64::max);
    let place = |i: u32| most * (least / most).powf(f64::from(i) / f64::from(PLACES - 1));
    let cell = |run: &&Run| Cell {
        apd: run.mean_apd(),
        apd_at_same_vertices: (0..PLACES).map(|i| run.apd_at(place(i))).sum::<f64>() / f64::from(PLACES),
        seconds: run.descriptor_seconds(),
    };
    runs.iter().map(cell).collect()
}

fn rank_one(descriptor: &'static str, i: usize, table: &[Vec<Cell>]) -> Rank {
    let count = table.len().max(1) as f64;
    let share = |row: &[Cell], value: fn(&Cell) -> f64| {
        let mean = row.iter().map(value).sum::<f64>() / row.len() as f64;
        if mean > 0.0 { value(&row[i]) / mean } else { 1.0 }
    };
    let mean_share = |value| table.iter().map(|row| share(row, value)).sum::<f64>() / count;
    let relative: Vec<f64> = table.iter().map(|row| share(row, |cell| cell.apd)).collect();
    let is_best = |row: &&Vec<Cell>| row.iter().all(|cell| cell.apd >= row[i].apd);
    Rank {
        descriptor,
        mean_apd: table.iter().map(|row| row[i].apd).sum::<f64>() / count,
        relative: [
            relative.iter().sum::<f64>() / count,
            relative.iter().copied().fold(f64::INFINITY, f64::min),
            relative.iter().copied().fold(0.0, f64::max),
        ],
        same_vertices: mean_share(|cell| cell.apd_at_same_vertices),
        wins: table.iter().filter(is_best).count(),
        cost: mean_share(|cell| cell.seconds),
    }
}

/// Prints the rankings of the runs without and with noise.
///
/// # Errors
/// If `out` fails.
pub fn print(out: &mut dyn Write, results: &Results) -> io::Result<()> {
    for with_noise in [false, true] {
        let (ranks, subjects) = rank(results, with_noise);
        if subjects > 0 {
            let meshes = crate::cli::quantity::counted(subjects, "mesh", "meshes");
            let noise = if with_noise { " with noise" } else { "" };
            writeln!(out, "\nRanking over {meshes}{noise}; percentages are of the mean of the descriptors.")?;
            print_table(out, &ranks)?;
        }
    }
    Ok(())
}

fn print_table(out: &mut dyn Write, ranks: &[Rank]) -> io::Result<()> {
    writeln!(
        out,
        "{:>4}  {:<12} {:>9} {:>11} {:>17} {:>16} {:>5} {:>11}",
        "rank",
        "descriptor",
        "mean apd",
        "relative %",
        "least to most %",
        "same vertices %",
        "best",
        "its time %"
    )?;
    for (place, rank) in ranks.iter().enumerate() {
        let [mean, least, most] = rank.relative.map(|ratio| 100.0 * ratio);
        writeln!(
            out,
            "{:>4}  {:<12} {:>9.5} {mean:>11.1} {:>17} {:>16.1} {:>5} {:>11.0}",
            place + 1,
            rank.descriptor,
            rank.mean_apd,
            format!("{least:.1} to {most:.1}"),
            100.0 * rank.same_vertices,
            rank.wins,
            100.0 * rank.cost,
        )?;
    }
    Ok(())
}
