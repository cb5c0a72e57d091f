//! How far a long computation is: told to whoever asked.

use std::fmt;
use std::sync::Arc;

/// Called with the share that is done, 0 to 1, and what is going on.
type Told = Arc<dyn Fn(f64, &str) + Send + Sync>;

/// Who is told how far it is; nobody by default.
#[derive(Clone, Default)]
pub struct Progress(Option<Told>);

impl Progress {
    /// Tells a function the share that is done, 0 to 1, and what is going on.
    pub fn to(told: impl Fn(f64, &str) + Send + Sync + 'static) -> Self {
        Self(Some(Arc::new(told)))
    }

    /// Tells.
    pub(crate) fn at(&self, share: f64, what: &str) {
        if let Some(told) = &self.0 {
            told(share, what);
        }
    }
}

impl fmt::Debug for Progress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.0.is_some() { "Progress(..)" } else { "Progress(nobody)" })
    }
}
