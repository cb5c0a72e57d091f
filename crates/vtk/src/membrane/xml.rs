//! A drawing as the bytes of a VTK XML unstructured grid.

use super::drawing::{Drawing, Shape};
use super::{MembranePicture, arrays, check};
use std::fmt::Write as _;
use vtkio::model::{
    Attribute, Attributes, ByteOrder, CellType, Cells, DataSet, UnstructuredGridPiece, Version,
    VertexNumbers, Vtk,
};
use vtkio::xml::Compressor;

/// The bytes of a file, or the reason why it can't be encoded.
pub(super) fn encode(drawing: Drawing, picture: &MembranePicture) -> Result<Vec<u8>, String> {
    let vtk = Vtk {
        version: Version::new_xml(1, 0),
        title: String::new(),
        byte_order: ByteOrder::LittleEndian,
        data: DataSet::inline(piece(drawing, picture)),
        file_path: None,
    };
    let file = vtk.try_into_xml_format(Compressor::ZLib, 6).map_err(|e| e.to_string())?;
    // Written to memory first: vtkio doesn't notice a full disk.
    let mut body = Vec::new();
    file.write(&mut body).map_err(|e| e.to_string())?;
    let body = String::from_utf8(body).map_err(|e| e.to_string())?;
    let (head, tail) = body.split_once("<UnstructuredGrid>").ok_or("no UnstructuredGrid element")?;
    let fields = field_data(picture);
    Ok(format!("<?xml version=\"1.0\"?>\n{head}<UnstructuredGrid>{fields}{tail}\n").into_bytes())
}

/// Field data, which vtkio can't write.
fn field_data(picture: &MembranePicture) -> String {
    let mut xml = String::from("<FieldData>");
    // Writing to a String can't fail.
    for (name, value) in check::numbers(picture.state, picture.time) {
        let _ = write!(
            xml,
            r#"<DataArray type="Float64" Name="{name}" NumberOfTuples="1" format="ascii">{value:e}</DataArray>"#
        );
    }
    let unstable = picture.state.unstable;
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
    xml + "</Array></FieldData>"
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
