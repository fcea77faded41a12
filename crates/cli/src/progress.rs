//! Progress on stderr, for people only: nothing is drawn when stderr is not a terminal.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

/// One bar or spinner at a time.
pub struct Progress {
    quiet: bool,
    bar: ProgressBar,
}

impl Progress {
    /// No bar yet; never one when `quiet`.
    pub fn new(quiet: bool) -> Self {
        Self { quiet, bar: ProgressBar::hidden() }
    }

    /// Begins a stage of `length` steps, in place of the one before.
    pub fn begin(&mut self, what: &str, length: usize) {
        self.replace(ProgressBar::new(length as u64), "{msg:12} {wide_bar} {pos}/{len} {eta:>4}", what);
    }

    /// Begins a stage of unknown length, in place of the one before.
    pub fn spin(&mut self, what: &str) {
        self.replace(ProgressBar::new_spinner(), "{msg} {spinner} {elapsed}", what);
        self.bar.enable_steady_tick(Duration::from_millis(120));
    }

    /// Some steps are done.
    pub fn advance(&self, steps: usize) {
        self.bar.inc(steps as u64);
    }

    /// What the stage is about now, beside the bar.
    pub fn tell(&self, what: String) {
        self.bar.set_message(what);
    }

    /// A line that stays, above the bar.
    pub fn warn(&self, line: &str) {
        if !self.quiet {
            self.bar.suspend(|| eprintln!("warning: {line}"));
        }
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }

    fn replace(&mut self, bar: ProgressBar, template: &str, what: &str) {
        self.bar.finish_and_clear();
        if self.quiet {
            return;
        }
        self.bar = bar;
        // A template that does not parse would only cost the looks.
        if let Ok(style) = ProgressStyle::with_template(template) {
            self.bar.set_style(style);
        }
        self.bar.set_message(what.to_owned());
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
