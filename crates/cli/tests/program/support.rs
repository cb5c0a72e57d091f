//! Helpers of the command's tests: temporary folders, calls, and their answers.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;
use tempfile::TempDir;

/// A muscle file and a protocol to simulate it with.
pub(crate) const MUSCLE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/data/braid.toml");
pub(crate) const PROTOCOL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/data/protocol.toml");

/// A folder of its own for each test, removed at the end.
pub(crate) struct Folder(
    pub(crate) PathBuf,
    #[expect(dead_code, reason = "removes the folder when it goes")] TempDir,
);

impl Folder {
    pub(crate) fn new(name: &str) -> Self {
        let folder = tempfile::Builder::new().prefix(&format!("bulge-cli-{name}-")).tempdir().unwrap();
        Self(folder.path().to_owned(), folder)
    }

    pub(crate) fn write(&self, name: &str, text: &str) -> String {
        let path = self.0.join(name);
        std::fs::write(&path, text).unwrap();
        path.display().to_string()
    }

    pub(crate) fn path(&self, name: &str) -> String {
        self.0.join(name).display().to_string()
    }

    pub(crate) fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(&self.0).unwrap();
        let mut names: Vec<String> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }
}

/// Every file below a folder, by its relative path.
pub(crate) fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in std::fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.file_name().is_some_and(|name| name != ".lock") {
                found.insert(path.strip_prefix(folder).unwrap().to_owned(), std::fs::read(&path).unwrap());
            }
        }
    }
    found
}

/// SplitMix64: the times of the kills are the same in each run of the test.
pub(crate) fn next(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}

/// The words of a call as they are typed: blanks part them, except between single quotes.
pub(crate) fn line(typed: &str) -> Vec<&str> {
    let parts = typed.split('\'').enumerate();
    parts
        .flat_map(|(place, part)| if place % 2 == 1 { vec![part] } else { part.split_whitespace().collect() })
        .collect()
}

pub(crate) fn bulge(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_bulge")).args(arguments).output().unwrap()
}

/// What a call prints that succeeds without any message.
pub(crate) fn stdout(arguments: &[&str]) -> String {
    let output = bulge(arguments);
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && message.is_empty(), "{arguments:?}: {message}");
    String::from_utf8(output.stdout).unwrap()
}

pub(crate) fn json(arguments: &[&str]) -> Value {
    serde_json::from_str(&stdout(arguments)).unwrap()
}

/// Exit status and message of a failing call. Standard output is empty, or the document that says the same.
pub(crate) fn failure(arguments: &[&str]) -> (i32, String) {
    let output = bulge(arguments);
    let (status, message) = (output.status.code().unwrap(), String::from_utf8(output.stderr).unwrap());
    if arguments.contains(&"--json") {
        let document: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!((&document["schema"], &document["status"]), (&"bulge.failure/1".into(), &status.into()));
        assert!(message.contains(document["message"].as_str().unwrap()), "{document} {message}");
    } else {
        let printed = String::from_utf8_lossy(&output.stdout);
        assert!(printed.is_empty(), "{arguments:?} printed {printed}");
    }
    (status, message)
}

/// The message of a call that fails with this status; it is short and has these parts.
pub(crate) fn refused(arguments: &[&str], expected: i32, parts: &[&str]) -> String {
    let (status, message) = failure(arguments);
    assert_eq!(status, expected, "{arguments:?}: {message}");
    assert!(message.starts_with("error: ") && message.lines().count() < 12, "{arguments:?}: {message}");
    has_parts(&message, parts);
    message
}

pub(crate) fn has_parts(text: &str, parts: &[&str]) {
    for part in parts {
        assert!(text.contains(part), "{part:?} is not in {text}");
    }
}

/// Simulated measurements in a folder of this name: data file and muscle file.
pub(crate) fn simulated(
    folder: &Folder,
    name: &str,
    [protocol, seed]: [&str; 2],
    more: &[&str],
) -> [String; 2] {
    let out = folder.path(name);
    let call = ["simulate", MUSCLE, "--protocol", protocol, "--out", &out, "--seed", seed];
    stdout(&[&call[..], more].concat());
    ["data.csv", "muscle.toml"].map(|file| folder.path(&format!("{name}/{file}")))
}
