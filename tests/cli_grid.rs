//! `lwc encode` with precision in the user's terms.
#![cfg(feature = "cli")]
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

mod common;

use common::workshop::{Workshop, error_line};
use common::{grid, map_positions};
use lwc::TriMesh;
use std::path::{Path, PathBuf};

/// Hills of 10 × 10 with vertices all 0.5, from x on.
fn tile(x: f64) -> TriMesh {
    let height = |x: f64, y: f64| 2.0 * (0.4 * x).sin() + (0.7 * y).cos();
    map_positions(grid(21, 21, |_, _| 0.0), |p| {
        let (x, y) = (p[0] / 2.0 + 5.0 + x, p[1] / 2.0);
        [x, y, height(x, y)]
    })
}

fn at(mesh: &TriMesh, x: f64) -> Vec<[u64; 3]> {
    let near = mesh.positions().iter().filter(|p| (p[0] - x).abs() < 0.1);
    let mut border: Vec<[u64; 3]> = near.map(|p| p.map(f64::to_bits)).collect();
    border.sort_unstable();
    border
}

fn decoded(workshop: &Workshop, options: &str, name: &str) -> TriMesh {
    workshop.ok(&format!("encode {name}.obj -o {name}.lwc --verify {options}"));
    workshop.ok(&format!("decode {name}.lwc -o {name}.back.ply"));
    workshop.mesh(&format!("{name}.back.ply"))
}

#[test]
fn neighbours_share_their_border_on_one_grid() {
    let workshop = Workshop::new();
    workshop.put("a.obj", &tile(0.0));
    workshop.put("b.obj", &tile(10.0));
    for lattice in ["0,0,0,0.003", "-17.3,1e5,0.1,0.003,0.02,0.0007"] {
        let [a, b] = ["a", "b"].map(|name| decoded(&workshop, &format!("--grid {lattice}"), name));
        assert_eq!(at(&a, 10.0).len(), 21);
        assert_eq!(at(&a, 10.0), at(&b, 10.0), "{lattice}");
    }
    let b = decoded(&workshop, "--grid a.lwc", "b");
    let a = workshop.mesh("a.back.ply");
    assert_eq!(at(&a, 10.0), at(&b, 10.0), "the lattice of the stream");
    let info = workshop.json("info b.lwc --json");
    assert_eq!(info["lattice"]["origin"][0], -17.3);
    assert_eq!(info["step"][2], 0.0007);
    assert!(info["lattice"]["offset"][0].as_i64().unwrap() > 1000);
    let (text, _) = workshop.ok("info b.lwc");
    assert!(
        text.contains("steps 0.003, 0.02, 0.0007") && text.contains("through (-17.3, 100000, 0.1)"),
        "{text}"
    );

    // That of the cubic grid of a stream.
    workshop.ok("encode a.obj -o cubic.lwc");
    workshop.ok("encode b.obj -o other.lwc --grid cubic.lwc --verify");
    let [cubic, other] = ["cubic", "other"].map(|name| workshop.json(&format!("info {name}.lwc --json")));
    assert_eq!(cubic["lattice"], serde_json::Value::Null);
    assert_eq!((&cubic["origin"], &cubic["step"]), (&other["lattice"]["origin"], &other["step"]));
}

/// Files of users' reports, where they are at hand.
fn cases() -> Option<PathBuf> {
    let corpus = std::env::var_os("LWC_CORPUS").map(|corpus| Path::new(&corpus).join("../cases"));
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/cases");
    let found = corpus.into_iter().chain([beside]).find(|folder| folder.is_dir());
    if found.is_none() {
        eprintln!("skipped: no cases beside the corpus; set LWC_CORPUS");
    }
    found
}

#[test]
fn tiles_of_the_cases_share_their_border() {
    let Some(cases) = cases() else { return };
    let workshop = Workshop::new();
    for name in ["a", "b"] {
        let file = cases.join(format!("obj-tile-{name}.obj"));
        std::fs::copy(file, workshop.path(&format!("{name}.obj"))).unwrap();
    }
    let [a, b] = ["a", "b"].map(|name| decoded(&workshop, "--grid 0,0,0,0.001", name));
    assert_eq!(at(&a, 10.0).len(), 11);
    assert_eq!(at(&a, 10.0), at(&b, 10.0));
}

#[test]
fn cases_that_no_cube_holds_come_out_with_few_triangles_lost() {
    let Some(cases) = cases() else { return };
    let workshop = Workshop::new();
    for name in ["las-degrees.las", "obj-rail-1000m.obj"] {
        let file = cases.join(name).display().to_string();
        let said = workshop.json(&format!("encode {file} -o case.lwc --json --verify"));
        let lost = said["triangles_collapsed"].as_u64().unwrap() + said["triangles_turned"].as_u64().unwrap();
        assert!(lost * 100 <= said["triangles"].as_u64().unwrap(), "{name}: {lost} lost");
        let (_, stderr) = workshop.ok(&format!("encode {file} -o case.lwc --cubic-grid"));
        assert!(stderr.contains("triangles collapsed: the grid is too coarse"), "{name}: {stderr}");
    }
}

#[test]
fn steps_and_precision_are_kept_and_said() {
    let workshop = Workshop::new();
    workshop.put("a.obj", &tile(0.0));
    let said = workshop.json("encode a.obj -o a.lwc --step 0.01,0.02,0.5 --json");
    assert_eq!(said["step"], serde_json::json!([0.01, 0.02, 0.5]));
    let largest = said["largest_error"].as_f64().unwrap();
    assert!(largest > 0.1 && largest < 0.26, "{largest}");
    assert!(said["largest_error_in_edges"].as_f64().unwrap() > 0.1);
    let (_, stderr) = workshop.ok("encode a.obj -o a.lwc --step 0.01,0.02,0.5");
    assert!(stderr.contains("bits: steps of 1.00e-2, 2.00e-2, 5.00e-1\n"), "{stderr}");
}

#[test]
fn precision_with_a_unit_needs_that_of_the_model() {
    let workshop = Workshop::new();
    workshop.put("a.obj", &tile(0.0));
    workshop.put("a.glb", &tile(0.0));
    let step =
        |line: &str| workshop.json(&format!("encode {line} -o a.lwc --json"))["step"][0].as_f64().unwrap();
    assert_eq!(step("a.obj --precision 0.25"), 0.5);
    assert_eq!(step("a.glb --precision 1mm"), 0.002);
    assert_eq!(step("a.obj --precision 1mm --unit cm"), 0.2);
    assert_eq!(step("a.obj --precision 1in --unit mm"), 2.0 * 25.4);
    assert_eq!(step("a.glb --precision 1mm --unit mm"), 2.0);
    let error = workshop.fails("encode a.obj -o new.lwc --precision 1mm", 2);
    assert!(error_line(&error).contains("add --unit"), "{error}");
    let error = workshop.fails("encode a.obj -o new.lwc --precision 0.1 --unit m", 2);
    assert!(error_line(&error).contains("with a unit"), "{error}");
}

#[test]
fn a_grid_that_cannot_be_is_refused_in_one_sentence() {
    let workshop = Workshop::new();
    workshop.put("a.obj", &tile(0.0));
    let error = workshop.fails("encode a.obj -o new.lwc --step 1e-12", 2);
    let smallest = error_line(&error).split("30 bits allow ").nth(1).unwrap().split(' ').next().unwrap();
    workshop.ok(&format!("encode a.obj -o new.lwc --step {smallest}"));
    std::fs::remove_file(workshop.path("new.lwc")).unwrap();
    for (options, part) in [
        ("--step 0", "above 0"),
        ("--step 1,2", "three"),
        ("--step 1 -q 12", "cannot be used with"),
        ("--step 1 --grid 0,0,0,1", "cannot be used with"),
        ("--precision 1 --grid 0,0,0,1", "cannot be used with"),
        ("--cubic-grid --grid 0,0,0,1", "cannot be used with"),
        ("--precision 1parsec", "no length"),
        ("--grid 0,0,1", "x,y,z"),
        ("--unit m", "--precision"),
    ] {
        let error = workshop.fails(&format!("encode a.obj -o new.lwc {options}"), 2);
        assert!(error.contains(part), "{options}: {error}");
    }
    let error = workshop.fails("encode a.obj -o new.lwc --grid nothing.lwc", 3);
    assert!(error_line(&error).contains("nothing.lwc"), "{error}");
    let error = workshop.fails("encode a.obj -o new.lwc --grid a.obj", 3);
    assert!(error_line(&error).contains("not an lwc stream"), "{error}");
}
