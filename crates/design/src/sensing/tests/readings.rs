//! One reading: closed forms on cylinders and rings, polylines in space, order of convergence, effects.

use super::*;

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
            // The layer keeps its volume: ((r + t)^2 - r^2) l equals its value at rest.
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
    // Pleated and inextensible: nothing changes. The whole muscle with 1 mm^2 of eGaIn: 0.294 ohm/m.
    let along = Winding { section_m2: 1e-6, ..zone(0.0, 1.0, 0.0) };
    let straight = sensor(&ppam(), along);
    close(straight.reference_resistance_ohm(), 0.294 * 0.11, 1e-12);
    for contraction in [0.02, 0.1, 0.3] {
        assert!(straight.reading(contraction).unwrap().relative_change.abs() < 1e-12);
    }
    let curve = straight.curve(Range { from: 0.05, to: 0.3, points: 21 }).unwrap();
    assert_eq!((curve.linearity, curve.check_monotone()), (None, Err(SensingError::NoChange)));
    assert!(curve.resolution(1e-6).is_err());
    // Pleated with elastic fibres: (1 + e)^2.
    let elastic = muscle(
        "name = \"e\"\nkind = \"pleated\"\nlength = \"110 mm\"\nradius = \"16 mm\"\nfibres = 40\nfibre = { stiffness = \"2 kN\" }\n",
    );
    let problem = Problem::new(&elastic, bar(2.0)).unwrap();
    let strain = problem.solve(Given::Contraction(0.1), Approach::Auto).unwrap().fibre_strain;
    assert!(strain > 0.005);
    let found = sensor(&alone(&elastic), along).reading(0.1).unwrap();
    close(1.0 + found.relative_change, (1.0 + strain).powi(2), 1e-11);
    // Braided: (cos(alpha)/cos(alpha0))^2, which for the cylinder is (1 - contraction)^2. The resistance
    // decreases and determines the contraction.
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
    let problem = Problem::new(muscle.parts(), bar(2.0)).unwrap();
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
    // At the reference itself nothing changes, along the whole muscle.
    let whole =
        from_5.rewound(Winding { offset_m: 1e-3, layer: Layer::Thinning, ..zone(0.0, 1.0, 9.0) }).unwrap();
    let found = whole.reading(0.05).unwrap();
    assert!(found.relative_change.abs() < 1e-10 && found.largest_strain.abs() < 1e-9, "{found:?}");
}

/// Length, resistance and liquid volume of a polyline in space, extrapolated to zero spacing; the reference
/// gives the unstretched lengths.
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
            // The volume of the liquid is constant.
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
    let problem = Problem::new(muscle.parts(), bar(2.0)).unwrap();
    let response = problem.solve(Given::Contraction(contraction), Approach::Auto).unwrap();
    let (n, r) = (40.0, response.mid_radius_m);
    let kappa = 2e5 * n * (TAU / n).sin() * r / (n * response.fibre_tension_n);
    let t = middle.radius_m - r;
    assert!(t < 0.6 * offset, "{t}");
    let volume = r * t + (1.0 + kappa * r) * t * t / 2.0 + kappa * t * t * t / 3.0;
    close(volume, 0.016 * offset + offset * offset / 2.0, 1e-9);
    // The variation of t along the muscle would add to the length, but is neglected: it is small and never
    // negative.
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
    // The longest shipped braid: it is 20 times as long as its ends.
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
fn effects_of_the_muscle_take_part() {
    let text = "name = \"c\"\nkind = \"braided\"\nlength = \"200 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\nends = \"cylinder\"\n";
    let learnt = |tables: &str| {
        let muscle = muscle(&format!("{text}\n{tables}\n"));
        MuscleWithEffects::new(&muscle, &known(&muscle, &Catalogue::builtin()).unwrap()).unwrap()
    };
    let wide = alone(&muscle(&text.replace("10 mm", "10.7 mm")));
    let winding = layer(0.2, 0.8, 11.0);
    let [a, b] = [&learnt("[effects.radius-error]\nradius = \"10.7 mm\""), &wide]
        .map(|muscle| sensor(muscle, winding).reading(0.1).unwrap());
    assert_eq!(a, b);
    // Fibres 1 % longer than the muscle file says: the contraction is relative to the stated length.
    let longer = sensor(&learnt("[effects.fibre-length]\nexcess = \"1 %\""), zone(0.1, 0.9, 0.0))
        .reading(0.1)
        .unwrap();
    assert!((longer.contraction - 0.1).abs() < 1e-15);
    close(longer.muscle_length_m, 0.18, 1e-12);
    close(1.0 + longer.relative_change, (0.9f64 / 1.01).powi(2), 1e-12);
    // Fibres stretch more at higher pressure; inextensible ones don't stretch.
    let stiff = sensor(&ppam(), winding);
    let [one, two] =
        [1.0, 3.0].map(|p| stiff.at_pressure(bar(p)).unwrap().reading(0.2).unwrap().resistance_ohm);
    close(one, two, 1e-12);
}
