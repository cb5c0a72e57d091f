//! Simulated measurements: the model without noise, the statistics of the noise, seeds, shortened ranges, rig
//! errors.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use crate::support::truth;
use bulge_effects::Catalogue;
use bulge_inference::{
    Block, Path, Protocol, ReadingNoise, ReadingSteps, RigErrors, Simulation, simulate, simulate_with,
};
use bulge_model::Model;
use bulge_muscles::{Muscle, Quantity, from_toml, to_toml};

/// A cylinder with a closed form: F = pi r0^2 p (a (1 - e)^2 - b), a = 3/tan^2 alpha, b = 1/sin^2 alpha; it pushes beyond e = 1 - sqrt(b/a).
const BRAID: &str = "name = \"trial\"\nkind = \"braided\"\nlength = \"250 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\nends = \"cylinder\"\n";
const WIDTHS: &str = "[instruments]\nforce = { zero = \"5 N\", gain = \"1 %\" }\npressure = { zero = \"500 Pa\" }\nlength = { zero = \"0.2 mm\", gain = \"0.5 %\" }\n";

fn muscle(more: &str) -> Muscle {
    from_toml(&format!("{BRAID}{more}"), "m.toml").unwrap()
}

fn force(pressure: f64, e: f64) -> f64 {
    let angle = 25.0_f64.to_radians();
    let (a, b) = (3.0 / angle.tan().powi(2), 1.0 / angle.sin().powi(2));
    std::f64::consts::PI * 1e-4 * pressure * (a * (1.0 - e).powi(2) - b)
}

fn friction(newton: f64) -> (Model, Vec<f64>) {
    truth(&muscle(""), &[("coulomb-friction", &[newton])])
}

fn plain(protocol: &Protocol, seed: u64) -> Simulation {
    simulate(&Model::new(&muscle("")), &[], protocol, seed).unwrap()
}

fn loops(rows: u32, cycles: u32) -> Block {
    Block { rows, cycles, ..Block::loops(vec![2e5, 3e5], [0.01, 0.15], 50.0) }
}

fn noisy(block: Block, noise: ReadingNoise) -> Protocol {
    Protocol { noise, ..Protocol::new(vec![block]) }
}

/// Force readings minus exact forces.
fn errors(found: &Simulation) -> Vec<f64> {
    found.data.force().iter().zip(found.exact.force()).map(|(read, exact)| read - exact).collect()
}

fn sd(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt()
}

/// A standard deviation of `n` independent normal numbers, within 3 of its own standard deviations.
#[track_caller]
fn is_sd(values: &[f64], expected: f64, n: f64) {
    let found = sd(values);
    assert!((found / expected - 1.0).abs() < 3.0 / (2.0 * n).sqrt(), "{found} is not {expected}");
}

#[test]
fn without_noise_it_is_the_model() {
    let (model, theta) = friction(14.0);
    let found = simulate(&model, &theta, &Protocol::new(vec![loops(50, 2)]), 1).unwrap();
    assert_eq!((found.data.len(), found.data.sweeps().len(), found.truth.rows), (200, 2, 200));
    for (row, moment) in found.exact.moments().iter().enumerate() {
        let phase = row % 50;
        let direction = if phase == 0 && row % 100 > 0 || phase > 25 { -1.0 } else { 1.0 };
        let expected = force(moment.pressure, moment.contraction) - 14.0 * direction;
        assert!(
            (found.data.force()[row] - expected).abs() < 1e-4,
            "row {row}: {} N",
            found.data.force()[row]
        );
        assert!((found.data.pressure()[row] - moment.pressure).abs() < 1e-2);
        assert!((found.data.contraction(0.25)[row] - moment.contraction).abs() < 1e-8);
    }
    assert_eq!(found.truth.effects.len(), 1);
    let number = &found.truth.effects[0].numbers[0];
    assert_eq!(
        (number.key.as_str(), number.unit.as_str(), number.value.to_string().as_str()),
        ("force", "N", "14")
    );
    assert_eq!(found.muscle, muscle(""));
}

#[test]
fn noise_has_the_stated_size() {
    let noise = ReadingNoise { force_n: 2.0, pressure_pa: 100.0, length_m: 20e-6, ..ReadingNoise::default() };
    let found = plain(&noisy(loops(5000, 1), noise), 3);
    is_sd(&errors(&found), 2.0, 1e4);
    let moments = found.exact.moments();
    let pressures: Vec<f64> =
        found.data.pressure().iter().zip(moments).map(|(p, m)| p - m.pressure).collect();
    is_sd(&pressures, 100.0, 1e4);
    let lengths = found.data.contraction(0.25);
    let lengths: Vec<f64> = lengths.iter().zip(moments).map(|(e, m)| 0.25 * (e - m.contraction)).collect();
    is_sd(&lengths, 20e-6, 1e4);
    // A mean of 0, within 3 standard deviations.
    assert!(errors(&found).iter().sum::<f64>().abs() / 1e4 < 3.0 * 2.0 / 100.0);
    // The instruments of the muscle state the noise.
    let stated = found.muscle.instruments();
    assert!(
        (stated.force.unwrap().noise() - 2.0).abs() < 1e-12
            && (stated.length.unwrap().noise() - 20e-6).abs() < 1e-15
    );
    let tails = plain(&noisy(loops(5000, 1), ReadingNoise { tails: Some(6.0), ..noise }), 3);
    let heavy = errors(&tails);
    // Kurtosis 3 + 6/(6 - 4) of Student's t; its estimate has a large scatter, and the scatter of the
    // variance follows from it.
    assert!((sd(&heavy) / 2.0 - 1.0).abs() < 3.0 * (5.0_f64 / 4e4).sqrt(), "{}", sd(&heavy));
    let kurtosis = heavy.iter().map(|e| (e / 2.0).powi(4)).sum::<f64>() / 1e4;
    assert!(kurtosis > 4.0, "{kurtosis}");
}

#[test]
fn correlated_noise_and_offsets_follow_their_law() {
    // Rows 10 ms apart, correlated over 50 ms.
    let noise = ReadingNoise { correlated_n: 3.0, correlation_time_s: 0.05, ..ReadingNoise::default() };
    let found = errors(&plain(&noisy(loops(5000, 2), noise), 5));
    let kept = (-0.2_f64).exp();
    // This many independent values have the same scatter of the variance.
    is_sd(&found, 3.0, 2e4 * (1.0 - kept * kept) / (1.0 + kept * kept));
    let lag = |k: usize| found[..10_000 - k].iter().zip(&found[k..10_000]).map(|(a, b)| a * b).sum::<f64>();
    let [one, five] = [lag(1) / lag(0), lag(5) / lag(0)];
    assert!((one - kept).abs() < 0.02 && (five - kept.powi(5)).abs() < 0.07, "{one} {five}");
    let offsets = ReadingNoise { offset_n: 4.0, ..ReadingNoise::default() };
    let found = plain(&noisy(Block { repeats: 300, ..loops(4, 1) }, offsets), 5);
    let of_sweeps: Vec<f64> = found.exact.sweeps().iter().map(|sweep| errors(&found)[sweep.start]).collect();
    is_sd(&of_sweeps, 4.0, 600.0);
    let within = errors(&found)[..4].iter().map(|e| (e - of_sweeps[0]).abs()).fold(0.0, f64::max);
    assert!(of_sweeps.len() == 600 && within < 2e-4, "{within}");
}

#[test]
fn a_seed_is_a_data_set() {
    let noise =
        ReadingNoise { force_n: 2.0, correlated_n: 1.0, correlation_time_s: 5.0, ..ReadingNoise::default() };
    let protocol = noisy(loops(50, 1), noise);
    let first = plain(&protocol, 7);
    assert_eq!(first.csv, plain(&protocol, 7).csv);
    assert_ne!(errors(&first), errors(&plain(&protocol, 8)));
    let single = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    assert_eq!(first.csv, single.install(|| plain(&protocol, 7).csv));
    // Noise of the pressure changes no force, and another pressure changes no sweep before it.
    let more = Protocol { noise: ReadingNoise { pressure_pa: 50.0, ..noise }, ..protocol.clone() };
    assert_eq!(plain(&more, 7).data.force(), first.data.force());
    let mut longer = protocol;
    longer.blocks[0].pressures_pa.push(4e5);
    assert_eq!(plain(&longer, 7).data.force()[..100], *first.data.force());
}

#[test]
fn readings_come_in_steps() {
    let steps = ReadingSteps { force_n: 5.0, pressure_pa: 250.0, length_m: 1e-3 };
    let found = plain(&Protocol { steps, ..Protocol::new(vec![loops(50, 1)]) }, 1);
    let is_whole = |value: f64| (value - value.round()).abs() < 1e-4;
    assert!(found.data.force().iter().all(|f| is_whole(f / 5.0)));
    assert!(found.data.pressure().iter().all(|p| is_whole(p / 250.0)));
    assert!(found.data.contraction(0.25).iter().all(|e| is_whole(250.0 * e)));
    assert!(errors(&found).iter().all(|e| e.abs() <= 2.5 + 1e-4));
    assert!((found.muscle.instruments().force.unwrap().noise() - 5.0 / 12.0_f64.sqrt()).abs() < 1e-3);
}

#[test]
fn sweeps_end_where_the_muscle_would_push() {
    // It pushes beyond 36.2 % and, with friction, already before that while shortening.
    let (model, theta) = friction(14.0);
    let block = Block { contraction: [0.01, 0.5], cycles: 2, rows: 200, ..loops(50, 1) };
    let found = simulate(&model, &theta, &Protocol::new(vec![block.clone()]), 1).unwrap();
    assert_eq!((found.data.len(), found.truth.ended.len()), (800, 2));
    let limit =
        |p: f64| (0..5000).map(|i| 1e-4 * f64::from(i)).take_while(|e| force(p, *e) > 14.0).last().unwrap();
    for ended in &found.truth.ended {
        let [low, high] = ended.reached.unwrap();
        let most = limit(ended.pressure_pa);
        assert!((low - 0.01).abs() < 1e-12 && high <= most + 1e-4 && high > most - 0.012, "{high} of {most}");
    }
    assert!(found.exact.force().iter().all(|force| *force > 0.0));
    // In a map, rows are left out, and the plan says the same.
    let map = Protocol::new(vec![Block { path: Path::Static, rows: 50, cycles: 1, ..block }]);
    let left = plain(&map, 1);
    let expected = map
        .moments(&muscle(""))
        .unwrap()
        .moments()
        .iter()
        .filter(|m| force(m.pressure, m.contraction) > 0.0)
        .count();
    assert_eq!(
        (left.data.len(), left.truth.ended.iter().map(|e| e.count).sum::<usize>()),
        (expected, 100 - expected)
    );
    assert_eq!(map.moments_within(&Model::new(&muscle("")), &[]).unwrap().len(), expected);
    let nowhere = Protocol::new(vec![Block { contraction: [0.4, 0.5], ..loops(50, 1) }]);
    let message = simulate(&model, &theta, &nowhere, 1).unwrap_err().to_string();
    assert!(message.contains("the muscle pulls nowhere"), "{message}");
}

#[test]
fn fillings_begin_where_the_muscle_pulls() {
    // With a load cell that reads 30 N less, readings are positive from 30 N on, and pressures from that force.
    let (model, theta) = truth(&muscle(""), &[("force-offset", &[-30.0])]);
    let block = Block { rows: 200, ..Block::isometric([0.1e5, 5e5], vec![0.05, 0.2], 40.0) };
    let found = simulate(&model, &theta, &Protocol::new(vec![block]), 1).unwrap();
    assert!(found.exact.force().iter().all(|force| *force > 0.0));
    assert_eq!(found.truth.ended.len(), 2);
    for (ended, held) in found.truth.ended.iter().zip([0.05, 0.2]) {
        let [low, high] = ended.pressure_reached_pa.unwrap();
        let least = 30.0 / force(1.0, held);
        // Rows of a filling, of the thinned plan at first, are some kilopascals apart.
        assert!(low > least && low < least + 2e4, "{held}: {low} Pa, not {least}");
        assert!((high - 5e5).abs() < 1e-6, "{high}");
    }
}

#[test]
fn rig_errors_are_drawn_from_the_instruments() {
    let protocol = Protocol { rig: RigErrors::Drawn, ..Protocol::new(vec![loops(50, 1)]) };
    let (mut zeros, mut gains) = (Vec::new(), Vec::new());
    for seed in 0..200 {
        let found = simulate(&Model::new(&muscle(WIDTHS)), &[], &protocol, seed).unwrap();
        let rig = found.truth.rig;
        zeros.push(rig.force_zero_n);
        gains.push(rig.length_gain);
        let moment = found.exact.moments()[20];
        let expected = found.exact.force()[20] * (1.0 + rig.force_gain) + rig.force_zero_n;
        assert!((found.data.force()[20] - expected).abs() < 1e-4);
        assert!((found.data.pressure()[20] - moment.pressure - rig.pressure_zero_pa).abs() < 0.01);
        let e = moment.contraction * (1.0 + rig.length_gain) - rig.length_zero_m / 0.25;
        assert!((found.data.contraction(0.25)[20] - e).abs() < 1e-8);
        assert!(rig.pressure_gain.abs() < 1e-15);
        // The stated widths stay.
        assert_eq!(to_toml(&found.muscle), to_toml(&muscle(WIDTHS)));
        assert!((found.muscle.instruments().length.unwrap().gain().si() - 0.005).abs() < 1e-15);
    }
    is_sd(&zeros, 5.0, 200.0);
    is_sd(&gains, 0.005, 200.0);
    let message = simulate(&Model::new(&muscle("")), &[], &protocol, 1).unwrap_err().to_string();
    assert!(
        message.contains("`rig = \"drawn\"` needs widths") && message.contains("[instruments]"),
        "{message}"
    );
}

#[test]
fn an_effect_that_a_protocol_can_not_show_is_refused() {
    let (model, theta) = friction(14.0);
    let map = Protocol::new(vec![Block::map(vec![2e5], [0.01, 0.2], 20)]);
    let message = simulate(&model, &theta, &map, 1).unwrap_err().to_string();
    assert!(message.contains("`coulomb-friction` needs a path"), "{message}");
}

#[test]
fn specimens_of_the_muscle_are_simulated_by_their_names() {
    let muscle = muscle("[specimens.wide]\nradius = \"11 mm\"\n[specimens.short]\nlength = \"100 mm\"\n");
    let block = |specimens| Block { specimens, ..loops(30, 1) };
    let of = |specimens| {
        simulate_with(&muscle, &Catalogue::builtin(), &Protocol::new(vec![block(specimens)]), &[], 1)
    };
    let both = of(2).unwrap();
    assert_eq!(both.data.specimens(), ["wide", "short"]);
    assert_eq!(both.muscle.specimens(), muscle.specimens());
    for (row, moment) in both.exact.moments().iter().enumerate() {
        let factor = if moment.specimen == 0 { 1.21 } else { 1.0 };
        let expected = factor * force(moment.pressure, moment.contraction);
        assert!((both.exact.force()[row] - expected).abs() < 1e-9 * expected, "{row}");
    }
    // A protocol with one specimen takes the muscle as stated.
    let one = of(1).unwrap();
    assert!(one.muscle.specimens().is_empty() && one.data.specimens() == ["1"]);
    let message = of(3).err().unwrap().to_string();
    assert!(message.contains("has 3 specimens, but trial states 2; write `specimens = 2`"), "{message}");
}
