//! The thread that compares: it keeps what it has solved, and answers one question after the other.
//!
//! A question that nobody waits for any more is passed over, so that the last one asked is answered first.

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
    /// The last rung.
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

    /// Says why there is no answer.
    fn refuse(self, refusal: Refusal) {
        // Whoever has given up meanwhile doesn't hear it.
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
            // Only the one that fits ahead gets ready.
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
    /// Starts the one that answers at once, and fits ahead while a person waits for nothing.
    pub(crate) fn quick(waiting: &Waiting) -> Self {
        let (tasks, asked) = channel();
        let waiting = waiting.clone();
        thread::spawn(move || each_inputs(&asked, |task| quickly(task, &asked, &waiting)));
        Self(tasks)
    }

    /// Starts the one that computes errors on held-out data.
    pub(crate) fn held_out(waiting: &Waiting) -> Self {
        let (tasks, asked) = channel();
        let waiting = waiting.clone();
        thread::spawn(move || {
            let work = move || each_inputs(&asked, |task| with_held_out(task, &asked, &waiting));
            // Held-out errors take long: they leave half of the cores to what a person waits for.
            let half = thread::available_parallelism().map_or(1, |cores| cores.get().div_ceil(2));
            match ThreadPoolBuilder::new().num_threads(half).build() {
                Ok(pool) => pool.install(work),
                // Without threads of its own it works on those of all.
                Err(_) => work(),
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

/// Works on questions about the same inputs, then on those about the next ones.
fn each_inputs(asked: &Receiver<Task>, work: impl Fn(Task) -> Option<Task>) {
    let mut first = None;
    while let Some(task) = first.take().or_else(|| asked.recv().ok()) {
        if !task.question.is_given_up() {
            first = work(task);
        }
    }
}

/// What is compared with the inputs of a task; one that can't be compared refuses it.
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
        // It goes when the last answer is given: then nothing is fitted ahead any more.
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

/// Answers as long as the questions are about the same inputs; returns the first that isn't.
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
