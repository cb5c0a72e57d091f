//! Diagnosis of simulated measurements: the hidden effect is named, nothing is named where nothing is hidden, and too few rows name nothing.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use bulge_effects::Catalogue;
use bulge_inference::{
    Block, DiagnoseOptions, Diagnosis, Options, Path, Protocol, ReadingNoise, Verdict, diagnose, simulate,
};
use bulge_measurements::Data;
use bulge_model::Model;
use bulge_muscles::{Muscle, from_toml};
use std::fmt::Write;

const BRAID: &str = r#"
name = "braid"
kind = "braided"
length = "250 mm"
radius = "10 mm"
braid_angle = "25 deg"
ends = "clamped"
wall = "1.8 mm"

[instruments]
force = { noise = "2 N", zero = "0.5 N", gain = "0.05 %" }
pressure = { noise = "50 Pa", zero = "100 Pa", gain = "0.05 %" }
length = { noise = "5 um", zero = "0.02 mm", gain = "0.02 %" }
"#;

fn muscle() -> Muscle {
    from_toml(BRAID, "braid.toml").unwrap()
}

fn protocol(force_n: f64, correlated_n: f64) -> Protocol {
    let loops = Block {
        path: Path::Triangle,
        cycles: 2,
        rows: 50,
        ..Block::loops(vec![2e5, 3e5, 4e5, 5e5], [0.01, 0.18], 40.0)
    };
    let noise = ReadingNoise { force_n, correlated_n, correlation_time_s: 3.0, ..ReadingNoise::default() };
    Protocol { noise, ..Protocol::new(vec![loops]) }
}

fn measured(effects: &[(&str, &[f64])], protocol: &Protocol, seed: u64) -> Data {
    let catalogue = Catalogue::builtin();
    let mut model = Model::new(&muscle());
    let mut theta = Vec::new();
    for (name, values) in effects {
        model = model.with(catalogue.find(name).unwrap(), None).unwrap();
        theta.extend_from_slice(values);
    }
    simulate(&model, &theta, protocol, seed).unwrap().data
}

fn diagnosed(data: &Data) -> Diagnosis {
    let base = Options::new(Catalogue::builtin(), Vec::new());
    diagnose(data, &muscle(), &DiagnoseOptions::new(base)).unwrap()
}

fn names(diagnosis: &Diagnosis) -> Vec<&str> {
    diagnosis.missing.iter().map(|missing| missing.effect.as_str()).collect()
}

#[test]
fn the_hidden_effect_is_named_with_its_number() {
    for (effect, values, key, unit) in [
        ("bladder-elasticity", &[1e5][..], "modulus", 1e6),
        ("coulomb-friction", &[6.0][..], "force", 1.0),
        ("frame-compliance", &[2e-7][..], "compliance", 1e-6),
    ] {
        let found = diagnosed(&measured(&[(effect, values)], &protocol(2.0, 0.0), 3));
        assert_eq!(found.verdict, Verdict::Missing, "{effect}: {}", found.says);
        let first = &found.missing[0];
        assert!(
            found.missing.len() == 1 && first.class.iter().any(|name| name == effect),
            "{effect}: {:?}",
            names(&found)
        );
        assert!(!found.remaining.structured && first.plausible, "{effect}");
        if first.effect == effect {
            let number = &first.parameters[key];
            let value = values[0] / unit;
            // A 95 % interval: twice its width holds the truth in all but one of 10^4 runs.
            let slack = 0.5 * (number.high - number.low);
            assert!(
                number.low - slack < value && value < number.high + slack,
                "{effect}: {value} against {number:?}"
            );
        }
        let [before, after] = [0, 1].map(|i| found.ladder[i].rmse_n);
        assert!(after < before && after < 1.1 * found.noise_floor_n, "{effect}: {before} to {after}");
    }
}

#[test]
fn where_nothing_is_hidden_nothing_is_named() {
    let (mut named, mut told) = (Vec::new(), 0);
    for seed in 0..12 {
        let correlated = if seed % 2 == 0 { 0.0 } else { 2.0 };
        let found = diagnosed(&measured(&[], &protocol(2.0, correlated), seed));
        if found.verdict != Verdict::Adequate {
            named.push(format!("{seed}: {} {:?} {}", found.says, names(&found), found.noise.law.says));
        }
        told += usize::from(found.noise.correlated == (correlated > 0.0));
    }
    // At 5 % false alarms, three of 12 have a chance of 2 %.
    assert!(named.len() <= 2, "{named:#?}");
    assert!(told >= 10, "{told} of 12 laws are right about correlation");
}

#[test]
fn two_effects_are_both_named() {
    let hidden: [(&str, &[f64]); 2] = [("coulomb-friction", &[8.0]), ("bladder-elasticity", &[5e4])];
    let found = diagnosed(&measured(&hidden, &protocol(2.0, 0.0), 5));
    assert_eq!(found.verdict, Verdict::Missing, "{}", found.says);
    for (effect, _) in hidden {
        let is_in = found.missing.iter().any(|missing| missing.class.iter().any(|name| name == effect));
        assert!(is_in, "{effect}: {:?}", names(&found));
    }
    // And with them the model is adequate: the next diagnosis starts from there.
    let catalogue = Catalogue::builtin();
    let effects =
        names(&found).iter().map(|name| std::sync::Arc::clone(catalogue.find(name).unwrap())).collect();
    let data = measured(&hidden, &protocol(2.0, 0.0), 5);
    let options = DiagnoseOptions::new(Options::new(catalogue, effects));
    let again = diagnose(&data, &muscle(), &options).unwrap();
    assert_eq!(again.verdict, Verdict::Adequate, "{}", again.says);
}

#[test]
fn too_few_rows_name_nothing() {
    let csv = |rows: usize| {
        let mut text = String::from("pressure [bar],contraction [%],force [N]\n");
        for i in 0..rows {
            let line = format!(
                "{},{},{}\n",
                2 + i % 2,
                2 + 3 * (i / 2),
                900.0 - 40.0 * i as f64 + 3.0 * (i % 3) as f64
            );
            text.push_str(&line);
        }
        let folder = std::env::temp_dir().join(format!("bulge-few-{rows}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let path = folder.join("data.csv");
        std::fs::write(&path, text).unwrap();
        let data = Data::read(&[&path]).unwrap();
        std::fs::remove_dir_all(&folder).unwrap();
        data
    };
    for rows in [1, 2, 4, 7] {
        let found = diagnosed(&csv(rows));
        assert_eq!(found.verdict, Verdict::CannotTell, "{rows} rows: {}", found.says);
        assert!(found.missing.is_empty() && !found.says.is_empty());
    }
}

#[test]
fn the_same_bytes_on_one_thread_and_on_many() {
    let data = measured(&[("pressure-friction", &[2e-5])], &protocol(2.0, 1.0), 2);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| serde_json::to_string(&diagnosed(&data)).unwrap())
    };
    assert!(on(1) == on(3));
}

#[test]
fn a_tolerance_is_what_matters() {
    let data = measured(&[("coulomb-friction", &[3.0])], &protocol(2.0, 0.0), 3);
    let with = |tolerance_n: Option<f64>| {
        let base = Options::new(Catalogue::builtin(), Vec::new());
        diagnose(&data, &muscle(), &DiagnoseOptions { tolerance_n, ..DiagnoseOptions::new(base) }).unwrap()
    };
    assert_eq!(with(None).verdict, Verdict::Missing);
    assert_eq!(with(Some(1.0)).verdict, Verdict::Missing);
    let loose = with(Some(20.0));
    assert_eq!(loose.verdict, Verdict::Adequate, "{}", loose.says);
    assert!(loose.missing.is_empty() && loose.says.contains("20"), "{}", loose.says);
    // Where nothing is named, no name stands anywhere as if it were.
    assert!(loose.ladder.len() == 1 && loose.ladder[0].adequate && loose.explained.is_empty());
    assert!(!loose.remaining.structured && loose.next_experiment.is_none());
    assert!(loose.candidates.iter().all(|candidate| candidate.status != "confirmed"));
}

#[test]
fn a_wrong_unit_is_no_physics() {
    let exact = measured(&[], &protocol(2.0, 0.0), 1);
    let folder = std::env::temp_dir().join(format!("bulge-unit-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("data.csv");
    // Bar written into a column of psi.
    let mut text = String::from("pressure [psi],contraction [%],force [N]\n");
    let contraction = exact.contraction(0.25);
    for (row, contraction) in contraction.iter().enumerate() {
        let line =
            format!("{},{},{}\n", exact.pressure()[row] / 1e5, 100.0 * contraction, exact.force()[row]);
        text.push_str(&line);
    }
    std::fs::write(&path, text).unwrap();
    let data = Data::read(&[&path]).unwrap();
    std::fs::remove_dir_all(&folder).unwrap();
    let options = DiagnoseOptions::new(Options::new(Catalogue::builtin(), Vec::new()));
    let error = diagnose(&data, &muscle(), &options).map(|found| found.says).unwrap_err().to_string();
    assert!(error.contains("14.50") && error.contains("psi"), "{error}");
}

/// The noise of a reading within 20 % of the truth, whether something is hidden or not, in short tests and in long ones of many cycles.
#[test]
fn more_rows_and_cycles_never_hurt_the_law_of_the_noise() {
    let rubber: (&str, &[f64]) = ("bladder-elasticity", &[2e5]);
    for (rows, cycles, hidden) in [(30, 1, vec![]), (200, 1, vec![rubber]), (120, 8, vec![rubber])] {
        let block = Block { cycles, rows, ..Block::loops(vec![2e5, 3e5, 4e5, 5e5], [0.01, 0.18], 40.0) };
        let noise = ReadingNoise { force_n: 2.0, ..ReadingNoise::default() };
        let data = measured(&hidden, &Protocol { noise, ..Protocol::new(vec![block]) }, 4);
        let found = diagnosed(&data);
        let ratio = found.noise.sd_n / 2.0;
        assert!((0.8..1.2).contains(&ratio), "{rows} rows, {cycles} cycles: {:?}", found.noise);
        assert_eq!(names(&found), hidden.iter().map(|(name, _)| *name).collect::<Vec<_>>());
    }
}

/// Clamped braids of some lengths \[mm\], diagnosed as cylinders.
fn end_taper_of(lengths: &[u32]) -> Diagnosis {
    let catalogue = Catalogue::builtin();
    let file = |length: u32| BRAID.replace("250 mm", &format!("{length} mm"));
    let mut text = String::new();
    let mut tables = file(lengths[0]).replace("clamped", "cylinder");
    let loops =
        Block { path: Path::Triangle, rows: 24, ..Block::loops(vec![2e5, 3e5, 4e5], [0.02, 0.14], 40.0) };
    for (i, length) in lengths.iter().enumerate() {
        let model = Model::new(&from_toml(&file(*length), "b").unwrap());
        let model = model.with(catalogue.find("coulomb-friction").unwrap(), None).unwrap();
        let noise = ReadingNoise { force_n: 2.0, ..ReadingNoise::default() };
        let found =
            simulate(&model, &[3.0], &Protocol { noise, ..Protocol::new(vec![loops.clone()]) }, 5).unwrap();
        for (row, line) in found.csv.lines().filter(|line| !line.starts_with('#')).enumerate() {
            let mut fields: Vec<String> = line.split(',').map(str::to_owned).collect();
            match row {
                0 if i > 0 => continue,
                0 => fields.push("specimen".to_owned()),
                _ => {
                    fields[1] = format!("{i}-{}", fields[1]);
                    fields.push(format!("l{length}"));
                }
            }
            text.push_str(&(fields.join(",") + "\n"));
        }
        let _ = write!(tables, "[specimens.l{length}]\nlength = \"{length} mm\"\n");
    }
    let data = Data::from_csv(&text, "lengths.csv").unwrap();
    let muscle = from_toml(&tables, "braids.toml").unwrap();
    let known = vec![(std::sync::Arc::clone(catalogue.find("coulomb-friction").unwrap()), vec![3.0])];
    let base = Options { known, ..Options::new(catalogue, Vec::new()) };
    diagnose(&data, &muscle, &DiagnoseOptions::new(base)).unwrap()
}

#[test]
fn end_effects_show_in_several_lengths() {
    // The nearest rival is nearer than by the square root of the number of rows: a factor of force suits one length, and none suits three.
    let separation = |lengths: &[u32]| {
        let diagnosis = end_taper_of(lengths);
        assert_eq!(names(&diagnosis), ["end-taper"], "{lengths:?}");
        let nearest = diagnosis.missing[0].rivals.iter().map(|rival| rival.separation);
        nearest.fold(f64::INFINITY, f64::min)
    };
    let (one, three) = (separation(&[250]), separation(&[250, 120, 60]));
    println!("the nearest rival of end-taper: {one:.1} sigma away with one length, {three:.1} with three");
    assert!(three > 2.0 * one, "{three} sigma with three lengths, {one} with one");
}
