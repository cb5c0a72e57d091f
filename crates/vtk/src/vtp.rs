//! One shape as one `.vtp` file (VTK XML `PolyData`).

use crate::VtkError;
use crate::bulge::{Bulge, whole};
use crate::error::check_extension;
use crate::mesh::Mesh;
use crate::whole_file;
use crate::xml::{self, Array, Section, Values};
use bulge_fibre::Response;
use std::path::Path;

/// Writes one shape; the file appears whole or not at all.
///
/// # Errors
/// The bulge can't be drawn (too few facets, a value that isn't finite, ...), the name doesn't end in `.vtp`,
/// its folder doesn't exist, or the disk refuses. The message names the path and the reason.
pub fn write_vtp(path: impl AsRef<Path>, bulge: &Bulge) -> Result<(), VtkError> {
    let path = path.as_ref();
    check_extension(path, "vtp")?;
    whole_file::write(path, &encoded(bulge)?)
}

/// The bytes of a `.vtp` file, for a pipe.
///
/// # Errors
/// The bulge can't be drawn.
pub fn vtp_bytes(bulge: &Bulge) -> Result<Vec<u8>, VtkError> {
    encoded(bulge)
}

fn encoded(bulge: &Bulge) -> Result<Vec<u8>, VtkError> {
    bulge.check()?;
    Ok(encode(Mesh::new(bulge), &bulge.shape.response))
}

/// The bytes of a file.
fn encode(mesh: Mesh, response: &Response) -> Vec<u8> {
    let counts = [
        ("NumberOfPoints", mesh.points.len()),
        ("NumberOfLines", mesh.fibres.len()),
        ("NumberOfPolys", mesh.quads.len()),
    ];
    let fields = |fields: Vec<(&'static str, Vec<f64>)>| {
        fields.into_iter().map(|(name, values)| Array::scalars(name, Values::Float64(values)))
    };
    let active = mesh.point_fields.first().map(|(name, _)| format!(" Scalars=\"{name}\""));
    let mut point = Section::new("PointData", fields(mesh.point_fields).collect());
    point.attributes = active.unwrap_or_default();
    let part = Array::scalars("part", Values::Int32(mesh.part));
    let cell = Section::new("CellData", std::iter::once(part).chain(fields(mesh.cell_fields)).collect());
    let mut sections = vec![point, cell, Section::points(mesh.points)];
    if !mesh.fibres.is_empty() {
        sections.push(Section::cells("Lines", mesh.fibres));
    }
    sections.push(Section::cells("Polys", mesh.quads));
    xml::bytes("PolyData", &xml::numbers(whole(response)), &counts, &sections)
}

#[cfg(test)]
#[path = "../tests/membrane/read.rs"]
mod read;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Style;
    use crate::analytic::barrel;
    use bulge_fibre::Shape;

    fn drawn(shape: &Shape, facets: u32, fibres: u32) -> String {
        let bulge = Bulge { shape, fibres, style: Style::Revolution, facets };
        bulge.check().unwrap();
        String::from_utf8(encode(Mesh::new(&bulge), &shape.response)).unwrap()
    }

    #[test]
    fn names_counts_arrays_and_field_data() {
        let xml = drawn(&barrel(20, 1.5), 24, 6);
        for part in [
            r#"NumberOfPoints="630""#,
            r#"NumberOfLines="6""#,
            r#"NumberOfPolys="480""#,
            r#"compressor="vtkZLibDataCompressor""#,
            r#"Scalars="membrane_force_N_per_m""#,
            r#"Name="pressure_Pa" NumberOfTuples="1" format="ascii">2e5<"#,
            r#"Name="force_N" NumberOfTuples="1" format="ascii">3.215e2<"#,
        ] {
            assert!(xml.contains(part), "{part}");
        }
    }

    #[test]
    fn the_points_and_faces_that_were_written_are_read_back() {
        let shape = barrel(20, 1.5);
        let bulge = Bulge { shape: &shape, fibres: 6, style: Style::Revolution, facets: 24 };
        let mesh = Mesh::new(&bulge);
        let xml = String::from_utf8(encode(mesh.clone(), &shape.response)).unwrap();
        let arrays = read::arrays(&xml);
        let of = |element: &str, name: &str| &arrays[&(element.to_owned(), name.to_owned())];
        assert_eq!(*of("Points", "Points"), mesh.points.into_iter().flatten().collect::<Vec<_>>());
        let corners = mesh.quads.iter().flatten().map(|corner| *corner as f64).collect::<Vec<_>>();
        assert_eq!(*of("Polys", "connectivity"), corners);
        assert_eq!(of("Polys", "offsets").len(), mesh.quads.len());
        assert_eq!(arrays.keys().filter(|(element, _)| element == "PointData").count(), 7);
    }

    #[test]
    fn leaves_nothing_behind_when_writing_fails() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        let occupied = folder.join("occupied.vtp");
        std::fs::create_dir(&occupied).unwrap();
        let shape = barrel(8, 0.0);
        let bulge = Bulge { shape: &shape, fibres: 4, style: Style::Revolution, facets: 8 };
        let message = |path: &Path| write_vtp(path, &bulge).unwrap_err().to_string();

        let missing = message(&folder.join("nowhere/shape.vtp"));
        assert!(missing.contains("nowhere") && missing.contains("no folder"), "{missing}");
        assert!(message(&occupied).contains("occupied.vtp"));
        assert!(message(&folder.join("shape.vtk")).contains("must end in .vtp"));
        assert_eq!(std::fs::read_dir(folder).unwrap().count(), 1, "only the folder that was there");
        assert_eq!(std::fs::read_dir(&occupied).unwrap().count(), 0);

        write_vtp(folder.join("shape.vtp"), &bulge).unwrap();
        write_vtp(folder.join("shape.vtp"), &bulge).unwrap();
        assert_eq!(std::fs::read_dir(folder).unwrap().count(), 2, "the file and no temporary one");
    }
}
