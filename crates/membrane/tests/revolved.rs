//! Membranes of revolution against closed forms and against exact solutions.

use bulge_membrane::mesher::{Grading, revolved};
use bulge_membrane::{
    Cloth, Copies, Fitting, Inflation, Law, Load, Mesh, Part, RingLayer, Sheet, Solver, State, Structure,
    Support, Thread, Tolerance,
};
use std::f64::consts::{FRAC_PI_2, PI};

fn rubber(law: Law) -> RingLayer {
    let sheet = Sheet { cloth: Cloth::Isotropic(law), wrinkles: false, residual: 0.0 };
    RingLayer::Sheet { sheet, fullness: 1.0 }
}

/// A wall on a fitting at each end, the first at z = 0.
fn clamped(mesh: &Mesh, layers: Vec<RingLayer>) -> Solver {
    let supports = [
        ("first".to_owned(), Support::Fitting { fitting: 0 }),
        ("last".to_owned(), Support::Fitting { fitting: 1 }),
    ];
    let parts = [("wall".to_owned(), Part::Revolved { layers })];
    let structure = Structure::new(mesh, &parts, &supports, &[Fitting::Placed, Fitting::Placed]).unwrap();
    Solver::new(structure, Copies::ONE, Tolerance::default()).unwrap()
}

fn at(solver: &mut Solver, pressure: f64, place: f64, from: &State) -> State {
    let before = Load { inflation: Inflation::Pressure(from.pressure), fittings: from.fittings.clone() };
    let load = Load { inflation: Inflation::Pressure(pressure), fittings: vec![0.0, place] };
    solver.follow(&before, from, &load, |_, _| ()).unwrap()
}

/// The peer problem: R = 10, L = 60, mu H = 0.4, in mm, N and MPa.
fn tube(elements: usize, is_quadratic: bool) -> (Mesh, Solver) {
    let mesh = revolved(|t| [10.0, 60.0 * t], elements, is_quadratic, Grading::Ends(3.0));
    let solver = clamped(&mesh, vec![rubber(Law::NeoHooke { shear: 0.4 })]);
    (mesh, solver)
}

#[test]
fn a_clamped_tube_of_rubber() {
    // Pressure, force, volume: shooting at 1e-13.
    let exact = [
        (0.005, -0.065_359_811_2, 20_087.860_728_58),
        (0.010, -0.267_583_632_1, 21_548.794_575_73),
        (0.020, -1.319_579_120_0, 25_667.591_355_03),
        (0.030, -4.509_371_885_7, 34_161.100_645_60),
        (0.034, -8.686_206_411_1, 45_070.528_954_94),
    ];
    let (_, mut solver) = tube(200, true);
    for (pressure, force, volume) in exact {
        let rest = solver.at_rest();
        let state = at(&mut solver, pressure, 0.0, &rest);
        println!(
            "{pressure} {} {} {:?} {}",
            state.forces[1] - force,
            state.volume / volume - 1.0,
            state.iterations,
            state.unstable
        );
        assert!((state.forces[1] / force - 1.0).abs() < 1e-7);
        assert!((state.volume / volume - 1.0).abs() < 1e-8);
        assert_eq!(state.unstable, 0);
    }
    println!("{:?}", solver.effort());
    let rest = solver.at_rest();
    let before = Load { inflation: Inflation::Pressure(0.0), fittings: vec![0.0, 0.0] };
    let load = Load { inflation: Inflation::Pressure(0.035), fittings: vec![0.0, 0.0] };
    let mut all = Vec::new();
    let error = solver.follow(&before, &rest, &load, |_, state| all.push(state.pressure)).unwrap_err();
    println!("{error} {all:?}");
    println!("{:?}", solver.effort());
    // Beyond the limit point.
    let mut state = at(&mut solver, 0.034, 0.0, &rest);
    for (volume, pressure, force) in
        [(68_311.883_8, 0.032_353_062_0, -12.533_616_51), (123_737.522_1, 0.025_797_586_0, f64::NAN)]
    {
        let load = Load { inflation: Inflation::Volume(volume), fittings: vec![0.0, 0.0] };
        let before = Load { inflation: Inflation::Volume(state.volume), fittings: vec![0.0, 0.0] };
        state = solver.follow(&before, &state, &load, |_, _| ()).unwrap();
        println!(
            "{volume} {} {} {} {}",
            state.pressure / pressure - 1.0,
            state.forces[1] / force - 1.0,
            state.unstable,
            state.iterations
        );
    }
}

#[test]
fn a_sphere_of_rubber() {
    let (law, r) = (Law::NeoHooke { shear: 1.0 }, 1.0);
    let mesh = revolved(
        |t| {
            let a = FRAC_PI_2 * (1.0 - t);
            [r * a.cos().max(0.0), r * (FRAC_PI_2 * t).sin()]
        },
        40,
        true,
        Grading::Even,
    );
    let mesh = Mesh {
        nodes: mesh.nodes.iter().map(|x| [(1.0 - x[2] * x[2]).max(0.0).sqrt(), 0.0, x[2]]).collect(),
        ..mesh
    };
    let supports = [
        ("first".to_owned(), Support::Plane { normal: [0.0, 0.0, 1.0] }),
        ("last".to_owned(), Support::Axis),
    ];
    let parts = [("wall".to_owned(), Part::Revolved { layers: vec![rubber(law)] })];
    let structure = Structure::new(&mesh, &parts, &supports, &[]).unwrap();
    let mut solver =
        Solver::new(structure, Copies { around: 1.0, along: 2.0 }, Tolerance::default()).unwrap();
    let rest = solver.at_rest();
    let mut state = rest;
    for (stretch, pressure) in [
        (1.1_f64, 0.791_865_581_720_405),
        (1.5, 1.216_278_006_401_46),
        (2.0, 0.984_375),
        (3.0, 0.665_752_171_925_011),
    ] {
        let volume = 4.0 / 3.0 * PI * stretch.powi(3);
        let load = Load { inflation: Inflation::Volume(volume), fittings: vec![] };
        state = solver.solve(&load, &state).unwrap();
        println!("{stretch} {} {} {}", state.pressure / pressure - 1.0, state.unstable, state.iterations);
        assert!((state.pressure / pressure - 1.0).abs() < 1e-6);
    }
}

/// Inextensible threads at the braid angle, or along the meridian.
fn net(angle: f64) -> RingLayer {
    RingLayer::Threads { thread: Thread::Inextensible, count: 40.0, angle }
}

#[test]
fn a_pleated_muscle() {
    let p = 0.3;
    for (elements, is_quadratic) in [(40, false), (80, false), (40, true), (80, true)] {
        let mesh = revolved(|t| [16.0, 110.0 * t], elements, is_quadratic, Grading::Ends(3.0));
        let mut solver = clamped(&mesh, vec![net(0.0)]);
        let mut state = solver.at_rest();
        for (contraction, force) in
            [(0.05, 4331.924053), (0.1, 2995.946796), (0.2, 1638.791111), (0.3, 765.032377)]
        {
            state = at(&mut solver, p, -110.0 * contraction, &state);
            println!(
                "{elements} {is_quadratic} {contraction} {:e} {} {}",
                state.forces[1] / force - 1.0,
                state.iterations,
                state.unstable
            );
        }
        println!("{:?}", solver.effort());
    }
}

#[test]
fn a_clamped_net() {
    let p = 0.3;
    let angle = 25.0_f64.to_radians();
    for (elements, is_quadratic) in [(40, false), (80, false), (40, true), (80, true), (160, true)] {
        let mesh = revolved(|t| [10.0, 60.0 * t], elements, is_quadratic, Grading::Ends(3.0));
        let mut solver = clamped(&mesh, vec![net(angle)]);
        let mut state = solver.at_rest();
        for (contraction, force, volume) in [
            (0.05, 495.731541949, 24980.660684),
            (0.2, 159.339674897, 34092.237545),
            (0.35, -19.963369759, 35964.454839),
        ] {
            state = at(&mut solver, p, -60.0 * contraction, &state);
            println!(
                "{elements} {is_quadratic} {contraction} {:e} {:e} {} {}",
                state.forces[1] / force - 1.0,
                state.volume / volume - 1.0,
                state.iterations,
                state.unstable
            );
        }
        println!("{:?}", solver.effort());
    }
}
