//! A drawing as the bytes of a VTK XML unstructured grid.

use super::drawing::{Drawing, Shape};
use super::{MembranePicture, arrays, check};
use crate::xml;
use std::fmt::Write as _;
use vtkio::model::{Attribute, Attributes, CellType, Cells, DataSet, UnstructuredGridPiece, VertexNumbers};

/// The bytes of a file, or the reason why it can't be encoded.
pub(super) fn encode(drawing: Drawing, picture: &MembranePicture) -> Result<Vec<u8>, String> {
    let fields = field_data(picture);
    xml::bytes(DataSet::inline(piece(drawing, picture)), "UnstructuredGrid", &fields)
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

fn piece(drawing: Drawing, picture: &MembranePicture) -> UnstructuredGridPiece {
    let cell = arrays::of_cells(&drawing, picture.fields);
    let displacements: Vec<f64> = drawing.displacements.into_iter().flatten().collect();
    let (mut connectivity, mut offsets, mut types) = (Vec::new(), Vec::new(), Vec::new());
    for cell in &drawing.cells {
        connectivity.extend(cell.nodes().iter().map(|node| *node as u64));
        offsets.push(connectivity.len() as u64);
        types.push(cell_type(cell.shape));
    }
    UnstructuredGridPiece {
        points: drawing.points.into_iter().flatten().collect::<Vec<f64>>().into(),
        cells: Cells { cell_verts: VertexNumbers::XML { connectivity, offsets }, types },
        data: Attributes { point: vec![Attribute::vectors("displacement_m").with_data(displacements)], cell },
    }
}

fn cell_type(shape: Shape) -> CellType {
    match shape {
        Shape::Vertex => CellType::Vertex,
        Shape::Line => CellType::Line,
        Shape::QuadraticLine => CellType::QuadraticEdge,
        Shape::Triangle => CellType::Triangle,
        Shape::QuadraticTriangle => CellType::QuadraticTriangle,
        Shape::Quadrangle => CellType::Quad,
    }
}
