//! The command line: one file per subcommand, on the public API of the library.

pub mod args;
pub mod compare;
pub mod completions;
pub mod decode;
pub mod describe;
pub mod edit;
pub mod encode;
pub mod exit;
pub mod experiment;
pub mod filter;
mod gain;
pub mod info;
mod input;
pub mod man;
mod output;
mod passes;
pub mod program;
mod quantity;
mod rate_distortion;
pub mod render;
pub mod signals;
pub mod ui;
mod verify;
pub mod view;
