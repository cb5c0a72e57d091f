//! Profiles against the covariance of a linear problem and the closed form of a decay.

use super::*;

#[test]
fn profile_of_a_linear_problem_is_the_covariance_interval() {
    let problem = model(12, 3, |p, i| {
        let x = 0.3 * i as f64;
        Some((p[0] + p[1] * x + p[2] * x * x - x.exp(), vec![1.0, x, x * x]))
    });
    let minimum = free(&problem, &[0.0; 3]);
    let rise = 3.841_458_820_694_124_f64;
    for j in 0..3 {
        let half = rise.sqrt() * minimum.standard_deviations(1.0)[j].unwrap();
        let found = profile(&problem, &minimum, &Bounds::none(3), &Options::default(), j, rise).unwrap();
        let (ProfileEnd::Crossed(lower), ProfileEnd::Crossed(upper)) = (found.lower, found.upper) else {
            panic!("{found:?}")
        };
        assert_close(&[lower, upper], &[minimum.theta[j] - half, minimum.theta[j] + half], 1e-9);
    }
}

#[test]
fn profile_of_a_decay_agrees_with_its_closed_form() {
    let rows = 12;
    let problem = decay(rows, [1.0, 1.0], in_order);
    let minimum = free(&problem, &[1.0, 0.1]);
    // For a given rate the best amplitude is a ratio of sums.
    let cost = |b: f64| {
        let e = |i: usize| (-b * time(i)).exp();
        let (ye, ee): (f64, f64) =
            ((0..rows).map(|i| e(i) * decay_data(i)).sum(), (0..rows).map(|i| e(i) * e(i)).sum());
        (0..rows).map(|i| (ye / ee * e(i) - decay_data(i)).powi(2)).sum::<f64>()
    };
    // A rise large enough that the interval is visibly lopsided.
    let rise = 1.0;
    let edge = |mut inside: f64, mut outside: f64| {
        for _ in 0..200 {
            let middle = 0.5 * (inside + outside);
            if cost(middle) - minimum.cost < rise { inside = middle } else { outside = middle }
        }
        inside
    };
    let found = profile(&problem, &minimum, &Bounds::none(2), &Options::default(), 1, rise).unwrap();
    let best = minimum.theta[1];
    let expected = [edge(best, 0.0), edge(best, 10.0)];
    let (ProfileEnd::Crossed(lower), ProfileEnd::Crossed(upper)) = (found.lower, found.upper) else {
        panic!("{found:?}")
    };
    assert_close(&[lower, upper], &expected, 1e-9);
    assert!((upper - best) > 1.2 * (best - lower));
}

/// The others are predicted along the profile: in a linear problem each point is a minimum at once, so that it takes a linearisation
/// and the check that it is one. The rise is quadratic, so that two points bracket the root of its root.
#[test]
fn a_profile_of_a_linear_problem_is_as_cheap_as_it_can_be() {
    use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
    let asked = AtomicUsize::new(0);
    let problem = model(9, 3, |p, i| {
        if i == 0 {
            asked.fetch_add(1, Relaxed);
        }
        let x = i as f64;
        Some((p[0] + p[1] * x + p[2] * x * x - (x * x * 7.0 + 2.0 * x) % 11.0, vec![1.0, x, x * x]))
    });
    let minimum = free(&problem, &[0.0; 3]);
    asked.store(0, Relaxed);
    profile(&problem, &minimum, &Bounds::none(3), &Options::default(), 1, 4.0).unwrap();
    assert_eq!(asked.load(Relaxed), 5);
}

#[test]
fn open_profiles_say_why() {
    let (problem, usual) = (decay(12, [1.0, 1.0], in_order), Options::default());
    let minimum = free(&problem, &[1.0, 0.1]);
    // A bound before the rise; a rise that even an infinite rate doesn't reach.
    let bounds = Bounds { lower: vec![f64::NEG_INFINITY, 0.6], upper: vec![f64::INFINITY; 2] };
    let found = profile(&problem, &minimum, &bounds, &usual, 1, 1.0).unwrap();
    assert!(matches!(found.lower, ProfileEnd::AtBound { value: 0.6, rise } if rise > 0.0 && rise < 1.0));
    let found = profile(&problem, &minimum, &Bounds::none(2), &usual, 1, 1e3).unwrap();
    let all: f64 = (1..12).map(|i| decay_data(i).powi(2)).sum();
    let ProfileEnd::Unbounded { rise, .. } = found.upper else { panic!("{found:?}") };
    assert_close(&[rise], &[all - minimum.cost], 1e-9);
    // Residuals that end at x = 2, in a parabola of one parameter.
    let ending = model(1, 1, |p, _| (p[0] <= 2.0).then(|| (p[0] - 1.0, vec![1.0])));
    let found = profile(&ending, &free(&ending, &[0.0]), &Bounds::none(1), &usual, 0, 4.0).unwrap();
    assert!(matches!(found.lower, ProfileEnd::Crossed(x) if (x + 1.0).abs() < 1e-9));
    assert!(
        matches!(found.upper, ProfileEnd::Undefined { value, .. } if (value - 2.0).abs() < 1e-5),
        "{found:?}"
    );
    // Inwards from a bound: (x + 1)^2 with x >= 0 rises by 2 x + x^2 = 3 at x = 1.
    let held = model(1, 1, |p, _| Some((p[0] + 1.0, vec![1.0])));
    let bounds = Bounds { lower: vec![0.0], upper: vec![f64::INFINITY] };
    let found = profile(&held, &least(&held, &[5.0], &bounds), &bounds, &usual, 0, 3.0).unwrap();
    assert_eq!(found.lower, ProfileEnd::AtBound { value: 0.0, rise: 0.0 });
    assert!(matches!(found.upper, ProfileEnd::Crossed(x) if (x - 1.0).abs() < 1e-9));
}

#[test]
fn profiles_refuse_what_is_no_minimum() {
    let (problem, usual, none) = (two_minima(), Options::default(), Bounds::none(1));
    // From the upper minimum (cost 0.04) towards the lower one.
    let minimum = free(&problem, &[-1.0]);
    let error = profile(&problem, &minimum, &none, &usual, 0, 2.0).unwrap_err();
    assert!(error.to_string().contains("below that of the given minimum"), "{error}");
    let error = profile(&problem, &minimum, &none, &usual, 1, 2.0).unwrap_err();
    assert!(error.to_string().starts_with("parameter 1 cannot be profiled: the problem has 1"), "{error}");
    let error = profile(&problem, &minimum, &none, &usual, 0, -1.0).unwrap_err();
    assert_eq!(error.to_string(), "the option rise is -1; it must be positive and finite");
    for wrong in [0.0, f64::INFINITY] {
        let error = profile(&problem, &minimum, &none, &usual, 0, wrong).unwrap_err();
        assert_eq!(error.to_string(), format!("the option rise is {wrong}; it must be positive and finite"));
    }
}
