//! Detects a muscle whose unpressurised length is not that of its file: a nominal length, or one between other
//! ends.
//!
//! ```text
//! c' = 1 - l / (k l0)
//! ```
//! is the contraction at the length l if the muscle was k l0 long instead of l0. A factor k that explains most
//! of the error is asked about.

use std::ops::RangeInclusive;

use bulge_measurements::{Data, Trace};
use bulge_muscles::units::significant;
use bulge_muscles::{Muscle, Parameter, Quantity};
use bulge_numerics::minimum::golden;

use crate::comparison::document::Mismatch;
use crate::comparison::mismatch::{LEFT, Trial};

/// Factors of the length that are tried, in per cent. Other lengths are impossible contractions in most tests.
const PER_CENT: RangeInclusive<i32> = 75..=133;
/// Factors closer to one are effects: fittings that slip, a sensor's zero, fibres longer than stated.
const NOTICEABLE: f64 = 0.02;
/// Lengths closer to the stated one than this many of its widths agree with it, and the fit finds them.
const WITHIN: f64 = 3.0;
/// Fraction of the error that is left from which nothing else is looked for: noise, but not another angle or radius,
/// whose curves differ.
const LEFT_SURELY: f64 = 0.06;
/// Accuracy of the factor.
const ENOUGH: f64 = 2e-4;

/// Asks about the length of the muscle. `few` are some of the rows of `trial`; `before` is its error \[N\].
pub(crate) fn question(
    data: &Data,
    muscle: &Muscle,
    few: &Trial<'_>,
    trial: &Trial<'_>,
    before: f64,
) -> Option<Mismatch> {
    let is_displacement =
        |column: &bulge_measurements::ColumnUse| column.quantity.as_deref() == Some("displacement");
    let l0 = muscle.length().si();
    let differ = (0..data.len()).any(|row| data.length_of(data.specimen_of(row), l0).total_cmp(&l0).is_ne());
    if !matches!(data.motion(), Trace::Length(_))
        || differ
        || data.reading().columns.iter().any(is_displacement)
    {
        return None;
    }
    let error = |trial: &Trial<'_>, factor: f64| {
        let of = move |[pressure, contraction, force]: [f64; 3]| {
            [pressure, 1.0 - (1.0 - contraction) / factor, force]
        };
        (factor, trial.error(&of).map_or(f64::INFINITY, |(error, _)| error))
    };
    let grid = PER_CENT.map(|per_cent| error(few, 0.01 * f64::from(per_cent)));
    let (near, _) = grid.min_by(|a, b| a.1.total_cmp(&b.1))?;
    let bracket = [near - 0.01, near + 0.01];
    let (factor, after) =
        golden(error(trial, near), bracket, ENOUGH, |place| *place, |factor| error(trial, factor));
    let width = muscle.width(Parameter::Length).unwrap_or(0.0) / l0;
    ((factor - 1.0).abs() > NOTICEABLE.max(WITHIN * width) && after <= LEFT * before).then(|| Mismatch {
        kind: "muscle-length",
        decided: after <= LEFT_SURELY * before,
        rmse_n: before,
        meant_rmse_n: Some(after),
        says: format!(
            "with an unpressurised length of {} mm instead of {} mm the error of the muscle as stated falls from {} N to {} N: is that the length of the muscle that was \
             measured, between its fittings?",
            significant(1e3 * factor * l0, 4),
            significant(1e3 * l0, 4),
            significant(before, 3),
            significant(after, 3)
        ),
        instead: "measure it without pressure and write it as `length` into the muscle file; or else check the zero of the column `length`".to_owned(),
    })
}
