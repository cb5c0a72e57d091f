//! The documents of `--json` against `docs/schemas`: what a schema names is there, and what isn't there is noticed.

use crate::schema::{complaints, without_one};
use crate::support::{Folder, json};
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

fn schemas() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/schemas")
}

/// `bulge.shape/1` is in `shape.json`.
fn schema_of(document: &Value) -> (String, Value) {
    let name = document["schema"].as_str().unwrap();
    let kind = name.strip_prefix("bulge.").unwrap().strip_suffix("/1").unwrap().to_owned();
    let text = std::fs::read_to_string(schemas().join(format!("{kind}.json"))).unwrap();
    (kind, serde_json::from_str(&text).unwrap())
}

/// Documents of the program, of each kind that has a schema.
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
        json(&[
            "simulate",
            &braid,
            "--protocol",
            &protocol,
            "--with",
            "coulomb-friction",
            "--out",
            &trial,
            "--json",
        ]),
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
        &["muscle"],
        &["muscle", "ppam-2-r16"],
        &["size", "--force", "500 N", "--stroke", "50 mm"],
        &["heat", "--pipe", "none"],
        &["sense", "ppam-2-r16", "--turns", "20"],
        &["air", "shut", "ppam-2-r16", "--pressure", "2 bar", "--contraction", "10 %"],
        &["air", "fill", "ppam-2-r16", "--supply", "3 bar", "--hole", "2 mm", "--held", "10 %"],
        &["air", "stroke", "ppam-2-r16", "--load", "200 N", "--stroke", "5 %..20 %", "--supply", "4 bar"],
    ] {
        all.push(json(&[call, &["--json"]].concat()));
    }
    all
}

#[test]
fn documents_hold_what_their_schemas_name() {
    let folder = Folder::new("schemas");
    let mut seen = BTreeSet::new();
    let mut fields = 0;
    for document in documents(&folder) {
        let (kind, schema) = schema_of(&document);
        assert_eq!(complaints(&schema, &document), Vec::<String>::new(), "{kind}");
        for (place, without) in without_one(&schema, &document) {
            assert!(!complaints(&schema, &without).is_empty(), "{kind} without {place} is not noticed");
            fields += 1;
        }
        seen.insert(kind + ".json");
    }
    assert!(fields > 500, "{fields}");
    let names =
        std::fs::read_dir(schemas()).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    assert_eq!(seen, names.collect::<BTreeSet<_>>());
}
