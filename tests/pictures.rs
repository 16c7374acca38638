//! Pictures as a user makes them, and what is to be seen on them.
#![cfg(feature = "cli")]
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

mod common;

use assert_cmd::Command;
use common::*;
use lwc::mesh::{Domain, Semantic};
use lwc::render::{Camera, Image, Paint, Shading, Style, Up, View, render};
use lwc::{TriMesh, io};
use std::io::Cursor;
use std::path::Path;
use std::process::Output;

fn picture(mesh: &TriMesh, style: &Style) -> Image {
    let camera = Camera::fit(mesh, View::default(), Up::Y, style.size[0], style.size[1]);
    render(mesh, Paint::Plain, &camera, style).unwrap()
}

fn small() -> Style {
    Style { size: [200, 200], background: [0, 0, 0, 0], ..Style::default() }
}

fn count(image: &Image, is_wanted: impl Fn(&[u8; 4]) -> bool) -> usize {
    image.rgba().as_chunks::<4>().0.iter().filter(|p| is_wanted(p)).count()
}

#[test]
fn a_sphere_is_a_disc_on_nothing() {
    let image = picture(&sphere(4), &small());
    let covered: f64 = image.rgba().as_chunks::<4>().0.iter().map(|p| f64::from(p[3]) / 255.0).sum();
    // Its diameter is 0.92 of the side.
    let disc = std::f64::consts::PI * (0.46 * 200.0_f64).powi(2);
    assert!((covered / disc - 1.0).abs() < 0.01, "{covered} of {disc}");
    assert_eq!(image.pixel(1, 1).unwrap()[3], 0);
    let edge = count(&image, |p| p[3] > 0 && p[3] < 255);
    assert!(edge > 300, "{edge} pixels are partly covered");
    // The light comes from the upper left.
    assert!(image.pixel(60, 60).unwrap()[0] > image.pixel(140, 140).unwrap()[0] + 10);
}

#[test]
fn the_same_mesh_gives_the_same_picture_wherever_it_is() {
    let mesh = noisy(sphere(3), 4, 0.03);
    let moved = map_positions(mesh.clone(), |p| p.map(|x| 256.0 * x + 65536.0));
    assert_eq!(picture(&mesh, &small()).width(), 200);
    let (a, b) = (picture(&mesh, &small()), picture(&moved, &small()));
    let differing = a.rgba().iter().zip(b.rgba()).filter(|(a, b)| a.abs_diff(**b) > 2).count();
    assert!(differing < 20, "{differing} bytes differ");
}

#[test]
fn flat_shading_wires_and_outlines_are_to_be_seen() {
    let mesh = sphere(2);
    let smooth = picture(&mesh, &small());
    let flat = picture(&mesh, &Style { shading: Shading::Flat, ..small() });
    let colours = |image: &Image| {
        let pixels = image.rgba().as_chunks::<4>().0.iter().filter(|p| p[3] == 255);
        pixels.collect::<std::collections::BTreeSet<_>>().len()
    };
    assert!(colours(&flat) < colours(&smooth), "{} and {}", colours(&flat), colours(&smooth));
    let dark = |image: &Image| count(image, |p| p[3] == 255 && p[..3].iter().all(|&c| c < 75));
    let wires = picture(&mesh, &Style { wireframe: true, ..small() });
    let outlines = picture(&mesh, &Style { silhouettes: true, ..small() });
    let [plain, wires, outlines] = [smooth, wires, outlines].map(|image| dark(&image));
    assert!(wires > plain + 200 && outlines > plain + 200, "{plain}, {wires} and {outlines}");
}

#[test]
fn values_colour_the_surface() {
    let mesh = sphere(3);
    let style = small();
    let camera = Camera::fit(&mesh, "front".parse().unwrap(), Up::Y, 200, 200);
    let values: Vec<f64> = mesh.positions().iter().map(|p| (p[0] + 1.0) / 2.0).collect();
    let image = render(&mesh, Paint::Values(&values), &camera, &style).unwrap();
    let (left, right) = (image.pixel(15, 100).unwrap(), image.pixel(185, 100).unwrap());
    // Violet to yellow.
    assert!(left[2] > left[1] && right[1] > 2 * right[2], "{left:?} {right:?}");
    assert!(render(&mesh, Paint::Values(&values[1..]), &camera, &style).is_err());
}

#[test]
fn meshes_without_extent_are_empty_pictures() {
    for mesh in [all_points_equal(), build(vec![], vec![]), build(vec![[f64::MAX; 3]], vec![])] {
        let image = picture(&mesh, &small());
        assert_eq!(count(&image, |p| p[3] > 0), 0);
    }
}

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        io::write(folder.path("ball.ply"), &noisy(sphere(3), 1, 0.01)).unwrap();
        folder.ok("encode ball.ply -o ball.lwc --quiet");
        folder
    }

    fn path(&self, name: &str) -> std::path::PathBuf {
        self.0.path().join(name)
    }

    fn run(&self, line: &str) -> Output {
        let mut command = Command::cargo_bin("lwc").unwrap();
        command.current_dir(self.0.path()).args(line.split_whitespace()).output().unwrap()
    }

    fn ok(&self, line: &str) {
        let output = self.run(line);
        assert!(output.status.success(), "{line}: {}", String::from_utf8_lossy(&output.stderr));
    }

    /// Width and height of a PNG, and its pixels.
    fn png(&self, name: &str) -> (u32, u32, Vec<u8>) {
        read_png(&self.path(name))
    }
}

fn read_png(path: &Path) -> (u32, u32, Vec<u8>) {
    let bytes = std::fs::read(path).unwrap();
    let mut reader = png::Decoder::new(Cursor::new(bytes)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    (info.width, info.height, pixels)
}

#[test]
fn the_program_takes_pictures_of_meshes_levels_and_prefixes() {
    let folder = Folder::new();
    folder.ok("render ball.ply -o mesh.png --size 120x90");
    folder.ok("render ball.lwc -o stream.png --size 120x90");
    folder.ok("render ball.lwc -o base.png --size 120x90 --level 0 --shading flat --view top --up z");
    folder.ok("render ball.lwc -o early.png --size 120x90 --bytes 400 --quiet");
    folder.ok("render ball.ply -o heat.png --size 120x90 --color-by nfv --clip 2 --background transparent");
    let (width, height, mesh) = folder.png("mesh.png");
    assert_eq!((width, height), (120, 90));
    let differing = |a: &[u8], b: &[u8]| a.iter().zip(b).filter(|(a, b)| a.abs_diff(**b) > 24).count();
    let stream = folder.png("stream.png").2;
    assert!(differing(&mesh, &stream) < 200, "{}", differing(&mesh, &stream));
    assert!(differing(&mesh, &folder.png("base.png").2) > 1000);
    assert!(differing(&mesh, &folder.png("early.png").2) > 300);
    assert!(folder.png("heat.png").0 > 150);

    for (line, code, part) in [
        ("render ball.ply -o x.jpg", 2, "unknown ending"),
        ("render ball.ply -o x.png --level 2", 2, "for streams"),
        ("render ball.ply -o x.png --montage", 2, "montage shows the levels of a stream"),
        ("render ball.lwc -o x.png --montage --levels 99", 2, "none of these levels"),
        ("render ball.ply -o x.png --size 0x10", 2, "no size"),
        ("render ball.ply -o x.png --view up", 2, "neither front"),
        ("render missing.ply -o x.png", 3, "missing.ply"),
    ] {
        let output = folder.run(line);
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(code), "{line}: {said}");
        assert!(said.contains(part), "{line}: {said}");
        assert!(!folder.path("x.png").exists());
    }
}

#[test]
fn a_montage_has_the_levels_that_were_asked_for() {
    let folder = Folder::new();
    folder.ok("render ball.lwc -o some.png --montage --levels 0,2 --size 100x80 --columns 1");
    let (width, height, pixels) = folder.png("some.png");
    assert_eq!(width, 100);
    assert!(height > 2 * 80 + 40 && height < 2 * 80 + 120, "{height}");
    // There is text under each picture.
    let row = 4 * width as usize;
    let dark = |rows: std::ops::Range<usize>| {
        let part = &pixels[rows.start * row..rows.end * row];
        part.as_chunks::<4>().0.iter().filter(|p| p[..3].iter().all(|&c| c < 170)).count()
    };
    assert!(dark(80..height as usize / 2) > 50);
    folder.ok("render ball.lwc -o all.png --montage --size 60x60");
    assert!(folder.png("all.png").0 >= 120);
}

#[test]
fn describe_makes_pictures_and_coloured_meshes() {
    let folder = Folder::new();
    folder.ok("describe ball.ply -d pca -o heat.png --size 100x100 --clip 1");
    assert_eq!(folder.png("heat.png").1, 100);
    folder.ok("describe ball.ply -d pca -o heat.ply");
    let file = io::read(folder.path("heat.ply")).unwrap();
    assert_eq!(file.mesh, io::read(folder.path("ball.ply")).unwrap().mesh);
    let colours = file.attributes.find(Semantic::Color(0)).unwrap();
    assert_eq!((colours.domain, colours.num_components), (Domain::Vertex, 3));
    assert_eq!(colours.num_entries(), file.mesh.num_vertices());
    let output = folder.run("describe ball.ply -o heat.txt");
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn the_curve_of_a_stream_is_drawn() {
    let folder = Folder::new();
    folder.ok("info ball.lwc --plot curve.svg");
    let svg = std::fs::read_to_string(folder.path("curve.svg")).unwrap();
    assert!(svg.contains("ball.lwc") && svg.contains("bytes"), "{svg}");
    assert!(svg.matches("<circle").count() > 5);
    folder.ok("info ball.lwc --plot curve.png");
    assert_eq!(folder.png("curve.png").0, 960);
    assert_eq!(folder.run("info ball.lwc --plot curve.pdf").status.code(), Some(2));
}
