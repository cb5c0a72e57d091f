//! Whole answers about small tests of very different muscles and rigs, number by number, as kept in `kept/NAME.json`.
//! That they are right is what the other tests verify; here every change of a number is seen, and its size.
//!
//! `BULGE_KEEP=1 cargo test -p bulge-inference --test all kept` writes the files anew.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use crate::support::{diagnosing, effects, options, truth};
use bulge_effects::{Catalogue, Moment};
use bulge_inference::{
    Block, DiagnoseOptions, NextLimits, Path, Protocol, ReadingNoise, ReadingSteps, RigErrors, compare,
    compare_with_rows, diagnose, drawn_forms, extended, fit_effects, plan, posterior, predict, simulate,
};
use bulge_measurements::{Channel, Columns, Data, Trace};
use bulge_model::{Model, forces_asked};
use bulge_muscles::{Muscle, from_toml, preset, to_toml};
use bulge_numerics::last_digits;
use nalgebra::DMatrix;
use serde_json::{Map, Value, json};
use std::path::PathBuf;

/// Relative accuracy of kept numbers, and where last digits are others: without fused operations a likelihood ratio moves by 9e-3.
const CLOSE: [f64; 2] = [2e-3, 2e-2];
/// Numbers below this fraction of the largest beside them are differences of larger ones.
const LEAST: f64 = 1e-6;
/// Parts of the kept cost that are no change, and where last digits are others.
const COST: [f64; 2] = [2e-3, 0.4];
/// Longer arrays are kept as a few numbers.
const MOST: usize = 12;

/// Fails if an answer isn't the kept one, or costs something else.
fn keep(name: &str, answer: impl FnOnce() -> Value + Send) {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(format!("tests/all/kept/{name}.json"));
    // What it costs is counted on one thread.
    let thread = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let (answer, asked) = thread.install(|| {
        let before = forces_asked();
        let answer = answer();
        (answer, forces_asked() - before)
    });
    let digits = format!("{:016x}", last_digits() ^ last_digits_of_products());
    let found = json!({ "answer": short(&answer), "forces_asked": asked, "last_digits": digits });
    if std::env::var_os("BULGE_KEEP").is_some() {
        // A line for each part of the answer.
        let parts =
            found["answer"].as_object().unwrap().iter().map(|(key, value)| format!("\"{key}\": {value}"));
        let answer = parts.collect::<Vec<_>>().join(",\n");
        let text = format!(
            "{{\n\"forces_asked\": {asked},\n\"last_digits\": \"{digits}\",\n\"answer\": {{\n{answer}\n}}\n}}\n"
        );
        std::fs::write(path, text).unwrap();
        return;
    }
    let kept: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let mut differ = Vec::new();
    let others = usize::from(kept["last_digits"] != found["last_digits"]);
    differences("", &kept["answer"], &found["answer"], CLOSE[others], &mut differ);
    let asked = [&kept, &found].map(|one| one["forces_asked"].as_f64().unwrap());
    if (asked[1] - asked[0]).abs() > COST[others] * asked[0] {
        differ.push(format!("{} forces were asked for, not {}", asked[0], asked[1]));
    }
    assert!(
        differ.is_empty(),
        "{name}: {} differ:\n{}",
        differ.len(),
        differ[..differ.len().min(20)].join("\n")
    );
}

/// The same as [`last_digits`] for products of matrices, whose kernels are those of the processor.
fn last_digits_of_products() -> u64 {
    let matrix = DMatrix::from_fn(70, 70, |i, j| (0.1 + 3.0 * i as f64 + 7.0 * j as f64).sin());
    (&matrix * &matrix).iter().fold(0, |sum: u64, value| sum.rotate_left(5) ^ value.to_bits())
}

/// The answer with six digits, of long arrays some entries, and of long arrays of numbers their size, ends, and a sum that tells their order.
fn short(value: &Value) -> Value {
    match value {
        Value::Number(number) => match number.as_f64() {
            Some(float) if number.is_f64() => format!("{float:.5e}").parse::<f64>().unwrap().into(),
            _ => value.clone(),
        },
        Value::Array(all) if all.len() > MOST && all.iter().all(Value::is_number) => {
            let numbers: Vec<f64> = all.iter().filter_map(Value::as_f64).collect();
            let mean = numbers.iter().sum::<f64>() / numbers.len() as f64;
            let rms = (numbers.iter().map(|x| x * x).sum::<f64>() / numbers.len() as f64).sqrt();
            let in_order = numbers.iter().enumerate().map(|(i, x)| x * (0.7 * i as f64).sin()).sum::<f64>()
                / numbers.len() as f64;
            short(&json!([numbers.len(), numbers[0], numbers[numbers.len() - 1], mean, rms, in_order]))
        }
        Value::Array(all) => all.iter().step_by(all.len().div_ceil(MOST).max(1)).map(short).collect(),
        Value::Object(all) => all
            .iter()
            .filter(|(key, _)| !matches!(key.as_str(), "version" | "files" | "sha256"))
            .map(|(key, value)| (key.clone(), short(&near(key, value))))
            .collect::<Map<_, _>>()
            .into(),
        other => other.clone(),
    }
}

/// Without rivals that are far behind: they explain nothing, and stand in the order of their last digits.
fn near(key: &str, value: &Value) -> Value {
    match value {
        Value::Array(all) if key == "rivals" => all
            .iter()
            .filter(|one| one["behind"].as_f64().is_none_or(|behind| behind < 300.0))
            .cloned()
            .collect(),
        _ => value.clone(),
    }
}

fn differences(place: &str, kept: &Value, found: &Value, close: f64, differ: &mut Vec<String>) {
    match (kept, found) {
        (Value::Object(a), Value::Object(b)) if a.keys().eq(b.keys()) => {
            a.iter()
                .for_each(|(key, one)| differences(&format!("{place}.{key}"), one, &b[key], close, differ));
        }
        (Value::Array(a), Value::Array(b)) if a.len() == b.len() => {
            let largest = a.iter().filter_map(Value::as_f64).fold(0.0, |most, x: f64| x.abs().max(most));
            for (i, (one, other)) in a.iter().zip(b).enumerate() {
                if let (Some(x), Some(y)) = (one.as_f64(), other.as_f64()) {
                    if !alike(x, y, close, LEAST * largest) {
                        differ.push(format!("{place}[{i}]: {x} was kept, not {y}"));
                    }
                } else {
                    differences(&format!("{place}[{i}]"), one, other, close, differ);
                }
            }
        }
        (Value::Number(a), Value::Number(b))
            if alike(a.as_f64().unwrap(), b.as_f64().unwrap(), close, 1e-9) => {}
        (Value::String(a), Value::String(b)) if said_alike(a, b, close) => {}
        _ if kept == found => {}
        _ => differ.push(format!("{place}: {kept} was kept, not {found}")),
    }
}

fn alike(kept: f64, found: f64, close: f64, least: f64) -> bool {
    (kept - found).abs() <= (close * kept.abs().max(found.abs())).max(least)
}

/// The same sentence, with numbers that are close or differ by one in their last digit.
fn said_alike(kept: &str, found: &str, close: f64) -> bool {
    let words = |text: &str| -> Vec<String> {
        text.split(|letter: char| letter.is_whitespace() || ",;:()%".contains(letter))
            .map(str::to_owned)
            .collect()
    };
    let (kept, found) = (words(kept), words(found));
    kept.len() == found.len()
        && kept.iter().zip(&found).all(|(one, other)| {
            one == other
                || one.parse::<f64>().ok().zip(other.parse::<f64>().ok()).is_some_and(|(x, y)| {
                    let digits = one.split_once('.').map_or(0, |(_, after)| after.len());
                    alike(x, y, close, 1.01 * 0.1_f64.powi(i32::try_from(digits).unwrap()))
                })
        })
}

const BRAID: &str = r#"
name = "braid"
kind = "braided"
length = "250 mm"
radius = "10 mm"
braid_angle = "25 deg"
ends = "ENDS"
wall = "1.8 mm"

[instruments]
force = { noise = "1 N", zero = "2 N", gain = "0.3 %" }
pressure = { noise = "100 Pa", zero = "1 kPa", gain = "0.2 %" }
length = { noise = "10 um", zero = "0.1 mm", gain = "0.2 %" }
"#;

fn braid(ends: &str) -> Muscle {
    from_toml(&BRAID.replace("ENDS", ends), "braid.toml").unwrap()
}

/// The same, with exact numbers: fewer are fitted along, which takes a tenth of the time.
fn exact(ends: &str) -> Muscle {
    from_toml(&exact_file(ends), "braid.toml").unwrap()
}

fn exact_file(ends: &str) -> String {
    BRAID.replace("ENDS", ends).replace(" mm\"\n", " mm +- 0\"\n").replace(" deg\"\n", " deg +- 0\"\n")
}

fn loops(rows: u32, cycles: u32) -> Block {
    Block { rows, cycles, ..Block::loops(vec![2e5, 3e5, 4e5], [0.02, 0.16], 30.0) }
}

fn noise(force_n: f64) -> ReadingNoise {
    ReadingNoise { force_n, ..ReadingNoise::default() }
}

fn measured(muscle: &Muscle, hidden: &[(&str, &[f64])], protocol: &Protocol) -> Data {
    let (model, theta) = truth(muscle, hidden);
    simulate(&model, &theta, protocol, 7).unwrap().data
}

fn keep_diagnosis(name: &str, data: &Data, muscle: &Muscle, options: &DiagnoseOptions) {
    keep(name, || serde_json::to_value(diagnose(data, muscle, options).unwrap()).unwrap());
}

/// A hidden effect in one block, with white noise of 1 N.
fn keep_hidden(name: &str, muscle: &Muscle, hidden: &[(&str, &[f64])], block: Block) {
    let protocol = Protocol { noise: noise(1.0), ..Protocol::new(vec![block]) };
    keep_diagnosis(name, &measured(muscle, hidden, &protocol), muscle, &diagnosing(&[]));
}

#[test]
fn friction_of_a_cylinder() {
    keep_hidden("friction", &braid("cylinder"), &[("coulomb-friction", &[8.0])], loops(24, 2));
}

#[test]
fn rubber_and_friction_of_a_clamped_braid() {
    let hidden: [(&str, &[f64]); 2] = [("bladder-elasticity", &[1e5]), ("pressure-friction", &[2e-5])];
    keep_hidden("clamped", &braid("clamped"), &hidden, loops(20, 1));
}

#[test]
fn a_pleated_muscle_on_a_grid() {
    let muscle = preset("ppam-2-r16").unwrap();
    let map = Block { repeats: 3, ..Block::map(vec![1e5, 2e5, 3e5], [0.05, 0.3], 9) };
    let protocol = Protocol {
        noise: noise(2.0),
        steps: ReadingSteps { force_n: 0.5, pressure_pa: 100.0, length_m: 1e-4 },
        ..Protocol::new(vec![map])
    };
    let data = measured(&muscle, &[("fibre-stretch", &[2e-5])], &protocol);
    keep_diagnosis("pleated", &data, &muscle, &diagnosing(&[]));
}

#[test]
fn held_lengths_and_correlated_noise() {
    let block = Block { rows: 24, ..Block::isometric([1e5, 5e5], vec![0.02, 0.08, 0.14], 30.0) };
    let noise = ReadingNoise {
        force_n: 1.0,
        correlated_n: 2.0,
        correlation_time_s: 4.0,
        pressure_pa: 300.0,
        length_m: 2e-5,
        ..ReadingNoise::default()
    };
    let protocol = Protocol { noise, rig: RigErrors::Drawn, ..Protocol::new(vec![block]) };
    let muscle = braid("cylinder");
    let data = measured(&muscle, &[("end-taper", &[])], &protocol);
    keep_diagnosis("held", &data, &muscle, &diagnosing(&[]));
}

#[test]
fn stairs_that_creep_and_warm_up() {
    let block = Block { path: Path::Stairs { steps: 4, hold_s: 2.0 }, ..loops(32, 2) };
    let protocol =
        Protocol { noise: noise(1.0), warming_k: 12.0, pause_s: 20.0, ..Protocol::new(vec![block]) };
    let muscle = braid("cylinder");
    let data = measured(&muscle, &[("creep", &[4.0])], &protocol);
    let among = Some(["temperature", "creep", "self-heating", "force-lag"].map(str::to_owned).to_vec());
    keep_diagnosis("warm", &data, &muscle, &DiagnoseOptions { among, ..diagnosing(&[]) });
}

#[test]
fn specimens_in_which_nothing_is_missing() {
    let block = Block { specimens: 3, path: Path::Sine, ..loops(16, 1) };
    let noise = ReadingNoise { tails: Some(4.0), offset_n: 2.0, ..noise(1.0) };
    let protocol = Protocol { noise, ..Protocol::new(vec![block]) };
    let muscle = braid("cylinder");
    let limits = NextLimits::default();
    let options = DiagnoseOptions { tolerance_n: Some(1.0), limits, ..diagnosing(&[]) };
    keep_diagnosis("specimens", &measured(&muscle, &[], &protocol), &muscle, &options);
}

/// Readings of a cylinder, with more force at each row.
fn with_more(block: Block, more: impl Fn(usize, &Moment) -> f64) -> Columns {
    let muscle = braid("cylinder");
    let protocol = Protocol { noise: noise(1.0), ..Protocol::new(vec![block]) };
    let (model, theta) = truth(&muscle, &[]);
    let found = simulate(&model, &theta, &protocol, 11).unwrap();
    let (data, moments) = (&found.data, found.exact.moments());
    let force =
        data.force().iter().zip(moments).enumerate().map(|(row, (force, moment))| force + more(row, moment));
    Columns { force_n: force.collect(), ..data.columns().as_ref().clone() }
}

fn keep_columns(name: &str, columns: Columns, with: &[&str]) {
    keep_diagnosis(name, &Data::from_columns(columns).unwrap(), &braid("cylinder"), &diagnosing(with));
}

#[test]
fn a_force_that_no_effect_explains() {
    let more = |_, moment: &Moment| 25.0 * (150.0 * moment.contraction).sin();
    keep_columns("unknown", with_more(loops(40, 1), more), &[]);
}

#[test]
fn a_smooth_force_that_no_effect_explains() {
    let more = |_, moment: &Moment| 4e-7 * moment.pressure.powf(1.5) * (40.0 * moment.contraction).cos();
    let data = Data::from_columns(with_more(loops(30, 1), more)).unwrap();
    keep_diagnosis("smooth", &data, &exact("cylinder"), &diagnosing(&[]));
}

#[test]
fn a_force_that_oscillates() {
    let more = |_, moment: &Moment| 8.0 * (1.7 * moment.time).sin();
    keep_columns("oscillation", with_more(loops(50, 1), more), &[]);
}

#[test]
fn friction_of_another_form_with_a_spike() {
    let more = |row, moment: &Moment| {
        if row == 57 { 900.0 } else { -9.0 * moment.direction * (1.0 + 2.0 * moment.contraction) }
    };
    keep_columns("bent", with_more(loops(24, 1), more), &["end-taper"]);
}

#[test]
fn the_form_of_friction_is_written_as_an_effect() {
    let more = |_, moment: &Moment| -9.0 * moment.direction * (1.0 + 3.0 * moment.contraction);
    let data = Data::from_columns(with_more(loops(40, 1), more)).unwrap();
    let options = options(&["coulomb-friction"]);
    keep("form", || {
        let found = drawn_forms(&data, &exact("cylinder"), &options).unwrap();
        let form = &found.forms[0];
        json!({ "rmse": [found.rmse_n, found.bent_rmse_n], "says": form.says, "error": form.form_error, "missed": form.missed_n })
    });
}

#[test]
fn a_load_cell_that_jumps() {
    keep_columns("jump", with_more(loops(40, 1), |row, _| if row > 70 { 18.0 } else { 0.0 }), &[]);
}

#[test]
fn rows_that_are_something_else() {
    let more = |row, _: &Moment| if (50..58).contains(&row) { 25.0 + row as f64 } else { 0.0 };
    keep_columns("odd", with_more(loops(40, 1), more), &[]);
}

#[test]
fn a_force_that_comes_late() {
    let block = Block { rows: 40, ..Block::isometric([1e5, 5e5], vec![0.02, 0.08, 0.14], 30.0) };
    let data = Data::from_columns(with_more(block, |_, _| 0.0)).unwrap().moved(Channel::Force, -3);
    keep_diagnosis("late", &data, &exact("cylinder"), &diagnosing(&[]));
}

#[test]
fn rubber_that_softens() {
    let hidden: [(&str, &[f64]); 2] = [("bladder-elasticity", &[2e5]), ("stress-softening", &[0.4, 1.5])];
    let muscle = braid("cylinder");
    let protocol = Protocol { noise: noise(1.0), warming_k: 8.0, ..Protocol::new(vec![loops(12, 5)]) };
    keep_diagnosis("softening", &measured(&muscle, &hidden, &protocol), &muscle, &diagnosing(&[]));
}

#[test]
fn exchanged_specimens() {
    let tables = "\n[specimens.1]\nradius = \"10 mm\"\n[specimens.2]\nradius = \"10.4 mm\"\n[specimens.3]\nradius = \"9.7 mm\"\n";
    let muscle = from_toml(&format!("{}{tables}", exact_file("cylinder")), "braid.toml").unwrap();
    let parts: Vec<Columns> = (20..)
        .zip(["1", "3", "2"])
        .map(|(seed, name)| {
            let protocol = Protocol { noise: noise(1.0), ..Protocol::new(vec![loops(20, 1)]) };
            let model = Model::new(&muscle.of_specimen(name).unwrap());
            simulate(&model, &[], &protocol, seed).unwrap().data.columns().as_ref().clone()
        })
        .collect();
    let all = |column: &dyn Fn(&Columns) -> Vec<f64>| parts.iter().flat_map(column).collect::<Vec<f64>>();
    let of_length = all(&|part| part.motion.values().to_vec());
    let motion = match parts[0].motion {
        Trace::Contraction(_) => Trace::Contraction(of_length),
        Trace::Length(_) => Trace::Length(of_length),
    };
    let mut columns =
        Columns::new(all(&|part| part.pressure_pa.clone()), motion, all(&|part| part.force_n.clone()));
    columns.time_s = Some(all(&|part| part.time_s.clone().unwrap()));
    columns.specimen = Some((0..columns.force_n.len()).map(|row| ["1", "2", "3"][row / 60]).collect());
    keep_diagnosis("exchanged", &Data::from_columns(columns).unwrap(), &muscle, &diagnosing(&[]));
}

#[test]
fn a_radius_that_is_off() {
    let other =
        from_toml(&BRAID.replace("ENDS", "clamped").replace("10 mm", "10.6 mm"), "braid.toml").unwrap();
    let protocol = Protocol { noise: noise(1.0), ..Protocol::new(vec![loops(20, 1)]) };
    keep_diagnosis("radius", &measured(&other, &[], &protocol), &braid("clamped"), &diagnosing(&[]));
}

#[test]
fn many_rows() {
    let hidden: [(&str, &[f64]); 2] = [("viscous-damping", &[200.0]), ("force-lag", &[0.2])];
    let block = Block { path: Path::Sine, ..loops(250, 1) };
    let protocol = Protocol {
        noise: ReadingNoise {
            correlated_n: 4.0,
            correlation_time_s: 2.0,
            pressure_pa: 500.0,
            length_m: 5e-6,
            ..noise(2.0)
        },
        ..Protocol::new(vec![block])
    };
    let muscle = exact("cylinder");
    keep_diagnosis("many", &measured(&muscle, &hidden, &protocol), &muscle, &diagnosing(&[]));
}

#[test]
fn pounds_for_newtons() {
    let mut columns = with_more(loops(40, 1), |_, _| 0.0);
    columns.force_n.iter_mut().for_each(|force| *force /= 4.448_222);
    let data = Data::from_columns(columns).unwrap();
    let muscle = braid("cylinder");
    keep("pounds", || {
        let (comparison, rows) = compare_with_rows(&data, &muscle, &options(&["coulomb-friction"])).unwrap();
        json!({ "comparison": comparison, "model": rows.model_n })
    });
}

/// Readings that are others than stated, and what is asked about them.
#[test]
fn other_meanings() {
    type Spoil = fn(&mut Columns);
    let spoilt: [(&str, Spoil); 9] = [
        ("kilograms", |columns| columns.force_n.iter_mut().for_each(|f| *f /= 9.806_65)),
        ("kilonewtons", |columns| columns.force_n.iter_mut().for_each(|f| *f *= 1e-3)),
        ("pushing", |columns| columns.force_n.iter_mut().for_each(|f| *f *= -1.0)),
        ("unplugged", |columns| {
            columns.force_n.iter_mut().enumerate().for_each(|(row, f)| *f = 2.0 + (row % 3) as f64);
        }),
        ("psi as bar", |columns| columns.pressure_pa.iter_mut().for_each(|p| *p *= 14.503_77)),
        ("bar as psi", |columns| columns.pressure_pa.iter_mut().for_each(|p| *p /= 14.503_77)),
        ("MPa as bar", |columns| columns.pressure_pa.iter_mut().for_each(|p| *p *= 0.1)),
        ("absolute", |columns| columns.pressure_pa.iter_mut().for_each(|p| *p += 101_325.0)),
        ("twice", |columns| columns.force_n.iter_mut().for_each(|f| *f *= 2.6)),
    ];
    let all = with_more(loops(24, 1), |_, _| 0.0);
    keep("meanings", || {
        let asked = spoilt.iter().map(|(name, spoil)| {
            let mut columns = all.clone();
            spoil(&mut columns);
            let found =
                compare(&Data::from_columns(columns).unwrap(), &exact("cylinder"), &options(&[])).unwrap();
            ((*name).to_owned(), serde_json::to_value(&found.data.findings).unwrap())
        });
        asked.collect::<Map<_, _>>().into()
    });
}

/// A muscle that pushes before the end of its strokes.
#[test]
fn rows_that_push() {
    let muscle = exact("cylinder");
    let mut columns = with_more(Block { contraction: [0.1, 0.34], ..loops(40, 1) }, |_, _| 0.0);
    columns.force_n.iter_mut().for_each(|force| *force -= 60.0);
    let data = Data::from_columns(columns).unwrap();
    keep("pushing", || {
        let (found, rows) = compare_with_rows(&data, &muscle, &options(&["force-offset"])).unwrap();
        json!({ "ladder": found.ladder, "data": found.data, "counts": rows.counts.iter().filter(|counts| **counts).count() })
    });
}

#[test]
fn friction_beside_something_unknown() {
    let more = |_, moment: &Moment| -9.0 * moment.direction + 4.0 * (90.0 * moment.contraction).sin();
    let data = Data::from_columns(with_more(loops(40, 1), more)).unwrap();
    keep_diagnosis("beside", &data, &exact("cylinder"), &diagnosing(&[]));
}

#[test]
fn one_sweep_with_another_zero_of_the_length() {
    let block = Block { pressures_pa: vec![1.5e5, 2e5, 2.5e5, 3e5, 3.5e5, 4e5], ..loops(16, 1) };
    let mut columns = with_more(block, |_, _| 0.0);
    // It slips by another part of the length from row to row.
    let stretched = columns.motion.values().iter().enumerate().map(|(row, value)| {
        value * if (32..48).contains(&row) { 1.0 + 4e-4 * (row - 32) as f64 } else { 1.0 }
    });
    columns.motion = match &columns.motion {
        Trace::Length(_) => Trace::Length(stretched.collect()),
        Trace::Contraction(_) => Trace::Contraction(stretched.collect()),
    };
    let data = Data::from_columns(columns).unwrap();
    keep_diagnosis("zero", &data, &exact("cylinder"), &diagnosing(&[]));
}

#[test]
fn another_length() {
    let mut columns = with_more(loops(30, 1), |_, _| 0.0);
    let contraction = Data::from_columns(columns.clone()).unwrap().contraction(0.25);
    columns.motion = Trace::Length(contraction.iter().map(|c| 0.25 * (1.0 - c)).collect());
    let muscle =
        from_toml(&BRAID.replace("ENDS", "cylinder").replace("250 mm", "238 mm"), "braid.toml").unwrap();
    keep_diagnosis("length", &Data::from_columns(columns).unwrap(), &muscle, &diagnosing(&[]));
}

#[test]
fn a_fit_and_what_it_predicts() {
    let muscle = exact("clamped");
    let protocol = Protocol { noise: noise(1.0), ..Protocol::new(vec![loops(16, 1)]) };
    let hidden: [(&str, &[f64]); 2] = [("coulomb-friction", &[8.0]), ("frame-compliance", &[2e-7, 1.0])];
    let data = measured(&muscle, &hidden, &protocol);
    let chosen = options(&["coulomb-friction", "frame-compliance"]);
    keep("fit", || {
        let (fitting, posterior) = posterior(&data, &muscle, &chosen, 3).unwrap();
        let alone = fit_effects(&data, &muscle, &chosen).unwrap();
        let learnt = extended(&alone.model, &alone.fit).unwrap();
        let predicted = predict(&data, &learnt.muscle, &Catalogue::builtin(), &[3]).unwrap();
        json!({
            "fit": fitting.fit,
            "before": fitting.before_rmse_n,
            "after": fitting.rmse_n,
            "posterior": posterior,
            "learnt": to_toml(&learnt.muscle),
            "predicted": predicted,
        })
    });
}

#[test]
fn what_a_test_would_show() {
    let muscle = braid("cylinder");
    let protocol = Protocol {
        noise: ReadingNoise {
            correlated_n: 1.0,
            correlation_time_s: 3.0,
            pressure_pa: 300.0,
            length_m: 2e-5,
            ..noise(1.0)
        },
        rig: RigErrors::Drawn,
        ..Protocol::new(vec![loops(20, 2)])
    };
    let known = [(effects(&["coulomb-friction"])[0].clone(), vec![5.0])];
    keep("plan", || {
        serde_json::to_value(plan(&muscle, &known, &Catalogue::builtin(), &protocol).unwrap()).unwrap()
    });
}

#[test]
fn too_few_rows() {
    let mut columns = with_more(loops(4, 1), |_, _| 0.0);
    let first: [&mut Vec<f64>; 3] =
        [&mut columns.pressure_pa, &mut columns.force_n, columns.time_s.as_mut().unwrap()];
    for values in first {
        values.truncate(3);
    }
    columns.motion = Trace::Contraction(vec![0.02, 0.09, 0.16]);
    columns.sweep = None;
    keep_diagnosis("few", &Data::from_columns(columns).unwrap(), &exact("cylinder"), &diagnosing(&[]));
}

/// So many rows that fits and held-out pressures begin with some of them.
#[test]
fn a_long_record() {
    let more = |_, moment: &Moment| -4e-5 * moment.pressure * moment.direction;
    let data = Data::from_columns(with_more(loops(700, 4), more)).unwrap();
    let options = options(&["coulomb-friction", "end-taper"]);
    let muscle = braid("cylinder");
    keep("long", || {
        let (found, _) = compare_with_rows(&data, &muscle, &options).unwrap();
        json!({ "ladder": found.ladder })
    });
}
