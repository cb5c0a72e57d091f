//! VTK XML files: arrays in Base64, compressed in blocks.
//!
//! Format: VTK File Formats, "XML file formats", docs.vtk.org. An array is the Base64 of its header (number of
//! blocks, size of a block, size of a last, shorter one or 0, compressed size of each) and that of its blocks.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use rayon::prelude::*;
use std::fmt::Write as _;
use std::io::Write as _;

/// Bytes of a block before it is compressed. Readers that want a part of an array unpack its blocks alone.
const BLOCK: usize = 1 << 17;
/// Level of compression: beyond it numbers get hardly smaller.
const LEVEL: u32 = 4;

/// Numbers of an array.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Values {
    Float64(Vec<f64>),
    Int32(Vec<i32>),
    UInt64(Vec<u64>),
    UInt8(Vec<u8>),
}

impl Values {
    /// VTK's name of the type, and the bytes in little-endian order.
    fn bytes(&self) -> (&'static str, Vec<u8>) {
        match self {
            Self::Float64(values) => ("Float64", values.iter().flat_map(|x| x.to_le_bytes()).collect()),
            Self::Int32(values) => ("Int32", values.iter().flat_map(|x| x.to_le_bytes()).collect()),
            Self::UInt64(values) => ("UInt64", values.iter().flat_map(|x| x.to_le_bytes()).collect()),
            Self::UInt8(values) => ("UInt8", values.clone()),
        }
    }
}

/// A named array.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Array {
    pub(crate) name: String,
    /// Numbers of a point or cell.
    pub(crate) components: usize,
    pub(crate) values: Values,
}

impl Array {
    /// An array with one number of each point or cell.
    pub(crate) fn scalars(name: impl Into<String>, values: Values) -> Self {
        Self { name: name.into(), components: 1, values }
    }

    /// An array with three numbers of each.
    pub(crate) fn vectors(name: impl Into<String>, values: Vec<f64>) -> Self {
        Self { name: name.into(), components: 3, values: Values::Float64(values) }
    }

    /// The array as an element.
    fn element(&self) -> String {
        let (kind, bytes) = self.values.bytes();
        let components = if self.components == 1 {
            String::new()
        } else {
            format!(r#" NumberOfComponents="{}""#, self.components)
        };
        let blocks: Vec<Vec<u8>> = bytes.par_chunks(BLOCK).map(compressed).collect();
        let numbers = [blocks.len(), BLOCK, bytes.len() % BLOCK];
        let sizes = blocks.iter().map(Vec::len);
        let header: Vec<u8> =
            numbers.into_iter().chain(sizes).flat_map(|number| (number as u64).to_le_bytes()).collect();
        let [header, data] = [header, blocks.concat()].map(|bytes| STANDARD.encode(bytes));
        let name = &self.name;
        format!(
            r#"<DataArray type="{kind}" Name="{name}"{components} format="binary">{header}{data}</DataArray>"#
        )
    }
}

fn compressed(block: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::new(LEVEL));
    // Writing to memory can't fail.
    let _ = encoder.write_all(block);
    encoder.finish().unwrap_or_default()
}

/// Arrays under one element, such as `PointData`. Its attributes name the active ones.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Section {
    pub(crate) element: &'static str,
    pub(crate) attributes: String,
    pub(crate) arrays: Vec<Array>,
}

impl Section {
    pub(crate) fn new(element: &'static str, arrays: Vec<Array>) -> Self {
        Self { element, attributes: String::new(), arrays }
    }

    /// The points of a data set.
    pub(crate) fn points(points: impl IntoIterator<Item = [f64; 3]>) -> Self {
        let points = points.into_iter().flatten().collect();
        Self::new("Points", vec![Array::vectors("Points", points)])
    }

    /// Cells by the indices of their points.
    pub(crate) fn cells<C: IntoIterator<Item = usize>>(
        element: &'static str,
        cells: impl IntoIterator<Item = C>,
    ) -> Self {
        let (mut connectivity, mut offsets) = (Vec::new(), Vec::new());
        for cell in cells {
            connectivity.extend(cell.into_iter().map(|vertex| vertex as u64));
            offsets.push(connectivity.len() as u64);
        }
        let array = |name: &str, values| Array::scalars(name, Values::UInt64(values));
        Self::new(element, vec![array("connectivity", connectivity), array("offsets", offsets)])
    }
}

/// The bytes of a file of one data set. `kind` is its element, `counts` are the attributes of its piece.
pub(crate) fn bytes(kind: &str, fields: &str, counts: &[(&str, usize)], sections: &[Section]) -> Vec<u8> {
    let all: Vec<&Array> = sections.iter().flat_map(|section| &section.arrays).collect();
    let mut elements = all.into_par_iter().map(Array::element).collect::<Vec<_>>().into_iter();
    let mut xml = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"{kind}\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\" \
         compressor=\"vtkZLibDataCompressor\"><{kind}><FieldData>{fields}</FieldData><Piece"
    );
    // Writing to a String can't fail.
    for (name, count) in counts {
        let _ = write!(xml, " {name}=\"{count}\"");
    }
    xml.push('>');
    for Section { element, attributes, arrays } in sections {
        let _ = write!(xml, "<{element}{attributes}>");
        xml.extend(elements.by_ref().take(arrays.len()));
        let _ = write!(xml, "</{element}>");
    }
    let _ = writeln!(xml, "</Piece></{kind}></VTKFile>");
    xml.into_bytes()
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
