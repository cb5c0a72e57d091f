//! Runs a sweep: chunks are computed in parallel and written whole; finished chunks are skipped.

use bulge_muscles::output;
use parquet::errors::ParquetError;
use rayon::prelude::*;
use serde::Serialize;
use serde_json::json;
use std::fs;
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::chunk::{Chunk, Computer};
use crate::design::Layout;
use crate::difference::difference;
use crate::family_error::FamilyError;
use crate::folder::{ChunkManifest, Folder, Standing, hash};
use crate::holds::Holds;
use crate::plan::Plan;

/// Format of the folder.
pub(crate) const SCHEMA: &str = "bulge.sweep/1";

/// Options of a run.
#[derive(Debug, Clone, Default)]
pub struct RunOptions {
    /// Only these chunks; all if none. Several processes may run chunks of one sweep in one folder.
    pub chunks: Option<Range<u64>>,
    /// Resumes the sweep that is in the folder.
    pub resume: bool,
    /// Writes each chunk as CSV as well.
    pub csv: bool,
    /// Folders of the same sweep; their chunks are taken over first.
    pub merge: Vec<PathBuf>,
}

/// Progress of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// Finished points, including those found in the folder.
    pub done: u64,
    /// Points of chunks that were found in the folder. They took no time.
    pub there: u64,
    /// All points of this run.
    pub all: u64,
}

/// Result of a run.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Summary {
    /// Points of the chunks of this run.
    pub points: u64,
    /// Number of these points without equilibrium.
    pub infeasible: u64,
    /// Chunks of this run.
    pub chunks: u64,
    /// Number of these chunks that were computed now; the others were found in the folder.
    pub computed: u64,
    /// Damaged or missing files, which were made again with their chunks.
    pub damaged: Vec<String>,
    /// Whether all chunks of the sweep are there and the manifest is written.
    pub is_complete: bool,
}

impl Summary {
    /// Of chunks of which none was computed now.
    fn of(promises: &[ChunkManifest]) -> Self {
        Self {
            points: promises.iter().map(|promise| promise.points).sum(),
            infeasible: promises.iter().map(|promise| promise.infeasible).sum(),
            chunks: promises.len() as u64,
            computed: 0,
            damaged: Vec::new(),
            is_complete: false,
        }
    }
}

/// Why a sweep stops. Finished chunks stay, and `resume` continues from them.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// A file that can't be read or written.
    #[error("{}: {source}; chunks that are finished stay, and `--resume` goes on from them", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The cause.
        source: io::Error,
    },
    /// A folder that isn't one of this sweep.
    #[error("{} {what}", path.display())]
    Folder {
        /// The folder, or the plan in it.
        path: PathBuf,
        /// What is wrong with it, and what to do instead.
        what: String,
    },
    /// Chunks that the sweep doesn't have, or a sweep without points.
    #[error("{0}")]
    Input(String),
    /// The family of the plan fails.
    #[error(transparent)]
    Family(#[from] FamilyError),
    /// The Parquet library fails.
    #[error("a chunk can't be written as Parquet: {0}")]
    Parquet(#[from] ParquetError),
    /// The plan can't be written as JSON.
    #[error("the plan can't be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
}

impl Plan {
    /// Everything that determines the numbers of the points, as JSON. It is hashed, and compared on resuming.
    ///
    /// # Errors
    /// If a number of the plan has no JSON.
    pub fn canonical(&self) -> Result<String, serde_json::Error> {
        let document = json!({
            "schema": SCHEMA,
            "version": env!("CARGO_PKG_VERSION"),
            "muscle": bulge_muscles::to_toml(&self.muscle).lines().collect::<Vec<_>>(),
            "pressure_pa": self.pressure_pa,
            "contraction": self.contraction,
            "method": format!("{:?}", self.approach),
            "design": self.design,
            "axes": self.axes,
            "outputs": self.outputs,
            "chunk": self.chunk,
        });
        Ok(serde_json::to_string_pretty(&document)? + "\n")
    }
}

/// Prepares a folder for a sweep whose chunks are then given to other processes.
///
/// # Errors
/// [`SweepError`].
pub fn begin(plan: &Plan, path: &Path, options: &RunOptions) -> Result<(), SweepError> {
    let canonical = plan.canonical()?;
    open(&Folder::new(path), path, (&canonical, &hash(canonical.as_bytes())), options).map(drop)
}

/// Runs a sweep into a folder. `told` receives the progress; it is called from several threads.
///
/// # Errors
/// [`SweepError`].
pub fn run(
    plan: &Plan,
    path: &Path,
    options: &RunOptions,
    told: &(dyn Fn(Progress) + Sync),
) -> Result<Summary, SweepError> {
    let layout = Layout::new(plan).ok_or_else(SweepError::no_points)?;
    let all = plan.chunks();
    // If a sweep is split into equal parts, the last part may reach beyond the last chunk.
    let asked = options.chunks.clone().unwrap_or(0..all);
    let chunks = asked.start..asked.end.min(all);
    if chunks.is_empty() {
        return Err(SweepError::no_such_chunks(&asked, all));
    }
    let canonical = plan.canonical()?;
    let key = hash(canonical.as_bytes());
    let folder = Folder::new(path);
    // Before anything is created.
    options.merge.iter().try_for_each(|from| is_of_this_sweep(from, (&canonical, &key)))?;
    let (_lock, lost) = open(&folder, path, (&canonical, &key), options)?;
    let damaged = Mutex::new(Vec::from_iter(lost));
    for from in &options.merge {
        merge(&folder, from, &key, all, &damaged)?;
    }
    let run = Run {
        plan,
        computer: Computer::new(plan, &layout)?,
        folder,
        key,
        csv: options.csv,
        waiting: AtomicU64::new(chunks.end - chunks.start),
        done: AtomicU64::new(0),
        there: AtomicU64::new(0),
        all: points_of(plan, &chunks),
        damaged,
        told,
    };
    run.tell(0, 0);
    let count = usize::try_from(chunks.end - chunks.start).unwrap_or(usize::MAX);
    let promises: Vec<(ChunkManifest, bool)> = (0..count)
        .into_par_iter()
        .with_max_len(1)
        .map(|i| run.chunk(chunks.start + i as u64))
        .collect::<Result<_, _>>()?;
    let computed = promises.iter().filter(|(_, is_new)| *is_new).count() as u64;
    let promises: Vec<ChunkManifest> = promises.into_iter().map(|(promise, _)| promise).collect();
    let mut summary = Summary { computed, ..Summary::of(&promises) };
    summary.damaged = run.damaged.into_inner().unwrap_or_default();
    summary.damaged.sort();
    if chunks == (0..all) {
        let text = manifest(plan, &promises)?;
        write(&run.folder.manifest(), text.as_bytes())?;
        summary.is_complete = true;
    }
    Ok(summary)
}

/// Data shared by all chunks of a run.
struct Run<'a> {
    plan: &'a Plan,
    computer: Computer<'a>,
    folder: Folder,
    key: String,
    csv: bool,
    /// Number of chunks that have not begun.
    waiting: AtomicU64,
    done: AtomicU64,
    there: AtomicU64,
    all: u64,
    damaged: Mutex<Vec<String>>,
    told: &'a (dyn Fn(Progress) + Sync),
}

impl Run<'_> {
    /// Reports points computed now and points found in the folder.
    fn tell(&self, computed: u64, there: u64) {
        let more = computed + there;
        let done = self.done.fetch_add(more, Ordering::Relaxed) + more;
        let there = self.there.fetch_add(there, Ordering::Relaxed) + there;
        (self.told)(Progress { done, there, all: self.all });
    }

    /// A chunk that is found in the folder, or is computed now.
    fn chunk(&self, number: u64) -> Result<(ChunkManifest, bool), SweepError> {
        // If the caller has given up, this call unwinds and the remaining chunks never begin.
        self.tell(0, 0);
        let waiting = self.waiting.fetch_sub(1, Ordering::Relaxed).saturating_sub(1);
        let path = self.folder.promise(number);
        match self.folder.standing(number, &self.key, self.csv).map_err(at(&path))? {
            Standing::Done(promise) => {
                self.tell(0, promise.points);
                return Ok((promise, false));
            }
            Standing::Absent => {}
            Standing::Damaged(what) => {
                if let Ok(mut damaged) = self.damaged.lock() {
                    damaged.push(what);
                }
            }
        }
        // A CSV file that was damaged or isn't requested this time must not stay as it was.
        let csv = self.csv || self.folder.csv(number).exists();
        let points = points_of_chunk(self.plan, number);
        // Only the last chunks are shared. Earlier, a waiting thread would begin another chunk and hold both.
        let threads = rayon::current_num_threads() as u64;
        let chunk = if waiting < threads && threads > 1 {
            self.computer.shared_chunk(points)
        } else {
            self.computer.chunk(points)
        };
        let Piece { parquet, csv, promise } = make(&self.computer, &chunk, &self.key, number, csv)?;
        write(&self.folder.parquet(number), &parquet)?;
        if let Some(text) = csv {
            write(&self.folder.csv(number), text.as_bytes())?;
        }
        write(&path, (serde_json::to_string(&promise)? + "\n").as_bytes())?;
        self.tell(promise.points, 0);
        Ok((promise, true))
    }
}

/// One chunk as bytes, for storage other than a folder. The bytes are the same as those that [`run`] writes.
#[derive(Debug, Clone)]
pub struct Piece {
    /// The Parquet file `points/000000.parquet`.
    pub parquet: Vec<u8>,
    /// The CSV file `csv/000000.csv`, if it was requested.
    pub csv: Option<String>,
    /// The promise `chunks/000000.json`, which must be written last.
    pub promise: ChunkManifest,
}

/// One chunk of a plan as bytes.
///
/// # Errors
/// [`SweepError`], except errors of files.
pub fn piece(plan: &Plan, number: u64, csv: bool) -> Result<Piece, SweepError> {
    let layout = Layout::new(plan).ok_or_else(SweepError::no_points)?;
    let all = plan.chunks();
    if number >= all {
        return Err(SweepError::no_such_chunks(&(number..number + 1), all));
    }
    let key = hash(plan.canonical()?.as_bytes());
    let computer = Computer::new(plan, &layout)?;
    // On one thread, because the caller distributes the pieces itself.
    let chunk = computer.chunk(points_of_chunk(plan, number));
    make(&computer, &chunk, &key, number, csv)
}

fn make(
    computer: &Computer<'_>,
    chunk: &Chunk,
    key: &str,
    number: u64,
    csv: bool,
) -> Result<Piece, SweepError> {
    let about = json!({ "plan": key, "chunk": number, "first": chunk.first });
    let parquet = computer.parquet(chunk, &about.to_string())?;
    let csv = csv.then(|| computer.csv(chunk));
    let promise = ChunkManifest {
        chunk: number,
        first: chunk.first,
        points: chunk.rows() as u64,
        infeasible: chunk.infeasible.len() as u64,
        sha256: hash(&parquet),
        csv_sha256: csv.as_ref().map(|text| hash(text.as_bytes())),
        plan: key.to_owned(),
    };
    Ok(Piece { parquet, csv, promise })
}

/// The text of `manifest.json`, which ends a sweep whose chunks are all there.
///
/// # Errors
/// If a promise has no JSON.
pub fn manifest(plan: &Plan, promises: &[ChunkManifest]) -> Result<String, SweepError> {
    let Summary { points, infeasible, .. } = Summary::of(promises);
    let document = json!({
        "schema": SCHEMA,
        "plan": hash(plan.canonical()?.as_bytes()),
        "points": points,
        "infeasible": infeasible,
        "chunks": promises,
    });
    Ok(serde_json::to_string_pretty(&document)? + "\n")
}

/// Writes the manifest from the promises of all chunks, without reading the chunks again: for chunks that
/// other processes have just finished. None if a promise is missing or of another sweep; then use [`run`].
///
/// # Errors
/// [`SweepError`].
pub fn complete(plan: &Plan, path: &Path) -> Result<Option<Summary>, SweepError> {
    let folder = Folder::new(path);
    let key = hash(plan.canonical()?.as_bytes());
    let mut promises = Vec::new();
    for number in 0..plan.chunks() {
        let file = folder.promise(number);
        let text = match fs::read(&file) {
            Ok(text) => text,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(at(&file)(error)),
        };
        match serde_json::from_slice::<ChunkManifest>(&text) {
            Ok(promise) if promise.plan == key && promise.chunk == number => promises.push(promise),
            _ => return Ok(None),
        }
    }
    write(&folder.manifest(), manifest(plan, &promises)?.as_bytes())?;
    Ok(Some(Summary { is_complete: true, ..Summary::of(&promises) }))
}

/// Numbers of the points of a chunk.
fn points_of_chunk(plan: &Plan, number: u64) -> Range<u64> {
    let all = u64::try_from(plan.points()).unwrap_or(u64::MAX);
    let first = number.saturating_mul(plan.chunk);
    first..first.saturating_add(plan.chunk).min(all)
}

fn points_of(plan: &Plan, chunks: &Range<u64>) -> u64 {
    let last = points_of_chunk(plan, chunks.end.saturating_sub(1));
    last.end - points_of_chunk(plan, chunks.start).start
}

impl SweepError {
    pub(crate) fn folder(path: &Path, what: impl Into<String>) -> Self {
        Self::Folder { path: path.to_owned(), what: what.into() }
    }

    /// The folder holds another sweep: the plan before, and the one now, of which the chunks may be.
    pub(crate) fn changed(path: &Path, [before, now]: [&str; 2], is_of_chunks: bool) -> Self {
        let difference = difference(before, now);
        let cure = if is_of_chunks {
            "take another folder; or, since its chunks are of this sweep, delete its plan.json and add `--resume`"
        } else {
            "take another folder, or undo the change"
        };
        Self::folder(path, format!("holds another sweep; the plans differ in\n{difference}\n{cure}"))
    }

    fn no_such_chunks(asked: &Range<u64>, all: u64) -> Self {
        let Range { start, end } = asked;
        Self::Input(format!("chunks {start}..{end} are asked for: this sweep has the chunks 0..{all}"))
    }

    fn no_points() -> Self {
        Self::Input("this sweep has no points: give every axis such as `points = 101`".to_owned())
    }
}

pub(crate) fn at(path: &Path) -> impl Fn(io::Error) -> SweepError {
    let path = path.to_owned();
    move |source| SweepError::File { path: path.clone(), source }
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), SweepError> {
    output::write(path, bytes).map_err(at(path))
}

/// Prepares the folder, or refuses it for this sweep. Beside the lock it returns what was wrong with the plan,
/// if it had to be written again.
fn open(
    folder: &Folder,
    path: &Path,
    plan: (&str, &str),
    options: &RunOptions,
) -> Result<(Option<fs::File>, Option<String>), SweepError> {
    folder.create(options.csv).map_err(at(path))?;
    let (lock, is_alone) = folder.lock().map_err(at(path))?;
    let holds = Holds::of(folder, path, plan)?;
    let goes_on = options.resume || options.chunks.is_some() || !options.merge.is_empty();
    if !matches!(holds, Holds::Nothing) && !goes_on {
        let what = "holds this sweep already: add `--resume` to go on with it, or take another folder";
        return Err(SweepError::folder(path, what));
    }
    // Other processes may be working on other chunks; their unfinished files must stay.
    if is_alone {
        folder.sweep_up().map_err(at(path))?;
    }
    let lost = match holds {
        Holds::ThisSweep => None,
        // A process may have been killed before it wrote the plan.
        Holds::Nothing => {
            write(&folder.plan(), plan.0.as_bytes())?;
            None
        }
        Holds::ChunksWithoutPlan(what) => {
            write(&folder.plan(), plan.0.as_bytes())?;
            Some(what)
        }
    };
    if let (Some(lock), true) = (&lock, is_alone) {
        Folder::share(lock).map_err(at(path))?;
    }
    Ok((lock, lost))
}

/// Refuses a folder whose chunks can't be taken over.
fn is_of_this_sweep(from: &Path, plan: (&str, &str)) -> Result<(), SweepError> {
    match Holds::of(&Folder::new(from), from, plan)? {
        Holds::Nothing => Err(SweepError::folder(from, "holds no sweep: it has no plan.json")),
        Holds::ThisSweep | Holds::ChunksWithoutPlan(_) => Ok(()),
    }
}

/// Takes over all finished, undamaged chunks from another folder of the same sweep.
fn merge(
    folder: &Folder,
    from: &Path,
    key: &str,
    all: u64,
    damaged: &Mutex<Vec<String>>,
) -> Result<(), SweepError> {
    let other = Folder::new(from);
    for chunk in 0..all {
        let standing =
            |folder: &Folder| folder.standing(chunk, key, false).map_err(at(&folder.promise(chunk)));
        if matches!(standing(folder)?, Standing::Done(_)) {
            continue;
        }
        let promise = match standing(&other)? {
            Standing::Done(promise) => promise,
            Standing::Absent => continue,
            Standing::Damaged(what) => {
                if let Ok(mut damaged) = damaged.lock() {
                    damaged.push(what);
                }
                continue;
            }
        };
        let mut files = vec![(other.parquet(chunk), folder.parquet(chunk))];
        if promise.csv_sha256.is_some() {
            output::create_folder(&folder.csv(chunk).with_file_name("")).map_err(at(&folder.csv(chunk)))?;
            files.push((other.csv(chunk), folder.csv(chunk)));
        }
        // The promise is copied last, because a chunk counts as finished once its promise is there.
        files.push((other.promise(chunk), folder.promise(chunk)));
        for (source, target) in files {
            let bytes = fs::read(&source).map_err(at(&source))?;
            write(&target, &bytes)?;
        }
    }
    Ok(())
}
