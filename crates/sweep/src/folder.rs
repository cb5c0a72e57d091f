//! The folder of a sweep: files that appear whole and stay, and what they promise.
//!
//! ```text
//! plan.json               what is swept, with everything that decides the numbers
//! points/000000.parquet   one file per chunk: the data set
//! csv/000000.csv          the same as CSV, where it was asked for
//! chunks/000000.json      written after the chunk's files: its hashes, by which it counts as done
//! manifest.json           written at the end: all chunks
//! .lock                   held by every process at work: only who is alone removes what a killed one left
//! ```
//! Every file is written under another name, forced to the disk, renamed, and its folder forced to the disk. What a crash or a power loss leaves is
//! either the whole file or none; a chunk whose file doesn't have the hash of its promise is computed again.

use bulge_muscles::output::{UNFINISHED, sync};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// What a finished chunk promises.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ChunkManifest {
    /// Number of the chunk.
    pub chunk: u64,
    /// Number of its first point.
    pub first: u64,
    /// How many points it has.
    pub points: u64,
    /// How many of them have no equilibrium.
    pub infeasible: u64,
    /// SHA-256 of its Parquet file.
    pub sha256: String,
    /// SHA-256 of its CSV file, if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub csv_sha256: Option<String>,
    /// SHA-256 of the plan.
    pub plan: String,
}

/// How a chunk stands.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Standing {
    /// Done, and its files are what it promises.
    Done(ChunkManifest),
    /// Not done.
    Absent,
    /// Done once, but a file is damaged, missing, or of another plan.
    Damaged(String),
}

/// A folder that a sweep is written to.
#[derive(Debug, Clone)]
pub(crate) struct Folder(PathBuf);

impl Folder {
    pub(crate) fn new(path: &Path) -> Self {
        Self(path.to_owned())
    }

    /// Creates it with its folders.
    pub(crate) fn create(&self, csv: bool) -> io::Result<()> {
        for name in ["points", "chunks"].into_iter().chain(csv.then_some("csv")) {
            fs::create_dir_all(self.0.join(name))?;
        }
        // What may be new: the folders, and the folder in its own.
        sync(&self.0)?;
        self.0.canonicalize()?.parent().map_or(Ok(()), sync)
    }

    /// Whether it holds chunks of some sweep.
    pub(crate) fn has_chunks(&self) -> bool {
        let finished = |entry: io::Result<fs::DirEntry>| {
            entry.is_ok_and(|entry| !entry.file_name().to_string_lossy().starts_with(UNFINISHED))
        };
        ["points", "chunks", "csv"]
            .into_iter()
            .any(|name| fs::read_dir(self.0.join(name)).is_ok_and(|mut entries| entries.any(finished)))
    }

    /// A lock on the folder, and whether this process is alone in it. Who is alone holds the lock alone, until [`Self::share`]: nobody begins to
    /// write while unfinished files are removed. All others share it; they wait for whoever is alone. The system lets go of it when a process
    /// ends, however it ends. None where the file system has no locks.
    pub(crate) fn lock(&self) -> io::Result<(Option<File>, bool)> {
        let file = File::options().create(true).truncate(false).write(true).open(self.0.join(".lock"))?;
        let is_alone = file.try_lock().is_ok();
        let is_held = is_alone || file.lock_shared().is_ok();
        Ok((is_held.then_some(file), is_alone))
    }

    /// Lets others in.
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

    /// Removes what a killed process left half-written.
    pub(crate) fn sweep_up(&self) -> io::Result<()> {
        for name in ["", "points", "chunks", "csv"] {
            let Ok(entries) = fs::read_dir(self.0.join(name)) else { continue };
            for entry in entries {
                let path = entry?.path();
                let unfinished =
                    path.file_name().is_some_and(|n| n.to_string_lossy().starts_with(UNFINISHED));
                match unfinished.then(|| fs::remove_file(path)) {
                    Some(Err(error)) if error.kind() != io::ErrorKind::NotFound => return Err(error),
                    _ => {}
                }
            }
        }
        Ok(())
    }

    /// Whether a chunk is done under a plan, all files read and hashed.
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

/// SHA-256 of bytes in hexadecimal digits.
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
