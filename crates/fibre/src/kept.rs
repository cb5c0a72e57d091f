//! Equilibria of very different muscles: their values to eight digits, and what they cost, as kept in `kept.tsv`.
//! The values are those of the independent checks of `bulge validate`; a change that moves one of them, or
//! takes more evaluations, is seen here.
//!
//! `BULGE_KEEP=1 cargo test -p bulge-fibre --lib kept` writes the file anew.

mod muscles;

use self::muscles::MUSCLES;
use crate::search::{Goal, Seen};
use crate::{
    Approach, Convergence, FibreError, Formula, FormulaInput, Given, Jet, Linear, Linearised, MeridianPoint,
    Parts, Problem, Repeated, Response, Start, isobars, work,
};
use bulge_muscles::{Parameter, Pressure, from_toml};
use bulge_numerics::last_digits;
use bulge_numerics::tape::{Builder, Function, Operator, Place};
use std::fmt::Write;
use std::sync::Arc;

/// What a formula changes.
type Change = fn(&mut Parts<Jet>);

/// Formulas that a braid has besides: names, and what they change.
const FORMULAS: [(&str, Change); 4] = [
    ("own rubber", |parts| parts.energy = Some(energy(1500.0, neo_hookean))),
    ("own exponential", |parts| parts.energy = Some(energy(1500.0, exponential))),
    ("sling", |parts| parts.energy = Some(energy(2000.0, sling))),
    ("own area", |parts| parts.area = Some(area())),
];
const BARS: [f64; 2] = [0.8, 3.5];
const CONTRACTIONS: [f64; 6] = [-0.03, 0.003, 0.02, 0.08, 0.15, 0.22];
/// Of these, those whose volume leads back.
const VOLUMES: [f64; 2] = [0.02, 0.15];
/// Accuracy of the sums of kept values: what other processors' elementary functions, and the steps that depend
/// on them, differ by is smaller.
const CLOSE: f64 = 1e-8;
/// The same for derivatives that are as good as a fit needs.
const CLOSE_FOR_A_FIT: f64 = 1e-5;
/// Values below this one are differences of larger ones, in SI units.
const LEAST: f64 = 1e-7;
/// Parts of the kept work that are no change, and with elementary functions of other last digits.
const OTHER: f64 = 5e-3;
const OTHER_DIGITS: f64 = 0.4;

/// What was asked, values, and the evaluations of all that was tried on the way ([`work`]).
struct Line {
    asked: String,
    values: [f64; 2],
    work: u64,
}

fn values_of(asked: &str, found: &Response) -> Vec<f64> {
    let Convergence { residual, first_integral, .. } = found.convergence;
    assert!(residual < 1e-8 && first_integral < 1e-8, "{asked}: {residual:e} {first_integral:e}");
    vec![
        // A force of nothing is the rounding of the forces that it is the difference of.
        found.force_n + 1.0,
        found.length_m,
        found.volume_m3,
        found.volume_polygon_m3,
        found.max_radius_m,
        found.mid_radius_m,
        found.fibre_tension_n,
        found.fibre_strain,
        found.stiffness_n_per_m,
        found.volume_slope_m2,
        found.stiffness_isothermal_n_per_m,
        found.stiffness_adiabatic_n_per_m,
        found.end_slope_rad,
    ]
}

/// Two sums of all values, in which each counts by its relative change: asinh(v/e) is ln(2 v/e) far above e.
fn summed(values: &[f64]) -> [f64; 2] {
    let place = |i: usize| 1.0 + i as f64;
    let term = |(i, value): (usize, &f64)| {
        let ln = (value / LEAST).asinh();
        [ln * place(i).sin(), ln * (1.3 * place(i)).cos()]
    };
    values.iter().enumerate().map(term).fold([0.0; 2], |sum, term| [sum[0] + term[0], sum[1] + term[1]])
}

fn inputs(tape: &mut Builder) -> [Place; 3] {
    use FormulaInput::{AlongMeridian, AroundAxis, Radius};
    [AlongMeridian, AroundAxis, Radius].map(|input| tape.input(input as usize))
}

/// l1^2 + l2^1.5 + 1/(l1 l2)^2
fn neo_hookean(tape: &mut Builder) -> Place {
    let [along, around, _] = inputs(tape);
    let product = tape.operate(Operator::Multiply, along, around);
    let terms = [tape.whole_power(along, 2), tape.real_power(around, 1.5), tape.whole_power(product, -2)];
    let sum = tape.operate(Operator::Add, terms[0], terms[1]);
    tape.operate(Operator::Add, sum, terms[2])
}

/// exp(l1) + (l2 - 1)^2
fn exponential(tape: &mut Builder) -> Place {
    let [along, around, _] = inputs(tape);
    let one = tape.constant(1.0);
    let beyond = tape.operate(Operator::Subtract, around, one);
    let terms = [tape.call(Function::Exp, &[along]), tape.whole_power(beyond, 2)];
    tape.operate(Operator::Add, terms[0], terms[1])
}

/// max(0, l2 - 1.05)^2 + max(0, 1 - l1)^2
fn sling(tape: &mut Builder) -> Place {
    let [along, around, _] = inputs(tape);
    let [zero, one, taut] = [0.0, 1.0, 1.05].map(|value| tape.constant(value));
    let gaps = [tape.operate(Operator::Subtract, around, taut), tape.operate(Operator::Subtract, one, along)];
    let [first, second] = gaps.map(|gap| {
        let most = tape.call(Function::Max, &[zero, gap]);
        tape.whole_power(most, 2)
    });
    tape.operate(Operator::Add, first, second)
}

/// max(0, l2 - 1.05), whose slope jumps.
fn jump(tape: &mut Builder) -> Place {
    let [_, around, _] = inputs(tape);
    let [zero, taut] = [0.0, 1.05].map(|value| tape.constant(value));
    let gap = tape.operate(Operator::Subtract, around, taut);
    tape.call(Function::Max, &[zero, gap])
}

/// An energy of the wall, k f(l1, l2) in N/m, with the derivatives that a net needs.
fn energy(k: f64, write: fn(&mut Builder) -> Place) -> Formula<Jet> {
    let mut tape = Builder::default();
    let factor = tape.input(FormulaInput::Length as usize + 1);
    let form = write(&mut tape);
    let place = tape.operate(Operator::Multiply, factor, form);
    let [along, around] = [FormulaInput::AlongMeridian, FormulaInput::AroundAxis].map(|input| input as usize);
    let [by_1, by_2] = [along, around].map(|input| tape.derivative(place, input));
    let [by_11, by_12] = [along, around].map(|input| tape.derivative(by_1, input));
    let by_22 = tape.derivative(by_2, around);
    let gaps = tape.gaps(place);
    Formula {
        tape: Arc::new(tape.finish(&[place, by_1, by_2, by_11, by_12, by_22]).unwrap()),
        even: None,
        gaps: (!gaps.is_empty()).then(|| Arc::new(tape.finish(&gaps).unwrap())),
        parameters: vec![Jet::variable(k, 2)],
    }
}

/// pi (r - t)^2 with t = 1 mm
fn area() -> Formula<Jet> {
    let mut tape = Builder::default();
    let [.., radius] = inputs(&mut tape);
    let thickness = tape.input(FormulaInput::Length as usize + 1);
    let pi = tape.constant(std::f64::consts::PI);
    let inside = tape.operate(Operator::Subtract, radius, thickness);
    let square = tape.whole_power(inside, 2);
    let place = tape.operate(Operator::Multiply, pi, square);
    let by_r = tape.derivative(place, FormulaInput::Radius as usize);
    let by_rr = tape.derivative(by_r, FormulaInput::Radius as usize);
    let tape = Arc::new(tape.finish(&[place, by_r, by_rr]).unwrap());
    Formula { tape, even: None, gaps: None, parameters: vec![Jet::variable(1e-3, 2)] }
}

/// What is asked about a muscle at a pressure, with a formula or without.
struct Questions {
    name: String,
    bar: f64,
    problem: Problem,
    moving: Parts<Jet>,
    lines: Vec<Line>,
}

const AUTO: Approach = Approach::Auto;

/// All that is asked.
fn lines(name: &str, keys: &str, change: Change, bar: f64) -> Vec<Line> {
    let muscle = from_toml(&format!("name = \"m\"\n{keys}"), "m.toml").unwrap();
    let mut moving = Parts::seeded(&muscle, &[Parameter::Length, Parameter::Radius]);
    change(&mut moving);
    let problem = Problem::new(moving.values(), Pressure::bar(bar)).unwrap();
    let mut questions = Questions { name: name.to_owned(), bar, problem, moving, lines: Vec::new() };
    questions.equilibria();
    questions.ranges();
    if bar < BARS[1] {
        questions.paths();
    }
    questions.derivatives();
    questions.shape();
    questions.lines
}

impl Questions {
    fn add(&mut self, what: &str, answer: impl FnOnce(&Self) -> Result<Vec<f64>, FibreError>) {
        let (found, work) = work::of(|| answer(self));
        let mut asked = format!("{}, {} bar, {what}", self.name, self.bar);
        if let Err(error) = &found {
            // The kind of the error, without its numbers.
            let kind = format!("{error:?}");
            asked = format!("{asked}: {}", kind.split([' ', '(']).next().unwrap_or_default());
        }
        self.lines.push(Line { asked, values: summed(&found.unwrap_or_default()), work });
    }

    fn response(
        &mut self,
        what: &str,
        answer: impl FnOnce(&Problem) -> Result<Response, FibreError>,
    ) -> Option<Response> {
        let mut kept = None;
        self.add(what, |questions| {
            let found = answer(&questions.problem)?;
            kept = Some(found);
            Ok(values_of(what, &found))
        });
        if let (Some(line), Some(found)) = (self.lines.last_mut(), kept) {
            // What the answer says of its last search counts again.
            line.work += u64::from(found.convergence.evaluations + found.convergence.iterations);
        }
        kept
    }

    fn equilibria(&mut self) {
        for at in CONTRACTIONS {
            let found = self.response(&format!("contraction {at}"), |problem| problem.follow(at, AUTO));
            let Some(found) = found.filter(|found| found.force_n > 0.0) else { continue };
            let (force, volume) = (Given::Force(0.9 * found.force_n), Given::Volume(1.02 * found.volume_m3));
            self.response(&format!("force of {at}"), |problem| problem.solve(force, AUTO));
            // One that no equilibrium has takes long.
            if VOLUMES.contains(&at) {
                self.response(&format!("volume of {at}"), |problem| problem.solve(volume, AUTO));
            }
        }
        self.response("no force", |problem| problem.solve(Given::Force(0.0), AUTO));
        self.response("shooting", |problem| problem.follow(0.1, Approach::Shooting));
    }

    fn ranges(&mut self) {
        let of_isobar = |problem: &Problem, contractions: &[f64]| {
            let isobar = problem.isobar(contractions, AUTO)?;
            let of = |point: &Response| [point.contraction, point.force_n, point.volume_m3];
            Ok(isobar.points.iter().flat_map(of).chain(isobar.contraction_limit).collect())
        };
        self.add("end", |Self { problem, .. }| {
            Ok(vec![problem.contraction_limit(AUTO)?, problem.range_end(AUTO)?.contraction()])
        });
        self.add("longest", |Self { problem, .. }| Ok(problem.longest().into_iter().collect()));
        self.add("isobar", |Self { problem, .. }| of_isobar(problem, &[-0.02, 0.01, 0.05, 0.1, 0.2, 0.3]));
        self.add("isobar backwards", |Self { problem, .. }| of_isobar(problem, &[0.3, 0.2, 0.1, 0.05]));
        if let Some(longest) = self.problem.longest() {
            self.add("isobar drawn out", |Self { problem, .. }| {
                of_isobar(problem, &[0.99 * longest, 0.9 * longest, 0.5 * longest, 0.01])
            });
        }
        self.add("isobars", |Self { moving, bar, .. }| {
            let pressures = [*bar, 1.5 * bar].map(Pressure::bar);
            let found = isobars(moving.values(), &pressures, &[0.02, 0.1], AUTO)?;
            let of = |point: &Response| [point.force_n, point.stiffness_isothermal_n_per_m];
            Ok(found.iter().flat_map(|isobar| &isobar.points).flat_map(of).collect())
        });
    }

    /// The last resort of a search, which is hardly ever needed.
    fn paths(&mut self) {
        let volume = self.problem.follow(0.06, AUTO).map_or(1e-4, |found| found.volume_m3);
        let goals = [
            ("contraction", Goal::Contraction(0.1)),
            ("force", Goal::Force(10.0)),
            ("volume", Goal::Volume(volume)),
        ];
        for (what, goal) in goals {
            self.add(&format!("a path to the {what}"), |Self { problem, .. }| {
                let found = problem.on_a_path(problem.scheme(AUTO)?, goal, true, &Seen::NOTHING);
                Ok(found.map_or(Vec::new(), |found| values_of(what, &found.response)))
            });
        }
    }

    fn derivatives(&mut self) {
        self.add("gradient", |Self { problem, .. }| {
            let gradient = problem.gradient(0.08, AUTO)?;
            let by_part = gradient.by_part.iter().flat_map(|(_, by)| *by);
            Ok(gradient.by_contraction.into_iter().chain(gradient.by_pressure).chain(by_part).collect())
        });
        let linear = |found: Linearised| {
            assert!(found.convergence.first_integral < 1e-8 && found.convergence.residual < 1e-8);
            let linear = [found.force_n, found.equator_force_n, found.mid_radius_m, found.volume_polygon_m3];
            let numbers = |l: &Linear| {
                let [length, radius, own, ..] = l.by_lane;
                [l.value, l.by_contraction, l.by_pressure, length, radius, own]
            };
            linear.iter().flat_map(numbers).collect::<Vec<_>>()
        };
        self.add("linearised", |Self { problem, moving, .. }| {
            problem.linearised(0.08, moving, AUTO).map(linear)
        });
        let there = self.problem.linearised(0.08, &self.moving, AUTO);
        let start: Option<Start> = there.ok().and_then(Linearised::into_start);
        self.add("linearised beside", |Self { problem, moving, .. }| {
            problem.linearised_from(start.as_ref(), 0.085, moving, AUTO).map(linear)
        });
        let Ok(repeated) = Repeated::new(self.moving.clone()) else { return };
        let mut near: Option<Start> = None;
        for i in 0..3 {
            let pressure = Pressure::bar(self.bar * (1.0 + 0.1 * f64::from(i)));
            let contraction = 0.05 + 0.02 * f64::from(i);
            let mut next = None;
            self.add(&format!("repeated {i}"), |_| {
                let found = repeated.linearised_from(near.as_ref(), pressure, contraction)?;
                next = found.start().cloned();
                Ok(linear(found))
            });
            near = next;
        }
    }

    fn shape(&mut self) {
        self.add("shape", |Self { problem, .. }| {
            let shape = problem.shape(Given::Contraction(0.08), AUTO, 9)?;
            let of = |p: &MeridianPoint| {
                let fibre =
                    [p.braid_angle_rad, p.fibre_tension_n, p.fibre_strain, p.fibre_length_m, p.turn_rad];
                [p.x_m, p.r_m, p.slope_rad, p.membrane_force_n_per_m].into_iter().chain(fibre)
            };
            let mut values: Vec<f64> = shape.meridian.iter().flat_map(of).collect();
            if let Some(numbers) = problem.pleated_numbers(&shape.response) {
                values.extend([numbers.m, numbers.phi_r, numbers.force_f, numbers.volume_v]);
            }
            Ok(values)
        });
    }
}

/// No equilibrium is found where the slope of a formula jumps, around the axis alone here; the error says so.
#[test]
fn a_slope_that_jumps_is_told() {
    let keys = MUSCLES.iter().find(|(name, _)| *name == "braid").unwrap().1;
    let muscle = from_toml(&format!("name = \"m\"\n{keys}"), "m.toml").unwrap();
    let mut parts = Parts::of(&muscle).still();
    parts.energy = Some(energy(2000.0, jump));
    let error = Problem::new(parts.values(), Pressure::bar(2.5)).unwrap().follow(0.08, AUTO).unwrap_err();
    let FibreError::FormulaJumps { around, .. } = error else { panic!("{error}") };
    assert!((around - 1.05).abs() < 1e-6, "{around}");
}

#[test]
fn kept_equilibria_and_their_cost() {
    let plain = MUSCLES.iter().flat_map(|(name, keys)| BARS.map(|bar| lines(name, keys, |_| (), bar)));
    let braids =
        MUSCLES.iter().filter(|(name, _)| ["cylinder", "braid", "braid elastic rubber"].contains(name));
    let own = braids.flat_map(|(of, keys)| {
        FORMULAS.iter().map(move |(name, change)| lines(&format!("{of} and {name}"), keys, *change, 2.5))
    });
    let found: Vec<Line> = plain.chain(own).flatten().collect();
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/src/kept.tsv");
    if std::env::var_os("BULGE_KEEP").is_some() {
        let mut text = format!("elementary functions\t{:016x}\n", last_digits());
        for line in &found {
            let values: Vec<String> = line.values.iter().map(|value| format!("{value:.9}")).collect();
            writeln!(text, "{}\t{}\t{}", line.asked, line.work, values.join(" ")).unwrap();
        }
        std::fs::write(path, text).unwrap();
    }
    let kept = std::fs::read_to_string(path).unwrap();
    let (first, kept) = kept.split_once('\n').unwrap();
    assert_eq!(kept.lines().count(), found.len());
    // Steps depend on last digits: with those of another processor a search may take more or fewer.
    let same_digits = first.ends_with(&format!("{:016x}", last_digits()));
    let other = if same_digits { OTHER } else { OTHER_DIGITS };
    let mut differ = Vec::new();
    for (line, kept) in found.iter().zip(kept.lines()) {
        let mut parts = kept.split('\t');
        let mut next = || parts.next().unwrap_or_default();
        let (asked, evaluations) = (next(), next().parse::<f64>().unwrap());
        let values: Vec<f64> = next().split_whitespace().map(|value| value.parse().unwrap()).collect();
        let off = line.values.iter().zip(&values).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        // What starts from a neighbour has derivatives for a fit.
        let is_for_a_fit = ["repeated", "beside"].iter().any(|way| asked.contains(way));
        let same = line.asked == asked && off < if is_for_a_fit { CLOSE_FOR_A_FIT } else { CLOSE };
        if !same || (line.work as f64 - evaluations).abs() > other * evaluations {
            differ.push(format!(
                "{asked}: {off:e}, {} of {evaluations} evaluations; found {}",
                line.work, line.asked
            ));
        }
    }
    assert!(differ.is_empty(), "{} differ:\n{}", differ.len(), differ[..differ.len().min(80)].join("\n"));
}
