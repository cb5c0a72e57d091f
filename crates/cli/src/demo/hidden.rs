//! The part of the tour with a hidden effect: measurements with an effect hidden in them, the diagnosis that
//! finds it, and the error that decreases when it is added.

use bulge_effects::Catalogue;
use bulge_inference::{DiagnoseOptions, Diagnosis, Options, diagnose};
use bulge_measurements::Data;
use bulge_muscles::from_toml;
use serde::Deserialize;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::arguments::pretty;
use crate::diagnose::paragraph::paragraph;
use crate::diagnose::report;
use crate::diagnose::text::{ladder, verdict};
use crate::failure::Failure;
use crate::files;

/// A case of the suite of hidden effects, whose simulator shares no formula with this program: the files of
/// the user, and the truth.
const FILES: [(&str, &str); 3] = [
    ("data.csv", include_str!("../../data/hidden/data.csv")),
    ("muscle.toml", include_str!("../../data/hidden/muscle.toml")),
    ("truth.json", include_str!("../../data/hidden/truth.json")),
];

/// The hidden truth.
#[derive(Debug, Deserialize)]
struct Truth {
    hidden: Vec<Hidden>,
}

#[derive(Debug, Deserialize)]
struct Hidden {
    effect: String,
}

/// Writes the case, diagnoses it, adds the effect, and diagnoses again. Returns both diagnoses.
pub(super) fn hidden(
    out: &Path,
    text: &mut String,
    written: &mut Vec<PathBuf>,
) -> Result<[Diagnosis; 2], Failure> {
    let folder = out.join("hidden");
    files::folder(&folder)?;
    for (name, content) in FILES {
        let path = folder.join(name);
        files::write(&path, content.as_bytes())?;
        written.push(path);
    }
    let [(data, csv), (muscle, toml), (_, truth)] = FILES;
    let truth: Truth = serde_json::from_str(truth)?;
    let muscle = from_toml(toml, muscle)?;
    let data = Data::from_csv(csv, data)?;
    let asked = |effects: &[String]| -> Result<Diagnosis, Failure> {
        let catalogue = Catalogue::builtin();
        let effects = effects.iter().map(|name| Ok(Arc::clone(catalogue.find(name)?)));
        let effects = effects.collect::<Result<Vec<_>, Failure>>()?;
        Ok(diagnose(&data, &muscle, &DiagnoseOptions::new(Options::new(catalogue, effects)))?)
    };
    let first = asked(&[])?;
    let _ = writeln!(
        text,
        "4. {} readings of a pleated muscle, simulated by another program that hid something in them: what is missing in the model?",
        data.len()
    );
    verdict(text, &first);
    ladder(text, &first);
    let found: Vec<String> = first.missing.iter().map(|missing| missing.fitted.clone()).collect();
    let again = asked(&found)?;
    let _ = writeln!(text, "\n  Asked again with {}:", found.join(" and "));
    verdict(text, &again);
    let names: Vec<&str> = truth.hidden.iter().map(|hidden| hidden.effect.as_str()).collect();
    paragraph(text, "\n  ", &format!("Hidden was: {} (truth.json).", names.join(" and ")));
    text.push('\n');
    let document = pretty(&first)?;
    written.extend(report(&folder.join("report"), &first, &document)?);
    Ok([first, again])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tour_hides_a_case_of_the_suite() {
        let case = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../validation/hidden-effects/cases/single-pleated-lobes-fixed-0"
        );
        for (name, content) in FILES {
            assert_eq!(content, std::fs::read_to_string(format!("{case}/{name}")).unwrap(), "{name}");
        }
    }
}
