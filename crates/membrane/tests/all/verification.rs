//! Equilibria against exact solutions: closed forms, elliptic integrals, quadratures and shooting at 1e-13. Lengths in mm, forces in N,
//! pressures in MPa where a case has units at all.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use bulge_membrane::mesher::{Grading, Surface, grid, revolved};
use bulge_membrane::{
    Block, CellKind, Cloth, Copies, Fields, Fitting, Gas, Inflation, Law, Load, MembraneError, Mesh, Part,
    RingLayer, Sheet, Solver, State, Structure, Support, Tension, Thread, Tolerance,
};
use std::f64::consts::{FRAC_PI_2, PI};

// ---- tools

fn rubber(law: Law) -> RingLayer {
    let sheet = Sheet { cloth: Cloth::Isotropic(law), wrinkles: false, residual: 0.0 };
    RingLayer::Sheet { sheet, fullness: 1.0 }
}

/// Inextensible threads at an angle to the meridian.
fn net(angle: f64) -> RingLayer {
    RingLayer::Threads { thread: Thread::Inextensible, count: 40.0, angle }
}

fn plane(x: f64, y: f64, z: f64) -> Support {
    Support::Plane { normal: [x, y, z] }
}

fn named<T: Clone>(all: &[(&str, T)]) -> Vec<(String, T)> {
    all.iter().map(|(name, value)| ((*name).to_owned(), value.clone())).collect()
}

fn solver_of(
    mesh: &Mesh,
    parts: &[(&str, Part)],
    supports: &[(&str, Support)],
    fittings: &[Fitting],
    copies: Copies,
) -> Solver {
    let structure = Structure::new(mesh, &named(parts), &named(supports), fittings).unwrap();
    Solver::new(structure, copies, Tolerance::default()).unwrap()
}

/// The wall of a mesh of revolution from one fitting to another, the second of the given kind.
fn clamped(mesh: &Mesh, layers: Vec<RingLayer>, last: Fitting) -> Solver {
    let supports = [("first", Support::Fitting { fitting: 0 }), ("last", Support::Fitting { fitting: 1 })];
    let parts = [("wall", Part::Revolved { layers })];
    solver_of(mesh, &parts, &supports, &[Fitting::Placed, last], Copies::ONE)
}

fn under(inflation: Inflation, fittings: &[f64]) -> Load {
    Load { inflation, fittings: fittings.to_vec() }
}

/// From a state to a pressure, with the fittings placed.
fn to_pressure(solver: &mut Solver, from: &State, pressure: f64, fittings: &[f64]) -> State {
    let before = under(Inflation::Pressure(from.pressure), &from.fittings);
    solver.follow(&before, from, &under(Inflation::Pressure(pressure), fittings), |_, _| ()).unwrap()
}

/// From a state to a volume, with the fittings where they are.
fn to_volume(solver: &mut Solver, from: &State, volume: f64) -> State {
    let before = under(Inflation::Volume(from.volume), &from.fittings);
    solver.follow(&before, from, &under(Inflation::Volume(volume), &from.fittings), |_, _| ()).unwrap()
}

/// A line of the table: the relative error, which is checked.
#[track_caller]
fn line(case: &str, value: f64, exact: f64, tolerance: f64) {
    let error = value / exact - 1.0;
    println!("{case:<58} {value:>20.12} {error:>10.1e}");
    assert!(error.abs() <= tolerance, "{case}: {value} instead of {exact}: {error:.2e} of {tolerance:.0e}");
}

/// The order of convergence over meshes that are refined by two, and the extrapolated value.
#[track_caller]
fn order(case: &str, values: [f64; 3], exact: f64, range: core::ops::Range<f64>) {
    let errors = values.map(|value| value / exact - 1.0);
    let orders = [(errors[0] / errors[1]).log2(), (errors[1] / errors[2]).log2()];
    println!("{case:<58} order {:.3} {:.3}, errors {errors:?}", orders[0], orders[1]);
    assert!(range.contains(&orders[1]), "{case}: {orders:?} {errors:?}");
}

/// Extrapolates from two meshes, one twice as fine, to zero element size.
fn extrapolated(coarse: f64, fine: f64, order: i32) -> f64 {
    fine + (fine - coarse) / (2.0_f64.powi(order) - 1.0)
}

/// The maximum (`sign` 1) or minimum (-1) of f between a and b: the root of its slope, from fourth-order
/// differences.
fn extreme(mut f: impl FnMut(f64) -> f64, a: f64, b: f64) -> (f64, f64) {
    let h = 2e-3 * (a + b);
    let mut slope = |x: f64| (8.0 * (f(x + h) - f(x - h)) - (f(x + 2.0 * h) - f(x - 2.0 * h))) / (12.0 * h);
    let (mut a, mut b) = (a, b);
    let (mut fa, mut fb) = (slope(a), slope(b));
    assert!(fa * fb < 0.0, "no extreme between {a} and {b}");
    // The Illinois method.
    let mut last = 0;
    let mut x = a;
    for _ in 0..40 {
        let next = (a * fb - b * fa) / (fb - fa);
        let is_done = (next - x).abs() < 1e-9 * x.abs();
        x = next;
        if is_done {
            break;
        }
        let fx = slope(x);
        if fx * fb < 0.0 {
            (a, fa) = (b, fb);
            last = 0;
        } else {
            last += 1;
            if last > 0 {
                fa *= 0.5;
            }
        }
        (b, fb) = (x, fx);
    }
    (x, f(x))
}

/// The root of f from two guesses, by the secant method.
fn root(mut f: impl FnMut(f64) -> f64, mut a: f64, mut b: f64) -> f64 {
    let mut fa = f(a);
    for _ in 0..30 {
        let fb = f(b);
        if (b - a).abs() < 1e-13 * b.abs() || (fb - fa).abs() < f64::MIN_POSITIVE {
            break;
        }
        (a, b, fa) = (b, b - fb * (b - a) / (fb - fa), fb);
    }
    b
}

// ---- spheres

/// Half a sphere of radius 1 on its middle plane.
fn half_sphere(law: Law, elements: usize, is_quadratic: bool) -> Solver {
    let circle = |t: f64| [(FRAC_PI_2 * t).cos().max(0.0), (FRAC_PI_2 * t).sin()];
    let mesh = revolved(circle, elements, is_quadratic, Grading::Even);
    let parts = [("wall", Part::Revolved { layers: vec![rubber(law)] })];
    let supports = [("first", plane(0.0, 0.0, 1.0)), ("last", Support::Axis)];
    solver_of(&mesh, &parts, &supports, &[], Copies { around: 1.0, along: 2.0 })
}

const SPHERE: f64 = 4.0 / 3.0 * PI;

#[test]
fn a_sphere_of_neo_hooke() {
    // p R/(mu H) = 2 (1/l - 1/l^7), the largest at l^6 = 7.
    let mut solver = half_sphere(Law::NeoHooke { shear: 1.0 }, 48, true);
    let mut state = solver.at_rest();
    for (stretch, pressure) in [
        (1.1_f64, 0.791_865_581_720_405),
        (1.25, 1.180_569_6),
        (1.5, 1.216_278_006_401_46),
        (2.0, 0.984_375),
        (3.0, 0.665_752_171_925_011),
        (5.0, 0.399_974_4),
    ] {
        state = to_volume(&mut solver, &state, SPHERE * stretch.powi(3));
        line(&format!("sphere neo-Hooke l = {stretch}: p"), state.pressure, pressure, 1e-6);
        assert_eq!(state.unstable, 0, "stable at a given volume");
    }
    let rest = solver.at_rest();
    let start = to_volume(&mut solver, &rest, SPHERE * 2.0);
    let (volume, pressure) =
        extreme(|v| to_volume(&mut solver, &start, v).pressure, SPHERE * 2.2, SPHERE * 3.2);
    line("sphere neo-Hooke limit point: V/V0", volume / SPHERE, 7.0_f64.sqrt(), 1e-5);
    line("sphere neo-Hooke limit point: p", pressure, 1.239_462_902_399_12, 1e-6);
}

#[test]
fn a_sphere_of_neo_hooke_converges() {
    for (is_quadratic, meshes, range) in [(false, [12, 24, 48], 1.9..2.1), (true, [6, 12, 24], 3.8..4.2)] {
        let values = meshes.map(|elements| {
            let mut solver = half_sphere(Law::NeoHooke { shear: 1.0 }, elements, is_quadratic);
            let rest = solver.at_rest();
            to_volume(&mut solver, &rest, SPHERE * 1.5_f64.powi(3)).pressure
        });
        order(
            &format!("sphere p at l = 1.5, quadratic: {is_quadratic}"),
            values,
            1.216_278_006_401_46,
            range,
        );
    }
}

#[test]
fn a_sphere_of_mooney_rivlin_has_two_limit_points() {
    // p = 4 (1/l - 1/l^7)(c1 + c2 l^2).
    let law = Law::MooneyRivlin { c1: 0.25, c2: 0.025 };
    let mut solver = half_sphere(law, 48, true);
    let rest = solver.at_rest();
    let state = to_volume(&mut solver, &rest, SPHERE * 8.0);
    line("sphere Mooney-Rivlin l = 2: p", state.pressure, 0.689_062_5, 1e-6);
    for (name, stretch, pressure, from, to) in [
        ("largest", 1.476_069_847_46_f64, 0.745_308_777_84, 1.35, 1.65),
        ("smallest", 3.142_621_333_21, 0.631_811_248_909, 2.8, 3.5),
    ] {
        let (from, to) = (SPHERE * f64::powi(from, 3), SPHERE * f64::powi(to, 3));
        let (volume, found) = extreme(|v| to_volume(&mut solver, &state, v).pressure, from, to);
        line(&format!("sphere Mooney-Rivlin {name} p: l"), (volume / SPHERE).cbrt(), stretch, 1e-5);
        line(&format!("sphere Mooney-Rivlin {name} p"), found, pressure, 1e-6);
    }
}

/// An eighth of a sphere of radius 1 in n^2 triangles, their nodes on it; `x`, `y`, `z` are its edges on the coordinate planes.
fn octant(n: usize, is_quadratic: bool) -> Mesh {
    let each = if is_quadratic { 2 } else { 1 };
    let all = each * n;
    let mut mesh = Mesh::default();
    let mut edges = [Vec::new(), Vec::new(), Vec::new()];
    for (i, j) in (0..=all).flat_map(|i| (0..=all - i).map(move |j| (i, j))) {
        let counts = [all - i - j, i, j];
        let [x, y, z] = counts.map(|k| k as f64);
        let size = (x * x + y * y + z * z).sqrt();
        for (edge, k) in edges.iter_mut().zip(counts) {
            if k == 0 {
                edge.push(mesh.nodes.len());
            }
        }
        mesh.nodes.push([x / size, y / size, z / size]);
        mesh.numbers.push(mesh.nodes.len() as u64);
    }
    // Row i has all + 1 - i nodes.
    let number = |i: usize, j: usize| i * (all + 1) - i * i.saturating_sub(1) / 2 + j;
    let mut cells = Vec::new();
    let mut push = |corners: [[usize; 2]; 3]| {
        cells.extend(corners.map(|[i, j]| number(each * i, each * j)));
        if is_quadratic {
            cells.extend((0..3).map(|k| {
                let ([i, j], [l, m]) = (corners[k], corners[(k + 1) % 3]);
                number(i + l, j + m)
            }));
        }
    };
    for i in 0..n {
        for j in 0..n - i {
            push([[i, j], [i + 1, j], [i, j + 1]]);
            if i + j + 2 <= n {
                push([[i + 1, j], [i + 1, j + 1], [i, j + 1]]);
            }
        }
    }
    let block = |group: &str, kind: CellKind, cells: Vec<usize>| {
        let numbers = (1..=(cells.len() / kind.nodes()) as u64).collect();
        Block { group: group.to_owned(), kind, cells, numbers, pattern: None }
    };
    let kind = if is_quadratic { CellKind::Triangle6 } else { CellKind::Triangle3 };
    mesh.blocks.push(block("cloth", kind, cells));
    for (name, edge) in ["x", "y", "z"].into_iter().zip(edges) {
        mesh.blocks.push(block(name, CellKind::Point, edge));
    }
    mesh
}

fn octant_solver(law: Law, n: usize, is_quadratic: bool) -> Solver {
    let sheet = Sheet { cloth: Cloth::Isotropic(law), wrinkles: true, residual: 0.0 };
    solver_of(
        &octant(n, is_quadratic),
        &[("cloth", Part::Membrane { sheet: Some(sheet), warp: [0.0, 0.0, 1.0] })],
        &[("x", plane(1.0, 0.0, 0.0)), ("y", plane(0.0, 1.0, 0.0)), ("z", plane(0.0, 0.0, 1.0))],
        &[],
        Copies { around: 4.0, along: 2.0 },
    )
}

#[test]
fn a_sphere_of_triangles() {
    let law = Law::NeoHooke { shear: 1.0 };
    for (is_quadratic, meshes, range) in [(false, [12, 24, 48], 1.9..2.1), (true, [3, 6, 12], 3.5..4.3)] {
        for (stretch, exact) in [(1.2_f64, 2.0 * (1.2_f64.powi(-1) - 1.2_f64.powi(-7))), (2.0, 0.984_375)] {
            let values = meshes.map(|n| {
                let mut solver = octant_solver(law, n, is_quadratic);
                let rest = solver.at_rest();
                let blown = to_pressure(&mut solver, &rest, 0.7, &[]);
                let state = to_volume(&mut solver, &blown, SPHERE * stretch.powi(3));
                assert_eq!(state.unstable, 0);
                state.pressure
            });
            let case = format!("sphere of triangles, l = {stretch}, quadratic: {is_quadratic}");
            order(&case, values, exact, range.clone());
            line(&case, values[2], exact, 1e-3);
        }
    }
    // The largest pressure.
    let mut solver = octant_solver(law, 12, true);
    let rest = solver.at_rest();
    let blown = to_pressure(&mut solver, &rest, 0.7, &[]);
    let start = to_volume(&mut solver, &blown, SPHERE * 2.0);
    let (volume, pressure) =
        extreme(|v| to_volume(&mut solver, &start, v).pressure, SPHERE * 2.2, SPHERE * 3.2);
    line("sphere of triangles, limit point: V/V0", volume / SPHERE, 7.0_f64.sqrt(), 1e-3);
    line("sphere of triangles, limit point: p", pressure, 1.239_462_902_399_12, 1e-3);
}

#[test]
fn a_sphere_filled_with_gas() {
    // p (V) of the membrane meets p (V) of the gas: isothermal, then adiabatic.
    let mut solver = half_sphere(Law::NeoHooke { shear: 1.0 }, 48, true);
    let rest = solver.at_rest();
    let start = to_pressure(&mut solver, &rest, 0.7, &[]);
    for gamma in [1.0, 1.4] {
        let ambient = 2.0;
        let gas = Gas::filling(start.volume, start.pressure, ambient, gamma);
        let twice = Gas { constant: 2.0 * gas.constant, ..gas };
        let same = solver.solve(&under(Inflation::Gas(gas), &[]), &start).unwrap();
        line(&format!("sphere of gas, gamma = {gamma}: V again"), same.volume, start.volume, 1e-10);
        let state = solver
            .follow(&under(Inflation::Gas(gas), &[]), &start, &under(Inflation::Gas(twice), &[]), |_, _| ())
            .unwrap();
        let constant = (state.pressure + ambient) * state.volume.powf(gamma);
        line(&format!("sphere of gas, gamma = {gamma}: p V^gamma"), constant, twice.constant, 1e-10);
        let l = (state.volume / SPHERE).cbrt();
        line(
            &format!("sphere of gas, gamma = {gamma}: p"),
            state.pressure,
            2.0 * (1.0 / l - l.powi(-7)),
            1e-6,
        );
        assert_eq!(state.unstable, 0);
    }
}

#[test]
fn stability_of_a_sphere_past_its_limit_point() {
    let mut solver = half_sphere(Law::NeoHooke { shear: 1.0 }, 24, true);
    let rest = solver.at_rest();
    let past = to_volume(&mut solver, &rest, SPHERE * 8.0);
    assert_eq!(past.unstable, 0, "at a given volume it can't run away");
    // It can at constant pressure; a small, closed amount of gas prevents it.
    let under_pressure = solver.solve(&under(Inflation::Pressure(past.pressure), &[]), &past);
    println!(
        "sphere past its limit point under pressure: {:?}",
        under_pressure.as_ref().map(|s| (s.unstable, s.volume / SPHERE))
    );
    let gas = Gas::filling(past.volume, past.pressure, 1.0, 1.0);
    let held = solver.solve(&under(Inflation::Gas(gas), &[]), &past).unwrap();
    assert_eq!(held.unstable, 0);
    line("sphere past its limit point, held by gas: V", held.volume, past.volume, 1e-9);
    // Beyond the limit there is an error that says so.
    let load = under(Inflation::Pressure(1.3), &[]);
    let error = solver.follow(&under(Inflation::Pressure(0.0), &[]), &rest, &load, |_, _| ()).unwrap_err();
    println!("{error}");
    let MembraneError::LimitPoint { last, .. } = error else { panic!("{error}") };
    line("sphere: last pressure before the limit", last, 1.239_462_902_399_12, 2e-3);
    assert!(last < 1.239_463);
}

// ---- cylinders

#[test]
fn a_cylinder_of_neo_hooke() {
    // Fixed axial stretch: p R/(mu H) = (1 - 1/(l^4 lz^2))/lz. The ends stay on their planes and may widen.
    let exact = |l: f64, lz: f64| (1.0 - l.powi(-4) / (lz * lz)) / lz;
    for (l, lz, known) in [
        (1.1, 1.0, 0.316_986_544_635),
        (1.25, 1.0, 0.5904),
        (1.5, 1.0, 0.802_469_135_802),
        (2.0, 1.0, 0.9375),
        (1.5, 1.2, exact(1.5, 1.2)),
        (1.3, 0.9, exact(1.3, 0.9)),
    ] {
        let mut mesh = revolved(|t| [1.0, 2.0 * lz * t], 4, true, Grading::Even);
        // The stress-free length is 2: r and z of the nodes of each cell.
        let wall = &mut mesh.blocks[0];
        wall.pattern = Some(wall.cells.iter().map(|node| [1.0, mesh.nodes[*node][2] / lz]).collect());
        let parts = [("wall", Part::Revolved { layers: vec![rubber(Law::NeoHooke { shear: 1.0 })] })];
        let supports = [("first", plane(0.0, 0.0, 1.0)), ("last", plane(0.0, 0.0, 1.0))];
        let mut solver = solver_of(&mesh, &parts, &supports, &[], Copies::ONE);
        let rest = solver.at_rest();
        let state = to_volume(&mut solver, &rest, PI * l * l * 2.0 * lz);
        line(&format!("cylinder l = {l}, lz = {lz}: p"), state.pressure, known, 1e-10);
    }
}

#[test]
fn a_closed_cylinder_of_neo_hooke() {
    // V = pi integral of r^2 dz vanishes on the end discs, but grows by pi r^2 dz as an end moves. The
    // pressure on the disc is therefore included, and a closed end is a fitting without external force. The
    // middle of a long tube isn't affected by the clamp.
    let mesh = revolved(|t| [1.0, 24.0 * t], 120, true, Grading::End(3.0));
    let parts = [("wall", Part::Revolved { layers: vec![rubber(Law::NeoHooke { shear: 1.0 })] })];
    let supports = [("first", plane(0.0, 0.0, 1.0)), ("last", Support::Fitting { fitting: 0 })];
    let mut solver =
        solver_of(&mesh, &parts, &supports, &[Fitting::Loaded], Copies { around: 1.0, along: 2.0 });
    let mut state = solver.at_rest();
    for (l, lz, pressure) in [
        (1.1, 1.006_450_741_209, 0.323_626_264_141),
        (1.3, 1.054_154_188_464, 0.649_735_909_791),
        (1.5, 1.138_601_389_019, 0.744_450_856_695),
    ] {
        let before = under(Inflation::Pressure(state.pressure), &[0.0]);
        state =
            solver.follow(&before, &state, &under(Inflation::Pressure(pressure), &[0.0]), |_, _| ()).unwrap();
        let fields = solver.fields(&state);
        line(&format!("closed cylinder, p = {pressure}: l"), fields.places[0][0], l, 1e-6);
        let sheet = fields.groups[0].sheets[0][0];
        line(&format!("closed cylinder, p = {pressure}: lz"), sheet.stretch[0], lz, 1e-6);
        assert!(state.forces[0].abs() < 1e-9);
    }
}

// ---- the clamped tube of rubber: R = 10, L = 60, mu H = 0.4

fn tube(elements: usize, is_quadratic: bool) -> Solver {
    let mesh = revolved(|t| [10.0, 60.0 * t], elements, is_quadratic, Grading::Ends(3.0));
    clamped(&mesh, vec![rubber(Law::NeoHooke { shear: 0.4 })], Fitting::Placed)
}

/// Pressure, radius in the middle, force, volume: shooting at 1e-13.
const TUBE: [[f64; 4]; 5] = [
    [0.005, 10.340_056_663_6, -0.065_359_811_2, 20_087.860_728_58],
    [0.010, 10.746_120_228_6, -0.267_583_632_1, 21_548.794_575_73],
    [0.020, 11.882_202_471_1, -1.319_579_120_0, 25_667.591_355_03],
    [0.030, 14.138_745_874_6, -4.509_371_885_7, 34_161.100_645_60],
    [0.034, 16.881_605_247_3, -8.686_206_411_1, 45_070.528_954_94],
];

#[test]
fn a_clamped_tube_of_rubber() {
    let mut solver = tube(200, true);
    let mut state = solver.at_rest();
    for [pressure, radius, force, volume] in TUBE {
        state = to_pressure(&mut solver, &state, pressure, &[0.0, 0.0]);
        let middle = solver.fields(&state).places[200][0];
        line(&format!("tube p = {pressure}: r"), middle, radius, 1e-8);
        line(
            &format!("tube p = {pressure}: F"),
            state.forces[1],
            force,
            if pressure < 0.01 { 1e-6 } else { 1e-7 },
        );
        line(&format!("tube p = {pressure}: V"), state.volume, volume, 1e-8);
        assert_eq!(state.unstable, 0);
    }
    let (volume, pressure) = extreme(|v| to_volume(&mut solver, &state, v).pressure, 47_000.0, 54_000.0);
    line("tube limit point: p", pressure, 0.034_342_062_070, 1e-9);
    line("tube limit point: V", volume, 50_534.2, 1e-5);
    let top = to_volume(&mut solver, &state, volume);
    line("tube limit point: r", solver.fields(&top).places[200][0], 18.2088, 1e-4);
    line("tube limit point: F", top.forces[1], -10.3753, 1e-4);
    let past = to_volume(&mut solver, &top, 68_311.883_8);
    line("tube past it: p", past.pressure, 0.032_353_062_0, 1e-8);
    line("tube past it: r", solver.fields(&past).places[200][0], 22.155_894_00, 1e-8);
    line("tube past it: F", past.forces[1], -12.533_616_51, 1e-7);
    let far = to_volume(&mut solver, &past, 123_737.522_1);
    line("tube far past it: p", far.pressure, 0.025_797_586_0, 1e-8);
    line("tube far past it: r", solver.fields(&far).places[200][0], 29.807_693_31, 1e-8);
}

#[test]
fn a_clamped_tube_of_rubber_converges() {
    let [pressure, _, force, volume] = TUBE[3];
    for (is_quadratic, meshes, range) in [(false, [20, 40, 80], 1.9..2.1), (true, [10, 20, 40], 3.8..4.4)] {
        let states = meshes.map(|elements| {
            let mut solver = tube(elements, is_quadratic);
            let rest = solver.at_rest();
            to_pressure(&mut solver, &rest, pressure, &[0.0, 0.0])
        });
        let forces = [0, 1, 2].map(|i| states[i].forces[1]);
        let volumes = [0, 1, 2].map(|i| states[i].volume);
        order(&format!("tube F, quadratic: {is_quadratic}"), forces, force, range.clone());
        order(&format!("tube V, quadratic: {is_quadratic}"), volumes, volume, range);
        if !is_quadratic {
            line("tube F of 80 linear", forces[2], force, 3e-4);
        }
    }
}

/// For each element of revolution: position of its middle, cosine of its slope to the axis.
fn middles(fields: &Fields) -> Vec<([f64; 2], f64)> {
    let group = &fields.groups[0];
    group
        .cells
        .chunks_exact(group.kind.nodes())
        .map(|cell| {
            let [a, b] = [cell[0], cell[1]].map(|node| fields.places[node as usize]);
            let (dr, dz) = (b[0] - a[0], b[2] - a[2]);
            ([0.5 * (a[0] + b[0]), 0.5 * (a[2] + b[2])], dz / dr.hypot(dz))
        })
        .collect()
}

#[test]
fn what_a_meridian_keeps() {
    // 2 pi r N1 cos psi - pi r^2 p = F on any section, and W - l1 dW/dl1 = const. along a tube (Pipkin).
    let mut solver = tube(400, false);
    let rest = solver.at_rest();
    let state = to_pressure(&mut solver, &rest, 0.03, &[0.0, 0.0]);
    let fields = solver.fields(&state);
    let keeps: Vec<f64> = middles(&fields)
        .iter()
        .zip(&fields.groups[0].sheets[0])
        .map(|(([r, _], cos), sheet)| {
            let force = 2.0 * PI * r * sheet.force[0] * cos - PI * r * r * 0.03;
            assert!((force - state.forces[1]).abs() < 1e-3, "{force} {}", state.forces[1]);
            let [l1, l2] = sheet.stretch;
            let third = (l1 * l2).powi(-2);
            0.2 * (l1 * l1 + l2 * l2 + third - 3.0) - 0.4 * (l1 * l1 - third)
        })
        .collect();
    let (low, high) = keeps.iter().fold((f64::MAX, f64::MIN), |(low, high), k| (low.min(*k), high.max(*k)));
    println!("tube: W - l1 W1 from {low} to {high}");
    assert!((high - low).abs() < 1e-3 * low.abs());
    // In the middle at p = 0.03: axial stretch and hoop Cauchy stress (force over the current thickness 1/(l1
    // l2)), by shooting.
    let sheet = fields.groups[0].sheets[0][199];
    line("tube middle: l1", sheet.stretch[0], 1.029_147_347, 1e-5);
    line(
        "tube middle: stress around",
        sheet.force[1] * sheet.stretch[0] * sheet.stretch[1],
        0.610_694_295_1,
        1e-4,
    );
}

// ---- flat discs

/// A flat disc of radius 1, its rim held; z grows towards its middle.
fn disc(layer: RingLayer, elements: usize) -> Solver {
    let mesh = revolved(|t| [1.0 - t, 0.0], elements, true, Grading::Even);
    let parts = [("wall", Part::Revolved { layers: vec![layer] })];
    solver_of(&mesh, &parts, &[("first", Support::Fixed), ("last", Support::Axis)], &[], Copies::ONE)
}

#[test]
fn a_flat_disc_under_a_small_pressure() {
    // Hencky: w0 = K_w (p a/Y h)^(1/3) a, N = K_N (p^2 a^2 Y h)^(1/3), V = K_V a^3 (p a/Y h)^(1/3).
    for (poisson, kw, k0, ka, kv) in [
        (0.2, 0.677_435_325_805, 0.420_683_090_434, 0.316_109_288_5, 1.114_377_953_41),
        (0.3, 0.653_443_344_693, 0.431_101_016_110, 0.332_956_806_9, 1.070_316_686_50),
        (0.34, 0.642_998_037_074, 0.435_966_558_463, 0.340_589_787_7, 1.051_318_242_33),
        (0.4, 0.626_255_079_364, 0.444_217_658_946, 0.353_232_745_1, 1.021_090_857_91),
    ] {
        let mut solver = disc(rubber(Law::SaintVenantKirchhoff { stiffness: 1.0, poisson }), 30);
        let rest = solver.at_rest();
        let p = 1e-5_f64;
        let state = to_pressure(&mut solver, &rest, p, &[]);
        let fields = solver.fields(&state);
        line(&format!("disc nu = {poisson}: w0"), fields.places[60][2], kw * p.cbrt(), 1e-3);
        line(&format!("disc nu = {poisson}: V"), state.volume, kv * p.cbrt(), 1e-3);
        let sheet = &fields.groups[0].sheets[0];
        line(&format!("disc nu = {poisson}: N (0)"), sheet[29].force[0], k0 * (p * p).cbrt(), 1e-3);
        // Extrapolated from the middles of the outermost elements to the rim.
        let rim = 1.5 * sheet[0].force[0] - 0.5 * sheet[1].force[0];
        line(&format!("disc nu = {poisson}: N (a)"), rim, ka * (p * p).cbrt(), 1e-3);
    }
}

#[test]
fn a_disc_of_rubber() {
    // Adkins and Rivlin, by shooting: stretch of the pole, p A/(mu H), w/A.
    let mooney = Law::MooneyRivlin { c1: 0.5 / 1.1, c2: 0.05 / 1.1 };
    for (name, law, table) in [
        (
            "neo-Hooke",
            Law::NeoHooke { shear: 1.0 },
            &[
                [1.1, 0.527_781_922, 0.383_472_429],
                [1.5, 1.643_581_841, 0.798_789_213],
                [2.0, 1.869_554_748, 1.083_067_162],
                [2.5, 1.864_578_897, 1.302_007_729],
            ],
        ),
        (
            "Mooney-Rivlin",
            mooney,
            &[
                [1.1, 0.540_520_902, 0.385_442_027],
                [1.5, 1.819_418_924, 0.822_324_896],
                [2.0, 2.245_900_737, 1.161_125_160],
                [2.5, 2.415_896_761, 1.473_641_873],
            ],
        ),
    ] {
        let mut solver = disc(rubber(law), 80);
        let rest = solver.at_rest();
        let mut state = to_pressure(&mut solver, &rest, 0.1, &[]);
        for [stretch, pressure, height] in *table {
            // The volume at which the pole reaches that height.
            let guess = state.volume * height / solver.fields(&state).places[160][2];
            let volume = root(
                |v| {
                    let next = to_volume(&mut solver, &state, v);
                    solver.fields(&next).places[160][2] - height
                },
                guess,
                1.02 * guess,
            );
            state = to_volume(&mut solver, &state, volume);
            line(&format!("{name} disc, l = {stretch}: p"), state.pressure, pressure, 1e-6);
            // At the pole, from the middles of the last two elements: even in R.
            let sheet = &solver.fields(&state).groups[0].sheets[0];
            let pole = (9.0 * sheet[79].stretch[0] - sheet[78].stretch[0]) / 8.0;
            line(&format!("{name} disc, l = {stretch}: l of the pole"), pole, stretch, 1e-4);
        }
        if name == "neo-Hooke" {
            let volume = state.volume;
            let (_, pressure) =
                extreme(|v| to_volume(&mut solver, &state, v).pressure, 0.65 * volume, 0.95 * volume);
            line("neo-Hooke disc, limit point: p", pressure, 1.879_173_469, 1e-6);
        }
    }
}

// ---- cloth that carries along meridians only

#[test]
fn a_mylar_balloon() {
    // Two discs of radius a joined at their rims: V/a^3 and thickness/a from elliptic integrals.
    let values = [20, 40, 80].map(|elements| {
        let mesh = revolved(|t| [1.0 - t, 0.0], elements, true, Grading::Even);
        // A weak film between the threads: it can't stretch along them, and yields around.
        let law = Law::SaintVenantKirchhoff { stiffness: 1.0, poisson: 0.3 };
        let sheet = Sheet { cloth: Cloth::Isotropic(law), wrinkles: true, residual: 1e-6 };
        let layers = vec![net(0.0), RingLayer::Sheet { sheet, fullness: 1.0 }];
        let parts = [("wall", Part::Revolved { layers })];
        let supports = [("first", plane(0.0, 0.0, 1.0)), ("last", Support::Axis)];
        let mut solver = solver_of(&mesh, &parts, &supports, &[], Copies { around: 1.0, along: 2.0 });
        let rest = solver.at_rest();
        let state = to_pressure(&mut solver, &rest, 1.0, &[]);
        let thick = 2.0 * solver.fields(&state).places[2 * elements][2];
        assert_eq!(state.unstable, 0);
        (state.volume, thick)
    });
    println!("{values:?}");
    line("mylar balloon: V/a^3", values[2].0, 1.218_524_216_118_569_7, 1e-5);
    line("mylar balloon: thickness/a", values[2].1, 0.913_893_162_088_927_2, 1e-5);
}

/// The force at each contraction of a muscle between two fittings, from the meshes with 40 and 80 elements:
/// fine, and extrapolated.
fn forces(
    make: impl Fn(usize) -> Solver,
    length: f64,
    pressure: f64,
    contractions: &[f64],
) -> Vec<[[f64; 2]; 2]> {
    let [coarse, fine] = [40, 80].map(|elements| {
        let mut solver = make(elements);
        let mut state = solver.at_rest();
        contractions
            .iter()
            .map(|contraction| {
                state = to_pressure(&mut solver, &state, pressure, &[0.0, -contraction * length]);
                [state.forces[1], state.volume]
            })
            .collect::<Vec<_>>()
    });
    coarse.into_iter().zip(fine).map(|(coarse, fine)| [coarse, fine]).collect()
}

#[test]
fn a_pleated_muscle() {
    // Inextensible meridians: incomplete elliptic integrals with 40 digits.
    let contractions = [0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35];
    for (radius, f, v, still) in [
        (
            16.0,
            [
                1.193_367_507_75,
                0.825_329_695_805,
                0.610_857_236_002,
                0.451_457_606_469,
                0.321_493_439_605,
                0.210_752_720_845,
                0.114_200_873_984,
            ],
            [
                0.171_855_703_508,
                0.221_177_427_134,
                0.256_753_481_248,
                0.283_154_564_530,
                0.302_382_858_941,
                0.315_621_757_667,
                0.323_693_484_710,
            ],
            0.418_497_072_842_92,
        ),
        (
            11.5,
            [
                1.027_950_800_49,
                0.742_813_363_048,
                0.569_054_876_702,
                0.435_938_968_986,
                0.325_051_885_176,
                0.229_057_401_746,
                0.144_337_241_640,
            ],
            [
                0.119_122_268_432,
                0.162_563_993_843,
                0.195_120_147_142,
                0.220_127_850_676,
                0.239_079_516_180,
                0.252_879_424_057,
                0.262_172_352_177,
            ],
            0.451_069_016_033_61,
        ),
    ] {
        let make = |elements| {
            let mesh = revolved(|t| [radius, 110.0 * t], elements, true, Grading::Ends(3.0));
            clamped(&mesh, vec![net(0.0)], Fitting::Placed)
        };
        let (p, l) = (0.3, 110.0_f64);
        for (i, [coarse, fine]) in forces(make, l, p, &contractions).into_iter().enumerate() {
            let name = format!("pleated muscle R = {radius}, {} %", 100.0 * contractions[i]);
            line(&format!("{name}: F of 80"), fine[0], f[i] * p * l * l, 1e-6);
            line(&format!("{name}: F"), extrapolated(coarse[0], fine[0], 4), f[i] * p * l * l, 1e-8);
            line(&format!("{name}: V"), extrapolated(coarse[1], fine[1], 4), v[i] * l.powi(3), 1e-8);
        }
        let mut solver = make(80);
        let rest = solver.at_rest();
        let near = to_pressure(&mut solver, &rest, p, &[0.0, -0.4 * l]);
        let found = root(|e| to_pressure(&mut solver, &near, p, &[0.0, -e * l]).forces[1], 0.41, 0.42);
        line(&format!("pleated muscle R = {radius}: contraction without force"), found, still, 1e-6);
    }
}

#[test]
fn a_pleated_muscle_converges() {
    let exact = 0.451_457_606_469 * 0.3 * 110.0 * 110.0;
    for (is_quadratic, meshes, range) in [(false, [20, 40, 80], 1.9..2.1), (true, [10, 20, 40], 3.0..5.0)] {
        let values = meshes.map(|elements| {
            let mesh = revolved(|t| [16.0, 110.0 * t], elements, is_quadratic, Grading::Ends(3.0));
            let mut solver = clamped(&mesh, vec![net(0.0)], Fitting::Placed);
            let rest = solver.at_rest();
            to_pressure(&mut solver, &rest, 0.3, &[0.0, -22.0]).forces[1]
        });
        order(&format!("pleated muscle F at 20 %, quadratic: {is_quadratic}"), values, exact, range);
    }
}

// ---- braids

const BRAID: f64 = 25.0;

/// A braid at 25 degrees on a wall of radius 10, clamped, with rubber on it or without.
fn braid(length: f64, elements: usize, has_rubber: bool) -> Solver {
    let grading = Grading::Ends(if length > 100.0 { 8.0 } else { 3.0 });
    let mesh = revolved(|t| [10.0, length * t], elements, true, grading);
    let mut layers = vec![net(BRAID.to_radians())];
    if has_rubber {
        layers.push(rubber(Law::NeoHooke { shear: 0.4 }));
    }
    clamped(&mesh, layers, Fitting::Placed)
}

const CONTRACTIONS: [f64; 8] = [0.02, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35];

fn braids(
    name: &str,
    has_rubber: bool,
    contractions: &[f64],
    cases: &[(f64, Vec<[f64; 2]>)],
    tolerance: f64,
) {
    for (length, table) in cases {
        let all = forces(|elements| braid(*length, elements, has_rubber), *length, 0.3, contractions);
        for (i, [coarse, fine]) in all.into_iter().enumerate() {
            let name = format!("{name} l = {length}, {} %", 100.0 * contractions[i]);
            let [force, volume] = table[i];
            println!("{name} of 80: {:.1e} {:.1e}", fine[0] / force - 1.0, fine[1] / volume - 1.0);
            // Relative to the largest force, because it changes sign.
            let found = extrapolated(coarse[0], fine[0], 4);
            line(&format!("{name}: F"), found - force + table[0][0], table[0][0], tolerance);
            line(&format!("{name}: V"), extrapolated(coarse[1], fine[1], 4), volume, tolerance);
        }
    }
}

#[test]
fn a_clamped_net() {
    // Pin-jointed and inextensible: quadratures with 30 digits.
    let long = vec![
        [709.026_161_143, 90_880.481_455],
        [621.046_770_455, 107_490.146_723],
        [489.117_261_456, 130_562.554_289],
        [371.490_395_062, 148_447.484_620],
        [265.682_506_482, 161_683.797_333],
        [170.268_994_056, 170_731.823_139],
        [84.369_200_255, 176_004.851_197],
        [7.473_541_990, 177_887.488_102],
    ];
    let short = vec![
        [630.194_578_728, 21_631.894_679],
        [495.731_541_949, 24_980.660_684],
        [348.973_600_133, 29_154.094_316],
        [243.362_676_221, 32_092.771_051],
        [159.339_674_897, 34_092.237_545],
        [89.550_291_054, 35_326.641_228],
        [30.445_260_447, 35_918.699_200],
        [-19.963_369_759, 35_964.454_839],
    ];
    braids("net", false, &CONTRACTIONS, &[(250.0, long), (60.0, short)], 1e-8);
}

#[test]
fn a_clamped_net_with_rubber() {
    // By elements of order 10 with a first integral constant to 1e-13.
    let long = vec![
        [572.911_650_292_1, 107_485.957_2],
        [428.404_355_698_8, 130_554.513_3],
        [307.311_545_887_1, 148_434.548_2],
        [201.362_876_408_9, 161_662.659_0],
        [107.304_842_7, 170_695.969_2],
        [23.640_708_0, 175_941.401_6],
        [-50.105_780_1, 177_768.984_2],
    ];
    let short = vec![
        [456.356_632_062_5, 24_980.075_5],
        [303.945_858_127_6, 29_152.511_9],
        [198.373_329_143_4, 32_089.484_1],
        [116.237_819_774_7, 34_085.971_6],
        [49.237_659_997_5, 35_315.360_6],
        [-6.439_045_112_8, 35_899.350_8],
        [-52.812_042_6, 35_932.678_3],
    ];
    braids("net with rubber", true, &CONTRACTIONS[1..], &[(250.0, long), (60.0, short)], 1e-8);
}

#[test]
fn what_a_braid_keeps() {
    // n T cos b cos psi + 2 pi r N1 cos psi - pi r^2 p = F on every section, with the current angle b of the
    // threads.
    for has_rubber in [false, true] {
        let mut solver = braid(60.0, 200, has_rubber);
        let rest = solver.at_rest();
        let state = to_pressure(&mut solver, &rest, 0.3, &[0.0, -12.0]);
        let fields = solver.fields(&state);
        let group = &fields.groups[0];
        let mut worst = 0.0_f64;
        for (i, ([r, _], cos)) in middles(&fields).into_iter().enumerate() {
            let thread = group.threads[0][i];
            let mut pull = 40.0 * thread.tension * thread.angle.cos();
            if has_rubber {
                pull += 2.0 * PI * r * group.sheets[0][i].force[0];
            }
            let force = pull * cos - PI * r * r * 0.3;
            worst = worst.max((force - state.forces[1]).abs());
            assert!((thread.stretch - 1.0).abs() < 1e-9);
        }
        println!(
            "braid with rubber: {has_rubber}: F along the meridian within {worst:.1e} of {}",
            state.forces[1]
        );
        assert!(worst < 0.5, "{worst}");
    }
}

#[test]
fn force_is_the_slope_of_the_energy() {
    // F = d (W - p V)/dl at constant pressure, by central differences.
    for (name, mut solver, p, place) in [
        ("tube", tube(40, true), 0.03, 0.0),
        ("braid", braid(60.0, 40, false), 0.3, -12.0),
        ("braid with rubber", braid(60.0, 40, true), 0.3, -12.0),
    ] {
        let rest = solver.at_rest();
        let middle = to_pressure(&mut solver, &rest, p, &[0.0, place]);
        let h = 1e-2;
        let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(|k| {
            let state = to_pressure(&mut solver, &middle, p, &[0.0, place + k * h]);
            state.energy - p * state.volume
        });
        line(
            &format!("{name}: F by virtual work"),
            (8.0 * (c - b) - (d - a)) / (12.0 * h),
            middle.forces[1],
            1e-6,
        );
    }
}

#[test]
fn a_fitting_with_the_force_found_stands_where_it_was_placed() {
    for (name, has_rubber) in [("braid", false), ("braid with rubber", true)] {
        let mesh = revolved(|t| [10.0, 60.0 * t], 40, true, Grading::Ends(3.0));
        let mut layers = vec![net(BRAID.to_radians())];
        if has_rubber {
            layers.push(rubber(Law::NeoHooke { shear: 0.4 }));
        }
        let mut placed = clamped(&mesh, layers.clone(), Fitting::Placed);
        let rest = placed.at_rest();
        let state = to_pressure(&mut placed, &rest, 0.3, &[0.0, -9.0]);
        let mut loaded = clamped(&mesh, layers, Fitting::Loaded);
        let rest = loaded.at_rest();
        let before = under(Inflation::Pressure(0.0), &[0.0, 0.0]);
        let load = under(Inflation::Pressure(0.3), &[0.0, state.forces[1]]);
        let again = loaded.follow(&before, &rest, &load, |_, _| ()).unwrap();
        line(&format!("{name}: place under the force found"), again.fittings[1], -9.0, 1e-9);
        line(&format!("{name}: volume under the force found"), again.volume, state.volume, 1e-9);
        line(&format!("{name}: force on the loaded fitting"), again.forces[1], state.forces[1], 1e-9);
    }
}

#[test]
fn a_muscle_closed_with_its_gas() {
    // (p + ambient) V^gamma is conserved while the fitting moves.
    for gamma in [1.0, 1.4] {
        let mut solver = braid(60.0, 40, true);
        let rest = solver.at_rest();
        let start = to_pressure(&mut solver, &rest, 0.3, &[0.0, -3.0]);
        let gas = Gas::filling(start.volume, start.pressure, 0.1, gamma);
        let before = under(Inflation::Gas(gas), &[0.0, -3.0]);
        let state =
            solver.follow(&before, &start, &under(Inflation::Gas(gas), &[0.0, -12.0]), |_, _| ()).unwrap();
        let constant = (state.pressure + 0.1) * state.volume.powf(gamma);
        line(&format!("braid of gas, gamma = {gamma}: p V^gamma"), constant, gas.constant, 1e-12);
        // The same force as at the pressure found.
        let again = to_pressure(&mut solver, &start, state.pressure, &[0.0, -12.0]);
        line(&format!("braid of gas, gamma = {gamma}: F"), state.forces[1], again.forces[1], 1e-8);
        assert_eq!(state.unstable, 0);
    }
}

// ---- plane tension fields

/// A panel of unit height along x and unit length along z, its stress-free pattern the unit square.
fn panel(cells: [usize; 2], is_quadratic: bool, place: &dyn Fn(f64, f64) -> [f64; 3]) -> Mesh {
    grid(&Surface { place, pattern: Some(&|u, v| [u, v]), cells, is_quadratic })
}

#[test]
fn a_wrinkled_panel_in_bending() {
    // Stein and Hedgepeth: with a slack band of height b, M/(P h) = (b/h + 1/2)/3, and the largest stress
    // over P/(t h) is 2/(1 - b/h). Its ends stay plane: z = (1 + e (x)) there, e = k (x - b), which the mesh
    // has from the start, but the pattern doesn't.
    let (strain, cells) = (1e-3, 40);
    for (band, moment, largest) in
        [(0.1, 0.2, 2.222_222_222), (0.4, 0.3, 3.333_333_333), (0.7, 0.4, 6.666_666_667)]
    {
        let mut mesh = panel([cells, 4], false, &|u, v| [u, 0.0, v * (1.0 + strain * (u - band))]);
        // One corner stays fixed; everything else is free to move across as the panel bends.
        mesh.blocks.push(Block {
            group: "corner".to_owned(),
            kind: CellKind::Point,
            cells: vec![cells],
            numbers: vec![1],
            pattern: None,
        });
        let law = Law::SaintVenantKirchhoff { stiffness: 1.0, poisson: 0.3 };
        let sheet = Sheet { cloth: Cloth::Isotropic(law), wrinkles: true, residual: 1e-4 };
        let mut solver = solver_of(
            &mesh,
            &[("cloth", Part::Membrane { sheet: Some(sheet), warp: [1.0, 0.0, 0.0] })],
            &[
                ("cloth", plane(0.0, 1.0, 0.0)),
                ("v0", plane(0.0, 0.0, 1.0)),
                ("v1", plane(0.0, 0.0, 1.0)),
                ("corner", plane(1.0, 0.0, 0.0)),
            ],
            &[],
            Copies::ONE,
        );
        let rest = solver.at_rest();
        let state = solver.solve(&under(Inflation::Pressure(0.0), &[]), &rest).unwrap();
        assert_eq!(state.unstable, 0);
        let fields = solver.fields(&state);
        let group = &fields.groups[0];
        let (mut force, mut bend, mut top) = (0.0, 0.0, 0.0);
        for (cell, (sheet, area)) in group.cells.chunks_exact(3).zip(group.sheets[0].iter().zip(&group.areas))
        {
            let x = cell.iter().map(|node| mesh.nodes[*node as usize][0]).sum::<f64>() / 3.0;
            // Per length of the pattern across, part of which wrinkles absorb.
            let pull = sheet.force[0] * sheet.stretch[1];
            force += pull * area;
            bend += pull * area * (x - 0.5);
            if x > 1.0 - 1.0 / cells as f64 {
                top += pull * area * cells as f64;
            }
        }
        line(&format!("panel b/h = {band}: M/(P h)"), bend / force, moment, 1e-2);
        // Extrapolated linearly from the middle of the outermost cells to the edge.
        let edge = top * (1.0 - band) / (1.0 - band - 0.5 / cells as f64);
        line(&format!("panel b/h = {band}: largest stress"), edge / force, largest, 1e-2);
    }
}

#[test]
fn a_patch_of_triangles_spreads_evenly() {
    // If the boundary of a patch is moved to a uniform strain, its interior follows, from any start, taut or
    // wrinkled.
    for is_quadratic in [false, true] {
        for (l1, l2, tension) in [(1.2, 1.1, Tension::Taut), (1.2, 0.96, Tension::Taut)] {
            let place = |u: f64, v: f64| {
                let inside = 16.0 * u * (1.0 - u) * v * (1.0 - v);
                let off = 0.05 * inside;
                [l1 * u + off * (7.0 * v).sin(), 0.02 * inside, l2 * v - off * (5.0 * u).cos()]
            };
            let mesh = panel([6, 5], is_quadratic, &place);
            let law = Law::SaintVenantKirchhoff { stiffness: 1.0, poisson: 0.3 };
            let sheet = Sheet { cloth: Cloth::Isotropic(law), wrinkles: true, residual: 0.0 };
            let edges = ["u0", "u1", "v0", "v1"].map(|edge| (edge, Support::Fixed));
            let part = Part::Membrane { sheet: Some(sheet), warp: [1.0, 0.0, 0.0] };
            let mut solver = solver_of(&mesh, &[("cloth", part)], &edges, &[], Copies::ONE);
            let rest = solver.at_rest();
            let state = solver.solve(&under(Inflation::Pressure(0.0), &[]), &rest).unwrap();
            let fields = solver.fields(&state);
            let e = [0.5 * (l1 * l1 - 1.0), 0.5 * (l2 * l2 - 1.0)];
            let force = [(e[0] + 0.3 * e[1]) / 0.91 * l1 / l2, (e[1] + 0.3 * e[0]) / 0.91 * l2 / l1];
            for sheet in &fields.groups[0].sheets[0] {
                assert_eq!(sheet.tension, tension);
                for i in 0..2 {
                    assert!((sheet.force[i] - force[i]).abs() < 1e-9, "{sheet:?} {force:?}");
                }
                assert!((sheet.direction[0].abs() - 1.0).abs() < 1e-9);
            }
            println!("patch, quadratic {is_quadratic}: {} iterations", state.iterations);
        }
    }
}

#[test]
fn results_of_an_earlier_state() {
    // The fields of a state don't depend on later solutions.
    let mut solver = braid(60.0, 20, false);
    let rest = solver.at_rest();
    let first = to_pressure(&mut solver, &rest, 0.3, &[0.0, -3.0]);
    let before = solver.fields(&first);
    let _ = to_pressure(&mut solver, &first, 0.1, &[0.0, -12.0]);
    let after = solver.fields(&first);
    let (a, b) = (before.groups[0].threads[0][10].tension, after.groups[0].threads[0][10].tension);
    line("tension of an earlier state", b, a, 1e-9);
}

#[test]
fn threads_under_a_volume_from_rest() {
    // Inextensible threads hardly allow the volume to change: its last digits correspond to the middle ones
    // of the pressure.
    let mut solver = braid(60.0, 20, true);
    let rest = solver.at_rest();
    let state = to_pressure(&mut solver, &rest, 0.3, &[0.0, -3.0]);
    let load = under(Inflation::Volume(state.volume), &[0.0, -3.0]);
    let near = to_pressure(&mut solver, &rest, 0.01, &[0.0, -3.0]);
    for (name, from) in [("itself", &state), ("a lower pressure", &near), ("rest", &rest)] {
        let found =
            solver.follow(&under(Inflation::Volume(from.volume), &from.fittings), from, &load, |_, _| ());
        line(&format!("braid at a volume, from {name}: p"), found.unwrap().pressure, 0.3, 1e-5);
    }
}
