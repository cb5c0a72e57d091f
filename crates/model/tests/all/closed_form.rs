//! Straight fibres in closed form within a fit. Each row starts from the previous row or from its own last
//! equilibrium.

#![expect(clippy::unwrap_used, reason = "a test that cannot be set up fails")]

use bulge_effects::{Catalogue, Moment};
use bulge_model::{Model, Prediction, Record, Wanted, Warm};
use bulge_muscles::preset;

/// Triangles between 0.5 and 35 % at three pressures. The pressure jumps from row to row where a sweep ends.
fn record(rows: usize) -> Record {
    let moment = |i: usize| {
        let part = (i % 100) as f64 / 50.0;
        let up = part < 1.0;
        let contraction = 0.005 + 0.345 * if up { part } else { 2.0 - part };
        Moment {
            direction: if up { 1.0 } else { -1.0 },
            begins: i.is_multiple_of(100),
            ..Moment::at_rest(1e5 * (1 + (i / 100) % 3) as f64, contraction)
        }
    };
    let sweeps = (0..rows).step_by(100).map(|start| start..(start + 100).min(rows)).collect();
    Record::from_moments((0..rows).map(moment).collect(), vec![0.0; rows], sweeps).unwrap()
}

fn model() -> Model {
    let catalogue = Catalogue::builtin();
    ["coulomb-friction", "fibre-stretch", "length-zero-error", "fibre-length"]
        .iter()
        .fold(Model::new(&preset("ppam-2-r16").unwrap()), |model, name| {
            model.with(catalogue.find(name).unwrap(), None).unwrap()
        })
}

/// Parameter values as a search tries them, with small and large steps.
fn trials(model: &Model) -> Vec<Vec<f64>> {
    let numbers = |friction: f64, stretch: f64, zero: f64, excess: f64| vec![friction, stretch, zero, excess];
    assert_eq!(model.parameters().len(), 4);
    vec![
        numbers(10.0, 2e-6, 0.0, 0.0),
        numbers(12.0, 2.001e-6, 1e-5, 1e-5),
        numbers(12.0, 1e-5, 5e-4, 0.01),
        numbers(12.0, 2e-7, 0.0, 0.0),
        numbers(12.0, 0.0, 0.0, 0.0),
        numbers(12.0, 2e-6, 4e-4, 0.0),
    ]
}

fn wanted(model: &Model) -> Wanted {
    Wanted { parameters: (0..model.parameters().len()).collect(), readings: true }
}

#[test]
fn warm_forces_and_derivatives_are_the_cold_ones() {
    let (model, record, warm) = (model(), record(900), Warm::new());
    for theta in trials(&model) {
        let cold = model.evaluate(&record, &theta, &wanted(&model)).unwrap();
        let found = model.evaluate_warm(&record, &theta, &wanted(&model), &warm).unwrap();
        let close = |a: &[f64], b: &[f64], part: f64| {
            assert_eq!(a.len(), b.len());
            let size = b.iter().map(|x| x.abs()).fold(0.0, f64::max);
            for (a, b) in a.iter().zip(b) {
                assert!((a - b).abs() <= part * (b.abs() + 1e-3 * size), "{a} {b}");
            }
        };
        close(&found.force, &cold.force, 1e-11);
        close(&found.by_pressure, &cold.by_pressure, 1e-5);
        close(&found.by_contraction, &cold.by_contraction, 1e-5);
        for j in 0..4 {
            let column =
                |of: &Prediction| -> Vec<f64> { of.jacobian.iter().skip(j).step_by(4).copied().collect() };
            close(&column(&found), &column(&cold), 1e-5);
        }
    }
}

#[test]
fn bytes_are_the_same_on_any_number_of_threads() {
    let (model, record) = (model(), record(3000));
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let warm = Warm::new();
            let evaluate =
                |theta: Vec<f64>| model.evaluate_warm(&record, &theta, &wanted(&model), &warm).unwrap();
            let bits = |all: Vec<f64>| all.into_iter().map(f64::to_bits).collect::<Vec<_>>();
            trials(&model)
                .into_iter()
                .map(evaluate)
                .map(|p| (bits(p.force), bits(p.jacobian)))
                .collect::<Vec<_>>()
        })
    };
    assert!(run(1) == run(3), "the bytes differ");
}
