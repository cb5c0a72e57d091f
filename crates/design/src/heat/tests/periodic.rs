//! The periodic state: orders of convergence, trends of S3, the balance of a cycle, ageing.

use super::*;

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
    // Without a pipe the end is hottest, and hotter than any point with a pipe.
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
    // The other trends hold.
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
    // By hand: the mean over the cycle crosses 90 %, half a period after its start.
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
fn a_pipe_harms_a_short_wide_muscle() {
    // L = 6 D: the jet of the port alone stirs the end.
    let mut problem = coarse();
    problem.tube.inner_diameter_m = 0.04;
    let with = piped(&problem, 0.2, 0.008).solve().unwrap();
    let without = problem.solve().unwrap();
    assert!(with.inlet_rise_k > without.end_rise_k + 10.0 && with.end_rise_k < without.end_rise_k);
}

#[test]
fn ageing_follows_arrhenius() {
    let mut problem = coarse();
    let reference = problem.solve().unwrap();
    let expected = |wall: f64, energy: f64| (energy / 8.314_462_618 * (1.0 / AMBIENT - 1.0 / wall)).exp();
    // The ripple of the wall in a cycle is a fraction of a kelvin: its mean factor is the factor at its mean
    // temperature.
    close(reference.ageing_factor, expected(AMBIENT + reference.hottest_rise_k, 85e3), 2e-3);
    problem.activation_energy_j_per_mol = 0.0;
    close(problem.solve().unwrap().ageing_factor, 1.0, 1e-12);
}

#[test]
fn all_kinds_of_muscles_have_a_periodic_state() {
    // A low-discrepancy sequence that fills (0, 1) evenly in each coordinate.
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
