//! A running diagnosis: it has its own thread, reports its progress, and stops when nobody listens any more.

use bulge_inference::{DiagnoseOptions, Diagnosis, Options, Progress, diagnose};
use serde::Serialize;
use std::panic::resume_unwind;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use tokio::sync::mpsc::{UnboundedReceiver, UnboundedSender, unbounded_channel};

use crate::ahead::Waited;
use crate::inputs::Inputs;
use crate::refusal::{Place, Refusal};
use crate::worker::of_all;

/// Messages of a diagnosis.
pub(crate) enum News {
    /// Its progress.
    Progress(Stage),
    /// The result.
    Found(Box<Diagnosis>),
    /// Why there is no result.
    Failed(Refusal),
}

/// The completed fraction, and the current step.
#[derive(Debug, Serialize)]
pub(crate) struct Stage {
    share: f64,
    what: String,
}

/// Payload that unwinds a diagnosis for which nobody waits.
struct GivenUp;

/// Receiver of the messages; dropping it ends the diagnosis.
pub(crate) struct Listener {
    pub(crate) news: UnboundedReceiver<News>,
    given_up: Arc<AtomicBool>,
}

impl Drop for Listener {
    fn drop(&mut self) {
        self.given_up.store(true, Ordering::Relaxed);
    }
}

/// Starts a diagnosis, which runs until it is done or the listener is dropped.
pub(crate) fn begin(inputs: Arc<Inputs>, options: Options, waited: Waited) -> Listener {
    let (told, news) = unbounded_channel();
    let given_up = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&given_up);
    thread::spawn(move || {
        let found = of_all(|| find(&inputs, options, &told, &flag));
        drop(told.send(match found {
            Ok(found) => News::Found(Box::new(found)),
            Err(refusal) => News::Failed(refusal),
        }));
        drop(waited);
    });
    Listener { news, given_up }
}

fn find(
    inputs: &Inputs,
    options: Options,
    told: &UnboundedSender<News>,
    given_up: &Arc<AtomicBool>,
) -> Result<Diagnosis, Refusal> {
    let stage = {
        let told = told.clone();
        move |share: f64, what: &str| drop(told.send(News::Progress(Stage { share, what: what.to_owned() })))
    };
    let flag = Arc::clone(given_up);
    // `resume_unwind` instead of a panic, so that no message is printed.
    let look = move || {
        if flag.load(Ordering::Relaxed) {
            resume_unwind(Box::new(GivenUp));
        }
    };
    let progress = Progress::to(stage).beating(look);
    let options = DiagnoseOptions { progress, ..DiagnoseOptions::new(options) };
    diagnose(&inputs.data, &inputs.muscle, &options).map_err(Refusal::at(Place::Data))
}
