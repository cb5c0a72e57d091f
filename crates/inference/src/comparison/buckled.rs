//! Rows at pressures too low for the muscle's rubber. The fibres are slack there and the muscle buckles, so
//! that the force carries no information about how it pulls.

use bulge_model::{Model, Record, Wanted, Warm};

use crate::comparison::rows::full_scale;

/// Measured forces below this fraction of full scale count as none.
const WEAK: f64 = 0.03;
/// Rows of the same sweep may buckle too if their contraction is this close to that of a buckled row
const NEAR: f64 = 0.01;
/// and their pressure is below its pressure times this factor: the muscle isn't exactly the stated one, and
/// equilibria near the limit aren't reliable.
const MARGIN: f64 = 1.3;
/// Largest fraction of the counting rows that may be left out. If a muscle is slack in more of them,
/// something else is wrong.
const MOST: f64 = 0.5;

/// Rows that count, at which the measured muscle hardly pulled and the model has no state or, while its
/// length is held and the pressure moves, would push; and the rows next to them.
pub(crate) fn buckled(model: &Model, record: &Record, used: &[bool]) -> Vec<usize> {
    let Ok(found) = model.evaluate_partly(record, &model.start(), &Wanted::default(), &Warm::of_rows(used))
    else {
        return Vec::new();
    };
    let moments = record.moments();
    let weak = WEAK * full_scale(record.force(), (0..record.len()).filter(|row| used[*row]));
    let is_held = |row: usize| moments[row].direction == 0.0 && moments[row].pressure_direction != 0.0;
    let force = &found.prediction.force;
    let is_slack = |row: &usize| force[*row].is_nan() || (force[*row] < 0.0 && is_held(*row));
    let is_weak = |row: &usize| used[*row] && record.force()[*row].abs() <= weak;
    let ends: Vec<usize> = (0..record.len()).filter(is_weak).filter(is_slack).collect();
    let mut rows = Vec::new();
    for sweep in record.sweeps() {
        // The rows at the highest pressures decide first; most others lie below one of them.
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

#[cfg(test)]
mod tests {
    use super::*;
    use bulge_effects::Moment;
    use bulge_muscles::from_toml;

    const HOSE: &str = "name = \"hose\"\nkind = \"braided\"\nlength = \"130 mm\"\nradius = \"7.5 mm\"\nbraid_angle = \"26 deg\"\nends = \"clamped\"\n\
                        wall = \"1.2 mm\"\n[effects.bladder-elasticity]\nc10 = \"0.25 MPa\"\n";

    /// Filled from 0.05 to 5 bar at 12 % and vented again; the muscle pulls where `pulls` is true.
    fn filled(held: bool, pulls: impl Fn(f64) -> bool) -> Record {
        let moment = |i: u32| {
            let bar = 0.05 * f64::from(if i < 100 { i + 1 } else { 200 - i });
            let direction = if i < 100 { 1.0 } else { -1.0 };
            let moment = Moment::at_rest(1e5 * bar, 0.12);
            if held {
                Moment { pressure_direction: direction, ..moment }
            } else {
                Moment { direction, ..moment }
            }
        };
        let moments: Vec<Moment> = (0..200).map(moment).collect();
        let force = moments.iter().map(|m| if pulls(m.pressure) { 1e-3 * m.pressure } else { 0.0 }).collect();
        Record::from_moments(moments, force, std::iter::once(0..200).collect()).unwrap()
    }

    #[test]
    fn slack_rows_at_low_pressure_are_left_out_and_others_are_not() {
        let model = Model::new(&from_toml(HOSE, "m.toml").unwrap());
        let begins = 1.3e5;
        let record = filled(true, |pressure| pressure > begins);
        let rows = buckled(&model, &record, &[true; 200]);
        // The model pulls from the pressure at which its force vanishes; a margin above it is left out as
        // well.
        let at = |row: usize| record.moments()[row].pressure;
        let pulls = (1..=100)
            .map(|i| 5e3 * f64::from(i))
            .find(|p| model.at_rest(&[], *p, 0.12).is_ok_and(|f| f.force_n >= 0.0));
        let first = pulls.unwrap().min(begins);
        let highest = rows.iter().map(|row| at(*row)).fold(0.0, f64::max);
        assert!(highest >= 1.2 * (first - 5e3) && highest <= 1.3 * first, "{highest} {first}");
        assert_eq!(rows.len(), (0..200).filter(|row| at(*row) <= highest).count());
        // Rows in which the measured muscle does pull are kept.
        assert!(buckled(&model, &record.clone().with_force(vec![200.0; 200]), &[true; 200]).is_empty());
        assert!(buckled(&model, &filled(true, |_| false), &[true; 200]).len() < 100);
    }
}
