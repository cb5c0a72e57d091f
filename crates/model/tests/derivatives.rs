//! Every effect along a path: derivatives against differences, and nothing changed, bit for bit, where it is off.

#![expect(
    clippy::unwrap_used,
    reason = "a test that cannot be set up fails; values are exact by construction"
)]

use bulge_effects::law::{LAWS, LawGeometry};
use bulge_effects::{Catalogue, Group, Moment};
use bulge_model::{Model, Record, Wanted};
use bulge_muscles::{Kind, Muscle, preset};

/// A loop with an inner reversal at two pressures, with time, temperature and two cycles.
fn path() -> Record {
    let contraction = |i: usize| 0.06 + 0.04 * (0.35 * i as f64).sin() + 0.02 * (0.9 * i as f64).sin();
    let mut moments: Vec<Moment> = Vec::new();
    for sweep in 0..2 {
        let mut largest = f64::MIN;
        for i in 0..24 {
            let e = contraction(i);
            largest = e.max(largest);
            let step = if i == 0 { 0.0 } else { e - contraction(i - 1) };
            moments.push(Moment {
                direction: if i == 0 { 0.0 } else { step.signum() },
                rate: 0.1 * (contraction(i + 1) - e),
                pressure_rate: 30.0,
                time: 10.0 * i as f64,
                clock: 10.0 * (i + 24 * sweep) as f64,
                since: if i == 0 { 0.0 } else { 10.0 },
                step,
                temperature: 0.3 * i as f64,
                cycle: sweep as f64,
                largest,
                begins: i == 0,
                ..Moment::at_rest(1.5e5 + 1e5 * sweep as f64 + 300.0 * i as f64, e)
            });
        }
    }
    Record::from_moments(moments, vec![0.0; 48], vec![0..24, 24..48]).unwrap()
}

/// Cheap answers: closed form, and the textbook cylinder with a wall.
fn muscles() -> Vec<Muscle> {
    let braid = "name = \"b\"\nkind = \"braided\"\nlength = \"250 mm\"\nradius = \"10 mm\"\nwall = \"2 mm\"\n\
                 braid_angle = \"25 deg\"\nends = \"cylinder\"\n";
    vec![preset("ppam-2-r16").unwrap(), bulge_muscles::from_toml(braid, "braid").unwrap()]
}

#[test]
fn derivatives_agree_with_differences() {
    let record = path();
    let mut tried = 0;
    for muscle in muscles() {
        for effect in Catalogue::builtin().iter() {
            let Ok(model) = Model::new(&muscle).with(effect, None) else { continue };
            // Those that need shooting are tried with fewer rows elsewhere.
            if model.is_costly(&model.start()).unwrap_or(true) {
                continue;
            }
            let mut theta = model.start();
            for (value, p) in theta.iter_mut().zip(model.parameters()) {
                // Away from off and from the bounds.
                if (*value - p.off).abs() < 1e-3 * (p.high - p.low) {
                    *value += 0.02 * (p.high - p.low);
                }
            }
            let wanted = Wanted { parameters: (0..theta.len()).collect(), readings: true };
            let found = match model.evaluate(&record, &theta, &wanted) {
                Ok(found) => found,
                Err(error) => panic!("{}: {error}", effect.card().name),
            };
            let k = theta.len();
            for j in 0..k {
                let h = 1e-5 * (theta[j] - model.parameters()[j].off).abs().max(1e-4 * theta[j].abs());
                let at = |x: f64| {
                    let mut moved = theta.clone();
                    moved[j] = x;
                    model.evaluate(&record, &moved, &Wanted::default()).unwrap().force
                };
                let (up, down) = (at(theta[j] + h), at(theta[j] - h));
                let largest = (0..record.len()).map(|i| found.jacobian[i * k + j].abs()).fold(0.0, f64::max);
                for i in 0..record.len() {
                    let quotient = (up[i] - down[i]) / (2.0 * h);
                    let error = (found.jacobian[i * k + j] - quotient).abs();
                    // Rounding of a force of some 1000 N over the step.
                    let rounding = 1e-12 * found.force[i].abs().max(100.0) / h;
                    assert!(
                        error <= 1e-6 * largest + rounding,
                        "{} {} row {i}: {} against {quotient}",
                        effect.card().name,
                        model.parameters()[j].name,
                        found.jacobian[i * k + j]
                    );
                }
                tried += 1;
            }
        }
    }
    println!("{tried} derivatives of effects along a path of {} rows", record.len());
    assert!(tried > 60, "{tried}");
}

#[test]
fn off_changes_nothing() {
    let record = path();
    let mut tried = 0;
    for muscle in muscles() {
        let bare = Model::new(&muscle).evaluate(&record, &[], &Wanted::default()).unwrap().force;
        for effect in Catalogue::builtin().iter() {
            let Ok(model) = Model::new(&muscle).with(effect, None) else { continue };
            if model.parameters().is_empty()
                || effect.card().group == Group::Specimen && model.parameters().len() > 1
            {
                continue;
            }
            let off = model.evaluate(&record, &model.off(), &Wanted::default()).unwrap().force;
            let same = bare.iter().zip(&off).all(|(a, b)| a.to_bits() == b.to_bits());
            assert!(same, "{} is not off", effect.card().name);
            tried += 1;
        }
    }
    assert!(tried > 60, "{tried}");
}

#[test]
fn laws_are_models() {
    let record = path();
    let muscle = &muscles()[1];
    let geometry = LawGeometry::from(muscle);
    for law in LAWS.iter().filter(|law| law.suits(Kind::Braided)) {
        let model = Model::from_law(muscle, law, &law.start(&geometry, None), true);
        let force = model.evaluate(&record, &model.start(), &Wanted::default()).unwrap().force;
        for (moment, force) in record.moments().iter().zip(force) {
            let point = bulge_effects::law::LawPoint {
                pressure: moment.pressure,
                contraction: moment.contraction,
                direction: moment.direction,
            };
            assert!((force - law.force(point, &geometry, &model.start())).abs() < 1e-9, "{}", law.name);
        }
    }
}
