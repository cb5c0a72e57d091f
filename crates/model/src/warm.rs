//! The state that one evaluation passes to the next: ends of its searches for equilibria, and the rows that
//! count.
//!
//! A fit asks for nearly the same equilibria thousands of times. Each row and each lattice node has a slot
//! with its last equilibrium, from which the next search starts along the derivatives. Only the row or node
//! itself reads and writes its slot, except that an empty slot may be filled from the previous row of the
//! same segment. Results therefore don't depend on the number of threads. A search that fails from its slot
//! starts from scratch, so that results depend on the slots only within the accuracy of the solver.

use bulge_fibre::{Parts, Start};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::answer::Answer;
use crate::lattice::{Lattice, Span};
use crate::solved::Starts;

/// Equilibria remembered between the evaluations of one fit, for [`crate::Model::evaluate_warm`].
///
/// Use one for each fit: it belongs to one record and one kind of model. Evaluations that share it must run
/// one after the other; if two run at the same time, one of them finds nothing remembered.
#[derive(Debug, Default)]
pub struct Warm {
    counts: Option<Vec<bool>>,
    slots: Mutex<Slots>,
}

/// Slots of the rows, segment by segment, and slots of the lattice nodes by their indices.
#[derive(Debug, Default)]
pub(crate) struct Slots {
    pub(crate) rows: Vec<Vec<Option<Start>>>,
    /// Ends of the node searches, for each of the model's muscles.
    pub(crate) nodes: Vec<Starts>,
    /// Whether to hold the next lattice that is solved.
    pub(crate) holds: bool,
    pub(crate) held: Vec<Option<Arc<Held>>>,
    /// Number of searches outside the lattice in the last evaluation, for each of the model's muscles.
    pub(crate) alone: Vec<usize>,
    /// Answers of the rows when equilibria were last held, if these rows are not too many.
    pub(crate) answers: Option<Arc<RowAnswers>>,
    /// Whether the held lattices come from another model. They then serve only the same muscle.
    is_shared: bool,
}

/// The answer of a row, with the pressure and the contraction at which it was asked last.
pub(crate) type Answered = Option<([f64; 2], Answer)>;

/// Answers of the rows of an evaluation. They serve evaluations of the same muscles, such as those of models that
/// add a friction or a sensor's error.
#[derive(Debug)]
pub(crate) struct RowAnswers {
    /// Parts of each of the model's muscles.
    pub(crate) parts: Vec<Parts>,
    /// Parameters that change the shape, in the order of the derivatives.
    pub(crate) shapes: Vec<usize>,
    pub(crate) rows: Vec<Answered>,
}

impl RowAnswers {
    /// Whether the answers are those of a muscle, with derivatives by these parameters.
    pub(crate) fn serve(&self, body: usize, parts: &Parts, shapes: &[usize]) -> bool {
        (shapes.is_empty() || shapes == self.shapes) && self.parts.get(body) == Some(parts)
    }
}

/// An answer that was asked at exactly this pressure and contraction.
pub(crate) fn known(answered: Option<&Answered>, at: [f64; 2]) -> Option<&Answer> {
    let (there, answer) = answered?.as_ref()?;
    (there.map(f64::to_bits) == at.map(f64::to_bits)).then_some(answer)
}

/// A solved lattice whose derivatives give the lattices of neighbouring shapes.
#[derive(Debug)]
pub(crate) struct Held {
    /// Parameters that change the shape, in the order of the derivatives.
    pub(crate) shapes: Vec<usize>,
    /// All parameters at which it was solved.
    pub(crate) theta: Vec<f64>,
    /// The parts at these parameters.
    pub(crate) parts: Parts,
    /// Nodes that rows have asked for.
    pub(crate) spans: Vec<Span>,
    pub(crate) lattice: Arc<Lattice>,
}

impl Held {
    /// The lattice of one of the model's muscles at other parameters, to first order in the shape parameters.
    /// `shape` makes the parts from parameters. None if the lattice lacks the requested derivatives, or if a
    /// parameter without derivatives has changed the shape as well.
    fn near(
        &self,
        theta: &[f64],
        shapes: &[usize],
        shape: impl Fn(&[f64]) -> Option<Parts>,
    ) -> Option<Arc<Lattice>> {
        // With the shape parameters of the derivatives set back, the parts must be those that were solved.
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

    /// The lattice of exactly this muscle. None if the muscle differs or the lattice lacks the requested
    /// derivatives.
    fn of(&self, parts: &Parts, shapes: &[usize]) -> Option<Arc<Lattice>> {
        let serves = (shapes.is_empty() || shapes == self.shapes) && *parts == self.parts;
        serves.then(|| Arc::clone(&self.lattice))
    }
}

impl Warm {
    /// An empty memory in which all rows count.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// An empty memory in which only the marked rows count. The other rows have the force 0 in a prediction
    /// and need no equilibrium.
    #[must_use]
    pub fn of_rows(counts: &[bool]) -> Self {
        Self { counts: Some(counts.to_vec()), ..Self::default() }
    }

    /// Holds the equilibria of the next evaluation. Later evaluations are computed from their derivatives, to
    /// first order in the shape parameters, until the next call or [`Warm::release`].
    ///
    /// This applies only if equilibria are found by shooting and interpolated; see [`Warm::is_held`]. What else is
    /// held, the answers of up to 20 000 rows, serves the same muscle only.
    pub fn hold(&self) {
        let mut slots = self.lock();
        (slots.holds, slots.held, slots.answers) = (true, Vec::new(), None);
    }

    /// Later evaluations hold nothing more. What is held already still serves.
    pub fn hold_no_more(&self) {
        self.lock().holds = false;
    }

    /// Solves the equilibria anew in each evaluation.
    pub fn release(&self) {
        let mut slots = self.lock();
        (slots.holds, slots.held, slots.answers) = (false, Vec::new(), None);
    }

    /// Whether evaluations are computed to first order from held equilibria.
    #[must_use]
    pub fn is_held(&self) -> bool {
        self.lock().held.iter().any(Option::is_some)
    }

    /// A separate memory with the lattices held here. It allows evaluations at the same time, of this model
    /// or of models that add effects to it. The lattices serve models that leave the muscle unchanged.
    #[must_use]
    pub fn shared(&self) -> Self {
        let (held, answers) = {
            let slots = self.lock();
            (slots.held.clone(), slots.answers.clone())
        };
        let slots = Slots { held, answers, is_shared: true, ..Slots::default() };
        Self { counts: self.counts.clone(), slots: Mutex::new(slots) }
    }

    /// Whether a row counts. Rows beyond the list count.
    pub(crate) fn counts(&self, row: usize) -> bool {
        self.counts.as_ref().and_then(|counts| counts.get(row)).is_none_or(|counts| *counts)
    }

    /// Takes the slots, to be put back later. No lock is held during an evaluation, because it waits for
    /// other threads.
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
    /// The lattice of a muscle at the parameters `theta`, from the held one.
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

    /// The held lattice of one of the model's muscles if it may be widened, and the number of rows that were
    /// solved outside it.
    pub(crate) fn missed(&self, body: usize) -> Option<(Arc<Held>, usize)> {
        let alone = *self.alone.get(body)?;
        let held = self.held.get(body)?.clone().filter(|_| !self.is_shared)?;
        Some((held, alone))
    }

    /// Makes slots for this number of muscles.
    pub(crate) fn for_bodies(&mut self, count: usize) {
        self.nodes.resize(count, Starts::default());
        self.held.resize(count, None);
        self.alone.resize(count, 0);
    }

    /// Makes one slot for each row of each segment. Slots are kept if the segments have the same lengths as
    /// before.
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

    /// In an isometric test all rows have the same contraction, so a zero error of the length moves them out
    /// of the held lattice.
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
        // A shift of 4 mm with a small change of the radius: the first such evaluation searches for each row,
        // later ones for none.
        let moved = [0.010_21, 4e-3];
        let alone = model.evaluate_warm(&record, &moved, &wanted, &warm).unwrap();
        assert!(warm.lock().alone[0] >= 600);
        let held = model.evaluate_warm(&record, &moved, &wanted, &warm).unwrap();
        assert!(warm.lock().alone == [0] && warm.is_held());
        let gap = alone.force.iter().zip(&held.force).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        // The held result is of first order in the radius.
        assert!(gap < 0.01 && gap > 0.0, "{gap} N");
    }
}
