//! Isobars as CSV, table and plot, for `curve` and `demo`.

use bulge_fibre::{Isobar, Response};
use bulge_muscles::Pressure;
use bulge_report::{Curve, characteristics_svg};
use std::fmt::Write;

use crate::failure::Failure;
use crate::text::{significant, with_units};

type Column = (&'static str, fn(&Response) -> f64);

/// Columns of the CSV: names as in data files, units in brackets, SI.
const COLUMNS: [Column; 14] = [
    ("pressure [Pa]", |r| r.pressure_pa),
    ("contraction [-]", |r| r.contraction),
    ("length [m]", |r| r.length_m),
    ("force [N]", |r| r.force_n),
    ("volume [m^3]", |r| r.volume_m3),
    ("volume_polygon [m^3]", |r| r.volume_polygon_m3),
    ("diameter [m]", |r| 2.0 * r.max_radius_m),
    ("fibre_tension [N]", |r| r.fibre_tension_n),
    ("fibre_strain [-]", |r| r.fibre_strain),
    ("stiffness [N/m]", |r| r.stiffness_n_per_m),
    ("stiffness_isothermal [N/m]", |r| r.stiffness_isothermal_n_per_m),
    ("stiffness_adiabatic [N/m]", |r| r.stiffness_adiabatic_n_per_m),
    ("end_slope [rad]", |r| r.end_slope_rad),
    ("residual [-]", |r| r.convergence.residual),
];

/// All points of all isobars.
pub(crate) fn csv(isobars: &[Isobar]) -> String {
    let mut text = COLUMNS.map(|(name, _)| name).join(",") + "\n";
    for response in isobars.iter().flat_map(|isobar| &isobar.points) {
        for (i, (_, value)) in COLUMNS.iter().enumerate() {
            let _ = write!(text, "{}{}", if i == 0 { "" } else { "," }, value(response));
        }
        text.push('\n');
    }
    text
}

/// About ten rows of every isobar.
pub(crate) fn summary(isobars: &[Isobar]) -> String {
    let mut text = String::new();
    for isobar in isobars {
        let _ = writeln!(
            text,
            "{}   ({})\n",
            Pressure::pa(isobar.pressure_pa),
            isobar.contraction_limit.map_or("contraction limit not found".to_owned(), |limit| {
                let limit = significant(100.0 * limit, 5);
                if isobar.ends_slack {
                    format!("ends at {limit} %, where the fibres slacken: the bladder carries the rest")
                } else {
                    format!("force vanishes at {limit} %")
                }
            })
        );
        let heading = ["contraction", "force", "volume", "largest radius", "fibre tension", "stiffness"];
        let units = ["%", "N", "ml", "mm", "N", "N/mm"];
        let largest = isobar.points.iter().map(|r| r.force_n.abs()).fold(0.0, f64::max);
        let every = isobar.points.len().div_ceil(11).max(1);
        let rows = isobar.points.iter().step_by(every).map(|r| {
            [
                significant(100.0 * r.contraction, 4),
                // At the limit itself the force is only rounding.
                if r.force_n.abs() < 1e-9 * largest { "0".to_owned() } else { significant(r.force_n, 5) },
                significant(1e6 * r.volume_m3, 5),
                significant(1e3 * r.max_radius_m, 4),
                significant(r.fibre_tension_n, 4),
                significant(1e-3 * r.stiffness_n_per_m, 4),
            ]
        });
        text.push_str(&with_units(heading, units, rows));
        text.push('\n');
    }
    text
}

/// Plot of force and volume against contraction.
pub(crate) fn svg(title: &str, isobars: &[Isobar]) -> Result<String, Failure> {
    let curves: Vec<Curve> = isobars
        .iter()
        .map(|isobar| Curve { pressure_pa: isobar.pressure_pa, points: &isobar.points })
        .collect();
    Ok(characteristics_svg(title, &curves)?)
}
