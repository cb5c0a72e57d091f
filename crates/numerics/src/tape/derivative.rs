//! Symbolic derivatives: the rule of every step, its parts shared with what is there already.

use super::{Builder, Comparison, Function, Operator, Place, Step};

impl Builder {
    /// Adds the derivative of a value by an input.
    pub fn derivative(&mut self, of: Place, input: usize) -> Place {
        let mut by: Vec<Place> = Vec::with_capacity(of + 1);
        let (zero, one) = (self.constant(0.0), self.constant(1.0));
        for place in 0..=of {
            let step = self.steps[place];
            let slope = match step {
                Step::Input(index) if index == input => one,
                // Nothing moves that depends on nothing that does.
                _ if step.operands().iter().all(|a| by[*a] == zero) => zero,
                _ => self.rule(step, place, &by),
            };
            by.push(slope);
        }
        by[of]
    }

    /// The derivative of a step at `place`, whose operands have the derivatives `by`.
    fn rule(&mut self, step: Step, place: Place, by: &[Place]) -> Place {
        use Operator::{Add, Divide, Multiply, Subtract};
        match step {
            Step::Constant(_) | Step::Input(_) | Step::Compare(..) => self.constant(0.0),
            Step::Negate(a) => self.negate(by[a]),
            Step::Operate(operator @ (Add | Subtract), [a, b]) => self.operate(operator, by[a], by[b]),
            Step::Operate(Multiply, [a, b]) => {
                let (left, right) = (self.operate(Multiply, by[a], b), self.operate(Multiply, a, by[b]));
                self.operate(Add, left, right)
            }
            Step::Operate(Divide, [a, b]) => {
                let less = self.operate(Multiply, place, by[b]);
                let rest = self.operate(Subtract, by[a], less);
                self.operate(Divide, rest, b)
            }
            Step::Operate(Operator::Power, [a, b]) => {
                let logarithm = self.call(Function::Ln, &[a]);
                let of_exponent = self.operate(Multiply, by[b], logarithm);
                let relative = self.operate(Divide, by[a], a);
                let of_base = self.operate(Multiply, b, relative);
                let sum = self.operate(Add, of_exponent, of_base);
                self.operate(Multiply, place, sum)
            }
            Step::WholePower(a, exponent) => {
                let (factor, lower) = (self.constant(exponent.into()), self.whole_power(a, exponent - 1));
                let slope = self.operate(Multiply, factor, lower);
                self.operate(Multiply, slope, by[a])
            }
            Step::RealPower(a, exponent) => {
                let (factor, lower) = (self.constant(exponent), self.real_power(a, exponent - 1.0));
                let slope = self.operate(Multiply, factor, lower);
                self.operate(Multiply, slope, by[a])
            }
            Step::Call(Function::Min, [a, b, _]) => self.branch(Comparison::Less, [b, a], [by[b], by[a]]),
            Step::Call(Function::Max, [a, b, _]) => self.branch(Comparison::Greater, [b, a], [by[b], by[a]]),
            Step::Call(Function::Clamp, [x, low, high]) => {
                let below = self.call(Function::Min, &[x, high]);
                let slope = self.branch(Comparison::Less, [high, x], [by[high], by[x]]);
                self.branch(Comparison::Greater, [low, below], [by[low], slope])
            }
            Step::Call(Function::If, [condition, yes, no]) => {
                self.call(Function::If, &[condition, by[yes], by[no]])
            }
            Step::Call(function, [x, ..]) => {
                let slope = self.slope_of(function, x, place);
                self.operate(Multiply, slope, by[x])
            }
        }
    }

    /// `yes` where a comparison holds, else `no`.
    fn branch(&mut self, comparison: Comparison, [a, b]: [Place; 2], [yes, no]: [Place; 2]) -> Place {
        let condition = self.compare(comparison, a, b);
        self.call(Function::If, &[condition, yes, no])
    }

    /// The slope of a function of one argument at `x`, where it has the value at `place`.
    fn slope_of(&mut self, function: Function, x: Place, place: Place) -> Place {
        use Operator::{Add, Divide, Multiply, Subtract};
        let (one, square) = (self.constant(1.0), self.whole_power(place, 2));
        match function {
            Function::Sqrt => {
                let half = self.constant(0.5);
                self.operate(Divide, half, place)
            }
            Function::Exp => place,
            Function::Ln => self.operate(Divide, one, x),
            Function::Log10 => {
                let ln_10 = self.constant(std::f64::consts::LN_10);
                let below = self.operate(Multiply, x, ln_10);
                self.operate(Divide, one, below)
            }
            Function::Sin => self.call(Function::Cos, &[x]),
            Function::Cos => {
                let sine = self.call(Function::Sin, &[x]);
                self.negate(sine)
            }
            Function::Tan => self.operate(Add, one, square),
            Function::Asin => {
                let square = self.whole_power(x, 2);
                let rest = self.operate(Subtract, one, square);
                let root = self.call(Function::Sqrt, &[rest]);
                self.operate(Divide, one, root)
            }
            Function::Atan => {
                let square = self.whole_power(x, 2);
                let below = self.operate(Add, one, square);
                self.operate(Divide, one, below)
            }
            Function::Tanh => self.operate(Subtract, one, square),
            Function::Sinh => self.call(Function::Cosh, &[x]),
            Function::Cosh => self.call(Function::Sinh, &[x]),
            Function::Abs => self.call(Function::Sign, &[x]),
            // The others have more arguments.
            _ => self.constant(0.0),
        }
    }
}
