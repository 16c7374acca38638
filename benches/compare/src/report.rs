//! Tables and charts.

use crate::stream::{Measured, SHARES};
use crate::{Args, Row, others, single};
use anyhow::Context;
use lwc::render::{Chart, Series, log_ticks};
use std::fmt::Write;

/// RMS over the diagonal for which bits are told.
const ERRORS: [f64; 4] = [2e-3, 1e-3, 5e-4, 2e-4];
const COLOURS: [[u8; 3]; 10] = [
    [38, 100, 150],
    [210, 120, 30],
    [60, 140, 70],
    [150, 60, 140],
    [120, 120, 120],
    [180, 40, 50],
    [50, 170, 190],
    [30, 30, 30],
    [130, 90, 50],
    [230, 130, 180],
];

pub fn write(rows: &[Row], args: &Args) -> anyhow::Result<()> {
    let mut text = head(args);
    sizes(&mut text, rows, args)?;
    if !args.sizes_only {
        beginnings(&mut text, rows)?;
        errors(&mut text, rows, args)?;
    }
    speeds(&mut text, rows, args)?;
    let path = args.out.join("table.md");
    std::fs::write(&path, text).with_context(|| path.display().to_string())?;
    if let Some(row) = rows.last().filter(|_| !args.sizes_only) {
        let path = args.out.join(format!("{}.svg", row.model.name));
        std::fs::write(&path, chart(row).to_svg()?).with_context(|| path.display().to_string())?;
    }
    Ok(())
}

fn head(args: &Args) -> String {
    let today = time::OffsetDateTime::now_utc().date();
    let cpu = std::fs::read_to_string("/proc/cpuinfo").ok();
    let cpu = cpu.as_deref().and_then(|text| text.lines().find_map(|l| l.strip_prefix("model name")));
    let cpu = cpu.map_or("an unknown processor", |name| name.trim_start_matches([' ', '\t', ':']));
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    format!("{today}, {cores} cores of {cpu}, {} bits.\n", args.bits)
}

/// `| a | b |`
fn line(text: &mut String, cells: impl IntoIterator<Item = String>) -> std::fmt::Result {
    for cell in cells {
        write!(text, "| {cell} ")?;
    }
    text.push_str("|\n");
    Ok(())
}

fn heading(text: &mut String, title: &str, columns: &[String], num_names: usize) -> std::fmt::Result {
    writeln!(text, "\n## {title}\n")?;
    line(text, columns.iter().cloned())?;
    line(text, (0..columns.len()).map(|i| if i < num_names { "---" } else { "--:" }.to_owned()))
}

fn number(value: Option<f64>, digits: usize) -> String {
    value.map_or("–".to_owned(), |value| format!("{value:.digits$}"))
}

fn sizes(text: &mut String, rows: &[Row], args: &Args) -> std::fmt::Result {
    let names = args.variants.iter().map(|v| format!("lwc {v}"));
    let others = ["Draco", "meshopt", "meshopt + zstd", "raw + zstd"].map(str::to_owned);
    let columns: Vec<String> =
        ["mesh".to_owned(), "vertices".to_owned()].into_iter().chain(names).chain(others).collect();
    heading(text, "Whole files, bits per vertex", &columns, 1)?;
    let bytes = |row: &Row| -> Vec<Option<usize>> {
        let Row { others, streams, .. } = row;
        let own = streams.iter().map(|s| Some(s.bytes));
        own.chain([others.draco, Some(others.meshopt), Some(others.meshopt_zstd), Some(others.raw_zstd)])
            .collect()
    };
    for row in rows {
        let cells = bytes(row).into_iter().map(|b| number(b.map(|b| row.model.bits_per_vertex(b)), 2));
        line(text, [row.model.name.clone(), row.model.num_vertices().to_string()].into_iter().chain(cells))?;
    }
    if others::has_draco() && !rows.is_empty() {
        let mut means = vec![0.0; columns.len() - 2];
        for row in rows {
            let draco = row.others.draco.unwrap_or(1) as f64;
            let sizes = bytes(row);
            means
                .iter_mut()
                .zip(sizes)
                .for_each(|(m, b)| *m += (b.unwrap_or(0) as f64 / draco).ln() / rows.len() as f64);
        }
        let means = means.into_iter().map(|m| number(Some(m.exp()), 3));
        line(text, ["**over Draco**, geometric mean".to_owned(), String::new()].into_iter().chain(means))?;
    }
    Ok(())
}

fn beginnings(text: &mut String, rows: &[Row]) -> std::fmt::Result {
    let shares = SHARES.map(|share| format!("{:.0} %", 100.0 * share));
    let columns: Vec<String> = ["mesh".to_owned(), String::new()].into_iter().chain(shares).collect();
    let of = if others::has_draco() { "Draco's" } else { "meshopt's" };
    heading(text, &format!("Beginnings, dB at shares of {of} bytes"), &columns, 2)?;
    for row in rows {
        for stream in &row.streams {
            let cells = stream.at_shares.iter().map(|db| number(*db, 1));
            line(text, [row.model.name.clone(), stream.variant.to_string()].into_iter().chain(cells))?;
        }
        if let (false, Some(draco)) = (row.singles.is_empty(), row.others.draco) {
            let at = |share| single::at(&row.singles, (share * draco as f64) as usize);
            let cells = SHARES.map(|share| number(at(share), 1));
            line(text, [row.model.name.clone(), "best single file".to_owned()].into_iter().chain(cells))?;
        }
    }
    Ok(())
}

fn errors(text: &mut String, rows: &[Row], args: &Args) -> std::fmt::Result {
    let errors = ERRORS.map(|error| format!("{error:.0e}"));
    let columns: Vec<String> = ["mesh".to_owned(), String::new()].into_iter().chain(errors).collect();
    heading(text, "Bits per vertex to an error, RMS over the diagonal", &columns, 2)?;
    for row in rows {
        for stream in row.streams.iter().take(args.variants.len()) {
            let bytes = ERRORS.map(|error| bytes_to(stream, -20.0 * error.log10()));
            let cells = bytes.map(|b| number(b.map(|b| 8.0 * b / row.model.num_vertices() as f64), 2));
            line(text, [row.model.name.clone(), stream.variant.to_string()].into_iter().chain(cells))?;
        }
    }
    Ok(())
}

/// Along the curve, straight between its points in dB over log bytes.
fn bytes_to(stream: &Measured, db: f64) -> Option<f64> {
    let (a, b) = stream.curve.windows(2).map(|pair| (pair[0], pair[1])).find(|(_, b)| b.1 >= db)?;
    if a.1 >= db {
        return None;
    }
    let share = (db - a.1) / (b.1 - a.1);
    Some(((a.0 as f64).ln() + share * (b.0 as f64 / a.0 as f64).ln()).exp())
}

fn speeds(text: &mut String, rows: &[Row], args: &Args) -> std::fmt::Result {
    let names = args.variants.iter().flat_map(|v| [format!("encode {v}"), format!("decode {v}")]);
    let columns: Vec<String> =
        ["mesh".to_owned()].into_iter().chain(names).chain(["decode meshopt".to_owned()]).collect();
    heading(text, "Thousand vertices per second, in the process, decoders on one core", &columns, 1)?;
    for row in rows {
        let own = row.streams.iter().flat_map(|s| [s.encode_speed, s.decode_speed]);
        let cells = own.chain([row.others.meshopt_speed]).map(|speed| format!("{:.0}", speed / 1e3));
        line(text, [row.model.name.clone()].into_iter().chain(cells))?;
    }
    Ok(())
}

fn chart(row: &Row) -> Chart {
    let mut lines: Vec<(String, Vec<(usize, f64)>)> =
        row.streams.iter().map(|s| (format!("lwc {}", s.variant), s.curve.clone())).collect();
    if !row.singles.is_empty() {
        lines.push(("best single file".to_owned(), row.singles.clone()));
    }
    // The whole mesh as a single-rate file: nothing before its last byte.
    let full = row.streams.iter().filter_map(|s| s.curve.last()).map(|p| p.1).fold(0.0, f64::max);
    let single_rate = [("Draco", row.others.draco), ("meshopt + zstd", Some(row.others.meshopt_zstd))];
    for (name, bytes) in single_rate {
        lines.extend(bytes.map(|bytes| (name.to_owned(), vec![(bytes, full)])));
    }
    let points = || lines.iter().flat_map(|(_, points)| points);
    let ends = |value: &dyn Fn(&(usize, f64)) -> f64| {
        let (low, high) = (f64::INFINITY, f64::NEG_INFINITY);
        points().map(value).fold((low, high), |(low, high), v| (low.min(v), high.max(v)))
    };
    let ((first, last), (lowest, highest)) = (ends(&|p| p.0 as f64), ends(&|p| p.1));
    let series = lines.iter().zip(COLOURS.iter().cycle()).map(|((name, points), &colour)| Series {
        name: name.clone(),
        points: points.iter().map(|&(bytes, db)| ((bytes as f64).log10(), db)).collect(),
        colour,
    });
    Chart {
        title: row.model.name.clone(),
        labels: ["bytes".into(), "dB (original, of the diagonal)".into()],
        x_range: [first.log10() - 0.05, last.log10() + 0.05],
        x_ticks: log_ticks(first * 0.9, last * 1.1, |bytes| format!("{bytes:.0}")),
        y_range: [lowest - 2.0, highest + 2.0],
        series: series.collect(),
    }
}
