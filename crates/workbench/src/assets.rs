//! The files of the page, embedded; the files of its plots are in `bulge-report`.

use bulge_report::scripts;

/// The media type and the bytes of a file, by name.
pub(crate) fn asset(name: &str) -> Option<(&'static str, &'static [u8])> {
    all().find(|(known, _)| *known == name).map(|(known, bytes)| (kind(known), *bytes))
}

/// The files of the page, then those shared with reports.
fn all() -> impl Iterator<Item = &'static (&'static str, &'static [u8])> {
    FILES.iter().chain(scripts::FILES)
}

/// The media type of a file.
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
    "api.js" => "page/api.js",
    "bulge-panel.js" => "page/bulge-panel.js",
    "column-map.js" => "page/column-map.js",
    "columns.js" => "page/columns.js",
    "connection.js" => "page/connection.js",
    "data-panel.js" => "page/data-panel.js",
    "diagnosis-panel.js" => "page/diagnosis-panel.js",
    "effect-card.js" => "page/effect-card.js",
    "effects-panel.js" => "page/effects-panel.js",
    "exclusion.js" => "page/exclusion.js",
    "export-menu.js" => "page/export-menu.js",
    "footer.js" => "page/footer.js",
    "headline.js" => "page/headline.js",
    "icon.svg" => "page/icon.svg",
    "index.html" => "page/index.html",
    "ladder.js" => "page/ladder.js",
    "main.js" => "page/main.js",
    "muscle-panel.js" => "page/muscle-panel.js",
    "notices.js" => "page/notices.js",
    "numbers.js" => "page/numbers.js",
    "own-effect.js" => "page/own-effect.js",
    "plan-panel.js" => "page/plan-panel.js",
    "plan-plane.js" => "page/plan-plane.js",
    "protocol.js" => "page/protocol.js",
    "scene.js" => "page/scene.js",
    "store.js" => "page/store.js",
    "style.css" => "page/style.css",
    "tabs.js" => "page/tabs.js",
    "theme.js" => "page/theme.js",
    "timings.js" => "page/timings.js",
    "toml.js" => "page/toml.js",
    "types.js" => "page/types.js",
    "verdict.js" => "page/verdict.js",
    "vendor/three.js" => "page/vendor/three.js",
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;
    use std::fs;
    use std::path::Path;

    #[test]
    fn every_file_of_the_page_is_embedded() {
        let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("page");
        let of_page =
            |name: &String| ["html", "js", "css", "svg"].iter().any(|end| name.ends_with(&format!(".{end}")));
        let there =
            fs::read_dir(page).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let there: BTreeSet<String> = there.filter(of_page).collect();
        let embedded = FILES.iter().map(|(name, _)| (*name).to_owned()).filter(|name| !name.contains('/'));
        assert_eq!(there, embedded.collect());
    }

    #[test]
    fn no_name_is_there_twice() {
        let names: BTreeSet<&str> = all().map(|(name, _)| *name).collect();
        assert_eq!(names.len(), all().count());
    }

    /// The page must weigh less than 3 MB.
    #[test]
    fn the_page_is_light() {
        let bytes: usize = all().map(|(_, bytes)| bytes.len()).sum();
        assert!((500_000..3_000_000).contains(&bytes), "{bytes}");
    }
}
