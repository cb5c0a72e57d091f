//! A channel that is shifted from some moment on, or for a sweep: a clamp that slipped, a sensor that was zeroed anew.
//! The force is as good a channel as the others, and what looks like creep or heat may be one step of the length.

use bulge_effects::Moment;
use bulge_measurements::Channel;
use bulge_model::Record;

use crate::diagnosis::channel::{name, shown, slopes};
use crate::diagnosis::trimmed::Linearised;
use crate::diagnosis::write::Findings;
use crate::vector::{count, minus};
use bulge_numerics::vector::dot;

/// Sum of squares that another explanation takes up over that of what was named, at least.
pub(crate) const AS_WELL: f64 = 0.8;
/// RMS of what is left over the noise, at most.
const NOISE: f64 = 1.2;
/// How much more it may be where a wrong reading has one number.
const NEARLY: f64 = 1.25;
/// Fraction of the rows that must be left: a few say nothing against the others.
const LEAST: f64 = 0.25;
/// Rows on either side of one at which another state may be set, and the least step as a fraction of the range.
const AROUND: usize = 2;
const STEP: f64 = 0.2;

/// A part of the rows that something else than an effect explains: a channel that is shifted, another specimen.
pub(crate) struct Otherwise {
    pub(crate) odd: Vec<bool>,
    /// What explains them, in words.
    pub(crate) says: String,
    /// Whether it explains as much as what was named,
    pub(crate) explains_all: bool,
    /// and clearly more, and begins where no other state was set.
    pub(crate) is_better: bool,
    /// Whether it leaves noise.
    pub(crate) leaves_noise: bool,
}

/// The shift of a channel that explains the data as well as what was named: in its window, or in all other rows.
/// The smaller part is left out first.
pub(crate) fn shifts(found: &Findings<'_>, linear: &Linearised) -> Vec<Otherwise> {
    let of = || {
        let (record, base) = (found.context.record, found.search.stages.first()?);
        let [pressure, motion, force] = slopes(found)?;
        let square = |force: &[f64]| {
            let left = minus(record.force(), force);
            dot(&left, &left)
        };
        let is_named = !found.claims().is_empty();
        let named =
            if is_named { square(&base.linear.force) - square(&found.last().linear.force) } else { 0.0 };
        let slopes = [(Channel::Pressure, pressure), (Channel::Motion, motion), (Channel::Force, force)];
        Some((linear.shift(&slopes, record.sweeps(), AS_WELL * named)?, named))
    };
    let Some((shift, named)) = of() else { return Vec::new() };
    let rows = found.context.record.len();
    let explains_all = shift.explained >= named;
    let is_better = shift.more > named && !is_another_state(found.context.record, shift.window.start);
    let leaves_noise = nearly_noise(found, shift.rest_n);
    let part = |is_window: bool| {
        let says = |(channel, by): &(Channel, f64)| {
            // The model's force needs another reading than the one that was taken.
            let by = if is_window { -by } else { *by };
            let side = if by > 0.0 { "much" } else { "little" };
            format!("the {} read {} too {side}", name(*channel), shown(*channel, by))
        };
        let says = shift.by.iter().map(says).collect::<Vec<String>>().join(" or ");
        let odd = (0..rows).map(|place| shift.window.contains(&place) == is_window).collect();
        Otherwise { odd, says, explains_all, is_better, leaves_noise }
    };
    let is_small = 2 * shift.window.len() <= rows;
    let leaves_enough = |part: &Otherwise| (rows - count(&part.odd)) as f64 >= LEAST * rows as f64;
    [part(is_small), part(!is_small)].into_iter().filter(leaves_enough).collect()
}

/// Whether an RMS misfit is no more than the noise \[N\].
pub(crate) fn is_noise(found: &Findings<'_>, rms_n: f64) -> bool {
    rms_n < NOISE * found.context.row_n.hypot(found.context.law.correlated_n)
}

/// Whether it is if one number may be a little wrong in its form.
pub(crate) fn nearly_noise(found: &Findings<'_>, rms_n: f64) -> bool {
    is_noise(found, rms_n / NEARLY)
}

/// Whether another state is set at a row: an effect of what is held then changes there as well.
fn is_another_state(record: &Record, row: usize) -> bool {
    let near = |other: usize| other.abs_diff(row) <= AROUND;
    if record.sweeps().iter().any(|sweep| near(sweep.start)) {
        return true;
    }
    let moments = record.moments();
    let part = |of: fn(&Moment) -> f64| {
        let range = |of: &[f64]| {
            let (low, high) =
                of.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x)));
            high - low
        };
        let values: Vec<f64> = moments.iter().map(of).collect();
        let end = (row + AROUND).min(values.len());
        range(&values[row.saturating_sub(AROUND)..end]) / range(&values).max(f64::MIN_POSITIVE)
    };
    part(|moment| moment.pressure) > STEP || part(|moment| moment.contraction) > STEP
}
