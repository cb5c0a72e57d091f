//! Detects times in milliseconds that were read as seconds: the test seems to take hours, with hundreds of
//! readings in each branch.

use bulge_measurements::Data;
use bulge_model::Record;
use bulge_muscles::units::significant;

use crate::comparison::document::Mismatch;

/// Kind of the question.
pub(crate) const TIME_UNIT: &str = "time-unit";
/// With fewer branches there is no cycle.
const BRANCHES: usize = 2;
/// Slow tests have few readings from one reversal to the next, fast ones don't take minutes. The question is
/// asked if the median branch has at least so many rows and lasts at least so long \[s\],
const ROWS: usize = 200;
const LONG: f64 = 300.0;
/// and the whole test at least so long \[s\],
const WHOLE: f64 = 3600.0;
/// or if the median branch has few readings and lasts for a good part of a day \[s\].
const FEW_ROWS: usize = 10;
const ENDLESS: f64 = 10_800.0;

/// Asks about the unit of the time. `rmse_n` is the error of the muscle as stated, which doesn't depend on
/// it.
pub(crate) fn question(data: &Data, record: &Record, rmse_n: f64) -> Option<Mismatch> {
    let time = data.time()?;
    // Clock times have their seconds written; milliseconds are whole numbers.
    let is_clock = |column: &&bulge_measurements::ColumnUse| {
        column.quantity.as_deref() == Some("time")
            && (column.unit.as_deref() != Some("s") || column.first.iter().any(|text| text.contains(':')))
    };
    if data.reading().columns.iter().any(|column| is_clock(&column)) || time.iter().any(|t| t.fract() != 0.0)
    {
        return None;
    }
    let mut branches: Vec<(f64, usize)> = record
        .sweeps()
        .iter()
        .flat_map(|rows| {
            let moments = &record.moments()[rows.clone()];
            let mut start = rows.start;
            moments
                .chunk_by(|a, b| a.branch().total_cmp(&b.branch()).is_eq())
                .filter_map(|branch| {
                    let rows = start..start + branch.len();
                    start = rows.end;
                    (branch[0].branch() != 0.0).then(|| (time[rows.end - 1] - time[rows.start], branch.len()))
                })
                .collect::<Vec<_>>()
        })
        .collect();
    let whole: f64 = record.sweeps().iter().map(|rows| time[rows.end - 1] - time[rows.start]).sum();
    if branches.len() < BRANCHES || whole < WHOLE {
        return None;
    }
    branches.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (duration, rows) = branches[branches.len() / 2];
    ((rows >= ROWS && duration >= LONG) || (rows >= FEW_ROWS && duration >= ENDLESS)).then(|| Mismatch {
        kind: TIME_UNIT,
        decided: false,
        rmse_n,
        meant_rmse_n: None,
        says: format!(
            "by its times, all whole numbers, this test took {} h, with {} s and {rows} readings from one reversal to the next; in milliseconds these are \
             {} s and {} s: is the time in milliseconds?",
            significant(whole / 3600.0, 2),
            significant(duration, 3),
            significant(1e-3 * whole, 3),
            significant(1e-3 * duration, 3)
        ),
        instead: "write `time [ms]` in the header, or `--columns \"time=NAME [ms]\"`; rates and times of effects are 1000 times off otherwise".to_owned(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fmt::Write as _;

    /// Triangles of a muscle of 300 mm, with `rows` per branch and one row per `step` \[s\].
    fn asked(rows: usize, step: f64, heading: &str) -> Option<Mismatch> {
        let mut text = format!("{heading},pressure [bar],length [mm],force [N]\n");
        for row in 0..6 * rows {
            let place = (row % (2 * rows)) as f64 / rows as f64;
            let way = if place < 1.0 { place } else { 2.0 - place };
            let factor = if heading.contains("ms") { 1e3 } else { 1.0 };
            writeln!(text, "{},2,{},{}", factor * step * row as f64, 300.0 - 60.0 * way, 800.0 - 500.0 * way)
                .unwrap();
        }
        let data = Data::from_csv(&text, "c.csv").unwrap();
        question(&data, &Record::new(&data, 0.3), 1.0)
    }

    #[test]
    fn milliseconds_are_asked_about_where_branches_are_dense_and_last_for_minutes() {
        let found = asked(625, 1.0, "time [s]").unwrap();
        assert_eq!((found.kind, found.decided), (TIME_UNIT, false));
        for part in ["took 1.0 h", "625 readings", "3.75 s", "0.62", "is the time in milliseconds?"] {
            assert!(found.says.contains(part), "{} does not say {part}", found.says);
        }
        assert!(asked(300, 10.0, "time [s]").is_some() && asked(700, 1.0, "time").is_some());
        assert!(asked(25, 1000.0, "time [s]").is_some());
        // Slow tests with few readings, short ones, fast ones, sampling at fractions of a second, and headers with
        // another unit.
        for (rows, step, heading) in [
            (100, 20.0, "time [s]"),
            (310, 1.0, "time [s]"),
            (625, 0.5, "time [s]"),
            (625, 0.02, "time [s]"),
            (625, 1.0, "time [ms]"),
            (625, 1.0, "time [min]"),
        ] {
            assert!(asked(rows, step, heading).is_none(), "{rows} {step} {heading}");
        }
    }
}
