//! Odd rows: those of a file, a sweep or a stretch of the record, rows here and there, or all from some moment on
//! (a sensor zeroed anew, another unit, a reversed column, a reading that is held, a clamp that slipped). If nothing
//! is missing without them, although what was named would have shown in the others, it is no effect of the muscle.

use bulge_effects::Moment;
use bulge_measurements::Data;
use bulge_model::Record;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use crate::comparison::rows::lines;
use crate::diagnosis::document::Verdict;
use crate::diagnosis::event::{Anew, names, said};
use crate::diagnosis::mislabelled::mislabelled;
use crate::diagnosis::shift::{Otherwise, shifts};
use crate::diagnosis::trimmed::Linearised;
use crate::diagnosis::write::Findings;
use crate::median::median;
use crate::vector::{count, minus, range};

/// Fewest parts among which one can be odd, and how many of them may be.
const FEWEST: usize = 3;
const ONE_IN: usize = 4;
/// Stretches into which a record is cut: short ones hide no event, and each needs some rows.
const STRETCHES: usize = 24;
/// Mean square of its misfit over the median of all from which a part is odd. An effect of the muscle
/// grows with pressure or length, which makes a factor of 2 or 3 between sweeps.
const ODD: f64 = 4.0;
/// Squared distance, in variances of the noise, of what the other rows show from what was named: 4 sigma.
pub(crate) const DENIED: f64 = 16.0;
/// The same if the other rows are too few for an answer: 6 sigma.
const SURELY: f64 = 36.0;
/// Fraction of what was named that they show at most if they deny it.
pub(crate) const SHOWN: f64 = 0.5;
/// Part of the misfit that the others may have if nothing is named, or if they could not show it.
const FALLS: f64 = 0.5;
/// Sum of squares of what was named that they could not show, in variances of the noise.
const SILENT: f64 = 64.0;
/// Youden's index from which the odd rows lie at one end of a state, and from which hardly another row does.
const APART: f64 = 0.75;
const ALONE: f64 = 0.9;
/// Step between neighbouring rows over the range, from which no stroke makes it.
const LEAP: f64 = 0.3;
/// Fractions of the rows on which alone nothing is named, with the part of the misfit that the others may have: an
/// effect of the muscle shows in its neighbours too, the more so if it is large.
const FEW: [(f64, f64); 2] = [(0.1, FALLS), (0.3, 0.1)];
/// The same where nothing is named, and no claim is lost.
const NONE_NAMED: [(f64, f64); 2] = [(0.1, 0.75), (1.0, FALLS)];
/// Largest step from one odd row to the next that leaves no other between them: a part of all odd rows, or so many.
const HOLE: f64 = 0.1;
const HOLE_ROWS: f64 = 3.0;
/// Fraction on which nothing is named if most of what was explained is there, whatever the others have.
const SINGLE: f64 = 0.01;

/// What is said of rows without which nothing of what was named is missing, if there are such.
pub(crate) fn odd(
    found: &Findings<'_>,
    linear: &Linearised,
    data: &Data,
    groups: &[Vec<usize>],
    Anew { without, .. }: Anew<'_>,
) -> Option<String> {
    let doubt = Doubt::of(found, linear)?;
    let claims = found.claims();
    let first = |place: &Vec<usize>| place.first().copied().unwrap_or_default();
    let sweep = |row: usize| data.sweeps().partition_point(|sweep| sweep.rows.end <= row);
    let file = |row: usize| data.line(row).0;
    let stretch = |row: usize| row * STRETCHES / data.len();
    let of: [&dyn Fn(usize) -> usize; 3] = [&file, &sweep, &stretch];
    let parts = of.into_iter().filter_map(|part| {
        let places = stand_out(found, groups, part)?;
        Some(groups.iter().map(|group| places.contains(&part(first(group)))).collect::<Vec<bool>>())
    });
    let others = mislabelled(found, linear, data, groups).into_iter().chain(shifts(found, linear));
    let others = others.map(|other| (other.odd.clone(), Some(other)));
    let mut tried = BTreeSet::new();
    let trimmed = linear.odd().into_iter().flat_map(|odd| [without_holes(&odd), odd]);
    others.chain(parts.chain(trimmed).chain(sorted(data, groups)).map(|odd| (odd, None))).find_map(|(odd, otherwise)| {
        let is_better = otherwise.as_ref().is_some_and(|otherwise| otherwise.is_better);
        let others = if is_better { Some(Others::Deny { surely: true }) } else { doubt.about(&odd, otherwise.as_ref()) };
        let others = others.filter(|others| tried.insert((odd.clone(), *others)))?;
        let own = groups.iter().zip(&odd).filter(|(_, odd)| **odd);
        let mut rows: Vec<usize> = own.flat_map(|(group, _)| group.iter().copied()).collect();
        rows.sort_unstable();
        let rest = without(&rows)?;
        let denied = match rest.verdict {
            Verdict::Adequate => true,
            Verdict::Missing => !claims.is_empty() && !claims.iter().any(|claim| names(&rest, *claim)),
            // Most of the rows know nothing of what was named.
            Verdict::CannotTell => {
                others == (Others::Deny { surely: true }) && 2 * count(&odd) <= odd.len()
            }
            Verdict::Unknown => false,
        };
        let asks = match others {
            Others::Deny { .. } => "some rows ask for something that the others deny",
            Others::AreSilent => "some rows ask for something that the others could not show",
        };
        let as_if = otherwise.map_or_else(String::new, |otherwise| format!(", as if {} there", otherwise.says));
        denied.then(|| {
            let or = or_what(found.context.record, &odd);
            format!(
                "{asks}{as_if}: without line {} {}. See what happened there: a fitting that slipped, a sensor zeroed anew, reversed or held, another unit, another \
                 specimen{or}",
                lines(data, &rows),
                said(Some(&rest)),
            )
        })
    })
}

/// Odd rows with those in small holes between them: by chance a wrong reading is right.
fn without_holes(odd: &[bool]) -> Vec<bool> {
    let most = (HOLE * count(odd) as f64).max(HOLE_ROWS);
    let mut filled = odd.to_vec();
    let rows: Vec<usize> = (0..odd.len()).filter(|row| odd[*row]).collect();
    for pair in rows.windows(2).filter(|pair| (pair[1] - pair[0]) as f64 <= most) {
        filled[pair[0]..pair[1]].fill(true);
    }
    filled
}

/// For each channel, the longest stretch of rows in which its readings only rise or only fall: a part of one column may have been
/// sorted.
fn sorted(data: &Data, groups: &[Vec<usize>]) -> Vec<Vec<bool>> {
    let stretches = [data.pressure(), data.motion().values(), data.force()].map(monotone);
    let short = stretches.into_iter().filter(|stretch| 2 * stretch.len() <= data.len());
    short
        .map(|stretch| groups.iter().map(|group| group.iter().any(|row| stretch.contains(row))).collect())
        .collect()
}

/// The longest stretch of values that only rise or only fall.
fn monotone(values: &[f64]) -> Range<usize> {
    let (mut best, mut start, mut side) = (0..values.len().min(1), 0, 0.0);
    for place in 1..values.len() {
        let step = values[place] - values[place - 1];
        if step * side < 0.0 {
            // Values that rest before the turn belong to both.
            start = (0..place)
                .rev()
                .take_while(|before| values[*before].total_cmp(&values[place - 1]).is_eq())
                .last()
                .unwrap_or(place);
        }
        if step != 0.0 {
            side = step;
        }
        if place + 1 - start > best.len() {
            best = start..place + 1;
        }
    }
    best
}

/// Why an answer may rest on some rows alone.
struct Doubt<'a> {
    linear: &'a Linearised,
    record: &'a Record,
    /// Whether anything is named, what it explains \[N\], and by how much the squares fall with it, row by row.
    is_named: bool,
    claimed: Vec<f64>,
    gains: Vec<f64>,
}

impl<'a> Doubt<'a> {
    fn of(found: &Findings<'a>, linear: &'a Linearised) -> Option<Self> {
        let record = found.context.record;
        let [base, last] = [found.search.stages.first()?, found.last()].map(|stage| &stage.linear.force);
        let [before, after] = [base, last].map(|force| minus(record.force(), force));
        let gains =
            before.iter().zip(&after).map(|(before, after)| before * before - after * after).collect();
        Some(Self { linear, record, is_named: !found.claims().is_empty(), claimed: minus(last, base), gains })
    }

    /// What the others say; none if they bear it out.
    fn about(&self, odd: &[bool], otherwise: Option<&Otherwise>) -> Option<Others> {
        let kept: Vec<bool> = odd.iter().map(|odd| !odd).collect();
        let falls = |below: f64| self.linear.falls_to(&kept).is_some_and(|part| part < below);
        let part = count(odd) as f64 / odd.len() as f64;
        if !self.is_named {
            // What comes back at one state is no event.
            let leaves_noise = otherwise.is_some_and(|otherwise| 2.0 * part <= 1.0 && otherwise.leaves_noise);
            let is_event = NONE_NAMED.iter().any(|(few, below)| part <= *few && falls(*below));
            let is_event = leaves_noise || is_event && !comes_back(self.record, odd);
            return is_event.then_some(Others::Deny { surely: false });
        }
        let share = self.linear.share(&self.claimed, &kept)?;
        let distance = share.expected * (1.0 - share.shown).powi(2);
        if share.shown < SHOWN && distance > DENIED {
            return Some(Others::Deny { surely: distance > SURELY });
        }
        let is_few = || {
            let is_few = FEW.iter().any(|(few, below)| part <= *few && falls(*below));
            let is_event = is_few || part <= SINGLE && self.is_in(odd);
            is_event && !comes_back(self.record, odd) && !is_driven_apart(self.record, odd)
        };
        // One reading that is wrong in these rows is as good a cause as what was named.
        let is_as_good =
            |otherwise: &Otherwise| 2.0 * part <= 1.0 && (otherwise.explains_all || falls(FALLS));
        (share.expected < SILENT && otherwise.map_or_else(is_few, is_as_good)).then_some(Others::AreSilent)
    }

    /// Whether most of what was named explains is in the odd rows.
    fn is_in(&self, odd: &[bool]) -> bool {
        let in_them: f64 = self.gains.iter().zip(odd).filter(|(_, odd)| **odd).map(|(gain, _)| gain).sum();
        in_them >= SHOWN * self.gains.iter().sum::<f64>()
    }
}

/// What else than an event would show in these rows alone, in words; empty if nothing would.
fn or_what(record: &Record, odd: &[bool]) -> String {
    let rest = odd.iter().position(|odd| !odd).unwrap_or(odd.len());
    if rest > 0 && odd[rest..].iter().all(|odd| !odd) {
        return "; or the muscle was not run in, which wears off: repeat the first strokes".to_owned();
    }
    let (apart, what) = end(record, odd);
    if apart < ALONE {
        return String::new();
    }
    format!("; or an effect that begins there: hardly another row has {what}; measure between")
}

/// Whether the odd rows come back at one end of a state in several sweeps that leave it in between.
fn comes_back(record: &Record, odd: &[bool]) -> bool {
    let is_mixed = |sweep: &&Range<usize>| {
        let count = count(&odd[(*sweep).clone()]);
        count > 0 && count < sweep.len()
    };
    record.sweeps().iter().filter(is_mixed).count() > 1
        && end(record, odd).0 > APART
        && !is_leapt_to(record, odd)
}

/// Whether most of the odd rows' edges within sweeps are leaps of pressure or contraction, such as no other rows make:
/// readings that fail lie at one end of a state as well, and no stroke leads there.
fn is_leapt_to(record: &Record, odd: &[bool]) -> bool {
    let moments = record.moments();
    let states: [State; 2] = [|moment| moment.pressure, |moment| moment.contraction];
    states.into_iter().any(|state| {
        let [low, high] = range(moments.iter().map(state));
        let inside = record.sweeps().iter().flat_map(|sweep| sweep.start + 1..sweep.end);
        let step = |row: usize| (state(&moments[row]) - state(&moments[row - 1])).abs();
        let usual = inside.clone().filter(|row| !odd[*row] && !odd[row - 1]).map(step).fold(0.0, f64::max);
        let edges: Vec<f64> = inside.filter(|row| odd[*row] != odd[row - 1]).map(step).collect();
        let leaps = edges.iter().filter(|step| **step > (LEAP * (high - low)).max(usual)).count();
        2 * leaps > edges.len()
    })
}

/// Whether the odd rows are sweeps that alone were driven so fast, or were so warm or cold: an experiment for what shows
/// there.
fn is_driven_apart(record: &Record, odd: &[bool]) -> bool {
    // Stretches of the record end beside the sweep that they are.
    let mut whole = vec![false; odd.len()];
    for sweep in record.sweeps() {
        let is_whole = count(&odd[sweep.clone()]) as f64 >= ALONE * sweep.len() as f64;
        whole[sweep.clone()].fill(is_whole);
    }
    let inside = odd.iter().zip(&whole).filter(|(odd, whole)| **odd && **whole).count();
    if (inside as f64) < ALONE * count(odd) as f64 {
        return false;
    }
    let odd = whole;
    let of: [State; 3] =
        [|moment| moment.rate.abs(), |moment| moment.pressure_rate.abs(), |moment| moment.temperature];
    // Rows at rest at the ends of a stroke are as slow as those of a slow one.
    let moving: Vec<usize> = (0..odd.len()).filter(|row| record.moments()[*row].branch() != 0.0).collect();
    let odd: Vec<bool> = moving.iter().map(|row| odd[*row]).collect();
    of.into_iter().any(|state| {
        let values = moving.iter().map(|row| state(&record.moments()[*row]));
        apart(values, &odd, ["", ""]).0 >= ALONE
    })
}

/// A number of a moment.
type State = fn(&Moment) -> f64;

/// The end of a state at which the odd rows lie, and how well it sets them apart: the fraction of them beyond a
/// limit less that of the others (Youden's index of the best limit).
fn end(record: &Record, odd: &[bool]) -> (f64, &'static str) {
    let of: [(State, [&'static str; 2]); 2] = [
        (|moment| moment.contraction, ["a contraction as small", "a contraction as large"]),
        (|moment| moment.pressure, ["a pressure as low", "a pressure as high"]),
    ];
    let best = |(state, ends): (State, _)| apart(record.moments().iter().map(state), odd, ends);
    let [contraction, pressure] = of.map(best);
    if pressure.0 > contraction.0 { pressure } else { contraction }
}

/// How well a limit sets the odd rows apart by a state, and the end at which they lie.
fn apart(
    state: impl Iterator<Item = f64>,
    odd: &[bool],
    [low, high]: [&'static str; 2],
) -> (f64, &'static str) {
    let rows = [true, false].map(|is_odd| odd.iter().filter(|odd| **odd == is_odd).count().max(1) as f64);
    let mut sorted: Vec<(f64, bool)> = state.zip(odd.iter().copied()).collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Of the rows up to a limit: odd ones less others.
    let mut below = 0.0;
    sorted
        .chunk_by(|a, b| a.0 >= b.0)
        .map(|tied| {
            below +=
                tied.iter().map(|(_, odd)| if *odd { 1.0 / rows[0] } else { -1.0 / rows[1] }).sum::<f64>();
            if below > 0.0 { (below, low) } else { (-below, high) }
        })
        .fold((0.0, low), |best, next| if next.0 > best.0 { next } else { best })
}

/// What the other rows say if a few are left out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Others {
    /// What was named is not there, although they could show it; or something else explains the odd rows better.
    Deny {
        /// So far from it that they need not be enough for an answer of their own.
        surely: bool,
    },
    /// They could not show it.
    AreSilent,
}

/// The few parts of the data whose misfit of the base stands far out.
fn stand_out(
    found: &Findings<'_>,
    groups: &[Vec<usize>],
    part: &dyn Fn(usize) -> usize,
) -> Option<BTreeSet<usize>> {
    // Squares of the misfit, and rows, part by part.
    let mut sums: BTreeMap<usize, [f64; 2]> = BTreeMap::new();
    for (group, misfit) in groups.iter().zip(&found.search.stages.first()?.linear.white) {
        let sum = sums.entry(part(*group.first()?)).or_default();
        *sum = [sum[0] + misfit * misfit, sum[1] + 1.0];
    }
    if sums.len() < FEWEST {
        return None;
    }
    let mean = |[square, rows]: [f64; 2]| square / rows;
    let usual = median(&mut sums.values().copied().map(mean).collect::<Vec<_>>()).max(1.0);
    let odd: BTreeSet<usize> =
        sums.iter().filter(|(_, sum)| mean(**sum) > ODD * usual).map(|(place, _)| *place).collect();
    (!odd.is_empty() && odd.len() <= (sums.len() / ONE_IN).max(1)).then_some(odd)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three contractions at each of three pressures, up and down again.
    fn record() -> Record {
        let of = |i: u32| {
            Moment::at_rest(1e5 * f64::from(1 + i / 6), 0.05 * f64::from([0, 1, 2, 2, 1, 0][i as usize % 6]))
        };
        let sweeps = vec![0..6, 6..12, 12..18];
        Record::from_moments((0..18).map(of).collect(), vec![0.0; 18], sweeps).unwrap()
    }

    fn rows(is_odd: impl Fn(usize) -> bool) -> Vec<bool> {
        (0..18).map(is_odd).collect()
    }

    #[test]
    fn rows_at_one_end_of_a_state_may_show_an_effect_that_begins_there() {
        let is = |is_odd: fn(usize) -> bool, apart: f64, what: &str| {
            let found = end(&record(), &rows(is_odd));
            assert!((found.0 - apart).abs() < 1e-12 && found.1 == what, "{found:?}");
        };
        is(|i| [2, 3].contains(&(i % 6)), 1.0, "a contraction as large");
        is(|i| [0, 5].contains(&(i % 6)), 1.0, "a contraction as small");
        is(|i| i < 6, 1.0, "a pressure as low");
        is(|i| i >= 12, 1.0, "a pressure as high");
        // All of three rows lie beyond a limit that 3 of 15 others exceed.
        is(|i| i % 6 == 2, 0.8, "a contraction as large");
        // All six of the middle pressure, and half of the others.
        let middle = end(&record(), &rows(|i| (6..12).contains(&i)));
        assert!((middle.0 - 0.5).abs() < 1e-12, "{middle:?}");
        let words = or_what(&record(), &rows(|i| i >= 12));
        assert!(words.contains("hardly another row has a pressure as high"), "{words}");
        assert_eq!(or_what(&record(), &rows(|i| (6..12).contains(&i))), "");
        assert!(or_what(&record(), &rows(|i| i < 4)).contains("repeat the first strokes"));
    }

    #[test]
    fn small_holes_between_odd_rows_are_odd() {
        let of = |rows: &[usize]| (0..60).map(|row| rows.contains(&row)).collect::<Vec<bool>>();
        let filled = |rows: &[usize]| {
            let filled = without_holes(&of(rows));
            (0..60).filter(|row| filled[*row]).collect::<Vec<usize>>()
        };
        // Two rows between 5 and 8, three between 8 and 12, which is more than a tenth of few.
        assert_eq!(filled(&[5, 8, 12, 40]), [5, 6, 7, 8, 12, 40]);
        let most: Vec<usize> = (0..45).filter(|row| !(20..23).contains(row)).chain([50]).collect();
        assert_eq!(filled(&most), (0..45).chain([50]).collect::<Vec<usize>>());
    }

    #[test]
    fn the_longest_stretch_that_only_rises_or_falls() {
        assert_eq!(monotone(&[3.0, 1.0, 2.0, 2.0, 5.0, 4.0, 3.0]), 1..5);
        assert_eq!(monotone(&[0.0, 0.0, 4.0, 3.0, 2.0, 2.0, 1.0, 6.0]), 2..7);
        assert_eq!(monotone(&[7.0, 7.0]), 0..2);
        assert!(monotone(&[]).is_empty());
    }

    #[test]
    fn what_comes_back_at_one_state_is_no_event_and_a_whole_sweep_may_be() {
        assert!(comes_back(&record(), &rows(|i| [2, 3].contains(&(i % 6)))));
        assert!(!comes_back(&record(), &rows(|i| i >= 6)));
        assert!(!comes_back(&record(), &rows(|i| i == 2 || i == 3)));
        assert!(!comes_back(&record(), &rows(|i| i % 5 == 1)));
    }
}
