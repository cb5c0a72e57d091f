//! Work that tests count, whatever search it belongs to: local quantities of a net, integrands of a quadrature,
//! pairs of elliptic integrals.

use std::cell::Cell;

thread_local! {
    static DONE: Cell<u64> = const { Cell::new(0) };
}

/// Counts one evaluation on this thread.
pub(crate) fn count() {
    DONE.with(|done| done.set(done.get() + 1));
}

/// An answer, and the evaluations that it took on this thread.
pub(crate) fn of<T>(answer: impl FnOnce() -> T) -> (T, u64) {
    let before = DONE.with(Cell::get);
    let found = answer();
    (found, DONE.with(Cell::get) - before)
}
