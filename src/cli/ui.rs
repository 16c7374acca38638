//! What is said on standard error.

use super::args::Global;
use super::bar::Bar;
use super::screen::Screen;
use clap::builder::styling::{AnsiColor, Style};
use std::io::{self, IsTerminal, Write};

/// How much to say.
#[derive(Clone, Debug)]
pub struct Ui {
    quiet: bool,
    verbose: bool,
    is_terminal: bool,
    colour: bool,
    screen: Screen,
}

impl Ui {
    pub fn new(global: &Global) -> Self {
        let is_terminal = io::stderr().is_terminal();
        let no_colour = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
        Self {
            quiet: global.quiet,
            verbose: global.verbose > 0,
            is_terminal,
            colour: is_terminal && !no_colour,
            screen: Screen::default(),
        }
    }

    /// Whether to leave out summaries.
    pub fn is_quiet(&self) -> bool {
        self.quiet
    }

    /// Whether details are wanted.
    pub fn is_verbose(&self) -> bool {
        self.verbose
    }

    /// What was done, unless nobody wants to know.
    pub fn say(&self, sentence: &str) {
        if !self.quiet {
            self.line("", AnsiColor::White, sentence);
        }
    }

    pub fn error(&self, sentence: &str) {
        self.line("lwc: ", AnsiColor::Red, sentence);
    }

    /// Something was dropped, repaired or missing.
    pub fn warn(&self, file: &str, what: &str) {
        if !self.quiet {
            self.line("lwc: warning: ", AnsiColor::Yellow, &format!("{file}: {what}"));
        }
    }

    /// Something worth knowing.
    pub fn note(&self, file: &str, what: &str) {
        if !self.quiet {
            self.line("lwc: note: ", AnsiColor::Cyan, &format!("{file}: {what}"));
        }
    }

    /// Something that only the curious want to know.
    pub fn detail(&self, file: &str, what: &str) {
        if self.verbose {
            self.line("lwc: ", AnsiColor::Cyan, &format!("{file}: {what}"));
        }
    }

    fn line(&self, label: &str, colour: AnsiColor, text: &str) {
        let is_coloured = self.colour && !label.is_empty();
        let style =
            if is_coloured { Style::new().bold().fg_color(Some(colour.into())) } else { Style::new() };
        // If standard error is closed there is nowhere to complain.
        let text = printable(text);
        let _ = self.screen.beside(|| writeln!(io::stderr(), "{style}{label}{style:#}{text}"));
    }

    /// The bar of the command, visible on a terminal only.
    pub fn bar(&self) -> Bar {
        Bar::new(&self.screen, self.is_terminal && !self.quiet)
    }

    /// Writes to standard output, which may be the terminal of the bar.
    pub fn beside_bar<T>(&self, write: impl FnOnce() -> T) -> T {
        self.screen.beside(write)
    }
}

/// A text as a terminal may have it: names out of files and streams may hold control characters, and such as change the
/// direction of a text.
pub fn printable(text: &str) -> String {
    let is_hidden = |c: char| {
        c != '\n' && c.is_control()
            || matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
    };
    text.replace(is_hidden, "\u{fffd}")
}

#[cfg(test)]
mod tests {
    use super::printable;

    #[test]
    fn names_cannot_reach_for_the_terminal() {
        assert_eq!(printable("a\u{1b}[31mb\u{202e}c\u{9b}d\ne"), "a\u{fffd}[31mb\u{fffd}c\u{fffd}d\ne");
    }
}
