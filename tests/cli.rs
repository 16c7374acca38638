//! The program as a user meets it: files, pipes, messages and exit codes.
#![cfg(feature = "cli")]

mod common;

use assert_cmd::Command;
use common::corpus::corpus;
use common::workshop::*;
use common::*;
use lwc::descriptors::{Descriptor, Window, evaluate, mean_edge_length};
use lwc::{TriMesh, io};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::io::Write;
use std::process::{Output, Stdio};

// --- help and usage ---

#[test]
fn help_names_commands_exit_codes_defaults_and_ranges() {
    let workshop = Workshop::new();
    let (help, _) = workshop.ok("--help");
    for word in ["encode", "decode", "info", "describe", "compare", "--threads", "--quiet", "Exit codes:"] {
        assert!(help.contains(word), "{word}");
    }
    let (help, _) = workshop.ok("encode --help");
    for part in ["[default: 12]", "1 to 30", "[default: harris3d]", "shape-index", "0 to 128", "algorithm1"] {
        assert!(help.contains(part), "{part}");
    }
    for command in ["decode", "info", "describe", "compare"] {
        assert!(workshop.ok(&format!("{command} -h")).0.contains("Usage: lwc"));
    }
    assert_eq!(workshop.ok("--version").0, concat!("lwc ", env!("CARGO_PKG_VERSION"), "\n"));
}

/// The long options that a text names.
fn options_in(text: &str) -> BTreeSet<&str> {
    let is_part = |c: char| c.is_ascii_lowercase() || c == '-';
    let words = text.split(|c| !is_part(c));
    words.filter(|word| word.starts_with("--")).map(|word| word.trim_end_matches('-')).collect()
}

#[test]
fn help_has_a_command_too() {
    let workshop = Workshop::new();
    assert_eq!(workshop.ok("help decode"), workshop.ok("decode --help"));
}

/// A bar of 1 m along x with a square of 1 mm, cut into slices.
fn thin_bar() -> TriMesh {
    let square = [[0.0, 0.0], [0.001, 0.0], [0.001, 0.001], [0.0, 0.001]];
    let slices = 0..=20;
    let positions = slices.flat_map(|i| square.map(|[y, z]| [f64::from(i) / 20.0, y, z])).collect();
    let side = |i: u32, k: u32| {
        let [a, b] = [4 * i + k, 4 * i + (k + 1) % 4];
        [[a, a + 4, b], [b, a + 4, b + 4]]
    };
    let sides = (0..20).flat_map(|i| (0..4).flat_map(move |k| side(i, k)));
    build(positions, sides.collect())
}

#[test]
fn a_grid_that_is_too_coarse_is_said_with_the_bits_that_do() {
    let workshop = Workshop::new();
    io::write(workshop.path("bar.obj"), &thin_bar()).unwrap();
    let (_, stderr) = workshop.ok("encode bar.obj -q 8 --cubic-grid -o coarse.lwc");
    assert!(stderr.contains("160 of 160 triangles collapsed: the grid is too coarse, `-q "), "{stderr}");
    assert!(stderr.contains("8 bits: steps of 3.92e-3\n"), "{stderr}");
    let bits = stderr.split("`-q ").nth(1).and_then(|rest| rest.split('`').next()).unwrap();
    let (_, stderr) = workshop.ok(&format!("encode bar.obj -q {bits} --cubic-grid -o fine.lwc"));
    assert!(!stderr.contains("warning"), "{stderr}");
    let (_, stderr) = workshop.ok("encode bar.obj -q 8 -o stretched.lwc");
    assert!(stderr.contains("note") && stderr.contains("each axis has its own step"), "{stderr}");
    assert!(!stderr.contains("warning"), "{stderr}");
    let (_, stderr) = workshop.ok("encode bar.obj -q 8 --lossless -o exact.lwc");
    assert!(!stderr.contains("warning") && !stderr.contains("steps of"), "{stderr}");
    assert!(!stderr.contains("positions rounded"), "{stderr}");
}

#[test]
fn meshes_come_from_standard_input_if_their_format_is_said() {
    let workshop = Workshop::new();
    let error = workshop.fails("encode -", 2);
    assert!(error_line(&error).starts_with("lwc: standard input: say what it is with --format"), "{error}");
    let expected = workshop.ball_stream();
    let mesh = fs::read(workshop.path("ball.ply")).unwrap();
    let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    packer.write_all(&mesh).unwrap();
    for bytes in [mesh.clone(), packer.finish().unwrap(), zstd::encode_all(&mesh[..], 1).unwrap()] {
        let output = workshop.run_with_input("encode - --format ply", bytes.clone());
        assert_eq!((output.stdout, text(output.stderr)), (expected.clone(), String::new()));
        let line = "compare - ball.ply --format ply";
        let (report, _) = succeeded(line, workshop.run_with_input(line, bytes));
        assert!(report.contains("the surfaces are identical"), "{report}");
    }
    for line in
        ["describe - --format ply -o d.csv", "filter - --format ply", "encode - --format ply -o a.lwc"]
    {
        succeeded(line, workshop.run_with_input(line, mesh.clone()));
    }
    assert_eq!(fs::read(workshop.path("a.lwc")).unwrap(), expected);
    let error = failed("encode", workshop.run_with_input("encode - --format obj", mesh), 3);
    assert!(error_line(&error).starts_with("lwc: standard input: line "), "{error}");
    workshop.fails("encode - ball.ply - --format ply -o x.lwc", 2);
}

#[test]
fn several_files_become_one_scene() {
    let workshop = Workshop::new();
    workshop.put("small.one.obj", &sphere(1));
    let error = workshop.fails("encode ball.ply small.one.obj", 2);
    assert!(error_line(&error).contains("name it with -o"), "{error}");
    let report =
        workshop.json("encode ball.ply small.one.obj ball.ply -o all.lwc --lossless --json --verify");
    assert_eq!(report["inputs"], serde_json::json!(["ball.ply", "small.one.obj", "ball.ply"]));
    workshop.ok("decode all.lwc -o all.glb");
    let scene = io::read_scene(workshop.path("all.glb")).unwrap();
    let names: Vec<&str> = scene.instances.iter().map(|instance| instance.name.as_str()).collect();
    assert_eq!(names, ["ball", "small.one", "ball"]);
    let sizes: Vec<usize> = scene.meshes.iter().map(|file| file.mesh.num_triangles()).collect();
    assert_eq!(sizes, [1280, 80, 1280]);
    // What is a scene already keeps its names and places.
    workshop.ok("encode all.glb small.one.obj -o more.lwc");
    workshop.ok("decode more.lwc -o more.glb");
    assert_eq!(io::read_scene(workshop.path("more.glb")).unwrap().instances.len(), 4);
    workshop.ok("encode ball.ply small.one.obj -o one.lwc --merge");
    workshop.ok("decode one.lwc -o one.glb");
    let merged = io::read_scene(workshop.path("one.glb")).unwrap();
    assert_eq!((merged.meshes.len(), merged.meshes[0].mesh.num_triangles()), (1, 1360));
    workshop.fails("encode ball.ply missing.obj -o x.lwc", 3);
    workshop.fails("encode small.one.obj ball.ply -o ball.ply", 2);
}

#[test]
fn textures_are_counted_and_may_be_left_out() {
    let workshop = Workshop::new();
    let obj = "mtllib a.mtl\nusemtl wood\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";
    fs::write(workshop.path("a.obj"), obj).unwrap();
    fs::write(workshop.path("a.mtl"), "newmtl wood\nKd 0.5 0.25 0.125\nmap_Kd wood.png\n").unwrap();
    fs::write(workshop.path("wood.png"), [&b"\x89PNG\r\n\x1a\n"[..], &[7; 4000]].concat()).unwrap();
    let (_, stderr) = workshop.ok("encode a.obj");
    assert!(stderr.contains(" bytes, 4008 of them textures, "), "{stderr}");
    assert_eq!(workshop.json("encode a.obj --json")["texture_bytes"], 4008);
    let report = workshop.json("encode a.obj --json --no-textures");
    assert_eq!(report["texture_bytes"], 0);
    assert_eq!(left_out(&report), ["textures"]);
    assert!(report["bytes"].as_u64().unwrap() < 1000);
    fs::remove_file(workshop.path("wood.png")).unwrap();
    let (_, stderr) = workshop.ok("encode a.obj");
    assert!(stderr.contains("left out: image `wood.png`: "), "{stderr}");
}

/// The names of all commands.
fn commands(workshop: &Workshop) -> Vec<String> {
    let (help, _) = workshop.ok("--help");
    let lines = help.lines().skip_while(|line| *line != "Commands:").skip(1);
    let names = lines.take_while(|line| !line.is_empty()).filter_map(|line| line.strip_prefix("  "));
    // The lines of long descriptions go on further to the right.
    let names = names.filter(|line| !line.starts_with(' ')).filter_map(|line| line.split(' ').next());
    // Help on help is nobody's wish.
    names.filter(|name| *name != "help").map(str::to_owned).collect()
}

#[test]
fn every_shell_gets_its_completions() {
    let workshop = Workshop::new();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let (script, stderr) = workshop.ok(&format!("completions {shell}"));
        // Fish has no dashes in front of the names.
        let option = if shell == "fish" { "-l descriptor " } else { "--descriptor" };
        for part in ["encode", option] {
            assert!(script.contains(part), "{shell}: no {part}");
        }
        assert_eq!(stderr, "");
    }
    workshop.fails("completions", 2);
    workshop.fails("completions tcsh", 2);
}

#[test]
fn every_command_has_a_manual_page_with_all_options_of_its_help() {
    let workshop = Workshop::new();
    let commands = commands(&workshop);
    assert!(commands.len() >= 12, "{commands:?}");
    let (stdout, stderr) = workshop.ok("man pages/man1");
    let num_pages = commands.len() + 1;
    assert_eq!((stdout, stderr), (String::new(), format!("pages/man1: {num_pages} manual pages\n")));
    assert_eq!(fs::read_dir(workshop.path("pages/man1")).unwrap().count(), num_pages);

    let mut pages = vec![("--help".to_owned(), "lwc".to_owned())];
    pages.extend(commands.iter().map(|name| (format!("{name} --help"), format!("lwc-{name}"))));
    for (line, name) in pages {
        let page = fs::read_to_string(workshop.path(&format!("pages/man1/{name}.1"))).unwrap();
        assert!(page.starts_with('.'), "{name}: {page}");
        assert!(
            page.contains(&format!("\n.TH {name} 1 ")) && page.contains("\n.SH NAME\n"),
            "{name}: {page}"
        );
        let plain = ["\\fB", "\\fI", "\\fR", "\\"].iter().fold(page, |page, mark| page.replace(mark, ""));
        let help = workshop.ok(&line).0;
        let (documented, shown) = (options_in(&plain), options_in(&help));
        assert!(shown.contains("--threads") && shown.is_subset(&documented), "{name}: {shown:?}");
    }
    // A second time the pages are replaced.
    assert_eq!(workshop.ok("man pages/man1 --quiet"), (String::new(), String::new()));
    let first = fs::read_to_string(workshop.path("pages/man1/lwc.1")).unwrap();
    assert_eq!(workshop.ok("man").0, first);
    assert_eq!(workshop.ok("man -").0, first);
}

#[test]
fn manual_pages_that_cannot_be_written_are_named() {
    let workshop = Workshop::new();
    let stderr = workshop.fails("man ball.ply", 1);
    assert_eq!(error_line(&stderr), "lwc: ball.ply: it is not a folder");
    let stderr = workshop.fails("man ball.ply/man1", 1);
    assert!(error_line(&stderr).starts_with("lwc: ball.ply/man1: "), "{stderr}");
    fs::create_dir_all(workshop.path("man1/lwc-info.1")).unwrap();
    let stderr = failed("man man1", workshop.run("man man1"), 1);
    assert!(error_line(&stderr).starts_with("lwc: man1/lwc-info.1: "), "{stderr}");
}

#[test]
fn nobody_has_to_read_completions_and_pages_to_the_end() {
    for line in ["completions bash", "man"] {
        let mut command = std::process::Command::new(assert_cmd::cargo::cargo_bin("lwc"));
        let command = command.args(line.split(' ')).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().expect("a run");
        drop(child.stdout.take());
        let output = child.wait_with_output().expect("a run");
        assert_eq!((output.status.code(), text(output.stderr)), (Some(0), String::new()), "{line}");
    }
}

#[test]
fn values_out_of_range_are_wrong_usage() {
    let workshop = Workshop::new();
    for options in [
        "-q 0",
        "-q 31",
        "-q -3",
        "-q x",
        "--levels 1000",
        "--levels -1",
        "--levels some",
        "--rings 0",
        "--rings 65",
        "--radius 0",
        "--radius -1",
        "--radius nan",
        "--radius inf",
        "--growth 0.5",
        "--growth 17",
        "--steps-per-edge 0",
        "-d harris4d",
        "--partition both",
        "--threads 99999",
        "--unknown",
        "--quiet -v",
    ] {
        let stderr = workshop.fails(&format!("encode ball.ply {options}"), 2);
        assert!(stderr.starts_with("error: ") && !stderr.contains("panicked"), "{stderr}");
    }
    for line in [
        "",
        "encode",
        "explode ball.ply",
        "decode ball.lwc --bytes -1",
        "decode ball.lwc --max-memory lots",
        "decode ball.lwc --max-vertices 5G",
        "decode ball.lwc --level -1",
        "decode x --format laz",
        "compare ball.ply",
        "compare ball.ply ball.ply --samples many",
        "describe ball.ply -d none",
    ] {
        workshop.fails(line, 2);
    }
}

#[test]
fn unknown_endings_are_named() {
    let workshop = Workshop::new();
    workshop.ball_stream();
    fs::copy(workshop.path("ball.ply"), workshop.path("ball.fbx")).unwrap();
    let stderr = workshop.fails("encode ball.fbx", 3);
    let known = ".obj, .ply, .stl, .glb, .gltf, .las, .laz,";
    assert!(error_line(&stderr).starts_with("lwc: ball.fbx: ") && stderr.contains(known), "{stderr}");
    let stderr = workshop.fails("decode ball.lwc -o ball.fbx", 2);
    let known = ".obj, .ply, .stl, .glb, .gltf,";
    assert!(error_line(&stderr).starts_with("lwc: ball.fbx: ") && stderr.contains(known), "{stderr}");
    assert!(!stderr.contains(".las"), "{stderr}");
    let stderr = workshop.fails("describe ball.ply -o ball.txt", 2);
    assert!(error_line(&stderr).contains(".csv"));
    let stderr = workshop.fails("decode ball.lwc --format stl -o ball.obj", 2);
    assert!(error_line(&stderr).contains("--format"));
}

#[test]
fn inputs_are_never_replaced() {
    let workshop = Workshop::new();
    let stream = workshop.ball_stream();
    let mesh = fs::read(workshop.path("ball.ply")).unwrap();
    fs::copy(workshop.path("ball.lwc"), workshop.path("stream.ply")).unwrap();
    for line in [
        "encode ball.ply -o ball.ply",
        "encode ball.ply -o ./../{}/ball.ply",
        "decode stream.ply -o stream.ply",
    ] {
        let folder = workshop.0.path().file_name().unwrap().to_str().unwrap();
        let stderr = workshop.fails(&line.replace("{}", folder), 2);
        assert!(error_line(&stderr).contains("would replace the input"));
    }
    assert_eq!(fs::read(workshop.path("ball.ply")).unwrap(), mesh);
    assert_eq!(fs::read(workshop.path("stream.ply")).unwrap(), stream);
}

#[test]
fn streams_and_meshes_keep_to_their_endings() {
    let workshop = Workshop::new();
    workshop.ball_stream();
    workshop.put("other.obj", &sphere(1));
    let other = fs::read(workshop.path("other.obj")).unwrap();
    for output in ["other.obj", "new.ply", "new.STL", "new.glb.zst", "new.laz"] {
        let stderr = workshop.fails(&format!("encode ball.ply -o {output}"), 2);
        let expected = "the ending is that of a mesh, but the output is a stream (.lwc)";
        assert_eq!(error_line(&stderr), format!("lwc: {output}: {expected}"));
    }
    assert_eq!(fs::read(workshop.path("other.obj")).unwrap(), other);
    let stream = fs::read(workshop.path("ball.lwc")).unwrap();
    fs::write(workshop.path("old.lwc"), "a stream").unwrap();
    for line in ["decode ball.lwc -o old.lwc", "filter ball.ply --gain 1=1 -o old.lwc"] {
        assert!(error_line(&workshop.fails(line, 2)).contains("unknown file ending"), "{line}");
    }
    assert_eq!(fs::read(workshop.path("old.lwc")).unwrap(), b"a stream");
    workshop.ok("encode ball.ply -o ball.bin");
    assert_eq!(fs::read(workshop.path("ball.bin")).unwrap(), stream);
}

/// A text of 300 MiB in which there is next to nothing, in less than 100 kB.
fn inflated_obj() -> Vec<u8> {
    let mut packer = zstd::Encoder::new(Vec::new(), 1).expect("writing to memory");
    let comment = [vec![b'#'; (1 << 20) - 1], vec![b'\n']].concat();
    for _ in 0..300 {
        packer.write_all(&comment).expect("writing to memory");
    }
    packer.write_all(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").expect("writing to memory");
    packer.finish().expect("writing to memory")
}

#[test]
fn what_unpacks_out_of_proportion_needs_an_option() {
    let workshop = Workshop::new();
    workshop.ball_stream();
    fs::write(workshop.path("big.obj.zst"), inflated_obj()).unwrap();
    for line in ["encode big.obj.zst", "describe big.obj.zst", "compare ball.ply big.obj.zst"] {
        let stderr = workshop.fails(line, 5);
        let expected = "lwc: big.obj.zst: refused without --any-ratio: too large: ";
        assert!(error_line(&stderr).starts_with(expected), "{stderr}");
    }
    workshop.ok("describe big.obj.zst --any-ratio");
    for command in ["encode", "describe", "compare", "experiment", "render", "filter", "edit", "view"] {
        assert!(workshop.ok(&format!("{command} --help")).0.contains("--any-ratio"), "{command}");
    }
}

// --- signals ---

/// Runs a line with its standard input open, and does something to it.
#[cfg(unix)]
fn disturbed(workshop: &Workshop, line: &str, signal: &str, wait: impl Fn()) -> Output {
    let mut command = std::process::Command::new(assert_cmd::cargo::cargo_bin("lwc"));
    command.current_dir(workshop.0.path()).args(line.split(' ')).stdin(Stdio::piped());
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("a run");
    let stdin = child.stdin.take();
    wait();
    let id = child.id().to_string();
    std::process::Command::new("kill").args([signal, &id]).output().expect("the program `kill`");
    let output = child.wait_with_output().expect("a run");
    drop(stdin);
    output
}

#[cfg(unix)]
#[test]
fn signals_end_the_program_with_their_number() {
    let workshop = Workshop::new();
    let before = workshop.files();
    for (signal, code) in [("-INT", 130), ("-TERM", 143)] {
        // The thread that waits for signals is there before the first output.
        let wait = || std::thread::sleep(std::time::Duration::from_millis(300));
        let output = disturbed(&workshop, "decode - -o never.obj", signal, wait);
        assert_eq!((output.status.code(), text(output.stderr)), (Some(code), String::new()), "{signal}");
    }
    assert_eq!(workshop.files(), before);
}

/// The moment between the first and the last byte of a file is short: it is tried for until it is met.
#[cfg(unix)]
#[test]
fn a_signal_while_writing_leaves_no_file() {
    let workshop = Workshop::new();
    workshop.put("large.ply", &sphere(6));
    workshop.ok("encode large.ply --quiet --effort 0");
    let before = workshop.files();
    let is_writing = || workshop.files().iter().any(|name| name.starts_with(".lwc-"));
    let was_met = (0..50).any(|_| {
        let begin = std::time::Instant::now();
        let wait = || while !is_writing() && begin.elapsed().as_secs() < 20 {};
        let output = disturbed(&workshop, "decode large.lwc -o large.obj.zst --quiet", "-INT", wait);
        let is_whole = output.status.code() == Some(0);
        assert!(is_whole || output.status.code() == Some(130), "{output:?}");
        if is_whole {
            fs::remove_file(workshop.path("large.obj.zst")).unwrap();
        }
        assert_eq!(workshop.files(), before);
        !is_whole
    });
    assert!(was_met, "no signal came in time");
}

// --- encode ---

#[test]
fn encode_writes_beside_the_model_and_sums_up() {
    let workshop = Workshop::new();
    let (stdout, stderr) = workshop.ok("encode ball.ply --verify");
    let bytes = fs::metadata(workshop.path("ball.lwc")).unwrap().len();
    assert!(stderr.starts_with("ball.lwc: 642 vertices, 1280 triangles, "), "{stderr}");
    assert!(
        stderr.contains(&format!("{bytes} bytes, "))
            && stderr.contains("verified: all triangles, positions on the grid\n"),
        "{stderr}"
    );
    assert_eq!((stdout, stderr.lines().count()), (String::new(), 4));

    fs::create_dir(workshop.path("deep.er")).unwrap();
    workshop.put("deep.er/two.dots.obj.zst", &sphere(1));
    workshop.ok("encode deep.er/two.dots.obj.zst");
    assert!(workshop.path("deep.er/two.dots.lwc").exists());
    assert_eq!(workshop.ok("encode ball.ply --quiet"), Default::default());
}

#[test]
fn every_option_reaches_the_stream() {
    let workshop = Workshop::new();
    let options =
        "-d shape-index -q 10 --levels 3 --rings 2 --radius 2.5 --growth 1.25 --partition algorithm1";
    workshop.ok(&format!("encode ball.ply -o a.lwc {options} --steps-per-edge 1000 --verify"));
    let info = workshop.json("info a.lwc --json");
    for (key, expected) in [
        ("descriptor", Value::from("shape-index")),
        ("quantization_bits", 10.into()),
        ("levels", 3.into()),
        ("rings", 2.into()),
        ("radius", 2.5.into()),
        ("growth", 1.25.into()),
        ("partition", "algorithm1".into()),
    ] {
        assert_eq!(info[key], expected, "{key}");
    }
    workshop.ok(&format!("encode ball.ply -o b.lwc {options}"));
    assert_ne!(fs::read(workshop.path("a.lwc")).unwrap(), fs::read(workshop.path("b.lwc")).unwrap());
    for descriptor in Descriptor::ALL.map(Descriptor::name) {
        workshop.ok(&format!("encode ball.ply -o b.lwc -d {descriptor} --verify"));
        assert_eq!(workshop.json("info b.lwc --json")["descriptor"], descriptor);
    }
}

#[test]
fn encode_reports_as_json() {
    let workshop = Workshop::new();
    workshop.put("fin.obj", &non_manifold_fin());
    let report = workshop.json("encode fin.obj --json --verify");
    assert_eq!(report["bytes"], fs::metadata(workshop.path("fin.lwc")).unwrap().len());
    assert_eq!((&report["input_vertices"], &report["input_triangles"]), (&50.into(), &73.into()));
    assert_eq!(report["output"], "fin.lwc");
    assert_eq!(report["verified"], "all triangles, positions on the grid");
    assert!(report["repeated_vertices"].as_u64() > Some(0));
    let passes = report["passes"].as_array().unwrap();
    assert_eq!(passes.last().unwrap()["end"], report["bytes"]);
    assert_eq!(passes.last().unwrap()["triangles"], report["triangles"]);
}

#[test]
fn what_is_dropped_is_counted() {
    let workshop = Workshop::new();
    let model = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 9 9 9\nvt 0 0\nvn 0 0 1\n\
                 f 1 2 3 4\nf 1 1 2\nf 1 2\nf 2 3 1\n";
    fs::write(workshop.path("odd.obj"), model).unwrap();
    let (_, stderr) = workshop.ok("encode odd.obj --verify");
    for warning in [
        "1 polygon cut into triangles",
        "left out: faces of fewer than three corners (1)",
        "left out: degenerate triangles (1): `--keep-degenerate` keeps them",
        "left out: vertices without triangles (1): `--keep-isolated` keeps them",
    ] {
        assert!(stderr.contains(&format!("lwc: warning: odd.obj: {warning}")), "{warning}: {stderr}");
    }
    assert_eq!(workshop.ok("encode odd.obj --quiet").1, "");
}

#[test]
fn nothing_is_dropped_if_nobody_wants_that() {
    let workshop = Workshop::new();
    let model = "v 0.1 -0 0\nv 1 1e-310 0\nv 1 1 0\nv 0 1 0\nv 9 9 9\nf 3 4 2\nf 1 1 2\nf 2 3 1\nf 1 2 3\n";
    fs::write(workshop.path("odd.obj"), model).unwrap();
    let wanted = lwc::io::read(workshop.path("odd.obj")).unwrap().mesh;
    let flags = "--lossless --keep-order --keep-isolated --keep-degenerate --verify";
    let (_, stderr) = workshop.ok(&format!("encode odd.obj {flags} -q 10"));
    assert!(!stderr.contains("left out"), "{stderr}");
    for file in ["odd.ply", "odd.decoded.obj"] {
        workshop.ok(&format!("decode odd.lwc -o {file}"));
        let found = lwc::io::read(workshop.path(file)).unwrap().mesh;
        assert_eq!(found, wanted, "{file}");
        let signs =
            |mesh: &lwc::TriMesh| mesh.positions().iter().flatten().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(signs(&found), signs(&wanted), "{file}");
    }
    let info = workshop.json("info odd.lwc --json");
    let kinds: Vec<&str> =
        info["trailing"].as_array().unwrap().iter().map(|chunk| chunk["kind"].as_str().unwrap()).collect();
    assert_eq!(kinds, ["isolated and degenerate", "exact coordinates", "order"]);
    assert_eq!(info["total_bytes"], fs::metadata(workshop.path("odd.lwc")).unwrap().len());
    // Which grid is best is found out if nobody says it.
    workshop.ok(&format!("encode odd.obj {flags} -o small.lwc"));
    assert!(
        ["12", "15", "18"]
            .contains(&workshop.json("info small.lwc --json")["quantization_bits"].to_string().as_str())
    );
}

fn left_out(report: &serde_json::Value) -> Vec<&str> {
    let losses = report["losses"].as_array().expect("a list").iter();
    losses
        .filter(|loss| loss["kind"] == "dropped")
        .map(|loss| loss["subject"].as_str().expect("a text"))
        .collect()
}

#[test]
fn what_a_stream_does_not_keep_is_told() {
    let workshop = Workshop::new();
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
               property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float quality\n\
               property list uchar int bones\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
               0 0 0 1 2 3 0.5 0\n1 0 0 1 2 3 0.5 0\n0 1 0 1 2 3 0.5 0\n3 0 1 2\n";
    fs::write(workshop.path("rich.ply"), ply).unwrap();
    let (_, stderr) = workshop.ok("encode rich.ply");
    assert!(stderr.contains("rich.ply: left out: vertex.bones\n"), "{stderr}");
    let report = workshop.json("encode rich.ply --json --verify");
    assert_eq!(left_out(&report), ["vertex.bones"]);
    assert_eq!(report["attributes"].as_array().map(Vec::len), Some(2));
    let (info, _) = workshop.ok("info rich.lwc");
    assert!(info.contains("attribute   quality: 1 × 12 bits of vertices"), "{info}");
    workshop.ok("decode rich.lwc -o back.ply");
    let back = fs::read(workshop.path("back.ply")).unwrap();
    assert!(String::from_utf8_lossy(&back).contains("property float quality"));
    let bare = workshop.json("encode rich.ply --json --no-attributes");
    assert_eq!(left_out(&bare), ["vertex.bones", "red green blue", "quality"]);
    assert_eq!(bare["attributes"], serde_json::json!([]));
}

#[test]
fn lossless_keeps_attributes_and_descriptors_say_what_they_know() {
    let workshop = Workshop::new();
    let shaded = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
        property float heat\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
        0 0 0 0.1\n1 0 0 nan\n0 1 0 0.30000001\n3 0 1 2\n";
    fs::write(workshop.path("shaded.ply"), shaded).unwrap();
    assert!(
        workshop.ok("encode shaded.ply").1.contains("left out: values of attributes that are not finite (1)")
    );
    let (_, stderr) = workshop.ok("encode shaded.ply --lossless --keep-order --verify");
    assert!(!stderr.contains("not finite"), "{stderr}");
    assert!(workshop.ok("info shaded.lwc").0.contains("values"));
    workshop.ok("decode shaded.lwc -o back.ply");
    let back = fs::read(workshop.path("back.ply")).unwrap();
    let found: Vec<f32> = (0..3)
        .map(|v| {
            let at = back.windows(11).position(|w| w == b"end_header\n").unwrap() + 11 + 16 * v + 12;
            f32::from_le_bytes(back[at..at + 4].try_into().unwrap())
        })
        .collect();
    assert!(found[0] == 0.1 && found[1].is_nan() && found[2] == 0.3, "{found:?}");

    // And descriptors say which of them know attributes.
    workshop.ok("encode shaded.ply -d pca-qem --descriptor-attributes heat:5");
    for (line, part) in [
        ("encode shaded.ply --descriptor-attributes heat", "harris3d knows no attributes"),
        ("encode shaded.ply -d pca --descriptor-attributes color", "no attribute `color`"),
        ("describe shaded.ply -d nfv --descriptor-attributes heat", "nfv knows no attributes"),
    ] {
        let stderr = workshop.fails(line, 2);
        assert!(stderr.contains(part), "{line}: {stderr}");
    }
}

#[test]
fn gltf_comes_in_and_goes_out() {
    let workshop = Workshop::new();
    workshop.ball_stream();
    workshop.ok("decode ball.lwc -o ball.glb");
    workshop.ok("decode ball.lwc -o ball.gltf --level 1");
    let (text, _) = workshop.ok("decode ball.lwc -o - --format gltf");
    assert!(text.starts_with('{'), "{}", &text[..20]);
    let (_, stderr) = workshop.ok("encode ball.glb -o again.lwc --verify");
    assert!(!stderr.contains("warning"), "{stderr}");
    let distance = workshop.json("compare ball.ply ball.glb --json");
    assert!(distance["db"].as_f64().is_none_or(|db| db > 60.0), "{distance}");

    // The same mesh twice, one of them beside the other.
    let document = fs::read_to_string(workshop.path("ball.gltf")).unwrap();
    let mut document: Value = serde_json::from_str(&document).unwrap();
    document["nodes"] = serde_json::json!([{ "mesh": 0 }, { "mesh": 0, "translation": [9, 0, 0] }]);
    document["scenes"][0]["nodes"] = serde_json::json!([0, 1]);
    fs::write(workshop.path("two.gltf"), document.to_string()).unwrap();
    let merged = workshop.json("encode two.gltf --merge --json --quiet");
    let single = workshop.json("encode ball.gltf --json --quiet");
    assert_eq!(merged["triangles"].as_u64(), single["triangles"].as_u64().map(|count| 2 * count));

    // In a stream it is there once, and comes back in both places.
    let scene = workshop.json("encode two.gltf --json --quiet --verify");
    assert_eq!(scene["triangles"], single["triangles"]);
    workshop.ok("decode two.lwc -o back.gltf");
    let back: Value = serde_json::from_slice(&fs::read(workshop.path("back.gltf")).unwrap()).unwrap();
    assert_eq!((back["meshes"].as_array().unwrap().len(), back["nodes"].as_array().unwrap().len()), (1, 2));
    let distance = workshop.json("compare two.gltf two.lwc --json");
    assert!(distance["db"].as_f64().is_none_or(|db| db > 60.0), "{distance}");
    workshop.ok("decode two.lwc -o back.ply");
    let distance = workshop.json("compare two.gltf back.ply --json");
    assert!(distance["db"].as_f64().is_none_or(|db| db > 60.0), "{distance}");
}

#[test]
fn point_clouds_become_terrain() {
    let workshop = Workshop::new();
    let mut cloud = vec![0; 227];
    let mut put = |at: usize, field: &[u8]| cloud[at..at + field.len()].copy_from_slice(field);
    put(0, b"LASF");
    put(24, &[1, 2]);
    put(94, &227u16.to_le_bytes());
    put(96, &227u32.to_le_bytes());
    put(105, &20u16.to_le_bytes());
    put(107, &400u32.to_le_bytes());
    put(131, [0.5f64; 3].map(f64::to_le_bytes).as_flattened());
    for k in 0..400i32 {
        let mut record = [0; 20];
        record[..12].copy_from_slice([k % 20, k / 20, k % 7].map(i32::to_le_bytes).as_flattened());
        // Every other point is the first of two returns.
        record[14] = 1 | (1 + (k % 2) as u8) << 3;
        cloud.extend(record);
    }
    fs::write(workshop.path("scan.las"), cloud).unwrap();
    assert_eq!(workshop.json("encode scan.las --json --verify")["vertices"], 400);
    let (_, stderr) = workshop.ok("encode scan.las --last-returns");
    assert!(stderr.contains("scan.las: left out: points above others, or not wanted (200)"), "{stderr}");
    let attributes = &workshop.json("encode scan.las --json")["attributes"];
    assert_eq!(attributes[0]["name"], "classification", "{attributes}");
    assert_eq!(workshop.json("encode scan.las --json --thin 2")["vertices"], 25);
    assert!(workshop.json("encode scan.las --json --max-points 100")["vertices"].as_u64() <= Some(100));
    workshop.fails("encode ball.ply --thin 2", 2);
    workshop.ball_stream();
    workshop.fails("decode ball.lwc -o ball.las", 2);
}

#[test]
fn threads_do_not_change_the_stream() {
    let workshop = Workshop::new();
    workshop.ok("encode ball.ply -o one.lwc --threads 1");
    workshop.ok("encode ball.ply -o three.lwc --threads 3");
    let stream = |name| fs::read(workshop.path(name)).unwrap();
    assert_eq!(stream("one.lwc"), stream("three.lwc"));
}

// --- decode ---

#[test]
fn the_whole_stream_is_the_mesh_on_the_grid() {
    let workshop = Workshop::new();
    workshop.ball_stream();
    let (stdout, stderr) = workshop.ok("decode ball.lwc");
    assert!(stderr.starts_with("ball.decoded.obj: 642 vertices, 1280 triangles, level "), "{stderr}");
    assert!(stderr.lines().nth(1).is_some_and(|line| line.starts_with("lost: ")), "{stderr}");
    assert_eq!((stdout, stderr.lines().count()), (String::new(), 2));
    let decoded = workshop.mesh("ball.decoded.obj");
    assert_eq!((decoded.num_vertices(), decoded.num_triangles()), (642, 1280));

    let info = workshop.json("info ball.lwc --json");
    let step = info["step"][0].as_f64().unwrap();
    workshop.ok("decode ball.lwc -o double.obj --position-type double");
    for (mesh, most) in [(&decoded, 0.125), (&workshop.mesh("double.obj"), 1e-6)] {
        for p in mesh.positions() {
            for (axis, x) in p.iter().enumerate() {
                let cell = (x - info["origin"][axis].as_f64().unwrap()) / step;
                assert!((cell - cell.round()).abs() < most && (-0.5..4095.5).contains(&cell), "{cell}");
            }
        }
    }
    let distance = workshop.json("compare ball.ply ball.lwc --json");
    assert!(distance["max"].as_f64().unwrap() <= step);
}

/// The options of mesh files, from the command line to the file.
#[test]
fn a_mesh_is_written_as_its_readers_want_it() {
    let workshop = Workshop::new();
    let obj = "v 0.1 0 0 0.5 0.25 1\nv 1.1 0 0 0.5 0.25 1\nv 1.1 1 0 0.5 0.25 1\nv 0.1 1 0 0.5 0.25 1\n\
               vt 0 0\nvt 0.5 0\nvt 0.5 1\nvt 0.1 0.2\nvn 0 0 1\nf 1/1/1 2/2/1 3/3/1\nf 1/4/1 3/3/1 4/2/1\n";
    fs::write(workshop.path("seam.obj"), obj).unwrap();
    workshop.ok("encode seam.obj");
    let header = |line: &str| {
        let (_, stderr) = workshop.ok(&format!("decode seam.lwc -o out.ply {line}"));
        let bytes = fs::read(workshop.path("out.ply")).unwrap();
        let text = String::from_utf8_lossy(&bytes).into_owned();
        (text.split("end_header").next().unwrap().to_owned(), stderr)
    };
    let (usual, stderr) = header("");
    for line in ["property float x", "property uchar red", "property float nx", "list uchar float texcoord"] {
        assert!(usual.contains(line), "{usual}");
    }
    assert!(!stderr.contains("warning"), "rounding is no news: {stderr}");
    assert!(stderr.contains("positions rounded to float32, by at most "), "{stderr}");
    assert!(stderr.contains("vt: 5 of 10 values rounded, by at most "), "{stderr}");
    assert!(header("--position-type double").0.contains("property double x"));
    assert!(header("--color-type ushort").0.contains("property uint16 red"));
    assert!(header("--color-type keep").0.contains("property double red"));
    let (split, _) = header("--split-seams");
    assert!(split.contains("vertex 5\n") && split.contains("property float s\n"), "{split}");

    let colour = |line: &str| {
        workshop.ok(&format!("decode seam.lwc -o out.glb {line}"));
        let file = io::read(workshop.path("out.glb")).unwrap();
        let colour = file.attributes.list.iter().find(|attribute| attribute.name == "COLOR_0").unwrap();
        (colour.number(0, 0).unwrap(), file.mesh.bounding_box().unwrap().1)
    };
    let (linear, corner) = colour("");
    assert!((linear - 0.215).abs() < 2e-3 && corner[1] > 0.99, "{linear}");
    let (kept, corner) = colour("--color-space keep --up z");
    assert!((kept - 0.5).abs() < 3e-3 && corner[1] < 0.01, "{kept}");
    workshop.fails("decode seam.lwc -o out.glb --up x", 2);
}

#[test]
fn every_format_can_be_written() {
    let workshop = Workshop::new();
    workshop.ball_stream();
    for ending in ["obj", "ply", "stl", "obj.zst", "ply.zst", "stl.zst"] {
        workshop.ok(&format!("decode ball.lwc -o out.{ending}"));
        assert_eq!(workshop.mesh(&format!("out.{ending}")).num_triangles(), 1280);
    }
    workshop.ok("decode ball.lwc --format ply");
    assert_eq!(workshop.mesh("ball.decoded.ply"), workshop.mesh("out.ply"));
}

#[test]
fn a_level_is_a_coarser_mesh() {
    let workshop = Workshop::new();
    workshop.ball_stream();
    let info = workshop.json("info ball.lwc --json");
    let levels = info["levels"].as_u64().unwrap();
    let mut vertices = 0;
    for level in 0..=levels {
        workshop.ok(&format!("decode ball.lwc --level {level}"));
        let mesh = workshop.mesh(&format!("ball.level{level}.obj"));
        assert!(mesh.num_vertices() > vertices);
        vertices = mesh.num_vertices();
    }
    assert_eq!(vertices, 642);
    let (_, stderr) = workshop.ok("decode ball.lwc --level 99");
    assert!(stderr.contains(&format!("there is no level 99, the finest is {levels}")), "{stderr}");
    // The name tells what is there.
    assert!(stderr.contains(&format!("ball.level{levels}.obj: 642 vertices")), "{stderr}");
    assert!(!workshop.path("ball.level99.obj").exists());
    fs::copy(workshop.path("ball.lwc"), workshop.path("cut.lwc")).unwrap();
    let end = info["passes"].as_array().unwrap().iter().find(|pass| pass["level"] == 3).unwrap();
    let cut = fs::read(workshop.path("cut.lwc")).unwrap()[..end["end"].as_u64().unwrap() as usize].to_vec();
    fs::write(workshop.path("cut.lwc"), cut).unwrap();
    workshop.ok("decode cut.lwc --level 5");
    assert!(workshop.path("cut.level3.obj").exists());
}

#[test]
fn a_cut_stream_is_a_coarser_mesh() {
    let workshop = Workshop::new();
    let stream = workshop.ball_stream();
    let info = workshop.json("info ball.lwc --json");
    for pass in info["passes"].as_array().unwrap() {
        // Cut just behind the pass, or by the decoder.
        let end = pass["end"].as_u64().unwrap() as usize;
        let cut = stream[..(end + 3).min(stream.len())].to_vec();
        let (_, stderr) = succeeded("cut", workshop.run_with_input("decode -o cut.ply", cut));
        workshop.ok(&format!("decode ball.lwc --bytes {end} -o bytes.ply"));
        let mesh = workshop.mesh("cut.ply");
        assert_eq!(mesh.num_vertices() as u64, pass["vertices"].as_u64().unwrap());
        assert_eq!(mesh, workshop.mesh("bytes.ply"));
        let is_whole = end == stream.len();
        assert_eq!(stderr.contains("lwc: note: "), !is_whole, "{stderr}");
        assert!(is_whole || stderr.contains(&format!("ends after level {} of", pass["level"])), "{stderr}");
    }
    workshop.ok("decode --quiet ball.lwc --bytes 1K");
}

#[test]
fn a_stream_may_come_from_standard_input_and_go_to_standard_output() {
    let workshop = Workshop::new();
    let output = workshop.run("encode ball.ply -o -");
    let stream = workshop.ball_stream();
    assert_eq!((output.stdout, text(output.stderr)), (stream.clone(), String::new()));
    let report = workshop.run("encode ball.ply -o - --json").stderr;
    assert_eq!(serde_json::from_slice::<Value>(&report).unwrap()["bytes"], stream.len());

    let (obj, stderr) = succeeded("pipe", workshop.run_with_input("decode - -o -", stream.clone()));
    assert_eq!((obj.matches("\nf ").count(), stderr.as_str()), (1280, ""));
    let stl = workshop.run_with_input("decode --output - --format stl", stream.clone()).stdout;
    assert_eq!(io::read_bytes(&stl, io::Format::Stl).unwrap().mesh.num_triangles(), 1280);
    let (info, _) = succeeded("info", workshop.run_with_input("info", stream.clone()));
    assert!(info.starts_with("standard input: "));

    let stderr = failed("no -o", workshop.run_with_input("decode", stream), 2);
    assert!(error_line(&stderr).contains("-o FILE"));
}

#[test]
fn damage_is_an_error_unless_salvage_is_asked_for() {
    let workshop = Workshop::new();
    let mut stream = workshop.ball_stream();
    let passes = workshop.json("info ball.lwc --json")["passes"].clone();
    let last_but_one = &passes[passes.as_array().unwrap().len() - 2];
    *stream.last_mut().unwrap() ^= 1;
    fs::write(workshop.path("hurt.lwc"), &stream).unwrap();
    let stderr = workshop.fails("decode hurt.lwc", 4);
    assert!(error_line(&stderr).starts_with("lwc: hurt.lwc: damaged stream: "), "{stderr}");
    workshop.fails("compare ball.ply hurt.lwc", 4);

    let (_, stderr) = workshop.ok("decode hurt.lwc --salvage");
    assert!(
        stderr.starts_with("lwc: warning: hurt.lwc: damaged stream: ") && stderr.contains("salvaged level")
    );
    let salvaged = workshop.mesh("hurt.decoded.obj");
    assert_eq!(salvaged.num_vertices() as u64, last_but_one["vertices"].as_u64().unwrap());

    // The header is damaged: nothing to salvage.
    stream[12] ^= 1;
    fs::write(workshop.path("hurt.lwc"), &stream).unwrap();
    error_line(&workshop.fails("decode hurt.lwc --salvage --level 1", 4));
    error_line(&workshop.fails("info hurt.lwc", 4));
}

#[test]
fn streams_too_short_for_a_mesh_are_damaged() {
    let workshop = Workshop::new();
    let stream = workshop.ball_stream();
    for length in [0, 1, 4, 20] {
        fs::write(workshop.path("short.lwc"), &stream[..length]).unwrap();
        let stderr = workshop.fails("decode short.lwc", 4);
        let expected =
            if length == 0 { "short.lwc: the input is empty" } else { "ends before its base mesh" };
        assert!(error_line(&stderr).contains(expected), "{stderr}");
        let stderr = workshop.fails("info short.lwc", 4);
        let expected = if length == 0 { "short.lwc: the input is empty" } else { "ends before its table" };
        assert!(error_line(&stderr).contains(expected), "{stderr}");
    }
    error_line(&workshop.fails("decode ball.lwc --bytes 0", 4));
}

#[test]
fn limits_have_their_own_exit_code() {
    let workshop = Workshop::new();
    workshop.ball_stream();
    let stderr = workshop.fails("decode ball.lwc --max-vertices 500", 5);
    assert_eq!(error_line(&stderr), "lwc: ball.lwc: limit of vertices exceeded: 642 needed, 500 allowed");
    error_line(&workshop.fails("decode ball.lwc --max-memory 100K", 5));
    error_line(&workshop.fails("compare ball.ply ball.lwc --max-vertices 0.5k", 5));
    workshop.ok("decode ball.lwc --max-vertices 1k --max-memory 16MiB");
    workshop.ok("decode ball.lwc --max-vertices 500 --level 1");
}

// --- info ---

#[test]
fn info_shows_what_is_there_and_what_is_missing() {
    let workshop = Workshop::new();
    let stream = workshop.ball_stream();
    let (table, _) = workshop.ok("info ball.lwc");
    assert!(table.contains("descriptor  harris3d, 4 rings, radius 3 mean edges"), "{table}");
    assert!(table.contains("12 bits, origin (") && !table.contains("missing"), "{table}");
    let info = workshop.json("info ball.lwc --json");
    let passes = info["passes"].as_array().unwrap();
    assert_eq!(table.lines().skip_while(|l| !l.starts_with("pass")).count(), passes.len() + 1);
    let sum: u64 = passes.iter().map(|p| p["bytes"].as_u64().unwrap()).sum();
    assert_eq!(sum + info["header_bytes"].as_u64().unwrap(), stream.len() as u64);
    assert_eq!((&info["complete"], &info["vertices"]), (&true.into(), &642.into()));
    let odd = |p: &Value| p["odd_share"].as_f64();
    assert!(passes.iter().all(|p| odd(p).is_some() == (p["kind"] == "split")));
    assert!(passes.iter().filter_map(odd).all(|share| share > 0.0 && share < 0.5));

    fs::write(workshop.path("cut.lwc"), &stream[..stream.len() / 2]).unwrap();
    assert!(workshop.ok("info cut.lwc").0.contains("missing"));
    let cut = workshop.json("info cut.lwc --json");
    assert_eq!((&cut["complete"], &cut["total_bytes"]), (&false.into(), &stream.len().into()));
    let present = cut["passes"].as_array().unwrap().iter().filter(|p| p["present"] == true).count();
    assert!(cut["passes_present"] == present && (1..passes.len()).contains(&present));
}

// --- describe ---

#[test]
fn describe_lists_every_vertex_in_full() {
    let workshop = Workshop::new();
    let (mut positions, triangles) = noisy(sphere(2), 7, 0.02).into_parts();
    positions.insert(0, [5.0; 3]);
    let triangles = triangles.into_iter().map(|t| t.map(|v| v + 1)).collect();
    let mesh = build(positions, triangles);
    workshop.put("spare.obj", &mesh);
    for descriptor in Descriptor::ALL {
        let window = Window { rings: 3, radius: 2.0 };
        let expected = evaluate(descriptor, &mesh, &window, mean_edge_length(&mesh));
        let (table, _) = workshop.ok(&format!("describe spare.obj -d {descriptor} --rings 3 --radius 2"));
        let mut lines = table.lines();
        assert_eq!((lines.next(), lines.next()), (Some("vertex,value"), Some("0,0")));
        let rows = table.lines().skip(1).map(|row| row.split_once(',').expect("two columns"));
        let values: Vec<f64> = rows.map(|(_, value)| value.parse().expect("a number")).collect();
        assert_eq!(values, expected);
    }
    workshop.ok("describe spare.obj -o out.csv");
    assert_eq!(fs::read_to_string(workshop.path("out.csv")).unwrap(), workshop.ok("describe spare.obj").0);
}

// --- compare ---

#[test]
fn compare_takes_meshes_and_streams() {
    let workshop = Workshop::new();
    workshop.ball_stream();
    workshop.put("moved.obj", &map_positions(sphere(3), |p| [p[0], p[1], p[2] + 0.25]));
    workshop.put("still.obj", &sphere(3));
    let same = workshop.json("compare ball.lwc ball.lwc --json");
    assert_eq!((&same["identical"], &same["db"], &same["rms"]), (&true.into(), &Value::Null, &0.0.into()));
    assert!(workshop.ok("compare ball.ply ball.ply").0.contains("identical"));

    let other = workshop.json("compare still.obj moved.obj --json --samples 20K");
    let number = |key: &str| other[key].as_f64().unwrap();
    assert!(other["identical"] == false && number("rms") < number("max"));
    assert!((0.2..=0.25).contains(&number("max")));
    assert!((number("db") + 20.0 * number("rms_relative").log10()).abs() < 1e-9);
    assert!(workshop.ok("compare still.obj moved.obj").0.contains(" dB"));

    fs::write(workshop.path("empty.obj"), "").unwrap();
    let stderr = workshop.fails("compare ball.ply empty.obj", 3);
    assert!(error_line(&stderr).contains("the second mesh has no vertices"));
}

#[test]
fn normals_that_are_not_finite_are_told_of() {
    let workshop = Workshop::new();
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn -nan(ind) 0 1\nvn 0 0 1\nf 1//1 2//2 3//2\n";
    fs::write(workshop.path("nan.obj"), text).unwrap();
    let warning = |line: &str| workshop.ok(line).1.lines().next().unwrap_or_default().to_owned();
    let expected = "lwc: warning: nan.obj: left out: values of attributes that are not finite (1): `--lossless` keeps them";
    assert_eq!(warning("encode nan.obj -o a.lwc"), expected);
    let expected = "lwc: warning: nan.obj: 1 normal or texture coordinate kept: not finite";
    assert_eq!(warning("encode nan.obj -o b.lwc --lossless"), expected);
}

// --- other failures ---

#[test]
fn bad_inputs_are_named_in_one_sentence() {
    let workshop = Workshop::new();
    fs::write(workshop.path("bad.obj"), "v 0 0 0\nv 1 0 0\nv one 0 0\n").unwrap();
    fs::write(workshop.path("points.obj"), "v 0 0 0\nv 1 0 0\n").unwrap();
    fs::write(workshop.path("fake.lwc"), "ply\nformat ascii 1.0\n").unwrap();
    fs::write(workshop.path("fake.ply.zst"), "not zstd").unwrap();
    fs::create_dir(workshop.path("folder.lwc")).unwrap();
    for (line, expected) in [
        ("encode bad.obj", "lwc: bad.obj: line 3: "),
        ("describe bad.obj", "lwc: bad.obj: line 3: "),
        ("compare ball.ply bad.obj", "lwc: bad.obj: line 3: "),
        ("encode points.obj", "lwc: points.obj: a point cloud, which has no triangles"),
        ("encode missing.obj", "lwc: missing.obj: "),
        ("encode fake.ply.zst", "lwc: fake.ply.zst: cannot decompress: "),
        ("decode missing.lwc", "lwc: missing.lwc: "),
        ("decode folder.lwc", "lwc: folder.lwc: "),
        ("info missing.lwc", "lwc: missing.lwc: "),
        ("decode fake.lwc", "lwc: fake.lwc: not an lwc stream"),
        ("info fake.lwc", "lwc: fake.lwc: not an lwc stream"),
        ("compare ball.ply fake.lwc", "lwc: fake.lwc: not an lwc stream"),
        ("encode missing", "lwc: missing: there is no such file"),
        ("view missing --no-open", "lwc: missing: there is no such file"),
        ("view missing.lwc --no-open", "lwc: missing.lwc: there is no such file"),
        ("render missing -o x.png", "lwc: missing: there is no such file"),
        ("encode .", "lwc: .: it is a folder"),
        ("view . --no-open", "lwc: .: it is a folder"),
        ("info .", "lwc: .: it is a folder"),
        ("decode folder.lwc", "lwc: folder.lwc: it is a folder"),
    ] {
        let stderr = workshop.fails(line, 3);
        assert!(error_line(&stderr).starts_with(expected), "`{line}`: {stderr}");
    }
    let stderr = workshop.fails("encode points.obj", 3);
    let sentence = "lwc: points.obj: a point cloud, which has no triangles to encode: 2 points\n";
    assert_eq!(stderr, sentence);
}

#[test]
fn streams_that_are_to_be_encoded_are_known_for_what_they_are() {
    let workshop = Workshop::new();
    workshop.ball_stream();
    fs::copy(workshop.path("ball.lwc"), workshop.path("ball")).unwrap();
    for line in ["encode ball.lwc", "encode ball.lwc -o other.lwc", "encode ball"] {
        let stderr = workshop.fails(line, 3);
        assert!(error_line(&stderr).ends_with("it is an lwc stream already"), "`{line}`: {stderr}");
    }
    let stderr = workshop.fails("filter ball.lwc", 3);
    assert!(error_line(&stderr).contains("it is an lwc stream, not a mesh"), "{stderr}");
    // Where either will do, the ending does not matter.
    assert_eq!(workshop.json("compare ball ball.lwc --json")["identical"], true);
    assert!(error_line(&workshop.fails("info", 4)).ends_with("standard input: the input is empty"));
    assert!(error_line(&workshop.fails("decode -o -", 4)).ends_with("standard input: the input is empty"));
}

#[test]
fn outputs_that_cannot_be_written_are_other_failures() {
    let workshop = Workshop::new();
    workshop.ball_stream();
    for (line, expected) in [
        ("encode ball.ply -o nowhere/ball.lwc", "lwc: nowhere/ball.lwc: there is no folder nowhere"),
        ("decode ball.lwc -o nowhere/ball.obj", "lwc: nowhere/ball.obj: there is no folder nowhere"),
        ("describe ball.ply -o nowhere/ball.csv", "lwc: nowhere/ball.csv: there is no folder nowhere"),
        ("encode ball.ply -o .", "lwc: .: it is a folder"),
    ] {
        assert_eq!(error_line(&workshop.fails(line, 1)), expected);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_device_is_an_error() {
    let workshop = Workshop::new();
    workshop.ball_stream();
    for line in ["encode ball.ply -o -", "decode ball.lwc -o -", "info ball.lwc", "describe ball.ply"] {
        let full = fs::File::options().write(true).open("/dev/full").unwrap();
        let mut command = std::process::Command::new(assert_cmd::cargo::cargo_bin("lwc"));
        command.current_dir(workshop.0.path()).args(line.split(' ')).stdout(full);
        assert_eq!(command.output().unwrap().status.code(), Some(1), "{line}");
    }
}

#[cfg(unix)]
#[test]
fn a_broken_pipe_ends_quietly() {
    let workshop = Workshop::new();
    workshop.ball_stream();
    // Far more than a pipe holds.
    workshop.put("large.ply", &sphere(5));
    workshop.ok("encode large.ply --quiet");
    for line in ["describe large.ply", "decode large.lwc -o -", "decode large.lwc -o - --format ply"] {
        let mut command = std::process::Command::new(assert_cmd::cargo::cargo_bin("lwc"));
        command.current_dir(workshop.0.path()).args(line.split(' '));
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert_eq!((output.status.code(), text(output.stderr)), (Some(0), String::new()), "{line}");
    }
}

// --- files of the corpus ---

#[test]
fn hostile_files_encode_or_fail_with_one_sentence() {
    let Some(corpus) = corpus() else { return };
    let workshop = Workshop::new();
    let mut encoded = 0;
    for entry in fs::read_dir(corpus.join("bad")).unwrap() {
        let path = entry.unwrap().path();
        let mut command = Command::cargo_bin("lwc").unwrap();
        command.current_dir(workshop.0.path()).arg("encode").arg(&path).args(["-o", "out.lwc", "--verify"]);
        let output = command.timeout(std::time::Duration::from_secs(60)).output().unwrap();
        let stderr = text(output.stderr);
        let name = path.display();
        assert!(!stderr.contains("panicked"), "{name}: {stderr}");
        if output.status.code() == Some(0) {
            encoded += 1;
            workshop.ok("decode out.lwc -o out.obj");
            fs::remove_file(workshop.path("out.lwc")).unwrap();
        } else {
            // Unusable, or declared too large.
            assert!(matches!(output.status.code(), Some(3 | 5)), "{name}: {stderr}");
            assert!(error_line(&stderr).starts_with(&format!("lwc: {name}: ")), "{name}: {stderr}");
            assert!(!workshop.path("out.lwc").exists(), "{name} leaves a file");
        }
    }
    assert!(encoded > 0);
}
