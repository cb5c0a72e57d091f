//! Rows whose direction isn't known: they count by how much the direction matters.

use bulge_measurements::Data;
use bulge_model::Record;

use crate::comparison::analysis::Analysis;
use crate::comparison::levels::Levels;
use crate::comparison::residuals::rmse;

/// The error of the other rows is told beside that of all where it is lower than this part of it.
const WORTH_TELLING: f64 = 0.9;
/// Fewer rows of a branch say nothing about its place.
const FEWEST: usize = 3;

/// Standard deviations of all rows, where those whose direction is in doubt have the variance that the doubt makes: `sigma^2 + g^2` with the gap `g` between the branches at their pressure, by which a
/// row is off that lies on the other branch.
///
/// The gap is that of the medians of the residuals while shortening and while lengthening (filling and venting at held length). A muscle without friction has none, and loses nothing: none then.
pub(crate) fn doubtful_sd(
    record: &Record,
    data: &Data,
    used: &[bool],
    levels: &Levels,
    residuals: &[f64],
    sd_n: f64,
) -> Option<Vec<f64>> {
    let doubtful = data.direction_in_doubt();
    if doubtful.is_empty() {
        return None;
    }
    let mut is_doubtful = vec![false; record.len()];
    for row in &doubtful {
        is_doubtful[*row] = true;
    }
    let mut branches = vec![[Vec::new(), Vec::new()]; levels.len()];
    for (row, moment) in record.moments().iter().enumerate() {
        if used[row] && !is_doubtful[row] && moment.branch() != 0.0 && residuals[row].is_finite() {
            branches[levels.at(row)][usize::from(moment.branch() < 0.0)].push(residuals[row]);
        }
    }
    let gaps: Vec<f64> = branches.into_iter().map(gap).collect();
    if gaps.iter().all(|gap| *gap <= sd_n) {
        return None;
    }
    // What the file states, not what the record may have from an earlier comparison.
    let stated = data.force_sd();
    let sd = |row: usize| {
        let own = stated.map_or(sd_n, |sd| sd[row]);
        if is_doubtful[row] { own.hypot(gaps[levels.at(row)]) } else { own }
    };
    Some((0..record.len()).map(sd).collect())
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

impl Analysis<'_> {
    /// RMS error \[N\] of the rows whose direction is known; none where rows in doubt count like the others, or where the error is about that of all rows.
    pub(crate) fn directed_rmse(&self, force: &[f64]) -> Option<f64> {
        let sd = self.record.force_sd()?;
        let stated = self.data.force_sd();
        let counts_less = |row: usize| sd[row] > 1.001 * stated.map_or(self.noise.force_n, |own| own[row]);
        let mut is_known = self.used.mask.clone();
        for row in self.data.direction_in_doubt() {
            is_known[row] &= !counts_less(row);
        }
        let of = |rows: &[bool]| rmse(self, force, &|row| rows[row]);
        let [directed, all] = [&is_known, &self.used.mask].map(|rows| of(rows));
        directed.filter(|directed| all.is_some_and(|all| *directed < WORTH_TELLING * all))
    }
}
