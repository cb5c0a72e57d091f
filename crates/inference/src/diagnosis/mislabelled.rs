//! Rows under the name of another specimen: a stretch of the readings of one fits the numbers of another.

use bulge_measurements::{Data, Trace};
use bulge_model::{Wanted, Warm};
use bulge_muscles::shown::shortened;

use crate::diagnosis::event::MOST_SPECIMENS;
use crate::diagnosis::shift::{AS_WELL, Otherwise};
use crate::diagnosis::trimmed::{Linearised, by_chance};
use crate::diagnosis::write::Findings;
use crate::vector::minus;
use bulge_numerics::vector::dot;
use std::ops::Range;

/// Fewest rows of a stretch: it is chosen among all.
const FEWEST: usize = 5;

/// The stretch of one specimen's rows that fits the numbers of another best, if those explain it as well as what was
/// named explains all rows. No number is fitted for it.
pub(crate) fn mislabelled(found: &Findings<'_>, linear: &Linearised, data: &Data) -> Option<Otherwise> {
    let (record, base) = (found.context.record, found.search.stages.first()?);
    let count = u32::try_from(record.specimens().len()).ok().filter(|count| *count <= MOST_SPECIMENS)?;
    let is_length = matches!(data.motion(), Trace::Length(_));
    let own = minus(record.force(), &base.linear.force);
    let mut best: Option<(f64, u32, Vec<bool>, Vec<f64>)> = None;
    for other in (0..count).filter(|_| count > 1) {
        let of_other = record.clone().of_specimen(other, is_length);
        let (model, theta) = (&base.confirmed.prepared.model, &base.confirmed.theta);
        let force = model.evaluate_partly(&of_other, theta, &Wanted::default(), &Warm::new()).ok()?;
        let left = minus(record.force(), &force.prediction.force);
        let gain = |row: &usize| own[*row].powi(2) - left[*row].powi(2);
        for specimen in (0..count).filter(|specimen| *specimen != other) {
            let moments = record.moments().iter().enumerate();
            let rows: Vec<usize> =
                moments.filter(|(_, m)| m.specimen == specimen).map(|(row, _)| row).collect();
            let gains: Vec<f64> = rows.iter().map(gain).collect();
            let stretch = largest(&gains);
            let sum: f64 = gains[stretch.clone()].iter().sum();
            if stretch.len() >= FEWEST && best.as_ref().is_none_or(|(most, ..)| sum > *most) {
                let mut odd = vec![false; record.len()];
                rows[stretch].iter().for_each(|row| odd[*row] = true);
                best = Some((sum, other, odd, left.clone()));
            }
        }
    }
    let (_, other, odd, left) = best?;
    let square = |left: &[f64]| dot(left, left);
    let named = square(&own) - square(&minus(record.force(), &found.last().linear.force));
    let relabelled: Vec<f64> =
        (0..record.len()).map(|row| if odd[row] { left[row] } else { own[row] }).collect();
    // The numbers of the base were drawn to the rows of both.
    let gain = square(&own) - linear.square_of(&relabelled, &vec![true; record.len()])?;
    let chance = by_chance(&relabelled);
    let name = shortened(record.specimens().get(other as usize)?);
    let explains_more = gain - chance > named;
    (gain > AS_WELL * named && gain > chance).then(|| Otherwise {
        odd,
        says: format!("the specimen `{name}` was measured"),
        explains_more,
        is_better: explains_more,
    })
}

/// The stretch with the largest sum (Kadane 1984).
fn largest(values: &[f64]) -> Range<usize> {
    let (mut best, mut most) = (0..0, 0.0);
    let (mut start, mut sum) = (0, 0.0);
    for (place, value) in values.iter().enumerate() {
        if sum <= 0.0 {
            (start, sum) = (place, 0.0);
        }
        sum += value;
        if sum > most {
            (most, best) = (sum, start..place + 1);
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stretch_with_the_largest_sum_is_that_of_all_stretches() {
        let mut random = bulge_numerics::Random::new(4, 0);
        for length in 1..40 {
            let values: Vec<f64> = (0..length).map(|_| random.normal()).collect();
            let found: f64 = values[largest(&values)].iter().sum();
            let stretches = (0..length).flat_map(|start| (start..=length).map(move |end| start..end));
            let most = stretches.map(|stretch| values[stretch].iter().sum::<f64>()).fold(0.0, f64::max);
            assert!((found - most).abs() < 1e-12, "{length}: {found} {most}");
        }
        assert_eq!(largest(&[-1.0, -2.0]), 0..0);
    }
}
