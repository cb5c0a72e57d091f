//! Repeated runs, and the pure error: the scatter of readings although nothing was changed.

use crate::columns::Trace;
use crate::data::Data;
use crate::resolution::{Resolution, bounds};
use crate::stretch::Stretch;
use serde::Serialize;
use std::collections::{BTreeMap, HashMap};
use std::ops::Range;

/// Runs that repeat each other.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Repeats {
    groups: Vec<RepeatGroup>,
    pure_error: Option<PureError>,
}

impl Repeats {
    /// The groups of runs, each of at least two.
    #[must_use]
    pub fn groups(&self) -> &[RepeatGroup] {
        &self.groups
    }

    /// Noise and drift of the force between repeats; none if nothing was repeated or if the repeats agree to
    /// the last digit.
    #[must_use]
    pub fn pure_error(&self) -> Option<PureError> {
        self.pure_error
    }
}

/// Runs on one specimen at one pressure, over the same range in the same directions (and in the same time, if
/// it was measured).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RepeatGroup {
    /// Index of the specimen in the list of specimens.
    pub specimen: u32,
    /// Mean pressure of the first run \[Pa\].
    pub pressure_pa: f64,
    /// Smallest and largest contraction of the first run.
    pub contraction: [f64; 2],
    /// +1 or -1 for each of the monotone stretches.
    pub directions: Vec<i8>,
    /// The runs, in the order of the rows.
    pub runs: Vec<Run>,
    /// Offset from each run to the next.
    pub offsets: Vec<Offset>,
}

/// A sweep, or one full loop of a sweep with several.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Run {
    /// Index of the sweep.
    pub sweep: usize,
    /// Its rows.
    pub rows: Range<usize>,
}

/// Mean difference of the force between a run and the next.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Offset {
    /// Mean of the next run minus this one \[N\].
    pub mean_n: f64,
    /// Standard deviation of that mean from the noise alone \[N\]; 0 if no noise is detected.
    pub sd_n: f64,
    /// Number of readings compared; 0 if the runs have no readings at common contractions.
    pub points: usize,
}

/// Scatter of the force between readings of the same state.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PureError {
    /// Standard deviation of one reading \[N\], without the offsets between repeats.
    pub sd_n: f64,
    /// Degrees of freedom of that estimate, for white noise; fractional, because inner runs enter two
    /// comparisons.
    pub degrees_of_freedom: f64,
    /// Mean offset from one repeat to the next \[N\], as heating, creep or softening cause it.
    pub drift_n: f64,
    /// Root mean square of these offsets \[N\].
    pub offset_rms_n: f64,
}

/// Mean pressures that differ by less than this fraction of the largest pressure form one level.
const LEVEL: f64 = 0.01;
/// Ends of stretches are equal within this fraction of the stretch.
const ENDS: f64 = 0.01;
/// Equal forces in the same state, over those by chance, from which they are copies.
const COPIES: f64 = 2.0;
/// Durations of stretches are equal within this fraction.
const DURATION: f64 = 0.1;

/// A run with the properties that are compared.
struct Candidate {
    run: Run,
    specimen: u32,
    /// Whether it is the first loop of its sweep, which lacks the history of later loops.
    is_first: bool,
    pressure: f64,
    legs: Vec<Leg>,
}

struct Leg {
    direction: i8,
    /// The row at which the motion starts; the next field has the rows of the motion.
    from: usize,
    rows: Range<usize>,
}

/// Sums of a comparison of two runs.
#[derive(Debug, Clone, Copy, Default)]
struct Comparison {
    points: usize,
    mean: f64,
    /// Sum of 1/variance factor.
    weight: f64,
    /// Weighted sum of squared deviations from the mean.
    squares: f64,
}

impl Data {
    /// Finds runs that repeat each other, and compares them at equal contractions on the same stretch. `l0`
    /// is the length of the unpressurised muscle \[m\], > 0.
    ///
    /// A run is a sweep, or a full loop of a sweep with several. The first loop of a sweep is only compared
    /// with first loops, because the others have a different history. A reading F of one run is compared with
    /// the next run's, interpolated linearly between neighbours F1 and F2:
    ///
    /// ```text
    /// d = F - (1 - w) F1 - w F2,   var d = sigma^2 (1 + (1 - w)^2 + w^2)
    /// ```
    ///
    /// No reading is used twice in a comparison. The mean of d is the offset between the runs; the remainder
    /// is noise. In a static map, rows of equal pressure, contraction, stated direction and specimen are
    /// repeats. Isometric runs aren't compared; disturbed rows are left out.
    #[must_use]
    pub fn repeats(&self, l0: f64) -> Repeats {
        let s = self.shortening();
        let mut is_sound = vec![true; self.len()];
        self.disturbed()
            .iter()
            .flat_map(|disturbance| &disturbance.rows)
            .for_each(|row| is_sound[*row] = false);
        let mut groups = Vec::new();
        // Sum of squares, its terms, effective degrees of freedom; offsets.
        let (mut squares, mut terms, mut freedom) = (0.0, 0.0, 0.0);
        let mut offsets: Vec<f64> = Vec::new();
        for members in self.grouped(&s, &is_sound) {
            let comparisons: Vec<Comparison> =
                members.windows(2).map(|pair| self.compared(&s, &is_sound, &pair[0], &pair[1])).collect();
            // Neighbouring comparisons share a run: they have the correlation -1/2 at equal readings, so that
            // n - 1 of them have fewer degrees of freedom.
            let (pairs, shared) = (comparisons.len() as f64, comparisons.len() as f64 - 1.0);
            let share = pairs / (pairs + 0.5 * shared);
            for found in comparisons.iter().filter(|found| found.points > 2) {
                let own = found.points as f64 - 1.0;
                squares += found.squares;
                terms += own;
                freedom += share * own;
                offsets.push(found.mean);
            }
            groups.push((members, comparisons));
        }
        if !self.is_path() {
            let (sum, count) = self.static_repeats(&is_sound);
            squares += sum;
            terms += count;
            freedom += count;
        }
        let sd = if terms > 0.0 { (squares / terms).sqrt() } else { 0.0 };
        let count = offsets.len().max(1) as f64;
        let pure_error = (sd > 0.0).then(|| PureError {
            sd_n: sd,
            degrees_of_freedom: freedom,
            drift_n: offsets.iter().sum::<f64>() / count,
            offset_rms_n: (offsets.iter().map(|offset| offset * offset).sum::<f64>() / count).sqrt(),
        });
        let groups = groups
            .into_iter()
            .map(|(members, comparisons)| group(self.range(&s, l0, &members[0]), members, &comparisons, sd))
            .collect();
        Repeats { groups, pure_error }
    }

    /// Smallest and largest contraction of a run.
    fn range(&self, s: &[f64], l0: f64, of: &Candidate) -> [f64; 2] {
        let (low, high) = bounds(&s[of.run.rows.clone()]);
        [low, high].map(|s| match &self.columns().motion {
            Trace::Contraction(_) => s,
            Trace::Length(_) => 1.0 + s / self.length_of(of.specimen, l0),
        })
    }

    /// The runs that repeat each other, in groups of at least two.
    fn grouped(&self, s: &[f64], is_sound: &[bool]) -> Vec<Vec<Candidate>> {
        let tolerance = self.level(is_sound);
        let mut groups: Vec<Vec<Candidate>> = Vec::new();
        // Groups by a key for fast lookup; a pressure near the edge of a level is looked up on both sides.
        let mut places: HashMap<(u32, bool, usize, i8, i64), Vec<usize>> = HashMap::new();
        for candidate in self.candidates(is_sound) {
            #[expect(clippy::cast_possible_truncation, reason = "at most 1/LEVEL levels")]
            let level = if tolerance > 0.0 { (candidate.pressure / tolerance).round() as i64 } else { 0 };
            let direction = candidate.legs.first().map_or(0, |leg| leg.direction);
            let key =
                |level| (candidate.specimen, candidate.is_first, candidate.legs.len(), direction, level);
            let near = [level, level - 1, level + 1];
            let place = near.iter().flat_map(|level| places.get(&key(*level)).into_iter().flatten()).copied();
            let place = place.into_iter().find(|place| {
                let first = groups.get(*place).and_then(|members| members.first());
                first.is_some_and(|first| {
                    (first.pressure - candidate.pressure).abs() <= tolerance
                        && self.is_same_way(s, first, &candidate)
                })
            });
            if let Some(place) = place {
                groups[place].push(candidate);
            } else {
                places.entry(key(level)).or_default().push(groups.len());
                groups.push(vec![candidate]);
            }
        }
        groups.retain(|members| members.len() > 1);
        groups
    }

    /// Pressures that differ by less form one level \[Pa\].
    fn level(&self, is_sound: &[bool]) -> f64 {
        let sound = self.pressure().iter().zip(is_sound).filter(|(_, is_sound)| **is_sound);
        LEVEL * sound.fold(0.0_f64, |most, (pressure, _)| most.max(pressure.abs()))
    }

    /// Every run with motion.
    fn candidates(&self, is_sound: &[bool]) -> Vec<Candidate> {
        let mut found = Vec::new();
        for (i, (sweep, stretches)) in self.paths().enumerate() {
            let moving: Vec<&Stretch> = stretches.iter().filter(|stretch| stretch.direction != 0).collect();
            let alternates = moving.windows(2).all(|pair| pair[0].direction != pair[1].direction);
            let size = if alternates && moving.len() > 2 { 2 } else { moving.len().max(1) };
            for (n, part) in moving.chunks(size).enumerate() {
                let legs: Vec<Leg> = part
                    .iter()
                    .map(|stretch| Leg {
                        direction: stretch.direction,
                        from: stretch.from(&sweep.rows),
                        rows: stretch.rows.clone(),
                    })
                    .collect();
                let (Some(first), Some(last)) = (legs.first(), legs.last()) else { continue };
                let rows = first.from..last.rows.end;
                let sound = || rows.clone().filter(|row| is_sound[*row]);
                let pressure =
                    sound().map(|row| self.pressure()[row]).sum::<f64>() / sound().count().max(1) as f64;
                let run = Run { sweep: i, rows };
                found.push(Candidate { run, specimen: sweep.specimen, is_first: n == 0, pressure, legs });
            }
        }
        found
    }

    /// Whether two runs follow the same path: directions, ends and durations of their stretches.
    fn is_same_way(&self, s: &[f64], a: &Candidate, b: &Candidate) -> bool {
        a.legs.iter().zip(&b.legs).all(|(a, b)| {
            let ends = |leg: &Leg| [s[leg.from], s[leg.rows.end - 1]];
            let ([a0, a1], [b0, b1]) = (ends(a), ends(b));
            let near = (2.0 * self.structure.band.width).max(ENDS * (a1 - a0).abs());
            let is_near = (a0 - b0).abs() <= near && (a1 - b1).abs() <= near;
            let takes_as_long = self.time().is_none_or(|time| {
                let duration = |leg: &Leg| time[leg.rows.end - 1] - time[leg.from];
                (duration(a) - duration(b)).abs() <= DURATION * duration(a).abs()
            });
            a.direction == b.direction && is_near && takes_as_long
        })
    }

    /// Compares the forces of two runs at the contractions of the first.
    fn compared(&self, s: &[f64], is_sound: &[bool], a: &Candidate, b: &Candidate) -> Comparison {
        let (force, pressure) = (self.force(), self.pressure());
        let level = self.level(is_sound);
        let mut found = Comparison::default();
        for (a, b) in a.legs.iter().zip(&b.legs) {
            let along = |row: usize| s[row] * f64::from(a.direction);
            // Rows of b before this one have been used.
            let mut unused = b.rows.start;
            let mut below = b.rows.start;
            for row in a.rows.clone() {
                while below + 1 < b.rows.end && along(below + 1) <= along(row) {
                    below += 1;
                }
                let gap = along((below + 1).min(b.rows.end - 1)) - along(below);
                let part = along(row) - along(below);
                if below < unused || part < 0.0 || (part > 0.0 && part > gap) {
                    continue;
                }
                let w = if part > 0.0 { part / gap } else { 0.0 };
                let above = if w > 0.0 { below + 1 } else { below };
                let differs =
                    (pressure[row] - (1.0 - w) * pressure[below] - w * pressure[above]).abs() > level;
                if differs || [row, below, above].iter().any(|row| !is_sound[*row]) {
                    continue;
                }
                let difference = (1.0 - w) * force[below] + w * force[above] - force[row];
                found.add(difference, 1.0 + (1.0 - w).powi(2) + w * w);
                unused = above + 1;
            }
        }
        found
    }

    /// Sum of squares and degrees of freedom of the rows of a static map with the same state. Rows whose force is the same
    /// as well count once, if there are more of them than chance makes on the grid of the force: they are copies.
    fn static_repeats(&self, is_sound: &[bool]) -> (f64, f64) {
        let motion = self.columns().motion.values();
        let mut states: BTreeMap<(u32, u64, u64, i8), Vec<f64>> = BTreeMap::new();
        for (row, force) in self.force().iter().enumerate().filter(|(row, _)| is_sound[*row]) {
            let direction = self.columns().direction.as_deref().map_or(0, |stated| stated[row]);
            let key =
                (self.specimen_of(row), self.pressure()[row].to_bits(), motion[row].to_bits(), direction);
            states.entry(key).or_default().push(*force);
        }
        let mut repeated: Vec<Vec<f64>> = states.into_values().filter(|forces| forces.len() > 1).collect();
        let all = scatter(&repeated);
        let pairs: f64 = repeated.iter().map(|forces| 0.5 * (forces.len() * (forces.len() - 1)) as f64).sum();
        for forces in &mut repeated {
            forces.sort_by(f64::total_cmp);
            forces.dedup_by_key(|force| force.to_bits());
        }
        let once = scatter(&repeated);
        let sd = (once.0 / once.1).sqrt();
        let step = Resolution::of(self.force(), &[]).step;
        // Two normal readings lie on the same level of the grid with a probability of step/(2 sqrt(pi) sd).
        let by_chance = pairs * step / (2.0 * std::f64::consts::PI.sqrt() * sd);
        if all.1 - once.1 > COPIES * by_chance + 1.0 { once } else { all }
    }
}

/// Sum of squares about the mean of each group, and degrees of freedom.
fn scatter(groups: &[Vec<f64>]) -> (f64, f64) {
    let of = |values: &Vec<f64>| {
        let mut found = Comparison::default();
        for value in values {
            found.add(*value, 1.0);
        }
        (found.squares, found.points as f64 - 1.0)
    };
    groups.iter().map(of).fold((0.0, 0.0), |sum, own| (sum.0 + own.0, sum.1 + own.1))
}

impl Comparison {
    /// Adds a difference whose variance is `factor` times that of a reading (West's update of weighted mean
    /// and squares).
    fn add(&mut self, difference: f64, factor: f64) {
        let weight = 1.0 / factor;
        let deviation = difference - self.mean;
        self.weight += weight;
        self.mean += deviation * weight / self.weight;
        self.squares += weight * deviation * (difference - self.mean);
        self.points += 1;
    }
}

fn group(contraction: [f64; 2], members: Vec<Candidate>, comparisons: &[Comparison], sd: f64) -> RepeatGroup {
    let first = &members[0];
    let offsets = comparisons.iter().map(|found| Offset {
        mean_n: found.mean,
        sd_n: if found.weight > 0.0 { sd / found.weight.sqrt() } else { 0.0 },
        points: found.points,
    });
    RepeatGroup {
        specimen: first.specimen,
        pressure_pa: first.pressure,
        contraction,
        directions: first.legs.iter().map(|leg| leg.direction).collect(),
        offsets: offsets.collect(),
        runs: members.into_iter().map(|member| member.run).collect(),
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::float_cmp, reason = "counts are exact")]

    use super::*;
    use crate::columns::{Columns, Labels};
    use crate::simulated::{Noise, clean_loops, force};

    /// The 99.9 % interval of the estimate of a standard deviation, by Wilson and Hilferty's cube-root transform of chi-square.
    fn interval(sd: f64, freedom: f64) -> [f64; 2] {
        let spread = 2.0 / (9.0 * freedom);
        [-3.29, 3.29].map(|z: f64| sd * (1.0 - spread + z * spread.sqrt()).powi(3).sqrt())
    }

    #[track_caller]
    fn within(found: PureError, sd: f64) {
        let [low, high] = interval(sd, found.degrees_of_freedom);
        assert!(found.sd_n > low && found.sd_n < high, "{found:?} is not within {low}..{high}");
    }

    /// Loops with different readings each time, and an offset that grows by `drift` from one sweep to the
    /// next.
    fn loops(sweeps: u32, rows: u32, sd: f64, drift: f64, seed: u64) -> Data {
        let mut noise = Noise::new(seed);
        let (mut c, mut f, mut t, mut sweep) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for n in 0..sweeps {
            let shift = noise.uniform();
            for i in 0..=rows {
                // Triangles, with the readings shifted but the turning points kept.
                let inner = if i % (rows / 2) == 0 { 0.0 } else { shift };
                let way = (f64::from(i) + inner) / f64::from(rows) * 2.0;
                let (x, direction) = if way <= 1.0 { (way, 1.0) } else { (2.0 - way, -1.0) };
                c.push(0.02 + 0.2 * x);
                f.push(force(2e5, 0.02 + 0.2 * x, direction) + drift * f64::from(n) + sd * noise.normal());
                t.push(1000.0 * f64::from(n) + 0.01 * f64::from(i));
                sweep.push(n.to_string());
            }
        }
        let mut columns = Columns::new(vec![2e5; c.len()], Trace::Contraction(c), f);
        columns.time_s = Some(t);
        columns.sweep = Some(Labels::from_iter(sweep));
        Data::from_columns(columns).unwrap()
    }

    #[test]
    fn noise_of_interpolated_repeats() {
        // A reading that is impossible or a spike is no scatter.
        let plain = loops(3, 300, 2.0, 0.0, 1);
        let mut columns = Columns::clone(plain.columns());
        columns.pressure_pa[16] = 160e5;
        columns.force_n[450] += 500.0;
        columns.force_n[0] = 9000.0;
        let disturbed = Data::from_columns(columns).unwrap().repeats(1.0).pure_error().unwrap();
        let of_plain = plain.repeats(1.0).pure_error().unwrap();
        assert!((disturbed.sd_n / of_plain.sd_n - 1.0).abs() < 0.02, "{disturbed:?} {of_plain:?}");
        let kept = disturbed.degrees_of_freedom / of_plain.degrees_of_freedom;
        assert!(kept > 0.97 && kept < 1.0, "{kept}");
        let mut outside = 0;
        for seed in 0..40 {
            let repeats = loops(2 + (seed % 3) as u32, 300, 2.0, 0.0, seed).repeats(1.0);
            assert_eq!(repeats.groups().len(), 1);
            assert_eq!(repeats.groups()[0].directions, [1, -1]);
            let found = repeats.pure_error().unwrap();
            within(found, 2.0);
            // A one-sigma interval contains about two thirds of the estimates: the degrees of freedom are
            // neither too many nor too few.
            outside +=
                u32::from((found.sd_n / 2.0 - 1.0).abs() > 1.0 / (2.0 * found.degrees_of_freedom).sqrt());
            assert!(found.drift_n.abs() < 4.0 * 2.0 * (2.0 / 140.0_f64).sqrt(), "{found:?}");
        }
        assert!((5..=22).contains(&outside), "{outside} of 40 beyond one standard deviation");
    }

    #[test]
    fn drift_is_apart_from_noise() {
        let repeats = loops(4, 300, 0.5, 3.0, 7).repeats(1.0);
        let found = repeats.pure_error().unwrap();
        within(found, 0.5);
        assert!((found.drift_n - 3.0).abs() < 0.1 && (found.offset_rms_n - 3.0).abs() < 0.1, "{found:?}");
        let group = &repeats.groups()[0];
        assert_eq!((group.runs.len(), group.offsets.len(), group.runs[3].sweep), (4, 3, 3));
        assert!((group.contraction[0] - 0.02).abs() < 1e-3 && (group.contraction[1] - 0.22).abs() < 1e-3);
        for offset in &group.offsets {
            assert!((offset.mean_n - 3.0).abs() < 5.0 * offset.sd_n && offset.sd_n < 0.06, "{offset:?}");
        }
    }

    #[test]
    fn loops_within_a_sweep_repeat_each_other_but_the_first() {
        let data = Data::from_columns(clean_loops(4, 1)).unwrap();
        let repeats = data.repeats(1.0);
        assert_eq!(repeats.groups().len(), 3);
        for (group, level) in repeats.groups().iter().zip([1e5, 2e5, 3e5]) {
            assert!((group.pressure_pa - level).abs() < 100.0);
            assert_eq!(group.runs.len(), 3);
        }
        // Noise of pressure and contraction adds: 2e-3 (1 - 2.8 c) 30 Pa = 0.05 N and 2e-3 * 2.8 p 1e-5 = 0.02 N at most.
        within(repeats.pure_error().unwrap(), 0.502);
    }

    #[test]
    fn other_ways_are_no_repeats() {
        for (name, change) in [
            (
                "pressure",
                (|columns, rows| columns.pressure_pa[rows].fill(2.2e5)) as fn(&mut Columns, Range<usize>),
            ),
            ("time", |columns, rows| {
                let time = columns.time_s.as_mut().unwrap();
                let start = time[rows.start];
                time[rows].iter_mut().for_each(|t| *t = start + 2.0 * (*t - start));
            }),
            ("range", |columns, rows| {
                let Trace::Contraction(c) = &mut columns.motion else { unreachable!() };
                c[rows].iter_mut().for_each(|c| *c *= 0.9);
            }),
            ("specimen", |columns, rows| {
                let label = |row| if rows.contains(&row) { "b" } else { "a" };
                columns.specimen = Some((0..columns.force_n.len()).map(label).collect());
            }),
        ] {
            let data = loops(2, 100, 1.0, 0.0, 3);
            assert_eq!(data.repeats(1.0).groups().len(), 1);
            let mut columns = data.columns().as_ref().clone();
            change(&mut columns, 101..202);
            let repeats = Data::from_columns(columns).unwrap().repeats(1.0);
            assert!(repeats.groups().is_empty() && repeats.pure_error().is_none(), "{name}");
        }
    }

    #[test]
    fn rows_of_a_static_map_with_the_same_state() {
        let mut noise = Noise::new(11);
        let (mut p, mut l, mut f) = (Vec::new(), Vec::new(), Vec::new());
        for i in 0..60 {
            for _ in 0..5 {
                p.push(1e5 + 1e3 * f64::from(i));
                l.push(0.3);
                f.push(100.0 + f64::from(i) + 1.5 * noise.normal());
            }
        }
        let mut columns = Columns::new(p, Trace::Length(l), f);
        let found = Data::from_columns(columns.clone()).unwrap().repeats(0.3).pure_error().unwrap();
        assert_eq!([found.degrees_of_freedom, found.drift_n], [240.0, 0.0]);
        within(found, 1.5);
        // Every second row copied: the scatter stays, and its degrees of freedom. On a coarse grid equal readings are no copies.
        let copies = |columns: &Columns| {
            let rows: Vec<usize> = (0..300).chain((0..300).step_by(2)).collect();
            let mut with = columns.clone();
            with.filter(&rows);
            Data::from_columns(with).unwrap().repeats(0.3).pure_error().unwrap()
        };
        let copied = copies(&columns);
        assert!(copied.degrees_of_freedom == 240.0 && (copied.sd_n / found.sd_n - 1.0).abs() < 1e-12);
        let mut coarse = columns.clone();
        coarse.force_n.iter_mut().for_each(|force| *force = force.round());
        let coarse = Data::from_columns(coarse).unwrap().repeats(0.3).pure_error().unwrap();
        assert_eq!(coarse.degrees_of_freedom, 240.0);
        within(coarse, (1.5_f64.powi(2) + 1.0 / 12.0).sqrt());
        // Nothing is repeated, or repeated to the last digit: there is no estimate.
        columns.force_n.fill(1.0);
        assert_eq!(Data::from_columns(columns).unwrap().repeats(0.3).pure_error(), None);
    }

    #[test]
    fn the_scatter_of_two_pairs_is_exact() {
        let motion = Trace::Length(vec![0.3; 4]);
        let columns = Columns::new(vec![1e5, 1e5, 2e5, 2e5], motion, vec![10.0, 12.0, 20.0, 22.0]);
        let found = Data::from_columns(columns).unwrap().repeats(0.3).pure_error().unwrap();
        // Squares of 1 N on either side of two means: 4 N^2 with two degrees of freedom.
        assert!((found.sd_n - 2.0_f64.sqrt()).abs() < 1e-12 && found.degrees_of_freedom == 2.0, "{found:?}");
    }
}
