//! A bit of a converter that is always set, or never: readings whose bit was otherwise are wrong by one step of it. They
//! leave every second band of that width empty, whatever the muscle does, and the misfit has two values.

use bulge_measurements::{Channel, Data};
use rayon::prelude::*;
use std::ops::Range;

use crate::comparison::rows::lines;
use crate::diagnosis::channel::{PutRight, name, readings, shown};
use crate::diagnosis::trimmed::Linearised;
use crate::diagnosis::write::Findings;
use crate::diagnosis::wrong_channel::WrongChannel;
use crate::vector::{count, range, rms};

/// Fewest rows that show bands.
const FEWEST: usize = 60;
/// Readings that are looked at, at a regular stride.
const ENOUGH: usize = 2000;
/// Moments at which the fault may begin, in eighths of the record.
const STARTS: [usize; 3] = [0, 2, 4];
/// Distances of two bands, over the range of the readings: three bands at least, and steps of a five-hundredth of it.
const PERIODS: [f64; 2] = [0.7, 1.0 / 250.0];
/// By how much of a band readings at the other end of the range move from one period to the next that is tried.
const STEP: f64 = 0.02;
/// Part of a period that is empty,
const EMPTY: [f64; 2] = [0.46, 0.54];
/// and largest gap in the other part: readings that rest at set points fill a little of it. Of set points that are a little less than
/// a period apart half is empty as well, but their misfit hasn't two values.
const GAP: f64 = 0.15;
/// Part of a period by which a reading lies beyond the edge of a band.
const EDGE: f64 = 0.03;
/// Bins of a period that are counted first.
const BINS: usize = 32;
/// Fewest bands, and the part of them that readings must go through.
const FEWEST_BANDS: f64 = 3.0;
const COVERED: f64 = 0.6;
/// Fewest changes from one band to another, and how often at least right and wrong readings take turns for each.
const FEWEST_CHANGES: usize = 8;
const TURNS: f64 = 0.3;
/// RMS misfit over that as read, and over what was named leaves.
const FALLS: f64 = 0.45;
const BETTER: f64 = 0.8;

/// The stuck bit that leaves least.
pub(crate) fn stuck_bit(
    found: &Findings<'_>,
    linear: &Linearised,
    data: &Data,
    groups: &[Vec<usize>],
) -> Option<WrongChannel> {
    let record = found.context.record;
    let searched: Vec<(Channel, Vec<f64>, Vec<Bands>)> = Channel::ALL
        .into_par_iter()
        .map(|channel| {
            let values = readings(record, channel);
            let bands = bands(&values);
            (channel, values, bands)
        })
        .collect();
    let tried = searched.into_iter().flat_map(|(channel, values, bands)| {
        let signed = bands.into_iter().flat_map(|bands| [(bands, 0.5), (bands, -0.5)]);
        let tried = signed.filter_map(|(bands, side)| {
            let step = side * bands.period;
            let others: Vec<f64> = values.iter().map(|reading| reading + step).collect();
            let rows: Vec<Range<usize>> = (bands.from..values.len()).map(|row| row..row + 1).collect();
            let PutRight { wrong, left } = PutRight::of(found, linear, (channel, &others), &rows)?;
            bands.take_turns(&values, &wrong).then(|| Stuck { channel, step, wrong, left_n: rms(&left) })
        });
        tried.collect::<Vec<_>>()
    });
    let stuck = tried.min_by(|a, b| a.left_n.total_cmp(&b.left_n))?;
    let says = stuck.says(data, groups);
    Some(WrongChannel { left_n: stuck.left_n, of_misfit: FALLS, of_named: BETTER, is_curve: false, says })
}

/// A bit of a channel, and the rows in which it was otherwise.
struct Stuck {
    channel: Channel,
    /// By how much they read too little.
    step: f64,
    wrong: Vec<bool>,
    /// RMS of what is left once they are put right \[N\].
    left_n: f64,
}

impl Stuck {
    fn says(&self, data: &Data, groups: &[Vec<usize>]) -> String {
        let first = self.wrong.iter().position(|wrong| *wrong).unwrap_or_default();
        let last = self.wrong.iter().rposition(|wrong| *wrong).unwrap_or_default();
        let rows: Vec<usize> = groups.iter().take(last + 1).skip(first).flatten().copied().collect();
        let side = if self.step > 0.0 { "little" } else { "much" };
        format!(
            "the {name} skips every other band of {step}, and nothing is left if {count} of its readings are {step} too {side} (line {}): is a bit of \
             its converter stuck? Repeat the test with another one",
            lines(data, &rows),
            name = name(self.channel),
            step = shown(self.channel, self.step),
            count = count(&self.wrong),
        )
    }
}

/// Bands of readings, of which every other one is empty.
#[derive(Debug, Clone, Copy)]
struct Bands {
    /// From one to the next of those that hold readings, where one of them begins, and the part of the period that it takes.
    period: f64,
    start: f64,
    full: f64,
    /// Row from which it is so.
    from: usize,
    /// How unevenly they are filled (the distance of Kolmogorov and Smirnov).
    uneven: f64,
}

/// The bands of a channel: from each start, the most evenly filled of each octave of periods.
fn bands(values: &[f64]) -> Vec<Bands> {
    let starts = STARTS.map(|eighths| eighths * values.len() / 8);
    let of = |from: usize| {
        let (all, values) = (values, &values[from..]);
        if values.len() < FEWEST {
            return Vec::new();
        }
        let some: Vec<f64> = values.iter().copied().step_by(values.len().div_ceil(ENOUGH)).collect();
        let [low, high] = range(some.iter().copied());
        let width = high - low;
        let mut best: Vec<Bands> = Vec::new();
        let mut period = PERIODS[0] * width;
        let mut octave = period;
        while period > PERIODS[1] * width {
            if period < 0.5 * octave {
                octave = period;
            }
            let found = Bands::of(&some, low, period).filter(|bands| bands.cover(values));
            if let Some(found) = found.map(|bands| Bands { from: bands.begin(all), ..bands }) {
                match best.last_mut().filter(|last| last.period <= octave) {
                    Some(last) if last.uneven <= found.uneven => {}
                    Some(last) => *last = found,
                    None => best.push(found),
                }
            }
            period *= 1.0 - STEP * period / width;
        }
        best
    };
    starts.into_par_iter().flat_map_iter(of).collect()
}

/// The part beyond the next lower whole number, of a number below 2^52: much faster than a remainder, and than a floor, which is
/// a call where processors need not have it.
fn fraction(number: f64) -> f64 {
    #[expect(clippy::cast_possible_truncation, reason = "places in at most some hundred periods")]
    let whole = number as i64 as f64;
    number - if whole > number { whole - 1.0 } else { whole }
}

impl Bands {
    /// Those of a period, if readings fill one half of it and leave the other empty.
    fn of(values: &[f64], low: f64, period: f64) -> Option<Self> {
        let place = |value: &f64| fraction((value - low) / period);
        let mut is_filled = [false; BINS];
        let mut filled = 0;
        for value in values {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and 32")]
            let bin = (place(value) * BINS as f64) as usize;
            let bin = &mut is_filled[bin.min(BINS - 1)];
            filled += usize::from(!std::mem::replace(bin, true));
            // The bins at both ends of the half may be partly filled.
            if filled > BINS / 2 + 4 {
                return None;
            }
        }
        if filled + 2 < BINS / 2 {
            return None;
        }
        let mut places: Vec<f64> = values.iter().map(place).collect();
        places.sort_by(f64::total_cmp);
        let next = |index: usize| places.get(index + 1).copied().unwrap_or(places[0] + 1.0);
        let gap = |index: usize| next(index) - places[index];
        let widest = (0..places.len()).max_by(|a, b| gap(*a).total_cmp(&gap(*b)))?;
        if !(EMPTY[0]..=EMPTY[1]).contains(&gap(widest)) {
            return None;
        }
        let start = next(widest);
        let mut inside: Vec<f64> = places.iter().map(|place| fraction(place - start)).collect();
        inside.sort_by(f64::total_cmp);
        if inside.windows(2).any(|pair| pair[1] - pair[0] > GAP) {
            return None;
        }
        let (full, count) = (1.0 - gap(widest), inside.len() as f64);
        let distance = |(index, place): (usize, &f64)| (place / full - (index as f64 + 0.5) / count).abs();
        let uneven = inside.iter().enumerate().map(distance).fold(0.0, f64::max);
        Some(Self { period, start: low + period * start, full, from: 0, uneven })
    }

    /// The row after the last reading between the bands.
    fn begin(&self, values: &[f64]) -> usize {
        let is_between = |value: &f64| {
            let place = fraction((value - self.start) / self.period);
            place > self.full + EDGE && place < 1.0 - EDGE
        };
        values.iter().rposition(is_between).map_or(0, |row| row + 1)
    }

    /// Number of the band of a reading.
    fn number(&self, value: f64) -> f64 {
        ((value - self.start) / self.period).floor()
    }

    /// Whether readings go through the bands: those that rest at set points leave most of them empty.
    fn cover(&self, values: &[f64]) -> bool {
        let mut numbers: Vec<f64> = values.iter().map(|value| self.number(*value)).collect();
        numbers.sort_by(f64::total_cmp);
        let all = numbers[numbers.len() - 1] - numbers[0] + 1.0;
        numbers.dedup();
        // By chance n readings leave one in exp(n/bands) of them empty.
        let expected = all * (1.0 - (-(values.len() as f64) / all).exp());
        all >= FEWEST_BANDS && numbers.len() as f64 > COVERED * expected
    }

    /// Whether right and wrong readings take turns as often as the bands change, as a bit does: a shift, a leak or a
    /// ceiling goes on through many of them.
    fn take_turns(&self, values: &[f64], wrong: &[bool]) -> bool {
        let rows = self.from.max(1)..values.len();
        let turns = rows.clone().filter(|row| wrong[*row] != wrong[row - 1]).count();
        let changes =
            rows.filter(|row| (self.number(values[*row]) - self.number(values[row - 1])).abs() > 0.5).count();
        changes >= FEWEST_CHANGES && turns as f64 >= TURNS * changes as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bulge_numerics::Random;

    #[test]
    fn a_fraction_is_that_above_the_next_lower_whole_number() {
        for (number, part) in [(2.25, 0.25), (-0.25, 0.75), (-3.0, 0.0), (7.0, 0.0), (0.0, 0.0)] {
            assert!((fraction(number) - part).abs() < 1e-15, "{number}: {}", fraction(number));
        }
        // A hair below 0 is 1 less that hair, which rounds to 1, as it does with a floor.
        assert_eq!(fraction(-1e-30).to_bits(), (-1e-30_f64 - (-1e-30_f64).floor()).to_bits());
    }

    /// Four strokes over a range of 100 with a little noise.
    fn strokes() -> Vec<f64> {
        let mut random = Random::new(3, 0);
        let of = |row: u32| {
            // No stroke repeats the places of another.
            let part = (f64::from(row) / 98.73).rem_euclid(2.0);
            100.0 * (1.0 - (part - 1.0).abs())
        };
        (0..800).map(|row| of(row) + 0.2 * random.normal()).collect()
    }

    #[test]
    fn a_bit_leaves_every_other_band_of_its_width_empty() {
        for (step, from) in [(20.0, 0), (3.0, 0), (0.7, 0), (6.0, 300)] {
            let stick = |(row, value): (usize, f64)| {
                let is_set = (value / step).floor().rem_euclid(2.0) > 0.5;
                if is_set || row < from { value } else { value + step }
            };
            let found = bands(&strokes().into_iter().enumerate().map(stick).collect::<Vec<f64>>());
            let best = found.iter().min_by(|a, b| a.uneven.total_cmp(&b.uneven)).unwrap();
            assert!((best.period / (2.0 * step) - 1.0).abs() < 0.02, "{step}: {found:?}");
            assert!(best.from <= from && best.from + 12 > from, "{best:?}");
            // Where one begins, but for whole periods.
            let begins = (best.start / best.period).rem_euclid(1.0);
            assert!((begins - 0.5).abs() < 0.1, "{step}: {begins}");
        }
        assert!(bands(&strokes()).is_empty());
    }

    #[test]
    fn a_bit_takes_turns_and_a_shift_does_not() {
        let values = strokes();
        let bands = Bands { period: 10.0, start: 0.0, full: 0.5, from: 0, uneven: 0.0 };
        let bit: Vec<bool> = values.iter().map(|value| (value / 10.0).rem_euclid(1.0) > 0.5).collect();
        assert!(bands.take_turns(&values, &bit));
        let shift: Vec<bool> = (0..values.len()).map(|row| row >= 350).collect();
        assert!(!bands.take_turns(&values, &shift));
    }
}
