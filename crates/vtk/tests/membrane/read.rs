//! The numbers of VTK's XML files as the format defines them: Base64 of a header (number of blocks, size of a block,
//! size of a last, shorter one, compressed size of each) and of the blocks, each by zlib. VTK itself reads the files
//! in the last step of `.ci/run`.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use flate2::read::ZlibDecoder;
use roxmltree::{Document, Node};
use std::collections::HashMap;
use std::io::Read as _;

/// Numbers of the arrays by the element that they are in, such as `PointData`, and their name.
pub(crate) fn arrays(xml: &str) -> HashMap<(String, String), Vec<f64>> {
    let document = Document::parse(xml).unwrap();
    let root = document.root_element();
    assert_eq!(root.attribute("byte_order"), Some("LittleEndian"));
    assert_eq!(root.attribute("header_type"), Some("UInt64"));
    assert_eq!(root.attribute("compressor"), Some("vtkZLibDataCompressor"));
    let packed = document.descendants().filter(|node| node.attribute("format") == Some("binary"));
    let named = |array: Node| {
        let element = array.parent().unwrap().tag_name().name().to_owned();
        ((element, array.attribute("Name").unwrap().to_owned()), numbers(array))
    };
    packed.map(named).collect()
}

fn numbers(array: Node) -> Vec<f64> {
    let text = array.text().unwrap();
    let blocks = words(&text[..12])[0];
    let (header, data) = text.split_at((8 * (3 + blocks)).div_ceil(3) * 4);
    let sizes = words(header);
    let mut packed = &STANDARD.decode(data).unwrap()[..];
    let mut bytes = Vec::new();
    for (block, size) in sizes[3..].iter().enumerate() {
        let (own, rest) = packed.split_at(*size);
        packed = rest;
        let length = ZlibDecoder::new(own).read_to_end(&mut bytes).unwrap();
        let is_last_and_shorter = block + 1 == blocks && sizes[2] > 0;
        assert_eq!(length, if is_last_and_shorter { sizes[2] } else { sizes[1] });
    }
    assert!(packed.is_empty() && sizes.len() == 3 + blocks);
    let eight = || bytes.as_chunks::<8>().0.iter().copied();
    match array.attribute("type").unwrap() {
        "Float64" => eight().map(f64::from_le_bytes).collect(),
        "UInt64" => eight().map(|word| u64::from_le_bytes(word) as f64).collect(),
        "Int32" => bytes.as_chunks().0.iter().map(|word| f64::from(i32::from_le_bytes(*word))).collect(),
        "UInt8" => bytes.iter().map(|byte| f64::from(*byte)).collect(),
        other => panic!("numbers of the type {other}"),
    }
}

/// Whole words at the start of a text in Base64.
fn words(text: &str) -> Vec<usize> {
    let bytes = STANDARD.decode(text).unwrap();
    bytes.as_chunks().0.iter().map(|word| u64::from_le_bytes(*word).try_into().unwrap()).collect()
}
