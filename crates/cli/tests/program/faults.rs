//! Faults from outside while a command writes: a disk that gets full, signals, a second process, a clock that
//! jumps. Whatever happens, a file is whole or not there, what was there before is unharmed, and the same
//! command once more gives what an undisturbed one gives.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant, SystemTime};

use serde_json::Value;

use crate::support::{Folder, files, next};

const SWEEP: &str = "muscle = \"ppam-2-r16\"\nchunk = 60\n[axes.contraction]\nrange = \"2 %..limit\"\npoints = 20\n\
    [axes.slenderness]\nrange = \"4..12\"\npoints = 6\n";
const TABLE: &str = "muscle = \"ppam-2-r16\"\n[axes.contraction]\nrange = \"5 %..30 %\"\n\
    [table]\noutputs = [\"force_f\"]\ntolerance = 1e-2\ngradient = 1e-1\nchecks = 100000\n";
const MUSCLE: &str = include_str!("../../data/braid.toml");
const CASE: &str = include_str!("../../../../meshes/tube.toml");

/// A command that writes, with the files that it reads, in a folder of their own. All names are relative: the
/// bytes don't depend on the folder.
struct Case {
    arguments: &'static str,
    /// What the same command takes in addition to go on.
    again: &'static str,
    read: Vec<(&'static str, String)>,
    /// Files that are there before.
    before: &'static [&'static str],
}

/// The fewest changes of files that a written file takes: create, write, force to the disk, rename, force the
/// name to the disk.
const CHANGES: usize = 5;

impl Case {
    fn sweep() -> Self {
        let read = vec![("sweep.toml", SWEEP.to_owned())];
        Self { arguments: "sweep sweep.toml --out out --csv", again: "--resume", read, before: &[] }
    }

    fn table() -> Self {
        let read = vec![("table.toml", TABLE.to_owned())];
        Self { arguments: "sweep table.toml --out out", again: "", read, before: &["out/table.json"] }
    }

    fn curve() -> Self {
        Self {
            arguments: "curve ppam-2-r16 --pressure 1bar --contraction 5%..30% --points 9 --csv out/c.csv --plot out/c.svg",
            again: "",
            read: Vec::new(),
            before: &["out/c.csv"],
        }
    }

    fn report() -> Self {
        let text = include_str!("../../data/braid-loops.csv");
        let lines = text.lines().enumerate().filter(|(i, _)| *i < 3 || i % 5 == 0);
        let lines: Vec<&str> = lines.take(80).map(|(_, line)| line).collect();
        Self {
            arguments: "compare data.csv --muscle muscle.toml --out out",
            again: "",
            read: vec![("data.csv", lines.join("\n")), ("muscle.toml", MUSCLE.to_owned())],
            before: &["out/report.html", "out/compare.json"],
        }
    }

    fn membrane() -> Self {
        let case = CASE.replace("cells = [30]", "cells = [4]");
        Self {
            arguments: "membrane case.toml --out out",
            again: "",
            read: vec![("case.toml", case)],
            before: &["out/states.csv", "out/clamped-tube-of-rubber.pvd"],
        }
    }

    fn simulation() -> Self {
        let protocol = "[[block]]\npressures = [\"2 bar\"]\ncontraction = \"1 %..20 %\"\nshape = \"loops\"\nwave = \"triangle\"\n\
            cycles = 1\nperiod = \"50 s\"\nrows = 20\n";
        Self {
            arguments: "simulate muscle.toml --protocol protocol.toml --seed 1 --out out",
            again: "",
            read: vec![("protocol.toml", protocol.to_owned()), ("muscle.toml", MUSCLE.to_owned())],
            before: &["out/data.csv", "out/truth.json"],
        }
    }

    /// A folder in which the command can run.
    fn folder(&self) -> Folder {
        let folder = Folder::new("faults");
        fs::create_dir(folder.path("out")).unwrap();
        for (name, text) in &self.read {
            folder.write(name, text);
        }
        for name in self.before {
            folder.write(name, &format!("before {name}"));
        }
        folder
    }

    fn command(&self, folder: &Folder, again: bool) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_bulge"));
        let more = if again { self.again } else { "" };
        command.args(self.arguments.split(' ').chain(more.split(' ').filter(|word| !word.is_empty())));
        command.current_dir(&folder.0);
        command
    }

    /// What an undisturbed run leaves.
    fn whole(&self) -> BTreeMap<PathBuf, Vec<u8>> {
        let folder = self.folder();
        let output = self.command(&folder, false).output().unwrap();
        assert!(output.status.success(), "{output:?}");
        let found = files(&folder.0);
        assert!(self.before.iter().all(|name| found[Path::new(name)] != format!("before {name}").as_bytes()));
        found
    }

    /// Every file is whole, as before or as it is to be. Unfinished ones may have been left.
    fn has_whole_files(&self, folder: &Folder, whole: &BTreeMap<PathBuf, Vec<u8>>, unfinished_too: bool) {
        for (path, bytes) in files(&folder.0) {
            if unfinished_too && path.file_name().unwrap().to_string_lossy().starts_with(".unfinished-") {
                continue;
            }
            let before = format!("before {}", path.display()).into_bytes();
            assert!(whole.contains_key(&path), "{} is left", path.display());
            let was_there = self.before.iter().any(|name| Path::new(name) == path);
            assert!(
                bytes == whole[&path] || was_there && bytes == before,
                "{} is half-written",
                path.display()
            );
        }
    }

    /// The same command once more, undisturbed, gives what it would have given.
    fn completes(&self, folder: &Folder, whole: &BTreeMap<PathBuf, Vec<u8>>) {
        let output = self.command(folder, true).output().unwrap();
        assert!(output.status.success(), "{output:?}");
        let mut found = files(&folder.0);
        if self.again.is_empty() {
            // Only a sweep removes what a killed process left.
            found.retain(|path, _| !path.file_name().unwrap().to_string_lossy().starts_with(".unfinished-"));
        }
        assert!(found == *whole, "{:?} {:?}", found.keys(), whole.keys());
    }

    /// Lets every `stride`-th change of files fail, one in each run, and in some runs all from there on.
    fn survives_a_full_disk(&self, stride: usize) {
        if !cfg!(debug_assertions) {
            println!("not tried: an optimised build has no faults");
            return;
        }
        let whole = self.whole();
        let written = whole.len() - self.read.len();
        let mut change = 1;
        loop {
            let and_all_after = change % 3 == 0;
            let fault = if and_all_after { format!("{change}..") } else { change.to_string() };
            let folder = self.folder();
            let output = self.command(&folder, false).env("BULGE_FAIL_WRITE", &fault).output().unwrap();
            if output.status.success() {
                assert!(files(&folder.0) == whole);
                break;
            }
            says_what_failed(&output, &fault);
            self.has_whole_files(&folder, &whole, and_all_after);
            self.completes(&folder, &whole);
            change += stride;
        }
        assert!(change > CHANGES * written, "{change} changes, {written} files");
    }

    /// Sends a signal at some moments of a run.
    fn survives_signals(&self, moments: u32) {
        let whole = self.whole();
        let started = Instant::now();
        let folder = self.folder();
        assert!(self.command(&folder, false).output().unwrap().status.success());
        let duration = started.elapsed();
        let mut state = 7;
        for signal in ["INT", "TERM", "HUP", "KILL"].into_iter().cycle().take(moments as usize) {
            let folder = self.folder();
            let mut command = self.command(&folder, false);
            let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
            sleep(duration.mul_f64(next(&mut state)));
            send(signal, &child);
            child.wait().unwrap();
            self.has_whole_files(&folder, &whole, true);
            self.completes(&folder, &whole);
        }
    }

    /// A reader of standard output that goes away, as `head` does, is no fault.
    fn survives_a_closed_pipe(&self) {
        let folder = self.folder();
        let mut child = self.command(&folder, false).stdout(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        assert!(child.wait().unwrap().success());
        assert!(files(&folder.0) == self.whole());
    }
}

/// One message names a file and says what is wrong with it; the status is 1.
#[track_caller]
fn says_what_failed(output: &Output, fault: &str) {
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{fault}: {message}");
    assert!(message.starts_with("error: ") && message.lines().count() == 1, "{fault}: {message}");
    assert!(message.contains("out") && message.contains("no storage space"), "{fault}: {message}");
    assert!(output.stdout.is_empty(), "{fault}");
}

/// Sends a signal by its name. Without a command for it, the process is killed.
fn send(signal: &str, child: &Child) {
    let sent =
        Command::new("kill").args(["-s", signal, &child.id().to_string()]).stderr(Stdio::null()).status();
    if sent.is_err() {
        println!("not tried: SIG{signal}");
    }
}

#[test]
fn a_sweep_survives_a_full_disk() {
    Case::sweep().survives_a_full_disk(1);
}

#[test]
fn a_table_survives_a_full_disk() {
    // A table takes longer than a file.
    Case::table().survives_a_full_disk(4);
}

#[test]
fn curves_and_pictures_survive_a_full_disk() {
    Case::curve().survives_a_full_disk(1);
}

#[test]
fn a_report_survives_a_full_disk() {
    // Each change of a file is met in some file.
    Case::report().survives_a_full_disk(4);
}

#[test]
fn a_membrane_survives_a_full_disk() {
    Case::membrane().survives_a_full_disk(1);
}

#[test]
fn simulated_measurements_survive_a_full_disk() {
    Case::simulation().survives_a_full_disk(1);
}

#[cfg(unix)]
#[test]
fn signals_leave_whole_files() {
    let cases = [Case::sweep(), Case::curve(), Case::report(), Case::membrane(), Case::simulation()];
    for case in cases {
        case.survives_signals(4);
        case.survives_a_closed_pipe();
    }
}

#[test]
fn two_processes_write_the_same_files() {
    for case in [Case::report(), Case::curve()] {
        let (folder, whole) = (case.folder(), case.whole());
        let start = || case.command(&folder, false).stdout(Stdio::null()).spawn().unwrap();
        for mut child in [start(), start()] {
            assert!(child.wait().unwrap().success());
        }
        assert!(files(&folder.0) == whole);
    }
    // Of two sweeps that begin, one is told that there is another; those that go on share the chunks.
    let case = Case::sweep();
    let whole = case.whole();
    for again in [false, true] {
        let folder = case.folder();
        let start =
            || case.command(&folder, again).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        let outputs = [start(), start()].map(|child| child.wait_with_output().unwrap());
        let successes = outputs.iter().filter(|output| output.status.success()).count();
        assert_eq!(successes, if again { 2 } else { 1 }, "{outputs:?}");
        for output in outputs.iter().filter(|output| !output.status.success()) {
            assert!(
                String::from_utf8_lossy(&output.stderr).contains("holds this sweep already: add `--resume`")
            );
        }
        assert!(files(&folder.0) == whole);
    }
}

#[test]
fn a_clock_that_jumps_changes_nothing() {
    let case = Case::sweep();
    let (folder, whole) = (case.folder(), case.whole());
    assert!(case.command(&folder, false).output().unwrap().status.success());
    let century = Duration::from_hours(100 * 365 * 24);
    for time in [SystemTime::UNIX_EPOCH, SystemTime::now() + century] {
        for path in whole.keys() {
            File::options().write(true).open(folder.0.join(path)).unwrap().set_modified(time).unwrap();
        }
        let output = case.command(&folder, true).arg("--json").output().unwrap();
        let document: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(document["points"]["computed"], 0);
        assert!(files(&folder.0) == whole);
    }
}

/// A workbench in a folder, ended with the value.
struct Workbench(Child);

impl Workbench {
    /// Opens a session; the address if the workbench starts, otherwise what it says.
    fn open(folder: &Folder, fault: Option<&str>) -> Result<(Self, String), Output> {
        let mut command = Command::new(env!("CARGO_BIN_EXE_bulge"));
        command.args(["open", "--no-browser", "--session", "out"]).current_dir(&folder.0);
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        fault.map(|fault| command.env("BULGE_FAIL_WRITE", fault));
        let mut child = command.spawn().unwrap();
        let mut line = String::new();
        let mut stdout = BufReader::new(child.stdout.take().unwrap());
        stdout.read_line(&mut line).unwrap();
        if line.is_empty() { Err(child.wait_with_output().unwrap()) } else { Ok((Self(child), line)) }
    }
}

impl Drop for Workbench {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Asks the workbench at an address; the status of the answer, and the answer.
fn ask(address: &str, call: &str, body: &str) -> (u16, String) {
    let (host, path) = address.trim().trim_start_matches("http://").split_once('/').unwrap();
    let mut stream = TcpStream::connect(host).unwrap();
    let length = body.len();
    let (method, call) = call.split_once(' ').unwrap();
    let head = format!(
        "{method} /{path}api/{call} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\nContent-Length: {length}\r\n\r\n"
    );
    stream.write_all((head + body).as_bytes()).unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    (answer.split(' ').nth(1).unwrap().parse().unwrap(), answer.split_once("\r\n\r\n").unwrap().1.to_owned())
}

#[test]
fn a_session_survives_a_full_disk() {
    if !cfg!(debug_assertions) {
        println!("not tried: an optimised build has no faults");
        return;
    }
    let is_whole = |folder: &Folder| {
        for (path, bytes) in files(&folder.0) {
            assert!(!path.to_string_lossy().contains(".unfinished-"), "{}", path.display());
            let is_json = path.extension().is_some_and(|end| end == "json");
            assert!(!is_json || serde_json::from_slice::<Value>(&bytes).is_ok(), "{}", path.display());
        }
    };
    let mut change = 1;
    let opened = loop {
        let folder = Folder::new("faults-session");
        match Workbench::open(&folder, Some(&change.to_string())) {
            Ok(_) => break change,
            Err(output) => says_what_failed(&output, &change.to_string()),
        }
        is_whole(&folder);
        assert!(Workbench::open(&folder, None).is_ok());
        change += 1;
    };
    assert!(opened > 2 * CHANGES, "{opened}");
    let text = "pressure [bar],contraction [%],force [N]\n2,1,500\n2,5,400\n2,9,300\n2,12,200\n";
    for change in opened.. {
        let folder = Folder::new("faults-session");
        let (workbench, address) = Workbench::open(&folder, Some(&change.to_string())).unwrap();
        let drop_file = || ask(&address, "POST data?name=own.csv", text);
        let (_, before) = ask(&address, "GET session", "");
        let (status, answer) = drop_file();
        is_whole(&folder);
        if status == 200 {
            assert!(change >= opened + 2 * CHANGES, "{change} {opened}");
            break;
        }
        assert!(answer.contains("no storage space"), "{change}: {answer}");
        assert!(answer.contains("own.csv") || answer.contains("session.json"), "{change}: {answer}");
        assert_eq!(ask(&address, "GET session", "").1, before);
        // The next time there is room.
        assert_eq!(drop_file().0, 200);
        is_whole(&folder);
        drop(workbench);
        assert!(Workbench::open(&folder, None).is_ok());
    }
}

#[test]
fn a_session_has_one_workbench() {
    let folder = Folder::new("faults-two");
    let (first, _) = Workbench::open(&folder, None).unwrap();
    let output = Workbench::open(&folder, None).err().unwrap();
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains("out is open in another workbench"), "{message}");
    // A killed workbench holds nothing.
    drop(first);
    assert!(Workbench::open(&folder, None).is_ok());
}

/// A command with two threads and an address space of so many MiB.
#[cfg(target_os = "linux")]
fn limited(folder: &Folder, mib: u64, arguments: &str) -> Output {
    let typed = format!("ulimit -v {} && exec \"$0\" {arguments}", mib << 10);
    let mut shell = Command::new("sh");
    shell.args(["-c", &typed, env!("CARGO_BIN_EXE_bulge")]).env("RAYON_NUM_THREADS", "2");
    shell.current_dir(&folder.0).output().unwrap()
}

#[cfg(target_os = "linux")]
#[test]
fn what_does_not_fit_into_the_memory_is_refused() {
    use std::fmt::Write as _;
    let folder = Folder::new("faults-memory");
    let mut text = "time [s],pressure [bar],contraction [%],force [N]\n".to_owned();
    for row in 0..1_000_000 {
        let step = row % 17;
        writeln!(text, "{row},2,{},{}", step + 1, 500 - 20 * step).unwrap();
    }
    folder.write("data.csv", &text);
    folder.write("muscle.toml", MUSCLE);
    let least = (64..).step_by(32).find(|mib| limited(&folder, *mib, "muscle").status.success()).unwrap();
    // First the file, then its columns, then the rows of a comparison, then those of a diagnosis don't fit.
    for (more, command) in [
        (16, "compare"),
        (48, "compare"),
        (96, "compare"),
        (208, "compare"),
        (208, "predict"),
        (368, "diagnose"),
    ] {
        let output = limited(&folder, least + more, &format!("{command} data.csv --muscle muscle.toml"));
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{more} MiB: {message}");
        let is_one = message.starts_with("error: data.csv: ") && message.lines().count() == 1;
        assert!(is_one, "{more} MiB: {message}");
        for part in ["MiB more memory", "are left (address space, `ulimit -v`)", "keep fewer rows per second"]
        {
            assert!(message.contains(part), "{more} MiB: {message}");
        }
    }
}
