//! Force filter: the force reading is a first-order filter of the force.

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Balance, Effect, Jet, OutputEffect, Row};
use crate::load::relaxed::relaxed;
use crate::mechanism::{Form, Mechanism};
use crate::unit::SECOND;

/// `tau y' = F - y`, with y = F at the beginning of a sweep.
///
/// For d = F - y this is d' = F' - d/tau, which is exact between two rows if the force is linear in time
/// ([`relaxed`]). The whole force is delayed, including friction. A dead time computed from speeds
/// (force-lag) doesn't delay friction.
#[derive(Debug)]
pub(crate) struct ForceFilter;

impl Effect for ForceFilter {
    fn card(&self) -> Card<'_> {
        Card {
            name: "force-filter",
            family: "force-lag",
            mechanism: Mechanism::LateReading,
            form: Form::Loose,
            title: "Force reading that is filtered",
            about: "The amplifier of the load cell smooths its signal. On the way the reading is late by tau, as with a dead time; after each turn \
                    it takes a few tau until it is, and a jump of the friction becomes a bend.",
            equation: "tau dy/dt = F - y,   y the reading, y = F when a sweep begins",
            source: "filter of first order; exact for a force that runs straight between two rows",
            evidence: Evidence::Derived,
            group: Group::Rig,
            kind: None,
            signature: Signature {
                pressure: "1",
                parity: Parity::Odd,
                shape: "-dF/d eps times the speed, rounded off after each turn",
            },
            twins: &[
                Twin { name: "force-lag", how: "0.99 where the time is a hundredth of a loop's" },
                Twin { name: "viscous-damping", how: "-0.95" },
                Twin { name: "pressure-viscosity", how: "with the other sign" },
                Twin { name: "presliding-hysteresis", how: "beside friction, at one speed" },
            ],
            separate: "a step of the load; a turn with many readings within tau; a second speed",
            needs: Needs::Time,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let about = "time constant of the filter";
        vec![ParameterCard::new("time", SECOND, (0.0, 5.0), 0.0, about).prior(0.0, 0.2).plausible(0.0, 2.0)]
    }

    fn memory(&self) -> usize {
        2
    }

    fn action(&self) -> Action<'_> {
        Action::Output(self)
    }
}

impl OutputEffect for ForceFilter {
    fn act(&self, Row { moment, theta, memory, .. }: Row<'_>, _: &Balance, reading: &mut Jet) {
        let force = *reading;
        let behind = if moment.begins {
            Jet::from(0.0)
        } else {
            relaxed(memory[0], force - memory[1], moment.since, theta[0])
        };
        (memory[0], memory[1]) = (behind, force);
        *reading = force - behind;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::Moment;
    use crate::probe::{SETTING, balance};
    use bulge_numerics::Real;

    /// Readings of forces, each given with the time since the previous one.
    fn readings(tau: Jet, rows: &[[f64; 2]]) -> Vec<Jet> {
        let mut memory = [Jet::from(0.0); 2];
        let row = |(i, &[since, force]): (usize, &[f64; 2])| {
            let moment = Moment { since, begins: i == 0, ..Moment::at_rest(2e5, 0.1) };
            let mut reading = Jet::from(force);
            ForceFilter.act(
                Row { moment: &moment, setting: &SETTING, theta: &[tau], memory: &mut memory },
                &balance(0.1),
                &mut reading,
            );
            reading
        };
        rows.iter().enumerate().map(row).collect()
    }

    #[test]
    fn a_ramp_arrives_late_by_its_time() {
        // A step to 500 N followed by 20 N/s: y = 500 + 20 (t - tau (1 - exp(-t/tau))), in uneven steps.
        let times = [0.0, 0.02, 0.3, 0.35, 1.1, 9.0];
        let mut last = 0.0;
        let rows = times.map(|t| [t - std::mem::replace(&mut last, t), 500.0 + 20.0 * t]);
        for (found, t) in readings(Jet::from(0.4), &rows).iter().zip(times) {
            let expected = 500.0 + 20.0 * (t - 0.4 * (1.0 - (-t / 0.4).exp()));
            assert!((found.value() - expected).abs() < 1e-12, "{t}: {found:?} {expected}");
        }
    }

    #[test]
    fn a_hum_is_smaller_and_late() {
        // sin(w t) becomes sin(w t - atan(w tau))/sqrt(1 + w^2 tau^2), to second order in the steps.
        let (w, tau): (f64, f64) = (3.0, 0.5);
        let error = |n: u32| {
            let step = 20.0 / f64::from(n);
            let rows: Vec<[f64; 2]> = (0..=n).map(|i| [step, (w * step * f64::from(i)).sin()]).collect();
            let found = readings(Jet::from(tau), &rows)[n as usize].value();
            found - (w * 20.0 - (w * tau).atan()).sin() / (1.0 + (w * tau).powi(2)).sqrt()
        };
        let errors = [400, 800].map(error);
        assert!(errors[1].abs() < 1e-3, "{errors:?}");
        assert!((errors[0] / errors[1] - 4.0).abs() < 0.1, "{errors:?}");
    }

    #[test]
    fn a_short_time_is_a_dead_time() {
        let found = readings(Jet::variable(0.0, 0), &[[0.0, 500.0], [0.1, 502.0], [0.1, 501.0]]);
        for (found, [force, slope]) in found.iter().zip([[500.0, 0.0], [502.0, 20.0], [501.0, -10.0]]) {
            assert_eq!(found.value().to_bits(), f64::to_bits(force));
            assert!((found.gradient()[0] + slope).abs() < 1e-12, "{found:?}");
        }
    }
}
