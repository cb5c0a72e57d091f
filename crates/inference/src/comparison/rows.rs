//! Rows that enter errors and fits, and the line numbers by which messages name rows.

use bulge_measurements::{Data, Reading};
use bulge_muscles::units::significant;
use std::fmt::Write;

use crate::comparison::document::LeftOut;

/// Rows between isobaric runs are kept if they are more than this fraction: then they are the test itself.
const MOST_BETWEEN: f64 = 0.2;
/// If more than this fraction of the rows pushes, the force must have the other sign.
const MOST_IDLE: f64 = 0.8;

/// Forces and pressures beyond this fraction of the largest, with the other sign, are readings whose sign is turned over: pressed
/// beyond its free contraction a muscle buckles, and no zero is so far off.
const TURNED: f64 = 0.25;

/// Rows that count, and the reasons for the others.
#[derive(Debug, Clone)]
pub(crate) struct Used {
    pub(crate) mask: Vec<bool>,
    pub(crate) left_out: Vec<LeftOut>,
    /// For each row that doesn't count, the index of its reason in the list.
    pub(crate) reason: Vec<Option<u32>>,
    /// How the data were read, and the rows that can't have an equilibrium.
    pub(crate) reading: Reading,
}

/// Start of the reason for rows that were read but can't be used because their gauge pressure isn't above 0.
/// They are among the rows left out.
pub const UNPRESSURISED: &str = "a gauge pressure of";

/// Reason for rows that a user left out.
pub(crate) const BY_HAND: &str = "excluded by hand";

/// Beginnings of the reasons for rows whose readings are right: they tell nothing of the muscle's force.
const RIGHT: [&str; 5] = ["slack", "between pressures", "no gauge pressure", "no force", BY_HAND];

impl LeftOut {
    /// Whether it is for readings that are wrong.
    pub(crate) fn is_wrong(&self) -> bool {
        !RIGHT.iter().any(|reason| self.why.starts_with(reason))
    }
}

impl Used {
    /// Leaves out rows, unless none would remain.
    pub(crate) fn leave_out(&mut self, data: &Data, rows: impl IntoIterator<Item = usize>, why: String) {
        let rows: Vec<usize> = rows.into_iter().filter(|row| self.mask[*row]).collect();
        if rows.is_empty() || rows.len() == self.mask.iter().filter(|counts| **counts).count() {
            return;
        }
        self.set_aside(data, &rows, why);
    }

    fn set_aside(&mut self, data: &Data, rows: &[usize], why: String) {
        let reason = u32::try_from(self.left_out.len()).ok();
        for row in rows {
            self.mask[*row] = false;
            self.reason[*row] = reason;
        }
        self.left_out.push(LeftOut { why, lines: lines(data, rows), rows: rows.len() });
    }

    /// The rows that count.
    pub(crate) fn rows(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.mask.len()).filter(|row| self.mask[*row])
    }

    /// Leaves out rows whose gauge pressure is 0 or, through noise around zero, negative: no pressure
    /// balances the fibres there.
    fn leave_out_unpressurised(&mut self, data: &Data) {
        let pressure = data.pressure();
        let rows: Vec<usize> = (0..pressure.len()).filter(|row| pressure[*row] <= 0.0).collect();
        for row in &rows {
            let (file, line) = data.line(*row);
            let file = data.files().get(file).map_or("", |file| file.name.as_str());
            let reason = format!("{UNPRESSURISED} {} Pa has no equilibrium", significant(pressure[*row], 3));
            self.reading.add(file, line, reason);
        }
        let full = full_scale(pressure, 0..pressure.len());
        let (turned, rows): (Vec<usize>, Vec<usize>) =
            rows.into_iter().partition(|row| pressure[*row] < -TURNED * full);
        let turned_why = "pressures as far below zero as others are above it: was the sign of the sensor turned over there?";
        let none_why = "no gauge pressure: nothing balances the fibres";
        for (rows, why) in
            [(turned, turned_why), (rows, none_why)].into_iter().filter(|(rows, _)| !rows.is_empty())
        {
            self.set_aside(data, &rows, why.to_owned());
        }
    }

    /// Leaves out spikes that only show up in the residuals.
    pub(crate) fn leave_out_spikes(&mut self, data: &Data, residuals: Vec<f64>) {
        let mut values = residuals;
        // Rows that don't count may lack a prediction: interpolate between those that do.
        for sweep in data.sweeps() {
            let mut last = None;
            for row in sweep.rows.clone() {
                match last {
                    _ if self.mask[row] && values[row].is_finite() => last = Some(values[row]),
                    Some(value) => values[row] = value,
                    None => values[row] = 0.0,
                }
            }
        }
        let why = "spike: the force lies far from what the rows around lead to, beside any model";
        let spikes = data.spikes_where(&values, |row| self.mask[row]);
        self.leave_out(data, spikes, why.to_owned());
    }
}

/// The rows that count. Left out are rows without information about the muscle: disturbed, frozen or clipped
/// readings; rows of pressure steps between isobaric runs; and readings at zero force, which only say that
/// the muscle didn't pull. The last kind comprises two or more rows of exactly the lowest force, within 1 %
/// of full scale of zero, rows that moved on at zero force, and rows in which the muscle pushed.
pub(crate) fn used(data: &Data) -> Used {
    let force = data.force();
    let mut used = Used {
        mask: vec![true; force.len()],
        left_out: Vec::new(),
        reason: vec![None; force.len()],
        reading: data.reading().clone(),
    };
    used.leave_out_unpressurised(data);
    let disturbed = data.disturbed();
    let mut is_disturbed = vec![false; force.len()];
    disturbed.iter().flat_map(|disturbance| &disturbance.rows).for_each(|row| is_disturbed[*row] = true);
    let sound = || (0..force.len()).filter(|row| !is_disturbed[*row]);
    let full = full_scale(force, sound());
    let lowest = sound().map(|row| force[row]).fold(f64::INFINITY, f64::min);
    let cut: Vec<usize> = sound().filter(|row| force[*row].total_cmp(&lowest).is_eq()).collect();
    if cut.len() >= 2 && lowest.abs() <= 0.01 * full {
        let why = format!("slack: {lowest} N, the lowest reading, says only that the muscle didn't pull");
        used.leave_out(data, cut, why);
    }
    for disturbance in disturbed {
        used.leave_out(data, disturbance.rows.iter().copied(), disturbance.why.clone());
    }
    let between = data.between_isobars().iter().copied();
    let why = "between pressures: the pressure steps from one isobaric run to the next, and what friction does there isn't known";
    if data.between_isobars().len() as f64 <= MOST_BETWEEN * force.len() as f64 {
        used.leave_out(data, between, why.to_owned());
    }
    // If nearly all rows push, the load cell has the other sign, which is left to a question.
    let idle = data.not_pulling();
    if idle.len() as f64 <= MOST_IDLE * force.len() as f64 {
        let (turned, idle): (Vec<usize>, Vec<usize>) =
            idle.into_iter().partition(|row| force[*row] < -TURNED * full);
        let why =
            "pushing as hard as a muscle pulls, which would buckle: was the load cell turned over there?";
        used.leave_out(data, turned, why.to_owned());
        let why = "slack or pushing: the muscle didn't pull, and says nothing about its force";
        used.leave_out(data, idle, why.to_owned());
    }
    used
}

/// Largest reading among some rows.
pub(crate) fn full_scale(force: &[f64], rows: impl Iterator<Item = usize>) -> f64 {
    rows.map(|row| force[row].abs()).fold(0.0, f64::max)
}

/// Line numbers of rows: `12, 33-40`, with the names of the files if there are several. Long lists end with a
/// count.
pub(crate) fn lines(data: &Data, rows: &[usize]) -> String {
    const MOST: usize = 12;
    let ranges = data.line_ranges(rows);
    let mut text = ranges.iter().take(MOST).map(String::as_str).collect::<Vec<_>>().join(", ");
    if ranges.len() > MOST {
        let _ = write!(text, " and {} more", ranges.len() - MOST);
    }
    text
}
