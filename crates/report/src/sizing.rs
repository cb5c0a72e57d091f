//! Lines with a legend: isobars of a muscle with the path of a load, torques of a joint.

use crate::PlotError;
use crate::axis::{Axis, range};
use crate::drawing::{Chart, bar, drawn};

const SIZE: (f64, f64) = (624.0, 400.0);
const LEGEND_WIDTH: f64 = 136.0;
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
    with_axes(title, [CONTRACTION, FORCE], &lines, &percent(load))
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
    with_axes(title, axes, lines, &[])
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

/// Lines, and a load over them if there is one.
fn with_axes(
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
    let legend: Vec<_> = lines.iter().enumerate().map(|(i, (name, _))| (i, name.as_str())).rev().collect();
    let lines = lines.iter().map(|(_, points)| points.clone()).collect();
    Ok(drawn(title, SIZE, (LEGEND_WIDTH, &legend), &[Chart { names, axes, lines }], load))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::palette::{self, hex};

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
            let stroke = format!("stroke=\"{}\"", hex(palette::colour(i, 3)));
            let lines = svg.lines().filter(|line| line.starts_with("<polyline") && line.contains(&stroke));
            let points = |line: &str| line.split_once("points=").unwrap().1.matches(',').count();
            assert_eq!(lines.map(points).collect::<Vec<_>>(), [3, 2], "{i}");
        }
        assert_eq!(svg.matches("h0").count(), load.len());
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
