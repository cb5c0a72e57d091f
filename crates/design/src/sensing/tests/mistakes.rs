//! Impossible inputs and their errors: shapes, strains, windings, requests.

use super::*;

#[test]
fn shapes_from_elsewhere_are_read_and_checked() {
    let muscle = ppam();
    let sensor = sensor(&muscle, layer(0.2, 0.8, 11.0));
    let problem = Problem::new(muscle.parts(), bar(2.0)).unwrap();
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
        assert_refused(found, "this meridian doesn't fit the winding");
    }
    // A meridian that turns outward by 40 rad along its length has no parallel surface 5 mm outside, for
    // either layer.
    let mut waist = shape.clone();
    for point in &mut waist.meridian {
        point.slope_rad = 40.0 * (point.fibre_length_m / 0.11 - 0.5);
    }
    for layer in [Layer::Kept, Layer::Thinning] {
        let thick = Winding { offset_m: 5e-3, layer, ..*sensor.winding() };
        let found = sensor.rewound(thick).unwrap().reading_of(&waist);
        assert_refused(found, "has no place at");
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
        (Winding { section_m2: 0.0, ..good }, "diameter"),
        (Winding { section_m2: f64::NAN, ..good }, "diameter"),
        (Winding { section_m2: 1.0, ..good }, "diameter"),
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
        assert_refused(sensor.curve(bad), ": it must be ");
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
        assert_refused(sensor.best_place(&bad), ": it must be ");
    }
    let curve = sensor.curve(range).unwrap();
    assert_refused(curve.resolution(0.0), ": it must be ");
    assert!(sensor.channel(0.1, 1).is_err() && sensor.reference_channel(usize::MAX).is_err());
}
