//! How far a command has come: one bar for all of it, which only goes forward.

use super::screen::Screen;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use std::fmt::Write;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// Units that a full bar has.
const FULL: f64 = 10_000.0;

/// Time between two looks at the clock.
const TICK: Duration = Duration::from_millis(200);

/// A bar that disappears when it is dropped.
pub struct Bar {
    drawn: ProgressBar,
    screen: Screen,
    /// Share of the whole command, 0 to 1.
    done: Mutex<f64>,
}

impl Bar {
    /// Visible if `is_shown`; `screen` is where else something may be written.
    pub fn new(screen: &Screen, is_shown: bool) -> Self {
        let target = if is_shown { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let drawn = ProgressBar::with_draw_target(Some(FULL as u64), target)
            .with_style(style())
            .with_message("starting");
        if is_shown {
            drawn.enable_steady_tick(TICK);
            screen.show(&drawn);
        }
        Self { drawn, screen: screen.clone(), done: Mutex::new(0.0) }
    }

    /// The parts of a command that come one after the other, with their shares of the time it takes, whose unit does not
    /// matter.
    pub fn split<const N: usize>(&self, shares: [(&'static str, f64); N]) -> [Part<'_>; N] {
        let parts = Part { bar: self, stage: "", begin: 0.0, length: 1.0 }.split(shares);
        parts.iter().take(1).for_each(|first| first.set(0.0));
        parts
    }

    /// Takes it away for good: the result goes to standard output, which may be the same terminal.
    pub fn hide(&self) {
        self.drawn.finish_and_clear();
        self.screen.clear();
    }

    /// Goes to a share of the whole, unless it is further already.
    fn go_to(&self, stage: &'static str, share: f64) {
        let mut done = self.done.lock().unwrap_or_else(PoisonError::into_inner);
        if share >= *done {
            *done = share;
            if self.drawn.message() != stage {
                self.drawn.set_message(stage);
            }
            // Far fewer calls than positions reach the terminal, indicatif sees to that.
            self.drawn.set_position((share * FULL) as u64);
        }
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.hide();
    }
}

/// A part of a command, which has its share of the bar.
#[derive(Clone, Copy)]
pub struct Part<'a> {
    bar: &'a Bar,
    stage: &'static str,
    begin: f64,
    length: f64,
}

impl<'a> Part<'a> {
    /// Its name.
    pub fn stage(&self) -> &'static str {
        self.stage
    }

    /// Which share of the part is done, 0 to 1.
    pub fn set(&self, fraction: f64) {
        self.set_stage(self.stage, fraction);
    }

    /// The same under another name.
    pub fn set_stage(&self, stage: &'static str, fraction: f64) {
        // What is not a number is no progress.
        let fraction = if fraction > 0.0 { fraction.min(1.0) } else { 0.0 };
        self.bar.go_to(stage, (self.begin + self.length * fraction).min(1.0));
    }

    /// Parts of this part, see [`Bar::split`].
    pub fn split<const N: usize>(&self, shares: [(&'static str, f64); N]) -> [Part<'a>; N] {
        let total: f64 = shares.iter().map(|(_, share)| share).sum();
        let mut before = 0.0;
        shares.map(|(stage, share)| {
            let begin = self.begin + self.length * before / total;
            before += share;
            Part { bar: self.bar, stage, begin, length: self.length * share / total }
        })
    }

    /// From one share of this part to another.
    pub fn between(&self, begin: f64, end: f64) -> Self {
        Self { begin: self.begin + self.length * begin, length: self.length * (end - begin), ..*self }
    }
}

/// Vertices that are done on any thread, as a share of all.
pub struct Vertices<'a> {
    done: AtomicUsize,
    total: usize,
    part: Part<'a>,
}

impl<'a> Vertices<'a> {
    pub fn new(total: usize, part: Part<'a>) -> Self {
        Self { done: AtomicUsize::new(0), total, part }
    }

    /// So many more are done.
    pub fn add(&self, more: usize) {
        let done = self.done.fetch_add(more, Ordering::Relaxed) + more;
        self.part.set(done as f64 / self.total.max(1) as f64);
    }
}

fn style() -> ProgressStyle {
    let template = "{msg:>11} [{bar:32}] {percent:>3} %  {time}";
    let style = ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
    style.with_key("time", |state: &ProgressState, out: &mut dyn Write| {
        // It writes to memory.
        let _ = out.write_str(&time(state.elapsed(), f64::from(state.fraction())));
    })
}

/// The time since the beginning, and what may be left of it if it goes on like this.
fn time(elapsed: Duration, fraction: f64) -> String {
    let seconds = elapsed.as_secs_f64();
    let is_known = seconds >= 1.0 && fraction >= 0.02;
    let left = seconds * (1.0 - fraction) / fraction;
    if is_known { format!("{}, {} left", clock(seconds), clock(left.ceil())) } else { clock(seconds) }
}

/// `7 s`, `1:05 min`, `2:00:05 h`.
fn clock(seconds: f64) -> String {
    let all = seconds as u64;
    let (hours, minutes, seconds) = (all / 3600, all / 60 % 60, all % 60);
    match (hours, minutes) {
        (0, 0) => format!("{seconds} s"),
        (0, _) => format!("{minutes}:{seconds:02} min"),
        _ => format!("{hours}:{minutes:02}:{seconds:02} h"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hidden() -> Bar {
        Bar::new(&Screen::default(), false)
    }

    #[test]
    fn the_bar_never_goes_back_whatever_the_stages_report() {
        let bar = hidden();
        let [reading, encoding, verifying] =
            bar.split([("reading", 1.0), ("encoding", 8.0), ("verifying", 1.0)]);
        let parts = [reading, encoding.between(0.0, 0.5), encoding.between(0.5, 1.0), verifying];
        let reports = [0.0, 0.6, 0.2, 1.0, f64::NAN, -3.0, 0.1, f64::INFINITY, 0.5];
        let mut before = 0;
        for i in 0..200_usize {
            // Every stage again and again, the early ones after the late ones too.
            parts[i * i % 7 % 4].set(reports[i * 5 % 9] * (i as f64 / 200.0));
            let now = bar.drawn.position();
            assert!((before..=10_000).contains(&now), "{before} to {now}");
            before = now;
        }
        verifying.set(1.0);
        assert_eq!(bar.drawn.position(), 10_000);
    }

    #[test]
    fn stages_have_their_shares() {
        let bar = hidden();
        let [reading, encoding, verifying] =
            bar.split([("reading", 1.0), ("encoding", 4.0), ("verifying", 0.0)]);
        let at = |part: Part, fraction| {
            part.set(fraction);
            (bar.drawn.message(), bar.drawn.position())
        };
        assert_eq!(at(reading, 0.5), ("reading".to_owned(), 1000));
        assert_eq!(at(encoding.between(0.5, 1.0), 0.0), ("encoding".to_owned(), 6000));
        assert_eq!(at(reading, 1.0), ("encoding".to_owned(), 6000));
        assert_eq!(at(encoding, 1.0), ("encoding".to_owned(), 10_000));
        assert_eq!(at(verifying, 0.5), ("verifying".to_owned(), 10_000));
    }

    #[test]
    fn the_time_left_follows_from_the_share_done() {
        let time = |seconds: f64, fraction| time(Duration::from_secs_f64(seconds), fraction);
        assert_eq!(time(0.5, 0.5), "0 s");
        assert_eq!(time(9.0, 0.0), "9 s");
        assert_eq!(time(9.5, 0.25), "9 s, 29 s left");
        assert_eq!(time(65.0, 0.02), "1:05 min, 53:05 min left");
        assert_eq!(time(7265.0, 1.0), "2:01:05 h, 0 s left");
    }
}
