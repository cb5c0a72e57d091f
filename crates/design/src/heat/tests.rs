//! Heat in a muscle: conservation to rounding, closed forms, orders of convergence, and what S3 reports.

use super::gas::{CP, CV, GAMMA, Jet, Passage, R, conductivity, nusselt, viscosity};
use super::mesh::{Conductances, Instant, Mesh};
use super::state::{Outside, State};
use super::step::{Step, Stepper};
use super::tridiagonal::Tridiagonal;
use super::*;
use std::f64::consts::PI;

const AMBIENT: f64 = 293.15;

/// Coarse, for many solves.
fn coarse() -> HeatProblem {
    let mut problem = HeatProblem::default();
    problem.numerics.cells = 20;
    problem.numerics.steps_per_cycle = 100;
    problem
}

fn piped(problem: &HeatProblem, length: f64, diameter: f64) -> HeatProblem {
    HeatProblem { pipe: Some(Pipe::nylon(length, diameter)), ..*problem }
}

#[track_caller]
fn close(value: f64, expected: f64, tolerance: f64) {
    assert!((value - expected).abs() <= tolerance * expected.abs(), "{value} is not {expected}");
}

fn nothing(mesh: &Mesh) -> Conductances {
    let (n, np) = (mesh.x.len(), mesh.pipe_cells);
    Conductances {
        wall: vec![0.0; n],
        mixing: vec![0.0; n],
        pipe_inner: vec![0.0; np],
        pipe_outer: vec![0.0; np],
    }
}

fn energy(mesh: &Mesh, state: &State) -> f64 {
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    CV * (product(&state.muscle.mass, &state.muscle.gas) + product(&state.pipe.mass, &state.pipe.gas))
        + product(&mesh.wall_capacity, &state.muscle.wall)
        + product(&mesh.pipe_capacity, &state.pipe.wall)
}

fn air(state: &State) -> f64 {
    state.muscle.mass.iter().chain(&state.pipe.mass).sum()
}

#[test]
fn every_step_keeps_energy_and_mass() {
    let mut swelling = coarse();
    swelling.tube.swelling = 0.7;
    swelling.surroundings.supply_k = 310.0;
    for problem in [swelling, piped(&swelling, 0.15, 0.004)] {
        let mesh = Mesh::new(&problem);
        let mut state = State::uniform(&mesh, problem.instant(0.0), 300.0, 320.0);
        let (mut stepper, mut c) = (Stepper::default(), Conductances::default());
        let outside = Outside { ambient: AMBIENT, supply: 310.0 };
        let (mut work, mut bought) = (0.0, 0.0);
        for i in 0..100 {
            let [from, to] = [i, i + 1].map(|i| problem.instant(f64::from(i) * 0.01));
            mesh.conductances(&problem, &state, from, &mut c);
            let before = state.clone();
            let step = Step { mesh: &mesh, conductances: &c, outside, from, to, dt: 0.01 };
            let exchange = stepper.step(step, &mut state).unwrap();
            let gained = energy(&mesh, &state) - energy(&mesh, &before);
            let balance = exchange.enthalpy - exchange.heat - exchange.work;
            // Of some 30 kJ in the walls.
            assert!((gained - balance).abs() < 1e-9, "step {i}: {gained} J against {balance} J");
            let moved = air(&state) - air(&before);
            assert!((moved - exchange.mass).abs() < 1e-16, "step {i}: {moved} kg");
            for cell in 0..20 {
                let (flow, mouth) = (&state.muscle.flow, state.pipe.flow.last().copied().unwrap_or(0.0));
                let mouth = if cell == mesh.pipe_cells { mouth } else { 0.0 };
                let gained = state.muscle.mass[cell] - before.muscle.mass[cell];
                let brought = 0.01 * (flow[cell] - flow[cell + 1] + mouth);
                assert!((gained - brought).abs() < 1e-16, "step {i}, cell {cell}: {gained} kg, {brought} kg");
            }
            assert!(state.muscle.flow[20].abs() < 1e-18);
            work += exchange.work;
            bought += exchange.work.abs();
        }
        assert!(work.abs() < 1e-12 && bought > 10.0, "{work} J of {bought} J");
    }
}

#[test]
fn conserved_energy_alone_gives_the_right_temperatures() {
    // The last solve must agree with the iteration before it, which is another form of the balance: a step repeated
    // with walls and conductances of its own end keeps cp M_old (T - T_old) = V dP + sum in.
    let problem = piped(&coarse(), 0.15, 0.004);
    let mesh = Mesh::new(&problem);
    let mut state = State::uniform(&mesh, problem.instant(0.0), 300.0, 320.0);
    let (mut stepper, mut c) = (Stepper::default(), Conductances::default());
    let outside = Outside { ambient: AMBIENT, supply: AMBIENT };
    for i in 0..60 {
        let [from, to] = [i, i + 1].map(|i| problem.instant(f64::from(i) * 0.01));
        mesh.conductances(&problem, &state, from, &mut c);
        let old = state.clone();
        let step = Step { mesh: &mesh, conductances: &c, outside, from, to, dt: 0.01 };
        stepper.step(step, &mut state).unwrap();
        let (gas, wall) = (&state.muscle.gas, &state.muscle.wall);
        for cell in 13..19 {
            let [left, right] = [state.muscle.flow[cell].max(0.0), (-state.muscle.flow[cell + 1]).max(0.0)];
            let brought = CP * (left * (gas[cell - 1] - gas[cell]) + right * (gas[cell + 1] - gas[cell]))
                + c.wall[cell] * (wall[cell] - gas[cell])
                + c.mixing[cell] * (gas[cell - 1] - gas[cell])
                + c.mixing[cell + 1] * (gas[cell + 1] - gas[cell]);
            let stored = CP * old.muscle.mass[cell] * (gas[cell] - old.muscle.gas[cell]) / 0.01
                - mesh.volume(cell, 1.0) * (to.pressure - from.pressure) / 0.01;
            assert!((brought - stored).abs() < 1e-5 * (1.0 + stored.abs()), "{brought} W, {stored} W");
        }
    }
}

/// Gas and walls without air passing the inlet: the pressure is what keeps the mass. Gives gas and wall after a time.
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
    // Extrapolated twice: third order.
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
    // The slowest modes of 20 and of 10 cells.
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
    // U outside by hand: 10 W/(m2 K) on a diameter of 23 mm, and rubber from 10.75 mm to 11.5 mm.
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

/// Charged without heat or mixing from 1 to 6 bar: temperatures of the gas.
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
    // So many cells that the fresh air doesn't reach the last.
    let [coarse, fine] = [200, 400].map(|steps| charged(40, steps).0[39]);
    let order = ((coarse - exact) / (fine - exact)).log2();
    assert!((order - 1.0).abs() < 0.1, "order {order}: {coarse} K, {fine} K, {exact} K");
    close(2.0 * fine - coarse, exact, 2e-4);
}

#[test]
fn a_charged_muscle_has_the_temperatures_of_the_closed_form() {
    // Air that entered at the pressure Pe lies at the distance L (Pe/P)^(1/gamma) from the end, at T_s (P/Pe)^(1-1/gamma):
    // T = T_s s^(1-gamma) at the distance s L, up to the air that was there at first.
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
    // A kink spreads as the root of the cells' length, over a width that is itself such: at least that order.
    let order = (coarse / fine).log2() / 2.0;
    assert!((0.8..1.2).contains(&order) && fine < 2.0, "order {order}, {fine} K");
}

#[test]
fn grid_and_time_step_converge_to_first_order() {
    let heat = |cells: usize, steps: usize| {
        let mut problem = HeatProblem::default();
        problem.numerics.cells = cells;
        problem.numerics.steps_per_cycle = steps;
        problem.solve().unwrap().heat_out_j
    };
    let order = |[coarse, middle, fine]: [f64; 3]| ((middle - coarse) / (fine - middle)).log2();
    let by_time = order([100, 200, 400].map(|steps| heat(10, steps)));
    assert!((0.85..1.1).contains(&by_time), "order in time {by_time}");
    let by_cells = order([16, 32, 64].map(|cells| heat(cells, 50)));
    assert!((0.7..1.2).contains(&by_cells), "order in space {by_cells}");
}

#[test]
fn what_s3_reports() {
    let problem = coarse();
    let pipe = |length, diameter| Some(Pipe::nylon(length, diameter));
    let pipes =
        [None, pipe(0.1, 0.004), pipe(0.15, 0.004), pipe(0.2, 0.004), pipe(0.2, 0.003), pipe(0.2, 0.006)];
    let all: Vec<HeatSolution> = trend(&problem, &pipes).into_iter().map(Result::unwrap).collect();
    let [none, short, middle, long, narrow, wide] = &all[..] else { panic!() };
    // Without a pipe the end is hottest, and hotter than anything with a pipe.
    assert!(none.end_rise_k > none.inlet_rise_k + 50.0 && none.hottest_x_m > 0.24);
    for with in &all[1..] {
        assert!(with.hottest_rise_k < none.end_rise_k - 5.0 && with.end_rise_k < none.end_rise_k - 5.0);
        // The pipe warms the inlet.
        assert!(with.inlet_rise_k > none.inlet_rise_k + 5.0);
    }
    // Longer: end cooler, inlet warmer. Wider: end warmer, inlet cooler.
    for [less, more] in [[short, middle], [middle, long], [wide, long], [long, narrow]] {
        assert!(more.end_rise_k < less.end_rise_k - 0.5 && more.inlet_rise_k > less.inlet_rise_k + 0.5);
    }
}

#[test]
fn conduction_alone_turns_two_of_the_trends() {
    let mut problem = coarse();
    problem.closures.natural_convection = 0.0;
    let pipes = [None, Some(Pipe::nylon(0.2, 0.003)), Some(Pipe::nylon(0.2, 0.006))];
    let all: Vec<HeatSolution> = trend(&problem, &pipes).into_iter().map(Result::unwrap).collect();
    assert!(all[2].inlet_rise_k > all[1].inlet_rise_k + 1.0);
    assert!(all[2].inlet_rise_k > all[0].end_rise_k);
    // The others hold.
    assert!(all[2].end_rise_k > all[1].end_rise_k + 1.0 && all[0].end_rise_k > all[2].end_rise_k + 20.0);
}

#[test]
fn in_the_periodic_state_heat_out_is_the_work_put_in() {
    let mut problem = coarse();
    problem.numerics.tolerance_k = 1e-7;
    problem.tube.swelling = 0.5;
    for problem in [problem, piped(&problem, 0.15, 0.005)] {
        let s = problem.solve().unwrap();
        close(s.enthalpy_in_j, s.heat_out_j, 1e-6);
        assert!(s.heat_out_j > 1.0 && s.wall_work_j.abs() < 1e-12 && s.mass_in_kg.abs() < 1e-12);
        let mesh = Mesh::new(&problem);
        let walls = s.muscle.wall_mean_k.iter().zip(&mesh.wall_outer);
        // A period of 1 s.
        close(walls.map(|(wall, outer)| outer * (wall - AMBIENT)).sum(), s.heat_out_j, 1e-9);
        assert!(s.residual_k <= 1e-7);
    }
}

#[test]
fn extrapolated_cycles_end_where_all_cycles_end() {
    let mut problem = piped(&coarse(), 0.15, 0.004);
    problem.numerics.cells = 10;
    problem.numerics.steps_per_cycle = 50;
    problem.tube.wall_thickness_m = 3e-4;
    problem.surroundings.outer_transfer_w_per_m2_k = 30.0;
    let fast = problem.solve().unwrap();
    problem.numerics.accelerate = false;
    let plain = problem.solve().unwrap();
    for (a, b) in fast.muscle.wall_mean_k.iter().zip(&plain.muscle.wall_mean_k) {
        assert!((a - b).abs() < 2e-3, "{a} K, {b} K");
    }
    close(fast.time_to_90_s, plain.time_to_90_s, 0.03);
    // By hand: the cycle's mean crosses 90 %, half a period after its start.
    let goal = 0.9 * plain.hottest_rise_k;
    let cell = plain.muscle.x_m.iter().position(|x| (x - plain.hottest_x_m).abs() < 1e-12).unwrap();
    let mut runner = cycle::Runner::new(&problem);
    let (mut before, mut after) = (0.0, 0.0);
    while after < goal {
        (before, after) = (after, runner.cycle().unwrap().muscle.wall_mean[cell] - AMBIENT);
    }
    let time = runner.cycles as f64 - 1.5 + (goal - before) / (after - before);
    close(plain.time_to_90_s, time, 1e-3);
    assert!(3 * fast.cycles < plain.cycles, "{} cycles of {}", fast.cycles, plain.cycles);
}

#[test]
fn without_amplitude_all_stays_ambient() {
    let mut problem = coarse();
    problem.drive.low_pa = 3e5;
    problem.drive.high_pa = 3e5;
    for problem in [problem, piped(&problem, 0.15, 0.005)] {
        let s = problem.solve().unwrap();
        for list in [&s.muscle, &s.pipe] {
            for t in
                [&list.wall_mean_k, &list.wall_max_k, &list.gas_mean_k, &list.gas_max_k].into_iter().flatten()
            {
                assert!((t - AMBIENT).abs() < 1e-9);
            }
        }
        close(s.ageing_factor, 1.0, 1e-9);
        assert!(s.heat_out_j.abs() < 1e-9 && s.time_to_90_s == 0.0 && s.peak_mach < 1e-9);
    }
}

#[test]
fn properties_and_nusselt_numbers_are_the_published_ones() {
    // Air at 300 K and 1 atm (Incropera, table A.4): 184.6e-7 Pa s, 26.3e-3 W/(m K), 1007 J/(kg K).
    close(viscosity(300.0), 184.6e-7, 2e-3);
    close(conductivity(300.0), 26.3e-3, 8e-3);
    close(conductivity(300.0), 1.846e-5 * 1004.675 / 0.71, 5e-4);
    close(CP, 1007.0, 3e-3);
    let mut closures = Closures { nusselt_floor: 0.0, natural_convection: 0.0, ..Closures::default() };
    // Gnielinski by hand at Re = 1e4, Pr = 0.71: f = 5.7^-2, Nu = 24.584/0.83921.
    close(nusselt(1e4, 0.0, &closures), 29.295, 1e-4);
    close(nusselt(100.0, 0.0, &closures), 3.66, 1e-12);
    close(nusselt(2300.0, 0.0, &closures), 3.66, 1e-12);
    close(nusselt(4000.0 - 1e-6, 0.0, &closures), nusselt(4000.0, 0.0, &closures), 1e-8);
    let middle = f64::midpoint(3.66, nusselt(4000.0, 0.0, &closures));
    close(nusselt(3150.0, 0.0, &closures), middle, 1e-12);
    closures.natural_convection = 0.55;
    close(nusselt(0.0, 1e6, &closures), 0.55 * 1e6_f64.powf(0.25), 1e-12);
    closures.nusselt_floor = 50.0;
    closures.nusselt_factor = 0.5;
    close(nusselt(0.0, 1e6, &closures), 25.0, 1e-12);
}

#[test]
fn convection_and_jet_are_as_documented() {
    let closures = Closures::default();
    let passage = Passage { hydraulic: 0.02, speed: 2.0, density: 5.0, gas: 320.0, wall: 300.0 };
    let (mu, k) = (viscosity(320.0), conductivity(320.0));
    let (re, nu) = (5.0 * 2.0 * 0.02 / mu, mu / 5.0);
    let ra = 9.80665 * 20.0 / 320.0 * 8e-6 * 0.71 / (nu * nu);
    let got = passage.convection(&closures);
    close(got.transfer, nusselt(re, ra, &closures) * k / 0.02, 1e-12);
    close(got.diffusivity, k / (5.0 * CP) + 0.3 * 2.0 * 0.02, 1e-12);
    // At rest natural convection is all.
    let rest = Passage { speed: 0.0, ..passage }.convection(&closures);
    close(rest.transfer, 0.55 * ra.powf(0.25) * k / 0.02, 1e-12);
    close(rest.diffusivity, k / (5.0 * CP), 1e-12);
    let jet = Jet { position: 0.1, speed: 50.0, contraction: 0.2 };
    close(jet.stirring(0.1, 0.02, &closures), 10.0, 1e-12);
    close(jet.stirring(0.18, 0.02, &closures), 10.0 / 1.0_f64.exp(), 1e-12);
    close(jet.stirring(0.08, 0.02, &closures), 10.0 / 1.0_f64.exp(), 1e-12);
}

#[test]
fn conductances_follow_the_flow() {
    let problem = piped(&coarse(), 0.125, 0.004);
    let (mesh, closures) = (Mesh::new(&problem), problem.closures);
    let now = Instant { pressure: 4e5, section: 1.0 };
    let mut state = State::uniform(&mesh, now, 310.0, 300.0);
    state.muscle.flow =
        (0..=20).map(|i| if i <= 10 { -1e-4 * f64::from(i) } else { 1e-4 * f64::from(20 - i) }).collect();
    state.pipe.flow = vec![2e-3; 11];
    let mut c = Conductances::default();
    mesh.conductances(&problem, &state, now, &mut c);
    let density = 4e5 / (R * 310.0);
    let nozzle = 2e-3 / (density * PI * 0.002_f64.powi(2));
    let at = |x: f64, flow: f64, section: f64, gap: f64, back: f64| {
        let stir = nozzle * 0.2 * (-(x - 0.125).abs() / (back * 0.02)).exp();
        let speed = (flow / (density * section)).hypot(stir);
        Passage { hydraulic: gap, speed, density, gas: 310.0, wall: 300.0 }.convection(&closures)
    };
    // Cell 4, beside the pipe of 5.5 mm outer diameter; cell 15 beyond it.
    let ring = PI * (0.01_f64.powi(2) - 0.002_75_f64.powi(2));
    let beside = at(0.05625, 4.5e-4, ring, 0.0145, 1.0);
    let beyond = at(0.19375, 4.5e-4, PI * 1e-4, 0.02, 4.0);
    let next = at(0.20625, 3.5e-4, PI * 1e-4, 0.02, 4.0);
    let inner =
        |h: f64| (1.0 / (h * PI * 0.02) + (10.75_f64 / 10.0).ln() / (2.0 * PI * 0.16)).recip() * 0.0125;
    close(c.wall[4], inner(beside.transfer), 1e-12);
    close(c.wall[15], inner(beyond.transfer), 1e-12);
    let mixing = CP * density * PI * 1e-4 * f64::midpoint(beyond.diffusivity, next.diffusivity) / 0.0125;
    close(c.mixing[16], mixing, 1e-12);
    let nylon = |from: f64, to: f64| (to / from).ln() / (2.0 * PI * 0.25);
    let outer = 1.0 / (beside.transfer * PI * 0.0055) + nylon(2.375, 2.75);
    close(c.pipe_outer[4], 0.0125 / outer, 1e-12);
    let pipe =
        Passage { hydraulic: 0.004, speed: nozzle, density, gas: 310.0, wall: 300.0 }.convection(&closures);
    close(c.pipe_inner[4], 0.0125 / (1.0 / (pipe.transfer * PI * 0.004) + nylon(2.0, 2.375)), 1e-12);
    // Air that is drawn out makes no jet.
    state.pipe.flow = vec![-2e-3; 11];
    state.muscle.flow = vec![0.0; 21];
    mesh.conductances(&problem, &state, now, &mut c);
    let still =
        Passage { hydraulic: 0.02, speed: 0.0, density, gas: 310.0, wall: 300.0 }.convection(&closures);
    close(c.wall[15], inner(still.transfer), 1e-12);
}

#[test]
fn mach_numbers_are_those_of_the_nozzle() {
    let sound = |t: f64| (1.4 * R * t).sqrt();
    for problem in [coarse(), piped(&coarse(), 0.125, 0.006)] {
        // Port and pipe are alike.
        let mesh = Mesh::new(&problem);
        let now = Instant { pressure: 2e5, section: 1.0 };
        let mut state = State::uniform(&mesh, now, 350.0, 300.0);
        let speed = |flow: f64, t: f64| flow / (2e5 / (R * t) * PI * 9e-6);
        let chain = if mesh.pipe_cells > 0 { &mut state.pipe } else { &mut state.muscle };
        chain.flow[0] = 3e-3;
        close(cycle::mach(&mesh, &state, now, 280.0), speed(3e-3, 280.0) / sound(280.0), 1e-12);
        let chain = if mesh.pipe_cells > 0 { &mut state.pipe } else { &mut state.muscle };
        chain.flow[0] = -3e-3;
        close(cycle::mach(&mesh, &state, now, 280.0), speed(3e-3, 350.0) / sound(350.0), 1e-12);
    }
}

#[test]
fn a_pipe_harms_a_short_wide_muscle() {
    // L = 6 D: the jet of the port alone stirs the end.
    let mut problem = coarse();
    problem.tube.inner_diameter_m = 0.04;
    let with = piped(&problem, 0.2, 0.008).solve().unwrap();
    let without = problem.solve().unwrap();
    assert!(with.inlet_rise_k > without.end_rise_k + 10.0 && with.end_rise_k < without.end_rise_k);
}

#[test]
fn cells_fill_the_muscle() {
    let problem = piped(&coarse(), 0.11, 0.004);
    let mesh = Mesh::new(&problem);
    close(mesh.dx.iter().sum(), 0.25, 1e-14);
    close(mesh.dx[..mesh.pipe_cells].iter().sum(), 0.11, 1e-14);
    let volume: f64 = (0..20).map(|i| mesh.volume(i, 1.3)).sum();
    close(volume, PI * (1.3 * 1e-4 * 0.25 - 0.002_75_f64.powi(2) * 0.11), 1e-13);
    close(mesh.pipe_volume.iter().sum(), PI * 4e-6 * 0.11, 1e-13);
    let wall: f64 = mesh.wall_capacity.iter().sum();
    close(wall, 2e6 * 0.25 * PI * (0.0115_f64.powi(2) - 1e-4), 1e-13);
    let pipe: f64 = mesh.pipe_capacity.iter().sum();
    close(pipe, 1.9e6 * 0.11 * PI * (0.002_75_f64.powi(2) - 4e-6), 1e-13);
    for i in 1..20 {
        close(mesh.x[i] - mesh.x[i - 1], f64::midpoint(mesh.dx[i], mesh.dx[i - 1]), 1e-12);
    }
}

#[test]
fn the_pressure_rises_and_falls_as_asked() {
    let mut problem = coarse();
    problem.drive = Drive { low_pa: 1e5, high_pa: 4e5, period_s: 2.0, duty: 0.4, ramp_s: 0.5 };
    problem.tube.swelling = 0.6;
    let at = |time: f64| problem.instant(time / 2.0);
    for (time, level) in
        [(0.0, 0.0), (0.25, 0.5), (0.5, 1.0), (0.8, 1.0), (1.05, 0.5), (1.3, 0.0), (2.0, 0.0)]
    {
        close(at(time).pressure, 101_325.0 + 1e5 + 3e5 * level, 1e-12);
        close(at(time).section, 1.0 + 0.6 * level, 1e-12);
    }
    // 10 s^3 - 15 s^4 + 6 s^5 at s = 0.2.
    close(at(0.1).section, 1.0 + 0.6 * 0.057_92, 1e-12);
}

#[test]
fn ageing_follows_arrhenius() {
    let mut problem = coarse();
    let reference = problem.solve().unwrap();
    let expected = |wall: f64, energy: f64| (energy / 8.314_462_618 * (1.0 / AMBIENT - 1.0 / wall)).exp();
    // The ripple of the wall in a cycle is a fraction of a kelvin: its mean factor is that of its mean temperature.
    close(reference.ageing_factor, expected(AMBIENT + reference.hottest_rise_k, 85e3), 2e-3);
    problem.activation_energy_j_per_mol = 0.0;
    close(problem.solve().unwrap().ageing_factor, 1.0, 1e-12);
}

#[test]
fn tridiagonal_rows_are_solved() {
    let mut rows = Tridiagonal::default();
    rows.reset(3);
    rows.couple(1, 2.0);
    rows.couple(2, 3.0);
    for i in 0..3 {
        rows.diagonal[i] += 1.0;
    }
    // x = (1, 2, 4).
    rows.right = vec![3.0 - 4.0, -2.0 + 12.0 - 12.0, -6.0 + 16.0];
    let mut x = [0.0; 3];
    rows.solve(&mut x);
    for (x, expected) in x.iter().zip([1.0, 2.0, 4.0]) {
        close(*x, expected, 1e-14);
    }
}

#[test]
fn senseless_numbers_are_refused() {
    let refused = |change: fn(&mut HeatProblem), word: &str| {
        for base in [coarse(), piped(&coarse(), 0.1, 0.004)] {
            let mut problem = base;
            change(&mut problem);
            let message = problem.solve().unwrap_err().to_string();
            assert!(message.contains(word), "{message}");
        }
    };
    refused(|p| p.tube.length_m = 0.0, "length of the muscle");
    refused(|p| p.tube.inner_diameter_m = f64::NAN, "inner diameter of the muscle");
    refused(|p| p.tube.wall_thickness_m = -1.0, "thickness");
    refused(|p| p.tube.wall_conductivity_w_per_m_k = 0.0, "conductivity");
    refused(|p| p.tube.wall_heat_capacity_j_per_m3_k = f64::INFINITY, "heat capacity");
    refused(|p| p.tube.port_diameter_m = 0.03, "port");
    refused(|p| p.tube.swelling = -0.1, "swelling");
    refused(|p| p.drive.low_pa = -1.0, "low gauge pressure");
    refused(|p| p.drive.high_pa = f64::NAN, "high gauge pressure");
    refused(|p| p.drive.period_s = 0.0, "period");
    refused(|p| p.drive.duty = 1.0, "duty");
    refused(|p| p.drive.ramp_s = 0.6, "ramp");
    refused(|p| p.surroundings.ambient_k = 20.0, "ambient temperature");
    refused(|p| p.surroundings.outer_transfer_w_per_m2_k = 0.0, "outer heat transfer");
    refused(|p| p.closures.mixing = f64::NAN, "mixing");
    refused(|p| p.numerics.cells = 3, "cells");
    refused(|p| p.numerics.steps_per_cycle = 0, "steps");
    refused(|p| p.numerics.tolerance_k = 0.0, "tolerance");
    refused(|p| p.activation_energy_j_per_mol = -1.0, "activation");
    refused(|p| p.pipe = Some(Pipe::nylon(0.25, 0.004)), "length of the pipe");
    refused(|p| p.pipe = Some(Pipe::nylon(f64::NAN, 0.004)), "length of the pipe");
    refused(|p| p.pipe = Some(Pipe::nylon(0.1, 0.019)), "outer diameter of the pipe");
    refused(|p| p.pipe = Some(Pipe::nylon(0.1, -0.004)), "inner diameter of the pipe");
    refused(|p| p.pipe = Some(Pipe::nylon(0.1, 0.0005)), "wider pipe");
    refused(|p| p.numerics.max_cycles = 2, "not periodic after 2");
}

#[test]
fn all_kinds_of_muscles_have_a_periodic_state() {
    // A sequence that fills (0, 1) evenly in each of its coordinates.
    let mut count = 0.0;
    let mut solved = 0;
    for i in 0..48 {
        let mut between = |low: f64, high: f64| {
            count += 1.0;
            low * (high / low).powf((count * 0.754_877_666 + f64::from(i) * 0.569_840_29).fract())
        };
        let mut problem = HeatProblem::default();
        problem.numerics.cells = 8;
        problem.numerics.steps_per_cycle = 40;
        let tube = &mut problem.tube;
        tube.length_m = between(0.02, 2.0);
        tube.inner_diameter_m = between(0.003, 0.1);
        tube.port_diameter_m = tube.inner_diameter_m * between(0.1, 1.0);
        tube.wall_thickness_m = tube.inner_diameter_m * between(0.01, 0.3);
        tube.swelling = if i % 3 == 0 { between(0.1, 2.0) } else { 0.0 };
        let (length, diameter) = (tube.length_m, tube.inner_diameter_m);
        let drive = &mut problem.drive;
        drive.high_pa = between(2e4, 1e6);
        drive.period_s = between(0.05, 100.0);
        drive.duty = between(0.1, 0.9);
        drive.ramp_s = drive.period_s * drive.duty.min(1.0 - drive.duty) * between(0.1, 1.0);
        problem.surroundings.outer_transfer_w_per_m2_k = between(1.0, 300.0);
        if i % 2 == 0 {
            problem = piped(&problem, length * between(0.05, 0.98), diameter * between(0.1, 0.7));
            problem.pipe.as_mut().unwrap().wall_thickness_m = diameter * between(0.01, 0.1);
        }
        match problem.solve() {
            Ok(s) => {
                solved += 1;
                assert!(s.end_rise_k.is_finite() && s.time_to_90_s >= 0.0 && s.hottest_rise_k > 0.0, "{i}");
                let off = (s.enthalpy_in_j - s.heat_out_j).abs();
                assert!(off < 0.01 * s.heat_out_j, "case {i}: {} J, off by {off} J", s.heat_out_j);
            }
            Err(HeatError::Choked { mach }) => assert!(mach >= 1.0),
            Err(error) => panic!("case {i}: {error}"),
        }
    }
    assert!(solved >= 25, "{solved}");
}
