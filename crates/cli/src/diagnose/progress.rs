//! A progress bar on standard error, for a user at a terminal.

use bulge_inference::Progress;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{IsTerminal, stderr, stdout};
use std::time::Duration;

/// Steps of the bar.
const STEPS: u32 = 1000;

/// The progress bar; it is removed when this value is dropped.
pub(crate) struct Bar(ProgressBar);

impl Bar {
    /// A bar if standard error is a terminal; none if JSON is written to something other than a terminal.
    pub(crate) fn new(json: bool) -> Self {
        if !stderr().is_terminal() || (json && !stdout().is_terminal()) {
            return Self(ProgressBar::hidden());
        }
        let bar = ProgressBar::with_draw_target(Some(u64::from(STEPS)), ProgressDrawTarget::stderr());
        if let Ok(style) = ProgressStyle::with_template("  {spinner} [{bar:30}] {percent:>3} %  {msg}") {
            bar.set_style(style.progress_chars("=> "));
        }
        bar.set_message("the base");
        bar.enable_steady_tick(Duration::from_millis(120));
        Self(bar)
    }

    /// The callback that moves the bar.
    pub(crate) fn progress(&self) -> Progress {
        let bar = self.0.clone();
        Progress::to(move |share, what| {
            bar.set_position(position(share));
            bar.set_message(what.to_owned());
        })
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

/// Step of a fraction; values outside \[0, 1\] are at the nearer end.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and STEPS")]
fn position(share: f64) -> u64 {
    (f64::from(STEPS) * share.clamp(0.0, 1.0)) as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_is_a_step_of_the_bar() {
        assert_eq!([-1.0, 0.0, 0.25, 1.0, 7.0, f64::NAN].map(position), [0, 0, 250, 1000, 1000, 0]);
    }
}
