//! One step conserves energy and mass to rounding.

use super::*;
use bulge_numerics::vector::dot;

fn energy(mesh: &Mesh, state: &State) -> f64 {
    CV * (dot(&state.muscle.mass, &state.muscle.gas) + dot(&state.pipe.mass, &state.pipe.gas))
        + dot(&mesh.wall_capacity, &state.muscle.wall)
        + dot(&mesh.pipe_capacity, &state.pipe.wall)
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
            // Out of some 30 kJ in the walls.
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
    // The last solve must agree with the iteration before it, which uses another form of the balance: a step
    // repeated with the final walls and conductances satisfies cp M_old (T - T_old) = V dP + sum in.
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
