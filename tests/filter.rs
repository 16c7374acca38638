//! `lwc filter` and `lwc edit` as a user meets them.
#![cfg(feature = "cli")]
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

mod common;

use assert_cmd::Command;
use common::*;
use lwc::mesh::{Attribute, Attributes, Domain, Semantic, Values};
use lwc::{TriMesh, io};
use std::path::PathBuf;

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        io::write(folder.path("ball.ply"), &noisy(sphere(4), 1, 0.01)).unwrap();
        folder.ok("encode ball.ply -o ball.lwc --quiet");
        folder
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn mesh(&self, name: &str) -> TriMesh {
        io::read(self.path(name)).unwrap().mesh
    }

    /// Exit code, standard output, standard error.
    fn run(&self, line: &str) -> (i32, String, String) {
        let mut command = Command::cargo_bin("lwc").unwrap();
        let output = command.current_dir(self.0.path()).args(line.split_whitespace()).output().unwrap();
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        (output.status.code().unwrap(), text(output.stdout), text(output.stderr))
    }

    fn ok(&self, line: &str) -> String {
        let (code, out, error) = self.run(line);
        assert_eq!(code, 0, "{line}: {error}");
        out
    }
}

/// Root mean square of the distance from the unit sphere.
fn roughness(mesh: &TriMesh) -> f64 {
    let squares =
        mesh.positions().iter().map(|p| (p.iter().map(|x| x * x).sum::<f64>().sqrt() - 1.0).powi(2));
    (squares.sum::<f64>() / mesh.num_vertices() as f64).sqrt()
}

#[test]
fn levels_are_listed_and_weakened() {
    let folder = Folder::new();
    let listed = folder.ok("filter ball.ply");
    let levels = listed.lines().count() - 2;
    assert!(levels > 8, "{listed}");
    assert!(listed.lines().last().unwrap().trim_start().starts_with(&levels.to_string()));
    assert!(listed.lines().last().unwrap().contains("2562"), "{listed}");

    folder.ok("filter ball.ply --gain 3..=1 -o same.ply");
    assert_eq!(folder.mesh("same.ply"), folder.mesh("ball.ply"));
    folder.ok(&format!("filter ball.ply --gain {}..=0 -o smooth.obj", levels - 3));
    folder.ok(&format!("filter ball.ply --gain {}..=3 -o rough.obj", levels - 3));
    let (before, smooth, rough) =
        (folder.mesh("ball.ply"), folder.mesh("smooth.obj"), folder.mesh("rough.obj"));
    assert_eq!(before.triangles(), smooth.triangles());
    let [before, smooth, rough] = [before, smooth, rough].map(|mesh| roughness(&mesh));
    assert!(smooth < 0.97 * before && rough > 1.5 * before, "{smooth} {before} {rough}");
    // Factors of one level multiply.
    folder.ok(&format!("filter ball.ply --gain {levels}=4 --gain {levels}=0.25 -o same.ply"));
    assert_eq!(folder.mesh("same.ply"), folder.mesh("ball.ply"));

    folder.ok("filter ball.ply --denoise -o clean.ply");
    let clean = roughness(&folder.mesh("clean.ply"));
    assert!(clean < 0.6 * before, "{clean} and {before}");
}

#[test]
fn a_changed_level_gets_its_details_back() {
    let folder = Folder::new();
    folder.ok("decode ball.lwc -o fine.ply --quiet");
    folder.ok("decode ball.lwc --level 4 -o coarse.obj --quiet");
    let (_, _, said) = folder.run("edit ball.lwc coarse.obj -o same.ply");
    assert!(said.contains("2562 vertices, 5120 triangles, details above level 4"), "{said}");
    let largest = |a: &TriMesh, b: &TriMesh| {
        let coordinates = a.positions().as_flattened().iter().zip(b.positions().as_flattened());
        coordinates.map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
    };
    assert!(largest(&folder.mesh("fine.ply"), &folder.mesh("same.ply")) < 1e-6);

    // Positions are float32, as those of the ball, unless somebody wants more.
    for (line, file) in [("decode ball.lwc", "fine.ply"), ("decode ball.lwc --level 4", "coarse.obj")] {
        folder.ok(&format!("{line} -o {file} --position-type double --quiet"));
    }
    folder.ok("edit ball.lwc coarse.obj -o same.ply --position-type double");
    assert!(largest(&folder.mesh("fine.ply"), &folder.mesh("same.ply")) < 1e-12);

    // A quarter of a turn about z.
    let turned = |mesh: TriMesh| map_positions(mesh, |[x, y, z]| [-y, x, z]);
    io::write(folder.path("turned.obj"), &turned(folder.mesh("coarse.obj"))).unwrap();
    folder.ok("edit ball.lwc turned.obj -o fine-turned.ply");
    assert!(largest(&turned(folder.mesh("fine.ply")), &folder.mesh("fine-turned.ply")) < 1e-6);
}

/// A sphere with a colour and a normal at each vertex, and its stream.
fn coloured() -> Folder {
    let folder = Folder::new();
    let mesh = sphere(4);
    let colours = (0..3 * mesh.num_vertices()).map(|k| k as u8).collect();
    let normals = mesh.positions().as_flattened().iter().map(|&x| x as f32).collect();
    let of_vertices =
        |name: &str, semantic, values| Attribute::new(name, semantic, Domain::Vertex, 3, values);
    let mut attributes = Attributes::default();
    attributes.list = vec![
        of_vertices("red green blue", Semantic::Color(0), Values::U8(colours)),
        of_vertices("nx ny nz", Semantic::Normal, Values::F32(normals)),
    ];
    io::write_with_attributes(folder.path("coloured.ply"), &mesh, &attributes).unwrap();
    folder.ok("encode coloured.ply -o coloured.lwc --quiet");
    folder
}

#[test]
fn attributes_stay_and_normals_of_the_former_shape_are_left_out() {
    let folder = coloured();
    let (_, _, said) = folder.run("filter coloured.ply --gain 3..=0 -o smooth.ply");
    assert!(said.contains("these normals are those of the shape before"), "{said}");
    let of = |name: &str| io::read(folder.path(name)).unwrap().attributes;
    let smooth = of("smooth.ply");
    assert_eq!(smooth.list.len(), 1);
    assert_eq!(smooth.find(Semantic::Color(0)), of("coloured.ply").find(Semantic::Color(0)));

    folder.ok("decode coloured.lwc -o whole.ply --quiet");
    folder.ok("decode coloured.lwc --level 4 -o coarse.ply --quiet");
    let (_, _, said) = folder.run("edit coloured.lwc coarse.ply -o edited.ply");
    assert!(said.contains("these normals are those of the shape before"), "{said}");
    let edited = of("edited.ply");
    assert_eq!(edited.list.len(), 1);
    assert_eq!(edited.find(Semantic::Color(0)), of("whole.ply").find(Semantic::Color(0)));
}

#[test]
fn mistakes_have_their_words_and_codes() {
    let folder = Folder::new();
    folder.ok("decode ball.lwc --level 4 -o coarse.obj --quiet");
    let (positions, mut triangles) = folder.mesh("coarse.obj").into_parts();
    triangles.pop();
    io::write(folder.path("open.obj"), &build(positions, triangles)).unwrap();
    let stream = std::fs::read(folder.path("ball.lwc")).unwrap();
    std::fs::write(folder.path("cut.lwc"), &stream[..stream.len() / 2]).unwrap();
    for (line, code, part) in [
        ("filter ball.ply --gain 3=0", 2, "give -o FILE"),
        ("filter ball.ply --gain 99=0 -o x.ply", 2, "for no level"),
        ("filter ball.ply --gain 3 -o x.ply", 2, "it is not like"),
        ("filter ball.ply --denoise --gain 3=0 -o x.ply", 2, "cannot be used with"),
        ("filter ball.ply --denoise -o x.txt", 2, "unknown file ending"),
        ("filter ball.ply --denoise -o ball.ply", 2, "replace the input"),
        ("edit ball.lwc ball.obj -o x.ply", 3, "ball.obj"),
        ("edit ball.lwc open.obj -o x.ply", 3, "faces of level 4 are not in the changed mesh"),
        ("edit cut.lwc coarse.obj -o x.ply", 4, "incomplete"),
        ("edit coarse.obj coarse.obj -o x.ply", 3, "not an lwc stream"),
        ("edit ball.lwc coarse.obj -o ball.lwc", 2, "unknown file ending"),
        ("edit ball.lwc coarse.obj -o x.ply --max-vertices 10", 5, "limit of vertices exceeded"),
    ] {
        let (found, _, error) = folder.run(line);
        assert!(found == code && error.contains(part), "{line}: {found} {error}");
        assert!(!folder.path("x.ply").exists(), "{line}");
    }
    io::write(folder.path("other.ply"), &sphere(0)).unwrap();
    let (code, _, error) = folder.run("edit ball.lwc other.ply -o x.ply");
    assert!(code == 3 && error.contains("has 12 vertices, but the levels of the stream have"), "{error}");
}
