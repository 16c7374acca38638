//! The command line: one file per subcommand, on the public API of the library.

pub mod args;
pub mod compare;
pub mod decode;
pub mod describe;
pub mod encode;
pub mod exit;
pub mod info;
mod input;
mod output;
mod passes;
mod quantity;
pub mod ui;
mod verify;
pub mod view;
