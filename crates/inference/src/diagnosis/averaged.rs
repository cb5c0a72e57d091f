//! Shortens a long record to means of neighbouring rows, which keep a slowly varying misfit and average the
//! noise.

use bulge_model::Record;
use std::ops::Range;

use crate::comparison::levels::Levels;
use crate::comparison::tails::{self, ways};
use crate::noise::inputs::Scatter;
use crate::vector::minus;

/// Means of each stroke from one reversal to the next, if it has enough rows; fewer would hide the shape of
/// the loop.
const PARTS: usize = 16;
/// Most means that this may lead to.
const MOST_PARTS: usize = 5_000;
/// Cycles of each sweep that are always kept: the first one lacks a history, and pure error needs two others.
const FEWEST_CYCLES: f64 = 3.0;
/// Fewest rows of a group for a straight line of its own.
const LINE: usize = 4;
/// A group whose scatter is this multiple of the usual variance, and beyond this normal quantile (exceeded by
/// chance once in 30 000), contains something other than noise.
const ODD: [f64; 2] = [3.0, 4.0];

/// A record of means, and the rows behind each of them.
#[derive(Debug, Clone)]
pub(crate) struct Averaged {
    /// Means of the rows that count; their forces are those of [`Averaged::forces`].
    pub(crate) record: Record,
    /// Rows of the long record in each mean.
    pub(crate) groups: Vec<Vec<usize>>,
    /// Stretches in which the muscle moves one way, as ranges of groups; none in a static map.
    stretches: Vec<Range<usize>>,
}

impl Averaged {
    /// About `most` means of the used rows, each within one sweep, one specimen and one direction. If there
    /// are no more rows than that, each row is its own mean. A record of many cycles gets more means, so that
    /// each stroke keeps its shape.
    ///
    /// The rows of a static map have no order: their neighbours are those of the same pressure level and
    /// nearly the same contraction.
    pub(crate) fn of(record: &Record, used: &[bool], levels: &Levels, most: usize) -> Option<Self> {
        let rows = used.iter().filter(|counts| **counts).count();
        let size = rows.div_ceil(most.max(1)).max(1);
        let kept = (size > 1 && record.is_path()).then(|| first_cycles(record, used, levels)).flatten();
        let used = kept.as_deref().unwrap_or(used);
        let size = used.iter().filter(|counts| **counts).count().div_ceil(most.max(1)).max(1);
        let mut groups: Vec<Vec<usize>> = Vec::new();
        let mut sweeps: Vec<Range<usize>> = Vec::new();
        let least = if size > 1 && record.is_path() { parts_of_ways(record, used, levels) } else { 1 };
        let mut stretches = Vec::new();
        for sweep in record.sweeps() {
            let start = groups.len();
            let mut rows: Vec<usize> = sweep.clone().filter(|row| used[*row]).collect();
            if size > 1 && !record.is_path() {
                sort_as_map(&mut rows, record, levels);
            }
            for run in ways(&rows, record, levels) {
                let parts = run.len().div_ceil(size).max(least.min(run.len()));
                let first = groups.len();
                groups.extend(
                    (0..parts).map(|i| run[i * run.len() / parts..(i + 1) * run.len() / parts].to_vec()),
                );
                if record.is_path() {
                    stretches.push(first..groups.len());
                }
            }
            if groups.len() > start {
                sweeps.push(start..groups.len());
            }
        }
        let force = groups.iter().map(|group| mean(group, record.force())).collect();
        let averaged = record.averaged(&groups, force, sweeps)?;
        Some(Self { record: averaged, groups, stretches })
    }

    /// Number of rows in each mean.
    pub(crate) fn counts(&self) -> impl Iterator<Item = f64> {
        self.groups.iter().map(|group| group.len() as f64)
    }

    /// Means of values of the long record.
    pub(crate) fn means(&self, values: &[f64]) -> Vec<f64> {
        self.groups.iter().map(|group| mean(group, values)).collect()
    }

    /// The forces of the means: the model's force at the mean row plus the mean residual. In this way the
    /// curvature within a group that the model already describes isn't taken for a misfit. Outliers among the
    /// residuals are bounded first, see [`Averaged::bounded`].
    pub(crate) fn forces(&self, record: &Record, model: &[f64], at_means: &[f64]) -> Vec<f64> {
        let residual = self.bounded(&minus(record.force(), model));
        self.means(&residual).iter().zip(at_means).map(|(residual, force)| residual + force).collect()
    }

    /// Scatter of the residuals within the groups: sum of squares about a straight line through each group,
    /// and its degrees of freedom. A misfit is nearly straight within a group and doesn't count as scatter; a
    /// group with a reversal or a spike is left out. Groups of two or three rows have no line of their own:
    /// along a path, second differences of three rows at a time replace them.
    pub(crate) fn within(&self, residual: &[f64]) -> (f64, f64) {
        let bounded = self.bounded(residual);
        let mut all: Vec<Scatter> = self.scatters(&bounded).into_iter().flatten().collect();
        for stretch in &self.stretches {
            let groups = &self.groups[stretch.clone()];
            if groups.iter().all(|group| group.len() < LINE) && groups.iter().any(|group| group.len() > 1) {
                let rows: Vec<f64> = groups.iter().flatten().map(|row| bounded[*row]).collect();
                let square =
                    |w: &[f64]| Scatter { sum: (w[0] - 2.0 * w[1] + w[2]).powi(2) / 6.0, freedom: 1.0 };
                all.extend(rows.chunks_exact(3).map(square));
            }
        }
        let is_usual = usual(&all);
        let kept = all.iter().filter(|one| is_usual(one));
        kept.fold((0.0, 0.0), |(sum, freedom), one| (sum + one.sum, freedom + one.freedom))
    }

    /// The scatter of each group as in [`Averaged::within`]; none for groups that are left out there or have
    /// no line.
    pub(crate) fn within_each(&self, residual: &[f64]) -> Vec<Option<Scatter>> {
        let found = self.scatters(&self.bounded(residual));
        let is_usual = usual(&found.iter().flatten().copied().collect::<Vec<_>>());
        found.into_iter().map(|one| one.filter(|one| is_usual(one))).collect()
    }

    fn scatters(&self, bounded: &[f64]) -> Vec<Option<Scatter>> {
        let least = if self.stretches.is_empty() { 2 } else { LINE };
        let of = |group: &Vec<usize>| scatter(group, bounded).filter(|_| group.len() >= least);
        self.groups.iter().map(of).collect()
    }
}

/// Whether the scatter of a group is within chance of the usual one.
fn usual(all: &[Scatter]) -> impl Fn(&Scatter) -> bool + use<> {
    let mut sorted: Vec<&Scatter> = all.iter().collect();
    sorted.sort_by(|a, b| (a.sum / a.freedom).total_cmp(&(b.sum / b.freedom)));
    let middle = sorted.get(sorted.len() / 2);
    let middle = middle.map_or(0.0, |one| one.sum / one.freedom / of_freedom(one.freedom, 0.0));
    move |one| one.sum <= middle * one.freedom * of_freedom(one.freedom, ODD[1]).max(ODD[0])
}

/// Quantile of chi-squared over its degrees of freedom, at the probability of a normal quantile (Wilson and
/// Hilferty 1931).
fn of_freedom(freedom: f64, normal: f64) -> f64 {
    let spread = 2.0 / (9.0 * freedom);
    (1.0 - spread + normal * spread.sqrt()).powi(3)
}

/// Sum of squares of a group about its line (for two or three rows about their mean), with its degrees of
/// freedom.
fn scatter(group: &[usize], residual: &[f64]) -> Option<Scatter> {
    let n = group.len() as f64;
    let middle = mean(group, residual);
    let about: f64 = group.iter().map(|row| (residual[*row] - middle).powi(2)).sum();
    match group.len() {
        0 | 1 => None,
        rows if rows < LINE => Some(Scatter { sum: about, freedom: n - 1.0 }),
        _ => {
            let x = |i: usize| i as f64 - 0.5 * (n - 1.0);
            let square = n * (n * n - 1.0) / 12.0;
            let along: f64 = group.iter().enumerate().map(|(i, row)| x(i) * (residual[*row] - middle)).sum();
            Some(Scatter { sum: (about - along * along / square).max(0.0), freedom: n - 2.0 })
        }
    }
}

/// The rows of the first cycles of each sweep; none if a record has few enough cycles that their means keep
/// the shape of the loop.
///
/// Means over several cycles would have no history of their own, and later cycles without the earlier ones a
/// wrong history.
fn first_cycles(record: &Record, used: &[bool], levels: &Levels) -> Option<Vec<bool>> {
    let moments = record.moments();
    let of_sweep = |sweep: &Range<usize>| -> Vec<(usize, usize)> {
        let rows: Vec<usize> = sweep.clone().filter(|row| used[*row]).collect();
        // First row of each stroke, and its number of rows.
        ways(&rows, record, levels).map(|run| (run[0], run.len())).collect()
    };
    let ways: Vec<Vec<(usize, usize)>> = record.sweeps().iter().map(of_sweep).collect();
    let cycle =
        |row: usize, sweep: &Range<usize>| moments[row].cycle.floor() - moments[sweep.start].cycle.floor();
    let means = |cycles: f64| -> usize {
        let own = |(sweep, ways): (&Range<usize>, &Vec<(usize, usize)>)| -> usize {
            let counting = ways.iter().filter(|(row, _)| cycle(*row, sweep) < cycles);
            counting.map(|(_, length)| PARTS.min(*length)).sum()
        };
        record.sweeps().iter().zip(&ways).map(own).sum()
    };
    if means(f64::INFINITY) <= MOST_PARTS {
        return None;
    }
    let mut cycles = FEWEST_CYCLES;
    while means(cycles + 1.0) <= MOST_PARTS {
        cycles += 1.0;
    }
    let mut kept = used.to_vec();
    for sweep in record.sweeps() {
        for row in sweep.clone() {
            kept[row] &= cycle(row, sweep) < cycles;
        }
    }
    Some(kept)
}

/// Number of means for each stroke from one reversal to the next.
fn parts_of_ways(record: &Record, used: &[bool], levels: &Levels) -> usize {
    let ways = |sweep: &Range<usize>| {
        let rows: Vec<usize> = sweep.clone().filter(|row| used[*row]).collect();
        ways(&rows, record, levels).count()
    };
    let ways: usize = record.sweeps().iter().map(ways).sum();
    (MOST_PARTS / ways.max(1)).clamp(1, PARTS)
}

impl Averaged {
    /// Residuals with bounded outliers, see [`tails::bounded`]. In a static map rows have no neighbours, so
    /// nothing is bounded.
    fn bounded(&self, residual: &[f64]) -> Vec<f64> {
        let rows = |stretch: &Range<usize>| self.groups[stretch.clone()].iter().flatten().copied().collect();
        tails::bounded(residual, &self.stretches.iter().map(rows).collect::<Vec<_>>())
    }
}

fn mean(group: &[usize], values: &[f64]) -> f64 {
    group.iter().map(|row| values[*row]).sum::<f64>() / group.len() as f64
}

fn sort_as_map(rows: &mut [usize], record: &Record, levels: &Levels) {
    let moments = record.moments();
    rows.sort_by(|a, b| {
        let key = |row: usize| (moments[row].specimen, levels.at(row));
        key(*a).cmp(&key(*b)).then(moments[*a].contraction.total_cmp(&moments[*b].contraction)).then(a.cmp(b))
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use bulge_effects::Moment;

    fn triangle(rows: usize) -> Record {
        let moments: Vec<Moment> = (0..rows)
            .map(|i| {
                let part = i as f64 / (rows - 1) as f64;
                let up = part < 0.5;
                Moment {
                    direction: if up { 1.0 } else { -1.0 },
                    begins: i == 0,
                    clock: i as f64,
                    time: i as f64,
                    ..Moment::at_rest(2e5, 0.2 * if up { 2.0 * part } else { 2.0 - 2.0 * part })
                }
            })
            .collect();
        let force = moments.iter().map(|m| 1000.0 * m.contraction).collect();
        Record::from_moments(moments, force, std::iter::once(0..rows).collect()).unwrap()
    }

    #[test]
    fn short_records_stay_what_they_are() {
        let record = triangle(50);
        let levels = Levels::of(&record, &[true; 50]);
        let averaged = Averaged::of(&record, &[true; 50], &levels, 100).unwrap();
        assert_eq!(averaged.record.force(), record.force());
        let [own, whole] =
            [&averaged.record, &record].map(|record| record.moments()[7].contraction.to_bits());
        assert_eq!(own, whole);
        assert_eq!(averaged.within(record.force()), (0.0, 0.0));
    }

    #[test]
    fn means_keep_directions_apart_and_lose_no_row() {
        let record = triangle(1000);
        let levels = Levels::of(&record, &vec![true; 1000]);
        let averaged = Averaged::of(&record, &vec![true; 1000], &levels, 100).unwrap();
        assert!(averaged.groups.len() >= 100 && averaged.groups.len() <= 102, "{}", averaged.groups.len());
        assert!((averaged.counts().sum::<f64>() - 1000.0).abs() < 1e-9);
        for (moment, force) in averaged.record.moments().iter().zip(averaged.record.force()) {
            assert!((moment.direction.abs() - 1.0).abs() < 1e-15);
            // The mean of points on a straight line lies on the line.
            assert!((force - 1000.0 * moment.contraction).abs() < 1e-9);
        }
    }

    #[test]
    fn what_lies_off_the_path_is_bounded_and_nothing_else() {
        let record = triangle(1000);
        let levels = Levels::of(&record, &vec![true; 1000]);
        let averaged = Averaged::of(&record, &vec![true; 1000], &levels, 100).unwrap();
        // A trend, friction that changes sign at the reversal with a transition, and noise of +-1.
        let noise = |row: usize| (f64::from(u32::try_from(row).unwrap()) * 12.9898).sin() * 43_758.545_3;
        let mut residual: Vec<f64> = (0..1000)
            .map(|row| {
                let friction =
                    if row < 500 { -20.0 } else { 20.0 - 40.0 * (-((row - 500) as f64) / 2.0).exp() };
                0.1 * row as f64 + friction + 2.0 * (noise(row).rem_euclid(1.0) - 0.5)
            })
            .collect();
        assert_eq!(averaged.bounded(&residual), residual);
        let clean = residual.clone();
        for row in [100, 300, 502, 700] {
            residual[row] += 50.0;
        }
        let bounded = averaged.bounded(&residual);
        for row in 0..1000 {
            let off = bounded[row] - clean[row];
            match row {
                100 | 300 | 700 => assert!(off < 6.0, "{row}: {off}"),
                // Within the transition, the outlier may stay as high as the transition reaches.
                502 => assert!((0.0..=50.0).contains(&off), "{off}"),
                _ => assert!(off.abs() < 1e-12, "{row}: {off}"),
            }
        }
        // Without an order of the rows, outliers can't be detected.
        let mut moments = record.moments().to_vec();
        for moment in &mut moments {
            moment.direction = 0.0;
        }
        let map = Record::from_moments(moments, vec![0.0; 1000], record.sweeps().to_vec()).unwrap();
        let averaged = Averaged::of(&map, &vec![true; 1000], &levels, 100).unwrap();
        assert_eq!(averaged.bounded(&residual), residual);
    }

    #[test]
    fn a_curved_model_leaves_no_misfit_of_its_own() {
        let record = triangle(1000);
        let levels = Levels::of(&record, &vec![true; 1000]);
        let averaged = Averaged::of(&record, &vec![true; 1000], &levels, 20).unwrap();
        let curved = |m: &Moment| 1e4 * m.contraction.powi(2);
        let model: Vec<f64> = record.moments().iter().map(curved).collect();
        let at_means: Vec<f64> = averaged.record.moments().iter().map(curved).collect();
        let exact =
            Record::from_moments(record.moments().to_vec(), model.clone(), record.sweeps().to_vec()).unwrap();
        let forces = averaged.forces(&exact, &model, &at_means);
        for (force, at_mean) in forces.iter().zip(&at_means) {
            assert!((force - at_mean).abs() < 1e-9);
        }
    }

    /// Cycles of 200 rows.
    fn cycles(count: u32) -> Vec<Moment> {
        let cycle = triangle(200);
        let moment = |i: u32| {
            let m = cycle.moments()[(i % 200) as usize];
            let number = f64::from(i / 200) + f64::from(i % 200) / 200.0;
            Moment { begins: i == 0, cycle: number, clock: f64::from(i), time: f64::from(i), ..m }
        };
        (0..200 * count).map(moment).collect()
    }

    #[test]
    fn long_tests_keep_their_first_cycles_whole() {
        // Two sweeps of 120 cycles have 480 strokes; 16 means each are more than 5000.
        let moments: Vec<Moment> = cycles(120).into_iter().chain(cycles(120)).collect();
        let n = moments.len();
        let force = moments.iter().map(|m| 1000.0 * m.contraction).collect();
        let record = Record::from_moments(moments, force, vec![0..n / 2, n / 2..n]).unwrap();
        let levels = Levels::of(&record, &vec![true; n]);
        let averaged = Averaged::of(&record, &vec![true; n], &levels, 2500).unwrap();
        let (means, sweeps) = (averaged.record.moments(), averaged.record.sweeps());
        assert!(means.len() <= MOST_PARTS && means.len() > MOST_PARTS - 100, "{}", means.len());
        for (sweep, first) in sweeps.iter().zip([0, n / 2]) {
            // Consecutive rows from the first one on, none left out, and no mean over two strokes.
            let rows: Vec<usize> = averaged.groups[sweep.clone()].iter().flatten().copied().collect();
            assert!(rows.iter().copied().eq(first..first + rows.len()));
            assert_eq!((rows.len() % 200, rows.len() / 200 >= 3), (0, true));
            for (way, means) in averaged.groups[sweep.clone()].chunks(PARTS).enumerate() {
                assert!(means.iter().flatten().all(|row| (row - first) / 100 == way), "{way}");
            }
        }
    }

    #[test]
    fn many_cycles_keep_the_shape_of_each_and_a_misfit_is_no_scatter() {
        // A misfit of 100 N over the stroke, friction that jumps at reversals, and 1.2 N of noise.
        let moments = cycles(100);
        let mut random = bulge_numerics::Random::new(4, 0);
        let misfit = |m: &Moment| 100.0 * (8.0 * m.contraction).exp().recip() - 14.0 * m.direction;
        let force: Vec<f64> = moments.iter().map(|m| misfit(m) + 1.2 * random.normal()).collect();
        let record = Record::from_moments(moments, force, std::iter::once(0..20_000).collect()).unwrap();
        let used = vec![true; record.len()];
        let levels = Levels::of(&record, &used);
        let averaged = Averaged::of(&record, &used, &levels, 300).unwrap();
        // 200 strokes of 16 means each.
        assert!((3_200..3_300).contains(&averaged.groups.len()), "{}", averaged.groups.len());
        let (sum, freedom) = averaged.within(record.force());
        let sd = (sum / freedom).sqrt();
        assert!((sd / 1.2 - 1.0).abs() < 0.05, "{sd}");
    }
}
