//! `lwc completions`: what a shell needs to complete the arguments of the program.

use super::output::Destination;
use clap::Command;
use clap_complete::Shell;

/// Print a script that completes commands and options in a shell.
///
/// Save the script where the shell looks for completions, or load it in the shell's startup file.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  lwc completions bash > ~/.local/share/bash-completion/completions/lwc
  lwc completions zsh > ~/.zfunc/_lwc     # ~/.zfunc must be in $fpath
  lwc completions fish > ~/.config/fish/completions/lwc.fish")]
pub struct Completions {
    /// Shell that will run the script.
    #[arg(value_name = "SHELL")]
    pub shell: Shell,
}

/// Writes the script to standard output.
pub fn run(args: &Completions, mut program: Command) -> anyhow::Result<()> {
    // The generator panics if it cannot write, which it always can to memory.
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut program, "lwc", &mut script);
    Destination::Stdout.write(|out| out.write_all(&script))
}
