//! `diagnose` as seen by a user: hidden effects are named, documents and reports are complete, messages for
//! bad input.

use crate::support::{Folder, MUSCLE, PROTOCOL, failure, has_parts, json, refused, simulated, stdout};
use serde_json::Value;
use std::fmt::Write;
use std::fs;
use std::path::Path;

/// Simulated measurements with hidden effects: data file and muscle file.
fn with(folder: &Folder, hidden: &str) -> [String; 2] {
    simulated(folder, "trial", [PROTOCOL, "7"], &["--with", hidden])
}

fn has(value: &Value, keys: &[&str]) {
    let object = value.as_object().unwrap();
    for key in keys {
        assert!(object.contains_key(*key), "no `{key}` in {value:.300}");
    }
}

#[test]
fn a_hidden_effect_is_named_and_the_document_has_all_keys() {
    let folder = Folder::new("diagnose-hidden");
    let [data, muscle] = with(&folder, "bladder-elasticity=0.31 MPa");
    let out = folder.path("report");
    let found = json(&["diagnose", &data, "--muscle", &muscle, "--seed", "3", "--out", &out, "--json"]);
    assert_eq!(
        (found["schema"].as_str(), found["verdict"].as_str()),
        (Some("bulge.diagnosis/1"), Some("missing"))
    );
    has(
        &found,
        &[
            "schema",
            "data",
            "noise",
            "verdict",
            "missing",
            "candidates",
            "ladder",
            "noise_floor_n",
            "where",
            "remaining",
            "next_experiment",
        ],
    );
    has(&found["data"], &["rows", "sha256", "sweeps"]);
    has(&found["noise"], &["sd_n", "correlated", "source"]);
    let named = &found["missing"][0];
    has(named, &["effect", "class", "confidence", "parameters", "plausible"]);
    assert_eq!(named["effect"], "bladder-elasticity", "{named}");
    assert_eq!((&named["class"][0], &named["plausible"]), (&"bladder-elasticity".into(), &true.into()));
    for number in named["parameters"].as_object().unwrap().values() {
        has(number, &["value", "unit", "low", "high"]);
        let [low, value, high] = ["low", "value", "high"].map(|key| number[key].as_f64().unwrap());
        assert!(low < value && value < high && (value - 0.31).abs() < 0.003, "{number}");
    }
    has(&found["candidates"][0], &["effect", "log_evidence", "score", "status"]);
    for step in found["ladder"].as_array().unwrap() {
        has(step, &["added", "rmse_n", "held_out_rmse_n", "adequate"]);
    }
    assert!(found["ladder"][0]["added"].is_null() && found["ladder"][0]["adequate"] == false);
    has(&found["where"][0], &["variable", "share", "p", "says"]);
    assert_eq!(found["where"][0]["variable"], "contraction");
    has(&found["remaining"], &["structured", "misfit_n", "hints"]);
    // The report contains the same.
    let read = |name: &str| fs::read_to_string(Path::new(&out).join(name)).unwrap();
    assert_eq!(serde_json::from_str::<Value>(&read("diagnosis.json")).unwrap(), found);
    let page = read("report.html");
    assert!(page.starts_with("<!DOCTYPE html>") && page.contains("Missing: bladder-elasticity"));
    for name in ["ladder", "explained-1", "candidates", "rivals", "where", "remaining", "force"] {
        assert!(Path::new(&out).join(format!("{name}.svg")).is_file(), "{name}.svg");
    }
    let parts = fs::read_dir(&out)
        .unwrap()
        .filter(|e| e.as_ref().unwrap().file_name().to_string_lossy().ends_with(".part"));
    assert_eq!(parts.count(), 0);
}

#[test]
fn people_read_the_verdict_first_and_how_to_go_on() {
    let folder = Folder::new("diagnose-text");
    let [data, muscle] = with(&folder, "bladder-elasticity=0.31 MPa");
    let text = stdout(&["diagnose", &data, "--muscle", &muscle]);
    let lines: Vec<&str> = text.lines().collect();
    assert!(lines.len() <= 42, "{text}");
    let place = |part: &str| {
        lines.iter().position(|line| line.contains(part)).unwrap_or_else(|| panic!("{part}: {text}"))
    };
    assert!(place("  missing: bladder-elasticity (rubber; on data like these") < 6);
    assert!(place("+ bladder-elasticity") < place("noise floor"));
    let accept = format!("bulge diagnose {data} --muscle {muscle} --with bladder-elasticity");
    assert!(place("noise: a single reading") < place(&accept));
    // An effect that was added isn't found again.
    let next = json(&["diagnose", &data, "--muscle", &muscle, "--with", "bladder-elasticity", "--json"]);
    assert_eq!(next["verdict"], "adequate", "{}", next["says"]);
    assert_eq!(next["missing"].as_array().unwrap().len(), 0);
    let learnt = folder.path("learnt.toml");
    stdout(&["fit", &data, "--muscle", &muscle, "--with", "bladder-elasticity", "--out", &learnt]);
    has_parts(&fs::read_to_string(&learnt).unwrap(), &["[effects.bladder-elasticity]"]);
}

#[test]
fn nothing_is_named_where_nothing_is_hidden() {
    let folder = Folder::new("diagnose-null");
    let [data, muscle] = simulated(&folder, "trial", [PROTOCOL, "7"], &[]);
    let arguments = ["diagnose", &data, "--muscle", &muscle, "--tolerance", "5 N", "--seed", "3", "--json"];
    let first = stdout(&arguments);
    let found: Value = serde_json::from_str(&first).unwrap();
    assert_eq!(found["verdict"], "adequate", "{}", found["says"]);
    // The same seed gives the same bytes.
    assert_eq!(stdout(&arguments), first);
}

#[test]
fn bad_input_gets_one_clear_message() {
    let folder = Folder::new("diagnose-bad");
    let data = folder.write("data.csv", "pressure [bar],contraction [%],force [N]\n1,5,100\n1,6,90\n");
    let file = folder.write("taken", "");
    for (more, expected, parts) in [
        (&["--tolerance", "5 mm"][..], 1, &["--tolerance", "mm"][..]),
        (&["--tolerance", "5"], 1, &["--tolerance", "unit"]),
        (&["--tolerance=-5 N"], 1, &["--tolerance", "less than nothing", "`5 N`"]),
        (&["--tolerance", "much"], 1, &["--tolerance", "much"]),
        (&["--with", "fibre-strech"], 1, &["did you mean `fibre-stretch`"]),
        (&["--effects", "nowhere.toml"], 1, &["nowhere.toml"]),
        (&["--seed", "x"], 2, &["--seed", "invalid"]),
        (&["--tolerence", "5 N"], 2, &["--tolerance"]),
    ] {
        refused(&[&["diagnose", &data, "--muscle", MUSCLE], more].concat(), expected, parts);
    }
    refused(&["diagnose", "--muscle", MUSCLE], 2, &["DATA"]);
    refused(&["diagnose", "nowhere.csv", "--muscle", MUSCLE], 1, &["nowhere.csv"]);
    // Nothing is left behind.
    assert!(Path::new(&file).is_file());
    assert_eq!(folder.names(), ["data.csv", "taken"]);
}

#[test]
fn a_report_that_has_no_place_is_refused_and_nothing_is_written() {
    let folder = Folder::new("diagnose-place");
    let [data, muscle] = with(&folder, "bladder-elasticity=0.31 MPa");
    let file = folder.write("taken", "");
    refused(
        &["diagnose", &data, "--muscle", &muscle, "--out", &file],
        1,
        &["is a file; give the name of a folder"],
    );
    fs::create_dir_all(folder.0.join("out/where.svg")).unwrap();
    refused(
        &["diagnose", &data, "--muscle", &muscle, "--out", &folder.path("out")],
        1,
        &["where.svg", "move it away"],
    );
    assert_eq!(fs::read_dir(folder.0.join("out")).unwrap().count(), 1);
}

/// Loops of the textbook cylinder at four pressures, with an offset of each sweep \[N\] and a change of each
/// reading.
fn loops(off: [f64; 4], change: impl Fn(usize, f64) -> f64) -> String {
    let mut text = String::from("sweep,time [s],pressure [bar],contraction [%],force [N]\n");
    let angle = 25.0_f64.to_radians();
    for row in 0..160_u32 {
        let (level, i) = (row / 40, row % 40);
        let e = 0.01 + 0.15 * (1.0 - (f64::from(i) / 20.0 - 1.0).abs());
        let p = 1e5 * f64::from(level + 1);
        let exact = std::f64::consts::PI
            * 1e-4
            * p
            * (3.0 * (1.0 - e).powi(2) / angle.tan().powi(2) - angle.sin().powi(-2));
        // Noise of 2 N without a pattern.
        let noise = 2.0 * (f64::from(row * row % 97) / 48.0 - 1.0);
        let force = change(row as usize, exact + off[level as usize] + noise);
        let (time, percent) = (0.2 * f64::from(row), 100.0 * e);
        let _ = writeln!(text, "{level},{time:.1},{},{percent:.4},{force:.3}", level + 1);
    }
    text
}

const CYLINDER: &str = "name = \"c\"\nkind = \"braided\"\nlength = \"250 mm +- 0\"\nradius = \"10 mm +- 0\"\nbraid_angle = \"25 deg +- 0\"\nends = \"cylinder\"\n";

/// A diagnosis as text, as JSON and as a page.
struct Answer {
    text: String,
    json: Value,
    page: String,
    tolerance_n: f64,
}

impl Answer {
    fn of(folder: &Folder, [data, muscle]: &[String; 2], tolerance_n: f64) -> Self {
        let tolerance = format!("{tolerance_n} N");
        let out = folder.path("out");
        let mut call = vec!["diagnose", data, "--muscle", muscle, "--out", &out];
        if tolerance_n > 0.0 {
            call.extend(["--tolerance", &tolerance]);
        }
        let text = stdout(&call);
        let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
        let read = |name: &str| fs::read_to_string(Path::new(&out).join(name)).unwrap();
        let json = serde_json::from_str(&read("diagnosis.json")).unwrap();
        Self { text, json, page: read("report.html"), tolerance_n }
    }

    fn verdict(&self) -> &str {
        self.json["verdict"].as_str().unwrap()
    }

    fn list(&self, key: &str) -> &[Value] {
        self.json[key].as_array().unwrap()
    }

    fn names(&self, key: &str) -> Vec<&str> {
        self.list(key).iter().map(|missing| missing["effect"].as_str().unwrap()).collect()
    }

    /// The text, the JSON and the page agree.
    fn agrees(&self) {
        let (text, json) = (&self.text, &self.json);
        let says = |part: &str| assert!(text.contains(part), "no {part:?} in {text}");
        let never = |part: &str| assert!(!text.contains(part), "{part:?} in {text}");
        for (verdict, headline) in
            [("adequate", "adequate: "), ("unknown", "unknown: "), ("cannot-tell", "cannot tell: ")]
        {
            assert_eq!(text.contains(&format!(" {headline}")), self.verdict() == verdict, "{text}");
        }
        assert_eq!(self.list("missing").is_empty(), self.verdict() != "missing", "{text}");
        for part in ["structure of 0 N", "structure of 0.00", "NaN", "inf "] {
            never(part);
        }
        // A percentage that wasn't simulated says so.
        for missing in self.list("missing") {
            let name = missing["effect"].as_str().unwrap();
            let claims = missing["simulated"]["claims"].as_u64().unwrap();
            // A name that is more likely wrong than right is given as one of several.
            let begins = match missing["level"].as_str().unwrap() {
                "form" | "family" => format!("missing: {name} ("),
                "mechanism" => format!("likeliest {name} ("),
                _ => format!("({name}: "),
            };
            let start = text.find(&begins).unwrap();
            let claim = &text[start..(start + 200).min(text.len())];
            assert_eq!(claim.contains("not simulated"), claims == 0, "{claim}");
        }
        for nearest in self.names("nearest") {
            says(&format!("nearest: {nearest} ("));
        }
        // Each rung reduces the error; only the last one can be sufficient.
        let ladder = self.list("ladder");
        for pair in ladder.windows(2) {
            let [before, after] = [&pair[0], &pair[1]].map(|rung| rung["rmse_n"].as_f64().unwrap());
            assert!(after < before || ladder.len() == 2, "{ladder:?}");
            assert_eq!(pair[0]["adequate"], false);
        }
        let remaining = &json["remaining"];
        let structured = remaining["structured"].as_bool().unwrap();
        let ends = &remaining["misfit_interval_n"];
        match self.verdict() {
            "adequate" => {
                let [low, high] = [0, 1].map(|end| ends[end].as_f64().unwrap());
                assert!(!structured && (high <= self.tolerance_n || low < 5.0), "{remaining}");
                assert!(low <= 0.0 || !text.contains("no structure beyond chance"), "{text}");
            }
            "unknown" => assert!(structured, "{remaining}"),
            "cannot-tell" => assert!(ladder.iter().all(|rung| rung["adequate"] == false)),
            _ => {
                assert_eq!(text.contains("remains: a structure"), structured, "{text}");
                let fitted: Vec<&str> =
                    self.list("missing").iter().map(|m| m["fitted"].as_str().unwrap()).collect();
                says(&format!("--with {}", fitted.join(",")));
                if self.list("missing").len() + self.list("nearest").len() == 3 && structured {
                    says("where the search stops");
                }
            }
        }
        assert_eq!(text.contains("to accept this step"), self.verdict() == "missing", "{text}");
        // The findings of the quality gate are in all of them.
        let quality = json["data"]["quality"].as_array().unwrap();
        for finding in quality.iter().take(6) {
            says(finding["says"].as_str().unwrap());
        }
        assert_eq!(self.page.contains("What the check of the data found"), !quality.is_empty());
        if let Some(next) = json["next_experiment"].as_object() {
            says("next experiment: ");
            for name in next["separates"].as_array().unwrap() {
                says(name.as_str().unwrap());
            }
        }
    }

    /// A tolerance removes claims and adds none.
    fn is_no_stronger_than(&self, other: &Self) {
        let pair = [other.verdict(), self.verdict()];
        let allowed = [["missing", "adequate"], ["unknown", "adequate"], ["adequate", "cannot-tell"]];
        assert!(
            pair[0] == pair[1] || allowed.contains(&pair) || pair == ["cannot-tell", "adequate"],
            "{pair:?}"
        );
        let named = other.names("missing");
        assert!(self.names("missing").iter().all(|name| named.contains(name)), "{named:?}");
        for missing in self.list("missing").iter().chain(self.list("nearest")) {
            let is_same = |before: &&Value| before["effect"] == missing["effect"];
            let mut all = other.list("missing").iter().chain(other.list("nearest"));
            let before = all.find(is_same).unwrap();
            for level in ["confidence", "confidence_mechanism", "confidence_form"] {
                assert!(missing[level].as_f64() <= before[level].as_f64(), "{level}: {missing}");
            }
            for (name, number) in missing["parameters"].as_object().unwrap() {
                let old = &before["parameters"][name];
                assert!(number["low"].as_f64() <= old["low"].as_f64(), "{name}: {number} was {old}");
                assert!(number["high"].as_f64() >= old["high"].as_f64(), "{name}: {number} was {old}");
            }
        }
    }
}

#[test]
fn sentences_of_a_diagnosis_agree_with_each_other_and_a_tolerance_only_weakens_them() {
    let folder = Folder::new("diagnose-agree");
    let case = |name: &str| {
        let path = format!("{}/../../validation/hidden-effects/cases/{name}", env!("CARGO_MANIFEST_DIR"));
        ["data.csv", "muscle.toml"].map(|file| format!("{path}/{file}"))
    };
    let muscle = folder.write("c.toml", CYLINDER);
    let off = folder.write("off.csv", &loops([90.0, -80.0, 110.0, -60.0], |_, force| force));
    // Friction and an outlier.
    let disturbed = |row: usize, force: f64| match row {
        30 => force + 900.0,
        _ => force - if row % 40 < 20 { 8.0 } else { -8.0 },
    };
    let spiked = folder.write("spiked.csv", &loops([0.0; 4], disturbed));
    let three = with(&folder, "bladder-elasticity=0.31 MPa,coulomb-friction=14 N,force-lag=0.3 s");
    let cases = [
        ("adequate", case("null-005")),
        ("missing", case("pair-010")),
        ("unknown", case("unknown-one-way-2")),
        ("cannot-tell", [off, muscle.clone()]),
        ("missing", [spiked, muscle]),
        ("missing", three),
    ];
    let mut found = 0;
    // Each case with a small or a large tolerance in turn.
    for ((verdict, files), tolerance) in cases.into_iter().zip([4.0, 60.0].into_iter().cycle()) {
        let answer = Answer::of(&folder, &files, 0.0);
        assert_eq!(answer.verdict(), verdict, "{}", answer.text);
        answer.agrees();
        found += answer.json["data"]["quality"].as_array().unwrap().len();
        let within = Answer::of(&folder, &files, tolerance);
        within.agrees();
        within.is_no_stronger_than(&answer);
        if verdict == "cannot-tell" {
            assert!(answer.text.contains("furthest off is sweep 3 (`2`)"), "{}", answer.text);
        }
    }
    assert!(found > 0);
}

/// Friction of a form that the catalogue lacks: it grows with the square root of the pressure, and with the
/// contraction.
const OWN_FRICTION: &str = "\
[effects.own-friction]
title = \"Friction of its own\"
force = \"-direction * mu * sqrt(p / 300000 [Pa]) * (0.55 + 5 * eps)\"
parameters.mu = { unit = \"N\", typical = \"40 N\", low = \"0 N\", high = \"500 N\" }
";

#[test]
fn a_form_that_the_data_want_becomes_an_effect_of_ones_own() {
    let folder = Folder::new("fit-form-error");
    let own = folder.write("own.toml", OWN_FRICTION);
    let hidden = ["--effects", &own, "--with", "own-friction=40 N"];
    let [data, muscle] = simulated(&folder, "trial", [PROTOCOL, "7"], &hidden);
    let bent = folder.path("bent.toml");
    let about = [&data[..], "--muscle", &muscle, "--json"];
    let fit = ["--with", "coulomb-friction", "--form-error", &bent];
    let found = json(&[&["fit"], &about[..], &fit].concat());
    let drawn = &found["drawn"];
    let form = &drawn["forms"][0];
    assert_eq!(form["written"], "coulomb-friction-bent", "{form}");
    let (exact, wanted) = (drawn["rmse_n"].as_f64().unwrap(), drawn["bent_rmse_n"].as_f64().unwrap());
    assert!(wanted < 0.5 * exact, "{exact} {wanted}");
    // The drawn form contains the hidden one within its intervals, and the file explains the data as well as
    // the fit with form error.
    let curves = form["form_error"]["curves"].as_array().unwrap();
    assert!(!curves.is_empty());
    for curve in curves {
        let number = |key: &str| curve[key].as_f64().unwrap();
        let list = |key: &str| -> Vec<f64> {
            curve[key].as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect()
        };
        let strength = -number("direction") * 40.0 * (number("pressure_pa") / 3e5).sqrt();
        for ((eps, drawn), sd) in list("contraction").iter().zip(list("bent_n")).zip(list("sd_n")) {
            let hidden = strength * (0.55 + 5.0 * eps);
            // Each is a mean of a few rows; a bin may contain a reading at a turn.
            assert!((drawn - hidden).abs() < 5.0 * sd + 0.01 * hidden.abs(), "{eps} {drawn} {hidden} {sd}");
        }
    }
    let compared =
        json(&[&["compare"], &about[..], &["--effects", &bent, "--with", "coulomb-friction-bent"]].concat());
    let rungs = compared["ladder"].as_array().unwrap();
    let rmse = |rung: &Value| rung["rmse_n"].as_f64().unwrap();
    let (before, after) = (rmse(&rungs[0]), rmse(&rungs[rungs.len() - 1]));
    assert!(after < 0.2 * before && (after / wanted - 1.0).abs() < 0.1, "{before} {exact} {after} {wanted}");
    let size = &rungs[rungs.len() - 1]["fit"]["parameters"][0];
    assert_eq!(size["effect"], "coulomb-friction-bent");
    // A formula without form error is not written.
    let none = folder.path("none.toml");
    let radius = json(&[&["fit"], &about[..], &["--with", "radius-error", "--form-error", &none]].concat());
    let says = radius["drawn"]["forms"][0]["says"].as_str().unwrap();
    assert!(says.contains("its formula is exact"), "{says}");
    assert!(!Path::new(&none).exists());
}

/// A hum, and one with growing amplitude: functions of time alone.
const HUMS: &str = "\
[effects.hum]
title = \"A hum\"
force = \"a * sin(time / tau)\"
parameters.a = { unit = \"N\", typical = \"30 N\", low = \"0 N\", high = \"500 N\" }
parameters.tau = { unit = \"s\", typical = \"11 s\", low = \"10 s\", high = \"12 s\" }

[effects.growing-hum]
title = \"A hum that grows\"
force = \"a * sin(time / tau) * (1 + 0.5 * time / (30 * tau))\"
parameters.a = { unit = \"N\", typical = \"30 N\", low = \"0 N\", high = \"500 N\" }
parameters.tau = { unit = \"s\", typical = \"11 s\", low = \"10 s\", high = \"12 s\" }
";

#[test]
fn a_form_along_the_time_is_written_nowhere() {
    let folder = Folder::new("fit-time");
    let own = folder.write("hums.toml", HUMS);
    let block = "[[block]]\npressures = [\"3 bar\"]\ncontraction = \"1 %..20 %\"\nshape = \"loops\"\ncycles = 6\nperiod = \"50 s\"\nrows = 50\n";
    let protocol = folder.write("protocol.toml", &format!("{block}[noise]\nforce = \"2 N\"\n"));
    let hidden = ["--effects", &own, "--with", "growing-hum=20 N,11 s"];
    let [data, muscle] = simulated(&folder, "trial", [&protocol, "7"], &hidden);
    let listed = folder.names();
    let bent = folder.path("bent.toml");
    let call = ["fit", &data, "--muscle", &muscle, "--effects", &own, "--with", "hum", "--form-error", &bent];
    let found = json(&[&call[..], &["--json"]].concat());
    let drawn = &found["drawn"];
    let (exact, wanted) = (drawn["rmse_n"].as_f64().unwrap(), drawn["bent_rmse_n"].as_f64().unwrap());
    assert!(wanted < 2.1 && wanted < 0.8 * exact, "the data do bend it: {exact} {wanted}");
    let form = &drawn["forms"][0];
    assert!(form["form_error"]["share"].as_f64().unwrap() > 0.05 && form["written"].is_null(), "{form}");
    let says = form["says"].as_str().unwrap();
    assert!(says.starts_with("hum is not written: ") && says.contains("along the time"), "{says}");
    let learnt = folder.path("learnt.toml");
    let text = stdout(&[&call[..], &["--out", &learnt]].concat());
    has_parts(&text, &[says, &format!("{bent} is not written: there is no form")]);
    assert!(Path::new(&learnt).is_file() && !Path::new(&bent).exists());
    fs::remove_file(&learnt).unwrap();
    assert_eq!(folder.names(), listed);
}

#[test]
fn what_a_fit_writes_is_kept_apart_from_what_it_reads() {
    let folder = Folder::new("fit-apart");
    let data = folder.write("data.csv", "no measurements: they are not even read\n");
    let own = folder.write("own.toml", OWN_FRICTION);
    let muscle = folder.write("muscle.toml", &fs::read_to_string(MUSCLE).unwrap());
    fs::create_dir(folder.0.join("inner")).unwrap();
    let kept = folder.write("kept.toml", "as it was\n");
    let names = ["data.csv", "own.toml", "muscle.toml", "kept.toml"];
    let read = || names.map(|name| fs::read(folder.0.join(name)).unwrap());
    let (before, listed) = (read(), folder.names());
    let same = |name: &str| folder.path(&format!("inner/../{name}"));
    let (new, new_again) = (folder.path("new.toml"), same("new.toml"));
    let [data_again, own_again, muscle_again, kept_again] = names.map(same);
    for (option, more) in [
        ("--out", &["--form-error", &new, "--out", &new][..]),
        ("--out", &["--form-error", &new, "--out", &new_again]),
        ("--out", &["--form-error", &kept, "--out", &kept_again]),
        ("--out", &["--form-error", "-", "--out", "/dev/stdout"]),
        ("--out", &["--form-error", "-"]),
        ("--form-error", &["--form-error", &data]),
        ("--form-error", &["--form-error", &data_again, "--json"]),
        ("--form-error", &["--form-error", &own_again, "--out", &new]),
        ("--form-error", &["--form-error", &muscle_again, "--out", &new]),
        ("--out", &["--out", &data_again]),
        ("--out", &["--form-error", &new, "--out", &own]),
    ] {
        let call = ["fit", &data, "--muscle", &muscle, "--effects", &own, "--with", "own-friction"];
        let (status, message) = failure(&[&call[..], more].concat());
        assert!(status == 1 && message.starts_with(&format!("error: {option}: ")), "{more:?}: {message}");
        assert!(
            message.contains("give the name of another file") && message.lines().count() == 1,
            "{message}"
        );
        assert_eq!(read(), before, "{more:?}");
        assert_eq!(folder.names(), listed, "{more:?}");
    }
    // If one of two files can't be written, neither is.
    let nowhere = folder.path("nowhere/learnt.toml");
    let call =
        ["fit", &data, "--muscle", &muscle, "--with", "creep", "--form-error", &new, "--out", &nowhere];
    refused(&call, 1, &["there is no folder"]);
    assert_eq!(folder.names(), listed);
}

#[test]
fn a_learnt_muscle_may_take_the_place_of_the_one_that_was_read() {
    let folder = Folder::new("fit-in-place");
    let [data, muscle] = with(&folder, "coulomb-friction=14 N");
    stdout(&["fit", &data, "--muscle", &muscle, "--with", "coulomb-friction", "--out", &muscle]);
    assert!(fs::read_to_string(&muscle).unwrap().contains("[effects.coulomb-friction]"));
}

/// Rubber of another form than that of the catalogue, by Gent (1996).
const GENT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/data/gent-liner.toml");

fn gent(folder: &Folder, name: &str, numbers: &str) -> [String; 2] {
    let hidden = format!("gent-liner={numbers}");
    simulated(folder, name, [PROTOCOL, "7"], &["--effects", GENT, "--with", &hidden])
}

#[test]
fn the_page_on_drawn_forms_says_what_the_commands_say() {
    let page = include_str!("../../../../docs/drawn-form.md");
    let folder = Folder::new("drawn-form");
    let [data, muscle] = gent(&folder, "gent", "150 N,1");
    // They are the files shipped with the tour.
    let shipped = concat!(env!("CARGO_MANIFEST_DIR"), "/data/own-form/data.csv");
    assert_eq!(fs::read_to_string(&data).unwrap(), fs::read_to_string(shipped).unwrap());
    let about = [&data[..], "--muscle", &muscle, "--json"];
    let first = json(&[&["diagnose"], &about[..]].concat());
    let named = &first["missing"][0];
    assert_eq!((&named["mechanism"], &named["fitted"]), (&"rubber".into(), &"bladder-axial".into()));
    // The ladder has the same errors for the formula and for the form.
    let ladder: Vec<String> = first["ladder"]
        .as_array()
        .unwrap()
        .iter()
        .map(|rung| format!("{} {} {:.2}", rung["added"], rung["bent"], rung["rmse_n"].as_f64().unwrap()))
        .collect();
    assert_eq!(ladder[1..], ["\"bladder-axial\" false 6.48", "\"bladder-axial\" true 2.22"]);
    assert!(first["ladder"][2]["held_out_rmse_n"].is_null() && first["ladder"][2]["adequate"] == true);
    let (bent, learnt) = (folder.path("bent.toml"), folder.path("learnt.toml"));
    let fit = ["--with", "bladder-axial", "--form-error", &bent, "--out", &learnt];
    let fitted = json(&[&["fit"], &about[..], &fit].concat());
    let with = ["--effects", &bent, "--with", "bladder-axial-bent"];
    let compared = json(&[&["compare"], &about[..], &with].concat());
    let row = |model: &str, error: &Value| {
        let error = error.as_f64().unwrap();
        let digits = if error < 10.0 { 2 } else { 1 };
        format!("| {model} | {error:.digits$} N |")
    };
    for row in [
        row("equilibrium", &fitted["before_rmse_n"]),
        row("+ bladder-axial, by its formula", &fitted["rmse_n"]),
        row("+ bladder-axial-bent, as the data want it", &compared["ladder"][1]["rmse_n"]),
    ] {
        assert!(page.contains(&row), "{row}");
    }
    let again = json(&[&["diagnose"], &about[..], &with].concat());
    assert_eq!(again["verdict"], "adequate");
    // A relaxation slower than any sweep acts as a spring: it must not replace rubber with limited chain
    // extensibility.
    for numbers in ["150 N,0.3", "150 N,0.6"] {
        let [data, muscle] = gent(&folder, "shorter", numbers);
        let found = json(&["diagnose", &data, "--muscle", &muscle, "--json"]);
        let missing = found["missing"].as_array().unwrap();
        assert!(missing.len() == 1 && missing[0]["fitted"] == "bladder-axial", "{numbers}: {missing:?}");
    }
}
