//! The thread that compares: it keeps what it has solved, and answers one question after the other.
//!
//! A question that nobody waits for any more is passed over, so that the last one asked is answered first.

use bulge_inference::{Comparing, Comparison, Rows};
use rayon::ThreadPoolBuilder;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;
use tokio::sync::oneshot;

use crate::inputs::{Inputs, With};
use crate::refusal::{Place, Refusal};

/// What is asked of a comparison.
pub(crate) enum Question {
    /// The ladder of errors and all that goes with it.
    Comparison(oneshot::Sender<Result<Box<Comparison>, Refusal>>),
    /// The forces row by row.
    Rows(oneshot::Sender<Result<Rows, Refusal>>),
    /// The comparison with the force of each rung, row by row.
    Report(oneshot::Sender<Result<(Box<Comparison>, Rows), Refusal>>),
    /// Why each of the effects can't be added.
    Unsuitable(oneshot::Sender<Result<Vec<Option<String>>, Refusal>>),
    /// To be ready for the questions that may follow.
    Prepared(oneshot::Sender<Result<(), Refusal>>),
}

impl Question {
    fn is_given_up(&self) -> bool {
        match self {
            Self::Comparison(to) => to.is_closed(),
            Self::Rows(to) => to.is_closed(),
            Self::Report(to) => to.is_closed(),
            Self::Unsuitable(to) => to.is_closed(),
            Self::Prepared(to) => to.is_closed(),
        }
    }

    /// Says why there is no answer.
    fn refuse(self, refusal: Refusal) {
        // Whoever has given up meanwhile doesn't hear it.
        match self {
            Self::Comparison(to) => drop(to.send(Err(refusal))),
            Self::Rows(to) => drop(to.send(Err(refusal))),
            Self::Report(to) => drop(to.send(Err(refusal))),
            Self::Unsuitable(to) => drop(to.send(Err(refusal))),
            Self::Prepared(to) => drop(to.send(Err(refusal))),
        }
    }

    fn answer(self, comparing: &Comparing<'_>, With { effects, restrictions }: &With) {
        let refused = Refusal::at(Place::Effects);
        match self {
            Self::Comparison(to) => {
                let found = of_all(|| comparing.with(effects, restrictions).map(Box::new).map_err(&refused));
                drop(to.send(found));
            }
            Self::Rows(to) => {
                drop(to.send(of_all(|| comparing.rows(effects, restrictions).map_err(&refused))));
            }
            Self::Report(to) => {
                let both = || {
                    let comparison = Box::new(comparing.with(effects, restrictions)?);
                    Ok((comparison, comparing.rows_of_rungs(effects, restrictions)?))
                };
                drop(to.send(of_all(|| both().map_err(&refused))));
            }
            Self::Prepared(to) => {
                drop(to.send(of_all(|| comparing.with(effects, restrictions).map(drop).map_err(&refused))));
            }
            Self::Unsuitable(to) => {
                drop(to.send(of_all(|| {
                    Ok(effects.iter().map(|effect| comparing.unsuitable(effect)).collect())
                })));
            }
        }
    }
}

/// A computation whose bug ends only the answer.
pub(crate) fn of_all<T>(compute: impl FnOnce() -> Result<T, Refusal>) -> Result<T, Refusal> {
    catch_unwind(AssertUnwindSafe(compute)).unwrap_or_else(|_| {
        let what = "this could not be computed because of a mistake in Bulge: please report it, with the data and the muscle";
        Err(Refusal::new(Place::Request, what))
    })
}

/// A question about some inputs and a model.
struct Task {
    inputs: Arc<Inputs>,
    with: With,
    question: Question,
}

/// A thread that compares.
pub(crate) struct Worker(Sender<Task>);

impl Worker {
    /// Starts it; `held_out`: whether it computes errors on held-out data.
    pub(crate) fn start(held_out: bool) -> Self {
        let (tasks, waiting) = channel();
        thread::spawn(move || {
            // Held-out errors take long: they leave half of the cores to what a person waits for.
            let half = thread::available_parallelism().map_or(1, |cores| cores.get().div_ceil(2));
            let apart = held_out.then(|| ThreadPoolBuilder::new().num_threads(half).build());
            match apart {
                Some(Ok(pool)) => pool.install(move || work(&waiting, held_out)),
                // Without threads of its own it works on those of all.
                _ => work(&waiting, held_out),
            }
        });
        Self(tasks)
    }

    /// Asks; the answer comes through the channel of the question.
    pub(crate) fn ask(&self, inputs: Arc<Inputs>, with: With, question: Question) {
        // Without its thread the question is dropped, and whoever waits for the answer hears that.
        drop(self.0.send(Task { inputs, with, question }));
    }
}

fn work(waiting: &Receiver<Task>, held_out: bool) {
    let mut first = None;
    while let Some(task) = first.take().or_else(|| waiting.recv().ok()) {
        if !task.question.is_given_up() {
            first = work_on(task, waiting, held_out);
        }
    }
}

/// Answers as long as the questions are about the same inputs; returns the first that isn't.
fn work_on(task: Task, waiting: &Receiver<Task>, held_out: bool) -> Option<Task> {
    let inputs = Arc::clone(&task.inputs);
    let options = inputs.options(With::default(), held_out);
    let begun =
        of_all(|| Comparing::new(&inputs.data, &inputs.muscle, &options).map_err(Refusal::at(Place::Data)));
    let comparing = match begun {
        Ok(comparing) => comparing,
        Err(refusal) => {
            task.question.refuse(refusal);
            return None;
        }
    };
    task.question.answer(&comparing, &task.with);
    while let Ok(task) = waiting.recv() {
        if task.question.is_given_up() {
            continue;
        }
        if !Arc::ptr_eq(&task.inputs, &inputs) {
            return Some(task);
        }
        task.question.answer(&comparing, &task.with);
    }
    None
}
