//! Forces at and below zero: the muscle is slack, or the zero of the load cell is off.

use super::clipping::expected;
use super::{Finding, FindingKind, Gate, QualityOptions, Severity, rows_in_words};
use crate::data::Data;
use std::ops::Range;

/// Forces within this fraction of the largest count as near zero.
const NEAR_ZERO: f64 = 1e-3;
/// Upper limit of that level relative to the largest force: in a map with random set points, differences of
/// neighbours aren't noise.
const SMALL: f64 = 0.05;
/// Pressures above this fraction of the largest should give a force.
const PRESSURE: f64 = 0.02;
/// Fewest consecutive readings near zero that are more than a zero crossing.
const RUN: usize = 3;
/// Expected change of the force, relative to the level near zero, from which the muscle is slack.
const STEPS: f64 = 5.0;
/// A negative force beyond this fraction of the largest isn't noise.
const NEGATIVE: f64 = 0.01;

impl Data {
    /// Rows in which the muscle didn't pull, in ascending order: it moved on at zero force, or the force was
    /// clearly negative. No model of a pulling muscle applies to them.
    #[must_use]
    pub fn not_pulling(&self) -> Vec<usize> {
        if self.is_empty() {
            return Vec::new();
        }
        let options = QualityOptions::default();
        let gate = Gate::new(self, &options);
        let (mut rows, _) = near_zero(&gate, level(&gate));
        rows.extend(pushing_rows(&gate).1);
        rows.sort_unstable();
        rows.dedup();
        rows
    }
}

/// Forces up to this level count as zero \[N\].
fn level(gate: &Gate) -> f64 {
    let noise = (4.0 * gate.force.noise).min(SMALL * gate.largest_force);
    noise.max(gate.force.step).max(NEAR_ZERO * gate.largest_force)
}

pub(super) fn find(gate: &Gate) -> Vec<Finding> {
    let level = level(gate);
    let (slack, free) = near_zero(gate, level);
    let within = format!("zero force (within {level:.3} N)");
    let hung = gate.finding_if_any(
        FindingKind::Slack,
        Severity::Warning,
        &slack,
        |count| format!("{} that moved on at {within}: the muscle was slack", rows_in_words(count)),
        "keep the row at which the force becomes zero (the free contraction), remove the rest",
    );
    let stopped = gate.finding_if_any(
        FindingKind::Slack,
        Severity::Note,
        &free,
        |count| {
            format!("{} with {within} at positive pressure: perhaps free contractions", rows_in_words(count))
        },
        "nothing, if the muscle just stopped pulling there; remove rows in which it hung slack",
    );
    [hung, stopped, pushing(gate)].into_iter().flatten().collect()
}

/// Rows near zero force at pressure: those that move on there, and those that don't (or have no order).
fn near_zero(gate: &Gate, level: f64) -> (Vec<usize>, Vec<usize>) {
    let data = gate.data;
    // If no force was measured at all, there is no zero to stay at.
    let is_near_zero = |row: usize| {
        level < gate.largest_force
            && data.force()[row].abs() <= level
            && data.pressure()[row] > PRESSURE * gate.largest_pressure
    };
    let (mut slack, mut free): (Vec<usize>, Vec<usize>) = (Vec::new(), Vec::new());
    if !data.is_path() {
        free.extend((0..data.len()).filter(|row| is_near_zero(*row)));
        return (slack, free);
    }
    for (sweep, _) in data.paths() {
        let mut take = |run: Range<usize>| {
            if run.len() >= RUN {
                let is_slack = expected(gate, &run) > STEPS * level;
                if is_slack { slack.extend(run) } else { free.extend(run) }
            }
        };
        let mut start = None;
        for row in sweep.rows.clone() {
            match (is_near_zero(row), start) {
                (true, None) => start = Some(row),
                (false, Some(first)) => {
                    take(first..row);
                    start = None;
                }
                _ => {}
            }
        }
        if let Some(first) = start {
            take(first..sweep.rows.end);
        }
    }
    (slack, free)
}

/// Clearly negative forces, and their rows.
fn pushing_rows<'a>(gate: &Gate<'a>) -> (&'a [f64], Vec<usize>) {
    let force = gate.data.force();
    let below = (5.0 * gate.force.noise).max(NEGATIVE * gate.largest_force);
    (force, (0..force.len()).filter(|row| force[*row] < -below).collect())
}

fn pushing(gate: &Gate) -> Option<Finding> {
    let (force, rows) = pushing_rows(gate);
    let says = |count| {
        let lowest = rows.iter().map(|row| force[*row]).fold(0.0, f64::min);
        format!("{} with a pushing force, down to {lowest:.3} N", rows_in_words(count))
    };
    gate.finding_if_any(
        FindingKind::NegativeForce,
        Severity::Warning,
        &rows,
        says,
        "a muscle only pulls: check zero and sign of the load cell, or remove the rows if the rig pushed",
    )
}
