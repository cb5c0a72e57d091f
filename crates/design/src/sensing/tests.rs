//! Windings: closed forms on cylinders and rings, polylines in space, order of convergence, inverse, linearity and places.

use super::*;
use bulge_effects::{Catalogue, known};
use bulge_fibre::{Approach, Given, Problem};
use bulge_model::Extended;
use bulge_muscles::{Muscle, Pressure, Quantity as _, from_toml, preset};
use std::f64::consts::TAU;

fn bar(value: f64) -> Pressure {
    Pressure::bar(value)
}

fn muscle(text: &str) -> Muscle {
    from_toml(text, "m.toml").unwrap()
}

fn alone(muscle: &Muscle) -> Extended {
    Extended::new(muscle, &[]).unwrap()
}

fn ppam() -> Extended {
    alone(&preset("ppam-2-r16").unwrap())
}

fn braid() -> Extended {
    alone(&muscle(
        "name = \"b\"\nkind = \"braided\"\nlength = \"80 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\n",
    ))
}

fn cylinder() -> Extended {
    alone(&muscle(
        "name = \"c\"\nkind = \"braided\"\nlength = \"200 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\nends = \"cylinder\"\n",
    ))
}

/// A thin channel with its centre on the fibres.
fn zone(start: f64, end: f64, turns: f64) -> Winding {
    Winding {
        start,
        end,
        turns,
        section_m2: 1e-14,
        offset_m: 0.0,
        layer: Layer::Kept,
        resistivity_ohm_m: EGAIN_RESISTIVITY_OHM_M,
    }
}

fn sensor_with(muscle: &Extended, winding: Winding, options: Options) -> Sensor {
    Sensor::new(muscle, bar(2.0), winding, Reference::Rest, options).unwrap()
}

fn sensor(muscle: &Extended, winding: Winding) -> Sensor {
    sensor_with(muscle, winding, Options::default())
}

#[track_caller]
fn close(found: f64, expected: f64, relative: f64) {
    let off = (found / expected - 1.0).abs();
    assert!(off <= relative, "{found} is not {expected}: off by {off:e}");
}

#[test]
fn a_helix_on_a_cylinder_has_its_closed_form() {
    let (l0, r0, alpha) = (0.2, 0.01, 25f64.to_radians());
    for (layer, offset) in [(Layer::Kept, 0.0), (Layer::Kept, 1.5e-3), (Layer::Thinning, 1.5e-3)] {
        let winding = Winding { offset_m: offset, layer, section_m2: 0.2e-6, ..zone(0.2, 0.7, 12.5) };
        let sensor = sensor(&cylinder(), winding);
        let helix = |rho: f64, axial: f64| (TAU * 12.5 * rho).hypot(axial);
        let length_0 = helix(r0 + offset, 0.5 * l0);
        close(sensor.reference_length_m(), length_0, 1e-14);
        close(sensor.reference_resistance_ohm(), 29.4e-8 * length_0 / 0.2e-6, 1e-14);
        for contraction in [-0.02, 0.0, 0.1, 0.25] {
            let sigma = alpha.cos() * (1.0 - contraction);
            let r = r0 / alpha.sin() * (1.0 - sigma * sigma).sqrt();
            // The layer keeps its volume: ((r + t)^2 - r^2) l = the same at rest.
            let t = match layer {
                Layer::Kept => offset,
                Layer::Thinning => {
                    (r * r + ((r0 + offset).powi(2) - r0 * r0) / (1.0 - contraction)).sqrt() - r
                }
            };
            let length = helix(r + t, 0.5 * l0 * (1.0 - contraction));
            let reading = sensor.reading(contraction).unwrap();
            close(reading.channel_length_m, length, 1e-12);
            let stretch = length / length_0;
            close(reading.resistance_ohm, sensor.reference_resistance_ohm() * stretch * stretch, 1e-12);
            // The stretch is uniform.
            close(reading.resistance_ohm, reading.uniform_resistance_ohm, 1e-12);
            close(1.0 + reading.largest_strain, stretch, 1e-12);
            close(1.0 + reading.smallest_strain, stretch, 1e-12);
            close(reading.smallest_section_m2, 0.2e-6 / stretch, 1e-12);
            close(reading.muscle_length_m, l0 * (1.0 - contraction), 1e-14);
        }
    }
}

#[test]
fn along_the_meridian_the_stretch_is_that_of_the_net() {
    // Pleated and inextensible: nothing changes; the whole muscle, 1 mm^2 of eGaIn: 0.294 ohm/m.
    let along = Winding { section_m2: 1e-6, ..zone(0.0, 1.0, 0.0) };
    let straight = sensor(&ppam(), along);
    close(straight.reference_resistance_ohm(), 0.294 * 0.11, 1e-12);
    for contraction in [0.02, 0.1, 0.3] {
        assert!(straight.reading(contraction).unwrap().relative_change.abs() < 1e-12);
    }
    let curve = straight.curve(Range { from: 0.05, to: 0.3, points: 21 }).unwrap();
    assert_eq!((curve.linearity, curve.check_monotone()), (None, Err(SensingError::NoChange)));
    assert!(curve.resolution(1e-6).is_err());
    // Pleated with fibres that stretch: (1 + e)^2.
    let elastic = muscle(
        "name = \"e\"\nkind = \"pleated\"\nlength = \"110 mm\"\nradius = \"16 mm\"\nfibres = 40\nfibre = { stiffness = \"2 kN\" }\n",
    );
    let problem = Problem::new(&elastic, bar(2.0)).unwrap();
    let strain = problem.solve(Given::Contraction(0.1), Approach::Auto).unwrap().fibre_strain;
    assert!(strain > 0.005);
    let found = sensor(&alone(&elastic), along).reading(0.1).unwrap();
    close(1.0 + found.relative_change, (1.0 + strain).powi(2), 1e-11);
    // Braided: (cos(alpha)/cos(alpha0))^2, and for the cylinder that is (1 - contraction)^2; the resistance falls and tells the contraction.
    let found = sensor(&cylinder(), along).reading(0.2).unwrap();
    close(1.0 + found.relative_change, 0.64, 1e-12);
    let falling = sensor(&braid(), along);
    let curve = falling.curve(Range { from: 0.0, to: 0.2, points: 21 }).unwrap();
    assert!(curve.sensitivity.iter().all(|slope| *slope < -1.0));
    let asked = falling.reading(0.1234).unwrap().resistance_ohm;
    assert!((falling.contraction(&curve, asked).unwrap() - 0.1234).abs() < 1e-9);
}

#[test]
fn a_ring_at_mid_length_measures_the_largest_radius() {
    let muscle = ppam();
    let ring = zone(0.5 - 5e-5, 0.5 + 5e-5, 1.0);
    let problem = Problem::new(muscle.muscle(), bar(2.0)).unwrap();
    let radius = |e: f64| problem.solve(Given::Contraction(e), Approach::Auto).unwrap().max_radius_m;
    let sensor = sensor(&muscle, ring);
    let reference = Reference::At { pressure: bar(1.0), contraction: 0.05 };
    let from_5 = Sensor::new(&muscle, bar(2.0), ring, reference, Options::default()).unwrap();
    for contraction in [0.05, 0.15, 0.3] {
        let r = radius(contraction);
        close(1.0 + sensor.reading(contraction).unwrap().relative_change, (r / 0.016).powi(2), 1e-7);
        let found = from_5.reading(contraction).unwrap();
        close(1.0 + found.relative_change, (r / radius(0.05)).powi(2), 1e-7);
    }
    // At the reference itself nothing has changed, along the whole muscle.
    let whole =
        from_5.rewound(Winding { offset_m: 1e-3, layer: Layer::Thinning, ..zone(0.0, 1.0, 9.0) }).unwrap();
    let found = whole.reading(0.05).unwrap();
    assert!(found.relative_change.abs() < 1e-10 && found.largest_strain.abs() < 1e-9, "{found:?}");
}

/// Length, resistance and liquid of a polyline in space, extrapolated to no spacing; the reference gives the unstretched lengths.
fn polyline(sensor: &Sensor, contraction: f64) -> [f64; 3] {
    let sums = |count: usize| {
        let [now, then] =
            [sensor.channel(contraction, count), sensor.reference_channel(count)].map(Result::unwrap);
        let chord = |points: &[ChannelPoint]| {
            let [a, b] = [&points[0], &points[1]]
                .map(|p| [p.x_m, p.radius_m * p.angle_rad.cos(), p.radius_m * p.angle_rad.sin()]);
            a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
        };
        let mut sums = [0.0; 3];
        for (now, then) in now.windows(2).zip(then.windows(2)) {
            let [dl, dl_0] = [chord(now), chord(then)];
            let section = 0.5 * (now[0].section_m2 + now[1].section_m2);
            let resistivity = sensor.winding().resistivity_ohm_m;
            let terms = [dl, resistivity * dl * dl / (sensor.winding().section_m2 * dl_0), section * dl];
            sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
        }
        sums
    };
    let [coarse, fine] = [sums(4001), sums(8001)];
    std::array::from_fn(|i| (4.0 * fine[i] - coarse[i]) / 3.0)
}

#[test]
fn length_resistance_and_liquid_are_those_of_a_curve_in_space() {
    for (muscle, contraction) in [(ppam(), 0.1), (ppam(), 0.3), (braid(), 0.2)] {
        for (start, end) in [(0.0, 1.0), (0.13, 0.42)] {
            let winding = Winding { offset_m: 1.5e-3, section_m2: 1e-8, ..zone(start, end, 5.3) };
            let sensor = sensor(&muscle, winding);
            let reading = sensor.reading(contraction).unwrap();
            let [length, resistance, liquid] = polyline(&sensor, contraction);
            close(reading.channel_length_m, length, 2e-9);
            close(reading.resistance_ohm, resistance, 2e-9);
            // Liquid neither comes nor goes.
            close(reading.liquid_m3, liquid, 2e-9);
            close(reading.liquid_m3, 1e-8 * sensor.reference_length_m(), 1e-11);
            assert!(reading.resistance_ohm > reading.uniform_resistance_ohm);
        }
    }
}

#[test]
fn a_thinning_layer_keeps_its_volume() {
    let muscle = ppam();
    let (offset, contraction) = (2e-3, 0.25);
    let winding = Winding { offset_m: offset, layer: Layer::Thinning, ..zone(0.0, 1.0, 6.0) };
    let sensor = sensor(&muscle, winding);
    let middle = sensor.channel(contraction, 3).unwrap()[1];
    // At mid-length the curvature is p A'/N, with N = n T for straight fibres.
    let problem = Problem::new(muscle.muscle(), bar(2.0)).unwrap();
    let response = problem.solve(Given::Contraction(contraction), Approach::Auto).unwrap();
    let (n, r) = (40.0, response.mid_radius_m);
    let kappa = 2e5 * n * (TAU / n).sin() * r / (n * response.fibre_tension_n);
    let t = middle.radius_m - r;
    assert!(t < 0.6 * offset, "{t}");
    let volume = r * t + (1.0 + kappa * r) * t * t / 2.0 + kappa * t * t * t / 3.0;
    close(volume, 0.016 * offset + offset * offset / 2.0, 1e-9);
    // What the change of t along the muscle adds to the length is left out: small, and never negative.
    let reading = sensor.reading(contraction).unwrap();
    let [length, resistance, _] = polyline(&sensor, contraction);
    let left_out = [length / reading.channel_length_m - 1.0, resistance / reading.resistance_ohm - 1.0];
    println!("left out by a = sigma - t dpsi/dS: {left_out:?}");
    assert!(left_out.iter().all(|part| *part > 0.0 && *part < 2e-4), "{left_out:?}");
}

#[test]
fn the_error_falls_with_the_sixth_power_of_the_spacing() {
    for (muscle, approach, name, at_49) in [
        (ppam(), Approach::ClosedForm, "closed form", 4e-10),
        (ppam(), Approach::Shooting, "shooting", 7e-10),
        (braid(), Approach::Auto, "braid", 5e-9),
    ] {
        let winding = Winding { offset_m: 1e-3, ..zone(0.13, 0.81, 7.0) };
        let resistance = |points: usize| {
            let options = Options { approach, points, ..Options::default() };
            sensor_with(&muscle, winding, options).reading(0.2).unwrap().resistance_ohm
        };
        let exact = resistance(801);
        let errors = [13, 25, 49].map(|points| (resistance(points) / exact - 1.0).abs());
        let orders = [0, 1].map(|i| (errors[i] / errors[i + 1]).log2());
        let default = (resistance(201) / exact - 1.0).abs();
        println!("{name}: errors {errors:?}, orders {orders:.2?}, 201 points {default:.1e}");
        assert!(orders[1] > 5.0 && orders[1] < 8.5, "{name}: {errors:?}");
        assert!(errors[2] < at_49 && default < 1e-11, "{name}: {errors:?} {default:e}");
    }
    // The longest shipped braid, whose ends are 20 times shorter than itself.
    let long = alone(&preset("dmsp-20-400").unwrap());
    let [found, exact] = [201, 1601].map(|points| {
        let options = Options { points, ..Options::default() };
        let winding = Winding { offset_m: 1e-3, ..zone(0.0, 1.0, 7.0) };
        sensor_with(&long, winding, options).reading(0.2).unwrap().resistance_ohm
    });
    println!("dmsp-20-400: 201 points {:.1e}", (found / exact - 1.0).abs());
    close(found, exact, 1e-7);
    // Both methods of the equilibrium agree.
    let of = |approach| {
        let options = Options { approach, ..Options::default() };
        sensor_with(&ppam(), zone(0.1, 0.9, 9.0), options).reading(0.2).unwrap().resistance_ohm
    };
    close(of(Approach::Shooting), of(Approach::ClosedForm), 1e-9);
}

#[test]
fn mirrored_zones_measure_the_same_and_growth_is_monotone() {
    for muscle in [ppam(), braid()] {
        let wound = |start, end| {
            sensor(&muscle, Winding { offset_m: 1e-3, layer: Layer::Thinning, ..zone(start, end, 8.0) })
        };
        let [left, right] = [wound(0.05, 0.35), wound(0.65, 0.95)];
        let mut last = 0.0;
        for i in 1..=10 {
            let [a, b] = [&left, &right].map(|s| s.reading(0.025 * f64::from(i)).unwrap());
            close(a.resistance_ohm, b.resistance_ohm, 1e-11);
            assert!((a.largest_strain_at + b.largest_strain_at - 1.0).abs() < 1e-9);
            assert!(a.resistance_ohm > last);
            last = a.resistance_ohm;
        }
    }
}

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
        // The noise of a reading, through the inverse.
        let noise = 1e-5 * sensor.reference_resistance_ohm();
        let resolution = curve.resolution(noise).unwrap();
        let here = &curve.readings[10];
        let [up, down] =
            [noise, -noise].map(|n| sensor.contraction(&curve, here.resistance_ohm + n).unwrap());
        close(resolution.contraction[10], 0.5 * (up - down), 1e-5);
        close(resolution.worst_m, resolution.worst * muscle.muscle().length().si(), 1e-15);
        assert!(resolution.contraction.iter().all(|size| *size <= resolution.worst));
        // Outside, and on another's curve.
        let outside = sensor.contraction(&curve, 2.0 * curve.readings[20].resistance_ohm);
        assert!(matches!(outside, Err(SensingError::OutsideCurve { .. })));
        assert!(matches!(sensor.contraction(&curve, f64::NAN), Err(SensingError::OutsideCurve { .. })));
        let other = sensor.rewound(Winding { turns: 19.0, ..winding }).unwrap();
        assert_eq!(other.contraction(&curve, here.resistance_ohm), Err(SensingError::OtherCurve));
        let other = sensor.at_pressure(bar(1.0)).unwrap();
        assert_eq!(other.contraction(&curve, here.resistance_ohm), Err(SensingError::OtherCurve));
    }
}

#[test]
fn a_curve_that_turns_has_no_inverse() {
    // On a cylinder lambda^2 ~ c^2 (r + t)^2 + 1 - q^2 r^2 with c = theta' and q = sin(alpha0)/r0: largest at r = c^2 t/(q^2 - c^2). For a
    // layer of 2 mm that stays, c^2 = q^2 12/14 puts this at r = 12 mm.
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
    // Nor is it a place to wind.
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
    // R = 3 + 2 e^2: the best line is at the variance of e about the middle, (n + 1)/(12 (n - 1)).
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

/// A layer of 0.5 mm with a channel of 0.05 mm^2.
fn layer(start: f64, end: f64, turns: f64) -> Winding {
    Winding { offset_m: 0.5e-3, layer: Layer::Thinning, section_m2: 0.05e-6, ..zone(start, end, turns) }
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
    // The curve is concave: steepest where the muscle begins.
    assert!(curve.sensitivity.windows(2).all(|pair| pair[1] < pair[0]));
    // 1 mohm is at worst, at 30 %: 1e-3/(13.646 * 12.195) of 110 mm.
    let resolution = curve.resolution(1e-3).unwrap();
    assert!((resolution.worst_at - 0.3).abs() < 1e-12);
    assert!(resolution.worst_m > 0.658e-6 && resolution.worst_m < 0.664e-6, "{}", resolution.worst_m);
}

fn search(to: f64, widths: [f64; 2], goal: Goal) -> Search {
    let width_steps = if widths[0] < widths[1] { 4 } else { 1 };
    let range = Range { from: 0.05, to, points: 26 };
    Search { range, widths, width_steps, centres: 15, goal }
}

#[test]
fn a_pleated_muscle_is_best_wound_at_its_middle() {
    let options = Options { points: 61, ..Options::default() };
    let sensor = sensor_with(&ppam(), layer(0.0, 1.0, 6.0), options);
    let middle = |goal| sensor.best_place(&search(0.3, [0.1, 0.3], goal)).unwrap();
    for goal in [Goal::MostSensitive, Goal::MostLinear { least_sensitivity: 5.0 }] {
        let found = middle(goal);
        assert!((found.best.centre - 0.5).abs() < 1e-9 && (found.best.width - 0.1).abs() < 1e-9);
        let gauge = found.best.sensitivity.unwrap();
        assert!(gauge > 21.9 && gauge < 22.0, "{gauge}");
        // The curve that comes with it is that of the zone.
        let line = found.curve.linearity.unwrap();
        close(line.mean_sensitivity, gauge, 1e-12);
        close(line.best_fit_percent, found.best.best_fit_percent.unwrap(), 1e-9);
        assert_eq!(found.scanned.len(), 60);
        // Near the fittings the radius hardly changes.
        let first = &found.scanned[0];
        assert!((first.centre - 0.05).abs() < 1e-12 && first.sensitivity.unwrap() < 0.1 * gauge);
        let insensitive = found.scanned.iter().any(|place| place.verdict == Verdict::Insensitive);
        assert_eq!(insensitive, goal != Goal::MostSensitive);
    }
    // An elastomer that bears less: the best zone reaches its limit, or there is none.
    let weak = |max_strain| {
        let sensor = sensor_with(&ppam(), layer(0.0, 1.0, 6.0), Options { max_strain, ..options });
        sensor.best_place(&search(0.3, [0.1; 2], Goal::MostSensitive))
    };
    let found = weak(1.2).unwrap();
    assert!(
        (found.best.largest_strain.unwrap() - 1.2).abs() < 1e-3 && found.best.centre < 0.3,
        "{:?}",
        found.best
    );
    assert!(found.scanned.iter().any(|place| place.verdict == Verdict::Overstrained));
    assert!(matches!(weak(0.1), Err(SensingError::NoPlace { overstrained: 15, .. })));
    // Turns that run into each other in the narrowest zones only.
    let dense = sensor.rewound(layer(0.0, 1.0, 60.0)).unwrap();
    let found = dense.best_place(&search(0.3, [0.1, 0.4], Goal::MostSensitive)).unwrap();
    assert!(found.scanned[..15].iter().all(|place| place.verdict == Verdict::Impossible));
    // 60 channels of 0.2523 mm in 110 mm of fibre.
    close(found.best.width, 60.0 * (4.0 * 0.05 / std::f64::consts::PI).sqrt() / 110.0, 1e-3);
}

#[test]
fn a_braid_is_straightest_near_its_fittings() {
    let options = Options { points: 61, ..Options::default() };
    let sensor = sensor_with(&braid(), layer(0.0, 1.0, 6.0), options);
    let best = |widths, least_sensitivity| {
        sensor.best_place(&search(0.25, widths, Goal::MostLinear { least_sensitivity })).unwrap()
    };
    let departure = |centre: f64, width: f64| {
        let wound = sensor.rewound(sensor.winding().placed(centre, width)).unwrap();
        wound.curve(search(0.25, [0.1; 2], Goal::MostSensitive).range).unwrap().linearity.unwrap()
    };
    let free = best([0.1; 2], 0.0);
    let found = free.best.best_fit_percent.unwrap();
    println!("braid, zone of 10 %: {:?}", free.best);
    assert!(
        found < free.scanned.iter().filter_map(|place| place.best_fit_percent).fold(f64::INFINITY, f64::min)
    );
    // No place of a scan twenty times as fine is better.
    let fine = (0..=60)
        .map(|i| departure(0.08 + 2e-4 * f64::from(i), 0.1).best_fit_percent)
        .fold(f64::INFINITY, f64::min);
    assert!(found <= fine + 1e-9 && fine - found < 2e-3, "{found} {fine}");
    // More sensitivity is paid for with linearity, and no more of it is taken than asked for.
    let bound = best([0.1; 2], 5.0).best;
    close(bound.sensitivity.unwrap(), 5.0, 2e-4);
    assert!(bound.sensitivity.unwrap() >= 5.0 && bound.best_fit_percent.unwrap() > found);
    // Other widths can only help.
    let wide = best([0.1, 0.25], 5.0).best;
    assert!(wide.best_fit_percent.unwrap() <= bound.best_fit_percent.unwrap() + 1e-12);
    let impossible = sensor.best_place(&search(0.25, [0.1; 2], Goal::MostLinear { least_sensitivity: 8.0 }));
    let Err(SensingError::NoPlace { largest, .. }) = impossible else { panic!("8 can't be reached") };
    assert!(largest > 7.39 && largest < 7.42);
    // A long braid: the straightest zone is where the ends give way to the cylinder.
    let long = sensor_with(&alone(&preset("dmsp-20-250").unwrap()), layer(0.0, 1.0, 6.0), Options::default());
    let goal = Goal::MostLinear { least_sensitivity: 0.0 };
    let placed = long.best_place(&search(0.25, [0.1; 2], goal)).unwrap();
    let (found, middle) = (placed.best, placed.scanned[14].best_fit_percent.unwrap());
    assert!(middle > 3.6 && middle < 3.8, "{middle}");
    println!("dmsp-20-250, zone of 10 %: {found:?}");
    let percent = found.best_fit_percent.unwrap();
    assert!(percent > 0.2 && percent < 0.27 && (found.centre - 0.094).abs() < 0.003, "{found:?}");
}

#[test]
fn effects_of_the_muscle_take_part() {
    let text = "name = \"c\"\nkind = \"braided\"\nlength = \"200 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\nends = \"cylinder\"\n";
    let learnt = |tables: &str| {
        let muscle = muscle(&format!("{text}\n{tables}\n"));
        Extended::new(&muscle, &known(&muscle, &Catalogue::builtin()).unwrap()).unwrap()
    };
    let wide = alone(&muscle(&text.replace("10 mm", "10.7 mm")));
    let winding = layer(0.2, 0.8, 11.0);
    let [a, b] = [&learnt("[effects.radius-error]\nradius = \"10.7 mm\""), &wide]
        .map(|muscle| sensor(muscle, winding).reading(0.1).unwrap());
    assert_eq!(a, b);
    // Fibres that are 1 % longer than the muscle says: the contraction is that from the stated length.
    let longer = sensor(&learnt("[effects.fibre-length]\nexcess = \"1 %\""), zone(0.1, 0.9, 0.0))
        .reading(0.1)
        .unwrap();
    assert!((longer.contraction - 0.1).abs() < 1e-15);
    close(longer.muscle_length_m, 0.18, 1e-12);
    close(1.0 + longer.relative_change, (0.9f64 / 1.01).powi(2), 1e-12);
    // Fibres stretch more under more pressure; inextensible ones don't care.
    let stiff = sensor(&ppam(), winding);
    let [one, two] =
        [1.0, 3.0].map(|p| stiff.at_pressure(bar(p)).unwrap().reading(0.2).unwrap().resistance_ohm);
    close(one, two, 1e-12);
}

#[test]
fn shapes_from_elsewhere_are_read_and_checked() {
    let muscle = ppam();
    let sensor = sensor(&muscle, layer(0.2, 0.8, 11.0));
    let problem = Problem::new(muscle.muscle(), bar(2.0)).unwrap();
    let shape = problem.shape(Given::Contraction(0.2), Approach::Shooting, 301).unwrap();
    let [a, b] = [sensor.reading_of(&shape), sensor.reading(0.2)].map(Result::unwrap);
    close(a.resistance_ohm, b.resistance_ohm, 1e-9);
    let changed = |change: &dyn Fn(&mut bulge_fibre::Shape)| {
        let mut shape = shape.clone();
        change(&mut shape);
        sensor.reading_of(&shape)
    };
    for found in [
        changed(&|shape| shape.meridian.truncate(6)),
        changed(&|shape| shape.meridian.truncate(200)),
        changed(&|shape| shape.meridian.reverse()),
        changed(&|shape| shape.meridian[7].r_m = f64::NAN),
        changed(&|shape| shape.meridian[7].r_m = 0.0),
        changed(&|shape| shape.meridian[300].fibre_length_m = f64::NAN),
        changed(&|shape| shape.meridian[9].fibre_length_m = shape.meridian[8].fibre_length_m),
    ] {
        assert!(matches!(found, Err(SensingError::Meridian { .. })), "{found:?}");
    }
    // A meridian that turns outwards by 40 rad on its way has no parallel surface 5 mm outside, whatever the layer does.
    let mut waist = shape.clone();
    for point in &mut waist.meridian {
        point.slope_rad = 40.0 * (point.fibre_length_m / 0.11 - 0.5);
    }
    for layer in [Layer::Kept, Layer::Thinning] {
        let thick = Winding { offset_m: 5e-3, layer, ..*sensor.winding() };
        let found = sensor.rewound(thick).unwrap().reading_of(&waist);
        assert!(matches!(found, Err(SensingError::Folded { .. })), "{found:?}");
    }
}

#[test]
fn an_elastomer_that_would_tear_is_an_error() {
    let options = Options { max_strain: 1.5, ..Options::default() };
    let sensor = sensor_with(&ppam(), zone(0.2, 0.9, 8.0), options);
    assert!(sensor.reading(0.1).is_ok());
    let Err(SensingError::Overstrained { strain, at, allowed, contraction }) = sensor.reading(0.3) else {
        panic!("it must tear")
    };
    let free = sensor_with(&ppam(), zone(0.2, 0.9, 8.0), Options::default()).reading(0.3).unwrap();
    assert_eq!(
        (strain.to_bits(), at.to_bits()),
        (free.largest_strain.to_bits(), free.largest_strain_at.to_bits())
    );
    assert!((at - 0.5).abs() < 1e-12 && strain > 2.0);
    assert_eq!([allowed, contraction].map(f64::to_bits), [1.5, 0.3].map(f64::to_bits));
    let range = Range { from: 0.05, to: 0.3, points: 11 };
    let error = sensor.curve(range).unwrap_err().to_string();
    assert!(error.contains("more than the 150.0 % that the elastomer bears"), "{error}");
}

#[test]
fn what_can_not_be_is_answered() {
    let good = layer(0.2, 0.8, 11.0);
    let new =
        |winding, options| Sensor::new(&ppam(), bar(2.0), winding, Reference::Rest, options).map(|_| ());
    let bad_windings = [
        (Winding { start: -0.1, ..good }, "zone"),
        (Winding { end: 1.1, ..good }, "zone"),
        (Winding { end: 0.2, ..good }, "zone"),
        (Winding { start: f64::NAN, ..good }, "zone"),
        (Winding { turns: -1.0, ..good }, "number of turns"),
        (Winding { turns: f64::NAN, ..good }, "number of turns"),
        (Winding { turns: f64::INFINITY, ..good }, "number of turns"),
        (Winding { turns: 1e5, ..good }, "apart"),
        (Winding { section_m2: 0.0, ..good }, "section"),
        (Winding { section_m2: f64::NAN, ..good }, "section"),
        (Winding { section_m2: 1.0, ..good }, "section"),
        (Winding { offset_m: -1e-3, ..good }, "offset"),
        (Winding { offset_m: 1.0, ..good }, "offset"),
        (Winding { resistivity_ohm_m: 0.0, ..good }, "resistivity"),
        (Winding { resistivity_ohm_m: f64::INFINITY, ..good }, "resistivity"),
    ];
    for (winding, part) in bad_windings {
        let error = new(winding, Options::default()).unwrap_err().to_string();
        assert!(error.contains(part), "{winding:?}: {error:?} does not say {part:?}");
    }
    for (options, part) in [
        (Options { points: 6, ..Options::default() }, "meridian points"),
        (Options { points: 1_000_000, ..Options::default() }, "meridian points"),
        (Options { max_strain: 0.0, ..Options::default() }, "bears"),
        (Options { max_strain: f64::NAN, ..Options::default() }, "bears"),
    ] {
        let error = new(good, options).unwrap_err().to_string();
        assert!(error.contains(part), "{options:?}: {error}");
    }
    for pressure in [0.0, -1.0, f64::NAN] {
        let new = Sensor::new(&ppam(), bar(pressure), good, Reference::Rest, Options::default());
        assert!(matches!(new, Err(SensingError::Equilibrium { .. })));
        let reference = Reference::At { pressure: bar(pressure), contraction: 0.1 };
        assert!(Sensor::new(&ppam(), bar(1.0), good, reference, Options::default()).is_err());
    }
}

#[test]
fn what_can_not_be_asked_is_answered() {
    let sensor = sensor(&ppam(), layer(0.2, 0.8, 11.0));
    for contraction in [f64::NAN, f64::INFINITY, 0.0, -0.1, 0.6, 1.0, 2.0] {
        let found = sensor.reading(contraction);
        assert!(matches!(found, Err(SensingError::Equilibrium { .. })), "{contraction}: {found:?}");
    }
    let range = Range { from: 0.05, to: 0.3, points: 21 };
    for bad in [
        Range { from: 0.3, to: 0.05, ..range },
        Range { from: f64::NAN, ..range },
        Range { to: f64::INFINITY, ..range },
        Range { points: 10, ..range },
        Range { points: usize::MAX, ..range },
    ] {
        assert!(matches!(sensor.curve(bad), Err(SensingError::Number { .. })), "{bad:?}");
    }
    let good = search(0.3, [0.1, 0.2], Goal::MostSensitive);
    for bad in [
        Search { widths: [0.0, 0.2], ..good },
        Search { widths: [0.3, 0.2], ..good },
        Search { widths: [0.1, 1.2], ..good },
        Search { widths: [0.1; 2], ..good },
        Search { width_steps: 1, ..good },
        Search { centres: 2, ..good },
        Search { goal: Goal::MostLinear { least_sensitivity: f64::NAN }, ..good },
    ] {
        assert!(matches!(sensor.best_place(&bad), Err(SensingError::Number { .. })), "{bad:?}");
    }
    let curve = sensor.curve(range).unwrap();
    assert!(matches!(curve.resolution(0.0), Err(SensingError::Number { .. })));
    assert!(sensor.channel(0.1, 1).is_err() && sensor.reference_channel(usize::MAX).is_err());
}
