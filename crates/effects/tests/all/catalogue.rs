//! Tests of the whole catalogue: names, cards, the meaning of `off`, and every derivative compared with
//! differences.

use bulge_effects::{
    Action, Balance, Card, CardDocument, Catalogue, Effect, Form, Input, Jet, LoadEffect, Mechanism, Moment,
    ParameterCard, Row, Setting, Stage, describe, overview,
};
use bulge_fibre::Parts;
use bulge_muscles::{Muscle, PRESETS, Parameter, preset, units};
use bulge_numerics::{Random, Real};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Names that files, scripts and reports rely on. The catalogue may contain more.
const NAMES: &[&str] = &[
    "end-radius",
    "fibre-count",
    "braid-angle-error",
    "end-taper",
    "wall-thickness",
    "pleat-depth",
    "lobes",
    "fibre-misalignment",
    "uneven-fibres",
    "fibre-stretch",
    "bladder-elasticity",
    "limited-unfolding",
    "membrane-axial",
    "coulomb-friction",
    "pressure-friction",
    "force-friction",
    "presliding-hysteresis",
    "viscous-damping",
    "creep",
    "stress-softening",
    "pressure-threshold",
    "temperature",
    "low-load-slack",
    "force-offset",
    "force-gain",
    "force-nonlinearity",
    "force-drift",
    "force-lag",
    "pressure-offset",
    "pressure-gain",
    "length-zero-error",
    "displacement-gain",
    "frame-compliance",
    "end-slip",
    "regulator-lag",
    "specimen-spread",
];

/// Lanes of the derivatives by pressure and contraction. The lanes before them are for the parameters.
const PRESSURE: usize = 6;
const CONTRACTION: usize = 7;

fn effects() -> Vec<Arc<dyn Effect>> {
    Catalogue::builtin().iter().cloned().collect()
}

/// The shipped muscles that can have the effect.
fn muscles(effect: &dyn Effect) -> Vec<Muscle> {
    let all = PRESETS.iter().filter_map(|entry| preset(entry.name).ok());
    all.filter(|muscle| effect.card().kind.is_none_or(|kind| kind == muscle.kind())).collect()
}

/// The cards of the parameters for one muscle, with multiples converted to SI.
fn cards<'a>(effect: &'a dyn Effect, muscle: &Muscle) -> Vec<ParameterCard<'a>> {
    effect.parameters().into_iter().map(|card| card.of(muscle)).collect()
}

/// A value within the bounds of a parameter.
fn inside(random: &mut Random, card: &ParameterCard<'_>) -> f64 {
    let part = random.between(0.02, 0.98);
    if card.logarithmic {
        (card.low.ln() + part * (card.high / card.low).ln()).exp()
    } else {
        card.low + part * (card.high - card.low)
    }
}

/// A sweep with reversals and uneven time steps.
fn sweep(random: &mut Random, rows: usize) -> Vec<Moment> {
    let (mut out, mut sense): (Vec<Moment>, f64) = (Vec::with_capacity(rows), 1.0);
    let (mut contraction, mut pressure) = (random.between(0.05, 0.15), random.between(1e5, 4e5));
    let specimen = u32::from(random.uniform() < 0.5);
    for row in 0..rows {
        let mut moment = Moment::at_rest(pressure, contraction);
        moment.temperature = random.between(-5.0, 20.0);
        moment.clock = random.between(0.0, 3600.0);
        moment.cycle = random.between(0.0, 5.0).floor();
        moment.specimen = specimen;
        if let Some(last) = out.last() {
            moment.begins = false;
            moment.since = random.between(0.1, 2.0);
            moment.time = last.time + moment.since;
            moment.step = contraction - last.contraction;
            moment.rate = moment.step / moment.since;
            moment.pressure_step = pressure - last.pressure;
            moment.pressure_rate = moment.pressure_step / moment.since;
            moment.pressure_direction = moment.pressure_step.signum();
            moment.direction = sense;
            moment.largest = last.largest.max(contraction);
        }
        out.push(moment);
        if row % 3 == 2 {
            sense = -sense;
        }
        contraction += sense * random.between(0.001, 0.02);
        pressure += random.between(-1e4, 1e4);
    }
    out
}

/// An equilibrium from made-up laws that depend on pressure and contraction.
fn balance(moment: &Moment, pressure: Jet, contraction: Jet) -> Balance {
    let force = pressure * (-contraction * 2.5 + 1.0) * 2.5e-3;
    let mid_radius = contraction * 0.06 + 0.011;
    Balance {
        pressure,
        contraction,
        force,
        tension: force + pressure * mid_radius.squared() * std::f64::consts::PI,
        mid_radius,
        volume: mid_radius.squared() * (-contraction + 1.0) * 0.7,
        slope: -6.25e-3 * pressure.value(),
        turn: Jet::from(moment.step + 1e-8 * moment.pressure_step),
    }
}

/// All outputs of an effect along a sweep: input, load and reading. `dp` and `de` are added to the readings.
fn run(
    effect: &dyn Effect,
    setting: &Setting,
    theta: &[Jet],
    sweep: &[Moment],
    [dp, de]: [Jet; 2],
) -> Vec<Jet> {
    let mut memory = vec![Jet::from(0.0); effect.memory()];
    let mut out = Vec::new();
    for moment in sweep {
        let (pressure, contraction) = (dp + moment.pressure, de + moment.contraction);
        let mut input = Input::of(pressure, contraction);
        // Values other than 0 and 1 reveal sums and products.
        input.spread = Jet::from(1e-3);
        input.give_force.linear = Jet::from(1e-7);
        input.give_tension.linear = Jet::from(2e-7);
        input.wall = Jet::from(1.1);
        let balance = balance(moment, pressure, contraction);
        let (mut load, mut reading) = (Jet::from(37.0), balance.force);
        let row = Row { moment, setting, theta, memory: &mut memory };
        match effect.action() {
            Action::Shape(effect) => effect.act(row, &mut input),
            Action::Input(effect) => effect.act(row, &mut input),
            Action::Load(effect) => effect.act(row, &balance, &mut load),
            Action::Output(effect) => effect.act(row, &balance, &mut reading),
        }
        out.extend([input.pressure, input.contraction, input.area, input.wall, input.spread]);
        let gives = [input.give_force, input.give_tension].map(|give| give.under(balance.force));
        out.extend([gives[0], gives[1], load, reading]);
    }
    out
}

/// The derivative of `f` at 0, to fourth order in the step.
fn difference(f: impl Fn(f64) -> Vec<f64>, step: f64) -> Vec<f64> {
    let [near, far] = [step, 2.0 * step].map(|h| (f(h), f(-h)));
    let term = |i: usize| 8.0 * (near.0[i] - near.1[i]) - (far.0[i] - far.1[i]);
    (0..near.0.len()).map(|i| term(i) / (12.0 * step)).collect()
}

#[test]
fn the_promised_names_are_there_and_every_name_is_well_formed() {
    let all: Vec<_> = effects();
    let names: BTreeSet<&str> = all.iter().map(|effect| effect.card().name).collect();
    assert_eq!(names.len(), all.len(), "names are unique");
    let missing: Vec<_> = NAMES.iter().filter(|name| !names.contains(*name)).collect();
    assert!(missing.is_empty(), "missing: {missing:?}");
    for name in names {
        let is_word = |word: &str| {
            !word.is_empty() && word.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit())
        };
        assert!(name.split('-').all(is_word), "{name}");
    }
}

#[test]
fn families_and_twins_are_effects() {
    let all = effects();
    let find = |name: &str| all.iter().find(|effect| effect.card().name == name);
    for effect in &all {
        let card = effect.card();
        let family = find(card.family).unwrap_or_else(|| panic!("{}: family {}", card.name, card.family));
        assert_eq!(family.card().family, card.family, "{}: a family counts under itself", card.name);
        let twins: BTreeSet<&str> = card.twins.iter().map(|twin| twin.name).collect();
        assert_eq!(twins.len(), card.twins.len(), "{}: a twin twice", card.name);
        for twin in twins {
            assert!(find(twin).is_some() && twin != card.name, "{}: twin {twin}", card.name);
        }
    }
}

#[test]
fn families_have_a_mechanism_and_geometry_is_exact() {
    let all = effects();
    let of: BTreeMap<&str, Mechanism> =
        all.iter().map(|effect| effect.card()).map(|card| (card.name, card.mechanism)).collect();
    for effect in &all {
        let card = effect.card();
        assert_ne!(card.mechanism, Mechanism::User, "{}", card.name);
        assert_eq!(card.mechanism, of[card.family], "{}: another mechanism than {}", card.name, card.family);
        if matches!(card.mechanism, Mechanism::FibreGeometry | Mechanism::LengthChain) {
            assert_eq!(card.form, Form::Exact, "{}", card.name);
        }
    }
    let found: BTreeSet<Mechanism> = of.values().copied().collect();
    assert_eq!(found, Mechanism::ALL.into(), "every mechanism has an effect");
    let is_friction = |card: &Card<'_>| card.mechanism == Mechanism::DryFriction;
    assert!(all.iter().map(|effect| effect.card()).filter(is_friction).all(|card| card.form == Form::Loose));
}

#[test]
fn no_text_is_empty_or_ragged() {
    for effect in effects() {
        let card = effect.card();
        let mut texts = vec![card.title, card.about, card.equation, card.source, card.separate];
        texts.extend([card.signature.pressure, card.signature.shape]);
        texts.extend(card.twins.iter().flat_map(|twin| [twin.name, twin.how]));
        let parameters = effect.parameters();
        texts.extend(parameters.iter().flat_map(|p| [p.name, p.key, p.unit, p.about]));
        for text in texts {
            assert!(
                !text.is_empty() && text.trim() == text && !text.contains('\n'),
                "{}: {text:?}",
                card.name
            );
            assert!(text.is_ascii(), "{}: {text:?}", card.name);
        }
        for text in [card.about, card.title] {
            assert!(!text.contains("  "), "{}: {text:?}", card.name);
        }
        assert!(card.about.ends_with('.') && !card.title.ends_with('.'), "{}", card.name);
    }
}

#[test]
fn parameters_are_in_order() {
    for effect in effects() {
        let name = effect.card().name.to_owned();
        let parameters = effect.parameters();
        let keys: BTreeSet<&str> = parameters.iter().map(|card| card.key).collect();
        let names: BTreeSet<&str> = parameters.iter().map(|card| card.name).collect();
        assert_eq!(
            (keys.len(), names.len()),
            (parameters.len(), parameters.len()),
            "{name}: keys and names are unique"
        );
        for card in &parameters {
            let at = format!("{name}.{}", card.name);
            let within = |value: f64| value >= card.low && value <= card.high;
            assert!(card.low < card.high && card.low.is_finite() && card.high.is_finite(), "{at}: bounds");
            assert!(within(card.typical), "{at}: typical");
            // If the bounds exclude 0 from below, `off` = 0 means that the effect is absent.
            assert!(within(card.off) || (card.off == 0.0 && card.low > 0.0), "{at}: off");
            assert!(!card.logarithmic || card.low > 0.0, "{at}: logarithm");
            if let Some((mean, sd)) = card.prior {
                assert!(within(mean) && sd > 0.0 && sd.is_finite(), "{at}: prior");
            }
            if let Some((low, high)) = card.plausible {
                assert!(low < high && within(low) && within(high), "{at}: plausible");
            }
            let reciprocal = card.reciprocal.map(|(_, unit, factor)| (unit, factor));
            for (unit, factor) in [(card.unit, card.factor)].into_iter().chain(reciprocal) {
                let (read, _) = units::unit(unit).unwrap_or_else(|error| panic!("{at}: {error}"));
                assert!((factor / read - 1.0).abs() < 1e-12, "{at}: {unit} is {read}, not {factor}");
            }
        }
    }
}

#[test]
fn off_changes_nothing_bit_for_bit() {
    let mut random = Random::new(0x5EED, 0);
    for effect in effects() {
        let name = effect.card().name.to_owned();
        if effect.parameters().is_empty() {
            continue;
        }
        for muscle in muscles(effect.as_ref()) {
            let off: Vec<f64> = cards(effect.as_ref(), &muscle).iter().map(|card| card.off).collect();
            let parts = Parts::of(&muscle);
            assert_eq!(effect.reshaped(&off, &parts).unwrap(), parts, "{name}: {}", muscle.name());
            let lanes = off.iter().enumerate().map(|(i, value)| Jet::variable(*value, i)).collect::<Vec<_>>();
            for _ in 0..10 {
                let sweep = sweep(&mut random, 12);
                let moved = [0.0, 0.0].map(Jet::from);
                let nothing = run(&Nothing, &Setting::of(&muscle), &[], &sweep, moved);
                let found = run(effect.as_ref(), &Setting::of(&muscle), &lanes, &sweep, moved);
                for (i, (found, expected)) in found.iter().zip(&nothing).enumerate() {
                    let bits = [found.value().to_bits(), expected.value().to_bits()];
                    assert_eq!(bits[0], bits[1], "{name}, output {i}: {found:?} for {expected:?}");
                    assert!(found.gradient().iter().all(|g| g.is_finite()), "{name}, output {i}: {found:?}");
                }
            }
        }
    }
}

/// An effect that does nothing.
#[derive(Debug)]
struct Nothing;

impl Effect for Nothing {
    fn card(&self) -> bulge_effects::Card<'_> {
        unreachable!("nobody asks")
    }
    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        Vec::new()
    }
    fn action(&self) -> Action<'_> {
        Action::Load(self)
    }
}

impl LoadEffect for Nothing {
    fn act(&self, _: Row<'_>, _: &Balance, _: &mut Jet) {}
}

#[test]
fn derivatives_agree_with_differences() {
    let mut random = Random::new(0xD1FF, 0);
    for effect in effects() {
        let effect = effect.as_ref();
        assert!(effect.parameters().len() <= PRESSURE, "{}", effect.card().name);
        for muscle in muscles(effect) {
            let cards = cards(effect, &muscle);
            for trial in 0..8 {
                // Derivatives are also tested with the effect off, because a screen needs them at an
                // amplitude of 0.
                let value = |card: &ParameterCard<'_>| {
                    if trial % 4 > 0 { inside(&mut random, card) } else { card.off.max(card.low) }
                };
                let theta: Vec<f64> = cards.iter().map(value).collect();
                check_derivatives(effect, &muscle, &theta, &sweep(&mut random, 9));
            }
        }
    }
}

/// Checks the derivatives of all outputs by every parameter, the pressure and the contraction.
fn check_derivatives(effect: &dyn Effect, muscle: &Muscle, theta: &[f64], sweep: &[Moment]) {
    let setting = Setting::of(muscle);
    let lanes: Vec<Jet> = theta.iter().enumerate().map(|(i, v)| Jet::variable(*v, i)).collect();
    let moved = [PRESSURE, CONTRACTION].map(|lane| Jet::variable(0.0, lane));
    let exact = run(effect, &setting, &lanes, sweep, moved);
    let at = |lane: usize, h: f64| -> Vec<f64> {
        let at = |l: usize, value: f64| Jet::from(if l == lane { value + h } else { value });
        let theta: Vec<Jet> = theta.iter().enumerate().map(|(i, value)| at(i, *value)).collect();
        let moved = [PRESSURE, CONTRACTION].map(|l| at(l, 0.0));
        run(effect, &setting, &theta, sweep, moved).into_iter().map(Jet::value).collect()
    };
    let scales = cards(effect, muscle)
        .into_iter()
        .zip(theta)
        .map(|(card, value)| if card.logarithmic { value.abs() } else { 0.1 * (card.high - card.low) });
    for (lane, scale) in scales.enumerate().chain([(PRESSURE, 1e5), (CONTRACTION, 0.1)]) {
        let differences = difference(|h| at(lane, h), 1e-4 * scale);
        for (i, (exact, difference)) in exact.iter().zip(differences).enumerate() {
            let derivative = exact.gradient()[lane];
            // The rounding errors of the values, divided by the step, are far below the second term. Terms
            // that cancel have rounding errors of the size of the largest parameter.
            let size = derivative.abs() + 1e-4 * exact.value().abs() / scale;
            let largest = theta.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
            assert!(
                (derivative - difference).abs() <= 1e-6 * size + f64::EPSILON * largest / (1e-4 * scale),
                "{} on {}, output {i}, lane {lane}: {derivative} against {difference} at {theta:?}",
                effect.card().name,
                muscle.name()
            );
        }
    }
}

#[test]
fn parts_move_as_differences_say() {
    let mut random = Random::new(0x30FE, 0);
    for effect in effects() {
        let (effect, name) = (effect.as_ref(), effect.card().name.to_owned());
        let is_shape = effect.stage() == Stage::Shape;
        let mut reshaped = 0;
        for muscle in muscles(effect) {
            let cards = cards(effect, &muscle);
            let parts = Parts::of(&muscle);
            // A number of either sign also moves the muscle at `off`: diagnosis asks for the derivative there.
            let has_both_signs = cards.iter().all(|card| card.low < card.off && card.off < card.high);
            for draw in 0..6 {
                if draw == 5 && !has_both_signs {
                    break;
                }
                let value =
                    |card: &ParameterCard<'_>| if draw == 5 { card.off } else { inside(&mut random, card) };
                let theta: Vec<f64> = cards.iter().map(value).collect();
                let lanes: Vec<Jet> = theta.iter().enumerate().map(|(i, v)| Jet::variable(*v, i)).collect();
                let mut found = parts.still();
                // An effect may not fit a muscle that has no wall or no countable fibres.
                if effect.reshape(&lanes, &mut found).is_err() {
                    continue;
                }
                reshaped += usize::from(found.values() != parts);
                let numbers: Vec<Jet> = found.numbers().into_iter().map(|(_, number)| number).collect();
                for (i, value) in theta.iter().enumerate() {
                    let moves = numbers.iter().any(|number| number.gradient()[i] != 0.0);
                    assert_eq!(moves, is_shape, "{name} on {}, parameter {i}", muscle.name());
                    let get = |h: f64| {
                        let mut moved = theta.clone();
                        moved[i] += h;
                        let there = effect.reshaped(&moved, &parts).unwrap();
                        there.numbers().into_iter().map(|(_, number)| number).collect::<Vec<f64>>()
                    };
                    let step = 1e-4 * value.abs().max(0.01 * (cards[i].high - cards[i].low));
                    for (difference, exact) in difference(get, step).iter().zip(&numbers) {
                        let error = (difference - exact.gradient()[i]).abs();
                        assert!(error <= 1e-9 * difference.abs(), "{name}, {i}: {exact:?}, {difference}");
                    }
                }
            }
        }
        // No shipped muscle is a textbook cylinder.
        assert!(name == "end-taper" || is_shape == (reshaped > 0), "{name}: {reshaped}");
    }
}

#[test]
fn pages_hold_the_whole_card_in_100_columns() {
    for effect in effects() {
        let (card, page) = (effect.card(), describe(effect.as_ref()));
        assert!(page.starts_with(&format!("{}: ", card.name)) && page.ends_with('\n'));
        for line in page.lines() {
            assert!(line.chars().count() <= 100 && line.trim_end() == line, "{}: {line:?}", card.name);
        }
        let joined = page.split_whitespace().collect::<Vec<_>>().join(" ");
        let mut texts = vec![card.title, card.about, card.separate, card.source, card.evidence.says()];
        texts.extend(card.twins.iter().flat_map(|twin| [twin.name, twin.how]));
        texts.extend([card.signature.shape, card.needs.says(), card.mechanism.name(), card.form.says()]);
        let parameters = effect.parameters();
        texts.extend(parameters.iter().flat_map(|p| [p.name, p.unit, p.about]));
        for text in texts.into_iter().chain(card.equation.split_whitespace()) {
            let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
            assert!(joined.contains(&text), "{}: {text:?} is not on its page:\n{page}", card.name);
        }
    }
}

#[test]
fn the_overview_has_a_line_for_each_effect() {
    let list = overview(&Catalogue::builtin());
    for line in list.lines() {
        assert!(line.chars().count() <= 100 && line.trim_end() == line, "{line:?}");
    }
    for effect in effects() {
        let card = effect.card();
        let lines: Vec<_> =
            list.lines().filter(|line| line.split_whitespace().next() == Some(card.name)).collect();
        let [line] = lines[..] else { panic!("{}: {lines:?}", card.name) };
        assert!(line.contains(card.title), "{line}");
        let indent = line.len() - line.trim_start().len();
        assert_eq!(indent, if card.family == card.name { 2 } else { 4 }, "{line}");
    }
}

#[test]
fn documents_hold_numbers_in_shown_units() {
    let catalogue = Catalogue::builtin();
    let rubber = CardDocument::of(catalogue.find("bladder-elasticity").unwrap().as_ref());
    let [modulus] = &rubber.parameters[..] else { panic!("{rubber:?}") };
    assert_eq!((modulus.unit.as_str(), modulus.key.as_str()), ("MPa", "c10"));
    // The numbers must be exact: 0.3, not 0.30000000000000004.
    let shown = [modulus.low, modulus.typical, modulus.high, modulus.off].map(|value| value.to_string());
    assert_eq!(shown, ["0", "0.3", "3", "0"]);
    assert_eq!((modulus.prior, modulus.plausible), (Some([0.3, 0.3]), Some([0.01, 1.2])));
    let radius = CardDocument::of(catalogue.find("end-radius").unwrap().as_ref());
    assert_eq!(radius.parameters[0].multiple_of, Some(Parameter::FittingRadius.name()));
    assert_eq!((radius.parameters[0].low, radius.parameters[0].off), (0.5, 1.0));
    let angle = CardDocument::of(catalogue.find("braid-angle-error").unwrap().as_ref());
    assert_eq!((angle.parameters[0].low, angle.parameters[0].high), (-12.0, 12.0));
    let text = toml::to_string(&angle).unwrap();
    assert!(text.contains("stage = \"shape\"") && text.contains("kind = \"braided\""), "{text}");
    assert!(text.contains("mechanism = \"fibre-geometry\"") && text.contains("form = \"exact\""), "{text}");
}
