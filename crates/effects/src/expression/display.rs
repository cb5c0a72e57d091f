//! Writes a formula as text, with no more parentheses than it needs.

use super::function;
use super::node::{Node, Part};
use super::variable::Variable;
use bulge_numerics::tape::{Function, Operator};

/// The tightness with which a text holds together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Tightness {
    Comparison,
    Sum,
    Product,
    Unary,
    Power,
    Atom,
}

/// Writes the parts. Reading the text gives the same parts.
pub(crate) fn written(text: &str, nodes: &[Node], variables: &[Variable], parameters: &[String]) -> String {
    let mut operands: Vec<(String, Tightness)> = Vec::new();
    for node in nodes {
        let first = operands.len().saturating_sub(node.part.arity());
        let mut taken = operands.split_off(first).into_iter();
        let mut next = |at_least: Tightness| {
            let (operand, tightness) = taken.next().unwrap_or((String::new(), Tightness::Atom));
            if tightness < at_least { format!("({operand})") } else { operand }
        };
        let (written, tightness) = match &node.part {
            Part::Number { digits, unit, .. } => {
                let digits = &text[digits.clone()];
                let unit = unit.clone().map(|unit| format!("{digits} [{}]", text[unit].trim()));
                (unit.unwrap_or_else(|| digits.to_owned()), Tightness::Atom)
            }
            Part::Pi => ("pi".to_owned(), Tightness::Atom),
            Part::Variable(index) => {
                (variables.get(*index).map_or("", |variable| variable.name).to_owned(), Tightness::Atom)
            }
            Part::Parameter(index) => (parameters.get(*index).cloned().unwrap_or_default(), Tightness::Atom),
            Part::Negate => (format!("-{}", next(Tightness::Unary)), Tightness::Unary),
            Part::Operate(operator) => {
                let (sign, left, right, own) = match operator {
                    Operator::Add => (" + ", Tightness::Sum, Tightness::Product, Tightness::Sum),
                    Operator::Subtract => (" - ", Tightness::Sum, Tightness::Product, Tightness::Sum),
                    Operator::Multiply => ("*", Tightness::Product, Tightness::Unary, Tightness::Product),
                    Operator::Divide => ("/", Tightness::Product, Tightness::Unary, Tightness::Product),
                    Operator::Power => ("^", Tightness::Atom, Tightness::Unary, Tightness::Power),
                };
                let mut out = next(left);
                out.push_str(sign);
                out.push_str(&next(right));
                (out, own)
            }
            Part::Compare(comparison) => {
                let left = next(Tightness::Sum);
                let right = next(Tightness::Sum);
                (format!("{left} {} {right}", function::symbol(*comparison)), Tightness::Comparison)
            }
            Part::Call(function) => (called(*function, |_| next(Tightness::Comparison)), Tightness::Atom),
        };
        operands.push((written, tightness));
    }
    operands.pop().map_or_else(String::new, |(written, _)| written)
}

fn called(called: Function, argument: impl FnMut(usize) -> String) -> String {
    let arguments: Vec<String> = (0..called.arity()).map(argument).collect();
    format!("{}({})", function::name(called), arguments.join(", "))
}
