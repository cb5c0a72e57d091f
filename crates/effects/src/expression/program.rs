//! A formula as a flat list of steps on a stack, for numbers with or without derivatives.

use super::elementary;
use super::function::{Comparison, Function};
use super::node::Operator;
use bulge_numerics::Real;

/// One step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Step {
    Constant(f64),
    Variable(usize),
    Parameter(usize),
    Negate,
    Operate(Operator),
    /// A whole constant power.
    WholePower(i32),
    /// Another constant power.
    RealPower(f64),
    Compare(Comparison),
    Call(Function),
}

impl Step {
    /// How many numbers it takes from the stack; each leaves one.
    fn takes(self) -> usize {
        match self {
            Self::Constant(_) | Self::Variable(_) | Self::Parameter(_) => 0,
            Self::Negate | Self::WholePower(_) | Self::RealPower(_) => 1,
            Self::Operate(_) | Self::Compare(_) => 2,
            Self::Call(function) => function.arity(),
        }
    }
}

/// The steps, and how many numbers the stack holds at most.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Program {
    pub(crate) steps: Vec<Step>,
    pub(crate) stack: usize,
}

/// The most numbers that a stack may hold.
pub(crate) const MAX_STACK: usize = 64;

impl Program {
    /// From steps that never take more than there is.
    pub(crate) fn new(steps: Vec<Step>) -> Self {
        let (mut height, mut stack) = (0_usize, 0);
        for step in &steps {
            height = (height + 1).saturating_sub(step.takes());
            stack = height.max(stack);
        }
        Self { steps, stack }
    }

    /// The value. A variable or parameter that is not given makes it not a number.
    pub(crate) fn run<D: Real>(&self, variables: &[D], parameters: &[D]) -> D {
        // Filling a large stack would take longer than a short formula.
        match self.stack {
            0..=4 => run_on::<D, 4>(&self.steps, variables, parameters),
            5..=12 => run_on::<D, 12>(&self.steps, variables, parameters),
            _ => run_on::<D, MAX_STACK>(&self.steps, variables, parameters),
        }
    }
}

fn run_on<D: Real, const DEPTH: usize>(steps: &[Step], variables: &[D], parameters: &[D]) -> D {
    let undefined = D::from(f64::NAN);
    let mut stack = [undefined; DEPTH];
    let mut height = 0;
    for step in steps {
        let top = |below: usize| stack[height - below];
        let value = match *step {
            Step::Constant(value) => D::from(value),
            Step::Variable(index) => variables.get(index).copied().unwrap_or(undefined),
            Step::Parameter(index) => parameters.get(index).copied().unwrap_or(undefined),
            Step::Negate => -top(1),
            Step::WholePower(exponent) => top(1).powi(exponent),
            Step::RealPower(exponent) => elementary::real_power(top(1), exponent),
            Step::Operate(operator) => operate(operator, top(2), top(1)),
            Step::Compare(comparison) => compare(comparison, top(2), top(1)),
            Step::Call(Function::Min) => elementary::minimum(top(2), top(1)),
            Step::Call(Function::Max) => elementary::maximum(top(2), top(1)),
            Step::Call(Function::Clamp) => elementary::clamp(top(3), top(2), top(1)),
            Step::Call(Function::If) => choose(top(3), top(2), top(1)),
            Step::Call(function) => single(function, top(1)),
        };
        height -= step.takes();
        stack[height] = value;
        height += 1;
    }
    stack[0]
}

fn operate<D: Real>(operator: Operator, a: D, b: D) -> D {
    match operator {
        Operator::Add => a + b,
        Operator::Subtract => a - b,
        Operator::Multiply => a * b,
        Operator::Divide => a / b,
        Operator::Power => elementary::power(a, b),
    }
}

/// 1 or 0; not a number where a side is none.
fn compare<D: Real>(comparison: Comparison, a: D, b: D) -> D {
    let (a, b) = (a.value(), b.value());
    D::from(match comparison.holds(a, b) {
        _ if a.is_nan() || b.is_nan() => f64::NAN,
        true => 1.0,
        false => 0.0,
    })
}

/// Both values were computed; the other one is dropped with all that is wrong with it.
fn choose<D: Real>(condition: D, yes: D, no: D) -> D {
    match condition.value() {
        1.0 => yes,
        0.0 => no,
        _ => condition,
    }
}

fn single<D: Real>(function: Function, x: D) -> D {
    match function {
        Function::Sqrt => elementary::square_root(x),
        Function::Exp => x.exp(),
        Function::Ln => x.ln(),
        Function::Log10 => elementary::log10(x),
        Function::Sin => x.sin_cos().0,
        Function::Cos => x.sin_cos().1,
        Function::Tan => elementary::tan(x),
        Function::Asin => elementary::asin(x),
        Function::Atan => x.atan(),
        Function::Tanh => x.tanh(),
        Function::Sinh => elementary::sinh(x),
        Function::Cosh => elementary::cosh(x),
        Function::Abs => x.abs(),
        Function::Sign => elementary::sign(x),
        Function::Step => elementary::step(x),
        // These take more than one argument.
        Function::Min | Function::Max | Function::Clamp | Function::If => x,
    }
}
