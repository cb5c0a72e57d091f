//! A column that comes late: loggers of their own, whose clocks were put together by hand. Each row then holds
//! readings of different times, and lags and friction explain a part of what follows from it.

use bulge_measurements::{Channel, Data, Sweep};
use bulge_model::{Record, Wanted, Warm};
use bulge_muscles::units::significant;
use std::ops::Range;

use crate::comparison::analysis::Analysis;
use crate::diagnosis::averaged::Averaged;
use crate::diagnosis::confirm::Confirmed;
use crate::diagnosis::trimmed::{Linearised, chosen};
use crate::diagnosis::write::Findings;
use crate::median::median;
use crate::vector::{count, minus};

/// Rows by which a column is tried to be late or early; between two of them the error has no other minimum.
const TRIED: [isize; 12] = [1, 2, 3, 4, 6, 8, 11, 15, 20, 26, 33, 40];
/// Most rows of a test in which a late column is looked for: each of some fifty trials moves all.
const MOST_ROWS: usize = 30_000;
/// Rows, at a regular stride, whose force each trial computes.
const ENOUGH: usize = 2000;
/// Fewest rows that are left, as a fraction of all.
const LEFT: f64 = 0.6;
/// RMS error with the column moved over that as read,
const FALLS: f64 = 0.5;
/// and over that of what was named: a lag of the rig leaves less itself.
const BETTER: f64 = 0.95;
/// Columns whose sums of squares differ by less than this factor are alike.
const ALIKE: f64 = 1.5;

/// A column and the rows by which it is late; negative if it is early.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Late {
    pub(crate) channel: Channel,
    pub(crate) rows: isize,
}

impl Late {
    /// The columns that leave the base the least error if one of them is moved, if that is much less than as read,
    /// and less than the last model leaves. At constant pressure, a late force is as good as an early motion; late
    /// columns come first.
    pub(crate) fn of(found: &Findings<'_>, analysis: &Analysis<'_>) -> Vec<Self> {
        if !analysis.data.is_path() || analysis.rows().count() > MOST_ROWS {
            return Vec::new();
        }
        let Some(trial) = Trial::of(found, analysis) else { return Vec::new() };
        let left = |force: &[f64], kept: &[bool]| trial.left(trial.record.force(), force, kept);
        let best = Channel::ALL.into_iter().filter_map(|channel| trial.best(channel));
        let mut tried: Vec<(Self, f64)> = best
            .filter_map(|late| {
                let (moved, kept) = trial.moved(late)?;
                let part = moved / left(&trial.forces[0], &kept);
                let is_better = moved < BETTER * BETTER * left(&trial.forces[1], &kept);
                (part < FALLS * FALLS && is_better).then_some((late, part))
            })
            .collect();
        let least = tried.iter().map(|(_, part)| *part).fold(f64::INFINITY, f64::min);
        tried.retain(|(_, part)| *part < ALIKE * least);
        tried.sort_by_key(|(late, _)| late.rows < 0);
        tried.into_iter().map(|(late, _)| late).collect()
    }

    /// Rows for which the column has no reading once it is moved: those at the ends of the sweeps.
    pub(crate) fn without_partner(self, data: &Data) -> Vec<usize> {
        let by = self.rows.unsigned_abs();
        let of = |sweep: &Sweep| {
            let Range { start, end } = sweep.rows;
            if self.rows > 0 { end.saturating_sub(by).max(start)..end } else { start..(start + by).min(end) }
        };
        data.sweeps().iter().flat_map(of).collect()
    }

    /// A question about one of several that are alike.
    pub(crate) fn asks(alike: &[Self], data: &Data) -> String {
        let step = data
            .time()
            .map(|time| median(&mut time.windows(2).map(|pair| pair[1] - pair[0]).collect::<Vec<f64>>()));
        let moved = |late: &Self| {
            let rows = late.rows.unsigned_abs();
            let plural = if rows == 1 { "" } else { "s" };
            let seconds =
                step.map_or_else(String::new, |step| format!(" ({} s)", significant(step * rows as f64, 2)));
            let side = if late.rows > 0 { "earlier" } else { "later" };
            format!("the {} {rows} row{plural}{seconds} {side}", late.channel.name())
        };
        format!(
            "with {} nothing is missing: was a column recorded late, or by another clock? Put the readings of one moment into one row, and ask again",
            alike.iter().map(moved).collect::<Vec<String>>().join(", or ")
        )
    }
}

/// The rows that count, one by one, and the base, with columns that are moved.
struct Trial<'a> {
    record: Record,
    /// Row of the file of each, and the end of its sweep.
    rows: Vec<(usize, Range<usize>)>,
    base: &'a Confirmed,
    linear: Linearised,
    /// Forces of the base and of the last model \[N\].
    forces: [Vec<f64>; 2],
}

impl<'a> Trial<'a> {
    /// None if there is no model of these rows.
    fn of(found: &'a Findings<'_>, analysis: &Analysis<'_>) -> Option<Self> {
        let base = &found.search.stages.first()?.confirmed;
        let mut used = analysis.used.mask.clone();
        let mut force = |model: &Confirmed| {
            let (model, theta) = (&model.prepared.model, &model.theta);
            let partly =
                model.evaluate_partly(&analysis.record, theta, &Wanted::default(), &Warm::of_rows(&used));
            let force = partly.ok()?.prediction.force;
            for (used, force) in used.iter_mut().zip(&force) {
                *used &= force.is_finite();
            }
            Some(force)
        };
        let forces = [force(base)?, force(&found.last().confirmed)?];
        let single = Averaged::of(&analysis.record, &used, &analysis.levels, usize::MAX)?;
        let of_rows = forces.each_ref().map(|force| single.means(force));
        let record =
            single.record.clone().with_force(single.forces(&analysis.record, &forces[0], &of_rows[0]));
        let rows = single.groups.iter().enumerate().map(|(place, group)| {
            let own = record.sweeps().iter().find(|sweep| sweep.contains(&place));
            (group[0], own.cloned().unwrap_or(place..place + 1))
        });
        let rows = rows.collect();
        let linear = Linearised::of(&base.prepared, &base.theta, &record).ok()?;
        let forces = of_rows;
        Some(Self { record, rows, base, linear, forces })
    }

    /// The row that is `by` rows after another one of the same sweep.
    fn after(&self, place: usize, by: isize) -> Option<usize> {
        let other = place.checked_add_signed(by)?;
        let ((row, sweep), (other_row, _)) = (self.rows.get(place)?, self.rows.get(other)?);
        // Rows that don't count may lie between them.
        (sweep.contains(&other) && row.checked_add_signed(by)? == *other_row).then_some(other)
    }

    /// The rows by which a column leaves the least error, by descent from the best of those that are tried.
    fn best(&self, channel: Channel) -> Option<Late> {
        let error = |rows: isize| {
            let (square, kept) = self.moved(Late { channel, rows })?;
            Some(square / count(&kept) as f64)
        };
        let signed = TRIED.iter().flat_map(|rows| [*rows, -rows]);
        let tried = signed.filter_map(|rows| Some((rows, error(rows)?)));
        let (mut rows, mut least) = tried.min_by(|a, b| a.1.total_cmp(&b.1))?;
        for step in [1, -1] {
            while let Some(other) = error(rows + step).filter(|other| rows + step != 0 && *other < least) {
                (rows, least) = (rows + step, other);
            }
        }
        Some(Late { channel, rows })
    }

    /// The sum of squared errors of the base with a column moved, and the rows that have one; none if they are
    /// few.
    fn moved(&self, late: Late) -> Option<(f64, Vec<bool>)> {
        let mut kept: Vec<bool> =
            (0..self.record.len()).map(|place| self.after(place, late.rows).is_some()).collect();
        if (count(&kept) as f64) < LEFT * kept.len() as f64 {
            return None;
        }
        let every = kept.len().div_ceil(ENOUGH);
        for (place, kept) in kept.iter_mut().enumerate() {
            *kept &= place % every == 0;
        }
        let [pressure, contraction, read] =
            Channel::ALL.map(|channel| self.at(channel, if channel == late.channel { late.rows } else { 0 }));
        let force = if late.channel == Channel::Force {
            self.forces[0].clone()
        } else {
            let record = self.record.clone().at(&pressure, &contraction);
            let (model, theta) = (&self.base.prepared.model, &self.base.theta);
            let partly = model.evaluate_partly(&record, theta, &Wanted::default(), &Warm::of_rows(&kept));
            partly.ok()?.prediction.force
        };
        Some((self.left(&read, &force, &kept), kept))
    }

    /// A column moved by some rows; where there is none its own value stays.
    fn at(&self, channel: Channel, by: isize) -> Vec<f64> {
        let record = &self.record;
        let value = |place: usize| match channel {
            Channel::Pressure => record.moments()[place].pressure,
            Channel::Motion => record.moments()[place].contraction,
            Channel::Force => record.force()[place],
        };
        (0..record.len()).map(|place| value(self.after(place, by).unwrap_or(place))).collect()
    }

    /// Sum of squares of what a force leaves of the readings in the rows that are kept, once the numbers of the base
    /// are drawn to it; a row without a state counts as infinitely far.
    fn left(&self, read: &[f64], force: &[f64], kept: &[bool]) -> f64 {
        let left = self.linear.square_of(&chosen(&minus(read, force), kept), kept);
        left.filter(|left| left.is_finite()).unwrap_or(f64::INFINITY)
    }
}
