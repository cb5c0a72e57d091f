//! Many shapes as numbered `.vtp` files and one `.pvd` that ParaView plays as an animation.

use crate::bulge::Bulge;
use crate::{VtkError, whole_file, write_vtp};
use bulge_muscles::output;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Writes `stem_0000.vtp`, `stem_0001.vtp`, ... into the folder `dir`, which is created if needed. Then it
/// writes `stem.pvd` and returns its path. The first entry of each pair is the value that ParaView shows as
/// time: the contraction, or any other value that orders the shapes.
///
/// # Errors
/// As [`write_vtp`]; also if the series is empty, one of its values isn't finite, the stem can't be part of a
/// file name, or the folder can't be created.
pub fn write_series(
    dir: impl AsRef<Path>,
    stem: &str,
    members: &[(f64, Bulge)],
) -> Result<PathBuf, VtkError> {
    let dir = dir.as_ref();
    check(stem, members)?;
    create(dir)?;
    for (index, (_, bulge)) in members.iter().enumerate() {
        write_vtp(dir.join(member_name(stem, index, "vtp")), bulge)?;
    }
    let path = dir.join(format!("{stem}.pvd"));
    let xml = collection(stem, "vtp", members.iter().map(|(value, _)| *value));
    whole_file::write(&path, xml.as_bytes())?;
    Ok(path)
}

/// Creates the folder of a series and its parents.
pub(crate) fn create(dir: &Path) -> Result<(), VtkError> {
    output::create_folder(dir).map_err(|source| VtkError::File {
        path: dir.to_path_buf(),
        action: "create the folder",
        source,
    })
}

/// Checks that the stem can be part of file names.
pub(crate) fn check_stem(stem: &str) -> Result<(), VtkError> {
    let is_name = !stem.is_empty() && !stem.contains(['/', '\\']) && !stem.contains(char::is_control);
    if is_name {
        Ok(())
    } else {
        Err(VtkError::Drawing(format!(
            "{stem:?} can't begin the file names of a series: use a name without folders"
        )))
    }
}

fn check(stem: &str, members: &[(f64, Bulge)]) -> Result<(), VtkError> {
    check_stem(stem)?;
    if members.is_empty() {
        return Err(VtkError::Drawing("a series needs at least one shape".to_owned()));
    }
    match members.iter().enumerate().find(|(_, (value, _))| !value.is_finite()) {
        Some((index, (value, _))) => Err(VtkError::Drawing(format!(
            "the value of member {index} of the series is {value}: it must be finite"
        ))),
        None => members.iter().try_for_each(|(_, bulge)| bulge.check()),
    }
}

pub(crate) fn member_name(stem: &str, index: usize, extension: &str) -> String {
    format!("{stem}_{index:04}.{extension}")
}

/// Content of the `.pvd` file. The file names in it are relative to it.
pub(crate) fn collection(stem: &str, extension: &str, values: impl Iterator<Item = f64>) -> String {
    let mut xml = String::from(concat!(
        "<?xml version=\"1.0\"?>\n",
        "<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n",
        "  <Collection>\n",
    ));
    for (index, value) in values.enumerate() {
        let file = escape(&member_name(stem, index, extension));
        // Writing to a String can't fail.
        let _ = writeln!(xml, "    <DataSet timestep=\"{value}\" part=\"0\" file=\"{file}\"/>");
    }
    xml + "  </Collection>\n</VTKFile>\n"
}

/// Escapes text for the value of an XML attribute.
fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Style;
    use crate::analytic::barrel;
    use std::fs;

    #[test]
    fn writes_members_and_collection() {
        let parent = tempfile::tempdir().unwrap();
        let folder = parent.path().join("new");
        let shapes = [barrel(8, 0.0), barrel(9, 0.0)];
        let style = Style::Pleats { cloth_circumference: None };
        let members: Vec<_> = shapes
            .iter()
            .zip([0.0, 0.05])
            .map(|(shape, value)| (value, Bulge { shape, fibres: 4, style, facets: 4 }))
            .collect();
        let path = write_series(&folder, "a & b", &members).unwrap();
        assert_eq!(path, folder.join("a & b.pvd"));
        let xml = fs::read_to_string(&path).unwrap();
        assert!(xml.contains(r#"<DataSet timestep="0.05" part="0" file="a &amp; b_0001.vtp"/>"#), "{xml}");
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 3);
    }

    #[test]
    fn refuses_before_writing_anything() {
        let parent = tempfile::tempdir().unwrap();
        let folder = parent.path().join("new");
        let shape = barrel(8, 0.0);
        let bulge = Bulge { shape: &shape, fibres: 4, style: Style::Revolution, facets: 4 };
        let message = |stem: &str, members: &[(f64, Bulge)]| {
            write_series(&folder, stem, members).unwrap_err().to_string()
        };
        assert!(message("up/down", &[(0.0, bulge)]).contains("up/down"));
        assert!(message("", &[(0.0, bulge)]).contains("without folders"));
        assert!(message("a", &[]).contains("at least one shape"));
        assert!(message("a", &[(0.0, bulge), (f64::NAN, bulge)]).contains("member 1"));
        assert!(message("a", &[(0.0, bulge), (0.1, Bulge { facets: 1, ..bulge })]).contains("1 facets"));
        assert!(!folder.exists());
    }
}
