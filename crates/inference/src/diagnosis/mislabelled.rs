//! Rows under the name of another specimen: a stretch of the readings of one fits the numbers of another.

use bulge_effects::Moment;
use bulge_measurements::{Channel, Data};
use bulge_muscles::Quantity;
use bulge_muscles::shown::shortened;

use crate::diagnosis::channel::{left_at, readings};
use crate::diagnosis::event::MOST_SPECIMENS;
use crate::diagnosis::shift::{AS_WELL, Otherwise, is_noise};
use crate::diagnosis::trimmed::{Linearised, by_chance};
use crate::diagnosis::write::Findings;
use crate::vector::minus;
use std::ops::Range;

/// Fewest rows of a stretch: it is chosen among all.
const FEWEST: usize = 5;

/// The stretch of one specimen's rows that fits the numbers of another best, if those explain it as well as what was
/// named explains all rows; its ends and the other specimen are chosen, and no number is fitted.
pub(crate) fn mislabelled(
    found: &Findings<'_>,
    linear: &Linearised,
    data: &Data,
    groups: &[Vec<usize>],
) -> Option<Otherwise> {
    let (record, base) = (found.context.record, found.search.stages.first()?);
    let count = u32::try_from(record.specimens().len()).ok().filter(|count| *count <= MOST_SPECIMENS)?;
    let length = base.confirmed.prepared.model.muscle().length().si();
    let own = minus(record.force(), &base.linear.force);
    let mut best: Option<(f64, u32, Range<usize>, Vec<f64>)> = None;
    for other in (0..count).filter(|_| count > 1) {
        let contraction = |(place, moment): (usize, &Moment)| {
            let row = groups.get(place).and_then(|group| group.first()).copied().unwrap_or(place);
            data.contraction_as(other, row, moment.contraction, length)
        };
        let contraction: Vec<f64> = record.moments().iter().enumerate().map(contraction).collect();
        let pressure = readings(record, Channel::Pressure);
        let of_other = record.clone().at(&pressure, &contraction).of_specimen(other);
        let left = left_at(found, &of_other)?;
        for rows in record.moments().chunk_by(|a, b| a.specimen == b.specimen).scan(0, |end, rows| {
            *end += rows.len();
            Some(*end - rows.len()..*end)
        }) {
            if record.moments()[rows.start].specimen == other {
                continue;
            }
            // Where the other specimen has no state it explains nothing.
            let gain = |row: usize| {
                own[row].powi(2) - if left[row].is_finite() { left[row].powi(2) } else { f64::INFINITY }
            };
            let gains: Vec<f64> = rows.clone().map(gain).collect();
            let stretch = largest(&gains);
            let sum: f64 = gains[stretch.clone()].iter().sum();
            if stretch.len() >= FEWEST && best.as_ref().is_none_or(|(most, ..)| sum > *most) {
                best = Some((sum, other, rows.start + stretch.start..rows.start + stretch.end, left.clone()));
            }
        }
    }
    let (_, other, stretch, left) = best?;
    let odd: Vec<bool> = (0..record.len()).map(|row| stretch.contains(&row)).collect();
    let relabelled: Vec<f64> =
        (0..record.len()).map(|row| if odd[row] { left[row] } else { own[row] }).collect();
    // All with the numbers of the base drawn to them.
    let all = vec![true; record.len()];
    let [before, named, gain] = [&own, &minus(record.force(), &found.last().linear.force), &relabelled]
        .map(|left| linear.square_of(left, &all));
    let left_n = (gain? / record.len() as f64).sqrt();
    let named = if found.claims().is_empty() { before } else { named };
    let (named, gain) = (before? - named?, before? - gain?);
    let chance = by_chance(&relabelled);
    let name = shortened(record.specimens().get(other as usize)?);
    // Where nothing is named, half of the misfit, or all but noise.
    let is_enough = || Some(2.0 * gain > before? || is_noise(found, left_n));
    let is_as_good = if named > 0.0 { gain > AS_WELL * named } else { is_enough()? };
    let is_so = 2 * stretch.len() <= record.len() && is_as_good && gain > chance;
    is_so.then(|| Otherwise {
        odd,
        says: format!("the specimen `{name}` was measured"),
        explains_all: gain >= named,
        is_better: gain - chance > named,
        leaves_noise: is_noise(found, left_n),
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
