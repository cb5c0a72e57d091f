//! Noise laws: whitening against dense matrices, laws recovered from simulated noise, and no claim beyond
//! white noise where there is none.

#![expect(clippy::unwrap_used, reason = "a test stops where something is missing")]

use bulge_effects::Moment;
use bulge_inference::{CorrelationTime, NoiseError, NoiseLaw, NoiseSource, Random, Whitening};
use bulge_model::Record;

/// Sweeps of `rows` rows at 0.05 s, with steps that vary by a quarter.
fn record(sweeps: usize, rows: usize) -> Record {
    let moments: Vec<Moment> = (0..sweeps * rows)
        .map(|i| {
            let clock = 0.05 * (i as f64 + 0.25 * (i % 3) as f64) + 0.01;
            let x = (i % rows) as f64 / rows as f64;
            Moment {
                direction: if x < 0.5 { 1.0 } else { -1.0 },
                clock,
                begins: i % rows == 0,
                ..Moment::at_rest(1e5 * (1 + i / rows) as f64, 0.2 * (1.0 - (2.0 * x - 1.0).abs()))
            }
        })
        .collect();
    let ranges = (0..sweeps).map(|s| s * rows..(s + 1) * rows).collect();
    Record::from_moments(moments, vec![0.0; sweeps * rows], ranges).unwrap()
}

fn law(white_n: f64, correlated_n: f64, seconds: f64, offset_n: f64) -> NoiseLaw {
    NoiseLaw {
        correlated_n,
        time: (correlated_n > 0.0).then_some(CorrelationTime::Seconds(seconds)),
        offset_n,
        ..NoiseLaw::white(white_n, NoiseSource::Instruments, 0.0, String::new())
    }
}

/// A smooth surface in pressure and contraction for each direction: 12 columns.
fn design(record: &Record) -> Vec<f64> {
    let columns = |m: &Moment| {
        let (p, e) = (m.pressure / 5e5, 10.0 * m.contraction - 1.0);
        let smooth = [1.0, e, e * e, p, p * e, p * e * e];
        smooth.into_iter().chain(smooth.map(|x| x * m.direction)).collect::<Vec<f64>>()
    };
    record.moments().iter().flat_map(columns).collect()
}

fn dense(law: &NoiseLaw, record: &Record, rows: &[usize], known: &[f64]) -> Vec<Vec<f64>> {
    let sweep = |row: usize| record.sweeps().iter().position(|s| s.contains(&row));
    let time = law.time.map_or(1.0, CorrelationTime::value);
    let seconds = matches!(law.time, Some(CorrelationTime::Seconds(_)));
    let at = |row: usize| if seconds { record.moments()[row].clock } else { row as f64 };
    let covariance = |i: usize, j: usize| {
        let mut k = 0.0;
        if sweep(i) == sweep(j) {
            k += law.offset_n.powi(2) + law.correlated_n.powi(2) * (-(at(i) - at(j)).abs() / time).exp();
        }
        if i == j { k + law.white_n.powi(2) + known[i] } else { k }
    };
    rows.iter().map(|i| rows.iter().map(|j| covariance(*i, *j)).collect()).collect()
}

/// Lower Cholesky factor.
fn factor(k: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let n = k.len();
    let mut l = vec![vec![0.0; n]; n];
    for i in 0..n {
        for j in 0..=i {
            let sum: f64 = k[i][j] - (0..j).map(|m| l[i][m] * l[j][m]).sum::<f64>();
            l[i][j] = if i == j { sum.sqrt() } else { sum / l[j][j] };
        }
    }
    l
}

fn solve(l: &[Vec<f64>], mut b: Vec<f64>) -> Vec<f64> {
    for i in 0..b.len() {
        b[i] = (b[i] - (0..i).map(|j| l[i][j] * b[j]).sum::<f64>()) / l[i][i];
    }
    b
}

#[test]
fn whitening_is_the_inverse_of_the_dense_factor() {
    let record = record(4, 30);
    let n = record.len();
    let used: Vec<bool> = (0..n).map(|i| i % 7 != 3 && !(30..33).contains(&i)).collect();
    let known: Vec<f64> = (0..n).map(|i| 0.3 * (i % 5) as f64).collect();
    let rows: Vec<usize> = (0..n).filter(|i| used[*i]).collect();
    let in_rows = NoiseLaw { time: Some(CorrelationTime::Rows(4.0)), ..law(0.2, 1.5, 1.0, 0.4) };
    for law in [
        law(1.3, 0.0, 1.0, 0.0),
        law(0.7, 2.0, 0.3, 0.0),
        law(0.5, 0.0, 1.0, 3.0),
        law(0.4, 1.0, 0.6, 30.0),
        law(0.01, 5.0, 3.0, 1.0),
        in_rows,
    ] {
        let l = factor(&dense(&law, &record, &rows, &known));
        let whitening = Whitening::new(&law, &record, &used, &known).unwrap();
        let mut random = Random::new(3, 0);
        let mut columns: Vec<f64> = (0..3 * rows.len()).map(|_| random.normal()).collect();
        let expected: Vec<Vec<f64>> =
            (0..3).map(|c| solve(&l, columns.iter().skip(c).step_by(3).copied().collect())).collect();
        whitening.apply(&mut columns).unwrap();
        for (i, row) in columns.chunks_exact(3).enumerate() {
            for (c, value) in row.iter().enumerate() {
                assert!((value - expected[c][i]).abs() < 1e-10 * (1.0 + value.abs()), "{law:?}: {value}");
            }
        }
        let log_determinant = 2.0 * (0..l.len()).map(|i| l[i][i].ln()).sum::<f64>();
        assert!((whitening.log_determinant() - log_determinant).abs() < 1e-10 * rows.len() as f64);
        let ones: f64 = solve(&l, vec![1.0; rows.len()]).iter().map(|x| x * x).sum();
        let single: f64 =
            dense(&law, &record, &rows, &known).iter().enumerate().map(|(i, row)| 1.0 / row[i]).sum();
        let effective = (rows.len() as f64 * ones / single).min(rows.len() as f64);
        assert!((whitening.effective_rows() / effective - 1.0).abs() < 1e-9);
    }
}

#[test]
fn bytes_do_not_depend_on_threads_and_effective_rows_have_their_limits() {
    let record = record(20, 50);
    let used = vec![true; 1000];
    let some = law(1.0, 1.0, 0.5, 1.0);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let noise = some.simulate(&record, &used, &[], 5);
        pool.install(|| NoiseLaw::estimate(&record, &used, &[], &design(&record), &noise).unwrap())
    };
    assert_eq!(format!("{:?}", run(1)), format!("{:?}", run(2)));
    let effective = |law| Whitening::new(&law, &record, &used, &[]).unwrap().effective_rows();
    assert!((effective(law(2.0, 0.0, 1.0, 0.0)) - 1000.0).abs() < 1e-9);
    // Rows with a correlation of 1 - 1e-6 within a sweep: each sweep counts as one row.
    assert!((effective(law(1e-3, 0.0, 1.0, 1.0)) - 20.0).abs() < 1e-3);
    // A Markov chain with correlation f: (1 + (n - 1) (1 - f)/(1 + f)) rows in each sweep of n.
    let f = (-0.25_f64).exp();
    let rows = NoiseLaw { time: Some(CorrelationTime::Rows(4.0)), ..law(1e-6, 1.0, 1.0, 0.0) };
    assert!((effective(rows) / (20.0 * (1.0 + 49.0 * (1.0 - f) / (1.0 + f))) - 1.0).abs() < 1e-6);
}

/// Means over seeds of (white, correlated, ln time, offset), with the standard errors of the means.
fn found(truth: &NoiseLaw, record: &Record, known: &[f64]) -> [(f64, f64); 4] {
    let used = vec![true; record.len()];
    let design = design(record);
    let all: Vec<[f64; 4]> = (0..20)
        .map(|seed| {
            let noise = truth.simulate(record, &used, known, seed);
            let law = NoiseLaw::estimate(record, &used, known, &design, &noise).unwrap();
            let time = law.time.map_or(f64::NAN, |time| time.value().ln());
            [law.white_n, law.correlated_n, time, law.offset_n]
        })
        .collect();
    std::array::from_fn(|k| {
        let mean = all.iter().map(|x| x[k]).sum::<f64>() / 20.0;
        let variance = all.iter().map(|x| (x[k] - mean).powi(2)).sum::<f64>() / 19.0;
        (mean, (variance / 20.0).sqrt())
    })
}

fn assert_near(name: &str, (mean, error): (f64, f64), truth: f64) {
    assert!(
        (mean - truth).abs() < 4.0 * error + 0.03 * truth.abs(),
        "{name}: {mean} +- {error}, not {truth}"
    );
    assert!(error < 0.12 * truth.abs().max(1.0), "{name}: +- {error}");
}

#[test]
fn laws_are_found_again() {
    let record = record(10, 120);
    let none = &[][..];
    let [white, correlated, _, offset] = found(&law(2.0, 0.0, 1.0, 0.0), &record, none);
    assert_near("white alone", white, 2.0);
    assert!(correlated.0 < 0.05 && offset.0 < 0.05, "{correlated:?} {offset:?}");
    let [white, correlated, time, offset] = found(&law(1.0, 2.0, 0.4, 0.0), &record, none);
    assert_near("white", white, 1.0);
    assert_near("correlated", correlated, 2.0);
    assert_near("time", (time.0 + 2.0, time.1), 0.4_f64.ln() + 2.0);
    assert!(offset.0 < 0.2, "{offset:?}");
    let [white, correlated, _, offset] = found(&law(1.0, 0.0, 1.0, 1.5), &record, none);
    assert_near("white beside offsets", white, 1.0);
    assert_near("offsets", offset, 1.5);
    assert!(correlated.0 < 0.1, "{correlated:?}");
    let [white, correlated, time, offset] = found(&law(1.0, 1.5, 0.3, 2.5), &record, none);
    assert_near("white of a mixture", white, 1.0);
    assert_near("correlated of a mixture", correlated, 1.5);
    assert_near("time of a mixture", (time.0 + 2.0, time.1), 0.3_f64.ln() + 2.0);
    assert_near("offsets of a mixture", offset, 2.5);
}

#[test]
fn input_variances_come_on_top() {
    let record = record(10, 120);
    let known: Vec<f64> = (0..record.len()).map(|i| if i % 120 < 40 { 16.0 } else { 0.25 }).collect();
    let [white, correlated, _, offset] = found(&law(1.0, 0.0, 1.0, 0.0), &record, &known);
    assert_near("white", white, 1.0);
    assert!(correlated.0 < 0.05 && offset.0 < 0.05, "{correlated:?} {offset:?}");
    let [white, correlated, time, _] = found(&law(1.0, 2.0, 0.4, 0.0), &record, &known);
    assert_near("white beside correlation", white, 1.0);
    assert_near("correlated", correlated, 2.0);
    assert_near("time", (time.0 + 2.0, time.1), 0.4_f64.ln() + 2.0);
}

#[test]
fn white_noise_is_not_taken_for_correlated_even_with_heavy_tails() {
    let record = record(6, 60);
    let used = vec![true; record.len()];
    let design = design(&record);
    let alarms = |draw: &dyn Fn(&mut Random) -> f64, stream| {
        let mut random = Random::new(11, stream);
        (0..200)
            .filter(|_| {
                let noise: Vec<f64> = used.iter().map(|_| draw(&mut random)).collect();
                !NoiseLaw::estimate(&record, &used, &[], &design, &noise).unwrap().is_white()
            })
            .count()
    };
    let (normal, heavy) = (alarms(&Random::normal, 0), alarms(&|r| r.student(4.0), 1));
    assert!(normal <= 10 && heavy <= 10, "{normal} and {heavy} of 200");
}

#[test]
fn what_the_model_can_explain_changes_nothing() {
    let record = record(8, 80);
    let used = vec![true; record.len()];
    let columns = design(&record);
    let noise = law(1.0, 2.0, 0.4, 1.0).simulate(&record, &used, &[], 2);
    let plain = NoiseLaw::estimate(&record, &used, &[], &columns, &noise).unwrap();
    let shifted: Vec<f64> = noise
        .iter()
        .zip(columns.chunks_exact(12))
        .map(|(y, row)| y + 50.0 * row[4] - 300.0 * row[7])
        .collect();
    // A column added again, in combination and in another unit.
    let twice: Vec<f64> = columns.chunks_exact(12).flat_map(|r| [r, &[1e6 * r[3] - r[2]]].concat()).collect();
    let other = NoiseLaw::estimate(&record, &used, &[], &twice, &shifted).unwrap();
    let near = |a: f64, b: f64| (a / b - 1.0).abs() < 0.01;
    assert!(
        near(plain.white_n, other.white_n) && near(plain.correlated_n, other.correlated_n),
        "{plain:?} {other:?}"
    );
    assert_eq!(plain.degrees_of_freedom.to_bits(), other.degrees_of_freedom.to_bits());
}

#[test]
fn what_data_can_not_tell_is_left_out_and_said() {
    let estimate = |record: &Record, noise: &[f64]| {
        let ones = vec![1.0; record.len()];
        NoiseLaw::estimate(record, &vec![true; record.len()], &[], &ones, noise).unwrap()
    };
    let truth = law(1.0, 3.0, 1.0, 3.0);
    let noisy = |record: &Record| truth.simulate(record, &vec![true; record.len()], &[], 1);
    let few = record(1, 20);
    let found = estimate(&few, &noisy(&few));
    assert!(found.is_white() && found.says.contains("below 30 degrees of freedom"), "{found:?}");
    let single = record(1, 400);
    let found = estimate(&single, &noisy(&single));
    assert!(
        found.offset_n == 0.0 && found.correlated_n > 1.0 && found.says.contains("fewer than three sweeps")
    );
    let exact = estimate(&single, &[5.0; 400]);
    assert!(exact.is_white() && exact.white_n < 1e-9 && exact.says.contains("rounding"), "{exact:?}");
    let still = |clock: bool, direction: f64| {
        let moments = (0..300)
            .map(|i| Moment {
                direction,
                clock: if clock { 0.1 * f64::from(i) } else { 0.0 },
                begins: i == 0,
                ..Moment::at_rest(1e5, 0.01)
            })
            .collect();
        Record::from_moments(moments, vec![0.0; 300], std::iter::once(0..300).collect()).unwrap()
    };
    let chain = law(1.0, 3.0, 1.0, 0.0).simulate(&still(true, 1.0), &[true; 300], &[], 4);
    let map = estimate(&still(true, 0.0), &chain);
    assert!(map.is_white() && map.says.contains("static map"), "{map:?}");
    // 10 rows are a second.
    let Some(CorrelationTime::Rows(rows)) = estimate(&still(false, 1.0), &chain).time else {
        panic!("no rows")
    };
    assert!((4.0..25.0).contains(&rows), "{rows}");
}

#[test]
fn large_records_are_cut_and_keep_their_law() {
    let record = record(12, 2000);
    let used = vec![true; record.len()];
    let noise = law(1.0, 2.0, 0.5, 0.0).simulate(&record, &used, &[], 9);
    let found = NoiseLaw::estimate(&record, &used, &[], &design(&record), &noise).unwrap();
    assert!(found.degrees_of_freedom <= 5000.0, "{found:?}");
    assert!(found.says.ends_with("against white noise, p < 1e-16"), "{}", found.says);
    assert!((found.correlated_n / 2.0 - 1.0).abs() < 0.12 && (found.white_n - 1.0).abs() < 0.06, "{found:?}");
}

#[test]
fn impossible_questions_are_answered_with_numbers() {
    let record = record(2, 40);
    let used = vec![true; 80];
    let whitening = |law: &NoiseLaw, known: &[f64]| Whitening::new(law, &record, &used, known);
    let twin = NoiseLaw { white_n: 0.0, ..law(1.0, 0.0, 1.0, 2.0) };
    assert!(matches!(whitening(&twin, &[]), Err(NoiseError::Singular { row: 1, .. })));
    assert!(matches!(whitening(&law(-1.0, 0.0, 1.0, 0.0), &[]), Err(NoiseError::Value { place: 0, .. })));
    assert!(matches!(whitening(&law(1.0, 1.0, 0.0, 0.0), &[]), Err(NoiseError::Value { .. })));
    assert!(matches!(
        whitening(&law(1.0, 0.0, 1.0, 0.0), &[1.0; 3]),
        Err(NoiseError::Lengths { given: 3, .. })
    ));
    assert!(matches!(whitening(&law(1.0, 0.0, 1.0, 0.0), &[f64::NAN; 80]), Err(NoiseError::Value { .. })));
    let white = whitening(&law(1.0, 0.0, 1.0, 0.0), &[]).unwrap();
    assert!(matches!(white.apply(&mut [0.0; 81]), Err(NoiseError::Lengths { expected: 160, .. })));
    let mut random = Random::new(0, 0);
    let square: Vec<f64> = (0..80 * 80).map(|_| random.normal()).collect();
    let all = NoiseLaw::estimate(&record, &used, &[], &square, &[1.0; 80]);
    assert_eq!(all, Err(NoiseError::TooFewRows { rows: 80, columns: 80 }));
}
