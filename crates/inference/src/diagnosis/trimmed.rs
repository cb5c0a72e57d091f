//! Least trimmed squares of the base (Rousseeuw 1984): the rows that it fits if a quarter of them may be
//! anything. It is linearised at its numbers, in newtons and not whitened: a law of the noise that was
//! estimated from spoilt rows would spread each of them over its neighbours.

use bulge_measurements::Channel;
use bulge_model::{ModelError, Record};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use std::ops::Range;

use crate::diagnosis::tangents::Tangents;
use crate::fit::nuisance::Prepared;
use crate::median::robust_sd;
use crate::vector::count;
use bulge_numerics::vector::{add, dot, norm};

/// One in so many rows may be anything.
const SPOILT: usize = 4;
/// Fraction of the rows that may be odd in the end.
const MOST: f64 = 0.3;
/// Standard deviations from which a row is odd: a normal variable exceeds them once in 2000 rows.
const FAR: f64 = 3.5;
/// Starts without a quarter of the record.
const PARTS: usize = 8;
/// Most concentration steps; each lowers the sum, and a few suffice.
const STEPS: usize = 30;

/// Lengths of blocks of neighbouring values, and fewest of them.
const BLOCKS: [usize; 3] = [4, 16, 64];
const FEWEST_BLOCKS: usize = 6;
/// Starts of windows in which a channel may be shifted, and fewest rows of each.
const WINDOWS: usize = 60;
const FEWEST: usize = 5;
/// A channel explains as much as another if its sum of squares is at least this fraction of the other's.
const ALIKE: f64 = 0.9;
/// Fraction of a shift that the numbers of the model must leave.
const SEEN: f64 = 0.02;
/// Sum of squares of what explains a part of the rows, in variances of what is left: 6 sigma, of some hundreds of parts
/// that are tried.
const CLEAR: f64 = 36.0;

/// A model linearised at its numbers.
#[derive(Clone)]
pub(crate) struct Linearised {
    /// Derivative of the force by each free number.
    columns: Vec<Vec<f64>>,
    /// What the prior of a free number asks it to change by, with its standard deviation.
    priors: Vec<Option<[f64; 2]>>,
    /// Measured less computed force \[N\].
    residual: Vec<f64>,
}

/// One more number of a model.
#[derive(Debug, Clone, Copy)]
pub(crate) struct OneMore {
    pub(crate) number: f64,
    /// What the cost falls by \[N^2\].
    pub(crate) gain: f64,
    /// What the number costs of twice the log evidence: ln(1 + (width / sd of the number)^2).
    pub(crate) charge: f64,
}

/// What a claim explains in some rows.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Share {
    /// Its sum of squares beside the numbers of the base, in variances of what the base leaves there.
    pub(crate) expected: f64,
    /// Fraction of it that the readings show: 1 if the claim is right, 0 if the rows know nothing of it.
    pub(crate) shown: f64,
}

impl Linearised {
    /// A model at numbers `theta`.
    pub(crate) fn of(prepared: &Prepared, theta: &[f64], record: &Record) -> Result<Self, ModelError> {
        let tangents = Tangents::of(prepared, theta, record)?;
        let prior = |index: &usize| {
            let (mean, sd) = prepared.priors[*index].filter(|_| prepared.nuisance[*index])?;
            Some([mean - theta[*index], sd])
        };
        let priors = tangents.free.iter().map(prior).collect();
        Ok(Self { columns: tangents.columns, priors, residual: tangents.residual })
    }

    /// The same with further free numbers, each with this prior.
    pub(crate) fn with(&self, columns: Vec<Vec<f64>>, prior: Option<[f64; 2]>) -> Self {
        let mut with = self.clone();
        with.priors.resize(with.priors.len() + columns.len(), prior);
        with.columns.extend(columns);
        with
    }

    /// Each column as one more number with a prior of a `width` around 0, for noise of `sd`; the others make room for it.
    pub(crate) fn one_more(&self, columns: &[Vec<f64>], width: f64, sd: f64) -> Option<Vec<OneMore>> {
        let all = vec![true; self.residual.len()];
        let numbers = self.on(&all, sd)?;
        let left = numbers.outside(&self.residual, 1.0);
        let each = |column: &Vec<f64>| {
            // What the priors hold of the others counts as readings do, and is outside of the column.
            let seen = dot(column, &numbers.outside(column, 0.0));
            let (along, stiff) = (dot(column, &left), (sd / width).powi(2));
            OneMore {
                charge: (seen / stiff).max(0.0).ln_1p(),
                number: along / (seen + stiff),
                gain: along * along / (seen + stiff),
            }
        };
        Some(columns.iter().map(each).collect())
    }

    pub(crate) fn rows(&self) -> usize {
        self.residual.len()
    }

    /// How many free numbers it has.
    pub(crate) fn len(&self) -> usize {
        self.columns.len()
    }

    /// What its free numbers change by to follow all readings, for noise of `sd` \[N\].
    pub(crate) fn numbers(&self, sd: f64) -> Option<Vec<f64>> {
        Some(self.on(&vec![true; self.residual.len()], sd)?.numbers(&self.residual, 1.0))
    }

    /// Rows that the model doesn't fit, if they are few.
    pub(crate) fn odd(&self) -> Option<Vec<bool>> {
        let rows = self.residual.len();
        let spoilt = rows / SPOILT;
        // From all rows, and from those without a part of the record: many spoilt rows draw the first fit to them.
        let parts = (0..PARTS).map(|part| part * rows / PARTS);
        let starts = std::iter::once(rows)
            .chain(parts)
            .map(|start| (0..rows).map(|row| row < start || row >= start + spoilt).collect::<Vec<bool>>());
        let best = starts.filter_map(|kept| self.concentrated(kept, rows - spoilt));
        let (_, mut left) = best.min_by(|a, b| a.0.total_cmp(&b.0))?;
        // The best three quarters say how large the noise is, and the noise which rows are odd.
        let mut kept = Vec::new();
        for _ in 0..STEPS {
            let sd = robust_sd(&left);
            let near: Vec<bool> = left.iter().map(|left| left.abs() <= FAR * sd).collect();
            if near == kept {
                break;
            }
            kept = near;
            left = self.left(&kept)?;
        }
        let odd: Vec<bool> = kept.iter().map(|kept| !kept).collect();
        let count = count(&odd);
        (count > 0 && count as f64 <= MOST * rows as f64).then_some(odd)
    }

    /// The least sum of squares of `most` rows that concentration steps reach from a start, and what is left of
    /// all.
    fn concentrated(&self, mut kept: Vec<bool>, most: usize) -> Option<(f64, Vec<f64>)> {
        let mut reached = (f64::INFINITY, Vec::new());
        for _ in 0..STEPS {
            let left = self.left(&kept)?;
            let mut order: Vec<usize> = (0..left.len()).collect();
            order.sort_by(|a, b| left[*a].abs().total_cmp(&left[*b].abs()));
            let sum: f64 = order[..most].iter().map(|row| left[*row].powi(2)).sum();
            if sum >= reached.0 {
                break;
            }
            reached = (sum, left);
            kept.fill(false);
            order[..most].iter().for_each(|row| kept[*row] = true);
        }
        Some(reached)
    }

    /// What `claimed` newtons explain in the rows that are kept; none if nothing can be fitted there.
    pub(crate) fn share(&self, claimed: &[f64], kept: &[bool]) -> Option<Share> {
        let only = |values: Vec<f64>| -> Vec<f64> {
            values.into_iter().zip(kept).filter(|(_, kept)| **kept).map(|(value, _)| value).collect()
        };
        let left = only(self.left(kept)?);
        let sd = robust_sd(&left);
        let claimed = only(self.on(kept, sd)?.outside(claimed, 0.0));
        let square = dot(&claimed, &claimed);
        (square > 0.0).then(|| Share {
            expected: square / (sd * sd * shared(&left)).max(f64::MIN_POSITIVE),
            shown: dot(&claimed, &left) / square,
        })
    }

    /// RMS that the model leaves in the rows that are kept, over that in all.
    pub(crate) fn falls_to(&self, kept: &[bool]) -> Option<f64> {
        let size = |kept: &[bool]| {
            let square = self.square_of(&self.residual, kept)?;
            Some((square / count(kept).max(1) as f64).sqrt())
        };
        let before = size(&vec![true; kept.len()])?;
        (before > 0.0).then_some(size(kept)? / before)
    }

    /// Sum of squares that the model leaves of other readings in the rows that are kept, its numbers drawn to them;
    /// `residual` is what it leaves at its own numbers \[N\].
    pub(crate) fn square_of(&self, residual: &[f64], kept: &[bool]) -> Option<f64> {
        let left = self.left_of(residual, kept)?;
        Some(left.iter().zip(kept).filter(|(_, kept)| **kept).map(|(left, _)| left * left).sum())
    }

    /// The least sum of squares that the model leaves of all rows, with what its priors cost, for noise of `sd` \[N^2\].
    pub(crate) fn cost(&self, sd: f64) -> Option<f64> {
        let numbers = self.numbers(sd)?;
        let mut left = self.residual.clone();
        let mut cost = 0.0;
        for ((column, prior), number) in self.columns.iter().zip(&self.priors).zip(numbers) {
            add(&mut left, -number, column);
            cost += prior.map_or(0.0, |[mean, width]| (sd * (number - mean) / width).powi(2));
        }
        Some(cost + dot(&left, &left))
    }

    /// What the model leaves of the readings of all rows if its numbers are those of the rows that are kept
    /// \[N\].
    pub(crate) fn left(&self, kept: &[bool]) -> Option<Vec<f64>> {
        self.left_of(&self.residual, kept)
    }

    /// The same of other readings.
    pub(crate) fn left_of(&self, residual: &[f64], kept: &[bool]) -> Option<Vec<f64>> {
        // The weight of the priors depends on the noise, and the noise on what is left: twice is enough.
        let first = self.on(kept, robust_sd(residual))?.outside(residual, 1.0);
        Some(self.on(kept, robust_sd(&first))?.outside(residual, 1.0))
    }

    /// The numbers of the model as the rows that are kept determine them, for noise of `sd`; none if they can't.
    fn on<'a>(&'a self, kept: &'a [bool], sd: f64) -> Option<Determined<'a>> {
        let columns: Vec<Vec<f64>> = self.columns.iter().map(|column| chosen(column, kept)).collect();
        // A number that these rows know nothing of.
        let or_one = |size: f64| if size > 0.0 { size } else { 1.0 };
        let sizes: Vec<f64> = columns.iter().map(|column| or_one(norm(column))).collect();
        let count = columns.len();
        let mut matrix =
            DMatrix::from_fn(count, count, |a, b| dot(&columns[a], &columns[b]) / (sizes[a] * sizes[b]));
        let mut drawn = vec![0.0; count];
        for (place, prior) in self.priors.iter().enumerate() {
            // Numbers that two columns can't tell apart share what they explain.
            matrix[(place, place)] += f64::EPSILON.sqrt();
            if let Some([mean, width]) = prior {
                let weight = (sd / width).powi(2) / sizes[place];
                matrix[(place, place)] += weight / sizes[place];
                drawn[place] = weight * mean;
            }
        }
        Some(Determined { model: self, kept, sizes, drawn, factor: matrix.cholesky()? })
    }
}

/// Values in the rows that are kept, and 0 elsewhere.
pub(crate) fn chosen(values: &[f64], kept: &[bool]) -> Vec<f64> {
    values.iter().zip(kept).map(|(value, kept)| if *kept { *value } else { 0.0 }).collect()
}

/// The numbers of a linearised model, determined by some of the rows.
struct Determined<'a> {
    model: &'a Linearised,
    kept: &'a [bool],
    /// Norm of each column in the rows that are kept.
    sizes: Vec<f64>,
    /// What the priors add to the right-hand side if the numbers are drawn to them.
    drawn: Vec<f64>,
    /// Of the normal matrix of columns of norm 1.
    factor: Cholesky<f64, Dyn>,
}

impl Determined<'_> {
    /// Values without what the numbers of the model make of them; `towards` is 1 if the numbers are drawn to their
    /// priors, 0 if they are only held by them.
    fn outside(&self, values: &[f64], towards: f64) -> Vec<f64> {
        let mut outside = values.to_vec();
        for (column, number) in self.model.columns.iter().zip(self.numbers(values, towards)) {
            add(&mut outside, -number, column);
        }
        outside
    }

    /// What the numbers of the model change by to follow values.
    fn numbers(&self, values: &[f64], towards: f64) -> Vec<f64> {
        let target = chosen(values, self.kept);
        let right = self.model.columns.iter().zip(&self.sizes).zip(&self.drawn);
        let right = right.map(|((column, size), drawn)| dot(column, &target) / size + towards * drawn);
        let scaled = self.factor.solve(&DVector::from_iterator(self.sizes.len(), right));
        scaled.iter().zip(&self.sizes).map(|(number, size)| number / size).collect()
    }
}

impl Linearised {
    /// The shift of a channel within a window of rows that explains most of the misfit, if that is a sum of squares
    /// of at least `least` \[N^2\], no chance, and more than a shift of all rows explains. `slopes` are the changes of
    /// the force by each channel.
    pub(crate) fn shift(
        &self,
        slopes: &[(Channel, Vec<f64>)],
        sweeps: &[Range<usize>],
        least: f64,
    ) -> Option<Shift> {
        let rows = self.residual.len();
        let all = vec![true; rows];
        let left = self.left(&all)?;
        let numbers = self.on(&all, robust_sd(&left))?;
        // A channel within a window, beside the numbers of the model: what its shift explains, its size, its column.
        let tried = |(channel, slopes): &(Channel, Vec<f64>), window: &Range<usize>| {
            let mut column = vec![0.0; rows];
            column[window.clone()].copy_from_slice(&slopes[window.clone()]);
            let outside = numbers.outside(&column, 0.0);
            let (own, along) = (dot(&outside, &outside), dot(&outside, &left));
            let is_seen = own > SEEN * dot(&column, &column);
            is_seen.then(|| (along * along / own, (*channel, along / own), outside))
        };
        let best = |windows: Vec<Range<usize>>| {
            let each = windows.into_iter().flat_map(|window| {
                slopes.iter().filter_map(move |slopes| Some((tried(slopes, &window)?.0, window.clone())))
            });
            each.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, window)| window)
        };
        let stride = (rows / WINDOWS).max(1);
        let rough = best(windows(rows, stride, sweeps))?;
        // Nearer to the row itself.
        let near = rough.start.saturating_sub(stride)..(rough.start + stride).min(rough.end);
        let near = near.map(|start| start..rough.end).filter(|window| (FEWEST..rows).contains(&window.len()));
        let window = best(near.collect())?;
        let mut channels: Vec<_> = slopes.iter().filter_map(|slopes| tried(slopes, &window)).collect();
        channels.sort_by(|a, b| b.0.total_cmp(&a.0));
        let (most, (_, by), outside) = channels.first()?;
        let mut rest = left.clone();
        add(&mut rest, -by, outside);
        let chance = by_chance(&rest);
        let alike = channels.iter().filter(|(gain, _, _)| *gain >= ALIKE * most);
        let by = alike.map(|(_, by, _)| *by).collect();
        let rest_n = (dot(&rest, &rest) / rows as f64).sqrt();
        // What a shift of all rows explains as well is no event, however few of them could deny it.
        let in_all =
            slopes.iter().filter_map(|slopes| Some(tried(slopes, &(0..rows))?.0)).fold(0.0, f64::max);
        let is_event = *most - in_all > chance || in_all < ALIKE * most;
        let is_clear = *most > least && *most > chance && is_event;
        is_clear.then(|| Shift { window, by, explained: *most, more: most - chance, rest_n })
    }
}

/// Sum of squares that a choice among some hundreds may explain of noise such as this \[N^2\].
pub(crate) fn by_chance(left: &[f64]) -> f64 {
    CLEAR * variance(left)
}

/// Variance of noise such as this, with what neighbours share \[N^2\].
pub(crate) fn variance(left: &[f64]) -> f64 {
    robust_sd(left).powi(2) * shared(left)
}

/// Windows in which a channel may be shifted: to the end of the record, to the end of a sweep, a whole sweep.
fn windows(rows: usize, stride: usize, sweeps: &[Range<usize>]) -> Vec<Range<usize>> {
    let starts = (FEWEST..rows).step_by(stride).chain(sweeps.iter().map(|sweep| sweep.start));
    let ends = |start: usize| {
        let own = sweeps.iter().find(|sweep| sweep.contains(&start)).map(|sweep| sweep.end);
        [Some(rows), own.filter(|end| *end < rows)].into_iter().flatten()
    };
    let windows = starts.flat_map(|start| ends(start).map(move |end| start..end));
    windows.filter(|window| window.len() >= FEWEST && window.len() < rows).collect()
}

/// A channel that is shifted within a window.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Shift {
    pub(crate) window: Range<usize>,
    /// The channel and by how much, in its unit; others that explain as much follow.
    pub(crate) by: Vec<(Channel, f64)>,
    /// Sum of squares that it explains \[N^2\],
    pub(crate) explained: f64,
    /// and beyond chance.
    pub(crate) more: f64,
    /// RMS of what it leaves \[N\].
    pub(crate) rest_n: f64,
}

/// Factor by which what neighbouring values share makes sums of them vary more than those of independent ones, from
/// the means of blocks.
fn shared(values: &[f64]) -> f64 {
    let square = |values: &mut dyn Iterator<Item = f64>| {
        let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value * value, count + 1.0));
        sum / f64::max(count, 1.0)
    };
    let single = square(&mut values.iter().copied()).max(f64::MIN_POSITIVE);
    let of_blocks =
        BLOCKS.into_iter().filter(|length| values.len() >= FEWEST_BLOCKS * length).map(|length| {
            let means = values.chunks_exact(length).map(|block| block.iter().sum::<f64>() / length as f64);
            length as f64 * square(&mut means.into_iter()) / single
        });
    of_blocks.fold(1.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use bulge_numerics::Random;

    /// 100 readings of 2 + 3 x with noise of 0.1, every `of`-th of them spoilt by 20 N, all to one side.
    fn line(of: usize) -> Linearised {
        let mut random = Random::new(5, 0);
        let x: Vec<f64> = (0..100).map(|row| f64::from(row) / 99.0).collect();
        let spoilt = |row: usize| if row.is_multiple_of(of) { 20.0 * x[row] + 5.0 } else { 0.0 };
        let residual = (0..100).map(|row| 2.0 + 3.0 * x[row] + 0.1 * random.normal() + spoilt(row)).collect();
        Linearised { columns: vec![vec![1.0; 100], x], priors: vec![None; 2], residual }
    }

    #[test]
    fn a_fifth_of_the_rows_may_be_anything() {
        let odd = line(5).odd().unwrap();
        assert!((0..100).all(|row| odd[row] == row.is_multiple_of(5)), "{odd:?}");
        assert!(line(200).odd().is_none_or(|odd| count(&odd) == 1));
        // A third is too much to be odd.
        assert!(line(3).odd().is_none());
    }

    #[test]
    fn a_number_that_the_rows_know_nothing_of_changes_nothing() {
        let with = line(5).with(vec![vec![0.0; 100]], None);
        let kept: Vec<bool> = (0..100).map(|row| row % 5 > 0).collect();
        assert_eq!(with.left(&kept), line(5).left(&kept));
        assert!(with.numbers(0.1).unwrap()[2].abs() < 1e-300);
    }

    /// Mean m of n readings, drawn to a prior of width w around a by noise of sd: the least of
    /// n (b - m)^2 + (sd/w)^2 (b - a)^2 is that of two springs in series.
    #[test]
    fn what_a_prior_costs_is_that_of_springs_in_series() {
        let residual: Vec<f64> = (0..8).map(|row| 3.0 + f64::from([1, -1][row % 2])).collect();
        let own = Linearised { columns: Vec::new(), priors: Vec::new(), residual };
        for (mean, width, sd) in [(0.0, 0.5, 2.0), (4.0, 0.1, 0.3), (1.0, 10.0, 1.0)] {
            let with = own.with(vec![vec![1.0; 8]], Some([mean, width]));
            let stiff: f64 = (sd / width).powi(2);
            let expected = 8.0 + 8.0 * stiff / (8.0 + stiff) * (3.0 - mean).powi(2);
            let cost = with.cost(sd).unwrap();
            assert!((cost / expected - 1.0).abs() < 1e-6, "{cost} {expected}");
            let number = with.numbers(sd).unwrap()[0];
            assert!((number - (24.0 + stiff * mean) / (8.0 + stiff)).abs() < 1e-6, "{number}");
        }
    }

    /// One more number lowers the cost by what is said without solving for it, beside numbers with and without priors.
    #[test]
    fn one_more_number_gains_what_the_cost_falls_by() {
        let slope: Vec<f64> = (0..100).map(|row| (f64::from(row) / 7.0).sin()).collect();
        let base = line(5).with(vec![(0..100).map(|row| f64::from(row % 9)).collect()], Some([0.3, 0.2]));
        for (width, sd) in [(0.05, 0.4), (2.0, 0.4), (0.3, 3.0)] {
            let one = base.one_more(std::slice::from_ref(&slope), width, sd).unwrap()[0];
            let with = base.with(vec![slope.clone()], Some([0.0, width]));
            let falls = base.cost(sd).unwrap() - with.cost(sd).unwrap();
            assert!((one.gain / falls - 1.0).abs() < 1e-5, "{} {falls}", one.gain);
            assert!((one.number / with.numbers(sd).unwrap()[3] - 1.0).abs() < 1e-5);
        }
    }

    #[test]
    fn a_channel_that_slips_is_found_with_its_row_and_size() {
        let mut line = line(200);
        line.residual[0] = 2.0;
        let waves = (0..100).map(|row| 4.0 + (0.3 * f64::from(row)).sin()).collect();
        let slopes = [(Channel::Force, vec![1.0; 100]), (Channel::Motion, waves)];
        let sweeps = [0..50, 50..100];
        assert_eq!(line.shift(&slopes, &sweeps, 0.0), None);
        let whole = line.residual.clone();
        for (channel, window) in [(0, 37..100), (1, 37..100), (1, 20..50), (1, 50..100)] {
            line.residual.clone_from(&whole);
            for row in window.clone() {
                line.residual[row] += 0.5 * slopes[channel].1[row];
            }
            let shift = line.shift(&slopes, &sweeps, 0.0).unwrap();
            assert_eq!(shift.window, window);
            assert!(shift.by[0].0 == slopes[channel].0 && (shift.by[0].1 - 0.5).abs() < 0.05, "{shift:?}");
        }
        // A channel that is off in all rows is off in all but a few as well: those few can't deny it.
        let sine =
            [(Channel::Pressure, (0..100).map(|row| (0.3 * f64::from(row)).sin()).collect::<Vec<f64>>())];
        line.residual = whole.iter().zip(&sine[0].1).map(|(left, slope)| left + 0.5 * slope).collect();
        assert_eq!(line.shift(&sine, &sweeps, 0.0), None);
        // A channel that explains as much is named beside it, by its own size.
        let half = (Channel::Pressure, slopes[0].1.iter().map(|slope| 0.5 * slope).collect());
        line.residual = (37..100).fold(whole, |mut residual, row| {
            residual[row] += 0.5;
            residual
        });
        let both = line.shift(&[slopes[0].clone(), half, slopes[1].clone()], &sweeps, 0.0).unwrap();
        assert_eq!(
            both.by.iter().map(|by| by.0).collect::<Vec<_>>()[..2],
            [Channel::Force, Channel::Pressure]
        );
        assert!((both.by[1].1 / both.by[0].1 - 2.0).abs() < 1e-9, "{both:?}");
        // Without noise its size is exact, and nothing is chance.
        line.residual = (37..100).fold(vec![1.0; 100], |mut residual, row| {
            residual[row] += 0.5 * slopes[1].1[row];
            residual
        });
        let shift = line.shift(&slopes, &sweeps, 0.0).unwrap();
        assert!((shift.by[0].1 - 0.5).abs() < 1e-6 && shift.window == (37..100), "{shift:?}");
        let column = (0..100).map(|row| if row < 37 { 0.0 } else { slopes[1].1[row] }).collect::<Vec<f64>>();
        let outside = line.on(&[true; 100], 1.0).unwrap().outside(&column, 0.0);
        assert!((shift.more / (0.25 * dot(&outside, &outside)) - 1.0).abs() < 1e-6, "{shift:?}");
    }

    #[test]
    fn what_is_claimed_shows_in_the_other_rows_or_does_not() {
        let mut line = line(5);
        let kept: Vec<bool> = (0..100).map(|row| !usize::is_multiple_of(row, 5)).collect();
        // A parabola, of which the numbers of the line explain a part.
        let claimed: Vec<f64> = line.columns[1].iter().map(|x| 4.0 * x * x).collect();
        let without = line.share(&claimed, &kept).unwrap();
        assert!(without.shown.abs() < 0.15 && without.expected > 64.0, "{without:?}");
        // 4 x^2 at N equal steps h leaves 4^2 h^4 N (N^2 - 1) (N^2 - 4)/180 beside a line (the orthogonal polynomial
        // of the second degree).
        let all = [true; 100];
        let left = line.left(&all).unwrap();
        let found = line.share(&claimed, &all).unwrap().expected * robust_sd(&left).powi(2) * shared(&left);
        let exact = 16.0 * 99.0_f64.powi(-4) * 100.0 * 9_999.0 * 9_996.0 / 180.0;
        assert!((found / exact - 1.0).abs() < 1e-6, "{found} {exact}");
        line.residual.iter_mut().zip(&claimed).for_each(|(residual, claimed)| *residual += claimed);
        let with = line.share(&claimed, &kept).unwrap();
        assert!((with.shown - 1.0).abs() < 0.15, "{with:?}");
        // Without noise it is all there.
        line.residual =
            line.columns[1].iter().zip(&claimed).map(|(x, claimed)| 2.0 + 3.0 * x + claimed).collect();
        assert!((line.share(&claimed, &all).unwrap().shown - 1.0).abs() < 1e-6);
        // Numbers of the line alone are no claim.
        let own = line.share(&line.columns[1].clone(), &kept);
        assert!(own.is_none_or(|own| own.expected < 1e-6), "{own:?}");
    }

    #[test]
    fn shared_noise_counts_as_its_blocks_vary() {
        let mut random = Random::new(11, 0);
        let white: Vec<f64> = (0..6400).map(|_| random.normal()).collect();
        assert!(shared(&white) < 1.5, "{}", shared(&white));
        // Eight neighbours with one value: sums vary as those of an eighth of the rows.
        let steps: Vec<f64> = white.iter().flat_map(|value| [*value; 8]).collect();
        assert!((shared(&steps) - 8.0).abs() < 1.5, "{}", shared(&steps));
        // Blocks of 16 of one sign each: exactly as a sixteenth of the rows, and those of 64 vanish.
        let signs: Vec<f64> = (0..640).map(|row| if row / 16 % 2 == 0 { 1.0 } else { -1.0 }).collect();
        assert!((shared(&signs) - 16.0).abs() < 1e-12, "{}", shared(&signs));
    }

    #[test]
    fn a_prior_holds_a_number_as_its_width_says() {
        // One number with a column of ones, n = 100 readings of 3 N, noise s, prior 1 +- w:
        // (n 3/s^2 + 1/w^2)/(n/s^2 + 1/w^2).
        let model = Linearised {
            columns: vec![vec![1.0; 100]],
            priors: vec![Some([1.0, 0.1])],
            residual: vec![3.0; 100],
        };
        let numbers = model.on(&[true; 100], 2.0).unwrap();
        let left = numbers.outside(&model.residual, 1.0);
        let number = (100.0 * 3.0 / 4.0 + 100.0) / (100.0 / 4.0 + 100.0);
        assert!((left[0] - (3.0 - number)).abs() < 1e-6, "{}", left[0]);
        // Held, not drawn: 3 n/s^2 over the same sum.
        let left = numbers.outside(&model.residual, 0.0);
        assert!((left[0] - (3.0 - 75.0 / 125.0)).abs() < 1e-6, "{}", left[0]);
    }
}
