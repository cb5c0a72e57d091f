//! Files that appear whole or not at all, and targets that are no regular file.

mod fault;

use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// Beginning of the names of unfinished files. It identifies the files that a killed process leaves.
pub const UNFINISHED: &str = ".unfinished-";
/// Most links in a row. More of them count as a circle, as they do for the system.
const MOST_LINKS: usize = 40;
/// Folders in which a name stands for a file that a process has open.
const OPEN_FILES: [&str; 2] = ["/proc", "/dev/fd"];

/// The target of bytes that are written to a name.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Target {
    /// A regular file, perhaps a new one: it is replaced as a whole.
    File(PathBuf),
    /// A FIFO, a device, or a file that a process has open: bytes are written into it.
    Stream(PathBuf),
}

/// Writes a file as a whole or not at all: under a temporary name beside it, forced to the disk, then
/// renamed.
///
/// A link is followed: its target is replaced, and the link stays. A FIFO, a device or another target that is
/// no regular file is written into, never replaced. A file that is replaced keeps its permissions.
///
/// # Errors
/// Those of the system. Nothing is left of the file then, and an older one stays as it was.
pub fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    write_with(path, bytes, false)
}

/// As [`write()`], but a new file can be read by its owner alone.
///
/// # Errors
/// As [`write()`].
pub fn write_private(path: &Path, bytes: &[u8]) -> io::Result<()> {
    write_with(path, bytes, true)
}

fn write_with(path: &Path, bytes: &[u8], is_private: bool) -> io::Result<()> {
    match target(path)? {
        Target::File(path) => replace(&path, bytes, is_private),
        Target::Stream(path) => {
            // Appending: another program's output may be in the same file, as behind /dev/stdout.
            let mut stream = File::options().append(true).open(path)?;
            fault::write(&mut stream, bytes)?;
            stream.flush()
        }
    }
}

/// Creates a folder with its parents if it doesn't exist.
///
/// # Errors
/// Those of the system.
pub fn create_folder(path: &Path) -> io::Result<()> {
    fault::check()?;
    fs::create_dir_all(path)
}

/// Removes a file.
///
/// # Errors
/// Those of the system.
pub fn remove(path: &Path) -> io::Result<()> {
    fault::check()?;
    fs::remove_file(path)
}

/// Opens a file that processes lock. It is created if needed, and stays empty.
///
/// # Errors
/// Those of the system.
pub fn lock_file(path: &Path) -> io::Result<File> {
    fault::check()?;
    File::options().create(true).truncate(false).write(true).open(path)
}

/// A file under a temporary name. If it isn't published, it is removed.
#[derive(Debug)]
pub struct Unfinished {
    path: PathBuf,
    file: File,
    is_published: bool,
}

impl Unfinished {
    /// A new file in a folder. `name` is a part of its temporary name.
    ///
    /// # Errors
    /// Those of the system.
    pub fn new(folder: &Path, name: &OsStr) -> io::Result<Self> {
        Self::create(folder, name, false)
    }

    fn create(folder: &Path, name: &OsStr, is_private: bool) -> io::Result<Self> {
        static COUNT: AtomicU64 = AtomicU64::new(0);
        // A name of the full length leaves no room for more.
        let name: String = name.to_string_lossy().chars().take(40).collect();
        let mut options = File::options();
        options.write(true).create_new(true);
        #[cfg(unix)]
        if is_private {
            std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
        }
        loop {
            let count = COUNT.fetch_add(1, Ordering::Relaxed);
            let path = folder.join(format!("{UNFINISHED}{}-{count}-{name}", std::process::id()));
            fault::check()?;
            match options.open(&path) {
                // Left by a killed process with the same number.
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
                found => return found.map(|file| Self { path, file, is_published: false }),
            }
        }
    }

    /// Its temporary path.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes further bytes.
    ///
    /// # Errors
    /// Those of the system.
    pub fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        fault::write(&mut self.file, bytes)
    }

    /// Forces the file to the disk and renames it to `path`, in the same folder.
    ///
    /// # Errors
    /// Those of the system. If the new name can't be forced to the disk, the file has it nevertheless.
    pub fn publish(mut self, path: &Path) -> io::Result<()> {
        fault::check()?;
        self.file.sync_all()?;
        fault::check()?;
        fs::rename(&self.path, path)?;
        self.is_published = true;
        sync(folder_of(path))
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        if !self.is_published {
            // If this fails too, the name tells what the file is.
            let _ = remove(&self.path);
        }
    }
}

/// The regular file that [`write()`] would replace or make, with all links followed. `None` for a name that
/// stands for something else or lies in no folder.
#[must_use]
pub fn file_of(path: &Path) -> Option<PathBuf> {
    let Target::File(path) = target(path).ok()? else { return None };
    if let Ok(found) = fs::canonicalize(&path) {
        return Some(found);
    }
    Some(fs::canonicalize(folder_of(&path)).ok()?.join(path.file_name()?))
}

/// Forces a folder's list of names to the disk, if the system can do that.
///
/// # Errors
/// Those of the system.
pub fn sync(folder: &Path) -> io::Result<()> {
    fault::check()?;
    if cfg!(unix) { File::open(folder)?.sync_all() } else { Ok(()) }
}

/// Follows links to the target that is really written.
fn target(path: &Path) -> io::Result<Target> {
    // The target at the end of all links. For a file that a process has open, only the system can tell it.
    match fs::metadata(path) {
        Ok(found) if found.is_dir() => {
            return Err(io::Error::new(
                io::ErrorKind::IsADirectory,
                "it is a folder; give the name of a file",
            ));
        }
        Ok(found) if !found.is_file() => return Ok(Target::Stream(path.to_owned())),
        _ => {}
    }
    let mut path = path.to_owned();
    for _ in 0..MOST_LINKS {
        if is_open_file(&path) {
            return Ok(Target::Stream(path));
        }
        // The first name that is no link, or nothing yet, is the file.
        let Ok(next) = fs::read_link(&path) else { return Ok(Target::File(path)) };
        path = folder_of(&path).join(next);
    }
    Err(io::Error::other("its links go in a circle; give the name of a file"))
}

/// Whether a name is one of a file that some process has open, such as /proc/self/fd/1.
fn is_open_file(path: &Path) -> bool {
    OPEN_FILES.iter().any(|folder| path.starts_with(folder))
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

fn replace(path: &Path, bytes: &[u8], is_private: bool) -> io::Result<()> {
    let mut file = Unfinished::create(folder_of(path), path.file_name().unwrap_or_default(), is_private)?;
    if let Ok(older) = fs::metadata(path) {
        // A file system without permissions has nothing to keep.
        let _ = file.file.set_permissions(older.permissions());
    }
    file.write(bytes)?;
    file.publish(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Folder(PathBuf);

    impl Folder {
        fn new(name: &str) -> Self {
            let path = std::env::temp_dir().join(format!("bulge-output-{name}-{}", std::process::id()));
            fs::create_dir_all(&path).unwrap();
            Self(path)
        }

        fn names(&self) -> Vec<String> {
            let entries = fs::read_dir(&self.0).unwrap();
            let mut names: Vec<String> =
                entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
            names.sort();
            names
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    #[cfg(unix)]
    #[test]
    fn names_of_one_file_are_told_before_it_is_there() {
        let folder = Folder::new("same");
        let at = |name: &str| folder.0.join(name);
        let own = file_of(&at("a"));
        assert!(own.as_ref().is_some_and(|path| path.ends_with("a")) && !at("a").exists());
        assert_ne!(file_of(&at("b")), own);
        // By another way to the folder, and by a link to a file that isn't there yet.
        fs::create_dir_all(at("inner")).unwrap();
        std::os::unix::fs::symlink("a", at("link")).unwrap();
        std::os::unix::fs::symlink(at("inner/.."), at("way")).unwrap();
        for name in ["inner/../a", "./a", "link", "way/a", "way/link"] {
            assert_eq!(file_of(&at(name)), own, "{name}");
        }
        fs::write(at("a"), "here").unwrap();
        for name in ["a", "inner/../a", "link", "way/link"] {
            assert_eq!(file_of(&at(name)), own, "{name}");
        }
        // A target that is no regular file, and targets that lie nowhere.
        assert_eq!([Path::new("/dev/null"), &at("inner"), &at("none/a")].map(file_of), [None, None, None]);
    }

    #[test]
    fn replaces_an_older_file_as_a_whole() {
        let folder = Folder::new("whole");
        let path = folder.0.join("a");
        write(&path, b"a longer text").unwrap();
        write(&path, b"short").unwrap();
        assert_eq!((fs::read(&path).unwrap(), folder.names()), (b"short".to_vec(), vec!["a".to_owned()]));
    }

    #[test]
    fn what_fails_leaves_nothing_behind() {
        let folder = Folder::new("fails");
        let occupied = folder.0.join("occupied");
        fs::create_dir_all(&occupied).unwrap();
        assert_eq!(write(&occupied, b"x").unwrap_err().kind(), io::ErrorKind::IsADirectory);
        // A rename that fails at the last moment.
        assert!(replace(&occupied, b"x", false).is_err());
        assert!(write(&folder.0.join("absent").join("a"), b"x").is_err());
        assert_eq!(folder.names(), ["occupied"]);
    }

    #[cfg(unix)]
    #[test]
    fn links_stay_and_what_they_point_at_is_replaced() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let folder = Folder::new("links");
        let inner = folder.0.join("inner");
        fs::create_dir_all(&inner).unwrap();
        fs::write(inner.join("real"), "old").unwrap();
        fs::set_permissions(inner.join("real"), fs::Permissions::from_mode(0o600)).unwrap();
        symlink("inner/real", folder.0.join("link")).unwrap();
        symlink("link", folder.0.join("link-of-link")).unwrap();
        symlink("inner/new", folder.0.join("dangling")).unwrap();
        symlink("circle", folder.0.join("circle")).unwrap();
        write(&folder.0.join("link-of-link"), b"new").unwrap();
        write(&folder.0.join("dangling"), b"first").unwrap();
        assert!(write(&folder.0.join("circle"), b"x").is_err());
        for link in ["link", "link-of-link", "dangling", "circle"] {
            assert!(folder.0.join(link).is_symlink(), "{link}");
        }
        assert_eq!(fs::read(inner.join("real")).unwrap(), b"new");
        assert_eq!(fs::metadata(inner.join("real")).unwrap().permissions().mode() & 0o777, 0o600);
        assert_eq!(fs::read(inner.join("new")).unwrap(), b"first");
        assert_eq!(fs::read_dir(&inner).unwrap().count(), 2, "no temporary file");
    }

    #[cfg(unix)]
    #[test]
    fn a_fifo_is_written_into() {
        use std::os::unix::fs::FileTypeExt;
        let folder = Folder::new("fifo");
        let fifo = folder.0.join("fifo");
        if !std::process::Command::new("mkfifo").arg(&fifo).status().is_ok_and(|status| status.success()) {
            println!("not tried: this system makes no FIFO");
            return;
        }
        let link = folder.0.join("link");
        std::os::unix::fs::symlink("fifo", &link).unwrap();
        for name in [&fifo, &link] {
            let reader = std::thread::spawn({
                let fifo = fifo.clone();
                move || fs::read(fifo).unwrap()
            });
            write(name, &vec![7; 100_000]).unwrap();
            assert_eq!(reader.join().unwrap(), vec![7; 100_000]);
        }
        assert!(fs::symlink_metadata(&fifo).unwrap().file_type().is_fifo() && link.is_symlink());
        assert_eq!(folder.names(), ["fifo", "link"]);
    }

    /// A file that a process has open is written into: a rename would leave the open file behind.
    #[cfg(target_os = "linux")]
    #[test]
    fn open_files_are_written_into() {
        use std::os::fd::AsRawFd;
        let folder = Folder::new("open");
        let path = folder.0.join("a");
        let file = File::create(&path).unwrap();
        let name = PathBuf::from(format!("/proc/self/fd/{}", file.as_raw_fd()));
        assert_eq!(target(&name).unwrap(), Target::Stream(name.clone()));
        write(&name, b"through").unwrap();
        assert_eq!((fs::read(&path).unwrap(), folder.names()), (b"through".to_vec(), vec!["a".to_owned()]));
    }
}
