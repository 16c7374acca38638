//! Which descriptor leaves the smallest distances, over all meshes of a folder.

use super::results::Results;
use lwc::descriptors::Descriptor;
use std::io::{self, Write};

/// One descriptor over all subjects.
#[derive(Debug, PartialEq)]
pub struct Rank {
    pub descriptor: &'static str,
    /// Mean over the subjects of the mean apd.
    pub mean_apd: f64,
    /// Mean apd over that of all descriptors on the same subject: mean, least and most.
    pub relative: [f64; 3],
    /// On how many subjects it is the best.
    pub wins: usize,
    /// Seconds in the descriptor over those of all descriptors on the same subject, mean.
    pub cost: f64,
}

/// The descriptors that every subject has, best first, and the number of subjects.
pub fn rank(results: &Results) -> (Vec<Rank>, usize) {
    let groups = results.by_subject();
    let everywhere: Vec<&'static str> = Descriptor::ALL
        .map(Descriptor::name)
        .into_iter()
        .filter(|name| groups.iter().all(|(_, runs)| runs.iter().any(|run| run.descriptor == *name)))
        .collect();
    // Per subject and descriptor: mean apd and seconds.
    let table: Vec<Vec<(f64, f64)>> = groups
        .iter()
        .map(|(_, runs)| {
            let runs = runs.iter().filter(|run| everywhere.contains(&run.descriptor.as_str()));
            runs.map(|run| (run.mean_apd(), run.descriptor_seconds())).collect()
        })
        .collect();
    let mut ranks: Vec<Rank> =
        everywhere.iter().enumerate().map(|(i, descriptor)| rank_one(descriptor, i, &table)).collect();
    ranks.sort_by(|a, b| a.relative[0].total_cmp(&b.relative[0]));
    (ranks, groups.len())
}

fn rank_one(descriptor: &'static str, i: usize, table: &[Vec<(f64, f64)>]) -> Rank {
    let count = table.len().max(1) as f64;
    let share = |row: &[(f64, f64)], value: fn(&(f64, f64)) -> f64| {
        let mean = row.iter().map(value).sum::<f64>() / row.len() as f64;
        if mean > 0.0 { value(&row[i]) / mean } else { 1.0 }
    };
    let relative: Vec<f64> = table.iter().map(|row| share(row, |cell| cell.0)).collect();
    let is_best = |row: &&Vec<(f64, f64)>| row.iter().all(|cell| cell.0 >= row[i].0);
    Rank {
        descriptor,
        mean_apd: table.iter().map(|row| row[i].0).sum::<f64>() / count,
        relative: [
            relative.iter().sum::<f64>() / count,
            relative.iter().copied().fold(f64::INFINITY, f64::min),
            relative.iter().copied().fold(0.0, f64::max),
        ],
        wins: table.iter().filter(is_best).count(),
        cost: table.iter().map(|row| share(row, |cell| cell.1)).sum::<f64>() / count,
    }
}

/// Prints the ranking as a table.
///
/// # Errors
/// If `out` fails.
pub fn print(out: &mut dyn Write, (ranks, subjects): &(Vec<Rank>, usize)) -> io::Result<()> {
    writeln!(
        out,
        "\nRanking over {subjects} meshes; percentages are of the mean of the descriptors on a mesh."
    )?;
    writeln!(
        out,
        "{:>4}  {:<12} {:>9} {:>11} {:>17} {:>6} {:>11}",
        "rank", "descriptor", "mean apd", "relative %", "least to most %", "best", "its time %"
    )?;
    for (place, rank) in ranks.iter().enumerate() {
        let [mean, least, most] = rank.relative.map(|ratio| 100.0 * ratio);
        writeln!(
            out,
            "{:>4}  {:<12} {:>9.5} {mean:>11.1} {:>17} {:>6} {:>11.0}",
            place + 1,
            rank.descriptor,
            rank.mean_apd,
            format!("{least:.1} to {most:.1}"),
            rank.wins,
            100.0 * rank.cost,
        )?;
    }
    Ok(())
}
