//! The program in a folder of its own.
#![allow(dead_code)]

use super::{noisy, sphere};
use assert_cmd::Command;
use lwc::{TriMesh, io};
use serde_json::Value;
use std::fs;
use std::path::PathBuf;
use std::process::Output;
use tempfile::TempDir;

/// A folder of meshes to play with.
pub struct Workshop(pub TempDir);

impl Workshop {
    pub fn new() -> Self {
        let workshop = Self(tempfile::tempdir().expect("a temporary folder"));
        workshop.put("ball.ply", &noisy(sphere(3), 1, 0.01));
        workshop
    }

    pub fn put(&self, name: &str, mesh: &TriMesh) {
        io::write(self.path(name), mesh).expect("a mesh file");
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn mesh(&self, name: &str) -> TriMesh {
        io::read(self.path(name)).expect("a mesh").mesh
    }

    /// Names of all files, sorted.
    pub fn files(&self) -> Vec<String> {
        let entries = fs::read_dir(self.0.path()).expect("a folder");
        let name = |entry: std::io::Result<fs::DirEntry>| {
            entry.expect("an entry").file_name().into_string().expect("a name")
        };
        let mut names: Vec<String> = entries.map(name).collect();
        names.sort();
        names
    }

    pub fn run_with_input(&self, line: &str, input: impl Into<Vec<u8>>) -> Output {
        let mut command = Command::cargo_bin("lwc").expect("the program");
        command.current_dir(self.0.path()).args(line.split_whitespace()).write_stdin(input);
        command.output().expect("a run")
    }

    pub fn run(&self, line: &str) -> Output {
        self.run_with_input(line, [])
    }

    /// Standard output and standard error of a run that must succeed.
    pub fn ok(&self, line: &str) -> (String, String) {
        succeeded(line, self.run(line))
    }

    /// The one line of a run that must fail with `code`, without leaving or changing a file.
    pub fn fails(&self, line: &str, code: i32) -> String {
        let before = self.files();
        let output = self.run(line);
        assert_eq!(self.files(), before, "`{line}` leaves files");
        failed(line, output, code)
    }

    pub fn json(&self, line: &str) -> Value {
        serde_json::from_str(&self.ok(line).0).expect("JSON")
    }

    /// The bytes of the stream of `ball.ply`.
    pub fn ball_stream(&self) -> Vec<u8> {
        self.ok("encode ball.ply --quiet");
        fs::read(self.path("ball.lwc")).expect("a stream")
    }
}

pub fn text(bytes: Vec<u8>) -> String {
    String::from_utf8(bytes).expect("text")
}

pub fn succeeded(line: &str, output: Output) -> (String, String) {
    let (stdout, stderr) = (text(output.stdout), text(output.stderr));
    assert_eq!(output.status.code(), Some(0), "`{line}`: {stderr}");
    (stdout, stderr)
}

pub fn failed(line: &str, output: Output, code: i32) -> String {
    let stderr = text(output.stderr);
    assert_eq!(output.status.code(), Some(code), "`{line}`: {stderr}");
    assert!(output.stdout.is_empty(), "`{line}` fails and prints");
    stderr
}

/// The line of an error, without warnings; there must be one.
pub fn error_line(stderr: &str) -> &str {
    let is_chatter = |line: &&str| !line.starts_with("lwc: warning: ") && !line.starts_with("lwc: note: ");
    let errors: Vec<&str> = stderr.lines().filter(is_chatter).collect();
    assert_eq!(errors.len(), 1, "not one line: {stderr}");
    assert!(errors[0].starts_with("lwc: ") && !stderr.contains("panicked"), "{stderr}");
    errors[0]
}
