//! A channel that is wrong in a way of its own, in all rows or in some, whatever the muscle does: put right, it leaves nothing
//! but noise.

use bulge_measurements::Data;

use crate::diagnosis::backwards::backwards;
use crate::diagnosis::ceiling::ceiling;
use crate::diagnosis::shift::nearly_noise;
use crate::diagnosis::stuck_bit::stuck_bit;
use crate::diagnosis::trimmed::Linearised;
use crate::diagnosis::write::Findings;
use crate::vector::{minus, rms};

/// RMS misfit with the readings put right over that without, below which it need not be noise: the numbers of the base are far
/// from theirs if the readings are, and follow on a straight line.
const SURELY: f64 = 0.2;

/// What is left once a channel is put right.
pub(crate) struct WrongChannel {
    /// RMS misfit \[N\].
    pub(crate) left_n: f64,
    /// What it may be at most of the misfit if nothing is named, and of what the effects that were named leave.
    pub(crate) of_misfit: f64,
    pub(crate) of_named: f64,
    /// Whether the readings follow a curve, which an effect of the muscle may be like.
    pub(crate) is_curve: bool,
    /// What is wrong, where, and what to do.
    pub(crate) says: String,
}

/// What is said of the channel that leaves least: a bit is stuck, it stands in the reverse order, or it bends below a ceiling
/// where nothing is named.
pub(crate) fn wrong_channel(
    found: &Findings<'_>,
    linear: &Linearised,
    data: &Data,
    groups: &[Vec<usize>],
) -> Option<String> {
    let bends = || ceiling(found, linear, data, groups).filter(|_| found.claims().is_empty());
    likeliest(
        found,
        linear,
        [stuck_bit(found, linear, data, groups), backwards(found, linear, data, groups), bends()],
    )
}

/// What is said of a channel that bends below a ceiling, which leaves no more than what was named.
pub(crate) fn bent_channel(
    found: &Findings<'_>,
    linear: &Linearised,
    data: &Data,
    groups: &[Vec<usize>],
) -> Option<String> {
    likeliest(found, linear, [ceiling(found, linear, data, groups)])
}

/// The one that leaves least, if that is noise: much less than what no effect explains, or no more than what was named leaves.
fn likeliest<const N: usize>(
    found: &Findings<'_>,
    linear: &Linearised,
    tried: [Option<WrongChannel>; N],
) -> Option<String> {
    let record = found.context.record;
    let before = rms(&linear.left(&vec![true; record.len()])?);
    let named = rms(&minus(record.force(), &found.last().linear.force));
    let is_named = !found.claims().is_empty();
    let is_it = |one: &WrongChannel| {
        let enough = match (is_named, one.is_curve) {
            (false, _) => one.of_misfit * before,
            (true, true) => one.of_named * named,
            (true, false) => (one.of_named * named).min(one.of_misfit * before),
        };
        let is_sure = !one.is_curve && one.left_n < SURELY * before;
        one.left_n < enough && (is_sure || nearly_noise(found, one.left_n))
    };
    let best = tried.into_iter().flatten().filter(is_it).min_by(|a, b| a.left_n.total_cmp(&b.left_n));
    best.map(|best| best.says)
}
