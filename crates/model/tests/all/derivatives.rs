//! Every effect along a path: derivatives agree with differences, and an effect that is off changes nothing,
//! bit for bit.

#![expect(
    clippy::unwrap_used,
    reason = "a test that cannot be set up fails; values are exact by construction"
)]

use bulge_effects::law::{LAWS, Law, LawGeometry};
use bulge_effects::{Catalogue, Group, Moment};
use bulge_model::{Model, Record, Wanted};
use bulge_muscles::{Kind, Muscle, Parameter, Quantity, preset};
use bulge_numerics::Random;

/// Loops with inner reversals at two random pressures, with time, temperature and two cycles.
fn path(seed: u64) -> Record {
    let mut random = Random::new(seed, 0);
    let [middle, wide, narrow] =
        [random.between(0.06, 0.07), random.between(0.01, 0.04), random.between(0.005, 0.015)];
    let [slow, fast, phase] = [random.between(0.2, 0.4), random.between(0.7, 1.2), random.between(0.0, 6.0)];
    let [pressure, higher, pace] =
        [random.between(1.2e5, 3e5), random.between(0.5e5, 2e5), random.between(0.5, 20.0)];
    let contraction =
        |i: usize| middle + wide * (slow * i as f64 + phase).sin() + narrow * (fast * i as f64).sin();
    let mut moments: Vec<Moment> = Vec::new();
    for sweep in 0..2 {
        let mut largest = f64::MIN;
        for i in 0..24 {
            let e = contraction(i);
            largest = e.max(largest);
            let step = if i == 0 { 0.0 } else { e - contraction(i - 1) };
            moments.push(Moment {
                direction: if i == 0 { 0.0 } else { step.signum() },
                rate: (contraction(i + 1) - e) / pace,
                pressure_rate: 300.0 / pace,
                time: pace * i as f64,
                clock: pace * (i + 24 * sweep) as f64,
                since: if i == 0 { 0.0 } else { pace },
                step,
                temperature: 0.3 * i as f64,
                cycle: sweep as f64,
                largest,
                begins: i == 0,
                ..Moment::at_rest(pressure + higher * sweep as f64 + 300.0 * i as f64, e)
            });
        }
    }
    Record::from_moments(moments, vec![0.0; 48], vec![0..24, 24..48]).unwrap()
}

/// Muscles with cheap answers: closed form, and the textbook cylinder with a wall.
fn muscles() -> Vec<Muscle> {
    let braid = "name = \"b\"\nkind = \"braided\"\nlength = \"250 mm\"\nradius = \"10 mm\"\nwall = \"2 mm\"\n\
                 braid_angle = \"25 deg\"\nends = \"cylinder\"\n";
    vec![preset("ppam-2-r16").unwrap(), bulge_muscles::from_toml(braid, "braid").unwrap()]
}

/// Compares the derivatives by parameter `j` with a difference over `h`, to a millionth of the largest one.
fn check(model: &Model, record: &Record, theta: &[f64], j: usize, h: f64) {
    let wanted = Wanted { parameters: (0..theta.len()).collect(), readings: true };
    let found = model.evaluate(record, theta, &wanted).unwrap();
    let k = theta.len();
    let at = |x: f64| {
        let mut moved = theta.to_vec();
        moved[j] = x;
        model.evaluate(record, &moved, &Wanted::default()).unwrap().force
    };
    let (up, down) = (at(theta[j] + h), at(theta[j] - h));
    let largest = (0..record.len()).map(|i| found.jacobian[i * k + j].abs()).fold(0.0, f64::max);
    for i in 0..record.len() {
        let quotient = (up[i] - down[i]) / (2.0 * h);
        let error = (found.jacobian[i * k + j] - quotient).abs();
        // The rounding error of a force of some 1000 N, divided by the step.
        let rounding = 1e-12 * found.force[i].abs().max(100.0) / h;
        let p = &model.parameters()[j];
        assert!(
            error <= 1e-6 * largest + rounding,
            "{} {} row {i}: {} against {quotient}",
            p.effect,
            p.name,
            found.jacobian[i * k + j]
        );
    }
}

#[test]
fn derivatives_agree_with_differences() {
    let mut tried = 0;
    for seed in 1..=4 {
        let record = path(seed);
        for muscle in muscles() {
            for effect in Catalogue::builtin().iter() {
                let Ok(model) = Model::new(&muscle).with(effect, None) else { continue };
                // Effects that need shooting are tested with fewer rows elsewhere.
                if model.is_costly(&model.start()).unwrap_or(true) {
                    continue;
                }
                let mut theta = model.start();
                for (value, p) in theta.iter_mut().zip(model.parameters()) {
                    // The value is away from `off` and from the bounds.
                    if (*value - p.off).abs() < 1e-3 * (p.high - p.low) {
                        *value += 0.02 * (p.high - p.low);
                    }
                }
                for (j, p) in model.parameters().iter().enumerate() {
                    let h = 1e-5 * (theta[j] - p.off).abs().max(1e-4 * theta[j].abs());
                    check(&model, &record, &theta, j, h);
                    tried += 1;
                }
            }
        }
    }
    println!("{tried} derivatives of effects along paths of 48 rows");
    assert!(tried > 240, "{tried}");
}

#[test]
fn derivatives_of_laws_agree_with_differences() {
    let mut tried = 0;
    for seed in 1..=4 {
        let record = path(seed);
        for muscle in muscles() {
            let geometry = LawGeometry::from(&muscle);
            for law in LAWS.iter().filter(|law| law.suits(muscle.kind())) {
                for table in std::iter::once(None).chain(law.tables.iter().map(Some)) {
                    let theta = law.start(&geometry, table);
                    let model = Model::from_law(&muscle, law, &theta, true);
                    for j in 0..theta.len() {
                        check(&model, &record, &theta, j, 1e-6 * theta[j].abs().max(1e-3));
                        tried += 1;
                    }
                }
            }
        }
    }
    println!("{tried} derivatives of force laws along paths of 48 rows");
    assert!(tried > 200, "{tried}");
}

#[test]
fn off_changes_nothing() {
    let record = path(7);
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
    let record = path(7);
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

/// A braid with a second specimen of another length, radius and angle, and loops on both.
fn specimens(ends: &str) -> (Muscle, Record) {
    let braid = format!(
        "name = \"b\"\nkind = \"braided\"\nlength = \"250 mm\"\nradius = \"10 mm\"\nwall = \"2 mm\"\nbraid_angle = \"25 deg\"\nends = \"{ends}\"\n\n\
         [specimens.2]\nlength = \"80 mm\"\nradius = \"9 mm\"\nbraid_angle = \"24 deg\"\n"
    );
    let record = path(3);
    let moments = record.moments().iter().enumerate();
    let moments = moments.map(|(row, m)| Moment { specimen: u32::from(row >= 24), ..*m }).collect();
    let record = Record::from_moments(moments, vec![0.0; 48], record.sweeps().to_vec()).unwrap();
    (bulge_muscles::from_toml(&braid, "braid").unwrap(), record)
}

fn of_both(muscle: &Muscle) -> Model {
    Model::new(muscle).for_specimens(&["1".to_owned(), "2".to_owned()]).unwrap()
}

#[test]
fn derivatives_across_specimens_agree_with_differences() {
    let mut tried = 0;
    for ends in ["cylinder", "clamped"] {
        let (muscle, record) = specimens(ends);
        let costly = ["bladder-elasticity", "radius-error", "length-zero-error", "fibre-length"];
        for effect in Catalogue::builtin().iter() {
            let Ok(model) = of_both(&muscle).with(effect, None) else { continue };
            let is_costly = model.is_costly(&model.start()).unwrap_or(true);
            if is_costly && (ends == "cylinder" || !costly.contains(&effect.card().name)) {
                continue;
            }
            let mut theta = model.start();
            for (value, p) in theta.iter_mut().zip(model.parameters()) {
                if (*value - p.off).abs() < 1e-3 * (p.high - p.low) {
                    *value += 0.02 * (p.high - p.low);
                }
            }
            for (j, p) in model.parameters().iter().enumerate() {
                let h = 1e-5 * (theta[j] - p.off).abs().max(1e-4 * theta[j].abs());
                check(&model, &record, &theta, j, h);
                tried += 1;
            }
        }
    }
    assert!(tried > 60, "{tried}");
}

#[test]
fn each_specimen_is_its_own_muscle_and_shares_the_effects() {
    let (muscle, record) = specimens("clamped");
    let catalogue = Catalogue::builtin();
    let with = |model: Model, name: &str, values: &[f64]| {
        model.with(catalogue.find(name).unwrap(), Some(values)).unwrap()
    };
    let own = |moments: &[Moment]| {
        let moments = moments.iter().map(|m| Moment { specimen: 0, ..*m }).collect::<Vec<_>>();
        Record::from_moments(moments, vec![0.0; 24], std::iter::once(0..24).collect()).unwrap()
    };
    let full = |model: Model| with(with(model, "bladder-elasticity", &[2e5]), "coulomb-friction", &[7.0]);
    let both = full(of_both(&muscle));
    assert_eq!(both.parameters().len(), 2);
    let force = both.evaluate(&record, &both.start(), &Wanted::default()).unwrap().force;
    for (specimen, rows) in [("1", 0..24), ("2", 24..48)] {
        let alone = full(Model::new(&muscle.of_specimen(specimen).unwrap()));
        let record = own(&record.moments()[rows.clone()]);
        let found = alone.evaluate(&record, &alone.start(), &Wanted::default()).unwrap().force;
        for (a, b) in force[rows].iter().zip(found) {
            // 48 rows get a lattice, 24 don't.
            assert!((a - b).abs() < 1e-5 * b.abs().max(100.0), "{specimen}: {a} {b}");
        }
    }
    // A radius of 10.5 instead of 10 mm corresponds to 9.45 instead of 9 mm.
    let wide = with(of_both(&muscle), "radius-error", &[0.0105]);
    let force = wide.evaluate(&record, &wide.start(), &Wanted::default()).unwrap().force;
    let second = muscle.of_specimen("2").unwrap().with(Parameter::Radius, 0.00945).unwrap();
    let found = Model::new(&second).evaluate(&own(&record.moments()[24..]), &[], &Wanted::default()).unwrap();
    for (a, b) in force[24..].iter().zip(found.force) {
        assert!((a - b).abs() < 1e-5 * b.abs().max(100.0), "{a} {b}");
    }
    // Zero errors come with the mounting, so each specimen has its own.
    for (effect, numbers) in [("force-offset", 2), ("length-zero-error", 2), ("force-gain", 1)] {
        let model = of_both(&muscle).with(catalogue.find(effect).unwrap(), None).unwrap();
        assert_eq!(model.parameters().len(), numbers, "{effect}");
        let plain = of_both(&muscle.clone().without_specimens());
        assert_eq!(plain.with(catalogue.find(effect).unwrap(), None).unwrap().parameters().len(), 1);
    }
}

#[test]
fn a_specimen_like_the_muscle_changes_nothing() {
    let record = path(5);
    for muscle in muscles() {
        let length = muscle.get(Parameter::Length).unwrap();
        let same = muscle.clone().with_specimen("1", vec![(Parameter::Length, length)]).unwrap();
        for effect in Catalogue::builtin().iter() {
            let names = ["1".to_owned()];
            let model = |muscle| Model::new(muscle).for_specimens(&names).unwrap().with(effect, None);
            let (Ok(one), Ok(other)) = (model(&muscle), model(&same)) else { continue };
            if one.is_costly(&one.start()).unwrap_or(true) {
                continue;
            }
            let wanted = Wanted { parameters: (0..one.parameters().len()).collect(), readings: true };
            let found = [one, other].map(|m| m.evaluate(&record, &m.start(), &wanted).unwrap());
            let bits = |p: &bulge_model::Prediction| {
                [&p.force, &p.jacobian, &p.by_contraction]
                    .map(|v| v.iter().map(|x| x.to_bits()).collect::<Vec<_>>())
            };
            assert_eq!(bits(&found[0]), bits(&found[1]), "{}", effect.card().name);
        }
    }
}

fn one_effect(muscle: &Muscle, name: &str) -> Model {
    Model::new(muscle).with(Catalogue::builtin().find(name).unwrap(), None).unwrap()
}

fn at_contractions(pressure: f64, contractions: &[f64]) -> Record {
    let moments: Vec<Moment> = contractions.iter().map(|e| Moment::at_rest(pressure, *e)).collect();
    let rows = moments.len();
    Record::from_moments(moments, vec![0.0; rows], std::iter::once(0..rows).collect()).unwrap()
}

/// A frame that gives shortens the muscle by F/k: the force is that of the muscle alone at e + F/(k l0).
#[test]
fn a_soft_frame_is_a_shorter_muscle() {
    for muscle in muscles() {
        let model = one_effect(&muscle, "frame-compliance");
        let readings = [0.04, 0.08, 0.12];
        // 2 um/N, proportional to the force.
        let force =
            model.evaluate(&at_contractions(2e5, &readings), &[2e-6, 1.0], &Wanted::default()).unwrap().force;
        let length = muscle.length().si();
        let shorter: Vec<f64> = readings.iter().zip(&force).map(|(e, f)| e + 2e-6 * f / length).collect();
        let alone = Model::new(&muscle).evaluate(&at_contractions(2e5, &shorter), &[], &Wanted::default());
        for (force, alone) in force.iter().zip(alone.unwrap().force) {
            assert!((force - alone).abs() < 1e-9 * alone, "{force} {alone}");
        }
    }
}

/// Within a fit a row under load starts from its last contraction, or from the give of the row before: the forces are
/// those that it finds alone, also where the frame has become stiffer since, and where the next row is far away.
#[test]
fn a_contraction_under_load_does_not_depend_on_where_its_search_began() {
    for muscle in muscles() {
        let model = one_effect(&muscle, "frame-compliance");
        let record = at_contractions(2e5, &[0.04, 0.041, 0.042, 0.15, 0.02, 0.021]);
        let wanted = Wanted { parameters: vec![0, 1], readings: true };
        let warm = bulge_model::Warm::new();
        warm.hold();
        for compliance in [2e-6, 2.1e-6, 2e-7, 0.0] {
            let theta = [compliance, 0.8];
            let found = model.evaluate_warm(&record, &theta, &wanted, &warm).unwrap();
            let alone = model.evaluate(&record, &theta, &wanted).unwrap();
            for (found, alone) in found.force.iter().zip(&alone.force) {
                assert!((found - alone).abs() < 1e-12 * alone.abs(), "{found} {alone}");
            }
            for (found, alone) in found.jacobian.iter().zip(&alone.jacobian) {
                assert!((found - alone).abs() < 1e-6 * alone.abs() + 1e-9, "{found} {alone}");
            }
        }
    }
}

/// Fibres that slip out of their ends shorten nothing but the fibres, by the tension of all: F + p pi R^2 where a law has no shape.
#[test]
fn fibres_that_slip_out_of_their_ends_follow_the_tension() {
    let muscle = &muscles()[1];
    let geometry = LawGeometry::from(muscle);
    let law = LAWS.iter().find(|law| law.suits(Kind::Braided)).unwrap();
    let theta = law.start(&geometry, None);
    let (e, p, slip) = (0.05, 2e5, 1e-6);
    let bare = Model::from_law(muscle, law, &theta, true);
    let model = bare.with(Catalogue::builtin().find("end-slip").unwrap(), None).unwrap();
    let all = [&theta[..], &[slip, 1.0]].concat();
    let force = model.evaluate(&at_contractions(p, &[e]), &all, &Wanted::default()).unwrap().force[0];
    let tension = force + p * std::f64::consts::PI * geometry.radius.powi(2);
    let shorter = at_contractions(p, &[e + slip * tension / muscle.length().si()]);
    let alone = bare.evaluate(&shorter, &theta, &Wanted::default()).unwrap().force[0];
    assert!((force - alone).abs() < 1e-9 * alone.abs(), "{force} {alone}");
}

/// Fibres of unequal length: the mean over three nodes of Gauss and Hermite, at e and e +- sqrt(3) sigma.
#[test]
fn uneven_fibres_pull_the_mean_force() {
    let muscle = &muscles()[0];
    let (e, sigma) = (0.03, 0.004);
    let wide = sigma * 3.0_f64.sqrt();
    let mean = one_effect(muscle, "uneven-fibres");
    let mean = mean.evaluate(&at_contractions(2e5, &[e]), &[sigma], &Wanted::default()).unwrap().force[0];
    let alone = Model::new(muscle);
    let alone = alone
        .evaluate(&at_contractions(2e5, &[e - wide, e, e + wide]), &[], &Wanted::default())
        .unwrap()
        .force;
    let expected = alone[0] / 6.0 + 2.0 / 3.0 * alone[1] + alone[2] / 6.0;
    assert!((mean - expected).abs() < 1e-9 * expected, "{mean} {expected}");
}

#[test]
fn parameters_are_called_by_their_effect() {
    let model = one_effect(&muscles()[0], "frame-compliance");
    let labels: Vec<String> = model.parameters().iter().map(bulge_model::ModelParameter::label).collect();
    assert_eq!(labels, ["frame-compliance.compliance", "frame-compliance.power"]);
    let zero = one_effect(&muscles()[0], "length-zero-error");
    assert!((zero.parameters()[0].shown(4e-3) - 4.0).abs() < 1e-12, "millimetres are shown");
}

/// Rows of a specimen that a model was not made for are those of its last one.
#[test]
fn specimens_that_are_not_known_are_the_last_one() {
    let (muscle, record) = specimens("cylinder");
    let model = of_both(&muscle);
    assert_eq!(model.specimens(), ["1", "2"]);
    let model = model.with(Catalogue::builtin().find("force-offset").unwrap(), Some(&[3.0])).unwrap();
    let later: Vec<Moment> = record
        .moments()
        .iter()
        .map(|m| Moment { specimen: m.specimen + m.specimen.min(1) * 4, ..*m })
        .collect();
    let later = Record::from_moments(later, vec![0.0; 48], record.sweeps().to_vec()).unwrap();
    let [known, unknown] = [&record, &later]
        .map(|record| model.evaluate(record, &[3.0, 8.0], &Wanted::default()).unwrap().force);
    assert!(known.iter().zip(&unknown).all(|(a, b)| a.to_bits() == b.to_bits()));
}

/// Rows take an integration where ends are clamped; cylinders and laws have formulas.
#[test]
fn clamped_braids_are_costly() {
    let costly = |model: &Model| model.is_costly(&model.start()).unwrap();
    for (ends, expected) in [("cylinder", false), ("clamped", true)] {
        let muscle = specimens(ends).0;
        assert_eq!(costly(&Model::new(&muscle)), expected);
        let law = Law::find("tondu-lopez").unwrap();
        let start = law.start(&LawGeometry::from(&muscle), None);
        assert!(!costly(&Model::from_law(&muscle, law, &start, true)));
    }
}
