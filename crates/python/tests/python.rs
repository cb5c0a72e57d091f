//! Runs the Python tests: makes an environment and a wheel in folders of their own below the target folder, installs one into the other, and lets
//! pytest run. Where there is no Python 3.10 with `venv`, or nothing can be installed, that is said, and the tests count as skipped; with
//! `BULGE_REQUIRE_PYTHON` set (as continuous integration has it) it is an error.
//!
//! Arguments after `--` are words that the names of the tests must contain.

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
    "fsspec",
    "tqdm",
    "pytest",
];

/// Least version of Python.
const LEAST: (u32, u32) = (3, 10);

fn main() -> ExitCode {
    let words: Vec<String> = env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    if env::args().any(|word| word == "--list") {
        return ExitCode::SUCCESS;
    }
    let tests = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
    match run(&tests, &words) {
        Ok(status) => status,
        Err(why) if env::var_os("BULGE_REQUIRE_PYTHON").is_some() => {
            println!("\nthe Python tests could not run: {why}");
            ExitCode::FAILURE
        }
        Err(why) => {
            let count = count(&tests);
            println!("\nthe {count} Python tests are skipped: {why}");
            println!("\ntest result: ok. 0 passed; 0 failed; {count} ignored; 0 measured; 0 filtered out\n");
            ExitCode::SUCCESS
        }
    }
}

/// Runs the tests, or says why that is not possible here.
fn run(tests: &Path, words: &[String]) -> Result<ExitCode, String> {
    let python = python()?;
    let target = target()?;
    let folder = target.join("python-tests");
    fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let venv = environment(&python, &folder)?;
    let wheel = wheel(&venv, &folder, &target)?;
    let install =
        ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-deps", "--force-reinstall"];
    said(Command::new(&venv).args(install).arg(&wheel), "the wheel could not be installed")?;
    let mut pytest = Command::new(&venv);
    pytest.args(["-m", "pytest", "-p", "no:cacheprovider", "--rootdir"]).arg(tests).arg(tests);
    if !words.is_empty() {
        pytest.args(["-k", &words.join(" or ")]);
    }
    // Cross-checks with the command line, where it has been built.
    let command = target.join("debug").join(format!("bulge{}", env::consts::EXE_SUFFIX));
    if command.exists() {
        pytest.env("BULGE_COMMAND", command);
    }
    pytest.env("PYTHONDONTWRITEBYTECODE", "1").env("MPLBACKEND", "Agg");
    let status = pytest.status().map_err(|error| format!("pytest: {error}"))?;
    // 5: no test has such a name.
    Ok(if status.success() || (status.code() == Some(5) && !words.is_empty()) {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    })
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

/// How many test functions there are, to say how many are skipped.
fn count(tests: &Path) -> usize {
    let Ok(entries) = fs::read_dir(tests) else { return 0 };
    let texts = entries.flatten().filter_map(|entry| fs::read_to_string(entry.path()).ok());
    texts.map(|text| text.lines().filter(|line| line.trim_start().starts_with("def test_")).count()).sum()
}
