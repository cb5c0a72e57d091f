//! Tests in which loads were held while pressure and length changed.

use bulge_effects::Moment;
use bulge_measurements::is_weight;
use bulge_model::Record;
use bulge_numerics::vector::{add, dot};
use std::ops::Range;

/// The family of late readings of the force.
pub(crate) const LATE_FORCE: &str = "force-lag";
/// Part of a force's variance that goes with the contraction, from which it isn't that of a load that is held, however
/// little it changes.
const FOLLOWS: f64 = 0.5;
/// Fraction of the rows under held loads from which nothing else tells how late the force is.
const MOSTLY: f64 = 0.9;

/// Whether loads were held wherever pressure and length changed. The force is then the same at all times, and what a
/// model gives for it changes by the noise of the readings, which a filter would take away.
pub(crate) fn is_under_loads(record: &Record) -> bool {
    let moves = |rows: &&Range<usize>| {
        record.moments()[(*rows).clone()].iter().any(|m| m.direction != 0.0 && m.pressure_direction != 0.0)
    };
    let is_load = |rows: &Range<usize>| {
        let (force, moments) = (&record.force()[rows.clone()], &record.moments()[rows.clone()]);
        is_weight(force.iter().copied()) && goes_with_the_state(force, moments) < FOLLOWS
    };
    let under: usize =
        record.sweeps().iter().filter(moves).filter(|rows| is_load(rows)).map(Range::len).sum();
    under as f64 > MOSTLY * record.len() as f64
}

/// Part of the variance of a force that goes with contraction and pressure, linearly.
fn goes_with_the_state(force: &[f64], moments: &[Moment]) -> f64 {
    let centred = |values: Vec<f64>| {
        let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
        values.into_iter().map(|value| value - mean).collect::<Vec<f64>>()
    };
    let force = centred(force.to_vec());
    let e = centred(moments.iter().map(|moment| moment.contraction).collect());
    let mut p = centred(moments.iter().map(|moment| moment.pressure).collect());
    // What of the pressure doesn't go with the contraction.
    let along = dot(&p, &e) / dot(&e, &e).max(f64::MIN_POSITIVE);
    add(&mut p, -along, &e);
    let part = |column: &[f64]| dot(&force, column).powi(2) / dot(column, column).max(f64::MIN_POSITIVE);
    (part(&e) + part(&p)) / dot(&force, &force).max(f64::MIN_POSITIVE)
}
