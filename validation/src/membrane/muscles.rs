//! Muscles of revolution with inextensible fibres, with and without a bladder.

use bulge_fibre::closed_form;
use bulge_membrane::case::Row;
use std::fmt::Write;

use super::{RUBBER, extrapolated, rows};
use crate::check::{Check, Claim, Trouble};
use crate::reference::values;

/// Forces and volumes of a tube of inextensible threads (optionally with rubber) at contractions,
/// extrapolated from two meshes.
fn net(
    cells: usize,
    size: [f64; 2],
    angle: f64,
    rubber: &str,
    contractions: &[f64],
) -> Result<Vec<[f64; 2]>, Trouble> {
    let run = |cells: usize| {
        let mut text = format!(
            "[mesher]\nkind = \"tube\"\nradius = \"{} mm\"\nlength = \"{} mm\"\ncells = [{cells}]\norder = 2\ngrading = 4.0\n{rubber}[[part]]\ngroup = \"wall\"\nkind = \"threads\"\nangle = \"{angle} deg\"\n",
            size[0], size[1]
        );
        for contraction in contractions {
            write!(text, "[[step]]\npressure = \"3 bar\"\ncontraction = {contraction}\n")?;
        }
        rows(&text)
    };
    let (coarse, fine) = (run(cells)?, run(2 * cells)?);
    let force = |row: &Row| row.force.unwrap_or(f64::NAN);
    Ok(coarse
        .iter()
        .zip(&fine)
        .map(|(a, b)| [extrapolated(force(a), force(b)), extrapolated(a.volume, b.volume)])
        .collect())
}

/// Fibres along the meridian, as in the pleated muscle.
pub(crate) fn pleated() -> Check {
    Claim {
        group: "membrane",
        name: "pleated muscle of revolution, fibres without stretch: force and volume",
        source: "elliptic integrals",
        tolerance: 1e-6,
        why: "80 and 160 quadratic elements, extrapolated",
    }
    .run(|tally| {
        let contractions = [0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35];
        for radius in [16.0, 11.5] {
            let found = net(80, [radius, 110.0], 0.0, "", &contractions)?;
            for ([force, volume], contraction) in found.into_iter().zip(contractions) {
                let exact = closed_form::solve(contraction, 110.0 / radius, 0.0)?;
                let case = |what: &str| format!("{what}, R = {radius} mm, contraction {contraction}");
                tally.relative(force, 3e5 * 0.11 * 0.11 * exact.force.value, || case("force"));
                tally.relative(volume, 0.11_f64.powi(3) * exact.volume.value, || case("volume"));
            }
        }
        Ok(())
    })
}

/// A braid of 25 degrees with clamped ends.
pub(crate) fn braided() -> Check {
    Claim {
        group: "membrane",
        name: "clamped braid, fibres without stretch: force (of 5 bar r0^2) and volume",
        source: "quadrature, 12 digits",
        tolerance: 1e-6,
        why: "160 and 320 quadratic elements, extrapolated",
    }
    .run(|tally| {
        let text = include_str!("../../reference/braided_clamped_net.csv");
        for length in [60.0, 250.0] {
            let wanted: Vec<[f64; 8]> = values::<8>(text)?
                .into_iter()
                // r0 = 10 mm.
                .filter(|row| {
                    [row[0] - 0.01, row[1] - 1e-3 * length, row[2] - 25.0].iter().all(|d| d.abs() < 1e-9)
                })
                .collect();
            let contractions: Vec<f64> = wanted.iter().map(|row| row[3]).collect();
            let found = net(160, [10.0, length], 25.0, "", &contractions)?;
            for ([force, volume], row) in found.into_iter().zip(&wanted) {
                let case = |what: &str| format!("{what}, l0 = {length} mm, contraction {}", row[3]);
                tally.scaled(force, 3e5 * row[4], 50.0, || case("force"));
                tally.relative(volume, row[5], || case("volume"));
            }
        }
        Ok(())
    })
}

/// The same braid on a rubber bladder.
pub(crate) fn braided_with_bladder() -> Check {
    Claim {
        group: "membrane",
        name: "clamped braid on a neo-Hookean bladder: force (of 50 N at least) and volume",
        source: "reduced elements of order 10",
        tolerance: 1e-6,
        why: "160 and 320 quadratic elements, extrapolated",
    }
    .run(|tally| {
        let text = include_str!("../../reference/braided_net_bladder.csv");
        for length in [60.0, 250.0] {
            let wanted: Vec<[f64; 5]> =
                values::<5>(text)?.into_iter().filter(|row| (row[0] - length).abs() < 1e-9).collect();
            let contractions: Vec<f64> = wanted.iter().map(|row| row[1]).collect();
            let found = net(160, [10.0, length], 25.0, RUBBER, &contractions)?;
            for ([force, volume], row) in found.into_iter().zip(&wanted) {
                let case = |what: &str| format!("{what}, l0 = {length} mm, contraction {}", row[1]);
                tally.scaled(force, row[2], 50.0, || case("force"));
                tally.relative(volume, 1e-9 * row[4], || case("volume"));
            }
        }
        Ok(())
    })
}

/// A muscle with a closed valve.
pub(crate) fn gas() -> Check {
    Claim {
        group: "membrane",
        name: "clamped braid closed with its gas at 5 %, drawn to 20 %: pressure and force",
        source: "quadrature, 12 digits, and (p + pa) V^gamma = const.",
        tolerance: 1e-6,
        why: "200 quadratic elements: fourth order",
    }
    .run(|tally| {
        let text = include_str!("../../reference/braided_clamped_net.csv");
        let short: Vec<[f64; 8]> = values::<8>(text)?
            .into_iter()
            .filter(|row| [row[0] - 0.01, row[1] - 0.06, row[2] - 25.0].iter().all(|d| d.abs() < 1e-9))
            .collect();
        let at = |contraction: f64| {
            short.iter().find(|row| (row[3] - contraction).abs() < 1e-9).ok_or("a row is missing")
        };
        let (start, end) = (at(0.05)?, at(0.2)?);
        for (gas, gamma) in [("isothermal", 1.0), ("adiabatic", 1.4)] {
            let found = rows(&format!(
                "[mesher]\nkind = \"tube\"\nradius = \"10 mm\"\nlength = \"60 mm\"\ncells = [200]\norder = 2\ngrading = 4.0\n[[part]]\ngroup = \"wall\"\nkind = \"threads\"\nangle = \"25 deg\"\n[[step]]\npressure = \"3 bar\"\ncontraction = 0.05\n[[step]]\ngas = \"{gas}\"\nambient = \"1 bar\"\ncontraction = 0.2\n"
            ))?;
            let last = found.last().ok_or("the case has no state")?;
            let pressure = 4e5 * (start[5] / end[5]).powf(gamma) - 1e5;
            tally.relative(last.pressure, pressure, || format!("pressure, {gas}"));
            tally.relative(last.force.unwrap_or(f64::NAN), pressure * end[4], || format!("force, {gas}"));
        }
        Ok(())
    })
}

/// F = d(U - pV)/dl in every kind of mesh.
pub(crate) fn virtual_work() -> Check {
    Claim {
        group: "membrane",
        name: "F = d(U - pV)/dl at constant pressure: tube, braid, braid on rubber, pleated sector with cloth",
        source: "virtual work",
        tolerance: 1e-6,
        why: "central differences of fourth order",
    }
    .run(|tally| {
        let tube = "[mesher]\nkind = \"tube\"\nradius = \"10 mm\"\nlength = \"60 mm\"\ncells = [40]\norder = 2\ngrading = 3.0\n";
        let threads = "[[part]]\ngroup = \"wall\"\nkind = \"threads\"\nangle = \"25 deg\"\n";
        let lobe = "[mesher]\nkind = \"pleated\"\nradius = \"16 mm\"\nlength = \"110 mm\"\nfibres = 12\ncircumference = \"288 mm\"\ncells = [6, 16]\n[[material]]\nname = \"cloth\"\nlaw = \"st-venant\"\nthickness = \"0.1 mm\"\nyoung = \"500 MPa\"\npoisson = 0.3\n[[part]]\ngroup = \"cloth\"\nkind = \"membrane\"\nmaterial = \"cloth\"\n[[part]]\ngroup = \"fibre\"\nkind = \"cable\"\nstiffness = \"1 MN\"\n";
        for (name, text, length, pressure, contraction) in [
            ("tube of rubber", format!("{tube}{RUBBER}"), 0.06, 3e4, 0.0),
            ("braid", format!("{tube}{threads}"), 0.06, 3e5, 0.2),
            ("braid on rubber", format!("{tube}{RUBBER}{threads}"), 0.06, 3e5, 0.2),
            ("pleated sector", lobe.to_owned(), 0.11, 3e5, 0.2),
        ] {
            let (mut text, step) = (text, 2e-4);
            for k in [-2.0, -1.0, 0.0, 1.0, 2.0] {
                let contraction = contraction + k * step;
                write!(text, "[[step]]\npressure = \"{pressure} Pa\"\ncontraction = {contraction}\n")?;
            }
            let rows = rows(&text)?;
            let [a, b, middle, d, e] = &rows[..] else { return Err("a state is missing".into()) };
            let potential = |row: &Row| row.energy - pressure * row.volume;
            let slope = (8.0 * (potential(d) - potential(b)) - (potential(e) - potential(a))) / (12.0 * step);
            tally.relative(middle.force.unwrap_or(f64::NAN), -slope / length, || name.into());
        }
        Ok(())
    })
}
