//! Lattices that a family of models has solved.
//!
//! Most candidates of a search leave the muscle as it is, and start where others start: they ask for the same equilibria. What a lattice holds depends on what was
//! asked for only if its searches began anew; such a lattice is kept, and whoever asks for the very same gets it, to the bit what he would have solved.

use bulge_fibre::Start;
use bulge_muscles::Muscle;
use std::collections::{HashMap, VecDeque};
use std::sync::{Arc, Mutex, PoisonError};

use crate::lattice::Lattice;

/// Lattices that are kept, some 100 kB each.
const KEPT: usize = 32;

/// Where the searches for the nodes of a lattice ended.
pub(crate) type Starts = Arc<HashMap<[i64; 2], Start>>;

/// What the nodes of a lattice depend on besides their places.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Asked {
    pub(crate) muscle: Muscle,
    /// All numbers of effects that change the shape: a derivative may depend on those that leave the muscle as it is.
    pub(crate) numbers: Vec<(String, u64)>,
    /// Numbers by which derivatives are asked for.
    pub(crate) shapes: Vec<(String, String)>,
}

#[derive(Debug)]
struct Kept {
    asked: Asked,
    lattice: Arc<Lattice>,
    starts: Starts,
}

/// Solved lattices, the oldest first. A model shares them with those that were made from it.
#[derive(Debug, Default)]
pub(crate) struct Solved(Mutex<VecDeque<Arc<Kept>>>);

impl Solved {
    /// The lattice with the nodes of `unsolved`, from what is kept, or as `solve` finds it.
    pub(crate) fn lattice(
        &self,
        asked: Asked,
        unsolved: Lattice,
        solve: impl FnOnce(Lattice) -> (Lattice, Starts),
    ) -> (Arc<Lattice>, Starts) {
        let is_it = |kept: &&Arc<Kept>| kept.lattice.has_nodes_of(&unsolved) && kept.asked == asked;
        let found = self.lock().iter().find(is_it).map(Arc::clone);
        let kept = found.unwrap_or_else(|| {
            let (lattice, starts) = solve(unsolved);
            let kept = Arc::new(Kept { asked, lattice: Arc::new(lattice), starts });
            let mut all = self.lock();
            if all.len() >= KEPT {
                all.pop_front();
            }
            all.push_back(Arc::clone(&kept));
            kept
        });
        (Arc::clone(&kept.lattice), Arc::clone(&kept.starts))
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, VecDeque<Arc<Kept>>> {
        // A thread that panicked leaves whole entries.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
