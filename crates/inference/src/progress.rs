//! Progress of a long computation, reported to a callback.

use std::fmt;
use std::sync::Arc;

/// Called with the fraction that is done, 0 to 1, and what is going on.
type Told = Arc<dyn Fn(f64, &str) + Send + Sync>;

/// Called often, from several threads.
type Beat = Arc<dyn Fn() + Send + Sync>;

/// Callbacks for the progress of a computation; none by default.
#[derive(Clone, Default)]
pub struct Progress {
    told: Option<Told>,
    beat: Option<Beat>,
}

/// No callbacks.
pub(crate) static NOBODY: Progress = Progress { told: None, beat: None };

impl Progress {
    /// Reports the fraction that is done, 0 to 1, and what is going on to a function.
    pub fn to(told: impl Fn(f64, &str) + Send + Sync + 'static) -> Self {
        Self { told: Some(Arc::new(told)), beat: None }
    }

    /// Also calls a function before each of the many fits that the work consists of, from several threads. A
    /// caller who has given up may unwind the computation from there.
    #[must_use]
    pub fn beating(self, beat: impl Fn() + Send + Sync + 'static) -> Self {
        Self { beat: Some(Arc::new(beat)), ..self }
    }

    /// Signals that one more fit begins.
    pub(crate) fn beat(&self) {
        if let Some(beat) = &self.beat {
            beat();
        }
    }

    /// Reports the fraction that is done.
    pub(crate) fn at(&self, share: f64, what: &str) {
        if let Some(told) = &self.told {
            told(share, what);
        }
    }
}

impl fmt::Debug for Progress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.told.is_some() { "Progress(..)" } else { "Progress(nobody)" })
    }
}
