//! Offsets between runs that repeat each other.

use super::{Finding, FindingKind, Gate, Severity};

/// An offset isn't chance beyond this many of its standard deviations,
const DEVIATIONS: f64 = 4.0;
/// and it matters beyond this fraction of the force's range and beyond the noise of one reading.
const RANGE: f64 = 2e-3;

pub(super) fn find(gate: &Gate) -> Vec<Finding> {
    let l0 = gate.options.l0_m.filter(|l0| *l0 > 0.0).unwrap_or(gate.data.structure.scale);
    let repeats = gate.data.repeats(l0);
    let Some(error) = repeats.pure_error() else { return Vec::new() };
    let matters = error.sd_n.max(RANGE * gate.force.range);
    let (mut rows, mut worst) = (Vec::new(), 0.0_f64);
    for group in repeats.groups() {
        for (run, offset) in group.runs.iter().skip(1).zip(&group.offsets) {
            let size = offset.mean_n.abs();
            if offset.points > 2 && size > DEVIATIONS * offset.sd_n && size > matters {
                rows.extend(run.rows.clone());
                worst = if size > worst.abs() { offset.mean_n } else { worst };
            }
        }
    }
    rows.sort_unstable();
    rows.dedup();
    let says = |_| {
        format!(
            "runs differ by up to {worst:.3} N from the one before that they repeat, against a noise of {:.3} N",
            error.sd_n
        )
    };
    let instead = "warm the muscle up before measuring, check the zero of the load cell, or include what drifts (creep, softening, temperature)";
    let found = gate.finding_if_any(FindingKind::RepeatDrift, Severity::Warning, &rows, says, instead);
    found.into_iter().collect()
}
