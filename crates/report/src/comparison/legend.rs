//! A legend as a row of marks with labels, wrapped at the edge of the drawing.

use crate::comparison::svg::{Anchor, Stroke, Style, Svg, TEXT, width};
use crate::palette::{INK, Rgb, SOFT_INK};

/// The mark before a label.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Mark {
    /// A line.
    Line(Stroke),
    /// A dot.
    Dot(Rgb),
    /// A diamond.
    Diamond(Rgb),
    /// A filled rectangle.
    Box(Rgb),
}

/// Entries of the readings, the base and, if there are effects, the last model: the curves of a comparison.
pub(crate) fn models(has_effects: bool) -> Vec<(Mark, String)> {
    let mut entries = vec![
        (Mark::Dot(SOFT_INK), "measured".to_owned()),
        (Mark::Line(Stroke::dashed(INK, 1.0)), "base alone".to_owned()),
    ];
    if has_effects {
        entries.push((Mark::Line(Stroke::solid(INK, 2.0)), "with all effects".to_owned()));
    }
    entries
}

/// Height of a row.
const ROW: f64 = 20.0;
/// Width of a mark and the gap to its label.
const MARK: f64 = 30.0;
const GAP: f64 = 18.0;

/// Positions of the entries relative to the origin, and the height of all rows.
fn places(entries: &[(Mark, String)], room: f64) -> (Vec<(f64, f64)>, f64) {
    let (mut x, mut y) = (0.0, 0.0);
    let mut places = Vec::with_capacity(entries.len());
    for (_, words) in entries {
        let wide = MARK + width(words, TEXT) + GAP;
        if x > 0.0 && x + wide > room {
            (x, y) = (0.0, y + ROW);
        }
        places.push((x, y));
        x += wide;
    }
    (places, if entries.is_empty() { 0.0 } else { y + ROW })
}

/// Height of the legend if its width is `room`.
pub(crate) fn height(entries: &[(Mark, String)], room: f64) -> f64 {
    places(entries, room).1
}

/// Draws the entries, starting at the upper left corner.
pub(crate) fn draw(svg: &mut Svg, (left, top): (f64, f64), room: f64, entries: &[(Mark, String)]) {
    for ((x, y), (mark, words)) in places(entries, room).0.into_iter().zip(entries) {
        let (x, y) = (left + x, top + y + 0.5 * ROW);
        match *mark {
            Mark::Line(stroke) => svg.line((x, y), (x + 24.0, y), stroke),
            Mark::Dot(colour) => svg.dots(&[(x + 17.0, y)], 3.0, colour, 1.0),
            Mark::Diamond(colour) => svg.diamond((x + 17.0, y), 5.0, colour),
            Mark::Box(colour) => svg.rect((x + 8.0, y - 5.0), (16.0, 10.0), colour),
        }
        svg.text((x + MARK, y), words, Style::new(Anchor::Start));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_that_do_not_fit_go_to_the_next_row() {
        let entry = || (Mark::Dot(INK), "measured".to_owned());
        for (count, room, rows) in [(2, 900.0, 1.0), (2, 150.0, 2.0), (1, 10.0, 1.0), (0, 10.0, 0.0)] {
            let entries: Vec<_> = (0..count).map(|_| entry()).collect();
            assert!((height(&entries, room) - rows * ROW).abs() < 1e-9, "{count} in {room}");
        }
    }
}
