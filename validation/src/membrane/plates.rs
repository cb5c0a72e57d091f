//! Sheets that resist bending: rectangular plates.

use bulge_membrane::mesher::{Surface, grid};
use bulge_membrane::{Cloth, Copies, Inflation, Law, Part, Sheet, Solver, Structure, Support, Tolerance};
use core::f64::consts::{FRAC_PI_2, PI};

use super::rig::{order, plane, to};
use crate::check::{Check, Claim, Trouble};

/// D of a sheet that hardly stretches, and a pressure under which it hardly bends.
const BENDING: f64 = 0.8;
const STIFFNESS: f64 = 1e4;
const PRESSURE: f64 = 1e-7;

/// Deflection of the middle and volume under a rectangular plate of sides 10 and 10 `ratio`, whose edges are held and free to
/// turn, and its energy; a quarter is meshed, with so many cells along its sides.
fn plate(ratio: f64, cells: usize) -> Result<[f64; 3], Trouble> {
    let place = |u: f64, v: f64| [5.0 * u, 5.0 * ratio * v, 0.0];
    let mesh = grid(&Surface { place: &place, pattern: None, cells: [cells; 2], is_quadratic: false });
    let law = Law::SaintVenantKirchhoff { stiffness: STIFFNESS, poisson: 0.3 };
    let sheet = Sheet { cloth: Cloth::Isotropic(law), wrinkles: false, residual: 0.0 };
    let group = "cloth".to_owned();
    let parts = [(group.clone(), Part::Membrane { sheet: Some(sheet), warp: [1.0, 0.0, 0.0] })];
    let held = |name: &str, normal: [f64; 3]| (name.to_owned(), plane(normal));
    let supports: [(String, Support); 4] = [
        held("u0", [1.0, 0.0, 0.0]),
        held("v0", [0.0, 1.0, 0.0]),
        held("u1", [0.0, 0.0, 1.0]),
        held("v1", [0.0, 0.0, 1.0]),
    ];
    let structure = Structure::new(&mesh, &parts, &supports, &[])?;
    let structure = structure.resisting_bending(&mesh, &supports, &[(group, BENDING)])?;
    let mut solver = Solver::new(structure, Copies { around: 4.0, along: 1.0 }, Tolerance::default())?;
    let rest = solver.at_rest();
    let state = to(&mut solver, &rest, Inflation::Pressure(PRESSURE), &[])?;
    let middle = solver.fields(&state).places.first().map_or(f64::NAN, |place| place[2].abs());
    Ok([middle, state.volume, state.energy])
}

/// Navier's double series for the middle and the volume.
fn exact(ratio: f64) -> [f64; 2] {
    let [a, b] = [10.0, 10.0 * ratio];
    let (mut middle, mut volume) = (0.0, 0.0);
    for m in (1..200).step_by(2) {
        for n in (1..200).step_by(2) {
            let [m, n] = [f64::from(m), f64::from(n)];
            let bent = ((m / a).powi(2) + (n / b).powi(2)).powi(2);
            let size = 16.0 * PRESSURE / (PI.powi(6) * BENDING * m * n * bent);
            middle += size * (FRAC_PI_2 * m).sin() * (FRAC_PI_2 * n).sin();
            volume += size * 4.0 * a * b / (PI * PI * m * n);
        }
    }
    [middle, volume]
}

pub(crate) fn rectangles() -> Check {
    Claim {
        group: "membrane",
        name: "plates with free hinges, b/a = 1, 1.5, 2: middle, volume, energy = p V/2",
        source: "Navier's series",
        tolerance: 3e-3,
        why: "small deflections; 24 x 24 cells on a quarter",
    }
    .run(|tally| {
        for ratio in [1.0, 1.5, 2.0] {
            let ([middle, volume, energy], [w, v]) = (plate(ratio, 24)?, exact(ratio));
            tally.relative(middle, w, || format!("middle, b/a = {ratio}"));
            tally.relative(volume, v, || format!("volume, b/a = {ratio}"));
            tally.relative(energy, 0.5 * PRESSURE * volume, || format!("energy, b/a = {ratio}"));
        }
        Ok(())
    })
}

pub(crate) fn orders() -> Check {
    Claim {
        group: "membrane",
        name: "order of convergence of the same plates: 2",
        source: "Navier's series",
        tolerance: 0.1,
        why: "linear elements; 6, 12 and 24 cells",
    }
    .run(|tally| {
        for ratio in [1.0, 2.0] {
            let [w, v] = exact(ratio);
            let found = [6, 12, 24].map(|cells| plate(ratio, cells));
            let (mut middles, mut volumes) = (Vec::new(), Vec::new());
            for found in found {
                let [middle, volume, _] = found?;
                middles.push((middle / w - 1.0).abs());
                volumes.push((volume / v - 1.0).abs());
            }
            order(tally, &format!("middle, b/a = {ratio}"), &middles, 2.0);
            order(tally, &format!("volume, b/a = {ratio}"), &volumes, 2.0);
        }
        Ok(())
    })
}
