//! The quality check: reports what looks wrong in a data set, where, and what to do about it. Nothing is
//! changed.

mod clipping;
mod column;
mod copied;
mod design;
mod drift;
mod frozen;
mod labels;
mod quantisation;
mod slack;
mod slower;
mod spikes;
mod thousands;
mod time;
mod values;

use crate::data::Data;
use crate::resolution::Resolution;
use column::Column;
use serde::Serialize;
use std::ops::Range;

/// Known properties of the muscle; the check works without them.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct QualityOptions {
    /// Length of the unpressurised muscle \[m\], for judging contractions if the length was measured.
    pub l0_m: Option<f64>,
    /// Radius of the unpressurised muscle \[m\], for judging forces.
    pub radius_m: Option<f64>,
}

/// The findings, in the order of [`FindingKind`].
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Quality {
    /// The findings.
    pub findings: Vec<Finding>,
}

impl Quality {
    /// The most severe finding.
    #[must_use]
    pub fn worst(&self) -> Option<Severity> {
        self.findings.iter().map(|finding| finding.severity).max()
    }

    /// The findings of one kind.
    pub fn of(&self, kind: FindingKind) -> impl Iterator<Item = &Finding> {
        self.findings.iter().filter(move |finding| finding.kind == kind)
    }
}

/// One thing that looks wrong.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// Kind of the finding.
    pub kind: FindingKind,
    /// Its severity.
    pub severity: Severity,
    /// The lines of the files, in at most [`Finding::MOST_RANGES`] ranges; none if it concerns the data as a
    /// whole.
    pub rows: Vec<LineRange>,
    /// Total number of rows.
    pub count: usize,
    /// The observation, in a sentence with numbers.
    pub says: String,
    /// The remedy.
    pub instead: String,
}

impl Finding {
    /// Most ranges of rows that are listed.
    pub const MOST_RANGES: usize = 1000;
}

/// Lines of a file (rows of a Parquet file), both ends included; comments may lie between.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct LineRange {
    /// Index of the file.
    pub file: usize,
    /// First line.
    pub first: usize,
    /// Last line.
    pub last: usize,
}

/// Kinds of findings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FindingKind {
    /// There are too few rows to learn anything from.
    TooFewRows,
    /// Every row is the same.
    AllRowsIdentical,
    /// A value that is impossible for a muscle.
    ImpossibleValue,
    /// The time stands still or goes back.
    TimeNotMonotone,
    /// A pause within a run.
    TimeGap,
    /// The label of a run returns after other labels.
    SweepInterrupted,
    /// A sweep label continues although its run has ended.
    SweepContradicted,
    /// A coarse sensor.
    Quantised,
    /// A reading stays at its extreme value while others move.
    Clipped,
    /// All readings stay the same although they are noisy.
    Frozen,
    /// A reading far from its neighbours in time.
    Spike,
    /// Force near zero at positive pressure.
    Slack,
    /// A pushing force.
    NegativeForce,
    /// Repeats differ by an offset.
    RepeatDrift,
    /// Stated directions contradict the motion.
    DirectionContradicted,
    /// A held length that isn't quite constant.
    HeldLengthDrifts,
    /// A duplicated row.
    DuplicateRow,
    /// All rows have one pressure.
    OnePressureLevel,
    /// The muscle never moves.
    ContractionConstant,
    /// The temperature changes, possibly correlated with something else.
    TemperatureChanges,
}

/// Severity of a finding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Severity {
    /// Good to know.
    Note,
    /// Conclusions may be wrong.
    Warning,
    /// No conclusion is possible from these rows.
    Error,
}

impl Data {
    /// Checks the data for defects. A clean data set gives no warning.
    #[must_use]
    pub fn quality(&self, options: &QualityOptions) -> Quality {
        if self.is_empty() {
            return Quality { findings: Vec::new() };
        }
        let gate = Gate::new(self, options);
        let checks = [
            design::find,
            values::find,
            time::find,
            labels::find,
            quantisation::find,
            clipping::find,
            frozen::find,
            copied::find,
            spikes::find,
            slack::find,
            drift::find,
        ];
        let mut findings: Vec<Finding> = checks.iter().flat_map(|check| check(&gate)).collect();
        findings.sort_by_key(|finding| finding.kind);
        Quality { findings }
    }
}

/// Rows with a disturbed reading, which isn't the muscle's.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Disturbance {
    /// The rows, in ascending order.
    pub rows: Vec<usize>,
    /// The kind of disturbance.
    pub why: String,
}

impl Data {
    /// Rows with impossible or frozen readings; and with spikes or clipped readings, by column, which can't be
    /// detected in a static map.
    #[must_use]
    pub fn disturbed(&self) -> &[Disturbance] {
        self.structure.disturbed.get_or_init(|| self.find_disturbed())
    }

    fn find_disturbed(&self) -> Vec<Disturbance> {
        if self.is_empty() {
            return Vec::new();
        }
        let options = QualityOptions::default();
        let gate = Gate::new(self, &options);
        let impossible = values::rows(&gate).map(|(rows, why)| Disturbance { rows, why });
        let named = |what: &'static str| {
            move |(name, rows): (&str, Vec<usize>)| Disturbance {
                rows,
                why: format!("{what}: the {name} {}", of(what)),
            }
        };
        let frozen = frozen::rows(&gate);
        let all = Disturbance {
            rows: frozen.all,
            why: "frozen: pressure, motion and force repeat the row before to the last digit".to_owned(),
        };
        let alone = frozen
            .alone
            .into_iter()
            .map(|(name, how, rows)| Disturbance { rows, why: format!("frozen: the {name} {}", how.says()) });
        let mut found: Vec<Disturbance> = impossible.collect();
        let thousands = |column: &Column<'_>| {
            let Column { name, .. } = *column;
            Disturbance {
                rows: thousands::rows(column),
                why: format!("comma: the {name} is {}", thousands::WHY),
            }
        };
        found.extend(gate.columns.iter().map(thousands));
        if self.is_path() {
            found.extend(spikes::in_columns(&gate).into_iter().map(named("spike")));
            found.extend(clipping::in_columns(&gate).into_iter().map(named("clipped")));
        }
        found.push(all);
        // Equal set points of a static map are its repeats.
        found.extend(alone.filter(|_| self.is_path()));
        let copied = copied::rows(&gate);
        found.push(Disturbance { rows: copied.all, why: format!("copied: {}", copied::ALL) });
        found.extend(
            copied.alone.into_iter().map(|(name, rows)| Disturbance {
                rows,
                why: format!("copied: the {name} {}", copied::ALONE),
            }),
        );
        found.retain(|found| !found.rows.is_empty());
        found
    }
}

/// The description for a column.
fn of(what: &str) -> &'static str {
    if what == "spike" {
        "lies far from what the rows around lead to"
    } else {
        "stays at the end of its range while others move"
    }
}

/// The data, with values that several checks need.
struct Gate<'a> {
    data: &'a Data,
    options: &'a QualityOptions,
    motion: &'a [f64],
    /// Force, motion, pressure.
    columns: [Column<'a>; 3],
    pressure: Resolution,
    force: Resolution,
    largest_force: f64,
    largest_pressure: f64,
}

impl<'a> Gate<'a> {
    fn new(data: &'a Data, options: &'a QualityOptions) -> Self {
        let sweeps: Vec<Range<usize>> = data.sweeps().iter().map(|sweep| sweep.rows.clone()).collect();
        let largest = |values: &[f64]| values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let motion = data.columns().motion.values();
        let [force, pressure] = [data.force(), data.pressure()].map(|values| Resolution::of(values, &sweeps));
        let mut gate = Self {
            data,
            options,
            motion,
            columns: [
                Column::new("force", data.force(), force, &sweeps),
                Column::new(motion_name(data), motion, data.structure.resolution, &sweeps),
                Column::new("pressure", data.pressure(), pressure, &sweeps),
            ],
            pressure,
            force,
            largest_force: largest(data.force()),
            largest_pressure: largest(data.pressure()),
        };
        // A disturbed reading must not set the largest force.
        let spikes = spikes::of_force(&gate);
        if !spikes.is_empty() {
            let kept = (0..data.len()).filter(|row| spikes.binary_search(row).is_err());
            gate.largest_force = kept.map(|row| data.force()[row].abs()).fold(0.0, f64::max);
        }
        gate
    }

    fn motion_resolution(&self) -> &Resolution {
        &self.data.structure.resolution
    }

    /// A value of one of the columns with a common unit.
    fn with_unit(&self, column: &str, value: f64) -> String {
        let (factor, unit) = match (column, self.data.motion()) {
            ("force", _) => (1.0, "N"),
            ("pressure", _) => (1e-5, "bar"),
            (_, crate::Trace::Contraction(_)) => (100.0, "%"),
            (_, crate::Trace::Length(_)) => (1e3, "mm"),
        };
        format!("{} {unit}", quantisation::four(factor * value))
    }

    /// A reading with its unit.
    fn reading(&self, column: &str, row: usize) -> String {
        let values = match column {
            "force" => self.data.force(),
            "pressure" => self.data.pressure(),
            _ => self.motion,
        };
        self.with_unit(column, values[row])
    }

    fn motion_name(&self) -> &'static str {
        motion_name(self.data)
    }

    /// A finding about some rows, in ascending order.
    fn finding(
        &self,
        kind: FindingKind,
        severity: Severity,
        rows: &[usize],
        says: String,
        instead: &str,
    ) -> Finding {
        let mut ranges: Vec<LineRange> = Vec::new();
        for run in rows.chunk_by(|a, b| a + 1 == *b && self.data.line(*a).0 == self.data.line(*b).0) {
            if ranges.len() == Finding::MOST_RANGES {
                break;
            }
            let (file, first) = self.data.line(run[0]);
            let (_, last) = self.data.line(run[run.len() - 1]);
            ranges.push(LineRange { file, first, last });
        }
        Finding { kind, severity, rows: ranges, count: rows.len(), says, instead: instead.to_owned() }
    }

    /// A finding if there are such rows; the sentence gets their number.
    fn finding_if_any(
        &self,
        kind: FindingKind,
        severity: Severity,
        rows: &[usize],
        says: impl FnOnce(usize) -> String,
        instead: &str,
    ) -> Option<Finding> {
        (!rows.is_empty()).then(|| self.finding(kind, severity, rows, says(rows.len()), instead))
    }
}

fn motion_name(data: &Data) -> &'static str {
    match data.motion() {
        crate::Trace::Contraction(_) => "contraction",
        crate::Trace::Length(_) => "length",
    }
}

/// "1 row", "2 rows".
fn rows_in_words(count: usize) -> String {
    if count == 1 { "1 row".to_owned() } else { format!("{count} rows") }
}

#[cfg(test)]
mod tests;
