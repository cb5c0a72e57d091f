//! Impossible inputs and their error messages.

use super::*;

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
