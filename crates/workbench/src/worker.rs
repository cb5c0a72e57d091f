//! The thread that compares. It keeps the equilibria it has solved, and answers one question after the other.
//!
//! A question for which nobody waits any more is skipped, so that the latest one is answered first.

use bulge_inference::{Comparing, Comparison, Fitting, Options, Rows};
use rayon::ThreadPoolBuilder;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;
use tokio::sync::oneshot;

use crate::ahead::{self, Next, Waiting};
use crate::inputs::{Inputs, With};
use crate::refusal::{Place, Refusal};

/// Questions about a comparison.
pub(crate) enum Question {
    /// The ladder of errors and the rest of the comparison.
    Comparison(oneshot::Sender<Result<Box<Comparison>, Refusal>>),
    /// The forces row by row.
    Rows(oneshot::Sender<Result<Rows, Refusal>>),
    /// The comparison with the force of each rung, row by row.
    Report(oneshot::Sender<Result<(Box<Comparison>, Rows), Refusal>>),
    /// Why each of the effects can't be added.
    Unsuitable(oneshot::Sender<Result<Vec<Option<String>>, Refusal>>),
    /// Preparation for the questions that may follow.
    Prepared(oneshot::Sender<Result<(), Refusal>>),
    /// The fit of the last rung.
    Fitting(oneshot::Sender<Result<Box<Fitting>, Refusal>>),
}

impl Question {
    fn is_given_up(&self) -> bool {
        match self {
            Self::Comparison(to) => to.is_closed(),
            Self::Rows(to) => to.is_closed(),
            Self::Report(to) => to.is_closed(),
            Self::Unsuitable(to) => to.is_closed(),
            Self::Prepared(to) => to.is_closed(),
            Self::Fitting(to) => to.is_closed(),
        }
    }

    /// Answers with a refusal.
    fn refuse(self, refusal: Refusal) {
        // Nobody receives it if the requester has given up meanwhile.
        match self {
            Self::Comparison(to) => drop(to.send(Err(refusal))),
            Self::Rows(to) => drop(to.send(Err(refusal))),
            Self::Report(to) => drop(to.send(Err(refusal))),
            Self::Unsuitable(to) => drop(to.send(Err(refusal))),
            Self::Prepared(to) => drop(to.send(Err(refusal))),
            Self::Fitting(to) => drop(to.send(Err(refusal))),
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
            // Only the worker that fits in advance prepares anything.
            Self::Prepared(to) => drop(to.send(Ok(()))),
            Self::Fitting(to) => {
                let found =
                    of_all(|| comparing.fitting(effects, restrictions).map(Box::new).map_err(&refused));
                drop(to.send(found));
            }
            Self::Unsuitable(to) => {
                drop(to.send(of_all(|| {
                    Ok(effects.iter().map(|effect| comparing.unsuitable(effect)).collect())
                })));
            }
        }
    }
}

/// Runs a computation; a panic in it becomes an error of the answer and ends nothing else.
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
    /// Starts the worker that answers at once, and fits in advance while no person waits.
    pub(crate) fn quick(waiting: &Waiting) -> Self {
        let (tasks, asked) = channel();
        let waiting = waiting.clone();
        thread::spawn(move || each_inputs(&asked, |task| quickly(task, &asked, &waiting)));
        Self(tasks)
    }

    /// Starts the worker that computes errors on held-out data.
    pub(crate) fn held_out(waiting: &Waiting) -> Self {
        let (tasks, asked) = channel();
        let waiting = waiting.clone();
        thread::spawn(move || {
            let work = move || each_inputs(&asked, |task| with_held_out(task, &asked, &waiting));
            // Held-out errors take long: they leave half of the cores to computations a person waits for.
            let half = thread::available_parallelism().map_or(1, |cores| cores.get().div_ceil(2));
            match ThreadPoolBuilder::new().num_threads(half).build() {
                Ok(pool) => pool.install(work),
                // Without its own thread pool it uses the common one.
                Err(_) => work(),
            }
        });
        Self(tasks)
    }

    /// Sends a question; the answer comes through the question's channel.
    pub(crate) fn ask(&self, inputs: Arc<Inputs>, with: With, question: Question) {
        // Without its thread the question is dropped, which the receiver of the answer notices.
        drop(self.0.send(Task { inputs, with, question }));
    }
}

/// Works on questions about the same inputs, then on questions about the next ones.
fn each_inputs(asked: &Receiver<Task>, work: impl Fn(Task) -> Option<Task>) {
    let mut first = None;
    while let Some(task) = first.take().or_else(|| asked.recv().ok()) {
        if !task.question.is_given_up() {
            first = work(task);
        }
    }
}

/// The comparison for the inputs of a task. If they can't be compared, the task is refused.
fn begun<'a>(
    task: Task,
    inputs: &'a Inputs,
    options: &'a Options,
    waiting: &Waiting,
) -> Result<(Comparing<'a>, Task), ()> {
    let _waited = waiting.begin();
    let comparing =
        of_all(|| Comparing::new(&inputs.data, &inputs.muscle, options).map_err(Refusal::at(Place::Data)));
    match comparing {
        Ok(comparing) => Ok((comparing, task)),
        Err(refusal) => {
            task.question.refuse(refusal);
            Err(())
        }
    }
}

fn with_held_out(task: Task, asked: &Receiver<Task>, waiting: &Waiting) -> Option<Task> {
    let inputs = Arc::clone(&task.inputs);
    let options = inputs.options(With::default(), true);
    let (comparing, task) = begun(task, &inputs, &options, waiting).ok()?;
    answered(task, asked, |Task { with, question, .. }| {
        let _waited = waiting.begin();
        question.answer(&comparing, &with);
    })
}

fn quickly(task: Task, asked: &Receiver<Task>, waiting: &Waiting) -> Option<Task> {
    let inputs = Arc::clone(&task.inputs);
    let options = inputs.options(With::default(), false);
    let (comparing, task) = begun(task, &inputs, &options, waiting).ok()?;
    thread::scope(|threads| {
        // The sender is dropped after the last answer, which ends the fits in advance.
        let (ahead, wishes) = channel();
        let (comparing, catalogue) = (&comparing, &inputs.catalogue);
        threads.spawn(move || ahead::work(comparing, catalogue, waiting, &wishes));
        let wish = |wish: Next| drop(ahead.send(wish));
        answered(task, asked, |Task { with, question, .. }| match question {
            Question::Prepared(told) => wish(Next::One(with, told)),
            question => {
                let is_model = matches!(question, Question::Comparison(_));
                let waited = waiting.begin_with(&with);
                question.answer(comparing, &with);
                drop(waited);
                if is_model {
                    wish(Next::After(with));
                }
            }
        })
    })
}

/// Answers questions as long as they are about the same inputs; returns the first one that isn't.
fn answered(mut task: Task, asked: &Receiver<Task>, answer: impl Fn(Task)) -> Option<Task> {
    let inputs = Arc::clone(&task.inputs);
    loop {
        if !task.question.is_given_up() {
            if !Arc::ptr_eq(&task.inputs, &inputs) {
                return Some(task);
            }
            answer(task);
        }
        task = asked.recv().ok()?;
    }
}
