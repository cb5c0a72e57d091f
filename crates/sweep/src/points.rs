//! Evaluates a family at arbitrary points on all cores. The results keep the order of the points; each point
//! has either its outputs or the reason why it has none.

use bulge_muscles::Fault;
use rayon::prelude::*;
use std::ops::Range;

use crate::family::Family;
use crate::family_error::FamilyError;
use crate::member::{Asked, Member};
use crate::output::Output;

/// Points of one task. It is long enough (half a millisecond of the closed form) to hide the cost of a task,
/// and short enough to share and to stop.
const BLOCK: usize = 512;

/// Values of an axis at all points.
#[derive(Debug, Clone, Copy)]
pub enum Values<'a> {
    /// One value for all points.
    Same(f64),
    /// One value for each point.
    Each(&'a [f64]),
}

impl Values<'_> {
    fn at(&self, row: usize) -> f64 {
        match self {
            Self::Same(value) => *value,
            Self::Each(values) => values.get(row).copied().unwrap_or(f64::NAN),
        }
    }
}

/// Why a point has no outputs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reason {
    /// Index of the point.
    pub row: usize,
    /// Who is at fault.
    pub fault: Fault,
    /// The reason in a sentence.
    pub says: String,
}

/// Outputs at points.
#[derive(Debug, Clone, PartialEq)]
pub struct Points {
    /// Values in SI, one list for each output; NaN where a point has none.
    pub outputs: Vec<Vec<f64>>,
    /// Number of points without an equilibrium at which the muscle pulls.
    pub infeasible: usize,
    /// Reasons for the first of these points, in the order of the points.
    pub reasons: Vec<Reason>,
}

impl Points {
    fn new(outputs: usize) -> Self {
        Self { outputs: vec![Vec::new(); outputs], infeasible: 0, reasons: Vec::new() }
    }
}

/// Outputs of a family at `count` points; `axes` holds the values of its axes, in their order. Consecutive
/// points with the same muscle share its preparation.
///
/// `told` receives the number of points that were finished since the last call. It is called from several
/// threads, and also before each block. Only the first `most` points without equilibrium get a reason,
/// because sentences take more time and memory than numbers.
#[must_use]
pub fn evaluate(
    family: &Family,
    axes: &[Values<'_>],
    count: usize,
    outputs: &[Output],
    most: usize,
    told: &(dyn Fn(usize) + Sync),
) -> Points {
    let blocks: Vec<Points> = (0..count.div_ceil(BLOCK))
        .into_par_iter()
        .map(|i| {
            // If the caller has given up, this call unwinds, and the blocks that have not begun are never
            // computed.
            told(0);
            let rows = i * BLOCK..((i + 1) * BLOCK).min(count);
            let done = rows.len();
            let block = block(family, axes, rows, outputs, most);
            told(done);
            block
        })
        .collect();
    let mut all = Points::new(outputs.len());
    all.outputs.iter_mut().for_each(|column| column.reserve_exact(count));
    for block in blocks {
        for (column, part) in all.outputs.iter_mut().zip(block.outputs) {
            column.extend(part);
        }
        all.infeasible += block.infeasible;
        all.reasons.extend(block.reasons.into_iter().take(most - all.reasons.len()));
    }
    all
}

fn block(
    family: &Family,
    axes: &[Values<'_>],
    rows: Range<usize>,
    outputs: &[Output],
    most: usize,
) -> Points {
    let mut points = Points::new(outputs.len());
    points.outputs.iter_mut().for_each(|column| column.resize(rows.len(), f64::NAN));
    let (mut point, mut before) = (vec![0.0; axes.len()], vec![f64::NAN; axes.len()]);
    // Each muscle once, and the muscle and contraction of each row.
    let mut members: Vec<Result<Member, FamilyError>> = Vec::new();
    let mut placed = Vec::with_capacity(rows.len());
    for row in rows.clone() {
        for (x, axis) in point.iter_mut().zip(axes) {
            *x = axis.at(row);
        }
        if members.is_empty() || !family.is_same_member(&point, &before) {
            members.push(family.member(&point));
        }
        before.copy_from_slice(&point);
        placed.push((members.len() - 1, family.contraction(&point)));
    }
    let (mut asked, mut asked_rows) = (Vec::with_capacity(placed.len()), Vec::with_capacity(placed.len()));
    for (place, (member, contraction)) in placed.iter().enumerate() {
        if let Ok(member) = &members[*member] {
            asked.push(Asked { member, contraction: *contraction, end: None });
            asked_rows.push(place);
        }
    }
    let mut failed: Vec<Option<FamilyError>> = Vec::new();
    failed.resize_with(rows.len(), || None);
    Member::pulling_each(&asked, outputs, |i, found| match found {
        Ok(values) => {
            for (column, value) in points.outputs.iter_mut().zip(values) {
                column[asked_rows[i]] = *value;
            }
        }
        Err(error) => failed[asked_rows[i]] = Some(error),
    });
    for ((row, (member, _)), failed) in rows.zip(&placed).zip(&failed) {
        let Some(error) = members[*member].as_ref().err().or(failed.as_ref()) else { continue };
        points.infeasible += 1;
        if points.reasons.len() < most {
            points.reasons.push(Reason { row, fault: error.fault(), says: error.to_string() });
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::Quantity;
    use bulge_fibre::Approach;
    use bulge_muscles::preset;
    use std::sync::atomic::{AtomicUsize, Ordering};

    fn family() -> Family {
        let axes = vec![Quantity::Contraction, Quantity::Slenderness];
        Family::of(&preset("ppam-2-r16").unwrap(), Vec::new(), 1e5, Approach::Auto, axes).unwrap()
    }

    /// A point evaluated on its own gives the same bits, whatever points precede it.
    #[test]
    fn points_are_those_of_the_family() {
        let family = family();
        let outputs = [Output::Force, Output::Volume];
        let count = 2 * BLOCK + 17;
        let contraction: Vec<f64> = (0..count).map(|i| 0.02 + 0.3 * (i as f64 / count as f64)).collect();
        let slenderness: Vec<f64> = (0..count).map(|i| 4.0 + (i / 100 % 7) as f64).collect();
        let done = AtomicUsize::new(0);
        let axes = [Values::Each(&contraction), Values::Each(&slenderness)];
        let told = |more: usize| {
            done.fetch_add(more, Ordering::Relaxed);
        };
        let points = evaluate(&family, &axes, count, &outputs, 20, &told);
        assert_eq!((done.into_inner(), points.infeasible), (count, 0));
        for row in (0..count).step_by(97) {
            let point = [contraction[row], slenderness[row]];
            let mut values = [0.0; 2];
            family.member(&point).unwrap().outputs(point[0], &outputs, &mut values).unwrap();
            assert_eq!(values.map(f64::to_bits), [0, 1].map(|o| points.outputs[o][row].to_bits()));
        }
    }

    #[test]
    fn points_without_equilibrium_say_why() {
        let axes = [Values::Each(&[0.2, 0.6, 1.2, 0.1]), Values::Same(6.875)];
        let points = evaluate(&family(), &axes, 4, &[Output::Force], 20, &|_| ());
        // The faults are those of a single shape: no equilibrium beyond the limit, and no contraction by more
        // than the length.
        let faults: Vec<Fault> = points.reasons.iter().map(|reason| reason.fault).collect();
        assert_eq!(faults, [Fault::NoSolution, Fault::Input]);
        let axes = [Values::Each(&[0.2, 0.6, f64::NAN, 0.1]), Values::Same(6.875)];
        let points = evaluate(&family(), &axes, 4, &[Output::Force], 20, &|_| ());
        let places: Vec<usize> = points.reasons.iter().map(|reason| reason.row).collect();
        assert_eq!((places, points.infeasible), (vec![1, 2], 2));
        assert!(points.reasons[0].says.contains("limit"), "{:?}", points.reasons);
        assert!(points.outputs[0][1].is_nan() && points.outputs[0][2].is_nan());
        assert!((points.outputs[0][0] - 544.0).abs() < 0.1);
        assert!(evaluate(&family(), &axes, 0, &[Output::Force], 20, &|_| ()).outputs[0].is_empty());
        let far = vec![0.6; 3 * BLOCK];
        let axes = [Values::Each(&far), Values::Same(6.875)];
        let points = evaluate(&family(), &axes, far.len(), &[Output::Force], 3, &|_| ());
        let places: Vec<usize> = points.reasons.iter().map(|reason| reason.row).collect();
        assert_eq!((places, points.infeasible), (vec![0, 1, 2], far.len()));
    }
}
