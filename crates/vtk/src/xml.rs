//! Data sets as the bytes of VTK XML files, with the field data that vtkio doesn't write.

use std::fmt::Write as _;
use vtkio::model::{ByteOrder, DataSet, Version, Vtk};
use vtkio::xml::Compressor;

/// Level of compression: the third is some 5 % larger than the sixth, the usual one, in a third of its time.
const LEVEL: u32 = 3;

/// The bytes of a file of one data set, with `fields` in its element.
pub(crate) fn bytes(data: DataSet, element: &str, fields: &str) -> Result<Vec<u8>, String> {
    let vtk = Vtk {
        version: Version::new_xml(1, 0),
        title: String::new(),
        byte_order: ByteOrder::LittleEndian,
        data,
        file_path: None,
    };
    let file = vtk.try_into_xml_format(Compressor::ZLib, LEVEL).map_err(|e| e.to_string())?;
    // Into memory: the writer of vtkio doesn't notice a disk that is full.
    let mut body = Vec::new();
    file.write(&mut body).map_err(|e| e.to_string())?;
    let body = String::from_utf8(body).map_err(|e| e.to_string())?;
    let (head, tail) = body.split_once(&format!("<{element}>")).ok_or(format!("no {element} element"))?;
    Ok(format!("<?xml version=\"1.0\"?>\n{head}<{element}><FieldData>{fields}</FieldData>{tail}\n")
        .into_bytes())
}

/// Field data of one number each.
pub(crate) fn numbers(values: impl IntoIterator<Item = (&'static str, f64)>) -> String {
    let mut xml = String::new();
    for (name, value) in values {
        // Writing to a String can't fail.
        let _ = write!(
            xml,
            r#"<DataArray type="Float64" Name="{name}" NumberOfTuples="1" format="ascii">{value:e}</DataArray>"#
        );
    }
    xml
}
