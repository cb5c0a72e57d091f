//! A panel of a plot: two axes with grid, ticks and names, and the map from values to positions.

use crate::axis::Axis;
use crate::comparison::svg::{Anchor, Stroke, Style, Svg, TEXT, width};
use crate::palette::{GRID, INK, SOFT_INK};

/// Space left of a panel for tick labels and the name of its axis.
pub(crate) const LEFT: f64 = 64.0;
/// Space below a panel.
pub(crate) const BELOW: f64 = 46.0;

/// A panel: axes and the rectangle that they span.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Panel {
    /// Horizontal axis.
    pub(crate) x: Axis,
    /// Vertical axis.
    pub(crate) y: Axis,
    /// Left edge.
    pub(crate) left: f64,
    /// Upper edge.
    pub(crate) top: f64,
    /// Width without the labels.
    pub(crate) width: f64,
    /// Height without the labels.
    pub(crate) height: f64,
}

impl Panel {
    /// Horizontal position of a value.
    pub(crate) fn across(&self, value: f64) -> f64 {
        self.left + self.width * self.x.share(value)
    }

    /// Vertical position of a value.
    pub(crate) fn up(&self, value: f64) -> f64 {
        self.top + self.height * (1.0 - self.y.share(value))
    }

    /// Position of a pair of values.
    pub(crate) fn at(&self, (x, y): (f64, f64)) -> (f64, f64) {
        (self.across(x), self.up(y))
    }

    /// Lower edge.
    pub(crate) fn bottom(&self) -> f64 {
        self.top + self.height
    }

    /// Right edge.
    pub(crate) fn right(&self) -> f64 {
        self.left + self.width
    }

    /// Draws grid, ticks, their labels, names of the axes and a heading above.
    pub(crate) fn draw(&self, svg: &mut Svg, heading: &str, x_name: &str, y_name: &str) {
        self.draw_heading(svg, heading);
        self.draw_upwards(svg, y_name);
        let labels = self.draw_grid(svg);
        self.draw_across(svg, &labels, x_name);
    }

    /// Labels of the horizontal axis with their positions.
    pub(crate) fn labels(&self) -> Vec<(f64, String)> {
        self.x.labels().into_iter().map(|(value, label)| (self.across(value), label)).collect()
    }

    /// Draws the vertical lines of the grid, and returns their positions and labels.
    pub(crate) fn draw_grid(&self, svg: &mut Svg) -> Vec<(f64, String)> {
        let labels = self.labels();
        for (x, _) in &labels {
            self.draw_upright(svg, *x, Stroke::solid(GRID, 1.0));
        }
        labels
    }

    /// Draws a vertical line at a position.
    pub(crate) fn draw_upright(&self, svg: &mut Svg, x: f64, stroke: Stroke) {
        svg.line((x, self.top), (x, self.bottom()), stroke);
    }

    /// Draws the heading, left-aligned with the panel.
    pub(crate) fn draw_heading(&self, svg: &mut Svg, heading: &str) {
        if !heading.is_empty() {
            svg.text((self.left, self.top - 14.0), heading, Style::new(Anchor::Start).bold());
        }
    }

    /// Draws the vertical axis with its grid.
    pub(crate) fn draw_upwards(&self, svg: &mut Svg, name: &str) {
        for (value, label) in self.y.labels() {
            let y = self.up(value);
            let line = if value == 0.0 { Stroke::solid(SOFT_INK, 1.0) } else { Stroke::solid(GRID, 1.0) };
            svg.line((self.left, y), (self.right(), y), line);
            svg.text((self.left - 7.0, y), &label, Style::new(Anchor::End));
        }
        let middle = (self.left - LEFT + 10.0, self.top + 0.5 * self.height);
        svg.text_upwards(middle, name, Style::new(Anchor::Middle).colour(SOFT_INK));
    }

    /// Draws the horizontal axis with labels at given positions, as many of them as fit.
    pub(crate) fn draw_across(&self, svg: &mut Svg, labels: &[(f64, String)], name: &str) {
        let bottom = self.bottom();
        svg.line((self.left, bottom), (self.right(), bottom), Stroke::solid(INK, 1.0));
        for (x, label) in with_room(labels) {
            svg.line((*x, bottom), (*x, bottom + 4.0), Stroke::solid(INK, 1.0));
            svg.text((*x, bottom + 14.0), label, Style::new(Anchor::Middle));
        }
        let middle = (self.left + 0.5 * self.width, bottom + 34.0);
        svg.text(middle, name, Style::new(Anchor::Middle).colour(SOFT_INK));
    }
}

/// Every label, or only every second, third, ... if they would touch.
fn with_room(labels: &[(f64, String)]) -> impl Iterator<Item = &(f64, String)> {
    let apart = |every: usize| {
        let kept: Vec<_> = labels.iter().step_by(every).collect();
        kept.windows(2).all(|pair| {
            let room = (pair[1].0 - pair[0].0).abs();
            room >= 0.5 * (width(&pair[0].1, TEXT) + width(&pair[1].1, TEXT)) + 6.0
        })
    };
    let every = (1..labels.len().max(2)).find(|every| apart(*every)).unwrap_or(labels.len().max(1));
    labels.iter().step_by(every)
}

/// Panels side by side: left edge and width of each of `count` across `total`.
pub(crate) fn columns(count: usize, total: f64) -> Vec<(f64, f64)> {
    let gap = 16.0;
    let each = total / count.max(1) as f64;
    (0..count).map(|i| (i as f64 * each + LEFT, each - LEFT - gap)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_that_would_touch_are_left_out() {
        let labels: Vec<_> = (0..40).map(|i| (20.0 * f64::from(i), format!("{}", 100 * i))).collect();
        let kept: Vec<_> = with_room(&labels).collect();
        assert!(kept.len() >= 10 && kept.len() <= 20, "{}", kept.len());
        assert!(kept.windows(2).all(|pair| pair[1].0 - pair[0].0 >= 40.0));
        assert_eq!(with_room(&labels[..1]).count(), 1);
        assert_eq!(with_room(&[]).count(), 0);
    }

    #[test]
    fn corners_are_the_ends_of_the_axes() {
        let axis = Axis::around([0.0, 10.0].into_iter()).unwrap();
        let panel = Panel { x: axis, y: axis, left: 50.0, top: 20.0, width: 200.0, height: 100.0 };
        assert_eq!([panel.at((0.0, 0.0)), panel.at((10.0, 10.0))], [(50.0, 120.0), (250.0, 20.0)]);
        assert_eq!(panel.at((5.0, 2.5)), (150.0, 95.0));
    }

    #[test]
    fn columns_fill_the_width() {
        let columns = columns(3, 900.0);
        assert_eq!(columns.len(), 3);
        assert!((columns[2].0 + columns[2].1 + 16.0 - 900.0).abs() < 1e-9);
    }
}
