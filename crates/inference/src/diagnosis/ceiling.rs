//! A reading that bends below a ceiling: an amplifier that saturates, a sensor beyond its range.

use bulge_measurements::{Channel, Data};
use bulge_model::Record;

use crate::comparison::rows::lines;
use crate::diagnosis::channel::{name, readings, shown, slopes};
use crate::diagnosis::trimmed::Linearised;
use crate::diagnosis::write::Findings;
use crate::diagnosis::wrong_channel::WrongChannel;
use crate::vector::rms;

/// Quantiles of the readings at which they may begin to bend.
const KNEES: [f64; 7] = [0.6, 0.7, 0.75, 0.8, 0.85, 0.9, 0.95];
/// How near to the ceiling the largest reading is, over the way from the knee.
const NEAR: [f64; 4] = [0.4, 0.7, 0.9, 0.97];
/// RMS misfit with the readings put right over that without.
const FALLS: f64 = 0.45;
/// RMS misfit with a ceiling of the one channel over that with one of the other, up to which both are said.
const ALIKE: f64 = 1.05;
/// What is named where a sensor of the force bends, and the RMS misfit over what that leaves of a ceiling that can't be told
/// from it.
const FORCE: &str = "force-nonlinearity";
const AS_WELL: f64 = 1.0;
/// Standard deviation of what the largest reading lacks, over that reading.
const LACKS: f64 = 0.1;

/// A channel whose readings approach a ceiling.
struct Ceiling {
    channel: Channel,
    /// Reading from which they bend, and what the largest one lacks.
    knee: f64,
    lacks: f64,
    /// RMS of what is left once they are put right \[N\].
    left_n: f64,
}

/// The ceiling that leaves least, where nothing is named or a bend of the force.
pub(crate) fn ceiling(
    found: &Findings<'_>,
    linear: &Linearised,
    data: &Data,
    groups: &[Vec<usize>],
) -> Option<WrongChannel> {
    let record = found.context.record;
    let claims = found.claims();
    if claims.iter().any(|(name, _)| *name != FORCE) {
        return None;
    }
    let before = rms(&linear.left(&vec![true; record.len()])?);
    // No length ends for a sensor of it: it would be clipped where the rig stops.
    let [pressure, _, force] = slopes(found)?;
    let of = |(channel, slope): (Channel, Vec<f64>)| {
        Ceiling::of(linear, channel, &slope, &readings(record, channel), before)
    };
    let mut tried: Vec<Ceiling> =
        [(Channel::Pressure, pressure), (Channel::Force, force)].into_iter().filter_map(of).collect();
    tried.sort_by(|a, b| a.left_n.total_cmp(&b.left_n));
    let left_n = tried.first()?.left_n;
    let alike = tried.iter().filter(|one| one.left_n < ALIKE * left_n);
    let says = format!(
        "nothing is left{}{}: does a sensor or an amplifier saturate there, or does an effect begin? Repeat the test with a sensor of a larger range",
        if claims.is_empty() { String::new() } else { format!(", as with {FORCE},") },
        alike.map(|one| one.says(record, data, groups)).collect::<Vec<_>>().join(", or"),
    );
    Some(WrongChannel { left_n, of_misfit: FALLS, of_named: AS_WELL, is_curve: true, says })
}

impl Ceiling {
    /// The one that leaves least of those whose largest reading is too small.
    fn of(
        linear: &Linearised,
        channel: Channel,
        slope: &[f64],
        values: &[f64],
        noise_n: f64,
    ) -> Option<Self> {
        let all = vec![true; values.len()];
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        let highest = *sorted.last()?;
        let width = LACKS * highest.abs();
        let tried = KNEES.into_iter().flat_map(|knee| NEAR.map(|near| (quantile(&sorted, knee), near)));
        let each = tried.filter(|(knee, _)| *knee < highest).filter_map(|(knee, near)| {
            let lacking = |value: &f64| lacking(((value - knee) / (highest - knee)).max(0.0), near);
            let column: Vec<f64> =
                slope.iter().zip(values).map(|(slope, value)| slope * lacking(value)).collect();
            let lacks = linear.one_more(std::slice::from_ref(&column), width, noise_n)?.pop()?.number;
            let left_n = rms(&linear.with(vec![column], Some([0.0, width])).left(&all)?);
            (lacks > 0.0).then_some(Self { channel, knee, lacks, left_n })
        });
        each.min_by(|a, b| a.left_n.total_cmp(&b.left_n))
    }

    fn says(&self, record: &Record, data: &Data, groups: &[Vec<usize>]) -> String {
        let values = readings(record, self.channel);
        let bent = groups.iter().zip(&values).filter(|(_, value)| **value > self.knee);
        let rows: Vec<usize> = bent.flat_map(|(group, _)| group.iter().copied()).collect();
        format!(
            " if the readings of the {} bend below a ceiling, from {} on and by {} at the largest (line {})",
            name(self.channel),
            shown(self.channel, self.knee),
            shown(self.channel, self.lacks),
            lines(data, &rows),
        )
    }
}

/// What a reading lacks, over what the largest one does, if readings follow room * tanh(more/room) above the knee; `part` is its way
/// from the knee to the largest reading, which lies at `near` of the room.
fn lacking(part: f64, near: f64) -> f64 {
    let atanh = |part: f64| (near * part).atanh() / near - part;
    atanh(part) / atanh(1.0)
}

/// A quantile of sorted values.
fn quantile(sorted: &[f64], part: f64) -> f64 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an index")]
    let place = (part * sorted.len() as f64) as usize;
    sorted[place.min(sorted.len() - 1)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_reading_lacks_below_a_ceiling_is_what_the_amplifier_took() {
        // From 4 on 4 + 2 tanh((x - 4)/2); the largest is 7.
        let read = |x: f64| 4.0 + 2.0 * ((x - 4.0_f64) / 2.0).tanh();
        let [highest, near] = [read(7.0), 1.5_f64.tanh()];
        for x in [4.0, 4.5, 5.0, 6.2, 7.0] {
            let part = (read(x) - 4.0) / (highest - 4.0);
            let taken = (7.0 - highest) * lacking(part, near);
            assert!((read(x) + taken - x).abs() < 1e-12, "{x}: {taken}");
        }
    }
}
