//! The best zone for a channel.

use super::*;

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
        // The curve returned is that of the zone.
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
    // With a weaker elastomer the best zone reaches its limit, or there is none.
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
    // The turns overlap only in the narrowest zones.
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
    // No zone of a scan twenty times as fine is better.
    let fine = (0..=60)
        .map(|i| departure(0.08 + 2e-4 * f64::from(i), 0.1).best_fit_percent)
        .fold(f64::INFINITY, f64::min);
    assert!(found <= fine + 1e-9 && fine - found < 2e-3, "{found} {fine}");
    // Higher sensitivity costs linearity, and no more of it is taken than required.
    let bound = best([0.1; 2], 5.0).best;
    close(bound.sensitivity.unwrap(), 5.0, 2e-4);
    assert!(bound.sensitivity.unwrap() >= 5.0 && bound.best_fit_percent.unwrap() > found);
    // A range of widths can only improve the result.
    let wide = best([0.1, 0.25], 5.0).best;
    assert!(wide.best_fit_percent.unwrap() <= bound.best_fit_percent.unwrap() + 1e-12);
    let impossible = sensor.best_place(&search(0.25, [0.1; 2], Goal::MostLinear { least_sensitivity: 8.0 }));
    let Err(SensingError::NoPlace { largest, .. }) = impossible else { panic!("8 can't be reached") };
    assert!(largest > 7.39 && largest < 7.42);
    // In a long braid the most linear zone is at the transition from the ends to the cylinder.
    let long = sensor_with(&alone(&preset("dmsp-20-250").unwrap()), layer(0.0, 1.0, 6.0), Options::default());
    let goal = Goal::MostLinear { least_sensitivity: 0.0 };
    let placed = long.best_place(&search(0.25, [0.1; 2], goal)).unwrap();
    let (found, middle) = (placed.best, placed.scanned[14].best_fit_percent.unwrap());
    assert!(middle > 3.6 && middle < 3.8, "{middle}");
    println!("dmsp-20-250, zone of 10 %: {found:?}");
    let percent = found.best_fit_percent.unwrap();
    assert!(percent > 0.2 && percent < 0.27 && (found.centre - 0.094).abs() < 0.003, "{found:?}");
}
