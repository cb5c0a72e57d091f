//! Formulas as straight-line programs: built step by step, differentiated symbolically, run for numbers with or without derivatives.
//!
//! A [`Builder`] keeps every value once, computes with constants as it goes, and drops what changes nothing (`x + 0`, `1 x`). So the derivatives
//! of a formula share their parts with it, and one run gives them all.
//!
//! ```
//! use bulge_numerics::tape::{Builder, Operator};
//!
//! let mut tape = Builder::default();
//! let x = tape.input(0);
//! let cube = tape.whole_power(x, 3);
//! let slope = tape.derivative(cube, 0);
//! let tape = tape.finish(&[cube, slope]).ok_or("too long")?;
//! assert_eq!(tape.run(&[2.0]), [8.0, 12.0]);
//! # Ok::<(), &str>(())
//! ```

use arrayvec::ArrayVec;

mod derivative;
mod gaps;
mod powers;
mod values;

use crate::Real;

/// Two operands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Operator {
    /// a + b.
    Add,
    /// a - b.
    Subtract,
    /// a b.
    Multiply,
    /// a / b.
    Divide,
    /// a to the power of b, for a > 0; at a = 0 it is 0 for b > 0 and 1 for b = 0.
    Power,
}

/// A comparison: 1 where it holds, 0 where it doesn't.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Comparison {
    /// a < b.
    Less,
    /// a <= b.
    LessOrEqual,
    /// a > b.
    Greater,
    /// a >= b.
    GreaterOrEqual,
}

impl Comparison {
    /// Whether it holds.
    #[must_use]
    pub fn holds(self, left: f64, right: f64) -> bool {
        match self {
            Self::Less => left < right,
            Self::LessOrEqual => left <= right,
            Self::Greater => left > right,
            Self::GreaterOrEqual => left >= right,
        }
    }
}

/// A function; angles are in rad.
///
/// Where one has a kink, its derivative is that of the branch that counts: of equal arguments of `Min` and `Max` the first; within `Clamp` up to
/// and including its limits. `Sign` and `Step` have the derivative 0 everywhere.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "the names say it")]
pub enum Function {
    Sqrt,
    Exp,
    Ln,
    Log10,
    Sin,
    Cos,
    Tan,
    Asin,
    Atan,
    Tanh,
    Sinh,
    Cosh,
    Abs,
    Sign,
    Step,
    Min,
    Max,
    /// A number, its lower and its upper limit.
    Clamp,
    /// A condition (1 or 0) and the two values.
    If,
}

impl Function {
    /// Number of arguments.
    #[must_use]
    pub const fn arity(self) -> usize {
        match self {
            Self::Min | Self::Max => 2,
            Self::Clamp | Self::If => 3,
            _ => 1,
        }
    }
}

/// The place of a value among the steps of a [`Builder`].
pub type Place = usize;

/// One step; operands are places of earlier ones, in a [`Tape`] registers.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Step {
    Constant(f64),
    Input(usize),
    Negate(Place),
    Operate(Operator, [Place; 2]),
    WholePower(Place, i32),
    RealPower(Place, f64),
    Compare(Comparison, [Place; 2]),
    Call(Function, [Place; 3]),
}

impl Step {
    /// The same with other places for its operands.
    fn moved(self, place: impl Fn(Place) -> Place) -> Self {
        match self {
            Self::Constant(_) | Self::Input(_) => self,
            Self::Negate(a) => Self::Negate(place(a)),
            Self::Operate(operator, operands) => Self::Operate(operator, operands.map(place)),
            Self::WholePower(a, exponent) => Self::WholePower(place(a), exponent),
            Self::RealPower(a, exponent) => Self::RealPower(place(a), exponent),
            Self::Compare(comparison, operands) => Self::Compare(comparison, operands.map(place)),
            Self::Call(function, operands) => Self::Call(function, operands.map(place)),
        }
    }

    fn operands(self) -> ArrayVec<Place, 3> {
        match self {
            Self::Constant(_) | Self::Input(_) => ArrayVec::new(),
            Self::Negate(a) | Self::WholePower(a, _) | Self::RealPower(a, _) => [a].into_iter().collect(),
            Self::Operate(_, operands) | Self::Compare(_, operands) => operands.into_iter().collect(),
            Self::Call(function, operands) => operands.into_iter().take(function.arity()).collect(),
        }
    }
}

/// Steps, each value once.
#[derive(Debug, Clone, Default)]
pub struct Builder {
    steps: Vec<Step>,
}

impl Builder {
    /// How many values there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.steps.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.steps.is_empty()
    }

    /// The value at a place, if it doesn't depend on the inputs.
    #[must_use]
    pub fn constant_at(&self, place: Place) -> Option<f64> {
        if let Some(Step::Constant(value)) = self.steps.get(place) { Some(*value) } else { None }
    }

    fn push(&mut self, step: Step) -> Place {
        let operands = step.operands();
        let are_constant = !operands.is_empty() && operands.iter().all(|a| self.constant_at(*a).is_some());
        let step = if are_constant {
            let constants: ArrayVec<[f64; 1], 3> =
                operands.iter().map(|a| [self.constant_at(*a).unwrap_or(f64::NAN)]).collect();
            let alone = step.moved(|a| operands.iter().position(|other| *other == a).unwrap_or(0));
            let [value] = alone.values(&|_| [f64::NAN], &constants);
            Step::Constant(value)
        } else {
            step
        };
        let same = |other: &Step| match (*other, step) {
            (Step::Constant(a), Step::Constant(b)) => a.to_bits() == b.to_bits(),
            (other, step) => other == step,
        };
        self.steps.iter().position(same).unwrap_or_else(|| {
            self.steps.push(step);
            self.steps.len() - 1
        })
    }

    /// A constant.
    pub fn constant(&mut self, value: f64) -> Place {
        self.push(Step::Constant(value))
    }

    /// An input by its place.
    pub fn input(&mut self, index: usize) -> Place {
        self.push(Step::Input(index))
    }

    /// -a.
    pub fn negate(&mut self, a: Place) -> Place {
        match self.steps.get(a) {
            Some(Step::Negate(inner)) => *inner,
            _ => self.push(Step::Negate(a)),
        }
    }

    /// Two operands.
    pub fn operate(&mut self, operator: Operator, a: Place, b: Place) -> Place {
        let is = |place: Place, value: f64| self.constant_at(place) == Some(value);
        match operator {
            Operator::Add if is(a, 0.0) => b,
            Operator::Add | Operator::Subtract if is(b, 0.0) => a,
            Operator::Subtract if is(a, 0.0) => self.negate(b),
            Operator::Multiply if is(a, 1.0) => b,
            Operator::Multiply | Operator::Divide if is(b, 1.0) => a,
            Operator::Multiply | Operator::Divide if is(a, 0.0) => a,
            Operator::Multiply if is(b, 0.0) => b,
            Operator::Multiply if self.constant_at(b).is_some() && self.constant_at(a).is_none() => {
                self.operate(operator, b, a)
            }
            _ => match (operator, self.step_at(a), self.step_at(b)) {
                // A division costs most, and its derivatives cost more.
                (Operator::Divide, _, Some(Step::WholePower(base, exponent))) if exponent != i32::MIN => {
                    let inverse = self.whole_power(base, -exponent);
                    self.operate(Operator::Multiply, a, inverse)
                }
                (
                    Operator::Multiply,
                    Some(Step::Constant(factor)),
                    Some(Step::Operate(Operator::Multiply, [inner, x])),
                ) if let Some(inner) = self.constant_at(inner) => {
                    let factor = self.constant(factor * inner);
                    self.operate(Operator::Multiply, factor, x)
                }
                _ => self.push(Step::Operate(operator, [a, b])),
            },
        }
    }

    fn step_at(&self, place: Place) -> Option<Step> {
        self.steps.get(place).copied()
    }

    /// A whole constant power.
    pub fn whole_power(&mut self, a: Place, exponent: i32) -> Place {
        match exponent {
            0 => self.constant(1.0),
            1 => a,
            _ => self.push(Step::WholePower(a, exponent)),
        }
    }

    /// Another constant power, of a number that isn't negative.
    pub fn real_power(&mut self, a: Place, exponent: f64) -> Place {
        self.push(Step::RealPower(a, exponent))
    }

    /// 1 where it holds, else 0.
    pub fn compare(&mut self, comparison: Comparison, a: Place, b: Place) -> Place {
        self.push(Step::Compare(comparison, [a, b]))
    }

    /// A function of as many arguments as it takes; missing ones are the first.
    pub fn call(&mut self, function: Function, arguments: &[Place]) -> Place {
        let argument = |i: usize| arguments.get(i).or(arguments.first()).copied().unwrap_or(0);
        self.push(Step::Call(function, std::array::from_fn(argument)))
    }

    /// The same steps where some inputs are known, with the place of each value; what changes nothing with these
    /// is dropped.
    #[must_use]
    pub fn with_known(&self, known: impl Fn(usize) -> Option<f64>) -> (Self, Vec<Place>) {
        let (mut to, mut places) = (Self::default(), Vec::with_capacity(self.steps.len()));
        for step in &self.steps {
            let place = match step.moved(|operand| places[operand]) {
                constant @ Step::Constant(_) => to.push(constant),
                Step::Input(index) => to.push(known(index).map_or(Step::Input(index), Step::Constant)),
                Step::Negate(a) => to.negate(a),
                Step::Operate(operator, [a, b]) => to.operate(operator, a, b),
                Step::WholePower(a, exponent) => to.whole_power(a, exponent),
                other @ (Step::RealPower(..) | Step::Compare(..) | Step::Call(..)) => to.push(other),
            };
            places.push(place);
        }
        (to, places)
    }

    /// The tape that computes these values and no others; none if more than [`MOST_REGISTERS`] numbers are needed at a time.
    #[must_use]
    pub fn finish(&self, outputs: &[Place]) -> Option<Tape> {
        // Until which step each value is needed; outputs to the end.
        let mut last = vec![None; self.steps.len()];
        for output in outputs {
            last[*output] = Some(self.steps.len());
        }
        for place in (0..self.steps.len()).rev() {
            if last[place].is_some() {
                for operand in self.steps[place].operands() {
                    last[operand] = last[operand].max(Some(place));
                }
            }
        }
        let mut register = vec![0; self.steps.len()];
        let (mut free, mut used) = (Vec::new(), 0);
        let mut steps = Vec::new();
        for (place, step) in self.steps.iter().enumerate().filter(|(place, _)| last[*place].is_some()) {
            let moved = step.moved(|operand| register[operand]);
            let mut operands = step.operands();
            operands.sort_unstable();
            let mut before = None;
            for operand in operands {
                if last[operand] == Some(place) && before != Some(operand) {
                    free.push(register[operand]);
                }
                before = Some(operand);
            }
            let into = free.pop().unwrap_or_else(|| {
                used += 1;
                used - 1
            });
            register[place] = into;
            steps.push((into, moved));
        }
        let outputs = outputs.iter().map(|output| register[*output]).collect();
        (used <= MOST_REGISTERS).then_some(Tape { steps, used, outputs })
    }
}

/// Numbers that a tape may need at a time.
pub const MOST_REGISTERS: usize = 128;

/// A formula to be run; its numbers live in as few registers as they can.
#[derive(Debug, Clone, PartialEq)]
pub struct Tape {
    /// Each with the register of its value.
    steps: Vec<(usize, Step)>,
    used: usize,
    outputs: Vec<usize>,
}

impl Tape {
    /// How many steps it has.
    #[must_use]
    pub fn len(&self) -> usize {
        self.steps.len()
    }

    /// Whether it has none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.steps.is_empty()
    }

    /// How many numbers it needs at a time.
    #[must_use]
    pub fn registers(&self) -> usize {
        self.used
    }

    /// The outputs for numbers with or without derivatives. Nothing is allocated; an input or output that is missing is not a number.
    pub fn run<D: Real, const OUTPUTS: usize>(&self, inputs: &[D]) -> [D; OUTPUTS] {
        self.run_on(|index| inputs.get(index).copied().unwrap_or(D::from(f64::NAN)))
    }

    /// The same with inputs by their places.
    pub fn run_on<D: Real, const OUTPUTS: usize>(&self, input: impl Fn(usize) -> D) -> [D; OUTPUTS] {
        self.run_at(|index| [input(index)]).map(|[output]| output)
    }

    /// The same at `L` points at once, which costs less than one after the other: each step is decoded once.
    pub fn run_at<D: Real, const OUTPUTS: usize, const L: usize>(
        &self,
        input: impl Fn(usize) -> [D; L],
    ) -> [[D; L]; OUTPUTS] {
        let mut outputs = [[D::from(f64::NAN); L]; OUTPUTS];
        match self.used {
            0..=8 => self.run_in::<D, 8, L>(&input, &mut outputs),
            9..=32 => self.run_in::<D, 32, L>(&input, &mut outputs),
            _ => self.run_in::<D, MOST_REGISTERS, L>(&input, &mut outputs),
        }
        outputs
    }

    fn run_in<D: Real, const REGISTERS: usize, const L: usize>(
        &self,
        input: &dyn Fn(usize) -> [D; L],
        outputs: &mut [[D; L]],
    ) {
        // Registers come into use one after the other: nothing is filled that isn't needed.
        let mut registers: ArrayVec<[D; L], REGISTERS> = ArrayVec::new();
        for (into, step) in &self.steps {
            let values = step.values(input, &registers);
            match registers.get_mut(*into) {
                Some(register) => *register = values,
                None => registers.push(values),
            }
        }
        for (output, register) in outputs.iter_mut().zip(&self.outputs) {
            *output = registers[*register];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Dual;

    /// What needs no step has none: a product with 1, a first power.
    #[test]
    fn a_tape_is_as_short_as_it_can_be() {
        let mut tape = Builder::default();
        assert!(tape.is_empty());
        let x = tape.input(0);
        let one = tape.constant(1.0);
        let steps = tape.len();
        assert!(!tape.is_empty());
        assert_eq!([tape.whole_power(x, 1), tape.operate(Operator::Multiply, one, x)], [x, x]);
        assert_eq!([tape.operate(Operator::Divide, x, one), tape.len()], [x, steps]);
        // x^3 + x needs x and its power; the constant is left out.
        let power = tape.whole_power(x, 3);
        let sum = tape.operate(Operator::Add, power, x);
        let found = tape.finish(&[sum]).unwrap();
        assert_eq!((found.len(), found.registers(), found.is_empty()), (3, 2, false));
        let [value] = found.run(&[2.0]);
        assert!((value - 10.0_f64).abs() < 1e-15);
        assert!(tape.finish(&[]).unwrap().is_empty());
        // Constants are gathered, whichever side they are on: x 2 3 is 6 x.
        let [two, three, six] = [2.0, 3.0, 6.0].map(|value| tape.constant(value));
        let twice = tape.operate(Operator::Multiply, x, two);
        let gathered = tape.operate(Operator::Multiply, twice, three);
        assert_eq!(gathered, tape.operate(Operator::Multiply, six, x));
        // A power is that of its operand.
        let root = tape.real_power(gathered, 1.5);
        let [value] = tape.finish(&[root]).unwrap().run(&[6.0]);
        assert!((value - 216.0_f64).abs() < 1e-12, "{value}");
    }

    /// Every function and operator at a point where it is smooth: its symbolic derivative, twice, against that of dual numbers.
    #[test]
    fn symbolic_derivatives_are_those_of_dual_numbers() {
        let one = |function: Function| {
            let mut tape = Builder::default();
            let (x, y) = (tape.input(0), tape.input(1));
            let inner = tape.operate(Operator::Multiply, x, y);
            let place = match function.arity() {
                1 => tape.call(function, &[inner]),
                2 => tape.call(function, &[inner, y]),
                _ if function == Function::If => {
                    let condition = tape.compare(Comparison::GreaterOrEqual, x, y);
                    tape.call(function, &[condition, inner, y])
                }
                _ => tape.call(function, &[inner, x, y]),
            };
            (tape, place)
        };
        let operators =
            [Operator::Add, Operator::Subtract, Operator::Multiply, Operator::Divide, Operator::Power];
        let mut tapes: Vec<(String, Builder, Place)> = Vec::new();
        for function in [
            Function::Sqrt,
            Function::Exp,
            Function::Ln,
            Function::Log10,
            Function::Sin,
            Function::Cos,
            Function::Tan,
            Function::Asin,
            Function::Atan,
            Function::Tanh,
            Function::Sinh,
            Function::Cosh,
            Function::Abs,
            Function::Sign,
            Function::Step,
            Function::Min,
            Function::Max,
            Function::Clamp,
            Function::If,
        ] {
            let (tape, place) = one(function);
            tapes.push((format!("{function:?}"), tape, place));
        }
        for operator in operators {
            let mut tape = Builder::default();
            let (x, y) = (tape.input(0), tape.input(1));
            let (square, negative) = (tape.whole_power(x, 2), tape.negate(y));
            let root = tape.real_power(square, 0.7);
            let power = tape.whole_power(negative, -2);
            let place = tape.operate(operator, root, power);
            tapes.push((format!("{operator:?}"), tape, place));
        }
        for (name, mut tape, place) in tapes {
            let by = [0, 1].map(|input| tape.derivative(place, input));
            let outputs = [place, by[0], by[1]];
            let seconds = [(by[0], 0), (by[0], 1), (by[1], 1)].map(|(of, input)| tape.derivative(of, input));
            let first = tape.finish(&outputs).unwrap();
            let second = tape.finish(&seconds).unwrap();
            let at = [Dual::<2>::variable(0.8, 0), Dual::variable(0.7, 1)];
            let [value, by_x, by_y]: [Dual<2>; 3] = first.run(&at);
            let [xx, xy, yy]: [f64; 3] = second.run(&[0.8, 0.7]);
            let pairs = [
                (by_x.value(), value.gradient()[0]),
                (by_y.value(), value.gradient()[1]),
                (xx, by_x.gradient()[0]),
                (xy, by_x.gradient()[1]),
                (xy, by_y.gradient()[0]),
                (yy, by_y.gradient()[1]),
            ];
            for (i, (symbolic, dual)) in pairs.into_iter().enumerate() {
                assert!(
                    (symbolic - dual).abs() <= 1e-13 * (1.0 + dual.abs()),
                    "{name} {i}: {symbolic} {dual}"
                );
            }
        }
    }

    /// What is computed once is kept once, and nothing is kept that changes nothing.
    #[test]
    fn values_are_shared() {
        let mut tape = Builder::default();
        let (x, zero, two) = (tape.input(0), tape.constant(0.0), tape.constant(2.0));
        let twice = [tape.operate(Operator::Multiply, x, two), tape.operate(Operator::Multiply, x, two)];
        assert_eq!(twice[0], twice[1]);
        assert_eq!(tape.operate(Operator::Add, twice[0], zero), twice[0]);
        let four = tape.operate(Operator::Multiply, two, two);
        assert_eq!(tape.constant_at(four), Some(4.0));
        let back = tape.negate(x);
        assert_eq!(tape.negate(back), x);
        // -x and 4 are not needed for 2 x.
        assert_eq!(tape.finish(&[twice[0]]).unwrap().len(), 3);
    }

    /// With a known input a formula is the shorter one that a reader would write.
    #[test]
    fn known_inputs_simplify() {
        let mut tape = Builder::default();
        let (x, k, one) = (tape.input(0), tape.input(1), tape.constant(1.0));
        let part = tape.operate(Operator::Multiply, k, x);
        let factor = tape.operate(Operator::Add, one, part);
        let sine = tape.call(Function::Sin, &[x]);
        let product = tape.operate(Operator::Multiply, sine, factor);
        let (mut none, places) = tape.with_known(|index| (index == 1).then_some(0.0));
        let x = none.input(0);
        assert_eq!(places[product], none.call(Function::Sin, &[x]));
        assert_eq!(none.constant_at(places[part]), Some(0.0));
        let (some, places) = tape.with_known(|index| (index == 1).then_some(2.0));
        let [found] = some.finish(&[places[product]]).unwrap().run(&[0.5]);
        assert_eq!(found.to_bits(), (0.5_f64.sin() * 2.0).to_bits());
    }

    /// A sum of many products needs few registers, whatever its length.
    #[test]
    fn registers_are_used_again() {
        let mut tape = Builder::default();
        let mut sum = tape.constant(0.0);
        for i in 0..300 {
            let x = tape.input(i);
            let square = tape.whole_power(x, 2);
            sum = tape.operate(Operator::Add, sum, square);
        }
        let tape = tape.finish(&[sum]).unwrap();
        assert!(tape.used <= 3 && tape.len() > 800, "{} {}", tape.used, tape.len());
        let inputs: Vec<f64> = (0..300).map(f64::from).collect();
        let [found] = tape.run(&inputs);
        assert_eq!(found.to_bits(), (0..300).map(|i| f64::from(i).powi(2)).sum::<f64>().to_bits());
        let [missing] = tape.run(&inputs[..299]);
        assert!(missing.is_nan());
    }

    #[test]
    fn too_many_numbers_at_a_time_are_refused() {
        let mut tape = Builder::default();
        let inputs: Vec<Place> = (0..=MOST_REGISTERS).map(|i| tape.input(i)).collect();
        assert!(tape.finish(&inputs).is_none() && tape.finish(&inputs[1..]).is_some());
    }
}
