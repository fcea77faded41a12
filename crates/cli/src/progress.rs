//! Progress on stderr, for people only: nothing is drawn when stderr is not a terminal.

use std::time::{Duration, Instant};

use indicatif::{HumanCount, ProgressBar, ProgressStyle};

/// Points of a stage so far.
pub struct Points {
    begun: Instant,
    points: u64,
}

impl Points {
    fn told(&self) -> String {
        let seconds = self.begun.elapsed().as_secs_f64().max(1e-3);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a rate that people read"
        )]
        let rate = (self.points as f64 / seconds) as u64;
        format!("{} points, {} a second, ", HumanCount(self.points), HumanCount(rate))
    }
}

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

    /// Begins a stage in which files of so many bytes are read, in place of the one before.
    pub fn begin_points(&mut self, what: &'static str, bytes: u64) -> Points {
        let template = "{prefix:12} {wide_bar} {percent:>3}%, {msg}{eta} left";
        self.replace(ProgressBar::new(bytes), template, "");
        self.bar.set_prefix(what);
        Points { begun: Instant::now(), points: 0 }
    }

    /// More points were read, and of the files as many bytes as are told.
    pub fn advance_points(&self, stage: &mut Points, points: usize, bytes: u64) {
        stage.points += points as u64;
        self.bar.set_message(stage.told());
        self.bar.set_position(bytes);
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
