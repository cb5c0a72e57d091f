//! The XML of a VTK file and its appended data, which may contain bytes that aren't valid in XML.

use super::super::MeshError;
use super::super::msh::{find, quoted};
use std::borrow::Cow;

const BEGIN: &[u8] = b"<AppendedData";
const END: &[u8] = b"</AppendedData>";

/// Remedy for a truncated file.
pub(super) const CUT: &str =
    "the file is cut or damaged: copy it again, or save it again with the program that wrote it";

/// Most attributes of an element, and most declarations of namespaces in a file. The parser compares each with
/// all before it; elements of VTK have about ten attributes, and its files no namespaces.
const MOST_ATTRIBUTES: usize = 100;

/// The two parts of a file.
pub(super) struct Parts<'a> {
    /// Everything except the appended data.
    pub(super) xml: Cow<'a, str>,
    /// The bytes after the underscore of the appended data.
    pub(super) appended: &'a [u8],
}

/// Separates the appended data from a file.
pub(super) fn parts<'a>(bytes: &'a [u8], origin: &str) -> Result<Parts<'a>, MeshError> {
    let error = |what: String, instead: &str| MeshError {
        file: origin.to_owned(),
        what,
        instead: instead.to_owned(),
    };
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let start = bytes.trim_ascii_start();
    if start.starts_with(b"# vtk DataFile") {
        let instead = "open it with ParaView and save it as an unstructured grid of the XML kind (.vtu)";
        return Err(error("the file is of the legacy kind of VTK".to_owned(), instead));
    }
    if !start.starts_with(b"<") {
        let what = format!("the file begins with `{}`, not as XML does", quoted(start));
        return Err(error(what, "give an unstructured grid of VTK (.vtu)"));
    }
    let text = |bytes: &'a [u8]| {
        std::str::from_utf8(bytes).map_err(|bad| {
            let before = bytes.get(..bad.valid_up_to()).unwrap_or_default();
            let line = before.split(|byte| *byte == b'\n').count();
            let what = "the XML isn't UTF-8".to_owned();
            MeshError { file: format!("{origin}:{line}"), what, instead: CUT.to_owned() }
        })
    };
    let Some(begin) = find(bytes, BEGIN) else {
        return Ok(Parts { xml: Cow::Borrowed(text(bytes)?), appended: &[] });
    };
    let cut = || error("the file ends inside the appended data".to_owned(), CUT);
    let inside = begin + bytes.get(begin..).and_then(|tag| find(tag, b">")).ok_or_else(cut)? + 1;
    let (head, rest) = bytes.split_at_checked(inside).ok_or_else(cut)?;
    if head.ends_with(b"/>") {
        return Ok(Parts { xml: Cow::Borrowed(text(bytes)?), appended: &[] });
    }
    // Take the last one, because raw data may contain anything.
    let end = rest.windows(END.len()).rposition(|window| window == END).ok_or_else(cut)?;
    let (data, tail) = rest.split_at_checked(end).ok_or_else(cut)?;
    let Some(appended) = data.trim_ascii_start().strip_prefix(b"_") else {
        return Err(error("the appended data don't begin with an underscore".to_owned(), CUT));
    };
    Ok(Parts { xml: Cow::Owned(text(head)?.to_owned() + text(tail)?), appended })
}

/// Rejects what the parser would take a time for that grows with the square of the file.
pub(super) fn check(xml: &str, origin: &str) -> Result<(), MeshError> {
    let refused = |at: usize, what: &str| {
        let line = xml.bytes().take(at).filter(|byte| *byte == b'\n').count() + 1;
        Err(MeshError {
            file: format!("{origin}:{line}"),
            what: format!("{what}: at most {MOST_ATTRIBUTES} are read"),
            instead: "give an unstructured grid of VTK (.vtu), as ParaView and meshio write it".to_owned(),
        })
    };
    if let Some((at, _)) = xml.match_indices("xmlns").nth(MOST_ATTRIBUTES) {
        return refused(at, "the file declares too many namespaces");
    }
    match crowded(xml) {
        Some(at) => refused(at, "an element has too many attributes"),
        None => Ok(()),
    }
}

/// The first element with too many attributes. Its begin is sure, because no attribute may have a `<` in it: what
/// a comment holds may be taken for an element, but no element for a comment.
fn crowded(xml: &str) -> Option<usize> {
    let bytes = xml.as_bytes();
    let (mut element, mut quote, mut attributes) = (None, None, 0);
    for (at, byte) in bytes.iter().enumerate() {
        match (byte, quote) {
            (b'<', _) => {
                let is_element = !matches!(bytes.get(at + 1), Some(b'!' | b'?'));
                (element, quote, attributes) = (is_element.then_some(at), None, 0);
            }
            (byte, Some(open)) => quote = Some(open).filter(|open| open != byte),
            (b'>', None) => element = None,
            (b'"' | b'\'', None) if element.is_some() => quote = Some(*byte),
            (b'=', None) if element.is_some() => {
                attributes += 1;
                if attributes > MOST_ATTRIBUTES {
                    return element;
                }
            }
            _ => {}
        }
    }
    None
}
