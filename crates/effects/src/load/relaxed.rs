//! The value of a first-order memory at the end of a step, such as relaxing rubber or a filter.

use bulge_numerics::Real;

use crate::effect::Jet;

/// After more than this many time constants nothing of the held value remains: exp(-750) is 0.
const FORGOTTEN: f64 = 750.0;

/// `q' = x' - q/tau` over a step of duration `since`, in which x changes linearly by `change`.
///
/// ```text
/// q -> q exp(-h) + change (1 - exp(-h))/h,   h = since/tau
/// ```
/// This is exact. At tau = 0 nothing is held, and the derivative by tau is that of the limit, `change/since`.
pub(crate) fn relaxed(held: Jet, change: Jet, since: f64, tau: Jet) -> Jet {
    if since >= FORGOTTEN * tau.value() {
        return if since > 0.0 { change * (tau / since) } else { Jet::from(0.0) };
    }
    let over = Jet::from(since) / tau;
    held * (-over).exp() + mean_decay(over) * change
}

/// The mean of exp(-x) over 0 ..= h: (1 - exp(-h))/h, or 1 at h = 0.
fn mean_decay(over: Jet) -> Jet {
    let h = over.value();
    let decay = (-h).exp();
    if h < 0.01 {
        // The series is used where the quotients lose digits. The first omitted term is below 1e-15.
        let mean = 1.0 - h / 2.0 * (1.0 - h / 3.0 * (1.0 - h / 4.0 * (1.0 - h / 5.0 * (1.0 - h / 6.0))));
        let high = 1.0 - h * 4.0 / 15.0 * (1.0 - h * 5.0 / 24.0 * (1.0 - h * 6.0 / 35.0));
        let slope = -0.5 + h / 3.0 * (1.0 - h * 3.0 / 8.0 * high);
        return over.chain(mean, slope);
    }
    let mean = -(-h).exp_m1() / h;
    over.chain(mean, (decay - mean) / h)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_from_rest_ends_in_its_steady_lag() {
        // q = tau s (1 - exp(-t/tau)) after a ramp of slope s = 3/s for 2 s, in three uneven steps.
        let run = |tau: f64| {
            let step = |held, since| relaxed(held, Jet::from(3.0 * since), since, Jet::variable(tau, 0));
            [0.1, 0.7, 1.2].into_iter().fold(Jet::from(0.0), step)
        };
        for tau in [1e-3_f64, 0.5, 2.0, 40.0] {
            let (found, fades) = (run(tau), (-2.0 / tau).exp());
            assert!((found.value() - 3.0 * tau * (1.0 - fades)).abs() < 1e-12, "{tau}: {found:?}");
            let derivative = 3.0 * (1.0 - fades) - 6.0 / tau * fades;
            assert!((found.gradient()[0] - derivative).abs() < 1e-10, "{tau}: {found:?}");
        }
        // Without a time constant nothing is held. The derivative shows that a small one holds its part of
        // the slope.
        assert_eq!((run(0.0).value(), run(0.0).gradient()[0]), (0.0, 3.0));
        let nothing = relaxed(Jet::from(1.0), Jet::from(1.0), 0.0, Jet::from(0.0));
        assert_eq!(nothing, Jet::from(0.0));
    }

    #[test]
    fn in_no_time_everything_is_held() {
        let found = relaxed(Jet::from(1.0), Jet::from(0.5), 0.0, Jet::from(2.0));
        assert_eq!(found, Jet::from(1.5));
    }

    /// The sum of (-h)^k/(k + 1)!, which ends with its 14th term for these h, and its derivative.
    #[test]
    fn the_mean_of_a_short_decay_is_exact() {
        for h in [1e-9_f64, 1e-3, 0.0099, 0.02] {
            let (mut term, mut mean, mut slope) = (1.0_f64, 1.0_f64, 0.0_f64);
            for k in 1..14 {
                slope -= f64::from(k) * term / f64::from(k + 1);
                term *= -h / f64::from(k + 1);
                mean += term;
            }
            let at = mean_decay(Jet::variable(h, 0));
            assert!((at.value() - mean).abs() < 1e-15, "{h}: {} {mean}", at.value());
            // From 0.01 on its slope is a quotient of differences, which lose two digits there.
            let digits = if h < 0.01 { 1e-15 } else { 2e-14 };
            assert!((at.gradient()[0] - slope).abs() < digits, "{h}: {:?} {slope}", at.gradient());
        }
    }

    #[test]
    fn the_mean_of_the_decay_is_smooth() {
        for h in [1e-9, 1e-3, 0.0099, 0.0101, 0.5, 30.0] {
            let at = mean_decay(Jet::variable(h, 0));
            // Simpson's rule for the integrals of exp(-h u) and -u exp(-h u) over 0 ..= 1.
            let integral = |f: &dyn Fn(f64) -> f64| {
                let n = 2000;
                let inner = (1..n).map(|i| f64::from(2 + 2 * (i % 2)) * f(f64::from(i) / f64::from(n)));
                (f(0.0) + f(1.0) + inner.sum::<f64>()) / f64::from(3 * n)
            };
            assert!((at.value() - integral(&|u| (-h * u).exp())).abs() < 1e-9, "{h}");
            assert!((at.gradient()[0] + integral(&|u| u * (-h * u).exp())).abs() < 1e-9, "{h}");
        }
    }
}
