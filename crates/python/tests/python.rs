//! Runs the Python tests: makes an environment and a wheel in folders of their own below the target folder, installs one into the other, and lets
//! pytest run. Where there is no Python 3.10 with `venv`, or what the tests need can't be had, that is said, and the tests count as skipped; with
//! `BULGE_REQUIRE_PYTHON` set (as continuous integration has it) it is an error. A wheel that can't be built or installed always is.
//!
//! Words on the command line are parts of the names of tests, as for tests in Rust: where no Python test has such a name, nothing is built.

use std::env;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};

/// What the tests need. Versions are the user's business; a change of this list makes a new installation.
const NEEDED: &[&str] = &[
    "maturin>=1.9.4,<2",
    "numpy",
    "scipy",
    "pandas",
    "pyarrow",
    "matplotlib",
    "meshio",
    "distributed",
    "dask-jobqueue",
    "fsspec",
    "tqdm",
    "pytest",
    "pytest-xdist",
];

/// Least version of Python.
const LEAST: (u32, u32) = (3, 10);

/// Options of Rust's test programs that have a value, which is no name.
const WITH_VALUE: &[&str] = &["--test-threads", "--format", "--color", "--logfile", "--shuffle-seed", "-Z"];

/// Why no test has run.
enum Why {
    /// This machine can't.
    Absent(String),
    /// Something is wrong.
    Broken(String),
}

fn main() -> ExitCode {
    let (mut words, mut skipped) = (Vec::new(), Vec::new());
    let mut arguments = env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--list" => {
                // One test, for programs that ask.
                println!("python: test");
                return ExitCode::SUCCESS;
            }
            "--skip" => skipped.extend(arguments.next()),
            option if WITH_VALUE.contains(&option) => drop(arguments.next()),
            option if option.starts_with('-') || option == "python" => {}
            _ => words.push(argument),
        }
    }
    let tests = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
    let names = names(&tests);
    let all = names.len();
    if !words.is_empty() && !names.iter().any(|name| words.iter().any(|word| name.contains(word))) {
        println!("\ntest result: ok. 0 passed; 0 failed; 0 ignored; 0 measured; {all} filtered out\n");
        return ExitCode::SUCCESS;
    }
    match run(&tests, &words, &skipped) {
        Ok(status) => status,
        Err(Why::Absent(why)) if env::var_os("BULGE_REQUIRE_PYTHON").is_none() => {
            println!("\nthe {all} Python tests are skipped: {why}");
            println!("\ntest result: ok. 0 passed; 0 failed; {all} ignored; 0 measured; 0 filtered out\n");
            ExitCode::SUCCESS
        }
        Err(Why::Absent(why) | Why::Broken(why)) => {
            println!("\nthe Python tests could not run: {why}");
            ExitCode::FAILURE
        }
    }
}

/// Runs the tests, or says why not.
fn run(tests: &Path, words: &[String], skipped: &[String]) -> Result<ExitCode, Why> {
    let python = python().map_err(Why::Absent)?;
    let target = target().map_err(Why::Broken)?;
    let folder = target.join("python-tests");
    fs::create_dir_all(&folder).map_err(|error| Why::Broken(format!("{}: {error}", folder.display())))?;
    let venv = environment(&python, &folder).map_err(Why::Absent)?;
    let wheel = wheel(&venv, &folder, &target).map_err(Why::Broken)?;
    let install =
        ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-deps", "--force-reinstall"];
    said(Command::new(&venv).args(install).arg(&wheel), "the wheel could not be installed")
        .map_err(Why::Broken)?;
    let mut pytest = Command::new(&venv);
    // Most of a test runs on one core: two files at a time.
    let apart = ["-n", "2", "--dist", "loadfile"];
    pytest
        .args(["-m", "pytest", "-p", "no:cacheprovider"])
        .args(apart)
        .arg("--rootdir")
        .arg(tests)
        .arg(tests);
    let mut chosen: Vec<String> = skipped.iter().map(|word| format!("not {word}")).collect();
    if !words.is_empty() {
        chosen.push(format!("({})", words.join(" or ")));
    }
    if !chosen.is_empty() {
        pytest.args(["-k", &chosen.join(" and ")]);
    }
    // Cross-checks with the command line, where it has been built from this source.
    let command = target.join("debug").join(format!("bulge{}", env::consts::EXE_SUFFIX));
    if is_newer(&command, env::current_exe().ok().as_deref()) {
        pytest.env("BULGE_COMMAND", command);
    }
    pytest.env("PYTHONDONTWRITEBYTECODE", "1").env("MPLBACKEND", "Agg");
    let status = pytest.status().map_err(|error| Why::Broken(format!("pytest: {error}")))?;
    // 5: all are skipped by name.
    let none_left = status.code() == Some(5) && !skipped.is_empty();
    Ok(if status.success() || none_left { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// Whether a program was built in the same run of cargo as this test, or later: within an hour before it.
fn is_newer(program: &Path, than: Option<&Path>) -> bool {
    let built = |path: &Path| fs::metadata(path).and_then(|data| data.modified()).ok();
    let (Some(program), Some(test)) = (built(program), than.and_then(built)) else { return false };
    test.duration_since(program).is_ok_and(|before| before.as_secs() < 3600) || program >= test
}

/// A Python that is new enough and has `venv`.
fn python() -> Result<OsString, String> {
    let candidates =
        env::var_os("BULGE_PYTHON").map_or_else(|| vec!["python3".into(), "python".into()], |own| vec![own]);
    let program = "import sys, venv, ensurepip; print(*sys.version_info[:2])";
    for python in &candidates {
        let Ok(output) = Command::new(python).args(["-c", program]).stderr(Stdio::null()).output() else {
            continue;
        };
        let text = String::from_utf8_lossy(&output.stdout);
        let mut numbers = text.split_whitespace().filter_map(|word| word.parse::<u32>().ok());
        if let (Some(major), Some(minor)) = (numbers.next(), numbers.next())
            && (major, minor) >= LEAST
        {
            return Ok(python.clone());
        }
    }
    Err(format!(
        "there is no Python {}.{} or newer with `venv` here (name one with BULGE_PYTHON)",
        LEAST.0, LEAST.1
    ))
}

/// The target folder: that of this test, which lies in `target/debug/deps`.
fn target() -> Result<PathBuf, String> {
    let this = env::current_exe().map_err(|error| error.to_string())?;
    let target = this.ancestors().nth(3).ok_or("this test lies in no target folder")?;
    Ok(target.to_path_buf())
}

/// The Python of an environment that has what is needed.
fn environment(python: &OsString, folder: &Path) -> Result<PathBuf, String> {
    let venv = folder.join("venv");
    let bin = venv.join(if cfg!(windows) { "Scripts" } else { "bin" });
    let (inner, done) = (bin.join("python"), folder.join("installed.txt"));
    let list = NEEDED.join("\n");
    if inner.exists() && fs::read_to_string(&done).is_ok_and(|there| there == list) {
        return Ok(inner);
    }
    said(Command::new(python).args(["-m", "venv", "--clear"]).arg(&venv), "no environment could be made")?;
    let install = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check"];
    said(Command::new(&inner).args(install).args(NEEDED), "what the tests need could not be installed")?;
    fs::write(&done, list).map_err(|error| error.to_string())?;
    Ok(inner)
}

/// A wheel of this source.
fn wheel(python: &Path, folder: &Path, target: &Path) -> Result<PathBuf, String> {
    let wheels = folder.join("wheel");
    if wheels.exists() {
        fs::remove_dir_all(&wheels).map_err(|error| error.to_string())?;
    }
    // The profile of the tests: nearly all is compiled already.
    let mut maturin = Command::new(python);
    maturin.args(["-m", "maturin", "build", "--quiet", "--profile", "dev", "--manifest-path"]);
    maturin.arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml")).arg("--out").arg(&wheels);
    maturin.env("CARGO_TARGET_DIR", target);
    // Cargo's own variables of this test would be taken for those of the build.
    for (name, _) in env::vars_os() {
        let text = name.to_string_lossy();
        if text.starts_with("CARGO_PKG_")
            || text.starts_with("CARGO_MANIFEST_")
            || text == "CARGO_PRIMARY_PACKAGE"
        {
            maturin.env_remove(&name);
        }
    }
    said(&mut maturin, "no wheel could be built")?;
    let entries = fs::read_dir(&wheels).map_err(|error| error.to_string())?;
    let made =
        entries.flatten().map(|entry| entry.path()).find(|path| path.extension().is_some_and(|e| e == "whl"));
    made.ok_or_else(|| "maturin made no wheel".to_owned())
}

/// Runs a command that says nothing unless it fails.
fn said(command: &mut Command, what: &str) -> Result<(), String> {
    let output = command.output().map_err(|error| format!("{what}: {error}"))?;
    if output.status.success() {
        return Ok(());
    }
    Err(format!(
        "{what}:\n{}{}",
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    ))
}

/// Names of the test functions.
fn names(tests: &Path) -> Vec<String> {
    let Ok(entries) = fs::read_dir(tests) else { return Vec::new() };
    let texts = entries.flatten().filter_map(|entry| fs::read_to_string(entry.path()).ok());
    let name = |line: &str| Some(line.trim_start().strip_prefix("def ")?.split('(').next()?.to_owned());
    texts
        .flat_map(|text| text.lines().filter_map(name).collect::<Vec<_>>())
        .filter(|name| name.starts_with("test_"))
        .collect()
}
