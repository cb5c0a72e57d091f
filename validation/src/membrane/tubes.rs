//! Rubber tubes: clamped ones against shooting, open and closed cylinders against closed forms.

use bulge_membrane::mesher::{Grading, revolved};
use bulge_membrane::{Fitting, Inflation, Law, Solver, Support};
use std::f64::consts::PI;
use std::fmt::Write;

use super::rig::{self, extreme, plane, rubber, solver, to};
use super::{RUBBER, rows};
use crate::check::{Check, Claim, Trouble};

fn tube(cells: usize, order: usize, steps: &str) -> String {
    format!(
        "[mesher]\nkind = \"tube\"\nradius = \"10 mm\"\nlength = \"60 mm\"\ncells = [{cells}]\norder = {order}\ngrading = 3.0\n{RUBBER}{steps}"
    )
}

/// Pressure \[kPa\], force \[N\], volume \[mm^3\] of the clamped rubber tube.
const TUBE: [[f64; 3]; 6] = [
    [5.0, -0.065_359_811_2, 20_087.860_728_58],
    [10.0, -0.267_583_632_1, 21_548.794_575_73],
    [20.0, -1.319_579_120_0, 25_667.591_355_03],
    [30.0, -4.509_371_885_7, 34_161.100_645_60],
    [34.0, -8.686_206_411_1, 45_070.528_954_94],
    [32.353_062_0, -12.533_616_51, 68_311.883_8],
];

/// A clamped rubber tube, R = 10, L = 60, H = 1 mm.
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

/// Order of the error of the force of the tube.
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
                errors.push(last[0].force.unwrap_or(f64::NAN) - TUBE[3][1]);
            }
            rig::order(tally, &format!("{} nodes", order + 1), &errors, expected);
        }
        Ok(())
    })
}

/// The largest pressure of the same tube.
pub(crate) fn limit_point() -> Check {
    Claim {
        group: "membrane",
        name: "clamped tube of rubber: its largest pressure",
        source: "shooting at 1e-13",
        tolerance: 1e-8,
        why: "200 quadratic elements: fourth order",
    }
    .run(|tally| {
        // Lengths in mm, forces in N.
        let mesh = revolved(|t| [10.0, 60.0 * t], 200, true, Grading::Ends(3.0));
        let ends = [("first", Support::Fitting { fitting: 0 }), ("last", Support::Fitting { fitting: 1 })];
        let parts = [("wall", rubber(Law::NeoHooke { shear: 0.4 }))];
        let mut tube = solver(&mesh, &parts, &ends, &[Fitting::Placed; 2], [1.0, 1.0])?;
        let mut state = tube.at_rest();
        let [_, largest] = extreme(48_000.0, |volume| {
            state = to(&mut tube, &state, Inflation::Volume(volume), &[0.0, 0.0])?;
            Ok(state.pressure)
        })?;
        tally.relative(largest, 0.034_342_062_070, || "largest pressure".into());
        Ok(())
    })
}

/// A stress-free cylinder of radius 1 and length 2, stretched to 2 lz in the mesh. Its ends stay plane, and
/// one of them moves axially if it is free.
fn cylinder(lz: f64, is_closed: bool) -> Result<Solver, Trouble> {
    let mut mesh = revolved(|t| [1.0, 2.0 * lz * t], 4, true, Grading::Even);
    let nodes = &mesh.nodes;
    if let Some(wall) = mesh.blocks.first_mut() {
        wall.pattern = Some(wall.cells.iter().map(|node| [1.0, nodes[*node][2] / lz]).collect());
    }
    let level = plane([0.0, 0.0, 1.0]);
    // A plane in which every meridian lies constrains nothing, but marks the end as closed.
    let last = if is_closed { plane([0.0, 1.0, 0.0]) } else { level.clone() };
    let parts = [("wall", rubber(Law::NeoHooke { shear: 1.0 }))];
    solver(&mesh, &parts, &[("first", level), ("last", last)], &[], [1.0, 1.0])
}

/// Cylinders that remain cylindrical.
pub(crate) fn cylinders() -> Check {
    Claim {
        group: "membrane",
        name: "neo-Hookean cylinder, held length and closed ends: pressure, axial force, stretches, limit point",
        source: "closed form",
        tolerance: 1e-9,
        why: "an even stretch is within the elements; the table has 12 digits (the limit point's stretches 9)",
    }
    .run(|tally| {
        let cases = [(1.1_f64, 1.0_f64), (1.25, 1.0), (1.5, 1.0), (2.0, 1.0), (1.5, 1.2), (1.3, 0.9)];
        for (l, lz) in cases {
            let mut tube = cylinder(lz, false)?;
            let rest = tube.at_rest();
            let state = to(&mut tube, &rest, Inflation::Volume(PI * l * l * 2.0 * lz), &[])?;
            let exact = (1.0 - l.powi(-4) / (lz * lz)) / lz;
            tally.relative(state.pressure, exact, || format!("pressure, {l} and {lz}"));
            let fields = tube.fields(&state);
            let force = 2.0 * PI * l * fields.groups[0].sheets[0][1].force[0];
            let exact = 2.0 * PI * (lz - lz.powi(-3) * l.powi(-2));
            tally.relative(force, exact, || format!("axial force, {l} and {lz}"));
        }
        let mut tube = cylinder(1.0, true)?;
        let mut state = tube.at_rest();
        let closed = [
            [1.1, 1.006_450_741_209, 0.323_626_264_141],
            [1.3, 1.054_154_188_464, 0.649_735_909_791],
            [1.5, 1.138_601_389_019, 0.744_450_856_695],
        ];
        for [l, lz, pressure] in closed {
            state = to(&mut tube, &state, Inflation::Volume(PI * l * l * 2.0 * lz), &[])?;
            tally.relative(state.pressure, pressure, || format!("pressure, closed, {l}"));
            let fields = tube.fields(&state);
            tally.relative(fields.places[8][0], l, || format!("radius, closed, {l}"));
            tally.relative(fields.groups[0].sheets[0][1].stretch[0], lz, || format!("length, closed, {l}"));
        }
        let [_, pressure] = extreme(1.02 * state.volume, |volume| {
            state = to(&mut tube, &state, Inflation::Volume(volume), &[])?;
            Ok(state.pressure)
        })?;
        tally.relative(pressure, 0.749_867_673_058, || "largest pressure, closed".into());
        Ok(())
    })
}
