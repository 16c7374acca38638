//! What may be typed: one command, with what it has and what all have.

use super::args::Global;
use clap::{Parser, Subcommand};

/// Progressive codec for triangle meshes: one small file that can be cut anywhere.
#[derive(Debug, Parser)]
#[command(name = "lwc", version, after_help = super::exit::HELP)]
pub struct Args {
    #[command(flatten)]
    pub global: Global,
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    Encode(Box<super::encode::args::Encode>),
    Decode(super::decode::Decode),
    Info(super::info::Info),
    Describe(super::describe::Describe),
    Compare(super::compare::Compare),
    Experiment(super::experiment::args::Experiment),
    Render(super::render::args::Render),
    Filter(super::filter::Filter),
    Edit(super::edit::Edit),
    View(super::view::args::View),
    Completions(super::completions::Completions),
    Man(super::man::Man),
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;
    use lwc::{EncodeOptions, Limits};

    #[test]
    fn options_do_not_clash() {
        Args::command().debug_assert();
    }

    #[test]
    fn defaults_are_those_of_the_library() {
        let args = Args::try_parse_from(["lwc", "encode", "x.ply"]).unwrap();
        let Command::Encode(encode) = args.command else { panic!("not encode") };
        assert_eq!(encode.options(lwc::GridChoice::Auto), EncodeOptions::default());
        let args = Args::try_parse_from(["lwc", "decode", "x.lwc"]).unwrap();
        let Command::Decode(decode) = args.command else { panic!("not decode") };
        assert_eq!(decode.limits.limits(), Limits::default());
    }
}
