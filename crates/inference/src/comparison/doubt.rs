//! Rows of unknown direction, weighted by how much the direction matters.

use bulge_model::Record;

use crate::comparison::analysis::Analysis;
use crate::comparison::floor::every;
use crate::comparison::levels::Levels;

/// The error of the other rows is reported as well if it is below this fraction of the error of all rows.
const WORTH_TELLING: f64 = 0.9;
/// Fewest rows of a branch that give its median.
const FEWEST: usize = 3;

/// The standard deviations of all rows. Rows of uncertain direction get the variance `sigma^2 + g^2` with the
/// gap `g` between the branches at their pressure, which is the error of a row that lies on the other branch.
///
/// The gap is the difference between the medians of the residuals while shortening and while lengthening
/// (filling and venting at held length). None if no gap is larger than the noise, as for a muscle without
/// friction.
///
/// `doubtful` are the rows in question, `stated` the standard deviations that the file states.
pub(crate) fn doubtful_sd(
    record: &Record,
    (doubtful, stated): (&[usize], Option<&[f64]>),
    used: &[bool],
    levels: &Levels,
    residuals: &[f64],
    sd_n: f64,
) -> Option<Vec<f64>> {
    if doubtful.is_empty() {
        return None;
    }
    let mut is_doubtful = vec![false; record.len()];
    for row in doubtful {
        is_doubtful[*row] = true;
    }
    let mut branches = vec![[Vec::new(), Vec::new()]; levels.len()];
    for (row, moment) in record.moments().iter().enumerate().step_by(every(record.len())) {
        if used[row] && !is_doubtful[row] && moment.branch() != 0.0 && residuals[row].is_finite() {
            branches[levels.at(row)][usize::from(moment.branch() < 0.0)].push(residuals[row]);
        }
    }
    let gaps: Vec<f64> = branches.into_iter().map(gap).collect();
    if gaps.iter().all(|gap| *gap <= sd_n) {
        return None;
    }
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
    /// RMS error \[N\] of the rows of known direction; none if no row has a reduced weight, or if the error
    /// isn't clearly below that of all rows, `all_n`.
    pub(crate) fn directed_rmse(&self, force: &[f64], all_n: f64) -> Option<f64> {
        if self.doubtful.is_empty() {
            return None;
        }
        let is_known = |row: &usize| self.doubtful.binary_search(row).is_err();
        let known = self.rows().filter(is_known).filter(|row| force[*row].is_finite());
        let error = |row: usize| self.record.force()[row] - force[row];
        let (rows, square) = known.fold((0_usize, 0.0), |(n, sum), row| (n + 1, sum + error(row).powi(2)));
        let directed_n = (square / rows.max(1) as f64).sqrt();
        (rows > 0 && directed_n < WORTH_TELLING * all_n).then_some(directed_n)
    }
}
