//! The folder of a sweep: its files appear only when complete, and each chunk has a record with its hashes.
//!
//! ```text
//! plan.json               what is swept, with everything that decides the numbers
//! points/000000.parquet   one file per chunk: the data set
//! csv/000000.csv          the same as CSV, where it was asked for
//! chunks/000000.json      written after the chunk's files: its hashes, by which it counts as done
//! manifest.json           written at the end: all chunks
//! .lock                   held by every process at work: only who is alone removes what a killed one left
//! ```
//! Every file is written under another name, forced to the disk and renamed; then its folder is forced to the
//! disk. After a crash or a power loss a file is therefore either complete or absent. A chunk is computed
//! again if its file doesn't have the hash in its promise. The promises also name the plan, by its hash: if
//! `plan.json` is lost, they tell which sweep the folder holds.

use bulge_muscles::output::{UNFINISHED, create_folder, lock_file, remove, sync};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// The promise of a finished chunk.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ChunkManifest {
    /// Number of the chunk.
    pub chunk: u64,
    /// Number of its first point.
    pub first: u64,
    /// Number of its points.
    pub points: u64,
    /// Number of these without equilibrium.
    pub infeasible: u64,
    /// SHA-256 of its Parquet file.
    pub sha256: String,
    /// SHA-256 of its CSV file, if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub csv_sha256: Option<String>,
    /// SHA-256 of the plan.
    pub plan: String,
}

/// State of a chunk.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Standing {
    /// Done, and its files match its promise.
    Done(ChunkManifest),
    /// Not done.
    Absent,
    /// Done earlier, but a file is damaged, missing, or of another plan.
    Damaged(String),
}

/// The folder into which a sweep is written.
#[derive(Debug, Clone)]
pub(crate) struct Folder(PathBuf);

impl Folder {
    pub(crate) fn new(path: &Path) -> Self {
        Self(path.to_owned())
    }

    /// Creates the folder and its subfolders.
    pub(crate) fn create(&self, csv: bool) -> io::Result<()> {
        for name in ["points", "chunks"].into_iter().chain(csv.then_some("csv")) {
            create_folder(&self.0.join(name))?;
        }
        // The subfolders may be new, and so may the folder itself within its parent.
        sync(&self.0)?;
        self.0.canonicalize()?.parent().map_or(Ok(()), sync)
    }

    /// Whether the folder holds chunks of any sweep.
    pub(crate) fn has_chunks(&self) -> bool {
        let finished = |entry: io::Result<fs::DirEntry>| {
            entry.is_ok_and(|entry| !entry.file_name().to_string_lossy().starts_with(UNFINISHED))
        };
        ["points", "chunks", "csv"]
            .into_iter()
            .any(|name| fs::read_dir(self.0.join(name)).is_ok_and(|mut entries| entries.any(finished)))
    }

    /// Number of the promises of a plan, and the paths of those of other plans. Damaged ones tell nothing.
    pub(crate) fn promises(&self, plan: &str) -> io::Result<(usize, Vec<PathBuf>)> {
        let (mut own, mut others) = (0, Vec::new());
        let entries = match fs::read_dir(self.0.join("chunks")) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok((own, others)),
            entries => entries?,
        };
        for entry in entries {
            let path = entry?.path();
            match fs::read(&path).ok().and_then(|text| serde_json::from_slice::<ChunkManifest>(&text).ok()) {
                Some(promise) if promise.plan == plan => own += 1,
                Some(_) => others.push(path),
                None => {}
            }
        }
        others.sort();
        Ok((own, others))
    }

    /// Locks the folder, and tells whether this process is alone in it.
    ///
    /// A process that is alone holds the lock exclusively until [`Self::share`], so no other process begins
    /// to write while unfinished files are removed. All others share the lock, and wait for an exclusive
    /// holder. The system releases the lock when a process ends, for whatever reason. The returned lock
    /// is none where the file system has no locks.
    pub(crate) fn lock(&self) -> io::Result<(Option<File>, bool)> {
        let file = lock_file(&self.0.join(".lock"))?;
        let is_alone = file.try_lock().is_ok();
        let is_held = is_alone || file.lock_shared().is_ok();
        Ok((is_held.then_some(file), is_alone))
    }

    /// Lets other processes in.
    pub(crate) fn share(lock: &File) -> io::Result<()> {
        lock.unlock()?;
        lock.lock_shared()
    }

    pub(crate) fn plan(&self) -> PathBuf {
        self.0.join("plan.json")
    }

    pub(crate) fn manifest(&self) -> PathBuf {
        self.0.join("manifest.json")
    }

    pub(crate) fn parquet(&self, chunk: u64) -> PathBuf {
        self.0.join("points").join(format!("{chunk:06}.parquet"))
    }

    pub(crate) fn csv(&self, chunk: u64) -> PathBuf {
        self.0.join("csv").join(format!("{chunk:06}.csv"))
    }

    pub(crate) fn promise(&self, chunk: u64) -> PathBuf {
        self.0.join("chunks").join(format!("{chunk:06}.json"))
    }

    /// Removes unfinished files that a killed process left.
    pub(crate) fn sweep_up(&self) -> io::Result<()> {
        for name in ["", "points", "chunks", "csv"] {
            let Ok(entries) = fs::read_dir(self.0.join(name)) else { continue };
            for entry in entries {
                let path = entry?.path();
                let unfinished =
                    path.file_name().is_some_and(|n| n.to_string_lossy().starts_with(UNFINISHED));
                match unfinished.then(|| remove(&path)) {
                    Some(Err(error)) if error.kind() != io::ErrorKind::NotFound => return Err(error),
                    _ => {}
                }
            }
        }
        Ok(())
    }

    /// State of a chunk under a plan. All its files are read and hashed.
    pub(crate) fn standing(&self, chunk: u64, plan: &str, csv: bool) -> io::Result<Standing> {
        let path = self.promise(chunk);
        let text = match fs::read(&path) {
            Ok(text) => text,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Standing::Absent),
            Err(error) => return Err(error),
        };
        let damaged = |what: String| Ok(Standing::Damaged(what));
        let Ok(promise) = serde_json::from_slice::<ChunkManifest>(&text) else {
            return damaged(format!("{} is damaged", path.display()));
        };
        if promise.plan != plan || promise.chunk != chunk {
            return damaged(format!("{} belongs to another sweep", path.display()));
        }
        let files = [
            Some((self.parquet(chunk), promise.sha256.clone())),
            promise.csv_sha256.clone().map(|hash| (self.csv(chunk), hash)),
        ];
        for (path, hash) in files.into_iter().flatten() {
            match hash_of_file(&path) {
                Ok(found) if found == hash => {}
                Ok(_) => return damaged(format!("{} is damaged or truncated", path.display())),
                Err(error) if error.kind() == io::ErrorKind::NotFound => {
                    return damaged(format!("{} is missing", path.display()));
                }
                Err(error) => return Err(error),
            }
        }
        if csv && promise.csv_sha256.is_none() {
            return Ok(Standing::Absent);
        }
        Ok(Standing::Done(promise))
    }
}

/// SHA-256 of the bytes, in hexadecimal digits.
pub(crate) fn hash(bytes: &[u8]) -> String {
    hexadecimal(&Sha256::digest(bytes))
}

fn hash_of_file(path: &Path) -> io::Result<String> {
    let mut file = File::open(path)?;
    let mut hasher = Sha256::new();
    let mut buffer = vec![0; 1 << 16];
    loop {
        match file.read(&mut buffer)? {
            0 => return Ok(hexadecimal(&hasher.finalize())),
            read => hasher.update(&buffer[..read]),
        }
    }
}

fn hexadecimal(bytes: &[u8]) -> String {
    use std::fmt::Write as _;
    bytes.iter().fold(String::with_capacity(2 * bytes.len()), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}
