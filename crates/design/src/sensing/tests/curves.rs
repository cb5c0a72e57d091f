//! Curves over a range: inverse, slopes, linearity.

use super::*;

#[test]
fn the_inverse_gives_the_contraction_back() {
    let winding =
        Winding { offset_m: 0.5e-3, layer: Layer::Thinning, section_m2: 0.05e-6, ..zone(0.3, 0.7, 20.0) };
    for muscle in [ppam(), braid()] {
        let sensor = sensor(&muscle, winding);
        let range = Range { from: 0.05, to: 0.25, points: 21 };
        let curve = sensor.curve(range).unwrap();
        for contraction in [0.05, 0.050_001, 0.1, 0.123_456, 0.2, 0.249_999, 0.25] {
            let asked = sensor.reading(contraction).unwrap().resistance_ohm;
            let found = sensor.contraction(&curve, asked).unwrap();
            assert!((found - contraction).abs() < 1e-9, "{contraction}: {found}");
        }
        // The noise of a reading, propagated through the inverse.
        let noise = 1e-5 * sensor.reference_resistance_ohm();
        let resolution = curve.resolution(noise).unwrap();
        let here = &curve.readings[10];
        let [up, down] =
            [noise, -noise].map(|n| sensor.contraction(&curve, here.resistance_ohm + n).unwrap());
        close(resolution.contraction[10], 0.5 * (up - down), 1e-5);
        close(resolution.worst_m, resolution.worst * muscle.muscle().length().si(), 1e-15);
        assert!(resolution.contraction.iter().all(|size| *size <= resolution.worst));
        // Outside the curve, and on the curve of another sensor.
        for outside in [2.0 * curve.readings[20].resistance_ohm, f64::NAN] {
            assert_refused(sensor.contraction(&curve, outside), "lies outside those of the curve");
        }
        let other = sensor.rewound(Winding { turns: 19.0, ..winding }).unwrap();
        assert_refused(other.contraction(&curve, here.resistance_ohm), "not one of this winding");
        let other = sensor.at_pressure(bar(1.0)).unwrap();
        assert_refused(other.contraction(&curve, here.resistance_ohm), "not one of this winding");
    }
}

#[test]
fn a_curve_that_turns_has_no_inverse() {
    // On a cylinder lambda^2 ~ c^2 (r + t)^2 + 1 - q^2 r^2 with c = theta' and q = sin(alpha0)/r0: its
    // maximum is at r = c^2 t/(q^2 - c^2). For a layer of constant 2 mm, c^2 = q^2 12/14 puts it at r = 12
    // mm.
    let alpha = 25f64.to_radians();
    let fibre = 0.2 / alpha.cos();
    let turns = (12.0f64 / 14.0).sqrt() * alpha.sin() / 0.01 * fibre / TAU;
    let sensor = sensor(&cylinder(), Winding { offset_m: 2e-3, ..zone(0.0, 1.0, turns) });
    let range = Range { from: 0.0, to: 0.06, points: 41 };
    let curve = sensor.curve(range).unwrap();
    let Err(SensingError::NotMonotone { between }) = curve.check_monotone() else { panic!("it must turn") };
    let turn = 1.0 - (1.0 - (1.2 * alpha.sin()).powi(2)).sqrt() / alpha.cos();
    assert!((0.5 * (between[0] + between[1]) - turn).abs() < 1.5 * 0.0015, "{between:?} {turn}");
    let [before, here, after] = [-1e-3, 0.0, 1e-3].map(|step| {
        let [up, down] = [1e-4, -1e-4].map(|h| sensor.reading(turn + step + h).unwrap().relative_change);
        (up - down) / 2e-4
    });
    assert!(before > 0.0 && after < 0.0 && here.abs() < 1e-4 * before, "{before:e} {here:e} {after:e}");
    assert!(sensor.contraction(&curve, curve.readings[3].resistance_ohm).is_err());
    assert!(curve.resolution(1e-6).is_err());
    // Nor is it an acceptable zone.
    let search = Search { range, widths: [1.0; 2], width_steps: 1, centres: 3, goal: Goal::MostSensitive };
    let Err(SensingError::NoPlace { scanned, largest, .. }) = sensor.best_place(&search) else {
        panic!("no place")
    };
    assert_eq!((scanned, largest.to_bits()), (1, 0));
}

#[test]
fn slopes_and_lines_are_those_of_known_curves() {
    let winding = Winding { offset_m: 0.5e-3, section_m2: 0.05e-6, ..zone(0.3, 0.7, 20.0) };
    let sensor = sensor(&ppam(), winding);
    let curve = sensor.curve(Range { from: 0.05, to: 0.3, points: 51 }).unwrap();
    for i in [0, 1, 25, 50] {
        let e = curve.readings[i].contraction;
        let change = |h: f64| sensor.reading(e + h).unwrap().relative_change;
        let slope = |h: f64| (change(h) - change(-h)) / (2.0 * h);
        let exact = (4.0 * slope(5e-4) - slope(1e-3)) / 3.0;
        close(curve.sensitivity[i], exact, if i < 2 { 3e-5 } else { 1e-6 });
    }
    // R = 3 + 2 e^2: the best line equals it where e^2 about the middle equals its mean, (n + 1)/(12 (n -
    // 1)).
    let n = 101;
    let e: Vec<f64> = (0..n).map(|i| f64::from(i) / 100.0).collect();
    let r: Vec<f64> = e.iter().map(|e| 3.0 + 2.0 * e * e).collect();
    let line = Linearity::of(&e, &r, 4.0).unwrap();
    let variance = 102.0 / 1200.0;
    close(line.slope_ohm, 2.0, 1e-12);
    close(line.mean_sensitivity, 0.5, 1e-12);
    close(line.intercept_ohm, 3.0 + 2.0 * (variance - 0.25), 1e-12);
    close(line.full_scale_ohm, 2.0, 1e-15);
    close(line.best_fit_percent, 100.0 * (0.25 - variance), 1e-11);
    close(line.terminal_percent, 25.0, 1e-12);
    assert!((line.terminal_at - 0.5).abs() < 1e-12 && (line.best_fit_at - 0.5).abs() > 0.49);
    for (e, r) in [
        (&e[..1], &r[..1]),
        (&e[..3], &[1.0; 3][..]),
        (&[0.1; 3][..], &r[..3]),
        (&e[..2], &[1.0, f64::NAN][..]),
    ] {
        assert_eq!(Linearity::of(e, r, 1.0), None);
    }
}

#[test]
fn the_linearity_of_the_second_generation_ppam() {
    let curve =
        sensor(&ppam(), layer(0.3, 0.7, 20.0)).curve(Range { from: 0.05, to: 0.3, points: 51 }).unwrap();
    let line = curve.linearity.unwrap();
    println!(
        "ppam-2-r16, 20 turns on the middle 40 %, from 5 to 30 %: {:.4} % (best fit), {:.4} % (terminal) of full scale, gauge factor {:.4} \
         ({:.3} to {:.3}), R0 {:.4} ohm, full scale {:.3} ohm, strain at 30 % {:.4}",
        line.best_fit_percent,
        line.terminal_percent,
        line.mean_sensitivity,
        curve.sensitivity[0],
        curve.sensitivity[50],
        curve.reference_resistance_ohm,
        line.full_scale_ohm,
        curve.readings[50].largest_strain
    );
    assert!(line.best_fit_percent > 7.00 && line.best_fit_percent < 7.04);
    assert!(line.terminal_percent > 9.33 && line.terminal_percent < 9.38);
    assert!(line.mean_sensitivity > 19.55 && line.mean_sensitivity < 19.61);
    assert!(curve.reference_resistance_ohm > 12.19 && curve.reference_resistance_ohm < 12.20);
    // The curve is concave: it is steepest at the smallest contraction.
    assert!(curve.sensitivity.windows(2).all(|pair| pair[1] < pair[0]));
    // 1 mohm is worst at 30 %: 1e-3/(13.646 * 12.195) of 110 mm.
    let resolution = curve.resolution(1e-3).unwrap();
    assert!((resolution.worst_at - 0.3).abs() < 1e-12);
    assert!(resolution.worst_m > 0.658e-6 && resolution.worst_m < 0.664e-6, "{}", resolution.worst_m);
}
