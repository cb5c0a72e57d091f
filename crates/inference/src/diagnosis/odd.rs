//! Odd rows: those of a file, a sweep or a stretch of the record, rows here and there, or all from some moment on
//! (a sensor zeroed anew, another unit, a reversed column, a reading that is held, a clamp that slipped). If nothing
//! is missing without them, although what was named would have shown in the others, it is no effect of the muscle.

use bulge_effects::Moment;
use bulge_measurements::Data;
use bulge_model::Record;
use std::collections::{BTreeMap, BTreeSet};

use crate::comparison::rows::lines;
use crate::diagnosis::document::Verdict;
use crate::diagnosis::event::{Anew, names, said};
use crate::diagnosis::shift::shifts;
use crate::diagnosis::trimmed::Linearised;
use crate::diagnosis::write::Findings;
use crate::median::median;
use crate::vector::{count, minus};

/// Fewest parts among which one can be odd, and how many of them may be.
const FEWEST: usize = 3;
const ONE_IN: usize = 4;
/// Stretches into which a record is cut: short ones hide no event, and each needs some rows.
const STRETCHES: usize = 24;
/// Mean square of its misfit over the median of all from which a part is odd. An effect of the muscle
/// grows with pressure or length, which makes a factor of 2 or 3 between sweeps.
const ODD: f64 = 4.0;
/// Squared distance, in variances of the noise, of what the other rows show from what was named: 4 sigma.
const DENIED: f64 = 16.0;
/// Fraction of what was named that they show at most if they deny it.
const SHOWN: f64 = 0.5;
/// Part of the misfit that the others may have if nothing is named, or if they could not show it.
const FALLS: f64 = 0.5;
/// Sum of squares of what was named that they could not show, in variances of the noise.
const SILENT: f64 = 64.0;
/// Fraction of the rows on which alone nothing is named: an effect of the muscle shows in its neighbours too.
const FEW: f64 = 0.1;

/// What is said of rows without which nothing of what was named is missing, if there are such.
pub(crate) fn odd(
    found: &Findings<'_>,
    data: &Data,
    groups: &[Vec<usize>],
    Anew { without, .. }: Anew<'_>,
) -> Option<String> {
    let base = found.search.stages.first()?;
    let confirmed = &base.confirmed;
    let linear = Linearised::of(&confirmed.prepared, &confirmed.theta, found.context.record).ok()?;
    let claimed = minus(&found.last().linear.force, &base.linear.force);
    let claims = found.claims();
    // Why an answer may rest on these rows alone; none if the others bear it out.
    let doubt = |odd: &[bool]| {
        let kept: Vec<bool> = odd.iter().map(|odd| !odd).collect();
        let falls = || linear.falls_to(&kept).is_some_and(|part| part < FALLS);
        if claims.is_empty() {
            return falls().then_some(Others::Deny);
        }
        let share = linear.share(&claimed, &kept)?;
        if share.shown < SHOWN && share.expected * (1.0 - share.shown).powi(2) > DENIED {
            return Some(Others::Deny);
        }
        let is_silent = share.expected < SILENT;
        (is_silent && count(odd) as f64 <= FEW * odd.len() as f64 && falls()).then_some(Others::AreSilent)
    };
    let first = |place: &Vec<usize>| place.first().copied().unwrap_or_default();
    let sweep = |row: usize| data.sweeps().partition_point(|sweep| sweep.rows.end <= row);
    let file = |row: usize| data.line(row).0;
    let stretch = |row: usize| row * STRETCHES / data.len();
    let of: [&dyn Fn(usize) -> usize; 3] = [&file, &sweep, &stretch];
    let few = of.into_iter().filter_map(|part| {
        let places = stand_out(found, groups, part)?;
        Some(groups.iter().map(|group| places.contains(&part(first(group)))).collect::<Vec<bool>>())
    });
    let shifts = shifts(found, &linear);
    let mut tried = BTreeSet::new();
    let few = few.chain(linear.odd()).chain(sides(found, data, groups)).map(|odd| (odd, None));
    shifts.into_iter().map(|shifted| (shifted.odd.clone(), Some(shifted))).chain(few).find_map(|(odd, shifted)| {
        let is_better = shifted.as_ref().is_some_and(|shifted| shifted.is_better);
        let others = if is_better { Some(Others::Deny) } else { doubt(&odd) };
        let others = others.filter(|_| tried.insert(odd.clone()))?;
        let own = groups.iter().zip(&odd).filter(|(_, odd)| **odd);
        let mut rows: Vec<usize> = own.flat_map(|(group, _)| group.iter().copied()).collect();
        rows.sort_unstable();
        let rest = without(&rows)?;
        let denied = match rest.verdict {
            Verdict::Adequate => true,
            Verdict::Missing => !claims.is_empty() && !claims.iter().any(|claim| names(&rest, *claim)),
            // Most of the rows know nothing of what a shift of the others explains better.
            Verdict::CannotTell => is_better && 2 * count(&odd) <= odd.len(),
            Verdict::Unknown => false,
        };
        let asks = match others {
            Others::Deny => "some rows ask for something that the others deny",
            Others::AreSilent => "few rows ask for something that the others could not show",
        };
        let as_if = shifted.map_or_else(String::new, |shifted| format!(", as if {} there", shifted.says));
        denied.then(|| {
            let or = beyond(found.context.record, &odd).map_or_else(String::new, |what| {
                format!("; or an effect that begins there: no other row has {what}; measure between")
            });
            format!(
                "{asks}{as_if}: without line {} {}. See what happened there: a fitting that slipped, a sensor zeroed anew, reversed or held, another unit, another \
                 specimen{or}",
                lines(data, &rows),
                said(Some(&rest)),
            )
        })
    })
}

/// What only the odd rows have, if all of them lie beyond the range of the others: what shows there alone needn't
/// be an event.
fn beyond(record: &Record, odd: &[bool]) -> Option<&'static str> {
    type State = fn(&Moment) -> f64;
    let of: [(State, [&'static str; 2]); 2] = [
        (|moment| moment.contraction, ["a contraction as small", "a contraction as large"]),
        (|moment| moment.pressure, ["a pressure as low", "a pressure as high"]),
    ];
    of.into_iter().find_map(|(state, [low, high])| {
        let range = |is_odd: bool| {
            let own = record.moments().iter().zip(odd).filter(|(_, odd)| **odd == is_odd);
            own.map(|(moment, _)| state(moment))
                .fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], value| {
                    [least.min(value), most.max(value)]
                })
        };
        let ([least, most], [least_of_others, most_of_others]) = (range(true), range(false));
        if most < least_of_others {
            return Some(low);
        }
        (least > most_of_others).then_some(high)
    })
}

/// What the other rows say if a few are left out.
#[derive(Debug, Clone, Copy)]
enum Others {
    /// What was named is not there, although they could show it.
    Deny,
    /// They could not show it.
    AreSilent,
}

/// The rows behind the clearest jump in the misfit of the base, and those before it: what stays after an event
/// may be most of a record.
fn sides(found: &Findings<'_>, data: &Data, groups: &[Vec<usize>]) -> Vec<Vec<bool>> {
    let jump = found.search.stages.first().and_then(|base| base.linear.jump(found.context));
    let Some(row) = jump.and_then(|jump| groups.get(jump.row)?.first().copied()) else { return Vec::new() };
    let own = |group: &Vec<usize>, is_after: bool| {
        group
            .first()
            .is_some_and(|one| (*one >= row) == is_after && data.specimen_of(*one) == data.specimen_of(row))
    };
    [true, false].map(|is_after| groups.iter().map(|group| own(group, is_after)).collect()).to_vec()
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

    #[test]
    fn rows_beyond_the_others_may_show_an_effect_that_begins_there() {
        // Three pressures at each of three contractions.
        let states = (0..9).map(|i| Moment::at_rest(1e5 * f64::from(1 + i % 3), 0.05 * f64::from(i / 3)));
        let record = Record::from_moments(states.collect(), vec![0.0; 9], vec![0..3, 3..6, 6..9]).unwrap();
        let of = |is_odd: fn(usize) -> bool| beyond(&record, &(0..9).map(is_odd).collect::<Vec<bool>>());
        assert_eq!(of(|i| i >= 6), Some("a contraction as large"));
        assert_eq!(of(|i| i < 3), Some("a contraction as small"));
        assert_eq!(of(|i| i % 3 == 2), Some("a pressure as high"));
        assert_eq!(of(|i| i % 3 == 0), Some("a pressure as low"));
        assert_eq!(of(|i| (3..6).contains(&i)), None);
        assert_eq!(of(|i| i == 8), None);
    }
}
