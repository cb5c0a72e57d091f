//! Membranes of triangles against exact solutions and values converged elsewhere.

use bulge_membrane::mesher::{Pleated, Surface, grid};
use bulge_membrane::{
    Cloth, Copies, Fitting, Inflation, Law, Load, Mesh, Part, Sheet, Solver, State, Structure, Support,
    Thread, Tolerance,
};
use std::f64::consts::{FRAC_PI_2, PI};

fn cloth(stiffness: f64, poisson: f64) -> Sheet {
    let law = Law::SaintVenantKirchhoff { stiffness, poisson };
    Sheet { cloth: Cloth::Isotropic(law), wrinkles: true, residual: 1e-6 }
}

fn named<T: Clone>(all: &[(&str, T)]) -> Vec<(String, T)> {
    all.iter().map(|(name, value)| ((*name).to_owned(), value.clone())).collect()
}

fn plane(x: f64, y: f64, z: f64) -> Support {
    Support::Plane { normal: [x, y, z] }
}

fn solver(
    mesh: &Mesh,
    parts: &[(&str, Part)],
    supports: &[(&str, Support)],
    fittings: &[Fitting],
    copies: [f64; 2],
) -> Solver {
    let structure = Structure::new(mesh, &named(parts), &named(supports), fittings).unwrap();
    Solver::new(structure, Copies { around: copies[0], along: copies[1] }, Tolerance::default()).unwrap()
}

fn follow(solver: &mut Solver, from: &State, pressure: f64, fittings: Vec<f64>) -> State {
    let before = Load { inflation: Inflation::Pressure(from.pressure), fittings: from.fittings.clone() };
    let load = Load { inflation: Inflation::Pressure(pressure), fittings };
    solver.follow(&before, from, &load, |_, _| ()).unwrap()
}

/// N fibres without stretch, flat facets without stiffness: the pleated muscle times sin(2 pi/N)/(2 pi/N).
#[test]
fn fibres_and_facets() {
    for (n, force) in [(6, 1355.26934), (12, 1564.93024), (24, 1620.13500)] {
        for elements in [20, 40] {
            let muscle = Pleated {
                fibres: n,
                radius: 16.0,
                length: 110.0,
                circumference: 2.0 * PI * 16.0,
                depth: 0.0,
                cells: [1, elements],
                is_quadratic: false,
            };
            let mut mesh = muscle.lobe();
            for block in &mut mesh.blocks {
                block.pattern = None;
            }
            let angle = 2.0 * PI / n as f64;
            let mut solver = solver(
                &mesh,
                &[
                    ("cloth", Part::Membrane { sheet: None, warp: [0.0, 0.0, 1.0] }),
                    ("fibre", Part::Cable { thread: Thread::Inextensible, share: 1.0 }),
                ],
                &[
                    ("top", Support::Cyclic { partner: "fibre".to_owned(), angle }),
                    ("middle", plane(0.0, 0.0, 1.0)),
                    ("end", Support::Fitting { fitting: 0 }),
                ],
                &[Fitting::Placed],
                [n as f64, 2.0],
            );
            let rest = solver.at_rest();
            let state = follow(&mut solver, &rest, 0.3, vec![-11.0]);
            println!(
                "{n} {elements} {:e} it {} unstable {} {:?}",
                state.forces[0] / force - 1.0,
                state.iterations,
                state.unstable,
                solver.effort()
            );
        }
    }
}

#[test]
fn a_sector_of_cloth() {
    for (n, force, volume) in [(8, 884.25, 479_439.0), (12, 1064.44, 456_851.0), (24, 1320.17, 422_513.0)] {
        let muscle = Pleated {
            fibres: n,
            radius: 16.0,
            length: 110.0,
            circumference: 288.0,
            depth: 0.0,
            cells: [40, 12],
            is_quadratic: false,
        };
        let muscle = Pleated { cells: [12, 40], ..muscle };
        let mesh = muscle.half_lobe();
        let a = PI / n as f64;
        let mut solver = solver(
            &mesh,
            &[
                ("cloth", Part::Membrane { sheet: Some(cloth(50.0, 0.3)), warp: [0.0, 1.0, 0.0] }),
                ("fibre", Part::Cable { thread: Thread::Elastic { stiffness: 12e6 / n as f64 }, share: 0.5 }),
            ],
            &[
                ("fibre", plane(0.0, 1.0, 0.0)),
                ("top", plane(-a.sin(), a.cos(), 0.0)),
                ("middle", plane(0.0, 0.0, 1.0)),
                ("end", Support::Fitting { fitting: 0 }),
            ],
            &[Fitting::Placed],
            [2.0 * n as f64, 2.0],
        );
        let clock = std::time::Instant::now();
        let rest = solver.at_rest();
        let state = follow(&mut solver, &rest, 0.3, vec![-11.0]);
        println!(
            "{n} {:.3e} {:.3e} it {} unstable {} {:?} {:?}",
            state.forces[0] / force - 1.0,
            state.volume / volume - 1.0,
            state.iterations,
            state.unstable,
            solver.effort(),
            clock.elapsed()
        );
    }
}

#[test]
fn a_square_airbag() {
    let half = 848.53 / 2.0;
    for n in [10, 20, 40] {
        let mesh = grid(&Surface {
            place: &|u, v| [half * u, half * v, 0.0],
            pattern: None,
            cells: [n, n],
            is_quadratic: false,
        });
        let mut solver = solver(
            &mesh,
            &[("cloth", Part::Membrane { sheet: Some(cloth(588.0 * 0.6, 0.4)), warp: [1.0, 0.0, 0.0] })],
            &[
                ("u0", plane(1.0, 0.0, 0.0)),
                ("v0", plane(0.0, 1.0, 0.0)),
                ("u1", plane(0.0, 0.0, 1.0)),
                ("v1", plane(0.0, 0.0, 1.0)),
            ],
            &[],
            [4.0, 2.0],
        );
        let clock = std::time::Instant::now();
        let rest = solver.at_rest();
        let state = follow(&mut solver, &rest, 5e-3, vec![]);
        println!(
            "{n} {:.6e} it {} unstable {} {:?} {:?}",
            state.volume,
            state.iterations,
            state.unstable,
            solver.effort(),
            clock.elapsed()
        );
    }
    let _ = FRAC_PI_2;
}
