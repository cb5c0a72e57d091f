//! Experiments within the limits of a bench, from which the next one is chosen.

use bulge_model::Record;
use bulge_muscles::units::{rounded, significant};
use serde::Serialize;

use crate::comparison::levels::Levels;
use crate::protocol::bench::{Block, Path, Protocol};
use crate::vector::range;

/// Rows of each sweep of a proposal.
const ROWS: u32 = 60;

/// Limits of the next experiment; the ranges of the data if nothing is stated.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct NextLimits {
    /// Least and largest pressure \[Pa\].
    pub pressure_pa: Option<[f64; 2]>,
    /// Least and largest contraction.
    pub contraction: Option<[f64; 2]>,
}

/// The number of pressures as it appears in proposals.
const COUNTS: [&str; 8] = [
    ", at two pressures",
    " at the lowest and the highest pressure",
    " at two pressures",
    " at three pressures",
    ", at four pressures",
    " at six pressures",
    " at one pressure",
    " of eight pressures",
];

/// Highest gauge pressure \[Pa\], and contractions that a bench can set, as for a protocol.
const MOST_PRESSURE: f64 = 1e8;
const CONTRACTIONS: [f64; 2] = [-1.0, 0.6];

impl NextLimits {
    /// Checks whether a bench can keep within the limits.
    ///
    /// # Errors
    /// The name of the impossible limit, and what is wrong with it.
    pub fn check(&self) -> Result<(), (&'static str, String)> {
        let [least, most] = CONTRACTIONS;
        if let Some([low, high]) = self.pressure_pa
            && !(low > 0.0 && low < high && high <= MOST_PRESSURE)
        {
            let what = format!(
                "{low} to {high} Pa is not possible: gauge pressures lie above 0 and up to 1000 bar; write such as \"1 bar..6 bar\""
            );
            return Err(("pressure", what));
        }
        if let Some([low, high]) = self.contraction
            && !(low >= least && low < high && high <= most)
        {
            let what = format!(
                "{} to {} % is not possible: contractions lie within -100 % and 60 %; write such as \"0 %..20 %\"",
                significant(100.0 * low, 4),
                significant(100.0 * high, 4)
            );
            return Err(("contraction", what));
        }
        Ok(())
    }
}

/// The limits in effect.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Limits {
    pressure_pa: [f64; 2],
    contraction: [f64; 2],
    /// Period of one loop of the data \[s\].
    period_s: f64,
}

impl Limits {
    /// The stated limits, completed by the ranges of a record, which are rounded to what one sets on a bench.
    pub(crate) fn of(record: &Record, stated: NextLimits) -> Self {
        let range = |of: fn(&bulge_effects::Moment) -> f64| range(record.moments().iter().map(of));
        let levels = Levels::of(record, &vec![true; record.len()]);
        let [low, high] = range(|m| m.pressure);
        let kept = [levels.mean.first().copied().unwrap_or(low), levels.mean.last().copied().unwrap_or(high)];
        // The cycle number continues from sweep to sweep.
        let mut periods: Vec<f64> = record
            .sweeps()
            .iter()
            .map(|sweep| {
                let rows = || record.moments()[sweep.clone()].iter();
                let [first, last] = rows().fold([f64::INFINITY, 0.0], |[first, last]: [f64; 2], m| {
                    [first.min(m.cycle), last.max(m.cycle)]
                });
                rows().map(|m| m.time).fold(0.0, f64::max) / ((last - first).max(0.0).floor() + 1.0)
            })
            .collect();
        periods.sort_by(f64::total_cmp);
        let period = periods.get(periods.len() / 2).map_or(60.0, |period| period.clamp(1.0, 1e4));
        Self {
            pressure_pa: stated.pressure_pa.unwrap_or_else(|| kept.map(|pressure| rounded(pressure, 3))),
            contraction: stated.contraction.unwrap_or_else(|| settable_within(range(|m| m.contraction))),
            period_s: if record.has_time() { rounded(period, 2) } else { 60.0 },
        }
    }

    pub(crate) fn pressures_in_words(&self) -> String {
        let [low, high] = self.pressure_pa.map(|p| significant(p / 1e5, 3));
        if low == high { format!("at {low} bar") } else { format!("between {low} and {high} bar") }
    }

    pub(crate) fn contractions_in_words(&self) -> String {
        let [low, high] = self.contraction;
        format!("between {} and {} %", significant(100.0 * low, 2), significant(100.0 * high, 3))
    }

    /// A proposal in words, without its number of pressures if only one may be used.
    pub(crate) fn without_count(&self, says: &str) -> String {
        let one = self.pressures(2).len() == 1;
        let counts = COUNTS.iter().find(|counts| one && says.contains(**counts));
        counts.map_or_else(|| says.to_owned(), |counts| says.replacen(counts, "", 1))
    }

    fn pressures(&self, count: usize) -> Vec<f64> {
        let [low, high] = self.pressure_pa;
        if high - low <= 1e-3 * high {
            return vec![high];
        }
        (0..count).map(|i| low + (high - low) * i as f64 / (count - 1).max(1) as f64).collect()
    }
}

/// The range of contraction in steps of 0.1 % within a measured one; the measured one if it holds no step.
fn settable_within([low, high]: [f64; 2]) -> [f64; 2] {
    // A reading may lie a hair beside the step that was set.
    let hair = 1e-5;
    // The sum takes the sign off a zero.
    let steps = [(1e3 * low - hair).ceil() / 1e3 + 0.0, (1e3 * high + hair).floor() / 1e3];
    if steps[0] < steps[1] { steps } else { [low, high] }
}

/// A protocol with its description.
pub(crate) struct Proposal {
    pub(crate) says: &'static str,
    pub(crate) protocol: Protocol,
}

impl Proposal {
    /// Whether the muscle is held in between.
    pub(crate) fn holds(&self) -> bool {
        self.protocol.blocks.iter().any(|block| matches!(block.path, Path::Stairs { .. }))
    }
}

/// The experiments to choose from.
pub(crate) fn proposals(limits: &Limits) -> Vec<Proposal> {
    let [low, high] = limits.contraction;
    // A loop needs a range. If the force is unbounded at rest, evaluating the model reports it.
    let whole = [low, high.max(low + 0.01)];
    let block = |pressures: usize, contraction: [f64; 2], path: Path, period: f64, cycles: u32| Block {
        path,
        cycles,
        rows: ROWS,
        ..Block::loops(limits.pressures(pressures), contraction, period)
    };
    let slow = limits.period_s;
    let one = |says, blocks: Vec<Block>| Proposal { says, protocol: Protocol::new(blocks) };
    let third_of_stroke = [whole[0], whole[0] + (whole[1] - whole[0]) / 3.0];
    let small = [whole[0], (whole[0] + 0.25 * (high - whole[0])).max(whole[0] + 0.01)];
    vec![
        one(
            "loops at six pressures over the whole range of contraction",
            vec![block(6, whole, Path::Triangle, slow, 1)],
        ),
        one(
            "loops at the lowest and the highest pressure, three times each",
            vec![block(2, whole, Path::Triangle, slow, 3)],
        ),
        one(
            "the same loops, and then ten times slower, at two pressures",
            vec![block(2, whole, Path::Triangle, slow, 1), block(2, whole, Path::Triangle, 10.0 * slow, 1)],
        ),
        one(
            "the same loops, and then ten times faster, at two pressures",
            vec![block(2, whole, Path::Triangle, slow, 1), block(2, whole, Path::Triangle, slow / 10.0, 1)],
        ),
        one(
            "the same loops, and then ten times slower and ten times faster, at two pressures",
            [slow, 10.0 * slow, slow / 10.0]
                .map(|period| block(2, whole, Path::Triangle, period, 1))
                .to_vec(),
        ),
        one(
            "loops over a third of the stroke, and over all of it at the same speed, at two pressures",
            vec![
                block(2, third_of_stroke, Path::Triangle, slow / 3.0, 2),
                block(2, whole, Path::Triangle, slow, 1),
            ],
        ),
        one(
            "sines at three pressures, whose speed goes through 0 at the ends",
            vec![block(3, whole, Path::Sine, slow, 2)],
        ),
        one(
            "small loops near the largest force, at four pressures",
            vec![block(4, small, Path::Triangle, slow, 2)],
        ),
        one(
            "steps of contraction with holds of a minute, at two pressures",
            vec![block(2, whole, Path::Stairs { steps: 4, hold_s: 60.0 }, 8.0 * 70.0, 1)],
        ),
        one(
            "twelve loops at one pressure, one after the other",
            vec![block(1, whole, Path::Triangle, slow, 12)],
        ),
        one("a static map of eight pressures", vec![Block::map(limits.pressures(8), whole, 20)]),
    ]
    .into_iter()
    .chain(filled(limits, whole))
    .collect()
}

/// Experiments at held length in which the pressure rises and falls.
fn filled(limits: &Limits, whole: [f64; 2]) -> Vec<Proposal> {
    let slow = limits.period_s;
    let one = |says, blocks: Vec<Block>| Proposal { says, protocol: Protocol::new(blocks) };
    let [low_pressure, high_pressure] = limits.pressure_pa;
    let third = low_pressure.max(high_pressure / 3.0);
    let filling = |from: f64, lengths: u32, period: f64| {
        let from = from.min(0.9 * high_pressure);
        let held = (0..lengths)
            .map(|i| whole[0] + (whole[1] - whole[0]) * (0.1 + 0.8 * f64::from(i) / f64::from(lengths - 1)));
        let block = Block::isometric([from, high_pressure], held.collect(), period);
        Block { cycles: 2, rows: ROWS, ..block }
    };
    vec![
        one("filling and venting at three held lengths, twice each", vec![filling(low_pressure, 3, slow)]),
        one(
            "filling and venting at two held lengths, from the lowest pressure and from a third of the highest",
            vec![filling(low_pressure, 2, slow), filling(third, 2, slow)],
        ),
        one(
            "filling and venting at two held lengths, and then ten times slower",
            vec![filling(low_pressure, 2, slow), filling(low_pressure, 2, 10.0 * slow)],
        ),
        one(
            "filling and venting at two held lengths, and then ten times slower and ten times faster",
            [slow, 10.0 * slow, slow / 10.0].map(|period| filling(low_pressure, 2, period)).to_vec(),
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_of_readings_can_be_set_on_a_bench() {
        // Within a hair a step is reached; a range without a step stays.
        for (read, set) in [
            ([-0.0003, 0.14993], [0.0, 0.149]),
            ([0.01 + 1e-9, 0.2 - 1e-9], [0.01, 0.2]),
            ([0.0102, 0.0108], [0.0102, 0.0108]),
        ] {
            let found = settable_within(read);
            assert!((0..2).all(|i| (found[i] - set[i]).abs() < 1e-12), "{found:?}");
        }
    }

    #[test]
    fn with_one_pressure_no_proposal_speaks_of_several() {
        let limits = |high| Limits { pressure_pa: [2e5, high], contraction: [0.0, 0.2], period_s: 60.0 };
        for proposal in proposals(&limits(2e5)) {
            let says = limits(2e5).without_count(proposal.says);
            assert!(!says.contains("pressures") || says.contains("from the lowest pressure"), "{says}");
            let pressures = proposal.protocol.blocks.iter().filter(|block| block.held.is_empty());
            assert!(pressures.into_iter().all(|block| block.pressures_pa == [2e5]), "{says}");
            assert_eq!(limits(4e5).without_count(proposal.says), proposal.says);
        }
    }
}
