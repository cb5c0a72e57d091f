//! Lines with a legend: isobars of a muscle with the path of a load, torques of a joint.

use crate::PlotError;
use crate::axis::{Axis, range};
use crate::drawing::{Area, INK, LINE, SCALE, bar, chart, failed, finish, pixels, text, titled};
use crate::palette;
use plotters::prelude::{Circle, Color, IntoDrawingArea, LineSeries, PathElement, SVGBackend};
use plotters::style::text_anchor::HPos;

/// Size of the picture in pixels.
const SIZE: (u32, u32) = (780, 500);
const LEGEND_WIDTH: u32 = 170;
const ROW_HEIGHT: i32 = 24;
const CONTRACTION: &str = "contraction [%]";
const FORCE: &str = "force [N]";

/// Draws force \[N\] against contraction \[%\] as an SVG document: one line per gauge pressure \[Pa\] with
/// its contractions and forces, in the order of rising pressure, and over them the points of a load, joined.
///
/// # Errors
/// There is no isobar or no load, an isobar has fewer than 2 points, or a value isn't finite.
///
/// # Examples
/// ```
/// use bulge_report::sizing_svg;
/// let isobars = [(2e5, vec![[0.0, 600.0], [0.2, 0.0]]), (4e5, vec![[0.0, 1200.0], [0.25, 0.0]])];
/// let svg = sizing_svg("a muscle", &isobars, &[[0.0, 0.0], [0.12, 400.0]])?;
/// assert!(svg.contains("4 bar") && svg.contains("load"));
/// # Ok::<(), bulge_report::PlotError>(())
/// ```
pub fn sizing_svg(
    title: &str,
    isobars: &[(f64, Vec<[f64; 2]>)],
    load: &[[f64; 2]],
) -> Result<String, PlotError> {
    check(isobars, load)?;
    let percent =
        |points: &[[f64; 2]]| points.iter().map(|[x, force]| [100.0 * x, *force]).collect::<Vec<_>>();
    let lines: Vec<_> = isobars.iter().map(|(pressure, points)| (bar(*pressure), percent(points))).collect();
    drawn(title, [CONTRACTION, FORCE], &lines, &percent(load))
}

/// Draws named lines against two axes as an SVG document. The first line is lowest in the legend.
///
/// # Errors
/// There is no line, a line has fewer than 2 points, or a value isn't finite.
pub fn lines_svg(
    title: &str,
    axes: [&str; 2],
    lines: &[(String, Vec<[f64; 2]>)],
) -> Result<String, PlotError> {
    if lines.is_empty() {
        return Err(PlotError::NoCurves);
    }
    if let Some((_, points)) = lines.iter().find(|(_, points)| points.len() < 2) {
        return Err(PlotError::Lengths { what: "point(s) of a line", expected: 2, found: points.len() });
    }
    drawn(title, axes, lines, &[])
}

fn check(isobars: &[(f64, Vec<[f64; 2]>)], load: &[[f64; 2]]) -> Result<(), PlotError> {
    if isobars.is_empty() || load.is_empty() {
        return Err(PlotError::NoCurves);
    }
    for (curve, (pressure_pa, points)) in isobars.iter().enumerate() {
        let pressure_pa = *pressure_pa;
        if !pressure_pa.is_finite() {
            return Err(PlotError::Pressure { curve, value: pressure_pa });
        }
        if points.len() < 2 {
            return Err(PlotError::TooFewPoints { pressure_pa, found: points.len() });
        }
    }
    Ok(())
}

/// Draws the lines, and a load over them if there is one.
fn drawn(
    title: &str,
    names: [&str; 2],
    lines: &[(String, Vec<[f64; 2]>)],
    load: &[[f64; 2]],
) -> Result<String, PlotError> {
    let all = || lines.iter().flat_map(|(_, points)| points).chain(load);
    let axis = |k: usize| {
        let values = || all().map(move |point| point[k]);
        let quantity = names[k].to_owned();
        if let Some(value) = values().find(|value| !value.is_finite()) {
            return Err(PlotError::Value { quantity, value });
        }
        Axis::around(values()).ok_or_else(|| {
            let (low, high) = range(values()).unwrap_or((f64::MIN, f64::MAX));
            PlotError::Value { quantity, value: high - low }
        })
    };
    let axes = [axis(0)?, axis(1)?];
    let mut svg = String::new();
    draw(&mut svg, title, (names, axes), lines, load)?;
    Ok(finish(&svg, SIZE, lines.len()))
}

fn draw(
    svg: &mut String,
    title: &str,
    (names, axes): ([&str; 2], [Axis; 2]),
    lines: &[(String, Vec<[f64; 2]>)],
    load: &[[f64; 2]],
) -> Result<(), PlotError> {
    let paper = SVGBackend::with_string(svg, (SIZE.0 * SCALE, SIZE.1 * SCALE)).into_drawing_area();
    let body = titled(&paper, title, SIZE.0)?;
    let (plot, legend) = body.split_horizontally((SIZE.0 - LEGEND_WIDTH) * SCALE);
    let mut chart = chart(&plot, (axes[0], names[0]), (axes[1], names[1]))?;
    let point = |[x, y]: &[f64; 2]| (*x, *y);
    for (i, (_, points)) in lines.iter().enumerate() {
        let line = palette::colour(i, lines.len()).stroke_width(LINE);
        chart.draw_series(LineSeries::new(points.iter().map(point), line)).map_err(failed)?;
    }
    if !load.is_empty() {
        chart
            .draw_series(LineSeries::new(load.iter().map(point), INK.stroke_width(LINE + SCALE)))
            .map_err(failed)?;
        chart
            .draw_series(load.iter().map(|at| Circle::new(point(at), 5 * SCALE, INK.filled())))
            .map_err(failed)?;
    }
    named(&legend, lines, !load.is_empty())?;
    paper.present().map_err(failed)
}

/// Draws the legend with the last line on top, which is the order of isobars, and the load at the end.
fn named(area: &Area, lines: &[(String, Vec<[f64; 2]>)], has_load: bool) -> Result<(), PlotError> {
    let scale = pixels(1);
    let row = |row: i32| (22 + row * ROW_HEIGHT) * scale;
    let mut last = 0;
    for (k, (i, (name, _))) in (0..).zip(lines.iter().enumerate().rev()) {
        let line = palette::colour(i, lines.len()).stroke_width(LINE);
        area.draw(&PathElement::new(vec![(0, row(k)), (38 * scale, row(k))], line)).map_err(failed)?;
        text(area, name, (46 * scale, row(k)), 16, HPos::Left)?;
        last = k + 1;
    }
    if !has_load {
        return Ok(());
    }
    let line = INK.stroke_width(LINE + SCALE);
    area.draw(&PathElement::new(vec![(0, row(last)), (38 * scale, row(last))], line)).map_err(failed)?;
    text(area, "load", (46 * scale, row(last)), 16, HPos::Left)
}

#[cfg(test)]
mod tests {
    use super::*;
    use plotters::prelude::RGBColor;

    fn isobars() -> Vec<(f64, Vec<[f64; 2]>)> {
        [1e5, 2e5, 4e5].map(|p| (p, vec![[0.0, 3e-3 * p], [0.1, 1e-3 * p], [0.25, 0.0]])).to_vec()
    }

    #[test]
    fn draws_isobars_and_load() {
        let load = [[0.0, 0.0], [0.125, 500.0]];
        let svg = sizing_svg("DMSP-20 <of 400 mm>", &isobars(), &load).unwrap();
        for words in [CONTRACTION, FORCE, "1 bar", "2 bar", "4 bar", "load", "DMSP-20 &lt;of 400 mm&gt;"] {
            assert!(svg.contains(words), "{words}");
        }
        // Each isobar occurs in the plot and in the legend.
        for i in 0..3 {
            let RGBColor(r, g, b) = palette::colour(i, 3);
            let stroke = format!("stroke=\"#{r:02X}{g:02X}{b:02X}\"");
            let lines = svg.lines().filter(|line| line.starts_with("<polyline") && line.contains(&stroke));
            let points = |line: &str| line.split_once("points=").unwrap().1.matches(',').count();
            assert_eq!(lines.map(points).collect::<Vec<_>>(), [3, 2], "{i}");
        }
        assert_eq!(svg.matches("<circle").count(), load.len());
        assert_eq!(svg, sizing_svg("DMSP-20 <of 400 mm>", &isobars(), &load).unwrap());
    }

    #[test]
    fn refuses_what_can_not_be_drawn() {
        let load = [[0.0, 0.0], [0.1, 500.0]];
        assert_eq!(sizing_svg("a", &[], &load), Err(PlotError::NoCurves));
        assert_eq!(sizing_svg("a", &isobars(), &[]), Err(PlotError::NoCurves));
        let short = [(1e5, vec![[0.0, 1.0]])];
        assert_eq!(
            sizing_svg("a", &short, &load),
            Err(PlotError::TooFewPoints { pressure_pa: 1e5, found: 1 })
        );
        let endless = [(1e5, vec![[0.0, f64::INFINITY], [0.1, 1.0]])];
        assert!(sizing_svg("a", &endless, &load).unwrap_err().to_string().contains("force [N] is inf"));
        let lines = [("a".to_owned(), vec![[0.0, 1.0]])];
        assert!(lines_svg("a", ["x", "y"], &lines).unwrap_err().to_string().contains("1 point(s) of a line"));
        assert_eq!(lines_svg("a", ["x", "y"], &[]), Err(PlotError::NoCurves));
        let nowhere = [(f64::NAN, vec![[0.0, 1.0], [0.1, 1.0]])];
        assert!(matches!(sizing_svg("a", &nowhere, &load), Err(PlotError::Pressure { curve: 0, .. })));
    }
}
