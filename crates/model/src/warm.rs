//! What one evaluation leaves to the next: where its searches for equilibria ended, and which rows count.
//!
//! A fit asks for nearly the same equilibria thousands of times. Each row and each node of the lattice has a slot with its last equilibrium,
//! from which the next search starts along the derivatives. A slot is read and written by its own row or node only, but for an empty one,
//! which may be filled from the row before in the same segment: so results don't depend on the number of threads. And a search that
//! doesn't get anywhere from there begins anew, so they depend on the slots no further than the accuracy of the solver.

use bulge_fibre::{Parts, Start};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::lattice::{Lattice, Span};
use crate::solved::Starts;

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
    /// Of each of the model's muscles.
    pub(crate) nodes: Vec<Starts>,
    /// Whether the next lattice that is solved is held.
    pub(crate) holds: bool,
    pub(crate) held: Vec<Option<Arc<Held>>>,
    /// Searches of the last evaluation for rows that its lattice doesn't reach, for each of the model's muscles.
    pub(crate) alone: Vec<usize>,
    /// Whether what is held comes from another model: it then serves for the same muscle only.
    is_shared: bool,
}

/// A solved lattice from which those of neighbouring shapes are found by its derivatives.
#[derive(Debug)]
pub(crate) struct Held {
    /// Parameters that change the shape, in the order of the derivatives.
    pub(crate) shapes: Vec<usize>,
    /// All parameters where it was solved.
    pub(crate) theta: Vec<f64>,
    /// The parts that they make.
    pub(crate) parts: Parts,
    /// Where rows have asked for nodes.
    pub(crate) spans: Vec<Span>,
    pub(crate) lattice: Arc<Lattice>,
}

impl Held {
    /// The lattice of one of the model's muscles with other parameters, to first order in what changes the shape; none if it lacks the derivatives asked for, or if a
    /// parameter without derivatives has changed the shape too. `shape` makes the parts of parameters.
    fn near(
        &self,
        theta: &[f64],
        shapes: &[usize],
        shape: impl Fn(&[f64]) -> Option<Parts>,
    ) -> Option<Arc<Lattice>> {
        let mut back = theta.to_vec();
        for index in &self.shapes {
            back[*index] = self.theta[*index];
        }
        let is_all = || shape(&back).is_some_and(|parts| parts == self.parts);
        let serves = (shapes.is_empty() || shapes == self.shapes) && is_all();
        serves.then(|| {
            let moved: Vec<f64> = self.shapes.iter().map(|i| theta[*i] - self.theta[*i]).collect();
            if moved.iter().all(|moved| *moved == 0.0) {
                return Arc::clone(&self.lattice);
            }
            Arc::new(self.lattice.moved(&moved))
        })
    }

    /// The lattice of this very muscle; none if it is another, or if the lattice lacks the derivatives asked for.
    fn of(&self, parts: &Parts, shapes: &[usize]) -> Option<Arc<Lattice>> {
        let serves = (shapes.is_empty() || shapes == self.shapes) && *parts == self.parts;
        serves.then(|| Arc::clone(&self.lattice))
    }
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

    /// Solves the equilibria of the next evaluation, and those after it by their derivatives, to first order in the parameters of the shape: until this is
    /// called again, or [`Warm::release`].
    ///
    /// Only where equilibria are shot for and interpolated; elsewhere nothing is held, see [`Warm::is_held`].
    pub fn hold(&self) {
        let mut slots = self.lock();
        (slots.holds, slots.held) = (true, Vec::new());
    }

    /// Solves the equilibria of each evaluation again.
    pub fn release(&self) {
        let mut slots = self.lock();
        (slots.holds, slots.held) = (false, Vec::new());
    }

    /// Whether evaluations are to first order from one that was solved.
    #[must_use]
    pub fn is_held(&self) -> bool {
        self.lock().held.iter().any(Option::is_some)
    }

    /// A memory of its own that has what is held here: for evaluations at the same time, of this model or
    /// of others that add effects to it. It serves those that leave the muscle as it was.
    #[must_use]
    pub fn shared(&self) -> Self {
        let held = self.lock().held.clone();
        let slots = Slots { held, is_shared: true, ..Slots::default() };
        Self { counts: self.counts.clone(), slots: Mutex::new(slots) }
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
    /// The lattice of a muscle with the parameters `theta` from what is held.
    pub(crate) fn held_at(
        &self,
        body: usize,
        parts: &Parts,
        theta: &[f64],
        shapes: &[usize],
        shape: impl Fn(&[f64]) -> Option<Parts>,
    ) -> Option<Arc<Lattice>> {
        let held = self.held.get(body)?.as_ref()?;
        if self.is_shared { held.of(parts, shapes) } else { held.near(theta, shapes, shape) }
    }

    /// What is held of one of the model's muscles, if it may be widened: many rows were solved alone.
    pub(crate) fn missed(&self, body: usize) -> Option<(Arc<Held>, usize)> {
        let alone = *self.alone.get(body)?;
        let held = self.held.get(body)?.clone().filter(|_| !self.is_shared)?;
        Some((held, alone))
    }

    /// Slots for so many muscles.
    pub(crate) fn for_bodies(&mut self, count: usize) {
        self.nodes.resize(count, Starts::default());
        self.held.resize(count, None);
        self.alone.resize(count, 0);
    }

    /// One slot for each row of each segment, kept if there are as many as before.
    pub(crate) fn fit(&mut self, lengths: impl Iterator<Item = usize>) {
        let lengths: Vec<usize> = lengths.collect();
        if !self.rows.iter().map(Vec::len).eq(lengths.iter().copied()) {
            self.rows = lengths.into_iter().map(|length| vec![None; length]).collect();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Model;
    use crate::{Record, Wanted};
    use bulge_effects::{Catalogue, Moment};
    use bulge_muscles::from_toml;

    /// In an isometric test all rows are of one contraction: a zero error of the length moves them out of what was solved for it.
    #[test]
    fn a_held_lattice_follows_rows_that_leave_it() {
        let file = "name = \"b\"\nkind = \"braided\"\nlength = \"300 mm\"\nradius = \"10 mm\"\nwall = \"1.8 mm\"\n\
                    braid_angle = \"28.6 deg\"\nends = \"clamped\"\n";
        let catalogue = Catalogue::builtin();
        let add = |model: Model, name: &str| model.with(catalogue.find(name).unwrap(), None).unwrap();
        let model = ["radius-error", "length-zero-error"]
            .into_iter()
            .fold(Model::new(&from_toml(file, "braid").unwrap()), add);
        let moment = |i: u32| Moment { begins: i == 0, ..Moment::at_rest(1e5 + 500.0 * f64::from(i), 0.01) };
        let record = Record::from_moments(
            (0..600).map(moment).collect(),
            vec![0.0; 600],
            std::iter::once(0..600).collect(),
        );
        let record = record.unwrap();
        let wanted = Wanted { parameters: vec![0, 1], readings: false };
        let warm = Warm::new();
        warm.hold();
        model.evaluate_warm(&record, &[0.0102, 0.0], &wanted, &warm).unwrap();
        assert_eq!(warm.lock().alone, [0]);
        // By 4 mm, and the radius by a part: the first such evaluation searches for each row, those after it for none.
        let moved = [0.010_21, 4e-3];
        let alone = model.evaluate_warm(&record, &moved, &wanted, &warm).unwrap();
        assert!(warm.lock().alone[0] >= 600);
        let held = model.evaluate_warm(&record, &moved, &wanted, &warm).unwrap();
        assert!(warm.lock().alone == [0] && warm.is_held());
        let gap = alone.force.iter().zip(&held.force).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        // To first order in the radius.
        assert!(gap < 0.01 && gap > 0.0, "{gap} N");
    }
}
