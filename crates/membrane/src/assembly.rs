//! Assembly: energy, forces and stiffness of the structure over its degrees of freedom, from its elements.
//!
//! The destination of each element number is determined once. A sum then runs over the sources of one entry
//! in the order of the elements, so that the result doesn't depend on the order of computation.

use crate::dofs::{Dofs, NONE};
use crate::error::MembraneError;
use crate::set::{Elements, Parts, Place, packed};
use rayon::prelude::*;
use std::collections::TryReserveError;

/// For each entry of a vector, the positions in a buffer whose sum it is.
#[derive(Debug, Default)]
struct Gather {
    starts: Vec<u32>,
    sources: Vec<u32>,
}

impl Gather {
    /// From pairs (entry, source), whose order the sources of an entry keep.
    fn new(entries: usize, pairs: &[(u32, u32)]) -> Result<Self, TryReserveError> {
        let (starts, sources) = grouped(entries, pairs.len(), pairs.iter().copied())?;
        Ok(Self { starts, sources })
    }

    fn entries(&self) -> usize {
        self.starts.len() - 1
    }

    fn sum(&self, buffer: &[f64], out: &mut [f64]) {
        let one = |(i, out): (usize, &mut f64)| {
            let sources = &self.sources[self.starts[i] as usize..self.starts[i + 1] as usize];
            *out = sources.iter().map(|source| buffer[*source as usize]).sum();
        };
        if out.len() < 4096 {
            out.iter_mut().enumerate().for_each(one);
        } else {
            out.par_iter_mut().enumerate().with_min_len(1024).for_each(one);
        }
    }
}

/// Numbers of groups 0.. with the first place of each group, and the end of the last. Within a group they keep their order.
fn grouped<T: Copy + Default>(
    groups: usize,
    count: usize,
    of: impl Iterator<Item = (u32, T)> + Clone,
) -> Result<(Vec<u32>, Vec<T>), TryReserveError> {
    let mut starts = filled(groups + 1, 0_u32)?;
    for (group, _) in of.clone() {
        starts[group as usize + 1] += 1;
    }
    for i in 0..groups {
        starts[i + 1] += starts[i];
    }
    let mut next = with_room(groups)?;
    next.extend_from_slice(&starts[..groups]);
    let mut all = filled(count, T::default())?;
    for (group, one) in of {
        let place = &mut next[group as usize];
        all[*place as usize] = one;
        *place += 1;
    }
    Ok((starts, all))
}

/// An entry of the stiffness by column and row, and a source of it.
type Entry = ((u32, u32), u32);

/// Entries in the order of columns, rows and sources. There are few in a column, so grouping leaves little to sort.
fn sorted(columns: usize, entries: Vec<Entry>) -> Result<Vec<Entry>, TryReserveError> {
    let by_column = entries.iter().map(|entry| (entry.0.0, *entry));
    let (_, mut sorted) = grouped(columns, entries.len(), by_column)?;
    drop(entries);
    sorted.par_chunk_by_mut(|a, b| a.0.0 == b.0.0).for_each(<[_]>::sort_unstable);
    Ok(sorted)
}

/// The buffers of all elements, and the destinations of their numbers.
#[derive(Debug)]
pub(crate) struct Assembly {
    /// The upper triangle of the stiffness over the free degrees of freedom, column by column.
    pub(crate) columns: Vec<usize>,
    pub(crate) rows: Vec<usize>,
    /// Positions of the diagonal entries.
    pub(crate) diagonal: Vec<usize>,
    stiffness: Gather,
    force: Gather,
    sweep: Gather,
    sizes: Vec<(usize, usize)>,
    measures: Vec<f64>,
    gradients: Vec<f64>,
    packed: Vec<f64>,
}

/// Energy, volume, and their gradients over all degrees of freedom.
#[derive(Debug, Clone, Default)]
pub(crate) struct Totals {
    pub(crate) energy: f64,
    pub(crate) volume: f64,
    pub(crate) force: Vec<f64>,
    pub(crate) sweep: Vec<f64>,
    /// Mean size of the terms summed in `force` and of the pressure's forces: the reference for residuals.
    pub(crate) scale: f64,
}

impl Assembly {
    pub(crate) fn new(sets: &[&dyn Elements], dofs: &Dofs) -> Result<Self, MembraneError> {
        Self::try_new(sets, dofs).map_err(|_| MembraneError::Memory { unknowns: dofs.free })
    }

    fn try_new(sets: &[&dyn Elements], dofs: &Dofs) -> Result<Self, TryReserveError> {
        let all = |of: &dyn Fn(usize) -> usize| sets.iter().map(|set| set.count() * of(set.each())).sum();
        let (mut force, mut sweep) = (with_room(all(&|each| 3 * each))?, with_room(all(&|each| 3 * each))?);
        let mut stiffness = with_room(all(&|each| packed(3 * each)))?;
        let (mut gradient_at, mut packed_at, mut count) = (0_usize, 0_usize, 0);
        let mut sizes = Vec::new();
        for set in sets {
            let own = 3 * set.each();
            sizes.push((set.count(), set.each()));
            for e in 0..set.count() {
                let all: Vec<u32> =
                    set.nodes(e).iter().flat_map(|node| dofs.nodes[*node as usize].dof).collect();
                for (i, dof) in all.iter().enumerate() {
                    if *dof != NONE {
                        force.push((*dof, short(gradient_at + i)));
                        sweep.push((*dof, short(gradient_at + own + i)));
                    }
                }
                gradient_at += 2 * own;
                // A set writes its blocks in this order.
                let nodes = set.each();
                let mut at = packed_at;
                for a in 0..nodes {
                    for k in 0..3 {
                        for b in a..nodes {
                            for l in if a == b { k } else { 0 }..3 {
                                let (i, j) = (all[3 * a + k], all[3 * b + l]);
                                if (i as usize) < dofs.free && (j as usize) < dofs.free {
                                    let entry = (i.max(j), i.min(j));
                                    grow(&mut stiffness)?;
                                    stiffness.push((entry, short(at)));
                                    // Two of its degrees of freedom are the same one, so both halves of the
                                    // matrix contribute to the diagonal.
                                    if i == j && (a, k) != (b, l) {
                                        grow(&mut stiffness)?;
                                        stiffness.push((entry, short(at)));
                                    }
                                }
                                at += 1;
                            }
                        }
                    }
                }
                packed_at += packed(own);
            }
            count += set.count();
        }
        let entries = sorted(dofs.free, stiffness)?;
        let (mut columns, mut rows) = (with_room(dofs.free + 1)?, Vec::new());
        columns.push(0_usize);
        let mut pairs = with_room(entries.len())?;
        let mut diagonal = with_room(dofs.free)?;
        let mut next = entries.into_iter().peekable();
        for column in 0..short(dofs.free) {
            let mut last = NONE;
            while let Some(((_, row), source)) = next.next_if(|((c, _), _)| *c == column) {
                if row != last {
                    grow(&mut rows)?;
                    rows.push(row as usize);
                    last = row;
                }
                pairs.push((short(rows.len() - 1), source));
            }
            if last != column {
                grow(&mut rows)?;
                rows.push(column as usize);
            }
            diagonal.push(rows.len() - 1);
            columns.push(rows.len());
        }
        Ok(Self {
            stiffness: Gather::new(rows.len(), &pairs)?,
            force: Gather::new(dofs.all, &force)?,
            sweep: Gather::new(dofs.all, &sweep)?,
            columns,
            rows,
            diagonal,
            sizes,
            measures: filled(2 * count, 0.0)?,
            gradients: filled(gradient_at, 0.0)?,
            packed: filled(packed_at, 0.0)?,
        })
    }

    /// Energy and volume.
    pub(crate) fn measure(&mut self, sets: &[&dyn Elements], place: Place<'_>) -> [f64; 2] {
        let mut left = &mut self.measures[..];
        for (set, (count, _)) in sets.iter().zip(&self.sizes) {
            let (own, rest) = left.split_at_mut(2 * count);
            set.measure(place, own);
            left = rest;
        }
        self.summed()
    }

    fn summed(&self) -> [f64; 2] {
        let mut sum = [0.0; 2];
        for pair in self.measures.chunks_exact(2) {
            sum[0] += pair[0];
            sum[1] += pair[1];
        }
        sum
    }

    /// Computes everything: `totals`, and the stiffness of energy - pressure volume at the positions of the
    /// pattern.
    pub(crate) fn work(
        &mut self,
        sets: &[&dyn Elements],
        place: Place<'_>,
        free: usize,
        totals: &mut Totals,
        matrix: &mut [f64],
    ) {
        let (mut measures, mut gradients, mut stiffness) =
            (&mut self.measures[..], &mut self.gradients[..], &mut self.packed[..]);
        for (set, (count, each)) in sets.iter().zip(&self.sizes) {
            let (m, m_rest) = measures.split_at_mut(2 * count);
            let (g, g_rest) = gradients.split_at_mut(6 * each * count);
            let (k, k_rest) = stiffness.split_at_mut(packed(3 * each) * count);
            set.work(place, Parts { measures: m, gradients: g, stiffness: k });
            (measures, gradients, stiffness) = (m_rest, g_rest, k_rest);
        }
        [totals.energy, totals.volume] = self.summed();
        totals.force.resize(self.force.entries(), 0.0);
        totals.sweep.resize(self.force.entries(), 0.0);
        self.force.sum(&self.gradients, &mut totals.force);
        self.sweep.sum(&self.gradients, &mut totals.sweep);
        self.stiffness.sum(&self.packed, matrix);
        totals.scale = self.scale(free, place.pressure);
    }

    /// The mean over the free degrees of freedom of the summed sizes of their forces.
    fn scale(&self, free: usize, pressure: f64) -> f64 {
        let mut sum = 0.0;
        for dof in 0..free {
            for (gather, weight) in [(&self.force, 1.0), (&self.sweep, pressure)] {
                let range = gather.starts[dof] as usize..gather.starts[dof + 1] as usize;
                for source in &gather.sources[range] {
                    sum += (weight * self.gradients[*source as usize]).abs();
                }
            }
        }
        sum / free.max(1) as f64
    }
}

/// An empty vector with capacity for `count` values.
fn with_room<T>(count: usize) -> Result<Vec<T>, TryReserveError> {
    let mut all = Vec::new();
    all.try_reserve_exact(count)?;
    Ok(all)
}

/// A vector of one value, or an error if there is too little memory.
pub(crate) fn filled<T: Clone>(count: usize, value: T) -> Result<Vec<T>, TryReserveError> {
    let mut all = with_room(count)?;
    all.resize(count, value);
    Ok(all)
}

/// Capacity for one more value; doubles it if necessary.
fn grow<T>(all: &mut Vec<T>) -> Result<(), TryReserveError> {
    if all.len() == all.capacity() { all.try_reserve(1) } else { Ok(()) }
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "checked when the structure is built: fewer than 2^32 numbers"
)]
fn short(count: usize) -> u32 {
    count as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// More elements than any memory can hold.
    #[derive(Debug)]
    struct Endless;

    impl Elements for Endless {
        fn count(&self) -> usize {
            1 << 44
        }
        fn nodes(&self, _: usize) -> &[u32] {
            &[0, 0, 0]
        }
        fn each(&self) -> usize {
            3
        }
        fn measure(&self, _: Place<'_>, _: &mut [f64]) {}
        fn work(&self, _: Place<'_>, _: Parts<'_>) {}
        fn hold(&mut self, _: Place<'_>) -> f64 {
            0.0
        }
        fn held(&mut self) -> Vec<&mut f64> {
            Vec::new()
        }
    }

    #[test]
    fn entries_are_sorted_and_sources_keep_their_order() {
        let entry = |i: u32| ((i * i % 7, i * 5 % 3), 100 - i);
        let entries: Vec<Entry> = (0..60).map(entry).collect();
        let mut expected = entries.clone();
        expected.sort_unstable();
        assert_eq!(sorted(9, entries).unwrap(), expected);
        let pairs: Vec<(u32, u32)> = (0..10).map(|i| (i % 3 * 2, i)).collect();
        let gather = Gather::new(6, &pairs).unwrap();
        assert_eq!(gather.starts, [0, 4, 4, 7, 7, 10, 10]);
        assert_eq!(gather.sources, [0, 3, 6, 9, 1, 4, 7, 2, 5, 8]);
    }

    #[test]
    fn too_many_elements_are_an_error() {
        let dofs = Dofs { nodes: Vec::new(), free: 7, all: 7, fittings: Vec::new() };
        let error = Assembly::new(&[&Endless], &dofs).err();
        assert_eq!(error, Some(MembraneError::Memory { unknowns: 7 }));
    }
}
