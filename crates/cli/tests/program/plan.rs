//! `plan` as seen by a user: detection limits by hand, twins by name, one message for bad input.

use crate::support::{Folder, MUSCLE, PROTOCOL, has_parts, json, refused, stdout};
use serde_json::Value;
use std::fs;

/// A static map with white noise of 2 N.
const MAP: &str = "[[block]]\nshape = \"static\"\npressures = \"2,3,4 bar\"\ncontraction = \"1 %..20 %\"\nrows = 20\n\n[noise]\nforce = \"2 N\"\n";

/// The shipped braid without data sheets: only the noise of the protocol limits detection.
fn bare(folder: &Folder) -> String {
    let text = fs::read_to_string(MUSCLE).unwrap();
    folder.write("bare.toml", text.split("[instruments]").next().unwrap())
}

fn of<'v>(plan: &'v Value, name: &str) -> &'v Value {
    plan["effects"].as_array().unwrap().iter().find(|e| e["effect"] == name).unwrap()
}

#[test]
fn limits_are_those_of_an_estimate_by_hand() {
    let folder = Folder::new("plan-limits");
    let (muscle, protocol) = (bare(&folder), folder.write("map.toml", MAP));
    let plan = json(&["plan", "--muscle", &muscle, "--protocol", &protocol, "--json"]);
    assert_eq!((plan["schema"].as_str(), plan["rows"].as_u64()), (Some("bulge.plan/1"), Some(60)));
    // A mean of n readings of standard deviation sigma has sigma/sqrt(n).
    let expected = 3.3 * 2.0 / 60.0_f64.sqrt();
    let number = |effect: &Value, key: &str| effect[key].as_f64().unwrap();
    let offset = of(&plan, "force-offset");
    assert_eq!(offset["unit"], "N");
    assert!((number(offset, "detection_limit") / expected - 1.0).abs() < 1e-9, "{offset}");
    // The usual offset is 10 N.
    assert!((number(offset, "usual_sigma") - 3.3 * 10.0 / expected).abs() < 1e-6, "{offset}");
    // For every effect without compensation the RMS change of the force at the limit is the same.
    let effects = plan["effects"].as_array().unwrap();
    let free = effects.iter().filter(|e| e["detection_limit_n"].is_f64() && number(e, "compensation") < 1e-9);
    let limits: Vec<f64> = free.map(|e| number(e, "detection_limit_n")).collect();
    assert!(limits.len() > 10 && limits.iter().all(|n| (n / expected - 1.0).abs() < 1e-6), "{limits:?}");
    // Half the noise halves the limit; a quarter of the rows doubles it.
    for (change, factor) in [(("\"2 N\"", "\"1 N\""), 0.5), (("rows = 20", "rows = 5"), 2.0)] {
        let other = folder.write("other.toml", &MAP.replace(change.0, change.1));
        let plan = json(&["plan", "--muscle", &muscle, "--protocol", &other, "--json"]);
        let limit = number(of(&plan, "force-offset"), "detection_limit");
        assert!((limit / expected - factor).abs() < 1e-9, "{change:?}: {limit}");
    }
}

#[test]
fn a_test_like_the_one_that_was_made_is_written_as_a_protocol() {
    let folder = Folder::new("plan-like");
    let (data, out) =
        (concat!(env!("CARGO_MANIFEST_DIR"), "/data/braid-loops.csv"), folder.path("like.toml"));
    let arguments = ["plan", "--muscle", MUSCLE, "--like", data, "--out", &out, "--json"];
    let plan = json(&arguments);
    assert_eq!((plan["rows"].as_u64(), plan["sweeps"].as_u64()), (Some(750), Some(5)));
    let again = json(&["plan", "--muscle", MUSCLE, "--protocol", &out, "--json"]);
    assert!(again == plan, "what is written is another test");
    let written = fs::read_to_string(&out).unwrap();
    // At a higher pressure the muscle moved further.
    let block = "pressures = [\"5 bar\"]\ncontraction = \"1 %..20 %\"\nwave = \"sine\"\ncycles = 3\nperiod = \"50 s\"\nrows = 50\n";
    assert!(written.contains(block) && written.matches("[[block]]").count() == 5, "{written}");
    refused(
        &["plan", "--muscle", MUSCLE, "--like", data, "--out", data],
        1,
        &["the data file, which is read"],
    );
    // Meaningless headings, and an unreadable row.
    let text =
        fs::read_to_string(data).unwrap().replace("force [N]", "channel 3").replace("\n30,1,", "\n30,1,x");
    let other = folder.write("other.csv", &text);
    refused(&["plan", "--muscle", MUSCLE, "--like", &other], 1, &["--columns"]);
    let arguments = ["plan", "--muscle", MUSCLE, "--like", &other, "--columns", "force=channel 3 [N]"];
    let text = stdout(&arguments);
    assert!(text.contains("set apart 1 row") && text.contains("in 5 sweeps"), "{text}");
    refused(&["plan", "--muscle", MUSCLE], 2, &["--protocol"]);
}

#[test]
fn effects_that_look_alike_are_named() {
    let arguments = ["plan", "--muscle", MUSCLE, "--protocol", PROTOCOL];
    let plan = json(&[&arguments[..], &["--json"]].concat());
    let is_pair = |pair: &&Value| {
        ["pressure-offset", "pressure-threshold"]
            .iter()
            .all(|name| pair["effects"].as_array().unwrap().iter().any(|e| e == name))
    };
    let pair = plan["confused"].as_array().unwrap().iter().find(is_pair).unwrap();
    assert!(
        pair["cosine"].as_f64().unwrap() > 0.999
            && pair["repeats"].as_f64().is_none_or(|repeats| repeats > 1e6),
        "{pair}"
    );
    assert!(!pair["separate"].as_str().unwrap().is_empty());
    let text = stdout(&arguments);
    let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
    has_parts(
        &words,
        &[
            "20 mm braid, textbook, before measuring 600 rows in 4 sweeps: 2.00 to 5.00 bar, contraction 1.00 to 20.0 %",
            "2.00 N white, 1.00 N correlated over 5.00 s (the protocol)",
            "seen from (3.3 sigma)",
            "bladder-elasticity modulus",
            "cannot be seen (would change nothing here): low-load-slack",
            "pressure-threshold = pressure-offset",
            "bulge simulate ",
        ],
    );
}

#[test]
fn the_text_is_short_and_the_hint_can_be_followed() {
    let folder = Folder::new("plan-text");
    let quiet = folder.write("map.toml", MAP.split("[noise]").next().unwrap());
    for (muscle, protocol) in [(MUSCLE, PROTOCOL), (MUSCLE, quiet.as_str()), ("ppam-2-r16", &quiet)] {
        let text = stdout(&["plan", "--muscle", muscle, "--protocol", protocol]);
        assert!(
            text.lines().count() <= 45 && !text.contains("NaN"),
            "{} lines: {text}",
            text.lines().count()
        );
        assert!(text.lines().filter(|line| line.starts_with("  cannot be seen (")).count() <= 3, "{text}");
        let said = text.contains("! no noise is stated");
        assert_eq!(said, muscle == "ppam-2-r16", "{text}");
        let hint = text.lines().find_map(|line| line.trim().strip_prefix("bulge simulate ")).unwrap();
        let out = folder.path("trial");
        let words = hint.split_whitespace().map(|word| if word == "trial" { out.as_str() } else { word });
        let call: Vec<&str> = std::iter::once("simulate").chain(words).collect();
        stdout(&call);
    }
}

#[test]
fn bad_input_gets_one_clear_message() {
    let folder = Folder::new("plan-bad");
    let slip = folder.write("slip.toml", &MAP.replace("rows", "row"));
    let few = folder.write("few.toml", &MAP.replace("rows = 20", "rows = 1"));
    for (arguments, expected, parts) in [
        (&["--muscle", MUSCLE, "--protocol", &slip][..], 1, &["slip.toml:5:1", "`rows`"][..]),
        (&["--muscle", MUSCLE, "--protocol", &few], 1, &["few.toml", "`rows` is 1"]),
        (&["--muscle", MUSCLE, "--protocol", "none.toml"], 1, &["none.toml", "there is no such file"]),
        (&["--muscle", "nobody", "--protocol", PROTOCOL], 1, &["no shipped muscle is called `nobody`"]),
        (&["--muscle", MUSCLE, "--protocol", PROTOCOL, "--effects", "own.toml"], 1, &["own.toml"]),
        (&["--muscle", MUSCLE], 2, &["--protocol"]),
        (&["--protocol", PROTOCOL], 2, &["--muscle"]),
        (&["--muscle", MUSCLE, "--protocol", PROTOCOL, "more"], 2, &["more"]),
    ] {
        refused(&[&["plan"], arguments].concat(), expected, parts);
    }
    // Nothing is left behind.
    assert_eq!(folder.names(), ["few.toml", "slip.toml"]);
}
