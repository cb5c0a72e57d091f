//! Tests of all load and rig effects along random paths: derivatives, no change when off, and a fresh start
//! of every sweep.

#![expect(clippy::float_cmp, reason = "off means the same number, to the bit")]

use bulge_muscles::{Kind, units};
use bulge_numerics::{Random, Real};

use crate::effect::{self, Action, Balance, Effect, Input, Jet, Moment, Setting};
use crate::probe::SETTING;
use crate::{load, rig};

const PRESSURE_LANE: usize = 6;
const CONTRACTION_LANE: usize = 7;
const ROWS: usize = 50;

/// The outputs of an effect in a row: the seven numbers of the input, the load, the reading.
type Row = [Jet; 9];

/// Two sweeps up and down, with rests, between 0.5 and 30 %.
fn walk(random: &mut Random) -> Vec<Moment> {
    let (mut moments, mut contraction, mut s) = (Vec::new(), 0.1, 1.0);
    let (mut time, mut cycle, mut largest) = (0.0, 0.0, 0.0_f64);
    for i in 0..ROWS {
        let begins = i % (ROWS / 2) == 0;
        let pressure = random.between(5e4, 6e5);
        let since = if begins { 0.0 } else { random.between(0.05, 20.0) };
        let size = if random.uniform() < 0.1 { 0.0 } else { random.between(0.0, 0.03) };
        if random.uniform() < 0.2 || !(0.005..=0.3).contains(&(contraction + s * size)) {
            s = -s;
            cycle += 0.5;
        }
        let step = if begins { 0.0 } else { s * size };
        contraction += step;
        time = if begins { 0.0 } else { time + since };
        largest = if begins { contraction } else { largest.max(contraction) };
        moments.push(Moment {
            direction: if step == 0.0 { 0.0 } else { s },
            rate: if begins { random.between(-0.01, 0.01) } else { step / since },
            pressure_rate: random.between(-2e3, 2e3),
            pressure_step: if begins { 0.0 } else { random.between(-1e5, 1e5) },
            pressure_direction: f64::signum(random.between(-1.0, 1.0)),
            time,
            clock: time + 500.0 * cycle,
            since,
            step,
            temperature: random.between(-5.0, 30.0),
            cycle: f64::floor(cycle),
            largest,
            begins,
            ..Moment::at_rest(pressure, contraction)
        });
    }
    moments
}

/// Every row with the effect, or without any. The equilibria are made up, and their force is negative at
/// large contractions.
fn run(
    effect: Option<&dyn Effect>,
    setting: &Setting,
    moments: &[Moment],
    theta: &[Jet],
    offsets: [Jet; 2],
) -> Vec<Row> {
    let mut memory = vec![Jet::from(0.0); effect.map_or(0, Effect::memory)];
    let row = |moment: &Moment| {
        if moment.begins {
            memory.fill(Jet::from(0.0));
        }
        let action = effect.map(Effect::action);
        let (pressure, contraction) = (offsets[0] + moment.pressure, offsets[1] + moment.contraction);
        let mut input = Input::of(pressure, contraction);
        if let Some(Action::Input(effect)) = action {
            effect.act(effect::Row { moment, setting, theta, memory: &mut memory }, &mut input);
        }
        let force = pressure * (-contraction + 0.25) * 5e-3;
        let mid_radius = (contraction + 1.0) * 0.014;
        let balance = Balance {
            pressure,
            contraction,
            force,
            tension: force + pressure * mid_radius.squared() * 3.0,
            mid_radius,
            volume: mid_radius.squared() * (-contraction + 1.0) * 0.7,
            slope: -2e3,
            turn: Jet::from(moment.step) + pressure * (moment.pressure_step * 1e-13),
        };
        let (mut added, mut reading) = (Jet::from(0.0), force);
        // Without a load the give is 0 and shows no derivative, so a load is applied.
        let load = Jet::from(700.0);
        let row = effect::Row { moment, setting, theta, memory: &mut memory };
        match action {
            Some(Action::Load(effect)) => effect.act(row, &balance, &mut added),
            Some(Action::Output(effect)) => effect.act(row, &balance, &mut reading),
            _ => {}
        }
        [
            input.pressure,
            input.contraction,
            input.area,
            input.wall,
            input.spread,
            input.give_force.under(load),
            input.give_tension.under(load),
            added,
            reading,
        ]
    };
    moments.iter().map(row).collect()
}

/// Calls `check` for every effect on every kind of muscle that can have it.
fn each(mut check: impl FnMut(&dyn Effect, &Setting)) {
    let pleated = Setting { kind: Kind::Pleated, length: 0.11, radius: 0.016, braid_angle: 0.0, ..SETTING };
    let bladder = Setting { has_bladder: true, ..SETTING };
    for effect in load::all().into_iter().chain(rig::all()) {
        for setting in [&SETTING, &bladder, &pleated] {
            if effect.card().kind.is_none_or(|kind| kind == setting.kind) {
                check(effect.as_ref(), setting);
            }
        }
    }
}

/// Central differences of all rows by one of the parameters, the pressure or the contraction.
fn differences(
    effect: &dyn Effect,
    setting: &Setting,
    moments: &[Moment],
    theta: &[f64],
    (lane, h): (usize, f64),
) -> Vec<[f64; 9]> {
    let moved = |h: f64| {
        let mut theta: Vec<Jet> = theta.iter().map(|value| Jet::from(*value)).collect();
        let mut offsets = [0.0, 0.0].map(Jet::from);
        match lane {
            PRESSURE_LANE => offsets[0] += Jet::from(h),
            CONTRACTION_LANE => offsets[1] += Jet::from(h),
            _ => theta[lane] += Jet::from(h),
        }
        run(Some(effect), setting, moments, &theta, offsets)
    };
    let row = |(up, down): (Row, Row)| std::array::from_fn(|k| (up[k].value() - down[k].value()) / (2.0 * h));
    moved(h).into_iter().zip(moved(-h)).map(row).collect()
}

fn check_derivatives(effect: &dyn Effect, setting: &Setting, moments: &[Moment], theta: &[f64]) {
    let cards = effect.parameters();
    assert!(cards.len() <= PRESSURE_LANE);
    let seeded: Vec<Jet> = theta.iter().enumerate().map(|(i, value)| Jet::variable(*value, i)).collect();
    let offsets = [PRESSURE_LANE, CONTRACTION_LANE].map(|lane| Jet::variable(0.0, lane));
    let rows = run(Some(effect), setting, moments, &seeded, offsets);
    let own =
        cards.iter().zip(theta).map(|(card, value)| 1e-5 * value.abs().max(1e-2 * (card.high - card.low)));
    // A parameter whose logarithm is fitted is never near 0.
    let own =
        own.zip(&cards).zip(theta).map(|((h, card), value)| if card.logarithmic { 1e-5 * value } else { h });
    let lanes = own.enumerate().chain([(PRESSURE_LANE, 1.0), (CONTRACTION_LANE, 1e-6)]);
    for (lane, h) in lanes {
        let found = differences(effect, setting, moments, theta, (lane, h));
        for k in 0..9 {
            let scale = rows.iter().map(|row| row[k].gradient()[lane].abs()).fold(0.0, f64::max);
            for (i, (row, difference)) in rows.iter().zip(&found).enumerate() {
                let rounding = 1e-15 * row[k].value().abs() / h;
                let error = (row[k].gradient()[lane] - difference[k]).abs();
                assert!(
                    error <= 1e-6 * scale + rounding,
                    "{} {:?}, row {i}, output {k}, lane {lane}: {} against {} at {theta:?}",
                    effect.card().name,
                    setting.kind,
                    row[k].gradient()[lane],
                    difference[k]
                );
            }
        }
    }
}

#[test]
fn derivatives_are_those_of_differences() {
    let mut random = Random::new(20_240_611, 0);
    each(|effect, setting| {
        let off: Vec<f64> = effect.parameters().iter().map(|card| card.off).collect();
        check_derivatives(effect, setting, &walk(&mut random), &off);
        for draw in 0..6 {
            let number = |card: &crate::ParameterCard<'_>, random: &mut Random| {
                let (low, high) =
                    if draw < 4 { card.plausible } else { None }.unwrap_or((card.low, card.high));
                if card.logarithmic {
                    random.between(low.ln(), high.ln()).exp()
                } else {
                    random.between(low, high)
                }
            };
            let theta: Vec<f64> = effect.parameters().iter().map(|card| number(card, &mut random)).collect();
            check_derivatives(effect, setting, &walk(&mut random), &theta);
        }
    });
}

#[test]
fn off_means_nothing_to_the_bit() {
    let mut random = Random::new(42, 0);
    each(|effect, setting| {
        let moments = walk(&mut random);
        let off: Vec<Jet> = effect.parameters().iter().map(|card| Jet::from(card.off)).collect();
        let offsets = [PRESSURE_LANE, CONTRACTION_LANE].map(|lane| Jet::variable(0.0, lane));
        let rows = run(Some(effect), setting, &moments, &off, offsets);
        let untouched = run(None, setting, &moments, &[], offsets);
        for (row, plain) in rows.iter().zip(&untouched) {
            for (found, expected) in row.iter().zip(plain) {
                assert_eq!(found.value().to_bits(), expected.value().to_bits(), "{}", effect.card().name);
                assert_eq!(found.gradient(), expected.gradient(), "{}", effect.card().name);
            }
        }
    });
}

#[test]
fn a_sweep_knows_nothing_of_the_one_before() {
    let mut random = Random::new(7, 0);
    each(|effect, setting| {
        let moments = walk(&mut random);
        let theta: Vec<Jet> = effect.parameters().iter().map(|card| Jet::from(card.typical)).collect();
        let offsets = [0.0, 0.0].map(Jet::from);
        let both = run(Some(effect), setting, &moments, &theta, offsets);
        let second = run(Some(effect), setting, &moments[ROWS / 2..], &theta, offsets);
        assert_eq!(both[ROWS / 2..], second, "{}", effect.card().name);
    });
}

#[test]
fn every_effect_acts_at_its_typical_numbers_or_one_deviation_off() {
    let mut random = Random::new(3, 0);
    each(|effect, setting| {
        let moments = walk(&mut random);
        let usual = |card: crate::ParameterCard<'_>| {
            let other = || card.prior.map_or(card.high, |(mean, sd)| mean + sd);
            Jet::from(if card.typical == card.off && !card.logarithmic { other() } else { card.typical })
        };
        let theta: Vec<Jet> = effect.parameters().into_iter().map(usual).collect();
        let offsets = [0.0, 0.0].map(Jet::from);
        let rows = run(Some(effect), setting, &moments, &theta, offsets);
        let untouched = run(None, setting, &moments, &[], offsets);
        assert_ne!(rows, untouched, "{}", effect.card().name);
        let is_finite = |number: &Jet| number.value().is_finite();
        assert!(rows.iter().flatten().all(is_finite), "{}", effect.card().name);
        assert!(rows.iter().all(|row| row[0].value() > 0.0), "{}", effect.card().name);
    });
}

#[test]
fn units_are_those_of_files() {
    for effect in load::all().into_iter().chain(rig::all()) {
        for card in effect.parameters() {
            let (factor, _) = units::unit(card.unit).unwrap();
            assert!((factor / card.factor - 1.0).abs() < 1e-12, "{} {}", effect.card().name, card.unit);
        }
    }
}
