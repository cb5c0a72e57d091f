//! What the pictures of lines share: paper with a title, panels, lines and a legend.

use crate::axis::Axis;
use crate::comparison::panel::Panel;
use crate::comparison::svg::{Anchor, Stroke, Style, Svg};
use crate::palette;

/// Pixels of a unit of the drawing, which stands alone: its letters are larger than those of a report.
const ZOOM: f64 = 1.25;
/// Height of the title.
const TOP: f64 = 40.0;

/// Lines of one panel, and the names of its axes.
pub(crate) struct Chart<'a> {
    pub(crate) names: [&'a str; 2],
    pub(crate) axes: [Axis; 2],
    pub(crate) lines: Vec<Vec<[f64; 2]>>,
}

/// Panels side by side under a title, with a legend of so many units at their right. The last line stands on top of it, as isobars lie; a load is drawn
/// over the lines of all panels, and its name stands below theirs. As an SVG document.
pub(crate) fn drawn(
    title: &str,
    (width, height): (f64, f64),
    (legend_width, names): (f64, &[(usize, &str)]),
    charts: &[Chart],
    load: &[[f64; 2]],
) -> String {
    let mut svg = Svg::new("lines", width, height).zoomed(ZOOM);
    svg.text((0.5 * width, 0.5 * TOP), title, Style::new(Anchor::Middle).size(17.0));
    let each = (width - legend_width) / charts.len() as f64;
    let load_line = Stroke::solid(palette::INK, 2.4);
    let mut count = 0;
    for (i, Chart { names, axes, lines }) in charts.iter().enumerate() {
        let left = i as f64 * each + 74.0;
        let panel = Panel {
            x: axes[0],
            y: axes[1],
            left,
            top: TOP + 8.0,
            width: each - 92.0,
            height: height - TOP - 60.0,
        };
        panel.draw(&mut svg, "", names[0], names[1]);
        let at = |points: &[[f64; 2]]| points.iter().map(|[x, y]| panel.at((*x, *y))).collect::<Vec<_>>();
        count = lines.len();
        for (i, points) in lines.iter().enumerate() {
            svg.polyline(&at(points), palette::line(i, count));
        }
        svg.polyline(&at(load), load_line);
        svg.dots(&at(load), 4.0, palette::INK, 1.0);
    }
    let rows = names.iter().map(|(i, name)| (palette::line(*i, count), *name));
    let load = (!load.is_empty()).then_some((load_line, "load"));
    for (row, (line, name)) in rows.chain(load).enumerate() {
        let (left, y) = (width - legend_width, TOP + 18.0 + 19.0 * row as f64);
        svg.polyline(&[(left, y), (left + 30.0, y)], line);
        svg.text((left + 37.0, y), name, Style::new(Anchor::Start).size(13.0));
    }
    svg.finish(title)
}

/// "2 bar", "0.125 bar": four digits, without trailing zeros.
pub(crate) fn bar(pressure_pa: f64) -> String {
    // Adding zero turns -0 into 0.
    let rounded = bulge_muscles::units::rounded(pressure_pa / 1e5, 4) + 0.0;
    if rounded == 0.0 || (1e-4..1e7).contains(&rounded.abs()) {
        format!("{rounded} bar")
    } else {
        format!("{rounded:e} bar")
    }
}
