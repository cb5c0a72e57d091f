//! A drawing as an SVG document: text remains text, lengths are in CSS pixels, and the same calls give the
//! same bytes.
//!
//! Marks of a kind share one element, and figures are tabular: a report holds thousands of marks and is read on paper.

use std::fmt::{self, Write};

use crate::palette::{INK, Rgb, hex};

/// Fonts that every system has in some form, with figures of equal width.
const FONTS: &str = "system-ui, -apple-system, 'Segoe UI', Roboto, 'Helvetica Neue', Arial, sans-serif";

/// Size of normal text.
pub(crate) const TEXT: f64 = 12.0;

/// Size of normal text with the width of a heading: bold letters are wider.
pub(crate) const BOLD: f64 = 1.12 * TEXT;

/// A drawing in progress.
pub(crate) struct Svg {
    name: &'static str,
    width: f64,
    height: f64,
    zoom: f64,
    body: String,
    hatched: bool,
}

/// Position of a text relative to its point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Anchor {
    /// The text begins at the point.
    Start,
    /// The text is centred at the point.
    Middle,
    /// The text ends at the point.
    End,
}

/// Appearance of a text.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Style {
    /// Position relative to its point.
    pub(crate) anchor: Anchor,
    /// Height of the font.
    pub(crate) size: f64,
    /// Colour.
    pub(crate) colour: Rgb,
    /// Whether it is a heading.
    pub(crate) bold: bool,
}

impl Style {
    /// Normal text.
    pub(crate) const fn new(anchor: Anchor) -> Self {
        Self { anchor, size: TEXT, colour: INK, bold: false }
    }

    /// The same style as a heading.
    pub(crate) const fn bold(self) -> Self {
        Self { bold: true, ..self }
    }

    /// The same in another colour.
    pub(crate) const fn colour(self, colour: Rgb) -> Self {
        Self { colour, ..self }
    }

    /// The same style in another size.
    pub(crate) const fn size(self, size: f64) -> Self {
        Self { size, ..self }
    }
}

/// Appearance of a line.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stroke {
    /// Colour.
    pub(crate) colour: Rgb,
    /// Width.
    pub(crate) width: f64,
    /// Lengths of dashes and gaps; `None` for a solid line.
    pub(crate) dashes: Option<&'static str>,
}

impl Stroke {
    /// A solid line.
    pub(crate) const fn solid(colour: Rgb, width: f64) -> Self {
        Self { colour, width, dashes: None }
    }

    /// A dashed line.
    pub(crate) const fn dashed(colour: Rgb, width: f64) -> Self {
        Self { colour, width, dashes: Some("5 3") }
    }

    fn attributes(self) -> String {
        let dashes = self.dashes.map(|d| format!(r#" stroke-dasharray="{d}""#)).unwrap_or_default();
        format!(r#"stroke="{}" stroke-width="{}"{dashes}"#, hex(self.colour), short(self.width))
    }
}

impl Svg {
    /// An empty drawing. `name` makes its ids unique among several drawings on one page.
    pub(crate) fn new(name: &'static str, width: f64, height: f64) -> Self {
        Self { name, width, height, zoom: 1.0, body: String::new(), hatched: false }
    }

    /// The same, shown so many times as large.
    pub(crate) fn zoomed(self, zoom: f64) -> Self {
        Self { zoom, ..self }
    }

    /// Adds markup.
    fn put(&mut self, markup: fmt::Arguments<'_>) {
        // Writing to a `String` can't fail.
        let _ = self.body.write_fmt(markup);
    }

    /// Adds a text whose middle line is at `y`.
    pub(crate) fn text(&mut self, (x, y): (f64, f64), words: &str, style: Style) {
        self.words(words, style, &format!(r#"x="{}" y="{}""#, short(x), short(y)));
    }

    /// Adds a text that reads upwards, centred at the point.
    pub(crate) fn text_upwards(&mut self, (x, y): (f64, f64), words: &str, style: Style) {
        let (x, y) = (short(x), short(y));
        self.words(words, style, &format!(r#"x="{x}" y="{y}" transform="rotate(-90 {x} {y})""#));
    }

    fn words(&mut self, words: &str, style: Style, place: &str) {
        let anchor = match style.anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let weight = if style.bold { r#" font-weight="600""# } else { "" };
        self.put(format_args!(
            "<text {place} dy=\".35em\" text-anchor=\"{anchor}\" font-size=\"{}\" fill=\"{}\"{weight}>{}</text>\n",
            short(style.size),
            hex(style.colour),
            escape(words)
        ));
    }

    /// Adds a straight line.
    pub(crate) fn line(&mut self, (x1, y1): (f64, f64), (x2, y2): (f64, f64), stroke: Stroke) {
        self.put(format_args!(
            "<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\" {}/>\n",
            short(x1),
            short(y1),
            short(x2),
            short(y2),
            stroke.attributes()
        ));
    }

    /// Adds a line through points.
    pub(crate) fn polyline(&mut self, points: &[(f64, f64)], stroke: Stroke) {
        if points.len() < 2 {
            return;
        }
        self.put(format_args!(
            "<polyline points=\"{}\" fill=\"none\" stroke-linejoin=\"round\" {}/>\n",
            listed(points),
            stroke.attributes()
        ));
    }

    /// A filled area.
    pub(crate) fn polygon(&mut self, points: &[(f64, f64)], fill: Rgb) {
        if points.len() >= 3 {
            self.put(format_args!("<polygon points=\"{}\" fill=\"{}\"/>\n", listed(points), hex(fill)));
        }
    }

    /// A filled area through which one sees what lies below.
    pub(crate) fn veil(&mut self, points: &[(f64, f64)], fill: Rgb, opacity: f64) {
        if points.len() >= 3 {
            self.put(format_args!(
                "<polygon points=\"{}\" fill=\"{}\" fill-opacity=\"{}\"/>\n",
                listed(points),
                hex(fill),
                short(opacity)
            ));
        }
    }

    /// A filled rectangle; a negative size extends to the other side.
    pub(crate) fn rect(&mut self, corner: (f64, f64), size: (f64, f64), fill: Rgb) {
        self.rectangle(corner, size, &hex(fill));
    }

    /// Adds a hatched rectangle.
    pub(crate) fn hatch(&mut self, corner: (f64, f64), size: (f64, f64)) {
        self.hatched = true;
        let fill = format!("url(#{}-hatch)", self.name);
        self.rectangle(corner, size, &fill);
    }

    fn rectangle(&mut self, (x, y): (f64, f64), (width, height): (f64, f64), fill: &str) {
        self.put(format_args!(
            "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"{fill}\"/>\n",
            short(x.min(x + width)),
            short(y.min(y + height)),
            short(width.abs()),
            short(height.abs())
        ));
    }

    /// Round dots, all in one element: lines of no length with round caps.
    pub(crate) fn dots(&mut self, points: &[(f64, f64)], radius: f64, colour: Rgb, opacity: f64) {
        if points.is_empty() {
            return;
        }
        let places: Vec<String> =
            points.iter().map(|(x, y)| format!("M{} {}h0", short(*x), short(*y))).collect();
        let path = places.concat();
        self.put(format_args!(
            "<path d=\"{path}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" stroke-linecap=\"round\" stroke-opacity=\"{}\"/>\n",
            hex(colour),
            short(2.0 * radius),
            short(opacity)
        ));
    }

    /// A diamond with a light edge, which stands out on bars.
    pub(crate) fn diamond(&mut self, (x, y): (f64, f64), radius: f64, colour: Rgb) {
        let points = [(x - radius, y), (x, y - radius), (x + radius, y), (x, y + radius)];
        self.put(format_args!(
            "<polygon points=\"{}\" fill=\"{}\" stroke=\"#FFFFFF\" stroke-width=\"1\"/>\n",
            listed(&points),
            hex(colour)
        ));
    }

    /// The document.
    pub(crate) fn finish(self, title: &str) -> String {
        let Self { name, width, height, zoom, body, hatched } = self;
        let [across, down, width, height] = [zoom * width, zoom * height, width, height].map(short);
        let hatch = if hatched {
            format!(
                "<defs><pattern id=\"{name}-hatch\" width=\"6\" height=\"6\" patternUnits=\"userSpaceOnUse\">\
                 <rect width=\"6\" height=\"6\" fill=\"#FAFAFA\"/>\
                 <path d=\"M0 6L6 0\" stroke=\"#D5D5D5\" stroke-width=\"1\"/></pattern></defs>\n"
            )
        } else {
            String::new()
        };
        let title = escape(title);
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{across}\" height=\"{down}\" viewBox=\"0 0 {width} {height}\" \
             role=\"img\" aria-label=\"{title}\" font-family=\"{FONTS}\" style=\"font-variant-numeric:tabular-nums\">\n\
             <rect width=\"100%\" height=\"100%\" fill=\"#FFFFFF\"/>\n{hatch}{body}</svg>\n"
        )
    }
}

/// A coordinate rounded to a tenth of a pixel, an opacity or width to a hundredth.
fn short(value: f64) -> String {
    let text = if value.abs() < 3.0 { format!("{value:.2}") } else { format!("{value:.1}") };
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

fn listed(points: &[(f64, f64)]) -> String {
    points.iter().map(|(x, y)| format!("{},{}", short(*x), short(*y))).collect::<Vec<_>>().join(" ")
}

/// Text as XML, in which control characters aren't allowed.
fn escape(words: &str) -> String {
    let mut text = String::with_capacity(words.len());
    for letter in words.chars() {
        match letter {
            '&' => text += "&amp;",
            '<' => text += "&lt;",
            '>' => text += "&gt;",
            '"' => text += "&quot;",
            '\'' => text += "&#39;",
            c if c.is_control() || matches!(c, '\u{FFFE}' | '\u{FFFF}') => text.push(' '),
            c => text.push(c),
        }
    }
    text
}

/// Approximate width of a text, estimated for the widest of the usual fonts.
pub(crate) fn width(words: &str, size: f64) -> f64 {
    let letter = |c: char| match c {
        'i' | 'j' | 'l' | '.' | ',' | ':' | ';' | '|' | '\'' | '!' | ' ' | 'I' => 0.36,
        'f' | 't' | 'r' | '(' | ')' | '[' | ']' | '-' | '/' => 0.42,
        'm' | 'w' | 'M' | 'W' | '%' | '@' => 0.98,
        c if c.is_ascii_uppercase() => 0.72,
        c if c.is_ascii() => 0.62,
        c if u32::from(c) < 0x2E80 => 0.78,
        _ => 1.05,
    };
    size * words.chars().map(letter).sum::<f64>()
}

/// The text, shortened at the end with an ellipsis if it doesn't fit into `room`.
pub(crate) fn fitted(words: &str, size: f64, room: f64) -> String {
    if width(words, size) <= room {
        return words.to_owned();
    }
    let mut kept = String::new();
    for letter in words.chars() {
        if width(&kept, size) + width(&letter.to_string(), size) + size > room {
            break;
        }
        kept.push(letter);
    }
    format!("{}…", kept.trim_end())
}

/// The name, shortened in the middle with an ellipsis if it doesn't fit: names of a series differ at the end.
pub(crate) fn name_fitted(name: &str, size: f64, room: f64) -> String {
    if width(name, size) <= room {
        return name.to_owned();
    }
    let letters: Vec<char> = name.chars().collect();
    let cut = |kept: usize| -> String {
        let tail = kept / 2;
        let (head, tail) = (&letters[..kept - tail], &letters[letters.len() - tail..]);
        let (head, tail) = (head.iter().collect::<String>(), tail.iter().collect::<String>());
        format!("{}…{}", head.trim_end(), tail.trim_start())
    };
    let kept = (0..letters.len()).rev().find(|kept| width(&cut(*kept), size) <= room).unwrap_or(0);
    cut(kept)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_are_short() {
        assert_eq!(
            [0.0, -0.001, 12.0, 12.34, 0.354, -0.5].map(short),
            ["0", "0", "12", "12.3", "0.35", "-0.5"]
        );
    }

    #[test]
    fn any_text_is_well_formed() {
        let mut svg = Svg::new("a", 10.0, 10.0);
        svg.text((1.0, 2.0), "<a & 'b'> \"c\" \u{7}", Style::new(Anchor::Start));
        svg.hatch((0.0, 0.0), (3.0, 3.0));
        let svg = svg.finish("\"<&>\u{0}");
        let tree = roxmltree::Document::parse(&svg).unwrap();
        assert!(tree.descendants().any(|n| n.text() == Some("<a & 'b'> \"c\"  ")));
        assert_eq!(tree.root_element().attribute("aria-label"), Some("\"<&> "));
    }

    #[test]
    fn long_words_end_in_an_ellipsis_within_the_room() {
        assert_eq!(fitted("friction", 12.0, 100.0), "friction");
        let cut = fitted(&"friction ".repeat(20), 12.0, 100.0);
        assert!(cut.ends_with('…') && width(&cut, 12.0) <= 100.0, "{cut}");
    }

    #[test]
    fn names_of_a_series_stay_apart() {
        let cut = |i: usize| name_fitted(&format!("a muscle of the spring series, number {i}"), 12.0, 120.0);
        assert!(
            cut(1).starts_with("a musc") && cut(1).ends_with("er 1") && width(&cut(1), 12.0) <= 120.0,
            "{}",
            cut(1)
        );
        assert_ne!(cut(1), cut(2));
        assert_eq!(name_fitted("abc", 12.0, 1.0), "…");
    }

    #[test]
    fn rectangles_of_negative_size_are_turned() {
        let mut svg = Svg::new("a", 10.0, 10.0);
        svg.rect((5.0, 5.0), (-2.0, -3.0), INK);
        assert!(svg.finish("a").contains(r#"x="3" y="2" width="2" height="3""#));
    }
}
