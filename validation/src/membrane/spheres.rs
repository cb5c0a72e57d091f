//! Rubber spheres by elements of revolution and by triangles.

use bulge_membrane::mesher::{Grading, Surface, grid, revolved};
use bulge_membrane::{Block, CellKind, Cloth, Gas, Inflation, Law, Mesh, Part, Sheet, Solver, Support};
use std::f64::consts::{FRAC_PI_2, PI};
use std::fmt::Write;

use super::rig::{extreme, order, plane, rubber, solver, to};
use super::{RUBBER, rows};
use crate::check::{Check, Claim, Trouble};

/// A sphere of R = 100 mm: pR/(mu H) = 2 (1/l - 1/l^7), also beyond its limit point.
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

/// Volume of a sphere of radius 1.
const SPHERE: f64 = 4.0 / 3.0 * PI;
const NEO_HOOKE: Law = Law::NeoHooke { shear: 1.0 };

/// p R/(mu H) at a stretch.
fn neo_hooke(l: f64) -> f64 {
    2.0 * (1.0 / l - l.powi(-7))
}

/// Half a sphere of radius 1, supported on its middle plane.
fn half(law: Law, elements: usize, is_quadratic: bool) -> Result<Solver, Trouble> {
    let circle = |t: f64| [(FRAC_PI_2 * t).cos(), (FRAC_PI_2 * t).sin()];
    let mesh = revolved(circle, elements, is_quadratic, Grading::Even);
    let supports = [("first", plane([0.0, 0.0, 1.0])), ("last", Support::Axis)];
    solver(&mesh, &[("wall", rubber(law))], &supports, &[], [1.0, 2.0])
}

/// The largest and the smallest pressure of a balloon.
pub(crate) fn limit_points() -> Check {
    Claim {
        group: "membrane",
        name: "limit points of a neo-Hookean sphere (l^6 = 7) and a Mooney-Rivlin one (two): pressure and volume",
        source: "closed form",
        tolerance: 1e-6,
        why: "48 quadratic elements; slopes by differences of fourth order",
    }
    .run(|tally| {
        let mooney = Law::MooneyRivlin { c1: 0.25, c2: 0.025 };
        // Stretch and pressure at the limit point, and a stretch to start from.
        let cases = [
            (NEO_HOOKE, 7.0_f64.powf(1.0 / 6.0), 1.239_462_902_399_12, 1.36),
            (mooney, 1.476_069_847_46, 0.745_308_777_84, 1.45),
            (mooney, 3.142_621_333_21, 0.631_811_248_909, 3.1),
        ];
        for (law, stretch, pressure, near) in cases {
            let mut sphere = half(law, 48, true)?;
            let rest = sphere.at_rest();
            let mut state = to(&mut sphere, &rest, Inflation::Volume(SPHERE * f64::powi(near, 3)), &[])?;
            let start = state.volume;
            let [volume, found] = extreme(start, |volume| {
                state = to(&mut sphere, &state, Inflation::Volume(volume), &[])?;
                Ok(state.pressure)
            })?;
            tally.relative(volume, SPHERE * f64::powi(stretch, 3), || format!("volume, l = {stretch}"));
            tally.relative(found, pressure, || format!("pressure, l = {stretch}"));
        }
        Ok(())
    })
}

/// A sphere with an enclosed amount of gas.
pub(crate) fn gas() -> Check {
    Claim {
        group: "membrane",
        name: "neo-Hookean sphere with twice its gas, isothermal and adiabatic: pressure and volume",
        source: "(p + pa) V^gamma = const. meets 2 (1/l - 1/l^7)",
        tolerance: 1e-6,
        why: "48 quadratic elements: fourth order",
    }
    .run(|tally| {
        let mut sphere = half(NEO_HOOKE, 48, true)?;
        let rest = sphere.at_rest();
        let start = to(&mut sphere, &rest, Inflation::Pressure(0.7), &[])?;
        for gamma in [1.0, 1.4] {
            let once = Gas::filling(start.volume, start.pressure, 2.0, gamma);
            let gas = Gas { constant: 2.0 * once.constant, ..once };
            let state = to(&mut sphere, &start, Inflation::Gas(gas), &[])?;
            // The gas alone exceeds the rubber at a stretch of 1 and is weaker at 3.
            let lacks = |l: f64| neo_hooke(l) + 2.0 - gas.constant * (SPHERE * l.powi(3)).powf(-gamma);
            let (mut low, mut high) = (1.0, 3.0);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if lacks(middle) < 0.0 { low = middle } else { high = middle }
            }
            tally.relative(state.pressure, neo_hooke(low), || format!("pressure, gamma = {gamma}"));
            tally.relative(state.volume, SPHERE * low.powi(3), || format!("volume, gamma = {gamma}"));
        }
        Ok(())
    })
}

/// An eighth of a sphere of radius 1 in n^2 triangles, n even: half of a grid on a square. Groups: those of
/// the grid, and `equator`.
fn octant(n: usize, is_quadratic: bool) -> Mesh {
    let place = |u: f64, v: f64| {
        let w = 1.0 - u - v;
        let size = (u * u + v * v + w * w).sqrt();
        [u / size, v / size, w / size]
    };
    let mut mesh = grid(&Surface { place: &place, pattern: None, cells: [n, n], is_quadratic });
    let height = |node: usize| mesh.nodes[node][2];
    let kept = |block: &Block| -> Vec<usize> {
        let cells = block.cells.chunks_exact(block.kind.nodes());
        cells.filter(|cell| cell.iter().all(|node| height(*node) > -1e-9)).flatten().copied().collect()
    };
    let blocks: Vec<Block> = mesh
        .blocks
        .iter()
        .filter(|block| ["cloth", "u0", "v0"].contains(&block.group.as_str()))
        .map(|block| Block { cells: kept(block), ..block.clone() })
        .collect();
    let equator: Vec<usize> = (0..mesh.nodes.len()).filter(|node| height(*node).abs() < 1e-9).collect();
    mesh.blocks = blocks;
    mesh.blocks.push(Block {
        group: "equator".to_owned(),
        kind: CellKind::Point,
        numbers: vec![0; equator.len()],
        cells: equator,
        pattern: None,
    });
    mesh
}

fn of_triangles(n: usize, is_quadratic: bool) -> Result<Solver, Trouble> {
    let sheet = Sheet { cloth: Cloth::Isotropic(NEO_HOOKE), wrinkles: true, residual: 0.0 };
    solver(
        &octant(n, is_quadratic),
        &[("cloth", Part::Membrane { sheet: Some(sheet), warp: [0.0, 0.0, 1.0] })],
        &[
            ("u0", plane([1.0, 0.0, 0.0])),
            ("v0", plane([0.0, 1.0, 0.0])),
            ("equator", plane([0.0, 0.0, 1.0])),
        ],
        &[],
        [4.0, 2.0],
    )
}

/// Pressures of a sphere at increasing stretches.
fn pressures(mut sphere: Solver, stretches: &[f64]) -> Result<Vec<f64>, Trouble> {
    let rest = sphere.at_rest();
    let mut state = to(&mut sphere, &rest, Inflation::Pressure(0.7), &[])?;
    let mut found = Vec::new();
    for l in stretches {
        state = to(&mut sphere, &state, Inflation::Volume(SPHERE * l.powi(3)), &[])?;
        found.push(state.pressure);
    }
    Ok(found)
}

/// Triangles in space.
pub(crate) fn triangles() -> Check {
    Claim {
        group: "membrane",
        name: "the neo-Hookean sphere by triangles with three and six nodes: pressure, and its limit point",
        source: "closed form",
        tolerance: 1e-3,
        why: "2304 linear triangles on an octant, 64 quadratic ones",
    }
    .run(|tally| {
        let stretches = [1.2, 2.0, 3.0];
        for (n, is_quadratic, nodes) in [(48, false, 3), (8, true, 6)] {
            let found = pressures(of_triangles(n, is_quadratic)?, &stretches)?;
            for (pressure, l) in found.into_iter().zip(stretches) {
                tally.relative(pressure, neo_hooke(l), || format!("{nodes} nodes, stretch {l}"));
            }
        }
        let mut sphere = of_triangles(8, true)?;
        let rest = sphere.at_rest();
        let blown = to(&mut sphere, &rest, Inflation::Pressure(0.7), &[])?;
        let mut state = to(&mut sphere, &blown, Inflation::Volume(2.55 * SPHERE), &[])?;
        let [volume, pressure] = extreme(2.55 * SPHERE, |volume| {
            state = to(&mut sphere, &state, Inflation::Volume(volume), &[])?;
            Ok(state.pressure)
        })?;
        tally.relative(volume, 7.0_f64.sqrt() * SPHERE, || "volume at the limit".into());
        tally.relative(pressure, 1.239_462_902_399_12, || "pressure at the limit".into());
        Ok(())
    })
}

/// Makes a sphere from a number of elements, which are quadratic or not.
type Make = fn(usize, bool) -> Result<Solver, Trouble>;

/// Order of the error.
pub(crate) fn orders() -> Check {
    Claim {
        group: "membrane",
        name: "order of convergence of the sphere's pressure, revolved and by triangles: 2 linear, 4 quadratic",
        source: "closed form",
        tolerance: 0.2,
        why: "quadratic triangles are not yet asymptotic to more",
    }
    .run(|tally| {
        let cases: [(&str, Make, bool, [usize; 3]); 4] = [
            ("revolved, 2 nodes", |n, is_quadratic| half(NEO_HOOKE, n, is_quadratic), false, [12, 24, 48]),
            ("revolved, 3 nodes", |n, is_quadratic| half(NEO_HOOKE, n, is_quadratic), true, [6, 12, 24]),
            ("triangles, 3 nodes", of_triangles, false, [8, 16, 32]),
            ("triangles, 6 nodes", of_triangles, true, [8, 16, 32]),
        ];
        for (name, make, is_quadratic, meshes) in cases {
            let mut errors = Vec::new();
            for n in meshes {
                let found = pressures(make(n, is_quadratic)?, &[1.5])?;
                errors.push(found[0] - neo_hooke(1.5));
            }
            order(tally, name, &errors, if is_quadratic { 4.0 } else { 2.0 });
        }
        Ok(())
    })
}
