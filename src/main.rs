//! The `lwc` program.

mod cli;

use clap::{CommandFactory, Parser};
use cli::program::{Args, Command};
use cli::ui::Ui;
use std::process::ExitCode;

fn main() -> ExitCode {
    let args = Args::parse();
    let ui = Ui::new(&args.global);
    match cli::signals::watch().and_then(|()| dispatch(&args, &ui)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => cli::exit::report(&error, &ui),
    }
}

fn dispatch(args: &Args, ui: &Ui) -> anyhow::Result<()> {
    if args.global.threads > 0 {
        rayon::ThreadPoolBuilder::new().num_threads(args.global.threads as usize).build_global()?;
    }
    match &args.command {
        Command::Encode(args) => cli::encode::run(args, ui),
        Command::Decode(args) => cli::decode::run(args, ui),
        Command::Info(args) => cli::info::run(args, ui),
        Command::Describe(args) => cli::describe::run(args, ui),
        Command::Compare(args) => cli::compare::run(args, ui),
        Command::Experiment(args) => cli::experiment::run(args, ui),
        Command::Render(args) => cli::render::run(args, ui),
        Command::Filter(args) => cli::filter::run(args, ui),
        Command::Edit(args) => cli::edit::run(args, ui),
        Command::View(args) => cli::view::run(args, ui),
        Command::Completions(args) => cli::completions::run(args, Args::command()),
        Command::Man(args) => cli::man::run(args, Args::command(), ui),
    }
}
