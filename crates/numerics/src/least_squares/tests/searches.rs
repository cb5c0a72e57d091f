//! Searches against known solutions: bounds, rank, scales, saddles, failures, determinism.

use super::*;

#[test]
fn an_active_bound_of_a_linear_problem_is_exact() {
    // (x - 2)^2 + (x + y - 1)^2: free at (2, -1); with y >= 0 at (1.5, 0), where (J^T r)_y = x + y - 1 = 0.5 points outwards.
    let problem = model(2, 2, |p, row| {
        Some(if row == 0 { (p[0] - 2.0, vec![1.0, 0.0]) } else { (p[0] + p[1] - 1.0, vec![1.0, 1.0]) })
    });
    let bounds = Bounds { lower: vec![f64::NEG_INFINITY, 0.0], upper: vec![f64::INFINITY; 2] };
    let minimum = least(&problem, &[7.0, 4.0], &bounds);
    assert_eq!(minimum.theta[1].to_bits(), 0);
    assert_close(&minimum.theta[..1], &[1.5], 1e-14);
    assert_close(&minimum.gradient, &[0.0, 0.5], 1e-11);
    assert_close(&[minimum.cost], &[0.5], 1e-14);
    let certificate = &minimum.certificate;
    assert!(certificate.converged && certificate.at_bound == [None, Some(Side::Lower)]);
    assert_eq!((certificate.rank, minimum.standard_deviations(1.0)[1]), (1, None));
    // The variance of x alone: 1/(1 + 1).
    assert_close(&minimum.covariance(1.0), &[0.5, 0.0, 0.0, 0.0], 1e-14);
    // A bound that doesn't hold the minimum is left: from (2, 0) on an upper bound.
    let bounds = Bounds { lower: vec![f64::NEG_INFINITY; 2], upper: vec![f64::INFINITY, 0.0] };
    let minimum = least(&problem, &[2.0, 0.0], &bounds);
    assert_close(&minimum.theta, &[2.0, -1.0], 1e-14);
    assert_eq!(minimum.certificate.at_bound, [None, None]);
}

#[test]
fn boxes_agree_with_trying_every_active_set() {
    let mut seed = 1_u32;
    let mut random = || {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(seed >> 8) / f64::from(1_u32 << 23) - 1.0
    };
    let mut steps = 0;
    for _ in 0..200 {
        let (a, b): (Vec<f64>, Vec<f64>) =
            ((0..15).map(|_| random()).collect(), (0..5).map(|_| random()).collect());
        let bounds = Bounds {
            lower: (0..3).map(|_| -0.3 * random().abs()).collect(),
            upper: (0..3).map(|_| 0.3 * random().abs()).collect(),
        };
        let residual = |p: &[f64], i: usize| b[i] + (0..3).map(|j| a[3 * i + j] * p[j]).sum::<f64>();
        let cost = |p: &[f64]| (0..5).map(|i| residual(p, i).powi(2)).sum::<f64>();
        let problem = model(5, 3, |p, i| Some((residual(p, i), a[3 * i..3 * i + 3].to_vec())));
        let found = least(&problem, &[0.0; 3], &bounds);
        assert!(found.certificate.converged, "{found:?}");
        // Minimum over each of the 27 faces, by coordinate descent; the best feasible one is the answer.
        let mut best = f64::INFINITY;
        for face in 0..27 {
            let side = |j: u32| face / 3_usize.pow(j) % 3;
            let mut p: Vec<f64> = (0..3)
                .map(|j| [0.0, bounds.lower[j], bounds.upper[j]][side(u32::try_from(j).unwrap())])
                .collect();
            for _ in 0..20_000 {
                let before = p.clone();
                for j in (0..3).filter(|j| side(u32::try_from(*j).unwrap()) == 0) {
                    let column = (0..5).map(|i| a[3 * i + j]);
                    let slope: f64 = column.clone().zip(0..5).map(|(x, i)| x * residual(&p, i)).sum();
                    p[j] -= slope / column.map(|x| x * x).sum::<f64>();
                }
                if p.iter().zip(&before).all(|(x, y)| (x - y).abs() < 1e-15) {
                    break;
                }
            }
            if (0..3).all(|j| p[j] >= bounds.lower[j] && p[j] <= bounds.upper[j]) {
                best = best.min(cost(&p));
            }
        }
        assert!((found.cost - best).abs() < 1e-10, "{} {best}", found.cost);
        steps += found.iterations;
    }
    // A step that ends on a wrong face would be found out, but cost another.
    assert_eq!(steps, 200);
}

#[test]
fn forty_bounded_parameters_meet_the_conditions_of_a_minimum() {
    // Rows of a smooth kernel: far from orthogonal, and half of the bounds are active.
    let (rows, k) = (120, 40);
    let kernel = |i: usize, j: usize| 1.0 / (1.0 + (0.3 * i as f64 - j as f64).powi(2));
    let data = |i: usize| (0.37 * i as f64).sin() + 0.3 * (1.9 * i as f64).cos();
    let problem = model(rows, k, move |p, i| {
        let row: Vec<f64> = (0..k).map(|j| kernel(i, j)).collect();
        let sum: f64 = row.iter().zip(p).map(|(a, p)| a * p.sin()).sum();
        Some((sum - data(i), row.iter().zip(p).map(|(a, p)| a * p.cos()).collect()))
    });
    let bounds = Bounds { lower: vec![-0.3; k], upper: vec![0.4; k] };
    let minimum = least(&problem, &vec![0.1; k], &bounds);
    assert!(minimum.certificate.converged, "{:?}", minimum.certificate);
    let held = minimum.certificate.at_bound.iter().flatten().count();
    assert!((5..36).contains(&held), "{held}");
    for (j, side) in minimum.certificate.at_bound.iter().enumerate() {
        let (theta, gradient) = (minimum.theta[j], minimum.gradient[j]);
        match side {
            Some(Side::Lower) => assert!(theta.to_bits() == (-0.3_f64).to_bits() && gradient > 0.0),
            Some(Side::Upper) => assert!(theta.to_bits() == 0.4_f64.to_bits() && gradient < 0.0),
            None => assert!(theta > -0.3 && theta < 0.4 && gradient.abs() < 1e-8, "{theta} {gradient}"),
        }
    }
}

#[test]
fn rosenbrock_free_and_bounded() {
    let minimum = free(&rosenbrock(), &[-1.2, 1.0]);
    assert_close(&minimum.theta, &[1.0, 1.0], 1e-13);
    assert_eq!([minimum.iterations, minimum.evaluations, minimum.linearisations], [3, 5, 8]);
    let bounds = Bounds { lower: vec![-2.0; 2], upper: vec![0.5, 2.0] };
    let minimum = least(&rosenbrock(), &[-1.2, 1.0], &bounds);
    assert_eq!(minimum.theta[0].to_bits(), 0.5_f64.to_bits());
    assert_close(&minimum.theta[1..], &[0.25], 1e-12);
    assert_close(&minimum.gradient[..1], &[-0.5], 1e-9);
    assert_eq!(minimum.certificate.at_bound, [Some(Side::Upper), None]);
    // Fixed: y = 3 leaves 100 (3 - x^2)^2 + (1 - x)^2, stationary where 200 x (x^2 - 3) + x - 1 = 0.
    let minimum = least(&rosenbrock(), &[1.0, 3.0], &Bounds::none(2).with_fixed(1, 3.0));
    let x = minimum.theta[0];
    assert!((200.0 * x * (x * x - 3.0) + x - 1.0).abs() < 1e-9 && x > 1.7);
    assert_eq!(minimum.theta[1].to_bits(), 3.0_f64.to_bits());
    // A fixed parameter is held even where nothing pulls at it.
    let apart =
        model(2, 2, |p, i| Some(if i == 0 { (p[0] - 1.0, vec![1.0, 0.0]) } else { (p[1], vec![0.0, 1.0]) }));
    let minimum = least(&apart, &[0.0, 0.0], &Bounds::none(2).with_fixed(1, 0.0));
    assert_eq!(minimum.certificate.at_bound, [None, Some(Side::Lower)]);
    assert_eq!(minimum.covariance(1.0), [1.0, 0.0, 0.0, 0.0]);
    let all = minimise(
        &rosenbrock(),
        &[0.0, 3.0],
        &Bounds { lower: vec![0.0, 3.0], upper: vec![0.0, 3.0] },
        &Options::default(),
    );
    assert_eq!(all.unwrap().certificate.reason, Reason::NothingFree);
}

#[test]
fn derivatives_with_every_trial_give_the_same_path_with_fewer_evaluations() {
    let start = [-1.2, 1.0];
    let apart = free(&rosenbrock(), &start);
    let joint = free(&Model { joint: true, ..rosenbrock() }, &start);
    assert_eq!(bits(&joint.theta), bits(&apart.theta));
    assert_eq!(joint.iterations, apart.iterations);
    assert_eq!(joint.evaluations, 0);
    // Each trial is evaluated once.
    assert!(joint.linearisations < apart.evaluations + apart.linearisations);
}

#[test]
fn a_search_goes_on_from_a_point_that_was_linearised() {
    let (problem, bounds, options) = (rosenbrock(), Bounds::none(2), Options::default());
    let known = Linearisation::at(&problem, &[-1.2, 1.0]).unwrap();
    // 10 (1 - 1.44) = -4.4 and 1 + 1.2 = 2.2.
    assert!((known.cost() - 24.2).abs() < 1e-12, "{}", known.cost());
    let found = minimise_from(&problem, known.clone(), &bounds, &options).unwrap();
    assert_eq!(found, minimise(&problem, &[-1.2, 1.0], &bounds, &options).unwrap());
    let beyond = Bounds { lower: vec![-1.0; 2], upper: vec![2.0; 2] };
    let error = minimise_from(&problem, known.clone(), &beyond, &options).unwrap_err().to_string();
    assert!(error.contains("outside its bounds"), "{error}");
    let longer = model(3, 2, |theta, i| Some((theta[0] - i as f64, vec![1.0, 0.0])));
    let error = minimise_from(&longer, known, &bounds, &options).unwrap_err().to_string();
    assert!(error.contains("the start has 2 rows; the problem has 3"), "{error}");
    let error = Linearisation::at(&problem, &[1.0]).unwrap_err().to_string();
    assert!(error.contains("1 numbers; the problem has 2"), "{error}");
}

#[test]
fn blocks_of_many_rows_are_split() {
    // Least squares of a line through 20 001 points in one block: sum t = 0, so the slope is sum t y/sum t^2.
    let rows = 20_001;
    let (t, y) = (|i: usize| i as f64 / 1e4 - 1.0, |i: usize| ((i * 7919) % 101) as f64 / 101.0);
    let line = |p: &[f64], i: usize| Some((p[0] + p[1] * t(i) - y(i), vec![1.0, t(i)]));
    let minimum = free(&Model { block: rows, ..model(rows, 2, line) }, &[0.0, 0.0]);
    let sum = |f: &dyn Fn(usize) -> f64| (0..rows).map(f).sum::<f64>();
    let slope = sum(&|i| t(i) * y(i)) / sum(&|i| t(i) * t(i));
    assert_close(&minimum.theta, &[sum(&y) / rows as f64, slope], 1e-11);
}

#[test]
fn straight_line_has_the_textbook_covariance() {
    // Points x = 0..9: var(slope) = 1/sum (x - 4.5)^2 = 1/82.5; var(intercept) = 1/10 + 4.5^2/82.5; cov = -4.5/82.5.
    let problem = model(10, 2, |p, i| {
        let x = i as f64;
        Some((p[0] + p[1] * x - (1.0 + 2.0 * x + f64::from(u8::from(i == 3))), vec![1.0, x]))
    });
    let minimum = free(&problem, &[0.0, 0.0]);
    let expected = [0.1 + 20.25 / 82.5, -4.5 / 82.5, -4.5 / 82.5, 1.0 / 82.5];
    assert_close(&minimum.covariance(4.0), &expected.map(|c| 4.0 * c), 1e-13);
    let rho = expected[1] / (expected[0] * expected[3]).sqrt();
    assert_close(&minimum.correlation(), &[1.0, rho, rho, 1.0], 1e-13);
    let deviation = minimum.standard_deviations(4.0)[1].unwrap();
    assert_close(&[deviation], &[2.0 / 82.5_f64.sqrt()], 1e-13);
    assert!(minimum.certificate.least_curvature.unwrap() > 0.0);
    // R^T R = J^T J with an upper triangle: 10, sum x = 45, sum x^2 = 285.
    let [a, b, zero, c] = minimum.r[..] else { panic!("{:?}", minimum.r) };
    assert_close(&[a * a, a * b, b * b + c * c, zero], &[10.0, 45.0, 285.0, 0.0], 1e-13);
    // Columns of unit length at an angle of cosine c have the singular values sqrt(1 + c) and sqrt(1 - c).
    let cosine = 45.0 / 2850.0_f64.sqrt();
    let condition = ((1.0 + cosine) / (1.0 - cosine)).sqrt();
    assert_close(&[minimum.certificate.condition], &[condition], 1e-12);
}

#[test]
fn what_the_residuals_do_not_determine_is_reported() {
    // Only a + b matters, c is determined, and d has no influence.
    let problem = model(8, 4, |p, i| {
        let x = i as f64 - 2.0;
        let y = 2.0 * x + 5.0 + 0.1 * (x * 3.0).sin();
        Some(((p[0] + p[1]) * x + p[2] - y, vec![x, x, 1.0, 0.0]))
    });
    let minimum = free(&problem, &[1.0, 0.5, 0.0, 3.0]);
    let certificate = &minimum.certificate;
    assert!(certificate.converged && certificate.rank == 2 && certificate.condition > 1e10);
    assert_eq!(certificate.flat.len(), 2);
    let along = |v: &[f64]| {
        certificate.flat.iter().map(|f| f.iter().zip(v).map(|(f, v)| f * v).sum::<f64>().powi(2)).sum::<f64>()
    };
    let half = 0.5_f64.sqrt();
    assert!((along(&[half, -half, 0.0, 0.0]) - 1.0).abs() < 1e-12);
    assert!((along(&[0.0, 0.0, 0.0, 1.0]) - 1.0).abs() < 1e-12);
    let deviations = minimum.standard_deviations(1.0);
    assert_eq!(deviations.iter().map(Option::is_some).collect::<Vec<_>>(), [false, false, true, false]);
    // Nothing moved along flat directions: the steps of a and b are equal, and d stays.
    assert_close(&[minimum.theta[0] - minimum.theta[1], minimum.theta[3]], &[0.5, 3.0], 1e-9);
    assert!(minimum.covariance(1.0)[..8].iter().all(|c| *c == 0.0));
    // c as in the problem without b: sum 1 = 8, sum x = 12, sum x^2 = 60.
    assert_close(&[minimum.covariance(1.0)[10]], &[60.0 / (8.0 * 60.0 - 144.0)], 1e-10);
}

#[test]
fn fewer_rows_than_parameters_and_no_parameters() {
    let problem =
        model(1, 3, |p, _| Some((p[0] + 2.0 * p[1] * p[1] + p[2] - 4.0, vec![1.0, 4.0 * p[1], 1.0])));
    let minimum = free(&problem, &[0.0, 1.0, 0.0]);
    assert!(minimum.certificate.converged && minimum.cost < 1e-28);
    assert_eq!((minimum.certificate.rank, minimum.certificate.flat.len()), (1, 2));
    let empty = model(3, 0, |_, i| Some((i as f64, Vec::new())));
    let minimum = free(&empty, &[]);
    assert_eq!(
        (minimum.cost.to_bits(), minimum.certificate.reason),
        (5.0_f64.to_bits(), Reason::NothingFree)
    );
    let nothing = model(0, 1, |_, _| None);
    assert_eq!(free(&nothing, &[1.0]).certificate.reason, Reason::ExactFit);
}

#[test]
fn powers_of_two_in_the_parameters_give_the_same_path_bit_for_bit() {
    let plain = free(&decay(40, [1.0, 1.0], in_order), &[1.0, 0.1]);
    assert!(plain.certificate.converged && plain.iterations > 3);
    let scale = [2.0_f64.powi(40), 2.0_f64.powi(-30)];
    let scaled = free(&decay(40, scale, in_order), &[1.0 / scale[0], 0.1 / scale[1]]);
    let back: Vec<f64> = scaled.theta.iter().zip(scale).map(|(t, s)| t * s).collect();
    assert_eq!(bits(&back), bits(&plain.theta));
    assert_eq!(
        (scaled.iterations, scaled.evaluations, scaled.linearisations),
        (plain.iterations, plain.evaluations, plain.linearisations)
    );
    assert_eq!(bits(&scaled.residuals), bits(&plain.residuals));
    // Other factors only change the rounding errors.
    let scaled = free(&decay(40, [1e9, 1e-9], in_order), &[1e-9, 1e8]);
    assert_close(&[scaled.theta[0] * 1e9, scaled.theta[1] * 1e-9], &plain.theta, 1e-9);
    assert_eq!(scaled.iterations, plain.iterations);
}

#[test]
fn order_and_blocks_of_rows_change_the_rounding_alone() {
    let plain = free(&decay(1000, [1.0, 1.0], in_order), &[1.0, 0.1]);
    let mut other = decay(1000, [1.0, 1.0], |row, rows| (row * 7 + 3) % rows);
    for block in [4096, 1, 7, 64] {
        other.block = block;
        let found = free(&other, &[1.0, 0.1]);
        assert_close(&found.theta, &plain.theta, 1e-12);
        assert_close(&found.covariance(1.0), &plain.covariance(1.0), 1e-11);
    }
}

#[test]
fn bytes_do_not_depend_on_threads_or_repetition() {
    let mut problem = decay(5000, [1.0, 1.0], in_order);
    problem.block = 100;
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let found = pool.install(|| free(&problem, &[1.0, 0.1]));
        [bits(&found.theta), bits(&found.residuals), bits(&found.r), bits(&found.covariance(1.0))]
    };
    let one = run(1);
    assert_eq!(one, run(1));
    assert_eq!(one, run(4));
}

#[test]
fn a_million_rows_pass_through_in_blocks() {
    let parameters = [1.0, -2.0, 3.0, 0.5, 0.25, -1.0, 2.0, 4.0];
    let mut problem = model(1_000_000, 8, |p, i| {
        // Powers of x in [-1, 1] would do; products of tent functions are cheaper and equally independent.
        let mut x = (i as f64).mul_add(0.618_033_988_749_894_9, 0.25).fract();
        let row: Vec<f64> = (0..8)
            .map(|_| {
                x = (x * 3.7 + 0.11).fract();
                x - 0.4
            })
            .collect();
        let sum = |p: &[f64]| row.iter().zip(p).map(|(a, b)| a * b).sum::<f64>();
        Some((sum(p) - sum(&parameters), row))
    });
    // The model asserts that no block is larger than this.
    problem.block = 2048;
    let options = Options { check_curvature: false, ..Options::default() };
    let minimum = minimise(&problem, &[0.0; 8], &Bounds::none(8), &options).unwrap();
    assert!(minimum.certificate.converged);
    assert_close(&minimum.theta, &parameters, 1e-12);
}

#[test]
fn stationary_points_that_are_no_minima_are_left() {
    // Maximum of (x^2 - 1)^2 with a zero Jacobian, in any unit.
    for unit in [1e-4, 1.0, 1e4] {
        let hill = model(1, 1, |p, _| Some((unit * (p[0] * p[0] - 1.0), vec![2.0 * unit * p[0]])));
        let minimum = free(&hill, &[0.0]);
        assert_close(&[minimum.theta[0].abs()], &[1.0], 1e-12);
    }
    // x^2 + 4 (1 - x^2)^2 at 0: full rank, J^T r = 0, second derivative of the half: 1 - 8. The minima: x^2 = 1 - 1/8.
    let saddle = model(2, 1, |p, i| {
        Some(if i == 0 { (p[0], vec![1.0]) } else { (2.0 * (1.0 - p[0] * p[0]), vec![-4.0 * p[0]]) })
    });
    let minimum = free(&saddle, &[0.0]);
    assert!(minimum.certificate.converged);
    assert_close(&[minimum.theta[0].abs()], &[0.875_f64.sqrt()], 1e-9);
    // Half the second derivative there: 1 - 8 + 24 x^2 = 14, relative to the column's |J|^2 = 1 + 16 x^2 =
    // 15.
    assert_close(&[minimum.certificate.least_curvature.unwrap()], &[14.0 / 15.0], 1e-4);
    let trusting = Options { check_curvature: false, ..Options::default() };
    let stationary = minimise(&saddle, &[0.0], &Bounds::none(1), &trusting).unwrap();
    assert!(stationary.certificate.least_curvature.is_none() && stationary.theta[0] == 0.0);
    // With the bound x <= 0 only, the same point is a minimum, and the other side is searched.
    let bounds = Bounds { lower: vec![-2.0], upper: vec![0.0] };
    assert_close(&least(&saddle, &[0.0], &bounds).theta, &[-0.875_f64.sqrt()], 1e-9);
}

/// Its differences are taken over steps that suit the parameter, whatever its scale, and inwards at a bound.
#[test]
fn the_curvature_has_no_scale() {
    for scale in [1e-3, 1.0, 1e3] {
        // The saddle of the test above in x = scale p, at its minimum.
        let saddle = model(2, 1, |p, i| {
            let x = scale * p[0];
            Some(if i == 0 { (x, vec![scale]) } else { (2.0 * (1.0 - x * x), vec![-4.0 * x * scale]) })
        });
        let minimum = free(&saddle, &[0.8 / scale]);
        assert_close(&[minimum.certificate.least_curvature.unwrap()], &[14.0 / 15.0], 1e-4);
        // x^2 + (1 + x^2)^2 at 0: half its second derivative is 3, and the square of the column is 1.
        let valley = model(2, 1, |p, i| {
            let x = scale * p[0];
            Some(if i == 0 { (x, vec![scale]) } else { (1.0 + x * x, vec![2.0 * x * scale]) })
        });
        for [lower, upper] in [[-1.0, 1.0], [0.0, 1.0], [-1.0, 0.0]] {
            let bounds = Bounds { lower: vec![lower / scale], upper: vec![upper / scale] };
            let minimum = least(&valley, &[0.0], &bounds);
            assert_close(&[minimum.certificate.least_curvature.unwrap()], &[3.0], 1e-4);
        }
    }
}

#[test]
fn ends_that_are_no_minima_are_not_called_converged() {
    let backwards = model(3, 1, |p, i| Some((p[0] - i as f64, vec![-1.0])));
    let end = free(&backwards, &[5.0]);
    assert_eq!((end.certificate.reason, end.certificate.converged), (Reason::Stagnated, false));
    assert!(end.certificate.gradient_cosine > 0.9);
    let options = Options { max_evaluations: 4, ..Options::default() };
    let end = minimise(&rosenbrock(), &[-1.2, 1.0], &Bounds::none(2), &options).unwrap();
    assert_eq!((end.certificate.reason, end.certificate.converged), (Reason::Budget, false));
    assert!(end.cost < 24.2 && end.evaluations + end.linearisations <= 5);
    // A jump: the derivative promises a decrease that ends at x = 1.
    let cliff = model(1, 1, |p, _| Some((if p[0] < 1.0 { 9.0 } else { p[0] }, vec![1.0])));
    assert_eq!(free(&cliff, &[1.0]).certificate.reason, Reason::Stagnated);
}

#[test]
fn a_kink_is_the_end_where_shorter_steps_are_not_worth_it() {
    // (2 + |x - 1|, 0.1 x): the minimum is at the kink x = 1, where the derivatives on both sides promise a
    // decrease.
    let kinked = model(2, 1, |p, i| {
        let side = if p[0] < 1.0 { -1.0 } else { 1.0 };
        Some(if i == 0 { (2.0 + side * (p[0] - 1.0), vec![side]) } else { (0.1 * p[0], vec![0.1]) })
    });
    let search = |least_decrease| {
        let options = Options { least_decrease, check_curvature: false, ..Options::default() };
        minimise(&kinked, &[-5.0], &Bounds::none(1), &options).unwrap()
    };
    let (found, exact) = (search(1e-3), search(0.0));
    let reasons = [found.certificate.reason, exact.certificate.reason];
    assert_eq!((reasons, found.certificate.converged), ([Reason::Kink, Reason::Stagnated], false));
    // The cost has the slope 4 on either side.
    assert!(found.cost - 4.01 < 1e-3 && (exact.theta[0] - 1.0).abs() < 1e-12, "{found:?}");
    let work = |end: &Minimum| end.evaluations + end.linearisations;
    assert!(2 * work(&found) < work(&exact), "{} {}", work(&found), work(&exact));
    // A smooth minimum isn't a kink, and is found as well.
    let options = Options { least_decrease: 1e-3, ..Options::default() };
    let smooth = minimise(&rosenbrock(), &[-1.2, 1.0], &Bounds::none(2), &options).unwrap();
    assert!(smooth.certificate.converged && (smooth.theta[0] - 1.0).abs() < 1e-9);
    for wrong in [-1.0, f64::NAN, f64::INFINITY] {
        let options = Options { least_decrease: wrong, ..Options::default() };
        assert!(minimise(&rosenbrock(), &[-1.2, 1.0], &Bounds::none(2), &options).is_err());
    }
}

#[test]
fn trial_points_without_value_shorten_the_step() {
    // (ln x - ln 1e-3) from x = 2: the Gauss-Newton step goes far below 0.
    for failing in [true, false] {
        let problem = model(1, 1, move |p, _| {
            if failing && p[0] <= 0.0 {
                return None;
            }
            Some((p[0].ln() - 1e-3_f64.ln(), vec![1.0 / p[0]]))
        });
        let minimum = free(&problem, &[2.0]);
        assert!(minimum.certificate.converged);
        assert_close(&minimum.theta, &[1e-3], 1e-12);
    }
    // Beyond 4.5 the residual, or only its derivative, has no value. The derivative is too small, so that the first step goes to 4.67.
    for (fails, work) in [(true, [4, 5, 6]), (false, [4, 5, 7])] {
        let problem = model(1, 1, move |p, _| {
            let beyond = p[0] > 4.5;
            (!(beyond && fails)).then(|| (p[0] - 4.0, vec![if beyond { f64::NAN } else { 0.6 }]))
        });
        let end = minimise(&problem, &[3.0], &Bounds::none(1), &Options::default()).unwrap();
        assert!((end.theta[0] - 4.0).abs() < 1e-9, "{end:?}");
        assert_eq!([end.iterations, end.evaluations, end.linearisations], work);
    }
}

#[test]
fn zero_residuals_converge_to_rounding() {
    // Exact data of a sum of two decays.
    let problem = model(30, 4, |p, i| {
        let (e, f) = ((-p[1] * time(i)).exp(), (-p[3] * time(i)).exp());
        let data = 2.0 * (-0.3 * time(i)).exp() + 5.0 * (-1.7 * time(i)).exp();
        Some((p[0] * e + p[2] * f - data, vec![e, -p[0] * time(i) * e, f, -p[2] * time(i) * f]))
    });
    let minimum = free(&problem, &[1.0, 0.1, 1.0, 1.0]);
    assert!(minimum.certificate.converged, "{minimum:?}");
    assert_close(&minimum.theta, &[2.0, 0.3, 5.0, 1.7], 1e-12);
}

#[test]
fn unusable_calls_say_what_is_wrong() {
    let problem = rosenbrock();
    let text = |start: &[f64], bounds: &Bounds, options: &Options| {
        minimise(&problem, start, bounds, options).unwrap_err().to_string()
    };
    let (none, usual) = (Bounds::none(2), Options::default());
    let bounds = Bounds { lower: vec![0.0, 2.0], upper: vec![1.0, 3.0] };
    assert_eq!(
        text(&[0.5, 4.0], &bounds, &usual),
        "the start of parameter 1 is 4, outside its bounds [2, 3]"
    );
    assert_eq!(text(&[0.5], &bounds, &usual), "the start has 1 entries; the problem has 2 parameters");
    let crossed = Bounds { lower: vec![0.0, 2.0], upper: vec![1.0, f64::NAN] };
    assert!(text(&[0.5, 2.0], &crossed, &usual).starts_with("the bounds of parameter 1 are [2, NaN]"));
    assert!(text(&[f64::NAN, 2.0], &none, &usual).contains("parameter 0 is NaN"));
    let options = Options { tolerance: 0.0, ..usual };
    assert_eq!(
        text(&[0.5, 2.0], &none, &options),
        "the option tolerance is 0; it must be above 0 and below 1"
    );
    let options = Options { tolerance: 1.0, ..usual };
    assert!(text(&[0.5, 2.0], &none, &options).starts_with("the option tolerance is 1;"));
    assert!(text(&[1e200, 2.0], &none, &usual).contains("residual 0 is -inf"));
    assert!(text(&[1e80, 2.0], &none, &usual).contains("overflows"));
    let undefined = model(1, 1, |_, _| None);
    let error = minimise(&undefined, &[1.0], &Bounds::none(1), &usual).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the residuals cannot be evaluated at the start: no value in row 0 at [1.0]"
    );
    let infinite = model(2, 1, |_, i| Some((1.0, vec![1.0 / (1.0 - i as f64)])));
    let error = minimise(&infinite, &[1.0], &Bounds::none(1), &usual).unwrap_err();
    assert!(error.to_string().starts_with("the derivative of residual 1 by parameter 0 is inf"), "{error}");
}

/// Where a search had to end, its certificate says how far it still was: r = (10 x - 30, 15) at x = 1.
#[test]
fn a_certificate_measures_what_was_left() {
    let line =
        model(2, 1, |p, i| Some(if i == 0 { (10.0 * p[0] - 30.0, vec![10.0]) } else { (15.0, vec![0.0]) }));
    let options = Options { max_evaluations: 1, ..Options::default() };
    let end = minimise(&line, &[1.0], &Bounds::none(1), &options).unwrap();
    let found = [
        end.cost,
        end.certificate.relative_decrease,
        end.certificate.gradient_cosine,
        end.certificate.relative_step,
    ];
    // 400 of 625; 200 by 10 times 25; a step of 2 from 1.
    assert_eq!(end.certificate.reason, Reason::Budget);
    assert_close(&found, &[625.0, 0.64, 0.8, 2.0], 1e-14);
}
