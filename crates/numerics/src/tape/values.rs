//! The value of a step from those of its operands.

use super::{Function, Operator, Place, Step};
use crate::Real;
use crate::elementary::{
    asin, clamp, cosh, log10, maximum, minimum, power, real_power, sign, sinh, square_root, step, tan,
};

impl Step {
    /// The value at each of `L` points.
    #[inline]
    pub(super) fn values<D: Real, const L: usize>(
        self,
        input: &dyn Fn(usize) -> [D; L],
        registers: &[[D; L]],
    ) -> [D; L] {
        let at = |place: Place| registers[place];
        match self {
            Self::Constant(value) => [D::from(value); L],
            Self::Input(index) => input(index),
            Self::Negate(a) => each(at(a), |a| -a),
            Self::WholePower(a, exponent) => each(at(a), |a| a.powi(exponent)),
            Self::RealPower(a, exponent) => each(at(a), |a| real_power(a, exponent)),
            Self::Operate(operator, [a, b]) => match operator {
                Operator::Add => both(at(a), &at(b), |a, b| a + b),
                Operator::Subtract => both(at(a), &at(b), |a, b| a - b),
                Operator::Multiply => both(at(a), &at(b), |a, b| a * b),
                Operator::Divide => both(at(a), &at(b), |a, b| a / b),
                Operator::Power => both(at(a), &at(b), power),
            },
            Self::Compare(comparison, [a, b]) => both(at(a), &at(b), |a, b| {
                let (a, b) = (a.value(), b.value());
                D::from(match comparison.holds(a, b) {
                    _ if a.is_nan() || b.is_nan() => f64::NAN,
                    true => 1.0,
                    false => 0.0,
                })
            }),
            Self::Call(Function::Min, [a, b, _]) => both(at(a), &at(b), minimum),
            Self::Call(Function::Max, [a, b, _]) => both(at(a), &at(b), maximum),
            Self::Call(Function::Clamp, [x, low, high]) => all(at(x), &at(low), &at(high), clamp),
            // Both values were computed; the other one is dropped with all that is wrong with it.
            Self::Call(Function::If, [condition, yes, no]) => {
                all(at(condition), &at(yes), &at(no), |condition, yes, no| match condition.value() {
                    1.0 => yes,
                    0.0 => no,
                    _ => condition,
                })
            }
            Self::Call(function, [x, ..]) => each(at(x), |x| single(function, x)),
        }
    }
}

// Loops in place: with `array::map` and `array::from_fn` half of all code that the compiler sees would be these functions.

#[inline]
fn each<D: Real, const L: usize>(mut x: [D; L], f: impl Fn(D) -> D) -> [D; L] {
    for x in &mut x {
        *x = f(*x);
    }
    x
}

#[inline]
fn both<D: Real, const L: usize>(mut a: [D; L], b: &[D; L], f: impl Fn(D, D) -> D) -> [D; L] {
    for (a, b) in a.iter_mut().zip(b) {
        *a = f(*a, *b);
    }
    a
}

#[inline]
fn all<D: Real, const L: usize>(mut a: [D; L], b: &[D; L], c: &[D; L], f: impl Fn(D, D, D) -> D) -> [D; L] {
    for (a, (b, c)) in a.iter_mut().zip(b.iter().zip(c)) {
        *a = f(*a, *b, *c);
    }
    a
}

fn single<D: Real>(function: Function, x: D) -> D {
    match function {
        Function::Sqrt => square_root(x),
        Function::Exp => x.exp(),
        Function::Ln => x.ln(),
        Function::Log10 => log10(x),
        Function::Sin => x.sin_cos().0,
        Function::Cos => x.sin_cos().1,
        Function::Tan => tan(x),
        Function::Asin => asin(x),
        Function::Atan => x.atan(),
        Function::Tanh => x.tanh(),
        Function::Sinh => sinh(x),
        Function::Cosh => cosh(x),
        Function::Abs => x.abs(),
        Function::Sign => sign(x),
        Function::Step => step(x),
        // These take more than one argument.
        Function::Min | Function::Max | Function::Clamp | Function::If => x,
    }
}
