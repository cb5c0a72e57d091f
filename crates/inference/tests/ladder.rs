//! The numbers of a ladder against what they must be by hand: errors, half-gaps, weights, priors, intervals, noise floor.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use bulge_effects::{Catalogue, Moment};
use bulge_inference::{Comparison, Noise, Options, compare};
use bulge_measurements::Data;
use bulge_model::{Model, Prediction, Record, Wanted};
use bulge_muscles::{Muscle, from_toml};
use std::fmt::Write;
use std::sync::Arc;

const BRAID: &str = "name = \"x\"\nkind = \"braided\"\nlength = \"250 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\nends = \"cylinder\"\n";

fn muscle(more: &str) -> Muscle {
    from_toml(&format!("{BRAID}{more}\n"), "m.toml").unwrap()
}

/// Loops of 40 rows at three pressures: the cylinder's force, and what `more` adds to it by row and direction.
fn loops(more: impl Fn(usize, f64) -> f64) -> Data {
    let plain = muscle("");
    let model = Model::new(&plain);
    let mut csv = String::from("time [s],sweep,pressure [bar],contraction [-],force [N]\n");
    for row in 0..120 {
        let (sweep, i) = (row / 40, row % 40);
        let (back, direction) = if i < 20 { (i, 1.0) } else { (39 - i, -1.0) };
        let (bar, e) = (2.0 + sweep as f64, 0.02 + 0.01 * back as f64);
        let force = model.at_rest(&[], bar * 1e5, e).unwrap().force_n + more(row, direction);
        let _ = writeln!(csv, "{row},{sweep},{bar},{e},{force}");
    }
    Data::from_csv(&csv, "loops.csv").unwrap()
}

fn climbed(data: &Data, muscle: &Muscle, with: &[&str]) -> Comparison {
    let catalogue = Catalogue::builtin();
    let effects = with.iter().map(|name| Arc::clone(catalogue.find(name).unwrap())).collect();
    compare(data, muscle, &Options::new(catalogue, effects)).unwrap()
}

/// 2 N or -2 N, neighbours unlike, the same number of both in either direction.
fn alternating(row: usize) -> f64 {
    if (row / 2 + row).is_multiple_of(2) { 2.0 } else { -2.0 }
}

#[test]
fn errors_are_those_of_the_definition() {
    // 10 N too much, and 7 N of friction, at every row.
    let data = loops(|_, direction| 10.0 - 7.0 * direction);
    let rung = &climbed(&data, &muscle(""), &[]).ladder[0];
    assert!((rung.rmse_n - 149.0_f64.sqrt()).abs() < 1e-6, "{}", rung.rmse_n);
    assert!((rung.bias_n - 10.0).abs() < 1e-6 && (rung.largest_n - 17.0).abs() < 1e-6);
    assert!((rung.half_gap_rmse_n.unwrap() - 7.0).abs() < 1e-6);
    assert!((rung.held_out_rmse_n.unwrap() - rung.rmse_n).abs() < 1e-9, "nothing was fitted");
    let forces = data.force();
    let mean = forces.iter().sum::<f64>() / 120.0;
    let total: f64 = forces.iter().map(|f| (f - mean).powi(2)).sum();
    assert!((rung.r_squared - (1.0 - 120.0 * 149.0 / total)).abs() < 1e-9);
    let most = forces.iter().copied().fold(0.0, f64::max);
    assert!((rung.rmse_percent - 100.0 * 149.0_f64.sqrt() / most).abs() < 1e-9);
}

#[test]
fn loops_and_maps_are_means_of_residuals() {
    let comparison = climbed(&loops(|_, direction| 10.0 - 7.0 * direction), &muscle(""), &[]);
    for gap in &comparison.loops {
        for (measured, model) in gap.half_gap_measured_n.iter().zip(&gap.half_gap_model_n[0]) {
            assert!((measured - model - 7.0).abs() < 1e-6);
        }
    }
    for map in &comparison.maps {
        let hoped = if map.direction == "shortening" { 3.0 } else { 17.0 };
        assert!(map.first_n.iter().flatten().all(|n| (n - hoped).abs() < 1e-6), "{}", map.direction);
    }
    let by = comparison.by.iter().find(|by| by.variable == "direction").unwrap();
    assert!((by.bins[0].bias_n[0] - 3.0).abs() < 1e-6 && (by.bins[0].rmse_n[0] - 3.0).abs() < 1e-6);
}

#[test]
fn an_interval_is_students_quantile_times_the_standard_deviation() {
    let data = loops(|row, _| 30.0 + alternating(row));
    let comparison = climbed(&data, &muscle("[instruments]\nforce = { noise = \"2 N\" }"), &["force-offset"]);
    let fit = comparison.ladder[1].fit.as_ref().unwrap();
    let offset = &fit.parameters[0];
    // The prior is wide; 119 degrees of freedom: 1.980. Rows that alternate don't count for less.
    assert!((fit.effective_rows - 120.0).abs() < 1e-9);
    let half = 1.980_10 * 2.0 * (120.0_f64 / 119.0).sqrt() / 120.0_f64.sqrt();
    assert!((0.5 * (offset.high - offset.low) / half - 1.0).abs() < 2e-3, "{offset:?}, {half}");
    assert!((offset.value - 30.0).abs() < 0.1);
}

#[test]
fn a_stated_width_is_a_prior_about_the_stated_value() {
    // Data and statement agree: whatever their weights, the radius stays.
    let stated = muscle("[instruments]\nforce = { noise = \"200 N\" }");
    let stated = from_toml(
        &bulge_muscles::to_toml(&stated).replace("radius = \"10 mm\"", "radius = \"10 mm +- 0.1 mm\""),
        "w.toml",
    )
    .unwrap();
    let comparison = climbed(&loops(|row, _| alternating(row)), &stated, &[]);
    let fit = comparison.ladder[0].fit.as_ref().unwrap();
    let radius = fit.parameters.iter().find(|p| p.effect == "radius-error").unwrap();
    assert!((radius.value - 10.0).abs() < 0.01 && radius.nuisance, "{radius:?}");
    // 0.1 mm, hardly narrowed by such noise.
    assert!((0.5 * (radius.high - radius.low) / 0.196 - 1.0).abs() < 0.25, "{radius:?}");
}

#[test]
fn input_errors_add_in_squares() {
    let moments = vec![Moment::at_rest(1e5, 0.1); 2];
    let record = Record::from_moments(moments, vec![0.0; 2], std::iter::once(0..2).collect()).unwrap();
    let slopes = Prediction {
        force: vec![0.0; 2],
        jacobian: Vec::new(),
        by_pressure: vec![0.003, 0.0],
        by_contraction: vec![0.0, -5000.0],
    };
    let noise = Noise { force_n: 4.0, pressure_pa: 1000.0, contraction: 0.002 };
    let sd = noise.of_rows(&record, &slopes);
    assert!((sd[0] - 5.0).abs() < 1e-12 && (sd[1] - 116.0_f64.sqrt()).abs() < 1e-12, "{sd:?}");
}

#[test]
fn the_floor_is_the_noise_and_not_below_the_resolution() {
    let floor = |data: &Data| climbed(data, &muscle(""), &[]).noise_floor.unwrap().sd_n;
    let noisy = floor(&loops(|row, _| alternating(row)));
    assert!((1.5..2.4).contains(&noisy), "{noisy}");
    let model = Model::new(&muscle(""));
    let exact =
        model.evaluate(&Record::new(&loops(|_, _| 0.0), 0.25), &[], &Wanted::default()).unwrap().force;
    let coarse = floor(&loops(|row, _| 80.0 * (exact[row] / 80.0).round() - exact[row]));
    assert!(coarse >= 80.0 / 12.0_f64.sqrt() - 1e-6, "{coarse}");
}

/// Where the model lacks something, the rig errors of the data sheet may not make up for it in silence.
#[test]
fn a_rig_error_beyond_its_data_sheet_is_said() {
    let sheet = "[instruments]\nforce = { noise = \"0.1 N\", zero = \"2 N\" }";
    let small = loops(|row, _| 1.5 + 0.05 * alternating(row));
    let large = loops(|row, _| 150.0 + 0.05 * alternating(row));
    let found = |data: &Data| climbed(data, &muscle(sheet), &[]).ladder[0].fit.clone().unwrap();
    let [within, beyond] = [found(&small), found(&large)];
    assert!(within.parameters[0].plausible && within.warnings.is_empty(), "{:?}", within.warnings);
    assert!(!beyond.parameters[0].plausible && (beyond.parameters[0].value - 150.0).abs() < 1.0);
    assert!(
        beyond.warnings[0].contains("far beyond its data sheet (-8.00 to 8.00 N)"),
        "{:?}",
        beyond.warnings
    );
}
