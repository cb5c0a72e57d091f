//! What one evaluation leaves to the next: where its searches for equilibria ended, and which rows count.
//!
//! A fit asks for nearly the same equilibria thousands of times. Each row and each node of the lattice has a slot with its last equilibrium,
//! from which the next search starts along the derivatives. A slot is read and written by its own row or node only, but for an empty one,
//! which may be filled from the row before in the same segment: so results don't depend on the number of threads. And a search that
//! doesn't get anywhere from there begins anew, so they depend on the slots no further than the accuracy of the solver.

use bulge_fibre::Start;
use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Memory of the equilibria between the evaluations of one fit, for [`crate::Model::evaluate_warm`].
///
/// One for each fit: it belongs to one record and one kind of model. Evaluations that share it run one after the other; of two at the same time one
/// would find nothing remembered.
#[derive(Debug, Default)]
pub struct Warm {
    counts: Option<Vec<bool>>,
    slots: Mutex<Slots>,
}

/// Slots of the rows, segment by segment, and of the nodes of the lattice by their indices.
#[derive(Debug, Default)]
pub(crate) struct Slots {
    pub(crate) rows: Vec<Vec<Option<Start>>>,
    pub(crate) nodes: HashMap<[i64; 2], Start>,
}

impl Warm {
    /// Nothing remembered, all rows count.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Nothing remembered; only the rows that are marked count. The others have the force 0 in a prediction, and it doesn't matter whether they have
    /// an equilibrium.
    #[must_use]
    pub fn of_rows(counts: &[bool]) -> Self {
        Self { counts: Some(counts.to_vec()), ..Self::default() }
    }

    /// Whether a row counts; those beyond the list do.
    pub(crate) fn counts(&self, row: usize) -> bool {
        self.counts.as_ref().and_then(|counts| counts.get(row)).is_none_or(|counts| *counts)
    }

    /// The slots, to be put back: no lock is held during an evaluation, which waits for other threads.
    pub(crate) fn take(&self) -> Slots {
        std::mem::take(&mut *self.lock())
    }

    pub(crate) fn put(&self, slots: Slots) {
        *self.lock() = slots;
    }

    fn lock(&self) -> MutexGuard<'_, Slots> {
        // A thread that panicked leaves old starts at worst.
        self.slots.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Slots {
    /// One slot for each row of each segment, kept if there are as many as before.
    pub(crate) fn fit(&mut self, lengths: impl Iterator<Item = usize>) {
        let lengths: Vec<usize> = lengths.collect();
        if !self.rows.iter().map(Vec::len).eq(lengths.iter().copied()) {
            self.rows = lengths.into_iter().map(|length| vec![None; length]).collect();
        }
    }
}
