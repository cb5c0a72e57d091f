//! `bulge sweep` and `bulge table` as seen by a user: exit statuses, messages, JSON names, and nothing lost
//! or doubled when a run is killed.

use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::support::{Folder, failure, files, has_parts, json, next, refused, stdout};
use serde_json::Value;

const SWEEP: &str = "name = \"small family\"\nmuscle = \"ppam-2-r16\"\npressure = \"1 bar\"\noutputs = [\"force_f\", \"volume_v\", \"force\"]\n\
    chunk = 50\n[axes.contraction]\nrange = \"2 %..45 %\"\npoints = 44\n[axes.slenderness]\nrange = \"4..12\"\npoints = 5\n";
const TABLE: &str = "name = \"small table\"\nmuscle = \"ppam-2-r16\"\n[axes.contraction]\nrange = \"2 %..limit\"\n\
    [axes.slenderness]\nrange = \"6..8\"\n[table]\ntolerance = 1e-3\ngradient = 1e-2\nchecks = 100000\n";

fn start(arguments: &[&str]) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_bulge"));
    command.args(arguments).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
}

#[test]
fn a_sweep_says_what_it_did() {
    let folder = Folder::new("sweep-json");
    let (sweep, out) = (folder.write("sweep.toml", SWEEP), folder.path("out"));
    let first = json(&["sweep", &sweep, "--out", &out, "--json"]);
    assert_eq!(first["schema"], "bulge.sweep/1");
    assert_eq!(
        (first["name"].as_str(), first["folder"].as_str()),
        (Some("small family"), Some(out.as_str()))
    );
    assert_eq!(first["table"], Value::Null);
    let points = &first["points"];
    assert_eq!((points["points"].as_u64(), points["chunks"].as_u64()), (Some(220), Some(5)));
    assert_eq!((points["computed"].as_u64(), points["is_complete"].as_bool()), (Some(5), Some(true)));
    assert_eq!(points["damaged"], Value::Array(vec![]));
    // 45 % is beyond the limit of each muscle.
    let infeasible = points["infeasible"].as_u64().unwrap();
    assert!((5..110).contains(&infeasible), "{infeasible}");
    let names: Vec<String> = files(Path::new(&out)).keys().map(|path| path.display().to_string()).collect();
    let chunks = (0..5).map(|i| format!("chunks/{i:06}.json"));
    let data = (0..5).map(|i| format!("points/{i:06}.parquet"));
    let wanted: Vec<String> =
        chunks.chain(["manifest.json".into(), "plan.json".into()]).chain(data).collect();
    assert_eq!(names, wanted);
    let manifest: Value =
        serde_json::from_slice(&files(Path::new(&out))[Path::new("manifest.json")]).unwrap();
    assert_eq!(
        (manifest["schema"].as_str(), manifest["points"].as_u64()),
        (Some("bulge.sweep/1"), Some(220))
    );
    assert_eq!(manifest["infeasible"].as_u64(), Some(infeasible));
    assert_eq!(manifest["chunks"].as_array().unwrap().len(), 5);

    let again = json(&["sweep", &sweep, "--out", &out, "--resume", "--csv", "--json"]);
    assert_eq!(again["points"]["computed"], 5);
    let text = std::fs::read_to_string(Path::new(&out).join("csv/000000.csv")).unwrap();
    assert!(
        text.starts_with("index,contraction,slenderness,force_f,volume_v,force [N],infeasible\n0,0.02,4,"),
        "{text}"
    );
    assert_eq!(text.lines().count(), 51);

    let text = stdout(&["sweep", &sweep, "--out", &out, "--resume"]);
    assert!(text.contains("220 points in 5 chunks (0 computed, 5 there already)"), "{text}");
    std::fs::remove_file(Path::new(&out).join("points/000003.parquet")).unwrap();
    let text = stdout(&["sweep", &sweep, "--out", &out, "--resume"]);
    has_parts(&text, &["(1 computed", "000003.parquet is missing: computed again"]);
}

#[test]
fn what_is_wrong_is_status_1_with_place_and_cure() {
    let folder = Folder::new("sweep-input");
    let out = folder.path("out");
    for (from, to, place, cure) in [
        ("outputs", "outptus", "sweep.toml:4:1", "did you mean `outputs`"),
        ("\"force_f\"", "\"forse_f\"", "sweep.toml:4:", "did you mean `force_f`"),
        ("ppam-2-r16", "ppam-3", "sweep.toml:2:", "ppam-2-r16"),
        ("ppam-2-r16", "nowhere.toml", "nowhere.toml", "no such file"),
        ("[axes.slenderness]", "[axes.slendernes]", "sweep.toml:9:", "did you mean `slenderness`"),
        ("2 %..45 %", "0 %..45 %", "sweep.toml:7:", "infinite at 0"),
        ("2 %..45 %", "45 %..2 %", "sweep.toml:7:", "must rise"),
        ("4..12", "4..limit", "sweep.toml:10:", "`limit` is the contraction"),
        ("points = 5\n", "points = 1\n", "sweep.toml:11:", "list = [2]"),
        ("chunk = 50", "chunk = 0", "sweep.toml:5:", "chunk = 65536"),
        ("1 bar", "1 mm", "sweep.toml:3:", "bar"),
    ] {
        let sweep = folder.write("sweep.toml", &SWEEP.replace(from, to));
        refused(&["sweep", &sweep, "--out", &out], 1, &[place, cure]);
    }
    assert_eq!(folder.names(), ["sweep.toml"]);
    refused(&["sweep", &folder.path("no.toml"), "--out", &out], 1, &["there is no such file"]);
    let sweep = folder.write("sweep.toml", SWEEP);
    assert_eq!(failure(&["sweep", &sweep]).0, 2);
    for chunks in ["3", "3..3", "5..2", "a..b", "-1..2"] {
        refused(&["sweep", &sweep, "--out", &out, &format!("--chunks={chunks}")], 2, &["100..200"]);
    }
    refused(&["sweep", &sweep, "--out", &out, "--chunks", "7..9"], 1, &["0..5"]);
    assert_eq!(folder.names(), ["sweep.toml"]);
}

#[test]
fn a_folder_with_another_sweep_is_refused() {
    let folder = Folder::new("sweep-changed");
    let (sweep, out) = (folder.write("sweep.toml", SWEEP), folder.path("out"));
    stdout(&["sweep", &sweep, "--out", &out]);
    let before = files(Path::new(&out));
    refused(&["sweep", &sweep, "--out", &out], 1, &["--resume"]);
    let changed = folder.write("changed.toml", &SWEEP.replace("1 bar", "2 bar"));
    refused(
        &["sweep", &changed, "--out", &out, "--resume"],
        1,
        &["- \"pressure_pa\": 100000.0", "+ \"pressure_pa\": 200000.0"],
    );
    let (status, message) =
        failure(&["sweep", &sweep, "--out", &folder.path("new"), "--merge", &folder.path("nowhere")]);
    assert!(status == 1 && message.contains("no plan.json"), "{message}");
    assert!(files(Path::new(&out)) == before);
}

#[test]
fn a_folder_that_cannot_be_written_is_named() {
    let folder = Folder::new("sweep-folder");
    let sweep = folder.write("sweep.toml", SWEEP);
    let file = folder.write("file", "not a folder");
    for out in [file.clone(), format!("{file}/below")] {
        refused(
            &["sweep", &sweep, "--out", &out],
            1,
            &[&format!("{file} is a file; give the name of a folder")],
        );
    }
    // A folder in the place of a file.
    let out = folder.path("out");
    stdout(&["sweep", &sweep, "--out", &out, "--chunks", "0..1"]);
    std::fs::create_dir_all(Path::new(&out).join("points/000002.parquet")).unwrap();
    refused(&["sweep", &sweep, "--out", &out, "--resume"], 1, &["000002.parquet"]);
    std::fs::remove_dir(Path::new(&out).join("points/000002.parquet")).unwrap();
    stdout(&["sweep", &sweep, "--out", &out, "--resume"]);
    assert!(files(Path::new(&out)).keys().all(|path| !path.to_string_lossy().contains(".unfinished")));
}

#[test]
fn a_huge_sweep_must_be_confirmed() {
    let folder = Folder::new("sweep-huge");
    let huge = SWEEP.replace("points = 44", "points = 1000000").replace("points = 5\n", "points = 1000000\n");
    let (sweep, out) = (folder.write("sweep.toml", &huge), folder.path("out"));
    let says = ["1000000000000 points", "40000 GB", "20000000000 files", "hours", "--confirm"];
    refused(&["sweep", &sweep, "--out", &out], 1, &says);
    assert_eq!(folder.names(), ["sweep.toml"]);
}

#[test]
#[expect(clippy::too_many_lines, reason = "one table, built once")]
fn a_table_is_built_and_asked() {
    let folder = Folder::new("sweep-table");
    let (sweep, out) = (folder.write("sweep.toml", TABLE), folder.path("out"));
    let built = json(&["sweep", &sweep, "--out", &out, "--json"]);
    assert_eq!(built["points"], Value::Null);
    let table = folder.path("out/table.bulge");
    let info = json(&["table", "info", &table, "--json"]);
    assert_eq!(info, built["table"]);
    let written: Value =
        serde_json::from_slice(&std::fs::read(folder.path("out/table.json")).unwrap()).unwrap();
    assert_eq!(info, written);
    assert_eq!((info["schema"].as_str(), info["checks"].as_u64()), (Some("bulge.table/1"), Some(100_000)));
    assert_eq!(info["bytes"].as_u64().unwrap(), std::fs::metadata(&table).unwrap().len());
    for (o, name) in ["force_f", "volume_v"].into_iter().enumerate() {
        let output = &info["outputs"][o];
        assert_eq!(output["name"], name);
        let number = |key: &str| output[key].as_f64().unwrap();
        assert!(
            number("error") <= 1e-3
                && number("error_rms") <= number("error")
                && number("bound") >= number("error")
        );
        assert!(number("gradient_error") <= 1e-2 && number("gradient_error_rms") <= number("gradient_error"));
    }
    let axis = &info["axes"][0];
    assert_eq!((axis["name"].as_str(), axis["is_fitted"].as_bool()), (Some("contraction"), Some(true)));

    let ask = |at: &str| json(&["table", "eval", &table, "--at", at, "--json"]);
    let value = ask("contraction=20 %,slenderness=6.875");
    assert_eq!(value, ask("slenderness = 6.875, contraction = 0.2"));
    assert_eq!(value["schema"], "bulge.table-value/1");
    assert_eq!(value["at"]["contraction"], 0.2);
    let shape = json(&["shape", "ppam-2-r16", "--pressure", "1 bar", "--contraction", "20 %", "--json"]);
    for name in ["force_f", "volume_v"] {
        let (found, exact) =
            (value["values"][name]["value"].as_f64().unwrap(), shape[name].as_f64().unwrap());
        assert!((found / exact - 1.0).abs() < 1e-3, "{name}: {found}, not {exact}");
        assert!(value["values"][name]["gradient"]["slenderness"].is_f64());
        assert!(value["values"][name]["error"].as_f64().unwrap() <= 1e-3);
        assert_eq!(value["values"][name]["unit"], "1");
    }
    let text = stdout(&["table", "eval", &table, "--at", "contraction=0.2,slenderness=7"]);
    assert!(text.contains("d/d(contraction)") && text.contains("force_f"), "{text}");
    let text = stdout(&["table", "info", &table]);
    assert!(text.contains("follows the others") && text.contains("F = p l0^2 a f"), "{text}");

    for (at, status, says) in [
        ("contraction=20 %", 1, "no value for the axis `slenderness`"),
        ("contraction=20 %,slendernes=7", 1, "no axis `slendernes`: write `contraction=...,slenderness=...`"),
        ("contraction=20 %,slenderness=7,slenderness=7", 1, "stands twice"),
        ("contraction=20 %,slenderness", 1, "is no `name=value`"),
        ("contraction=20 mm,slenderness=7", 1, "contraction"),
        ("contraction=x,slenderness=7", 1, "contraction"),
        ("", 1, "name=value"),
        ("contraction=45 %,slenderness=6.875", 3, "0.0200000 to 0.41849"),
        ("contraction=1 %,slenderness=6.875", 3, "0.0200000 to"),
        ("contraction=20 %,slenderness=9", 3, "6.00000 to 8.00000"),
        ("contraction=-5 %,slenderness=5", 3, "6.00000 to 8.00000"),
        ("contraction=NaN,slenderness=7", 3, "outside"),
    ] {
        refused(&["table", "eval", &table, "--at", at], status, &[says]);
    }

    // An existing table isn't built again, unless it differs or is damaged.
    let bytes = std::fs::read(&table).unwrap();
    let when = || std::fs::metadata(&table).unwrap().modified().unwrap();
    let before = when();
    assert_eq!(json(&["sweep", &sweep, "--out", &out, "--json"]), built);
    assert_eq!(when(), before);
    let mut damaged = bytes.clone();
    damaged[400] ^= 1;
    for (what, says) in [
        (&damaged[..], "checksum"),
        (&bytes[..bytes.len() - 3], "truncated"),
        (b"", "truncated"),
        (b"x", "BulgeTab"),
    ] {
        let path = folder.path("damaged.bulge");
        std::fs::write(&path, what).unwrap();
        for arguments in [
            &["table", "info", &path][..],
            &["table", "eval", &path, "--at", "contraction=0.2,slenderness=7"],
        ] {
            refused(arguments, 1, &[&path, says]);
        }
    }
    refused(&["table", "info", &out], 1, &["is a folder"]);
    refused(&["table", "info", &folder.path("none.bulge")], 1, &["cannot be read"]);
    std::fs::write(&table, &damaged).unwrap();
    assert_eq!(json(&["sweep", &sweep, "--out", &out, "--json"]), built);
    assert!(std::fs::read(&table).unwrap() == bytes);
    // Other outputs require another table.
    let other =
        folder.write("other.toml", &TABLE.replace("[table]\n", "[table]\noutputs = [\"volume_v\"]\n"));
    refused(&["sweep", &other, "--out", &out], 1, &["holds another table"]);
    let other = json(&["sweep", &other, "--out", &out, "--resume", "--json"]);
    assert_eq!(other["table"]["outputs"].as_array().unwrap().len(), 1);
    assert!(
        std::fs::read_dir(&out).unwrap().all(|entry| !entry
            .unwrap()
            .file_name()
            .to_string_lossy()
            .starts_with('.'))
    );
}

#[test]
fn a_table_that_does_not_fit_or_exist_is_refused() {
    let folder = Folder::new("sweep-no-table");
    let out = folder.path("out");
    let small = folder
        .write("small.toml", &TABLE.replace("tolerance = 1e-3", "tolerance = 1e-8\nmax_size = \"3 KiB\""));
    let text = stdout(&["sweep", &small, "--out", &out]);
    assert!(text.contains("the size limit came first: the tolerance is not met"), "{text}");
    // Such short muscles don't exist.
    let far = folder.write("far.toml", &TABLE.replace("6..8", "0.1..8"));
    refused(&["sweep", &far, "--out", &folder.path("far")], 3, &["leave the region out"]);
    assert!(!Path::new(&folder.path("far/table.bulge")).exists());
}

#[test]
fn several_processes_share_a_folder() {
    let folder = Folder::new("sweep-shared");
    let text = SWEEP.replace("chunk = 50", "chunk = 5");
    let sweep = folder.write("sweep.toml", &text);
    let [out, whole] = ["out", "whole"].map(|name| folder.path(name));
    stdout(&["sweep", &sweep, "--out", &whole]);
    // 44 chunks; some are computed by two of the processes.
    let parts = ["0..16", "14..30", "20..40"];
    let mut running: Vec<Child> =
        parts.iter().map(|part| start(&["sweep", &sweep, "--out", &out, "--chunks", part])).collect();
    assert!(running.iter_mut().all(|child| child.wait().unwrap().success()));
    assert!(!Path::new(&out).join("manifest.json").exists());
    let completed = json(&["sweep", &sweep, "--out", &out, "--resume", "--json"]);
    assert_eq!(
        (completed["points"]["computed"].as_u64(), completed["points"]["chunks"].as_u64()),
        (Some(4), Some(44))
    );
    assert!(files(Path::new(&out)) == files(Path::new(&whole)));
}

#[test]
fn fifty_kills_lose_nothing() {
    const KILLS: u32 = 50;
    let folder = Folder::new("sweep-kills");
    let text = "muscle = \"ppam-2-r16\"\nchunk = 100\n[axes.contraction]\nrange = \"2 %..limit\"\npoints = 200\n\
        [axes.slenderness]\nrange = \"4..12\"\npoints = 200\n";
    let sweep = folder.write("sweep.toml", text);
    let [out, whole] = ["out", "whole"].map(|name| folder.path(name));
    let started = Instant::now();
    stdout(&["sweep", &sweep, "--out", &whole]);
    let duration = started.elapsed();
    let expected = files(Path::new(&whole));
    let (mut state, mut killed, mut rounds) = (1, 0, 0);
    let resumed = ["sweep", &sweep, "--out", &out, "--resume"];
    let mut at_last = Duration::ZERO;
    while killed < KILLS {
        // Starts again once everything is done: kills hit the first chunk, the gaps between chunks, and the
        // manifest.
        if Path::new(&out).join("manifest.json").exists() {
            assert!(files(Path::new(&out)) == expected, "after {killed} kills");
            std::fs::remove_dir_all(&out).unwrap();
            rounds += 1;
        }
        let mut child = start(&resumed);
        // About five kills per round.
        let moment = duration.mul_f64(0.4 * next(&mut state));
        let started = Instant::now();
        sleep(moment);
        child.kill().unwrap();
        killed += u32::from(!child.wait().unwrap().success());
        at_last = at_last.max(started.elapsed());
        // Finished chunks are complete at any time.
        if killed.is_multiple_of(5) && Path::new(&out).join("chunks").exists() {
            for (path, bytes) in files(Path::new(&out)) {
                let is_unfinished = path.to_string_lossy().contains(".unfinished-");
                assert!(is_unfinished || expected[&path] == bytes, "{} after {killed} kills", path.display());
            }
        }
    }
    assert!(rounds < KILLS && at_last < 10 * duration);
    let done = json(&[&resumed[..], &["--json"]].concat());
    assert_eq!(
        (done["points"]["is_complete"].as_bool(), done["points"]["points"].as_u64()),
        (Some(true), Some(40_000))
    );
    assert_eq!(done["points"]["damaged"], Value::Array(vec![]));
    assert!(files(Path::new(&out)) == expected);
    // Nothing is doubled: the chunks in the manifest are consecutive.
    let manifest: Value = serde_json::from_slice(&expected[Path::new("manifest.json")]).unwrap();
    let mut first = 0;
    for (number, chunk) in manifest["chunks"].as_array().unwrap().iter().enumerate() {
        assert_eq!((chunk["chunk"].as_u64(), chunk["first"].as_u64()), (Some(number as u64), Some(first)));
        first += chunk["points"].as_u64().unwrap();
    }
    assert_eq!(first, 40_000);
}
