//! Rows at pressures too low for the rubber of the muscle: its fibres are slack there, it buckles, and what it carries says nothing of how it pulls.

use bulge_model::{Model, Record, Wanted, Warm};

use crate::comparison::rows::full_scale;

/// A measured force below this part of full scale is none.
const WEAK: f64 = 0.03;
/// Rows of the same sweep within this contraction of a buckled one,
const NEAR: f64 = 0.01;
/// and below this many times its pressure, may buckle too: the muscle is not quite the one that is stated, and equilibria near their end decide nothing.
const MARGIN: f64 = 1.3;
/// Most rows that may be left out, as a part of those that count: of a muscle that is mostly slack something else is wrong.
const MOST: f64 = 0.5;

/// Rows that count at which the measured muscle hardly pulled, and the model has no state or, while its length is held and the pressure moves, would push; and those
/// next to them.
pub(crate) fn buckled(model: &Model, record: &Record, used: &[bool]) -> Vec<usize> {
    let Ok(found) = model.evaluate_partly(record, &model.start(), &Wanted::default(), &Warm::of_rows(used))
    else {
        return Vec::new();
    };
    let moments = record.moments();
    let weak = WEAK * full_scale(record.force());
    let is_held = |row: usize| moments[row].direction == 0.0 && moments[row].pressure_direction != 0.0;
    let force = &found.prediction.force;
    let is_slack = |row: &usize| force[*row].is_nan() || (force[*row] < 0.0 && is_held(*row));
    let is_weak = |row: &usize| used[*row] && record.force()[*row].abs() <= weak;
    let ends: Vec<usize> = (0..record.len()).filter(is_weak).filter(is_slack).collect();
    let mut rows = Vec::new();
    for sweep in record.sweeps() {
        // Those at the highest pressures decide; most of the others lie below one of them.
        let mut highest: Vec<usize> = ends.iter().copied().filter(|row| sweep.contains(row)).collect();
        highest.sort_by(|a, b| moments[*b].pressure.total_cmp(&moments[*a].pressure));
        let mut deciding: Vec<usize> = Vec::new();
        for row in highest {
            let is_below =
                |end: &usize| (moments[*end].contraction - moments[row].contraction).abs() <= 0.1 * NEAR;
            if !deciding.iter().any(is_below) {
                deciding.push(row);
            }
        }
        let is_buckled = |row: &usize| {
            deciding.iter().any(|end| {
                (moments[*end].contraction - moments[*row].contraction).abs() <= NEAR
                    && moments[*row].pressure <= MARGIN * moments[*end].pressure
            })
        };
        rows.extend(sweep.clone().filter(|row| used[*row]).filter(is_buckled));
    }
    let counted = used.iter().filter(|used| **used).count();
    if rows.len() as f64 > MOST * counted as f64 { Vec::new() } else { rows }
}
