//! Helpers for the cases that are not described by a file.

use bulge_membrane::{
    Cloth, Copies, Fitting, Gas, Inflation, Law, Load, Mesh, Part, RingLayer, Sheet, Solver, State,
    Structure, Support, Tolerance,
};

use crate::check::{Tally, Trouble};

/// A rubber membrane of revolution.
pub(super) fn rubber(law: Law) -> Part {
    let sheet = Sheet { cloth: Cloth::Isotropic(law), wrinkles: false, residual: 0.0 };
    Part::Revolved { layers: vec![RingLayer::Sheet { sheet, fullness: 1.0 }] }
}

pub(super) fn plane(normal: [f64; 3]) -> Support {
    Support::Plane { normal }
}

fn named<T: Clone>(all: &[(&str, T)]) -> Vec<(String, T)> {
    all.iter().map(|(name, value)| ((*name).to_owned(), value.clone())).collect()
}

/// A solver from parts and supports by the groups of the mesh; copies around and along.
pub(super) fn solver(
    mesh: &Mesh,
    parts: &[(&str, Part)],
    supports: &[(&str, Support)],
    fittings: &[Fitting],
    [around, along]: [f64; 2],
) -> Result<Solver, Trouble> {
    let structure = Structure::new(mesh, &named(parts), &named(supports), fittings)?;
    Ok(Solver::new(structure, Copies { around, along }, Tolerance::default())?)
}

/// Moves from one state to another.
pub(super) fn to(
    solver: &mut Solver,
    from: &State,
    inflation: Inflation,
    fittings: &[f64],
) -> Result<State, Trouble> {
    let before = match inflation {
        Inflation::Pressure(_) => Inflation::Pressure(from.pressure),
        Inflation::Volume(_) => Inflation::Volume(from.volume),
        Inflation::Gas(gas) => {
            Inflation::Gas(Gas::filling(from.volume, from.pressure, gas.ambient, gas.gamma))
        }
    };
    let before = Load { inflation: before, fittings: from.fittings.clone() };
    let load = Load { inflation, fittings: fittings.to_vec() };
    Ok(solver.follow(&before, from, &load, |_, _| ())?)
}

/// Position and value of the extremum of f near x, by Newton's method with slopes by differences of fourth
/// order.
pub(super) fn extreme(
    mut x: f64,
    mut f: impl FnMut(f64) -> Result<f64, Trouble>,
) -> Result<[f64; 2], Trouble> {
    for _ in 0..6 {
        let h = 0.01 * x;
        let mut at = |k: f64| f(x + k * h);
        let [a, b, c, d, e] = [at(-2.0)?, at(-1.0)?, at(0.0)?, at(1.0)?, at(2.0)?];
        let (slope, bend) = (8.0 * (d - b) - (e - a), 16.0 * (b + d) - (a + e) - 30.0 * c);
        let step = (slope / bend).clamp(-4.0, 4.0) * h;
        x -= step;
        if step.abs() < 1e-8 * x {
            break;
        }
    }
    Ok([x, f(x)?])
}

/// Tallies the order of the errors over meshes that are each twice as fine as the previous one.
pub(super) fn order(tally: &mut Tally, name: &str, errors: &[f64], expected: f64) {
    for pair in errors.windows(2) {
        let observed = (pair[0] / pair[1]).log2();
        tally.absolute(observed, expected, || format!("{name}: {observed:.2}"));
    }
}
