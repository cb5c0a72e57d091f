//! Long work beside the interpreter: on a thread of its own, without the lock, told of by a callback, and stopped by Ctrl-C.
//!
//! Work looks at its [`Watch`] whenever it tells how far it is. Once the caller has given up, the watch unwinds the work from there: no lock of the
//! crates is held at these places, files are written under other names until they are whole, and the payload never leaves this module.

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

/// How often Python's signals are looked for.
const LOOK: Duration = Duration::from_millis(50);
/// How often a callback is called at most: a bar needs no more, and each call takes the interpreter's lock.
const TELL: Duration = Duration::from_millis(50);

/// What unwinds work that nobody waits for.
struct Stopped;

/// Through which work tells how far it is, and hears that it is to stop.
#[derive(Clone)]
pub(crate) struct Watch {
    stop: Arc<AtomicBool>,
    told: Option<Arc<Py<PyAny>>>,
    last: Arc<Mutex<Option<Instant>>>,
    raised: Arc<Mutex<Option<PyErr>>>,
}

impl Watch {
    fn new(told: Option<Py<PyAny>>) -> Self {
        Self { stop: Arc::default(), told: told.map(Arc::new), last: Arc::default(), raised: Arc::default() }
    }

    /// Stops here if the caller has given up.
    pub(crate) fn look(&self) {
        if self.stop.load(Ordering::Relaxed) {
            resume_unwind(Box::new(Stopped));
        }
    }

    /// Tells the callback the share that is done, 0 to 1, and what is going on; stops here if the caller has given up or the callback raises.
    pub(crate) fn at(&self, share: f64, what: &str) {
        self.look();
        let Some(told) = self.told.as_ref().filter(|_| self.is_time(share)) else { return };
        let answer = Python::attach(|py| told.call1(py, (share, what)).map(|_| ()));
        if let Err(error) = answer {
            self.stop.store(true, Ordering::Relaxed);
            if let Ok(mut raised) = self.raised.lock() {
                raised.get_or_insert(error);
            }
            resume_unwind(Box::new(Stopped));
        }
    }

    /// Whether the callback is to hear of it; of the end it hears in any case.
    fn is_time(&self, share: f64) -> bool {
        let Ok(mut last) = self.last.try_lock() else { return false };
        let now = Instant::now();
        let is_time = share >= 1.0 || last.is_none_or(|last| now.duration_since(last) >= TELL);
        if is_time {
            *last = Some(now);
        }
        is_time
    }

    fn take_raised(&self) -> Option<PyErr> {
        self.raised.lock().ok().and_then(|mut raised| raised.take())
    }
}

/// Does work on a thread of its own, and returns what it returns. On Ctrl-C it raises at once; the work ends at the next place where it
/// tells of itself.
pub(crate) fn beside<T: Send + 'static>(
    py: Python<'_>,
    told: Option<Py<PyAny>>,
    work: impl FnOnce(&Watch) -> T + Send + 'static,
) -> PyResult<T> {
    let watch = Watch::new(told);
    let (send, receive) = channel();
    let theirs = watch.clone();
    let run = move || {
        let found = catch_unwind(AssertUnwindSafe(|| work(&theirs)));
        // Nobody may be waiting any more.
        let _ = send.send(found);
    };
    thread::Builder::new().name("bulge".to_owned()).spawn(run).map_err(PyErr::from)?;
    let mut receive = receive;
    loop {
        let waited;
        (waited, receive) = py.detach(move || (receive.recv_timeout(LOOK), receive));
        match waited {
            Ok(Ok(found)) => return Ok(found),
            Ok(Err(payload)) => return Err(watch.take_raised().unwrap_or_else(|| fault(payload.as_ref()))),
            Err(RecvTimeoutError::Timeout) => {
                if let Err(interrupt) = py.check_signals() {
                    watch.stop.store(true, Ordering::Relaxed);
                    return Err(interrupt);
                }
            }
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err("a thread of bulge has gone"));
            }
        }
    }
}

/// Work that ended in a way that nobody meant.
fn fault(payload: &(dyn Any + Send)) -> PyErr {
    let says = payload.downcast_ref::<String>().cloned();
    let says = says.or_else(|| payload.downcast_ref::<&str>().map(|text| (*text).to_owned()));
    PyRuntimeError::new_err(format!("a fault inside bulge: {}", says.unwrap_or_default()))
}
