//! Membrane finite elements: against closed forms, against shooting, and against the meridian equation.

use bulge_fibre::closed_form;
use bulge_membrane::case::{Case, Row};
use std::f64::consts::PI;
use std::fmt::Write;

use crate::check::{Check, Claim, Trouble};
use crate::reference::values;

/// Runs a case and gives its rows.
fn rows(text: &str) -> Result<Vec<Row>, Trouble> {
    let case = Case::from_toml(text, "case", None)?;
    let mut rows = Vec::new();
    case.start()?.last_row(|row| rows.push(row.clone()))?;
    Ok(rows)
}

/// Richardson's value from one mesh and one twice as fine, for errors of fourth order.
fn extrapolated(coarse: f64, fine: f64) -> f64 {
    fine + (fine - coarse) / 15.0
}

const RUBBER: &str = "
[[material]]
name = \"rubber\"
law = \"neo-hooke\"
thickness = \"1 mm\"
shear = \"0.4 MPa\"
[[part]]
group = \"wall\"
kind = \"sheet\"
material = \"rubber\"
";

/// A sphere of R = 100 mm: pR/(mu H) = 2 (1/l - 1/l^7), beyond its limit point too.
pub(crate) fn sphere() -> Check {
    Claim {
        group: "membrane",
        name: "pressure of a neo-Hookean sphere at prescribed volumes, before and past its limit point",
        source: "closed form",
        tolerance: 1e-6,
        why: "40 quadratic elements: fourth order",
    }
    .run(|tally| {
        let stretches = [1.1_f64, 1.25, 1.383_087_554_268_49, 1.5, 2.0, 3.0, 5.0];
        let mut text =
            format!("[mesher]\nkind = \"sphere\"\nradius = \"100 mm\"\ncells = [40]\norder = 2\n{RUBBER}");
        for stretch in stretches {
            let volume = 4.0 / 3.0 * PI * (100.0 * stretch).powi(3);
            write!(text, "[[step]]\nvolume = \"{volume} mm^3\"\n")?;
        }
        for (row, l) in rows(&text)?.iter().zip(stretches) {
            let exact = 0.4e6 * 0.001 / 0.1 * 2.0 * (1.0 / l - l.powi(-7));
            tally.relative(row.pressure, exact, || format!("stretch {l}"));
        }
        Ok(())
    })
}

fn tube(cells: usize, order: usize, steps: &str) -> String {
    format!(
        "[mesher]\nkind = \"tube\"\nradius = \"10 mm\"\nlength = \"60 mm\"\ncells = [{cells}]\norder = {order}\ngrading = 3.0\n{RUBBER}{steps}"
    )
}

/// Pressure \[kPa\], force \[N\], volume \[mm^3\] of the clamped tube of rubber.
const TUBE: [[f64; 3]; 6] = [
    [5.0, -0.065_359_811_2, 20_087.860_728_58],
    [10.0, -0.267_583_632_1, 21_548.794_575_73],
    [20.0, -1.319_579_120_0, 25_667.591_355_03],
    [30.0, -4.509_371_885_7, 34_161.100_645_60],
    [34.0, -8.686_206_411_1, 45_070.528_954_94],
    [32.353_062_0, -12.533_616_51, 68_311.883_8],
];

/// A clamped tube of rubber, R = 10, L = 60, H = 1 mm.
pub(crate) fn clamped_tube() -> Check {
    Claim {
        group: "membrane",
        name: "clamped tube of rubber: pressure and force at six volumes, one past the limit point",
        source: "shooting at 1e-13",
        tolerance: 1e-7,
        why: "200 quadratic elements: 4e-8 in the force past the limit point",
    }
    .run(|tally| {
        let mut steps = String::new();
        for [_, _, volume] in TUBE {
            write!(steps, "[[step]]\nvolume = \"{volume} mm^3\"\n")?;
        }
        for (row, [pressure, force, volume]) in rows(&tube(200, 2, &steps))?.iter().zip(TUBE) {
            tally.relative(row.pressure, 1e3 * pressure, || format!("pressure at {volume} mm^3"));
            tally.relative(row.force.unwrap_or(f64::NAN), force, || format!("force at {volume} mm^3"));
        }
        Ok(())
    })
}

/// How fast the error of the tube's force falls.
pub(crate) fn orders() -> Check {
    Claim {
        group: "membrane",
        name: "order of convergence of the tube's force: 2 for elements with two nodes, 4 with three",
        source: "shooting at 1e-13",
        tolerance: 0.15,
        why: "meshes of 30 to 120 elements are not yet asymptotic to more",
    }
    .run(|tally| {
        for (order, expected) in [(1, 2.0), (2, 4.0)] {
            let mut errors = Vec::new();
            for cells in [30, 60, 120] {
                let last = rows(&tube(cells, order, "[[step]]\npressure = \"30 kPa\"\n"))?;
                errors.push((last[0].force.unwrap_or(f64::NAN) - TUBE[3][1]).abs());
            }
            for pair in errors.windows(2) {
                let observed = (pair[0] / pair[1]).log2();
                tally.absolute(observed, expected, || format!("{} nodes: {observed:.2}", order + 1));
            }
        }
        Ok(())
    })
}

/// Forces and volumes of a tube of threads without stretch (and perhaps rubber) at contractions, extrapolated from two meshes.
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

/// Fibres along the meridian: the pleated muscle.
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
        let text = include_str!("../reference/braided_clamped_net.csv");
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

/// The same on a bladder of rubber.
pub(crate) fn braided_with_bladder() -> Check {
    Claim {
        group: "membrane",
        name: "clamped braid on a neo-Hookean bladder: force (of 50 N at least) and volume",
        source: "reduced elements of order 10",
        tolerance: 1e-6,
        why: "160 and 320 quadratic elements, extrapolated",
    }
    .run(|tally| {
        let text = include_str!("../reference/braided_net_bladder.csv");
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

fn sector(
    fibres: u32,
    cells: [usize; 2],
    cloth: &str,
    fibre: &str,
    contraction: f64,
) -> Result<Row, Trouble> {
    let text = format!(
        "[mesher]\nkind = \"pleated\"\nradius = \"16 mm\"\nlength = \"110 mm\"\nfibres = {fibres}\ncircumference = \"288 mm\"\ncells = [{}, {}]\n{cloth}[[part]]\ngroup = \"fibre\"\nkind = \"cable\"\n{fibre}[[step]]\npressure = \"3 bar\"\ncontraction = {contraction}\n",
        cells[0], cells[1]
    );
    let rows = rows(&text)?;
    rows.last().cloned().ok_or_else(|| "the case has no state".into())
}

/// Half lobes with cloth between the fibres.
pub(crate) fn sectors() -> Check {
    Claim {
        group: "membrane",
        name: "pleated sectors with cloth (50 N/mm, tension field), n = 8, 12, 24: force and volume",
        source: "an independent prototype, converged to 3e-4",
        tolerance: 1e-3,
        why: "12 x 40 cells; the reference has 18 x 60",
    }
    .run(|tally| {
        let cloth = "[[material]]\nname = \"cloth\"\nlaw = \"st-venant\"\nthickness = \"0.1 mm\"\nyoung = \"500 MPa\"\npoisson = 0.3\n[[part]]\ngroup = \"cloth\"\nkind = \"membrane\"\nmaterial = \"cloth\"\n";
        for (fibres, force, volume) in [(8, 884.25, 479_439.0), (12, 1064.44, 456_851.0), (24, 1320.17, 422_513.0)] {
            let stiffness = format!("stiffness = \"{} N\"\n", 12e6 / f64::from(fibres));
            let row = sector(fibres, [12, 40], cloth, &stiffness, 0.2)?;
            tally.relative(row.force.unwrap_or(f64::NAN), force, || format!("force, n = {fibres}"));
            tally.relative(row.volume, 1e-9 * volume, || format!("volume, n = {fibres}"));
        }
        Ok(())
    })
}

/// The square airbag, one eighth.
pub(crate) fn airbag() -> Check {
    Claim {
        group: "membrane",
        name: "square airbag of 1.2 m diagonal, 0.6 mm, 5 kPa: volume",
        source: "an independent prototype, 12800 triangles",
        tolerance: 1e-3,
        why: "3200 triangles",
    }
    .run(|tally| {
        let text = "[mesher]\nkind = \"square\"\nside = \"848.53 mm\"\ncells = [40, 40]\n[[material]]\nname = \"foil\"\nlaw = \"st-venant\"\nthickness = \"0.6 mm\"\nyoung = \"588 MPa\"\npoisson = 0.4\n[[part]]\ngroup = \"cloth\"\nkind = \"membrane\"\nmaterial = \"foil\"\n[[step]]\npressure = \"5 kPa\"\n";
        let rows = rows(text)?;
        tally.relative(rows[0].volume, 0.124_995, || "volume".into());
        Ok(())
    })
}
