//! Held equilibria are exact where they were solved and of first order beside it. They are shared with models
//! that leave the muscle unchanged.

#![expect(clippy::unwrap_used, reason = "a test that cannot be set up fails")]

use bulge_effects::{Catalogue, Moment};
use bulge_model::{Model, Record, Wanted, Warm};
use bulge_muscles::from_toml;

const THETA: [f64; 3] = [0.0102, -0.02, 1e-4];

fn model(effects: &[&str]) -> Model {
    let file = "name = \"b\"\nkind = \"braided\"\nlength = \"300 mm\"\nradius = \"10 mm\"\nwall = \"1.8 mm\"\n\
                braid_angle = \"28.6 deg\"\nends = \"clamped\"\n";
    let catalogue = Catalogue::builtin();
    let base = Model::new(&from_toml(file, "braid").unwrap());
    effects.iter().fold(base, |model, name| model.with(catalogue.find(name).unwrap(), None).unwrap())
}

/// Slow strokes at three pressures, with enough rows for a lattice to pay off.
fn record() -> Record {
    let moment = |i: u32| Moment {
        direction: 1.0,
        begins: i.is_multiple_of(200),
        ..Moment::at_rest(2e5 + 1e5 * f64::from(i / 200), 0.01 + 0.000_8 * f64::from(i % 200))
    };
    let sweeps = (0..3).map(|i| 200 * i..200 * (i + 1)).collect();
    Record::from_moments((0..600).map(moment).collect(), vec![0.0; 600], sweeps).unwrap()
}

fn base() -> Model {
    model(&["radius-error", "braid-angle-error", "length-zero-error"])
}

fn wanted() -> Wanted {
    Wanted { parameters: vec![0, 1, 2], readings: false }
}

/// The shape changed by a fraction of what a data sheet leaves open, together with an input parameter.
fn moved(part: f64) -> Vec<f64> {
    vec![THETA[0] * (1.0 + 0.01 * part), THETA[1] + 0.003 * part, THETA[2] + 2e-4 * part]
}

#[test]
fn what_is_held_is_exact_where_it_was_solved() {
    let (model, record) = (base(), record());
    let warm = Warm::new();
    warm.hold();
    let solved = model.evaluate_warm(&record, &THETA, &wanted(), &warm).unwrap();
    assert!(warm.is_held());
    assert_eq!(solved, model.evaluate_warm(&record, &THETA, &wanted(), &warm).unwrap());
    // Only the shape is linearised, not the input.
    let shifted = vec![THETA[0], THETA[1], 5e-4];
    let held = model.evaluate_warm(&record, &shifted, &wanted(), &warm).unwrap();
    let full = model.evaluate(&record, &shifted, &wanted()).unwrap();
    for (held, full) in held.force.iter().zip(&full.force) {
        assert!((held - full).abs() < 1e-6 * 1500.0, "{held} {full}");
    }
    warm.release();
    assert!(!warm.is_held());
}

#[test]
fn beside_it_the_error_falls_with_the_square() {
    let (model, record) = (base(), record());
    let error = |part: f64| {
        let warm = Warm::new();
        warm.hold();
        model.evaluate_warm(&record, &THETA, &wanted(), &warm).unwrap();
        let held = model.evaluate_warm(&record, &moved(part), &Wanted::default(), &warm).unwrap();
        let full = model.evaluate(&record, &moved(part), &Wanted::default()).unwrap();
        held.force.iter().zip(&full.force).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    let errors = [1.0, 0.5, 0.25].map(error);
    let order = (errors[0] / errors[2]).log2() / 2.0;
    assert!((order - 2.0).abs() < 0.1 && errors[0] < 2.0 && errors[0] > 0.01, "{errors:?}");
}

/// A search that began where nothing is interpolated ends with the model itself, also where a lattice would pay.
#[test]
fn nothing_is_held_any_more_once_that_is_said() {
    let (base, record) = (base(), record());
    for holds in [true, false] {
        let warm = Warm::new();
        warm.hold();
        if !holds {
            warm.hold_no_more();
        }
        base.evaluate_warm(&record, &base.start(), &wanted(), &warm).unwrap();
        assert_eq!(warm.is_held(), holds);
    }
}

#[test]
fn a_shape_that_was_held_without_derivatives_is_solved_again() {
    let (model, record) = (base(), record());
    let warm = Warm::new();
    warm.hold();
    model.evaluate_warm(&record, &THETA, &Wanted::default(), &warm).unwrap();
    let found = model.evaluate_warm(&record, &moved(1.0), &Wanted::default(), &warm).unwrap();
    let full = model.evaluate(&record, &moved(1.0), &Wanted::default()).unwrap();
    for (found, full) in found.force.iter().zip(&full.force) {
        assert!((found - full).abs() < 1e-6 * 1500.0, "{found} {full}");
    }
}

#[test]
fn what_is_shared_serves_the_same_muscle_only() {
    let record = record();
    let warm = Warm::new();
    warm.hold();
    let base = base();
    base.evaluate_warm(&record, &THETA, &wanted(), &warm).unwrap();
    assert!(warm.is_held() && warm.shared().is_held());
    let all = ["radius-error", "braid-angle-error", "length-zero-error"];
    for (effect, value) in
        [("coulomb-friction", 8.0), ("bladder-elasticity", 2e5), ("pressure-offset", 500.0)]
    {
        let more = model(&[&all[..], &[effect]].concat());
        let theta = [&THETA[..], &[value]].concat();
        let shared = more.evaluate_warm(&record, &theta, &Wanted::default(), &warm.shared()).unwrap();
        let full = more.evaluate(&record, &theta, &Wanted::default()).unwrap();
        for (shared, full) in shared.force.iter().zip(&full.force) {
            assert!((shared - full).abs() < 1e-6 * 1500.0, "{effect}: {shared} {full}");
        }
    }
}

/// Near the largest contraction the next nodes have no equilibrium, so stencils are shifted.
#[test]
fn rows_next_to_the_end_of_equilibria_are_those_solved_alone() {
    let model = model(&["radius-error", "bladder-elasticity"]);
    let theta = [0.0102, 3e5];
    let forces = |contractions: &[f64]| {
        let moment = |(i, e): (usize, &f64)| Moment { begins: i == 0, ..Moment::at_rest(2e5, *e) };
        let rows = contractions.len();
        let moments = contractions.iter().enumerate().map(moment).collect();
        let record =
            Record::from_moments(moments, vec![0.0; rows], std::iter::once(0..rows).collect()).unwrap();
        model.evaluate(&record, &theta, &Wanted::default()).map(|found| found.force)
    };
    let mut end = 0.1;
    // The last rows are hard for any search.
    while forces(&[end + 0.005]).is_ok() {
        end += 0.001;
    }
    let contractions: Vec<f64> = (0..4000).map(|i| end - (end - 0.02) * f64::from(i) / 4000.0).collect();
    let found = forces(&contractions).unwrap();
    let errors: Vec<f64> =
        (0..4000).step_by(17).map(|i| (found[i] - forces(&contractions[i..=i]).unwrap()[0]).abs()).collect();
    let full = found.iter().fold(0.0_f64, |most, force| most.max(force.abs()));
    let interpolated = errors.iter().filter(|error| **error > 0.0).count();
    let worst = errors.iter().copied().fold(0.0, f64::max);
    // Rows up to the zero of the force are interpolated. The rest, next to the end, is solved row by row.
    assert!(worst < 1e-4 * full && 2 * interpolated > errors.len(), "{worst} N, {interpolated}");
}

/// What was answered serves models that ask the same question: an effect that doesn't change the shape finds the
/// forces that it would find alone, bit for bit where nothing is interpolated, and a changed shape is solved.
#[test]
fn answers_serve_the_same_muscle_only() {
    let file = "name = \"b\"\nkind = \"braided\"\nlength = \"300 mm\"\nradius = \"10 mm\"\nwall = \"1.8 mm\"\n\
                braid_angle = \"28.6 deg\"\nends = \"cylinder\"\n\n[specimens.2]\nradius = \"9 mm\"\n";
    let catalogue = Catalogue::builtin();
    let muscle = from_toml(file, "braid").unwrap();
    let base = Model::new(&muscle).for_specimens(&["1".to_owned(), "2".to_owned()]).unwrap();
    let with = |name: &str, value: f64| base.with(catalogue.find(name).unwrap(), Some(&[value])).unwrap();
    // The same readings of both specimens, row by row.
    let at = |i: u32| Moment {
        specimen: i % 2,
        ..Moment::at_rest(2e5 + 1e5 * f64::from(i / 40), 0.01 + 0.004 * f64::from(i % 40 / 2))
    };
    let record =
        Record::from_moments((0..120).map(at).collect(), vec![0.0; 120], vec![0..60, 60..120]).unwrap();
    let warm = Warm::new();
    warm.hold();
    let first = base.evaluate_warm(&record, &[], &Wanted::default(), &warm).unwrap().force;
    assert!((first[0] / first[1] - 1.0).abs() > 0.1, "the specimens differ");
    let models = [
        with("coulomb-friction", 8.0),
        with("pressure-offset", 500.0),
        with("bladder-elasticity", 2e5),
        with("radius-error", 0.0102),
    ];
    for model in &models {
        let wanted = Wanted { parameters: vec![0], readings: true };
        let theta = model.start();
        let shared = model.evaluate_warm(&record, &theta, &wanted, &warm.shared()).unwrap();
        let alone = model.evaluate_warm(&record, &theta, &wanted, &Warm::new()).unwrap();
        assert_eq!(shared, alone, "{}", model.parameters()[0].effect);
    }
}
