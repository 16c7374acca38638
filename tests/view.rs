//! `lwc view`: what its server gives, and what it does not.
#![cfg(feature = "cli")]
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};

struct Server {
    program: Child,
    address: String,
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}

struct Answer {
    status: u16,
    head: String,
    body: Vec<u8>,
}

impl Server {
    fn start(model: &str) -> Self {
        Self::start_by(Command::new(env!("CARGO_BIN_EXE_lwc")), model)
    }

    /// `command` runs the program with further arguments.
    fn start_by(mut command: Command, model: &str) -> Self {
        let mut program = command
            .args(["view", model, "--no-open", "--quiet"])
            .current_dir(env!("CARGO_MANIFEST_DIR"))
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut line = String::new();
        BufReader::new(program.stdout.take().unwrap()).read_line(&mut line).unwrap();
        let address = line.trim().strip_prefix("http://").unwrap().trim_end_matches('/').to_owned();
        Self { program, address }
    }

    fn get(&self, path: &str, headers: &str) -> Answer {
        self.request(&format!("GET {path} HTTP/1.1\r\nHost: {}\r\n{headers}", self.address))
    }

    fn request(&self, head: &str) -> Answer {
        let mut stream = TcpStream::connect(&self.address).unwrap();
        write!(stream, "{head}Connection: close\r\n\r\n").unwrap();
        let mut bytes = Vec::new();
        stream.read_to_end(&mut bytes).unwrap();
        let end = bytes.windows(4).position(|w| w == b"\r\n\r\n").unwrap();
        let head = String::from_utf8(bytes[..end].to_vec()).unwrap();
        let status = head.split(' ').nth(1).unwrap().parse().unwrap();
        Answer { status, head, body: bytes[end + 4..].to_vec() }
    }
}

const TORUS: &str = "format/golden/torus.lwc";

fn torus() -> Vec<u8> {
    std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join(TORUS)).unwrap()
}

#[test]
fn the_page_and_its_parts_come_from_the_program() {
    let server = Server::start(TORUS);
    let page = server.get("/", "");
    assert_eq!(page.status, 200);
    let html = String::from_utf8(page.body).unwrap();
    assert!(html.contains("viewer.js") && !html.contains("http"), "the page needs the network");
    assert!(page.head.contains("Content-Security-Policy: default-src 'self'"));
    for (path, kind) in [
        ("/viewer.js", "text/javascript"),
        ("/worker.js", "text/javascript"),
        ("/lwc.wasm", "application/wasm"),
        ("/lwc-assets.wasm", "application/wasm"),
    ] {
        let part = server.get(path, "");
        assert_eq!(part.status, 200, "{path}");
        assert!(part.head.contains(&format!("Content-Type: {kind}")), "{}", part.head);
        assert!(part.body.len() > 1000, "{path}: {} bytes", part.body.len());
    }
}

#[test]
fn the_stream_comes_whole_or_in_ranges() {
    let (server, torus) = (Server::start(TORUS), torus());
    let whole = server.get("/model.lwc", "");
    assert_eq!((whole.status, &whole.body), (200, &torus));
    assert!(whole.head.contains("Accept-Ranges: bytes") && whole.head.contains("ETag: \""));

    let rest = server.get("/model.lwc", "Range: bytes=100-\r\n");
    assert_eq!((rest.status, &rest.body[..]), (206, &torus[100..]));
    assert!(rest.head.contains(&format!("Content-Range: bytes 100-{}/{}", torus.len() - 1, torus.len())));

    let middle = server.get("/model.lwc", "Range: bytes=10-19\r\n");
    assert_eq!((middle.status, &middle.body[..]), (206, &torus[10..20]));
    let beyond = server.get("/model.lwc", "Range: bytes=99999-\r\n");
    assert_eq!(beyond.status, 416);
    let head = server.request(&format!("HEAD /model.lwc HTTP/1.1\r\nHost: {}\r\n", server.address));
    assert!(head.body.is_empty() && head.head.contains(&format!("Content-Length: {}", torus.len())));
    let several = server.get("/model.lwc", "Range: bytes=0-1,4-5\r\n");
    assert_eq!((several.status, &several.body), (200, &torus));
}

#[test]
fn nothing_else_is_served() {
    let server = Server::start(TORUS);
    for path in [
        "/Cargo.toml",
        "/../Cargo.toml",
        "/%2e%2e/Cargo.toml",
        "//etc/passwd",
        "/format/golden/torus.lwc",
        "/web/viewer/index.html",
    ] {
        assert_eq!(server.get(path, "").status, 404, "{path}");
    }
    let host = "GET / HTTP/1.1\r\nHost: example.com\r\n";
    assert_eq!(server.request(host).status, 403, "another name for this machine");
    let post = format!("POST / HTTP/1.1\r\nHost: {}\r\nContent-Length: 0\r\n", server.address);
    assert_eq!(server.request(&post).status, 405);
}

#[test]
fn one_that_does_not_read_does_not_keep_others_waiting() {
    let server = Server::start(TORUS);
    let idle: Vec<TcpStream> = (0..20).map(|_| TcpStream::connect(&server.address).unwrap()).collect();
    assert_eq!(server.get("/model.lwc", "").body, torus());
    drop(idle);
}

/// More connections than it may have open files: `accept` fails until some have gone.
#[cfg(unix)]
#[test]
fn a_shortage_of_files_passes() {
    let mut command = Command::new("sh");
    command.args(["-c", r#"ulimit -n 16; exec "$0" "$@""#, env!("CARGO_BIN_EXE_lwc")]);
    let mut server = Server::start_by(command, TORUS);
    for _ in 0..2 {
        let idle: Vec<TcpStream> = (0..40).map(|_| TcpStream::connect(&server.address).unwrap()).collect();
        std::thread::sleep(std::time::Duration::from_millis(300));
        assert!(server.program.try_wait().unwrap().is_none(), "the server has ended");
        drop(idle);
        assert_eq!(server.get("/model.lwc", "").body, torus());
    }
}

#[test]
fn a_mesh_is_encoded_and_described() {
    let server = Server::start("tests/data/knot.ply");
    let stream = server.get("/model.lwc", "").body;
    let mesh = lwc::decode(&stream, lwc::DecodeOptions::new()).unwrap();
    let colours = server.get("/descriptor", "").body;
    assert_eq!(colours.len(), mesh.num_vertices());
    assert!(colours.contains(&0) && colours.contains(&255));

    let about = String::from_utf8(server.get("/about.json", "").body).unwrap();
    let about: serde_json::Value = serde_json::from_str(&about).unwrap();
    assert_eq!(
        (about["name"].as_str(), about["bytes"].as_u64()),
        (Some("knot.ply"), Some(stream.len() as u64))
    );

    let passes = lwc::StreamInfo::read(&stream).unwrap().unwrap().passes().len();
    let db = loop {
        let body = server.get("/quality.json", "").body;
        let quality: serde_json::Value = serde_json::from_slice(&body).unwrap();
        let db = quality["db"].as_array().unwrap().clone();
        if db.len() == passes {
            break db;
        }
        std::thread::sleep(std::time::Duration::from_millis(100));
    };
    let (first, late) = (db[0].as_f64().unwrap(), db[passes - 2].as_f64().unwrap());
    assert!(first > 10.0 && late > first + 20.0, "{db:?}");
}

#[test]
fn what_is_no_model_is_refused() {
    for (model, code) in [("no-such-file.lwc", 3), ("README.md", 3)] {
        let output = Command::new(env!("CARGO_BIN_EXE_lwc"))
            .args(["view", model, "--no-open"])
            .current_dir(env!("CARGO_MANIFEST_DIR"))
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(code), "{model}");
        assert!(output.stdout.is_empty());
    }
}
