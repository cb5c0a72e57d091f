//! A cache of recent results.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A cache with least-recently-used eviction, so that memory doesn't grow with the number of questions.
///
/// Two threads that ask for the same key at the same time both compute it: if a thread of a pool waited for
/// another one, it could end up waiting for itself.
pub(crate) struct Recent<T> {
    most: usize,
    kept: Mutex<Kept<T>>,
}

struct Kept<T> {
    /// Each entry with the number of the last question that asked for it.
    entries: HashMap<Vec<String>, (u64, Arc<T>)>,
    asked: u64,
}

impl<T> Recent<T> {
    /// A cache with at most `most` entries, and at least one.
    pub(crate) fn new(most: usize) -> Self {
        Self { most: most.max(1), kept: Mutex::new(Kept { entries: HashMap::new(), asked: 0 }) }
    }

    fn locked(&self) -> MutexGuard<'_, Kept<T>> {
        // Entries are complete even if a thread panicked.
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The entry under a key; otherwise the result of `compute`, which is kept.
    pub(crate) fn of<E>(&self, key: &[String], compute: impl FnOnce() -> Result<T, E>) -> Result<Arc<T>, E> {
        if let Some(found) = self.get(key) {
            return Ok(found);
        }
        let found = Arc::new(compute()?);
        self.keep(key, &found);
        Ok(found)
    }

    fn get(&self, key: &[String]) -> Option<Arc<T>> {
        let mut kept = self.locked();
        kept.asked += 1;
        let asked = kept.asked;
        let (last, found) = kept.entries.get_mut(key)?;
        *last = asked;
        Some(Arc::clone(found))
    }

    fn keep(&self, key: &[String], found: &Arc<T>) {
        let mut kept = self.locked();
        kept.asked += 1;
        let asked = kept.asked;
        kept.entries.insert(key.to_vec(), (asked, Arc::clone(found)));
        if kept.entries.len() > self.most {
            let oldest = kept.entries.iter().min_by_key(|(_, (last, _))| *last).map(|(key, _)| key.clone());
            oldest.map(|key| kept.entries.remove(&key));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;
    use std::convert::Infallible;

    #[test]
    fn what_was_asked_for_the_longest_time_ago_goes_first() {
        let made = Cell::new(0);
        let recent = Recent::new(2);
        let ask = |name: &str| {
            let Ok(found) =
                recent.of(&[name.to_owned()], || Ok::<_, Infallible>(made.replace(made.get() + 1)));
            *found
        };
        assert_eq!(["first", "second", "first", "third"].map(ask), [0, 1, 0, 2]);
        // The second one was evicted.
        assert_eq!(["first", "third", "second"].map(ask), [0, 2, 3]);
        assert_eq!(["second", "first"].map(ask), [3, 4]);
    }

    #[test]
    fn what_fails_is_computed_by_the_next_who_asks() {
        let recent = Recent::new(9);
        let key = ["a".to_owned()];
        assert_eq!(recent.of(&key, || Err::<i32, _>("no")), Err("no"));
        assert_eq!(recent.of(&key, || Ok::<_, Infallible>(3)).as_deref(), Ok(&3));
    }
}
