//! The files of the page, embedded.

/// A file by its name: its kind and its bytes.
pub(crate) fn asset(name: &str) -> Option<(&'static str, &'static [u8])> {
    FILES.iter().find(|(known, _)| *known == name).map(|(known, bytes)| (kind(known), *bytes))
}

/// What a browser is told that a file is.
fn kind(name: &str) -> &'static str {
    match name.rsplit('.').next() {
        Some("html") => "text/html; charset=utf-8",
        Some("js") => "text/javascript; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("svg") => "image/svg+xml",
        _ => "text/plain; charset=utf-8",
    }
}

macro_rules! files {
    ($($name:literal => $path:literal),* $(,)?) => {
        const FILES: &[(&str, &[u8])] = &[$(($name, include_bytes!(concat!("../", $path)))),*];
    };
}

files! {
    "index.html" => "page/index.html",
}
