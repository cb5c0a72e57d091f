//! `simulate` as seen by a user: files that `compare` and `fit` can read, the same bytes for the same seed,
//! one message for bad input.

use crate::support::{Folder, MUSCLE, PROTOCOL, has_parts, json, line, refused, stdout};
use serde_json::Value;
use std::fs;

const HIDDEN: &str = "end-taper,bladder-elasticity=0.31 MPa,coulomb-friction=14 N";

fn simulated(folder: &Folder, name: &str, more: &[&str]) -> (Value, [String; 3]) {
    let out = folder.path(name);
    let mut arguments = vec!["simulate", MUSCLE, "--protocol", PROTOCOL, "--out", &out, "--json"];
    arguments.extend(more);
    let truth = json(&arguments);
    let read = |file: &str| fs::read_to_string(folder.0.join(name).join(file)).unwrap();
    (truth, [read("data.csv"), read("muscle.toml"), read("truth.json")])
}

#[test]
fn what_is_hidden_is_found_again() {
    let folder = Folder::new("simulate");
    let (truth, [csv, muscle, written]) = simulated(&folder, "trial", &["--with", HIDDEN, "--seed", "7"]);
    assert_eq!((truth["schema"].as_str(), truth["seed"].as_u64()), (Some("bulge.simulation/1"), Some(7)));
    assert_eq!(serde_json::from_str::<Value>(&written).unwrap(), truth);
    let names: Vec<&str> =
        truth["effects"].as_array().unwrap().iter().map(|e| e["effect"].as_str().unwrap()).collect();
    assert_eq!(names, ["end-taper", "bladder-elasticity", "coulomb-friction"]);
    assert_eq!(truth["effects"][1]["numbers"][0]["unit"], "MPa");
    assert!(csv.contains("time [s],sweep,pressure [bar],contraction [%],force [N]\n"), "{csv:.200}");
    // The muscle file contains nothing of the effects.
    assert!(muscle.contains("noise = \"2.236 N\"") && !muscle.contains("effects"), "{muscle}");
    assert_eq!(csv.lines().count(), 2 + 600);
    let (data, stated) = (folder.path("trial/data.csv"), folder.path("trial/muscle.toml"));
    let found = json(&line(&format!(
        "compare {data} --muscle {stated} --with end-taper,bladder-elasticity,coulomb-friction --json"
    )));
    let last = &found["ladder"][3];
    // sqrt(2^2 + 1^2) N, and the noise of the pressure.
    let error = last["rmse_n"].as_f64().unwrap();
    assert!((2.0..2.6).contains(&error), "{error}");
    for (number, expected) in last["fit"]["parameters"].as_array().unwrap().iter().zip([0.31, 14.0]) {
        assert!((number["value"].as_f64().unwrap() / expected - 1.0).abs() < 0.03, "{number}");
    }
    let model = folder.path("model.toml");
    let fitted = json(&line(&format!(
        "fit {data} --muscle {stated} --with end-taper,bladder-elasticity,coulomb-friction --out {model} --json"
    )));
    assert!(fitted["rmse_n"].as_f64().unwrap() < 2.6);
    // The fitted muscle can be simulated in turn, and its effects are then known.
    let again = json(&["simulate", &model, "--protocol", PROTOCOL, "--out", &folder.path("again"), "--json"]);
    assert_eq!(again["effects"], serde_json::json!([]));
    assert!(folder.names().contains(&"again".to_owned()));
}

#[test]
fn a_seed_gives_the_same_bytes() {
    let folder = Folder::new("simulate-seed");
    let [first, same, other] = [("a", "7"), ("b", "7"), ("c", "8")]
        .map(|(name, seed)| simulated(&folder, name, &["--with", HIDDEN, "--seed", seed]).1);
    assert_eq!(first, same);
    assert_ne!(first[0], other[0]);
    assert_eq!(first[1], other[1]);
}

#[test]
fn numbers_are_stated_in_many_ways() {
    let folder = Folder::new("simulate-numbers");
    let values = |with: &str| -> Vec<f64> {
        let (truth, _) = simulated(&folder, "x", &["--with", with]);
        let effects = truth["effects"].as_array().unwrap().clone();
        effects
            .iter()
            .flat_map(|e| e["numbers"].as_array().unwrap())
            .map(|n| n["value"].as_f64().unwrap())
            .collect()
    };
    assert_eq!(values("coulomb-friction.force=9 N"), [9.0]);
    assert_eq!(values("coulomb-friction=0.009 kN"), [9.0]);
    let usual = values("presliding-hysteresis");
    assert!(usual.len() > 1, "{usual:?}");
    // Values in order, and by name.
    let (truth, _) = simulated(&folder, "keys", &["--with", "presliding-hysteresis"]);
    let numbers = truth["effects"][0]["numbers"].as_array().unwrap().clone();
    let stated = |n: &Value| {
        let unit = n["unit"].as_str().unwrap();
        format!("{} {}", n["value"].as_f64().unwrap() * 1.25, if unit == "1" { "" } else { unit })
    };
    let expected: Vec<f64> = numbers.iter().map(|n| n["value"].as_f64().unwrap() * 1.25).collect();
    let in_order: Vec<String> = numbers.iter().map(stated).collect();
    let close = |found: Vec<f64>| found.iter().zip(&expected).all(|(a, b)| (a / b - 1.0).abs() < 1e-9);
    assert!(close(values(&format!("presliding-hysteresis={}", in_order.join(",")))));
    let by_name: Vec<String> = numbers
        .iter()
        .map(|n| format!("presliding-hysteresis.{}={}", n["key"].as_str().unwrap(), stated(n)))
        .collect();
    assert!(close(values(&by_name.join(","))));
    // An effect whose usual value is zero takes the size given in the literature: 10 N.
    assert_eq!(values("force-offset"), [10.0]);
}

#[test]
fn specimens_differ_by_their_spread() {
    let folder = Folder::new("simulate-specimens");
    let text = fs::read_to_string(PROTOCOL).unwrap().replace("cycles = 3", "cycles = 1\nspecimens = 40");
    let protocol = folder.write("many.toml", &text);
    let out = folder.path("s");
    let call = |protocol: &str| {
        format!("simulate {MUSCLE} --protocol {protocol} --with 'specimen-spread=2 %' --out {out} --json")
    };
    let truth = json(&line(&call(&protocol)));
    let drawn: Vec<f64> = truth["effects"][0]["numbers"]
        .as_array()
        .unwrap()
        .iter()
        .map(|n| n["value"].as_f64().unwrap())
        .collect();
    let spread = (drawn.iter().map(|v| v * v).sum::<f64>() / 40.0).sqrt();
    assert!(
        drawn.len() == 40 && (spread / 2.0 - 1.0).abs() < 3.0 / 80.0_f64.sqrt(),
        "{spread} % of {drawn:?}"
    );
    let csv = fs::read_to_string(folder.0.join("s/data.csv")).unwrap();
    assert!(csv.contains("time [s],sweep,specimen,pressure"), "{csv:.200}");
    refused(&line(&call(PROTOCOL)), 1, &["needs two specimens or more"]);
}

#[test]
fn people_read_what_was_done() {
    let folder = Folder::new("simulate-text");
    let out = folder.path("trial");
    let text = stdout(&["simulate", MUSCLE, "--protocol", PROTOCOL, "--with", HIDDEN, "--out", &out]);
    has_parts(
        &text,
        &[
            "600 rows in 4 sweeps",
            "hidden: coulomb-friction force 14",
            "at 2.000 bar",
            "was done (1 sweep)",
            "truth.json",
            "bulge compare",
        ],
    );
    let help = stdout(&["simulate", "--help"]);
    has_parts(&help, &["Example:", "[[block]]", "--with \"coulomb-friction=14 N"]);
    // The protocol in the help is valid.
    let shown = help.split("every key:\n").nth(1).unwrap();
    let protocol = folder.write("help.toml", &shown.replace("\"drawn\"", "\"none\""));
    stdout(&["simulate", MUSCLE, "--protocol", &protocol, "--out", &out]);
}

#[test]
fn bad_input_is_answered_with_one_message() {
    let folder = Folder::new("simulate-bad");
    let slip = folder.write("slip.toml", &fs::read_to_string(PROTOCOL).unwrap().replace("cycles", "cicles"));
    let drawn =
        folder.write("drawn.toml", &format!("rig = \"drawn\"\n{}", fs::read_to_string(PROTOCOL).unwrap()));
    let map = folder.write(
        "map.toml",
        "[[block]]\nshape = \"static\"\npressures = \"2,3 bar\"\ncontraction = \"1 %..10 %\"\n",
    );
    let out = folder.path("out");
    for (muscle, protocol, with, parts) in [
        (
            MUSCLE,
            slip.as_str(),
            "end-taper",
            ["slip.toml:10:1: unknown key `cicles`", "did you mean `cycles`?"],
        ),
        (MUSCLE, "none.toml", "end-taper", ["none.toml", "there is no such file"]),
        ("nobody", PROTOCOL, "end-taper", ["no shipped muscle is called `nobody`", "dmsp-20-250"]),
        (MUSCLE, drawn.as_str(), "end-taper", ["needs widths", "[instruments]"]),
        (MUSCLE, map.as_str(), "coulomb-friction=14 N", ["`coulomb-friction` needs a path", "leave it out"]),
        (MUSCLE, PROTOCOL, "coulomb-frction=14 N", ["no effect `coulomb-frction`", "`coulomb-friction`"]),
        (MUSCLE, PROTOCOL, "coulomb-friction=14", ["a pure number", "coulomb-friction.force="]),
        (MUSCLE, PROTOCOL, "coulomb-friction=14 mm", ["a length", "coulomb-friction.force="]),
        (MUSCLE, PROTOCOL, "coulomb-friction=much", ["much", "coulomb-friction.force="]),
        (MUSCLE, PROTOCOL, "coulomb-friction=-1 N", ["out of the bounds", "between 0 N and"]),
        (
            MUSCLE,
            PROTOCOL,
            "coulomb-friction.farce=1 N",
            ["has no `farce`; write such as `coulomb-friction.force=", "N`"],
        ),
        (MUSCLE, PROTOCOL, "coulomb-friction.force", ["has no value", "coulomb-friction.force="]),
        (MUSCLE, PROTOCOL, "coulomb-friction=1 N,2 N", ["`2 N` is too much", "one number only"]),
        (MUSCLE, PROTOCOL, "end-taper=3 N", ["too much", "its name alone"]),
        (MUSCLE, PROTOCOL, "14 N", ["belongs to no effect", "coulomb-friction=14 N"]),
        (MUSCLE, PROTOCOL, "coulomb-friction=1 N,coulomb-friction=2 N", ["twice", "once is enough"]),
        (MUSCLE, PROTOCOL, "lobes=300 mm", ["`lobes`", "pleated"]),
    ] {
        let call = ["simulate", muscle, "--protocol", protocol, "--with", with, "--out", &out];
        let message = refused(&call, 1, &parts);
        assert_eq!(message.matches("error: ").count(), 1, "{message}");
        assert!(!folder.names().contains(&"out".to_owned()), "{with}: a failed call wrote something");
    }
    // No file of the user is overwritten.
    let muscle = folder.write("muscle.toml", &fs::read_to_string(MUSCLE).unwrap());
    let own = folder.0.display().to_string();
    refused(
        &["simulate", &muscle, "--protocol", PROTOCOL, "--out", &own],
        1,
        &["muscle.toml would be written over"],
    );
    assert!(!folder.names().contains(&"data.csv".to_owned()));
    // Nor measurements that no simulation made; a simulation is.
    let measured = Folder::new("measured");
    measured.write("data.csv", "my readings");
    let out = measured.0.display().to_string();
    let call = ["simulate", MUSCLE, "--protocol", PROTOCOL, "--out", &out];
    refused(&call, 1, &["data.csv isn't of a simulation", "give another folder"]);
    let data = || fs::read_to_string(measured.0.join("data.csv")).unwrap();
    assert_eq!((data().as_str(), measured.names().len()), ("my readings", 1));
    measured.write("truth.json", "{}");
    stdout(&call);
    assert!(measured.names().len() == 3 && data() != "my readings");
}
