//! Isobaric characteristics: force and volume against contraction.

use crate::PlotError;
use crate::axis::Axis;
use crate::drawing::{Chart, bar, drawn};
use bulge_fibre::Response;

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
    let charts = [panel(FORCE, curves)?, panel(VOLUME, curves)?];
    let names: Vec<_> = curves.iter().map(|curve| bar(curve.pressure_pa)).collect();
    // Highest pressure on top, as the curves mostly lie.
    let every = curves.len().div_ceil(ROWS);
    let mut legend: Vec<_> =
        names.iter().enumerate().step_by(every).map(|(i, name)| (i, name.as_str())).collect();
    legend.sort_by(|a, b| curves[b.0].pressure_pa.total_cmp(&curves[a.0].pressure_pa));
    Ok(drawn(title, SIZE, (LEGEND_WIDTH, &legend), &charts, &[]))
}

const SIZE: (f64, f64) = (928.0, 376.0);
const LEGEND_WIDTH: f64 = 104.0;
/// Rows a legend has at most; of more curves only every second, third, ... is named.
const ROWS: usize = 16;

/// A quantity of a response, in the unit of its axis.
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
        Axis::of(self.name, curves.iter().flat_map(|c| c.points).map(self.read))
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

fn panel<'a>(quantity: Quantity, curves: &[Curve]) -> Result<Chart<'a>, PlotError> {
    let axes = [CONTRACTION.axis(curves)?, quantity.axis(curves)?];
    let pair = |r: &Response| [(CONTRACTION.read)(r), (quantity.read)(r)];
    let lines = curves.iter().map(|curve| curve.points.iter().map(pair).collect()).collect();
    Ok(Chart { names: [CONTRACTION.name, quantity.name], axes, lines })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::palette::{self, hex};
    use bulge_fibre::{Convergence, Method};

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
            let stroke = format!("stroke=\"{}\"", hex(palette::colour(i, 3)));
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
        assert!(svg.contains(r#"width="1160" height="470" viewBox="0 0 928 376""#));
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
        assert!(svg.matches(" bar<").count() <= ROWS && !svg.contains("dasharray"));
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
