//! Sweeps in their folders: the bytes don't depend on how they are run, no point is lost or doubled, and
//! every number is that of the solver.

#![expect(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use bulge_effects::{Catalogue, known};
use bulge_fibre::{Approach, Given, Problem, Response};
use bulge_model::MuscleWithEffects;
use bulge_muscles::{Muscle, Parameter, Pressure, Quantity as _, from_toml, preset};
use bulge_sweep::plan::{End, Range, Spacing};
use bulge_sweep::{Output, Plan, RunOptions, Summary, SweepError, Variable, run};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;
use tempfile::TempDir;

const CLOSED: &str = "muscle = \"ppam-2-r16\"\npressure = \"1 bar\"\nchunk = 64\n\
    outputs = [\"force_f\", \"volume_v\", \"force\", \"max_radius\"]\n\
    [axes.slenderness]\nrange = \"4..12\"\npoints = 7\n\
    [axes.contraction]\nrange = \"2 %..limit\"\npoints = 41\n";
const BRAID: &str = "muscle = \"dmsp-20-250\"\npressure = \"3 bar\"\nmethod = \"shooting\"\nchunk = 7\n\
    outputs = [\"force\", \"volume\", \"end_slope\", \"stiffness_isothermal\"]\n\
    [axes.braid_angle]\nrange = \"22 deg..28 deg\"\npoints = 3\n\
    [axes.contraction]\nrange = \"1 %..40 %\"\npoints = 10\n";
const HYPERCUBE: &str = "muscle = \"ppam-2-r16\"\ndesign = \"latin-hypercube\"\npoints = 300\nseed = 7\nchunk = 37\n\
    [axes.contraction]\nrange = \"2 %..limit\"\n\
    [axes.pressure]\nrange = \"1 bar..3 bar\"\nspacing = \"log\"\n\
    [axes.slenderness]\nrange = \"4..12\"\n\
    [axes.elastic_group]\nrange = \"0.001..0.02\"\n";

fn plan(text: &str) -> Plan {
    Plan::from_toml(text, "sweep.toml", None).unwrap()
}

fn go(plan: &Plan, folder: &Path, options: &RunOptions) -> Result<Summary, SweepError> {
    run(plan, folder, options, &|_| {})
}

/// A whole run into its own folder.
fn whole(plan: &Plan, csv: bool) -> TempDir {
    let folder = TempDir::new().unwrap();
    let options = RunOptions { csv, ..RunOptions::default() };
    let summary = go(plan, folder.path(), &options).unwrap();
    assert!(summary.is_complete && summary.computed == plan.chunks() && summary.damaged.is_empty());
    folder
}

fn resume() -> RunOptions {
    RunOptions { resume: true, ..RunOptions::default() }
}

/// Every file below a folder, with its path in the folder.
fn files(folder: &Path) -> BTreeMap<PathBuf, (Vec<u8>, SystemTime)> {
    let mut found = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.file_name().is_some_and(|name| name != ".lock") {
                let changed = path.metadata().unwrap().modified().unwrap();
                let name = path.strip_prefix(folder).unwrap().to_owned();
                found.insert(name, (fs::read(&path).unwrap(), changed));
            }
        }
    }
    found
}

fn bytes(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    files(folder).into_iter().map(|(name, (bytes, _))| (name, bytes)).collect()
}

/// The rows of all chunks, read back.
fn rows(folder: &Path) -> Vec<BTreeMap<String, Field>> {
    let mut names: Vec<PathBuf> =
        fs::read_dir(folder.join("points")).unwrap().map(|entry| entry.unwrap().path()).collect();
    names.sort();
    let mut found = vec![];
    for name in names {
        let reader = SerializedFileReader::new(fs::File::open(name).unwrap()).unwrap();
        for row in reader.get_row_iter(None).unwrap() {
            found.push(row.unwrap().into_columns().into_iter().collect());
        }
    }
    found
}

fn number(row: &BTreeMap<String, Field>, name: &str) -> Option<f64> {
    match &row[name] {
        Field::Double(value) => Some(*value),
        Field::Null => None,
        other => panic!("{name} is {other}"),
    }
}

fn reason(row: &BTreeMap<String, Field>) -> Option<&str> {
    match &row["infeasible"] {
        Field::Str(reason) => Some(reason),
        Field::Null => None,
        other => panic!("infeasible is {other}"),
    }
}

fn assert_close(found: f64, expected: f64, within: f64, what: &str) {
    assert!((found - expected).abs() <= within * expected.abs(), "{what}: {found:e}, not {expected:e}");
}

#[test]
fn the_same_bytes_on_any_number_of_threads() {
    for text in [CLOSED, BRAID, HYPERCUBE] {
        let plan = plan(text);
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let folder = pool.install(|| whole(&plan, true));
            bytes(folder.path())
        };
        let one = on(1);
        let chunks = usize::try_from(plan.chunks()).unwrap();
        assert_eq!(one.len(), 2 + 3 * chunks);
        assert!(one == on(3), "{text}");
    }
}

/// A run may share a chunk among threads in parts, while a piece is computed in one go.
#[test]
fn chunks_in_parts_are_the_chunks_in_one_piece() {
    let plan = plan(
        "muscle = \"ppam-2-r16\"\nchunk = 5000\noutputs = [\"force_f\", \"volume_v\"]\n\
         [axes.slenderness]\nrange = \"2..12\"\npoints = 9\n\
         [axes.contraction]\nrange = \"1 %..40 %\"\npoints = 1000\n",
    );
    // There are more threads than chunks, so all chunks are shared, even on a single processor.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap();
    let folder = pool.install(|| whole(&plan, true));
    let found = bytes(folder.path());
    let mut infeasible = 0;
    for number in 0..plan.chunks() {
        let piece = bulge_sweep::piece(&plan, number, true).unwrap();
        assert!(found[Path::new(&format!("points/{number:06}.parquet"))] == piece.parquet, "{number}");
        assert!(found[Path::new(&format!("csv/{number:06}.csv"))] == piece.csv.unwrap().into_bytes());
        let promise = serde_json::to_string(&piece.promise).unwrap() + "\n";
        assert!(found[Path::new(&format!("chunks/{number:06}.json"))] == promise.into_bytes());
        infeasible += piece.promise.infeasible;
    }
    assert!(infeasible > 500, "{infeasible}");
}

#[test]
fn stopped_and_resumed_is_as_if_never_stopped() {
    for text in [CLOSED, BRAID, HYPERCUBE] {
        let plan = plan(text);
        let expected = whole(&plan, true);
        let folder = TempDir::new().unwrap();
        let part = RunOptions { chunks: Some(1..3), csv: true, ..RunOptions::default() };
        let summary = go(&plan, folder.path(), &part).unwrap();
        assert_eq!((summary.chunks, summary.computed, summary.is_complete), (2, 2, false));
        assert!(!folder.path().join("manifest.json").exists());
        // Nothing in the folder is computed again, neither here nor by the run that completes it.
        assert_eq!(go(&plan, folder.path(), &part).unwrap().computed, 0);
        let summary = go(&plan, folder.path(), &RunOptions { csv: true, ..resume() }).unwrap();
        assert_eq!((summary.chunks, summary.computed), (plan.chunks(), plan.chunks() - 2));
        assert_eq!((u128::from(summary.points), summary.is_complete), (plan.points(), true));
        assert!(bytes(folder.path()) == bytes(expected.path()), "{text}");
    }
}

#[test]
fn progress_ends_at_all_points() {
    let plan = plan(CLOSED);
    let folder = TempDir::new().unwrap();
    let last = std::sync::Mutex::new((0, 0));
    let told = |progress: bulge_sweep::Progress| {
        let mut last = last.lock().unwrap();
        last.0 = last.0.max(progress.done);
        last.1 = progress.all;
    };
    let part = RunOptions { chunks: Some(3..5), ..RunOptions::default() };
    run(&plan, folder.path(), &part, &told).unwrap();
    // The last chunk is shorter: 287 = 4 x 64 + 31.
    assert_eq!(*last.lock().unwrap(), (95, 95));
    *last.lock().unwrap() = (0, 0);
    run(&plan, folder.path(), &resume(), &told).unwrap();
    assert_eq!(*last.lock().unwrap(), (287, 287));
}

type Damage = (&'static str, fn(&Path), Option<&'static str>);

fn altered(path: &Path, change: impl Fn(&mut Vec<u8>)) {
    let mut bytes = fs::read(path).unwrap();
    change(&mut bytes);
    fs::write(path, bytes).unwrap();
}

/// The damaged file, the damage, and the expected message.
const DAMAGE: [Damage; 11] = [
    ("points/000001.parquet", |p| altered(p, |b| b[100] ^= 4), Some("is damaged or truncated")),
    (
        "points/000004.parquet",
        |p| altered(p, |b| *b.last_mut().unwrap() ^= 1),
        Some("is damaged or truncated"),
    ),
    ("points/000002.parquet", |p| altered(p, |b| b.truncate(b.len() - 1)), Some("is damaged or truncated")),
    ("points/000003.parquet", |p| altered(p, Vec::clear), Some("is damaged or truncated")),
    ("points/000000.parquet", |p| fs::remove_file(p).unwrap(), Some("is missing")),
    ("csv/000001.csv", |p| altered(p, |b| b[20] = b'x'), Some("is damaged or truncated")),
    ("csv/000001.csv", |p| fs::remove_file(p).unwrap(), Some("is missing")),
    ("chunks/000002.json", |p| fs::write(p, "{\"chunk\": 2,").unwrap(), Some("is damaged")),
    ("chunks/000004.json", |p| altered(p, Vec::clear), Some("is damaged")),
    (
        "chunks/000000.json",
        |p| {
            fs::copy(p.with_file_name("000001.json"), p).unwrap();
        },
        Some("belongs to another sweep"),
    ),
    ("chunks/000003.json", |p| fs::remove_file(p).unwrap(), None),
];

#[test]
fn what_is_damaged_is_named_and_computed_again() {
    let plan = plan(CLOSED);
    let folder = whole(&plan, true);
    let expected = bytes(folder.path());
    for (name, damage, says) in DAMAGE {
        let before = files(folder.path());
        damage(&folder.path().join(name));
        let summary = go(&plan, folder.path(), &RunOptions { csv: true, ..resume() }).unwrap();
        assert_eq!((summary.computed, summary.is_complete), (1, true), "{name}");
        match says {
            None => assert!(summary.damaged.is_empty()),
            Some(says) => {
                assert_eq!(summary.damaged.len(), 1);
                assert!(
                    summary.damaged[0].contains(name) && summary.damaged[0].contains(says),
                    "{summary:?}"
                );
            }
        }
        assert!(bytes(folder.path()) == expected, "{name}");
        // Other chunks are left alone.
        let number = Path::new(name).file_stem().unwrap();
        for (path, (_, changed)) in files(folder.path()) {
            let is_other = path.parent() != Some(Path::new("")) && path.file_stem() != Some(number);
            assert!(!is_other || changed == before[&path].1, "{name}: {} is written again", path.display());
        }
    }
}

#[test]
fn several_damages_are_all_named_in_order() {
    let plan = plan(CLOSED);
    let folder = whole(&plan, false);
    let expected = bytes(folder.path());
    for name in ["points/000003.parquet", "points/000000.parquet"] {
        fs::remove_file(folder.path().join(name)).unwrap();
    }
    let summary = go(&plan, folder.path(), &resume()).unwrap();
    assert!(summary.damaged[0].contains("000000") && summary.damaged[1].contains("000003"));
    assert_eq!((summary.computed, summary.damaged.len()), (2, 2));
    assert!(bytes(folder.path()) == expected);
}

#[test]
fn half_written_files_are_swept_up() {
    let plan = plan(CLOSED);
    let expected = bytes(whole(&plan, false).path());
    // This includes a process that was killed before it wrote the plan.
    for has_plan in [true, false] {
        let folder = if has_plan { whole(&plan, false) } else { TempDir::new().unwrap() };
        for name in ["", "points", "chunks"] {
            fs::create_dir_all(folder.path().join(name)).unwrap();
            fs::write(folder.path().join(name).join(".unfinished-abc"), "half").unwrap();
        }
        fs::write(folder.path().join("notes.txt"), "of the user").unwrap();
        go(&plan, folder.path(), &resume()).unwrap();
        let mut found = bytes(folder.path());
        assert_eq!(found.remove(Path::new("notes.txt")).unwrap(), b"of the user");
        assert!(found.keys().eq(expected.keys()), "{:?}", found.keys());
        assert!(found == expected);
    }
}

#[test]
fn the_unfinished_files_of_others_at_work_are_left_alone() {
    let plan = plan(CLOSED);
    let folder = whole(&plan, false);
    let other = folder.path().join("points/.unfinished-other");
    fs::write(&other, "another process is at it").unwrap();
    let at_work = fs::File::open(folder.path().join(".lock")).unwrap();
    at_work.lock_shared().unwrap();
    let part = RunOptions { chunks: Some(0..1), ..RunOptions::default() };
    for options in [part, resume()] {
        go(&plan, folder.path(), &options).unwrap();
        assert!(other.exists());
    }
    drop(at_work);
    go(&plan, folder.path(), &resume()).unwrap();
    assert!(!other.exists());
}

/// Each process begins while others write. A search for unfinished files must not take theirs.
#[test]
fn many_begin_at_once_and_none_removes_what_another_writes() {
    let plan = plan(&CLOSED.replace("chunk = 64", "chunk = 5"));
    let expected = bytes(whole(&plan, false).path());
    for _ in 0..5 {
        let folder = TempDir::new().unwrap();
        std::thread::scope(|scope| {
            let work = |worker: u64| {
                let (plan, path) = (&plan, folder.path());
                move || {
                    for chunk in (worker..plan.chunks()).step_by(6) {
                        let one = RunOptions { chunks: Some(chunk..chunk + 1), ..resume() };
                        go(plan, path, &one).unwrap();
                    }
                }
            };
            let workers: Vec<_> = (0..6).map(|worker| scope.spawn(work(worker))).collect();
            for worker in workers {
                worker.join().unwrap();
            }
        });
        go(&plan, folder.path(), &resume()).unwrap();
        assert!(bytes(folder.path()) == expected);
    }
}

/// The chunks say of which plan they are: a lost plan is written again, and they are used.
#[test]
fn a_lost_plan_is_written_again() {
    let plan = plan(CLOSED);
    let folder = whole(&plan, true);
    let expected = bytes(folder.path());
    let path = folder.path().join("plan.json");
    let sound = fs::read(&path).unwrap();
    let again = |what: &str| {
        let summary = go(&plan, folder.path(), &resume()).unwrap();
        assert_eq!((summary.computed, summary.damaged), (0, vec![format!("{} {what}", path.display())]));
        assert!(bytes(folder.path()) == expected, "{what}");
    };
    fs::remove_file(&path).unwrap();
    let error = go(&plan, folder.path(), &RunOptions::default()).unwrap_err().to_string();
    assert!(error.contains("holds this sweep already: add `--resume`") && !path.exists(), "{error}");
    again("is missing");
    for length in [0, 1, 2, 10, sound.len() / 2, sound.len() - 2, sound.len() - 1] {
        fs::write(&path, &sound[..length]).unwrap();
        again("is damaged");
    }
    for foreign in [&b"null"[..], b"{}", b"\xff\xfe", &[&sound[..], b"\n"].concat()] {
        fs::write(&path, foreign).unwrap();
        again("is damaged");
    }
    // A flipped bit is seen at once, or makes another plan: that is refused until the file is gone.
    let mut refused = 0;
    for place in (0..sound.len()).step_by(37) {
        let mut flipped = sound.clone();
        flipped[place] ^= 1 << (place % 8);
        fs::write(&path, &flipped).unwrap();
        match go(&plan, folder.path(), &resume()) {
            Ok(summary) => assert_eq!((summary.computed, summary.damaged.len()), (0, 1)),
            Err(error) => {
                let error = error.to_string();
                assert!(
                    error.contains("holds another sweep") && error.contains("delete its plan.json"),
                    "{error}"
                );
                assert!(fs::read(&path).unwrap() == flipped);
                fs::remove_file(&path).unwrap();
                again("is missing");
                refused += 1;
            }
        }
        assert!(bytes(folder.path()) == expected, "byte {place}");
    }
    assert!(refused > 0);
    // The chunks of a folder without a plan can be taken over too.
    fs::remove_file(&path).unwrap();
    let other = TempDir::new().unwrap();
    let options = RunOptions { merge: vec![folder.path().to_owned()], csv: true, ..RunOptions::default() };
    assert_eq!(go(&plan, other.path(), &options).unwrap().computed, 0);
    assert!(bytes(other.path()) == expected);
}

#[test]
fn chunks_that_a_lost_plan_leaves_to_others_stay() {
    let (own, other) = (plan(CLOSED), plan(&CLOSED.replace("1 bar", "2 bar")));
    let folder = whole(&own, false);
    let at = |name: &str| folder.path().join(name);
    let sound = fs::read(at("plan.json")).unwrap();
    let foreign = whole(&other, false);
    let refuses = |plan: &Plan, parts: &[&str]| {
        let before = bytes(folder.path());
        for options in [resume(), RunOptions { chunks: Some(0..1), ..resume() }] {
            let error = go(plan, folder.path(), &options).unwrap_err().to_string();
            assert!(parts.iter().all(|part| error.contains(part)), "{error}");
        }
        assert!(bytes(folder.path()) == before);
    };
    // The plan of another sweep.
    fs::copy(foreign.path().join("plan.json"), at("plan.json")).unwrap();
    refuses(
        &own,
        &["holds another sweep", "100000.0", "200000.0", "delete its plan.json and add `--resume`"],
    );
    // To that sweep the chunks are damaged ones, which the plan in the folder has it make again; without a
    // plan they are another's.
    fs::remove_file(at("plan.json")).unwrap();
    refuses(&other, &["plan.json is missing", "chunks of another sweep", "000000.json"]);
    // One chunk of another sweep.
    for name in ["chunks/000001.json", "points/000001.parquet"] {
        fs::copy(foreign.path().join(name), at(name)).unwrap();
    }
    refuses(&own, &["plan.json is missing", "chunks of another sweep are there (1 of", "000001.json"]);
    // Points that nothing tells of.
    fs::remove_dir_all(at("chunks")).unwrap();
    fs::create_dir(at("chunks")).unwrap();
    refuses(&own, &["plan.json is missing", "no chunk tells"]);
    fs::write(at("plan.json"), "{").unwrap();
    refuses(&own, &["plan.json is damaged", "no chunk tells"]);
    // With its plan the folder is this sweep's, whatever is left of it.
    fs::write(at("plan.json"), sound).unwrap();
    go(&own, folder.path(), &resume()).unwrap();
    assert!(bytes(folder.path()) == bytes(whole(&own, false).path()));
    // A damaged plan of nothing.
    let empty = TempDir::new().unwrap();
    fs::write(empty.path().join("plan.json"), "{").unwrap();
    let error = go(&own, empty.path(), &resume()).unwrap_err().to_string();
    assert!(error.contains("plan.json is damaged") && error.contains("delete this file"), "{error}");
}

#[test]
fn csv_may_be_asked_for_later() {
    let plan = plan(CLOSED);
    let expected = whole(&plan, true);
    let folder = whole(&plan, false);
    let summary = go(&plan, folder.path(), &RunOptions { csv: true, ..resume() }).unwrap();
    assert!(summary.damaged.is_empty());
    assert!(bytes(folder.path()) == bytes(expected.path()));
    // Chunks that have CSV count as finished if none is requested.
    assert_eq!(go(&plan, folder.path(), &resume()).unwrap().computed, 0);
}

#[test]
fn another_sweep_is_refused_with_the_line_that_differs() {
    let folder = whole(&plan(CLOSED), false);
    let before = files(folder.path());
    for (from, to, lines) in [
        ("1 bar", "2 bar", ["- \"pressure_pa\": 100000.0,", "+ \"pressure_pa\": 200000.0,"]),
        ("4..12", "4..13", ["- \"value\": 12.0", "+ \"value\": 13.0"]),
        ("chunk = 64", "chunk = 65", ["- \"chunk\": 64", "+ \"chunk\": 65"]),
        ("\"force_f\"", "\"stiffness\"", ["- \"force_f\"", "+ \"stiffness\""]),
        ("ppam-2-r16", "ppam-1", ["16", "ppam-1"]),
    ] {
        let changed = plan(&CLOSED.replace(from, to));
        for options in [resume(), RunOptions::default(), RunOptions { chunks: Some(0..1), ..resume() }] {
            let error = go(&changed, folder.path(), &options).unwrap_err();
            let message = error.to_string();
            assert!(message.contains(" holds another sweep; the plans differ in\n"), "{message}");
            assert!(lines.iter().all(|line| message.contains(line)), "{to}: {message}");
            assert!(message.contains(&folder.path().display().to_string()) && message.lines().count() < 30);
        }
    }
    // Name and table don't determine the numbers of the points.
    let renamed = plan(&format!("name = \"other\"\n{CLOSED}[table]\n"));
    assert_eq!(go(&renamed, folder.path(), &resume()).unwrap().computed, 0);
    assert!(files(folder.path()).keys().eq(before.keys()));
}

#[test]
fn without_resume_a_sweep_is_not_gone_on_with() {
    let plan = plan(CLOSED);
    let folder = whole(&plan, false);
    let before = files(folder.path());
    let error = go(&plan, folder.path(), &RunOptions::default()).unwrap_err();
    assert!(error.to_string().contains(" holds this sweep already: add `--resume`"), "{error}");
    assert!(files(folder.path()) == before);
}

#[test]
fn chunks_that_do_not_exist_are_refused() {
    let plan = plan(CLOSED);
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("new");
    for (asked, says) in [(6..9, "6..9"), (5..6, "0..5"), (2..2, "2..2"), (7..u64::MAX, "0..5")] {
        let options = RunOptions { chunks: Some(asked), ..RunOptions::default() };
        let error = go(&plan, &path, &options).unwrap_err();
        assert!(matches!(&error, SweepError::Input(message) if message.contains(says)), "{error}");
    }
    assert!(!path.exists());
    // The last of equal parts ends at the end of the sweep.
    let summary = go(&plan, &path, &RunOptions { chunks: Some(3..9), ..RunOptions::default() }).unwrap();
    assert_eq!(summary.chunks, 2);
    let table_only = CLOSED.replace("points = 7\n", "").replace("points = 41\n", "") + "[table]\n";
    let error = go(&self::plan(&table_only), &path, &RunOptions::default()).unwrap_err();
    assert!(error.to_string().starts_with("this sweep has no points"), "{error}");
}

#[test]
fn folders_merge_into_one() {
    let plan = plan(CLOSED);
    let expected = whole(&plan, true);
    let parts: Vec<TempDir> = [0..2, 2..5]
        .into_iter()
        .map(|chunks| {
            let folder = TempDir::new().unwrap();
            let part = RunOptions { chunks: Some(chunks), csv: true, ..RunOptions::default() };
            go(&plan, folder.path(), &part).unwrap();
            folder
        })
        .collect();
    let merge: Vec<PathBuf> = parts.iter().map(|part| part.path().to_owned()).collect();
    let options = RunOptions { merge: merge.clone(), csv: true, ..RunOptions::default() };
    let folder = TempDir::new().unwrap();
    let summary = go(&plan, folder.path(), &options).unwrap();
    assert_eq!((summary.computed, summary.is_complete), (0, true));
    assert!(bytes(folder.path()) == bytes(expected.path()));
    // A damaged chunk is computed instead of being taken over.
    altered(&merge[1].join("points/000003.parquet"), |b| b[9] ^= 1);
    let folder = TempDir::new().unwrap();
    let summary = go(&plan, folder.path(), &options).unwrap();
    assert_eq!((summary.computed, summary.is_complete), (1, true));
    assert!(bytes(folder.path()) == bytes(expected.path()));
    // Another sweep is not taken over, nor a folder without one.
    let other = whole(&self::plan(&CLOSED.replace("4..12", "4..13")), false);
    let empty = TempDir::new().unwrap();
    for (from, says) in [(&other, "- \"value\": 13.0"), (&empty, "holds no sweep")] {
        let options = RunOptions { merge: vec![from.path().to_owned()], ..RunOptions::default() };
        let folder = TempDir::new().unwrap();
        let error = go(&plan, folder.path(), &options).unwrap_err().to_string();
        assert!(error.contains(says) && error.contains(&from.path().display().to_string()), "{error}");
        // A refused folder leaves nothing behind.
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}

/// Whether there is an equilibrium at a value.
type Exists = fn(f64) -> bool;

/// Rows without equilibrium hold a reason and no number; all other rows hold numbers and no reason.
fn assert_whole(plan: &Plan, rows: &[BTreeMap<String, Field>]) {
    assert_eq!(rows.len() as u128, plan.points());
    for (i, row) in rows.iter().enumerate() {
        assert_eq!(row["index"], Field::Long(i64::try_from(i).unwrap()));
        assert!(plan.axes.iter().all(|axis| number(row, &axis.name).unwrap().is_finite()));
        for output in &plan.outputs {
            let value = number(row, &output.name());
            assert_eq!(value.is_none(), reason(row).is_some(), "{row:?}");
            assert!(value.is_none_or(f64::is_finite), "{row:?}");
        }
    }
}

#[test]
fn points_without_equilibrium_say_why() {
    let with = |axis: usize, range: Range| {
        let mut plan = plan(CLOSED);
        plan.axes[axis].range = range;
        plan
    };
    let to = |from, to, points| Range::Between {
        from,
        to: End::Value(to),
        points: Some(points),
        spacing: Spacing::Linear,
    };
    let mut fibres =
        plan(&CLOSED.replace(
            "[axes.slenderness]\nrange = \"4..12\"\npoints = 7",
            "[axes.fibres]\nlist = [20, 30, 40]",
        ));
    fibres.axes[0].range = Range::List(vec![2.0, 20.5, 40.0]);
    // (plan, the axis that decides, the value from which on there are equilibria, the reason given for the
    // others)
    let cases: [(Plan, &str, Exists, &str); 5] = [
        (
            plan(
                &CLOSED
                    .replace("range = \"4..12\"\npoints = 7", "list = [6.875]")
                    .replace("2 %..limit", "30 %..50 %"),
            ),
            "contraction",
            |e| e < 0.418_497,
            "41.8497 %",
        ),
        (with(1, to(-0.1, 0.3, 41)), "contraction", |e| e > 1e-12, "greater than 0"),
        (
            with(0, Range::List(vec![0.1, 5.0, 2000.0])),
            "slenderness",
            |s| (s - 5.0).abs() < 1.0,
            "0.5 to 1000",
        ),
        (with(0, Range::List(vec![-1.0, 0.0, 5.0])), "slenderness", |s| s > 0.0, "radius"),
        (fibres, "fibres", |n| n > 30.0, "fibres"),
    ];
    for (plan, axis, exists, says) in cases {
        let folder = TempDir::new().unwrap();
        let summary = go(&plan, folder.path(), &RunOptions::default()).unwrap();
        let rows = rows(folder.path());
        assert_whole(&plan, &rows);
        let mut without = 0;
        for row in &rows {
            let value = number(row, axis).unwrap();
            assert_eq!(reason(row).is_none(), exists(value), "{axis} {value}: {:?}", reason(row));
            if let Some(reason) = reason(row) {
                without += 1;
                assert!(reason.contains(says), "{axis} {value}: {reason}");
            }
        }
        assert!(without > 0 && without < rows.len() as u64);
        assert_eq!(summary.infeasible, without);
    }
}

/// A range up to the limit ends where the fibres slacken, if they do so before the force vanishes. The error
/// for points beyond names that limit.
#[test]
fn a_range_ends_where_fibres_slacken() {
    let folder = TempDir::new().unwrap();
    let text = "name = \"b\"\nkind = \"braided\"\nlength = \"60 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\nwall = \"3 mm\"\n\
        [effects.wall-thickness]\n[effects.end-radius]\nradius = \"16 mm\"\n[effects.bladder-elasticity]\nc10 = \"2 MPa\"\n";
    fs::write(folder.path().join("muscle.toml"), text).unwrap();
    let sweep = |range: &str| {
        let text = format!(
            "muscle = \"muscle.toml\"\npressure = \"2 bar\"\noutputs = [\"force\"]\n[axes.contraction]\nrange = \"{range}\"\npoints = 5\n"
        );
        Plan::from_toml(&text, "sweep.toml", Some(folder.path())).unwrap()
    };
    let to_limit = sweep("10 %..limit");
    let rows_of = |plan: &Plan| {
        let folder = whole(plan, false);
        let rows = rows(folder.path());
        assert_whole(plan, &rows);
        rows
    };
    let found = rows_of(&to_limit);
    assert_eq!(found.iter().find_map(reason), None);
    let limit = number(&found[4], "contraction").unwrap();
    // The muscle still pulls at the point where its fibres slacken.
    assert!(number(&found[4], "force").unwrap() > 1.0, "{limit}");
    let named = format!("{:.4} % on", 100.0 * limit);
    let beyond = rows_of(&sweep("10 %..50 %"));
    let reasons: Vec<&str> = beyond.iter().filter_map(reason).collect();
    assert!(!reasons.is_empty() && reasons.len() < 5, "{reasons:?}");
    assert!(
        reasons.iter().all(|reason| reason.contains("slack") && reason.contains(&named)),
        "{named}: {reasons:?}"
    );
}

#[test]
fn a_range_that_begins_beyond_the_limit_says_so() {
    // Slender muscles contract further, so that only some of them reach 45 %.
    let plan = plan(&CLOSED.replace("2 %..limit", "42 %..limit").replace("4..12", "4..40"));
    let folder = whole(&plan, false);
    let rows = rows(folder.path());
    assert_whole(&plan, &rows);
    let with = rows.iter().filter(|row| reason(row).is_none()).count();
    assert!(with > 0 && with < rows.len(), "{with} of {}", rows.len());
    assert!(rows.iter().filter_map(reason).all(|reason| reason.contains('%')), "{:?}", reason(&rows[0]));
}

fn follow(muscle: &Muscle, pressure: f64, contraction: f64) -> (Problem, Response) {
    let problem = Problem::new(muscle, Pressure::pa(pressure)).unwrap();
    let response = problem.follow(contraction, Approach::Auto).unwrap();
    (problem, response)
}

/// The expected value of an output, computed with the solver alone.
fn expected(muscle: &Muscle, problem: &Problem, response: &Response, output: Output) -> f64 {
    let (length, pressure) = (muscle.length().si(), problem.pressure().si());
    let a = muscle
        .fibres()
        .filter(|_| muscle.is_pleated())
        .map_or(1.0, |n| f64::from(n) / TAU * (TAU / f64::from(n)).sin());
    let [force, volume] = [pressure * length * length * a, length.powi(3)];
    let gradient = problem.gradient(response.contraction, Approach::Auto).unwrap();
    let [by_force, by_volume] = gradient.by_contraction;
    let by = |variable, which: usize| match variable {
        Variable::Pressure => gradient.by_pressure[which],
        Variable::Parameter(parameter) => gradient.by(muscle, parameter).unwrap()[which],
    };
    match output {
        Output::ForceF => response.force_n / force,
        Output::VolumeV => response.volume_m3 / volume,
        Output::Force => response.force_n,
        Output::Volume => response.volume_m3,
        Output::VolumePolygon => response.volume_polygon_m3,
        Output::MaxRadius => response.max_radius_m,
        Output::RadiusRatio => response.max_radius_m / muscle.end_radius().si(),
        Output::FibreTension => response.fibre_tension_n,
        Output::FibreStrain => response.fibre_strain,
        Output::Stiffness => response.stiffness_n_per_m,
        Output::StiffnessIsothermal => response.stiffness_isothermal_n_per_m,
        Output::StiffnessAdiabatic => response.stiffness_adiabatic_n_per_m,
        Output::EndSlope => response.end_slope_rad,
        Output::ForceFByContraction => by_force / force,
        Output::VolumeVByContraction => by_volume / volume,
        Output::ForceByContraction => by_force,
        Output::VolumeByContraction => by_volume,
        Output::ForceBy(variable) => by(variable, 0),
        Output::VolumeBy(variable) => by(variable, 1),
    }
}

/// The text of a plan with all outputs that are possible for its muscle.
fn with_outputs(text: &str, variables: &[Variable]) -> Plan {
    let mut plan = plan(text);
    plan.outputs = Output::PLAIN.to_vec();
    plan.outputs.extend(variables.iter().flat_map(|v| [Output::ForceBy(*v), Output::VolumeBy(*v)]));
    plan
}

#[test]
fn every_output_is_the_solver_s() {
    let parameters = |list: &[Parameter]| {
        list.iter().map(|p| Variable::Parameter(*p)).chain([Variable::Pressure]).collect::<Vec<_>>()
    };
    let pleated = "muscle = \"ppam-2-r16\"\npressure = \"2 bar\"\n\
        [axes.slenderness]\nlist = [4, 6.875, 12]\n[axes.fibres]\nlist = [12, 40]\n\
        [axes.elastic_group]\nlist = [0.0005, 0.004]\n[axes.contraction]\nlist = [0.03, 0.1, 0.2]\n";
    let braided = "muscle = \"dmsp-20-250\"\n[axes.pressure]\nlist = [\"1 bar\", \"5 bar\"]\n\
        [axes.length]\nlist = [\"0.2 m\", \"0.3 m\"]\n[axes.contraction]\nlist = [-0.01, 0.1, 0.25]\n";
    let pleated = with_outputs(
        pleated,
        &parameters(&[Parameter::Length, Parameter::Radius, Parameter::FibreStiffness]),
    );
    let braided =
        with_outputs(braided, &parameters(&[Parameter::Length, Parameter::Radius, Parameter::BraidAngle]));
    for plan in [pleated, braided] {
        let folder = whole(&plan, false);
        let rows = rows(folder.path());
        assert_whole(&plan, &rows);
        for row in &rows {
            assert_eq!(reason(row), None);
            let at = |name: &str| number(row, name).unwrap();
            let mut muscle = plan.muscle.clone();
            let mut pressure = plan.pressure_pa;
            if muscle.is_pleated() {
                muscle = muscle.with(Parameter::Fibres, at("fibres")).unwrap();
                let radius = muscle.length().si() / at("slenderness");
                muscle = muscle.with(Parameter::Radius, radius).unwrap();
                // EA = p sin(2 pi/n) R^2/group.
                let stiffness = pressure * (TAU / at("fibres")).sin() * radius * radius / at("elastic_group");
                muscle = muscle.with(Parameter::FibreStiffness, stiffness).unwrap();
            } else {
                muscle = muscle.with(Parameter::Length, at("length")).unwrap();
                pressure = at("pressure");
            }
            let (problem, response) = follow(&muscle, pressure, at("contraction"));
            for output in &plan.outputs {
                let name = output.name();
                let (found, wanted) = (at(&name), expected(&muscle, &problem, &response, *output));
                // The slopes are derived independently of the gradients.
                let within = if name.contains("_by_contraction") { 1e-7 } else { 1e-11 };
                assert!(
                    (found - wanted).abs() <= within * wanted.abs() + 1e-13,
                    "{name} at {row:?}: {wanted:e}"
                );
            }
        }
    }
}

#[test]
fn f_and_v_are_those_of_the_pleated_muscle() {
    let plan = plan(CLOSED);
    let folder = whole(&plan, false);
    for row in rows(folder.path()) {
        let at = |name: &str| number(&row, name).unwrap();
        let radius = plan.muscle.length().si() / at("slenderness");
        let muscle = plan.muscle.with(Parameter::Radius, radius).unwrap();
        let (problem, response) = follow(&muscle, 1e5, at("contraction"));
        let numbers = problem.pleated_numbers(&response).unwrap();
        assert!((at("force_f") - numbers.force_f).abs() < 1e-12 * numbers.force_f.abs() + 1e-14);
        assert_close(at("volume_v"), numbers.volume_v, 1e-12, "volume_v");
    }
    // The last contraction of each muscle is its limit: no force, exactly the solver's contraction.
    for row in rows(folder.path()).iter().skip(40).step_by(41) {
        let at = |name: &str| number(row, name).unwrap();
        let muscle =
            plan.muscle.with(Parameter::Radius, plan.muscle.length().si() / at("slenderness")).unwrap();
        let limit =
            Problem::new(&muscle, Pressure::pa(1e5)).unwrap().contraction_limit(Approach::Auto).unwrap();
        assert_eq!(at("contraction").to_bits(), limit.to_bits());
        assert!(at("force_f").abs() < 1e-10);
    }
}

#[test]
fn effects_of_the_muscle_file_act() {
    let folder = TempDir::new().unwrap();
    let text = bulge_muscles::to_toml(&preset("dmsp-20-250").unwrap());
    let with = format!("{text}\n[effects.hoop-elasticity]\nstiffness = \"1 kN/m\"\n");
    fs::write(folder.path().join("muscle.toml"), &with).unwrap();
    let sweep = |muscle: &str| {
        format!(
            "muscle = \"{muscle}\"\npressure = \"3 bar\"\noutputs = [\"force\", \"volume\", \"stiffness\"]\n[axes.contraction]\nlist = [0.02, 0.06, 0.1]\n"
        )
    };
    let values = |plan: &Plan| {
        let folder = whole(plan, false);
        let rows = rows(folder.path());
        assert_whole(plan, &rows);
        assert_eq!(rows.iter().find_map(reason), None);
        rows.iter()
            .map(|row| ["force", "volume", "stiffness"].map(|name| number(row, name).unwrap()))
            .collect::<Vec<_>>()
    };
    let plain = values(&plan(&sweep("dmsp-20-250")));
    let changed = Plan::from_toml(&sweep("muscle.toml"), "sweep.toml", Some(folder.path())).unwrap();
    let found = values(&changed);
    let extended = |text: &str| {
        let muscle = from_toml(text, "muscle.toml").unwrap();
        MuscleWithEffects::new(&muscle, &known(&muscle, &Catalogue::builtin()).unwrap()).unwrap()
    };
    let stated = extended(&with);
    for (i, contraction) in [0.02, 0.06, 0.1].into_iter().enumerate() {
        let [force, volume, stiffness] = found[i];
        assert!((force - plain[i][0]).abs() > 1.0, "the effects add nothing: {force} N");
        assert!((volume - plain[i][1]).abs() < 1e-12);
        let wanted =
            stated.solve(Pressure::bar(3.0), Given::Contraction(contraction), Approach::Auto).unwrap();
        assert_close(force, wanted.force_n, 1e-12, "force");
        assert_close(stiffness, wanted.stiffness_n_per_m, 1e-12, "stiffness");
    }
    // A number of an effect as an axis gives the muscle that has that number in its file.
    let axis = sweep("muscle.toml")
        + "[axes.\"hoop-elasticity.stiffness\"]\nlist = [\"0.5 kN/m\", \"1 kN/m\", \"2 kN/m\"]\n";
    let varied = Plan::from_toml(&axis, "sweep.toml", Some(folder.path())).unwrap();
    let found_varied = values(&varied);
    assert_eq!(
        found_varied[3..6].iter().flatten().map(|x| x.to_bits()).collect::<Vec<_>>(),
        found.iter().flatten().map(|x| x.to_bits()).collect::<Vec<_>>()
    );
    for (k, stiffness) in ["0.5 kN/m", "1 kN/m", "2 kN/m"].into_iter().enumerate() {
        let extended = extended(&with.replace("1 kN/m", stiffness));
        for (i, contraction) in [0.02, 0.06, 0.1].into_iter().enumerate() {
            let wanted =
                extended.solve(Pressure::bar(3.0), Given::Contraction(contraction), Approach::Auto).unwrap();
            assert_close(found_varied[3 * k + i][0], wanted.force_n, 1e-12, stiffness);
        }
    }
}

#[test]
fn derivatives_are_those_of_the_muscle_with_its_effects() {
    let folder = TempDir::new().unwrap();
    let text = bulge_muscles::to_toml(&preset("dmsp-20-250").unwrap());
    let with = text + "\n[effects.hoop-elasticity]\nstiffness = \"1 kN/m\"\n";
    fs::write(folder.path().join("muscle.toml"), with).unwrap();
    for (axis, list, output, within) in [
        ("radius", "[\"10.715 mm\", \"10.725 mm\", \"10.735 mm\"]", "force_by_radius", 1e-5),
        ("length", "[\"249.9 mm\", \"250 mm\", \"250.1 mm\"]", "force_by_length", 1e-5),
        ("pressure", "[\"2.99 bar\", \"3 bar\", \"3.01 bar\"]", "force_by_pressure", 1e-5),
        ("contraction", "[0.0499, 0.05, 0.0501]", "force_by_contraction", 1e-5),
    ] {
        let fixed = [("pressure", "pressure = \"3 bar\"\n"), ("contraction", "contraction = 0.05\n")];
        let fixed: String = fixed.iter().filter(|(name, _)| *name != axis).map(|(_, line)| *line).collect();
        let text = format!(
            "muscle = \"muscle.toml\"\n{fixed}outputs = [\"force\", \"{output}\"]\n[axes.{axis}]\nlist = {list}\n"
        );
        let plan = Plan::from_toml(&text, "sweep.toml", Some(folder.path())).unwrap();
        let rows = rows(whole(&plan, false).path());
        assert_whole(&plan, &rows);
        let at = |i: usize, name: &str| number(&rows[i], name).unwrap();
        let difference = (at(2, "force") - at(0, "force")) / (at(2, axis) - at(0, axis));
        assert_close(at(1, output), difference, within, output);
    }
}

#[test]
fn csv_has_the_same_numbers() {
    for text in [BRAID, HYPERCUBE] {
        let plan = plan(text);
        let folder = whole(&plan, true);
        let rows = rows(folder.path());
        assert_whole(&plan, &rows);
        let mut at = 0;
        for chunk in 0..plan.chunks() {
            let text = fs::read_to_string(folder.path().join(format!("csv/{chunk:06}.csv"))).unwrap();
            let mut lines = text.lines();
            let heading: Vec<&str> = lines.next().unwrap().split(',').collect();
            assert_eq!((heading[0], *heading.last().unwrap()), ("index", "infeasible"));
            for line in lines {
                // A reason may contain commas, but it is the last cell.
                let cells: Vec<&str> = line.splitn(heading.len(), ',').collect();
                assert_eq!(cells.len(), heading.len());
                assert_eq!(cells[0], at.to_string());
                for (name, cell) in heading.iter().zip(&cells).skip(1) {
                    let name = name.split(" [").next().unwrap();
                    match (name, &rows[at][name]) {
                        ("infeasible", Field::Str(reason)) => assert_eq!(cell.trim_matches('"'), reason),
                        (_, Field::Double(value)) => {
                            assert_eq!(cell.parse::<f64>().unwrap().to_bits(), value.to_bits());
                        }
                        (_, Field::Null) => assert_eq!(*cell, ""),
                        (_, other) => panic!("{name} is {other}"),
                    }
                }
                at += 1;
            }
        }
        assert_eq!(at, rows.len());
    }
}

#[test]
fn columns_carry_their_units() {
    let folder = whole(&plan(BRAID), false);
    let file = fs::File::open(folder.path().join("points/000002.parquet")).unwrap();
    let reader = SerializedFileReader::new(file).unwrap();
    let metadata = reader.metadata().file_metadata();
    let of = |key: &str| -> serde_json::Value {
        let entries = metadata.key_value_metadata().unwrap();
        let text = entries.iter().find(|entry| entry.key == key).unwrap().value.clone().unwrap();
        serde_json::from_str(&text).unwrap()
    };
    let columns = of("bulge.columns");
    let pairs: Vec<(&str, &str)> = columns
        .as_array()
        .unwrap()
        .iter()
        .map(|column| (column["name"].as_str().unwrap(), column["unit"].as_str().unwrap()))
        .collect();
    let wanted = [
        ("index", ""),
        ("braid_angle", "rad"),
        ("contraction", "1"),
        ("force", "N"),
        ("volume", "m^3"),
        ("end_slope", "rad"),
        ("stiffness_isothermal", "N/m"),
        ("infeasible", ""),
    ];
    assert_eq!(pairs, wanted);
    let schema = metadata.schema_descr();
    assert!((0..wanted.len()).all(|i| schema.column(i).name() == wanted[i].0));
    let about = of("bulge.sweep");
    assert_eq!(
        (about["plan"].as_str().map(str::len), about["chunk"].as_u64(), about["first"].as_u64()),
        (Some(64), Some(2), Some(14))
    );
}
