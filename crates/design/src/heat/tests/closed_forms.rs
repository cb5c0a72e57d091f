//! Steps against closed-form solutions: mixing, exponential decay, conduction, adiabatic charging.

use super::*;

/// Gas and walls without air passing the inlet: the pressure is the one that keeps the mass. Returns gas and
/// wall after a time.
fn closed(problem: &HeatProblem, c: &Conductances, steps: u32, time: f64) -> (State, Mesh) {
    let mut mesh = Mesh::new(problem);
    mesh.wall_outer.fill(0.0);
    let outside = Outside { ambient: AMBIENT, supply: AMBIENT };
    let mut from = Instant { pressure: 3e5, section: 1.0 };
    let mut state = State::uniform(&mesh, from, 400.0, 300.0);
    let (mut stepper, dt) = (Stepper::default(), time / f64::from(steps));
    for _ in 0..steps {
        let mut run = |pressure: f64| {
            let (mut next, to) = (state.clone(), Instant { pressure, section: 1.0 });
            let step = Step { mesh: &mesh, conductances: c, outside, from, to, dt };
            (stepper.step(step, &mut next).unwrap().enthalpy, next)
        };
        let (mut a, mut b) = (from.pressure, from.pressure * 0.9999);
        let mut at_a = run(a).0;
        let mut end = run(b);
        for _ in 0..6 {
            let next = if (end.0 - at_a).abs() > 0.0 { b - end.0 * (b - a) / (end.0 - at_a) } else { b };
            (a, at_a, b) = (b, end.0, next);
            end = run(b);
        }
        from.pressure = b;
        state = end.1;
    }
    (state, mesh)
}

#[test]
fn closed_gas_and_wall_meet_at_the_mixed_temperature() {
    let mut problem = piped(&coarse(), 0.125, 0.004);
    problem.numerics.cells = 4;
    let mesh = Mesh::new(&problem);
    let mut c = nothing(&mesh);
    (c.wall, c.pipe_inner, c.pipe_outer) = (vec![0.5; 4], vec![0.7; 2], vec![0.9; 2]);
    c.mixing = vec![0.0, 3.0, 3.0, 3.0];
    let (state, mesh) = closed(&problem, &c, 200, 4000.0);
    let start = Instant { pressure: 3e5, section: 1.0 };
    let first = State::uniform(&mesh, start, 400.0, 300.0);
    let mass = air(&first);
    let walls: f64 = mesh.wall_capacity.iter().chain(&mesh.pipe_capacity).sum();
    let mixed = (CV * mass * 400.0 + walls * 300.0) / (CV * mass + walls);
    close(air(&state), mass, 1e-8);
    for t in [&state.muscle.gas, &state.muscle.wall, &state.pipe.gas, &state.pipe.wall].into_iter().flatten()
    {
        assert!((t - mixed).abs() < 1e-4, "{t} K, {mixed} K");
    }
}

#[test]
fn closed_gas_and_wall_meet_exponentially() {
    let mut problem = coarse();
    problem.numerics.cells = 4;
    problem.tube.wall_thickness_m = 1e-6;
    let mesh = Mesh::new(&problem);
    let c = Conductances { wall: vec![0.01; 4], ..nothing(&mesh) };
    let mass = 3e5 * mesh.volume(0, 1.0) / (R * 400.0);
    let rate = 0.01 * (1.0 / (CV * mass) + 1.0 / mesh.wall_capacity[0]);
    let time = 1.0 / rate;
    let gap = |steps: u32| {
        let (state, _) = closed(&problem, &c, steps, time);
        state.muscle.gas[2] - state.muscle.wall[2]
    };
    let exact = 100.0 * (-1.0_f64).exp();
    let [coarse, middle, fine] = [100, 200, 400].map(gap);
    let order = ((coarse - exact) / (middle - exact)).log2();
    assert!((order - 1.0).abs() < 0.02, "order {order}");
    // Two Richardson extrapolations: third order.
    let (once, twice) = (2.0 * middle - coarse, 2.0 * fine - middle);
    close((4.0 * twice - once) / 3.0, exact, 1e-5);
}

#[test]
fn gas_at_constant_pressure_warms_as_the_closed_form() {
    // With y = 1/T: dy/dt = k (1 - T_w y), k = U R/(P V cp); the gas flows out, so nothing enters.
    let mut problem = coarse();
    problem.tube.wall_heat_capacity_j_per_m3_k = 1e7;
    let mut mesh = Mesh::new(&problem);
    mesh.wall_outer.fill(0.0);
    mesh.wall_capacity.fill(1e12);
    let c = Conductances { wall: vec![0.02; 20], ..nothing(&mesh) };
    let now = Instant { pressure: 2e5, section: 1.0 };
    let k = 0.02 * R / (now.pressure * mesh.volume(0, 1.0) * CP);
    let time = 1.0 / (k * 400.0);
    let at = |steps: u32| {
        let (mut state, mut stepper) = (State::uniform(&mesh, now, 300.0, 400.0), Stepper::default());
        let outside = Outside { ambient: AMBIENT, supply: AMBIENT };
        let dt = time / f64::from(steps);
        let step = Step { mesh: &mesh, conductances: &c, outside, from: now, to: now, dt };
        for _ in 0..steps {
            stepper.step(step, &mut state).unwrap();
        }
        assert!((state.muscle.gas[0] - state.muscle.gas[19]).abs() < 1e-6);
        state.muscle.gas[7]
    };
    let exact = (1.0 / 400.0 + (1.0 / 300.0 - 1.0 / 400.0) * (-1.0_f64).exp()).recip();
    let [coarse, fine] = [100, 200].map(at);
    let order = ((coarse - exact) / (fine - exact)).log2();
    assert!((order - 1.0).abs() < 0.02, "order {order}");
    close(2.0 * fine - coarse, exact, 1e-5);
}

#[test]
fn walls_cool_and_conduct_as_the_closed_forms() {
    let problem = piped(&coarse(), 0.125, 0.004);
    let mesh = Mesh::new(&problem);
    let c = nothing(&mesh);
    let now = problem.instant(0.0);
    let mut state = State::uniform(&mesh, now, AMBIENT, 350.0);
    // The slowest modes for 20 and for 10 cells.
    let mode = |i: usize, n: f64| (PI * (i as f64 + 0.5) / n).cos();
    for i in 0..20 {
        state.muscle.wall[i] = 350.0 + 10.0 * mode(i, 20.0);
    }
    for i in 0..10 {
        state.pipe.wall[i] = 350.0 + 10.0 * mode(i, 10.0);
    }
    let outside = Outside { ambient: AMBIENT, supply: AMBIENT };
    let step = Step { mesh: &mesh, conductances: &c, outside, from: now, to: now, dt: 50.0 };
    Stepper::default().step(step, &mut state).unwrap();
    // Outer U by hand: 10 W/(m2 K) on a diameter of 23 mm, and rubber from 10.75 mm to 11.5 mm.
    let u = (1.0 / (10.0 * PI * 0.023) + (11.5_f64 / 10.75).ln() / (2.0 * PI * 0.16)).recip();
    let section = PI * (0.0115_f64.powi(2) - 0.01_f64.powi(2));
    let along = |k: f64, n: f64| 4.0 * k / 0.0125_f64.powi(2) * (PI / (2.0 * n)).sin().powi(2);
    let uniform = 50.0 * u / (2.0e6 * section);
    let wavy = uniform + 50.0 * along(0.16 / 2.0e6, 20.0);
    let expected =
        |i: usize| AMBIENT + (350.0 - AMBIENT) / (1.0 + uniform) + 10.0 * mode(i, 20.0) / (1.0 + wavy);
    for i in 0..20 {
        assert!((state.muscle.wall[i] - expected(i)).abs() < 1e-9);
    }
    let kept = 1.0 / (1.0 + 50.0 * along(0.25 / 1.9e6, 10.0));
    for i in 0..10 {
        assert!((state.pipe.wall[i] - 350.0 - 10.0 * mode(i, 10.0) * kept).abs() < 1e-9);
    }
}

/// Gas temperatures after charging from 1 to 6 bar without heat transfer or mixing.
fn charged(cells: usize, steps: u32) -> (Vec<f64>, Mesh) {
    let mut problem = coarse();
    problem.numerics.cells = cells;
    let mesh = Mesh::new(&problem);
    let c = nothing(&mesh);
    let at = |i: u32| Instant { pressure: 1e5 + 5e5 * f64::from(i) / f64::from(steps), section: 1.0 };
    let mut state = State::uniform(&mesh, at(0), AMBIENT, AMBIENT);
    let mut stepper = Stepper::default();
    for i in 0..steps {
        let outside = Outside { ambient: AMBIENT, supply: AMBIENT };
        let step = Step {
            mesh: &mesh,
            conductances: &c,
            outside,
            from: at(i),
            to: at(i + 1),
            dt: 0.1 / f64::from(steps),
        };
        stepper.step(step, &mut state).unwrap();
    }
    (state.muscle.gas, mesh)
}

#[test]
fn the_end_is_compressed_adiabatically_to_first_order() {
    let exact = AMBIENT * 6.0_f64.powf((GAMMA - 1.0) / GAMMA);
    // The cells are so many that the fresh air doesn't reach the last one.
    let [coarse, fine] = [200, 400].map(|steps| charged(40, steps).0[39]);
    let order = ((coarse - exact) / (fine - exact)).log2();
    assert!((order - 1.0).abs() < 0.1, "order {order}: {coarse} K, {fine} K, {exact} K");
    close(2.0 * fine - coarse, exact, 2e-4);
}

#[test]
fn a_charged_muscle_has_the_temperatures_of_the_closed_form() {
    // Air that entered at the pressure Pe lies at the distance L (Pe/P)^(1/gamma) from the end, at T_s
    // (P/Pe)^(1-1/gamma). So T = T_s s^(1-gamma) at the distance s L, up to the air that was there initially.
    let first = 6.0_f64.powf(-1.0 / GAMMA);
    let error = |cells: usize| {
        let (gas, mesh) = charged(cells, 40 * u32::try_from(cells).unwrap());
        let off = |(t, x): (&f64, &f64)| {
            let s = (1.0 - x / 0.25).max(first);
            (t - AMBIENT * s.powf(1.0 - GAMMA)).abs()
        };
        gas.iter().zip(&mesh.x).map(off).sum::<f64>() / cells as f64
    };
    let [coarse, fine] = [20, 80].map(error);
    // A kink is smeared over a width proportional to the root of the cell length, and so is the error: the
    // order is at least that.
    let order = (coarse / fine).log2() / 2.0;
    assert!((0.8..1.2).contains(&order) && fine < 2.0, "order {order}, {fine} K");
}
