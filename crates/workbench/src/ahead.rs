//! Fits computed in advance while nobody waits for a computation. A switch of the page can then be answered
//! at once.

use bulge_effects::{Catalogue, Effect};
use bulge_inference::Comparing;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::collections::VecDeque;
use std::sync::mpsc::{Receiver, RecvTimeoutError, TryRecvError};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use tokio::sync::oneshot;

use crate::inputs::With;
use crate::refusal::{Place, Refusal};
use crate::worker::of_all;

/// Time for which a model must stay unchanged before others are fitted. Meanwhile the page draws, and the
/// user may switch further effects.
const REST: Duration = Duration::from_secs(1);
/// After a fit that takes longer no others are computed in advance: they would occupy a core for minutes.
const SLOW: Duration = Duration::from_secs(3);

/// Number of computations a person waits for, and the model being fitted in advance.
#[derive(Debug, Default)]
struct Now {
    /// Computations that a person waits for.
    waited: usize,
    /// Key of the model that is being fitted in advance.
    ahead: Option<String>,
}

/// Shared counter of the computations a person waits for, and of the fit in advance.
#[derive(Debug, Clone, Default)]
pub(crate) struct Waiting(Arc<(Mutex<Now>, Condvar)>);

/// Guard: a person waits until it is dropped.
#[derive(Debug)]
pub(crate) struct Waited(Waiting);

/// Guard: a model is being fitted in advance until it is dropped.
struct Ahead<'a>(&'a Waiting);

impl Waiting {
    fn now(&self) -> MutexGuard<'_, Now> {
        self.0.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn wait_while(&self, busy: impl Fn(&Now) -> bool) -> MutexGuard<'_, Now> {
        self.0.1.wait_while(self.now(), |now| busy(now)).unwrap_or_else(PoisonError::into_inner)
    }

    /// Registers one more computation that a person waits for.
    pub(crate) fn begin(&self) -> Waited {
        self.now().waited += 1;
        Waited(self.clone())
    }

    /// As [`Waiting::begin`], for a computation about a model. If that model is being fitted in advance, it
    /// returns once the fit is done.
    pub(crate) fn begin_with(&self, with: &With) -> Waited {
        let key = with.key();
        let waited = self.begin();
        drop(self.wait_while(|now| now.ahead.as_ref() == Some(&key)));
        waited
    }

    /// Marks a model as being fitted in advance.
    fn ahead(&self, with: &With) -> Ahead<'_> {
        self.now().ahead = Some(with.key());
        Ahead(self)
    }

    /// Blocks until no person waits for a computation.
    fn rest(&self) {
        drop(self.wait_while(|now| now.waited > 0));
    }
}

impl Drop for Waited {
    fn drop(&mut self) {
        self.0.now().waited -= 1;
        self.0.0.1.notify_all();
    }
}

impl Drop for Ahead<'_> {
    fn drop(&mut self) {
        self.0.now().ahead = None;
        self.0.0.1.notify_all();
    }
}

/// Models that are one switch away: with one effect less, starting with the last one, or with one more.
fn neighbours<'a>(with: &'a With, catalogue: &'a Catalogue) -> impl Iterator<Item = With> + 'a {
    let is = |one: &Arc<dyn Effect>, name: &str| one.card().name == name;
    let without = (0..with.effects.len()).rev().map(move |place| {
        let mut less = with.clone();
        let left_out = less.effects.remove(place);
        less.restrictions.retain(|restriction| !is(&left_out, &restriction.number.effect));
        less
    });
    let others =
        catalogue.iter().filter(move |effect| !with.effects.iter().any(|one| is(one, effect.card().name)));
    without.chain(others.map(|effect| {
        let mut more = with.clone();
        more.effects.push(Arc::clone(effect));
        more
    }))
}

/// What to fit in advance.
pub(crate) enum Next {
    /// The models that may follow this one.
    After(With),
    /// This model, since the pointer is on its switch. The sender reports when the fit is done; it is closed
    /// if nobody is interested any more.
    One(With, oneshot::Sender<Result<(), Refusal>>),
}

/// The threads that fit in advance. They are separate from the threads of those who wait for an answer, since
/// an answer may wait for one of these fits.
struct Pools {
    /// One thread, since most of its results will never be requested.
    alone: ThreadPool,
    /// All threads.
    all: ThreadPool,
}

/// Fits what is requested: at once if the pointer is on a switch; otherwise the neighbours of the last model
/// one by one, and only while no person waits.
pub(crate) fn work(
    comparing: &Comparing<'_>,
    catalogue: &Catalogue,
    waiting: &Waiting,
    wishes: &Receiver<Next>,
) {
    let pools = [1, 0].map(|threads| ThreadPoolBuilder::new().num_threads(threads).build());
    let [Ok(alone), Ok(all)] = pools else { return };
    let pools = Pools { alone, all };
    // Neighbours still to be fitted.
    let mut rest: VecDeque<With> = VecDeque::new();
    let mut is_resting = false;
    loop {
        let wish = match () {
            () if rest.is_empty() => wishes.recv().map_err(|_| RecvTimeoutError::Disconnected),
            () if is_resting => wishes.recv_timeout(REST),
            () => wishes.try_recv().map_err(|error| match error {
                TryRecvError::Empty => RecvTimeoutError::Timeout,
                TryRecvError::Disconnected => RecvTimeoutError::Disconnected,
            }),
        };
        match wish {
            Err(RecvTimeoutError::Disconnected) => return,
            Ok(Next::After(with)) => {
                rest = neighbours(&with, catalogue).collect();
                is_resting = true;
            }
            Ok(Next::One(with, told)) => {
                if !told.is_closed() {
                    // Nobody receives the answer if the page has given up meanwhile.
                    let _ahead = waiting.ahead(&with);
                    drop(told.send(fit(comparing, &pools.all, &with)));
                }
            }
            Err(RecvTimeoutError::Timeout) => {
                is_resting = false;
                waiting.rest();
                let begun = Instant::now();
                if let Some(with) = rest.pop_front() {
                    let _ahead = waiting.ahead(&with);
                    // An error is reported when the fit is requested.
                    drop(fit(comparing, &pools.alone, &with));
                }
                if begun.elapsed() > SLOW {
                    rest.clear();
                }
            }
        }
    }
}

fn fit(comparing: &Comparing<'_>, pool: &ThreadPool, with: &With) -> Result<(), Refusal> {
    let compared = || comparing.with(&with.effects, &with.restrictions).map(drop);
    pool.install(|| of_all(|| compared().map_err(Refusal::at(Place::Effects))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::channel;
    use std::thread;

    #[test]
    fn neighbours_are_one_switch_away() {
        let catalogue = Catalogue::builtin();
        let effects = ["end-taper", "coulomb-friction"].map(|name| Arc::clone(catalogue.find(name).unwrap()));
        let with = With { effects: effects.to_vec(), restrictions: Vec::new() };
        let names = |with: &With| -> Vec<String> {
            with.effects.iter().map(|effect| effect.card().name.to_owned()).collect()
        };
        let all: Vec<Vec<String>> = neighbours(&with, &catalogue).map(|with| names(&with)).collect();
        assert_eq!(all[..2], [vec!["end-taper"], vec!["coulomb-friction"]]);
        assert_eq!(all.len(), 2 + catalogue.iter().count() - 2);
        assert!(
            all[2..].iter().all(|more| more.len() == 3 && more[..2] == ["end-taper", "coulomb-friction"])
        );
    }

    /// Whether a call returns only after something else has been done.
    fn waits(call: impl FnOnce() + Send + 'static, then: impl FnOnce()) {
        let (told, hears) = channel();
        let thread = thread::spawn(move || {
            call();
            told.send(()).unwrap();
        });
        assert!(hears.recv_timeout(Duration::from_millis(20)).is_err());
        then();
        hears.recv().unwrap();
        thread.join().unwrap();
    }

    #[test]
    fn nothing_is_fitted_ahead_while_a_person_waits() {
        let waiting = Waiting::default();
        let (first, second) = (waiting.begin(), waiting.begin());
        drop(first);
        let other = waiting.clone();
        waits(move || other.rest(), || drop(second));
        waiting.rest();
    }

    #[test]
    fn who_asks_for_what_is_fitted_ahead_gets_that() {
        let catalogue = Catalogue::builtin();
        let with = |name: &str| With {
            effects: vec![Arc::clone(catalogue.find(name).unwrap())],
            restrictions: Vec::new(),
        };
        let waiting = Waiting::default();
        let ahead = waiting.ahead(&with("end-taper"));
        drop(waiting.begin_with(&with("coulomb-friction")));
        let (other, same) = (waiting.clone(), with("end-taper"));
        waits(move || drop(other.begin_with(&same)), || drop(ahead));
    }
}
