//! The closed form, one muscle at a time and many in one call.

use bulge_fibre::closed_form::{solve, solve_many};
use bulge_fibre::{Approach, Problem};
use bulge_muscles::{Parameter, Pressure, preset};
use bulge_numerics::Random;

/// Contraction between two limits, slenderness 1.2 to 500 and an elastic group of up to a third of what makes fibres balloon.
fn random(random: &mut Random, [low, high]: [f64; 2]) -> [f64; 3] {
    let slenderness = 1.2 * (6.0 * random.uniform()).exp();
    let group = (-18.0 * random.uniform() - 1.0).exp();
    [low + (high - low) * random.uniform(), slenderness, group / (slenderness * slenderness)]
}

/// Muscles that need different numbers of iterations, that are stretched, and that have no equilibrium stand side by side.
#[test]
fn many_are_each_as_it_is_alone() {
    let mut draw = Random::new(3, 0);
    let asked: Vec<[f64; 3]> = (0..403)
        .map(|i| {
            let [contraction, slenderness, kappa] = random(&mut draw, [-0.05, 0.7]);
            [contraction, slenderness, if i % 3 == 0 { 0.0 } else { kappa }]
        })
        .chain([[0.1, f64::NAN, 0.0], [0.2, 6.0, 0.1], [0.3, 6.0, 0.0], [f64::NAN, 6.0, 0.0]])
        .collect();
    let many = solve_many(&asked);
    assert_eq!(many.len(), asked.len());
    let mut failed = 0;
    for ([contraction, slenderness, kappa], many) in asked.iter().zip(&many) {
        let alone = solve(*contraction, *slenderness, *kappa);
        failed += usize::from(alone.is_err());
        // As text, which tells every digit, and NaN from NaN.
        assert_eq!(format!("{alone:?}"), format!("{many:?}"), "{contraction} {slenderness} {kappa}");
    }
    assert!((4..60).contains(&failed), "{failed} without equilibrium");
}

#[test]
fn problems_are_followed_together_as_alone() {
    let preset = |name| preset(name).unwrap();
    let elastic = preset("ppam-2-r16").with(Parameter::FibreStiffness, 2e4).unwrap();
    let muscles = [preset("ppam-2-r16"), elastic, preset("dmsp-20-250")];
    let problems = muscles.map(|muscle| Problem::new(&muscle, Pressure::kpa(150.0)).unwrap());
    let contractions = [0.03, -0.02, 0.1, 0.2, 0.9, 0.31, 1.2];
    let asked: Vec<_> = problems.iter().flat_map(|problem| contractions.map(|at| (problem, at))).collect();
    for ((problem, at), found) in asked.iter().zip(Problem::follow_each(&asked, Approach::Auto)) {
        assert_eq!(format!("{:?}", problem.follow(*at, Approach::Auto)), format!("{found:?}"), "{at}");
    }
}

/// Starts within 2e-6 are 4e-12 off after a step, which the second evaluation confirms.
#[test]
fn inextensible_fibres_take_two_evaluations() {
    for slenderness in [1.0, 1.5, 3.0, 6.875, 20.0, 100.0, 1000.0] {
        let mut contraction = 1e-9;
        while let Ok(found) = solve(contraction, slenderness, 0.0) {
            if found.m > 0.5 {
                break;
            }
            assert!(found.evaluations <= 2, "{contraction} of {slenderness}: {}", found.evaluations);
            contraction = (1.3 * contraction).min(contraction + 0.01);
        }
        assert!(contraction > 0.1, "ends at {contraction} for {slenderness}");
    }
}

#[test]
fn elastic_fibres_take_few_evaluations() {
    let mut draw = Random::new(4, 0);
    let mut most = 0;
    let mut mean = |limits: [f64; 2]| {
        let taken = (0..2000).map(|_| {
            let [contraction, slenderness, kappa] = random(&mut draw, limits);
            solve(contraction, slenderness, kappa).unwrap().evaluations
        });
        let taken: Vec<u32> = taken.collect();
        most = taken.iter().copied().max().unwrap_or(0).max(most);
        f64::from(taken.iter().sum::<u32>()) / 2000.0
    };
    let means = [mean([-0.1, 0.0]), mean([0.0, 0.02]), mean([0.02, 0.5])];
    for (mean, at_most) in means.into_iter().zip([2.75, 3.15, 2.7]) {
        assert!(mean < at_most, "{means:?}");
    }
    assert!(most <= 8, "{most}");
}

/// Where numbers underflow there is an error, and no answer that isn't a number.
#[test]
fn tiny_contractions_have_a_shape_or_an_error() {
    for exponent in (1..308).step_by(3) {
        let contraction = 10.0_f64.powi(-exponent);
        match solve(contraction, 20.0, 0.0) {
            // F_t ~ 1/sqrt(eps): a shallow arc has t^4 = 3/2 eps L^2 and f = pi/(2 t^2).
            Ok(found) if exponent > 12 => {
                let shallow = std::f64::consts::FRAC_PI_2 / (1.5 * contraction * 400.0).sqrt();
                assert!((found.force.value / shallow - 1.0).abs() < 1e-5, "1e-{exponent}: {found:?}");
                // Below, dF/dm loses its digits, and Newton's method its speed.
                assert!(found.evaluations <= 2 || exponent > 24, "1e-{exponent}: {}", found.evaluations);
            }
            Ok(found) => assert!(found.force.value.is_finite(), "{found:?}"),
            Err(_) => assert!(exponent > 240, "1e-{exponent}"),
        }
    }
}
