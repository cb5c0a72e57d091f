//! Times that stand still, go back or pause.

use super::{Finding, FindingKind, Gate, Severity, rows_in_words};
use crate::resolution::median;
use crate::sweep::GAP;

pub(super) fn find(gate: &Gate) -> Vec<Finding> {
    let data = gate.data;
    let Some(time) = data.time() else { return Vec::new() };
    let is_labelled = data.columns().sweep.is_some();
    let (mut back, mut pauses, mut longest) = (Vec::new(), Vec::new(), 0.0_f64);
    for (i, sweep) in data.sweeps().iter().enumerate() {
        // Without labels a run begins where the clock goes back. If it goes back to before the previous run,
        // it was restarted; otherwise the rows are out of order.
        let before = i.checked_sub(1).map(|i| &data.sweeps()[i]);
        if let Some(before) = before
            && !is_labelled
            && before.specimen == sweep.specimen
            && data.line(before.rows.start).0 == data.line(sweep.rows.start).0
        {
            let (start, end, next) =
                (time[before.rows.start], time[before.rows.end - 1], time[sweep.rows.start]);
            if next > start && next < end {
                back.push(sweep.rows.start);
            } else if next > end {
                // A jump to another isobaric run isn't a pause.
                let mut steps: Vec<f64> = time[before.rows.clone()].windows(2).map(|w| w[1] - w[0]).collect();
                if next - end > GAP * median(&mut steps) {
                    pauses.push(sweep.rows.start);
                    longest = longest.max(next - end);
                }
            }
        }
        let times = &time[sweep.rows.clone()];
        let mut steps: Vec<f64> = times.windows(2).map(|w| w[1] - w[0]).filter(|step| *step > 0.0).collect();
        let pause = GAP * median(&mut steps);
        for (row, pair) in (sweep.rows.start + 1..).zip(times.windows(2)) {
            let step = pair[1] - pair[0];
            if step <= 0.0 {
                back.push(row);
            } else if step > pause {
                pauses.push(row);
                longest = longest.max(step);
            }
        }
    }
    // A clock that runs backwards makes every row a run.
    let starts = data.sweeps().iter().skip(1).map(|sweep| sweep.rows.start);
    let backwards: Vec<usize> = starts.filter(|row| time[*row] < time[*row - 1]).collect();
    if !is_labelled && 2 * backwards.len() > data.len() {
        back = backwards;
    }
    let severity = if is_labelled { Severity::Warning } else { Severity::Note };
    [
        gate.finding_if_any(
            FindingKind::TimeNotMonotone,
            Severity::Warning,
            &back,
            |count| format!("{}: the time is not later than in the row before", rows_in_words(count)),
            "sort the rows by time; give runs with a clock of their own a `sweep` label; write enough digits of the time",
        ),
        gate.finding_if_any(
            FindingKind::TimeGap,
            severity,
            &pauses,
            |count| {
                let pauses = if count == 1 { "pause" } else { "pauses" };
                format!("{count} {pauses} of more than {GAP} times the usual time between rows, the longest of {longest:.3} s")
            },
            if is_labelled {
                "give what comes after a pause a `sweep` label of its own: what happened in between is not known"
            } else {
                "nothing, if the muscle did not move: what comes after a pause is taken as a new run"
            },
        ),
    ]
    .into_iter()
    .flatten()
    .collect()
}
