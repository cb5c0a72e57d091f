//! What the folder of a sweep holds before a run.

use std::fs;
use std::io;
use std::path::Path;

use crate::folder::Folder;
use crate::run::{SCHEMA, SweepError, at};

/// What a folder holds, unless it is another sweep.
pub(crate) enum Holds {
    Nothing,
    ThisSweep,
    /// Chunks of this sweep, with what is wrong with their plan.
    ChunksWithoutPlan(String),
}

impl Holds {
    /// Compares the plan in a folder with a plan and its hash. If there is no sound plan, the chunks decide.
    pub(crate) fn of(
        folder: &Folder,
        path: &Path,
        (canonical, key): (&str, &str),
    ) -> Result<Self, SweepError> {
        let plan = folder.plan();
        let promises = || folder.promises(key).map_err(at(path));
        let what = match fs::read(&plan) {
            Ok(before) if before == canonical.as_bytes() => return Ok(Self::ThisSweep),
            Ok(before) => {
                if let Some(before) = sound(&before, canonical) {
                    let is_of_chunks = promises().is_ok_and(|(own, others)| own > 0 && others.is_empty());
                    return Err(SweepError::changed(path, [before, canonical], is_of_chunks));
                }
                if !folder.has_chunks() {
                    let what = "is damaged: take another folder, or delete this file";
                    return Err(SweepError::folder(&plan, what));
                }
                "is damaged"
            }
            Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(at(&plan)(error)),
            Err(_) if !folder.has_chunks() => return Ok(Self::Nothing),
            Err(_) => "is missing",
        };
        let what = format!("{} {what}", plan.display());
        match promises()? {
            (own, others) if own > 0 && others.is_empty() => Ok(Self::ChunksWithoutPlan(what)),
            (own, others) => {
                let why = match others.as_slice() {
                    [] => "no chunk tells of which sweep it is".to_owned(),
                    [first, ..] => format!(
                        "chunks of another sweep are there ({} of {}, such as {})",
                        others.len(),
                        own + others.len(),
                        first.display()
                    ),
                };
                let what =
                    format!("can't be resumed: {what}, and {why}; take another folder, or move them away");
                Err(SweepError::folder(path, what))
            }
        }
    }
}

/// The text of another plan, unless it isn't sound.
fn sound<'a>(before: &'a [u8], canonical: &str) -> Option<&'a str> {
    let text = std::str::from_utf8(before).ok()?;
    let [before, now] = [text, canonical].map(serde_json::from_str::<serde_json::Value>);
    let before = before.ok().filter(|plan| plan["schema"] == SCHEMA)?;
    // The same plan, if only blanks differ, is a damaged one.
    now.is_ok_and(|now| now != before).then_some(text)
}
