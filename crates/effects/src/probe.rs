//! Helpers for the tests of effects: single calls and paths on made-up equilibria.

use bulge_muscles::Kind;
use bulge_numerics::Real;

use crate::effect::{Action, Balance, Effect, Input, Jet, Moment, Row, Setting};

/// A braid of 250 mm.
pub(crate) const SETTING: Setting = Setting {
    kind: Kind::Braided,
    length: 0.25,
    radius: 0.01,
    braid_angle: 0.436_332_312_998_582_4,
    fibres: None,
    has_bladder: false,
};

/// An equilibrium of round numbers: 2 bar, 10 %, 500 N, 800 N along the meridians, no turn of the strands.
pub(crate) fn balance(contraction: f64) -> Balance {
    let jet = Jet::from;
    Balance {
        pressure: jet(2e5),
        contraction: jet(contraction),
        force: jet(500.0),
        tension: jet(800.0),
        mid_radius: jet(0.015),
        volume: jet(1e-4),
        slope: -3000.0,
        turn: jet(0.0),
    }
}

/// The force that an effect adds at 2 bar and 10 %, at a moment modified by `change`.
pub(crate) fn load(effect: &dyn Effect, theta: &[f64], change: impl FnOnce(&mut Moment)) -> f64 {
    let mut moment = Moment::at_rest(2e5, 0.1);
    change(&mut moment);
    let theta: Vec<Jet> = theta.iter().map(|v| Jet::from(*v)).collect();
    let mut memory = vec![Jet::from(0.0); effect.memory()];
    let mut force = Jet::from(0.0);
    let row = Row { moment: &moment, setting: &SETTING, theta: &theta, memory: &mut memory };
    let Action::Load(effect) = effect.action() else { panic!("no load") };
    effect.act(row, &balance(0.1), &mut force);
    force.value()
}

/// The forces that an effect adds along a path of contractions at 2 bar, with one second between rows.
pub(crate) fn path(effect: &dyn Effect, theta: &[f64], contractions: &[f64]) -> Vec<f64> {
    let rows: Vec<[f64; 2]> = contractions.iter().map(|contraction| [2e5, *contraction]).collect();
    driven(effect, theta, &rows)
}

/// The forces that an effect adds along a path of pressures \[Pa\] and contractions, with one second between
/// rows. The pressure alone turns no strand.
pub(crate) fn driven(effect: &dyn Effect, theta: &[f64], rows: &[[f64; 2]]) -> Vec<f64> {
    let sign = |step: f64| if step == 0.0 { 0.0 } else { step.signum() };
    let theta: Vec<Jet> = theta.iter().map(|v| Jet::from(*v)).collect();
    let mut memory = vec![Jet::from(0.0); effect.memory()];
    let mut last = rows[0];
    let mut forces = Vec::new();
    for (i, &[pressure, contraction]) in rows.iter().enumerate() {
        let (pressure_step, step) = (pressure - last[0], contraction - last[1]);
        let moment = Moment {
            begins: i == 0,
            step,
            rate: step,
            direction: sign(step),
            pressure_step,
            pressure_rate: pressure_step,
            pressure_direction: sign(pressure_step),
            since: if i == 0 { 0.0 } else { 1.0 },
            time: i as f64,
            clock: i as f64,
            largest: rows[..=i].iter().map(|row| row[1]).fold(f64::MIN, f64::max),
            ..Moment::at_rest(pressure, contraction)
        };
        let balance =
            Balance { pressure: Jet::from(pressure), turn: Jet::from(step), ..balance(contraction) };
        let mut force = Jet::from(0.0);
        let row = Row { moment: &moment, setting: &SETTING, theta: &theta, memory: &mut memory };
        let Action::Load(effect) = effect.action() else { panic!("no load") };
        effect.act(row, &balance, &mut force);
        forces.push(force.value());
        last = [pressure, contraction];
    }
    forces
}

/// The input after an effect at 2 bar and 10 %, at a moment modified by `change`.
pub(crate) fn input(effect: &dyn Effect, theta: &[f64], change: impl FnOnce(&mut Moment)) -> Input {
    let mut moment = Moment::at_rest(2e5, 0.1);
    change(&mut moment);
    let theta: Vec<Jet> = theta.iter().map(|v| Jet::from(*v)).collect();
    let mut memory = vec![Jet::from(0.0); effect.memory()];
    let mut input = Input::of(Jet::from(2e5), Jet::from(0.1));
    let row = Row { moment: &moment, setting: &SETTING, theta: &theta, memory: &mut memory };
    match effect.action() {
        Action::Shape(effect) => effect.act(row, &mut input),
        Action::Input(effect) => effect.act(row, &mut input),
        _ => panic!("no input"),
    }
    input
}

/// The reading of the load cell for 500 N at 2 bar and 10 %, at a moment modified by `change`.
pub(crate) fn reading(effect: &dyn Effect, theta: &[f64], change: impl FnOnce(&mut Moment)) -> f64 {
    let mut moment = Moment::at_rest(2e5, 0.1);
    change(&mut moment);
    let theta: Vec<Jet> = theta.iter().map(|v| Jet::from(*v)).collect();
    let mut memory = vec![Jet::from(0.0); effect.memory()];
    let mut force = Jet::from(500.0);
    let row = Row { moment: &moment, setting: &SETTING, theta: &theta, memory: &mut memory };
    let Action::Output(effect) = effect.action() else { panic!("no output") };
    effect.act(row, &balance(0.1), &mut force);
    force.value()
}
