//! Parts of a step: properties of air, convection, cells, the drive, tridiagonal systems.

use super::*;

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
    // At rest there is only natural convection.
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
    // Air that flows out makes no jet.
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
        // Port and pipe have the same section.
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
