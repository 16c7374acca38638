//! `lwc view`: serves a page that refines a stream while it loads.

pub mod args;
mod http;
mod model;

use super::ui::Ui;
use anyhow::Context;
use args::View;
use http::{Answer, Request};
use model::Model;
use std::io::{self, Write};
use std::net::{Ipv4Addr, TcpListener};
use std::process::{Command, Stdio};

const PAGE: &[u8] = include_bytes!("../../../web/viewer/index.html");
const SCRIPT: &[u8] = include_bytes!("../../../web/viewer/embedded/viewer.js");
const WORKER: &[u8] = include_bytes!("../../../web/viewer/embedded/worker.js");
const DECODER: &[u8] = include_bytes!("../../../web/viewer/embedded/lwc.wasm");
const DECODER_OF_ASSETS: &[u8] = include_bytes!("../../../web/viewer/embedded/lwc-assets.wasm");

/// Reads or encodes the model, then serves until the program is stopped.
pub fn run(args: &View, ui: &Ui) -> anyhow::Result<()> {
    let model = Model::open(args, ui)?;
    // This machine only: what is shown is nobody else's business.
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, args.port))
        .with_context(|| format!("cannot listen on port {}", args.port))?;
    let port = listener.local_addr()?.port();
    let url = format!("http://127.0.0.1:{port}/");
    writeln!(io::stdout(), "{url}")?;
    io::stdout().flush()?;
    ui.note(&args.input.display().to_string(), "stop with Ctrl-C");
    if !args.no_open && open(&url).is_err() {
        ui.warn(&url, "no browser could be started, please open it by hand");
    }
    http::serve(&listener, move |request| answer(request, &model, port))
}

/// The whole site: these names and no others, whatever is on the disk.
fn answer(request: &Request, model: &Model, port: u16) -> Answer {
    // Another site could point a name of its own at this address.
    let hosts = [format!("127.0.0.1:{port}"), format!("localhost:{port}")];
    if !request.host.as_ref().is_some_and(|host| hosts.contains(host)) {
        return Answer::status(403);
    }
    if !matches!(request.method.as_str(), "GET" | "HEAD") {
        return Answer::status(405);
    }
    match request.path.as_str() {
        "/" => Answer::asset("text/html; charset=utf-8", PAGE),
        "/viewer.js" => Answer::asset("text/javascript", SCRIPT),
        "/worker.js" => Answer::asset("text/javascript", WORKER),
        "/lwc.wasm" => Answer::asset("application/wasm", DECODER),
        "/lwc-assets.wasm" => Answer::asset("application/wasm", DECODER_OF_ASSETS),
        "/model.lwc" => Answer::ranged("model/vnd.lwc", model.bytes(), request.range.as_deref(), model.tag()),
        "/about.json" => Answer::json(&model.about()),
        "/quality.json" => Answer::json(&model.quality()),
        "/descriptor" => Answer::bytes("application/octet-stream", model.colours().to_vec()),
        _ => Answer::status(404),
    }
}

/// Starts the browser that the system prefers.
fn open(url: &str) -> io::Result<()> {
    let mut command = if cfg!(target_os = "macos") {
        Command::new("open")
    } else if cfg!(windows) {
        let mut command = Command::new("cmd");
        command.args(["/C", "start", ""]);
        command
    } else {
        Command::new("xdg-open")
    };
    command.arg(url).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).spawn().map(drop)
}
