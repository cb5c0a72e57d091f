//! Long work beside the interpreter: on a thread of its own, without the lock, told of by a callback, and stopped by Ctrl-C.
//!
//! Work tells its [`Watch`] how far it is, and looks there whether it is to go on. Once the caller has given up, the watch unwinds the work from there:
//! no lock of the crates is held at these places, files are written under other names until they are whole, and the payload never leaves this module.
//! The callback is called by the caller's own thread, which waits: it may call Bulge again, and touch what belongs to that thread.
//!
//! Work runs on a pool of threads of this module and not on rayon's global one, which a child of `fork` inherits without its threads.

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use std::{mem, process, thread};

/// How often Python's signals are looked for, and the callback is called at most.
const LOOK: Duration = Duration::from_millis(50);

/// What unwinds work that nobody waits for.
struct Stopped;

/// The pool of a process. The process is known by its number: a child of `fork` has the pool of its parent, but not its threads.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// A pool with this many threads, or that of the process with as many as there are cores (or as `RAYON_NUM_THREADS` says).
fn pool(threads: Option<usize>) -> PyResult<Arc<ThreadPool>> {
    let build = |threads: usize| {
        let built = ThreadPoolBuilder::new().num_threads(threads).build();
        built.map(Arc::new).map_err(|error| PyRuntimeError::new_err(format!("no threads: {error}")))
    };
    if let Some(threads) = threads {
        return build(threads);
    }
    let mut there = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    match &*there {
        Some((owner, pool)) if *owner == process::id() => return Ok(Arc::clone(pool)),
        _ => {}
    }
    let made = build(0)?;
    // The pool of a parent is left as it is: whoever ends it waits for threads that are not here.
    mem::forget(there.replace((process::id(), Arc::clone(&made))));
    Ok(made)
}

/// Through which work tells how far it is, and hears that it is to stop.
#[derive(Clone, Default)]
pub(crate) struct Watch {
    stop: Arc<AtomicBool>,
    said: Arc<Mutex<Option<(f64, String)>>>,
}

impl Watch {
    /// Stops here if the caller has given up.
    pub(crate) fn look(&self) {
        if self.stop.load(Ordering::Relaxed) {
            resume_unwind(Box::new(Stopped));
        }
    }

    /// Tells the share that is done, 0 to 1, and what is going on; stops here if the caller has given up.
    pub(crate) fn at(&self, share: f64, what: &str) {
        self.look();
        let mut said = self.said.lock().unwrap_or_else(PoisonError::into_inner);
        match &mut *said {
            // Threads may come out of order.
            Some((before, _)) if *before > share => {}
            Some((before, text)) => {
                *before = share;
                if text != what {
                    what.clone_into(text);
                }
            }
            None => *said = Some((share, what.to_owned())),
        }
    }

    /// Calls the callback with what has been said last, if it hasn't heard of it.
    fn pass_on(
        &self,
        py: Python<'_>,
        told: Option<&Py<PyAny>>,
        heard: &mut Option<(f64, String)>,
    ) -> PyResult<()> {
        let Some(told) = told else { return Ok(()) };
        let said = self.said.lock().unwrap_or_else(PoisonError::into_inner).clone();
        if said == *heard {
            return Ok(());
        }
        heard.clone_from(&said);
        said.map_or(Ok(()), |news| told.call1(py, news).map(drop))
    }

    fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }
}

/// Does work on a thread of its own, and returns what it returns. On Ctrl-C, or if the callback raises, it raises at once; the work ends at the
/// next place where it looks.
pub(crate) fn beside<T: Send + 'static>(
    py: Python<'_>,
    told: Option<Py<PyAny>>,
    work: impl FnOnce(&Watch) -> T + Send + 'static,
) -> PyResult<T> {
    beside_on(py, told, None, work)
}

/// The same on a number of threads.
pub(crate) fn beside_on<T: Send + 'static>(
    py: Python<'_>,
    told: Option<Py<PyAny>>,
    threads: Option<usize>,
    work: impl FnOnce(&Watch) -> T + Send + 'static,
) -> PyResult<T> {
    let pool = py.detach(|| pool(threads))?;
    let watch = Watch::default();
    let (send, receive) = channel();
    let theirs = watch.clone();
    let run = move || {
        let found = catch_unwind(AssertUnwindSafe(|| pool.install(|| work(&theirs))));
        // Nobody may be waiting any more.
        let _ = send.send(found);
    };
    thread::Builder::new().name("bulge".to_owned()).spawn(run).map_err(PyErr::from)?;
    let (mut receive, mut heard) = (receive, None);
    loop {
        let waited;
        (waited, receive) = py.detach(move || (receive.recv_timeout(LOOK), receive));
        let over = match waited {
            Ok(Ok(found)) => Some(found),
            Ok(Err(payload)) => return Err(fault(payload.as_ref())),
            Err(RecvTimeoutError::Timeout) => None,
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err("a thread of bulge has gone"));
            }
        };
        let heard_of = py.check_signals().and_then(|()| watch.pass_on(py, told.as_ref(), &mut heard));
        if let Err(error) = heard_of {
            watch.stop();
            return Err(error);
        }
        if let Some(found) = over {
            return Ok(found);
        }
    }
}

/// Work that ended in a way that nobody meant.
fn fault(payload: &(dyn Any + Send)) -> PyErr {
    let says = payload.downcast_ref::<String>().cloned();
    let says = says.or_else(|| payload.downcast_ref::<&str>().map(|text| (*text).to_owned()));
    PyRuntimeError::new_err(format!("a fault inside bulge: {}", says.unwrap_or_default()))
}
