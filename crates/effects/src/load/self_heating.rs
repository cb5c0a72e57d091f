//! Self-heating: the muscle is warmed by its own work (S3, section 4; catalogue T2).

use bulge_numerics::Real;

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Twin};
use crate::effect::{Action, Effect, Input, InputEffect, Jet, Row};
use crate::mechanism::{Form, Mechanism};
use crate::unit::{PERCENT, SECOND};

/// `modulus -> modulus (1 + a w)`, `F -> F (1 + b w)`, with w = 1 - exp(-t/tau) and t the time since the
/// first row. Without a bladder a also applies to the whole force.
///
/// a = alpha_b dT and b = alpha dT in terms of the effect `temperature`. The force determines only the
/// product of temperature rise and coefficient.
///
/// A wall of thickness d that gives its heat off to the air warms up within rho c d/h: 33 s for 0.3 mm of rubber
/// (rho = 1100 kg/m^3, c = 2000 J/(kg K), h = 20 W/(m^2 K)), 5.5 min for 1.5 mm with h = 10 W/(m^2 K). What settles
/// faster is a gain of the force on all rows but the first.
#[derive(Debug)]
pub(crate) struct SelfHeating;

impl Effect for SelfHeating {
    fn card(&self) -> Card<'_> {
        Card {
            name: "self-heating",
            family: "self-heating",
            mechanism: Mechanism::SofteningAndHeat,
            form: Form::Loose,
            title: "Warming up by work",
            about: "Gas that is pumped in and out and rubber that is kneaded warm the muscle up, most at its closed end, until it gives off as \
                    much heat as it gets. Its rubber gets stiffer meanwhile: 10 K are 3.4 %. Everything else that warmth does is a relative change \
                    of the force.",
            equation: "modulus x (1 + a w),   force x (1 + b w),   w = 1 - exp(-t/tau),   t since the first row;   without a bladder a is of the force",
            source: "S3, section 4 (the closed end gets hot); first-order heating; 0.34 % of the modulus per kelvin",
            evidence: Evidence::Literature,
            group: Group::Load,
            kind: None,
            signature: Signature {
                pressure: "0 and 1",
                parity: Parity::Even,
                shape: "as the bladder's force, and as the force, settling with the clock",
            },
            twins: &[
                Twin {
                    name: "temperature",
                    how: "0.999 where the measured temperature only rises, 0.2 where it goes up and down",
                },
                Twin { name: "force-drift", how: "in tests shorter than tau" },
                Twin { name: "stress-softening", how: "a change of the modulus with cycles instead of time" },
            ],
            separate: "a thermometer in the closed end, in the column `temperature`: what follows it is temperature, what settles with the clock \
                       while it doesn't is this; a pause after which the muscle is cold again",
            needs: Needs::Time,
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        let of_force = "relative change of the force when it is warm; of no account without a bladder";
        vec![
            ParameterCard::new(
                "amplitude",
                PERCENT,
                (-50.0, 50.0),
                3.4,
                "relative change of the modulus when it is warm",
            )
            .prior(0.0, 5.0)
            .plausible(-15.0, 15.0),
            ParameterCard::new("time", SECOND, (30.0, 1e5), 600.0, "time within which it warms up")
                .off_at(600.0)
                .plausible(60.0, 1e4)
                .logarithmic(),
            ParameterCard::new("force", PERCENT, (-50.0, 50.0), 1.0, of_force)
                .prior(0.0, 3.0)
                .plausible(-15.0, 15.0)
                .off_if_absent(),
        ]
    }

    fn action(&self) -> Action<'_> {
        Action::Input(self)
    }
}

impl InputEffect for SelfHeating {
    fn act(&self, Row { moment, setting, theta, .. }: Row<'_>, input: &mut Input) {
        let warmed = -(-(Jet::from(moment.clock) / theta[1])).exp() + 1.0;
        input.multiply_modulus(theta[0] * warmed + 1.0, setting);
        if setting.has_bladder {
            input.multiply_force(theta[2] * warmed + 1.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::{Moment, Setting};
    use crate::load::temperature::Temperature;
    use crate::probe::{SETTING, input};
    use bulge_numerics::vector::{dot, norm};

    #[test]
    fn it_settles_with_the_clock() {
        // 1 + 0.034 (1 - 1/e) after one time constant.
        for (clock, expected) in [(0.0, 1.0), (600.0, 1.021_492_099), (1e5, 1.034)] {
            let found = input(&SelfHeating, &[0.034, 600.0, 0.0], |moment| moment.clock = clock);
            assert!((found.wall.value() - expected).abs() < 1e-9, "{clock}");
            assert_eq!(found.wall, found.area);
        }
    }

    #[test]
    fn no_wall_is_warm_at_once() {
        // rho c d/h of the thinnest bladder in moving air, 0.3 mm of latex: faster warming would be a gain.
        let thinnest = 1100.0 * 2000.0 * 0.3e-3 / 20.0;
        let time = SelfHeating.parameters()[1];
        assert!((0.8..=1.0).contains(&(time.low / thinnest)), "{} s, {thinnest} s", time.low);
        assert!(time.plausible.is_some_and(|(low, high)| low >= time.low && high <= time.high));
    }

    #[test]
    fn a_column_that_goes_up_and_down_is_another_hypothesis() {
        // The derivative of the modulus factor by the size of each effect, over an hour.
        let setting = Setting { has_bladder: true, ..SETTING };
        let column = |effect: &dyn InputEffect, theta: &[f64], size: usize, kelvin: &dyn Fn(f64) -> f64| {
            let theta: Vec<Jet> = theta.iter().map(|value| Jet::variable(*value, 0)).collect();
            let lanes = |i: usize| if i == size { theta[i] } else { Jet::from(theta[i].value()) };
            let theta: Vec<Jet> = (0..theta.len()).map(lanes).collect();
            let row = |i: u32| {
                let clock = 6.0 * f64::from(i);
                let moment = Moment { clock, temperature: kelvin(clock), ..Moment::at_rest(2e5, 0.1) };
                let mut input = Input::of(Jet::from(2e5), Jet::from(0.1));
                effect.act(
                    Row { moment: &moment, setting: &setting, theta: &theta, memory: &mut [] },
                    &mut input,
                );
                input.wall.gradient()[0]
            };
            (0..=600).map(row).collect::<Vec<f64>>()
        };
        let likeness = |kelvin: &dyn Fn(f64) -> f64| {
            let measured = column(&Temperature, &[0.0, 0.0], 1, kelvin);
            let of_time = |time: f64| {
                let own = column(&SelfHeating, &[0.0, time, 0.0], 0, kelvin);
                dot(&measured, &own).abs() / (norm(&measured) * norm(&own))
            };
            [30.0, 100.0, 300.0, 600.0, 2e3, 1e4, 1e5].map(of_time).into_iter().fold(0.0, f64::max)
        };
        let room = likeness(&|clock| 5.0 * (std::f64::consts::TAU * 1.3 * clock / 3600.0).sin());
        assert!(room < 0.25, "{room}");
        // A thermometer in the closed end measures the heating itself, so one of the two effects is enough.
        let closed_end = likeness(&|clock| 10.0 * (1.0 - (-clock / 600.0).exp()));
        assert!((closed_end - 1.0).abs() < 1e-12, "{closed_end}");
    }

    #[test]
    fn of_a_bladder_it_is_the_modulus() {
        let setting = Setting { has_bladder: true, ..SETTING };
        let mut input = Input::of(Jet::from(2e5), Jet::from(0.1));
        let moment = Moment { clock: 600.0, ..Moment::at_rest(2e5, 0.1) };
        let theta = [0.034, 600.0, 0.0].map(Jet::from);
        SelfHeating
            .act(Row { moment: &moment, setting: &setting, theta: &theta, memory: &mut [] }, &mut input);
        assert!((input.wall.value() - 1.021_492_099).abs() < 1e-9);
        assert_eq!(input.area, Jet::from(1.0));
        // A factor on the force changes both wall and area.
        let mut input = Input::of(Jet::from(2e5), Jet::from(0.1));
        let theta = [0.0, 600.0, 0.034].map(Jet::from);
        SelfHeating
            .act(Row { moment: &moment, setting: &setting, theta: &theta, memory: &mut [] }, &mut input);
        assert!((input.wall.value() - 1.021_492_099).abs() < 1e-9 && input.area == input.wall);
    }
}
