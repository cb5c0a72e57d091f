//! Properties of a muscle that the reader of its measurement files needs.

use bulge_fibre::{Approach, Problem};
use bulge_measurements::{ColumnMap, MeasurementError, ReadOptions};
use bulge_muscles::{Muscle, Pressure, Quantity};

/// The pressure at which the pull of a muscle is sampled \[Pa\]. Rubber matters little there, and most
/// muscles are made for it.
const USUAL: f64 = 2e5;
/// The range of contractions at which the pull is sampled. No muscle contracts by more, and a pleated muscle
/// has no finite force at 0.
const FIRST: f64 = 0.005;
const LAST: f64 = 0.455;
const STEPS: u32 = 18;

/// Options for reading the measurement files of a muscle. They contain the given columns, the muscle's own
/// `[data.columns]` for the quantities that these leave out, the muscle's length and its pull.
///
/// # Errors
/// If the muscle's `[data.columns]` are invalid.
pub fn read_options(muscle: &Muscle, columns: Option<&ColumnMap>) -> Result<ReadOptions, MeasurementError> {
    let mut stated = ColumnMap::default();
    for (quantity, column) in muscle.data_columns() {
        stated.add(quantity, column)?;
    }
    let columns = columns.map_or(stated.clone(), |columns| columns.clone().or(&stated));
    Ok(ReadOptions {
        columns,
        l0_m: Some(muscle.length().si()),
        pull: pull(muscle),
        ..ReadOptions::default()
    })
}

/// Force over pressure at the sampled contractions that the muscle can reach.
fn pull(muscle: &Muscle) -> Vec<[f64; 2]> {
    let step = (LAST - FIRST) / f64::from(STEPS);
    let contractions: Vec<f64> = (0..=STEPS).map(|i| FIRST + step * f64::from(i)).collect();
    let isobar = Problem::new(muscle, Pressure::from_si(USUAL))
        .and_then(|problem| problem.isobar(&contractions, Approach::Auto));
    let points = isobar.map(|isobar| isobar.points).unwrap_or_default();
    points.iter().map(|point| [point.contraction, point.force_n / USUAL]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use bulge_muscles::from_toml;
    use std::f64::consts::PI;

    /// A cylinder of braid: F = pi r0^2 p (3 (1 - eps)^2 / tan^2 a - 1 / sin^2 a).
    #[test]
    fn the_pull_is_that_of_the_muscle() {
        let text = "name = \"m\"\nkind = \"braided\"\nlength = \"250 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\nends = \"cylinder\"\n\
                    [data.columns]\nforce = \"F1\"\npressure = \"P1\"\n";
        let muscle = from_toml(text, "m.toml").unwrap();
        let columns: ColumnMap = "force=F2 [kN]".parse().unwrap();
        let options = read_options(&muscle, Some(&columns)).unwrap();
        let stated: Vec<_> = options.columns.entries().iter().map(|entry| entry.column.as_str()).collect();
        assert_eq!((stated, options.l0_m), (vec!["F2 [kN]", "P1"], Some(0.25)));
        let angle = 25_f64.to_radians();
        assert!(options.pull.len() > 10);
        for [contraction, pull] in options.pull {
            let exact = 3.0 * (1.0 - contraction).powi(2) / angle.tan().powi(2) - angle.sin().powi(-2);
            assert!((pull - PI * 1e-4 * exact).abs() < 1e-9, "{contraction}: {pull}");
        }
    }
}
