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
    "api.js" => "page/api.js",
    "axis.js" => "page/axis.js",
    "bulge-panel.js" => "page/bulge-panel.js",
    "cells.js" => "page/cells.js",
    "column-map.js" => "page/column-map.js",
    "columns.js" => "page/columns.js",
    "connection.js" => "page/connection.js",
    "contents.js" => "page/contents.js",
    "data-panel.js" => "page/data-panel.js",
    "diagnosis-panel.js" => "page/diagnosis-panel.js",
    "dom.js" => "page/dom.js",
    "effect-card.js" => "page/effect-card.js",
    "effects-panel.js" => "page/effects-panel.js",
    "export-menu.js" => "page/export-menu.js",
    "footer.js" => "page/footer.js",
    "format.js" => "page/format.js",
    "gestures.js" => "page/gestures.js",
    "headline.js" => "page/headline.js",
    "icon.svg" => "page/icon.svg",
    "index.html" => "page/index.html",
    "ladder.js" => "page/ladder.js",
    "main.js" => "page/main.js",
    "muscle-panel.js" => "page/muscle-panel.js",
    "notices.js" => "page/notices.js",
    "numbers.js" => "page/numbers.js",
    "own-effect.js" => "page/own-effect.js",
    "palette.js" => "page/palette.js",
    "plan-panel.js" => "page/plan-panel.js",
    "plan-plane.js" => "page/plan-plane.js",
    "plot.js" => "page/plot.js",
    "plots.js" => "page/plots.js",
    "protocol.js" => "page/protocol.js",
    "save-plot.js" => "page/save-plot.js",
    "scene.js" => "page/scene.js",
    "selection.js" => "page/selection.js",
    "store.js" => "page/store.js",
    "style.css" => "page/style.css",
    "tabs.js" => "page/tabs.js",
    "theme.js" => "page/theme.js",
    "timings.js" => "page/timings.js",
    "toml.js" => "page/toml.js",
    "types.js" => "page/types.js",
    "verdict.js" => "page/verdict.js",
    "vendor/echarts.js" => "vendor/echarts.js",
    "vendor/three.js" => "vendor/three.js",
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

    /// The page must weigh less than 3 MB.
    #[test]
    fn the_page_is_light() {
        let bytes: usize = FILES.iter().map(|(_, bytes)| bytes.len()).sum();
        assert!((500_000..3_000_000).contains(&bytes), "{bytes}");
    }
}
