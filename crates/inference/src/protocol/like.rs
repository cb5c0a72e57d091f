//! Approximate reconstruction of the test behind some measurements: what its sweeps held, and over which
//! ranges they went.

use bulge_measurements::{Data, History, Sweep, SweepKind};
use bulge_muscles::units::rounded;
use std::collections::BTreeMap;
use std::ops::Range;

use crate::median::median;
use crate::protocol::bench::{Block, Path, Protocol};
use crate::vector::range;

/// Most levels of a block; if more were measured, some are chosen that are spread over their range.
const MOST_LEVELS: usize = 8;
/// Least and largest number of rows of a cycle.
const ROWS: Range<f64> = 8.0..1000.0;
/// Levels, and ends of ranges, are alike within this fraction of the total range.
const ALIKE: f64 = 0.05;
/// The mean rate of a sine is 2/pi of its largest rate, that of a triangle equals it. A ratio below this
/// limit, about halfway between, means a sine.
const EVEN: f64 = 0.82;
/// Time of a cycle \[s\] if none was measured.
const USUAL_PERIOD: f64 = 60.0;

/// Motion of one sweep.
struct Moved {
    pressure: [f64; 2],
    contraction: [f64; 2],
    rows: usize,
    seconds: f64,
    /// Number of monotonic strokes.
    ways: usize,
    /// Mean rate over largest rate; none if the rates are 0.
    evenness: Option<f64>,
}

fn ends_of(ranges: impl Iterator<Item = [f64; 2]> + Clone) -> [f64; 2] {
    [range(ranges.clone().map(|range| range[0]))[0], range(ranges.map(|range| range[1]))[1]]
}

fn width([low, high]: [f64; 2]) -> f64 {
    (high - low).max(0.0)
}

fn middle([low, high]: [f64; 2]) -> f64 {
    f64::midpoint(low, high)
}

impl Moved {
    fn of(sweep: &Sweep, (pressure, contraction): (&[f64], &[f64]), history: &History) -> Self {
        let rows = sweep.rows.clone();
        let of = |values: &[f64]| range(values[rows.clone()].iter().copied());
        let ways = rows.clone().map(|row| history.approach[row]).filter(|way| *way != 0.0);
        let turns = ways.clone().zip(ways.skip(1)).filter(|(a, b)| a * b < 0.0).count();
        let mut rates: Vec<f64> = rows.clone().map(|row| history.rate[row].abs()).collect();
        rates.sort_by(f64::total_cmp);
        let largest = rates.get(rates.len() * 19 / 20).copied().unwrap_or(0.0);
        Self {
            pressure: of(pressure),
            contraction: of(contraction),
            rows: rows.len(),
            // A reading stands for the time until the next one.
            seconds: width(of(&history.time)) * rows.len() as f64 / (rows.len() as f64 - 1.0).max(1.0),
            ways: turns + 1,
            evenness: (largest > 0.0).then(|| rates.iter().sum::<f64>() / rates.len() as f64 / largest),
        }
    }
}

/// Distinct values in ascending order, rounded as a person would set them; if there are many, some that are
/// spread over their range.
fn levels(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    let (Some(first), Some(last)) = (sorted.first(), sorted.last()) else { return Vec::new() };
    let apart = ALIKE * (last - first).max(ALIKE * last.abs());
    let mut groups: Vec<Vec<f64>> = vec![vec![*first]];
    for value in &sorted[1..] {
        match groups.last_mut() {
            Some(group) if value - group[0] <= apart => group.push(*value),
            _ => groups.push(vec![*value]),
        }
    }
    let means: Vec<f64> =
        groups.iter().map(|group| rounded(group.iter().sum::<f64>() / group.len() as f64, 2)).collect();
    if means.len() <= MOST_LEVELS {
        return means;
    }
    (0..MOST_LEVELS).map(|place| means[place * (means.len() - 1) / (MOST_LEVELS - 1)]).collect()
}

/// Contractions rounded as a person would set them, to a tenth of a percent.
fn contractions(range: [f64; 2]) -> [f64; 2] {
    range.map(|value| (value * 1e3).round() / 1e3)
}

fn pressures(range: [f64; 2]) -> Vec<f64> {
    range.map(|value| rounded(value.max(1e3), 2)).to_vec()
}

/// A count, clamped to a range.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to small numbers")]
fn count(value: f64, range: Range<f64>) -> u32 {
    value.round().clamp(range.start, range.end) as u32
}

/// The block with the median motion of its sweeps.
fn moving(block: Block, sweeps: &[&Moved], kept: usize) -> Block {
    let of = |value: &dyn Fn(&Moved) -> f64| {
        median(&mut sweeps.iter().map(|sweep| value(sweep)).collect::<Vec<_>>())
    };
    // A stroke each way is one cycle; a single stroke is completed by the one back.
    let cycles = count(of(&|sweep| sweep.ways as f64 / 2.0), 1.0..1e4);
    let period = of(&|sweep| 2.0 * sweep.seconds / sweep.ways as f64);
    let mut evenness: Vec<f64> = sweeps.iter().filter_map(|sweep| sweep.evenness).collect();
    let evenness = (!evenness.is_empty()).then(|| median(&mut evenness));
    Block {
        path: if evenness.is_some_and(|evenness| evenness < EVEN) { Path::Sine } else { Path::Triangle },
        cycles,
        period_s: if period > 0.0 { rounded(period, 2) } else { USUAL_PERIOD },
        rows: count(of(&|sweep| 2.0 * sweep.rows as f64 / sweep.ways as f64), ROWS),
        repeats: count(sweeps.len() as f64 / kept.max(1) as f64, 1.0..1e4),
        ..block
    }
}

impl Protocol {
    /// Reconstructs the test behind some measurements, approximately, for one specimen and without noise.
    /// Sweeps that hold pressures over the same range form one block, as do those that hold their length.
    /// Numbers are rounded as a person would set them. `l0` is the length of the unpressurised muscle \[m\].
    ///
    /// Loops under a held load become loops at pressures from the range that they covered, because a protocol
    /// holds pressures or lengths. A static map without time becomes one with the mean number of contractions
    /// at each pressure. Data without rows give no block.
    #[must_use]
    pub fn like(data: &Data, l0: f64) -> Self {
        let (pressure, contraction, history) = (data.pressure(), data.contraction(l0), data.history(l0));
        let specimens = data.specimens().len().max(1);
        if data.is_empty() {
            return Self::new(Vec::new());
        }
        if !data.is_path() {
            let at = levels(pressure.iter().copied().filter(|p| *p > 0.0));
            let each = data.len() as f64 / (at.len().max(1) * specimens) as f64;
            let range = contractions(range(contraction.iter().copied()));
            let map = Block::map(at, range, count(each, 2.0..ROWS.end));
            return Self::new(vec![map]);
        }
        let moved = |sweep: &Sweep| Moved::of(sweep, (pressure, &contraction), &history);
        let of_first = data.sweeps().iter().filter(|sweep| sweep.specimen == data.sweeps()[0].specimen);
        let (held, other): (Vec<_>, Vec<_>) = of_first
            .map(|sweep| (sweep.kind, moved(sweep)))
            .partition(|(kind, _)| *kind == SweepKind::Isometric);
        let mut blocks = Vec::new();
        let all = ends_of(other.iter().map(|(_, sweep)| sweep.contraction));
        // Group by the ends of the contraction range, rounded to steps within which they are alike.
        let mut alike: BTreeMap<Vec<i64>, Vec<&Moved>> = BTreeMap::new();
        let mut under_load: Vec<&Moved> = Vec::new();
        for (kind, sweep) in &other {
            if *kind == SweepKind::Isotonic {
                under_load.push(sweep);
                continue;
            }
            #[expect(clippy::cast_possible_truncation, reason = "small")]
            let step = |value: f64| (value / (ALIKE * width(all)).max(1e-4)).round() as i64;
            alike.entry(sweep.contraction.map(step).to_vec()).or_default().push(sweep);
        }
        if alike.len() > MOST_LEVELS {
            // There are too many groups: merge them into one.
            alike = BTreeMap::from([(Vec::new(), alike.into_values().flatten().collect())]);
        }
        for sweeps in alike.into_values() {
            let at = levels(sweeps.iter().map(|sweep| middle(sweep.pressure)).filter(|p| *p > 0.0));
            let kept = at.len();
            let range = contractions(ends_of(sweeps.iter().map(|sweep| sweep.contraction)));
            blocks.push(moving(Block::loops(at, range, USUAL_PERIOD), &sweeps, kept));
        }
        if !under_load.is_empty() {
            let [low, high] = ends_of(under_load.iter().map(|sweep| sweep.pressure));
            let at = levels([low, f64::midpoint(low, high), high].into_iter().filter(|p| *p > 0.0));
            let range = contractions(ends_of(under_load.iter().map(|sweep| sweep.contraction)));
            blocks.push(moving(Block::loops(at, range, USUAL_PERIOD), &under_load, under_load.len()));
        }
        if !held.is_empty() {
            let sweeps: Vec<&Moved> = held.iter().map(|(_, sweep)| sweep).collect();
            let at = levels(sweeps.iter().map(|sweep| middle(sweep.contraction)));
            let kept = at.len();
            let [low, high] = ends_of(sweeps.iter().map(|sweep| sweep.pressure));
            let range = pressures([low, high]);
            let block = Block::isometric([range[0], range[1]], at, USUAL_PERIOD);
            blocks.push(moving(block, &sweeps, kept));
        }
        blocks.retain(|block| !block.pressures_pa.is_empty());
        Self::new(blocks)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::protocol::simulation::simulate;
    use bulge_model::Model;
    use bulge_muscles::{Quantity, preset};

    /// The test that is reconstructed from the simulated data of another one.
    fn again(blocks: Vec<Block>) -> Vec<Block> {
        let muscle = preset("dmsp-20-250").unwrap();
        let found = simulate(&Model::new(&muscle), &[], &Protocol::new(blocks), 7).unwrap();
        Protocol::like(&found.data, muscle.length().si()).blocks
    }

    #[test]
    fn a_test_is_found_again_in_what_it_measures() {
        let loops = Block { cycles: 2, ..Block::loops(vec![2e5, 4e5], [0.01, 0.15], 50.0) };
        let sine = Block { path: Path::Sine, repeats: 3, ..Block::loops(vec![3e5], [0.0, 0.1], 20.0) };
        for blocks in [
            vec![loops.clone()],
            vec![sine.clone()],
            vec![Block::isometric([1e5, 5e5], vec![0.02, 0.1], 30.0)],
            vec![Block::map(vec![1e5, 2e5, 3e5], [0.0, 0.2], 12)],
        ] {
            assert_eq!(again(blocks.clone()), blocks);
        }
        let both = again(vec![loops.clone(), sine.clone()]);
        assert!(both.contains(&loops) && both.contains(&sine), "{both:?}");
    }
}
