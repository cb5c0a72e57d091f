//! Compiles the parts of a formula to a tape. Every part gets its dimension, constants are computed once, and
//! inconsistent units are refused.

use super::error::ExpressionError;
use super::function;
use super::node::{Node, Part};
use bulge_muscles::Dimension;
use bulge_muscles::shown::shortened;
use bulge_numerics::tape::{Builder, Function, Operator, Place};
use std::ops::Range;

/// The largest magnitude of a constant exponent.
const MAX_EXPONENT: f64 = 1000.0;
/// The largest number of operands waiting for their operator. A formula without shared parts needs as many
/// registers.
const MAX_WAITING: usize = 64;

/// Compiles a formula that must have the dimension `result`. Returns the steps and the place of the value.
/// The inputs are the `count` variables, followed by the parameters.
pub(crate) fn compile(
    text: &str,
    nodes: &[Node],
    count: usize,
    dimension: impl Fn(usize) -> Dimension,
    result: Dimension,
) -> Result<(Builder, Place), ExpressionError> {
    let mut compiler = Compiler { text, tape: Builder::default(), operands: Vec::new() };
    for node in nodes {
        match &node.part {
            Part::Number { si, dimension, unit, .. } => {
                // A plain 0 fits any dimension.
                let is_plain_zero = *si == 0.0 && unit.is_none();
                let place = compiler.tape.constant(*si);
                compiler.begin(node, place, (!is_plain_zero).then_some(*dimension))?;
            }
            Part::Pi => {
                let place = compiler.tape.constant(std::f64::consts::PI);
                compiler.begin(node, place, Some(Dimension::NONE))?;
            }
            Part::Variable(index) => compiler.input(node, *index, &dimension)?,
            Part::Parameter(index) => compiler.input(node, count + index, &dimension)?,
            part => compiler.combine(node, part)?,
        }
    }
    let found = compiler.operands.pop();
    let place = found.as_ref().map_or(0, |operand| operand.place);
    match found.and_then(|operand| operand.dimension) {
        Some(found) if found != result => Err(compiler.wrong_result(found, result)),
        _ => Ok((compiler.tape, place)),
    }
}

/// A complete part that waits for its operator.
#[derive(Debug, Clone)]
struct Operand {
    span: Range<usize>,
    /// None for a plain 0, which fits any dimension.
    dimension: Option<Dimension>,
    place: Place,
}

struct Compiler<'t> {
    text: &'t str,
    tape: Builder,
    operands: Vec<Operand>,
}

impl Compiler<'_> {
    fn error(&self, span: &Range<usize>, what: String, instead: impl Into<String>) -> ExpressionError {
        ExpressionError::new(self.text, span.clone(), what, instead)
    }

    /// `text` (unit), for messages.
    fn named(&self, operand: &Operand) -> String {
        format!(
            "`{}` ({})",
            shortened(&self.text[operand.span.clone()]),
            operand.dimension.unwrap_or_default()
        )
    }

    fn input(
        &mut self,
        node: &Node,
        index: usize,
        dimension: impl Fn(usize) -> Dimension,
    ) -> Result<(), ExpressionError> {
        let place = self.tape.input(index);
        self.begin(node, place, Some(dimension(index)))
    }

    /// Adds a part without operands.
    fn begin(
        &mut self,
        node: &Node,
        place: Place,
        dimension: Option<Dimension>,
    ) -> Result<(), ExpressionError> {
        self.operands.push(Operand { span: node.span.clone(), dimension, place });
        if self.operands.len() <= MAX_WAITING {
            return Ok(());
        }
        let what = format!("the formula keeps more than {MAX_WAITING} numbers waiting here");
        Err(self.error(&node.span, what, "leave out parentheses, or put the long part of a sum first"))
    }

    fn constant(&self, operand: &Operand) -> Option<f64> {
        self.tape.constant_at(operand.place)
    }

    /// Adds a part whose operands are the last ones.
    fn combine(&mut self, node: &Node, part: &Part) -> Result<(), ExpressionError> {
        let first = self.operands.len().saturating_sub(part.arity());
        let operands = self.operands.split_off(first);
        let dimension = self.dimension(node, part, &operands)?;
        let place = self.place(node, part, &operands)?;
        if self.tape.constant_at(place).is_some_and(|value| !value.is_finite()) {
            let what = format!("`{}` is not a finite number", shortened(&self.text[node.span.clone()]));
            return Err(self.error(&node.span, what, "write a number, or a formula with a value"));
        }
        self.operands.push(Operand { span: node.span.clone(), dimension, place });
        Ok(())
    }

    /// The value of an operator. A constant exponent becomes part of the operator.
    fn place(&mut self, node: &Node, part: &Part, operands: &[Operand]) -> Result<Place, ExpressionError> {
        let places: Vec<Place> = operands.iter().map(|operand| operand.place).collect();
        let exponent = operands.get(1).and_then(|operand| self.constant(operand));
        Ok(match (part, places.as_slice(), exponent) {
            (Part::Operate(Operator::Power), [base, _], Some(exponent)) => {
                if exponent.abs() > MAX_EXPONENT {
                    let what = format!("the exponent {exponent} is beyond {MAX_EXPONENT}");
                    return Err(self.error(&node.span, what, "write a smaller one, or `exp`"));
                }
                match exponent {
                    0.5 => self.tape.call(Function::Sqrt, &[*base]),
                    whole if whole.fract() == 0.0 => {
                        #[expect(clippy::cast_possible_truncation, reason = "whole and at most 1000")]
                        let whole = whole as i32;
                        self.tape.whole_power(*base, whole)
                    }
                    other => self.tape.real_power(*base, other),
                }
            }
            (Part::Operate(operator), [a, b], _) => self.tape.operate(*operator, *a, *b),
            (Part::Compare(comparison), [a, b], _) => self.tape.compare(*comparison, *a, *b),
            (Part::Call(called), arguments, _) => self.tape.call(*called, arguments),
            (_, [a, ..], _) => self.tape.negate(*a),
            _ => self.tape.constant(f64::NAN),
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
                format!("the unit of `{}` has a power beyond 64", shortened(&self.text[node.span.clone()]));
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

    fn call(&self, called: Function, operands: &[Operand]) -> Result<Option<Dimension>, ExpressionError> {
        let together = |a: &Operand, b: &Operand| {
            self.agree(a, b, || {
                format!(
                    "{} and {} cannot stand in one `{}`",
                    self.named(a),
                    self.named(b),
                    function::name(called)
                )
            })
        };
        match (called, operands) {
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
                        function::name(called),
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
        let Some(constant) = self.constant(exponent) else {
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

    /// The common dimension of two operands. A plain 0 takes that of the other.
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
                    let b = shortened(&self.text[b.span.clone()]);
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
