//! Rows whose direction isn't known: they count by how much the direction matters.

use bulge_measurements::Data;
use bulge_model::Record;

/// Fewer rows of a branch say nothing about its place.
const FEWEST: usize = 3;

/// Gives rows whose direction is in doubt the variance that the doubt makes: `sigma^2 + g^2` with the gap `g` between the branches at their pressure, by which a
/// row is off that lies on the other branch.
///
/// The gap is that of the medians of the residuals while shortening and while lengthening. A muscle without friction has none, and loses nothing.
pub(crate) fn doubt_directions(
    record: &mut Record,
    data: &Data,
    used: &[bool],
    levels: &[usize],
    residuals: &[f64],
    sd_n: f64,
) {
    let doubtful = data.direction_in_doubt();
    if doubtful.is_empty() {
        return;
    }
    let mut is_doubtful = vec![false; record.len()];
    for row in &doubtful {
        is_doubtful[*row] = true;
    }
    let count = levels.iter().copied().max().map_or(0, |last| last + 1);
    let mut branches = vec![[Vec::new(), Vec::new()]; count];
    for (row, moment) in record.moments().iter().enumerate() {
        if used[row] && !is_doubtful[row] && moment.direction != 0.0 && residuals[row].is_finite() {
            branches[levels[row]][usize::from(moment.direction < 0.0)].push(residuals[row]);
        }
    }
    let gaps: Vec<f64> = branches.into_iter().map(gap).collect();
    if gaps.iter().all(|gap| *gap <= sd_n) {
        return;
    }
    let stated = record.force_sd().map(<[f64]>::to_vec);
    let sd = (0..record.len()).map(|row| {
        let own = stated.as_ref().map_or(sd_n, |sd| sd[row]);
        if is_doubtful[row] { own.hypot(gaps[levels[row]]) } else { own }
    });
    let sd = sd.collect();
    *record = record.clone().with_force_sd(sd);
}

fn gap(branches: [Vec<f64>; 2]) -> f64 {
    if branches.iter().any(|branch| branch.len() < FEWEST) {
        return 0.0;
    }
    let [shortening, lengthening] = branches.map(|mut branch| {
        let middle = branch.len() / 2;
        *branch.select_nth_unstable_by(middle, f64::total_cmp).1
    });
    (lengthening - shortening).abs()
}
