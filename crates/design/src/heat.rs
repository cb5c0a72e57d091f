//! Heat in a muscle under repeated charging and discharging, with or without an inner pipe.
//!
//! The air at the closed end is compressed and expanded but hardly exchanged, so that end gets hot. A pipe
//! that carries the air close to the end keeps it cool (S3: "Study on Mechanical Behaviour of Pneumatic
//! Artificial Muscle and Methods to Improve it", section 4, which gives trends and no equations). The model
//! is one-dimensional along the axis x, from the inlet at 0 to the closed end at L.
//!
//! ```text
//! P(t)           uniform in space (low Mach), prescribed: low, ramp up, high, ramp down
//! section A(t)   A0 (1 + swelling s), s = (P - P_low)/(P_high - P_low); beside the pipe its outer section less
//! mass           d(rho A)/dt + dm'/dx = 0,                        rho = P/(R T), m'(L) = 0
//! energy         d(rho cv T A)/dt + P dA/dt + d(m' cp T)/dx = q + d/dx(rho cp A D_m dT/dx)
//!                q = U (T_w - T) + U_o (T_pw - T) by length
//! wall           C dT_w/dt   = U (T - T_w) + U_a (T_a - T_w) + d/dx(k S dT_w/dx)
//! pipe wall      C_p dT_pw/dt = U_i (T_p - T_pw) + U_o (T - T_pw) + d/dx(k_p S_p dT_pw/dx)
//! pipe gas       as the muscle's, with q = U_i (T_pw - T_p) and without mixing
//! ```
//! Without a pipe air passes the inlet x = 0, and charged air has the temperature T_s. With a pipe x = 0 is
//! closed around it. Air then enters and leaves the muscle in the first cell behind the mouth, x = L_p, and
//! flows from there in both directions. T_w is the temperature at mid-thickness. U contains the film and half
//! of the wall, for a cylinder.
//!
//! # Closures
//!
//! All closures are assumptions. Their constants are in [`Closures`], with their ranges.
//!
//! ```text
//! air         R = 287.05 J/(kg K), gamma = 1.4, Pr = 0.71, mu by Sutherland, k = mu cp/Pr
//! speed       u_e^2 = u^2 + w^2, Re = rho u_e D_h/mu, D_h = D, beside the pipe D - d_o, in it d
//! stirring    w = c_j u_0 (d/D) exp(-|x - x_n|/(c D)): the jet of speed u_0 from a nozzle of diameter d at x_n (mouth or port)
//!             keeps its momentum flux in the section of the muscle; c = jet_reach ahead, jet_back behind; 0 while discharging
//! transfer    h = Nu k/D_h, Nu = max(Nu_flow, c_n Ra^(1/4), Nu_floor)
//!             Nu_flow = 3.66 to Re = 2300, linear to 4000, then Gnielinski (1976, 2013) with f = (1.8 lg Re - 1.5)^-2
//!             Ra = g |T - T_w| D_h^3 Pr/(T nu^2), c_n = 0.55: natural convection, the usual size in closed cylinders
//!             Nu_floor = 5.78: transient conduction in a cylinder, the square of the first zero of J0
//! mixing      D_m = k/(rho cp) + c_m chi u_e D_h, chi from 0 at Re = 2300 to 1 at 4000; c_m = 0.3 (Taylor 1954, turbulent tubes)
//! ageing      exp(Ea/R (1/T_a - 1/T_w)), mean over the cycle; Ea = 85 kJ/mol (70 to 110, oxidation of natural rubber)
//! ```
//! The ageing factor is relative to the same rubber at the ambient temperature. It is not a service life, and
//! above some 100 degC it is only a warning. Neglected: end fittings (they take up heat; the ends are
//! insulated here), heat from friction and from the hysteresis of the rubber, pressure drop in the pipe,
//! kinetic energy, humidity, and persistence of turbulence from stroke to stroke.
//!
//! # Method
//!
//! Finite volumes with upwind fluxes and backward Euler: first order in space and time. The internal energy
//! of the gas is `cv P V/R` whatever its temperatures. So the heats of a step determine all enthalpy flows,
//! and energy and mass are conserved to rounding. The periodic state is found by Anderson extrapolation of
//! cycles. The time to reach it is computed with jumps over many cycles, and therefore accurate to some 3 %.
//!
//! # Results
//!
//! Mean wall temperature above the ambient in K, default muscle (250 mm, 20 mm, 5 bar, 1 s), 40 cells, 200 steps:
//!
//! ```text
//! pipe                   none   0.10 m  0.15 m  0.20 m  0.20 m  0.20 m
//! inner diameter         -      4 mm    4 mm    4 mm    3 mm    6 mm
//! end                    90.8   49.6    28.4    6.5     5.0     11.6
//! inlet                  -2.5   63.8    70.4    73.2    74.7    71.5
//! ```
//! All trends reported in S3 result: without a pipe the end is hottest, and hotter than any point with one; a
//! longer pipe cools the end and warms the inlet; a wider one warms the end and cools the inlet. They don't
//! hold everywhere:
//!
//! - *Wider pipe, cooler inlet* needs natural convection in the default muscle. The gap beside a wider pipe
//!   is narrower, and with conduction alone (`natural_convection = 0`, and still at 0.3) a wider pipe warms
//!   the inlet. The trend also reverses in a muscle of 40 mm, and vanishes with a pipe of 0.4 L or with a
//!   section that swells by 80 %.
//! - *Inlet cooler than the end was without a pipe*: with conduction alone and a long wide pipe it is
//!   slightly hotter. In a short muscle of 40 mm (L = 6 D) the jet of the port itself already stirs the end,
//!   and a pipe is harmful.
//! - *Wider pipe, warmer end* reverses between 3 and 4 mm at the strongest mixing (1.0) and in the muscle of
//!   40 mm.
//!
//! Longer pipes cool the end and warm the inlet for every constant in its range, varied one at a time (20
//! cells, 100 steps). Halving the time step lowers the rise of the end without a pipe by 4 %, halving the
//! cell length raises it by 6 %: the errors partly cancel. No constant was fitted. But natural convection was
//! added after conduction alone had missed the two trends named above, so these two are no independent
//! support of the model; c_n is a usual value, not measured on a muscle. The constants change the rise by
//! some 20 %, c_n by 30 %, the outer coefficient by more. Use the model to compare designs; trust absolute
//! temperatures only after a measurement has fixed the coefficients.

mod check;
mod cycle;
mod gas;
mod mesh;
mod outcome;
mod periodic;
mod problem;
mod question;
mod state;
mod step;
#[cfg(test)]
mod tests;
mod tridiagonal;

pub use outcome::{HeatError, HeatProfile, HeatSolution};
pub use problem::{Closures, Drive, HeatNumerics, HeatProblem, Pipe, Surroundings, Tube};
pub use question::{HeatAnswer, HeatDocument, HeatQuestion, pipe_name};

use rayon::prelude::*;

impl HeatProblem {
    /// Computes the periodic steady state, and the time to reach it from the ambient temperature.
    ///
    /// # Errors
    /// [`HeatError::Invalid`] for invalid numbers, [`HeatError::Choked`] if the inlet chokes,
    /// [`HeatError::NotConverged`] if the numerics don't converge.
    pub fn solve(&self) -> Result<HeatSolution, HeatError> {
        check::check(self)?;
        let mut runner = cycle::Runner::new(self);
        let (tally, residual_k) = periodic::steady(&mut runner)?;
        let steady = runner.temperatures();
        let walls = &tally.muscle.wall_mean;
        let ambient = self.surroundings.ambient_k;
        let (hottest, most) = walls
            .iter()
            .enumerate()
            .fold((0, 0.0), |best: (usize, f64), (i, wall)| if *wall > best.1 { (i, *wall) } else { best });
        let mut start = cycle::Runner::new(self);
        let time_to_90_s = periodic::time_to_90(&mut start, hottest, &steady, most)?;
        let (first, last) = (walls[0], walls[walls.len() - 1]);
        let muscle = tally.muscle.profile(&runner.mesh.x);
        Ok(HeatSolution {
            end_rise_k: last - ambient,
            inlet_rise_k: first - ambient,
            hottest_rise_k: most - ambient,
            hottest_x_m: runner.mesh.x[hottest],
            time_to_90_s,
            ageing_factor: muscle.ageing_factor.iter().fold(0.0, |a: f64, b| a.max(*b)),
            heat_out_j: tally.heat,
            enthalpy_in_j: tally.enthalpy,
            wall_work_j: tally.work,
            mass_in_kg: tally.mass,
            peak_mach: tally.peak_mach,
            cycles: runner.cycles + start.cycles,
            residual_k,
            pipe: tally.pipe.profile(&runner.mesh.x),
            muscle,
        })
    }
}

/// Solves one problem with each of a list of pipes (`None`: without a pipe), in parallel; the results are in
/// the order of the list.
///
/// # Errors
/// Each result has its own, as [`HeatProblem::solve`].
#[must_use]
pub fn trend(problem: &HeatProblem, pipes: &[Option<Pipe>]) -> Vec<Result<HeatSolution, HeatError>> {
    pipes.par_iter().map(|pipe| HeatProblem { pipe: *pipe, ..*problem }.solve()).collect()
}
