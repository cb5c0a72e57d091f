//! The plots of rows for a browser, embedded: scripts and their style, one copy for the page of the workbench
//! and for reports.

/// Files that a page can be served, by name: scripts of the plots as modules that import each other, their
/// style, and ECharts.
pub const FILES: &[(&str, &[u8])] = &[
    ("axis.js", include_bytes!("../scripts/axis.js")),
    ("cells.js", include_bytes!("../scripts/cells.js")),
    ("contents.js", include_bytes!("../scripts/contents.js")),
    ("dom.js", include_bytes!("../scripts/dom.js")),
    ("format.js", include_bytes!("../scripts/format.js")),
    ("gestures.js", include_bytes!("../scripts/gestures.js")),
    ("palette.js", include_bytes!("../scripts/palette.js")),
    ("plot.js", include_bytes!("../scripts/plot.js")),
    ("plots.css", STYLE.as_bytes()),
    ("plots.js", include_bytes!("../scripts/plots.js")),
    ("rows.js", include_bytes!("../scripts/rows.js")),
    ("save-plot.js", include_bytes!("../scripts/save-plot.js")),
    ("selection.js", include_bytes!("../scripts/selection.js")),
    ("topics.js", include_bytes!("../scripts/topics.js")),
    ("vendor/echarts.js", include_bytes!("../scripts/vendor/echarts.js")),
];

/// Palette, controls and plots.
pub(crate) const STYLE: &str = include_str!("../scripts/plots.css");

/// All scripts as one, which starts by itself in a report: modules within one file can't import each other.
/// `vendor/build.mjs` creates it.
pub(crate) const BUNDLE: &str = include_str!("../scripts/report/bundle.js");

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;
    use std::fs;
    use std::path::Path;

    #[test]
    fn every_script_is_embedded() {
        let scripts = Path::new(env!("CARGO_MANIFEST_DIR")).join("scripts");
        let there =
            fs::read_dir(scripts).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let there: BTreeSet<String> = there.filter(|name| name.contains('.')).collect();
        let embedded = FILES.iter().map(|(name, _)| (*name).to_owned()).filter(|name| !name.contains('/'));
        assert_eq!(there, embedded.collect());
    }

    /// The bundle must contain nothing that ends its element, or that the page would change.
    #[test]
    fn the_bundle_can_stand_in_a_page() {
        let lower = BUNDLE.to_lowercase();
        assert!(!lower.contains("</script") && !lower.contains("<!--"));
        let control = |c: char| c.is_control() && c != '\n' || matches!(c, '\u{FFFE}' | '\u{FFFF}');
        assert!(!BUNDLE.contains(control));
    }
}
