//! Readings whose zero or gain is another in each sweep: a load cell that is zeroed anew, a displacement transducer that
//! is clamped anew, an amplifier that is set anew. Sweeps that follow each other at rising pressures make an effect of the
//! pressure of it, and those in any order heat, drift or creep.

use bulge_measurements::Channel;
use bulge_muscles::units::significant;
use std::ops::Range;

use crate::diagnosis::odd::{DENIED, SHOWN};
use crate::diagnosis::shift::slopes;
use crate::diagnosis::trimmed::{Linearised, variance};
use crate::diagnosis::write::Findings;
use crate::median::{median, robust_sd};
use crate::vector::minus;

/// Fewest sweeps, and fewest rows for each.
const FEWEST: usize = 3;
const ROWS: usize = 5;
/// Twice the log odds from which one cause is likelier than another, and what each number of a sweep costs of them: a prior
/// about e times as wide as what the number turns out to be.
const LIKELIER: f64 = 9.0;
const COST: f64 = 2.0;
/// What is left over the noise, at most.
const NOISE: f64 = 1.2;
/// Least width of a zero, in standard deviations of the noise.
const LEAST: f64 = 0.01;

/// A reading that is wrong in its zero or in its gain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Wrong {
    Zero(Channel),
    Gain(Channel),
}

impl Wrong {
    /// It in words, with the scale and the unit of its size.
    fn words(self) -> (String, f64, &'static str) {
        let (what, scale, unit) = match self {
            Self::Zero(Channel::Pressure) => ("zero", 1e5, "bar"),
            Self::Zero(Channel::Motion) => ("zero", 0.01, "points"),
            Self::Zero(Channel::Force) => ("zero", 1.0, "N"),
            Self::Gain(_) => ("gain", 0.01, "%"),
        };
        let (Self::Zero(channel) | Self::Gain(channel)) = self;
        let name = if channel == Channel::Motion { "contraction" } else { channel.name() };
        (format!("the {what} of the {name}"), scale, unit)
    }
}

/// What one number of a reading in each sweep leaves.
struct Left {
    wrong: Wrong,
    /// Sum of squares \[N^2\].
    square: f64,
    /// The numbers, sweep by sweep.
    numbers: Vec<f64>,
    linear: Linearised,
}

/// What is said if one number of a reading in each sweep explains clearly more than what was named, and that doesn't
/// show within the sweeps.
pub(crate) fn each_sweep(found: &Findings<'_>, linear: &Linearised) -> Option<String> {
    let (record, base) = (found.context.record, found.search.stages.first()?);
    let (rows, sweeps) = (record.len(), record.sweeps());
    if found.claims().is_empty() || sweeps.len() < FEWEST || rows < ROWS * sweeps.len() {
        return None;
    }
    let all = vec![true; rows];
    let last = &found.last().confirmed;
    let named = Linearised::of(&last.prepared, &last.theta, record).ok()?;
    let sd = robust_sd(&named.left(&all)?);
    // A zero that changes within the data sheet is noise, beside the named effect as without it.
    let stated = last.prepared.model.muscle().instruments().force.map(|force| force.zero());
    let usual = stated.filter(|zero| *zero > 0.0).unwrap_or(found.context.law.offset_n).max(LEAST * sd);
    let in_each = |slope: &[f64]| -> Vec<Vec<f64>> {
        let column = |sweep: &Range<usize>| {
            let mut column = vec![0.0; rows];
            column[sweep.clone()].copy_from_slice(&slope[sweep.clone()]);
            column
        };
        sweeps.iter().map(column).collect()
    };
    let zeros = in_each(&vec![1.0; rows]);
    let named = named.with(zeros.clone(), Some([0.0, usual])).cost(sd)?;
    let each = |(wrong, slope): (Wrong, Vec<f64>)| {
        let beside = match wrong {
            Wrong::Zero(Channel::Force) => linear.clone(),
            Wrong::Zero(_) | Wrong::Gain(_) => linear.with(zeros.clone(), Some([0.0, usual])),
        };
        let linear = beside.with(in_each(&slope), None);
        let numbers = linear.numbers(sd)?.split_off(beside.len());
        Some(Left { wrong, square: linear.cost(sd)?, numbers, linear })
    };
    let mut tried: Vec<Left> = wrong(found)?.into_iter().filter_map(each).collect();
    tried.sort_by(|a, b| a.square.total_cmp(&b.square));
    let best = tried.first()?;
    let variance = variance(&best.linear.left(&all)?);
    let more = (named - best.square) / variance;
    let rmse = |square: f64| (square / rows as f64).sqrt();
    let law = found.context.law;
    if rmse(best.square) > NOISE * law.white_n.hypot(law.correlated_n) {
        return None;
    }
    let share = best.linear.share(&minus(&found.last().linear.force, &base.linear.force), &all)?;
    let is_denied =
        more > 0.0 && share.shown < SHOWN && share.expected * (1.0 - share.shown).powi(2) > DENIED;
    let is_silent = share.expected < DENIED && more > LIKELIER + COST * sweeps.len() as f64;
    let alike = || tried.iter().filter(|other| other.square - best.square < LIKELIER * variance);
    let names: Vec<&str> = found.claims().iter().map(|(name, _)| *name).collect();
    (is_denied || is_silent).then(|| {
        format!(
            "if {} had changed between the sweeps, {} N would be left, {} N with {}, which {} within the sweeps. See that nothing is zeroed, clamped or set anew \
             between sweeps, and measure each set point twice, in another order",
            alike().map(Left::says).collect::<Vec<_>>().join(" or "),
            significant(rmse(best.square), 3),
            significant(rmse(named), 3),
            names.join(" and "),
            if is_denied { "is not seen" } else { "could hardly be seen" },
        )
    })
}

/// What each wrong reading would add to the force, for each unit of its size.
fn wrong(found: &Findings<'_>) -> Option<[(Wrong, Vec<f64>); 5]> {
    let [pressure, motion, force] = slopes(found)?;
    let gain = pressure.iter().zip(found.context.record.moments()).map(|(slope, at)| slope * at.pressure);
    let gain = gain.collect();
    // Not the measured force: that holds what is missing.
    let computed = found.search.stages.first()?.linear.force.clone();
    Some([
        (Wrong::Zero(Channel::Force), force),
        (Wrong::Zero(Channel::Motion), motion),
        (Wrong::Zero(Channel::Pressure), pressure),
        (Wrong::Gain(Channel::Force), computed),
        (Wrong::Gain(Channel::Pressure), gain),
    ])
}

impl Left {
    /// The reading, and the sweep that is furthest from the others.
    fn says(&self) -> String {
        let usual = median(&mut self.numbers.clone());
        let away = self.numbers.iter().map(|number| (number - usual).abs()).enumerate();
        let (sweep, by) = away.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or_default();
        let (what, scale, unit) = self.wrong.words();
        format!("{what} (in sweep {} by {} {unit})", sweep + 1, significant(by / scale, 2))
    }
}
