//! `compare` and `fit` as seen by a user: ladders on data with a known truth, output files as further input,
//! and messages for bad input.

use crate::support::{Folder, PROTOCOL, failure, has_parts, json, line, refused, simulated, stdout};
use bulge_effects::{Catalogue, Moment};
use bulge_model::{Model, Record, Wanted};
use bulge_muscles::from_toml;
use serde_json::Value;
use std::fmt::Write;
use std::path::Path;

const MUSCLE: &str =
    "name = \"trial\"\nkind = \"pleated\"\nlength = \"110 mm\"\nradius = \"16 mm\"\nfibres = 40\n";

/// Loops at five pressures of a muscle with elastic fibres and friction, read without noise to 0.01 N.
fn loops(truth: &[(&str, &[f64])]) -> String {
    let muscle = from_toml(MUSCLE, "muscle").unwrap();
    let catalogue = Catalogue::builtin();
    let mut model = Model::new(&muscle);
    for (name, values) in truth {
        model = model.with(catalogue.find(name).unwrap(), Some(values)).unwrap();
    }
    let mut moments = Vec::new();
    let mut sweeps = Vec::new();
    for bar in 1..=5 {
        let start = moments.len();
        for i in 0..40 {
            let (back, direction) = if i < 20 { (i, 1.0) } else { (39 - i, -1.0) };
            let mut moment = Moment::at_rest(f64::from(bar) * 1e5, 0.05 + 0.012 * f64::from(back));
            moment.direction = direction;
            moment.begins = i == 0;
            moments.push(moment);
        }
        sweeps.push(start..moments.len());
    }
    let record = Record::from_moments(moments.clone(), vec![0.0; moments.len()], sweeps).unwrap();
    let force = model.evaluate(&record, &model.start(), &Wanted::default()).unwrap().force;
    let mut csv = String::from("time [s],sweep,pressure [bar],contraction [%],force [N]\n");
    for (i, (moment, force)) in moments.iter().zip(force).enumerate() {
        let _ = writeln!(
            csv,
            "{},{},{},{:.4},{force:.2}",
            i,
            i / 40 + 1,
            moment.pressure / 1e5,
            100.0 * moment.contraction
        );
    }
    csv
}

/// Fibres of 250 kN, friction of 12 N.
const TRUTH: &[(&str, &[f64])] = &[("fibre-stretch", &[4e-6]), ("coulomb-friction", &[12.0])];

/// A folder with the loops of this muscle, and its two files.
fn measured(name: &str) -> (Folder, [String; 2]) {
    let folder = Folder::new(name);
    let files = [folder.write("data.csv", &loops(TRUTH)), folder.write("muscle.toml", MUSCLE)];
    (folder, files)
}

fn rmse(document: &Value, rung: usize) -> f64 {
    document["ladder"][rung]["rmse_n"].as_f64().unwrap()
}

#[test]
fn the_error_falls_as_the_right_effects_are_added() {
    let (_folder, [data, muscle]) = measured("ladder");
    let found =
        json(&["compare", &data, "--muscle", &muscle, "--with", "fibre-stretch,coulomb-friction", "--json"]);
    assert_eq!(found["schema"], "bulge.comparison/1");
    assert_eq!(found["data"]["rows"], 200);
    let errors = [0, 1, 2].map(|rung| rmse(&found, rung));
    assert!(errors[0] > 20.0 && errors[1] < 13.0 && errors[2] < 0.01, "{errors:?}");
    let held_out = found["ladder"][2]["held_out_rmse_n"].as_f64().unwrap();
    assert!(held_out < 0.01, "{held_out}");
    for (number, truth) in
        found["ladder"][2]["fit"]["parameters"].as_array().unwrap().iter().zip([250.0, 12.0])
    {
        // The compliance is shown together with its stiffness.
        let value = number["also"][1].as_f64().or(number["value"].as_f64()).unwrap();
        assert!((value / truth - 1.0).abs() < 1e-3, "{number}");
        assert_eq!(number["plausible"], true);
    }
}

#[test]
fn a_report_holds_page_plots_and_numbers() {
    let (folder, [data, muscle]) = measured("report");
    let out = folder.path("report");
    stdout(&["compare", &data, "--muscle", &muscle, "--with", "fibre-stretch", "--out", &out]);
    let page = std::fs::read_to_string(Path::new(&out).join("report.html")).unwrap();
    assert!(page.starts_with("<!DOCTYPE html>") && page.matches("<svg").count() >= 8);
    for name in ["ladder", "force", "residual-map", "loops", "contributions", "scatter", "parameters"] {
        assert!(Path::new(&out).join(format!("{name}.svg")).is_file(), "{name}.svg");
    }
    let numbers = std::fs::read_to_string(Path::new(&out).join("compare.json")).unwrap();
    let numbers: Value = serde_json::from_str(&numbers).unwrap();
    assert_eq!(numbers["muscle"], "trial");
}

#[test]
fn what_was_learnt_is_used() {
    let (folder, [data, muscle]) = measured("learnt");
    let learnt = folder.path("learnt.toml");
    let with = "fibre-stretch,coulomb-friction";
    let fit = json(&["fit", &data, "--muscle", &muscle, "--with", with, "--out", &learnt, "--json"]);
    assert_eq!(fit["schema"], "bulge.fit/1");
    assert_eq!(fit["written"], serde_json::json!(["fibre-stretch", "coulomb-friction"]));
    let text = std::fs::read_to_string(&learnt).unwrap();
    assert!(text.contains("[effects.coulomb-friction]") && text.starts_with("# Fitted to"), "{text}");
    // The next comparison starts with the result of this fit.
    let next = json(&["compare", &data, "--muscle", &learnt, "--json"]);
    let [fitted, start] = [fit["rmse_n"].as_f64().unwrap(), rmse(&next, 0)];
    assert!((start / fitted - 1.0).abs() < 1e-3, "{start} after {fitted}");
    // The shape is that of elastic fibres; friction has no direction at rest.
    let shape = |file: &str| {
        json(&["shape", file, "--pressure", "3 bar", "--contraction", "10 %", "--json"])["force_n"]
            .as_f64()
            .unwrap()
    };
    let elastic = folder.write("elastic.toml", &format!("{MUSCLE}fibre = {{ stiffness = \"6.25 kN\" }}\n"));
    assert!((shape(&learnt) / shape(&elastic) - 1.0).abs() < 1e-4);
    assert!((shape(&learnt) / shape(&muscle) - 1.0).abs() > 1e-3);
    stdout(&["curve", &learnt, "--pressure", "3 bar", "--points", "5"]);
    // Standard output is the file itself.
    assert_eq!(stdout(&["fit", &data, "--muscle", &muscle, "--with", with]), text);
}

/// The posterior as a picture and as draws, the covariance in the document, and a loss that sees a spike off.
#[test]
fn how_sure_a_fit_is_can_be_drawn_and_read() {
    let (folder, [data, muscle]) = measured("sure");
    let [picture, draws, learnt] = ["sure.svg", "draws.csv", "learnt.toml"].map(|name| folder.path(name));
    let call =
        ["fit", &data, "--muscle", &muscle, "--with", "fibre-stretch,coulomb-friction", "--out", &learnt];
    let files = ["--posterior", &picture, "--draws", &draws, "--json"];
    let fit = json(&[&call[..], &files].concat());
    let parameters = fit["posterior"]["parameters"].as_array().unwrap();
    assert_eq!(parameters.len(), 2);
    assert_eq!(fit["fit"]["covariance"].as_array().unwrap().len(), 4);
    assert_eq!((&fit["fit"]["loss"], &fit["fit"]["downweighted"]), (&"squares".into(), &0.into()));
    let svg = std::fs::read_to_string(&picture).unwrap();
    has_parts(&svg, &["<svg", "force [N]", "profile likelihood"]);
    let table = std::fs::read_to_string(&draws).unwrap();
    let mut lines = table.lines();
    assert!(lines.next().unwrap().contains("coulomb-friction.force [N]"));
    assert_eq!(fit["posterior"]["count"], lines.filter(|line| line.split(',').count() == 2).count());
    // A reading a hundred newtons off.
    let text = std::fs::read_to_string(&data).unwrap();
    let mut rows: Vec<String> = text.lines().map(str::to_owned).collect();
    let spiked = rows.len() / 2;
    let (before, force) = rows[spiked].rsplit_once(',').unwrap();
    rows[spiked] = format!("{before},{}", force.parse::<f64>().unwrap() + 100.0);
    let spiked = folder.write("spiked.csv", &rows.join("\n"));
    let friction = |loss: &str| {
        let fit = json(&[
            "fit",
            &spiked,
            "--muscle",
            &muscle,
            "--with",
            "coulomb-friction",
            "--loss",
            loss,
            "--json",
        ]);
        (fit["fit"]["parameters"][0]["value"].as_f64().unwrap(), fit["fit"]["downweighted"].as_u64().unwrap())
    };
    let [(plain, none), (robust, one)] = ["squares", "cauchy"].map(friction);
    assert!(none == 0 && one >= 1, "{none} {one}");
    assert!((plain - robust).abs() > 0.1, "{plain} {robust}");
    refused(&[&call[..], &["--loss", "hubert"]].concat(), 2, &["huber"]);
}

#[test]
fn a_users_own_effect_is_one_of_all() {
    let folder = Folder::new("own");
    let data = folder.write("data.csv", &loops(&[("coulomb-friction", &[12.0])]));
    let muscle = folder.write("muscle.toml", MUSCLE);
    let own = folder.write(
        "own.toml",
"[effects.my-drag]\ntitle = \"Drag\"\nforce = \"-drag * direction\"\nparameters.drag = { unit = \"N\", typical = \"5 N\", low = \"0 N\", high = \"100 N\" }\n",
    );
    has_parts(&stdout(&["effects", "--effects", &own]), &["my-drag"]);
    let learnt = folder.path("learnt.toml");
    let fit = json(&line(&format!(
        "fit {data} --muscle {muscle} --effects {own} --with my-drag --out {learnt} --json"
    )));
    let drag = fit["fit"]["parameters"][0]["value"].as_f64().unwrap();
    assert!((drag - 12.0).abs() < 0.01, "{drag}");
    refused(&["compare", &data, "--muscle", &learnt], 1, &["my-drag", "--effects"]);
    let next = json(&["compare", &data, "--muscle", &learnt, "--effects", &own, "--json"]);
    assert!(rmse(&next, 0) < 0.01);
}

/// A formula without a value at any row: the fit can't begin, says where, and writes nothing.
#[test]
fn a_fit_that_can_not_begin_writes_nothing() {
    let folder = Folder::new("no-beginning");
    let [data, muscle] = simulated(&folder, "trial", [PROTOCOL, "7"], &[]);
    let own = folder.write(
        "own.toml",
        "[effects.ends]\ntitle = \"Ends\"\nenergy = \"k*ln(1.001 - l2)\"\n\
         parameters.k = { unit = \"N/m\", typical = \"100 N/m\", low = \"0 N/m\", high = \"1e4 N/m\" }\n",
    );
    let learnt = folder.path("learnt.toml");
    let call = ["fit", &data, "--muscle", &muscle, "--effects", &own, "--with", "ends", "--out", &learnt];
    let (status, message) = failure(&call);
    assert_eq!(status, 1, "{message}");
    has_parts(&message, &["nothing was fitted", "the formula for `energy`", "l2 = 1.", "finite"]);
    assert!(!Path::new(&learnt).exists());
}

#[test]
fn bad_input_gets_one_clear_message() {
    let folder = Folder::new("bad");
    let muscle = folder.write("muscle.toml", MUSCLE);
    let good = "pressure [bar],contraction [%],force [N]\n";
    let cases: &[(&str, &[&str])] = &[
        ("", &["empty"]),
        (good, &["no row"]),
        ("pressure [bar],contraction [%],thrust [kg m]\n1,5,100\n", &["thrust", "`force [N]`", "--columns"]),
        ("pressure [bar],contraction [%]\n1,5\n", &["force"]),
        (
            "pressure [bar],contraction [%],force [N]\n1,5,100\n1,abc,90\n",
            &["1 of 2 rows", "`contraction [%]` is not a number (line 3)"],
        ),
        ("pressure [mm],contraction [%],force [N]\n1,5,100\n", &["pressure", "mm"]),
        (
            "pressure [bar],contraction [%],force [N]\n1,5,100\n1,5\n",
            &["fewer fields than the header (line 3)"],
        ),
    ];
    for (text, parts) in cases {
        let data = folder.write("data.csv", text);
        refused(&["compare", &data, "--muscle", &muscle], 1, parts);
    }
    let one = folder.write("data.csv", &format!("{good}1,5,100\n"));
    refused(
        &["compare", &one, "--muscle", &muscle, "--with", "fibre-stretch"],
        1,
        &["1 numbers (those of effects", "can't be fitted to 1 rows"],
    );
    let same = folder.write("data.csv", &(good.to_owned() + &"1,5,900\n".repeat(9)));
    refused(
        &["compare", &same, "--muscle", &muscle, "--with", "fibre-stretch"],
        1,
        &["all 9 rows are identical"],
    );
    let data = folder.write("data.csv", &loops(&[]));
    for (arguments, parts) in [
        (["--with", "fibre-strech"], ["fibre-strech", "did you mean `fibre-stretch`"]),
        (["--with", "radius-error"], ["braided muscles", "leave it out"]),
        (["--with", "coulomb-friction,coulomb-friction"], ["coulomb-friction", "twice"]),
        (["--with", "temperature"], ["temperature", "these data don't have"]),
        (["--law", "s9"], ["s9", "bulge effects --laws"]),
        (["--effects", "nowhere.toml"], ["nowhere.toml", ""]),
    ] {
        refused(&[&["compare", &data, "--muscle", &muscle], &arguments[..]].concat(), 1, &parts);
    }
    // Nothing is left behind.
    assert_eq!(folder.names(), ["data.csv", "muscle.toml"]);
}

/// A parameter that is fixed, bounded or tied is so in every answer, and in the fitted muscle file.
#[test]
fn numbers_are_held_bounded_and_tied() {
    let (folder, [data, muscle]) = measured("held");
    let with = "fibre-stretch,coulomb-friction";
    let compared = |more: &[&str]| {
        json(&[&["compare", &data, "--muscle", &muscle, "--with", with, "--json"], more].concat())
    };
    let held = compared(&["--hold", "coulomb-friction.force=10 N"]);
    let last = &held["ladder"][2];
    assert_eq!((last["fitted"].as_u64(), last["fit"]["parameters"].as_array().unwrap().len()), (Some(1), 1));
    assert_eq!(
        (&last["held"][0]["how"], last["held"][0]["value"].as_f64()),
        (&serde_json::json!("held"), Some(10.0))
    );
    // Of 12 N of friction 2 N remain, in both directions.
    assert!((rmse(&held, 2) - 2.0).abs() < 0.02, "{}", rmse(&held, 2));
    let bounded = compared(&["--bound", "coulomb-friction=1..11 N"]);
    assert!((rmse(&bounded, 2) - 1.0).abs() < 0.02, "{}", rmse(&bounded, 2));
    let with_offset = "coulomb-friction,force-offset";
    let tied = json(&line(&format!(
        "compare {data} --muscle {muscle} --with {with_offset} --tie force-offset.offset=coulomb-friction.force --json"
    )));
    assert_eq!(tied["ladder"][2]["held"][0]["to"], "coulomb-friction.force");
    let learnt = folder.path("learnt.toml");
    let hold = "coulomb-friction.force=10 N";
    let says = stdout(&["fit", &data, "--muscle", &muscle, "--with", with, "--hold", hold, "--out", &learnt]);
    has_parts(&says, &["numbers that were not fitted", "10.00 N"]);
    let text = std::fs::read_to_string(&learnt).unwrap();
    has_parts(&text, &["force = \"10 N\"", "# coulomb-friction force = 10 N (held)"]);
    let told =
        stdout(&["diagnose", &data, "--muscle", &muscle, "--with", "coulomb-friction", "--hold", hold]);
    assert!(told.contains("bulge fit") && told.contains("--hold \"coulomb-friction.force=10 N\""), "{told}");
    for (arguments, parts) in [
        (["--hold", "coulomb-frction.force=1 N"], ["--hold: ", "did you mean `coulomb-friction`"]),
        (["--hold", "coulomb-friction.forc=1 N"], ["has no `forc`", "did you mean `coulomb-friction.force`"]),
        (["--hold", "coulomb-friction.force=1 mm"], ["is a force", "`1 mm` is a length"]),
        (["--hold", "coulomb-friction.force=-1 N"], ["out of the bounds", "lies between"]),
        (["--hold", "force-offset.offset=1 N"], ["isn't fitted", "name it in --with"]),
        (["--bound", "coulomb-friction.force=3 N"], ["--bound: ", "is no range"]),
        (["--tie", "coulomb-friction.force=fibre-stretch.compliance"], ["--tie: ", "same unit"]),
    ] {
        refused(
            &[&["compare", &data, "--muscle", &muscle, "--with", with], &arguments[..]].concat(),
            1,
            &parts,
        );
    }
    let both = ["--hold", hold, "--bound", "coulomb-friction.force=1..3 N"];
    let call = [&["compare", &data, "--muscle", &muscle, "--with", with], &both[..]].concat();
    refused(&call, 1, &["is held and bounded"]);
}

/// Every row is written with the forces of the first and the last rung, and Bulge reads that file as it read
/// the first.
#[test]
fn rows_are_written_and_read_again() {
    let folder = Folder::new("rows");
    let data = folder.write("data.csv", &(loops(TRUTH) + "200,6,0,10,3\n"));
    let muscle = folder.write("muscle.toml", MUSCLE);
    let compared = |data: &str, more: &[&str]| {
        let call = ["compare", data, "--muscle", &muscle, "--with", "coulomb-friction", "--json"];
        json(&[&call, more].concat())
    };
    let files = ["rows.csv", "rows.parquet"].map(|name| folder.path(name));
    let first = compared(&data, &["--rows", &files[0]]);
    assert_eq!(compared(&data, &["--rows", &files[1]]), first);
    let text = std::fs::read_to_string(&files[0]).unwrap();
    let mut lines = text.lines();
    let heading = "file,line,sweep,specimen,counts,why,time [s],pressure [Pa],contraction [-],force [N],base force [N],model force [N],residual [N]";
    assert_eq!(lines.next(), Some(heading));
    let cells = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<_>>();
    let (mut square, mut rows) = (0.0, 0);
    for (number, line) in lines.by_ref().take(200).enumerate() {
        let cells = cells(line);
        assert_eq!((cells[1].as_str(), cells[4].as_str()), ((number + 2).to_string().as_str(), "true"));
        let [force, model, residual] = [9, 11, 12].map(|at| cells[at].parse::<f64>().unwrap());
        assert_eq!((force - model).to_bits(), residual.to_bits());
        (square, rows) = (square + residual * residual, rows + 1);
    }
    let found = (square / f64::from(rows)).sqrt();
    assert!((found / rmse(&first, 1) - 1.0).abs() < 1e-9, "{found}");
    let last = cells(lines.next().unwrap());
    assert!(
        last[4] == "false" && last[5].contains("no gauge pressure") && last[10..] == ["", "", ""],
        "{last:?}"
    );
    for file in &files {
        let again = compared(file, &[]);
        assert_eq!(again["data"]["sweeps"], first["data"]["sweeps"]);
        for rung in 0..2 {
            assert!((rmse(&again, rung) / rmse(&first, rung) - 1.0).abs() < 1e-9, "{file}");
        }
    }
    refused(&["compare", &data, "--muscle", &muscle, "--rows", &data], 1, &["the data file, which is read"]);
}

/// A muscle fitted to one test predicts another, with or without a measured force.
#[test]
fn a_learnt_muscle_predicts_new_rows() {
    let (folder, [data, muscle]) = measured("predict");
    let learnt = folder.path("learnt.toml");
    let with = "fibre-stretch,coulomb-friction";
    stdout(&["fit", &data, "--muscle", &muscle, "--with", with, "--out", &learnt]);
    let file = folder.path("predicted.csv");
    let found = json(&["predict", &data, "--muscle", &learnt, "--out", &file, "--json"]);
    assert_eq!((found["schema"].as_str(), found["rows"].as_u64()), (Some("bulge.prediction/1"), Some(200)));
    let coverage = found["against"]["coverage"].as_f64().unwrap();
    assert!(coverage > 0.9 && found["against"]["rmse_n"].as_f64().unwrap() < 0.01, "{}", found["against"]);
    assert_eq!(found["uncertain"].as_array().unwrap().len(), 2);
    let heading = std::fs::read_to_string(&file).unwrap().lines().next().unwrap().to_owned();
    let ending = "pressure [Pa],contraction [-],force [N],model force [N],model uncertainty [N],low [N],high [N],residual [N]";
    assert!(heading.ends_with(ending), "{heading}");
    // The same rows without their force.
    let bare: String =
        loops(TRUTH).lines().map(|line| line.rsplit_once(',').unwrap().0.to_owned() + "\n").collect();
    let bare = folder.write("bare.csv", &bare);
    let again = json(&["predict", &bare, "--muscle", &learnt, "--json"]);
    assert_eq!(again["columns"]["force_n"], found["columns"]["force_n"]);
    assert!(again["against"].is_null() && again["columns"]["measured_n"].is_null());
    let told = stdout(&["predict", &bare, "--muscle", &learnt]);
    has_parts(&told, &["200 of 200 rows have a state", "no force to compare with"]);
    refused(&["compare", &bare, "--muscle", &learnt], 1, &["force"]);
    refused(
        &["predict", &data, "--muscle", &learnt, "--out", &learnt],
        1,
        &["the muscle file, which is read"],
    );
}

/// The base may be wrong: a muscle that would push where this one pulls is compared all the same, with a
/// warning.
#[test]
fn a_base_that_would_push_is_shown_with_a_warning() {
    let folder = Folder::new("pushes");
    let muscle = folder.write("muscle.toml", MUSCLE);
    let rows =
        "1,10,900\n1,12,800\n1,14,700\n1,20,500\n1,52,1000\n1,53,900\n2,52,1900\n2,53,1900\n2,54,1800\n";
    let data = folder.write("data.csv", &format!("pressure [bar],contraction [%],force [N]\n{rows}"));
    has_parts(&stdout(&["compare", &data, "--muscle", &muscle]), &["would push at 5 of 9 rows (line 6-10;"]);
}

/// A file as written by a laboratory, with an unusable row and one without pressure, also from standard
/// input; guesses are reported.
#[test]
fn a_laboratory_file_goes_in_as_it_is() {
    let folder = Folder::new("laboratory");
    let muscle = folder.write("muscle.toml", MUSCLE);
    // Semicolons between columns, commas in numbers.
    let german = |line: &str| line.replace(',', ";").replace('.', ",");
    let mut lines: Vec<String> = loops(TRUTH).lines().skip(1).map(german).collect();
    lines.insert(10, "9,5;1;1;#N/A;3".to_owned());
    lines.push("1000;6;-0,00241;5;1".to_owned());
    let text = format!(
        "Operator: me\nRate: 10 Hz\n\nZeit / s;sweep;Druck (bar);Kontraktion [%];Kraft_N;Notiz\n{}\n",
        lines.iter().map(|line| format!("{line};ok")).collect::<Vec<_>>().join("\n")
    );
    let data = folder.write("data.csv", &text);
    let found = json(&["compare", &data, "--muscle", &muscle, "--json"]);
    assert_eq!(found["data"]["used"], 200);
    let apart = found["data"]["set_apart"].as_array().unwrap();
    assert_eq!((apart.len(), found["data"]["set_apart_rows"].as_u64()), (2, Some(2)), "{apart:?}");
    assert_eq!(apart[0]["row"], 15);
    assert!(apart[0]["reason"].as_str().unwrap().contains("`#N/A` is not a number"), "{apart:?}");
    assert!(apart[1]["reason"].as_str().unwrap().contains("-241 Pa"), "{apart:?}");
    assert_eq!(found["data"]["columns"][2]["quantity"], "pressure");
    let plain = folder.write("plain.csv", &loops(TRUTH));
    let exact = json(&["compare", &plain, "--muscle", &muscle, "--json"]);
    assert!((rmse(&found, 0) - rmse(&exact, 0)).abs() < 1e-9 * rmse(&exact, 0));
    let said = stdout(&["compare", &data, "--muscle", &muscle]);
    let parts = ["taken for", "Kraft_N", "ignored: Notiz", "decimal commas", "set apart 2 rows", "line 15"];
    has_parts(&said, &parts);
    // The mapping from the muscle file, and standard input.
    let odd = text.replace("Kraft_N", "ch4").replace("Druck (bar)", "ch2");
    let mapped = folder.write(
        "mapped.toml",
        &format!("{MUSCLE}\n[data.columns]\nforce = \"ch4 [N]\"\npressure = \"ch2 [bar]\"\n"),
    );
    let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_bulge"))
        .args(["compare", "-", "--muscle", &mapped, "--json"])
        .stdin(std::process::Stdio::piped())
        .stdout(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    std::io::Write::write_all(&mut child.stdin.take().unwrap(), odd.as_bytes()).unwrap();
    let answer: Value = serde_json::from_slice(&child.wait_with_output().unwrap().stdout).unwrap();
    assert_eq!(rmse(&answer, 0).to_bits(), rmse(&found, 0).to_bits());
    let file = folder.write("odd.csv", &odd);
    refused(&["compare", &file, "--muscle", &muscle], 1, &["2 things", "--columns"]);
    let wrong = "force=ch9 [N]";
    refused(
        &["compare", &file, "--muscle", &mapped, "--columns", wrong],
        1,
        &["there is no column `ch9 [N]`"],
    );
}

/// A file without any unit gives the same result, and the guesses are reported with their reason; a unit that
/// is ambiguous is asked for.
#[test]
fn units_that_are_not_written_are_guessed_or_asked_for() {
    let folder = Folder::new("no-units");
    let muscle = folder.write("muscle.toml", MUSCLE);
    let text = loops(TRUTH);
    let data = folder.write("data.csv", &text);
    let bare = "time,sweep,p,contraction,force\n".to_owned() + text.split_once('\n').unwrap().1;
    let file = folder.write("bare.csv", &bare);
    let [exact, found] = [&data, &file].map(|file| json(&["compare", file, "--muscle", &muscle, "--json"]));
    assert_eq!(rmse(&found, 0).to_bits(), rmse(&exact, 0).to_bits());
    assert_eq!([2, 3].map(|i| found["data"]["columns"][i]["unit"].clone()), ["bar", "%"]);
    let said = stdout(&["compare", &file, "--muscle", &muscle]);
    assert!(said.contains("no unit is written: the forces are"), "{said}");
    // With pounds for newtons the pressure could be in psi.
    let in_pounds = |line: &str| {
        let (rest, force) = line.rsplit_once(',').unwrap();
        force.parse::<f64>().map_or_else(|_| line.to_owned(), |force| format!("{rest},{}", force / 4.448_222))
    };
    let pounds = bare.lines().map(in_pounds).collect::<Vec<_>>().join("\n");
    let file = folder.write("pounds.csv", &pounds);
    refused(&["compare", &file, "--muscle", &muscle], 1, &["pressure=p [bar], force=force [lbf]"]);
    let obeyed =
        ["compare", &file, "--muscle", &muscle, "--columns", "pressure=p [bar], force=force [lbf]", "--json"];
    assert!((rmse(&json(&obeyed), 0) / rmse(&exact, 0) - 1.0).abs() < 1e-3);
}

/// A specimen without rows, a stated direction opposite to the motion, a held length that drifts: each is
/// reported with its remedy.
#[test]
fn what_contradicts_the_rows_is_said() {
    let folder = Folder::new("contradicts");
    let stated = folder.write("stated.toml", &format!("{MUSCLE}\n[specimens.short]\nlength = \"80 mm\"\n"));
    let muscle = folder.write("muscle.toml", MUSCLE);
    let data = folder.write("data.csv", &loops(TRUTH));
    refused(&["compare", &data, "--muscle", &stated], 1, &["no row of the data is of the specimen `short`"]);
    // Labelled opposite to the motion.
    let labelled = |line: &str| match line.split(',').next().and_then(|text| text.parse::<usize>().ok()) {
        Some(row) => format!("{line},{},shrot", if row % 40 < 20 { "down" } else { "up" }),
        None => format!("{line},direction,specimen"),
    };
    let text = loops(TRUTH).lines().map(labelled).collect::<Vec<_>>().join("\n");
    let labelled = folder.write("labelled.csv", &text);
    refused(&["compare", &labelled, "--muscle", &stated], 1, &["`[specimens.shrot]`"]);
    let said = stdout(&["compare", &labelled, "--muscle", &muscle]);
    assert!(said.contains("with a direction against the motion"), "{said}");
    let mut held = "time [s],pressure [bar],length [mm],force [N]\n".to_owned();
    for i in 0..200 {
        let pressure = 1.0 + 0.04 * f64::from(if i % 100 < 50 { i % 100 } else { 100 - i % 100 });
        let _ = writeln!(held, "{i},{pressure},{},{}", 100.0 + 0.005 * f64::from(i), 250.0 * pressure);
    }
    let held = folder.write("held.csv", &held);
    let said = stdout(&["compare", &held, "--muscle", &muscle]);
    assert!(said.contains("at held length, whose length changes by up to"), "{said}");
}

/// The output of `curve` can be read by `compare`, and has no error.
#[test]
fn a_curve_is_data() {
    let folder = Folder::new("curve-is-data");
    let csv = folder.path("curve.csv");
    stdout(&["curve", "dmsp-20-250", "--pressure", "1 bar,2 bar,3 bar", "--points", "31", "--csv", &csv]);
    let found = json(&["compare", &csv, "--muscle", "dmsp-20-250", "--json"]);
    assert!(rmse(&found, 0) < 1e-3, "{}", rmse(&found, 0));
    let columns = found["data"]["columns"].as_array().unwrap();
    assert!(
        columns.iter().any(|column| column["says"] == "ignored: it follows from the length"),
        "{columns:?}"
    );
}

/// Simulated tests in the formats of laboratories (`validation/real-tests/cases`): every file is read
/// unchanged, and compared.
#[test]
fn files_of_real_tests_are_answered_as_they_are() {
    let cases = concat!(env!("CARGO_MANIFEST_DIR"), "/../../validation/real-tests/cases");
    let mut kinds = Vec::new();
    for case in std::fs::read_dir(cases).unwrap() {
        let case = case.unwrap().path();
        let words = std::fs::read_to_string(case.join("args")).unwrap();
        let place = |word: &str| {
            let is_file = word.starts_with("data.") || word == "muscle.toml";
            if is_file { case.join(word).display().to_string() } else { word.to_owned() }
        };
        let words: Vec<String> = words.lines().map(place).collect();
        let arguments: Vec<&str> =
            ["compare", "--json"].into_iter().chain(words.iter().map(String::as_str)).collect();
        let found = json(&arguments);
        let base = &found["ladder"][0];
        // A muscle with friction has an error of some per cent of full scale; a misread one has far more.
        assert!(base["rmse_percent"].as_f64().unwrap() < 8.0, "{}: {base}", case.display());
        kinds.extend(found["data"]["sweep_kinds"].as_array().unwrap().iter().cloned());
    }
    for kind in ["isometric", "isotonic", "loop"] {
        assert!(kinds.iter().any(|found| found == kind), "{kind}");
    }
}

/// A sweep is excluded by its lines: the rows that count are those of the other sweeps.
#[test]
fn rows_are_left_out_by_their_lines() {
    let (_folder, [data, muscle]) = measured("exclude");
    let of = |more: &[&str]| json(&[&["compare", &data, "--muscle", &muscle, "--json"], more].concat());
    let (all, some) = (of(&[]), of(&["--exclude", "2-41"]));
    assert_eq!([&all, &some].map(|found| found["data"]["used"].as_u64().unwrap()), [200, 160]);
    let left = some["data"]["left_out"].as_array().unwrap();
    assert!(left.iter().any(|one| one["why"] == "excluded by hand" && one["lines"] == "2-41"), "{left:?}");
    // The first sweep is at the lowest pressure, where the fibres stretch least.
    assert!(rmse(&some, 0) > 1.05 * rmse(&all, 0), "{} {}", rmse(&some, 0), rmse(&all, 0));
    for (lines, part) in [("0-1", "no row"), ("x", "no line"), ("2-9999", "all rows")] {
        refused(&["compare", &data, "--muscle", &muscle, "--exclude", lines], 1, &[part]);
    }
    // The command proposed by a diagnosis contains the exclusion.
    let command = ["diagnose", &data, "--muscle", &muscle, "--with", "fibre-stretch", "--exclude", "2-41"];
    let said = stdout(&command);
    assert!(said.contains("--exclude 2-41") && said.contains("coulomb-friction"), "{said}");
    // A prediction has all rows; its errors are those of the other rows.
    let predicted = json(&["predict", &data, "--muscle", &muscle, "--exclude", "2-41", "--json"]);
    assert_eq!([&predicted["rows"], &predicted["against"]["rows"]].map(|n| n.as_u64().unwrap()), [200, 160]);
    assert_eq!(predicted["columns"]["force_n"].as_array().unwrap().len(), 200);
}
