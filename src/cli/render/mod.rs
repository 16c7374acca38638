//! `lwc render`: pictures of meshes and streams.

pub mod args;
mod montage;

use super::bar::{Part, Vertices};
use super::exit::Failure;
use super::input::{in_place, read_mesh};
use super::input_file::is_stream;
use super::output::{Destination, has_ending, pixels_of, say_written};
use super::stream::{DecodedStream, StreamSource, Wanted, note_if_incomplete, note_if_no_level};
use super::ui::Ui;
use anyhow::Context;
use args::{AttributeKind, ColorBy, HeatArgs, Picture, Render};
use lwc::descriptors::{evaluate_with_progress, mean_edge_length};
use lwc::io::MeshFile;
use lwc::mesh::Attributes;
use lwc::render::{Camera, CornerPaint, Heat, Image, Paint, RenderError, render_with_progress, with_legend};
use lwc::{DecodeError, DecodeOptions, TriMesh};

/// Reads, draws, writes.
pub fn run(args: &Render, ui: &Ui) -> anyhow::Result<()> {
    let destination = Destination::new(args.output.clone());
    check_ending(&destination).with_context(|| destination.name())?;
    destination.check(Some(&args.input), false)?;
    let bar = ui.bar();
    let reading = if is_stream(&args.input) { "decoding" } else { "reading" };
    let [making, writing] = bar.split([(reading, 90.0), ("writing", 10.0)]);
    let picture = if args.montage { montage::montage(args, making)? } else { picture(args, making, ui)? };
    writing.set(0.0);
    destination.write(|out| picture.write_png(out))?;
    drop(bar);
    say_written(&destination, &pixels_of(&picture), ui);
    Ok(())
}

/// One picture.
fn picture(args: &Render, part: Part, ui: &Ui) -> anyhow::Result<Image> {
    let (descriptor, evaluating) = match args.color_by {
        Some(ColorBy::Descriptor(descriptor)) => (descriptor.name(), 50.0),
        _ => ("drawing", 0.0),
    };
    let [reading, evaluating, drawing] =
        part.split([(part.stage(), 50.0), (descriptor, evaluating), ("drawing", args.picture.work())]);
    let MeshFile { mesh, attributes, .. } = read(args, reading, ui)?;
    match args.color_by {
        Some(ColorBy::Descriptor(descriptor)) => {
            let vertices = Vertices::new(mesh.num_vertices(), evaluating);
            let (window, mean_edge) = (args.window.window(), mean_edge_length(&mesh));
            let progress = |more: usize| vertices.add(more);
            let values = evaluate_with_progress(descriptor, &mesh, &window, mean_edge, &progress);
            let title = descriptor.name();
            Ok(heat_picture(&mesh, &values, title, &args.heat, &args.picture, drawing)?)
        }
        Some(ColorBy::Attribute(kind)) => {
            let paint = paint(&mesh, &attributes, kind).with_context(|| args.input.display().to_string())?;
            Ok(picture_with(&mesh, Paint::Corners(&paint), &args.picture, drawing)?)
        }
        None => Ok(picture_with(&mesh, Paint::Plain, &args.picture, drawing)?),
    }
}

fn check_ending(destination: &Destination) -> Result<(), Failure> {
    match destination {
        Destination::File(path) if !has_ending(path, "png") => {
            Err(Failure::Usage("unknown ending; pictures are written as .png only".into()))
        }
        _ => Ok(()),
    }
}

/// The colours that an attribute gives.
fn paint(mesh: &TriMesh, attributes: &Attributes, kind: AttributeKind) -> Result<CornerPaint, Failure> {
    let paint = kind.find(attributes).and_then(|attribute| CornerPaint::new(mesh, attribute));
    paint.ok_or_else(|| Failure::Usage(format!("the mesh has no attribute `{}` to show", kind.name())))
}

/// The mesh to show.
fn read(args: &Render, part: Part, ui: &Ui) -> anyhow::Result<MeshFile> {
    if !is_stream(&args.input) {
        if args.level.is_some() || args.bytes.is_some() {
            let what = "--level and --bytes are for streams (.lwc)".to_owned();
            return Err(Failure::Usage(what)).with_context(|| args.input.display().to_string());
        }
        return read_mesh(&args.input, &args.reading, part, ui);
    }
    let source = StreamSource::File(args.input.clone());
    let wanted = Wanted::new(DecodeOptions::new().limits(args.limits.limits()), args.level);
    let DecodedStream { decoder, error } = source.decode(args.bytes, wanted, part, ui)?;
    if let Some(error) = error {
        return Err(error).with_context(|| source.name());
    }
    note_if_incomplete(&decoder, args.bytes, &source.name(), ui);
    if let (Some(info), Some(level)) = (decoder.info(), args.level) {
        note_if_no_level(info, level, &source.name(), ui);
    }
    let decoded = decoder.preview_with_attributes().ok_or(DecodeError::NoMesh);
    let (mesh, attributes) = decoded.with_context(|| source.name())?;
    in_place(mesh, attributes).with_context(|| source.name())
}

fn camera(mesh: &TriMesh, picture: &Picture) -> Camera {
    let [width, height] = picture.size;
    Camera::fit(mesh, picture.view, picture.up, width, height)
}

fn picture_with(mesh: &TriMesh, paint: Paint, picture: &Picture, part: Part) -> Result<Image, RenderError> {
    part.set(0.0);
    let progress = |done: f64| part.set(done);
    render_with_progress(mesh, paint, &camera(mesh, picture), &picture.style(), &progress)
}

/// `mesh` coloured by `values`, one per vertex, with a legend.
///
/// # Errors
/// If the picture is too large.
pub fn heat_picture(
    mesh: &TriMesh,
    values: &[f64],
    title: &str,
    heat: &HeatArgs,
    picture: &Picture,
    part: Part,
) -> Result<Image, RenderError> {
    let heat = Heat::new(values, heat.clip);
    let image = picture_with(mesh, Paint::Values(&heat.values), picture, part)?;
    with_legend(&image, title, &heat, picture.background)
}
