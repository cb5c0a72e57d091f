//! `next` as seen by a user: the open question, the experiment that decides it (and does), and the honest
//! answer if none does.

use crate::support::{Folder, MUSCLE, PROTOCOL, has_parts, json, refused, simulated, stdout};
use serde_json::Value;
use std::fs;

/// A single loop at one pressure.
const LOOP: &str =
    "[[block]]\npressures = [\"3 bar\"]\ncontraction = \"1 %..20 %\"\nperiod = \"50 s\"\nrows = 50\n";
const NOISE: &str = "[noise]\nforce = \"2 N\"\npressure = \"100 Pa\"\n";

/// The words that a call prints.
fn words(arguments: &[&str]) -> String {
    let text = stdout(arguments);
    assert!(text.lines().count() < 25, "{text}");
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn class(found: &Value) -> Vec<&str> {
    found["missing"][0]["class"].as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect()
}

#[test]
fn where_no_test_of_force_separates_that_is_said() {
    let folder = Folder::new("next-threshold");
    let [data, muscle] = simulated(&folder, "trial", [PROTOCOL, "7"], &["--with", "pressure-threshold"]);
    let found = json(&["next", &data, "--muscle", &muscle, "--json"]);
    assert_eq!(
        (found["schema"].as_str(), found["verdict"].as_str()),
        (Some("bulge.next/1"), Some("missing")),
        "{found}"
    );
    let class = class(&found);
    assert!(class.contains(&"pressure-threshold") && class.contains(&"pressure-offset"), "{class:?}");
    assert!(found["missing"][0]["confidence"].is_f64());
    let next = &found["next_experiment"];
    assert_eq!(next["repeats"], 0, "{next}");
    assert!(
        next["says"].as_str().unwrap().starts_with("no test of force within these limits tells"),
        "{next}"
    );
    assert!(found["says"].as_str().unwrap().contains("the reading of the vented pressure sensor"));
    let text = words(&["next", &data, "--muscle", &muscle]);
    has_parts(
        &text,
        &[
            "missing: pressure-threshold",
            "open: these data cannot tell pressure-",
            "no test of force",
            "--pressure",
        ],
    );
    assert!(!text.contains("and then, with both"), "{text}");
}

/// The promised sigmas and those that the proposed test brings, both of the nearest rival that it should separate.
fn promised_and_measured(next: &Value, after: &Value) -> [f64; 2] {
    let says = next["says"].as_str().unwrap();
    let told = &says[says.find("that tells").unwrap()..says.find(" sigma)").unwrap()];
    let rivals = after["missing"][0]["rivals"].as_array().unwrap();
    let named =
        rivals.iter().filter(|rival| told.contains(&format!("`{}`", rival["effect"].as_str().unwrap())));
    let measured = named.map(|rival| rival["separation"].as_f64().unwrap()).fold(f64::INFINITY, f64::min);
    [next["sigma"].as_f64().unwrap(), measured]
}

/// A test that leaves something open is made, then the one that is proposed, as it is written: that decides, by as many sigmas as promised.
#[test]
fn what_is_proposed_decides_what_was_open() {
    let folder = Folder::new("next-friction");
    let one = folder.write("one.toml", &format!("{LOOP}{NOISE}"));
    for (hidden, protocol, open) in [
        // At one pressure, friction proportional to the pressure can't be distinguished from constant friction.
        ("coulomb-friction=14 N", [&*one, "2"], ["coulomb-friction", "pressure-friction"]),
        // At one speed drag is indistinguishable from dry friction.
        ("viscous-damping", [PROTOCOL, "7"], ["viscous-damping", "coulomb-friction"]),
    ] {
        let [data, muscle] = simulated(&folder, open[0], protocol, &["--with", hidden]);
        let arguments = ["next", &data, "--muscle", &muscle, "--pressure", "2 bar..5 bar"];
        let second = folder.path("second.toml");
        let found = json(&[&arguments[..], &["--json", "--out", &second]].concat());
        let class = class(&found);
        assert!(open.iter().all(|name| class.contains(name)), "{class:?}");
        let next = &found["next_experiment"];
        let says = next["says"].as_str().unwrap();
        assert!(next["sigma"].as_f64().unwrap() > 3.29 && next["repeats"].as_u64() == Some(1), "{next}");
        assert!(says.contains("between 2.00 and 5.00 bar"), "{says}");
        let words = words(&arguments);
        has_parts(&words, &["next: measure ", &format!("bulge diagnose {data} NEW.csv")]);
        // Set points as one writes them, not as they were read.
        has_parts(
            &fs::read_to_string(&second).unwrap(),
            &["contraction = \"1 %..20 %\"\n", "\"2 bar\"", "\"5 bar\""],
        );
        let [more, _] =
            simulated(&folder, &format!("{}-second", open[0]), [&second, "12"], &["--with", hidden]);
        let after = json(&["diagnose", &data, &more, "--muscle", &muscle, "--json"]);
        let left = after["missing"][0]["class"].as_array().unwrap();
        assert!(left.contains(&open[0].into()) && !left.contains(&open[1].into()), "{left:?}");
        let [promised, measured] = promised_and_measured(next, &after);
        // What was named first may have been the twin: then the promise is that of another pair.
        let most = if found["missing"][0]["effect"] == open[0] { 1.5 } else { 5.0 };
        assert!((0.7..most).contains(&(measured / promised)), "{hidden}: {measured} for {promised}");
    }
}

#[test]
fn a_held_length_or_another_stroke_is_proposed_where_that_separates_best() {
    let folder = Folder::new("next-held");
    let one = folder.write("one.toml", &format!("{LOOP}{NOISE}"));
    for (hidden, seed, proposal) in [
        ("frame-compliance", "8", "filling and venting at two held lengths"),
        ("pressure-offset", "7", "loops over a third of the stroke, and over all of it"),
        ("force-gain", "7", "loops over a third of the stroke, and over all of it"),
    ] {
        let [data, muscle] = simulated(&folder, hidden, [&one, seed], &["--with", hidden]);
        let found = json(&["next", &data, "--muscle", &muscle, "--pressure", "2 bar..5 bar", "--json"]);
        let next = &found["next_experiment"];
        assert!(next["says"].as_str().unwrap().contains(proposal), "{hidden}: {next}");
        assert!(next["sigma"].as_f64().unwrap() > 3.29, "{next}");
    }
}

#[test]
fn where_nothing_is_open_the_largest_limit_is_named() {
    let folder = Folder::new("next-nothing");
    let [data, muscle] =
        simulated(&folder, "trial", [PROTOCOL, "7"], &["--with", "bladder-elasticity=0.31 MPa"]);
    let with = ["next", &data, "--muscle", &muscle, "--with", "bladder-elasticity"];
    let found = json(&[&with[..], &["--json"]].concat());
    assert_eq!(found["verdict"], "adequate", "{found}");
    assert!(found["next_experiment"].is_null() && found["missing"] == serde_json::json!([]), "{found}");
    let says = found["says"].as_str().unwrap();
    assert!(
        says.starts_with("nothing to separate: ")
            && says.contains("the largest detection limit is that of `"),
        "{says}"
    );
    assert!(says.contains(" N). What lowers it: "), "{says}");
    let words = words(&with);
    has_parts(
        &words,
        &[
            "adequate: ",
            "nothing to separate: ",
            "could not be looked for (needs a path with a column `time` on which the pressure rises",
        ],
    );
    // The same seed gives the same bytes.
    let again = || stdout(&["next", &data, "--muscle", &muscle, "--seed", "5", "--json"]);
    assert_eq!(again(), again());
}

/// Data with a bump of 25 N over the contraction, which no effect produces.
fn with_a_bump(csv: &str) -> String {
    let is_row = |line: &str| line.starts_with(|c: char| c.is_ascii_digit());
    let columns: Vec<&str> = csv.lines().find(|line| line.starts_with("time")).unwrap().split(',').collect();
    let place = |name: &str| columns.iter().position(|column| column.starts_with(name)).unwrap();
    let (contraction, force) = (place("contraction"), place("force"));
    let bumped = |line: &str| {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        let at: f64 = cells[contraction].parse().unwrap();
        let bump = 25.0 * (-((at - 8.0) / 0.6).powi(2)).exp();
        cells[force] = (cells[force].parse::<f64>().unwrap() + bump).to_string();
        cells.join(",")
    };
    csv.lines().map(|line| if is_row(line) { bumped(line) } else { line.to_owned() } + "\n").collect()
}

#[test]
fn the_unknown_is_measured_again_where_it_is_largest() {
    let folder = Folder::new("next-unknown");
    let [data, muscle] = simulated(&folder, "trial", [PROTOCOL, "7"], &["--with", "coulomb-friction=14 N"]);
    let data = folder.write("bump.csv", &with_a_bump(&fs::read_to_string(data).unwrap()));
    let arguments = ["next", &data, "--muscle", &muscle, "--with", "coulomb-friction"];
    let found = json(&[&arguments[..], &["--json"]].concat());
    assert_eq!(found["verdict"], "unknown", "{found}");
    assert!(found["next_experiment"].is_null(), "{found}");
    let words = words(&arguments);
    has_parts(
        &words,
        &[
            "unknown: ",
            "it is largest near contraction ",
            "next: repeat the test where the misfit is largest, around contraction ",
        ],
    );
    let around = words.split("around contraction ").nth(1).unwrap().split(' ').next().unwrap();
    assert!((around.parse::<f64>().unwrap() - 8.0).abs() < 1.0, "{words}");
}

#[test]
fn too_few_rows_are_answered_with_what_to_measure() {
    let folder = Folder::new("next-few");
    let data =
        folder.write("few.csv", "pressure [bar],contraction [%],force [N]\n2,5,300\n3,5,480\n3,9,400\n");
    let found = json(&["next", &data, "--muscle", MUSCLE, "--json"]);
    assert_eq!(found["verdict"], "cannot-tell", "{found}");
    let words = words(&["next", &data, "--muscle", MUSCLE]);
    assert!(words.contains("cannot tell: ") && words.contains("easure at least three pressures"), "{words}");
    assert_eq!(words.matches("can't tell").count(), 0, "{words}");
}

#[test]
fn bad_input_gets_one_clear_message() {
    let folder = Folder::new("next-bad");
    let data = folder.write("data.csv", "pressure [bar],contraction [%],force [N]\n1,5,100\n1,6,90\n");
    for (more, expected, parts) in [
        (&["--pressure", "1 bar"][..], 1, &["--pressure", "range"][..]),
        (
            &["--pressure", "5 bar..1 bar"],
            1,
            &["--pressure", "5 bar..1 bar", "the smaller end first", "\"1 bar..6 bar\""],
        ),
        (&["--pressure", "0 bar..2 bar"], 1, &["--pressure", "above 0"]),
        (&["--pressure", "-1 bar..2 bar"], 1, &["--pressure", "above 0"]),
        (&["--pressure", "1 bar..2000 bar"], 1, &["--pressure", "1000 bar"]),
        (&["--pressure", "1 mm..2 mm"], 1, &["--pressure", "mm"]),
        (&["--contraction", "5 %..5 %"], 1, &["--contraction", "is empty", "\"0 %..20 %\""]),
        (&["--contraction", "0 %..90 %"], 1, &["--contraction", "90.00 %", "60 %"]),
        (&["--contraction", "0..much"], 1, &["--contraction", "much"]),
        (&["--with", "fibre-strech"], 1, &["did you mean `fibre-stretch`"]),
        (&["--effects", "nowhere.toml"], 1, &["nowhere.toml"]),
        (&["--seed", "x"], 2, &["--seed", "invalid"]),
        (&["--presure", "1 bar..2 bar"], 2, &["--presure"]),
    ] {
        refused(&[&["next", &data, "--muscle", MUSCLE], more].concat(), expected, parts);
    }
    refused(&["next", "--muscle", MUSCLE], 2, &["DATA"]);
    refused(&["next", "nowhere.csv", "--muscle", MUSCLE], 1, &["nowhere.csv"]);
    // Nothing is left behind.
    assert_eq!(folder.names(), ["data.csv"]);
}
