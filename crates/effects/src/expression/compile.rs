//! Parts into steps: every part gets its dimension, constants are computed once, and units that do not fit are refused.

use super::error::{ExpressionError, quoted};
use super::function::Function;
use super::node::{Node, Operator, Part};
use super::program::{MAX_STACK, Program, Step};
use bulge_muscles::Dimension;
use std::ops::Range;

/// The largest magnitude of a constant exponent.
const MAX_EXPONENT: f64 = 1000.0;

/// Compiles a formula that must have the dimension `result`.
pub(crate) fn compile(
    text: &str,
    nodes: &[Node],
    variables: impl Fn(usize) -> Dimension,
    parameters: impl Fn(usize) -> Dimension,
    result: Dimension,
) -> Result<Program, ExpressionError> {
    let mut compiler = Compiler { text, steps: Vec::new(), operands: Vec::new() };
    for node in nodes {
        match &node.part {
            Part::Number { si, dimension, unit, .. } => {
                // A plain 0 fits any dimension.
                let is_plain_zero = *si == 0.0 && unit.is_none();
                compiler.begin(
                    node,
                    Step::Constant(*si),
                    (!is_plain_zero).then_some(*dimension),
                    Some(*si),
                )?;
            }
            Part::Pi => {
                let pi = std::f64::consts::PI;
                compiler.begin(node, Step::Constant(pi), Some(Dimension::NONE), Some(pi))?;
            }
            Part::Variable(index) => {
                compiler.begin(node, Step::Variable(*index), Some(variables(*index)), None)?;
            }
            Part::Parameter(index) => {
                compiler.begin(node, Step::Parameter(*index), Some(parameters(*index)), None)?;
            }
            part => compiler.combine(node, part)?,
        }
    }
    let found = compiler.operands.pop().and_then(|operand| operand.dimension);
    match found {
        Some(found) if found != result => Err(compiler.wrong_result(found, result)),
        _ => Ok(Program::new(compiler.steps)),
    }
}

/// A part that is complete, and waits for its operator.
#[derive(Debug, Clone)]
struct Operand {
    span: Range<usize>,
    /// None: a plain 0, which fits any.
    dimension: Option<Dimension>,
    /// Where its steps begin.
    start: usize,
    /// Its value, if it is constant.
    constant: Option<f64>,
}

struct Compiler<'t> {
    text: &'t str,
    steps: Vec<Step>,
    operands: Vec<Operand>,
}

impl Compiler<'_> {
    fn error(&self, span: &Range<usize>, what: String, instead: impl Into<String>) -> ExpressionError {
        ExpressionError::new(self.text, span.clone(), what, instead)
    }

    /// `text` (unit), for messages.
    fn named(&self, operand: &Operand) -> String {
        format!("`{}` ({})", quoted(&self.text[operand.span.clone()]), operand.dimension.unwrap_or_default())
    }

    /// A part without operands.
    fn begin(
        &mut self,
        node: &Node,
        step: Step,
        dimension: Option<Dimension>,
        constant: Option<f64>,
    ) -> Result<(), ExpressionError> {
        let start = self.steps.len();
        self.steps.push(step);
        self.operands.push(Operand { span: node.span.clone(), dimension, start, constant });
        if self.operands.len() <= MAX_STACK {
            return Ok(());
        }
        let what = format!("the formula keeps more than {MAX_STACK} numbers waiting here");
        Err(self.error(&node.span, what, "leave out parentheses, or put the long part of a sum first"))
    }

    /// A part whose operands are the last ones.
    fn combine(&mut self, node: &Node, part: &Part) -> Result<(), ExpressionError> {
        let first = self.operands.len().saturating_sub(part.arity());
        let operands = self.operands.split_off(first);
        let start = operands.first().map_or(0, |operand| operand.start);
        let dimension = self.dimension(node, part, &operands)?;
        let step = self.step(node, part, &operands)?;
        self.steps.push(step);
        let is_constant = operands.iter().all(|operand| operand.constant.is_some());
        // Constant operands are one step each.
        let constant = is_constant.then(|| Program::new(self.steps[start..].to_vec()).run::<f64>(&[], &[]));
        if let Some(value) = constant {
            if !value.is_finite() {
                let what = format!("`{}` is not a finite number", quoted(&self.text[node.span.clone()]));
                return Err(self.error(&node.span, what, "write a number, or a formula with a value"));
            }
            self.steps.truncate(start);
            self.steps.push(Step::Constant(value));
        }
        self.operands.push(Operand { span: node.span.clone(), dimension, start, constant });
        Ok(())
    }

    /// The step of an operator; a constant exponent becomes part of it.
    fn step(&mut self, node: &Node, part: &Part, operands: &[Operand]) -> Result<Step, ExpressionError> {
        Ok(match (part, operands) {
            (Part::Operate(Operator::Power), [_, Operand { constant: Some(exponent), .. }]) => {
                if exponent.abs() > MAX_EXPONENT {
                    let what = format!("the exponent {exponent} is beyond {MAX_EXPONENT}");
                    return Err(self.error(&node.span, what, "write a smaller one, or `exp`"));
                }
                self.steps.pop();
                match *exponent {
                    0.5 => Step::Call(Function::Sqrt),
                    whole if whole.fract() == 0.0 => {
                        #[expect(clippy::cast_possible_truncation, reason = "whole and at most 1000")]
                        let whole = whole as i32;
                        Step::WholePower(whole)
                    }
                    other => Step::RealPower(other),
                }
            }
            (Part::Operate(operator), _) => Step::Operate(*operator),
            (Part::Compare(comparison), _) => Step::Compare(*comparison),
            (Part::Call(function), _) => Step::Call(*function),
            _ => Step::Negate,
        })
    }

    /// The dimension of a part with these operands.
    fn dimension(
        &self,
        node: &Node,
        part: &Part,
        operands: &[Operand],
    ) -> Result<Option<Dimension>, ExpressionError> {
        let too_large = || {
            let what =
                format!("the unit of `{}` has a power beyond 64", quoted(&self.text[node.span.clone()]));
            self.error(&node.span, what, "write smaller powers of quantities with a unit")
        };
        match (part, operands) {
            (Part::Operate(Operator::Power), [base, exponent]) => self.power(node, base, exponent),
            (Part::Operate(operator @ (Operator::Multiply | Operator::Divide)), [a, b]) => {
                let (a, b) = (a.dimension.unwrap_or_default(), b.dimension.unwrap_or_default());
                let found = if *operator == Operator::Multiply { a.times(b) } else { a.over(b) };
                found.map(Some).ok_or_else(too_large)
            }
            (Part::Operate(operator), [a, b]) => {
                let (verb, first, second) = match operator {
                    Operator::Subtract => ("cannot be subtracted from", b, a),
                    _ => ("cannot be added to", a, b),
                };
                self.agree(a, b, || format!("{} {verb} {}", self.named(first), self.named(second)))
            }
            (Part::Compare(_), [a, b]) => {
                self.agree(a, b, || format!("{} cannot be compared with {}", self.named(a), self.named(b)))
            }
            (Part::Call(function), _) => self.call(*function, operands),
            (_, [operand]) => Ok(operand.dimension),
            _ => Ok(Some(Dimension::NONE)),
        }
    }

    fn call(&self, function: Function, operands: &[Operand]) -> Result<Option<Dimension>, ExpressionError> {
        let together = |a: &Operand, b: &Operand| {
            self.agree(a, b, || {
                format!("{} and {} cannot stand in one `{}`", self.named(a), self.named(b), function.name())
            })
        };
        match (function, operands) {
            (Function::Min | Function::Max, [a, b]) | (Function::If, [_, a, b]) => together(a, b),
            (Function::Clamp, [x, low, high]) => {
                let (with_low, with_high) = (together(x, low)?, together(x, high)?);
                Ok(with_low.or(with_high).or(together(low, high)?))
            }
            (Function::Abs, [x]) => Ok(x.dimension),
            (Function::Sign | Function::Step, _) => Ok(Some(Dimension::NONE)),
            (Function::Sqrt, [x]) => match x.dimension.map(Dimension::root) {
                None => Ok(None),
                Some(Some(root)) => Ok(Some(root)),
                Some(None) => {
                    let what = format!("the square root of {} has no unit with halves", self.named(x));
                    Err(self.error(&x.span, what, "take the root of a square, or of a pure number"))
                }
            },
            (_, [x]) => match x.dimension {
                Some(dimension) if !dimension.is_none() => {
                    let what = format!(
                        "`{}` needs a pure number, but {} has a unit",
                        function.name(),
                        self.named(x)
                    );
                    let instead = format!(
                        "divide it by a quantity in {dimension}: a parameter, or a number such as `1 [{dimension}]`"
                    );
                    Err(self.error(&x.span, what, instead))
                }
                _ => Ok(Some(Dimension::NONE)),
            },
            _ => Ok(Some(Dimension::NONE)),
        }
    }

    fn power(
        &self,
        node: &Node,
        base: &Operand,
        exponent: &Operand,
    ) -> Result<Option<Dimension>, ExpressionError> {
        if let Some(dimension) = exponent.dimension.filter(|dimension| !dimension.is_none()) {
            let what = format!("the exponent {} has a unit", self.named(exponent));
            let instead = format!("divide the exponent by a quantity in {dimension}");
            return Err(self.error(&exponent.span, what, instead));
        }
        let dimension = base.dimension.unwrap_or_default();
        if dimension.is_none() {
            return Ok(Some(dimension));
        }
        let Some(constant) = exponent.constant else {
            let what = format!("{} has a unit, so its exponent must be a constant number", self.named(base));
            let instead = format!("divide it by a quantity in {dimension} before taking the power");
            return Err(self.error(&node.span, what, instead));
        };
        dimension.power(constant).map(Some).ok_or_else(|| {
            let what = format!(
                "{} to the power of {constant} has no unit with whole or half powers",
                self.named(base)
            );
            let instead = format!("divide it by a quantity in {dimension} before taking the power");
            self.error(&node.span, what, instead)
        })
    }

    /// The dimension that both have; a plain 0 has that of the other.
    fn agree(
        &self,
        a: &Operand,
        b: &Operand,
        what: impl Fn() -> String,
    ) -> Result<Option<Dimension>, ExpressionError> {
        let (Some(left), Some(right)) = (a.dimension, b.dimension) else {
            return Ok(a.dimension.or(b.dimension));
        };
        if left == right {
            return Ok(Some(left));
        }
        let bare = |operand: &Operand| self.text[operand.span.clone()].parse::<f64>().is_ok();
        let number = |operand: &Operand, unit| {
            format!("give the number its unit: `{} [{unit}]`", &self.text[operand.span.clone()])
        };
        let instead = match (bare(a), bare(b)) {
            (true, _) => number(a, right),
            (_, true) => number(b, left),
            _ => match left.over(right) {
                Some(factor) => {
                    let b = quoted(&self.text[b.span.clone()]);
                    format!(
                        "multiply `{b}` by a quantity in {factor}: a parameter, or a number such as `1 [{factor}]`"
                    )
                }
                None => "make their units agree".to_owned(),
            },
        };
        let span = a.span.start.min(b.span.start)..a.span.end.max(b.span.end);
        Err(self.error(&span, what(), instead))
    }

    fn wrong_result(&self, found: Dimension, wanted: Dimension) -> ExpressionError {
        let what = format!("the formula gives {}, but must give {}", found.describe(), wanted.describe());
        let instead = match wanted.over(found) {
            Some(factor) => {
                format!(
                    "multiply it by a quantity in {factor}: a parameter, or a number such as `1 [{factor}]`"
                )
            }
            None => format!("write a formula that gives {}", wanted.describe()),
        };
        let end = self.text.trim_end().len();
        let start = self.text.len() - self.text.trim_start().len();
        self.error(&(start..end), what, instead)
    }
}
