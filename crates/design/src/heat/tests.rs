//! Heat in a muscle: conservation to rounding, closed forms, orders of convergence, and the trends of S3.

mod closed_forms;
mod mistakes;
mod parts;
mod periodic;
mod steps;

use super::gas::{CP, CV, GAMMA, Jet, Passage, R, conductivity, nusselt, viscosity};
use super::mesh::{Conductances, Instant, Mesh};
use super::state::{Outside, State};
use super::step::{Step, Stepper};
use super::tridiagonal::Tridiagonal;
use super::*;
use std::f64::consts::PI;

const AMBIENT: f64 = 293.15;

/// A coarse problem, for many solves.
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

fn air(state: &State) -> f64 {
    state.muscle.mass.iter().chain(&state.pipe.mass).sum()
}
