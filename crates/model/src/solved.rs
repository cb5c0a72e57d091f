//! A cache of the lattices that a family of models has solved.
//!
//! Most candidates of a search leave the muscle unchanged and start from the same values, so they ask for the
//! same equilibria. The result of a lattice depends only on the request if its searches started from scratch.
//! Only such lattices are cached. A cached lattice is identical, bit for bit, to the one that would be
//! solved.

use bulge_fibre::{Parts, Start};
use std::collections::{HashMap, VecDeque};
use std::sync::{Arc, Mutex, PoisonError};

use crate::lattice::Lattice;

/// The number of lattices that are kept. Each takes some 500 kB with the ends of its searches. The candidates
/// of one step start from these.
const KEPT: usize = 12;

/// The ends of the searches for the nodes of a lattice.
pub(crate) type Starts = Arc<HashMap<[i64; 2], Start>>;

/// The request for a lattice: everything its nodes depend on besides their positions.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Asked {
    pub(crate) parts: Parts,
    /// All parameters of the shape effects. Derivatives may depend on a parameter that leaves the muscle
    /// unchanged.
    pub(crate) numbers: Vec<(String, u64)>,
    /// The parameters to differentiate by.
    pub(crate) shapes: Vec<(String, String)>,
}

#[derive(Debug)]
struct Kept {
    asked: Asked,
    lattice: Arc<Lattice>,
    starts: Starts,
}

/// Solved lattices, the oldest first. A model shares them with the models made from it.
#[derive(Debug, Default)]
pub(crate) struct Solved(Mutex<VecDeque<Arc<Kept>>>);

impl Solved {
    /// The lattice with the nodes of `unsolved`, from the cache or from `solve`.
    pub(crate) fn lattice(
        &self,
        asked: Asked,
        unsolved: Lattice,
        solve: impl FnOnce(Lattice) -> (Lattice, Starts),
    ) -> (Arc<Lattice>, Starts) {
        let find = |all: &VecDeque<Arc<Kept>>, lattice: &Lattice, asked: &Asked| {
            let is_it = |kept: &&Arc<Kept>| kept.lattice.has_nodes_of(lattice) && kept.asked == *asked;
            all.iter().find(is_it).map(Arc::clone)
        };
        let found = find(&self.lock(), &unsolved, &asked);
        let kept = found.unwrap_or_else(|| {
            let (lattice, starts) = solve(unsolved);
            let mut all = self.lock();
            // Another thread may have solved the same one meanwhile.
            find(&all, &lattice, &asked).unwrap_or_else(|| {
                let kept = Arc::new(Kept { asked, lattice: Arc::new(lattice), starts });
                if all.len() >= KEPT {
                    all.pop_front();
                }
                all.push_back(Arc::clone(&kept));
                kept
            })
        });
        (Arc::clone(&kept.lattice), Arc::clone(&kept.starts))
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, VecDeque<Arc<Kept>>> {
        // Entries are added whole, so a thread that panicked leaves none half written.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::tests::{braid, lattice};

    fn asked(radius: f64, number: f64) -> Asked {
        Asked {
            parts: braid(radius, 1e5).0,
            numbers: vec![("radius-error".to_owned(), number.to_bits())],
            shapes: Vec::new(),
        }
    }

    /// A cached lattice equals the solved one, bit for bit. Another muscle, another parameter or other rows
    /// are solved anew.
    #[test]
    fn a_hit_is_to_the_bit_a_miss() {
        let solved = Solved::default();
        let mut searches = 0;
        let mut ask = |solved: &Solved, radius: f64, number: f64, most: f64| {
            let equilibrium = braid(radius, 1e5).1;
            let unsolved = lattice(&equilibrium, 2e5, most);
            let (found, starts) = solved.lattice(asked(radius, number), unsolved, |unsolved| {
                searches += 1;
                unsolved.solved(&equilibrium, &Starts::default())
            });
            let force = found.answer(2.1e5, 0.153).unwrap().force;
            let bits = [force.value, force.by_pressure, force.by_contraction].map(f64::to_bits);
            (bits, starts.len(), searches)
        };
        let miss = ask(&solved, 10.0, 1.0, 0.2);
        let hit = ask(&solved, 10.0, 1.0, 0.2);
        assert_eq!((miss.0, miss.1, 1), hit);
        let alone = ask(&Solved::default(), 10.0, 1.0, 0.2);
        assert_eq!((alone.0, alone.1, 2), (hit.0, hit.1, alone.2));
        assert_eq!(ask(&solved, 10.0, 1.01, 0.2), (hit.0, hit.1, 3));
        assert_eq!(ask(&solved, 10.0, 1.0, 0.25).2, 4);
        let other = ask(&solved, 10.1, 1.0, 0.2);
        assert!(other.0 != hit.0 && other.2 == 5);
        assert_eq!(ask(&solved, 10.0, 1.0, 0.2), (hit.0, hit.1, 5));
    }

    /// The oldest lattice is dropped when the cache is full.
    #[test]
    fn no_more_are_kept_than_there_is_room_for() {
        let solved = Solved::default();
        let unsolved = || lattice(&braid(10.0, 1e5).1, 2e5, 0.2);
        for number in 0..=KEPT {
            solved.lattice(asked(10.0, number as f64), unsolved(), |unsolved| (unsolved, Starts::default()));
        }
        assert_eq!(solved.lock().len(), KEPT);
        let mut anew = false;
        solved.lattice(asked(10.0, 0.0), unsolved(), |unsolved| {
            anew = true;
            (unsolved, Starts::default())
        });
        assert!(anew);
    }
}
