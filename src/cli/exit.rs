//! How the program ends: one sentence on standard error, and a number.

use super::ui::Ui;
use lwc::descriptors::FeaturesError;
use lwc::io::{ReadError, WriteError};
use lwc::multiresolution::EditError;
use lwc::{DecodeError, EncodeError};
use std::io;
use std::process::ExitCode;
use thiserror::Error;

/// The numbers, for the help text.
pub const HELP: &str = "\
Exit codes:
  0  success; also if a stream ends early and a coarser mesh was written
  1  any other failure, such as an output that cannot be written
  2  wrong usage: an unknown option, a value out of range
  3  an input that cannot be read, or is not a mesh or stream that can be used
  4  a damaged stream, or one that ends before its base mesh
  5  a limit is exceeded
  6  the verification of an encoded stream failed
  7  something would be lost, and --strict forbids that
  130, 143  stopped by Ctrl-C (SIGINT) or SIGTERM; no unfinished file is left";

const OTHER: u8 = 1;
const USAGE: u8 = 2;
const INPUT: u8 = 3;
const DAMAGED: u8 = 4;
const LIMIT: u8 = 5;
const VERIFICATION: u8 = 6;
const LOSSY: u8 = 7;

/// What goes wrong in the program itself.
#[derive(Debug, Error)]
pub enum Failure {
    /// The arguments contradict each other or the files at hand.
    #[error("{0}")]
    Usage(String),
    /// An input cannot be read.
    #[error("{0}")]
    Input(io::Error),
    /// An input has no bytes.
    #[error("the input is empty")]
    Empty,
    /// The stream ends too early to say anything of itself.
    #[error("the stream ends before its table of passes is complete")]
    CutTable,
    /// The encoded stream is not the mesh.
    #[error("verification failed: {0}")]
    Verification(String),
    /// Something would be lost though nothing may be.
    #[error("--strict, and something would be lost: {0}")]
    Lossy(String),
}

/// Tells what went wrong. Nobody is left to read after a broken pipe: that is success.
pub fn report(error: &anyhow::Error, ui: &Ui) -> ExitCode {
    if error.chain().any(is_broken_pipe) {
        return ExitCode::SUCCESS;
    }
    ui.error(&sentence(error));
    ExitCode::from(code(error))
}

fn code(error: &anyhow::Error) -> u8 {
    let code = |cause: &(dyn std::error::Error + 'static)| {
        None.or(cause.downcast_ref().map(|failure| match failure {
            Failure::Usage(_) => USAGE,
            Failure::Input(_) => INPUT,
            Failure::Empty | Failure::CutTable => DAMAGED,
            Failure::Verification(_) => VERIFICATION,
            Failure::Lossy(_) => LOSSY,
        }))
        .or(cause.downcast_ref().map(|error| match error {
            ReadError::TooLarge { .. } | ReadError::Ratio { .. } => LIMIT,
            _ => INPUT,
        }))
        .or(cause.downcast_ref().map(|error| match error {
            DecodeError::NotAStream | DecodeError::Unsupported(_) => INPUT,
            DecodeError::Limit { .. } => LIMIT,
            _ => DAMAGED,
        }))
        .or(cause.downcast_ref().map(|error| match error {
            EncodeError::Option { .. }
            | EncodeError::StepTooSmall { .. }
            | EncodeError::DescriptorAttributes(_) => USAGE,
            EncodeError::TooLarge(_) => LIMIT,
            _ => INPUT,
        }))
        .or(cause.downcast_ref::<FeaturesError>().map(|_| USAGE))
        .or(cause.downcast_ref().map(|error| match error {
            WriteError::UnknownEnding => USAGE,
            _ => OTHER,
        }))
        .or(cause.downcast_ref().map(|_: &lwc::metrics::CompareError| INPUT))
        .or(cause.downcast_ref().map(|error| match error {
            EditError::Stream(DecodeError::Limit { .. }) => LIMIT,
            EditError::Stream(DecodeError::NotAStream | DecodeError::Unsupported(_)) => INPUT,
            EditError::Stream(_) | EditError::Incomplete => DAMAGED,
            _ => INPUT,
        }))
        .or(cause.downcast_ref().map(|_: &lwc::render::RenderError| USAGE))
    };
    error.chain().find_map(code).unwrap_or(OTHER)
}

fn is_broken_pipe(cause: &(dyn std::error::Error + 'static)) -> bool {
    let io_error = match cause.downcast_ref() {
        Some(WriteError::Io(error)) => Some(error),
        _ => cause.downcast_ref(),
    };
    io_error.is_some_and(|error: &io::Error| error.kind() == io::ErrorKind::BrokenPipe)
}

/// The causes in one line; one that the cause before quotes already is left out.
fn sentence(error: &anyhow::Error) -> String {
    let mut parts: Vec<String> = Vec::new();
    for cause in error.chain().map(ToString::to_string) {
        if !parts.last().is_some_and(|before| before.ends_with(&cause)) {
            parts.push(cause);
        }
    }
    parts.join(": ").replace(char::is_control, " ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use anyhow::anyhow;

    #[test]
    fn causes_are_named_once_and_in_one_line() {
        let cause = ReadError::Zstd(io::Error::other("bad\nmagic"));
        let error = anyhow!(cause).context("a.ply.zst");
        assert_eq!(sentence(&error), "a.ply.zst: cannot decompress: bad magic");
        assert_eq!(code(&error), INPUT);
    }

    #[test]
    fn every_kind_of_failure_has_its_code() {
        let limit = DecodeError::Limit { what: "vertices", needed: 2, allowed: 1 };
        for (error, expected) in [
            (anyhow!("anything"), OTHER),
            (anyhow!(WriteError::Io(io::ErrorKind::PermissionDenied.into())), OTHER),
            (anyhow!(Failure::Usage("u".into())), USAGE),
            (anyhow!(Failure::Input(io::ErrorKind::NotFound.into())), INPUT),
            (anyhow!(EncodeError::NoTriangles), INPUT),
            (anyhow!(DecodeError::NotAStream), INPUT),
            (anyhow!(DecodeError::NoMesh), DAMAGED),
            (anyhow!(limit), LIMIT),
            (anyhow!(ReadError::Ratio { packed: 1, most: 2 }), LIMIT),
            (anyhow!(Failure::Verification("v".into())), VERIFICATION),
            (anyhow!(Failure::Lossy("l".into())), LOSSY),
        ] {
            assert_eq!(code(&error.context("file")), expected);
        }
    }

    #[test]
    fn a_broken_pipe_is_found_wherever_it_hides() {
        let pipe = || io::Error::from(io::ErrorKind::BrokenPipe);
        assert!(anyhow!(pipe()).context("x").chain().any(is_broken_pipe));
        assert!(anyhow!(WriteError::Io(pipe())).context("x").chain().any(is_broken_pipe));
        assert!(!anyhow!(io::Error::other("x")).chain().any(is_broken_pipe));
    }
}
