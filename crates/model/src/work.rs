//! What models were asked for, as tests count the cost of a search.

use std::cell::Cell;

thread_local! {
    static ASKED: Cell<u64> = const { Cell::new(0) };
}

/// Forces and derivatives of forces that models were asked for on this thread so far: what a search costs, on
/// any machine.
#[must_use]
pub fn forces_asked() -> u64 {
    ASKED.with(Cell::get)
}

/// Counts the rows of one evaluation, and as many for each derivative.
pub(crate) fn count(rows: usize, derivatives: usize) {
    let asked = rows as u64 * (1 + derivatives as u64);
    ASKED.with(|all| all.set(all.get().wrapping_add(asked)));
}
