//! `lwc render`: pictures of meshes and streams.

pub mod args;
mod montage;

use super::bar::{Bar, Part, Vertices};
use super::exit::Failure;
use super::input::{in_place, read_mesh};
use super::input_file::is_stream;
use super::output::{Destination, has_ending, pixels_of, say_written};
use super::stream::{DecodedStream, StreamSource, Wanted, note_if_incomplete};
use super::ui::Ui;
use anyhow::Context;
use args::{AttributeKind, ColorBy, HeatArgs, Picture, Render};
use lwc::descriptors::{evaluate_with_progress, mean_edge_length};
use lwc::io::MeshFile;
use lwc::mesh::Attributes;
use lwc::render::{Camera, CornerPaint, Heat, Image, Paint, RenderError, render, with_legend};
use lwc::{DecodeError, DecodeOptions, TriMesh};

/// Reads, draws, writes.
pub fn run(args: &Render, ui: &Ui) -> anyhow::Result<()> {
    let destination = Destination::new(args.output.clone());
    check_ending(&destination).with_context(|| destination.name())?;
    destination.check(Some(&args.input), false)?;
    let bar = ui.bar();
    let picture = if args.montage { montage::montage(args, &bar)? } else { picture(args, &bar, ui)? };
    destination.write(|out| picture.write_png(out))?;
    drop(bar);
    say_written(&destination, &pixels_of(&picture), ui);
    Ok(())
}

/// One picture.
fn picture(args: &Render, bar: &Bar, ui: &Ui) -> anyhow::Result<Image> {
    let reading = if is_stream(&args.input) { "decoding" } else { "reading" };
    let (descriptor, evaluating) = match args.color_by {
        Some(ColorBy::Descriptor(descriptor)) => (descriptor.name(), 50.0),
        _ => ("drawing", 0.0),
    };
    let [reading, evaluating, drawing] =
        bar.split([(reading, 50.0), (descriptor, evaluating), ("drawing", 20.0)]);
    let MeshFile { mesh, attributes, .. } = read(args, reading, ui)?;
    match args.color_by {
        Some(ColorBy::Descriptor(descriptor)) => {
            let vertices = Vertices::new(mesh.num_vertices(), evaluating);
            let (window, mean_edge) = (args.window.window(), mean_edge_length(&mesh));
            let progress = |more: usize| vertices.add(more);
            let values = evaluate_with_progress(descriptor, &mesh, &window, mean_edge, &progress);
            drawing.set(0.0);
            Ok(heat_picture(&mesh, &values, descriptor.name(), &args.heat, &args.picture)?)
        }
        Some(ColorBy::Attribute(kind)) => {
            let paint = paint(&mesh, &attributes, kind).with_context(|| args.input.display().to_string())?;
            drawing.set(0.0);
            Ok(picture_with(&mesh, Paint::Corners(&paint), &args.picture)?)
        }
        None => {
            drawing.set(0.0);
            Ok(plain_picture(&mesh, &args.picture)?)
        }
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
    let decoded = decoder.preview_with_attributes().ok_or(DecodeError::NoMesh);
    let (mesh, attributes) = decoded.with_context(|| source.name())?;
    in_place(mesh, attributes).with_context(|| source.name())
}

fn camera(mesh: &TriMesh, picture: &Picture) -> Camera {
    let [width, height] = picture.size;
    Camera::fit(mesh, picture.view, picture.up, width, height)
}

/// `mesh` in one colour.
///
/// # Errors
/// If the picture is too large.
pub fn plain_picture(mesh: &TriMesh, picture: &Picture) -> Result<Image, RenderError> {
    picture_with(mesh, Paint::Plain, picture)
}

fn picture_with(mesh: &TriMesh, paint: Paint, picture: &Picture) -> Result<Image, RenderError> {
    render(mesh, paint, &camera(mesh, picture), &picture.style())
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
) -> Result<Image, RenderError> {
    let heat = Heat::new(values, heat.clip);
    let style = picture.style();
    let image = render(mesh, Paint::Values(&heat.values), &camera(mesh, picture), &style)?;
    with_legend(&image, title, &heat, style.background)
}
