//! What every page and every plot keeps to.

#![expect(clippy::unwrap_used, clippy::panic, reason = "a page that can't be read fails its test")]

use bulge_report::comparison::Plot;
use roxmltree::{Document, Node, ParsingOptions};

/// The page as XML: it is written so that both kinds of parser read it.
pub(crate) fn parsed(html: &str) -> Document<'_> {
    let options = ParsingOptions { allow_dtd: true, ..ParsingOptions::default() };
    Document::parse_with_options(html, options).unwrap()
}

/// Words of a page, with single spaces.
pub(crate) fn words(html: &str) -> String {
    let document = parsed(html);
    let texts = document.descendants().filter(Node::is_text).filter_map(|node| node.text());
    texts.flat_map(str::split_whitespace).collect::<Vec<_>>().join(" ")
}

/// Nothing from outside, no script, every link to an id that is there once, a sentence at the beginning of each section, no number that is none.
pub(crate) fn check_page(sample: &str, html: &str) {
    assert!(html.starts_with("<!DOCTYPE html>") && html.len() < 3_000_000, "{sample}: {} bytes", html.len());
    let drawings = html.matches("<svg ").count();
    assert_eq!(html.matches("http").count(), drawings + 1, "{sample}: beyond `http-equiv` and namespaces");
    assert_eq!(html.matches("xmlns=\"http://www.w3.org/2000/svg\"").count(), drawings, "{sample}");
    assert!(html.contains("default-src 'none'; style-src 'unsafe-inline'; img-src data:"), "{sample}");
    let document = parsed(html);
    for node in document.descendants().filter(Node::is_element) {
        let name = node.tag_name().name();
        assert!(
            !["script", "link", "img", "iframe", "object", "use", "image"].contains(&name),
            "{sample}: {name}"
        );
        for attribute in node.attributes() {
            assert!(!attribute.name().starts_with("on") && attribute.name() != "src", "{sample}: {name}");
        }
    }
    let mut ids: Vec<&str> = document.descendants().filter_map(|n| n.attribute("id")).collect();
    let all = ids.len();
    ids.sort_unstable();
    ids.dedup();
    assert_eq!(ids.len(), all, "{sample}: an id occurs twice");
    for target in document.descendants().filter_map(|n| n.attribute("href")) {
        assert!(target.strip_prefix('#').is_some_and(|target| ids.contains(&target)), "{sample}: {target}");
    }
    for section in document.descendants().filter(|n| n.has_tag_name("section")) {
        let lead = section.descendants().find(|n| n.attribute("class") == Some("lead"));
        let lead = lead.unwrap_or_else(|| panic!("{sample}: {:?} has no sentence", section.attribute("id")));
        assert!(lead.text().unwrap().trim().ends_with('.'), "{sample}: {:?}", lead.text());
    }
    let text = words(html);
    for none in ["NaN", "nan", "inf", "Infinity", "null", "undefined"] {
        assert!(text.split(|c: char| !c.is_alphanumeric()).all(|word| word != none), "{sample}: `{none}`");
        assert!(!html.contains(&format!("\"{none}\"")), "{sample}: `{none}`");
    }
}

/// Well-formed, of some size, and all of it within its frame.
pub(crate) fn check_plots(sample: &str, plots: &[Plot]) {
    for plot in plots {
        let document = Document::parse(&plot.svg).unwrap_or_else(|e| panic!("{sample}, {}: {e}", plot.name));
        let size = |name| document.root_element().attribute(name).unwrap().parse::<f64>().unwrap();
        let [width, height] = ["width", "height"].map(size);
        assert!(width > 100.0 && height > 80.0, "{sample}, {}", plot.name);
        let within = |value: f64, most: f64| (-1.0..=most + 1.0).contains(&value);
        for node in document.descendants() {
            for (names, most) in [(["x", "x1", "x2", "width"], width), (["y", "y1", "y2", "height"], height)]
            {
                let values = names.iter().filter_map(|name| node.attribute(*name)?.parse().ok());
                assert!(values.into_iter().all(|v| within(v, most)), "{sample}, {}: {node:?}", plot.name);
            }
            for point in node.attribute("points").unwrap_or_default().split_whitespace() {
                let (x, y) = point.split_once(',').unwrap();
                let inside = within(x.parse().unwrap(), width) && within(y.parse().unwrap(), height);
                assert!(inside, "{sample}, {}: {point}", plot.name);
            }
        }
        assert!(!plot.title.is_empty() && plot.caption.ends_with('.'), "{sample}, {}", plot.name);
    }
}
