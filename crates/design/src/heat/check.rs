//! Checks of the inputs of the heat model.

use super::{HeatError, HeatProblem};

/// Name of a number, its value, its smallest and largest valid value, and this range in words.
type Row = (&'static str, f64, [f64; 2], &'static str);

/// Rejects values without physical sense.
pub(super) fn check(problem: &HeatProblem) -> Result<(), HeatError> {
    let rows = tube(problem).into_iter().chain(pipe(problem)).chain(drive(problem)).chain(rest(problem));
    for (what, value, [low, high], range) in rows {
        if !(low..=high).contains(&value) {
            return Err(HeatError::Invalid { what, value, range });
        }
    }
    Ok(())
}

fn tube(problem: &HeatProblem) -> Vec<Row> {
    let t = &problem.tube;
    let (length, diameter) = (t.length_m, t.inner_diameter_m);
    let (k, c) = (t.wall_conductivity_w_per_m_k, t.wall_heat_capacity_j_per_m3_k);
    vec![
        ("the length of the muscle [m]", length, [1e-3, 100.0], "1 mm to 100 m"),
        ("the inner diameter of the muscle [m]", diameter, [1e-4, 1.0], "0.1 mm to 1 m"),
        (
            "the thickness of the muscle's wall [m]",
            t.wall_thickness_m,
            [1e-6, diameter],
            "0.001 mm to the inner diameter",
        ),
        ("the conductivity of the muscle's wall [W/(m K)]", k, [1e-3, 500.0], "1e-3 to 500"),
        ("the heat capacity of the muscle's wall [J/(m3 K)]", c, [1e4, 1e7], "1e4 to 1e7"),
        (
            "the diameter of the port [m]",
            t.port_diameter_m,
            [1e-5, diameter],
            "0.01 mm to the inner diameter of the muscle",
        ),
        ("the swelling of the muscle", t.swelling, [0.0, 10.0], "0 to 10"),
    ]
}

fn pipe(problem: &HeatProblem) -> Vec<Row> {
    let Some(p) = &problem.pipe else { return Vec::new() };
    let (length, diameter) = (problem.tube.length_m, problem.tube.inner_diameter_m);
    let outer = p.inner_diameter_m + 2.0 * p.wall_thickness_m;
    let (k, c) = (p.conductivity_w_per_m_k, p.heat_capacity_j_per_m3_k);
    vec![
        (
            "the length of the pipe [m]",
            p.length_m,
            [0.01 * length, 0.99 * length],
            "0.01 to 0.99 of the muscle's length; leave the pipe out for none",
        ),
        ("the inner diameter of the pipe [m]", p.inner_diameter_m, [1e-5, f64::INFINITY], "at least 0.01 mm"),
        (
            "the thickness of the pipe's wall [m]",
            p.wall_thickness_m,
            [1e-6, diameter],
            "0.001 mm to the inner diameter of the muscle",
        ),
        (
            "the outer diameter of the pipe [m]",
            outer,
            [f64::NEG_INFINITY, 0.95 * diameter],
            "at most 0.95 of the muscle's inner diameter",
        ),
        ("the conductivity of the pipe [W/(m K)]", k, [1e-3, 500.0], "1e-3 to 500"),
        ("the heat capacity of the pipe [J/(m3 K)]", c, [1e4, 1e7], "1e4 to 1e7"),
    ]
}

fn drive(problem: &HeatProblem) -> Vec<Row> {
    let d = &problem.drive;
    let plateau = d.period_s * d.duty.min(1.0 - d.duty);
    vec![
        ("the low gauge pressure [Pa]", d.low_pa, [0.0, 1e7], "0 bar to 100 bar"),
        ("the high gauge pressure [Pa]", d.high_pa, [d.low_pa, 1e7], "the low one to 100 bar"),
        ("the period [s]", d.period_s, [1e-3, 1e5], "1 ms to 100 000 s"),
        ("the duty [%]", d.duty, [0.01, 0.99], "1 % to 99 %"),
        (
            "the ramp [s]",
            d.ramp_s,
            [1e-2 * plateau, plateau * (1.0 + 1e-12)],
            "0.01 to 1 times the shorter of the charged and the discharged part of the period",
        ),
    ]
}

fn rest(problem: &HeatProblem) -> Vec<Row> {
    let (s, c, n) = (&problem.surroundings, &problem.closures, &problem.numerics);
    let energy = problem.activation_energy_j_per_mol;
    vec![
        ("the ambient temperature [K]", s.ambient_k, [150.0, 600.0], "150 K to 600 K"),
        ("the supply temperature [K]", s.supply_k, [150.0, 600.0], "150 K to 600 K"),
        ("the ambient pressure [Pa]", s.pressure_pa, [1e3, 1e7], "0.01 bar to 100 bar"),
        (
            "the outer heat transfer coefficient [W/(m2 K)]",
            s.outer_transfer_w_per_m2_k,
            [0.1, 1e5],
            "0.1 to 1e5",
        ),
        ("the Nusselt floor", c.nusselt_floor, [0.0, 1e3], "0 to 1e3"),
        ("the constant of natural convection", c.natural_convection, [0.0, 10.0], "0 to 10"),
        ("the Nusselt factor", c.nusselt_factor, [0.0, 100.0], "0 to 100"),
        ("the mixing constant", c.mixing, [0.0, 100.0], "0 to 100"),
        ("the jet's strength", c.jet_strength, [0.0, 100.0], "0 to 100"),
        ("the jet's reach", c.jet_reach, [0.01, 1e3], "0.01 to 1e3"),
        ("the jet's reach behind", c.jet_back, [0.01, 1e3], "0.01 to 1e3"),
        ("the activation energy [J/mol]", energy, [0.0, 3e5], "0 to 3e5"),
        ("the number of cells", n.cells as f64, [4.0, 2000.0], "4 to 2000"),
        ("the number of steps in a cycle", n.steps_per_cycle as f64, [20.0, 1e5], "20 to 100 000"),
        ("the tolerance [K]", n.tolerance_k, [1e-9, 1.0], "1e-9 to 1"),
        ("the number of cycles allowed", n.max_cycles as f64, [1.0, 1e8], "1 to 100 000 000"),
    ]
}
