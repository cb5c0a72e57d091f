//! Tests under a held load: the error of the model in contraction.

use bulge_measurements::SweepKind;
use bulge_model::{Wanted, Warm};

use crate::comparison::analysis::{Analysis, Climbed};
use crate::comparison::document::{HeldLoad, HeldLoadPoint};

/// Most points of one sweep.
const MOST_POINTS: usize = 400;

/// The isotonic sweeps, with the contractions at which the first and the last rung bear the measured load, to
/// first order: `contraction + (F - F_model) / (dF_model/d contraction)`.
///
/// The force remains the quantity that is predicted and fitted, because with friction the contraction isn't
/// unique. Rows in which a model's force doesn't decrease with the contraction are left out.
pub(crate) fn held_loads(analysis: &Analysis<'_>, rungs: [&Climbed; 2]) -> Vec<HeldLoad> {
    let sweeps = analysis.data.sweeps();
    let isotonic = || sweeps.iter().filter(|sweep| sweep.kind == SweepKind::Isotonic);
    let mut counts = vec![false; analysis.record.len()];
    isotonic().for_each(|sweep| counts[sweep.rows.clone()].fill(true));
    counts.iter_mut().zip(&analysis.used.mask).for_each(|(counts, used)| *counts &= used);
    if !counts.contains(&true) {
        return Vec::new();
    }
    let wanted = Wanted { readings: true, ..Wanted::default() };
    let slopes = rungs.map(|rung| {
        let warm = Warm::of_rows(&counts);
        let found = rung.prepared.model.evaluate_partly(&analysis.record, &rung.theta, &wanted, &warm);
        found.map(|found| found.prediction.by_contraction).unwrap_or_default()
    });
    let (moments, measured) = (analysis.record.moments(), analysis.record.force());
    let bears = |which: usize, row: usize| {
        let slope = slopes[which].get(row).copied().filter(|slope| *slope < 0.0)?;
        let moved = moments[row].contraction + (measured[row] - rungs[which].force[row]) / slope;
        moved.is_finite().then_some(moved)
    };
    let held = |sweep: &bulge_measurements::Sweep| {
        let points: Vec<(HeldLoadPoint, f64)> = sweep
            .rows
            .clone()
            .filter(|row| counts[*row])
            .filter_map(|row| {
                let point = HeldLoadPoint {
                    pressure_pa: moments[row].pressure,
                    contraction: moments[row].contraction,
                    direction: moments[row].branch(),
                    first: bears(0, row)?,
                    last: bears(1, row)?,
                };
                Some((point, measured[row]))
            })
            .collect();
        let mean = |of: &dyn Fn(&(HeldLoadPoint, f64)) -> f64| {
            points.iter().map(of).sum::<f64>() / points.len().max(1) as f64
        };
        let rmse = |of: fn(&HeldLoadPoint) -> f64| mean(&|(p, _)| (p.contraction - of(p)).powi(2)).sqrt();
        let stride = points.len().div_ceil(MOST_POINTS).max(1);
        HeldLoad {
            sweep: sweep.name.clone(),
            specimen: analysis.record.specimens()[sweep.specimen as usize].clone(),
            load_n: mean(&|(_, force)| *force),
            rmse_contraction: [rmse(|p| p.first), rmse(|p| p.last)],
            points: points.iter().step_by(stride).map(|(point, _)| *point).collect(),
        }
    };
    isotonic().map(held).filter(|held| !held.points.is_empty()).collect()
}
