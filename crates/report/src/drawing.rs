//! Parts that the plots share: background, text, axes, and the final SVG.

use crate::PlotError;
use crate::axis::Axis;
use crate::palette;
use plotters::chart::ChartContext;
use plotters::coord::Shift;
use plotters::coord::cartesian::Cartesian2d;
use plotters::prelude::{
    ChartBuilder, Color, DrawingArea, IntoFont, RGBColor, SVGBackend, Text, TextStyle, WHITE,
};
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Plotters rounds to whole units: it draws at this scale, and the viewer scales back.
pub(crate) const SCALE: u32 = 10;
pub(crate) const LINE: u32 = 2 * SCALE;
const TITLE_HEIGHT: u32 = 50;
pub(crate) const INK: RGBColor = RGBColor(34, 34, 34);
const GRID: RGBColor = RGBColor(222, 222, 222);

pub(crate) type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Draws a white background with a title and returns the area below. Control characters aren't allowed in
/// XML.
pub(crate) fn titled<'a>(paper: &Area<'a>, title: &str, width: u32) -> Result<Area<'a>, PlotError> {
    paper.fill(&WHITE).map_err(failed)?;
    let (head, body) = paper.split_vertically(TITLE_HEIGHT * SCALE);
    let title = title.replace(char::is_control, " ");
    text(&head, &title, (pixels(width) / 2, pixels(TITLE_HEIGHT) / 2), 21, HPos::Center)?;
    Ok(body)
}

/// Draws axes with names, ticks and grid.
pub(crate) fn chart<'a, 'b>(
    area: &'b Area<'a>,
    (x, across): (Axis, &str),
    (y, up): (Axis, &str),
) -> Result<ChartContext<'b, SVGBackend<'a>, Cartesian2d<Axis, Axis>>, PlotError> {
    let mut chart = ChartBuilder::on(area)
        .margin_right(22 * SCALE)
        .margin_bottom(14 * SCALE)
        .margin_left(12 * SCALE)
        .margin_top(10 * SCALE)
        .x_label_area_size(52 * SCALE)
        .y_label_area_size(74 * SCALE)
        .build_cartesian_2d(x, y)
        .map_err(failed)?;
    chart
        .configure_mesh()
        .x_desc(across)
        .y_desc(up)
        .label_style(style(15))
        .axis_desc_style(style(17))
        .axis_style(INK.stroke_width(SCALE))
        .bold_line_style(GRID.stroke_width(SCALE))
        .light_line_style(WHITE.mix(0.0))
        .set_all_tick_mark_size(5 * SCALE)
        .draw()
        .map_err(failed)?;
    Ok(chart)
}

pub(crate) fn failed(reason: impl std::fmt::Display) -> PlotError {
    PlotError::Drawing { reason: reason.to_string() }
}

/// A length in pixels as a coordinate of the drawing.
pub(crate) fn pixels(length: u32) -> i32 {
    i32::try_from(length * SCALE).unwrap_or(i32::MAX)
}

pub(crate) fn style(size: u32) -> TextStyle<'static> {
    ("sans-serif", size * SCALE).into_font().color(&INK)
}

pub(crate) fn text(area: &Area, words: &str, at: (i32, i32), size: u32, side: HPos) -> Result<(), PlotError> {
    let style = style(size).pos(Pos::new(side, VPos::Center));
    area.draw(&Text::new(words.to_owned(), at, style)).map_err(failed)
}

/// "2 bar", "0.125 bar": four digits, without trailing zeros.
pub(crate) fn bar(pressure_pa: f64) -> String {
    let value = pressure_pa / 1e5;
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    // Adding zero turns -0 into 0.
    let rounded = rounded + 0.0;
    if rounded == 0.0 || (1e-4..1e7).contains(&rounded.abs()) {
        format!("{rounded} bar")
    } else {
        format!("{rounded:e} bar")
    }
}

/// Scales the drawing back and adds the dashes, since plotters would draw every dash as a separate line. Text
/// can't be mistaken for an attribute: its quotation marks are escaped.
pub(crate) fn finish(svg: &str, (width, height): (u32, u32), n: usize) -> String {
    let size = |factor: u32| format!(r#"width="{}" height="{}""#, width * factor, height * factor);
    let mut svg = svg.replacen(&size(SCALE), &size(1), 1);
    for i in 0..n {
        if let Some(dashes) = palette::dashes(i, n, LINE) {
            let RGBColor(r, g, b) = palette::colour(i, n);
            let stroke = format!("stroke=\"#{r:02X}{g:02X}{b:02X}\"");
            svg = svg.replace(&stroke, &format!(r#"{stroke} stroke-dasharray="{dashes}""#));
        }
    }
    svg
}
