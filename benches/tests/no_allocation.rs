//! A solve allocates nothing: it can run in a control loop, and on many threads without a lock.

use allocation_counter::measure;
use bulge_benches::{bladder, braid, cylinder, pleated, solve};
use bulge_fibre::{Approach, Problem, closed_form};
use std::hint::black_box;

fn assert_allocates_nothing(what: &str, problem: &Problem, approach: Approach, contractions: &[f64]) {
    for &contraction in contractions {
        let mut force = f64::NAN;
        let counted =
            measure(|| force = solve(problem, contraction, approach).map_or(f64::NAN, |r| r.force_n));
        assert!(force > 0.0, "{what} at {contraction}: force {force}");
        assert_eq!(counted.count_total, 0, "{what} at {contraction}: {} bytes", counted.bytes_total);
    }
}

#[test]
fn the_counter_counts() {
    assert_eq!(measure(|| drop(black_box(Box::new(1)))).count_total, 1);
}

#[test]
fn closed_form_allocates_nothing() {
    let counted = measure(|| {
        let _ = black_box(closed_form::solve(black_box(0.2), 6.875, 1e-4));
    });
    assert_eq!(counted.count_total, 0);
    assert_allocates_nothing("inelastic", &pleated(None).unwrap(), Approach::Auto, &[1e-6, 0.05, 0.2, 0.41]);
    assert_allocates_nothing("elastic", &pleated(Some(12e3)).unwrap(), Approach::Auto, &[-0.001, 0.0, 0.2]);
    assert_allocates_nothing("cylinder", &cylinder().unwrap(), Approach::Auto, &[0.02, 0.2]);
}

#[test]
fn shooting_allocates_nothing() {
    assert_allocates_nothing(
        "pleated",
        &pleated(None).unwrap(),
        Approach::Shooting,
        &[1e-6, 0.05, 0.2, 0.41],
    );
    assert_allocates_nothing("elastic", &pleated(Some(12e3)).unwrap(), Approach::Shooting, &[0.0, 0.2]);
    for length_over_radius in [3.0, 25.0, 100.0] {
        let name = format!("braid of {length_over_radius}");
        assert_allocates_nothing(
            &name,
            &braid(length_over_radius).unwrap(),
            Approach::Shooting,
            &[0.02, 0.1, 0.24],
        );
    }
    assert_allocates_nothing("bladder", &bladder().unwrap(), Approach::Auto, &[0.02, 0.1, 0.2]);
}
