//! `lwc man`: the help texts as manual pages.

use super::output::Destination;
use super::quantity::counted;
use super::ui::Ui;
use anyhow::Context;
use clap::builder::Resettable;
use clap::{Command, ValueHint};
use clap_mangen::Man as Page;
use clap_mangen::roff::{Roff, roman};
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Write the manual pages: lwc.1 and one page per command, such as lwc-encode.1.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  lwc man ~/.local/share/man/man1     # then: man lwc-encode
  lwc man | man -l -                  # read the first page at once")]
pub struct Man {
    /// Folder for the pages, created if it does not exist. Default: lwc.1 alone, to standard output.
    #[arg(value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub folder: Option<PathBuf>,
}

/// Writes all pages into the folder, or the first to standard output.
pub fn run(args: &Man, mut program: Command, ui: &Ui) -> anyhow::Result<()> {
    // Subcommands get their full names and the general options.
    program.build();
    let Some(folder) = args.folder.as_deref().filter(|folder| *folder != Path::new("-")) else {
        return Destination::Stdout.write(|out| write_page(out, &program));
    };
    if folder.exists() && !folder.is_dir() {
        anyhow::bail!("{}: it is not a folder", folder.display());
    }
    fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    let mut num_pages = 0;
    for command in
        std::iter::once(&program).chain(program.get_subcommands().filter(|c| c.get_name() != "help"))
    {
        let path = folder.join(Page::new(command.clone()).get_filename());
        Destination::File(path).write(|out| write_page(out, command))?;
        num_pages += 1;
    }
    let pages = counted(num_pages, "manual page", "manual pages");
    ui.say(&format!("{}: {pages}", folder.display()));
    Ok(())
}

fn write_page(out: &mut dyn Write, command: &Command) -> io::Result<()> {
    let usage = command.clone().render_usage().to_string();
    let command_of_page = command
        .clone()
        .mut_args(with_broken_lists)
        .override_usage(usage.trim_start_matches("Usage: ").to_owned())
        .subcommand_help_heading("COMMANDS")
        .after_help(Resettable::Reset);
    let page = Page::new(command_of_page).source(concat!("lwc ", env!("CARGO_PKG_VERSION")));
    // An empty date would be left out, and what follows take its place.
    page.date(" ").manual("User Commands").render(out)?;
    write_last_section(out, command)
}

/// The text at the end of the help under its own heading, which is its first line.
fn write_last_section(out: &mut dyn Write, command: &Command) -> io::Result<()> {
    let text = command.get_after_help().map(ToString::to_string).unwrap_or_default();
    let Some((heading, lines)) = text.split_once(":\n") else { return Ok(()) };
    let mut roff = Roff::default();
    roff.control("SH", [heading.to_uppercase().as_str()]);
    roff.control("nf", []);
    roff.text([roman(lines)]);
    roff.control("fi", []);
    out.write_all(roff.to_roff().as_bytes())
}

/// Indents the entries of lists: lines that begin with a space are not joined.
fn with_broken_lists(arg: clap::Arg) -> clap::Arg {
    match arg.get_long_help().map(ToString::to_string) {
        Some(help) if help.contains("\n- ") => arg.long_help(help.replace("\n- ", "\n  - ")),
        _ => arg,
    }
}
