//! Isobaric characteristics: force and volume against contraction.

use crate::PlotError;
use crate::axis::{Axis, range};
use crate::drawing::{Area, LINE, SCALE, bar, chart, failed, finish, pixels, text, titled};
use crate::palette;
use bulge_fibre::Response;
use plotters::prelude::{Color, IntoDrawingArea, LineSeries, PathElement, SVGBackend};
use plotters::style::text_anchor::HPos;

/// One isobaric curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Curve<'a> {
    /// Gauge pressure \[Pa\], for the legend.
    pub pressure_pa: f64,
    /// Its points in drawing order, at least 2.
    pub points: &'a [Response],
}

/// Draws force \[N\] and volume \[ml\] against contraction \[%\] side by side, one line per pressure, with a legend, as an SVG document.
///
/// # Errors
/// There is no curve, a curve has fewer than 2 points, or a value isn't finite.
///
/// # Examples
/// ```
/// use bulge_fibre::Response;
/// use bulge_report::{Curve, PlotError, characteristics_svg};
///
/// fn isobar(points: &[Response]) -> Result<String, PlotError> {
///     characteristics_svg("A braided muscle at 2 bar", &[Curve { pressure_pa: 2e5, points }])
/// }
/// assert_eq!(isobar(&[]), Err(PlotError::TooFewPoints { pressure_pa: 2e5, found: 0 }));
/// ```
pub fn characteristics_svg(title: &str, curves: &[Curve]) -> Result<String, PlotError> {
    check(curves)?;
    let mut svg = String::new();
    draw(&mut svg, title, curves)?;
    Ok(finish(&svg, SIZE, curves.len()))
}

/// Size of the picture in pixels.
const SIZE: (u32, u32) = (1160, 470);
const LEGEND_WIDTH: u32 = 130;
/// A quantity of a response in the unit of its axis.
#[derive(Clone, Copy)]
struct Quantity {
    name: &'static str,
    read: fn(&Response) -> f64,
}

const CONTRACTION: Quantity = Quantity { name: "contraction [%]", read: |r| 100.0 * r.contraction };
const FORCE: Quantity = Quantity { name: "force [N]", read: |r| r.force_n };
const VOLUME: Quantity = Quantity { name: "volume [ml]", read: |r| 1e6 * r.volume_m3 };

impl Quantity {
    fn axis(self, curves: &[Curve]) -> Result<Axis, PlotError> {
        let values = || curves.iter().flat_map(|c| c.points).map(self.read);
        Axis::around(values()).ok_or_else(|| {
            let (low, high) = range(values()).unwrap_or((f64::MIN, f64::MAX));
            PlotError::Span { quantity: self.name, low, high }
        })
    }
}

fn check(curves: &[Curve]) -> Result<(), PlotError> {
    if curves.is_empty() {
        return Err(PlotError::NoCurves);
    }
    for (index, curve) in curves.iter().enumerate() {
        let pressure_pa = curve.pressure_pa;
        if !pressure_pa.is_finite() {
            return Err(PlotError::Pressure { curve: index, value: pressure_pa });
        }
        if curve.points.len() < 2 {
            return Err(PlotError::TooFewPoints { pressure_pa, found: curve.points.len() });
        }
        for (point, response) in curve.points.iter().enumerate() {
            for Quantity { name, read } in [CONTRACTION, FORCE, VOLUME] {
                let value = read(response);
                if !value.is_finite() {
                    return Err(PlotError::NotFinite { quantity: name, point, pressure_pa, value });
                }
            }
        }
    }
    Ok(())
}

fn draw(svg: &mut String, title: &str, curves: &[Curve]) -> Result<(), PlotError> {
    let paper = SVGBackend::with_string(svg, (SIZE.0 * SCALE, SIZE.1 * SCALE)).into_drawing_area();
    let body = titled(&paper, title, SIZE.0)?;
    let (plots, legend) = body.split_horizontally((SIZE.0 - LEGEND_WIDTH) * SCALE);
    let (left, right) = plots.split_horizontally((SIZE.0 - LEGEND_WIDTH) * SCALE / 2);
    panel(&left, FORCE, curves)?;
    panel(&right, VOLUME, curves)?;
    self::legend(&legend, curves)?;
    paper.present().map_err(failed)
}

fn panel(area: &Area, quantity: Quantity, curves: &[Curve]) -> Result<(), PlotError> {
    let (x, y) = (CONTRACTION.axis(curves)?, quantity.axis(curves)?);
    let mut chart = chart(area, (x, CONTRACTION.name), (y, quantity.name))?;
    for (i, curve) in curves.iter().enumerate() {
        let points = curve.points.iter().map(|r| ((CONTRACTION.read)(r), (quantity.read)(r)));
        let line = palette::colour(i, curves.len()).stroke_width(LINE);
        chart.draw_series(LineSeries::new(points, line)).map_err(failed)?;
    }
    Ok(())
}

/// Most rows of a legend; of more curves only every second, third, ... is named.
const ROWS: usize = 16;
const ROW_HEIGHT: i32 = 24;

/// Draws the legend with the highest pressure on top, which is the usual order of the curves.
fn legend(area: &Area, curves: &[Curve]) -> Result<(), PlotError> {
    let every = curves.len().div_ceil(ROWS);
    let mut named: Vec<usize> = (0..curves.len()).step_by(every).collect();
    named.sort_by(|a, b| curves[*b].pressure_pa.total_cmp(&curves[*a].pressure_pa));
    let scale = pixels(1);
    for (row, i) in (0_i32..).zip(named) {
        let y = (22 + row * ROW_HEIGHT) * scale;
        let line = palette::colour(i, curves.len()).stroke_width(LINE);
        area.draw(&PathElement::new(vec![(0, y), (38 * scale, y)], line)).map_err(failed)?;
        text(area, &bar(curves[i].pressure_pa), (46 * scale, y), 16, HPos::Left)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use bulge_fibre::{Convergence, Method};
    use plotters::prelude::RGBColor;

    fn response(pressure_pa: f64, contraction: f64) -> Response {
        Response {
            pressure_pa,
            force_n: pressure_pa * 6e-4 * (1.6 * (1.0 - contraction).powi(2) - 1.0),
            length_m: 0.1 * (1.0 - contraction),
            contraction,
            volume_m3: 6e-5 * (1.0 + 3.0 * contraction - 2.0 * contraction * contraction),
            volume_polygon_m3: 6e-5,
            max_radius_m: 0.02,
            mid_radius_m: 0.02,
            fibre_tension_n: 10.0,
            fibre_strain: 0.0,
            stiffness_n_per_m: 1e3,
            volume_slope_m2: 0.0,
            stiffness_isothermal_n_per_m: 1e3,
            stiffness_adiabatic_n_per_m: 1e3,
            end_slope_rad: 0.1,
            method: Method::ClosedForm,
            convergence: Convergence {
                iterations: 1,
                evaluations: 1,
                steps: 0,
                residual: 0.0,
                first_integral: 0.0,
            },
        }
    }

    fn isobar(pressure_pa: f64) -> Vec<Response> {
        (0..=30).map(|i| response(pressure_pa, 0.01 * f64::from(i))).collect()
    }

    fn plot(title: &str, pressures: &[f64]) -> String {
        let points: Vec<_> = pressures.iter().map(|p| isobar(*p)).collect();
        let curves: Vec<_> =
            pressures.iter().zip(&points).map(|(p, points)| Curve { pressure_pa: *p, points }).collect();
        characteristics_svg(title, &curves).unwrap()
    }

    /// Names of the tags, after checking that they nest and that quotation marks are even.
    fn tags(svg: &str) -> Vec<String> {
        let (mut open, mut names) = (Vec::new(), Vec::new());
        for tag in svg.split('<').skip(1) {
            let (tag, _) = tag.split_once('>').expect("a tag ends");
            assert!(tag.matches('"').count().is_multiple_of(2), "{tag}");
            if let Some(name) = tag.strip_prefix('/') {
                assert_eq!(open.pop().as_deref(), Some(name));
                continue;
            }
            let name = tag.split_whitespace().next().unwrap().to_owned();
            if !tag.ends_with('/') {
                open.push(name.clone());
            }
            names.push(name);
        }
        assert!(open.is_empty(), "left open: {open:?}");
        names
    }

    #[test]
    fn draws_every_curve_in_both_panels_and_in_the_legend() {
        let svg = plot("second-generation PPAM", &[1e5, 2e5, 3e5]);
        assert_eq!(tags(&svg)[0], "svg");
        for i in 0..3 {
            let RGBColor(r, g, b) = palette::colour(i, 3);
            let stroke = format!("stroke=\"#{r:02X}{g:02X}{b:02X}\"");
            let lines: Vec<_> =
                svg.lines().filter(|l| l.starts_with("<polyline") && l.contains(&stroke)).collect();
            let points = |line: &str| line.split_once("points=").unwrap().1.matches(',').count();
            assert_eq!(lines.iter().map(|line| points(line)).collect::<Vec<_>>(), [31, 31, 2]);
            assert_eq!(
                lines.iter().filter(|l| l.contains("stroke-dasharray")).count(),
                if i == 0 { 0 } else { 3 }
            );
        }
    }

    #[test]
    fn names_quantities_units_and_pressures() {
        let svg = plot("second-generation PPAM", &[1e5, 2.5e5]);
        for words in
            ["contraction [%]", "force [N]", "volume [ml]", "second-generation PPAM", "1 bar", "2.5 bar"]
        {
            assert!(svg.contains(words), "{words}");
        }
        assert!(svg.contains(r#"width="1160" height="470" viewBox="0 0 11600 4700""#));
    }

    #[test]
    fn any_title_gives_well_formed_xml() {
        let svg = plot("<b> \"a\" & stroke=\"#0D0887\" \u{7}\n", &[1e5, 2e5]);
        tags(&svg);
        assert!(svg.contains("&lt;b&gt;") && svg.contains("&amp;") && !svg.contains('\u{7}'));
    }

    #[test]
    fn same_curves_same_bytes() {
        assert_eq!(plot("a", &[1e5, 2e5]), plot("a", &[1e5, 2e5]));
    }

    #[test]
    fn many_curves_keep_a_short_legend() {
        let pressures: Vec<_> = (1..=50).map(|i| 1e4 * f64::from(i)).collect();
        let svg = plot("fifty", &pressures);
        assert!(svg.matches(" bar\n").count() <= ROWS && !svg.contains("dasharray"));
    }

    #[test]
    fn refuses_what_can_not_be_drawn_and_says_why() {
        let message = |curves: &[Curve]| characteristics_svg("a", curves).unwrap_err().to_string();
        assert_eq!(message(&[]), "a plot needs at least one curve");
        let mut points = isobar(1e5);
        assert!(message(&[Curve { pressure_pa: 1e5, points: &points[..1] }]).contains("1 point(s)"));
        assert!(message(&[Curve { pressure_pa: f64::NAN, points: &points }]).contains("NaN Pa"));
        points[7].force_n = f64::INFINITY;
        assert_eq!(
            message(&[Curve { pressure_pa: 1e5, points: &points }]),
            "force [N] is inf at point 7 of the curve at 100000 Pa: only finite values can be drawn"
        );
        points[7].force_n = 1e308;
        points[8].force_n = -1e308;
        assert!(
            message(&[Curve { pressure_pa: 1e5, points: &points }]).contains("more than an axis can span")
        );
    }

    #[test]
    fn constant_values_can_be_drawn() {
        let points = [response(1e5, 0.1); 2];
        assert!(characteristics_svg("a", &[Curve { pressure_pa: 1e5, points: &points }]).is_ok());
    }

    #[test]
    fn pressures_are_short() {
        let shown: Vec<_> = [0.0, -0.0, 2e5, 12_345.678, 1.0, -5e4].into_iter().map(bar).collect();
        assert_eq!(shown, ["0 bar", "0 bar", "2 bar", "0.1235 bar", "1e-5 bar", "-0.5 bar"]);
    }
}
