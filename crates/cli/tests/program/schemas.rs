//! The documents of `--json` against `docs/schemas`: required fields are there, and a missing one is noticed.

use crate::schema::{self, holds};
use crate::support::{Folder, bulge, json, line};
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::Path;

/// Kinds of documents that take long to create or are no documents of the command. They are checked next to
/// the code that creates them, in `src/demo.rs`, `src/validate.rs`, and the tests of the workbench.
const ELSEWHERE: [&str; 7] = ["demo", "validation", "session", "session-file", "surface", "open", "failure"];

const KNEE: &str = "name = \"knee\"\nmuscle = \"ppam-2-r16\"\nkind = \"pulley\"\nradius = \"40 mm\"\ncontraction = \"20 %\"\n\
    angle = \"-25 deg..25 deg\"\npressure = \"0.5 bar..3 bar\"\n";
const SWEEP: &str = "muscle = \"ppam-2-r16\"\npressure = \"1 bar\"\noutputs = [\"force_f\", \"volume_v\"]\nchunk = 10\n\
    [axes.contraction]\nrange = \"2 %..limit\"\npoints = 5\n[axes.slenderness]\nrange = \"6..8\"\npoints = 4\n";
const TABLE: &str = "[table]\ntolerance = 1e-2\ngradient = 1e-1\nchecks = 100000\n";
const TUBE: &str = include_str!("../../../../meshes/tube.toml");

/// Documents of the program, one of each kind with a schema.
fn documents(folder: &Folder) -> Vec<Value> {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("data");
    let [rows, braid, protocol] =
        ["braid-loops.csv", "braid.toml", "protocol.toml"].map(|name| data.join(name).display().to_string());
    let few: Vec<String> =
        std::fs::read_to_string(&rows).unwrap().lines().take(8).map(str::to_owned).collect();
    let few = folder.write("few.csv", &(few.join("\n") + "\n"));
    let (learnt, trial) = (folder.path("learnt.toml"), folder.path("trial"));
    let with = "end-taper,bladder-elasticity,coulomb-friction";
    let on_braid = |command: &str, rows: &str, more: &[&str]| {
        json(&[&[command, rows, "--muscle", &braid, "--json"], more].concat())
    };
    let mut all = vec![
        on_braid("compare", &rows, &["--with", with, "--hold", "coulomb-friction.force=14 N", "--rivals"]),
        on_braid("diagnose", &rows, &["--among", "end-taper,bladder-elasticity,coulomb-friction"]),
        on_braid("diagnose", &few, &[]),
        on_braid("fit", &rows, &["--with", with, "--out", &learnt]),
        json(&["predict", &rows, "--muscle", &learnt, "--json"]),
        json(&["plan", "--muscle", &braid, "--protocol", &protocol, "--json"]),
        on_braid("next", &rows, &["--with", "end-taper,bladder-elasticity"]),
        json(&line(&format!(
            "simulate {braid} --protocol {protocol} --with coulomb-friction --out {trial} --json"
        ))),
    ];
    for call in [
        &["shape", "ppam-2-r16", "--pressure", "2 bar", "--contraction", "20 %"][..],
        &["shape", "dmsp-20-250", "--pressure", "2 bar", "--force", "100 N"],
        &["curve", "ppam-2-r16", "--pressure", "1 bar,2 bar", "--points", "5"],
        &["curve", "dmsp-20-250", "--pressure", "3 bar", "--points", "5"],
        &["effects"],
        &["effects", "bladder-elasticity"],
        &["effects", "end-taper"],
        &["effects", "--laws"],
        &["effects", "s2-cylinder"],
        &["effects", "s1-volume"],
        &["muscle"],
        &["muscle", "ppam-2-r16"],
        &["keys"],
        &["keys", "braided"],
        &["size", "--force", "500 N", "--stroke", "50 mm"],
        &["heat", "--pipe", "none"],
        &["sense", "ppam-2-r16", "--turns", "20"],
        &["air", "shut", "ppam-2-r16", "--pressure", "2 bar", "--contraction", "10 %"],
        &["air", "fill", "ppam-2-r16", "--supply", "3 bar", "--hole", "2 mm", "--held", "10 %"],
        &["air", "stroke", "ppam-2-r16", "--load", "200 N", "--stroke", "5 %..20 %", "--supply", "4 bar"],
    ] {
        all.push(json(&[call, &["--json"]].concat()));
    }
    all.extend(joints(folder));
    all.extend(tables(folder));
    let tube = folder.write("tube.toml", TUBE);
    all.push(json(&["membrane", &tube, "--out", &folder.path("tube"), "--json"]));
    all
}

/// A joint: its equilibrium, the torque that holds it, its pressures, its map, and shut valves.
fn joints(folder: &Folder) -> Vec<Value> {
    let knee = folder.write("knee.toml", KNEE);
    let of = |more: &[&str]| json(&[&["joint", &knee, "--json"], more].concat());
    let pressures = ["--pressure", "2 bar,1.5 bar"];
    vec![
        of(&[]),
        of(&[&pressures[..], &["--torque", "3 N m"]].concat()),
        of(&[&pressures[..], &["--angle", "4.5 deg", "--pressure-sd", "500 Pa"]].concat()),
        of(&["--angle", "4.5 deg", "--stiffness", "150 N m/rad"]),
        of(&[&pressures[..], &["--torque", "3 N m", "--closed", "adiabatic"]].concat()),
    ]
}

/// A failure has a document too: of a muscle that isn't there, and of a command line that isn't one.
#[test]
fn what_fails_says_so_in_a_document() {
    for (arguments, status) in [
        (&["shape", "nix", "--pressure", "1 bar", "--contraction", "20 %", "--json"][..], 1),
        (&["shape", "ppam-2-r16", "--pressure", "1 bar", "--contraction", "70 %", "--json"], 3),
        (&["shape", "ppam-2-r16", "--presure", "1 bar", "--json"], 2),
    ] {
        let output = bulge(arguments);
        let document: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(holds(&document).0, "failure");
        assert_eq!((output.status.code(), document["status"].as_i64()), (Some(status), Some(status.into())));
        let message = String::from_utf8(output.stderr).unwrap();
        assert!(message.contains(document["message"].as_str().unwrap().lines().next().unwrap()));
    }
}

/// Sweeps with and without a table, and the documents of the table.
fn tables(folder: &Folder) -> Vec<Value> {
    let (points, both) =
        (folder.write("points.toml", SWEEP), folder.write("both.toml", &(SWEEP.to_owned() + TABLE)));
    let (out, table) = (folder.path("both"), folder.path("both/table.bulge"));
    let at = "contraction=0.2,slenderness=7";
    vec![
        json(&["sweep", &points, "--out", &folder.path("points"), "--json"]),
        json(&["sweep", &both, "--out", &out, "--json"]),
        json(&["table", "info", &table, "--json"]),
        json(&["table", "eval", &table, "--at", at, "--json"]),
    ]
}

#[test]
fn documents_hold_what_their_schemas_name() {
    let folder = Folder::new("schemas");
    let mut seen = BTreeSet::new();
    let mut fields = 0;
    for document in documents(&folder) {
        let (kind, required) = holds(&document);
        fields += required;
        seen.insert(kind + ".json");
    }
    assert!(fields > 700, "{fields}");
    seen.extend(ELSEWHERE.map(|kind| format!("{kind}.json")));
    let names = std::fs::read_dir(schema::folder())
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap());
    assert_eq!(seen, names.collect::<BTreeSet<_>>());
}
