//! Detects a sweep that is shifted as a whole, because the load cell was zeroed again or something was hung
//! on it. Such a shift isn't physics and doesn't affect the other sweeps.
//!
//! ```text
//! r = S(driven, held, direction) + d 1_s,    gain_s = (a_s . z)^2/(a_s . a_s),    d = (a_s . z)/(a_s . a_s)
//! ```
//! r are the residuals. S is a surface that all sweeps share: a polynomial in the driven variable (the
//! contraction, or the pressure at held length) and in the held one. It is affine in a held pressure, like
//! the force of nearly every mechanism, and of the third degree in a held length, on which rubber, angle and
//! friction depend in their own ways. z are the residuals of r about S, and a_s is the sweep's indicator
//! orthogonalised against S. A sweep is shifted if its offset d is large compared with the noise and constant
//! along the sweep, if no other offset remains comparable once it is removed, and if no other sweep's offset
//! explains the residuals as well.

use bulge_effects::Moment;
use bulge_measurements::Data;
use bulge_model::Record;
use bulge_muscles::units::significant;
use std::ops::Range;

use crate::chebyshev::chebyshev;
use crate::comparison::document::LeftOut;
use crate::comparison::rows::Used;
use crate::noise::orthonormal::Basis;
use crate::vector::range;
use bulge_numerics::vector::{add, dot};

/// Most rows for fitting the surface.
const MOST_ROWS: usize = 4_000;
/// Fewest sweeps for the others to agree on where one should lie, and fewest rows of each.
const FEWEST: [usize; 2] = [4, 8];
/// Most sweeps; the test of each takes a column.
const MOST_SWEEPS: usize = 200;
/// At most one sweep in this many may be shifted.
const ONE_IN: usize = 4;
/// A variable is driven if most sweeps cover more than this fraction of its total range.
const DRIVEN: f64 = 0.3;
/// A variable counts as held within this fraction of its largest value: contraction, pressure.
const HELD: [f64; 2] = [0.01, 0.02];
/// Degrees in the driven variable, for the mean of the branches and for their difference; the lower set is
/// for few rows.
const DEGREES: [[usize; 2]; 2] = [[7, 4], [4, 2]];
/// Degree in the held variable (pressure, length); at most one less than the number of levels.
const HELD_DEGREE: [usize; 2] = [1, 3];
/// Fewest rows for each column of the surface.
const ROWS_PER_COLUMN: usize = 3;
/// Levels of the held variable are at least this fraction of its largest value apart.
const GAP: f64 = 0.03;
/// A smaller offset, in standard deviations of a reading, hardly matters.
const SIZE: f64 = 2.5;
/// A smaller offset, in its own standard deviations, may be chance.
const SURE: f64 = 8.0;
/// Least fraction of the sweep's indicator that is outside the surface; otherwise the offset is undetermined.
const LEFT: f64 = 0.1;
/// Largest fraction of the gain that another sweep's offset may reach instead,
const INSTEAD: f64 = 0.85;
/// that another sweep's offset may reach in addition,
const BESIDES: f64 = 0.05;
/// and that a variation along the sweep may reach.
const ALONG: f64 = 0.1;
/// Number of positions along a sweep at which a jump is tried: a jump within a sweep is no shift of the whole
/// sweep.
const PARTS: usize = 16;
/// Gains below this, in variances of a reading, are insignificant.
const CHANCE: f64 = 30.0;

/// Beginning of the reason.
const SHIFTED: &str = "shifted:";

/// A sweep and its offset.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Shift {
    sweep: usize,
    offset_n: f64,
}

impl Used {
    /// Leaves out sweeps that are shifted as a whole. `residuals` \[N\] are those of a model, which may be
    /// wrong.
    pub(crate) fn leave_out_shifted(&mut self, data: &Data, record: &Record, residuals: &[f64], sd_n: f64) {
        for _ in 0..record.sweeps().len() / ONE_IN {
            let Some(found) = shifted(record, &self.mask, residuals, sd_n) else { break };
            let name = data.sweeps().get(found.sweep).map_or("", |sweep| sweep.name.as_str());
            let why = format!(
                "{SHIFTED} all of sweep `{name}` lies {} N {} where the other sweeps lead ({} times the noise of {} N): was the load cell zeroed anew before it?",
                significant(found.offset_n.abs(), 3),
                if found.offset_n > 0.0 { "above" } else { "below" },
                significant(found.offset_n.abs() / sd_n, 2),
                significant(sd_n, 2),
            );
            self.leave_out(data, record.sweeps()[found.sweep].clone(), why);
        }
    }
}

impl Used {
    /// The first sweep, if it was left out as shifted: run-in, creep and warming up make the first sweep differ, too.
    pub(crate) fn first_is_shifted(&self, data: &Data) -> Option<&LeftOut> {
        let first = data.sweeps().first()?;
        let reason = (*self.reason.get(first.rows.start)?)?;
        self.left_out.get(usize::try_from(reason).ok()?).filter(|left| left.why.starts_with(SHIFTED))
    }
}

/// The sweep with the largest shift, if it is the only one that explains the residuals.
fn shifted(record: &Record, used: &[bool], residuals: &[f64], sd_n: f64) -> Option<Shift> {
    let sweeps = record.sweeps();
    if !record.is_path() || !(FEWEST[0]..=MOST_SWEEPS).contains(&sweeps.len()) || sd_n <= 0.0 {
        return None;
    }
    let (rows, blocks) = thinned(sweeps, &|row| used[row] && residuals[row].is_finite());
    let blocks: Vec<(usize, Range<usize>)> =
        blocks.into_iter().filter(|(_, block)| block.len() >= FEWEST[1]).collect();
    if blocks.len() < FEWEST[0] {
        return None;
    }
    let basis = surface(record, &rows, &blocks)?;
    let mut left: Vec<f64> = rows.iter().map(|row| residuals[*row]).collect();
    basis.remove_from(&mut left);
    let gain = |column: &[f64], left: &[f64]| dot(column, left).powi(2) / dot(column, column);
    let columns: Vec<Option<Vec<f64>>> = blocks
        .iter()
        .map(|(_, block)| {
            let mut column = vec![0.0; rows.len()];
            column[block.clone()].fill(1.0);
            basis.remove_from(&mut column);
            (dot(&column, &column) >= LEFT * block.len() as f64).then_some(column)
        })
        .collect();
    let of_sweep = |(place, column): (usize, &Option<Vec<f64>>)| Some((place, gain(column.as_ref()?, &left)));
    let mut gains: Vec<(usize, f64)> = columns.iter().enumerate().filter_map(of_sweep).collect();
    gains.sort_by(|a, b| b.1.total_cmp(&a.1));
    let (place, most) = *gains.first()?;
    let own = columns[place].as_ref()?;
    let offset_n = dot(own, &left) / dot(own, own);
    let variance = sd_n * sd_n;
    let instead = gains.get(1).map_or(0.0, |other| other.1);
    if offset_n.abs() < SIZE * sd_n || most < SURE * SURE * variance || instead > INSTEAD * most {
        return None;
    }
    let mut rest = left;
    take_out(&mut rest, own);
    let without = |mut column: Vec<f64>| {
        take_out(&mut column, own);
        column
    };
    let besides = columns.iter().enumerate().filter(|(other, _)| *other != place);
    let besides = besides.filter_map(|(_, column)| Some(gain(&without(column.clone()?), &rest)));
    let nothing = CHANCE * variance;
    let (_, block) = &blocks[place];
    let along = along(record, &rows, block).into_iter().map(|mut column| {
        basis.remove_from(&mut column);
        let column = without(column);
        if dot(&column, &column) > LEFT { gain(&column, &rest) } else { 0.0 }
    });
    let is_alone = besides.fold(0.0, f64::max) <= (BESIDES * most).max(nothing);
    let is_constant = along.fold(0.0, f64::max) <= (ALONG * most).max(nothing);
    (is_alone && is_constant).then_some(Shift { sweep: blocks[place].0, offset_n })
}

fn take_out(vector: &mut [f64], column: &[f64]) {
    let part = dot(vector, column) / dot(column, column);
    add(vector, -part, column);
}

/// Rows that count, thinned at a constant stride within each sweep, and the range of each sweep among them.
fn thinned(
    sweeps: &[Range<usize>],
    counts: &dyn Fn(usize) -> bool,
) -> (Vec<usize>, Vec<(usize, Range<usize>)>) {
    let all: usize = sweeps.iter().map(|sweep| sweep.clone().filter(|row| counts(*row)).count()).sum();
    let stride = all.div_ceil(MOST_ROWS).max(1);
    let (mut rows, mut blocks) = (Vec::new(), Vec::new());
    for (number, sweep) in sweeps.iter().enumerate() {
        let start = rows.len();
        rows.extend(sweep.clone().filter(|row| counts(*row)).step_by(stride));
        blocks.push((number, start..rows.len()));
    }
    (rows, blocks)
}

/// Middle and half-width of the range of some values.
fn scale(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let [low, high] = range(values);
    [0.5 * (low + high), (0.5 * (high - low)).max(f64::MIN_POSITIVE)]
}

/// The surface that all sweeps share, as an orthonormal basis; none unless exactly one of contraction and
/// pressure is driven.
fn surface(record: &Record, rows: &[usize], blocks: &[(usize, Range<usize>)]) -> Option<Basis> {
    let moments = record.moments();
    let read: [fn(&Moment) -> f64; 2] = [|m| m.contraction, |m| m.pressure];
    let whole = read.map(|of| scale(rows.iter().map(|row| of(&moments[*row]))));
    let is_driven = [0, 1].map(|axis: usize| {
        let [middle, half] = whole[axis];
        let least = (DRIVEN * half).max(HELD[axis] * (middle.abs() + half));
        let goes = |(_, block): &&(usize, Range<usize>)| {
            scale(rows[block.clone()].iter().map(|row| read[axis](&moments[*row])))[1] > least
        };
        2 * blocks.iter().filter(goes).count() > blocks.len()
    });
    let (driven, held) = match is_driven {
        [true, false] => (0, 1),
        [false, true] => (1, 0),
        _ => return None,
    };
    let mut means: Vec<f64> = blocks
        .iter()
        .map(|(_, block)| {
            rows[block.clone()].iter().map(|row| read[held](&moments[*row])).sum::<f64>() / block.len() as f64
        })
        .collect();
    means.sort_by(f64::total_cmp);
    let largest = means.last().map_or(0.0, |mean| mean.abs());
    let levels = 1 + means.windows(2).filter(|pair| pair[1] - pair[0] > GAP * largest).count();
    let specimens = record.specimens().len();
    let held_degree = (levels - 1).min(HELD_DEGREE[driven]);
    let columns = |degrees: [usize; 2]| (degrees[0] + degrees[1] + 2) * (held_degree + 1) + specimens - 1;
    let degrees = DEGREES.into_iter().find(|degrees| ROWS_PER_COLUMN * columns(*degrees) <= rows.len())?;
    let mut design = Vec::with_capacity(rows.len() * columns(degrees));
    for row in rows {
        let moment = &moments[*row];
        let at = |axis: usize| (read[axis](moment) - whole[axis][0]) / whole[axis][1];
        let (x, y) = (at(driven), at(held));
        for (sign, degree) in [1.0, moment.branch()].into_iter().zip(degrees) {
            for i in 0..=degree {
                design.extend((0..=held_degree).map(|j| sign * chebyshev(i, x) * chebyshev(j, y)));
            }
        }
        design.extend((1..specimens).map(|one| f64::from(u8::from(moment.specimen as usize == one))));
    }
    Some(Basis::of(&design, rows.len()))
}

/// Variations along the sweep as columns: linear in contraction and in pressure, in the direction, in both
/// together, and a step at each position.
fn along(record: &Record, rows: &[usize], block: &Range<usize>) -> Vec<Vec<f64>> {
    let moments = record.moments();
    let own = |of: &dyn Fn(&Moment) -> f64| {
        let mut column = vec![0.0; rows.len()];
        for place in block.clone() {
            column[place] = of(&moments[rows[place]]);
        }
        column
    };
    let of = |axis: fn(&Moment) -> f64| scale(rows[block.clone()].iter().map(|row| axis(&moments[*row])));
    let ([e, half_e], [p, half_p]) = (of(|m| m.contraction), of(|m| m.pressure));
    let mut columns = vec![
        own(&|m| (m.contraction - e) / half_e),
        own(&|m| (m.pressure - p) / half_p),
        own(&Moment::branch),
        own(&|m| m.branch() * (m.contraction - e) / half_e),
    ];
    columns.extend((1..PARTS).map(|part| {
        let mut column = vec![0.0; rows.len()];
        column[block.start + part * block.len() / PARTS..block.end].fill(1.0);
        column
    }));
    columns
}

#[cfg(test)]
mod tests {
    use super::*;
    use bulge_numerics::Random;

    /// Loops of 60 rows at pressures \[bar\], one sweep each.
    fn loops(pressures: &[f64]) -> Record {
        there_and_back(pressures, |bar, part, way| Moment {
            direction: way,
            ..Moment::at_rest(1e5 * bar, 0.01 + 0.19 * part)
        })
    }

    /// Filling and venting in 60 rows at contractions, one sweep each.
    fn fillings(contractions: &[f64]) -> Record {
        there_and_back(contractions, |contraction, part, way| Moment {
            pressure_direction: way,
            ..Moment::at_rest(1e5 * (0.5 + 4.5 * part), contraction)
        })
    }

    fn there_and_back(held: &[f64], moment: impl Fn(f64, f64, f64) -> Moment) -> Record {
        let row = |sweep: usize, i: usize| {
            let x = i as f64 / 60.0;
            let way = if x < 0.5 { 1.0 } else { -1.0 };
            let moment = moment(held[sweep], 1.0 - (2.0 * x - 1.0).abs(), way);
            Moment { begins: i == 0, clock: (100 * sweep + i) as f64, ..moment }
        };
        let moments: Vec<Moment> = (0..held.len())
            .flat_map(|sweep| (0..60).map(move |i| (sweep, i)))
            .map(|(s, i)| row(s, i))
            .collect();
        let n = moments.len();
        Record::from_moments(moments, vec![0.0; n], (0..held.len()).map(|s| 60 * s..60 * s + 60).collect())
            .unwrap()
    }

    /// Rubber that the model lacks gives residuals that are curved in the length. With four lengths no shift
    /// is found, and with two sweeps at one length it is ambiguous; with seven lengths or three sweeps at one
    /// length it is found.
    #[test]
    fn at_held_lengths_what_goes_with_the_length_is_no_shift() {
        for (lengths, finds) in [
            (&[0.02, 0.06, 0.10, 0.14][..], false),
            (&[0.0, 0.02, 0.05, 0.08, 0.11, 0.13, 0.15], true),
            (&[0.02, 0.14, 0.02, 0.14, 0.02, 0.14], true),
            (&[0.02, 0.08, 0.14, 0.02, 0.08, 0.14], false),
        ] {
            let record = fillings(lengths);
            let used = vec![true; record.len()];
            let mut random = Random::new(4, 0);
            let rubber = |m: &Moment| -60.0 * (6.0 * m.contraction).exp() * (1.0 + 0.1 * m.pressure / 1e5);
            let mut residuals: Vec<f64> =
                record.moments().iter().map(|m| rubber(m) + random.normal()).collect();
            assert_eq!(shifted(&record, &used, &residuals, 1.0), None, "{lengths:?}");
            residuals[120..180].iter_mut().for_each(|value| *value += 8.0);
            let found = shifted(&record, &used, &residuals, 1.0);
            assert_eq!(found.map(|found| found.sweep), finds.then_some(2), "{lengths:?}");
        }
    }

    /// Missing rubber, friction that grows with the pressure, a small term quadratic in the pressure, and
    /// noise of 1 N.
    fn misfit(record: &Record, seed: u64) -> Vec<f64> {
        let mut random = Random::new(seed, 0);
        let of = |m: &Moment| {
            let bar = m.pressure / 1e5;
            -60.0 * (6.0 * m.contraction).exp() - (4.0 + 3.0 * bar) * m.direction
                + 10.0 * bar * m.contraction
                + 0.1 * bar * bar * m.contraction
        };
        record.moments().iter().map(|m| of(m) + random.normal()).collect()
    }

    #[test]
    fn a_sweep_that_is_off_is_found_with_its_offset_and_no_other() {
        for (pressures, place) in [
            (&[1.0, 2.0, 3.0, 4.0, 5.0][..], 2),
            (&[2.0, 2.0, 2.0, 2.0], 3),
            (&[1.0, 2.0, 3.0, 1.0, 2.0, 3.0], 0),
            (&[2.0, 3.0, 4.0, 5.0], 1),
        ] {
            let record = loops(pressures);
            let used = vec![true; record.len()];
            let mut clean = 0;
            for seed in 0..20 {
                let mut residuals = misfit(&record, seed);
                clean += usize::from(shifted(&record, &used, &residuals, 1.0).is_some());
                for value in &mut residuals[record.sweeps()[place].clone()] {
                    *value -= 6.0;
                }
                let found = shifted(&record, &used, &residuals, 1.0);
                assert_eq!(found.map(|found| found.sweep), Some(place), "{pressures:?} {seed}");
                let found = found.unwrap();
                // For an inner sweep of four, the surface leaves three tenths of the information of 60 rows.
                assert!((found.offset_n + 6.0).abs() < 1.2, "{pressures:?}: {}", found.offset_n);
            }
            assert_eq!(clean, 0, "{pressures:?}");
            // Without noise, the offset is exact.
            let mut exact: Vec<f64> =
                record.moments().iter().map(|m| 3.0 * m.pressure / 1e5 * m.direction).collect();
            exact[record.sweeps()[place].clone()].iter_mut().for_each(|value| *value -= 6.0);
            let found = shifted(&record, &used, &exact, 1.0).unwrap();
            assert!((found.offset_n + 6.0).abs() < 1e-9, "{pressures:?}: {}", found.offset_n);
        }
    }

    /// Pressures \[bar\], and the term added to the residuals.
    type Case<'c> = (&'c [f64], &'c dyn Fn(&Moment) -> f64);

    #[test]
    fn what_changes_along_a_sweep_is_no_shift_nor_what_two_sweeps_may_have() {
        let record = loops(&[1.0, 2.0, 3.0, 4.0, 5.0]);
        let used = vec![true; record.len()];
        for (name, own) in [
            ("friction", (|m: &Moment| 9.0 * m.direction) as fn(&Moment) -> f64),
            ("stiffness", |m| 100.0 * m.contraction),
        ] {
            let mut residuals = misfit(&record, 3);
            for row in record.sweeps()[2].clone() {
                residuals[row] += own(&record.moments()[row]);
            }
            assert_eq!(shifted(&record, &used, &residuals, 1.0), None, "{name}");
        }
        // A jump within a sweep leaves its beginning in place.
        for jump in [8, 15, 30, 45, 54] {
            let mut residuals = misfit(&record, 3);
            residuals[120 + jump..180].iter_mut().for_each(|value| *value += 20.0);
            assert_eq!(shifted(&record, &used, &residuals, 1.0), None, "{jump}");
        }
        // With three sweeps the shifted one is ambiguous; two shifted sweeps are not unique; and curvature in
        // the pressure is physics.
        let bent = |m: &Moment| 6.0 * (m.pressure / 1e5 - 3.5).powi(2);
        let second = |m: &Moment| if (m.pressure - 3e5).abs() < 1e4 { 6.0 } else { 0.0 };
        let both = |m: &Moment| if (m.pressure - 3.5e5).abs() < 6e4 { 6.0 } else { 0.0 };
        let cases: [Case<'_>; 3] =
            [(&[2.0, 3.0, 4.0], &second), (&[2.0, 3.0, 4.0, 5.0], &both), (&[2.0, 3.0, 4.0, 5.0], &bent)];
        for (pressures, own) in cases {
            let record = loops(pressures);
            let mut residuals = misfit(&record, 3);
            for (value, moment) in residuals.iter_mut().zip(record.moments()) {
                *value += own(moment);
            }
            assert_eq!(shifted(&record, &vec![true; record.len()], &residuals, 1.0), None, "{pressures:?}");
        }
    }
}
