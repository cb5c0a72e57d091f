//! Two independent ways to one equilibrium: `linearised` takes the meridian by quadrature, `follow`
//! integrates the ODE.

#![expect(clippy::unwrap_used, reason = "a test that cannot be set up fails")]

use bulge_fibre::{Approach, FibreError, Given, MOST_STRAIN, Problem};
use bulge_muscles::{Muscle, Parameter, Pressure, Quantity, preset};

fn braid(length_mm: f64, angle_deg: f64) -> Muscle {
    let file = format!(
        "name = \"b\"\nkind = \"braided\"\nlength = \"{length_mm} mm\"\nradius = \"10 mm\"\nwall = \"1.8 mm\"\n\
         braid_angle = \"{angle_deg} deg\"\nfibres = 120\nends = \"clamped\"\n"
    );
    bulge_muscles::from_toml(&file, "braid").unwrap()
}

fn with(muscle: &Muscle, numbers: &[(Parameter, f64)]) -> Muscle {
    numbers.iter().fold(muscle.clone(), |muscle, (parameter, value)| muscle.with(*parameter, *value).unwrap())
}

#[test]
fn both_ways_give_the_same_equilibrium() {
    let bladder = [(Parameter::C10, 3e5), (Parameter::C01, 5e4)];
    let pleated = preset("ppam-2-r16").unwrap();
    let muscles = [
        braid(300.0, 28.6),
        braid(1000.0, 45.0),
        with(&braid(300.0, 28.6), &bladder),
        with(&braid(40.0, 20.0), &bladder),
        with(
            &braid(200.0, 25.0),
            &[bladder[0], (Parameter::FittingRadius, 0.0085), (Parameter::GasWall, 1e-3)],
        ),
        with(&pleated, &[(Parameter::Misalignment, 0.1)]),
        cloth(&pleated, 8e4, 0.035),
        with(&braid(300.0, 28.6), &[(Parameter::FibreStiffness, 5e3)]),
        with(&braid(300.0, 28.6), &[bladder[0], bladder[1], (Parameter::FibreStiffness, 5e3)]),
        with(&braid(40.0, 20.0), &[bladder[0], (Parameter::FibreStiffness, 500.0)]),
        with(&pleated, &[(Parameter::FibreStiffness, 12e3)]),
        with(&cloth(&pleated, 8e4, 0.035), &[(Parameter::FibreStiffness, 12e3)]),
        with(&cloth(&braid(300.0, 28.6), 3e4, 0.0115), &[bladder[0], (Parameter::FibreStiffness, 5e3)]),
    ];
    let mut tried = 0;
    for muscle in &muscles {
        for bar in [1.0, 3.0, 6.0] {
            let problem = Problem::new(muscle, Pressure::bar(bar)).unwrap();
            for contraction in [-0.02, 0.0, 1e-6, 0.01, 0.05, 0.1, 0.2, 0.3] {
                let Ok(ode) = problem.follow(contraction, Approach::Shooting) else { continue };
                let found =
                    problem.linearised(contraction, &problem.parts().still(), Approach::Shooting).unwrap();
                let scale = 1e5 * bar * 1e-4;
                for (name, a, b, size) in [
                    ("force", ode.force_n, found.force_n.value, scale),
                    ("volume", ode.volume_polygon_m3, found.volume_polygon_m3.value, 0.0),
                    ("radius", ode.mid_radius_m, found.mid_radius_m.value, 0.0),
                ] {
                    let error = (a - b).abs() / (a.abs() + size);
                    // A muscle held far beyond its limit pushes with fibres that are nearly slack; the
                    // integration of the ODE loses digits there.
                    let most = if ode.force_n >= 0.0 { 3e-10 } else { 2e-7 };
                    assert!(error < most, "{name} {bar} bar {contraction} {a} {b} {error:e}: {muscle:?}");
                }
                tried += 1;
            }
        }
    }
    assert!(tried > 200, "{tried}");
}

fn cloth(muscle: &Muscle, stiffness: f64, radius: f64) -> Muscle {
    let limit = [(Parameter::HoopStiffness, stiffness), (Parameter::UnfoldedRadius, radius)];
    muscle.with_all(&limit).unwrap()
}

/// Equilibria that are hard to find: cloth 10^5 times stiffer than p R, fittings on which the fibres nearly
/// lie along the circumference, a long braid whose middle is a cylinder, a waist. They satisfy F = -p dV/dl,
/// or dF/dp = -dV/dl with stored energy, and their derivatives agree with differences.
#[test]
fn hard_equilibria_obey_virtual_work() {
    let pleated = preset("ppam-2-r16").unwrap();
    let wide = with(&braid(120.0, 40.0), &[(Parameter::FittingRadius, 0.01533)]);
    let cases = [
        (cloth(&pleated, 2e8, 0.03), vec![0.02, 0.08], true),
        (cloth(&pleated, 1e6, 0.017), vec![0.001, 0.0025], true),
        (wide, vec![0.0, 0.1, 0.2], false),
        (braid(1000.0, 50.0), vec![0.05], false),
        (with(&braid(200.0, 30.0), &[(Parameter::FittingRadius, 0.004)]), vec![0.0, 0.1], false),
    ];
    let pressure = Pressure::bar(2.0);
    for (muscle, contractions, stores) in &cases {
        let problem = Problem::new(muscle, pressure).unwrap();
        for contraction in contractions {
            let found = problem.follow(*contraction, Approach::Auto).unwrap();
            let step = if *contraction > 0.0 { 1e-3 * contraction } else { 1e-5_f64 };
            let beside = |sign: f64| problem.follow(contraction + sign * step, Approach::Auto).unwrap();
            let (up, down) = (beside(1.0), beside(-1.0));
            let (l0, p) = (muscle.length().si(), pressure.si());
            let slope = (up.volume_polygon_m3 - down.volume_polygon_m3) / (2.0 * step * l0);
            let gradient = problem.gradient(*contraction, Approach::Auto).unwrap();
            let by_contraction = (up.force_n - down.force_n) / (2.0 * step);
            let scale = found.force_n.abs() + p * found.max_radius_m.powi(2);
            let case = format!("{contraction}: {muscle:?}");
            assert!(
                (gradient.by_contraction[0] - by_contraction).abs() < 1e-5 * by_contraction.abs(),
                "{case}"
            );
            if *stores {
                let [by_pressure, _] = gradient.by_pressure;
                assert!((by_pressure - slope).abs() < 1e-5 * slope.abs(), "{by_pressure} {slope} {case}");
            } else {
                assert!(
                    (found.force_n - p * slope).abs() < 1e-5 * scale,
                    "{} {} {case}",
                    found.force_n,
                    p * slope
                );
            }
        }
    }
}

/// The cost of a cold search, with the approach that everything takes by itself and with one that the ODE checks:
/// evaluations of the quadratures' integrands and of the ODE's right-hand side, the same on every machine. A
/// count below its range is a gain: these numbers and those of `docs/speed.md` must then be brought up to date.
#[test]
fn evaluations_stay_few() {
    let pleated = preset("ppam-2-r16").unwrap();
    let elastic = with(&pleated, &[(Parameter::FibreStiffness, 12e3)]);
    let rubber = |muscle: &Muscle| {
        muscle.with_all(&[(Parameter::Wall, 0.0015), (Parameter::C10, 2e5), (Parameter::C01, 5e4)])
    };
    let long = braid(250.0, 25.0);
    for (name, muscle, bar, counts) in [
        (
            "pleated",
            &pleated,
            1.0,
            &[
                (1e-6, [2, 99]),
                (0.05, [2, 207]),
                (0.1, [2, 240]),
                (0.2, [2, 276]),
                (0.3, [2, 288]),
                (0.4, [2, 312]),
            ][..],
        ),
        ("pleated, elastic", &elastic, 1.0, &[(0.0, [4, 228]), (0.1, [3, 288]), (0.3, [2, 354])]),
        (
            "braid, l0/r0 = 3",
            &braid(30.0, 25.0),
            3.0,
            &[(0.02, [63, 195]), (0.1, [84, 264]), (0.2, [84, 300])],
        ),
        (
            "braid, l0/r0 = 25",
            &long,
            3.0,
            &[(0.02, [126, 486]), (0.1, [168, 624]), (0.2, [126, 702]), (0.3, [189, 909])],
        ),
        (
            "braid, l0/r0 = 100",
            &braid(1000.0, 25.0),
            3.0,
            &[(0.1, [252, 1788]), (0.2, [252, 2268]), (0.3, [336, 2472])],
        ),
        (
            "braid with bladder",
            &rubber(&long).unwrap(),
            3.0,
            &[(0.02, [210, 642]), (0.1, [168, 720]), (0.2, [231, 903])],
        ),
        (
            "elastic braid with bladder",
            &with(&rubber(&long).unwrap(), &[(Parameter::FibreStiffness, 5e3)]),
            3.0,
            &[(0.02, [340, 772]), (0.1, [272, 824]), (0.2, [335, 1007])],
        ),
        (
            "elastic braid with cloth",
            &with(&cloth(&long, 8e3, 0.0115), &[(Parameter::FibreStiffness, 5e3)]),
            3.0,
            &[(0.02, [272, 620]), (0.1, [574, 1342])],
        ),
    ] {
        let problem = Problem::new(muscle, Pressure::bar(bar)).unwrap();
        for (contraction, expected) in counts {
            for (approach, expected) in [Approach::Auto, Approach::Shooting].into_iter().zip(*expected) {
                let count = problem.follow(*contraction, approach).unwrap().convergence.evaluations;
                // Rounding of another machine's logarithms may shift a step.
                let is_near = (f64::from(count) / f64::from(expected) - 1.0).abs() < 0.05;
                assert!(
                    is_near,
                    "{name}, {contraction}, {approach:?}: {count} evaluations, {expected} expected"
                );
            }
        }
    }
}

/// Equilibria that are found on a path: braids on narrow fittings whose stiff cloth comes taut within a part
/// of 10^4 of the contraction, a long one whose gas acts far inside, and rubber on wide fittings, which
/// leaves little to contract. They satisfy F = -p dV/dl, or dF/dp = -dV/dl with stored energy.
#[test]
fn paths_lead_where_no_start_does() {
    let narrow = cloth(&with(&braid(150.0, 40.0), &[(Parameter::FittingRadius, 0.004)]), 3e5, 0.0042);
    let inside = with(&braid(947.3, 12.078), &[(Parameter::GasWall, 2.2055e-3)]);
    let problem = Problem::new(&narrow, Pressure::bar(1.0)).unwrap();
    let limit = problem.contraction_limit(Approach::Auto).unwrap();
    let force = |pressure: f64, contraction: f64| {
        let problem = Problem::new(&narrow, Pressure::bar(pressure)).unwrap();
        problem.follow(contraction, Approach::Auto).unwrap()
    };
    let middle = limit - 2e-3;
    let by_pressure = (force(1.001, middle).force_n - force(0.999, middle).force_n) / 200.0;
    let [up, down] = [1e-6, -1e-6].map(|step| force(1.0, middle + step).volume_polygon_m3);
    let by_length = (up - down) / (2e-6 * narrow.length().si());
    assert!((by_pressure / by_length - 1.0).abs() < 1e-4, "{by_pressure} {by_length}");
    let held = problem.solve(Given::Force(0.5 * force(1.0, middle).force_n), Approach::Auto).unwrap();
    assert!(held.contraction > middle && held.contraction < limit, "{}", held.contraction);
    let beyond = problem.solve(Given::Contraction(0.1), Approach::Auto).unwrap_err();
    assert!(matches!(beyond, FibreError::BeyondLimit { .. }), "{beyond}");

    let problem = Problem::new(&inside, Pressure::bar(1.0)).unwrap();
    let at = |contraction: f64| problem.solve(Given::Contraction(contraction), Approach::Auto).unwrap();
    let slope = (at(0.01356 + 1e-5).volume_polygon_m3 - at(0.01356 - 1e-5).volume_polygon_m3)
        / (2e-5 * inside.length().si());
    assert!((at(0.01356).force_n / (1e5 * slope) - 1.0).abs() < 1e-5, "{slope}");
}

/// Elastic fibres are not drawn out farther than any fibre bears. The answer is status 3 with the largest
/// force, the same for every approach.
#[test]
fn fibres_are_not_drawn_out_beyond_what_they_bear() {
    let stiffness = [(Parameter::FibreStiffness, 5e3)];
    for muscle in [with(&braid(300.0, 28.6), &stiffness), with(&preset("ppam-2-r16").unwrap(), &stiffness)] {
        let problem = Problem::new(&muscle, Pressure::bar(2.0)).unwrap();
        let all = 5e3 * f64::from(muscle.fibres().unwrap());
        let error = problem.solve(Given::Force(1e7), Approach::Auto).unwrap_err();
        let FibreError::ForceTooLarge { high_n, contraction, .. } = error else { panic!("{error}") };
        // T = EA times the strain; the force is that of the fibres, nearly along the axis.
        assert!(high_n > 0.8 * MOST_STRAIN * all && high_n < 1.01 * MOST_STRAIN * all, "{high_n} of {all}");
        assert!(contraction > -0.6 && contraction < -0.2, "{contraction}");
        assert!(problem.solve(Given::Force(0.99 * high_n), Approach::Auto).is_ok());
        let error = problem.solve(Given::Contraction(-3.0), Approach::Auto).unwrap_err();
        assert!(matches!(error, FibreError::Overstretched { .. }), "{error}");
    }
    // Inextensible fibres that are all but straight.
    let problem = Problem::new(&preset("dmsp-20-250").unwrap(), Pressure::bar(2.0)).unwrap();
    let error = problem.solve(Given::Force(1e6), Approach::Auto).unwrap_err();
    assert!(matches!(error, FibreError::ForceTooLarge { .. }), "{error}");
}
