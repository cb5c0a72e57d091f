//! Readings of a channel, as a record holds them: what the base would leave of others, and words for them.

use bulge_effects::Moment;
use bulge_measurements::Channel;
use bulge_model::{Record, Wanted, Warm};
use bulge_muscles::units::significant;
use std::ops::Range;

use crate::diagnosis::trimmed::Linearised;
use crate::diagnosis::write::Findings;
use crate::vector::minus;

/// Most pairs of fits and choices of the parts that are wrong.
const ROUNDS: usize = 30;

/// Readings of a channel.
pub(crate) fn readings(record: &Record, channel: Channel) -> Vec<f64> {
    let of = |state: fn(&Moment) -> f64| record.moments().iter().map(state).collect();
    match channel {
        Channel::Pressure => of(|moment| moment.pressure),
        Channel::Motion => of(|moment| moment.contraction),
        Channel::Force => record.force().to_vec(),
    }
}

/// What a record holds of a channel.
pub(crate) fn name(channel: Channel) -> &'static str {
    if channel == Channel::Motion { "contraction" } else { channel.name() }
}

/// The size of a change of a reading, with its unit.
pub(crate) fn shown(channel: Channel, by: f64) -> String {
    let (scale, unit) = match channel {
        Channel::Pressure => (1e5, "bar"),
        Channel::Motion => (0.01, "points"),
        Channel::Force => (1.0, "N"),
    };
    format!("{} {unit}", significant((by / scale).abs(), 2))
}

/// Derivatives of the base's force by pressure and contraction, and what the force reads too little.
pub(crate) fn slopes(found: &Findings<'_>) -> Option<[Vec<f64>; 3]> {
    let (record, base) = (found.context.record, found.search.stages.first()?);
    let wanted = Wanted { parameters: Vec::new(), readings: true };
    let at = &base.confirmed;
    let slopes = at.prepared.model.evaluate_warm(record, &at.theta, &wanted, &Warm::new()).ok()?;
    // A force that reads too much is no change of the model's.
    Some([slopes.by_pressure, slopes.by_contraction, vec![-1.0; record.len()]])
}

/// The rows of a channel whose readings are others, as far as that lowers the misfit.
pub(crate) struct PutRight {
    pub(crate) wrong: Vec<bool>,
    /// What the base leaves with the others, its numbers drawn to them \[N\].
    pub(crate) left: Vec<f64>,
}

impl PutRight {
    /// Chooses the parts that are wrong and draws the numbers of the base to them, in turns. Where another reading has no
    /// state, the one that was taken is right.
    pub(crate) fn of(
        found: &Findings<'_>,
        linear: &Linearised,
        (channel, others): (Channel, &[f64]),
        parts: &[Range<usize>],
    ) -> Option<Self> {
        let own = minus(found.context.record.force(), &found.search.stages.first()?.linear.force);
        let mut by = minus(&left_of(found, channel, others)?, &own);
        by.iter_mut().filter(|by| !by.is_finite()).for_each(|by| *by = 0.0);
        let all = vec![true; own.len()];
        let mut weight: Vec<f64> = vec![0.0; own.len()];
        for part in parts {
            weight[part.clone()].fill(0.5);
        }
        let mut left = Vec::new();
        for _ in 0..ROUNDS {
            let residual: Vec<f64> =
                own.iter().zip(&by).zip(&weight).map(|((own, by), weight)| own + weight * by).collect();
            left = linear.left_of(&residual, &all)?;
            let mut next = vec![0.0; own.len()];
            for part in parts {
                let squares = part.clone().fold([0.0, 0.0], |[right, wrong], row| {
                    let own = left[row] - weight[row] * by[row];
                    [right + own * own, wrong + (own + by[row]).powi(2)]
                });
                next[part.clone()].fill(if squares[1] < squares[0] { 1.0 } else { 0.0 });
            }
            if next == weight {
                break;
            }
            weight = next;
        }
        Some(Self { wrong: weight.iter().map(|weight| *weight > 0.5).collect(), left })
    }
}

/// What the base leaves with other readings of a channel \[N\]; not finite where it has no state.
fn left_of(found: &Findings<'_>, channel: Channel, others: &[f64]) -> Option<Vec<f64>> {
    let (record, base) = (found.context.record, found.search.stages.first()?);
    let [pressure, contraction] = match channel {
        Channel::Force => return Some(minus(others, &base.linear.force)),
        Channel::Pressure => [others, &readings(record, Channel::Motion)],
        Channel::Motion => [&readings(record, Channel::Pressure), others],
    };
    left_at(found, &record.clone().at(pressure, contraction))
}

/// What the base leaves at other moments of a record with the same forces \[N\]; not finite where it has no state.
pub(crate) fn left_at(found: &Findings<'_>, moments: &Record) -> Option<Vec<f64>> {
    let base = &found.search.stages.first()?.confirmed;
    let (model, theta) = (&base.prepared.model, &base.theta);
    let force = model.evaluate_partly(moments, theta, &Wanted::default(), &Warm::new()).ok()?;
    Some(minus(found.context.record.force(), &force.prediction.force))
}
