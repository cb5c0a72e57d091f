//! Readings whose zero or gain is another in each sweep: a load cell that is zeroed anew, a displacement transducer that
//! is clamped anew, an amplifier that is set anew. Sweeps that follow each other at rising pressures make an effect of the
//! pressure of it, and those in any order heat, drift or creep.

use bulge_measurements::{Channel, Data};
use bulge_muscles::units::significant;
use std::ops::Range;
use std::rc::Rc;

use crate::comparison::rows::{full_scale, lines};
use crate::diagnosis::channel::{name, shown, slopes};
use crate::diagnosis::odd::{DENIED, SHOWN};
use crate::diagnosis::shift::is_noise;
use crate::diagnosis::trimmed::{Linearised, variance};
use crate::diagnosis::write::Findings;
use crate::median::median;
use crate::vector::minus;
use bulge_numerics::vector::dot;

/// Fewest sweeps, and fewest rows of one that has a number.
const FEWEST: usize = 3;
const ROWS: usize = 5;
/// Twice the log of the number of effects among which the named one was chosen, some sixty.
const CHOSEN: f64 = 8.0;
/// Twice the log odds up to which two wrong readings are alike.
const ALIKE: f64 = 9.0;
/// Most of them that are said.
const MOST: usize = 3;
/// Standard deviation of a zero or a gain that is set anew, over the largest reading; of a contraction: itself. A tenth of
/// full scale is rare.
const ANEW: f64 = 0.03;
const ANEW_CONTRACTION: f64 = 0.005;
/// Least width of a zero, in standard deviations of the noise.
const LEAST: f64 = 0.01;

/// A reading that is wrong in its zero or in its gain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Wrong {
    Zero(Channel),
    Gain(Channel),
}

/// What a number of a reading in each sweep, or from a sweep on, makes of the data.
struct Each {
    wrong: Wrong,
    /// Rows that have one, and by how much the reading is too small there.
    numbers: Vec<(Range<usize>, f64)>,
    /// What each unit of it adds to the force \[N\], and the width of its number.
    slope: Rc<[f64]>,
    width: f64,
    /// Twice the log evidence but for a constant.
    evidence: f64,
}

/// What is said if a reading whose zero or gain changed between sweeps, each time or once, is as likely a cause as what was
/// named, and that isn't seen within the sweeps.
pub(crate) fn each_sweep(
    found: &Findings<'_>,
    linear: &Linearised,
    data: &Data,
    groups: &[Vec<usize>],
) -> Option<String> {
    let (record, base) = (found.context.record, found.search.stages.first()?);
    let sweeps = record.sweeps().iter().filter(|sweep| sweep.len() >= ROWS).cloned().collect();
    let named = Named::of(found, sweeps).filter(|_| !found.claims().is_empty())?;
    // The formulas of the base may be as wrong as those of what was named.
    let (linear, bending) = with_numbers(linear, base.linear.bent.clone(), 1.0, named.sd)?;
    let mut tried = named.others(found, &linear)?;
    tried.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
    let best = tried.first()?;
    let all = vec![true; record.len()];
    let beside = named.with(&linear, best)?;
    let left = beside.left(&all)?;
    let rmse = (dot(&left, &left) / left.len() as f64).sqrt();
    let share = beside.share(&minus(&found.last().linear.force, &base.linear.force), &all)?;
    let is_seen = share.expected > DENIED && share.shown >= SHOWN;
    if is_seen || !is_noise(found, rmse) || best.evidence - bending - named.evidence < -CHOSEN {
        return None;
    }
    let alike = tried.iter().filter(|other| best.evidence - other.evidence < ALIKE).take(MOST);
    let claims: Vec<&str> = found.claims().iter().map(|(name, _)| *name).collect();
    Some(format!(
        "{} explains these data as well as {}, which isn't seen within the sweeps. See that nothing is zeroed, clamped or set anew \
         between sweeps, and measure each set point twice, in another order",
        alike.map(|each| each.says(data, groups)).collect::<Vec<_>>().join(", or "),
        claims.join(" and "),
    ))
}

/// What was named, beside zeros of the force that change between sweeps by no more than usual: noise.
struct Named {
    sweeps: Vec<Range<usize>>,
    /// Width of the zeros \[N\]: that of the data sheet, or what the law of the noise found.
    usual: f64,
    /// Noise of a row, with what its neighbours share \[N\].
    sd: f64,
    /// Twice the log evidence but for a constant.
    evidence: f64,
}

impl Named {
    fn of(found: &Findings<'_>, sweeps: Vec<Range<usize>>) -> Option<Self> {
        let record = found.context.record;
        let last = &found.last().confirmed;
        let exact = Linearised::of(&last.prepared, &last.theta, record).ok()?;
        let sd = |linear: &Linearised| Some(variance(&linear.left(&vec![true; record.len()])?).sqrt());
        // Its formulas may be a little wrong.
        let bent = &found.last().linear.bent;
        let linear = exact.with(bent.clone(), Some([0.0, 1.0]));
        let without = sd(&linear)?;
        let stated = last.prepared.model.muscle().instruments().force.map(|force| force.zero());
        let usual = stated.filter(|zero| *zero > 0.0).unwrap_or(found.context.law.offset_n);
        let named = Self { sweeps, usual: usual.max(LEAST * without), sd: without, evidence: 0.0 };
        let sd = sd(&named.with_zeros(&linear)?.0)?;
        let named = Self { sd, ..named };
        let (linear, bending) = with_numbers(&exact, bent.clone(), 1.0, sd)?;
        let (linear, charge) = named.with_zeros(&linear)?;
        let evidence = evidence(&linear, charge + bending, sd)?;
        (named.sweeps.len() >= FEWEST).then_some(Self { evidence, ..named })
    }

    fn with_zeros(&self, linear: &Linearised) -> Option<(Linearised, f64)> {
        let ones = vec![1.0; linear.rows()];
        with_numbers(linear, columns(&self.sweeps, &ones), self.usual, self.sd)
    }

    /// Each wrong reading beside the base, with a number in each sweep; and once, from a sweep on, which is chosen.
    fn others(&self, found: &Findings<'_>, base: &Linearised) -> Option<Vec<Each>> {
        let (with_zeros, usually) = self.with_zeros(base)?;
        let sd = self.sd;
        let once = evidence(&with_zeros, usually, sd)?;
        let chosen = 2.0 * (self.sweeps.len() as f64).ln();
        let starts: Vec<Range<usize>> =
            self.sweeps.iter().skip(1).map(|sweep| sweep.start..base.rows()).collect();
        let mut all = Vec::new();
        for (wrong, slope, width) in wrong(found, self.usual)? {
            let is_zero = wrong == Wrong::Zero(Channel::Force);
            let (beside, usually) = if is_zero { (base, 0.0) } else { (&with_zeros, usually) };
            let (linear, charge) = with_numbers(beside, columns(&self.sweeps, &slope), width, sd)?;
            let numbers = linear.numbers(sd)?.split_off(beside.len());
            let numbers = self.sweeps.iter().cloned().zip(numbers).collect();
            let own = evidence(&linear, usually + charge, sd)? - chosen;
            let slope: Rc<[f64]> = slope.into();
            all.push(Each { wrong, numbers, slope: Rc::clone(&slope), width, evidence: own });
            let each = with_zeros.one_more(&columns(&starts, &slope), width, sd)?.into_iter().zip(&starts);
            all.extend(each.map(|(one, rows)| Each {
                wrong,
                numbers: vec![(rows.clone(), one.number)],
                slope: Rc::clone(&slope),
                width,
                evidence: once + one.gain / (sd * sd) - one.charge - chosen,
            }));
        }
        Some(all)
    }

    /// The base with the numbers of a wrong reading.
    fn with(&self, base: &Linearised, other: &Each) -> Option<Linearised> {
        let is_zero = other.wrong == Wrong::Zero(Channel::Force) && other.numbers.len() > 1;
        let beside = if is_zero { base.clone() } else { self.with_zeros(base)?.0 };
        let places: Vec<Range<usize>> = other.numbers.iter().map(|(rows, _)| rows.clone()).collect();
        Some(beside.with(columns(&places, &other.slope), Some([0.0, other.width])))
    }
}

/// Columns of a slope in some rows each.
fn columns(places: &[Range<usize>], slope: &[f64]) -> Vec<Vec<f64>> {
    let column = |rows: &Range<usize>| {
        let mut column = vec![0.0; slope.len()];
        column[rows.clone()].copy_from_slice(&slope[rows.clone()]);
        column
    };
    places.iter().map(column).collect()
}

/// Twice the log evidence of a model but for a constant, for noise of `sd`; `charge` is what its numbers cost.
fn evidence(linear: &Linearised, charge: f64, sd: f64) -> Option<f64> {
    Some(-linear.cost(sd)? / (sd * sd) - charge)
}

/// A model with further numbers, each with a prior of a width around 0; and what they cost of twice the log evidence.
fn with_numbers(
    linear: &Linearised,
    columns: Vec<Vec<f64>>,
    width: f64,
    sd: f64,
) -> Option<(Linearised, f64)> {
    let charge = linear.one_more(&columns, width, sd)?.iter().map(|one| one.charge).sum();
    Some((linear.with(columns, Some([0.0, width])), charge))
}

/// What each wrong reading would add to the force, for each unit that it reads too little; and the width of its number.
fn wrong(found: &Findings<'_>, usual: f64) -> Option<[(Wrong, Vec<f64>, f64); 6]> {
    let record = found.context.record;
    let [pressure, motion, force] = slopes(found)?;
    let by = |slope: &[f64], reading: &dyn Fn(usize) -> f64| -> Vec<f64> {
        slope.iter().enumerate().map(|(row, slope)| slope * reading(row)).collect()
    };
    let moments = record.moments();
    // Not the measured force: that holds what is missing.
    let computed = &found.search.stages.first()?.linear.force;
    let gains = [
        by(&force, &|row| computed[row]),
        by(&motion, &|row| moments[row].contraction),
        by(&pressure, &|row| moments[row].pressure),
    ];
    let largest = moments.iter().map(|moment| moment.pressure).fold(0.0, f64::max);
    let [gain_f, gain_m, gain_p] = gains;
    let full = ANEW * full_scale(record.force(), 0..record.len());
    Some([
        (Wrong::Zero(Channel::Force), force, full.hypot(usual)),
        (Wrong::Zero(Channel::Motion), motion, ANEW_CONTRACTION),
        (Wrong::Zero(Channel::Pressure), pressure, ANEW * largest),
        (Wrong::Gain(Channel::Force), gain_f, ANEW),
        (Wrong::Gain(Channel::Motion), gain_m, ANEW),
        (Wrong::Gain(Channel::Pressure), gain_p, ANEW),
    ])
}

impl Each {
    /// The reading, and the sweep that is furthest from the others.
    fn says(&self, data: &Data, groups: &[Vec<usize>]) -> String {
        let mut numbers: Vec<f64> = self.numbers.iter().map(|(_, number)| *number).collect();
        // Before it changed once there is no number.
        let usual = if numbers.len() == 1 { 0.0 } else { median(&mut numbers) };
        let away = |number: f64| (number - usual).abs();
        let furthest = self.numbers.iter().max_by(|a, b| away(a.1).total_cmp(&away(b.1)));
        let (sweep, number) = furthest.cloned().unwrap_or_default();
        let (Wrong::Zero(channel) | Wrong::Gain(channel)) = self.wrong;
        let rows: Vec<usize> = sweep.filter_map(|place| groups.get(place)).flatten().copied().collect();
        let by = usual - number;
        let side = if by > 0.0 { "more" } else { "less" };
        let (what, by) = match self.wrong {
            Wrong::Zero(_) => ("zero", shown(channel, by)),
            Wrong::Gain(_) => ("gain", format!("{} %", significant((100.0 * by).abs(), 2))),
        };
        format!(
            "a {what} of the {} that changed (line {}: {by} {side} than before or after)",
            name(channel),
            lines(data, &rows)
        )
    }
}
