//! A meridian by the equilibrium ODE and by a quadrature.

use bulge_numerics::{Dual, Real};

use crate::meridian::{Middle, NoTrajectory, SHORTENING, Trajectory, trajectory};
use crate::net::Net;
use crate::quadrature;
use crate::shooting::FIRST_INTEGRAL;

/// Largest difference of both ways in lengths, relative to that of the fibres, at which the quadrature's derivatives
/// stand for those of the ODE.
const BOTH_WAYS: f64 = 1e-7;

/// The values of the ODE, with the derivatives of the quadrature: an integration with derivatives would take three times as
/// long, and what is to be checked are values.
pub(crate) fn values_of_ode<const N: usize>(
    net: &Net<Dual<N>>,
    middle: Middle<Dual<N>>,
    tolerance: f64,
) -> Result<Trajectory<Dual<N>>, NoTrajectory> {
    let values = trajectory(&net.constant(), middle.constant(), tolerance)?;
    let agrees = |slopes: &Trajectory<Dual<N>>| {
        let is_close =
            |value: f64, other: Dual<N>| (value - other.value()).abs() <= BOTH_WAYS * values.half_fibre;
        slopes.first_integral <= FIRST_INTEGRAL
            && is_close(values.half_fibre, slopes.half_fibre)
            && is_close(values.end[SHORTENING], slopes.end[SHORTENING])
    };
    let slopes = quadrature::trajectory(net, middle);
    let spent =
        values.evaluations + slopes.as_ref().map_or_else(|none| none.evaluations, |run| run.evaluations);
    let Some(slopes) = slopes.ok().filter(agrees) else {
        let run = trajectory(net, middle, tolerance)?;
        return Ok(Trajectory { evaluations: run.evaluations + spent, ..run });
    };
    let both = |value: f64, slope: Dual<N>| Dual::new(value, *slope.gradient());
    Ok(Trajectory {
        half_fibre: both(values.half_fibre, slopes.half_fibre),
        end: std::array::from_fn(|i| both(values.end[i], slopes.end[i])),
        force: both(values.force, slopes.force),
        mid_tension: both(values.mid_tension, slopes.mid_tension),
        steps: values.steps,
        evaluations: spent,
        first_integral: values.first_integral,
    })
}
