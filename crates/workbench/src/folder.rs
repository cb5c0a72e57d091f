//! The folder of a session: the choices, and the files dropped on the page.

use bulge_muscles::output::{self, Unfinished};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

use crate::choices::Choices;
use crate::refusal::{Place, Refusal};

/// The file that holds the choices.
const STATE: &str = "session.json";
/// The last diagnosis: its document and its report.
const DIAGNOSIS: &str = "diagnosis.json";
const REPORT: &str = "diagnosis.html";
/// The folder of the files that were dropped on the page.
const DATA: &str = "data";
/// Name and version of the state file.
const SCHEMA: &str = "bulge.session-file/1";
/// Most steps that undo can go back. Each is as large as the muscle's file.
pub(crate) const MOST_STEPS: usize = 200;

/// The state on the disk: it survives a killed process.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Kept {
    schema: String,
    pub(crate) choices: Choices,
    pub(crate) past: Vec<Choices>,
    pub(crate) future: Vec<Choices>,
    pub(crate) view: Value,
    /// The random token at the end of the address. It is kept, so that an open page finds the session when it
    /// is served again at the same port.
    pub(crate) token: String,
    /// The port of the last run, where an open page looks for the session.
    #[serde(default)]
    pub(crate) port: u16,
    /// The choices given when it was last opened: if the same are given again, the session continues.
    #[serde(default)]
    pub(crate) stated: Option<Choices>,
    /// The choices to which the last diagnosis refers.
    #[serde(default)]
    pub(crate) diagnosed: Option<Choices>,
}

/// A diagnosis as it is saved.
#[derive(Debug, Clone)]
pub(crate) struct Diagnosed {
    pub(crate) document: String,
    pub(crate) report: String,
}

impl Kept {
    pub(crate) fn new(choices: Choices, token: String) -> Self {
        Self {
            schema: SCHEMA.to_owned(),
            port: 0,
            stated: Some(choices.clone()),
            choices,
            past: Vec::new(),
            future: Vec::new(),
            view: Value::Null,
            token,
            diagnosed: None,
        }
    }
}

/// The folder of a session; a temporary one is removed when this value is dropped.
#[derive(Debug)]
pub(crate) struct Folder {
    path: PathBuf,
    _temporary: Option<TempDir>,
}

impl Folder {
    /// Opens a permanent folder, which is created if needed, or a temporary one without a path.
    pub(crate) fn open(path: Option<&Path>) -> io::Result<Self> {
        let temporary =
            if path.is_none() { Some(tempfile::Builder::new().prefix("bulge-").tempdir()?) } else { None };
        let path = match (path, &temporary) {
            (None, Some(made)) => made.path().to_path_buf(),
            (path, _) => std::path::absolute(path.unwrap_or(Path::new(".")))?,
        };
        output::create_folder(&path.join(DATA))?;
        Ok(Self { path, _temporary: temporary })
    }

    /// The state of an earlier run; `None` if there was none.
    pub(crate) fn kept(&self) -> Result<Option<Kept>, Refusal> {
        let path = self.path.join(STATE);
        let refuse = |why: String| {
            let what = format!(
                "{}: {why}; give another folder with --session, or move this file away",
                path.display()
            );
            Refusal::new(Place::Request, what)
        };
        let text = match fs::read_to_string(&path) {
            Ok(text) => text,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(refuse(error.to_string())),
        };
        let kept: Kept = serde_json::from_str(&text)
            .map_err(|error| refuse(format!("is no session of the workbench ({error})")))?;
        if kept.schema == SCHEMA {
            Ok(Some(kept))
        } else {
            Err(refuse(format!("is of another version ({})", kept.schema)))
        }
    }

    /// Writes the state, whole or not at all.
    pub(crate) fn keep(&self, kept: &Kept) -> Result<(), Refusal> {
        let text = serde_json::to_string(kept).map_err(Refusal::at(Place::Request))?;
        let path = self.path.join(STATE);
        // Private, since the state contains the token.
        output::write_private(&path, text.as_bytes()).map_err(|error| {
            Refusal::new(Place::Request, format!("cannot write {}: {error}", path.display()))
        })
    }

    /// Writes a diagnosis.
    pub(crate) fn keep_diagnosis(&self, found: &Diagnosed) -> io::Result<()> {
        output::write(&self.path.join(DIAGNOSIS), found.document.as_bytes())?;
        output::write(&self.path.join(REPORT), found.report.as_bytes())
    }

    /// The stored diagnosis.
    pub(crate) fn diagnosis(&self) -> io::Result<Diagnosed> {
        let [document, report] = [DIAGNOSIS, REPORT].map(|name| fs::read_to_string(self.path.join(name)));
        Ok(Diagnosed { document: document?, report: report? })
    }

    /// The folder of the dropped files.
    pub(crate) fn data(&self) -> PathBuf {
        self.path.join(DATA)
    }

    /// Moves a dropped file to its place. An existing file with the same name and other content is kept,
    /// since undo may need it.
    pub(crate) fn place(&self, name: &str, received: Unfinished) -> io::Result<PathBuf> {
        let folder = self.data();
        let path = Path::new(name);
        let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let end = path.extension().map_or_else(String::new, |end| format!(".{}", end.to_string_lossy()));
        for number in 1_u32.. {
            let other =
                if number == 1 { folder.join(name) } else { folder.join(format!("{stem}-{number}{end}")) };
            if !other.exists() {
                received.publish(&other)?;
                return Ok(other);
            }
            if is_same(&other, received.path())? {
                return Ok(other);
            }
        }
        Err(io::Error::other("all names are taken"))
    }
}

/// Whether two files hold the same bytes.
fn is_same(a: &Path, b: &Path) -> io::Result<bool> {
    Ok(fs::metadata(a)?.len() == fs::metadata(b)?.len() && fs::read(a)? == fs::read(b)?)
}

/// The last component of a name if it is a valid file name: a page may send anything.
pub(crate) fn file_name(name: &str) -> Option<String> {
    let last = name.rsplit(['/', '\\']).next().unwrap_or_default().trim();
    let sound = !last.is_empty()
        && !last.starts_with('.')
        && last.len() <= 200
        && !last.chars().any(char::is_control);
    sound.then(|| last.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stay_in_the_folder() {
        let names = ["a.csv", "../../etc/passwd", "C:\\x\\b.xlsx", "..", ".", "", "a/", "x\0y", ".hidden"];
        let found = names.map(|name| file_name(name).unwrap_or_default());
        assert_eq!(found, ["a.csv", "passwd", "b.xlsx", "", "", "", "", "", ""]);
    }

    #[test]
    fn a_file_of_the_same_name_stays() {
        let folder = Folder::open(None).unwrap();
        let receive = |bytes: &[u8]| {
            let mut file = Unfinished::new(&folder.data(), "a.csv".as_ref()).unwrap();
            file.write(bytes).unwrap();
            folder.place("a.csv", file).unwrap()
        };
        let [first, second, third] = [receive(b"1"), receive(b"2"), receive(b"1")];
        assert_eq!((fs::read(&first).unwrap(), fs::read(&second).unwrap()), (b"1".to_vec(), b"2".to_vec()));
        assert!(first == third && first != second);
        assert_eq!(fs::read_dir(folder.data()).unwrap().count(), 2);
    }
}
