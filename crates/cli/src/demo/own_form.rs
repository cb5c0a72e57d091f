//! The part of the tour with an effect of another form: the form error that the data suggest for the nearest
//! effect of the catalogue, and the user-defined effect that it becomes.

use bulge_effects::Catalogue;
use bulge_inference::{DiagnoseOptions, Diagnosis, Options, diagnose, drawn_forms};
use bulge_measurements::Data;
use bulge_muscles::from_toml;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use crate::arguments::{self, pretty};
use crate::diagnose::report;
use crate::diagnose::text::{ladder, verdict};
use crate::failure::Failure;
use crate::files;

/// Measurements with a rubber liner by Gent's law, and the muscle of the user.
const FILES: [(&str, &str); 2] = [
    ("data.csv", include_str!("../../data/own-form/data.csv")),
    ("muscle.toml", include_str!("../../data/own-form/muscle.toml")),
];
/// The hidden law.
const LAW: (&str, &str) = ("gent-liner.toml", include_str!("../../data/gent-liner.toml"));

/// Diagnoses, draws the form, writes it as an effect, and diagnoses again with it. Returns both diagnoses.
pub(super) fn own_form(
    out: &Path,
    text: &mut String,
    written: &mut Vec<PathBuf>,
) -> Result<[Diagnosis; 2], Failure> {
    let folder = out.join("own-form");
    files::folder(&folder)?;
    for (name, content) in FILES.into_iter().chain([LAW]) {
        let path = folder.join(name);
        files::write(&path, content.as_bytes())?;
        written.push(path);
    }
    let [(data, csv), (muscle, toml)] = FILES;
    let muscle = from_toml(toml, muscle)?;
    let data = Data::from_csv(csv, data)?;
    let asked = |options: Options| diagnose(&data, &muscle, &DiagnoseOptions::new(options));
    let _ = writeln!(
        text,
        "  And with rubber of a form that the catalogue lacks (Gent's law, {}), in {} readings of a braid:",
        LAW.0,
        data.len()
    );
    let first = asked(Options::new(Catalogue::builtin(), Vec::new()))?;
    verdict(text, &first);
    ladder(text, &first);
    let document = pretty(&first)?;
    written.extend(report(&folder.join("report"), &first, &document)?);
    let found: Vec<String> = first.missing.iter().map(|missing| missing.fitted.clone()).collect();
    let catalogue = Catalogue::builtin();
    let effects = arguments::effects(&catalogue, &found)?;
    let drawn = drawn_forms(&data, &muscle, &Options::new(catalogue, effects))?;
    let path = folder.join("bent.toml");
    let file: Vec<&str> = drawn.forms.iter().map(|form| form.toml.as_str()).collect();
    files::write(&path, file.concat().as_bytes())?;
    // Effects whose form wasn't written keep that of the catalogue.
    let names: Vec<String> =
        drawn.forms.iter().map(|form| form.written.as_ref().unwrap_or(&form.effect).clone()).collect();
    let catalogue = arguments::catalogue(Some(&path))?;
    let effects = arguments::effects(&catalogue, &names)?;
    let again = asked(Options::new(catalogue, effects))?;
    let _ = writeln!(
        text,
        "\n  The report draws the form that the data want (\"Formula and data\"). Written as an effect, {}, and asked again with it:",
        path.display()
    );
    verdict(text, &again);
    ladder(text, &again);
    text.push('\n');
    written.push(path);
    Ok([first, again])
}

#[cfg(test)]
mod tests {
    use super::*;
    use bulge_effects::Mechanism;
    use bulge_inference::Verdict;

    #[test]
    fn the_form_that_was_hidden_becomes_an_effect_that_explains_the_data() {
        let out = std::env::temp_dir().join(format!("bulge-own-form-{}", std::process::id()));
        let (mut text, mut written) = (String::new(), Vec::new());
        files::folder(&out).unwrap();
        let [first, again] = own_form(&out, &mut text, &mut written).unwrap();
        assert_eq!((first.verdict, first.missing.len()), (Verdict::Missing, 1));
        assert_eq!(first.missing[0].mechanism, Mechanism::Rubber);
        assert_eq!(again.verdict, Verdict::Adequate, "{text}");
        assert!(text.contains("bladder-axial-bent"), "{text}");
        assert!(written.iter().all(|path| path.exists()));
        let report = std::fs::read_to_string(out.join("own-form/report/report.html")).unwrap();
        assert!(report.contains("Formula and data"));
        std::fs::remove_dir_all(&out).unwrap();
    }
}
