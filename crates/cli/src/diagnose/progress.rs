//! A progress bar on standard error, for a user at a terminal, and what each stage took.

use bulge_inference::Progress;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{IsTerminal, stderr, stdout};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::text::table;

/// Steps of the bar.
const STEPS: u32 = 1000;

/// A stage of the work, when it began, and how many fits there had been.
#[derive(Debug, Clone)]
struct Stage {
    what: String,
    begun: Instant,
    fits: usize,
}

/// The progress bar, which is removed when this value is dropped, and the stages so far.
pub(crate) struct Bar {
    shown: ProgressBar,
    stages: Arc<Mutex<Vec<Stage>>>,
}

impl Bar {
    /// A bar if standard error is a terminal; none if JSON is written to something other than a terminal.
    pub(crate) fn new(json: bool) -> Self {
        let first = Stage { what: "the base".to_owned(), begun: Instant::now(), fits: 0 };
        let stages = Arc::new(Mutex::new(vec![first.clone()]));
        if !stderr().is_terminal() || (json && !stdout().is_terminal()) {
            return Self { shown: ProgressBar::hidden(), stages };
        }
        let shown = ProgressBar::with_draw_target(Some(u64::from(STEPS)), ProgressDrawTarget::stderr());
        if let Ok(style) = ProgressStyle::with_template("  {spinner} [{bar:30}] {percent:>3} %  {msg}") {
            shown.set_style(style.progress_chars("=> "));
        }
        shown.set_message(first.what);
        shown.enable_steady_tick(Duration::from_millis(120));
        Self { shown, stages }
    }

    /// The callbacks that move the bar and count.
    pub(crate) fn progress(&self) -> Progress {
        let (bar, stages, fits) =
            (self.shown.clone(), Arc::clone(&self.stages), Arc::new(AtomicUsize::new(0)));
        let counted = Arc::clone(&fits);
        let told = move |share: f64, what: &str| {
            bar.set_position(position(share));
            bar.set_message(what.to_owned());
            let stage =
                Stage { what: what.to_owned(), begun: Instant::now(), fits: counted.load(Ordering::Relaxed) };
            stages.lock().unwrap_or_else(PoisonError::into_inner).push(stage);
        };
        Progress::to(told).beating(move || {
            fits.fetch_add(1, Ordering::Relaxed);
        })
    }

    /// What each stage took, as a table.
    pub(crate) fn profile(&self) -> String {
        profile(&self.stages.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.shown.finish_and_clear();
    }
}

/// Time and fits of each stage but the last, which ends the others.
fn profile(stages: &[Stage]) -> String {
    let took = |from: &Stage, to: &Stage| (to.begun - from.begun).as_secs_f64();
    let [Some(first), Some(last)] = [stages.first(), stages.last()] else { return String::new() };
    let whole = took(first, last);
    let mut rows = vec![["stage", "s", "%", "fits"].map(str::to_owned).to_vec()];
    let mut add = |what: &str, seconds: f64, fits: usize| {
        let share = 100.0 * seconds / whole.max(f64::MIN_POSITIVE);
        rows.push(vec![what.to_owned(), format!("{seconds:.2}"), format!("{share:.0}"), fits.to_string()]);
    };
    for pair in stages.windows(2) {
        add(&pair[0].what, took(&pair[0], &pair[1]), pair[1].fits - pair[0].fits);
    }
    add("all", whole, last.fits - first.fits);
    format!("\n{}", table(&rows))
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
    fn stages_take_the_time_until_the_next_one() {
        let begun = Instant::now();
        let at = |what: &str, after: u64, fits: usize| Stage {
            what: what.to_owned(),
            begun: begun + Duration::from_millis(after),
            fits,
        };
        let text = profile(&[at("the base", 0, 0), at("the noise", 500, 3), at("done", 2000, 3)]);
        let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split_whitespace().collect()).collect();
        let has = |row: &[&str]| rows.iter().any(|found| found == row);
        assert!(
            has(&["the", "base", "0.50", "25", "3"]) && has(&["the", "noise", "1.50", "75", "0"]),
            "{text}"
        );
        assert!(has(&["all", "2.00", "100", "3"]) && !text.contains("done"), "{text}");
    }

    #[test]
    fn a_share_is_a_step_of_the_bar() {
        assert_eq!([-1.0, 0.0, 0.25, 1.0, 7.0, f64::NAN].map(position), [0, 0, 250, 1000, 1000, 0]);
    }
}
