//! A drawing as the bytes of a VTK XML unstructured grid.

use super::drawing::{Drawing, Shape};
use super::{MembranePicture, arrays, check};
use crate::xml::{self, Array, Section, Values};
use std::fmt::Write as _;

/// The bytes of a file.
pub(super) fn encode(drawing: Drawing, picture: &MembranePicture) -> Vec<u8> {
    let counts = [("NumberOfPoints", drawing.points.len()), ("NumberOfCells", drawing.cells.len())];
    let cell = Section::new("CellData", arrays::of_cells(&drawing, picture.fields));
    let types = drawing.cells.iter().map(|cell| cell_type(cell.shape)).collect();
    let mut cells = Section::cells("Cells", drawing.cells.iter().map(|cell| cell.nodes().iter().copied()));
    cells.arrays.push(Array::scalars("types", Values::UInt8(types)));
    let displacements: Vec<f64> = drawing.displacements.into_iter().flatten().collect();
    let point = Section {
        element: "PointData",
        attributes: " Vectors=\"displacement_m\"".to_owned(),
        arrays: vec![Array::vectors("displacement_m", displacements)],
    };
    let sections = [point, cell, Section::points(drawing.points), cells];
    xml::bytes("UnstructuredGrid", &field_data(picture), &counts, &sections)
}

fn field_data(picture: &MembranePicture) -> String {
    let mut xml = xml::numbers(check::numbers(picture.state, picture.time));
    let unstable = picture.state.unstable;
    // Writing to a String can't fail.
    let _ = write!(
        xml,
        r#"<DataArray type="Int64" Name="unstable" NumberOfTuples="1" format="ascii">{unstable}</DataArray>"#
    );
    let (names, _) = arrays::group_names(picture.fields);
    let _ =
        write!(xml, r#"<Array type="String" Name="groups" NumberOfTuples="{}" format="ascii">"#, names.len());
    for name in names {
        // Names are stored as character codes. A zero ends a name, so it can't be part of one.
        for byte in name.bytes().filter(|byte| *byte != 0) {
            let _ = write!(xml, "{byte} ");
        }
        xml.push_str("0 ");
    }
    xml + "</Array>"
}

/// VTK's number of a type of cell.
fn cell_type(shape: Shape) -> u8 {
    match shape {
        Shape::Vertex => 1,
        Shape::Line => 3,
        Shape::QuadraticLine => 21,
        Shape::Triangle => 5,
        Shape::QuadraticTriangle => 22,
        Shape::Quadrangle => 9,
    }
}
