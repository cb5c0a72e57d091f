//! What must hold of any data set that was read, and of the message about any that was not.

use bulge_measurements::{Data, History, MeasurementError, QualityOptions};

/// Calls every method of a data set.
pub(crate) fn ask(data: &Data) {
    let History {
        direction, approach, rate, since_reversal, time_since_reversal, time, cycle, branch, ..
    } = data.history(0.3);
    for column in [&direction, &approach, &rate, &since_reversal, &time_since_reversal, &time, &cycle] {
        assert!(column.len() == data.len() && column.iter().all(|value| value.is_finite()));
    }
    assert_eq!(branch.len(), data.len());
    let mut end = 0;
    for sweep in data.sweeps() {
        assert_eq!(sweep.rows.start, end);
        end = sweep.rows.end;
    }
    assert_eq!(end, data.len());
    let options = QualityOptions { l0_m: Some(0.3), radius_m: Some(0.01) };
    for finding in data.quality(&options).findings {
        assert!(!finding.says.contains("NaN") && !finding.instead.is_empty(), "{finding:?}");
    }
    let repeats = data.repeats(0.3);
    if let Some(error) = repeats.pure_error() {
        assert!(error.sd_n > 0.0 && error.degrees_of_freedom > 0.0, "{error:?}");
    }
    let every_other: Vec<bool> = (0..data.len()).map(|row| row % 2 == 0).collect();
    assert_eq!(data.subset(&every_other).len(), data.len().div_ceil(2));
}

/// The message is a bounded text with the file in it; each of several complaints has its line.
pub(crate) fn complete(error: &MeasurementError) {
    let message = error.to_string();
    assert!(message.contains("any.") && message.lines().count() < 25 && message.len() < 8000, "{message}");
}
