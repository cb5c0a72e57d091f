//! Mean residuals over pressure and contraction as coloured cells: one map per direction, before and after.

use crate::PlotError;
use crate::comparison::number::{bar, level, percent, three, ticks};
use crate::comparison::svg::{Anchor, Stroke, Style, Svg, TEXT, width};
use crate::comparison::wording::{has_effects, names, pulls, sentence};
use crate::comparison::{Plot, WIDTH};
use crate::palette::{INK, Rgb, SOFT_INK, WHITE, signed};
use bulge_inference::{Comparison, ResidualMap};

const LEFT: f64 = 64.0;
const HEAD: f64 = 30.0;
const BELOW: f64 = 48.0;
/// Font size of the numbers in cells.
const SMALL: f64 = 10.0;
/// Height of the colour scale with its labels.
const SCALE: f64 = 56.0;

/// The plot; `None` without a map that has cells.
///
/// # Errors
/// None at present: the signature is that of the other plots.
#[expect(clippy::unnecessary_wraps, reason = "all plots are called alike")]
pub(crate) fn plot(comparison: &Comparison) -> Result<Option<Plot>, PlotError> {
    let maps: Vec<&ResidualMap> = comparison.maps.iter().filter(|map| !map.first_n.is_empty()).collect();
    if maps.is_empty() {
        return Ok(None);
    }
    let names = names(comparison);
    let most = scales(comparison, &maps);
    let row_height = |map: &ResidualMap| (150.0 / map.pressure_pa.len() as f64).clamp(7.0, 30.0);
    let heights: Vec<f64> = maps.iter().map(|map| row_height(map) * map.pressure_pa.len() as f64).collect();
    let total: f64 = heights.iter().map(|height| HEAD + height + BELOW).sum();
    let mut svg = Svg::new("residual-map", WIDTH, total + SCALE);
    let each = WIDTH / names.len() as f64;
    let mut top = 0.0;
    for (map, height) in maps.iter().zip(&heights) {
        for (i, name) in names.iter().enumerate() {
            let values = if i == 0 { &map.first_n } else { &map.last_n };
            let grid = Grid {
                left: i as f64 * each + LEFT,
                top: top + HEAD,
                width: each - LEFT - 16.0,
                height: *height,
            };
            // Single readings have no direction.
            let heading =
                if comparison.data.is_path { format!("{}, {name}", map.direction) } else { sentence(name) };
            svg.text((grid.left, grid.top - 13.0), &heading, Style::new(Anchor::Start).bold());
            grid.draw(&mut svg, map, values, most[i]);
        }
        top += HEAD + height + BELOW;
    }
    for (i, _) in names.iter().enumerate() {
        draw_scale(&mut svg, (i as f64 * each + LEFT, top), each - LEFT - 16.0, most[i]);
    }
    Ok(Some(Plot {
        name: "residual-map",
        title: "Map of the mean errors".to_owned(),
        caption: caption(comparison),
        svg: svg.finish("Mean errors over pressure and contraction"),
    }))
}

fn caption(comparison: &Comparison) -> String {
    let scales = match (has_effects(comparison), &comparison.noise_floor) {
        (true, Some(_)) => {
            " Before and after have scales of their own; the second is never finer than three times the noise floor, so a pattern that \
             is seen there hints at an effect that is missing."
        }
        (true, None) => {
            " Before and after have scales of their own: look at the numbers before comparing colours."
        }
        (false, _) => "",
    };
    format!(
        "Each cell is the mean of measured − model, in N. Orange: the model pulls too weakly; blue: too hard; pale: it is right. Hatched: \
         nothing was measured.{scales}"
    )
}

/// Error at the ends of the colour scale, for the first and the last rung \[N\].
fn scales(comparison: &Comparison, maps: &[&ResidualMap]) -> [f64; 2] {
    let largest = |values: fn(&ResidualMap) -> &Vec<Option<f64>>| {
        let cells = maps.iter().flat_map(|map| values(map)).flatten();
        // A perfect model has only white cells, whatever the scale; the minimum avoids a division by zero.
        cells.fold(0.0_f64, |most, cell| most.max(cell.abs())).max(1e-9 * comparison.data.full_scale_n.abs())
    };
    let floor = comparison.noise_floor.as_ref().map_or(0.0, |floor| 3.0 * floor.sd_n);
    [largest(|map| &map.first_n), largest(|map| &map.last_n).max(floor)]
        .map(|most| most.max(f64::MIN_POSITIVE))
}

/// Position of a map.
struct Grid {
    left: f64,
    top: f64,
    width: f64,
    height: f64,
}

impl Grid {
    fn draw(&self, svg: &mut Svg, map: &ResidualMap, values: &[Option<f64>], most: f64) {
        let (rows, columns) = (map.pressure_pa.len(), map.contraction.len());
        let size = (self.width / columns as f64, self.height / rows as f64);
        // The highest pressure is on top, as in the plots of the force.
        for (i, value) in values.iter().enumerate() {
            let (row, column) = (i / columns, i % columns);
            let corner = (self.left + column as f64 * size.0, self.top + (rows - 1 - row) as f64 * size.1);
            match value {
                Some(value) => {
                    let colour = signed(value / most);
                    svg.rect(corner, (size.0 + 0.3, size.1 + 0.3), colour);
                    draw_value(svg, (corner.0 + 0.5 * size.0, corner.1 + 0.5 * size.1), size, *value, most);
                }
                None => svg.hatch(corner, size),
            }
        }
        self.draw_frame(svg, map, size);
    }

    fn draw_frame(&self, svg: &mut Svg, map: &ResidualMap, size: (f64, f64)) {
        let bottom = self.top + self.height;
        let rows = map.pressure_pa.len();
        let every = (15.0 / size.1).ceil().max(1.0);
        for (i, pressure) in map.pressure_pa.iter().enumerate().filter(|(i, _)| *i as f64 % every == 0.0) {
            let y = self.top + (rows - i) as f64 * size.1 - 0.5 * size.1;
            svg.text((self.left - 6.0, y), &level(pressure / 1e5), Style::new(Anchor::End));
        }
        let percents: Vec<f64> = map.contraction.iter().map(|c| 100.0 * c).collect();
        let labels = ticks(&percents);
        let widest = labels.iter().map(|label| width(label, TEXT)).fold(0.0, f64::max);
        let every = ((widest + 6.0) / size.0).ceil().max(1.0);
        for (i, label) in labels.iter().enumerate().filter(|(i, _)| *i as f64 % every == 0.0) {
            svg.text(
                (self.left + (i as f64 + 0.5) * size.0, bottom + 13.0),
                label,
                Style::new(Anchor::Middle),
            );
        }
        let soft = Style::new(Anchor::Middle).colour(SOFT_INK);
        svg.text((self.left + 0.5 * self.width, bottom + 32.0), "contraction [%]", soft);
        svg.text_upwards((self.left - LEFT + 10.0, self.top + 0.5 * self.height), "p [bar]", soft);
    }
}

/// Draws the number in its cell if it fits.
fn draw_value(svg: &mut Svg, middle: (f64, f64), size: (f64, f64), value: f64, most: f64) {
    let words = cell(value, most);
    if width(&words, SMALL) + 3.0 < size.0 && size.1 >= 14.0 {
        let colour: Rgb = if (value / most).abs() > 0.7 { WHITE } else { INK };
        svg.text(middle, &words, Style::new(Anchor::Middle).size(SMALL).colour(colour));
    }
}

/// A number with two digits at the end of the scale, and the same number of decimals in all cells.
fn cell(value: f64, most: f64) -> String {
    let decimals = [10.0, 1.0, 0.1, 0.01].iter().filter(|size| most < **size).count();
    let text = format!("{:.decimals$}", value.abs());
    if value < 0.0 && text.contains(|c| c != '0' && c != '.') { format!("−{text}") } else { text }
}

/// Draws the colour scale with its forces below the maps of a rung.
fn draw_scale(svg: &mut Svg, (start, top): (f64, f64), width: f64, most: f64) {
    let (length, steps) = (width - 190.0, 41);
    let left = start + 95.0;
    let step = length / f64::from(steps);
    for i in 0..steps {
        let share = 2.0 * (f64::from(i) + 0.5) / f64::from(steps) - 1.0;
        svg.rect((left + f64::from(i) * step, top + 4.0), (step + 0.3, 12.0), signed(share));
    }
    for (share, label) in [(0.0, -most), (0.5, 0.0), (1.0, most)] {
        let x = left + share * length;
        svg.line((x, top + 16.0), (x, top + 20.0), Stroke::solid(INK, 1.0));
        let words = if label == 0.0 { "0".to_owned() } else { format!("{} N", three(label)) };
        svg.text((x, top + 30.0), &words, Style::new(Anchor::Middle));
    }
    svg.text((left - 10.0, top + 10.0), "pulls too hard", Style::new(Anchor::End).colour(SOFT_INK));
    svg.text((left + length + 10.0, top + 10.0), "too weakly", Style::new(Anchor::Start).colour(SOFT_INK));
}

/// The sentence above the plot.
pub(crate) fn says(comparison: &Comparison) -> String {
    let worst = |last: bool| {
        let cells = comparison.maps.iter().flat_map(move |map| {
            let values = if last { &map.last_n } else { &map.first_n };
            let columns = map.contraction.len().max(1);
            values.iter().enumerate().filter_map(move |(i, value)| {
                let (pressure, contraction) =
                    (map.pressure_pa.get(i / columns)?, map.contraction.get(i % columns)?);
                Some((value.as_ref().copied()?, *pressure, *contraction, map.direction))
            })
        });
        cells.max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()))
    };
    let place = |(_, pressure, contraction, direction): (f64, f64, f64, &str)| {
        let motion = match direction {
            _ if !comparison.data.is_path => String::new(),
            "at rest" => " at rest".to_owned(),
            _ => format!(" while {direction}"),
        };
        format!("at {} and {} contraction{motion}", bar(pressure), percent(contraction))
    };
    let (Some(first), Some(last)) = (worst(false), worst(true)) else { return String::new() };
    let base = format!("{} the base {}: no cell is worse.", sentence(&place(first)), pulls(first.0));
    if has_effects(comparison) {
        format!("{base} With all effects the worst cell is {}: the model {}.", place(last), pulls(last.0))
    } else {
        base
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_of_one_map_have_equally_many_decimals() {
        assert_eq!([166.0, -3.4, 0.2, -0.2].map(|v| cell(v, 166.0)), ["166", "−3", "0", "0"]);
        assert_eq!([7.5, -0.04, 0.36].map(|v| cell(v, 7.5)), ["7.5", "0.0", "0.4"]);
        assert_eq!(cell(-0.012, 0.05), "−0.012");
    }
}
