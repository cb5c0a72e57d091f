//! The architecture as a test: who may import whom, and what every source file and every page keeps to. Each rule is tried on a bad sample as well.

#![expect(clippy::unwrap_used, clippy::expect_used, reason = "a test that can't be set up fails")]

mod pages;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What each crate may import of ours, by folder name.
const MAY_IMPORT: &[(&str, &[&str])] = &[
    ("numerics", &[]),
    ("table", &[]),
    ("muscles", &[]),
    ("fibre", &["numerics", "muscles"]),
    ("membrane", &["numerics", "muscles"]),
    ("measurements", &["muscles"]),
    ("effects", &["numerics", "muscles", "fibre"]),
    ("model", &["numerics", "muscles", "fibre", "effects", "measurements"]),
    ("inference", &["numerics", "muscles", "effects", "measurements", "model"]),
    ("design", &["numerics", "muscles", "fibre", "membrane", "effects", "model"]),
    ("sweep", &["numerics", "muscles", "fibre", "effects", "model", "design", "table"]),
    ("vtk", &["muscles", "fibre", "membrane"]),
    (
        "report",
        &[
            "numerics",
            "table",
            "muscles",
            "fibre",
            "membrane",
            "measurements",
            "effects",
            "model",
            "inference",
            "design",
            "sweep",
        ],
    ),
    ("workbench", &["muscles", "fibre", "measurements", "effects", "model", "inference", "vtk", "report"]),
    (
        "bulge",
        &[
            "numerics",
            "table",
            "muscles",
            "fibre",
            "membrane",
            "measurements",
            "effects",
            "model",
            "inference",
            "design",
            "sweep",
            "vtk",
            "report",
        ],
    ),
    ("cli", EVERYTHING),
    ("python", EVERYTHING),
    ("validation", EVERYTHING),
    ("benches", EVERYTHING),
    ("fuzz", EVERYTHING),
];

const EVERYTHING: &[&str] = &["*"];

/// Lines of a source file without its tests.
const MOST_LINES: usize = 500;

/// Names of the dependencies in a manifest, each with the section it stands in.
fn dependencies(manifest: &str) -> Vec<(String, String)> {
    let mut section = String::new();
    let mut found = Vec::new();
    for line in manifest.lines().map(str::trim) {
        if let Some(header) = line.strip_prefix('[') {
            header.trim_end_matches(']').clone_into(&mut section);
            // [dependencies.name]
            if let Some((kind, name)) =
                section.rsplit_once('.').filter(|(kind, _)| kind.ends_with("dependencies"))
            {
                found.push((kind.to_owned(), name.trim_matches('"').to_owned()));
            }
        } else if section.ends_with("dependencies") && !line.is_empty() && !line.starts_with('#') {
            let end = line.find(['.', '=', ' ']).unwrap_or(line.len());
            found.push((section.clone(), line[..end].trim_matches('"').to_owned()));
            // renamed = { package = "name" }
            if let Some((_, rest)) = line.split_once("package") {
                let name = rest.split('"').nth(1).unwrap_or_default();
                found.push((section.clone(), name.to_owned()));
            }
        }
    }
    found
}

/// What a manifest imports and shouldn't.
fn forbidden_imports(folder: &str, manifest: &str) -> Vec<String> {
    let Some((_, allowed)) = MAY_IMPORT.iter().find(|(name, _)| *name == folder) else {
        return vec![format!("crate `{folder}` is not in the architecture's table")];
    };
    let mut complaints = Vec::new();
    for (section, name) in dependencies(manifest) {
        let ours = name.strip_prefix("bulge-").or_else(|| (name == "bulge").then_some("bulge"));
        if let Some(ours) = ours
            && *allowed != EVERYTHING
            && !allowed.contains(&ours)
        {
            complaints.push(format!("`{folder}` imports `{ours}` in [{section}]: it may import {allowed:?}"));
        }
        if name == "pyo3" && folder != "python" {
            complaints.push(format!("`{folder}` names pyo3: only `python` may"));
        }
        if name == "clap" && folder != "cli" {
            complaints.push(format!("`{folder}` names clap: only `cli` may"));
        }
        if folder == "table" && section == "dependencies" {
            complaints.push(format!("`table` depends on `{name}`: it must stand alone"));
        }
    }
    complaints
}

/// The part of a source file before its tests module.
fn without_tests(text: &str) -> impl Iterator<Item = &str> {
    text.lines().take_while(|line| line.trim() != "#[cfg(test)]")
}

/// What a source file does and shouldn't. A file of tests has no lines without its tests.
fn untidy(path: &str, text: &str) -> Vec<String> {
    let mut complaints = Vec::new();
    let first = text.lines().next().unwrap_or_default();
    if !first.starts_with("//! ") {
        complaints.push(format!("{path} does not start with a `//!` line that says what it is"));
    }
    if path.contains("/tests/") {
        return complaints;
    }
    let lines = without_tests(text).count();
    if lines > MOST_LINES {
        complaints.push(format!("{path} has {lines} lines without its tests: more than {MOST_LINES}"));
    }
    // A bench may say why it has to.
    if text.contains("#![expect(clippy::unwrap_used, reason = ") {
        return complaints;
    }
    for (i, line) in without_tests(text).enumerate() {
        let code = line.split("//").next().unwrap_or_default();
        if code.contains(".unwrap()") {
            complaints.push(format!("{path}:{} unwraps outside tests", i + 1));
        }
    }
    complaints
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the package lies in the workspace").to_owned()
}

/// Folders of all packages: `crates/*`, `validation`, `benches`, `fuzz`.
fn packages() -> Vec<PathBuf> {
    let entries = fs::read_dir(root().join("crates")).expect("the workspace has a folder `crates`");
    let mut folders: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    folders.extend(["validation", "benches", "fuzz"].map(|name| root().join(name)));
    folders.retain(|folder| folder.join("Cargo.toml").is_file());
    folders.sort();
    folders
}

/// Every `.rs` file below a folder.
fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if path.is_dir() && name != "target" && !name.starts_with('.') {
            sources(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// Files that are compiled for tests alone: `mod name;` below `#[cfg(test)]` in the file at `path`.
fn test_modules(path: &Path, text: &str) -> Vec<PathBuf> {
    let stem = path.file_stem().unwrap_or_default();
    let beside = ["mod", "lib", "main"].iter().any(|name| stem == *name);
    let folder = path.parent().unwrap_or(path);
    let folder = if beside { folder.to_owned() } else { folder.join(stem) };
    let lines: Vec<&str> = text.lines().map(str::trim).collect();
    let module = |pair: &[&str]| {
        let name = pair[1].trim_start_matches("pub(crate) ").strip_prefix("mod ")?.strip_suffix(';')?;
        (pair[0] == "#[cfg(test)]").then(|| folder.join(name))
    };
    lines.windows(2).filter_map(module).collect()
}

#[test]
fn crates_import_only_what_the_architecture_allows() {
    let packages = packages();
    assert!(packages.len() >= 8, "found only {packages:?}");
    let complaints: Vec<String> = packages
        .iter()
        .flat_map(|folder| {
            let name = folder.file_name().unwrap_or_default().to_string_lossy();
            forbidden_imports(&name, &fs::read_to_string(folder.join("Cargo.toml")).unwrap())
        })
        .collect();
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}

#[test]
fn sources_are_tidy() {
    let mut files = Vec::new();
    for folder in packages() {
        sources(&folder, &mut files);
    }
    assert!(files.len() > 40, "found only {} source files", files.len());
    let texts: Vec<String> = files.iter().map(|path| fs::read_to_string(path).unwrap()).collect();
    let tests: Vec<PathBuf> =
        files.iter().zip(&texts).flat_map(|(path, text)| test_modules(path, text)).collect();
    let is_test = |path: &Path| tests.iter().any(|module| path.with_extension("").starts_with(module));
    let complaints: Vec<String> = files
        .iter()
        .filter(|path| !is_test(path))
        .flat_map(|path| {
            let name = path.strip_prefix(root()).unwrap_or(path).to_string_lossy().replace('\\', "/");
            untidy(&name, &fs::read_to_string(path).unwrap())
        })
        .collect();
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}

/// Each package in the build of some crates, with its features.
fn built(of: &[&str]) -> BTreeSet<String> {
    let edges = ["-e", "normal,build,dev", "--prefix", "none", "-f", "{p} {f}", "--manifest-path"];
    let output = Command::new(env!("CARGO"))
        .args(["tree", "--offline", "--quiet"])
        .args(of)
        .args(edges)
        .arg(root().join("Cargo.toml"))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    text.lines().map(|line| line.trim_end_matches(" (*)").to_owned()).collect()
}

/// Else the tests of the Python package would compile for minutes what the tests of the workspace have compiled with more features.
#[test]
fn a_wheel_is_made_of_what_the_tests_have_built() {
    let (all, wheel) = (built(&["--workspace"]), built(&["-p", "bulge-python"]));
    let anew: Vec<_> = wheel.difference(&all).collect();
    assert!(
        !wheel.is_empty() && anew.is_empty(),
        "state in crates/python/Cargo.toml the features of {anew:?}"
    );
}

/// A list with a hole or a misspelt name would allow what it should forbid.
#[test]
fn the_table_names_only_its_own_crates() {
    for (name, allowed) in MAY_IMPORT {
        for import in allowed.iter().filter(|import| **import != "*") {
            assert!(
                MAY_IMPORT.iter().any(|(known, _)| known == import),
                "`{name}` may import the unknown `{import}`"
            );
            assert_ne!(name, import);
        }
    }
    // No arrow leads back: the order of the table is the direction of the data.
    for (i, (name, _)) in MAY_IMPORT.iter().enumerate() {
        for (earlier, allowed) in &MAY_IMPORT[..i] {
            assert!(!allowed.contains(name), "`{earlier}` imports `{name}`, which comes later");
        }
    }
}

#[test]
fn bad_manifests_are_caught() {
    let manifest =
        "[package]\nname = \"bulge-fibre\"\n[dependencies]\nbulge-numerics.workspace = true\nserde = \"1\"\n";
    assert!(forbidden_imports("fibre", manifest).is_empty());
    for (folder, bad, part) in [
        ("fibre", "bulge-effects.workspace = true", "imports `effects`"),
        ("fibre", "bulge = { path = \"../bulge\" }", "imports `bulge`"),
        ("fibre", "bulge-cli = { path = \"../cli\" }", "imports `cli`"),
        ("workbench", "clap = \"4\"", "only `cli`"),
        ("numerics", "bulge-muscles = { workspace = true }", "imports `muscles`"),
        ("fibre", "net = { package = \"bulge-membrane\", path = \"../membrane\" }", "imports `membrane`"),
        ("fibre", "[dev-dependencies]\nbulge-report.workspace = true", "in [dev-dependencies]"),
        ("fibre", "[dependencies.bulge-model]\nworkspace = true", "imports `model`"),
        ("fibre", "[target.'cfg(unix)'.dependencies]\nbulge-vtk.workspace = true", "imports `vtk`"),
        ("report", "bulge-vtk.workspace = true", "imports `vtk`"),
        ("report", "pyo3 = \"0.27\"", "only `python`"),
        ("table", "serde = \"1\"", "must stand alone"),
        ("helpers", "", "not in the architecture's table"),
    ] {
        let complaints = forbidden_imports(folder, &format!("[dependencies]\n{bad}\n")).join("\n");
        assert!(complaints.contains(part), "{folder} with `{bad}`: {complaints:?} does not say {part:?}");
    }
    assert!(
        forbidden_imports("python", "[dependencies]\npyo3 = \"0.27\"\nbulge-vtk.workspace = true").is_empty()
    );
}

#[test]
fn bad_sources_are_caught() {
    let good = "//! A noun.\nfn f() {}\n#[cfg(test)]\nmod tests {\n    fn g() { h().unwrap(); }\n}\n";
    assert!(untidy("crates/a/src/noun.rs", good).is_empty());
    assert!(untidy("crates/a/src/noun.rs", &format!("//! A noun.\n{}", "\n".repeat(499))).is_empty());
    let long_tests = format!("{good}{}", "\n".repeat(600));
    assert!(untidy("crates/a/src/noun.rs", &long_tests).is_empty());
    for (text, part) in [
        ("fn f() {}\n".to_owned(), "does not start"),
        ("//!\nfn f() {}\n".to_owned(), "does not start"),
        ("// A noun.\nfn f() {}\n".to_owned(), "does not start"),
        (format!("//! A noun.\n{}", "\n".repeat(500)), "501 lines"),
        ("//! A noun.\nfn f() { g().unwrap(); }\n".to_owned(), "noun.rs:2 unwraps"),
    ] {
        let complaints = untidy("crates/a/src/noun.rs", &text).join("\n");
        assert!(complaints.contains(part), "{complaints:?} does not say {part:?}");
    }
    // Doc-tests and files of tests may unwrap, but say what they are.
    assert!(untidy("crates/a/src/noun.rs", "//! A noun.\n/// g().unwrap();\nfn f() {}\n").is_empty());
    assert!(untidy("crates/a/tests/noun.rs", "//! A noun.\nfn f() { g().unwrap(); }\n").is_empty());
    assert!(!untidy("crates/a/tests/noun.rs", "fn f() {}\n").is_empty());
}
