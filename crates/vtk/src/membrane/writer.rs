//! A thread that writes the states of a run while the next one is sought.
//!
//! It packs on a pool of its own: whoever waits for it may be the only thread of another one, and a child of `fork` has no threads
//! of its parent's.

use rayon::ThreadPoolBuilder;
use std::io;
use std::panic::resume_unwind;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::{Builder, JoinHandle};

use super::MembraneSeries;
use crate::VtkError;

/// Writes a state.
type Job = Box<dyn FnOnce(&mut MembraneSeries) -> Result<(), VtkError> + Send>;

/// The series of a run in the hands of its thread, which writes one state at a time.
#[derive(Debug)]
pub(super) struct Writer {
    jobs: Option<Sender<Job>>,
    done: Receiver<Result<(), VtkError>>,
    thread: Option<JoinHandle<()>>,
    is_writing: bool,
    /// The series, for a system that has no more threads, and for the name of its file.
    here: MembraneSeries,
}

impl Writer {
    pub(super) fn new(series: MembraneSeries) -> Self {
        let (jobs, asked) = channel::<Job>();
        let (tell, done) = channel();
        let mut own = series.clone();
        let work = move || {
            let _pool = ThreadPoolBuilder::new().num_threads(1).use_current_thread().build();
            for job in asked {
                if tell.send(job(&mut own)).is_err() {
                    break;
                }
            }
        };
        let thread = Builder::new().name("files".to_owned()).spawn(work).ok();
        Self { jobs: thread.is_some().then_some(jobs), done, thread, is_writing: false, here: series }
    }

    /// Waits for the last state.
    pub(super) fn rest(&mut self) -> Result<(), VtkError> {
        if !std::mem::take(&mut self.is_writing) {
            return Ok(());
        }
        self.done.recv().unwrap_or_else(|_| Err(self.lost()))
    }

    /// Begins to write another one, after [`Self::rest`].
    pub(super) fn begin(
        &mut self,
        write: impl FnOnce(&mut MembraneSeries) -> Result<(), VtkError> + Send + 'static,
    ) -> Result<(), VtkError> {
        let Some(jobs) = &self.jobs else { return write(&mut self.here) };
        if jobs.send(Box::new(write)).is_err() {
            return Err(self.lost());
        }
        self.is_writing = true;
        Ok(())
    }

    /// A thread that has ended has panicked, and so does whoever asks first.
    fn lost(&mut self) -> VtkError {
        if let Some(Err(panic)) = self.thread.take().map(JoinHandle::join) {
            resume_unwind(panic);
        }
        let source = io::Error::other("the thread that writes has ended");
        VtkError::File { path: self.here.path(), action: "write the states of", source }
    }
}

impl Drop for Writer {
    fn drop(&mut self) {
        // A program that ends now would leave a state that was found and isn't there. Whoever drops this before the end has
        // another error to tell of.
        self.jobs = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}
