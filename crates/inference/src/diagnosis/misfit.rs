//! The systematic part of a model's residuals: its size in newtons, and the variables on which it depends.

use statrs::distribution::{ChiSquared, ContinuousCDF};

use crate::diagnosis::document::Located;
use crate::diagnosis::linearised_model::{Direction, LinearisedModel};
use crate::diagnosis::smooth::Variable;
use bulge_numerics::Random;
use bulge_numerics::vector::{add, dot};

/// Draws for the interval of the misfit.
const DRAWS: usize = 400;

/// RMS of the systematic misfit \[N\], and its 95 % interval.
///
/// The smooth functions that the model can't follow have the coordinates z_j with variance 1 each; the mean
/// square of their sum exceeds the true one by sum |f_j|^2 in expectation.
pub(crate) fn misfit(linear: &LinearisedModel, seed: u64) -> (f64, [f64; 2]) {
    let n = linear.force.len() as f64;
    let coordinates: Vec<f64> = linear.smooth.iter().map(|d| dot(&d.unit, &linear.z)).collect();
    let excess: f64 = linear.smooth.iter().map(|d| dot(&d.values, &d.values)).sum::<f64>() / n;
    let sum = linear.systematic(&linear.z);
    let found = (dot(&sum, &sum) / n - excess).max(0.0).sqrt();
    let stride = (linear.force.len() / 500).max(1);
    let thin: Vec<Direction> = linear
        .smooth
        .iter()
        .map(|d| Direction {
            values: d.values.iter().step_by(stride).copied().collect(),
            unit: Vec::new(),
            ..*d
        })
        .collect();
    let rows = linear.force.len().div_ceil(stride) as f64;
    let mut random = Random::new(seed, 77);
    let mut drawn: Vec<f64> = (0..DRAWS)
        .map(|_| {
            let mut sum = vec![0.0; thin.first().map_or(0, |d| d.values.len())];
            for (direction, part) in thin.iter().zip(&coordinates) {
                let part = part + random.normal();
                add(&mut sum, part, &direction.values);
            }
            (dot(&sum, &sum) / rows - 2.0 * excess).max(0.0).sqrt()
        })
        .collect();
    drawn.sort_by(f64::total_cmp);
    let at = |part: usize| drawn.get(part * drawn.len() / 1000).copied().unwrap_or(found);
    (found, [at(25).min(found), at(975).max(found)])
}

/// Variables on which the misfit depends: share of the excess over chance, and p-value (Holm 1979), the
/// largest share first.
pub(crate) fn located(linear: &LinearisedModel) -> Vec<Located> {
    let mut found: Vec<((&str, &str), f64, f64, f64)> = Vec::new();
    for (variable, name, says) in Variable::ALL {
        let squares: Vec<f64> = linear
            .smooth
            .iter()
            .filter(|d| d.variable == variable)
            .map(|d| dot(&d.unit, &linear.z).powi(2))
            .collect();
        if squares.is_empty() {
            continue;
        }
        let (sum, count) = (squares.iter().sum::<f64>(), squares.len() as f64);
        let p = ChiSquared::new(count).map_or(1.0, |chi| chi.sf(sum));
        found.push(((name, says), (sum - count).max(0.0), p, 1.0));
    }
    let whole: f64 = found.iter().map(|f| f.1).sum();
    let mut order: Vec<usize> = (0..found.len()).collect();
    order.sort_by(|a, b| found[*a].2.total_cmp(&found[*b].2));
    let mut largest: f64 = 0.0;
    for (rank, place) in order.iter().enumerate() {
        largest = largest.max((found[*place].2 * (found.len() - rank) as f64).min(1.0));
        found[*place].3 = largest;
    }
    found.sort_by(|a, b| b.1.total_cmp(&a.1));
    found
        .into_iter()
        .filter(|f| f.1 > 0.0)
        .map(|((name, says), excess, _, p)| Located {
            variable: name.to_owned(),
            share: if whole > 0.0 { excess / whole } else { 0.0 },
            p,
            says: says.to_owned(),
        })
        .collect()
}
