//! What is said on standard error, and how far long work has come.

use super::args::Global;
use clap::builder::styling::{AnsiColor, Style};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{self, IsTerminal, Write};

/// How much to say.
#[derive(Clone, Copy, Debug)]
pub struct Ui {
    quiet: bool,
    verbose: bool,
    is_terminal: bool,
    colour: bool,
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
        let style =
            if self.colour { Style::new().bold().fg_color(Some(colour.into())) } else { Style::new() };
        // If standard error is closed there is nowhere to complain.
        let _ = writeln!(io::stderr(), "{style}{label}{style:#}{text}");
    }

    /// A bar from 0 to 1, visible on a terminal only.
    pub fn bar(&self, stage: &'static str) -> Bar {
        let style = ProgressStyle::with_template("{msg:>10} [{bar:32}] {percent:>3} %  {elapsed}");
        self.visible_bar(stage, style.unwrap_or_else(|_| ProgressStyle::default_bar()))
    }

    /// As [`Ui::bar`], with an estimate of the time left.
    pub fn bar_with_time_left(&self, stage: &'static str) -> Bar {
        let template = "{msg:>10} [{bar:32}] {percent:>3} %  {elapsed}, {eta} left";
        let style = ProgressStyle::with_template(template);
        self.visible_bar(stage, style.unwrap_or_else(|_| ProgressStyle::default_bar()))
    }

    /// For work that does not say how far it is.
    pub fn spinner(&self, stage: &'static str) -> Bar {
        let bar = self.visible_bar(stage, ProgressStyle::default_spinner());
        if !bar.0.is_hidden() {
            bar.0.enable_steady_tick(std::time::Duration::from_millis(100));
        }
        bar
    }

    fn visible_bar(&self, stage: &'static str, style: ProgressStyle) -> Bar {
        let shown = self.is_terminal && !self.quiet;
        let target = if shown { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        Bar(ProgressBar::with_draw_target(Some(FULL), target).with_style(style).with_message(stage))
    }
}

/// Units that a full bar has.
const FULL: u64 = 1000;

/// A bar that disappears when it is dropped.
pub struct Bar(ProgressBar);

impl Bar {
    pub fn set(&self, fraction: f64) {
        // Far fewer calls than positions reach the terminal, indicatif sees to that.
        self.0.set_position((fraction.clamp(0.0, 1.0) * FULL as f64) as u64);
    }

    /// Takes the bar away while `write` writes.
    pub fn suspend<T>(&self, write: impl FnOnce() -> T) -> T {
        self.0.suspend(write)
    }

    pub fn set_stage(&self, stage: &'static str, fraction: f64) {
        if self.0.message() != stage {
            self.0.set_message(stage);
        }
        self.set(fraction);
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
