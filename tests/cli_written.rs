//! Each command says in one line what it wrote.
#![cfg(feature = "cli")]
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

mod common;

use common::workshop::*;
use std::fs;

/// Lines of commands that write a file, the file, and what is said of it.
const WRITTEN: [(&str, &str, &str); 14] = [
    ("decode ball.lwc -o fine.obj", "fine.obj", "642 vertices, 1280 triangles, level "),
    ("render ball.ply -o ball.png --size 64x48", "ball.png", "64 × 48 pixels"),
    ("render ball.lwc -o levels.png --montage --size 40x30", "levels.png", " pixels"),
    ("render ball.ply -o heat.png --size 64x48 --color-by sqem", "heat.png", " × 48 pixels"),
    ("describe ball.ply -o ball.csv", "ball.csv", "642 rows"),
    ("describe ball.ply -o describe.png --size 64x48", "describe.png", " × 48 pixels"),
    ("describe ball.ply -d sqem -o heat.ply", "heat.ply", "642 vertices, 1280 triangles, coloured by sqem"),
    ("info ball.lwc --plot curve.svg", "curve.svg", "chart of "),
    ("info ball.lwc --plot curve.png", "curve.png", " pixels"),
    ("filter ball.ply --gain 5..=0 -o smooth.ply", "smooth.ply", "642 vertices, 1280 triangles"),
    ("filter ball.ply --denoise -o clean.stl", "clean.stl", "642 vertices, 1280 triangles"),
    (
        "edit ball.lwc coarse.obj -o bent.glb",
        "bent.glb",
        "642 vertices, 1280 triangles, details above level 2",
    ),
    ("encode ball.ply -o other.lwc", "other.lwc", "642 vertices, 1280 triangles"),
    ("man pages", "pages", " manual pages"),
];

fn workshop() -> Workshop {
    let workshop = Workshop::new();
    workshop.ball_stream();
    workshop.ok("decode ball.lwc --level 2 -o coarse.obj");
    workshop
}

#[test]
fn each_file_is_named_with_what_is_in_it() {
    let workshop = workshop();
    for (line, file, what) in WRITTEN {
        let (stdout, stderr) = workshop.ok(line);
        let said = |line: &&str| line.starts_with(&format!("{file}: "));
        let found: Vec<&str> = stderr.lines().filter(said).collect();
        assert!(found.len() == 1 && found[0].contains(what), "`{line}`: {stderr}");
        // The numbers of a filter are what was asked for.
        assert_eq!(stdout.is_empty(), !line.starts_with("filter"), "`{line}`: {stdout}");
        let written = fs::metadata(workshop.path(file)).unwrap();
        let size = format!("{} bytes", written.len());
        assert!(written.is_dir() || stderr.contains(&size), "`{line}`: {stderr}");
    }
}

#[test]
fn an_experiment_names_its_folder() {
    let workshop = workshop();
    let (stdout, stderr) = workshop.ok("experiment ball.ply -d pca,sqem --levels 2 --output results");
    assert_eq!(stderr, "results: results.json and results.csv of 2 runs, charts of 1 mesh\n");
    assert!(stdout.contains("Ranking over 1 mesh"), "{stdout}");
}

#[test]
fn nothing_is_said_where_nobody_wants_to_know() {
    let workshop = workshop();
    for (line, _, _) in WRITTEN {
        assert_eq!(workshop.ok(&format!("{line} --quiet")), (String::new(), String::new()), "`{line}`");
    }
}

#[test]
fn nothing_is_said_of_standard_output() {
    let workshop = workshop();
    for line in [
        "encode ball.ply -o -",
        "decode ball.lwc -o -",
        "render ball.ply -o - --size 64x48",
        "describe ball.ply",
        "completions bash",
        "man",
        "compare ball.ply ball.lwc",
        "info ball.lwc",
    ] {
        let output = workshop.run(line);
        assert!(output.status.success() && !output.stdout.is_empty(), "`{line}`");
        assert_eq!(text(output.stderr), "", "`{line}`");
    }
}
