//! What takes long tells how far it is: from 0 to 1, and never back.
#![cfg(all(
    feature = "encoder",
    feature = "experiment",
    feature = "io",
    feature = "metrics",
    feature = "render"
))]
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

mod common;

use common::*;
use lwc::descriptors::{Descriptor, Window, evaluate_with_progress, mean_edge_length};
use lwc::experiment::{Experiment, Settings};
use lwc::io::ReadOptions;
use lwc::mesh::Attributes;
use lwc::metrics::{CompareOptions, compare, compare_with_progress};
use lwc::multiresolution::{Decomposition, DetailTransfer, Options, denoised_with_progress};
use lwc::render::{Camera, Paint, Style, Up, View, render, render_with_progress};
use lwc::{DecodeOptions, EncodeOptions, Limits, Optimize, TriMesh, encode_with_attributes};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// What was told, in order.
#[derive(Default)]
struct Told(Mutex<Vec<f64>>);

impl Told {
    fn hear(&self, fraction: f64) {
        self.0.lock().unwrap().push(fraction);
    }

    /// It went from 0 to 1 in at least so many steps.
    fn check(self, what: &str, least: usize) {
        let told = self.0.into_inner().unwrap();
        assert!(told.len() >= least, "{what}: only {told:?}");
        assert!(told.is_sorted() && told[0] >= 0.0, "{what}: {told:?}");
        assert_eq!(told.last(), Some(&1.0), "{what}");
    }
}

fn ball() -> TriMesh {
    noisy(sphere(4), 1, 0.01)
}

#[test]
fn encoding_does() {
    let mesh = ball();
    for (what, least, change) in [
        ("usual", 10, (|_| ()) as fn(&mut EncodeOptions)),
        ("size", 20, |options| options.optimize = Optimize::Size),
        ("size in one precision", 10, |options| {
            (options.optimize, options.steps_per_edge) = (Optimize::Size, Some(8.0));
        }),
        ("most effort", 60, |options| (options.optimize, options.effort) = (Optimize::Size, 9)),
        ("no levels", 1, |options| options.levels = Some(0)),
        ("lossless", 10, |options| options.lossless = true),
    ] {
        let mut options = EncodeOptions::default();
        change(&mut options);
        let told = Told::default();
        encode_with_attributes(&mesh, &Attributes::default(), &options, &|now| told.hear(now.fraction))
            .unwrap();
        told.check(what, least);
    }
}

#[test]
fn reading_does() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.ply", "a.obj", "a.stl", "a.ply.zst", "a.obj.zst"] {
        let path = folder.path().join(name);
        lwc::io::write(&path, &ball()).unwrap();
        let told = Told::default();
        let file = ReadOptions::default().read_with_progress(&path, &|done| told.hear(done)).unwrap();
        assert_eq!(file, lwc::io::read(&path).unwrap());
        told.check(name, 2);
    }
}

#[test]
fn comparing_does_on_any_number_of_threads() {
    let (mesh, other) = (ball(), noisy(sphere(3), 2, 0.02));
    for (a, b) in [(&mesh, &other), (&mesh, &mesh)] {
        for num_threads in [1, 4] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(num_threads).build().unwrap();
            let told = Told::default();
            let options = CompareOptions::new().samples(50_000);
            let found =
                pool.install(|| compare_with_progress(a, b, &options, &|done| told.hear(done)).unwrap());
            assert_eq!(found, compare(a, b, &options).unwrap());
            told.check("compare", 20);
        }
    }
}

#[test]
fn levels_and_details_do() {
    let mesh = ball();
    let told = Told::default();
    Decomposition::new_with_progress(&mesh, &Options::default(), &|done| told.hear(done)).unwrap();
    told.check("decomposition", 10);
    let told = Told::default();
    denoised_with_progress(&mesh, &Options::default(), &|done| told.hear(done)).unwrap();
    told.check("denoised", 70);

    let stream = lwc::encode(&mesh, &EncodeOptions::default()).unwrap().bytes;
    let coarse = lwc::decode(&stream, DecodeOptions::new().level(3)).unwrap();
    let told = Told::default();
    let hear = |done| told.hear(done);
    DetailTransfer::new_with_progress(&stream, coarse.num_vertices(), Limits::default(), &hear).unwrap();
    told.check("details of a stream", 10);
}

#[test]
fn drawing_does() {
    let mesh = ball();
    let style = Style { size: [160, 120], ..Style::default() };
    let camera = Camera::fit(&mesh, View::default(), Up::Y, 160, 120);
    let told = Told::default();
    let hear = |done| told.hear(done);
    let picture = render_with_progress(&mesh, Paint::Plain, &camera, &style, &hear).unwrap();
    assert_eq!(picture.pixel(80, 60), render(&mesh, Paint::Plain, &camera, &style).unwrap().pixel(80, 60));
    told.check("render", 100);
}

#[test]
fn experiments_do() {
    let experiment = Experiment::new(&ball(), None).unwrap();
    let told = Told::default();
    experiment.run(Descriptor::Sqem, &Settings::default(), &|done| told.hear(done));
    told.check("experiment", 5);
}

#[test]
fn descriptors_count_every_vertex_once() {
    let mesh = ball();
    for descriptor in Descriptor::ALL {
        let done = AtomicUsize::new(0);
        let count = |more: usize| {
            done.fetch_add(more, Ordering::Relaxed);
        };
        evaluate_with_progress(descriptor, &mesh, &Window::default(), mean_edge_length(&mesh), &count);
        assert_eq!(done.into_inner(), mesh.num_vertices(), "{descriptor}");
    }
}
